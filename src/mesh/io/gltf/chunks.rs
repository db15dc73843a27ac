//! A binary file under construction: the document, the bytes it refers to, and the frame around both.

use super::MAGIC;
use crate::{Error, Result};
use gltf_json::accessor::{ComponentType, GenericComponentType, Type};
use gltf_json::buffer::{Target, View};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Accessor, Buffer, Index, Root, Value};

/// Bytes of the file's header and of a chunk's.
const HEADERS: [usize; 2] = [12, 8];

/// The document and the bytes.
#[derive(Default)]
pub struct Chunks {
    /// The document; it refers to the bytes by the views made here.
    pub root: Root,
    bytes: Vec<u8>,
}

impl Chunks {
    /// Appends bytes, aligned to four.
    pub fn view(&mut self, bytes: impl IntoIterator<Item = u8>, target: Option<Target>) -> Index<View> {
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        let length = self.bytes.len() - start;
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.root.push(View {
            buffer: Index::new(0),
            byte_length: length.into(),
            byte_offset: Some(start.into()),
            byte_stride: None,
            name: None,
            target: target.map(Valid),
            extensions: None,
            extras: None,
        })
    }

    /// Appends values of vertices.
    pub fn vertex_values<const N: usize>(&mut self, rows: &[[f32; N]]) -> Index<Accessor> {
        let view = self.view(le_bytes(rows), Some(Target::ArrayBuffer));
        self.accessor(view, rows.len(), shape_of(N), ComponentType::F32)
    }

    /// Appends values that are no vertex's.
    pub fn values(&mut self, numbers: &[f32]) -> Index<Accessor> {
        let view = self.view(le_bytes(&numbers.iter().map(|&x| [x]).collect::<Vec<_>>()), None);
        self.accessor(view, numbers.len(), Type::Scalar, ComponentType::F32)
    }

    /// Appends the corners of triangles.
    pub fn indices(&mut self, corners: &[u32]) -> Index<Accessor> {
        let view = self.view(corners.iter().flat_map(|i| i.to_le_bytes()), Some(Target::ElementArrayBuffer));
        self.accessor(view, corners.len(), Type::Scalar, ComponentType::U32)
    }

    /// Adds the least and greatest values, component by component, to the accessor of these rows.
    pub fn bound<const N: usize>(&mut self, accessor: Index<Accessor>, rows: &[[f32; N]]) {
        let fold = |start: f32, pick: fn(f32, f32) -> f32| -> Value {
            (0..N).map(|k| rows.iter().map(|row| row[k]).fold(start, pick)).collect::<Vec<_>>().into()
        };
        let accessor = &mut self.root.accessors[accessor.value()];
        accessor.min = Some(fold(f32::INFINITY, f32::min));
        accessor.max = Some(fold(f32::NEG_INFINITY, f32::max));
    }

    fn accessor(&mut self, view: Index<View>, count: usize, shape: Type, component: ComponentType) -> Index<Accessor> {
        self.root.push(Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: count.into(),
            component_type: Valid(GenericComponentType(component)),
            extensions: None,
            extras: None,
            type_: Valid(shape),
            min: None,
            max: None,
            name: None,
            normalized: false,
            sparse: None,
        })
    }

    /// The whole file. Fails if it is longer than the format's 32-bit lengths can say.
    pub fn finish(mut self) -> Result<Vec<u8>> {
        self.root.push(Buffer {
            byte_length: self.bytes.len().into(),
            name: None,
            uri: None,
            extensions: None,
            extras: None,
        });
        let mut json = self.root.to_vec().map_err(|e| Error::bug(format!("a document that is no JSON: {e}")))?;
        json.resize(json.len().next_multiple_of(4), b' ');
        let [header, chunk] = HEADERS;
        let total = header + chunk + json.len() + chunk + self.bytes.len();
        if u32::try_from(total).is_err() {
            return Err(Error::input("the result is longer than the 4 GiB that a GLB file can hold")
                .remedy("use fewer maps at once, or a coarser mesh"));
        }
        let word = |n: usize| (n as u32).to_le_bytes();
        let mut file = Vec::with_capacity(total);
        for part in [MAGIC, &word(2), &word(total), &word(json.len()), b"JSON", &json] {
            file.extend_from_slice(part);
        }
        for part in [&word(self.bytes.len())[..], b"BIN\0", &self.bytes] {
            file.extend_from_slice(part);
        }
        Ok(file)
    }
}

fn shape_of(components: usize) -> Type {
    match components {
        2 => Type::Vec2,
        3 => Type::Vec3,
        _ => Type::Scalar,
    }
}

fn le_bytes<const N: usize>(rows: &[[f32; N]]) -> impl Iterator<Item = u8> {
    rows.iter().flatten().flat_map(|x| x.to_le_bytes())
}
