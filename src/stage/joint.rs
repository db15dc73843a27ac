//! A layout grown on both meshes at once, every arc chosen for its length on both together.
//!
//! Where the landmarks of one mesh lie in quite another order than those of the other, arcs that are short on one mesh
//! have to wind on the other. Here a spanning tree of arcs comes first, the shortest pairs leading (E. Praun,
//! W. Sweldens, P. Schröder 2001; V. Kraevoy, A. Sheffer 2004); then handles are opened; what is left is one disc, and
//! gets the diagonals of least total length. Shortest paths between corners of a disc cross only if their ends are
//! interleaved, so lengths can be measured before any diagonal is laid.

use super::polygon::{Polygon, triangulate};
use crate::error::{Error, Result};
use crate::mesh::{ArcId, FaceId, Id, IdVec, LandmarkId, TriMesh, VertexId, face_of};
use crate::path::base_complex::{BaseComplex, DirectedArc};
use crate::path::cluster::Clusters;
use crate::path::corner_distance::corner_distances;
use crate::path::cut_mesh::{CutMesh, Place};
use crate::path::handle::lay_across_handle;
use crate::path::network::{Corner, connect, embed, rotation, sectors, terminal};
use crate::path::rebuild::Upkeep;
use crate::path::region::Regions;
use crate::path::search::{Anywhere, Path, Searcher, Terminal};
use crate::path::subcomplex::Subcomplex;
use rayon::prelude::*;

/// A complete layout on both meshes.
pub struct Grown {
    /// The base complex.
    pub base: BaseComplex,
    /// Both cut meshes.
    pub cuts: [CutMesh; 2],
}

/// One mesh and its share of the layout.
struct Half<'a> {
    mesh: &'a TriMesh,
    unit: f64,
    cut: CutMesh,
    searcher: Searcher,
    upkeep: Upkeep,
}

/// Grows a layout; handles are opened where mesh `lead` has them shortest.
pub fn grow(
    meshes: [&TriMesh; 2],
    landmarks: [&[VertexId]; 2],
    clusters: &[Clusters; 2],
    edge_nodes: u32,
    lead: usize,
) -> Result<Grown> {
    let half = |k: usize| Half {
        mesh: meshes[k],
        unit: meshes[k].area().sqrt(),
        cut: CutMesh::new(meshes[k], landmarks[k], edge_nodes),
        searcher: Searcher::default(),
        upkeep: Upkeep::default(),
    };
    let mut growth = Growth { halves: [half(0), half(1)], arcs: IdVec::default(), edge_nodes, lead };
    growth.span(clusters)?;
    let walk = growth.open_handles()?;
    let base = growth.triangulate(&walk)?;
    let [source, target] = growth.halves;
    Ok(Grown { base, cuts: [source.cut, target.cut] })
}

struct Growth<'a> {
    halves: [Half<'a>; 2],
    arcs: IdVec<ArcId, [LandmarkId; 2]>,
    edge_nodes: u32,
    lead: usize,
}

