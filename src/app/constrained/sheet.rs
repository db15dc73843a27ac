//! A disc in space and in the plane, its features, and what surrounds it.

use crate::error::{Error, Result};
use crate::mesh::{Id, TriMesh, VertexId, metric};
use crate::plane::domain::Domain;
use crate::plane::orientation::orientation;
use crate::plane::scaffold::scaffold;
use glam::{DVec2, DVec3};

/// Points on a side of the border, one corner included.
pub(super) const SIDE: usize = 6;
/// Points between the boundary and the ring are this share of the ring's extent apart.
const SPACING: f64 = 0.06;
/// All scaffold triangles together count as much as this share of the disc.
const SCAFFOLD_SHARE: f64 = 0.01;

/// A vertex that must come to lie at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feature {
    /// The disc's vertex.
    pub vertex: u32,
    /// Its place, v up.
    pub place: DVec2,
}

/// Points along the border of the unit square, counter-clockwise.
pub fn border() -> Vec<DVec2> {
    let side = |k: usize, t: f64| match k {
        0 => DVec2::new(t, 0.0),
        1 => DVec2::new(1.0, t),
        2 => DVec2::new(1.0 - t, 1.0),
        _ => DVec2::new(0.0, 1.0 - t),
    };
    (0..4 * SIDE).map(|i| side(i / SIDE, (i % SIDE) as f64 / SIDE as f64)).collect()
}

/// A disc in the plane.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Vertices in space.
    pub points: Vec<DVec3>,
    /// Triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Triangles from here on fill holes: they must not fold, but their shape does not matter.
    pub real: usize,
    /// Vertices in the plane.
    pub uv: Vec<DVec2>,
    /// The boundary, counter-clockwise.
    pub boundary: Vec<u32>,
    /// Vertices with a place.
    pub features: Vec<Feature>,
    /// The convex ring that the boundary may not leave, counter-clockwise.
    pub ring: Vec<DVec2>,
}

impl Sheet {
    /// A disc that is nowhere in the plane yet; `mesh` has one boundary loop and no vertex without triangles.
    pub fn new(mesh: &TriMesh, real: usize, features: Vec<Feature>) -> Result<Self> {
        let loops = mesh.conn.boundary_loops();
        let [boundary] = &loops[..] else { return Err(Error::bug("a disc has one boundary")) };
        Ok(Sheet {
            points: mesh.positions.raw.clone(),
            triangles: mesh.faces().iter().map(|t| t.map(|v| v.0)).collect(),
            real,
            uv: vec![DVec2::ZERO; mesh.positions.len()],
            boundary: boundary.iter().map(|&h| mesh.conn.from(h).0).collect(),
            features,
            ring: border(),
        })
    }

    /// The corners of a triangle in space.
    pub fn spatial(&self, t: usize) -> [DVec3; 3] {
        self.triangles[t].map(|v| self.points[v as usize])
    }

    /// The corners of a triangle in the plane.
    pub fn planar(&self, t: usize) -> [DVec2; 3] {
        self.triangles[t].map(|v| self.uv[v as usize])
    }

    /// Triangles that are not exactly counter-clockwise.
    pub fn folded(&self) -> usize {
        let folds = |&t: &usize| {
            let [a, b, c] = self.planar(t);
            let turn = orientation(a, b, c);
            turn.is_nan() || turn <= 0.0
        };
        (0..self.triangles.len()).filter(folds).count()
    }

    /// True if every feature is at its place, to the last bit.
    pub fn is_met(&self) -> bool {
        self.features.iter().all(|f| self.uv[f.vertex as usize] == f.place)
    }

    /// The disc and its scaffold as a domain in which all but the ring and the features may move; then how large a
    /// triangle wants to be and how much it counts.
    ///
    /// `weight` is how much a disc's triangle counts for its area. None if the boundary has met itself.
    pub fn framed(&self, weight: &[f64]) -> Option<Framed> {
        let boundary: Vec<DVec2> = self.boundary.iter().map(|&v| self.uv[v as usize]).collect();
        let extent = self.ring.iter().map(|p| p.distance(self.ring[0])).fold(0.0, f64::max);
        let around = scaffold(&boundary, &self.ring, SPACING * extent)?;
        let (disc, n) = (self.uv.len(), boundary.len() as u32);
        let number = |v: u32| if v < n { self.boundary[v as usize] } else { disc as u32 + v - n };
        let positions: Vec<DVec2> = self.uv.iter().chain(&around.points).copied().collect();
        let outer = around.triangles.iter().map(|t| t.map(number));
        let triangles: Vec<[u32; 3]> = self.triangles.iter().copied().chain(outer).collect();
        let mut free = vec![true; positions.len()];
        free[disc..disc + around.ring].fill(false);
        self.features.iter().for_each(|f| free[f.vertex as usize] = false);
        let scale = self.balanced_scale(weight);
        let (mut shapes, mut weights) = (Vec::with_capacity(triangles.len()), weight.to_vec());
        let mut counted = 0.0;
        for (t, corners) in triangles.iter().enumerate() {
            if t < self.real {
                shapes.push(metric::flatten(self.spatial(t).map(|p| p * scale)));
                counted += metric::signed_area(shapes[t]) * weight[t];
            } else {
                shapes.push(corners.map(|v| positions[v as usize]));
            }
        }
        let virtual_share = SCAFFOLD_SHARE * counted / (triangles.len() - self.real) as f64;
        weights.truncate(self.real);
        weights.extend(shapes[self.real..].iter().map(|&s| virtual_share / metric::signed_area(s)));
        let vertices = (0..positions.len()).map(VertexId::new).collect();
        let domain = Domain { vertices, positions, free, triangles, ..Domain::default() };
        Some(Framed { domain, shapes, weights })
    }

    /// How large the unit of space is in the plane for the energy to be least: then stretching and shrinking cost the same,
    /// and what a round of relaxation gains the next does not lose.
    fn balanced_scale(&self, weight: &[f64]) -> f64 {
        let scale = self.scale(weight);
        let (mut stretched, mut shrunk) = (0.0, 0.0);
        for (t, weight) in weight.iter().enumerate().take(self.real) {
            let rest = self.spatial(t).map(|p| p * scale);
            let area = weight * metric::area(rest);
            if area <= 0.0 {
                continue;
            }
            let (large, small) = metric::singular_values(rest, self.planar(t).map(|p| p.extend(0.0)));
            stretched += area * (large * large + small * small);
            shrunk += area * (1.0 / (large * large) + 1.0 / (small * small));
        }
        let balance = (stretched / shrunk).powf(0.25);
        if balance.is_normal() { scale * balance } else { scale }
    }

    /// Area in the plane per area in space.
    pub fn unit(&self) -> f64 {
        self.scale(&vec![1.0; self.real]).powi(2)
    }

    /// How large the unit of space is in the plane, by areas.
    fn scale(&self, weight: &[f64]) -> f64 {
        let (mut plane, mut space) = (0.0, 0.0);
        for (t, weight) in weight.iter().enumerate().take(self.real) {
            plane += weight * metric::signed_area(self.planar(t));
            space += weight * metric::area(self.spatial(t));
        }
        (plane / space).sqrt()
    }
}

/// A disc and its scaffold, ready to be relaxed.
pub struct Framed {
    /// Both; the disc's vertices and triangles come first.
    pub domain: Domain,
    /// What every triangle should look like.
    pub shapes: Vec<[DVec2; 3]>,
    /// How much each counts for its area.
    pub weights: Vec<f64>,
}
