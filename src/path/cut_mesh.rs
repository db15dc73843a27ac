//! The cut mesh: a mesh refined so that arcs run along its edges, with the geometry unchanged.
//!
//! Every vertex remembers the point of the original mesh where it lies and every face the original face that contains
//! it. Arcs are directed arcs on half-edges. The edge nodes that paths may pass through live here too, because they are
//! re-spread whenever an edge is split (VORONOI 4).

use crate::error::{Error, Result};
use crate::mesh::{
    Connectivity, FaceId, HalfedgeId, Id, IdVec, LandmarkId, SurfacePoint, TriMesh, VertexId, face_of, next, prev,
};
use crate::path::base_complex::DirectedArc;
use glam::DVec3;

mod arcs;

/// Upper bound on the edge nodes of one edge: more would slow the search without shortening any path noticeably.
const MAX_NODES: f64 = 12.0;

/// Where a path may pass: at a vertex, or at one of the nodes of an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// A vertex of the cut mesh.
    Vertex(VertexId),
    /// The share `t` in (0, 1) of the way along a half-edge.
    Edge(HalfedgeId, f64),
}

/// A run of node numbers.
#[derive(Clone, Copy, Debug, Default)]
pub struct NodeRange {
    /// First node.
    pub start: u32,
    /// Number of nodes.
    pub count: u32,
}

impl NodeRange {
    /// The node numbers in order.
    pub fn iter(self) -> std::ops::Range<u32> {
        self.start..self.start + self.count
    }
}

/// A refined mesh with arcs along its edges; see the module documentation.
#[derive(Clone, Debug)]
pub struct CutMesh {
    /// Connectivity; the first vertices are those of the original mesh.
    pub conn: Connectivity,
    /// Positions, on the original surface.
    pub positions: IdVec<VertexId, DVec3>,
    /// Where every vertex lies on the original mesh.
    pub origin: IdVec<VertexId, SurfacePoint>,
    /// The original face that contains each face.
    pub face_origin: IdVec<FaceId, FaceId>,
    /// The landmark at a vertex.
    pub landmark_at: IdVec<VertexId, Option<LandmarkId>>,
    /// The vertex of each landmark.
    pub landmarks: IdVec<LandmarkId, VertexId>,
    arc_at: IdVec<HalfedgeId, Option<DirectedArc>>,
    blocked: IdVec<VertexId, bool>,
    nodes_of_edge: IdVec<HalfedgeId, NodeRange>,
    scale_of_edge: IdVec<HalfedgeId, f64>,
    node_of_vertex: IdVec<VertexId, u32>,
    node_place: Vec<Place>,
    node_position: Vec<DVec3>,
    edge_nodes: u32,
}

impl CutMesh {
    /// The uncut mesh with its landmarks; `edge_nodes` is the least number of nodes on an edge (VORONOI 4: 3).
    pub fn new(mesh: &TriMesh, landmarks: &[VertexId], edge_nodes: u32) -> Self {
        let origin = mesh.conn.vertices().map(SurfacePoint::Vertex).collect();
        let face_origin = mesh.conn.faces().collect();
        Self::with_connectivity(mesh, mesh.conn.clone(), origin, face_origin, landmarks, edge_nodes)
    }

    /// A refined mesh from its triangles, where its vertices lie on `mesh`, and which faces its faces are parts of.
    pub fn assemble(
        mesh: &TriMesh,
        faces: &[[VertexId; 3]],
        origin: Vec<SurfacePoint>,
        face_origin: Vec<FaceId>,
        landmarks: &[VertexId],
        edge_nodes: u32,
    ) -> Result<Self> {
        let conn = Connectivity::build(origin.len(), faces)
            .map_err(|fault| Error::bug("a refined mesh is not a manifold").at(format!("{fault:?}")))?;
        let origin = IdVec::from_raw(origin);
        Ok(Self::with_connectivity(mesh, conn, origin, IdVec::from_raw(face_origin), landmarks, edge_nodes))
    }

    fn with_connectivity(
        mesh: &TriMesh,
        conn: Connectivity,
        origin: IdVec<VertexId, SurfacePoint>,
        face_origin: IdVec<FaceId, FaceId>,
        landmarks: &[VertexId],
        edge_nodes: u32,
    ) -> Self {
        let (vertices, halfedges) = (conn.vertex_count(), 3 * conn.face_count());
        let mut cut = CutMesh {
            conn,
            positions: origin.iter().map(|p| p.position(mesh)).collect(),
            origin,
            face_origin,
            landmark_at: IdVec::filled(None, vertices),
            landmarks: IdVec::from_raw(landmarks.to_vec()),
            arc_at: IdVec::filled(None, halfedges),
            blocked: IdVec::filled(false, vertices),
            nodes_of_edge: IdVec::filled(NodeRange::default(), halfedges),
            scale_of_edge: IdVec::filled(0.0, halfedges),
            node_of_vertex: IdVec::default(),
            node_place: Vec::new(),
            node_position: Vec::new(),
            edge_nodes,
        };
        for (l, &v) in landmarks.iter().enumerate() {
            cut.landmark_at[v] = Some(LandmarkId::new(l));
            cut.blocked[v] = true;
        }
        cut.spread_all_nodes();
        cut
    }

