//! Base complexes for tests, and the octahedron as one.

use glam::DVec3;
use homeo::Result;
use homeo::app::rebuild::{PositionImage, RGB, rebuild};
use homeo::map::atlas::Atlas;
use homeo::map::base_complex::{BaseComplex, DirectedArc};
use homeo::mesh::{ArcId, LandmarkId, TriMesh};
use homeo::stage::exr::FloatImage;

/// A base complex from the ends of its arcs and, per patch, its sides: arc `a` forward is `a + 1`, backward `-a - 1`.
pub fn complex(landmarks: usize, arcs: &[[u32; 2]], patches: &[[i32; 3]]) -> BaseComplex {
    let side = |s: i32| DirectedArc { arc: ArcId(s.unsigned_abs() - 1), reversed: s < 0 };
    BaseComplex {
        landmarks,
        arcs: arcs.iter().map(|ends| ends.map(LandmarkId)).collect(),
        patches: patches.iter().map(|sides| sides.map(side)).collect(),
    }
}

/// The base complex whose patches are the faces of a closed triangle mesh.
pub fn from_triangles(landmarks: usize, faces: &[[u32; 3]]) -> BaseComplex {
    let mut arcs: Vec<[u32; 2]> = Vec::new();
    let mut patches = Vec::new();
    for face in faces {
        patches.push([0, 1, 2].map(|k| {
            let (a, b) = (face[k], face[(k + 1) % 3]);
            let known = arcs.iter().position(|&ends| ends == [a, b] || ends == [b, a]);
            let arc = known.unwrap_or(arcs.len());
            if known.is_none() {
                arcs.push([a, b]);
            }
            if arcs[arc] == [a, b] { arc as i32 + 1 } else { -(arc as i32) - 1 }
        }));
    }
    complex(landmarks, &arcs, &patches)
}

/// The faces of the octahedron, outwards.
pub const OCTAHEDRON: [[u32; 3]; 8] =
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];

/// Its corners, at distance 1 from the origin.
pub fn octahedron_corners() -> Vec<DVec3> {
    [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z].to_vec()
}

/// An atlas without preferences.
pub fn atlas_of(base: &BaseComplex, tile_size: usize) -> Atlas {
    Atlas::new(base, tile_size, None).expect("the tile size is allowed")
}

/// The mesh that the channels R, G, B of an image hold.
pub fn mesh_of(image: &FloatImage, atlas: &Atlas, base: &BaseComplex) -> Result<TriMesh> {
    Ok(rebuild(&PositionImage::new(image, RGB, atlas.clone(), base.clone())?)?.mesh)
}
