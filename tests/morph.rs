//! Promises of `homeo morph`: vertices in order, other shapes exact up to single precision, seams doubled behind all
//! vertices, steps that begin and end exactly, and nothing written where something is wrong.

use glam::DVec3;
use homeo::mesh::io::{MeshFile, Morph, MorphTarget, parse_mesh, read_mesh, write_morph};
use serde_json::Value;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Columns and rings of the spheres.
const SIZE: [usize; 2] = [10, 6];
const LANDMARKS: &str = "name,source_vertex,target_vertex\na,0,0\nb,5,5\nc,25,25\nd,51,51\ne,32,32\n";
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n and what follows";

/// A folder of one test, with finished maps of a ball onto an egg and a pear in it.
struct Files(PathBuf);

impl Files {
    fn new(test: &str) -> Self {
        let dir = std::env::temp_dir().join(format!("homeo-morph-{test}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(&dir).expect("the temporary folder is writable");
        Files(dir)
    }

    /// With the map of the ball onto the egg.
    fn mapped(test: &str) -> Self {
        let files = Files::new(test);
        files.add("ball.obj", ball(DVec3::ZERO, |p| p).as_bytes());
        files.map("egg", |p| p * DVec3::new(1.0, 1.2, 1.7));
        files
    }

    /// Maps the ball onto another shape of it.
    fn map(&self, name: &str, shape: impl Fn(DVec3) -> DVec3) {
        let target = self.add(&format!("{name}.obj"), ball(DVec3::new(0.5, 0.0, 0.0), shape).as_bytes());
        let landmarks = self.add("landmarks.csv", LANDMARKS.as_bytes());
        let (source, out) = (self.path("ball.obj"), self.path(&format!("to_{name}")));
        let quick = ["--relax", "none", "--image", "0", "--device", "cpu", "--no-report", "-q"];
        let output =
            homeo(&[&["map", &source, &target, "--landmarks", &landmarks, "--out", &out][..], &quick].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }

    fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().expect("the temporary folder has a plain name").to_owned()
    }

    fn add(&self, name: &str, content: &[u8]) -> String {
        fs::write(self.path(name), content).expect("the temporary folder is writable");
        self.path(name)
    }

    fn mesh(&self, name: &str) -> MeshFile {
        read_mesh(Path::new(&self.path(name))).expect("a sound mesh")
    }

    /// Runs the command on folders; the result as JSON.
    fn morph(&self, folders: &[&str], flags: &[&str]) -> Value {
        let output = self.run(folders, flags);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).expect("JSON on stdout")
    }

    fn run(&self, folders: &[&str], flags: &[&str]) -> Output {
        let folders: Vec<String> = folders.iter().map(|f| self.path(f)).collect();
        let folders: Vec<&str> = folders.iter().map(String::as_str).collect();
        homeo(&[&["morph", "--json", "--out", &self.path("out.glb")][..], &folders, flags].concat())
    }

    /// Asserts that the command refuses with exit code 3 and these words, and writes nothing.
    fn refuses(&self, folders: &[&str], flags: &[&str], words: &[&str]) {
        let output = self.run(folders, flags);
        let line = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(3), "{line}");
        assert!(line.starts_with("error: ") && words.iter().all(|w| line.contains(w)), "{words:?}: {line}");
        let names = fs::read_dir(&self.0).expect("readable").flatten().map(|e| e.file_name());
        let written: Vec<_> = names.filter(|n| n.to_string_lossy().contains("out")).collect();
        assert!(written.is_empty(), "{written:?}");
    }
}

impl Drop for Files {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn homeo(arguments: &[&str]) -> Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_homeo"));
    program.env_remove("HOMEO_REQUIRE_GPU").args(arguments).output().expect("the program starts")
}

