//! A planar domain for relaxation: one mesh's patch, or two neighbouring patches glued along their arc.
//!
//! A single patch keeps its reference triangle. Two patches share the segment from (0, 0) to (1, 0), the first above
//! it, the second below, each laid out with the proportions of its frame. Gluing is affine on either side, so triangles
//! that were positive in their patches are positive here.

use super::patch_disc::PatchDisc;
use super::stretch::Frame;
use crate::mesh::{FaceId, VertexId};
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
    /// The cut mesh's face of every triangle.
    pub faces: Vec<FaceId>,
    /// Triangles, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// For every triangle the one behind the side from corner `i` to corner `i + 1`, or [`OUTSIDE`].
    pub neighbours: Vec<[u32; 3]>,
    /// For two patches: the vertex at (0, 0).
    pub start: u32,
    /// For two patches: the vertex at (1, 0).
    pub end: u32,
}

/// How one patch lies in a domain of two: barycentric coordinates of its corners, turned so that the shared side comes
/// first, become plane coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// The side of the patch that is shared.
    pub side: usize,
    /// The image of the opposite corner.
    apex: DVec2,
    /// Where the shared side starts and ends on the x axis.
    ends: [f64; 2],
}

impl Placement {
    /// The patch above the shared segment; its shared side runs from (0, 0) to (1, 0).
    pub fn above(side: usize, frame: &Frame) -> Self {
        Placement { side, apex: apex_over(side, frame), ends: [0.0, 1.0] }
    }

    /// The patch below; its shared side runs from (1, 0) to (0, 0).
    pub fn below(side: usize, frame: &Frame) -> Self {
        let apex = apex_over(side, frame);
        Placement { side, apex: DVec2::new(1.0 - apex.x, -apex.y), ends: [1.0, 0.0] }
    }

    /// From reference coordinates to the plane.
    pub fn place(&self, p: DVec2) -> DVec2 {
        let b = [1.0 - p.x - p.y, p.x, p.y];
        let turned: [f64; 3] = std::array::from_fn(|i| b[(self.side + i) % 3]);
        let along = turned[0] * self.ends[0] + turned[1] * self.ends[1];
        DVec2::new(along, 0.0) + self.apex * turned[2]
    }

    /// From the plane back to reference coordinates.
    pub fn reference(&self, q: DVec2) -> DVec2 {
        let far = q.y / self.apex.y;
        let along = q.x - self.apex.x * far;
        let (near_start, near_end) =
            if self.ends[0] == 0.0 { (1.0 - far - along, along) } else { (along, 1.0 - far - along) };
        let mut b = [0.0; 3];
        b[self.side] = near_start;
        b[(self.side + 1) % 3] = near_end;
        b[(self.side + 2) % 3] = far;
        DVec2::new(b[1], b[2])
    }
}

/// Where the corner opposite to `side` lies when that side is laid from (0, 0) to (1, 0).
fn apex_over(side: usize, frame: &Frame) -> DVec2 {
    let corners = [DVec2::ZERO, frame.first, frame.second];
    let (a, b, c) = (corners[side], corners[(side + 1) % 3], corners[(side + 2) % 3]);
    let along = (b - a) / (b - a).length_squared();
    DVec2::new((c - a).dot(along), along.perp_dot(c - a))
}

impl Domain {
    /// A single patch in its reference triangle.
    pub fn of_patch(disc: &PatchDisc, points: &dyn Fn(VertexId) -> DVec3) -> Self {
        let mut domain = Domain::default();
        domain.add(disc, points, &|p| p, &|_| None);
        domain.connect();
        domain
    }

    /// Two patches glued along side `above.side` of the first and `below.side` of the second.
    ///
    /// `shares` are the positions of the shared arc's vertices along it, from the segment's start to its end.
    pub fn of_pair(
        discs: [&PatchDisc; 2],
        placements: [&Placement; 2],
        shares: &[f64],
        points: &dyn Fn(VertexId) -> DVec3,
    ) -> Self {
        let mut domain = Domain::default();
        domain.add(discs[0], points, &|p| placements[0].place(p), &|_| None);
        let shared = side_vertices(discs[0], placements[0].side);
        for (&v, &s) in shared.iter().zip(shares) {
            domain.positions[v as usize] = DVec2::new(s, 0.0);
        }
        for &v in &shared[1..shared.len() - 1] {
            domain.free[v as usize] = true;
        }
        domain.start = shared[0];
        domain.end = shared[shared.len() - 1];
        let other = side_vertices(discs[1], placements[1].side);
        let twin = |v: u32| other.iter().position(|&w| w == v).map(|i| shared[shared.len() - 1 - i]);
        domain.add(discs[1], points, &|p| placements[1].place(p), &twin);
        domain.connect();
        domain
    }

    /// Adds a patch; `known` gives the domain vertex of a local vertex that is there already.
    fn add(
        &mut self,
        disc: &PatchDisc,
        points: &dyn Fn(VertexId) -> DVec3,
        place: &dyn Fn(DVec2) -> DVec2,
        known: &dyn Fn(u32) -> Option<u32>,
    ) {
        let mut number = Vec::with_capacity(disc.vertices.len());
        for (i, (&v, &p)) in disc.vertices.iter().zip(&disc.positions).enumerate() {
            let shared = if i < disc.boundary { known(i as u32) } else { None };
            number.push(shared.unwrap_or_else(|| {
                self.vertices.push(v);
                self.positions.push(place(p));
                self.points.push(points(v));
                self.free.push(i >= disc.boundary);
                self.vertices.len() as u32 - 1
            }));
        }
        self.faces.extend_from_slice(&disc.faces);
        self.triangles.extend(disc.triangles.iter().map(|t| t.map(|v| number[v as usize])));
    }

    /// Finds the neighbours of all triangles.
    fn connect(&mut self) {
        let mut sides: Vec<(u32, u32, u32)> = Vec::with_capacity(3 * self.triangles.len());
        for (t, corners) in self.triangles.iter().enumerate() {
            for i in 0..3 {
                let (a, b) = (corners[i], corners[(i + 1) % 3]);
                sides.push((a.min(b), a.max(b), (3 * t + i) as u32));
            }
        }
        sides.sort_unstable();
        self.neighbours = vec![[OUTSIDE; 3]; self.triangles.len()];
        for pair in sides.windows(2) {
            if (pair[0].0, pair[0].1) == (pair[1].0, pair[1].1) {
                let (h, k) = (pair[0].2 as usize, pair[1].2 as usize);
                self.neighbours[h / 3][h % 3] = (k / 3) as u32;
                self.neighbours[k / 3][k % 3] = (h / 3) as u32;
            }
        }
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
