//! The images that pages hold: small enough for a page, as `data:` addresses.

use super::page::image_address;
use crate::mesh::io::MeshFile;
use crate::mesh::io::materials::read_materials;
use crate::picture::{Depth, Picture, file::format_for, read_picture};
use std::fs;
use std::io::Cursor;
use std::path::Path;

/// Bytes of an image file that is embedded as it is; larger ones are made smaller.
const SMALL: u64 = 300_000;
/// Pixels along the longer side of an image that was made smaller: more than a panel shows at once would be wasted.
const SIDE: usize = 768;

/// The image that a mesh shows: the one asked for, or the first of its materials' that is there; none for meshes without
/// texture coordinates, for several tiles, and for images that cannot be read.
pub fn texture_of(mesh: &MeshFile, asked: Option<&Path>) -> Option<String> {
    if mesh.uv.values.is_empty() {
        return None;
    }
    let of_materials = || {
        let materials = read_materials(mesh).ok()?;
        materials.into_iter().filter_map(|m| m.texture).find(|path| path.is_file())
    };
    let path = asked.map(Path::to_owned).or_else(of_materials)?;
    embedded(&path)
}

/// An image file as a `data:` address, made smaller if it is large; none if it cannot be read.
pub fn embedded(path: &Path) -> Option<String> {
    let size = fs::metadata(path).ok()?.len();
    let bytes = if size <= SMALL { fs::read(path).ok()? } else { Vec::new() };
    match bytes.as_slice() {
        [0x89, b'P', b'N', b'G', ..] => Some(image_address("png", &bytes)),
        [0xff, 0xd8, 0xff, ..] => Some(image_address("jpeg", &bytes)),
        _ => Some(image_address("jpeg", &encoded(&smaller(read_picture(path, false).ok()?, SIDE), "a.jpg")?)),
    }
}

/// The picture as a PNG file's bytes; floats are taken for colours in linear light.
pub fn png(picture: &Picture) -> Option<Vec<u8>> {
    encoded(picture, "a.png")
}

fn encoded(picture: &Picture, name: &str) -> Option<Vec<u8>> {
    let depth = if picture.depth == Depth::DataByte { Depth::DataByte } else { Depth::Byte };
    let mut bytes = Cursor::new(Vec::new());
    let in_bytes = Picture { depth, ..picture.clone() };
    in_bytes.write(format_for(Path::new(name), depth).ok()?, &mut bytes).ok()?;
    Some(bytes.into_inner())
}

/// The picture with blocks of pixels averaged, so that no side is longer than `most`.
pub fn smaller(picture: Picture, most: usize) -> Picture {
    let block = picture.width.max(picture.height).div_ceil(most);
    if block <= 1 {
        return picture;
    }
    let (width, height) = (picture.width.div_ceil(block), picture.height.div_ceil(block));
    let mean = |i: usize| {
        let (left, top) = (i % width * block, i / width * block);
        let rows = top..(top + block).min(picture.height);
        let columns = left..(left + block).min(picture.width);
        let share = 1.0 / (rows.len() * columns.len()) as f32;
        let mut sum = [0.0; 4];
        for pixel in rows.flat_map(|y| &picture.pixels[y * picture.width..][columns.clone()]) {
            (0..4).for_each(|k| sum[k] += pixel[k] * share);
        }
        sum
    };
    Picture { width, height, pixels: (0..width * height).map(mean).collect(), ..picture }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_pictures_are_averaged() {
        let pixels = (0..15).map(|i| [if i % 5 < 2 { 1.0 } else { 0.0 }; 4]).collect();
        let picture = Picture { width: 5, height: 3, channels: 3, depth: Depth::Byte, pixels };
        let small = smaller(picture.clone(), 3);
        assert_eq!((small.width, small.height), (3, 2));
        assert_eq!(small.pixels.iter().map(|p| p[0]).collect::<Vec<_>>(), [1.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
        assert_eq!(smaller(picture.clone(), 5), picture);
    }
}
