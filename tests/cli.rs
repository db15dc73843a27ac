//! Promises of the command line: exit codes, refusals, one line per error, JSON on request, quiet streams.

use serde_json::Value;
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

fn homeo(arguments: &[&str]) -> Output {
    program().args(arguments).output().expect("the program starts")
}

fn program() -> Command {
    let mut program = Command::new(env!("CARGO_BIN_EXE_homeo"));
    program.env_remove("RUST_BACKTRACE").env_remove("HOMEO_REQUIRE_GPU").env_remove("NO_COLOR");
    program
}

fn code(output: &Output) -> i32 {
    output.status.code().expect("the program is not killed")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("output is UTF-8")
}

/// The error line; drivers may have written lines of their own before it.
fn error_line(output: &Output) -> String {
    let stderr = text(&output.stderr);
    stderr.lines().last().unwrap_or_default().to_owned()
}

/// Asserts that the program refuses, with this exit code and a line that holds all the words.
fn refuses(arguments: &[&str], expected: i32, words: &[&str]) {
    let output = homeo(arguments);
    let line = error_line(&output);
    assert_eq!(code(&output), expected, "{arguments:?}: {line}");
    assert!(line.starts_with("error: "), "{arguments:?}: {line}");
    for word in words {
        assert!(line.contains(word), "{arguments:?}: no \"{word}\" in: {line}");
    }
}

/// A folder of one test with mesh files in it.
struct Files(PathBuf);

