//! The same regions on a second mesh, through a finished map.

use super::disc::{Labels, area_of, faces_by_region, is_border, pieces_of};
use super::segment::settle;
use crate::app::finished_map::FinishedMap;
use crate::map::transport::{Transport, reference_points};
use crate::mesh::io::{Region, Regions};
use crate::mesh::{TriMesh, corner, face_of};
use rayon::prelude::*;
use std::collections::BTreeMap;
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
        give_strays_away(&mesh, &mut labels, regions.list.len());
        settle(&mesh, &mut labels);
    }
    let list = regions.list.iter().map(|r| Region { name: r.name.clone(), sides: None }).collect();
    Regions { path: PathBuf::new(), list, of_triangle: labels.raw }
}

/// Gives the pieces of a region beside its largest one to the region that they have the longest border with: triangles that
/// reach across a border of the source make such pieces.
fn give_strays_away(mesh: &TriMesh, labels: &mut Labels, regions: usize) {
    for faces in faces_by_region(labels, regions) {
        let mut pieces = pieces_of(mesh, labels, &faces);
        let largest = (0..pieces.len())
            .max_by(|&i, &j| area_of(mesh, &pieces[i]).total_cmp(&area_of(mesh, &pieces[j])).then(j.cmp(&i)));
        let Some(largest) = largest else { continue };
        pieces.swap_remove(largest);
        for piece in pieces {
            let mut shared = BTreeMap::new();
            for h in piece.iter().flat_map(|&f| (0..3).map(move |i| corner(f, i))) {
                let Some(t) = mesh.conn.twin(h).filter(|_| is_border(mesh, labels, h)) else { continue };
                let length = mesh.positions[mesh.conn.from(h)].distance(mesh.positions[mesh.conn.to(h)]);
                *shared.entry(labels[face_of(t)]).or_insert(0.0) += length;
            }
            let most = shared.into_iter().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
            piece.iter().for_each(|&f| labels[f] = most.map_or(labels[f], |(r, _)| r));
        }
    }
}
