//! Triangles between the boundary of a disc in the plane and a ring around it.
//!
//! With them the disc is part of a convex one, so its boundary can move without meeting itself as long as no triangle
//! folds: the virtual points of WARP 4.1, and the scaffold of Jiang, Schaefer, Panozzo: Simplicial complex augmentation
//! framework for bijective maps (2017).

use glam::DVec2;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

/// Points between the boundary and the ring keep this share of the spacing from both.
const CLEARANCE: f64 = 0.6;

/// What lies around a disc. Points are numbered on from those of the boundary: first the ring, then those between.
#[derive(Clone, Debug, Default)]
pub struct Scaffold {
    /// The ring and the points between it and the boundary.
    pub points: Vec<DVec2>,
    /// Number of points of the ring.
    pub ring: usize,
    /// Triangles, counter-clockwise, over the boundary's points and these.
    pub triangles: Vec<[u32; 3]>,
}

/// Fills the space between the boundary of a disc, simple and counter-clockwise, and a convex ring around it; points
/// between them are about `spacing` apart.
///
/// None if rounding has put a boundary point onto a boundary edge or onto another.
pub fn scaffold(boundary: &[DVec2], ring: &[DVec2], spacing: f64) -> Option<Scaffold> {
    let between = filling(boundary, ring, spacing);
    let points: Vec<DVec2> = ring.iter().chain(&between).copied().collect();
    let mut cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let mut handles = Vec::with_capacity(boundary.len() + points.len());
    for p in boundary.iter().chain(&points) {
        let handle = cdt.insert(Point2::new(p.x, p.y)).ok()?;
        (handle.index() == handles.len()).then_some(())?;
        handles.push(handle);
    }
    for i in 0..boundary.len() {
        let (a, b) = (handles[i], handles[(i + 1) % boundary.len()]);
        cdt.can_add_constraint(a, b).then_some(())?;
        cdt.add_constraint(a, b);
        cdt.get_edge_from_neighbors(a, b).filter(|e| e.is_constraint_edge())?;
    }
    Some(Scaffold { points, ring: ring.len(), triangles: outside(&cdt) })
}

/// The triangles that can be reached from the hull without crossing the boundary.
fn outside(cdt: &ConstrainedDelaunayTriangulation<Point2<f64>>) -> Vec<[u32; 3]> {
    let mut reached = vec![false; cdt.num_all_faces()];
    let mut stack = vec![cdt.outer_face().fix().index()];
    let faces: Vec<_> = cdt.inner_faces().collect();
    let mut neighbours = vec![Vec::new(); reached.len()];
    for face in &faces {
        for edge in face.adjacent_edges().into_iter().filter(|e| !e.is_constraint_edge()) {
            let other = edge.rev().face().fix().index();
            neighbours[face.fix().index()].push(other);
            neighbours[other].push(face.fix().index());
        }
    }
    while let Some(f) = stack.pop() {
        if !std::mem::replace(&mut reached[f], true) {
            stack.extend(&neighbours[f]);
        }
    }
    let corners = faces.iter().filter(|f| reached[f.fix().index()]).map(|f| f.vertices());
    corners.map(|c| c.map(|v| v.fix().index() as u32)).collect()
}

/// Points of a triangular grid inside of the ring and outside of the boundary.
fn filling(boundary: &[DVec2], ring: &[DVec2], spacing: f64) -> Vec<DVec2> {
    let low = ring.iter().copied().fold(DVec2::INFINITY, DVec2::min);
    let high = ring.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
    let rise = spacing * 0.75f64.sqrt();
    let (columns, rows) = (((high.x - low.x) / spacing) as usize, ((high.y - low.y) / rise) as usize);
    let grid = (0..=rows).flat_map(|j| (0..=columns).map(move |i| (i, j)));
    let points = grid.map(|(i, j)| low + DVec2::new((i as f64 + (j % 2) as f64 * 0.5) * spacing, j as f64 * rise));
    let clearance = CLEARANCE * spacing;
    let is_free = |p: &DVec2| {
        is_inside(ring, *p) && !is_inside(boundary, *p) && [ring, boundary].iter().all(|l| distance(l, *p) > clearance)
    };
    points.filter(is_free).collect()
}

fn edges(polygon: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> {
    polygon.iter().zip(polygon.iter().cycle().skip(1)).map(|(&a, &b)| (a, b))
}

/// Whether a ray to the right crosses the polygon an odd number of times.
fn is_inside(polygon: &[DVec2], p: DVec2) -> bool {
    let crosses =
        |(a, b): &(DVec2, DVec2)| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
    edges(polygon).filter(crosses).count() % 2 == 1
}

fn distance(polygon: &[DVec2], p: DVec2) -> f64 {
    let to_edge = |(a, b): (DVec2, DVec2)| {
        let along = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        p.distance(a.lerp(b, if along.is_finite() { along } else { 0.0 }))
    };
    edges(polygon).map(to_edge).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::metric;
    use std::f64::consts::TAU;

    fn circle(n: usize, radius: f64) -> Vec<DVec2> {
        (0..n).map(|i| DVec2::from_angle(TAU * i as f64 / n as f64) * radius).collect()
    }

    fn area(polygon: &[DVec2]) -> f64 {
        edges(polygon).map(|(a, b)| a.perp_dot(b)).sum::<f64>() * 0.5
    }

    #[test]
    fn a_scaffold_fills_the_space_between_a_spiral_and_its_ring_exactly_once() {
        let arm = |turn: f64, i: usize| DVec2::from_angle(i as f64 * 0.2) * (turn + 0.02 * i as f64);
        let (outer, inner): (Vec<_>, Vec<_>) = (0..50).map(|i| (arm(0.5, i), arm(0.2, i))).unzip();
        let boundary: Vec<DVec2> = outer.into_iter().chain(inner.into_iter().rev()).collect();
        let ring = circle(16, 3.0);
        let scaffold = scaffold(&boundary, &ring, 0.4).expect("the spiral is simple");
        let points: Vec<DVec2> = boundary.iter().chain(&scaffold.points).copied().collect();
        let sum: f64 = scaffold.triangles.iter().map(|t| metric::signed_area(t.map(|v| points[v as usize]))).sum();
        let expected = area(&ring) - area(&boundary);
        assert!((sum - expected).abs() < 1e-9, "{sum} for {expected}");
        assert!(scaffold.points[..16] == ring[..] && scaffold.points.len() > 50);
        let edge = |t: &[u32; 3], a: u32, b: u32| (0..3).any(|i| t[i] == a && t[(i + 1) % 3] == b);
        let n = boundary.len() as u32;
        assert!((0..n).all(|i| scaffold.triangles.iter().any(|t| edge(t, (i + 1) % n, i))));
    }

    #[test]
    fn a_boundary_through_one_point_twice_is_refused() {
        let [a, b, c] = [DVec2::ZERO, DVec2::X, DVec2::Y];
        assert!(scaffold(&[a, b, c, a, -b, -c], &circle(8, 3.0), 0.5).is_none());
    }
}
