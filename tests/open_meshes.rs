//! Open meshes and meshes in several pieces: boundaries go onto boundaries, exactly and in order.

mod common;

use common::check;
use common::mesh::{grid, mesh, vertices};
use glam::DVec3;
use homeo::ErrorKind;
use homeo::gpu::{Compute, Device, DeviceChoice};
use homeo::map::surface_map::SurfaceMap;
use homeo::mesh::io::{MeshFile, write_obj};
use homeo::mesh::{HalfedgeId, Id, SurfacePoint, TriMesh, VertexId};
use homeo::path::rim::rims;
use homeo::pipeline::{MapJob, MapOptions, Silent, run_maps};
use homeo::shape::fixture::{annulus, disc, icosphere, sphere_with_holes, torus};
use homeo::shape::random_landmarks;
use homeo::stage::check::Guides;
use homeo::stage::cluster::{BaseVertices, cluster};
use homeo::stage::compose::{Composed, compose};
use homeo::stage::embed::embed;
use homeo::stage::layout::layouts;
use homeo::stage::polish::{DREAD, polish_samples};
use homeo::stage::relax::{RelaxOptions, promise, relax_arcs};

/// Maps a pair and checks the layout, the certificate, the images, the landmarks and the boundaries.
fn map(meshes: [TriMesh; 2], landmarks: [Vec<VertexId>; 2]) -> Composed {
    let both = [&meshes[0], &meshes[1]];
    let sets = cluster(both, [&landmarks[0], &landmarks[1]], &Guides::default());
    let layout = layouts(both, &sets, 3, 1).expect("a layout").remove(0);
    check::layout(&layout, &meshes);
    let (mut embedding, _) = embed(both, layout).expect("an embedding");
    let short = RelaxOptions { coarse_rounds: 1, fine_rounds: 0, ..RelaxOptions::default() };
    relax_arcs(&Compute::Cpu, both, &mut embedding, &short).expect("a relaxed map");
    polish_samples(both, &mut embedding, 0.05, &DREAD).expect("a polished map");
    check::embedding(&embedding, &meshes);
    let composed = compose(both, embedding).expect("a map");
    assert!(composed.certificate.bijective, "{:?}", composed.certificate);
    for k in 0..2 {
        check::images(&composed.maps[k], both[1 - k]);
        for (&v, &w) in landmarks[k].iter().zip(&landmarks[1 - k]) {
            assert_eq!(composed.maps[k].images[v], Some(SurfacePoint::Vertex(w)), "a landmark of mesh {k}");
        }
        boundary_onto_boundary(both[k], both[1 - k], &composed.maps[k]);
    }
    composed
}

/// Every boundary vertex goes to a vertex or into an edge of the other boundary, once around each loop in order.
fn boundary_onto_boundary(from: &TriMesh, onto: &TriMesh, map: &SurfaceMap) {
    let loops = onto.conn.boundary_loops();
    let place =
        |h: HalfedgeId| loops.iter().enumerate().find_map(|(l, one)| Some((l, one.iter().position(|&k| k == h)?)));
    let mut hit = vec![false; loops.len()];
    for one in from.conn.boundary_loops() {
        let images: Vec<(usize, f64)> = one
            .iter()
            .map(|&h| match map.images[from.conn.from(h)].expect("boundary vertices are on faces") {
                SurfacePoint::Vertex(v) => place(onto.conn.leaving(v).expect("used")).map(|(l, i)| (l, i as f64)),
                SurfacePoint::Edge(h, t) => place(h).map(|(l, i)| (l, i as f64 + t)),
                SurfacePoint::Face(..) => None,
            })
            .map(|image| image.expect("on the boundary, without rounding"))
            .collect();
        let goal = images[0].0;
        assert!(images.iter().all(|&(l, _)| l == goal), "a loop goes to one loop: {images:?}");
        assert!(!std::mem::replace(&mut hit[goal], true), "two loops go to one");
        let n = images.len();
        let descents = (0..n).filter(|&i| images[(i + 1) % n].1 <= images[i].1).count();
        assert_eq!(descents, 1, "once around, in order: {images:?}");
    }
}

