//! The rows of texels inside a triangle: the CPU twin of [`texels`](super::texels) without the texels outside.
//!
//! Along a row the area beside an edge never falls or never rises, in floating point as well: a difference, a product with
//! a constant and a difference from one keep the order of their argument. So the columns that an edge holds are the first or
//! the last ones, those that all edges hold follow each other, and it is enough to know both ends. They are looked for where
//! the edges cross the row, and verified by the areas that decide for single texels: what comes out is the same.

use super::texels::{FlatTriangle, Texel};
use glam::{BVec4A, Vec4};
use std::ops::Range;

/// Rows of at most this many texels are tried one by one, which is cheaper than to look for the ends.
const NARROW: usize = 4;
/// The smallest positive number: areas above its opposite are those from zero on.
const LEAST: f32 = f32::from_bits(1);

/// The edges opposite the three corners of a triangle, in the lanes of vectors and told from their lower ends. What stands
/// in the fourth lane holds everything.
pub(super) struct Edges {
    x: Vec4,
    y: Vec4,
    dx: Vec4,
    dy: Vec4,
    /// 1 for edges that ascend, -1 for the others.
    sign: Vec4,
    /// Areas above this are held.
    above: Vec4,
    /// Edges that hold the first columns of a row, and those that hold the last.
    first: BVec4A,
    last: BVec4A,
    /// Columns by row.
    slope: Vec4,
}

impl Edges {
    #[inline]
    pub fn of(&FlatTriangle { ax, ay, bx, by, cx, cy }: &FlatTriangle) -> Edges {
        let (px, py) = (Vec4::new(bx, cx, ax, 0.0), Vec4::new(by, cy, ay, 0.0));
        let (qx, qy) = (Vec4::new(cx, ax, bx, 0.0), Vec4::new(cy, ay, by, 0.0));
        let ascends = px.cmplt(qx) | (px.cmpeq(qx) & py.cmplt(qy));
        let (x, y) = (Vec4::select(ascends, px, qx), Vec4::select(ascends, py, qy));
        let (dx, dy) = (Vec4::select(ascends, qx, px) - x, Vec4::select(ascends, qy, py) - y);
        let sign = Vec4::select(ascends, Vec4::ONE, Vec4::NEG_ONE);
        let above = Vec4::select(ascends, Vec4::splat(-LEAST), Vec4::ZERO).with_w(-1.0);
        let falls = dy * sign;
        let (first, last) = (falls.cmpgt(Vec4::ZERO), falls.cmplt(Vec4::ZERO));
        Edges { x, y, dx, dy, sign, above, first, last, slope: dx / dy }
    }

    /// The edges as the texels of a row see them.
    #[inline]
    pub fn along(&self, row: u32) -> Row<'_> {
        let down = Vec4::splat(row as f32 + 0.5) - self.y;
        Row { edges: self, rise: self.dx * down, crossing: self.x + self.slope * down }
    }
}

/// The edges beside the texels of a row.
pub(super) struct Row<'a> {
    edges: &'a Edges,
    /// The part of the areas that does not depend on the column.
    rise: Vec4,
    /// About where the edges cross the row; anything where they do not.
    crossing: Vec4,
}

impl Row<'_> {
    /// Twice the areas that the centre of a column's texel spans with the edges, positive inside.
    #[inline]
    fn areas(&self, column: u32) -> Vec4 {
        let Edges { x, dy, sign, .. } = self.edges;
        (self.rise - dy * (Vec4::splat(column as f32 + 0.5) - x)) * sign
    }

    #[inline]
    fn holds(&self, column: u32) -> bool {
        self.areas(column).cmpgt(self.edges.above).all()
    }

    /// Those of some columns that all edges hold.
    #[inline]
    pub fn inside(&self, columns: Range<u32>) -> Range<u32> {
        let Range { start, end } = columns;
        if columns.len() <= NARROW {
            let first = columns.into_iter().find(|&column| self.holds(column)).unwrap_or(end);
            let behind = (first..end).find(|&column| !self.holds(column)).unwrap_or(end);
            return first..behind;
        }
        let low = Vec4::select(self.edges.last, self.crossing, Vec4::NEG_INFINITY).max_element();
        let high = Vec4::select(self.edges.first, self.crossing, Vec4::INFINITY).min_element();
        // The first column with its centre beyond a place.
        let beyond = |x: f32| ((x + 0.5) as u32).clamp(start, end);
        let (first, behind) = (beyond(low), beyond(high));
        let begins = || self.holds(first) && (first == start || !self.holds(first - 1));
        let ends = || self.holds(behind - 1) && (behind == end || !self.holds(behind));
        if first < behind && begins() && ends() { first..behind } else { self.search(start..end) }
    }

    /// The same for edges that hardly cross the row or miss it, by bisection.
    #[cold]
    fn search(&self, columns: Range<u32>) -> Range<u32> {
        (0..3).fold(columns, |Range { start, end }, k| {
            let holds_first = self.edges.first.test(k);
            let is_first = |column: u32| (self.areas(column)[k] > self.edges.above[k]) == holds_first;
            let (mut low, mut high) = (start, end);
            while low < high {
                let middle = low.midpoint(high);
                if is_first(middle) { low = middle + 1 } else { high = middle }
            }
            if holds_first { start..low } else { low..end }
        })
    }

    /// Covers the texels of a row from column `first` on, which lie inside triangle `t`.
    #[inline]
    pub fn cover(&self, line: &mut [Texel], first: u32, t: u32) {
        let Edges { x, dy, sign, .. } = self.edges;
        let [rise, x, dy, sign] = [self.rise, *x, *dy, *sign].map(|v| v.to_array().map(Vec4::splat));
        let mut u = Vec4::splat(first as f32) + Vec4::new(0.0, 1.0, 2.0, 3.0) + 0.5;
        for piece in line.chunks_mut(4) {
            let [at_a, at_b, at_c] = [0, 1, 2].map(|k| (rise[k] - dy[k] * (u - x[k])) * sign[k]);
            let sum = at_a + at_b + at_c;
            let (w1, w2) = ((at_b / sum).to_array(), (at_c / sum).to_array());
            let is_inside = sum.cmpgt(Vec4::ZERO);
            if is_inside.all() && piece.len() == 4 && piece.iter().all(|texel| texel.covers == 0) {
                for (i, texel) in piece.iter_mut().enumerate() {
                    *texel = Texel { triangle: t, covers: 1, w1: w1[i], w2: w2[i] };
                }
            } else {
                for (i, texel) in piece.iter_mut().enumerate().filter(|&(i, _)| is_inside.test(i)) {
                    if texel.covers == 0 {
                        *texel = Texel { triangle: t, covers: 0, w1: w1[i], w2: w2[i] };
                    }
                    texel.covers += 1;
                }
            }
            u += 4.0;
        }
    }
}
