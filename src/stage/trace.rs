//! Stage: the layout of the source (VORONOI 5.1).
//!
//! Input: a mesh, its landmarks, their clusters. Output: arcs embedded in a cut mesh so that every region between them
//! is a disc with three sides. Invariant: after every arc the arcs do not cross, for they run along edges. First one
//! arc goes through every cut, inside the two clusters that touch there; then regions in several parts are joined,
//! handles are cut open by the shortest arcs that do not separate, and regions with more than three sides are halved by
//! their shortest diagonal.

use crate::error::{Error, Result};
use crate::mesh::{ArcId, FaceId, HalfedgeId, Id, IdVec, LandmarkId, TriMesh, VertexId, corner, face_of};
use crate::path::base_complex::{BaseComplex, DirectedArc};
use crate::path::cluster::Clusters;
use crate::path::cut_mesh::CutMesh;
use crate::path::edge_loop::GivenArc;
use crate::path::handle::lay_across_handle;
use crate::path::network::{Corner, connect, embed};
use crate::path::rebuild::Upkeep;
use crate::path::region::{Regions, base_complex, walk_along};
use crate::path::search::{Passage, Path, Searcher, Terminal};
use crate::path::side::Explorer;

/// How an arc came about; decides when it is carried over to the target (VORONOI, procedure 1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Link {
    /// Along a boundary loop or a guide; not traced, and first in number.
    Given,
    /// Through a cut between two clusters.
    Cut,
    /// Joins parts of a region, opens a handle, or halves a region with more than three sides.
    Diagonal,
}

/// A complete layout on one mesh.
#[derive(Clone, Debug)]
pub struct Traced {
    /// The cut mesh that carries the arcs.
    pub cut: CutMesh,
    /// The arcs and the patches between them.
    pub base: BaseComplex,
    /// How every arc came about.
    pub links: IdVec<ArcId, Link>,
    /// Length of every arc in mesh units.
    pub lengths: IdVec<ArcId, f64>,
}

/// Traces the arcs of the source, beginning with those that are given.
pub fn trace(
    mesh: &TriMesh,
    landmarks: &[VertexId],
    given: &[GivenArc],
    clusters: &Clusters,
    edge_nodes: u32,
) -> Result<Traced> {
    let mut tracer = Tracer {
        mesh,
        edge_nodes,
        searcher: Searcher::default(),
        explorer: Explorer::default(),
        upkeep: Upkeep::default(),
        cut: CutMesh::new(mesh, landmarks, edge_nodes),
        arcs: IdVec::default(),
        links: IdVec::default(),
        lengths: IdVec::default(),
    };
    tracer.lay_given(given);
    tracer.link_through_cuts(clusters)?;
    while tracer.split_one_region()? {}
    let Tracer { cut, arcs, links, lengths, .. } = tracer;
    Ok(Traced { base: base_complex(&cut, &arcs)?, cut, links, lengths })
}

struct Tracer<'a> {
    mesh: &'a TriMesh,
    edge_nodes: u32,
    searcher: Searcher,
    explorer: Explorer,
    upkeep: Upkeep,
    cut: CutMesh,
    arcs: IdVec<ArcId, [LandmarkId; 2]>,
    links: IdVec<ArcId, Link>,
    lengths: IdVec<ArcId, f64>,
}

