//! A sparse symmetric positive definite system with a block of two by two for every pair of vertices at an edge.
//!
//! The elimination order is found on the vertices' own graph, a quarter of the entries, and the values go straight to
//! their places: with a list of entries to be sorted both took several times as long as the factorisation itself.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::PermRef;
use faer::sparse::linalg::amd;
use faer::sparse::linalg::cholesky::{SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky};
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::{Conj, Side, get_global_parallelism};
use glam::{DMat2, DVec2};

/// Which vertices have a block with which.
pub struct Pattern {
    /// Where every vertex's column of blocks starts: the diagonal's first, then by rows below.
    starts: Vec<usize>,
    rows: Vec<usize>,
}

/// How a system of a pattern is eliminated, whatever its numbers.
pub struct Plan(SymbolicCholesky<usize>);

impl Pattern {
    /// That of `n` vertices with blocks for the corners of triangles; corners that are not below `n` have none.
    pub fn new(n: usize, triangles: impl Iterator<Item = [u32; 3]>) -> Self {
        let mut columns: Vec<Vec<usize>> = (0..n).map(|v| vec![v]).collect();
        for [a, b, c] in triangles {
            for (v, w) in [(a, b), (b, c), (c, a)] {
                let (low, high) = (v.min(w) as usize, v.max(w) as usize);
                if high < n {
                    columns[low].push(high);
                }
            }
        }
        let (mut starts, mut rows) = (vec![0], Vec::with_capacity(4 * n));
        for mut column in columns {
            column.sort_unstable();
            column.dedup();
            rows.extend(column);
            starts.push(rows.len());
        }
        Pattern { starts, rows }
    }

    /// Number of vertices.
    fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// How its systems are eliminated; none if memory does not suffice.
    pub fn plan(&self) -> Option<Plan> {
        let expand = |places: &[usize]| places.iter().flat_map(|&k| [2 * k, 2 * k + 1]).collect::<Vec<usize>>();
        let [forth, back] = self.order()?.map(|places| expand(&places));
        let order = SymmetricOrdering::Custom(PermRef::new_checked(&forth, &back, forth.len()));
        let numbers = self.numbers();
        factorize_symbolic_cholesky(numbers.as_ref(), Side::Lower, order, Default::default()).ok().map(Plan)
    }

    /// The vertices in an order of little fill, and the place of every vertex in it.
    fn order(&self) -> Option<[Vec<usize>; 2]> {
        let n = self.len();
        let graph = SymbolicSparseColMat::new_checked(n, n, self.starts.clone(), None, self.rows.clone());
        let mut room = MemBuffer::try_new(amd::order_maybe_unsorted_scratch::<usize>(n, self.rows.len())).ok()?;
        let (mut forth, mut back) = (vec![0; n], vec![0; n]);
        let stack = MemStack::new(&mut room);
        amd::order_maybe_unsorted(&mut forth, &mut back, graph.as_ref(), Default::default(), stack).ok()?;
        Some([forth, back])
    }

    /// Where a system has numbers: the lower half, column by column.
    fn numbers(&self) -> SymbolicSparseColMat<usize> {
        let (mut starts, mut rows) = (vec![0], Vec::with_capacity(4 * self.rows.len() - self.len()));
        for v in 0..self.len() {
            for side in 0..2 {
                for &row in &self.rows[self.starts[v]..self.starts[v + 1]] {
                    let first = if row == v { side } else { 0 };
                    rows.extend((first..2).map(|i| 2 * row + i));
                }
                starts.push(rows.len());
            }
        }
        SymbolicSparseColMat::new_checked(2 * self.len(), 2 * self.len(), starts, None, rows)
    }
}

/// A system.
pub struct Blocks<'a> {
    pattern: &'a Pattern,
    blocks: Vec<DMat2>,
}

impl<'a> Blocks<'a> {
    /// The system whose blocks are zero.
    pub fn new(pattern: &'a Pattern) -> Self {
        Blocks { pattern, blocks: vec![DMat2::ZERO; pattern.rows.len()] }
    }

    /// Adds to the block in the row of `i` and the column of `j`, two vertices of one triangle, `i` not below `j`; of the
    /// diagonal's only the lower half counts.
    pub fn add(&mut self, i: u32, j: u32, block: DMat2) {
        let (first, last) = (self.pattern.starts[j as usize], self.pattern.starts[j as usize + 1]);
        if let Some(k) = self.pattern.rows[first..last].iter().position(|&row| row == i as usize) {
            self.blocks[first + k] += block;
        }
    }

