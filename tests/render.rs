//! Previews: what hides what, which way textures stand, and the same bytes always.

use glam::{DVec2, DVec3};
use homeo::mesh::{TriMesh, VertexId};
use homeo::picture::render::{Camera, Dot, Lens, Line, Paint, Scene, View, color, contact_sheet, render};
use homeo::picture::{Depth, Picture, Pyramid, file::format_for, read_picture};
use homeo::shape::{Quadruped, fixture, quadruped};
use std::path::Path;

const RED: [f32; 3] = [1.0, 0.0, 0.0];
const GREEN: [f32; 3] = [0.0, 1.0, 0.0];

/// The bytes of a picture as PNG.
fn png(picture: &Picture) -> Vec<u8> {
    let format = format_for(Path::new("a.png"), picture.depth).expect("bytes fit into PNG");
    let mut out = std::io::Cursor::new(Vec::new());
    picture.write(format, &mut out).expect("memory takes all");
    out.into_inner()
}

fn middle(picture: &Picture) -> [f32; 3] {
    at(picture, 0.5, 0.5)
}

/// The colour at a share of the way right and down.
fn at(picture: &Picture, x: f64, y: f64) -> [f32; 3] {
    let (x, y) = ((x * picture.width as f64) as usize, (y * picture.height as f64) as usize);
    let [r, g, b, _] = picture.pixels[y * picture.width + x];
    [r, g, b]
}

/// A square of half side 1 in the plane z = `height`, as two triangles seen from +z.
fn square(height: f64, first: u32) -> (Vec<DVec3>, Vec<[VertexId; 3]>) {
    let positions = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec3::new(x, y, height));
    let faces = [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|v| VertexId(first + v)));
    (positions.to_vec(), faces.to_vec())
}

/// ```text
///  viewer   z = 1 red        z = 0 green        and the same with the order of faces turned round
/// ```
#[test]
fn the_nearer_triangle_hides_the_farther_one() {
    for lens in [Lens::Orthographic, Lens::Perspective(3.0)] {
        let ((mut positions, mut faces), (behind, more)) = (square(1.0, 0), square(0.0, 4));
        positions.extend(behind);
        faces.extend(more);
        let mut colors = vec![RED, RED, GREEN, GREEN];
        for _ in 0..2 {
            let scene = Scene::new(&positions, &faces, Paint::Faces(&colors));
            let front = Camera::looking(DVec3::Z, DVec3::Y, lens, &positions);
            let back = Camera::looking(DVec3::NEG_Z, DVec3::Y, lens, &positions);
            let [r, g, _] = middle(&render(&scene, &front, [33, 33]));
            assert!(r > 0.9 && g == 0.0, "red is nearer");
            let [r, g, _] = middle(&render(&scene, &back, [33, 33]));
            assert!(r == 0.0 && g > 0.2 && g < 0.6, "green is nearer, seen from inside");
            faces.reverse();
            colors.reverse();
        }
    }
}

/// ```text
/// v = 1  +------+------+
///        | blue | white|      the image, as it stands
///        +------+------+
///        | red  | green|
/// v = 0  +------+------+
/// ```
#[test]
fn textures_stand_upright_with_v_up() {
    let [red, green, blue, white] =
        [[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0], [1.0, 1.0, 1.0, 1.0]];
    let pixels = vec![blue, white, red, green];
    let image = Picture { width: 2, height: 2, channels: 3, depth: Depth::Byte, pixels };
    let pyramid = Pyramid::new(&image);
    let (positions, faces) = square(0.0, 0);
    let uv: Vec<[DVec2; 3]> =
        faces.iter().map(|t| t.map(|v| positions[v.0 as usize].truncate() * 0.5 + DVec2::splat(0.5))).collect();
    let scene = Scene::new(&positions, &faces, Paint::Texture(&uv, &pyramid));
    let picture = render(&scene, &Camera::new(View::Front, Lens::Orthographic, &positions), [64, 64]);
    for (x, y, [r, g, b, _]) in [(0.28, 0.72, red), (0.72, 0.72, green), (0.28, 0.28, blue), (0.72, 0.28, white)] {
        let seen = at(&picture, x, y);
        for (k, expected) in [r, g, b].into_iter().enumerate() {
            assert!((seen[k] - expected).abs() < 0.25, "{seen:?} at {x}, {y}");
        }
    }
    let checker = Scene { paint: Paint::Checker(&uv, 2.0, [RED, GREEN]), ..scene };
    let picture = render(&checker, &Camera::new(View::Front, Lens::Orthographic, &positions), [64, 64]);
    assert!(at(&picture, 0.3, 0.7)[0] > 0.9 && at(&picture, 0.7, 0.7)[1] > 0.9);
}

