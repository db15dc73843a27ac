//! Maps random pairs and counts what became of them.
//!
//! `cargo run --release --example sweep -- 500 [--genus LOW-HIGH] [--loops LOW-HIGH] [--seed FIRST]`
//!
//! Every pair has a number of its own, from FIRST on, that decides all about it: genus (0 to 3 unless told otherwise),
//! boundary loops (none unless told otherwise), 3 to 60 landmarks, 1,000 to 20,000 triangles a mesh. The landmarks of
//! four pairs in five correspond; those of the fifth are scattered on either mesh without regard to the other. Failures
//! are printed with their numbers, so that `-- 1 --seed N` repeats one. The exit code is 1 if there was any.

use homeo::gpu::{Device, DeviceChoice};
use homeo::mesh::SurfacePoint;
use homeo::pipeline::{MapOptions, Mapped, Outcome, Silent, map_pairs};
use homeo::shape::{PairOptions, RandomPair, SplitMix, random_pair};
use homeo::stage::load::Loaded;
use homeo::{Error, ErrorKind};
use std::ops::RangeInclusive;
use std::process::ExitCode;
use std::time::Instant;

/// Landmarks of a pair.
const LANDMARKS: RangeInclusive<usize> = 3..=60;
/// Vertices of a mesh: half its triangles.
const VERTICES: (f64, f64) = (500.0, 10_000.0);
/// One pair in so many has unrelated landmarks.
const SCATTERED: usize = 5;

/// What to run.
struct Sweep {
    count: u64,
    first: u64,
    genus: RangeInclusive<usize>,
    loops: RangeInclusive<usize>,
}

fn main() -> ExitCode {
    let Some(sweep) = parse(std::env::args().skip(1)) else {
        eprintln!("usage: sweep COUNT [--genus LOW-HIGH] [--loops LOW-HIGH] [--seed FIRST]");
        return ExitCode::from(ErrorKind::Usage.exit_code());
    };
    match run(&sweep) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(e) => {
            eprintln!("error: {e}");
            ExitCode::from(e.kind.exit_code())
        }
    }
}

fn parse(mut args: impl Iterator<Item = String>) -> Option<Sweep> {
    let mut sweep = Sweep { count: args.next()?.parse().ok()?, first: 0, genus: 0..=3, loops: 0..=0 };
    while let Some(flag) = args.next() {
        let value = args.next()?;
        match flag.as_str() {
            "--genus" => sweep.genus = range(&value)?,
            "--loops" => sweep.loops = range(&value)?,
            "--seed" => sweep.first = value.parse().ok()?,
            _ => return None,
        }
    }
    Some(sweep)
}

/// `2` or `0-3`.
fn range(text: &str) -> Option<RangeInclusive<usize>> {
    let (low, high) = text.split_once('-').unwrap_or((text, text));
    Some(low.parse().ok()?..=high.parse().ok()?)
}

/// Runs all pairs; the number of failures.
fn run(sweep: &Sweep) -> Result<usize, Error> {
    let device = Device::open(&DeviceChoice::Cpu)?;
    let started = Instant::now();
    let (mut successes, mut refusals, mut failures) = (0, 0, 0);
    let seeds = sweep.first..sweep.first + sweep.count;
    let pairs = seeds.map(|seed| {
        let RandomPair { meshes, landmarks } = random_pair(&draw(sweep, seed), seed);
        Loaded::of([&meshes[0], &meshes[1]], [&landmarks[0], &landmarks[1]])
    });
    map_pairs(pairs, &MapOptions::default(), &device, &Silent, |Outcome { id, value, seconds, .. }| {
        let seed = sweep.first + id.0 as u64;
        let what = draw(sweep, seed);
        let seconds = seconds.get("total").copied().unwrap_or_default();
        let fault = match &value {
            Ok(mapped) => fault(mapped),
            Err(e) if e.kind == ErrorKind::Unsolvable => {
                refusals += 1;
                println!("pair {seed} refused after {seconds:.1} s: {e}; {what:?}");
                return;
            }
            Err(e) => Some(e.to_string()),
        };
        match fault {
            None => successes += 1,
            Some(fault) => {
                failures += 1;
                println!("pair {seed} FAILED after {seconds:.1} s: {fault}; {what:?}");
            }
        }
    });
    let seconds = started.elapsed().as_secs_f64();
    println!(
        "{} pairs: {successes} / {refusals} / {failures} mapped / refused / failed in {seconds:.0} s",
        sweep.count
    );
    Ok(failures)
}

/// The options of a pair.
fn draw(sweep: &Sweep, seed: u64) -> PairOptions {
    let mut random = SplitMix::new(seed ^ 0x5eed);
    let mut within = |range: &RangeInclusive<usize>| range.start() + random.below(range.end() - range.start() + 1);
    let (genus, loops, landmarks) = (within(&sweep.genus), within(&sweep.loops), within(&LANDMARKS));
    let related = within(&(1..=SCATTERED)) > 1;
    let vertices = [(); 2].map(|()| (VERTICES.0 * (VERTICES.1 / VERTICES.0).powf(random.unit())) as usize);
    PairOptions { genus, loops, landmarks, vertices, related }
}

/// What is wrong with a finished map, if anything.
fn fault(mapped: &Mapped) -> Option<String> {
    if !mapped.map.certificate.bijective {
        return Some(format!("no certificate: {:?}", mapped.map.certificate));
    }
    let checked = &mapped.checked;
    let ends = [&checked.landmarks.source, &checked.landmarks.target];
    for (k, map) in mapped.map.maps.iter().enumerate() {
        for (&from, &to) in ends[k].iter().zip(ends[1 - k]) {
            if map.images[from] != Some(SurfacePoint::Vertex(to)) {
                return Some(format!("landmark at {from} went to {:?}, not to {to}", map.images[from]));
            }
        }
    }
    None
}
