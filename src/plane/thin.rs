//! A domain without the vertices that arcs left behind.
//!
//! Every arc that moves leaves the vertices of its old way behind: they divide original edges and faces and nothing else,
//! but between them lie slivers that stop vertices around them from moving. Here they are merged into neighbours, where
//! that leaves the surface as it is: all triangles stay inside their original faces and keep their orientation there, and
//! stay positive in the plane. The map changes between original vertices; at these it stays.

use super::domain::Domain;
use crate::mesh::{FaceId, SurfacePoint, TriMesh, VertexId, metric};
use glam::DVec2;

/// Every triangle made by a merge keeps at least this share of the ring's area, on the surface and in the plane.
const LEAST_SHARE: f64 = 1e-4;
/// A merge is left out if a triangle would be this many times more or less dense in the plane than its ring.
const MOST_UNEVEN: f64 = 1e4;

/// What a refined mesh has of the original one.
pub struct Origins<'a> {
    /// The original mesh.
    pub mesh: &'a TriMesh,
    /// Where a vertex of the refined mesh lies on it.
    pub point: &'a dyn Fn(VertexId) -> SurfacePoint,
    /// The original face of a face of the refined mesh.
    pub face: &'a dyn Fn(FaceId) -> FaceId,
}

/// Takes the vertices that may move and are none of the original mesh out of a domain, where that can be done.
pub fn thin_out(domain: Domain, origins: &Origins) -> Domain {
    let mut around = vec![Vec::new(); domain.vertices.len()];
    for (t, corners) in (0u32..).zip(&domain.triangles) {
        corners.iter().for_each(|&v| around[v as usize].push(t));
    }
    let alive = vec![true; domain.triangles.len()];
    let mut thinning = Thinning { domain, origins, around, alive };
    let originals = origins.mesh.positions.len();
    let is_extra = |domain: &Domain, v: usize| domain.free[v] && domain.vertices[v].0 as usize >= originals;
    let mut waiting: Vec<usize> = (0..thinning.around.len()).filter(|&v| is_extra(&thinning.domain, v)).collect();
    loop {
        let before = waiting.len();
        waiting.retain(|&v| !thinning.merge(v as u32));
        if waiting.len() == before {
            return thinning.rest();
        }
    }
}

struct Thinning<'a> {
    domain: Domain,
    origins: &'a Origins<'a>,
    /// The triangles around every vertex.
    around: Vec<Vec<u32>>,
    /// Whether a triangle is still there.
    alive: Vec<bool>,
}

impl Thinning<'_> {
    /// Merges `v` into the neighbour that leaves the triangles around most even in the plane; false if none can take it.
    fn merge(&mut self, v: u32) -> bool {
        let ring = std::mem::take(&mut self.around[v as usize]);
        let neighbours = ring.iter().map(|&t| after(&self.domain.triangles[t as usize], v));
        let candidates = neighbours.filter_map(|w| Some((self.unevenness(&ring, v, w)?, w)));
        let Some((_, w)) = candidates.min_by(|a, b| a.0.total_cmp(&b.0)) else {
            self.around[v as usize] = ring;
            return false;
        };
        for t in ring {
            let corners = self.domain.triangles[t as usize];
            if corners.contains(&w) {
                self.alive[t as usize] = false;
                corners.iter().for_each(|&u| self.around[u as usize].retain(|&s| s != t));
            } else {
                self.domain.triangles[t as usize] = redrawn(corners, v, w);
                self.around[w as usize].push(t);
            }
        }
        true
    }

    /// How uneven the triangles around `v`, drawn to `w` instead, are; none if they cannot be.
    fn unevenness(&self, ring: &[u32], v: u32, w: u32) -> Option<f64> {
        let triangle = |t: u32| self.domain.triangles[t as usize];
        let is_shared = |&t: &u32| {
            let u = after(&triangle(t), v);
            u != w && self.around[w as usize].iter().any(|&s| triangle(s).contains(&u))
        };
        if ring.iter().filter(|t| is_shared(t)).count() != 2 {
            return None;
        }
        let face = |t: u32| (self.origins.face)(self.domain.faces[t as usize]);
        let planar = |corners: [u32; 3]| metric::signed_area(corners.map(|u| self.domain.positions[u as usize]));
        let spatial = |corners: [u32; 3]| metric::area(self.domain.spatial(&corners));
        let whole: [f64; 2] = ring
            .iter()
            .fold([0.0; 2], |[plane, space], &t| [plane + planar(triangle(t)), space + spatial(triangle(t))]);
        let mut worst: f64 = 1.0;
        for &t in ring {
            let (corners, f) = (triangle(t), face(t));
            if corners.contains(&w) {
                self.on_face([w; 3], f)?;
                continue;
            }
            let moved = redrawn(corners, v, w);
            let of_face: f64 =
                ring.iter().filter(|&&s| face(s) == f).filter_map(|&s| self.on_face(triangle(s), f)).sum();
            if self.on_face(moved, f)? <= LEAST_SHARE * of_face || planar(moved) <= LEAST_SHARE * whole[0] {
                return None;
            }
            let density = planar(moved) / whole[0] * whole[1] / spatial(moved);
            worst = worst.max(density).max(1.0 / density);
        }
        (worst < MOST_UNEVEN).then_some(worst)
    }

    /// Twice the area of a triangle in the coordinates of an original face; none if it is not in that face.
    fn on_face(&self, corners: [u32; 3], f: FaceId) -> Option<f64> {
        let Origins { mesh, point, .. } = self.origins;
        let [a, b, c] = corners.map(|u| point(self.domain.vertices[u as usize]).barycentric_in(mesh, f));
        let [a, b, c] = [a?, b?, c?].map(|b| DVec2::new(b[1], b[2]));
        Some((b - a).perp_dot(c - a))
    }

    /// What is left of the domain.
    fn rest(self) -> Domain {
        let Thinning { domain, around, alive, .. } = self;
        let mut rest = Domain::default();
        let mut number = vec![u32::MAX; domain.vertices.len()];
        for (v, number) in number.iter_mut().enumerate().filter(|(v, _)| !around[*v].is_empty()) {
            *number = rest.vertices.len() as u32;
            rest.vertices.push(domain.vertices[v]);
            rest.positions.push(domain.positions[v]);
            rest.points.push(domain.points[v]);
            rest.free.push(domain.free[v]);
        }
        for t in (0..domain.triangles.len()).filter(|&t| alive[t]) {
            rest.triangles.push(domain.triangles[t].map(|v| number[v as usize]));
            rest.faces.push(domain.faces[t]);
        }
        rest.connect();
        rest
    }
}

