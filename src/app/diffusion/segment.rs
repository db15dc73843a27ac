//! Regions without a region file: cells of fronts from points that are as far apart as can be.
//!
//! DIFFUSION 4 leaves this to a future version. Points are put where the fronts from the earlier ones arrive last; faces go
//! to the nearest. A cell that is no disc (a ring around a limb, one with a handle) is divided in two, over and over, and so
//! are the largest ones if there are too few then.

use super::bisect::{Seam, across, corner_of, lengthwise, rim_length};
use super::disc::{Labels, area_of, disc_of, faces_by_region, rims_of};
use crate::error::{Error, Result};
use crate::mesh::io::{Region, Regions};
use crate::mesh::{FaceId, Id, TriMesh, VertexId, corner, face_of};
use crate::path::front::front;

/// Rounds of moving faces that jut out over to the neighbour; borders settle after a few.
const SMOOTHINGS: usize = 8;

/// How many segmentations there are to choose from.
pub const VARIANTS: usize = 16;

/// Divides a mesh into `count` regions that are discs, named `region-1` and so on.
///
/// # Errors
/// Unsolvable, if the surface needs more regions than that; usage, for none at all.
pub fn segment(mesh: &TriMesh, count: usize) -> Result<Regions> {
    segment_variant(mesh, count, 0)
}

/// The same around other points: the first one of a variant other than 0 lies anywhere.
pub fn segment_variant(mesh: &TriMesh, count: usize, variant: usize) -> Result<Regions> {
    if count == 0 {
        return Err(Error::usage("no regions to make").remedy("use --segment with a number from 1 on"));
    }
    let pieces = mesh.conn.components().iter().max().map_or(1, |&last| last as usize + 1);
    let sites = sites(mesh, count.max(pieces), variant);
    let mut fewest = usize::MAX;
    let mut wanted = count;
    while wanted >= pieces.max(1) {
        let labels = into_discs(mesh, cells(mesh, &sites[..wanted.min(sites.len())]))?;
        let made = labels.iter().max().map_or(0, |&last| last as usize + 1);
        if made > count {
            fewest = fewest.min(made);
            wanted -= (made - count).div_ceil(2).clamp(1, wanted);
        } else if faces_by_region(&labels, made).into_iter().all(|faces| is_four_sided(mesh, &labels, faces)) {
            return Ok(named(filled_up(mesh, labels, count)?));
        } else {
            wanted -= 1;
        }
    }
    let remedy = if fewest == usize::MAX { "ask for fewer".to_owned() } else { format!("ask for {fewest} or more") };
    Err(Error::unsolvable(format!("the surface cannot be divided into {count} discs")).remedy(remedy))
}

/// True for a disc with edges enough for four sides: the thin end of a limb may have only three around it.
fn is_four_sided(mesh: &TriMesh, labels: &Labels, faces: Vec<FaceId>) -> bool {
    disc_of(mesh, labels, faces).is_ok_and(|disc| disc.rim.len() >= 4)
}

/// Vertices, each where the fronts from the earlier ones arrive last; components without one come first.
fn sites(mesh: &TriMesh, count: usize, variant: usize) -> Vec<VertexId> {
    let used: Vec<VertexId> = mesh.conn.vertices().filter(|&v| mesh.conn.leaving(v).is_some()).collect();
    let Some(&first) = used.get(variant * used.len() / VARIANTS) else { return Vec::new() };
    let farthest = |sites: &[VertexId]| {
        let reached = front(mesh, sites).distance;
        let farther = |f: &FaceId, g: &FaceId| reached[*f].total_cmp(&reached[*g]).then(g.cmp(f));
        mesh.conn.faces().max_by(farther).map_or(first, |f| mesh.face(f)[0])
    };
    let mut sites = vec![if variant == 0 { farthest(&[first]) } else { first }];
    while sites.len() < count {
        sites.push(farthest(&sites));
    }
    sites
}

/// The faces nearest to every site, with smooth borders.
fn cells(mesh: &TriMesh, sites: &[VertexId]) -> Labels {
    let source = front(mesh, sites).source;
    let mut labels: Labels = source.iter().map(|s| s.map_or(0, |site| site.index() as u32)).collect();
    settle(mesh, &mut labels);
    compact(&labels)
}

