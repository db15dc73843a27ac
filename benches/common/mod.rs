//! What several benches need.

use std::path::{Path, PathBuf};

/// All folders at and below one that hold files of these names, in order.
pub fn folders_with(names: &[&str], folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_owned()];
    while let Some(folder) = open.pop() {
        let entries = std::fs::read_dir(&folder).into_iter().flatten().flatten();
        open.extend(entries.map(|entry| entry.path()).filter(|path| path.is_dir()));
        if names.iter().all(|name| folder.join(name).is_file()) {
            found.push(folder);
        }
    }
    found.sort();
    found
}
