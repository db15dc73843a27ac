//! `bake --rebuild` on files: sound ones flat and layered, damaged and lying ones, and the command line around them.

mod base_complexes;

use base_complexes::{OCTAHEDRON, atlas_of, complex, from_triangles, mesh_of, octahedron_corners};
use glam::DVec3;
use homeo::app::rebuild::{Layer, PositionImage, Rebuilt, rebuild};
use homeo::gpu::{Device, DeviceChoice};
use homeo::map::atlas::BaseSample;
use homeo::map::base_complex::BaseComplex;
use homeo::map::tile_table::TileTable;
use homeo::mesh::io::{MeshFile, read_mesh, write_obj};
use homeo::mesh::{Id, TriMesh, VertexId};
use homeo::pipeline::{MapJob, MapOptions, Silent, run_maps};
use homeo::shape::SplitMix;
use homeo::shape::fixture::{ellipsoid, icosphere};
use homeo::stage::bake::{BakedImage, Metadata, encode_layered};
use homeo::stage::exr::{FloatImage, Plane, encode, read};
use homeo::{Error, ErrorKind, Result};
use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const TILE: usize = 5;

fn octahedron() -> BaseComplex {
    from_triangles(6, &OCTAHEDRON)
}

/// Positions on the octahedron, `scale` times as large; every pixel lies inside the mask.
fn positions(scale: f64) -> FloatImage {
    let base = octahedron();
    let (atlas, corners) = (atlas_of(&base, TILE), octahedron_corners());
    let pixels: Vec<[f32; 3]> = atlas.samples(&base).map(|(_, sample)| match sample {
        BaseSample::Landmark(l) => corners[l.index()],
        BaseSample::OnArc(a, s) => {
            let [p, q] = base.arcs[a].map(|l| corners[l.index()]);
            p.lerp(q, s)
        }
        BaseSample::InPatch(p, b) => base.corners(p).iter().zip(b).map(|(l, w)| corners[l.index()] * w).sum::<DVec3>(),
    } * scale).map(|p| p.as_vec3().into()).collect();
    FloatImage::rgb(atlas.width(), atlas.height(), &pixels)
}

fn table() -> TileTable {
    let base = octahedron();
    TileTable::new(&atlas_of(&base, TILE), &base)
}

fn baked(name: &'static str, image: FloatImage) -> BakedImage {
    BakedImage { name, unit: "length unit of the mesh file", image }
}

fn flat() -> Vec<u8> {
    baked("source_position", positions(1.0)).encode(&table()).expect("a sound image")
}

fn layered() -> Vec<u8> {
    let images = [baked("source_position", positions(1.0)), baked("target_position", positions(3.0))];
    encode_layered(&images, &table()).expect("sound images")
}

fn rebuilt(bytes: &[u8], layer: Option<Layer>) -> Result<Rebuilt> {
    rebuild(&PositionImage::parse(Cursor::new(bytes), layer)?)
}

fn refused(bytes: &[u8]) -> Error {
    let error = rebuilt(bytes, None).expect_err("damaged");
    assert_eq!(error.kind, ErrorKind::Input, "{error}");
    error
}

#[test]
fn flat_and_layered_files_hold_the_same_mesh() {
    let volume = |bytes: &[u8], layer| rebuilt(bytes, layer).expect("a sound file").mesh.volume();
    let unit = 4.0 / 3.0;
    assert!((volume(&flat(), None) - unit).abs() < 1e-6);
    assert!((volume(&layered(), None) - unit).abs() < 1e-6);
    assert!((volume(&layered(), Some(Layer::Source)) - unit).abs() < 1e-6);
    assert!((volume(&layered(), Some(Layer::Target)) - 27.0 * unit).abs() < 1e-4);
    assert_eq!(rebuilt(&flat(), Some(Layer::Target)).expect_err("no layers").kind, ErrorKind::Usage);
}

#[test]
fn truncated_files_are_refused() {
    for bytes in [flat(), layered()] {
        for length in (0..bytes.len()).step_by(31).chain([bytes.len() - 1]) {
            refused(&bytes[..length]);
        }
    }
}

