//! Who may import whom: data flows down through the rooms of `src/`, and each outside crate has one door.
//!
//! Test code is exempt: a room's unit tests may use the shapes above it.

use std::collections::BTreeSet;
use std::fmt;
use std::path::{Path, PathBuf};

/// The rooms by level, lowest first. A room may import lower levels, and rooms beside it as long as those do not
/// import it in turn.
const LEVELS: [&[&str]; 9] = [
    &["error"],
    &["deadline"],
    &["mesh"],
    &["path", "plane", "solve", "gpu", "picture"],
    &["map", "kernel"],
    &["view"],
    &["stage", "app", "shape"],
    &["pipeline"],
    &["cli"],
];

/// Rooms that may import less than their level allows.
const NARROWER: [(&str, &[&str]); 3] = [
    ("shape", &["error", "mesh"]),
    ("map", &["error", "mesh", "path", "plane", "solve"]),
    ("view", &["error", "mesh", "picture", "map"]),
];

/// Outside crates and the parts of `src/` that may name them.
const DOORS: [(&str, &[&str]); 18] = [
    ("wgpu", &["gpu"]),
    ("pollster", &["gpu"]),
    ("naga", &["gpu"]),
    ("crossbeam", &["pipeline"]),
    ("clap", &["cli"]),
    ("indicatif", &["cli"]),
    ("crc32fast", &["map"]),
    ("exr", &["stage", "picture"]),
    ("image", &["picture"]),
    ("postcard", &["map"]),
    ("tobj", &["mesh/io"]),
    ("gltf_json", &["mesh/io/gltf"]),
    ("kiddo", &["app/diffusion"]),
    ("blake3", &["pipeline/batch"]),
    ("ctrlc", &["cli/batch"]),
    ("object_store", &["pipeline/batch/store"]),
    ("tokio", &["pipeline/batch/store"]),
    ("toml", &["pipeline/batch/manifest"]),
];

/// A line that breaks a rule.
#[derive(Debug, PartialEq)]
struct Breach {
    file: String,
    line: usize,
    why: String,
}

impl fmt::Display for Breach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "src/{}:{}: {}", self.file, self.line, self.why)
    }
}

#[test]
fn data_flows_down_and_crates_come_through_their_doors() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut breaches = Vec::new();
    let mut imports = BTreeSet::new();
    for path in rust_files(&root) {
        let source = std::fs::read_to_string(&path).expect("source files are readable text");
        let file = path.strip_prefix(&root).expect("files lie below the root").to_string_lossy().replace('\\', "/");
        breaches.extend(check_file(&file, &source));
        imports.extend(rooms_used(&file, &source).into_iter().map(|(_, to)| (room_of(&file).to_string(), to)));
    }
    assert!(imports.len() > 3, "the checker reads no imports: {imports:?}");
    let circles = circles(&imports);
    let report: Vec<_> = breaches.iter().map(Breach::to_string).chain(circles).collect();
    assert!(report.is_empty(), "the house rules are broken:\n{}", report.join("\n"));
}

/// All `.rs` files below a folder, in order; files that hold only tests are left out.
fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("the source folder is readable");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("its entries too").path()).collect();
    paths.sort();
    let is_test = |path: &PathBuf| path.file_stem().is_some_and(|stem| stem == "tests");
    let (folders, files): (Vec<_>, Vec<_>) = paths.into_iter().filter(|p| !is_test(p)).partition(|p| p.is_dir());
    let files = files.into_iter().filter(|p| p.extension().is_some_and(|e| e == "rs"));
    files.chain(folders.iter().flat_map(|f| rust_files(f))).collect()
}

/// The room of a file given relative to `src/`: its top folder, or its own name.
fn room_of(file: &str) -> &str {
    file.split('/').next().unwrap_or(file).trim_end_matches(".rs")
}

fn level_of(room: &str) -> Option<usize> {
    LEVELS.iter().position(|level| level.contains(&room))
}

fn check_file(file: &str, source: &str) -> Vec<Breach> {
    let breach = |line, why| Breach { file: file.to_string(), line, why };
    let rooms = rooms_used(file, source).into_iter();
    let rooms = rooms.filter_map(|(line, to)| room_fault(room_of(file), &to).map(|why| breach(line, why)));
    rooms.chain(door_faults(file, source).into_iter().map(|(line, why)| breach(line, why))).collect()
}