impl Tracer<'_> {
    /// Notes an arc that has been laid.
    fn note(&mut self, ends: [LandmarkId; 2], link: Link, length: f64) {
        self.arcs.push(ends);
        self.links.push(link);
        self.lengths.push(length);
        self.upkeep.after_arc(self.mesh, &mut self.cut, &self.arcs, self.edge_nodes);
    }

    /// Adds an arc through a cut, unless it would enclose nothing together with an arc that is already there.
    ///
    /// That happens where landmarks lie so close together that a cut runs through one of them.
    fn add_unless_empty(&mut self, ends: [LandmarkId; 2], path: &Path) -> Result<()> {
        let arc = ArcId::new(self.arcs.len());
        embed(&mut self.cut, self.mesh, path, arc)?;
        let h = self.cut.arc_path(arc, ends[0]).first().copied();
        let sides = [h, h.and_then(|h| self.cut.conn.twin(h))];
        if sides.into_iter().flatten().any(|h| self.encloses_nothing(h)) {
            self.cut.unmark(arc, ends[0]);
        } else {
            self.note(ends, Link::Cut, path.length);
        }
        Ok(())
    }

    /// Lays the arcs along the boundary and the guides.
    fn lay_given(&mut self, given: &[GivenArc]) {
        for one in given {
            let arc = self.arcs.push(one.ends);
            self.links.push(Link::Given);
            self.lengths.push(one.length(&self.cut));
            one.lay(&mut self.cut, arc);
        }
    }

    /// True if left of a half-edge with an arc lies an empty disc with one or two sides: no triangle can fill it.
    ///
    /// A single open arc on a sphere also has a walk of two sides, but the walk runs along both sides of one arc.
    fn encloses_nothing(&mut self, h: HalfedgeId) -> bool {
        let walk = walk_along(&self.cut, h);
        if walk.len() > 2 || walk.iter().all(|d| walk.contains(&d.flipped())) {
            return false;
        }
        let side = self.explorer.left_of(&self.cut, h);
        side.euler == 1 && side.isolated.is_empty() && side.boundary.len() == walk.len()
    }

    /// One arc through every cut, the nearest cuts first.
    fn link_through_cuts(&mut self, clusters: &Clusters) -> Result<()> {
        let cut_of_edge = number_cut_edges(self.mesh, clusters);
        let mut order: Vec<(f64, usize)> = (0..clusters.cuts.len()).map(|c| (gap(self.mesh, clusters, c), c)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, c) in order {
            let ends = clusters.cuts[c].clusters;
            let passage = ThroughCut::new(self.mesh, &self.cut, clusters, &cut_of_edge, c);
            let [start, goal] = ends.map(|l| Terminal::whole(&self.cut, self.cut.landmarks[l]));
            if let Some(path) = self.searcher.shortest(&self.cut, &start, &goal, &passage) {
                self.add_unless_empty(ends, &path)?;
            }
        }
        Ok(())
    }

    /// Adds one arc to the first region that is not yet a triangle; false when all are.
    fn split_one_region(&mut self) -> Result<bool> {
        let regions = Regions::find(&self.cut);
        for (r, walks) in regions.walks.iter().enumerate() {
            let parts = parts(&self.arcs, walks, &regions.isolated[r]);
            let (ends, length) = match parts.as_slice() {
                [walk] if regions.genus[r] > 0 => self.open_handle(walk)?,
                [walk] if walk.len() == 3 => continue,
                [walk] => self.lay_shortest(diagonals(walk))?,
                _ => self.lay_shortest(joins(&parts))?,
            };
            self.note(ends, Link::Diagonal, length);
            return Ok(true);
        }
        Ok(false)
    }

    fn open_handle(&mut self, corners: &[Corner]) -> Result<([LandmarkId; 2], f64)> {
        let arc = ArcId::new(self.arcs.len());
        let ends = [corners, corners];
        let laid = lay_across_handle(&mut self.cut, self.mesh, &mut self.searcher, ends, arc)?;
        Ok((laid.ends, laid.length))
    }

    fn lay_shortest(&mut self, candidates: Vec<[Corner; 2]>) -> Result<([LandmarkId; 2], f64)> {
        let (ends, path) = self.shortest_of(candidates)?;
        embed(&mut self.cut, self.mesh, &path, ArcId::new(self.arcs.len()))?;
        Ok((ends.map(|c| c.landmark), path.length))
    }

    /// The shortest path among candidate ends; the straight distance tells which need not be searched.
    fn shortest_of(&mut self, candidates: Vec<[Corner; 2]>) -> Result<([Corner; 2], Path)> {
        let at = |c: Corner| self.cut.positions[self.cut.landmarks[c.landmark]];
        let mut sorted: Vec<(f64, [Corner; 2])> =
            candidates.into_iter().map(|ends| (at(ends[0]).distance(at(ends[1])), ends)).collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let nodes = self.cut.node_count();
        let mut best: Option<([Corner; 2], Path)> = None;
        for (straight, ends) in sorted {
            if best.as_ref().is_some_and(|(_, path)| path.length <= straight) {
                break;
            }
            let path = connect(&mut self.cut, self.mesh, &mut self.searcher, ends)?;
            if best.as_ref().is_none_or(|(_, other)| path.length < other.length) {
                best = Some((ends, path));
            }
        }
        let (ends, path) = best.ok_or_else(|| {
            Error::unsolvable("the landmarks are too few to span a layout").remedy("give at least three")
        })?;
        if self.cut.node_count() == nodes {
            return Ok((ends, path));
        }
        // A search refined the region, so nodes found before it may be gone.
        let path = connect(&mut self.cut, self.mesh, &mut self.searcher, ends)?;
        Ok((ends, path))
    }
}

