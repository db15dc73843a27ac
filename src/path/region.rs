//! The regions that a set of arcs leaves on a mesh, and the structure two meshes must share.
//!
//! The cyclic order of arcs around every landmark is kept by construction (an arc is only ever traced into its own
//! sector), so the boundary walks agree; what remains to compare is which walks and which arc-free landmarks lie in the
//! same region, and the genus of each region.

use super::base_complex::DirectedArc;
use super::cut_mesh::CutMesh;
use crate::mesh::{ArcId, FaceId, HalfedgeId, IdVec, LandmarkId, corner, face_of, next};

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

/// What two meshes with the same arcs must agree on: for every walk and every isolated landmark the smallest one in
/// its region, and the genus of that region.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RegionStructure {
    walk_mates: Vec<(DirectedArc, Member, i64)>,
    landmark_mates: Vec<(LandmarkId, Member, i64)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Member {
    Walk(DirectedArc),
    Isolated(LandmarkId),
}

impl Regions {
    /// Finds the regions between the arcs that are `active`; the others count as absent.
    pub fn find(cut: &CutMesh, active: &dyn Fn(ArcId) -> bool) -> Self {
        let barrier = |h: HalfedgeId| cut.arc_at(h).is_some_and(|d| active(d.arc));
        let (of_face, count) = flood(cut, &barrier);
        let walks = find_walks(cut, &of_face, count, active);
        let mut isolated = vec![Vec::new(); count];
        for (l, &v) in cut.landmarks.iter_ids() {
            if let Some(h) = cut.conn.leaving(v).filter(|_| !cut.conn.outgoing(v).any(barrier)) {
                isolated[of_face[face_of(h)] as usize].push(l);
            }
        }
        let genus = find_genus(cut, &of_face, &walks, &barrier);
        Regions { of_face, walks, isolated, genus }
    }

    /// True if some region is a disc with fewer than three sides and nothing inside: no triangle can fill it.
    pub fn has_empty_cell(&self) -> bool {
        let empty = |r: usize| {
            self.genus[r] == 0 && self.isolated[r].is_empty() && matches!(self.walks[r].as_slice(), [w] if w.len() < 3)
        };
        // A single open arc on a sphere also has a walk of two sides, but the walk runs along both sides of one arc.
        let encloses = |r: usize| self.walks[r].iter().flatten().any(|d| !self.walks[r][0].contains(&d.flipped()));
        (0..self.walks.len()).any(|r| empty(r) && encloses(r))
    }

    /// The canonical form to compare two meshes by.
    pub fn structure(&self) -> RegionStructure {
        let mut walk_mates = Vec::new();
        let mut landmark_mates = Vec::new();
        for (r, walks) in self.walks.iter().enumerate() {
            let walk_names = walks.iter().flat_map(|w| w.iter().min()).copied();
            let members = walk_names.map(Member::Walk).chain(self.isolated[r].iter().map(|&l| Member::Isolated(l)));
            if let Some(first) = members.min() {
                walk_mates.extend(walks.iter().flatten().map(|&d| (d, first, self.genus[r])));
                landmark_mates.extend(self.isolated[r].iter().map(|&l| (l, first, self.genus[r])));
            }
        }
        walk_mates.sort();
        landmark_mates.sort();
        RegionStructure { walk_mates, landmark_mates }
    }
}

fn flood(cut: &CutMesh, barrier: &impl Fn(HalfedgeId) -> bool) -> (IdVec<FaceId, u32>, usize) {
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
            for h in (0..3).map(|i| corner(g, i)).filter(|&h| !barrier(h)) {
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

/// Follows the boundary of the region left of `h` to the next half-edge that carries an active arc.
fn along_boundary(cut: &CutMesh, h: HalfedgeId, active: &dyn Fn(ArcId) -> bool) -> Option<HalfedgeId> {
    let mut n = next(h);
    while cut.arc_at(n).is_none_or(|d| !active(d.arc)) {
        n = next(cut.conn.twin(n)?);
    }
    Some(n)
}

fn find_walks(
    cut: &CutMesh,
    of_face: &IdVec<FaceId, u32>,
    regions: usize,
    active: &dyn Fn(ArcId) -> bool,
) -> Vec<Vec<Vec<DirectedArc>>> {
    let mut walks = vec![Vec::new(); regions];
    let mut seen = IdVec::<HalfedgeId, bool>::filled(false, 3 * cut.conn.face_count());
    for start in cut.conn.halfedges() {
        if seen[start] || cut.arc_at(start).is_none_or(|d| !active(d.arc)) {
            continue;
        }
        let mut walk: Vec<DirectedArc> = Vec::new();
        let mut h = start;
        while !seen[h] {
            seen[h] = true;
            if let (Some(arc), true) = (cut.arc_at(h), cut.landmark_at[cut.conn.from(h)].is_some()) {
                walk.push(arc);
            }
            let Some(n) = along_boundary(cut, h, active) else { break };
            h = n;
        }
        walks[of_face[face_of(start)] as usize].push(walk);
    }
    walks
}

/// Genus of every region from its Euler characteristic: V - E + F over the open region is 2 - 2 genus - walks.
fn find_genus(
    cut: &CutMesh,
    of_face: &IdVec<FaceId, u32>,
    walks: &[Vec<Vec<DirectedArc>>],
    barrier: &impl Fn(HalfedgeId) -> bool,
) -> Vec<i64> {
    let mut euler = vec![0i64; walks.len()];
    for f in cut.conn.faces() {
        euler[of_face[f] as usize] += 1;
    }
    for h in cut.conn.halfedges().filter(|&h| cut.conn.is_edge_representative(h) && !barrier(h)) {
        euler[of_face[face_of(h)] as usize] -= 1;
    }
    for v in cut.conn.vertices() {
        if let Some(h) = cut.conn.leaving(v).filter(|_| !cut.conn.outgoing(v).any(barrier)) {
            euler[of_face[face_of(h)] as usize] += 1;
        }
    }
    euler.iter().zip(walks).map(|(&e, w)| (2 - w.len() as i64 - e) / 2).collect()
}
