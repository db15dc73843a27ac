//! Colours for patches: neighbours differ, and the same patch looks the same on every mesh.

use crate::map::base_complex::BaseComplex;
use crate::mesh::Id;

/// Muted, so that shading shows, and told apart by lightness as well as by hue; sRGB codes.
pub const PATCH_COLORS: [u32; 12] = [
    0x8fb8de, 0xf2c879, 0x9ed1b0, 0xd7a6c8, 0xf0a58f, 0x6f8fc0, 0xd9d98c, 0x7fc3c9, 0xb79bd0, 0xe3cfae, 0x85aa6f,
    0xc98a7d,
];

/// A colour for every patch, in order: of those that no patch at one of its landmarks has, the least used.
pub fn patch_colors(base: &BaseComplex) -> Vec<u32> {
    let mut at_landmark = vec![Vec::new(); base.landmarks];
    let mut used = [0usize; PATCH_COLORS.len()];
    let mut colors = Vec::with_capacity(base.patches.len());
    for p in base.patches.ids() {
        let corners = base.corners(p);
        let near = |c: usize| {
            corners.iter().map(|l| at_landmark[l.index()].iter().filter(|&&d| d == c).count()).sum::<usize>()
        };
        let best = (0..PATCH_COLORS.len()).min_by_key(|&c| (near(c), used[c], c)).unwrap_or(0);
        used[best] += 1;
        corners.iter().for_each(|l| at_landmark[l.index()].push(best));
        colors.push(PATCH_COLORS[best]);
    }
    colors
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::base_complex::DirectedArc;
    use crate::mesh::{ArcId, IdVec, LandmarkId};

    /// The four faces of a tetrahedron.
    #[test]
    fn neighbours_have_different_colours() {
        let arcs = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]].map(|e: [u32; 2]| e.map(LandmarkId));
        let side = |(arc, reversed)| DirectedArc { arc: ArcId(arc), reversed };
        let patches = [
            [(0, false), (1, false), (2, false)],
            [(0, true), (3, false), (4, true)],
            [(1, true), (4, false), (5, true)],
            [(2, true), (5, false), (3, true)],
        ];
        let patches: IdVec<_, _> = patches.iter().map(|sides| sides.map(side)).collect();
        let base = BaseComplex { landmarks: 4, arcs: IdVec::from_raw(arcs.to_vec()), patches };
        let mut colors = patch_colors(&base);
        colors.sort_unstable();
        colors.dedup();
        assert_eq!(colors.len(), 4);
    }
}
