//! Foldover-free warping of a plane triangulation: points walk to prescribed places, edges are swapped before triangles
//! fold (Lee, Yen, Yeh: Texture Mapping with Hard Constraints Using Warping Scheme, section 3).
//!
//! ```text
//! all walkers, a step each, again and again:
//!   march.rs    one walker, straight: invalid points, which edge to swap there, stepping aside
//!   meeting.rs  when it meets the line of an edge, and where along it, in fractions
//!   triangulation.rs    the triangles and their swaps
//! ```
//!
//! Every decision is exact, so for finite coordinates the walk ends: on a straight way the walker crosses the line
//! through two other points once, and an edge is swapped at most once for it.

mod march;
mod meeting;
mod triangulation;

pub use march::Obstacle;
pub use triangulation::{Swap, Triangulation};

use glam::DVec2;

/// A point and where it must go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walker {
    /// The point's number.
    pub point: u32,
    /// Its place at the end.
    pub to: DVec2,
}

/// How a warp proceeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WarpOptions {
    /// Into how many steps every way is divided. Walkers take turns, so more steps come nearer to all walking at once,
    /// which swaps fewer edges; 1 sends one after the other. Default 32.
    pub steps: u32,
    /// Once so many edges are swapped the walkers stop where they are, between two steps. Default: none stops early.
    pub swaps: usize,
    /// They only stop where every triangle is at least so high. Default 0.
    pub room: f64,
}

impl Default for WarpOptions {
    fn default() -> Self {
        WarpOptions { steps: 32, swaps: usize::MAX, room: 0.0 }
    }
}

/// Rounds over walkers whose places others hold before the warp is given up; every round brings at least one home.
const SPARE_ROUNDS: usize = 8;

/// Moves all walkers, inner points with different places inside of the hull, to their places, exactly, or until enough
/// edges are swapped.
///
/// Returns the edges swapped, in order. Fails, naming the walker and what stops it, if two places are equal or one is
/// not inside; the triangulation is then valid still, with the others under way.
pub fn warp(
    triangulation: &mut Triangulation,
    walkers: &[Walker],
    options: &WarpOptions,
) -> Result<Vec<Swap>, (u32, Obstacle)> {
    let start: Vec<DVec2> = walkers.iter().map(|w| triangulation.point(w.point)).collect();
    let mut swaps = Vec::new();
    for k in 1..options.steps {
        if swaps.len() >= options.swaps && triangulation.least_height() >= options.room {
            return Ok(swaps);
        }
        let share = f64::from(k) / f64::from(options.steps);
        for (walker, &from) in walkers.iter().zip(&start) {
            // A walker that cannot make this step catches up with a later one.
            swaps.extend(triangulation.march(walker.point, from.lerp(walker.to, share)).unwrap_or_default());
        }
    }
    let mut left: Vec<Walker> = walkers.to_vec();
    for _ in 0..walkers.len() + SPARE_ROUNDS {
        let before = left.len();
        let mut stuck = None;
        left.retain(|w| match triangulation.march(w.point, w.to) {
            Ok(more) => {
                swaps.extend(more);
                false
            }
            Err(obstacle) => {
                stuck = stuck.or(Some((w.point, obstacle)));
                true
            }
        });
        match stuck {
            None => return Ok(swaps),
            Some((_, Obstacle::Occupied(holder))) if left.len() == before => {
                let may_leave = left.iter().any(|w| w.point == holder);
                swaps.extend(may_leave.then(|| triangulation.give_way(holder)).flatten().unwrap_or_default());
            }
            Some(_) => {}
        }
    }
    let w = left[0];
    Err((w.point, triangulation.march(w.point, w.to).err().unwrap_or(Obstacle::Outside)))
}

