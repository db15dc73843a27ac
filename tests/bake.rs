//! Baked geometry images lie on the surface, fill their gutters, and rebuild the mesh from the file alone.

mod base_complexes;

use base_complexes::{OCTAHEDRON, atlas_of, complex, from_triangles, mesh_of, octahedron_corners};
use glam::DVec3;
use homeo::map::atlas::{Atlas, BaseSample};
use homeo::map::base_complex::BaseComplex;
use homeo::map::tile_table::TileTable;
use homeo::mesh::{ArcId, FaceId, Id, IdVec, TriMesh, VertexId};
use homeo::stage::bake::{BakedImage, Metadata, Query, Sampled, bake, encode_layered};
use homeo::stage::exr;
use std::io::Cursor;

/// Interpolates in plain f32 arithmetic.
fn resample(attributes: &[[f32; 4]], queries: &[Query]) -> homeo::Result<Vec<[f32; 4]>> {
    let one = |(corners, b): &Query| {
        let [p, q, r] = corners.map(|v| attributes[v as usize]);
        std::array::from_fn(|i| b[0] * p[i] + b[1] * q[i] + b[2] * r[i])
    };
    Ok(queries.iter().map(one).collect())
}

/// For every sample of an atlas over the faces of a mesh its point on that mesh.
fn points_on_faces(base: &BaseComplex, atlas: &Atlas) -> Vec<(FaceId, [f64; 3])> {
    let side_of = base.side_of();
    let on_arc = |a: ArcId, s: f64| {
        let (p, side) = side_of[2 * a.index()];
        let mut b = [0.0; 3];
        b[side] = 1.0 - s;
        b[(side + 1) % 3] = s;
        (FaceId(p.0), b)
    };
    let place = |(_, sample)| match sample {
        BaseSample::Landmark(l) => {
            let a = base.arcs.ids().find(|&a| base.arcs[a].contains(&l)).expect("every landmark has an arc");
            on_arc(a, f64::from(u8::from(base.arcs[a][1] == l)))
        }
        BaseSample::OnArc(a, s) => on_arc(a, s),
        BaseSample::InPatch(p, b) => (FaceId(p.0), b),
    };
    atlas.samples(base).map(place).collect()
}

fn octahedron_mesh(corners: Vec<DVec3>) -> TriMesh {
    TriMesh::new(corners, &OCTAHEDRON.map(|face| face.map(VertexId))).expect("a manifold")
}

fn baked_octahedron(base: &BaseComplex, atlas: &Atlas) -> Vec<BakedImage> {
    let source = octahedron_mesh(octahedron_corners());
    let target = octahedron_mesh(octahedron_corners().iter().map(|p| *p * 2.0 + DVec3::Z).collect());
    let points = points_on_faces(base, atlas);
    let stretch = IdVec::from_raw(vec![1.0, 1.0, 1.0, 1.0, 2.0, 2.0]);
    let on = |mesh| Sampled { mesh, points: &points, uv: None };
    bake(base, atlas, on(&source), on(&target), &stretch, &resample).expect("matching sizes")
}

#[test]
fn baked_octahedron_lies_on_the_octahedron_and_rebuilds_to_it() {
    let base = from_triangles(6, &OCTAHEDRON);
    let atlas = atlas_of(&base, 9);
    let images = baked_octahedron(&base, &atlas);
    let names: Vec<&str> = images.iter().map(|image| image.name).collect();
    assert_eq!(names, ["source_position", "source_normal", "target_position", "target_normal", "stretch", "mask"]);
    for [x, y, z] in images[0].image.rgb_pixels().expect("R, G, B") {
        assert!((x.abs() + y.abs() + z.abs() - 1.0).abs() < 1e-6, "{x} {y} {z} is off the surface");
    }
    let positions = images[0].image.rgb_pixels().expect("R, G, B");
    for (normal, position) in images[1].image.rgb_pixels().expect("R, G, B").into_iter().zip(&positions) {
        let (n, p) = (DVec3::from(normal.map(f64::from)), DVec3::from(position.map(f64::from)));
        // The corner normals are the corners themselves, so an interpolated normal has its point's direction.
        assert!((n.length() - 1.0).abs() < 1e-6 && n.distance(p.normalize()) < 1e-6, "{n} at {p}");
    }
    for (&s, [_, _, z]) in images[4].image.plane("Y").expect("Y").iter().zip(&positions) {
        assert!((s - 1.0 - z.abs()).abs() < 1e-6, "stretch {s} at height {z}");
    }
    assert!(images[5].image.plane("Y").expect("Y").iter().all(|&y| y == 1.0));
    let volume = |i: usize| mesh_of(&images[i].image, &atlas, &base).expect("watertight").volume();
    assert!((volume(0) - 4.0 / 3.0).abs() < 1e-6, "volume {}", volume(0));
    assert!((volume(2) - 32.0 / 3.0).abs() < 1e-5, "volume {}", volume(2));
}

