//! Stage: arcs flipped on both meshes at once.
//!
//! Input: a relaxed embedding. Output: the same map over a base complex in which some arcs run along the other diagonal
//! of their two patches: it is straight in the quad that both meshes share, so it is read off on both like a relaxed arc.
//! A flip does not change the map, only which patches are relaxed together from now on. So it is judged by the energy
//! that it leads to: the stars of the four base vertices at the quad are relaxed with the flip and without. Invariant:
//! every patch stays embedded, and no flip is kept that leads to more energy than there would be without.

use super::levels::CRUSHED;
use super::relax::{SNAPS, domains, patch_energies, relax_stars, thin_domains, unit_scale};
use crate::error::Result;
use crate::gpu::Compute;
use crate::map::embedding::Embedding;
use crate::map::recut::{Relaxed, recut_all};
use crate::mesh::{ArcId, IdVec, LandmarkId, PatchId, TriMesh};
use crate::path::base_complex::{BaseComplex, DirectedArc};
use crate::plane::smooth;
use crate::plane::straighten::straighten;
use crate::plane::stretch::Frame;
use crate::plane::tiling::{Seam, Tile, Tiling};
use glam::DVec2;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// A flip is looked into if it makes the arc shorter than this share of its length, on both meshes together: where layouts
/// are good, longer ones hardly ever lead to less energy.
const SHORTER: f64 = 0.95;
/// Where a quad is crushed it is looked into up to this length.
const LONGEST_WHERE_CRUSHED: f64 = 1.5;
/// Rounds of flips; in one round no two flips concern the same base vertex.
const ROUNDS: usize = 4;
/// Arcs that a base vertex keeps at least, so that it still is the middle of a domain.
const LEAST_DEGREE: usize = 4;
/// The energy of a quad may rise by this share as its new diagonal is made to run along edges.
const SPOILT: f64 = 0.05;

/// Both new triangles of a quad, whose old diagonal has length one, have at least half this area.
const LEAST_AREA: f64 = 0.05;

/// The two patches at an arc and the arcs around them.
///
/// ```text
///        2
///       / \
///   s2 / p \ s1     the arc runs from 0 to 1, and from 3 to 2 once it is flipped; all sides run counter-clockwise
///     0 --- 1
///   t1 \ q / t2
///       \ /
///        3
/// ```
struct Quad {
    /// p and q.
    patches: [PatchId; 2],
    /// s1, s2, t1, t2.
    sides: [DirectedArc; 4],
    corners: [LandmarkId; 4],
}

/// An arc along the other diagonal.
struct Flip {
    arc: ArcId,
    quad: Quad,
    /// The quad with the new arc as its seam.
    tiling: Tiling,
    relaxed: [Relaxed; 2],
    /// The new length, mean of both meshes in units of their roots of area.
    length: f64,
    /// Its share of the old one.
    share: f64,
    /// Whether the quad is crushed as it is.
    is_crushed: bool,
}

/// Flips arcs where that leads to less energy; returns how many. Fails on a device error.
pub fn flip_arcs(compute: &Compute, meshes: [&TriMesh; 2], embedding: &mut Embedding) -> Result<usize> {
    let scale = unit_scale(meshes);
    let (mut count, mut refused) = (0, BTreeSet::new());
    for _ in 0..ROUNDS {
        let flips = independent(wanted(meshes, embedding, scale, &refused));
        if flips.is_empty() {
            break;
        }
        let corners: Vec<LandmarkId> = flips.iter().flat_map(|flip| flip.quad.corners).collect();
        let mut tried = flipped(meshes, embedding, &flips, scale)?;
        let mut kept = embedding.clone();
        for embedding in [&mut kept, &mut tried] {
            relax_stars(compute, meshes, embedding, &corners)?;
        }
        let energies = [&kept, &tried].map(|embedding| around(meshes, embedding, &flips));
        let worse = (0..flips.len()).filter(|&i| energies[1][i] >= energies[0][i]);
        let before = refused.len();
        refused.extend(worse.map(|i| flips[i].arc));
        if refused.len() == before {
            count += flips.len();
            *embedding = tried;
        } else if refused.len() == before + flips.len() {
            *embedding = kept;
        }
    }
    Ok(count)
}

