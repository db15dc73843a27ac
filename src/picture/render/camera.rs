//! Where a scene is seen from, fitted to it.

use glam::{DVec2, DVec3};

/// Share of the picture that the scene leaves free on every side.
const MARGIN: f64 = 0.05;

/// Directions that previews are taken from. What is up is told from the points: y, unless they reach farther along z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// From the front: along -z where y is up, along y where z is.
    Front,
    /// From the back.
    Back,
    /// From the side: along -x.
    Side,
    /// From the front, a little from the side and above.
    ThreeQuarter,
    /// The same from behind.
    ThreeQuarterBack,
}

/// How depth shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// Not at all.
    Orthographic,
    /// From a distance of so many radii of the scene, more than 1.
    Perspective(f64),
}

/// A camera, fitted to points.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Axes: to the right, up, and towards the viewer; of length one.
    axes: [DVec3; 3],
    centre: DVec3,
    lens: Lens,
    /// Distance of the viewer from the centre; infinite without perspective.
    distance: f64,
    /// What the scene covers of the image plane.
    low: DVec2,
    high: DVec2,
    /// Radius of a ball around the scene.
    radius: f64,
}

/// A point in a picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projected {
    /// In samples, y downwards.
    pub at: DVec2,
    /// Larger is nearer; linear in the picture along lines in space.
    pub nearness: f64,
    /// Weight with which values at this point are interpolated in the picture.
    pub weight: f64,
}

impl Camera {
    /// A camera that shows all of `points` from a usual direction.
    pub fn new(view: View, lens: Lens, points: &[DVec3]) -> Self {
        let (low, high) = bounds(points.iter().copied());
        let extent = high - low;
        let front = if extent.y >= extent.z { DVec3::Z } else { DVec3::NEG_Y };
        let up = if extent.y >= extent.z { DVec3::Y } else { DVec3::Z };
        let right = up.cross(front);
        let towards = match view {
            View::Front => front,
            View::Back => -front,
            View::Side => right,
            View::ThreeQuarter => front * 0.75 + right * 0.55 + up * 0.35,
            View::ThreeQuarterBack => -front * 0.75 - right * 0.55 + up * 0.35,
        };
        Camera::looking(towards, up, lens, points)
    }

    /// A camera in direction `towards` from the scene that shows all of `points`, with `up` upwards in the picture.
    pub fn looking(towards: DVec3, up: DVec3, lens: Lens, points: &[DVec3]) -> Self {
        let (low, high) = bounds(points.iter().copied());
        let centre = (low + high) * 0.5;
        let z = towards.normalize_or(DVec3::Z);
        let x = up.cross(z).normalize_or(z.any_orthonormal_vector());
        let radius = points.iter().map(|p| p.distance(centre)).filter(|d| d.is_finite()).fold(0.0, f64::max);
        let radius = if radius > 0.0 { radius } else { 1.0 };
        let distance = match lens {
            Lens::Orthographic => f64::INFINITY,
            Lens::Perspective(radii) => radius * radii,
        };
        let mut camera =
            Camera { axes: [x, z.cross(x), z], centre, lens, distance, low: DVec2::ZERO, high: DVec2::ONE, radius };
        let plane = points.iter().map(|&p| camera.on_plane(p).0.extend(0.0));
        let (low, high) = bounds(plane);
        (camera.low, camera.high) = (low.truncate(), high.truncate());
        camera
    }

    /// A camera in the same direction that shows all of other points.
    pub fn fitted_to(&self, points: &[DVec3]) -> Self {
        Camera::looking(self.axes[2], self.axes[1], self.lens, points)
    }

    /// Width by height of what the scene covers of the picture.
    pub fn aspect(&self) -> f64 {
        let extent = self.high - self.low;
        if extent.y > 0.0 { extent.x / extent.y } else { 1.0 }
    }

    /// The direction from the scene to the viewer, as seen from a point.
    pub(super) fn towards(&self, p: DVec3) -> DVec3 {
        if self.distance.is_finite() {
            (self.centre + self.axes[2] * self.distance - p).normalize_or(self.axes[2])
        } else {
            self.axes[2]
        }
    }

    /// How much nearer a mark is taken to be, so that the surface that it lies on does not hide it, in nearness.
    pub(super) fn lift(&self) -> f64 {
        /// Share of the radius; more lets marks shine through thin sheets, less lets coarse surfaces swallow them.
        const LIFT: f64 = 0.008;
        let depth = LIFT * self.radius;
        if self.distance.is_finite() { depth / (self.distance * self.distance) } else { depth }
    }

    /// A point on the image plane, y up, and the weight that it has by its depth.
    fn on_plane(&self, p: DVec3) -> (DVec2, f64, f64) {
        let [x, y, z] = self.axes.map(|axis| axis.dot(p - self.centre));
        if !self.distance.is_finite() {
            return (DVec2::new(x, y), z, 1.0);
        }
        let weight = 1.0 / (self.distance - z);
        (DVec2::new(x, y) * (weight * self.distance), weight, weight)
    }

    /// Points in a picture of so many samples.
    pub(super) fn project(&self, points: &[DVec3], size: [usize; 2]) -> Vec<Projected> {
        let size = DVec2::new(size[0] as f64, size[1] as f64);
        let extent = (self.high - self.low).max(DVec2::splat(f64::MIN_POSITIVE));
        let scale = (size * (1.0 - 2.0 * MARGIN) / extent).min_element();
        let middle = (self.low + self.high) * 0.5;
        let one = |&p: &DVec3| {
            let (q, nearness, weight) = self.on_plane(p);
            let from_middle = (q - middle) * scale;
            Projected { at: size * 0.5 + DVec2::new(from_middle.x, -from_middle.y), nearness, weight }
        };
        points.iter().map(one).collect()
    }
}

/// The box around the finite ones of some points; a point at the origin without any.
fn bounds(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = points.filter(|p| p.is_finite()).fold(nothing, |(l, h), p| (l.min(p), h.max(p)));
    if low.x <= high.x { (low, high) } else { (DVec3::ZERO, DVec3::ZERO) }
}
