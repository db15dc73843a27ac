//! The same regions on a second mesh, through a finished map.

use super::disc::Labels;
use super::segment::settle;
use crate::app::finished_map::FinishedMap;
use crate::map::transport::{Transport, reference_points};
use crate::mesh::TriMesh;
use crate::mesh::io::{Region, Regions};
use rayon::prelude::*;
use std::path::PathBuf;

/// The regions of a map's target: every triangle's is the one in which its middle comes out on the source. Sides are left to
/// be found.
pub fn regions_through(map: &FinishedMap, regions: &Regions) -> Regions {
    let points = reference_points(&map.charts.meshes[0]);
    let transport = Transport::new(&map.charts, 1, &points);
    let count = map.meshes[1].triangle_count() as u32;
    let label = |t: u32| {
        let arrival = transport.image(t, [1.0 / 3.0; 3]);
        arrival.map_or(0, |arrival| regions.of_triangle[arrival.face as usize])
    };
    let mut labels = Labels::from_raw((0..count).into_par_iter().map(label).collect());
    if let Ok(mesh) = TriMesh::new(map.meshes[1].positions.clone(), &map.meshes[1].triangles()) {
        settle(&mesh, &mut labels);
    }
    let list = regions.list.iter().map(|r| Region { name: r.name.clone(), sides: None }).collect();
    Regions { path: PathBuf::new(), list, of_triangle: labels.raw }
}
