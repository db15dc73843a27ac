//! A patch cut out of its mesh as a disc with numbered vertices, three sides and positions in the reference triangle.
//!
//! The reference triangle has its corners at (0,0), (1,0), (0,1). A boundary vertex sits at the share of its arc's
//! length, rounded to a multiple of 2^-52, so that s and 1 - s are both exact: boundary vertices lie exactly on the
//! sides, and the two patches at an arc agree bit for bit.

use crate::error::{Error, Result};
use crate::mesh::{ArcId, FaceId, HalfedgeId, IdVec, PatchId, VertexId, corner, face_of, next, prev};
use crate::path::base_complex::{BaseComplex, DirectedArc};
use crate::path::cut_mesh::CutMesh;
use glam::DVec2;

/// Shares along an arc are multiples of this, so that 1 - s is exact.
const GRID: f64 = 1.0 / (1u64 << 52) as f64;
/// Neighbouring shares along an arc differ by at least this share of their mean gap, or they are spread more evenly.
const LEAST_GAP: f64 = 1e-6;

/// One patch of one mesh.
#[derive(Clone, Debug)]
pub struct PatchDisc {
    /// The cut mesh's vertex of every vertex here; a vertex on an arc with this patch on both sides appears twice.
    pub vertices: Vec<VertexId>,
    /// The cut mesh's face of every triangle here.
    pub faces: Vec<FaceId>,
    /// Triangles, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// Number of boundary vertices; they come first, counter-clockwise from corner 0.
    pub boundary: usize,
    /// The first vertex of each side: the corners.
    pub corners: [u32; 3],
    /// Positions in the reference triangle.
    pub positions: Vec<DVec2>,
}

/// For every arc, the share of its length at each of its vertices, from 0 to 1.
pub type ArcShares = IdVec<ArcId, Vec<f64>>;

/// The share of its arc's length at every vertex of every arc, strictly increasing multiples of 2^-52.
pub fn arc_shares(cut: &CutMesh, base: &BaseComplex) -> Result<ArcShares> {
    base.arcs.iter_ids().map(|(arc, ends)| shares_of(cut, &cut.arc_path(arc, ends[0]), arc)).collect()
}

/// The nearest share that is a multiple of 2^-52.
pub fn on_grid(share: f64) -> f64 {
    (share / GRID).round() * GRID
}

fn shares_of(cut: &CutMesh, path: &[HalfedgeId], arc: ArcId) -> Result<Vec<f64>> {
    let lengths: Vec<f64> = path.iter().map(|&h| cut.length(h)).collect();
    let shares = shares_of_lengths(&lengths);
    if shares.windows(2).all(|w| w[0] < w[1]) {
        Ok(shares)
    } else {
        Err(Error::bug("the vertices of an arc cannot be told apart").at(arc))
    }
}

/// The shares of an arc that rises by the given lengths, small ones padded.
fn shares_of_lengths(lengths: &[f64]) -> Vec<f64> {
    let (total, mean) = (lengths.iter().sum::<f64>(), 1.0 / lengths.len() as f64);
    let mut shares = vec![0.0];
    let mut walked = 0.0;
    let floor = |length: f64| (length / total).max(LEAST_GAP * mean);
    let padded: f64 = lengths.iter().map(|&l| floor(l)).sum();
    for &length in lengths {
        walked += floor(length);
        shares.push(on_grid(walked / padded));
    }
    if let Some(last) = shares.last_mut() {
        *last = 1.0;
    }
    shares
}

/// Shares that rise from 0 to 1, perhaps not strictly, moved apart so that they do.
pub fn spread_shares(shares: &[f64]) -> Vec<f64> {
    let gaps: Vec<f64> = shares.windows(2).map(|w| (w[1] - w[0]).max(0.0)).collect();
    shares_of_lengths(&gaps)
}

/// Cuts every patch out of a cut mesh without dividing edges and fixes its boundary.
pub fn patch_discs(cut: &CutMesh, base: &BaseComplex, shares: &ArcShares) -> Result<IdVec<PatchId, PatchDisc>> {
    let mut scratch = Scratch::default();
    base.patches.ids().map(|p| patch_disc(cut, base, p, shares, &mut scratch)).collect()
}

/// Working memory for [`patch_disc`]: numbers corners (by the half-edge that leaves them) within the patch at hand.
#[derive(Default)]
pub struct Scratch {
    local: IdVec<HalfedgeId, u32>,
}

/// Cuts one patch out; free vertices have no positions yet.
pub fn patch_disc(
    cut: &CutMesh,
    base: &BaseComplex,
    p: PatchId,
    shares: &ArcShares,
    scratch: &mut Scratch,
) -> Result<PatchDisc> {
    scratch.local.raw.resize(3 * cut.conn.face_count(), u32::MAX);
    let disc = cut_out(cut, base, p, shares, &mut scratch.local)?;
    for h in disc.faces.iter().flat_map(|&f| (0..3).map(move |i| corner(f, i))) {
        scratch.local[h] = u32::MAX;
    }
    Ok(disc)
}

