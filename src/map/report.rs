//! `report.json`: what was mapped, how, how well, how long it took.

use super::certificate::Certificate;
use super::distortion::Distortion;
use serde::Serialize;
use std::collections::BTreeMap;

/// The report of one finished map.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Version of the program.
    pub version: &'static str,
    /// The compute device, in words.
    pub device: String,
    /// The source mesh.
    pub source: MeshSummary,
    /// The target mesh.
    pub target: MeshSummary,
    /// Number of landmarks.
    pub landmarks: usize,
    /// The layout.
    pub layout: LayoutSummary,
    /// How the distortion was lowered.
    pub relaxation: RelaxationSummary,
    /// Why the map is a homeomorphism.
    pub certificate: Certificate,
    /// `source_on_target.obj` against the source, both ways.
    pub distortion: Distortion,
    /// `target_on_source.obj` against the target, both ways.
    pub distortion_target_on_source: Distortion,
    /// Wall-clock seconds per stage, and `total`, their sum.
    pub seconds: BTreeMap<&'static str, f64>,
    /// Largest resident memory of the process so far, bytes; 0 where the system does not say.
    pub peak_bytes: u64,
    /// What a user should know about this result, one sentence each.
    pub warnings: Vec<String>,
}

/// One input mesh.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeshSummary {
    /// The file as it was named.
    pub file: String,
    /// Number of vertices, unreferenced ones included.
    pub vertices: usize,
    /// Number of triangles.
    pub faces: usize,
    /// Genus.
    pub genus: i64,
    /// Number of boundary loops.
    pub boundary_loops: usize,
}

/// The layout in numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayoutSummary {
    /// The method that made it, as on the command line.
    pub kind: &'static str,
    /// Number of arcs.
    pub arcs: usize,
    /// Number of patches.
    pub patches: usize,
    /// Arcs that were put off at least once because they would have blocked others or swirled.
    pub postponed: usize,
    /// Arcs that were flipped on both meshes at once to lower distortion.
    pub flips: usize,
}

/// The energies before and after each phase of the relaxation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RelaxationSummary {
    /// How far the map was relaxed, as on the command line.
    pub method: &'static str,
    /// The embeddings of the source's and the target's patches, relaxed by the kernels.
    pub stretch: [StretchSummary; 2],
    /// Symmetric Dirichlet energy of the map, mean of both directions: before, and after every round.
    pub energies: Vec<f64>,
    /// Symmetric Dirichlet energy of the compatible meshes, mean of both: before the polish, and after every round of it.
    pub polish: Vec<f64>,
}

/// Stretch of one mesh's patches against the triangles they are embedded in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct StretchSummary {
    /// E_L2 of the embeddings as they were solved.
    pub before: f64,
    /// E_L2 after the kernels.
    pub after: f64,
    /// Patches whose stretch fell.
    pub improved: usize,
}

/// Largest resident memory of this process so far, in bytes; 0 where the system does not say.
pub fn peak_bytes() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    let kib = line.and_then(|l| l.trim().trim_end_matches("kB").trim().parse::<u64>().ok());
    kib.unwrap_or(0) * 1024
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn peak_memory_covers_a_large_block() {
        let block = vec![1u8; 64 << 20];
        assert!(block.iter().map(|&b| u64::from(b)).sum::<u64>() == 64 << 20);
        assert!(peak_bytes() >= 64 << 20);
    }
}
