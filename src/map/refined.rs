//! A refined mesh in the terms of its file: polygons, texture coordinates and groups as they were where nothing was
//! inserted, triangles with interpolated attributes elsewhere.

use super::file_order::Onto;
use crate::error::{Error, Result};
use crate::mesh::io::mesh_file::{Attribute, NO_INDEX};
use crate::mesh::io::{MeshFile, Statement};
use crate::mesh::subdivision::Subdivision;
use crate::mesh::{FaceId, Id, IdVec, SurfacePoint, TriMesh, VertexId};
use glam::{DVec2, DVec3};
use std::collections::HashMap;

/// A mesh with vertices appended.
#[derive(Clone, Debug)]
pub struct RefinedMesh {
    /// What a file of it holds; normals are those of the original corners, and are made anew when it is written.
    pub file: MeshFile,
    /// The same as an oriented manifold.
    pub mesh: TriMesh,
    /// The file's triangles that the mesh lacks, in order.
    pub omitted: Vec<FaceId>,
    /// Where every vertex lies on the other mesh.
    pub images: IdVec<VertexId, Option<SurfacePoint>>,
}

/// Writes a subdivision of `mesh`, which was read from `file` without its triangles `omitted`, in the file's terms.
///
/// Fails only by a bug.
pub fn refined_mesh(
    file: &MeshFile,
    mesh: &TriMesh,
    omitted: &[FaceId],
    subdivision: &Subdivision,
    images: IdVec<VertexId, Option<SurfacePoint>>,
) -> Result<RefinedMesh> {
    let triangles = file.triangles();
    let onto = Onto { mesh, triangles: &triangles, omitted };
    let positions: Vec<DVec3> = subdivision.places.iter().map(|p| p.position(mesh)).collect();
    let appended = &positions[mesh.positions.len()..];
    let mut refined = MeshFile {
        path: file.path.clone(),
        positions: file.positions.iter().chain(appended).copied().collect(),
        uv: Attribute { values: file.uv.values.clone(), corners: Vec::new() },
        normals: Attribute { values: file.normals.values.clone(), corners: Vec::new() },
        material_libraries: file.material_libraries.clone(),
        warnings: file.warnings.clone(),
        ..MeshFile::default()
    };
    let mut work = Work { file, onto, subdivision, known: HashMap::new() };
    let (mut faces, mut still_omitted) = (Vec::new(), Vec::new());
    let mut statements = file.statements.iter().peekable();
    let (mut number, mut next_mesh_face, mut refined_number) = (0usize, 0usize, 0usize);
    for p in 0..file.polygon_count() {
        while let Some(statement) = statements.next_if(|s| s.polygon <= p) {
            refined.statements.push(Statement { polygon: refined.polygon_count(), ..statement.clone() });
        }
        let corners: Vec<[usize; 3]> = file.polygon_triangles(p).collect();
        let mut parts: Vec<Vec<Part>> = Vec::with_capacity(corners.len());
        for t in &corners {
            let f = FaceId::new(number);
            number += 1;
            if omitted.binary_search(&f).is_ok() {
                still_omitted.push(FaceId::new(refined_number));
                refined_number += 1;
                parts.push(vec![Part::Whole(*t)]);
                continue;
            }
            let f = FaceId::new(next_mesh_face);
            next_mesh_face += 1;
            let within = subdivision.within(f);
            refined_number += within.len();
            faces.extend(within.iter().map(|&t| subdivision.triangles[t as usize].map(VertexId)));
            parts.push(match within {
                [_] => vec![Part::Whole(*t)],
                many => many.iter().map(|&part| Part::Of(f, part, *t)).collect(),
            });
        }
        let is_whole = parts.iter().all(|part| matches!(part.as_slice(), [Part::Whole(_)]));
        if is_whole {
            let all: Vec<usize> = file.polygon(p).collect();
            work.copy(&mut refined, &all);
        } else {
            parts.concat().into_iter().for_each(|part| work.add(&mut refined, part));
        }
    }
    let end = refined.polygon_count();
    refined.statements.extend(statements.map(|s| Statement { polygon: end, ..s.clone() }));
    let mesh = TriMesh::new(refined.positions.clone(), &faces)
        .map_err(|e| Error::bug(format!("a refined mesh is not a manifold: {e:?}")))?;
    Ok(RefinedMesh { file: refined, mesh, omitted: still_omitted, images })
}

