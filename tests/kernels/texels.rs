//! Texel ownership: every texel belongs to exactly one of triangles that share edges, and the same on every device.

use crate::support::{Random, assert_same, device};
use homeo::gpu::Compute;
use homeo::kernel::{FlatTriangle, NO_TRIANGLE, Texel, texels};

type Point = [f32; 2];

fn flat([a, b, c]: [Point; 3]) -> FlatTriangle {
    FlatTriangle { ax: a[0], ay: a[1], bx: b[0], by: b[1], cx: c[0], cy: c[1] }
}

/// A grid of `n` x `n` quads over a square with its upper left corner at `low`, each halved; inner vertices are moved by up to
/// `jitter` of a side.
fn sheet(random: &mut Random, n: usize, low: f32, side: f32, jitter: f32) -> Vec<FlatTriangle> {
    let step = side / n as f32;
    let mut move_by = |i: usize| {
        let share = random.index(2001) as f32 / 1000.0 - 1.0;
        if i.is_multiple_of(n) { 0.0 } else { share * jitter * step }
    };
    let points: Vec<Point> = (0..(n + 1) * (n + 1))
        .map(|i| (i % (n + 1), i / (n + 1)))
        .map(|(x, y)| [low + x as f32 * step + move_by(x), low + y as f32 * step + move_by(y)])
        .collect();
    let quad = |i: usize| {
        let corner = i / n * (n + 1) + i % n;
        let [a, b, c, d] = [0, 1, n + 2, n + 1].map(|k| points[corner + k]);
        [flat([a, b, c]), flat([a, c, d])]
    };
    (0..n * n).flat_map(quad).collect()
}

fn flattened(texels: &[Texel]) -> Vec<f32> {
    texels.iter().flat_map(|t| [t.w1, t.w2]).collect()
}

#[test]
fn a_sheet_covers_every_texel_once_seed_3() {
    let mut random = Random(3);
    // Whole and half steps put centres on edges and vertices.
    for (n, side, jitter) in [(1, 64.0, 0.0), (64, 64.0, 0.0), (128, 64.0, 0.0), (37, 64.0, 0.3), (5, 64.0, 0.4)] {
        for shift in [0.0, 0.5] {
            let triangles = sheet(&mut random, n, -shift, side + 2.0 * shift, jitter);
            let all = texels(&Compute::Cpu, 64, 64, &triangles).unwrap();
            assert!(all.iter().all(|t| t.covers == 1), "{n} {shift}");
            for (i, texel) in all.iter().enumerate() {
                let t = triangles[texel.triangle as usize];
                let [w0, w1, w2] = texel.weights();
                let x = w0 * t.ax + w1 * t.bx + w2 * t.cx - (i % 64) as f32 - 0.5;
                let y = w0 * t.ay + w1 * t.by + w2 * t.cy - (i / 64) as f32 - 0.5;
                assert!(x.abs() < 1e-3 && y.abs() < 1e-3, "{n} {shift}: {x} {y}");
            }
        }
    }
}

#[test]
fn the_first_of_overlapping_triangles_owns_and_the_outside_belongs_to_none() {
    let square = [[2.0, 2.0], [6.0, 2.0], [6.0, 6.0], [2.0, 6.0]];
    let half = |k: [usize; 3]| flat(k.map(|i| square[i]));
    let all = texels(&Compute::Cpu, 9, 8, &[half([0, 1, 2]), half([0, 2, 3]), half([0, 1, 2])]).unwrap();
    for (i, texel) in all.iter().enumerate() {
        let (x, y) = (i % 9, i / 9);
        let inside = (2..6).contains(&x) && (2..6).contains(&y);
        assert_eq!(texel.triangle == NO_TRIANGLE, !inside, "{x} {y}");
        let is_upper = inside && texel.triangle == 0;
        assert_eq!(texel.covers, if is_upper { 2 } else { u32::from(inside) }, "{x} {y}");
    }
}

