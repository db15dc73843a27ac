//! Mesh files: what comes out is what the file says, vertex by vertex, and whatever is wrong is refused with its place.

use glam::DVec3;
use homeo::ErrorKind;
use homeo::mesh::VertexId;
use homeo::mesh::io::materials::read_library;
use homeo::mesh::io::{MeshFile, NO_INDEX, parse_mesh, read_mesh, write_obj};
use proptest::prelude::*;
use std::fmt::Write;
use std::path::{Path, PathBuf};

const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

fn parse(name: &str, bytes: impl AsRef<[u8]>) -> homeo::Result<MeshFile> {
    parse_mesh(Path::new(name), bytes.as_ref())
}

fn obj(text: &str) -> MeshFile {
    parse("mesh.obj", text).expect("a valid OBJ")
}

fn ids(mesh: &MeshFile) -> Vec<u32> {
    mesh.corners.iter().map(|v| v.0).collect()
}

fn temporary(name: &str, content: impl AsRef<[u8]>) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("homeo-readers-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the temporary folder is writable");
    let path = folder.join(name);
    std::fs::write(&path, content).expect("the temporary folder is writable");
    path
}

/// A torus of `n` x `m` quads, every third one split in two, with a uv seam and objects in between.
fn torus(n: usize, m: usize) -> String {
    let mut text = String::from("mtllib skin.mtl\no torus\n");
    for (i, j) in (0..n).flat_map(|i| (0..m).map(move |j| (i, j))) {
        let (a, b) = (i as f64 * std::f64::consts::TAU / n as f64, j as f64 * std::f64::consts::TAU / m as f64);
        let r = 2.0 + b.cos();
        writeln!(text, "v {} {} {}", r * a.cos(), r * a.sin(), b.sin()).expect("strings grow");
    }
    for (i, j) in (0..=n).flat_map(|i| (0..=m).map(move |j| (i, j))) {
        writeln!(text, "vt {} {}", i as f64 / n as f64, j as f64 / m as f64).expect("strings grow");
    }
    for (i, j) in (0..n).flat_map(|i| (0..m).map(move |j| (i, j))) {
        let corner = |i: usize, j: usize| format!("{}/{}", (i % n) * m + j % m + 1, i * (m + 1) + j + 1);
        let [p, q, r, s] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        if j == 0 && i % 5 == 0 {
            writeln!(text, "usemtl skin{i}\ng part{i}").expect("strings grow");
        }
        if (i + j) % 3 == 0 {
            writeln!(text, "f {p} {q} {r}\nf {p} {r} {s}").expect("strings grow");
        } else {
            writeln!(text, "f {p} {q} {r} {s}").expect("strings grow");
        }
    }
    text
}

/// Position and texture coordinate of every triangle corner, as tobj reads them.
fn corners_by_tobj(text: &str) -> Vec<([f32; 3], Option<[f32; 2]>)> {
    let options = tobj::LoadOptions { triangulate: true, single_index: true, ..Default::default() };
    let no_materials = |_: &Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, no_materials).expect("tobj reads it");
    let corner = |mesh: &tobj::Mesh, i: u32| {
        let i = i as usize;
        let p = std::array::from_fn(|k| mesh.positions[3 * i + k]);
        (p, (!mesh.texcoords.is_empty()).then(|| std::array::from_fn(|k| mesh.texcoords[2 * i + k])))
    };
    models.iter().flat_map(|m| m.mesh.indices.iter().map(|&i| corner(&m.mesh, i))).collect()
}

fn corners_by_us(mesh: &MeshFile) -> Vec<([f32; 3], Option<[f32; 2]>)> {
    let corner = |c: usize| {
        let p = mesh.positions[mesh.corners[c].0 as usize];
        (p.as_vec3().to_array(), mesh.uv.at(c).map(|uv| uv.as_vec2().to_array()))
    };
    mesh.triangle_corners().flatten().map(corner).collect()
}

#[test]
fn agrees_with_tobj_corner_by_corner() {
    let pentagon = "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 1e-3\nf 1 2 3 4 5\nf -1 -2 -3\n";
    let normals = "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nvn 0 0 1\r\n\r\nf 1//1 2//1 3//1\r\n";
    for text in [TETRAHEDRON, pentagon, normals, &torus(7, 5), &torus(40, 31)] {
        assert_eq!(corners_by_us(&obj(text)), corners_by_tobj(text));
    }
}

