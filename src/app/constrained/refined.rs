//! A disc with vertices added inside its faces and on its edges, and how they are taken out again.
//!
//! A Steiner vertex is taken out by pulling it onto a vertex beside it: of its own edge, if it lies on an edge of the
//! given mesh. When all are gone the given triangles are back.

use super::sheet::Sheet;
use crate::mesh::{FaceId, Id, TriMesh, VertexId};
use crate::path::cut_mesh::CutMesh;
use crate::plane::orientation::orientation;
use crate::plane::visible::kernel;
use glam::{DVec2, DVec3};
use std::collections::BTreeSet;

/// A disc with added vertices.
#[derive(Clone, Debug)]
pub struct Refined {
    /// The refined disc; its first vertices are the given ones.
    pub sheet: Sheet,
    /// For every triangle the given one that it is part of.
    pub part_of: Vec<u32>,
    /// Where the added vertices lie on the given disc, in order.
    pub steiner: Vec<Steiner>,
    /// Number of given vertices.
    given: usize,
    /// The given triangles.
    faces: Vec<[u32; 3]>,
}

/// Where an added vertex lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steiner {
    /// A given triangle that contains it.
    pub triangle: u32,
    /// Its barycentric coordinates there; zero exactly if it lies on an edge.
    pub weights: [f64; 3],
}

impl Refined {
    /// The part of a cut mesh that belongs to the disc; `mesh` is the disc with its scaffold and numbers the disc's
    /// elements as the disc does, `uv` has a place for every vertex.
    pub fn new(sheet: &Sheet, cut: &CutMesh, mesh: &TriMesh, uv: &[DVec2]) -> Self {
        let (given, disc) = (sheet.uv.len(), sheet.triangles.len());
        let mut faces: Vec<FaceId> = cut.conn.faces().filter(|&f| cut.face_origin[f].index() < disc).collect();
        // Triangles that fill holes come last, as they do in the disc.
        faces.sort_by_key(|&f| cut.face_origin[f].index() >= sheet.real);
        let mut number: Vec<Option<u32>> = vec![None; cut.conn.vertex_count()];
        (0..given).for_each(|v| number[v] = Some(v as u32));
        let mut refined = Refined {
            sheet: Sheet { triangles: Vec::new(), boundary: Vec::new(), ..sheet.clone() },
            part_of: Vec::new(),
            steiner: Vec::new(),
            given,
            faces: sheet.triangles.clone(),
        };
        refined.sheet.uv.copy_from_slice(&uv[..given]);
        refined.sheet.real = faces.iter().filter(|&&f| cut.face_origin[f].index() < sheet.real).count();
        for f in faces {
            let part = cut.face_origin[f];
            let corners = cut.conn.face(f).map(|v| match number[v.index()] {
                Some(known) => known,
                None => {
                    let weights = cut.origin[v].barycentric_in(mesh, part).unwrap_or_default();
                    let new = refined.add(Steiner { triangle: part.0, weights }, uv[v.index()]);
                    number[v.index()] = Some(new);
                    new
                }
            });
            refined.sheet.triangles.push(corners);
            refined.part_of.push(part.0);
        }
        refined.find_boundary();
        refined
    }

    /// A disc without added vertices.
    pub fn unrefined(sheet: Sheet) -> Self {
        let part_of = (0..sheet.triangles.len() as u32).collect();
        let (given, faces) = (sheet.uv.len(), sheet.triangles.clone());
        Refined { sheet, part_of, steiner: Vec::new(), given, faces }
    }

    fn add(&mut self, steiner: Steiner, uv: DVec2) -> u32 {
        let corners = self.faces[steiner.triangle as usize].map(|v| self.sheet.points[v as usize]);
        let point: DVec3 = (0..3).map(|i| corners[i] * steiner.weights[i]).sum();
        self.steiner.push(steiner);
        self.sheet.points.push(point);
        self.sheet.uv.push(uv);
        self.sheet.uv.len() as u32 - 1
    }

    /// The boundary, from the triangles.
    fn find_boundary(&mut self) {
        let faces: Vec<[VertexId; 3]> = self.sheet.triangles.iter().map(|t| t.map(VertexId)).collect();
        // What a cut mesh's faces leave is a manifold; were it not, folds would be seen later.
        let Ok(mesh) = TriMesh::new(self.sheet.points.clone(), &faces) else { return };
        let loops = mesh.conn.boundary_loops();
        self.sheet.boundary = loops.iter().flatten().map(|&h| mesh.conn.from(h).0).collect();
    }

    /// Number of given vertices.
    pub fn given(&self) -> usize {
        self.given
    }

    /// Takes out the Steiner vertices that the others can do without; returns how many went.
    pub fn take_out(&mut self) -> usize {
        let before = self.steiner.len();
        let mut fans: Vec<BTreeSet<u32>> = vec![BTreeSet::new(); self.sheet.uv.len()];
        for (t, corners) in (0u32..).zip(&self.sheet.triangles) {
            corners.iter().for_each(|&v| _ = fans[v as usize].insert(t));
        }
        let mut gone = vec![false; self.sheet.uv.len()];
        loop {
            let mut any = false;
            for s in self.given..self.sheet.uv.len() {
                if !gone[s] && self.take_out_one(s as u32, &mut fans) {
                    (gone[s], any) = (true, true);
                }
            }
            if !any {
                break;
            }
        }
        self.forget(&gone, &fans);
        before - self.steiner.len()
    }