/// Every texel and every triangle, as `kernels/texels.wgsl` has it.
fn one_by_one(width: u32, height: u32, triangles: &[FlatTriangle]) -> Vec<Texel> {
    let precedes = |p: Point, q: Point| p[0] < q[0] || (p[0] == q[0] && p[1] < q[1]);
    let area = |p: Point, q: Point, x: Point| (q[0] - p[0]) * (x[1] - p[1]) - (q[1] - p[1]) * (x[0] - p[0]);
    let beside = |p, q, x| if precedes(p, q) { area(p, q, x) } else { -area(q, p, x) };
    let holds = |area: f32, p, q| area > 0.0 || (area == 0.0 && precedes(p, q));
    let texel = |i: u32| {
        let x = [(i % width) as f32 + 0.5, (i / width) as f32 + 0.5];
        let mut texel = Texel::EMPTY;
        for (t, f) in (0u32..).zip(triangles) {
            let (a, b, c) = ([f.ax, f.ay], [f.bx, f.by], [f.cx, f.cy]);
            let (at_a, at_b, at_c) = (beside(b, c, x), beside(c, a, x), beside(a, b, x));
            let sum = at_a + at_b + at_c;
            if holds(at_a, b, c) && holds(at_b, c, a) && holds(at_c, a, b) && sum > 0.0 {
                if texel.covers == 0 {
                    let per_sum = 1.0 / sum;
                    texel = Texel { triangle: t, covers: 0, w1: at_b * per_sum, w2: at_c * per_sum };
                }
                texel.covers += 1;
            }
        }
        texel
    };
    (0..width * height).map(texel).collect()
}

/// Corners on and off the texels' centres, near and far, in a line, and all in one place.
#[test]
fn rows_of_texels_are_what_single_texels_are_seed_5() {
    let mut random = Random(5);
    for round in 0..3000 {
        let (width, height) = (1 + random.index(40), 1 + random.index(12));
        let reach = [1.0, 8.0, 40.0, 3000.0][random.index(4) as usize];
        let grain = [2.0, 8.0, 1000.0][random.index(3) as usize];
        let mut number = |size: u32| {
            let share = random.index(2001) as f32 / 1000.0 - 1.0;
            ((size as f32 * 0.5 + share * reach) * grain).round() / grain
        };
        let mut point = || [number(width), number(height)];
        let mut triangles = Vec::new();
        while triangles.len() < 6 {
            let [a, b, c] = [point(), point(), point()];
            let middle = [0, 1].map(|k| 0.5 * (a[k] + b[k]) + 1e-5 * c[k]);
            triangles.extend([flat([a, b, c]), flat([a, c, b]), flat([a, middle, b]), flat([b, b, c])]);
        }
        let all = texels(&Compute::Cpu, width, height, &triangles).unwrap();
        assert_eq!(all, one_by_one(width, height, &triangles), "round {round}");
    }
}

#[test]
fn texels_are_the_same_on_every_device_seed_4() {
    let Some((gpu, exact)) = device() else { return };
    let mut random = Random(4);
    for (width, height, n, jitter) in
        [(64, 64, 40, 0.4), (1, 1, 1, 0.0), (7, 130, 3, 0.2), (65, 9, 64, 0.0), (8, 8, 0, 0.0)]
    {
        let triangles = if n == 0 { Vec::new() } else { sheet(&mut random, n, -3.0, 100.0, jitter) };
        let [on_cpu, on_gpu] = [&Compute::Cpu, &gpu].map(|on| texels(on, width, height, &triangles).unwrap());
        if exact {
            let owners = |all: &[Texel]| all.iter().map(|t| (t.triangle, t.covers)).collect::<Vec<_>>();
            assert_eq!(owners(&on_cpu), owners(&on_gpu));
            assert_same("weights", exact, 1.0, &flattened(&on_cpu), &flattened(&on_gpu));
        } else {
            assert!(on_gpu.iter().zip(&on_cpu).all(|(a, b)| a.covers == b.covers), "every texel is covered once");
        }
    }
}
