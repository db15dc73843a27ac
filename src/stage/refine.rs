//! Stage: active refinement of the compatible meshes (HYPOTHESIS 4).
//!
//! Input: a mesh and the map from it to another one, and back. Output: the mesh with vertices inserted where the compatible
//! mesh misses the other surface: the counterparts of vertices of the other mesh, and middles of edges whose image bends.
//! First come those whose error is an outlier among all errors (a box plot tells): features that the mesh lacks. Then the
//! counterparts of the salient vertices that make up the profile. Invariant: the surface stays as it is, original
//! vertices keep their numbers.

use super::compose::Composed;
use crate::map::lift::Lift;
use crate::mesh::salience::salient_vertices;
use crate::mesh::subdivision::{Image, Subdivision};
use crate::mesh::{IdVec, SurfacePoint, TriMesh, VertexId, face_of, metric};
use glam::DVec3;
use rayon::prelude::*;
use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashMap};

/// When vertices are inserted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefineOptions {
    /// An error is an outlier if it is above the third quartile by more than this many times the distance of the
    /// quartiles; the box plot's usual 1.5 (HYPOTHESIS 4.1).
    pub whisker: f64,
    /// A vertex is stood for by a salient one if it lies this near to its sphere, as a share of the bounding box's diagonal
    /// (HYPOTHESIS 4.2: 1e-4); salient vertices that the compatible mesh misses by no more are left alone.
    pub salience: f64,
    /// At most so many vertices are inserted, as a share of those there are.
    pub most: f64,
}

impl Default for RefineOptions {
    fn default() -> Self {
        RefineOptions { whisker: 1.5, salience: 1e-4, most: 0.05 }
    }
}

/// A mesh with vertices inserted.
#[derive(Clone, Debug)]
pub struct Refinement<'m> {
    /// The finer mesh over the old one.
    pub subdivision: Subdivision<'m>,
    /// Where every vertex lies on the other mesh.
    pub images: IdVec<VertexId, Option<SurfacePoint>>,
    /// Vertices inserted for features, and for the profile.
    pub inserted: [usize; 2],
}

/// A vertex of the other mesh with a smaller weight of a triangle's corner gets its counterpart on the edge across from it,
/// and none if there are two: it would make slivers.
const NEAR_EDGE: f64 = 0.1;

/// Errors above this share of the diagonal are mended even if triangles turn over for it: there a limb is missing.
const GLARING: f64 = 0.005;

/// What may be inserted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Wish {
    /// The counterpart of a vertex of the other mesh, in a triangle.
    Counterpart(VertexId, u32),
    /// The middle of an edge; the lower vertex first.
    Middle([u32; 2]),
}

/// A wish in the queue; the one with the largest error comes first.
#[derive(PartialEq)]
struct Open {
    error: f64,
    wish: Wish,
}

impl Eq for Open {}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        self.error.total_cmp(&other.error).then(other.wish.cmp(&self.wish))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The middle of an edge: where it lies, and where it should on the other mesh.
#[derive(Clone, Copy)]
struct Middle {
    point: SurfacePoint,
    image: SurfacePoint,
    error: f64,
}

/// Refines mesh `from` of a finished map, 0 or 1.
pub fn refine<'m>(
    meshes: [&'m TriMesh; 2],
    composed: &Composed,
    from: usize,
    options: &RefineOptions,
) -> Refinement<'m> {
    let [mesh, other] = [meshes[from], meshes[1 - from]];
    let [images, back] = [&composed.maps[from].images, &composed.maps[1 - from].images];
    let anywhere = images.iter().flatten().next().map_or(DVec3::ZERO, |p| p.position(other));
    let mut refiner = Refiner {
        other,
        back,
        lift: Lift::new(meshes, &composed.embedding, from),
        subdivision: Subdivision::new(mesh),
        image: images.iter().map(|p| p.map_or(anywhere, |p| p.position(other))).collect(),
        normal: Vec::new(),
        images: images.raw.clone(),
        holds: Vec::new(),
        middles: HashMap::new(),
    };
    refiner.normal = images.iter().map(|p| p.map_or(DVec3::ZERO, |p| refiner.normal_at(p))).collect();
    refiner.look_at_middles();
    let most = (options.most * mesh.positions.len() as f64) as usize;
    let everything: Vec<VertexId> = other.conn.vertices().collect();
    refiner.hold(&everything);
    let threshold = outlier(refiner.wishes().iter().map(|open| open.error).collect(), options.whisker);
    let features = refiner.insert_while_above(threshold, most);
    let tolerance = options.salience * other.diagonal();
    refiner.hold(&salient_vertices(other, tolerance));
    refiner.middles.clear();
    let profile = refiner.insert_while_above(tolerance, most - features);
    let Refiner { subdivision, images, .. } = refiner;
    Refinement { subdivision, images: IdVec::from_raw(images), inserted: [features, profile] }
}

