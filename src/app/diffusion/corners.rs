//! The four corners of every region: given by its sides, or found where three regions meet (DIFFUSION 2.7).

use super::bisect::corner_of;
use super::borders::{vertex_at_share, walked};
use super::disc::{Disc, Labels};
use crate::error::{Error, Result};
use crate::mesh::io::{Region, Regions, SIDES};
use crate::mesh::{TriMesh, VertexId, face_of};
use serde::Serialize;
use std::collections::BTreeSet;

/// Where the sides of a region meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Corners {
    /// Vertices, counter-clockwise; the first side, v0, runs from the first to the second.
    pub at: [VertexId; 4],
    /// True if the sides come as v0, u0, v1, u1 and not as v0, u1, v1, u0: u and v then are left-handed.
    pub mirrored: bool,
    /// True if the region file has them.
    pub given: bool,
}

/// What was done to a region with more or fewer than four neighbours.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Completion {
    /// The region.
    pub region: String,
    /// `split`: the longest side was split at the vertex; `joined`: the shortest was joined to its neighbour there.
    pub what: &'static str,
    /// The vertex.
    pub vertex: VertexId,
}

/// The corners of all regions; where there are none, how four were made.
///
/// # Errors
/// Input: sides that are no parts of their region's border, that overlap or cross, or a border of fewer than four edges.
pub fn corners(
    mesh: &TriMesh,
    regions: &Regions,
    labels: &Labels,
    discs: &[Disc],
    nodes: &BTreeSet<VertexId>,
) -> Result<(Vec<Corners>, Vec<Completion>)> {
    let mut completions = Vec::new();
    let mut all = Vec::with_capacity(discs.len());
    for (region, disc) in regions.list.iter().zip(discs) {
        let corners = match &region.sides {
            Some(sides) => given(region, disc, sides),
            None => found(mesh, labels, &region.name, disc, nodes, &mut completions),
        };
        all.push(corners.map_err(|e| e.file(&regions.path))?);
    }
    Ok((all, completions))
}

/// The order of [`SIDES`] counter-clockwise, and the same for left-handed coordinates.
const AROUND: [usize; 4] = [2, 1, 3, 0];
const AROUND_MIRRORED: [usize; 4] = [2, 0, 3, 1];

/// The corners between given sides: the vertex that two of them share, or the middle of the gap between them.
fn given(region: &Region, disc: &Disc, sides: &[Vec<VertexId>; 4]) -> Result<Corners> {
    let crossing = || {
        Error::input(format!("the sides of region \"{}\" cross or overlap", region.name))
            .remedy("let v0, u1, v1 and u0 follow each other around its border, with one vertex in common at most")
    };
    let spans = spans(&marks(region, disc, sides)?).filter(|spans| spans.len() == 4).ok_or_else(crossing)?;
    let mirrored = [AROUND, AROUND_MIRRORED].iter().position(|order| (0..4).all(|i| spans[i].0 == order[i]));
    let mirrored = mirrored.ok_or_else(crossing)? == 1;
    let n = disc.rim.len();
    let between = |i: usize| {
        let (end, start) = (spans[(i + 3) % 4].2, spans[i].1);
        let gap = (start + n - end) % n;
        disc.vertices[(end + gap / 2) % n]
    };
    let at = [0, 1, 2, 3].map(between);
    let distinct: BTreeSet<VertexId> = at.into_iter().collect();
    if distinct.len() < 4 {
        return Err(crossing());
    }
    Ok(Corners { at, mirrored, given: true })
}

/// For every place of the rim the sides that list it, one bit each.
fn marks(region: &Region, disc: &Disc, sides: &[Vec<VertexId>; 4]) -> Result<Vec<u8>> {
    let mut on = vec![0u8; disc.rim.len()];
    for (k, side) in sides.iter().enumerate() {
        for &v in side {
            let place = disc.on_rim(v).ok_or_else(|| {
                Error::input(format!("side {} of region \"{}\" leaves its border", SIDES[k], region.name))
                    .at(v)
                    .remedy("list vertices on the region's border")
            })?;
            on[place] |= 1 << k;
        }
    }
    Ok(on)
}

/// The maximal spans of places on one side around a rim, each as side, first and last place, v0 first. A place on two
/// sides ends one span and starts the next. None if there is no such order.
fn spans(on: &[u8]) -> Option<Vec<(usize, usize, usize)>> {
    let n = on.len();
    let single = |bits: u8| (bits.count_ones() == 1).then(|| bits.trailing_zeros() as usize);
    // Start where the span of v0 starts: at a place of v0 whose last marked place before it is not of v0 alone.
    let before = |i: usize| (1..=n).map(|d| (i + n - d) % n).find(|&j| on[j] != 0);
    let is_start = |&i: &usize| {
        on[i] & 4 != 0 && before(i).is_some_and(|j| on[j] & 4 == 0 || (on[j] != 4 && single(on[i]).is_none()))
    };
    let first = (0..n).find(is_start)?;
    let mut spans: Vec<(usize, usize, usize)> = vec![(2, first, first)];
    for i in (1..n).map(|d| (first + d) % n).filter(|&i| on[i] != 0) {
        let last = spans.len() - 1;
        let side = spans[last].0;
        let others = on[i] & !(1 << side);
        if on[i] & (1 << side) != 0 {
            spans[last].2 = i;
        }
        if others != 0 {
            spans.push((single(others)?, i, i));
        }
    }
    // The first place may also end the last span.
    let others = on[first] & !4;
    if others != 0 {
        let last = spans.len() - 1;
        (single(others)? == spans[last].0).then_some(())?;
        spans[last].2 = first;
    }
    Some(spans)
}

