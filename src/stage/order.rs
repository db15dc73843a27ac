//! Orders in which arcs are carried to the target; the order matters more than search.

use super::trace::{Link, Traced};
use crate::mesh::{ArcId, Id, IdVec, LandmarkId};
use crate::path::cluster::Clusters;

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
    let (count, ends) = (source.cut.landmarks.len(), |a: ArcId| source.base.arcs[a]);
    match order {
        Order::Shortest => {}
        Order::Cuts => arcs.sort_by_key(|&a| cut_class(source, target, a)),
        // How far out landmarks lie does not matter: the shortest arcs of the tree stay first.
        Order::Tree => tree_first(&mut arcs, ends, &IdVec::filled(0.0, count)),
        Order::OuterTree => {
            let lengths = source.base.arcs.iter_ids().map(|(a, &ends)| (ends, length[a]));
            tree_first(&mut arcs, ends, &outwardness(count, lengths));
        }
    }
    arcs
}

/// Puts the paths of the shortest spanning tree first, those that end farthest out leading; `sorted` lists all paths, shortest
/// first, and what is equal keeps its order.
pub(super) fn tree_first<T: Copy>(
    sorted: &mut [T],
    ends: impl Fn(T) -> [LandmarkId; 2],
    outward: &IdVec<LandmarkId, f64>,
) {
    let mut part: IdVec<LandmarkId, u32> = outward.ids().map(|l| l.index() as u32).collect();
    let mut key = |&path: &T| {
        let ends = ends(path);
        let [a, b] = ends.map(|l| part[l]);
        if a != b {
            part.raw.iter_mut().filter(|p| **p == a).for_each(|p| *p = b);
        }
        let is_in_tree = a != b;
        (is_in_tree, if is_in_tree { ends.map(|l| outward[l]).into_iter().fold(0.0, f64::max) } else { 0.0 }, path)
    };
    let mut keyed: Vec<(bool, f64, T)> = sorted.iter().map(&mut key).collect();
    keyed.sort_by(|a, b| b.0.cmp(&a.0).then(b.1.total_cmp(&a.1)));
    sorted.iter_mut().zip(keyed).for_each(|(path, (_, _, now))| *path = now);
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

/// How far out every one of `count` landmarks lies: the mean length of the paths that end there.
pub(super) fn outwardness(
    count: usize,
    lengths: impl Iterator<Item = ([LandmarkId; 2], f64)>,
) -> IdVec<LandmarkId, f64> {
    let mut sum = IdVec::filled((0.0, 0.0), count);
    for (ends, length) in lengths {
        for l in ends {
            sum[l] = (sum[l].0 + length, sum[l].1 + 1.0);
        }
    }
    sum.iter().map(|&(s, n)| s / f64::max(n, 1.0)).collect()
}
