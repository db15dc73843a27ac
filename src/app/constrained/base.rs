//! A base mesh over the features' next places, whose edges are paths on the disc: with the paths straight the disc follows,
//! patch by patch (WARP 4.2 and 4.3).
//!
//! ```text
//! next places and ring --Delaunay--> base mesh
//! its edges --network.rs--> paths on the disc and its scaffold, wherever the features are
//! base triangles --embed_patch--> the disc within straight sides
//! ```
//!
//! The paper lays paths where the features are and exchanges one at every swap of a warp (`plane::warp`); where features go
//! far the paths then wind around each other without end. Here they are laid for where the features go at once.
//!
//! Invariant: base triangles are exactly counter-clockwise, and each holds a convex embedding of the faces between its paths,
//! so nothing folds; rounding is checked exactly.

use super::network::{Network, lifted, too_fine};
use super::refined::Refined;
use super::sheet::{Framed, SIDE, Sheet};
use crate::error::{Error, Result};
use crate::mesh::{FaceId, Id, TriMesh, VertexId};
use crate::path::cut_mesh::CutMesh;
use crate::plane::convex::embed_patch;
use crate::plane::divide::split_dividing_edges;
use crate::plane::orientation::orientation;
use crate::plane::patch_disc::{PatchDisc, arc_shares, patch_discs};
use crate::plane::stretch::Frame;
use crate::plane::warp::Triangulation;
use glam::DVec2;
use rayon::prelude::*;
use spade::{DelaunayTriangulation, Point2, Triangulation as _};

/// Times that all paths are laid anew at most.
const RELAYS: usize = 4;

/// The disc and its scaffold, in which paths are laid.
struct Ground {
    mesh: TriMesh,
    /// The vertices that are the base mesh's points: the features, then some of the border.
    points: Vec<VertexId>,
    /// The border, from the first of those on.
    rim: Vec<VertexId>,
}

impl Ground {
    fn of(sheet: &Sheet) -> Result<Self> {
        let even = vec![1.0; sheet.triangles.len()];
        let framed = sheet.framed(&even).ok_or_else(|| Error::bug("the boundary of the disc has met itself"))?;
        let Framed { domain, .. } = framed;
        let mesh = lifted(&domain.positions, &domain.triangles)?;
        let rim: Vec<VertexId> = (0..sheet.ring.len()).map(|i| VertexId::new(sheet.uv.len() + i)).collect();
        // Half of the border's points are enough for its hull, and fewer points make fewer paths.
        let corners = rim.iter().copied().step_by(SIDE / 2);
        let points = sheet.features.iter().map(|f| VertexId(f.vertex)).chain(corners).collect();
        Ok(Ground { mesh, points, rim })
    }

    /// Where the base mesh's points are.
    fn places(&self) -> Vec<DVec2> {
        self.points.iter().map(|&v| self.mesh.positions[v].truncate()).collect()
    }
}

/// Brings the features to places, one for each, by a base mesh over these whose paths lie on the disc as they can; the disc
/// gets the vertices that paths need.
///
/// # Errors
/// Unsolvable if double precision cannot hold the patches, or if paths need more than `most` times as many vertices as
/// there are.
pub fn place_by_paths(refined: &Refined, to: &[DVec2], most: usize) -> Result<Refined> {
    let ground = Ground::of(&refined.sheet)?;
    let mut places = ground.places();
    places[..to.len()].copy_from_slice(to);
    let base = guiding(&places)?;
    let most = most.saturating_mul(ground.mesh.positions.len());
    let network = Network::grow(&ground.mesh, &base, &ground.points, &ground.rim, most)?;
    let network = relaid(network, &base)?;
    placed(refined, network, &ground.mesh, &base)
}

/// The disc with the vertices that paths need, these straight between the base mesh's points.
fn placed(refined: &Refined, network: Network, mesh: &TriMesh, base: &Triangulation) -> Result<Refined> {
    let (cut, uv) = straightened(network, mesh, base)?;
    let mut refined = refined.divided(&cut, mesh, &uv);
    let Sheet { features, uv, .. } = &mut refined.sheet;
    (0u32..).zip(features).for_each(|(i, f)| uv[f.vertex as usize] = base.point(i));
    if refined.sheet.folded() > 0 {
        return Err(too_fine());
    }
    Ok(refined)
}

/// The cut mesh and a place for every vertex: paths straight between the base mesh's points, the faces between them
/// embedded.
fn straightened(network: Network, mesh: &TriMesh, base: &Triangulation) -> Result<(CutMesh, Vec<DVec2>)> {
    let complex = network.complex(base.triangles())?;
    let mut cut = network.into_cut();
    split_dividing_edges(&mut cut, mesh);
    let mut discs = patch_discs(&cut, &complex, &arc_shares(&cut, &complex)?)?;
    let triangles: Vec<[DVec2; 3]> = base.triangles().map(|t| t.map(|v| base.point(v))).collect();
    let embed = |(disc, [a, b, c]): (&mut PatchDisc, &[DVec2; 3])| {
        let points: Vec<_> = disc.vertices.iter().map(|&v| cut.positions[v]).collect();
        let frame = Frame::with_sides([a.distance(*b), b.distance(*c), c.distance(*a)]);
        embed_patch(disc, &points, &frame).is_some()
    };
    if !discs.raw.par_iter_mut().zip(&triangles).map(embed).reduce(|| true, |a, b| a && b) {
        return Err(too_fine());
    }
    let uv = place(&discs.raw, &triangles, cut.conn.vertex_count());
    let is_upright = |f: FaceId| {
        let [a, b, c] = cut.conn.face(f).map(|v| uv[v.index()]);
        orientation(a, b, c) > 0.0
    };
    if cut.conn.faces().all(is_upright) { Ok((cut, uv)) } else { Err(too_fine()) }
}

/// Lays all paths anew as long as that takes out vertices.
fn relaid<'a>(mut network: Network<'a>, base: &Triangulation) -> Result<Network<'a>> {
    for _ in 0..RELAYS {
        let mut next = network.clone();
        next.relay(base)?;
        if next.added() >= network.added() {
            break;
        }
        network = next;
    }
    Ok(network)
}

/// The Delaunay triangulation of the features, where they are, and the ring.
fn guiding(points: &[DVec2]) -> Result<Triangulation> {
    let mut delaunay = DelaunayTriangulation::<Point2<f64>>::new();
    for (i, p) in points.iter().enumerate() {
        let inserted = delaunay.insert(Point2::new(p.x, p.y)).ok().filter(|h| h.index() == i);
        inserted.ok_or_else(|| Error::bug("two features lie at one place of the embedding").at(i))?;
    }
    let triangles: Vec<[u32; 3]> =
        delaunay.inner_faces().map(|f| f.vertices().map(|v| v.fix().index() as u32)).collect();
    Triangulation::new(points.to_vec(), &triangles).ok_or_else(|| Error::bug("a Delaunay triangulation is none"))
}

/// The place of every vertex of the cut mesh, from the first patch that has it.
fn place(discs: &[PatchDisc], triangles: &[[DVec2; 3]], vertices: usize) -> Vec<DVec2> {
    let mut uv = vec![DVec2::NAN; vertices];
    for (disc, &[a, b, c]) in discs.iter().zip(triangles) {
        for (&v, p) in disc.vertices.iter().zip(&disc.positions) {
            if uv[v.index()].is_nan() {
                uv[v.index()] = a + (b - a) * p.x + (c - a) * p.y;
            }
        }
    }
    uv
}
