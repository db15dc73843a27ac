//! A cut mesh built anew from its arcs: straightened, and free of the vertices that tracing left behind.
//!
//! Every arc is reduced to the vertices and edge points of the original mesh that it passes. Inside an original face it
//! becomes straight steps between points of the face's boundary; steps of arcs that did not cross still do not, because
//! whether two straight steps in a triangle cross depends only on the order of their ends.

use super::base_complex::DirectedArc;
use super::cut_mesh::CutMesh;
use super::face_cells::{BoundaryPoint, cells_of_face, triangulate};
use crate::error::{Error, Result};
use crate::mesh::{ArcId, FaceId, HalfedgeId, Id, IdVec, LandmarkId, SurfacePoint, TriMesh, VertexId, corner, face_of};
use glam::DVec3;

/// Rounds of straightening; arcs bend over a few faces only, and each round moves bends by about one face.
const ROUNDS: usize = 20;
/// Crossings keep apart, and off the ends of their edge, by this share of the mean gap on it: with less, taut bundles of
/// arcs become needle triangles and in the end one point; with more, arcs keep bends that they do not need.
const ELBOW_ROOM: f64 = 0.05;
/// Arcs that may be laid before a cut mesh is rebuilt: each may quarter the gaps between crossings.
const ARCS_BETWEEN_REBUILDS: u32 = 8;

/// Keeps a growing cut mesh small and its crossings apart by rebuilding it now and then.
///
/// Without it, arcs that wind around others cross ever more of the edges that laying those has left behind.
#[derive(Clone, Copy, Debug, Default)]
pub struct Upkeep {
    arcs_laid: u32,
    vertices: usize,
}

impl Upkeep {
    /// To be called after an arc was laid; `arcs` may list arcs that are not on the mesh.
    pub fn after_arc(
        &mut self,
        mesh: &TriMesh,
        cut: &mut CutMesh,
        arcs: &IdVec<ArcId, [LandmarkId; 2]>,
        edge_nodes: u32,
    ) {
        self.arcs_laid += 1;
        let doubled = cut.conn.vertex_count() > 2 * self.vertices.max(mesh.positions.len());
        if doubled || self.arcs_laid >= ARCS_BETWEEN_REBUILDS {
            // What cannot be rebuilt stays as it is, finer than need be.
            if let Ok(rebuilt) = rebuild(mesh, cut, arcs, edge_nodes) {
                *cut = rebuilt;
            }
            *self = Upkeep { arcs_laid: 0, vertices: cut.conn.vertex_count() };
        }
    }
}

/// A vertex or an edge crossing that an arc passes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stop {
    Vertex(VertexId),
    /// On the edge with this lower-numbered half; the number indexes [`Network::crossings`].
    Crossing(usize),
}

/// A crossing of an arc with an original edge.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    edge: HalfedgeId,
    t: f64,
    /// Its place among the crossings of the edge.
    rank: usize,
    /// Its place among the points of its arc's curve.
    point: usize,
}

struct Network<'a> {
    mesh: &'a TriMesh,
    crossings: Vec<Crossing>,
    /// For every arc its stops in order.
    stops: IdVec<ArcId, Vec<Stop>>,
    /// For every original edge, by its lower-numbered half, its crossings in order.
    on_edge: IdVec<HalfedgeId, Vec<usize>>,
}

/// Builds the cut mesh of `arcs` (given by their ends) from the polylines they follow on `cut`.
///
/// Fails only if two crossings of one edge coincide in floating point; the caller then keeps `cut`.
pub fn rebuild(
    mesh: &TriMesh,
    cut: &CutMesh,
    arcs: &IdVec<ArcId, [LandmarkId; 2]>,
    edge_nodes: u32,
) -> Result<CutMesh> {
    let curve = |(arc, ends): (ArcId, &[LandmarkId; 2])| polyline(cut, arc, ends[0]);
    let curves: IdVec<ArcId, Vec<SurfacePoint>> = arcs.iter_ids().map(curve).collect();
    let mut network = Network::new(mesh, &curves)?;
    for _ in 0..ROUNDS {
        network.straighten();
    }
    network.build(&cut.landmarks.raw, edge_nodes)
}

/// A curve on a mesh: its points, each with the share of the curve that lies before it.
pub type Curve = Vec<(SurfacePoint, f64)>;

