//! Promises of `homeo diffuse`: files that belong together, the same bytes on any number of threads, refusals that name the
//! region, and nothing written where something is wrong.

mod common;

use common::mesh::{grid, sphere};
use glam::{DVec2, DVec3};
use homeo::mesh::io::{MeshFile, read_mesh, write_obj};
use homeo::mesh::{TriMesh, VertexId};
use homeo::picture::{Depth, Picture, file::format_for, read_picture};
use homeo::shape::fixture;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn homeo(arguments: &[&str]) -> Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_homeo"));
    program.env_remove("RUST_BACKTRACE").args(arguments).output().expect("the program starts")
}

/// Runs a command that must succeed; returns its report.
fn report(arguments: &[&str]) -> Value {
    let output = homeo(&[&["--json"], arguments].concat());
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("a report")
}

/// A folder of one test with mesh files in it.
struct Files(PathBuf);

impl Files {
    fn new(test: &str) -> Self {
        let dir = std::env::temp_dir().join(format!("homeo-diffuse-{test}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(&dir).expect("the temporary folder is writable");
        Files(dir)
    }

    fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().expect("the temporary folder has a plain name").to_owned()
    }

    fn add(&self, name: &str, content: &[u8]) -> String {
        fs::write(self.path(name), content).expect("the temporary folder is writable");
        self.path(name)
    }

    fn mesh(&self, name: &str, mesh: &MeshFile) -> String {
        let mut bytes = Vec::new();
        write_obj(&mut bytes, &self.0, mesh, &mesh.positions).expect("memory takes everything");
        self.add(name, &bytes)
    }

    /// A table of regions by a name for the middle of every face.
    fn regions(&self, name: &str, mesh: &TriMesh, region: impl Fn(DVec3) -> &'static str) -> String {
        let middle = |t: [DVec3; 3]| t.iter().sum::<DVec3>() / 3.0;
        let rows = mesh.conn.faces().map(|f| format!("{},{}\n", f.0, region(middle(mesh.triangle(f)))));
        self.add(name, format!("face,region\n{}", rows.collect::<String>()).as_bytes())
    }

    fn refuses(&self, arguments: &[&str], code: i32, words: &[&str]) {
        let out = self.path("refused");
        let output = homeo(&[&["diffuse"], arguments, &["--out", &out]].concat());
        let line = String::from_utf8_lossy(&output.stderr).lines().last().unwrap_or_default().to_owned();
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {line}");
        assert!(line.starts_with("error: "), "{line}");
        words.iter().for_each(|word| assert!(line.contains(word), "no \"{word}\" in: {line}"));
        let left: Vec<PathBuf> =
            fs::read_dir(&self.0).expect("readable").map(|e| e.expect("readable").path()).collect();
        assert!(!left.iter().any(|p| p.to_string_lossy().contains("refused")), "{left:?}");
    }
}

impl Drop for Files {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// The sides of the grid of `n` by `m` squares, and all its faces in one region.
fn grid_regions(mesh: &TriMesh, n: usize, m: usize) -> Value {
    let at = |i: usize, j: usize| j * (n + 1) + i;
    let column = |i: usize| (0..=m).map(|j| at(i, j)).collect::<Vec<_>>();
    let row = |j: usize| (0..=n).map(|i| at(i, j)).collect::<Vec<_>>();
    let sides = json!({ "u0": column(0), "u1": column(n), "v0": row(0), "v1": row(m) });
    let faces: Vec<usize> = (0..mesh.conn.face_count()).collect();
    json!({ "regions": [{ "name": "all", "faces": faces, "sides": sides }] })
}

fn hemisphere(p: DVec3) -> &'static str {
    if p.z > 0.0 { "north" } else { "south" }
}

/// The middle of a triangle never lies on a plane between octants.
fn octant(p: DVec3) -> &'static str {
    const NAMES: [&str; 8] = ["a", "b", "c", "d", "e", "f", "g", "h"];
    NAMES[usize::from(p.x > 0.0) + 2 * usize::from(p.y > 0.0) + 4 * usize::from(p.z > 0.0)]
}