#[test]
fn an_image_file_alone_rebuilds_the_mesh() {
    let base = from_triangles(6, &OCTAHEDRON);
    let atlas = atlas_of(&base, 17);
    let table = TileTable::new(&atlas, &base);
    let images = baked_octahedron(&base, &atlas);
    let bytes = images[0].encode(&table).expect("a sound image");
    assert_eq!(bytes, images[0].encode(&table).expect("a sound image"), "the bytes differ from run to run");
    let (image, json) = exr::read(Cursor::new(bytes)).expect("our own file");
    let metadata: Metadata = serde_json::from_str(&json).expect("our own text");
    assert_eq!((metadata.image.as_str(), metadata.color_interop_id.as_str()), ("source_position", "data"));
    let (atlas, base) = metadata.atlas.parts().expect("a sound table");
    let mesh = mesh_of(&image, &atlas, &base).expect("a sound image");
    assert_eq!((mesh.conn.face_count(), mesh.genus()), (8 * 16 * 16, 0));
    assert!((mesh.volume() - 4.0 / 3.0).abs() < 1e-6);
}

#[test]
fn a_layered_file_holds_every_image_and_shows_the_first() {
    let base = from_triangles(6, &OCTAHEDRON);
    let atlas = atlas_of(&base, 9);
    let table = TileTable::new(&atlas, &base);
    let images = baked_octahedron(&base, &atlas);
    let bytes = encode_layered(&images, &table).expect("sound images");
    let (file, json) = exr::read(Cursor::new(bytes)).expect("our own file");
    let metadata: Metadata = serde_json::from_str(&json).expect("our own text");
    assert_eq!((metadata.image.as_str(), metadata.color_interop_id.as_str()), ("geometry", "data"));
    assert!(metadata.units.contains("stretch: ratio of lengths"), "{}", metadata.units);
    assert_eq!(file.rgb_pixels(), images[0].image.rgb_pixels());
    let layered = [("source.position", 0), ("source.normal", 1), ("target.position", 2), ("target.normal", 3)];
    for (layer, i) in layered {
        for (channel, flat) in [("X", "R"), ("Y", "G"), ("Z", "B")] {
            let plane = file.plane(&format!("{layer}.{channel}"));
            assert!(plane.is_some() && plane == images[i].image.plane(flat), "{layer}.{channel}");
        }
    }
    for (layer, i) in [("stretch.Y", 4), ("mask.Y", 5)] {
        assert_eq!(file.plane(layer), images[i].image.plane("Y"), "{layer}");
    }
    assert_eq!(file.planes.len(), 3 + 4 * 3 + 2);
    let (atlas, base) = metadata.atlas.parts().expect("a sound table");
    assert!((mesh_of(&file, &atlas, &base).expect("watertight").volume() - 4.0 / 3.0).abs() < 1e-6);
    assert!(encode_layered(&[], &table).is_err());
}