fn bent(mut mesh: TriMesh) -> TriMesh {
    mesh.positions.raw.iter_mut().for_each(|p| *p = DVec3::new(p.x, 0.8 * p.y, p.z + 0.3 * p.x * p.x - 0.2 * p.y));
    mesh
}

/// The boundary vertex of the unit disc nearest to the direction `turns`, in shares of a full turn.
fn at_rim(mesh: &TriMesh, turns: f64) -> VertexId {
    let angle = std::f64::consts::TAU * turns;
    let goal = DVec3::new(angle.cos(), angle.sin(), 0.0);
    let rim = mesh.conn.vertices().filter(|&v| mesh.conn.is_on_boundary(v));
    let nearest = rim.min_by(|&v, &w| mesh.positions[v].distance(goal).total_cmp(&mesh.positions[w].distance(goal)));
    nearest.expect("the mesh is open")
}

fn inner(mesh: &TriMesh, n: usize, seed: u64) -> Vec<VertexId> {
    let all = random_landmarks(mesh, mesh.positions.len(), seed);
    all.into_iter().filter(|&v| !mesh.conn.is_on_boundary(v)).take(n).collect()
}

/// One mesh beside the other.
fn beside(a: &TriMesh, b: &TriMesh) -> TriMesh {
    let n = a.positions.len();
    let positions = a.positions.iter().copied().chain(b.positions.iter().map(|&p| p + DVec3::X * 4.0)).collect();
    let numbers = |t: [VertexId; 3], shift: usize| t.map(|v| v.index() + shift);
    let faces: Vec<_> =
        a.faces().into_iter().map(|t| numbers(t, 0)).chain(b.faces().into_iter().map(|t| numbers(t, n))).collect();
    mesh(positions, &faces)
}

#[test]
fn a_disc_with_landmarks_on_its_boundary_and_inside() {
    for on_rim in 1..=5 {
        let meshes = [disc(5), bent(disc(7))];
        let landmarks = meshes.each_ref().map(|m| {
            let rim = (0..on_rim).map(|k| at_rim(&disc(if m.positions.len() == 91 { 5 } else { 7 }), k as f64 / 5.0));
            rim.chain(inner(m, 3, 9)).collect()
        });
        map(meshes, landmarks);
    }
}

#[test]
fn a_disc_with_a_single_landmark_anywhere() {
    for source in [VertexId(0), VertexId(7), VertexId(90)] {
        let target = if source == VertexId(90) { at_rim(&disc(4), 0.3) } else { VertexId(2) };
        map([disc(5), bent(disc(4))], [vec![source], vec![target]]);
    }
}

#[test]
fn the_disc_onto_itself_is_the_identity_on_the_boundary() {
    let landmarks = vec![VertexId(0), at_rim(&disc(4), 0.0), at_rim(&disc(4), 0.4)];
    let composed = map([disc(4), disc(4)], [landmarks.clone(), landmarks]);
    let mesh = disc(4);
    for v in mesh.conn.vertices().filter(|&v| mesh.conn.is_on_boundary(v)) {
        assert_eq!(composed.maps[0].images[v], Some(SurfacePoint::Vertex(v)));
    }
}

///   +---+     two triangles, every vertex on the boundary
///   | \ |
///   +---+
#[test]
fn a_square_without_a_vertex_inside() {
    map([grid(1, 1), grid(1, 1)], [vertices(&[0]), vertices(&[3])]);
    map([grid(1, 1), grid(3, 2)], [vertices(&[0, 1, 3, 2]), vertices(&[0, 3, 11, 8])]);
}

#[test]
fn an_annulus_with_and_without_landmarks_on_its_loops() {
    let (a, b) = (annulus(14, 3), bent(annulus(20, 4)));
    // Vertices (i, j) are number i (m + 1) + j; j = 0 is the inner loop.
    let at = |m: u32, i: u32, j: u32| VertexId(i * (m + 1) + j);
    let inside = [vec![at(3, 0, 1), at(3, 5, 2), at(3, 10, 1)], vec![at(4, 0, 2), at(4, 7, 2), at(4, 14, 1)]];
    map([a.clone(), b.clone()], inside.clone());
    let mut outer = inside.clone();
    outer[0].extend([at(3, 2, 3), at(3, 8, 3)]);
    outer[1].extend([at(4, 3, 4), at(4, 11, 4)]);
    map([a.clone(), b.clone()], outer.clone());
    outer[0].extend([at(3, 1, 0), at(3, 5, 0), at(3, 9, 0), at(3, 12, 0)]);
    outer[1].extend([at(4, 1, 0), at(4, 7, 0), at(4, 13, 0), at(4, 17, 0)]);
    map([a, b], outer);
}

