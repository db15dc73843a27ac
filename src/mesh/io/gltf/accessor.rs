//! Typed values in the buffers of a glTF file; nothing is trusted before its bounds are checked.

use super::AGAIN;
use super::document::{Accessor, Buffer, Document};
use crate::mesh::io::read_bytes;
use crate::{Error, Result};
use std::borrow::Cow;
use std::path::Path;

/// Remedy for buffers that cannot be had.
const KEEP_TOGETHER: &str = "keep the .bin files beside the .gltf file, or export a .glb";

/// The buffers of a document.
pub struct Buffers<'a> {
    document: &'a Document,
    bytes: Vec<Cow<'a, [u8]>>,
}

/// Where the elements of an accessor lie.
struct Span<'a> {
    accessor: &'a Accessor,
    bytes: &'a [u8],
    stride: usize,
    /// Bytes of one component.
    size: usize,
}

impl<'a> Buffers<'a> {
    /// Fetches all buffers: the binary chunk, data in the document, or files relative to `folder`.
    pub fn open(document: &'a Document, folder: &Path, binary: Option<&'a [u8]>) -> Result<Self> {
        let open = |(i, buffer): (usize, &Buffer)| {
            let found = match (&buffer.uri, binary) {
                (Some(uri), _) => by_uri(uri, folder).map(Cow::Owned),
                (None, Some(chunk)) if i == 0 => Ok(Cow::Borrowed(chunk)),
                (None, _) => Err(Error::input("a buffer without data").remedy(KEEP_TOGETHER)),
            };
            found.map_err(|e| e.at(format_args!("buffer {i}")))
        };
        Ok(Buffers { document, bytes: document.buffers.iter().enumerate().map(open).collect::<Result<_>>()? })
    }

    /// Number of elements.
    pub fn count(&self, accessor: usize) -> Result<usize> {
        Ok(self.get(accessor)?.count)
    }

    /// Elements of `N` components each, as numbers.
    pub fn read<const N: usize>(&self, accessor: usize) -> Result<Vec<[f64; N]>> {
        let span = self.span(accessor, N).map_err(|e| e.at(format_args!("accessor {accessor}")))?;
        let element = |i: usize| std::array::from_fn(|k| span.component(i, k));
        Ok((0..span.accessor.count).map(element).collect())
    }

    /// Vertex indices, all below `vertices`.
    pub fn indices(&self, accessor: usize, vertices: usize) -> Result<Vec<u32>> {
        let fail = |what: String| Error::input(what).at(format_args!("accessor {accessor}")).remedy(AGAIN);
        if !matches!(self.get(accessor)?.component_type, 5121 | 5123 | 5125) {
            return Err(fail("indices must be unsigned integers".to_owned()));
        }
        let index = |[i]: [f64; 1]| match i < vertices as f64 {
            true => Ok(i as u32),
            false => Err(fail(format!("index {i}, but there are {vertices} vertices"))),
        };
        self.read::<1>(accessor)?.into_iter().map(index).collect()
    }

    fn get(&self, accessor: usize) -> Result<&'a Accessor> {
        let missing = || Error::input(format!("accessor {accessor} does not exist")).remedy(AGAIN);
        self.document.accessors.get(accessor).ok_or_else(missing)
    }

    /// The bytes of an accessor of `N` components, so many that every element lies in them.
    fn span(&self, number: usize, components: usize) -> Result<Span<'_>> {
        let fail = |what: &str| Error::input(what).remedy(AGAIN);
        let accessor = self.get(number)?;
        let size = match accessor.component_type {
            5120 | 5121 => 1,
            5122 | 5123 => 2,
            5125 | 5126 => 4,
            other => return Err(fail(&format!("unknown component type {other}"))),
        };
        let shape = ["", "SCALAR", "VEC2", "VEC3"][components];
        if accessor.shape != shape {
            return Err(fail(&format!("{} where {shape} should stand", accessor.shape)));
        }
        if accessor.sparse.is_some() {
            return Err(Error::input("sparse values").remedy("export the mesh without sparse accessors"));
        }
        let view = accessor.buffer_view.and_then(|v| self.document.buffer_views.get(v));
        let view = view.ok_or_else(|| fail("values without a buffer view"))?;
        let buffer = self.bytes.get(view.buffer).ok_or_else(|| fail("a buffer that does not exist"))?;
        let end = view.byte_offset.checked_add(view.byte_length);
        let bytes = end.and_then(|end| buffer.get(view.byte_offset..end));
        let bytes = bytes.and_then(|bytes| bytes.get(accessor.byte_offset..));
        let bytes = bytes.ok_or_else(|| fail("the buffer is too short"))?;
        let stride = view.byte_stride.unwrap_or(size * components);
        let last = accessor.count.saturating_sub(1).checked_mul(stride);
        let needed = last.and_then(|last| last.checked_add(size * components)).filter(|_| stride > 0);
        if accessor.count > 0 && needed.is_none_or(|needed| needed > bytes.len()) {
            return Err(fail(&format!("{} values do not fit into the buffer view", accessor.count)));
        }
        Ok(Span { accessor, bytes, stride, size })
    }
}

