//! The values of a PLY file, row by row, from text or bytes.

use super::header::{Element, Header, Kind, Property};
use crate::mesh::io::scan::Scanner;
use crate::{Error, Result};

/// Remedy for files that end early.
const CUT: &str = "the file is cut short: export it again";

/// A source of values. All PLY types fit into `f64` without loss.
pub trait Values<'a> {
    /// Moves to a row of an element.
    fn start(&mut self, element: &'a Element, row: u32) -> Result<()>;
    /// The value of a scalar property, or the length or an item of a list.
    fn value(&mut self, kind: Kind) -> Result<f64>;
    /// Ends a row.
    fn end(&mut self) -> Result<()>;
    /// Ends the file; returns a warning if something is left over.
    fn finish(self) -> Result<Option<String>>;
    /// An error in the current row.
    fn error(&self, what: &str, remedy: &str) -> Error;

    /// The items of a list property, or the one value of a scalar property, in place of what `out` held.
    fn list(&mut self, property: &Property, out: &mut Vec<f64>) -> Result<()> {
        out.clear();
        let length = match property.length {
            Some(kind) => self.value(kind)?,
            None => 1.0,
        };
        if !(length >= 0.0 && length.fract() == 0.0) {
            return Err(self.error(&format!("{} has {length} items", property.name), "correct the list's length"));
        }
        for _ in 0..length as u64 {
            let value = self.value(property.kind)?;
            out.push(value);
        }
        Ok(())
    }
}

/// The row at hand, for messages.
#[derive(Clone, Copy, Default)]
struct Row<'a> {
    element: &'a str,
    number: u32,
    count: u32,
}

impl<'a> Row<'a> {
    fn new(element: &'a Element, number: u32) -> Self {
        Row { element: &element.name, number, count: element.count }
    }
}

/// Values as text, one row per line.
pub struct Ascii<'a> {
    scan: Scanner<'a>,
    row: Row<'a>,
}

impl<'a> Ascii<'a> {
    /// Starts after the header.
    pub fn new(bytes: &'a [u8], header: &Header) -> Self {
        Ascii { scan: Scanner::starting_at(bytes, header.body, header.lines + 1), row: Row::default() }
    }
}

impl<'a> Values<'a> for Ascii<'a> {
    fn start(&mut self, element: &'a Element, row: u32) -> Result<()> {
        self.row = Row::new(element, row);
        if element.properties.is_empty() || self.scan.next_line() {
            return Ok(());
        }
        Err(self.error(&format!("the file ends at {} {row} of {}", element.name, element.count), CUT))
    }

    fn value(&mut self, kind: Kind) -> Result<f64> {
        if kind.is_float() {
            return Ok(self.scan.number("value")?);
        }
        Ok(self.scan.integer("value")? as f64)
    }

    fn end(&mut self) -> Result<()> {
        Ok(self.scan.end_line("the declared properties")?)
    }

    fn finish(mut self) -> Result<Option<String>> {
        if self.scan.next_line() {
            let what = "more lines than the header announces";
            return Err(self.scan.malformed(what, "correct the counts in the header").into());
        }
        Ok(None)
    }

    fn error(&self, what: &str, remedy: &str) -> Error {
        let Row { element, number, .. } = self.row;
        Error::input(what).at(format_args!("line {}, {element} {number}", self.scan.line())).remedy(remedy)
    }
}

/// Values as bytes.
pub struct Binary<'a, const BIG: bool> {
    bytes: &'a [u8],
    at: usize,
    row: Row<'a>,
}

impl<'a, const BIG: bool> Binary<'a, BIG> {
    /// Starts after the header.
    pub fn new(bytes: &'a [u8], header: &Header) -> Self {
        Binary { bytes, at: header.body, row: Row::default() }
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N]> {
        let field = self.bytes.get(self.at..self.at + N).and_then(|s| <[u8; N]>::try_from(s).ok());
        let Some(mut field) = field else {
            let Row { element, number, count } = self.row;
            return Err(self.error(&format!("the file ends at {element} {number} of {count}"), CUT));
        };
        self.at += N;
        if BIG {
            field.reverse();
        }
        Ok(field)
    }
}

impl<'a, const BIG: bool> Values<'a> for Binary<'a, BIG> {
    fn start(&mut self, element: &'a Element, row: u32) -> Result<()> {
        self.row = Row::new(element, row);
        Ok(())
    }

    fn value(&mut self, kind: Kind) -> Result<f64> {
        Ok(match kind {
            Kind::I8 => f64::from(i8::from_le_bytes(self.take()?)),
            Kind::U8 => f64::from(u8::from_le_bytes(self.take()?)),
            Kind::I16 => f64::from(i16::from_le_bytes(self.take()?)),
            Kind::U16 => f64::from(u16::from_le_bytes(self.take()?)),
            Kind::I32 => f64::from(i32::from_le_bytes(self.take()?)),
            Kind::U32 => f64::from(u32::from_le_bytes(self.take()?)),
            Kind::F32 => f64::from(f32::from_le_bytes(self.take()?)),
            Kind::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    fn end(&mut self) -> Result<()> {
        Ok(())
    }

    fn finish(self) -> Result<Option<String>> {
        let left = self.bytes.len() - self.at;
        Ok((left > 0).then(|| format!("{left} bytes after the last element were left out")))
    }

    fn error(&self, what: &str, remedy: &str) -> Error {
        let Row { element, number, .. } = self.row;
        Error::input(what).at(format_args!("{element} {number}, byte {}", self.at)).remedy(remedy)
    }
}
