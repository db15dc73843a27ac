//! Other ways to lay arcs out: along hypotheses from a rough map, and greedily.

mod common;

use common::check;
use common::run::{EDGE_NODES, Pair};
use glam::DVec3;
use homeo::gpu::{Device, DeviceChoice};
use homeo::mesh::{Id, LandmarkId, SurfacePoint, TriMesh, VertexId};
use homeo::pipeline::{LayoutMethod, MapOptions, Mapped, Silent, map_pairs};
use homeo::shape::fixture::{annulus, ellipsoid, genus, icosphere, torus};
use homeo::shape::{PairOptions, Quadruped, SplitMix, nudge_landmarks, quadruped, random_landmarks, random_pair};
use homeo::stage::cluster::BaseVertices;
use homeo::stage::compose::compose;
use homeo::stage::greedy::Greedy;
use homeo::stage::hypothesis::{path_hypotheses, rough_map};
use homeo::stage::layout::{Layout, greedy_layout, guided_by, layouts, published_layout};
use homeo::stage::load::Loaded;

fn vertices(numbers: &[u32]) -> Vec<VertexId> {
    numbers.iter().map(|&v| VertexId(v)).collect()
}

fn quadrupeds() -> Pair {
    let [bull, mule] = [quadruped(Quadruped::Bull, 900), quadruped(Quadruped::Mule, 1100)];
    let vertices = |landmarks: Vec<(String, VertexId)>| landmarks.into_iter().map(|(_, v)| v).collect();
    Pair::new((bull.mesh, vertices(bull.landmarks)), (mule.mesh, vertices(mule.landmarks)))
}

fn base(pair: &Pair) -> BaseVertices {
    BaseVertices::grow([&pair.meshes[0], &pair.meshes[1]], pair.landmarks.clone(), pair.landmarks[0].len())
}

/// The layouts along hypotheses, the shortest first.
fn guided(pair: &Pair) -> Vec<Layout> {
    let (both, set) = ([&pair.meshes[0], &pair.meshes[1]], base(pair));
    let rough = rough_map(both, set.vertices.each_ref().map(Vec::as_slice)).expect("a rough map");
    guided_by(both, &set, &rough, EDGE_NODES).expect("layouts")
}

#[test]
fn of_a_mesh_onto_itself_the_rough_map_is_nearly_the_identity() {
    let mesh = ellipsoid(DVec3::new(1.0, 0.7, 0.5), 4);
    let landmarks: Vec<VertexId> = mesh.conn.vertices().step_by(40).collect();
    let rough = rough_map([&mesh, &mesh], [&landmarks, &landmarks]).expect("a rough map");
    let far = mesh.conn.vertices().map(|v| rough[v].distance(mesh.positions[v])).fold(0.0, f64::max);
    assert!(far < 0.1, "{far}");
    assert!(landmarks.iter().all(|&l| rough[l] == mesh.positions[l]));
}

#[test]
fn hypotheses_come_shortest_first_and_pass_no_other_landmark() {
    let pair = quadrupeds();
    let (both, set) = ([&pair.meshes[0], &pair.meshes[1]], base(&pair));
    let landmarks = set.vertices.each_ref().map(Vec::as_slice);
    let rough = rough_map(both, landmarks).expect("a rough map");
    let all = path_hypotheses(both, landmarks, &rough);
    assert!(all.len() > 2 * landmarks[0].len());
    assert!(all.windows(2).all(|w| w[0].lengths[1] <= w[1].lengths[1]));
    for path in &all {
        let [along, near] = &path.vertices;
        let ends = path.ends.map(|l| [0, 1].map(|k| landmarks[k][l.index()]));
        assert_eq!([along[0], along[along.len() - 1]], [ends[0][0], ends[1][0]]);
        assert!(along[1..along.len() - 1].iter().all(|v| !landmarks[0].contains(v)), "{:?}", path.ends);
        assert!(ends.iter().all(|end| near.contains(&end[1])), "{:?}", path.ends);
    }
}

#[test]
fn every_method_gives_one_complex_on_both_meshes() {
    let pair = quadrupeds();
    let (both, set) = ([&pair.meshes[0], &pair.meshes[1]], base(&pair));
    guided(&pair).iter().for_each(|layout| check::layout(layout, &pair.meshes));
    for edge_nodes in [1, EDGE_NODES] {
        let published = published_layout(both, &set, edge_nodes).expect("a layout");
        check::layout(&published, &pair.meshes);
        let Greedy::Complete(greedy) = greedy_layout(both, &set, edge_nodes).expect("no failure but getting stuck")
        else {
            panic!("the greedy layout is stuck");
        };
        check::layout(&greedy, &pair.meshes);
    }
}

/// Around a torus two ways join opposite landmarks. The second landmark lies a column beyond the opposite side on the source
/// and a column before it on the target, so the shortest paths go around on different sides; the hypothesis is that of the
/// source.
#[test]
fn the_hypothesis_decides_which_way_around_a_handle() {
    let mesh = torus(48, 16);
    let sites = |column: u32| vec![VertexId(0), VertexId(column * 16)];
    let set = BaseVertices::grow([&mesh, &mesh], [sites(25), sites(23)], 2);
    for layout in guided_by([&mesh, &mesh], &set, &mesh.positions, EDGE_NODES).expect("layouts") {
        check::layout(&layout, &[mesh.clone(), mesh.clone()]);
        let first = layout.base.arcs.iter_ids().find(|(_, ends)| **ends == [LandmarkId(0), LandmarkId(1)]);
        let (arc, ends) = first.expect("an arc between the two");
        for cut in &layout.cuts {
            let along = cut.arc_path(arc, ends[0]);
            let side: f64 = along.iter().map(|&h| cut.positions[cut.conn.to(h)].y).sum();
            assert!(side < 0.0, "not the way of the hypothesis");
        }
    }
}

