//! The diffusion parametrization: exact where fronts are straight, borders that agree, look-ups both ways, folds repaired,
//! equal regions mapped onto each other.

mod common;

use common::mesh::{grid, jittered, lattice, sphere};
use glam::{DVec2, DVec3};
use homeo::app::diffusion::{
    Diffusion, DiffusionOptions, Lookup, Piece, correspond, diffuse, diffuse_like, segment, split_ends,
};
use homeo::mesh::io::{Region, Regions};
use homeo::mesh::{FaceId, TriMesh, VertexId};
use homeo::path::side_front::{FrontGraph, Travel};
use homeo::shape::{Quadruped, SplitMix, fixture, quadruped};
use std::collections::{HashMap, HashSet};
use std::f64::consts::FRAC_PI_2;

const FACES: DiffusionOptions = DiffusionOptions { travel: Travel::Faces, repair: false };
const EDGES: DiffusionOptions = DiffusionOptions { travel: Travel::Edges, repair: false };
const REPAIRED: DiffusionOptions = DiffusionOptions { travel: Travel::Faces, repair: true };

/// The rectangle of `n` by `m` squares, of which inner vertices are moved about in the plane.
fn uneven_rectangle(n: usize, m: usize, seed: u64) -> TriMesh {
    let mut mesh = grid(n, m);
    let mut random = SplitMix::new(seed);
    for p in &mut mesh.positions.raw {
        let inner = p.x > 0.0 && p.y > 0.0 && p.x < n as f64 && p.y < m as f64;
        let step = DVec3::new(random.unit() - 0.5, random.unit() - 0.5, 0.0);
        *p += step * if inner { 0.4 } else { 0.0 };
    }
    mesh
}

/// One region whose sides are those of a grid of `n` by `m` squares.
fn one_region(mesh: &TriMesh, n: usize, m: usize) -> Regions {
    let at = |i: usize, j: usize| VertexId((j * (n + 1) + i) as u32);
    let [u0, u1] = [0, n].map(|i| (0..=m).map(|j| at(i, j)).collect());
    let [v0, v1] = [0, m].map(|j| (0..=n).map(|i| at(i, j)).collect());
    let list = vec![Region { name: "all".into(), sides: Some([u0, u1, v0, v1]) }];
    Regions { list, of_triangle: vec![0; mesh.conn.face_count()], ..Regions::default() }
}

/// Regions by a name for the middle of every face.
fn named(mesh: &TriMesh, name: impl Fn(DVec3) -> String) -> Regions {
    let mut regions = Regions::default();
    for f in mesh.conn.faces() {
        let name = name(mesh.triangle(f).iter().sum::<DVec3>() / 3.0);
        let known = regions.list.iter().position(|r| r.name == name);
        let number = known.unwrap_or_else(|| {
            regions.list.push(Region { name, sides: None });
            regions.list.len() - 1
        });
        regions.of_triangle.push(number as u32);
    }
    regions
}

/// The part of a sphere on one side of all three coordinate planes.
fn octant(p: DVec3) -> String {
    [p.x, p.y, p.z].map(|x| if x > 0.0 { '+' } else { '-' }).iter().collect()
}

fn bull() -> TriMesh {
    quadruped(Quadruped::Bull, 3000).mesh
}

fn worst(piece: &Piece, expected: impl Fn(VertexId) -> DVec2) -> f64 {
    let off = |(i, &v): (usize, &VertexId)| (piece.uv(i) - expected(v)).abs().max_element();
    piece.disc.vertices.iter().enumerate().map(off).fold(0.0, f64::max)
}

/// Fronts that are straight lines go across faces exactly, whatever the triangles.
#[test]
fn a_rectangle_has_u_and_v_proportional_to_x_and_y() {
    for seed in 1..=3 {
        let mesh = uneven_rectangle(40, 25, seed);
        let diffusion = diffuse(&mesh, one_region(&mesh, 40, 25), FACES).expect("a disc with four sides");
        let expected = |v: VertexId| mesh.positions[v].truncate() / DVec2::new(40.0, 25.0);
        let error = worst(&diffusion.pieces[0], expected);
        assert!(error < 1e-6, "seed {seed}: {error}");
        let by_edges = diffuse(&mesh, one_region(&mesh, 40, 25), EDGES).expect("the same");
        assert!(worst(&by_edges.pieces[0], expected) > 1e-3, "edges do not run along the fronts");
        let [face, edge] = [&diffusion, &by_edges].map(|d| &d.quality[0]);
        assert!(face.folds.is_empty() && face.jitter < 1e-3 && edge.jitter > 0.02, "{} {}", face.jitter, edge.jitter);
        assert!((face.measures.e_l2 - 1.0).abs() < 1e-6, "an isometry up to scale: {}", face.measures.e_l2);
    }
}

