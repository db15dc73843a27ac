//! Splits dividing edges, which would make a convex embedding degenerate.
//!
//! An edge inside a patch whose two ends lie on the same side of it would be flattened onto that side, and the triangle
//! behind it with it. Splitting such an edge puts a free vertex between them.

use crate::mesh::{HalfedgeId, Id, IdVec, TriMesh, corner, next};
use crate::path::base_complex::DirectedArc;
use crate::path::cut_mesh::CutMesh;

/// The sides of the patch at the left of a half-edge that meet at the corner the half-edge leaves: the arc that
/// arrives there and the one that leaves, equal inside a side; None at a free vertex.
fn sides_at(cut: &CutMesh, h: HalfedgeId) -> Option<[DirectedArc; 2]> {
    if !cut.is_blocked(cut.conn.from(h)) {
        return None;
    }
    let mut leaving = h;
    while cut.arc_at(leaving).is_none() {
        leaving = next(cut.conn.twin(leaving)?);
    }
    let mut arriving = h;
    loop {
        let before = crate::mesh::prev(arriving);
        if let Some(arc) = cut.arc_at(before) {
            return Some([arc, cut.arc_at(leaving)?]);
        }
        arriving = cut.conn.twin(before)?;
    }
}

/// Splits all dividing edges; returns how many there were.
pub fn split_dividing_edges(cut: &mut CutMesh, mesh: &TriMesh) -> usize {
    let halfedges = 3 * cut.conn.face_count();
    let sides: IdVec<HalfedgeId, Option<[DirectedArc; 2]>> =
        (0..halfedges).map(|i| sides_at(cut, HalfedgeId::new(i))).collect();
    let dividing = |h: HalfedgeId| {
        let (Some(a), Some(b)) = (sides[h], sides[next(h)]) else { return false };
        cut.arc_at(h).is_none() && a.iter().any(|side| b.contains(side))
    };
    let ends: Vec<_> = (0..cut.conn.face_count())
        .flat_map(|f| (0..3).map(move |i| corner(crate::mesh::FaceId::new(f), i)))
        .filter(|&h| cut.conn.is_edge_representative(h) && dividing(h))
        .map(|h| [cut.conn.from(h), cut.conn.to(h), cut.conn.to(next(h))])
        .collect();
    for &[a, b, c] in &ends {
        // Splitting other edges renumbers half-edges and may have split the face behind, so look the edge up again.
        let around = cut.conn.outgoing(a).filter(|&h| cut.conn.to(h) == b && cut.arc_at(h).is_none());
        let found: Vec<HalfedgeId> = around.collect();
        let exact = found.iter().copied().find(|&h| cut.conn.to(next(h)) == c);
        if let Some(h) = exact.or(found.first().copied()) {
            cut.split_edge(mesh, h, 0.5);
        }
    }
    ends.len()
}
