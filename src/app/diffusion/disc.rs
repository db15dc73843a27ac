//! A region cut out of its mesh as a disc with vertices of its own.

use crate::error::{Error, Result};
use crate::mesh::io::{Region, Regions};
use crate::mesh::{FaceId, HalfedgeId, IdVec, TriMesh, VertexId, corner, face_of, metric, next};
use glam::DVec3;

/// A region that is a disc.
#[derive(Clone, Debug)]
pub struct Disc {
    /// The mesh's vertex of every vertex; those of the rim come first, counter-clockwise.
    pub vertices: Vec<VertexId>,
    /// The mesh's face of every triangle.
    pub faces: Vec<FaceId>,
    /// Triangles over the vertices.
    pub triangles: Vec<[u32; 3]>,
    /// The half-edges of the rim, the region at their left; half-edge `i` leaves vertex `i`.
    pub rim: Vec<HalfedgeId>,
}

/// The region of every face of a mesh.
pub type Labels = IdVec<FaceId, u32>;

/// True if a half-edge bounds the region at its left.
pub fn is_border(mesh: &TriMesh, labels: &Labels, h: HalfedgeId) -> bool {
    mesh.conn.twin(h).is_none_or(|t| labels[face_of(t)] != labels[face_of(h)])
}

/// Cuts out all regions.
///
/// # Errors
/// Input, with the name of the first region that is not a disc, and why.
pub fn cut_out(mesh: &TriMesh, regions: &Regions, labels: &Labels) -> Result<Vec<Disc>> {
    let one = |(faces, region): (Vec<FaceId>, &Region)| {
        disc_of(mesh, labels, faces).map_err(|why| {
            Error::input(format!("region \"{}\" is not a disc: {why}", region.name))
                .file(&regions.path)
                .remedy("divide it, or move faces to its neighbours, until it is in one piece with one border; --split-ends divides limbs")
        })
    };
    faces_by_region(labels, regions.list.len()).into_iter().zip(&regions.list).map(one).collect()
}

/// The faces of every region, in order.
pub fn faces_by_region(labels: &Labels, regions: usize) -> Vec<Vec<FaceId>> {
    let mut faces = vec![Vec::new(); regions];
    labels.iter_ids().for_each(|(f, &r)| faces[r as usize].push(f));
    faces
}

/// Cuts out the region of some faces; or why it is not a disc.
pub fn disc_of(mesh: &TriMesh, labels: &Labels, faces: Vec<FaceId>) -> std::result::Result<Disc, String> {
    let pieces = pieces_of(mesh, labels, &faces).len();
    if pieces > 1 {
        return Err(format!("it is in {pieces} pieces"));
    }
    let rims = rims_of(mesh, labels, &faces);
    let [rim] = &rims[..] else {
        return Err(match rims.len() {
            0 => "it has no border".to_owned(),
            n => format!("it has {n} borders"),
        });
    };
    let disc = number(mesh, faces, rim.clone())?;
    let corners = 3 * disc.triangles.len() + disc.rim.len();
    if 2 * (disc.vertices.len() + disc.triangles.len()) != corners + 2 {
        return Err("it has a handle".to_owned());
    }
    Ok(disc)
}

/// The border walks of a region, the region at their left, in the order of their first half-edge.
pub fn rims_of(mesh: &TriMesh, labels: &Labels, faces: &[FaceId]) -> Vec<Vec<HalfedgeId>> {
    let mut seen = std::collections::HashSet::new();
    let mut rims = Vec::new();
    for start in faces.iter().flat_map(|&f| (0..3).map(move |i| corner(f, i))) {
        let mut rim = Vec::new();
        let mut at = Some(start).filter(|&h| is_border(mesh, labels, h));
        while let Some(h) = at.filter(|&h| seen.insert(h)) {
            rim.push(h);
            at = following(mesh, labels, h);
        }
        rims.extend(Some(rim).filter(|rim| !rim.is_empty()));
    }
    rims
}

