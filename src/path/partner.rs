//! Points of two meshes that seem to correspond, told by a smooth warp through the points that do.
//!
//! Points far from every base vertex leave open which way arcs go around what lies between, for instance through which
//! hole. Where the warp takes such a point close to the other surface, to a place that faces the same way and that the
//! warp back returns from, the two are taken for partners.

use super::front::front;
use crate::mesh::{FaceId, IdVec, TriMesh, VertexId, corner, face_of};
use crate::solve::warp::Warp;
use glam::DVec3;

/// Most pairs; more cost time and add little.
const MOST: usize = 16;
/// Sampling ends when every point is this near to a base vertex or a sample, in units of the root of the area.
const GAP: f64 = 0.15;
/// A warped point must come this near to the other surface's vertices, in the same unit.
const NEAR: f64 = 0.05;
/// Partners may be nearer to other base vertices than their samples are, but not by more than this factor.
const CROWDING: f64 = 0.5;
/// Least cosine of the angle between a warped normal and the partner's.
const FACING: f64 = 0.5;

/// What is known of one mesh.
struct Surface<'a> {
    mesh: &'a TriMesh,
    unit: f64,
    normals: IdVec<VertexId, DVec3>,
    /// The base vertices and what has been sampled.
    taken: Vec<VertexId>,
}

impl<'a> Surface<'a> {
    fn new(mesh: &'a TriMesh, taken: &[VertexId]) -> Self {
        let mut normals = IdVec::filled(DVec3::ZERO, mesh.positions.len());
        for f in mesh.conn.faces() {
            let [a, b, c] = mesh.triangle(f);
            mesh.conn.face(f).into_iter().for_each(|v| normals[v] += (b - a).cross(c - a));
        }
        Surface { mesh, unit: mesh.area().sqrt(), normals, taken: taken.to_vec() }
    }

    /// Distance of every face from what is taken, in units of the root of the area.
    fn distances(&self) -> IdVec<FaceId, f64> {
        let reached = front(self.mesh, &self.taken).distance;
        reached.iter().map(|d| d / self.unit).collect()
    }

    /// The vertex used by a face that comes nearest to a point, among those that face along `normal`.
    fn nearest(&self, to: DVec3, normal: DVec3) -> Option<(VertexId, f64)> {
        let facing = |v: &VertexId| self.normals[*v].normalize_or_zero().dot(normal) >= FACING;
        let apart = |v: VertexId| (v, self.mesh.positions[v].distance(to) / self.unit);
        self.mesh.conn.vertices().filter(facing).map(apart).min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)))
    }
}

/// Pairs of partners far from all `base` vertices and from each other, source first.
///
/// There are at least `least` pairs if the meshes have vertices left: where none are clear the best are taken.
pub fn partners(meshes: [&TriMesh; 2], base: [&[VertexId]; 2], least: usize) -> Vec<[VertexId; 2]> {
    let points = [0, 1].map(|k| base[k].iter().map(|&v| meshes[k].positions[v]).collect::<Vec<_>>());
    let areas = meshes.map(TriMesh::area);
    let there = Warp::fit(&points[0], &points[1], areas);
    let back = Warp::fit(&points[1], &points[0], [areas[1], areas[0]]);
    let [mut source, mut target] = [0, 1].map(|k| Surface::new(meshes[k], base[k]));
    let mut pairs = Vec::new();
    for _ in 0..MOST {
        let far = farthest(&source);
        let Some((v, gap)) = far.filter(|&(_, gap)| gap > GAP || pairs.len() < least) else { break };
        source.taken.push(v);
        let image = there.apply(meshes[0].positions[v]);
        let partner = target.nearest(image, there.turn(source.normals[v]));
        let is_clear = |&(w, apart): &(VertexId, f64)| {
            let returned = source.nearest(back.apply(meshes[1].positions[w]), source.normals[v].normalize_or_zero());
            let strays = returned
                .map_or(f64::INFINITY, |(u, _)| meshes[0].positions[u].distance(meshes[0].positions[v]) / source.unit);
            apart <= NEAR && strays <= NEAR && clearance(&target, w) >= CROWDING * gap
        };
        if let Some((w, _)) = partner.filter(is_clear) {
            target.taken.push(w);
            pairs.push([v, w]);
        }
    }
    force(&mut pairs, [&source, &target], base, least, &there);
    pairs
}

/// The vertex farthest from everything taken, and how far that is.
fn farthest(surface: &Surface) -> Option<(VertexId, f64)> {
    let distances = surface.distances();
    let far = distances.iter_ids().filter(|(_, d)| d.is_finite()).max_by(|a, b| a.1.total_cmp(b.1).then(b.0.cmp(&a.0)));
    let (f, &gap) = far?;
    let corners = (0..3).map(|i| surface.mesh.conn.from(corner(f, i)));
    corners.filter(|v| !surface.taken.contains(v)).min().map(|v| (v, gap))
}

/// Distance of a vertex from everything taken.
fn clearance(surface: &Surface, v: VertexId) -> f64 {
    let distances = surface.distances();
    surface.mesh.conn.outgoing(v).map(|h| distances[face_of(h)]).fold(f64::INFINITY, f64::min)
}

/// Fills up to `least` pairs with the farthest vertices left and what comes nearest to their images.
fn force(
    pairs: &mut Vec<[VertexId; 2]>,
    [source, target]: [&Surface; 2],
    base: [&[VertexId]; 2],
    least: usize,
    warp: &Warp,
) {
    while pairs.len() < least {
        let is_free = |k: usize, v: VertexId| !base[k].contains(&v) && pairs.iter().all(|pair| pair[k] != v);
        let taken = base[0].iter().copied().chain(pairs.iter().map(|pair| pair[0])).collect();
        let spread = Surface { mesh: source.mesh, unit: source.unit, normals: IdVec::default(), taken };
        let Some((v, _)) = farthest(&spread) else { return };
        let image = warp.apply(source.mesh.positions[v]);
        let used = target.mesh.conn.vertices().filter(|&w| target.mesh.conn.leaving(w).is_some() && is_free(1, w));
        let apart = |w: VertexId| target.mesh.positions[w].distance(image);
        let Some(w) = used.min_by(|&a, &b| apart(a).total_cmp(&apart(b))) else { return };
        pairs.push([v, w]);
    }
}
