//! Materials of OBJ files, as far as textures need them.
//!
//! tobj reads the library. It panics on a colour with fewer than three numbers and refuses a whole library for one odd
//! line, so it is only shown the lines whose form it accepts.

use super::mesh_file::MeshFile;
use crate::{Error, Result};
use std::path::{Path, PathBuf};

/// Number of values after each option of a texture statement; options with an on/off or name value take one.
const OPTION_VALUES: [(&str, usize); 12] = [
    ("-o", 3),
    ("-s", 3),
    ("-t", 3),
    ("-mm", 2),
    ("-blendu", 1),
    ("-blendv", 1),
    ("-cc", 1),
    ("-clamp", 1),
    ("-texres", 1),
    ("-bm", 1),
    ("-boost", 1),
    ("-imfchan", 1),
];

/// A material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name that `usemtl` refers to.
    pub name: String,
    /// Diffuse colour, red, green, blue in [0, 1], if given.
    pub diffuse: Option<[f32; 3]>,
    /// The diffuse texture (`map_Kd`), found relative to the library.
    pub texture: Option<PathBuf>,
}

/// Reads the materials of all libraries that a mesh names.
///
/// A missing library is an error of its own, because meshes are often passed on without it: callers that can do without
/// materials may ignore it.
pub fn read_materials(mesh: &MeshFile) -> Result<Vec<Material>> {
    let folder = mesh.path.parent().unwrap_or(Path::new(""));
    let mut materials = Vec::new();
    for name in &mesh.material_libraries {
        materials.extend(read_library(&folder.join(name))?);
    }
    Ok(materials)
}

/// Reads one MTL file.
pub fn read_library(path: &Path) -> Result<Vec<Material>> {
    let text = String::from_utf8_lossy(&super::read_bytes(path)?).into_owned();
    let accepted: String = text.lines().filter(|line| is_sound(line)).flat_map(|line| [line.trim(), "\n"]).collect();
    let (materials, _) = tobj::load_mtl_buf(&mut accepted.as_bytes()).map_err(|e| {
        Error::input(format!("unreadable material library: {e}")).file(path).remedy("export the materials again")
    })?;
    let folder = path.parent().unwrap_or(Path::new(""));
    Ok(materials.into_iter().map(|m| material(m, folder)).collect())
}

/// True for the statements used here, in the form that tobj accepts.
fn is_sound(line: &str) -> bool {
    let mut words = line.split_whitespace();
    match words.next() {
        Some("newmtl" | "map_Kd") => words.next().is_some(),
        Some("Kd") => words.clone().count() == 3 && words.all(|w| w.parse::<f32>().is_ok()),
        _ => false,
    }
}

fn material(m: tobj::Material, folder: &Path) -> Material {
    let texture = m.diffuse_texture.as_deref().and_then(texture_name).map(|name| folder.join(name));
    Material { name: m.name, diffuse: m.diffuse, texture }
}

/// The file name of a texture statement, after its options; with forward slashes.
fn texture_name(statement: &str) -> Option<String> {
    let mut rest = statement.trim();
    while rest.starts_with('-') {
        let (option, tail) = rest.split_once(char::is_whitespace)?;
        let values = OPTION_VALUES.iter().find(|(name, _)| *name == option).map_or(0, |&(_, n)| n);
        rest = tail.trim_start();
        for i in 0..values {
            let (value, tail) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
            if i > 0 && value.parse::<f64>().is_err() {
                break; // the second and third value of -o, -s and -t may be left out
            }
            rest = tail.trim_start();
        }
    }
    (!rest.is_empty()).then(|| rest.replace('\\', "/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texture_names_follow_their_options() {
        for (statement, name) in [
            ("skin.png", "skin.png"),
            ("my skin.png", "my skin.png"),
            ("-s 1 1 1 -clamp on tex\\skin.png", "tex/skin.png"),
            ("-o 0.5 skin.png", "skin.png"),
            ("-mm 0 1 -bm 2 skin.png", "skin.png"),
        ] {
            assert_eq!(texture_name(statement).as_deref(), Some(name), "{statement}");
        }
        assert_eq!(texture_name("-clamp on"), None);
    }

    #[test]
    fn odd_lines_are_left_out() {
        for line in ["Kd 0.5", "Kd a b c", "newmtl", "map_Kd", "# Kd 1 1 1", "", "illum x"] {
            assert!(!is_sound(line), "{line}");
        }
        assert!(is_sound("Kd 1 0.5 0") && is_sound("newmtl skin"));
    }
}
