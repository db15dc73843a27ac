//! How much memory a job will need, told before it is begun from the sizes of its files.
//!
//! An estimate from above: a job that needs more than it was let in for breaks the bound that the user set.

use super::inputs::files_behind;
use super::job::{MapJob, MapOptions, Relaxation};
use crate::stage::simplify::{ENOUGH, WORTHWHILE};
use std::path::Path;

/// Memory at its peak for every face of both meshes: 4.3 to 5.2 KB were measured on pairs of 13k to 53k faces.
const BYTES_PER_FACE: u64 = 5_500;
/// The same for every face beyond those of the largest pair that is not mapped by way of simple meshes; see the test.
const BYTES_PER_FACE_MORE: u64 = 1_600;
/// What a job needs beside its meshes, such as buffers of the writers.
const BYTES_PER_JOB: u64 = 16 << 20;
/// Geometry images, for every sample of a tile: about 30 tiles of two meshes' positions and normals with their files.
const BYTES_PER_SAMPLE: u64 = 30 * 200;
/// A picture's texels in memory against its compressed file.
const PICTURE_GROWTH: u64 = 40;

/// Bytes of memory that a job will need at its peak, about; what cannot be read needs nothing but the job's own.
pub fn footprint(job: &MapJob, options: &MapOptions) -> u64 {
    let is_simplified = options.relax == Relaxation::Full && job.hint.is_none();
    let meshes = bytes_for(faces_in(&job.source) + faces_in(&job.target), is_simplified);
    let samples = (options.image * options.image) as u64;
    let picture = job.texture.as_deref().map_or(0, size_of_files);
    BYTES_PER_JOB + meshes + samples * BYTES_PER_SAMPLE + picture * PICTURE_GROWTH
}

/// Bytes for so many faces of both meshes, if large ones are mapped by way of simple meshes or as they are.
fn bytes_for(faces: u64, is_simplified: bool) -> u64 {
    // Twice as many faces as vertices.
    let large = if is_simplified { (2.0 * WORTHWHILE * 2.0 * ENOUGH as f64) as u64 } else { u64::MAX };
    faces.min(large) * BYTES_PER_FACE + faces.saturating_sub(large) * BYTES_PER_FACE_MORE
}

/// Faces that a mesh file of this size can hold at most, roughly.
fn faces_in(path: &Path) -> u64 {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
    // Half a vertex and one face in each format's leanest usual form.
    let bytes_per_face = match extension.as_str() {
        "obj" => 32,
        "off" => 30,
        "stl" => 50,
        _ => 18,
    };
    let bytes = if extension == "gltf" { size_of_files(path) } else { size_of_file(path) };
    bytes / bytes_per_face
}

/// Of a file with those it refers to.
fn size_of_files(path: &Path) -> u64 {
    files_behind(path).unwrap_or_default().iter().map(|file| size_of_file(file)).sum()
}

fn size_of_file(path: &Path) -> u64 {
    std::fs::metadata(path).map_or(0, |data| data.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Faces of both meshes and MiB at the peak, of large generated pairs (`--bench scale`) and of a horse and a camel with
    /// their images.
    const MEASURED: [(u64, u64); 4] = [(183_524, 361), (544_672, 801), (583_542, 826), (1_854_544, 2_374)];

    #[test]
    fn the_estimate_is_above_what_was_measured_and_not_far() {
        for (faces, mib) in MEASURED {
            let estimate = (BYTES_PER_JOB + bytes_for(faces, true)) >> 20;
            assert!(estimate >= mib, "{estimate} MiB for {faces} faces, {mib} measured");
            assert!(estimate <= 2 * mib, "{estimate} MiB for {faces} faces, {mib} measured");
        }
    }
}
