//! The CPU twin of the sweep kernel, a register of vertices at a time.
//!
//! What the triangles around four vertices need is gathered once, number by number, and stays in the innermost cache while
//! the step is found and tried. A fan shorter than the longest of them is filled up with one of its own triangles, which
//! is looked at and not counted. Every vertex has its numbers added in the order of its fan, so the company it is in
//! changes no bit.

use glam::{BVec4A, Mat4, Vec4};
use rayon::prelude::*;

use super::Lanes;
use super::sweep::{FOLDED, Moving, SAFE_SHARE, Sight, TRIES};

/// Vertices that go together.
const WIDTH: usize = 4;
/// Vertices a thread takes at once; those with as many triangles go together.
const GRAIN: usize = 256;

/// A number for every vertex.
type Row = Vec4;
/// A vector for every vertex, by coordinate.
type Rows = [Row; 2];

/// Moves the vertices, each of which has triangles and none of which are neighbours.
pub fn reference(vertices: &[u32], moving: &mut Moving) {
    let mut moved = vec![Lanes::default(); vertices.len()];
    let at_rest: &Moving = moving;
    let pieces = vertices.par_chunks(GRAIN).zip(moved.par_chunks_mut(GRAIN));
    pieces.for_each(|(vertices, moved)| improve(at_rest, vertices, moved));
    for (&v, p) in vertices.iter().zip(moved) {
        moving.positions[v as usize] = p;
    }
}

/// Where the vertices go.
fn improve(moving: &Moving, vertices: &[u32], moved: &mut [Lanes]) {
    let mut order: Vec<usize> = (0..vertices.len()).collect();
    order.sort_by_key(|&k| moving.fans.of(vertices[k] as usize).len());
    let mut company = Company::default();
    for places in order.chunks(WIDTH) {
        // A last company that is too small is filled up with its first.
        let of = |i: usize| vertices[*places.get(i).unwrap_or(&places[0])] as usize;
        company.gather(moving, std::array::from_fn(of));
        let to = company.improved();
        places.iter().zip(to).for_each(|(&k, p)| moved[k] = p);
    }
}

/// A triangle at every vertex, seen from there: `next` and `last` are its other corners, counter-clockwise.
#[derive(Clone, Copy, Default)]
struct Wedge {
    /// Whose triangle counts.
    counts: BVec4A,
    /// The first parts of the ways from the vertex to the other corners.
    next: Rows,
    last: Rows,
    /// The second parts of the other corners.
    next_moved: Rows,
    last_moved: Rows,
    /// From the next corner to the last.
    side: Rows,
    /// How much the two columns of the map have of the ways to the next corner, to the last, and of the side.
    columns: [[Row; 3]; 2],
    /// How much they have of the vertex.
    by: Rows,
    /// The metrics, see [`Sight`].
    sum: [Row; 3],
    inverse: [Row; 3],
}

/// Vertices that go together.
#[derive(Default)]
struct Company {
    /// Where they are, both parts.
    here: [Rows; 2],
    /// Their triangles, first ones first.
    wedges: Vec<Wedge>,
}

impl Company {
    fn gather(&mut self, moving: &Moving, vertices: [usize; WIDTH]) {
        let fans = vertices.map(|v| moving.fans.of(v));
        let here = vertices.map(|v| Vec4::from_array(moving.positions[v]));
        let [x, y, dx, dy] = transposed(here);
        self.here = [[x, y], [dx, dy]];
        let longest = fans.iter().map(|fan| fan.len()).max().unwrap_or(0);
        self.wedges.resize(longest, Wedge::default());
        for (k, wedge) in self.wedges.iter_mut().enumerate() {
            let counts = fans.map(|fan| k < fan.len());
            wedge.counts = BVec4A::from_array(counts);
            wedge.gather(moving, fans.map(|fan| *fan.get(k).unwrap_or(&fan[0])), here);
        }
    }

    /// Where the vertices go.
    fn improved(&self) -> [Lanes; WIDTH] {
        let [at_first, here] = self.here;
        let step = self.newton();
        let before = self.energy(here);
        let mut share = self.safe_share(step);
        let (mut to, mut is_done) = (here, BVec4A::FALSE);
        for _ in 0..TRIES {
            let tried = [0, 1].map(|m| here[m] + share * step[m]);
            let falls = !is_done & self.energy(tried).cmplt(before);
            to = [0, 1].map(|m| Vec4::select(falls, tried[m], to[m]));
            is_done |= falls;
            if is_done.all() {
                break;
            }
            share *= 0.5;
        }
        transposed([at_first[0], at_first[1], to[0], to[1]]).map(|p| p.to_array())
    }

