//! Rims: the arcs along boundary loops, between the base vertices on them.
//!
//! They are given before any other arc is traced, run along the mesh's own edges with the surface at their left, and
//! never move: so boundaries go onto boundaries exactly, and every region between arcs is bounded by arcs alone. Rims
//! are numbered loop by loop, the loop with the lowest base vertex first and from that vertex on; two meshes whose loops
//! carry the same base vertices in the same cyclic order number them alike.

use super::base_complex::DirectedArc;
use super::cut_mesh::CutMesh;
use crate::mesh::{ArcId, HalfedgeId, Id, LandmarkId, TriMesh, VertexId};
use std::collections::HashMap;

/// A boundary loop with the base vertices on it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BoundaryLoop {
    /// The half-edges in order, with the surface at their left; base vertices split them into rims.
    pub halfedges: Vec<HalfedgeId>,
    /// The base vertices in order, each with the number of the half-edge that leaves it.
    pub stops: Vec<(usize, LandmarkId)>,
}

/// A part of a boundary loop from one base vertex to the next.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rim {
    /// Where it starts and ends; the same where the loop has a single base vertex.
    pub ends: [LandmarkId; 2],
    /// Its half-edges in order.
    pub halfedges: Vec<HalfedgeId>,
}

/// The boundary loops of a mesh, those with base vertices first, by their lowest, from which they start.
pub fn boundary_loops(mesh: &TriMesh, base_vertices: &[VertexId]) -> Vec<BoundaryLoop> {
    let number: HashMap<VertexId, LandmarkId> =
        base_vertices.iter().enumerate().map(|(l, &v)| (v, LandmarkId::new(l))).collect();
    let stop = |h: HalfedgeId| number.get(&mesh.conn.from(h)).copied();
    let one = |mut halfedges: Vec<HalfedgeId>| {
        let first = (0..halfedges.len()).filter_map(|i| Some((stop(halfedges[i])?, i))).min();
        halfedges.rotate_left(first.map_or(0, |(_, i)| i));
        let stops = (0..halfedges.len()).filter_map(|i| Some((i, stop(halfedges[i])?))).collect();
        BoundaryLoop { halfedges, stops }
    };
    let mut loops: Vec<BoundaryLoop> = mesh.conn.boundary_loops().into_iter().map(one).collect();
    loops.sort_by_key(|l| l.stops.first().map_or(usize::MAX, |&(_, stop)| stop.index()));
    loops
}

/// The rims of a mesh in order; a loop without a base vertex has none.
pub fn rims(mesh: &TriMesh, base_vertices: &[VertexId]) -> Vec<Rim> {
    boundary_loops(mesh, base_vertices).iter().flat_map(BoundaryLoop::rims).collect()
}

impl BoundaryLoop {
    fn rims(&self) -> Vec<Rim> {
        let n = self.stops.len();
        let rim = |k: usize| {
            let (from, start) = self.stops[k];
            let (to, end) = if k + 1 < n { self.stops[k + 1] } else { (self.halfedges.len(), self.stops[0].1) };
            Rim { ends: [start, end], halfedges: self.halfedges[from..to].to_vec() }
        };
        (0..n).map(rim).collect()
    }
}

impl Rim {
    /// Lays the rim into a cut mesh that is not yet cut, as the arc of the given number.
    pub fn lay(&self, cut: &mut CutMesh, arc: ArcId) {
        self.halfedges.iter().for_each(|&h| cut.mark(h, DirectedArc { arc, reversed: false }));
    }

    /// Length in mesh units.
    pub fn length(&self, cut: &CutMesh) -> f64 {
        self.halfedges.iter().map(|&h| cut.length(h)).sum()
    }
}
