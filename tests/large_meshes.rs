//! Large meshes are mapped by way of simple ones: what comes back is a map of the meshes that were given.

mod common;

use common::check;
use homeo::gpu::{Compute, Device, DeviceChoice};
use homeo::map::embedding::Embedding;
use homeo::mesh::{SurfacePoint, TriMesh};
use homeo::pipeline::{MapOptions, Silent, map_pairs};
use homeo::shape::{PairOptions, Quadruped, quadruped, random_pair};
use homeo::stage::check::{Checked, check as check_pair};
use homeo::stage::cluster::cluster;
use homeo::stage::compose::compose;
use homeo::stage::embed::embed;
use homeo::stage::layout::layouts;
use homeo::stage::lift::lift;
use homeo::stage::load::Loaded;
use homeo::stage::relax::{Lifted, RelaxOptions, energy, relax_arcs, relax_lifted};
use homeo::stage::simplify::{Simple, simplify};

/// Maps the simple meshes.
fn embedding_of(Simple { checked, .. }: &Simple) -> Embedding {
    let both = checked.meshes();
    let [on_source, on_target] = checked.sites();
    let sets = cluster(both, [&on_source, &on_target], &checked.guides);
    let layout = layouts(both, &sets, 3, 1).expect("a layout").remove(0);
    let (mut embedding, _) = embed(both, layout).expect("an embedding");
    let short = RelaxOptions { coarse_rounds: 2, fine_rounds: 1, ..RelaxOptions::default() };
    relax_arcs(&Compute::Cpu, both, &mut embedding, &short).expect("a relaxed map");
    embedding
}

/// Maps a pair by way of simple meshes; returns the energy of the simple meshes' map, and what became of it.
fn map(checked: &Checked, enough: usize) -> (f64, Lifted) {
    let simple = simplify(checked, enough).expect("a pair worth simplifying");
    let on_simple = embedding_of(&simple);
    let both = checked.meshes();
    let mut embedding = lift(both, &simple.simplified, &on_simple).expect("a lifted map");
    assert_eq!(embedding.base, on_simple.base);
    let owned: [TriMesh; 2] = both.map(Clone::clone);
    check::embedding(&embedding, &owned);
    let before = energy(simple.checked.meshes(), &on_simple);
    let lifted = relax_lifted(&Compute::Cpu, both, &mut embedding, 0.01, before).expect("a relaxed map");
    check::embedding(&embedding, &owned);
    let composed = compose(both, embedding).expect("a map");
    assert!(composed.certificate.bijective, "{:?}", composed.certificate);
    let sites = checked.sites();
    for k in 0..2 {
        for (v, image) in composed.maps[k].images.iter_ids() {
            assert_eq!(image.is_some(), both[k].conn.leaving(v).is_some(), "{v} of mesh {k}");
        }
        for (&v, &w) in sites[k].iter().zip(&sites[1 - k]) {
            assert_eq!(composed.maps[k].images[v], Some(SurfacePoint::Vertex(w)), "a landmark of mesh {k}");
        }
    }
    (before, lifted)
}

fn random(genus: usize, loops: usize, seed: u64) -> Checked {
    let options = PairOptions { genus, loops, landmarks: 8, vertices: [3000, 3600], related: true };
    let pair = random_pair(&options, seed);
    let [source, target] = &pair.landmarks;
    check_pair(Loaded::of([&pair.meshes[0], &pair.meshes[1]], [source, target])).expect("a sound pair")
}

#[test]
fn maps_come_back_bijective_with_handles_and_boundaries() {
    for (genus, loops, seed) in [(0, 0, 1), (0, 2, 2), (1, 0, 3), (1, 1, 4), (2, 0, 5)] {
        let (simple, Lifted { energies, polish }) = map(&random(genus, loops, seed), 900);
        let [relaxed, polished] = [&energies, &polish].map(|history| history[history.len() - 1]);
        assert!(relaxed - 1.0 < 1.3 * (simple - 1.0), "genus {genus}, {loops} loops: {simple}, {energies:?}");
        assert!(polished - 1.0 < 1.5 * (simple - 1.0), "genus {genus}, {loops} loops: {simple}, {polish:?}");
    }
}

/// A hundred pairs: `cargo test --release --test large_meshes -- --ignored`.
#[test]
#[ignore = "takes minutes"]
fn many_maps_come_back() {
    for seed in 10..110 {
        map(&random(seed as usize % 3, seed as usize / 3 % 3, seed), 900);
    }
}

/// The line takes the way by simple meshes on its own, and small pairs go without.
#[test]
fn the_line_maps_large_meshes_by_way_of_simple_ones() {
    let energy_at = |vertices: usize| {
        let [bull, mule] = [quadruped(Quadruped::Bull, vertices), quadruped(Quadruped::Mule, vertices)];
        let landmarks = [&bull, &mule].map(|shape| shape.landmarks.iter().map(|&(_, v)| v).collect::<Vec<_>>());
        let pair = Loaded::of([&bull.mesh, &mule.mesh], [&landmarks[0], &landmarks[1]]);
        let device = Device::open(&DeviceChoice::Cpu).expect("the CPU is there");
        let mut outcomes = Vec::new();
        map_pairs(std::iter::once(pair), &MapOptions::default(), &device, &Silent, |outcome| outcomes.push(outcome));
        let outcome = outcomes.remove(0);
        let mapped = outcome.value.expect("quadrupeds are mapped");
        assert!(mapped.map.certificate.bijective);
        assert_eq!(mapped.map.maps[0].images.len(), bull.mesh.positions.len());
        mapped.relaxation.polish.last().copied().expect("a polished map")
    };
    let [small, large] = [3_000, 21_000].map(energy_at);
    assert!(large < small * 1.05, "{small} to {large}");
}
