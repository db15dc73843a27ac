//! (u, v) for every region of a mesh from pairs of fronts, and region-wise maps between two meshes.
//!
//! After DIFFUSION: M. Schmidt, M. Guthe, V. Blanz, "Diffusion-based parametrization of surfaces on 3D-meshes".
//!
//! ```text
//! regions: a file, fronts from farthest points, a map     mesh::io, segment, through
//!    | limbs in halves, if wanted                         ends, bisect
//!    | discs, the border graph, four corners each         disc, borders, corners
//!    | or those of another mesh carried over              matching
//!    | sides with the share of the way at every vertex    outline
//!    | four fronts, (u, v)                                square, path::side_front
//!    | folds re-embedded, if wanted                       repair
//!    v
//! Diffusion --- measured                                  quality
//!    | vertex -> (region, u, v) -> surface                lookup
//!    v
//! correspondence, carried images, pictures, a folder      correspond, carry, picture, page, write
//! ```
//!
//! Invariants: u and v lie in [0, 1]; a side's vertices lie exactly on their side of the square; along a border both
//! regions have the same values up to an affine map. Fronts do not promise more: folds are counted, not ruled out, until
//! `repair` re-embeds a region, which then has none but triangles that its straight sides leave no room for.

mod bisect;
mod borders;
mod carry;
mod corners;
mod correspond;
mod disc;
mod ends;
pub mod job;
mod lookup;
mod matching;
mod outline;
mod page;
mod picture;
mod piece;
mod quality;
mod repair;
mod report;
mod segment;
mod square;
mod through;
mod write;

pub use carry::carry_image;
pub use corners::{Completion, Corners};
pub use correspond::{Correspondence, correspond};
pub use disc::Disc;
pub use ends::{Ends, split_ends};
pub use lookup::{Found, Lookup, Place};
pub use piece::Piece;
pub use quality::Quality;
pub use report::{DiffusionReport, RegionReport};
pub use segment::segment;
pub use square::Side;
pub use write::{Output, write};

use crate::error::{Error, Result};
use crate::mesh::io::Regions;
use crate::mesh::{TriMesh, VertexId};
use crate::path::side_front::Travel;
use borders::{Borders, natural_nodes};
use matching::{Divided, match_regions};
use outline::NodeShares;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// How to parametrize.
#[derive(Clone, Copy, Debug)]
pub struct DiffusionOptions {
    /// How fronts move.
    pub travel: Travel,
    /// Whether regions that fold are re-embedded.
    pub repair: bool,
}

/// A parametrized mesh.
#[derive(Clone, Debug)]
pub struct Diffusion<'m> {
    /// The mesh.
    pub mesh: &'m TriMesh,
    /// Its regions.
    pub regions: Regions,
    /// The regions with (u, v), in the same order.
    pub pieces: Vec<Piece>,
    /// How good they are, in the same order.
    pub quality: Vec<Quality>,
    /// How regions came to four sides.
    pub completions: Vec<Completion>,
    /// What is worth knowing, as sentences.
    pub warnings: Vec<String>,
    corners: Vec<Corners>,
    shares: Vec<NodeShares>,
}

/// Parametrizes a mesh; `regions` are of its faces.
///
/// # Errors
/// Input, with the region's name: no disc, sides that leave the border, cross or overlap, too short a border.
pub fn diffuse(mesh: &TriMesh, regions: Regions, options: DiffusionOptions) -> Result<Diffusion<'_>> {
    let labels = disc::labels_of(&regions);
    let discs = disc::cut_out(mesh, &regions, &labels)?;
    let mut nodes = natural_nodes(mesh, &discs);
    let (corners, completions) = corners::corners(mesh, &regions, &labels, &discs, &nodes)?;
    nodes.extend(corners.iter().flat_map(|c| c.at));
    let borders = Borders::new(mesh, &discs, &nodes);
    let sides: Vec<_> = (0..discs.len()).map(|r| outline::sides_of(mesh, &borders, r, &corners[r])).collect();
    let shares: Vec<NodeShares> = sides.iter().map(|s| outline::shares_by_length(mesh, &borders, s)).collect();
    let draft = Draft { mesh, regions, discs, corners, shares, completions };
    Ok(draft.finish(&borders, options))
}

/// Parametrizes a second mesh like a first one with the same regions: corners and the shares at nodes correspond.
///
/// # Errors
/// Those of [`diffuse`], and unsolvable, with a region's name, where the regions' borders differ.
pub fn diffuse_like<'m>(
    first: &Diffusion,
    mesh: &'m TriMesh,
    regions: Regions,
    options: DiffusionOptions,
) -> Result<Diffusion<'m>> {
    let regions = in_order_of(&first.regions, regions);
    let labels = disc::labels_of(&regions);
    let discs = disc::cut_out(mesh, &regions, &labels)?;
    let mut nodes = natural_nodes(mesh, &discs);
    let (own, _) = corners::corners(mesh, &regions, &labels, &discs, &nodes)?;
    let forced = given_on_both(first, &regions, &own)?;
    let there =
        Divided { mesh, regions: &regions, discs: &discs, borders: Borders::new(mesh, &discs, &nodes), nodes: &nodes };
    let (corners, is_symmetric) = corners_like(first, &there, &forced)?;
    nodes.extend(corners.iter().flat_map(|c| c.at));
    let borders = Borders::new(mesh, &discs, &nodes);
    let draft = Draft { mesh, regions, discs, corners, shares: first.shares.clone(), completions: Vec::new() };
    let mut diffusion = draft.finish(&borders, options);
    if is_symmetric {
        let text = "the regions fit onto each other in several ways; the one whose corners lie most alike was taken: give sides to decide it";
        diffusion.warnings.push(text.to_owned());
    }
    Ok(diffusion)
}

