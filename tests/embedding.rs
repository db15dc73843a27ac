//! Patches embedded in their base triangles.

mod common;

use common::check;
use common::mesh::{self, vertices};
use common::run::{EDGE_NODES, Pair};
use homeo::map::certificate::certify;
use homeo::map::embedding::Embedding;
use homeo::mesh::{ArcId, FaceId, Id, IdVec, LandmarkId, TriMesh, VertexId, face_of};
use homeo::path::base_complex::DirectedArc;
use homeo::path::cut_mesh::CutMesh;
use homeo::path::region::base_complex;
use homeo::plane::convex::{embed_disc, embed_patch, is_embedded};
use homeo::plane::divide::split_dividing_edges;
use homeo::plane::orientation::orientation;
use homeo::plane::patch_disc::{PatchDisc, on_side};
use homeo::plane::progressive::embed_progressively;
use homeo::plane::stretch::{Frame, e_l2, patch_stretch};
use homeo::shape::fixture;
use homeo::shape::random_landmarks;

fn pair(seed: u64, n: usize) -> Pair {
    let [a, b] = [mesh::sphere(11, 20), mesh::crumpled(200, seed)];
    let [la, lb] = [random_landmarks(&a, n, seed), random_landmarks(&b, n, seed + 1)];
    Pair::new((a, la), (b, lb))
}

fn embedded(pair: &Pair) -> Embedding {
    pair.embed().unwrap_or_else(|e| panic!("{e}"))
}

/// The sides of its reference triangle that a boundary vertex lies on, by its place in the list of vertices.
fn sides(disc: &PatchDisc, v: u32) -> Vec<usize> {
    let v = v as usize;
    let end = |k: usize| if k == 2 { disc.boundary } else { disc.corners[k + 1] as usize };
    let on = |k: usize| (disc.corners[k] as usize..=end(k)).any(|i| i % disc.boundary == v && v < disc.boundary);
    (0..3).filter(|&k| on(k)).collect()
}

#[test]
fn no_dividing_edge_is_left_seeds_1_to_5() {
    for seed in 1..=5 {
        for mesh in &embedded(&pair(seed, 9)).meshes {
            for disc in mesh.discs.iter() {
                let inner = disc.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
                let outline = |(a, b): (u32, u32)| (a + 1) % disc.boundary as u32 == b;
                for edge in inner.filter(|&(a, b)| !outline((a, b)) && !outline((b, a))) {
                    let (a, b) = (sides(disc, edge.0), sides(disc, edge.1));
                    assert!(!a.iter().any(|k| b.contains(k)), "{edge:?} lies along a side");
                }
            }
        }
    }
}

/// Arcs 2-3-0, 0-4-1 and 1-2 on an octahedron with poles 0, 1: only the edge 0-2 joins two vertices of one arc.
#[test]
fn the_dividing_edge_of_an_arc_around_a_corner_is_split() {
    let mesh = mesh::octahedron();
    let mut cut = CutMesh::new(&mesh, &vertices(&[2, 0, 1]), EDGE_NODES);
    for (arc, chain) in [&[2, 3, 0][..], &[0, 4, 1], &[1, 2]].into_iter().enumerate() {
        for pair in chain.windows(2) {
            let h = cut.conn.find(VertexId::new(pair[0]), VertexId::new(pair[1])).expect("an edge of the octahedron");
            cut.mark(h, DirectedArc { arc: ArcId::new(arc), reversed: false });
        }
    }
    let ends = [[0, 1], [1, 2], [2, 0]].map(|ends| ends.map(LandmarkId));
    let base = base_complex(&cut, &IdVec::from_raw(ends.to_vec())).expect("two triangles");
    assert_eq!(split_dividing_edges(&mut cut, &mesh), 1);
    assert_eq!(split_dividing_edges(&mut cut, &mesh), 0);
    assert_eq!(cut.conn.find(VertexId(0), VertexId(2)), None);
    check::cut_mesh(&cut, &mesh);
    check::arcs(&cut, &base);
}

#[test]
fn boundary_vertices_lie_on_the_sides_and_both_patches_of_an_arc_agree() {
    for mesh in &embedded(&pair(6, 10)).meshes {
        let mut places = IdVec::<VertexId, Vec<u64>>::filled(Vec::new(), mesh.cut.conn.vertex_count());
        for disc in mesh.discs.iter() {
            for k in 0..3 {
                let end = if k == 2 { disc.boundary } else { disc.corners[k + 1] as usize };
                let mut last = 0.0;
                for i in disc.corners[k] as usize + 1..end {
                    let p = disc.positions[i];
                    let s = [p.x, p.y, 1.0 - p.y][k];
                    assert_eq!(p, on_side(k, s));
                    assert!(s > last && s < 1.0);
                    last = s;
                    // From either patch the share is s or exactly 1 - s.
                    places[disc.vertices[i]].push(s.min(1.0 - s).to_bits());
                }
            }
        }
        for (v, bits) in places.iter_ids().filter(|(_, bits)| !bits.is_empty()) {
            assert!(bits.len() == 2 && bits[0] == bits[1], "{v}: {bits:?}");
        }
    }
}