#[test]
fn obj_spellings_of_one_mesh() {
    let plain = obj(TETRAHEDRON);
    let spellings = [
        format!("\u{feff}# BOM\n{TETRAHEDRON}"),
        TETRAHEDRON.replace('\n', "\r\n"),
        TETRAHEDRON.replace('\n', " # comment\n"),
        TETRAHEDRON.replace(' ', "\t ").replace("v", "  v"),
        TETRAHEDRON.replace("f 1 3 2", "f 1 \\\n3 \\\r\n2"),
        TETRAHEDRON.replace("f 1 3 2", "f -4 -2 -3"),
        TETRAHEDRON.replace("v 1 0 0", "v +1e0 0.0E+5 -0 0.5 0.25 1"),
        format!("{TETRAHEDRON}l 1 2 3\np 1\ncurv 0 1 \\\n 1 2\n"),
        TETRAHEDRON.trim_end().to_owned(),
    ];
    for text in spellings {
        let mesh = obj(&text);
        assert_eq!((&mesh.positions, ids(&mesh)), (&plain.positions, ids(&plain)), "{text}");
    }
    let (vertices, faces) = TETRAHEDRON.split_at(32);
    assert_eq!(obj(&format!("{faces}{vertices}")), plain, "vertices after faces");
}

#[test]
fn vertices_keep_order_and_number() {
    let mesh = obj("v 9 9 9\nv 0 0 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 8 8 8\nf 5 3 4\n");
    assert_eq!(mesh.positions.len(), 6, "unused and doubled vertices stay");
    assert_eq!(ids(&mesh), [4, 2, 3]);
    assert_eq!(mesh.positions[0], DVec3::splat(9.0));
}

#[test]
fn polygons_become_fans_in_file_order() {
    let mesh = obj("v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 3 4 5 1 2\nf 1 2 3\n");
    let triangles: Vec<[u32; 3]> = mesh.triangles().iter().map(|t| t.map(|v| v.0)).collect();
    assert_eq!(triangles, [[2, 3, 4], [2, 4, 0], [2, 0, 1], [0, 1, 2]]);
    assert_eq!(mesh.triangle_polygons(), [0, 0, 0, 1]);
    assert_eq!(mesh.triangle_count(), 4);
}

#[test]
fn obj_errors_name_the_line() {
    let head = "# one\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n\n"; // the fault follows in line 7
    for bad in [
        "v 0 0 nan",
        "v inf 0 0",
        "v 1e999 0 0",
        "v 0 zero 0",
        "v 0,5 0 0",
        "v 0 0",
        "v 0 0 0 1 1 1 1 1",
        "v 0x10 0 0",
        "vt",
        "vt 0 nan",
        "vn 0 0",
        "f 1 2",
        "f",
        "f 1 2 0",
        "f 1 2 4",
        "f 1 2 -4",
        "f 1/2 2/1 3/1",
        "f 1//1 2 3",
        "f 1 2 3.5",
        "f 1/1/1/1 2 3",
        "f 1 2 three",
        "f 1 2 99999999999999999999",
        "f 1 2 -99999999999",
        "f 1 2 4294967297",
        "vertex 1 2 3",
        "\u{0}\u{1}",
    ] {
        let error = parse("mesh.obj", format!("{head}{bad}\nf 1 2 3\n")).expect_err(bad);
        assert_eq!(error.element, "line 7", "{bad}: {error}");
        assert_eq!(error.kind, ErrorKind::Input);
        assert!(!error.what.is_empty() && !error.remedy.is_empty(), "{bad}: {error}");
    }
}

#[test]
fn empty_and_faceless_files_are_refused_by_name() {
    for (name, text) in [("empty.obj", ""), ("blank.ply", " \n"), ("no_faces.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n")] {
        let path = temporary(name, text);
        let error = read_mesh(&path).expect_err(name);
        assert_eq!(error.file, path.display().to_string());
        assert!(!error.remedy.is_empty(), "{error}");
    }
    let error = read_mesh(Path::new("no/such/file.obj")).expect_err("missing file");
    assert_eq!((error.kind, error.file.as_str()), (ErrorKind::Input, "no/such/file.obj"));
}