/// The corners of every boundary walk of a region, and its isolated landmarks.
pub(super) fn parts(
    arcs: &IdVec<ArcId, [LandmarkId; 2]>,
    walks: &[Vec<DirectedArc>],
    isolated: &[LandmarkId],
) -> Vec<Vec<Corner>> {
    let start = |d: DirectedArc| arcs[d.arc][usize::from(d.reversed)];
    let walk_corners =
        |w: &Vec<DirectedArc>| w.iter().map(|&d| Corner { landmark: start(d), after: Some(d) }).collect();
    let alone = isolated.iter().map(|&landmark| vec![Corner { landmark, after: None }]);
    walks.iter().map(walk_corners).chain(alone).collect()
}

/// Corners of a disc's walk that a diagonal may join: not neighbours, and at one landmark only where there is no choice.
pub(super) fn diagonals(walk: &[Corner]) -> Vec<[Corner; 2]> {
    let n = walk.len();
    let pairs = (0..n).flat_map(|i| (i + 2..n).map(move |j| (i, j))).filter(|&(i, j)| (j + 1) % n != i);
    let pairs: Vec<[Corner; 2]> = pairs.map(|(i, j)| [walk[i], walk[j]]).collect();
    let open: Vec<[Corner; 2]> = pairs.iter().filter(|[a, b]| a.landmark != b.landmark).copied().collect();
    if open.is_empty() { pairs } else { open }
}

/// Corners in different parts of a region.
pub(super) fn joins(parts: &[Vec<Corner>]) -> Vec<[Corner; 2]> {
    let mut pairs = Vec::new();
    for (i, part) in parts.iter().enumerate() {
        for &a in part {
            pairs.extend(parts[i + 1..].iter().flatten().map(|&b| [a, b]));
        }
    }
    pairs
}

/// Shortest way from landmark to landmark through a cut, along the face graph.
fn gap(mesh: &TriMesh, clusters: &Clusters, c: usize) -> f64 {
    let across = |&h: &HalfedgeId| {
        let other = mesh.conn.twin(h).map_or(f64::INFINITY, |t| clusters.distance[face_of(t)]);
        clusters.distance[face_of(h)] + other
    };
    clusters.cuts[c].halfedges.iter().map(across).fold(f64::INFINITY, f64::min)
}

/// For every half-edge of the mesh the cut it belongs to.
fn number_cut_edges(mesh: &TriMesh, clusters: &Clusters) -> IdVec<HalfedgeId, Option<usize>> {
    let mut number = IdVec::filled(None, 3 * mesh.conn.face_count());
    for (c, cut) in clusters.cuts.iter().enumerate() {
        for &h in &cut.halfedges {
            number[h] = Some(c);
            if let Some(t) = mesh.conn.twin(h) {
                number[t] = Some(c);
            }
        }
    }
    number
}

/// Lets a path cross two clusters, and pass between them only at one of their cuts.
struct ThroughCut<'a> {
    mesh: &'a TriMesh,
    cut: &'a CutMesh,
    clusters: &'a Clusters,
    cut_of_edge: &'a IdVec<HalfedgeId, Option<usize>>,
    wanted: usize,
    several: bool,
}

impl<'a> ThroughCut<'a> {
    fn new(
        mesh: &'a TriMesh,
        cut: &'a CutMesh,
        clusters: &'a Clusters,
        cut_of_edge: &'a IdVec<HalfedgeId, Option<usize>>,
        wanted: usize,
    ) -> Self {
        let [a, b] = clusters.cuts[wanted].clusters;
        ThroughCut { mesh, cut, clusters, cut_of_edge, wanted, several: clusters.linkage(a, b) > 1 }
    }

    fn is_other_cut(&self, c: Option<usize>) -> bool {
        let cuts = &self.clusters.cuts;
        c.is_some_and(|c| c != self.wanted && cuts[c].clusters == cuts[self.wanted].clusters)
    }
}

impl Passage for ThroughCut<'_> {
    fn face(&self, f: FaceId) -> bool {
        let label = self.clusters.of_face[self.cut.face_origin[f]];
        label.is_some_and(|l| self.clusters.cuts[self.wanted].clusters.contains(&l))
    }

    fn edge(&self, h: HalfedgeId) -> bool {
        let Some(t) = self.cut.conn.twin(h).filter(|_| self.several) else { return true };
        let [f, g] = [h, t].map(|k| self.cut.face_origin[face_of(k)]);
        let between = |k: &HalfedgeId| self.mesh.conn.twin(*k).is_some_and(|k| face_of(k) == g);
        let common = (0..3).map(|i| corner(f, i)).find(between);
        f == g || !common.is_some_and(|k| self.is_other_cut(self.cut_of_edge[k]))
    }

    fn vertex(&self, v: VertexId) -> bool {
        if !self.several || v.index() >= self.mesh.positions.len() {
            return true;
        }
        !self.mesh.conn.outgoing(v).any(|h| self.is_other_cut(self.cut_of_edge[h]))
    }
}
