//! Where curves meet each other and the landmarks.

use super::super::SIDES;
use super::Guiding;
use crate::mesh::{HalfedgeId, Id, LandmarkId, VertexId};
use crate::path::edge_loop::EdgeLoop;
use crate::path::loop_pairs::{Mismatch, same_order};
use crate::{Error, Result};
use std::collections::{BTreeMap, BTreeSet};

/// The numbers of the curves through a vertex.
type Through = BTreeSet<usize>;

impl Guiding<'_> {
    /// The vertices, source first, where curves meet and no landmark is.
    ///
    /// Curves must meet as often on both meshes, and pass the same landmarks; which meeting corresponds to which is clear
    /// only if the same curves have no other.
    pub(super) fn meetings(&self, loops: &[Vec<Vec<HalfedgeId>>; 2]) -> Result<Vec<[VertexId; 2]>> {
        let through = [0, 1].map(|k| self.curves_through(k, &loops[k]));
        self.same_landmarks(&through)?;
        let [source, target] = [0, 1].map(|k| self.between_landmarks(k, &through[k]));
        let all: BTreeSet<&Through> = source.keys().chain(target.keys()).collect();
        let mut meetings = Vec::with_capacity(all.len());
        for curves in all {
            let at = [&source, &target].map(|m| m.get(curves).map_or(&[][..], Vec::as_slice));
            match at {
                [&[a], &[b]] => meetings.push([a, b]),
                [a, b] => return Err(self.unclear(curves, [a.len(), b.len()])),
            }
        }
        Ok(meetings)
    }

    fn curves_through(&self, k: usize, loops: &[Vec<HalfedgeId>]) -> BTreeMap<VertexId, Through> {
        let conn = &self.loaded[k].canonical.mesh.conn;
        let mut through: BTreeMap<VertexId, Through> = BTreeMap::new();
        for (i, halfedges) in loops.iter().enumerate() {
            halfedges.iter().for_each(|&h| through.entry(conn.from(h)).or_default().extend([i]));
        }
        through
    }

    fn same_landmarks(&self, through: &[BTreeMap<VertexId, Through>; 2]) -> Result<()> {
        let none = Through::new();
        for (l, &number) in self.order.iter().enumerate() {
            let [a, b] = [0, 1].map(|k| through[k].get(&self.sites[k][l]).unwrap_or(&none));
            if let Some(&i) = a.symmetric_difference(b).next() {
                let on = usize::from(!a.contains(&i));
                let what = format!(
                    "landmark \"{}\" lies on {} on the {} but beside it on the {}",
                    self.landmarks.names[number],
                    self.name(i),
                    SIDES[on],
                    SIDES[1 - on]
                );
                return Err(Error::unsolvable(what).remedy("lead the loop through it on both meshes, or on neither"));
            }
        }
        Ok(())
    }

    /// The vertices of several curves that are no landmarks, by their curves.
    fn between_landmarks(&self, k: usize, through: &BTreeMap<VertexId, Through>) -> BTreeMap<Through, Vec<VertexId>> {
        let mut at: BTreeMap<Through, Vec<VertexId>> = BTreeMap::new();
        for (&v, curves) in through.iter().filter(|(v, curves)| curves.len() > 1 && !self.sites[k].contains(v)) {
            at.entry(curves.clone()).or_default().push(v);
        }
        at
    }

    fn unclear(&self, curves: &Through, counts: [usize; 2]) -> Error {
        let names: Vec<String> = curves.iter().map(|&i| self.name(i)).collect();
        let names = names.join(" and ");
        if counts[0] == counts[1] {
            let what =
                format!("{names} meet at {} vertices that are no landmarks: which correspond is open", counts[0]);
            return Error::input(what).remedy("put landmarks at all of them but one");
        }
        let [a, b] = counts;
        Error::unsolvable(format!(
            "{names} meet at {a} vertices of the source but at {b} of the target, landmarks not counted"
        ))
        .remedy("lead them so that they meet as often on both meshes; they meet at vertices that both list")
    }

    /// Refuses curves that pass landmarks and meetings in another cyclic order on the target.
    pub(super) fn same_order(&self, marked: &[Vec<EdgeLoop>; 2]) -> Result<()> {
        for (i, (source, target)) in marked[0].iter().zip(&marked[1]).enumerate() {
            let Err(mismatch) = same_order(source, target) else { continue };
            let name = self.name(i);
            let (how, remedy) = match mismatch {
                Mismatch::Order { reversed: true, .. } => {
                    ("in the opposite order", "list it in the same direction on both meshes")
                }
                _ => ("in another order", "lead it through them in one order on both meshes"),
            };
            let stops: Vec<String> = source.base_vertices().map(|l| self.stop(l)).collect();
            let what = format!("{name} passes {} {how} on the target", stops.join(", "));
            return Err(Error::unsolvable(what).remedy(remedy));
        }
        Ok(())
    }

    fn stop(&self, l: LandmarkId) -> String {
        self.landmark(l).unwrap_or_else(|| "a meeting".to_owned())
    }

    /// The name of a base vertex that is a landmark.
    pub(super) fn landmark(&self, l: LandmarkId) -> Option<String> {
        let number = *self.order.get(l.index())?;
        Some(format!("\"{}\"", self.landmarks.names[number]))
    }
}
