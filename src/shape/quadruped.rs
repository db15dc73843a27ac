//! Two quadrupeds of clearly different build over one plan of the body.
//!
//! A body is a list of chains of round cones, blended; a chain beside the middle plane stands for a mirrored pair.

use super::Shape;
use super::field::{Sample, round_cone};
use super::solid::{Ray, Solid};
use glam::{DQuat, DVec3};

/// Room around the joints' balls for the fillets.
const FILLET_MARGIN: f64 = 0.1;

/// Rounding of the edge between hoof and sole; the soles stand on the plane z = 0.
const SOLE_EDGE: f64 = 0.04;

/// Builds of quadrupeds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quadruped {
    /// Stocky: heavy shoulders, short legs, low head, small ears, short tail.
    Bull,
    /// Slender: long legs, long raised neck, long ears, long tail.
    Mule,
}

/// A joint: x (forward), y (left), z (up), radius.
type Joint = [f64; 4];

/// Measures of a build. Chains run from the body outwards; chains with y > 0 are mirrored.
struct Build {
    name: &'static str,
    spine: &'static [Joint],
    neck: &'static [Joint],
    head: &'static [Joint],
    ear: &'static [Joint],
    foreleg: &'static [Joint],
    hindleg: &'static [Joint],
    tail: &'static [Joint],
    /// Fillet between the chains, in the order above.
    blends: [f64; 7],
    /// Ears are this much thinner across than wide.
    ear_flatness: f64,
    turn: DVec3,
}

const BULL: Build = Build {
    name: "bull",
    spine: &[[-0.86, 0.0, 1.02, 0.36], [-0.25, 0.0, 0.98, 0.43], [0.36, 0.0, 1.04, 0.47], [0.56, 0.0, 1.26, 0.33]],
    neck: &[[0.60, 0.0, 1.18, 0.36], [1.02, 0.0, 1.22, 0.27]],
    head: &[[1.16, 0.0, 1.26, 0.22], [1.34, 0.0, 1.12, 0.18], [1.52, 0.0, 0.98, 0.155]],
    ear: &[[1.08, 0.14, 1.34, 0.06], [1.06, 0.32, 1.40, 0.085], [1.04, 0.46, 1.38, 0.05]],
    foreleg: &[[0.46, 0.22, 0.90, 0.23], [0.44, 0.28, 0.50, 0.135], [0.46, 0.28, 0.22, 0.08], [0.50, 0.28, 0.08, 0.12]],
    hindleg: &[
        [-0.86, 0.18, 0.96, 0.28],
        [-0.76, 0.26, 0.64, 0.17],
        [-0.98, 0.27, 0.45, 0.095],
        [-0.91, 0.27, 0.20, 0.075],
        [-0.86, 0.27, 0.08, 0.115],
    ],
    tail: &[[-1.12, 0.0, 1.22, 0.08], [-1.36, 0.0, 1.13, 0.055], [-1.45, 0.0, 0.86, 0.05], [-1.46, 0.0, 0.66, 0.08]],
    blends: [0.20, 0.20, 0.12, 0.05, 0.07, 0.07, 0.06],
    ear_flatness: 1.35,
    turn: DVec3::new(0.3, 0.7, 0.2),
};

