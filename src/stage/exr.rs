//! Flat 32-bit float images as OpenEXR files: ZIP scanlines if nothing else is asked for, row 0 at the top, one custom
//! attribute with JSON text.
//!
//! The bytes depend on the image and the text alone. Blocks of scanlines are compressed in parallel, a bounded number
//! at a time and whichever bands they came with, in the current rayon pool (the file library's own parallel writer would
//! start threads of its own), and are written from top to bottom. There is one custom attribute only because the library
//! keeps attributes in a hash map, whose order changes from run to run.

use crate::error::{Error, Result};
use exr::block::chunk::Chunk;
use exr::block::writer::{ChunkWriter, ChunksWriter};
use exr::block::{BlockIndex, UncompressedBlock, enumerate_ordered_header_block_indices};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::{
    AttributeValue, ChannelDescription, FlatSamples, LayerAttributes, LineOrder, ReadChannels, ReadLayers, SampleType,
    SmallVec, Text,
};
use rayon::prelude::*;
use std::io::{Cursor, Read, Seek, SeekFrom, Write};
use std::iter::Peekable;
use std::vec::IntoIter;

/// The name of the custom attribute.
const ATTRIBUTE: &str = "homeo";

/// Blocks that wait for every thread before they are compressed together: enough to keep all busy, few enough to bound the
/// memory.
const BLOCKS_A_THREAD: usize = 2;

/// How many times larger than its file an image can be; more is not read, so that a small damaged file cannot claim all
/// memory. Deflate, the densest compression in use, comes to 1032.
const MAX_RATIO: u64 = 1 << 12;

/// Rows of the largest blocks, those of PIZ; ZIP has 16, the others have one. Bands of an image that is written piece by piece
/// consist of whole blocks.
pub const BLOCK_ROWS: usize = 32;

/// One channel of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    /// The channel's name in the file: `R`, `G`, `B`, `Y`, or `layer.channel`.
    pub name: String,
    /// The values, row by row from the top.
    pub values: Vec<f32>,
}

/// An image of 32-bit floats.
#[derive(Clone, Debug, PartialEq)]
pub struct FloatImage {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The channels, in alphabetic order of their names.
    pub planes: Vec<Plane>,
}

impl FloatImage {
    /// An image of three channels `R`, `G`, `B` that hold x, y, z.
    pub fn rgb(width: usize, height: usize, pixels: &[[f32; 3]]) -> Self {
        let plane = |(name, axis): (&str, usize)| Plane {
            name: name.to_string(),
            values: pixels.iter().map(|pixel| pixel[axis]).collect(),
        };
        FloatImage { width, height, planes: [("B", 2), ("G", 1), ("R", 0)].map(plane).into() }
    }

    /// An image of the one channel `Y`.
    pub fn grey(width: usize, height: usize, values: Vec<f32>) -> Self {
        FloatImage { width, height, planes: vec![Plane { name: "Y".to_string(), values }] }
    }

    /// The values of a channel, if there is one of that name.
    pub fn plane(&self, name: &str) -> Option<&[f32]> {
        self.planes.iter().find(|plane| plane.name == name).map(|plane| plane.values.as_slice())
    }

    /// The pixels of an image with channels `R`, `G` and `B`.
    pub fn rgb_pixels(&self) -> Option<Vec<[f32; 3]>> {
        let (r, g, b) = (self.plane("R")?, self.plane("G")?, self.plane("B")?);
        Some((0..r.len()).map(|i| [r[i], g[i], b[i]]).collect())
    }

    fn check(&self) -> Result<()> {
        let whole = |plane: &Plane| plane.values.len() == self.width * self.height;
        if self.width == 0 || self.height == 0 || !self.planes.iter().all(whole) {
            return Err(Error::bug(format!("an image of {} x {} pixels lacks some", self.width, self.height)));
        }
        if !self.planes.is_sorted_by(|a, b| a.name < b.name) {
            return Err(Error::bug("the channels of an image are not in alphabetic order"));
        }
        Ok(())
    }
}

/// Writes an image with its JSON text to `out`, which is written from its current position on and should be buffered.
///
/// # Errors
/// Input, if `out` fails; bug, if the image has no pixels or channels of unequal length, or the text is not ASCII.
pub fn write(image: &FloatImage, json: &str, out: impl Write + Seek) -> Result<()> {
    image.check()?;
    let names: Vec<&str> = image.planes.iter().map(|plane| plane.name.as_str()).collect();
    let planes: Vec<&[f32]> = image.planes.iter().map(|plane| plane.values.as_slice()).collect();
    let format = Format { size: [image.width, image.height], names: &names, compression: Compression::Zip };
    write_bands(format, json, out, |band| band(&planes))
}

