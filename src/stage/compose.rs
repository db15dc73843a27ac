//! Stage: the map itself, both ways, and its certificate.
//!
//! Input: both meshes embedded in the base complex. Output: where every vertex of either mesh lies on the other, the arcs
//! as curves, and what the certificate says.

use super::check::Checked;
use crate::error::Result;
use crate::map::certificate::{Certificate, certify};
use crate::map::embedding::{EmbeddedMesh, Embedding};
use crate::map::surface_map::{Chart, SurfaceMap, compose as compose_one};
use crate::mesh::{ArcId, Canonical, Id, IdVec, LandmarkId, SurfacePoint, TriMesh, VertexId};
use crate::path::base_complex::BaseComplex;

/// A finished map.
#[derive(Clone, Debug)]
pub struct Composed {
    /// Both meshes over the base complex.
    pub embedding: Embedding,
    /// Source to target, and target to source.
    pub maps: [SurfaceMap; 2],
    /// The arcs on either mesh, each from its first end to its second.
    pub arcs: [IdVec<ArcId, Vec<SurfacePoint>>; 2],
    /// Why the map is a bijection.
    pub certificate: Certificate,
}

/// A certified map in terms of the files: their vertices, faces and landmarks by their own numbers.
#[derive(Clone, Debug)]
pub struct CertifiedMap {
    /// The base complex; auxiliary vertices are numbered behind the landmarks.
    pub base: BaseComplex,
    /// Source to target, and target to source.
    pub maps: [SurfaceMap; 2],
    /// The arcs on either mesh, each from its first end to its second.
    pub arcs: [IdVec<ArcId, Vec<SurfacePoint>>; 2],
    /// Why the map is a bijection.
    pub certificate: Certificate,
}

/// Leaves the canonical order in which the stages work.
pub fn in_file_terms(checked: &Checked, composed: Composed) -> CertifiedMap {
    let Composed { embedding: Embedding { base, .. }, mut maps, mut arcs, certificate } = composed;
    let base = base_in_file_terms(checked, base);
    let orders = [&checked.source.canonical, &checked.target.canonical];
    for k in 0..2 {
        maps[k].images = images_there(&maps[k].images, [orders[k], orders[1 - k]]);
        arcs[k].raw.iter_mut().flatten().for_each(|point| *point = orders[k].point_there(*point));
    }
    CertifiedMap { base, maps, arcs, certificate }
}

/// The same base complex with the landmarks numbered as in their file.
pub fn base_in_file_terms(checked: &Checked, mut base: BaseComplex) -> BaseComplex {
    let number = |l: LandmarkId| checked.landmark_order.get(l.index()).map_or(l, |&given| LandmarkId::new(given));
    base.arcs.raw.iter_mut().for_each(|ends| *ends = ends.map(number));
    base
}

/// Images in terms of the files, those of appended vertices behind the others; `orders` are the canonical orders of the
/// mesh whose vertices have images, and of the other.
pub fn images_there(
    images: &IdVec<VertexId, Option<SurfacePoint>>,
    orders: [&Canonical; 2],
) -> IdVec<VertexId, Option<SurfacePoint>> {
    let own = orders[0].mesh.positions.len();
    let here = |v: VertexId| if v.index() < own { orders[0].vertex(v) } else { v };
    images.ids().map(|v| images[here(v)].map(|point| orders[1].point_there(point))).collect()
}

/// Composes the map both ways and certifies it.
pub fn compose(meshes: [&TriMesh; 2], embedding: Embedding) -> Result<Composed> {
    let Embedding { base, meshes: embedded, .. } = &embedding;
    let one_way = |from: usize, onto: usize| {
        let chart = Chart::new(meshes[onto], &embedded[onto], base);
        compose_one(&embedded[from], base, meshes[from].positions.len(), &chart)
    };
    let (forward, backward) = rayon::join(|| one_way(0, 1), || one_way(1, 0));
    let maps = [forward?, backward?];
    let arcs = [curves(&embedded[0], base), curves(&embedded[1], base)];
    let certificate = certify(&embedding);
    Ok(Composed { embedding, maps, arcs, certificate })
}

fn curves(embedded: &EmbeddedMesh, base: &BaseComplex) -> IdVec<ArcId, Vec<SurfacePoint>> {
    let cut = &embedded.cut;
    let curve = |(arc, ends): (ArcId, &[LandmarkId; 2])| {
        let starts = cut.arc_path(arc, ends[0]).into_iter().map(|h| cut.origin[cut.conn.from(h)]);
        starts.chain([SurfacePoint::Vertex(cut.landmarks[ends[1]])]).collect()
    };
    base.arcs.iter_ids().map(curve).collect()
}
