//! A night's batch, without its files: `cargo bench --bench folder -- FOLDER [cpu|gpu|auto]`.
//!
//! Every folder below FOLDER with `source.obj`, `target.obj` and `landmarks.csv` is a pair. All are mapped at once with the
//! default options, then one after the other. Printed: for every pair its faces, the seconds that its stages took while the
//! others were in flight, and those it takes alone; and the seconds of all both ways.

mod common;

use common::folders_with;
use homeo::gpu::{Device, DeviceChoice};
use homeo::pipeline::{MapOptions, Mapped, Outcome, Silent, map_pairs};
use homeo::stage::load::{LoadOptions, Loaded, load};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The files of a pair.
const PAIR: [&str; 3] = ["source.obj", "target.obj", "landmarks.csv"];

fn read(pair: &Path) -> Option<Loaded> {
    let file = |name: &str| pair.join(name);
    let [source, target, landmarks] = PAIR.map(file);
    let loaded = load(LoadOptions { source, target, landmarks, target_landmarks: None, hint: None });
    loaded.inspect_err(|error| println!("{}: {error}", pair.display())).ok()
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let [folder, device @ ..] = &arguments[..] else {
        eprintln!("usage: cargo bench --bench folder -- FOLDER [cpu|gpu|auto]");
        return;
    };
    let choice = device.first().map_or(Ok(DeviceChoice::Auto), |name| name.parse()).expect("cpu, gpu, auto or a name");
    let device = Device::open(&choice).expect("the device opens");
    let folders = folders_with(&PAIR, Path::new(folder));
    let pairs: Vec<(PathBuf, Loaded)> = folders.into_iter().filter_map(|f| read(&f).map(|pair| (f, pair))).collect();
    let total = |outcome: &Outcome<Mapped>| outcome.seconds["total"];
    let map = |pairs: &[(PathBuf, Loaded)], take: &mut dyn FnMut(Outcome<Mapped>)| {
        let start = Instant::now();
        let loaded = pairs.iter().map(|(_, pair)| pair.clone()).collect::<Vec<_>>();
        map_pairs(loaded.into_iter(), &MapOptions::default(), &device, &Silent, take);
        start.elapsed().as_secs_f64()
    };
    let mut at_once = vec![f64::NAN; pairs.len()];
    let together = map(&pairs, &mut |outcome| at_once[outcome.id.0] = total(&outcome));
    let mut in_turn = 0.0;
    for (k, (folder, pair)) in pairs.iter().enumerate() {
        let mut result = String::new();
        let seconds = map(&pairs[k..=k], &mut |outcome| {
            result = outcome.value.map_or_else(|error| format!("  {error}"), |_| String::new());
        });
        in_turn += seconds;
        let faces = [&pair.source, &pair.target].map(|mesh| mesh.offsets.len() - 1);
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        println!(
            "{name:26} {:7}/{:7} faces {:7.2} s at once {seconds:7.2} s alone{result}",
            faces[0], faces[1], at_once[k]
        );
    }
    println!("{} pairs on {}: {together:.1} s at once, {in_turn:.1} s in turn", pairs.len(), device.description);
}