/// Sides may be left-handed, and leave corners out: then those are in the middle of the gaps.
#[test]
fn given_sides_may_be_mirrored_and_have_gaps() {
    let mesh = grid(6, 6);
    let mut regions = one_region(&mesh, 6, 6);
    let sides = regions.list[0].sides.as_mut().expect("sides are given");
    sides.swap(0, 1);
    sides.iter_mut().for_each(|side| *side = side[1..side.len() - 1].to_vec());
    let diffusion = diffuse(&mesh, regions.clone(), FACES).expect("a disc with four sides");
    let expected = |v: VertexId| DVec2::new(6.0 - mesh.positions[v].x, mesh.positions[v].y) / 6.0;
    assert!(worst(&diffusion.pieces[0], expected) < 1e-6);
    assert!(diffusion.pieces[0].mirrored && diffusion.quality[0].folds.is_empty());
    let like = diffuse_like(&diffusion, &mesh, regions, FACES).expect("the same sides");
    let there = correspond(&diffusion, &like);
    assert!(mesh.conn.vertices().all(|v| there.positions[v].distance(mesh.positions[v]) < 1e-6));
    let error = diffuse_like(&diffusion, &mesh, one_region(&mesh, 6, 6), FACES).expect_err("the other way round");
    assert!(error.kind == homeo::ErrorKind::Unsolvable && error.to_string().contains("\"all\""), "{error}");
}

/// A rolled rectangle is as flat inside as the rectangle.
#[test]
fn a_cylinder_segment_unrolls() {
    let (n, m) = (48, 20);
    let mut mesh = grid(n, m);
    let angle = |x: f64| 1.3 * FRAC_PI_2 * x / n as f64;
    mesh.positions.raw.iter_mut().for_each(|p| *p = DVec3::new(angle(p.x).cos(), angle(p.x).sin(), 0.05 * p.y));
    let diffusion = diffuse(&mesh, one_region(&mesh, n, m), FACES).expect("a disc with four sides");
    let share = |v: VertexId| {
        DVec2::new((v.0 as usize % (n + 1)) as f64 / n as f64, (v.0 as usize / (n + 1)) as f64 / m as f64)
    };
    let error = worst(&diffusion.pieces[0], share);
    assert!(error < 1e-6, "{error}");
}

/// ```text
///   /\/\/\/\    steps of length 1 rise by 0.866: the distance along edges is 1.155 times the true one at any resolution
/// ```
#[test]
fn edges_measure_the_graph_and_faces_the_surface() {
    for size in [8, 32] {
        let mesh = lattice(size, size);
        let triangles: Vec<[u32; 3]> = mesh.faces().iter().map(|t| t.map(|v| v.0)).collect();
        let graph = FrontGraph::new(&mesh.positions.raw, &triangles);
        let bottom: Vec<u32> = (0..=size as u32).collect();
        let middle = size / 2 * (size + 1) + size / 2;
        let height = mesh.positions.raw[middle].y;
        let [edges, faces] = [Travel::Edges, Travel::Faces].map(|travel| graph.distances(&bottom, travel)[middle]);
        assert!((edges / height - 2.0 / 3.0f64.sqrt()).abs() < 1e-9, "{edges} for {height}");
        assert!((faces / height - 1.0).abs() < 1e-9, "{faces} for {height}");
    }
}

/// Around a corner fronts are circles: the error of faces falls with the edge length, that of edges stays.
#[test]
fn round_fronts_converge_across_faces() {
    let errors = |travel: Travel| {
        [16usize, 64].map(|n| {
            let mesh = grid(n, n);
            let triangles: Vec<[u32; 3]> = mesh.faces().iter().map(|t| t.map(|v| v.0)).collect();
            let distances = FrontGraph::new(&mesh.positions.raw, &triangles).distances(&[0], travel);
            let error = |(d, p): (&f64, &DVec3)| (d - p.length()).abs() / n as f64;
            distances.iter().zip(mesh.positions.iter()).map(error).fold(0.0, f64::max)
        })
    };
    let ([coarse, fine], [_, edges]) = (errors(Travel::Faces), errors(Travel::Edges));
    assert!(fine < 0.5 * coarse && fine < 0.012, "{coarse} {fine}");
    assert!(edges > 0.08, "{edges}");
}