    /// The mean of the diagonal.
    pub fn mean_diagonal(&self) -> f64 {
        let n = self.pattern.len();
        let diagonal = self.pattern.starts[..n].iter().map(|&k| self.blocks[k]);
        diagonal.map(|block| block.x_axis.x + block.y_axis.y).sum::<f64>() / (2 * n) as f64
    }

    /// Adds to the whole diagonal.
    pub fn add_ridge(&mut self, ridge: f64) {
        let diagonal = &self.pattern.starts[..self.pattern.len()];
        diagonal.iter().for_each(|&k| self.blocks[k] += DMat2::from_diagonal(DVec2::splat(ridge)));
    }

    /// Solves for a right side with one entry for every vertex, by the plan of the pattern; none if the system is not
    /// positive definite.
    pub fn solve(&self, Plan(symbolic): &Plan, rhs: &[DVec2]) -> Option<Vec<DVec2>> {
        let matrix = SparseColMat::new(self.pattern.numbers(), self.values());
        let par = get_global_parallelism();
        let mut values = vec![0.0; symbolic.len_val()];
        let room = symbolic.factorize_numeric_llt_scratch::<f64>(par, Default::default());
        let mut room = MemBuffer::try_new(room.or(symbolic.solve_in_place_scratch::<f64>(1, par))).ok()?;
        let stack = MemStack::new(&mut room);
        let (how, which) = (Default::default(), Default::default());
        let factor =
            symbolic.factorize_numeric_llt(&mut values, matrix.as_ref(), Side::Lower, how, par, stack, which).ok()?;
        let mut x = faer::Mat::from_fn(2 * rhs.len(), 1, |i, _| rhs[i / 2][i % 2]);
        factor.solve_in_place_with_conj(Conj::No, x.as_mut(), par, MemStack::new(&mut room));
        Some((0..rhs.len()).map(|v| DVec2::new(x[(2 * v, 0)], x[(2 * v + 1, 0)])).collect())
    }

    /// The numbers where the pattern has them.
    fn values(&self) -> Vec<f64> {
        let Pattern { starts, rows } = self.pattern;
        let mut values = Vec::with_capacity(4 * rows.len() - self.pattern.len());
        for v in 0..self.pattern.len() {
            for side in 0..2 {
                for k in starts[v]..starts[v + 1] {
                    let first = if rows[k] == v { side } else { 0 };
                    values.extend_from_slice(&self.blocks[k].col(side).to_array()[first..]);
                }
            }
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of triangles, one corner of which is fixed.
    #[test]
    fn the_solution_satisfies_the_system() {
        let n = 40u32;
        let triangles: Vec<[u32; 3]> =
            (0..n - 1).map(|i| [i, i + 1, if i + 2 < n { i + 2 } else { u32::MAX }]).collect();
        let pattern = Pattern::new(n as usize, triangles.iter().copied());
        let mut system = Blocks::new(&pattern);
        let near = DMat2::from_cols(DVec2::new(-1.0, 0.25), DVec2::new(-0.5, -0.75));
        (0..n).for_each(|v| system.add(v, v, DMat2::from_cols(DVec2::new(6.0, 1.0), DVec2::new(1.0, 7.0))));
        (1..n).for_each(|v| system.add(v, v - 1, near));
        system.add_ridge(0.5);
        assert!((system.mean_diagonal() - 7.0).abs() < 1e-12);
        let rhs: Vec<DVec2> = (0..n).map(|v| DVec2::new(f64::from(v), f64::from(v % 7) - 3.0)).collect();
        let x = system.solve(&pattern.plan().expect("enough memory"), &rhs).expect("the diagonal dominates");
        let own = DMat2::from_cols(DVec2::new(6.5, 1.0), DVec2::new(1.0, 7.5));
        for v in 0..n as usize {
            let mut left = own * x[v];
            left += v.checked_sub(1).map_or(DVec2::ZERO, |before| near * x[before]);
            left += x.get(v + 1).map_or(DVec2::ZERO, |&after| near.transpose() * after);
            assert!(left.distance(rhs[v]) < 1e-10, "{left} for {} at {v}", rhs[v]);
        }
    }

    #[test]
    fn a_system_that_is_not_positive_definite_is_refused() {
        let pattern = Pattern::new(3, [[0, 1, 2]].into_iter());
        let mut system = Blocks::new(&pattern);
        (0..3).for_each(|v| system.add(v, v, -DMat2::IDENTITY));
        assert!(system.solve(&pattern.plan().expect("enough memory"), &[DVec2::X; 3]).is_none());
    }
}
