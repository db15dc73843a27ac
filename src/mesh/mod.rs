//! Triangle meshes: ids, connectivity, metric, points on surfaces, files, checks.

pub mod canonical;
pub mod check;
pub mod connectivity;
pub mod face_tree;
pub mod id;
pub mod io;
pub mod metric;
pub mod point;
mod quadric;
pub mod salience;
pub mod simplify;
pub mod subdivision;
pub mod trimesh;

pub use canonical::Canonical;
pub use connectivity::{Connectivity, ManifoldError, corner, face_of, next, prev};
pub use id::{ArcId, FaceId, HalfedgeId, Id, IdVec, LandmarkId, PatchId, VertexId};
pub use point::SurfacePoint;
pub use trimesh::TriMesh;
