//! Active refinement: the compatible meshes come nearer to the other surface by few vertices, and nothing else changes.

mod common;

use common::run::Pair;
use glam::DVec3;
use homeo::gpu::{Compute, Device, DeviceChoice};
use homeo::mesh::face_tree::FaceTree;
use homeo::mesh::io::{MeshFile, read_mesh};
use homeo::mesh::{Id, SurfacePoint, TriMesh, VertexId};
use homeo::pipeline::{MapJob, MapOptions, Silent, run_maps};
use homeo::shape::fixture::icosphere;
use homeo::stage::compose::{Composed, compose};
use homeo::stage::refine::{RefineOptions, Refinement, refine};
use homeo::stage::relax::{RelaxOptions, relax_arcs};
use std::fmt::Write;

/// A coarse sphere and a fine one with a horn, which the coarse one lacks.
fn sphere_and_horn() -> Pair {
    let coarse = icosphere(3);
    let mut fine = icosphere(5);
    let tip = DVec3::new(0.3, 0.5, 0.8).normalize();
    for p in &mut fine.positions.raw {
        *p *= 1.0 + 0.8 * (-60.0 * p.distance_squared(tip)).exp();
    }
    let corners: Vec<VertexId> = (0..12).map(VertexId).collect();
    Pair::new((coarse, corners.clone()), (fine, corners))
}

fn finished(pair: &Pair) -> Composed {
    let both = [&pair.meshes[0], &pair.meshes[1]];
    let mut embedding = pair.embed().expect("an embedding");
    let short = RelaxOptions { coarse_rounds: 1, fine_rounds: 1, ..RelaxOptions::default() };
    relax_arcs(&Compute::Cpu, both, &mut embedding, &short).expect("a relaxed map");
    compose(both, embedding).expect("a map")
}

/// The compatible mesh of a refinement.
fn compatible(refinement: &Refinement, other: &TriMesh) -> TriMesh {
    let positions = refinement.images.iter().map(|p| p.expect("every vertex is used").position(other)).collect();
    let faces: Vec<_> = refinement.subdivision.triangles.iter().map(|t| t.map(VertexId)).collect();
    TriMesh::new(positions, &faces).expect("a manifold")
}

/// The greatest distance of a vertex of one mesh from the other, whichever way.
fn apart(a: &TriMesh, b: &TriMesh) -> f64 {
    let one_way = |from: &TriMesh, to: &TriMesh| {
        let tree = FaceTree::new(to);
        let middles = from.conn.faces().map(|f| from.triangle(f).iter().sum::<DVec3>() / 3.0);
        from.positions.iter().copied().chain(middles).map(|p| tree.distance(p)).fold(0.0, f64::max)
    };
    one_way(a, b).max(one_way(b, a))
}

#[test]
fn a_horn_that_was_lost_is_found_by_few_vertices() {
    let pair = sphere_and_horn();
    let both = [&pair.meshes[0], &pair.meshes[1]];
    let composed = finished(&pair);
    let none = RefineOptions { most: 0.0, ..RefineOptions::default() };
    let before = refine(both, &composed, 0, &none);
    assert_eq!(before.inserted, [0, 0]);
    assert_eq!(before.images, composed.maps[0].images);
    let some = RefineOptions { most: 0.08, ..RefineOptions::default() };
    let after = refine(both, &composed, 0, &some);
    let count = after.images.len() - both[0].positions.len();
    assert_eq!(count, after.inserted.iter().sum::<usize>());
    assert!(count > 0 && count <= both[0].positions.len() * 8 / 100, "{count}");
    let [far, near] = [&before, &after].map(|r| apart(&compatible(r, both[1]), both[1]));
    assert!(near < 0.5 * far, "{far} to {near}");
}

#[test]
fn the_refined_mesh_is_the_same_surface_and_its_first_vertices_are_the_old_ones() {
    let pair = sphere_and_horn();
    let both = [&pair.meshes[0], &pair.meshes[1]];
    let composed = finished(&pair);
    for k in 0..2 {
        let Refinement { subdivision, images, .. } = refine(both, &composed, k, &RefineOptions::default());
        let mesh = both[k];
        for v in mesh.conn.vertices() {
            assert_eq!(subdivision.places[v.index()], SurfacePoint::Vertex(v));
            assert_eq!(images[v], composed.maps[k].images[v]);
        }
        let positions = subdivision.places.iter().map(|p| p.position(mesh)).collect();
        let faces: Vec<_> = subdivision.triangles.iter().map(|t| t.map(VertexId)).collect();
        let fine = TriMesh::new(positions, &faces).expect("a manifold");
        assert!((fine.area() - mesh.area()).abs() < 1e-9 * mesh.area());
        assert!((fine.volume() - mesh.volume()).abs() < 1e-9 * mesh.volume());
        assert_eq!(fine.conn.euler_characteristic(), 2);
    }
}

