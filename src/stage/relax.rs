//! Stage: the composed map relaxed, certificate kept.
//!
//! Input: an embedding. Output: the same with lower symmetric Dirichlet energy of the map in both directions. The
//! patches around a base vertex are glued into one domain, the base vertex pinned; the vertices of either mesh move in it
//! while the other holds still, first a few of them, then ever more (a V-cycle without its way down), and the arcs are read
//! off again as the straight segments between their ends. Arcs that no such star holds get a domain of their two patches.
//! This is a Schwarz iteration over overlapping domains, parallel over domains that share no patch. Invariant: every patch
//! stays embedded; a domain whose energy does not fall, or whose arcs cannot be read, is left as it was.

use super::flip::flip_arcs;
use super::levels::{Climb, climb};
use super::polish::{DREAD, HASTY_DREAD, polish_samples};
use super::visits::Visits;
use crate::deadline;
use crate::error::Result;
use crate::gpu::Compute;
use crate::map::embedding::Embedding;
use crate::map::recut::{Relaxed, recut_all};
use crate::mesh::{Id, IdVec, LandmarkId, PatchId, TriMesh, VertexId};
use crate::plane::convex::is_embedded;
use crate::plane::domain::Domain;
use crate::plane::exact_sweep::sweep_exactly;
use crate::plane::newton::newton;
use crate::plane::smooth::{self, Smoother};
use crate::plane::straighten::straighten;
use crate::plane::thin::{Origins, thin_out};
use crate::plane::tiling::Tiling;
use glam::DVec3;
use rayon::prelude::*;

/// How far from a vertex, as a share of an edge, an arc's new way may miss it and still be led through it; the first that
/// leaves the energy below what it was.
pub(super) const SNAPS: [f64; 3] = [0.2, 0.05, LEAST_SNAP];
/// Vertices that lie on the way but for rounding, and slivers not worth making.
pub(super) const LEAST_SNAP: f64 = 1e-3;

/// Vertices that may move at the level at which layouts are told apart.
const SKETCH: usize = 150;
/// Descents by the gradient of the energy itself in one visit of a domain: what is seen at the middles of triangles misses
/// some that nearly collapse, and these must have opened before the visit can be judged.
const DESCENTS: usize = 2;

/// A visit that lowers what a domain has more energy than an isometry by a smaller share leaves it settled.
const LITTLE: f64 = 0.01;

/// A map of more energy is crushed in places where further rounds mend little for their time.
const LOST: f64 = 10.0;
/// Rounds of either kind that it gets.
const ROUNDS_WHERE_LOST: usize = 2;

/// Most rounds for a map that was relaxed on simplified meshes.
const LIFTED_ROUNDS: usize = 6;
/// It needs no further round when what it has more energy than an isometry is that of the simple map but for this share.
const REGAINED: f64 = 0.05;

/// Vertices of both meshes together above which polishing is cut short.
const HASTY_FROM: usize = 200_000;

/// How far the map is relaxed.
#[derive(Clone, Copy, Debug)]
pub struct RelaxOptions {
    /// Most visits of every domain from coarse to fine, which go far in little time.
    pub coarse_rounds: usize,
    /// Most visits of every domain by the gradient of the energy itself.
    pub fine_rounds: usize,
    /// Either row of rounds ends when one lowers the energy, less that of an isometry, by less than this share; 0 runs all.
    pub tolerance: f64,
    /// Whether arcs are flipped after the first round from coarse to fine.
    pub flips: bool,
}

impl Default for RelaxOptions {
    fn default() -> Self {
        RelaxOptions { coarse_rounds: 3, fine_rounds: 3, tolerance: 0.01, flips: true }
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
            follow_gradient(&mut domains).map(|_| domains)
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
        if settled(&mut history, energy(meshes, embedding), options.tolerance) {
            break;
        }
    }
    history
}

/// How a domain is relaxed.
#[derive(Clone, Copy)]
enum Visit {
    FromCoarseToFine,
    FollowGradient,
}

/// What the relaxation across arcs did.
#[derive(Clone, Debug)]
pub struct Relaxing {
    /// The energy before and after every round.
    pub energies: Vec<f64>,
    /// Arcs that were flipped on both meshes at once.
    pub flips: usize,
}

