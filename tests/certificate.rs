//! The certificate holds for what the stages make and fails for every way of breaking it.

mod common;

use common::mesh;
use common::run::Pair;
use homeo::map::certificate::{Certificate, certify};
use homeo::map::embedding::Embedding;
use homeo::mesh::{ArcId, Id, PatchId};
use homeo::plane::patch_disc::PatchDisc;
use homeo::shape::random_landmarks;

fn good() -> Embedding {
    let [a, b] = [mesh::sphere(9, 16), mesh::crumpled(150, 1)];
    let [la, lb] = [random_landmarks(&a, 7, 1), random_landmarks(&b, 7, 2)];
    Pair::new((a, la), (b, lb)).embed().expect("an embedding")
}

/// Breaks one mesh of a good embedding and certifies it; both meshes in turn.
fn broken(harm: impl Fn(&mut Embedding, usize)) -> [Certificate; 2] {
    [0, 1].map(|k| {
        let mut embedding = good();
        harm(&mut embedding, k);
        let certificate = certify(&embedding);
        assert!(!certificate.bijective, "mesh {k}: {certificate:?}");
        certificate
    })
}

/// The patch with the most free vertices.
fn largest(embedding: &mut Embedding, k: usize) -> &mut PatchDisc {
    let free = |d: &&mut PatchDisc| d.vertices.len() - d.boundary;
    embedding.meshes[k].discs.raw.iter_mut().max_by_key(free).expect("there are patches")
}

#[test]
fn a_good_embedding_passes() {
    let certificate = certify(&good());
    assert!(certificate.bijective && certificate.same_complex && certificate.patches_are_discs, "{certificate:?}");
    assert!(certificate.positive && certificate.min_orientation > 0.0, "{certificate:?}");
}

#[test]
fn a_vertex_moved_across_an_edge() {
    for certificate in broken(|e, k| {
        let disc = largest(e, k);
        let v = disc.boundary as u32;
        let t = *disc.triangles.iter().find(|t| t.contains(&v)).expect("a vertex has triangles");
        let i = t.iter().position(|&w| w == v).expect("just found");
        let [a, b] = [1, 2].map(|d| disc.positions[t[(i + d) % 3] as usize]);
        // Mirrored about the middle of the opposite edge.
        disc.positions[v as usize] = a + b - disc.positions[v as usize];
    }) {
        assert!(!certificate.positive && certificate.min_orientation < 0.0);
    }
}

#[test]
fn a_triangle_without_area() {
    for certificate in broken(|e, k| {
        let disc = largest(e, k);
        let v = disc.boundary;
        let t = disc.triangles.iter().find(|t| t.contains(&(v as u32))).expect("a vertex has triangles");
        let other = t.iter().find(|&&w| w != v as u32).expect("three corners");
        disc.positions[v] = disc.positions[*other as usize];
    }) {
        assert!(!certificate.positive && certificate.min_orientation <= 0.0);
    }
}

#[test]
fn a_position_that_is_not_a_number() {
    for certificate in broken(|e, k| {
        let disc = largest(e, k);
        disc.positions[disc.boundary].x = f64::NAN;
    }) {
        assert!(!certificate.positive);
    }
}

#[test]
fn two_boundary_vertices_exchanged() {
    for certificate in broken(|e, k| {
        let long = |d: &&mut PatchDisc| d.corners[1] > 2;
        let disc = e.meshes[k].discs.raw.iter_mut().find(long).expect("some arc crosses two edges");
        disc.positions.swap(1, 2);
    }) {
        assert!(!certificate.positive);
    }
}

#[test]
fn a_boundary_vertex_moved_in_one_of_its_two_patches() {
    for certificate in broken(|e, k| {
        let long = |d: &&mut PatchDisc| d.corners[1] > 1;
        let disc = e.meshes[k].discs.raw.iter_mut().find(long).expect("some arc crosses an edge");
        // A little way along the side: every triangle stays positive, but the map is torn along the arc.
        let x = &mut disc.positions[1].x;
        *x = f64::from_bits(x.to_bits() ^ (1 << 20));
    }) {
        assert!(!certificate.positive, "{certificate:?}");
    }
}

#[test]
fn sides_of_a_patch_exchanged() {
    for certificate in broken(|e, _| e.base.patches[PatchId(0)].swap(0, 1)) {
        assert!(!certificate.same_complex);
    }
}

#[test]
fn arcs_with_exchanged_ends() {
    for certificate in broken(|e, _| {
        let other = e.base.arcs.ids().find(|&a| e.base.arcs[a] != e.base.arcs[ArcId(0)]).expect("arcs differ");
        e.base.arcs.raw.swap(0, other.index());
    }) {
        assert!(!certificate.same_complex);
    }
}

#[test]
fn patches_exchanged_on_one_mesh() {
    for certificate in broken(|e, k| e.meshes[k].discs.raw.swap(0, 1)) {
        assert!(!certificate.same_complex);
    }
}

#[test]
fn a_dropped_face() {
    for certificate in broken(|e, k| {
        let disc = largest(e, k);
        disc.faces.pop();
        disc.triangles.pop();
    }) {
        assert!(!certificate.same_complex || !certificate.patches_are_discs);
    }
}

#[test]
fn a_face_of_another_patch() {
    for certificate in broken(|e, k| {
        let foreign = e.meshes[k].discs[PatchId(1)].faces[0];
        e.meshes[k].discs[PatchId(0)].faces[0] = foreign;
    }) {
        assert!(!certificate.same_complex);
    }
}

#[test]
fn faces_of_one_patch_in_another_order() {
    // Positions and topology are untouched, but triangles no longer are the faces they stand for.
    broken(|e, k| largest(e, k).faces.swap(0, 1));
}

#[test]
fn a_triangle_glued_twice() {
    for certificate in broken(|e, k| {
        let disc = largest(e, k);
        disc.triangles[0] = disc.triangles[1];
    }) {
        assert!(!certificate.patches_are_discs);
    }
}

#[test]
fn a_landmark_at_another_vertex() {
    for certificate in broken(|e, k| e.meshes[k].cut.landmarks.raw.swap(0, 1)) {
        assert!(!certificate.same_complex, "{certificate:?}");
    }
}
