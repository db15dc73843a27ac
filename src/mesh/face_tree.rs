//! A tree of bounding boxes over the faces of a mesh: what lies near a point.
//!
//! The faces are halved at the median of the widest side, over and over; the boxes of the halves form an implicit
//! binary tree. Distances are those to the triangles themselves, not to the boxes.

use super::id::{FaceId, Id};
use super::metric::distance_sq;
use super::trimesh::TriMesh;
use glam::DVec3;

/// Faces in a leaf at most; fewer cost memory, more cost distances.
const LEAF: usize = 4;

/// The tree; it borrows the mesh whose faces it holds.
#[derive(Debug)]
pub struct FaceTree<'m> {
    mesh: &'m TriMesh,
    /// Faces, the range of every subtree in one piece.
    order: Vec<FaceId>,
    /// Boxes by heap number: the children of `i` are `2 i + 1` and `2 i + 2`.
    boxes: Vec<Bounds>,
}

#[derive(Clone, Copy, Debug)]
struct Bounds {
    low: DVec3,
    high: DVec3,
}

/// A subtree: its heap number and its range of faces.
#[derive(Clone, Copy)]
struct Node {
    number: usize,
    start: usize,
    end: usize,
}

impl<'m> FaceTree<'m> {
    /// Builds the tree.
    pub fn new(mesh: &'m TriMesh) -> Self {
        let mut tree = FaceTree { mesh, order: mesh.conn.faces().collect(), boxes: Vec::new() };
        let middles: Vec<DVec3> = tree.order.iter().map(|&f| mesh.triangle(f).iter().sum::<DVec3>() / 3.0).collect();
        tree.build(tree.root(), &middles);
        tree
    }

    /// Distance from `p` to the nearest face; infinite without faces.
    pub fn distance(&self, p: DVec3) -> f64 {
        let mut nearest_sq = f64::INFINITY;
        let mut take = |_, distance_sq, reach_sq: &mut f64| {
            nearest_sq = distance_sq;
            *reach_sq = distance_sq;
            false
        };
        let mut reach_sq = f64::INFINITY;
        self.visit(self.root(), p, &mut take, &mut reach_sq);
        nearest_sq.sqrt()
    }

    /// The nearest face within `radius` of `p` of which `test` holds.
    pub fn nearest_within(&self, p: DVec3, radius: f64, mut test: impl FnMut(FaceId) -> bool) -> Option<FaceId> {
        let mut nearest = None;
        let mut take = |f, distance_sq, reach_sq: &mut f64| {
            if test(f) {
                nearest = Some(f);
                *reach_sq = distance_sq;
            }
            false
        };
        let mut reach_sq = radius * radius;
        self.visit(self.root(), p, &mut take, &mut reach_sq);
        nearest
    }

    /// True if `test` holds of a face that comes within `radius` of `p`.
    pub fn any_within(&self, p: DVec3, radius: f64, mut test: impl FnMut(FaceId) -> bool) -> bool {
        let mut reach_sq = radius * radius;
        self.visit(self.root(), p, &mut |f, _, _| test(f), &mut reach_sq)
    }

    fn root(&self) -> Node {
        Node { number: 0, start: 0, end: self.order.len() }
    }

    fn build(&mut self, node: Node, middles: &[DVec3]) {
        if self.boxes.len() <= node.number {
            self.boxes.resize(node.number + 1, Bounds::NOTHING);
        }
        let faces = &mut self.order[node.start..node.end];
        let corners = faces.iter().flat_map(|&f| self.mesh.triangle(f));
        self.boxes[node.number] = corners.fold(Bounds::NOTHING, Bounds::with);
        let Some([left, right]) = node.children() else { return };
        let spread = faces.iter().map(|f| middles[f.index()]).fold(Bounds::NOTHING, Bounds::with);
        let axis = (spread.high - spread.low).max_position();
        faces.select_nth_unstable_by(left.end - node.start, |f, g| {
            middles[f.index()][axis].total_cmp(&middles[g.index()][axis]).then(f.cmp(g))
        });
        self.build(left, middles);
        self.build(right, middles);
    }

    /// Shows `take` the faces within the reach, nearer subtrees first, until it returns true.
    fn visit(
        &self,
        node: Node,
        p: DVec3,
        take: &mut impl FnMut(FaceId, f64, &mut f64) -> bool,
        reach_sq: &mut f64,
    ) -> bool {
        let Some(children) = node.children() else {
            return self.order[node.start..node.end].iter().any(|&f| {
                let distance_sq = distance_sq(p, self.mesh.triangle(f));
                distance_sq <= *reach_sq && take(f, distance_sq, reach_sq)
            });
        };
        let mut near = children.map(|child| (self.boxes[child.number].distance_sq(p), child));
        if near[1].0 < near[0].0 {
            near.swap(0, 1);
        }
        near.into_iter().any(|(distance_sq, child)| distance_sq <= *reach_sq && self.visit(child, p, take, reach_sq))
    }
}

impl Node {
    /// The two halves; none for a leaf.
    fn children(self) -> Option<[Node; 2]> {
        let Node { number, start, end } = self;
        let middle = start.midpoint(end);
        let halves =
            [Node { number: 2 * number + 1, start, end: middle }, Node { number: 2 * number + 2, start: middle, end }];
        (end - start > LEAF).then_some(halves)
    }
}

impl Bounds {
    const NOTHING: Bounds = Bounds { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    fn with(self, p: DVec3) -> Self {
        Bounds { low: self.low.min(p), high: self.high.max(p) }
    }

    fn distance_sq(&self, p: DVec3) -> f64 {
        p.distance_squared(p.clamp(self.low, self.high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{SplitMix, fixture};

    #[test]
    fn queries_agree_with_looking_at_every_face_seed_5() {
        let mesh = fixture::ellipsoid(DVec3::new(1.0, 0.6, 0.3), 3);
        let tree = FaceTree::new(&mesh);
        let mut random = SplitMix::new(5);
        for _ in 0..200 {
            let p = DVec3::from_array([0; 3].map(|_| 2.4 * random.unit() - 1.2));
            let distances: Vec<f64> = mesh.conn.faces().map(|f| distance_sq(p, mesh.triangle(f)).sqrt()).collect();
            let nearest = distances.iter().copied().fold(f64::INFINITY, f64::min);
            assert_eq!(tree.distance(p), nearest);
            let radius = 1.5 * nearest;
            let mut found = Vec::new();
            assert!(!tree.any_within(p, radius, |f| {
                found.push(f);
                false
            }));
            found.sort();
            let expected: Vec<FaceId> = mesh.conn.faces().filter(|f| distances[f.index()] <= radius).collect();
            assert_eq!(found, expected);
            assert!(tree.any_within(p, radius, |_| true));
        }
    }
}
