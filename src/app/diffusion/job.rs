//! `homeo diffuse` as a job: files in, a folder out.

use super::picture::Cells;
use super::report::{ParametrizedMesh, remarks};
use super::segment::{VARIANTS, segment_variant};
use super::through::regions_through;
use super::{Correspondence, Diffusion, DiffusionOptions, DiffusionReport, Ends, Output};
use super::{carry::by_triangle, carry_image, correspond, diffuse, diffuse_like, in_order_of, split_ends, write};
use crate::app::attributes::require_uv;
use crate::app::canvas::Padding;
use crate::app::finished_map::{FinishedMap, read_finished_map};
use crate::app::texture::Textures;
use crate::app::transfer::{TransferOptions, TransferReport};
use crate::app::udim::file_of;
use crate::app::uv::UvTriangles;
use crate::error::{Error, Result};
use crate::gpu::Compute;
use crate::mesh::TriMesh;
use crate::mesh::io::{MeshFile, Regions, read_mesh, read_regions};
use crate::path::side_front::Travel;
use crate::picture::{Depth, Picture};
use crate::stage::check::{LoadedMesh, inspect};
use crate::stage::write::check_place;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Where regions come from.
#[derive(Clone, Debug)]
pub enum RegionSource {
    /// A file.
    File(PathBuf),
    /// So many are made.
    Segment(usize),
}

/// The second mesh.
#[derive(Clone, Debug)]
pub enum Onto {
    /// A mesh and its regions.
    Regions {
        /// The mesh.
        mesh: PathBuf,
        /// The region file.
        regions: PathBuf,
    },
    /// The target of a finished map, with regions carried through it.
    Map(PathBuf),
}

/// An image to be carried over.
#[derive(Clone, Debug)]
pub struct TextureJob {
    /// The first mesh's image.
    pub image: PathBuf,
    /// Texels along a side; none for the size of the image.
    pub size: Option<usize>,
    /// How far gutters are filled.
    pub padding: Padding,
}

/// What to do.
#[derive(Clone, Debug)]
pub struct DiffuseJob {
    /// The mesh.
    pub mesh: PathBuf,
    /// Its regions.
    pub regions: RegionSource,
    /// Whether limbs are divided lengthwise.
    pub split_ends: bool,
    /// How to parametrize.
    pub options: DiffusionOptions,
    /// The second mesh, if there is one.
    pub onto: Option<Onto>,
    /// An image to be carried to it.
    pub texture: Option<TextureJob>,
    /// The folder for the results.
    pub out: PathBuf,
    /// The command as it was typed, for `report.html`; none if no page is wanted.
    pub command: Option<String>,
}

/// Runs the job; `compute` opens the device, if an image is carried.
///
/// # Errors
/// Those of reading, checking, parametrizing, matching and writing; the folder then is as it was before.
pub fn run(job: &DiffuseJob, compute: &dyn Fn() -> Result<Compute>) -> Result<DiffusionReport> {
    check_place(&job.out)?;
    if job.texture.is_some() && job.onto.is_none() {
        return Err(Error::usage("there is no second mesh to carry the image to").remedy("give --onto or --onto-map"));
    }
    let mut clock = Clock::start();
    let loaded = inspect(read_mesh(&job.mesh)?)?;
    let second = job.onto.as_ref().map(|onto| Second::load(onto, &loaded)).transpose()?;
    clock.lap("load");
    let (first, onto) = parametrized(job, &loaded, second.as_ref())?;
    clock.lap("diffuse");
    let maps = onto.as_ref().map(|onto| [correspond(&first, onto), correspond(onto, &first)]);
    let pair = onto.as_ref().zip(second.as_ref().map(|other| &other.loaded.file));
    let mut images = Vec::new();
    let mut texture = None;
    if let (Some(job), Some((onto, file))) = (&job.texture, pair) {
        texture = Some(carried(job, [(&first, &loaded.file), (onto, file)], &compute()?, &mut images)?);
    }
    clock.lap("correspond");
    let in_atlas = texture.is_some() && pair.is_some_and(|(_, file)| file.uv.values.is_empty());
    let mesh = (&loaded.file, &first);
    let onto = pair.map(|(onto, file)| (file, onto));
    let output = Output { mesh, onto, maps: maps.as_ref(), images: &images, in_atlas };
    write(&output, &job.out, job.command.as_deref(), || {
        clock.lap("draw");
        report(job, &output, texture, clock.finish())
    })
}

/// Seconds by step.
struct Clock {
    start: Instant,
    last: Instant,
    seconds: BTreeMap<&'static str, f64>,
}

impl Clock {
    fn start() -> Self {
        let now = Instant::now();
        Clock { start: now, last: now, seconds: BTreeMap::new() }
    }

    fn lap(&mut self, name: &'static str) {
        self.seconds.insert(name, self.last.elapsed().as_secs_f64());
        self.last = Instant::now();
    }

    fn finish(mut self) -> BTreeMap<&'static str, f64> {
        self.seconds.insert("total", self.start.elapsed().as_secs_f64());
        self.seconds
    }
}

/// The second mesh, and where its regions come from.
struct Second {
    loaded: LoadedMesh,
    regions: SecondRegions,
}

enum SecondRegions {
    Read(Regions),
    Through(Box<FinishedMap>, PathBuf),
}

