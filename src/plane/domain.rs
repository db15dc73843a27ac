//! A planar domain for relaxation: one mesh's part of a patch, or of several patches laid out as a tiling.
//!
//! A single patch keeps its reference triangle. Tiles are laid out affinely and glued along seams, so triangles that
//! were positive in their patches are positive here.

use super::patch_disc::{ArcShares, PatchDisc};
use super::tiling::{Tile, Tiling};
use crate::mesh::{FaceId, PatchId, VertexId, metric};
use glam::{DVec2, DVec3};

/// Marks the missing neighbour of a triangle at the domain's boundary.
pub const OUTSIDE: u32 = u32::MAX;

/// One mesh's part of a domain.
#[derive(Clone, Debug, Default)]
pub struct Domain {
    /// The cut mesh's vertex of every vertex.
    pub vertices: Vec<VertexId>,
    /// Positions in the plane.
    pub positions: Vec<DVec2>,
    /// Positions in space.
    pub points: Vec<DVec3>,
    /// Whether the vertex may move.
    pub free: Vec<bool>,
    /// Triangles, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// For every triangle a face of the cut mesh that lies in the same original face.
    pub faces: Vec<FaceId>,
    /// For every triangle the one behind the side from corner `i` to corner `i + 1`, or [`OUTSIDE`].
    pub neighbours: Vec<[u32; 3]>,
}

/// Gives the patch discs of one mesh.
pub type Discs<'a> = &'a dyn Fn(PatchId) -> &'a PatchDisc;
/// Gives the points in space of one mesh.
pub type Points<'a> = &'a dyn Fn(VertexId) -> DVec3;

impl Domain {
    /// A single patch in its reference triangle.
    pub fn of_patch(disc: &PatchDisc, points: Points) -> Self {
        let mut domain = Domain::default();
        let number: Vec<u32> = (0..disc.vertices.len() as u32).collect();
        for (i, (&v, &p)) in disc.vertices.iter().zip(&disc.positions).enumerate() {
            domain.add_vertex(v, p, points, i >= disc.boundary);
        }
        domain.add_triangles(disc, &number);
        domain.connect();
        domain
    }

    /// The patches of a tiling; vertex `i` lies at its node `i`, and the seams' vertices may move.
    pub fn of_tiling(tiling: &Tiling, discs: Discs, shares: &ArcShares, points: Points) -> Self {
        let mut domain = Domain::default();
        for &node in &tiling.nodes {
            domain.add_vertex(VertexId(u32::MAX), node, &|_| DVec3::ZERO, false);
        }
        let mut first_of_seam = Vec::new();
        for seam in &tiling.seams {
            let [from, to] = seam.ends.map(|n| tiling.nodes[n as usize]);
            let inside = &shares[seam.arc][1..shares[seam.arc].len() - 1];
            first_of_seam.push(domain.vertices.len() as u32);
            for &s in inside {
                domain.add_vertex(VertexId(u32::MAX), from + (to - from) * s, &|_| DVec3::ZERO, true);
            }
        }
        for tile in &tiling.tiles {
            domain.add_tile(tiling, tile, discs(tile.patch), &first_of_seam, points);
        }
        domain.connect();
        domain
    }

    fn add_vertex(&mut self, v: VertexId, position: DVec2, points: Points, free: bool) -> u32 {
        self.vertices.push(v);
        self.positions.push(position);
        self.points.push(points(v));
        self.free.push(free);
        self.vertices.len() as u32 - 1
    }

    fn add_tile(&mut self, tiling: &Tiling, tile: &Tile, disc: &PatchDisc, first_of_seam: &[u32], points: Points) {
        let placement = tiling.placement(tile);
        let mut number = vec![u32::MAX; disc.vertices.len()];
        for k in 0..3 {
            let side = side_vertices(disc, k);
            number[side[0] as usize] = tile.corners[k];
            if let Some(seam) = tile.seams[k] {
                let inside = &side[1..side.len() - 1];
                for (m, &v) in inside.iter().enumerate() {
                    let along = if tile.sides[k].reversed { inside.len() - 1 - m } else { m };
                    number[v as usize] = first_of_seam[seam] + along as u32;
                }
            }
        }
        for (i, &v) in disc.vertices.iter().enumerate() {
            if number[i] == u32::MAX {
                number[i] = self.add_vertex(v, placement.place(disc.positions[i]), points, i >= disc.boundary);
            } else {
                self.vertices[number[i] as usize] = v;
                self.points[number[i] as usize] = points(v);
            }
        }
        self.add_triangles(disc, &number);
    }

