//! Half-edge connectivity of an oriented triangle manifold, possibly with boundary.
//!
//! Half-edge `3 f + i` runs from corner `i` of face `f` to corner `i + 1`; `next` and `prev` are arithmetic and only the
//! twins are stored. Splitting an edge appends and never renumbers, which is what the cut mesh is grown with.

use super::id::{FaceId, HalfedgeId, Id, IdVec, VertexId};

/// Marks the missing twin of a boundary half-edge.
const NONE: HalfedgeId = HalfedgeId(u32::MAX);

/// Why triangles do not form an oriented manifold; each names the first offending element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ManifoldError {
    /// A face uses a vertex that does not exist.
    OutOfRange(FaceId, VertexId),
    /// A face uses a vertex twice.
    RepeatedVertex(FaceId, VertexId),
    /// Two faces run along an edge in the same direction (three faces at an edge, or clashing orientations).
    EdgeUsedTwice(VertexId, VertexId, FaceId, FaceId),
    /// The faces around a vertex form more than one fan.
    SplitFan(VertexId),
}

/// Half-edge connectivity; see the module documentation.
#[derive(Clone, Debug, Default)]
pub struct Connectivity {
    tip: Vec<VertexId>,
    twin: Vec<HalfedgeId>,
    leaving: IdVec<VertexId, HalfedgeId>,
}

/// The half-edge at corner `i` of face `f`.
pub fn corner(f: FaceId, i: usize) -> HalfedgeId {
    HalfedgeId(3 * f.0 + i as u32)
}

/// The half-edge after `h` in its face.
pub fn next(h: HalfedgeId) -> HalfedgeId {
    HalfedgeId(if h.0 % 3 == 2 { h.0 - 2 } else { h.0 + 1 })
}

/// The half-edge before `h` in its face.
pub fn prev(h: HalfedgeId) -> HalfedgeId {
    HalfedgeId(if h.0.is_multiple_of(3) { h.0 + 2 } else { h.0 - 1 })
}

/// The face left of `h`.
pub fn face_of(h: HalfedgeId) -> FaceId {
    FaceId(h.0 / 3)
}

impl Connectivity {
    /// Joins triangles into an oriented manifold of `vertices` vertices; unreferenced vertices are allowed.
    ///
    /// Time is linear: half-edges are bucketed by their lower vertex, no hashing.
    pub fn build(vertices: usize, faces: &[[VertexId; 3]]) -> Result<Self, ManifoldError> {
        check_corners(vertices, faces)?;
        let tip: Vec<VertexId> = faces.iter().flatten().copied().collect();
        let twin = pair_halfedges(vertices, &tip)?;
        let mut conn = Connectivity { leaving: IdVec::filled(NONE, vertices), tip, twin };
        for h in conn.halfedges() {
            let v = conn.from(h);
            if conn.leaving[v] == NONE || conn.twin(h).is_none() {
                conn.leaving[v] = h;
            }
        }
        conn.check_fans()?;
        Ok(conn)
    }

    fn check_fans(&self) -> Result<(), ManifoldError> {
        let mut degree = vec![0u32; self.leaving.len()];
        for h in self.halfedges() {
            degree[self.from(h).index()] += 1;
        }
        for v in self.leaving.ids() {
            if self.outgoing(v).count() as u32 != degree[v.index()] {
                return Err(ManifoldError::SplitFan(v));
            }
        }
        Ok(())
    }

    /// Number of vertices, unreferenced ones included.
    pub fn vertex_count(&self) -> usize {
        self.leaving.len()
    }

    /// Number of faces.
    pub fn face_count(&self) -> usize {
        self.tip.len() / 3
    }

    /// Number of edges (boundary edges count once).
    pub fn edge_count(&self) -> usize {
        self.halfedges().filter(|&h| self.is_edge_representative(h)).count()
    }

    /// All vertices.
    pub fn vertices(&self) -> impl DoubleEndedIterator<Item = VertexId> + use<> {
        (0..self.leaving.len()).map(VertexId::new)
    }

    /// All faces.
    pub fn faces(&self) -> impl DoubleEndedIterator<Item = FaceId> + use<> {
        (0..self.face_count()).map(FaceId::new)
    }

    /// All half-edges.
    pub fn halfedges(&self) -> impl DoubleEndedIterator<Item = HalfedgeId> + use<> {
        (0..self.tip.len()).map(HalfedgeId::new)
    }

    /// The vertex that `h` leaves.
    pub fn from(&self, h: HalfedgeId) -> VertexId {
        self.tip[h.index()]
    }

    /// The vertex that `h` enters.
    pub fn to(&self, h: HalfedgeId) -> VertexId {
        self.tip[next(h).index()]
    }

    /// The corners of a face in order.
    pub fn face(&self, f: FaceId) -> [VertexId; 3] {
        let i = 3 * f.index();
        [self.tip[i], self.tip[i + 1], self.tip[i + 2]]
    }

    /// The other half of the edge, unless `h` is on the boundary.
    pub fn twin(&self, h: HalfedgeId) -> Option<HalfedgeId> {
        let t = self.twin[h.index()];
        (t != NONE).then_some(t)
    }

