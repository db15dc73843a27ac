//! A mesh with vertices inserted at points of its surface, which stays as it is.
//!
//! Every triangle lies in a face of the mesh. A point inside a triangle splits it in three, one on an edge splits the
//! triangles beside it; then edges inside faces are flipped where that makes the smallest angle larger, on this mesh or on
//! the one that it is mapped to. Original vertices keep their numbers, new ones are appended.

use super::{Canonical, FaceId, Id, SurfacePoint, TriMesh, VertexId, metric};
use glam::{DVec2, DVec3};
use std::collections::HashMap;

/// A point with less than this barycentric weight of a corner lies on the edge across from it.
const ON_EDGE: f64 = 1e-9;
/// Flipped triangles have at least this share of the area of their face.
const LEAST_SHARE: f64 = 1e-6;
/// No vertex and no flip leaves a smaller angle than this, in radians, on the mesh itself: below it a triangle has no area.
const HAIR: f64 = 1e-5;
/// A vertex that would leave a smaller angle than this, in radians, is not inserted unless the angles are no better already.
const LEAST_ANGLE: f64 = 0.005;
/// A flip must make the smallest angle larger by so many radians, so that flips end.
const WORTH_FLIPPING: f64 = 1e-6;

/// Where a vertex lies on the other mesh, and the normal there.
#[derive(Clone, Copy, Debug)]
pub struct Image {
    /// The position.
    pub point: DVec3,
    /// The unit normal.
    pub normal: DVec3,
}

/// Gives the images of vertices.
pub type Images<'a> = &'a dyn Fn(u32) -> Image;

/// The mesh being refined.
#[derive(Clone, Debug)]
pub struct Subdivision<'m> {
    mesh: &'m TriMesh,
    /// Where every vertex lies on the mesh; the original ones first.
    pub places: Vec<SurfacePoint>,
    /// Corners of every triangle, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// The face of the mesh that a triangle lies in.
    pub faces: Vec<FaceId>,
    /// For every directed edge the triangle at its left.
    left_of: HashMap<[u32; 2], u32>,
    /// The triangles in every face.
    inside: Vec<Vec<u32>>,
}

impl<'m> Subdivision<'m> {
    /// The mesh as it is.
    pub fn new(mesh: &'m TriMesh) -> Self {
        let triangles: Vec<[u32; 3]> = mesh.conn.faces().map(|f| mesh.face(f).map(|v| v.0)).collect();
        let mut left_of = HashMap::with_capacity(3 * triangles.len());
        for (t, &[a, b, c]) in (0u32..).zip(&triangles) {
            left_of.extend([([a, b], t), ([b, c], t), ([c, a], t)]);
        }
        Subdivision {
            mesh,
            places: (0..mesh.positions.len()).map(|i| SurfacePoint::Vertex(VertexId::new(i))).collect(),
            faces: mesh.conn.faces().collect(),
            inside: (0..triangles.len() as u32).map(|t| vec![t]).collect(),
            triangles,
            left_of,
        }
    }

    /// The triangles that face `f` was divided into.
    pub fn within(&self, f: FaceId) -> &[u32] {
        &self.inside[f.index()]
    }