    /// The Newton steps of the energies of the fans; zero where there is none.
    fn newton(&self) -> Rows {
        let [mut gx, mut gy, mut xx, mut xy, mut yy] = [Vec4::ZERO; 5];
        for wedge in &self.wedges {
            let Slopes { gradient, hessian } = wedge.slopes(wedge.ways(self.here[1]));
            let count = |sum: &mut Row, more: Row| *sum = Vec4::select(wedge.counts, *sum + more, *sum);
            count(&mut gx, gradient[0]);
            count(&mut gy, gradient[1]);
            count(&mut xx, hessian[0]);
            count(&mut xy, hessian[1]);
            count(&mut yy, hessian[2]);
        }
        let det = xx * yy - xy * xy;
        // Also false for NaN.
        let is_convex = det.cmpgt(Vec4::ZERO);
        [(xy * gy - yy * gx) / det, (xy * gx - xx * gy) / det].map(|s| Vec4::select(is_convex, s, Vec4::ZERO))
    }

    /// The energies of the fans with the second parts of their vertices at `moved`.
    fn energy(&self, moved: Rows) -> Row {
        let mut sum = Vec4::ZERO;
        for wedge in &self.wedges {
            let energy = wedge.energy(wedge.ways(moved));
            sum = Vec4::select(wedge.counts, sum + energy, sum);
        }
        sum
    }

    /// The shares of the steps that are safe: less than the way to the first triangle that collapses, and no more than all.
    fn safe_share(&self, step: Rows) -> Row {
        let mut share = Vec4::ONE;
        for wedge in &self.wedges {
            let ([u, w], side) = (wedge.ways(self.here[1]), wedge.side);
            let area = u[0] * w[1] - u[1] * w[0];
            let loss = step[0] * side[1] - step[1] * side[0];
            let safe = Vec4::splat(SAFE_SHARE) * (area / loss);
            share = Vec4::select(wedge.counts & loss.cmpgt(Vec4::ZERO) & safe.cmplt(share), safe, share);
        }
        share
    }
}

struct Slopes {
    gradient: Rows,
    /// xx, xy, yy of the second derivative.
    hessian: [Row; 3],
}

impl Wedge {
    /// Takes up the triangles at entries of the fans of vertices that are `here`.
    fn gather(&mut self, moving: &Moving, entries: [u32; WIDTH], here: [Vec4; WIDTH]) {
        let mut all = [[Vec4::ZERO; WIDTH]; 6];
        for i in 0..WIDTH {
            let (t, corner) = ((entries[i] / 4) as usize, entries[i] as usize % 4);
            let [next, last] =
                OTHERS[corner].map(|k| Vec4::from_array(moving.positions[moving.triangles[t][k] as usize]));
            let first_part = here[i] * Vec4::new(1.0, 1.0, 0.0, 0.0);
            let Sight { rest, sum, inverse } = moving.sights[t];
            all[0][i] = next - first_part;
            all[1][i] = last - first_part;
            all[2][i] = last - next;
            all[3][i] = Vec4::from_array(rest);
            all[4][i] = Vec4::from_array(sum);
            all[5][i] = Vec4::from_array(inverse);
        }
        let [next, last, side, rest, sum, inverse] = all.map(transposed);
        self.next = [next[0], next[1]];
        self.last = [last[0], last[1]];
        self.next_moved = [next[2], next[3]];
        self.last_moved = [last[2], last[3]];
        self.side = [side[0] + side[2], side[1] + side[3]];
        self.sum = [sum[0], sum[1], sum[2]];
        self.inverse = [inverse[0], inverse[1], inverse[2]];
        self.weigh(entries.map(|entry| entry % 4), rest);
    }