/// Relaxes across all arcs, and flips some after the first round. Fails on a device error.
pub fn relax_arcs(
    compute: &Compute,
    meshes: [&TriMesh; 2],
    embedding: &mut Embedding,
    options: &RelaxOptions,
) -> Result<Relaxing> {
    let mut groups = independent_domains(embedding);
    let mut relaxing = Relaxing { energies: vec![energy(meshes, embedding)], flips: 0 };
    for (how, rounds) in
        [(Visit::FromCoarseToFine, options.coarse_rounds), (Visit::FollowGradient, options.fine_rounds)]
    {
        let mut visits = Visits::none(&groups, embedding.base.patches.len(), LITTLE);
        for round in 0..rounds {
            if round >= ROUNDS_WHERE_LOST && relaxing.energies.last().is_some_and(|&energy| energy > LOST) {
                break;
            }
            visit_all(compute, meshes, embedding, &groups, &mut visits, how)?;
            let is_settled = settled(&mut relaxing.energies, energy(meshes, embedding), options.tolerance);
            if matches!(how, Visit::FromCoarseToFine) && round == 0 && options.flips {
                relaxing.flips = flip_arcs(compute, meshes, embedding)?;
                if relaxing.flips > 0 {
                    groups = independent_domains(embedding);
                    visits = Visits::none(&groups, embedding.base.patches.len(), LITTLE);
                    continue;
                }
            }
            if is_settled {
                break;
            }
        }
    }
    Ok(relaxing)
}

/// What the relaxation of a lifted map did.
#[derive(Clone, Debug)]
pub struct Lifted {
    /// The energy before and after.
    pub energies: Vec<f64>,
    /// The energies of the compatible meshes, as [`super::polish::Polish`] has them.
    pub polish: Vec<f64>,
}

/// Relaxes a map that was relaxed on simplified meshes before, where it had the energy `simple`: one round by the gradient of
/// the energy, more where the map is not yet what it was there. Fails on a device error.
pub fn relax_lifted(
    compute: &Compute,
    meshes: [&TriMesh; 2],
    embedding: &mut Embedding,
    tolerance: f64,
    simple: f64,
) -> Result<Lifted> {
    let mut energies = vec![energy(meshes, embedding)];
    let groups = independent_domains(embedding);
    let mut visits = Visits::none(&groups, embedding.base.patches.len(), LITTLE);
    for _ in 0..LIFTED_ROUNDS {
        visit_all(compute, meshes, embedding, &groups, &mut visits, Visit::FollowGradient)?;
        let is_settled = settled(&mut energies, energy(meshes, embedding), tolerance);
        if is_settled || energies[energies.len() - 1] - 1.0 < (simple - 1.0) * (1.0 + REGAINED) {
            break;
        }
    }
    let vertices: usize = meshes.iter().map(|mesh| mesh.positions.len()).sum();
    let dread: &[f64] = if vertices > HASTY_FROM { &HASTY_DREAD } else { &DREAD };
    let polish = polish_samples(meshes, embedding, tolerance, dread)?.energies;
    Ok(Lifted { energies, polish })
}

/// Relaxes the domains at some base vertices once, from coarse to fine.
pub(super) fn relax_stars(
    compute: &Compute,
    meshes: [&TriMesh; 2],
    embedding: &mut Embedding,
    centers: &[LandmarkId],
) -> Result<()> {
    let Embedding { base, frames, .. } = &*embedding;
    let side_of = base.side_of();
    let stars = centers.iter().filter_map(|&l| Tiling::of_star(base, &side_of, frames, l)).collect();
    let groups = apart(stars, base.patches.len());
    let mut visits = Visits::none(&groups, embedding.base.patches.len(), LITTLE);
    visit_all(compute, meshes, embedding, &groups, &mut visits, Visit::FromCoarseToFine)
}

