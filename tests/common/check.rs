//! Checkers of invariants; each panics with the offending element.

use homeo::map::certificate::certify;
use homeo::map::embedding::Embedding;
use homeo::map::surface_map::SurfaceMap;
use homeo::mesh::{Connectivity, FaceId, Id, LandmarkId, TriMesh, corner, metric, next};
use homeo::path::base_complex::BaseComplex;
use homeo::path::cut_mesh::CutMesh;
use homeo::path::network::rotation;
use homeo::stage::layout::Layout;

/// Twins pair up and run against each other, every vertex has one fan, and the half-edge it names leaves it with, on
/// the boundary, nothing at its right.
pub fn manifold(conn: &Connectivity) {
    let mut degree = vec![0; conn.vertex_count()];
    for h in conn.halfedges() {
        degree[conn.from(h).index()] += 1;
        assert_ne!(conn.from(h), conn.to(h), "{h} is a loop");
        assert_eq!(conn.to(h), conn.from(next(h)));
        if let Some(t) = conn.twin(h) {
            assert_eq!(conn.twin(t), Some(h), "twin of the twin of {h}");
            assert_eq!([conn.from(t), conn.to(t)], [conn.to(h), conn.from(h)], "ends of the twin of {h}");
        } else {
            assert_eq!(conn.leaving(conn.from(h)), Some(h), "the boundary half-edge {h} leads its fan");
        }
    }
    for v in conn.vertices() {
        assert!(conn.leaving(v).is_none_or(|h| conn.from(h) == v), "{v} names a half-edge that leaves another vertex");
        assert_eq!(conn.outgoing(v).count(), degree[v.index()], "the fan of {v} is complete");
    }
}

/// The cut mesh is a manifold that covers the mesh: every vertex on the original face of every face around it, none of
/// them turned over, the same area.
pub fn cut_mesh(cut: &CutMesh, mesh: &TriMesh) {
    manifold(&cut.conn);
    let mut parts = vec![0.0; mesh.conn.face_count()];
    for f in cut.conn.faces() {
        let corners = cut.corner_coordinates(mesh, f);
        for b in corners {
            assert!(b.iter().all(|&x| x >= 0.0), "a corner of {f} at {b:?}");
            assert!((b.iter().sum::<f64>() - 1.0).abs() < 1e-12, "a corner of {f} at {b:?}");
        }
        let share = determinant(corners);
        assert!(share > -1e-12, "{f} is turned over: {share}");
        parts[cut.face_origin[f].index()] += share;
    }
    for (f, sum) in parts.iter().enumerate() {
        assert!((sum - 1.0).abs() < 1e-9, "{} is covered {sum} times", FaceId::new(f));
    }
    for (v, point) in cut.origin.iter_ids() {
        assert!(cut.positions[v].distance(point.position(mesh)) <= 1e-12 * mesh.diagonal(), "{v} is off its origin");
    }
    for v in mesh.conn.vertices() {
        assert_eq!(cut.positions[v], mesh.positions[v], "{v} moved");
    }
}

fn determinant([a, b, c]: [[f64; 3]; 3]) -> f64 {
    let minor = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
    a[0] * minor(1, 2) - a[1] * minor(0, 2) + a[2] * minor(0, 1)
}

/// Every arc is one chain of edges between its landmarks that meets no other arc and no landmark on its way.
pub fn arcs(cut: &CutMesh, base: &BaseComplex) {
    let mut taken = vec![None; cut.conn.vertex_count()];
    let mut marked = 0;
    for (arc, ends) in base.arcs.iter_ids() {
        let path = cut.arc_path(arc, ends[0]);
        assert!(!path.is_empty(), "{arc} is missing");
        assert_eq!(cut.conn.from(path[0]), cut.landmarks[ends[0]], "start of {arc}");
        assert_eq!(cut.conn.to(path[path.len() - 1]), cut.landmarks[ends[1]], "end of {arc}");
        for &h in &path[1..] {
            let v = cut.conn.from(h);
            assert_eq!(cut.landmark_at[v], None, "{arc} passes a landmark at {v}");
            assert!(cut.is_blocked(v));
            assert_eq!(taken[v.index()].replace(arc), None, "{arc} meets an arc at {v}");
        }
        marked += path.iter().map(|&h| 1 + usize::from(cut.conn.twin(h).is_some())).sum::<usize>();
    }
    let carrying = cut.conn.halfedges().filter(|&h| cut.arc_at(h).is_some()).count();
    assert_eq!(carrying, marked, "half-edges that carry an arc without being part of its chain");
    for v in cut.conn.vertices() {
        let expected = taken[v.index()].is_some() || cut.landmark_at[v].is_some();
        assert_eq!(cut.is_blocked(v), expected, "{v} is blocked without reason, or free on an arc");
    }
}

/// Euler's counts, the same rotation system on both meshes, arcs that do not cross, and nothing but the arcs changed.
pub fn layout(layout: &Layout, meshes: &[TriMesh; 2]) {
    let base = &layout.base;
    let rims = base.arcs.iter_ids().filter(|(arc, ends)| layout.cuts[0].is_rim(*arc, ends[0])).count() as i64;
    let inner = base.landmarks as i64 - meshes[0].conn.euler_characteristic();
    assert_eq!(base.arcs.len() as i64, 3 * inner - rims, "arcs");
    assert_eq!(base.patches.len() as i64, 2 * inner - rims, "patches");
    for (cut, mesh) in layout.cuts.iter().zip(meshes) {
        cut_mesh(cut, mesh);
        arcs(cut, base);
    }
    for l in (0..base.landmarks).map(LandmarkId::new) {
        let [mut a, mut b] = [0, 1].map(|k| rotation(&layout.cuts[k], l, &|_| true));
        for r in [&mut a, &mut b] {
            let first = (0..r.len()).min_by_key(|&i| r[i]).expect("every landmark has an arc");
            r.rotate_left(first);
        }
        assert_eq!(a, b, "arcs around {l}");
    }
}

/// Certified, and nothing but the arcs and dividing edges changed.
pub fn embedding(embedding: &Embedding, meshes: &[TriMesh; 2]) {
    let certificate = certify(embedding);
    assert!(certificate.bijective, "{certificate:?}");
    for (embedded, mesh) in embedding.meshes.iter().zip(meshes) {
        cut_mesh(&embedded.cut, mesh);
        arcs(&embedded.cut, &embedding.base);
    }
}

/// Total area of a cut mesh.
pub fn area(cut: &CutMesh) -> f64 {
    let triangle = |f: FaceId| [0, 1, 2].map(|i| cut.positions[cut.conn.from(corner(f, i))]);
    cut.conn.faces().map(|f| metric::area(triangle(f))).sum()
}

/// Every image lies in its face: no coordinate negative, sum one.
pub fn images(map: &SurfaceMap, mesh: &TriMesh) {
    for (v, image) in map.images.iter_ids() {
        let (f, b) = image.and_then(|p| p.on_face(mesh)).unwrap_or_else(|| panic!("{v} has no image"));
        assert!(b.iter().all(|&x| x >= 0.0), "{v} at {b:?} of {f}");
        assert!((b.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{v} at {b:?} of {f}");
    }
}
