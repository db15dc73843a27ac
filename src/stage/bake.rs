//! Bakes the geometry images of a finished map: position, normal and texture coordinates of both meshes, stretch and mask
//! over one atlas.

use super::exr::{FloatImage, Plane, encode};
use crate::error::{Error, Result};
use crate::map::atlas::{Atlas, Pixel};
use crate::map::base_complex::BaseComplex;
use crate::map::tile_table::TileTable;
use crate::mesh::{FaceId, IdVec, TriMesh, VertexId};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Version of the metadata and of the tile table in an image.
pub const METADATA_VERSION: u32 = 1;

/// A point to resample at: three vertices and their barycentric weights.
pub type Query = ([u32; 3], [f32; 3]);

/// Interpolates attributes, one of four components per vertex, at queries; answers in the order of the queries.
///
/// Equal queries must get equal answers, and a query with one weight 1 and two weights 0 the attribute itself.
pub type Resample<'a> = dyn Fn(&[[f32; 4]], &[Query]) -> Result<Vec<[f32; 4]>> + 'a;

/// A mesh to bake and where the samples lie on it.
#[derive(Clone, Copy)]
pub struct Sampled<'a> {
    /// The mesh as it was read, not the cut mesh.
    pub mesh: &'a TriMesh,
    /// For every sample of [`Atlas::samples`], in that order, its face and barycentric coordinates.
    ///
    /// Equal samples must have equal points, down to the choice of the face: then images agree on tile borders.
    pub points: &'a [(FaceId, [f64; 3])],
    /// The texture coordinates there, v up: those of the sample's face, where a seam runs; none for a mesh without any.
    pub uv: Option<&'a [[f32; 2]]>,
}

/// One geometry image; `name` is its file name without extension.
#[derive(Clone, Debug, PartialEq)]
pub struct BakedImage {
    /// What the image holds: `source_position`, `source_normal`, `target_position`, `target_normal`, `stretch`, `mask`,
    /// `source_uv`, `target_uv`.
    pub name: &'static str,
    /// The unit of its values, in words.
    pub unit: &'static str,
    /// The pixels.
    pub image: FloatImage,
}

/// The JSON text in a geometry image's attribute.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Metadata {
    /// [`METADATA_VERSION`].
    pub version: u32,
    /// The name of the image.
    pub image: String,
    /// The unit of its values, in words.
    pub units: String,
    /// Always `data`: the values are no colours, and a reader must not convert them.
    #[serde(rename = "colorInteropID")]
    pub color_interop_id: String,
    /// The tiles.
    pub atlas: TileTable,
}

impl BakedImage {
    /// The bytes of the image's EXR file.
    pub fn encode(&self, table: &TileTable) -> Result<Vec<u8>> {
        encode(&self.image, &metadata(self.name, self.unit.to_string(), table)?)
    }

    /// The name of the image's layer in a layered file: `source.position` for `source_position`.
    pub fn layer(&self) -> String {
        self.name.replace('_', ".")
    }

    /// The image's channels in a layered file: `X`, `Y`, `Z` of its layer, `Y` alone, or `U` and `V`.
    fn planes(&self) -> impl Iterator<Item = Plane> {
        let layer = self.layer();
        let is_uv = layer.ends_with(".uv");
        self.image.planes.iter().filter_map(move |plane| {
            let channel = match (plane.name.as_str(), is_uv) {
                ("R", false) => "X",
                ("B", false) => "Z",
                (_, false) => "Y",
                ("R", true) => "U",
                ("G", true) => "V",
                (_, true) => return None,
            };
            Some(Plane { name: format!("{layer}.{channel}"), values: plane.values.clone() })
        })
    }
}

