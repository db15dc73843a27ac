//! The kernels that treat one element at a time: the identities that define them, and the same on every device.

use crate::support::{Random, assert_same, device, hexagon, lanes};
use homeo::gpu::{Compute, WORKGROUP};
use homeo::kernel::{Lanes, Lists, Query, Stretch, resample, stretch, vertex_stretch};

/// Sizes around the workgroup's, and one that fills no whole number of them.
const SIZES: [usize; 6] = [0, 1, 63, 64, 65, 1_000_003];

fn random_triangles(random: &mut Random, count: usize, vertices: usize) -> Vec<[u32; 3]> {
    (0..count).map(|_| [0; 3].map(|_| random.index(vertices))).collect()
}

fn flat(stretches: &[Stretch]) -> Vec<f32> {
    stretches.iter().flat_map(|s| [s.large, s.small, s.area_from, s.area_to]).collect()
}

fn near(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * a.abs().max(b.abs())
}

#[test]
fn stretch_satisfies_its_identities_seed_1() {
    let mut random = Random(1);
    for scale in [1e-6f32, 1.0, 1e6] {
        let source: Vec<Lanes> = (0..300).map(|_| random.point(1.0)).collect();
        let image: Vec<Lanes> = (0..300).map(|_| random.point(scale)).collect();
        let triangles = random_triangles(&mut random, 2000, 300);
        for (t, s) in triangles.iter().zip(stretch(&Compute::Cpu, &triangles, &source, &image).unwrap()) {
            let [u, w] = [1, 2].map(|k| difference(source[t[k] as usize], source[t[0] as usize]));
            let [p, q] = [1, 2].map(|k| difference(image[t[k] as usize], image[t[0] as usize]));
            let (from, to) = (0.5 * u.cross(w).length(), 0.5 * p.cross(q).length());
            // Thin triangles have a height of few bits; what they give is checked for sanity only.
            if from < 0.05 || to < 0.05 * f64::from(scale * scale) {
                assert!([s.large, s.small, s.area_from, s.area_to].iter().all(|x| x.is_finite() && *x >= 0.0), "{s:?}");
                continue;
            }
            let (large, small) = (f64::from(s.large), f64::from(s.small));
            assert!(near(s.area_from.into(), from, 1e-4) && near(s.area_to.into(), to, 1e-4), "{s:?}");
            assert!(large >= small && near(large * small, to / from, 1e-3), "{s:?}, {}", to / from);
            assert!(near(large * large + small * small, frobenius_sq([u, w], [p, q]), 1e-3), "{s:?}");
        }
    }
}

fn difference(a: Lanes, b: Lanes) -> glam::DVec3 {
    glam::DVec3::new((a[0] - b[0]).into(), (a[1] - b[1]).into(), (a[2] - b[2]).into())
}

/// Trace of `(E^T E)^-1 (P^T P)` with the edges `u, w` and `p, q` as columns: the squared Frobenius norm of the map.
fn frobenius_sq([u, w]: [glam::DVec3; 2], [p, q]: [glam::DVec3; 2]) -> f64 {
    let (uu, uw, ww) = (u.dot(u), u.dot(w), w.dot(w));
    (ww * p.dot(p) - 2.0 * uw * p.dot(q) + uu * q.dot(q)) / (uu * ww - uw * uw)
}

#[test]
fn known_maps_have_known_stretches() {
    let [o, x, y] = [[0.0; 4], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]];
    let image = [[5.0, 5.0, 5.0, 0.0], [5.0, 5.0, 8.0, 0.0], [5.0, 7.0, 5.0, 0.0]];
    let s = stretch(&Compute::Cpu, &[[0, 1, 2]], &[o, x, y], &image).unwrap();
    assert_eq!(s, [Stretch { large: 3.0, small: 2.0, area_from: 0.5, area_to: 3.0 }]);
    let collapsed = stretch(&Compute::Cpu, &[[0, 1, 2]], &[o, x, y], &[o, o, o]).unwrap();
    assert_eq!(collapsed, [Stretch { large: 0.0, small: 0.0, area_from: 0.5, area_to: 0.0 }]);
    let flattened = stretch(&Compute::Cpu, &[[0, 1, 2]], &[o, x, y], &[o, x, x]).unwrap()[0];
    assert!(flattened.large > 1.0 && flattened.small == 0.0 && flattened.area_to == 0.0, "{flattened:?}");
}

