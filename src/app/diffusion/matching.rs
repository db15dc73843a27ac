//! Matches the border graphs of two meshes with regions of the same names, and carries corners over.
//!
//! Once one run of a region has its counterpart, the cyclic order of runs around regions and the regions behind them leave
//! no choice. So every run of a region is tried for one of the other mesh's, and of those that fit all around the one whose
//! nodes lie most alike in the boxes around the meshes is taken.

use super::borders::{Borders, Way, vertex_at_share, walked};
use super::disc::{Bounds, Disc};
use crate::error::{Error, Result};
use crate::mesh::io::Regions;
use crate::mesh::{TriMesh, VertexId};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// A mesh with regions and their natural borders.
pub struct Divided<'a> {
    /// The mesh.
    pub mesh: &'a TriMesh,
    /// Its regions.
    pub regions: &'a Regions,
    /// The regions as discs.
    pub discs: &'a [Disc],
    /// The runs between natural nodes.
    pub borders: Borders,
    /// The natural nodes.
    pub nodes: &'a BTreeSet<VertexId>,
}

/// What corresponds on two meshes.
pub struct Match {
    /// For every region of the first mesh that of the second.
    pub regions: Vec<usize>,
    /// For every way of the first mesh that of the second.
    ways: HashMap<Way, Way>,
    /// True if other matches would fit as well, so that positions decided.
    pub is_symmetric: bool,
}

/// Finds the match.
///
/// # Errors
/// Unsolvable, with a region's name: one that the other mesh lacks, other neighbours, or another arrangement.
pub fn match_regions(a: &Divided, b: &Divided) -> Result<Match> {
    let regions = by_name(a, b)?;
    for (r, &q) in regions.iter().enumerate() {
        compare_neighbours(a, b, r, q)?;
    }
    let mut found = Match { regions, ways: HashMap::new(), is_symmetric: false };
    for r in 0..a.discs.len() {
        if found.ways.contains_key(&a.borders.around[r][0]) {
            continue;
        }
        let seed = a.borders.around[r][0];
        let others = &b.borders.around[found.regions[r]];
        let fits: Vec<HashMap<Way, Way>> =
            others.iter().filter_map(|&way| spread(a, b, &found.regions, [seed, way])).collect();
        found.is_symmetric |= fits.len() > 1;
        let best = fits.into_iter().min_by(|x, y| distance(a, b, x).total_cmp(&distance(a, b, y)));
        let best = best.ok_or_else(|| {
            Error::unsolvable(format!("the regions around \"{}\" are arranged differently", a.regions.list[r].name))
                .file(&b.regions.path)
                .at(format!("against {}", a.regions.path.display()))
                .remedy("let the same regions touch each other on both meshes, in the same order around each")
        })?;
        found.ways.extend(best);
    }
    Ok(found)
}

fn by_name(a: &Divided, b: &Divided) -> Result<Vec<usize>> {
    let lacks = |name: &str, there: &Divided, here: &Divided| {
        Error::unsolvable(format!("there is no region \"{name}\""))
            .file(&there.regions.path)
            .at(format!("it is in {}", here.regions.path.display()))
            .remedy("give both meshes the same regions")
    };
    let numbers: HashMap<&str, usize> = (0..).zip(&b.regions.list).map(|(i, r)| (r.name.as_str(), i)).collect();
    let one = |name: &str| numbers.get(name).copied().ok_or_else(|| lacks(name, b, a));
    let found = a.regions.list.iter().map(|r| one(&r.name)).collect::<Result<Vec<usize>>>()?;
    let named: BTreeSet<usize> = found.iter().copied().collect();
    match (0..b.regions.list.len()).find(|i| !named.contains(i)) {
        Some(extra) => Err(lacks(&b.regions.list[extra].name, a, b)),
        None => Ok(found),
    }
}