/// Where a base vertex is passed on different sides on the two meshes before it has an arc, its arcs wind around those that are
/// there: so it is with seed 27 if the outermost base vertices lead alone.
#[test]
fn guided_arcs_do_not_wind_wherever_the_landmarks_are() {
    for seed in 24..28 {
        let mut pair = quadrupeds();
        let mut random = SplitMix::new(seed);
        for (mesh, landmarks) in pair.meshes.iter().zip(&mut pair.landmarks) {
            nudge_landmarks(mesh, landmarks, &mut random);
        }
        let both = [&pair.meshes[0], &pair.meshes[1]];
        let usual = layouts(both, &[base(&pair)], EDGE_NODES, 1).expect("a layout")[0].size(both);
        let guided = guided(&pair)[0].size(both);
        assert!(guided < 1.25 * usual, "seed {seed}: {guided}, through cells {usual}");
    }
}

#[test]
fn guided_layouts_on_surfaces_of_all_kinds_seeds_31_to_36() {
    let mut pairs: Vec<(TriMesh, TriMesh, Vec<VertexId>, Vec<VertexId>)> = Vec::new();
    for (seed, g) in (31u64..).zip(0..=2) {
        let pair =
            random_pair(&PairOptions { genus: g, loops: 0, landmarks: 10, vertices: [700, 900], related: true }, seed);
        let [source, target] = pair.meshes;
        let [on_source, on_target] = pair.landmarks;
        pairs.push((source, target, on_source, on_target));
    }
    for (seed, mesh) in (34u64..).zip([icosphere(3), genus(1, 600)]) {
        let [a, b] = [seed, seed + 100].map(|s| random_landmarks(&mesh, 9, s));
        pairs.push((mesh.clone(), mesh, a, b));
    }
    let ring = annulus(12, 5);
    let marks = vertices(&[1, 15, 40, 59]);
    pairs.push((ring.clone(), ring, marks.clone(), marks));
    for (i, (source, target, on_source, on_target)) in pairs.into_iter().enumerate() {
        let loaded = Loaded::of([&source, &target], [&on_source, &on_target]);
        let mapped =
            map_with(loaded, LayoutMethod::Hypothesis { cycles: 2 }).unwrap_or_else(|e| panic!("pair {i}: {e}"));
        common::job::assert_sound(&mapped, &format!("pair {i}"));
        assert_eq!(mapped.layout.kind, "hypothesis");
    }
}

/// With three landmarks a torus needs several arcs between the same two, or loops: the heuristic knows neither.
#[test]
fn a_stuck_greedy_layout_is_unsolvable_and_names_the_landmarks() {
    let mesh = torus(24, 12);
    let landmarks = vertices(&[0, 100, 200]);
    let outcome = map(&mesh, &landmarks, LayoutMethod::Greedy);
    let error = outcome.expect_err("three arcs do not cut a torus open");
    assert_eq!(error.kind, homeo::ErrorKind::Unsolvable, "{error}");
    let names = Loaded::of([&mesh, &mesh], [&landmarks, &landmarks]).landmarks.expect("landmarks").names;
    assert!(names.iter().any(|name| error.element.contains(&format!("'{name}'"))), "{error}");
    assert!(error.remedy.contains("voronoi"), "{error}");
    let guided = map(&mesh, &landmarks, LayoutMethod::Hypothesis { cycles: 1 }).expect("a map");
    common::job::assert_sound(&guided, "torus");
}

/// Maps a mesh onto itself.
fn map(mesh: &TriMesh, landmarks: &[VertexId], layout: LayoutMethod) -> homeo::Result<Mapped> {
    map_with(Loaded::of([mesh, mesh], [landmarks, landmarks]), layout)
}

fn map_with(loaded: Loaded, layout: LayoutMethod) -> homeo::Result<Mapped> {
    let options = MapOptions { layout, ..MapOptions::default() };
    let device = Device::open(&DeviceChoice::Cpu).expect("the CPU is there");
    let mut outcomes = Vec::new();
    map_pairs(std::iter::once(loaded), &options, &device, &Silent, |outcome| outcomes.push(outcome.value));
    outcomes.pop().expect("one outcome")
}

#[test]
fn a_guided_layout_leads_to_a_certified_map_that_meets_the_landmarks() {
    let pair = quadrupeds();
    let both = [&pair.meshes[0], &pair.meshes[1]];
    let (embedding, _) = homeo::stage::embed::embed(both, guided(&pair).swap_remove(0)).expect("an embedding");
    let composed = compose(both, embedding).expect("a map");
    assert!(composed.certificate.bijective);
    for (&from, &to) in pair.landmarks[0].iter().zip(&pair.landmarks[1]) {
        assert_eq!(composed.maps[0].images[from], Some(SurfacePoint::Vertex(to)));
    }
}