/// A ball with a seam of texture coordinates along one meridian; vertex 0 is the south pole, the last the north pole.
///
/// ```text
/// u = 0        1/10        ...        9/10        1
///     1 + 10 j   2 + 10 j          10 + 10 j     1 + 10 j     ring j
/// ```
fn ball(shift: DVec3, shape: impl Fn(DVec3) -> DVec3) -> String {
    let [n, m] = SIZE;
    let mut text = String::from("mtllib ball.mtl\n");
    let point = |i: usize, j: usize| {
        let (a, b) = (TAU * i as f64 / n as f64, PI * (j as f64 / m as f64 - 0.5));
        shape(DVec3::new(a.cos() * b.cos(), a.sin() * b.cos(), b.sin())) + shift
    };
    let rings = (1..m).flat_map(|j| (0..n).map(move |i| (i, j)));
    for p in [(0, 0)].into_iter().chain(rings).chain([(0, m)]).map(|(i, j)| point(i, j)) {
        writeln!(text, "v {} {} {}", p.x, p.y, p.z).expect("text grows");
    }
    for (i, j) in (0..=m).flat_map(|j| (0..=n).map(move |i| (i, j))) {
        writeln!(text, "vt {} {}", i as f64 / n as f64, j as f64 / m as f64).expect("text grows");
    }
    let vertex = |i: usize, j: usize| match j {
        0 => 1,
        _ if j == m => 2 + n * (m - 1),
        _ => 2 + n * (j - 1) + i % n,
    };
    let corner = |(i, j): (usize, usize)| format!(" {}/{}", vertex(i, j), 1 + j * (n + 1) + i);
    text += "g skin\nusemtl skin\n";
    for (i, j) in (0..m).flat_map(|j| (0..n).map(move |i| (i, j))) {
        let square = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
        let face = square.iter().enumerate().filter(|&(k, _)| !(j == 0 && k == 1 || j == m - 1 && k == 3));
        let face: String = face.map(|(_, &c)| corner(c)).collect();
        writeln!(text, "f{face}").expect("text grows");
    }
    text
}

/// The document and the binary chunk of a GLB file.
struct Glb {
    json: Value,
    binary: Vec<u8>,
}

impl Glb {
    fn open(bytes: &[u8]) -> Glb {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize;
        assert_eq!((&bytes[..4], word(4), word(8)), (&b"glTF"[..], 2, bytes.len()));
        let next = 20 + word(12);
        assert_eq!((&bytes[16..20], &bytes[next + 4..next + 8]), (&b"JSON"[..], &b"BIN\0"[..]));
        assert_eq!(next + 8 + word(next), bytes.len());
        let json = serde_json::from_slice(&bytes[20..next]).expect("JSON");
        Glb { json, binary: bytes[next + 8..].to_vec() }
    }

    fn read(path: &str) -> Glb {
        Glb::open(&fs::read(path).expect("the file is there"))
    }

    fn view(&self, view: &Value) -> &[u8] {
        let view = &self.json["bufferViews"][number(view)];
        let start = number(&view["byteOffset"]);
        &self.binary[start..start + number(&view["byteLength"])]
    }

    fn floats(&self, accessor: &Value) -> Vec<f32> {
        let bytes = self.view(&self.json["accessors"][number(accessor)]["bufferView"]);
        bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().expect("four bytes"))).collect()
    }

    fn points(&self, accessor: &Value) -> Vec<DVec3> {
        let floats = self.floats(accessor);
        floats.chunks_exact(3).map(|p| DVec3::new(p[0].into(), p[1].into(), p[2].into())).collect()
    }

    fn primitive(&self) -> &Value {
        &self.json["meshes"][0]["primitives"][0]
    }

    /// The vertices where the weight of one target is 1.
    fn morphed(&self, target: usize) -> Vec<DVec3> {
        let primitive = self.primitive();
        let moved = self.points(&primitive["targets"][target]["POSITION"]);
        let shift: Vec<f64> =
            serde_json::from_value(self.json["nodes"][0]["translation"].clone()).unwrap_or(vec![0.0; 3]);
        let base = self.points(&primitive["attributes"]["POSITION"]);
        base.iter().zip(&moved).map(|(a, b)| a + b + DVec3::from_slice(&shift)).collect()
    }

    /// Least and greatest values as the file says, against those that it holds.
    fn assert_bounds(&self, accessor: &Value, components: usize) {
        let floats = self.floats(accessor);
        let accessor = &self.json["accessors"][number(accessor)];
        for (key, pick) in [("min", f32::min as fn(f32, f32) -> f32), ("max", f32::max)] {
            for k in 0..components {
                let all = floats.iter().skip(k).step_by(components).copied();
                assert_eq!(accessor[key][k].as_f64(), all.reduce(pick).map(f64::from), "{key} {k}");
            }
        }
    }
}

