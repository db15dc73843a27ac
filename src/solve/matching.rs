//! Maximum matching in a general graph by Edmonds' blossom algorithm.
//!
//! J. Edmonds, "Paths, trees, and flowers", Canad. J. Math. 17 (1965); blossoms are kept as a union-find forest of
//! bases, after H. Gabow, "An efficient implementation of Edmonds' algorithm for maximum matching on graphs", J. ACM 23
//! (1976).

use std::collections::VecDeque;

/// Marks a node without partner, predecessor or edge.
const NONE: usize = usize::MAX;

/// A matching of maximum cardinality; for every node the number of the edge that matches it, or None.
///
/// `edges` stand in order of preference: the greedy start takes them in that order, and of several edges between two
/// matched nodes the first is reported. Edges from a node to itself are passed over. The result depends on nothing but
/// the arguments. Time is O(nodes * edges) but for a logarithm, and close to linear after a good start.
///
/// # Panics
/// If an edge names a node that is not below `nodes`.
pub fn maximum_matching(nodes: usize, edges: &[[usize; 2]]) -> Vec<Option<usize>> {
    let mut search = Search::new(nodes, edges);
    search.match_greedily(edges);
    for root in 0..nodes {
        if search.mate[root] == NONE {
            search.augment_from(root);
        }
    }
    matched_edges(&search.mate, edges)
}

/// Names the first edge between every two matched nodes.
fn matched_edges(mate: &[usize], edges: &[[usize; 2]]) -> Vec<Option<usize>> {
    let mut matched = vec![None; mate.len()];
    for (e, &[a, b]) in edges.iter().enumerate() {
        if mate[a] == b && matched[a].is_none() {
            matched[a] = Some(e);
            matched[b] = Some(e);
        }
    }
    matched
}

/// A node's place in the alternating forest.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Label {
    /// Not reached.
    Unseen,
    /// An even number of edges from its root, counted along the alternating path.
    Even,
    /// An odd number of edges from its root.
    Odd,
}

/// The state of the search for augmenting paths.
struct Search {
    /// Neighbours of node `v`: `neighbour[start[v]..start[v + 1]]`.
    start: Vec<usize>,
    neighbour: Vec<usize>,
    mate: Vec<usize>,
    label: Vec<Label>,
    /// The node from which a node was reached by an unmatched edge; inside a blossom, by the way around it.
    before: Vec<usize>,
    /// Union-find forest: the root of a node's tree is the base of the outermost blossom around the node.
    base: Vec<usize>,
    /// When a node was last passed on the way to a common ancestor.
    stamp: Vec<usize>,
    clock: usize,
    queue: VecDeque<usize>,
    /// The nodes labelled by the search under way.
    touched: Vec<usize>,
}

impl Search {
    fn new(nodes: usize, edges: &[[usize; 2]]) -> Self {
        let mut start = vec![0; nodes + 1];
        for &v in edges.iter().flatten() {
            start[v + 1] += 1;
        }
        for v in 0..nodes {
            start[v + 1] += start[v];
        }
        let mut fill = start.clone();
        let mut neighbour = vec![NONE; 2 * edges.len()];
        for &[a, b] in edges {
            for (v, w) in [(a, b), (b, a)] {
                neighbour[fill[v]] = w;
                fill[v] += 1;
            }
        }
        Search {
            start,
            neighbour,
            mate: vec![NONE; nodes],
            label: vec![Label::Unseen; nodes],
            before: vec![NONE; nodes],
            base: (0..nodes).collect(),
            stamp: vec![0; nodes],
            clock: 0,
            queue: VecDeque::new(),
            touched: Vec::new(),
        }
    }

    fn match_greedily(&mut self, edges: &[[usize; 2]]) {
        for &[a, b] in edges {
            if a != b && self.mate[a] == NONE && self.mate[b] == NONE {
                self.mate[a] = b;
                self.mate[b] = a;
            }
        }
    }

    /// Looks for an augmenting path from `root` and flips it.
    ///
    /// The nodes of a search that fails keep their labels: no later augmenting path can pass through them.
    fn augment_from(&mut self, root: usize) {
        self.touched.clear();
        self.queue.clear();
        self.reach(root, Label::Even);
        while let Some(v) = self.queue.pop_front() {
            for i in self.start[v]..self.start[v + 1] {
                if self.examine(v, self.neighbour[i]) {
                    self.forget();
                    return;
                }
            }
        }
    }

