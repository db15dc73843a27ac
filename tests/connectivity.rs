//! Splitting edges and faces keeps a valid manifold.

mod common;

use common::{check, mesh};
use homeo::mesh::{Connectivity, FaceId, HalfedgeId, Id, TriMesh, VertexId, corner};
use homeo::shape::SplitMix;
use homeo::shape::fixture;

/// Splits at random and checks everything after every step.
fn split_at_random(TriMesh { mut conn, .. }: TriMesh, seed: u64, steps: usize) {
    let mut random = SplitMix::new(seed);
    let (euler, loops) = (conn.euler_characteristic(), conn.boundary_loops().len());
    for _ in 0..steps {
        let (vertices, faces) = (conn.vertex_count(), conn.face_count());
        let f = FaceId::new(random.below(faces));
        let (made, new_faces) = if random.unit() < 0.7 {
            let h = corner(f, random.below(3));
            (split_edge(&mut conn, h), if conn.twin(h).is_some() { 2 } else { 1 })
        } else {
            (conn.split_face(f), 2)
        };
        check::manifold(&conn);
        assert_eq!(made.index(), vertices);
        assert_eq!(conn.vertex_count(), vertices + 1);
        assert_eq!(conn.face_count(), faces + new_faces);
        assert_eq!(conn.euler_characteristic(), euler);
        assert_eq!(conn.boundary_loops().len(), loops);
    }
}

/// Splits an edge and checks what the method promises about the half-edge and the faces that stay.
fn split_edge(conn: &mut Connectivity, h: HalfedgeId) -> VertexId {
    let (a, b, twin) = (conn.from(h), conn.to(h), conn.twin(h));
    let first_new = HalfedgeId::new(3 * conn.face_count());
    let m = conn.split_edge(h);
    assert_eq!([conn.from(h), conn.to(h)], [a, m]);
    assert_eq!(conn.twin(h), twin);
    assert_eq!([conn.from(first_new), conn.to(first_new)], [m, b]);
    assert_eq!(conn.outgoing(m).count(), if twin.is_some() { 4 } else { 2 });
    m
}

#[test]
fn splits_keep_a_closed_manifold_seeds_1_to_4() {
    for seed in 1..=4 {
        split_at_random(fixture::tetrahedron(), seed, 150);
    }
}

#[test]
fn splits_keep_a_torus_seed_5() {
    split_at_random(mesh::torus(5, 4), 5, 150);
}

#[test]
fn splits_keep_a_disc_seeds_6_to_9() {
    for seed in 6..=9 {
        split_at_random(mesh::grid(2, 3), seed, 150);
    }
}

#[test]
fn the_checker_sees_a_broken_fan() {
    // Two tetrahedra that share a vertex: pairs of twins everywhere, but two fans at the vertex.
    let one = fixture::tetrahedron();
    let shift = |v: VertexId| if v.index() == 0 { v } else { VertexId::new(v.index() + 3) };
    let faces: Vec<_> = one.faces().into_iter().flat_map(|f| [f, f.map(shift)]).collect();
    assert!(Connectivity::build(7, &faces).is_err());
}
