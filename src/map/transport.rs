//! Takes points of one mesh through a finished map to the other one, in terms of the files.

use super::charts::{ChartedMesh, ChartedPatch, Charts};
use crate::mesh::metric;
use crate::plane::locate::Locator;
use glam::{DMat2, DVec2};
use rayon::prelude::*;

/// The centre of the reference triangle.
const CENTRE: DVec2 = DVec2::splat(1.0 / 3.0);
/// How far towards the centre a point goes that lies outside by rounding.
const INWARDS: f64 = 1e-12;

/// Where a point comes out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// The triangle of the other mesh's file.
    pub face: u32,
    /// Weights of its corners.
    pub b: [f64; 3],
    /// The derivative of the weights of its second and third corner by those of the triangle that the point came from,
    /// or by the point of the reference triangle.
    pub derivative: DMat2,
}

/// The way from one mesh to the other.
pub struct Transport<'a> {
    from: &'a ChartedMesh,
    onto: &'a ChartedMesh,
    /// For every triangle of the file its parts: patch and triangle there; the parts of triangle i are `parts[starts[i]..starts[i + 1]]`.
    starts: Vec<u32>,
    parts: Vec<[u32; 2]>,
    locators: Vec<Locator<'a>>,
}

impl<'a> Transport<'a> {
    /// From mesh `from`, 0 for the source or 1 for the target, to the other; `points` are those of the other mesh.
    pub fn new(charts: &'a Charts, from: usize, points: &'a [Vec<DVec2>]) -> Self {
        let [from, onto] = [&charts.meshes[from], &charts.meshes[1 - from]];
        let mut starts = vec![0u32; from.triangles as usize + 1];
        let faces = || from.patches.iter().flat_map(|patch| &patch.faces);
        faces().for_each(|&f| starts[f as usize + 1] += 1);
        (0..from.triangles as usize).for_each(|i| starts[i + 1] += starts[i]);
        let mut next = starts.clone();
        let mut parts = vec![[0; 2]; starts[from.triangles as usize] as usize];
        for (p, patch) in (0u32..).zip(&from.patches) {
            for (t, &f) in (0u32..).zip(&patch.faces) {
                parts[next[f as usize] as usize] = [p, t];
                next[f as usize] += 1;
            }
        }
        let locators = onto.patches.par_iter().zip(points);
        let locators = locators.map(|(patch, points)| Locator::new(points, &patch.triangles)).collect();
        Transport { from, onto, starts, parts, locators }
    }

    /// Where the point at weights `b` of a triangle's corners comes out; none in triangles that are left out of the map.
    pub fn image(&self, face: u32, b: [f64; 3]) -> Option<Arrival> {
        let at = DVec2::new(b[1], b[2]);
        let range = *self.starts.get(face as usize)? as usize..*self.starts.get(face as usize + 1)? as usize;
        let least = |(_, w): &([u32; 2], [f64; 3])| w.iter().copied().fold(f64::INFINITY, f64::min);
        let found = self.parts[range].iter().map(|&part| (part, metric::barycentric(self.corners(part), at)));
        let ([p, t], w) = found.max_by(|x, y| least(x).total_cmp(&least(y)))?;
        let inside = w.map(|w| w.max(0.0));
        let sum: f64 = inside.iter().sum();
        let corners = corners_in_reference(&self.from.patches[p as usize], t);
        let q: DVec2 = corners.iter().zip(inside).map(|(&c, w)| c * (w / sum)).sum();
        let arrival = self.arrive(p, q)?;
        let derivative = arrival.derivative * edges(corners) * edges(self.corners([p, t])).inverse();
        Some(Arrival { derivative, ..arrival })
    }

    /// The point of the other mesh at a point of a patch's reference triangle.
    pub fn arrive(&self, p: u32, q: DVec2) -> Option<Arrival> {
        let patch = &self.onto.patches[p as usize];
        let locator = &self.locators[p as usize];
        // Rounding may put a point of a side beyond it.
        let q = q.max(DVec2::ZERO);
        let q = q / (q.x + q.y).max(1.0);
        let (t, w) = locator.locate(q).or_else(|| locator.locate(q.lerp(CENTRE, INWARDS)))?;
        let corners = patch.corners[t].map(|c| DVec2::from_array(c.map(f64::from)));
        let at: DVec2 = corners.iter().zip(w).map(|(&c, w)| c * w).sum();
        let derivative = edges(corners) * edges(corners_in_reference(patch, t as u32)).inverse();
        Some(Arrival { face: patch.faces[t], b: [1.0 - at.x - at.y, at.x, at.y], derivative })
    }

    /// The corners of a part, in weights of its face.
    fn corners(&self, [p, t]: [u32; 2]) -> [DVec2; 3] {
        self.from.patches[p as usize].corners[t as usize].map(|c| DVec2::from_array(c.map(f64::from)))
    }
}

/// The points of all patches of a mesh, for [`Transport::new`].
pub fn reference_points(mesh: &ChartedMesh) -> Vec<Vec<DVec2>> {
    mesh.patches.iter().map(ChartedPatch::positions).collect()
}

fn corners_in_reference(patch: &ChartedPatch, t: u32) -> [DVec2; 3] {
    patch.triangles[t as usize].map(|v| DVec2::from_array(patch.points[v as usize]))
}

/// The matrix that takes the unit vectors to a triangle's edges at its first corner.
fn edges([a, b, c]: [DVec2; 3]) -> DMat2 {
    DMat2::from_cols(b - a, c - a)
}
