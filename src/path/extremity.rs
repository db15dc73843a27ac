//! Limbs without a landmark: tails, horns, ears that both meshes have but nobody marked.
//!
//! A limb that no landmark pins may end up in different patches of the two layouts, and no relaxation finds its way
//! back: the arcs between would have to sweep over the whole limb. So its tip is found on both meshes and matched. A tip
//! is a local maximum of the summed distance to all landmarks, far from each of them, with little surface around it: the
//! middle of a wide flank is a maximum as well, but no place that anything could be matched to. Where a limb grows is told
//! by the order of the landmarks' distances from its tip. Neither the limb's own length nor the proportions of the body
//! change that order much, and the landmarks beside the middle plane, some nearer to the left and some to the right, tell
//! two ears apart that lie equally far from all others.

use super::front::front;
use crate::mesh::{FaceId, IdVec, TriMesh, VertexId, face_of, metric};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Fewer landmarks cannot tell where a limb grows.
const LEAST_LANDMARKS: usize = 8;
/// A limb reaches at least this far from every landmark, in units of the root of the area; shorter ones do no harm.
const LEAST_REACH: f64 = 0.15;
/// Around a tip there is at most this share of a disc's area. Distances along faces are longer than straight ones, so that
/// flanks have three fifths of it; ears have a quarter to nine twentieths, tails a tenth.
const SLENDER: f64 = 0.5;
/// Radii of the discs in which that holds, as shares of the reach: a knee is slender only from afar.
const RADII: [f64; 2] = [0.5, 1.0];
/// Matching tips disagree at most so much about the order of the landmarks.
const MAX_DISCORD: f64 = 0.06;
/// A match must be better than every other pairing of its two tips by this factor, those aside that are matched already.
const CLEARNESS: f64 = 1.5;
/// Lengths of matching limbs differ at most by this factor.
const MAX_LENGTH_RATIO: f64 = 3.0;
/// A landmark this much farther from a tip than the nearest one counts a quarter of it, in units of the root of the area.
const NEAR: f64 = 0.15;

/// The far end of a limb.
struct Tip {
    vertex: VertexId,
    /// Distance to the nearest landmark.
    reach: f64,
    /// Distance to every landmark.
    distances: Vec<f64>,
}

/// Pairs of tips that clearly correspond, source first.
pub fn matching_tips(meshes: [&TriMesh; 2], landmarks: [&[VertexId]; 2]) -> Vec<[VertexId; 2]> {
    if landmarks[0].len() < LEAST_LANDMARKS || !(0..2).all(|k| has_room(meshes[k], landmarks[k])) {
        return Vec::new();
    }
    let (source, target) = rayon::join(|| tips(meshes[0], landmarks[0]), || tips(meshes[1], landmarks[1]));
    let discords: Vec<Vec<f64>> = source.iter().map(|s| target.iter().map(|t| discord(s, t)).collect()).collect();
    let mut pairs = clear_pairs(&discords, |i, j| {
        let ratio = source[i].reach / target[j].reach;
        (1.0 / MAX_LENGTH_RATIO..=MAX_LENGTH_RATIO).contains(&ratio)
    });
    pairs.sort_unstable();
    pairs.into_iter().map(|[i, j]| [source[i].vertex, target[j].vertex]).collect()
}

/// Pairs of a row and a column whose entry is small and clearly the smallest of both, the smallest first; what is paired
/// rivals nobody any more.
fn clear_pairs(discords: &[Vec<f64>], alike: impl Fn(usize, usize) -> bool) -> Vec<[usize; 2]> {
    let mut rows: Vec<usize> = (0..discords.len()).collect();
    let mut columns: Vec<usize> = (0..discords.first().map_or(0, Vec::len)).collect();
    let mut pairs = Vec::new();
    loop {
        let all = rows.iter().flat_map(|&i| columns.iter().map(move |&j| [i, j]));
        let is_clear = |&[i, j]: &[usize; 2]| {
            let in_row = columns.iter().filter(|&&k| k != j).map(|&k| discords[i][k]);
            let in_column = rows.iter().filter(|&&k| k != i).map(|&k| discords[k][j]);
            let d = discords[i][j];
            d <= MAX_DISCORD && alike(i, j) && in_row.chain(in_column).all(|other| other > CLEARNESS * d)
        };
        let best = all.filter(is_clear).min_by(|&[i, j], &[k, l]| discords[i][j].total_cmp(&discords[k][l]));
        let Some([i, j]) = best else { return pairs };
        pairs.push([i, j]);
        rows.retain(|&k| k != i);
        columns.retain(|&k| k != j);
    }
}

