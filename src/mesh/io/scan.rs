//! Text as bytes: lines, fields and numbers, with the line number at hand for error messages.
//!
//! A backslash before a line break continues the line, `#` starts a comment anywhere, any run of blanks separates
//! fields, and both `\n` and `\r\n` end a line.

use crate::Error;
use std::ops::Range;

/// Remedy for text that is not the number it should be.
pub(super) const EXPECT_NUMBER: &str = "write a finite decimal number, with a point and without separators";
/// Remedy for lines with too few or too many fields.
const EXPECT_FIELDS: &str = "compare this line with its neighbours; the file may be damaged or cut short";
/// Most characters of an offending field that an error message quotes.
const QUOTED: usize = 24;

/// What is wrong with a text file and in which line (from 1).
#[derive(Debug)]
pub(super) struct Malformed {
    pub what: String,
    pub line: usize,
    pub remedy: &'static str,
}

/// Result of reading text.
pub(super) type Scanned<T> = Result<T, Malformed>;

impl From<Malformed> for Error {
    fn from(m: Malformed) -> Error {
        Error::input(m.what).at(format_args!("line {}", m.line)).remedy(m.remedy)
    }
}

/// A position in a text, moving forward by fields and lines.
pub(super) struct Scanner<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
}

impl<'a> Scanner<'a> {
    /// Starts before the first line.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self::starting_at(bytes, 0, 1)
    }

    /// Starts at byte `at`, in line `line`.
    pub fn starting_at(bytes: &'a [u8], at: usize, line: usize) -> Self {
        Scanner { bytes, at, line }
    }

    /// The byte it stands at.
    pub fn position(&self) -> usize {
        self.at
    }

    /// The number of the current line, from 1.
    pub fn line(&self) -> usize {
        self.line
    }

    /// Moves past the current line's end if needed and on to the next line that holds a field; false at the end.
    ///
    /// A line that still holds an unread field is the next line itself.
    pub fn next_line(&mut self) -> bool {
        while !self.more() {
            match self.bytes[self.at..].iter().position(|&b| b == b'\n') {
                Some(n) => {
                    self.at += n + 1;
                    self.line += 1;
                }
                None => {
                    self.at = self.bytes.len();
                    return false;
                }
            }
        }
        true
    }

    /// Skips blanks; true if the current line holds another field.
    pub fn more(&mut self) -> bool {
        loop {
            match self.bytes.get(self.at) {
                Some(b'\\') => match continuation(&self.bytes[self.at..]) {
                    Some(n) => {
                        self.at += n;
                        self.line += 1;
                    }
                    None => return true,
                },
                Some(&b) if is_blank(b) => self.at += 1,
                Some(b'\n' | b'#') | None => return false,
                Some(_) => return true,
            }
        }
    }

    /// The next field of the current line.
    pub fn field(&mut self) -> Option<&'a [u8]> {
        if !self.more() {
            return None;
        }
        let range = self.field_range();
        self.at = range.end;
        Some(&self.bytes[range])
    }

    /// The next field of the current line, left in place.
    pub fn peek_field(&mut self) -> Option<&'a [u8]> {
        let at = self.at;
        let field = self.field();
        self.at = at;
        field
    }

    /// Everything up to the end of the line or a comment that stands apart, without surrounding blanks.
    pub fn rest(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.at..];
        let mut end = 0;
        while end < rest.len() && rest[end] != b'\n' {
            let escaped = continuation(&rest[end..]);
            self.line += usize::from(escaped.is_some());
            end += escaped.unwrap_or(1);
        }
        self.at += end;
        let comment = rest[..end].windows(2).position(|w| is_blank(w[0]) && w[1] == b'#').unwrap_or(end);
        rest[..comment].trim_ascii()
    }

    /// The next field as a finite number; `name` is what an error calls it.
    pub fn number(&mut self, name: &str) -> Scanned<f64> {
        self.require(name)?;
        let Ok((value, length)) = fast_float2::parse_partial::<f64, _>(&self.bytes[self.at..]) else {
            return Err(self.not_a(name, "number", EXPECT_NUMBER));
        };
        if !self.ends_at(self.at + length) {
            return Err(self.not_a(name, "number", EXPECT_NUMBER));
        }
        if !value.is_finite() {
            return Err(self.not_a(name, "finite number", EXPECT_NUMBER));
        }
        self.at += length;
        Ok(value)
    }

    /// The next three fields as finite numbers.
    pub fn numbers<const N: usize>(&mut self, name: &str) -> Scanned<[f64; N]> {
        let mut out = [0.0; N];
        for x in &mut out {
            *x = self.number(name)?;
        }
        Ok(out)
    }

    /// The next field as an integer; `name` is what an error calls it.
    pub fn integer(&mut self, name: &str) -> Scanned<i64> {
        self.require(name)?;
        let value = self.digits(name)?;
        if !self.ends_at(self.at) {
            return Err(self.not_a(name, "whole number", "write whole numbers separated by blanks"));
        }
        Ok(value)
    }

    /// The next field as a count or an index from 0 to `u32::MAX - 1`.
    pub fn count(&mut self, name: &str) -> Scanned<u32> {
        let line = self.line;
        let value = self.integer(name)?;
        u32::try_from(value).ok().filter(|&n| n < u32::MAX).ok_or_else(|| Malformed {
            what: format!("{name} {value} is out of range"),
            line,
            remedy: "counts and indices run from 0 to 2^32 - 2",
        })
    }

    /// An integer at this very place, whatever follows it.
    pub fn digits(&mut self, name: &str) -> Scanned<i64> {
        let rest = &self.bytes[self.at..];
        let sign = usize::from(matches!(rest.first(), Some(b'-' | b'+')));
        let mut value = 0i64;
        let mut n = sign;
        while let Some(d) = rest.get(n).map(|b| b.wrapping_sub(b'0')).filter(|&d| d < 10) {
            let Some(more) = value.checked_mul(10).and_then(|v| v.checked_add(i64::from(d))) else {
                return Err(self.not_a(name, "64-bit number", "no mesh has that many elements: correct the index"));
            };
            value = more;
            n += 1;
        }
        if n == sign {
            return Err(self.not_a(name, "whole number", "write whole numbers separated by blanks"));
        }
        self.at += n;
        Ok(if rest[0] == b'-' { -value } else { value })
    }

    /// True if the next byte is `byte`.
    pub fn peek(&self, byte: u8) -> bool {
        self.bytes.get(self.at) == Some(&byte)
    }

    /// Takes one byte if it is `byte`.
    pub fn take(&mut self, byte: u8) -> bool {
        let hit = self.peek(byte);
        self.at += usize::from(hit);
        hit
    }

    /// True if a field ends here.
    pub fn at_break(&self) -> bool {
        self.ends_at(self.at)
    }

    /// Refuses further fields on this line.
    pub fn end_line(&mut self, after: &str) -> Scanned<()> {
        if !self.more() {
            return Ok(());
        }
        Err(self.malformed(format!("unexpected \"{}\" after {after}", self.quote()), EXPECT_FIELDS))
    }

    /// An error in the current line.
    pub fn malformed(&self, what: impl Into<String>, remedy: &'static str) -> Malformed {
        Malformed { what: what.into(), line: self.line, remedy }
    }

    /// The error that the field here is not a `kind`.
    pub fn not_a(&self, name: &str, kind: &str, remedy: &'static str) -> Malformed {
        self.malformed(format!("{name} \"{}\" is not a {kind}", self.quote()), remedy)
    }

    fn require(&mut self, name: &str) -> Scanned<()> {
        let line = self.line;
        if self.more() {
            return Ok(());
        }
        Err(Malformed { what: format!("the line ends where a {name} should stand"), line, remedy: EXPECT_FIELDS })
    }

    fn quote(&self) -> String {
        quote(&self.bytes[self.field_range()])
    }

    fn field_range(&self) -> Range<usize> {
        let end = (self.at..self.bytes.len()).find(|&i| self.ends_at(i)).unwrap_or(self.bytes.len());
        self.at..end
    }

    fn ends_at(&self, i: usize) -> bool {
        match self.bytes.get(i) {
            Some(b'\n' | b'#') | None => true,
            Some(b'\\') => continuation(&self.bytes[i..]).is_some(),
            Some(&b) => is_blank(b),
        }
    }
}

