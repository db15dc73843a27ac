//! The way from one folder to a file in another, for references that a file takes along when it is written elsewhere.

use std::path::{Component, Path, PathBuf};

/// The name under which a file in `folder` finds the material library that a mesh file calls `name`.
///
/// Relative to `folder` with forward slashes where a way exists. Names that lead nowhere, and absolute ones, are kept.
pub fn library_from(folder: &Path, mesh: &Path, name: &str) -> String {
    let library = mesh.parent().unwrap_or(Path::new("")).join(name);
    if Path::new(name).is_absolute() || !library.is_file() {
        return name.to_owned();
    }
    way(&resolved(folder), &resolved(&library)).unwrap_or_else(|| name.to_owned())
}

/// The absolute path without links, as far as it exists.
fn resolved(path: &Path) -> PathBuf {
    let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
    path.canonicalize().unwrap_or_else(|_| match (path.parent(), path.file_name()) {
        (Some(parent), Some(name)) => resolved(parent).join(name),
        _ => path.to_owned(),
    })
}

/// Up from `from` to the common ancestor and down to `to`; None if they share no root.
fn way(from: &Path, to: &Path) -> Option<String> {
    let (mut here, mut there) = (from.components().peekable(), to.components().peekable());
    here.peek().filter(|c| there.peek() == Some(c))?;
    while here.peek().is_some() && here.peek() == there.peek() {
        here.next();
        there.next();
    }
    let up = here.map(|_| "..".to_owned());
    let down = there.map(|c: Component| c.as_os_str().to_string_lossy().into_owned());
    Some(up.chain(down).collect::<Vec<_>>().join("/"))
}

/// The libraries that an OBJ file names; of other files none.
pub fn libraries_named(bytes: &[u8]) -> impl Iterator<Item = String> {
    let lines = bytes.split(|&b| b == b'\n').filter_map(|line| line.strip_prefix(b"mtllib "));
    lines.map(|name| String::from_utf8_lossy(name).trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_lead_up_and_down() {
        for (from, to, expected) in [
            ("/data/out", "/data/cat/cat.mtl", Some("../cat/cat.mtl")),
            ("/data", "/data/cat.mtl", Some("cat.mtl")),
            ("/data/cat/out/maps", "/data/cat/cat.mtl", Some("../../cat.mtl")),
            ("/a", "/b/c.mtl", Some("../b/c.mtl")),
            ("a", "/b/c.mtl", None),
        ] {
            assert_eq!(way(Path::new(from), Path::new(to)).as_deref(), expected, "{from} {to}");
        }
    }
}
