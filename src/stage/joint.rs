//! A layout grown on both meshes at once, every arc chosen for its length on both together.
//!
//! Where the landmarks of one mesh lie in quite another order than those of the other, arcs that are short on one mesh
//! have to wind on the other. Here a spanning tree of arcs comes first, the shortest pairs leading (E. Praun,
//! W. Sweldens, P. Schröder 2001; V. Kraevoy, A. Sheffer 2004); then handles are opened; what is left is one disc, and
//! gets the diagonals of least total length. Shortest paths between corners of a disc cross only if their ends are
//! interleaved, so lengths can be measured before any diagonal is laid.

use super::growth::{Growth, Half, corners_of, too_few};
use super::polygon::{Polygon, triangulate};
use crate::error::{Error, Result};
use crate::mesh::{Id, LandmarkId, TriMesh, VertexId};
use crate::path::base_complex::{BaseComplex, DirectedArc};
use crate::path::cluster::Clusters;
use crate::path::corner_distance::corner_distances;
use crate::path::cut_mesh::CutMesh;
use crate::path::network::{Corner, connect};
use crate::path::region::Regions;
use crate::path::search::{Anywhere, Searcher, Terminal};
use crate::path::subcomplex::Subcomplex;
use rayon::prelude::*;

/// A complete layout on both meshes.
pub struct Grown {
    /// The base complex.
    pub base: BaseComplex,
    /// Both cut meshes.
    pub cuts: [CutMesh; 2],
}

/// Grows a layout; handles are opened where mesh `lead` has them shortest.
pub fn grow(
    meshes: [&TriMesh; 2],
    landmarks: [&[VertexId]; 2],
    clusters: &[Clusters; 2],
    edge_nodes: u32,
    lead: usize,
) -> Result<Grown> {
    let mut growth = Growth::new(meshes, landmarks, edge_nodes, lead);
    growth.span(clusters)?;
    let walk = growth.open_handles()?;
    let base = growth.triangulate(&walk)?;
    let [source, target] = growth.halves;
    Ok(Grown { base, cuts: [source.cut, target.cut] })
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

    /// Distances between the corners of the region, relative to the root of the area.
    fn distances(&self, corners: &[Corner]) -> Result<Vec<Vec<f64>>> {
        let mut distances = corner_distances(&self.cut, &self.terminals(corners)?);
        distances.iter_mut().flatten().for_each(|d| *d /= self.unit);
        Ok(distances)
    }
}
