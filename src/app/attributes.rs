//! What can be baked: values at the corners of a mesh's triangles.

use crate::error::{Error, Result};
use crate::kernel::Lanes;
use crate::mesh::io::{MeshFile, vertex_normals};
use crate::mesh::salience::mean_curvature_normals;
use crate::mesh::{IdVec, VertexId, metric};
use glam::{DVec2, DVec3};

/// The maps that can be baked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BakeMap {
    /// The position in space, in the mesh's units.
    Position,
    /// The unit normal: the file's, or the mean of the faces around a vertex, weighted by area.
    Normal,
    /// The unit tangent along increasing u, at right angles to the normal.
    Tangent,
    /// The mean curvature, in one over the mesh's units; positive where the surface is convex.
    Curvature,
    /// How much texture space is stretched on the surface: L2 stretch of the map from there, 1 where it is an isometry
    /// once both areas are equal.
    Distortion,
}

impl BakeMap {
    /// Name and unit, for the metadata.
    pub fn words(self) -> [&'static str; 2] {
        match self {
            BakeMap::Position => ["position", "length unit of the mesh file"],
            BakeMap::Normal => ["normal", "unit vector"],
            BakeMap::Tangent => ["tangent", "unit vector"],
            BakeMap::Curvature => ["curvature", "one over the length unit of the mesh file"],
            BakeMap::Distortion => ["distortion", "ratio of lengths"],
        }
    }

    /// True for vectors, false for numbers.
    pub fn is_vector(self) -> bool {
        !matches!(self, BakeMap::Curvature | BakeMap::Distortion)
    }

    /// True for directions, which stay of length one.
    pub fn is_direction(self) -> bool {
        matches!(self, BakeMap::Normal | BakeMap::Tangent)
    }
}

/// The values of a map at the three corners of every triangle; numbers stand in the first lane.
pub fn corner_values(mesh: &MeshFile, uv: &[[DVec2; 3]], map: BakeMap) -> Vec<[Lanes; 3]> {
    let vector = |v: DVec3| v.as_vec3().extend(0.0).to_array();
    let number = |x: f64| [x as f32, 0.0, 0.0, 0.0];
    let values = match map {
        BakeMap::Position => at_corners(mesh, |c| vector(mesh.positions[mesh.corners[c].0 as usize])),
        BakeMap::Normal => corner_normals(mesh).into_iter().map(vector).collect(),
        BakeMap::Tangent => corner_tangents(mesh, uv).into_iter().map(|(t, _)| vector(t)).collect(),
        BakeMap::Curvature => {
            let curvature = signed_curvature(mesh);
            at_corners(mesh, |c| number(curvature[mesh.corners[c]]))
        }
        BakeMap::Distortion => distortion(mesh, uv).into_iter().flat_map(|x| [number(x); 3]).collect(),
    };
    values.as_chunks().0.to_vec()
}

fn at_corners<T>(mesh: &MeshFile, value: impl Fn(usize) -> T) -> Vec<T> {
    mesh.triangle_corners().flatten().map(value).collect()
}

fn triangle_points(mesh: &MeshFile) -> impl Iterator<Item = [DVec3; 3]> {
    mesh.triangles().into_iter().map(|t| t.map(|v| mesh.positions[v.0 as usize]))
}

/// Unit normals at the corners: the file's, where it has some.
pub fn corner_normals(mesh: &MeshFile) -> Vec<DVec3> {
    let smooth = vertex_normals(mesh, &mesh.positions);
    let normal = |c: usize| mesh.normals.at(c).unwrap_or(smooth[mesh.corners[c].0 as usize]).normalize_or_zero();
    at_corners(mesh, normal)
}