/// True if some vertex lies so far from all landmarks that it can be a tip: one front tells, before one a landmark runs.
fn has_room(mesh: &TriMesh, landmarks: &[VertexId]) -> bool {
    let farthest = front(mesh, landmarks).distance.iter().copied().filter(|d| d.is_finite()).fold(0.0, f64::max);
    farthest >= LEAST_REACH * mesh.area().sqrt()
}

/// How much two tips disagree about which of two landmarks is nearer, from 0 to 1. Every two landmarks count by the smaller
/// of their differences on the two meshes, and near ones more.
fn discord(a: &Tip, b: &Tip) -> f64 {
    let weight = |i: usize| (NEAR + (a.distances[i] - a.reach).min(b.distances[i] - b.reach)).powi(-2);
    let weights: Vec<f64> = (0..a.distances.len()).map(weight).collect();
    let (mut all, mut against) = (0.0, 0.0);
    for i in 0..weights.len() {
        for j in 0..i {
            let [x, y] = [a, b].map(|tip| tip.distances[i] - tip.distances[j]);
            let counts = weights[i] * weights[j] * x.abs().min(y.abs());
            all += counts;
            against += if x * y < 0.0 { counts } else { 0.0 };
        }
    }
    if all > 0.0 { against / all } else { 1.0 }
}

/// The tips of a mesh, those that reach farthest first.
fn tips(mesh: &TriMesh, landmarks: &[VertexId]) -> Vec<Tip> {
    let unit = mesh.area().sqrt();
    let fields: Vec<IdVec<VertexId, f64>> = landmarks.par_iter().map(|&l| distances(mesh, l, unit)).collect();
    let sum: IdVec<VertexId, f64> = mesh.conn.vertices().map(|v| fields.iter().map(|d| d[v]).sum()).collect();
    let is_peak = |v: &VertexId| mesh.conn.outgoing(*v).all(|h| sum[mesh.conn.to(h)] <= sum[*v]);
    let tip = |vertex: VertexId| {
        let distances: Vec<f64> = fields.iter().map(|d| d[vertex]).collect();
        Tip { vertex, reach: distances.iter().copied().fold(f64::INFINITY, f64::min), distances }
    };
    let used = mesh.conn.vertices().filter(|&v| mesh.conn.leaving(v).is_some() && sum[v].is_finite());
    let peaks: Vec<Tip> = used.filter(is_peak).map(tip).filter(|t| t.reach >= LEAST_REACH).collect();
    let with_disc = |tip: Tip| slender_disc(mesh, &tip, unit).map(|disc| (tip, disc));
    let mut slender: Vec<(Tip, Vec<FaceId>)> = peaks.into_par_iter().filter_map(with_disc).collect();
    slender.sort_by(|(a, _), (b, _)| b.reach.total_cmp(&a.reach).then(a.vertex.cmp(&b.vertex)));
    let mut held = IdVec::filled(false, mesh.conn.face_count());
    let mut tips = Vec::new();
    for (tip, disc) in slender {
        if !mesh.conn.outgoing(tip.vertex).any(|h| held[face_of(h)]) {
            disc.into_iter().for_each(|f| held[f] = true);
            tips.push(tip);
        }
    }
    tips
}

/// The faces around a tip as far as it reaches, which other maxima on the same limb lie on, if they are few; none where
/// they meet the boundary: that would leave few as well.
fn slender_disc(mesh: &TriMesh, tip: &Tip, unit: f64) -> Option<Vec<FaceId>> {
    let distance = front(mesh, &[tip.vertex]).distance;
    let disc: Vec<FaceId> = mesh.conn.faces().filter(|&f| distance[f] < tip.reach * unit).collect();
    let is_slender = |share: f64| {
        let radius = share * tip.reach * unit;
        let inside = disc.iter().filter(|&&f| distance[f] < radius);
        inside.map(|&f| metric::area(mesh.triangle(f))).sum::<f64>() <= SLENDER * PI * radius * radius
    };
    let on_boundary = |&f: &FaceId| mesh.face(f).into_iter().any(|v| mesh.conn.is_on_boundary(v));
    (RADII.into_iter().all(is_slender) && !disc.iter().any(on_boundary)).then_some(disc)
}

/// Distance of every vertex from a landmark along the face graph, in units of the root of the area.
pub(super) fn distances(mesh: &TriMesh, landmark: VertexId, unit: f64) -> IdVec<VertexId, f64> {
    let reached = front(mesh, &[landmark]);
    let at = |v: VertexId| {
        let over = |h| {
            let [a, b, c] = mesh.triangle(face_of(h));
            reached.distance[face_of(h)] + mesh.positions[v].distance((a + b + c) / 3.0)
        };
        mesh.conn.outgoing(v).map(over).fold(f64::INFINITY, f64::min) / unit
    };
    let mut field: IdVec<VertexId, f64> = mesh.conn.vertices().map(at).collect();
    field[landmark] = 0.0;
    field
}