#[test]
fn every_triangle_is_exactly_positive_and_frames_are_triangles_seeds_7_to_9() {
    for seed in 7..=9 {
        let pair = pair(seed, 7);
        let embedding = embedded(&pair);
        check::embedding(&embedding, &pair.meshes);
        for frame in embedding.frames.iter() {
            assert!(frame.area() > 0.01 && frame.area().is_finite());
        }
        for disc in embedding.meshes.iter().flat_map(|m| m.discs.iter()) {
            for t in &disc.triangles {
                let [a, b, c] = t.map(|v| disc.positions[v as usize]);
                assert!(orientation(a, b, c) > 0.0);
            }
        }
    }
}

#[test]
fn frames_even_out_impossible_sides() {
    for sides in [[1.0, 1.0, 1.0], [3.0, 4.0, 5.0], [1.0, 1.0, 10.0], [0.0, 1.0, 1.0], [1e-9, 1e-9, 1.0]] {
        let frame = Frame::with_sides(sides);
        assert!(frame.area() > 0.0, "{sides:?}");
        let p = glam::DVec2::new(0.2, 0.3);
        assert!(frame.reference(frame.place(p)).distance(p) < 1e-12);
    }
    let right = Frame::with_sides([3.0, 5.0, 4.0]);
    assert!((right.area() - 6.0).abs() < 1e-12);
}

/// A flat triangle of `n` by `n` small ones: the identity is the best embedding there is.
fn flat_disc(n: usize) -> (PatchDisc, Vec<glam::DVec3>) {
    let mut boundary: Vec<[usize; 2]> = (0..n).map(|i| [i, 0]).collect();
    boundary.extend((0..n).map(|j| [n - j, j]));
    boundary.extend((0..n).map(|j| [0, n - j]));
    let inner = (1..n).flat_map(|j| (1..n - j).map(move |i| [i, j])).filter(|[i, j]| i + j < n);
    let all: Vec<[usize; 2]> = boundary.iter().copied().chain(inner).collect();
    let at = |p: [usize; 2]| all.iter().position(|&q| q == p).expect("a lattice point") as u32;
    let mut triangles = Vec::new();
    for j in 0..n {
        for i in 0..n - j {
            triangles.push([at([i, j]), at([i + 1, j]), at([i, j + 1])]);
            if i + j + 2 <= n {
                triangles.push([at([i + 1, j]), at([i + 1, j + 1]), at([i, j + 1])]);
            }
        }
    }
    let share = |x: usize| x as f64 / n as f64;
    let position = |[i, j]: [usize; 2]| glam::DVec2::new(share(i), share(j));
    let positions: Vec<_> = all.iter().map(|&p| position(p)).collect();
    let points = positions.iter().map(|p| p.extend(0.0)).collect();
    let disc = PatchDisc {
        vertices: (0..all.len()).map(VertexId::new).collect(),
        faces: (0..triangles.len()).map(FaceId::new).collect(),
        triangles,
        boundary: 3 * n,
        corners: [0, n as u32, 2 * n as u32],
        positions,
    };
    (disc, points)
}

#[test]
fn a_flat_patch_is_reproduced() {
    let (mut disc, points) = flat_disc(8);
    let expected = disc.positions.clone();
    disc.positions[disc.boundary..].fill(glam::DVec2::ZERO);
    let frame = Frame { first: glam::DVec2::X, second: glam::DVec2::Y };
    assert!(embed_patch(&mut disc, &points, &frame).is_some());
    for (p, q) in disc.positions.iter().zip(&expected) {
        assert!(p.distance(*q) < 1e-12, "{p} for {q}");
    }
    let stretch = patch_stretch(&disc, &points, &frame);
    assert!((e_l2(&stretch, frame.area()) - 1.0).abs() < 1e-12);
}

