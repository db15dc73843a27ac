//! Features that cannot walk are carried to their places: a base mesh over the places takes them along (base.rs).
//!
//! First those that have not far to go, then the others one at a time: paths wind around what is carried far, and where the
//! ways of two cross as often as both numbers multiplied. In between the disc is relaxed, and does without most of the
//! vertices that paths needed. If double precision cannot hold that, all are carried at once.

use super::ConstrainReport;
use super::base::place_by_paths;
use super::refined::Refined;
use super::relax::{Relaxation, relax};
use super::sheet::Sheet;
use crate::error::Result;
use crate::gpu::Compute;
use glam::DVec2;

/// Rounds of relaxation between attempts to take Steiner vertices out.
const ROUNDS: usize = 3;
/// Such attempts every time that features are carried.
const ATTEMPTS: usize = 6;
/// Features that have no farther to go than this, in distances of neighbouring places, all go at once. With more, paths
/// around some of them cross; with less, those that could go together take turns.
const TOGETHER: f64 = 1.5;
/// A feature nearer to another's place than this share of the distance from there to the next place is in its way. At a
/// half two places would claim a feature; with less, base triangles get so small that what they hold is crowded.
const NEAR: f64 = 0.3;

/// Carries the features of a disc that has not been crowded yet to their places.
///
/// # Errors
/// Unsolvable if double precision cannot hold the result.
pub fn carry(flat: &Refined, compute: &Compute, report: &mut ConstrainReport) -> Result<Refined> {
    let mut refined = flat.clone();
    while !refined.sheet.is_met() {
        let carried = place_by_paths(&refined, &next_places(&refined.sheet));
        refined = carried.or_else(|_| place_by_paths(flat, &places(&flat.sheet)))?;
        report.carried += 1;
        report.steiner[0] += refined.steiner.len();
        tidy(&mut refined, compute)?;
    }
    Ok(refined)
}

fn places(sheet: &Sheet) -> Vec<DVec2> {
    sheet.features.iter().map(|f| f.place).collect()
}

/// Where every feature goes next: to its place, or nowhere.
///
/// To their places go those that have not far to go, the nearest of the others if all those are there, those in the way of
/// these, and so on.
fn next_places(sheet: &Sheet) -> Vec<DVec2> {
    let to = places(sheet);
    let at: Vec<DVec2> = sheet.features.iter().map(|f| sheet.uv[f.vertex as usize]).collect();
    let way = |i: usize| at[i].distance(to[i]);
    let room: Vec<f64> = (0..to.len()).map(|i| apart(&to, i)).collect();
    let reach = TOGETHER * median(&room);
    let (near, far): (Vec<usize>, Vec<usize>) = (0..to.len()).filter(|&i| way(i) > 0.0).partition(|&i| way(i) < reach);
    let nearest = far.into_iter().min_by(|&i, &j| way(i).total_cmp(&way(j)));
    let mut next = if near.is_empty() { nearest.into_iter().collect() } else { near };
    let mut goes: Vec<bool> = (0..to.len()).map(|i| way(i) == 0.0 || next.contains(&i)).collect();
    while let Some(i) = next.pop() {
        let in_the_way: Vec<usize> =
            (0..to.len()).filter(|&j| !goes[j] && at[j].distance(to[i]) < NEAR * room[i]).collect();
        in_the_way.iter().for_each(|&j| goes[j] = true);
        next.extend(in_the_way);
    }
    (0..to.len()).map(|i| if goes[i] { to[i] } else { at[i] }).collect()
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

/// The distance from a place to the next one.
fn apart(places: &[DVec2], i: usize) -> f64 {
    let others = (0..places.len()).filter(|&j| j != i);
    others.map(|j| places[i].distance(places[j])).fold(1.0, f64::min)
}

/// Relaxes a disc in which features were carried and takes out the Steiner vertices that it can do without then.
fn tidy(refined: &mut Refined, compute: &Compute) -> Result<()> {
    for _ in 0..ATTEMPTS {
        let weight = vec![1.0; refined.sheet.triangles.len()];
        relax(&mut refined.sheet, compute, &Relaxation { weight: &weight, rounds: ROUNDS })?;
        if refined.steiner.is_empty() {
            break;
        }
        refined.take_out();
    }
    Ok(())
}
