//! The relaxation kernel and its session: what it converges to, what it never does, and the same on every device.

use crate::support::{Hexagon, Random, assert_same, device, folded, hexagon, lanes};
use glam::{DVec2, DVec3};
use homeo::gpu::Compute;
use homeo::kernel::relax::relax;
use homeo::kernel::{Lanes, RelaxInput, RelaxOptions, RelaxResult, RelaxSession, Rings, energy};
use homeo::solve::coloring;

/// One full sweep with stretches given, colour by colour.
fn sweep(compute: &Compute, rings: &Rings, weights: &[f32], sigma: &[f32], plane: &mut Vec<Lanes>) {
    let coloring = coloring::color(plane.len(), |v| rings.of(v));
    for c in 0..coloring.colors() {
        *plane = relax(compute, coloring.class(c), rings, weights, sigma, plane, 1.0).unwrap();
    }
}

fn random_weights(random: &mut Random, count: usize) -> Vec<f32> {
    (0..count).map(|_| (0.2 + random.unit()) as f32).collect()
}

fn flat(plane: &[DVec2]) -> Vec<f32> {
    plane.iter().flat_map(|p| [p.x as f32, p.y as f32]).collect()
}

#[test]
fn rings_are_closed_counter_clockwise_and_start_in_the_first_triangle() {
    let disc = hexagon(2);
    let rings = disc.rings();
    assert_eq!((0..disc.plane.len()).filter(|&v| !rings.of(v).is_empty()).count(), 7);
    for v in (0..disc.plane.len()).filter(|&v| disc.free[v]) {
        let ring = rings.of(v);
        assert_eq!(ring.len(), 6);
        for k in 0..6 {
            let t = [v as u32, ring[k], ring[(k + 1) % 6]];
            let turned = |r: usize| [t[r], t[(r + 1) % 3], t[(r + 2) % 3]];
            assert!((0..3).any(|r| disc.triangles.contains(&turned(r))), "{t:?} is no triangle");
        }
    }
    assert!(Rings::build(&disc.triangles, &vec![true; disc.plane.len()]).is_err(), "boundary vertices have no ring");
    assert!(Rings::build(&[[0, 1, 2], [0, 2, 1]], &[true, false, false]).is_ok());
    let two_fans = [[0, 1, 2], [0, 2, 1], [0, 3, 4], [0, 4, 3]];
    assert!(Rings::build(&two_fans, &[true, false, false, false, false]).is_err());
}

#[test]
fn the_fixed_point_is_the_weighted_mean_seed_11() {
    let mut random = Random(11);
    let disc = hexagon(5);
    let rings = disc.rings();
    let weights = random_weights(&mut random, rings.lists().items.len());
    let sigma: Vec<f32> = disc.plane.iter().map(|_| (0.5 + random.unit()) as f32).collect();
    let mut plane = lanes(&disc.plane);
    for _ in 0..300 {
        sweep(&Compute::Cpu, &rings, &weights, &sigma, &mut plane);
    }
    for v in (0..plane.len()).filter(|&v| disc.free[v]) {
        let (mut mean, mut total) = (DVec2::ZERO, 0.0);
        for (&j, w) in rings.of(v).iter().zip(&weights[rings.lists().range(v)]) {
            let w = f64::from(*w) / f64::from(sigma[j as usize]);
            mean += w * DVec2::new(plane[j as usize][0].into(), plane[j as usize][1].into());
            total += w;
        }
        let p = DVec2::new(plane[v][0].into(), plane[v][1].into());
        assert!((p - mean / total).length() < 1e-6, "vertex {v} rests at {p}, not at {}", mean / total);
    }
}

/// Every vertex pushed to and fro within its hexagon, as far as triangles stay positive.
fn shaken(disc: &Hexagon, random: &mut Random) -> Vec<Lanes> {
    let reach = (disc.plane[1] - disc.plane[0]).length() * 0.28;
    let mut plane = lanes(&disc.plane);
    for v in (0..plane.len()).filter(|&v| disc.free[v]) {
        let angle = random.unit() * std::f64::consts::TAU;
        plane[v][0] += (reach * angle.cos()) as f32;
        plane[v][1] += (reach * angle.sin()) as f32;
    }
    assert_eq!(folded(&disc.triangles, &plane), None);
    plane
}

