//! Least-squares meshes: the smoothest positions that come near given places.
//!
//! Minimised is the squared uniform Laplacian of all vertices plus the weighted squared distances of some vertices from
//! where they should be (O. Sorkine, D. Cohen-Or, "Least-squares meshes", 2004; HYPOTHESIS 3.1). One factorisation serves
//! all three coordinates.

use crate::mesh::{Id, IdVec, TriMesh, VertexId};
use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use glam::DVec3;

/// Added to the diagonal: keeps vertices that nothing holds from making the system singular.
const RIDGE: f64 = 1e-9;

/// A vertex that should lie at a place, and how much that counts against the smoothness at a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Pull {
    /// The vertex.
    pub vertex: VertexId,
    /// Where it should be.
    pub to: DVec3,
    /// Weight of the squared distance; that of the squared Laplacian is 1.
    pub weight: f64,
}

/// Positions for all vertices of a mesh, of which only the connectivity counts; none if the system cannot be solved.
pub fn least_squares_mesh(mesh: &TriMesh, pulls: &[Pull]) -> Option<IdVec<VertexId, DVec3>> {
    let n = mesh.positions.len();
    let around = neighbours(mesh);
    let mut entries: Vec<Triplet<usize, usize, f64>> = Vec::with_capacity(50 * n);
    for (v, ring) in around.iter_ids() {
        let share = -1.0 / ring.len() as f64;
        let row: Vec<(usize, f64)> =
            std::iter::once((v.index(), 1.0)).chain(ring.iter().map(|w| (w.index(), share))).collect();
        let row = if ring.is_empty() { &[] } else { row.as_slice() };
        for &(i, x) in row {
            let lower = row.iter().filter(|&&(j, _)| j <= i);
            entries.extend(lower.map(|&(j, y)| Triplet { row: i, col: j, val: x * y }));
        }
    }
    entries.extend((0..n).map(|i| Triplet { row: i, col: i, val: RIDGE }));
    entries.extend(pulls.iter().map(|p| Triplet { row: p.vertex.index(), col: p.vertex.index(), val: p.weight }));
    let mut rhs = faer::Mat::<f64>::zeros(n, 3);
    for pull in pulls {
        (0..3).for_each(|k| rhs[(pull.vertex.index(), k)] += pull.weight * pull.to[k]);
    }
    let matrix = SparseColMat::try_new_from_triplets(n, n, &entries).ok()?;
    matrix.sp_cholesky(faer::Side::Lower).ok()?.solve_in_place(&mut rhs);
    let place = |i: usize| DVec3::new(rhs[(i, 0)], rhs[(i, 1)], rhs[(i, 2)]);
    let places: IdVec<VertexId, DVec3> = (0..n).map(place).collect();
    places.iter().all(|p| p.is_finite()).then_some(places)
}

/// The vertices at the other ends of every vertex's edges.
fn neighbours(mesh: &TriMesh) -> IdVec<VertexId, Vec<VertexId>> {
    let mut around = IdVec::filled(Vec::new(), mesh.positions.len());
    for h in mesh.conn.halfedges().filter(|&h| mesh.conn.is_edge_representative(h)) {
        let [a, b] = [mesh.conn.from(h), mesh.conn.to(h)];
        around[a].push(b);
        around[b].push(a);
    }
    around
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::fixture::icosphere;

    fn pull((vertex, to): (VertexId, DVec3)) -> Pull {
        Pull { vertex, to, weight: 100.0 }
    }

    #[test]
    fn a_mesh_pulled_to_one_place_lies_there() {
        let mesh = icosphere(2);
        let places = least_squares_mesh(&mesh, &[pull((VertexId(3), DVec3::new(1.0, 2.0, 3.0)))]).expect("a solution");
        assert!(places.iter().all(|p| p.distance(DVec3::new(1.0, 2.0, 3.0)) < 1e-4));
    }

    /// Moving all places moves the whole mesh along, and the energy has no lower neighbour.
    #[test]
    fn no_vertex_can_be_moved_for_less_energy() {
        let mesh = icosphere(2);
        let pulls: Vec<Pull> = mesh.conn.vertices().step_by(9).map(|v| pull((v, mesh.positions[v] * 2.0))).collect();
        let places = least_squares_mesh(&mesh, &pulls).expect("a solution");
        let around = neighbours(&mesh);
        let energy = |places: &IdVec<VertexId, DVec3>| {
            let bend = |(v, ring): (VertexId, &Vec<VertexId>)| {
                let mean = ring.iter().map(|&w| places[w]).sum::<DVec3>() / ring.len() as f64;
                (places[v] - mean).length_squared()
            };
            let smooth: f64 = around.iter_ids().map(bend).sum();
            smooth + pulls.iter().map(|p| p.weight * places[p.vertex].distance_squared(p.to)).sum::<f64>()
        };
        let least = energy(&places);
        for v in mesh.conn.vertices().step_by(7) {
            for step in [DVec3::X, DVec3::NEG_Y, DVec3::Z] {
                let mut moved = places.clone();
                moved[v] += 0.01 * step;
                assert!(energy(&moved) > least, "{v}");
            }
        }
    }
}
