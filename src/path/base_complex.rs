//! The base complex: abstract triangles over the landmarks, common to both meshes.

use crate::mesh::{ArcId, IdVec, LandmarkId, PatchId};

/// Stands for the missing patch at the right of an arc along the boundary.
pub const NO_PATCH: PatchId = PatchId(u32::MAX);

/// An arc with a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct DirectedArc {
    /// The arc.
    pub arc: ArcId,
    /// True if it is walked from its second end to its first.
    pub reversed: bool,
}

impl DirectedArc {
    /// The same arc the other way.
    pub fn flipped(self) -> Self {
        DirectedArc { reversed: !self.reversed, ..self }
    }

    /// A dense number: `2 arc + reversed`.
    pub fn index(self) -> usize {
        2 * self.arc.0 as usize + usize::from(self.reversed)
    }
}

/// Triangles over the landmarks. Several arcs may join the same two landmarks, and an arc may be a loop.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct BaseComplex {
    /// Number of landmarks.
    pub landmarks: usize,
    /// The two ends of every arc.
    pub arcs: IdVec<ArcId, [LandmarkId; 2]>,
    /// The three sides of every patch, counter-clockwise; side `k` runs from corner `k` to corner `k + 1`.
    pub patches: IdVec<PatchId, [DirectedArc; 3]>,
}

impl BaseComplex {
    /// The landmark where a directed arc starts.
    pub fn start(&self, side: DirectedArc) -> LandmarkId {
        self.arcs[side.arc][usize::from(side.reversed)]
    }

    /// The corners of a patch.
    pub fn corners(&self, p: PatchId) -> [LandmarkId; 3] {
        self.patches[p].map(|side| self.start(side))
    }

    /// For every directed arc (by [`DirectedArc::index`]) the patch at its left and which side of it the arc is;
    /// [`NO_PATCH`] at the right of arcs along the boundary.
    pub fn side_of(&self) -> Vec<(PatchId, usize)> {
        let mut side_of = vec![(NO_PATCH, 0); 2 * self.arcs.len()];
        for (p, sides) in self.patches.iter_ids() {
            for (k, side) in sides.iter().enumerate() {
                side_of[side.index()] = (p, k);
            }
        }
        side_of
    }
}