/// Triangles that have lost something: coincident corners, collinear corners, extents near the ends of f32.
fn degenerate() -> (Vec<[u32; 3]>, Vec<Lanes>, Vec<Lanes>) {
    let shapes: [[f32; 3]; 7] = [
        [0.0; 3],
        [1.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 1e-9, 0.0],
        [1e-5, 1e-5, 1.0],
        [0.3, 0.7, -2.0],
    ];
    let scales = [0.0f32, 1e-38, 1e-20, 1e-13, 1e-11, 1e-6, 1.0, 1e6, 1e11, 1e13, 1e19, 1e38];
    let mut source = Vec::new();
    let mut image = Vec::new();
    let mut triangles = Vec::new();
    for (a, b) in scales.iter().flat_map(|a| scales.map(|b| (*a, b))) {
        let first = source.len() as u32;
        source.extend(shapes.map(|p| [p[0] * a, p[1] * a, p[2] * a, 0.0]));
        image.extend(shapes.map(|p| [p[2] * b, p[0] * b, p[1] * b, 0.0]));
        let all = (0..7).flat_map(|i| (0..7).flat_map(move |j| (0..7).map(move |k| [i, j, k])));
        triangles.extend(all.map(|t| t.map(|v| v + first)));
    }
    (triangles, source, image)
}

#[test]
fn degenerate_triangles_are_flagged_and_never_nan() {
    let (triangles, source, image) = degenerate();
    for (a, b) in [(&source, &image), (&image, &source), (&source, &source)] {
        for (t, s) in triangles.iter().zip(stretch(&Compute::Cpu, &triangles, a, b).unwrap()) {
            assert!(
                [s.large, s.small, s.area_from, s.area_to].iter().all(|x| x.is_finite() && *x >= 0.0),
                "{t:?} {s:?}"
            );
            assert!(s.area_from > 0.0 || (s.large == 0.0 && s.small == 0.0), "{t:?} {s:?}");
            assert!(s.large >= s.small, "{t:?} {s:?}");
            let repeated = t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
            assert!(!repeated || (s.area_from == 0.0 && s.area_to == 0.0), "{t:?} {s:?}");
        }
    }
}

#[test]
fn stretch_is_the_same_on_an_adapter_seed_2() {
    let Some((gpu, exact)) = device() else { return };
    let mut random = Random(2);
    let source: Vec<Lanes> = (0..501).map(|_| random.point(1.0)).collect();
    let image: Vec<Lanes> = (0..501).map(|_| random.point(3.0)).collect();
    for count in SIZES {
        let mut triangles = random_triangles(&mut random, count, source.len());
        if !exact {
            triangles.retain(|t| well_shaped(t, &source) && well_shaped(t, &image));
        }
        let [a, b] = [&Compute::Cpu, &gpu].map(|c| flat(&stretch(c, &triangles, &source, &image).unwrap()));
        assert_same(&format!("{count} triangles"), exact, 0.0, &a, &b);
    }
    let (triangles, source, image) = degenerate();
    let [a, b] = [&Compute::Cpu, &gpu].map(|c| stretch(c, &triangles, &source, &image).unwrap());
    if exact {
        assert_same("degenerate triangles", true, 0.0, &flat(&a), &flat(&b));
    }
    assert!(flat(&b).iter().all(|x| x.is_finite() && *x >= 0.0));
}

/// Rounding is magnified by a triangle's thinness, so that 1e-5 can be asked for fat ones only.
fn well_shaped(t: &[u32; 3], positions: &[Lanes]) -> bool {
    let [u, w] = [1, 2].map(|k| difference(positions[t[k] as usize], positions[t[0] as usize]));
    u.cross(w).length() > 0.3 * u.length_squared().max(w.length_squared())
}

#[test]
fn vertex_stretch_is_the_weighted_mean() {
    let row = |large, small, area_from, area_to| Stretch { large, small, area_from, area_to };
    let rows = [row(1.0, 1.0, 1.0, 3.0), row(7.0, 1.0, 1.0, 1.0), row(0.0, 0.0, 0.0, 9.0)];
    let incident = Lists { starts: vec![0, 2, 3, 3, 5], items: vec![0, 1, 2, 1, 2] };
    let sigma = vertex_stretch::vertex_stretch(&Compute::Cpu, &incident, &rows, &[9.0; 4], 0).unwrap();
    assert!(near(sigma[0].into(), (3.0 * 1.0 + 1.0 * 5.0) / 4.0, 1e-6), "{sigma:?}");
    assert_eq!(sigma[1..3], [1.0, 1.0], "a vertex without usable triangles");
    assert!(near(sigma[3].into(), 5.0, 1e-6), "{sigma:?}");
    let damped = vertex_stretch::vertex_stretch(&Compute::Cpu, &incident, &rows, &[9.0; 4], 3).unwrap();
    assert!((0..4).all(|v| near(damped[v].into(), (9.0 * f64::from(sigma[v]).powi(3)).sqrt(), 1e-6)), "{damped:?}");
    assert!(vertex_stretch::vertex_stretch(&Compute::Cpu, &incident, &rows, &[9.0; 4], 4).is_err());
    assert!(vertex_stretch::vertex_stretch(&Compute::Cpu, &incident, &rows, &[9.0; 3], 1).is_err());
}

