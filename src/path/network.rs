//! The network of arcs growing on a cut mesh: sectors around landmarks, tracing paths, embedding them as arcs.

use super::base_complex::DirectedArc;
use super::cut_mesh::{CutMesh, Place};
use super::search::{Anywhere, Passage, Path, Searcher, Terminal};
use crate::error::{Error, Result};
use crate::mesh::{ArcId, FaceId, HalfedgeId, Id, IdVec, LandmarkId, TriMesh, VertexId, corner, face_of};
use std::collections::{BTreeMap, HashMap};

/// The faces around a landmark between two neighbouring arcs.
#[derive(Clone, Debug)]
pub struct Sector {
    /// The arc at its clockwise end, leaving the landmark; None if no arc meets the landmark yet.
    pub after: Option<DirectedArc>,
    /// The half-edges leaving the landmark whose left faces make up the sector, counter-clockwise.
    pub halfedges: Vec<HalfedgeId>,
}

/// The sectors around `v`, counter-clockwise, where only arcs that are `active` count.
pub fn sectors(cut: &CutMesh, v: VertexId, active: &dyn Fn(ArcId) -> bool) -> Vec<Sector> {
    let mut sectors: Vec<Sector> = Vec::new();
    let mut head = Vec::new();
    for h in cut.conn.outgoing(v) {
        match (cut.arc_at(h).filter(|d| active(d.arc)), sectors.last_mut()) {
            (Some(arc), _) => sectors.push(Sector { after: Some(arc), halfedges: vec![h] }),
            (None, Some(last)) => last.halfedges.push(h),
            (None, None) => head.push(h),
        }
    }
    match sectors.last_mut() {
        Some(last) => last.halfedges.extend(head),
        None => sectors.push(Sector { after: None, halfedges: head }),
    }
    sectors
}

/// The active arcs leaving a landmark, counter-clockwise.
pub fn rotation(cut: &CutMesh, l: LandmarkId, active: &dyn Fn(ArcId) -> bool) -> Vec<DirectedArc> {
    sectors(cut, cut.landmarks[l], active).iter().filter_map(|s| s.after).collect()
}

/// A place where an arc may end: a landmark, and the sector that follows a given arc around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Corner {
    /// The landmark.
    pub landmark: LandmarkId,
    /// The arc at the clockwise end of the sector; None while no arc meets the landmark.
    pub after: Option<DirectedArc>,
}

/// Embeds a path as an arc: splits the edges it crosses and marks the edges it then runs along.
///
/// The path may cross a face several times (it must where a region is one face wide), as long as it does not cross
/// itself, which a shortest path never does.
pub fn embed(cut: &mut CutMesh, mesh: &TriMesh, path: &Path, arc: ArcId) -> Result<()> {
    Inlay { cut, mesh, arc, whole: HashMap::new() }.lay(path)
}

/// A path being laid into a cut mesh.
struct Inlay<'a> {
    cut: &'a mut CutMesh,
    mesh: &'a TriMesh,
    arc: ArcId,
    /// For every face made by splitting, the face it is a part of.
    whole: HashMap<FaceId, FaceId>,
}

impl Inlay<'_> {
    fn lay(&mut self, path: &Path) -> Result<()> {
        let faces: Vec<FaceId> = path.faces.iter().map(|&f| self.whole_face(f)).collect();
        let vertices = self.make_vertices(path);
        for (pair, &f) in vertices.windows(2).zip(&faces) {
            match self.cut.conn.find(pair[0], pair[1]) {
                Some(h) => self.cut.mark(h, DirectedArc { arc: self.arc, reversed: false }),
                None => self.cross_parts(pair[0], pair[1], f)?,
            }
        }
        Ok(())
    }

    fn whole_face(&self, f: FaceId) -> FaceId {
        self.whole.get(&f).copied().unwrap_or(f)
    }

    /// The vertices of a path, those on edges made by splitting.
    fn make_vertices(&mut self, path: &Path) -> Vec<VertexId> {
        let mut on_edge: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for &node in &path.nodes {
            if let Place::Edge(h, _) = self.cut.place(node) {
                // Splitting other edges renumbers half-edges, but never the nodes of this one.
                on_edge.entry(self.cut.nodes_on(h).start).or_default().push(node);
            }
        }
        let mut made: HashMap<u32, VertexId> = HashMap::new();
        for nodes in on_edge.into_values() {
            self.split_at_all(nodes, &mut made);
        }
        let vertex = |&node: &u32| match self.cut.place(node) {
            Place::Vertex(v) => v,
            Place::Edge(..) => made[&node],
        };
        path.nodes.iter().map(vertex).collect()
    }

    /// Splits an edge at some of its nodes, the farthest from its start first.
    fn split_at_all(&mut self, mut nodes: Vec<u32>, made: &mut HashMap<u32, VertexId>) {
        nodes.sort_unstable();
        nodes.dedup();
        // All nodes of an edge name the same half of it, and are numbered along it.
        let mut length = 1.0;
        for node in nodes.into_iter().rev() {
            let Place::Edge(h, t) = self.cut.place(node) else { continue };
            let sides = [Some(h), self.cut.conn.twin(h)];
            let first_new = self.cut.conn.face_count();
            made.insert(node, self.cut.split_edge(self.mesh, h, t / length));
            for (k, side) in sides.into_iter().flatten().enumerate() {
                self.whole.insert(FaceId::new(first_new + k), self.whole_face(face_of(side)));
            }
            length = t;
        }
    }

    /// Leads the arc from `a` to `b` across the parts of face `f` that earlier steps left between them.
    fn cross_parts(&mut self, a: VertexId, b: VertexId, f: FaceId) -> Result<()> {
        let [start, goal] = [a, b].map(|v| Terminal::whole(self.cut, v));
        let parts = PartsOf { cut: self.cut, whole: &self.whole, face: f };
        let path = Searcher::default().shortest(self.cut, &start, &goal, &parts);
        let torn = || Error::bug("a traced path does not embed").at(format!("{} near {a}", self.arc));
        self.lay(&path.ok_or_else(torn)?)
    }
}

