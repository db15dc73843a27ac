//! Patches laid side by side in the plane: the plan of a domain, common to both meshes.
//!
//! A tiling joins the two patches at an arc, or all patches around a base vertex. Its seams are the arcs inside, straight
//! segments between nodes. Every patch is laid out affinely, with roughly the proportions of its frame.

use super::stretch::Frame;
use crate::mesh::{ArcId, IdVec, LandmarkId, PatchId};
use crate::path::base_complex::{BaseComplex, DirectedArc, NO_PATCH};
use glam::{DMat2, DVec2};
use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};

/// A patch around a base vertex takes at most this angle there: it would turn over at half a circle.
const WIDEST: f64 = 0.8 * PI;

/// An arc inside a domain.
#[derive(Clone, Copy, Debug)]
pub struct Seam {
    /// The arc.
    pub arc: ArcId,
    /// The nodes at its first and its second end.
    pub ends: [u32; 2],
}

/// A patch in a domain.
#[derive(Clone, Copy, Debug)]
pub struct Tile {
    /// The patch.
    pub patch: PatchId,
    /// Its sides.
    pub sides: [DirectedArc; 3],
    /// The nodes at its corners.
    pub corners: [u32; 3],
    /// For every side the seam it lies on, none at the domain's border.
    pub seams: [Option<usize>; 3],
}

/// The plan of a domain.
#[derive(Clone, Debug, Default)]
pub struct Tiling {
    /// Corners of patches in the plane.
    pub nodes: Vec<DVec2>,
    /// The arcs inside.
    pub seams: Vec<Seam>,
    /// The patches.
    pub tiles: Vec<Tile>,
}

/// From the reference triangle of a patch to the plane and back.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    origin: DVec2,
    axes: DMat2,
    inverse: DMat2,
}

impl Placement {
    /// From reference coordinates to the plane.
    pub fn place(&self, p: DVec2) -> DVec2 {
        self.origin + self.axes * p
    }

    /// From the plane back to reference coordinates.
    pub fn reference(&self, q: DVec2) -> DVec2 {
        self.inverse * (q - self.origin)
    }
}

impl Tiling {
    /// The two patches at an arc, which runs from (0, 0) to (1, 0); none if both are the same patch or one is missing.
    pub fn of_arc(
        base: &BaseComplex,
        side_of: &[(PatchId, usize)],
        frames: &IdVec<PatchId, Frame>,
        arc: ArcId,
    ) -> Option<Self> {
        let [(p, i), (q, j)] = [side_of[2 * arc.0 as usize], side_of[2 * arc.0 as usize + 1]];
        if p == q || [p, q].contains(&NO_PATCH) {
            return None;
        }
        let (above, below) = (frames[p].apex_over(i), frames[q].apex_over(j));
        let nodes = vec![DVec2::ZERO, DVec2::X, above, DVec2::X - below];
        let tile = |patch: PatchId, side: usize, nodes: [u32; 3]| {
            let mut tile = Tile { patch, sides: base.patches[patch], corners: [0; 3], seams: [None; 3] };
            tile.seams[side] = Some(0);
            (0..3).for_each(|k| tile.corners[(side + k) % 3] = nodes[k]);
            tile
        };
        let tiles = vec![tile(p, i, [0, 1, 2]), tile(q, j, [1, 0, 3])];
        Some(Tiling { nodes, seams: vec![Seam { arc, ends: [0, 1] }], tiles })
    }

    /// The patches around a base vertex, which lies at the origin; none unless they are at least three and differ.
    pub fn of_star(
        base: &BaseComplex,
        side_of: &[(PatchId, usize)],
        frames: &IdVec<PatchId, Frame>,
        center: LandmarkId,
    ) -> Option<Self> {
        let wedges = wedges(base, side_of, center)?;
        let count = wedges.len() as u32;
        let angles: Vec<f64> = wedges.iter().map(|&(p, k)| frames[p].angle(k)).collect();
        let scale = TAU / angles.iter().sum::<f64>();
        let even = angles.iter().any(|a| a * scale > WIDEST);
        let mut tiling = Tiling { nodes: vec![DVec2::ZERO], ..Tiling::default() };
        let mut turn = 0.0;
        for (n, (&(patch, k), angle)) in (0..count).zip(wedges.iter().zip(&angles)) {
            let sides = base.patches[patch];
            tiling.nodes.push(DVec2::from_angle(turn) * frames[patch].length(k));
            turn += if even { TAU / f64::from(count) } else { angle * scale };
            let (out, next) = (n + 1, (n + 1) % count + 1);
            let ends = if sides[k].reversed { [out, 0] } else { [0, out] };
            tiling.seams.push(Seam { arc: sides[k].arc, ends });
            let mut tile = Tile { patch, sides, corners: [0; 3], seams: [None; 3] };
            (tile.corners[(k + 1) % 3], tile.corners[(k + 2) % 3]) = (out, next);
            (tile.seams[k], tile.seams[(k + 2) % 3]) = (Some(n as usize), Some(next as usize - 1));
            tiling.tiles.push(tile);
        }
        Some(tiling)
    }

    /// How a tile lies in the plane.
    pub fn placement(&self, tile: &Tile) -> Placement {
        let [origin, first, second] = tile.corners.map(|n| self.nodes[n as usize]);
        let axes = DMat2::from_cols(first - origin, second - origin);
        Placement { origin, axes, inverse: axes.inverse() }
    }
}

/// The patches around a base vertex, counter-clockwise, each with the side that leaves the vertex.
fn wedges(base: &BaseComplex, side_of: &[(PatchId, usize)], center: LandmarkId) -> Option<Vec<(PatchId, usize)>> {
    let leaving = |(arc, ends): (ArcId, &[LandmarkId; 2])| {
        let reversed = ends.iter().position(|&l| l == center)? == 1;
        Some(DirectedArc { arc, reversed })
    };
    let first = base.arcs.iter_ids().find_map(leaving)?;
    let (mut wedges, mut patches, mut arcs) = (Vec::new(), BTreeSet::new(), BTreeSet::new());
    let mut at = first;
    loop {
        let (p, k) = side_of[at.index()];
        if p == NO_PATCH || !patches.insert(p) || !arcs.insert(at.arc) {
            return None;
        }
        wedges.push((p, k));
        at = base.patches[p][(k + 2) % 3].flipped();
        if at == first {
            return (wedges.len() >= 3).then_some(wedges);
        }
    }
}
