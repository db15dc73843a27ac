//! Orders in which arcs are carried to the target; the order matters more than search.

use super::trace::{Link, Traced};
use crate::mesh::{ArcId, Id, IdVec, LandmarkId};
use crate::path::cluster::Clusters;
use std::cmp::Ordering;

/// A rule that sorts the arcs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Pairs with a single cut on both meshes, then pairs without a cut, then several cuts (VORONOI, procedure 1).
    Cuts,
    /// The shortest arcs first.
    Shortest,
    /// A spanning tree of shortest arcs first, then the rest.
    Tree,
    /// The same with the arcs of the outermost landmarks leading.
    OuterTree,
}

/// All orders.
pub const ORDERS: [Order; 4] = [Order::Cuts, Order::Shortest, Order::Tree, Order::OuterTree];

/// Sorts the arcs of `source`; `length` is each arc's length relative to its mesh, summed over both meshes.
pub fn arrange(order: Order, source: &Traced, target: &Clusters, length: &IdVec<ArcId, f64>) -> Vec<ArcId> {
    let mut arcs: Vec<ArcId> = source.base.arcs.ids().collect();
    arcs.sort_by(|&a, &b| length[a].total_cmp(&length[b]));
    let tree = spanning_tree(source, &arcs);
    match order {
        Order::Shortest => {}
        Order::Cuts => arcs.sort_by_key(|&a| cut_class(source, target, a)),
        Order::Tree => arcs.sort_by_key(|&a| !tree[a]),
        Order::OuterTree => {
            let reach = outwardness(source, length);
            let outer = |a: ArcId| source.base.arcs[a].map(|l| reach[l]).into_iter().fold(0.0, f64::max);
            arcs.sort_by(|&a, &b| {
                tree[b].cmp(&tree[a]).then(if tree[a] { outer(b).total_cmp(&outer(a)) } else { Ordering::Equal })
            });
        }
    }
    arcs
}

/// Class of an arc in VORONOI's procedure 1: 0 single cut on both, 1 no cut, 2 several cuts.
fn cut_class(source: &Traced, target: &Clusters, arc: ArcId) -> u8 {
    let [a, b] = source.base.arcs[arc];
    let twins = source.base.arcs.iter().filter(|&&[c, d]| (c, d) == (a, b) || (c, d) == (b, a)).count();
    match (twins, target.linkage(a, b)) {
        (1, 1) if source.links[arc] == Link::Cut => 0,
        (1, 0 | 1) => 1,
        _ => 2,
    }
}

/// Marks the arcs of the shortest spanning tree; `sorted` lists all arcs, shortest first.
fn spanning_tree(source: &Traced, sorted: &[ArcId]) -> IdVec<ArcId, bool> {
    let mut part: IdVec<LandmarkId, u32> = source.cut.landmarks.ids().map(|l| l.index() as u32).collect();
    let mut tree = IdVec::filled(false, source.base.arcs.len());
    for &arc in sorted {
        let [a, b] = source.base.arcs[arc].map(|l| part[l]);
        if a != b {
            tree[arc] = true;
            part.raw.iter_mut().filter(|p| **p == a).for_each(|p| *p = b);
        }
    }
    tree
}

/// How far out every landmark lies: its mean arc length.
fn outwardness(source: &Traced, length: &IdVec<ArcId, f64>) -> IdVec<LandmarkId, f64> {
    let mut sum = IdVec::filled((0.0, 0.0), source.cut.landmarks.len());
    for (arc, ends) in source.base.arcs.iter_ids() {
        for &l in ends {
            sum[l] = (sum[l].0 + length[arc], sum[l].1 + 1.0);
        }
    }
    sum.iter().map(|&(s, n)| s / f64::max(n, 1.0)).collect()
}
