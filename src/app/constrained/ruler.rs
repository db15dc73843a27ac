//! Where a straight line on a plane mesh goes on.

use crate::mesh::{HalfedgeId, VertexId, next};
use crate::path::cut_mesh::CutMesh;
use crate::plane::orientation::orientation;
use glam::DVec2;

/// Shares along edges are multiples of this, so that barycentric coordinates stay exact when splits are split again.
const GRID: f64 = (1u64 << 40) as f64;

/// What comes next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ahead {
    /// A vertex beside the last one.
    Vertex(VertexId),
    /// The share of the way along a half-edge opposite to the last vertex.
    Edge(HalfedgeId, f64),
}

/// What the straight line from `v` to `goal` meets first, the goal's own edges being taken whole; none if everything
/// ahead is taken by paths.
pub fn straight_on(cut: &CutMesh, v: VertexId, goal: VertexId) -> Option<Ahead> {
    let at = |v: VertexId| cut.positions[v].truncate();
    let (from, to) = (at(v), at(goal));
    let side = |w: VertexId| orientation(from, to, at(w));
    let is_ahead = |w: VertexId| (at(w) - from).dot(to - from) > 0.0;
    if cut.conn.outgoing(v).any(|h| cut.conn.to(h) == goal && cut.arc_at(h).is_none()) {
        return Some(Ahead::Vertex(goal));
    }
    for h in cut.conn.outgoing(v) {
        let (a, b) = (cut.conn.to(h), cut.conn.to(next(h)));
        for w in [a, b] {
            if side(w) == 0.0 && is_ahead(w) && !cut.is_blocked(w) {
                return Some(Ahead::Vertex(w));
            }
        }
        let (right, left) = (side(a), side(b));
        if right < 0.0 && left > 0.0 && orientation(at(a), at(b), from) > 0.0 && crosses(from, to, at(a), at(b)) {
            let edge = next(h);
            let free = cut.arc_at(edge).is_none() && cut.conn.twin(edge).is_some();
            let share = (right / (right - left) * GRID).round().clamp(1.0, GRID - 1.0) / GRID;
            return free.then_some(Ahead::Edge(edge, share));
        }
    }
    None
}

/// True if the line from `from` leaves through the edge from `a` to `b` ahead, not behind.
fn crosses(from: DVec2, to: DVec2, a: DVec2, b: DVec2) -> bool {
    (to - from).perp_dot(a - from) < 0.0 && (b - a).perp_dot(to - a) < (b - a).perp_dot(from - a)
}
