//! Promises about what is written: a folder appears complete or not at all, and image points survive the round trip.

use glam::DVec3;
use homeo::map::base_complex::{BaseComplex, DirectedArc};
use homeo::map::certificate::Certificate;
use homeo::map::file_order::Onto;
use homeo::map::product::{GeometryImages, Product, Side};
use homeo::map::report::{LayoutSummary, RelaxationSummary, Report};
use homeo::map::tile_table::TileTable;
use homeo::mesh::io::{Landmarks, MeshFile, read_mesh};
use homeo::mesh::{ArcId, FaceId, HalfedgeId, IdVec, LandmarkId, SurfacePoint, TriMesh, VertexId, corner};
use homeo::stage::write::points_csv::{read_points, write_points};
use homeo::stage::write::{OutputFolder, check_place, write};
use homeo::{Error, ErrorKind};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// A folder of this test alone, removed at the end.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        let dir = std::env::temp_dir().join(format!("homeo-outputs-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(&dir).expect("the temporary folder is writable");
        Scratch(dir)
    }

    fn out(&self) -> PathBuf {
        self.0.join("out")
    }

    /// Names in the folder, sorted.
    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.0).expect("the scratch folder exists");
        let mut names: Vec<_> = entries.flatten().map(|e| e.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn write_output(dir: &Path, text: &str) -> Result<(), Error> {
    let folder = OutputFolder::create(dir)?;
    folder.write("report.json", |out| out.write_all(text.as_bytes()))?;
    folder.write("geometry/mask.exr", |out| out.write_all(b"mask"))?;
    folder.commit()
}

#[test]
fn a_finished_folder_stands_alone() {
    let scratch = Scratch::new("finished");
    write_output(&scratch.out(), "{}").expect("the place is free");
    assert_eq!(scratch.names(), ["out"]);
    assert_eq!(fs::read(scratch.out().join("geometry/mask.exr")).expect("written"), b"mask");
}

#[test]
fn missing_parents_are_made() {
    let scratch = Scratch::new("parents");
    write_output(&scratch.0.join("a/b/c"), "{}").expect("the place is free");
    assert!(scratch.0.join("a/b/c/report.json").is_file());
}

#[test]
fn nothing_appears_before_commit_or_after_a_failure() {
    let scratch = Scratch::new("failure");
    let folder = OutputFolder::create(&scratch.out()).expect("the place is free");
    folder.write("report.json", |out| out.write_all(b"{}")).expect("the disk has room");
    assert!(!scratch.out().exists());
    let full = || std::io::Error::from(std::io::ErrorKind::StorageFull);
    let error = folder.write("source_on_target.obj", |_| Err(full())).expect_err("the disk is full");
    assert_eq!(error.kind, ErrorKind::Input);
    assert!(error.file.ends_with("out/source_on_target.obj"), "{error}");
    drop(folder);
    assert!(scratch.names().is_empty(), "{:?}", scratch.names());
}

#[test]
fn an_earlier_output_is_replaced_as_a_whole() {
    let scratch = Scratch::new("replace");
    write_output(&scratch.out(), "old").expect("the place is free");
    fs::write(scratch.out().join("stray"), "x").expect("writable");
    write_output(&scratch.out(), "new").expect("an earlier output may be replaced");
    assert_eq!(fs::read_to_string(scratch.out().join("report.json")).expect("written"), "new");
    assert!(!scratch.out().join("stray").exists());
    assert_eq!(scratch.names(), ["out"]);
}

#[test]
fn a_failure_leaves_the_earlier_output_alone() {
    let scratch = Scratch::new("keep");
    write_output(&scratch.out(), "old").expect("the place is free");
    drop(OutputFolder::create(&scratch.out()).expect("an earlier output may be replaced"));
    assert_eq!(fs::read_to_string(scratch.out().join("report.json")).expect("still there"), "old");
    assert_eq!(scratch.names(), ["out"]);
}

#[test]
fn foreign_folders_and_files_are_refused() {
    let scratch = Scratch::new("foreign");
    fs::create_dir(scratch.out()).expect("writable");
    check_place(&scratch.out()).expect("an empty folder is free");
    fs::write(scratch.out().join("thesis.tex"), "precious").expect("writable");
    for place in [scratch.out(), scratch.out().join("thesis.tex")] {
        let error = OutputFolder::create(&place).expect_err("not ours");
        assert_eq!(error.kind, ErrorKind::Usage, "{error}");
    }
    assert_eq!(fs::read_to_string(scratch.out().join("thesis.tex")).expect("untouched"), "precious");
}

const CHILD: &str = "HOMEO_TEST_WRITES_INTO";

/// Not a test of its own: the process that the kill tests kill. It writes half a folder, says so, and waits.
#[test]
fn child_that_never_finishes() {
    let Some(dir) = std::env::var_os(CHILD) else { return };
    let folder = OutputFolder::create(Path::new(&dir)).expect("the place is free");
    folder.write("report.json", |out| out.write_all(b"half")).expect("the disk has room");
    fs::write(Path::new(&dir).with_file_name("ready"), "").expect("writable");
    std::thread::sleep(std::time::Duration::from_secs(60));
}

fn spawn_child(dir: &Path) -> Child {
    let me = std::env::current_exe().expect("a test knows its program");
    let mut child = Command::new(me)
        .args(["--exact", "child_that_never_finishes"])
        .env(CHILD, dir)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the test program starts");
    let ready = dir.with_file_name("ready");
    for _ in 0..1000 {
        if ready.exists() {
            fs::remove_file(&ready).expect("just written");
            return child;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    child.kill().expect("the child runs");
    child.wait().expect("the child ends");
    panic!("the child did not get to writing");
}

#[test]
fn a_kill_leaves_nothing_visible_and_the_next_run_cleans_up() {
    let scratch = Scratch::new("kill");
    let mut child = spawn_child(&scratch.out());
    child.kill().expect("the child runs");
    child.wait().expect("the child ends");
    assert!(!scratch.out().exists());
    assert!(scratch.names().iter().all(|n| n.starts_with(".out.tmp-")), "{:?}", scratch.names());
    write_output(&scratch.out(), "whole").expect("the place is free");
    if Path::new("/proc/self").exists() {
        assert_eq!(scratch.names(), ["out"], "leftovers of the dead process are gone");
    }
}

#[test]
fn the_folder_of_a_living_process_is_left_alone() {
    let scratch = Scratch::new("living");
    let mut child = spawn_child(&scratch.out());
    write_output(&scratch.out(), "whole").expect("the place is free");
    assert_eq!(scratch.names().len(), 2, "{:?}", scratch.names());
    child.kill().expect("the child runs");
    child.wait().expect("the child ends");
}

/// Killed between moving the earlier output away and moving the new one in: the next run puts it back first.
#[test]
#[cfg(target_os = "linux")]
fn an_output_moved_away_by_a_dead_process_comes_back() {
    let scratch = Scratch::new("moved");
    write_output(&scratch.out(), "old").expect("the place is free");
    let dead = u32::MAX; // above any process number
    fs::rename(scratch.out(), scratch.0.join(format!(".out.old-{dead}"))).expect("writable");
    drop(OutputFolder::create(&scratch.out()).expect("the place is free"));
    assert_eq!(fs::read_to_string(scratch.out().join("report.json")).expect("back again"), "old");
    assert_eq!(scratch.names(), ["out"]);
}

/// Image points.
type Points = IdVec<VertexId, Option<SurfacePoint>>;

fn tetrahedron() -> TriMesh {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(|t| t.map(VertexId));
    TriMesh::new(positions, &faces).expect("a tetrahedron is a manifold")
}

fn round_trip(points: &Points) -> (String, Points) {
    let mesh = tetrahedron();
    let mut bytes = Vec::new();
    let onto = Onto { mesh: &mesh, triangles: &mesh.faces(), omitted: &[] };
    write_points(&mut bytes, points, onto).expect("memory has room");
    let text = String::from_utf8(bytes).expect("CSV is text");
    (text.clone(), read(&text, points.len()).expect("our own file reads back"))
}

fn read(text: &str, vertices: usize) -> Result<Points, Error> {
    let thread = std::thread::current();
    let test = thread.name().unwrap_or("test").replace(':', "-");
    let path = std::env::temp_dir().join(format!("homeo-points-{test}-{}.csv", std::process::id()));
    fs::File::create(&path).and_then(|mut f| f.write_all(text.as_bytes())).expect("writable");
    let mesh = tetrahedron();
    let points = read_points(&path, vertices, Onto { mesh: &mesh, triangles: &mesh.faces(), omitted: &[] });
    fs::remove_file(&path).expect("just written");
    points
}

#[test]
fn image_points_survive_the_round_trip_bit_by_bit() {
    let third = 1.0 / 3.0;
    let faces = [[third, third, 1.0 - 2.0 * third], [0.1, 0.2, 0.7], [1e-300, 0.5, 0.5], [0.25, 5e-17, 0.75]];
    let points: Points = faces.iter().zip(0..).map(|(&b, f)| Some(SurfacePoint::Face(FaceId(f), b))).collect();
    let (text, back) = round_trip(&points);
    assert_eq!(back, points, "{text}");
}

#[test]
fn vertices_and_edges_come_back_as_the_same_places() {
    let mesh = tetrahedron();
    let points: Points =
        [Some(SurfacePoint::Vertex(VertexId(2))), None, Some(SurfacePoint::Edge(HalfedgeId(4), 0.375))]
            .into_iter()
            .collect();
    let (text, back) = round_trip(&points);
    assert_eq!(back[VertexId(0)], points[VertexId(0)], "{text}");
    assert_eq!(back[VertexId(1)], None, "{text}");
    assert!(matches!(back[VertexId(2)], Some(SurfacePoint::Edge(..))), "{text}");
    let place = |points: &Points| points[VertexId(2)].map(|p| p.position(&mesh));
    assert_eq!(place(&back), place(&points), "{text}");
}

#[test]
fn broken_image_points_are_refused_by_line() {
    for (rows, line) in [
        ("vertex,face\n", "line 1"),
        ("vertex,face,b0,b1,b2\n0,4,1,0,0\n", "line 2"),
        ("vertex,face,b0,b1,b2\n0,0,1,0,0\n4,0,1,0,0\n", "line 3"),
        ("vertex,face,b0,b1,b2\n0,0,1,0,0\n0,0,1,0,0\n", "line 3"),
        ("vertex,face,b0,b1,b2\n0,0,0.5,0.4,0\n", "line 2"),
        ("vertex,face,b0,b1,b2\n0,0,NaN,0,1\n", "line 2"),
        ("vertex,face,b0,b1,b2\n0,0,1,0\n", "line 2"),
    ] {
        let error = read(rows, 4).expect_err(rows);
        assert_eq!((error.kind, error.element.as_str()), (ErrorKind::Input, line), "{error}");
    }
}

/// The identity of a tetrahedron with all four vertices as landmarks: arcs are its edges, patches its faces.
struct Identity {
    file: MeshFile,
    mesh: TriMesh,
    base: BaseComplex,
    arcs: IdVec<ArcId, Vec<SurfacePoint>>,
    image: Points,
    landmarks: Landmarks,
}

impl Identity {
    fn new() -> Self {
        let mesh = tetrahedron();
        let corners: Vec<VertexId> = mesh.faces().into_iter().flatten().collect();
        let edges: Vec<HalfedgeId> = mesh.conn.halfedges().filter(|&h| mesh.conn.is_edge_representative(h)).collect();
        let side = |h: HalfedgeId| {
            let edge = mesh.conn.edge_representative(h);
            let arc = edges.iter().position(|&e| e == edge).expect("every half-edge has an edge");
            DirectedArc { arc: ArcId(arc as u32), reversed: edge != h }
        };
        let ends = |&h: &HalfedgeId| [mesh.conn.from(h), mesh.conn.to(h)];
        let vertices: Vec<VertexId> = mesh.conn.vertices().collect();
        Identity {
            file: MeshFile {
                path: "tetrahedron.obj".into(),
                positions: mesh.positions.raw.clone(),
                offsets: vec![0, 3, 6, 9, 12],
                corners,
                ..MeshFile::default()
            },
            base: BaseComplex {
                landmarks: 4,
                arcs: edges.iter().map(|h| ends(h).map(|v| LandmarkId(v.0))).collect(),
                patches: mesh.conn.faces().map(|f| [0, 1, 2].map(|i| side(corner(f, i)))).collect(),
            },
            arcs: edges.iter().map(|h| ends(h).map(SurfacePoint::Vertex).to_vec()).collect(),
            image: vertices.iter().map(|&v| Some(SurfacePoint::Vertex(v))).collect(),
            landmarks: Landmarks {
                path: PathBuf::from("landmarks.csv"),
                names: ["a", "b", "c", "d"].map(String::from).to_vec(),
                source: vertices.clone(),
                target: vertices,
                notes: Vec::new(),
            },
            mesh,
        }
    }

    fn write(&self, dir: &Path) -> Report {
        let side = Side {
            file: &self.file,
            mesh: &self.mesh,
            omitted: &[],
            arcs: &self.arcs,
            image: &self.image,
            refined: None,
        };
        let table = TileTable { tile_size: 5, columns: 1, rows: 1, tiles: Vec::new() };
        let images = GeometryImages { table, files: vec![("mask.exr".to_owned(), b"mask".to_vec())] };
        let product = Product {
            source: side,
            target: side,
            landmarks: &self.landmarks,
            base: &self.base,
            layout: LayoutSummary { kind: "voronoi", arcs: 6, patches: 4, postponed: 0, flips: 0 },
            relaxation: RelaxationSummary {
                method: "none",
                stretch: Default::default(),
                energies: Vec::new(),
                polish: Vec::new(),
            },
            certificate: Certificate {
                bijective: true,
                same_complex: true,
                patches_are_discs: true,
                positive: true,
                min_orientation: 1.0,
            },
            files: &[("map.bin".to_owned(), b"map".to_vec())],
            images: Some(&images),
            device: "CPU",
            warnings: Vec::new(),
            shown: None,
        };
        write(&product, dir, || [("total", 0.5)].into()).expect("the place is free")
    }
}

#[test]
fn a_map_is_written_with_all_its_files() {
    let scratch = Scratch::new("product");
    let identity = Identity::new();
    identity.write(&scratch.out());
    let names = ["source_on_target.obj", "target_on_source.obj", "source_on_target.csv", "target_on_source.csv"];
    for name in names.into_iter().chain(["geometry/mask.exr", "layout.json", "report.json"]) {
        assert!(scratch.out().join(name).is_file(), "{name}");
    }
    let back = read_points(
        &scratch.out().join("source_on_target.csv"),
        identity.mesh.positions.len(),
        Onto { mesh: &identity.mesh, triangles: &identity.mesh.faces(), omitted: &[] },
    )
    .expect("our own file");
    assert_eq!(back, identity.image);
    let mesh = read_mesh(&scratch.out().join("source_on_target.obj")).expect("our own file");
    assert_eq!((mesh.positions, mesh.corners), (identity.file.positions, identity.file.corners));
}

#[test]
fn the_report_holds_what_the_contract_names() {
    let scratch = Scratch::new("report");
    let report = Identity::new().write(&scratch.out());
    assert_eq!(report.distortion.forward.symmetric_dirichlet, 1.0);
    let text = fs::read_to_string(scratch.out().join("report.json")).expect("written");
    let json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    for pointer in [
        "/version",
        "/device",
        "/source/file",
        "/target/boundary_loops",
        "/landmarks",
        "/layout/kind",
        "/layout/postponed",
        "/certificate/min_orientation",
        "/distortion/forward/e_l2",
        "/distortion/backward/flips",
        "/seconds/total",
        "/peak_bytes",
        "/warnings",
    ] {
        assert!(json.pointer(pointer).is_some(), "{pointer} is missing in {text}");
    }
    assert_eq!(
        json["source"],
        serde_json::json!({
            "file": "tetrahedron.obj", "vertices": 4, "faces": 4, "genus": 0, "boundary_loops": 0
        })
    );
}

#[test]
fn the_layout_file_lets_the_patches_be_walked() {
    let scratch = Scratch::new("layout");
    Identity::new().write(&scratch.out());
    let text = fs::read_to_string(scratch.out().join("layout.json")).expect("written");
    let json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let end = |side: &serde_json::Value, last: bool| {
        let reversed = side["reversed"].as_bool().expect("a flag");
        let arc = side["arc"].as_u64().expect("a number") as usize;
        json["arcs"][arc][usize::from(last != reversed)].as_u64().expect("a landmark")
    };
    for patch in json["patches"].as_array().expect("a list") {
        for k in 0..3 {
            assert_eq!(end(&patch[k], true), end(&patch[(k + 1) % 3], false), "{patch}");
        }
    }
    assert_eq!(json["source"][0]["points"][0]["vertex"], json["arcs"][0][0]);
    assert_eq!(json["landmarks"][2]["name"], "c");
}
