//! The map between two parametrized meshes with the same regions: equal regions, equal (u, v).

use super::Diffusion;
use super::lookup::Lookup;
use crate::map::distortion::{Distortion, distortion};
use crate::map::flips::flips_on_target;
use crate::mesh::{IdVec, SurfacePoint, VertexId};
use glam::DVec3;
use rayon::prelude::*;

/// Where the vertices of one mesh lie on the other.
#[derive(Clone, Debug)]
pub struct Correspondence {
    /// For every vertex its image; none for a vertex that no face uses.
    pub image: IdVec<VertexId, Option<SurfacePoint>>,
    /// The images' positions; where there are none, the vertex's own.
    pub positions: IdVec<VertexId, DVec3>,
    /// How far the compatible mesh is from an isometry.
    pub distortion: Distortion,
}

/// Maps the vertices of one mesh to another with the same regions in the same order.
pub fn correspond(from: &Diffusion, onto: &Diffusion) -> Correspondence {
    let (here, there) = (Lookup::new(from.mesh, &from.pieces), Lookup::new(onto.mesh, &onto.pieces));
    let vertices: Vec<VertexId> = from.mesh.conn.vertices().collect();
    let image = |&v: &VertexId| here.place(v).map(|place| there.surface_point(place));
    let image: IdVec<VertexId, Option<SurfacePoint>> =
        IdVec::from_raw(vertices.par_iter().map(image).collect::<Vec<_>>());
    let position = |(v, point): (VertexId, &Option<SurfacePoint>)| {
        point.map_or(from.mesh.positions[v], |point| point.position(onto.mesh))
    };
    let positions: IdVec<VertexId, DVec3> = image.iter_ids().map(position).collect();
    let flips = flips_on_target(from.mesh, onto.mesh, &image, &positions).len();
    let distortion = distortion(&from.mesh.faces(), &from.mesh.positions, &positions, flips);
    Correspondence { image, positions, distortion }
}
