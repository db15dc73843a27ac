//! What two meshes must have in common, component by component and loop by loop.

use super::{LoadedMesh, SIDES};
use crate::mesh::check::Component;
use crate::mesh::io::Landmarks;
use crate::mesh::{Id, LandmarkId, VertexId, face_of};
use crate::path::loop_pairs::{Mismatch, pair_by_base_vertices};
use crate::path::rim::boundary_loops;
use crate::{Error, Result};

/// The component of the target for every component of the source.
pub type Partners = Vec<usize>;

/// Matches the components through the landmarks they carry.
pub fn match_components(meshes: [&LoadedMesh; 2], landmarks: &Landmarks) -> Result<Partners> {
    if landmarks.names.is_empty() {
        let what = "there are no landmarks: nothing tells which of the infinitely many maps is meant";
        return Err(Error::unsolvable(what).remedy("give at least one, better three or more"));
    }
    let counts = meshes.map(|m| m.report.components.len());
    if counts[0] != counts[1] {
        return Err(different("numbers of components", counts, "delete the pieces without a counterpart"));
    }
    let at = [(meshes[0], &landmarks.source), (meshes[1], &landmarks.target)].map(|(m, v)| components_of(m, v));
    for side in 0..2 {
        let bare = (0..counts[side]).find(|c| counts[side] > 1 && !at[side].contains(c));
        if let Some(c) = bare {
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
    let partner = |c: usize| at[0].iter().position(|&d| d == c).map_or(0, |i| at[1][i]);
    Ok((0..counts[0]).map(partner).collect())
}

/// The component of every landmark.
fn components_of(mesh: &LoadedMesh, vertices: &[VertexId]) -> Vec<usize> {
    let label = mesh.mesh.conn.components();
    // Landmarks on unreferenced vertices are refused before.
    vertices.iter().map(|&v| mesh.mesh.conn.leaving(v).map_or(0, |h| label[face_of(h)] as usize)).collect()
}

/// Refuses components of different kind, and boundary loops that do not correspond.
pub fn same_topology(meshes: [&LoadedMesh; 2], partners: &Partners, landmarks: &Landmarks) -> Result<()> {
    for (c, &partner) in partners.iter().enumerate() {
        let pair = [&meshes[0].report.components[c], &meshes[1].report.components[partner]];
        same_kind(pair)
            .map_err(|e| if partners.len() > 1 { e.at(format!("component {c} of the source")) } else { e })?;
    }
    let source = boundary_loops(&meshes[0].mesh, &landmarks.source);
    let target = boundary_loops(&meshes[1].mesh, &landmarks.target);
    match pair_by_base_vertices([&source, &target]) {
        Ok(_) => Ok(()),
        Err(mismatch) => Err(explain(mismatch, landmarks)),
    }
}

fn same_kind([source, target]: [&Component; 2]) -> Result<()> {
    let genus = [source, target].map(|c| c.genus.unwrap_or_default() as usize); // both are manifolds by now
    if genus[0] != genus[1] {
        return Err(different("genus", genus, "look for unwanted tunnels, for instance where limbs touch"));
    }
    let loops = [source, target].map(|c| c.boundary_loops);
    if loops[0] != loops[1] {
        return Err(different("numbers of boundary loops", loops, "close the extra holes; `homeo check` lists them"));
    }
    Ok(())
}

fn different(what: &str, [source, target]: [usize; 2], remedy: &str) -> Error {
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
