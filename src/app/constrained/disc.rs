//! A mesh made into a disc: closed ones are cut open, all but one boundary loop filled.

use super::seam::{Seam, cut_along, find_seam};
use crate::error::{Error, Result};
use crate::mesh::io::MeshFile;
use crate::mesh::{HalfedgeId, TriMesh, VertexId};
use crate::stage::check::LoadedMesh;
use glam::DVec3;

/// A disc, and how its vertices relate to those of the mesh it was made from.
#[derive(Clone, Debug)]
pub struct Disc {
    /// The disc. Triangle `i` is the mesh's triangle `i`; those that fill holes come after.
    pub mesh: TriMesh,
    /// Number of the mesh's triangles.
    pub real: usize,
    /// For every vertex of the disc the mesh's; none in the middle of filled holes.
    pub vertex_of: Vec<Option<VertexId>>,
    /// The vertices of the seam that the mesh was cut along.
    pub seam: Seam,
    /// Number of boundary loops that were filled.
    pub filled: usize,
}

/// Makes a disc of a checked mesh of one piece and genus 0; `features` are vertices that the seam keeps away from.
///
/// # Errors
/// Input for a mesh in several pieces, or with texture charts of its own, or a seam that does not fit; unsolvable for
/// handles.
pub fn disc_of(loaded: &LoadedMesh, features: &[VertexId], seam: Option<&[VertexId]>) -> Result<Disc> {
    refuse(loaded)?;
    let mesh = &loaded.mesh;
    let loops = mesh.conn.boundary_loops();
    if !loops.is_empty() && seam.is_some() {
        return Err(Error::input("a seam for a mesh that is open already").remedy("leave out --seam"));
    }
    let mut faces = mesh.faces();
    let real = faces.len();
    let mut positions = mesh.positions.raw.clone();
    let mut vertex_of: Vec<Option<VertexId>> = mesh.conn.vertices().map(Some).collect();
    let mut used = Seam::new();
    let mut filled = 0;
    if loops.is_empty() {
        used = seam.map_or_else(|| find_seam(mesh, features), |s| Ok(s.to_vec()))?;
        for (copy, of) in cut_along(mesh, &used, features, &mut faces)? {
            debug_assert_eq!(copy.0 as usize, positions.len());
            positions.push(mesh.positions[of]);
            vertex_of.push(Some(of));
        }
    } else {
        filled = fill_holes(mesh, &loops, &mut faces, &mut positions);
        vertex_of.resize(positions.len(), None);
    }
    let (mesh, vertex_of) = compact(&positions, &faces, &vertex_of)?;
    Ok(Disc { mesh, real, vertex_of, seam: used, filled })
}

fn refuse(LoadedMesh { file, mesh, .. }: &LoadedMesh) -> Result<()> {
    let components = mesh.conn.components().iter().max().map_or(0, |&last| last + 1);
    if components > 1 {
        let second = mesh.conn.components().iter_ids().find(|(_, c)| **c == 1).map(|(f, _)| f.0);
        return Err(Error::input(format!("the mesh is in {components} pieces"))
            .at(format!("face {} begins the second", second.unwrap_or_default()))
            .remedy("texture the pieces one at a time"));
    }
    if mesh.genus() > 0 {
        return Err(Error::unsolvable(format!("the mesh has {} handles and is not disc-like", mesh.genus()))
            .remedy("cut the handles open, or fill them"));
    }
    let charts = charts(file);
    if charts > 1 {
        return Err(Error::input(format!("the mesh has texture coordinates of its own, in {charts} charts"))
            .remedy("they are left alone; to replace them, export the mesh without texture coordinates"));
    }
    Ok(())
}

/// Number of pieces that the mesh's own texture coordinates form; 0 without any.
fn charts(file: &MeshFile) -> usize {
    if file.uv.values.is_empty() {
        return 0;
    }
    let mut tree: Vec<usize> = (0..file.uv.values.len()).collect();
    let root = |tree: &mut Vec<usize>, mut v: usize| {
        while tree[v] != v {
            tree[v] = tree[tree[v]];
            v = tree[v];
        }
        v
    };
    let mut used = vec![false; tree.len()];
    for p in 0..file.polygon_count() {
        let corners: Vec<usize> = file.polygon(p).filter_map(|c| file.uv.index(c)).map(|i| i as usize).collect();
        corners.iter().for_each(|&i| used[i] = true);
        for pair in corners.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|v| root(&mut tree, v));
            tree[a.max(b)] = a.min(b);
        }
    }
    (0..tree.len()).filter(|&v| used[v] && tree[v] == v).count()
}

/// Closes all loops but the longest with fans around their centres; returns how many.
fn fill_holes(
    mesh: &TriMesh,
    loops: &[Vec<HalfedgeId>],
    faces: &mut Vec<[VertexId; 3]>,
    positions: &mut Vec<DVec3>,
) -> usize {
    let point = |h: HalfedgeId| mesh.positions[mesh.conn.from(h)];
    let end = |h: HalfedgeId| mesh.positions[mesh.conn.to(h)];
    let length = |l: &[HalfedgeId]| l.iter().map(|&h| point(h).distance(end(h))).sum::<f64>();
    let longest = (0..loops.len()).max_by(|&i, &j| length(&loops[i]).total_cmp(&length(&loops[j])).then(j.cmp(&i)));
    for (i, hole) in loops.iter().enumerate() {
        if Some(i) == longest {
            continue;
        }
        let centre = VertexId(positions.len() as u32);
        positions.push(hole.iter().map(|&h| point(h)).sum::<DVec3>() / hole.len() as f64);
        faces.extend(hole.iter().map(|&h| [mesh.conn.to(h), mesh.conn.from(h), centre]));
    }
    loops.len() - 1
}

/// The mesh without vertices that no face uses.
fn compact(
    positions: &[DVec3],
    faces: &[[VertexId; 3]],
    vertex_of: &[Option<VertexId>],
) -> Result<(TriMesh, Vec<Option<VertexId>>)> {
    let mut number = vec![None; positions.len()];
    faces.as_flattened().iter().for_each(|v| number[v.0 as usize] = Some(VertexId(0)));
    let kept: Vec<usize> = (0..positions.len()).filter(|&v| number[v].is_some()).collect();
    (0u32..).zip(&kept).for_each(|(i, &v)| number[v] = Some(VertexId(i)));
    let renumber = |v: VertexId| number[v.0 as usize].unwrap_or(v);
    let faces: Vec<[VertexId; 3]> = faces.iter().map(|t| t.map(renumber)).collect();
    let mesh = TriMesh::new(kept.iter().map(|&v| positions[v]).collect(), &faces)
        .map_err(|fault| Error::bug("a mesh made into a disc is not a manifold").at(format!("{fault:?}")))?;
    Ok((mesh, kept.iter().map(|&v| vertex_of[v]).collect()))
}
