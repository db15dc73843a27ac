//! What a picture shows.

use crate::mesh::VertexId;
use crate::picture::Pyramid;
use crate::picture::srgb;
use glam::{DVec2, DVec3};

/// Red, green and blue in linear light, 0 to 1.
pub type Color = [f32; 3];

/// Light grey, sRGB 238.
pub(super) const BACKGROUND: Color = [0.854_992_6; 3];

/// The colour with this sRGB code, as in `0xff8000`.
pub fn color(code: u32) -> Color {
    [16, 8, 0].map(|shift| srgb::decode(((code >> shift) & 0xff) as f32 / 255.0))
}

/// How a surface is coloured; a slice has an entry for every triangle or vertex.
#[derive(Clone, Copy, Debug)]
pub enum Paint<'a> {
    /// One colour.
    Plain(Color),
    /// A colour for every triangle.
    Faces(&'a [Color]),
    /// A colour for every vertex, interpolated between them.
    Vertices(&'a [Color]),
    /// An image at the texture coordinates of every triangle's corners, v up; white where they are not finite.
    Texture(&'a [[DVec2; 3]], &'a Pyramid),
    /// Squares of the first and the second colour, so many to a unit of texture coordinates.
    Checker(&'a [[DVec2; 3]], f64, [Color; 2]),
}

/// A line on the surface.
#[derive(Clone, Debug)]
pub struct Line {
    /// Its points in space.
    pub points: Vec<DVec3>,
    /// Its colour.
    pub color: Color,
    /// Its width in pixels.
    pub width: f64,
}

/// A mark at a point of the surface, with a white rim.
#[derive(Clone, Copy, Debug)]
pub struct Dot {
    /// Its centre in space.
    pub at: DVec3,
    /// Its colour.
    pub color: Color,
    /// Its radius in pixels.
    pub radius: f64,
}

/// A surface and the marks on it. Surfaces hide the lines and dots behind them.
#[derive(Clone, Debug)]
pub struct Scene<'a> {
    /// Vertices.
    pub positions: &'a [DVec3],
    /// Triangles, counter-clockwise seen from outside; their insides are shown darker.
    pub triangles: &'a [[VertexId; 3]],
    /// Their colours.
    pub paint: Paint<'a>,
    /// True for light that does not show the triangles.
    pub smooth: bool,
    /// Lines, later ones over earlier ones.
    pub lines: Vec<Line>,
    /// Dots, over the lines.
    pub dots: Vec<Dot>,
}

impl<'a> Scene<'a> {
    /// A smooth surface without marks.
    pub fn new(positions: &'a [DVec3], triangles: &'a [[VertexId; 3]], paint: Paint<'a>) -> Self {
        Scene { positions, triangles, paint, smooth: true, lines: Vec::new(), dots: Vec::new() }
    }
}
