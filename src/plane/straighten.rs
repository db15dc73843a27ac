//! The new ways of the arcs through a relaxed domain: straight segments between the nodes of its tiling.
//!
//! After relaxation the segments no longer run along edges. Vertices close to a segment are put onto it where that keeps
//! their triangles positive; then it is read off as the vertices and edges it meets, from the signs of the vertices'
//! heights over it alone, and the edges are split there. Seams are taken in turn and meet only at nodes.

use super::domain::{Domain, Fans, OUTSIDE};
use super::tiling::Tiling;
use crate::mesh::FaceId;
use glam::DVec2;

/// Triangles keep this share of their area when a vertex is put onto the segment.
const KEEP_AREA: f64 = 0.1;
/// Neighbouring places on the segment are at least this far apart; nearer ones could not be told apart later.
const LEAST_GAP: f64 = 1e-10;
/// Triangles are at least this high: lower ones may turn over when they are rounded to their patch's coordinates.
const LEAST_HEIGHT: f64 = 1e-13;

/// An edge that was split.
#[derive(Clone, Copy, Debug)]
pub struct Split {
    /// From and to.
    pub ends: [u32; 2],
    /// The share of the way.
    pub share: f64,
    /// A face of the cut mesh in an original face at the edge.
    pub face: FaceId,
}

/// How the seams run.
#[derive(Clone, Debug, Default)]
pub struct Straightened {
    /// The edges that were split in the domain, in order; every split made the next higher vertex.
    pub splits: Vec<Split>,
    /// For every seam its vertices and their shares of its length, from its first end to its second.
    pub seams: Vec<Vec<(u32, f64)>>,
}

/// A place on a segment and its abscissa.
type Place = (Meeting, f64);

#[derive(Clone, Copy)]
enum Meeting {
    Vertex(u32),
    /// The share of the way along an edge, with the triangles before and behind it.
    Edge {
        ends: [u32; 2],
        share: f64,
        triangles: [u32; 2],
    },
}

/// Makes all seams of a relaxed domain run along edges.
///
/// An edge crossed nearer to a vertex than the share `snap` of its length gives the vertex a try on the segment: fewer
/// splits, but the map changes there. None if rounding spoils the order of the places on a segment, or may spoil a triangle.
pub fn straighten(domain: &mut Domain, tiling: &Tiling, snap: f64) -> Option<Straightened> {
    let mut result = Straightened::default();
    for seam in &tiling.seams {
        let ends = seam.ends;
        let [from, to] = ends.map(|n| tiling.nodes[n as usize]);
        let fans = domain.fans();
        let mut view = View::new(domain, ends, from, to);
        view.snap_near(domain, &fans, snap);
        let segment = view.read(domain, &fans)?;
        let mut vertices = Vec::with_capacity(segment.len());
        for (meeting, x) in segment {
            let v = match meeting {
                Meeting::Vertex(v) => v,
                Meeting::Edge { ends, share, triangles } => {
                    let (v, t) = domain.split_edge(ends, share, from + (to - from) * x, triangles)?;
                    result.splits.push(Split { ends, share, face: domain.faces[t as usize] });
                    v
                }
            };
            domain.free[v as usize] = false;
            vertices.push((v, x));
        }
        result.seams.push(vertices);
        domain.connect();
    }
    (0..domain.triangles.len()).all(|t| height(domain.triangle(t)) > LEAST_HEIGHT).then_some(result)
}

/// The least height of a triangle, negative if it is turned over.
fn height([a, b, c]: [DVec2; 3]) -> f64 {
    let longest_sq = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
    (b - a).perp_dot(c - a) / longest_sq.sqrt()
}

/// A domain seen along a segment: it runs from (0, 0) to (1, 0).
struct View {
    ends: [u32; 2],
    from: DVec2,
    along: DVec2,
    positions: Vec<DVec2>,
}

impl View {
    fn new(domain: &Domain, ends: [u32; 2], from: DVec2, to: DVec2) -> Self {
        let along = to - from;
        let unit = along / along.length_squared();
        let see = |&p: &DVec2| DVec2::new((p - from).dot(unit), unit.perp_dot(p - from));
        let mut positions: Vec<DVec2> = domain.positions.iter().map(see).collect();
        positions[ends[0] as usize] = DVec2::ZERO;
        positions[ends[1] as usize] = DVec2::X;
        View { ends, from, along, positions }
    }

