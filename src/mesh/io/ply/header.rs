//! The header of a PLY file: encoding, elements, properties.

use crate::mesh::io::scan::{Scanned, Scanner, quote};

/// Remedy for a header line that makes no sense.
const HEADER: &str = "correct the PLY header; exporting the mesh again is the simplest way";

/// How the values after the header are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    Ascii,
    Little,
    Big,
}

/// A number type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// A property of an element; a list if it has a length.
#[derive(Debug)]
pub struct Property {
    pub name: String,
    /// Type of the list's length.
    pub length: Option<Kind>,
    /// Type of the value, or of the list's items.
    pub kind: Kind,
}

/// A table of the file.
#[derive(Debug)]
pub struct Element {
    pub name: String,
    pub count: u32,
    pub properties: Vec<Property>,
}

/// What the header declares.
#[derive(Debug)]
pub struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Number of vertices.
    pub vertices: usize,
    /// Where the values start.
    pub body: usize,
    /// Number of header lines.
    pub lines: usize,
}

impl Element {
    /// The places of scalar properties by name; None if one is missing.
    pub fn columns<const N: usize>(&self, names: [&str; N]) -> Option<[usize; N]> {
        let mut columns = [0; N];
        for (column, name) in columns.iter_mut().zip(names) {
            *column = self.properties.iter().position(|p| p.name == name && p.length.is_none())?;
        }
        Some(columns)
    }
}

impl Kind {
    fn parse(word: &[u8]) -> Option<Kind> {
        Some(match word {
            b"char" | b"int8" => Kind::I8,
            b"uchar" | b"uint8" => Kind::U8,
            b"short" | b"int16" => Kind::I16,
            b"ushort" | b"uint16" => Kind::U16,
            b"int" | b"int32" => Kind::I32,
            b"uint" | b"uint32" => Kind::U32,
            b"float" | b"float32" => Kind::F32,
            b"double" | b"float64" => Kind::F64,
            _ => return None,
        })
    }

    /// True for the two floating-point types.
    pub fn is_float(self) -> bool {
        matches!(self, Kind::F32 | Kind::F64)
    }
}

impl Header {
    /// Parses the header at the start of `bytes`.
    pub fn parse(bytes: &[u8]) -> Scanned<Header> {
        let mut scan = Scanner::new(bytes);
        if scan.peek_field() != Some(b"ply") {
            return Err(scan.malformed("the file does not start with \"ply\"", "is this a PLY file?"));
        }
        scan.rest();
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        loop {
            if !scan.next_line() {
                return Err(scan.malformed("the header has no end_header", HEADER));
            }
            match scan.field().unwrap_or_default() {
                b"comment" | b"obj_info" => drop(scan.rest()),
                b"format" => encoding = Some(parse_encoding(&mut scan)?),
                b"element" => elements.push(parse_element(&mut scan)?),
                b"property" => {
                    let property = parse_property(&mut scan)?;
                    let element = elements.last_mut();
                    element
                        .ok_or_else(|| scan.malformed("a property before any element", HEADER))?
                        .properties
                        .push(property);
                }
                b"end_header" => break,
                word => return Err(scan.malformed(format!("unknown header line \"{}\"", quote(word)), HEADER)),
            }
            scan.end_line("the declaration")?;
        }
        let encoding = encoding.ok_or_else(|| scan.malformed("the header has no format line", HEADER))?;
        let vertices = elements.iter().find(|e| e.name == "vertex").map_or(0, |e| e.count as usize);
        let lines = scan.line();
        scan.end_line("end_header")?;
        scan.take(b'\n');
        Ok(Header { encoding, elements, vertices, body: scan.position(), lines })
    }
}

fn parse_encoding(scan: &mut Scanner) -> Scanned<Encoding> {
    let encoding = match scan.peek_field() {
        Some(b"ascii") => Encoding::Ascii,
        Some(b"binary_little_endian") => Encoding::Little,
        Some(b"binary_big_endian") => Encoding::Big,
        _ => return Err(scan.malformed("unknown format", "use ascii, binary_little_endian or binary_big_endian")),
    };
    scan.field();
    scan.number("format version")?;
    Ok(encoding)
}

fn parse_element(scan: &mut Scanner) -> Scanned<Element> {
    let name = parse_name(scan)?;
    Ok(Element { name, count: scan.count("element count")?, properties: Vec::new() })
}

fn parse_property(scan: &mut Scanner) -> Scanned<Property> {
    let mut length = None;
    if scan.peek_field() == Some(b"list") {
        scan.field();
        let kind = parse_kind(scan)?;
        if kind.is_float() {
            return Err(scan.malformed("the length of a list is not an integer type", HEADER));
        }
        length = Some(kind);
    }
    let kind = parse_kind(scan)?;
    Ok(Property { name: parse_name(scan)?, length, kind })
}

fn parse_kind(scan: &mut Scanner) -> Scanned<Kind> {
    let word = scan.field().unwrap_or_default();
    Kind::parse(word).ok_or_else(|| scan.malformed(format!("unknown type \"{}\"", quote(word)), HEADER))
}

fn parse_name(scan: &mut Scanner) -> Scanned<String> {
    let word = scan.field().ok_or_else(|| scan.malformed("a name is missing", HEADER))?;
    Ok(String::from_utf8_lossy(word).into_owned())
}