/// For every flip the energy of the patches that meet at its quad's corners.
fn around(meshes: [&TriMesh; 2], embedding: &Embedding, flips: &[Flip]) -> Vec<f64> {
    let energies = patch_energies(meshes, embedding);
    let one = |flip: &Flip| {
        let is_near = |p: &PatchId| embedding.base.corners(*p).iter().any(|l| flip.quad.corners.contains(l));
        embedding.base.patches.ids().filter(is_near).map(|p| energies[p]).sum()
    };
    flips.iter().map(one).collect()
}

/// Flips that may be worth it, those that shorten their arcs the most first.
fn wanted(meshes: [&TriMesh; 2], embedding: &Embedding, scale: [f64; 2], refused: &BTreeSet<ArcId>) -> Vec<Flip> {
    let base = &embedding.base;
    let (side_of, lengths) = (base.side_of(), lengths(embedding, scale));
    let mut degree: IdVec<LandmarkId, usize> = IdVec::filled(0, base.landmarks);
    base.arcs.iter().flatten().for_each(|&l| degree[l] += 1);
    let may_lose = |arc: ArcId| base.arcs[arc].iter().all(|&l| degree[l] > LEAST_DEGREE);
    let open: Vec<ArcId> = base.arcs.ids().filter(|&arc| !refused.contains(&arc) && may_lose(arc)).collect();
    let one = |&arc: &ArcId| {
        let flip = Flip::of(meshes, embedding, arc, &side_of, &lengths, LONGEST_WHERE_CRUSHED)?;
        (flip.share < if flip.is_crushed { LONGEST_WHERE_CRUSHED } else { SHORTER }).then_some(flip)
    };
    let mut flips: Vec<Flip> = open.par_iter().filter_map(one).collect();
    flips.sort_by(|a, b| a.share.total_cmp(&b.share).then(a.arc.cmp(&b.arc)));
    flips
}

/// The same map with an arc along the other diagonal of its two patches; none if that is not straight inside them.
/// Fails only by a bug.
pub fn flip_arc(meshes: [&TriMesh; 2], embedding: &Embedding, arc: ArcId) -> Result<Option<Embedding>> {
    let scale = unit_scale(meshes);
    let (side_of, lengths) = (embedding.base.side_of(), lengths(embedding, scale));
    let flip = Flip::of(meshes, embedding, arc, &side_of, &lengths, f64::INFINITY);
    flip.map(|flip| flipped(meshes, embedding, &[flip], scale)).transpose()
}

/// Mean length of every arc on both meshes, in units of their roots of area.
fn lengths(embedding: &Embedding, scale: [f64; 2]) -> IdVec<ArcId, f64> {
    let of = |k: usize| embedding.meshes[k].cut.arc_lengths(&embedding.base.arcs);
    let [mut lengths, other] = [of(0), of(1)];
    lengths.raw.iter_mut().zip(&other.raw).for_each(|(a, b)| *a = 0.5 * (*a * scale[0] + b * scale[1]));
    lengths
}

/// Length of a domain's only seam.
fn seam_length(relaxed: &Relaxed) -> f64 {
    let point = |&(v, _): &(u32, f64)| relaxed.domain.points[v as usize];
    let seam = &relaxed.straight.seams[0];
    seam.windows(2).map(|w| point(&w[0]).distance(point(&w[1]))).sum()
}

/// The first of the flips, and those after it that share no corner with an earlier one.
fn independent(flips: Vec<Flip>) -> Vec<Flip> {
    let mut taken: Vec<LandmarkId> = Vec::new();
    let free = |flip: &Flip| {
        let is_free = flip.quad.corners.iter().all(|l| !taken.contains(l));
        if is_free {
            taken.extend(flip.quad.corners);
        }
        is_free
    };
    flips.into_iter().filter(free).collect()
}

/// The embedding with these arcs flipped.
fn flipped(meshes: [&TriMesh; 2], embedding: &Embedding, flips: &[Flip], scale: [f64; 2]) -> Result<Embedding> {
    let mut flipped = embedding.clone();
    let mut lengths = lengths(embedding, scale);
    for flip in flips {
        let [.., second, third] = flip.quad.corners;
        flipped.base.arcs[flip.arc] = [third, second];
        lengths[flip.arc] = flip.length;
        for tile in &flip.tiling.tiles {
            flipped.base.patches[tile.patch] = tile.sides;
        }
    }
    for patch in flips.iter().flat_map(|flip| flip.quad.patches) {
        flipped.frames[patch] = Frame::with_sides(flipped.base.patches[patch].map(|side| lengths[side.arc]));
    }
    let relaxed: Vec<(&Tiling, &[Relaxed; 2])> = flips.iter().map(|flip| (&flip.tiling, &flip.relaxed)).collect();
    recut_all(meshes, &mut flipped, &relaxed)?;
    Ok(flipped)
}

