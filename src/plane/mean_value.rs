//! Mean value weights: Floater, Mean value coordinates (2003).

use super::patch_disc::PatchDisc;
use glam::DVec3;

/// Weights are kept within this ratio of the largest around their vertex, so that systems stay solvable on slivers.
const WEIGHT_RANGE: f64 = 1e8;

/// The weights of a vertex towards its closed, counter-clockwise ring, from the angles on the surface; largest 1.
pub fn mean_value(v: usize, ring: &[u32], points: &[DVec3]) -> Vec<f64> {
    let spokes: Vec<DVec3> = ring.iter().map(|&j| points[j as usize] - points[v]).collect();
    let n = ring.len();
    let tangents: Vec<f64> = (0..n).map(|i| half_tangent(spokes[i], spokes[(i + 1) % n])).collect();
    let mut weights: Vec<f64> =
        (0..n).map(|i| (tangents[(i + n - 1) % n] + tangents[i]) / spokes[i].length()).collect();
    bound(&mut weights);
    weights
}

/// The sum of the weights from either end, for every pair of vertices at a side of a triangle of the disc. `ends` has the
/// pairs in rising order, the lower vertex first; those at sides that it lacks are left out.
pub fn stiffness(disc: &PatchDisc, ends: &[[u32; 2]], points: &[DVec3]) -> Vec<f64> {
    let mut sums = vec![0.0; ends.len()];
    for t in &disc.triangles {
        let corners = t.map(|v| points[v as usize]);
        let side = |i: usize, j: usize| corners[j % 3] - corners[i];
        let tangents = [0, 1, 2].map(|i| half_tangent(side(i, i + 1), side(i, i + 2)));
        for i in 0..3 {
            let j = (i + 1) % 3;
            if let Ok(k) = ends.binary_search(&[t[i].min(t[j]), t[i].max(t[j])]) {
                sums[k] += (tangents[i] + tangents[j]) / side(i, j).length();
            }
        }
    }
    let mut largest = vec![0.0_f64; disc.vertices.len()];
    for (&[v, w], &sum) in ends.iter().zip(&sums).filter(|(_, sum)| sum.is_finite()) {
        largest[v as usize] = largest[v as usize].max(sum);
        largest[w as usize] = largest[w as usize].max(sum);
    }
    for (&[v, w], sum) in ends.iter().zip(&mut sums) {
        let finite = largest[v as usize].max(largest[w as usize]);
        let largest = if finite > 0.0 { finite } else { 1.0 };
        *sum = if sum.is_finite() { sum.max(largest / WEIGHT_RANGE) } else { largest };
    }
    sums
}

/// The tangent of half the angle between two vectors.
fn half_tangent(u: DVec3, w: DVec3) -> f64 {
    let (sine, product) = (u.cross(w).length(), u.length() * w.length());
    // tan(a/2) = sin a / (1 + cos a) = (1 - cos a) / sin a; the larger denominator is the stable one.
    let cosine = u.dot(w);
    if cosine >= 0.0 { sine / (product + cosine) } else { (product - cosine) / sine }
}

/// Scales weights to a largest of 1 and keeps them within the range; what is not finite counts as largest.
pub fn bound(weights: &mut [f64]) {
    let finite = weights.iter().copied().filter(|w| w.is_finite()).fold(0.0, f64::max);
    let largest = if finite > 0.0 { finite } else { 1.0 };
    for w in weights {
        let scaled = if w.is_finite() { *w / largest } else { 1.0 };
        *w = scaled.max(1.0 / WEIGHT_RANGE);
    }
}