/// A triangle to be written.
#[derive(Clone, Copy)]
enum Part {
    /// A triangle of the file by its corners.
    Whole([usize; 3]),
    /// A triangle of the subdivision in a face of the mesh, which is the triangle of the file with these corners.
    Of(FaceId, u32, [usize; 3]),
}

struct Work<'a, 'm> {
    file: &'a MeshFile,
    onto: Onto<'a>,
    subdivision: &'a Subdivision<'m>,
    /// The texture coordinates made so far, by vertex and bits.
    known: HashMap<(u32, [u64; 2]), u32>,
}

impl Work<'_, '_> {
    /// Copies a polygon, or a triangle of one, by its corners.
    fn copy(&self, refined: &mut MeshFile, corners: &[usize]) {
        refined.push_polygon(corners.iter().map(|&c| self.file.corners[c].0));
        if !self.file.uv.corners.is_empty() {
            refined.uv.corners.extend(corners.iter().map(|&c| self.file.uv.corners[c]));
        }
    }

    fn add(&mut self, refined: &mut MeshFile, part: Part) {
        let (f, part, corners) = match part {
            Part::Whole(corners) => return self.copy(refined, &corners),
            Part::Of(f, part, corners) => (f, part, corners),
        };
        let mut vertices = self.subdivision.triangles[part as usize];
        let whole = corners.map(|c| self.file.corners[c]);
        if self.is_turned(f, whole) {
            vertices.reverse();
        }
        refined.push_polygon(vertices);
        for v in vertices {
            let shares = self.shares(f, v, whole);
            if !self.file.uv.corners.is_empty() {
                let index = match whole.iter().position(|w| w.0 == v) {
                    Some(i) => self.file.uv.corners[corners[i]],
                    None => {
                        let value = mixed(&self.file.uv, corners, whole, shares);
                        value.map_or(NO_INDEX, |uv| {
                            let key = (v, uv.to_array().map(f64::to_bits));
                            *self.known.entry(key).or_insert_with(|| push(&mut refined.uv.values, uv))
                        })
                    }
                };
                refined.uv.corners.push(index);
            }
        }
    }

    /// True if the mesh has the triangle of the file the other way round.
    fn is_turned(&self, f: FaceId, whole: [VertexId; 3]) -> bool {
        let [a, b, c] = self.onto.mesh.face(f);
        ![[a, b, c], [b, c, a], [c, a, b]].contains(&whole)
    }

    /// The barycentric coordinates of a vertex in a triangle of the file.
    fn shares(&self, f: FaceId, v: u32, whole: [VertexId; 3]) -> [f64; 3] {
        let b = self.subdivision.places[v as usize].barycentric_in(self.onto.mesh, f).unwrap_or([1.0 / 3.0; 3]);
        let corners = self.onto.mesh.face(f);
        whole.map(|w| corners.iter().zip(b).find_map(|(&x, share)| (x == w).then_some(share)).unwrap_or(0.0))
    }
}

fn push(values: &mut Vec<DVec2>, value: DVec2) -> u32 {
    values.push(value);
    values.len() as u32 - 1
}

/// Texture coordinates between the corners of a triangle; summed in order of vertices, so that both triangles at an edge
/// get the same bits. None if a corner has none.
fn mixed(uv: &Attribute<DVec2>, corners: [usize; 3], whole: [VertexId; 3], shares: [f64; 3]) -> Option<DVec2> {
    let mut order = [0, 1, 2];
    order.sort_by_key(|&i| whole[i]);
    let mut sum = DVec2::ZERO;
    for i in order {
        sum += uv.at(corners[i])? * shares[i];
    }
    Some(sum)
}