/// Refuses a region with other neighbours on the other mesh: in number, in name, or in their order around it.
fn compare_neighbours(a: &Divided, b: &Divided, r: usize, q: usize) -> Result<()> {
    let names = |d: &Divided, region: usize| -> Vec<String> {
        let name = |&way: &Way| match d.borders.beyond(way) {
            Some(other) => format!("\"{}\"", d.regions.list[other as usize].name),
            None => "the boundary".to_owned(),
        };
        d.borders.around[region].iter().map(name).collect()
    };
    let (here, there) = (names(a, r), names(b, q));
    let turned = |k: usize| (0..there.len()).all(|i| here.get(i) == there.get((i + k) % there.len()));
    if here.len() == there.len() && (0..there.len()).any(turned) {
        return Ok(());
    }
    let what = format!("region \"{}\" has other neighbours than on the first mesh", a.regions.list[r].name);
    Err(Error::unsolvable(what)
        .file(&b.regions.path)
        .at(format!("around it lie {}, and not {}", there.join(", "), here.join(", ")))
        .remedy("let the same regions touch each other on both meshes, in the same order around each"))
}

/// The match that follows from one pair of ways; none if it does not fit.
fn spread(a: &Divided, b: &Divided, regions: &[usize], seed: [Way; 2]) -> Option<HashMap<Way, Way>> {
    let [places_a, places_b] = [a, b].map(places);
    let mut ways = HashMap::new();
    let mut stack = vec![seed];
    while let Some([x, y]) = stack.pop() {
        if let Some(&known) = ways.get(&x) {
            if known == y {
                continue;
            }
            return None;
        }
        let ((r, i), (q, j)) = (*places_a.get(&x)?, *places_b.get(&y)?);
        if regions[r] != q || a.borders.around[r].len() != b.borders.around[q].len() {
            return None;
        }
        ways.insert(x, y);
        let after = |d: &Divided, r: usize, i: usize| d.borders.around[r][(i + 1) % d.borders.around[r].len()];
        stack.push([after(a, r, i), after(b, q, j)]);
        match [x, y].map(|way| Way { reversed: !way.reversed, ..way }) {
            twins if places_a.contains_key(&twins[0]) == places_b.contains_key(&twins[1]) => {
                stack.extend(Some(twins).filter(|t| places_a.contains_key(&t[0])));
            }
            _ => return None,
        }
    }
    Some(ways)
}

/// The region of every way and its place around it.
fn places(d: &Divided) -> HashMap<Way, (usize, usize)> {
    let around = d.borders.around.iter().enumerate();
    around.flat_map(|(r, ways)| ways.iter().enumerate().map(move |(i, &way)| (way, (r, i)))).collect()
}

/// How far apart matched nodes lie in the boxes around the meshes: the sum of squares.
fn distance(a: &Divided, b: &Divided, ways: &HashMap<Way, Way>) -> f64 {
    let [box_a, box_b] = [a, b].map(|d| Bounds::of(d.mesh));
    let start = |d: &Divided, bounds: &Bounds, way| bounds.share(d.mesh.positions[d.borders.start(d.mesh, way)]);
    let mut all: Vec<(&Way, &Way)> = ways.iter().collect();
    all.sort(); // sums must not depend on the order of a table
    all.iter().map(|&(&x, &y)| start(a, &box_a, x).distance_squared(start(b, &box_b, y))).sum()
}

impl Match {
    /// For every node of the first mesh a vertex of the second: `extra` are the nodes that are no natural ones, `forced` those
    /// whose counterpart is given.
    ///
    /// # Errors
    /// Unsolvable, if a border of the second mesh has too few vertices, or a forced counterpart lies elsewhere.
    pub fn nodes(
        &self,
        a: &Divided,
        b: &Divided,
        extra: &BTreeSet<VertexId>,
        forced: &BTreeMap<VertexId, VertexId>,
    ) -> Result<BTreeMap<VertexId, VertexId>> {
        let mut nodes = BTreeMap::new();
        for (r, around) in a.borders.around.iter().enumerate() {
            for &way in around {
                let start = a.borders.start(a.mesh, way);
                if a.nodes.contains(&start) {
                    nodes.insert(start, b.borders.start(b.mesh, self.ways[&way]));
                }
                // Backwards it is the same run, seen from its other side.
                if !way.reversed {
                    let fail = |e: Error| e.at(format!("region \"{}\"", a.regions.list[r].name)).file(&b.regions.path);
                    nodes.extend(self.along(a, b, way, extra, forced).map_err(fail)?);
                }
            }
        }
        let off = forced.iter().find(|(v, w)| nodes.get(v).is_some_and(|n| n != *w));
        match off {
            Some((v, w)) => Err(Error::unsolvable("a corner of given sides lies elsewhere than on the first mesh")
                .file(&b.regions.path)
                .at(format!("{w} against {v}"))
                .remedy("let sides meet at corresponding places on both meshes")),
            None => Ok(nodes),
        }
    }
}

