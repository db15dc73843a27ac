//! The surface map: source -> base complex -> target, composed exactly through the patch embeddings.

use super::atlas::BaseSample;
use super::embedding::EmbeddedMesh;
use crate::error::{Error, Result};
use crate::mesh::{ArcId, HalfedgeId, Id, IdVec, PatchId, SurfacePoint, TriMesh, VertexId, face_of};
use crate::path::base_complex::BaseComplex;
use crate::plane::locate::Locator;
use glam::DVec2;
use rayon::prelude::*;

/// For every vertex of one mesh its image on the other.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceMap {
    /// Image points; an unreferenced vertex has none.
    pub images: IdVec<VertexId, Option<SurfacePoint>>,
}

/// Finds points of one mesh from their place in the base complex.
pub struct Chart<'a> {
    mesh: &'a TriMesh,
    embedded: &'a EmbeddedMesh,
    locators: Vec<Locator<'a>>,
    arc_paths: IdVec<ArcId, Vec<HalfedgeId>>,
}

impl<'a> Chart<'a> {
    /// Prepares all patches of a mesh for location.
    pub fn new(mesh: &'a TriMesh, embedded: &'a EmbeddedMesh, base: &BaseComplex) -> Self {
        let locators =
            embedded.discs.raw.par_iter().map(|disc| Locator::new(&disc.positions, &disc.triangles)).collect();
        let arc_paths = base.arcs.iter_ids().map(|(arc, ends)| embedded.cut.arc_path(arc, ends[0])).collect();
        Chart { mesh, embedded, locators, arc_paths }
    }

    /// The point of the original mesh at a place of the base complex.
    pub fn point(&self, sample: BaseSample) -> Result<SurfacePoint> {
        match sample {
            BaseSample::Landmark(l) => Ok(SurfacePoint::Vertex(self.embedded.landmark(l))),
            BaseSample::OnArc(arc, s) => Ok(self.on_arc(arc, s)),
            BaseSample::InPatch(p, b) => {
                let lost = || Error::bug("a point of the base complex has no image").at(format!("{p}, {b:?}"));
                let (t, weights) = self.locators[p.index()].locate(DVec2::new(b[1], b[2])).ok_or_else(lost)?;
                Ok(self.embedded.original_point(self.mesh, self.embedded.discs[p].faces[t], weights))
            }
        }
    }

    /// The point at share `s` in [0, 1] of an arc.
    fn on_arc(&self, arc: ArcId, s: f64) -> SurfacePoint {
        let shares = &self.embedded.shares[arc];
        let i = shares.partition_point(|&x| x <= s).clamp(1, shares.len() - 1) - 1;
        let t = (s - shares[i]) / (shares[i + 1] - shares[i]);
        let h = self.arc_paths[arc][i];
        let mut weights = [0.0; 3];
        weights[h.index() % 3] = 1.0 - t;
        weights[(h.index() + 1) % 3] = t;
        self.embedded.original_point(self.mesh, face_of(h), weights)
    }
}

/// The place in the base complex of every vertex of the original mesh; None for unreferenced vertices.
pub fn places(embedded: &EmbeddedMesh, base: &BaseComplex, vertices: usize) -> IdVec<VertexId, Option<BaseSample>> {
    let mut places = IdVec::filled(None, vertices);
    for (p, disc) in embedded.discs.iter_ids() {
        for i in disc.boundary..disc.vertices.len() {
            let v = disc.vertices[i];
            if v.index() < vertices {
                places[v] = Some(inner_place(p, disc.positions[i]));
            }
        }
    }
    for (arc, ends) in base.arcs.iter_ids() {
        for (i, h) in embedded.cut.arc_path(arc, ends[0]).into_iter().enumerate().skip(1) {
            let v = embedded.cut.conn.from(h);
            if v.index() < vertices {
                places[v] = Some(BaseSample::OnArc(arc, embedded.shares[arc][i]));
            }
        }
    }
    for (l, &v) in embedded.cut.landmarks.iter_ids() {
        places[v] = Some(BaseSample::Landmark(l));
    }
    places
}

fn inner_place(p: PatchId, at: DVec2) -> BaseSample {
    BaseSample::InPatch(p, [1.0 - at.x - at.y, at.x, at.y])
}

/// Maps every vertex of the mesh embedded as `from` onto the mesh of `chart`.
pub fn compose(from: &EmbeddedMesh, base: &BaseComplex, vertices: usize, chart: &Chart) -> Result<SurfaceMap> {
    let image = |place: &Option<BaseSample>| place.map(|p| chart.point(p)).transpose();
    let images: Result<Vec<_>> = places(from, base, vertices).raw.par_iter().map(image).collect();
    Ok(SurfaceMap { images: IdVec::from_raw(images?) })
}