/// Moves faces that jut out into a neighbour over to it, a few rounds long: borders get smoother, regions stay discs.
pub fn settle(mesh: &TriMesh, labels: &mut Labels) {
    for _ in 0..SMOOTHINGS {
        let jutting: Vec<FaceId> = mesh.conn.faces().filter(|&f| juts_into(mesh, labels, f).is_some()).collect();
        for f in jutting {
            if let Some(other) = juts_into(mesh, labels, f) {
                labels[f] = other;
            }
        }
    }
}

/// The region that a face shares two sides with, if all faces at the vertex between them are in it or in the face's own.
fn juts_into(mesh: &TriMesh, labels: &Labels, f: FaceId) -> Option<u32> {
    let beyond = |i: usize| mesh.conn.twin(corner(f, i % 3)).map(|t| labels[face_of(t)]).filter(|&r| r != labels[f]);
    (0..3).find_map(|i| {
        let other = beyond(i).filter(|&r| beyond(i + 1) == Some(r))?;
        let tip = mesh.conn.to(corner(f, i));
        let fits = |h| labels[face_of(h)] == other || face_of(h) == f;
        (!mesh.conn.is_on_boundary(tip) && mesh.conn.outgoing(tip).all(fits) && beyond(i + 2).is_none())
            .then_some(other)
    })
}

/// Numbers without gaps, in the order of the first face.
fn compact(labels: &Labels) -> Labels {
    let mut number = std::collections::HashMap::new();
    labels
        .iter()
        .map(|r| {
            let next = number.len() as u32;
            *number.entry(*r).or_insert(next)
        })
        .collect()
}

/// Divides regions that are no discs until all are.
fn into_discs(mesh: &TriMesh, mut labels: Labels) -> Result<Labels> {
    let mut regions = labels.iter().max().map_or(0, |&last| last as usize + 1);
    let most = 4 * regions + 256;
    let mut r = 0;
    while r < regions {
        let faces = faces_by_region(&labels, regions).swap_remove(r);
        if disc_of(mesh, &labels, faces.clone()).is_ok() {
            r += 1;
            continue;
        }
        if regions >= most || faces.len() < 2 {
            let what = "the surface cannot be divided into discs";
            return Err(Error::unsolvable(what).at(faces[0]).remedy("repair or remesh it there"));
        }
        divide(mesh, &mut labels, &faces, regions as u32);
        regions += 1;
    }
    Ok(labels)
}

/// Gives about half of a region's faces a new number: of one with several rims lengthwise.
fn divide(mesh: &TriMesh, labels: &mut Labels, faces: &[FaceId], number: u32) {
    let rims = rims_of(mesh, labels, faces);
    let longest = (0..rims.len()).max_by(|&i, &j| rim_length(mesh, &rims[i]).total_cmp(&rim_length(mesh, &rims[j])));
    let part = match longest.filter(|_| rims.len() > 1) {
        Some(rim) => lengthwise(mesh, labels, faces, Seam { rim, place: corner_of(mesh, &rims[rim]) }),
        None => across(mesh, labels, faces),
    };
    let rest = if part.len() == faces.len() { across(mesh, labels, faces) } else { part };
    rest.into_iter().for_each(|f| labels[f] = number);
}

/// Divides the largest regions until there are enough.
fn filled_up(mesh: &TriMesh, mut labels: Labels, count: usize) -> Result<Labels> {
    loop {
        let regions = labels.iter().max().map_or(0, |&last| last as usize + 1);
        if regions >= count {
            return Ok(labels);
        }
        let faces = faces_by_region(&labels, regions);
        let mut order: Vec<usize> = (0..regions).collect();
        order.sort_by(|&i, &j| area_of(mesh, &faces[j]).total_cmp(&area_of(mesh, &faces[i])));
        let halves = order.into_iter().filter(|&r| faces[r].len() > 1).find_map(|r| {
            let mut trial = labels.clone();
            divide(mesh, &mut trial, &faces[r], regions as u32);
            let parts = faces_by_region(&trial, regions + 1);
            let sound = [r, regions].iter().all(|&p| is_four_sided(mesh, &trial, parts[p].clone()));
            sound.then_some(trial)
        });
        labels = halves.ok_or_else(|| {
            Error::unsolvable(format!("the surface cannot be divided into {count} discs"))
                .remedy(format!("ask for {regions} or fewer"))
        })?;
    }
}

fn named(labels: Labels) -> Regions {
    let count = labels.iter().max().map_or(0, |&last| last + 1);
    let list = (1..=count).map(|i| Region { name: format!("region-{i}"), sides: None }).collect();
    Regions { path: std::path::PathBuf::new(), list, of_triangle: labels.raw }
}
