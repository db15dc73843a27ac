//! Image files: PNG, JPEG and OpenEXR.
//!
//! Inside, values are linear: colours of eight bits are decoded from sRGB on the way in and encoded on the way out, unless
//! the image holds data. Sixteen bits and floats are taken as they are. Alpha is never converted.

use super::exr_file::read_exr;
use super::srgb;
use crate::error::{Error, Result};
use image::{ColorType, DynamicImage, ImageFormat};
use rayon::prelude::*;
use std::io::{Seek, Write};
use std::path::Path;

/// Pixels that a thread encodes at a time.
const GRAIN: usize = 1 << 14;

/// How many bits a value has in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// Eight, of colours in sRGB.
    Byte,
    /// Eight, of data.
    DataByte,
    /// Sixteen.
    Word,
    /// 32-bit floats.
    Float,
}

/// An image in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Channels that count: 1 grey, 2 grey and alpha, 3 colour, 4 colour and alpha.
    pub channels: usize,
    /// What the values were in the file.
    pub depth: Depth,
    /// Red, green, blue, alpha, row by row from the top; grey stands in all three, alpha is 1 if there is none.
    pub pixels: Vec<[f32; 4]>,
}

/// Reads an image; the values of one that holds `data` are not decoded from sRGB.
///
/// # Errors
/// Input, if the file cannot be read or is none of the formats.
pub fn read_picture(path: &Path, data: bool) -> Result<Picture> {
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, &e))?;
    let unknown = || Error::input("not an image that can be read").file(path).remedy("use PNG, JPEG or OpenEXR");
    let format = image::guess_format(&bytes).map_err(|_| unknown())?;
    if !matches!(format, ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::OpenExr) {
        return Err(unknown());
    }
    if format == ImageFormat::OpenExr {
        return read_exr(&bytes).map_err(|e| e.file(path));
    }
    let decoded = image::load_from_memory_with_format(&bytes, format)
        .map_err(|e| Error::input(format!("the image cannot be read: {e}")).file(path).remedy("export it again"))?;
    Ok(picture(decoded, data))
}

fn picture(image: DynamicImage, data: bool) -> Picture {
    let color = image.color();
    let depth = match color {
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 if data => Depth::DataByte,
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => Depth::Byte,
        ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 => Depth::Word,
        _ => Depth::Float,
    };
    let (width, height) = (image.width() as usize, image.height() as usize);
    let values = image.into_rgba32f().into_raw();
    let linear = |&[r, g, b, a]: &[f32; 4]| match depth {
        Depth::Byte => [srgb::decode(r), srgb::decode(g), srgb::decode(b), a],
        _ => [r, g, b, a],
    };
    let pixels = values.as_chunks().0.iter().map(linear).collect();
    Picture { width, height, channels: usize::from(color.channel_count()), depth, pixels }
}

/// The format that an image of some depth can be written in under a name.
///
/// # Errors
/// Usage, for an extension that does not fit.
pub fn format_for(path: &Path, depth: Depth) -> Result<ImageFormat> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let wrong = |what: String, remedy: &str| Err(Error::usage(what).file(path).remedy(remedy));
    match (extension.as_str(), depth) {
        ("png", Depth::Byte | Depth::DataByte | Depth::Word) => Ok(ImageFormat::Png),
        ("jpg" | "jpeg", Depth::Byte | Depth::DataByte) => Ok(ImageFormat::Jpeg),
        ("exr", _) => Ok(ImageFormat::OpenExr),
        ("png" | "jpg" | "jpeg", _) => {
            wrong(format!("{} files do not hold the image's values", extension.to_uppercase()), "end the name in .exr")
        }
        _ => wrong("not the name of an image".into(), "end the name in .png, .jpg or .exr"),
    }
}