/// Takes the next rows of an image, for every channel in the order of the names.
pub type BandSink<'a> = dyn FnMut(&[&[f32]]) -> Result<()> + 'a;

/// How the values of a file are compressed; none of them loses any.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compression {
    /// Not at all: large and fast.
    None,
    /// Runs of equal bytes.
    Rle,
    /// Deflate.
    #[default]
    Zip,
    /// Wavelets, good for noise.
    Piz,
}

/// What the header of a file says.
#[derive(Clone, Copy, Debug)]
pub struct Format<'a> {
    /// Width and height.
    pub size: [usize; 2],
    /// Names of the channels, in alphabetic order.
    pub names: &'a [&'a str],
    /// How values are compressed.
    pub compression: Compression,
}

/// Writes an image whose rows `make` hands over in bands from the top; every band but the last has a multiple of
/// [`BLOCK_ROWS`] rows.
///
/// # Errors
/// Those of `make`; input, if `out` fails; bug, if the bands do not make up the image or the text is not ASCII.
pub fn write_bands(
    format: Format,
    json: &str,
    out: impl Write + Seek,
    make: impl FnOnce(&mut BandSink) -> Result<()>,
) -> Result<()> {
    let headers = SmallVec::from_iter([header(format, json)?]);
    let mut failure = None;
    let written = exr::block::write(out, headers, true, |meta, writer| {
        let mut blocks = Blocks::new(format.size, &meta, writer);
        let made = make(&mut |planes| blocks.push(planes));
        let made = made.and_then(|()| blocks.finish());
        made.map_err(|error| {
            failure = Some(error);
            exr::error::Error::Aborted
        })
    });
    match failure {
        Some(error) => Err(error),
        None => written.map_err(writing_failed),
    }
}

/// The bytes of the file that [`write()`] writes.
pub fn encode(image: &FloatImage, json: &str) -> Result<Vec<u8>> {
    let mut bytes = Cursor::new(Vec::new());
    write(image, json, &mut bytes)?;
    Ok(bytes.into_inner())
}

/// Reads a file written by [`write()`]: the image and its JSON text.
///
/// # Errors
/// Input, if the file is not OpenEXR, has other than 32-bit float channels in full resolution, or lacks the text.
pub fn read(mut buffered: impl Read + Seek) -> Result<(FloatImage, String)> {
    check_claim(&mut buffered).map_err(unreadable)?;
    let reader = exr::image::read::read().no_deep_data().largest_resolution_level().all_channels();
    let file = reader.first_valid_layer().all_attributes().non_parallel().from_buffered(buffered);
    let layer = file.map_err(unreadable)?.layer_data;
    let Some(AttributeValue::Text(json)) = layer.attributes.other.get(ATTRIBUTE.as_bytes()) else {
        let what = format!("the image has no attribute '{ATTRIBUTE}'");
        return Err(Error::input(what).remedy("use a geometry image that this program wrote"));
    };
    let mut planes = Vec::new();
    for channel in layer.channel_data.list {
        let name = channel.name.to_string();
        let FlatSamples::F32(values) = channel.sample_data else {
            return Err(Error::input("not a channel of 32-bit floats").at(format!("channel {name}")));
        };
        if values.len() != layer.size.area() {
            return Err(Error::input("a channel without a value for every pixel").at(format!("channel {name}")));
        }
        planes.push(Plane { name, values });
    }
    Ok((FloatImage { width: layer.size.0, height: layer.size.1, planes }, json.to_string()))
}

/// Refuses files whose header claims more pixels than the file can hold.
fn check_claim(file: &mut (impl Read + Seek)) -> exr::error::UnitResult {
    let meta = MetaData::read_from_buffered(&mut *file, false)?;
    let length = file.seek(SeekFrom::End(0))?;
    file.rewind()?;
    let bytes = |header: &Header| -> u64 {
        let samples = [header.layer_size.0, header.layer_size.1, header.channels.list.len()];
        samples.iter().fold(size_of::<f32>() as u64, |product, &n| product.saturating_mul(n as u64))
    };
    if meta.headers.iter().all(|header| bytes(header) / MAX_RATIO <= length) {
        return Ok(());
    }
    Err(exr::error::Error::Invalid("more pixels than the file can hold".into()))
}

fn unreadable(error: exr::error::Error) -> Error {
    Error::input(error.to_string()).remedy("use a whole OpenEXR file")
}