/// Visits all domains that are not settled, group by group.
fn visit_all(
    compute: &Compute,
    meshes: [&TriMesh; 2],
    embedding: &mut Embedding,
    groups: &[Vec<Tiling>],
    visits: &mut Visits,
    how: Visit,
) -> Result<()> {
    let scale = unit_scale(meshes);
    for (g, group) in groups.iter().enumerate() {
        deadline::check()?;
        let visit = |due: &[&Tiling]| relax_domains(compute, meshes, embedding, due, scale, how);
        let relaxed = visits.group(g, group, visit)?;
        let changed: Vec<_> = group.iter().zip(&relaxed).filter_map(|(t, sides)| Some((t, sides.as_ref()?))).collect();
        recut_all(meshes, embedding, &changed)?;
    }
    Ok(())
}

/// Factors from mesh units to unit area.
pub(super) fn unit_scale(meshes: [&TriMesh; 2]) -> [f64; 2] {
    meshes.map(|m| 1.0 / m.area().sqrt())
}

/// Symmetric Dirichlet energy of the map, the mean of both directions; 1 for an isometry.
pub fn energy(meshes: [&TriMesh; 2], embedding: &Embedding) -> f64 {
    patch_energies(meshes, embedding).raw.iter().sum()
}

/// What every patch contributes to the energy.
pub(super) fn patch_energies(meshes: [&TriMesh; 2], embedding: &Embedding) -> IdVec<PatchId, f64> {
    let scale = unit_scale(meshes);
    let one = |p: PatchId| {
        let [source, target] = [0, 1].map(|k| patch_domain(embedding, p, k, scale[k]));
        smooth::energy(&source, &target)
    };
    let patches: Vec<PatchId> = embedding.base.patches.ids().collect();
    let energies: Vec<f64> = patches.into_par_iter().map(one).collect();
    energies.into_iter().collect()
}

/// Records the energy; true if the last round brought too little to go on.
fn settled(history: &mut Vec<f64>, now: f64, tolerance: f64) -> bool {
    let before = history[history.len() - 1];
    history.push(now);
    before.is_finite() && now - 1.0 > (before - 1.0) * (1.0 - tolerance)
}

/// The two meshes' parts of a domain.
pub(super) fn domains(embedding: &Embedding, tiling: &Tiling, scale: [f64; 2]) -> [Domain; 2] {
    [0, 1].map(|k| {
        let mesh = &embedding.meshes[k];
        let points = |v: VertexId| -> DVec3 { mesh.cut.positions[v] * scale[k] };
        Domain::of_tiling(tiling, &|p| &mesh.discs[p], &mesh.shares, &points)
    })
}

/// The same without what arcs left behind.
pub(super) fn thin_domains(meshes: [&TriMesh; 2], embedding: &Embedding, whole: [Domain; 2]) -> [Domain; 2] {
    let [source, target] = whole;
    let thin = |k: usize, domain: Domain| {
        let cut = &embedding.meshes[k].cut;
        let origins = Origins { mesh: meshes[k], point: &|v| cut.origin[v], face: &|f| cut.face_origin[f] };
        thin_out(domain, &origins)
    };
    [thin(0, source), thin(1, target)]
}

/// Both meshes' parts of a domain after a visit, and by which share of what there was to gain its energy fell.
type Visited = ([Relaxed; 2], f64);

/// Relaxes domains that share no patch; none for those whose energy did not fall.
fn relax_domains(
    compute: &Compute,
    meshes: [&TriMesh; 2],
    embedding: &Embedding,
    due: &[&Tiling],
    scale: [f64; 2],
    how: Visit,
) -> Result<Vec<Option<Visited>>> {
    let start = |tiling: &&Tiling| {
        let whole = domains(embedding, tiling, scale);
        let isometry = 0.5 * (whole[0].area() + whole[1].area());
        let energy = smooth::energy(&whole[0], &whole[1]);
        (energy, isometry, thin_domains(meshes, embedding, whole))
    };
    let starts: Vec<(f64, f64, [Domain; 2])> = due.par_iter().map(start).collect();
    let (before, thin): (Vec<[f64; 2]>, Vec<[Domain; 2]>) = starts.into_iter().map(|(e, i, d)| ([e, i], d)).unzip();
    let moved: Vec<Option<[Domain; 2]>> = match how {
        Visit::FromCoarseToFine => {
            climb(compute, thin, usize::MAX)?.into_iter().map(|climb| climb.map(|c| c.whole)).collect()
        }
        Visit::FollowGradient => thin.into_iter().map(Some).collect(),
    };
    let visits = due.par_iter().zip(before).zip(moved);
    Ok(visits.map(|((tiling, before), domains)| relax_exactly(tiling, before, domains?)).collect())
}

