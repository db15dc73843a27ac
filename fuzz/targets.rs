//! What the fuzzers try, shared with the tests: a target panics if and only if a promise is broken.
#![allow(dead_code)] // every fuzzer has one target

use glam::DVec3;
use homeo::gpu::{Device, DeviceChoice};
use homeo::mesh::check::check;
use homeo::mesh::io::{Hint, HintLoop, MeshFile, parse_landmarks, parse_mesh, write_obj};
use homeo::mesh::{FaceId, Id, SurfacePoint, TriMesh, VertexId, corner, face_of};
use homeo::pipeline::{MapOptions, Relaxation, Silent, map_pairs};
use homeo::shape::SplitMix;
use homeo::shape::fixture::{icosphere, octahedron, tetrahedron, torus};
use homeo::stage::load::Loaded;
use homeo::{Error, ErrorKind};
use std::path::Path;

/// Names by which a mesh file's format is chosen; the first leaves it to the content.
const MESHES: [&str; 7] = ["a", "a.obj", "a.off", "a.ply", "a.stl", "a.gltf", "a.glb"];
/// Most splits of a mesh of a pair; more vertices cost time and find nothing else.
const MOST_SPLITS: usize = 24;

/// A mesh file is refused with a reason, or its mesh can be checked, and written and read again without a change.
pub fn mesh(bytes: &[u8]) {
    for name in MESHES {
        match parse_mesh(Path::new(name), bytes) {
            Err(error) => assert_helpful(&error),
            Ok(mesh) => assert_readable(&mesh),
        }
    }
}

fn assert_readable(mesh: &MeshFile) {
    assert_eq!(mesh.triangles().len(), mesh.triangle_count());
    let report = check(&mesh.positions, &mesh.triangles());
    assert_eq!(report.mesh().is_some(), report.faults.is_empty(), "{report}");
    let mut text = Vec::new();
    write_obj(&mut text, Path::new(""), mesh, &mesh.positions).expect("memory can be written");
    let again = parse_mesh(Path::new("a.obj"), &text).unwrap_or_else(|e| panic!("our own file: {e}"));
    assert_eq!(again.positions, mesh.positions);
    assert_eq!((again.corners, again.offsets), (mesh.corners.clone(), mesh.offsets.clone()));
}

/// A landmark file is refused with a reason, or all its landmarks are different vertices of the meshes. The first byte
/// is the number of bytes, in units of four, of a second file; none if it is zero.
pub fn landmarks(bytes: &[u8]) {
    let Some((&split, bytes)) = bytes.split_first() else { return };
    let (first, second) = match 4 * usize::from(split) {
        0 => (bytes, None),
        n => bytes.split_at_checked(n).map_or((bytes, None), |(a, b)| (a, Some((Path::new("b"), b)))),
    };
    let [source, target] = [icosphere(0), octahedron()].map(|mesh| MeshFile::of(&mesh));
    match parse_landmarks((Path::new("a"), first), second, &source, &target) {
        Err(error) => assert_helpful(&error),
        Ok(found) => {
            for (vertices, mesh) in [(&found.source, &source), (&found.target, &target)] {
                assert_eq!(vertices.len(), found.names.len());
                let mut sorted: Vec<_> = vertices.iter().map(|v| v.index()).collect();
                sorted.sort_unstable();
                sorted.dedup();
                assert_eq!(sorted.len(), vertices.len(), "a vertex twice");
                assert!(sorted.iter().all(|&v| v < mesh.positions.len()), "no such vertex");
            }
        }
    }
}

/// Two small triangulations with random landmarks and guides get a certified map or a reason why there is none.
///
/// Bytes: the surface and whether the map is relaxed; the numbers of landmarks and guides; then for either mesh what is
/// done to it, one byte each.
pub fn pair(bytes: &[u8]) {
    let [surface, landmarks, recipes @ ..] = bytes else { return };
    let (first, second) = recipes.split_at(recipes.len() / 2);
    let meshes = [first, second].map(|recipe| triangulation(*surface, recipe));
    let sites = [0, 1].map(|k| choose(&meshes[k], usize::from(*landmarks % 12), recipes.len() as u64 + k as u64));
    let count = sites[0].len().min(sites[1].len());
    let sites = sites.each_ref().map(|s| &s[..count]);
    let mut pair = Loaded::of([&meshes[0], &meshes[1]], sites);
    let guides = usize::from(*landmarks / 12 % 4);
    if guides > 0 {
        pair.hint = Ok(Some(Hint { path: "hint".into(), loops: random_loops(&meshes, guides, recipes.len() as u64) }));
    }
    let relax = if surface & 64 == 0 { Relaxation::None } else { Relaxation::Full };
    let options = MapOptions { relax, ..MapOptions::default() };
    let device = Device::open(&DeviceChoice::Cpu).expect("there is always a CPU");
    map_pairs(std::iter::once(pair), &options, &device, &Silent, |outcome| match outcome.value {
        Err(error) => assert_helpful(&error),
        Ok(mapped) => {
            assert!(mapped.map.certificate.bijective, "{:?}", mapped.map.certificate);
            for (from, to) in sites[0].iter().zip(sites[1]) {
                assert_eq!(mapped.map.maps[0].images[*from], Some(SurfacePoint::Vertex(*to)));
                assert_eq!(mapped.map.maps[1].images[*to], Some(SurfacePoint::Vertex(*from)));
            }
        }
    });
}

