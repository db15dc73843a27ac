//! The border graph of regions: nodes, where three borders meet or a side ends, and the runs of edges between them.

use super::disc::Disc;
use crate::mesh::{HalfedgeId, IdVec, TriMesh, VertexId, face_of};
use glam::DVec3;
use std::collections::BTreeSet;

/// A run of border edges from a node to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Its half-edges in order, with the first region at their left.
    pub path: Vec<HalfedgeId>,
    /// The regions at its left and right; none beyond the boundary of the mesh.
    pub regions: [Option<u32>; 2],
}

/// A run in the direction in which it has a region at its left.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Way {
    /// The run.
    pub run: usize,
    /// True against the run's own direction.
    pub reversed: bool,
}

/// The borders of all regions of a mesh.
#[derive(Clone, Debug)]
pub struct Borders {
    /// All runs.
    pub runs: Vec<Run>,
    /// For every region the runs around it, counter-clockwise.
    pub around: Vec<Vec<Way>>,
}

/// The vertices where other than two border edges meet: there regions, or the boundary, change.
pub fn natural_nodes(mesh: &TriMesh, discs: &[Disc]) -> BTreeSet<VertexId> {
    let mut degree = IdVec::<VertexId, u32>::filled(0, mesh.positions.len());
    for &h in discs.iter().flat_map(|disc| &disc.rim) {
        // Edges between two regions are on two rims.
        let share = if mesh.conn.twin(h).is_some() { 1 } else { 2 };
        degree[mesh.conn.from(h)] += share;
        degree[mesh.conn.to(h)] += share;
    }
    degree.iter_ids().filter(|&(_, &d)| d != 0 && d != 4).map(|(v, _)| v).collect()
}

impl Borders {
    /// The runs between nodes; every rim has one.
    pub fn new(mesh: &TriMesh, discs: &[Disc], nodes: &BTreeSet<VertexId>) -> Self {
        let mut region_of = IdVec::filled(None, mesh.conn.face_count());
        for (r, disc) in (0u32..).zip(discs) {
            disc.faces.iter().for_each(|&f| region_of[f] = Some(r));
        }
        let mut borders = Borders { runs: Vec::new(), around: Vec::with_capacity(discs.len()) };
        let mut run_of = IdVec::<HalfedgeId, Option<usize>>::filled(None, 3 * mesh.conn.face_count());
        for disc in discs {
            let mut around = Vec::new();
            for path in pieces(mesh, disc, nodes) {
                let twin = mesh.conn.twin(path[0]);
                let way = match twin.and_then(|t| run_of[t]) {
                    Some(run) => Way { run, reversed: true },
                    None => {
                        let run = borders.runs.len();
                        path.iter().for_each(|&h| run_of[h] = Some(run));
                        let regions = [Some(path[0]), twin].map(|h| h.and_then(|h| region_of[face_of(h)]));
                        borders.runs.push(Run { path, regions });
                        Way { run, reversed: false }
                    }
                };
                around.push(way);
            }
            borders.around.push(around);
        }
        borders
    }

    /// The vertices along a way, both ends included.
    pub fn vertices(&self, mesh: &TriMesh, way: Way) -> Vec<VertexId> {
        let path = &self.runs[way.run].path;
        let mut vertices: Vec<VertexId> = path.iter().map(|&h| mesh.conn.from(h)).collect();
        vertices.extend(path.last().map(|&h| mesh.conn.to(h)));
        if way.reversed {
            vertices.reverse();
        }
        vertices
    }

    /// The node that a way starts at.
    pub fn start(&self, mesh: &TriMesh, way: Way) -> VertexId {
        let path = &self.runs[way.run].path;
        if way.reversed { mesh.conn.to(path[path.len() - 1]) } else { mesh.conn.from(path[0]) }
    }

    /// The region at the right of a way.
    pub fn beyond(&self, way: Way) -> Option<u32> {
        self.runs[way.run].regions[usize::from(!way.reversed)]
    }
}

/// A rim cut at the nodes on it.
fn pieces(mesh: &TriMesh, disc: &Disc, nodes: &BTreeSet<VertexId>) -> Vec<Vec<HalfedgeId>> {
    let is_node = |h: &HalfedgeId| nodes.contains(&mesh.conn.from(*h));
    let first = disc.rim.iter().position(is_node).unwrap_or(0);
    let mut pieces: Vec<Vec<HalfedgeId>> = Vec::new();
    for i in 0..disc.rim.len() {
        let h = disc.rim[(first + i) % disc.rim.len()];
        match pieces.last_mut().filter(|_| !is_node(&h)) {
            Some(piece) => piece.push(h),
            None => pieces.push(vec![h]),
        }
    }
    pieces
}

/// Rounds in which the teeth are taken off a path before it is measured.
const SMOOTHINGS: usize = 4;
/// A step counts at least this share of its length, so that no two vertices of a path come to the same place.
const LEAST_STEP: f64 = 0.05;

/// The length of a path of vertices up to each of them, without its teeth: borders zigzag with the triangles, more on one mesh
/// or stretch of it than on another. Paths that turn one way, or not at all, keep their length.
pub fn walked(mesh: &TriMesh, vertices: &[VertexId]) -> Vec<f64> {
    let raw: Vec<DVec3> = vertices.iter().map(|&v| mesh.positions[v]).collect();
    let mut points = raw.clone();
    (0..SMOOTHINGS).for_each(|_| take_teeth_off(&mut points));
    let mut walked = vec![0.0];
    for i in 1..raw.len() {
        let step = points[i - 1].distance(points[i]).max(LEAST_STEP * raw[i - 1].distance(raw[i]));
        walked.push(walked[i - 1] + step);
    }
    walked
}

/// Moves the points where a path turns against its turns before and after half the way to the chord.
fn take_teeth_off(points: &mut [DVec3]) {
    let to_chord = |w: &[DVec3]| {
        let (from, to) = (w[0].distance(w[1]), w[1].distance(w[2]));
        if from + to > 0.0 { w[0].lerp(w[2], from / (from + to)) - w[1] } else { DVec3::ZERO }
    };
    let mut turns = vec![DVec3::ZERO; points.len()];
    points.windows(3).enumerate().for_each(|(i, w)| turns[i + 1] = to_chord(w));
    for i in 1..points.len().saturating_sub(1) {
        if turns[i].dot(turns[i - 1] + turns[i + 1]) < 0.0 {
            points[i] += 0.5 * turns[i];
        }
    }
}

/// The inner vertex of a path nearest to a share of its length; none without inner vertices.
pub fn vertex_at_share(mesh: &TriMesh, vertices: &[VertexId], share: f64) -> Option<usize> {
    let walked = walked(mesh, vertices);
    let goal = share * walked.last()?;
    let inner = 1..vertices.len().saturating_sub(1);
    inner.min_by(|&i, &j| (walked[i] - goal).abs().total_cmp(&(walked[j] - goal).abs()).then(i.cmp(&j)))
}