#[test]
fn vertex_stretch_is_the_same_on_an_adapter_seed_3() {
    let Some((gpu, exact)) = device() else { return };
    let mut random = Random(3);
    for (vertices, triangles) in [(1, 0), (1, 1), (63, 20), (64, 200), (65, 65), (250_007, 500_000)] {
        let corners = random_triangles(&mut random, triangles, vertices);
        let incident = Lists::incident(vertices, &corners).unwrap();
        let mut value = || random.unit() as f32;
        let rows: Vec<_> = (0..triangles).map(|_| (value(), value(), value(), value())).collect();
        let rows: Vec<_> = rows
            .iter()
            .map(|&(a, b, from, to)| Stretch { large: a + b, small: b, area_from: from, area_to: to })
            .map(|s| if s.area_from < 0.1 { Stretch::default() } else { s })
            .collect();
        let sigma: Vec<f32> = (0..vertices).map(|_| (0.1 + random.unit()) as f32).collect();
        for power in 0..=3 {
            let on = |compute| vertex_stretch::vertex_stretch(compute, &incident, &rows, &sigma, power).unwrap();
            assert_same(&format!("{vertices} vertices, power {power}"), exact, 0.0, &on(&Compute::Cpu), &on(&gpu));
        }
    }
}

fn random_queries(random: &mut Random, count: usize, vertices: usize) -> Vec<Query> {
    let query = |random: &mut Random| {
        let [i0, i1, i2] = [0; 3].map(|_| random.index(vertices));
        let (s, t) = (random.unit().sqrt(), random.unit());
        Query { i0, i1, i2, w0: (1.0 - s) as f32, w1: (s * t) as f32, w2: (s * (1.0 - t)) as f32 }
    };
    (0..count).map(|_| query(random)).collect()
}

#[test]
fn resampling_reproduces_affine_functions_seed_4() {
    let mut random = Random(4);
    let disc = hexagon(12);
    let affine = |p: Lanes| [2.0 * p[0] - p[1] + 3.0, p[0] + 0.5 * p[1], -4.0, p[1]];
    let plane = lanes(&disc.plane);
    let attribute: Vec<Lanes> = plane.iter().map(|&p| affine(p)).collect();
    let queries = random_queries(&mut random, 1000, plane.len());
    let places = resample(&Compute::Cpu, &queries, &plane).unwrap();
    for (place, sample) in places.iter().zip(resample(&Compute::Cpu, &queries, &attribute).unwrap()) {
        let expected = affine(*place);
        assert!((0..4).all(|k| (sample[k] - expected[k]).abs() < 1e-5), "{sample:?} is not {expected:?}");
    }
    let corner = Query { i0: 7, i1: 8, i2: 9, w0: 0.0, w1: 1.0, w2: 0.0 };
    assert_eq!(resample(&Compute::Cpu, &[corner], &attribute).unwrap(), [attribute[8]]);
}

#[test]
fn resampling_is_the_same_on_an_adapter_seed_5() {
    let Some((gpu, exact)) = device() else { return };
    let mut random = Random(5);
    let attribute: Vec<Lanes> = (0..1001).map(|_| random.point(10.0)).collect();
    // The last size needs more workgroups than one dispatch may have.
    for count in SIZES.into_iter().chain([65_535 * WORKGROUP as usize + 1]) {
        let queries = random_queries(&mut random, count, attribute.len());
        let [a, b] = [&Compute::Cpu, &gpu].map(|c| resample(c, &queries, &attribute).unwrap());
        assert_same(&format!("{count} queries"), exact, 10.0, a.as_flattened(), b.as_flattened());
    }
}

#[test]
fn indices_out_of_range_are_refused() {
    let points = [[0.0; 4]; 3];
    let query = Query { i0: 0, i1: 3, i2: 1, w0: 1.0, w1: 0.0, w2: 0.0 };
    assert!(stretch(&Compute::Cpu, &[[0, 1, 3]], &points, &points).unwrap_err().what.contains('3'));
    assert!(stretch(&Compute::Cpu, &[[0, 1, 2]], &points, &points[..2]).is_err());
    assert!(resample(&Compute::Cpu, &[query], &points).unwrap_err().what.contains('3'));
    assert!(Lists::incident(2, &[[0, 1, 2]]).is_err());
}
