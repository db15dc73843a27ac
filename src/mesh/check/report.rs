//! What a check found: faults, warnings and figures, as lines for people and as data.

use crate::mesh::{FaceId, TriMesh, VertexId};
use crate::{Error, Result};
use serde::Serialize;
use std::fmt;

/// Most elements of a list in one line for people; the data has all of them.
const LISTED: usize = 8;
/// Most faults in one error message.
const NAMED: usize = 3;

/// Why triangles do not form an orientable manifold.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Fault {
    /// There is nothing but vertices.
    NoFaces,
    /// A coordinate is NaN or infinite.
    NotFinite {
        /// The vertex.
        vertex: VertexId,
    },
    /// A face uses a vertex that does not exist.
    OutOfRange {
        /// The face.
        face: FaceId,
        /// The vertex it names.
        vertex: VertexId,
        /// How many there are.
        vertices: usize,
    },
    /// A face uses a vertex twice.
    RepeatedVertex {
        /// The face.
        face: FaceId,
        /// The vertex.
        vertex: VertexId,
    },
    /// Two faces have the same three vertices.
    DuplicateFace {
        /// The later face.
        face: FaceId,
        /// The earlier one.
        first: FaceId,
    },
    /// More than two faces share an edge.
    NonManifoldEdge {
        /// The edge's ends.
        vertices: [VertexId; 2],
        /// All faces at it.
        faces: Vec<FaceId>,
    },
    /// The faces at a vertex form several fans.
    NonManifoldVertex {
        /// The vertex.
        vertex: VertexId,
        /// Number of fans.
        fans: usize,
    },
    /// A component whose faces have no area, or coordinates of a size at which areas can no longer be computed.
    NoArea {
        /// The component.
        component: usize,
        /// Its first face.
        face: FaceId,
        /// What its faces' areas add up to.
        area: f64,
    },
    /// A component has one side only, like a Moebius band: no choice of orientations agrees everywhere.
    NotOrientable {
        /// An edge where the two faces disagree when all others agree.
        vertices: [VertexId; 2],
        /// Its faces.
        faces: [FaceId; 2],
    },
}

/// What is odd but survived.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Warning {
    /// Faces whose corners lie on a line.
    ZeroArea {
        /// The faces.
        faces: Vec<FaceId>,
    },
    /// Vertices that no face uses.
    Unreferenced {
        /// The vertices.
        vertices: Vec<VertexId>,
    },
    /// Vertices at the position of another: the mesh may be cut open along seams.
    DuplicatePositions {
        /// Vertices at the position of one with a lower number.
        count: usize,
        /// The first such pair.
        first: [VertexId; 2],
    },
    /// A closed component whose faces look inwards; they are turned over.
    InsideOut {
        /// The component.
        component: usize,
        /// Its negative volume.
        volume: f64,
    },
}

/// A set of faces that hang together by edges.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Component {
    /// Its lowest face.
    pub first_face: FaceId,
    /// Number of faces.
    pub faces: usize,
    /// Number of vertices; 0 in a mesh with faults, like all that follows.
    pub vertices: usize,
    /// V - E + F.
    pub euler: i64,
    /// Number of boundary loops.
    pub boundary_loops: usize,
    /// Number of handles, if the mesh has no fault.
    pub genus: Option<i64>,
    /// Area.
    pub area: f64,
    /// Enclosed volume of a closed component, negative if it is inside out.
    pub volume: Option<f64>,
}

impl Default for Component {
    fn default() -> Self {
        let first_face = FaceId(0);
        Component {
            first_face,
            faces: 0,
            vertices: 0,
            euler: 0,
            boundary_loops: 0,
            genus: None,
            area: 0.0,
            volume: None,
        }
    }
}

/// A closed curve of boundary edges.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BoundaryLoop {
    /// Its component.
    pub component: usize,
    /// One of its vertices.
    pub vertex: VertexId,
    /// Number of edges.
    pub edges: usize,
    /// Length.
    pub length: f64,
}

/// Everything a check found.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Report {
    /// Number of vertices, unused ones included.
    pub vertices: usize,
    /// Number of triangles.
    pub faces: usize,
    /// Every fault.
    pub faults: Vec<Fault>,
    /// Every oddity.
    pub warnings: Vec<Warning>,
    /// The components by first face.
    pub components: Vec<Component>,
    /// The boundary loops, if there is no fault.
    pub boundary_loops: Vec<BoundaryLoop>,
    /// Number of handles of all components, if there is no fault.
    pub genus: Option<i64>,
    /// Faces that had to be turned over to agree with their neighbours: corners 1 and 2 swapped.
    pub flipped: Vec<FaceId>,
    /// The repaired mesh, with faces turned to agree and to look outwards, if there is no fault and nobody took it.
    #[serde(skip)]
    pub(super) mesh: Option<TriMesh>,
}