/// The half-edges of a directed arc in walking order, the patch at their left.
fn directed_path(cut: &CutMesh, path: &[HalfedgeId], side: DirectedArc) -> Result<Vec<HalfedgeId>> {
    if !side.reversed {
        return Ok(path.to_vec());
    }
    let twins: Option<Vec<HalfedgeId>> = path.iter().rev().map(|&h| cut.conn.twin(h)).collect();
    twins.ok_or_else(|| Error::bug("an arc along the boundary has the surface at its right").at(side.arc))
}

fn cut_out(
    cut: &CutMesh,
    base: &BaseComplex,
    p: PatchId,
    shares: &ArcShares,
    local: &mut IdVec<HalfedgeId, u32>,
) -> Result<PatchDisc> {
    let mut disc = PatchDisc {
        vertices: Vec::new(),
        faces: Vec::new(),
        triangles: Vec::new(),
        boundary: 0,
        corners: [0; 3],
        positions: Vec::new(),
    };
    let mut seed = None;
    for (k, &side) in base.patches[p].iter().enumerate() {
        disc.corners[k] = disc.vertices.len() as u32;
        let share = &shares[side.arc];
        let path = cut.arc_path(side.arc, base.arcs[side.arc][0]);
        for (i, h) in directed_path(cut, &path, side)?.into_iter().enumerate() {
            seed = seed.or(Some(face_of(h)));
            let s = if side.reversed { 1.0 - share[share.len() - 1 - i] } else { share[i] };
            number_fan(cut, h, disc.vertices.len() as u32, local);
            disc.vertices.push(cut.conn.from(h));
            disc.positions.push(on_side(k, s));
        }
    }
    disc.boundary = disc.vertices.len();
    let seed = seed.ok_or_else(|| Error::bug("a patch without a boundary").at(p))?;
    disc.collect_faces(cut, seed, local);
    Ok(disc)
}

/// The point at share `s` of side `k` of the reference triangle.
pub fn on_side(k: usize, s: f64) -> DVec2 {
    match k {
        0 => DVec2::new(s, 0.0),
        1 => DVec2::new(1.0 - s, s),
        _ => DVec2::new(0.0, 1.0 - s),
    }
}

/// Gives number `i` to all corners of the fan that starts at boundary half-edge `h` and ends at the next arc.
fn number_fan(cut: &CutMesh, h: HalfedgeId, i: u32, local: &mut IdVec<HalfedgeId, u32>) {
    let mut at = h;
    loop {
        local[at] = i;
        if cut.arc_at(prev(at)).is_some() {
            return;
        }
        match cut.conn.twin(prev(at)) {
            Some(t) => at = t,
            None => return,
        }
    }
}

impl PatchDisc {
    /// Floods the patch from `seed` and numbers its free vertices in order of discovery.
    fn collect_faces(&mut self, cut: &CutMesh, seed: FaceId, local: &mut IdVec<HalfedgeId, u32>) {
        let mut queue = vec![seed];
        let mut seen = std::collections::HashSet::from([seed]);
        let mut at = 0;
        while let Some(&f) = queue.get(at) {
            at += 1;
            for h in (0..3).map(|i| corner(f, i)) {
                if local[h] == u32::MAX {
                    let number = self.vertices.len() as u32;
                    cut.conn.outgoing(cut.conn.from(h)).for_each(|k| local[k] = number);
                    self.vertices.push(cut.conn.from(h));
                    self.positions.push(DVec2::ZERO);
                }
                let across = cut.conn.twin(h).filter(|_| cut.arc_at(h).is_none()).map(face_of);
                if let Some(g) = across.filter(|&g| seen.insert(g)) {
                    queue.push(g);
                }
            }
            let h = corner(f, 0);
            self.triangles.push([h, next(h), prev(h)].map(|k| local[k]));
        }
        self.faces = queue;
    }

    /// For every free vertex the ring of vertices around it, counter-clockwise; empty for boundary vertices.
    pub fn rings(&self) -> Vec<Vec<u32>> {
        let mut spokes: Vec<Vec<(u32, u32)>> = vec![Vec::new(); self.vertices.len()];
        for &[a, b, c] in &self.triangles {
            for (v, from, to) in [(a, b, c), (b, c, a), (c, a, b)] {
                if v as usize >= self.boundary {
                    spokes[v as usize].push((from, to));
                }
            }
        }
        spokes.into_iter().map(|s| chain(&s)).collect()
    }
}

/// Orders the opposite edges around a vertex into a ring.
fn chain(spokes: &[(u32, u32)]) -> Vec<u32> {
    let Some(&(start, _)) = spokes.first() else { return Vec::new() };
    let mut ring = vec![start];
    while ring.len() < spokes.len() {
        let last = ring[ring.len() - 1];
        match spokes.iter().find(|&&(from, _)| from == last) {
            Some(&(_, to)) => ring.push(to),
            None => break,
        }
    }
    ring
}
