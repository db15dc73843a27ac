//! The list of stages, in the order in which a job passes them.

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
