//! `report.html` and `preview.png`: complete, self-contained, safe, the same on every run, of bounded size.

mod common;

use common::ball::BallMap;
use homeo::picture::read_picture;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A folder of this test alone, left below the build folder for people to look at.
fn place(name: &str) -> PathBuf {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report").join(name);
    let _ = fs::remove_dir_all(&dir);
    fs::create_dir_all(&dir).expect("the build folder can be written");
    dir.join("map")
}

fn page(dir: &Path) -> String {
    fs::read_to_string(dir.join("report.html")).expect("a page")
}

/// The scene as the page's script reads it.
fn scene(page: &str) -> Value {
    let (_, rest) = page.split_once("id=\"scene\">").expect("the page holds its scene");
    let (text, _) = rest.split_once("</script>").expect("an element that ends");
    serde_json::from_str(text).expect("the scene is JSON")
}

/// The page without what may differ between runs: times, memory, the command.
fn lasting(page: &str) -> String {
    let without = |text: String, title: &str| match text.split_once(&format!("<h2>{title}</h2>")) {
        Some((before, after)) => {
            let (_, rest) = after.split_once("</section>").expect("a section that ends");
            format!("{before}{rest}")
        }
        None => text,
    };
    let text = without(without(page.to_owned(), "Time"), "Made by");
    let Some((before, after)) = text.split_once("<dt>Memory</dt>") else { return text };
    let (_, rest) = after.split_once("</dd>").expect("an entry that ends");
    format!("{before}{rest}")
}

#[test]
fn the_page_holds_the_result_and_names_no_address() {
    let dir = place("whole");
    BallMap::new(4).write(&dir, 1.25, "homeo map ball.obj pulled.obj");
    let page = page(&dir);
    for text in
        ["Certified bijective", "a warning of this test", "homeo map ball.obj", "1.25 s", "same 6 arcs", "8 patches"]
    {
        assert!(page.contains(text), "{text}");
    }
    for address in ["http:", "https:", "src=\"//", "href=", "@import", "{{"] {
        assert!(!page.contains(address), "{address}");
    }
    let scene = scene(&page);
    assert_eq!(scene["surfaces"][0]["triangles"], 5120);
    assert_eq!(scene["surfaces"][1]["spaces"], serde_json::json!(["source", "target"]));
    assert_eq!(scene["marks"][3]["name"], "tail");
    assert_eq!(scene["panels"].as_array().map(Vec::len), Some(3));
    assert!(scene["surfaces"][0]["stands_for"].is_null());
}

#[test]
fn the_same_map_gives_the_same_bytes_on_any_number_of_threads() {
    let ball = BallMap::new(3);
    let written = |threads: usize, seconds: f64| {
        let dir = place(&format!("threads-{threads}"));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| ball.write(&dir, seconds, &format!("homeo --threads {threads}")));
        (lasting(&page(&dir)), fs::read(dir.join("preview.png")).expect("a preview"))
    };
    let (one, three) = (written(1, 1.0), written(3, 2.0));
    assert!(one.0 == three.0, "the page differs");
    assert!(one.1 == three.1, "the preview differs");
}

/// This page is also what the browser test times; see `tests/browser`.
#[test]
fn two_meshes_of_20_000_triangles_stay_below_three_megabytes() {
    let dir = place("large");
    BallMap::new(5).write(&dir, 1.0, "homeo map");
    let page = page(&dir);
    assert_eq!(scene(&page)["surfaces"][0]["triangles"], 20480);
    assert!(page.len() < 3_000_000, "{} bytes", page.len());
}

#[test]
fn hostile_names_stay_text() {
    let name = "</script><img src=x onerror=alert(1)>\"'&";
    let mut ball = BallMap::new(2);
    ball.landmarks.names[0] = name.to_owned();
    ball.files[0].path = PathBuf::from("</title><img src=y>.obj");
    let dir = place("hostile");
    ball.write(&dir, 1.0, "homeo map '</pre><img src=z>'");
    let page = page(&dir);
    assert!(!page.contains("<img"), "no element comes from a name");
    assert_eq!(scene(&page)["marks"][0]["name"], name);
}

#[test]
fn a_stand_in_is_shown_for_meshes_that_are_too_large_and_the_page_says_so() {
    let dir = place("huge");
    let ball = BallMap::new(7);
    ball.write(&dir, 1.0, "homeo map");
    let page = page(&dir);
    let scene = scene(&page);
    let triangles = |k: usize| scene["surfaces"][k]["triangles"].as_u64().expect("a number");
    assert!(triangles(0) + triangles(1) <= 300_000 && triangles(0) > 50_000, "{} triangles", triangles(0));
    assert_eq!(scene["surfaces"][0]["stands_for"], serde_json::json!([163_842, 327_680]));
    assert!(page.contains("simpler stand-ins are shown"));
    assert!(page.len() < 24_000_000, "{} bytes", page.len());
}

/// The picture lies in `golden/`; after a wanted change look at the new one, below the build folder, and put it in its place.
#[test]
fn the_golden_preview_is_drawn_pixel_for_pixel() {
    let dir = place("golden");
    BallMap::new(3).write(&dir, 1.0, "");
    let drawn = dir.join("preview.png");
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/map_preview.png");
    let read = |path: &Path| read_picture(path, true).expect("both are pictures");
    assert!(read(&drawn) == read(&golden), "{} is not the golden picture", drawn.display());
}

/// The whole program: a page and a preview by default, neither with `--no-report`.
#[test]
fn map_writes_a_page_unless_told_not_to() {
    let dir = place("program");
    let at = |name: &str| dir.with_file_name(name);
    let (source, target) = (homeo::shape::DEMO_PAIRS[1].generate)(600);
    let mut rows = "name,source_vertex,target_vertex\n".to_owned();
    for ((name, s), (_, t)) in source.landmarks.iter().zip(&target.landmarks) {
        rows += &format!("{name},{},{}\n", s.0, t.0);
    }
    fs::write(at("landmarks.csv"), rows).expect("the build folder can be written");
    for (name, shape) in [("source.obj", &source), ("target.obj", &target)] {
        let mut bytes = Vec::new();
        let file = homeo::mesh::io::MeshFile::of(&shape.mesh);
        homeo::mesh::io::write_obj(&mut bytes, Path::new(""), &file, &file.positions).expect("memory takes all");
        fs::write(at(name), bytes).expect("the build folder can be written");
    }
    let run = |more: &[&str]| {
        let mut program = Command::new(env!("CARGO_BIN_EXE_homeo"));
        program.arg("map").args([at("source.obj"), at("target.obj")]).arg("--landmarks").arg(at("landmarks.csv"));
        let done = program.arg("--out").arg(&dir).args(["--device", "cpu", "-q"]).args(more).output();
        assert!(done.expect("the program starts").status.success());
    };
    run(&["--no-report"]);
    assert!(!dir.join("report.html").exists() && !dir.join("preview.png").exists());
    let mut pages = ["1", "2"].map(|threads| {
        run(&["--threads", threads]);
        page(&dir)
    });
    assert!(pages[0].contains("homeo map ") && pages[0].contains("--threads 1"));
    assert_eq!(pages[0].matches("<figure><img src=\"data:image/png;base64,").count(), 4, "geometry images");
    assert!(scene(&pages[0])["patch_colors"].as_array().is_some_and(|colors| !colors.is_empty()));
    pages = pages.map(|page| lasting(&page));
    assert!(pages[0] == pages[1], "the page depends on the number of threads");
}
