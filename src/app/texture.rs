//! The images of a texture: one, or one for every tile.

use super::udim::{file_of, is_pattern};
use super::uv::{Tile, UvTriangles};
use crate::error::{Error, Result};
use crate::picture::{Depth, Pyramid, read_picture};
use glam::{DMat2, DVec2};
use std::collections::BTreeMap;
use std::path::Path;

/// Images by tile.
#[derive(Clone, Debug)]
pub struct Textures {
    /// Of one image for all tiles there is only that of tile (0, 0).
    tiles: BTreeMap<Tile, Pyramid>,
    is_single: bool,
    channels: usize,
    depth: Depth,
}

impl Textures {
    /// Reads the image at `path`, or one for every tile that `uv` reaches where the name has `<UDIM>`; the values of `data` are
    /// not decoded from sRGB.
    ///
    /// # Errors
    /// Input, if a file is missing, cannot be read, or differs from the others in channels or depth.
    pub fn read(path: &Path, uv: &UvTriangles, data: bool) -> Result<Textures> {
        let is_single = !is_pattern(path);
        let wanted = if is_single { vec![[0, 0]] } else { uv.tiles() };
        let mut tiles = BTreeMap::new();
        let mut kind = None;
        for tile in wanted {
            let file = file_of(path, tile)?;
            let picture = read_picture(&file, data)?;
            let own = (picture.channels, picture.depth);
            if *kind.get_or_insert(own) != own {
                let what = "the image of a tile differs from the others in channels or depth";
                return Err(Error::input(what).file(&file).remedy("save all tiles alike"));
            }
            tiles.insert(tile, Pyramid::new(&picture));
        }
        let missing =
            || Error::input("the mesh reaches no tile").file(path).remedy("give the mesh texture coordinates");
        let (channels, depth) = kind.ok_or_else(missing)?;
        Ok(Textures { tiles, is_single, channels, depth })
    }

    /// Channels that count.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// The values in the files.
    pub fn depth(&self) -> Depth {
        self.depth
    }

    /// The longest side of an image.
    pub fn largest_side(&self) -> usize {
        self.tiles.values().map(|p| p.size().max_element() as usize).max().unwrap_or(1)
    }

    /// What shows at texture coordinates, averaged over the longer side of the parallelogram that the columns of `by_texel`
    /// span there. None beyond the tiles.
    pub fn sample(&self, uv: DVec2, by_texel: DMat2) -> Option<[f32; 4]> {
        let tile = if self.is_single { [0, 0] } else { [uv.x.floor() as i32, uv.y.floor() as i32] };
        let pyramid = self.tiles.get(&tile)?;
        let pixels = |column: DVec2| (column * pyramid.size()).length();
        let footprint = pixels(by_texel.x_axis).max(pixels(by_texel.y_axis));
        Some(pyramid.sample(uv, footprint))
    }
}
