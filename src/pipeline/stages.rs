//! The list of stages, in the order in which a job passes them, and the line they make.

use super::job::{MapJob, MapOptions};
use super::line::{Line, Outcome};
use super::observer::Observer;
use super::pair::Pair;
use crate::error::{Error, Result};
use crate::gpu::Device;
use crate::map::report::Report;
use crate::mesh::{TriMesh, VertexId};
use crate::stage::check::{Checked, check};
use crate::stage::cluster::cluster;
use crate::stage::layout::layout;
use crate::stage::load::{LoadOptions, load};
use crate::stage::trace::trace;
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
            .then(Stage::Embed, move |pair, _| {
                let _ = (options, &device);
                pair.then(|_, _| -> Result<()> { Err(Error::bug("the stages from embed on are not joined yet")) })
            })
            .then(Stage::Write, |_, _| Err(Error::bug("the stages from embed on are not joined yet")))
            .finish(take);
    });
}

/// Least number of nodes on an edge that arcs may cross it at (VORONOI 4.2: b = 3).
const EDGE_NODES: u32 = 3;

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