#[test]
fn coordinates_lie_in_the_square_and_borders_agree() {
    let mesh = bull();
    for options in [FACES, EDGES, REPAIRED] {
        let regions = segment(&mesh, 14).expect("the bull can be divided");
        let diffusion = diffuse(&mesh, regions, options).expect("discs");
        assert_eq!(diffusion.pieces.len(), 14);
        for piece in &diffusion.pieces {
            assert!(piece.st.iter().all(|p| p.cmpge(DVec2::ZERO).all() && p.cmple(DVec2::ONE).all()), "{}", piece.name);
            for (k, side) in piece.sides.iter().enumerate() {
                let (axis, value) = [(1, 0.0), (0, 1.0), (1, 1.0), (0, 0.0)][k];
                assert!(side.vertices.iter().all(|&v| piece.st[v as usize][axis] == value), "{} {k}", piece.name);
                assert!(side.shares.windows(2).all(|w| w[0] < w[1]), "{} {k}", piece.name);
            }
        }
        assert!(compare_borders(&diffusion) > 100);
    }
}

/// Along a border the steps of both regions have one ratio; returns how many places were compared.
fn compare_borders(diffusion: &Diffusion) -> usize {
    let mesh = diffusion.mesh;
    let tables: Vec<HashMap<VertexId, usize>> =
        diffusion.pieces.iter().map(|p| p.disc.vertices.iter().copied().zip(0..).collect()).collect();
    let corners: HashSet<VertexId> =
        diffusion.pieces.iter().flat_map(|p| p.sides.iter().map(|s| p.disc.vertices[s.vertices[0] as usize])).collect();
    let mut compared = 0;
    for (r, piece) in diffusion.pieces.iter().enumerate() {
        for w in piece.disc.rim.windows(2) {
            let [a, b, c] = [mesh.conn.from(w[0]), mesh.conn.from(w[1]), mesh.conn.to(w[1])];
            let others: Vec<usize> = (0..tables.len()).filter(|&q| q != r && tables[q].contains_key(&b)).collect();
            let [q] = others[..] else { continue };
            if corners.contains(&b) || !tables[q].contains_key(&a) || !tables[q].contains_key(&c) {
                continue;
            }
            let ratio = |q: usize| {
                let at = |v: VertexId| diffusion.pieces[q].st[tables[q][&v]];
                at(a).distance(at(b)) / at(b).distance(at(c))
            };
            assert!((ratio(r) / ratio(q) - 1.0).abs() < 1e-6, "{} at {b}: {} {}", piece.name, ratio(r), ratio(q));
            compared += 1;
        }
    }
    compared
}

#[test]
fn look_ups_go_there_and_back() {
    let mesh = bull();
    let regions = segment(&mesh, 14).expect("the bull can be divided");
    let diffusion = diffuse(&mesh, regions, REPAIRED).expect("discs");
    let lookup = Lookup::new(&mesh, &diffusion.pieces);
    for v in mesh.conn.vertices() {
        let place = lookup.place(v).expect("every vertex is in a region");
        let found = lookup.point(place);
        let piece = &diffusion.pieces[place.region];
        let corners = piece.disc.triangles[found.triangle];
        let uv: DVec2 = corners.iter().zip(found.weights).map(|(&v, w)| piece.uv(v as usize) * w).sum();
        assert!(uv.distance(place.uv) < 1e-7, "{v}: {uv} for {}", place.uv);
        if diffusion.quality[place.region].pinned.is_empty() {
            let there = lookup.surface_point(place).position(&mesh);
            assert!(there.distance(mesh.positions[v]) < 1e-6 * mesh.diagonal(), "{v}");
        }
    }
}