struct Refiner<'a, 'm> {
    other: &'m TriMesh,
    back: &'a IdVec<VertexId, Option<SurfacePoint>>,
    lift: Lift<'a>,
    subdivision: Subdivision<'m>,
    /// Where every vertex of the finer mesh lies on the other one.
    image: Vec<DVec3>,
    /// The normals there.
    normal: Vec<DVec3>,
    images: Vec<Option<SurfacePoint>>,
    /// For every triangle the vertices of the other mesh that are to be met and lie in its image.
    holds: Vec<Vec<VertexId>>,
    /// The middles that may be inserted, by edge.
    middles: HashMap<[u32; 2], Middle>,
}

impl Refiner<'_, '_> {
    /// Lets the triangles hold these vertices of the other mesh and no others.
    fn hold(&mut self, vertices: &[VertexId]) {
        self.holds = vec![Vec::new(); self.subdivision.triangles.len()];
        for &v in vertices {
            self.seat(v);
        }
    }

    /// Finds the triangle of a vertex of the other mesh.
    fn seat(&mut self, v: VertexId) -> Option<u32> {
        let point = self.back[v].filter(|p| !matches!(p, SurfacePoint::Vertex(_)))?;
        let (t, _) = self.subdivision.locate(point)?;
        self.holds[t as usize].push(v);
        Some(t)
    }

    /// The normal of the other mesh at a point, that of the faces around it together.
    fn normal_at(&self, point: SurfacePoint) -> DVec3 {
        let area_vector = |f| {
            let [a, b, c] = self.other.triangle(f);
            (b - a).cross(c - a)
        };
        let sum: DVec3 = match point {
            SurfacePoint::Vertex(v) => self.other.conn.outgoing(v).map(|h| area_vector(face_of(h))).sum(),
            _ => point.on_face(self.other).map_or(DVec3::ZERO, |(f, _)| area_vector(f)),
        };
        sum.normalize_or_zero()
    }

    /// Looks where the middles of all edges should lie.
    fn look_at_middles(&mut self) {
        let triangles: Vec<u32> = (0..self.subdivision.triangles.len() as u32).collect();
        let found: Vec<Vec<([u32; 2], Middle)>> = triangles.par_iter().map(|&t| self.middles_of(t)).collect();
        self.middles = found.into_iter().flatten().collect();
    }

    /// The middles of a triangle's edges that have not been looked at.
    fn middles_of(&self, t: u32) -> Vec<([u32; 2], Middle)> {
        let corners = self.subdivision.triangles[t as usize];
        let one = |i: usize| {
            let [a, b] = [corners[i], corners[(i + 1) % 3]];
            let edge = [a.min(b), a.max(b)];
            if self.middles.contains_key(&edge) {
                return None;
            }
            let mut weights = [0.5; 3];
            weights[(i + 2) % 3] = 0.0;
            let point = self.subdivision.point_in(t, weights)?;
            let image = self.lift.image(point)?;
            let [p, q] = edge.map(|v| self.image[v as usize]);
            let error = metric::distance_sq(image.position(self.other), [p, q, q]).sqrt();
            Some((edge, Middle { point, image, error }))
        };
        (0..3).filter_map(one).collect()
    }

    /// How far a vertex of the other mesh is from the image of a triangle.
    fn error(&self, v: VertexId, t: u32) -> f64 {
        let corners = self.subdivision.triangles[t as usize].map(|w| self.image[w as usize]);
        metric::distance_sq(self.other.positions[v], corners).sqrt()
    }

    /// The wishes of a triangle.
    fn wishes_of(&self, t: u32) -> impl Iterator<Item = Open> {
        let corners = self.subdivision.triangles[t as usize];
        let counterpart = move |&v: &VertexId| Open { error: self.error(v, t), wish: Wish::Counterpart(v, t) };
        let middle = move |i: usize| {
            let [a, b] = [corners[i], corners[(i + 1) % 3]];
            let edge = [a.min(b), a.max(b)];
            self.middles.get(&edge).map(|m| Open { error: m.error, wish: Wish::Middle(edge) })
        };
        self.holds[t as usize].iter().map(counterpart).chain((0..3).filter_map(middle))
    }

