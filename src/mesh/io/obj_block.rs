//! One block of an OBJ file, parsed without knowing what stands before it.

use super::mesh_file::{Keyword, NO_INDEX, Statement};
use super::scan::{Malformed, Scanned, Scanner};
use glam::{DVec2, DVec3};

/// Statements that carry nothing a surface mesh needs: lines, points, free-form geometry, display attributes.
const IGNORED: &str = "l p vp vc cstype deg bmat step curv curv2 surf parm trim hole scrv sp end con mg bevel c_interp \
                       d_interp lod usemap maplib shadow_obj trace_obj ctech stech call csh";
/// Remedy for an index that cannot be right whatever stands elsewhere in the file.
const INDICES: &str = "OBJ counts vertices from 1, or from -1 backwards";

/// A corner whose negative index reaches back from a place in this block.
#[derive(Debug)]
pub(super) struct Relative {
    /// The corner in this block.
    pub corner: usize,
    /// Its index counted from the block's first element; negative if it lies in an earlier block.
    pub offset: i64,
}

/// One of the three index columns of a face line.
#[derive(Debug, Default)]
pub(super) struct Column {
    /// For every corner its 0-based index; [`NO_INDEX`] where it is missing or relative. May stop at the last index.
    pub indices: Vec<u32>,
    /// The corners with negative indices.
    pub relative: Vec<Relative>,
}

/// The content of a block.
#[derive(Debug, Default)]
pub(super) struct Block {
    pub positions: Vec<DVec3>,
    pub uv: Vec<DVec2>,
    pub normals: Vec<DVec3>,
    /// Where each polygon's corners end, counted from the block's first corner.
    pub ends: Vec<u32>,
    /// Vertex, texture coordinate and normal indices.
    pub columns: [Column; 3],
    pub statements: Vec<Statement>,
    pub material_libraries: Vec<String>,
}

impl Column {
    fn push(&mut self, corner: usize, index: i64, so_far: usize) {
        self.indices.resize(corner, NO_INDEX);
        if index > 0 {
            self.indices.push((index - 1) as u32); // below 2^32 - 1, see `Block::index`
        } else {
            self.relative.push(Relative { corner, offset: so_far as i64 + index });
            self.indices.push(NO_INDEX);
        }
    }
}

/// True if `word` starts a statement this reader knows.
pub(super) fn is_keyword(word: &[u8]) -> bool {
    matches!(word, b"v" | b"vt" | b"vn" | b"f" | b"mtllib") || keyword(word).is_some() || is_ignored(word)
}

fn is_ignored(word: &[u8]) -> bool {
    IGNORED.split(' ').any(|ignored| ignored.as_bytes() == word)
}

fn keyword(word: &[u8]) -> Option<Keyword> {
    [Keyword::Object, Keyword::Group, Keyword::Smoothing, Keyword::Material]
        .into_iter()
        .find(|k| k.word().as_bytes() == word)
}

/// Parses a block; lines are counted from its start.
pub(super) fn parse_block(bytes: &[u8]) -> Scanned<Block> {
    let mut block = Block::default();
    let mut scan = Scanner::new(bytes);
    while scan.next_line() {
        let line = scan.line();
        let word = scan.field().unwrap_or_default(); // `next_line` found a field
        match word {
            b"v" => block.vertex(&mut scan)?,
            b"f" => block.face(&mut scan)?,
            b"vt" => block.texture_coordinate(&mut scan)?,
            b"vn" => {
                block.normals.push(DVec3::from_array(scan.numbers("normal component")?));
                scan.end_line("three normal components")?;
            }
            b"mtllib" => block.material_libraries.push(String::from_utf8_lossy(scan.rest()).into_owned()),
            _ => block.other(word, line, &mut scan)?,
        }
    }
    Ok(block)
}

impl Block {
    /// Number of corners of all finished faces.
    pub fn corner_count(&self) -> usize {
        self.ends.last().map_or(0, |&end| end as usize)
    }

    /// Number of elements that index column `k` refers to.
    pub fn element_count(&self, k: usize) -> usize {
        [self.positions.len(), self.uv.len(), self.normals.len()][k]
    }

    /// `v x y z [w]` or `v x y z r g b [a]`; weights and colours are checked and left out.
    fn vertex(&mut self, scan: &mut Scanner) -> Scanned<()> {
        self.positions.push(DVec3::from_array(scan.numbers("coordinate")?));
        for _ in 0..4 {
            if !scan.more() {
                return Ok(());
            }
            scan.number("weight or colour")?;
        }
        scan.end_line("three coordinates and a colour")
    }

    /// `vt u [v [w]]`.
    fn texture_coordinate(&mut self, scan: &mut Scanner) -> Scanned<()> {
        let mut uv = [0.0; 3];
        uv[0] = scan.number("texture coordinate")?;
        for x in &mut uv[1..] {
            if scan.more() {
                *x = scan.number("texture coordinate")?;
            }
        }
        self.uv.push(DVec2::new(uv[0], uv[1]));
        scan.end_line("three texture coordinates")
    }

    /// `f` and at least three corners `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn face(&mut self, scan: &mut Scanner) -> Scanned<()> {
        let line = scan.line();
        while scan.more() {
            self.corner(scan)?;
        }
        let end = self.columns[0].indices.len();
        let n = end - self.corner_count();
        if n < 3 {
            return Err(Malformed {
                what: format!("a face with {n} corners"),
                line,
                remedy: "a face needs at least three: correct or delete the line",
            });
        }
        self.ends.push(end as u32); // blocks are far shorter than 2^32 bytes
        Ok(())
    }

    fn corner(&mut self, scan: &mut Scanner) -> Scanned<()> {
        let corner = self.columns[0].indices.len();
        let so_far = [self.positions.len(), self.uv.len(), self.normals.len()];
        let index = Self::index(scan)?;
        self.columns[0].push(corner, index, so_far[0]);
        for k in 1..3 {
            if !scan.take(b'/') {
                break;
            }
            if !scan.at_break() && !scan.peek(b'/') {
                let index = Self::index(scan)?;
                self.columns[k].push(corner, index, so_far[k]);
            }
        }
        if scan.at_break() { Ok(()) } else { Err(scan.not_a("face corner", "v, v/vt, v//vn or v/vt/vn", INDICES)) }
    }

    /// An index that is neither 0 nor beyond what 32 bits can number.
    fn index(scan: &mut Scanner) -> Scanned<i64> {
        let index = scan.digits("index")?;
        if index == 0 {
            return Err(scan.malformed("index 0", INDICES));
        }
        if index.unsigned_abs() >= u64::from(u32::MAX) {
            return Err(scan.malformed(format!("index {index} is out of range"), INDICES));
        }
        Ok(index)
    }

    fn other(&mut self, word: &[u8], line: usize, scan: &mut Scanner) -> Scanned<()> {
        let text = scan.rest();
        if let Some(keyword) = keyword(word) {
            let text = String::from_utf8_lossy(text).into_owned();
            self.statements.push(Statement { polygon: self.ends.len(), keyword, text });
        } else if !is_ignored(word) {
            return Err(Malformed {
                what: format!("unknown statement \"{}\"", super::scan::quote(word)),
                line,
                remedy: "is this an OBJ file? correct or delete the line",
            });
        }
        Ok(())
    }
}
