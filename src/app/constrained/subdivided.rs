//! Triangles divided at added vertices, and how these are taken out again.
//!
//! A Steiner vertex is taken out by pulling it onto a vertex beside it: one on its own edge, if it lies on an edge of the
//! given mesh. Every triangle stays a part of its given triangle, so when all are gone the given triangles are back.

use crate::plane::orientation::orientation;
use glam::DVec2;

/// Where an added vertex lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steiner {
    /// A given triangle that contains it.
    pub triangle: u32,
    /// Its barycentric coordinates there; zero exactly if it lies on an edge.
    pub weights: [f64; 3],
}

/// A way to take a Steiner vertex out.
#[derive(Clone, Debug)]
pub struct Pull {
    /// The Steiner vertex.
    pub from: u32,
    /// The vertex it is pulled onto.
    pub onto: u32,
    /// Triangles at it that stay, with the other in its place.
    pub staying: Vec<u32>,
    /// Triangles at both, which vanish.
    pub dying: Vec<u32>,
}

/// A divided mesh.
#[derive(Clone, Debug)]
pub struct Subdivided<'a> {
    /// The given triangles.
    faces: &'a [[u32; 3]],
    /// Number of given vertices; the added ones follow.
    given: usize,
    /// The triangles; those that vanished keep their corners.
    pub triangles: Vec<[u32; 3]>,
    /// For every triangle the given one that it is part of.
    pub part_of: Vec<u32>,
    /// The added vertices.
    pub steiner: Vec<Steiner>,
    /// The triangles around every vertex; none around one that was taken out.
    fans: Vec<Vec<u32>>,
}

impl<'a> Subdivided<'a> {
    /// From the given triangles over `given` vertices, and the triangles they are divided into.
    pub fn new(
        faces: &'a [[u32; 3]],
        given: usize,
        triangles: Vec<[u32; 3]>,
        part_of: Vec<u32>,
        steiner: Vec<Steiner>,
    ) -> Self {
        let mut fans = vec![Vec::new(); given + steiner.len()];
        for (t, corners) in (0u32..).zip(&triangles) {
            corners.iter().for_each(|&v| fans[v as usize].push(t));
        }
        Subdivided { faces, given, triangles, part_of, steiner, fans }
    }

    /// The triangles around a vertex.
    pub fn fan(&self, v: u32) -> &[u32] {
        &self.fans[v as usize]
    }

    /// The two corners of a triangle behind corner `v`, counter-clockwise.
    pub fn opposite(&self, t: u32, v: u32) -> Option<[u32; 2]> {
        let corners = self.triangles[t as usize];
        let i = corners.iter().position(|&c| c == v)?;
        Some([1, 2].map(|k| corners[(i + k) % 3]))
    }

