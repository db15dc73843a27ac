//! The list of stages, in the order in which a job passes them, and the line they make.

use super::images::geometry_images;
use super::job::{MapJob, MapOptions};
use super::line::{Line, Outcome};
use super::observer::Observer;
use super::pair::Pair;
use crate::gpu::{Compute, Device};
use crate::map::embedding::Embedding;
use crate::map::product::{GeometryImages, Product, Side};
use crate::map::report::{LayoutSummary, Report};
use crate::mesh::{TriMesh, VertexId};
use crate::stage::check::{Checked, LoadedMesh, check};
use crate::stage::cluster::cluster;
use crate::stage::compose::{Composed, compose};
use crate::stage::embed::embed;
use crate::stage::layout::{Layout, layout};
use crate::stage::load::{LoadOptions, load};
use crate::stage::trace::trace;
use crate::stage::write::write;
use std::thread;

/// Maps pairs: every job passes all stages; `take` gets the outcomes in the order of the jobs.
///
/// Several jobs are in flight at once, each in a stage of its own. The device belongs to the thread of one stage.
pub fn run_maps(
    jobs: Vec<MapJob>,
    options: &MapOptions,
    device: Device,
    observer: &dyn Observer,
    take: impl FnMut(Outcome<Report>),
) {
    let device_line = device_line(&device);
    let compute = &device.compute;
    thread::scope(|scope| {
        Line::start(scope, observer, jobs)
            .then(Stage::Load, |job: MapJob, step| {
                let loaded = load(LoadOptions {
                    source: job.source,
                    target: job.target,
                    landmarks: job.landmarks,
                    target_landmarks: job.target_landmarks,
                })?;
                step.detail(format!(
                    "{} and {} vertices, {} landmarks",
                    loaded.source.positions.len(),
                    loaded.target.positions.len(),
                    loaded.landmarks.names.len()
                ));
                Ok((job.out, loaded))
            })
            .then(Stage::Check, |(out, loaded), _| Ok(Pair { out, checked: check(loaded)?, made: () }))
            .then(Stage::Cluster, |pair, step| {
                pair.then(|checked, ()| {
                    let clusters = cluster(meshes(checked), landmarks(checked));
                    step.detail(format!("{} and {} cuts", clusters[0].cuts.len(), clusters[1].cuts.len()));
                    Ok(clusters)
                })
            })
            .then(Stage::Trace, |pair, step| {
                pair.then(|checked, [source_clusters, target_clusters]| {
                    let [source, _] = meshes(checked);
                    let [source_landmarks, target_landmarks] = landmarks(checked);
                    let traced = trace(source, source_landmarks, &source_clusters, EDGE_NODES)?;
                    let layout = layout(meshes(checked), target_landmarks, traced, &target_clusters, EDGE_NODES)?;
                    step.detail(format!("{} arcs, {} patches", layout.base.arcs.len(), layout.base.patches.len()));
                    Ok(layout)
                })
            })
            .then(Stage::Embed, |pair, _| {
                pair.then(|checked, layout| {
                    let summary = summary(&layout);
                    let (embedding, notes) = embed(meshes(checked), layout)?;
                    Ok(Embedded { summary, embedding, notes })
                })
            })
            .then(Stage::Compose, |pair, step| {
                pair.then(|checked, Embedded { summary, embedding, notes }| {
                    let composed = compose(meshes(checked), embedding)?;
                    step.detail(format!("certified: {}", composed.certificate.bijective));
                    Ok(Finished { summary, composed, notes, images: None })
                })
            })
            .then(Stage::Bake, |pair, step| {
                pair.then(|checked, finished| {
                    let images = geometry_images(compute, meshes(checked), &finished.composed, options.image)?;
                    step.detail(format!("{} images", images.as_ref().map_or(0, |i| i.files.len())));
                    Ok(Finished { images, ..finished })
                })
            })
            .then(Stage::Write, |pair, step| write(&product(&pair, &device_line), &pair.out, || step.seconds()))
            .finish(take);
    });
}

/// Least number of nodes on an edge that arcs may cross it at (VORONOI 4.2: b = 3).
const EDGE_NODES: u32 = 3;

/// The product of the embed stage.
struct Embedded {
    summary: LayoutSummary,
    embedding: Embedding,
    notes: Vec<String>,
}

/// The product of the last stages before writing.
struct Finished {
    summary: LayoutSummary,
    composed: Composed,
    notes: Vec<String>,
    images: Option<GeometryImages>,
}

fn summary(layout: &Layout) -> LayoutSummary {
    LayoutSummary {
        kind: "voronoi",
        arcs: layout.base.arcs.len(),
        patches: layout.base.patches.len(),
        postponed: layout.postponed,
        flips: 0,
    }
}

/// What is written, by reference.
fn product<'a>(pair: &'a Pair<Finished>, device: &'a str) -> Product<'a> {
    let Pair { checked, made, .. } = pair;
    let side = |k: usize, mesh: &'a LoadedMesh| Side {
        file: &mesh.file,
        mesh: &mesh.mesh,
        arcs: &made.composed.arcs[k],
        image: &made.composed.maps[k].images,
    };
    Product {
        source: side(0, &checked.source),
        target: side(1, &checked.target),
        landmarks: &checked.landmarks,
        base: &made.composed.embedding.base,
        layout: made.summary.clone(),
        certificate: made.composed.certificate,
        images: made.images.as_ref(),
        device,
        warnings: checked.warnings.iter().chain(&made.notes).cloned().collect(),
    }
}

/// The device in the report; without the number of threads, on which no result depends.
fn device_line(device: &Device) -> String {
    let name = match device.compute {
        Compute::Cpu => "CPU",
        Compute::Gpu(_) => &device.description,
    };
    device.note.as_ref().map_or(name.to_owned(), |note| format!("{name}; {note}"))
}

fn meshes(checked: &Checked) -> [&TriMesh; 2] {
    [&checked.source.mesh, &checked.target.mesh]
}

fn landmarks(checked: &Checked) -> [&[VertexId]; 2] {
    [&checked.landmarks.source, &checked.landmarks.target]
}

/// A stage of the main job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Reads both meshes and the landmarks.
    Load,
    /// Turns them into manifolds or says what is wrong.
    Check,
    /// Grows the landmarks' surface Voronoi cells.
    Cluster,
    /// Traces the arcs of the layout on both meshes.
    Trace,
    /// Embeds every patch into its base triangle.
    Embed,
    /// Lowers the distortion; owns the compute device.
    Relax,
    /// Joins the embeddings into the map and certifies it.
    Compose,
    /// Samples the common atlas.
    Bake,
    /// Writes the output folder.
    Write,
}

impl Stage {
    /// All stages in order.
    pub const ALL: [Stage; 9] = [
        Stage::Load,
        Stage::Check,
        Stage::Cluster,
        Stage::Trace,
        Stage::Embed,
        Stage::Relax,
        Stage::Compose,
        Stage::Bake,
        Stage::Write,
    ];

    /// The stage's name in reports, logs and benches.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Load => "load",
            Stage::Check => "check",
            Stage::Cluster => "cluster",
            Stage::Trace => "trace",
            Stage::Embed => "embed",
            Stage::Relax => "relax",
            Stage::Compose => "compose",
            Stage::Bake => "bake",
            Stage::Write => "write",
        }
    }
}
