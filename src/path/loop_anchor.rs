//! Auxiliary base vertices on boundary loops and on guides.
//!
//! Every loop needs three base vertices, so that its arcs are sides of proper triangles. Where the landmarks on a loop
//! are fewer, vertices at matching places are added. A loop without any is matched, and turned, by its vertices'
//! distances to a few landmarks near by; between base vertices places match by their share of the length.

use super::edge_loop::EdgeLoop;
use super::extremity::distances;
use super::loop_pairs::pair_by_base_vertices;
use super::rim::boundary_loops;
use crate::mesh::{IdVec, TriMesh, VertexId, face_of};
use glam::DVec3;
use rayon::prelude::*;

/// Base vertices a loop gets at least: the sides of a triangle.
const LEAST_ON_LOOP: usize = 3;
/// Landmarks near each loop whose distances tell its places apart; more cost a front each and add little.
const NEAREST: usize = 8;
/// Places on a loop that are compared when it is turned.
const PLACES: usize = 64;
/// Difference of distances that stands for places on different components, in units of the root of the area.
const APART: f64 = 1e3;

/// A loop as vertices in order, and the numbers of its base vertices among them, ascending from 0.
#[derive(Clone)]
struct Ring {
    vertices: Vec<VertexId>,
    stops: Vec<usize>,
}

/// Pairs of auxiliary base vertices, source first, for loops that have too few.
///
/// The loops must correspond as far as the base vertices tell ([`pair_by_base_vertices`]), else there are none.
pub fn matching_anchors(meshes: [&TriMesh; 2], base_vertices: [&[VertexId]; 2]) -> Vec<[VertexId; 2]> {
    let loops = [0, 1].map(|k| boundary_loops(meshes[k], base_vertices[k]));
    let Ok(partners) = pair_by_base_vertices([&loops[0], &loops[1]]) else { return Vec::new() };
    let rings = [0, 1].map(|k| loops[k].iter().map(|l| Ring::new(meshes[k], l)).collect::<Vec<_>>());
    let mut pairs: Vec<[Ring; 2]> = Vec::new();
    for (i, partner) in partners.iter().enumerate() {
        pairs.extend(partner.map(|j| [rings[0][i].clone(), rings[1][j].clone()]));
    }
    // Loops without base vertices stand behind the others on both meshes, and are as many.
    let bare = rings.each_ref().map(|all| &all[pairs.len()..]);
    let signed = sign(meshes, bare, base_vertices);
    let started =
        assign(&signed).into_iter().map(|(i, j)| start([&bare[0][i], &bare[1][j]], [&signed[0][i], &signed[1][j]]));
    anchors(meshes, pairs, started.collect())
}

/// The same for loops that are paired already: those with one number correspond, with the same base vertices on them.
pub fn anchors_between(
    meshes: [&TriMesh; 2],
    loops: [&[EdgeLoop]; 2],
    base_vertices: [&[VertexId]; 2],
) -> Vec<[VertexId; 2]> {
    let rings = |k: usize, bare: bool| {
        let wanted = loops[k].iter().filter(|l| l.stops.is_empty() == bare);
        wanted.map(|l| Ring::new(meshes[k], l)).collect::<Vec<Ring>>()
    };
    let marked: [Vec<Ring>; 2] = [0, 1].map(|k| rings(k, false));
    let bare: [Vec<Ring>; 2] = [0, 1].map(|k| rings(k, true));
    let signed = sign(meshes, bare.each_ref().map(Vec::as_slice), base_vertices);
    let started = (0..bare[0].len()).map(|i| start([&bare[0][i], &bare[1][i]], [&signed[0][i], &signed[1][i]]));
    let [source, target] = marked;
    anchors(meshes, source.into_iter().zip(target).map(|(a, b)| [a, b]).collect(), started.collect())
}

/// Completes all pairs of loops; those that were bare have been started at places that are anchors now.
fn anchors(meshes: [&TriMesh; 2], mut pairs: Vec<[Ring; 2]>, started: Vec<[Ring; 2]>) -> Vec<[VertexId; 2]> {
    let mut anchors: Vec<[VertexId; 2]> = started.iter().map(|pair| pair.each_ref().map(|r| r.vertices[0])).collect();
    pairs.extend(started);
    anchors.extend(pairs.iter().flat_map(|pair| complete(meshes, pair)));
    anchors
}

/// Tells loops without base vertices apart by the landmarks near them.
fn sign(meshes: [&TriMesh; 2], bare: [&[Ring]; 2], base_vertices: [&[VertexId]; 2]) -> [Vec<Signature>; 2] {
    let marks = nearest_landmarks(meshes[0], bare[0], base_vertices[0]);
    [0, 1].map(|k| {
        let sites: Vec<VertexId> = marks.iter().map(|&l| base_vertices[k][l]).collect();
        signatures(meshes[k], bare[k], &sites)
    })
}