/// Why room `from` may not import room `to`, if so. Names that are no room (re-exports of `lib.rs`) are fine.
fn room_fault(from: &str, to: &str) -> Option<String> {
    let narrow = NARROWER.iter().find(|(room, _)| *room == from);
    let (here, there) = (level_of(from)?, level_of(to)?);
    if from == to {
        None
    } else if there > here {
        Some(format!("`{from}` imports `{to}`, which lies above it: move the shared part down, or the user up"))
    } else if let Some((_, allowed)) = narrow.filter(|(_, allowed)| !allowed.contains(&to)) {
        Some(format!("`{from}` imports `{to}`, but may use only {}", allowed.join(", ")))
    } else {
        None
    }
}

/// Rooms on one level that import each other.
fn circles(imports: &BTreeSet<(String, String)>) -> Vec<String> {
    let both = imports.iter().filter(|(a, b)| a < b && imports.contains(&(b.clone(), a.clone())));
    both.filter(|(a, b)| level_of(a).is_some() && level_of(a) == level_of(b))
        .map(|(a, b)| format!("src/{a} and src/{b} import each other: let data flow one way"))
        .collect()
}

fn door_faults(file: &str, source: &str) -> Vec<(usize, String)> {
    let text = production_code(source);
    let mut faults = Vec::new();
    for (name, doors) in DOORS {
        let inside = doors.iter().any(|door| file.strip_prefix(door).is_some_and(|rest| rest.starts_with(['/', '.'])));
        for at in text.match_indices(name).map(|(at, _)| at).filter(|&at| !inside && names_crate(&text, at, name)) {
            let doors = doors.iter().map(|door| format!("src/{door}")).collect::<Vec<_>>().join(" or ");
            faults.push((line_of(&text, at), format!("names the crate `{name}`, whose door is {doors}")));
        }
    }
    faults
}

/// True if the match at `at` is a path's first segment, or a whole `use`.
fn names_crate(text: &str, at: usize, name: &str) -> bool {
    let (before, after) = (&text[..at], &text[at + name.len()..]);
    let starts =
        !before.ends_with(|c: char| is_word(c) || c == '.') && (!before.ends_with("::") || before.ends_with(" ::"));
    let imported = before.trim_end().ends_with("use") && !after.starts_with(is_word);
    starts && (after.starts_with("::") || imported)
}

/// The rooms that production code of a file names, with line numbers: by `crate::` or by climbing with `super::`.
fn rooms_used(file: &str, source: &str) -> Vec<(usize, String)> {
    let text = production_code(source);
    let climb = "super::".repeat(depth_of(file));
    let mut found = Vec::new();
    for root in ["crate::", "homeo::", climb.as_str()].into_iter().filter(|root| !root.is_empty()) {
        for (at, _) in text.match_indices(root) {
            let before = &text[..at];
            if before.ends_with(|c: char| is_word(c) || c == ':' || c == '$') {
                continue;
            }
            found.extend(heads(&text[at + root.len()..]).into_iter().map(|head| (line_of(&text, at), head)));
        }
    }
    found
}

/// How many modules deep the items of a file lie: 0 for `lib.rs`, 1 for `mesh/mod.rs`, 2 for `mesh/id.rs`.
fn depth_of(file: &str) -> usize {
    let own = usize::from(!["lib.rs", "main.rs"].contains(&file) && !file.ends_with("/mod.rs"));
    file.matches('/').count() + own
}

/// The first segments of what follows `crate::`: one name, or those of a `{..}` group.
fn heads(rest: &str) -> Vec<String> {
    let word = |text: &str| text.trim_start().chars().take_while(|&c| is_word(c)).collect::<String>();
    let Some(group) = rest.strip_prefix('{') else { return vec![word(rest)] };
    let (mut heads, mut depth, mut start) = (Vec::new(), 0, 0);
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth > 0 => depth -= 1,
            ',' | '}' if depth == 0 => {
                heads.push(word(&group[start..at]));
                start = at + 1;
                if c == '}' {
                    break;
                }
            }
            _ => {}
        }
    }
    heads.retain(|head| !head.is_empty());
    heads
}

