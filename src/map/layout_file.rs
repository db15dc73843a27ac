//! `layout.json`: the base complex and the arcs on both meshes.

use super::base_complex::{BaseComplex, DirectedArc};
use super::file_order::Onto;
use super::tile_table::{ArcEntry, TileTable};
use crate::mesh::{ArcId, IdVec, SurfacePoint, VertexId};
use serde::Serialize;

/// The content of `layout.json`.
#[derive(Debug, Serialize)]
pub struct LayoutFile {
    /// The landmarks; their numbers are what arcs refer to.
    pub landmarks: Vec<LandmarkEntry>,
    /// The two landmarks of every arc.
    pub arcs: Vec<[u32; 2]>,
    /// The three sides of every patch, counter-clockwise.
    pub patches: Vec<[ArcEntry; 3]>,
    /// The atlas of the geometry images, null without images.
    pub atlas: Option<TileTable>,
    /// The arcs on the source, in the order of `arcs`, each from its first end to its second.
    pub source: Vec<Polyline>,
    /// The arcs on the target, likewise.
    pub target: Vec<Polyline>,
}

/// One landmark.
#[derive(Debug, Serialize)]
pub struct LandmarkEntry {
    /// The user's name for it.
    pub name: String,
    /// Its vertex of the source, 0-based.
    pub source_vertex: u32,
    /// Its vertex of the target, 0-based.
    pub target_vertex: u32,
}

/// One arc on one mesh.
#[derive(Debug, Serialize)]
pub struct Polyline {
    /// Its points as elements of the mesh.
    pub points: Vec<PointEntry>,
    /// The same points in space.
    pub xyz: Vec<[f64; 3]>,
}

/// A surface point in vertex and face numbers of the input file, 0-based.
#[derive(Debug, Serialize)]
#[serde(untagged)]
pub enum PointEntry {
    /// At a vertex.
    Vertex {
        /// The vertex.
        vertex: u32,
    },
    /// On an edge.
    Edge {
        /// Its two vertices.
        edge: [u32; 2],
        /// The share of the way from the first to the second, in (0, 1).
        t: f64,
    },
    /// In a triangle.
    Face {
        /// The triangle.
        face: u32,
        /// Barycentric coordinates in corner order.
        bary: [f64; 3],
    },
}

impl PointEntry {
    /// The entry for a point on a mesh.
    pub fn new(point: SurfacePoint, onto: Onto) -> Self {
        let mesh = onto.mesh;
        match point {
            SurfacePoint::Vertex(VertexId(vertex)) => PointEntry::Vertex { vertex },
            SurfacePoint::Edge(h, t) => PointEntry::Edge { edge: [mesh.conn.from(h).0, mesh.conn.to(h).0], t },
            SurfacePoint::Face(f, b) => {
                let (face, bary) = onto.to_file_order(f, b);
                PointEntry::Face { face: face.0, bary }
            }
        }
    }
}

/// The arcs and patches of a base complex as plain numbers.
pub fn base_entries(base: &BaseComplex) -> (Vec<[u32; 2]>, Vec<[ArcEntry; 3]>) {
    let arcs = base.arcs.iter().map(|ends| ends.map(|l| l.0)).collect();
    let side = |side: DirectedArc| ArcEntry { arc: side.arc.0, reversed: side.reversed };
    let patches = base.patches.iter().map(|sides| sides.map(side)).collect();
    (arcs, patches)
}

/// The arcs of one mesh.
pub fn polylines(arcs: &IdVec<ArcId, Vec<SurfacePoint>>, onto: Onto) -> Vec<Polyline> {
    let polyline = |points: &Vec<SurfacePoint>| Polyline {
        points: points.iter().map(|&p| PointEntry::new(p, onto)).collect(),
        xyz: points.iter().map(|p| p.position(onto.mesh).to_array()).collect(),
    };
    arcs.iter().map(polyline).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{FaceId, HalfedgeId, TriMesh};
    use glam::DVec3;

    #[test]
    fn points_are_written_by_kind() {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let mesh = TriMesh::new(positions, &[[0, 1, 2].map(VertexId)]).expect("one triangle is a manifold");
        let points = vec![
            SurfacePoint::Vertex(VertexId(2)),
            SurfacePoint::Edge(HalfedgeId(1), 0.25),
            SurfacePoint::Face(FaceId(0), [0.5, 0.25, 0.25]),
        ];
        let onto = Onto { mesh: &mesh, triangles: &mesh.faces(), omitted: &[] };
        let lines = polylines(&IdVec::from_raw(vec![points]), onto);
        assert_eq!(
            serde_json::to_string(&lines).expect("plain data"),
            concat!(
                r#"[{"points":[{"vertex":2},{"edge":[1,2],"t":0.25},{"face":0,"bary":[0.5,0.25,0.25]}],"#,
                r#""xyz":[[0.0,1.0,0.0],[0.75,0.25,0.0],[0.25,0.25,0.0]]}]"#
            )
        );
    }
}