/// The bytes of one EXR file with all images as layers; its `R`, `G` and `B` show the first image.
///
/// # Errors
/// Bug, if there are no images or they differ in size.
pub fn encode_layered(images: &[BakedImage], table: &TileTable) -> Result<Vec<u8>> {
    let first = images.first().ok_or_else(|| Error::bug("no images to write"))?;
    let mut planes: Vec<Plane> = first.image.planes.clone();
    planes.extend(images.iter().flat_map(BakedImage::planes));
    planes.sort_by(|a, b| a.name.cmp(&b.name));
    let units: Vec<String> = images.iter().map(|image| format!("{}: {}", image.layer(), image.unit)).collect();
    let image = FloatImage { width: first.image.width, height: first.image.height, planes };
    encode(&image, &metadata("geometry", units.join("; "), table)?)
}

fn metadata(image: &str, units: String, table: &TileTable) -> Result<String> {
    let metadata = Metadata {
        version: METADATA_VERSION,
        image: image.to_string(),
        units,
        color_interop_id: "data".to_string(),
        atlas: table.clone(),
    };
    serde_json::to_string(&metadata).map_err(|error| Error::bug(error.to_string()))
}

/// Bakes the images over `atlas`: both positions, both normals, the map's stretch on the source, the mask, and the texture
/// coordinates of meshes that have some.
///
/// Pixels outside the mask take the value of [`Atlas::nearest_inside`]; the mask itself is 1 inside and 0 outside.
/// `stretch` is the L2 stretch of the map at every source vertex (1 for an isometry), interpolated like a position.
///
/// # Errors
/// Bug, if the numbers of points, texture coordinates or stretches do not fit the atlas and the source; whatever `resample` reports.
pub fn bake(
    base: &BaseComplex,
    atlas: &Atlas,
    source: Sampled,
    target: Sampled,
    stretch: &IdVec<VertexId, f64>,
    resample: &Resample,
) -> Result<Vec<BakedImage>> {
    if stretch.len() != source.mesh.positions.len() {
        return Err(Error::bug(format!("{} stretches for {} vertices", stretch.len(), source.mesh.positions.len())));
    }
    let canvas = Canvas::new(base, atlas);
    let none = IdVec::filled(0.0, target.mesh.positions.len());
    let on_source = canvas.sample(source, stretch, resample)?;
    let on_target = canvas.sample(target, &none, resample)?;
    let mesh_unit = "length unit of the mesh file";
    let image = |name, unit, image| BakedImage { name, unit, image };
    let mut images = vec![
        image("source_position", mesh_unit, canvas.vectors(&on_source.position)),
        image("source_normal", "unit vector", canvas.vectors(&on_source.normal)),
        image("target_position", mesh_unit, canvas.vectors(&on_target.position)),
        image("target_normal", "unit vector", canvas.vectors(&on_target.normal)),
        image("stretch", "ratio of lengths", canvas.scalars(&on_source.scalar)),
        image("mask", "1 inside, 0 outside", canvas.mask()),
    ];
    for (name, side) in [("source_uv", source), ("target_uv", target)] {
        let Some(uv) = side.uv else { continue };
        canvas.check_samples(uv.len())?;
        let uv: Vec<[f32; 3]> = uv.iter().map(|&[u, v]| [u, v, 0.0]).collect();
        images.push(image(name, "texture coordinate, v up", canvas.vectors(&uv)));
    }
    Ok(images)
}

/// What is sampled on one mesh, per sample of the atlas.
struct Samples {
    position: Vec<[f32; 3]>,
    scalar: Vec<f32>,
    normal: Vec<[f32; 3]>,
}

/// The pixels of an atlas: for each the sample that fills it.
struct Canvas {
    width: usize,
    height: usize,
    samples: usize,
    /// For every pixel, row by row, the sample it shows, and whether it lies inside the mask.
    shows: Vec<(usize, bool)>,
}