    fn add_triangles(&mut self, disc: &PatchDisc, number: &[u32]) {
        self.faces.extend(&disc.faces);
        self.triangles.extend(disc.triangles.iter().map(|t| t.map(|v| number[v as usize])));
    }

    /// Splits the edge from `a` to `b` at share `t` of its way; the new vertex lies at `position` and stays there.
    ///
    /// `near` are the triangles at the edge before earlier splits. Neighbours are out of date until [`Domain::connect`]
    /// is called. Returns the new vertex and a triangle at the edge; none if there is no such edge.
    pub fn split_edge(&mut self, [a, b]: [u32; 2], t: f64, position: DVec2, near: [u32; 2]) -> Option<(u32, u32)> {
        let point = self.points[a as usize].lerp(self.points[b as usize], t);
        let middle = self.add_vertex(VertexId(u32::MAX), position, &|_| point, false);
        let mut found = None;
        let latest = self.triangles.len() as u32;
        for (from, to) in [(a, b), (b, a)] {
            let side = |f: u32| {
                let corners = self.triangles[f as usize];
                let i = (0..3).find(|&i| corners[i] == from && corners[(i + 1) % 3] == to)?;
                Some((f as usize, corners[(i + 2) % 3]))
            };
            let likely = near.into_iter().chain((0..latest).rev());
            let Some((f, far)) = likely.filter_map(side).next() else { continue };
            self.triangles[f] = [from, middle, far];
            self.triangles.push([middle, to, far]);
            self.faces.push(self.faces[f]);
            found = Some((middle, f as u32));
        }
        found
    }

    /// Finds the neighbours of all triangles.
    pub fn connect(&mut self) {
        let fans = self.fans();
        let behind = |a: u32, b: u32| {
            let is_behind = |&&(t, i): &&(u32, u8)| self.triangles[t as usize][(i as usize + 2) % 3] == b;
            fans.around(a as usize).iter().find(is_behind).map_or(OUTSIDE, |&(t, _)| t)
        };
        self.neighbours = self.triangles.iter().map(|&[a, b, c]| [behind(a, b), behind(b, c), behind(c, a)]).collect();
    }

    /// For every vertex the triangles around it with the corner it has there, in order of triangles.
    pub fn fans(&self) -> Fans {
        let mut start = vec![0u32; self.vertices.len() + 1];
        for &v in self.triangles.iter().flatten() {
            start[v as usize + 1] += 1;
        }
        for v in 0..self.vertices.len() {
            start[v + 1] += start[v];
        }
        let mut fill = start.clone();
        let mut entries = vec![(0, 0); 3 * self.triangles.len()];
        for (t, corners) in self.triangles.iter().enumerate() {
            for (i, &v) in corners.iter().enumerate() {
                entries[fill[v as usize] as usize] = (t as u32, i as u8);
                fill[v as usize] += 1;
            }
        }
        Fans { start, entries }
    }

    /// Area in space.
    pub fn area(&self) -> f64 {
        self.triangles.iter().map(|t| metric::area(self.spatial(t))).sum()
    }

    /// The corners of a triangle in space.
    pub fn spatial(&self, corners: &[u32; 3]) -> [DVec3; 3] {
        corners.map(|v| self.points[v as usize])
    }

    /// The corners of a triangle in the plane.
    pub fn triangle(&self, t: usize) -> [DVec2; 3] {
        self.triangles[t].map(|v| self.positions[v as usize])
    }
}

/// The triangles around every vertex.
pub struct Fans {
    start: Vec<u32>,
    entries: Vec<(u32, u8)>,
}

impl Fans {
    /// The triangles around `v`, each with the corner that `v` is of it.
    pub fn around(&self, v: usize) -> &[(u32, u8)] {
        &self.entries[self.start[v] as usize..self.start[v + 1] as usize]
    }
}

/// The local vertices along a side of a patch, both corners included.
pub fn side_vertices(disc: &PatchDisc, side: usize) -> Vec<u32> {
    let from = disc.corners[side];
    let to = if side == 2 { disc.boundary as u32 } else { disc.corners[side + 1] };
    (from..=to).map(|v| v % disc.boundary as u32).collect()
}
