//! A triangulation of points in the plane whose edges can be swapped.

use super::super::orientation::orientation;
use glam::DVec2;

/// Marks the missing twin of an edge of the hull.
const NONE: u32 = u32::MAX;

/// A plane triangulation: half-edge `3 t + i` runs from corner `i` of triangle `t` to the next one.
#[derive(Clone, Debug)]
pub struct Triangulation {
    points: Vec<DVec2>,
    tip: Vec<u32>,
    twin: Vec<u32>,
    /// One half-edge that leaves each point.
    leaving: Vec<u32>,
}

/// An edge that was swapped: its ends before, and its ends now, which were opposite to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Swap {
    /// The ends before, the first one at the lower end of the half-edge that was named.
    pub old: [u32; 2],
    /// The ends now: first the one that was left of `old`.
    pub new: [u32; 2],
}

/// The half-edge after `h` in its triangle.
pub(super) fn following(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// The half-edge before `h` in its triangle.
pub(super) fn leading(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

impl Triangulation {
    /// Joins triangles, counter-clockwise; none if they overlap at an edge or one is not counter-clockwise.
    pub fn new(points: Vec<DVec2>, triangles: &[[u32; 3]]) -> Option<Self> {
        let tip: Vec<u32> = triangles.as_flattened().to_vec();
        let mut leaving = vec![NONE; points.len()];
        let mut twin = vec![NONE; tip.len()];
        let mut edges = std::collections::HashMap::with_capacity(tip.len());
        for h in 0..tip.len() as u32 {
            let ends = (tip[h as usize], tip[following(h) as usize]);
            leaving[ends.0 as usize] = h;
            edges.insert(ends, h).is_none().then_some(())?;
            if let Some(&t) = edges.get(&(ends.1, ends.0)) {
                (twin[h as usize], twin[t as usize]) = (t, h);
            }
        }
        let made = Triangulation { points, tip, twin, leaving };
        made.is_valid().then_some(made)
    }

    /// Where a point is.
    pub fn point(&self, v: u32) -> DVec2 {
        self.points[v as usize]
    }

    /// Where all points are.
    pub fn points(&self) -> &[DVec2] {
        &self.points
    }

    /// The triangles, counter-clockwise.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        self.tip.chunks_exact(3).map(|t| [t[0], t[1], t[2]])
    }

    /// True if every triangle is exactly counter-clockwise.
    pub fn is_valid(&self) -> bool {
        self.triangles().all(|t| {
            let [a, b, c] = t.map(|v| self.point(v));
            orientation(a, b, c) > 0.0
        })
    }

    /// The least height of a triangle.
    pub(super) fn least_height(&self) -> f64 {
        let height = |t: [u32; 3]| {
            let [a, b, c] = t.map(|v| self.point(v));
            orientation(a, b, c) / a.distance(b).max(b.distance(c)).max(c.distance(a))
        };
        self.triangles().map(height).fold(f64::INFINITY, f64::min)
    }

    pub(super) fn put(&mut self, v: u32, p: DVec2) {
        self.points[v as usize] = p;
    }

    pub(super) fn from(&self, h: u32) -> u32 {
        self.tip[h as usize]
    }

    /// The edges opposite to an inner point, counter-clockwise; empty for a point on the hull or without triangles.
    pub(super) fn link(&self, v: u32) -> Vec<u32> {
        let start = self.leaving[v as usize];
        let mut link = Vec::new();
        let mut at = start;
        while at != NONE {
            link.push(following(at));
            at = self.twin[leading(at) as usize];
            if at == start {
                return link;
            }
        }
        Vec::new()
    }

    /// The points around a point, counter-clockwise; around one on the hull from the hull's edge that leaves it to the one
    /// that arrives. Empty for a point without triangles.
    pub fn ring(&self, v: u32) -> Vec<u32> {
        let mut start = self.leaving[v as usize];
        if start == NONE {
            return Vec::new();
        }
        let any = start;
        while !self.is_hull(start) {
            start = following(self.twin[start as usize]);
            if start == any {
                break;
            }
        }
        let mut ring = Vec::new();
        let mut at = start;
        loop {
            ring.push(self.from(following(at)));
            let before = leading(at);
            if self.is_hull(before) {
                ring.push(self.from(before));
                return ring;
            }
            at = self.twin[before as usize];
            if at == start {
                return ring;
            }
        }
    }

    /// Repeats a swap that was made on an equal triangulation; false if the edge is not there or on the hull.
    ///
    /// Only the triangles change: places are those that the points have here, in which a triangle may be folded.
    pub fn repeat(&mut self, swap: &Swap) -> bool {
        let [a, b] = swap.old;
        let found = (0..self.tip.len() as u32).find(|&h| self.from(h) == a && self.from(following(h)) == b);
        let Some(h) = found.filter(|&h| !self.is_hull(h)) else { return false };
        self.swap(h) == *swap
    }

    /// True for an edge with a triangle on one side only.
    pub(super) fn is_hull(&self, h: u32) -> bool {
        self.twin[h as usize] == NONE
    }

    /// Swaps the edge of `h`, which must not be on the hull, for the other diagonal of its two triangles.
    pub(super) fn swap(&mut self, h: u32) -> Swap {
        let t = self.twin[h as usize];
        let (a, b) = (self.from(h), self.from(t));
        let (c, d) = (self.from(leading(h)), self.from(leading(t)));
        let outer = [following(h), leading(h), following(t), leading(t)].map(|k| self.twin[k as usize]);
        let (f, g) = (h / 3 * 3, t / 3 * 3);
        for (i, v) in [a, d, c].into_iter().enumerate() {
            self.tip[f as usize + i] = v;
        }
        for (i, v) in [b, c, d].into_iter().enumerate() {
            self.tip[g as usize + i] = v;
        }
        self.join(f, outer[2]);
        self.join(f + 1, g + 1);
        self.join(f + 2, outer[1]);
        self.join(g, outer[0]);
        self.join(g + 2, outer[3]);
        for (v, k) in [(a, f), (d, f + 1), (c, f + 2), (b, g)] {
            self.leaving[v as usize] = k;
        }
        Swap { old: [a, b], new: [c, d] }
    }

    fn join(&mut self, h: u32, t: u32) {
        self.twin[h as usize] = t;
        if t != NONE {
            self.twin[t as usize] = h;
        }
    }
}
