//! The papers' tables on pairs of one's own: `cargo bench --bench papers -- FOLDER [--only WORD] [--perturb N]`.
//!
//! Every folder below FOLDER with `source.obj`, `target.obj` and `landmarks.csv` is a pair. Printed are our versions of
//! VORONOI's table 2 (the greedy layout against VORONOI with one edge node and with adaptive ones, the map relaxed within
//! patches), of HYPOTHESIS' table 1 (vertices before and after active refinement, the greedy layout's seconds against
//! ours), and beside them what the papers have. With `--perturb N` landmarks are moved instead: all of them to a neighbouring
//! vertex by chance, N times a pair; printed is how E_L2 spreads.

mod common;

use common::folders_with;
use homeo::Result;
use homeo::gpu::{Compute, Device, DeviceChoice};
use homeo::map::distortion::{Measures, distortion};
use homeo::map::surface_map::SurfaceMap;
use homeo::mesh::io::Landmarks;
use homeo::mesh::{IdVec, TriMesh, VertexId};
use homeo::pipeline::{LayoutMethod, MapOptions, Mapped, Silent, map_pairs};
use homeo::shape::{SplitMix, nudge_landmarks};
use homeo::stage::check::{Checked, check};
use homeo::stage::cluster::BaseVertices;
use homeo::stage::compose::{Composed, compose};
use homeo::stage::embed::embed;
use homeo::stage::greedy::Greedy;
use homeo::stage::layout::{Layout, greedy_layout, guided_layouts, published_layout};
use homeo::stage::load::{LoadOptions, Loaded, load};
use homeo::stage::refine::{RefineOptions, refine};
use homeo::stage::relax::{RelaxOptions, relax_arcs, relax_patches};
use homeo::stage::stretch::stretch;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// VORONOI, table 2: pair, vertices, landmarks; E_ang, E_L2 and seconds of greedy, one edge node, adaptive edge nodes.
const VORONOI: [(&str, &str, u32, [[f64; 3]; 3]); 9] = [
    ("cow 1/2", "2904/4315", 27, [[1.33, 0.56, 0.61], [1.320, 1.103, 1.097], [6.0, 1.0, 3.0]]),
    ("skull/Max-Planck", "23908/7399", 24, [[0.16, 0.16, 0.15], [1.122, 1.116, 1.107], [53.0, 6.0, 20.0]]),
    ("dog/goat", "8020/10436", 59, [[0.36, 0.16, 0.16], [1.943, 1.132, 1.131], [134.0, 5.0, 12.0]]),
    ("David/Egea", "49493/8268", 24, [[0.36, 0.18, 0.16], [1.368, 1.110, 1.097], [174.0, 13.0, 44.0]]),
    ("male 1/2", "38438/8950", 37, [[0.50, 0.08, 0.07], [1.769, 1.063, 1.060], [169.0, 14.0, 31.0]]),
    ("male 1/2", "38438/8950", 75, [[0.13, 0.10, 0.09], [1.138, 1.074, 1.068], [362.0, 23.0, 47.0]]),
    ("dino/giraffe", "23982/9239", 67, [[0.56, 0.33, 0.31], [1.605, 1.260, 1.251], [422.0, 13.0, 28.0]]),
    ("armadillo/woman", "43245/5691", 45, [[0.64, 0.39, 0.39], [2.170, 1.307, 1.292], [306.0, 17.0, 40.0]]),
    ("armadillo/woman", "43245/5691", 85, [[0.47, 0.44, 0.43], [1.465, 1.299, 1.289], [814.0, 32.0, 72.0]]),
];

