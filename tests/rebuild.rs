//! Geometry images read back: watertight, of the surface's kind, exact at the pixels, and ever closer to the surface.

mod common;

use common::run::EDGE_NODES;
use glam::DVec3;
use homeo::app::rebuild::{PositionImage, RGB, Rebuilt, rebuild};
use homeo::map::atlas::Atlas;
use homeo::map::embedding::Embedding;
use homeo::map::surface_map::Chart;
use homeo::mesh::face_tree::FaceTree;
use homeo::mesh::io::read_mesh;
use homeo::mesh::{Id, SurfacePoint, TriMesh, VertexId};
use homeo::shape::fixture::{annulus, disc, ellipsoid, icosphere, sphere_with_holes, torus};
use homeo::shape::random_landmarks;
use homeo::stage::check::Guides;
use homeo::stage::cluster::cluster;
use homeo::stage::embed::embed;
use homeo::stage::exr::FloatImage;
use homeo::stage::layout::layouts;

/// Two meshes of one kind with an embedding in a common base complex.
struct Embedded {
    meshes: [TriMesh; 2],
    embedding: Embedding,
}

fn embedded(meshes: [TriMesh; 2], landmarks: [&[VertexId]; 2]) -> Embedded {
    let both = [&meshes[0], &meshes[1]];
    let sets = cluster(both, landmarks, &Guides::default());
    let layout = layouts(both, &sets, EDGE_NODES, 1).expect("a layout").remove(0);
    let (embedding, _) = embed(both, layout).expect("an embedding");
    Embedded { meshes, embedding }
}

impl Embedded {
    /// The position image of mesh `k`; not a number outside the mask.
    fn image(&self, k: usize, tile_size: usize) -> (FloatImage, Atlas) {
        let (mesh, base) = (&self.meshes[k], &self.embedding.base);
        let atlas = Atlas::new(base, tile_size, None).expect("the tile size is allowed");
        let chart = Chart::new(mesh, &self.embedding.meshes[k], base);
        let mut pixels = vec![[f32::NAN; 3]; atlas.width() * atlas.height()];
        for (pixel, sample) in atlas.samples(base) {
            let place: SurfacePoint = chart.point(sample).expect("charts cover their mesh");
            pixels[atlas.index(pixel)] = place.position(mesh).as_vec3().into();
        }
        (FloatImage::rgb(atlas.width(), atlas.height(), &pixels), atlas)
    }

    fn rebuilt(&self, k: usize, tile_size: usize) -> Rebuilt {
        let (image, atlas) = self.image(k, tile_size);
        let image = PositionImage::new(&image, RGB, atlas, self.embedding.base.clone()).expect("they fit");
        rebuild(&image).expect("a sound image")
    }
}

/// Pairs by name: closed of genus 0 and 1, and with one to three boundary loops.
fn pairs() -> Vec<(&'static str, Embedded)> {
    let marks = [0, 2, 3, 5, 6, 8].map(VertexId); // vertices of the icosahedron keep their numbers
    let egg = ellipsoid(DVec3::new(2.0, 1.0, 0.7), 3);
    let tori = [torus(24, 12), torus(30, 16)];
    let on_tori = tori.each_ref().map(|mesh| random_landmarks(mesh, 4, 3));
    let lone = [VertexId(0), VertexId(7)];
    vec![
        ("spheres", embedded([icosphere(2), egg], [&marks, &marks])),
        ("tori", embedded(tori, [&on_tori[0], &on_tori[1]])),
        ("discs", embedded([disc(5), disc(7)], [&lone[..1], &lone[..1]])),
        ("rings", embedded([annulus(14, 3), annulus(20, 4)], [&lone[..1], &lone[..1]])),
        ("holes", embedded([sphere_with_holes(3, 2), sphere_with_holes(3, 3)], [&marks, &marks])),
    ]
}

#[test]
fn rebuilt_meshes_are_of_the_surfaces_kind() {
    for (name, pair) in pairs() {
        for (k, tile_size) in [(0, 2), (0, 5), (1, 9), (0, 17), (1, 33)] {
            let (mesh, original) = (&pair.rebuilt(k, tile_size).mesh, &pair.meshes[k]);
            common::check::manifold(&mesh.conn);
            let kind =
                |m: &TriMesh| (m.genus(), m.conn.boundary_loops().len(), m.conn.components().iter().max().copied());
            assert_eq!(kind(mesh), kind(original), "{name} at {tile_size}");
        }
        let (mesh, original) = (pair.rebuilt(1, 33).mesh, &pair.meshes[1]);
        let sides = [mesh.area() / original.area(), turned_over(&mesh, original)];
        assert!((0.95..1.05).contains(&sides[0]) && sides[1] < 0.02, "{name}: area and share turned over {sides:?}");
    }
}

/// The share of the area whose normal opposes that of the nearest face of the original.
fn turned_over(mesh: &TriMesh, original: &TriMesh) -> f64 {
    let tree = FaceTree::new(original);
    let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
    let opposes = |t: [DVec3; 3]| {
        let middle = t.iter().sum::<DVec3>() / 3.0;
        let reach = tree.distance(middle) * 1.001 + 1e-9;
        let nearest = tree.nearest_within(middle, reach, |_| true).expect("something is nearest");
        normal(t).dot(normal(original.triangle(nearest))) < 0.0
    };
    let turned = mesh.conn.faces().map(|f| mesh.triangle(f)).filter(|&t| opposes(t)).map(|t| normal(t).length() / 2.0);
    turned.sum::<f64>() / mesh.area()
}

