//! The two-way look-up (DIFFUSION 2.5): an array from vertices to (region, u, v), a kd-tree from there to the surface.

use super::piece::Piece;
use crate::mesh::{IdVec, SurfacePoint, TriMesh, VertexId, metric};
use glam::{DMat2, DVec2};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use std::num::NonZero;

/// Nearest vertices whose triangles are looked at, in this order, before all of a region are.
const NEAREST: [usize; 2] = [3, 12];
/// A point may lie outside a triangle by this much, in barycentric coordinates, and still count as in it.
const TOLERANCE: f64 = 1e-9;

/// A place in a region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The region's number.
    pub region: usize,
    /// u and v.
    pub uv: DVec2,
}

/// A point of a region's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// The triangle of the region.
    pub triangle: usize,
    /// Weights of its corners, none negative, sum one.
    pub weights: [f64; 3],
}

/// Both directions.
pub struct Lookup<'a> {
    mesh: &'a TriMesh,
    pieces: &'a [Piece],
    places: IdVec<VertexId, Option<(u32, u32)>>,
    trees: Vec<Tree>,
}

/// The vertices of a region by (s, t), and the triangles around each.
struct Tree {
    tree: Option<ImmutableKdTree<f64, 2>>,
    /// For every edge of the rim its triangle, and which of the triangle's corners it leaves.
    rim: Vec<(usize, usize)>,
    start: Vec<u32>,
    triangles: Vec<u32>,
}

impl<'a> Lookup<'a> {
    /// Prepares the look-up. A vertex on borders belongs to the first region that has it.
    pub fn new(mesh: &'a TriMesh, pieces: &'a [Piece]) -> Self {
        let mut places = IdVec::filled(None, mesh.positions.len());
        for (r, piece) in (0..pieces.len() as u32).zip(pieces).rev() {
            (0u32..).zip(&piece.disc.vertices).for_each(|(i, &v)| places[v] = Some((r, i)));
        }
        Lookup { mesh, pieces, places, trees: pieces.iter().map(Tree::new).collect() }
    }

    /// The region of a vertex and its u and v there; none for a vertex that no face uses.
    pub fn place(&self, v: VertexId) -> Option<Place> {
        let (r, i) = self.places[v]?;
        Some(Place { region: r as usize, uv: self.pieces[r as usize].uv(i as usize) })
    }

    /// The point of the surface at a place; beyond the region, or where folds leave a gap, the nearest in (u, v).
    pub fn point(&self, place: Place) -> Found {
        let piece = &self.pieces[place.region];
        self.trees[place.region].find(piece, piece.turn(place.uv))
    }

    /// The same as a point of the mesh.
    pub fn surface_point(&self, place: Place) -> SurfacePoint {
        let Found { triangle, weights } = self.point(place);
        SurfacePoint::from_barycentric(self.mesh, self.pieces[place.region].disc.faces[triangle], weights)
    }

    /// The derivative of the weights of a triangle's second and third corner by u and v.
    pub fn weights_by_uv(&self, region: usize, triangle: usize) -> DMat2 {
        let piece = &self.pieces[region];
        let [a, b, c] = piece.disc.triangles[triangle].map(|v| piece.uv(v as usize));
        DMat2::from_cols(b - a, c - a).inverse()
    }
}

impl Tree {
    fn new(piece: &Piece) -> Self {
        let entries: Vec<[f64; 2]> = piece.st.iter().map(|p| p.to_array()).collect();
        let mut start = vec![0u32; entries.len() + 1];
        piece.disc.triangles.iter().flatten().for_each(|&v| start[v as usize + 1] += 1);
        (0..entries.len()).for_each(|v| start[v + 1] += start[v]);
        let mut fill = start.clone();
        let mut triangles = vec![0; 3 * piece.disc.triangles.len()];
        for (t, corners) in (0u32..).zip(&piece.disc.triangles) {
            for &v in corners {
                triangles[fill[v as usize] as usize] = t;
                fill[v as usize] += 1;
            }
        }
        Tree { tree: ImmutableKdTree::new_from_slice(&entries).ok(), rim: rim(piece), start, triangles }
    }

