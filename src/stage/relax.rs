//! Stage: the composed map relaxed, certificate kept.
//!
//! Input: an embedding. Output: the same with lower symmetric Dirichlet energy of the map in both directions. The
//! patches around a base vertex are glued into one domain, the base vertex pinned; the vertices of either mesh move in it
//! while the other holds still, and the arcs are read off again as the straight segments between their ends. Arcs that no
//! such star holds get a domain of their two patches. This is a Schwarz iteration over overlapping domains, parallel over
//! domains that share no patch. Invariant: every patch stays embedded; a domain whose energy does not fall, or whose arcs
//! cannot be read, is left as it was.

use crate::error::Result;
use crate::map::embedding::Embedding;
use crate::map::purge::purge;
use crate::map::recut::{Relaxed, recut_all};
use crate::mesh::{Id, IdVec, LandmarkId, PatchId, TriMesh, VertexId};
use crate::plane::convex::is_embedded;
use crate::plane::domain::Domain;
use crate::plane::newton::newton;
use crate::plane::smooth::{Model, Smoother};
use crate::plane::straighten::straighten;
use crate::plane::sweep::{sweep, sweep_exactly};
use crate::plane::tiling::Tiling;
use glam::DVec3;
use rayon::prelude::*;

/// How far from a vertex, as a share of an edge, an arc's new way may miss it and still be led through it; the first that
/// leaves the energy below what it was.
const SNAPS: [f64; 3] = [0.2, 0.05, LEAST_SNAP];
/// Vertices that lie on the way but for rounding, and slivers not worth making.
pub(super) const LEAST_SNAP: f64 = 1e-3;

/// How far the map is relaxed.
#[derive(Clone, Copy, Debug)]
pub struct RelaxOptions {
    /// Sweeps of single moves of one mesh's vertices over the other, in coarse rounds.
    pub sweeps: usize,
    /// Newton steps of one mesh over the other after them.
    pub newton: usize,
    /// Exchanges of the meshes' roles in one visit of a domain, in coarse rounds.
    pub exchanges: usize,
    /// Coarse visits of every domain: metrics are held while vertices move, which goes far in little time.
    pub coarse_rounds: usize,
    /// Fine visits of every domain: moves follow the gradient of the energy itself.
    pub fine_rounds: usize,
    /// A row of rounds ends when one lowers the energy by less than this share; 0 runs all rounds.
    pub tolerance: f64,
}

impl Default for RelaxOptions {
    fn default() -> Self {
        RelaxOptions { sweeps: 2, newton: 1, exchanges: 2, coarse_rounds: 1, fine_rounds: 3, tolerance: 3e-3 }
    }
}

impl RelaxOptions {
    /// A short relaxation, after which candidates can be told apart.
    pub fn trial() -> Self {
        RelaxOptions { coarse_rounds: 1, fine_rounds: 0, tolerance: 0.0, ..Self::default() }
    }
}

/// Relaxes the inside of every patch, arcs held; returns the energy before and after every round.
pub fn relax_patches(meshes: [&TriMesh; 2], embedding: &mut Embedding, options: &RelaxOptions) -> Vec<f64> {
    let scale = unit_scale(meshes);
    let mut history = vec![energy(meshes, embedding)];
    let patches: Vec<PatchId> = embedding.base.patches.ids().collect();
    for _ in 0..options.coarse_rounds + options.fine_rounds {
        let relax = |&p: &PatchId| {
            let mut domains = [0, 1].map(|k| patch_domain(embedding, p, k, scale[k]));
            alternate(&mut domains, Model::Tangent, options).map(|_| domains)
        };
        let relaxed: Vec<Option<[Domain; 2]>> = patches.par_iter().map(relax).collect();
        for (&p, result) in patches.iter().zip(relaxed) {
            let Some(domains) = result else { continue };
            let discs = [0, 1].map(|k| &embedding.meshes[k].discs[p]);
            if (0..2).all(|k| is_embedded(discs[k], &domains[k].positions)) {
                for (mesh, domain) in embedding.meshes.iter_mut().zip(domains) {
                    mesh.discs[p].positions = domain.positions;
                }
            }
        }
        if settled(&mut history, energy(meshes, embedding), options) {
            break;
        }
    }
    history
}

/// Relaxes across all arcs; returns the energy before and after every round.
pub fn relax_arcs(meshes: [&TriMesh; 2], embedding: &mut Embedding, options: &RelaxOptions) -> Result<Vec<f64>> {
    let scale = unit_scale(meshes);
    let groups = independent_domains(embedding);
    let mut history = vec![energy(meshes, embedding)];
    for (model, rounds) in [(Model::Held, options.coarse_rounds), (Model::Tangent, options.fine_rounds)] {
        for _ in 0..rounds {
            for group in &groups {
                let visit = |tiling: &Tiling| relax_domain(embedding, tiling, scale, model, options);
                let relaxed: Vec<Option<[Relaxed; 2]>> = group.par_iter().map(visit).collect();
                recut_all(meshes, embedding, group, &relaxed)?;
            }
            clean_up(meshes, embedding)?;
            if settled(&mut history, energy(meshes, embedding), options) {
                break;
            }
        }
    }
    Ok(history)
}

/// Factors from mesh units to unit area.
pub(super) fn unit_scale(meshes: [&TriMesh; 2]) -> [f64; 2] {
    meshes.map(|m| 1.0 / m.area().sqrt())
}