    fn spread_all_nodes(&mut self) {
        // Half as many edges as half-edges, on most of them the least number of nodes.
        let expected = self.conn.vertex_count() + self.arc_at.len() / 2 * (self.edge_nodes as usize + 1);
        self.node_place.reserve(expected);
        self.node_position.reserve(expected);
        for v in self.conn.vertices() {
            let node = self.add_node(Place::Vertex(v));
            self.node_of_vertex.push(node);
        }
        let mean: IdVec<VertexId, (f64, f64)> = self
            .conn
            .vertices()
            .map(|v| self.conn.outgoing(v).fold((0.0, 0.0), |(s, n), h| (s + self.length(h), n + 1.0)))
            .collect();
        for h in self.conn.halfedges() {
            if !self.conn.is_edge_representative(h) {
                continue;
            }
            let ((s, n), (t, m)) = (mean[self.conn.from(h)], mean[self.conn.to(h)]);
            self.spread_nodes(h, (s + t) / (n + m));
        }
    }

    fn add_node(&mut self, place: Place) -> u32 {
        self.node_place.push(place);
        let position = self.place_position(place);
        self.node_position.push(position);
        u32::try_from(self.node_place.len() - 1).expect("the readers bound the number of elements")
    }

    /// Gives the edge of `h` fresh nodes; `scale` is the mean length of its neighbours on the original mesh.
    fn spread_nodes(&mut self, h: HalfedgeId, scale: f64) {
        let wished = f64::from(self.edge_nodes) * self.length(h) / scale;
        let count = wished.clamp(f64::from(self.edge_nodes), MAX_NODES.max(f64::from(self.edge_nodes))) as u32;
        let start = self.node_place.len() as u32;
        for k in 0..count {
            self.add_node(Place::Edge(h, f64::from(k + 1) / f64::from(count + 1)));
        }
        for side in [Some(h), self.conn.twin(h)].into_iter().flatten() {
            self.nodes_of_edge[side] = NodeRange { start, count };
            self.scale_of_edge[side] = scale;
        }
    }

    /// Length of an edge.
    pub fn length(&self, h: HalfedgeId) -> f64 {
        self.positions[self.conn.from(h)].distance(self.positions[self.conn.to(h)])
    }

    /// The directed arc that runs along `h`, in its direction.
    pub fn arc_at(&self, h: HalfedgeId) -> Option<DirectedArc> {
        self.arc_at[h]
    }

    /// True for landmarks and for vertices on arcs: no other arc may pass.
    pub fn is_blocked(&self, v: VertexId) -> bool {
        self.blocked[v]
    }

    /// The nodes on the edge of `h`.
    pub fn nodes_on(&self, h: HalfedgeId) -> NodeRange {
        self.nodes_of_edge[h]
    }

    /// The node at a vertex.
    pub fn node_at(&self, v: VertexId) -> u32 {
        self.node_of_vertex[v]
    }

    /// Number of nodes ever made; node numbers stay below it.
    pub fn node_count(&self) -> usize {
        self.node_place.len()
    }

    /// The place of a node.
    pub fn place(&self, node: u32) -> Place {
        self.node_place[node as usize]
    }

    /// The position of a node.
    pub fn node_position(&self, node: u32) -> DVec3 {
        self.node_position[node as usize]
    }

    fn place_position(&self, place: Place) -> DVec3 {
        match place {
            Place::Vertex(v) => self.positions[v],
            Place::Edge(h, t) => self.positions[self.conn.from(h)] * (1.0 - t) + self.positions[self.conn.to(h)] * t,
        }
    }

    /// Barycentric coordinates, in the original face that contains `f`, of the corners of `f`.
    pub fn corner_coordinates(&self, mesh: &TriMesh, f: FaceId) -> [[f64; 3]; 3] {
        self.conn.face(f).map(|v| {
            let b = self.origin[v].barycentric_in(mesh, self.face_origin[f]);
            b.expect("a face of the cut mesh lies in its original face, corners included")
        })
    }