/// The half-edge after `h` along the border of the region at its left.
fn following(mesh: &TriMesh, labels: &Labels, h: HalfedgeId) -> Option<HalfedgeId> {
    let mut at = next(h);
    while !is_border(mesh, labels, at) {
        at = next(mesh.conn.twin(at)?);
    }
    Some(at)
}

/// The edge-connected pieces of faces that lie in one region, in the order of their first face.
pub fn pieces_of(mesh: &TriMesh, labels: &Labels, faces: &[FaceId]) -> Vec<Vec<FaceId>> {
    let mut seen = std::collections::HashSet::new();
    let mut pieces = Vec::new();
    for &seed in faces {
        if !seen.insert(seed) {
            continue;
        }
        let mut piece = vec![seed];
        let mut at = 0;
        while let Some(&f) = piece.get(at) {
            at += 1;
            let inner = (0..3).map(|i| corner(f, i)).filter(|&h| !is_border(mesh, labels, h));
            piece.extend(inner.filter_map(|h| mesh.conn.twin(h)).map(face_of).filter(|&g| seen.insert(g)));
        }
        pieces.push(piece);
    }
    pieces
}

/// Numbers the vertices, those of the rim first.
fn number(mesh: &TriMesh, faces: Vec<FaceId>, rim: Vec<HalfedgeId>) -> std::result::Result<Disc, String> {
    let mut local = std::collections::HashMap::with_capacity(faces.len());
    let mut vertices = Vec::with_capacity(faces.len());
    for &h in &rim {
        let v = mesh.conn.from(h);
        if local.insert(v, vertices.len() as u32).is_some() {
            return Err(format!("its border meets itself at {v}"));
        }
        vertices.push(v);
    }
    let mut number = |v: VertexId| {
        *local.entry(v).or_insert_with(|| {
            vertices.push(v);
            vertices.len() as u32 - 1
        })
    };
    let triangles = faces.iter().map(|&f| mesh.face(f).map(&mut number)).collect();
    Ok(Disc { vertices, faces, triangles, rim })
}

impl Disc {
    /// Positions of the vertices in space.
    pub fn points(&self, mesh: &TriMesh) -> Vec<DVec3> {
        self.vertices.iter().map(|&v| mesh.positions[v]).collect()
    }

    /// The rim's vertex numbers from one to another, both included, counter-clockwise; the whole rim if they are one.
    pub fn stretch_of_rim(&self, from: usize, to: usize) -> Vec<u32> {
        let n = self.rim.len();
        let steps = if to > from { to - from } else { to + n - from };
        (0..=steps).map(|i| ((from + i) % n) as u32).collect()
    }

    /// The place of a vertex of the mesh on the rim.
    pub fn on_rim(&self, v: VertexId) -> Option<usize> {
        self.vertices[..self.rim.len()].iter().position(|&w| w == v)
    }
}

/// The region of every face, from the regions of the triangles of the mesh's file, which are its faces.
pub fn labels_of(regions: &Regions) -> Labels {
    IdVec::from_raw(regions.of_triangle.clone())
}

/// The sum of the areas of faces.
pub fn area_of(mesh: &TriMesh, faces: &[FaceId]) -> f64 {
    faces.iter().map(|&f| metric::area(mesh.triangle(f))).sum()
}

/// The box around a mesh, in which points of similar meshes can be compared.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    low: DVec3,
    extent: DVec3,
}

impl Bounds {
    /// Around the vertices that faces use.
    pub fn of(mesh: &TriMesh) -> Self {
        let used = mesh.conn.vertices().filter(|&v| mesh.conn.leaving(v).is_some());
        let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (low, high) = used.map(|v| mesh.positions[v]).fold(nothing, |(l, h), p| (l.min(p), h.max(p)));
        Bounds { low, extent: (high - low).max(DVec3::splat(f64::MIN_POSITIVE)) }
    }

    /// The share of the way through the box along every axis.
    pub fn share(&self, p: DVec3) -> DVec3 {
        (p - self.low) / self.extent
    }
}