/// Limbs fold: the fronts from both sides of a foot meet.
#[test]
fn folds_are_counted_and_repaired() {
    let mesh = bull();
    let regions = segment(&mesh, 14).expect("the bull can be divided");
    let folded = diffuse(&mesh, regions.clone(), FACES).expect("discs");
    let repaired = diffuse(&mesh, regions, REPAIRED).expect("discs");
    let count = |d: &Diffusion| d.quality.iter().map(|q| q.folds.len() + q.flat.len()).sum::<usize>();
    assert!(count(&folded) > 20, "{}", count(&folded));
    assert_eq!(count(&repaired), 0);
    for (k, piece) in repaired.pieces.iter().enumerate() {
        let had = folded.quality[k].folds.len() + folded.quality[k].flat.len();
        assert_eq!(piece.repaired, had > 0, "{}: only what folds is embedded anew", piece.name);
    }
}

/// DIFFUSION 3 shows jitter; fronts across faces have less of it in every region, and less stretch in most.
#[test]
fn faces_give_less_jitter_and_stretch_than_edges() {
    let mesh = bull();
    let regions = segment(&mesh, 16).expect("the bull can be divided");
    let by_faces = diffuse(&mesh, regions.clone(), FACES).expect("discs");
    let by_edges = diffuse(&mesh, regions, EDGES).expect("discs");
    let mut less_stretched = 0;
    for (piece, (face, edge)) in by_faces.pieces.iter().zip(by_faces.quality.iter().zip(&by_edges.quality)) {
        let numbers = [face.jitter, edge.jitter, face.measures.e_l2, edge.measures.e_l2];
        println!("{} folds {} {} {numbers:.3?}", piece.name, face.folds.len(), edge.folds.len());
        assert!(face.jitter < edge.jitter, "{}: {numbers:?}", piece.name);
        assert!(face.measures.e_l2 < 1.01 * edge.measures.e_l2, "{}: {numbers:?}", piece.name);
        less_stretched += usize::from(face.measures.e_l2 < edge.measures.e_l2);
    }
    assert!(less_stretched >= 14, "of 16 regions {less_stretched} are less stretched");
}

#[test]
fn segmentations_have_the_wanted_number_of_discs() {
    for (mesh, least) in [(fixture::icosphere(3), 2), (fixture::torus(40, 20), 7), (fixture::two_spheres(2), 4)] {
        for count in [least, 8, 20] {
            let regions = segment(&mesh, count).expect("it can be divided");
            assert_eq!(regions.list.len(), count);
            let diffusion = diffuse(&mesh, regions, FACES).expect("all are discs");
            assert_eq!(diffusion.pieces.iter().map(|p| p.disc.faces.len()).sum::<usize>(), mesh.conn.face_count());
        }
        assert_eq!(segment(&mesh, 1).expect_err("a closed surface is no disc").kind, homeo::ErrorKind::Unsolvable);
    }
}

/// ```text
///  rings in the plane: no disc, but halves of it are
/// ```
#[test]
fn tubes_and_ends_are_divided_lengthwise() {
    let ring = fixture::annulus(24, 6);
    let whole = named(&ring, |_| "ring".into());
    let error = diffuse(&ring, whole.clone(), FACES).expect_err("two borders");
    assert!(error.to_string().contains("\"ring\"") && error.to_string().contains("2 borders"), "{error}");
    let (halves, _) = split_ends(&ring, &whole, None);
    let diffusion = diffuse(&ring, halves, FACES).expect("two discs");
    let names: Vec<&str> = diffusion.pieces.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["ring a", "ring b"]);
    assert!(diffusion.pieces.iter().all(|p| p.disc.faces.len() > ring.conn.face_count() / 3));

    let ball = sphere(24, 32);
    let caps = named(&ball, |p| if p.z > 0.5 { "top".into() } else { "rest".into() });
    let (halves, ends) = split_ends(&ball, &caps, None);
    assert_eq!(ends.len(), 2, "both have one neighbour all around");
    assert_eq!(diffuse(&ball, halves, FACES).expect("four discs").pieces.len(), 4);
}

