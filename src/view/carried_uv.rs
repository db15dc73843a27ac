//! Texture coordinates of one mesh at the triangles of another one that is mapped onto it.

use crate::map::file_order::number_in_file;
use crate::map::product::Side;
use crate::mesh::{FaceId, Id, SurfacePoint};
use glam::{DVec2, DVec3};

/// The texture coordinates of a mesh's own triangles; not a number where there are none.
pub fn own_uv(side: &Side) -> Vec<[DVec2; 3]> {
    let in_file: Vec<[usize; 3]> = side.file.triangle_corners().collect();
    let of_face = |f: FaceId| {
        let corners = in_file[number_in_file(f, side.omitted).index()];
        side.mesh.face(f).map(|v| {
            let corner = corners.into_iter().find(|&c| side.file.corners[c] == v);
            corner.and_then(|c| side.file.uv.at(c)).unwrap_or(DVec2::NAN)
        })
    };
    side.mesh.conn.faces().map(of_face).collect()
}

/// The texture coordinates `uv` of the mesh `onto` at the images of the triangles' corners of another mesh.
///
/// Where a triangle reaches over a seam, all its corners follow the chart that most of them lie in: the others' coordinates
/// are those of the plane through the face there.
pub fn carried_uv(side: &Side, onto: &Side, uv: &[[DVec2; 3]]) -> Vec<[DVec2; 3]> {
    let charts = charts(uv);
    let of_face = |f: FaceId| {
        let points = side.mesh.face(f).map(|v| side.image[v].and_then(|p: SurfacePoint| p.on_face(onto.mesh)));
        let chart = |k: usize| points[k].map(|(g, _)| charts[g.index()]);
        let leader = (0..3).max_by_key(|&k| ((0..3).filter(|&j| chart(j) == chart(k)).count(), 2 - k)).unwrap_or(0);
        let Some((lead, _)) = points[leader] else { return [DVec2::NAN; 3] };
        points.map(|point| match point {
            Some((g, b)) if charts[g.index()] == charts[lead.index()] => mixed(uv[g.index()], b),
            Some((g, b)) => {
                let at = onto.mesh.triangle(g).into_iter().zip(b).map(|(p, w)| p * w).sum();
                mixed(uv[lead.index()], weights(onto.mesh.triangle(lead), at))
            }
            None => DVec2::NAN,
        })
    };
    side.mesh.conn.faces().map(of_face).collect()
}

fn mixed(uv: [DVec2; 3], b: [f64; 3]) -> DVec2 {
    uv[0] * b[0] + uv[1] * b[1] + uv[2] * b[2]
}

/// The weights of a triangle's corners at the point of its plane that is nearest to `p`; a third each without area.
fn weights([a, b, c]: [DVec3; 3], p: DVec3) -> [f64; 3] {
    let (u, v, w) = (b - a, c - a, p - a);
    let (uu, uv, vv, wu, wv) = (u.dot(u), u.dot(v), v.dot(v), w.dot(u), w.dot(v));
    let area_sq = uu * vv - uv * uv;
    let [s, t] = [(wu * vv - wv * uv) / area_sq, (wv * uu - wu * uv) / area_sq];
    if s.is_finite() && t.is_finite() { [1.0 - s - t, s, t] } else { [1.0 / 3.0; 3] }
}

/// A number for every triangle, the same for those that hang together in the image.
fn charts(uv: &[[DVec2; 3]]) -> Vec<u32> {
    let mut first_at = std::collections::HashMap::new();
    let mut parent: Vec<u32> = (0..uv.len() as u32).collect();
    for (i, corners) in (0u32..).zip(uv) {
        for corner in corners {
            let other = *first_at.entry(corner.to_array().map(f64::to_bits)).or_insert(i);
            let (a, b) = (root(&mut parent, i), root(&mut parent, other));
            parent[a.max(b) as usize] = a.min(b);
        }
    }
    (0..uv.len() as u32).map(|i| root(&mut parent, i)).collect()
}

fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        parent[i as usize] = parent[parent[i as usize] as usize];
        i = parent[i as usize];
    }
    i
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_that_share_a_place_in_the_image_are_one_chart() {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        let one = [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)];
        let beside = [at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
        let away = one.map(|p| p + 5.0);
        assert_eq!(charts(&[one, away, beside]), [0, 1, 0]);
    }

    #[test]
    fn weights_reach_beyond_the_triangle() {
        let t = [DVec3::ZERO, DVec3::X, DVec3::Y];
        assert_eq!(weights(t, DVec3::new(2.0, -1.0, 3.0)), [0.0, 2.0, -1.0]);
        assert_eq!(weights([DVec3::ZERO; 3], DVec3::X), [1.0 / 3.0; 3]);
    }
}
