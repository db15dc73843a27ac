//! Stage: large meshes simplified, so that the layout and most of the relaxation are made on small ones.
//!
//! Input: a checked pair. Output: the same pair with fewer vertices, landmarks kept, or nothing where the meshes are small
//! or the user has drawn curves along their edges. Invariant: every vertex of the given meshes has a place on the simple
//! ones, by a bijection (see [`crate::mesh::simplify`]).

use super::check::{Checked, Guides, LoadedMesh};
use crate::mesh::io::{Landmarks, MeshFile};
use crate::mesh::simplify::{Simplified, simplify as simplify_mesh};
use crate::mesh::{Canonical, VertexId};
use std::collections::HashMap;

/// Vertices that a mesh is simplified to: fewer no longer carry its shape, more cost time.
pub const ENOUGH: usize = 8_000;
/// Meshes that together have fewer times as many vertices as two simple ones are mapped as they are.
pub const WORTHWHILE: f64 = 2.5;

/// A simplified pair.
pub struct Simple {
    /// The pair as the further stages see it.
    pub checked: Checked,
    /// Both meshes and the way back.
    pub simplified: [Simplified; 2],
}

/// Simplifies a pair to about `enough` vertices a mesh, if that is worthwhile.
pub fn simplify(checked: &Checked, enough: usize) -> Option<Simple> {
    let meshes = checked.meshes();
    let vertices: usize = meshes.iter().map(|m| m.positions.len()).sum();
    if (vertices as f64) < WORTHWHILE * 2.0 * enough as f64 || !checked.guides.is_empty() {
        return None;
    }
    let sites = checked.sites();
    let one = |k: usize| simplify_mesh(meshes[k], &sites[k], enough);
    let (source, target) = rayon::join(|| one(0), || one(1));
    let simplified = [source, target];
    let given = [&checked.source, &checked.target];
    let landmarks_of = |k: usize, of_file: &[VertexId]| -> Vec<VertexId> {
        let number: HashMap<VertexId, VertexId> = simplified[k].kept.iter_ids().map(|(here, &v)| (v, here)).collect();
        of_file.iter().map(|&v| number[&given[k].canonical.vertex(v)]).collect()
    };
    let landmarks = Landmarks {
        source: landmarks_of(0, &checked.landmarks.source),
        target: landmarks_of(1, &checked.landmarks.target),
        ..checked.landmarks.clone()
    };
    let [source, target] = [0, 1].map(|k| as_loaded(given[k], &simplified[k]));
    let landmark_order = checked.landmark_order.clone();
    let checked =
        Checked { source, target, landmarks, landmark_order, guides: Guides::default(), warnings: Vec::new() };
    Some(Simple { checked, simplified })
}

/// A simplified mesh as if it had been loaded and checked; its order follows that of the given one.
fn as_loaded(given: &LoadedMesh, simplified: &Simplified) -> LoadedMesh {
    LoadedMesh {
        file: MeshFile { path: given.file.path.clone(), ..MeshFile::default() },
        mesh: simplified.mesh.clone(),
        omitted: Vec::new(),
        report: given.report.clone(),
        canonical: Canonical::as_given(&simplified.mesh),
    }
}