const MULE: Build = Build {
    name: "mule",
    spine: &[[-0.66, 0.0, 1.52, 0.27], [-0.10, 0.0, 1.46, 0.28], [0.42, 0.0, 1.50, 0.29]],
    neck: &[[0.50, 0.0, 1.60, 0.23], [0.78, 0.0, 1.98, 0.16], [0.98, 0.0, 2.34, 0.125]],
    head: &[[1.02, 0.0, 2.42, 0.145], [1.26, 0.0, 2.30, 0.115], [1.54, 0.0, 2.13, 0.09]],
    ear: &[[0.97, 0.08, 2.50, 0.075], [0.94, 0.19, 2.72, 0.095], [0.95, 0.27, 2.96, 0.06]],
    foreleg: &[
        [0.42, 0.14, 1.36, 0.17],
        [0.42, 0.17, 0.98, 0.10],
        [0.45, 0.17, 0.66, 0.075],
        [0.44, 0.17, 0.18, 0.052],
        [0.48, 0.17, 0.07, 0.08],
    ],
    hindleg: &[
        [-0.70, 0.13, 1.44, 0.20],
        [-0.58, 0.17, 1.06, 0.125],
        [-0.82, 0.17, 0.74, 0.07],
        [-0.76, 0.17, 0.18, 0.052],
        [-0.72, 0.17, 0.07, 0.08],
    ],
    tail: &[
        [-0.88, 0.0, 1.64, 0.065],
        [-1.06, 0.0, 1.56, 0.045],
        [-1.20, 0.0, 1.24, 0.045],
        [-1.24, 0.0, 0.90, 0.07],
        [-1.22, 0.0, 0.62, 0.045],
    ],
    blends: [0.16, 0.16, 0.08, 0.05, 0.06, 0.06, 0.05],
    ear_flatness: 1.35,
    turn: DVec3::new(-0.5, 0.2, 0.9),
};

impl Quadruped {
    fn build(self) -> &'static Build {
        match self {
            Quadruped::Bull => &BULL,
            Quadruped::Mule => &MULE,
        }
    }
}

/// A quadruped with about `resolution` vertices (at least [`FEWEST_VERTICES`](super::FEWEST_VERTICES)): closed,
/// genus 0, with the same 22 landmarks in the same order for every build.
pub fn quadruped(kind: Quadruped, resolution: usize) -> Shape {
    let build = kind.build();
    let bones = build.bones();
    let field = |p: DVec3| sample(&bones, p);
    let solid = Solid {
        name: build.name,
        field: &field,
        bounds: build.bounds(),
        thinnest: 0.026,
        flat: 0.4,
        turn: DQuat::from_scaled_axis(build.turn),
    };
    solid.shape(resolution, &build.rays())
}

/// One round cone of the body, in coordinates stretched by `flatness` along `across`.
struct Bone {
    from: (DVec3, f64),
    to: (DVec3, f64),
    /// Centre and radius of a ball around the bone.
    middle: DVec3,
    reach: f64,
    across: DVec3,
    flatness: f64,
    /// Fillet to the bones before, on the scale of this bone's field.
    blend: f64,
}

fn sample(bones: &[Bone], p: DVec3) -> Sample {
    let [first, rest @ ..] = bones else { unreachable!("every build has a spine") };
    let all = rest.iter().fold(first.sample(p), |all, bone| {
        if bone.least_distance(p) < all.distance + bone.blend { all.union(bone.sample(p), bone.blend) } else { all }
    });
    let ground = Sample { distance: p.z, gradient: DVec3::Z };
    all.minus(ground, SOLE_EDGE)
}

impl Bone {
    fn new(from: (DVec3, f64), to: (DVec3, f64), flatness: f64, blend: f64) -> Self {
        let middle = from.0.midpoint(to.0);
        let reach = 0.5 * from.0.distance(to.0) + from.1.max(to.1);
        let across = DVec3::X.reject_from(to.0 - from.0).normalize_or(DVec3::Z);
        Bone { from, to, middle, reach, across, flatness, blend: blend / flatness }
    }

    /// A cheap lower bound of the bone's field, from the ball around its joints.
    fn least_distance(&self, p: DVec3) -> f64 {
        (p.distance(self.middle) - self.reach) / self.flatness
    }

    /// The stretched coordinates make the field steeper; dividing by the stretch keeps its slope below one.
    fn sample(&self, p: DVec3) -> Sample {
        let stretch = |v: DVec3| v + self.across * (v.dot(self.across) * (self.flatness - 1.0));
        let middle = self.from.0;
        let s = round_cone(middle + stretch(p - middle), self.from, self.to);
        Sample { distance: s.distance / self.flatness, gradient: stretch(s.gradient) / self.flatness }
    }
}

