//! The base mesh's edges as paths on the disc and its scaffold: laid one after the other, then laid anew.
//!
//! Paths never meet but at their ends, and leave them in the cyclic order that the base mesh has: so they cut the mesh
//! into discs with three corners, one for every base triangle. A path is the cheapest one between the right sectors of its
//! ends (WARP 4.2); in which order they are laid decides how they wind: `grow.rs`.

mod grow;

use super::route::{Found, Route, Stop, Tolls, route};
use super::subdivided::{Steiner, Subdivided};
use crate::error::{Error, Result};
use crate::mesh::{ArcId, FaceId, HalfedgeId, Id, IdVec, LandmarkId, PatchId, TriMesh, VertexId, face_of};
use crate::path::base_complex::{BaseComplex, DirectedArc};
use crate::path::cut_mesh::CutMesh;
use crate::plane::warp::Triangulation;
use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};

/// What the paths of the tree pay, `hop` in mean distances of vertices: hardly more than their length. If they kept away from
/// vertices that others take, or from where the mesh is fine, they would come to lie on the wrong side of points, and
/// others would wind around them for it.
const STRAIGHT: Tolls = Tolls { hop: 0.1, crowded: 1.0, split: 0.5 };
/// What other paths pay: which side of what they pass is decided, so they had better spare vertices and leave room.
const SPARING: Tolls = Tolls { hop: 2.0, crowded: 3.0, split: 4.0 };
/// So many added vertices that no path passes are taken out together, which costs as much as taking out one.
const IDLE: usize = 24;

/// The error of a disc whose triangles can no longer be told apart.
pub fn too_fine() -> Error {
    Error::unsolvable("the constraints crowd the mesh more than it can hold")
        .remedy("move constraints apart, order them as they lie on the mesh, or use a finer mesh")
}

/// Paths along the edges of a base mesh.
#[derive(Clone)]
pub struct Network<'a> {
    /// The disc and its scaffold; positions in space are those in the plane that the paths are measured in.
    mesh: &'a TriMesh,
    /// Its triangles.
    faces: Vec<[u32; 3]>,
    /// The mean distance of its vertices.
    spacing: f64,
    /// The same with the paths on it as arcs.
    pub cut: CutMesh,
    /// The arc along an edge of the base mesh, by its ends, the lower first.
    arcs: BTreeMap<[u32; 2], ArcId>,
    /// First and second end of every arc; the landmark is the base mesh's point.
    ends: IdVec<ArcId, [LandmarkId; 2]>,
}

