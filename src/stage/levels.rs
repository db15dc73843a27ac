//! Domains relaxed from coarse to fine, side by side.
//!
//! Input: both meshes' parts of any number of domains. Output: the same, moved. At every level the vertices of either
//! mesh move over the other in turn, seen at the middles of triangles: single moves on the compute device, all domains in
//! one batch, then a Newton step for a domain at once. Domains need not be at the same level, and none sees the others.
//! Invariant: no triangle turns over, and no exchange raises the energy as it is seen.

use crate::deadline;
use crate::error::Result;
use crate::gpu::Compute;
use crate::kernel::{Piece, Sight, sweep_all};
use crate::plane::domain::Domain;
use crate::plane::hierarchy::Hierarchy;
use crate::plane::newton::newton;
use crate::plane::smooth::Smoother;
use rayon::prelude::*;

/// Vertices that may move at the coarsest level of a domain: fewer miss what limbs and ears look like, more cost time.
const COARSEST: usize = 50;
/// Most exchanges of the meshes' roles at the coarsest level, which does most of the work for next to no time.
const COARSEST_EXCHANGES: usize = 12;
/// Exchanges at the levels between.
const EXCHANGES: usize = 2;
/// Exchanges with all vertices; polishing does the rest better.
const FINEST_EXCHANGES: usize = 1;
/// A level is done when an exchange lowers its energy by less than this share.
const SETTLED: f64 = 0.02;
/// Newton steps are made while no more vertices than this can move: they carry errors far, which is done by then, and what
/// triangles see at their middles is too rough for them.
const NEWTON_UP_TO: usize = 300;
/// A domain with more than this many times the energy of an isometry is crushed somewhere.
pub(super) const CRUSHED: f64 = 3.0;
/// There Newton steps are made up to so many vertices: single moves unfold too little.
const NEWTON_WHERE_CRUSHED: usize = 1500;
/// From level to level the vertices grow by this factor at least: with more, vertices come back too crowded to sort out.
const GROWTH: usize = 2;
/// Sweeps of single moves in one exchange.
const SWEEPS: usize = 2;

/// A domain on its way from coarse to fine.
pub(super) struct Climb {
    /// Both meshes' parts, all their vertices moved along.
    pub whole: [Domain; 2],
    /// The parts at the level reached.
    pub level: [Domain; 2],
    hierarchy: [Hierarchy; 2],
    /// For either part the vertex of the whole of every vertex.
    numbers: [Vec<u32>; 2],
    exchanges_left: usize,
    energy: f64,
    state: State,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Climbing,
    Arrived,
    /// A vertex found no way back.
    Lost,
}

/// Relaxes domains level by level, each until more than `enough` vertices can move; none for one in which a vertex finds
/// no way back. Fails on a device error.
pub(super) fn climb(compute: &Compute, domains: Vec<[Domain; 2]>, enough: usize) -> Result<Vec<Option<Climb>>> {
    let mut climbs: Vec<Climb> = domains.into_par_iter().map(Climb::new).collect();
    loop {
        let mut climbing: Vec<&mut Climb> = climbs.iter_mut().filter(|c| c.state == State::Climbing).collect();
        if climbing.is_empty() {
            break;
        }
        deadline::check()?;
        exchange(compute, &mut climbing, 0)?;
        let energies = exchange(compute, &mut climbing, 1)?;
        climbing.into_par_iter().zip(energies).for_each(|(climb, energy)| climb.note(energy, enough));
    }
    Ok(climbs.into_iter().map(|climb| (climb.state == State::Arrived).then_some(climb)).collect())
}

/// Moves mesh `k` over the other in all domains; returns the energies as they are seen.
fn exchange(compute: &Compute, climbs: &mut [&mut Climb], k: usize) -> Result<Vec<f64>> {
    let looked: Result<Vec<(Smoother, Piece)>> = climbs.par_iter_mut().map(|climb| look(climb, k)).collect();
    let (smoothers, mut pieces): (Vec<Smoother>, Vec<Piece>) = looked?.into_iter().unzip();
    sweep_all(compute, &mut pieces, SWEEPS)?;
    let finish = |(mut smoother, piece): (Smoother, Piece)| {
        smoother.adopt(piece.positions());
        let moving = smoother.moving();
        let free = moving.free.iter().filter(|free| **free).count();
        let is_crushed = smoother.energy() > CRUSHED * smoother.area();
        if free <= if is_crushed { NEWTON_WHERE_CRUSHED } else { NEWTON_UP_TO } {
            newton(&mut smoother);
        }
        smoother.settle();
        smoother.energy()
    };
    Ok(smoothers.into_par_iter().zip(pieces).map(finish).collect())
}

/// Mesh `k` over the other at the level of a domain, and what the kernel needs of it.
fn look(climb: &mut Climb, k: usize) -> Result<(Smoother<'_>, Piece)> {
    let [source, target] = &mut climb.level;
    let smoother = if k == 0 { Smoother::sampled(source, target) } else { Smoother::sampled(target, source) };
    let moving = smoother.moving();
    let sight = |t: usize| {
        let (rest, metrics) = smoother.seen(t);
        Sight::new(rest, &metrics, moving.triangle(t))
    };
    let sights = (0..moving.triangles.len()).map(sight).collect();
    let piece = Piece::new(&moving.triangles, sights, &moving.positions, &moving.free)?;
    Ok((smoother, piece))
}

impl Climb {
    fn new(whole: [Domain; 2]) -> Self {
        let hierarchy = whole.each_ref().map(|domain| Hierarchy::new(domain, COARSEST));
        let mut climb = Climb {
            whole,
            level: Default::default(),
            hierarchy,
            numbers: Default::default(),
            exchanges_left: 0,
            energy: f64::INFINITY,
            state: State::Climbing,
        };
        climb.enter(COARSEST_EXCHANGES);
        climb
    }

    fn is_finest(&self) -> bool {
        self.hierarchy.iter().all(Hierarchy::is_finest)
    }

    /// Makes the level's domains.
    fn enter(&mut self, exchanges: usize) {
        for k in 0..2 {
            (self.level[k], self.numbers[k]) = self.hierarchy[k].domain(&self.whole[k]);
        }
        self.exchanges_left = if self.is_finest() { FINEST_EXCHANGES } else { exchanges };
        self.energy = f64::INFINITY;
    }

    /// Takes note of what an exchange brought, and goes to the next level where it was the last.
    fn note(&mut self, energy: f64, enough: usize) {
        let is_settled = energy > self.energy * (1.0 - SETTLED);
        self.energy = energy;
        self.exchanges_left -= 1;
        if !is_settled && self.exchanges_left > 0 {
            return;
        }
        for k in 0..2 {
            let places = self.numbers[k].iter().zip(&self.level[k].positions);
            places.for_each(|(&v, &p)| self.whole[k].positions[v as usize] = p);
        }
        if self.is_finest() || self.hierarchy.iter().any(|level| level.free() > enough) {
            self.state = State::Arrived;
        } else if self.refine().is_some() {
            self.enter(EXCHANGES);
        } else {
            self.state = State::Lost;
        }
    }

    fn refine(&mut self) -> Option<()> {
        for (level, whole) in self.hierarchy.iter_mut().zip(&mut self.whole) {
            let enough = GROWTH * level.free();
            while !level.is_finest() && level.free() < enough {
                level.refine(whole)?;
            }
        }
        Some(())
    }
}
