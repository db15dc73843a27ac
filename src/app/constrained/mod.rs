//! Texture coordinates that put vertices exactly where the user wants them, without a folded triangle (Lee, Yen, Yeh:
//! Texture Mapping with Hard Constraints Using Warping Scheme).
//!
//! ```text
//! start.rs     the disc laid flat, relaxed, aligned with its features' places
//! walk.rs      features walk there, the mesh giving way; creep.rs where the whole cannot follow
//!              all there: no vertex is added
//! base.rs      otherwise a base mesh is warped some of the way in their stead, and the walk goes on
//!              network.rs, ruler.rs, route.rs: its edges as paths; refined.rs, subdivided.rs: the vertices they add
//! relax.rs     triangles take the shapes they have in space, most of all near features (weight.rs)
//! job.rs       from files to a folder: disc.rs, seam.rs before, files.rs, preview.rs after
//! ```
//!
//! Input: a disc with features. Output: a place in the plane for every vertex. Invariant, checked exactly at every step: no
//! triangle is folded; at the end every feature is at its place to the last bit.

pub mod base;
mod creep;
pub mod disc;
mod files;
pub mod job;
mod network;
mod preview;
pub mod refined;
mod relax;
mod route;
mod ruler;
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
use base::{grow_sheet, warp_sheet};
use network::too_fine;
use refined::Refined;
use relax::{Relaxation, relax};
use serde::Serialize;
use sheet::Sheet;
use weight::near_features;

/// Rounds of relaxation between attempts to take Steiner vertices out.
const ROUNDS: usize = 3;
/// Such attempts after every warp.
const ATTEMPTS: usize = 6;
/// Rounds of relaxation at the end.
const LAST_ROUNDS: usize = 8;
/// A warp stops after so many swaps, for the walk to go on: paths laid anew on a relaxed disc need fewer Steiner vertices
/// than those that many swaps have wound up.
const SWAPS: usize = 12;
/// So many warps stop early; the next one goes through to the end.
const WARPS: usize = 16;

/// What was done to meet the constraints.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ConstrainReport {
    /// How often features that could not walk on were warped; 0 if all walked.
    pub warps: usize,
    /// Swaps of base mesh edges.
    pub swaps: usize,
    /// Steiner vertices that paths needed, over all warps, and those that stayed.
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
    let mut refined = Refined::unrefined(sheet);
    if let Ok(mode) = std::env::var("HOMEO_MODE") {
        let t = std::time::Instant::now();
        let flat = refined.clone();
        if mode == "g" || !walk::walk(&mut refined.sheet, compute)? {
            eprintln!("walk {:?}", t.elapsed());
            let t = std::time::Instant::now();
            refined = if mode == "w" { refined } else { flat };
            refined = grow_sheet(&refined)?;
            eprintln!("grow {:?}: {} steiner, e {}", t.elapsed(), refined.steiner.len(), stretch_of(&refined.sheet));
            let t = std::time::Instant::now();
            report.steiner[0] += refined.steiner.len();
            for _ in 0..12 {
                let weight = vec![1.0; refined.sheet.triangles.len()];
                relax(&mut refined.sheet, compute, &Relaxation { weight: &weight, rounds: ROUNDS })?;
                eprint!("e {} ", stretch_of(&refined.sheet));
                refined.take_out();
                eprintln!("{:?}: {} steiner, e {}", t.elapsed(), refined.steiner.len(), stretch_of(&refined.sheet));
            }
        }
        report.steiner[1] = refined.steiner.len();
        report.e_l2[0] = stretch_of(&refined.sheet);
        smooth(&mut refined.sheet, compute)?;
        report.e_l2[1] = stretch_of(&refined.sheet);
        return Ok((refined, report));
    }
    for k in 0.. {
        let before = refined.clone();
        if walk::walk(&mut refined.sheet, compute)? || k > WARPS {
            break;
        }
        let weight = vec![1.0; refined.sheet.triangles.len()];
        relax(&mut refined.sheet, compute, &Relaxation { weight: &weight, rounds: ROUNDS })?;
        let most = if k < WARPS { SWAPS } else { usize::MAX };
        // Where features have crowded triangles beyond what can be told apart, those before the walk still can be.
        let attempts = [(&refined, most), (&before, most), (&refined, 1), (&before, 1), (&refined, 4 * SWAPS)];
        let mut first_failure = None;
        let warped = attempts.into_iter().find_map(|(from, most)| {
            let warped = warp_sheet(from, most);
            warped.map_err(|error| first_failure.get_or_insert(error).clone()).ok()
        });
        let (warped, swaps) = warped.ok_or_else(|| first_failure.unwrap_or_else(too_fine))?;
        refined = warped;
        report.warps += 1;
        report.swaps += swaps;
        report.steiner[0] += refined.steiner.len();
        tidy(&mut refined, compute)?;
    }
    if !refined.sheet.is_met() {
        return Err(too_fine());
    }
    report.steiner[1] = refined.steiner.len();
    report.e_l2[0] = stretch_of(&refined.sheet);
    smooth(&mut refined.sheet, compute)?;
    report.e_l2[1] = stretch_of(&refined.sheet);
    Ok((refined, report))
}

/// Relaxes with more say for triangles near features; with the same for all if the whole gets worse for it, and not at all
/// if that is no better.
fn smooth(sheet: &mut Sheet, compute: &Compute) -> Result<()> {
    let before = sheet.clone();
    for weight in [near_features(sheet), vec![1.0; sheet.triangles.len()]] {
        relax(sheet, compute, &Relaxation { weight: &weight, rounds: LAST_ROUNDS })?;
        if stretch_of(sheet) <= stretch_of(&before) {
            return Ok(());
        }
        sheet.uv.clone_from(&before.uv);
    }
    Ok(())
}

/// Relaxes a disc that was warped and takes out the Steiner vertices that it can do without then.
fn tidy(refined: &mut Refined, compute: &Compute) -> Result<()> {
    for _ in 0..ATTEMPTS {
        if refined.steiner.is_empty() {
            break;
        }
        refined.take_out();
        let weight = vec![1.0; refined.sheet.triangles.len()];
        relax(&mut refined.sheet, compute, &Relaxation { weight: &weight, rounds: ROUNDS })?;
    }
    refined.take_out();
    Ok(())
}

/// E_L2 of the texture coordinates, 1 for an isometry up to scale.
pub fn stretch_of(sheet: &Sheet) -> f64 {
    let real = 0..sheet.real;
    let plane: f64 = real.clone().map(|t| metric::signed_area(sheet.planar(t))).sum();
    let stretch = real.map(|t| (l2_sq(sheet.planar(t), sheet.spatial(t)), metric::area(sheet.spatial(t))));
    e_l2(&stretch.collect::<Vec<_>>(), plane)
}
