//! Ways to lay one base complex on both meshes: traced on one and carried to the other in some order, or grown on both.

use super::carry::{Carried, Carrier};
use super::cluster::BaseVertices;
use super::guided::Lead;
use super::joint::{Grown, grow};
use super::order::{ORDERS, Order, arrange};
use super::take_out::take_out;
use super::trace::{Traced, trace};
use crate::error::{Error, Result};
use crate::mesh::{ArcId, IdVec, LandmarkId, TriMesh};
use crate::path::base_complex::BaseComplex;
use crate::path::cut_mesh::CutMesh;
use crate::path::search::{Anywhere, Searcher, Terminal};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// Least edge nodes while candidates are laid out: they settle which way arcs go, and re-routing smooths them.
pub(super) const SCOUT_NODES: u32 = 1;
/// Candidates longer than the shortest by this factor are dropped: no relaxation makes up for it.
const HOPELESS: f64 = 1.08;

/// How a layout came about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Traced on the source (0) or target (1) and carried to the other mesh.
    Carried(usize, Order),
    /// Grown on both at once, handles opened where the source (0) or target (1) has them shortest.
    Joint(usize),
    /// Along path hypotheses, some of them first.
    Guided(Lead),
    /// By the greedy heuristic.
    Greedy,
}

/// The same arcs on both meshes.
pub struct Candidate {
    /// The base complex.
    pub base: BaseComplex,
    /// Both cut meshes.
    pub cuts: [CutMesh; 2],
    /// How it came about.
    pub way: Way,
    /// How often an arc was put off.
    pub postponed: usize,
    /// Total length of the arcs on both meshes, each relative to the root of the mesh's area.
    pub size: f64,
}

/// The candidates with one set of base vertices that are not hopeless, the shortest first; at least one.
pub fn candidates(meshes: [&TriMesh; 2], set: &BaseVertices) -> Result<Vec<Candidate>> {
    let scouting = Scouting::new(meshes, set, SCOUT_NODES);
    let leads = match meshes[0].conn.euler_characteristic() {
        // Growth starts from bare meshes.
        _ if !set.given[0].is_empty() || !meshes[0].conn.is_closed_and_connected() => 0..0,
        2 => 0..1,
        _ => 0..2,
    };
    let mut all: Vec<Result<Option<Candidate>>> = leads.into_par_iter().map(|k| scouting.grow(k).map(Some)).collect();
    let carried: Vec<Vec<Result<Option<Candidate>>>> =
        [0, 1].par_iter().map(|&k| scouting.carry_all(k, &ORDERS)).collect();
    all.extend(carried.into_iter().flatten());
    let mut failure = None;
    let mut found = Vec::new();
    for candidate in all {
        match candidate {
            Ok(candidate) => found.extend(candidate),
            Err(error) => failure = failure.or(Some(error)),
        }
    }
    let least = found.iter().map(|c| c.size).fold(f64::INFINITY, f64::min);
    found.retain(|c| c.size <= HOPELESS * least);
    found.sort_by(|a, b| a.size.total_cmp(&b.size));
    match failure {
        Some(error) if found.is_empty() => Err(error),
        _ => Ok(found),
    }
}

/// The candidate of VORONOI itself: traced on the source, carried to the target in the order of procedure 1.
pub fn published(meshes: [&TriMesh; 2], set: &BaseVertices, edge_nodes: u32) -> Result<Candidate> {
    let carried = Scouting::new(meshes, set, edge_nodes).carry_all(0, &[Order::Cuts]).pop();
    carried.unwrap_or(Ok(None))?.ok_or_else(|| Error::bug("a layout was given up that has no rival"))
}

/// What all candidates have in common.
struct Scouting<'a> {
    meshes: [&'a TriMesh; 2],
    set: &'a BaseVertices,
    edge_nodes: u32,
    units: [f64; 2],
    /// The size of the shortest candidate so far, as bits, which for positive numbers sort like the numbers.
    best: AtomicU64,
}

