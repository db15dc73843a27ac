//! `homeo batch`: many maps, streamed.

pub mod args;
mod progress;
mod summary;

use super::args::Global;
use super::console::Console;
use super::map::options;
use crate::error::{Error, Result};
use crate::gpu::{Device, DeviceChoice};
use crate::pipeline::batch::ledger::Closed;
use crate::pipeline::batch::manifest::read_manifest;
use crate::pipeline::batch::merge::merge;
use crate::pipeline::batch::page::write_page;
use crate::pipeline::batch::plan::{Engine, write_plan};
use crate::pipeline::batch::shelf::Shelf;
use crate::pipeline::batch::{BatchOptions, BatchResult, run_batch};
use crate::pipeline::{MapOptions, PageOptions};
use args::{BatchArgs, EngineChoice};
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use summary::{Summary, summary_text};

/// The exit code of a batch that finished with failed jobs.
const FAILED_JOBS: u8 = 6;
/// The exit code of a batch that was interrupted, as shells have it for a program that ends by Ctrl-C.
const INTERRUPTED: u8 = 130;

/// Runs the command; `arguments` is what was typed, the program's name first.
pub fn run(args: &BatchArgs, arguments: &[OsString], global: &Global, console: &Console) -> Result<ExitCode> {
    if let Some(out) = &args.merge {
        let shelf = Shelf::open(out)?;
        let rows = merge(&shelf)?;
        if !global.no_report {
            write_page(&shelf, &out.to_string_lossy(), &rows)?;
        }
        let ended = rows.iter().map(|row| row.id.clone()).collect();
        let (jobs, stage_seconds) = (rows.len(), BTreeMap::new());
        return Ok(report(&BatchResult { jobs, closed: Closed { rows, ended }, stage_seconds }, out, console));
    }
    let (Some(manifest), Some(out)) = (&args.manifest, &args.out) else {
        return Err(Error::usage("a manifest and --out are needed").remedy("see homeo batch --help"));
    };
    let jobs = read_manifest(manifest)?;
    if let (Some(engine), Some(shards)) = (args.plan, args.shards) {
        return plan(engine, shards, [manifest, out], arguments, console);
    }
    let shelf = Shelf::open(out)?;
    let Ok(choice) = global.device.parse::<DeviceChoice>();
    let device = Device::open(&choice)?;
    let options = BatchOptions {
        map: MapOptions {
            // A job's page does not say how the batch was cut up.
            page: (!global.no_report).then(PageOptions::default),
            ..options(&args.options, global)?
        },
        shard: args.shard,
        timeout: args.timeout,
        memory: args.memory.unwrap_or_else(default_memory),
        max_fail: args.max_fail,
    };
    let stop = stop_on_interrupt()?;
    let result = {
        let observer = progress::observer(global, &jobs, options.shard);
        run_batch(&jobs, &shelf, &options, &device, observer.as_ref(), &stop)?
    };
    if !global.no_report && options.shard.is_none() {
        write_page(&shelf, &manifest.to_string_lossy(), &result.closed.rows)?;
    }
    let code = report(&result, out, console);
    Ok(if stop.load(Ordering::SeqCst) { ExitCode::from(INTERRUPTED) } else { code })
}

/// Prints the summary; the exit code says whether jobs failed.
fn report(result: &BatchResult, out: &Path, console: &Console) -> ExitCode {
    let summary = Summary::of(result);
    console.result(&summary, || summary_text(&summary, out, console));
    if summary.failed > 0 { ExitCode::from(FAILED_JOBS) } else { ExitCode::SUCCESS }
}

fn plan(
    engine: EngineChoice,
    shards: u32,
    [manifest, out]: [&Path; 2],
    arguments: &[OsString],
    console: &Console,
) -> Result<ExitCode> {
    let engine = match engine {
        EngineChoice::Dask => Engine::Dask,
        EngineChoice::Slurm => Engine::Slurm,
        EngineChoice::Openjd => Engine::OpenJd,
    };
    let absolute = |path: &Path| std::path::absolute(path).map_err(|e| Error::io(path, &e));
    let is_address = out.to_string_lossy().contains("://");
    let whole_out = if is_address { out.to_owned() } else { absolute(out)? };
    let (whole_manifest, place) = (absolute(manifest)?, if is_address { Path::new("") } else { &whole_out });
    let mut words = vec!["batch".to_owned(), whole_manifest.display().to_string()];
    words.extend(["--out".to_owned(), whole_out.display().to_string()]);
    words.extend(options_typed(arguments, manifest));
    let path = write_plan(engine, &words, [place, &whole_out], shards)?;
    console.result(&serde_json::json!({ "plan": path }), || format!("plan for {shards} shards: {}\n", path.display()));
    Ok(ExitCode::SUCCESS)
}

/// What was typed, without the program, the command, the manifest, and the flags that the plan has its own of.
fn options_typed(arguments: &[OsString], manifest: &Path) -> Vec<String> {
    let mut rest = arguments.iter().skip(1).map(|word| word.to_string_lossy().into_owned()).peekable();
    let (mut kept, mut is_named, mut is_given) = (Vec::new(), false, false);
    while let Some(word) = rest.next() {
        let own = ["--out", "--plan", "--shards"];
        if own.contains(&word.as_str()) {
            rest.next();
        } else if own.iter().any(|flag| word.strip_prefix(flag).is_some_and(|value| value.starts_with('='))) {
            continue;
        } else if !is_named && word == "batch" {
            is_named = true;
        } else if !is_given && is_named && Path::new(&word) == manifest {
            is_given = true;
        } else {
            kept.push(word);
        }
    }
    kept
}

/// Half of what the system says is there, or lets this process have; without a word from it four gigabytes.
fn default_memory() -> u64 {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let number = |text: String| text.trim().parse::<u64>().ok();
    let in_all = |text: String| {
        let line = text.lines().find_map(|line| line.strip_prefix("MemTotal:")).map(str::to_owned)?;
        Some(number(line.trim_end_matches("kB").to_owned())? * 1024)
    };
    let machine = read("/proc/meminfo").and_then(in_all);
    let groups = ["/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"];
    let bounds = groups.into_iter().filter_map(read).filter_map(number);
    bounds.chain(machine).min().map_or(4 << 30, |bytes| bytes / 2)
}

/// A flag that the first Ctrl-C sets; the second one ends the program, which loses the jobs at hand and nothing else.
fn stop_on_interrupt() -> Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = stop.clone();
    let handler = move || {
        if flag.swap(true, Ordering::SeqCst) {
            std::process::exit(i32::from(INTERRUPTED));
        }
        crate::cli::console::eprint("finishing the jobs at hand; Ctrl-C once more to end at once\n");
    };
    ctrlc::set_handler(handler).map_err(|e| Error::bug(format!("no handler for Ctrl-C: {e}")))?;
    Ok(stop)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_keeps_the_options_that_were_typed() {
        let typed = "homeo -v batch scans.csv --out o --layout greedy --plan=dask --shards 8 --timeout 60 --threads=4";
        let arguments: Vec<OsString> = typed.split(' ').map(OsString::from).collect();
        let kept = options_typed(&arguments, Path::new("scans.csv"));
        assert_eq!(kept, ["-v", "--layout", "greedy", "--timeout", "60", "--threads=4"]);
    }
}
