//! Stage: base vertices and their clusters on both meshes (VORONOI 5.1).
//!
//! Base vertices are the landmarks and, behind them, auxiliary ones: the tips of limbs that both meshes have but no
//! landmark pins, and vertices on boundary loops that carry too few. Auxiliary ones are vertices of the base complex
//! like the others, but are not landmarks of the user.

use crate::mesh::{TriMesh, VertexId};
use crate::path::cluster::Clusters;
use crate::path::extremity::matching_tips;
use crate::path::loop_anchor::matching_anchors;

/// The base vertices of both meshes and their clusters.
#[derive(Clone, Debug)]
pub struct Clustered {
    /// On each mesh the landmarks, then the auxiliary base vertices, in the same order on both.
    pub base_vertices: [Vec<VertexId>; 2],
    /// Their clusters.
    pub clusters: [Clusters; 2],
}

/// Finds auxiliary base vertices and grows the clusters of both meshes, side by side.
pub fn cluster(meshes: [&TriMesh; 2], landmarks: [&[VertexId]; 2]) -> Clustered {
    let mut base_vertices = landmarks.map(<[VertexId]>::to_vec);
    for tips in matching_tips(meshes, landmarks) {
        if (0..2).all(|k| !base_vertices[k].contains(&tips[k]) && !meshes[k].conn.is_on_boundary(tips[k])) {
            (0..2).for_each(|k| base_vertices[k].push(tips[k]));
        }
    }
    for anchors in matching_anchors(meshes, [&base_vertices[0], &base_vertices[1]]) {
        (0..2).for_each(|k| base_vertices[k].push(anchors[k]));
    }
    let [on_source, on_target] = &base_vertices;
    let (source, target) =
        rayon::join(|| Clusters::grow(meshes[0], on_source), || Clusters::grow(meshes[1], on_target));
    Clustered { clusters: [source, target], base_vertices }
}
