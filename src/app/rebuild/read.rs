//! Position images as they come from a file: which channels hold positions, and whether the tile table fits them.

use crate::error::{Error, Result};
use crate::map::atlas::Atlas;
use crate::map::base_complex::BaseComplex;
use crate::stage::bake::{METADATA_VERSION, Metadata};
use crate::stage::exr::{FloatImage, read};
use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;

/// The channels of a flat image that hold x, y, z.
pub const RGB: [&str; 3] = ["R", "G", "B"];

const WRITE_AGAIN: &str = "write the geometry image again";
const USE_POSITIONS: &str = "use source_position.exr, target_position.exr or geometry.exr of a finished map";

/// Images with more pixels are refused: with six half-edges a pixel, and some to spare for edges that are split, 32-bit
/// ids would not suffice for their meshes.
const MAX_PIXELS: usize = u32::MAX as usize / 8;

/// Which mesh of a layered file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// The source, `source.position`.
    Source,
    /// The target, `target.position`.
    Target,
}

impl Layer {
    fn channels(self) -> [&'static str; 3] {
        match self {
            Layer::Source => ["source.position.X", "source.position.Y", "source.position.Z"],
            Layer::Target => ["target.position.X", "target.position.Y", "target.position.Z"],
        }
    }
}

/// Positions over an atlas.
#[derive(Clone, Debug)]
pub struct PositionImage {
    pub(super) atlas: Atlas,
    pub(super) base: BaseComplex,
    pub(super) pixels: Vec<[f32; 3]>,
}

impl PositionImage {
    /// Takes the positions from three channels of `image`.
    ///
    /// # Errors
    /// Input, if a channel is missing, the image has not the atlas's size or its mesh would be too large.
    pub fn new(image: &FloatImage, channels: [&str; 3], atlas: Atlas, base: BaseComplex) -> Result<Self> {
        if (image.width, image.height) != (atlas.width(), atlas.height()) {
            let (width, height) = (atlas.width(), atlas.height());
            let what = format!("{} x {} pixels, but the tile table has {width} x {height}", image.width, image.height);
            let remedy = "geometry images must not be resized or cropped: write the geometry image again";
            return Err(Error::input(what).remedy(remedy));
        }
        if image.width * image.height > MAX_PIXELS {
            let remedy = "map with a smaller --image";
            return Err(Error::input("more pixels than 32-bit indices can number").remedy(remedy));
        }
        let plane = |name: &str| {
            let missing = || Error::input("a channel is missing").at(format!("channel {name}")).remedy(WRITE_AGAIN);
            image.plane(name).ok_or_else(missing)
        };
        let [x, y, z] = [plane(channels[0])?, plane(channels[1])?, plane(channels[2])?];
        let pixels = x.iter().zip(y).zip(z).map(|((&x, &y), &z)| [x, y, z]).collect();
        Ok(PositionImage { atlas, base, pixels })
    }

    /// Reads a flat position image, or one layer of a layered file, by default the source.
    ///
    /// # Errors
    /// Usage, if a layer is named for a flat file; input, if the file is no position image of this program or damaged.
    pub fn open(path: &Path, layer: Option<Layer>) -> Result<Self> {
        let file = File::open(path).map_err(|e| Error::io(path, &e))?;
        PositionImage::parse(BufReader::new(file), layer).map_err(|error| error.file(path))
    }

    /// The same from anything that can be read.
    ///
    /// # Errors
    /// See [`PositionImage::open`].
    pub fn parse(buffered: impl Read + Seek, layer: Option<Layer>) -> Result<Self> {
        let (image, json) = read(buffered)?;
        let no_table = |error: serde_json::Error| Error::input(format!("no tile table: {error}")).remedy(USE_POSITIONS);
        let metadata: Metadata = serde_json::from_str(&json).map_err(no_table)?;
        if metadata.version != METADATA_VERSION {
            let what = format!("a geometry image of version {}, not {METADATA_VERSION}", metadata.version);
            return Err(Error::input(what).remedy("use the version of homeo that wrote it"));
        }
        let channels = channels(&metadata.image, layer)?;
        let (atlas, base) = metadata.atlas.parts()?;
        PositionImage::new(&image, channels, atlas, base)
    }
}

/// The channels with the positions in an image of this name.
fn channels(image: &str, layer: Option<Layer>) -> Result<[&'static str; 3]> {
    match (image, layer) {
        ("geometry", layer) => Ok(layer.unwrap_or(Layer::Source).channels()),
        ("source_position" | "target_position", None) => Ok(RGB),
        ("source_position" | "target_position", Some(_)) => {
            Err(Error::usage("a flat geometry image has no layers").remedy("leave out --layer, or use geometry.exr"))
        }
        (other, _) => Err(Error::input(format!("the image holds {other:?}, no positions")).remedy(USE_POSITIONS)),
    }
}