fn off(prefix: &str, counts_apart: bool) -> String {
    let gap = if counts_apart { "\n# c\n" } else { " " };
    let tail = match prefix {
        "C" => " 255 0 0 255",
        "N" => " 0 0 1",
        "STCN" => " 0 0 1 255 0 0 255 0.25 0.75",
        _ => "",
    };
    let vertices = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"].map(|v| format!("{v}{tail}\n")).concat();
    format!("{prefix}OFF{gap}4 4 6\n{vertices}3 0 2 1 0.5 0.5 0.5\n3 0 1 3\n3 1 2 3\n3 2 0 3\n")
}

const PLY_HEAD: &str = "comment made by hand\nelement vertex 4\nproperty float x\nproperty uchar red\n\
    property double y\nproperty float z\nproperty list uchar int weights\nelement face 4\n\
    property short flag\nproperty list uchar uint vertex_index\nelement edge 1\nproperty int from\nend_header\n";
const POINTS: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

fn ply_ascii() -> Vec<u8> {
    let mut text = format!("ply\nformat ascii 1.0\n{PLY_HEAD}");
    POINTS.iter().for_each(|[x, y, z]| text += &format!("{x} 200 {y} {z} 2 7 -8\n"));
    FACES.iter().for_each(|[a, b, c]| text += &format!("-1 3 {a} {b} {c}\n"));
    (text + "5\n").into_bytes()
}

fn ply_binary(big: bool) -> Vec<u8> {
    let mut out =
        format!("ply\nformat binary_{}_endian 1.0\n{PLY_HEAD}", if big { "big" } else { "little" }).into_bytes();
    let mut put = |bytes: &[u8]| {
        let mut bytes = bytes.to_vec(); // little-endian
        if big {
            bytes.reverse();
        }
        out.extend(bytes);
    };
    for [x, y, z] in POINTS {
        put(&(x as f32).to_le_bytes());
        put(&[200]);
        put(&y.to_le_bytes());
        put(&(z as f32).to_le_bytes());
        put(&[2]);
        put(&7i32.to_le_bytes());
        put(&(-8i32).to_le_bytes());
    }
    for face in FACES {
        put(&(-1i16).to_le_bytes());
        put(&[3]);
        face.iter().for_each(|v| put(&v.to_le_bytes()));
    }
    put(&5i32.to_le_bytes());
    out
}

fn stl_ascii() -> Vec<u8> {
    let corner =
        |v: u32| format!("vertex {} {} {}\n", POINTS[v as usize][0], POINTS[v as usize][1], POINTS[v as usize][2]);
    let facet =
        |f: &[u32; 3]| format!("facet normal 0 0 0\n outer loop\n{}endloop\nendfacet\n", f.map(corner).concat());
    format!("solid a b\n{}endsolid a b\n", FACES.iter().map(facet).collect::<String>()).into_bytes()
}

fn stl_binary() -> Vec<u8> {
    let mut out = b"solid, although binary".to_vec();
    out.resize(80, b' ');
    out.extend((FACES.len() as u32).to_le_bytes());
    for face in FACES {
        out.extend([0; 12]);
        let numbers = face.iter().flat_map(|&v| POINTS[v as usize]);
        out.extend(numbers.flat_map(|x| (x as f32).to_le_bytes()));
        out.extend([0; 2]);
    }
    out
}

#[test]
fn every_format_gives_the_same_mesh() {
    let reference = obj(TETRAHEDRON);
    let files = [
        ("a.off", off("", true).into_bytes()),
        ("b.off", off("", false).into_bytes()),
        ("c.off", off("C", true).into_bytes()),
        ("d.off", off("N", true).into_bytes()),
        ("e.off", off("STCN", true).into_bytes()),
        ("a.ply", ply_ascii()),
        ("b.ply", ply_binary(false)),
        ("c.ply", ply_binary(true)),
    ];
    for (name, bytes) in &files {
        for name in [name, "no_extension"] {
            let mesh = parse(name, bytes).expect(name);
            assert_eq!((&mesh.positions, ids(&mesh)), (&reference.positions, ids(&reference)), "{name}");
            assert!(mesh.warnings.is_empty());
        }
    }
    let mesh = parse("e.off", &files[4].1).expect("valid");
    assert!(
        (0..12).all(|c| mesh.uv.at(c) == Some(glam::DVec2::new(0.25, 0.75)) && mesh.normals.at(c) == Some(DVec3::Z))
    );
}

