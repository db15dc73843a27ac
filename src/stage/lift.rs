//! Stage: the map of simplified meshes carried back to the meshes they were made from.
//!
//! Input: an embedding of both simplified meshes. Output: an embedding of the given meshes in the same base complex: the
//! arcs where they ran, every vertex as near as can be to where its place on the simplified mesh lies. Invariant: every
//! patch is embedded.

use crate::error::{Error, Result};
use crate::map::embedding::{EmbeddedMesh, Embedding};
use crate::mesh::simplify::Simplified;
use crate::mesh::{ArcId, FaceId, Id, IdVec, LandmarkId, PatchId, SurfacePoint, TriMesh, VertexId, metric};
use crate::path::base_complex::BaseComplex;
use crate::path::lift::lift as lift_curves;
use crate::path::rebuild::{Curve, cut_along};
use crate::path::region::base_complex;
use crate::plane::convex::{embed_near, is_embedded};
use crate::plane::divide::split_dividing_edges;
use crate::plane::domain::{Domain, Points};
use crate::plane::exact_sweep::sweep_exactly;
use crate::plane::patch_disc::{PatchDisc, patch_discs, spread_shares};
use crate::plane::smooth::Smoother;
use crate::plane::stretch::Frame;
use crate::solve::dirichlet::{Metrics, Rest};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Least edge nodes of the cut meshes; no arc is traced on them any more.
const EDGE_NODES: u32 = 1;

/// Where a triangle has more than so many times the energy of an isometry to its place on the simplified mesh, its corners
/// do not wish to lie there.
const MOST_UNEVEN: f64 = 10.0;

/// Sweeps over the vertices of triangles that are not what they are on the simplified mesh.
const REPAIRS: usize = 6;

/// A patch and a place in its reference triangle.
type Place = (PatchId, DVec2);

/// Carries the embedding of simplified meshes back to the given ones.
///
/// Fails if arcs cannot be told apart in floating point on the given meshes.
pub fn lift(meshes: [&TriMesh; 2], simplified: &[Simplified; 2], embedding: &Embedding) -> Result<Embedding> {
    let Embedding { base, meshes: embedded, frames } = embedding;
    let one = |k: usize| Lift { mesh: meshes[k], simplified: &simplified[k], base, frames }.lift(&embedded[k]);
    let (source, target) = rayon::join(|| one(0), || one(1));
    Ok(Embedding { base: base.clone(), meshes: [source?, target?], frames: frames.clone() })
}

struct Lift<'a> {
    mesh: &'a TriMesh,
    simplified: &'a Simplified,
    base: &'a BaseComplex,
    frames: &'a IdVec<PatchId, Frame>,
}

