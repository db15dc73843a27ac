//! Features that cannot walk are carried to their places: a base mesh over the places takes them along (base.rs).
//!
//! All at once, if paths need not wind too much for that. Otherwise first those that have not far to go, fewer of them if
//! paths would wind too much again, then the others one at a time: paths wind around what is carried far, and where the
//! ways of two cross as often as both numbers multiplied. In between the disc is relaxed, and does without most of the
//! vertices that paths needed. If double precision cannot hold that, all are carried at once after all.

use super::base::place_by_paths;
use super::refined::Refined;
use super::relax::{Relaxation, relax};
use super::sheet::Sheet;
use super::{ConstrainReport, stretch_of};
use crate::error::Result;
use crate::gpu::Compute;
use glam::DVec2;

/// Rounds of relaxation between attempts to take Steiner vertices out.
const ROUNDS: usize = 3;
/// Such attempts every time that features are carried.
const ATTEMPTS: usize = 6;
/// All are carried at once if paths add no more than so many times the vertices: with more they wind around each other, which
/// takes long and leaves triangles that no relaxation gets open again.
const MOST: usize = 3;
/// The same when some go and others wait: with more, those that have far to go wait as well.
const MOST_IN_TURN: usize = 12;
/// An E_L2 with which taking turns is not tried.
const GOOD: f64 = 6.0;
/// While features are still to be carried, a mean squared stretch around a Steiner vertex that is no reason to keep it: with
/// less more stay, for paths to wind through; with more triangles are crushed that no relaxation gets open again.
const FAIR: f64 = 100.0;
/// In the end the fewest vertices are worth it if E_L2 grows by no more than this factor.
const PRICE: f64 = 1.5;
/// Rounds of relaxation before the two are compared.
const LAST_ROUNDS: usize = 8;
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
    let whole =
        place_by_paths(flat, &places(&flat.sheet), MOST).ok().map(|w| finished(w, compute, report)).transpose()?;
    match whole {
        Some(whole) if stretch_of(&whole.sheet) <= GOOD => Ok(whole),
        None => carry_in_turn(flat, compute, report),
        Some(whole) => {
            let turns = carry_in_turn(flat, compute, report)?;
            Ok(if stretch_of(&turns.sheet) < stretch_of(&whole.sheet) { turns } else { whole })
        }
    }
}

/// Carries them a few at a time.
fn carry_in_turn(flat: &Refined, compute: &Compute, report: &mut ConstrainReport) -> Result<Refined> {
    let mut refined = flat.clone();
    while !refined.sheet.is_met() {
        let together = place_by_paths(&refined, &next_places(&refined.sheet, Reach::Mean), MOST_IN_TURN);
        let carried = together
            .or_else(|_| place_by_paths(&refined, &next_places(&refined.sheet, Reach::Median), usize::MAX))
            .or_else(|_| place_by_paths(flat, &places(&flat.sheet), usize::MAX));
        refined = carried?;
        report.carried += 1;
        report.steiner[0] += refined.steiner.len();
        tidy(&mut refined, compute, FAIR)?;
    }
    thin(refined, compute)
}

/// A disc in which all were carried at once, relaxed, with the Steiner vertices that it needs.
fn finished(mut refined: Refined, compute: &Compute, report: &mut ConstrainReport) -> Result<Refined> {
    report.carried += 1;
    report.steiner[0] += refined.steiner.len();
    tidy(&mut refined, compute, FAIR)?;
    thin(refined, compute)
}

fn places(sheet: &Sheet) -> Vec<DVec2> {
    sheet.features.iter().map(|f| f.place).collect()
}

