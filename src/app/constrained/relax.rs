//! Relaxation of the disc and its scaffold (WARP 4.4): every triangle wants the shape it has in space.
//!
//! The paper's phi counts the larger and the smaller singular value as what they or their reciprocals are, whichever is
//! larger; the symmetric Dirichlet energy, whose kernel this is, counts all four, is smooth, and is unbounded towards a
//! fold. Newton steps carry an error over the whole disc, sweeps clear it up around single vertices.

use super::sheet::{Feature, Framed, Sheet};
use crate::error::Result;
use crate::gpu::Compute;
use crate::kernel::sweep::Sight;
use crate::kernel::sweep_batch::{Piece, sweep_all};
use crate::mesh::metric;
use crate::plane::domain::Domain;
use crate::plane::exact_sweep::sweep_exactly;
use crate::plane::newton::{drag, newton};
use crate::plane::smooth::Smoother;
use glam::DVec2;

/// Newton steps of a round.
const STEPS: usize = 1;
/// Sweeps of a round.
const SWEEPS: usize = 2;
/// A round that lowers the energy by a smaller share is the last.
const SETTLED: f64 = 5e-3;

/// How to relax.
#[derive(Clone, Copy, Debug)]
pub struct Relaxation<'a> {
    /// How much every triangle counts for its area.
    pub weight: &'a [f64],
    /// Rounds at most; the scaffold is made anew for each.
    pub rounds: usize,
    /// Whether vertices of distorted triangles move by themselves first, in full precision: where triangles are crushed so
    /// far that the worst of them cuts back a step of all.
    pub crushed: bool,
}

/// Moves all vertices but the features so that triangles look more as they do in space; none ever folds.
pub fn relax(sheet: &mut Sheet, compute: &Compute, how: &Relaxation) -> Result<()> {
    let mut last = f64::INFINITY;
    for _ in 0..how.rounds {
        let Some(Framed { mut domain, shapes, weights }) = sheet.framed(how.weight) else { break };
        // The unit of space changes from round to round; energies by area can be compared all the same.
        let area: f64 = shapes.iter().zip(&weights).map(|(&shape, weight)| weight * metric::signed_area(shape)).sum();
        let mut smoother = Smoother::shaped(&mut domain, &shapes, &weights);
        if how.crushed {
            sweep_exactly(&mut smoother);
            smoother.look();
        }
        let stepped = (0..STEPS).filter(|_| newton(&mut smoother)).count();
        sweep(&mut smoother, compute)?;
        smoother.look();
        let energy = smoother.energy() / area;
        adopt(sheet, &domain);
        if stepped == 0 || energy > last * (1.0 - SETTLED) {
            break;
        }
        last = energy;
    }
    Ok(())
}

/// Drags the features towards places for now, the others giving way; returns the share of the way gone.
pub fn pull(sheet: &mut Sheet, compute: &Compute, weight: &[f64], to: &[Feature]) -> Result<f64> {
    let Some(Framed { mut domain, shapes, weights }) = sheet.framed(weight) else { return Ok(0.0) };
    let mut smoother = Smoother::shaped(&mut domain, &shapes, &weights);
    let places: Vec<(u32, DVec2)> = to.iter().map(|f| (f.vertex, f.place)).collect();
    let share = drag(&mut smoother, &places);
    sweep(&mut smoother, compute)?;
    Ok(if adopt(sheet, &domain) { share } else { 0.0 })
}

/// Sweeps by the kernel; vertices whose triangles would turn over in its precision stay.
fn sweep(smoother: &mut Smoother, compute: &Compute) -> Result<()> {
    smoother.look();
    let mut pieces = [piece(smoother)?];
    let Domain { positions: fixed, free, .. } = smoother.moving();
    sweep_all(compute, &mut pieces, SWEEPS)?;
    let [piece] = pieces;
    // The kernel's two floats do not hold every double: what must not move is put back exactly.
    let moved = piece.positions().into_iter().zip(fixed).zip(free).map(|((p, &q), &free)| if free { p } else { q });
    let moved = moved.collect();
    smoother.adopt(moved);
    Ok(())
}

/// What a smoother was looking at, as the kernel sweeps it.
pub fn piece(smoother: &Smoother) -> Result<Piece> {
    let Domain { triangles, positions, free, .. } = smoother.moving();
    let sight = |t: usize| {
        let (rest, metrics) = smoother.seen(t);
        Sight::new(rest, &metrics, smoother.moving().triangle(t))
    };
    Piece::new(triangles, (0..triangles.len()).map(sight).collect(), positions, free)
}

/// Takes over the positions of the disc's vertices if no triangle has folded; says whether it did.
pub fn adopt(sheet: &mut Sheet, domain: &Domain) -> bool {
    let mut uv = domain.positions[..sheet.uv.len()].to_vec();
    std::mem::swap(&mut sheet.uv, &mut uv);
    let holds = sheet.folded() == 0 && outer_holds(sheet, domain);
    if !holds {
        sheet.uv = uv;
    }
    holds
}

fn outer_holds(sheet: &Sheet, domain: &Domain) -> bool {
    (sheet.triangles.len()..domain.triangles.len()).all(|t| metric::signed_area(domain.triangle(t)) > 0.0)
}
