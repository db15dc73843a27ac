//! A job of the main pipeline and its options.

use crate::map::product::NamedFile;
use crate::stage::refine::RefineOptions;
use crate::stage::relax::RelaxOptions;
use std::path::PathBuf;

/// One pair to be mapped.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MapJob {
    /// The mesh to be mapped.
    pub source: PathBuf,
    /// The mesh it is mapped onto.
    pub target: PathBuf,
    /// The landmarks of both meshes, or of the source if there is a second file.
    pub landmarks: PathBuf,
    /// The landmarks of the target, if they have a file of their own.
    pub target_landmarks: Option<PathBuf>,
    /// Closed curves that must correspond, if landmarks leave open how the map winds around handles.
    pub hint: Option<PathBuf>,
    /// The source's colour texture, if it is to be carried to the target; `<UDIM>` stands for one file per tile.
    pub texture: Option<PathBuf>,
    /// Where the results go.
    pub out: PathBuf,
}

/// What is wanted of a finished map.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Outputs {
    /// Where the results go.
    pub dir: PathBuf,
    /// The texture to be carried.
    pub texture: Option<PathBuf>,
    /// A file to be written with them, by which a later run knows them again.
    pub seal: Option<NamedFile>,
}

/// How arcs are laid out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LayoutMethod {
    /// Through the cuts between surface Voronoi cells, carried over in several orders or grown on both meshes (VORONOI).
    #[default]
    Voronoi,
    /// Along path hypotheses from a rough compatible mesh (HYPOTHESIS), so often anew from the map that comes of it.
    Hypothesis {
        /// Times that hypotheses are made, the first included.
        cycles: u32,
    },
    /// By the heuristic of Kraevoy and Sheffer; the baseline, which may fail.
    Greedy,
}

impl LayoutMethod {
    /// The name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            LayoutMethod::Voronoi => "voronoi",
            LayoutMethod::Hypothesis { .. } => "hypothesis",
            LayoutMethod::Greedy => "greedy",
        }
    }
}

/// How far the distortion is lowered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Relaxation {
    /// Not at all: the embeddings as they are, each with little stretch.
    None,
    /// Within each patch, arcs held.
    Patch,
    /// Across the arcs, which move with it.
    #[default]
    Full,
}

impl Relaxation {
    /// The name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Relaxation::None => "none",
            Relaxation::Patch => "patch",
            Relaxation::Full => "full",
        }
    }
}

/// How pairs are mapped; common to the jobs of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct MapOptions {
    /// How arcs are laid out; default: by surface Voronoi cells.
    pub layout: LayoutMethod,
    /// How far the distortion is lowered; default: across the arcs.
    pub relax: Relaxation,
    /// Rounds of relaxation go on until one lowers the energy, less that of an isometry, by less than this share.
    /// Default 0.01.
    pub tolerance: f64,
    /// Active refinement of the compatible meshes; default: none, exactly the input's vertices and faces.
    pub refine: Option<RefineOptions>,
    /// Samples along a geometry-image tile's side, a power of two plus one; 0: no images. Default 65.
    pub image: usize,
    /// All geometry images as layers of one file. Default: a file for each.
    pub layered: bool,
    /// Seed of whatever is drawn by chance. Default 0.
    pub seed: u64,
    /// `report.html` in every output folder. Default: without a command.
    pub page: Option<PageOptions>,
}

/// What `report.html` says besides the result.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PageOptions {
    /// The command as it was typed; left out if empty.
    pub command: String,
}

impl Default for MapOptions {
    fn default() -> Self {
        MapOptions {
            layout: LayoutMethod::default(),
            relax: Relaxation::default(),
            tolerance: RelaxOptions::default().tolerance,
            refine: None,
            image: 65,
            layered: false,
            seed: 0,
            page: Some(PageOptions::default()),
        }
    }
}
