//! Auxiliary base vertices on boundary loops.
//!
//! Every loop needs three base vertices, so that its rims are sides of proper triangles. Where the landmarks on a loop
//! are fewer, vertices at matching places are added. A loop without any is matched, and turned, by its vertices'
//! distances to a few landmarks near by; between base vertices places match by their share of the length.

use super::extremity::distances;
use super::loop_pairs::pair_by_base_vertices;
use super::rim::{BoundaryLoop, boundary_loops};
use crate::mesh::{IdVec, LandmarkId, TriMesh, VertexId};
use rayon::prelude::*;

/// Base vertices a loop gets at least: the sides of a triangle.
const LEAST_ON_LOOP: usize = 3;
/// Landmarks near each loop whose distances tell its places apart; more cost a front each and add little.
const NEAREST: usize = 8;
/// Places on a loop that are compared when it is turned.
const PLACES: usize = 64;
/// Difference of distances that stands for places on different components, in units of the root of the area.
const APART: f64 = 1e3;

/// Pairs of auxiliary base vertices, source first, for loops that have too few.
///
/// The loops must correspond as far as the base vertices tell ([`pair_by_base_vertices`]), else there are none.
pub fn matching_anchors(meshes: [&TriMesh; 2], base_vertices: [&[VertexId]; 2]) -> Vec<[VertexId; 2]> {
    let loops = [0, 1].map(|k| boundary_loops(meshes[k], base_vertices[k]));
    let Ok(pairs) = pair_by_base_vertices([&loops[0], &loops[1]]) else { return Vec::new() };
    let [source, target] = loops;
    let bare: Vec<usize> = (0..pairs.len()).filter(|&i| pairs[i].is_none()).collect();
    let mut matched: Vec<[BoundaryLoop; 2]> = Vec::new();
    for (one, j) in source.iter().zip(&pairs) {
        matched.extend(j.map(|j| [one.clone(), target[j].clone()]));
    }
    let mut anchors = Vec::new();
    if !bare.is_empty() {
        // Loops without base vertices stand behind the others on both meshes.
        let marks = nearest_landmarks(meshes[0], &source[bare[0]..], base_vertices[0]);
        let signed = [0, 1].map(|k| {
            let sites: Vec<VertexId> = marks.iter().map(|&l| base_vertices[k][l]).collect();
            let bare = if k == 0 { &source[bare[0]..] } else { &target[target.len() - bare.len()..] };
            signatures(meshes[k], bare, &sites)
        });
        for (i, j) in assign(&signed) {
            let pair = [source[bare[0] + i].clone(), target[target.len() - bare.len() + j].clone()];
            let starts = turn([&signed[0][i], &signed[1][j]]);
            let rotated = [0, 1].map(|k| started_at(&pair[k], starts[k]));
            anchors.push([0, 1].map(|k| meshes[k].conn.from(rotated[k].halfedges[0])));
            matched.push(rotated);
        }
    }
    anchors.extend(matched.iter().flat_map(|pair| complete(meshes, pair)));
    anchors
}

/// A bare loop that starts at its half-edge number `first`, with a base vertex there.
fn started_at(bare: &BoundaryLoop, first: usize) -> BoundaryLoop {
    let mut halfedges = bare.halfedges.clone();
    halfedges.rotate_left(first);
    BoundaryLoop { halfedges, stops: vec![(0, LandmarkId(u32::MAX))] }
}

/// The landmarks nearest to each loop, by straight distance to its vertices' mean.
fn nearest_landmarks(mesh: &TriMesh, loops: &[BoundaryLoop], landmarks: &[VertexId]) -> Vec<usize> {
    let mut marks = Vec::new();
    for one in loops {
        let points = one.halfedges.iter().map(|&h| mesh.positions[mesh.conn.from(h)]);
        let centre = points.sum::<glam::DVec3>() / one.halfedges.len() as f64;
        let mut sorted: Vec<(f64, usize)> =
            landmarks.iter().enumerate().map(|(l, &v)| (mesh.positions[v].distance(centre), l)).collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        marks.extend(sorted.into_iter().take(NEAREST).map(|(_, l)| l));
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

fn signatures(mesh: &TriMesh, loops: &[BoundaryLoop], sites: &[VertexId]) -> Vec<Signature> {
    let unit = mesh.area().sqrt();
    let fields: Vec<IdVec<VertexId, f64>> = sites.par_iter().map(|&v| distances(mesh, v, unit)).collect();
    let one = |l: &BoundaryLoop| Signature {
        shares: shares(mesh, l, 0, l.halfedges.len()),
        distances: l.halfedges.iter().map(|&h| fields.iter().map(|d| d[mesh.conn.from(h)]).collect()).collect(),
    };
    loops.iter().map(one).collect()
}

/// The share of the length from half-edge number `from` to number `to` of a loop at each vertex between, both included.
fn shares(mesh: &TriMesh, one: &BoundaryLoop, from: usize, to: usize) -> Vec<f64> {
    let mut walked = vec![0.0];
    for &h in &one.halfedges[from..to] {
        let length = mesh.positions[mesh.conn.from(h)].distance(mesh.positions[mesh.conn.to(h)]);
        walked.push(walked[walked.len() - 1] + length);
    }
    let total = walked[walked.len() - 1];
    walked
        .iter()
        .enumerate()
        .map(|(i, w)| if total > 0.0 { w / total } else { i as f64 / (to - from) as f64 })
        .collect()
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
fn complete(meshes: [&TriMesh; 2], pair: &[BoundaryLoop; 2]) -> Vec<[VertexId; 2]> {
    let missing = LEAST_ON_LOOP.saturating_sub(pair[0].stops.len());
    let room = |k: usize| (0..2).map(|m| spans(&pair[m])[k].1 - spans(&pair[m])[k].0 - 1).min().unwrap_or(0);
    let length = |k: usize| (0..2).map(|m| span_share(meshes[m], &pair[m], k)).sum::<f64>();
    let widest =
        (0..pair[0].stops.len()).filter(|&k| room(k) >= missing).max_by(|&a, &b| length(a).total_cmp(&length(b)));
    let Some(k) = widest.filter(|_| missing > 0) else { return Vec::new() };
    let sides = [0, 1].map(|m| {
        let (from, to) = spans(&pair[m])[k];
        let chosen = evenly(&shares(meshes[m], &pair[m], from, to), missing);
        chosen.into_iter().map(|i| meshes[m].conn.from(pair[m].halfedges[from + i])).collect::<Vec<_>>()
    });
    sides[0].iter().zip(&sides[1]).map(|(&a, &b)| [a, b]).collect()
}

/// The numbers of the first half-edge of every rim and of the one behind its last.
fn spans(one: &BoundaryLoop) -> Vec<(usize, usize)> {
    let ends = one.stops.iter().skip(1).map(|s| s.0).chain([one.halfedges.len()]);
    one.stops.iter().map(|s| s.0).zip(ends).collect()
}

/// The share of a loop's length that rim number `k` takes.
fn span_share(mesh: &TriMesh, one: &BoundaryLoop, k: usize) -> f64 {
    let all = shares(mesh, one, 0, one.halfedges.len());
    let (from, to) = spans(one)[k];
    all[to] - all[from]
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
