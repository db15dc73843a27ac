//! A layout that grows on both meshes at once: every arc is laid on both before the next.
//!
//! Invariant: the arcs come in the same cyclic order around every landmark of both meshes, and every region holds the same
//! boundary walks, landmarks and handles on both. So a layout can be completed from any state: parts of a region are
//! joined, handles are opened, and what then is a disc gets its shortest diagonals.

use super::trace::{diagonals, joins, parts};
use crate::error::{Error, Result};
use crate::mesh::{ArcId, FaceId, Id, IdVec, LandmarkId, TriMesh, VertexId, face_of};
use crate::path::base_complex::DirectedArc;
use crate::path::cut_mesh::{CutMesh, Place};
use crate::path::edge_loop::GivenArc;
use crate::path::handle::lay_across_handle;
use crate::path::network::{Corner, connect, embed, rotation, sectors, terminal};
use crate::path::rebuild::Upkeep;
use crate::path::region::Regions;
use crate::path::search::{Bounds, Path, Searcher, Terminal};
use crate::path::side::{Explorer, Side};

/// One mesh and its share of the layout.
pub(super) struct Half<'a> {
    pub mesh: &'a TriMesh,
    /// The root of its area.
    pub unit: f64,
    pub cut: CutMesh,
    pub searcher: Searcher,
    upkeep: Upkeep,
}

/// A layout on its way.
pub(super) struct Growth<'a> {
    pub halves: [Half<'a>; 2],
    /// The arcs so far and the landmarks they join.
    pub arcs: IdVec<ArcId, [LandmarkId; 2]>,
    edge_nodes: u32,
    /// The mesh that decides where handles are opened.
    pub lead: usize,
    explorer: Explorer,
}