/// Symmetric Dirichlet energy of the map, the mean of both directions; 1 for an isometry.
pub fn energy(meshes: [&TriMesh; 2], embedding: &Embedding) -> f64 {
    let scale = unit_scale(meshes);
    let one = |p: PatchId| {
        let [mut source, target] = [0, 1].map(|k| patch_domain(embedding, p, k, scale[k]));
        Smoother::new(&mut source, &target, Model::Held).energy()
    };
    let patches: Vec<PatchId> = embedding.base.patches.ids().collect();
    let energies: Vec<f64> = patches.into_par_iter().map(one).collect();
    energies.iter().sum()
}

/// Records the energy; true if the last round brought too little to go on.
fn settled(history: &mut Vec<f64>, now: f64, options: &RelaxOptions) -> bool {
    let before = history[history.len() - 1];
    history.push(now);
    before.is_finite() && now > before * (1.0 - options.tolerance)
}

/// Removes the vertices that arcs left behind.
fn clean_up(meshes: [&TriMesh; 2], embedding: &mut Embedding) -> Result<()> {
    let scale = unit_scale(meshes);
    let Embedding { base, meshes: [source, target], .. } = embedding;
    purge([meshes[0], meshes[1]], [source, target], base, scale)?;
    purge([meshes[1], meshes[0]], [target, source], base, [scale[1], scale[0]])
}

/// The two meshes' parts of a domain.
pub(super) fn domains(embedding: &Embedding, tiling: &Tiling, scale: [f64; 2]) -> [Domain; 2] {
    [0, 1].map(|k| {
        let mesh = &embedding.meshes[k];
        let points = |v: VertexId| -> DVec3 { mesh.cut.positions[v] * scale[k] };
        Domain::of_tiling(tiling, &|p| &mesh.discs[p], &mesh.shares, &points)
    })
}

fn relax_domain(
    embedding: &Embedding,
    tiling: &Tiling,
    scale: [f64; 2],
    model: Model,
    options: &RelaxOptions,
) -> Option<[Relaxed; 2]> {
    let mut domains = domains(embedding, tiling, scale);
    let before = alternate(&mut domains, model, options)?;
    SNAPS.iter().find_map(|&snap| {
        let [mut source, mut target] = domains.clone();
        let straight = [straighten(&mut source, tiling, snap)?, straighten(&mut target, tiling, snap)?];
        let after = Smoother::new(&mut source, &target, Model::Held).energy();
        let [first, second] = straight;
        let relaxed = [Relaxed { domain: source, straight: first }, Relaxed { domain: target, straight: second }];
        (after < before).then_some(relaxed)
    })
}

fn patch_domain(embedding: &Embedding, p: PatchId, k: usize, scale: f64) -> Domain {
    let mesh = &embedding.meshes[k];
    Domain::of_patch(&mesh.discs[p], &|v: VertexId| -> DVec3 { mesh.cut.positions[v] * scale })
}

/// Moves the source's vertices over the target and the target's over the source in turn; returns the energy before.
///
/// None if nothing moved.
fn alternate([source, target]: &mut [Domain; 2], model: Model, options: &RelaxOptions) -> Option<f64> {
    let mut first = None;
    let exchanges = if model == Model::Held { options.exchanges } else { 1 };
    for _ in 0..exchanges {
        first = first.or(smooth(source, target, model, options));
        first = first.or(smooth(target, source, model, options));
    }
    first
}

/// Moves one mesh's vertices over the other; returns the energy before if it fell.
fn smooth(moving: &mut Domain, fixed: &Domain, model: Model, options: &RelaxOptions) -> Option<f64> {
    let mut smoother = Smoother::new(moving, fixed, model);
    let before = smoother.energy();
    match model {
        Model::Held => (0..options.sweeps).for_each(|k| sweep(&mut smoother, k % 2 == 1)),
        Model::Tangent => {
            sweep_exactly(&mut smoother);
            smoother.look();
        }
    }
    (0..options.newton).take_while(|_| newton(&mut smoother)).for_each(drop);
    smoother.settle();
    (smoother.energy() < before).then_some(before)
}

/// Groups of domains that share no patch: stars of base vertices, and the arcs that no star holds.
pub(super) fn independent_domains(embedding: &Embedding) -> Vec<Vec<Tiling>> {
    let Embedding { base, frames, .. } = embedding;
    let side_of = base.side_of();
    let star = |l| Tiling::of_star(base, &side_of, frames, LandmarkId::new(l));
    let mut tilings: Vec<Tiling> = (0..base.landmarks).filter_map(star).collect();
    let mut held = IdVec::filled(false, base.arcs.len());
    tilings.iter().flat_map(|t| &t.seams).for_each(|seam| held[seam.arc] = true);
    let alone = base.arcs.ids().filter(|&a| !held[a]);
    tilings.extend(alone.filter_map(|a| Tiling::of_arc(base, &side_of, frames, a)));
    let mut groups: Vec<(IdVec<PatchId, bool>, Vec<Tiling>)> = Vec::new();
    for tiling in tilings {
        let free = |used: &IdVec<PatchId, bool>| tiling.tiles.iter().all(|t| !used[t.patch]);
        let at = groups.iter().position(|(used, _)| free(used)).unwrap_or_else(|| {
            groups.push((IdVec::filled(false, base.patches.len()), Vec::new()));
            groups.len() - 1
        });
        tiling.tiles.iter().for_each(|t| groups[at].0[t.patch] = true);
        groups[at].1.push(tiling);
    }
    groups.into_iter().map(|(_, tilings)| tilings).collect()
}
