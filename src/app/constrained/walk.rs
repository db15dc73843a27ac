//! Features walk to their places through the disc itself, the mesh giving way: no vertex is added.
//!
//! Each step is the Newton step of the relaxation with the features' ways prescribed, cut back before any triangle folds;
//! where that gets slow they creep. Features that would pass close by each other swerve in time, or the triangles between
//! them would be crushed. Where there is no room the way ends early; what is left is for the base mesh to warp.

use super::creep::creep;
use super::relax::{Relaxation, pull, relax};
use super::sheet::{Feature, Sheet};
use crate::error::Result;
use crate::gpu::Compute;
use glam::DVec2;

/// Steps at most.
const STEPS: usize = 40;
/// A step that goes a smaller share of what was asked is a slow one.
const SLOW: f64 = 0.05;
/// So many slow steps end the walk, and creeping begins.
const PATIENCE: usize = 3;
/// The first step asks for this share of the ways, and no later one for less than the second.
const SHARES: [f64; 2] = [1.0, 0.08];
/// The largest share of the ways that a step asks for in which features swerve.
const SWERVING: f64 = 0.2;
/// Two features keep this share of the distance that they have now or will have at the end, whichever is less.
const CLEARANCE: f64 = 0.6;
/// How much of what is missing of the clearance each of the two makes up for in a step.
const SWERVE: f64 = 0.15;
/// So often features creep at most.
const CREEPS: usize = 30;
/// Creeping ends once all features together got no nearer by this share: those that are left wait for others to make room
/// that cannot, and had better be carried. With less they crush what lies between them.
const IDLE: f64 = 0.1;

/// Walks as far as it goes; true if all features are at their places, exactly.
pub fn walk(sheet: &mut Sheet, compute: &Compute) -> Result<bool> {
    let even = vec![1.0; sheet.triangles.len()];
    let (mut slow, mut ask) = (0, SHARES[0]);
    for _ in 0..STEPS {
        if sheet.is_met() {
            return Ok(true);
        }
        let next = next_places(sheet, ask);
        let gone = pull(sheet, compute, &even, &next)?;
        slow += usize::from(gone < SLOW);
        if slow > PATIENCE {
            break;
        }
        ask = if gone == 1.0 { (ask * 2.0).min(1.0) } else { (ask * gone.max(0.5)).max(SHARES[1]) };
    }
    creep_on(sheet, compute, &even)
}

fn creep_on(sheet: &mut Sheet, compute: &Compute, even: &[f64]) -> Result<bool> {
    let left =
        |sheet: &Sheet| -> f64 { sheet.features.iter().map(|f| sheet.uv[f.vertex as usize].distance(f.place)).sum() };
    for _ in 0..CREEPS {
        let before = left(sheet);
        creep(sheet)?;
        relax(sheet, compute, &Relaxation { weight: even, rounds: 1, crushed: false })?;
        if sheet.is_met() || left(sheet) > before * (1.0 - IDLE) {
            break;
        }
    }
    Ok(sheet.is_met())
}

/// Where every feature should be after a step of a share of its way, swerving included.
fn next_places(sheet: &Sheet, ask: f64) -> Vec<Feature> {
    let at: Vec<DVec2> = sheet.features.iter().map(|f| sheet.uv[f.vertex as usize]).collect();
    let to: Vec<DVec2> = sheet.features.iter().map(|f| f.place).collect();
    let swerve = swerves(&at, &to);
    let share = if swerve.iter().any(|s| *s != DVec2::ZERO) { ask.min(SWERVING) } else { ask };
    let inside = |p: DVec2| p.clamp(DVec2::splat(0.005), DVec2::splat(0.995));
    let next = |(i, f): (usize, &Feature)| {
        // The exact place, not one that is rounded.
        let place = if share == 1.0 { f.place } else { inside(at[i] + (to[i] - at[i]) * share + swerve[i]) };
        Feature { place, ..*f }
    };
    sheet.features.iter().enumerate().map(next).collect()
}

/// How far every feature should keep aside of its way for all to pass each other.
pub fn swerves(at: &[DVec2], to: &[DVec2]) -> Vec<DVec2> {
    let mut swerve = vec![DVec2::ZERO; at.len()];
    for i in 0..at.len() {
        for j in i + 1..at.len() {
            let push = swerving(at[j] - at[i], to[j] - to[i]);
            swerve[i] -= push;
            swerve[j] += push;
        }
    }
    swerve
}

/// How far the second of two features should keep aside, and the first the other way, for them to pass each other: they
/// are `now` apart and will be `then`, all walking evenly.
fn swerving(now: DVec2, then: DVec2) -> DVec2 {
    let along = then - now;
    let when = (-now.dot(along) / along.length_squared()).clamp(0.0, 1.0);
    let nearest = now + along * if when.is_finite() { when } else { 0.0 };
    let clearance = CLEARANCE * now.length().min(then.length());
    let missing = clearance - nearest.length();
    if missing <= 0.0 {
        return DVec2::ZERO;
    }
    // Those that would meet head on pass each other on the left.
    let aside = nearest.try_normalize().filter(|_| nearest.length() > 1e-3 * clearance);
    aside.or_else(|| along.perp().try_normalize()).unwrap_or(DVec2::ZERO) * (missing * SWERVE)
}