#[test]
fn stl_welds_equal_positions_by_first_appearance_and_says_so() {
    for bytes in [stl_ascii(), stl_binary()] {
        for name in ["a.stl", "no_extension"] {
            let mesh = parse(name, &bytes).expect("valid STL");
            assert_eq!(ids(&mesh), [0, 1, 2, 0, 2, 3, 2, 1, 3, 1, 0, 3]);
            assert_eq!(mesh.positions[1], DVec3::Y);
            assert!(mesh.warnings[0].contains("welded"), "{:?}", mesh.warnings);
        }
    }
}

#[test]
fn ply_texture_coordinates_per_vertex_and_per_corner() {
    for (u, v) in [("s", "t"), ("u", "v"), ("texture_u", "texture_v"), ("texture_s", "texture_t")] {
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             property float {u}\nproperty float {v}\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
             0 0 0 0 0\n1 0 0 1 0\n0 1 0 0.5 1\n3 2 0 1\n"
        );
        let mesh = parse("uv.ply", text).expect("valid PLY");
        assert_eq!(mesh.uv.at(0), Some(glam::DVec2::new(0.5, 1.0)), "{u} {v}");
    }
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n\
        property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 0 0 1 0 0 1\n3 2 1 0 0\n";
    let mesh = parse("uv.ply", text).expect("valid PLY");
    assert_eq!(mesh.uv.corners, [0, 1, 2, NO_INDEX, NO_INDEX, NO_INDEX]);
}

#[test]
fn other_formats_name_the_place_of_a_fault() {
    let ply = String::from_utf8(ply_ascii()).expect("ASCII");
    let stl = String::from_utf8(stl_ascii()).expect("ASCII");
    let cases = [
        ("a.off", off("", true).replace("3 0 2 1", "3 0 2 4"), "line 8"),
        ("a.off", off("", true).replace("3 0 2 1", "2 0 2"), "line 8"),
        ("a.off", off("", true).replace("3 0 2 1", "3 0 2"), "line 8"),
        ("a.off", off("", true).replace("1 0 0\n", "1 0 nan\n"), "line 5"),
        ("a.off", off("", true) + "3 0 1 2\n", "line 12"),
        ("a.off", off("4", true), "line 1"),
        ("a.ply", ply.replace("-1 3 0 1 3", "-1 3 0 1 4"), "line 21, face 1"),
        ("a.ply", ply.replace("-1 3 0 1 3", "-1 2 0 1"), "line 21, face 1"),
        ("a.ply", ply.replace("-1 3 0 1 3", "-1 3 0 1"), "line 21"),
        ("a.ply", ply.replace("1 200 0 0 2", "1 200 inf 0 2"), "line 17"),
        ("a.ply", ply.replace("property float x", "property float32x"), "line 5"),
        ("a.ply", ply.replace("end_header", "end header"), "line 15"),
        ("a.stl", stl.replacen("outer loop", "outer lop", 1), "line 3"),
        ("a.stl", stl.replacen("vertex 0 0 0", "vertex 0 0 x", 1), "line 4"),
        ("a.stl", stl.replace("endsolid a b\n", ""), "line 30"),
    ];
    for (name, text, element) in cases {
        let error = parse(name, &text).expect_err(&text);
        assert_eq!(error.element, element, "{error}\n{text}");
        assert!(!error.remedy.is_empty(), "{error}");
    }
    let mut nan = ply_binary(false);
    let body = nan.len() - 4 - 4 * (2 + 1 + 12) - 4 * 26;
    nan[body + 26..body + 30].copy_from_slice(&f32::NAN.to_le_bytes());
    let error = parse("a.ply", nan).expect_err("a NaN");
    assert_eq!(error.element, format!("vertex 1, byte {}", body + 52));
}

#[test]
fn no_prefix_of_a_file_is_taken_for_the_whole() {
    for (name, bytes, spare) in [
        ("a.off", off("", true).into_bytes(), 13), // the last face's corners and the line break may be cut unnoticed
        ("a.ply", ply_ascii(), 1),
        ("b.ply", ply_binary(false), 0),
        ("c.ply", ply_binary(true), 0),
        ("b.stl", stl_binary(), 0),
        ("a.stl", stl_ascii(), 5),
    ] {
        for n in 0..bytes.len() - spare {
            let error = parse(name, &bytes[..n]).expect_err(&format!("{name} cut to {n} bytes"));
            assert!(error.kind == ErrorKind::Input && !error.remedy.is_empty(), "{name} cut to {n} bytes: {error}");
        }
    }
}

