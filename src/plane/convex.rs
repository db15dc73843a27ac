//! Convex embeddings of a patch: mean value weights (Floater 2003), re-weighted by stretch (Yoshizawa, Belyaev, Seidel).
//!
//! Every free vertex is a convex combination of its ring, so the embedding in a convex triangle is bijective as long as
//! all weights are positive and no dividing edge exists; whether it is so in floating point is checked exactly.

use super::mean_value::{bound, mean_value, stiffness};
use super::orientation::orientation;
use super::patch_disc::PatchDisc;
use super::progressive::embed_progressively;
use super::stretch::{Frame, e_l2, patch_stretch};
use crate::mesh::metric;
use crate::solve::springs::Springs;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{SparseColMat, Triplet};
use glam::{DVec2, DVec3};

/// Most re-weightings; E_L2 hardly falls after these.
const REWEIGHTINGS: usize = 10;
/// A re-weighting must lower E_L2 by this share for another one to be tried.
const GAIN: f64 = 1e-3;
/// An embedding with a larger E_L2 has shrunk a limb, and is worth the slower way from coarse to fine.
const ACCEPTABLE: f64 = 3.0;

/// Which weights an embedding came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weights {
    /// Mean value, re-weighted by stretch.
    MeanValue,
    /// All ones, re-weighted by stretch: where slivers break the former numerically.
    Uniform,
    /// Those that reproduce an embedding found from coarse to fine, re-weighted by stretch: where a long limb shrinks
    /// below the resolution of floating point with the former two.
    Progressive,
}

/// A linear system over the free vertices of one patch whose pattern never changes.
struct System<'a> {
    disc: &'a PatchDisc,
    rings: &'a [Vec<u32>],
    symbolic: Option<SymbolicLu<usize>>,
}

/// Embeds a patch; positions of free vertices are written, boundary vertices stay. None if no weights give an
/// embedding with exactly positive triangles.
pub fn embed_patch(disc: &mut PatchDisc, points: &[DVec3], frame: &Frame) -> Option<Weights> {
    let rings = disc.rings();
    let all = 0..rings.len();
    let surface = all.clone().map(|v| mean_value(v, &rings[v], points)).collect();
    let mut best = embed_by_rings(disc, &rings, surface, points, frame).map(|e| (Weights::MeanValue, e));
    if best.is_none() {
        let uniform = rings.iter().map(|r| vec![1.0; r.len()]).collect();
        best = embed_by_rings(disc, &rings, uniform, points, frame).map(|e| (Weights::Uniform, e));
    }
    if !best.as_ref().is_some_and(|(_, e)| e.energy <= ACCEPTABLE)
        && let Some(positions) = embed_progressively(disc, &rings, points, frame)
    {
        let flat: Vec<DVec3> = positions.iter().map(|&p| frame.place(p).extend(0.0)).collect();
        let weights = all.map(|v| mean_value(v, &rings[v], &flat)).collect();
        let found = Embedded { energy: energy_of(disc, &positions, points, frame), positions };
        let minimised = embed_by_rings(disc, &rings, weights, points, frame);
        let rivals = [Some(found), minimised].into_iter().flatten().map(|e| (Weights::Progressive, e));
        best = best.into_iter().chain(rivals).min_by(|a, b| a.1.energy.total_cmp(&b.1.energy));
    }
    let (kind, Embedded { positions, .. }) = best?;
    disc.positions = positions;
    Some(kind)
}

/// [`embed_patch`] for a disc of its own, which may be large: on springs, if that embeds it well. A spring pulls at both its
/// ends alike, and the symmetric system takes a quarter of the time. The patches of a map keep the weights by rings, with
/// which the kernels go on.
///
/// Stiffness is divided by a `power` of the stretch at both ends: E_L2 falls most with the root, 0.5; with 1 the vertices
/// near the boundary get more room, as is good for a boundary that is let go next.
pub fn embed_disc(disc: &mut PatchDisc, points: &[DVec3], frame: &Frame, power: f64) -> Option<()> {
    match embed_on_springs(disc, points, frame, power).filter(|e| e.energy <= ACCEPTABLE) {
        Some(embedded) => disc.positions = embedded.positions,
        None => drop(embed_patch(disc, points, frame)?),
    }
    Some(())
}

