//! Writer of morphs: a mesh with other shapes of it as morph targets, and an animation through them.
//!
//! Vertex `i` of the file is the mesh's vertex `i`. Where texture coordinates have a seam, the first coordinate of a vertex
//! stays with it, and copies for the others stand behind all vertices. Vertices that no face uses stay.
//!
//! Positions are single precision. A mesh far from the origin is therefore written around its centre, which the node's
//! translation holds. Displacements lead from the rounded positions to the other shape, so that their own rounding is all
//! that is lost there: a shape that lies far from the mesh, measured by its size, loses digits.
//!
//! Source: Khronos, "glTF 2.0 Specification", 2021, sections 3.7.2.2 (morph targets) and 3.11 (animations).

use super::chunks::Chunks;
use super::seams::{SplitVertices, split_at_seams};
use super::texture_image::TextureImage;
use crate::mesh::io::mesh_file::MeshFile;
use crate::mesh::io::normals::vertex_normals;
use crate::{Error, Result};
use glam::DVec3;
use gltf_json::animation::{Channel, Interpolation, Property, Sampler, Target};
use gltf_json::extras::{Extras, RawValue};
use gltf_json::image::MimeType;
use gltf_json::material::{PbrMetallicRoughness, StrengthFactor};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Accessor, Animation, Image, Index, Material, Mesh, Node, Scene, Texture, mesh, texture};
use std::collections::BTreeMap;

/// A mesh is written around its centre if that is farther from the origin than so many diagonals of its bounding box:
/// nearer ones lose at most one bit by their place.
const FAR: f64 = 1.0;

/// Seconds from the mesh to a target, and back again.
const SECONDS_ONE_WAY: f32 = 1.0;

/// Another shape of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MorphTarget {
    /// Its name.
    pub name: String,
    /// The places of all vertices.
    pub positions: Vec<DVec3>,
}

/// What is written.
#[derive(Clone, Copy, Debug)]
pub struct Morph<'a> {
    /// The mesh when all weights are zero.
    pub mesh: &'a MeshFile,
    /// Its name.
    pub name: &'a str,
    /// The other shapes, one at least, each with the mesh's vertices.
    pub targets: &'a [MorphTarget],
    /// The colour texture; used only if the mesh has texture coordinates.
    pub image: Option<&'a TextureImage>,
}

/// A GLB file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MorphedMesh {
    /// The bytes.
    pub bytes: Vec<u8>,
    /// Number of vertices in the file, copies along seams included.
    pub vertices: usize,
}

/// Writes one mesh with positions, normals, texture coordinates if it has some, its targets, named in `extras.targetNames`
/// and with weight 0, and an animation that moves one weight after the other from 0 to 1 and back.
///
/// Fails if a coordinate is beyond single precision, or the file beyond 4 GiB.
pub fn write_morph(morph: &Morph) -> Result<MorphedMesh> {
    let split = split_at_seams(morph.mesh);
    let shift = translation(&morph.mesh.positions);
    let mut chunks = Chunks::default();
    let image = morph.image.filter(|_| !split.uv.is_empty());
    let material = add_material(&mut chunks, image);
    let primitive = add_primitive(&mut chunks, morph, &split, written(shift), material)?;
    let mesh = chunks.root.push(Mesh {
        extensions: None,
        extras: target_names(morph.targets)?,
        name: Some(morph.name.to_owned()),
        primitives: vec![primitive],
        weights: Some(vec![0.0; morph.targets.len()]),
    });
    let is_moved = shift != [0.0; 3];
    let translation = is_moved.then_some(shift);
    let node = Node { mesh: Some(mesh), name: Some(morph.name.to_owned()), translation, ..Node::default() };
    let node = chunks.root.push(node);
    let scene = Scene { extensions: None, extras: None, name: None, nodes: vec![node] };
    chunks.root.scene = Some(chunks.root.push(scene));
    chunks.root.asset.generator = Some(concat!("homeo ", env!("CARGO_PKG_VERSION")).to_owned());
    add_animation(&mut chunks, node, morph.targets.len());
    Ok(MorphedMesh { bytes: chunks.finish()?, vertices: split.origin.len() })
}

/// Where the node stands: the centre of a mesh far from the origin, otherwise the origin.
fn translation(positions: &[DVec3]) -> [f32; 3] {
    let low = positions.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = positions.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let centre = 0.5 * low + 0.5 * high;
    if centre.length() > FAR * (high - low).length() { centre.as_vec3().to_array() } else { [0.0; 3] }
}

/// The translation as a reader in double precision takes it from the document, where it is the shortest decimal number that
/// is right in single precision.
fn written(shift: [f32; 3]) -> DVec3 {
    DVec3::from_array(shift.map(|x| x.to_string().parse().unwrap_or(f64::from(x))))
}

