//! Stage: the best of several layouts, by the energy they lead to.
//!
//! Arc lengths tell poor layouts from good ones, but not which of the good ones runs around the limbs the right way. So
//! each is embedded and relaxed a little, and the one with the lowest energy is kept.

use super::embed::embed;
use super::layout::Layout;
use super::relax::{RelaxOptions, relax_arcs};
use crate::error::{Error, Result};
use crate::mesh::TriMesh;
use rayon::prelude::*;

/// How far candidates are relaxed: after two rounds their order hardly changes any more.
const TRIAL: RelaxOptions = RelaxOptions { newton: 1, sweeps: 2, exchanges: 1, rounds: 2, tolerance: 0.0 };

/// The layout whose map has the lowest energy after a short relaxation; ties go to the first.
pub fn choose(meshes: [&TriMesh; 2], mut layouts: Vec<Layout>) -> Result<Layout> {
    if layouts.len() > 1 {
        let tried: Vec<Result<f64>> = layouts.par_iter().map(|layout| try_out(meshes, layout)).collect();
        let energies = tried.into_iter().collect::<Result<Vec<f64>>>()?;
        let best = (0..layouts.len()).min_by(|&a, &b| energies[a].total_cmp(&energies[b])).unwrap_or(0);
        return Ok(layouts.swap_remove(best));
    }
    layouts.pop().ok_or_else(|| Error::bug("no layout was made"))
}

fn try_out(meshes: [&TriMesh; 2], layout: &Layout) -> Result<f64> {
    let (mut embedding, _) = embed(meshes, layout.clone())?;
    let history = relax_arcs(meshes, &mut embedding, &TRIAL)?;
    Ok(history.last().copied().unwrap_or(f64::INFINITY))
}
