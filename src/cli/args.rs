//! What was typed.

use super::batch::args::BatchArgs;
use crate::app::canvas::Padding;
use crate::mesh::VertexId;
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// Certified bijective, low-distortion maps between triangle meshes.
#[derive(Debug, Parser)]
#[command(name = "homeo", version, about, after_help = EXIT_CODES, propagate_version = true)]
pub struct Cli {
    #[command(flatten)]
    pub global: Global,
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_CODES: &str = "Exit codes: 0 done, 1 internal error, 2 wrong usage, 3 bad input, \
4 well-formed but unsolvable, 5 no usable device where one was required, 6 batch finished with failed jobs.";

#[derive(Args, Debug)]
pub struct Global {
    /// Compute device: auto (a hardware GPU if there is one, otherwise the CPU), cpu, gpu, or part of an adapter's name
    #[arg(long, global = true, default_value = "auto", value_name = "auto|cpu|gpu|NAME")]
    pub device: String,
    /// Do not write report.html, the page that shows a result, and the preview of a map
    #[arg(long, global = true)]
    pub no_report: bool,
    /// Threads for the CPU stages; default: one per core
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
    /// Seed of whatever is drawn by chance; results are the same for the same seed
    #[arg(long, global = true, default_value_t = 0, value_name = "N")]
    pub seed: u64,
    /// Say nothing but errors
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Say more
    #[arg(short, long, global = true)]
    pub verbose: bool,
    /// Machine-readable result on stdout
    #[arg(long, global = true)]
    pub json: bool,
    /// Colours; auto: on a terminal, unless NO_COLOR is set
    #[arg(long, global = true, default_value = "auto", value_name = "WHEN")]
    pub color: ColorChoice,
    /// Progress on stderr; auto: bars on a terminal, nothing otherwise
    #[arg(long, global = true, default_value = "auto", value_name = "HOW")]
    pub progress: ProgressChoice,
    /// The command as it was typed.
    #[arg(skip)]
    pub command: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ColorChoice {
    Auto,
    Always,
    Never,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ProgressChoice {
    /// Bars on a terminal, nothing otherwise
    Auto,
    /// One JSON line per step
    Jsonl,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Map generated pairs and show a summary
    Demo(DemoArgs),
    /// Map one mesh onto another, guided by landmarks
    Map(MapArgs),
    /// Say what is wrong with meshes, element by element
    Check(CheckArgs),
    /// Measure the distortion of a compatible mesh
    Measure(MeasureArgs),
    /// Write finished maps as morph targets of one GLB file
    Morph(MorphArgs),
    /// List compute adapters and which one `auto` takes
    Devices,
    /// Texture coordinates that put vertices exactly where you want them on an image, without a fold
    Texture(TextureArgs),
    /// Parametrize regions by pairs of fronts, and map them onto the same regions of another mesh
    Diffuse(DiffuseArgs),
    /// Bake a map of a mesh into its own texture coordinates, or read a geometry image back as a mesh
    Bake(BakeArgs),
    /// Carry an image of the source through a finished map to the target
    Transfer(TransferArgs),
    /// Map many pairs from a manifest: streamed, resumable, in shards
    Batch(Box<BatchArgs>),
}

#[derive(Args, Debug)]
pub struct DemoArgs {
    /// Folder for the generated pairs and their maps
    #[arg(default_value = "homeo-demo")]
    pub dir: PathBuf,
}

#[derive(Args, Debug)]
pub struct MapArgs {
    /// The mesh to be mapped: OBJ, OFF, PLY, STL or glTF
    pub source: PathBuf,
    /// The mesh it is mapped onto
    pub target: PathBuf,
    /// CSV `name,source_vertex,target_vertex` (0-based) or `name,sx,sy,sz,tx,ty,tz`; or a file of source points
    #[arg(long, value_name = "FILE")]
    pub landmarks: PathBuf,
    /// File of target points, matched with those of the source by name or order
    #[arg(long, value_name = "FILE")]
    pub target_landmarks: Option<PathBuf>,
    /// JSON `{"loops": [{"name": "handle", "source": [vertices], "target": [vertices]}]}`: closed curves that must
    /// correspond, where landmarks leave open how the map winds around handles; listed in one direction on both meshes
    #[arg(long, value_name = "FILE")]
    pub hint: Option<PathBuf>,
    /// Folder for the results; appears complete or not at all
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// The source's colour texture, carried to the target; <UDIM> in its name stands for one file per tile
    #[arg(long, value_name = "IMAGE")]
    pub texture: Option<PathBuf>,
    #[command(flatten)]
    pub options: MapFlags,
}

#[derive(Args, Debug)]
pub struct MapFlags {
    /// How arcs are laid out: voronoi, hypothesis (along guesses from a rough map), or greedy, the baseline, which may fail
    #[arg(long, default_value = "voronoi", value_name = "METHOD")]
    pub layout: LayoutChoice,
    /// With --layout hypothesis: how often guesses are made, from the second time on from the map so far
    #[arg(long, default_value = "1", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=16))]
    pub cycles: u32,
    /// Refinement of the compatible meshes: none, or active: vertices are appended where they miss the other surface
    #[arg(long, default_value = "none", value_name = "METHOD")]
    pub refine: RefineChoice,
    /// With --refine active: errors above the third quartile by this many quartile distances mark features
    #[arg(long, default_value = "1.5", value_name = "X", value_parser = not_negative)]
    pub refine_whisker: f64,
    /// With --refine active: how near a salient vertex's sphere others count as met, as a share of the diagonal
    #[arg(long, default_value = "1e-4", value_name = "SHARE", value_parser = not_negative)]
    pub refine_salience: f64,
    /// With --refine active: most vertices to append, as a share of those there are
    #[arg(long, default_value = "0.05", value_name = "SHARE", value_parser = not_negative)]
    pub refine_most: f64,
    /// Relaxation of the map: none, within each patch, or full: across patches, arcs moving with it
    #[arg(long, default_value = "full", value_name = "METHOD")]
    pub relax: RelaxChoice,
    /// Relaxation ends when a round lowers the energy, less that of an isometry, by less than this share; 0 runs all rounds
    #[arg(long, default_value = "0.01", value_name = "SHARE", value_parser = share)]
    pub tolerance: f64,
    /// Samples along a geometry-image tile's side, a power of two plus one; 0: no images
    #[arg(long, default_value = "65", value_name = "N", value_parser = image_size)]
    pub image: usize,
    /// The geometry images as layers of one EXR instead of one file per map
    #[arg(long)]
    pub layered: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LayoutChoice {
    Voronoi,
    Hypothesis,
    Greedy,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RefineChoice {
    None,
    Active,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum RelaxChoice {
    None,
    Patch,
    Full,
}

#[derive(Args, Debug)]
pub struct BakeArgs {
    /// A mesh with texture coordinates
    #[arg(required_unless_present = "rebuild", conflicts_with_all = ["rebuild", "layer"])]
    pub mesh: Option<PathBuf>,
    /// A geometry image of a finished map to be read back as a mesh: source_position.exr, target_position.exr or
    /// geometry.exr
    #[arg(long, value_name = "IMAGE", conflicts_with_all = ["size", "map", "padding", "compression"])]
    pub rebuild: Option<PathBuf>,
    /// With --rebuild of geometry.exr: which mesh; default: source
    #[arg(long, value_name = "source|target")]
    pub layer: Option<LayerChoice>,
    /// The EXR file; <UDIM> in its name stands for one file per tile. The mask comes beside it as FILE_mask. With
    /// --rebuild the OBJ file
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Texels along a side, up to 16384
    #[arg(long, default_value = "1024", value_name = "N")]
    pub size: usize,
    /// What to bake
    #[arg(long, default_value = "position", value_name = "MAP")]
    pub map: MapChoice,
    /// Texels to fill around what triangles cover: a number or `infinite`
    #[arg(long, default_value = "16", value_name = "N|infinite", value_parser = padding)]
    pub padding: Padding,
    /// How the EXR files are compressed; none is the fastest to write
    #[arg(long, default_value = "zip", value_name = "none|rle|zip|piz")]
    pub compression: CompressionChoice,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CompressionChoice {
    None,
    Rle,
    Zip,
    Piz,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LayerChoice {
    Source,
    Target,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MapChoice {
    /// Positions in the mesh's units
    Position,
    /// Unit normals in object space
    Normal,
    /// Unit tangents along increasing u
    Tangent,
    /// Mean curvature, positive where convex
    Curvature,
    /// L2 stretch from texture space to the surface, 1 where there is none
    Distortion,
}

#[derive(Args, Debug)]
pub struct TransferArgs {
    /// Folder of a finished map
    pub dir: PathBuf,
    /// The source's image: PNG, JPEG or EXR; <UDIM> in its name stands for one file per tile
    #[arg(long, value_name = "IMAGE", required_unless_present = "attribute", conflicts_with = "attribute")]
    pub texture: Option<PathBuf>,
    /// Numbers by vertex of the source, such as colours or skin weights: a CSV table with a row of names, or a PLY file
    #[arg(long, value_name = "FILE")]
    pub attribute: Option<PathBuf>,
    /// The target's image, <UDIM> in its name stands for one file per tile; or with --attribute its CSV table
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Texels along a side; default: as the source's image
    #[arg(long, value_name = "N")]
    pub size: Option<usize>,
    /// Texels to fill around what triangles cover: a number or `infinite`
    #[arg(long, default_value = "16", value_name = "N|infinite", value_parser = padding)]
    pub padding: Padding,
    /// The image holds normals in the source's tangent frames (OpenGL style): turn them into the target's
    #[arg(long)]
    pub normal_map: bool,
    /// The image holds data, not colours: eight-bit values are not decoded from sRGB
    #[arg(long)]
    pub linear: bool,
    /// Where the source is now, if not where it was mapped
    #[arg(long, value_name = "FILE")]
    pub source: Option<PathBuf>,
    /// Where the target is now, if not where it was mapped
    #[arg(long, value_name = "FILE")]
    pub target: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub struct DiffuseArgs {
    /// The mesh
    pub mesh: PathBuf,
    /// Its regions: JSON `{"regions": [{"name": "torso", "faces": [faces], "sides": {"u0": [vertices], "u1": [], "v0": [],
    /// "v1": []}}]}` (sides may be left out), CSV `face,region`, or an OBJ file with materials, groups or objects; `materials`,
    /// `groups` or `objects` for those of MESH itself. Faces and vertices are counted from 0
    #[arg(long, value_name = "FILE", required_unless_present = "segment", conflicts_with = "segment")]
    pub regions: Option<PathBuf>,
    /// Make N regions instead, around points as far apart as can be
    #[arg(long, value_name = "N")]
    pub segment: Option<usize>,
    /// Divide the ends of limbs (regions with one neighbour all around) and tubes (regions with two borders) in halves
    #[arg(long)]
    pub split_ends: bool,
    /// How fronts move: across faces, or along edges as in the paper
    #[arg(long, default_value = "face", value_name = "HOW")]
    pub front: FrontChoice,
    /// Embed regions anew, without folds, where fronts fold them
    #[arg(long)]
    pub repair: bool,
    /// A second mesh with the same regions, to be mapped onto
    #[arg(long, value_name = "MESH2", requires = "onto_regions", conflicts_with = "onto_map")]
    pub onto: Option<PathBuf>,
    /// Its regions
    #[arg(long, value_name = "FILE2", requires = "onto")]
    pub onto_regions: Option<PathBuf>,
    /// Or the folder of a finished map of MESH: its target is the second mesh, and gets the same regions through the map
    #[arg(long, value_name = "DIR")]
    pub onto_map: Option<PathBuf>,
    /// An image in the texture coordinates of MESH, to be carried to the second mesh
    #[arg(long, value_name = "IMAGE")]
    pub texture: Option<PathBuf>,
    /// Texels along a side of the second mesh's image; default: as the first one's
    #[arg(long, value_name = "N", requires = "texture")]
    pub size: Option<usize>,
    /// Texels to fill around what triangles cover: a number or `infinite`
    #[arg(long, default_value = "16", value_name = "N|infinite", value_parser = padding)]
    pub padding: Padding,
    /// Folder for the results; appears complete or not at all
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FrontChoice {
    Edge,
    Face,
}

#[derive(Args, Debug)]
pub struct CheckArgs {
    /// Mesh files
    #[arg(required = true)]
    pub meshes: Vec<PathBuf>,
    /// Landmarks to be checked against the first mesh as source and the second as target
    #[arg(long, value_name = "FILE")]
    pub landmarks: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub struct MeasureArgs {
    /// The mesh before the map
    pub source: PathBuf,
    /// The same vertices and faces at the positions after the map
    pub compatible: PathBuf,
}

#[derive(Args, Debug)]
pub struct TextureArgs {
    /// A disc-like mesh: OBJ, OFF, PLY, STL or glTF. A closed one is cut open, further boundary loops are bridged
    pub mesh: PathBuf,
    /// The image: PNG, JPEG or EXR
    pub image: PathBuf,
    /// CSV `vertex,u,v` (0-based; 0 < u, v < 1, v up), with a column `name` if you like
    #[arg(long, value_name = "FILE")]
    pub constraints: PathBuf,
    /// Folder for the results; appears complete or not at all
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Vertices along which a closed mesh is cut open, in order, as in 4,17,2; default: a way far from the constraints
    #[arg(long, value_name = "V,V,...", value_delimiter = ',', value_parser = vertex)]
    pub seam: Option<Vec<VertexId>>,
}

#[derive(Args, Debug)]
pub struct MorphArgs {
    /// Folders that `homeo map` wrote, all from one source; each target's shape becomes a morph target
    #[arg(required = true, value_name = "DIR")]
    pub maps: Vec<PathBuf>,
    /// The GLB file; appears complete or not at all
    #[arg(long, value_name = "FILE.glb", required_unless_present = "gif")]
    pub out: Option<PathBuf>,
    /// A moving picture: from the source to each target and back, without end
    #[arg(long, value_name = "FILE.gif")]
    pub gif: Option<PathBuf>,
    /// Also write N steps from the source to each target beside FILE, as FILE_000.obj and so on
    #[arg(long, value_name = "N", requires = "out", value_parser = clap::value_parser!(u32).range(2..))]
    pub frames: Option<u32>,
    /// A PNG or JPEG file to embed as colour texture; default: the one that the source's materials name
    #[arg(long, value_name = "IMAGE")]
    pub texture: Option<PathBuf>,
    /// Where the source is now, if not where it was mapped
    #[arg(long, value_name = "FILE")]
    pub source: Option<PathBuf>,
}

/// The largest side of a geometry-image tile: 2^12 + 1, a gigabyte and a half for a single tile's three channels with
/// both meshes and their normals.
const LARGEST_IMAGE: usize = (1 << 12) + 1;

fn vertex(text: &str) -> Result<VertexId, String> {
    text.trim().parse().map(VertexId).map_err(|_| "use vertex numbers, counted from 0".to_owned())
}

fn padding(text: &str) -> Result<Padding, String> {
    match text {
        "infinite" => Ok(Padding::Infinite),
        _ => text.parse().map(Padding::Texels).map_err(|_| "use a number of texels or `infinite`".to_owned()),
    }
}

fn share(text: &str) -> Result<f64, String> {
    let x: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if (0.0..1.0).contains(&x) { Ok(x) } else { Err("use a share from 0 to below 1, such as 0.05".to_owned()) }
}

fn not_negative(text: &str) -> Result<f64, String> {
    let x: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if x >= 0.0 && x.is_finite() { Ok(x) } else { Err("use a number that is not negative".to_owned()) }
}

fn image_size(text: &str) -> Result<usize, String> {
    let n: usize = text.parse().map_err(|_| "not a number".to_owned())?;
    let is_power_plus_one = n >= 2 && (n - 1).is_power_of_two() && n <= LARGEST_IMAGE;
    if n == 0 || is_power_plus_one {
        Ok(n)
    } else {
        Err(format!("use 0 or a power of two plus one up to {LARGEST_IMAGE}: 33, 65, 129, ..."))
    }
}
