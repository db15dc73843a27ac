//! Closed loops of edges that base vertices divide into given arcs.
//!
//! Given arcs are laid before any other arc is traced, along the mesh's own edges. Two meshes whose loops carry the same
//! base vertices in the same cyclic order number them alike.

use super::base_complex::DirectedArc;
use super::cut_mesh::CutMesh;
use crate::mesh::{ArcId, HalfedgeId, Id, LandmarkId, TriMesh, VertexId};
use std::collections::HashMap;

/// A closed loop of edges with the base vertices on it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EdgeLoop {
    /// The half-edges in order, from the lowest base vertex on; base vertices split them into arcs.
    pub halfedges: Vec<HalfedgeId>,
    /// The base vertices in order, each with the number of the half-edge that leaves it.
    pub stops: Vec<(usize, LandmarkId)>,
}

/// A part of a loop from one base vertex to the next.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GivenArc {
    /// Where it starts and ends; the same where the loop has a single base vertex.
    pub ends: [LandmarkId; 2],
    /// Its half-edges in order.
    pub halfedges: Vec<HalfedgeId>,
}

/// The numbers of base vertices.
pub fn numbers(base_vertices: &[VertexId]) -> HashMap<VertexId, LandmarkId> {
    base_vertices.iter().enumerate().map(|(l, &v)| (v, LandmarkId::new(l))).collect()
}

impl EdgeLoop {
    /// A loop from its half-edges, in order from any of them on.
    pub fn new(mesh: &TriMesh, mut halfedges: Vec<HalfedgeId>, number: &HashMap<VertexId, LandmarkId>) -> Self {
        let stop = |h: HalfedgeId| number.get(&mesh.conn.from(h)).copied();
        let first = (0..halfedges.len()).filter_map(|i| Some((stop(halfedges[i])?, i))).min();
        halfedges.rotate_left(first.map_or(0, |(_, i)| i));
        let stops = (0..halfedges.len()).filter_map(|i| Some((i, stop(halfedges[i])?))).collect();
        EdgeLoop { halfedges, stops }
    }

    /// The arcs between the base vertices; none if there is no base vertex.
    pub fn arcs(&self) -> Vec<GivenArc> {
        let n = self.stops.len();
        let arc = |k: usize| {
            let (from, start) = self.stops[k];
            let (to, end) = if k + 1 < n { self.stops[k + 1] } else { (self.halfedges.len(), self.stops[0].1) };
            GivenArc { ends: [start, end], halfedges: self.halfedges[from..to].to_vec() }
        };
        (0..n).map(arc).collect()
    }

    /// The base vertices in order.
    pub fn base_vertices(&self) -> impl Iterator<Item = LandmarkId> + use<'_> {
        self.stops.iter().map(|&(_, l)| l)
    }
}

impl GivenArc {
    /// Lays the arc, under the given number, into a cut mesh that is not yet refined.
    pub fn lay(&self, cut: &mut CutMesh, arc: ArcId) {
        self.halfedges.iter().for_each(|&h| cut.mark(h, DirectedArc { arc, reversed: false }));
    }

    /// Length in mesh units.
    pub fn length(&self, cut: &CutMesh) -> f64 {
        self.halfedges.iter().map(|&h| cut.length(h)).sum()
    }
}
