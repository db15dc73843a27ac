//! Rims: the arcs along boundary loops, between the base vertices on them.
//!
//! They are given, run with the surface at their left, and never move: so boundaries go onto boundaries exactly, and
//! every region between arcs is bounded by arcs alone. Rims are numbered loop by loop, the loop with the lowest base
//! vertex first and from that vertex on.

use super::edge_loop::{EdgeLoop, GivenArc, numbers};
use crate::mesh::{Id, TriMesh, VertexId};

/// The boundary loops of a mesh, those with base vertices first, by their lowest, from which they start.
pub fn boundary_loops(mesh: &TriMesh, base_vertices: &[VertexId]) -> Vec<EdgeLoop> {
    let number = numbers(base_vertices);
    let loops = mesh.conn.boundary_loops().into_iter();
    let mut loops: Vec<EdgeLoop> = loops.map(|halfedges| EdgeLoop::new(mesh, halfedges, &number)).collect();
    loops.sort_by_key(|l| l.stops.first().map_or(usize::MAX, |&(_, stop)| stop.index()));
    loops
}

/// The rims of a mesh in order; a loop without a base vertex has none.
pub fn rims(mesh: &TriMesh, base_vertices: &[VertexId]) -> Vec<GivenArc> {
    boundary_loops(mesh, base_vertices).iter().flat_map(EdgeLoop::arcs).collect()
}