#[test]
fn loops_of_three_edges_with_nothing_between() {
    map([annulus(3, 1), annulus(3, 2)], [vertices(&[0]), vertices(&[0])]);
}

#[test]
fn spheres_with_one_to_three_holes_without_landmarks_on_them() {
    for holes in 1..=3 {
        let mut meshes = [sphere_with_holes(holes, 2), sphere_with_holes(holes, 3)];
        meshes[1].positions.raw.iter_mut().for_each(|p| *p *= DVec3::new(1.2, 1.0, 0.9));
        // The icosahedron's other vertices keep their numbers in every subdivision.
        let marks = vertices(&[0, 2, 3, 5, 6, 8]);
        let composed = map(meshes.clone(), [marks.clone(), marks]);
        let middle = |one: &Vec<HalfedgeId>, m: &TriMesh| {
            one.iter().map(|&h| m.positions[m.conn.from(h)]).sum::<DVec3>() / one.len() as f64
        };
        for one in meshes[0].conn.boundary_loops() {
            let v = meshes[0].conn.from(one[0]);
            let image = composed.maps[0].images[v].expect("used").position(&meshes[1]);
            let near = |l: &Vec<HalfedgeId>| middle(l, &meshes[1]).distance(image);
            let loops = meshes[1].conn.boundary_loops();
            let nearest = loops.iter().min_by(|a, b| near(a).total_cmp(&near(b))).expect("as many loops");
            assert!(
                middle(&one, &meshes[0]).distance(middle(nearest, &meshes[1])) < 0.4,
                "loops in the same place match"
            );
        }
    }
}

#[test]
fn a_torus_with_a_hole() {
    let punctured = |n: u32, m: u32| {
        let torus = torus(n, m);
        let kept: Vec<_> = torus.faces().into_iter().filter(|t| !t.contains(&VertexId(0))).collect();
        let faces: Vec<_> = kept.into_iter().map(|t| t.map(|v| v.index() - 1)).collect();
        mesh(torus.positions.raw[1..].to_vec(), &faces)
    };
    let at = |m: u32, i: u32, j: u32| VertexId(i * m + j - 1);
    let landmarks = [[1, 0], [5, 2], [9, 4], [3, 6]];
    let source = landmarks.map(|[i, j]| at(8, i, j)).to_vec();
    let target = landmarks.map(|[i, j]| at(10, i, j + j / 4)).to_vec();
    map([punctured(12, 8), bent(punctured(12, 10))], [source, target]);
}

#[test]
fn two_components_a_disc_and_a_sphere() {
    let meshes = [beside(&disc(4), &icosphere(2)), beside(&icosphere(1), &bent(disc(5)))];
    let (on_source, on_target) = (disc(4).positions.len(), icosphere(1).positions.len());
    let source = vertices(&[0, 3, on_source, on_source + 3, on_source + 7, on_source + 10]);
    let target = vertices(&[on_target, on_target + 2, 0, 3, 7, 10]);
    map(meshes, [source, target]);
}

