//! Stage: the compatible meshes themselves relaxed.
//!
//! Input: a relaxed embedding. Output: the same with some vertices moved a little, so that the sampled triangles of both
//! meshes have less energy and fewer of them are turned over. Invariant: every patch stays embedded.

use super::levels::CRUSHED;
use super::relax::{LEAST_SNAP, domains, independent_domains, thin_domains, unit_scale};
use super::visits::Visits;
use crate::deadline;
use crate::error::Result;
use crate::map::embedding::Embedding;
use crate::map::recut::{Relaxed, recut_all};
use crate::map::surface_map::{Chart, compose};
use crate::mesh::{FaceId, IdVec, SurfacePoint, TriMesh, VertexId, face_of, metric};
use crate::plane::domain::Domain;
use crate::plane::polish::polish;
use crate::plane::samples::{Price, Sample, Samples};
use crate::plane::straighten::straighten;
use crate::plane::tiling::Tiling;
use crate::solve::dirichlet::{Metrics, Rest};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};

/// What a triangle that is turned over costs in every visit of all domains, in energies of a triangle of mean area under
/// an isometry: much at first, when the most can be turned back, then less, so that none stays badly stretched for it.
pub const DREAD: [f64; 6] = [3000.0, 1000.0, 400.0, 400.0, 400.0, 400.0];
/// The same for large meshes, where a round takes long and the first brings nearly all.
pub const HASTY_DREAD: [f64; 2] = [3000.0, 300.0];
/// What a triangle costs for an image that is larger, as a share of its energy, times the square of the factor by which it is
/// larger. With less, E_L2 is that of a few triangles that span limbs of the other surface; with more, the others bend for
/// them. Where a domain is crushed this is no help: all it has swells.
const DISLIKE: f64 = 0.03;
/// The round from which on they may end: in those before, the dread falls.
const EARLIEST_END: usize = 2;
/// A visit that lowers the energy by a smaller share of the domain's area leaves it settled.
const LITTLE: f64 = 0.002;
/// Visits of a domain's vertices in one visit of the domain.
const SWEEPS: usize = 2;
/// Where the vertices of the source lie on the target, and the other way round.
type Images = [IdVec<VertexId, Sample>; 2];

/// What polishing brought.
#[derive(Clone, Debug)]
pub struct Polish {
    /// So many fewer triangles are turned over.
    pub turned_back: isize,
    /// Symmetric Dirichlet energy of the compatible meshes, mean of both: before, and after every round.
    pub energies: Vec<f64>,
}

/// Polishes both compatible meshes, a round for every `dread` of triangles that are turned over. It ends sooner when a round
/// lowers their energy, less that of an isometry, by less than the share `tolerance`.
pub fn polish_samples(
    meshes: [&TriMesh; 2],
    embedding: &mut Embedding,
    tolerance: f64,
    dread: &[f64],
) -> Result<Polish> {
    let scale = unit_scale(meshes);
    let groups = independent_domains(embedding);
    let mut images = locate(meshes, embedding, scale)?;
    let mut turned_back = 0;
    let mut energies = vec![sampled_energy(meshes, &images, scale)];
    let mut visits = Visits::none(&groups, embedding.base.patches.len(), LITTLE);
    for (round, &now) in dread.iter().enumerate() {
        if round > 0 && now != dread[round - 1] {
            visits = Visits::none(&groups, embedding.base.patches.len(), LITTLE);
        }
        for (g, group) in groups.iter().enumerate() {
            deadline::check()?;
            let one = |tiling: &&Tiling| visit(meshes, embedding, &images, tiling, scale, now);
            let results = visits.group(g, group, |due| Ok(due.par_iter().map(one).collect()))?;
            let mut relaxed = Vec::with_capacity(results.len());
            for result in results {
                relaxed.push(result.map(|visited| {
                    turned_back += visited.turned_back;
                    for (k, moved) in visited.images.into_iter().enumerate() {
                        moved.into_iter().for_each(|(v, sample)| images[k][v] = sample);
                    }
                    visited.relaxed
                }));
            }
            let changed: Vec<_> =
                group.iter().zip(&relaxed).filter_map(|(t, sides)| Some((t, sides.as_ref()?))).collect();
            recut_all(meshes, embedding, &changed)?;
        }
        let after = sampled_energy(meshes, &images, scale);
        let is_settled = after - 1.0 > (energies[round] - 1.0) * (1.0 - tolerance);
        energies.push(after);
        if round >= EARLIEST_END && is_settled {
            break;
        }
    }
    Ok(Polish { turned_back, energies })
}

/// The outcome of polishing a domain.
struct Visited {
    turned_back: isize,
    images: [Vec<(VertexId, Sample)>; 2],
    relaxed: [Relaxed; 2],
}