/// HYPOTHESIS, table 1: pair, vertices, landmarks, seconds of the earlier method and of theirs, vertices after.
const HYPOTHESIS: [(&str, &str, u32, &str, &str, &str); 10] = [
    ("cat/lion 1", "21617/14996", 63, "over 7200", "1200", "21834/15285"),
    ("cat/lion 1, moved", "21617/14996", 63, "failed", "1260", "21878/15300"),
    ("cat/lion 2", "7207/5000", 63, "900", "420", "7414/5212"),
    ("cat/lion 3", "7207/5000", 14, "72", "75", "7383/5028"),
    ("cat/lion 3, moved", "7207/5000", 14, "failed", "72", "7390/5043"),
    ("running cat/lion", "7207/5000", 17, "120", "120", "7286/5136"),
    ("camel/horse", "9770/19851", 35, "1500", "600", "10826/20736"),
    ("bull/buffalo", "12941/8708", 17, "420", "240", "13392/9013"),
    ("torus/star", "16815/5192", 20, "720", "360", "16846/8408"),
    ("Egea/David", "8268/10113", 27, "720", "300", "8417/10292"),
];

struct Arguments {
    folder: PathBuf,
    only: Option<String>,
    perturb: usize,
}

fn arguments() -> Option<Arguments> {
    let mut given = std::env::args().skip(1).filter(|a| a != "--bench");
    let mut arguments = Arguments { folder: given.next()?.into(), only: None, perturb: 0 };
    while let Some(flag) = given.next() {
        match flag.as_str() {
            "--only" => arguments.only = Some(given.next()?),
            "--perturb" => arguments.perturb = given.next()?.parse().ok()?,
            _ => return None,
        }
    }
    Some(arguments)
}

fn main() {
    let Some(Arguments { folder, only, perturb }) = arguments() else {
        eprintln!("usage: cargo bench --bench papers -- FOLDER [--only WORD] [--perturb N]");
        return;
    };
    let mut pairs = folders_with(&["source.obj", "target.obj", "landmarks.csv"], &folder);
    pairs.retain(|p| only.as_ref().is_none_or(|word| p.to_string_lossy().contains(word)));
    if perturb > 0 {
        println!(
            "Landmarks moved to a neighbouring vertex, {perturb} times: failures, E_L2 from to, change in the median, the greatest and its draw"
        );
        for pair in &pairs {
            shown(pair, perturbed_row(pair, perturb));
        }
        return;
    }
    println!("VORONOI, table 2 in the paper: greedy | one edge node | adaptive edge nodes");
    for (name, sizes, landmarks, [ang, l2, seconds]) in VORONOI {
        let cell = |k: usize| format!("{:6.2} {:6.3} {:7.1} s", ang[k], l2[k], seconds[k]);
        println!("{name:26} {sizes:12} {landmarks:3} | {} | {} | {}", cell(0), cell(1), cell(2));
    }
    println!("\nThe same here, E_ang, E_L2 (forward), seconds of the layout:");
    let rows: Vec<Row> = pairs.iter().filter_map(|pair| shown(pair, voronoi_row(pair))).collect();
    trends(&rows);
    println!("\nHYPOTHESIS, table 1 in the paper: earlier method | theirs, vertices after");
    for (name, sizes, landmarks, earlier, theirs, after) in HYPOTHESIS {
        println!("{name:26} {sizes:12} {landmarks:3} | {earlier:>9} s | {theirs:>6} s, {after}");
    }
    println!("\nThe same here, seconds of the layout: greedy | hypothesis, vertices after active refinement");
    for pair in &pairs {
        shown(pair, hypothesis_row(pair));
    }
}

/// Says why a row is missing.
fn shown<T>(pair: &Path, row: Result<T>) -> Option<T> {
    row.inspect_err(|error| println!("{}: {error}", name(pair))).ok()
}