/// Where every feature goes next: to its place, or nowhere.
///
/// To their places go those that have not far to go, the nearest of the others if all those are there, those in the way of
/// these, and so on.
fn next_places(sheet: &Sheet, reach: Reach) -> Vec<DVec2> {
    let to = places(sheet);
    let at: Vec<DVec2> = sheet.features.iter().map(|f| sheet.uv[f.vertex as usize]).collect();
    let way = |i: usize| at[i].distance(to[i]);
    let room: Vec<f64> = (0..to.len()).map(|i| apart(&to, i)).collect();
    let reach = TOGETHER
        * match reach {
            Reach::Mean => 1.0 / (to.len() as f64).sqrt(),
            Reach::Median => median(&room),
        };
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

/// How far features may have to go to their places to go together, in [`TOGETHER`]'s unit.
#[derive(Clone, Copy)]
enum Reach {
    /// The distance of places were they spread evenly over the image: of scattered ones most have another much nearer, and
    /// would take turns without need.
    Mean,
    /// The median distance from a place to the next one.
    Median,
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
fn tidy(refined: &mut Refined, compute: &Compute, most: f64) -> Result<()> {
    for _ in 0..ATTEMPTS {
        settle(refined, compute, ROUNDS)?;
        if refined.steiner.is_empty() {
            break;
        }
        refined.take_out(most);
    }
    settle(refined, compute, ROUNDS)
}

/// Takes out all Steiner vertices whose going folds nothing, unless the whole is much the worse for it.
fn thin(refined: Refined, compute: &Compute) -> Result<Refined> {
    if refined.steiner.is_empty() {
        return Ok(refined);
    }
    let mut thinner = refined.clone();
    tidy(&mut thinner, compute, f64::INFINITY)?;
    settle(&mut thinner, compute, LAST_ROUNDS)?;
    Ok(if stretch_of(&thinner.sheet) <= PRICE * stretch_of(&refined.sheet) { thinner } else { refined })
}

fn settle(refined: &mut Refined, compute: &Compute, rounds: usize) -> Result<()> {
    let weight = vec![1.0; refined.sheet.triangles.len()];
    relax(&mut refined.sheet, compute, &Relaxation { weight: &weight, rounds, crushed: true })
}

#[cfg(test)]
mod tests {
    use super::super::sheet::Feature;
    use super::*;

    /// Features 0 to 3 in a row, `to` being where they belong.
    fn row(to: [f64; 4]) -> Sheet {
        let at = [0.2, 0.4, 0.6, 0.8].map(|x| DVec2::new(x, 0.5));
        let place = |x: f64| DVec2::new(x, 0.5);
        Sheet {
            points: Vec::new(),
            triangles: Vec::new(),
            real: 0,
            uv: at.to_vec(),
            boundary: Vec::new(),
            features: (0..4).map(|i| Feature { vertex: i, place: place(to[i as usize]) }).collect(),
            ring: Vec::new(),
        }
    }

    #[test]
    fn first_go_those_that_have_not_far_to_go() {
        let next = next_places(&row([0.25, 0.45, 0.65, 0.05]), Reach::Median);
        assert_eq!(next.iter().map(|p| p.x).collect::<Vec<_>>(), [0.25, 0.45, 0.65, 0.8]);
    }

    #[test]
    fn to_crowded_places_all_go_that_would_go_to_even_ones() {
        let sheet = row([0.55, 0.56, 0.57, 0.62]);
        let x = |reach| next_places(&sheet, reach).iter().map(|p| p.x).collect::<Vec<_>>();
        assert_eq!(x(Reach::Median), [0.2, 0.4, 0.57, 0.8]);
        assert_eq!(x(Reach::Mean), [0.55, 0.56, 0.57, 0.62]);
    }

    #[test]
    fn who_goes_far_takes_those_in_the_way_along() {
        let next = next_places(&row([0.8, 0.4, 0.6, 0.2]), Reach::Median);
        assert_eq!(next.iter().map(|p| p.x).collect::<Vec<_>>(), [0.8, 0.4, 0.6, 0.2]);
        let next = next_places(&row([0.92, 0.4, 0.6, 0.05]), Reach::Median);
        assert_eq!(next.iter().map(|p| p.x).collect::<Vec<_>>(), [0.92, 0.4, 0.6, 0.8]);
    }
}