impl Picture {
    /// Writes the image in a format from [`format_for`]; JPEG drops alpha, and OpenEXR always has floats.
    pub fn write(&self, format: ImageFormat, out: &mut (impl Write + Seek)) -> Result<()> {
        let channels = match (format, self.channels) {
            (ImageFormat::OpenExr, 1 | 3) => 3,
            (ImageFormat::OpenExr, _) => 4,
            (ImageFormat::Jpeg, 1 | 2) => 1,
            (ImageFormat::Jpeg, _) => 3,
            (_, channels) => channels,
        };
        let float = || self.pick(channels, |x, _| x);
        let word = || self.pick(channels, |x, _| (x.clamp(0.0, 1.0) * 65535.0).round() as u16);
        let byte = || self.pick(channels, |x, is_alpha| self.byte(x, is_alpha));
        let (width, height) = (self.width as u32, self.height as u32);
        let written = match (format, self.depth) {
            (ImageFormat::OpenExr, _) => save(width, height, channels, Samples::Float(float()), format, out),
            (_, Depth::Word) => save(width, height, channels, Samples::Word(word()), format, out),
            _ => save(width, height, channels, Samples::Byte(byte()), format, out),
        };
        written
            .map_err(|e| Error::input(format!("the image cannot be written: {e}")).remedy("check the free disk space"))
    }

    fn byte(&self, x: f32, is_alpha: bool) -> u8 {
        let x = x.clamp(0.0, 1.0);
        let x = if is_alpha || self.depth != Depth::Byte { x } else { srgb::encode(x) };
        (x * 255.0).round() as u8
    }

    /// The first channels of every pixel, alpha last.
    fn pick<T: Copy + Send + Sync>(&self, channels: usize, value: impl Fn(f32, bool) -> T + Sync) -> Vec<T> {
        let lanes: &[usize] = match channels {
            1 => &[0],
            2 => &[0, 3],
            3 => &[0, 1, 2],
            _ => &[0, 1, 2, 3],
        };
        let values = |pixels: &[[f32; 4]]| -> Vec<T> {
            pixels.iter().flat_map(|pixel| lanes.iter().map(|&k| value(pixel[k], k == 3))).collect()
        };
        self.pixels.par_chunks(GRAIN).map(values).collect::<Vec<_>>().concat()
    }
}

/// Values in the form of a file.
enum Samples {
    Byte(Vec<u8>),
    Word(Vec<u16>),
    Float(Vec<f32>),
}

fn save(
    width: u32,
    height: u32,
    channels: usize,
    samples: Samples,
    format: ImageFormat,
    out: &mut (impl Write + Seek),
) -> image::ImageResult<()> {
    use image::ImageBuffer as Buffer;
    let image = match (samples, channels) {
        (Samples::Byte(v), 1) => Buffer::from_raw(width, height, v).map(DynamicImage::ImageLuma8),
        (Samples::Byte(v), 2) => Buffer::from_raw(width, height, v).map(DynamicImage::ImageLumaA8),
        (Samples::Byte(v), 3) => Buffer::from_raw(width, height, v).map(DynamicImage::ImageRgb8),
        (Samples::Byte(v), _) => Buffer::from_raw(width, height, v).map(DynamicImage::ImageRgba8),
        (Samples::Word(v), 1) => Buffer::from_raw(width, height, v).map(DynamicImage::ImageLuma16),
        (Samples::Word(v), 2) => Buffer::from_raw(width, height, v).map(DynamicImage::ImageLumaA16),
        (Samples::Word(v), 3) => Buffer::from_raw(width, height, v).map(DynamicImage::ImageRgb16),
        (Samples::Word(v), _) => Buffer::from_raw(width, height, v).map(DynamicImage::ImageRgba16),
        (Samples::Float(v), 3) => Buffer::from_raw(width, height, v).map(DynamicImage::ImageRgb32F),
        (Samples::Float(v), _) => Buffer::from_raw(width, height, v).map(DynamicImage::ImageRgba32F),
    };
    let image = image.expect("as many values as pixels have channels");
    match (format, &image) {
        (ImageFormat::Jpeg, _) => {
            image.write_with_encoder(image::codecs::jpeg::JpegEncoder::new_with_quality(out, JPEG_QUALITY))
        }
        _ => image.write_to(out, format),
    }
}

/// Of 100: artefacts of lower ones can be seen on textures.
const JPEG_QUALITY: u8 = 95;
