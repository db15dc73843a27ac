//! OpenEXR textures: colour or grey, with or without alpha, halves or floats.

use super::file::{Depth, Picture};
use crate::error::{Error, Result};
use exr::prelude::{FlatSamples, ReadChannels, ReadLayers};
use std::io::Cursor;

/// Reads the colour of the first layer that has some: `R`, `G`, `B`, or `Y` for grey, and `A`.
///
/// # Errors
/// Input, if the file is damaged or has no such channels.
pub fn read_exr(bytes: &[u8]) -> Result<Picture> {
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels();
    let file = reader.first_valid_layer().all_attributes().non_parallel().from_buffered(Cursor::new(bytes));
    let damaged =
        |e: exr::error::Error| Error::input(format!("the image cannot be read: {e}")).remedy("export it again");
    let layer = file.map_err(damaged)?.layer_data;
    let channel = |name: &str| {
        let found = layer.channel_data.list.iter().find(|channel| channel.name.eq(name));
        found.map(|channel| &channel.sample_data)
    };
    let (alpha, grey) = (channel("A"), channel("Y"));
    let colours = match ([channel("R"), channel("G"), channel("B")], grey) {
        ([Some(r), Some(g), Some(b)], _) => [r, g, b],
        (_, Some(y)) => [y; 3],
        _ => {
            let what = "the image has neither channels R, G and B nor Y";
            return Err(Error::input(what).remedy("export its colours in one layer without a name"));
        }
    };
    let is_grey = std::ptr::eq(colours[0], colours[1]);
    let pixel = |i: usize| {
        let [r, g, b] = colours.map(|samples| value(samples, i));
        [r, g, b, alpha.map_or(1.0, |samples| value(samples, i))]
    };
    let (width, height) = (layer.size.0, layer.size.1);
    Ok(Picture {
        width,
        height,
        channels: if is_grey { 1 } else { 3 } + usize::from(alpha.is_some()),
        depth: Depth::Float,
        pixels: (0..width * height).map(pixel).collect(),
    })
}

fn value(samples: &FlatSamples, i: usize) -> f32 {
    match samples {
        FlatSamples::F16(values) => values[i].to_f32(),
        FlatSamples::F32(values) => values[i],
        FlatSamples::U32(values) => values[i] as f32,
    }
}