impl Files {
    fn new(test: &str) -> Self {
        let dir = std::env::temp_dir().join(format!("homeo-cli-{test}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(&dir).expect("the temporary folder is writable");
        Files(dir)
    }

    fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().expect("the temporary folder has a plain name").to_owned()
    }

    fn add(&self, name: &str, content: &str) -> String {
        fs::write(self.path(name), content).expect("the temporary folder is writable");
        self.path(name)
    }
}

impl Drop for Files {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
const LANDMARKS: &str = "name,source_vertex,target_vertex\na,0,0\nb,1,1\nc,2,2\n";

#[test]
fn help_and_version_are_no_errors() {
    for arguments in [["--help"], ["--version"], ["-h"]] {
        let output = homeo(&arguments);
        assert_eq!(code(&output), 0);
        assert!(text(&output.stdout).contains("homeo") || text(&output.stdout).contains("Usage"));
    }
    let output = homeo(&["--help"]);
    for command in ["map", "demo", "check", "measure", "devices", "texture", "diffuse", "bake", "morph", "batch"] {
        assert!(text(&output.stdout).contains(command), "{command}");
    }
}

#[test]
fn wrong_arguments_are_one_line_and_exit_2() {
    refuses(&["map"], 2, &["required", "--landmarks"]);
    refuses(&["nonsense"], 2, &["nonsense"]);
    refuses(&["devices", "--colour"], 2, &["--colour"]);
    refuses(&["devices", "--threads", "0"], 2, &["threads", "0"]);
    refuses(&["map", "a.obj", "b.obj", "--landmarks", "c.csv", "--out", "o", "--image", "64"], 2, &["64", "65"]);
    assert_eq!(code(&homeo(&[])), 2);
    let stderr = text(&homeo(&["map"]).stderr);
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
}

#[test]
fn a_batch_needs_a_manifest_and_a_place() {
    refuses(&["batch"], 2, &["--out", "MANIFEST"]);
    refuses(&["batch", "some.csv", "--out", "out", "--frames", "3"], 2, &["--frames"]);
    refuses(&["batch", "some.csv", "--out", "out"], 3, &["some.csv", "No such file"]);
    refuses(&["batch", "some.csv", "--out", "out", "--shard", "3/2"], 2, &["3/2", "1 <= I <= N"]);
    refuses(&["batch", "some.csv", "--merge", "out"], 2, &["--merge"]);
}

#[test]
fn a_texture_that_cannot_be_carried_is_refused_before_the_work() {
    let files = Files::new("texture");
    let (mesh, landmarks) = (files.add("mesh.obj", TETRAHEDRON), files.add("l.csv", LANDMARKS));
    let out = files.path("out");
    let map = ["map", &mesh, &mesh, "--landmarks", &landmarks, "--out", &out, "--device", "cpu", "--texture"];
    refuses(&[map.as_slice(), &[&files.path("missing.png")]].concat(), 3, &["mesh.obj", "no texture coordinates"]);
    refuses(&["transfer", &out, "--texture", "t.png", "--out", "u.png"], 3, &[&out, "not a finished map"]);
    refuses(&["transfer", &out, "--out", "u.png"], 2, &["--texture"]);
    refuses(&["bake", &mesh, "--out", &files.path("b.exr")], 3, &["mesh.obj", "no texture coordinates"]);
    refuses(&["bake", &mesh, "--out", &files.path("b.png")], 2, &["b.png", ".exr"]);
    assert!(!PathBuf::from(&out).exists() && !PathBuf::from(files.path("b.exr")).exists());
}

#[test]
fn unreadable_input_is_exit_3_and_names_the_file() {
    let files = Files::new("unreadable");
    let good = files.add("good.obj", TETRAHEDRON);
    let cut = files.add("cut.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n");
    let landmarks = files.add("l.csv", LANDMARKS);
    let out = files.path("out");
    let map = |source: &str, target: &str, landmarks: &str, words: &[&str]| {
        refuses(&["map", source, target, "--landmarks", landmarks, "--out", &out, "--device", "cpu"], 3, words);
        assert!(!PathBuf::from(&out).exists());
    };
    map(&files.path("missing.obj"), &good, &landmarks, &["missing.obj"]);
    map(&cut, &good, &landmarks, &["cut.obj", "line 4"]);
    map(&good, &good, &files.path("missing.csv"), &["missing.csv"]);
    let beyond = files.add("beyond.csv", "name,source_vertex,target_vertex\na,0,0\nb,1,1\nc,99,2\n");
    map(&good, &good, &beyond, &["beyond.csv", "99", "row 3"]);
}

#[test]
fn different_genus_is_exit_4() {
    let files = Files::new("genus");
    let good = files.add("good.obj", TETRAHEDRON);
    let torus = files.add("torus.obj", &torus());
    let landmarks = files.add("l.csv", LANDMARKS);
    let out = files.path("out");
    refuses(
        &["map", &good, &torus, "--landmarks", &landmarks, "--out", &out, "--device", "cpu"],
        4,
        &["torus.obj", "genus"],
    );
}

#[test]
fn a_hint_is_followed_or_refused_by_name() {
    let files = Files::new("hint");
    let torus = files.add("torus.obj", &torus());
    let landmarks = files.add("l.csv", "name,source_vertex,target_vertex\na,5,5\nb,10,10\n");
    let curve =
        |target: &str| format!(r#"{{"loops": [{{"name": "tube", "source": [0, 1, 2, 3], "target": {target}}}]}}"#);
    let out = files.path("out");
    let map = ["map", &torus, &torus, "--landmarks", &landmarks, "--out", &out, "--device", "cpu", "--image", "0"];
    let with = |hint: &str| [&map[..], &["--hint", hint]].concat().into_iter().map(str::to_owned).collect::<Vec<_>>();
    for (name, content, expected, words) in [
        ("absent.json", None, 3, ["absent.json", ""]),
        ("list.json", Some("[0, 1, 2]".to_owned()), 3, ["list.json", "no list of loops"]),
        ("beyond.json", Some(curve("[0, 1, 16]")), 3, ["beyond.json", "16 is no vertex of the target"]),
        ("other.json", Some(curve("[4, 5, 6, 7]")), 4, ["other.json", "landmark \"a\" lies on loop \"tube\""]),
    ] {
        let path = content.map_or_else(|| files.path(name), |content| files.add(name, &content));
        let arguments = with(&path);
        refuses(&arguments.iter().map(String::as_str).collect::<Vec<_>>(), expected, &words);
    }
    let arguments = with(&files.add("good.json", &curve("[0, 1, 2, 3]")));
    let output = homeo(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("landmarks and hint leave open"), "{}", text(&output.stderr));
}

/// A torus of 4 x 4 quads, each cut into two triangles.
fn torus() -> String {
    let angle = |i: usize| i as f64 * std::f64::consts::FRAC_PI_2;
    let mut obj = String::new();
    for (i, j) in (0..16).map(|k| (k / 4, k % 4)) {
        let r = 2.0 + angle(j).cos();
        obj += &format!("v {} {} {}\n", r * angle(i).cos(), r * angle(i).sin(), angle(j).sin());
    }
    for (i, j) in (0..16).map(|k| (k / 4, k % 4)) {
        let at = |i: usize, j: usize| 1 + 4 * (i % 4) + j % 4;
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        obj += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
    }
    obj
}

#[test]
fn a_device_that_is_not_there_is_exit_5() {
    let files = Files::new("device");
    let good = files.add("good.obj", TETRAHEDRON);
    let landmarks = files.add("l.csv", LANDMARKS);
    let out = files.path("out");
    let device = "a device of that name exists nowhere";
    refuses(&["map", &good, &good, "--landmarks", &landmarks, "--out", &out, "--device", device], 5, &["device"]);
    assert!(!PathBuf::from(&out).exists());
}

#[test]
fn a_foreign_output_folder_is_refused_before_the_work_starts() {
    let files = Files::new("foreign");
    files.add("precious.txt", "x");
    let dir = files.0.to_str().expect("a plain name").to_owned();
    refuses(
        &["map", "no.obj", "no.obj", "--landmarks", "no.csv", "--out", &dir],
        2,
        &["output folder", "not an output"],
    );
    assert!(PathBuf::from(files.path("precious.txt")).exists());
}

#[test]
fn json_errors_have_the_same_parts_on_stdout() {
    let output = homeo(&["measure", "nowhere.obj", "nowhere.obj", "--json"]);
    assert_eq!(code(&output), 3);
    let json: Value = serde_json::from_slice(&output.stdout).expect("JSON on stdout");
    assert_eq!(json["error"]["kind"], "input");
    assert_eq!(json["error"]["exit_code"], 3);
    assert_eq!(json["error"]["file"], "nowhere.obj");
    for part in ["what", "element", "remedy"] {
        assert!(json["error"][part].is_string(), "{part}");
    }
    let output = homeo(&["map", "--json"]);
    let json: Value = serde_json::from_slice(&output.stdout).expect("JSON on stdout");
    assert_eq!((code(&output), json["error"]["kind"].as_str()), (2, Some("usage")));
}

#[test]
fn check_lists_every_fault_and_exits_3() {
    let files = Files::new("check");
    let good = files.add("good.obj", TETRAHEDRON);
    let fan = files.add("fan.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 2 1 4\nf 1 2 5\n");
    let output = homeo(&["check", &good]);
    assert_eq!(code(&output), 0, "{}", text(&output.stdout));
    let output = homeo(&["check", &good, &fan, &files.path("none.obj")]);
    let stdout = text(&output.stdout);
    assert_eq!(code(&output), 3);
    assert!(stdout.contains("edge 0-1 belongs to 3 faces") && stdout.contains("none.obj"), "{stdout}");
    let output = homeo(&["check", &good, &fan, "--json"]);
    let json: Value = serde_json::from_slice(&output.stdout).expect("JSON on stdout");
    assert_eq!(json["sound"], false);
    assert_eq!(json["meshes"][0]["genus"], 0);
    assert_eq!(json["meshes"][1]["faults"][0]["kind"], "non_manifold_edge");
}

#[test]
fn check_takes_landmarks_for_two_meshes() {
    let files = Files::new("check-landmarks");
    let good = files.add("good.obj", TETRAHEDRON);
    let landmarks = files.add("l.csv", LANDMARKS);
    let twice = files.add("twice.csv", "name,source_vertex,target_vertex\na,0,0\nb,0,1\nc,2,2\n");
    let output = homeo(&["check", &good, &good, "--landmarks", &landmarks]);
    assert_eq!(code(&output), 0, "{}", text(&output.stdout));
    let output = homeo(&["check", &good, &good, "--landmarks", &twice]);
    assert_eq!(code(&output), 3);
    assert!(text(&output.stdout).contains("row 2"), "{}", text(&output.stdout));
    refuses(&["check", &good, "--landmarks", &landmarks], 2, &["two meshes"]);
}

#[test]
fn devices_says_what_is_taken() {
    let output = homeo(&["devices", "--device", "cpu", "--json"]);
    assert_eq!(code(&output), 0);
    let json: Value = serde_json::from_slice(&output.stdout).expect("JSON on stdout");
    assert_eq!(json["cpu_taken"], true);
    assert!(json["adapters"].is_array());
    assert!(text(&homeo(&["devices"]).stdout).contains("* "));
}

#[test]
fn colours_are_off_without_a_terminal_and_on_when_asked_for() {
    let colourful = |output: &Output| output.stderr.contains(&0x1b);
    assert!(!colourful(&homeo(&["measure", "no.obj", "no.obj"])));
    assert!(colourful(&homeo(&["measure", "no.obj", "no.obj", "--color", "always"])));
    assert!(!colourful(&homeo(&["--color", "never", "measure", "no.obj", "no.obj"])));
}

#[test]
fn progress_as_json_lines_names_stages_and_events() {
    let files = Files::new("progress");
    let cut = files.add("cut.obj", "v 0 0 0\n");
    let map = ["map", &cut, &cut, "--landmarks", "no.csv", "--device", "cpu", "--progress", "jsonl"];
    let output = homeo(&[&map, &["--out", &files.path("out")][..]].concat());
    let stderr = text(&output.stderr);
    let events: Vec<Value> = stderr.lines().filter_map(|l| serde_json::from_str(l).ok()).collect();
    let seen: Vec<_> = events.iter().map(|e| (e["stage"].as_str(), e["event"].as_str())).collect();
    assert_eq!(seen, [(Some("load"), Some("started")), (Some("load"), Some("failed"))], "{stderr}");
}

/// `homeo check ... | head -1`: the reader goes away while there is more to say.
#[test]
#[cfg(unix)]
fn a_reader_that_goes_away_is_no_error() {
    let files = Files::new("pipe");
    let mut fans = String::new();
    for i in 0..20_000 {
        fans += &format!("v {i} 0 0\nv {i} 1 0\nv {i} 0 1\n");
    }
    for i in 0..20_000 {
        let v = 3 * i + 1;
        fans += &format!("f {v} {} {}\nf {v} {} {}\n", v + 1, v + 2, v + 1, v + 2);
    }
    let many = files.add("many.obj", &fans);
    let mut child = program()
        .args(["check", &many])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("the program ends");
    assert_eq!(code(&output), 3);
    assert!(!text(&output.stderr).contains("panicked"), "{}", text(&output.stderr));
}

/// A sphere as OBJ: the faces of a cube in n x n quads, pushed out, then moved by `shape`.
fn ball(n: usize, shape: impl Fn([f64; 3]) -> [f64; 3]) -> String {
    let mut numbers = std::collections::BTreeMap::new();
    let mut obj = String::new();
    let mut faces = String::new();
    let mut vertex = |place: [usize; 3]| {
        let next = numbers.len() + 1;
        *numbers.entry(place).or_insert_with(|| {
            let p = place.map(|x| 2.0 * x as f64 / n as f64 - 1.0);
            let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
            let [x, y, z] = shape(p.map(|x| x / length));
            obj += &format!("v {x:?} {y:?} {z:?}\n");
            next
        })
    };
    for (axis, side, i, j) in (0..6 * n * n).map(|k| (k / n / n % 3, k / n / n / 3, k / n % n, k % n)) {
        let mut at = |i: usize, j: usize| {
            let mut place = [0; 3];
            (place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3]) = (side * n, i, j);
            vertex(place)
        };
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        let [b, d] = if side == 1 { [b, d] } else { [d, b] };
        faces += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
    }
    obj + &faces
}

/// A pair of balls of different shape and fineness; landmarks are the corners of the cubes.
fn balls(files: &Files) -> [String; 3] {
    let corners = |n: usize| {
        let obj = ball(n, |p| p);
        let is_corner = |line: &&str| {
            line.starts_with('v') && line.split(' ').skip(1).all(|x| x.trim_start_matches('-').starts_with("0.577"))
        };
        let lines: Vec<&str> = obj.lines().collect();
        let mut found: Vec<(String, usize)> = lines
            .iter()
            .enumerate()
            .filter(|(_, l)| is_corner(l))
            .map(|(i, l)| (l.split(' ').skip(1).map(|x| if x.starts_with('-') { '-' } else { '+' }).collect(), i))
            .collect();
        found.sort();
        found
    };
    let rows = corners(4).into_iter().zip(corners(6)).map(|((name, s), (_, t))| format!("{name},{s},{t}\n"));
    let landmarks = "name,source_vertex,target_vertex\n".to_owned() + &rows.collect::<String>();
    [
        files.add("source.obj", &ball(4, |p| p)),
        files.add("target.obj", &ball(6, |[x, y, z]| [2.0 * x, y + 0.3 * x * x, 0.7 * z])),
        files.add("landmarks.csv", &landmarks),
    ]
}

#[test]
fn a_pair_of_balls_is_mapped_and_certified() {
    let files = Files::new("balls");
    let [source, target, landmarks] = balls(&files);
    let out = files.path("out");
    let map = ["map", &source, &target, "--landmarks", &landmarks, "--out", &out, "--device", "cpu", "--image", "5"];
    let output = homeo(&[&map[..], &["--json"]].concat());
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).expect("the report on stdout");
    assert_eq!(report["certificate"]["bijective"], true, "{report}");
    assert_eq!((&report["landmarks"], &report["layout"]["patches"]), (&8.into(), &12.into()));
    let stretch = report["distortion"]["forward"]["e_l2"].as_f64().expect("a number");
    assert!((1.0..3.0).contains(&stretch), "{stretch}");
    for stage in homeo::pipeline::Stage::ALL.iter().filter(|s| **s != homeo::pipeline::Stage::Relax) {
        assert!(report["seconds"][stage.name()].is_number(), "{}", stage.name());
    }
    let rows = fs::read_to_string(files.path("out/source_on_target.csv")).expect("written");
    assert_eq!(rows.lines().count(), 1 + 98, "a row for every vertex");
    assert_eq!(fs::read_dir(files.path("out/geometry")).expect("written").count(), 6);
}

#[test]
fn output_does_not_depend_on_the_number_of_threads() {
    let files = Files::new("threads");
    let [source, target, landmarks] = balls(&files);
    for threads in ["1", "2", "3"] {
        let out = files.path(threads);
        let output =
            homeo(&["map", &source, &target, "--landmarks", &landmarks, "--out", &out, "--threads", threads, "-q"]);
        assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    }
    let names = ["source_on_target.obj", "target_on_source.csv", "layout.json", "geometry/source_position.exr"];
    for name in names.into_iter().chain(["geometry/stretch.exr", "geometry/target_normal.exr"]) {
        let bytes = |threads: &str| fs::read(files.path(threads).to_owned() + "/" + name).expect("written");
        assert!(bytes("1") == bytes("2") && bytes("2") == bytes("3"), "{name}");
    }
}

/// Killed at any moment, a run leaves either the whole output or nothing that is not hidden.
#[test]
fn a_killed_run_leaves_no_partial_output() {
    let files = Files::new("killed");
    let [source, target, landmarks] = balls(&files);
    let out = files.path("out");
    for milliseconds in (0..200).step_by(10) {
        let _ = fs::remove_dir_all(&out);
        let mut child = program()
            .args(["map", &source, &target, "--landmarks", &landmarks, "--out", &out, "--device", "cpu", "-q"])
            .stderr(Stdio::null())
            .spawn()
            .expect("the program starts");
        std::thread::sleep(std::time::Duration::from_millis(milliseconds));
        child.kill().expect("the child is ours");
        child.wait().expect("the child ends");
        if PathBuf::from(&out).exists() {
            for name in ["report.json", "layout.json", "source_on_target.obj", "geometry/mask.exr"] {
                assert!(PathBuf::from(&out).join(name).exists(), "{name} is missing after {milliseconds} ms");
            }
        }
        let entries = fs::read_dir(&files.0).expect("the folder of this test").flatten();
        let visible = entries.filter(|e| !e.file_name().to_string_lossy().starts_with('.')).count();
        assert!(visible <= 4, "something else than inputs and output after {milliseconds} ms");
    }
}