#[test]
fn the_folder_holds_what_the_next_run_can_read() {
    let files = Files::new("folder");
    let mesh = files.mesh("ball.obj", &MeshFile::of(&sphere(23, 32)));
    let out = files.path("out");
    let made = report(&["diffuse", &mesh, "--segment", "6", "--out", &out]);
    assert_eq!(made["mesh"]["regions"].as_array().map(Vec::len), Some(6));
    let names =
        ["mesh.obj", "mesh.mtl", "grid.png", "preview.png", "uv.csv", "regions.json", "report.json", "report.html"];
    for name in names {
        assert!(Path::new(&out).join(name).is_file(), "{name}");
    }
    let textured = read_mesh(&Path::new(&out).join("mesh.obj")).expect("a mesh");
    assert_eq!(textured.positions, read_mesh(Path::new(&mesh)).expect("a mesh").positions, "vertices in their order");
    assert_eq!(textured.material_libraries, ["mesh.mtl"]);
    assert!(textured.uv.values.iter().all(|p| p.cmpge(DVec2::ZERO).all() && p.cmple(DVec2::ONE).all()));
    let table = fs::read_to_string(Path::new(&out).join("uv.csv")).expect("a table");
    assert_eq!(table.lines().next(), Some("vertex,region,u,v,sides"));
    assert_eq!(table.lines().count(), 1 + textured.uv.values.len());
    // The regions as JSON, with sides, and as materials of the written mesh, without.
    let (again, by_material) = (files.path("again"), files.path("by-material"));
    report(&["diffuse", &mesh, "--regions", &format!("{out}/regions.json"), "--out", &again]);
    assert_eq!(fs::read_to_string(Path::new(&again).join("uv.csv")).expect("a table"), table);
    let read = report(&["diffuse", &format!("{out}/mesh.obj"), "--regions", "materials", "--out", &by_material]);
    assert_eq!(read["mesh"]["regions"].as_array().map(Vec::len), Some(6));
}

#[test]
fn bytes_do_not_depend_on_threads() {
    let files = Files::new("threads");
    let mesh = files.mesh("ball.obj", &MeshFile::of(&sphere(23, 32)));
    let outs = ["1", "3"].map(|threads| {
        let out = files.path(threads);
        let segmented = ["diffuse", &mesh, "--segment", "7", "--repair", "--threads", threads, "--out", &out];
        report(&segmented);
        out
    });
    for name in ["mesh.obj", "mesh.mtl", "grid.png", "preview.png", "uv.csv", "regions.json"] {
        let [one, three] = outs.each_ref().map(|out| fs::read(Path::new(out).join(name)).expect("written"));
        assert!(one == three, "{name}");
    }
}

#[test]
fn a_second_mesh_is_mapped_onto_with_tables_both_ways() {
    let files = Files::new("onto");
    let balls = [fixture::icosphere(3), sphere(23, 32)];
    let [a, b] = [0, 1].map(|k| files.mesh(["a.obj", "b.obj"][k], &MeshFile::of(&balls[k])));
    let [r, q] = [0, 1].map(|k| files.regions(["a.csv", "b.csv"][k], &balls[k], octant));
    let out = files.path("out");
    let made = report(&["diffuse", &a, "--regions", &r, "--onto", &b, "--onto-regions", &q, "--repair", "--out", &out]);
    assert!(made["distortion"]["forward"]["e_l2"].as_f64().expect("a number") < 1.5, "{}", made["distortion"]);
    assert_eq!(made["mesh"]["completions"].as_array().map(Vec::len), Some(8));
    for (name, from) in [("source_on_target", &balls[0]), ("target_on_source", &balls[1])] {
        let table = fs::read_to_string(Path::new(&out).join(format!("{name}.csv"))).expect("a table");
        assert_eq!(table.lines().count(), 1 + from.positions.len());
        let moved = read_mesh(&Path::new(&out).join(format!("{name}.obj"))).expect("a mesh");
        let off = moved.positions.iter().zip(from.positions.iter()).map(|(p, q)| p.distance(*q));
        assert!(off.sum::<f64>() / (from.positions.len() as f64) < 0.06, "{name}");
    }
    assert!(Path::new(&out).join("onto_uv.csv").is_file());
}

