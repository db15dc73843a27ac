//! Triangulation of a disc between arcs by the diagonals of least total length.
//!
//! Dynamic programming over the intervals of the boundary walk: G. Klincsek, "Minimal triangulations of polygonal
//! domains" (1980). Time grows with the cube of the number of corners, memory with its square.

use crate::mesh::{ArcId, IdVec, LandmarkId};
use crate::path::base_complex::{BaseComplex, DirectedArc};

/// Added to the length of a diagonal between corners at one landmark, so that loops come only where nothing else can.
const LOOP: f64 = 1e3;

/// A disc bounded by arcs: its boundary walk, with the disc at its left.
pub struct Polygon<'a> {
    /// The arcs around it; corner `i` is where side `i` starts.
    pub walk: &'a [DirectedArc],
    /// The landmark at every corner.
    pub landmarks: &'a [LandmarkId],
    /// The length of the diagonal between two corners.
    pub length: &'a dyn Fn(usize, usize) -> f64,
}

/// The base complex of a polygon that is all of a surface, its sides glued; `arcs` are the sides.
///
/// The diagonals get the numbers behind the sides, the shorter ones first.
pub fn triangulate(polygon: &Polygon, arcs: &IdVec<ArcId, [LandmarkId; 2]>, landmarks: usize) -> BaseComplex {
    let n = polygon.walk.len();
    let split = best_splits(polygon);
    let mut triangles = Vec::new();
    let mut stack = vec![(0, n - 1)];
    while let Some((i, j)) = stack.pop() {
        if j > i + 1 {
            let k = split[i * n + j];
            triangles.push([i, k, j]);
            stack.extend([(i, k), (k, j)]);
        }
    }
    let mut diagonals: Vec<(usize, usize)> = triangles.iter().map(|&[i, _, j]| (i, j)).skip(1).collect();
    diagonals.sort_by(|a, b| (polygon.length)(a.0, a.1).total_cmp(&(polygon.length)(b.0, b.1)).then(a.cmp(b)));
    let mut base = BaseComplex { landmarks, arcs: arcs.clone(), patches: IdVec::default() };
    let mut diagonal_of = vec![ArcId(u32::MAX); n * n];
    for (i, j) in diagonals {
        diagonal_of[i * n + j] = base.arcs.push([polygon.landmarks[i], polygon.landmarks[j]]);
    }
    let side = |a: usize, b: usize| match (a, b) {
        _ if b == (a + 1) % n => polygon.walk[a],
        _ if a < b => DirectedArc { arc: diagonal_of[a * n + b], reversed: false },
        _ => DirectedArc { arc: diagonal_of[b * n + a], reversed: true },
    };
    let mut patches: Vec<[DirectedArc; 3]> = Vec::with_capacity(triangles.len());
    for [i, k, j] in triangles {
        let mut sides = [side(i, k), side(k, j), side(j, i)];
        let first = (0..3).min_by_key(|&s| sides[s]).unwrap_or(0);
        sides.rotate_left(first);
        patches.push(sides);
    }
    patches.sort();
    base.patches = IdVec::from_raw(patches);
    base
}

/// For every interval of corners `i` to `j`, at `i * n + j`, the corner between that makes the shortest triangulation.
fn best_splits(polygon: &Polygon) -> Vec<usize> {
    let n = polygon.walk.len();
    let weight = |i: usize, j: usize| {
        let is_side = j == i + 1 || (i == 0 && j == n - 1);
        let is_loop = polygon.landmarks[i] == polygon.landmarks[j];
        if is_side { 0.0 } else { (polygon.length)(i, j) + if is_loop { LOOP } else { 0.0 } }
    };
    let mut least = vec![0.0f64; n * n];
    let mut split = vec![0; n * n];
    for width in 2..n {
        for i in 0..n - width {
            let j = i + width;
            let total = |k: usize| least[i * n + k] + least[k * n + j];
            let k = (i + 1..j).min_by(|&a, &b| total(a).total_cmp(&total(b))).unwrap_or(i + 1);
            split[i * n + j] = k;
            least[i * n + j] = total(k) + weight(i, j);
        }
    }
    split
}