/// Any answer will do, as long as it is one; a file that still reads is still a surface.
#[test]
fn changed_bytes_never_panic_seed_11() {
    let mut random = SplitMix::new(11);
    let sound = flat();
    let mut read = 0;
    for _ in 0..3000 {
        let mut bytes = sound.clone();
        for _ in 0..=random.below(3) {
            let at = random.below(bytes.len());
            bytes[at] = random.next_bits() as u8;
        }
        read += usize::from(rebuilt(&bytes, None).is_ok());
    }
    assert!(read < 3000);
}

/// A header that claims 2^48 pixels must not lead to an allocation of that size.
#[test]
fn a_claim_of_many_pixels_is_refused() {
    let mut bytes = flat();
    for window in [&b"dataWindow\0box2i\0"[..], b"displayWindow\0box2i\0"] {
        let at = bytes.windows(window.len()).position(|part| part == window).expect("a header has it");
        let corner = at + window.len() + 4 + 8;
        bytes[corner..corner + 8].copy_from_slice(&[0xff, 0xff, 0xff, 0, 0xff, 0xff, 0xff, 0]);
    }
    assert!(refused(&bytes).what.contains("more pixels than the file can hold"));
}

#[test]
fn images_without_positions_are_refused() {
    let with_name = |name| baked(name, positions(1.0)).encode(&table()).expect("a sound image");
    for name in ["mask", "stretch", "source_normal", "", "position"] {
        assert!(refused(&with_name(name)).what.contains("no positions"), "{name}");
    }
    let grey = FloatImage::grey(2 * TILE, 2 * TILE, vec![0.0; 4 * TILE * TILE]);
    let error = refused(&baked("source_position", grey).encode(&table()).expect("an image"));
    assert_eq!(error.element, "channel R", "{error}");
    let only_target = encode_layered(&[baked("target_position", positions(1.0))], &table()).expect("an image");
    assert_eq!(refused(&only_target).element, "channel source.position.X");
    assert!(rebuilt(&only_target, Some(Layer::Target)).is_ok());
    for text in ["{}", "[]", "no JSON", ""] {
        assert!(refused(&encode(&positions(1.0), text).expect("an image")).what.contains("no tile table"), "{text}");
    }
    let (image, json) = read(Cursor::new(flat())).expect("our own file");
    let newer = json.replacen("\"version\":1", "\"version\":99", 1);
    assert!(refused(&encode(&image, &newer).expect("an image")).what.contains("version 99"));
}

#[test]
fn damaged_pixels_are_refused_by_place() {
    for (value, word) in [(f32::NAN, "finite"), (f32::INFINITY, "finite"), (7.0, "differs")] {
        let mut image = positions(1.0);
        image.planes[1].values[2] = value; // the top border of the first tile
        let error = refused(&baked("source_position", image).encode(&table()).expect("an image"));
        assert!(error.what.contains(word) && error.element.contains("column"), "{error}");
    }
    let mut image = positions(1.0);
    image.planes[0].values[2 * TILE + 1] = f32::NAN; // inside a patch, where no other pixel tells
    let base = octahedron();
    assert!(mesh_of(&image, &atlas_of(&base, TILE), &base).expect_err("not a number").what.contains("finite"));
    assert!(refused(&baked("source_position", image).encode(&table()).expect("an image")).element.contains("row 1"));
}

#[test]
fn other_sizes_than_the_tables_are_refused() {
    let whole = positions(1.0);
    let crop = |plane: &Plane| Plane {
        name: plane.name.clone(),
        values: plane.values.chunks(whole.width).flat_map(|row| row[..whole.width - 1].to_vec()).collect(),
    };
    let cropped = FloatImage { width: whole.width - 1, planes: whole.planes.iter().map(crop).collect(), ..whole };
    let error = refused(&baked("source_position", cropped).encode(&table()).expect("an image"));
    assert!(error.what.contains("9 x 10 pixels, but the tile table has 10 x 10"), "{error}");
    let larger = TileTable { tile_size: (1 << 19) + 1, columns: 1, rows: 4, ..table() };
    assert!(
        refused(&baked("source_position", positions(1.0)).encode(&larger).expect("an image")).what.contains("pixels")
    );
}

