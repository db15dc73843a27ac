//! The same input gives the same output: on any number of threads, and on any device that keeps the order of operations.

use homeo::gpu::{Compute, Device, DeviceChoice, REQUIRE_GPU};
use homeo::mesh::VertexId;
use homeo::mesh::io::{MeshFile, write_obj};
use homeo::shape::{Quadruped, Shape, quadruped};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// A generated pair on disk and its reference map: CPU, one thread.
struct Pair {
    dir: PathBuf,
    reference: Output,
}

/// File names and contents; the report without what may differ.
#[derive(PartialEq)]
struct Output {
    files: BTreeMap<String, Vec<u8>>,
    report: Value,
}

fn pair() -> &'static Pair {
    static PAIR: OnceLock<Pair> = OnceLock::new();
    PAIR.get_or_init(|| {
        let dir = std::env::temp_dir().join(format!("homeo-same-{}", std::process::id()));
        fs::create_dir_all(&dir).expect("the temporary folder is writable");
        let (bull, mule) = (quadruped(Quadruped::Bull, 1_500), quadruped(Quadruped::Mule, 1_200));
        write_shape(&dir.join("source.obj"), &bull);
        write_shape(&dir.join("target.obj"), &mule);
        let rows = bull.landmarks.iter().zip(&mule.landmarks).map(|((n, s), (_, t))| format!("{n},{},{}\n", s.0, t.0));
        let csv = ["name,source_vertex,target_vertex\n".to_owned()].into_iter().chain(rows).collect::<String>();
        fs::write(dir.join("landmarks.csv"), csv).expect("the temporary folder is writable");
        let reference = map(&dir, "reference", &["--threads", "1", "--device", "cpu"]);
        Pair { dir, reference }
    })
}

fn write_shape(path: &Path, shape: &Shape) {
    let corners: Vec<VertexId> = shape.mesh.faces().into_iter().flatten().collect();
    let positions = shape.mesh.positions.raw.clone();
    let file = MeshFile { offsets: (0..=corners.len() as u32).step_by(3).collect(), corners, ..MeshFile::default() };
    let mut text = Vec::new();
    write_obj(&mut text, Path::new(""), &MeshFile { positions: positions.clone(), ..file }, &positions)
        .expect("memory takes it");
    fs::write(path, text).expect("the temporary folder is writable");
}

/// Maps the pair with further flags and reads the output; runs in its own folder so that the report names equal files.
fn map(dir: &Path, out: &str, flags: &[&str]) -> Output {
    let job = ["map", "source.obj", "target.obj", "--landmarks", "landmarks.csv", "--image", "17", "--out", out];
    let program = Command::new(env!("CARGO_BIN_EXE_homeo")).current_dir(dir).args(job).args(flags).output();
    let output = program.expect("the program starts");
    assert!(output.status.success(), "{flags:?}: {}", String::from_utf8_lossy(&output.stderr));
    let mut files = BTreeMap::new();
    for folder in [dir.join(out), dir.join(out).join("geometry")] {
        for entry in fs::read_dir(&folder).expect("the map was written").flatten().filter(|e| e.path().is_file()) {
            let name = entry.file_name().to_string_lossy().into_owned();
            files.insert(name, fs::read(entry.path()).expect("a file of the map is readable"));
        }
    }
    // The page holds times and the command; `report_page` compares the rest of it.
    files.remove("report.html").expect("every map has a page");
    let report = files.remove("report.json").expect("every map has a report");
    let mut report: Value = serde_json::from_slice(&report).expect("the report is JSON");
    for varies in ["seconds", "peak_bytes", "device"] {
        report.as_object_mut().expect("the report is an object").remove(varies).expect("the report is complete");
    }
    Output { files, report }
}

fn assert_same(what: &str, a: &Output, b: &Output) {
    let names = |o: &Output| o.files.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(a), names(b), "{what}");
    assert!(a.files.len() >= 11, "{what}: {:?}", names(a));
    for (name, content) in &a.files {
        assert!(*content == b.files[name], "{what}: {name} differs");
    }
    assert_eq!(a.report, b.report, "{what}");
}

#[test]
fn on_any_number_of_threads() {
    let Pair { dir, reference } = pair();
    for threads in ["2", "3"] {
        let other = map(dir, &format!("threads-{threads}"), &["--threads", threads, "--device", "cpu"]);
        assert_same(&format!("{threads} threads"), reference, &other);
    }
}

#[test]
fn on_an_adapter() {
    let Pair { dir, reference } = pair();
    let device = match Device::open(&DeviceChoice::Gpu) {
        Ok(device) => device,
        Err(error) if std::env::var(REQUIRE_GPU).is_ok_and(|v| v == "1") => panic!("{REQUIRE_GPU}=1, but {error}"),
        Err(_) => return, // the kernel tests say loudly that there is no adapter
    };
    let Compute::Gpu(gpu) = &device.compute else { panic!("`gpu` was asked for and the CPU came") };
    let other = map(dir, "adapter", &["--device", "gpu"]);
    if gpu.info().kind.is_software() {
        return assert_same("software adapter", reference, &other);
    }
    // Hardware fuses multiplications with additions: the maps differ in the last digits the kernels see.
    let e_l2 = |o: &Output| o.report["distortion"]["forward"]["e_l2"].as_f64().expect("a number");
    assert!((e_l2(reference) / e_l2(&other) - 1.0).abs() < 1e-2, "{} and {}", e_l2(reference), e_l2(&other));
}

#[test]
fn the_report_tells_the_energies_of_every_phase() {
    let Pair { dir, reference } = pair();
    let full = &reference.report["relaxation"];
    assert_eq!(full["method"], "full");
    for mesh in full["stretch"].as_array().expect("one entry a mesh") {
        assert!(mesh["after"].as_f64() <= mesh["before"].as_f64(), "{mesh}");
    }
    let energies: Vec<f64> = full["energies"].as_array().expect("a list").iter().filter_map(Value::as_f64).collect();
    assert!(energies.len() >= 2 && energies.last() < energies.first(), "{energies:?}");
    let none = map(dir, "none", &["--device", "cpu", "--relax", "none"]).report;
    assert_eq!(none["relaxation"]["method"], "none");
    assert_eq!(none["relaxation"]["energies"].as_array().map(Vec::len), Some(1), "the energy as it is");
    let energy = |report: &Value| report["distortion"]["forward"]["symmetric_dirichlet"].as_f64();
    assert!(energy(&reference.report) < energy(&none), "relaxation lowers the distortion");
}