#[test]
fn every_sample_is_one_vertex_and_every_cell_two_triangles() {
    let pair = &pairs()[0].1;
    let base = &pair.embedding.base;
    for tile_size in [5, 9, 33] {
        let mesh = pair.rebuilt(0, tile_size).mesh;
        let steps = tile_size - 1;
        let inside = (steps - 1) * (steps - 2) / 2;
        let samples = base.landmarks + base.arcs.len() * (steps - 1) + base.patches.len() * inside;
        assert_eq!(mesh.positions.len(), samples, "{tile_size}");
        assert_eq!(mesh.conn.face_count(), base.patches.len() * steps * steps, "{tile_size}");
    }
}

#[test]
fn vertices_lie_at_their_pixels_exactly() {
    for (name, pair) in pairs() {
        let (image, atlas) = pair.image(0, 17);
        let pixels = image.rgb_pixels().expect("R, G, B");
        let Rebuilt { mesh, uv } = pair.rebuilt(0, 17);
        let corners: Vec<VertexId> = mesh.faces().into_iter().flatten().collect();
        let mut halfway = 0;
        for (c, &v) in corners.iter().enumerate() {
            let at = uv.at(c).expect("every corner has a place");
            let [x, y] = [at.x * atlas.width() as f64 - 0.5, (1.0 - at.y) * atlas.height() as f64 - 0.5];
            if [x, y].iter().any(|a| (a - a.round()).abs() > 1e-6) {
                halfway += 1; // a split edge's middle
                continue;
            }
            let pixel = pixels[y.round() as usize * atlas.width() + x.round() as usize];
            assert_eq!(mesh.positions[v].as_vec3().to_array(), pixel, "{name}: {v} at column {x}, row {y}");
        }
        assert!(halfway * 20 < corners.len(), "{name}: {halfway} of {} corners", corners.len());
    }
}

/// Every triangle is counter-clockwise in the image and covers half a pixel's cell: the image is a chart without folds.
#[test]
fn texture_coordinates_do_not_fold() {
    for (name, pair) in pairs() {
        let (_, atlas) = pair.image(0, 9);
        let Rebuilt { mesh, uv } = pair.rebuilt(0, 9);
        let cell = 1.0 / (atlas.width() * atlas.height()) as f64;
        for f in mesh.conn.faces() {
            let [a, b, c] = [0, 1, 2].map(|i| uv.at(3 * f.index() + i).expect("every corner has a place"));
            let cells = (b - a).perp_dot(c - a) / cell;
            assert!(cells > 0.01 && cells < 1.0 + 1e-9, "{name}: {f} covers {cells} cells");
        }
    }
}

#[test]
fn a_written_mesh_reads_back_bit_for_bit() {
    let rebuilt = pairs()[1].1.rebuilt(0, 9);
    let path = std::env::temp_dir().join(format!("homeo-rebuilt-{}.obj", std::process::id()));
    rebuilt.write(&path).expect("the temporary folder is writable");
    let file = read_mesh(&path).expect("our own file");
    std::fs::remove_file(&path).expect("just written");
    assert_eq!(file.positions, rebuilt.mesh.positions.raw);
    assert_eq!(file.triangles(), rebuilt.mesh.faces());
    assert_eq!(file.uv, rebuilt.uv);
    assert!(TriMesh::new(file.positions.clone(), &file.triangles()).is_ok());
}

/// Greatest distance from the middles of `from`'s faces and from its vertices to the surface of `to`.
fn farthest(from: &TriMesh, to: &TriMesh) -> f64 {
    let tree = FaceTree::new(to);
    let middles = from.conn.faces().map(|f| from.triangle(f).iter().sum::<DVec3>() / 3.0);
    middles.chain(from.positions.iter().copied()).map(|p| tree.distance(p)).fold(0.0, f64::max)
}

/// Chords miss a smooth surface by the square of their length. The sphere is itself a polyhedron, so its edges, 0.04
/// long, must stay below the spacing of the samples: 0.2, 0.1, 0.05 for 9, 17, 33 samples along a quarter of a circle.
#[test]
fn the_distance_falls_with_the_square_of_the_spacing() {
    let fine = icosphere(5);
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| [axis, -axis]).into_iter().flatten();
    let nearest = |axis: DVec3| {
        let towards = |&v: &VertexId| fine.positions[v].dot(axis);
        fine.conn.vertices().max_by(|a, b| towards(a).total_cmp(&towards(b))).expect("a sphere has vertices")
    };
    let marks: Vec<VertexId> = axes.map(nearest).collect();
    let pair = embedded([fine.clone(), fine], [&marks, &marks]);
    let distances = [9, 17, 33].map(|tile_size| {
        let mesh = pair.rebuilt(0, tile_size).mesh;
        [farthest(&mesh, &pair.meshes[0]), farthest(&pair.meshes[0], &mesh)]
    });
    println!("{distances:?}");
    for pair in distances.windows(2) {
        for way in 0..2 {
            let gain = pair[0][way] / pair[1][way];
            assert!(gain > 3.2, "half the spacing brings a factor of {gain} only: {distances:?}");
        }
    }
}
