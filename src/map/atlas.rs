//! The common atlas: the patches of a base complex laid out as square tiles of samples, two patches to a tile.
//!
//! Both meshes carry the same base complex, so they get the same atlas: pixel (x, y) of one geometry image corresponds
//! to pixel (x, y) of the other (X. Gu, S. Gortler, H. Hoppe, "Geometry Images", SIGGRAPH 2002; here one image per pair
//! of patches). A tile, with `o` for the landmarks, `s` for the side of each patch that lies on the diagonal:
//!
//! ```text
//! corner s+1 of first,  o-----------o  corner s+2 of second
//! corner s of second    | \  second |
//!                       |   \       |
//!                       | first \   |
//! corner s+2 of first   o-----------o  corner s of first, corner s+1 of second
//! ```
//!
//! Samples lie on the tile's border and diagonal, so neighbouring patches sample their common arc at the same points,
//! bit for bit: see [`BaseSample`].

use super::base_complex::{BaseComplex, NO_PATCH};
use crate::error::{Error, Result};
use crate::mesh::{ArcId, Id, IdVec, LandmarkId, PatchId};
use crate::solve::matching::maximum_matching;

/// Images whose width or height exceeds this are refused: coordinates in image files are signed 32-bit numbers, and
/// several readers give up far earlier.
pub const MAX_IMAGE_SIDE: usize = 1 << 20;

/// Where a sample lies on the base complex. Equal places have equal values: an arc's samples do not tell from which
/// patch, nor in which direction, they were reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BaseSample {
    /// At a landmark.
    Landmark(LandmarkId),
    /// On an arc, at the share in (0, 1) of the way from the arc's first end to its second.
    OnArc(ArcId, f64),
    /// Inside a patch, with positive barycentric coordinates in its base triangle, in corner order, that sum to one
    /// exactly.
    InPatch(PatchId, [f64; 3]),
}

/// A patch in one half of a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Half {
    /// The patch.
    pub patch: PatchId,
    /// The side of the patch, 0 to 2, that lies on the tile's diagonal.
    pub side: usize,
}

/// A square tile: two patches that share an arc, or one patch alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// The patch in the lower left half.
    pub first: Half,
    /// The patch in the upper right half, if there is one.
    pub second: Option<Half>,
}

impl Tile {
    /// The halves that hold a patch, the lower left one first.
    pub fn halves(&self) -> impl Iterator<Item = (Corner, Half)> + use<> {
        [(Corner::LowerLeft, Some(self.first)), (Corner::UpperRight, self.second)]
            .into_iter()
            .filter_map(|(corner, half)| half.map(|half| (corner, half)))
    }
}

/// The two halves of a tile, named by the tile corner that is theirs alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corner {
    /// The first patch's half.
    LowerLeft,
    /// The second patch's half.
    UpperRight,
}

/// A pixel, counted from the left and, as in all image files, from the top.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Pixel {
    /// Column.
    pub x: usize,
    /// Row, 0 at the top.
    pub y: usize,
}

/// Tiles in a near-square grid, row by row from the top left; see the module documentation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Atlas {
    /// Samples along a tile's side, a power of two plus one.
    pub tile_size: usize,
    /// Tiles in a row.
    pub columns: usize,
    /// Rows of tiles.
    pub rows: usize,
    /// The tiles; places left in the last row stay empty.
    pub tiles: Vec<Tile>,
}

impl Atlas {
    /// Pairs the patches of `base` into as many tiles of two as possible and packs the tiles.
    ///
    /// A perfect pairing exists when the surface is closed and no arc's removal separates its patches (Petersen's
    /// theorem). Among the pairings the search starts from arcs of low `cost` (for instance minus the arc's length: a
    /// long diagonal makes a compact quad); without costs from arcs of low number.
    ///
    /// # Errors
    /// Usage, if `tile_size` is not a power of two plus one or the image would exceed [`MAX_IMAGE_SIDE`].
    pub fn new(base: &BaseComplex, tile_size: usize, cost: Option<&IdVec<ArcId, f64>>) -> Result<Self> {
        check_tile_size(tile_size)?;
        let tiles = pair_patches(base, cost);
        let columns = (tiles.len() as f64).sqrt().ceil() as usize;
        let rows = if columns == 0 { 0 } else { tiles.len().div_ceil(columns) };
        if columns > MAX_IMAGE_SIDE / tile_size {
            let what = format!("a geometry image of {columns} x {rows} tiles of {tile_size} samples is too large");
            return Err(Error::usage(what).remedy("choose a smaller --image"));
        }
        Ok(Atlas { tile_size, columns, rows, tiles })
    }

    /// Width of the image in pixels.
    pub fn width(&self) -> usize {
        self.columns * self.tile_size
    }

    /// Height of the image in pixels.
    pub fn height(&self) -> usize {
        self.rows * self.tile_size
    }

    /// Steps along a tile's side.
    pub fn steps(&self) -> usize {
        self.tile_size - 1
    }

    /// The number of a pixel, row by row from the top.
    pub fn index(&self, pixel: Pixel) -> usize {
        pixel.y * self.width() + pixel.x
    }

    /// All pixels inside the mask, row by row, with the place each samples.
    pub fn samples<'a>(&'a self, base: &'a BaseComplex) -> impl Iterator<Item = (Pixel, BaseSample)> + 'a {
        let pixels = (0..self.height()).flat_map(|y| (0..self.width()).map(move |x| Pixel { x, y }));
        pixels.filter_map(|pixel| Some((pixel, self.sample(base, pixel)?)))
    }

