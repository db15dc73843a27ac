//! The stages one after the other, as the main job runs them.

use homeo::Result;
use homeo::map::embedding::Embedding;
use homeo::map::surface_map::{Chart, SurfaceMap, compose};
use homeo::mesh::{TriMesh, VertexId};
use homeo::stage::cluster::cluster;
use homeo::stage::embed::embed;
use homeo::stage::layout::{Layout, layouts};

/// Least number of nodes on an edge, as VORONOI takes it.
pub const EDGE_NODES: u32 = 3;

/// Two meshes and their landmarks, pairwise.
pub struct Pair {
    pub meshes: [TriMesh; 2],
    pub landmarks: [Vec<VertexId>; 2],
}

impl Pair {
    pub fn new(source: (TriMesh, Vec<VertexId>), target: (TriMesh, Vec<VertexId>)) -> Self {
        assert_eq!(source.1.len(), target.1.len(), "as many landmarks on both meshes");
        Pair { meshes: [source.0, target.0], landmarks: [source.1, target.1] }
    }

    fn both(&self) -> [&TriMesh; 2] {
        [&self.meshes[0], &self.meshes[1]]
    }

    /// The layout with the shortest arcs.
    pub fn layout(&self) -> Result<Layout> {
        let landmarks = [self.landmarks[0].as_slice(), &self.landmarks[1]];
        let clusters = cluster(self.both(), landmarks);
        let mut all = layouts(self.both(), landmarks, &clusters, EDGE_NODES, 1)?;
        Ok(all.swap_remove(0))
    }

    pub fn embed(&self) -> Result<Embedding> {
        Ok(embed(self.both(), self.layout()?)?.0)
    }

    /// The images of the vertices of mesh `from` on the other.
    pub fn map(&self, embedding: &Embedding, from: usize) -> Result<SurfaceMap> {
        let to = 1 - from;
        let chart = Chart::new(&self.meshes[to], &embedding.meshes[to], &embedding.base);
        compose(&embedding.meshes[from], &embedding.base, self.meshes[from].positions.len(), &chart)
    }
}