    /// Grows the forest over the edge from even node `v` to `w`; true if that completed an augmenting path.
    fn examine(&mut self, v: usize, w: usize) -> bool {
        match self.label[w] {
            Label::Odd => {}
            Label::Unseen => {
                self.reach(w, Label::Odd);
                self.before[w] = v;
                if self.mate[w] == NONE {
                    self.flip(w);
                    return true;
                }
                self.reach(self.mate[w], Label::Even);
            }
            Label::Even => {
                if self.find(v) != self.find(w) {
                    let ancestor = self.common_ancestor(v, w);
                    self.shrink(v, w, ancestor);
                    self.shrink(w, v, ancestor);
                }
            }
        }
        false
    }

    fn reach(&mut self, v: usize, label: Label) {
        self.label[v] = label;
        self.touched.push(v);
        if label == Label::Even {
            self.queue.push_back(v);
        }
    }

    /// Exchanges matched and unmatched edges on the alternating path that ends in the free node `end`.
    fn flip(&mut self, end: usize) {
        let mut odd = end;
        while odd != NONE {
            let even = self.before[odd];
            let next = self.mate[even];
            self.mate[odd] = even;
            self.mate[even] = odd;
            odd = next;
        }
    }

    fn forget(&mut self) {
        for &v in &self.touched {
            self.label[v] = Label::Unseen;
            self.base[v] = v;
        }
    }

    fn find(&mut self, mut v: usize) -> usize {
        while self.base[v] != v {
            self.base[v] = self.base[self.base[v]];
            v = self.base[v];
        }
        v
    }

    /// The first base that the paths from two even nodes to their root share.
    fn common_ancestor(&mut self, v: usize, w: usize) -> usize {
        self.clock += 1;
        let (mut here, mut there) = (v, w);
        loop {
            if here != NONE {
                here = self.find(here);
                if self.stamp[here] == self.clock {
                    return here;
                }
                self.stamp[here] = self.clock;
                here = if self.mate[here] == NONE { NONE } else { self.before[self.mate[here]] };
            }
            std::mem::swap(&mut here, &mut there);
        }
    }