impl Lift<'_> {
    fn lift(&self, embedded: &EmbeddedMesh) -> Result<EmbeddedMesh> {
        let Lift { mesh, simplified, base, frames } = *self;
        let curves = lift_curves(mesh, simplified, &curves(embedded, base));
        let landmarks: Vec<VertexId> = embedded.cut.landmarks.iter().map(|&v| simplified.kept[v]).collect();
        let (mut cut, shares) = cut_along(mesh, &curves, &landmarks, EDGE_NODES)?;
        // Flips may have left the patches in another order.
        let [found, wanted] = [base_complex(&cut, &base.arcs)?, base.clone()].map(|base| {
            let mut patches = base.patches.raw;
            patches.sort_unstable();
            patches
        });
        if found != wanted {
            return Err(Error::bug("the layout of the simplified mesh has other patches on the mesh itself"));
        }
        let shares = shares.iter().map(|shares| spread_shares(shares)).collect();
        split_dividing_edges(&mut cut, mesh);
        let mut discs = patch_discs(&cut, base, &shares)?;
        let places = self.places(embedded);
        let embed = |(p, disc): (usize, &mut PatchDisc)| {
            let p = PatchId::new(p);
            let points: Vec<DVec3> = disc.vertices.iter().map(|&v| cut.positions[v]).collect();
            let wish = |v: &VertexId| {
                let (q, place) = (*places.raw.get(v.index())?)?;
                (q == p).then_some(place)
            };
            let wishes: Vec<Option<DVec2>> = disc.vertices.iter().map(wish).collect();
            let vertices = disc.vertices.clone();
            let is_fair = |t: &[u32; 3]| self.is_fair(t.map(|v| vertices[v as usize]));
            embed_near(disc, &points, &frames[p], &wishes, &is_fair)
                .ok_or_else(|| Error::bug("a patch cannot be embedded in double precision").at(p))?;
            self.repair(disc, &|v| cut.positions[v], &embedded.discs[p], &|v| embedded.cut.positions[v]);
            Ok(())
        };
        discs.raw.par_iter_mut().enumerate().map(embed).collect::<Result<()>>()?;
        Ok(EmbeddedMesh { cut, shares, discs })
    }

    /// Moves vertices whose triangles are not what they are on the simplified mesh.
    fn repair(&self, disc: &mut PatchDisc, points: Points, simple: &PatchDisc, simple_points: Points) {
        let below = Domain::of_patch(simple, simple_points);
        let mut domain = Domain::of_patch(disc, points);
        for _ in 0..REPAIRS {
            sweep_exactly(&mut Smoother::new(&mut domain, &below));
        }
        if is_embedded(disc, &domain.positions) {
            disc.positions = domain.positions;
        }
    }

    /// True unless the places of a triangle's corners on the simplified mesh make up a triangle of quite another shape.
    fn is_fair(&self, corners: [VertexId; 3]) -> bool {
        let Simplified { mesh: simple, images, .. } = self.simplified;
        let place = |v: VertexId| Some((*images.raw.get(v.index())?)?.position(simple));
        let [Some(a), Some(b), Some(c)] = corners.map(place) else { return true };
        let plane = metric::flatten([a, b, c]);
        let surface = corners.map(|v| self.mesh.positions[v]);
        let energy = Rest::new(metric::flatten(surface)).energy(&Metrics::identity(metric::area(surface)), plane);
        energy < MOST_UNEVEN * metric::area(surface)
    }

    /// Where every vertex lies in the base complex by its place on the simplified mesh, if that is inside a patch.
    fn places(&self, embedded: &EmbeddedMesh) -> IdVec<VertexId, Option<Place>> {
        let Simplified { mesh: simple, images, .. } = self.simplified;
        let EmbeddedMesh { cut, discs, .. } = embedded;
        let mut triangle_of: IdVec<FaceId, (PatchId, u32)> = IdVec::filled((PatchId(0), 0), cut.conn.face_count());
        for (p, disc) in discs.iter_ids() {
            (0u32..).zip(&disc.faces).for_each(|(t, &f)| triangle_of[f] = (p, t));
        }
        let mut parts: IdVec<FaceId, Vec<FaceId>> = IdVec::filled(Vec::new(), simple.conn.face_count());
        cut.face_origin.iter_ids().for_each(|(part, &f)| parts[f].push(part));
        let place = |image: &Option<SurfacePoint>| {
            let (f, b) = (*image)?.on_face(simple)?;
            let weights = parts[f].iter().map(|&part| (part, weights_in(cut.corner_coordinates(simple, part), b)));
            let least = |w: &[f64; 3]| w.iter().copied().fold(f64::INFINITY, f64::min);
            let (part, weights) = weights.max_by(|a, b| least(&a.1).total_cmp(&least(&b.1)))?;
            let (p, t) = triangle_of[part];
            let corners = discs[p].triangles[t as usize].map(|v| discs[p].positions[v as usize]);
            Some((p, (0..3).map(|i| corners[i] * weights[i]).sum()))
        };
        IdVec::from_raw(images.raw.par_iter().map(place).collect())
    }
}

/// The arcs of an embedded mesh as curves.
fn curves(embedded: &EmbeddedMesh, base: &BaseComplex) -> IdVec<ArcId, Curve> {
    let cut = &embedded.cut;
    let curve = |(arc, ends): (ArcId, &[LandmarkId; 2])| {
        let first = std::iter::once(cut.landmarks[ends[0]]);
        let path = first.chain(cut.arc_path(arc, ends[0]).into_iter().map(|h| cut.conn.to(h)));
        path.map(|v| cut.origin[v]).zip(embedded.shares[arc].iter().copied()).collect()
    };
    base.arcs.iter_ids().map(curve).collect()
}

/// The weights of a triangle's corners that make up a point, all in barycentric coordinates of one face.
fn weights_in(corners: [[f64; 3]; 3], point: [f64; 3]) -> [f64; 3] {
    let flat = |x: [f64; 3]| DVec2::new(x[1], x[2]);
    metric::barycentric(corners.map(flat), flat(point))
}
