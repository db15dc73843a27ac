//! Which boundary loop of one mesh corresponds to which of the other, by the base vertices on them.

use super::edge_loop::EdgeLoop;
use crate::mesh::LandmarkId;

/// Why two sets of boundary loops cannot correspond.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Mismatch {
    /// Different numbers of loops.
    Count([usize; 2]),
    /// A base vertex on a loop of one mesh (0: the source) that lies inside the other.
    Inside {
        /// The base vertex.
        landmark: LandmarkId,
        /// The mesh on whose boundary it lies.
        outer: usize,
    },
    /// Two base vertices on one loop of one mesh (0: the source) and on two of the other.
    Split {
        /// The base vertices.
        landmarks: [LandmarkId; 2],
        /// The mesh where they share a loop.
        together: usize,
    },
    /// The base vertices of a loop stand in another cyclic order on the target.
    Order {
        /// The base vertices in the order of the source.
        landmarks: Vec<LandmarkId>,
        /// True if the order of the target is the source's backwards.
        reversed: bool,
    },
}

/// Pairs the loops that carry base vertices; for every loop of the source the loop of the target, None for a loop
/// without a base vertex.
pub fn pair_by_base_vertices(loops: [&[EdgeLoop]; 2]) -> Result<Vec<Option<usize>>, Mismatch> {
    let [source, target] = loops;
    if source.len() != target.len() {
        return Err(Mismatch::Count([source.len(), target.len()]));
    }
    for outer in 0..2 {
        let inner = loops[1 - outer];
        let lost = loops[outer].iter().flat_map(EdgeLoop::base_vertices).find(|&l| loop_of(inner, l).is_none());
        if let Some(landmark) = lost {
            return Err(Mismatch::Inside { landmark, outer });
        }
        for one in loops[outer] {
            let mut on = one.base_vertices();
            let Some(first) = on.next() else { continue };
            if let Some(other) = on.find(|&l| loop_of(inner, l) != loop_of(inner, first)) {
                return Err(Mismatch::Split { landmarks: [first, other], together: outer });
            }
        }
    }
    let partner = |one: &EdgeLoop| one.base_vertices().next().and_then(|l| loop_of(target, l));
    let pairs: Vec<Option<usize>> = source.iter().map(partner).collect();
    for (one, &partner) in source.iter().zip(&pairs) {
        if let Some(j) = partner {
            same_order(one, &target[j])?;
        }
    }
    Ok(pairs)
}

fn loop_of(loops: &[EdgeLoop], landmark: LandmarkId) -> Option<usize> {
    loops.iter().position(|one| one.base_vertices().any(|l| l == landmark))
}

/// Both loops start at their lowest base vertex, so equal cyclic orders are equal sequences.
pub fn same_order(source: &EdgeLoop, target: &EdgeLoop) -> Result<(), Mismatch> {
    let [there, mut back]: [Vec<LandmarkId>; 2] = [source, target].map(|one| one.base_vertices().collect());
    if there == back {
        return Ok(());
    }
    back[1..].reverse();
    Err(Mismatch::Order { reversed: there == back, landmarks: there })
}
