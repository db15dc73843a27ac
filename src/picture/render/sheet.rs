//! Several pictures on one.

use super::scene::BACKGROUND;
use crate::picture::file::{Depth, Picture};

/// Puts pictures side by side, so many in a row, in cells as large as the largest; missing ones leave background.
pub fn contact_sheet(pictures: &[Picture], columns: usize) -> Picture {
    let columns = columns.clamp(1, pictures.len().max(1));
    let cell = |side: fn(&Picture) -> usize| pictures.iter().map(side).max().unwrap_or(1);
    let (width, height) = (cell(|p| p.width), cell(|p| p.height));
    let (all_width, all_height) = (columns * width, pictures.len().div_ceil(columns).max(1) * height);
    let [r, g, b] = BACKGROUND;
    let mut pixels = vec![[r, g, b, 1.0]; all_width * all_height];
    for (i, picture) in pictures.iter().enumerate() {
        let left = i % columns * width + (width - picture.width) / 2;
        let top = i / columns * height + (height - picture.height) / 2;
        for (y, row) in picture.pixels.chunks(picture.width.max(1)).enumerate() {
            let at = (top + y) * all_width + left;
            pixels[at..at + row.len()].copy_from_slice(row);
        }
    }
    Picture { width: all_width, height: all_height, channels: 3, depth: Depth::Byte, pixels }
}
