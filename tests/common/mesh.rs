//! Small meshes by property.

use glam::DVec3;
use homeo::mesh::{Connectivity, FaceId, Id, TriMesh, VertexId, corner};
use homeo::shape::SplitMix;
use homeo::shape::fixture::tetrahedron;
use std::f64::consts::{PI, TAU};

/// A mesh from plain numbers.
pub fn mesh(positions: Vec<DVec3>, faces: &[[usize; 3]]) -> TriMesh {
    let faces: Vec<_> = faces.iter().map(|f| f.map(VertexId::new)).collect();
    TriMesh::new(positions, &faces).expect("fixtures are manifolds")
}

/// Vertices by number.
pub fn vertices(numbers: &[usize]) -> Vec<VertexId> {
    numbers.iter().map(|&v| VertexId::new(v)).collect()
}

/// Six vertices, eight faces; vertices 0 and 1 are the poles.
pub fn octahedron() -> TriMesh {
    revolution(&[(0.0, -1.0), (1.0, 0.0), (0.0, 1.0)], 4)
}

/// A plane grid of `n` by `m` squares with side 1, each cut along a diagonal; vertex (i, j) is number `j (n + 1) + i`.
pub fn grid(n: usize, m: usize) -> TriMesh {
    let positions = (0..=m).flat_map(|j| (0..=n).map(move |i| DVec3::new(i as f64, j as f64, 0.0))).collect();
    let at = |i: usize, j: usize| j * (n + 1) + i;
    let square = |i: usize, j: usize| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        if (i + j).is_multiple_of(2) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
    };
    let faces: Vec<_> = (0..m).flat_map(|j| (0..n).flat_map(move |i| square(i, j))).collect();
    mesh(positions, &faces)
}

/// A plane lattice of `n` by `m` rhombi of equilateral triangles with side 1.
pub fn lattice(n: usize, m: usize) -> TriMesh {
    let point = |i: usize, j: usize| DVec3::new(i as f64 + 0.5 * j as f64, 0.75f64.sqrt() * j as f64, 0.0);
    let positions = (0..=m).flat_map(|j| (0..=n).map(move |i| point(i, j))).collect();
    let at = |i: usize, j: usize| j * (n + 1) + i;
    let rhombus =
        |i: usize, j: usize| [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]];
    let faces: Vec<_> = (0..m).flat_map(|j| (0..n).flat_map(move |i| rhombus(i, j))).collect();
    mesh(positions, &faces)
}

/// A torus with `n` vertices the long and `m` the short way around.
pub fn torus(n: usize, m: usize) -> TriMesh {
    let point = |i: usize, j: usize| {
        let (a, b) = (TAU * i as f64 / n as f64, TAU * j as f64 / m as f64);
        let r = 3.0 + b.cos();
        DVec3::new(r * a.cos(), r * a.sin(), b.sin())
    };
    let positions = (0..n).flat_map(|i| (0..m).map(move |j| point(i, j))).collect();
    let at = |i: usize, j: usize| (i % n) * m + j % m;
    let quad = |i: usize, j: usize| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    let faces: Vec<_> = (0..n).flat_map(|i| (0..m).flat_map(move |j| quad(i, j))).collect();
    mesh(positions, &faces)
}

/// A closed surface of revolution about z from a profile of (radius, height), upwards; only its two ends have radius 0.
///
/// Vertex 0 is the lower end, vertex 1 the upper one.
pub fn revolution(profile: &[(f64, f64)], around: usize) -> TriMesh {
    let rings = profile.len() - 2;
    let mut positions = vec![DVec3::new(0.0, 0.0, profile[0].1), DVec3::new(0.0, 0.0, profile[rings + 1].1)];
    for (k, &(r, z)) in profile[1..=rings].iter().enumerate() {
        let turn = |i: usize| TAU * (i as f64 + 0.5 * (k % 2) as f64) / around as f64;
        positions.extend((0..around).map(|i| DVec3::new(r * turn(i).cos(), r * turn(i).sin(), z)));
    }
    let at = |k: usize, i: usize| 2 + k * around + i % around;
    let mut faces = Vec::new();
    for i in 0..around {
        faces.push([0, at(0, i + 1), at(0, i)]);
        faces.push([1, at(rings - 1, i), at(rings - 1, i + 1)]);
        for k in 0..rings - 1 {
            let [a, b, c, d] = [at(k, i), at(k, i + 1), at(k + 1, i + 1), at(k + 1, i)];
            faces.extend(if k % 2 == 0 { [[a, b, d], [b, c, d]] } else { [[a, b, c], [a, c, d]] });
        }
    }
    mesh(positions, &faces)
}

