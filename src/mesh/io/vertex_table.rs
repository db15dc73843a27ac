//! Numbers by vertex: colours, skin weights, whatever a PLY file or a CSV table holds.

use super::ply::parse_table;
use super::{plain_text, read_bytes};
use crate::{Error, Result};
use std::io::Write;
use std::path::Path;

/// The column that says which vertex a row is about.
const VERTEX: &str = "vertex";
/// Remedy for tables that make no sense.
const FORM: &str = "a first line with names, then one line per vertex, numbers separated by commas";

/// Columns of numbers, one row per vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VertexTable {
    /// The columns' names.
    pub names: Vec<String>,
    /// The columns; a value that is not a number is written as an empty cell.
    pub columns: Vec<Vec<f64>>,
}

/// Reads the table of a mesh of so many vertices: the scalar properties of a PLY file's vertices besides `x`, `y`, `z`, or a CSV
/// file with a row of names. A CSV column `vertex` says which row is whose, counted from 0; without it they come in order.
///
/// # Errors
/// Input, if the file cannot be read, a cell is no finite number, or there is not one row for every vertex.
pub fn read_vertex_table(path: &Path, vertices: usize) -> Result<VertexTable> {
    let bytes = read_bytes(path)?;
    let is_ply = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("ply"));
    let table = plain_text(&bytes).and_then(|text| if is_ply { parse_table(text) } else { parse_csv(text, vertices) });
    let table = table.map_err(|e| e.file(path))?;
    let rows = table.columns.first().map_or(0, Vec::len);
    if table.names.is_empty() || rows != vertices {
        let what = format!("{} columns of {rows} rows, but the mesh has {vertices} vertices", table.names.len());
        return Err(Error::input(what).file(path).remedy("use a table of the source's vertices"));
    }
    Ok(table)
}

fn parse_csv(bytes: &[u8], vertices: usize) -> Result<VertexTable> {
    let text = std::str::from_utf8(bytes).map_err(|_| Error::input("the table is not UTF-8 text").remedy(FORM))?;
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let header = lines.next().map_or("", |(_, line)| line);
    let all: Vec<&str> = header.split(',').map(str::trim).collect();
    let number_column = all.iter().position(|&name| name == VERTEX);
    let names: Vec<String> = (0..all.len()).filter(|&k| Some(k) != number_column).map(|k| all[k].to_owned()).collect();
    let mut columns = vec![vec![f64::NAN; vertices]; names.len()];
    let mut is_given = vec![false; vertices];
    for (row, (i, line)) in lines.enumerate() {
        let fail = |what: String| Error::input(what).at(format!("line {}", i + 1)).remedy(FORM);
        let cell = |text: &str| text.trim().parse().ok().filter(|x: &f64| x.is_finite());
        let cells: Option<Vec<f64>> = line.split(',').map(cell).collect();
        let cells = cells.filter(|cells| cells.len() == all.len());
        let mut cells = cells.ok_or_else(|| fail(format!("not {} finite numbers", all.len())))?;
        let vertex = number_column.map_or(row as f64, |k| cells.remove(k));
        let v = vertex as usize; // compared below, so that a negative or broken number is refused
        if v as f64 != vertex || v >= vertices || std::mem::replace(&mut is_given[v], true) {
            return Err(fail(format!("vertex {vertex} is not one of {vertices} vertices, or stands here twice")));
        }
        columns.iter_mut().zip(cells).for_each(|(column, x)| column[v] = x);
    }
    match is_given.iter().position(|given| !given) {
        Some(v) => Err(Error::input("no row for a vertex").at(format!("vertex {v}")).remedy(FORM)),
        None => Ok(VertexTable { names, columns }),
    }
}

/// Writes a table as CSV with a column `vertex` in front.
pub fn write_vertex_table(out: &mut dyn Write, table: &VertexTable) -> std::io::Result<()> {
    writeln!(out, "{VERTEX},{}", table.names.join(","))?;
    for v in 0..table.columns.first().map_or(0, Vec::len) {
        write!(out, "{v}")?;
        for column in &table.columns {
            match column[v] {
                x if x.is_finite() => write!(out, ",{x}")?,
                _ => out.write_all(b",")?,
            }
        }
        out.write_all(b"\n")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_by_number_or_in_order() {
        let by_number = parse_csv(b"a,vertex,b\n1,1,2\n3,0,4\n", 2).expect("a table");
        assert_eq!(by_number.names, ["a", "b"]);
        assert_eq!(by_number.columns, [[3.0, 1.0], [4.0, 2.0]]);
        let in_order = parse_csv(b"w\n0.5\n\n0.25\n", 2).expect("a table");
        assert_eq!(in_order.columns, [[0.5, 0.25]]);
        let mut written = Vec::new();
        write_vertex_table(&mut written, &by_number).expect("memory takes everything");
        assert_eq!(parse_csv(&written, 2).expect("the same"), by_number);
    }

    #[test]
    fn tables_that_do_not_fit_are_refused() {
        for text in [
            "a,vertex\n1,0\n1,0\n",
            "a,vertex\n1,0\n1,2\n",
            "a\n1\n",
            "a\n1\n2\n3\n",
            "a\n1\nx\n",
            "a,b\n1\n2\n",
            "a\n1\nnan\n",
        ] {
            assert!(parse_csv(text.as_bytes(), 2).is_err(), "{text}");
        }
    }
}