/// Unit tangents along increasing u at the corners, and whether the bitangent is normal x tangent or its opposite: means
/// over the corners with the same vertex, texture coordinate and handedness, each weighted by its angle.
pub fn corner_tangents(mesh: &MeshFile, uv: &[[DVec2; 3]]) -> Vec<(DVec3, f64)> {
    let normals = corner_normals(mesh);
    let corners: Vec<usize> = mesh.triangle_corners().flatten().collect();
    let key = |i: usize, hand: f64| (mesh.corners[corners[i]], mesh.uv.index(corners[i]), hand > 0.0);
    let mut sums = std::collections::HashMap::new();
    let mut hands = Vec::with_capacity(corners.len());
    for (t, points) in triangle_points(mesh).enumerate() {
        let hand = hand_of(uv[t]);
        let along = along_u(points, uv[t]);
        for (k, angle) in metric::angles(points).into_iter().enumerate() {
            *sums.entry(key(3 * t + k, hand)).or_insert(DVec3::ZERO) += along * angle;
            hands.push(hand);
        }
    }
    let tangent = |i: usize| {
        let sum = sums.get(&key(i, hands[i])).copied().unwrap_or_default();
        ((sum - normals[i] * sum.dot(normals[i])).normalize_or_zero(), hands[i])
    };
    (0..corners.len()).map(tangent).collect()
}

fn hand_of([a, b, c]: [DVec2; 3]) -> f64 {
    if (b - a).perp_dot(c - a) < 0.0 { -1.0 } else { 1.0 }
}

/// The unit vector in a triangle's plane along which u grows and v stays; zero without area in texture space.
fn along_u([p, q, r]: [DVec3; 3], [a, b, c]: [DVec2; 3]) -> DVec3 {
    let (u, w) = (b - a, c - a);
    let area = u.perp_dot(w);
    (((q - p) * w.y - (r - p) * u.y) * area.signum()).normalize_or_zero()
}

/// Mean curvature at the vertices, positive where the surface bends away from its normal; zero on the boundary.
fn signed_curvature(mesh: &MeshFile) -> IdVec<VertexId, f64> {
    let (triangles, positions) = (mesh.triangles(), IdVec::from_raw(mesh.positions.clone()));
    let curvature = mean_curvature_normals(&triangles, &positions);
    let normals = IdVec::<VertexId, DVec3>::from_raw(vertex_normals(mesh, &mesh.positions));
    positions.ids().map(|v| 0.5 * curvature[v].length() * curvature[v].dot(normals[v]).signum()).collect()
}

/// L2 stretch of every triangle's map from texture space, once both areas together are equal; zero without area there.
fn distortion(mesh: &MeshFile, uv: &[[DVec2; 3]]) -> Vec<f64> {
    let areas = |t: &[DVec2; 3]| metric::signed_area(*t).abs();
    let finite = |t: &&[DVec2; 3]| t.iter().all(|p| p.is_finite());
    let flat: f64 = uv.iter().filter(finite).map(areas).sum();
    let solid: f64 = triangle_points(mesh).map(metric::area).sum();
    let scale = (flat / solid).sqrt();
    let one = |([p, q, r], [a, b, c]): ([DVec3; 3], &[DVec2; 3])| {
        let (u, w) = (*b - *a, *c - *a);
        let area = u.perp_dot(w);
        // Columns of the map's derivative by u and by v.
        let by_u = ((q - p) * w.y - (r - p) * u.y) / area;
        let by_v = ((r - p) * u.x - (q - p) * w.x) / area;
        let stretch = scale * (0.5 * (by_u.length_squared() + by_v.length_squared())).sqrt();
        if stretch.is_finite() { stretch } else { 0.0 }
    };
    triangle_points(mesh).zip(uv).map(one).collect()
}

/// Fails for a mesh that has no texture coordinates at all.
pub fn require_uv(mesh: &MeshFile) -> Result<()> {
    if mesh.uv.values.is_empty() || mesh.uv.corners.is_empty() {
        let what = "the mesh has no texture coordinates";
        return Err(Error::input(what).file(&mesh.path).remedy("unwrap it, or export it with its texture coordinates"));
    }
    Ok(())
}
