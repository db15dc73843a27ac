//! Fronts over a piece of a surface from a set of its vertices: the distance of every vertex from the set.
//!
//! Along edges it is the length of the shortest path of edges (DIFFUSION 2.8). Across faces a vertex takes the least of
//! what comes straight through a triangle from its opposite side, on which distances are interpolated: the Hopf-Lax
//! update, which has one solution on any triangulation and is exact for fronts that are straight lines in the unfolded
//! surface (Bornemann, Rasch, "Finite-element discretization of static Hamilton-Jacobi equations based on a local
//! variational principle", 2006; the update on a triangle is that of Kimmel, Sethian, "Computing geodesic paths on
//! manifolds", 1998). Otherwise its error falls with the edge length; that of edges does not.

use super::bucket::BucketQueue;
use glam::DVec3;

/// How a front moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Travel {
    /// From vertex to vertex along edges.
    Edges,
    /// Across faces.
    Faces,
}

/// No vertex.
const NONE: u32 = u32::MAX;
/// Width of the queue's buckets by the mean edge length: wider ones correct vertices more often, narrower ones cost memory.
const BUCKET: f64 = 0.3;
/// A distance is corrected only if it falls by this share of the mean edge length: with less, fronts go on for what nobody
/// sees (a tenth of the time for 1e-9 of the distance), with more it shows.
const CORRECTION: f64 = 3e-6;

/// What a vertex v sees of a triangle v, a, b at it; or of an edge v, a, and then b is [`NONE`].
#[derive(Clone, Copy, Debug)]
struct Spoke {
    a: u32,
    b: u32,
    /// Length of v a.
    length: f64,
    /// 1 / length of v a and of v b.
    inverse: [f64; 2],
    /// (a - v) . (b - v).
    dot: f64,
    /// Twice the triangle's area.
    area: f64,
}

/// The neighbourhood of every vertex in one piece of memory.
#[derive(Clone, Debug)]
pub struct FrontGraph {
    start: Vec<u32>,
    spokes: Vec<Spoke>,
    mean_length: f64,
    longest: f64,
}

impl FrontGraph {
    /// Prepares fronts over triangles that form a manifold.
    pub fn new(points: &[DVec3], triangles: &[[u32; 3]]) -> Self {
        let mut start = vec![0u32; points.len() + 1];
        let open = open_ends(points.len(), triangles);
        triangles.iter().flatten().chain(open.iter().map(|(v, _)| v)).for_each(|&v| start[v as usize + 1] += 1);
        (0..points.len()).for_each(|v| start[v + 1] += start[v]);
        let nothing = Spoke { a: NONE, b: NONE, length: 0.0, inverse: [0.0; 2], dot: 0.0, area: 0.0 };
        let mut graph =
            FrontGraph { spokes: vec![nothing; start[points.len()] as usize], start, mean_length: 0.0, longest: 0.0 };
        let mut fill = graph.start.clone();
        let mut put = |v: u32, spoke: Spoke| {
            graph.spokes[fill[v as usize] as usize] = spoke;
            fill[v as usize] += 1;
        };
        let mut sum = 0.0;
        for t in triangles {
            let spokes = spokes_of(t, t.map(|v| points[v as usize]));
            (0..3).for_each(|i| put(t[i], spokes[i]));
            for Spoke { length, .. } in spokes {
                sum += length;
                graph.longest = graph.longest.max(length);
            }
        }
        for &(v, a) in &open {
            let length = points[v as usize].distance(points[a as usize]);
            put(v, Spoke { a, length, ..nothing });
        }
        graph.mean_length = sum / (3 * triangles.len()).max(1) as f64;
        graph
    }

