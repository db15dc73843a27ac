//! Landmarks of which one mesh has the mirror image: they ask for a map that turns the surface over.

use crate::mesh::TriMesh;
use crate::mesh::io::Landmarks;
use crate::path::handedness::{Handedness, Verdict};
use crate::{Error, Result};

/// How to mend it.
const EXCHANGE: &str = "left and right seem swapped on one of the meshes: exchange them";

/// Refuses landmarks that are surely mirrored; returns a warning if they look so and may yet be right.
pub fn refuse_mirrored(meshes: [&TriMesh; 2], landmarks: &Landmarks) -> Result<Option<String>> {
    let seen = Handedness::compare(meshes, [&landmarks.source, &landmarks.target]);
    let count = format!("around {} landmarks", seen.compared);
    match seen.verdict() {
        Verdict::Alike => Ok(None),
        Verdict::Doubtful => Ok(Some(format!(
            "the landmarks may be mirrored: {count} their neighbours follow in reverse order; {EXCHANGE}"
        ))),
        Verdict::Mirrored => Err(Error::unsolvable("the landmarks of the target mirror those of the source")
            .file(&landmarks.path)
            .at(format_args!("{count} their neighbours follow in reverse order"))
            .remedy(EXCHANGE)),
    }
}