fn number(value: &Value) -> usize {
    value.as_u64().expect("a number") as usize
}

fn assert_near(found: &[DVec3], expected: &[DVec3], tolerance: f64) {
    for (i, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((a - b).length() <= tolerance, "vertex {i}: {a} instead of {b}");
    }
}

/// Rounding of sums of coordinates up to 2 in single precision.
const ROUNDING: f64 = 5e-7;

#[test]
fn a_moving_picture_goes_to_the_target_and_back() {
    let files = Files::mapped("gif");
    let gif = files.path("ball.gif");
    let run = || {
        let output = homeo(&["morph", &files.path("to_egg"), "--json", "--gif", &gif]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let result: Value = serde_json::from_slice(&output.stdout).expect("JSON on stdout");
        assert!(result["file"].is_null() && result["gif"].as_str() == Some(gif.as_str()));
        fs::read(&gif).expect("the file is there")
    };
    let bytes = run();
    assert!(bytes.starts_with(b"GIF89a") && bytes == run(), "the same bytes on every run");
    use image::AnimationDecoder;
    let decoder = image::codecs::gif::GifDecoder::new(std::io::Cursor::new(&bytes)).expect("a GIF file");
    let frames = decoder.into_frames().collect_frames().expect("all frames are sound");
    let stills: Vec<_> = frames.iter().map(|f| f.buffer().as_raw()).collect();
    assert!(stills.len() > 20 && stills[0] != stills[stills.len() / 2], "the shape changes");
    assert_eq!(stills[1], stills[stills.len() - 1], "the way back is the way there");
    let wrong = homeo(&["morph", &files.path("to_egg"), "--gif", "a.png"]);
    assert_eq!(wrong.status.code(), Some(2));
}

#[test]
fn two_maps_make_two_targets_in_the_order_of_the_vertices() {
    let files = Files::mapped("two");
    files.map("pear", |p| p * DVec3::new(1.0 - 0.3 * p.z, 1.0 - 0.3 * p.z, 1.4));
    let result = files.morph(&["to_egg", "to_pear"], &["--frames", "3"]);
    assert_eq!(result["targets"], serde_json::json!(["egg", "pear"]));
    let glb = Glb::read(&files.path("out.glb"));
    assert_eq!(glb.json["meshes"][0]["extras"]["targetNames"], result["targets"]);
    assert_eq!(glb.json["meshes"][0]["weights"], serde_json::json!([0.0, 0.0]));
    let source = files.mesh("ball.obj");
    let read_back = files.mesh("out.glb");
    assert_near(&read_back.positions, &source.positions, ROUNDING);
    let targets = glb.primitive()["targets"].as_array().expect("targets");
    for (k, name) in ["egg", "pear"].iter().enumerate() {
        let there = files.mesh(&format!("to_{name}/source_on_target.obj")).positions;
        assert_near(&glb.morphed(k), &there, ROUNDING);
        glb.assert_bounds(&targets[k]["POSITION"], 3);
        let steps = ["000", "001", "002"].map(|i| files.mesh(&format!("out_{name}_{i}.obj")));
        assert_eq!(steps[0].positions, source.positions);
        assert_eq!(steps[2].positions, there);
        assert!(steps.iter().all(|s| s.corners == source.corners && s.uv == source.uv));
        assert!(steps.iter().all(|s| s.statements == source.statements && s.material_libraries == ["ball.mtl"]));
    }
    glb.assert_bounds(&glb.primitive()["attributes"]["POSITION"], 3);
    let sampler = &glb.json["animations"][0]["samplers"][0];
    glb.assert_bounds(&sampler["input"], 1);
    assert_eq!(glb.floats(&sampler["input"]), [0.0, 1.0, 2.0, 3.0, 4.0]);
    assert_eq!(glb.floats(&sampler["output"]), [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
}

#[test]
fn seams_append_copies_and_normals_have_unit_length() {
    let files = Files::mapped("seams");
    let result = files.morph(&["to_egg", "to_egg"], &[]);
    assert_eq!(result["targets"], serde_json::json!(["egg", "egg_2"]), "names are unique");
    let (source, glb) = (files.mesh("ball.obj"), Glb::read(&files.path("out.glb")));
    let attributes = &glb.primitive()["attributes"];
    let positions = glb.points(&attributes["POSITION"]);
    // A copy for every ring, and for either pole one for each of its triangles but the first.
    let appended = SIZE[1] - 1 + 2 * (SIZE[0] - 1);
    assert_eq!(result["appended"], appended);
    assert_eq!(positions.len(), source.positions.len() + appended);
    assert_near(&positions, &source.positions, ROUNDING);
    let indices = glb.view(&glb.json["accessors"][number(&glb.primitive()["indices"])]["bufferView"]);
    let indices = indices.chunks_exact(4).map(|b| u32::from_le_bytes(b.try_into().expect("four bytes")) as usize);
    let uv = glb.floats(&attributes["TEXCOORD_0"]);
    for (i, c) in indices.zip(source.triangle_corners().flatten()) {
        assert_near(&[positions[i]], &[source.positions[source.corners[c].0 as usize]], ROUNDING);
        let expected = source.uv.at(c).expect("every corner has one");
        assert_eq!(uv[2 * i..2 * i + 2], [expected.x as f32, (1.0 - expected.y) as f32]);
    }
    let normals = glb.points(&attributes["NORMAL"]);
    let turned = glb.points(&glb.primitive()["targets"][0]["NORMAL"]);
    assert!(normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-6));
    assert!(normals.iter().zip(&turned).all(|(n, d)| ((n + d).length() - 1.0).abs() < 1e-6));
    assert!(normals.iter().zip(&positions).all(|(n, p)| n.dot(*p) > 0.0), "the ball's normals look out");
}

#[test]
fn textures_are_embedded_as_they_are() {
    let files = Files::mapped("texture");
    let without = files.morph(&["to_egg"], &[]);
    assert!(without["texture"].is_null());
    assert!(without["warnings"][0].as_str().expect("a warning").contains("ball.mtl"), "{without}");
    files.add("ball.mtl", b"newmtl skin\nmap_Kd skin.png\n");
    let missing = files.morph(&["to_egg"], &[]);
    assert!(missing["warnings"][0].as_str().expect("a warning").contains("skin.png"), "{missing}");
    files.add("skin.png", PNG);
    let other = files.add("other.png", b"\xff\xd8\xff\xe0 a JPEG by another name");
    for (flags, bytes, mime) in
        [(&[][..], PNG, "image/png"), (&["--texture", &other], &fs::read(&other).expect("there"), "image/jpeg")]
    {
        let result = files.morph(&["to_egg"], flags);
        assert_eq!(result["warnings"], serde_json::json!([]));
        let glb = Glb::read(&files.path("out.glb"));
        assert_eq!(glb.json["images"][0]["mimeType"], mime);
        assert_eq!(glb.view(&glb.json["images"][0]["bufferView"]), bytes);
        assert_eq!(glb.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"], 0);
        assert_eq!(glb.json["materials"][0]["doubleSided"], true);
    }
}

#[test]
fn bad_input_is_refused_and_nothing_written() {
    let files = Files::mapped("refusals");
    fs::create_dir(files.path("empty")).expect("writable");
    files.refuses(&["empty"], &[], &["not a finished map", "report.json"]);
    files.refuses(&["nowhere"], &[], &["not a finished map"]);
    let image = files.add("image.exr", b"\x76\x2f\x31\x01");
    files.refuses(&["to_egg"], &["--texture", &image, "--frames", "4"], &["image.exr", "neither PNG nor JPEG"]);
    files.refuses(&["to_egg"], &["--texture", "none.png"], &["none.png"]);
    let whole = fs::read_to_string(files.path("ball.obj")).expect("there");
    let there = fs::read_to_string(files.path("to_egg/source_on_target.obj")).expect("there");
    fs::create_dir(files.path("foreign")).expect("writable");
    fs::copy(files.path("to_egg/report.json"), files.path("foreign/report.json")).expect("writable");
    let (head, face) = there.trim_end().rsplit_once("\nf ").expect("faces");
    let turned: Vec<&str> = face.split(' ').rev().collect();
    files.add("foreign/source_on_target.obj", format!("{head}\nf {}\n", turned.join(" ")).as_bytes());
    files.refuses(&["to_egg", "foreign"], &[], &["foreign/source_on_target.obj", "faces in their order", "face 59"]);
    files.add("foreign/source_on_target.obj", format!("v 0 0 0\n{there}").as_bytes());
    files.refuses(&["to_egg", "foreign"], &[], &["53 vertices", "the source has 52"]);
    files.add("ball.obj", format!("v 0 0 0\n{whole}").as_bytes());
    files.refuses(&["to_egg"], &[], &["ball.obj", "53 vertices", "changed"]);
    fs::remove_file(files.path("ball.obj")).expect("it is there");
    files.refuses(&["to_egg"], &[], &["ball.obj", "not there any more"]);
    let usage = homeo(&["morph", &files.path("to_egg"), "--out", &files.path("out.obj")]);
    assert_eq!(usage.status.code(), Some(2));
}

#[test]
fn a_source_that_was_moved_is_found_and_told_from_another() {
    let files = Files::mapped("moved");
    let in_place = files.morph(&["to_egg"], &[]);
    let glb = fs::read(files.path("out.glb")).expect("the morph");
    fs::remove_file(files.path("out.glb")).expect("the morph");
    fs::rename(files.path("ball.obj"), files.path("moved.obj")).expect("the source");
    files.refuses(&["to_egg"], &[], &["ball.obj", "--source"]);
    let moved = files.path("moved.obj");
    files.refuses(&["to_egg"], &["--source", &files.path("egg.obj")], &["egg.obj", "not the one that was mapped"]);
    files.refuses(&["to_egg"], &["--source", &files.path("gone.obj")], &["gone.obj", "not there"]);
    assert_eq!(files.morph(&["to_egg"], &["--source", &moved])["vertices"], in_place["vertices"]);
    assert!(fs::read(files.path("out.glb")).expect("the morph") == glb, "another file than from the old place");
}

/// A triangle and a vertex that no face uses.
fn triangle(at: DVec3) -> MeshFile {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.1, 0.2, 0.3)];
    let mut mesh = MeshFile { positions: corners.map(|p| p + at).to_vec(), ..MeshFile::default() };
    mesh.push_polygon([0, 1, 2]);
    mesh
}

#[test]
fn meshes_far_from_the_origin_keep_their_digits_and_unused_vertices() {
    for at in [DVec3::ZERO, DVec3::new(1e6 + 0.3, -3e7, 5e8)] {
        let mesh = triangle(at);
        let positions: Vec<_> = mesh.positions.iter().map(|p| p + 0.25 * (*p - at)).collect();
        let targets = [MorphTarget { name: "larger \"one\"".to_owned(), positions: positions.clone() }];
        let morph = Morph { mesh: &mesh, name: "triangle", targets: &targets, image: None };
        let written = write_morph(&morph).expect("single precision holds it");
        assert_eq!(written.vertices, 4);
        let read_back = parse_mesh(Path::new("a.glb"), &written.bytes).expect("a sound file");
        assert_eq!(read_back.positions.len(), 4);
        let ulp = 4.0 * f64::EPSILON * at.length();
        assert_near(&read_back.positions, &mesh.positions, ROUNDING + ulp);
        let glb = Glb::open(&written.bytes);
        assert_near(&glb.morphed(0), &positions, ROUNDING + ulp);
        assert!(glb.primitive()["attributes"]["TEXCOORD_0"].is_null());
        assert_eq!(glb.json["nodes"][0]["translation"].is_null(), at == DVec3::ZERO);
        assert_eq!(glb.json["meshes"][0]["extras"]["targetNames"][0], "larger \"one\"");
    }
}

#[test]
fn coordinates_beyond_single_precision_are_refused() {
    let mut mesh = triangle(DVec3::ZERO);
    mesh.positions[2].y = 1e39;
    let morph = Morph { mesh: &mesh, name: "triangle", targets: &[], image: None };
    let error = write_morph(&morph).expect_err("single precision ends at 3.4e38");
    assert!(error.to_string().contains("vertex 2"), "{error}");
}