    /// The ways to take a Steiner vertex out that leave every triangle a part of its given one.
    pub fn pulls(&self, s: u32) -> impl Iterator<Item = Pull> + '_ {
        let around = &self.fans[s as usize];
        let mut ring: Vec<u32> = around.iter().filter_map(|&t| self.opposite(t, s)).flatten().collect();
        ring.sort_unstable();
        ring.dedup();
        let pull = move |&onto: &u32| {
            let (dying, staying): (Vec<u32>, Vec<u32>) =
                around.iter().partition(|t| self.triangles[**t as usize].contains(&onto));
            let touches = |v: u32| self.fans[v as usize].iter().any(|t| self.triangles[*t as usize].contains(&onto));
            let all = around.iter().filter_map(|&t| self.opposite(t, s)).flatten();
            let mut common: Vec<u32> = all.filter(|&v| v != onto && touches(v)).collect();
            common.sort_unstable();
            common.dedup();
            let holds = common.len() == dying.len() && staying.iter().all(|&t| self.is_part(t, s, onto));
            holds.then_some(Pull { from: s, onto, staying, dying })
        };
        let ring: Vec<u32> = ring.into_iter().filter(|&u| self.shares_edge(s, u)).collect();
        ring.into_iter().filter_map(move |u| pull(&u))
    }

    /// Takes a vertex out.
    pub fn pull(&mut self, pull: &Pull) {
        let Pull { from, onto, staying, dying } = pull;
        for &t in dying {
            for v in self.triangles[t as usize] {
                self.fans[v as usize].retain(|&x| x != t);
            }
        }
        for &t in staying {
            self.triangles[t as usize].iter_mut().filter(|v| **v == *from).for_each(|v| *v = *onto);
            self.fans[*onto as usize].push(t);
        }
        self.fans[*from as usize].clear();
    }

    /// True if `u` lies on the given edge that Steiner vertex `s` lies on, if it lies on one.
    fn shares_edge(&self, s: u32, u: u32) -> bool {
        let Steiner { triangle, weights } = self.steiner[s as usize - self.given];
        let on_edge = |w: [f64; 3]| (0..3).all(|i| weights[i] != 0.0 || w[i] == 0.0);
        weights.iter().all(|&w| w != 0.0) || self.weights(u, triangle).is_some_and(on_edge)
    }

    /// True if `t`, with `u` in place of `s`, is a part of its given triangle.
    fn is_part(&self, t: u32, s: u32, u: u32) -> bool {
        let part = self.part_of[t as usize];
        let corners = self.triangles[t as usize].map(|v| self.weights(if v == s { u } else { v }, part));
        let [Some(a), Some(b), Some(c)] = corners else { return false };
        // Rounding may give corners on one edge an area.
        if (0..3).any(|i| [a, b, c].iter().all(|w| w[i] == 0.0)) {
            return false;
        }
        let flat = |w: [f64; 3]| DVec2::new(w[1], w[2]);
        orientation(flat(a), flat(b), flat(c)) > 0.0
    }

    /// The barycentric coordinates of a vertex in a given triangle, if that contains it.
    fn weights(&self, v: u32, triangle: u32) -> Option<[f64; 3]> {
        let corners = self.faces[triangle as usize];
        let Some(i) = (v as usize).checked_sub(self.given) else {
            let i = corners.iter().position(|&c| c == v)?;
            return Some(std::array::from_fn(|k| f64::from(u8::from(k == i))));
        };
        let Steiner { triangle: own, weights } = self.steiner[i];
        if own == triangle {
            return Some(weights);
        }
        let mut found = [0.0; 3];
        for (c, w) in self.faces[own as usize].into_iter().zip(weights).filter(|&(_, w)| w != 0.0) {
            found[corners.iter().position(|&x| x == c)?] = w;
        }
        Some(found)
    }

    /// The point with barycentric coordinates `b` in a triangle, in terms of the given one.
    pub fn within(&self, t: u32, b: [f64; 3]) -> Steiner {
        let part = self.part_of[t as usize];
        let corners = self.triangles[t as usize].map(|v| self.weights(v, part).unwrap_or_default());
        let weights = std::array::from_fn(|i| (0..3).map(|k| corners[k][i] * b[k]).sum());
        Steiner { triangle: part, weights }
    }

    /// Drops what was taken out; returns the new number of every vertex, none of those.
    pub fn compact(&mut self) -> Vec<Option<u32>> {
        let mut alive = vec![false; self.triangles.len()];
        self.fans.iter().flatten().for_each(|&t| alive[t as usize] = true);
        let stays = |v: usize| v < self.given || !self.fans[v].is_empty();
        let mut next = 0;
        let number: Vec<Option<u32>> = (0..self.fans.len())
            .map(|v| {
                next += u32::from(stays(v));
                stays(v).then(|| next - 1)
            })
            .collect();
        let kept = |t: &usize| alive[*t];
        let renumber = |v: u32| number[v as usize].unwrap_or(v);
        self.part_of = (0..alive.len()).filter(kept).map(|t| self.part_of[t]).collect();
        self.triangles = (0..alive.len()).filter(kept).map(|t| self.triangles[t].map(renumber)).collect();
        let given = self.given;
        self.steiner =
            (given..number.len()).filter(|&v| number[v].is_some()).map(|v| self.steiner[v - given]).collect();
        let mut fans = vec![Vec::new(); given + self.steiner.len()];
        for (t, corners) in (0u32..).zip(&self.triangles) {
            corners.iter().for_each(|&v| fans[v as usize].push(t));
        }
        self.fans = fans;
        number
    }
}
