//! A sparse symmetric positive definite system with a block of two by two for every pair of vertices at an edge.
//!
//! The elimination order is found on the vertices' own graph, a quarter of the entries, and the values go straight to
//! their places: with a list of entries to be sorted both took several times as long as the factorisation itself.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{SymmetricOrdering, factorize_symbolic_cholesky};
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::{Conj, Side, get_global_parallelism};
use glam::{DMat2, DVec2};

/// The system, its blocks zero at first.
pub struct Blocks {
    /// Where every vertex's column of blocks starts: the diagonal's first, then by rows below.
    starts: Vec<usize>,
    rows: Vec<usize>,
    blocks: Vec<DMat2>,
}

impl Blocks {
    /// A system over `n` vertices with blocks for the corners of triangles; corners that are not below `n` have none.
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
        let blocks = vec![DMat2::ZERO; rows.len()];
        Blocks { starts, rows, blocks }
    }

    /// Adds to the block in the row of `i` and the column of `j`, two vertices of one triangle, `i` not below `j`; of the
    /// diagonal's only the lower half counts.
    pub fn add(&mut self, i: u32, j: u32, block: DMat2) {
        let (first, last) = (self.starts[j as usize], self.starts[j as usize + 1]);
        if let Some(k) = self.rows[first..last].iter().position(|&row| row == i as usize) {
            self.blocks[first + k] += block;
        }
    }

    /// The mean of the diagonal.
    pub fn mean_diagonal(&self) -> f64 {
        let n = self.starts.len() - 1;
        let sum: f64 = self.starts[..n].iter().map(|&k| self.blocks[k].x_axis.x + self.blocks[k].y_axis.y).sum();
        sum / (2 * n) as f64
    }

    /// Adds to the whole diagonal.
    pub fn add_ridge(&mut self, ridge: f64) {
        let n = self.starts.len() - 1;
        self.starts[..n].iter().for_each(|&k| self.blocks[k] += DMat2::from_diagonal(DVec2::splat(ridge)));
    }

    /// Solves for a right side with one entry for every vertex; none if the system is not positive definite.
    pub fn solve(&self, rhs: &[DVec2]) -> Option<Vec<DVec2>> {
        let matrix = self.matrix();
        let order = self.order()?;
        let expand = |places: &[usize]| places.iter().flat_map(|&k| [2 * k, 2 * k + 1]).collect::<Vec<usize>>();
        let [forth, back] = order.map(|places| expand(&places));
        let order = PermRef::new_checked(&forth, &back, forth.len());
        let symbolic = factorize_symbolic_cholesky(
            matrix.symbolic(),
            Side::Lower,
            SymmetricOrdering::Custom(order),
            Default::default(),
        );
        let (symbolic, par) = (symbolic.ok()?, get_global_parallelism());
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

    /// The vertices in an order of little fill, and the place of every vertex in it.
    fn order(&self) -> Option<[Vec<usize>; 2]> {
        let n = self.starts.len() - 1;
        let graph = SymbolicSparseColMat::new_checked(n, n, self.starts.clone(), None, self.rows.clone());
        let found =
            factorize_symbolic_cholesky(graph.as_ref(), Side::Lower, SymmetricOrdering::Amd, Default::default());
        let found = found.ok()?;
        let (forth, back) = found.perm()?.arrays();
        Some([forth.to_vec(), back.to_vec()])
    }

    /// The lower half, column by column.
    fn matrix(&self) -> SparseColMat<usize, f64> {
        let n = self.starts.len() - 1;
        let many = 4 * self.rows.len() - n;
        let (mut starts, mut rows, mut values) = (vec![0], Vec::with_capacity(many), Vec::with_capacity(many));
        for v in 0..n {
            for side in 0..2 {
                for k in self.starts[v]..self.starts[v + 1] {
                    let (row, column) = (self.rows[k], self.blocks[k].col(side));
                    let first = if row == v { side } else { 0 };
                    rows.extend((first..2).map(|i| 2 * row + i));
                    values.extend((first..2).map(|i| column[i]));
                }
                starts.push(rows.len());
            }
        }
        let pattern = SymbolicSparseColMat::new_checked(2 * n, 2 * n, starts, None, rows);
        SparseColMat::new(pattern, values)
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
        let mut system = Blocks::new(n as usize, triangles.iter().copied());
        let near = DMat2::from_cols(DVec2::new(-1.0, 0.25), DVec2::new(-0.5, -0.75));
        (0..n).for_each(|v| system.add(v, v, DMat2::from_cols(DVec2::new(6.0, 1.0), DVec2::new(1.0, 7.0))));
        (1..n).for_each(|v| system.add(v, v - 1, near));
        system.add_ridge(0.5);
        assert!((system.mean_diagonal() - 7.0).abs() < 1e-12);
        let rhs: Vec<DVec2> = (0..n).map(|v| DVec2::new(f64::from(v), f64::from(v % 7) - 3.0)).collect();
        let x = system.solve(&rhs).expect("the diagonal dominates");
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
        let mut system = Blocks::new(3, [[0, 1, 2]].into_iter());
        (0..3).for_each(|v| system.add(v, v, -DMat2::IDENTITY));
        assert!(system.solve(&[DVec2::X; 3]).is_none());
    }
}