    /// The distance of every vertex from `sources`; infinite where no front arrives.
    pub fn distances(&self, sources: &[u32], travel: Travel) -> Vec<f64> {
        let vertices = self.start.len() - 1;
        let mut distance = vec![f64::INFINITY; vertices];
        let mut queue = BucketQueue::new(vertices, BUCKET * self.mean_length, self.longest);
        for &v in sources {
            distance[v as usize] = 0.0;
            queue.push(v, 0.0);
        }
        match travel {
            Travel::Edges => self.run::<false>(&mut distance, &mut queue),
            Travel::Faces => self.run::<true>(&mut distance, &mut queue),
        }
        distance
    }

    fn run<const FACES: bool>(&self, distance: &mut [f64], queue: &mut BucketQueue) {
        let correction = CORRECTION * self.mean_length;
        while let Some(v) = queue.pop() {
            let here = distance[v as usize];
            for s in &self.spokes[self.start[v as usize] as usize..self.start[v as usize + 1] as usize] {
                let known_a = distance[s.a as usize];
                let mut at_a = known_a.min(here + s.length);
                if FACES && s.b != NONE {
                    let known_b = distance[s.b as usize];
                    // What comes to a corner that is not obtuse comes later than to both others.
                    if at_a > here || s.dot > s.length * s.length {
                        at_a = at_a.min(across(here, known_b, at_a, s, s.inverse[1]));
                    }
                    if known_b > here || s.dot * s.inverse[1] * s.inverse[1] > 1.0 {
                        let at_b = across(here, at_a, known_b, s, s.inverse[0]);
                        if at_b < known_b - correction {
                            distance[s.b as usize] = at_b;
                            queue.push(s.b, at_b);
                        }
                    }
                }
                if at_a < known_a - correction {
                    distance[s.a as usize] = at_a;
                    queue.push(s.a, at_a);
                }
            }
        }
    }
}

/// The distance at the third corner of a triangle of what comes straight from the inside of the side from v to w, where the
/// distances are `at_v` and `at_w`; `known` if that is not less. `inverse` is 1 / length of that side.
#[inline]
fn across(at_v: f64, at_w: f64, known: f64, s: &Spoke, inverse: f64) -> f64 {
    if known <= at_v.min(at_w) + s.area * inverse {
        return known; // nearer than the side's line
    }
    let slope = (at_w - at_v) * inverse;
    // Not a number where the front is steeper than it can be, or one end is infinitely far: then the tests fail.
    let cosine = (1.0 - slope * slope).sqrt();
    let foot = s.dot * cosine - s.area * slope;
    if foot > 0.0 && foot * inverse * inverse < cosine {
        at_v + (s.dot * slope + s.area * cosine) * inverse
    } else {
        known
    }
}

/// What the three corners of a triangle see of it.
fn spokes_of(t: &[u32; 3], p: [DVec3; 3]) -> [Spoke; 3] {
    let sides = [p[1] - p[0], p[2] - p[1], p[0] - p[2]];
    let lengths = sides.map(|s| s.length());
    let inverses = lengths.map(|l| if l > 0.0 { 1.0 / l } else { 0.0 });
    let area = sides[0].cross(sides[1]).length();
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        Spoke {
            a: t[j],
            b: t[k],
            length: lengths[i],
            inverse: [inverses[i], inverses[k]],
            dot: -sides[i].dot(sides[k]),
            area,
        }
    })
}

/// The edges v a on the boundary that have their triangle at the right of v: no triangle shows a as its second corner.
fn open_ends(vertices: usize, triangles: &[[u32; 3]]) -> Vec<(u32, u32)> {
    let ways = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut start = vec![0u32; vertices + 1];
    ways.clone().for_each(|[v, _]| start[v as usize + 1] += 1);
    (0..vertices).for_each(|v| start[v + 1] += start[v]);
    let mut fill = start.clone();
    let mut tips = vec![0u32; 3 * triangles.len()];
    for [v, w] in ways.clone() {
        tips[fill[v as usize] as usize] = w;
        fill[v as usize] += 1;
    }
    let leads = |v: u32, w: u32| tips[start[v as usize] as usize..start[v as usize + 1] as usize].contains(&w);
    ways.filter(|&[v, w]| !leads(w, v)).map(|[v, w]| (w, v)).collect()
}
