//! STL reader, ASCII and binary.
//!
//! STL repeats the corner positions in every facet and has no vertex numbers. Bit-identical positions become one vertex,
//! numbered by first appearance; a warning says so.

use super::mesh_file::MeshFile;
use super::scan::{Scanned, Scanner, quote};
use crate::{Error, Result};
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Bytes before the first facet of a binary file: a free header and the facet count.
const HEAD: usize = 84;
/// Bytes per facet of a binary file: normal, three corners, attribute.
const FACET: usize = 50;
/// Remedy for an ASCII file whose words stand in the wrong order.
const WORDS: &str = "a facet reads: facet normal, outer loop, three vertex lines, endloop, endfacet";

/// Vertices by position.
#[derive(Default)]
struct Welder {
    mesh: MeshFile,
    index: HashMap<[u64; 3], u32>,
}

impl Welder {
    fn facet(&mut self, corners: [DVec3; 3]) {
        let corners = corners.map(|p| {
            let key = p.to_array().map(|x| (x + 0.0).to_bits()); // adding zero makes -0 and 0 the same
            *self.index.entry(key).or_insert_with(|| {
                self.mesh.positions.push(p);
                self.mesh.positions.len() as u32 - 1
            })
        });
        self.mesh.push_polygon(corners);
    }

    fn finish(mut self) -> MeshFile {
        let (corners, vertices) = (self.mesh.corners.len(), self.mesh.positions.len());
        self.mesh.warnings.push(format!(
            "STL has no vertex numbers: {corners} facet corners were welded to {vertices} vertices, \
             numbered by first appearance"
        ));
        self.mesh
    }
}

/// Parses an STL file.
pub(super) fn parse(bytes: &[u8]) -> Result<MeshFile> {
    if is_binary(bytes) {
        return parse_binary(bytes);
    }
    if bytes.trim_ascii_start().starts_with(b"solid") {
        return Ok(parse_ascii(bytes)?);
    }
    let what = match announced(bytes) {
        Some(n) => {
            let needed = HEAD as u64 + FACET as u64 * u64::from(n);
            format!("a binary STL of {n} facets takes {needed} bytes, the file has {}", bytes.len())
        }
        None => "neither an ASCII nor a binary STL".to_owned(),
    };
    Err(Error::input(what).remedy("the file is damaged or cut short: export it again"))
}

/// Facet count in the header of a binary file.
fn announced(bytes: &[u8]) -> Option<u32> {
    let field = bytes.get(HEAD - 4..HEAD)?;
    Some(u32::from_le_bytes(field.try_into().ok()?))
}

/// True if the length is exactly what the facet count of a binary file asks for.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    announced(bytes).is_some_and(|n| bytes.len() as u64 == HEAD as u64 + FACET as u64 * u64::from(n))
}

fn parse_binary(bytes: &[u8]) -> Result<MeshFile> {
    let mut welder = Welder::default();
    for (i, facet) in bytes[HEAD..].chunks_exact(FACET).enumerate() {
        let float = |k: usize| f32::from_le_bytes(std::array::from_fn(|j| facet[4 * k + j]));
        let corners = [3, 6, 9].map(|k| Vec3::new(float(k), float(k + 1), float(k + 2)));
        if !corners.iter().all(|p| p.is_finite()) {
            return Err(Error::input("a coordinate is not a finite number")
                .at(format_args!("facet {i}, byte {}", HEAD + FACET * i))
                .remedy("export the mesh again without such facets"));
        }
        welder.facet(corners.map(Vec3::as_dvec3));
    }
    Ok(welder.finish())
}

fn parse_ascii(bytes: &[u8]) -> Scanned<MeshFile> {
    let mut scan = Scanner::new(bytes);
    let mut welder = Welder::default();
    let mut open = false;
    while scan.next_line() {
        match scan.field().unwrap_or_default() {
            b"solid" => open = true,
            b"endsolid" => open = false,
            b"facet" => {
                scan.rest(); // the normal follows from the corners
                welder.facet(parse_facet(&mut scan)?);
                continue;
            }
            word => return Err(scan.malformed(format!("unexpected \"{}\"", quote(word)), WORDS)),
        }
        scan.rest(); // the solid's name
    }
    if open {
        return Err(scan.malformed("the file ends without endsolid", "the file is cut short: export it again"));
    }
    Ok(welder.finish())
}

/// The lines of a facet after its normal.
fn parse_facet(scan: &mut Scanner) -> Scanned<[DVec3; 3]> {
    expect(scan, b"outer")?;
    expect(scan, b"loop")?;
    let mut corners = [DVec3::ZERO; 3];
    for corner in &mut corners {
        expect(scan, b"vertex")?;
        *corner = DVec3::from_array(scan.numbers("coordinate")?);
    }
    expect(scan, b"endloop")?;
    expect(scan, b"endfacet")?;
    Ok(corners)
}

fn expect(scan: &mut Scanner, word: &[u8]) -> Scanned<()> {
    scan.next_line();
    if scan.peek_field() == Some(word) {
        scan.field();
        return Ok(());
    }
    let found = quote(scan.peek_field().unwrap_or(b"end of file"));
    Err(scan.malformed(format!("\"{found}\" where \"{}\" should stand", quote(word)), WORDS))
}
