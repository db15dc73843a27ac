//! How much memory a job will need, told before it is begun from the sizes of its files.
//!
//! An estimate from above: a job that needs more than it was let in for breaks the bound that the user set.

use super::inputs::files_behind;
use super::job::{MapJob, MapOptions};
use std::path::Path;

/// Memory at its peak for every face of both meshes: 4.3 to 5.2 KB were measured on pairs of 13k to 53k faces.
const BYTES_PER_FACE: u64 = 5_500;
/// What a job needs beside its meshes, such as buffers of the writers.
const BYTES_PER_JOB: u64 = 16 << 20;
/// Geometry images, for every sample of a tile: about 30 tiles of two meshes' positions and normals with their files.
const BYTES_PER_SAMPLE: u64 = 30 * 200;
/// A picture's texels in memory against its compressed file.
const PICTURE_GROWTH: u64 = 40;

/// Bytes of memory that a job will need at its peak, about; what cannot be read needs nothing but the job's own.
pub fn footprint(job: &MapJob, options: &MapOptions) -> u64 {
    let faces = faces_in(&job.source) + faces_in(&job.target);
    let samples = (options.image * options.image) as u64;
    let picture = job.texture.as_deref().map_or(0, size_of_files);
    BYTES_PER_JOB + faces * BYTES_PER_FACE + samples * BYTES_PER_SAMPLE + picture * PICTURE_GROWTH
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