/// The corner of `t` that follows `v`.
fn after(t: &[u32; 3], v: u32) -> u32 {
    let i = t.iter().position(|&u| u == v).unwrap_or(0);
    t[(i + 1) % 3]
}

/// The triangle with its corner `v` at `w`.
fn redrawn(t: [u32; 3], v: u32, w: u32) -> [u32; 3] {
    t.map(|u| if u == v { w } else { u })
}

#[cfg(test)]
mod tests {
    use super::super::grid::{grid, swirl};
    use super::*;
    use crate::mesh::Id;
    use crate::path::cut_mesh::CutMesh;

    /// A grid whose triangles were divided, and the mesh it was: places in the plane go with the original faces.
    fn divided(free: bool) -> (TriMesh, CutMesh, Domain, Domain) {
        let whole = grid(5, swirl);
        let faces: Vec<[VertexId; 3]> = whole.triangles.iter().map(|t| t.map(VertexId)).collect();
        let mesh = TriMesh::new(whole.points.clone(), &faces).expect("a grid is a manifold");
        let mut cut = CutMesh::new(&mesh, &[], 1);
        for k in 0..40 {
            let inner =
                cut.conn.halfedges().filter(|&h| cut.conn.twin(h).is_some() && cut.conn.is_edge_representative(h));
            let h = inner.into_iter().nth(7 * k % 60).expect("so many edges");
            cut.split_edge(&mesh, h, 0.2 + 0.015 * k as f64);
        }
        let place = |v: VertexId| {
            let (f, b) = cut.origin[v].on_face(&mesh).expect("every vertex has a face");
            (0..3).map(|i| whole.positions[mesh.face(f)[i].index()] * b[i]).sum()
        };
        let vertices: Vec<VertexId> = cut.conn.vertices().collect();
        let mut domain = Domain {
            positions: vertices.iter().map(|&v| place(v)).collect(),
            points: cut.positions.raw.clone(),
            free: vertices.iter().map(|v| whole.free.get(v.index()).copied().unwrap_or(free)).collect(),
            triangles: cut.conn.faces().map(|f| cut.conn.face(f).map(|v| v.0)).collect(),
            faces: cut.conn.faces().collect(),
            vertices,
            ..Domain::default()
        };
        domain.connect();
        (mesh, cut, whole, domain)
    }

    fn thin(mesh: &TriMesh, cut: &CutMesh, domain: Domain) -> Domain {
        thin_out(domain, &Origins { mesh, point: &|v| cut.origin[v], face: &|f| cut.face_origin[f] })
    }

    #[test]
    fn what_only_divides_goes_and_the_original_mesh_is_left() {
        let (mesh, cut, whole, domain) = divided(true);
        assert!(domain.vertices.len() > whole.vertices.len() + 30);
        let rest = thin(&mesh, &cut, domain);
        assert_eq!(rest.vertices, whole.vertices);
        assert_eq!(rest.triangles.len(), whole.triangles.len());
        for (t, &f) in rest.triangles.iter().zip(&rest.faces) {
            let mut corners = mesh.face(cut.face_origin[f]);
            let mut found = t.map(|v| rest.vertices[v as usize]);
            corners.sort_unstable();
            found.sort_unstable();
            assert_eq!(found, corners);
        }
        assert!((0..rest.triangles.len()).all(|t| metric::signed_area(rest.triangle(t)) > 0.0));
    }

    #[test]
    fn what_must_not_move_stays() {
        let (mesh, cut, _, domain) = divided(false);
        let rest = thin(&mesh, &cut, domain.clone());
        assert_eq!((rest.vertices, rest.triangles), (domain.vertices, domain.triangles));
    }

    /// Places in the plane that go with no original face: some vertices find nowhere to go.
    #[test]
    fn nothing_turns_over() {
        let (mesh, cut, whole, mut domain) = divided(true);
        for (v, p) in domain.positions.iter_mut().enumerate().skip(whole.vertices.len()) {
            let shake = DVec2::from_angle(2.4 * v as f64) * 0.004;
            *p += shake;
        }
        let flipped = |domain: &Domain| {
            (0..domain.triangles.len()).filter(|&t| metric::signed_area(domain.triangle(t)) <= 0.0).count()
        };
        let before = flipped(&domain);
        let rest = thin(&mesh, &cut, domain.clone());
        assert!(rest.vertices.len() < domain.vertices.len());
        assert!(flipped(&rest) <= before);
    }
}