/// Two pillows that share a landmark fit along every arc, and are no surface where they touch.
#[test]
fn tables_that_fit_but_describe_no_surface_are_refused() {
    let arcs = [[0, 1], [1, 2], [2, 0], [0, 3], [3, 4], [4, 0]];
    let base = complex(5, &arcs, &[[1, 2, 3], [-3, -2, -1], [4, 5, 6], [-6, -5, -4]]);
    let atlas = atlas_of(&base, TILE);
    let black = FloatImage::rgb(atlas.width(), atlas.height(), &vec![[0.0; 3]; atlas.width() * atlas.height()]);
    let bytes = baked("source_position", black).encode(&TileTable::new(&atlas, &base)).expect("an image");
    assert!(refused(&bytes).what.contains("form no surface"));
    let empty = TileTable { tile_size: TILE, columns: 2, rows: 2, tiles: Vec::new() };
    refused(&baked("source_position", positions(1.0)).encode(&empty).expect("an image"));
}

/// Landmarks in an order of the user's own: what is written speaks of them by their place in the file.
#[test]
fn a_finished_maps_images_name_its_landmarks_and_rebuild() {
    let scratch = Scratch::new("map");
    let meshes = [icosphere(1), ellipsoid(DVec3::new(2.0, 1.0, 0.7), 2)];
    let marks = [8, 0, 3, 10, 5, 2]; // vertices of the icosahedron keep their numbers
    let rows: String = marks.iter().map(|v| format!("mark {v},{v},{v}\n")).collect();
    let [source, target] = [(0, "source.obj"), (1, "target.obj")].map(|(k, name)| {
        let mut text = Vec::new();
        let file = MeshFile::of(&meshes[k]);
        write_obj(&mut text, &scratch.0, &file, &file.positions).expect("memory takes it");
        PathBuf::from(scratch.add(name, &text))
    });
    let landmarks = scratch.add("l.csv", format!("name,source_vertex,target_vertex\n{rows}").as_bytes()).into();
    let job = MapJob {
        source,
        target,
        landmarks,
        target_landmarks: None,
        hint: None,
        texture: None,
        out: scratch.0.join("out"),
    };
    let options = MapOptions { image: TILE, ..MapOptions::default() };
    let device = Device::open(&DeviceChoice::Cpu).expect("the CPU is always there");
    run_maps(vec![job], &options, &device, &Silent, |outcome| assert!(outcome.value.is_ok()));

    let layout: serde_json::Value =
        serde_json::from_slice(&fs::read(scratch.path("out/layout.json")).expect("written")).expect("our own file");
    let table: TileTable = serde_json::from_value(layout["atlas"].clone()).expect("a tile table");
    let (atlas, base) = table.parts().expect("a sound table");
    for (arc, ends) in base.arcs.iter_ids() {
        assert_eq!(layout["arcs"][arc.index()], serde_json::json!(ends.map(|l| l.0)), "{arc}");
    }
    for (k, name) in [(0, "source_position"), (1, "target_position")] {
        let bytes = fs::read(scratch.path(&format!("out/geometry/{name}.exr"))).expect("written");
        let (image, json) = read(Cursor::new(&bytes)).expect("our own file");
        let metadata: Metadata = serde_json::from_str(&json).expect("our own text");
        assert_eq!(metadata.atlas, table, "{name}");
        let pixels = image.rgb_pixels().expect("R, G, B");
        for (pixel, sample) in atlas.samples(&base) {
            let BaseSample::Landmark(l) = sample else { continue };
            let Some(&v) = marks.get(l.index()) else { continue };
            assert_eq!(
                pixels[atlas.index(pixel)],
                meshes[k].positions[VertexId(v)].as_vec3().to_array(),
                "{name}: {l}"
            );
        }
        let mesh = rebuilt(&bytes, None).expect("a sound image").mesh;
        assert_eq!((mesh.genus(), mesh.conn.boundary_loops().len()), (0, 0), "{name}");
        assert!(mesh.volume() > 0.0, "{name} is inside out");
    }
}

/// A folder of one test.
struct Scratch(PathBuf);