fn name(pair: &Path) -> String {
    pair.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn read(pair: &Path) -> Result<Checked> {
    let file = |name: &str| pair.join(name);
    check(load(LoadOptions {
        source: file("source.obj"),
        target: file("target.obj"),
        landmarks: file("landmarks.csv"),
        target_landmarks: None,
        hint: None,
    })?)
}

/// The landmarks alone as base vertices, as in the papers, and those that boundary loops need.
fn base_vertices(checked: &Checked) -> BaseVertices {
    let [source, target] = checked.sites();
    let sets = homeo::stage::cluster::cluster(checked.meshes(), [&source, &target], &checked.guides);
    if checked.meshes()[0].conn.is_closed_and_connected() && source.len() > 2 {
        let count = source.len();
        return BaseVertices::grow(checked.meshes(), [source, target], count);
    }
    sets.into_iter().next().expect("there is a set of base vertices")
}

fn head(pair: &Path, checked: &Checked) -> String {
    let [a, b] = checked.meshes().map(|m| m.positions.len());
    format!("{:26} {:12} {:3}", name(pair), format!("{a}/{b}"), checked.landmarks.names.len())
}

/// A map whose patches are relaxed, arcs held.
fn map_within_patches(meshes: [&TriMesh; 2], layout: Layout) -> Result<Composed> {
    let (mut embedding, _) = embed(meshes, layout)?;
    stretch(&Compute::Cpu, &mut embedding)?;
    relax_patches(meshes, &mut embedding, &RelaxOptions::default());
    compose(meshes, embedding)
}

fn measure(meshes: [&TriMesh; 2], map: &SurfaceMap) -> Measures {
    let images: IdVec<VertexId, _> =
        map.images.iter().map(|p| p.map_or(glam::DVec3::ZERO, |p| p.position(meshes[1]))).collect();
    distortion(&meshes[0].faces(), &meshes[0].positions, &images, 0).forward
}

/// E_ang, E_L2 and the layout's seconds; none where there is no layout.
type Cell = Option<[f64; 3]>;

struct Row {
    landmarks: usize,
    cells: [Cell; 3],
}

fn cell(meshes: [&TriMesh; 2], layout: impl FnOnce() -> Result<Option<Layout>>) -> Result<Cell> {
    let start = Instant::now();
    let Some(layout) = layout()? else { return Ok(None) };
    let seconds = start.elapsed().as_secs_f64();
    let measures = measure(meshes, &map_within_patches(meshes, layout)?.maps[0]);
    Ok(Some([measures.e_ang, measures.e_l2, seconds]))
}

fn voronoi_row(pair: &Path) -> Result<Row> {
    let checked = read(pair)?;
    let (meshes, set) = (checked.meshes(), base_vertices(&checked));
    let greedy = || {
        Ok(match greedy_layout(meshes, &set, 1)? {
            Greedy::Complete(layout) => Some(layout),
            Greedy::Stuck(_) => None,
        })
    };
    let cells = [
        cell(meshes, greedy)?,
        cell(meshes, || published_layout(meshes, &set, 1).map(Some))?,
        cell(meshes, || published_layout(meshes, &set, 3).map(Some))?,
    ];
    let text = |cell: &Cell| match cell {
        Some([ang, l2, seconds]) => format!("{ang:6.2} {l2:6.3} {seconds:7.2} s"),
        None => format!("{:>23}", "stuck"),
    };
    let cells_text: Vec<String> = cells.iter().map(text).collect();
    println!("{} | {}", head(pair, &checked), cells_text.join(" | "));
    Ok(Row { landmarks: checked.landmarks.names.len(), cells })
}

/// What the paper says of its table, of ours.
fn trends(rows: &[Row]) {
    let ratios = |k: usize, at: usize, least: usize| -> Vec<f64> {
        let known = rows.iter().filter(|r| r.landmarks >= least);
        let mut all: Vec<f64> = known.filter_map(|r| Some(r.cells[0]?[at] / r.cells[k]?[at])).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    for (k, what) in [(1, "one edge node"), (2, "adaptive edge nodes")] {
        let (l2, seconds) = (ratios(k, 1, 0), ratios(k, 2, 20));
        let lower = l2.iter().filter(|r| **r > 1.0).count();
        println!("{what}: E_L2 below greedy's on {lower} of {} pairs", l2.len());
        if let (Some(least), Some(median)) = (seconds.first(), seconds.get(seconds.len() / 2)) {
            println!(
                "{what}: {least:.1} times as fast as greedy at least, {median:.1} in the median, 20 landmarks or more"
            );
        }
    }
    let finer = rows.iter().filter_map(|r| Some(r.cells[2]?[1] < r.cells[1]?[1]));
    let (better, all) = finer.fold((0, 0), |(better, all), is| (better + usize::from(is), all + 1));
    println!("adaptive edge nodes: E_L2 below that of one edge node on {better} of {all} pairs");
}

fn hypothesis(meshes: [&TriMesh; 2], set: &BaseVertices) -> Result<Layout> {
    Ok(guided_layouts(meshes, set, 3)?.swap_remove(0))
}

fn hypothesis_row(pair: &Path) -> Result<()> {
    let checked = read(pair)?;
    let (meshes, set) = (checked.meshes(), base_vertices(&checked));
    let start = Instant::now();
    let is_complete = matches!(greedy_layout(meshes, &set, 1)?, Greedy::Complete(_));
    let greedy = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let layout = hypothesis(meshes, &set)?;
    let ours = start.elapsed().as_secs_f64();
    let (mut embedding, _) = embed(meshes, layout)?;
    relax_arcs(&Compute::Cpu, meshes, &mut embedding, &RelaxOptions::default())?;
    let composed = compose(meshes, embedding)?;
    let after = [0, 1].map(|k| refine(meshes, &composed, k, &RefineOptions::default()).images.len());
    let greedy = if is_complete { format!("{greedy:9.2} s") } else { format!("{:>11}", "stuck") };
    println!("{} | {greedy} | {ours:6.2} s, {}/{}", head(pair, &checked), after[0], after[1]);
    Ok(())
}

/// Maps by the hypothesis layout, as `homeo map` does, with all landmarks moved to a neighbouring vertex each; nothing is drawn
/// twice the same, and nothing by the clock.
fn perturbed_row(pair: &Path, times: usize) -> Result<()> {
    let checked = read(pair)?;
    let meshes = [&checked.source.mesh, &checked.target.mesh];
    let sites = [checked.landmarks.source.clone(), checked.landmarks.target.clone()];
    let options = MapOptions { layout: LayoutMethod::Hypothesis { cycles: 1 }, ..MapOptions::default() };
    let device = Device::open(&DeviceChoice::Cpu)?;
    let e_l2 = |[source, target]: [Vec<VertexId>; 2]| -> Result<f64> {
        let landmarks = Landmarks { source, target, ..checked.landmarks.clone() };
        let [source, target] = [&checked.source.file, &checked.target.file].map(Clone::clone);
        let loaded = Loaded { source, target, landmarks: Ok(landmarks), hint: Ok(None) };
        let mut result = None;
        map_pairs(std::iter::once(loaded), &options, &device, &Silent, |outcome| result = Some(outcome.value));
        let Mapped { checked, map, .. } = result.expect("one pair has one outcome")?;
        Ok(measure([&checked.source.mesh, &checked.target.mesh], &map.maps[0]).e_l2)
    };
    let first = e_l2(sites.clone())?;
    let (mut failures, mut all) = (0, Vec::new());
    for seed in 0..times {
        let mut random = SplitMix::new(seed as u64);
        let mut moved = sites.clone();
        for (mesh, landmarks) in meshes.into_iter().zip(&mut moved) {
            nudge_landmarks(mesh, landmarks, &mut random);
        }
        match e_l2(moved) {
            Ok(x) => all.push((x, seed)),
            Err(_) => failures += 1,
        }
    }
    let change = |x: f64| 100.0 * (x / first - 1.0).abs();
    all.sort_by(|(x, _), (y, _)| change(*x).total_cmp(&change(*y)));
    let [least, most] = [f64::min, f64::max].map(|pick| all.iter().fold(first, |e, &(x, _)| pick(e, x)));
    let (median, _) = all.get(all.len() / 2).copied().unwrap_or((first, 0));
    let (greatest, draw) = all.last().copied().unwrap_or((first, 0));
    println!(
        "{} | {failures} | {first:.3}: {least:.3} to {most:.3} | {:.1} %, {:.1} % ({draw})",
        head(pair, &checked),
        change(median),
        change(greatest)
    );
    Ok(())
}
