//! The four sides of a region as runs of the border graph, and the share of the way at every vertex of them.
//!
//! Between two nodes of a side the share grows with the length walked, so both regions at a run have the same values along
//! it, up to the affine map between the shares at its ends; and so have two meshes that agree on the shares at the nodes.

use super::borders::{Borders, Way, walked};
use super::corners::Corners;
use super::disc::Disc;
use super::square::Side;
use crate::mesh::TriMesh;

/// For every side of a region the share at each of its nodes, from 0 to 1.
pub type NodeShares = [Vec<f64>; 4];

/// The ways of every side, counter-clockwise from the first corner; all corners are nodes.
pub fn sides_of(mesh: &TriMesh, borders: &Borders, region: usize, corners: &Corners) -> [Vec<Way>; 4] {
    let around = &borders.around[region];
    let first = around.iter().position(|&way| borders.start(mesh, way) == corners.at[0]).unwrap_or(0);
    let mut sides: [Vec<Way>; 4] = Default::default();
    let mut side = 0;
    for &way in around.iter().cycle().skip(first).take(around.len()) {
        side = corners.at.iter().position(|&c| c == borders.start(mesh, way)).unwrap_or(side);
        sides[side].push(way);
    }
    sides
}

/// The shares at the nodes of a region's sides by length.
pub fn shares_by_length(mesh: &TriMesh, borders: &Borders, sides: &[Vec<Way>; 4]) -> NodeShares {
    sides.each_ref().map(|ways| {
        let mut shares = vec![0.0];
        for &way in ways {
            let length = walked(mesh, &borders.vertices(mesh, way)).last().copied().unwrap_or(0.0);
            shares.push(shares[shares.len() - 1] + length);
        }
        let total = shares[shares.len() - 1];
        let count = shares.len();
        // A side without length is walked in equal steps.
        let share = |(i, s): (usize, f64)| match i + 1 {
            last if last == count => 1.0,
            _ if total > 0.0 => s / total,
            _ => i as f64 / (count - 1) as f64,
        };
        shares.into_iter().enumerate().map(share).collect()
    })
}

/// The sides with the share at every vertex.
pub fn with_shares(
    mesh: &TriMesh,
    disc: &Disc,
    borders: &Borders,
    sides: &[Vec<Way>; 4],
    nodes: &NodeShares,
) -> [Side; 4] {
    [0, 1, 2, 3].map(|k| {
        let mut side = Side { vertices: Vec::new(), shares: Vec::new() };
        let first = sides[k].first().and_then(|&way| disc.on_rim(borders.start(mesh, way))).unwrap_or(0);
        for (i, &way) in sides[k].iter().enumerate() {
            let walked = walked(mesh, &borders.vertices(mesh, way));
            let total = walked[walked.len() - 1];
            let (from, to) = (nodes[k][i], nodes[k][i + 1]);
            // A run without length is walked in equal steps.
            let part = |j: usize| if total > 0.0 { walked[j] / total } else { j as f64 / (walked.len() - 1) as f64 };
            side.shares.pop();
            side.shares.extend((0..walked.len()).map(|j| from + (to - from) * part(j)));
        }
        side.vertices = (0..side.shares.len()).map(|j| ((first + j) % disc.rim.len()) as u32).collect();
        side
    })
}