/// Part of a file as printable text for a message.
pub(super) fn quote(bytes: &[u8]) -> String {
    let short = &bytes[..bytes.len().min(QUOTED)];
    match std::str::from_utf8(short) {
        Ok(text) if !text.contains(char::is_control) => text.to_owned(),
        _ => short.escape_ascii().to_string(),
    }
}

/// Splits text into blocks of about `size` bytes at line breaks that end a statement.
pub(super) fn blocks(bytes: &[u8], size: usize) -> Vec<Range<usize>> {
    let mut blocks = Vec::new();
    let mut start = 0;
    while start < bytes.len() {
        let mut end = bytes.len().min(start + size);
        while end < bytes.len() && !ends_statement(&bytes[..end]) {
            end += 1;
        }
        blocks.push(start..end);
        start = end;
    }
    blocks
}

/// True if `head` ends with a line break that is not escaped.
fn ends_statement(head: &[u8]) -> bool {
    let Some(line) = head.strip_suffix(b"\n") else { return false };
    !line.strip_suffix(b"\r").unwrap_or(line).ends_with(b"\\")
}

fn is_blank(b: u8) -> bool {
    matches!(b, b' ' | b'\t' | b'\r' | 0x0b | 0x0c)
}

/// Length of an escaped line break at the start of `bytes`.
fn continuation(bytes: &[u8]) -> Option<usize> {
    match bytes {
        [b'\\', b'\n', ..] => Some(2),
        [b'\\', b'\r', b'\n', ..] => Some(3),
        _ => None,
    }
}