impl Span<'_> {
    /// Component `k` of element `i`; normalised integers become numbers in [-1, 1] or [0, 1].
    fn component(&self, i: usize, k: usize) -> f64 {
        let at = i * self.stride + k * self.size;
        let mut b = [0; 4];
        b[..self.size].copy_from_slice(&self.bytes[at..at + self.size]); // `Buffers::span` checked the last element
        let (value, largest) = match self.accessor.component_type {
            5120 => (f64::from(b[0] as i8), f64::from(i8::MAX)),
            5121 => (f64::from(b[0]), f64::from(u8::MAX)),
            5122 => (f64::from(i16::from_le_bytes([b[0], b[1]])), f64::from(i16::MAX)),
            5123 => (f64::from(u16::from_le_bytes([b[0], b[1]])), f64::from(u16::MAX)),
            5125 => (f64::from(u32::from_le_bytes(b)), f64::from(u32::MAX)),
            _ => return f64::from(f32::from_le_bytes(b)),
        };
        if self.accessor.normalized { (value / largest).max(-1.0) } else { value }
    }
}

/// Data in a URI, or a file beside the document.
fn by_uri(uri: &str, folder: &Path) -> Result<Vec<u8>> {
    if let Some(data) = uri.strip_prefix("data:") {
        let content = data.split_once(";base64,").and_then(|(_, text)| base64(text.as_bytes()));
        return content.ok_or_else(|| Error::input("the embedded data is not base64").remedy(AGAIN));
    }
    let name = percent_decoded(uri);
    let path = folder.join(&name);
    if Path::new(&name).is_absolute() || name.contains("://") || !path.is_file() {
        return Err(Error::input(format!("the buffer file \"{name}\" is not there")).remedy(KEEP_TOGETHER));
    }
    read_bytes(&path)
}

/// RFC 4648, padding optional; None if a character does not belong.
fn base64(text: &[u8]) -> Option<Vec<u8>> {
    let text = text.trim_ascii();
    let text = text.strip_suffix(b"==").or_else(|| text.strip_suffix(b"=")).unwrap_or(text);
    let mut out = Vec::with_capacity(text.len() / 4 * 3 + 2);
    for group in text.chunks(4) {
        let mut bits = 0u32;
        for &c in group {
            let digit = match c {
                b'A'..=b'Z' => c - b'A',
                b'a'..=b'z' => c - b'a' + 26,
                b'0'..=b'9' => c - b'0' + 52,
                b'+' => 62,
                b'/' => 63,
                _ => return None,
            };
            bits = bits << 6 | u32::from(digit);
        }
        bits <<= 6 * (4 - group.len());
        out.extend(&bits.to_be_bytes()[1..group.len()]);
    }
    Some(out)
}

/// A URI with `%20` and the like replaced.
pub fn percent_decoded(uri: &str) -> String {
    let mut out = Vec::new();
    let mut rest = uri.as_bytes();
    while let Some((&byte, tail)) = rest.split_first() {
        let hex = tail.get(..2).filter(|_| byte == b'%').and_then(|h| std::str::from_utf8(h).ok());
        match hex.and_then(|h| u8::from_str_radix(h, 16).ok()) {
            Some(decoded) => {
                out.push(decoded);
                rest = &tail[2..];
            }
            None => {
                out.push(byte);
                rest = tail;
            }
        }
    }
    String::from_utf8_lossy(&out).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_the_standard() {
        for (text, bytes) in
            [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYg", "foob"), ("Zm9vYmE=", "fooba")]
        {
            assert_eq!(base64(text.as_bytes()).as_deref(), Some(bytes.as_bytes()), "{text}");
        }
        assert_eq!(base64(b"Zm9v!"), None);
        assert_eq!(percent_decoded("my%20mesh%2ebin%"), "my mesh.bin%");
    }
}
