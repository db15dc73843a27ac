//! Marching tetrahedra: a field becomes a closed triangle manifold.
//!
//! A lattice of cubes is split into six tetrahedra each (Kuhn), all around the cube's main diagonal, so that
//! neighbouring cubes agree on their common faces. Every lattice point is inside or outside, never undecided, and a
//! tetrahedron is cut by one triangle or one quad: the result is a closed manifold by construction.
//! Source: Doi, Koide, "An efficient method of triangulating equi-valued surfaces by using tetrahedral cells", 1991.

use super::field::Field;
use glam::{DQuat, DVec3, IVec3};
use std::collections::HashMap;

/// Cells along a leaf of the octree; larger leaves sample space in vain, smaller ones sample their faces twice.
const LEAF: i32 = 8;
/// A vertex keeps this share of its lattice edge away from both ends, so that no triangle collapses to a point.
const END_MARGIN: f64 = 0.02;
/// The six orders in which a path along the cube's edges takes the axes, and whether the tetrahedron of the path is
/// positively oriented.
const PATHS: [([usize; 3], bool); 6] = [
    ([0, 1, 2], true),
    ([1, 2, 0], true),
    ([2, 0, 1], true),
    ([0, 2, 1], false),
    ([2, 1, 0], false),
    ([1, 0, 2], false),
];

/// Where and how finely to look for the surface.
#[derive(Clone, Copy, Debug)]
pub struct Lattice {
    /// Centre of a ball that contains the solid.
    pub centre: DVec3,
    /// Radius of that ball.
    pub radius: f64,
    /// Length of a cube's side.
    pub cell: f64,
    /// Turns the lattice, so that different solids get different triangulations.
    pub turn: DQuat,
}

impl Lattice {
    fn position(&self, at: IVec3) -> DVec3 {
        self.centre + self.turn * (at.as_dvec3() * self.cell)
    }
}

/// The surface of the solid as positions and outward triangles.
pub fn march(field: &Field, lattice: &Lattice) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut marcher =
        Marcher { field, lattice, crossings: HashMap::new(), positions: Vec::new(), triangles: Vec::new() };
    let mut half = LEAF;
    while f64::from(half - LEAF) * lattice.cell < lattice.radius {
        half *= 2;
    }
    marcher.visit(IVec3::splat(-half), 2 * half);
    (marcher.positions, marcher.triangles)
}

struct Marcher<'a> {
    field: &'a Field<'a>,
    lattice: &'a Lattice,
    /// The vertex on a lattice edge, by the edge's lower end and the axes it runs along (one bit each).
    crossings: HashMap<(IVec3, u8), u32>,
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

/// A lattice point of the tetrahedron at hand: where it is, its place in the cube, and its value.
#[derive(Clone, Copy)]
struct Corner {
    at: IVec3,
    axes: u8,
    value: f64,
}

impl Marcher<'_> {
    /// Descends into the cube of `size` cells at `low` unless the surface misses it.
    fn visit(&mut self, low: IVec3, size: i32) {
        let half_diagonal = 0.5 * f64::from(size) * self.lattice.cell * 3f64.sqrt();
        let centre = self.lattice.position(low + IVec3::splat(size / 2));
        if (self.field)(centre).distance.abs() > half_diagonal {
            return;
        }
        if size <= LEAF {
            return self.leaf(low);
        }
        for child in 0..8 {
            self.visit(low + axes_of(child) * (size / 2), size / 2);
        }
    }

    fn leaf(&mut self, low: IVec3) {
        let side = (LEAF + 1) as usize;
        let mut values = Vec::with_capacity(side * side * side);
        for (x, y, z) in cube(LEAF + 1) {
            values.push((self.field)(self.lattice.position(low + IVec3::new(x, y, z))).distance);
        }
        let value = |p: IVec3| values[(p.x as usize * side + p.y as usize) * side + p.z as usize];
        for (x, y, z) in cube(LEAF) {
            let cell = IVec3::new(x, y, z);
            let corner = |axes: u8| Corner { at: low + cell, axes, value: value(cell + axes_of(axes)) };
            let corners: [Corner; 8] = std::array::from_fn(|axes| corner(axes as u8));
            let inside = corners.iter().filter(|c| c.value < 0.0).count();
            if inside != 0 && inside != 8 {
                self.cube(&corners);
            }
        }
    }

    fn cube(&mut self, corners: &[Corner; 8]) {
        for ([i, j, _], positive) in PATHS {
            let path = [0, 1 << i, (1 << i) | (1 << j), 7].map(|axes: usize| corners[axes]);
            self.tetrahedron(path, positive);
        }
    }

    /// Cuts one tetrahedron. Its corners are reordered, inside first; an odd reordering turns the triangles over.
    fn tetrahedron(&mut self, path: [Corner; 4], positive: bool) {
        let mut order = [0, 1, 2, 3];
        order.sort_by_key(|&k: &usize| path[k].value >= 0.0);
        let swaps = (0..4).flat_map(|i| (0..i).map(move |j| (j, i))).filter(|&(j, i)| order[j] > order[i]).count();
        let outward = (swaps % 2 == 0) == positive;
        let corner = order.map(|k| path[k]);
        let mut cut = |i: usize, j: usize| self.crossing(corner[i], corner[j]);
        let polygon = match path.iter().filter(|c| c.value < 0.0).count() {
            1 => vec![cut(0, 1), cut(0, 2), cut(0, 3)],
            2 => vec![cut(0, 2), cut(0, 3), cut(1, 3), cut(1, 2)],
            3 => vec![cut(0, 3), cut(1, 3), cut(2, 3)],
            _ => return,
        };
        for k in 2..polygon.len() {
            let (a, b, c) = (polygon[0], polygon[k - 1], polygon[k]);
            self.triangles.push(if outward { [a, b, c] } else { [a, c, b] });
        }
    }

    /// The vertex where the surface crosses the lattice edge between two corners of one tetrahedron.
    fn crossing(&mut self, a: Corner, b: Corner) -> u32 {
        let (low, high) = if a.axes < b.axes { (a, b) } else { (b, a) };
        let start = low.at + axes_of(low.axes);
        let (positions, lattice) = (&mut self.positions, self.lattice);
        *self.crossings.entry((start, high.axes ^ low.axes)).or_insert_with(|| {
            let share = (low.value / (low.value - high.value)).clamp(END_MARGIN, 1.0 - END_MARGIN);
            positions.push(lattice.position(start).lerp(lattice.position(high.at + axes_of(high.axes)), share));
            (positions.len() - 1) as u32
        })
    }
}

/// The unit steps named by three bits.
fn axes_of(bits: u8) -> IVec3 {
    IVec3::new(i32::from(bits & 1), i32::from(bits >> 1 & 1), i32::from(bits >> 2 & 1))
}

/// All points of a cube of `n` points a side, last coordinate fastest.
fn cube(n: i32) -> impl Iterator<Item = (i32, i32, i32)> {
    (0..n).flat_map(move |x| (0..n).flat_map(move |y| (0..n).map(move |z| (x, y, z))))
}