/// A unit sphere with `around` vertices on each of `rings` circles of latitude.
pub fn sphere(rings: usize, around: usize) -> TriMesh {
    let angle = |k: usize| PI * k as f64 / (rings + 1) as f64;
    let profile: Vec<_> = (0..=rings + 1).map(|k| (angle(k).sin().max(0.0), -angle(k).cos())).collect();
    revolution(&profile, around)
}

/// A ball of radius 1 with a limb at its top whose length is `ratio` times its circumference; vertex 1 is the tip.
pub fn limb(ratio: f64, around: usize) -> TriMesh {
    const RADIUS: f64 = 0.2;
    let root = (1.0 - RADIUS * RADIUS).sqrt();
    let ball = (PI - RADIUS.asin(), around);
    let mut profile: Vec<_> =
        (0..=ball.1).map(|k| ball.0 * k as f64 / ball.1 as f64).map(|a| (a.sin(), -a.cos())).collect();
    let step = TAU * RADIUS / around as f64;
    let steps = (ratio * around as f64).ceil() as usize;
    profile.extend((1..=steps).map(|k| (RADIUS, root + step * k as f64)));
    let top = root + step * steps as f64;
    let cap = (around / 4).max(2);
    let tilt = |k: usize| 0.5 * PI * k as f64 / cap as f64;
    profile.extend((1..cap).map(|k| (RADIUS * tilt(k).cos(), top + RADIUS * tilt(k).sin())));
    profile.push((0.0, top + RADIUS));
    profile[0].0 = 0.0;
    revolution(&profile, around)
}

/// The same surface with every vertex moved by up to `amount`.
pub fn jittered(mesh: &TriMesh, amount: f64, seed: u64) -> TriMesh {
    let mut random = SplitMix::new(seed);
    let mut moved = mesh.clone();
    for p in &mut moved.positions.raw {
        *p += amount * DVec3::from([(); 3].map(|()| 2.0 * random.unit() - 1.0));
    }
    moved
}

/// The same mesh with faces in another order, each turned to start at another corner; also where each face came from.
pub fn permuted(original: &TriMesh, seed: u64) -> (TriMesh, Vec<FaceId>) {
    let mut random = SplitMix::new(seed);
    let mut order: Vec<FaceId> = original.conn.faces().collect();
    for i in (1..order.len()).rev() {
        order.swap(i, random.below(i + 1));
    }
    let turned = |&f: &FaceId| {
        let mut corners = original.face(f);
        corners.rotate_left(random.below(3));
        corners
    };
    let faces: Vec<_> = order.iter().map(turned).collect();
    (TriMesh::new(original.positions.raw.clone(), &faces).expect("the same manifold"), order)
}

/// A tetrahedron whose edges and faces were split at random `splits` times, every vertex somewhere on the unit sphere's
/// neighbourhood: closed, with very uneven triangles and vertices of every degree.
pub fn crumpled(splits: usize, seed: u64) -> TriMesh {
    let mut random = SplitMix::new(seed);
    let TriMesh { mut conn, mut positions } = tetrahedron();
    for _ in 0..splits {
        let h = corner(FaceId::new(random.below(conn.face_count())), random.below(3));
        let [a, b] = [conn.from(h), conn.to(h)].map(|v| positions[v]);
        let middle = if random.unit() < 0.5 {
            split_edge(&mut conn, h);
            (a + b) * 0.5
        } else {
            let f = homeo::mesh::face_of(h);
            let centre = conn.face(f).iter().map(|&v| positions[v]).sum::<DVec3>() / 3.0;
            conn.split_face(f);
            centre
        };
        let out = middle.normalize_or(DVec3::Z) * (1.0 + 0.3 * random.unit());
        positions.push(middle + (out - middle) * random.unit());
    }
    TriMesh { conn, positions }
}

fn split_edge(conn: &mut Connectivity, h: homeo::mesh::HalfedgeId) {
    conn.split_edge(h);
}

/// `n` different vertices without any order, near each other as often as not.
pub fn any_vertices(mesh: &TriMesh, n: usize, seed: u64) -> Vec<VertexId> {
    let mut random = SplitMix::new(seed);
    let mut all: Vec<VertexId> = mesh.conn.vertices().collect();
    for i in 0..n.min(all.len()) {
        let j = i + random.below(all.len() - i);
        all.swap(i, j);
    }
    all.truncate(n);
    all
}

/// The `n` vertices nearest to `seed` along edges, in order of discovery: `seed`, its ring, and so on.
pub fn crowd(mesh: &TriMesh, seed: VertexId, n: usize) -> Vec<VertexId> {
    let mut found = vec![seed];
    let mut at = 0;
    while found.len() < n && at < found.len() {
        let ring: Vec<_> = mesh.conn.outgoing(found[at]).map(|h| mesh.conn.to(h)).collect();
        for v in ring {
            if !found.contains(&v) && found.len() < n {
                found.push(v);
            }
        }
        at += 1;
    }
    found
}