impl Scratch {
    fn new(test: &str) -> Self {
        let dir = std::env::temp_dir().join(format!("homeo-rebuild-{test}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(&dir).expect("the temporary folder is writable");
        Scratch(dir)
    }

    fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().expect("a plain name").to_owned()
    }

    fn add(&self, name: &str, bytes: &[u8]) -> String {
        fs::write(self.path(name), bytes).expect("the temporary folder is writable");
        self.path(name)
    }

    fn count(&self) -> usize {
        fs::read_dir(&self.0).expect("it is there").count()
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn bake(arguments: &[&str]) -> Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_homeo"));
    program.arg("bake").args(arguments).env_remove("RUST_BACKTRACE").output().expect("the program starts")
}

/// Asserts the exit code and that the one line of the error holds all the words.
fn refuses(arguments: &[&str], code: i32, words: &[&str]) {
    let output = bake(arguments);
    let line = String::from_utf8_lossy(&output.stderr).trim_end().to_owned();
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {line}");
    assert!(line.starts_with("error: ") && line.lines().count() == 1, "{arguments:?}: {line}");
    for word in words {
        assert!(line.contains(word), "{arguments:?}: no {word:?} in: {line}");
    }
}

#[test]
fn the_program_rebuilds_flat_and_layered_files() {
    let scratch = Scratch::new("program");
    let (flat, layered) = (scratch.add("source_position.exr", &flat()), scratch.add("geometry.exr", &layered()));
    let out = scratch.path("mesh.obj");
    let volume = |arguments: &[&str]| {
        let output = bake(&[arguments, &["--out", &out, "--json"]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON on stdout");
        assert_eq!((&json["vertices"], &json["faces"]), (&66.into(), &128.into()), "{json}");
        assert_eq!((&json["genus"], &json["boundary_loops"]), (&0.into(), &0.into()), "{json}");
        let file = read_mesh(Path::new(&out)).expect("our own file");
        TriMesh::new(file.positions.clone(), &file.triangles()).expect("a manifold").volume()
    };
    assert!((volume(&["--rebuild", &flat]) - 4.0 / 3.0).abs() < 1e-6);
    assert!((volume(&["--rebuild", &layered]) - 4.0 / 3.0).abs() < 1e-6, "an earlier file is replaced");
    assert!((volume(&["--rebuild", &layered, "--layer", "target"]) - 36.0).abs() < 1e-4);
    assert_eq!(scratch.count(), 3, "nothing else is left");
    let output = bake(&["--rebuild", &flat, "--out", &out]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.ends_with("mesh.obj: 66 vertices, 128 faces, genus 0, 0 boundary loops\n"), "{text}");
}

#[test]
fn the_program_refuses_by_file_and_leaves_nothing() {
    let scratch = Scratch::new("refusals");
    let (flat, out) = (scratch.add("source_position.exr", &flat()), scratch.path("mesh.obj"));
    let cut = scratch.add("cut.exr", &layered()[..900]);
    refuses(&["--rebuild", &cut, "--out", &out], 3, &["cut.exr"]);
    refuses(&["--rebuild", &scratch.path("none.exr"), "--out", &out], 3, &["none.exr"]);
    refuses(&["--rebuild", &flat, "--layer", "source", "--out", &out], 2, &["source_position.exr", "--layer"]);
    refuses(&["--rebuild", &flat, "--layer", "both", "--out", &out], 2, &["both"]);
    refuses(&["--rebuild", &flat, "--out", &scratch.path("mesh.ply")], 2, &["mesh.ply", ".obj"]);
    refuses(&["--rebuild", &flat], 2, &["--out"]);
    refuses(&["some.obj", "--rebuild", &flat, "--out", &out], 2, &["cannot be used with"]);
    refuses(&["--rebuild", &flat, "--size", "64", "--out", &out], 2, &["cannot be used with"]);
    refuses(&["some.obj", "--layer", "source", "--out", "map.exr"], 2, &["cannot be used with"]);
    refuses(&["--out", &out], 2, &["required"]);
    fs::create_dir(scratch.path("folder.obj")).expect("writable");
    refuses(
        &["--rebuild", &flat, "--out", &scratch.path("folder.obj")],
        2,
        &["folder.obj", "the output file is a folder"],
    );
    refuses(&["--rebuild", &flat, "--out", &scratch.path("cut.exr/mesh.obj")], 3, &["cut.exr"]);
    assert_eq!(scratch.count(), 3, "inputs and the folder");
}