/// Lets a pair of loops without base vertices start at places that match, with a base vertex there.
fn start(bare: [&Ring; 2], signed: [&Signature; 2]) -> [Ring; 2] {
    let first = turn(signed);
    [0, 1].map(|k| bare[k].started_at(first[k]))
}

impl Ring {
    fn new(mesh: &TriMesh, one: &EdgeLoop) -> Self {
        let vertices = one.halfedges.iter().map(|&h| mesh.conn.from(h)).collect();
        Ring { vertices, stops: one.stops.iter().map(|s| s.0).collect() }
    }

    /// The same loop from its vertex number `first` on, with a base vertex there.
    fn started_at(&self, first: usize) -> Self {
        let mut vertices = self.vertices.clone();
        vertices.rotate_left(first);
        Ring { vertices, stops: vec![0] }
    }

    /// The numbers of the first vertex of every rim and of the one where it ends.
    fn rims(&self) -> Vec<(usize, usize)> {
        let ends = self.stops.iter().skip(1).copied().chain([self.vertices.len()]);
        self.stops.iter().copied().zip(ends).collect()
    }

    /// The shares of the length from vertex number `from` to number `to` at each vertex on the way, both included.
    fn shares(&self, mesh: &TriMesh, (from, to): (usize, usize)) -> Vec<f64> {
        let at = |i: usize| mesh.positions[self.vertices[i % self.vertices.len()]];
        let mut walked = vec![0.0];
        for i in from..to {
            walked.push(walked[walked.len() - 1] + at(i).distance(at(i + 1)));
        }
        let total = walked[walked.len() - 1];
        let share = |(i, w): (usize, &f64)| if total > 0.0 { w / total } else { i as f64 / (to - from) as f64 };
        walked.iter().enumerate().map(share).collect()
    }
}

/// The landmarks nearest to each loop on its component, by straight distance to the mean of its vertices.
fn nearest_landmarks(mesh: &TriMesh, loops: &[Ring], landmarks: &[VertexId]) -> Vec<usize> {
    let label = mesh.conn.components();
    let component = |v: VertexId| mesh.conn.leaving(v).map(|h| label[face_of(h)]);
    let mut marks = Vec::new();
    for one in loops {
        let centre = one.vertices.iter().map(|&v| mesh.positions[v]).sum::<DVec3>() / one.vertices.len() as f64;
        let here = component(one.vertices[0]);
        let mut near: Vec<(f64, usize)> = (0..landmarks.len())
            .filter(|&l| component(landmarks[l]) == here)
            .map(|l| (mesh.positions[landmarks[l]].distance(centre), l))
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        marks.extend(near.into_iter().take(NEAREST).map(|(_, l)| l));
    }
    marks.sort_unstable();
    marks.dedup();
    marks
}

/// A loop as the shares of its length at its vertices, and each vertex's distances to the landmarks.
struct Signature {
    shares: Vec<f64>,
    distances: Vec<Vec<f64>>,
}

fn signatures(mesh: &TriMesh, loops: &[Ring], sites: &[VertexId]) -> Vec<Signature> {
    let unit = mesh.area().sqrt();
    let fields: Vec<IdVec<VertexId, f64>> = sites.par_iter().map(|&v| distances(mesh, v, unit)).collect();
    let one = |ring: &Ring| Signature {
        shares: ring.shares(mesh, (0, ring.vertices.len())),
        distances: ring.vertices.iter().map(|&v| fields.iter().map(|d| d[v]).collect()).collect(),
    };
    loops.iter().map(one).collect()
}

impl Signature {
    /// The number of the vertex nearest to share `s`.
    fn at(&self, s: f64) -> usize {
        let n = self.distances.len();
        let s = s.rem_euclid(1.0);
        let i = self.shares.partition_point(|&x| x < s).min(n);
        let nearer = if i > 0 && s - self.shares[i - 1] < self.shares[i] - s { i - 1 } else { i };
        nearer % n
    }

    /// The distances in the mean over the loop's vertices.
    fn mean(&self) -> Vec<f64> {
        let n = self.distances.len() as f64;
        (0..self.distances[0].len()).map(|l| self.distances.iter().map(|d| d[l]).sum::<f64>() / n).collect()
    }
}

/// Sum of squared differences; what no front reaches on either mesh counts as equal.
fn differ(a: &[f64], b: &[f64]) -> f64 {
    let one = |(x, y): (&f64, &f64)| match (x.is_finite(), y.is_finite()) {
        (true, true) => (x - y) * (x - y),
        (false, false) => 0.0,
        _ => APART * APART,
    };
    a.iter().zip(b).map(one).sum()
}