/// Weights and stretches over many orders of magnitude drive vertices onto their neighbours: most steps are cut short.
#[test]
fn no_triangle_ever_turns_over_seed_12() {
    let mut random = Random(12);
    let gpu = device();
    let disc = hexagon(9);
    let rings = disc.rings();
    for round in 0..6 {
        let wild = |random: &mut Random| 10f64.powf(2.0 * f64::from(round) * random.signed()) as f32;
        let mut plane = shaken(&disc, &mut random);
        let before = plane.clone();
        let weights: Vec<f32> = rings.lists().items.iter().map(|_| wild(&mut random)).collect();
        for _ in 0..20 {
            let sigma: Vec<f32> = plane.iter().map(|_| wild(&mut random)).collect();
            let mut on_gpu = plane.clone();
            sweep(&Compute::Cpu, &rings, &weights, &sigma, &mut plane);
            assert_eq!(folded(&disc.triangles, &plane), None, "round {round}");
            if let Some((gpu, exact)) = &gpu {
                sweep(gpu, &rings, &weights, &sigma, &mut on_gpu);
                assert_eq!(folded(&disc.triangles, &on_gpu), None, "round {round} on the adapter");
                assert!(!exact || on_gpu == plane, "round {round}: the adapter stepped back differently");
            }
        }
        assert_ne!(plane, before);
        assert!((0..plane.len()).all(|v| disc.free[v] || plane[v] == before[v]), "a fixed vertex moved");
    }
}

#[test]
fn a_folded_vertex_is_set_right_when_its_ring_allows() {
    let disc = hexagon(1);
    let mut plane = lanes(&disc.plane);
    let centre = disc.free.iter().position(|&free| free).unwrap();
    plane[centre] = [3.0, 0.5, 0.0, 0.0];
    assert!(folded(&disc.triangles, &plane).is_some());
    sweep(&Compute::Cpu, &disc.rings(), &[1.0; 6], &[1.0; 7], &mut plane);
    assert_eq!(folded(&disc.triangles, &plane), None);
}

fn run(compute: &Compute, disc: &Hexagon, surface: &[DVec3], options: &RelaxOptions) -> RelaxResult {
    let rings = disc.rings();
    let weights = vec![1.0; rings.lists().items.len()];
    let input =
        RelaxInput { triangles: &disc.triangles, rings: &rings, weights: &weights, surface, plane: &disc.plane };
    let mut session = RelaxSession::new(compute, &input).unwrap();
    session.run(options).unwrap();
    session.read().unwrap()
}

#[test]
fn a_session_lowers_the_stretch_of_a_hill() {
    let disc = hexagon(16);
    let surface = disc.hill(4.0);
    let start = run(&Compute::Cpu, &disc, &surface, &RelaxOptions { sweeps: 0, ..Default::default() });
    assert_eq!(flat(&start.plane), flat(&disc.plane), "no sweeps, no change");
    let mut last = energy(&start.stretches);
    assert!(last > 2.5, "{last}");
    for power in 1..=3 {
        let result = run(&Compute::Cpu, &disc, &surface, &RelaxOptions { sweeps: 100, power, step: 1.0 });
        assert_eq!(folded(&disc.triangles, &lanes(&result.plane)), None);
        let now = energy(&result.stretches);
        assert!(now < last, "power {power}: {now} after {last}");
        last = now;
    }
    // Exact solves of the published iteration reach 1.86 here.
    assert!(last < 1.85, "{last}");
}

#[test]
fn settling_keeps_the_best_state_of_every_patch() {
    let (steep, flat_disc) = (hexagon(12), hexagon(7));
    let both = side_by_side(&steep, &flat_disc);
    let mut surface = steep.hill(3.0);
    surface.extend(flat_disc.hill(0.0));
    let patches = [0..steep.triangles.len(), steep.triangles.len()..both.triangles.len()];
    let rings = both.rings();
    let weights = vec![1.0; rings.lists().items.len()];
    let input = RelaxInput {
        triangles: &both.triangles,
        rings: &rings,
        weights: &weights,
        surface: &surface,
        plane: &both.plane,
    };
    for step in [1.0, 1.9] {
        let mut session = RelaxSession::new(&Compute::Cpu, &input).unwrap();
        let before = session.read().unwrap();
        let options = RelaxOptions { sweeps: 5, step, ..Default::default() };
        let after = session.settle(&patches, &options, 30).unwrap();
        let drop = |patch: &std::ops::Range<usize>| {
            energy(&after.stretches[patch.clone()]) / energy(&before.stretches[patch.clone()])
        };
        // A step that long drives the iteration astray; even then nothing may end worse than it began.
        assert!(drop(&patches[0]) < if step == 1.0 { 0.8 } else { 1.0 + 1e-9 }, "step {step}: {}", drop(&patches[0]));
        assert!(drop(&patches[1]) <= 1.0, "step {step}: {}", drop(&patches[1]));
        assert_eq!(folded(&both.triangles, &lanes(&after.plane)), None);
    }
}

