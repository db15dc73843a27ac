//! Pages in a real browser, offline: `tests/browser/check.mjs` opens what this test makes.
//!
//! Where no browser is installed the test is skipped, which it says; with `HOMEO_REQUIRE_BROWSER=1` that is a failure.
//! `scripts/test.sh` installs one.

mod common;

use common::ball::BallMap;
use homeo::mesh::io::{MeshFile, write_obj};
use homeo::shape::{DEMO_PAIRS, Shape, fixture};
use homeo::view::{BatchRow, BatchStatus, batch_page};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What `run.sh` exits with where there is no browser.
const SKIPPED: i32 = 77;

/// Everything goes below the build folder, and stays there for people to look at.
struct Place(PathBuf);

impl Place {
    fn at(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn text(&self, name: &str, text: &str) {
        fs::write(self.at(name), text).expect("the build folder can be written");
    }

    fn mesh(&self, name: &str, file: &MeshFile) {
        let mut bytes = Vec::new();
        write_obj(&mut bytes, Path::new(""), file, &file.positions).expect("memory takes all");
        fs::write(self.at(name), bytes).expect("the build folder can be written");
    }

    fn homeo(&self, arguments: &[&str]) {
        let mut program = Command::new(env!("CARGO_BIN_EXE_homeo"));
        let done = program.current_dir(&self.0).args(arguments).args(["--device", "cpu", "-q"]).output();
        let done = done.expect("the program starts");
        assert!(done.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&done.stderr));
    }
}

fn rows(source: &Shape, target: &Shape) -> String {
    let pairs = source.landmarks.iter().zip(&target.landmarks);
    let rows = pairs.map(|((name, s), (_, t))| format!("{name},{},{}\n", s.0, t.0));
    "name,source_vertex,target_vertex\n".to_owned() + &rows.collect::<String>()
}

/// A mug on a doughnut, a textured disc, a parametrized ball, a large pair, a batch.
fn make_pages(place: &Place) {
    let (source, target) = (DEMO_PAIRS[1].generate)(900);
    place.text("landmarks.csv", &rows(&source, &target));
    place.mesh("mug.obj", &MeshFile::of(&source.mesh));
    place.mesh("doughnut.obj", &MeshFile::of(&target.mesh));
    place.homeo(&["map", "mug.obj", "doughnut.obj", "--landmarks", "landmarks.csv", "--out", "map"]);

    let image = image::RgbImage::from_fn(64, 64, |x, y| image::Rgb([x as u8 * 4, y as u8 * 4, 128]));
    image.save(place.at("image.png")).expect("the build folder can be written");
    place.mesh("disc.obj", &MeshFile::of(&fixture::disc(12)));
    place.text("constraints.csv", "name,vertex,u,v\neye,3,0.3,0.6\nchin,40,0.55,0.35\n");
    place.homeo(&["texture", "disc.obj", "image.png", "--constraints", "constraints.csv", "--out", "texture"]);

    place.mesh("ball.obj", &MeshFile::of(&fixture::icosphere(3)));
    place.homeo(&["diffuse", "ball.obj", "--segment", "8", "--repair", "--out", "diffuse"]);

    BallMap::new(5).write(&place.at("large"), 1.0, "homeo map");
    let row = |i: usize| BatchRow {
        id: if i == 0 { "map".to_owned() } else { format!("pair {i}") },
        status: if i % 7 == 3 { BatchStatus::Failed } else { BatchStatus::Ok },
        error: (i % 7 == 3).then(|| "source.obj: not a manifold (edge 3 9)".to_owned()),
        seconds: i as f64 * 0.5,
        e_l2: (i % 7 != 3).then_some(1.0 + i as f64 / 100.0),
        symmetric_dirichlet: (i % 7 != 3).then_some(1.1),
        flips: (i % 7 != 3).then_some(i % 3),
        has_report: i == 0,
        has_preview: i == 0,
    };
    place.text("batch.html", &batch_page("A batch", &(0..300).map(row).collect::<Vec<_>>()));
}

#[test]
fn pages_work_offline_in_a_browser() {
    let place = Place(Path::new(env!("CARGO_TARGET_TMPDIR")).join("browser"));
    let _ = fs::remove_dir_all(&place.0);
    fs::create_dir_all(&place.0).expect("the build folder can be written");
    make_pages(&place);
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/browser/run.sh");
    let done = Command::new("bash").arg(script).arg(&place.0).output().expect("there is a shell");
    let told = [done.stdout, done.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    println!("{told}");
    match done.status.code() {
        Some(0) => {}
        Some(SKIPPED) => eprintln!("SKIPPED: pages in a browser. {told}"),
        code => panic!("the pages fail in the browser ({code:?}):\n{told}"),
    }
}