impl Growth<'_> {
    /// Lays a spanning tree over pairs of neighbouring clusters.
    fn span(&mut self, clusters: &[Clusters; 2]) -> Result<()> {
        let mut pairs: Vec<[LandmarkId; 2]> = clusters.iter().flat_map(|c| c.cuts.iter().map(|c| c.clusters)).collect();
        pairs.sort_unstable();
        pairs.dedup();
        let halves = &self.halves;
        let both = |searcher: &mut Searcher, &pair: &[LandmarkId; 2]| {
            halves.iter().map(|half| half.bare_length(searcher, pair)).sum::<f64>()
        };
        let lengths: Vec<f64> = pairs.par_iter().map_init(Searcher::default, both).collect();
        let mut order: Vec<usize> = (0..pairs.len()).collect();
        order.sort_by(|&a, &b| lengths[a].total_cmp(&lengths[b]).then(a.cmp(&b)));
        let mut part: Vec<usize> = (0..self.halves[0].cut.landmarks.len()).collect();
        for pair in order.into_iter().map(|i| pairs[i]) {
            let [a, b] = pair.map(|l| part[l.index()]);
            if a != b {
                part.iter_mut().filter(|p| **p == a).for_each(|p| *p = b);
                self.join(pair)?;
            }
        }
        Ok(())
    }

    /// Lays an arc between two landmarks, in the sectors that are best for either mesh alone, or rather both.
    fn join(&mut self, pair: [LandmarkId; 2]) -> Result<()> {
        let mut best: Option<(f64, [Corner; 2])> = None;
        for k in 0..2 {
            let Some(corners) = self.halves[k].free_corners(pair) else { continue };
            let mut length = 0.0;
            for half in &mut self.halves {
                length += connect(&mut half.cut, half.mesh, &mut half.searcher, corners)?.length / half.unit;
            }
            if best.is_none_or(|(least, _)| length < least) {
                best = Some((length, corners));
            }
        }
        let (_, corners) = best.ok_or_else(|| Error::bug("a landmark is walled in").at(pair[0]))?;
        let arc = self.arcs.push(pair);
        self.lay(arc, corners)
    }

    /// Lays an arc between two corners on both meshes.
    fn lay(&mut self, arc: ArcId, corners: [Corner; 2]) -> Result<()> {
        for half in &mut self.halves {
            let path = connect(&mut half.cut, half.mesh, &mut half.searcher, corners)?;
            embed(&mut half.cut, half.mesh, &path, arc)?;
            half.upkeep.after_arc(half.mesh, &mut half.cut, &self.arcs, self.edge_nodes);
        }
        Ok(())
    }

    /// Opens handles and joins boundary walks until the region is a disc; returns its boundary walk.
    fn open_handles(&mut self) -> Result<Vec<DirectedArc>> {
        loop {
            let regions = Regions::find(&self.halves[self.lead].cut);
            let walks = regions.walks.concat();
            let alone = regions.isolated.concat();
            let corners = |walk: &Vec<DirectedArc>| walk.iter().map(|&d| self.corner(d)).collect::<Vec<_>>();
            match (walks.as_slice(), alone.as_slice(), regions.genus.as_slice()) {
                ([walk], [], [0]) => return Ok(walk.clone()),
                ([walk], [], _) => self.open_handle(&corners(walk))?,
                ([], &[landmark], &[genus]) if genus > 0 => self.open_handle(&[Corner { landmark, after: None }])?,
                ([first, rest @ ..], [], _) => {
                    let rest: Vec<Corner> = rest.iter().flat_map(corners).collect();
                    self.join_walks(&corners(first), &rest)?;
                }
                _ => return Err(too_few()),
            }
        }
    }

    /// The corner of a boundary walk where an arc starts.
    fn corner(&self, d: DirectedArc) -> Corner {
        Corner { landmark: self.arcs[d.arc][usize::from(d.reversed)], after: Some(d) }
    }

    /// Opens a handle where that is shortest on the leading mesh, and between the same corners on the other.
    fn open_handle(&mut self, corners: &[Corner]) -> Result<()> {
        let arc = ArcId::new(self.arcs.len());
        let half = &mut self.halves[self.lead];
        let laid = lay_across_handle(&mut half.cut, half.mesh, &mut half.searcher, [corners, corners], arc)?;
        self.arcs.push(laid.ends);
        let lead = &self.halves[self.lead].cut;
        let [start, end] = [false, true].map(|reversed| {
            let d = DirectedArc { arc, reversed };
            let landmark = self.corner(d).landmark;
            [Corner { landmark, after: arc_before(lead, landmark, d) }]
        });
        let other = &mut self.halves[1 - self.lead];
        lay_across_handle(&mut other.cut, other.mesh, &mut other.searcher, [&start, &end], arc)?;
        self.turn_alike(arc)?;
        for half in &mut self.halves {
            half.upkeep.after_arc(half.mesh, &mut half.cut, &self.arcs, self.edge_nodes);
        }
        Ok(())
    }

    /// Turns a loop around, if need be, so that its ends come in one order on both meshes.
    fn turn_alike(&mut self, arc: ArcId) -> Result<()> {
        let [l, end] = self.arcs[arc];
        for _ in 0..2 {
            let [mut a, mut b] = [0, 1].map(|k| rotation(&self.halves[k].cut, l, &|_| true));
            for r in [&mut a, &mut b] {
                let first = (0..r.len()).min_by_key(|&i| r[i]).unwrap_or(0);
                r.rotate_left(first);
            }
            if a == b || l != end {
                return Ok(());
            }
            self.halves[1 - self.lead].cut.reverse(arc, l);
        }
        Err(Error::bug("a loop has its ends in the wrong place").at(arc))
    }

    /// Joins two boundary walks where that is shortest on the leading mesh.
    fn join_walks(&mut self, from: &[Corner], to: &[Corner]) -> Result<()> {
        let half = &mut self.halves[self.lead];
        let (starts, goals) = (half.terminals(from)?, half.terminals(to)?);
        let path = half.searcher.shortest_of(&half.cut, &starts, &goals);
        // Where the nodes leave no way, any two corners will do: the region is refined between them.
        let ends = path.and_then(|path| corners_of(&half.cut, &path)).unwrap_or([from[0], to[0]]);
        let arc = self.arcs.push(ends.map(|c| c.landmark));
        self.lay(arc, ends)
    }

    /// Cuts the disc with the given boundary walk into triangles.
    fn triangulate(&mut self, walk: &[DirectedArc]) -> Result<BaseComplex> {
        let corners: Vec<Corner> = walk.iter().map(|&d| self.corner(d)).collect();
        if corners.len() < 3 {
            return Err(too_few());
        }
        let [source, target] = [self.halves[0].distances(&corners)?, self.halves[1].distances(&corners)?];
        let landmarks: Vec<LandmarkId> = corners.iter().map(|c| c.landmark).collect();
        let polygon = Polygon { walk, landmarks: &landmarks, length: &|i, j| source[i][j] + target[i][j] };
        let base = triangulate(&polygon, &self.arcs, self.halves[0].cut.landmarks.len());
        let mut present = Subcomplex::bare(&base);
        self.arcs.ids().for_each(|arc| present.add(arc));
        for arc in base.arcs.ids().skip(self.arcs.len()) {
            let ends = [false, true].map(|reversed| present.corner_behind(DirectedArc { arc, reversed }));
            self.arcs.push(base.arcs[arc]);
            self.lay(arc, ends)?;
            present.add(arc);
        }
        Ok(base)
    }
}