    fn take_out_one(&mut self, s: u32, fans: &mut [BTreeSet<u32>]) -> bool {
        let around = fans[s as usize].clone();
        let corners = |t: &u32| self.sheet.triangles[*t as usize];
        let ring: BTreeSet<u32> = around.iter().flat_map(corners).filter(|&v| v != s).collect();
        for &u in ring.iter().filter(|&&u| self.shares_edge(s, u)) {
            let (dying, staying): (Vec<u32>, Vec<u32>) = around.iter().partition(|t| corners(t).contains(&u));
            let beside: BTreeSet<u32> = fans[u as usize].iter().flat_map(corners).collect();
            let common = ring.iter().filter(|&&v| v != u && beside.contains(&v)).count();
            if common != dying.len() || !staying.iter().all(|&t| self.contains(t, u) && self.is_part(t, s, u)) {
                continue;
            }
            let Some(place) = self.place_for(s, u, &staying, &dying, fans) else { continue };
            self.sheet.uv[u as usize] = place;
            for &t in &staying {
                let corners = &mut self.sheet.triangles[t as usize];
                corners.iter_mut().filter(|v| **v == s).for_each(|v| *v = u);
                fans[u as usize].insert(t);
            }
            for t in dying {
                self.sheet.triangles[t as usize].iter().for_each(|&v| _ = fans[v as usize].remove(&t));
            }
            fans[s as usize].clear();
            return true;
        }
        false
    }

    /// True if `u` lies on the given edge that Steiner vertex `s` lies on, if it lies on one.
    fn shares_edge(&self, s: u32, u: u32) -> bool {
        let Steiner { triangle, weights } = self.steiner[s as usize - self.given];
        let on_edge = |w: [f64; 3]| (0..3).all(|i| weights[i] != 0.0 || w[i] == 0.0);
        weights.iter().all(|&w| w != 0.0) || self.weights(u, triangle).is_some_and(on_edge)
    }

    /// True if the given triangle that `t` is part of contains vertex `u`.
    fn contains(&self, t: u32, u: u32) -> bool {
        self.weights(u, self.part_of[t as usize]).is_some()
    }

    /// True if `t`, with `u` in place of `s`, is a part of its given triangle.
    fn is_part(&self, t: u32, s: u32, u: u32) -> bool {
        let part = self.part_of[t as usize];
        let corners = self.sheet.triangles[t as usize].map(|v| self.weights(if v == s { u } else { v }, part));
        let [Some(a), Some(b), Some(c)] = corners else { return false };
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

    /// Where `u` must lie for no triangle to fold when `s` is pulled onto it: where it is, or, if it may move, in the
    /// middle of what sees all around.
    fn place_for(&self, s: u32, u: u32, staying: &[u32], dying: &[u32], fans: &[BTreeSet<u32>]) -> Option<DVec2> {
        let opposite = |t: &u32, v: u32| {
            let corners = self.sheet.triangles[*t as usize];
            let i = corners.iter().position(|&c| c == v)?;
            Some([1, 2].map(|k| corners[(i + k) % 3]))
        };
        let mut edges: Vec<[u32; 2]> = staying.iter().filter_map(|t| opposite(t, s)).collect();
        let own = fans[u as usize].iter().filter(|t| !dying.contains(t));
        let at = self.sheet.uv[u as usize];
        let place = |v: u32| self.sheet.uv[v as usize];
        let sees = |p: DVec2, edges: &[[u32; 2]]| edges.iter().all(|&[a, b]| orientation(p, place(a), place(b)) > 0.0);
        if sees(at, &edges) {
            return Some(at);
        }
        edges.extend(own.filter_map(|t| opposite(t, u)));
        let is_free = !self.sheet.features.iter().any(|f| f.vertex == u);
        let polygon = is_free.then(|| closed(&edges)).flatten()?;
        let middle = kernel(&polygon.iter().map(|&v| place(v)).collect::<Vec<_>>()).centre();
        (middle.is_finite() && sees(middle, &edges)).then_some(middle)
    }

    /// Renumbers what is left.
    fn forget(&mut self, gone: &[bool], fans: &[BTreeSet<u32>]) {
        let alive: BTreeSet<u32> = fans.iter().flatten().copied().collect();
        let mut number = 0u32;
        let numbers: Vec<u32> = gone
            .iter()
            .map(|gone| {
                number += u32::from(!gone);
                number - u32::from(!gone)
            })
            .collect();
        let kept = |v: usize| !gone[v];
        let real = alive.iter().filter(|&&t| (t as usize) < self.sheet.real).count();
        let triangles = alive.iter().map(|&t| self.sheet.triangles[t as usize].map(|v| numbers[v as usize]));
        self.sheet.triangles = triangles.collect();
        self.part_of = alive.iter().map(|&t| self.part_of[t as usize]).collect();
        self.sheet.real = real;
        let given = self.given;
        self.steiner = (given..gone.len()).filter(|&v| kept(v)).map(|v| self.steiner[v - given]).collect();
        self.sheet.points = (0..gone.len()).filter(|&v| kept(v)).map(|v| self.sheet.points[v]).collect();
        self.sheet.uv = (0..gone.len()).filter(|&v| kept(v)).map(|v| self.sheet.uv[v]).collect();
        self.find_boundary();
    }
}

/// The polygon that directed edges form, if they form one.
fn closed(edges: &[[u32; 2]]) -> Option<Vec<u32>> {
    let mut polygon = vec![edges.first()?[0]];
    while polygon.len() < edges.len() {
        let last = polygon[polygon.len() - 1];
        polygon.push(edges.iter().find(|e| e[0] == last)?[1]);
    }
    let last = polygon[polygon.len() - 1];
    edges.iter().any(|e| e[0] == last && e[1] == polygon[0]).then_some(polygon)
}
