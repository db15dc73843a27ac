//! Region files: which region every face of a mesh belongs to, and the four sides of regions that have them.
//!
//! JSON `{"regions": [{"name": "torso", "faces": [...], "sides": {"u0": [vertices], "u1": [...], "v0": [...], "v1": [...]}}]}`,
//! sides are optional; a CSV table `face,region`; or an OBJ file with the mesh's faces, whose materials are the regions, or
//! its groups, or its objects, whichever first tell faces apart. Faces are those of the mesh's file, counted from 0; all
//! triangles of a polygon lie in its region.

use super::mesh_file::{Keyword, MeshFile};
use super::{plain_text, read_bytes, read_mesh};
use crate::mesh::{Id, VertexId};
use crate::{Error, Result};
use serde_json::Value;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// The names of the four sides.
pub const SIDES: [&str; 4] = ["u0", "u1", "v0", "v1"];
/// Remedy for JSON of another shape.
const SHAPE: &str = "write {\"regions\": [{\"name\": \"torso\", \"faces\": [faces]}]}";
/// Remedy for tables that make no sense.
const TABLE: &str = "write a first line face,region and then one line per face, counted from 0";

/// A region as its file has it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Region {
    /// Its name, which no other has.
    pub name: String,
    /// Vertices on its sides, in the order of [`SIDES`], if they are given.
    pub sides: Option<[Vec<VertexId>; 4]>,
}

/// The regions of a mesh.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Regions {
    /// Where they come from; empty for regions that were made.
    pub path: PathBuf,
    /// All regions, in the order of the file.
    pub list: Vec<Region>,
    /// The region of every triangle of the mesh's file.
    pub of_triangle: Vec<u32>,
}

/// Reads the regions of a mesh from a file of any of the kinds above; or, if `path` is `materials`, `groups` or `objects`
/// and no such file exists, from the statements of the mesh's own file.
pub fn read_regions(path: &Path, mesh: &MeshFile) -> Result<Regions> {
    let own = [("materials", Keyword::Material), ("groups", Keyword::Group), ("objects", Keyword::Object)];
    let own = own.into_iter().find(|(name, _)| path == Path::new(name) && !path.exists());
    if let Some((_, keyword)) = own {
        return by_statements(mesh, mesh, &[keyword]).map_err(|e| e.file(&mesh.path));
    }
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    if extension.as_deref() == Some("obj") {
        let labelled = read_mesh(path)?;
        let keywords = [Keyword::Material, Keyword::Group, Keyword::Object];
        let regions = by_statements(&labelled, mesh, &keywords).map_err(|e| e.file(path))?;
        return Ok(Regions { path: path.to_owned(), ..regions });
    }
    parse_regions(path, &read_bytes(path)?, mesh)
}

/// Parses a JSON or CSV file in memory; only errors speak of its path.
///
/// # Errors
/// Bad input: another shape, a face or vertex that the mesh lacks, a face in two regions or in none, two regions of one
/// name, a region without faces.
pub fn parse_regions(path: &Path, bytes: &[u8], mesh: &MeshFile) -> Result<Regions> {
    let parse = || {
        let text = plain_text(bytes)?;
        match text.trim_ascii_start().first() {
            Some(b'{' | b'[') => parse_json(text, mesh),
            _ => parse_csv(text, mesh),
        }
    };
    let regions = parse().map_err(|e| e.file(path))?;
    Ok(Regions { path: path.to_owned(), ..regions })
}

/// Regions under construction, by polygons.
struct Draft<'m> {
    mesh: &'m MeshFile,
    list: Vec<Region>,
    numbers: HashMap<String, u32>,
    of_polygon: Vec<Option<u32>>,
}

impl<'m> Draft<'m> {
    fn new(mesh: &'m MeshFile) -> Self {
        let of_polygon = vec![None; mesh.polygon_count()];
        Draft { mesh, list: Vec::new(), numbers: HashMap::new(), of_polygon }
    }

    /// The number of the region of a name, a new one if need be.
    fn number(&mut self, name: &str) -> u32 {
        if let Some(&number) = self.numbers.get(name) {
            return number;
        }
        let number = self.list.len() as u32;
        self.numbers.insert(name.to_owned(), number);
        self.list.push(Region { name: name.to_owned(), sides: None });
        number
    }

    fn label(&mut self, polygon: u64, region: u32) -> Result<()> {
        let count = self.of_polygon.len();
        let at = usize::try_from(polygon).ok().filter(|&p| p < count);
        let at = at.ok_or_else(|| {
            Error::input(format!("region \"{}\" lists face {polygon}", self.list[region as usize].name))
                .remedy(format!("the mesh's {count} faces are counted from 0"))
        })?;
        match self.of_polygon[at].replace(region).filter(|&other| other != region) {
            None => Ok(()),
            Some(other) => {
                let [a, b] = [other, region].map(|r| &self.list[r as usize].name);
                let what = format!("a face in two regions, \"{a}\" and \"{b}\"");
                Err(Error::input(what).at(format!("face {at}")).remedy("list every face once"))
            }
        }
    }

