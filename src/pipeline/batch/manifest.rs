//! Manifests: which pairs to map, as CSV, JSON lines or TOML.

use super::super::job::MapJob;
use crate::error::{Error, Result};
use crate::mesh::io::split_fields;
use serde::Deserialize;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// A job of a batch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BatchJob {
    /// Its name, and that of its folder.
    pub id: String,
    /// Its inputs; where its results go is for the batch to say.
    pub files: MapJob,
}

/// What a manifest may say of a job; also the columns of a CSV manifest.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    id: Option<String>,
    source: Option<PathBuf>,
    target: Option<PathBuf>,
    landmarks: Option<PathBuf>,
    target_landmarks: Option<PathBuf>,
    hint: Option<PathBuf>,
    texture: Option<PathBuf>,
}

/// A TOML manifest: `[defaults]` that hold for every `[[job]]` which does not say otherwise.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    #[serde(default)]
    defaults: Entry,
    job: Vec<Entry>,
}

const COLUMNS: &str = "id, source, target, landmarks, target_landmarks, hint, texture";
/// Longest id in bytes: a folder's name with what temporary ones add must stay below 255.
const LONGEST_ID: usize = 200;
/// Names in the output folder that are not jobs'.
const OWN_FILES: [&str; 4] = ["results.jsonl", "failed.jsonl", "batch.json", "batch.html"];

/// Reads a manifest; paths in it are relative to its folder. The form is told by the extension, else by the content.
///
/// # Errors
/// Input, naming the line or the job: what cannot be read, an unknown key, a path that is missing, an id that is given
/// twice or cannot be a folder's name. Whether the files are there shows when a job is begun.
pub fn read_manifest(path: &Path) -> Result<Vec<BatchJob>> {
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, &e))?;
    let text = String::from_utf8(bytes).map_err(|_| {
        Error::input("not a text file in UTF-8").file(path).remedy("give a manifest: CSV, JSON lines or TOML")
    })?;
    let folder = path.parent().unwrap_or(Path::new(""));
    parse_manifest(&text, &extension(path), folder).map_err(|e| e.file(path))
}