fn add_primitive(
    chunks: &mut Chunks,
    morph: &Morph,
    split: &SplitVertices,
    shift: DVec3,
    material: Index<Material>,
) -> Result<Primitive> {
    let mesh = morph.mesh;
    let positions = single(mesh.positions.iter().map(|&p| p - shift))?;
    let normals = single(vertex_normals(mesh, &mesh.positions).into_iter())?;
    let mut attributes = BTreeMap::from([
        (Valid(Semantic::Positions), add_positions(chunks, &split.spread(&positions))),
        (Valid(Semantic::Normals), chunks.vertex_values(&split.spread(&normals))),
    ]);
    if !split.uv.is_empty() {
        attributes.insert(Valid(Semantic::TexCoords(0)), chunks.vertex_values(&split.uv));
    }
    let mut targets = Vec::new();
    for target in morph.targets {
        let places = target.positions.iter().map(|&p| p - shift);
        let moved = displacements(&positions, places)?;
        let turned = displacements(&normals, vertex_normals(mesh, &target.positions).into_iter())?;
        targets.push(mesh::MorphTarget {
            positions: Some(add_positions(chunks, &split.spread(&moved))),
            normals: Some(chunks.vertex_values(&split.spread(&turned))),
            tangents: None,
        });
    }
    Ok(Primitive {
        attributes,
        extensions: None,
        extras: None,
        indices: Some(chunks.indices(&split.indices)),
        material: Some(material),
        mode: Valid(Mode::Triangles),
        targets: Some(targets),
    })
}

fn add_positions(chunks: &mut Chunks, rows: &[[f32; 3]]) -> Index<Accessor> {
    let accessor = chunks.vertex_values(rows);
    chunks.bound(accessor, rows);
    accessor
}

impl SplitVertices {
    /// The values of the mesh's vertices for the vertices here.
    fn spread(&self, rows: &[[f32; 3]]) -> Vec<[f32; 3]> {
        self.origin.iter().map(|&v| rows[v as usize]).collect()
    }
}

/// Rounds to single precision.
fn single(rows: impl Iterator<Item = DVec3>) -> Result<Vec<[f32; 3]>> {
    let rounded = |(i, p): (usize, DVec3)| {
        let p = p.as_vec3();
        let too_large = || {
            Error::input("a coordinate is too large for the single precision of glTF")
                .at(format_args!("vertex {i}"))
                .remedy("scale the mesh down")
        };
        if p.is_finite() { Ok(p.to_array()) } else { Err(too_large()) }
    };
    rows.enumerate().map(rounded).collect()
}

/// From the rounded values to others.
fn displacements(from: &[[f32; 3]], to: impl Iterator<Item = DVec3>) -> Result<Vec<[f32; 3]>> {
    single(from.iter().zip(to).map(|(&a, b)| b - DVec3::from_array(a.map(f64::from))))
}

fn target_names(targets: &[MorphTarget]) -> Result<Extras> {
    let names: Vec<&str> = targets.iter().map(|t| t.name.as_str()).collect();
    let text = serde_json::json!({ "targetNames": names }).to_string();
    let extras = RawValue::from_string(text).map_err(|e| Error::bug(format!("names that are no JSON: {e}")))?;
    Ok(Some(extras))
}

/// Appends a matte material seen from both sides, white or with the image.
fn add_material(chunks: &mut Chunks, image: Option<&TextureImage>) -> Index<Material> {
    let texture = image.map(|image| add_texture(chunks, image));
    let info = |index| texture::Info { index, tex_coord: 0, extensions: None, extras: None };
    chunks.root.push(Material {
        double_sided: true,
        pbr_metallic_roughness: PbrMetallicRoughness {
            base_color_texture: texture.map(info),
            metallic_factor: StrengthFactor(0.0),
            ..PbrMetallicRoughness::default()
        },
        ..Material::default()
    })
}

fn add_texture(chunks: &mut Chunks, image: &TextureImage) -> Index<Texture> {
    let view = chunks.view(image.bytes().iter().copied(), None);
    let image = chunks.root.push(Image {
        buffer_view: Some(view),
        mime_type: Some(MimeType(image.mime_type().to_owned())),
        name: None,
        uri: None,
        extensions: None,
        extras: None,
    });
    let texture = Texture { name: None, sampler: None, source: image, extensions: None, extras: None };
    // `Root` has no `push` for textures.
    Index::push(&mut chunks.root.textures, texture)
}

/// Appends the animation: at every even step all weights are 0, at every odd one that of one target is 1.
fn add_animation(chunks: &mut Chunks, node: Index<Node>, targets: usize) {
    let times: Vec<f32> = (0..=2 * targets).map(|step| step as f32 * SECONDS_ONE_WAY).collect();
    let weight = |step: usize, target: usize| if step == 2 * target + 1 { 1.0 } else { 0.0 };
    let weights: Vec<f32> = (0..times.len()).flat_map(|step| (0..targets).map(move |t| weight(step, t))).collect();
    let input = chunks.values(&times);
    chunks.bound(input, &times.iter().map(|&t| [t]).collect::<Vec<_>>());
    let output = chunks.values(&weights);
    let interpolation = Valid(Interpolation::Linear);
    let target = Target { extensions: None, extras: None, node, path: Valid(Property::MorphTargetWeights) };
    chunks.root.push(Animation {
        extensions: None,
        extras: None,
        channels: vec![Channel { sampler: Index::new(0), target, extensions: None, extras: None }],
        name: Some("morph".to_owned()),
        samplers: vec![Sampler { extensions: None, extras: None, input, interpolation, output }],
    });
}
