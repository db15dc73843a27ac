//! The list of stages, in the order in which a job passes them, and the line they make.

use super::flow::Flow;
use super::footprint::footprint;
use super::job::{MapJob, MapOptions, Outputs};
use super::line::{JobId, Line, Outcome};
use super::observer::Observer;
use super::pair::Pair;
use super::steps::{self, Finished, Mapped};
use super::templates::Templates;
use crate::gpu::{Compute, Device};
use crate::map::product::NamedFile;
use crate::map::report::Report;
use crate::stage::load::Loaded;
use std::thread;

/// Maps pairs: every job passes all stages; `take` gets the outcomes as they come, not in the order of the jobs.
///
/// Several jobs are in flight at once; what becomes of one does not depend on the others.
pub fn run_maps(
    jobs: Vec<MapJob>,
    options: &MapOptions,
    device: &Device,
    observer: &dyn Observer,
    take: impl FnMut(Outcome<Report>),
) {
    let jobs = jobs.into_iter().enumerate().map(|(i, job)| (JobId(i), job, None));
    stream_maps(jobs, options, device, &Flow::watched(observer), &Templates::default(), take);
}

/// A job by its number, and the file by which its results are known again, if there is one.
pub type SealedJob = (JobId, MapJob, Option<NamedFile>);

/// The same for jobs that are told one by one, within the flow's limits; source meshes that `templates` names are read
/// and checked once. A job's seal is written with its results.
pub fn stream_maps(
    jobs: impl Iterator<Item = SealedJob> + Send,
    options: &MapOptions,
    device: &Device,
    flow: &Flow,
    templates: &Templates,
    take: impl FnMut(Outcome<Report>),
) {
    let (compute, device) = (&device.compute, &steps::device_line(device));
    let jobs = jobs.map(|(id, job, seal)| (id, footprint(&job, options), (job, seal)));
    thread::scope(|scope| {
        let started = Line::start(scope, flow, jobs);
        let loaded = started.then(Stage::Load, |job, step| steps::load(job, templates, step));
        checked_to_composed(loaded, options, compute, templates)
            .then(Stage::Refine, |pair, step| steps::refine(pair, options.refine.as_ref(), step))
            .then(Stage::Bake, |pair, step| steps::bake(pair, compute, options, step))
            .then(Stage::Write, |pair, step| steps::write(pair, device, options.page.as_ref(), step))
            .finish(take);
    });
}

/// Maps pairs that are in memory, by the same stages but without files and images; asks for the next pair only when
/// there is room.
pub fn map_pairs(
    pairs: impl Iterator<Item = Loaded> + Send,
    options: &MapOptions,
    device: &Device,
    observer: &dyn Observer,
    mut take: impl FnMut(Outcome<Mapped>),
) {
    let pairs = pairs.enumerate().map(|(i, pair)| (JobId(i), 0, (Outputs::default(), pair)));
    let (flow, templates) = (Flow::watched(observer), Templates::default());
    thread::scope(|scope| {
        let loaded = Line::start(scope, &flow, pairs);
        checked_to_composed(loaded, options, &device.compute, &templates).finish(
            |Outcome { id, value, failed_in, seconds }| {
                take(Outcome { id, value: value.map(steps::mapped), failed_in, seconds });
            },
        );
    });
}

/// The stages from which a map comes out of two meshes.
fn checked_to_composed<'scope, 'env>(
    loaded: Line<'scope, 'env, (Outputs, Loaded)>,
    options: &'env MapOptions,
    compute: &'env Compute,
    templates: &'env Templates,
) -> Line<'scope, 'env, Pair<Finished>> {
    loaded
        .then(Stage::Check, |pair, _| steps::check(pair, templates))
        .then(Stage::Simplify, |pair, step| steps::simplify(pair, options.relax, step))
        .then(Stage::Cluster, steps::cluster)
        .then(Stage::Trace, |pair, step| steps::trace(pair, compute, options.layout, step))
        .then(Stage::Embed, |pair, step| steps::embed(pair, options.layout, step))
        .then(Stage::Stretch, |pair, step| steps::stretch(pair, compute, step))
        .then(Stage::Relax, |pair, step| steps::relax(pair, compute, options.relax, options.tolerance, step))
        .then(Stage::Lift, |pair, step| steps::lift(pair, compute, options.layout, options.tolerance, step))
        .then(Stage::Compose, steps::compose)
}

/// A stage of the main job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Reads both meshes and the landmarks.
    Load,
    /// Turns them into manifolds or says what is wrong.
    Check,
    /// Makes large meshes smaller, with a way back.
    Simplify,
    /// Grows the landmarks' surface Voronoi cells.
    Cluster,
    /// Traces the arcs of the layout on both meshes.
    Trace,
    /// Embeds every patch into its base triangle.
    Embed,
    /// Lowers the stretch of the embeddings, all patches in one batch on the compute device.
    Stretch,
    /// Lowers the distortion of the composed map.
    Relax,
    /// Carries the map back to the large meshes.
    Lift,
    /// Joins the embeddings into the map and certifies it.
    Compose,
    /// Inserts vertices where the compatible meshes miss the other surface, if that was asked for.
    Refine,
    /// Samples the common atlas.
    Bake,
    /// Writes the output folder.
    Write,
}

impl Stage {
    /// All stages in order.
    pub const ALL: [Stage; 13] = [
        Stage::Load,
        Stage::Check,
        Stage::Simplify,
        Stage::Cluster,
        Stage::Trace,
        Stage::Embed,
        Stage::Stretch,
        Stage::Relax,
        Stage::Lift,
        Stage::Compose,
        Stage::Refine,
        Stage::Bake,
        Stage::Write,
    ];

    /// The stage's name in reports, logs and benches.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Load => "load",
            Stage::Check => "check",
            Stage::Simplify => "simplify",
            Stage::Cluster => "cluster",
            Stage::Trace => "trace",
            Stage::Embed => "embed",
            Stage::Stretch => "stretch",
            Stage::Relax => "relax",
            Stage::Lift => "lift",
            Stage::Compose => "compose",
            Stage::Refine => "refine",
            Stage::Bake => "bake",
            Stage::Write => "write",
        }
    }
}
