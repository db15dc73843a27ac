//! The atlas covers every patch once, shares borders bit for bit, and its images rebuild to a watertight mesh.

mod base_complexes;

use base_complexes::{OCTAHEDRON, atlas_of, complex, from_triangles, mesh_of, octahedron_corners};
use glam::DVec3;
use homeo::ErrorKind;
use homeo::map::atlas::{Atlas, BaseSample, Pixel};
use homeo::map::base_complex::{BaseComplex, DirectedArc};
use homeo::map::tile_table::TileTable;
use homeo::mesh::{ArcId, Id, IdVec, LandmarkId, PatchId};
use homeo::stage::exr::FloatImage;
use std::collections::HashMap;

fn tetrahedron() -> BaseComplex {
    from_triangles(4, &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
}

fn icosahedron() -> BaseComplex {
    let mut faces = Vec::new();
    for i in 0..5 {
        let (a, b) = (1 + i, 1 + (i + 1) % 5);
        let (c, d) = (6 + i, 6 + (i + 1) % 5);
        faces.extend([[0, a, b], [a, c, b], [b, c, d], [11, d, c]]);
    }
    from_triangles(12, &faces)
}

/// Two triangles glued along all three sides: every landmark has two arcs.
fn pillow() -> BaseComplex {
    complex(3, &[[0, 1], [1, 2], [2, 0]], &[[1, 2, 3], [-3, -2, -1]])
}

/// Two arcs from landmark 0 to landmark 1, with one landmark on either side of them.
fn double_arc() -> BaseComplex {
    let arcs = [[0, 1], [0, 1], [0, 2], [1, 2], [0, 3], [1, 3]];
    complex(4, &arcs, &[[1, 4, -3], [-2, 3, -4], [2, 6, -5], [-1, 5, -6]])
}

/// Two cones, each a patch glued to itself along one arc, joined at a loop: landmarks 1 and 2 have one arc.
fn two_cones() -> BaseComplex {
    complex(3, &[[0, 1], [0, 0], [0, 2]], &[[1, -1, 2], [3, -3, -2]])
}

/// A patch of three loops at landmark 0, behind each of which lie three patches: three bridges of the dual graph.
fn three_lobes() -> BaseComplex {
    let mut arcs = vec![[0, 0]; 3];
    let mut patches = vec![[1, 2, 3]];
    for lobe in 0..3 {
        let (x, y) = (1 + 2 * lobe, 2 + 2 * lobe);
        let c = arcs.len() as i32 + 1;
        let (d, e, f) = (c + 1, c + 2, c + 3);
        arcs.extend([[0, x], [0, x], [0, y], [x, y]]);
        patches.extend([[-(lobe as i32) - 1, c, -d], [-c, e, -f], [d, f, -e]]);
    }
    complex(7, &arcs, &patches)
}

/// One landmark, three loops: a square with opposite sides glued, cut along its diagonal.
fn torus() -> BaseComplex {
    complex(1, &[[0, 0]; 3], &[[1, 2, -3], [3, -1, -2]])
}

/// Closed base complexes by name, with their Euler characteristic.
fn closed() -> Vec<(&'static str, BaseComplex, i64)> {
    vec![
        ("tetrahedron", tetrahedron(), 2),
        ("octahedron", from_triangles(6, &OCTAHEDRON), 2),
        ("icosahedron", icosahedron(), 2),
        ("pillow", pillow(), 2),
        ("double arc", double_arc(), 2),
        ("two cones", two_cones(), 2),
        ("three lobes", three_lobes(), 2),
        ("torus", torus(), 0),
    ]
}

/// An embedding without meaning but continuous: corners on a helix, every arc and every patch with a bulge of its own.
fn bulged(base: &BaseComplex, sample: BaseSample) -> DVec3 {
    let corner = |l: LandmarkId| DVec3::new(f64::from(l.0).cos(), f64::from(l.0).sin(), 0.3 * f64::from(l.0));
    let bulge = |a: ArcId| DVec3::new(0.2, 0.1 * f64::from(a.0), 0.7 - 0.05 * f64::from(a.0));
    match sample {
        BaseSample::Landmark(l) => corner(l),
        BaseSample::OnArc(a, s) => {
            let [p, q] = base.arcs[a].map(corner);
            p * (1.0 - s) + q * s + bulge(a) * (4.0 * s * (1.0 - s))
        }
        BaseSample::InPatch(p, b) => {
            let corners = base.corners(p).map(corner);
            (0..3).fold(DVec3::ZERO, |sum, k| {
                sum + corners[k] * b[k] + bulge(base.patches[p][k].arc) * (4.0 * b[k] * b[(k + 1) % 3])
            })
        }
    }
}

/// The position image of [`bulged`]; zero outside the mask.
fn bulged_image(base: &BaseComplex, atlas: &Atlas) -> FloatImage {
    let mut pixels = vec![[0.0; 3]; atlas.width() * atlas.height()];
    for (pixel, sample) in atlas.samples(base) {
        pixels[atlas.index(pixel)] = bulged(base, sample).as_vec3().into();
    }
    FloatImage::rgb(atlas.width(), atlas.height(), &pixels)
}

#[test]
fn every_patch_has_one_half_of_one_tile() {
    for (name, base, euler) in closed() {
        let counts = base.landmarks as i64 - base.arcs.len() as i64 + base.patches.len() as i64;
        assert_eq!(counts, euler, "{name}: the fixture is wrong");
        let atlas = atlas_of(&base, 5);
        let mut patches: Vec<u32> =
            atlas.tiles.iter().flat_map(|tile| tile.halves()).map(|(_, half)| half.patch.0).collect();
        patches.sort_unstable();
        assert!(patches.iter().copied().eq(0..base.patches.len() as u32), "{name}: {patches:?}");
        let alone = atlas.tiles.iter().filter(|tile| tile.second.is_none()).count();
        assert_eq!(alone, if name == "three lobes" { 2 } else { 0 }, "{name}");
        assert!(atlas.columns * atlas.rows >= atlas.tiles.len() && atlas.rows.abs_diff(atlas.columns) <= 1, "{name}");
    }
}

#[test]
fn every_place_is_sampled_as_often_as_tiles_touch_it() {
    for (name, base, _) in closed() {
        for tile_size in [2, 3, 5, 17] {
            let atlas = atlas_of(&base, tile_size);
            let steps = atlas.steps();
            let (mut inside, mut on_arcs, mut landmarks) = (HashMap::new(), HashMap::new(), 0);
            for (_, sample) in atlas.samples(&base) {
                match sample {
                    BaseSample::Landmark(_) => landmarks += 1,
                    BaseSample::OnArc(a, s) => *on_arcs.entry((a, s.to_bits())).or_insert(0) += 1,
                    BaseSample::InPatch(p, b) => {
                        assert!(b.iter().sum::<f64>() == 1.0 && b.iter().all(|&x| x > 0.0), "{name}: {b:?}");
                        *inside.entry((p, b.map(f64::to_bits))).or_insert(0) += 1;
                    }
                }
            }
            let in_one = (steps - 1) * steps.saturating_sub(2) / 2;
            assert_eq!(inside.len(), base.patches.len() * in_one, "{name} at {tile_size}");
            assert!(inside.values().all(|&n| n == 1), "{name} at {tile_size}: a patch is covered twice");
            let diagonal = |a: ArcId| {
                atlas.tiles.iter().any(|t| t.second.is_some() && base.patches[t.first.patch][t.first.side].arc == a)
            };
            for a in base.arcs.ids() {
                for k in 1..steps {
                    let found = on_arcs.get(&(a, (k as f64 / steps as f64).to_bits())).copied();
                    assert_eq!(found, Some(if diagonal(a) { 1 } else { 2 }), "{name} at {tile_size}: {a}, step {k}");
                }
            }
            assert_eq!(on_arcs.len(), base.arcs.len() * (steps - 1), "{name} at {tile_size}");
            let alone = atlas.tiles.iter().filter(|tile| tile.second.is_none()).count();
            assert_eq!(landmarks, 4 * atlas.tiles.len() - alone, "{name} at {tile_size}");
        }
    }
}

#[test]
fn neighbouring_pixels_of_a_tile_are_neighbours_on_the_surface() {
    let base = from_triangles(6, &OCTAHEDRON);
    let corners = octahedron_corners();
    let atlas = atlas_of(&base, 17);
    let position = |pixel: Pixel| match atlas.sample(&base, pixel).expect("full tiles") {
        BaseSample::Landmark(l) => corners[l.index()],
        BaseSample::OnArc(a, s) => {
            let [p, q] = base.arcs[a].map(|l| corners[l.index()]);
            p.lerp(q, s)
        }
        BaseSample::InPatch(p, b) => {
            let at = base.corners(p).map(|l| corners[l.index()]);
            at[0] * b[0] + at[1] * b[1] + at[2] * b[2]
        }
    };
    let step = 2f64.sqrt() / 16.0;
    for y in 0..atlas.height() {
        for x in (0..atlas.width()).filter(|x| x % 17 != 0) {
            let here = position(Pixel { x, y });
            assert!((here.distance(position(Pixel { x: x - 1, y })) - step).abs() < 1e-12, "column {x}, row {y}");
            if y % 17 != 0 {
                assert!((here.distance(position(Pixel { x, y: y - 1 })) - step).abs() < 1e-12, "column {x}, row {y}");
            }
        }
    }
}

#[test]
fn rebuilt_meshes_are_closed_with_the_euler_characteristic_of_the_base_complex() {
    for (name, base, euler) in closed() {
        for tile_size in [2, 3, 5, 9, 33] {
            let atlas = atlas_of(&base, tile_size);
            let mesh = mesh_of(&bulged_image(&base, &atlas), &atlas, &base)
                .unwrap_or_else(|error| panic!("{name} at {tile_size}: {error}"));
            assert!(mesh.conn.boundary_loops().is_empty(), "{name} at {tile_size} is open");
            assert_eq!(mesh.conn.euler_characteristic(), euler, "{name} at {tile_size}");
            assert_eq!(mesh.conn.components().iter().max(), Some(&0), "{name} at {tile_size} falls apart");
            let regular = base.patches.len() * atlas.steps() * atlas.steps();
            if matches!(name, "tetrahedron" | "octahedron" | "icosahedron") || (name == "torus" && tile_size > 3) {
                assert_eq!(mesh.conn.face_count(), regular, "{name} at {tile_size} is split without need");
            }
        }
    }
}

/// Replaces an arc between two patches by the other diagonal of their quad; None if both sides are one patch.
fn flipped(base: &BaseComplex, a: ArcId) -> Option<BaseComplex> {
    let side_of = base.side_of();
    let [(p, k), (q, m)] = [side_of[2 * a.index()], side_of[2 * a.index() + 1]];
    if p == q {
        return None;
    }
    let (along_p, along_q) = (base.patches[p], base.patches[q]);
    let [p1, p2] = [along_p[(k + 1) % 3], along_p[(k + 2) % 3]];
    let [q1, q2] = [along_q[(m + 1) % 3], along_q[(m + 2) % 3]];
    let across = DirectedArc { arc: a, reversed: false };
    let mut next = base.clone();
    next.arcs[a] = [base.start(q2), base.start(p2)];
    next.patches[p] = [across, p2, q1];
    next.patches[q] = [across.flipped(), q2, p1];
    Some(next)
}

#[test]
fn every_complex_on_a_walk_of_random_flips_rebuilds_seed_7() {
    let mut draw = 7u64;
    let mut loops = 0;
    for (start, euler) in [(tetrahedron(), 2), (pillow(), 2), (from_triangles(6, &OCTAHEDRON), 2), (torus(), 0)] {
        let mut base = start;
        for step in 0..300 {
            draw = draw.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let a = ArcId::new((draw >> 33) as usize % base.arcs.len());
            let Some(next) = flipped(&base, a) else { continue };
            base = next;
            loops += base.arcs.iter().filter(|ends| ends[0] == ends[1]).count();
            let atlas = atlas_of(&base, [2, 3, 5, 9][step % 4]);
            let mesh = mesh_of(&bulged_image(&base, &atlas), &atlas, &base)
                .unwrap_or_else(|error| panic!("{base:?}: {error}"));
            assert!(mesh.conn.boundary_loops().is_empty() && mesh.conn.euler_characteristic() == euler, "{base:?}");
            assert_eq!(TileTable::new(&atlas, &base).parts().expect("sound"), (atlas, base.clone()));
        }
    }
    assert!(loops > 300, "the walk met only {loops} loops");
}

#[test]
fn an_open_base_complex_rebuilds_to_a_disc() {
    let base = complex(4, &[[0, 1], [1, 2], [2, 0], [2, 3], [3, 0]], &[[1, 2, 3], [-3, 4, 5]]);
    let atlas = atlas_of(&base, 9);
    assert_eq!(atlas.tiles.len(), 1);
    let mesh = mesh_of(&bulged_image(&base, &atlas), &atlas, &base).expect("a sound image");
    assert_eq!((mesh.conn.euler_characteristic(), mesh.conn.boundary_loops().len()), (1, 1));
    assert_eq!(mesh.conn.boundary_loops()[0].len(), 4 * 8);
}

#[test]
fn torn_borders_are_refused_by_pixel() {
    let base = tetrahedron();
    let atlas = atlas_of(&base, 5);
    let sound = bulged_image(&base, &atlas);
    let border = Pixel { x: 2, y: 0 };
    for value in [7.0, f32::NAN] {
        let mut torn = sound.clone();
        torn.planes[0].values[atlas.index(border)] = value;
        let error = mesh_of(&torn, &atlas, &base).expect_err("two tiles disagree");
        assert_eq!(error.kind, ErrorKind::Input);
        assert!(error.element.contains("column"), "{error}");
    }
    let other = atlas_of(&base, 9);
    assert_eq!(mesh_of(&sound, &other, &base).expect_err("another size").kind, ErrorKind::Input);
}

#[test]
fn costs_choose_the_diagonals() {
    let base = from_triangles(6, &OCTAHEDRON);
    let equator: Vec<ArcId> =
        base.arcs.iter_ids().filter(|(_, ends)| ends.iter().all(|l| l.0 < 4)).map(|(a, _)| a).collect();
    assert_eq!(equator.len(), 4);
    let cost = base.arcs.ids().map(|a| if equator.contains(&a) { -1.0 } else { 0.0 }).collect::<IdVec<ArcId, f64>>();
    let atlas = Atlas::new(&base, 5, Some(&cost)).expect("allowed size");
    for tile in &atlas.tiles {
        assert!(equator.contains(&base.patches[tile.first.patch][tile.first.side].arc));
    }
}

#[test]
fn tile_sizes_must_be_a_power_of_two_plus_one() {
    for size in [0, 1, 4, 64, 66, 100, usize::MAX] {
        let error = Atlas::new(&tetrahedron(), size, None).expect_err("not a power of two plus one");
        assert_eq!(error.kind, ErrorKind::Usage, "{size}");
    }
    assert_eq!(Atlas::new(&tetrahedron(), (1 << 20) + 1, None).expect_err("too large").kind, ErrorKind::Usage);
}

#[test]
fn pixels_outside_the_mask_take_a_nearest_one_of_their_tile() {
    let base = three_lobes();
    let atlas = atlas_of(&base, 9);
    let mut outside = 0;
    for y in 0..atlas.height() {
        for x in 0..atlas.width() {
            let pixel = Pixel { x, y };
            let nearest = atlas.nearest_inside(pixel);
            assert!(atlas.sample(&base, nearest).is_some(), "{pixel:?} takes {nearest:?}");
            if atlas.sample(&base, pixel).is_some() {
                assert_eq!(nearest, pixel);
                continue;
            }
            outside += 1;
            let (left, top) = (x - x % 9, y - y % 9);
            let distance_sq = |p: Pixel| p.x.abs_diff(x).pow(2) + p.y.abs_diff(y).pow(2);
            let own = (0..81).map(|i| Pixel { x: left + i % 9, y: top + i / 9 });
            let best = own.filter(|&p| atlas.sample(&base, p).is_some()).map(distance_sq).min();
            if let Some(best) = best {
                assert_eq!((distance_sq(nearest), nearest.x - nearest.x % 9), (best, left), "{pixel:?}");
            }
        }
    }
    assert_eq!(outside, 2 * 9 * 8 / 2, "two patches stand alone in six tiles of three by two");
}

#[test]
fn empty_places_of_the_grid_are_filled() {
    let base = icosahedron();
    let atlas = atlas_of(&base, 5);
    assert_eq!((atlas.tiles.len(), atlas.columns, atlas.rows), (10, 4, 3));
    assert_eq!(atlas.nearest_inside(Pixel { x: 10, y: 14 }), Pixel { x: 9, y: 14 });
    assert_eq!(atlas.nearest_inside(Pixel { x: 19, y: 11 }), Pixel { x: 19, y: 9 });
}

#[test]
fn tile_tables_survive_json_and_refuse_contradictions() {
    for (name, base, _) in closed() {
        let atlas = atlas_of(&base, 5);
        let text = serde_json::to_string(&TileTable::new(&atlas, &base)).expect("plain data");
        let table: TileTable = serde_json::from_str(&text).expect("our own text");
        assert_eq!(table.parts().expect(name), (atlas, base), "{name}");
    }
    let base = icosahedron();
    let sound = TileTable::new(&atlas_of(&base, 5), &base);
    let damages: [fn(&mut TileTable); 9] = [
        |t| t.tile_size = 6,
        |t| t.columns = 0,
        |t| t.rows = usize::MAX,
        |t| t.tiles[0].first.patch = 19,
        |t| t.tiles[0].first.side = 3,
        |t| t.tiles[0].first.side = (t.tiles[0].first.side + 1) % 3,
        |t| t.tiles[0].first.corners[1] = u32::MAX,
        |t| t.tiles[2].first.arcs[0].arc = u32::MAX,
        |t| t.tiles[2].first.arcs[0].reversed ^= true,
    ];
    for (i, damage) in damages.iter().enumerate() {
        let mut table = sound.clone();
        damage(&mut table);
        assert_eq!(table.parts().expect_err("damaged").kind, ErrorKind::Input, "damage {i}");
    }
}

#[test]
fn patch_ids_are_the_order_of_tiles() {
    for (name, base, _) in closed() {
        let atlas = atlas_of(&base, 3);
        let firsts: Vec<PatchId> = atlas.tiles.iter().map(|tile| tile.first.patch).collect();
        assert!(firsts.is_sorted(), "{name}");
        assert!(atlas.tiles.iter().all(|t| t.second.is_none_or(|second| t.first.patch < second.patch)), "{name}");
        assert_eq!(atlas, atlas_of(&base, 3), "{name}");
    }
}
