//! The atlas as JSON: what a geometry image needs beside it to be read back as a mesh.

use super::atlas::{Atlas, Half, MAX_IMAGE_SIDE, Tile, check_tile_size};
use super::base_complex::{BaseComplex, DirectedArc};
use crate::error::{Error, Result};
use crate::mesh::{ArcId, Id, IdVec, LandmarkId, PatchId};
use serde::{Deserialize, Serialize};

/// The tiles of an atlas with the patches' corners and sides; stands in layout.json and in every geometry image.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TileTable {
    /// Samples along a tile's side, a power of two plus one.
    pub tile_size: usize,
    /// Tiles in a row of the image.
    pub columns: usize,
    /// Rows of tiles.
    pub rows: usize,
    /// Tiles row by row from the top left.
    pub tiles: Vec<TileEntry>,
}

/// One tile.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TileEntry {
    /// The patch in the lower left half.
    pub first: HalfEntry,
    /// The patch in the upper right half, or null.
    pub second: Option<HalfEntry>,
}

/// A patch in one half of a tile.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HalfEntry {
    /// Number of the patch.
    pub patch: u32,
    /// The side, 0 to 2, on the tile's diagonal: its start is the tile's lower right corner in a lower left half and
    /// the upper left corner in an upper right half; the patch is counter-clockwise in the tile.
    pub side: usize,
    /// The landmarks at the patch's corners.
    pub corners: [u32; 3],
    /// The patch's sides; side k runs from corner k to corner k + 1.
    pub arcs: [ArcEntry; 3],
}

/// A side of a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ArcEntry {
    /// Number of the arc.
    pub arc: u32,
    /// True if the side runs from the arc's second end to its first.
    pub reversed: bool,
}

impl TileTable {
    /// Writes down an atlas of `base`.
    pub fn new(atlas: &Atlas, base: &BaseComplex) -> Self {
        let half = |half: Half| HalfEntry {
            patch: half.patch.0,
            side: half.side,
            corners: base.corners(half.patch).map(|l| l.0),
            arcs: base.patches[half.patch].map(|side| ArcEntry { arc: side.arc.0, reversed: side.reversed }),
        };
        let tiles = atlas.tiles.iter().map(|tile| TileEntry { first: half(tile.first), second: tile.second.map(half) });
        TileTable { tile_size: atlas.tile_size, columns: atlas.columns, rows: atlas.rows, tiles: tiles.collect() }
    }

    /// Reads the atlas and its base complex back.
    ///
    /// # Errors
    /// Input, if the table contradicts itself: it may come from anywhere.
    pub fn parts(&self) -> Result<(Atlas, BaseComplex)> {
        self.check_grid()?;
        let halves = || self.tiles.iter().flat_map(|tile| std::iter::once(&tile.first).chain(&tile.second));
        let sides: Vec<([ArcEntry; 3], [u32; 3])> = in_patch_order(halves())?;
        let base = base_complex(&sides)?;
        let half = |entry: &HalfEntry| Half { patch: PatchId(entry.patch), side: entry.side };
        let tiles = self.tiles.iter().map(|t| Tile { first: half(&t.first), second: t.second.as_ref().map(half) });
        let atlas = Atlas { tile_size: self.tile_size, columns: self.columns, rows: self.rows, tiles: tiles.collect() };
        for (i, tile) in atlas.tiles.iter().enumerate() {
            let diagonal = |half: Half| base.patches[half.patch][half.side];
            if tile.second.is_some_and(|second| diagonal(second) != diagonal(tile.first).flipped()) {
                return Err(fault("the two patches of a tile do not share its diagonal").at(format!("tile {i}")));
            }
        }
        Ok((atlas, base))
    }

    fn check_grid(&self) -> Result<()> {
        check_tile_size(self.tile_size).map_err(|error| fault(error.what))?;
        let rows_needed = self.tiles.len().checked_div(self.columns).map(|_| self.tiles.len().div_ceil(self.columns));
        let fits = self.columns <= MAX_IMAGE_SIDE / self.tile_size && rows_needed == Some(self.rows);
        if fits {
            return Ok(());
        }
        Err(fault(format!("{} tiles do not fill {} x {} places", self.tiles.len(), self.columns, self.rows)))
    }
}

fn fault(what: impl Into<String>) -> Error {
    Error::input(what).remedy("the tile table is damaged: write the geometry image again")
}

/// Sides and corners of all patches, by patch; every patch must occur exactly once.
fn in_patch_order<'a>(halves: impl Iterator<Item = &'a HalfEntry>) -> Result<Vec<([ArcEntry; 3], [u32; 3])>> {
    let mut halves: Vec<&HalfEntry> = halves.collect();
    halves.sort_by_key(|half| half.patch);
    for (p, half) in halves.iter().enumerate() {
        if half.patch as usize != p || half.side > 2 {
            return Err(
                fault("patches are not numbered one by one, or a side is not 0, 1 or 2").at(PatchId(half.patch))
            );
        }
    }
    Ok(halves.into_iter().map(|half| (half.arcs, half.corners)).collect())
}

/// Joins patches into a base complex; arcs and landmarks must be numbered one by one and sides must meet at corners.
fn base_complex(patches: &[([ArcEntry; 3], [u32; 3])]) -> Result<BaseComplex> {
    let most = 3 * patches.len();
    let mut ends: Vec<Option<[LandmarkId; 2]>> = vec![None; most];
    let mut used = vec![false; 2 * most];
    let mut landmarks = 0;
    for (p, (arcs, corners)) in patches.iter().enumerate() {
        for (k, side) in arcs.iter().enumerate() {
            let side = DirectedArc { arc: ArcId(side.arc), reversed: side.reversed };
            let mut walk = [LandmarkId(corners[k]), LandmarkId(corners[(k + 1) % 3])];
            landmarks = landmarks.max(corners[k] as usize + 1);
            if side.reversed {
                walk.reverse();
            }
            let known = ends.get_mut(side.arc.index()).map(|slot| *slot.get_or_insert(walk));
            if known != Some(walk) || std::mem::replace(&mut used[side.index()], true) {
                let element = format!("side {k} of {}", PatchId::new(p));
                return Err(fault("patches do not fit together along an arc").at(element));
            }
        }
    }
    let count = ends.iter().take_while(|slot| slot.is_some()).count();
    if landmarks > most || ends[count..].iter().any(Option::is_some) {
        return Err(fault("arcs or landmarks are not numbered one by one"));
    }
    let sides = |arcs: &[ArcEntry; 3]| arcs.map(|side| DirectedArc { arc: ArcId(side.arc), reversed: side.reversed });
    Ok(BaseComplex {
        landmarks,
        arcs: ends.into_iter().flatten().collect(),
        patches: patches.iter().map(|(arcs, _)| sides(arcs)).collect::<IdVec<PatchId, _>>(),
    })
}
