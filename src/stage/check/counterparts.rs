//! What two meshes must have in common, component by component and loop by loop.

use super::{LoadedMesh, SIDES};
use crate::mesh::check::Report;
use crate::mesh::io::Landmarks;
use crate::mesh::{Id, LandmarkId, TriMesh, VertexId, face_of};
use crate::path::loop_pairs::{Mismatch, pair_by_base_vertices};
use crate::path::rim::boundary_loops;
use crate::{Error, Result};
use std::fmt::Display;

/// Refuses meshes between which there is no homeomorphism, whatever the landmarks.
pub fn same_numbers(reports: [&Report; 2]) -> Result<()> {
    let components = reports.map(|r| r.components.len());
    if components[0] != components[1] {
        return Err(different("numbers of components", components, "delete the pieces without a counterpart"));
    }
    let genus = reports.map(|r| r.genus.unwrap_or_default()); // both are manifolds by now
    same_kind(genus, reports.map(|r| r.boundary_loops.len()))
}

/// Refuses components that do not correspond through the landmarks they carry, or are of different kind.
pub fn match_components(meshes: [&LoadedMesh; 2], landmarks: &Landmarks) -> Result<()> {
    if landmarks.names.is_empty() {
        let what = "there are no landmarks: nothing tells which of the infinitely many maps is meant";
        return Err(Error::unsolvable(what).remedy("give at least one, better three or more"));
    }
    let count = meshes[0].report.components.len();
    let at = [(meshes[0], &landmarks.source), (meshes[1], &landmarks.target)].map(|(m, v)| components_of(m, v));
    for side in 0..2 {
        if let Some(c) = (0..count).find(|c| !at[side].contains(c)) {
            let component = &meshes[side].report.components[c];
            let what = format!("component {c} of the {} has no landmark", SIDES[side]);
            return Err(Error::unsolvable(what)
                .at(format!("{} faces from {}", component.faces, component.first_face))
                .remedy("put a landmark on it and on its counterpart, or delete both"));
        }
        let split = |i: &usize| (0..*i).find(|&j| at[side][j] == at[side][*i] && at[1 - side][j] != at[1 - side][*i]);
        if let Some((j, i)) = (0..at[side].len()).find_map(|i| Some((split(&i)?, i))) {
            let [a, b] = [j, i].map(|i| &landmarks.names[i]);
            let what = format!(
                "landmarks \"{a}\" and \"{b}\" lie on one component of the {} but on two of the {}",
                SIDES[side],
                SIDES[1 - side]
            );
            return Err(Error::unsolvable(what).remedy("move one of them"));
        }
    }
    for (&c, &d) in at[0].iter().zip(&at[1]) {
        let pair = [&meshes[0].report.components[c], &meshes[1].report.components[d]];
        same_kind(pair.map(|p| p.genus.unwrap_or_default()), pair.map(|p| p.boundary_loops))
            .map_err(|e| e.at(format!("component {c} of the source")))?;
    }
    Ok(())
}

/// The component of every landmark.
fn components_of(mesh: &LoadedMesh, vertices: &[VertexId]) -> Vec<usize> {
    let label = mesh.mesh.conn.components();
    // Landmarks on unreferenced vertices are refused before.
    vertices.iter().map(|&v| mesh.mesh.conn.leaving(v).map_or(0, |h| label[face_of(h)] as usize)).collect()
}

/// Refuses boundary loops that do not correspond through the landmarks on them.
pub fn same_loops(meshes: [&TriMesh; 2], landmarks: &Landmarks) -> Result<()> {
    let source = boundary_loops(meshes[0], &landmarks.source);
    let target = boundary_loops(meshes[1], &landmarks.target);
    pair_by_base_vertices([&source, &target]).map(drop).map_err(|mismatch| explain(mismatch, landmarks))
}

fn same_kind(genus: [i64; 2], loops: [usize; 2]) -> Result<()> {
    if genus[0] != genus[1] {
        return Err(different("genus", genus, "look for unwanted tunnels, for instance where limbs touch"));
    }
    if loops[0] != loops[1] {
        return Err(different("numbers of boundary loops", loops, "close the extra holes; `homeo check` lists them"));
    }
    Ok(())
}

fn different<N: Display>(what: &str, [source, target]: [N; 2], remedy: &str) -> Error {
    Error::unsolvable(format!("different {what}: {source} in the source, {target} in the target")).remedy(remedy)
}

/// The refusal of boundary loops that do not correspond, with the landmarks' names.
fn explain(mismatch: Mismatch, landmarks: &Landmarks) -> Error {
    let name = |l: LandmarkId| format!("\"{}\"", landmarks.names[l.index()]);
    let vertex = |side: usize, l: LandmarkId| [&landmarks.source, &landmarks.target][side][l.index()];
    match mismatch {
        Mismatch::Count(loops) => different("numbers of boundary loops", loops, "close the extra holes"),
        Mismatch::Inside { landmark: l, outer } => {
            let inner = 1 - outer;
            let [out, within] = [SIDES[outer], SIDES[inner]];
            Error::unsolvable(format!("landmark {} lies on the boundary of the {out} but inside the {within}", name(l)))
                .at(format!("{out} {}, {within} {}", vertex(outer, l), vertex(inner, l)))
                .remedy("move it to the boundary of both meshes, or to the inside of both")
        }
        Mismatch::Split { landmarks: [a, b], together } => Error::unsolvable(format!(
            "landmarks {} and {} lie on one boundary loop of the {} but on two of the {}",
            name(a),
            name(b),
            SIDES[together],
            SIDES[1 - together]
        ))
        .remedy("move one of them"),
        Mismatch::Order { landmarks: on, reversed } => {
            let names: Vec<String> = on.into_iter().map(name).collect();
            let how = if reversed { "runs backwards" } else { "is another" };
            let remedy =
                if reversed { "left and right seem swapped in one of the files" } else { "move or rename them" };
            Error::unsolvable(format!(
                "the cyclic order of landmarks {} along their boundary loop {how} on the target",
                names.join(", ")
            ))
            .remedy(remedy)
        }
    }
}