    /// Splits the edge of `h` at the share `t`; returns the new vertex. Arcs along the edge follow both halves.
    pub fn split_edge(&mut self, mesh: &TriMesh, h: HalfedgeId, t: f64) -> VertexId {
        let f = self.face_origin[face_of(h)];
        let [a, b] = [self.conn.from(h), self.conn.to(h)].map(|v| {
            self.origin[v].barycentric_in(mesh, f).expect("the ends of an edge lie in the original face of its side")
        });
        let origin = SurfacePoint::from_barycentric(mesh, f, std::array::from_fn(|i| a[i] * (1.0 - t) + b[i] * t));
        let along = self.arc_at[h];
        let scale = self.scale_of_edge[h];
        let twin = self.conn.twin(h);
        let m = self.conn.split_edge(h);
        self.positions.push(origin.position(mesh));
        self.origin.push(origin);
        self.landmark_at.push(None);
        self.blocked.push(along.is_some());
        let node = self.add_node(Place::Vertex(m));
        self.node_of_vertex.push(node);
        self.extend_side(h, HalfedgeId::new(self.arc_at.len()), next(h), true, along);
        if let Some(t) = twin {
            self.extend_side(t, HalfedgeId::new(self.arc_at.len()), prev(t), false, along.map(DirectedArc::flipped));
        }
        self.respread(h, scale, twin.is_some());
        m
    }

    /// Attributes of the face that a split adds on one side; `moved` is the half-edge whose outer edge went to it.
    fn extend_side(
        &mut self,
        h: HalfedgeId,
        new: HalfedgeId,
        moved: HalfedgeId,
        leads: bool,
        along: Option<DirectedArc>,
    ) {
        let outer = if leads { 1 } else { 2 };
        let kept = (self.arc_at[moved], self.nodes_of_edge[moved], self.scale_of_edge[moved]);
        self.face_origin.push(self.face_origin[face_of(h)]);
        for i in 0..3 {
            let on_split_edge = i == 0;
            self.arc_at.push(if on_split_edge { along } else { None });
            self.nodes_of_edge.push(NodeRange::default());
            self.scale_of_edge.push(0.0);
            if i == outer {
                let k = HalfedgeId(new.0 + i);
                (self.arc_at[k], self.nodes_of_edge[k], self.scale_of_edge[k]) = kept;
                self.redirect_nodes(moved, k);
            }
        }
        self.arc_at[moved] = None;
    }

    /// Nodes that named their edge by half-edge `old` name it by `new` from now on.
    fn redirect_nodes(&mut self, old: HalfedgeId, new: HalfedgeId) {
        for node in self.nodes_of_edge[new].iter() {
            if let Place::Edge(h, _) = &mut self.node_place[node as usize]
                && *h == old
            {
                *h = new;
            }
        }
    }

    /// Fresh nodes on the two halves of a split edge and on the new edges from its middle.
    fn respread(&mut self, h: HalfedgeId, scale: f64, two_sided: bool) {
        let across_left = next(h);
        self.spread_nodes(h, scale);
        let sides = if two_sided { 2 } else { 1 };
        let first_new = HalfedgeId::new(self.arc_at.len() - 3 * sides);
        self.spread_nodes(first_new, scale);
        self.spread_nodes(across_left, scale);
        if let Some(t) = self.conn.twin(h) {
            self.spread_nodes(prev(t), scale);
        }
    }

    /// Splits a face at its centroid into three; returns the new vertex.
    pub fn split_face(&mut self, mesh: &TriMesh, f: FaceId) -> VertexId {
        let corners = self.corner_coordinates(mesh, f);
        let b = std::array::from_fn(|i| (corners[0][i] + corners[1][i] + corners[2][i]) / 3.0);
        let origin = SurfacePoint::from_barycentric(mesh, self.face_origin[f], b);
        let moved = [crate::mesh::corner(f, 1), crate::mesh::corner(f, 2)];
        let scale = self.scale_of_edge[moved[0]];
        let m = self.conn.split_face(f);
        self.positions.push(origin.position(mesh));
        self.origin.push(origin);
        self.landmark_at.push(None);
        self.blocked.push(false);
        let node = self.add_node(Place::Vertex(m));
        self.node_of_vertex.push(node);
        for old in moved {
            let new = HalfedgeId::new(self.arc_at.len());
            self.face_origin.push(self.face_origin[f]);
            self.arc_at.raw.extend([self.arc_at[old], None, None]);
            self.nodes_of_edge.raw.extend([self.nodes_of_edge[old], NodeRange::default(), NodeRange::default()]);
            self.scale_of_edge.raw.extend([self.scale_of_edge[old], 0.0, 0.0]);
            self.redirect_nodes(old, new);
            self.arc_at[old] = None;
        }
        let spokes: Vec<HalfedgeId> = self.conn.outgoing(m).collect();
        for h in spokes {
            self.spread_nodes(h, scale);
        }
        m
    }
}
