//! Binary OFF: the counts, the vertices and the faces as 32-bit big-endian integers and floats.
//!
//! Source: Geomview manual, "OFF: Object File Format".

use super::mesh_file::MeshFile;
use super::off::Header;
use crate::{Error, Result};
use glam::{DVec2, DVec3};

/// Remedy for files that end early.
const CUT: &str = "the file is cut short: export it again";

/// 32-bit words with their place in the file.
struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Words<'_> {
    fn fail(&self, what: String, remedy: &str) -> Error {
        Error::input(what).at(format_args!("byte {}", self.at)).remedy(remedy)
    }

    fn word(&mut self, what: &str) -> Result<[u8; 4]> {
        let word = self.bytes.get(self.at..self.at + 4).and_then(|w| <[u8; 4]>::try_from(w).ok());
        let word = word.ok_or_else(|| self.fail(format!("the file ends where {what} should stand"), CUT))?;
        self.at += 4;
        Ok(word)
    }

    /// A count or an index.
    fn count(&mut self, what: &str) -> Result<u32> {
        let value = i32::from_be_bytes(self.word(what)?);
        let remedy = "integers are big-endian; export the file again, best as ASCII";
        u32::try_from(value).map_err(|_| self.fail(format!("{what} {value} is negative"), remedy))
    }

    fn floats<const N: usize>(&mut self, what: &str) -> Result<[f64; N]> {
        let mut values = [0.0; N];
        for x in &mut values {
            *x = f64::from(f32::from_be_bytes(self.word(what)?));
        }
        match values.iter().all(|x| x.is_finite()) {
            true => Ok(values),
            false => Err(self.fail(format!("{what} is not a finite number"), "correct or delete the vertex")),
        }
    }
}

/// Parses what follows the header line, which ends before byte `at`.
pub(super) fn parse(bytes: &[u8], at: usize, header: &Header) -> Result<MeshFile> {
    let mut words = Words { bytes, at };
    let [vertices, faces, _] =
        [words.count("the vertex count")?, words.count("the face count")?, words.count("the edge count")?];
    let mut mesh = MeshFile::default();
    for _ in 0..vertices {
        mesh.positions.push(DVec3::from_array(words.floats("a coordinate")?));
        if header.normals {
            mesh.normals.values.push(DVec3::from_array(words.floats("a normal component")?));
        }
        if header.colors {
            words.floats::<4>("a colour")?;
        }
        if header.texture {
            mesh.uv.values.push(DVec2::from_array(words.floats("a texture coordinate")?));
        }
    }
    for face in 0..faces {
        parse_face(&mut words, face, vertices, &mut mesh)?;
    }
    let left = bytes.len() - words.at;
    if left > 0 {
        mesh.warnings.push(format!("{left} bytes after the last face were left out"));
    }
    mesh.uv.spread(&mesh.corners);
    mesh.normals.spread(&mesh.corners);
    Ok(mesh)
}

/// A corner count, so many vertices, the number of colour components, these.
fn parse_face(words: &mut Words, face: u32, vertices: u32, mesh: &mut MeshFile) -> Result<()> {
    let n = words.count("a corner count")?;
    if n < 3 {
        return Err(words.fail(format!("face {face} has {n} corners"), "a face needs at least three"));
    }
    let mut corners = Vec::new();
    for _ in 0..n {
        let v = words.count("a vertex index")?;
        if v >= vertices {
            let what = format!("face {face} names vertex {v}, the file has {vertices}");
            return Err(words.fail(what, "OFF counts vertices from 0; the file may be damaged"));
        }
        corners.push(v);
    }
    for _ in 0..words.count("a colour's length")? {
        words.word("a colour")?;
    }
    mesh.push_polygon(corners);
    Ok(())
}
