//! Landmarks as comma-separated tables with a header, for both meshes or for one.

use super::place::{Entry, Place, PointFile, row};
use crate::{Error, Result};
use glam::DVec3;
use std::path::Path;

/// Columns of the table of vertex pairs.
const VERTEX_PAIRS: [&str; 2] = ["source_vertex", "target_vertex"];
/// Columns of the table of pairs of positions.
const POSITION_PAIRS: [[&str; 3]; 2] = [["sx", "sy", "sz"], ["tx", "ty", "tz"]];
/// Column separators, the first that occurs in the header counts.
const SEPARATORS: [char; 3] = [',', ';', '\t'];

/// A row with its fields.
struct Row {
    number: usize,
    line: usize,
    fields: Vec<String>,
}

/// A table by column names.
struct Table {
    header: Vec<String>,
    rows: Vec<Row>,
}

/// Where a place stands in a row.
enum Columns {
    Vertex(usize),
    Position([usize; 3]),
}

/// Parses a table for both meshes: the points on the source and those on the target.
pub fn read_pairs(path: &Path, content: &str) -> Result<[PointFile; 2]> {
    let table = Table::parse(content)?;
    let vertices = VERTEX_PAIRS.map(|name| table.find(name));
    let positions = POSITION_PAIRS.map(|names| table.find_all(names));
    let columns = match (vertices, positions) {
        ([Some(s), Some(t)], _) => [Columns::Vertex(s), Columns::Vertex(t)],
        (_, [Some(s), Some(t)]) => [Columns::Position(s), Columns::Position(t)],
        _ => return Err(table.lacks(&expected_pairs(&table))),
    };
    let mut files = [PointFile::default(), PointFile::default()];
    for (file, columns) in files.iter_mut().zip(&columns) {
        *file = PointFile { path: path.to_owned(), ..table.points(columns)? };
    }
    Ok(files)
}

/// Parses a table for one mesh: `name,vertex` or `name,x,y,z`.
pub fn read_points(content: &str) -> Result<PointFile> {
    let table = Table::parse(content)?;
    let columns = match (table.find("vertex"), table.find_all(["x", "y", "z"])) {
        (Some(v), _) => Columns::Vertex(v),
        (_, Some(p)) => Columns::Position(p),
        _ => return Err(table.lacks(&["vertex"])),
    };
    table.points(&columns)
}

/// The columns that a table for both meshes seems to be meant to have.
fn expected_pairs(table: &Table) -> Vec<&'static str> {
    if POSITION_PAIRS.iter().flatten().any(|name| table.find(name).is_some()) {
        return POSITION_PAIRS.concat();
    }
    VERTEX_PAIRS.to_vec()
}

impl Table {
    fn parse(content: &str) -> Result<Table> {
        let mut lines = content.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
        let Some((_, first)) = lines.next() else {
            return Err(Error::input("the landmark file is empty").remedy("write a header and one row per landmark"));
        };
        let separator = SEPARATORS.into_iter().find(|&s| first.contains(s)).unwrap_or(',');
        let header = split(first, separator).map_err(|e| e.at("header"))?;
        let mut rows = Vec::new();
        for (n, (i, text)) in lines.enumerate() {
            let (number, line) = (n + 1, i + 1);
            let fields = split(text, separator).map_err(|e| e.at(row(number, Some(line))))?;
            rows.push(Row { number, line, fields });
        }
        let table = Table { header: header.iter().map(|name| name.to_ascii_lowercase()).collect(), rows };
        if table.find("name").is_none() {
            return Err(table.lacks(&["name"]));
        }
        Ok(table)
    }

    fn find(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|column| column == name)
    }

    fn find_all(&self, names: [&str; 3]) -> Option<[usize; 3]> {
        let [x, y, z] = names.map(|name| self.find(name));
        Some([x?, y?, z?])
    }

    /// The error that columns are missing.
    fn lacks(&self, names: &[&str]) -> Error {
        let missing: Vec<&str> = names.iter().copied().filter(|name| self.find(name).is_none()).collect();
        Error::input(format!("column {} is missing", missing.join(", ")))
            .at("row 0, the header")
            .remedy("start with name,source_vertex,target_vertex or name,sx,sy,sz,tx,ty,tz (one mesh: name,vertex)")
    }

    fn points(&self, columns: &Columns) -> Result<PointFile> {
        let name = self.find("name").unwrap_or_default(); // `parse` refuses tables without
        let entries =
            self.rows.iter().map(|r| self.entry(r, name, columns).map_err(|e| e.at(row(r.number, Some(r.line)))));
        Ok(PointFile { entries: entries.collect::<Result<_>>()?, ..PointFile::default() })
    }

    fn entry(&self, row: &Row, name: usize, columns: &Columns) -> Result<Entry> {
        let name = self.field(row, name)?.to_owned();
        let place = match *columns {
            Columns::Vertex(c) => Place::Vertex(vertex_index(&self.header[c], self.field(row, c)?)?),
            Columns::Position(c) => {
                let mut p = [0.0; 3];
                for (x, c) in p.iter_mut().zip(c) {
                    *x = coordinate(&self.header[c], self.field(row, c)?)?;
                }
                Place::Position(DVec3::from_array(p))
            }
        };
        Ok(Entry { number: row.number, line: Some(row.line), name: Some(name), place })
    }

    fn field<'a>(&self, row: &'a Row, column: usize) -> Result<&'a str> {
        match row.fields.get(column) {
            Some(field) if !field.is_empty() => Ok(field),
            _ => Err(Error::input(format!("no {}", self.header[column])).remedy("fill in every column of the row")),
        }
    }
}

/// A vertex index as written.
pub fn vertex_index(name: &str, field: &str) -> Result<u64> {
    field.parse().map_err(|_| {
        Error::input(format!("{name} \"{field}\" is not a vertex index"))
            .remedy("write the vertex's number, a whole number counted from 0")
    })
}

/// A finite coordinate as written.
pub fn coordinate(name: &str, field: &str) -> Result<f64> {
    field.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(|| {
        Error::input(format!("{name} \"{field}\" is not a finite number")).remedy("write a decimal number")
    })
}

/// Splits a line into trimmed fields; quotes protect separators, doubled quotes stand for one.
pub fn split(line: &str, separator: char) -> Result<Vec<String>> {
    let mut fields = vec![String::new()];
    let mut quoted = false;
    let mut chars = line.trim_end_matches('\r').chars().peekable();
    while let Some(c) = chars.next() {
        let field = fields.last_mut().expect("there is always a field under way");
        match c {
            '"' if quoted && chars.peek() == Some(&'"') => {
                chars.next();
                field.push('"');
            }
            '"' if quoted || field.trim().is_empty() => quoted = !quoted,
            _ if c == separator && !quoted => fields.push(String::new()),
            _ => field.push(c),
        }
    }
    if quoted {
        return Err(Error::input("a quote is not closed").remedy("close it on the same line"));
    }
    Ok(fields.into_iter().map(|field| field.trim().to_owned()).collect())
}
