//! The meshes of a glTF scene with their places in space.

use super::AGAIN;
use super::document::{Document, Node};
use crate::{Error, Result};
use glam::{DMat4, DQuat, DVec3};

/// A mesh in space.
pub struct PlacedMesh {
    /// Its number.
    pub mesh: usize,
    /// From its coordinates to those of the scene.
    pub transform: DMat4,
}

/// All meshes of the scene, parents before children and these in order; without a scene every mesh where it is.
pub fn placed_meshes(document: &Document) -> Result<Vec<PlacedMesh>> {
    let scene = document.scenes.get(document.scene.unwrap_or(0));
    let Some(scene) = scene.filter(|scene| !scene.nodes.is_empty()) else {
        let place = |mesh| PlacedMesh { mesh, transform: DMat4::IDENTITY };
        return Ok((0..document.meshes.len()).map(place).collect());
    };
    let mut seen = vec![false; document.nodes.len()];
    let mut placed = Vec::new();
    let mut stack: Vec<(usize, DMat4)> = scene.nodes.iter().rev().map(|&n| (n, DMat4::IDENTITY)).collect();
    while let Some((n, parent)) = stack.pop() {
        let fail = |what: &str| Error::input(what).at(format_args!("node {n}")).remedy(AGAIN);
        let node = document.nodes.get(n).ok_or_else(|| fail("a node that does not exist"))?;
        if std::mem::replace(&mut seen[n], true) {
            return Err(fail("a node with two parents"));
        }
        let transform = parent * local(node);
        if !transform.is_finite() {
            return Err(fail("the transform is not finite"));
        }
        placed.extend(node.mesh.map(|mesh| PlacedMesh { mesh, transform }));
        stack.extend(node.children.iter().rev().map(|&child| (child, transform)));
    }
    Ok(placed)
}

/// The transform of a node relative to its parent.
fn local(node: &Node) -> DMat4 {
    if let Some(matrix) = &node.matrix {
        return DMat4::from_cols_array(matrix);
    }
    let rotation = node.rotation.map_or(DQuat::IDENTITY, |q| DQuat::from_array(q).normalize());
    let [scale, shift] = [node.scale.unwrap_or([1.0; 3]), node.translation.unwrap_or_default()].map(DVec3::from_array);
    DMat4::from_scale_rotation_translation(scale, rotation, shift)
}
