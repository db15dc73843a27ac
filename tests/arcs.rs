//! Paths over edge nodes and arcs on the cut mesh.

mod common;

use common::run::{EDGE_NODES, Pair};
use common::{check, mesh};
use homeo::mesh::{ArcId, FaceId, Id, IdVec, LandmarkId, VertexId};
use homeo::path::base_complex::DirectedArc;
use homeo::path::cut_mesh::CutMesh;
use homeo::path::network::{Corner, connect, embed, rotation, sectors};
use homeo::path::rebuild::rebuild;
use homeo::path::region::base_complex;
use homeo::path::search::{Anywhere, Path, Searcher, Terminal};
use homeo::shape::fixture;
use homeo::shape::{SplitMix, random_landmarks};
use homeo::stage::layout::Layout;

fn path(cut: &CutMesh, a: VertexId, b: VertexId) -> Path {
    let [start, goal] = [a, b].map(|v| Terminal::whole(cut, v));
    Searcher::default().shortest(cut, &start, &goal, &Anywhere).expect("a connected mesh has a path")
}

#[test]
fn paths_on_a_plane_are_nearly_straight_and_more_nodes_never_lengthen_them() {
    // All edges are equally long, so every edge has exactly the nodes asked for.
    let mesh = mesh::lattice(12, 9);
    let mut random = SplitMix::new(1);
    for _ in 0..40 {
        let [a, b] = [(); 2].map(|()| VertexId::new(random.below(mesh.positions.len())));
        if a == b {
            continue;
        }
        let straight = mesh.positions[a].distance(mesh.positions[b]);
        // Node counts 1, 3, 7: each set of nodes contains the one before.
        let lengths = [1, 3, 7].map(|nodes| path(&CutMesh::new(&mesh, &[a, b], nodes), a, b).length);
        assert!(lengths[0] >= straight * (1.0 - 1e-12));
        assert!(lengths[0] <= 1.12 * straight, "one node: {} for {straight}", lengths[0]);
        assert!(lengths[1] <= 1.03 * straight, "three nodes: {} for {straight}", lengths[1]);
        assert!(lengths[1] <= lengths[0] * (1.0 + 1e-12) && lengths[2] <= lengths[1] * (1.0 + 1e-12), "{lengths:?}");
    }
}

#[test]
fn sectors_part_the_neighbourhood_at_the_arcs() {
    let mesh = mesh::octahedron();
    let landmarks = mesh::vertices(&[0, 2, 4]);
    let mut cut = CutMesh::new(&mesh, &landmarks, EDGE_NODES);
    let pole = cut.landmarks[LandmarkId(0)];
    assert_eq!(sectors(&cut, pole, &|_| true).len(), 1);
    assert!(rotation(&cut, LandmarkId(0), &|_| true).is_empty());
    for (arc, end) in [(ArcId(0), 2), (ArcId(1), 4)] {
        let h = cut.conn.find(pole, VertexId::new(end)).expect("the pole meets the equator");
        cut.mark(h, DirectedArc { arc, reversed: false });
    }
    let both = sectors(&cut, pole, &|_| true);
    assert_eq!(both.iter().map(|s| s.halfedges.len()).collect::<Vec<_>>(), [2, 2]);
    assert_eq!(both.iter().map(|s| s.halfedges.len()).sum::<usize>(), cut.conn.outgoing(pole).count());
    assert_eq!(sectors(&cut, pole, &|a| a == ArcId(1)).len(), 1);
    assert_eq!(rotation(&cut, LandmarkId(0), &|_| true).len(), 2);
}

/// A strip one face wide on either side of an arc: the second arc has to cross faces more than once.
#[test]
fn an_arc_beside_another_embeds_where_no_vertex_is_free() {
    let mesh = fixture::tetrahedron();
    let landmarks = mesh::vertices(&[0, 1, 2, 3]);
    let mut cut = CutMesh::new(&mesh, &landmarks, EDGE_NODES);
    let mut searcher = Searcher::default();
    let mut laid = 0;
    // Three arcs between landmarks 0 and 1, then two between 2 and 3 would cross them: each sector once.
    for after in [None, Some(ArcId(0))] {
        let corner = |landmark: u32, reversed: bool| Corner {
            landmark: LandmarkId(landmark),
            after: after.map(|arc| DirectedArc { arc, reversed }),
        };
        let ends = [corner(0, false), corner(1, true)];
        let path = connect(&mut cut, &mesh, &mut searcher, ends).expect("corners of one region");
        embed(&mut cut, &mesh, &path, ArcId(laid)).expect("a shortest path embeds");
        laid += 1;
        check::cut_mesh(&cut, &mesh);
    }
    let arcs = IdVec::from_raw(vec![[LandmarkId(0), LandmarkId(1)]; laid as usize]);
    for (arc, ends) in arcs.iter_ids() {
        let path = cut.arc_path(arc, ends[0]);
        assert_eq!(path.last().map(|&h| cut.conn.to(h)), Some(cut.landmarks[ends[1]]));
    }
}

