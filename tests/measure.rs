//! `homeo measure` against maps whose distortion is known in closed form.

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const N: usize = 13;

/// An N x N grid over the unit square, moved by `map`, as OBJ text.
fn grid(map: impl Fn(f64, f64) -> [f64; 3]) -> String {
    let mut obj = String::new();
    for k in 0..N * N {
        let [x, y, z] = map((k % N) as f64 / (N - 1) as f64, (k / N) as f64 / (N - 1) as f64);
        obj += &format!("v {x:?} {y:?} {z:?}\n");
    }
    for (i, j) in (0..(N - 1) * (N - 1)).map(|k| (k % (N - 1), k / (N - 1))) {
        let a = 1 + i + j * N;
        obj += &format!("f {a} {} {}\nf {a} {} {}\n", a + 1, a + N + 1, a + N + 1, a + N);
    }
    obj
}

fn write(name: &str, content: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("homeo-measure-{}-{name}", std::process::id()));
    fs::write(&path, content).expect("the temporary folder is writable");
    path
}

fn run(source: &Path, compatible: &Path) -> (Option<i32>, String, String) {
    let program = Command::new(env!("CARGO_BIN_EXE_homeo")).arg("measure").args([source, compatible]).output();
    let output = program.expect("the program starts");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

/// Measures the grid against its image under `map`.
fn measure(name: &str, map: impl Fn(f64, f64) -> [f64; 3]) -> Value {
    let source = write(&format!("{name}-source.obj"), &grid(|x, y| [x, y, 0.0]));
    let compatible = write(&format!("{name}-image.obj"), &grid(map));
    let (code, stdout, stderr) = run(&source, &compatible);
    for path in [source, compatible] {
        fs::remove_file(path).expect("just written");
    }
    assert_eq!(code, Some(0), "{stderr}");
    serde_json::from_str(&stdout).expect("JSON on stdout")
}

fn expect(json: &Value, pointer: &str, expected: f64) {
    let value = json.pointer(pointer).and_then(Value::as_f64).unwrap_or(f64::NAN);
    assert!((value - expected).abs() <= 1e-9 * expected.abs().max(1.0), "{pointer}: {value} instead of {expected}");
}

#[test]
fn a_similarity_has_no_distortion() {
    let json = measure("similarity", |x, y| [3.0 - 2.5 * y, 2.5 * x, 7.0]);
    for way in ["forward", "backward"] {
        expect(&json, &format!("/{way}/e_l2"), 1.0);
        expect(&json, &format!("/{way}/symmetric_dirichlet"), 1.0);
        expect(&json, &format!("/{way}/e_ang"), 0.0);
        expect(&json, &format!("/{way}/flips"), 0.0);
    }
    expect(&json, "/vertices", (N * N) as f64);
    expect(&json, "/faces", (2 * (N - 1) * (N - 1)) as f64);
}

/// x' = s x, y' = y / s: angles of the right triangles change by known amounts.
#[test]
fn a_squeeze_is_measured_in_closed_form() {
    let s = 1.5;
    let json = measure("squeeze", |x, y| [s * x, y / s, 0.0]);
    let stretch = f64::midpoint(s * s, 1.0 / (s * s));
    for way in ["forward", "backward"] {
        expect(&json, &format!("/{way}/e_l2"), stretch.sqrt());
        expect(&json, &format!("/{way}/symmetric_dirichlet"), stretch);
        let turned = (s * s).atan() - std::f64::consts::FRAC_PI_4;
        expect(&json, &format!("/{way}/e_ang"), 2.0 * turned / 3.0);
    }
}

#[test]
fn a_vertex_pushed_over_its_neighbours_is_found() {
    let middle = 0.5;
    let json = measure("pushed", |x, y| {
        let is_middle = (x - middle).abs() < 1e-9 && (y - middle).abs() < 1e-9;
        [if is_middle { x + 1.5 / (N - 1) as f64 } else { x }, y, 0.0]
    });
    let flips = json["forward"]["flips"].as_u64().expect("a number");
    assert!((1..=3).contains(&flips), "{flips}");
}

#[test]
fn meshes_that_do_not_correspond_are_refused() {
    let flat = |x, y| [x, y, 0.0];
    let source = write("refused-source.obj", &grid(flat));
    let other = write("refused-other.obj", &grid(flat).replace("f 1 2 15\n", "f 2 15 1\n"));
    let fewer = write("refused-fewer.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    for (compatible, word) in [(&other, "face 0"), (&fewer, "3 vertices")] {
        let (code, _, stderr) = run(&source, compatible);
        assert_eq!(code, Some(3), "{stderr}");
        assert!(stderr.contains(word), "{stderr}");
    }
    for path in [source, other, fewer] {
        fs::remove_file(path).expect("just written");
    }
}