/// The source with comments and `#[cfg(test)]` items blanked, line numbers kept. Relies on rustfmt's layout: an item
/// ends at the first line that closes it at the indentation of its attribute.
fn production_code(source: &str) -> String {
    let mut out = String::new();
    let mut test_indent: Option<usize> = None;
    for line in source.lines() {
        let code = line.split("//").next().unwrap_or("");
        let indent = line.len() - line.trim_start().len();
        match test_indent {
            None if code.trim() == "#[cfg(test)]" => test_indent = Some(indent),
            None => out.push_str(code),
            Some(outer) if indent == outer && code.trim_end().ends_with(['}', ';']) => test_indent = None,
            Some(_) => {}
        }
        out.push('\n');
    }
    out
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn line_of(text: &str, at: usize) -> usize {
    text[..at].matches('\n').count() + 1
}

fn whys(file: &str, source: &str) -> Vec<String> {
    check_file(file, source).iter().map(Breach::to_string).collect()
}

#[test]
fn an_import_from_above_is_named_with_its_line() {
    let found = whys("mesh/io/obj.rs", "//! Reads.\n\nuse crate::stage::load;\n");
    assert_eq!(found.len(), 1);
    assert!(found[0].starts_with("src/mesh/io/obj.rs:3: `mesh` imports `stage`"), "{found:?}");
}

#[test]
fn groups_nested_paths_and_climbing_are_seen() {
    assert_eq!(whys("path/a.rs", "use crate::{\n    error::{Error, Result},\n    pipeline::Job,\n};\n").len(), 1);
    assert_eq!(whys("plane/a.rs", "fn f() -> crate::map::Map {}\n").len(), 1);
    assert_eq!(whys("plane/a.rs", "use super::super::kernel::stretch;\n").len(), 1);
    assert_eq!(whys("plane/mod.rs", "use super::kernel::stretch;\n").len(), 1);
    assert!(whys("plane/a.rs", "use super::kernel::own_submodule;\n").is_empty());
}

#[test]
fn imports_from_below_pass() {
    assert!(whys("cli/run.rs", "use crate::pipeline::run;\nuse crate::error::Result;\nuse crate::Error;\n").is_empty());
    assert!(whys("stage/embed.rs", "use crate::{map::Map, plane, mesh::{TriMesh, VertexId}};\n").is_empty());
}

#[test]
fn narrow_rooms_keep_to_their_list() {
    assert!(whys("shape/mod.rs", "use crate::path::front;\n")[0].contains("may use only error, mesh"));
    assert_eq!(whys("map/mod.rs", "use crate::gpu::Device;\n").len(), 1);
    assert!(whys("map/mod.rs", "use crate::plane::walk;\n").is_empty());
}

#[test]
fn outside_crates_are_stopped_beside_their_door() {
    assert!(whys("kernel/a.rs", "use wgpu::Buffer;\n")[0].contains("whose door is src/gpu"));
    assert_eq!(whys("mesh/obj.rs", "let x = tobj::load();\n").len(), 1);
    assert_eq!(whys("stage/a.rs", "use indicatif as bars;\n").len(), 1);
    assert!(whys("mesh/io/mtl.rs", "use tobj;\n").is_empty());
    assert!(whys("gpu/device.rs", "let x = pollster::block_on(y);\n").is_empty());
    assert!(whys("kernel/a.rs", "use crate::gpu::exr::x; let wgpu_like = my_wgpu::f();\n").is_empty());
}

#[test]
fn comments_and_test_items_are_exempt() {
    let tests = "#[cfg(test)]\nmod tests {\n    use crate::shape::fixture;\n}\n";
    assert!(whys("path/a.rs", &format!("// like crate::cli\n{tests}")).is_empty());
    assert_eq!(
        whys("path/a.rs", &format!("{tests}use crate::shape::fixture;\n")),
        ["src/path/a.rs:5: `path` imports `shape`, which lies above it: move the shared part down, or the user up"]
    );
}

#[test]
fn rooms_side_by_side_may_not_import_each_other() {
    let pair = |a: &str, b: &str| (a.to_string(), b.to_string());
    assert!(circles(&BTreeSet::from([pair("path", "plane")])).is_empty());
    assert_eq!(circles(&BTreeSet::from([pair("path", "plane"), pair("plane", "path")])).len(), 1);
}
