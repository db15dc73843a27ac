//! One point walks straight to a new place while all others stay; edges are swapped in time, so no triangle folds.
//!
//! WARP 3.2: the first share of the way at which the walker stands on the line of an edge of its link is the invalid
//! point. An edge there of which the walker is between the ends is swapped itself (lemma 1); where the walker is beyond
//! an end, the spoke to the other, farther end is swapped, the farthest first where edges are in one line (lemmas 2 to 4).
//! Just before that point the two triangles form a convex quadrilateral, so the walker need not stop: swaps happen at
//! the moment itself, and shares of the way are compared as fractions. A walker that would come upon a point steps aside
//! on its way (lemma 5, with the walker in place of the one it meets, who then need not move back).

use super::super::orientation::orientation;
use super::meeting::{Place, Way};
use super::triangulation::{Swap, Triangulation, following, leading};
use glam::DVec2;
use num_rational::BigRational;

/// Why a walker cannot get where it should.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    /// Another point stands at the end of the way.
    Occupied(u32),
    /// The end lies outside of the hull or on it, or the walker is on the hull.
    Outside,
}

/// How far aside a walker steps that would come upon a point, as shares of its way: the first that works counts.
const ASIDE: [f64; 12] =
    [0.01, -0.01, 0.023, -0.023, 0.0037, -0.0037, 0.0511, -0.0511, 0.00071, -0.00071, 0.117, -0.117];

/// What stops a straight walk.
enum Stop {
    /// The walker comes upon a point before its end.
    Upon,
    /// It cannot get there at all.
    At(Obstacle),
}

impl Triangulation {
    /// Moves an inner point to `to` and returns the edges swapped on the way, in order.
    ///
    /// Before and after, all triangles are exactly counter-clockwise; on an error nothing has changed.
    pub fn march(&mut self, v: u32, to: DVec2) -> Result<Vec<Swap>, Obstacle> {
        let from = self.point(v);
        match self.straight(v, to) {
            Ok(swaps) => return Ok(swaps),
            Err(Stop::At(obstacle)) => return Err(obstacle),
            Err(Stop::Upon) => {}
        }
        let along = to - from;
        for share in ASIDE {
            let aside = from + along * (0.5 + share) + along.perp() * share;
            let mut trial = self.clone();
            let Ok(mut swaps) = trial.straight(v, aside) else { continue };
            match trial.straight(v, to) {
                Ok(rest) => {
                    swaps.extend(rest);
                    *self = trial;
                    return Ok(swaps);
                }
                Err(Stop::At(obstacle)) => return Err(obstacle),
                Err(Stop::Upon) => {}
            }
        }
        Err(Obstacle::Outside)
    }

    fn straight(&mut self, v: u32, to: DVec2) -> Result<Vec<Swap>, Stop> {
        let way = Way { from: self.point(v), to };
        let link = self.link(v);
        if link.is_empty() || !to.is_finite() {
            return Err(Stop::At(Obstacle::Outside));
        }
        if link.iter().all(|&h| self.sees(h, to)) {
            self.put(v, to);
            return Ok(Vec::new());
        }
        let mut trial = self.clone();
        let mut swaps = Vec::new();
        while let Some(edge) = trial.next_swap(v, &way)? {
            if trial.is_hull(edge) {
                return Err(Stop::At(Obstacle::Outside));
            }
            swaps.push(trial.swap(edge));
        }
        trial.put(v, to);
        *self = trial;
        Ok(swaps)
    }

    /// True if `p` lies left of half-edge `h`.
    fn sees(&self, h: u32, p: DVec2) -> bool {
        let [a, b] = self.ends(h);
        orientation(p, a, b) > 0.0
    }

    fn ends(&self, h: u32) -> [DVec2; 2] {
        [self.point(self.from(h)), self.point(self.from(following(h)))]
    }

    /// The edge to be swapped for the walker to pass its next invalid point; none if there is none before the end.
    fn next_swap(&self, v: u32, way: &Way) -> Result<Option<u32>, Stop> {
        let link = self.link(v);
        let outside = || Stop::At(Obstacle::Outside);
        let mut first: Option<BigRational> = None;
        let mut met = vec![false; link.len()];
        for (i, &h) in link.iter().enumerate() {
            if self.sees(h, way.to) {
                continue;
            }
            let [p, q] = self.ends(h);
            let share = way.meets(p, q).ok_or_else(outside)?;
            if first.as_ref().is_none_or(|f| share < *f) {
                met[..i].fill(false);
                first = Some(share.clone());
            }
            met[i] = first.as_ref() == Some(&share);
        }
        let Some(share) = first else { return Ok(None) };
        let mut between = None;
        for i in (0..link.len()).filter(|&i| met[i]) {
            let [p, q] = self.ends(link[i]);
            let (before, after) = (met[(i + link.len() - 1) % link.len()], met[(i + 1) % link.len()]);
            match way.place(&share, p, q).ok_or_else(outside)? {
                Place::First => return Err(self.stop_at(way, self.from(link[i]))),
                Place::Second => return Err(self.stop_at(way, self.from(following(link[i])))),
                Place::Between => between = Some(link[i]),
                // The spokes to the ends run along the two other sides of the walker's triangle at the edge.
                Place::BeforeFirst if !after => return Ok(Some(following(link[i]))),
                Place::AfterSecond if !before => return Ok(Some(leading(link[i]))),
                Place::BeforeFirst | Place::AfterSecond => {}
            }
        }
        between.map(Some).ok_or_else(outside)
    }

    fn stop_at(&self, way: &Way, u: u32) -> Stop {
        if self.point(u) == way.to { Stop::At(Obstacle::Occupied(u)) } else { Stop::Upon }
    }
}