/// The corners of the first mesh on the second, and whether there were several ways to match the regions.
fn corners_like(
    first: &Diffusion,
    there: &Divided,
    forced: &BTreeMap<VertexId, VertexId>,
) -> Result<(Vec<Corners>, bool)> {
    let Diffusion { mesh, regions, .. } = first;
    let discs: Vec<Disc> = first.pieces.iter().map(|piece| piece.disc.clone()).collect();
    let nodes = natural_nodes(mesh, &discs);
    let here = Divided { mesh, regions, discs: &discs, borders: Borders::new(mesh, &discs, &nodes), nodes: &nodes };
    let found = match_regions(&here, there)?;
    let extra: BTreeSet<VertexId> = first.corners.iter().flat_map(|c| c.at).filter(|v| !nodes.contains(v)).collect();
    let counterparts = found.nodes(&here, there, &extra, forced)?;
    let carried = first.corners.iter().map(|c| Corners { at: c.at.map(|v| counterparts[&v]), ..*c });
    Ok((carried.collect(), found.is_symmetric))
}

/// Regions numbered as those of the first mesh with the same names; others behind them.
fn in_order_of(first: &Regions, regions: Regions) -> Regions {
    let place = |name: &str| first.list.iter().position(|r| r.name == name).unwrap_or(usize::MAX);
    let mut order: Vec<usize> = (0..regions.list.len()).collect();
    order.sort_by_key(|&i| place(&regions.list[i].name));
    let mut number = vec![0u32; order.len()];
    (0u32..).zip(&order).for_each(|(new, &old)| number[old] = new);
    Regions {
        list: order.iter().map(|&i| regions.list[i].clone()).collect(),
        of_triangle: regions.of_triangle.iter().map(|&r| number[r as usize]).collect(),
        ..regions
    }
}

/// Corners that both region files give.
fn given_on_both(first: &Diffusion, regions: &Regions, own: &[Corners]) -> Result<BTreeMap<VertexId, VertexId>> {
    let mut forced = BTreeMap::new();
    for ((a, b), region) in first.corners.iter().zip(own).zip(&regions.list) {
        let fail = |what: String, remedy: &str| Err(Error::unsolvable(what).file(&regions.path).remedy(remedy));
        match (a.given, b.given) {
            (true, true) if a.mirrored != b.mirrored => {
                let what =
                    format!("the sides of region \"{}\" run the other way round than on the first mesh", region.name);
                return fail(what, "swap u0 and u1, or v0 and v1, on one of the meshes");
            }
            (true, true) => forced.extend(a.at.into_iter().zip(b.at)),
            (false, true) => {
                let what = format!("region \"{}\" has sides here, but none on the first mesh", region.name);
                return fail(what, "give sides on both meshes, or only on the first");
            }
            _ => {}
        }
    }
    Ok(forced)
}

/// Everything but the coordinates.
struct Draft<'m> {
    mesh: &'m TriMesh,
    regions: Regions,
    discs: Vec<Disc>,
    corners: Vec<Corners>,
    shares: Vec<NodeShares>,
    completions: Vec<Completion>,
}

impl<'m> Draft<'m> {
    fn finish(self, borders: &Borders, options: DiffusionOptions) -> Diffusion<'m> {
        let Draft { mesh, regions, discs, corners, shares, completions } = self;
        let one = |(r, disc): (usize, Disc)| -> (Piece, Quality) {
            let ways = outline::sides_of(mesh, borders, r, &corners[r]);
            let sides = outline::with_shares(mesh, &disc, borders, &ways, &shares[r]);
            let st = square::square(mesh, &disc, &sides, options.travel);
            let (name, mirrored) = (regions.list[r].name.clone(), corners[r].mirrored);
            let mut piece = Piece { name, disc, sides, st, mirrored, repaired: false };
            let mut quality = quality::quality(mesh, &piece);
            if options.repair && quality.measures.flips > 0 {
                repair::repair(mesh, &mut piece);
                quality = quality::quality(mesh, &piece);
            }
            (piece, quality)
        };
        let made: Vec<(Piece, Quality)> = discs.into_par_iter().enumerate().map(one).collect();
        let (pieces, quality) = made.into_iter().unzip();
        Diffusion { mesh, regions, pieces, quality, completions, warnings: Vec::new(), corners, shares }
    }
}
