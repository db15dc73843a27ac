//! What triangles of one mesh see of the other one below them in a common domain.
//!
//! The map between the meshes is affine on every common part of two triangles, so its symmetric Dirichlet energy is
//! summed over the parts, each weighted with half its area on either mesh: the mean of both directions' energies. The
//! derivative takes in that parts grow and shrink as triangles move.

use super::domain::Domain;
use super::overlay::{Overlay, Part};
use super::walk::Spot;
use crate::mesh::metric;
use crate::solve::dirichlet::{Metrics, Rest};
use glam::{DVec2, DVec3};

/// Triangles with less than this share of the mean area have no say: their shape is rounding noise.
const NEGLIGIBLE: f64 = 1e-9;

/// A mesh that holds still.
pub struct Ground<'a> {
    domain: &'a Domain,
    /// The metric of every triangle, with weight 1.
    metric: Vec<Metrics>,
    /// Half the area in space per area in the plane, 0 for triangles without a say.
    density: Vec<f64>,
}

/// What a triangle sees: metrics, and by how much its energy changes because their weights do when its corners move.
pub struct Seen {
    /// The metrics.
    pub metrics: Metrics,
    /// Derivative of the energy by the corners through the weights alone.
    pub slope: [DVec2; 3],
    /// The fixed triangle at its middle.
    pub seat: u32,
}

impl Seen {
    /// Metrics whose weights do not change.
    pub fn of(metrics: Metrics) -> Self {
        Seen { metrics, slope: [DVec2::ZERO; 3], seat: 0 }
    }
}

/// A triangle over the ground.
#[derive(Clone, Copy, Debug)]
pub struct Above {
    /// Its corners in the plane.
    pub corners: [DVec2; 3],
    /// Its shape in space.
    pub rest: Rest,
    /// Its area in space.
    pub area: f64,
}

impl Above {
    /// From its corners in the plane and in space.
    pub fn new(corners: [DVec2; 3], points: [DVec3; 3]) -> Self {
        Above { corners, rest: Rest::new(metric::flatten(points)), area: metric::area(points) }
    }
}

impl<'a> Ground<'a> {
    /// Prepares the metrics of a mesh.
    pub fn new(domain: &'a Domain) -> Self {
        let areas = areas(domain);
        let floor = floor(&areas);
        let planar = |t: usize| metric::signed_area(domain.triangle(t));
        let density = |(t, &area): (usize, &f64)| if area > floor { 0.5 * area / planar(t) } else { 0.0 };
        let density = areas.iter().enumerate().map(density).collect();
        let unit = |t: u32| {
            let mut metrics = Metrics::NONE;
            metrics.add(Spot { triangle: t, weights: [0.0; 3] }.derivative(domain), 1.0);
            metrics
        };
        let metric = (0..domain.triangles.len() as u32).map(unit).collect();
        Ground { domain, metric, density }
    }

    /// The mesh.
    pub fn domain(&self) -> &'a Domain {
        self.domain
    }

    /// The metric of a triangle, with weight 1.
    pub fn metric(&self, t: u32) -> &Metrics {
        &self.metric[t as usize]
    }

    /// Half the area of a triangle in space, 0 without a say.
    pub fn weight(&self, t: u32) -> f64 {
        let density = self.density[t as usize];
        if density > 0.0 { density * metric::signed_area(self.domain.triangle(t as usize)) } else { 0.0 }
    }

    /// The overlay over this mesh.
    pub fn overlay(&self) -> Overlay<'a> {
        Overlay::new(self.domain)
    }

    /// What a triangle sees, looked for from the fixed triangle `near`; the slope is zero unless asked for.
    pub fn gather(&self, overlay: &mut Overlay, above: &Above, near: u32, slopes: bool) -> Seen {
        let Above { corners, rest, area: whole } = above;
        let planar = metric::signed_area(*corners);
        let density = 0.5 * whole / planar;
        let shrink = [0, 1, 2].map(|i| (corners[(i + 2) % 3] - corners[(i + 1) % 3]).perp() * (0.5 * density / planar));
        let seat = overlay.seat(corners, near);
        let mut seen = Seen { metrics: Metrics::NONE, slope: [DVec2::ZERO; 3], seat };
        overlay.parts(corners, seat, slopes, |Part { fixed, area, slope }| {
            let of_fixed = self.density[fixed as usize];
            if of_fixed == 0.0 {
                return;
            }
            let unit = &self.metric[fixed as usize];
            seen.metrics.add_weighted(unit, area * (density + of_fixed));
            if slopes {
                let energy = rest.energy(unit, *corners);
                for i in 0..3 {
                    seen.slope[i] += (slope[i] * (density + of_fixed) - shrink[i] * area) * energy;
                }
            }
        });
        if seen.metrics == Metrics::NONE {
            seen.metrics.add_weighted(&self.metric[seat as usize], *whole);
        }
        seen
    }
}

/// Areas of all triangles in space.
pub(super) fn areas(domain: &Domain) -> Vec<f64> {
    domain.triangles.iter().map(|t| metric::area(domain.spatial(t))).collect()
}

/// The area in space below which a triangle of a domain has no say, from the areas of all.
pub(super) fn floor(areas: &[f64]) -> f64 {
    NEGLIGIBLE * areas.iter().sum::<f64>() / areas.len() as f64
}
