//! What was typed after `homeo batch`.

use crate::cli::args::MapFlags;
use crate::pipeline::batch::shard::Shard;
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use std::time::Duration;

#[derive(Args, Debug)]
pub struct BatchArgs {
    /// The pairs: CSV or JSON lines with id, source, target, landmarks and, if you like, target_landmarks, hint, texture; or
    /// TOML with [defaults] and a [[job]] for each. Paths are relative to the manifest's folder
    #[arg(required_unless_present = "merge", conflicts_with = "merge")]
    pub manifest: Option<PathBuf>,
    /// Folder for the results: DIR/ID/ for each job, results.jsonl, failed.jsonl. Run again with the same folder, it skips
    /// the jobs that are done and whose inputs, options and version are the same
    #[arg(long, value_name = "DIR", required_unless_present = "merge", conflicts_with = "merge")]
    pub out: Option<PathBuf>,
    /// Do only the I-th of N parts; which part a job belongs to depends on its id alone
    #[arg(long, value_name = "I/N", value_parser = shard)]
    pub shard: Option<Shard>,
    /// Begin no further job once N have failed; default: failures never stop the others
    #[arg(long, value_name = "N", value_parser = at_least_one)]
    pub max_fail: Option<usize>,
    /// Give up a job that is worked on for so many seconds: between stages, or within a second or so while it is relaxed
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub timeout: Option<Duration>,
    /// Memory for the jobs in flight, as 800M or 4G; default: half of what there is
    #[arg(long, value_name = "BYTES", value_parser = bytes)]
    pub memory: Option<u64>,
    /// Do not run, but write a plan into DIR by which Dask, Slurm or an Open Job Description engine runs the shards
    #[arg(long, value_name = "ENGINE", requires = "shards", conflicts_with = "shard")]
    pub plan: Option<EngineChoice>,
    /// Parts of the plan
    #[arg(long, value_name = "N", requires = "plan", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub shards: Option<u32>,
    /// Check that every job of the batch in DIR was done exactly once, and join the results of its shards
    #[arg(long, value_name = "DIR")]
    pub merge: Option<PathBuf>,
    #[command(flatten)]
    pub options: MapFlags,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum EngineChoice {
    /// A Python program for Dask distributed
    Dask,
    /// An array script for sbatch
    Slurm,
    /// A template for engines that read Open Job Description
    Openjd,
}

fn shard(text: &str) -> Result<Shard, String> {
    text.parse().map_err(|e: crate::Error| e.remedy)
}

fn at_least_one(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|&n| n > 0).ok_or_else(|| "use a whole number from 1 on".to_owned())
}

fn seconds(text: &str) -> Result<Duration, String> {
    let given = text.parse().ok().filter(|&s: &f64| s > 0.0).and_then(|s| Duration::try_from_secs_f64(s).ok());
    given.ok_or_else(|| "use a number of seconds above 0".to_owned())
}

/// Bytes with the units that people write: K, M, G, T are powers of 1024, with or without `B` or `iB`.
fn bytes(text: &str) -> Result<u64, String> {
    let digits = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let factor = match text[digits.len()..].to_uppercase().trim_end_matches('B').trim_end_matches('I') {
        "" => Some(0),
        "K" => Some(10),
        "M" => Some(20),
        "G" => Some(30),
        "T" => Some(40),
        _ => None,
    };
    let number = digits.trim().parse::<f64>().ok().filter(|&x| x > 0.0);
    let given = number.zip(factor).map(|(x, shift)| x * (1u64 << shift) as f64).filter(|&x| x < 2f64.powi(63));
    given.map(|x| x as u64).ok_or_else(|| "use a number of bytes such as 800M or 4G".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_come_with_the_usual_units() {
        let known =
            [("1024", 1024), ("800M", 800 << 20), ("4G", 4 << 30), ("1.5g", 3 << 29), ("2GiB", 2 << 30), ("1kB", 1024)];
        for (text, expected) in known {
            assert_eq!(bytes(text), Ok(expected), "{text}");
        }
        for text in ["", "G", "-1G", "1X", "1e30T", "0", "NaN"] {
            assert!(bytes(text).is_err(), "{text}");
        }
    }

    #[test]
    fn times_are_positive() {
        assert_eq!(seconds("1.5"), Ok(Duration::from_millis(1500)));
        for text in ["0", "-1", "inf", "NaN", "soon"] {
            assert!(seconds(text).is_err(), "{text}");
        }
    }
}