/// An image of four colours goes from one rectangle to another one, into its texture coordinates or into an atlas.
#[test]
fn textures_are_carried_over() {
    let files = Files::new("texture");
    let mesh = grid(8, 8);
    let mut source = MeshFile::of(&mesh);
    source.uv.values = source.positions.iter().map(|p| p.truncate() / 8.0).collect();
    source.uv.corners = source.corners.iter().map(|v: &VertexId| v.0).collect();
    let mut target = source.clone();
    target.positions.iter_mut().for_each(|p| *p = *p * 3.0 + DVec3::Z);
    // Turned by a quarter, so that the image has to be as well.
    target.uv.values.iter_mut().for_each(|p| *p = DVec2::new(1.0 - p.y, p.x));
    let [a, b] = [files.mesh("a.obj", &source), files.mesh("b.obj", &target)];
    let c = files.mesh("c.obj", &MeshFile { uv: Default::default(), ..target });
    let regions = files.add("r.json", grid_regions(&mesh, 8, 8).to_string().as_bytes());
    let color = |i: usize| [f32::from(u8::from(i % 64 < 32)), f32::from(u8::from(i / 64 < 32)), 0.0, 1.0];
    let image =
        Picture { width: 64, height: 64, channels: 3, depth: Depth::Byte, pixels: (0..64 * 64).map(color).collect() };
    let path = files.path("image.png");
    let mut file = fs::File::create(&path).expect("writable");
    image.write(format_for(Path::new(&path), Depth::Byte).expect("PNG"), &mut file).expect("written");
    for (onto, atlas) in [(&b, false), (&c, true)] {
        let out = files.path("out");
        let pair = ["--regions", &regions, "--onto", onto, "--onto-regions", &regions];
        let made =
            report(&[&["diffuse", &a], &pair[..], &["--texture", &path, "--device", "cpu", "--out", &out]].concat());
        assert_eq!(made["texture"]["unfilled"], 0);
        let carried = read_picture(&Path::new(&out).join("target_texture.png"), false).expect("an image");
        let at = |u: f64, v: f64| {
            let [x, y] = [u, 1.0 - v].map(|t| (t * carried.width as f64) as usize);
            carried.pixels[y * carried.width + x]
        };
        assert_eq!(Path::new(&out).join("target_atlas.obj").is_file(), atlas);
        // In the atlas of one region its cell, and one for folds beside it, are half as wide.
        let place = |u: f64, v: f64| if atlas { (0.5 * u, 0.5 * v) } else { (1.0 - v, u) };
        for (u, v) in [(0.2, 0.2), (0.8, 0.2), (0.2, 0.8), (0.8, 0.8)] {
            let (x, y) = place(u, v);
            let expected = [f32::from(u8::from(u < 0.5)), f32::from(u8::from(v > 0.5))];
            assert_eq!(at(x, y)[..2], expected, "at {u}, {v}");
        }
    }
}

/// ```text
///   top      one neighbour all around: an end
///   belt     two borders: a tube
///   bottom
/// ```
#[test]
fn limbs_are_divided_alike_on_both_meshes() {
    let files = Files::new("limbs");
    let band = |p: DVec3| match p.z {
        z if z > 0.5 => "top",
        z if z > -0.5 => "belt",
        _ => "bottom",
    };
    let balls = [fixture::icosphere(4), sphere(31, 40)];
    let [a, b] = [0, 1].map(|k| files.mesh(["a.obj", "b.obj"][k], &MeshFile::of(&balls[k])));
    let [r, q] = [0, 1].map(|k| files.regions(["a.csv", "b.csv"][k], &balls[k], band));
    let out = files.path("out");
    let pair = ["diffuse", &a, "--regions", &r, "--onto", &b, "--onto-regions", &q, "--out", &out];
    let made = report(&[&pair[..], &["--split-ends", "--repair"]].concat());
    let names: Vec<&str> =
        made["onto"]["regions"].as_array().expect("regions").iter().filter_map(|r| r["name"].as_str()).collect();
    assert_eq!(names.len(), 6);
    assert!(names.contains(&"belt a") && names.contains(&"top b"), "{names:?}");
    let moved = read_mesh(&Path::new(&out).join("source_on_target.obj")).expect("a mesh");
    let off = moved.positions.iter().zip(balls[0].positions.iter()).map(|(p, q)| p.distance(*q));
    let mean = off.sum::<f64>() / balls[0].positions.len() as f64;
    // Around a circle nothing but its triangles says where a seam starts and runs: the halves correspond roughly.
    assert!(mean < 0.25, "{mean}");
}

