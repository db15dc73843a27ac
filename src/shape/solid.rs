//! From a solid to a [`Shape`]: polygonise, remesh, find the landmarks.

use super::Shape;
use super::draft::Draft;
use super::field::{Field, cast};
use super::march::{Lattice, march};
use super::remesh::remesh;
use crate::mesh::{TriMesh, VertexId};
use glam::{DQuat, DVec3};

/// Fewest vertices a remeshed solid gets: below it, thin parts such as ears turn into slivers.
pub const FEWEST_VERTICES: usize = 600;

/// A solid with what the mesher and the landmark finder have to know about it.
pub struct Solid<'a> {
    /// Name of the shape.
    pub name: &'a str,
    /// The solid, smooth.
    pub field: &'a Field<'a>,
    /// Centre and radius of a ball that contains it.
    pub bounds: (DVec3, f64),
    /// Lattice cells this long still see every part; at most the thinnest part's radius.
    pub thinnest: f64,
    /// Curvature radius from which on the surface counts as flat and gets the longest edges.
    pub flat: f64,
    /// Turns the lattice, so that different solids get different triangulations.
    pub turn: DQuat,
}

/// A landmark as a ray: its name, a start inside the solid, a direction of any length; it leaves the solid at the
/// landmark.
pub type Ray = (String, DVec3, DVec3);

impl Solid<'_> {
    /// The solid's surface with about `vertices` vertices, at least [`FEWEST_VERTICES`].
    pub fn mesh(&self, vertices: usize) -> TriMesh {
        let vertices = vertices.max(FEWEST_VERTICES);
        let (centre, radius) = self.bounds;
        let lattice = Lattice { centre, radius, cell: self.thinnest, turn: self.turn };
        let (positions, faces) = march(self.field, &lattice);
        let (positions, faces) = remesh(self.field, Draft::new(positions, faces), vertices, self.flat).finish();
        let faces: Vec<_> = faces.into_iter().map(|face| face.map(VertexId)).collect();
        // Marching tetrahedra give a closed manifold, and every step of the remesher keeps it one.
        TriMesh::new(positions, &faces).expect("a remeshed solid is a manifold")
    }

    /// The meshed solid with the vertices nearest to the rays' ends as landmarks, each a vertex of its own.
    pub fn shape(&self, vertices: usize, rays: &[Ray]) -> Shape {
        let mesh = self.mesh(vertices);
        let mut landmarks: Vec<(String, VertexId)> = Vec::new();
        for (name, start, way) in rays {
            let tip = cast(self.field, *start, way.normalize());
            let free = mesh.conn.vertices().filter(|v| landmarks.iter().all(|(_, taken)| taken != v));
            let distance = |&v: &VertexId| mesh.positions[v].distance_squared(tip);
            if let Some(v) = free.min_by(|a, b| distance(a).total_cmp(&distance(b))) {
                landmarks.push((name.clone(), v));
            }
        }
        Shape { name: self.name.to_string(), mesh, landmarks }
    }
}
