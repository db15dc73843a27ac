//! Clusters (surface Voronoi cells of the landmarks) and the cuts along which they touch (VORONOI 5.1).

use super::front::{Front, front};
use crate::mesh::{Connectivity, FaceId, HalfedgeId, Id, IdVec, LandmarkId, TriMesh, VertexId, face_of, next};

/// A contiguous run of edges along which the same two clusters touch.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut {
    /// The two clusters, the lower first.
    pub clusters: [LandmarkId; 2],
    /// Half-edges in order, with the first cluster at their left.
    pub halfedges: Vec<HalfedgeId>,
    /// True if the run closes on itself, as around a limb.
    pub closed: bool,
}

/// The clusters of a mesh and their cuts.
#[derive(Clone, Debug, PartialEq)]
pub struct Clusters {
    /// The cluster of every face; None on components without a landmark.
    pub of_face: IdVec<FaceId, Option<LandmarkId>>,
    /// Distance of every face from its landmark along the face graph.
    pub distance: IdVec<FaceId, f64>,
    /// All cuts, in the order of their first half-edge.
    pub cuts: Vec<Cut>,
}

impl Clusters {
    /// Clusters the faces around the landmarks at `sites`.
    pub fn grow(mesh: &TriMesh, sites: &[VertexId]) -> Self {
        let Front { source: of_face, distance } = front(mesh, sites);
        let cuts = find_cuts(&mesh.conn, &of_face);
        Clusters { of_face, distance, cuts }
    }

    /// How many cuts two clusters share.
    pub fn linkage(&self, a: LandmarkId, b: LandmarkId) -> usize {
        self.cuts.iter().filter(|c| c.clusters == [a.min(b), a.max(b)]).count()
    }
}

/// The clusters left and right of a half-edge, if it separates two.
fn sides(conn: &Connectivity, of_face: &IdVec<FaceId, Option<LandmarkId>>, h: HalfedgeId) -> Option<[LandmarkId; 2]> {
    let left = of_face[face_of(h)]?;
    let right = of_face[face_of(conn.twin(h)?)]?;
    (left != right).then_some([left, right])
}

/// The next half-edge of the boundary walk that keeps the cluster of `h` at its left; None at the mesh boundary.
fn walk(conn: &Connectivity, of_face: &IdVec<FaceId, Option<LandmarkId>>, h: HalfedgeId) -> Option<HalfedgeId> {
    let mut n = next(h);
    while sides(conn, of_face, n).is_none() {
        n = next(conn.twin(n)?);
    }
    Some(n)
}

/// For every boundary walk of a cluster the clusters at its right, in order, none twice in a row. A walk starts anywhere;
/// it ends where it comes round or meets the boundary of the mesh.
pub(super) fn boundary_walks(
    conn: &Connectivity,
    of_face: &IdVec<FaceId, Option<LandmarkId>>,
) -> Vec<(LandmarkId, Vec<LandmarkId>)> {
    let mut seen = vec![false; 3 * conn.face_count()];
    let mut walks = Vec::new();
    for start in conn.halfedges() {
        let Some([cluster, _]) = sides(conn, of_face, start).filter(|_| !seen[start.index()]) else { continue };
        let mut around: Vec<LandmarkId> = Vec::new();
        let mut at = Some(start);
        while let Some(h) = at.filter(|h| !std::mem::replace(&mut seen[h.index()], true)) {
            around.extend(sides(conn, of_face, h).map(|[_, right]| right).filter(|l| around.last() != Some(l)));
            at = walk(conn, of_face, h);
        }
        if around.len() > 1 && around.first() == around.last() {
            around.pop();
        }
        walks.push((cluster, around));
    }
    walks
}

fn find_cuts(conn: &Connectivity, of_face: &IdVec<FaceId, Option<LandmarkId>>) -> Vec<Cut> {
    let follower = |h: HalfedgeId| {
        let n = walk(conn, of_face, h)?;
        let same_pair = sides(conn, of_face, n) == sides(conn, of_face, h);
        let seen_from_right = walk(conn, of_face, conn.twin(n)?)? == conn.twin(h)?;
        (same_pair && seen_from_right).then_some(n)
    };
    let starts: Vec<HalfedgeId> =
        conn.halfedges().filter(|&h| sides(conn, of_face, h).is_some_and(|[left, right]| left < right)).collect();
    let mut has_leader = vec![false; 3 * conn.face_count()];
    for &h in &starts {
        if let Some(n) = follower(h) {
            has_leader[n.index()] = true;
        }
    }
    let mut done = vec![false; has_leader.len()];
    let mut cuts = Vec::new();
    for open_runs in [true, false] {
        for &start in &starts {
            if done[start.index()] || (open_runs && has_leader[start.index()]) {
                continue;
            }
            cuts.push(run_from(start, &follower, &mut done, conn, of_face));
        }
    }
    cuts.sort_by_key(|cut| cut.halfedges[0]);
    cuts
}

/// Follows one run to its end; a run that comes back to its start is closed.
fn run_from(
    start: HalfedgeId,
    follower: &impl Fn(HalfedgeId) -> Option<HalfedgeId>,
    done: &mut [bool],
    conn: &Connectivity,
    of_face: &IdVec<FaceId, Option<LandmarkId>>,
) -> Cut {
    let mut halfedges = vec![start];
    done[start.index()] = true;
    let mut h = start;
    let closed = loop {
        match follower(h) {
            None => break false,
            Some(n) if n == start => break true,
            Some(n) => h = n,
        }
        done[h.index()] = true;
        halfedges.push(h);
    };
    let clusters = sides(conn, of_face, start).expect("runs start at half-edges between two clusters");
    Cut { clusters, halfedges, closed }
}
