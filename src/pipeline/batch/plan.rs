//! Plans for engines that run a batch on many machines: each does the shards of one batch, `homeo` does the rest.
//!
//! All machines must see the manifest and the output folder under the same paths, and have `homeo` on their path, or where
//! the environment variable `HOMEO` says.

use crate::error::Result;
use crate::stage::write::write_file;
use std::path::{Path, PathBuf};

/// An engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Engine {
    /// Dask distributed: a Python program.
    Dask,
    /// Slurm: an array script for sbatch.
    Slurm,
    /// Open Job Description: a template, as for AWS Deadline Cloud.
    OpenJd,
}

impl Engine {
    /// The plan's file in the output folder.
    pub fn file_name(self) -> &'static str {
        match self {
            Engine::Dask => "plan_dask.py",
            Engine::Slurm => "plan_slurm.sh",
            Engine::OpenJd => "plan_openjd.yaml",
        }
    }

    fn template(self) -> &'static str {
        match self {
            Engine::Dask => include_str!("plan/dask.py"),
            Engine::Slurm => include_str!("plan/slurm.sh"),
            Engine::OpenJd => include_str!("plan/openjd.yaml"),
        }
    }
}

/// Writes the plan for `shards` parts of a batch with results in `out` into the folder `place`; `arguments` are those of `homeo` without the shard: `batch`, the
/// manifest, `--out`, the options. Returns where it is.
pub fn write_plan(engine: Engine, arguments: &[String], [place, out]: [&Path; 2], shards: u32) -> Result<PathBuf> {
    let path = place.join(engine.file_name());
    let text = plan(engine, arguments, out, shards);
    write_file(&path, |file| file.write_all(text.as_bytes()))?;
    Ok(path)
}

/// The text of a plan.
pub fn plan(engine: Engine, arguments: &[String], out: &Path, shards: u32) -> String {
    let out = out.display().to_string();
    let (arguments, out) = match engine {
        // JSON's strings are Python's and YAML's as well.
        Engine::Dask | Engine::OpenJd => (json(&arguments), json(&out)),
        Engine::Slurm => (arguments.iter().map(|a| shell_word(a)).collect::<Vec<_>>().join(" "), shell_word(&out)),
    };
    let template = engine.template();
    template.replace("@ARGUMENTS@", &arguments).replace("@OUT@", &out).replace("@SHARDS@", &shards.to_string())
}

fn json(value: &impl serde::Serialize) -> String {
    serde_json::to_string(value).expect("strings are JSON")
}

/// A word that the shell takes as it is.
fn shell_word(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-./=+,:@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn awkward_paths_stay_whole_words() {
        assert_eq!(shell_word("a/b.csv"), "a/b.csv");
        assert_eq!(shell_word("it's $HOME"), r"'it'\''s $HOME'");
        let arguments = ["batch", "my \"scans\".csv", "--out", "o'ut"].map(String::from);
        let text = plan(Engine::Dask, &arguments, Path::new("o'ut"), 8);
        assert!(text.contains(r#"["batch","my \"scans\".csv","--out","o'ut"]"#), "{text}");
        let text = plan(Engine::Slurm, &arguments, Path::new("o'ut"), 8);
        assert!(text.contains(r#"batch 'my "scans".csv' --out 'o'\''ut'"#), "{text}");
    }

    #[test]
    fn nothing_is_left_to_fill_in() {
        for engine in [Engine::Dask, Engine::Slurm, Engine::OpenJd] {
            let text = plan(engine, &["batch".to_owned()], Path::new("out"), 3);
            assert!(["@ARGUMENTS@", "@OUT@", "@SHARDS@"].iter().all(|blank| !text.contains(blank)), "{text}");
        }
    }
}