fn too_few() -> Error {
    Error::unsolvable("the landmarks are too few to span a layout").remedy("give at least three")
}

/// The arc before an end around its landmark, clockwise, other than the end's own.
fn arc_before(cut: &CutMesh, l: LandmarkId, end: DirectedArc) -> Option<DirectedArc> {
    let around = rotation(cut, l, &|_| true);
    let at = around.iter().position(|&d| d == end)?;
    (1..around.len()).map(|k| around[(at + around.len() - k) % around.len()]).find(|d| d.arc != end.arc)
}

/// The corners that a path between two landmarks leaves and enters.
fn corners_of(cut: &CutMesh, path: &Path) -> Option<[Corner; 2]> {
    let corner = |node: Option<&u32>, f: Option<&FaceId>| {
        let Place::Vertex(v) = cut.place(*node?) else { return None };
        let sector = sectors(cut, v, &|_| true).into_iter();
        let found = sector.into_iter().find(|s| s.halfedges.iter().any(|&h| Some(&face_of(h)) == f));
        Some(Corner { landmark: cut.landmark_at[v]?, after: found?.after })
    };
    Some([corner(path.nodes.first(), path.faces.first())?, corner(path.nodes.last(), path.faces.last())?])
}

impl Half<'_> {
    /// Distance of two landmarks without regard to arcs, relative to the root of the area.
    fn bare_length(&self, searcher: &mut Searcher, pair: [LandmarkId; 2]) -> f64 {
        let [start, goal] = pair.map(|l| Terminal::whole(&self.cut, self.cut.landmarks[l]));
        searcher.shortest(&self.cut, &start, &goal, &Anywhere).map_or(f64::INFINITY, |p| p.length / self.unit)
    }

    /// The corners between which the shortest path between two landmarks runs.
    fn free_corners(&mut self, pair: [LandmarkId; 2]) -> Option<[Corner; 2]> {
        let [start, goal] = pair.map(|l| Terminal::whole(&self.cut, self.cut.landmarks[l]));
        corners_of(&self.cut, &self.searcher.shortest(&self.cut, &start, &goal, &Anywhere)?)
    }

    fn terminals(&self, corners: &[Corner]) -> Result<Vec<Terminal>> {
        corners.iter().map(|&c| terminal(&self.cut, c, &|_| true)).collect()
    }

    /// Distances between the corners of the region, relative to the root of the area.
    fn distances(&self, corners: &[Corner]) -> Result<Vec<Vec<f64>>> {
        let mut distances = corner_distances(&self.cut, &self.terminals(corners)?);
        distances.iter_mut().flatten().for_each(|d| *d /= self.unit);
        Ok(distances)
    }
}