/// The whole run: what is written about an annulus beside a sphere.
#[test]
fn the_report_and_the_tables_are_those_of_the_open_mesh() {
    let meshes = [beside(&annulus(14, 3), &icosphere(1)), beside(&bent(annulus(20, 4)), &icosphere(2))];
    let (n, m) = (14 * 4, 20 * 5);
    let rows = [[1, 2], [22, 37], [43, 71], [n, m], [n + 3, m + 3], [n + 7, m + 7]];
    let dir = std::env::temp_dir().join(format!("homeo-open-{}", std::process::id()));
    std::fs::create_dir_all(&dir).expect("the temporary folder is writable");
    let file = |name: &str| dir.join(name);
    for (mesh, name) in meshes.iter().zip(["source.obj", "target.obj"]) {
        let mut text = Vec::new();
        write_obj(&mut text, &dir, &MeshFile::of(mesh), &mesh.positions.raw).expect("memory takes it");
        std::fs::write(file(name), text).expect("the temporary folder is writable");
    }
    let table: String = rows.iter().enumerate().map(|(i, [s, t])| format!("mark{i},{s},{t}\n")).collect();
    std::fs::write(file("marks.csv"), "name,source_vertex,target_vertex\n".to_owned() + &table).expect("writable");
    let job = MapJob {
        source: file("source.obj"),
        target: file("target.obj"),
        landmarks: file("marks.csv"),
        target_landmarks: None,
        hint: None,
        texture: None,
        out: file("out"),
    };
    let options = MapOptions { image: 9, ..MapOptions::default() };
    let device = Device::open(&DeviceChoice::Cpu).expect("the CPU is always there");
    let mut reports = Vec::new();
    run_maps(vec![job], &options, &device, &Silent, |outcome| reports.push(outcome.value.expect("a map")));
    let report = &reports[0];
    assert!(report.certificate.bijective);
    assert_eq!(report.landmarks, 6);
    for (summary, mesh) in [&report.source, &report.target].into_iter().zip(&meshes) {
        assert_eq!((summary.genus, summary.boundary_loops), (0, 2));
        assert_eq!(summary.faces, mesh.conn.face_count());
    }
    let csv = std::fs::read_to_string(file("out/source_on_target.csv")).expect("the table is written");
    let mut on_boundary = 0;
    for (v, line) in csv.lines().skip(1).enumerate() {
        let zeros = line.split(',').skip(2).filter(|b| b.parse() == Ok(0.0)).count();
        let is_on_boundary = meshes[0].conn.is_on_boundary(VertexId::new(v));
        assert!(zeros >= 1 || !is_on_boundary, "{line}");
        on_boundary += usize::from(is_on_boundary);
    }
    assert_eq!(on_boundary, 28);
    std::fs::remove_dir_all(dir).expect("the folder is ours");
}

#[test]
fn rims_are_numbered_from_the_lowest_base_vertex_with_the_surface_at_their_left() {
    let mesh = grid(2, 2);
    let rims = rims(&mesh, &vertices(&[8, 0, 4, 2]));
    let ends: Vec<[usize; 2]> = rims.iter().map(|r| r.ends.map(Id::index)).collect();
    assert_eq!(ends, [[0, 1], [1, 3], [3, 0]], "vertex 4, number 2, lies inside");
    let walked: Vec<usize> = rims.iter().flat_map(|r| &r.halfedges).map(|&h| mesh.conn.from(h).index()).collect();
    assert_eq!(walked, [8, 7, 6, 3, 0, 1, 2, 5]);
}

#[test]
fn base_vertices_in_another_order_around_a_loop_give_no_layout() {
    let meshes = [disc(4), disc(4)];
    let at = |turns: f64| at_rim(&meshes[0], turns);
    let landmarks = [vec![at(0.0), at(0.3), at(0.6)], vec![at(0.3), at(0.0), at(0.6)]];
    let set = BaseVertices::grow([&meshes[0], &meshes[1]], landmarks, 3);
    let error = layouts([&meshes[0], &meshes[1]], &[set], 3, 1);
    assert_eq!(error.err().map(|e| e.kind), Some(ErrorKind::Bug), "the check stage refuses such pairs by name");
}

/// The only patch has no arc to relax across, so nothing tells what the layout will come to: it is taken last, but it is.
#[test]
fn a_layout_of_one_patch_promises_nothing_and_is_mapped() {
    let meshes = [disc(4), bent(disc(6))];
    let landmarks = meshes.each_ref().map(|m| (0..3).map(|k| at_rim(m, f64::from(k) / 3.0)).collect::<Vec<_>>());
    let both = [&meshes[0], &meshes[1]];
    let set = BaseVertices::grow(both, landmarks.clone(), 3);
    let layout = layouts(both, &[set], 3, 1).expect("a layout").remove(0);
    assert_eq!(layout.base.patches.len(), 1);
    let (embedding, _) = embed(both, layout).expect("an embedding");
    assert_eq!(promise(&Compute::Cpu, both, &embedding).expect("the CPU is there"), f64::INFINITY);
    map(meshes, landmarks);
}