#[test]
fn a_region_without_a_free_node_is_refined_until_a_path_exists() {
    // No edge nodes, and every vertex is a landmark: a path from pole to pole has nowhere to pass.
    let mesh = mesh::octahedron();
    let landmarks = mesh::vertices(&[0, 1, 2, 3, 4, 5]);
    let mut cut = CutMesh::new(&mesh, &landmarks, 0);
    let ends = [0, 1].map(|l| Corner { landmark: LandmarkId(l), after: None });
    let whole = ends.map(|c| Terminal::whole(&cut, cut.landmarks[c.landmark]));
    assert_eq!(Searcher::default().shortest(&cut, &whole[0], &whole[1], &Anywhere), None);
    let path = connect(&mut cut, &mesh, &mut Searcher::default(), ends).expect("a path after refinement");
    embed(&mut cut, &mesh, &path, ArcId(0)).expect("it embeds");
    check::cut_mesh(&cut, &mesh);
    assert!(cut.conn.vertex_count() > 6);
}

fn laid_out(seed: u64, n: usize) -> (Pair, Layout) {
    let [a, b] = [mesh::sphere(9, 16), mesh::crumpled(150, seed)];
    let [la, lb] = [random_landmarks(&a, n, seed), random_landmarks(&b, n, seed + 1)];
    let pair = Pair::new((a, la), (b, lb));
    let layout = pair.layout().expect("a layout");
    (pair, layout)
}

#[test]
fn cut_meshes_cover_their_mesh_seeds_1_to_6() {
    for seed in 1..=6 {
        let (pair, layout) = laid_out(seed, 8);
        for (cut, mesh) in layout.cuts.iter().zip(&pair.meshes) {
            check::cut_mesh(cut, mesh);
            check::arcs(cut, &layout.base);
            let area = mesh.area();
            assert!((check::area(cut) - area).abs() < 1e-9 * area);
        }
    }
}

#[test]
fn rebuilding_keeps_the_base_complex_and_shortens_arcs_seeds_1_to_6() {
    for seed in 1..=6 {
        let (pair, layout) = laid_out(seed, 10);
        for (cut, mesh) in layout.cuts.iter().zip(&pair.meshes) {
            let built = rebuild(mesh, cut, &layout.base.arcs, EDGE_NODES).expect("arcs are apart");
            check::cut_mesh(&built, mesh);
            check::arcs(&built, &layout.base);
            let base = base_complex(&built, &layout.base.arcs).expect("a base complex");
            assert_eq!(base, layout.base);
            let total = |cut: &CutMesh| -> f64 {
                let halfedges = layout.base.arcs.iter_ids().flat_map(|(arc, ends)| cut.arc_path(arc, ends[0]));
                halfedges.map(|h| cut.length(h)).sum()
            };
            assert!(total(&built) <= total(cut) * 1.001, "{} from {}", total(&built), total(cut));
        }
    }
}

#[test]
fn splitting_where_nothing_runs_changes_no_arc_seed_7() {
    let (pair, layout) = laid_out(7, 6);
    let (mut cut, mesh) = (layout.cuts[0].clone(), &pair.meshes[0]);
    let mut random = SplitMix::new(7);
    for _ in 0..200 {
        let f = FaceId::new(random.below(cut.conn.face_count()));
        if random.unit() < 0.7 {
            cut.split_edge(mesh, homeo::mesh::corner(f, random.below(3)), 0.1 + 0.8 * random.unit());
        } else {
            cut.split_face(mesh, f);
        }
    }
    check::cut_mesh(&cut, mesh);
    check::arcs(&cut, &layout.base);
    assert_eq!(base_complex(&cut, &layout.base.arcs).expect("a base complex"), layout.base);
}