/// The cut mesh of arcs that are given as curves, and the share of its arc at every vertex of every arc.
///
/// Fails if two of them cross an edge at one point, or cross each other.
pub fn cut_along(
    mesh: &TriMesh,
    curves: &IdVec<ArcId, Curve>,
    landmarks: &[VertexId],
    edge_nodes: u32,
) -> Result<(CutMesh, IdVec<ArcId, Vec<f64>>)> {
    let network = Network::new(mesh, &points_of(curves))?;
    let shares = network.stops.iter_ids().map(|(arc, stops)| network.shares(&curves[arc], stops)).collect();
    Ok((network.build(landmarks, edge_nodes)?, shares))
}

fn points_of(curves: &IdVec<ArcId, Curve>) -> IdVec<ArcId, Vec<SurfacePoint>> {
    curves.iter().map(|curve| curve.iter().map(|&(point, _)| point).collect()).collect()
}

impl<'a> Network<'a> {
    fn new(mesh: &'a TriMesh, curves: &IdVec<ArcId, Vec<SurfacePoint>>) -> Result<Self> {
        let on_edge = IdVec::filled(Vec::new(), 3 * mesh.conn.face_count());
        let mut network = Network { mesh, crossings: Vec::new(), stops: IdVec::default(), on_edge };
        for points in curves.iter() {
            let stops = network.stops_of(points);
            network.stops.push(stops);
        }
        for stop in network.stops.iter().flatten() {
            if let Stop::Crossing(c) = *stop {
                network.on_edge[network.crossings[c].edge].push(c);
            }
        }
        for on in &mut network.on_edge.raw {
            on.sort_by(|&a, &b| network.crossings[a].t.total_cmp(&network.crossings[b].t));
            let apart = |w: &[usize]| network.crossings[w[0]].t < network.crossings[w[1]].t;
            if !on.windows(2).all(apart) {
                return Err(Error::bug("two arcs cross an edge at one point").at(network.crossings[on[0]].edge));
            }
            for (rank, &c) in on.iter().enumerate() {
                network.crossings[c].rank = rank;
            }
        }
        network.spread();
        Ok(network)
    }

    /// Moves crossings apart where the gaps on an edge are very uneven.
    fn spread(&mut self) {
        for on in &self.on_edge.raw {
            let mean = 1.0 / (on.len() + 1) as f64;
            let t = |i: usize| on.get(i).map_or(1.0, |&c| self.crossings[c].t);
            let gap = |i: usize| if i == 0 { t(0) } else { t(i) - t(i - 1) };
            let least = (0..=on.len()).map(gap).fold(f64::INFINITY, f64::min);
            // The blend of the crossings with evenly spaced ones whose least gap is wide enough.
            let blend = ((ELBOW_ROOM * mean - least) / (mean - least)).max(0.0);
            for (i, &c) in on.iter().enumerate().filter(|_| blend > 0.0) {
                let t = &mut self.crossings[c].t;
                *t += blend * ((i + 1) as f64 * mean - *t);
            }
        }
    }

    /// Reduces a polyline to its stops, without steps along the inside of an edge.
    fn stops_of(&mut self, points: &[SurfacePoint]) -> Vec<Stop> {
        let mut stops = Vec::new();
        for (point, &p) in points.iter().enumerate() {
            stops.push(match p {
                SurfacePoint::Vertex(v) => Stop::Vertex(v),
                SurfacePoint::Face(..) => continue,
                SurfacePoint::Edge(h, t) => {
                    let edge = self.mesh.conn.edge_representative(h);
                    self.crossings.push(Crossing { edge, t: if edge == h { t } else { 1.0 - t }, rank: 0, point });
                    Stop::Crossing(self.crossings.len() - 1)
                }
            });
        }
        self.remove_slides(&mut stops);
        stops
    }

    /// Removes the steps that slide along an edge.
    fn remove_slides(&self, stops: &mut Vec<Stop>) {
        let mut i = 0;
        while i + 1 < stops.len() {
            let slide = match (stops[i], stops[i + 1]) {
                (Stop::Crossing(a), Stop::Crossing(b)) if self.crossings[a].edge == self.crossings[b].edge => {
                    let (before, after) =
                        (self.face_of_step(stops, i.wrapping_sub(1)), self.face_of_step(stops, i + 1));
                    if before == after { i..i + 2 } else { i + 1..i + 2 }
                }
                (Stop::Vertex(v), Stop::Crossing(c)) if self.ends(c).contains(&v) => i + 1..i + 2,
                (Stop::Crossing(c), Stop::Vertex(v)) if self.ends(c).contains(&v) => i..i + 1,
                _ => {
                    i += 1;
                    continue;
                }
            };
            stops.drain(slide);
            // Only the steps just before can have become slides.
            i = i.saturating_sub(2);
        }
    }

