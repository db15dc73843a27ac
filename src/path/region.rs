//! The regions that the arcs leave on a mesh, and the base complex once all of them are triangles.

use super::base_complex::{BaseComplex, DirectedArc};
use super::cut_mesh::CutMesh;
use crate::error::{Error, Result};
use crate::mesh::{ArcId, FaceId, HalfedgeId, IdVec, LandmarkId, PatchId, VertexId, corner, face_of, next};

/// The regions between arcs.
#[derive(Clone, Debug)]
pub struct Regions {
    /// The region of every face, numbered by first face.
    pub of_face: IdVec<FaceId, u32>,
    /// For every region: its boundary walks, directed arcs in order with the region at their left.
    pub walks: Vec<Vec<Vec<DirectedArc>>>,
    /// For every region: landmarks inside that no arc meets.
    pub isolated: Vec<Vec<LandmarkId>>,
    /// For every region: its genus.
    pub genus: Vec<i64>,
}

impl Regions {
    /// Finds the regions between the arcs.
    pub fn find(cut: &CutMesh) -> Self {
        let (of_face, count) = flood(cut);
        let walks = find_walks(cut, &of_face, count);
        let mut isolated = vec![Vec::new(); count];
        for (l, &v) in cut.landmarks.iter_ids() {
            if let Some(h) = cut.conn.leaving(v).filter(|_| !on_arc(cut, v)) {
                isolated[of_face[face_of(h)] as usize].push(l);
            }
        }
        let genus = find_genus(cut, &of_face, &walks);
        Regions { of_face, walks, isolated, genus }
    }
}

/// Reads the base complex off a mesh whose regions are all triangles.
pub fn base_complex(cut: &CutMesh, arcs: &IdVec<ArcId, [LandmarkId; 2]>) -> Result<BaseComplex> {
    let regions = Regions::find(cut);
    let mut patches: Vec<[DirectedArc; 3]> = Vec::new();
    for (walks, genus) in regions.walks.iter().zip(&regions.genus) {
        let sides = match walks.as_slice() {
            [walk] if *genus == 0 => <[DirectedArc; 3]>::try_from(walk.as_slice()).ok(),
            _ => None,
        };
        let mut sides = sides.ok_or_else(|| Error::bug("a region of the layout is not a triangular disc"))?;
        let first = (0..3).min_by_key(|&k| sides[k]).unwrap_or(0);
        sides.rotate_left(first);
        patches.push(sides);
    }
    patches.sort();
    let patches: IdVec<PatchId, _> = IdVec::from_raw(patches);
    Ok(BaseComplex { landmarks: cut.landmarks.len(), arcs: arcs.clone(), patches })
}

/// True if an arc meets the vertex.
pub(super) fn on_arc(cut: &CutMesh, v: VertexId) -> bool {
    cut.is_blocked(v) && cut.conn.outgoing(v).any(|h| cut.arc_at(h).is_some())
}

fn flood(cut: &CutMesh) -> (IdVec<FaceId, u32>, usize) {
    let mut of_face = IdVec::filled(u32::MAX, cut.conn.face_count());
    let mut count = 0;
    let mut stack = Vec::new();
    for f in cut.conn.faces() {
        if of_face[f] != u32::MAX {
            continue;
        }
        of_face[f] = count;
        stack.push(f);
        while let Some(g) = stack.pop() {
            for h in (0..3).map(|i| corner(g, i)).filter(|&h| cut.arc_at(h).is_none()) {
                if let Some(k) = cut.conn.twin(h).map(face_of).filter(|&k| of_face[k] == u32::MAX) {
                    of_face[k] = count;
                    stack.push(k);
                }
            }
        }
        count += 1;
    }
    (of_face, count as usize)
}

/// Follows the boundary of the region left of `h` to the next half-edge that carries an arc.
fn along_boundary(cut: &CutMesh, h: HalfedgeId) -> Option<HalfedgeId> {
    let mut n = next(h);
    while cut.arc_at(n).is_none() {
        n = next(cut.conn.twin(n)?);
    }
    Some(n)
}

/// The boundary walk that starts with half-edge `start`, which carries an arc: its half-edges in order.
fn boundary_from(cut: &CutMesh, start: HalfedgeId) -> impl Iterator<Item = HalfedgeId> + '_ {
    let follow = move |&h: &HalfedgeId| along_boundary(cut, h).filter(|&n| n != start);
    std::iter::successors(Some(start), follow)
}

/// The arc that starts with a half-edge, if one does.
fn arc_leaving(cut: &CutMesh, h: HalfedgeId) -> Option<DirectedArc> {
    cut.arc_at(h).filter(|_| cut.landmark_at[cut.conn.from(h)].is_some())
}

/// The arcs of the boundary walk with half-edge `h`, in order with the region at their left.
pub fn walk_along(cut: &CutMesh, h: HalfedgeId) -> Vec<DirectedArc> {
    boundary_from(cut, h).filter_map(|h| arc_leaving(cut, h)).collect()
}

fn find_walks(cut: &CutMesh, of_face: &IdVec<FaceId, u32>, regions: usize) -> Vec<Vec<Vec<DirectedArc>>> {
    let mut walks = vec![Vec::new(); regions];
    let mut seen = IdVec::<HalfedgeId, bool>::filled(false, 3 * cut.conn.face_count());
    for start in cut.conn.halfedges() {
        if seen[start] || cut.arc_at(start).is_none() {
            continue;
        }
        let mut walk: Vec<DirectedArc> = Vec::new();
        for h in boundary_from(cut, start) {
            seen[h] = true;
            walk.extend(arc_leaving(cut, h));
        }
        walks[of_face[face_of(start)] as usize].push(walk);
    }
    walks
}

/// Genus of every region from its Euler characteristic: V - E + F over the open region is 2 - 2 genus - walks.
fn find_genus(cut: &CutMesh, of_face: &IdVec<FaceId, u32>, walks: &[Vec<Vec<DirectedArc>>]) -> Vec<i64> {
    let mut euler = vec![0i64; walks.len()];
    for f in cut.conn.faces() {
        euler[of_face[f] as usize] += 1;
    }
    for h in cut.conn.halfedges().filter(|&h| cut.conn.is_edge_representative(h) && cut.arc_at(h).is_none()) {
        euler[of_face[face_of(h)] as usize] -= 1;
    }
    for v in cut.conn.vertices() {
        if let Some(h) = cut.conn.leaving(v).filter(|_| !on_arc(cut, v)) {
            euler[of_face[face_of(h)] as usize] += 1;
        }
    }
    euler.iter().zip(walks).map(|(&e, w)| (2 - w.len() as i64 - e) / 2).collect()
}