fn key(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

fn edges_of(base: &Triangulation) -> BTreeSet<[u32; 2]> {
    base.triangles().flat_map(|[a, b, c]| [key(a, b), key(b, c), key(c, a)]).collect()
}

impl<'a> Network<'a> {
    /// A network of the rim alone.
    fn framed(mesh: &'a TriMesh, points: &[VertexId], rim: &[VertexId]) -> Result<Self> {
        let cut = CutMesh::new(mesh, points, 0);
        let faces = mesh.faces().iter().map(|t| t.map(|v| v.0)).collect();
        let spacing = (mesh.area() / mesh.positions.len() as f64).sqrt();
        let mut network = Network { mesh, faces, spacing, cut, arcs: BTreeMap::new(), ends: IdVec::default() };
        let at = |v: &VertexId| points.iter().position(|p| p == v);
        let corners: Vec<usize> = (0..rim.len()).filter(|&i| at(&rim[i]).is_some()).collect();
        let first = points.len() - corners.len();
        for (k, &i) in corners.iter().enumerate() {
            let end = corners.get(k + 1).copied().unwrap_or(rim.len());
            let along: Vec<VertexId> = (i..=end).map(|j| rim[j % rim.len()]).collect();
            network.mark([first + k, first + (k + 1) % corners.len()].map(|p| p as u32), &along)?;
        }
        Ok(network)
    }

    /// Lays every path anew between its neighbours, so that it takes the room that they have left since.
    pub fn relay(&mut self, base: &Triangulation) -> Result<()> {
        let edges: Vec<[u32; 2]> = self.arcs.keys().copied().collect();
        for [a, b] in edges {
            let arc = self.arcs[&key(a, b)];
            if self.cut.is_rim(arc, self.ends[arc][0]) {
                continue;
            }
            self.arcs.remove(&key(a, b));
            self.cut.unmark(arc, self.ends[arc][0]);
            self.tidy_if(IDLE)?;
            self.connect(base, a, b)?;
        }
        self.tidy_if(1)
    }

    /// Number of vertices that paths have added.
    pub fn added(&self) -> usize {
        self.cut.conn.vertex_count() - self.mesh.positions.len()
    }

    /// Takes out the added vertices that no path passes any more, once there are so many.
    fn tidy_if(&mut self, many: usize) -> Result<()> {
        let given = self.mesh.positions.len();
        let idle: Vec<u32> = (given..self.cut.conn.vertex_count())
            .map(|v| v as u32)
            .filter(|&v| !self.cut.is_blocked(VertexId(v)))
            .collect();
        if idle.len() < many {
            return Ok(());
        }
        let steiner: Option<Vec<Steiner>> =
            (given..self.cut.conn.vertex_count()).map(|v| self.steiner(VertexId::new(v))).collect();
        let steiner = steiner.ok_or_else(|| Error::bug("an added vertex lies in no triangle"))?;
        let triangles = self.cut.conn.faces().map(|f| self.cut.conn.face(f).map(|v| v.0)).collect();
        let part_of = self.cut.face_origin.iter().map(|f| f.0).collect();
        let mut sub = Subdivided::new(&self.faces, given, triangles, part_of, steiner);
        let mut left = idle;
        loop {
            let count = left.len();
            left.retain(|&s| {
                let found = sub.pulls(s).next();
                found.inspect(|pull| sub.pull(pull)).is_none()
            });
            if left.len() == count {
                break;
            }
        }
        let number = sub.compact();
        let Subdivided { triangles, part_of, .. } = sub;
        self.rebuild(&triangles, &part_of, &number)
    }

    /// Where an added vertex lies.
    fn steiner(&self, v: VertexId) -> Option<Steiner> {
        let triangle = self.cut.face_origin[face_of(self.cut.conn.leaving(v)?)];
        let weights = self.cut.origin[v].barycentric_in(self.mesh, triangle)?;
        Some(Steiner { triangle: triangle.0, weights })
    }

    /// The cut mesh with the triangles that are left, the arcs as they were.
    fn rebuild(&mut self, triangles: &[[u32; 3]], part_of: &[u32], number: &[Option<u32>]) -> Result<()> {
        let paths: Vec<(ArcId, Vec<VertexId>)> = self
            .arcs
            .values()
            .map(|&arc| {
                let path = self.cut.arc_path(arc, self.ends[arc][0]);
                let start = path.first().map(|&h| self.cut.conn.from(h));
                let vertices = start.into_iter().chain(path.iter().map(|&h| self.cut.conn.to(h)));
                (arc, vertices.filter_map(|v| number[v.index()].map(VertexId)).collect())
            })
            .collect();
        let faces: Vec<[VertexId; 3]> = triangles.iter().map(|t| t.map(VertexId)).collect();
        let origin = (0..number.len()).filter(|&v| number[v].is_some()).map(|v| self.cut.origin[VertexId::new(v)]);
        let parts = part_of.iter().map(|&p| FaceId(p)).collect();
        let landmarks = self.cut.landmarks.raw.clone();
        self.cut = CutMesh::assemble(self.mesh, &faces, origin.collect(), parts, &landmarks, 0)?;
        paths.iter().try_for_each(|(arc, vertices)| self.cut.mark_along(vertices, *arc))
    }

    /// Lays the path from `a` to `b` into the sectors in which the base mesh has the edge.
    fn connect(&mut self, base: &Triangulation, a: u32, b: u32) -> Result<()> {
        let found = self.find(base, [a, b], &SPARING)?;
        self.follow([a, b], &found)
    }

    /// Finds the cheapest path between two points that leaves and arrives in the sectors in which the base mesh has it.
    fn find(&self, base: &Triangulation, [a, b]: [u32; 2], tolls: &Tolls) -> Result<Found> {
        let sectors = [self.sector(base, a, b), self.sector(base, b, a)];
        let ends = [a, b].map(|i| self.cut.landmarks[LandmarkId(i)]);
        let tolls = Tolls { hop: tolls.hop * self.spacing, ..*tolls };
        route(&self.cut, &Route { ends, sectors, tolls }).ok_or_else(too_fine)
    }

    /// Lays a path where it was found.
    fn follow(&mut self, [a, b]: [u32; 2], found: &Found) -> Result<()> {
        let ends = [a, b].map(|i| self.cut.landmarks[LandmarkId(i)]);
        let mut vertices = vec![ends[0]];
        for &stop in &found.stops {
            vertices.push(match stop {
                Stop::Vertex(v) => v,
                Stop::Middle([p, q]) => {
                    let h = self.cut.conn.find(p, q).or_else(|| self.cut.conn.find(q, p));
                    let h = h.ok_or_else(|| Error::bug("an edge to be split is gone"))?;
                    self.cut.split_edge(self.mesh, h, 0.5)
                }
            });
        }
        vertices.push(ends[1]);
        self.mark([a, b], &vertices)
    }

    fn mark(&mut self, [a, b]: [u32; 2], vertices: &[VertexId]) -> Result<()> {
        let arc = self.ends.push([LandmarkId(a), LandmarkId(b)]);
        self.arcs.insert(key(a, b), arc);
        self.cut.mark_along(vertices, arc)
    }

    /// The half-edges that leave `a` from the path before `b` in the base mesh's cyclic order up to the next path; each
    /// stands for the face at its left. All of them if there is no path at `a`.
    fn sector(&self, base: &Triangulation, a: u32, b: u32) -> Vec<HalfedgeId> {
        let ring = base.ring(a);
        let spokes: Vec<HalfedgeId> = self.cut.conn.outgoing(self.cut.landmarks[LandmarkId(a)]).collect();
        let at = ring.iter().position(|&v| v == b).unwrap_or_default();
        let before =
            (1..ring.len()).map(|k| ring[(at + ring.len() - k) % ring.len()]).find_map(|v| self.arcs.get(&key(a, v)));
        let Some(&before) = before else { return spokes };
        let leaves = |h: HalfedgeId| self.cut.arc_at(h).is_some_and(|d| d.arc == before);
        let start = spokes.iter().position(|&h| leaves(h)).unwrap_or_default();
        let turned = (0..spokes.len()).map(|k| spokes[(start + k) % spokes.len()]);
        let first = turned.clone().take(1);
        first.chain(turned.skip(1).take_while(|&h| self.cut.arc_at(h).is_none())).collect()
    }

    /// The base mesh, whose triangles these are, with the arcs as they run now.
    pub fn complex(&self, triangles: impl Iterator<Item = [u32; 3]>) -> Result<BaseComplex> {
        let mut number: IdVec<ArcId, Option<ArcId>> = IdVec::filled(None, self.ends.len());
        let mut arcs = IdVec::default();
        for &arc in self.arcs.values() {
            number[arc] = Some(arcs.push(self.ends[arc]));
        }
        let side = |[a, b]: [u32; 2]| {
            let arc = *self.arcs.get(&key(a, b))?;
            Some(DirectedArc { arc: number[arc]?, reversed: self.ends[arc][0] != LandmarkId(a) })
        };
        let mut patches: IdVec<PatchId, _> = IdVec::default();
        for [a, b, c] in triangles {
            let sides = [side([a, b]), side([b, c]), side([c, a])];
            let [Some(p), Some(q), Some(r)] = sides else {
                return Err(Error::bug("an edge of the base mesh has no path"));
            };
            patches.push([p, q, r]);
        }
        Ok(BaseComplex { landmarks: self.cut.landmarks.len(), arcs, patches })
    }

    /// The cut mesh, its arcs numbered as [`Network::complex`] has them.
    pub fn into_cut(mut self) -> CutMesh {
        let mut number = IdVec::filled(None, self.ends.len());
        for (new, &arc) in self.arcs.values().enumerate() {
            number[arc] = Some(ArcId::new(new));
        }
        self.cut.renumber_arcs(&number);
        self.cut
    }
}

/// The mesh in which paths are laid: the disc and its scaffold in the plane, lifted to height zero.
pub fn lifted(positions: &[DVec2], triangles: &[[u32; 3]]) -> Result<TriMesh> {
    let faces: Vec<[VertexId; 3]> = triangles.iter().map(|t| t.map(VertexId)).collect();
    TriMesh::new(positions.iter().map(|p| p.extend(0.0)).collect(), &faces)
        .map_err(|fault| Error::bug("the disc and its scaffold do not join").at(format!("{fault:?}")))
}