    /// The same in terms of the mesh that `mesh` is the canonical order of.
    pub fn there<'g>(&self, canonical: &Canonical, given: &'g TriMesh) -> Subdivision<'g> {
        let originals = self.mesh.positions.len();
        let number = |v: u32| if (v as usize) < originals { canonical.vertex_there(VertexId(v)).0 } else { v };
        let mut there = Subdivision::new(given);
        there.places.extend(self.places[originals..].iter().map(|&p| canonical.point_there(p)));
        there.triangles = self.triangles.iter().map(|t| t.map(number)).collect();
        there.faces = self.faces.iter().map(|&f| canonical.face_there(f)).collect();
        there.inside.iter_mut().for_each(Vec::clear);
        there.left_of.clear();
        for t in 0..there.triangles.len() as u32 {
            there.inside[there.faces[t as usize].index()].push(t);
            there.note(t);
        }
        there
    }

    /// True if two vertices are the ends of an edge.
    pub fn is_edge(&self, [a, b]: [u32; 2]) -> bool {
        self.left_of.contains_key(&[a, b]) || self.left_of.contains_key(&[b, a])
    }

    /// The point of an edge of a triangle, or inside it, at weights of its corners.
    pub fn point_in(&self, t: u32, weights: [f64; 3]) -> Option<SurfacePoint> {
        let f = self.faces[t as usize];
        let sum: f64 = weights.iter().sum();
        let mut b = [0.0; 3];
        for (&v, w) in self.triangles[t as usize].iter().zip(weights) {
            let at = self.places[v as usize].barycentric_in(self.mesh, f)?;
            (0..3).for_each(|k| b[k] += at[k] * w / sum);
        }
        Some(SurfacePoint::from_barycentric(self.mesh, f, b))
    }

    /// Inserts a vertex; `images` also gives that of the vertex that will be the next. Returns the triangles that changed,
    /// none if there is a vertex already, the point is on no face or parts would have no area; and, if that is `careful`,
    /// where triangles would turn over or become slivers on either mesh.
    pub fn insert(&mut self, point: SurfacePoint, images: Images, careful: bool) -> Vec<u32> {
        let Some((t, weights)) = self.locate(point) else { return Vec::new() };
        let near: Vec<usize> = (0..3).filter(|&i| weights[i] < ON_EDGE).collect();
        let side = match near.as_slice() {
            [] => None,
            &[i] => Some((i + 1) % 3),
            _ => return Vec::new(),
        };
        if !self.has_room(t, side, point, careful.then_some(images)) {
            return Vec::new();
        }
        let mut changed = match side {
            None => self.split_triangle(t, point),
            Some(side) => self.split_edge(t, side, point, weights),
        };
        self.legalise(&mut changed, images);
        changed
    }

    /// True if a vertex in a triangle, or on a side of it, leaves parts with an area; with images, also none turned over there
    /// and no slivers on either mesh.
    fn has_room(&self, t: u32, side: Option<usize>, point: SurfacePoint, images: Option<Images>) -> bool {
        let new = self.places.len() as u32;
        let corners = self.triangles[t as usize];
        let around = |side: usize| {
            let [a, b] = [corners[side], corners[(side + 1) % 3]];
            let behind = self.left_of.get(&[b, a]).map(|&s| self.triangles[s as usize]);
            std::iter::once(corners).chain(behind).collect::<Vec<_>>()
        };
        let before = side.map_or(vec![corners], around);
        let split = |t: &[u32; 3]| {
            let halves = edges(*t).into_iter().filter(|&[a, b]| {
                side.is_none_or(|side| ![a, b].iter().all(|v| [corners[side], corners[(side + 1) % 3]].contains(v)))
            });
            halves.map(|[a, b]| [a, b, new]).collect::<Vec<_>>()
        };
        let after: Vec<[u32; 3]> = before.iter().flat_map(split).collect();
        let here = |v: u32| if v == new { point.position(self.mesh) } else { self.position(v) };
        let limit = if images.is_some() { LEAST_ANGLE } else { HAIR };
        let [old, least] = [&before, &after].map(|triangles| match images {
            Some(images) => least_angle(triangles, &here, images),
            None => least_angle_here(triangles, &here),
        });
        least > limit || least >= old
    }

    fn position(&self, v: u32) -> DVec3 {
        self.places[v as usize].position(self.mesh)
    }

    /// The triangle that holds a point, and its weights of the corners.
    pub fn locate(&self, point: SurfacePoint) -> Option<(u32, [f64; 3])> {
        let (f, b) = point.on_face(self.mesh)?;
        let p = DVec2::new(b[1], b[2]);
        let weights = |t: u32| Some((t, metric::barycentric(self.flat(t, f)?, p)));
        let least = |(_, w): &(u32, [f64; 3])| w.iter().copied().fold(f64::INFINITY, f64::min);
        self.within(f).iter().filter_map(|&t| weights(t)).max_by(|a, b| least(a).total_cmp(&least(b)))
    }

    /// The corners of a triangle in the coordinates of its face.
    fn flat(&self, t: u32, f: FaceId) -> Option<[DVec2; 3]> {
        let [a, b, c] = self.triangles[t as usize].map(|v| {
            let [_, x, y] = self.places[v as usize].barycentric_in(self.mesh, f)?;
            Some(DVec2::new(x, y))
        });
        Some([a?, b?, c?])
    }

    fn push_vertex(&mut self, point: SurfacePoint) -> u32 {
        self.places.push(point);
        self.places.len() as u32 - 1
    }

    fn push_triangle(&mut self, corners: [u32; 3], f: FaceId) -> u32 {
        let t = self.triangles.len() as u32;
        self.triangles.push(corners);
        self.faces.push(f);
        self.inside[f.index()].push(t);
        self.note(t);
        t
    }

    /// Notes the edges of a triangle.
    fn note(&mut self, t: u32) {
        let [a, b, c] = self.triangles[t as usize];
        self.left_of.extend([([a, b], t), ([b, c], t), ([c, a], t)]);
    }

    fn split_triangle(&mut self, t: u32, point: SurfacePoint) -> Vec<u32> {
        let ([a, b, c], f) = (self.triangles[t as usize], self.faces[t as usize]);
        let v = self.push_vertex(point);
        self.triangles[t as usize] = [a, b, v];
        self.note(t);
        vec![t, self.push_triangle([b, c, v], f), self.push_triangle([c, a, v], f)]
    }

    /// Splits side `side` of a triangle, and the triangle behind it.
    fn split_edge(&mut self, t: u32, side: usize, point: SurfacePoint, mut weights: [f64; 3]) -> Vec<u32> {
        let corners = self.triangles[t as usize];
        let [a, b] = [corners[side], corners[(side + 1) % 3]];
        let behind = self.left_of.get(&[b, a]).copied();
        let f = self.faces[t as usize];
        if behind.is_some_and(|s| self.faces[s as usize] != f) && !matches!(point, SurfacePoint::Edge(..)) {
            // Between two faces the point must be one of both.
            weights[(side + 2) % 3] = 0.0;
            return match self.point_in(t, weights) {
                Some(snapped @ SurfacePoint::Edge(..)) => self.split_edge(t, side, snapped, weights),
                _ => Vec::new(),
            };
        }
        let v = self.push_vertex(point);
        self.left_of.remove(&[a, b]);
        self.left_of.remove(&[b, a]);
        let mut changed = Vec::new();
        for (side, from, to) in [(Some(t), a, b), (behind, b, a)] {
            let Some(s) = side else { continue };
            let f = self.faces[s as usize];
            let Some(&far) = self.triangles[s as usize].iter().find(|&&w| w != a && w != b) else { continue };
            self.triangles[s as usize] = [from, v, far];
            self.note(s);
            changed.extend([s, self.push_triangle([v, to, far], f)]);
        }
        changed
    }

    /// Flips edges inside faces until no flip makes the smallest angle larger.
    fn legalise(&mut self, changed: &mut Vec<u32>, images: Images) {
        let mut open: Vec<[u32; 2]> = changed.iter().flat_map(|&t| edges(self.triangles[t as usize])).collect();
        let most = 64 * open.len();
        for _ in 0..most {
            let Some([a, b]) = open.pop() else { return };
            let (Some(&s), Some(&t)) = (self.left_of.get(&[a, b]), self.left_of.get(&[b, a])) else { continue };
            if let Some([c, d]) = self.wants_flip([a, b], [s, t], images) {
                self.left_of.remove(&[a, b]);
                self.left_of.remove(&[b, a]);
                self.triangles[s as usize] = [d, b, c];
                self.triangles[t as usize] = [c, a, d];
                [s, t].into_iter().for_each(|t| self.note(t));
                open.extend([[b, c], [c, a], [a, d], [d, b]]);
                changed.extend([s, t].into_iter().filter(|t| !changed.contains(t)).collect::<Vec<_>>());
            }
        }
    }

    /// The corners opposite an edge if it should run between them: both its triangles lie in one face and make up a convex
    /// quad there, and the smallest angle of both gets larger, here and on the other mesh.
    fn wants_flip(&self, [a, b]: [u32; 2], [s, t]: [u32; 2], images: Images) -> Option<[u32; 2]> {
        let f = self.faces[s as usize];
        if f != self.faces[t as usize] {
            return None;
        }
        let opposite = |t: u32| self.triangles[t as usize].into_iter().find(|&w| w != a && w != b);
        let (c, d) = (opposite(s)?, opposite(t)?);
        let flat = |v: u32| {
            let [_, x, y] = self.places[v as usize].barycentric_in(self.mesh, f)?;
            Some(DVec2::new(x, y))
        };
        let [p, q, r, s] = [flat(a)?, flat(b)?, flat(c)?, flat(d)?];
        let is_upright = |x: DVec2, y: DVec2, z: DVec2| (y - x).perp_dot(z - x) > LEAST_SHARE;
        if !is_upright(s, q, r) || !is_upright(r, p, s) {
            return None;
        }
        let here = |v: u32| self.position(v);
        let [old, new] = [[[a, b, c], [b, a, d]], [[d, b, c], [c, a, d]]];
        let has_area = || least_angle_here(&new, &here) > HAIR;
        let least = |triangles: &[[u32; 3]]| least_angle(triangles, &here, images);
        (least(&new) > least(&old) + WORTH_FLIPPING && has_area()).then_some([c, d])
    }
}