impl Triangulation {
    /// Lets a point make room for another: it goes some of the way into one of its triangles.
    fn give_way(&mut self, v: u32) -> Option<Vec<Swap>> {
        let ring = self.ring(v);
        let p = self.point(v);
        (0..ring.len()).find_map(|i| {
            let [a, b] = [0, 1].map(|k| self.point(ring[(i + k) % ring.len()]));
            self.march(v, p.lerp((p + a + b) / 3.0, 0.25)).ok()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::SplitMix;
    use std::f64::consts::TAU;

    /// A fan of `n` hull points around the origin, and one inner point.
    fn wheel(n: u32) -> Triangulation {
        let spoke = |i: u32| DVec2::from_angle(TAU * f64::from(i) / f64::from(n)) * 4.0;
        let points = (0..n).map(spoke).chain([DVec2::ZERO]).collect();
        let triangles: Vec<[u32; 3]> = (0..n).map(|i| [n, i, (i + 1) % n]).collect();
        Triangulation::new(points, &triangles).expect("a wheel is a triangulation")
    }

    /// Square of `2 n` by `2 n` cells around the origin with its diagonals; returns the inner points as well.
    fn square(n: i32) -> (Triangulation, Vec<u32>) {
        let side = 2 * n + 1;
        let points = (0..side * side).map(|k| DVec2::new(f64::from(k % side - n), f64::from(k / side - n)));
        let cells = (0..4 * n * n).map(|k| (k / (2 * n) * side + k % (2 * n)) as u32);
        let s = side as u32;
        let triangles: Vec<[u32; 3]> = cells.flat_map(|c| [[c, c + 1, c + s + 1], [c, c + s + 1, c + s]]).collect();
        let inner = (0..side * side).filter(|k| [k % side, k / side].iter().all(|&x| x > 0 && x < side - 1));
        let triangulation = Triangulation::new(points.collect(), &triangles).expect("a grid is a triangulation");
        (triangulation, inner.map(|k| k as u32).collect())
    }

    fn euler(t: &Triangulation) -> (usize, usize) {
        (t.points().len(), t.triangles().count())
    }

    #[test]
    fn within_its_ring_a_point_walks_without_swaps() {
        let mut t = wheel(6);
        assert_eq!(t.march(6, DVec2::new(0.5, 0.25)), Ok(vec![]));
        assert!(t.is_valid() && t.point(6) == DVec2::new(0.5, 0.25));
    }

    /// Lemma 1: straight through an edge. Lemma 2 to 4: beyond the ends of edges in one line with the walker.
    #[test]
    fn along_grid_lines_and_diagonals_all_swaps_are_possible() {
        for to in [[1.5, 0.0], [1.5, 1.5], [1.25, 0.5], [0.5, 1.25], [-1.5, 0.75], [1.0, 0.5], [-0.5, 1.0]] {
            let (mut t, inner) = square(3);
            let centre = inner[inner.len() / 2];
            let (size, to) = (euler(&t), DVec2::from_array(to));
            t.march(centre, to).unwrap_or_else(|o| panic!("{to}: {o:?}"));
            assert!(t.is_valid() && t.point(centre) == to && euler(&t) == size, "{to}");
        }
    }

    /// Lemma 5: another point stands on the way.
    #[test]
    fn a_walker_goes_around_points_on_its_way() {
        let (mut t, inner) = square(4);
        let centre = inner[inner.len() / 2];
        let before = t.points().to_vec();
        for to in [[2.5, 0.0], [-2.5, -2.5], [0.0, 2.0625]] {
            let to = DVec2::from_array(to);
            t.march(centre, to).expect("nothing stands at the end");
            assert!(t.is_valid() && t.point(centre) == to);
        }
        let others = (0..before.len()).filter(|&v| v != centre as usize);
        assert!(others.into_iter().all(|v| t.points()[v] == before[v]), "only the walker moves");
    }

    #[test]
    fn what_cannot_be_reached_is_refused_and_nothing_changes() {
        let (mut t, inner) = square(2);
        let centre = inner[inner.len() / 2];
        let before = t.clone();
        assert_eq!(t.march(centre, DVec2::new(1.0, 0.0)), Err(Obstacle::Occupied(centre + 1)));
        assert_eq!(t.march(centre, DVec2::new(2.0, 0.25)), Err(Obstacle::Outside));
        assert_eq!(t.march(centre, DVec2::new(9.0, 0.3)), Err(Obstacle::Outside));
        assert_eq!(t.march(centre, DVec2::new(f64::NAN, 0.3)), Err(Obstacle::Outside));
        assert_eq!(t.march(0, DVec2::new(0.1, 0.1)), Err(Obstacle::Outside));
        assert!(t.triangles().eq(before.triangles()) && t.points() == before.points());
    }

    /// Points exchange places in pairs, turn, are mirrored, and are thrown about, on the worst of all grids.
    #[test]
    fn walkers_reach_any_places_exactly() {
        for seed in 0..60 {
            let mut random = SplitMix::new(seed);
            let (mut t, inner) = square(3);
            let (size, mut places): (_, Vec<DVec2>) = (euler(&t), inner.iter().map(|&v| t.point(v)).collect());
            match seed % 4 {
                0 => places.reverse(),
                1 => places.iter_mut().for_each(|p| p.x = -p.x),
                2 => (0..places.len()).for_each(|i| places.swap(i, random.below(25))),
                _ => places.iter_mut().for_each(|p| {
                    *p = DVec2::new(random.unit(), random.unit()) * 5.8 - 2.9;
                }),
            }
            let walkers: Vec<Walker> = inner.iter().zip(&places).map(|(&point, &to)| Walker { point, to }).collect();
            let options = WarpOptions { steps: [1, 7, 32][seed as usize % 3], ..WarpOptions::default() };
            let swaps = warp(&mut t, &walkers, &options).unwrap_or_else(|e| panic!("seed {seed}: {e:?}"));
            assert!(t.is_valid() && euler(&t) == size, "seed {seed}");
            assert!(!swaps.is_empty() && walkers.iter().all(|w| t.point(w.point) == w.to), "seed {seed}");
        }
    }

    #[test]
    fn after_so_many_swaps_walkers_stop_and_can_go_on() {
        let (mut t, inner) = square(3);
        let walkers: Vec<Walker> =
            inner.iter().rev().zip(&inner).map(|(&point, &v)| Walker { point, to: t.point(v) }).collect();
        let few = warp(&mut t, &walkers, &WarpOptions { swaps: 3, ..WarpOptions::default() }).expect("no obstacle");
        assert!(few.len() >= 3 && t.is_valid());
        assert!(walkers.iter().any(|w| t.point(w.point) != w.to), "some are still under way");
        warp(&mut t, &walkers, &WarpOptions::default()).expect("the places differ");
        assert!(t.is_valid() && walkers.iter().all(|w| t.point(w.point) == w.to));
    }

    #[test]
    fn swaps_repeated_give_the_same_triangles() {
        let (mut t, inner) = square(3);
        let mut other = t.clone();
        let walkers: Vec<Walker> =
            inner.iter().rev().zip(&inner).map(|(&point, &v)| Walker { point, to: t.point(v) }).collect();
        let swaps = warp(&mut t, &walkers, &WarpOptions::default()).expect("the places differ");
        assert!(swaps.iter().all(|swap| other.repeat(swap)));
        assert!(t.triangles().eq(other.triangles()));
        assert!(!other.repeat(&Swap { old: [0, 1], new: [8, 9] }), "the hull stays");
    }

    #[test]
    fn around_a_point_on_the_hull_come_first_the_next_and_last_the_one_before() {
        let t = wheel(5);
        assert_eq!(t.ring(0), [1, 5, 4]);
        assert_eq!(t.ring(5).len(), 5);
    }

    #[test]
    fn places_that_all_but_coincide_are_told_apart() {
        let (mut t, inner) = square(2);
        let near = |i: usize| DVec2::new(0.3 + f64::EPSILON * i as f64, 0.3);
        let walkers: Vec<Walker> = (0..4).map(|i| Walker { point: inner[2 * i], to: near(i) }).collect();
        warp(&mut t, &walkers, &WarpOptions::default()).expect("the places differ");
        assert!(t.is_valid() && walkers.iter().all(|w| t.point(w.point) == w.to));
    }

    #[test]
    fn two_walkers_to_one_place_are_refused() {
        let (mut t, inner) = square(2);
        let to = DVec2::new(0.25, 0.5);
        let walkers = [inner[0], inner[7]].map(|point| Walker { point, to });
        assert_eq!(warp(&mut t, &walkers, &WarpOptions::default()), Err((inner[7], Obstacle::Occupied(inner[0]))));
        assert!(t.is_valid());
    }
}
