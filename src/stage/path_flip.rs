//! Stage: path flips, with which the greedy layout of Kraevoy and Sheffer ends.
//!
//! Input: a complete layout. Output: a layout in which no arc would be shorter, on both meshes together, along the other
//! diagonal of its two patches. Invariant: both meshes carry the same base complex; landmarks keep at least three arcs and no
//! two arcs join the same landmarks because of a flip.

use super::growth::Growth;
use crate::error::Result;
use crate::mesh::{ArcId, LandmarkId, PatchId};
use crate::path::base_complex::{BaseComplex, DirectedArc, NO_PATCH};
use crate::path::network::{Corner, embed, terminal};
use crate::path::region::base_complex;
use crate::path::search::Anywhere;

/// A flip must make the arc shorter by this share, so that flips end.
const WORTH_FLIPPING: f64 = 1e-3;
/// Sweeps over all arcs; each makes the layout shorter, later ones by little.
const SWEEPS: usize = 8;
/// Arcs that a landmark must have to lose one.
const LEAST_DEGREE: usize = 4;

/// The patches and landmarks at an arc once it runs along the other diagonal.
struct Flip {
    ends: [LandmarkId; 2],
    corners: [Corner; 2],
    patches: [(PatchId, [DirectedArc; 3]); 2],
}

/// Flips arcs until none gets shorter.
pub(super) fn flip_paths(growth: &mut Growth) -> Result<()> {
    let mut base = base_complex(&growth.halves[0].cut, &growth.arcs)?;
    for _ in 0..SWEEPS {
        let mut flipped = false;
        for arc in base.arcs.ids() {
            if let Some(flip) = flip_of(&base, arc) {
                flipped |= try_flip(growth, &mut base, arc, flip)?;
            }
        }
        if !flipped {
            break;
        }
    }
    Ok(())
}

/// The flip of an arc; none if it runs along the boundary or its landmarks have no arc to spare, or if landmarks would be
/// joined twice.
fn flip_of(base: &BaseComplex, arc: ArcId) -> Option<Flip> {
    let side_of = base.side_of();
    let [forward, backward] = [false, true].map(|reversed| DirectedArc { arc, reversed });
    let [(p, k), (q, m)] = [forward, backward].map(|d| side_of[d.index()]);
    if p == q || p == NO_PATCH || q == NO_PATCH {
        return None;
    }
    let [s1, s2] = [1, 2].map(|i| base.patches[p][(k + i) % 3]);
    let [t1, t2] = [1, 2].map(|i| base.patches[q][(m + i) % 3]);
    let ends = [base.start(t2), base.start(s2)];
    let degree = |l: LandmarkId| base.arcs.iter().flatten().filter(|&&end| end == l).count();
    let is_joined = ends[0] == ends[1] || base.arcs.iter().any(|&[a, b]| ends == [a, b] || ends == [b, a]);
    if is_joined || base.arcs[arc].iter().any(|&l| degree(l) < LEAST_DEGREE) {
        return None;
    }
    Some(Flip {
        ends,
        corners: [t2, s2].map(|side| Corner { landmark: base.start(side), after: Some(side) }),
        patches: [(p, [forward, s2, t1]), (q, [backward, t2, s1])],
    })
}

/// Flips an arc if that makes it shorter; otherwise it stays where it is. Returns whether it did.
fn try_flip(growth: &mut Growth, base: &mut BaseComplex, arc: ArcId, flip: Flip) -> Result<bool> {
    let (mut old, mut new, mut ways) = (0.0, 0.0, Vec::with_capacity(2));
    let first = base.arcs[arc][0];
    for half in &mut growth.halves {
        old += half.cut.arc_length(arc, first) / half.unit;
        let way = half.cut.unmark(arc, first);
        let [start, goal] = flip.corners.map(|c| terminal(&half.cut, c, &|_| true));
        let path = half.searcher.shortest(&half.cut, &start?, &goal?, &Anywhere);
        new += path.as_ref().map_or(f64::INFINITY, |path| path.length / half.unit);
        ways.push((way, path));
    }
    let is_shorter = new < old * (1.0 - WORTH_FLIPPING);
    for (half, (way, path)) in growth.halves.iter_mut().zip(&ways) {
        match path {
            Some(path) if is_shorter => embed(&mut half.cut, half.mesh, path, arc)?,
            _ => half.cut.mark_along(way, arc)?,
        }
    }
    if is_shorter {
        for (patch, sides) in flip.patches {
            base.patches[patch] = sides;
        }
        base.arcs[arc] = flip.ends;
        growth.arcs[arc] = flip.ends;
        growth.keep_up();
    }
    Ok(is_shorter)
}
