//! Geometry images as pictures to look at.

use crate::map::product::NamedFile;
use crate::picture::{Depth, Picture};
use crate::stage::bake::BakedImage;
use crate::view::image::{png, smaller};
use glam::Vec3;

/// Pixels along a thumbnail's longer side, at most: about as wide as the page shows it, and four of them are as large as a mesh.
const SIDE: usize = 320;

/// The images that show something, each with a caption and as a PNG file's bytes.
pub fn thumbnails(images: &[BakedImage]) -> Vec<NamedFile> {
    let caption = |name: &str| match name {
        "source_position" => Some("Source, positions as colours"),
        "source_normal" => Some("Source, normals as colours"),
        "target_position" => Some("Target, positions as colours"),
        "target_normal" => Some("Target, normals as colours"),
        _ => None,
    };
    let thumbnail = |image: &BakedImage| {
        let caption = caption(image.name)?;
        let bytes = png(&picture(image, image.name.ends_with("normal"))?)?;
        Some((caption.to_owned(), bytes))
    };
    images.iter().filter_map(thumbnail).collect()
}

/// Values in the box around them as colours; unit vectors in that around the unit ball.
fn picture(image: &BakedImage, is_unit: bool) -> Option<Picture> {
    let (width, height) = (image.image.width, image.image.height);
    let values: Vec<Vec3> = image.image.rgb_pixels()?.into_iter().map(Vec3::from_array).collect();
    let around = || values.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let (low, high) = if is_unit { (Vec3::NEG_ONE, Vec3::ONE) } else { around() };
    let extent = (high - low).max(Vec3::splat(f32::MIN_POSITIVE));
    let pixels = values.iter().map(|v| ((*v - low) / extent).extend(1.0).to_array()).collect();
    let picture = smaller(Picture { width, height, channels: 3, depth: Depth::DataByte, pixels }, SIDE);
    Some(picture)
}