    fn find(&self, piece: &Piece, p: DVec2) -> Found {
        if let Some(found) = self.on_border(piece, p) {
            return found;
        }
        for count in NEAREST {
            let best = self.near(p, count).filter_map(|t| inside(piece, t, p)).next();
            if let Some(found) = best {
                return found;
            }
        }
        let all = 0..piece.disc.triangles.len();
        all.clone().find_map(|t| inside(piece, t, p)).unwrap_or_else(|| nearest(piece, all, p))
    }

    /// The point of the rim for a point of the square's sides: there the sides' shares are the map, whatever lies beside them.
    fn on_border(&self, piece: &Piece, p: DVec2) -> Option<Found> {
        let (k, share) = match p {
            _ if p.y == 0.0 => (0, p.x),
            _ if p.x == 1.0 => (1, p.y),
            _ if p.y == 1.0 => (2, 1.0 - p.x),
            _ if p.x == 0.0 => (3, 1.0 - p.y),
            _ => return None,
        };
        let side = &piece.sides[k];
        let after = side.shares.partition_point(|&s| s < share).clamp(1, side.shares.len() - 1);
        let (low, high) = (side.shares[after - 1], side.shares[after]);
        let t = if high > low { ((share - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
        let (triangle, corner) = *self.rim.get(side.vertices[after - 1] as usize)?;
        let mut weights = [0.0; 3];
        (weights[corner], weights[(corner + 1) % 3]) = (1.0 - t, t);
        Some(Found { triangle, weights })
    }

    /// The triangles around the vertices nearest to a point.
    fn near(&self, p: DVec2, count: usize) -> impl Iterator<Item = usize> {
        let count = NonZero::new(count).unwrap_or(NonZero::<usize>::MIN);
        let query = |tree: &ImmutableKdTree<f64, 2>| {
            tree.query(&p.to_array()).nearest_n::<SquaredEuclidean<f64>>(count).execute()
        };
        let vertices: Vec<usize> = self.tree.iter().flat_map(query).map(|n| n.item as usize).collect();
        vertices.into_iter().flat_map(|v| {
            self.triangles[self.start[v] as usize..self.start[v + 1] as usize].iter().map(|&t| t as usize)
        })
    }
}

/// For every edge of the rim its triangle, and which of the triangle's corners it leaves.
fn rim(piece: &Piece) -> Vec<(usize, usize)> {
    let n = piece.disc.rim.len() as u32;
    let mut rim = vec![(0, 0); n as usize];
    for (t, corners) in piece.disc.triangles.iter().enumerate() {
        for i in (0..3).filter(|&i| corners[i] < n && corners[(i + 1) % 3] == (corners[i] + 1) % n) {
            rim[corners[i] as usize] = (t, i);
        }
    }
    rim
}

/// The weights of a point in a triangle that is not turned over; none outside.
fn inside(piece: &Piece, triangle: usize, p: DVec2) -> Option<Found> {
    let corners = piece.disc.triangles[triangle].map(|v| piece.st[v as usize]);
    let weights = metric::barycentric(corners, p);
    let is_inside = metric::signed_area(corners) > 0.0 && weights.iter().all(|&w| w >= -TOLERANCE);
    is_inside.then(|| Found { triangle, weights: clamped(weights) })
}

fn clamped(weights: [f64; 3]) -> [f64; 3] {
    let inside = weights.map(|w| w.max(0.0));
    let sum: f64 = inside.iter().sum();
    inside.map(|w| w / sum)
}

/// The point of a region nearest in (s, t), on whatever triangle.
fn nearest(piece: &Piece, all: std::ops::Range<usize>, p: DVec2) -> Found {
    let closest = |t: usize| {
        let corners = piece.disc.triangles[t].map(|v| piece.st[v as usize].extend(0.0));
        metric::closest_point(p.extend(0.0), corners).truncate()
    };
    let distance = |t: usize| closest(t).distance_squared(p);
    let triangle = all.min_by(|&s, &t| distance(s).total_cmp(&distance(t))).unwrap_or(0);
    let corners = piece.disc.triangles[triangle].map(|v| piece.st[v as usize]);
    let weights = metric::barycentric(corners, closest(triangle));
    if weights.iter().all(|w| w.is_finite()) {
        return Found { triangle, weights: clamped(weights) };
    }
    let corner = (0..3).min_by(|&i, &j| corners[i].distance_squared(p).total_cmp(&corners[j].distance_squared(p)));
    let mut weights = [0.0; 3];
    weights[corner.unwrap_or(0)] = 1.0;
    Found { triangle, weights }
}
