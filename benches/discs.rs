//! One disc laid flat with little stretch: `cargo bench --bench discs -- [TRIANGLES] [--write FOLDER]`.
//!
//! The disc has hills and about as many triangles as asked for (100,000 unless said otherwise). It is laid flat twice: its
//! boundary on a circle, on springs that are weighted anew by stretch (after Yoshizawa, Belyaev, Seidel); and its boundary
//! free, as the texture mapping of a disc without constraints does it. Printed: how, triangles, seconds on the wall and of
//! all threads, normalised L2 stretch. `--write` leaves disc.obj there, for others to do the same.

use glam::DVec2;
use homeo::app::constrained::constrain;
use homeo::app::constrained::sheet::Sheet;
use homeo::gpu::Compute;
use homeo::mesh::io::{MeshFile, write_obj};
use homeo::mesh::metric;
use homeo::mesh::{FaceId, Id, TriMesh, VertexId};
use homeo::plane::convex::embed_disc;
use homeo::plane::patch_disc::PatchDisc;
use homeo::plane::stretch::{Frame, e_l2, l2_sq};
use homeo::shape::fixture::disc;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Triangles unless said otherwise.
const TRIANGLES: f64 = 1e5;

/// A disc of radius 1 with three hills and a hollow, `6 rings^2` triangles.
fn hilly(rings: u32) -> TriMesh {
    let hills = [([0.4, 0.1], 1.5), ([-0.3, 0.4], 1.1), ([-0.1, -0.5], 1.8), ([0.1, 0.6], -0.9)];
    let mut mesh = disc(rings);
    for p in &mut mesh.positions.raw {
        let hill = |&([x, y], height): &([f64; 2], f64)| {
            height * (-12.0 * DVec2::new(p.x - x, p.y - y).length_squared()).exp()
        };
        p.z = hills.iter().map(hill).sum();
    }
    mesh
}

/// Normalised L2 stretch of places in the plane.
fn stretch(mesh: &TriMesh, uv: &[DVec2]) -> f64 {
    let planar = |f: [VertexId; 3]| f.map(|v| uv[v.index()]);
    let spatial = |f: [VertexId; 3]| f.map(|v| mesh.positions[v]);
    let of_face = |&f: &[VertexId; 3]| (l2_sq(planar(f), spatial(f)), metric::area(spatial(f)));
    let stretches: Vec<(f64, f64)> = mesh.faces().iter().map(of_face).collect();
    e_l2(&stretches, mesh.faces().iter().map(|&f| metric::signed_area(planar(f))).sum())
}

/// The boundary on a circle.
fn on_a_circle(mesh: &TriMesh) -> Vec<DVec2> {
    let loops = mesh.conn.boundary_loops();
    let boundary: Vec<VertexId> = loops[0].iter().map(|&h| mesh.conn.from(h)).collect();
    let mut number = vec![u32::MAX; mesh.positions.len()];
    (0..).zip(&boundary).for_each(|(i, v)| number[v.index()] = i);
    let inner: Vec<VertexId> = (0..number.len()).filter(|&v| number[v] == u32::MAX).map(VertexId::new).collect();
    (boundary.len() as u32..).zip(&inner).for_each(|(i, v)| number[v.index()] = i);
    let vertices: Vec<VertexId> = boundary.iter().chain(&inner).copied().collect();
    let points: Vec<_> = vertices.iter().map(|&v| mesh.positions[v]).collect();
    let turn = |i: usize| DVec2::from_angle(TAU * i as f64 / boundary.len() as f64);
    let mut positions = vec![DVec2::ZERO; points.len()];
    (0..boundary.len()).for_each(|i| positions[i] = turn(i));
    let mut disc = PatchDisc {
        vertices,
        faces: (0..mesh.conn.face_count()).map(FaceId::new).collect(),
        triangles: mesh.faces().iter().map(|f| f.map(|v| number[v.index()])).collect(),
        boundary: boundary.len(),
        corners: [0, 1, 2],
        positions,
    };
    embed_disc(&mut disc, &points, &Frame { first: DVec2::X, second: DVec2::Y }, 0.5)
        .expect("a hilly disc can be laid flat");
    let mut uv = vec![DVec2::ZERO; points.len()];
    disc.vertices.iter().zip(&disc.positions).for_each(|(v, &p)| uv[v.index()] = p);
    uv
}

fn free(mesh: &TriMesh) -> Vec<DVec2> {
    let sheet = Sheet::new(mesh, mesh.conn.face_count(), Vec::new()).expect("a disc");
    constrain(sheet, &Compute::Cpu).expect("a hilly disc can be laid flat").0.sheet.uv
}

/// Seconds that all threads of this process have worked, where the system tells.
fn worked() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<f64> =
        stat.rsplit(')').next().unwrap_or_default().split_whitespace().filter_map(|x| x.parse().ok()).collect();
    // Ticks of 10 ms in user and in system mode, fields 14 and 15 of the line; the name and the state are no numbers.
    fields.get(10..12).map_or(f64::NAN, |ticks| ticks.iter().sum::<f64>() / 100.0)
}

fn write(mesh: &TriMesh, folder: &Path) -> std::io::Result<()> {
    let file = MeshFile::of(mesh);
    let mut bytes = Vec::new();
    write_obj(&mut bytes, folder, &file, &file.positions)?;
    std::fs::write(folder.join("disc.obj"), bytes)
}

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    let (mut triangles, mut folder) = (TRIANGLES, None);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--write" => folder = arguments.next().map(PathBuf::from),
            number => triangles = number.parse().unwrap_or(TRIANGLES),
        }
    }
    let mesh = hilly((triangles / 6.0).sqrt().round() as u32);
    if let Some(folder) = folder {
        write(&mesh, &folder).expect("the folder takes a mesh");
    }
    let lay: [fn(&TriMesh) -> Vec<DVec2>; 2] = [on_a_circle, free];
    for (name, lay) in ["circle", "free"].into_iter().zip(lay) {
        let (start, before) = (Instant::now(), worked());
        let uv = lay(&mesh);
        let seconds = [start.elapsed().as_secs_f64(), worked() - before];
        let faces = mesh.conn.face_count();
        println!(
            "{name:7} {faces:8} {:7.2} s {:7.2} s of threads  L2 {:.4}",
            seconds[0],
            seconds[1],
            stretch(&mesh, &uv)
        );
    }
}