impl Second {
    fn load(onto: &Onto, first: &LoadedMesh) -> Result<Self> {
        match onto {
            Onto::Regions { mesh, regions } => {
                let loaded = inspect(read_mesh(mesh)?)?;
                let regions = SecondRegions::Read(read_regions(regions, &loaded.file)?);
                Ok(Second { loaded, regions })
            }
            Onto::Map(dir) => {
                let map = read_finished_map(dir, [Some(&first.file.path), None])?;
                let loaded = inspect(map.meshes[1].clone())?;
                Ok(Second { loaded, regions: SecondRegions::Through(Box::new(map), dir.clone()) })
            }
        }
    }

    /// The regions that correspond to those of the first mesh.
    fn regions(&self, first: &Regions) -> Regions {
        match &self.regions {
            SecondRegions::Read(regions) => regions.clone(),
            SecondRegions::Through(map, dir) => Regions { path: dir.clone(), ..regions_through(map, first) },
        }
    }
}

/// Both meshes with (u, v). Regions that are made, and do not fit on the second mesh (where borders are short, a map can let
/// other regions touch), are made anew around other points, as long as there are some.
fn parametrized<'m>(
    job: &DiffuseJob,
    loaded: &'m LoadedMesh,
    second: Option<&'m Second>,
) -> Result<(Diffusion<'m>, Option<Diffusion<'m>>)> {
    let count = match &job.regions {
        RegionSource::File(path) => return both(job, loaded, read_regions(path, &loaded.file)?, second),
        RegionSource::Segment(count) => *count,
    };
    let attempt = |variant: usize| {
        let regions = segment_variant(&loaded.mesh, count, variant).map_err(|e| e.file(&job.mesh))?;
        both(job, loaded, Regions { path: job.mesh.clone(), ..regions }, second)
    };
    let first = attempt(0);
    if first.is_ok() || !second.is_some_and(|s| matches!(s.regions, SecondRegions::Through(..))) {
        return first;
    }
    (1..VARIANTS).map(attempt).find(Result::is_ok).unwrap_or(first)
}

/// Both meshes with (u, v), given the regions of the first.
fn both<'m>(
    job: &DiffuseJob,
    loaded: &'m LoadedMesh,
    regions: Regions,
    second: Option<&'m Second>,
) -> Result<(Diffusion<'m>, Option<Diffusion<'m>>)> {
    let halved = |mesh: &TriMesh, regions: &Regions, like: Option<&Ends>| match job.split_ends {
        true => split_ends(mesh, regions, like),
        false => (regions.clone(), Ends::new()),
    };
    let (own, ends) = halved(&loaded.mesh, &regions, None);
    let first = diffuse(&loaded.mesh, own, job.options)?;
    let Some(second) = second else { return Ok((first, None)) };
    let mesh = &second.loaded.mesh;
    let (regions, _) = halved(mesh, &in_order_of(&regions, second.regions(&regions)), Some(&ends));
    let onto = diffuse_like(&first, mesh, regions, job.options)?;
    Ok((first, Some(onto)))
}

/// Carries the image into the second mesh's texture coordinates, or into an atlas of its regions.
fn carried(
    job: &TextureJob,
    pair: [(&Diffusion, &MeshFile); 2],
    compute: &Compute,
    images: &mut Vec<(String, Picture)>,
) -> Result<TransferReport> {
    require_uv(pair[0].1)?;
    let textures = Textures::read(&job.image, &UvTriangles::of(pair[0].1), false)?;
    let (onto, file) = pair[1];
    let uv = if file.uv.values.is_empty() { in_atlas(onto, file) } else { UvTriangles::of(file) };
    let extension = if textures.depth() == Depth::Float { "exr" } else { "png" };
    let several = uv.tiles().len() > 1;
    let name = format!("target_texture{}.{extension}", if several { ".<UDIM>" } else { "" });
    let options = TransferOptions { size: job.size, padding: job.padding, normal_map: false };
    let report = carry_image(compute, pair, &textures, &uv, &options, |tile, picture| {
        images.push((file_of(Path::new(&name), tile)?.display().to_string(), picture));
        Ok(())
    })?;
    Ok(TransferReport { files: images.iter().map(|(name, _)| PathBuf::from(name)).collect(), ..report })
}

fn in_atlas(diffusion: &Diffusion, file: &MeshFile) -> UvTriangles {
    let cells = Cells::new(diffusion.pieces.len());
    let places = by_triangle(diffusion, &file.triangles()).into_iter();
    let corners = places.map(|(r, uv)| uv.map(|uv| cells.place(r, uv))).collect();
    UvTriangles { corners, missing: Vec::new(), flipped: Vec::new() }
}

fn report(
    job: &DiffuseJob,
    output: &Output,
    texture: Option<TransferReport>,
    seconds: BTreeMap<&'static str, f64>,
) -> DiffusionReport {
    let described = |(file, diffusion): (&MeshFile, &Diffusion)| {
        (
            ParametrizedMesh::new(diffusion, file),
            remarks(diffusion, &file.path.display().to_string(), job.options.repair),
        )
    };
    let (mesh, mut warnings) = described(output.mesh);
    let onto = output.onto.map(|onto| {
        let (mesh, more) = described(onto);
        warnings.extend(more);
        mesh
    });
    let distortion = |k: usize| output.maps.map(|maps: &[Correspondence; 2]| maps[k].distortion);
    DiffusionReport {
        version: env!("CARGO_PKG_VERSION"),
        front: if job.options.travel == Travel::Faces { "face" } else { "edge" },
        mesh,
        onto,
        distortion: distortion(0),
        distortion_target_on_source: distortion(1),
        texture,
        seconds,
        warnings,
    }
}