/// Assigns the loops of the source to those of the target, most alike first; then exchanges where that is better.
fn assign([source, target]: &[Vec<Signature>; 2]) -> Vec<(usize, usize)> {
    let [a, b] = [source, target].map(|all| all.iter().map(Signature::mean).collect::<Vec<_>>());
    let cost: Vec<Vec<f64>> = a.iter().map(|x| b.iter().map(|y| differ(x, y)).collect()).collect();
    let n = a.len();
    let mut order: Vec<(usize, usize)> = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).collect();
    order.sort_by(|&(i, j), &(k, l)| cost[i][j].total_cmp(&cost[k][l]));
    let mut partner: Vec<Option<usize>> = vec![None; n];
    for (i, j) in order {
        if partner[i].is_none() && !partner.contains(&Some(j)) {
            partner[i] = Some(j);
        }
    }
    let mut pairs: Vec<(usize, usize)> = partner.into_iter().enumerate().filter_map(|(i, j)| Some((i, j?))).collect();
    let crossed =
        |p: (usize, usize), q: (usize, usize)| cost[p.0][q.1] + cost[q.0][p.1] < cost[p.0][p.1] + cost[q.0][q.1];
    while let Some((p, q)) =
        (0..n).flat_map(|p| (0..p).map(move |q| (p, q))).find(|&(p, q)| crossed(pairs[p], pairs[q]))
    {
        (pairs[p].1, pairs[q].1) = (pairs[q].1, pairs[p].1);
    }
    pairs
}

/// The vertices, by number, at which two loops best start together: the one of the source that is nearest to the
/// landmarks, and the one of the target from which all places are most alike.
fn turn([source, target]: [&Signature; 2]) -> [usize; 2] {
    let total = |i: &usize| source.distances[*i].iter().filter(|d| d.is_finite()).sum::<f64>();
    let first = (0..source.distances.len()).min_by(|a, b| total(a).total_cmp(&total(b))).unwrap_or(0);
    let difference = |second: &usize| {
        let place = |k: usize| {
            let s = k as f64 / PLACES as f64;
            let [i, j] = [source.at(source.shares[first] + s), target.at(target.shares[*second] + s)];
            differ(&source.distances[i], &target.distances[j])
        };
        (0..PLACES).map(place).sum::<f64>()
    };
    let costs: Vec<f64> = (0..target.distances.len()).map(|j| difference(&j)).collect();
    let second = (0..costs.len()).min_by(|&a, &b| costs[a].total_cmp(&costs[b])).unwrap_or(0);
    [first, second]
}

/// What a pair of loops with one or two base vertices lacks: vertices that divide its longest rim, or its only one.
fn complete(meshes: [&TriMesh; 2], pair: &[Ring; 2]) -> Vec<[VertexId; 2]> {
    let missing = LEAST_ON_LOOP.saturating_sub(pair[0].stops.len());
    let rims = pair.each_ref().map(Ring::rims);
    let room = |k: usize| rims.iter().map(|r| r[k].1 - r[k].0 - 1).min().unwrap_or(0);
    let length = |k: usize| {
        let share = |m: usize| {
            let all = pair[m].shares(meshes[m], (0, pair[m].vertices.len()));
            all[rims[m][k].1] - all[rims[m][k].0]
        };
        share(0) + share(1)
    };
    let wide = (0..rims[0].len()).filter(|&k| missing > 0 && room(k) >= missing);
    let Some(k) = wide.max_by(|&a, &b| length(a).total_cmp(&length(b))) else { return Vec::new() };
    let [source, target] = [0, 1].map(|m| {
        let chosen = evenly(&pair[m].shares(meshes[m], rims[m][k]), missing);
        chosen.into_iter().map(|i| pair[m].vertices[rims[m][k].0 + i]).collect::<Vec<_>>()
    });
    source.into_iter().zip(target).map(|(a, b)| [a, b]).collect()
}

/// `count` different inner places of a run of ascending shares from 0 to 1, as evenly spread as they come.
fn evenly(shares: &[f64], count: usize) -> Vec<usize> {
    let mut chosen = Vec::with_capacity(count);
    for k in 0..count {
        let wanted = (k + 1) as f64 / (count + 1) as f64;
        let low = chosen.last().map_or(1, |&i| i + 1);
        let high = shares.len() - 1 - (count - k);
        let nearest = (low..=high).min_by(|&i, &j| (shares[i] - wanted).abs().total_cmp(&(shares[j] - wanted).abs()));
        chosen.extend(nearest);
    }
    chosen
}
