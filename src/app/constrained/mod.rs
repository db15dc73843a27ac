//! Texture coordinates that put vertices exactly where the user wants them, without a folded triangle (Lee, Yen, Yeh:
//! Texture Mapping with Hard Constraints Using Warping Scheme).
//!
//! ```text
//! start.rs     the disc laid flat, relaxed, aligned with its features' places
//! walk.rs      features walk there, the mesh giving way            all there: no vertex is added
//! base.rs      otherwise a base mesh is warped in their stead      network.rs, route.rs: its edges as paths
//! refined.rs   vertices that paths added are taken out again
//! relax.rs     triangles take the shapes they have in space, most of all near features
//! ```
//!
//! Input: a disc with features. Output: a place in the plane for every vertex. Invariant, checked exactly at every step: no
//! triangle is folded; at the end every feature is at its place to the last bit.

pub mod base;
pub mod disc;
mod files;
pub mod job;
mod network;
mod preview;
pub mod refined;
mod relax;
mod route;
mod seam;
pub mod sheet;
mod start;
mod walk;
mod weight;

use crate::error::Result;
use crate::gpu::Compute;
use crate::mesh::metric;
use crate::plane::stretch::{e_l2, l2_sq};
use base::warp_sheet;
use refined::Refined;
use relax::{Relaxation, relax};
use serde::Serialize;
use sheet::Sheet;
use weight::near_features;

/// Rounds of relaxation between attempts to take Steiner vertices out.
const ROUNDS: usize = 3;
/// Such attempts at most.
const ATTEMPTS: usize = 6;
/// Rounds of relaxation at the end.
const LAST_ROUNDS: usize = 8;

/// What was done to meet the constraints.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ConstrainReport {
    /// Features that walked all the way, or had to be warped.
    pub warped: bool,
    /// Swaps of base mesh edges.
    pub swaps: usize,
    /// Steiner vertices that paths needed, and those that stayed.
    pub steiner: [usize; 2],
    /// E_L2 once the constraints were met, and after smoothing.
    pub e_l2: [f64; 2],
}

/// Meets the constraints.
///
/// # Errors
/// Unsolvable if double precision cannot hold the result; device errors.
pub fn constrain(mut sheet: Sheet, compute: &Compute) -> Result<(Refined, ConstrainReport)> {
    start::start(&mut sheet, compute)?;
    let mut report = ConstrainReport::default();
    let mut refined = if walk::walk(&mut sheet, compute)? {
        Refined::unrefined(sheet)
    } else {
        let (refined, warped) = warp_sheet(&sheet)?;
        (report.warped, report.swaps) = (true, warped.swaps);
        refined
    };
    report.steiner[0] = refined.steiner.len();
    report.e_l2[0] = stretch_of(&refined.sheet);
    for _ in 0..ATTEMPTS {
        if refined.steiner.is_empty() {
            break;
        }
        refined.take_out();
        let weight = vec![1.0; refined.sheet.triangles.len()];
        relax(&mut refined.sheet, compute, &Relaxation { weight: &weight, rounds: ROUNDS })?;
    }
    refined.take_out();
    let weight = near_features(&refined.sheet);
    relax(&mut refined.sheet, compute, &Relaxation { weight: &weight, rounds: LAST_ROUNDS })?;
    report.steiner[1] = refined.steiner.len();
    report.e_l2[1] = stretch_of(&refined.sheet);
    Ok((refined, report))
}

/// E_L2 of the texture coordinates, 1 for an isometry up to scale.
pub fn stretch_of(sheet: &Sheet) -> f64 {
    let real = 0..sheet.real;
    let plane: f64 = real.clone().map(|t| metric::signed_area(sheet.planar(t))).sum();
    let stretch = real.map(|t| (l2_sq(sheet.planar(t), sheet.spatial(t)), metric::area(sheet.spatial(t))));
    e_l2(&stretch.collect::<Vec<_>>(), plane)
}
