//! The rows of texels inside a triangle: the CPU twin of [`texels`](super::texels) without the texels outside.
//!
//! Along a row the area beside an edge never falls or never rises, in floating point as well: a difference, a product with
//! a constant and a difference from one keep the order of their argument. So the columns that an edge holds are the first or
//! the last ones, those that all edges hold follow each other, and it is enough to know both ends. They are looked for where
//! the edges cross the row, and verified by the areas that decide for single texels: what comes out is the same.

use super::texels::{FlatTriangle, Texel};
use glam::{BVec4A, Vec4, Vec4Swizzles};
use std::ops::Range;

/// Rows of at most this many texels are tried all at once, which is cheaper than to look for the ends.
pub(super) const NARROW: usize = 4;
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
        let [a, b, c] = self.for_four();
        let mut u = Vec4::splat(first as f32) + CENTRES;
        for piece in line.chunks_mut(4) {
            let weighed = Weighed::new([a.areas(u), b.areas(u), c.areas(u)], t);
            if weighed.is_inside.all() && piece.len() == 4 && piece.iter().all(|texel| texel.covers == 0) {
                piece.iter_mut().enumerate().for_each(|(i, texel)| *texel = weighed.texel(i));
            } else {
                let inside = piece.iter_mut().enumerate().filter(|&(i, _)| weighed.is_inside.test(i));
                inside.for_each(|(i, texel)| weighed.put(i, texel));
            }
            u += 4.0;
        }
    }

    /// Covers those of at most [`NARROW`] texels from column `first` on that lie inside triangle `t`.
    #[inline]
    pub fn cover_narrow(&self, line: &mut [Texel], first: u32, t: u32) {
        let u = Vec4::splat(first as f32) + CENTRES;
        let [at_a, at_b, at_c] = self.for_four().each_ref().map(|edge| edge.areas(u));
        let above = self.edges.above;
        let held = at_a.cmpgt(above.xxxx()) & at_b.cmpgt(above.yyyy()) & at_c.cmpgt(above.zzzz());
        if held.any() {
            let weighed = Weighed::new([at_a, at_b, at_c], t);
            let inside = (held & weighed.is_inside).bitmask();
            let inside = line.iter_mut().enumerate().filter(|&(i, _)| inside >> i & 1 == 1);
            inside.for_each(|(i, texel)| weighed.put(i, texel));
        }
    }

    /// The edges once for each of four texels.
    #[inline]
    fn for_four(&self) -> [RowEdge; 3] {
        let Edges { x, dy, sign, .. } = self.edges;
        [
            RowEdge { rise: self.rise.xxxx(), x: x.xxxx(), dy: dy.xxxx(), sign: sign.xxxx() },
            RowEdge { rise: self.rise.yyyy(), x: x.yyyy(), dy: dy.yyyy(), sign: sign.yyyy() },
            RowEdge { rise: self.rise.zzzz(), x: x.zzzz(), dy: dy.zzzz(), sign: sign.zzzz() },
        ]
    }
}

/// One of the edges beside the texels of a row, the same in all lanes.
struct RowEdge {
    rise: Vec4,
    x: Vec4,
    dy: Vec4,
    sign: Vec4,
}

impl RowEdge {
    /// The areas that four places along the row span with it.
    #[inline]
    fn areas(&self, u: Vec4) -> Vec4 {
        (self.rise - self.dy * (u - self.x)) * self.sign
    }
}

/// From the border of a column to its centre, and to those of the next three.
const CENTRES: Vec4 = Vec4::new(0.5, 1.5, 2.5, 3.5);

/// The weights of a triangle's corners at four texels.
struct Weighed {
    triangle: u32,
    w1: [f32; 4],
    w2: [f32; 4],
    /// Where the triangle has an area.
    is_inside: BVec4A,
}

impl Weighed {
    #[inline]
    fn new([at_a, at_b, at_c]: [Vec4; 3], triangle: u32) -> Weighed {
        let sum = at_a + at_b + at_c;
        let per_sum = Vec4::ONE / sum;
        let is_inside = sum.cmpgt(Vec4::ZERO);
        Weighed { triangle, w1: (at_b * per_sum).to_array(), w2: (at_c * per_sum).to_array(), is_inside }
    }

    #[inline]
    fn texel(&self, i: usize) -> Texel {
        Texel { triangle: self.triangle, covers: 1, w1: self.w1[i], w2: self.w2[i] }
    }

    /// Covers the i-th texel; the first triangle owns it.
    #[inline]
    fn put(&self, i: usize, texel: &mut Texel) {
        if texel.covers == 0 {
            *texel = self.texel(i);
        } else {
            texel.covers += 1;
        }
    }
}
