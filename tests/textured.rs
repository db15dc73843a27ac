//! `homeo texture` as its users call it: files in, a folder out, bad input refused by name.

use glam::DVec2;
use homeo::mesh::io::{MeshFile, read_mesh, write_obj};
use homeo::mesh::{TriMesh, VertexId};
use homeo::plane::orientation::orientation;
use homeo::shape::fixture::{annulus, disc, icosphere, torus, two_spheres};
use serde_json::Value;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

/// A folder of one test with an image in it.
struct Files(PathBuf);

impl Files {
    fn new(test: &str) -> Self {
        let dir = std::env::temp_dir().join(format!("homeo-textured-{test}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(&dir).expect("the temporary folder is writable");
        let image = image::RgbImage::from_fn(16, 16, |x, y| image::Rgb([x as u8 * 16, y as u8 * 16, 128]));
        image.save(dir.join("image.png")).expect("the temporary folder is writable");
        Files(dir)
    }

    fn mesh(&self, mesh: &MeshFile) {
        let mut bytes = Vec::new();
        write_obj(&mut bytes, &self.0, mesh, &mesh.positions).expect("a vector can be written to");
        fs::write(self.0.join("mesh.obj"), bytes).expect("the temporary folder is writable");
    }

    fn run(&self, constraints: &str, more: &[&str]) -> Output {
        fs::write(self.0.join("c.csv"), constraints).expect("the temporary folder is writable");
        let at = |name: &str| self.0.join(name);
        let mut program = Command::new(env!("CARGO_BIN_EXE_homeo"));
        program.arg("texture").args([at("mesh.obj"), at("image.png")]).arg("--constraints").arg(at("c.csv"));
        program.arg("--out").arg(at("out")).args(["--device", "cpu"]).args(more).output().expect("the program starts")
    }

    fn refuses(&self, constraints: &str, more: &[&str], code: i32, words: &[&str]) {
        let output = self.run(constraints, more);
        let line = String::from_utf8_lossy(&output.stderr).lines().last().unwrap_or_default().to_owned();
        assert_eq!(output.status.code(), Some(code), "{line}");
        assert!(words.iter().all(|w| line.contains(w)), "{words:?} in {line}");
        assert!(!self.0.join("out").exists(), "nothing is written");
    }

    /// Runs and reads back the mesh and the report.
    fn done(&self, constraints: &str, more: &[&str]) -> (MeshFile, Value) {
        let output = self.run(constraints, more);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let out = self.0.join("out");
        let report = fs::read(out.join("report.json")).expect("a report");
        (read_mesh(&out.join("mesh.obj")).expect("a mesh"), serde_json::from_slice(&report).expect("JSON"))
    }
}

impl Drop for Files {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// The texture coordinates of a vertex, all of them equal.
fn uv_of(mesh: &MeshFile, v: VertexId) -> DVec2 {
    let mut all = (0..mesh.corners.len()).filter(|&c| mesh.corners[c] == v).map(|c| mesh.uv.at(c).expect("a uv"));
    let first = all.next().expect("the vertex is used");
    assert!(all.all(|uv| uv == first), "{v} has one place");
    first
}

fn assert_no_fold(mesh: &MeshFile) {
    for t in mesh.triangle_corners() {
        let [a, b, c] = t.map(|c| mesh.uv.at(c).expect("every corner has texture coordinates"));
        assert!(orientation(a, b, c) > 0.0);
    }
}

const THREE: &str = "vertex,u,v\n0,0.5,0.55\n40,0.3,0.6\n100,0.7,0.31\n";

#[test]
fn constraints_are_in_the_file_to_the_last_bit_and_order_is_kept() {
    let files = Files::new("exact");
    let given = MeshFile::of(&disc(10));
    files.mesh(&given);
    let (mesh, report) = files.done(THREE, &[]);
    for (v, uv) in [(0, [0.5, 0.55]), (40, [0.3, 0.6]), (100, [0.7, 0.31])] {
        assert_eq!(uv_of(&mesh, VertexId(v)), DVec2::from_array(uv));
    }
    assert_no_fold(&mesh);
    assert_eq!((mesh.positions, mesh.corners, mesh.offsets), (given.positions, given.corners, given.offsets));
    assert_eq!(report["flips"], 0);
    assert_eq!(report["constraint_error"], 0.0);
    assert_eq!(report["steiner"], serde_json::json!([0, 0]), "these can walk");
    assert!(report["e_l2"][1].as_f64() <= report["e_l2"][0].as_f64(), "smoothing lowers the stretch");
    let out = files.0.join("out");
    assert_eq!(fs::read_to_string(out.join("steiner.csv")).expect("a table"), "vertex,face,b0,b1,b2\n");
    assert_eq!(fs::read(out.join("image.png")).expect("a copy"), fs::read(files.0.join("image.png")).expect("a file"));
    assert!(fs::read_to_string(out.join("mesh.mtl")).expect("a library").contains("map_Kd image.png"));
    assert!(image::open(out.join("preview.png")).expect("a picture").width() > 1000);
    assert!(fs::read_to_string(out.join("report.html")).expect("a page").contains("every constraint met exactly"));
}

#[test]
fn polygons_and_groups_stay_as_they_are() {
    let files = Files::new("polygons");
    let side = 9u32;
    let positions = (0..side * side).map(|k| glam::DVec3::new(f64::from(k % side), f64::from(k / side), 0.0)).collect();
    let mut grid = MeshFile { positions, ..MeshFile::default() };
    for k in (0..side * (side - 1)).filter(|k| k % side < side - 1) {
        grid.push_polygon([k, k + 1, k + side + 1, k + side]);
    }
    files.mesh(&grid);
    let (mesh, _) = files.done("name,vertex,u,v\nmiddle,40,0.45,0.5\nleft,37,0.2,0.4\n", &[]);
    assert_eq!(mesh.offsets, grid.offsets, "quads stay quads");
    assert_eq!(uv_of(&mesh, VertexId(37)), DVec2::new(0.2, 0.4));
}

#[test]
fn the_same_input_gives_the_same_bytes_on_any_number_of_threads() {
    let files = Files::new("threads");
    files.mesh(&MeshFile::of(&disc(12)));
    let swapped = "vertex,u,v\n10,0.6,0.5\n20,0.4,0.5\n200,0.3,0.3\n230,0.5,0.8\n";
    let bytes = |threads: &str| {
        files.done(swapped, &["--threads", threads]);
        ["mesh.obj", "preview.png", "steiner.csv"].map(|f| fs::read(files.0.join("out").join(f)).expect("a file"))
    };
    assert!(bytes("1") == bytes("2"));
}

#[test]
fn closed_meshes_are_cut_open_and_holes_bridged() {
    let files = Files::new("closed");
    let given = MeshFile::of(&icosphere(3));
    files.mesh(&given);
    let (mesh, report) = files.done("vertex,u,v\n0,0.5,0.5\n1,0.3,0.5\n", &[]);
    assert_no_fold(&mesh);
    assert_eq!(mesh.positions, given.positions, "cut in texture space alone");
    let seam = report["seam"].as_array().expect("a list").len();
    assert!(seam >= 3);
    assert_eq!(mesh.uv.values.len(), given.positions.len() + seam - 2, "what lies between the ends is there twice");
    files.mesh(&MeshFile::of(&annulus(24, 4)));
    let (mesh, report) = files.done("vertex,u,v\n3,0.5,0.6\n60,0.4,0.2\n", &[]);
    assert_no_fold(&mesh);
    assert_eq!(report["filled_loops"], 1);
}

#[test]
fn a_seam_can_be_named() {
    let files = Files::new("seam");
    let sphere = icosphere(2);
    files.mesh(&MeshFile::of(&sphere));
    let first = VertexId(20);
    let second = sphere.conn.outgoing(first).map(|h| sphere.conn.to(h)).next().expect("a neighbour");
    let around = |v: VertexId| sphere.conn.outgoing(v).map(|h| sphere.conn.to(h)).collect::<Vec<_>>();
    let third = around(second).into_iter().find(|v| *v != first && !around(first).contains(v)).expect("one farther");
    let seam = format!("{},{},{}", first.0, second.0, third.0);
    let (_, report) = files.done("vertex,u,v\n0,0.5,0.5\n", &["--seam", &seam]);
    assert_eq!(report["seam"], serde_json::json!([first.0, second.0, third.0]));
    let _ = fs::remove_dir_all(files.0.join("out"));
    files.refuses("vertex,u,v\n0,0.5,0.5\n", &["--seam", "20,21"], 3, &["mesh.obj", "seam of 2"]);
    files.refuses(
        "vertex,u,v\n0,0.5,0.5\n",
        &["--seam", &format!("{},{},{}", first.0, third.0, second.0)],
        3,
        &["no edge"],
    );
    let through = format!("vertex,u,v\n{},0.5,0.5\n", second.0);
    files.refuses(&through, &["--seam", &seam], 3, &["lies on the seam"]);
}

#[test]
fn bad_constraints_are_refused_by_name() {
    let files = Files::new("refused");
    files.mesh(&MeshFile::of(&disc(6)));
    let refuses = |rows: &str, words: &[&str]| files.refuses(&format!("name,vertex,u,v\n{rows}"), &[], 3, words);
    refuses("a,1,0.5,0.5\nb,2,0.5,0.5\n", &["c.csv", "\"a\" and \"b\"", "same place"]);
    refuses("a,1,0.5,0.5\nb,1,0.6,0.5\n", &["vertex 1", "twice", "\"a\" and \"b\""]);
    refuses("a,1,0.5,1.5\n", &["outside of the image", "line 2"]);
    refuses("a,1,0,0.5\n", &["border of the image", "line 2"]);
    refuses("a,99999,0.5,0.5\n", &["99999", "out of range"]);
    refuses("a,1,x,0.5\n", &["u", "x", "line 2"]);
    refuses("a,1,NaN,0.5\n", &["u", "NaN", "line 2"]);
    refuses("", &["no constraints"]);
    files.refuses("vertex,u\n1,0.5\n", &[], 3, &["column v is missing"]);
}

#[test]
fn meshes_that_are_no_discs_are_refused() {
    let files = Files::new("meshes");
    let one = "vertex,u,v\n0,0.5,0.5\n";
    let refuses = |mesh: &MeshFile, code: i32, words: &[&str]| {
        files.mesh(mesh);
        files.refuses(one, &[], code, words);
    };
    let of = |mesh: TriMesh| MeshFile::of(&mesh);
    refuses(&of(torus(12, 8)), 4, &["mesh.obj", "handles"]);
    refuses(&of(two_spheres(1)), 3, &["2 pieces"]);
    let mut charts = MeshFile::of(&disc(3));
    charts.uv.values = charts.corners.iter().map(|v| DVec2::splat(f64::from(v.0))).collect();
    charts.uv.corners = (0..charts.corners.len() as u32).collect();
    refuses(&charts, 3, &["texture coordinates of its own", "charts"]);
    let mut unused = MeshFile::of(&disc(3));
    unused.positions.insert(0, glam::DVec3::ZERO);
    unused.corners.iter_mut().for_each(|v| v.0 += 1);
    refuses(&unused, 3, &["vertex 0", "no face uses"]);
}
