//! A finished map at every point, as it is kept in a file: both meshes over the base complex, in terms of their files.
//!
//! Every patch of either mesh is a list of triangles, each a part of a triangle of the mesh's file, with corners in the
//! reference triangle. Both meshes have the same patches, so a point goes from a triangle of one mesh to the reference
//! triangle and on to the other mesh: [`super::transport`].

use super::embedding::EmbeddedMesh;
use super::file_order::Onto;
use crate::error::{Error, Result};
use crate::mesh::io::MeshFile;
use crate::mesh::{Canonical, SurfacePoint};
use glam::DVec2;
use serde::{Deserialize, Serialize};

/// Version of the file's content.
const VERSION: u32 = 1;
/// The file's name in the folder of a finished map.
pub const MAP_FILE: &str = "map.bin";
/// The first bytes of the file.
const MAGIC: &[u8; 8] = b"homeomap";

/// One patch of one mesh.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ChartedPatch {
    /// Points in the reference triangle (0,0), (1,0), (0,1).
    pub points: Vec<[f64; 2]>,
    /// Triangles over the points, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// For every triangle the one of the mesh's file that it is a part of.
    pub faces: Vec<u32>,
    /// For every triangle its corners there, as weights of the second and third corner.
    pub corners: Vec<[[f32; 2]; 3]>,
}

/// One mesh over the base complex.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChartedMesh {
    /// Number of triangles of the file.
    pub triangles: u32,
    /// Tells whether a mesh is this one: see [`fingerprint`].
    pub fingerprint: u32,
    /// The patches, by their numbers in layout.json.
    pub patches: Vec<ChartedPatch>,
}

/// The source and the target over one base complex.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Charts {
    /// The source, then the target.
    pub meshes: [ChartedMesh; 2],
}

/// A checksum of a mesh's positions and triangles.
pub fn fingerprint(mesh: &MeshFile) -> u32 {
    let mut sum = crc32fast::Hasher::new();
    mesh.positions.iter().flat_map(|p| p.to_array()).for_each(|x| sum.update(&x.to_le_bytes()));
    mesh.corners.iter().for_each(|v| sum.update(&v.0.to_le_bytes()));
    sum.finalize()
}

impl ChartedMesh {
    /// An embedded mesh in terms of its file; `canonical` is the order that it was embedded in.
    pub fn new(embedded: &EmbeddedMesh, file: &MeshFile, canonical: &Canonical, onto: Onto) -> Self {
        let part = |f| {
            let face = embedded.cut.face_origin[f];
            let corners = embedded.cut.corner_coordinates(&canonical.mesh, f).map(|b| {
                let SurfacePoint::Face(there, b) = canonical.point_there(SurfacePoint::Face(face, b)) else {
                    unreachable!("a point in a face is one in the other order")
                };
                onto.to_file_order(there, b)
            });
            (corners[0].0.0, corners.map(|(_, b)| [b[1] as f32, b[2] as f32]))
        };
        let patch = |disc: &crate::plane::patch_disc::PatchDisc| {
            let (faces, corners) = disc.faces.iter().map(|&f| part(f)).unzip();
            let points = disc.positions.iter().map(|p| p.to_array()).collect();
            ChartedPatch { points, triangles: disc.triangles.clone(), faces, corners }
        };
        ChartedMesh {
            triangles: onto.triangles.len() as u32,
            fingerprint: fingerprint(file),
            patches: embedded.discs.iter().map(patch).collect(),
        }
    }

    fn check(&self) -> Result<()> {
        for (i, patch) in self.patches.iter().enumerate() {
            let count = patch.triangles.len();
            let is_whole = patch.faces.len() == count && patch.corners.len() == count;
            let known = |t: &[u32; 3]| t.iter().all(|&v| (v as usize) < patch.points.len());
            let sound = is_whole
                && patch.triangles.iter().all(known)
                && patch.faces.iter().all(|&f| f < self.triangles)
                && patch.points.iter().flatten().all(|x| (0.0..=1.0).contains(x))
                && patch.corners.as_flattened().iter().flatten().all(|x| x.is_finite());
            if !sound {
                return Err(damaged().at(format!("patch {i}")));
            }
        }
        Ok(())
    }
}

impl ChartedPatch {
    /// The points as vectors.
    pub fn positions(&self) -> Vec<DVec2> {
        self.points.iter().map(|&p| DVec2::from_array(p)).collect()
    }
}

impl Charts {
    /// The bytes of the file.
    pub fn encode(&self) -> Result<Vec<u8>> {
        let start = [MAGIC.as_slice(), &VERSION.to_le_bytes()].concat();
        postcard::to_extend(self, start).map_err(|e| Error::bug(e.to_string()))
    }

    /// Reads what [`Charts::encode`] wrote, with every index checked.
    pub fn decode(bytes: &[u8]) -> Result<Charts> {
        let Some(rest) = bytes.strip_prefix(MAGIC) else { return Err(damaged()) };
        let Some((version, rest)) = rest.split_first_chunk() else { return Err(damaged()) };
        if u32::from_le_bytes(*version) != VERSION {
            let what = format!("version {} of the map's file, not {VERSION}", u32::from_le_bytes(*version));
            return Err(Error::input(what).remedy("map the pair again"));
        }
        let charts: Charts = postcard::from_bytes(rest).map_err(|_| damaged())?;
        if charts.meshes[0].patches.len() != charts.meshes[1].patches.len() {
            return Err(damaged());
        }
        charts.meshes.iter().try_for_each(ChartedMesh::check)?;
        Ok(charts)
    }
}

fn damaged() -> Error {
    Error::input("the map's file is damaged").remedy("map the pair again")
}