    fn ends(&self, crossing: usize) -> [VertexId; 2] {
        let h = self.crossings[crossing].edge;
        [self.mesh.conn.from(h), self.mesh.conn.to(h)]
    }

    /// The original face that step `i` (from stop `i` to stop `i + 1`) crosses; None for a step along a whole edge.
    fn face_of_step(&self, stops: &[Stop], i: usize) -> Option<FaceId> {
        let (&a, &b) = (stops.get(i)?, stops.get(i + 1)?);
        let (at_a, at_b) = (self.faces_at(a), self.faces_at(b));
        let mut common = at_a.iter().filter(|f| at_b.contains(f));
        let first = common.next();
        match (a, b) {
            (Stop::Vertex(_), Stop::Vertex(_)) => None,
            _ => first.copied(),
        }
    }

    fn faces_at(&self, stop: Stop) -> Vec<FaceId> {
        match stop {
            Stop::Vertex(v) => self.mesh.conn.outgoing(v).map(face_of).collect(),
            Stop::Crossing(c) => {
                let h = self.crossings[c].edge;
                [Some(h), self.mesh.conn.twin(h)].into_iter().flatten().map(face_of).collect()
            }
        }
    }

    fn position(&self, stop: Stop) -> DVec3 {
        match stop {
            Stop::Vertex(v) => self.mesh.positions[v],
            Stop::Crossing(c) => SurfacePoint::Edge(self.crossings[c].edge, self.crossings[c].t).position(self.mesh),
        }
    }

    /// Moves every crossing towards the straight line between its neighbours, unfolded, keeping the order on its edge.
    fn straighten(&mut self) {
        for arc in self.stops.ids() {
            for i in 1..self.stops[arc].len().max(1) - 1 {
                let Stop::Crossing(c) = self.stops[arc][i] else { continue };
                let (p, q) = (self.position(self.stops[arc][i - 1]), self.position(self.stops[arc][i + 1]));
                if let Some(t) = self.straight_share(c, p, q) {
                    let (low, high) = self.room(c);
                    self.crossings[c].t = t.clamp(low, high);
                }
            }
        }
    }

    /// Where the straight line from `p` to `q`, unfolded about the edge of the crossing, meets that edge.
    fn straight_share(&self, c: usize, p: DVec3, q: DVec3) -> Option<f64> {
        let [a, b] = self.ends(c).map(|v| self.mesh.positions[v]);
        let along = (b - a) / (b - a).length_squared();
        let height = |x: DVec3| ((x - a) - (b - a) * (x - a).dot(along)).length();
        let (hp, hq) = (height(p), height(q));
        let t = ((p - a).dot(along) * hq + (q - a).dot(along) * hp) / (hp + hq);
        t.is_finite().then_some(t)
    }

    /// The interval a crossing may move in.
    fn room(&self, c: usize) -> (f64, f64) {
        let Crossing { edge, t, rank: at, .. } = self.crossings[c];
        let on = &self.on_edge[edge];
        let low = if at > 0 { self.crossings[on[at - 1]].t } else { 0.0 };
        let high = on.get(at + 1).map_or(1.0, |&k| self.crossings[k].t);
        let room = ELBOW_ROOM / (on.len() + 1) as f64;
        (low + room.min(t - low), high - room.min(high - t))
    }

    /// The shares of a curve at its stops.
    fn shares(&self, curve: &Curve, stops: &[Stop]) -> Vec<f64> {
        let at = |stop: &Stop| match *stop {
            Stop::Crossing(c) => curve[self.crossings[c].point].1,
            Stop::Vertex(v) => curve.iter().find(|(p, _)| *p == SurfacePoint::Vertex(v)).map_or(0.0, |p| p.1),
        };
        let mut shares: Vec<f64> = stops.iter().map(at).collect();
        if let (Some(last), Some(end)) = (shares.last_mut(), curve.last()) {
            // Where the curve ends at the vertex at which it starts.
            *last = end.1;
        }
        shares
    }