/// Keeps a path inside the parts of one face.
struct PartsOf<'a> {
    cut: &'a CutMesh,
    whole: &'a HashMap<FaceId, FaceId>,
    face: FaceId,
}

impl Passage for PartsOf<'_> {
    fn face(&self, f: FaceId) -> bool {
        self.whole.get(&f).copied().unwrap_or(f) == self.face
    }
    fn edge(&self, h: HalfedgeId) -> bool {
        self.cut.conn.twin(h).is_some_and(|t| self.face(face_of(h)) && self.face(face_of(t)))
    }
    fn vertex(&self, _: VertexId) -> bool {
        false
    }
}

/// The open end at a corner, where only arcs that are `active` bound sectors.
pub fn terminal(cut: &CutMesh, corner: Corner, active: &dyn Fn(ArcId) -> bool) -> Result<Terminal> {
    let vertex = cut.landmarks[corner.landmark];
    let sector = sectors(cut, vertex, active).into_iter().find(|s| s.after == corner.after);
    let missing = || Error::bug("a corner of the layout is missing").at(corner.landmark);
    Ok(Terminal { vertex, sector: sector.ok_or_else(missing)?.halfedges })
}

/// The shortest path between two corners of one region.
///
/// If the nodes leave no way although the corners share a region, the region is refined around its blocked vertices;
/// then a way along free vertices exists.
pub fn connect(cut: &mut CutMesh, mesh: &TriMesh, searcher: &mut Searcher, ends: [Corner; 2]) -> Result<Path> {
    for _ in 0..2 {
        let [start, goal] = ends.map(|c| terminal(cut, c, &|_| true));
        let (start, goal) = (start?, goal?);
        if let Some(path) = searcher.shortest(cut, &start, &goal, &Anywhere) {
            return Ok(path);
        }
        open_up(cut, mesh, face_of(start.sector[0]));
    }
    Err(Error::bug("two corners of one region cannot be joined")
        .at(format!("{} and {}", ends[0].landmark, ends[1].landmark)))
}

/// Refines the region around `seed` until its free vertices are connected: splits every edge between two blocked
/// vertices that carries no arc, then every face without a free vertex.
pub(super) fn open_up(cut: &mut CutMesh, mesh: &TriMesh, seed: FaceId) {
    let faces = region_faces(cut, seed);
    let dividing = |cut: &CutMesh, h: HalfedgeId| {
        cut.arc_at(h).is_none() && cut.is_blocked(cut.conn.from(h)) && cut.is_blocked(cut.conn.to(h))
    };
    for &f in &faces {
        while let Some(h) = (0..3).map(|i| corner(f, i)).find(|&h| dividing(cut, h)) {
            cut.split_edge(mesh, h, 0.5);
        }
    }
    for f in faces {
        if cut.conn.face(f).iter().all(|&v| cut.is_blocked(v)) {
            cut.split_face(mesh, f);
        }
    }
}

/// The faces reachable from `seed` without crossing an arc, in order of discovery.
fn region_faces(cut: &CutMesh, seed: FaceId) -> Vec<FaceId> {
    let mut seen = IdVec::filled(false, cut.conn.face_count());
    seen[seed] = true;
    let mut faces = vec![seed];
    let mut at = 0;
    while let Some(&f) = faces.get(at) {
        at += 1;
        for h in (0..3).map(|i| corner(f, i)).filter(|&h| cut.arc_at(h).is_none()) {
            if let Some(g) = cut.conn.twin(h).map(face_of).filter(|&g| !seen[g]) {
                seen[g] = true;
                faces.push(g);
            }
        }
    }
    faces
}