impl Match {
    /// The counterparts of the nodes inside a run.
    fn along(
        &self,
        a: &Divided,
        b: &Divided,
        way: Way,
        extra: &BTreeSet<VertexId>,
        forced: &BTreeMap<VertexId, VertexId>,
    ) -> Result<Vec<(VertexId, VertexId)>> {
        let path = a.borders.vertices(a.mesh, way);
        let marks: Vec<usize> = (0..path.len() - 1).filter(|&i| extra.contains(&path[i])).collect();
        if marks.is_empty() {
            return Ok(Vec::new());
        }
        let there = b.borders.vertices(b.mesh, self.ways[&way]);
        let placed = if a.nodes.contains(&path[0]) {
            place_on_run([a.mesh, b.mesh], &path, &marks, &there, forced)
        } else {
            place_on_loop([a.mesh, b.mesh], &path, &marks, there, forced)
        }?;
        Ok(marks.iter().map(|&i| path[i]).zip(placed).collect())
    }
}

/// The counterparts of some inner vertices of a run: at the same shares of the length, one after the other.
fn place_on_run(
    meshes: [&TriMesh; 2],
    path: &[VertexId],
    marks: &[usize],
    there: &[VertexId],
    forced: &BTreeMap<VertexId, VertexId>,
) -> Result<Vec<VertexId>> {
    let walked = walked(meshes[0], path);
    let mut placed: Vec<usize> = Vec::new();
    for (k, &mark) in marks.iter().enumerate() {
        let place = match forced.get(&path[mark]) {
            Some(v) => there.iter().position(|w| w == v),
            None => vertex_at_share(meshes[1], there, walked[mark] / walked[walked.len() - 1]),
        };
        let least = placed.last().map_or(1, |&p| p + 1);
        let most = (there.len() - 1).checked_sub(marks.len() - k);
        let is_free = forced.contains_key(&path[mark]);
        let fitting = place.zip(most).filter(|&(p, most)| least <= most && (!is_free || (least..=most).contains(&p)));
        let (place, most) = fitting.ok_or_else(|| {
            Error::unsolvable("a border has too few vertices for the corners on it, or they lie in another order")
                .remedy("let sides meet at corresponding places on both meshes, or refine the mesh")
        })?;
        placed.push(place.clamp(least, most));
    }
    Ok(placed.into_iter().map(|p| there[p]).collect())
}

/// The same on a border without nodes: the first counterpart is the vertex that lies most alike in the box around its mesh.
fn place_on_loop(
    meshes: [&TriMesh; 2],
    path: &[VertexId],
    marks: &[usize],
    there: Vec<VertexId>,
    forced: &BTreeMap<VertexId, VertexId>,
) -> Result<Vec<VertexId>> {
    let [bounds, bounds_there] = meshes.map(Bounds::of);
    let goal = bounds.share(meshes[0].positions[path[marks[0]]]);
    let apart = |v: VertexId| bounds_there.share(meshes[1].positions[v]).distance_squared(goal);
    let n = there.len() - 1;
    let nearest = (0..n).min_by(|&i, &j| apart(there[i]).total_cmp(&apart(there[j]))).unwrap_or(0);
    let given = forced.get(&path[marks[0]]).and_then(|v| there[..n].iter().position(|w| w == v));
    let first = given.unwrap_or(nearest);
    let turned = |path: &[VertexId], first: usize| -> Vec<VertexId> {
        let n = path.len() - 1;
        (0..=n).map(|i| path[(first + i) % n]).collect()
    };
    let (path_turned, there) = (turned(path, marks[0]), turned(&there, first));
    let rest: Vec<usize> = marks[1..].iter().map(|m| m - marks[0]).collect();
    let mut placed = vec![there[0]];
    if !rest.is_empty() {
        placed.extend(place_on_run(meshes, &path_turned, &rest, &there, forced)?);
    }
    Ok(placed)
}