/// Embeds a patch as near as can be to the places its vertices would like to have: as they wish if no triangle turns over,
/// else by weights that reproduce the wish where the triangles around a vertex are positive. Boundary vertices stay. Where
/// that fails the patch is embedded without regard to wishes; None if that fails too.
pub fn embed_near(
    disc: &mut PatchDisc,
    points: &[DVec3],
    frame: &Frame,
    wishes: &[Option<DVec2>],
    is_fair: &dyn Fn(&[u32; 3]) -> bool,
) -> Option<()> {
    let mut places: Vec<DVec2> = disc.positions.clone();
    let mut is_sound = vec![true; places.len()];
    for v in disc.boundary..places.len() {
        (places[v], is_sound[v]) = wishes[v].map_or((DVec2::ZERO, false), |place| (place, true));
    }
    let granted = is_sound.clone();
    for t in &disc.triangles {
        let corners = t.map(|v| v as usize);
        let plane = corners.map(|v| frame.place(places[v]));
        if !corners.iter().all(|&v| granted[v]) || metric::signed_area(plane) <= 0.0 || !is_fair(t) {
            corners.iter().for_each(|&v| is_sound[v] = false);
        }
    }
    if (disc.boundary..places.len()).all(|v| is_sound[v]) && is_embedded(disc, &places) {
        disc.positions = places;
        return Some(());
    }
    let rings = disc.rings();
    let flat: Vec<DVec3> = places.iter().map(|&p| frame.place(p).extend(0.0)).collect();
    let weights = (0..rings.len()).map(|v| mean_value(v, &rings[v], if is_sound[v] { &flat } else { points }));
    let weights: Vec<Vec<f64>> = weights.collect();
    let solved = System { disc, rings: &rings, symbolic: None }.solve(&weights);
    match solved.filter(|positions| is_embedded(disc, positions)) {
        Some(positions) => disc.positions = positions,
        None => drop(embed_patch(disc, points, frame)?),
    }
    Some(())
}

/// Positions and their E_L2.
struct Embedded {
    positions: Vec<DVec2>,
    energy: f64,
}

fn energy_of(disc: &PatchDisc, positions: &[DVec2], points: &[DVec3], frame: &Frame) -> f64 {
    let placed = PatchDisc { positions: positions.to_vec(), ..disc.clone() };
    e_l2(&patch_stretch(&placed, points, frame), frame.area())
}

/// True if every triangle is exactly positively oriented.
pub fn is_embedded(disc: &PatchDisc, positions: &[DVec2]) -> bool {
    disc.triangles.iter().all(|t| {
        let [a, b, c] = t.map(|v| positions[v as usize]);
        orientation(a, b, c) > 0.0
    })
}

/// The embedding by weights of rings, re-weighted.
fn embed_by_rings(
    disc: &PatchDisc,
    rings: &[Vec<u32>],
    mut weights: Vec<Vec<f64>>,
    points: &[DVec3],
    frame: &Frame,
) -> Option<Embedded> {
    let mut system = System { disc, rings, symbolic: None };
    let first = system.solve(&weights)?;
    minimise_stretch(disc, first, points, frame, |sigma| {
        divide_by_stretch(&mut weights, rings, sigma);
        system.solve(&weights)
    })
}

/// The embedding on springs of mean value stiffness, re-weighted.
fn embed_on_springs(disc: &PatchDisc, points: &[DVec3], frame: &Frame, power: f64) -> Option<Embedded> {
    let springs = Springs::along(&disc.triangles, disc.vertices.len(), disc.boundary)?;
    let mut stiffness = stiffness(disc, springs.ends(), points);
    let first = springs.rest(&stiffness, &disc.positions)?;
    minimise_stretch(disc, first, points, frame, |sigma| {
        let divide = |(s, &[v, w]): (&mut f64, &[u32; 2])| *s /= (sigma[v as usize] * sigma[w as usize]).powf(power);
        stiffness.iter_mut().zip(springs.ends()).for_each(divide);
        springs.rest(&stiffness, &disc.positions)
    })
}

