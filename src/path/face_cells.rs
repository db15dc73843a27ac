//! One original face cut into convex cells by straight steps, and the triangulation of those cells.

use crate::mesh::VertexId;
use glam::DVec3;

/// A point on the boundary of a face and the sides of the face it lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoundaryPoint {
    /// The vertex it becomes.
    pub vertex: VertexId,
    /// One bit per side; a corner lies on two.
    sides: u8,
}

impl BoundaryPoint {
    /// The corner `i` of the face.
    pub fn at_corner(vertex: VertexId, i: usize) -> Self {
        BoundaryPoint { vertex, sides: (1 << i) | (1 << ((i + 2) % 3)) }
    }

    /// A point inside side `i`, which runs from corner `i` to corner `i + 1`.
    pub fn on_side(vertex: VertexId, i: usize) -> Self {
        BoundaryPoint { vertex, sides: 1 << i }
    }
}

/// Cuts the boundary polygon of a face along steps that do not cross; the cells are convex polygons.
pub fn cells_of_face(boundary: &[BoundaryPoint], steps: &[[VertexId; 2]]) -> Vec<Vec<BoundaryPoint>> {
    let mut cells = vec![boundary.to_vec()];
    for &[a, b] in steps {
        let find = |cell: &[BoundaryPoint], v| cell.iter().position(|p| p.vertex == v);
        let hit = cells.iter().enumerate().find_map(|(k, cell)| Some((k, find(cell, a)?, find(cell, b)?)));
        let Some((k, i, j)) = hit else { continue };
        let (i, j) = (i.min(j), i.max(j));
        let cell = cells.swap_remove(k);
        let inner = cell[i..=j].to_vec();
        let outer: Vec<BoundaryPoint> = cell[j..].iter().chain(&cell[..=i]).copied().collect();
        cells.extend([inner, outer].into_iter().filter(|c| c.len() > 2));
    }
    cells
}

/// Triangulates a convex cell by cutting off its best-shaped ear again and again.
///
/// No triangle has all corners on one side of the face, so none is flat.
pub fn triangulate(cell: &[BoundaryPoint], position: &dyn Fn(&BoundaryPoint) -> DVec3) -> Vec<[VertexId; 3]> {
    if let [a, b, c] = cell {
        return vec![[a.vertex, b.vertex, c.vertex]];
    }
    let mut ring = cell.to_vec();
    let mut triangles = Vec::with_capacity(ring.len() - 2);
    while ring.len() >= 3 {
        let n = ring.len();
        let ear = |i: usize| [ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]];
        let flat = |points: &mut dyn Iterator<Item = u8>| points.fold(7, |common, sides| common & sides) != 0;
        let sound = |&i: &usize| {
            let rest_is_flat = flat(&mut (0..n).filter(|&k| k != i).map(|k| ring[k].sides));
            !flat(&mut ear(i).iter().map(|p| p.sides)) && (n == 3 || !rest_is_flat)
        };
        let shape = |i: usize| {
            let [a, b, c] = ear(i).map(|p| position(&p));
            let sides_sq = (b - a).length_squared() + (c - b).length_squared() + (a - c).length_squared();
            (b - a).cross(c - a).length_squared() / (sides_sq * sides_sq)
        };
        let best = (0..n).filter(sound).max_by(|&i, &j| shape(i).total_cmp(&shape(j)));
        let i = best.unwrap_or(0);
        triangles.push(ear(i).map(|p| p.vertex));
        ring.remove(i);
    }
    triangles
}
