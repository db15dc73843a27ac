//! What the kernel tests share: the device, random numbers, and meshes chosen by property.

use std::io::Write;
use std::sync::Once;

use glam::{DVec2, DVec3};
use homeo::Error;
use homeo::gpu::{Compute, Device, DeviceChoice, REQUIRE_GPU};
use homeo::kernel::{Lanes, Rings};

/// The machine's best adapter; `None` (said loudly) without one, unless it is required.
pub fn device() -> Option<(Compute, bool)> {
    match Device::open(&DeviceChoice::Gpu) {
        Ok(Device { compute, .. }) => {
            let Compute::Gpu(gpu) = &compute else { panic!("`gpu` was asked for and the CPU came") };
            let exact = gpu.info().kind.is_software();
            Some((compute, exact))
        }
        Err(error) if std::env::var(REQUIRE_GPU).is_ok_and(|v| v == "1") => panic!("{REQUIRE_GPU}=1, but {error}"),
        Err(error) => {
            warn_once(&error);
            None
        }
    }
}

/// Written past the test harness, which swallows what passing tests print.
fn warn_once(error: &Error) {
    static WARNING: Once = Once::new();
    WARNING.call_once(|| {
        let warning = format!("\n*** SKIPPED: kernels were NOT compared between CPU and GPU: {error} ***\n\n");
        std::io::stderr().write_all(warning.as_bytes()).expect("standard error takes a line");
    });
}

/// Equal bits on a software adapter; on hardware, equal within 1e-5 of the larger of `scale` and the values.
pub fn assert_same(what: &str, exact: bool, scale: f32, cpu: &[f32], gpu: &[f32]) {
    assert_eq!(cpu.len(), gpu.len(), "{what}");
    for (i, (a, b)) in cpu.iter().zip(gpu).enumerate() {
        let near = (a - b).abs() <= 1e-5 * scale.max(a.abs()).max(b.abs());
        assert!(if exact { a.to_bits() == b.to_bits() } else { near }, "{what}, value {i}: CPU {a:e}, GPU {b:e}");
    }
}

/// Splitmix64: the same numbers on every machine.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In `0 .. below`.
    pub fn index(&mut self, below: usize) -> u32 {
        (self.bits() % below as u64) as u32
    }

    /// In `0 .. 1`.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// In `-1 .. 1`.
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    pub fn point(&mut self, scale: f32) -> Lanes {
        [0; 3]
            .map(|_: i32| self.signed() as f32 * scale)
            .into_iter()
            .chain([0.0])
            .collect::<Vec<_>>()
            .try_into()
            .unwrap()
    }
}
/// A triangulated hexagon of side 1 with `n` triangles along each side, counter-clockwise in the plane.
///
/// ```text
///      .---.---.
///     / \ / \ / \
///    .---.---.---.      n = 2
///   / \ / \ / \ / \
///  .---.---.---.---.
///   \ / \ / \ / \ /
///    .---.---.---.
///     \ / \ / \ /
///      .---.---.
/// ```
pub struct Hexagon {
    pub plane: Vec<DVec2>,
    pub triangles: Vec<[u32; 3]>,
    pub free: Vec<bool>,
}

pub fn hexagon(n: i32) -> Hexagon {
    let inside = |q: i32, r: i32| q.abs().max(r.abs()).max((q + r).abs()) <= n;
    let mut number = std::collections::BTreeMap::new();
    let mut hexagon = Hexagon { plane: Vec::new(), triangles: Vec::new(), free: Vec::new() };
    for (r, q) in (-n..=n).flat_map(|r| (-n..=n).map(move |q| (r, q))).filter(|&(r, q)| inside(q, r)) {
        number.insert((q, r), hexagon.plane.len() as u32);
        let (q, r) = (f64::from(q), f64::from(r));
        hexagon.plane.push(DVec2::new(q + 0.5 * r, 0.75f64.sqrt() * r) / f64::from(n));
        hexagon.free.push(q.abs().max(r.abs()).max((q + r).abs()) < f64::from(n));
    }
    for (q, r) in (-n..n).flat_map(|r| (-n..n).map(move |q| (q, r))) {
        for corners in [[(q, r), (q + 1, r), (q, r + 1)], [(q + 1, r), (q + 1, r + 1), (q, r + 1)]] {
            if let [Some(&a), Some(&b), Some(&c)] = corners.map(|corner| number.get(&corner)) {
                hexagon.triangles.push([a, b, c]);
            }
        }
    }
    hexagon
}

impl Hexagon {
    pub fn rings(&self) -> Rings {
        Rings::build(&self.triangles, &self.free).unwrap()
    }

    /// A steep hill over the middle of the hexagon, which an embedding by plain means shrinks.
    pub fn hill(&self, height: f64) -> Vec<DVec3> {
        self.plane.iter().map(|p| p.extend(height * (-8.0 * p.length_squared()).exp())).collect()
    }
}

/// Lanes of points in the plane.
pub fn lanes(plane: &[DVec2]) -> Vec<Lanes> {
    plane.iter().map(|p| [p.x as f32, p.y as f32, 0.0, 0.0]).collect()
}

/// The first triangle that is not exactly counter-clockwise.
pub fn folded(triangles: &[[u32; 3]], plane: &[Lanes]) -> Option<usize> {
    let at = |v: u32| robust::Coord { x: f64::from(plane[v as usize][0]), y: f64::from(plane[v as usize][1]) };
    // Phrased positively, so that NaN counts as folded.
    let upright = |&[a, b, c]: &[u32; 3]| robust::orient2d(at(a), at(b), at(c)) > 0.0;
    triangles.iter().position(|t| !upright(t))
}