    /// The map's columns are `rest` times the edges from the triangle's first corner, be that the vertex, the last or the
    /// next corner.
    fn weigh(&mut self, corner: [u32; WIDTH], rest: [Row; 4]) {
        let [is_second, is_third] = [1, 2].map(|k| BVec4A::from_array(corner.map(|c| c == k)));
        for (m, [second, third]) in [[rest[0], rest[1]], [rest[2], rest[3]]].into_iter().enumerate() {
            let by_corner = |[a, b, c]: [Row; 3]| Vec4::select(is_second, b, Vec4::select(is_third, c, a));
            self.columns[m] = [
                by_corner([second, Vec4::ZERO, -third]),
                by_corner([third, -second, Vec4::ZERO]),
                by_corner([Vec4::ZERO, -third, second]),
            ];
            self.by[m] = by_corner([-(second + third), second, third]);
        }
    }

    /// The ways from the vertex to the next corner and to the last, with its second part at `moved`.
    fn ways(&self, moved: Rows) -> [Rows; 2] {
        let way = |first: Rows, second: Rows| [0, 1].map(|m| first[m] + (second[m] - moved[m]));
        [way(self.next, self.next_moved), way(self.last, self.last_moved)]
    }

    /// The map from the triangle at rest into the plane, its two columns one after the other.
    fn map(&self, [next, last]: [Rows; 2]) -> [Row; 4] {
        let of = |c: [Row; 3], m: usize| next[m] * c[0] + last[m] * c[1] + self.side[m] * c[2];
        let [one, other] = self.columns;
        [of(one, 0), of(one, 1), of(other, 0), of(other, 1)]
    }

    /// Energies of the triangles.
    fn energy(&self, ways: [Rows; 2]) -> Row {
        let m = self.map(ways);
        let det = m[0] * m[3] - m[1] * m[2];
        let p = dot4(m, times(self.sum, m));
        let q = dot4(m, times(self.inverse, m));
        // Also false for NaN.
        Vec4::select(det.cmpgt(Vec4::ZERO), (p + q / (det * det)) * 0.25, Vec4::splat(FOLDED))
    }

    /// Derivatives of the triangles' energies by the vertices.
    fn slopes(&self, ways: [Rows; 2]) -> Slopes {
        let (by, half) = (self.by, Vec4::splat(0.5));
        let m = self.map(ways);
        let det = m[0] * m[3] - m[1] * m[2];
        let d2 = det * det;
        let pm = times(self.sum, m);
        let qm = times(self.inverse, m);
        let q = dot4(m, qm);
        // What P m, Q m and the cofactor of m make of the weights.
        let p = [pm[0] * by[0] + pm[2] * by[1], pm[1] * by[0] + pm[3] * by[1]];
        let a = [qm[0] * by[0] + qm[2] * by[1], qm[1] * by[0] + qm[3] * by[1]];
        let g = [m[3] * by[0] - m[1] * by[1], m[0] * by[1] - m[2] * by[0]];
        let along = half / d2;
        let across = half * (q / (d2 * det));
        let square = by[0] * by[0] + by[1] * by[1];
        let cross = Vec4::ONE / (d2 * det);
        let push = 2.0 * (q / (d2 * d2));
        let same = |k: usize| (half * self.sum[k] + along * self.inverse[k]) * square;
        Slopes {
            gradient: [0, 1].map(|k| (half * p[k] + along * a[k]) - across * g[k]),
            hessian: [
                (same(0) - cross * (2.0 * a[0] * g[0])) + push * (g[0] * g[0]),
                (same(1) - cross * (a[0] * g[1] + g[0] * a[1])) + push * (g[0] * g[1]),
                (same(2) - cross * (2.0 * a[1] * g[1])) + push * (g[1] * g[1]),
            ],
        }
    }
}

/// The corners after each, counter-clockwise; an entry of a fan has no fourth.
const OTHERS: [[usize; 2]; 4] = [[1, 2], [2, 0], [0, 1], [0, 1]];

/// Four vectors by coordinate.
fn transposed([a, b, c, d]: [Vec4; 4]) -> [Vec4; 4] {
    let by_coordinate = Mat4::from_cols(a, b, c, d).transpose();
    [by_coordinate.x_axis, by_coordinate.y_axis, by_coordinate.z_axis, by_coordinate.w_axis]
}

/// A symmetric matrix times the columns of `m`.
fn times(s: [Row; 3], m: [Row; 4]) -> [Row; 4] {
    [s[0] * m[0] + s[1] * m[1], s[1] * m[0] + s[2] * m[1], s[0] * m[2] + s[1] * m[3], s[1] * m[2] + s[2] * m[3]]
}

fn dot4(a: [Row; 4], b: [Row; 4]) -> Row {
    ((a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]) + a[3] * b[3]
}
