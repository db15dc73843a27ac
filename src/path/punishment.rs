//! The punishment field around a path hypothesis (HYPOTHESIS 3.2).
//!
//! A search pays more for every step the farther it is from the hypothesis, and cannot leave its neighbourhood: so a path
//! stays near the guess, takes the branch that the guess takes, and is found fast.

use super::cut_mesh::CutMesh;
use super::edge_tree::EdgeTree;
use super::search::{Bounds, Passage};
use crate::mesh::{FaceId, TriMesh, VertexId, face_of};
use std::collections::HashMap;

/// What a step at the border of the neighbourhood counts, in its length (HYPOTHESIS 3.2: exp(lambda R) = 5).
const HIGHEST: f64 = 5.0;

/// The faces near a hypothesis, each with the factor that steps through it are weighed with.
#[derive(Clone, Debug)]
pub struct Punishment {
    weight: HashMap<FaceId, f64>,
}

impl Punishment {
    /// The field around some vertices up to the distance `reach` along edges, in mesh units.
    pub fn around(mesh: &TriMesh, hypothesis: &[VertexId], reach: f64) -> Self {
        let step = |v: VertexId, w: VertexId| mesh.positions[v].distance(mesh.positions[w]);
        let tree = EdgeTree::grow(mesh, hypothesis, reach, step);
        let punish = |v: VertexId| HIGHEST.powf((tree.length[v] / reach).min(1.0));
        let mut weight = HashMap::new();
        for v in mesh.conn.vertices().filter(|&v| tree.length[v].is_finite()) {
            for f in mesh.conn.outgoing(v).map(face_of) {
                weight.entry(f).or_insert_with(|| mesh.conn.face(f).map(punish).iter().sum::<f64>() / 3.0);
            }
        }
        Punishment { weight }
    }
}

impl Bounds for Punishment {
    fn on<'a>(&'a self, cut: &'a CutMesh) -> Box<dyn Passage + 'a> {
        Box::new(Near { punishment: self, cut })
    }
}

/// Keeps a path near its hypothesis.
struct Near<'a> {
    punishment: &'a Punishment,
    cut: &'a CutMesh,
}

impl Passage for Near<'_> {
    fn face(&self, f: FaceId) -> bool {
        self.punishment.weight.contains_key(&self.cut.face_origin[f])
    }

    fn weight(&self, f: FaceId) -> f64 {
        self.punishment.weight.get(&self.cut.face_origin[f]).copied().unwrap_or(HIGHEST)
    }
}