fn extension(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// Parses a manifest whose paths are relative to `folder`; see [`read_manifest`].
pub fn parse_manifest(text: &str, extension: &str, folder: &Path) -> Result<Vec<BatchJob>> {
    let text = text.trim_start_matches('\u{feff}');
    let entries = match extension {
        "csv" => csv(text)?,
        "jsonl" | "ndjson" => json_lines(text)?,
        "toml" => toml_document(text)?,
        _ if text.trim_start().starts_with('{') => json_lines(text)?,
        _ if text.lines().any(|line| line.trim() == "[[job]]") => toml_document(text)?,
        _ => csv(text)?,
    };
    let mut places: HashMap<String, String> = HashMap::new();
    let mut jobs = Vec::with_capacity(entries.len());
    for (place, entry) in entries {
        let job = job(entry, folder).map_err(|e| e.at(&place))?;
        if let Some(earlier) = places.insert(job.id.clone(), place.clone()) {
            let what = format!("the id \"{}\" is given twice, first in {earlier}", job.id);
            return Err(Error::input(what).at(place).remedy("give every job an id of its own"));
        }
        jobs.push(job);
    }
    if jobs.is_empty() {
        return Err(Error::input("no jobs").remedy(format!("write a row for every pair: {COLUMNS}")));
    }
    Ok(jobs)
}

/// Entries with where they stand.
type Entries = Vec<(String, Entry)>;

fn csv(text: &str) -> Result<Entries> {
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    let Some((first, header)) = lines.next() else { return Ok(Vec::new()) };
    let at = |i: usize| format!("line {}", i + 1);
    let columns = split_fields(header, ',').map_err(|e| e.at(at(first)))?;
    let mut entries = Vec::new();
    for (i, line) in lines {
        let fields = split_fields(line, ',').map_err(|e| e.at(at(i)))?;
        if fields.len() != columns.len() {
            let what = format!("{} fields where the header has {}", fields.len(), columns.len());
            return Err(Error::input(what).at(at(i)).remedy("leave fields empty, but keep the commas"));
        }
        let mut entry = Entry::default();
        for (column, field) in columns.iter().zip(fields) {
            set(&mut entry, column, field).map_err(|e| e.at(at(first)))?;
        }
        entries.push((at(i), entry));
    }
    Ok(entries)
}

/// Sets what a column says; an empty field says nothing.
fn set(entry: &mut Entry, column: &str, field: String) -> Result<()> {
    let path = |field: String| (!field.is_empty()).then(|| PathBuf::from(field));
    match column {
        "id" => entry.id = Some(field),
        "source" => entry.source = path(field),
        "target" => entry.target = path(field),
        "landmarks" => entry.landmarks = path(field),
        "target_landmarks" => entry.target_landmarks = path(field),
        "hint" => entry.hint = path(field),
        "texture" => entry.texture = path(field),
        _ => {
            let what = format!("unknown column \"{column}\"");
            return Err(Error::input(what).remedy(format!("the columns are {COLUMNS}")));
        }
    }
    Ok(())
}

fn json_lines(text: &str) -> Result<Entries> {
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let entry = |(i, line): (usize, &str)| {
        let at = format!("line {}", i + 1);
        match serde_json::from_str(line) {
            Ok(entry) => Ok((at, entry)),
            Err(e) => Err(Error::input(format!("not a job: {e}"))
                .at(at)
                .remedy(format!("write one JSON object a line; its keys are {COLUMNS}"))),
        }
    };
    lines.map(entry).collect()
}

fn toml_document(text: &str) -> Result<Entries> {
    let document: Document = toml::from_str(text).map_err(|e| {
        let line = e.span().map(|span| text[..span.start].matches('\n').count() + 1);
        Error::input(format!("not a manifest: {}", e.message().replace('\n', " ")))
            .at(line.map_or(String::new(), |line| format!("line {line}")))
            .remedy(format!("write [[job]] for every pair and [defaults] for what they share; the keys are {COLUMNS}"))
    })?;
    let Document { defaults, job } = document;
    let entry = |(i, entry): (usize, Entry)| {
        let or = |own: Option<PathBuf>, common: &Option<PathBuf>| own.or_else(|| common.clone());
        let entry = Entry {
            id: entry.id.or_else(|| defaults.id.clone()),
            source: or(entry.source, &defaults.source),
            target: or(entry.target, &defaults.target),
            landmarks: or(entry.landmarks, &defaults.landmarks),
            target_landmarks: or(entry.target_landmarks, &defaults.target_landmarks),
            hint: or(entry.hint, &defaults.hint),
            texture: or(entry.texture, &defaults.texture),
        };
        (format!("job {}", i + 1), entry)
    };
    Ok(job.into_iter().enumerate().map(entry).collect())
}

fn job(entry: Entry, folder: &Path) -> Result<BatchJob> {
    let Entry { id, source, target, landmarks, target_landmarks, hint, texture } = entry;
    let id = id.ok_or_else(|| missing("id"))?;
    check_id(&id)?;
    let required = |path: Option<PathBuf>, name: &str| path.map(|p| folder.join(p)).ok_or_else(|| missing(name));
    let optional = |path: Option<PathBuf>| path.map(|p| folder.join(p));
    let files = MapJob {
        source: required(source, "source")?,
        target: required(target, "target")?,
        landmarks: required(landmarks, "landmarks")?,
        target_landmarks: optional(target_landmarks),
        hint: optional(hint),
        texture: optional(texture),
        out: PathBuf::new(),
    };
    Ok(BatchJob { id, files })
}

fn missing(name: &str) -> Error {
    Error::input(format!("no {name}")).remedy("every job needs an id, a source, a target and landmarks")
}

/// Refuses what cannot be the name of a folder everywhere, or is hidden, or taken.
fn check_id(id: &str) -> Result<()> {
    let is_odd = |c: char| c.is_control() || "/\\:*?\"<>|".contains(c);
    let is_taken = OWN_FILES.contains(&id) || id.ends_with(".jsonl");
    let refused = id.is_empty()
        || id.len() > LONGEST_ID
        || id.starts_with('.')
        || id.ends_with(['.', ' '])
        || id.contains(is_odd)
        || is_taken;
    if !refused {
        return Ok(());
    }
    Err(Error::input(format!("the id \"{}\" cannot name a folder", id.escape_debug()))
        .remedy("use letters, digits, - and _, not starting with a dot, and no more than 200 bytes"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ids(text: &str, form: &str) -> Vec<String> {
        let jobs = parse_manifest(text, form, Path::new("scans")).expect("a manifest");
        jobs.into_iter().map(|job| job.id).collect()
    }

    #[test]
    fn the_three_forms_say_the_same() {
        let csv = "id,source,target,landmarks,texture\na,t.obj,a.obj,l.csv,skin.png\n\"b\",t.obj,b.obj,l.csv,\n";
        let lines = "{\"id\":\"a\",\"source\":\"t.obj\",\"target\":\"a.obj\",\"landmarks\":\"l.csv\",\"texture\":\"skin.png\"}\n\n\
                     {\"id\":\"b\",\"source\":\"t.obj\",\"target\":\"b.obj\",\"landmarks\":\"l.csv\"}\n";
        let toml = "[defaults]\nsource = \"t.obj\"\nlandmarks = \"l.csv\"\n[[job]]\nid = \"a\"\ntarget = \"a.obj\"\n\
                    texture = \"skin.png\"\n[[job]]\nid = \"b\"\ntarget = \"b.obj\"\n";
        let read = |text, form| parse_manifest(text, form, Path::new("scans")).expect("a manifest");
        let jobs = read(csv, "csv");
        assert_eq!(jobs[0].files.texture, Some(PathBuf::from("scans/skin.png")));
        assert_eq!(jobs[1].files.texture, None);
        for (text, form) in [(lines, "jsonl"), (toml, "toml"), (csv, ""), (lines, "txt"), (toml, "")] {
            assert_eq!(read(text, form), jobs, "{form}");
        }
    }

    #[test]
    fn absolute_paths_stay() {
        let jobs = parse_manifest("id,source,target,landmarks\na,/t.obj,b.obj,l.csv\n", "csv", Path::new("scans"));
        assert_eq!(jobs.expect("a manifest")[0].files.source, Path::new("/t.obj"));
    }

    #[test]
    fn comments_blank_lines_and_byte_order_marks_do_no_harm() {
        let text = "\u{feff}id,source,target,landmarks\r\n# the horses\r\n\r\na,s,t,l\r\n";
        assert_eq!(ids(text, "csv"), ["a"]);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        let header = "id,source,target,landmarks";
        let cases: [(String, &str, &[&str]); 12] = [
            (format!("{header}\na,s,t,l\na,s,t,l\n"), "csv", &["\"a\" is given twice", "line 2", "line 3"]),
            (format!("{header}\na,s,t\n"), "csv", &["3 fields", "line 2"]),
            ("id,src\na,s\n".into(), "csv", &["unknown column \"src\"", "line 1"]),
            (format!("{header}\na,s,,l\n"), "csv", &["no target", "line 2"]),
            (format!("{header}\n../a,s,t,l\n"), "csv", &["cannot name a folder", "line 2"]),
            (format!("{header}\n.hidden,s,t,l\n"), "csv", &["cannot name a folder"]),
            (format!("{header}\nresults.jsonl,s,t,l\n"), "csv", &["cannot name a folder"]),
            (format!("{header}\n\"a,s,t,l\n"), "csv", &["quote is not closed", "line 2"]),
            (header.into(), "csv", &["no jobs"]),
            ("{\"id\":\"a\",\"from\":\"x\"}".into(), "jsonl", &["unknown field `from`", "line 1"]),
            ("[[job]]\nid = 3\n".into(), "toml", &["not a manifest", "line 2"]),
            ("[[job]]\nid = \"a\"\nsource = \"s\"\n".into(), "toml", &["no target", "job 1"]),
        ];
        for (text, form, words) in cases {
            let error = parse_manifest(&text, form, Path::new("")).expect_err(&text).to_string();
            for word in words {
                assert!(error.contains(word), "{text:?}: no {word:?} in: {error}");
            }
        }
    }
}