#[test]
fn surfaces_hide_the_lines_and_dots_behind_them() {
    let (positions, faces) = square(0.0, 0);
    let camera = Camera::new(View::Front, Lens::Orthographic, &positions);
    let blue = [0.0, 0.0, 1.0];
    let line = |z: f64| vec![DVec3::new(-0.9, 0.0, z), DVec3::new(0.9, 0.0, z)];
    for (height, is_seen) in [(0.0, true), (0.5, true), (-0.5, false)] {
        let mut scene = Scene::new(&positions, &faces, Paint::Plain(RED));
        scene.lines.push(Line { points: line(height), color: blue, width: 3.0 });
        scene.dots.push(Dot { at: DVec3::new(0.5, 0.5, height), color: GREEN, radius: 4.0 });
        let picture = render(&scene, &camera, [65, 65]);
        assert_eq!(middle(&picture)[2] > 0.9, is_seen, "a line at {height}");
        assert_eq!(at(&picture, 0.5 + 0.225, 0.5 - 0.225)[1] > 0.9, is_seen, "a dot at {height}");
    }
}

#[test]
fn meshes_fit_into_the_picture_and_degenerate_ones_do_no_harm() {
    let ball = fixture::icosphere(3);
    let faces = ball.faces();
    for (view, lens) in [(View::Front, Lens::Orthographic), (View::ThreeQuarter, Lens::Perspective(4.0))] {
        let scene = Scene::new(&ball.positions.raw, &faces, Paint::Plain(RED));
        let picture = render(&scene, &Camera::new(view, lens, &ball.positions.raw), [60, 40]);
        let covered = picture.pixels.iter().filter(|p| p[1] < 0.5).count() as f64 / 2400.0;
        let expected = std::f64::consts::PI * 18.0 * 18.0 / 2400.0;
        assert!((covered - expected).abs() < 0.03, "{covered} of the picture");
        let border = |i: usize| [0, 59].contains(&(i % 60)) || [0, 39].contains(&(i / 60));
        assert!(picture.pixels.iter().enumerate().all(|(i, p)| !border(i) || p[1] > 0.5));
    }
    let points = [DVec3::ZERO, DVec3::X, DVec3::splat(f64::NAN)];
    let flat = [[VertexId(0), VertexId(1), VertexId(1)], [VertexId(0), VertexId(1), VertexId(2)]];
    let scene = Scene::new(&points, &flat, Paint::Plain(RED));
    render(&scene, &Camera::new(View::Side, Lens::Perspective(3.0), &points), [8, 8]);
    render(&Scene::new(&[], &[], Paint::Plain(RED)), &Camera::new(View::Back, Lens::Orthographic, &[]), [8, 8]);
}

/// A quadruped in two views, with colours by height and its landmarks.
fn sheet() -> Picture {
    let shape = quadruped(Quadruped::Bull, 600);
    let TriMesh { positions, .. } = &shape.mesh;
    let faces = shape.mesh.faces();
    let height = |p: &DVec3| {
        let t = (p.z * 0.5).rem_euclid(1.0) as f32;
        [t, 0.4, 1.0 - t]
    };
    let colors: Vec<_> = positions.iter().map(height).collect();
    let mut scene = Scene::new(&positions.raw, &faces, Paint::Vertices(&colors));
    let dots = shape.landmarks.iter().map(|&(_, v)| Dot { at: positions[v], color: color(0xffd000), radius: 2.0 });
    scene.dots.extend(dots);
    let views = [View::Side, View::ThreeQuarter].map(|view| Camera::new(view, Lens::Perspective(4.0), &positions.raw));
    contact_sheet(&views.map(|camera| render(&scene, &camera, [160, 120])), 2)
}

/// The picture lies in `golden/`; after a wanted change of the renderer look at the new one, written below the build folder,
/// and put it in its place. Pixels are compared, so that a new PNG encoder is no difference.
#[test]
fn the_golden_picture_is_drawn_byte_for_byte_on_any_number_of_threads() {
    let bytes = png(&sheet());
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        assert_eq!(pool.install(|| png(&sheet())), bytes, "{threads} threads");
    }
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("render.png");
    std::fs::write(&place, &bytes).expect("the build folder can be written");
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/render.png");
    let read = |path: &Path| read_picture(path, true).expect("both are pictures");
    assert!(read(&place) == read(&golden), "{} is not the golden picture", place.display());
}
