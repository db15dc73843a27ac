//! The stretch stage: never worse, never folded, the same on every device.

use glam::{DVec2, DVec3};
use homeo::gpu::{Compute, Device, DeviceChoice, REQUIRE_GPU};
use homeo::map::certificate::certify;
use homeo::map::embedding::Embedding;
use homeo::mesh::{PatchId, TriMesh};
use homeo::plane::convex::is_embedded;
use homeo::plane::stretch::{e_l2, patch_stretch};
use homeo::shape::{fixture, random_landmarks};
use homeo::stage::cluster::BaseVertices;
use homeo::stage::embed::embed;
use homeo::stage::layout::layouts;
use homeo::stage::stretch::stretch;

/// A sphere and a long ellipsoid with the same eight landmarks, embedded.
fn embedded() -> Embedding {
    let meshes = [fixture::icosphere(3), fixture::ellipsoid(DVec3::new(2.5, 1.0, 0.6), 3)];
    let landmarks = random_landmarks(&meshes[0], 8, 3);
    let meshes: [&TriMesh; 2] = meshes.each_ref();
    let set = BaseVertices::grow(meshes, [landmarks.clone(), landmarks], 8);
    let layout = layouts(meshes, &[set], 3, 1).expect("spheres have a layout").swap_remove(0);
    embed(meshes, layout).expect("patches embed").0
}

/// E_L2 of every patch of both meshes.
fn energies(embedding: &Embedding) -> Vec<f64> {
    let of = |(k, p): (usize, PatchId)| {
        let (mesh, frame) = (&embedding.meshes[k], &embedding.frames[p]);
        e_l2(&patch_stretch(&mesh.discs[p], &mesh.points(p), frame), frame.area())
    };
    (0..2).flat_map(|k| embedding.frames.ids().map(move |p| (k, p))).map(of).collect()
}

fn positions(embedding: &Embedding) -> Vec<Vec<DVec2>> {
    embedding.meshes.iter().flat_map(|m| m.discs.iter().map(|d| d.positions.clone())).collect()
}

/// Stretches and checks what always holds; returns how many patches got better.
fn stretch_safely(compute: &Compute, embedding: &mut Embedding) -> usize {
    let (before, old) = (energies(embedding), positions(embedding));
    let summary = stretch(compute, embedding).expect("the device works");
    assert!(certify(embedding).bijective);
    let (after, new) = (energies(embedding), positions(embedding));
    for i in 0..before.len() {
        assert!(after[i] < before[i] || (after[i] == before[i] && old[i] == new[i]), "patch {i} got worse");
    }
    let better = (0..before.len()).filter(|&i| after[i] < before[i]).count();
    assert_eq!(better, summary.iter().map(|s| s.improved).sum::<usize>());
    assert!(summary.iter().all(|s| s.after <= s.before && s.after >= 1.0), "{summary:?}");
    better
}

#[test]
fn stretch_falls_and_nothing_folds() {
    let mut embedding = embedded();
    assert!(stretch_safely(&Compute::Cpu, &mut embedding) > 0);
}

/// One free vertex of every patch goes so close to an edge of its ring that f32 cannot tell on which side it lies.
#[test]
fn patches_too_fine_for_single_precision_stay_embedded() {
    let mut embedding = embedded();
    for disc in embedding.meshes.iter_mut().flat_map(|m| &mut m.discs.raw) {
        let rings = disc.rings();
        let squeezed = (disc.boundary..disc.vertices.len()).find_map(|v| {
            let middle = disc.positions[rings[v][0] as usize].midpoint(disc.positions[rings[v][1] as usize]);
            let mut positions = disc.positions.clone();
            positions[v] = middle + 1e-11 * (positions[v] - middle);
            is_embedded(disc, &positions).then_some(positions)
        });
        disc.positions = squeezed.unwrap_or_else(|| disc.positions.clone());
    }
    assert!(certify(&embedding).bijective && certify(&embedding).min_orientation < 1e-9);
    stretch_safely(&Compute::Cpu, &mut embedding);
}

#[test]
fn an_adapter_proposes_the_same() {
    let device = match Device::open(&DeviceChoice::Gpu) {
        Ok(device) => device,
        Err(error) if std::env::var(REQUIRE_GPU).is_ok_and(|v| v == "1") => panic!("{REQUIRE_GPU}=1, but {error}"),
        Err(_) => return, // the kernel tests say loudly that there is no adapter
    };
    let Compute::Gpu(gpu) = &device.compute else { panic!("`gpu` was asked for and the CPU came") };
    let [mut here, mut there] = [embedded(), embedded()];
    stretch_safely(&Compute::Cpu, &mut here);
    stretch_safely(&device.compute, &mut there);
    if gpu.info().kind.is_software() {
        assert!(positions(&here) == positions(&there), "a software adapter gives the same bits");
    } else {
        let near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-3 * a;
        assert!(energies(&here).iter().zip(&energies(&there)).all(near));
    }
}