impl Flip {
    /// An arc along the other diagonal; none if that is not straight inside its two patches, or longer than the arc by
    /// the factor `longest`.
    fn of(
        meshes: [&TriMesh; 2],
        embedding: &Embedding,
        arc: ArcId,
        side_of: &[(PatchId, usize)],
        lengths: &IdVec<ArcId, f64>,
        longest: f64,
    ) -> Option<Flip> {
        let scale = unit_scale(meshes);
        let base = &embedding.base;
        let old = Tiling::of_arc(base, side_of, &embedding.frames, arc)?;
        let quad = Quad::new(base, &old)?;
        let tiling = quad.flipped_tiling(old.nodes.clone(), arc)?;
        let whole = domains(embedding, &old, scale);
        let thin = thin_domains(meshes, embedding, whole.clone());
        let along = |snap: f64| -> Option<[Relaxed; 2]> {
            let [mut source, mut target] = thin.clone();
            let [first, second] = [straighten(&mut source, &tiling, snap)?, straighten(&mut target, &tiling, snap)?];
            Some([Relaxed { domain: source, straight: first }, Relaxed { domain: target, straight: second }])
        };
        let length = |relaxed: &[Relaxed; 2]| 0.5 * relaxed.iter().map(seam_length).sum::<f64>();
        let ways = SNAPS.iter().filter_map(|&snap| along(snap));
        let mut ways = ways.filter(|relaxed| length(relaxed) < longest * lengths[arc]).peekable();
        ways.peek()?;
        let energy = smooth::energy(&whole[0], &whole[1]);
        let is_crushed = energy > CRUSHED * 0.5 * (whole[0].area() + whole[1].area());
        let keeps =
            |[source, target]: &[Relaxed; 2]| smooth::energy(&source.domain, &target.domain) <= energy * (1.0 + SPOILT);
        let relaxed = ways.find(keeps)?;
        let length = length(&relaxed);
        Some(Flip { arc, quad, tiling, relaxed, length, share: length / lengths[arc], is_crushed })
    }
}

impl Quad {
    /// The quad of a domain of two patches; none if a corner is met twice.
    fn new(base: &BaseComplex, tiling: &Tiling) -> Option<Quad> {
        let side = |tile: &Tile, from: u32| {
            let k = tile.corners.iter().position(|&n| n == from)?;
            Some(tile.sides[k])
        };
        let [p, q] = tiling.tiles.as_slice() else { return None };
        let sides = [side(p, 1)?, side(p, 2)?, side(q, 0)?, side(q, 3)?];
        let [s1, s2, t1, t2] = sides.map(|side| base.start(side));
        let corners = [t1, s1, s2, t2];
        let differ = (0..4).all(|i| (0..i).all(|j| corners[i] != corners[j]));
        differ.then_some(Quad { patches: [p.patch, q.patch], sides, corners })
    }

    /// The same quad with the seam from node 3 to node 2; none if that does not run inside.
    fn flipped_tiling(&self, nodes: Vec<DVec2>, arc: ArcId) -> Option<Tiling> {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k: usize| nodes[k]);
        let turns_left = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p) > LEAST_AREA;
        if !turns_left(d, c, a) || !turns_left(c, d, b) {
            return None;
        }
        let [s1, s2, t1, t2] = self.sides;
        let new = DirectedArc { arc, reversed: false };
        let tile = |patch: PatchId, mut sides: [DirectedArc; 3], mut corners: [u32; 3]| {
            let mut seams = [Some(0), None, None];
            // A patch starts with the lowest of its sides.
            let first = (0..3).min_by_key(|&k| sides[k]).unwrap_or(0);
            sides.rotate_left(first);
            corners.rotate_left(first);
            seams.rotate_left(first);
            Tile { patch, sides, corners, seams }
        };
        let [p, q] = self.patches;
        let tiles = vec![tile(p, [new, s2, t1], [3, 2, 0]), tile(q, [new.flipped(), t2, s1], [2, 3, 1])];
        Some(Tiling { nodes, seams: vec![Seam { arc, ends: [3, 2] }], tiles })
    }
}
