//! Guides: the closed curves of a hint on both meshes, found to leave regions of one kind.
//!
//! Input: vertices along each curve. Output: loops of edges, disjoint but for the vertices where they meet, with base
//! vertices on them. Invariant: the loops carry the same base vertices in the same cyclic order, and what lies between
//! them is the same on both meshes: boundary walks, landmarks inside, genus. So some homeomorphism takes the loops to
//! each other, and arcs along them may be given to the layout of either mesh.

mod between;
mod curves;
mod meetings;

use super::LoadedMesh;
use crate::Result;
use crate::mesh::io::{Hint, Landmarks};
use crate::mesh::{FaceId, HalfedgeId, IdVec, TriMesh, VertexId, face_of};
use crate::path::edge_loop::{EdgeLoop, GivenArc, numbers};
use crate::path::loop_anchor::{anchors_between, matching_anchors};
use crate::path::rim::rims;

/// Closed curves that the map takes to each other, in canonical order.
#[derive(Clone, Debug, Default)]
pub struct Guides {
    /// On each mesh the half-edges of every curve; curves with one number correspond.
    loops: [Vec<Vec<HalfedgeId>>; 2],
    /// Base vertices on the curves that are no landmarks, source first: where curves meet, and places between.
    pub base_vertices: Vec<[VertexId; 2]>,
    /// For every face the region between curves; regions with one number correspond.
    region: [IdVec<FaceId, u32>; 2],
    /// True if the map may still wind around a handle, for some region between the curves has one or is a ring.
    pub open: bool,
}

impl Guides {
    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        self.loops[0].is_empty()
    }

    /// The arcs along boundary loops and guides on mesh `k`, in order.
    pub fn given_arcs(&self, k: usize, mesh: &TriMesh, base_vertices: &[VertexId]) -> Vec<GivenArc> {
        let mut arcs = rims(mesh, base_vertices);
        arcs.extend(edge_loops(mesh, &self.loops[k], base_vertices).iter().flat_map(EdgeLoop::arcs));
        arcs
    }

    /// True if a map that follows the guides may take one vertex to the other: both lie inside one region.
    pub fn allow(&self, meshes: [&TriMesh; 2], pair: [VertexId; 2]) -> bool {
        let passes = |k: usize| self.loops[k].iter().flatten().any(|&h| meshes[k].conn.from(h) == pair[k]);
        let region = |k: usize| meshes[k].conn.leaving(pair[k]).map(|h| self.region[k][face_of(h)]);
        self.is_empty() || !passes(0) && !passes(1) && region(0) == region(1)
    }
}

fn edge_loops(mesh: &TriMesh, loops: &[Vec<HalfedgeId>], base_vertices: &[VertexId]) -> Vec<EdgeLoop> {
    let number = numbers(base_vertices);
    loops.iter().map(|halfedges| EdgeLoop::new(mesh, halfedges.clone(), &number)).collect()
}

/// What guides are found from.
pub struct Guiding<'a> {
    /// Both meshes.
    pub loaded: [&'a LoadedMesh; 2],
    /// The landmarks.
    pub landmarks: &'a Landmarks,
    /// Their numbers in the order that the stages work in.
    pub order: &'a [usize],
    /// Their vertices on the canonical meshes, in that order.
    pub sites: [&'a [VertexId]; 2],
    /// The curves.
    pub hint: &'a Hint,
}

impl Guiding<'_> {
    /// Finds the guides.
    ///
    /// # Errors
    /// Bad input if a curve cannot be closed, meets the boundary, runs along another one, or meets one at places of which
    /// it is not clear which correspond. Unsolvable if no homeomorphism takes all curves and landmarks to each other.
    pub fn find(&self) -> Result<Guides> {
        let meshes = self.loaded.map(|l| &l.canonical.mesh);
        let loops = [self.close(0)?, self.close(1)?];
        let meetings = self.meetings(&loops)?;
        let mut base = self.sites.map(<[VertexId]>::to_vec);
        extend(&mut base, &meetings);
        let marked = [0, 1].map(|k| edge_loops(meshes[k], &loops[k], &base[k]));
        self.same_order(&marked)?;
        let places = anchors_between(meshes, [&marked[0], &marked[1]], [&base[0], &base[1]]);
        extend(&mut base, &places);
        let anchors = matching_anchors(meshes, [&base[0], &base[1]]);
        extend(&mut base, &anchors);
        let base_vertices = meetings.into_iter().chain(places).collect();
        self.compare(Guides { loops, base_vertices, ..Guides::default() }, &base)
    }

    fn name(&self, i: usize) -> String {
        format!("loop \"{}\"", self.hint.loops[i].name)
    }
}

fn extend(base: &mut [Vec<VertexId>; 2], pairs: &[[VertexId; 2]]) {
    (0..2).for_each(|k| base[k].extend(pairs.iter().map(|pair| pair[k])));
}
