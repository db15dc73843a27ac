//! The map at any point of a surface, not at vertices alone.

use super::atlas::BaseSample;
use super::embedding::{EmbeddedMesh, Embedding};
use super::surface_map::Chart;
use crate::mesh::{FaceId, IdVec, PatchId, SurfacePoint, TriMesh, metric};
use glam::DVec2;

/// Takes points of one mesh to the other one.
pub struct Lift<'a> {
    mesh: &'a TriMesh,
    embedded: &'a EmbeddedMesh,
    /// For every original face the embedded triangles in it.
    parts: IdVec<FaceId, Vec<(PatchId, u32)>>,
    chart: Chart<'a>,
}

impl<'a> Lift<'a> {
    /// From mesh `from` of an embedding, 0 or 1, to the other.
    pub fn new(meshes: [&'a TriMesh; 2], embedding: &'a Embedding, from: usize) -> Self {
        let embedded = &embedding.meshes[from];
        let mut parts = IdVec::filled(Vec::new(), meshes[from].conn.face_count());
        for (p, disc) in embedded.discs.iter_ids() {
            for (t, &f) in (0u32..).zip(&disc.faces) {
                parts[embedded.cut.face_origin[f]].push((p, t));
            }
        }
        let chart = Chart::new(meshes[1 - from], &embedding.meshes[1 - from], &embedding.base);
        Lift { mesh: meshes[from], embedded, parts, chart }
    }

    /// The image of a point; none for a vertex that no face uses.
    pub fn image(&self, point: SurfacePoint) -> Option<SurfacePoint> {
        let (f, b) = point.on_face(self.mesh)?;
        let at = DVec2::new(b[1], b[2]);
        let least = |(_, w): &((PatchId, u32), [f64; 3])| w.iter().copied().fold(f64::INFINITY, f64::min);
        let found = self.parts[f].iter().map(|&part| (part, self.weights(part, at)));
        let ((p, t), weights) = found.max_by(|a, b| least(a).total_cmp(&least(b)))?;
        let disc = &self.embedded.discs[p];
        let inside = weights.map(|w| w.max(0.0));
        let sum: f64 = inside.iter().sum();
        let corners = disc.triangles[t as usize].map(|v| disc.positions[v as usize]);
        let q: DVec2 = corners.iter().zip(inside).map(|(&c, w)| c * (w / sum)).sum();
        self.chart.point(BaseSample::InPatch(p, [1.0 - q.x - q.y, q.x, q.y])).ok()
    }

    /// The weights of an embedded triangle's corners at barycentric coordinates of its original face.
    fn weights(&self, (p, t): (PatchId, u32), at: DVec2) -> [f64; 3] {
        let f = self.embedded.discs[p].faces[t as usize];
        let corners = self.embedded.cut.corner_coordinates(self.mesh, f);
        metric::barycentric(corners.map(|b| DVec2::new(b[1], b[2])), at)
    }
}