/// The same shape turned, moved and scaled corresponds to itself.
#[test]
fn a_similar_mesh_is_mapped_onto_itself() {
    let mesh = bull();
    let mut other = mesh.clone();
    other.positions.raw.iter_mut().for_each(|p| *p = *p * 2.5 + DVec3::new(1.0, -3.0, 0.5));
    let regions = segment(&mesh, 14).expect("the bull can be divided");
    let first = diffuse(&mesh, regions.clone(), REPAIRED).expect("discs");
    let second = diffuse_like(&first, &other, regions, REPAIRED).expect("the same regions");
    let map = correspond(&first, &second);
    let rims: HashSet<VertexId> = first.pieces.iter().flat_map(|p| &p.disc.rim).map(|&h| mesh.conn.from(h)).collect();
    let pinned: HashSet<FaceId> = first.quality.iter().flat_map(|q| &q.pinned).copied().collect();
    let inside: HashSet<VertexId> = pinned.iter().flat_map(|&f| mesh.face(f)).filter(|v| !rims.contains(v)).collect();
    for v in mesh.conn.vertices().filter(|v| !inside.contains(v)) {
        let off = map.positions[v].distance(other.positions[v]) / other.diagonal();
        assert!(off < 1e-6, "{v}: {off}");
    }
}

/// Octants of two spheres have three neighbours each: the longest side is split, on the second mesh where it is on the first.
#[test]
fn spheres_of_other_triangles_are_mapped_by_their_octants() {
    let spheres = [fixture::icosphere(4), sphere(47, 64)];
    let first = diffuse(&spheres[0], named(&spheres[0], octant), REPAIRED).expect("octants are discs");
    assert_eq!(first.completions.len(), 8);
    let second = diffuse_like(&first, &spheres[1], named(&spheres[1], octant), REPAIRED).expect("the same octants");
    let map = correspond(&first, &second);
    let off: Vec<f64> =
        spheres[0].conn.vertices().map(|v| map.positions[v].distance(spheres[0].positions[v]) / 2.0).collect();
    let mean = off.iter().sum::<f64>() / off.len() as f64;
    assert!(mean < 0.02, "mean error {mean} of the diameter");
    let back = correspond(&second, &first);
    assert!(back.image.iter().all(Option::is_some));
}

#[test]
fn noise_does_not_change_which_regions_correspond() {
    let ball = fixture::icosphere(3);
    let rough = jittered(&ball, 0.01, 4);
    let first = diffuse(&ball, named(&ball, octant), REPAIRED).expect("octants are discs");
    let labels = Regions { path: "rough.csv".into(), ..first.regions.clone() };
    let second = diffuse_like(&first, &rough, labels, REPAIRED).expect("the same regions");
    let map = correspond(&first, &second);
    for v in ball.conn.vertices() {
        assert!(map.positions[v].distance(rough.positions[v]) < 0.05, "{v}");
    }
}

#[test]
fn other_arrangements_are_refused_with_a_name() {
    let ball = fixture::icosphere(3);
    let first = diffuse(&ball, named(&ball, octant), FACES).expect("octants are discs");
    let fails = |name: &dyn Fn(DVec3) -> String, word: &str| {
        let error = diffuse_like(&first, &ball, named(&ball, name), FACES).expect_err("another arrangement");
        assert_eq!(error.kind, homeo::ErrorKind::Unsolvable, "{error}");
        assert!(error.to_string().contains(word), "{error}");
    };
    let swapped = |p: DVec3| match octant(p).as_str() {
        "+++" => "---".to_owned(),
        "---" => "+++".to_owned(),
        other => other.to_owned(),
    };
    fails(&swapped, "\"+++\"");
    fails(&|p| if p.x > 0.0 && p.y > 0.0 { "+++".into() } else { octant(p) }, "\"++-\"");
    fails(&|p| octant(DVec3::new(-p.x, p.y, p.z)), "\"");
}

/// Edges without length, triangles without area.
#[test]
fn degenerate_triangles_do_no_harm() {
    for t in [0.0, 1e-9] {
        let mesh = fixture::needles(&fixture::icosphere(3), 60, t);
        let regions = segment(&mesh, 9).expect("a ball can be divided");
        let diffusion = diffuse(&mesh, regions, REPAIRED).expect("discs");
        for (piece, quality) in diffusion.pieces.iter().zip(&diffusion.quality) {
            assert!(piece.st.iter().all(|p| p.is_finite()), "{}", piece.name);
            assert!(quality.jitter.is_finite() && quality.measures.e_l2.is_finite(), "{}", piece.name);
        }
        let there = correspond(&diffusion, &diffusion);
        assert!(there.positions.iter().all(|p| p.is_finite()));
    }
}
