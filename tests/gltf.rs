//! glTF and binary OFF: vertices in the order of the file, placed as the nodes say, and damage refused with its place.

use glam::DVec3;
use homeo::mesh::io::{MeshFile, NO_INDEX, parse_mesh, read_mesh};
use homeo::{ErrorKind, Result};
use serde_json::{Value, json};
use std::path::Path;

const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const FACES: [[u16; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
const UV: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.25], [0.0, 1.0]];

fn bytes() -> Vec<u8> {
    let positions = CORNERS.iter().flatten().flat_map(|x| x.to_le_bytes());
    let faces = FACES.iter().flatten().flat_map(|i| i.to_le_bytes());
    positions.chain(faces).chain(UV.iter().flatten().flat_map(|x| x.to_le_bytes())).collect()
}

/// A tetrahedron in one mesh of two primitives that share its vertices.
fn document() -> Value {
    let primitive = |indices: usize, more: Value| {
        let mut attributes = json!({ "POSITION": 0 });
        attributes.as_object_mut().expect("an object").extend(more.as_object().expect("an object").clone());
        json!({ "attributes": attributes, "indices": indices })
    };
    json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [primitive(1, json!({ "TEXCOORD_0": 3 })), primitive(2, json!({}))] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR" },
            { "bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR", "byteOffset": 12 },
            { "bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 48 },
            { "buffer": 0, "byteLength": 24, "byteOffset": 48 },
            { "buffer": 0, "byteLength": 32, "byteOffset": 72 },
        ],
        "buffers": [{ "byteLength": 104 }],
    })
}

/// The document and the bytes in one binary file.
fn glb(document: &Value) -> Vec<u8> {
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let data = bytes();
    let word = |n: usize| (n as u32).to_le_bytes();
    let mut file = b"glTF".to_vec();
    for part in [&word(2)[..], &word(28 + json.len() + data.len()), &word(json.len()), b"JSON", &json] {
        file.extend(part);
    }
    for part in [&word(data.len())[..], b"BIN\0", &data] {
        file.extend(part);
    }
    file
}

fn parse(name: &str, bytes: &[u8]) -> Result<MeshFile> {
    parse_mesh(Path::new(name), bytes)
}

fn parsed(document: &Value) -> MeshFile {
    parse("mesh.glb", &glb(document)).expect("a valid file")
}

fn corners(mesh: &MeshFile) -> Vec<[u32; 3]> {
    mesh.triangles().into_iter().map(|t| t.map(|v| v.0)).collect()
}

fn points() -> Vec<DVec3> {
    CORNERS.iter().map(|p| DVec3::from_array(p.map(f64::from))).collect()
}

fn faces() -> Vec<[u32; 3]> {
    FACES.iter().map(|f| f.map(u32::from)).collect()
}

#[test]
fn vertices_and_faces_in_the_order_of_their_accessors() {
    let mesh = parsed(&document());
    assert_eq!((mesh.positions.clone(), corners(&mesh)), (points(), faces()));
    let uv: Vec<_> = (0..12).map(|c| mesh.uv.at(c).map(|uv| uv.to_array())).collect();
    let expected = |v: u16| UV[usize::from(v)].map(f64::from);
    for (c, &v) in FACES.iter().flatten().enumerate() {
        let given = expected(v);
        assert_eq!(uv[c], (c < 6).then_some([given[0], 1.0 - given[1]]), "corner {c}: v points up here");
    }
    assert_eq!(mesh.uv.corners[6..], [NO_INDEX; 6]);
    assert_eq!(parse("mesh", &glb(&document())), Ok(mesh), "by content");
}