#[test]
fn an_isometry_has_energy_one_wherever_it_lies() {
    let disc = hexagon(4);
    let far: Vec<DVec3> =
        disc.plane.iter().map(|p| DVec3::new(1e6, -2e6, 5e5) + 0.01 * DVec3::new(p.y, 0.0, p.x)).collect();
    let result = run(&Compute::Cpu, &disc, &far, &RelaxOptions { sweeps: 3, ..Default::default() });
    assert!((energy(&result.stretches) - 1.0).abs() < 1e-6, "{}", energy(&result.stretches));
    assert!(flat(&result.plane).iter().zip(flat(&disc.plane)).all(|(a, b)| (a - b).abs() < 1e-5));
}

#[test]
fn a_session_is_the_same_on_an_adapter() {
    let Some((gpu, exact)) = device() else { return };
    for (n, sweeps) in [(1, 3), (2, 5), (4, 20), (40, 6)] {
        let disc = hexagon(n);
        let surface = disc.hill(1.0);
        let options = RelaxOptions { sweeps, ..Default::default() };
        let [a, b] = [&Compute::Cpu, &gpu].map(|compute| run(compute, &disc, &surface, &options));
        assert_same(&format!("hexagon {n}"), exact, 1.0, &flat(&a.plane), &flat(&b.plane));
        assert!(!exact || a.stretches == b.stretches);
        assert!((energy(&a.stretches) - energy(&b.stretches)).abs() < 1e-5);
    }
}

/// `count` free vertices, each within a fixed pentagon of its own.
fn stars(count: usize) -> (Vec<[u32; 3]>, Vec<bool>, Vec<Lanes>) {
    let (mut triangles, mut free, mut plane) = (Vec::new(), Vec::new(), Vec::new());
    for star in 0..count as u32 {
        let first = 6 * star;
        triangles.extend((0..5).map(|k| [first, first + 1 + k, first + 1 + (k + 1) % 5]));
        free.extend([true, false, false, false, false, false]);
        let angle = |k: u32| 1.2566 * k as f32 + 0.001 * star as f32;
        plane.push([0.3, 0.2, 0.0, 0.0]);
        plane.extend((0..5).map(|k| [angle(k).cos(), angle(k).sin(), 0.0, 0.0]));
    }
    (triangles, free, plane)
}

#[test]
fn relax_is_the_same_on_an_adapter_seed_13() {
    let Some((gpu, exact)) = device() else { return };
    let mut random = Random(13);
    for count in [0, 1, 63, 64, 65, 40_003] {
        let (triangles, free, plane) = stars(count);
        let rings = Rings::build(&triangles, &free).unwrap();
        let weights = random_weights(&mut random, rings.lists().items.len());
        let sigma = random_weights(&mut random, plane.len());
        let centres: Vec<u32> = (0..count as u32).map(|star| 6 * star).collect();
        let [a, b] = [&Compute::Cpu, &gpu].map(|c| relax(c, &centres, &rings, &weights, &sigma, &plane, 1.0).unwrap());
        assert_same(&format!("{count} stars"), exact, 1.0, a.as_flattened(), b.as_flattened());
        assert!(count == 0 || a != plane);
    }
}

/// Two hexagons as one job.
fn side_by_side(a: &Hexagon, b: &Hexagon) -> Hexagon {
    let shift = a.plane.len() as u32;
    Hexagon {
        plane: a.plane.iter().chain(&b.plane).copied().collect(),
        triangles: a.triangles.iter().copied().chain(b.triangles.iter().map(|t| t.map(|v| v + shift))).collect(),
        free: a.free.iter().chain(&b.free).copied().collect(),
    }
}

#[test]
fn patches_do_not_see_their_company_or_the_threads() {
    let (a, b) = (hexagon(20), hexagon(31));
    let both = side_by_side(&a, &b);
    let options = RelaxOptions { sweeps: 10, ..Default::default() };
    let of = |disc: &Hexagon, surface: &[DVec3]| flat(&run(&Compute::Cpu, disc, surface, &options).plane);
    let surface = [a.hill(1.0), b.hill(2.0).iter().map(|p| 30.0 * *p + DVec3::splat(500.0)).collect()];
    let together = of(&both, &surface.concat());
    assert!(together == [of(&a, &surface[0]), of(&b, &surface[1])].concat());
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert!(pool.install(|| of(&both, &surface.concat())) == together, "{threads} threads");
    }
}
