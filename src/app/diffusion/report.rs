//! `report.json` of a parametrization.

use super::Diffusion;
use super::corners::Completion;
use crate::app::transfer::TransferReport;
use crate::map::distortion::Distortion;
use crate::map::report::MeshSummary;
use crate::mesh::io::MeshFile;
use serde::Serialize;
use std::collections::BTreeMap;

/// The report.
#[derive(Clone, Debug, Serialize)]
pub struct DiffusionReport {
    /// Version of the program.
    pub version: &'static str,
    /// How fronts moved: `face` or `edge`.
    pub front: &'static str,
    /// The mesh.
    pub mesh: ParametrizedMesh,
    /// The second mesh, if there is one.
    pub onto: Option<ParametrizedMesh>,
    /// `source_on_target.obj` against the mesh, both ways.
    pub distortion: Option<Distortion>,
    /// `target_on_source.obj` against the second mesh, both ways.
    pub distortion_target_on_source: Option<Distortion>,
    /// The image that was carried over.
    pub texture: Option<TransferReport>,
    /// Wall-clock seconds by step.
    pub seconds: BTreeMap<&'static str, f64>,
    /// What a user should know, one sentence each.
    pub warnings: Vec<String>,
}

/// One mesh.
#[derive(Clone, Debug, Serialize)]
pub struct ParametrizedMesh {
    /// The mesh as it was read.
    #[serde(flatten)]
    pub mesh: MeshSummary,
    /// Its regions.
    pub regions: Vec<RegionReport>,
    /// How regions came to four sides.
    pub completions: Vec<Completion>,
    /// Folded triangles in all regions.
    pub folds: usize,
}

/// One region.
#[derive(Clone, Debug, Serialize)]
pub struct RegionReport {
    /// Its name.
    pub name: String,
    /// Number of vertices, those on its border included.
    pub vertices: usize,
    /// Number of triangles.
    pub faces: usize,
    /// True if u and v are left-handed, as the given sides have it.
    pub mirrored: bool,
    /// True if it was re-embedded: its (u, v) do not come from fronts.
    pub repaired: bool,
    /// The corners, counter-clockwise, the first at the start of v0.
    pub corners: [u32; 4],
    /// What was measured.
    #[serde(flatten)]
    pub quality: super::Quality,
}

impl ParametrizedMesh {
    /// What there is to say about a mesh.
    pub fn new(diffusion: &Diffusion, file: &MeshFile) -> Self {
        let mesh = diffusion.mesh;
        let region = |(piece, quality): (&super::Piece, &super::Quality)| RegionReport {
            name: piece.name.clone(),
            vertices: piece.disc.vertices.len(),
            faces: piece.disc.faces.len(),
            mirrored: piece.mirrored,
            repaired: piece.repaired,
            corners: piece.sides.each_ref().map(|side| piece.disc.vertices[side.vertices[0] as usize].0),
            quality: quality.clone(),
        };
        ParametrizedMesh {
            mesh: MeshSummary {
                file: file.path.display().to_string(),
                vertices: mesh.positions.len(),
                faces: mesh.conn.face_count(),
                genus: mesh.genus(),
                boundary_loops: mesh.conn.boundary_loops().len(),
            },
            regions: diffusion.pieces.iter().zip(&diffusion.quality).map(region).collect(),
            completions: diffusion.completions.clone(),
            folds: diffusion.quality.iter().map(|q| q.folds.len()).sum(),
        }
    }
}

/// Sentences about what a mesh's parametrization is not; `repair` says whether folds were to be repaired.
pub fn remarks(diffusion: &Diffusion, name: &str, repair: bool) -> Vec<String> {
    let mut remarks: Vec<String> = diffusion.warnings.iter().map(|w| format!("{name}: {w}")).collect();
    let folding: Vec<String> = diffusion
        .pieces
        .iter()
        .zip(&diffusion.quality)
        .filter(|(_, q)| !q.folds.is_empty() || !q.flat.is_empty())
        .map(|(p, q)| format!("\"{}\" {}", p.name, q.folds.len() + q.flat.len()))
        .collect();
    if !folding.is_empty() {
        let list = folding.join(", ");
        let remedy = if repair { "they cannot be embedded anew" } else { "--repair embeds these regions anew" };
        remarks.push(format!("{name}: triangles are folded or flat in (u, v): {list}; {remedy}"));
    }
    let repaired: Vec<String> =
        diffusion.pieces.iter().filter(|p| p.repaired).map(|p| format!("\"{}\"", p.name)).collect();
    if !repaired.is_empty() {
        remarks.push(format!("{name}: embedded anew because fronts folded them: {}", repaired.join(", ")));
    }
    let pinned: usize = diffusion.quality.iter().map(|q| q.pinned.len()).sum();
    if pinned > 0 {
        remarks.push(format!("{name}: {pinned} triangles lie flat on straight sides, which leave no room for them"));
    }
    remarks
}