impl Build {
    fn chains(&self) -> [&'static [Joint]; 7] {
        [self.spine, self.neck, self.head, self.ear, self.foreleg, self.hindleg, self.tail]
    }

    fn bones(&self) -> Vec<Bone> {
        let mut bones = Vec::new();
        for (chain, blend) in self.chains().into_iter().zip(self.blends) {
            let flatness = if std::ptr::eq(chain, self.ear) { self.ear_flatness } else { 1.0 };
            for &side in sides(chain) {
                for pair in chain.windows(2) {
                    bones.push(Bone::new(joint(&pair[0], side), joint(&pair[1], side), flatness, blend));
                }
            }
        }
        bones
    }

    /// A ball that contains the body, fillets included.
    fn bounds(&self) -> (DVec3, f64) {
        let joints = || {
            let chains = self.chains().into_iter();
            chains
                .flat_map(|chain| sides(chain).iter().flat_map(move |&side| chain.iter().map(move |j| joint(j, side))))
        };
        let low = joints().fold(DVec3::INFINITY, |low, (p, r)| low.min(p - r));
        let high = joints().fold(DVec3::NEG_INFINITY, |high, (p, r)| high.max(p + r));
        let centre = low.midpoint(high);
        (centre, joints().map(|(p, r)| p.distance(centre) + r).fold(0.0, f64::max) + FILLET_MARGIN)
    }

    /// The landmarks, in the order shared by all builds.
    fn rays(&self) -> Vec<Ray> {
        let mut rays = Vec::new();
        let mut add = |name: &str, start: DVec3, way: DVec3| rays.push((name.to_string(), start, way));
        let spine = |k: usize| joint(&self.spine[k], 1.0).0;
        let (neck_low, neck_high) = last_bone(self.neck, 1.0);
        let throat = DVec3::Y.cross(neck_high - neck_low);
        let (muzzle, nose) = last_bone(self.head, 1.0);
        let (tuft, tail_tip) = last_bone(self.tail, 1.0);
        add("nose", nose, nose - muzzle);
        add("crown", joint(&self.head[0], 1.0).0, DVec3::Z);
        add("throat", neck_low.midpoint(neck_high), throat);
        add("nape", neck_low.midpoint(neck_high), -throat);
        add("withers", spine(2), DVec3::Z);
        add("back", spine(1), DVec3::Z);
        add("croup", spine(0), DVec3::Z);
        add("tail_tip", tail_tip, tail_tip - tuft);
        add("chest", spine(2), DVec3::new(1.0, 0.0, -1.0));
        add("belly", spine(1), DVec3::NEG_Z);
        for (word, side) in [("left", 1.0), ("right", -1.0)] {
            let (ear, ear_tip) = last_bone(self.ear, side);
            add(&format!("{word}_cheek"), muzzle, DVec3::Y * side);
            add(&format!("{word}_ear_tip"), ear_tip, ear_tip - ear);
            for (end, chain, bend) in [("front", self.foreleg, DVec3::X), ("hind", self.hindleg, DVec3::NEG_X)] {
                let joint_name = if end == "front" { "knee" } else { "hock" };
                add(&format!("{end}_{word}_{joint_name}"), joint(&chain[chain.len() - 3], side).0, bend);
                add(&format!("{end}_{word}_hoof"), last_bone(chain, side).1, DVec3::NEG_Z);
            }
        }
        rays
    }
}

/// The sides a chain stands on: both, unless it lies in the middle plane.
fn sides(chain: &[Joint]) -> &'static [f64] {
    if chain.iter().all(|j| j[1] == 0.0) { &[1.0] } else { &[1.0, -1.0] }
}

/// Position and radius of a joint, on the left (`side` 1) or mirrored (-1).
fn joint(&[x, y, z, radius]: &Joint, side: f64) -> (DVec3, f64) {
    (DVec3::new(x, y * side, z), radius)
}

/// The last two joints of a chain.
fn last_bone(chain: &[Joint], side: f64) -> (DVec3, DVec3) {
    let n = chain.len();
    (joint(&chain[n - 2], side).0, joint(&chain[n - 1], side).0)
}
