//! Whether a Steiner vertex taken out leaves the triangles around in shape.

use super::sheet::Sheet;
use super::subdivided::{Pull, Subdivided};
use crate::mesh::metric;
use crate::plane::stretch::l2_sq;
use glam::DVec2;

/// Where the stretch is greater than what is fair already it may grow by this factor: with less vertices stay in a crowd that
/// are not to blame for it, with more the crowd gets worse from time to time.
const WORSE: f64 = 1.5;

/// What is fair on a disc.
#[derive(Clone, Copy, Debug)]
pub struct Fair {
    /// Parts of given triangles from this one on fill holes; their shape does not matter.
    real: usize,
    /// A mean squared stretch that is no reason to keep a vertex.
    most: f64,
}

impl Fair {
    /// For a disc whose first `real` given triangles do not fill holes; `most` is the mean squared stretch that is no reason
    /// to keep a vertex, 1 for an isometry up to the disc's scale.
    pub fn new(sheet: &Sheet, real: usize, most: f64) -> Self {
        Fair { real, most: most / sheet.unit() }
    }

    /// True if the stretch around a vertex that is pulled onto another one, which then lies at `place`, stays within what is
    /// fair, or grows by no more than [`WORSE`].
    pub fn allows(&self, sheet: &Sheet, sub: &Subdivided, pull: &Pull, place: DVec2) -> bool {
        let moved = sub.fan(pull.onto).iter().filter(|t| !pull.dying.contains(t));
        let around = sub.fan(pull.from).iter().chain(moved);
        let (mut before, mut after, mut whole) = (0.0, 0.0, 0.0);
        for &t in around.filter(|&&t| (sub.part_of[t as usize] as usize) < self.real) {
            let corners = sub.triangles[t as usize];
            let spatial = corners.map(|v| sheet.points[v as usize]);
            let area = metric::area(spatial);
            whole += area;
            before += l2_sq(corners.map(|v| sheet.uv[v as usize]), spatial) * area;
            if !pull.dying.contains(&t) {
                let pulled = corners.map(|v| if v == pull.from { pull.onto } else { v });
                let planar = pulled.map(|v| if v == pull.onto { place } else { sheet.uv[v as usize] });
                let spatial = pulled.map(|v| sheet.points[v as usize]);
                after += l2_sq(planar, spatial) * metric::area(spatial);
            }
        }
        after <= self.most * whole || after <= WORSE * before
    }
}
