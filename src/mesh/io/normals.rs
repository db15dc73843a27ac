//! Normals of meshes as they were read, at any positions.

use super::mesh_file::MeshFile;
use glam::DVec3;

/// Written for a vertex whose faces have no area, where any direction is as good.
const ANY_NORMAL: DVec3 = DVec3::Z;

/// Unit normals at the vertices when they stand at `positions`: the area-weighted mean over the triangles around each.
pub fn vertex_normals(mesh: &MeshFile, positions: &[DVec3]) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; positions.len()];
    for triangle in mesh.triangle_corners() {
        let v = triangle.map(|c| mesh.corners[c].0 as usize);
        let [a, b, c] = v.map(|v| positions[v]);
        let doubled = (b - a).cross(c - a);
        for v in v {
            normals[v] += doubled;
        }
    }
    normals.into_iter().map(|n| n.try_normalize().unwrap_or(ANY_NORMAL)).collect()
}