/// Corners at nodes; the longest side is split, or the shortest joined to the shorter one beside it, until there are four.
fn found(
    mesh: &TriMesh,
    labels: &Labels,
    name: &str,
    disc: &Disc,
    nodes: &BTreeSet<VertexId>,
    completions: &mut Vec<Completion>,
) -> Result<Corners> {
    let mut note = |what, place: usize| {
        completions.push(Completion { region: name.to_owned(), what, vertex: disc.vertices[place] });
    };
    let mut places: Vec<usize> = (0..disc.rim.len()).filter(|&i| nodes.contains(&disc.vertices[i])).collect();
    if places.is_empty() {
        places.push(corner_of(mesh, &disc.rim));
        note("split", places[0]);
    }
    while places.len() > 4 {
        note("joined", join_shortest(mesh, disc, &mut places));
    }
    while places.len() < 4 {
        let place = split_longest(mesh, disc, &mut places).ok_or_else(|| {
            Error::input(format!("region \"{name}\" has a border of {} edges, too few for four sides", disc.rim.len()))
                .at(disc.faces[0])
                .remedy("make it larger")
        })?;
        note("split", place);
    }
    places.sort_unstable();
    // The first side is the one that touches the region that comes first; what lies beyond the boundary comes last.
    let beyond = |i: usize| mesh.conn.twin(disc.rim[i]).map_or(u32::MAX, |t| labels[face_of(t)]);
    let first = (0..4).min_by_key(|&k| beyond(places[k])).unwrap_or(0);
    places.rotate_left(first);
    Ok(Corners { at: [0, 1, 2, 3].map(|k| disc.vertices[places[k]]), mirrored: false, given: false })
}

/// The rim from corner `i` to the next one: places and vertices.
fn side(disc: &Disc, places: &[usize], i: usize) -> (Vec<u32>, Vec<VertexId>) {
    let path = disc.stretch_of_rim(places[i], places[(i + 1) % places.len()]);
    let vertices = path.iter().map(|&v| disc.vertices[v as usize]).collect();
    (path, vertices)
}

fn lengths(mesh: &TriMesh, disc: &Disc, places: &[usize]) -> Vec<f64> {
    let length = |i| walked(mesh, &side(disc, places, i).1).last().copied().unwrap_or(0.0);
    (0..places.len()).map(length).collect()
}

/// Removes the corner between the shortest side and the shorter one beside it.
fn join_shortest(mesh: &TriMesh, disc: &Disc, places: &mut Vec<usize>) -> usize {
    let (n, lengths) = (places.len(), lengths(mesh, disc, places));
    let shortest = (0..n).min_by(|&i, &j| lengths[i].total_cmp(&lengths[j])).unwrap_or(0);
    let is_before_shorter = lengths[(shortest + n - 1) % n] <= lengths[(shortest + 1) % n];
    places.remove(if is_before_shorter { shortest } else { (shortest + 1) % n })
}

/// Adds a corner in the middle of the longest side with a vertex inside; none if there is no such side.
fn split_longest(mesh: &TriMesh, disc: &Disc, places: &mut Vec<usize>) -> Option<usize> {
    let lengths = lengths(mesh, disc, places);
    let middle = |i: usize| {
        let (path, vertices) = side(disc, places, i);
        vertex_at_share(mesh, &vertices, 0.5).map(|k| path[k] as usize)
    };
    let splittable = (0..places.len()).filter_map(|i| Some((lengths[i], i, middle(i)?)));
    let (_, i, place) = splittable.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)))?;
    places.insert(i + 1, place);
    Some(place)
}

#[cfg(test)]
mod tests {
    use super::spans;

    /// Bits: 1 u0, 2 u1, 4 v0, 8 v1.
    #[test]
    fn sides_follow_each_other_with_shared_corners_or_gaps() {
        let expected = |order: [usize; 4]| Some(order.to_vec());
        let order = |on: &[u8]| spans(on).map(|s| s.iter().map(|s| s.0).collect::<Vec<_>>());
        assert_eq!(order(&[5, 4, 6, 2, 10, 8, 9, 1]), expected([2, 1, 3, 0]));
        assert_eq!(order(&[0, 4, 0, 2, 0, 8, 0, 1]), expected([2, 1, 3, 0]));
        assert_eq!(order(&[4, 6, 2, 10, 8, 9, 1, 5]), expected([2, 1, 3, 0]));
        assert_eq!(order(&[6, 4, 5, 1, 9, 8, 10, 2]), expected([2, 0, 3, 1]));
        assert_eq!(spans(&[5, 4, 6, 2, 10, 8, 9, 1]).map(|s| (s[0].1, s[0].2, s[3].2)), Some((0, 2, 0)));
    }

    #[test]
    fn sides_that_cross_have_no_order_of_four() {
        for on in [[4u8, 2, 4, 2, 8, 8, 1, 1], [4, 4, 12, 8, 2, 2, 1, 1], [4, 6, 6, 2, 8, 8, 1, 1]] {
            let order: Option<Vec<usize>> = spans(&on).map(|s| s.iter().map(|s| s.0).collect());
            let is_sound = order == Some(vec![2, 1, 3, 0]) || order == Some(vec![2, 0, 3, 1]);
            assert!(!is_sound, "{on:?}: {order:?}");
        }
    }
}
