//! A surface as a page shows it, and the bytes that it travels in.
//!
//! Positions are 16-bit steps through the box [-1, 1]^3, corners 16 or 32 bits, weights 16 bits, all little-endian in base 64.

use super::base64::base64;
use super::fields::Values;
use super::scale::SCALES;
use glam::{DVec2, DVec3};
use serde::Serialize;
use std::collections::BTreeMap;

/// A surface in one or two spaces, and what is drawn on it.
#[derive(Clone, Debug, Default)]
pub struct Surface {
    /// What it is called, such as its file.
    pub name: String,
    /// Names of the spaces that its vertices have places in: one or two.
    pub spaces: Vec<&'static str>,
    /// The vertices' places in each of these spaces, in viewers' terms: within [-1, 1].
    pub places: Vec<Vec<DVec3>>,
    /// The triangles.
    pub triangles: Vec<[u32; 3]>,
    /// What users know each triangle by, its polygon in the file; empty if that is its own number.
    pub numbers: Vec<u32>,
    /// The distortion of each triangle.
    pub values: Vec<Values>,
    /// The patch of each triangle; of one that lies in several, [`IN_PARTS`].
    pub patches: Vec<u32>,
    /// The parts of triangles that lie in several patches.
    pub parts: Vec<Part>,
    /// Texture coordinates of the triangles' corners, v up; empty without.
    pub uv: Vec<[DVec2; 3]>,
    /// Triangles that are collapsed or turned over, in order.
    pub flips: Vec<u32>,
    /// Lines on the surface: the places of their points, in each space.
    pub lines: Vec<Vec<Vec<DVec3>>>,
    /// Numbers of vertices and triangles of the surface that this one stands in for, if it does.
    pub stands_for: Option<[usize; 2]>,
}

/// The patch of a triangle that lies in several.
pub const IN_PARTS: u32 = u16::MAX as u32;

/// A triangle within a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// The triangle that it is a part of.
    pub triangle: u32,
    /// Its patch.
    pub patch: u32,
    /// Its corners: weights of the whole triangle's corners.
    pub corners: [[f64; 3]; 3],
}

/// The surface as JSON.
#[derive(Debug, Serialize)]
pub struct Packed {
    name: String,
    spaces: Vec<&'static str>,
    vertices: usize,
    triangles: usize,
    /// Bytes of an index: 2 or 4.
    wide: usize,
    flips: Vec<u32>,
    /// Number of points of each line.
    lines: Vec<usize>,
    /// The least texture coordinates, and how far they reach.
    uv: Option<[f64; 4]>,
    stands_for: Option<[usize; 2]>,
    /// The arrays by name.
    bytes: BTreeMap<&'static str, String>,
}

const POSITIONS: [&str; 2] = ["positions0", "positions1"];
const LINES: [&str; 2] = ["lines0", "lines1"];

impl Surface {
    /// The bytes.
    pub fn pack(&self) -> Packed {
        let wide = if self.places.first().is_some_and(|p| p.len() > 1 << 16) { 4 } else { 2 };
        let mut bytes = BTreeMap::new();
        for (k, places) in self.places.iter().enumerate() {
            bytes.insert(POSITIONS[k], steps(places.iter()));
            bytes.insert(LINES[k], steps(self.lines.iter().flat_map(|line| &line[k])));
        }
        let corners = self.triangles.iter().flatten();
        bytes.insert("corners", if wide == 2 { words(corners.map(|&v| v as u16)) } else { longs(corners.copied()) });
        bytes.insert("numbers", longs(self.numbers.iter().copied()));
        bytes.insert("values", words(self.values.iter().flat_map(quantised)));
        bytes.insert("patches", words(self.patches.iter().map(|&p| p as u16)));
        bytes.insert("part_triangles", longs(self.parts.iter().map(|p| p.triangle)));
        bytes.insert("part_patches", words(self.parts.iter().map(|p| p.patch as u16)));
        bytes.insert("part_corners", words(self.parts.iter().flat_map(Part::steps)));
        let uv = uv_box(&self.uv);
        if let Some(range) = uv {
            bytes.insert("uv", words(self.uv.iter().flatten().flat_map(|&p| uv_steps(p, range))));
        }
        Packed {
            name: self.name.clone(),
            spaces: self.spaces.clone(),
            vertices: self.places.first().map_or(0, Vec::len),
            triangles: self.triangles.len(),
            wide,
            flips: self.flips.clone(),
            lines: self.lines.iter().map(|line| line.first().map_or(0, Vec::len)).collect(),
            uv,
            stands_for: self.stands_for,
            bytes,
        }
    }
}

impl Part {
    /// Two weights of every corner, the third is what they leave.
    fn steps(&self) -> [u16; 6] {
        std::array::from_fn(|i| share(self.corners[i / 2][i % 2]))
    }
}

fn quantised(values: &Values) -> [u16; 3] {
    std::array::from_fn(|k| SCALES[k].quantised(values[k]))
}

/// A share of one in steps of 1/65535.
fn share(x: f64) -> u16 {
    (x.clamp(0.0, 1.0) * 65535.0).round() as u16
}

/// Places within [-1, 1]^3 as three steps each.
fn steps<'a>(places: impl Iterator<Item = &'a DVec3>) -> String {
    words(places.flat_map(|p| p.to_array().map(|x| share((x + 1.0) * 0.5))))
}

/// The box around all finite texture coordinates; none without any.
fn uv_box(uv: &[[DVec2; 3]]) -> Option<[f64; 4]> {
    let finite = uv.iter().flatten().filter(|p| p.is_finite());
    let (low, high) = finite.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    (low.x <= high.x).then_some([low.x, low.y, high.x - low.x, high.y - low.y])
}

/// Texture coordinates by their place in the box, in steps of 1/65534; 65535 twice where there are none.
fn uv_steps(p: DVec2, [x, y, width, height]: [f64; 4]) -> [u16; 2] {
    let step = |at: f64, extent: f64| (at / extent.max(f64::MIN_POSITIVE) * 65534.0).round() as u16;
    if p.is_finite() { [step(p.x - x, width), step(p.y - y, height)] } else { [u16::MAX; 2] }
}

fn words(values: impl Iterator<Item = u16>) -> String {
    base64(&values.flat_map(u16::to_le_bytes).collect::<Vec<u8>>())
}

fn longs(values: impl Iterator<Item = u32>) -> String {
    base64(&values.flat_map(u32::to_le_bytes).collect::<Vec<u8>>())
}
