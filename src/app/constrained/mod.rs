//! Texture coordinates that put vertices exactly where the user wants them, without a folded triangle (Lee, Yen, Yeh:
//! Texture Mapping with Hard Constraints Using Warping Scheme).
//!
//! ```text
//! start.rs     the disc laid flat, relaxed, aligned with its features' places
//! walk.rs      features walk there, the mesh giving way; creep.rs where the whole cannot follow
//!              all there: no vertex is added
//! carry.rs     otherwise features are carried, a few at a time, by a base mesh over their places (base.rs)
//!              network.rs, route.rs: its edges as paths; refined.rs, subdivided.rs, fair.rs: the vertices they add
//! relax.rs     triangles take the shapes they have in space, most of all near features (weight.rs)
//! job.rs       from files to a folder: disc.rs, seam.rs before, files.rs, preview.rs, page.rs after
//! ```
//!
//! Input: a disc with features. Output: a place in the plane for every vertex. Invariant, checked exactly at every step: no
//! triangle is folded; at the end every feature is at its place to the last bit.

pub mod base;
mod carry;
mod creep;
pub mod disc;
mod fair;
mod files;
pub mod job;
mod network;
mod page;
mod preview;
pub mod refined;
mod relax;
mod route;
mod seam;
pub mod sheet;
mod start;
pub mod subdivided;
mod walk;
mod weight;

use crate::error::Result;
use crate::gpu::Compute;
use crate::mesh::metric;
use crate::plane::stretch::{e_l2, l2_sq};
use carry::carry;
use refined::Refined;
use relax::{Relaxation, relax};
use serde::Serialize;
use sheet::Sheet;
use weight::near_features;

/// Rounds of relaxation at the end.
const LAST_ROUNDS: usize = 8;

/// What was done to meet the constraints.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ConstrainReport {
    /// How often features that could not walk on were carried; 0 if all walked.
    pub carried: usize,
    /// Steiner vertices that paths needed, over all times, and those that stayed.
    pub steiner: [usize; 2],
    /// E_L2 once the constraints were met, and after smoothing.
    pub e_l2: [f64; 2],
}

/// Meets the constraints.
///
/// # Errors
/// Unsolvable if double precision cannot hold the result; device errors.
pub fn constrain(sheet: Sheet, compute: &Compute) -> Result<(Refined, ConstrainReport)> {
    // On a thread of the pool: from outside each of many thousand short loops would wait for it to wake up.
    rayon::scope(|_| meet(sheet, compute))
}

fn meet(mut sheet: Sheet, compute: &Compute) -> Result<(Refined, ConstrainReport)> {
    start::start(&mut sheet, compute)?;
    let mut report = ConstrainReport::default();
    let flat = Refined::unrefined(sheet);
    let mut refined = flat.clone();
    if !walk::walk(&mut refined.sheet, compute)? {
        refined = carry(&flat, compute, &mut report)?;
    }
    report.steiner[1] = refined.steiner.len();
    report.e_l2[0] = stretch_of(&refined.sheet);
    // Without features nothing has been pulled about since the start relaxed it.
    if !refined.sheet.features.is_empty() {
        smooth(&mut refined.sheet, compute)?;
    }
    report.e_l2[1] = stretch_of(&refined.sheet);
    Ok((refined, report))
}

/// Relaxes with more say for triangles near features; with the same for all if the whole gets worse for it, and not at all
/// if that is no better.
fn smooth(sheet: &mut Sheet, compute: &Compute) -> Result<()> {
    let before = sheet.clone();
    for weight in [near_features(sheet), vec![1.0; sheet.triangles.len()]] {
        relax(sheet, compute, &Relaxation { weight: &weight, rounds: LAST_ROUNDS, crushed: false })?;
        if stretch_of(sheet) <= stretch_of(&before) {
            return Ok(());
        }
        sheet.uv.clone_from(&before.uv);
    }
    Ok(())
}

/// E_L2 of the texture coordinates, 1 for an isometry up to scale.
pub fn stretch_of(sheet: &Sheet) -> f64 {
    let real = 0..sheet.real;
    let plane: f64 = real.clone().map(|t| metric::signed_area(sheet.planar(t))).sum();
    let stretch = real.map(|t| (l2_sq(sheet.planar(t), sheet.spatial(t)), metric::area(sheet.spatial(t))));
    e_l2(&stretch.collect::<Vec<_>>(), plane)
}
