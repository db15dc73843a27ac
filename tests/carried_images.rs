//! What images keep on their way through a map: depth and alpha, tiles, and the directions of normal maps.

use glam::{DVec2, DVec3, Vec3};
use homeo::app::canvas::Padding;
use homeo::app::destination::Destination;
use homeo::app::finished_map::{FinishedMap, read_finished_map};
use homeo::app::texture::Textures;
use homeo::app::transfer::{Journey, TransferOptions, TransferReport, transfer};
use homeo::app::uv::UvTriangles;
use homeo::gpu::{Compute, Device, DeviceChoice};
use homeo::mesh::io::{MeshFile, write_obj};
use homeo::picture::{Depth, Picture, file::format_for, read_picture};
use homeo::pipeline::{MapJob, MapOptions, Silent, run_maps};
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Quads along a side of the sheets.
const QUADS: usize = 8;
/// Texels along a side of the images.
const SIZE: usize = 64;

/// A folder of one test alone, removed at the end.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        let dir = std::env::temp_dir().join(format!("homeo-carried-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&dir);
        std::fs::create_dir_all(&dir).expect("the temporary folder is writable");
        Scratch(dir)
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The unit square in space, flat, of quads; texture coordinates as `uv` says.
fn sheet(uv: impl Fn(DVec2) -> DVec2) -> MeshFile {
    let n = QUADS + 1;
    let places: Vec<DVec2> = (0..n * n).map(|i| DVec2::new((i % n) as f64, (i / n) as f64) / QUADS as f64).collect();
    let mut mesh = MeshFile { positions: places.iter().map(|p| p.extend(0.0)).collect(), ..MeshFile::default() };
    mesh.uv.values = places.iter().map(|&p| uv(p)).collect();
    for q in 0..QUADS * QUADS {
        let a = (q / QUADS * n + q % QUADS) as u32;
        let n = n as u32;
        for triangle in [[a, a + 1, a + n + 1], [a, a + n + 1, a + n]] {
            mesh.push_polygon(triangle);
            mesh.uv.corners.extend(triangle);
        }
    }
    mesh
}

/// A sheet mapped onto itself with other texture coordinates, by its four corners: every point goes where it was.
fn mapped(scratch: &Scratch, meshes: [MeshFile; 2]) -> FinishedMap {
    for (name, mesh) in ["a.obj", "b.obj"].into_iter().zip(&meshes) {
        let mut bytes = Vec::new();
        write_obj(&mut bytes, &scratch.0, mesh, &mesh.positions).expect("memory takes everything");
        std::fs::write(scratch.file(name), bytes).expect("a mesh");
    }
    let (n, all) = (QUADS, (QUADS + 1) * (QUADS + 1));
    let corners = [0, n, all - 1, all - 1 - n].map(|v| format!("c{v},{v},{v}\n")).concat();
    std::fs::write(scratch.file("corners.csv"), format!("name,source_vertex,target_vertex\n{corners}"))
        .expect("landmarks");
    let job = MapJob {
        source: scratch.file("a.obj"),
        target: scratch.file("b.obj"),
        landmarks: scratch.file("corners.csv"),
        target_landmarks: None,
        hint: None,
        texture: None,
        out: scratch.file("map"),
    };
    let device = Device::open(&DeviceChoice::Cpu).expect("the CPU");
    let options = MapOptions { image: 0, ..MapOptions::default() };
    run_maps(vec![job], &options, &device, &Silent, |outcome| drop(outcome.value.expect("a map")));
    read_finished_map(&scratch.file("map"), [None, None]).expect("the finished map")
}

/// Carries an image of the source; without gutters.
fn carry(map: &FinishedMap, texture: &Path, out: &Path, normal_map: bool) -> TransferReport {
    let [source, target] = &map.meshes;
    let textures = Textures::read(texture, &UvTriangles::of(source), normal_map).expect("a texture");
    let options = TransferOptions { size: Some(SIZE), padding: Padding::Texels(0), normal_map };
    let destination = Destination::of(target, &map.charts.meshes[1], None).expect("texture coordinates");
    let journey =
        Journey { meshes: [source, target], charts: &map.charts, textures: &textures, destination: &destination };
    transfer(&Compute::Cpu, journey, out, &options).expect("carried")
}

fn write(path: &Path, depth: Depth, channels: usize, colour: impl Fn(DVec2) -> [f32; 4]) {
    let pixels = (0..SIZE * SIZE).map(|i| colour(texel_uv(i))).collect();
    let picture = Picture { width: SIZE, height: SIZE, channels, depth, pixels };
    let mut bytes = Cursor::new(Vec::new());
    picture.write(format_for(path, depth).expect("a fitting name"), &mut bytes).expect("memory takes everything");
    std::fs::write(path, bytes.into_inner()).expect("an image");
}

fn texel_uv(i: usize) -> DVec2 {
    DVec2::new((i % SIZE) as f64 + 0.5, SIZE as f64 - (i / SIZE) as f64 - 0.5) / SIZE as f64
}