    fn at(&self, v: u32) -> DVec2 {
        self.positions[v as usize]
    }

    fn snap_near(&mut self, domain: &mut Domain, fans: &Fans, snap: f64) {
        for t in 0..domain.triangles.len() {
            for i in 0..3 {
                let [a, b] = [i, (i + 1) % 3].map(|k| domain.triangles[t][k]);
                let [ya, yb] = [a, b].map(|v| self.at(v).y);
                if ya * yb < 0.0 && ya.abs() < snap * (ya - yb).abs() {
                    self.try_snap(domain, fans, a);
                }
            }
        }
    }

    fn try_snap(&mut self, domain: &mut Domain, fans: &Fans, v: u32) {
        let old = self.at(v);
        let p = DVec2::new(old.x, 0.0);
        let keeps = |&(t, i): &(u32, u8)| {
            let corners = domain.triangles[t as usize];
            let [b, c] = [1, 2].map(|k| self.at(corners[(i as usize + k) % 3]));
            (b - p).perp_dot(c - p) > KEEP_AREA * (b - old).perp_dot(c - old)
        };
        let is_between = LEAST_GAP < p.x && p.x < 1.0 - LEAST_GAP;
        if domain.free[v as usize] && is_between && fans.around(v as usize).iter().all(keeps) {
            self.positions[v as usize] = p;
            domain.positions[v as usize] = self.from + self.along * p.x;
        }
    }

    /// The places that the segment meets, from end to end.
    fn read(&self, domain: &Domain, fans: &Fans) -> Option<Vec<Place>> {
        let mut segment = vec![(Meeting::Vertex(self.ends[0]), 0.0)];
        let mut at = self.ends[0];
        while at != self.ends[1] {
            if segment.len() > domain.triangles.len() + 2 {
                return None;
            }
            at = self.advance(domain, fans, at, &mut segment)?;
        }
        segment.windows(2).all(|w| w[0].1 + LEAST_GAP < w[1].1).then_some(segment)
    }

    /// Follows the segment from a vertex on it to the next vertex on it.
    fn advance(&self, domain: &Domain, fans: &Fans, at: u32, segment: &mut Vec<Place>) -> Option<u32> {
        for &(t, i) in fans.around(at as usize) {
            let corners = domain.triangles[t as usize];
            let (b, c) = (corners[(i as usize + 1) % 3], corners[(i as usize + 2) % 3]);
            for ahead in [b, c] {
                if self.at(ahead).y == 0.0 && self.at(ahead).x > self.at(at).x {
                    segment.push((Meeting::Vertex(ahead), self.at(ahead).x));
                    return Some(ahead);
                }
            }
            if self.at(b).y < 0.0 && self.at(c).y > 0.0 {
                return self.cross(domain, t, (i as usize + 1) % 3, segment);
            }
        }
        None
    }

    /// Crosses edges, starting with side `side` of triangle `t` (its first end below), up to the next vertex.
    fn cross(&self, domain: &Domain, mut t: u32, mut side: usize, segment: &mut Vec<Place>) -> Option<u32> {
        for _ in 0..domain.triangles.len() {
            let corners = domain.triangles[t as usize];
            let (b, c) = (corners[side], corners[(side + 1) % 3]);
            let (p, q) = (self.at(b), self.at(c));
            let share = p.y / (p.y - q.y);
            let behind = domain.neighbours[t as usize][side];
            if behind == OUTSIDE {
                return None;
            }
            let edge = Meeting::Edge { ends: [b, c], share, triangles: [t, behind] };
            segment.push((edge, p.x + share * (q.x - p.x)));
            let other = domain.triangles[behind as usize];
            let i = (0..3).find(|&i| other[i] == c && other[(i + 1) % 3] == b)?;
            let far = other[(i + 2) % 3];
            let height = self.at(far).y;
            if height == 0.0 {
                segment.push((Meeting::Vertex(far), self.at(far).x));
                return Some(far);
            }
            // The triangle behind is (c, b, far); the segment leaves between b and far, or between far and c.
            side = if height > 0.0 { (i + 1) % 3 } else { (i + 2) % 3 };
            t = behind;
        }
        None
    }
}
