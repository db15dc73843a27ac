//! The curves of a hint as loops of edges.

use super::super::SIDES;
use super::Guiding;
use crate::mesh::{HalfedgeId, IdVec, TriMesh, VertexId};
use crate::path::closing::{Closer, NoWay};
use crate::{Error, Result};
use std::collections::HashMap;

impl Guiding<'_> {
    /// The curves on mesh `k` as loops of edges.
    ///
    /// Between vertices that are listed they keep off the boundary, the landmarks and each other.
    pub(super) fn close(&self, k: usize) -> Result<Vec<Vec<HalfedgeId>>> {
        let mesh = self.mesh(k);
        let listed: Vec<Vec<VertexId>> =
            (0..self.hint.loops.len()).map(|i| self.listed(k, i)).collect::<Result<_>>()?;
        let mut taken: IdVec<VertexId, bool> = mesh.conn.vertices().map(|v| mesh.conn.is_on_boundary(v)).collect();
        self.sites[k].iter().chain(listed.iter().flatten()).for_each(|&v| taken[v] = true);
        let mut closer = Closer::new(mesh, taken);
        let mut owner = HashMap::new();
        let mut loops = Vec::with_capacity(listed.len());
        for (i, vertices) in listed.iter().enumerate() {
            let halfedges = closer.close(vertices).map_err(|way| self.no_way(k, i, way))?;
            for &h in &halfedges {
                if let Some(other) = owner.insert(mesh.conn.edge_representative(h), i) {
                    return Err(self.one_edge(k, [i, other], h));
                }
            }
            loops.push(halfedges);
        }
        Ok(loops)
    }

    fn mesh(&self, k: usize) -> &TriMesh {
        &self.loaded[k].canonical.mesh
    }

    /// The vertices that curve `i` lists; they must be inside the surface.
    fn listed(&self, k: usize, i: usize) -> Result<Vec<VertexId>> {
        let conn = &self.mesh(k).conn;
        let vertex = |&there: &VertexId| {
            let here = self.loaded[k].canonical.vertex(there);
            let fault = match conn.leaving(here) {
                None => "which no face uses",
                Some(_) if conn.is_on_boundary(here) => "which lies on the boundary",
                Some(_) => return Ok(here),
            };
            let what = format!("{} goes through {there} of the {}, {fault}", self.name(i), SIDES[k]);
            Err(Error::input(what).remedy("lead it through the inside of the surface"))
        };
        self.hint.loops[i].vertices[k].iter().map(vertex).collect()
    }

    fn no_way(&self, k: usize, i: usize, NoWay(ends): NoWay) -> Error {
        let [a, b] = ends.map(|v| self.loaded[k].canonical.vertex_there(v));
        Error::input(format!(
            "{} finds no way on the {} that keeps off the boundary, the landmarks and the other loops",
            self.name(i),
            SIDES[k]
        ))
        .at(format!("from {a} to {b}"))
        .remedy("list the vertices between them, or make room")
    }

    fn one_edge(&self, k: usize, [i, other]: [usize; 2], h: HalfedgeId) -> Error {
        let [a, b] =
            [self.mesh(k).conn.from(h), self.mesh(k).conn.to(h)].map(|v| self.loaded[k].canonical.vertex_there(v));
        Error::input(format!("{} and {} run along one edge of the {}", self.name(other), self.name(i), SIDES[k]))
            .at(format!("from {a} to {b}"))
            .remedy("let loops meet at single vertices only")
    }
}