#[test]
fn separate_buffers_lie_beside_the_document() {
    let folder = std::env::temp_dir().join(format!("homeo-gltf-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the temporary folder is writable");
    let mut document = document();
    document["buffers"][0]["uri"] = json!("my%20mesh.bin");
    let path = folder.join("mesh.gltf");
    std::fs::write(&path, document.to_string()).expect("the temporary folder is writable");
    let error = read_mesh(&path).expect_err("the buffer is missing");
    assert!(error.what.contains("\"my mesh.bin\"") && error.element == "buffer 0", "{error}");
    std::fs::write(folder.join("my mesh.bin"), bytes()).expect("the temporary folder is writable");
    assert_eq!(corners(&read_mesh(&path).expect("now it is there")), faces());
    std::fs::remove_dir_all(&folder).expect("it is ours");
}

#[test]
fn nodes_place_meshes_one_after_the_other() {
    let mut document = document();
    let half_turn = [0.0, 0.0, 1.0, 0.0];
    document["nodes"] = json!([
        { "translation": [10, 0, 0], "children": [2, 1] },
        { "mesh": 0 },
        { "mesh": 0, "rotation": half_turn, "scale": [2, 2, 2], "translation": [0, 0, 5] },
        { "mesh": 0, "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] },
    ]);
    document["scenes"] = json!([{ "nodes": [0, 3] }]);
    let mesh = parsed(&document);
    let shift = DVec3::X * 10.0;
    let turned = points().into_iter().map(|p| shift + DVec3::new(-2.0 * p.x, -2.0 * p.y, 5.0 + 2.0 * p.z));
    let plain = points().into_iter().map(|p| shift + p);
    let mirrored = points().into_iter().map(|p| DVec3::new(-p.x, p.y, p.z));
    for (v, (p, expected)) in mesh.positions.iter().zip(turned.chain(plain).chain(mirrored)).enumerate() {
        assert!(p.distance(expected) < 1e-12, "vertex {v} at {p}");
    }
    let moved = |first: u32| faces().into_iter().map(move |f| f.map(|v| first + v));
    let outward_again = moved(8).map(|[a, b, c]| [a, c, b]);
    assert_eq!(corners(&mesh), moved(0).chain(moved(4)).chain(outward_again).collect::<Vec<_>>());
}

#[test]
fn strips_fans_and_small_integers() {
    let mut document = document();
    document["accessors"][1] = json!({ "bufferView": 1, "componentType": 5123, "count": 4, "type": "SCALAR" });
    document["meshes"][0]["primitives"] = json!([
        { "attributes": { "POSITION": 0 }, "indices": 1, "mode": 5 },
        { "attributes": { "POSITION": 0 }, "indices": 1, "mode": 6 },
        { "attributes": { "POSITION": 0 }, "indices": 1, "mode": 1 },
    ]);
    let mesh = parsed(&document); // indices 0 2 1 0
    assert_eq!(corners(&mesh), [[0, 2, 1], [1, 2, 0], [0, 2, 1], [0, 1, 0]]);
    assert_eq!(mesh.warnings, ["1 primitives without triangles were left out"]);
    document["accessors"][0] =
        json!({ "bufferView": 1, "componentType": 5121, "count": 4, "type": "VEC3", "normalized": true });
    document["meshes"][0]["primitives"] = json!([{ "attributes": { "POSITION": 0 } }]);
    let mesh = parsed(&document);
    assert_eq!(mesh.positions[0], DVec3::new(0.0, 0.0, 2.0 / 255.0), "bytes of the indices");
    assert_eq!(corners(&mesh), [[0, 1, 2]], "without indices, in order");
}

#[test]
fn damage_is_refused_with_its_place() {
    for (pointer, value, place, what) in [
        ("/accessors/0/count", json!(5), "accessor 0", "5 values do not fit"),
        ("/accessors/0/count", json!(u64::MAX), "accessor 0", "do not fit"),
        ("/accessors/0/type", json!("VEC4"), "accessor 0", "VEC4 where VEC3 should stand"),
        ("/accessors/0/componentType", json!(7), "accessor 0", "unknown component type 7"),
        ("/accessors/0/sparse", json!({ "count": 1 }), "accessor 0", "sparse values"),
        ("/accessors/0/bufferView", json!(9), "accessor 0", "without a buffer view"),
        ("/accessors/0/byteOffset", json!(u64::MAX), "accessor 0", "too short"),
        ("/accessors/1/componentType", json!(5126), "accessor 1", "unsigned integers"),
        ("/accessors/3/count", json!(3), "accessor 3", "3 values of TEXCOORD_0 for 4 vertices"),
        ("/bufferViews/0/byteLength", json!(u64::MAX), "accessor 0", "too short"),
        ("/bufferViews/0/byteStride", json!(0), "accessor 0", "do not fit"),
        ("/bufferViews/0/buffer", json!(3), "accessor 0", "a buffer that does not exist"),
        ("/buffers/0/uri", json!("data:x;base64,***"), "buffer 0", "not base64"),
        ("/buffers/0/uri", json!("/dev/zero"), "buffer 0", "is not there"),
        ("/meshes/0/primitives/0/indices", json!(8), "mesh 0", "accessor 8 does not exist"),
        ("/nodes/0/mesh", json!(4), "mesh 4", "does not exist"),
        ("/nodes/0/children", json!([0]), "node 0", "two parents"),
        ("/scenes/0/nodes", json!([7]), "node 7", "does not exist"),
        (
            "/extensionsRequired",
            json!(["KHR_draco_mesh_compression"]),
            "extensionsRequired",
            "KHR_draco_mesh_compression",
        ),
        ("/meshes", json!([]), "mesh 0", "does not exist"),
        ("/nodes", json!("x"), "of the JSON", "not a glTF 2.0 document"),
    ] {
        let mut document = document();
        let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
        document.pointer_mut(parent).expect("it is there")[key] = value;
        let error = parse("mesh.glb", &glb(&document)).expect_err(what);
        assert_eq!(error.kind, ErrorKind::Input, "{error}");
        assert!(error.element.contains(place) && error.what.contains(what), "{pointer}: {error}");
        assert!(!error.remedy.is_empty(), "{error}");
    }
    let whole = glb(&document());
    for length in 4..whole.len() {
        let error = parse("mesh.glb", &whole[..length]).expect_err("cut short");
        assert_eq!(error.kind, ErrorKind::Input, "{length} bytes: {error}");
    }
}

/// A binary OFF file of the tetrahedron, with the extras that `prefix` announces.
fn binary_off(prefix: &str, extras: &[f32]) -> Vec<u8> {
    let mut file = format!("{prefix}OFF BINARY\n").into_bytes();
    let integers = |file: &mut Vec<u8>, list: &[i32]| file.extend(list.iter().flat_map(|i| i.to_be_bytes()));
    integers(&mut file, &[4, 4, 6]);
    for corner in CORNERS {
        file.extend(corner.iter().chain(extras).flat_map(|x| x.to_be_bytes()));
    }
    for face in FACES {
        integers(&mut file, &[3, face[0].into(), face[1].into(), face[2].into(), 1, 0]);
    }
    file
}

#[test]
fn binary_off_keeps_the_order() {
    for (prefix, extras) in [("", vec![]), ("STCN", vec![0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.25, 0.75])] {
        let mesh = parse("mesh.off", &binary_off(prefix, &extras)).expect("a valid file");
        assert_eq!((mesh.positions.clone(), corners(&mesh)), (points(), faces()));
        assert_eq!(mesh.uv.at(3).map(|uv| uv.to_array()), (!extras.is_empty()).then_some([0.25, 0.75]));
    }
    let whole = binary_off("", &[]);
    for length in 11..whole.len() {
        assert_eq!(parse("mesh.off", &whole[..length]).map_err(|e| e.kind), Err(ErrorKind::Input), "{length} bytes");
    }
    let mut wrong = whole.clone();
    wrong[11 + 12 + 48 + 7] = 9; // the first corner of the first face
    let error = parse("mesh.off", &wrong).expect_err("no such vertex");
    assert!(
        error.what.contains("face 0 names vertex 9, the file has 4") && error.element.starts_with("byte"),
        "{error}"
    );
}
