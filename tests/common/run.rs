//! The stages one after the other, as the main job runs them.

use glam::DVec2;
use homeo::Result;
use homeo::map::atlas::BaseSample;
use homeo::map::embedding::Embedding;
use homeo::map::surface_map::{Chart, SurfaceMap, compose};
use homeo::mesh::{Id, SurfacePoint, TriMesh, VertexId};
use homeo::stage::cluster::BaseVertices;
use homeo::stage::embed::embed;
use homeo::stage::layout::{Layout, layouts};

/// Least number of nodes on an edge, as VORONOI takes it.
pub const EDGE_NODES: u32 = 3;

/// Two meshes and their landmarks, pairwise.
pub struct Pair {
    pub meshes: [TriMesh; 2],
    pub landmarks: [Vec<VertexId>; 2],
}

impl Pair {
    pub fn new(source: (TriMesh, Vec<VertexId>), target: (TriMesh, Vec<VertexId>)) -> Self {
        assert_eq!(source.1.len(), target.1.len(), "as many landmarks on both meshes");
        Pair { meshes: [source.0, target.0], landmarks: [source.1, target.1] }
    }

    fn both(&self) -> [&TriMesh; 2] {
        [&self.meshes[0], &self.meshes[1]]
    }

    /// The layout with the shortest arcs.
    pub fn layout(&self) -> Result<Layout> {
        let set = BaseVertices::grow(self.both(), self.landmarks.clone(), self.landmarks[0].len());
        let mut all = layouts(self.both(), &[set], EDGE_NODES, 1)?;
        Ok(all.swap_remove(0))
    }

    pub fn embed(&self) -> Result<Embedding> {
        Ok(embed(self.both(), self.layout()?)?.0)
    }

    /// The images of the vertices of mesh `from` on the other.
    pub fn map(&self, embedding: &Embedding, from: usize) -> Result<SurfaceMap> {
        let to = 1 - from;
        let chart = Chart::new(&self.meshes[to], &embedding.meshes[to], &embedding.base);
        compose(&embedding.meshes[from], &embedding.base, self.meshes[from].positions.len(), &chart)
    }
}

/// The place in the base complex of every image of a map onto mesh `k`, found from the cut mesh's faces alone.
pub fn places_of_images(pair: &Pair, embedding: &Embedding, k: usize, map: &SurfaceMap) -> Vec<BaseSample> {
    let (mesh, embedded) = (&pair.meshes[k], &embedding.meshes[k]);
    let mut parts = vec![Vec::new(); mesh.conn.face_count()];
    for (p, disc) in embedded.discs.iter_ids() {
        for (t, &f) in disc.faces.iter().enumerate() {
            parts[embedded.cut.face_origin[f].index()].push((p, t, embedded.cut.corner_coordinates(mesh, f)));
        }
    }
    let place = |image: &Option<SurfacePoint>| {
        let (f, b) = image.and_then(|p| p.on_face(mesh)).expect("every vertex has an image");
        let inside = |corners: &[[f64; 3]; 3]| local(corners, b).into_iter().fold(f64::INFINITY, f64::min);
        let part = parts[f.index()].iter().max_by(|x, y| inside(&x.2).total_cmp(&inside(&y.2)));
        let (p, t, corners) = part.expect("every face has parts");
        let disc = &embedded.discs[*p];
        let at: DVec2 =
            local(corners, b).iter().zip(disc.triangles[*t]).map(|(&w, v)| disc.positions[v as usize] * w).sum();
        // Rounding must not lead out of the reference triangle: on multiples of 2^-52 sums up to one are exact.
        let grid = |x: f64| (x.clamp(0.0, 1.0) * (1u64 << 52) as f64).round() / (1u64 << 52) as f64;
        let x = grid(at.x);
        let y = grid(at.y).min(1.0 - x);
        BaseSample::InPatch(*p, [1.0 - x - y, x, y])
    };
    map.images.iter().map(place).collect()
}

/// Weights of the three corners, given in barycentric coordinates, that make up the point `b`.
fn local(corners: &[[f64; 3]; 3], b: [f64; 3]) -> [f64; 3] {
    let [p, q, r, x] = [corners[0], corners[1], corners[2], b].map(|c| DVec2::new(c[1], c[2]));
    let whole = (q - p).perp_dot(r - p);
    let [v, w] = [(x - p).perp_dot(r - p) / whole, (q - p).perp_dot(x - p) / whole];
    if whole > 0.0 { [1.0 - v - w, v, w] } else { [f64::NEG_INFINITY; 3] }
}
