//! Object File Format (OFF) reader, ASCII and binary, with the optional normals (N), colours (C) and texture coordinates (ST).
//!
//! Source: Geomview manual, "OFF: Object File Format".

use super::mesh_file::MeshFile;
use super::off_binary;
use super::scan::{Scanned, Scanner};
use crate::Result;
use glam::{DVec2, DVec3};

/// Most numbers after a vertex's position: normal, colour with alpha, texture coordinates.
const MOST_EXTRA: usize = 9;
/// Remedy for files that end early.
const CUT: &str = "the file is cut short: export it again";

/// What the prefix of the keyword promises for every vertex.
pub(super) struct Header {
    pub texture: bool,
    pub colors: bool,
    pub normals: bool,
}

/// Parses an OFF file.
pub(super) fn parse(bytes: &[u8]) -> Result<MeshFile> {
    let mut scan = Scanner::new(bytes);
    let header = parse_header(&mut scan)?;
    if scan.peek_field() == Some(b"BINARY") {
        scan.field();
        scan.end_line("BINARY")?;
        scan.take(b'\n');
        return off_binary::parse(bytes, scan.position(), &header);
    }
    expect_line(&mut scan, "the counts")?;
    let vertices = scan.count("vertex count")?;
    let faces = scan.count("face count")?;
    if scan.more() {
        scan.count("edge count")?; // redundant, often wrong, and never needed
    }
    scan.end_line("the counts")?;
    let mut mesh = MeshFile::default();
    for v in 0..vertices {
        expect_line(&mut scan, &format!("vertex {v} of {vertices}"))?;
        parse_vertex(&mut scan, &header, &mut mesh)?;
    }
    for f in 0..faces {
        expect_line(&mut scan, &format!("face {f} of {faces}"))?;
        parse_face(&mut scan, f, vertices, &mut mesh)?;
    }
    if scan.next_line() {
        return Err(scan.malformed("more lines than the counts announce", "correct the counts at the top").into());
    }
    mesh.uv.spread(&mesh.corners);
    mesh.normals.spread(&mesh.corners);
    Ok(mesh)
}

/// The keyword `[ST][C][N]OFF`; the counts may stand on its line.
fn parse_header(scan: &mut Scanner) -> Scanned<Header> {
    scan.next_line();
    let word = scan.field().unwrap_or_default();
    let Some(prefix) = word.strip_suffix(b"OFF") else {
        return Err(scan.malformed("the file does not start with OFF", "is this an OFF file?"));
    };
    let (texture, rest) = strip(prefix, b"ST");
    let (colors, rest) = strip(rest, b"C");
    let (normals, rest) = strip(rest, b"N");
    if !rest.is_empty() {
        return Err(scan.malformed("this kind of OFF is not supported", "export it as OFF in three dimensions"));
    }
    Ok(Header { texture, colors, normals })
}

fn strip<'a>(text: &'a [u8], prefix: &[u8]) -> (bool, &'a [u8]) {
    text.strip_prefix(prefix).map_or((false, text), |rest| (true, rest))
}

fn expect_line(scan: &mut Scanner, what: &str) -> Scanned<()> {
    if scan.next_line() { Ok(()) } else { Err(scan.malformed(format!("the file ends where {what} should stand"), CUT)) }
}

/// `x y z [nx ny nz] [r g b [a]] [s t]`.
fn parse_vertex(scan: &mut Scanner, header: &Header, mesh: &mut MeshFile) -> Scanned<()> {
    mesh.positions.push(DVec3::from_array(scan.numbers("coordinate")?));
    if header.normals {
        mesh.normals.values.push(DVec3::from_array(scan.numbers("normal component")?));
    }
    let mut extra = [0.0; MOST_EXTRA];
    let mut n = 0;
    while n < MOST_EXTRA && scan.more() {
        extra[n] = scan.number("vertex attribute")?;
        n += 1;
    }
    scan.end_line("the vertex")?;
    if header.texture {
        if n < 2 {
            return Err(scan.malformed("no texture coordinates at this vertex", "STOFF needs them at every vertex"));
        }
        mesh.uv.values.push(DVec2::new(extra[n - 2], extra[n - 1]));
    }
    Ok(())
}

/// `n v1 .. vn [colour]`.
fn parse_face(scan: &mut Scanner, face: u32, vertices: u32, mesh: &mut MeshFile) -> Scanned<()> {
    let n = scan.count("corner count")?;
    if n < 3 {
        return Err(scan.malformed(format!("face {face} has {n} corners"), "a face needs at least three"));
    }
    let mut corners = Vec::with_capacity(n.min(16) as usize); // n is not to be trusted before the line is read
    for _ in 0..n {
        let v = scan.count("vertex index")?;
        if v >= vertices {
            let what = format!("face {face} names vertex {v}, the file has {vertices}");
            return Err(scan.malformed(what, "OFF counts vertices from 0; the counts at the top may be wrong"));
        }
        corners.push(v);
    }
    scan.rest(); // a colour in any of the notations
    mesh.push_polygon(corners);
    Ok(())
}
