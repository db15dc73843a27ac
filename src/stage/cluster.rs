//! Stage: clusters of the landmarks on both meshes (VORONOI 5.1).

use crate::mesh::{TriMesh, VertexId};
use crate::path::cluster::Clusters;

/// Grows the clusters of both meshes, side by side.
pub fn cluster(meshes: [&TriMesh; 2], landmarks: [&[VertexId]; 2]) -> [Clusters; 2] {
    let (source, target) =
        rayon::join(|| Clusters::grow(meshes[0], landmarks[0]), || Clusters::grow(meshes[1], landmarks[1]));
    [source, target]
}