/// Where all vertices lie, in meshes scaled to unit area.
fn locate(meshes: [&TriMesh; 2], embedding: &Embedding, scale: [f64; 2]) -> Result<Images> {
    let Embedding { base, meshes: embedded, .. } = embedding;
    let one_way = |from: usize, onto: usize| -> Result<IdVec<VertexId, Sample>> {
        let chart = Chart::new(meshes[onto], &embedded[onto], base);
        let map = compose(&embedded[from], base, meshes[from].positions.len(), &chart)?;
        let normal = |point: SurfacePoint| {
            let triangle = point.on_face(meshes[onto]).map(|(f, _)| meshes[onto].triangle(f));
            triangle.map_or(DVec3::ZERO, |[a, b, c]| (b - a).cross(c - a).normalize_or_zero())
        };
        let sample = |p: SurfacePoint| Sample { point: p.position(meshes[onto]) * scale[onto], normal: normal(p) };
        Ok(map.images.iter().map(|p| p.map_or(Sample::default(), sample)).collect())
    };
    let (there, back) = rayon::join(|| one_way(0, 1), || one_way(1, 0));
    Ok([there?, back?])
}

/// Mean of both compatible meshes' energies; triangles without area, here or there, have no say.
fn sampled_energy(meshes: [&TriMesh; 2], images: &Images, scale: [f64; 2]) -> f64 {
    let one_way = |k: usize| {
        let mesh = meshes[k];
        mesh.conn.faces().map(|f| face_energy(mesh, f, &images[k], scale[k])[0]).sum::<f64>()
    };
    0.5 * (one_way(0) + one_way(1))
}

/// Energy of a face and its area; none where it has no area, here or there.
fn face_energy(mesh: &TriMesh, f: FaceId, images: &IdVec<VertexId, Sample>, scale: f64) -> [f64; 2] {
    let points = mesh.triangle(f).map(|p| p * scale);
    let image = mesh.conn.face(f).map(|v| images[v].point);
    let (area, flat) = (metric::area(points), metric::flatten(image));
    let energy = Rest::new(metric::flatten(points)).energy(&Metrics::identity(area), flat);
    if energy.is_finite() { [energy, area] } else { [0.0; 2] }
}

/// Polishes a domain; also returns by which share of its area the energy fell.
fn visit(
    meshes: [&TriMesh; 2],
    embedding: &Embedding,
    images: &Images,
    tiling: &Tiling,
    scale: [f64; 2],
    dread: f64,
) -> Option<(Visited, f64)> {
    let [mut source, mut target] = thin_domains(meshes, embedding, domains(embedding, tiling, scale));
    let on_source = samples(meshes[0], &source, &images[0], scale[0], dread);
    let on_target = samples(meshes[1], &target, &images[1], scale[1], dread);
    let area = 0.5 * (source.area() + target.area());
    let (mut turned_back, mut gained) = (0, 0.0);
    let mut last = [Vec::new(), Vec::new()];
    for _ in 0..SWEEPS {
        let there = polish(&mut source, &target, [&on_source, &on_target]);
        let back = polish(&mut target, &source, [&on_target, &on_source]);
        turned_back += there.turned_back + back.turned_back;
        gained += there.gained + back.gained;
        let [target_images, source_images] = back.images;
        last = [source_images, target_images];
    }
    let straight = [straighten(&mut source, tiling, LEAST_SNAP)?, straighten(&mut target, tiling, LEAST_SNAP)?];
    let [of_source, of_target] = last;
    let moved = |domain: &Domain, images: Vec<Option<Sample>>, mesh: &TriMesh| -> Vec<(VertexId, Sample)> {
        let known = domain.vertices.iter().zip(images).filter(|(v, _)| (v.0 as usize) < mesh.positions.len());
        known.filter_map(|(&v, sample)| Some((v, sample?))).collect()
    };
    let images = [moved(&source, of_source, meshes[0]), moved(&target, of_target, meshes[1])];
    let [first, second] = straight;
    let relaxed = [Relaxed { domain: source, straight: first }, Relaxed { domain: target, straight: second }];
    Some((Visited { turned_back, images, relaxed }, gained / area))
}

/// The faces of the original mesh with a corner in a domain.
fn samples(mesh: &TriMesh, domain: &Domain, images: &IdVec<VertexId, Sample>, scale: f64, dread: f64) -> Samples {
    let is_original = |v: VertexId| (v.0 as usize) < mesh.positions.len();
    let inside = (0u32..).zip(&domain.vertices).filter(|(_, v)| is_original(**v));
    let mut number: HashMap<VertexId, u32> = inside.map(|(i, &v)| (v, i)).collect();
    let mut outside = Vec::new();
    let mut seen = HashSet::new();
    let mut faces = Vec::new();
    let mut sums = [0.0; 2];
    for &v in domain.vertices.iter().filter(|v| is_original(**v)) {
        for f in mesh.conn.outgoing(v).map(face_of).filter(|f| seen.insert(*f)) {
            let [energy, area] = face_energy(mesh, f, images, scale);
            sums = [sums[0] + energy, sums[1] + area];
            faces.push(mesh.conn.face(f).map(|w| {
                *number.entry(w).or_insert_with(|| {
                    outside.push((mesh.positions[w] * scale, images[w]));
                    (domain.vertices.len() + outside.len() - 1) as u32
                })
            }));
        }
    }
    let has_extra = |t: &&[u32; 3]| t.iter().any(|&v| !is_original(domain.vertices[v as usize]));
    let parts: Vec<[u32; 3]> = domain.triangles.iter().filter(has_extra).copied().collect();
    let dislike = if sums[0] > CRUSHED * sums[1] { 0.0 } else { DISLIKE };
    Samples::new(domain, faces, &parts, &outside, domain.free.clone(), Price { dread, dislike })
}