impl<'a> Growth<'a> {
    /// Bare meshes; handles will be opened where mesh `lead` has them shortest.
    pub fn new(meshes: [&'a TriMesh; 2], landmarks: [&[VertexId]; 2], edge_nodes: u32, lead: usize) -> Self {
        let half = |k: usize| Half {
            mesh: meshes[k],
            unit: meshes[k].area().sqrt(),
            cut: CutMesh::new(meshes[k], landmarks[k], edge_nodes),
            searcher: Searcher::default(),
            upkeep: Upkeep::default(),
        };
        let halves = [half(0), half(1)];
        Growth { halves, arcs: IdVec::default(), edge_nodes, lead, explorer: Explorer::default() }
    }

    /// Lays the arcs along the boundary and the guides, which both meshes number alike.
    pub fn lay_given(&mut self, given: &[Vec<GivenArc>; 2]) -> Result<()> {
        if given[0].len() != given[1].len() {
            return Err(Error::bug("loops that correspond carry different base vertices"));
        }
        for (one, other) in given[0].iter().zip(&given[1]) {
            let arc = self.arcs.push(one.ends);
            if one.ends != other.ends {
                return Err(Error::bug("loops that correspond carry different base vertices").at(arc));
            }
            one.lay(&mut self.halves[0].cut, arc);
            other.lay(&mut self.halves[1].cut, arc);
        }
        Ok(())
    }

    /// The shortest path between two landmarks on mesh `first`, and that on the other mesh between the same corners;
    /// `bounds` say where paths may run on either. None if one of them has no way.
    pub fn paths_alike(&mut self, ends: [LandmarkId; 2], first: usize, bounds: [&dyn Bounds; 2]) -> Option<[Path; 2]> {
        let half = &mut self.halves[first];
        let [start, goal] = ends.map(|l| Terminal::whole(&half.cut, half.cut.landmarks[l]));
        let one = half.searcher.shortest(&half.cut, &start, &goal, &*bounds[first].on(&half.cut))?;
        let corners = corners_of(&half.cut, &one)?;
        let half = &mut self.halves[1 - first];
        let [start, goal] = corners.map(|c| terminal(&half.cut, c, &|_| true).ok());
        let other = half.searcher.shortest(&half.cut, &start?, &goal?, &*bounds[1 - first].on(&half.cut))?;
        Some(if first == 0 { [one, other] } else { [other, one] })
    }

    /// Lays an arc along a path on either mesh if both separate the same from the rest, or neither separates anything;
    /// false if they do not. The paths leave and enter the same corners.
    pub fn lay_if_alike(&mut self, ends: [LandmarkId; 2], paths: &[Path; 2]) -> Result<bool> {
        let arc = ArcId::new(self.arcs.len());
        for k in 0..2 {
            let laid = embed(&mut self.halves[k].cut, self.halves[k].mesh, &paths[k], arc);
            if let Err(error) = laid {
                self.halves[..=k].iter_mut().for_each(|half| drop(half.cut.unmark(arc, ends[0])));
                return Err(error);
            }
        }
        if self.separates_alike(arc, ends[0]) {
            self.arcs.push(ends);
            self.keep_up();
            return Ok(true);
        }
        self.halves.iter_mut().for_each(|half| drop(half.cut.unmark(arc, ends[0])));
        Ok(false)
    }

    fn separates_alike(&mut self, arc: ArcId, first: LandmarkId) -> bool {
        let [source, target] = &self.halves;
        let found = self.explorer.smaller_side(&source.cut, arc, first);
        let other = self.explorer.smaller_side(&target.cut, arc, first);
        match (found, other) {
            (None, None) => true,
            (Some((hand, side)), Some((other_hand, other_side))) => {
                let same: Option<Side> = if hand == other_hand {
                    Some(other_side)
                } else {
                    self.explorer.side_of(&target.cut, arc, first, hand)
                };
                same == Some(side)
            }
            _ => false,
        }
    }

    /// Keeps the cut meshes fit for searches after an arc.
    pub fn keep_up(&mut self) {
        for half in &mut self.halves {
            half.upkeep.after_arc(half.mesh, &mut half.cut, &self.arcs, self.edge_nodes);
        }
    }

    /// True if no arc is missing: Euler's formula tells how many there are in the end.
    pub fn is_complete(&self) -> bool {
        let Half { mesh, cut, .. } = &self.halves[self.lead];
        let along_rims = self.arcs.iter_ids().filter(|(arc, ends)| cut.is_rim(*arc, ends[0])).count();
        let all = 3 * (cut.landmarks.len() as i64 - mesh.conn.euler_characteristic()) - along_rims as i64;
        self.arcs.len() as i64 >= all
    }

    /// Lays arcs until every region is a triangle.
    pub fn complete(&mut self) -> Result<()> {
        while self.split_one_region()? {}
        Ok(())
    }

    /// Lays one arc in the first region that is not yet a triangle; false when all are.
    fn split_one_region(&mut self) -> Result<bool> {
        let regions = Regions::find(&self.halves[self.lead].cut);
        for (r, walks) in regions.walks.iter().enumerate() {
            let parts = parts(&self.arcs, walks, &regions.isolated[r]);
            match parts.as_slice() {
                [walk] if regions.genus[r] > 0 => self.open_handle(walk)?,
                [walk] if walk.len() == 3 => continue,
                [walk] => self.lay_shortest(diagonals(walk))?,
                _ => self.lay_shortest(joins(&parts))?,
            }
            return Ok(true);
        }
        Ok(false)
    }

    /// Lays the shortest of arcs between some corners, on both meshes together; the straight distance tells which need
    /// not be searched.
    fn lay_shortest(&mut self, candidates: Vec<[Corner; 2]>) -> Result<()> {
        let straight = |ends: &[Corner; 2]| -> f64 {
            let one = |half: &Half| {
                let [a, b] = ends.map(|c| half.cut.positions[half.cut.landmarks[c.landmark]]);
                a.distance(b) / half.unit
            };
            self.halves.iter().map(one).sum()
        };
        let mut sorted: Vec<(f64, [Corner; 2])> = candidates.into_iter().map(|ends| (straight(&ends), ends)).collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best: Option<(f64, [Corner; 2])> = None;
        for (straight, ends) in sorted {
            if best.is_some_and(|(least, _)| least <= straight) {
                break;
            }
            let mut length = 0.0;
            for half in &mut self.halves {
                length += connect(&mut half.cut, half.mesh, &mut half.searcher, ends)?.length / half.unit;
            }
            if best.is_none_or(|(least, _)| length < least) {
                best = Some((length, ends));
            }
        }
        let (_, ends) = best.ok_or_else(too_few)?;
        let arc = self.arcs.push(ends.map(|c| c.landmark));
        self.lay(arc, ends)
    }

    /// Lays an arc between two corners on both meshes.
    pub fn lay(&mut self, arc: ArcId, corners: [Corner; 2]) -> Result<()> {
        for half in &mut self.halves {
            let path = connect(&mut half.cut, half.mesh, &mut half.searcher, corners)?;
            embed(&mut half.cut, half.mesh, &path, arc)?;
        }
        self.keep_up();
        Ok(())
    }

    /// The corner of a boundary walk where an arc starts.
    pub fn corner(&self, d: DirectedArc) -> Corner {
        Corner { landmark: self.arcs[d.arc][usize::from(d.reversed)], after: Some(d) }
    }

    /// Opens a handle where that is shortest on the leading mesh, and between the same corners on the other.
    pub fn open_handle(&mut self, corners: &[Corner]) -> Result<()> {
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
        self.keep_up();
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
    pub fn join_walks(&mut self, from: &[Corner], to: &[Corner]) -> Result<()> {
        let half = &mut self.halves[self.lead];
        let (starts, goals) = (half.terminals(from)?, half.terminals(to)?);
        let path = half.searcher.shortest_of(&half.cut, &starts, &goals);
        // Where the nodes leave no way, any two corners will do: the region is refined between them.
        let ends = path.and_then(|path| corners_of(&half.cut, &path)).unwrap_or([from[0], to[0]]);
        let arc = self.arcs.push(ends.map(|c| c.landmark));
        self.lay(arc, ends)
    }
}

pub(super) fn too_few() -> Error {
    Error::unsolvable("the landmarks are too few to span a layout").remedy("give at least three")
}

/// The arc before an end around its landmark, clockwise, other than the end's own.
fn arc_before(cut: &CutMesh, l: LandmarkId, end: DirectedArc) -> Option<DirectedArc> {
    let around = rotation(cut, l, &|_| true);
    let at = around.iter().position(|&d| d == end)?;
    (1..around.len()).map(|k| around[(at + around.len() - k) % around.len()]).find(|d| d.arc != end.arc)
}

/// The corners that a path between two landmarks leaves and enters.
pub(super) fn corners_of(cut: &CutMesh, path: &Path) -> Option<[Corner; 2]> {
    let corner = |node: Option<&u32>, f: Option<&FaceId>| {
        let Place::Vertex(v) = cut.place(*node?) else { return None };
        let sector = sectors(cut, v, &|_| true).into_iter();
        let found = sector.into_iter().find(|s| s.halfedges.iter().any(|&h| Some(&face_of(h)) == f));
        Some(Corner { landmark: cut.landmark_at[v]?, after: found?.after })
    };
    Some([corner(path.nodes.first(), path.faces.first())?, corner(path.nodes.last(), path.faces.last())?])
}

impl Half<'_> {
    pub fn terminals(&self, corners: &[Corner]) -> Result<Vec<Terminal>> {
        corners.iter().map(|&c| terminal(&self.cut, c, &|_| true)).collect()
    }
}
