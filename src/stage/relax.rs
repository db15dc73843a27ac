//! Stage: the composed map relaxed, certificate kept.
//!
//! Input: an embedding. Output: the same with lower symmetric Dirichlet energy of the map in both directions. The two
//! patches at an arc are glued into one domain, the vertices of either mesh move in it while the other holds still, and
//! the arc is read off again as the straight segment between its ends: a Schwarz iteration over all arcs, parallel over
//! arcs that share no patch. Invariant: every patch stays embedded; a domain whose energy does not fall, or whose arc
//! cannot be read, is left as it was.

use crate::error::Result;
use crate::map::embedding::Embedding;
use crate::map::purge::purge;
use crate::map::recut::{Pair, recut};
use crate::mesh::{ArcId, Id, IdVec, PatchId, TriMesh, VertexId};
use crate::path::base_complex::NO_PATCH;
use crate::plane::convex::is_embedded;
use crate::plane::diagonal::{Segment, read_segment};
use crate::plane::domain::{Domain, Placement};
use crate::plane::newton::newton;
use crate::plane::smooth::Smoother;
use glam::DVec3;
use rayon::prelude::*;

/// How far the map is relaxed.
#[derive(Clone, Copy, Debug)]
pub struct RelaxOptions {
    /// Newton steps before the sweeps.
    pub newton: usize,
    /// Sweeps of one mesh's vertices over the other mesh before their roles are exchanged.
    pub sweeps: usize,
    /// Exchanges of roles in one visit of a domain.
    pub exchanges: usize,
    /// Visits of every domain.
    pub rounds: usize,
    /// The relaxation ends when a round lowers the energy by less than this share; 0 runs all rounds.
    pub tolerance: f64,
}

impl Default for RelaxOptions {
    fn default() -> Self {
        RelaxOptions { newton: 1, sweeps: 2, exchanges: 2, rounds: 6, tolerance: 5e-3 }
    }
}

impl RelaxOptions {
    /// A short relaxation, after which candidates can be told apart.
    pub fn trial() -> Self {
        RelaxOptions { rounds: 2, tolerance: 0.0, ..Self::default() }
    }
}

/// One mesh's share of a relaxed domain: the domain, and where the arc runs in it.
struct Relaxed {
    domain: Domain,
    segment: Segment,
}