    fn finish(self) -> Result<Regions> {
        let missing: Vec<usize> = (0..self.of_polygon.len()).filter(|&p| self.of_polygon[p].is_none()).collect();
        if let Some(first) = missing.first() {
            let what = format!("{} of {} faces are in no region", missing.len(), self.of_polygon.len());
            return Err(Error::input(what).at(format!("face {first}")).remedy("put every face into a region"));
        }
        let mut is_used = vec![false; self.list.len()];
        self.of_polygon.iter().flatten().for_each(|&r| is_used[r as usize] = true);
        if let Some(empty) = is_used.iter().position(|used| !used) {
            let what = format!("region \"{}\" has no faces", self.list[empty].name);
            return Err(Error::input(what).remedy("leave it out"));
        }
        let of_polygon: Vec<u32> = self.of_polygon.into_iter().flatten().collect();
        let of_triangle = self.mesh.triangle_polygons().iter().map(|&p| of_polygon[p as usize]).collect();
        Ok(Regions { path: PathBuf::new(), list: self.list, of_triangle })
    }
}

/// Regions by the first kind of statement in `labelled` that tells its faces apart.
fn by_statements(labelled: &MeshFile, mesh: &MeshFile, keywords: &[Keyword]) -> Result<Regions> {
    if labelled.polygon_count() != mesh.polygon_count() {
        let what = format!("{} faces, but the mesh has {}", labelled.polygon_count(), mesh.polygon_count());
        return Err(Error::input(what).remedy("label the mesh itself"));
    }
    let distinct = |keyword: &Keyword| {
        let mut texts: Vec<&str> =
            labelled.statements.iter().filter(|s| s.keyword == *keyword).map(|s| s.text.as_str()).collect();
        texts.sort_unstable();
        texts.dedup();
        texts.len()
    };
    let best = keywords.iter().find(|k| distinct(k) > 1).or_else(|| keywords.iter().find(|k| distinct(k) == 1));
    let keyword = *best.ok_or_else(|| {
        let words: Vec<&str> = keywords.iter().map(|k| k.word()).collect();
        Error::input(format!("no statements {} that tell regions apart", words.join(", "))).remedy(TABLE)
    })?;
    let mut draft = Draft::new(mesh);
    let mut statements = labelled.statements.iter().filter(|s| s.keyword == keyword).peekable();
    let mut current = None;
    for p in 0..labelled.polygon_count() {
        while let Some(s) = statements.next_if(|s| s.polygon <= p) {
            current = Some(draft.number(&s.text));
        }
        draft.of_polygon[p] = current;
    }
    let used: Vec<bool> = (0..draft.list.len() as u32).map(|r| draft.of_polygon.contains(&Some(r))).collect();
    drop_unused(&mut draft, &used);
    draft.finish()
}

/// Statements may name groups without faces; they are no regions.
fn drop_unused(draft: &mut Draft, used: &[bool]) {
    let renumbered: Vec<u32> = (0..used.len()).map(|r| used[..r].iter().filter(|&&u| u).count() as u32).collect();
    draft.of_polygon.iter_mut().flatten().for_each(|r| *r = renumbered[*r as usize]);
    let mut flags = used.iter();
    draft.list.retain(|_| *flags.next().unwrap_or(&true));
}

fn parse_csv(bytes: &[u8], mesh: &MeshFile) -> Result<Regions> {
    let text = std::str::from_utf8(bytes).map_err(|_| Error::input("the table is not UTF-8 text").remedy(TABLE))?;
    let mut draft = Draft::new(mesh);
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    for (row, (i, line)) in lines.enumerate() {
        let cells = line.split_once(',').map(|(face, name)| (face.trim(), name.trim().trim_matches('"')));
        let fault = |what: &str| Error::input(what).at(format!("line {}", i + 1)).remedy(TABLE);
        let (face, name) =
            cells.filter(|(_, name)| !name.is_empty()).ok_or_else(|| fault("not a face and a region"))?;
        if row == 0 && face == "face" {
            continue;
        }
        let face: u64 = face.parse().map_err(|_| fault(&format!("\"{face}\" is no face number")))?;
        let number = draft.number(name);
        draft.label(face, number).map_err(|e| e.at(format!("line {}", i + 1)))?;
    }
    draft.finish()
}

