//! A laid out disc with vertices added inside its faces and on its edges.

use super::fair::Fair;
use super::sheet::Sheet;
use super::subdivided::{Pull, Steiner, Subdivided};
use crate::mesh::{FaceId, Id, TriMesh, VertexId};
use crate::path::cut_mesh::CutMesh;
use crate::plane::orientation::orientation;
use crate::plane::visible::kernel;
use glam::{DVec2, DVec3};

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
    /// Number of given triangles that do not fill holes.
    real_faces: usize,
}

impl Refined {
    /// The same disc divided further: the part of a cut mesh that belongs to it. `mesh` is this disc with its scaffold and
    /// numbers the disc's elements as the disc does, `uv` has a place for every vertex.
    pub fn divided(&self, cut: &CutMesh, mesh: &TriMesh, uv: &[DVec2]) -> Self {
        let (known, disc) = (self.sheet.uv.len(), self.sheet.triangles.len());
        let part = |f: FaceId| cut.face_origin[f].index();
        let mut faces: Vec<FaceId> = cut.conn.faces().filter(|&f| part(f) < disc).collect();
        // Triangles that fill holes come last, as they do in the disc.
        faces.sort_by_key(|&f| part(f) >= self.sheet.real);
        let mut number: Vec<Option<u32>> = vec![None; cut.conn.vertex_count()];
        (0..known).for_each(|v| number[v] = Some(v as u32));
        let mut refined = self.clone();
        refined.sheet.uv.copy_from_slice(&uv[..known]);
        refined.sheet.real = faces.iter().filter(|&&f| part(f) < self.sheet.real).count();
        let sub = self.subdivided();
        let triangle = |f: FaceId| {
            cut.conn.face(f).map(|v| {
                *number[v.index()].get_or_insert_with(|| {
                    let within = cut.origin[v].barycentric_in(mesh, cut.face_origin[f]).unwrap_or_default();
                    refined.add(sub.within(part(f) as u32, within), uv[v.index()])
                })
            })
        };
        let triangles = faces.iter().copied().map(triangle).collect();
        refined.part_of = faces.iter().map(|&f| self.part_of[part(f)]).collect();
        refined.sheet.triangles = triangles;
        refined.find_boundary();
        refined
    }

    fn subdivided(&self) -> Subdivided<'_> {
        let Refined { sheet, part_of, steiner, given, faces, .. } = self;
        Subdivided::new(faces, *given, sheet.triangles.clone(), part_of.clone(), steiner.clone())
    }

    /// A disc without added vertices.
    pub fn unrefined(sheet: Sheet) -> Self {
        let part_of = (0..sheet.triangles.len() as u32).collect();
        let (given, faces, real_faces) = (sheet.uv.len(), sheet.triangles.clone(), sheet.real);
        Refined { sheet, part_of, steiner: Vec::new(), given, faces, real_faces }
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

    /// Takes out the Steiner vertices that the others can do without; `most` is the mean squared stretch that is no
    /// reason to keep one, 1 for an isometry.
    pub fn take_out(&mut self, most: f64) {
        let fair = Fair::new(&self.sheet, self.real_faces, most);
        let Refined { sheet, part_of, steiner, given, faces, .. } = self;
        let mut is_rim = vec![false; sheet.uv.len()];
        sheet.boundary.iter().for_each(|&v| is_rim[v as usize] = true);
        let triangles = std::mem::take(&mut sheet.triangles);
        let mut sub = Subdivided::new(faces, *given, triangles, std::mem::take(part_of), std::mem::take(steiner));
        let mut left: Vec<u32> = (*given as u32..sheet.uv.len() as u32).collect();
        loop {
            let count = left.len();
            left.retain(|&s| !take_out_one(sheet, &fair, &is_rim, &mut sub, s));
            if left.len() == count {
                break;
            }
        }
        let number = sub.compact();
        // A given triangle below `real` has only parts that come before those of the others.
        let virtual_parts = sub.part_of.iter().filter(|&&p| p as usize >= self.real_faces).count();
        sheet.real = sub.triangles.len() - virtual_parts;
        let kept = |v: &usize| number[*v].is_some();
        sheet.points = (0..number.len()).filter(kept).map(|v| sheet.points[v]).collect();
        sheet.uv = (0..number.len()).filter(kept).map(|v| sheet.uv[v]).collect();
        (sheet.triangles, self.part_of, self.steiner) = (sub.triangles, sub.part_of, sub.steiner);
        self.find_boundary();
    }
}