    /// True for one of the two halves of every edge: the one with the lower number.
    pub fn is_edge_representative(&self, h: HalfedgeId) -> bool {
        self.twin(h).is_none_or(|t| h < t)
    }

    /// The lower-numbered half of the edge of `h`.
    pub fn edge_representative(&self, h: HalfedgeId) -> HalfedgeId {
        self.twin(h).map_or(h, |t| h.min(t))
    }

    /// A half-edge that leaves `v`; on the boundary the one whose right side is outside. None if `v` is unreferenced.
    pub fn leaving(&self, v: VertexId) -> Option<HalfedgeId> {
        let h = self.leaving[v];
        (h != NONE).then_some(h)
    }

    /// True if `v` lies on a boundary loop.
    pub fn is_on_boundary(&self, v: VertexId) -> bool {
        self.leaving(v).is_some_and(|h| self.twin(h).is_none())
    }

    /// The next half-edge around the start of `h`, counter-clockwise; None past the boundary.
    pub fn turn_left(&self, h: HalfedgeId) -> Option<HalfedgeId> {
        self.twin(prev(h))
    }

    /// The half-edges leaving `v`, counter-clockwise; each stands for the face at its left.
    pub fn outgoing(&self, v: VertexId) -> Outgoing<'_> {
        let start = self.leaving(v);
        Outgoing { conn: self, start, at: start }
    }

    /// The half-edge from `a` to `b`, if there is one in that direction.
    pub fn find(&self, a: VertexId, b: VertexId) -> Option<HalfedgeId> {
        self.outgoing(a).find(|&h| self.to(h) == b)
    }

    /// Splits the edge of `h` and the one or two faces at it; returns the new vertex.
    ///
    /// Afterwards `h` runs from its old start to the new vertex. The faces of `h` and its twin keep their numbers and
    /// the side of that start; the new faces, numbered last, lie beyond the new vertex: first the one left of `h`.
    pub fn split_edge(&mut self, h: HalfedgeId) -> VertexId {
        let m = self.leaving.push(NONE);
        let b = self.to(h);
        let twin = self.twin(h);
        let left = self.split_side(h, m);
        self.leaving[m] = left;
        if let Some(t) = twin {
            let right = self.split_twin_side(t, m);
            self.join(h, t);
            self.join(left, right);
            if self.leaving[b] == t {
                self.leaving[b] = right;
            }
        }
        m
    }

    /// Face (a, b, c) with `h` = a b becomes (a, m, c); the new face is (m, b, c). Returns its half-edge m b.
    fn split_side(&mut self, h: HalfedgeId, m: VertexId) -> HalfedgeId {
        let (bc, ca) = (next(h), prev(h));
        let (b, c) = (self.from(bc), self.from(ca));
        let new = HalfedgeId::new(self.tip.len());
        self.tip.extend([m, b, c]);
        self.twin.extend([NONE; 3]);
        self.move_twin(bc, next(new));
        self.tip[bc.index()] = m;
        self.join(bc, prev(new));
        if self.leaving[b] == bc {
            self.leaving[b] = next(new);
        }
        new
    }

    /// Face (b, a, d) with `t` = b a becomes (m, a, d); the new face is (b, m, d). Returns its half-edge b m.
    fn split_twin_side(&mut self, t: HalfedgeId, m: VertexId) -> HalfedgeId {
        let db = prev(t);
        let (b, d) = (self.from(t), self.from(db));
        let new = HalfedgeId::new(self.tip.len());
        self.tip.extend([b, m, d]);
        self.twin.extend([NONE; 3]);
        self.move_twin(db, prev(new));
        self.tip[t.index()] = m;
        self.join(db, next(new));
        if self.leaving[d] == db {
            self.leaving[d] = prev(new);
        }
        new
    }

    /// Splits face `f` at a new interior vertex into three; `f` keeps its first edge. Returns the new vertex.
    pub fn split_face(&mut self, f: FaceId) -> VertexId {
        let [a, b, c] = self.face(f);
        let m = self.leaving.push(NONE);
        let (h1, h2) = (corner(f, 1), corner(f, 2));
        let second = HalfedgeId::new(self.tip.len());
        self.tip.extend([b, c, m, c, a, m]);
        self.twin.extend([NONE; 6]);
        let third = HalfedgeId(second.0 + 3);
        self.move_twin(h1, second);
        self.move_twin(h2, third);
        self.tip[h2.index()] = m;
        self.join(h1, prev(second));
        self.join(next(second), prev(third));
        self.join(next(third), h2);
        self.leaving[m] = h2;
        for (v, old, new) in [(b, h1, second), (c, h2, third)] {
            if self.leaving[v] == old {
                self.leaving[v] = new;
            }
        }
        m
    }

    fn join(&mut self, a: HalfedgeId, b: HalfedgeId) {
        self.twin[a.index()] = b;
        self.twin[b.index()] = a;
    }

    /// Gives the twin of `old` to `new`.
    fn move_twin(&mut self, old: HalfedgeId, new: HalfedgeId) {
        let t = self.twin[old.index()];
        self.twin[new.index()] = t;
        if t != NONE {
            self.twin[t.index()] = new;
        }
    }

    /// V - E + F over referenced vertices.
    pub fn euler_characteristic(&self) -> i64 {
        let used = self.leaving.iter().filter(|&&h| h != NONE).count();
        used as i64 - self.edge_count() as i64 + self.face_count() as i64
    }

    /// The boundary loops, each as half-edges in order with the surface at their left.
    pub fn boundary_loops(&self) -> Vec<Vec<HalfedgeId>> {
        let mut seen = vec![false; self.tip.len()];
        let mut loops = Vec::new();
        for start in self.halfedges() {
            if self.twin(start).is_some() || seen[start.index()] {
                continue;
            }
            let mut h = start;
            let mut one = Vec::new();
            while !seen[h.index()] {
                seen[h.index()] = true;
                one.push(h);
                h = self.leaving[self.to(h)];
            }
            loops.push(one);
        }
        loops
    }

    /// True for a surface without boundary and in one piece.
    pub fn is_closed_and_connected(&self) -> bool {
        self.halfedges().all(|h| self.twin(h).is_some()) && self.components().iter().all(|&c| c == 0)
    }

    /// The connected component of every face, numbered by first face.
    pub fn components(&self) -> IdVec<FaceId, u32> {
        let mut label = IdVec::filled(u32::MAX, self.face_count());
        let mut count = 0;
        let mut stack = Vec::new();
        for f in self.faces() {
            if label[f] != u32::MAX {
                continue;
            }
            label[f] = count;
            stack.push(f);
            while let Some(g) = stack.pop() {
                for i in 0..3 {
                    if let Some(t) = self.twin(corner(g, i)).filter(|&t| label[face_of(t)] == u32::MAX) {
                        label[face_of(t)] = count;
                        stack.push(face_of(t));
                    }
                }
            }
            count += 1;
        }
        label
    }
}

