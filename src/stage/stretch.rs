//! Stage: stretch-minimising relaxation of the embeddings by the kernels.
//!
//! Yoshizawa, Belyaev, Seidel: A fast and simple stretch-minimizing mesh parameterization (2004). Input: embedded
//! patches. Output: the same with less stretch against their surfaces. All patches of both meshes go to the compute
//! device as one batch, each in the frame its stretch is measured in. The device proposes in f32; a proposal is taken
//! only if, brought back to the reference triangle in f64 with the boundary untouched, every triangle is exactly
//! positive and the patch's E_L2 fell. So no patch ever gets worse, and one that f32 is too coarse for stays as it was.

use crate::error::Result;
use crate::gpu::Compute;
use crate::kernel::{RelaxInput, RelaxOptions, RelaxSession, Rings};
use crate::map::embedding::{EmbeddedMesh, Embedding};
use crate::map::report::StretchSummary;
use crate::mesh::{IdVec, PatchId};
use crate::plane::convex::is_embedded;
use crate::plane::mean_value::mean_value;
use crate::plane::patch_disc::PatchDisc;
use crate::plane::stretch::{Frame, e_l2, patch_stretch};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::ops::Range;

/// Sweeps between two looks at the energies: fewer look too often, more overshoot where the stretch settles early.
const SWEEPS: u32 = 8;
/// Most batches of sweeps; patches settle after three or four on the meshes measured.
const BATCHES: u32 = 8;

/// All patches of both meshes as one graph.
#[derive(Default)]
struct Batch {
    triangles: Vec<[u32; 3]>,
    free: Vec<bool>,
    surface: Vec<DVec3>,
    plane: Vec<DVec2>,
    /// Where each patch lies in `triangles` and in `plane`.
    ranges: Vec<(Range<usize>, Range<usize>)>,
}

/// Relaxes every patch of both meshes and says how either mesh fared. Fails only on a device error.
pub fn stretch(compute: &Compute, embedding: &mut Embedding) -> Result<[StretchSummary; 2]> {
    let mut batch = Batch::default();
    for mesh in &embedding.meshes {
        for (p, disc) in mesh.discs.iter_ids() {
            batch.push(disc, &mesh.points(p), &embedding.frames[p]);
        }
    }
    let proposed = batch.relaxed(compute)?;
    let mut proposals = batch.ranges.iter().map(|(_, vertices)| &proposed[vertices.clone()]);
    let Embedding { meshes, frames, .. } = embedding;
    Ok(meshes.each_mut().map(|mesh| {
        let before = energy(mesh, frames);
        let own: Vec<&[DVec2]> = proposals.by_ref().take(mesh.discs.len()).collect();
        let improved = accept(mesh, &frames.raw, &own);
        StretchSummary { before, after: energy(mesh, frames), improved }
    }))
}

impl Batch {
    fn push(&mut self, disc: &PatchDisc, points: &[DVec3], frame: &Frame) {
        let (triangles, vertices) = (self.triangles.len(), self.plane.len());
        let shifted = disc.triangles.iter().map(|t| t.map(|v| v + vertices as u32));
        self.triangles.extend(shifted);
        self.free.extend((0..disc.vertices.len()).map(|i| i >= disc.boundary));
        self.surface.extend_from_slice(points);
        // Patches of about unit size, as the session wants them.
        let unit = frame.area().sqrt().recip();
        self.plane.extend(disc.positions.iter().map(|&p| frame.place(p) * unit));
        self.ranges.push((triangles..self.triangles.len(), vertices..self.plane.len()));
    }

    /// The positions after relaxation.
    fn relaxed(&self, compute: &Compute) -> Result<Vec<DVec2>> {
        let rings = Rings::build(&self.triangles, &self.free)?;
        let free: Vec<usize> = (0..self.free.len()).filter(|&v| self.free[v]).collect();
        let weights_of = |v: usize| mean_value(v, rings.of(v), &self.surface).into_iter().map(|w| w as f32);
        let weights: Vec<f32> = free.into_par_iter().flat_map_iter(weights_of).collect();
        let input = RelaxInput {
            triangles: &self.triangles,
            rings: &rings,
            weights: &weights,
            surface: &self.surface,
            plane: &self.plane,
        };
        let patches: Vec<Range<usize>> = self.ranges.iter().map(|(triangles, _)| triangles.clone()).collect();
        let options = RelaxOptions { sweeps: SWEEPS, ..RelaxOptions::default() };
        Ok(RelaxSession::new(compute, &input)?.settle(&patches, &options, BATCHES)?.plane)
    }
}

/// Takes the proposals that are embeddings with less stretch; returns their number.
fn accept(mesh: &mut EmbeddedMesh, frames: &[Frame], proposals: &[&[DVec2]]) -> usize {
    let cut = &mesh.cut;
    let one = |((disc, frame), proposal): ((&mut PatchDisc, &Frame), &&[DVec2])| {
        let points: Vec<DVec3> = disc.vertices.iter().map(|&v| cut.positions[v]).collect();
        let before = e_l2(&patch_stretch(disc, &points, frame), frame.area());
        let size = frame.area().sqrt();
        let free = proposal[disc.boundary..].iter().map(|&q| frame.reference(q * size));
        let fixed = disc.positions[..disc.boundary].iter().copied();
        let trial = PatchDisc { positions: fixed.chain(free).collect(), ..disc.clone() };
        let is_better = is_embedded(&trial, &trial.positions)
            && e_l2(&patch_stretch(&trial, &points, frame), frame.area()) < before;
        if is_better {
            disc.positions = trial.positions;
        }
        usize::from(is_better)
    };
    mesh.discs.raw.par_iter_mut().zip(frames).zip(proposals).map(one).sum()
}

/// E_L2 of all patches of a mesh, every frame scaled to the area of its patch.
fn energy(mesh: &EmbeddedMesh, frames: &IdVec<PatchId, Frame>) -> f64 {
    let of_patch = |p: PatchId| {
        let stretch = patch_stretch(&mesh.discs[p], &mesh.points(p), &frames[p]);
        let area: f64 = stretch.iter().map(|&(_, area)| area).sum();
        (e_l2(&stretch, frames[p].area()).powi(2) * area, area)
    };
    let patches: Vec<PatchId> = mesh.discs.ids().collect();
    let sums: Vec<(f64, f64)> = patches.into_par_iter().map(of_patch).collect();
    let (sum, area) = sums.iter().fold((0.0, 0.0), |(s, a), &(e, area)| (s + e, a + area));
    (sum / area).sqrt()
}
