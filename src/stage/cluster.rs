//! Stage: base vertices and their clusters on both meshes (VORONOI 5.1).
//!
//! Base vertices are the landmarks and, behind them, auxiliary ones: the tips of limbs that both meshes have but no
//! landmark pins, vertices on boundary loops that carry too few, vertices on guides, and points in wide empty places that
//! seem to correspond. The last two only lead arcs around handles and limbs the same way on both meshes, and are taken
//! out again.

use super::check::Guides;
use crate::mesh::{TriMesh, VertexId};
use crate::path::cluster::Clusters;
use crate::path::edge_loop::GivenArc;
use crate::path::extremity::matching_tips;
use crate::path::loop_anchor::matching_anchors;
use crate::path::partner::partners;

/// Fewest vertices of a base complex on a sphere; on other surfaces one is enough.
const FEWEST_ON_SPHERE: usize = 3;

/// Base vertices of both meshes and their clusters.
#[derive(Clone, Debug)]
pub struct BaseVertices {
    /// On each mesh the landmarks, then the auxiliary base vertices, in the same order on both.
    pub vertices: [Vec<VertexId>; 2],
    /// Their clusters.
    pub clusters: [Clusters; 2],
    /// The arcs along boundary loops and guides on each mesh; those with one number correspond.
    pub given: [Vec<GivenArc>; 2],
    /// So many of them stay in the layout.
    pub lasting: usize,
}

impl BaseVertices {
    /// Grows the clusters of both meshes, side by side; without guides.
    pub fn grow(meshes: [&TriMesh; 2], vertices: [Vec<VertexId>; 2], lasting: usize) -> Self {
        Self::guided(meshes, vertices, lasting, &Guides::default())
    }

    /// The same with the meshes' roles swapped.
    pub fn swapped(&self) -> Self {
        let mut swapped = self.clone();
        swapped.vertices.swap(0, 1);
        swapped.clusters.swap(0, 1);
        swapped.given.swap(0, 1);
        swapped
    }

    /// The same with the arcs along guides given.
    fn guided(meshes: [&TriMesh; 2], vertices: [Vec<VertexId>; 2], lasting: usize, guides: &Guides) -> Self {
        let [on_source, on_target] = &vertices;
        let (source, target) =
            rayon::join(|| Clusters::grow(meshes[0], on_source), || Clusters::grow(meshes[1], on_target));
        let given = [0, 1].map(|k| guides.given_arcs(k, meshes[k], &vertices[k]));
        BaseVertices { clusters: [source, target], vertices, given, lasting }
    }
}

/// The sets of base vertices that layouts are tried with: without and with points in empty places.
pub fn cluster(meshes: [&TriMesh; 2], landmarks: [&[VertexId]; 2], guides: &Guides) -> Vec<BaseVertices> {
    let mut lasting = landmarks.map(<[VertexId]>::to_vec);
    let is_free = |pair: &[VertexId; 2]| guides.allow(meshes, *pair);
    let inside = |pair: &[VertexId; 2]| is_free(pair) && (0..2).all(|k| !meshes[k].conn.is_on_boundary(pair[k]));
    add(&mut lasting, matching_tips(meshes, landmarks).into_iter().filter(inside));
    let anchors = matching_anchors(meshes, lasting.each_ref().map(Vec::as_slice));
    add(&mut lasting, anchors);
    let mut more = Vec::new();
    let mut fewest = 0;
    if meshes[0].conn.is_closed_and_connected() {
        fewest = if meshes[0].conn.euler_characteristic() == 2 { FEWEST_ON_SPHERE } else { 1 };
        let missing = fewest.saturating_sub(lasting[0].len());
        let found = partners(meshes, lasting.each_ref().map(Vec::as_slice), missing);
        more.extend(found.into_iter().filter(is_free));
        add(&mut lasting, more.iter().copied().take(missing));
    }
    let lasting_pairs = lasting[0].len();
    let mut led = lasting;
    add(&mut led, guides.base_vertices.iter().copied());
    // Where partners are too few, vertices on guides make up for them.
    let count = lasting_pairs.max(fewest).min(led[0].len());
    let mut all = led.clone();
    add(&mut all, more);
    let has_more = all[0].len() > led[0].len();
    let mut sets = vec![BaseVertices::guided(meshes, led, count, guides)];
    if has_more {
        sets.push(BaseVertices::guided(meshes, all, count, guides));
    }
    sets
}

/// Adds pairs of vertices that are not base vertices yet.
fn add(base_vertices: &mut [Vec<VertexId>; 2], pairs: impl IntoIterator<Item = [VertexId; 2]>) {
    for pair in pairs {
        if (0..2).all(|k| !base_vertices[k].contains(&pair[k])) {
            (0..2).for_each(|k| base_vertices[k].push(pair[k]));
        }
    }
}