/// Iterator over the half-edges leaving a vertex; see [`Connectivity::outgoing`].
pub struct Outgoing<'a> {
    conn: &'a Connectivity,
    start: Option<HalfedgeId>,
    at: Option<HalfedgeId>,
}

impl Iterator for Outgoing<'_> {
    type Item = HalfedgeId;
    fn next(&mut self) -> Option<HalfedgeId> {
        let h = self.at?;
        self.at = self.conn.turn_left(h).filter(|&l| Some(l) != self.start);
        Some(h)
    }
}

fn check_corners(vertices: usize, faces: &[[VertexId; 3]]) -> Result<(), ManifoldError> {
    for (i, &[a, b, c]) in faces.iter().enumerate() {
        let f = FaceId::new(i);
        if let Some(&v) = [a, b, c].iter().find(|v| v.index() >= vertices) {
            return Err(ManifoldError::OutOfRange(f, v));
        }
        if a == b || b == c || a == c {
            return Err(ManifoldError::RepeatedVertex(f, if a == b || a == c { a } else { b }));
        }
    }
    Ok(())
}

/// Pairs half-edges that run along one edge in opposite directions.
fn pair_halfedges(vertices: usize, tip: &[VertexId]) -> Result<Vec<HalfedgeId>, ManifoldError> {
    let ends = |h: usize| (tip[h], tip[next(HalfedgeId::new(h)).index()]);
    let mut start = vec![0u32; vertices + 1];
    for h in 0..tip.len() {
        let (a, b) = ends(h);
        start[a.min(b).index() + 1] += 1;
    }
    for v in 0..vertices {
        start[v + 1] += start[v];
    }
    let mut fill = start.clone();
    let mut bucket = vec![0u32; tip.len()];
    for h in 0..tip.len() {
        let (a, b) = ends(h);
        let slot = &mut fill[a.min(b).index()];
        bucket[*slot as usize] = h as u32;
        *slot += 1;
    }
    let mut twin = vec![NONE; tip.len()];
    for v in 0..vertices {
        let around = &mut bucket[start[v] as usize..start[v + 1] as usize];
        around.sort_unstable_by_key(|&h| {
            let (a, b) = ends(h as usize);
            (a.max(b), a > b, h)
        });
        pair_run(around, &ends, &mut twin)?;
    }
    Ok(twin)
}

/// Pairs the half-edges of one bucket, sorted so that the two halves of an edge stand side by side.
fn pair_run(
    around: &[u32],
    ends: &impl Fn(usize) -> (VertexId, VertexId),
    twin: &mut [HalfedgeId],
) -> Result<(), ManifoldError> {
    for pair in around.windows(2) {
        let (h, k) = (pair[0] as usize, pair[1] as usize);
        let ((a, b), (c, d)) = (ends(h), ends(k));
        if (a, b) == (c, d) {
            let face = |h: usize| face_of(HalfedgeId::new(h));
            return Err(ManifoldError::EdgeUsedTwice(a, b, face(h), face(k)));
        }
        if (a, b) == (d, c) {
            twin[h] = HalfedgeId::new(k);
            twin[k] = HalfedgeId::new(h);
        }
    }
    Ok(())
}