/// On springs a disc exceeds an isometry's stretch by a fifth less than by the weights of rings, and than seen from above.
#[test]
fn a_hilly_disc_on_springs_has_little_stretch() {
    let (disc, mut points) = flat_disc(24);
    let hill = |x: f64, y: f64| (-20.0 * ((x - 0.3).powi(2) + (y - 0.3).powi(2))).exp();
    points.iter_mut().for_each(|p| p.z = hill(p.x, p.y));
    let frame = Frame { first: glam::DVec2::X, second: glam::DVec2::Y };
    let [mut by_rings, mut on_springs] = [disc.clone(), disc.clone()];
    assert!(embed_patch(&mut by_rings, &points, &frame).is_some());
    assert!(embed_disc(&mut on_springs, &points, &frame, 0.5).is_some());
    assert!(is_embedded(&on_springs, &on_springs.positions));
    assert_eq!(on_springs.positions[..on_springs.boundary], by_rings.positions[..by_rings.boundary]);
    let energy = |disc: &PatchDisc| e_l2(&patch_stretch(disc, &points, &frame), frame.area());
    let [above, rings, springs] = [&disc, &by_rings, &on_springs].map(energy);
    let excess = |e_l2: f64| e_l2 - 1.0;
    assert!(excess(springs) < 0.8 * excess(rings.min(above)), "{springs} against {rings} and {above}");
}

#[test]
fn coarse_to_fine_embeds_too_and_keeps_the_boundary() {
    let (disc, points) = flat_disc(12);
    let frame = Frame::with_sides([1.0, 1.2, 0.9]);
    let positions = embed_progressively(&disc, &disc.rings(), &points, &frame).expect("an embedding");
    assert!(is_embedded(&disc, &positions));
    assert_eq!(positions[..disc.boundary], disc.positions[..disc.boundary]);
}

/// Landmarks low on the ball, so that the whole limb lies inside one patch.
fn limb_pair(ratio: f64, around: usize) -> Pair {
    let marks = vertices(&[2, 2 + around / 3, 2 + 2 * around / 3]);
    Pair::new((mesh::limb(ratio, around), marks.clone()), (mesh::sphere(around, around), marks))
}

#[test]
fn a_limb_inside_a_patch_embeds_up_to_sixteen_times_its_girth() {
    for around in [4, 7, 12, 16] {
        for ratio in [1.0, 3.0, 5.0, 8.0, 16.0] {
            let pair = limb_pair(ratio, around);
            let embedding = embedded(&pair);
            check::embedding(&embedding, &pair.meshes);
            let discs = embedding.meshes[0].discs.iter_ids();
            let energy = |(p, disc): (_, &PatchDisc)| {
                let stretch = patch_stretch(disc, &embedding.meshes[0].points(p), &embedding.frames[p]);
                e_l2(&stretch, embedding.frames[p].area())
            };
            let worst = discs.map(energy).fold(0.0, f64::max);
            // Area is kept while a girth becomes a circle: E_L2 grows like the root of the length, at worst linearly.
            assert!(worst < 4.0 + 3.0 * ratio, "around {around}, ratio {ratio}: E_L2 {worst}");
            let least = certify(&embedding).min_orientation;
            assert!(least > 1e-10, "around {around}, ratio {ratio}: {least:e}");
        }
    }
}

#[test]
fn slivers_and_uneven_meshes_embed() {
    let sources = [mesh::sphere(2, 60), fixture::slivers(3), mesh::sphere(60, 3)];
    for (seed, source) in sources.into_iter().enumerate() {
        let target = fixture::uneven(1e4, 24);
        let marks = |m: &TriMesh| random_landmarks(m, 5, seed as u64);
        let (la, lb) = (marks(&source), marks(&target));
        let pair = Pair::new((source, la), (target, lb));
        check::embedding(&embedded(&pair), &pair.meshes);
    }
}

#[test]
fn every_face_of_the_cut_mesh_is_in_one_patch() {
    for mesh in &embedded(&pair(10, 8)).meshes {
        let mut times = vec![0; mesh.cut.conn.face_count()];
        mesh.discs.iter().flat_map(|d| &d.faces).for_each(|f| times[f.index()] += 1);
        assert!(times.iter().all(|&n| n == 1));
        for disc in mesh.discs.iter() {
            for (&f, t) in disc.faces.iter().zip(&disc.triangles) {
                assert_eq!(t.map(|v| disc.vertices[v as usize]), mesh.cut.conn.face(f));
                assert!(mesh.cut.conn.halfedges().any(|h| face_of(h) == f));
            }
        }
    }
}

#[test]
fn one_thread_and_two_give_the_same_positions() {
    let pair = pair(11, 9);
    let [one, two] = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a small pool");
        pool.install(|| pair.embed()).expect("an embedding")
    });
    for (a, b) in one.meshes.iter().zip(&two.meshes) {
        assert_eq!(a.shares, b.shares);
        assert_eq!(a.cut.positions, b.cut.positions);
        for (d, e) in a.discs.iter().zip(b.discs.iter()) {
            assert_eq!(d.positions, e.positions);
            assert_eq!(d.triangles, e.triangles);
        }
    }
}