    fn wishes(&self) -> Vec<Open> {
        (0..self.holds.len() as u32).flat_map(|t| self.wishes_of(t)).collect()
    }

    /// Inserts what is wished for, the worst first, while an error is above the threshold; at most so many. Returns how
    /// many.
    fn insert_while_above(&mut self, threshold: f64, most: usize) -> usize {
        let mut queue = BinaryHeap::from(self.wishes());
        let glaring = GLARING * self.other.diagonal();
        let mut count = 0;
        while let Some(Open { error, wish }) = queue.pop() {
            if count == most || error <= threshold {
                break;
            }
            let careful = error < glaring;
            let changed = match wish {
                Wish::Counterpart(v, t) if self.holds[t as usize].contains(&v) && self.error(v, t) == error => {
                    self.insert_counterpart(v, t, careful)
                }
                Wish::Middle(edge) if self.subdivision.is_edge(edge) => self.insert_middle(edge, careful),
                // What has changed since has an entry of its own.
                _ => continue,
            };
            count += usize::from(!changed.is_empty());
            for t in changed {
                queue.extend(self.wishes_of(t));
            }
        }
        count
    }

    /// Inserts the counterpart of a vertex; returns the triangles that changed, none if there is no room for it.
    fn insert_counterpart(&mut self, v: VertexId, t: u32, careful: bool) -> Vec<u32> {
        self.holds[t as usize].retain(|&w| w != v);
        let Some((t, weights)) = self.back[v].and_then(|point| self.subdivision.locate(point)) else {
            return Vec::new();
        };
        if weights.iter().filter(|w| **w < NEAR_EDGE).count() > 1 {
            return Vec::new();
        }
        let point = self.subdivision.point_in(t, weights.map(|w| if w < NEAR_EDGE { 0.0 } else { w }));
        point.map_or(Vec::new(), |point| self.insert(point, SurfacePoint::Vertex(v), careful))
    }

    fn insert_middle(&mut self, edge: [u32; 2], careful: bool) -> Vec<u32> {
        match self.middles.remove(&edge) {
            Some(Middle { point, image, .. }) => self.insert(point, image, careful),
            None => Vec::new(),
        }
    }

    /// Inserts a vertex; returns the triangles that changed or hold other vertices since.
    fn insert(&mut self, point: SurfacePoint, image: SurfacePoint, careful: bool) -> Vec<u32> {
        let new = Image { point: image.position(self.other), normal: self.normal_at(image) };
        let (known, normals) = (&self.image, &self.normal);
        let images = |w: u32| match known.get(w as usize) {
            Some(&point) => Image { point, normal: normals[w as usize] },
            None => new,
        };
        let mut changed = self.subdivision.insert(point, &images, careful);
        if changed.is_empty() {
            return changed;
        }
        self.image.push(new.point);
        self.normal.push(new.normal);
        self.images.push(Some(image));
        self.holds.resize(self.subdivision.triangles.len(), Vec::new());
        let homeless: Vec<VertexId> =
            changed.iter().flat_map(|&t| std::mem::take(&mut self.holds[t as usize])).collect();
        for w in homeless {
            changed.extend(self.seat(w));
        }
        changed.sort_unstable();
        changed.dedup();
        if !self.middles.is_empty() {
            let found: Vec<([u32; 2], Middle)> = changed.iter().flat_map(|&t| self.middles_of(t)).collect();
            self.middles.extend(found);
        }
        changed
    }
}

/// The third quartile and `whisker` times the distance of the quartiles more.
fn outlier(mut values: Vec<f64>, whisker: f64) -> f64 {
    if values.is_empty() {
        return f64::INFINITY;
    }
    values.sort_by(f64::total_cmp);
    let [first, third] = [1, 3].map(|k| values[(k * (values.len() - 1)) / 4]);
    third + whisker * (third - first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outliers_are_told_by_the_quartiles() {
        let mut values: Vec<f64> = (0..=100).map(f64::from).collect();
        assert_eq!(outlier(values.clone(), 1.5), 150.0);
        values.extend([1e6; 3]);
        assert!(outlier(values, 1.5) < 160.0);
        assert_eq!(outlier(Vec::new(), 1.5), f64::INFINITY);
    }
}