/// A surface of the kind that `surface` says, each byte of the recipe a split of an edge or a face.
fn triangulation(surface: u8, recipe: &[u8]) -> TriMesh {
    let (genus, loops) = (surface / 4 % 3, surface % 3);
    let TriMesh { mut conn, mut positions } = match genus {
        0 if surface & 128 == 0 => tetrahedron(),
        0 => octahedron(),
        1 => torus(4, 3),
        _ => double_torus(),
    };
    for (i, &byte) in recipe.iter().take(MOST_SPLITS).enumerate() {
        let f = FaceId::new((usize::from(byte) * 31 + i) % conn.face_count());
        let share = [0.0, 1e-9, 0.1, 0.3, 0.5, 0.5, 0.5, 0.9][usize::from(byte >> 5)];
        if byte & 1 == 0 {
            let h = corner(f, usize::from(byte >> 1) % 3);
            let point = positions[conn.from(h)].lerp(positions[conn.to(h)], share);
            conn.split_edge(h);
            positions.push(point + DVec3::splat(0.01 * f64::from(byte & 4)));
        } else {
            let corners = conn.face(f).map(|v| positions[v]);
            conn.split_face(f);
            positions.push(corners[0] * share + (corners[1] + corners[2]) * (0.5 - 0.5 * share));
        }
    }
    pierced(TriMesh { conn, positions }, usize::from(loops))
}

/// The mesh without the stars of a few vertices that do not touch each other.
fn pierced(mesh: TriMesh, holes: usize) -> TriMesh {
    let mut taken = vec![false; mesh.positions.len()];
    let mut removed = vec![false; mesh.conn.face_count()];
    let mut left = holes;
    for v in mesh.conn.vertices().rev() {
        let star: Vec<_> = mesh.conn.outgoing(v).collect();
        let free = !taken[v.index()] && star.iter().all(|&h| !taken[mesh.conn.to(h).index()]);
        if left > 0 && free {
            left -= 1;
            star.iter().for_each(|&h| removed[face_of(h).index()] = true);
            star.iter().for_each(|&h| taken[mesh.conn.to(h).index()] = true);
            taken[v.index()] = true;
        }
    }
    let faces: Vec<_> = mesh.conn.faces().filter(|f| !removed[f.index()]).map(|f| mesh.face(f)).collect();
    TriMesh::new(mesh.positions.raw.clone(), &faces).expect("holes that do not touch leave a manifold")
}

/// A torus and its mirror image joined where either lacks its first face.
fn double_torus() -> TriMesh {
    let one = torus(4, 3);
    let n = one.positions.len() as u32;
    let seam = one.face(FaceId(0));
    let other = |v: VertexId| if seam.contains(&v) { v } else { VertexId(v.0 + n) };
    let rest = one.faces().into_iter().skip(1);
    let faces: Vec<_> = rest.clone().chain(rest.map(|[a, b, c]| [a, c, b].map(other))).collect();
    let beside = one.positions.iter().map(|p| DVec3::new(3.0 - p.x, p.y, p.z));
    let positions = one.positions.iter().copied().chain(beside).collect();
    TriMesh::new(positions, &faces).expect("two surfaces joined along a triangle")
}

/// Loops through a few vertices each, drawn on either mesh alone or, where the numbers allow, through the same ones.
fn random_loops(meshes: &[TriMesh; 2], count: usize, seed: u64) -> Vec<HintLoop> {
    let one = |i: u64| {
        let length = 3 + (seed + i) as usize % 3;
        let lists = [0, 1]
            .map(|k| choose(&meshes[k], length, 7 * seed + i + if seed.is_multiple_of(2) { 0 } else { 99 * k as u64 }));
        HintLoop { name: i.to_string(), vertices: lists }
    };
    (0..count as u64).map(one).filter(|l| l.vertices.iter().all(|v| v.len() > 2)).collect()
}

/// `n` different vertices that faces use, or all.
fn choose(mesh: &TriMesh, n: usize, seed: u64) -> Vec<VertexId> {
    let mut random = SplitMix::new(seed);
    let mut used: Vec<VertexId> = mesh.conn.vertices().filter(|&v| mesh.conn.leaving(v).is_some()).collect();
    (0..n.min(used.len())).map(|_| used.swap_remove(random.below(used.len()))).collect()
}

/// An error is never one of ours, and says what to do.
fn assert_helpful(error: &Error) {
    assert!(matches!(error.kind, ErrorKind::Input | ErrorKind::Unsolvable), "{error}");
    assert!(!error.what.is_empty() && !error.remedy.is_empty(), "{error}");
}