/// Goes on from an embedding to what `reweighted` by the stretch around every vertex becomes of it, as long as E_L2 falls.
fn minimise_stretch(
    disc: &PatchDisc,
    first: Vec<DVec2>,
    points: &[DVec3],
    frame: &Frame,
    mut reweighted: impl FnMut(&[f64]) -> Option<Vec<DVec2>>,
) -> Option<Embedded> {
    let mut trial = PatchDisc { positions: first, ..disc.clone() };
    if !is_embedded(disc, &trial.positions) {
        return None;
    }
    let mut stretch = patch_stretch(&trial, points, frame);
    let mut best = Embedded { positions: trial.positions.clone(), energy: e_l2(&stretch, frame.area()) };
    for _ in 0..REWEIGHTINGS {
        match reweighted(&vertex_stretch(disc, &stretch)) {
            Some(positions) if is_embedded(disc, &positions) => trial.positions = positions,
            _ => break,
        }
        stretch = patch_stretch(&trial, points, frame);
        let (energy, before) = (e_l2(&stretch, frame.area()), best.energy);
        if energy < before {
            best = Embedded { positions: trial.positions.clone(), energy };
        }
        if energy.is_nan() || energy >= before * (1.0 - GAIN) {
            break;
        }
    }
    Some(best)
}

/// Root of the area-weighted mean of the squared stretch around every vertex.
fn vertex_stretch(disc: &PatchDisc, stretch: &[(f64, f64)]) -> Vec<f64> {
    let mut sum = vec![(0.0, 0.0); disc.vertices.len()];
    for (t, &(l, area)) in disc.triangles.iter().zip(stretch) {
        for &v in t {
            let s = &mut sum[v as usize];
            *s = (s.0 + l * area, s.1 + area);
        }
    }
    sum.iter().map(|&(s, a)| if a > 0.0 { (s / a).sqrt() } else { 1.0 }).collect()
}

fn divide_by_stretch(weights: &mut [Vec<f64>], rings: &[Vec<u32>], sigma: &[f64]) {
    for (w, ring) in weights.iter_mut().zip(rings) {
        for (w, &j) in w.iter_mut().zip(ring) {
            *w /= sigma[j as usize];
        }
        bound(w);
    }
}

impl System<'_> {
    /// Solves for the free vertices; None if the factorisation fails.
    fn solve(&mut self, weights: &[Vec<f64>]) -> Option<Vec<DVec2>> {
        let first = self.disc.boundary;
        let free = self.disc.vertices.len() - first;
        let mut positions = self.disc.positions.clone();
        if free == 0 {
            return Some(positions);
        }
        let mut entries = Vec::new();
        let mut rhs = faer::Mat::<f64>::zeros(free, 2);
        for i in 0..free {
            let (ring, w) = (&self.rings[first + i], &weights[first + i]);
            let total: f64 = w.iter().sum();
            entries.push(Triplet { row: i, col: i, val: 1.0 });
            for (&j, &w) in ring.iter().zip(w) {
                let (j, w) = (j as usize, w / total);
                if j < first {
                    rhs[(i, 0)] += w * positions[j].x;
                    rhs[(i, 1)] += w * positions[j].y;
                } else {
                    entries.push(Triplet { row: i, col: j - first, val: -w });
                }
            }
        }
        let matrix = SparseColMat::try_new_from_triplets(free, free, &entries).ok()?;
        if self.symbolic.is_none() {
            self.symbolic = SymbolicLu::try_new(matrix.symbolic()).ok();
        }
        let lu = Lu::try_new_with_symbolic(self.symbolic.clone()?, matrix.as_ref()).ok()?;
        lu.solve_in_place(&mut rhs);
        for i in 0..free {
            positions[first + i] = DVec2::new(rhs[(i, 0)], rhs[(i, 1)]);
        }
        positions.iter().all(|p| p.is_finite()).then_some(positions)
    }
}