    fn build(&self, landmarks: &[VertexId], edge_nodes: u32) -> Result<CutMesh> {
        let vertex_of: Vec<VertexId> =
            (0..self.crossings.len()).map(|c| VertexId::new(self.mesh.positions.len() + c)).collect();
        let (used, vertex_of) = self.number_crossings(vertex_of);
        let mut origin: Vec<SurfacePoint> = self.mesh.conn.vertices().map(SurfacePoint::Vertex).collect();
        origin.extend(used.iter().map(|&c| SurfacePoint::Edge(self.crossings[c].edge, self.crossings[c].t)));
        let chords = self.chords(&vertex_of);
        let mut faces = Vec::with_capacity(self.mesh.conn.face_count());
        let mut face_origin = Vec::with_capacity(self.mesh.conn.face_count());
        for f in self.mesh.conn.faces() {
            if chords[f].is_empty() && !self.is_crossed(f) {
                faces.push(self.mesh.face(f));
                face_origin.push(f);
                continue;
            }
            let boundary = self.boundary(f, &vertex_of);
            for cell in cells_of_face(&boundary, &chords[f]) {
                let position = |p: &BoundaryPoint| origin[p.vertex.index()].position(self.mesh);
                for triangle in triangulate(&cell, &position) {
                    faces.push(triangle);
                    face_origin.push(f);
                }
            }
        }
        let mut built = CutMesh::assemble(self.mesh, &faces, origin, face_origin, landmarks, edge_nodes)?;
        self.mark_arcs(&mut built, &vertex_of)?;
        Ok(built)
    }

    /// Numbers the crossings still in use behind the original vertices.
    fn number_crossings(&self, mut vertex_of: Vec<VertexId>) -> (Vec<usize>, Vec<VertexId>) {
        let mut used: Vec<usize> = self.on_edge.iter().flatten().copied().collect();
        used.sort_unstable();
        for (k, &c) in used.iter().enumerate() {
            vertex_of[c] = VertexId::new(self.mesh.positions.len() + k);
        }
        (used, vertex_of)
    }

    fn vertex(&self, stop: Stop, vertex_of: &[VertexId]) -> VertexId {
        match stop {
            Stop::Vertex(v) => v,
            Stop::Crossing(c) => vertex_of[c],
        }
    }

    /// For every original face the steps that cross it, as pairs of vertices.
    fn chords(&self, vertex_of: &[VertexId]) -> IdVec<FaceId, Vec<[VertexId; 2]>> {
        let mut chords = IdVec::filled(Vec::new(), self.mesh.conn.face_count());
        for stops in self.stops.iter() {
            for i in 0..stops.len() - 1 {
                if let Some(f) = self.face_of_step(stops, i) {
                    chords[f].push([stops[i], stops[i + 1]].map(|s| self.vertex(s, vertex_of)));
                }
            }
        }
        chords
    }

    /// True if an arc crosses a side of the face.
    fn is_crossed(&self, f: FaceId) -> bool {
        (0..3).any(|i| !self.on_edge[self.mesh.conn.edge_representative(corner(f, i))].is_empty())
    }

    /// The corners and crossings around an original face, counter-clockwise.
    fn boundary(&self, f: FaceId, vertex_of: &[VertexId]) -> Vec<BoundaryPoint> {
        let mut points = Vec::new();
        for i in 0..3 {
            let h = corner(f, i);
            points.push(BoundaryPoint::at_corner(self.mesh.conn.from(h), i));
            let edge = self.mesh.conn.edge_representative(h);
            let mut on: Vec<VertexId> = self.on_edge[edge].iter().map(|&c| vertex_of[c]).collect();
            if edge != h {
                on.reverse();
            }
            points.extend(on.into_iter().map(|v| BoundaryPoint::on_side(v, i)));
        }
        points
    }

    fn mark_arcs(&self, built: &mut CutMesh, vertex_of: &[VertexId]) -> Result<()> {
        for (arc, stops) in self.stops.iter_ids() {
            for pair in stops.windows(2) {
                let [a, b] = [pair[0], pair[1]].map(|s| self.vertex(s, vertex_of));
                let h = built.conn.find(a, b).ok_or_else(|| {
                    Error::bug("a step of an arc is missing from the rebuilt mesh").at(format!("{arc}, {a} to {b}"))
                })?;
                built.mark(h, DirectedArc { arc, reversed: false });
            }
        }
        Ok(())
    }
}

/// The points of the original mesh that an arc passes.
fn polyline(cut: &CutMesh, arc: ArcId, first: LandmarkId) -> Vec<SurfacePoint> {
    let path = cut.arc_path(arc, first);
    let start = cut.origin[cut.landmarks[first]];
    std::iter::once(start).chain(path.iter().map(|&h| cut.origin[cut.conn.to(h)])).collect()
}