/// An OBJ of a mesh with texture coordinates that are linear in the positions, faces 0 and 1 in a group of their own.
fn with_texture(mesh: &TriMesh) -> String {
    let mut text = String::new();
    for p in &mesh.positions.raw {
        writeln!(text, "v {} {} {}", p.x, p.y, p.z).expect("memory");
    }
    for p in &mesh.positions.raw {
        writeln!(text, "vt {} {}", uv(*p)[0], uv(*p)[1]).expect("memory");
    }
    for f in mesh.conn.faces() {
        if f.index() == 0 || f.index() == 2 {
            writeln!(text, "g part{}", f.index()).expect("memory");
        }
        let [a, b, c] = mesh.face(f).map(|v| v.0 + 1);
        writeln!(text, "f {a}/{a} {b}/{b} {c}/{c}").expect("memory");
    }
    text
}

fn uv(p: DVec3) -> [f64; 2] {
    [0.5 + 0.25 * p.x + 0.1 * p.z, 0.5 - 0.25 * p.y]
}

#[test]
fn files_of_a_refined_map_share_their_connectivity_and_keep_textures_and_groups() {
    let pair = sphere_and_horn();
    let dir = std::env::temp_dir().join(format!("homeo-refined-{}", std::process::id()));
    std::fs::create_dir_all(&dir).expect("the temporary folder is writable");
    let file = |name: &str| dir.join(name);
    for (mesh, name) in pair.meshes.iter().zip(["source.obj", "target.obj"]) {
        std::fs::write(file(name), with_texture(mesh)).expect("writable");
    }
    let rows: String = (0..12).map(|i| format!("mark{i},{i},{i}\n")).collect();
    std::fs::write(file("marks.csv"), "name,source_vertex,target_vertex\n".to_owned() + &rows).expect("writable");
    let job = MapJob {
        source: file("source.obj"),
        target: file("target.obj"),
        landmarks: file("marks.csv"),
        target_landmarks: None,
        hint: None,
        texture: None,
        out: file("out"),
    };
    let options = MapOptions { refine: Some(RefineOptions::default()), image: 0, ..MapOptions::default() };
    let device = Device::open(&DeviceChoice::Cpu).expect("the CPU is always there");
    run_maps(vec![job], &options, &device, &Silent, |outcome| drop(outcome.value.expect("a map")));
    for (mesh, [refined, mapped]) in
        pair.meshes.iter().zip([["source_refined", "source_on_target"], ["target_refined", "target_on_source"]])
    {
        let read = |name: &str| -> MeshFile { read_mesh(&file(&format!("out/{name}.obj"))).expect("readable") };
        let (refined, mapped, table) = (read(refined), read(mapped), file(&format!("out/{mapped}.csv")));
        assert!(refined.positions.len() > mesh.positions.len());
        assert_eq!(refined.positions[..mesh.positions.len()], mesh.positions.raw[..]);
        assert_eq!(refined.corners, mapped.corners);
        assert_eq!(refined.uv.corners, mapped.uv.corners);
        for (c, &v) in refined.corners.iter().enumerate() {
            let found = refined.uv.at(c).expect("every corner has texture coordinates");
            let [x, y] = uv(refined.positions[v.index()]);
            assert!((found.x - x).abs() + (found.y - y).abs() < 1e-12, "{v}: {found} for {x} {y}");
        }
        let groups: Vec<(&str, usize)> = refined.statements.iter().map(|s| (s.text.as_str(), s.polygon)).collect();
        assert!(matches!(groups.as_slice(), [("part0", 0), ("part2", 2..)]), "{groups:?}");
        let lines = std::fs::read_to_string(table).expect("the table is written").lines().count();
        assert_eq!(lines, refined.positions.len() + 1);
    }
    std::fs::remove_dir_all(dir).expect("the folder is ours");
}
