//! A net of springs whose boundary is fixed: every free vertex comes to rest at the weighted mean of its neighbours.
//!
//! Tutte: How to draw a graph (1963). A spring pulls at both its ends alike, so the system is symmetric and positive
//! definite, and Cholesky's factors of it are several times as fast to find as the factors of one without symmetry.

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::{Mat, Side};
use glam::DVec2;

/// Springs between vertices, of which the first few are fixed.
pub struct Springs {
    fixed: usize,
    /// The ends of every spring, of which at least one is free; the lower end first, by lower ends and then by upper ends.
    ends: Vec<[u32; 2]>,
    /// The lower half of the system over free vertices: a diagonal entry, then one for every spring to a vertex above.
    numbers: SymbolicSparseColMat<usize>,
    symbolic: SymbolicLlt<usize>,
}

impl Springs {
    /// Those along the sides of triangles over `n` vertices, `fixed` of which, the first, do not move; none if there is no
    /// free vertex or too little memory.
    pub fn along(triangles: &[[u32; 3]], n: usize, fixed: usize) -> Option<Self> {
        let free = n.checked_sub(fixed).filter(|&free| free > 0)?;
        let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let mut ends: Vec<[u32; 2]> = sides.map(|[v, w]| [v.min(w), v.max(w)]).collect();
        ends.retain(|&[_, upper]| upper as usize >= fixed);
        ends.sort_unstable();
        ends.dedup();
        let (mut starts, mut rows) = (Vec::with_capacity(free + 1), Vec::with_capacity(free + ends.len()));
        let mut inner = ends.iter().skip_while(|&&[lower, _]| (lower as usize) < fixed).peekable();
        for v in 0..free {
            starts.push(rows.len());
            rows.push(v);
            while let Some(&[_, upper]) = inner.next_if(|&&[lower, _]| lower as usize - fixed == v) {
                rows.push(upper as usize - fixed);
            }
        }
        starts.push(rows.len());
        let numbers = SymbolicSparseColMat::new_checked(free, free, starts, None, rows);
        let symbolic = SymbolicLlt::try_new(numbers.as_ref(), Side::Lower).ok()?;
        Some(Springs { fixed, ends, numbers, symbolic })
    }

    /// The ends of every spring.
    pub fn ends(&self) -> &[[u32; 2]] {
        &self.ends
    }

    /// The places of all vertices where springs of these stiffnesses, all positive, hold the free ones; the fixed ones are
    /// where `positions` has them. None if the factorisation fails or a place is not finite.
    pub fn rest(&self, stiffness: &[f64], positions: &[DVec2]) -> Option<Vec<DVec2>> {
        let (fixed, free) = (self.fixed, self.numbers.ncols());
        let starts = self.numbers.col_ptr();
        let mut values = vec![0.0; self.numbers.row_idx().len()];
        let mut rhs = Mat::<f64>::zeros(free, 2);
        let mut next = 0;
        for (&[lower, upper], &stiff) in self.ends.iter().zip(stiffness) {
            let (lower, upper) = (lower as usize, upper as usize - fixed);
            values[starts[upper]] += stiff;
            match lower.checked_sub(fixed) {
                Some(lower) => {
                    values[starts[lower]] += stiff;
                    // Springs come in the order of the entries, of which the first of a column is the diagonal's.
                    next = next.max(starts[lower]) + 1;
                    values[next] = -stiff;
                }
                None => {
                    rhs[(upper, 0)] += stiff * positions[lower].x;
                    rhs[(upper, 1)] += stiff * positions[lower].y;
                }
            }
        }
        let matrix = SparseColMat::new(self.numbers.clone(), values);
        Llt::try_new_with_symbolic(self.symbolic.clone(), matrix.as_ref(), Side::Lower).ok()?.solve_in_place(&mut rhs);
        let mut places = positions[..fixed].to_vec();
        places.extend((0..free).map(|v| DVec2::new(rhs[(v, 0)], rhs[(v, 1)])));
        places.iter().all(|p| p.is_finite()).then_some(places)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_free_vertex_is_at_the_weighted_mean_of_its_neighbours() {
        // A strip that hangs on its first triangle.
        let n = 30u32;
        let triangles: Vec<[u32; 3]> = (0..n - 2).map(|i| [i, i + 1, i + 2]).collect();
        let mut positions = vec![DVec2::ZERO; n as usize];
        [positions[0], positions[1], positions[2]] = [DVec2::ZERO, DVec2::X, DVec2::new(0.3, 2.0)];
        let springs = Springs::along(&triangles, n as usize, 3).expect("free vertices");
        assert_eq!(springs.ends().len(), 2 * n as usize - 3 - 3, "springs between fixed ones are left out");
        let stiffness: Vec<f64> = (0..springs.ends().len()).map(|k| 1.0 + (k % 5) as f64).collect();
        let places = springs.rest(&stiffness, &positions).expect("springs hold them");
        assert_eq!(places[..3], positions[..3]);
        let mut pull = vec![DVec2::ZERO; n as usize];
        for (&[v, w], stiff) in springs.ends().iter().zip(&stiffness) {
            let force = (places[w as usize] - places[v as usize]) * *stiff;
            pull[v as usize] += force;
            pull[w as usize] -= force;
        }
        assert!(pull[3..].iter().all(|p| p.length() < 1e-12), "{pull:?}");
    }

    #[test]
    fn nothing_free_is_nothing_to_solve() {
        assert!(Springs::along(&[[0, 1, 2]], 3, 3).is_none());
    }
}
