//! Carries numbers by vertex from the source of a finished map to the target.
//!
//! Every vertex of the target gets the source's values at its counterpart, interpolated in the triangle there: weights that
//! sum to one still do.

use super::finished_map::FinishedMap;
use crate::map::transport::{Transport, reference_points};
use crate::mesh::io::VertexTable;
use rayon::prelude::*;

/// The table of the target's vertices; not a number for those that no triangle of the map uses.
pub fn carry_values(map: &FinishedMap, table: &VertexTable) -> VertexTable {
    let [source, target] = &map.meshes;
    let points = reference_points(&map.charts.meshes[0]);
    let transport = Transport::new(&map.charts, 1, &points);
    let triangles = source.triangles();
    let mut seat = vec![None; target.positions.len()];
    for (face, corners) in (0u32..).zip(target.triangles()) {
        for (k, v) in corners.into_iter().enumerate() {
            seat[v.0 as usize].get_or_insert((face, k));
        }
    }
    let arrival = |&seat: &Option<(u32, usize)>| {
        let (face, k) = seat?;
        let arrival = transport.image(face, std::array::from_fn(|i| f64::from(u8::from(i == k))))?;
        Some((triangles[arrival.face as usize], arrival.b))
    };
    let arrivals: Vec<_> = seat.par_iter().map(arrival).collect();
    let carried = |column: &Vec<f64>| {
        let one = |arrival: &Option<_>| {
            arrival.map_or(f64::NAN, |(corners, b): ([crate::mesh::VertexId; 3], [f64; 3])| {
                corners.iter().zip(b).map(|(v, w)| w * column[v.0 as usize]).sum()
            })
        };
        arrivals.iter().map(one).collect()
    };
    VertexTable { names: table.names.clone(), columns: table.columns.iter().map(carried).collect() }
}