fn header(Format { size: [width, height], names, compression }: Format, json: &str) -> Result<Header> {
    let compression = match compression {
        Compression::None => exr::prelude::Compression::Uncompressed,
        Compression::Rle => exr::prelude::Compression::RLE,
        Compression::Zip => exr::prelude::Compression::ZIP16,
        Compression::Piz => exr::prelude::Compression::PIZ,
    };
    if !json.is_ascii() {
        return Err(Error::bug("the text for an image is not ASCII"));
    }
    let channel = |&name: &&str| {
        Text::new_or_none(name)
            .map(|name| ChannelDescription::named(name, SampleType::F32))
            .ok_or_else(|| Error::bug("a channel name is not ASCII").at(name))
    };
    let channels = names.iter().map(channel).collect::<Result<SmallVec<_>>>()?;
    let attribute = (Text::new_or_panic(ATTRIBUTE), AttributeValue::Text(Text::new_or_panic(json))); // both ASCII
    let attributes = LayerAttributes { other: [attribute].into(), ..LayerAttributes::default() };
    Ok(Header::new(Text::new_or_panic(""), (width, height), channels)
        .with_encoding(compression, BlockDescription::ScanLines, LineOrder::Increasing)
        .with_attributes(attributes))
}

/// The blocks of a file on their way into it.
struct Blocks<'a, W: Write + Seek> {
    width: usize,
    meta: &'a MetaData,
    writer: &'a mut ChunkWriter<W>,
    /// Blocks whose rows have not come yet, from the top, with their numbers.
    open: Peekable<IntoIter<(usize, BlockIndex)>>,
    /// Blocks to be compressed and written next.
    ready: Vec<(usize, UncompressedBlock)>,
    /// So many go together.
    together: usize,
    /// Rows handed over so far.
    rows: usize,
}

impl<'a, W: Write + Seek> Blocks<'a, W> {
    fn new([width, _]: [usize; 2], meta: &'a MetaData, writer: &'a mut ChunkWriter<W>) -> Self {
        let open: Vec<(usize, BlockIndex)> = enumerate_ordered_header_block_indices(&meta.headers).collect();
        let is_plain = |header: &Header| header.compression == exr::prelude::Compression::Uncompressed;
        // What is written as it is waits for nothing, and its memory serves the next one while it is still in the cache.
        let together =
            if meta.headers.iter().all(is_plain) { 1 } else { BLOCKS_A_THREAD * rayon::current_num_threads() };
        Blocks { width, meta, writer, open: open.into_iter().peekable(), ready: Vec::new(), together, rows: 0 }
    }

    /// Takes the blocks of the next rows, and writes blocks once there are enough of them.
    fn push(&mut self, planes: &[&[f32]]) -> Result<()> {
        let first = self.rows;
        self.rows += planes.first().map_or(0, |plane| plane.len() / self.width);
        let rows = self.rows;
        let is_whole = |(_, index): &(usize, BlockIndex)| index.pixel_position.y() + index.pixel_size.height() <= rows;
        while let Some((number, index)) = self.open.next_if(is_whole) {
            self.ready.push((number, block(planes, first, self.width, self.meta, index)));
            if self.ready.len() >= self.together {
                self.write()?;
            }
        }
        match self.open.peek() {
            Some((_, index)) if index.pixel_position.y() < rows => Err(Error::bug("a band ends inside a block")),
            _ => Ok(()),
        }
    }

    /// Compresses the blocks that are ready and writes them in order.
    fn write(&mut self) -> Result<()> {
        let compress =
            |(number, block): (usize, UncompressedBlock)| (number, block.compress_to_chunk(&self.meta.headers));
        let chunks: Vec<(usize, exr::error::Result<Chunk>)> = match self.together {
            1 => self.ready.drain(..).map(compress).collect(),
            _ => self.ready.par_drain(..).map(compress).collect(),
        };
        for (number, chunk) in chunks {
            let written = chunk.and_then(|chunk| self.writer.write_chunk(number, chunk));
            written.map_err(writing_failed)?;
        }
        Ok(())
    }

    fn finish(&mut self) -> Result<()> {
        self.write()?;
        match self.open.peek() {
            None => Ok(()),
            Some(_) => Err(Error::bug(format!("the image ends after {} rows", self.rows))),
        }
    }
}

/// A block's scanlines, for each line one channel after the other, in native byte order as the library expects.
fn block(planes: &[&[f32]], first: usize, width: usize, meta: &MetaData, index: BlockIndex) -> UncompressedBlock {
    let channels = &meta.headers[index.layer].channels;
    UncompressedBlock::from_lines(channels, index, |line| {
        let at = line.location;
        let start = (at.position.y() - first) * width + at.position.x();
        let values = &planes[at.channel][start..start + at.sample_count];
        line.value.copy_from_slice(bytemuck::cast_slice(values));
    })
}

fn writing_failed(error: exr::error::Error) -> Error {
    match error {
        exr::error::Error::Io(error) => Error::input(error.to_string()).remedy("check the free disk space"),
        other => Error::bug(other.to_string()),
    }
}