    /// The place a pixel samples; None outside the mask. Pixels on the diagonal count to the first patch.
    pub fn sample(&self, base: &BaseComplex, pixel: Pixel) -> Option<BaseSample> {
        let (tile, right, up) = self.locate(pixel)?;
        let steps = self.steps();
        let (half, along) = if right + up <= steps {
            (tile.first, [right, up, steps - right - up])
        } else {
            (tile.second?, [steps - right, steps - up, right + up - steps])
        };
        let mut coords = [0; 3];
        for (k, a) in along.into_iter().enumerate() {
            coords[(half.side + k) % 3] = a;
        }
        Some(grid_sample(base, half.patch, coords))
    }

    /// The pixel that samples a patch at barycentric coordinates `coords / steps`; the inverse of [`Atlas::sample`].
    ///
    /// `tile` is the number of the tile and `half` its half with the patch.
    pub fn pixel(&self, tile: usize, corner: Corner, half: Half, coords: [usize; 3]) -> Pixel {
        let steps = self.steps();
        let (a, b) = (coords[half.side], coords[(half.side + 1) % 3]);
        let (right, up) = match corner {
            Corner::LowerLeft => (a, b),
            Corner::UpperRight => (steps - a, steps - b),
        };
        let (column, row) = (tile % self.columns, tile / self.columns);
        Pixel { x: column * self.tile_size + right, y: row * self.tile_size + steps - up }
    }

    /// The pixel inside the mask whose value a pixel outside takes; a pixel inside is its own.
    ///
    /// In the empty half of a tile it is a nearest pixel of the diagonal, so that filters at the diagonal see only the
    /// patch itself. A pixel in an empty place of the grid takes what the nearest pixel of a tile takes.
    pub fn nearest_inside(&self, pixel: Pixel) -> Pixel {
        let pixel = self.nearest_tile_pixel(pixel);
        let Some((Tile { second: None, .. }, right, up)) = self.locate(pixel) else { return pixel };
        let beyond = (right + up).saturating_sub(self.steps());
        Pixel { x: pixel.x - beyond.div_ceil(2), y: pixel.y + beyond / 2 }
    }

    /// The nearest pixel that lies in a tile; the one above if there are two.
    fn nearest_tile_pixel(&self, pixel: Pixel) -> Pixel {
        let column = pixel.x / self.tile_size;
        let row = pixel.y / self.tile_size;
        if row * self.columns + column < self.tiles.len() {
            return pixel;
        }
        let above = row.checked_sub(1).map(|_| Pixel { y: row * self.tile_size - 1, ..pixel });
        let last_column = (self.tiles.len() - 1) % self.columns;
        let beside = Pixel { x: (last_column + 1) * self.tile_size - 1, ..pixel };
        above.filter(|above| pixel.y - above.y <= pixel.x - beside.x).unwrap_or(beside)
    }

    /// The tile of a pixel and the pixel's steps from the tile's lower left corner.
    fn locate(&self, pixel: Pixel) -> Option<(Tile, usize, usize)> {
        let (column, row) = (pixel.x / self.tile_size, pixel.y / self.tile_size);
        let tile = *self.tiles.get(row * self.columns + column).filter(|_| column < self.columns)?;
        Some((tile, pixel.x % self.tile_size, self.steps() - pixel.y % self.tile_size))
    }
}

/// Refuses tile sizes that are not a power of two plus one: only they make shares and coordinates exact.
pub fn check_tile_size(tile_size: usize) -> Result<()> {
    if tile_size >= 2 && (tile_size - 1).is_power_of_two() {
        return Ok(());
    }
    let what = format!("{tile_size} samples along a tile's side is not a power of two plus one");
    Err(Error::usage(what).remedy("use --image 17, 33, 65 or 129, or 0 for no images"))
}

/// Pairs patches across arcs; tiles come in the order of their lowest patch.
fn pair_patches(base: &BaseComplex, cost: Option<&IdVec<ArcId, f64>>) -> Vec<Tile> {
    let side_of = base.side_of();
    let mut arcs: Vec<ArcId> = base.arcs.ids().collect();
    if let Some(cost) = cost {
        arcs.sort_by(|&a, &b| cost[a].total_cmp(&cost[b]));
    }
    let sides = |a: ArcId| [side_of[2 * a.index()], side_of[2 * a.index() + 1]];
    arcs.retain(|&a| sides(a).iter().all(|&(p, _)| p != NO_PATCH));
    let edges: Vec<[usize; 2]> = arcs.iter().map(|&a| sides(a).map(|(p, _)| p.index())).collect();
    let matched = maximum_matching(base.patches.len(), &edges);
    let tile_of = |p: PatchId| {
        let Some(e) = matched[p.index()] else {
            return Some(Tile { first: Half { patch: p, side: 0 }, second: None });
        };
        let mut halves = sides(arcs[e]).map(|(patch, side)| Half { patch, side });
        halves.sort_by_key(|half| half.patch);
        let [first, second] = halves;
        (first.patch == p).then_some(Tile { first, second: Some(second) })
    };
    base.patches.ids().filter_map(tile_of).collect()
}

/// The place in `patch` with barycentric coordinates `coords / (sum of coords)`; the sum is a power of two.
fn grid_sample(base: &BaseComplex, patch: PatchId, coords: [usize; 3]) -> BaseSample {
    let steps = coords.iter().sum::<usize>();
    let share = |a: usize| a as f64 / steps as f64;
    if let Some(k) = coords.iter().position(|&a| a == steps) {
        return BaseSample::Landmark(base.start(base.patches[patch][k]));
    }
    if let Some(opposite) = coords.iter().position(|&a| a == 0) {
        let side = base.patches[patch][(opposite + 1) % 3];
        let away_from_first_end = if side.reversed { (opposite + 1) % 3 } else { (opposite + 2) % 3 };
        return BaseSample::OnArc(side.arc, share(coords[away_from_first_end]));
    }
    BaseSample::InPatch(patch, coords.map(share))
}
