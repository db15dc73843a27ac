//! Greedy vertex colouring: vertices of one colour share no edge and may move at once.
//!
//! Welsh, Powell: An upper bound for the chromatic number of a graph and its application to timetabling problems
//! (1967): vertices by falling degree, each taking the lowest colour its neighbours leave. A triangulation gets five to
//! eight colours this way.

/// Vertices grouped by colour.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Coloring {
    /// Vertices by colour, ascending within one colour.
    pub vertices: Vec<u32>,
    /// Where each colour starts in `vertices`, and one entry more for the end of the last.
    pub starts: Vec<u32>,
}

impl Coloring {
    /// Number of colours.
    pub fn colors(&self) -> usize {
        self.starts.len() - 1
    }

    /// Where the vertices of colour `c` lie in `vertices`.
    pub fn range(&self, c: usize) -> std::ops::Range<u32> {
        self.starts[c]..self.starts[c + 1]
    }

    /// The vertices of colour `c`, ascending.
    pub fn class(&self, c: usize) -> &[u32] {
        &self.vertices[self.starts[c] as usize..self.starts[c + 1] as usize]
    }
}

/// Colours the vertices `v` with neighbours; `neighbors(v)` lists them, and isolated vertices get no colour.
///
/// A vertex that lists another is kept apart from it only if the other lists it back or has no neighbours itself, so
/// vertices that never move are left out by giving them none. The outcome depends on nothing but the graph.
pub fn color<'a>(vertices: usize, neighbors: impl Fn(usize) -> &'a [u32]) -> Coloring {
    let mut order: Vec<u32> = (0..vertices as u32).filter(|&v| !neighbors(v as usize).is_empty()).collect();
    order.sort_by_key(|&v| (std::cmp::Reverse(neighbors(v as usize).len()), v));
    let mut color_of = vec![None; vertices];
    let mut taken_by = Vec::new();
    for &v in &order {
        for &w in neighbors(v as usize) {
            if let Some(c) = color_of[w as usize] {
                let c: u32 = c;
                taken_by[c as usize] = Some(v);
            }
        }
        let free = taken_by.iter().position(|&by| by != Some(v)).unwrap_or(taken_by.len());
        if free == taken_by.len() {
            taken_by.push(None);
        }
        color_of[v as usize] = Some(free as u32);
    }
    by_color(&color_of, taken_by.len())
}

fn by_color(color_of: &[Option<u32>], colors: usize) -> Coloring {
    let mut starts = vec![0; colors + 1];
    for c in color_of.iter().flatten() {
        starts[*c as usize + 1] += 1;
    }
    for c in 0..colors {
        starts[c + 1] += starts[c];
    }
    let mut next = starts.clone();
    let mut vertices = vec![0; starts[colors] as usize];
    for (v, c) in color_of.iter().enumerate().filter_map(|(v, c)| Some((v, (*c)? as usize))) {
        vertices[next[c] as usize] = v as u32;
        next[c] += 1;
    }
    Coloring { vertices, starts }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Neighbour lists of an undirected graph.
    fn graph(vertices: usize, edges: &[(u32, u32)]) -> Vec<Vec<u32>> {
        let mut lists = vec![Vec::new(); vertices];
        for &(a, b) in edges {
            lists[a as usize].push(b);
            lists[b as usize].push(a);
        }
        lists
    }

    fn check_proper(lists: &[Vec<u32>]) -> Coloring {
        let coloring = color(lists.len(), |v| &lists[v]);
        assert_eq!(coloring, color(lists.len(), |v| &lists[v]));
        let mut color_of = vec![None; lists.len()];
        for c in 0..coloring.colors() {
            assert!(!coloring.class(c).is_empty() && coloring.class(c).is_sorted());
            for &v in coloring.class(c) {
                assert_eq!(color_of[v as usize].replace(c), None, "vertex {v} has two colours");
            }
        }
        for (v, list) in lists.iter().enumerate() {
            assert_eq!(color_of[v].is_some(), !list.is_empty(), "vertex {v}");
            assert!(list.iter().all(|&w| color_of[w as usize] != color_of[v]), "vertex {v} shares its colour");
        }
        coloring
    }

    #[test]
    fn small_graphs_get_the_fewest_colours() {
        assert_eq!(check_proper(&graph(3, &[])).colors(), 0);
        assert_eq!(check_proper(&graph(4, &[(0, 1), (1, 2), (2, 3)])).colors(), 2);
        assert_eq!(check_proper(&graph(4, &[(0, 1), (1, 2), (2, 0)])).colors(), 3);
        assert_eq!(check_proper(&graph(4, &[(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)])).colors(), 4);
    }

    #[test]
    fn random_graphs_are_coloured_properly_seed_7() {
        let mut state = 7u32;
        let mut random = |below: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) % below
        };
        for vertices in [2, 10, 101] {
            let edges: Vec<_> = (0..3 * vertices).map(|_| (random(vertices), random(vertices))).collect();
            let edges: Vec<_> = edges.into_iter().filter(|(a, b)| a != b).collect();
            let lists = graph(vertices as usize, &edges);
            let most = lists.iter().map(Vec::len).max().unwrap();
            assert!(check_proper(&lists).colors() <= most + 1);
        }
    }
}
