//! A surface with fewer triangles that stands in for a large one in a page.
//!
//! Vertices are clustered by cells of a grid and by the direction that the surface faces, and every cluster keeps one vertex of
//! its own, so that whatever vertices have, such as their image, holds for the stand-in. After J. Rossignac, P. Borrel,
//! "Multi-resolution 3D approximations for rendering complex scenes" (1993).

use super::surface::{IN_PARTS, Surface};
use glam::DVec3;
use std::collections::{HashMap, HashSet};

/// Triangles of all surfaces of a page together; from there on stand-ins are shown. More makes pages of tens of megabytes
/// that browsers open slowly.
pub const MOST_TRIANGLES: usize = 300_000;
/// Cells along a side of the finest grid that is tried, and rounds of the search for the right one.
const FINEST: f64 = 4096.0;
const ROUNDS: usize = 14;

/// Replaces surfaces by stand-ins where all together have more than `most` triangles; true if that was needed.
///
/// Every surface gets its share of the triangles. Lines, texture coordinates and values of the triangles stay.
pub fn stand_in(surfaces: &mut [Surface], most: usize) -> bool {
    let all: usize = surfaces.iter().map(|s| s.triangles.len()).sum();
    if all <= most {
        return false;
    }
    for surface in surfaces {
        let share = (surface.triangles.len() as f64 / all as f64 * most as f64) as usize;
        *surface = simpler(surface, share);
    }
    true
}

/// The stand-in on the finest grid that leaves at most so many triangles.
fn simpler(surface: &Surface, most: usize) -> Surface {
    let normals = normals(surface);
    let (mut coarse, mut fine) = (1.0f64, FINEST);
    for _ in 0..ROUNDS {
        let cells = (coarse * fine).sqrt();
        let kept = kept_triangles(surface, &clusters(surface, &normals, cells)).len();
        if kept <= most { coarse = cells } else { fine = cells }
    }
    let clusters = clusters(surface, &normals, coarse);
    let kept = kept_triangles(surface, &clusters);
    rebuilt(surface, &clusters, &kept)
}

/// Normals at vertices in the first space, of any length.
fn normals(surface: &Surface) -> Vec<DVec3> {
    let places = &surface.places[0];
    let mut normals = vec![DVec3::ZERO; places.len()];
    for t in &surface.triangles {
        let [a, b, c] = t.map(|v| places[v as usize]);
        t.iter().for_each(|&v| normals[v as usize] += (b - a).cross(c - a));
    }
    normals
}

/// The vertex that stands for each vertex: in every cell and octant of directions the one nearest to their mean.
fn clusters(surface: &Surface, normals: &[DVec3], cells: f64) -> Vec<u32> {
    let places = &surface.places[0];
    let cell = |v: usize| {
        let at = ((places[v] + 1.0) * 0.5 * cells).as_ivec3();
        let octant = (0..3).fold(0u8, |o, k| o << 1 | u8::from(normals[v][k] > 0.0));
        (at, octant)
    };
    let mut number = HashMap::new();
    let of: Vec<usize> = (0..places.len())
        .map(|v| {
            let next = number.len();
            *number.entry(cell(v)).or_insert(next)
        })
        .collect();
    let mut sums = vec![(DVec3::ZERO, 0.0); number.len()];
    of.iter().zip(places).for_each(|(&c, &p)| sums[c] = (sums[c].0 + p, sums[c].1 + 1.0));
    let mut nearest = vec![(f64::INFINITY, 0u32); number.len()];
    for (v, (&c, &p)) in (0u32..).zip(of.iter().zip(places)) {
        let distance_sq = p.distance_squared(sums[c].0 / sums[c].1);
        if distance_sq < nearest[c].0 {
            nearest[c] = (distance_sq, v);
        }
    }
    of.into_iter().map(|c| nearest[c].1).collect()
}

/// The triangles that keep three corners, each once.
fn kept_triangles(surface: &Surface, clusters: &[u32]) -> Vec<usize> {
    let mut seen = HashSet::new();
    let is_kept = |&i: &usize| {
        let mut t = surface.triangles[i].map(|v| clusters[v as usize]);
        t.sort_unstable();
        t[0] != t[1] && t[1] != t[2] && seen.insert(t)
    };
    (0..surface.triangles.len()).filter(is_kept).collect()
}