/// True if the boundary, with Steiner vertex `s` pulled onto its neighbour, still does not meet itself.
///
/// Where `s` is a reflex corner the disc grows by a triangle, in which no other part of the boundary may lie.
fn boundary_holds(sheet: &Sheet, is_rim: &[bool], sub: &Subdivided, pull: &Pull) -> bool {
    if !is_rim[pull.from as usize] {
        return true;
    }
    let ends = sub.fan(pull.from).iter().filter_map(|&t| sub.opposite(t, pull.from));
    let (firsts, seconds): (Vec<u32>, Vec<u32>) = ends.map(|[a, b]| (a, b)).unzip();
    // The two neighbours along the boundary are the ends of the open fan.
    let next = firsts.iter().find(|v| !seconds.contains(v));
    let before = seconds.iter().find(|v| !firsts.contains(v));
    let (Some(&next), Some(&before)) = (next, before) else { return false };
    let [a, s, b] = [before, pull.from, next].map(|v| sheet.uv[v as usize]);
    if orientation(a, s, b) >= 0.0 {
        return true;
    }
    let lies_in = |p: DVec2| orientation(a, b, p) >= 0.0 && orientation(b, s, p) >= 0.0 && orientation(s, a, p) >= 0.0;
    let others = (0..is_rim.len() as u32).filter(|&v| is_rim[v as usize] && ![before, pull.from, next].contains(&v));
    !others.into_iter().any(|v| !sub.fan(v).is_empty() && lies_in(sheet.uv[v as usize]))
}

/// Takes one Steiner vertex out if some way to do so folds nothing and is fair.
fn take_out_one(sheet: &mut Sheet, fair: &Fair, is_rim: &[bool], sub: &mut Subdivided, s: u32) -> bool {
    let placed = |pull: Pull| {
        let holds = boundary_holds(sheet, is_rim, sub, &pull);
        let place = holds.then(|| place_for(sheet, is_rim, sub, &pull)).flatten()?;
        fair.allows(sheet, sub, &pull, place).then_some((pull, place))
    };
    let found = sub.pulls(s).find_map(placed);
    let Some((pull, place)) = found else { return false };
    sheet.uv[pull.onto as usize] = place;
    sub.pull(&pull);
    true
}

/// Where the vertex pulled onto must lie for no triangle to fold: where it is, or, if it may move, in the middle of what
/// sees all around.
fn place_for(sheet: &Sheet, is_rim: &[bool], sub: &Subdivided, pull: &Pull) -> Option<DVec2> {
    let Pull { from, onto, staying, dying } = pull;
    let mut edges: Vec<[u32; 2]> = staying.iter().filter_map(|&t| sub.opposite(t, *from)).collect();
    let at = sheet.uv[*onto as usize];
    let place = |v: u32| sheet.uv[v as usize];
    let sees = |p: DVec2, edges: &[[u32; 2]]| edges.iter().all(|&[a, b]| orientation(p, place(a), place(b)) > 0.0);
    if sees(at, &edges) {
        return Some(at);
    }
    let own = sub.fan(*onto).iter().filter(|t| !dying.contains(t));
    edges.extend(own.filter_map(|&t| sub.opposite(t, *onto)));
    let is_free = !is_rim[*onto as usize] && !sheet.features.iter().any(|f| f.vertex == *onto);
    let polygon = is_free.then(|| closed(&edges)).flatten()?;
    let middle = kernel(&polygon.iter().map(|&v| place(v)).collect::<Vec<_>>()).centre();
    (middle.is_finite() && sees(middle, &edges)).then_some(middle)
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
