//! What compatible meshes have of the map: images of vertices, and the original triangles between them.

use super::domain::Domain;
use crate::mesh::metric;
use crate::solve::dirichlet::Rest;
use glam::DVec3;

/// Triangles with less than this share of the mean area have no say: their shape is rounding noise.
const NEGLIGIBLE: f64 = 1e-9;

/// What parts of triangles count for, as a share of what whole ones do: enough to keep them from collapsing.
const SHARE_OF_PARTS: f64 = 0.1;

/// Where a vertex lies on the other surface, as far as triangles are concerned.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sample {
    /// The point in space.
    pub point: DVec3,
    /// The other surface's normal there.
    pub normal: DVec3,
}

/// What triangles cost besides their energy.
#[derive(Clone, Copy, Debug)]
pub struct Price {
    /// One that is turned over, in energies of a triangle of mean area under an isometry.
    pub dread: f64,
    /// One with a larger image, as a share of its energy, times the square of the factor by which it is larger.
    pub dislike: f64,
}

/// The original triangles of one mesh with a corner in a domain, by vertices of the domain and, behind them, those outside.
pub struct Samples {
    /// So many of the triangles are whole, the others parts of them.
    pub(super) whole: usize,
    /// Their corners.
    pub(super) faces: Vec<[u32; 3]>,
    /// Their shapes in space.
    pub(super) rest: Vec<Rest>,
    /// Areas in space; 0 for triangles without a say.
    pub(super) area: Vec<f64>,
    /// What a triangle that is turned over costs.
    pub(super) dread: f64,
    /// What one with a larger image costs, as [`Price::dislike`].
    pub(super) dislike: f64,
    /// The faces around every vertex.
    pub(super) around: Vec<Vec<u32>>,
    /// Whether a vertex may move.
    pub(super) free: Vec<bool>,
    /// Images of the vertices outside, which stay.
    pub(super) outside: Vec<Sample>,
}

impl Samples {
    /// From the triangles by number of their corners, vertices of the domain first, and those outside: their points on
    /// their own mesh and where they lie on the other one. `parts` are the domain's triangles that are only parts of original
    /// ones.
    pub fn new(
        domain: &Domain,
        mut faces: Vec<[u32; 3]>,
        parts: &[[u32; 3]],
        outside: &[(DVec3, Sample)],
        free: Vec<bool>,
        price: Price,
    ) -> Self {
        let count = domain.vertices.len();
        let whole = faces.len();
        faces.extend_from_slice(parts);
        let mut around = vec![Vec::new(); count];
        for (f, corners) in (0u32..).zip(&faces) {
            corners.iter().filter(|&&v| (v as usize) < count).for_each(|&v| around[v as usize].push(f));
        }
        let point = |v: u32| domain.points.get(v as usize).copied().unwrap_or_else(|| outside[v as usize - count].0);
        let areas: Vec<f64> = faces.iter().map(|t| metric::area(t.map(point))).collect();
        let mean = areas[..whole].iter().sum::<f64>() / whole.max(1) as f64;
        let least = NEGLIGIBLE * mean;
        let share = |f: usize| if f < whole { 1.0 } else { SHARE_OF_PARTS };
        let area = areas.into_iter().enumerate().map(|(f, a)| if a > least { a * share(f) } else { 0.0 }).collect();
        let rest = faces.iter().map(|t| Rest::new(metric::flatten(t.map(point)))).collect();
        Samples {
            whole,
            faces,
            rest,
            area,
            dread: price.dread * mean,
            dislike: price.dislike,
            around,
            free,
            outside: outside.iter().map(|o| o.1).collect(),
        }
    }
}
