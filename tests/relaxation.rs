//! Relaxation lowers the energy round by round, keeps the map and leaves nothing behind.

mod common;

use common::check;
use common::run::Pair;
use homeo::gpu::Compute;
use homeo::map::embedding::Embedding;
use homeo::mesh::{ArcId, Id, IdVec, LandmarkId, VertexId};
use homeo::shape::{Quadruped, quadruped};
use homeo::stage::flip::{flip_arc, flip_arcs};
use homeo::stage::polish::{DREAD, polish_samples};
use homeo::stage::relax::{RelaxOptions, energy, relax_arcs};

fn pair() -> Pair {
    let [bull, mule] = [quadruped(Quadruped::Bull, 900), quadruped(Quadruped::Mule, 1100)];
    let vertices = |landmarks: Vec<(String, VertexId)>| landmarks.into_iter().map(|(_, v)| v).collect();
    Pair::new((bull.mesh, vertices(bull.landmarks)), (mule.mesh, vertices(mule.landmarks)))
}

/// Vertices of mesh `k` that are no original ones and on no arc.
fn left_behind(pair: &Pair, embedding: &Embedding, k: usize) -> usize {
    let cut = &embedding.meshes[k].cut;
    cut.conn.vertices().filter(|&v| v.index() >= pair.meshes[k].positions.len() && !cut.is_blocked(v)).count()
}

#[test]
fn the_energy_falls_from_round_to_round_and_arcs_leave_little_behind() {
    let pair = pair();
    let both = [&pair.meshes[0], &pair.meshes[1]];
    let mut embedding = pair.embed().expect("an embedding");
    let all = RelaxOptions { tolerance: 0.0, ..RelaxOptions::default() };
    let energies = relax_arcs(&Compute::Cpu, both, &mut embedding, &all).expect("a relaxed map").energies;
    assert!(energies.len() > all.coarse_rounds, "{energies:?}");
    assert!(energies.windows(2).all(|w| w[1] <= w[0] * (1.0 + 1e-12)), "{energies:?}");
    assert!(energies[energies.len() - 1] < 1.0 + 0.5 * (energies[0] - 1.0), "{energies:?}");
    check::embedding(&embedding, &pair.meshes);
    for k in 0..2 {
        let left = left_behind(&pair, &embedding, k);
        assert!(left * 20 < pair.meshes[k].positions.len(), "{left} of mesh {k}");
    }
}

#[test]
fn polishing_lowers_the_energy_of_the_compatible_meshes_and_keeps_the_map() {
    let pair = pair();
    let both = [&pair.meshes[0], &pair.meshes[1]];
    let mut embedding = pair.embed().expect("an embedding");
    let short = RelaxOptions { coarse_rounds: 1, fine_rounds: 0, flips: false, ..RelaxOptions::default() };
    relax_arcs(&Compute::Cpu, both, &mut embedding, &short).expect("a relaxed map");
    let polish = polish_samples(both, &mut embedding, 0.05, &DREAD).expect("a polished map");
    let [first, last] = [polish.energies[0], polish.energies[polish.energies.len() - 1]];
    assert!(last - 1.0 < 0.8 * (first - 1.0), "{:?}", polish.energies);
    check::embedding(&embedding, &pair.meshes);
}

/// A looser tolerance ends sooner, at what a tighter one comes past as well.
#[test]
fn the_tolerance_says_when_to_stop() {
    let pair = pair();
    let both = [&pair.meshes[0], &pair.meshes[1]];
    let start = pair.embed().expect("an embedding");
    let run = |tolerance: f64| {
        let options = RelaxOptions { tolerance, fine_rounds: 0, ..RelaxOptions::default() };
        relax_arcs(&Compute::Cpu, both, &mut start.clone(), &options).expect("a relaxed map").energies
    };
    let [loose, tight] = [0.9, 0.0].map(run);
    assert!(loose.len() < tight.len(), "{loose:?} {tight:?}");
    assert_eq!(loose, tight[..loose.len()]);
}

fn ends(arcs: &IdVec<ArcId, [LandmarkId; 2]>) -> Vec<[LandmarkId; 2]> {
    let mut ends: Vec<[LandmarkId; 2]> = arcs.iter().map(|&[a, b]| [a.min(b), a.max(b)]).collect();
    ends.sort_unstable();
    ends
}

/// Every arc that can be flipped: the map is the same over another base complex, and flipped again over the same one.
#[test]
fn a_flip_changes_the_base_complex_and_not_the_map() {
    let pair = pair();
    let both = [&pair.meshes[0], &pair.meshes[1]];
    let mut embedding = pair.embed().expect("an embedding");
    let short = RelaxOptions { coarse_rounds: 1, fine_rounds: 0, flips: false, ..RelaxOptions::default() };
    relax_arcs(&Compute::Cpu, both, &mut embedding, &short).expect("a relaxed map");
    let before = energy(both, &embedding);
    let mut count = 0;
    for arc in embedding.base.arcs.ids() {
        let Some(flipped) = flip_arc(both, &embedding, arc).expect("a flip") else { continue };
        check::embedding(&flipped, &pair.meshes);
        let now = energy(both, &flipped);
        assert!((now - before).abs() < 0.01 * before, "{arc}: {before} to {now}");
        assert_ne!(ends(&flipped.base.arcs), ends(&embedding.base.arcs), "{arc}");
        if let Some(back) = flip_arc(both, &flipped, arc).expect("a flip") {
            check::embedding(&back, &pair.meshes);
            assert_eq!(ends(&back.base.arcs), ends(&embedding.base.arcs), "{arc}");
            count += 1;
        }
    }
    assert!(count > 5, "{count} arcs were flipped to and fro");
}

/// Arcs flipped by hand, until one is found that leads to more energy than its other diagonal.
#[test]
fn an_arc_that_leads_to_more_energy_is_flipped_on_both_meshes() {
    let pair = pair();
    let both = [&pair.meshes[0], &pair.meshes[1]];
    let mut embedding = pair.embed().expect("an embedding");
    let short = RelaxOptions { coarse_rounds: 1, fine_rounds: 0, flips: false, ..RelaxOptions::default() };
    relax_arcs(&Compute::Cpu, both, &mut embedding, &short).expect("a relaxed map");
    let mut arcs = embedding.base.arcs.ids();
    let found = arcs.find_map(|arc| {
        let bad = flip_arc(both, &embedding, arc).expect("a flip")?;
        let mut better = bad.clone();
        let count = flip_arcs(&Compute::Cpu, both, &mut better).expect("flips");
        (count > 0).then_some((bad, better))
    });
    let (bad, better) = found.expect("one of the arcs is better as it was");
    check::embedding(&better, &pair.meshes);
    assert!(energy(both, &better) < energy(both, &bad));
    assert_ne!(ends(&better.base.arcs), ends(&bad.base.arcs));
}
