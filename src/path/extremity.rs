//! Limbs without a landmark: tails, horns, ears that both meshes have but nobody marked.
//!
//! A limb that no landmark pins may end up in different patches of the two layouts, and no relaxation finds its way
//! back: the arcs between would have to sweep over the whole limb. So its tip is found on both meshes and matched. A tip
//! is a local maximum of the summed distance to all landmarks, far from each of them. Where its limb grows is told by
//! its distances to all landmarks less the smallest of them: the limb's own length drops out, so that a long tail is
//! matched with a short one, and all bumps along one limb look alike.

use super::front::front;
use crate::mesh::{IdVec, TriMesh, VertexId, face_of};
use rayon::prelude::*;

/// Fewer landmarks cannot tell where a limb grows.
const LEAST_LANDMARKS: usize = 8;
/// A limb reaches at least this far from every landmark, in units of the root of the area; shorter ones do no harm.
const LEAST_REACH: f64 = 0.2;
/// Tips of one mesh whose signatures differ by less sit on one limb; in the mean, in the same unit.
const SAME_LIMB: f64 = 0.08;
/// The signatures of matching tips differ by at most this much.
const MAX_DIFFERENCE: f64 = 0.1;
/// A match must be better than every other pairing of its two tips by this factor.
const CLEARNESS: f64 = 1.5;
/// Lengths of matching limbs differ at most by this factor.
const MAX_LENGTH_RATIO: f64 = 3.0;

/// The far end of a limb.
struct Tip {
    vertex: VertexId,
    reach: f64,
    signature: Vec<f64>,
}

/// Pairs of tips that clearly correspond, source first.
pub fn matching_tips(meshes: [&TriMesh; 2], landmarks: [&[VertexId]; 2]) -> Vec<[VertexId; 2]> {
    if landmarks[0].len() < LEAST_LANDMARKS || !(0..2).all(|k| has_room(meshes[k], landmarks[k])) {
        return Vec::new();
    }
    let (source, target) = rayon::join(|| tips(meshes[0], landmarks[0]), || tips(meshes[1], landmarks[1]));
    let difference: Vec<Vec<f64>> = source.iter().map(|s| target.iter().map(|t| differ(s, t)).collect()).collect();
    let mut pairs = Vec::new();
    for (i, row) in difference.iter().enumerate() {
        for (j, &d) in row.iter().enumerate() {
            let in_row = row.iter().enumerate().filter(|&(k, _)| k != j).map(|(_, &x)| x);
            let in_column = (0..source.len()).filter(|&k| k != i).map(|k| difference[k][j]);
            let ratio = source[i].reach / target[j].reach;
            let alike = (1.0 / MAX_LENGTH_RATIO..=MAX_LENGTH_RATIO).contains(&ratio);
            if alike && d <= MAX_DIFFERENCE && in_row.chain(in_column).all(|other| other > CLEARNESS * d) {
                pairs.push([source[i].vertex, target[j].vertex]);
            }
        }
    }
    pairs
}

/// True if some vertex lies so far from all landmarks that it can be a tip: one front tells, before one a landmark runs.
fn has_room(mesh: &TriMesh, landmarks: &[VertexId]) -> bool {
    let farthest = front(mesh, landmarks).distance.iter().copied().filter(|d| d.is_finite()).fold(0.0, f64::max);
    farthest >= LEAST_REACH * mesh.area().sqrt()
}

/// Mean difference of two signatures.
fn differ(a: &Tip, b: &Tip) -> f64 {
    let sum: f64 = a.signature.iter().zip(&b.signature).map(|(x, y)| (x - y).abs()).sum();
    sum / a.signature.len() as f64
}

/// The tips of a mesh, those that reach farthest first.
fn tips(mesh: &TriMesh, landmarks: &[VertexId]) -> Vec<Tip> {
    let unit = mesh.area().sqrt();
    let fields: Vec<IdVec<VertexId, f64>> = landmarks.par_iter().map(|&l| distances(mesh, l, unit)).collect();
    let sum: IdVec<VertexId, f64> = mesh.conn.vertices().map(|v| fields.iter().map(|d| d[v]).sum()).collect();
    let is_peak = |v: &VertexId| mesh.conn.outgoing(*v).all(|h| sum[mesh.conn.to(h)] <= sum[*v]);
    let tip = |vertex: VertexId| {
        let reach = fields.iter().map(|d| d[vertex]).fold(f64::INFINITY, f64::min);
        Tip { vertex, reach, signature: fields.iter().map(|d| d[vertex] - reach).collect() }
    };
    let used = mesh.conn.vertices().filter(|&v| mesh.conn.leaving(v).is_some() && sum[v].is_finite());
    let mut peaks: Vec<Tip> = used.filter(is_peak).map(tip).filter(|t| t.reach >= LEAST_REACH).collect();
    peaks.sort_by(|a, b| b.reach.total_cmp(&a.reach).then(a.vertex.cmp(&b.vertex)));
    let mut tips: Vec<Tip> = Vec::new();
    for peak in peaks {
        if tips.iter().all(|t| differ(t, &peak) > SAME_LIMB) {
            tips.push(peak);
        }
    }
    tips
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
