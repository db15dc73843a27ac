//! What the viewer of a page shows: surfaces, the panels that they stand in, marks, modes.

use super::html::script_data;
use super::scale::{SCALES, Scale};
use super::surface::{Packed, Surface};
use glam::{DVec2, DVec3};
use serde::Serialize;

/// Where a panel shows its surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum At {
    /// In its first space.
    First,
    /// In its second space.
    Second,
    /// On the way from the first to the second, where the page's slider stands.
    Slider,
}

/// From the front, a little from the side and above.
pub const THREE_QUARTER: [f64; 2] = [0.62, 0.26];

/// One view.
#[derive(Clone, Debug, Serialize)]
pub struct Panel {
    /// Its heading.
    pub title: &'static str,
    /// What stands behind it.
    pub subtitle: String,
    /// The number of the surface.
    pub surface: usize,
    /// Where it is shown.
    pub at: At,
    /// True for the plane: it is not turned, and shown without light.
    pub flat: bool,
    /// True if the scene's image lies behind the surface, over the unit square of the plane.
    pub backdrop: bool,
}

/// A point with a name.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mark {
    /// Its name.
    pub name: String,
    /// Its places in the spaces of the first surface.
    pub places: Vec<[f64; 3]>,
}

/// How surfaces are coloured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// By patch or region.
    Patches,
    /// By distortion.
    Distortion,
    /// By a checkerboard that goes through the map.
    Checker,
    /// By the image.
    Texture,
    /// By where a point is in the first space.
    Places,
    /// In one colour.
    Plain,
}

/// Everything that the viewer needs.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The surfaces.
    pub surfaces: Vec<Surface>,
    /// The views, from left to right.
    pub panels: Vec<Panel>,
    /// Landmarks or constraints.
    pub marks: Vec<Mark>,
    /// What marks are called.
    pub mark_name: &'static str,
    /// What patches are called.
    pub patch_name: &'static str,
    /// The patches' own names, if they have some.
    pub patch_names: Vec<String>,
    /// The patches' colours.
    pub patch_colors: Vec<u32>,
    /// The modes that there are, the first one first.
    pub modes: Vec<Mode>,
    /// The image as a `data:` address.
    pub texture: Option<String>,
    /// From where bodies are seen at first: the angles around the vertical and above the horizontal, radians.
    pub home: [f64; 2],
    /// True if checkers, and isolines, follow texture coordinates and not places in the first space.
    pub by_uv: bool,
}

/// The scene as the page's script reads it.
#[derive(Serialize)]
struct Document<'a> {
    surfaces: Vec<Packed>,
    panels: &'a [Panel],
    marks: &'a [Mark],
    mark_name: &'a str,
    patch_name: &'a str,
    patch_names: &'a [String],
    patch_colors: &'a [u32],
    modes: &'a [Mode],
    texture: Option<&'a str>,
    home: [f64; 2],
    by_uv: bool,
    scales: [Scale; 3],
}

impl Scene {
    /// The scene as JSON that can stand in a `script` element.
    pub fn data(&self) -> String {
        script_data(&Document {
            surfaces: self.surfaces.iter().map(Surface::pack).collect(),
            panels: &self.panels,
            marks: &self.marks,
            mark_name: self.mark_name,
            patch_name: self.patch_name,
            patch_names: &self.patch_names,
            patch_colors: &self.patch_colors,
            modes: &self.modes,
            texture: self.texture.as_deref(),
            home: self.home,
            by_uv: self.by_uv,
            scales: SCALES,
        })
    }
}

/// A place in the unit square of texture coordinates, v up, in viewers' terms.
pub fn in_plane(uv: DVec2) -> DVec3 {
    (uv * 2.0 - 1.0).extend(0.0)
}

impl Mark {
    /// A mark on all surfaces that share the first one's spaces.
    pub fn new(name: &str, places: impl IntoIterator<Item = DVec3>) -> Self {
        let places = places.into_iter().map(|p| p.to_array().map(|x| (x * 1e5).round() / 1e5));
        Mark { name: name.to_owned(), places: places.collect() }
    }
}