#[test]
fn writing_and_reading_back_changes_nothing() {
    let mut mesh = obj(&torus(9, 6));
    mesh.positions.iter_mut().for_each(|p| *p *= 0.1 + 1e-9);
    let mut text = Vec::new();
    write_obj(&mut text, Path::new(""), &mesh, &mesh.positions).expect("memory can be written");
    assert_eq!(parse("again.obj", &text).expect("our own file is valid"), mesh);
}

#[test]
fn material_libraries_are_named_as_seen_from_the_new_folder() {
    let library = temporary("skin.mtl", "newmtl skin\n");
    let mesh = MeshFile { path: library.with_file_name("mesh.obj"), ..obj(TETRAHEDRON) };
    for (name, expected) in [("skin.mtl", "../skin.mtl"), ("lost.mtl", "lost.mtl")] {
        let mesh = MeshFile { material_libraries: vec![name.to_owned()], ..mesh.clone() };
        let mut text = Vec::new();
        write_obj(&mut text, &library.with_file_name("out"), &mesh, &mesh.positions).expect("memory can be written");
        assert!(text.starts_with(format!("mtllib {expected}\n").as_bytes()), "{name}");
    }
}

#[test]
fn normals_are_recomputed_if_there_were_any() {
    let mesh = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nvt 0 0\nvn 1 0 0\nf 1//1 2/1/1 3//1\n");
    let mut text = Vec::new();
    write_obj(&mut text, Path::new(""), &mesh, &mesh.positions).expect("memory can be written");
    let text = String::from_utf8(text).expect("OBJ is text");
    assert_eq!(
        text,
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nvt 0 0\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\nf 1//1 2/1/2 3//3\n"
    );
}

#[test]
fn odd_material_lines_do_no_harm() {
    let text =
        "Kd 1 1 1\nnewmtl skin\nKd 0.5\nKa\nillum x\nmap_Kd -s 1 1 1 tex\\skin.png\nnewmtl\nnewmtl plain\nKd 1 0 0.5\n";
    let path = temporary("skin.mtl", text);
    let materials = read_library(&path).expect("readable");
    let folder = path.parent().expect("a file has a folder");
    assert_eq!(materials.len(), 2);
    assert_eq!(materials[0].texture, Some(folder.join("tex/skin.png")));
    assert_eq!((materials[0].diffuse, materials[1].diffuse), (None, Some([1.0, 0.0, 0.5])));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn no_bytes_make_a_reader_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        for name in ["a.obj", "a.off", "a.ply", "a.stl", "a"] {
            let _ = parse(name, &bytes);
        }
    }

    #[test]
    fn no_damaged_file_makes_a_reader_panic(k in 0usize..6, at in 0usize..10_000, byte in any::<u8>(), drop in any::<bool>()) {
        let (name, mut bytes) = [
            ("a.obj", torus(4, 3).into_bytes()),
            ("a.off", off("STCN", true).into_bytes()),
            ("a.ply", ply_ascii()),
            ("b.ply", ply_binary(true)),
            ("a.stl", stl_ascii()),
            ("b.stl", stl_binary()),
        ][k].clone();
        let at = at % bytes.len();
        if drop { bytes.remove(at); } else { bytes[at] = byte; }
        if let Ok(mesh) = parse(name, &bytes) {
            prop_assert!(mesh.positions.iter().all(|p| p.is_finite()));
            prop_assert!(mesh.triangles().iter().flatten().all(|&VertexId(v)| (v as usize) < mesh.positions.len()));
        }
    }

    #[test]
    fn every_finite_coordinate_survives_the_round_trip(bits in prop::collection::vec(any::<u64>(), 9)) {
        let numbers: Vec<f64> = bits.iter().map(|&b| f64::from_bits(b)).map(|x| if x.is_finite() { x } else { 0.5 }).collect();
        let mut mesh = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        mesh.positions = numbers.chunks(3).map(DVec3::from_slice).collect();
        let mut text = Vec::new();
        write_obj(&mut text, Path::new(""), &mesh, &mesh.positions).expect("memory can be written");
        let again = parse("again.obj", &text).expect("our own file is valid");
        prop_assert_eq!(again.positions, mesh.positions);
    }
}
