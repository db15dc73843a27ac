//! How much the shape of a triangle counts: the more, the nearer it is to a feature (WARP 4.4: 1 / d_f^2).

use super::sheet::Sheet;
use crate::solve::nearest::Nearest;
use std::collections::BinaryHeap;

/// Distances below this share of the greatest count as that: else the triangles at features would be all that counts.
const LEAST: f64 = 0.4;

/// A weight for every triangle, 1 at the features and `LEAST` squared where it is farthest from any; all 1 without
/// features.
pub fn near_features(sheet: &Sheet) -> Vec<f64> {
    let distance = distances(sheet);
    let greatest = distance.iter().copied().filter(|d| d.is_finite()).fold(0.0, f64::max);
    if greatest == 0.0 {
        return vec![1.0; sheet.triangles.len()];
    }
    let least = LEAST * greatest;
    let weigh = |corners: &[u32; 3]| {
        let mean = corners.iter().map(|&v| distance[v as usize].min(greatest)).sum::<f64>() / 3.0;
        (least / mean.max(least)).powi(2)
    };
    sheet.triangles.iter().map(weigh).collect()
}

/// The way along edges from every vertex to the nearest feature.
fn distances(sheet: &Sheet) -> Vec<f64> {
    let mut beside = vec![Vec::new(); sheet.points.len()];
    for &[a, b, c] in &sheet.triangles {
        for (v, w) in [(a, b), (b, c), (c, a)] {
            let length = sheet.points[v as usize].distance(sheet.points[w as usize]);
            beside[v as usize].push((w, length));
            beside[w as usize].push((v, length));
        }
    }
    let mut distance = vec![f64::INFINITY; sheet.points.len()];
    let mut queue: BinaryHeap<Nearest<u32>> = sheet.features.iter().map(|f| Nearest(0.0, f.vertex)).collect();
    sheet.features.iter().for_each(|f| distance[f.vertex as usize] = 0.0);
    while let Some(Nearest(d, v)) = queue.pop() {
        if d > distance[v as usize] {
            continue;
        }
        for &(w, length) in &beside[v as usize] {
            if d + length < distance[w as usize] {
                distance[w as usize] = d + length;
                queue.push(Nearest(d + length, w));
            }
        }
    }
    distance
}
