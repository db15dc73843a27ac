//! Texture coordinates: baked maps hold what the surface has there, gutters what is nearest, and images that go through a map
//! show what the other mesh shows.

mod common;

use common::islands::{ball, cell_colours};
use glam::{DVec2, DVec3};
use homeo::ErrorKind;
use homeo::app::attributes::BakeMap;
use homeo::app::bake::{BakeOptions, bake};
use homeo::app::canvas::{Canvas, Padding};
use homeo::app::carry_values::carry_values;
use homeo::app::destination::Destination;
use homeo::app::finished_map::{FinishedMap, read_finished_map};
use homeo::app::texture::Textures;
use homeo::app::transfer::{Journey, TransferOptions, TransferReport, transfer};
use homeo::app::uv::UvTriangles;
use homeo::gpu::{Compute, Device, DeviceChoice};
use homeo::mesh::io::{MeshFile, VertexTable, write_obj};
use homeo::picture::{Picture, read_picture};
use homeo::pipeline::{MapJob, MapOptions, Silent, run_maps};
use homeo::stage::exr::Compression;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// A folder of one test alone, removed at the end.
struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        let dir = std::env::temp_dir().join(format!("homeo-texture-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&dir);
        std::fs::create_dir_all(&dir).expect("the temporary folder is writable");
        Scratch(dir)
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn baked(mesh: &MeshFile, map: BakeMap, size: usize, padding: Padding, out: &Path) -> Picture {
    bake(&Compute::Cpu, mesh, out, &BakeOptions { map, size, padding, compression: Compression::Zip })
        .expect("a baked map");
    read_picture(out, true).expect("an image")
}

/// Closer to an edge than this, as a weight, a texel may belong to either side.
const ON_EDGE: f64 = 1e-4;

/// Nearer to a plane between octants than this, the map of one ball onto the other may cross the seam.
const NEAR_SEAM: f64 = 0.02;

/// The surface point at a texture coordinate, by brute force over all triangles, and its least weight: none outside.
fn surface_point(mesh: &MeshFile, uv: DVec2) -> Option<(DVec3, f64)> {
    mesh.triangle_corners().find_map(|corners| {
        let [a, b, c] = corners.map(|k| mesh.uv.at(k).expect("a texture coordinate"));
        let areas = [(b - uv).perp_dot(c - uv), (c - uv).perp_dot(a - uv), (a - uv).perp_dot(b - uv)];
        let sum: f64 = areas.iter().sum();
        let least = areas.iter().map(|x| x / sum).fold(f64::INFINITY, f64::min);
        let point =
            || corners.iter().zip(areas).map(|(&k, w)| mesh.positions[mesh.corners[k].0 as usize] * (w / sum)).sum();
        (least > -ON_EDGE).then(|| (point(), least))
    })
}

fn texel_uv(i: usize, size: usize) -> DVec2 {
    DVec2::new(((i % size) as f64 + 0.5) / size as f64, 1.0 - ((i / size) as f64 + 0.5) / size as f64)
}

#[test]
fn a_position_map_holds_the_surface_and_its_gutters_the_nearest_of_it() {
    let scratch = Scratch::new("position");
    let mesh = ball(4, [0, 1, 2, 3, 4, 5, 6, 7]);
    let (size, reach) = (96, 3);
    let out = scratch.0.join("position.exr");
    let image = baked(&mesh, BakeMap::Position, size, Padding::Texels(reach), &out);
    let mask = read_picture(&scratch.0.join("position_mask.exr"), true).expect("the mask");
    let inside: Vec<bool> = mask.pixels.iter().map(|p| p[0] == 1.0).collect();
    let mut filled = 0;
    for (i, pixel) in image.pixels.iter().enumerate() {
        let value = DVec3::new(pixel[0].into(), pixel[1].into(), pixel[2].into());
        let expected = surface_point(&mesh, texel_uv(i, size));
        let is_on_edge = expected.is_some_and(|(_, least)| least < ON_EDGE);
        assert!(is_on_edge || inside[i] == expected.is_some(), "texel {i}");
        if let Some((expected, _)) = expected.filter(|_| inside[i]) {
            assert!(value.distance(expected) < 1e-5, "texel {i}: {value} {expected}");
            continue;
        }
        let apart = |j: usize| (i % size).abs_diff(j % size).pow(2) + (i / size).abs_diff(j / size).pow(2);
        let covered = || (0..size * size).filter(|&j| inside[j]);
        let least = covered().map(apart).min().expect("something is covered");
        let is_of_nearest = || covered().any(|j| apart(j) == least && image.pixels[j] == *pixel);
        if least <= (reach * reach) as usize {
            assert!(is_of_nearest(), "texel {i}");
            filled += 1;
        } else {
            assert_eq!(value, DVec3::ZERO, "texel {i} lies beyond the padding");
        }
    }
    assert!(filled > 500, "{filled}");
}

/// An image of this size goes by in two bands, and a texel's nearest covered one may lie in the other.
#[test]
fn gutters_without_end_reach_from_band_to_band() {
    let scratch = Scratch::new("bands");
    let mesh = ball(4, [0, 1, 2, 3, 4, 5, 6, 7]);
    let size = 320;
    let image = baked(&mesh, BakeMap::Position, size, Padding::Infinite, &scratch.0.join("position.exr"));
    let mask = read_picture(&scratch.0.join("position_mask.exr"), true).expect("the mask");
    let (inside, gutter): (Vec<usize>, Vec<usize>) = (0..size * size).partition(|&i| mask.pixels[i][0] == 1.0);
    assert!(gutter.len() > 5000, "{}", gutter.len());
    for &i in gutter.iter().step_by(37) {
        let apart = |j: usize| (i % size).abs_diff(j % size).pow(2) + (i / size).abs_diff(j / size).pow(2);
        let least = inside.iter().map(|&j| apart(j)).min().expect("something is covered");
        let of_nearest = inside.iter().any(|&j| apart(j) == least && image.pixels[j] == image.pixels[i]);
        assert!(of_nearest, "texel {i}");
    }
}

#[test]
fn normals_tangents_curvature_and_distortion_of_a_sphere() {
    let scratch = Scratch::new("maps");
    let mesh = ball(16, [0, 1, 2, 3, 4, 5, 6, 7]);
    let map = |map| baked(&mesh, map, 64, Padding::Texels(0), &scratch.0.join("map.exr"));
    let vector = |p: &[f32; 4]| DVec3::new(p[0].into(), p[1].into(), p[2].into());
    let (position, normal, tangent) = (map(BakeMap::Position), map(BakeMap::Normal), map(BakeMap::Tangent));
    let (curvature, distortion) = (map(BakeMap::Curvature), map(BakeMap::Distortion));
    let inside = (0..64 * 64).filter(|&i| position.pixels[i] != [0.0, 0.0, 0.0, 1.0]);
    for i in inside {
        let [p, n, t] = [&position, &normal, &tangent].map(|image| vector(&image.pixels[i]));
        assert!(n.distance(p.normalize()) < 0.02 && (n.length() - 1.0).abs() < 1e-5, "{n} at {p}");
        assert!(t.dot(n).abs() < 0.02 && (t.length() - 1.0).abs() < 1e-5, "{t} at {p}");
        assert!((curvature.pixels[i][0] - 1.0).abs() < 0.15, "{} at {p}", curvature.pixels[i][0]);
        let share = f64::from(distortion.pixels[i][0]) / stretch_of_ball(p);
        assert!((share - 1.0).abs() < 0.1, "{share} at {p}");
    }
}

/// L2 stretch at a point of the ball: its flat faces come from half squares of side 1 and are blown up by p -> p / |p|.
fn stretch_of_ball(p: DVec3) -> f64 {
    let flat = p.abs() / p.abs().element_sum();
    let out = flat.normalize();
    let blown_up = |edge: DVec3| (edge - out * out.dot(edge)) / flat.length();
    let [a, b] = [DVec3::Y, DVec3::Z].map(|corner| blown_up(corner - DVec3::X));
    // The image has area 8 / 2, the sphere 4 pi.
    (0.5 * (a.length_squared() + b.length_squared()) / std::f64::consts::PI).sqrt()
}

#[test]
fn tiles_oddities_and_refusals_are_named() {
    let scratch = Scratch::new("udim");
    let mut mesh = ball(2, [0, 1, 2, 3, 4, 5, 6, 7]);
    let padding = Padding::Texels(1);
    let options = BakeOptions { map: BakeMap::Position, size: 32, padding, compression: Compression::Zip };
    // A second island lies on the first, turned over, and everything one tile to the right and two up.
    for uv in &mut mesh.uv.values {
        *uv += DVec2::new(1.0, 2.0);
    }
    let report = bake(&Compute::Cpu, &mesh, &scratch.0.join("tile.<UDIM>.exr"), &options).expect("tiles");
    let names: Vec<_> = report.files.iter().map(|f| f.file_name().unwrap().to_string_lossy().into_owned()).collect();
    assert_eq!(names, ["tile.1022.exr", "tile.1022_mask.exr"]);
    assert_eq!((report.outside.count, report.flipped.count, report.overlapping.count), (0, 0, 0));
    let single = bake(&Compute::Cpu, &mesh, &scratch.0.join("one.exr"), &options).expect("an empty image");
    assert_eq!((single.covered, single.outside.count, single.outside.face), (0, mesh.triangle_count(), Some(0)));
    let corner = mesh.triangle_corners().next().expect("a triangle");
    let (other, first) = (mesh.triangle_corners().last().expect("another"), corner.map(|c| mesh.uv.corners[c]));
    for (c, uv) in other.into_iter().zip([first[0], first[2], first[1]]) {
        mesh.uv.corners[c] = uv;
    }
    let report = bake(&Compute::Cpu, &mesh, &scratch.0.join("odd.<UDIM>.exr"), &options).expect("tiles");
    let last = mesh.triangle_count() as u32 - 1;
    assert_eq!((report.flipped.count, report.flipped.face), (1, Some(last)));
    assert!(report.overlapping.count > 0 && report.overlapping.face == Some(0), "{:?}", report.overlapping);
    let refused = |mesh: &MeshFile, size| {
        let failed = bake(&Compute::Cpu, mesh, &scratch.0.join("no.exr"), &BakeOptions { size, ..options });
        assert!(!scratch.0.join("no.exr").exists());
        failed.expect_err("refused").kind
    };
    assert_eq!(refused(&mesh, 0), ErrorKind::Usage);
    assert_eq!(refused(&mesh, 16385), ErrorKind::Usage);
    mesh.uv = Default::default();
    assert_eq!(refused(&mesh, 32), ErrorKind::Input);
}

#[test]
fn infinite_padding_leaves_nothing_empty() {
    let mesh = ball(3, [0, 1, 2, 3, 4, 5, 6, 7]);
    let uv = UvTriangles::of(&mesh);
    let canvas = Canvas::new(150, 170, &uv.corners);
    let mut rows = 0;
    canvas
        .bands(&Compute::Cpu, Padding::Infinite, None, |band| {
            assert_eq!(band.first_row, rows);
            rows += band.rows;
            assert!(band.texels.iter().all(|t| t.triangle < 8 * 9));
            Ok(())
        })
        .expect("bands");
    assert_eq!(rows, 170);
}

/// Two balls of eight islands each, the second with the islands in other places, mapped by their six poles.
fn mapped(scratch: &Scratch) -> FinishedMap {
    mapped_with_images(scratch, 0)
}

/// The same with so many samples along a tile of the geometry images.
fn mapped_with_images(scratch: &Scratch, image: usize) -> FinishedMap {
    let meshes = [ball(6, [0, 1, 2, 3, 4, 5, 6, 7]), ball(6, [3, 7, 0, 5, 6, 1, 4, 2])];
    let file = |name: &str| scratch.0.join(name);
    for (name, mesh) in ["a.obj", "b.obj"].into_iter().zip(&meshes) {
        let mut bytes = Vec::new();
        write_obj(&mut bytes, &scratch.0, mesh, &mesh.positions).expect("memory takes everything");
        std::fs::write(file(name), bytes).expect("a mesh");
    }
    let is_pole = |p: &DVec3| p.abs().max_element() > 1.0 - 1e-9;
    let mut landmarks = "name,source_vertex,target_vertex\n".to_owned();
    for (i, _) in meshes[0].positions.iter().enumerate().filter(|(_, p)| is_pole(p)) {
        writeln!(landmarks, "p{i},{i},{i}").expect("a string takes everything");
    }
    std::fs::write(file("poles.csv"), landmarks).expect("landmarks");
    let job = MapJob {
        source: file("a.obj"),
        target: file("b.obj"),
        landmarks: file("poles.csv"),
        target_landmarks: None,
        hint: None,
        texture: None,
        out: file("map"),
    };
    let device = Device::open(&DeviceChoice::Cpu).expect("the CPU");
    let options = MapOptions { image, ..MapOptions::default() };
    run_maps(vec![job], &options, &device, &Silent, |outcome| drop(outcome.value.expect("a map")));
    read_finished_map(&file("map"), [None, None]).expect("the finished map")
}

fn carry(map: &FinishedMap, texture: &Path, out: &Path) -> (Picture, TransferReport) {
    let [source, target] = &map.meshes;
    let textures = Textures::read(texture, &UvTriangles::of(source), true).expect("a texture");
    let options = TransferOptions { size: None, padding: Padding::Texels(4), normal_map: false };
    let destination = Destination::of(target, &map.charts.meshes[1], None).expect("texture coordinates");
    let journey =
        Journey { meshes: [source, target], charts: &map.charts, textures: &textures, destination: &destination };
    let report = transfer(&Compute::Cpu, journey, out, &options).expect("carried");
    (read_picture(out, true).expect("an image"), report)
}

#[test]
fn an_image_goes_to_the_other_mesh_and_back() {
    let scratch = Scratch::new("round");
    let map = mapped(&scratch);
    let file = |name: &str| scratch.0.join(name);
    let size = 192;
    let there = baked(&map.meshes[0], BakeMap::Position, size, Padding::Infinite, &file("there.exr"));
    let truth = baked(&map.meshes[1], BakeMap::Position, size, Padding::Texels(4), &file("truth.exr"));
    let mask = |k: usize| {
        baked(&map.meshes[k], BakeMap::Position, size, Padding::Texels(0), &file("inside.exr"));
        read_picture(&file("inside_mask.exr"), true).expect("a mask")
    };
    let (carried, report) = carry(&map, &file("there.exr"), &file("carried.exr"));
    assert!(report.unfilled == 0 && report.covered > size * size / 4, "{report:?}");
    assert!(psnr(&carried, &truth, &mask(1)) > 38.0, "{}", psnr(&carried, &truth, &mask(1)));
    let back = FinishedMap {
        meshes: [map.meshes[1].clone(), map.meshes[0].clone()],
        atlas: None,
        charts: homeo::map::charts::Charts { meshes: [map.charts.meshes[1].clone(), map.charts.meshes[0].clone()] },
    };
    let (round, _) = carry(&back, &file("carried.exr"), &file("round.exr"));
    assert!(psnr(&round, &there, &mask(0)) > 38.0, "{}", psnr(&round, &there, &mask(0)));
}

/// Peak signal-to-noise ratio inside a mask, of values from -1 to 1.
fn psnr(a: &Picture, b: &Picture, mask: &Picture) -> f64 {
    let inside = mask.pixels.iter().map(|p| p[0] == 1.0);
    let errors = a.pixels.iter().zip(&b.pixels).zip(inside).filter(|(_, inside)| *inside);
    let squares: Vec<f64> =
        errors.flat_map(|((p, q), _)| (0..3).map(|k| f64::from(p[k] - q[k]).powi(2)).collect::<Vec<_>>()).collect();
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    10.0 * (4.0 / mean).log10()
}

#[test]
fn no_colour_bleeds_across_seams() {
    let scratch = Scratch::new("bleed");
    let map = mapped(&scratch);
    let colours = cell_colours(240);
    let mut bytes = std::io::Cursor::new(Vec::new());
    colours.write(homeo::picture::file::format_for(Path::new("c.png"), colours.depth).unwrap(), &mut bytes).unwrap();
    std::fs::write(scratch.0.join("cells.png"), bytes.into_inner()).expect("an image");
    let (carried, report) = carry(&map, &scratch.0.join("cells.png"), &scratch.0.join("carried.png"));
    assert_eq!(report.unfilled, 0);
    let palette: Vec<[f32; 4]> = {
        let mut all = colours.pixels.clone();
        all.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
        all.dedup();
        all
    };
    let target = &map.meshes[1];
    let (mut seen, mut inner) = (0, 0);
    for (i, pixel) in carried.pixels.iter().enumerate() {
        let point = surface_point(target, texel_uv(i, 240)).filter(|(_, least)| *least > ON_EDGE);
        let Some((p, _)) = point else { continue };
        assert!(palette.contains(pixel), "mixed colours at {p}");
        seen += 1;
        // Away from the seams both points lie in the same octant, which is island number `octant` on the source.
        if p.abs().min_element() > NEAR_SEAM {
            let octant = (0..3).filter(|&k| p[k] < 0.0).map(|k| 1 << k).sum::<usize>();
            let middle = [octant % 3, octant / 3].map(|cell| 240 * (2 * cell + 1) / 6);
            assert_eq!(*pixel, colours.pixels[(239 - middle[1]) * 240 + middle[0]], "a foreign colour at {p}");
            inner += 1;
        }
    }
    assert!(inner > 8000 && seen > inner, "{inner} of {seen}");
}

#[test]
fn geometry_images_hold_the_texture_coordinates_of_their_points() {
    let scratch = Scratch::new("uv");
    let map = mapped_with_images(&scratch, 9);
    for (mesh, name) in map.meshes.iter().zip(["source", "target"]) {
        let image = |what: &str| {
            let path = scratch.0.join(format!("map/geometry/{name}_{what}.exr"));
            read_picture(&path, true).expect("an image")
        };
        let (positions, uv) = (image("position"), image("uv"));
        assert_eq!((uv.width, uv.height, uv.channels), (positions.width, positions.height, 3));
        for ([x, y, z, _], [u, v, zero, _]) in positions.pixels.into_iter().zip(uv.pixels) {
            let at = DVec2::new(u.into(), v.into());
            let (point, _) = surface_point(mesh, at).expect("a point at the texture coordinate");
            assert!(point.distance(DVec3::new(x.into(), y.into(), z.into())) < 1e-4, "{name}: {at} is not {x} {y} {z}");
            assert_eq!(zero, 0.0);
        }
    }
}

#[test]
fn numbers_by_vertex_go_to_the_other_mesh() {
    let scratch = Scratch::new("values");
    let map = mapped(&scratch);
    let [source, target] = &map.meshes;
    let axis = |k: usize| source.positions.iter().map(|p| p[k]).collect();
    let ones = vec![1.0; source.positions.len()];
    let names = ["x", "y", "z", "one"].map(String::from).to_vec();
    let carried = carry_values(&map, &VertexTable { names, columns: vec![axis(0), axis(1), axis(2), ones] });
    for (v, p) in target.positions.iter().enumerate() {
        let value = DVec3::new(carried.columns[0][v], carried.columns[1][v], carried.columns[2][v]);
        assert!(value.distance(*p) < 0.05, "vertex {v}: {value} {p}");
        assert!((carried.columns[3][v] - 1.0).abs() < 1e-6, "weights sum to one");
    }
}