fn smallest_angle(triangle: [DVec3; 3]) -> f64 {
    metric::angles(triangle).into_iter().fold(f64::INFINITY, f64::min)
}

/// The smallest angle of triangles on this mesh.
fn least_angle_here(triangles: &[[u32; 3]], here: &dyn Fn(u32) -> DVec3) -> f64 {
    triangles.iter().map(|t| smallest_angle(t.map(here))).fold(f64::INFINITY, f64::min)
}

/// The smallest angle of triangles, on this mesh and on the other one; negative there where a triangle is turned over.
fn least_angle(triangles: &[[u32; 3]], here: &dyn Fn(u32) -> DVec3, images: Images) -> f64 {
    let there = |t: &[u32; 3]| {
        let image = t.map(images);
        let [a, b, c] = image.map(|i| i.point);
        let normal: DVec3 = image.iter().map(|i| i.normal).sum();
        let is_over = (b - a).cross(c - a).dot(normal) < 0.0;
        smallest_angle([a, b, c]) - if is_over { std::f64::consts::PI } else { 0.0 }
    };
    triangles.iter().map(there).fold(least_angle_here(triangles, here), f64::min)
}

fn edges([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::HalfedgeId;
    use crate::shape::SplitMix;
    use crate::shape::fixture::icosphere;

    /// The sphere mapped to itself.
    fn itself(mesh: &TriMesh, place: SurfacePoint) -> Image {
        let point = place.position(mesh);
        Image { point, normal: point.normalize() }
    }

    /// The triangles are a manifold with the mesh's surface: same area in every face, none turned over.
    fn check(subdivision: &Subdivision) {
        let faces: Vec<[VertexId; 3]> = subdivision.triangles.iter().map(|t| t.map(VertexId)).collect();
        let positions = (0..subdivision.places.len() as u32).map(|v| subdivision.position(v)).collect();
        let fine = TriMesh::new(positions, &faces).expect("a manifold");
        assert_eq!(fine.conn.euler_characteristic(), subdivision.mesh.conn.euler_characteristic());
        for f in subdivision.mesh.conn.faces() {
            let whole = subdivision.mesh.triangle(f);
            let normal = (whole[1] - whole[0]).cross(whole[2] - whole[0]);
            let parts = subdivision.within(f).iter().map(|&t| fine.triangle(FaceId(t)));
            let sum: f64 = parts
                .map(|[a, b, c]| {
                    assert!((b - a).cross(c - a).dot(normal) > 0.0, "{f} has a part turned over");
                    metric::area([a, b, c])
                })
                .sum();
            assert!((sum - metric::area(whole)).abs() < 1e-9, "{f}");
        }
    }

    #[test]
    fn vertices_in_faces_and_on_edges_leave_the_surface_as_it_is_seed_8() {
        let mesh = icosphere(1);
        let mut random = SplitMix::new(8);
        let mut subdivision = Subdivision::new(&mesh);
        let mut inserted = 0;
        for k in 0..400 {
            let point = if k % 3 == 0 {
                SurfacePoint::Edge(HalfedgeId((random.unit() * 240.0) as u32), random.unit())
            } else {
                let (x, y) = (random.unit(), random.unit());
                let b = if x + y < 1.0 { [1.0 - x - y, x, y] } else { [x + y - 1.0, 1.0 - x, 1.0 - y] };
                SurfacePoint::Face(FaceId((random.unit() * 80.0) as u32), b)
            };
            let known = subdivision.places.clone();
            let changed =
                subdivision.insert(point, &|v| itself(&mesh, known.get(v as usize).copied().unwrap_or(point)), true);
            inserted += usize::from(!changed.is_empty());
        }
        assert!(inserted > 350 && subdivision.places.len() == mesh.positions.len() + inserted);
        assert_eq!(subdivision.triangles.len(), 80 + 2 * inserted);
        check(&subdivision);
    }

    #[test]
    fn a_vertex_is_not_inserted_twice() {
        let mesh = icosphere(0);
        let mut subdivision = Subdivision::new(&mesh);
        let point = SurfacePoint::Face(FaceId(3), [0.2, 0.3, 0.5]);
        let known = subdivision.places.clone();
        let images = |v: u32| itself(&mesh, known.get(v as usize).copied().unwrap_or(point));
        assert_eq!(subdivision.insert(point, &images, true).len(), 3);
        assert!(subdivision.insert(point, &images, true).is_empty());
        assert!(subdivision.insert(SurfacePoint::Vertex(VertexId(2)), &images, true).is_empty());
        check(&subdivision);
    }

    #[test]
    fn a_vertex_that_would_turn_triangles_over_finds_no_room() {
        let mesh = icosphere(0);
        let mut subdivision = Subdivision::new(&mesh);
        let point = SurfacePoint::Face(FaceId(3), [0.2, 0.3, 0.5]);
        let astray = |v: u32| match mesh.positions.raw.get(v as usize) {
            Some(&p) => Image { point: p, normal: p },
            None => Image { point: point.position(&mesh) * -1.0, normal: point.position(&mesh) },
        };
        assert!(subdivision.insert(point, &astray, true).is_empty());
        assert_eq!(subdivision.places.len(), mesh.positions.len());
        assert_eq!(subdivision.insert(point, &astray, false).len(), 3);
    }
}