impl<'a> Scouting<'a> {
    fn new(meshes: [&'a TriMesh; 2], set: &'a BaseVertices, edge_nodes: u32) -> Self {
        let best = AtomicU64::new(f64::INFINITY.to_bits());
        Scouting { meshes, set, edge_nodes, units: meshes.map(|m| m.area().sqrt()), best }
    }

    /// A layout grown on both meshes at once.
    fn grow(&self, lead: usize) -> Result<Candidate> {
        let BaseVertices { vertices, clusters, .. } = self.set;
        let landmarks = vertices.each_ref().map(Vec::as_slice);
        let Grown { base, cuts } = grow(self.meshes, landmarks, clusters, self.edge_nodes, lead)?;
        Ok(self.candidate(base, cuts, Way::Joint(lead), 0))
    }

    fn candidate(&self, base: BaseComplex, cuts: [CutMesh; 2], way: Way, postponed: usize) -> Candidate {
        let candidate = Candidate::new(self.meshes, base, cuts, way, postponed);
        self.best.fetch_min(candidate.size.to_bits(), Ordering::Relaxed);
        candidate
    }

    /// Traces mesh `from` and carries its arcs to the other one, in the given orders; None for an order that is hopeless.
    fn carry_all(&self, from: usize, orders: &[Order]) -> Vec<Result<Option<Candidate>>> {
        let BaseVertices { vertices, clusters, given, .. } = self.set;
        let to = 1 - from;
        let traced = match trace(self.meshes[from], &vertices[from], &given[from], &clusters[from], self.edge_nodes) {
            Ok(traced) => traced,
            Err(error) => return vec![Err(error)],
        };
        let own = traced.lengths.iter().sum::<f64>() / self.units[from];
        let reference = self.reference_lengths(to, &traced);
        let relative = self.relative_lengths(from, &traced, &reference);
        // What others have reached by now may differ from run to run, but never decides what is kept in the end.
        let best = || f64::from_bits(self.best.load(Ordering::Relaxed));
        let carrier = Carrier {
            source: &traced,
            mesh: self.meshes[to],
            landmarks: &vertices[to],
            given: &given[to],
            edge_nodes: self.edge_nodes,
            reference: &reference,
            enough: &|| (HOPELESS * best() - own) * self.units[to],
        };
        let one = |&order: &Order| {
            let carried = carrier.carry(&arrange(order, &traced, &clusters[to], &relative))?;
            Ok(carried.map(|Carried { cut, postponed }| {
                let mut cuts = [traced.cut.clone(), cut];
                if from == 1 {
                    cuts.swap(0, 1);
                }
                self.candidate(traced.base.clone(), cuts, Way::Carried(from, order), postponed)
            }))
        };
        orders.par_iter().map(one).collect()
    }

    /// The length of every arc on bare mesh `k`; infinite for loops, which could shrink to nothing.
    fn reference_lengths(&self, k: usize, traced: &Traced) -> IdVec<ArcId, f64> {
        let bare = CutMesh::new(self.meshes[k], &self.set.vertices[k], self.edge_nodes);
        let length = |searcher: &mut Searcher, ends: &[LandmarkId; 2]| {
            let [start, goal] = ends.map(|l| Terminal::whole(&bare, bare.landmarks[l]));
            let path = (ends[0] != ends[1]).then(|| searcher.shortest(&bare, &start, &goal, &Anywhere)).flatten();
            path.map_or(f64::INFINITY, |p| p.length)
        };
        let lengths: Vec<f64> = traced.base.arcs.raw.par_iter().map_init(Searcher::default, length).collect();
        IdVec::from_raw(lengths)
    }

    /// The length of every arc relative to the meshes' sizes, summed over both.
    fn relative_lengths(&self, from: usize, traced: &Traced, reference: &IdVec<ArcId, f64>) -> IdVec<ArcId, f64> {
        let relative = |a: ArcId| {
            let own = traced.lengths[a] / self.units[from];
            if reference[a].is_finite() { own + reference[a] / self.units[1 - from] } else { 2.0 * own }
        };
        traced.base.arcs.ids().map(relative).collect()
    }
}

/// Total length of the arcs on both meshes, each relative to the mesh's unit.
fn size(base: &BaseComplex, cuts: &[CutMesh; 2], units: [f64; 2]) -> f64 {
    (0..2).map(|k| cuts[k].arc_lengths(&base.arcs).iter().sum::<f64>() / units[k]).sum()
}

impl Candidate {
    /// A layout and its size.
    pub fn new(meshes: [&TriMesh; 2], base: BaseComplex, cuts: [CutMesh; 2], way: Way, postponed: usize) -> Self {
        let size = size(&base, &cuts, meshes.map(|m| m.area().sqrt()));
        Candidate { base, cuts, way, postponed, size }
    }

    /// The same with the first `lasting` base vertices, and others only where the layout cannot do without.
    pub fn keep(mut self, meshes: [&TriMesh; 2], lasting: usize) -> Result<Self> {
        if lasting < self.base.landmarks {
            self.base = take_out(meshes, &mut self.cuts, self.base, lasting)?;
            self.size = size(&self.base, &self.cuts, meshes.map(|m| m.area().sqrt()));
        }
        Ok(self)
    }
}