impl Report {
    /// Hands out the repaired mesh, or the error that names the first faults.
    pub fn take_mesh(&mut self) -> Result<TriMesh> {
        if self.faults.is_empty() {
            return self.mesh.take().ok_or_else(|| Error::bug("a mesh without faults could not be joined"));
        }
        let named: Vec<String> = self.faults.iter().take(NAMED).map(Fault::to_string).collect();
        let more = match self.faults.len() - named.len() {
            0 => String::new(),
            n => format!("; and {n} more"),
        };
        let error = Error::input(format!("not a sound manifold: {}{more}", named.join("; ")));
        let error = error.remedy("repair the mesh; `homeo check` lists all faults");
        let pieces = self.components.len();
        Err(if pieces > 1 { error.at(format_args!("in {pieces} components")) } else { error })
    }

    /// The repaired mesh, unless there is a fault or somebody took it.
    pub fn mesh(&self) -> Option<&TriMesh> {
        self.mesh.as_ref()
    }

    /// True if there is no boundary (and no fault).
    pub fn is_closed(&self) -> bool {
        self.faults.is_empty() && self.boundary_loops.is_empty()
    }

    /// The oddities and repairs as sentences.
    pub fn notes(&self) -> Vec<String> {
        let mut notes: Vec<String> = self.warnings.iter().map(Warning::to_string).collect();
        if !self.flipped.is_empty() {
            let faces = counted(self.flipped.len(), "face", "faces");
            notes.push(format!("{faces} turned over to agree with the others: {}", numbers(&self.flipped)));
        }
        notes
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Fault::NoFaces => write!(f, "no faces"),
            Fault::NotFinite { vertex } => write!(f, "{vertex} has a coordinate that is not finite"),
            Fault::OutOfRange { face, vertex, vertices } => {
                write!(f, "{face} uses {vertex}, but there are {vertices} vertices")
            }
            Fault::RepeatedVertex { face, vertex } => write!(f, "{face} uses {vertex} twice"),
            Fault::DuplicateFace { face, first } => write!(f, "{face} has the vertices of {first}"),
            Fault::NonManifoldEdge { vertices: [a, b], faces } => {
                write!(f, "edge {}-{} belongs to {} faces: {}", a.0, b.0, faces.len(), numbers(faces))
            }
            Fault::NonManifoldVertex { vertex, fans } => write!(f, "the faces at {vertex} form {fans} separate fans"),
            Fault::NoArea { component, face, area } => {
                write!(f, "component {component}, from {face} on, has the area {area:e}")
            }
            Fault::NotOrientable { vertices: [a, b], faces: [p, q] } => {
                write!(f, "one-sided surface: {p} and {q} cannot agree at edge {}-{}", a.0, b.0)
            }
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Warning::ZeroArea { faces } => {
                write!(f, "{} without area: {}", counted(faces.len(), "face", "faces"), numbers(faces))
            }
            Warning::Unreferenced { vertices } => {
                let count = counted(vertices.len(), "vertex", "vertices");
                write!(f, "{count} that no face uses: {}", numbers(vertices))
            }
            Warning::DuplicatePositions { count, first: [a, b] } => {
                let count = counted(*count, "vertex", "vertices");
                write!(f, "{count} at the position of another, first {b} at that of {a}")
            }
            Warning::InsideOut { component, volume } => {
                write!(f, "component {component} is inside out (volume {volume:.6}): its faces are turned over")
            }
        }
    }
}

impl fmt::Display for Report {
    /// One line of figures, then one line per fault, warning, repair, component (if several) and boundary loop.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [vertices, faces] =
            [counted(self.vertices, "vertex", "vertices"), counted(self.faces, "triangle", "triangles")];
        write!(f, "{vertices}, {faces}, {}", counted(self.components.len(), "component", "components"))?;
        match self.genus {
            Some(genus) => write!(f, ", genus {genus}, {}", loops(self.boundary_loops.len()))?,
            None => write!(f, ", {}", counted(self.faults.len(), "fault", "faults"))?,
        }
        for fault in &self.faults {
            write!(f, "\nfault: {fault}")?;
        }
        for note in self.notes() {
            write!(f, "\nwarning: {note}")?;
        }
        for (i, c) in self.components.iter().enumerate().filter(|_| self.components.len() > 1) {
            write!(f, "\ncomponent {i}: {} from {}", counted(c.faces, "face", "faces"), c.first_face)?;
            if let Some(genus) = c.genus {
                write!(f, ", genus {genus}, {}", loops(c.boundary_loops))?;
            }
        }
        for (i, one) in self.boundary_loops.iter().enumerate() {
            write!(f, "\nboundary loop {i}: {} edges, length {:.6}, at {}", one.edges, one.length, one.vertex)?;
        }
        Ok(())
    }
}

/// The first few numbers of a list of elements.
fn numbers<I: Copy + crate::mesh::Id>(ids: &[I]) -> String {
    let shown: Vec<String> = ids.iter().take(LISTED).map(|id| id.index().to_string()).collect();
    let dots = if ids.len() > LISTED { ", ..." } else { "" };
    shown.join(", ") + dots
}

fn loops(n: usize) -> String {
    counted(n, "boundary loop", "boundary loops")
}

/// A number with its noun.
fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}
