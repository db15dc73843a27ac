//! A map that is known without being computed: a ball onto the same ball, pulled out of shape.

use glam::DVec3;
use homeo::map::base_complex::{BaseComplex, DirectedArc};
use homeo::map::certificate::Certificate;
use homeo::map::divided::Divided;
use homeo::map::product::{Product, Shown, Side};
use homeo::map::report::{LayoutSummary, RelaxationSummary};
use homeo::mesh::io::{Landmarks, MeshFile};
use homeo::mesh::{ArcId, Id, IdVec, LandmarkId, PatchId, SurfacePoint, TriMesh, VertexId};
use homeo::shape::fixture::{icosphere, tetrahedron};
use homeo::stage::write::write;
use std::path::{Path, PathBuf};

/// The octants of the ball stand for patches; landmarks and arcs are those of a tetrahedron, wherever they lie.
pub struct BallMap {
    pub meshes: [TriMesh; 2],
    pub files: [MeshFile; 2],
    pub landmarks: Landmarks,
    pub base: BaseComplex,
    divided: Divided,
    arcs: IdVec<ArcId, Vec<SurfacePoint>>,
    image: IdVec<VertexId, Option<SurfacePoint>>,
}

impl BallMap {
    /// With 20 * 4^n triangles on either mesh.
    pub fn new(subdivisions: u32) -> Self {
        let ball = icosphere(subdivisions);
        let pulled = |p: &DVec3| DVec3::new(p.x * (1.3 + 0.5 * p.z), p.y, p.z * (1.0 + 0.4 * p.y));
        let target = TriMesh { positions: ball.positions.iter().map(pulled).collect(), conn: ball.conn.clone() };
        let octant = |p: DVec3| PatchId::new((0..3).fold(0, |o, k| 2 * o + usize::from(p[k] > 0.0)));
        let middle = |t: &[VertexId; 3]| t.iter().map(|&v| ball.positions[v]).sum::<DVec3>();
        let faces = ball.faces();
        let divided = Divided {
            places: ball.conn.vertices().map(SurfacePoint::Vertex).collect(),
            patches: faces.iter().map(|t| octant(middle(t))).collect(),
            faces: ball.conn.faces().collect(),
            triangles: faces,
        };
        let four: Vec<VertexId> = (0..4).map(VertexId).collect();
        let files = [("ball.obj", &ball), ("pulled.obj", &target)]
            .map(|(name, mesh)| MeshFile { path: PathBuf::from(name), ..MeshFile::of(mesh) });
        let arc = [VertexId(0), VertexId(12)].map(SurfacePoint::Vertex).to_vec();
        BallMap {
            landmarks: Landmarks {
                path: PathBuf::from("landmarks.csv"),
                names: ["nose", "left ear", "right ear", "tail"].map(String::from).to_vec(),
                source: four.clone(),
                target: four,
                notes: Vec::new(),
            },
            base: octahedron_like(),
            image: ball.conn.vertices().map(|v| Some(SurfacePoint::Vertex(v))).collect(),
            arcs: IdVec::from_raw(vec![arc; 6]),
            divided,
            meshes: [ball, target],
            files,
        }
    }

    /// Writes the map's folder; `seconds` is what all of it took, `command` none for no page.
    pub fn write(&self, dir: &Path, seconds: f64, command: &str) {
        let side = |k: usize| Side {
            file: &self.files[k],
            mesh: &self.meshes[k],
            omitted: &[],
            arcs: &self.arcs,
            image: &self.image,
            refined: None,
        };
        let shown = Shown { divided: [&self.divided; 2], figures: &[], texture: None, command };
        let product = Product {
            source: side(0),
            target: side(1),
            landmarks: &self.landmarks,
            base: &self.base,
            layout: LayoutSummary { kind: "voronoi", arcs: 6, patches: 8, postponed: 0, flips: 0 },
            relaxation: RelaxationSummary {
                method: "none",
                stretch: Default::default(),
                energies: vec![1.5],
                polish: Vec::new(),
            },
            certificate: Certificate {
                bijective: true,
                same_complex: true,
                patches_are_discs: true,
                positive: true,
                min_orientation: 0.25,
            },
            files: &[],
            images: None,
            device: "CPU",
            warnings: vec!["a warning of this test".to_owned()],
            shown: Some(shown),
        };
        write(&product, dir, || [("write", seconds), ("total", seconds)].into()).expect("the place is free");
    }
}

/// Eight patches over four landmarks: those of a tetrahedron, twice.
fn octahedron_like() -> BaseComplex {
    let mesh = tetrahedron();
    let edges: Vec<_> = mesh.conn.halfedges().filter(|&h| mesh.conn.is_edge_representative(h)).collect();
    let side = |h| {
        let edge = mesh.conn.edge_representative(h);
        let arc = edges.iter().position(|&e| e == edge).expect("every half-edge has an edge");
        DirectedArc { arc: ArcId(arc as u32), reversed: edge != h }
    };
    let patch = |f| [0, 1, 2].map(|i| side(homeo::mesh::corner(f, i)));
    let ends = |h| [mesh.conn.from(h), mesh.conn.to(h)].map(|v| LandmarkId(v.0));
    BaseComplex {
        landmarks: 4,
        arcs: edges.iter().map(|&h| ends(h)).collect(),
        patches: mesh.conn.faces().chain(mesh.conn.faces()).map(patch).collect(),
    }
}