/// Relaxes a domain by the gradient of its energy and reads off the arcs; none where it does not fall below what it was
/// before.
fn relax_exactly(tiling: &Tiling, [before, isometry]: [f64; 2], mut domains: [Domain; 2]) -> Option<Visited> {
    for _ in 0..DESCENTS {
        follow_gradient(&mut domains);
    }
    SNAPS.iter().find_map(|&snap| {
        let [mut source, mut target] = domains.clone();
        let straight = [straighten(&mut source, tiling, snap)?, straighten(&mut target, tiling, snap)?];
        let after = smooth::energy(&source, &target);
        let [first, second] = straight;
        let relaxed = [Relaxed { domain: source, straight: first }, Relaxed { domain: target, straight: second }];
        (after < before).then(|| (relaxed, (before - after) / (before - isometry)))
    })
}

/// Mean logarithm of the energy per area that the map will come to, told by relaxing every domain coarsely; for telling
/// layouts apart. Infinite where no domain tells anything. Fails on a device error.
pub fn promise(compute: &Compute, meshes: [&TriMesh; 2], embedding: &Embedding) -> Result<f64> {
    let scale = unit_scale(meshes);
    let tilings: Vec<Tiling> = independent_domains(embedding).into_iter().flatten().collect();
    let whole: Vec<[Domain; 2]> = tilings.par_iter().map(|tiling| domains(embedding, tiling, scale)).collect();
    let sketched = climb(compute, whole, SKETCH)?;
    let one = |climb: &Option<Climb>| {
        let Climb { whole, level: [source, target], .. } = climb.as_ref()?;
        let area = whole.each_ref().map(Domain::area).iter().sum::<f64>() * 0.5;
        Some(((smooth::energy(source, target) / area).ln() * area, area))
    };
    let parts: Vec<Option<(f64, f64)>> = sketched.par_iter().map(one).collect();
    let (energy, area) = parts.iter().flatten().fold((0.0, 0.0), |(e, a), (energy, area)| (e + energy, a + area));
    Ok(if area > 0.0 { energy / area } else { f64::INFINITY })
}

/// Moves either mesh's vertices over the other by the gradient of the energy; returns the energy before, None if it did
/// not fall.
fn follow_gradient([source, target]: &mut [Domain; 2]) -> Option<f64> {
    let first = descend(source, target);
    first.or(descend(target, source))
}

/// Moves one mesh's vertices over the other; returns the energy before if it fell.
fn descend(moving: &mut Domain, fixed: &Domain) -> Option<f64> {
    let mut smoother = Smoother::new(moving, fixed);
    let before = smoother.energy();
    sweep_exactly(&mut smoother);
    smoother.look();
    newton(&mut smoother);
    smoother.settle();
    (smoother.energy() < before).then_some(before)
}

fn patch_domain(embedding: &Embedding, p: PatchId, k: usize, scale: f64) -> Domain {
    let mesh = &embedding.meshes[k];
    Domain::of_patch(&mesh.discs[p], &|v: VertexId| -> DVec3 { mesh.cut.positions[v] * scale })
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
    apart(tilings, base.patches.len())
}

/// Groups of domains that share no patch.
fn apart(tilings: Vec<Tiling>, patches: usize) -> Vec<Vec<Tiling>> {
    let mut groups: Vec<(IdVec<PatchId, bool>, Vec<Tiling>)> = Vec::new();
    for tiling in tilings {
        let free = |used: &IdVec<PatchId, bool>| tiling.tiles.iter().all(|t| !used[t.patch]);
        let at = groups.iter().position(|(used, _)| free(used)).unwrap_or_else(|| {
            groups.push((IdVec::filled(false, patches), Vec::new()));
            groups.len() - 1
        });
        tiling.tiles.iter().for_each(|t| groups[at].0[t.patch] = true);
        groups[at].1.push(tiling);
    }
    groups.into_iter().map(|(_, tilings)| tilings).collect()
}
