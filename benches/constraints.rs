//! Hard constraints on generated sets, or on sets of one's own: `cargo bench --bench constraints [-- FOLDER] [--only NAME]`.
//!
//! Every folder below FOLDER with `mesh.obj` and `constraints.csv` is a set. Printed are the vertices, the constraints, the
//! Steiner vertices, E_L2 before and after smoothing and the seconds, and above them what others have on sets of this size.

mod common;
#[path = "../tests/common/constraint_sets.rs"]
mod constraint_sets;

use common::folders_with;
use constraint_sets::{KINDS, Kind, random_set};
use homeo::app::constrained::disc::disc_of;
use homeo::app::constrained::sheet::{Feature, Sheet};
use homeo::app::constrained::{ConstrainReport, constrain};
use homeo::gpu::Compute;
use homeo::mesh::VertexId;
use homeo::mesh::io::{read_constraints, read_mesh};
use homeo::stage::check::inspect;
use homeo::{Error, Result};
use std::path::Path;
use std::time::Instant;

/// WARP, table 1: vertices, features, Steiner vertices at the end, seconds on a Pentium 4.
const WARP: [[f64; 4]; 9] = [
    [1770.0, 24.0, 7.0, 0.625],
    [1808.0, 25.0, 10.0, 1.712],
    [10017.0, 54.0, 34.0, 10.641],
    [1772.0, 21.0, 21.0, 3.359],
    [1657.0, 27.0, 2.0, 0.75],
    [1697.0, 32.0, 64.0, 4.39],
    [10736.0, 32.0, 8.0, 14.5],
    [5184.0, 83.0, 38.0, 10.86],
    [4149.0, 71.0, 25.0, 6.14],
];

/// What is used today, measured on discs of 2,000 to 15,000 vertices with 20 to 83 features.
const TODAY: [&str; 2] = [
    "Matchmaker++ (with Progressive Embedding): 3 of 12 sets solved, 32060 to 100953 Steiner vertices, 3 to 12 s CPU",
    "foldover-free maps (2D untangling): 2007 vertices, 21 features: solved without Steiner vertices in 13.2 s CPU",
];

/// Rings and features of the generated sets: 9,919 and 14,911 vertices.
const GENERATED: [(u32, usize); 2] = [(57, 54), (70, 83)];
/// Generated sets of every size and kind.
const DRAWS: u64 = 3;

fn main() {
    println!("WARP, table 1: vertices, features, Steiner vertices, seconds (Pentium 4)");
    WARP.iter().for_each(|[v, f, s, t]| println!("{v:6} {f:4} {s:4} {t:8.3} s"));
    TODAY.iter().for_each(|line| println!("{line}"));
    println!(
        "\nHere: set, vertices, features, times carried, Steiner vertices before and after, E_L2 before and after, seconds"
    );
    let mut arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let only = arguments.iter().position(|a| a == "--only").map(|i| arguments.drain(i..).skip(1).collect::<String>());
    let is_wanted = |name: &str| only.as_ref().is_none_or(|only| name.contains(only));
    match arguments.first() {
        Some(folder) => {
            for set in folders_with(&["mesh.obj", "constraints.csv"], Path::new(folder)) {
                let name = set.file_name().unwrap_or_default().to_string_lossy().into_owned();
                if is_wanted(&name) {
                    print(&name, of_folder(&set));
                }
            }
        }
        None => generated(is_wanted),
    }
}

fn generated(is_wanted: impl Fn(&str) -> bool) {
    // Not to places anywhere: that many are met only with more Steiner vertices than anyone would want.
    for (rings, features) in GENERATED {
        for kind in &KINDS[..4] {
            for seed in 0..DRAWS {
                let name = format!("{kind:?} {features} {seed}");
                if is_wanted(&name) {
                    print(&name, of_draw(rings, features, *kind, seed));
                }
            }
        }
    }
}

/// What a set came to.
struct Row {
    vertices: usize,
    features: usize,
    report: ConstrainReport,
    seconds: f64,
}

fn print(name: &str, row: Result<Row>) {
    match row {
        Ok(Row { vertices, features, report, seconds }) => {
            let ConstrainReport { carried, steiner: [before, after], e_l2: [met, smooth] } = report;
            println!(
                "{name:26} {vertices:6} {features:4} {carried:3} {before:5} {after:4} {met:7.3} {smooth:7.3} {seconds:7.2} s"
            );
        }
        Err(error) => println!("{name:26} {error}"),
    }
}

fn of_folder(set: &Path) -> Result<Row> {
    let loaded = inspect(read_mesh(&set.join("mesh.obj"))?)?;
    let constraints = read_constraints(&set.join("constraints.csv"), loaded.file.positions.len())?;
    let start = Instant::now();
    let vertices: Vec<VertexId> = constraints.iter().map(|c| c.vertex).collect();
    let disc = disc_of(&loaded, &vertices, None)?;
    let number = |v: VertexId| disc.vertex_of.iter().position(|&of| of == Some(v));
    let features: Option<Vec<Feature>> =
        constraints.iter().map(|c| Some(Feature { vertex: number(c.vertex)? as u32, place: c.place })).collect();
    let features = features.ok_or_else(|| Error::input("a constrained vertex that no face uses"))?;
    let (_, report) = constrain(Sheet::new(&disc.mesh, disc.real, features)?, &Compute::Cpu)?;
    let (vertices, features) = (loaded.file.positions.len(), constraints.len());
    Ok(Row { vertices, features, report, seconds: start.elapsed().as_secs_f64() })
}

fn of_draw(rings: u32, count: usize, kind: Kind, seed: u64) -> Result<Row> {
    let (mesh, features) = random_set(rings, count, kind, seed);
    let start = Instant::now();
    let (_, report) = constrain(Sheet::new(&mesh, mesh.conn.face_count(), features)?, &Compute::Cpu)?;
    let (vertices, features) = (mesh.positions.len(), count);
    Ok(Row { vertices, features, report, seconds: start.elapsed().as_secs_f64() })
}