fn parse_json(bytes: &[u8], mesh: &MeshFile) -> Result<Regions> {
    let value: Value = serde_json::from_slice(bytes).map_err(|e| {
        let place = format!("line {}, column {}", e.line(), e.column());
        Error::input("not valid JSON").at(place).remedy(SHAPE)
    })?;
    let list = value.get("regions").and_then(Value::as_array).filter(|list| !list.is_empty());
    let list = list.ok_or_else(|| Error::input("no list of regions").remedy(SHAPE))?;
    let mut draft = Draft::new(mesh);
    for (i, one) in list.iter().enumerate() {
        let given = one.get("name").and_then(Value::as_str).filter(|name| !name.is_empty());
        let name = given.map_or_else(|| (i + 1).to_string(), str::to_owned);
        if draft.numbers.contains_key(&name) {
            return Err(Error::input(format!("two regions are called \"{name}\"")).remedy("rename one of them"));
        }
        let number = draft.number(&name);
        let faces = one.get("faces").and_then(Value::as_array);
        let faces = faces.ok_or_else(|| Error::input(format!("region \"{name}\" lists no faces")).remedy(SHAPE))?;
        for face in faces {
            let face = face.as_u64().ok_or_else(|| {
                Error::input(format!("region \"{name}\" lists {face} as a face")).remedy("count faces from 0")
            })?;
            draft.label(face, number)?;
        }
        let sides = one.get("sides").filter(|sides| !sides.is_null());
        draft.list[number as usize].sides = sides.map(|s| parse_sides(s, &name, mesh)).transpose()?;
    }
    draft.finish()
}

fn parse_sides(sides: &Value, region: &str, mesh: &MeshFile) -> Result<[Vec<VertexId>; 4]> {
    let count = mesh.positions.len();
    let side = |name: &str| -> Result<Vec<VertexId>> {
        let here = || format!("region \"{region}\", side {name}");
        let list = sides.get(name).and_then(Value::as_array).filter(|list| !list.is_empty());
        let list = list.ok_or_else(|| {
            Error::input("a side without vertices")
                .at(here())
                .remedy("list the vertices of u0, u1, v0 and v1, or leave sides out")
        })?;
        let vertex = |item: &Value| {
            let index = item.as_u64().and_then(|v| usize::try_from(v).ok()).filter(|&v| v < count);
            index.map(VertexId::new).ok_or_else(|| {
                let remedy = format!("its {count} vertices are counted from 0");
                Error::input(format!("{item} is no vertex of the mesh")).at(here()).remedy(remedy)
            })
        };
        list.iter().map(vertex).collect()
    };
    Ok([side("u0")?, side("u1")?, side("v0")?, side("v1")?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::fixture;

    fn parse(text: &str) -> Result<Regions> {
        parse_regions(Path::new("r"), text.as_bytes(), &MeshFile::of(&fixture::plane(1, 1)))
    }

    #[test]
    fn json_and_csv_say_the_same() {
        let json = parse(r#"{"regions": [{"name": "a", "faces": [1]}, {"name": "b, c", "faces": [0]}]}"#);
        let csv = parse("face,region\n1,a\n0,\"b, c\"\n");
        let (json, csv) = (json.expect("sound"), csv.expect("sound"));
        assert_eq!(json, csv);
        assert_eq!(json.of_triangle, [1, 0]);
    }

    #[test]
    fn materials_come_before_groups_and_empty_groups_are_no_regions() {
        let mut mesh = MeshFile::of(&fixture::plane(1, 1));
        let statement = |polygon, keyword, text: &str| super::super::Statement { polygon, keyword, text: text.into() };
        mesh.statements = vec![
            statement(0, Keyword::Group, "none"),
            statement(0, Keyword::Group, "left"),
            statement(0, Keyword::Material, "skin"),
            statement(1, Keyword::Group, "right"),
        ];
        let all = [Keyword::Material, Keyword::Group, Keyword::Object];
        let regions = by_statements(&mesh, &mesh, &all).expect("sound");
        let names: Vec<&str> = regions.list.iter().map(|r| r.name.as_str()).collect();
        assert_eq!((names, regions.of_triangle), (vec!["left", "right"], vec![0, 1]));
        assert!(by_statements(&mesh, &mesh, &[Keyword::Object]).is_err());
    }

    #[test]
    fn files_that_make_no_sense_are_refused_with_the_place() {
        for (text, named) in [
            ("", "in no region"),
            ("face,region\n0,a\n", "face 1"),
            ("0,a\n0,b\n1,a\n", "line 2"),
            ("0,a\n2,a\n", "face 2"),
            ("0,a\nx,a\n", "\"x\""),
            ("0\n", "line 1"),
            ("{", "line 1"),
            ("{}", "no list"),
            (r#"{"regions": [{"name": "a", "faces": [0, 1]}, {"name": "a", "faces": []}]}"#, "two regions"),
            (r#"{"regions": [{"name": "a", "faces": [0, 1]}, {"name": "b", "faces": []}]}"#, "\"b\" has no faces"),
            (r#"{"regions": [{"name": "a", "faces": [0, -1]}]}"#, "-1"),
            (r#"{"regions": [{"name": "a", "faces": [0, 1], "sides": {"u0": [0]}}]}"#, "side u1"),
            (r#"{"regions": [{"name": "a", "faces": [0, 1], "sides": {"u0": [4]}}]}"#, "4 is no vertex"),
        ] {
            let error = parse(text).expect_err(text);
            assert!(error.kind == crate::ErrorKind::Input && error.to_string().contains(named), "{text}: {error}");
        }
    }
}