/// Texels of images of the whole square that lie off its border, where single texels look over the edge.
fn inner() -> impl Iterator<Item = usize> {
    (0..SIZE * SIZE).filter(|&i| (texel_uv(i) - 0.5).abs().max_element() < 0.5 - 2.0 / SIZE as f64)
}

/// The texture coordinates of places on a sheet.
type Layout = fn(DVec2) -> DVec2;

fn quarter_turn(p: DVec2) -> DVec2 {
    DVec2::new(1.0 - p.y, p.x)
}

#[test]
fn sixteen_bits_and_alpha_are_kept() {
    let scratch = Scratch::new("words");
    let map = mapped(&scratch, [sheet(|p| p), sheet(quarter_turn)]);
    let ramp = |p: DVec2| [p.x as f32, p.y as f32, 0.25, (0.5 + 0.5 * p.x * p.y) as f32];
    write(&scratch.file("ramp.png"), Depth::Word, 4, ramp);
    carry(&map, &scratch.file("ramp.png"), &scratch.file("carried.png"), false);
    let carried = read_picture(&scratch.file("carried.png"), false).expect("an image");
    assert_eq!((carried.depth, carried.channels), (Depth::Word, 4));
    let mut odd = 0;
    for i in inner() {
        let at = texel_uv(i);
        let expected = ramp(DVec2::new(at.y, 1.0 - at.x));
        for k in 0..4 {
            let off = (carried.pixels[i][k] - expected[k]).abs();
            // The ramps are straight, alpha all but; 2e-3 is half of what eight bits would round to.
            assert!(off < [1e-4, 1e-4, 1e-4, 1e-3][k], "texel {i}: {:?} {expected:?}", carried.pixels[i]);
        }
        odd += usize::from((carried.pixels[i][0] * 255.0).fract() > 0.1);
    }
    assert!(odd > SIZE, "values between those of eight bits");
}

#[test]
fn the_tiles_of_a_source_reach_the_target() {
    let scratch = Scratch::new("tiles");
    // The left half of the source lies in tile 1001, the right half in tile 1012.
    let halves = |p: DVec2| DVec2::new(2.0 * p.x, p.y);
    let mut source = sheet(halves);
    let right = |t: [usize; 3]| t.iter().all(|&c| source.positions[source.corners[c].0 as usize].x >= 0.5);
    let corners: Vec<usize> = source.triangle_corners().filter(|&t| right(t)).flatten().collect();
    for c in corners {
        let uv = source.uv.at(c).expect("a texture coordinate");
        source.uv.corners[c] = source.uv.values.len() as u32;
        source.uv.values.push(uv + DVec2::Y);
    }
    let map = mapped(&scratch, [source, sheet(|p| p)]);
    let (left, right) = ([1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0]);
    write(&scratch.file("tile.1001.png"), Depth::Byte, 3, |_| left);
    write(&scratch.file("tile.1012.png"), Depth::Byte, 3, |_| right);
    let report = carry(&map, &scratch.file("tile.<UDIM>.png"), &scratch.file("carried.png"), false);
    assert_eq!(report.unfilled, 0);
    let carried = read_picture(&scratch.file("carried.png"), false).expect("an image");
    for i in inner().filter(|&i| (texel_uv(i).x - 0.5).abs() > 1.0 / SIZE as f64) {
        assert_eq!(carried.pixels[i], if texel_uv(i).x < 0.5 { left } else { right }, "texel {i}");
    }
    std::fs::remove_file(scratch.file("tile.1012.png")).expect("a tile");
    let missing = Textures::read(&scratch.file("tile.<UDIM>.png"), &UvTriangles::of(&map.meshes[0]), false);
    assert!(missing.expect_err("a tile is missing").file.ends_with("tile.1012.png"));
}

#[test]
fn normal_maps_turn_with_the_texture_coordinates() {
    let scratch = Scratch::new("normals");
    let lean = DVec3::new(0.48, 0.6, 0.64);
    let turns: [(Layout, DVec3); 3] = [
        (|p| p, lean),
        // u runs along y, and v against x.
        (|p| DVec2::new(p.y, 1.0 - p.x), DVec3::new(0.6, -0.48, 0.64)),
        // Mirrored: u runs against x.
        (|p| DVec2::new(1.0 - p.x, p.y), DVec3::new(-0.48, 0.6, 0.64)),
    ];
    let colour = |n: DVec3| (n.as_vec3() * 0.5 + 0.5).extend(1.0).to_array();
    for (k, (uv, expected)) in turns.into_iter().enumerate() {
        let map = mapped(&scratch, [sheet(|p| p), sheet(uv)]);
        for (given, expected) in [(DVec3::Z, DVec3::Z), (lean, expected)] {
            write(&scratch.file("normal.exr"), Depth::Float, 3, |_| colour(given));
            carry(&map, &scratch.file("normal.exr"), &scratch.file("turned.exr"), true);
            let turned = read_picture(&scratch.file("turned.exr"), true).expect("an image");
            for i in inner() {
                let [r, g, b, _] = turned.pixels[i];
                let normal = Vec3::new(r, g, b) * 2.0 - 1.0;
                assert!(normal.distance(expected.as_vec3()) < 1e-3, "{k}, texel {i}: {normal} {expected}");
            }
        }
    }
}
