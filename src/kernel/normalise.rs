//! Surfaces brought to where f32 serves them best, patch by patch.

use glam::{DVec2, DVec3};

use crate::mesh::metric;

use super::Lanes;
use super::stretch::Stretch;

/// A surface whose patches (connected components) each lie around the origin and have the area of their embedding, so
/// that stretches are of order one. Each patch is treated alone: what it gets does not depend on its company.
pub(super) struct Normalised {
    /// The surface's vertices after it.
    pub surface: Vec<Lanes>,
    /// The patch of every triangle.
    patch_of: Vec<u32>,
    /// The factor every patch was scaled by.
    scales: Vec<f64>,
}

/// Extent and areas of one patch.
#[derive(Clone, Copy)]
struct Patch {
    low: DVec3,
    high: DVec3,
    flat_area: f64,
    area: f64,
}

impl Normalised {
    /// Triangles name existing vertices; `surface` and `plane` run parallel.
    pub fn new(triangles: &[[u32; 3]], surface: &[DVec3], plane: &[DVec2]) -> Self {
        let (label, count) = components(surface.len(), triangles);
        let nothing = Patch { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY, flat_area: 0.0, area: 0.0 };
        let mut patches = vec![nothing; count];
        for (&patch, &p) in label.iter().zip(surface) {
            let patch = &mut patches[patch as usize];
            (patch.low, patch.high) = (patch.low.min(p), patch.high.max(p));
        }
        let patch_of: Vec<u32> = triangles.iter().map(|t| label[t[0] as usize]).collect();
        for (&patch, t) in patch_of.iter().zip(triangles) {
            let patch = &mut patches[patch as usize];
            patch.flat_area += metric::signed_area(t.map(|v| plane[v as usize])).abs();
            patch.area += metric::area(t.map(|v| surface[v as usize]));
        }
        let scales: Vec<f64> = patches.iter().map(Patch::scale).collect();
        let normalise = |(&patch, &p): (&u32, &DVec3)| {
            let Patch { low, high, .. } = patches[patch as usize];
            let centred = p - (low + high) * 0.5;
            (centred * scales[patch as usize]).as_vec3().extend(0.0).to_array()
        };
        Normalised { surface: label.iter().zip(surface).map(normalise).collect(), patch_of, scales }
    }

    /// The stretches, in triangle order, of the map to the surface as it was.
    pub fn undo(&self, stretches: &[Stretch]) -> Vec<Stretch> {
        let by = |value: f32, factor: f64| (f64::from(value) / factor) as f32;
        let undo = |(s, &patch): (&Stretch, &u32)| {
            let scale = self.scales[patch as usize];
            let (large, small) = (by(s.large, scale), by(s.small, scale));
            Stretch { large, small, area_from: s.area_from, area_to: by(s.area_to, scale * scale) }
        };
        stretches.iter().zip(&self.patch_of).map(undo).collect()
    }
}

impl Patch {
    /// 1 where an area is missing.
    fn scale(&self) -> f64 {
        let ratio = self.flat_area / self.area;
        if ratio > 0.0 && ratio.is_finite() { ratio.sqrt() } else { 1.0 }
    }
}

/// Labels the vertices by connected component, components in the order of their first vertices; returns their number.
fn components(vertices: usize, triangles: &[[u32; 3]]) -> (Vec<u32>, usize) {
    let mut parent: Vec<u32> = (0..vertices as u32).collect();
    for &[a, b, c] in triangles {
        for v in [b, c] {
            let (a, v) = (root(&mut parent, a), root(&mut parent, v));
            // The lower root stays, so that a root is its component's first vertex.
            parent[a.max(v) as usize] = a.min(v);
        }
    }
    let mut label = vec![0; vertices];
    let mut count = 0;
    for v in 0..vertices as u32 {
        let first = root(&mut parent, v);
        label[v as usize] = if first == v { count } else { label[first as usize] };
        count += u32::from(first == v);
    }
    (label, count as usize)
}

/// The root above `v`, shortening the way for the next time.
fn root(parent: &mut [u32], mut v: u32) -> u32 {
    while parent[v as usize] != v {
        parent[v as usize] = parent[parent[v as usize] as usize];
        v = parent[v as usize];
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_are_numbered_by_their_first_vertex() {
        let triangles = [[5, 3, 6], [1, 7, 2], [6, 0, 5]];
        assert_eq!(components(8, &triangles), (vec![0, 1, 1, 0, 2, 0, 0, 1], 3));
    }

    #[test]
    fn every_patch_gets_the_area_of_its_embedding_and_undo_takes_it_back() {
        let flat = [DVec2::ZERO, DVec2::X, DVec2::Y];
        let plane: Vec<DVec2> = flat.iter().chain(&flat).copied().collect();
        let surface: Vec<DVec3> = [(1e6, 3.0), (-7.0, 1e-4)]
            .iter()
            .flat_map(|&(at, size)| flat.map(|p| DVec3::splat(at) + size * p.extend(0.0)))
            .collect();
        let triangles = [[0, 1, 2], [3, 4, 5]];
        let normalised = Normalised::new(&triangles, &surface, &plane);
        for t in triangles {
            let [a, b, c] = t.map(|v| glam::Vec4::from(normalised.surface[v as usize]).truncate().as_dvec3());
            assert!((metric::area([a, b, c]) - 0.5).abs() < 1e-6);
        }
        let one = Stretch { large: 1.0, small: 1.0, area_from: 0.5, area_to: 0.5 };
        let undone = normalised.undo(&[one, one]);
        assert!((undone[0].large - 3.0).abs() < 1e-5 && (undone[0].area_to - 4.5).abs() < 1e-4, "{:?}", undone[0]);
        assert!((undone[1].small - 1e-4).abs() < 1e-9 && undone[1].area_from == 0.5, "{:?}", undone[1]);
    }
}
