//! The layouts of a pair, in the way that was asked for.

use super::job::LayoutMethod;
use crate::error::{Error, Result};
use crate::gpu::Compute;
use crate::mesh::{Id, LandmarkId, TriMesh};
use crate::stage::check::Checked;
use crate::stage::cluster::BaseVertices;
use crate::stage::compose::compose;
use crate::stage::embed::embed;
use crate::stage::greedy::Greedy;
use crate::stage::hypothesis::Rough;
use crate::stage::layout::{Layout, greedy_layout, guided_by, guided_layouts, layouts};
use crate::stage::relax::{RelaxOptions, relax_arcs};
use glam::DVec3;

/// Least number of nodes on an edge that arcs may cross it at (VORONOI 4: b = 3); fewer make arcs longer, more slower.
const EDGE_NODES: u32 = 3;

/// Layouts that are embedded and relaxed coarsely before the best is chosen; more cost time and hardly ever win.
const CANDIDATES: usize = 3;

/// Lays out both meshes; the layouts that may become the map, the one with the shortest arcs first.
pub fn lay_out(
    compute: &Compute,
    checked: &Checked,
    sets: &[BaseVertices],
    method: LayoutMethod,
) -> Result<Vec<Layout>> {
    let meshes = checked.meshes();
    let set = sets.first().ok_or_else(|| Error::bug("no base vertices"));
    match method {
        LayoutMethod::Voronoi => layouts(meshes, sets, EDGE_NODES, CANDIDATES),
        LayoutMethod::Hypothesis { cycles } => hypothesis(compute, meshes, set?, cycles),
        LayoutMethod::Greedy => match greedy_layout(meshes, set?, EDGE_NODES)? {
            Greedy::Complete(layout) => Ok(vec![layout]),
            Greedy::Stuck(ends) => Err(stuck(checked, ends)),
        },
    }
}

/// Layouts along the hypotheses of least-squares meshes, then along those of the map that the last of them leads to; the
/// one with the shortest arcs first.
fn hypothesis(compute: &Compute, meshes: [&TriMesh; 2], set: &BaseVertices, cycles: u32) -> Result<Vec<Layout>> {
    let mut all = guided_layouts(meshes, set, EDGE_NODES)?;
    let mut last = all[0].clone();
    for _ in 1..cycles {
        let rough = finished_map(compute, meshes, last)?;
        let guided = guided_by(meshes, set, &rough, EDGE_NODES)?;
        last = guided[0].clone();
        all.extend(guided);
    }
    all.sort_by(|a, b| a.size(meshes).total_cmp(&b.size(meshes)));
    all.truncate(CANDIDATES);
    Ok(all)
}

/// Where the map that a layout leads to takes the vertices of the source; what no face uses counts for nothing.
fn finished_map(compute: &Compute, meshes: [&TriMesh; 2], layout: Layout) -> Result<Rough> {
    let (mut embedding, _) = embed(meshes, layout)?;
    let short = RelaxOptions { coarse_rounds: 1, fine_rounds: 0, flips: false, ..RelaxOptions::default() };
    relax_arcs(compute, meshes, &mut embedding, &short)?;
    let [map, _] = compose(meshes, embedding)?.maps;
    Ok(map.images.iter().map(|image| image.map_or(DVec3::ZERO, |p| p.position(meshes[1]))).collect())
}

fn stuck(checked: &Checked, ends: [LandmarkId; 2]) -> Error {
    let name = |l: LandmarkId| match checked.landmark_order.get(l.index()) {
        Some(&given) => format!("'{}'", checked.landmarks.names[given]),
        None => "a vertex of its own".to_owned(),
    };
    let [from, to] = ends.map(name);
    Error::unsolvable("the greedy layout is stuck: it places no arc")
        .at(format!("from {from} to {to}"))
        .remedy("use --layout voronoi or hypothesis")
}
