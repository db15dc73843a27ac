//! Wavefront OBJ reader: blocks of whole lines in parallel, joined in the order of the file.

use super::mesh_file::{MeshFile, NO_INDEX, Statement};
use super::obj_block::{Block, Column, parse_block};
use super::scan::{Malformed, Scanner, blocks, quote};
use crate::mesh::VertexId;
use crate::{Error, Result};
use rayon::prelude::*;

/// Bytes per block: large enough to hide the cost of joining, small enough to keep every core busy.
const BLOCK: usize = 1 << 20;

/// Parses an OBJ file.
pub(super) fn parse(bytes: &[u8]) -> Result<MeshFile> {
    parse_in_blocks(bytes, BLOCK)
}

fn parse_in_blocks(bytes: &[u8], block: usize) -> Result<MeshFile> {
    let ranges = blocks(bytes, block);
    let parsed: Vec<_> = ranges.par_iter().map(|r| parse_block(&bytes[r.clone()])).collect();
    let mut parts = Vec::with_capacity(parsed.len());
    for (range, part) in ranges.iter().zip(parsed) {
        let breaks = || bytes[..range.start].iter().filter(|&&b| b == b'\n').count();
        parts.push(part.map_err(|m| Malformed { line: m.line + breaks(), ..m })?);
    }
    join(bytes, parts)
}

/// Joins the blocks of a file.
fn join(bytes: &[u8], mut parts: Vec<Block>) -> Result<MeshFile> {
    let mut mesh = MeshFile { offsets: offsets(&parts)?, ..MeshFile::default() };
    let mut columns: [Vec<u32>; 3] = Default::default();
    for (k, (out, name)) in columns.iter_mut().zip(["vertex", "texture coordinate", "normal"]).enumerate() {
        let (joined, count) = join_column(&mut parts, k);
        *out = joined.map_err(|corner| outside(bytes, &mesh.offsets, corner, name, count))?;
    }
    let [corners, uv, normals] = columns;
    mesh.corners = corners.into_iter().map(VertexId).collect();
    (mesh.uv.corners, mesh.normals.corners) = (uv, normals);
    let mut polygons = 0;
    for part in parts {
        mesh.positions.extend(part.positions);
        mesh.uv.values.extend(part.uv);
        mesh.normals.values.extend(part.normals);
        mesh.material_libraries.extend(part.material_libraries);
        mesh.statements.extend(part.statements.into_iter().map(|s| Statement { polygon: s.polygon + polygons, ..s }));
        polygons += part.ends.len();
    }
    Ok(mesh)
}

/// Where each polygon's corners start in the whole file, and the end.
fn offsets(parts: &[Block]) -> Result<Vec<u32>> {
    let corners: usize = parts.iter().map(Block::corner_count).sum();
    if corners >= u32::MAX as usize {
        return Err(Error::input("more face corners than 32-bit indices can number").remedy("split the mesh"));
    }
    let mut offsets = Vec::with_capacity(1 + parts.iter().map(|p| p.ends.len()).sum::<usize>());
    offsets.push(0);
    let mut base = 0;
    for part in parts {
        offsets.extend(part.ends.iter().map(|end| base + end));
        base += part.corner_count() as u32;
    }
    Ok(offsets)
}

/// Joins index column `k` and makes negative indices absolute; also counts the elements it indexes.
///
/// Fails with the first corner whose index is out of range. A column that is never used stays empty.
fn join_column(parts: &mut [Block], k: usize) -> (std::result::Result<Vec<u32>, usize>, usize) {
    let mut joined = Vec::new();
    let (mut corners, mut elements) = (0, 0);
    let mut bad = usize::MAX;
    for part in parts {
        let (corner_count, element_count) = (part.corner_count(), part.element_count(k));
        let Column { mut indices, relative } = std::mem::take(&mut part.columns[k]);
        for r in relative {
            match u32::try_from(elements as i64 + r.offset) {
                Ok(index) => indices[r.corner] = index,
                Err(_) => bad = bad.min(corners + r.corner),
            }
        }
        if !indices.is_empty() {
            joined.resize(corners, NO_INDEX);
            joined.append(&mut indices);
        }
        corners += corner_count;
        elements += element_count;
    }
    if !joined.is_empty() {
        joined.resize(corners, NO_INDEX);
    }
    let outside = joined.iter().position(|&i| i != NO_INDEX && i as usize >= elements);
    bad = bad.min(outside.unwrap_or(usize::MAX));
    (if bad == usize::MAX { Ok(joined) } else { Err(bad) }, elements)
}

/// The error for a corner that refers to nothing; finds its line by reading the file again.
fn outside(bytes: &[u8], offsets: &[u32], corner: usize, name: &str, count: usize) -> Error {
    let polygon = offsets.partition_point(|&o| o as usize <= corner) - 1;
    let mut scan = Scanner::new(bytes);
    let mut faces = 0;
    while scan.next_line() {
        if scan.field() != Some(b"f") {
            scan.rest();
        } else if faces < polygon {
            faces += 1;
            scan.rest();
        } else {
            break;
        }
    }
    let line = scan.line();
    let text = (offsets[polygon] as usize..=corner).filter_map(|_| scan.field()).last().unwrap_or_default();
    let what = format!("corner \"{}\" of face {polygon} names a {name} that does not exist", quote(text));
    let remedy = format!("the file has {count}, numbered from 1; it may be cut short");
    Error::input(what).at(format_args!("line {line}")).remedy(remedy)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two quads and a triangle with every kind of index, a continued line and CRLF.
    const MIXED: &str = "# head\r\nv 0 0 0\nv 1 0 0\nv 1 1 0 # c\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\n\
        f 1/1/1 2/2/1 \\\n 3//1 4\ng second\nv 0 0 1\nf -1 -5/-1 2\nvt 0 1\nf 5/3 -2/-2 1 2//-1\n";

    #[test]
    fn any_block_size_gives_the_same_mesh() {
        let whole = parse(MIXED.as_bytes()).expect("MIXED is valid");
        assert_eq!(whole.positions.len(), 5);
        assert_eq!(whole.corners.iter().map(|v| v.0).collect::<Vec<_>>(), [0, 1, 2, 3, 4, 0, 1, 4, 3, 0, 1]);
        let none = NO_INDEX;
        assert_eq!(whole.uv.corners, [0, 1, none, none, none, 1, none, 2, 1, none, none]);
        assert_eq!(whole.statements[0].polygon, 1);
        for size in 1..MIXED.len() {
            assert_eq!(
                parse_in_blocks(MIXED.as_bytes(), size).expect("valid in any blocks"),
                whole,
                "blocks of {size}"
            );
        }
    }

    #[test]
    fn any_block_size_gives_the_same_error() {
        let line = MIXED.lines().count() + 1;
        for bad in ["f 1 2 x", "f 1 2 9", "f 1 2 -6", "f 1 2", "v 1 2", "vn 0 0 inf", "what"] {
            let text = format!("{MIXED}{bad}\n# end\n");
            for size in 1..text.len() {
                let error = parse_in_blocks(text.as_bytes(), size).expect_err(bad);
                assert_eq!(error.element, format!("line {line}"), "{bad} in blocks of {size}: {error}");
            }
        }
    }
}