impl Canvas {
    fn new(base: &BaseComplex, atlas: &Atlas) -> Self {
        let (width, height) = (atlas.width(), atlas.height());
        let mut sample_at = vec![None; width * height];
        let mut samples = 0;
        for (pixel, _) in atlas.samples(base) {
            sample_at[atlas.index(pixel)] = Some(samples);
            samples += 1;
        }
        let show = |i: usize| match sample_at[i] {
            Some(sample) => (sample, true),
            None => {
                let inside = atlas.nearest_inside(Pixel { x: i % width, y: i / width });
                let sample = sample_at[atlas.index(inside)].expect("nearest_inside names a pixel inside the mask");
                (sample, false)
            }
        };
        let shows = (0..sample_at.len()).map(show).collect();
        Canvas { width, height, samples, shows }
    }

    /// Samples positions, normals and one scalar on a mesh.
    fn sample(&self, on: Sampled, scalar: &IdVec<VertexId, f64>, resample: &Resample) -> Result<Samples> {
        self.check_samples(on.points.len())?;
        let queries: Vec<Query> = on.points.iter().map(|&(f, b)| (on.mesh.face(f).map(|v| v.0), single(b))).collect();
        let positions = on.mesh.positions.iter_ids().map(|(v, p)| attribute(*p, scalar[v]));
        let values = answers(resample, &positions.collect::<Vec<_>>(), &queries)?;
        let normals: Vec<[f32; 4]> = vertex_normals(on.mesh).iter().map(|&n| attribute(n, 0.0)).collect();
        let normals = answers(resample, &normals, &queries)?;
        Ok(Samples {
            position: values.iter().map(|&[x, y, z, _]| [x, y, z]).collect(),
            scalar: values.iter().map(|value| value[3]).collect(),
            normal: normals.into_iter().map(normalised).collect(),
        })
    }

    fn check_samples(&self, points: usize) -> Result<()> {
        if points == self.samples {
            return Ok(());
        }
        Err(Error::bug(format!("{points} points for {} samples", self.samples)))
    }

    fn vectors(&self, samples: &[[f32; 3]]) -> FloatImage {
        let pixels: Vec<[f32; 3]> = self.shows.iter().map(|&(sample, _)| samples[sample]).collect();
        FloatImage::rgb(self.width, self.height, &pixels)
    }

    fn scalars(&self, samples: &[f32]) -> FloatImage {
        FloatImage::grey(self.width, self.height, self.shows.iter().map(|&(sample, _)| samples[sample]).collect())
    }

    fn mask(&self) -> FloatImage {
        let inside = self.shows.iter().map(|&(_, inside)| f32::from(u8::from(inside)));
        FloatImage::grey(self.width, self.height, inside.collect())
    }
}

fn answers(resample: &Resample, attributes: &[[f32; 4]], queries: &[Query]) -> Result<Vec<[f32; 4]>> {
    let answers = resample(attributes, queries)?;
    if answers.len() == queries.len() {
        return Ok(answers);
    }
    Err(Error::bug(format!("resampling gave {} answers to {} queries", answers.len(), queries.len())))
}

fn single(b: [f64; 3]) -> [f32; 3] {
    b.map(|x| x as f32)
}

fn attribute(v: DVec3, w: f64) -> [f32; 4] {
    [v.x as f32, v.y as f32, v.z as f32, w as f32]
}

/// Unit normals at the vertices: the mean of the adjacent faces' normals, weighted by area; zero where that vanishes.
fn vertex_normals(mesh: &TriMesh) -> IdVec<VertexId, DVec3> {
    let mut normals = IdVec::filled(DVec3::ZERO, mesh.positions.len());
    for f in mesh.conn.faces() {
        let [a, b, c] = mesh.triangle(f);
        let twice_area = (b - a).cross(c - a);
        for v in mesh.face(f) {
            normals[v] += twice_area;
        }
    }
    normals.raw.iter_mut().for_each(|n| *n = n.normalize_or_zero());
    normals
}

/// The direction of an interpolated normal; zero where it vanishes.
fn normalised([x, y, z, _]: [f32; 4]) -> [f32; 3] {
    DVec3::new(x.into(), y.into(), z.into()).normalize_or_zero().as_vec3().into()
}
