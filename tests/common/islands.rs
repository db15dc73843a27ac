//! A ball with eight islands of texture coordinates.

use glam::{DVec2, DVec3};
use homeo::mesh::io::MeshFile;
use homeo::picture::{Depth, Picture};
use std::collections::HashMap;

/// Islands in a row of the image.
const ROW: usize = 3;
/// An island's margin, as a share of its place.
const MARGIN: f64 = 0.1;

/// An octahedron with `n` segments along every edge, blown up to the unit sphere; face `k` is an island at place
/// `places[k]` of a 3 x 3 grid, so seams run along the edges of the octahedron.
pub fn ball(n: usize, places: [usize; 8]) -> MeshFile {
    let mut mesh = MeshFile::default();
    let mut number: HashMap<[i64; 3], u32> = HashMap::new();
    let signs = |k: usize| [0, 1, 2].map(|axis| if k >> axis & 1 == 0 { 1.0 } else { -1.0 });
    for k in 0..8 {
        let [x, y, z] = signs(k);
        let mut corners = [DVec3::X * x, DVec3::Y * y, DVec3::Z * z];
        if x * y * z < 0.0 {
            corners.swap(1, 2);
        }
        let place = DVec2::new((places[k] % ROW) as f64, (places[k] / ROW) as f64);
        let mut vertex = |i: usize, j: usize| {
            let (s, t) = (i as f64 / n as f64, j as f64 / n as f64);
            let p = (corners[0] * (1.0 - s - t) + corners[1] * s + corners[2] * t).normalize();
            let key = (p * 1e6).round().to_array().map(|x| x as i64);
            let v = *number.entry(key).or_insert_with(|| {
                mesh.positions.push(p);
                mesh.positions.len() as u32 - 1
            });
            let inner = DVec2::new(MARGIN, MARGIN) + DVec2::new(s, t) * (1.0 - 2.0 * MARGIN);
            mesh.uv.values.push((place + inner) / ROW as f64);
            (v, mesh.uv.values.len() as u32 - 1)
        };
        let mut triangles = Vec::new();
        for i in 0..n {
            for j in 0..n - i {
                triangles.push([(i, j), (i + 1, j), (i, j + 1)].map(|(i, j)| vertex(i, j)));
                if i + j + 1 < n {
                    triangles.push([(i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| vertex(i, j)));
                }
            }
        }
        for triangle in triangles {
            mesh.push_polygon(triangle.map(|(v, _)| v));
            mesh.uv.corners.extend(triangle.map(|(_, uv)| uv));
        }
    }
    mesh
}

/// An image that has a colour of its own in every place of the grid.
pub fn cell_colours(size: usize) -> Picture {
    let colour = |i: usize| {
        let cell = (i % size * ROW / size, i / size * ROW / size);
        let byte = |x: usize| (40 + 80 * x) as f32 / 255.0;
        [byte(cell.0), byte(cell.1), byte((cell.0 + cell.1) % 2), 1.0]
    };
    Picture {
        width: size,
        height: size,
        channels: 3,
        depth: Depth::DataByte,
        pixels: (0..size * size).map(colour).collect(),
    }
}
