//! Moving pictures as GIF files that go on for ever.

use super::file::Picture;
use super::srgb;
use crate::error::{Error, Result};
use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, Frame, RgbaImage};
use std::io::Write;

/// How hard the encoder looks for the best 256 colours, from 1, slow and good, to 30.
const SPEED: i32 = 10;
/// Steps of a channel that are told apart: fewer make smaller files, and bands where shading is soft.
const LEVELS: f32 = 40.0;

/// A picture and for how long it stands, in milliseconds.
pub type Still<'a> = (&'a Picture, u32);

/// Writes pictures of one size, one after the other, without end.
///
/// # Errors
/// Input, if it cannot be written.
pub fn write_loop(stills: &[Still], out: &mut dyn Write) -> Result<()> {
    let failed = |e: image::ImageError| {
        Error::input(format!("the moving picture cannot be written: {e}")).remedy("check the free disk space")
    };
    let mut encoder = GifEncoder::new_with_speed(out, SPEED);
    encoder.set_repeat(Repeat::Infinite).map_err(failed)?;
    for (picture, milliseconds) in stills {
        let (width, height) = (picture.width as u32, picture.height as u32);
        let bytes = picture.pixels.iter().flat_map(|&[r, g, b, _]| [level(r), level(g), level(b), 255]).collect();
        let image = RgbaImage::from_raw(width, height, bytes).ok_or_else(|| Error::bug("a picture lacks pixels"))?;
        let delay = Delay::from_numer_denom_ms(*milliseconds, 1);
        encoder.encode_frame(Frame::from_parts(image, 0, 0, delay)).map_err(failed)?;
    }
    Ok(())
}

/// A channel in linear light as a byte, rounded to one of the levels.
fn level(x: f32) -> u8 {
    ((srgb::encode(x.clamp(0.0, 1.0)) * LEVELS).round() / LEVELS * 255.0).round() as u8
}