#[test]
fn texture_coordinates_are_images_of_meshes_that_have_some() {
    let base = from_triangles(6, &OCTAHEDRON);
    let atlas = atlas_of(&base, 5);
    let mesh = octahedron_mesh(octahedron_corners());
    let points = points_on_faces(&base, &atlas);
    let places: Vec<[f32; 2]> = (0..points.len()).map(|i| [i as f32, 0.5 * i as f32]).collect();
    let on = |uv| Sampled { mesh: &mesh, points: &points, uv };
    let stretch = IdVec::filled(1.0, 6);
    let baked = |uv| bake(&base, &atlas, on(None), on(Some(uv)), &stretch, &resample);
    let images = baked(&places[..]).expect("matching sizes");
    assert_eq!(images.iter().map(|image| image.name).skip(6).collect::<Vec<_>>(), ["target_uv"]);
    let inside = images[6].image.rgb_pixels().expect("R, G, B");
    assert!(inside.iter().all(|&[u, v, zero]| v == 0.5 * u && zero == 0.0));
    let bytes = encode_layered(&images, &TileTable::new(&atlas, &base)).expect("sound images");
    let (file, _) = exr::read(Cursor::new(bytes)).expect("our own file");
    for (layer, flat) in [("target.uv.U", "R"), ("target.uv.V", "G")] {
        assert!(file.plane(layer).is_some() && file.plane(layer) == images[6].image.plane(flat), "{layer}");
    }
    assert_eq!(file.planes.len(), 3 + 4 * 3 + 2 + 2);
    assert!(baked(&places[1..]).is_err());
}

#[test]
fn the_mask_is_not_dilated_and_everything_else_is() {
    let base = complex(3, &[[0, 1], [1, 2], [2, 0]], &[[1, 2, 3]]);
    let atlas = atlas_of(&base, 5);
    let corners = vec![DVec3::new(1.0, 0.0, 1.0), DVec3::new(3.0, 0.0, 1.0), DVec3::new(1.0, 2.0, 1.0)];
    let mesh = TriMesh::new(corners, &[[0, 1, 2].map(VertexId)]).expect("a triangle");
    let points: Vec<(FaceId, [f64; 3])> = points_on_faces(&base, &atlas);
    let on = Sampled { mesh: &mesh, points: &points, uv: None };
    let stretch = IdVec::filled(1.0, 3);
    let images = bake(&base, &atlas, on, on, &stretch, &resample).expect("matching sizes");
    let mask = images[5].image.plane("Y").expect("Y");
    assert_eq!(mask.iter().sum::<f32>(), 15.0);
    for axis in ["R", "G"] {
        let (low, high) = if axis == "R" { (1.0, 3.0) } else { (0.0, 2.0) };
        assert!(images[0].image.plane(axis).expect(axis).iter().all(|v| (low..=high).contains(v)), "{axis}");
    }
    assert!(images[0].image.plane("B").expect("B").iter().all(|&z| z == 1.0), "a gutter is left empty");
    assert!(images[1].image.plane("B").expect("B").iter().all(|&z| z == 1.0), "a gutter is left empty");
    assert!(images[4].image.plane("Y").expect("Y").iter().all(|&s| s == 1.0), "a gutter is left empty");
}

#[test]
fn bake_refuses_lists_of_the_wrong_length() {
    let base = from_triangles(6, &OCTAHEDRON);
    let atlas = atlas_of(&base, 5);
    let mesh = octahedron_mesh(octahedron_corners());
    let points = points_on_faces(&base, &atlas);
    let (whole, short) =
        (Sampled { mesh: &mesh, points: &points, uv: None }, Sampled { mesh: &mesh, points: &points[1..], uv: None });
    let stretch = |n| IdVec::filled(1.0, n);
    let forgetful = |_: &[[f32; 4]], queries: &[Query]| Ok(vec![[0.0; 4]; queries.len() - 1]);
    assert!(bake(&base, &atlas, short, whole, &stretch(6), &resample).is_err());
    assert!(bake(&base, &atlas, whole, short, &stretch(6), &resample).is_err());
    assert!(bake(&base, &atlas, whole, whole, &stretch(5), &resample).is_err());
    assert!(bake(&base, &atlas, whole, whole, &stretch(6), &forgetful).is_err());
    assert!(bake(&base, &atlas, whole, whole, &stretch(6), &resample).is_ok());
}
