//! Salient vertices: so many that spheres through them come near all others (HYPOTHESIS 4.2).
//!
//! Around a vertex a surface is nearly a sphere, whose radius and centre its mean-curvature normal tells (Meyer, Desbrun,
//! Schröder, Barr 2002). Vertices are taken from the most curved on; each stands for those around it that lie near its
//! sphere, and what no earlier one stands for is salient itself. Without them the profile of the surface collapses.

use super::{IdVec, TriMesh, VertexId, metric, prev};
use glam::DVec3;
use rayon::prelude::*;

/// Where a radius is more than this many times the mesh's diagonal, the sphere is a plane.
const FLAT: f64 = 1e6;

/// The salient vertices of a mesh; a sphere is met within `tolerance`, in mesh units.
pub fn salient_vertices(mesh: &TriMesh, tolerance: f64) -> Vec<VertexId> {
    let curvature = mean_curvature_normals(&mesh.faces(), &mesh.positions);
    let diagonal = mesh.diagonal();
    let used = |v: &VertexId| mesh.conn.leaving(*v).is_some();
    let mut order: Vec<VertexId> = mesh.conn.vertices().filter(used).collect();
    order.sort_by(|&a, &b| curvature[b].length().total_cmp(&curvature[a].length()).then(a.cmp(&b)));
    let mut is_stood_for = IdVec::filled(false, mesh.positions.len());
    let mut salient = Vec::new();
    for v in order {
        if is_stood_for[v] {
            continue;
        }
        salient.push(v);
        is_stood_for[v] = true;
        let gap = gap_to_sphere(mesh.positions[v], curvature[v], FLAT * diagonal);
        let mut open = vec![v];
        while let Some(w) = open.pop() {
            for h in mesh.conn.outgoing(w) {
                for x in [mesh.conn.to(h), mesh.conn.from(prev(h))] {
                    if !is_stood_for[x] && gap(mesh.positions[x]) < tolerance {
                        is_stood_for[x] = true;
                        open.push(x);
                    }
                }
            }
        }
    }
    salient
}

/// How far a point is from the sphere that touches `at`, given its mean-curvature normal 2 H n.
fn gap_to_sphere(at: DVec3, curvature: DVec3, flat: f64) -> impl Fn(DVec3) -> f64 {
    let radius = 2.0 / curvature.length();
    let normal = curvature.normalize_or_zero();
    move |p| {
        if radius < flat { (p.distance(at - normal * radius) - radius).abs() } else { (p - at).dot(normal).abs() }
    }
}

/// Twice the mean curvature times the outer normal, at every vertex; zero on the boundary, which has none.
pub fn mean_curvature_normals(
    triangles: &[[VertexId; 3]],
    positions: &IdVec<VertexId, DVec3>,
) -> IdVec<VertexId, DVec3> {
    let mut sum = IdVec::filled(DVec3::ZERO, positions.len());
    let mut area = IdVec::filled(0.0, positions.len());
    for corners in triangles {
        let points = corners.map(|v| positions[v]);
        let double_area = 2.0 * metric::area(points);
        if double_area == 0.0 {
            continue;
        }
        let dots = [0, 1, 2].map(|i| (points[(i + 1) % 3] - points[i]).dot(points[(i + 2) % 3] - points[i]));
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let half_cotangent = 0.5 * dots[k] / double_area;
            let side = points[i] - points[j];
            sum[corners[i]] += side * half_cotangent;
            sum[corners[j]] -= side * half_cotangent;
            // The mixed Voronoi area: that of a circumcentre inside, else half at the obtuse corner.
            let is_obtuse = dots.iter().any(|d| *d < 0.0);
            area[corners[i]] += match (is_obtuse, dots[i] < 0.0) {
                (true, true) => 0.25 * double_area,
                (true, false) => 0.125 * double_area,
                (false, _) => {
                    let other = points[i] - points[k];
                    0.25 * (half_cotangent * side.length_squared()
                        + 0.5 * dots[j] / double_area * other.length_squared())
                }
            };
        }
    }
    let on_boundary = boundary_vertices(triangles, positions.len());
    let one = |v: VertexId| if area[v] > 0.0 && !on_boundary[v] { sum[v] / area[v] } else { DVec3::ZERO };
    positions.ids().map(one).collect()
}

/// Marks the ends of edges that one triangle only has.
fn boundary_vertices(triangles: &[[VertexId; 3]], count: usize) -> IdVec<VertexId, bool> {
    let mut edges: Vec<[VertexId; 2]> =
        triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]].map(|[p, q]| [p.min(q), p.max(q)])).collect();
    edges.par_sort_unstable();
    let mut marks = IdVec::filled(false, count);
    for same in edges.chunk_by(|a, b| a == b).filter(|same| same.len() == 1) {
        same[0].iter().for_each(|&v| marks[v] = true);
    }
    marks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::fixture::{ellipsoid, icosphere};

    #[test]
    fn a_sphere_has_the_curvature_of_a_sphere_and_one_salient_vertex() {
        let mesh = icosphere(4);
        let curvature = mean_curvature_normals(&mesh);
        for v in mesh.conn.vertices() {
            assert!((curvature[v] - 2.0 * mesh.positions[v]).length() < 0.1, "{v} {}", curvature[v]);
        }
        assert_eq!(salient_vertices(&mesh, 0.05).len(), 1);
    }

    #[test]
    fn what_is_not_salient_is_near_a_salient_vertex_sphere_and_sharp_ends_come_first() {
        let mesh = ellipsoid(DVec3::new(1.0, 0.2, 0.2), 4);
        let [coarse, fine] = [1e-2, 1e-3].map(|tolerance| salient_vertices(&mesh, tolerance));
        assert!(coarse.len() < fine.len() && fine.len() < mesh.positions.len());
        assert!(mesh.positions[coarse[0]].x.abs() > 0.9, "{}", mesh.positions[coarse[0]]);
        let curvature = mean_curvature_normals(&mesh);
        for v in mesh.conn.vertices() {
            let near = |&s: &VertexId| gap_to_sphere(mesh.positions[s], curvature[s], 1e9)(mesh.positions[v]) < 1e-3;
            assert!(fine.contains(&v) || fine.iter().any(near), "{v}");
        }
    }
}
