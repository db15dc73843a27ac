//! The new way of an arc through a relaxed domain of two patches: the straight segment between them.
//!
//! After relaxation the segment from (0, 0) to (1, 0) no longer runs along edges. Vertices close to it are put onto it
//! where that keeps their triangles positive; then it is read off as the vertices and edges it meets, from the signs of
//! the vertices' heights alone.

use super::domain::{Domain, Fans, OUTSIDE};
use glam::DVec2;

/// An edge crossed nearer to a vertex than this share of its length gives the vertex a try on the segment.
const SNAP: f64 = 0.2;
/// Triangles keep this share of their area when a vertex is put onto the segment.
const KEEP_AREA: f64 = 0.1;
/// Neighbouring places on the segment are at least this far apart; nearer ones could not be told apart later.
const LEAST_GAP: f64 = 1e-10;

/// A place on the segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// A vertex of the domain.
    Vertex(u32),
    /// Share `t` of the way along the edge from one vertex to another.
    Edge(u32, u32, f64),
}

/// The segment as it meets a domain: places in order, with their abscissae.
pub type Segment = Vec<(Place, f64)>;

/// Reads the segment off a domain, after putting near vertices onto it.
///
/// None if rounding spoils the order of the places; the caller then leaves the domain as it was.
pub fn read_segment(domain: &mut Domain) -> Option<Segment> {
    let fans = domain.fans();
    snap_near(domain, &fans);
    let mut segment = vec![(Place::Vertex(domain.start), 0.0)];
    let mut at = domain.start;
    while at != domain.end {
        if segment.len() > domain.triangles.len() + 2 {
            return None;
        }
        at = advance(domain, &fans, at, &mut segment)?;
    }
    segment.windows(2).all(|w| w[0].1 + LEAST_GAP < w[1].1).then_some(segment)
}

fn snap_near(domain: &mut Domain, fans: &Fans) {
    for t in 0..domain.triangles.len() {
        for i in 0..3 {
            let [a, b] = [i, (i + 1) % 3].map(|k| domain.triangles[t][k]);
            let [ya, yb] = [a, b].map(|v| domain.positions[v as usize].y);
            if ya * yb < 0.0 && ya.abs() < SNAP * (ya - yb).abs() {
                try_snap(domain, fans, a as usize);
            }
        }
    }
}

fn try_snap(domain: &mut Domain, fans: &Fans, v: usize) {
    let old = domain.positions[v];
    let p = DVec2::new(old.x, 0.0);
    let keeps = fans.around(v).iter().all(|&(t, i)| {
        let corners = domain.triangles[t as usize];
        let [b, c] = [1, 2].map(|k| domain.positions[corners[(i as usize + k) % 3] as usize]);
        (b - p).perp_dot(c - p) > KEEP_AREA * (b - old).perp_dot(c - old)
    });
    if domain.free[v] && keeps {
        domain.positions[v] = p;
    }
}

/// Follows the segment from a vertex on it to the next vertex on it.
fn advance(domain: &Domain, fans: &Fans, at: u32, segment: &mut Segment) -> Option<u32> {
    let position = |v: u32| domain.positions[v as usize];
    for &(t, i) in fans.around(at as usize) {
        let corners = domain.triangles[t as usize];
        let (b, c) = (corners[(i as usize + 1) % 3], corners[(i as usize + 2) % 3]);
        for ahead in [b, c] {
            if position(ahead).y == 0.0 && position(ahead).x > position(at).x {
                segment.push((Place::Vertex(ahead), position(ahead).x));
                return Some(ahead);
            }
        }
        if position(b).y < 0.0 && position(c).y > 0.0 {
            return cross(domain, t, (i as usize + 1) % 3, segment);
        }
    }
    None
}

/// Crosses edges, starting with side `side` of triangle `t` (its first end below the segment), up to the next vertex.
fn cross(domain: &Domain, mut t: u32, mut side: usize, segment: &mut Segment) -> Option<u32> {
    let position = |v: u32| domain.positions[v as usize];
    for _ in 0..domain.triangles.len() {
        let corners = domain.triangles[t as usize];
        let (b, c) = (corners[side], corners[(side + 1) % 3]);
        let (p, q) = (position(b), position(c));
        let share = p.y / (p.y - q.y);
        segment.push((Place::Edge(b, c, share), p.x + share * (q.x - p.x)));
        let behind = domain.neighbours[t as usize][side];
        if behind == OUTSIDE {
            return None;
        }
        let other = domain.triangles[behind as usize];
        let i = (0..3).find(|&i| other[i] == c && other[(i + 1) % 3] == b)?;
        let far = other[(i + 2) % 3];
        let height = position(far).y;
        if height == 0.0 {
            segment.push((Place::Vertex(far), position(far).x));
            return Some(far);
        }
        // The triangle behind is (c, b, far); the segment leaves between b and far, or between far and c.
        side = if height > 0.0 { (i + 1) % 3 } else { (i + 2) % 3 };
        t = behind;
    }
    None
}
