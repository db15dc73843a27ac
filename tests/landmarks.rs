//! Landmark files: every format gives the same landmarks, and every fault is refused with its file and row.

use glam::DVec3;
use homeo::mesh::VertexId;
use homeo::mesh::io::{Landmarks, MeshFile, parse_mesh, read_landmarks};
use homeo::{Error, ErrorKind, Result};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Octahedron with its corners at distance `size`: vertices +x, -x, +y, -y, +z, -z, moved by (10, 20, 30), and one more
/// vertex that no face uses; the first two faces are written as one quad.
fn octahedron(size: f64) -> MeshFile {
    let axes = [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z];
    let points = axes.map(|p| p * size + DVec3::new(10.0, 20.0, 30.0));
    let mut text: String = points.iter().map(|p| format!("v {} {} {}\n", p.x, p.y, p.z)).collect();
    text += "v 0 0 0\nf 1 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";
    parse_mesh(Path::new("octahedron.obj"), text.as_bytes()).expect("a valid OBJ")
}

/// A file in a folder of its own: tests run side by side and may choose the same names.
fn temporary(name: &str, content: &str) -> PathBuf {
    static FILES: AtomicUsize = AtomicUsize::new(0);
    let number = FILES.fetch_add(1, Ordering::Relaxed);
    let folder = std::env::temp_dir().join(format!("homeo-landmarks-{}-{number}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the temporary folder is writable");
    let path = folder.join(name);
    std::fs::write(&path, content).expect("the temporary folder is writable");
    path
}

fn table(name: &str, content: &str) -> Result<Landmarks> {
    read_landmarks(&temporary(name, content), None, &octahedron(1.0), &octahedron(2.0))
}

fn two_files(name: &str, source: &str, target: &str) -> Result<Landmarks> {
    let (source, target) = (temporary(&format!("source_{name}"), source), temporary(&format!("target_{name}"), target));
    read_landmarks(&source, Some(&target), &octahedron(1.0), &octahedron(2.0))
}

fn ids(list: &[VertexId]) -> Vec<u32> {
    list.iter().map(|v| v.0).collect()
}

/// Checks kind, file, row and remedy of an error.
fn assert_names(error: &Error, file: &str, row: &str, what: &str) {
    let kind = if what == "no landmarks" { ErrorKind::Unsolvable } else { ErrorKind::Input };
    assert_eq!(error.kind, kind, "{error}");
    assert!(error.file.ends_with(file), "{error}");
    assert_eq!(error.element, row, "{error}");
    assert!(error.what.contains(what), "\"{what}\" is not in: {error}");
    assert!(!error.remedy.is_empty(), "{error}");
}

#[test]
fn tables_in_any_dress() {
    let plain = "name,source_vertex,target_vertex\nnose,0,5\nleft ear,2,3\ntail,4,1\n";
    for (i, text) in [
        plain.to_owned(),
        format!("\u{feff}{}", plain.replace('\n', "\r\n")),
        plain.replace("left ear", "\"left ear\"").replace(",0,", ", \"0\" ,"),
        plain.replace(',', ";"),
        plain.replace(',', "\t"),
        plain.replace("nose", "\n\nnose"),
        "note,target_vertex,Name,source_vertex\n,5,nose,0\nx,3,left ear,2\ny,1,tail,4".to_owned(),
    ]
    .iter()
    .enumerate()
    {
        let landmarks = table(&format!("dress{i}.csv"), text).expect(text);
        assert_eq!(landmarks.names, ["nose", "left ear", "tail"], "{text}");
        assert_eq!((ids(&landmarks.source), ids(&landmarks.target)), (vec![0, 2, 4], vec![5, 3, 1]), "{text}");
        assert!(landmarks.notes.is_empty());
    }
    let quoted = table("quoted.csv", "name,source_vertex,target_vertex\n\"a, \"\"b\"\"\",1,2\n").expect("quotes");
    assert_eq!(quoted.names, ["a, \"b\""]);
}

#[test]
fn positions_snap_to_the_nearest_used_vertex_and_the_distance_is_told() {
    let text = "name,sx,sy,sz,tx,ty,tz\na,11.25,20,30,10,20,32\nb,0,0,0.5,12,20,30\n";
    let landmarks = table("positions.csv", text).expect("valid");
    assert_eq!((ids(&landmarks.source), ids(&landmarks.target)), (vec![0, 5], vec![4, 0]));
    let far = DVec3::new(10.0, 20.0, 28.5).length();
    let note = format!("2 source landmarks moved to the nearest vertex, by at most {far:.6} (\"b\", row 2, line 3)");
    assert_eq!(landmarks.notes[0], note);
    assert!(landmarks.notes.iter().any(|n| n.contains("\"b\"") && n.contains("is it on this mesh?")), "{landmarks:?}");
    assert!(landmarks.notes.iter().any(|n| n.starts_with("2 target landmarks") && n.contains("0.000000")));
}

#[test]
fn table_errors_name_file_and_row() {
    let cases = [
        ("source_vertex,target_vertex\n1,2\n", "row 0, the header", "column name is missing"),
        ("name,source_vertex\na,1\n", "row 0, the header", "column target_vertex is missing"),
        ("name,sx,sy,sz,tx,ty\na,1,1,1,1,1\n", "row 0, the header", "column tz is missing"),
        ("name,source_vertex,target_vertex\na,1,1\nb,1.5,x\n", "row 2, line 3", "source_vertex \"1.5\""),
        ("name,source_vertex,target_vertex\na,1,1\n\nb,2,x\n", "row 2, line 4", "target_vertex \"x\""),
        ("name,source_vertex,target_vertex\na,-1,1\n", "row 1, line 2", "\"-1\" is not a vertex index"),
        ("name,source_vertex,target_vertex\na,1,99999999999999999999\n", "row 1, line 2", "is not a vertex index"),
        ("name,source_vertex,target_vertex\na,1,1\nb,7,2\n", "row 2, line 3", "source vertex 7 does not exist"),
        ("name,source_vertex,target_vertex\na,1,1\nb,2,99\n", "row 2, line 3", "target vertex 99 does not exist"),
        ("name,source_vertex,target_vertex\na,1,1\nb,2\n", "row 2, line 3", "no target_vertex"),
        ("name,source_vertex,target_vertex\na,1,1\n,2,3\n", "row 2, line 3", "no name"),
        ("name,source_vertex,target_vertex\na,1,1\n\"b,2,3\n", "row 2, line 3", "a quote is not closed"),
        (
            "name,source_vertex,target_vertex\na,1,1\nb,3,2\nc,1,4\n",
            "row 3, line 4",
            "source of \"c\" and already of \"a\"",
        ),
        (
            "name,source_vertex,target_vertex\na,1,1\nb,3,2\nc,4,1\n",
            "row 3, line 4",
            "target of \"c\" and already of \"a\"",
        ),
        ("name,source_vertex,target_vertex\na,1,1\nb,3,2\na,4,4\n", "row 3, line 4", "\"a\" is taken by row 1"),
        ("name,sx,sy,sz,tx,ty,tz\na,1,2,nan,1,1,1\n", "row 1, line 2", "sz \"nan\""),
        ("name,sx,sy,sz,tx,ty,tz\na,0,0,0,9,9,9\nb,0,0,0,1,1,1\n", "row 2, line 3", "source of \"b\" and already"),
    ];
    for (i, (text, row, what)) in cases.into_iter().enumerate() {
        let name = format!("fault{i}.csv");
        assert_names(&table(&name, text).expect_err(text), &name, row, what);
    }
    let error = table("empty.csv", "\n").expect_err("an empty file");
    assert!(error.file.ends_with("empty.csv") && error.what.contains("empty"), "{error}");
    let error =
        read_landmarks(Path::new("none.csv"), None, &octahedron(1.0), &octahedron(1.0)).expect_err("no such file");
    assert_eq!((error.kind, error.file.as_str()), (ErrorKind::Input, "none.csv"));
}

/// The files of one point list: vertices 4, 0 and 3 of an octahedron of size 1 or 2, named p, q and r.
fn formats(size: f64) -> Vec<(&'static str, String)> {
    let points = [("p", [10.0, 20.0, 30.0 + size]), ("q", [10.0 + size, 20.0, 30.0]), ("r", [10.0, 20.0 - size, 30.0])];
    let each = |f: &dyn Fn(&str, [f64; 3]) -> String, gap: &str| points.map(|(name, p)| f(name, p)).join(gap);
    let slicer = |sign: f64, axes: &str| {
        let point = |name: &str, [x, y, z]: [f64; 3]| {
            format!("{{\"id\":\"1\",\"label\":\"{name}\",\"position\":[{}, {}, {z}]}}", sign * x, sign * y)
        };
        let points = each(&point, ",");
        format!(
            "{{\"markups\":[{{\"type\":\"Fiducial\",\"coordinateSystem\":\"{axes}\",\"controlPoints\":[{points}]}}]}}"
        )
    };
    let fcsv = |columns: bool| {
        let point = |name: &str, [x, y, z]: [f64; 3]| format!("id,{},{},{z},0,0,0,1,1,1,0,{name},,", -x, -y);
        let head =
            if columns { "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n" } else { "" };
        format!("# Markups fiducial file version = 4.10\n# CoordinateSystem = 0\n{head}{}\n", each(&point, "\n"))
    };
    let pp =
        |name: &str, [x, y, z]: [f64; 3]| format!(" <point y=\"{y}\" x='{x}' z=\"{z}\" active=\"1\" name=\"{name}\"/>");
    let scalismo = |name: &str, [x, y, z]: [f64; 3]| format!("{{\"id\":\"{name}\",\"coordinates\":[{x},{y},{z}]}}");
    vec![
        ("a.json", "[4, 0, 3]".to_owned()),
        ("b.txt", "# indices\n4\n0 # the nose\n3\n".to_owned()),
        ("c.txt", "4, 0,3".to_owned()),
        ("d.csv", "name,vertex\np,4\nq,0\nr,3\n".to_owned()),
        ("e.csv", format!("name,x,y,z\n{}", each(&|n, [x, y, z]| format!("{n},{x},{y},{z}"), "\n"))),
        // Faces count as fans: 0 and 1 are the quad's, 3 is (4, 1, 5) in the file's numbers, 4 is (3, 1, 6).
        ("wrap.json", "[[1, 0.1, 0.2], [4, 0.2, 0.7], [3, 0.8, 0.1]]".to_owned()),
        ("named.json", "{\"r\": [3, 0.8, 0.1], \"p\": [1, 0.1, 0.2], \"q\": [4, 0.2, 0.7]}".to_owned()),
        ("lps.mrk.json", slicer(1.0, "LPS")),
        ("ras.mrk.json", slicer(-1.0, "RAS")),
        ("a.fcsv", fcsv(true)),
        ("b.fcsv", fcsv(false)),
        ("a.pp", format!("<!DOCTYPE PickedPoints>\n<PickedPoints>\n{}\n</PickedPoints>\n", each(&pp, "\n"))),
        ("scalismo.json", format!("[{}]", each(&scalismo, ","))),
    ]
}

#[test]
fn every_format_places_the_same_points() {
    for ((name, source), (_, target)) in formats(1.0).into_iter().zip(formats(2.0)) {
        let landmarks = two_files(name, &source, &target).unwrap_or_else(|e| panic!("{name}: {e}"));
        let mut pairs: Vec<_> = ids(&landmarks.source).into_iter().zip(ids(&landmarks.target)).collect();
        pairs.sort_unstable();
        assert_eq!(pairs, [(0, 0), (3, 3), (4, 4)], "{name}");
        let is_named = !["a.json", "b.txt", "c.txt", "wrap.json"].contains(&name);
        assert_eq!(landmarks.names.contains(&"q".to_owned()), is_named, "{name}: {:?}", landmarks.names);
    }
}

#[test]
fn axes_are_chosen_by_distance_and_noted() {
    let files = formats(1.0);
    let content = |name: &str| files.iter().find(|f| f.0 == name).expect("in the list").1.clone();
    let landmarks = two_files("axes.json", &content("lps.mrk.json"), &content("ras.mrk.json")).expect("valid");
    assert!(landmarks.notes[0].contains("source landmarks are given in LPS: used as written"), "{:?}", landmarks.notes);
    assert!(
        landmarks.notes.iter().any(|n| n.contains("target landmarks are given in RAS: turned")),
        "{:?}",
        landmarks.notes
    );
}

#[test]
fn files_match_by_name_and_else_by_order() {
    let swapped =
        two_files("swap.csv", "name,vertex\na,0\nb,1\nc,2\n", "name,vertex\nc,5\nb,4\na,3\n").expect("by name");
    assert_eq!((swapped.names.join(""), ids(&swapped.target)), ("abc".to_owned(), vec![3, 4, 5]));
    assert!(swapped.notes[0].contains("\"a\" is row 1, line 2 and row 3, line 4"), "{:?}", swapped.notes);

    let mixed = two_files("mixed.csv", "4 5 3\n", "name,vertex\nx,1\ny,2\nz,0\n").expect("by order");
    assert_eq!((mixed.names.join(""), ids(&mixed.target)), ("xyz".to_owned(), vec![1, 2, 0]));
    assert!(mixed.notes[0].contains("matched by order"));

    let unnamed = two_files("plain.txt", "4 5\n", "1 2\n").expect("by order");
    assert_eq!(unnamed.names, ["landmark 1", "landmark 2"]);
}

#[test]
fn files_that_do_not_match_are_refused() {
    let head = "name,vertex\n";
    let error = two_files("only.csv", &format!("{head}a,0\nb,1\n"), &format!("{head}a,0\nx,1\n"))
        .expect_err("b has no partner");
    assert_names(&error, "source_only.csv", "row 2, line 3", "landmark \"b\" has no partner");
    let error =
        two_files("more.csv", &format!("{head}a,0\n"), &format!("{head}a,0\nx,1\n")).expect_err("x has no partner");
    assert_names(&error, "target_more.csv", "row 2, line 3", "landmark \"x\" has no partner");
    let error = two_files("count.txt", "1 2 3\n", "1 2\n").expect_err("three and two");
    assert!(error.what.starts_with("3 landmarks") && error.what.ends_with("has 2"), "{error}");
}

#[test]
fn errors_in_files_of_one_mesh_name_the_row() {
    let good = "0 1 2\n";
    for (name, text, row, what) in [
        ("a.txt", "0 1\n2 x\n", "row 4, line 2", "\"x\" is not a vertex index"),
        ("b.txt", "0\n1\n77\n", "row 3, line 3", "source vertex 77 does not exist"),
        ("c.txt", "0 1 0\n", "row 3, line 1", "vertex 0 is the source"),
        ("a.json", "[0, 1, 2.5]", "row 3", "2.5 is not a vertex index"),
        ("b.json", "[0, 1,\n 2", "line 2, column 2", "not valid JSON"),
        ("c.json", "[[0, 0.5, 0.5], [99, 1, 0]]", "row 2", "source triangle 99 does not exist, the source has 8"),
        ("d.json", "[[0, 0.5, 0.5], [1, 1]]", "row 2", "not three numbers"),
        ("e.json", "[{\"id\": \"a\", \"coordinates\": [1, 2, 3]}, {\"id\": \"b\"}]", "row 2", "not three numbers"),
        (
            "a.mrk.json",
            "{\"markups\":[{\"controlPoints\":[{\"label\":\"a\",\"position\":[1,2]}]}]}",
            "row 1",
            "not three numbers",
        ),
        ("a.fcsv", "# Markups\n1,2,3\n", "row 1, line 2", "no z"),
        ("b.fcsv", "# Markups\n# CoordinateSystem = IJK\n", "line 2", "unknown coordinate system"),
        ("a.pp", "<PickedPoints><point x=\"1\" y=\"2\" name=\"a\"/></PickedPoints>", "row 1", "no z"),
        ("b.pp", "<point x=\"1\" y=\"2\" z=\"3\" active=\"0\" name=\"a\"/>", "row 1", "never picked"),
        ("c.pp", "<PickedPoints><point x=\"1\" y=\"2\" z=\"3\"", "row 1", "not closed"),
        ("a.csv", "name,vertices\na,1\n", "row 0, the header", "column vertex is missing"),
    ] {
        let error = two_files(name, text, good).expect_err(text);
        assert_names(&error, &format!("source_{name}"), row, what);
    }
}

#[test]
fn sound_files_without_landmarks_leave_the_problem_unsolvable() {
    let empty = "{\"markups\":[{\"controlPoints\":[]}]}";
    let table = table("none.csv", "name,source_vertex,target_vertex\n");
    for none in [table, two_files("none.mrk.json", empty, "0 1 2\n")] {
        let error = none.expect_err("no landmarks");
        assert_eq!(error.kind, ErrorKind::Unsolvable, "{error}");
        assert!(error.what.starts_with("no landmarks"), "{error}");
    }
}