/// A finished map gives the second mesh the regions of the first.
#[test]
fn regions_go_through_a_finished_map() {
    let files = Files::new("through");
    let (ball, egg) = (sphere(17, 24), sphere(15, 20));
    let mut long = MeshFile::of(&egg);
    long.positions.iter_mut().for_each(|p| p.z *= 1.4);
    let [a, b] = [files.mesh("a.obj", &MeshFile::of(&ball)), files.mesh("b.obj", &long)];
    let nearest = |mesh: &TriMesh, to: DVec3| {
        let far = |v: &VertexId| mesh.positions[*v].distance_squared(to);
        mesh.conn.vertices().min_by(|v, w| far(v).total_cmp(&far(w))).expect("vertices").0
    };
    let axes = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
    let rows = axes.iter().enumerate().map(|(i, &p)| format!("{i},{},{}\n", nearest(&ball, p), nearest(&egg, p)));
    let landmarks =
        files.add("l.csv", format!("name,source_vertex,target_vertex\n{}", rows.collect::<String>()).as_bytes());
    let map = files.path("map");
    let quick = ["--relax", "patch", "--image", "0", "--device", "cpu", "-q", "--out", &map];
    assert!(homeo(&[&["map", &a, &b, "--landmarks", &landmarks], &quick[..]].concat()).status.success());
    let (out, regions) = (files.path("out"), files.regions("r.csv", &ball, hemisphere));
    let made = report(&["diffuse", &a, "--regions", &regions, "--onto-map", &map, "--repair", "--out", &out]);
    assert_eq!(made["onto"]["regions"].as_array().map(Vec::len), Some(2));
}

#[test]
fn bad_input_is_refused_with_the_name_of_the_region() {
    let files = Files::new("refusals");
    let ring = fixture::annulus(12, 3);
    let mesh = files.mesh("ring.obj", &MeshFile::of(&ring));
    let whole = files.regions("whole.csv", &ring, |_| "ring");
    files.refuses(&[&mesh, "--regions", &whole], 3, &["whole.csv", "\"ring\"", "2 borders", "--split-ends"]);
    let some = files.add("some.csv", b"face,region\n0,a\n1,a\n");
    files.refuses(&[&mesh, "--regions", &some], 3, &["some.csv", "in no region", "face 2"]);
    let apart = files.regions("apart.csv", &ring, |p| if p.x.abs() > 0.5 { "ends" } else { "rest" });
    files.refuses(&[&mesh, "--regions", &apart], 3, &["\"ends\"", "2 pieces"]);

    let square = grid(4, 4);
    let mesh = files.mesh("square.obj", &MeshFile::of(&square));
    let mut crossing = grid_regions(&square, 4, 4);
    let sides = &mut crossing["regions"][0]["sides"];
    (sides["u0"], sides["v1"]) = (sides["v1"].clone(), sides["u0"].clone());
    let crossing = files.add("crossing.json", crossing.to_string().as_bytes());
    files.refuses(&[&mesh, "--regions", &crossing], 3, &["crossing.json", "\"all\"", "cross"]);
    let mut inside = grid_regions(&square, 4, 4);
    inside["regions"][0]["sides"]["u0"] = json!([0, 6]);
    let inside = files.add("inside.json", inside.to_string().as_bytes());
    files.refuses(&[&mesh, "--regions", &inside], 3, &["u0", "\"all\"", "vertex 6"]);

    let ball = sphere(11, 16);
    let mesh = files.mesh("ball.obj", &MeshFile::of(&ball));
    let halves = files.regions("halves.csv", &ball, hemisphere);
    let octants = files.regions("octants.csv", &ball, octant);
    let sectors = files.regions("sectors.csv", &ball, |p| if p.x > 0.0 { "north" } else { octant(p) });
    let onto = |a: &str, b: &str, words: &[&str]| {
        files.refuses(&[&mesh, "--regions", a, "--onto", &mesh, "--onto-regions", b], 4, words);
    };
    onto(&halves, &octants, &["octants.csv", "\"south\""]);
    onto(&octants, &sectors, &["sectors.csv"]);
    files.refuses(&[&mesh, "--segment", "1"], 4, &["ball.obj", "2 or more"]);
    files.refuses(&[&mesh, "--segment", "0"], 2, &["--segment"]);
    files.refuses(&[&mesh], 2, &["--regions"]);
    files.refuses(&[&mesh, "--segment", "4", "--texture", "t.png"], 2, &["--onto"]);
    files.refuses(&[&mesh, "--regions", &files.path("missing.json")], 3, &["missing.json"]);
}