fn rebuilt(surface: &Surface, clusters: &[u32], kept: &[usize]) -> Surface {
    let mut used: Vec<u32> = kept.iter().flat_map(|&i| surface.triangles[i]).map(|v| clusters[v as usize]).collect();
    used.sort_unstable();
    used.dedup();
    let number = |v: u32| used.partition_point(|&u| u < clusters[v as usize]) as u32;
    let first_part = |i: usize| {
        let at = surface.parts.partition_point(|part| (part.triangle as usize) < i);
        surface.parts.get(at).map_or(0, |part| part.patch)
    };
    let patch = |&i: &usize| if surface.patches[i] == IN_PARTS { first_part(i) } else { surface.patches[i] };
    let known = |i: usize| surface.numbers.get(i).copied().unwrap_or(i as u32);
    let place_of = |t: &u32| kept.binary_search(&(*t as usize)).ok().map(|i| i as u32);
    Surface {
        places: surface.places.iter().map(|places| used.iter().map(|&v| places[v as usize]).collect()).collect(),
        triangles: kept.iter().map(|&i| surface.triangles[i].map(number)).collect(),
        numbers: kept.iter().map(|&i| known(i)).collect(),
        values: kept.iter().map(|&i| surface.values[i]).collect(),
        patches: if surface.patches.is_empty() { Vec::new() } else { kept.iter().map(patch).collect() },
        parts: Vec::new(),
        uv: if surface.uv.is_empty() { Vec::new() } else { kept.iter().map(|&i| surface.uv[i]).collect() },
        flips: surface.flips.iter().filter_map(place_of).collect(),
        stands_for: Some([surface.places[0].len(), surface.triangles.len()]),
        name: surface.name.clone(),
        spaces: surface.spaces.clone(),
        lines: surface.lines.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A closed band of `n` by 8 squares around a cylinder, with a second place above every vertex.
    fn band(n: u32) -> Surface {
        let at = |i: u32, j: u32| (i % n) * 9 + j;
        let place = |v: u32| {
            let angle = f64::from(v / 9) / f64::from(n) * std::f64::consts::TAU;
            DVec3::new(angle.cos() * 0.7, f64::from(v % 9) / 8.0 - 0.5, angle.sin() * 0.7)
        };
        let places: Vec<DVec3> = (0..9 * n).map(place).collect();
        let square = |i, j| [[at(i, j), at(i, j + 1), at(i + 1, j)], [at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]];
        let triangles: Vec<_> = (0..n).flat_map(|i| (0..8).flat_map(move |j| square(i, j))).collect();
        Surface {
            spaces: vec!["source", "target"],
            places: vec![places.clone(), places.iter().map(|p| *p * 0.5).collect()],
            values: vec![[1.0; 3]; triangles.len()],
            patches: (0..triangles.len() as u32).map(|i| i % 3).collect(),
            triangles,
            ..Surface::default()
        }
    }

    #[test]
    fn a_stand_in_keeps_vertices_with_their_images_and_what_triangles_know() {
        let given = band(900);
        let mut shown = [given.clone(), band(60)];
        assert!(stand_in(&mut shown, 6000));
        let total: usize = shown.iter().map(|s| s.triangles.len()).sum();
        assert!(total <= 6000 && total > 1500, "{total} triangles");
        let [large, _] = &shown;
        assert_eq!(large.stands_for, Some([8100, 14400]));
        for (p, q) in large.places[0].iter().zip(&large.places[1]) {
            assert!(given.places[0].contains(p) && *q == *p * 0.5);
        }
        for (i, t) in large.triangles.iter().enumerate() {
            assert!(t.iter().all(|&v| (v as usize) < large.places[0].len()));
            assert_eq!(large.patches[i], large.numbers[i] % 3);
        }
    }

    #[test]
    fn what_is_small_enough_is_left_alone() {
        let mut shown = [band(10)];
        assert!(!stand_in(&mut shown, 160) && shown[0].stands_for.is_none());
    }
}
