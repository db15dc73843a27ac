//! All numbers that a PLY file has by vertex, besides positions.

use super::header::{Element, Encoding, Header};
use super::values::{Ascii, Binary, Values};
use crate::mesh::io::VertexTable;
use crate::{Error, Result};

/// Scalar properties of element vertex other than these make up the table.
const POSITION: [&str; 3] = ["x", "y", "z"];

/// Reads the table of a PLY file's vertices.
pub(in crate::mesh::io) fn parse_table(bytes: &[u8]) -> Result<VertexTable> {
    let header = Header::parse(bytes)?;
    match header.encoding {
        Encoding::Ascii => read(&header, Ascii::new(bytes, &header)),
        Encoding::Little => read(&header, Binary::<false>::new(bytes, &header)),
        Encoding::Big => read(&header, Binary::<true>::new(bytes, &header)),
    }
}

fn read<'a>(header: &'a Header, mut values: impl Values<'a>) -> Result<VertexTable> {
    for element in &header.elements {
        if element.name == "vertex" {
            return read_vertices(element, &mut values);
        }
        super::skip(element, &mut values)?;
    }
    Err(Error::input("the file has no vertices").remedy("declare an element vertex"))
}

fn read_vertices<'a>(element: &'a Element, values: &mut impl Values<'a>) -> Result<VertexTable> {
    let is_wanted: Vec<bool> =
        element.properties.iter().map(|p| !p.is_list() && !POSITION.contains(&p.name.as_str())).collect();
    let wanted = element.properties.iter().zip(&is_wanted).filter(|(_, wanted)| **wanted);
    let names: Vec<String> = wanted.map(|(p, _)| p.name.clone()).collect();
    let mut columns = vec![Vec::with_capacity(element.count as usize); names.len()];
    let mut items = Vec::new();
    for v in 0..element.count {
        values.start(element, v)?;
        let mut next = columns.iter_mut();
        for (property, wanted) in element.properties.iter().zip(&is_wanted) {
            values.list(property, &mut items)?;
            if *wanted && let Some(column) = next.next() {
                column.extend(items.first());
            }
        }
        values.end()?;
    }
    Ok(VertexTable { names, columns })
}