/// Relaxes the inside of every patch, arcs held; returns the energy before and after every round.
pub fn relax_patches(meshes: [&TriMesh; 2], embedding: &mut Embedding, options: &RelaxOptions) -> Vec<f64> {
    let scale = unit_scale(meshes);
    let mut history = vec![energy(meshes, embedding)];
    let patches: Vec<PatchId> = embedding.base.patches.ids().collect();
    for _ in 0..options.rounds {
        let relax = |&p: &PatchId| {
            let mut domains = [0, 1].map(|k| patch_domain(embedding, p, k, scale[k]));
            alternate(&mut domains, options).then_some(domains)
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
    let groups = independent_arcs(embedding);
    let mut history = vec![energy(meshes, embedding)];
    for _ in 0..options.rounds {
        for group in &groups {
            let visit = |pair: &Pair| relax_pair(embedding, pair, scale, options);
            let relaxed: Vec<Option<[Relaxed; 2]>> = group.par_iter().map(visit).collect();
            apply(meshes, embedding, group, &relaxed)?;
        }
        clean_up(meshes, embedding)?;
        if settled(&mut history, energy(meshes, embedding), options) {
            break;
        }
    }
    Ok(history)
}

/// Factors from mesh units to unit area.
fn unit_scale(meshes: [&TriMesh; 2]) -> [f64; 2] {
    meshes.map(|m| 1.0 / m.area().sqrt())
}

/// Symmetric Dirichlet energy of the map, the mean of both directions; 1 for an isometry.
pub fn energy(meshes: [&TriMesh; 2], embedding: &Embedding) -> f64 {
    let scale = unit_scale(meshes);
    let one = |p: PatchId| {
        let [mut source, target] = [0, 1].map(|k| patch_domain(embedding, p, k, scale[k]));
        Smoother::new(&mut source, &target).energy()
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

/// Writes the results of one group of domains into both meshes, side by side.
fn apply(
    meshes: [&TriMesh; 2],
    embedding: &mut Embedding,
    group: &[Pair],
    relaxed: &[Option<[Relaxed; 2]>],
) -> Result<()> {
    let Embedding { base, meshes: embedded, .. } = embedding;
    let write = |(k, mesh): (usize, &mut _)| {
        for (pair, result) in group.iter().zip(relaxed) {
            if let Some(sides) = result {
                recut(meshes[k], mesh, base, pair, &sides[k].domain, &sides[k].segment)?;
            }
        }
        Ok(())
    };
    let results: Vec<Result<()>> = embedded.par_iter_mut().enumerate().map(write).collect();
    results.into_iter().collect()
}

/// Removes the vertices that arcs left behind.
fn clean_up(meshes: [&TriMesh; 2], embedding: &mut Embedding) -> Result<()> {
    let Embedding { base, meshes: embedded, .. } = embedding;
    let [source, target] = embedded;
    let (a, b) = rayon::join(|| purge(meshes[0], source, base, 1), || purge(meshes[1], target, base, 1));
    a?;
    b?;
    Ok(())
}

fn relax_pair(embedding: &Embedding, pair: &Pair, scale: [f64; 2], options: &RelaxOptions) -> Option<[Relaxed; 2]> {
    let mut domains = [0, 1].map(|k| {
        let mesh = &embedding.meshes[k];
        let discs = pair.patches.map(|p| &mesh.discs[p]);
        let points = |v: VertexId| -> DVec3 { mesh.cut.positions[v] * scale[k] };
        Domain::of_pair(discs, [&pair.placements[0], &pair.placements[1]], &mesh.shares[pair.arc], &points)
    });
    if !alternate(&mut domains, options) {
        return None;
    }
    let [first, second] = [read_segment(&mut domains[0])?, read_segment(&mut domains[1])?];
    let [source, target] = domains;
    Some([Relaxed { domain: source, segment: first }, Relaxed { domain: target, segment: second }])
}

fn patch_domain(embedding: &Embedding, p: PatchId, k: usize, scale: f64) -> Domain {
    let mesh = &embedding.meshes[k];
    Domain::of_patch(&mesh.discs[p], &|v: VertexId| -> DVec3 { mesh.cut.positions[v] * scale })
}

/// Moves the source's vertices over the target and the target's over the source in turn; true if the energy fell.
fn alternate([source, target]: &mut [Domain; 2], options: &RelaxOptions) -> bool {
    let before = Smoother::new(source, target).energy();
    for _ in 0..options.exchanges {
        smooth(source, target, options);
        smooth(target, source, options);
    }
    let after = Smoother::new(source, target).energy();
    after < before || !before.is_finite()
}

fn smooth(moving: &mut Domain, fixed: &Domain, options: &RelaxOptions) {
    for _ in 0..options.newton {
        if !newton(&mut Smoother::new(moving, fixed)) {
            break;
        }
    }
    let mut smoother = Smoother::new(moving, fixed);
    for sweep in 0..options.sweeps {
        if smoother.sweep(sweep % 2 == 1) == 0 {
            break;
        }
    }
}

/// Groups of arcs whose domains share no patch; arcs on the boundary and with one patch on both sides are left out.
fn independent_arcs(embedding: &Embedding) -> Vec<Vec<Pair>> {
    let side_of = embedding.base.side_of();
    let mut groups: Vec<(IdVec<PatchId, bool>, Vec<Pair>)> = Vec::new();
    for arc in embedding.base.arcs.ids() {
        let [(p, i), (q, j)] = [side_of[2 * arc.index()], side_of[2 * arc.index() + 1]];
        if p == q || [p, q].contains(&NO_PATCH) {
            continue;
        }
        let pair = pair_of(embedding, arc, [(p, i), (q, j)]);
        let free = groups.iter().position(|(used, _)| !used[p] && !used[q]);
        let at = free.unwrap_or_else(|| {
            groups.push((IdVec::filled(false, embedding.base.patches.len()), Vec::new()));
            groups.len() - 1
        });
        groups[at].0[p] = true;
        groups[at].0[q] = true;
        groups[at].1.push(pair);
    }
    groups.into_iter().map(|(_, pairs)| pairs).collect()
}

fn pair_of(embedding: &Embedding, arc: ArcId, [(p, i), (q, j)]: [(PatchId, usize); 2]) -> Pair {
    let frames = [embedding.frames[p], embedding.frames[q]];
    let placements = [Placement::above(i, &frames[0]), Placement::below(j, &frames[1])];
    Pair { arc, patches: [p, q], placements, frames }
}