    /// Takes one side of a blossom, from even node `v` up to the base `ancestor`, into it; `across` is the node that
    /// `v` is joined to by the edge that closed the blossom.
    fn shrink(&mut self, mut v: usize, mut across: usize, ancestor: usize) {
        while self.find(v) != ancestor {
            self.before[v] = across;
            let odd = self.mate[v];
            if self.label[odd] == Label::Odd {
                self.label[odd] = Label::Even;
                self.queue.push_back(odd);
            }
            for inside in [v, odd] {
                if self.base[inside] == inside {
                    self.base[inside] = ancestor;
                }
            }
            across = odd;
            v = self.before[odd];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A small deterministic generator (SplitMix64), enough to draw test graphs.
    struct Draw(u64);

    impl Draw {
        fn below(&mut self, n: usize) -> usize {
            self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mut z = self.0;
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            ((z ^ (z >> 31)) % n as u64) as usize
        }

        fn shuffle<T>(&mut self, items: &mut [T]) {
            for i in (1..items.len()).rev() {
                items.swap(i, self.below(i + 1));
            }
        }
    }

    /// Checks that every node's edge is also its partner's, and returns the number of pairs.
    fn pairs(matching: &[Option<usize>], edges: &[[usize; 2]]) -> usize {
        let mut matched = 0;
        for (v, e) in matching.iter().enumerate() {
            if let Some(e) = e {
                let [a, b] = edges[*e];
                assert!(a != b && (v == a || v == b), "node {v} is not at its edge {e}");
                assert_eq!(matching[a], matching[b], "edge {e} matches only one of its ends");
                matched += 1;
            }
        }
        assert!(matched % 2 == 0);
        matched / 2
    }

    /// The size of a maximum matching among the nodes of a bit set, by trying everything.
    fn brute_force(free: u32, adjacent: &[u32], known: &mut [u8]) -> u8 {
        if free == 0 {
            return 0;
        }
        if known[free as usize] == u8::MAX {
            let v = free.trailing_zeros() as usize;
            let rest = free & !(1 << v);
            let mut best = brute_force(rest, adjacent, known);
            for w in (0..adjacent.len()).filter(|w| adjacent[v] & rest & (1 << w) != 0) {
                best = best.max(1 + brute_force(rest & !(1 << w), adjacent, known));
            }
            known[free as usize] = best;
        }
        known[free as usize]
    }

    #[test]
    fn agrees_with_brute_force_on_3000_random_graphs_of_seed_1() {
        let mut draw = Draw(1);
        for round in 0..3000 {
            let nodes = 1 + draw.below(11);
            let count = draw.below(2 * nodes + 2);
            let edges: Vec<[usize; 2]> = (0..count).map(|_| [draw.below(nodes), draw.below(nodes)]).collect();
            let mut adjacent = vec![0u32; nodes];
            for &[a, b] in edges.iter().filter(|[a, b]| a != b) {
                adjacent[a] |= 1 << b;
                adjacent[b] |= 1 << a;
            }
            let best = brute_force((1 << nodes) - 1, &adjacent, &mut vec![u8::MAX; 1 << nodes]);
            let found = pairs(&maximum_matching(nodes, &edges), &edges);
            assert_eq!(found, best as usize, "round {round}: {nodes} nodes, {edges:?}");
        }
    }

    /// Different starts lead to different searches, which must agree in size; the sparse graphs are full of blossoms.
    #[test]
    fn the_order_of_the_edges_does_not_change_the_size_seed_3() {
        let mut draw = Draw(3);
        for round in 0..3000 {
            let nodes = 12 + draw.below(50);
            let count = nodes + draw.below(nodes);
            let mut edges: Vec<[usize; 2]> = (0..count).map(|_| [draw.below(nodes), draw.below(nodes)]).collect();
            let size = pairs(&maximum_matching(nodes, &edges), &edges);
            for _ in 0..4 {
                draw.shuffle(&mut edges);
                assert_eq!(pairs(&maximum_matching(nodes, &edges), &edges), size, "round {round}: {edges:?}");
            }
        }
    }

    #[test]
    fn an_edge_between_two_blossoms_closes_a_third() {
        // Matched pairs are joined by =. The way from 0 to 13 leads around both triangles of pairs and over 5 - 9:
        //
        //   13 - 1 = 2 - 5 = 6 - 8 = 7 - 2        0 - 1, 0 - 3, 5 - 9
        //        3 = 4 - 9 = 10 - 12 = 11 - 4
        let start = [[1, 2], [3, 4], [5, 6], [7, 8], [9, 10], [11, 12]];
        let rest = [[0, 1], [0, 3], [2, 5], [2, 7], [6, 8], [4, 9], [4, 11], [10, 12], [5, 9], [1, 13]];
        let edges = [start.as_slice(), &rest].concat();
        assert_eq!(pairs(&maximum_matching(14, &edges), &edges), 7);
    }

    #[test]
    fn petersen_graph_has_a_perfect_matching() {
        let edges: Vec<[usize; 2]> =
            (0..5).flat_map(|i| [[i, (i + 1) % 5], [i, i + 5], [i + 5, (i + 2) % 5 + 5]]).collect();
        assert_eq!(pairs(&maximum_matching(10, &edges), &edges), 5);
    }

    #[test]
    fn a_cubic_graph_with_three_bridges_at_one_node_has_none() {
        // The centre 15 holds three lobes of five nodes; only one lobe can lend it a partner.
        let mut edges = Vec::new();
        for lobe in 0..3 {
            let v = |i: usize| 5 * lobe + i;
            edges.extend([[v(0), 15], [v(0), v(1)], [v(0), v(2)], [v(1), v(3)], [v(1), v(4)]]);
            edges.extend([[v(2), v(3)], [v(2), v(4)], [v(3), v(4)]]);
        }
        assert_eq!(pairs(&maximum_matching(16, &edges), &edges), 7);
    }

    /// A random cubic graph with a Hamiltonian cycle, and so without a bridge.
    fn hamiltonian_cubic(nodes: usize, draw: &mut Draw) -> Vec<[usize; 2]> {
        let mut chords: Vec<usize> = (0..nodes).collect();
        draw.shuffle(&mut chords);
        let mut edges: Vec<[usize; 2]> = chords.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
        edges.extend((0..nodes).map(|i| [i, (i + 1) % nodes]));
        draw.shuffle(&mut edges);
        edges
    }

    #[test]
    fn bridgeless_cubic_graphs_are_matched_perfectly_seed_2() {
        let mut draw = Draw(2);
        for nodes in (4..80).step_by(2).chain([500, 5000]) {
            let edges = hamiltonian_cubic(nodes, &mut draw);
            assert_eq!(pairs(&maximum_matching(nodes, &edges), &edges), nodes / 2, "{nodes} nodes");
        }
    }

    #[test]
    fn preferred_edges_are_taken_first() {
        let square = [[0, 1], [1, 2], [2, 3], [3, 0]];
        assert_eq!(maximum_matching(4, &square), [Some(0), Some(0), Some(2), Some(2)]);
        let turned = [[1, 2], [2, 3], [3, 0], [0, 1]];
        assert_eq!(maximum_matching(4, &turned), [Some(2), Some(0), Some(0), Some(2)]);
        assert_eq!(maximum_matching(2, &[[1, 1], [1, 0], [0, 1]]), [Some(1), Some(1)]);
    }

    #[test]
    fn empty_graphs_match_nothing() {
        assert!(maximum_matching(0, &[]).is_empty());
        assert_eq!(maximum_matching(3, &[[2, 2]]), [None; 3]);
    }
}
