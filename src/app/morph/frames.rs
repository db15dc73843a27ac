//! A morph as steps, an OBJ file each.

use super::stem;
use crate::error::Result;
use crate::mesh::io::{MeshFile, MorphTarget, write_obj};
use crate::stage::write::write_file;
use std::path::{Path, PathBuf};

/// Least number of digits of a step's number.
const DIGITS: usize = 3;

/// One step from the source to a target.
pub struct Frame<'a> {
    /// The file.
    pub path: PathBuf,
    target: &'a MorphTarget,
    /// 0: the source, 1: the target's shape.
    time: f64,
}

/// The steps to all targets, `count` each, beside `out`: `STEM_NUMBER.obj`, with the target's name between if there are
/// several.
pub fn plan<'a>(out: &Path, targets: &'a [MorphTarget], count: usize) -> Vec<Frame<'a>> {
    let last = count.saturating_sub(1).max(1);
    let digits = DIGITS.max(last.to_string().len());
    let frame = |target: &'a MorphTarget, i: usize| {
        let name = if targets.len() > 1 { format!("_{}", target.name) } else { String::new() };
        let path = out.with_file_name(format!("{}{name}_{i:0digits$}.obj", stem(out)));
        Frame { path, target, time: i as f64 / last as f64 }
    };
    targets.iter().flat_map(|target| (0..=last).map(move |i| frame(target, i))).collect()
}

impl Frame<'_> {
    /// Writes the file: `mesh` with its texture coordinates, groups and materials, its vertices on straight ways to the
    /// target.
    pub fn write(&self, mesh: &MeshFile) -> Result<()> {
        let (t, ways) = (self.time, mesh.positions.iter().zip(&self.target.positions));
        // Exact at both ends, where one of the terms is zero.
        let positions: Vec<_> = ways.map(|(&a, &b)| a * (1.0 - t) + b * t).collect();
        let folder = self.path.parent().unwrap_or(Path::new(""));
        write_file(&self.path, |mut out| write_obj(&mut out, folder, mesh, &positions))
    }
}
