//! The network of arcs growing on a cut mesh: sectors around landmarks, tracing paths, embedding them as arcs.

use super::base_complex::DirectedArc;
use super::cut_mesh::{CutMesh, Place};
use super::search::{Anywhere, Path, Searcher, Terminal};
use crate::error::{Error, Result};
use crate::mesh::{ArcId, FaceId, HalfedgeId, IdVec, LandmarkId, TriMesh, VertexId, corner, face_of};

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
/// Fails if the path touches itself, which a shortest path never does.
pub fn embed(cut: &mut CutMesh, mesh: &TriMesh, path: &Path, arc: ArcId) -> Result<()> {
    let torn = |a: VertexId| Error::bug("a traced path does not embed").at(format!("{arc} near {a}"));
    let mut vertices = Vec::with_capacity(path.nodes.len());
    for &node in &path.nodes {
        vertices.push(match cut.place(node) {
            Place::Vertex(v) => v,
            Place::Edge(h, t) if cut.nodes_on(h).iter().contains(&node) => cut.split_edge(mesh, h, t),
            Place::Edge(h, _) => return Err(torn(cut.conn.from(h))),
        });
    }
    for pair in vertices.windows(2) {
        let h = cut.conn.find(pair[0], pair[1]).ok_or_else(|| torn(pair[0]))?;
        cut.mark(h, DirectedArc { arc, reversed: false });
    }
    Ok(())
}

/// The open end at a corner.
fn terminal(cut: &CutMesh, corner: Corner) -> Option<Terminal> {
    let vertex = cut.landmarks[corner.landmark];
    let sector = sectors(cut, vertex, &|_| true).into_iter().find(|s| s.after == corner.after)?;
    Some(Terminal { vertex, sector: sector.halfedges })
}

/// The shortest path between two corners of one region.
///
/// If the nodes leave no way although the corners share a region, the region is refined around its blocked vertices;
/// then a way along free vertices exists (`algorithms.md` 4: a path always exists).
pub fn connect(cut: &mut CutMesh, mesh: &TriMesh, searcher: &mut Searcher, ends: [Corner; 2]) -> Result<Path> {
    for _ in 0..2 {
        let [start, goal] = ends.map(|c| terminal(cut, c));
        let (Some(start), Some(goal)) = (start, goal) else {
            return Err(Error::bug("a corner of the layout is missing").at(ends[0].landmark));
        };
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
fn open_up(cut: &mut CutMesh, mesh: &TriMesh, seed: FaceId) {
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
