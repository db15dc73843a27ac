//! Neighbourhoods as flat lists: the triangles at every vertex, and the closed ring around every free vertex.

use crate::error::{Error, Result};

/// Many lists of indices in one array: list `i` is `items[starts[i] .. starts[i + 1]]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lists {
    /// Where each list starts, and one entry more for the end of the last.
    pub starts: Vec<u32>,
    /// The entries of all lists, one after the other.
    pub items: Vec<u32>,
}

impl Lists {
    /// Joins lists.
    pub fn new(lists: &[Vec<u32>]) -> Lists {
        let mut starts = vec![0u32];
        starts.extend(lists.iter().scan(0, |end, list| {
            *end += list.len() as u32;
            Some(*end)
        }));
        Lists { starts, items: lists.concat() }
    }

    /// Number of lists.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// True without lists.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// List number `i`.
    pub fn of(&self, i: usize) -> &[u32] {
        &self.items[self.range(i)]
    }

    /// Where list number `i` lies in `items`, and in any array that runs in parallel to it.
    pub fn range(&self, i: usize) -> std::ops::Range<usize> {
        self.starts[i] as usize..self.starts[i + 1] as usize
    }

    /// The triangles at every vertex, ascending.
    pub fn incident(vertices: usize, triangles: &[[u32; 3]]) -> Result<Lists> {
        super::check_indices("triangle corner", triangles.as_flattened(), vertices)?;
        let mut starts = vec![0u32; vertices + 1];
        for &v in triangles.as_flattened() {
            starts[v as usize + 1] += 1;
        }
        for i in 0..vertices {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut items = vec![0; triangles.len() * 3];
        for (f, &v) in triangles.as_flattened().iter().enumerate().map(|(corner, v)| (corner / 3, v)) {
            items[next[v as usize] as usize] = f as u32;
            next[v as usize] += 1;
        }
        Ok(Lists { starts, items })
    }
}

/// The rings of the free vertices: neighbours counter-clockwise and closed, so that triangle `k` at vertex `v` is
/// `(v, ring[k], ring[k + 1])` and the last one `(v, ring[last], ring[0])`. Fixed vertices have an empty ring.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rings(Lists);

impl Rings {
    /// Collects the ring of every vertex `v` with `free[v]`, starting in its lowest-numbered triangle.
    ///
    /// Triangles are counter-clockwise. Fails when the triangles at a free vertex do not form one closed fan (a vertex
    /// on a boundary must be fixed) or a corner is not below `free.len()`.
    pub fn build(triangles: &[[u32; 3]], free: &[bool]) -> Result<Rings> {
        let incident = Lists::incident(free.len(), triangles)?;
        let mut rings = Lists { starts: vec![0], items: Vec::with_capacity(triangles.len() * 3) };
        let mut fan = Vec::new();
        for v in 0..free.len() {
            if free[v] {
                fan.clear();
                fan.extend(incident.of(v).iter().map(|&f| opposite(triangles[f as usize], v as u32)));
                walk(&mut fan, &mut rings.items).ok_or_else(|| not_closed(v))?;
            }
            rings.starts.push(rings.items.len() as u32);
        }
        Ok(Rings(rings))
    }

    /// The rings as lists by vertex.
    pub fn lists(&self) -> &Lists {
        &self.0
    }

    /// The ring of vertex `v`, empty when it is fixed.
    pub fn of(&self, v: usize) -> &[u32] {
        self.0.of(v)
    }

    /// All entries of all rings: pairs of a free vertex and a neighbour, in the order that weights follow.
    pub fn entries(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        (0..self.0.len()).flat_map(|v| self.of(v).iter().map(move |&w| (v as u32, w)))
    }
}

fn not_closed(v: usize) -> Error {
    Error::bug("the triangles around a vertex that may move do not form one closed fan").at(format!("vertex {v}"))
}

/// The edge of triangle `t` that `v` looks at, in the triangle's direction.
fn opposite([a, b, c]: [u32; 3], v: u32) -> (u32, u32) {
    if v == a {
        (b, c)
    } else if v == b {
        (c, a)
    } else {
        (a, b)
    }
}

/// Chains the edges of `fan`, starting with the first, and appends their tails; `None` unless they form one cycle.
fn walk(fan: &mut [(u32, u32)], ring: &mut Vec<u32>) -> Option<()> {
    let &(first, mut tip) = fan.first()?;
    ring.push(first);
    fan.sort_unstable();
    for _ in 1..fan.len() {
        let next = fan.binary_search_by_key(&tip, |&(tail, _)| tail).ok()?;
        if tip == first {
            return None;
        }
        ring.push(tip);
        tip = fan[next].1;
    }
    (tip == first).then_some(())
}
