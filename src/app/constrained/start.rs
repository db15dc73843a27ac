//! The disc laid into the unit square, as near to its features' places as turning, scaling and moving it brings it.
//!
//! WARP 4.1 starts from Tutte's embedding. Here the boundary is let go at once and the whole relaxed, so that the features
//! have less far to go through less crowded triangles. The square's border is the ring of virtual points: the boundary
//! floats within the image.

use super::relax::{Relaxation, relax};
use super::sheet::Sheet;
use crate::error::{Error, Result};
use crate::gpu::Compute;
use crate::mesh::{FaceId, Id, VertexId};
use crate::plane::convex::embed_disc;
use crate::plane::patch_disc::PatchDisc;
use crate::plane::stretch::Frame;
use glam::DVec2;
use std::f64::consts::TAU;

/// Rounds of relaxation before the features count.
const ROUNDS: usize = 6;
/// The ring around the disc while nothing holds it, in its radii, and its points.
const FREE_RING: (f64, usize) = (2.5, 24);
/// The disc keeps this far from the border of the unit square.
const MARGIN: f64 = 0.02;
/// A turn that explains less than this share of the features' spread says nothing about how large the disc should be.
const TELLING: f64 = 0.3;

/// Embeds the disc, relaxes it, aligns it with its features' places, and puts the unit square's border around it.
///
/// # Errors
/// Unsolvable if double precision cannot hold an embedding.
pub fn start(sheet: &mut Sheet, compute: &Compute) -> Result<()> {
    embed(sheet)?;
    let (radius, points) = FREE_RING;
    let free = (0..points).map(|i| DVec2::from_angle(TAU * i as f64 / points as f64) * radius);
    let border = std::mem::replace(&mut sheet.ring, free.collect());
    let features = std::mem::take(&mut sheet.features);
    let even = vec![1.0; sheet.triangles.len()];
    relax(sheet, compute, &Relaxation { weight: &even, rounds: ROUNDS, crushed: false })?;
    sheet.features = features;
    sheet.ring = border;
    align(sheet);
    fit(sheet);
    Ok(())
}

/// The boundary on a circle by its length, every other vertex in between.
fn embed(sheet: &mut Sheet) -> Result<()> {
    let n = sheet.points.len();
    let mut number = vec![u32::MAX; n];
    let mut order = sheet.boundary.clone();
    (0u32..).zip(&order).for_each(|(i, &v)| number[v as usize] = i);
    for &v in sheet.triangles.as_flattened() {
        if number[v as usize] == u32::MAX {
            number[v as usize] = order.len() as u32;
            order.push(v);
        }
    }
    let points: Vec<_> = order.iter().map(|&v| sheet.points[v as usize]).collect();
    let boundary = sheet.boundary.len();
    let lengths: Vec<f64> = (0..boundary).map(|i| points[i].distance(points[(i + 1) % boundary])).collect();
    let mean = lengths.iter().sum::<f64>() / boundary as f64;
    // Edges without length would put two vertices at one place.
    let steps: Vec<f64> = lengths.iter().map(|l| l.max(1e-3 * mean)).collect();
    let whole: f64 = steps.iter().sum();
    let mut positions = vec![DVec2::ZERO; n];
    let mut walked = 0.0;
    for (p, step) in positions.iter_mut().zip(&steps) {
        *p = DVec2::from_angle(TAU * walked / whole);
        walked += step;
    }
    let mut disc = PatchDisc {
        vertices: order.iter().map(|&v| VertexId(v)).collect(),
        faces: (0..sheet.triangles.len()).map(FaceId::new).collect(),
        triangles: sheet.triangles.iter().map(|t| t.map(|v| number[v as usize])).collect(),
        boundary,
        corners: [0, 1, 2],
        positions,
    };
    let frame = Frame { first: DVec2::X, second: DVec2::Y };
    // All of the stretch: the boundary is let go next.
    embed_disc(&mut disc, &points, &frame, 1.0).ok_or_else(|| {
        Error::unsolvable("the mesh cannot be laid flat in double precision")
            .remedy("remove triangles without area and needles, or remesh")
    })?;
    for (&v, &p) in order.iter().zip(&disc.positions) {
        sheet.uv[v as usize] = p;
    }
    Ok(())
}

/// Shrinks and moves the disc as little as it must to lie in the unit square.
fn fit(sheet: &mut Sheet) {
    let (low, high) = bounds(&sheet.uv);
    let room = 1.0 - 2.0 * MARGIN;
    let scale = (room / (high - low).max_element()).min(1.0);
    let size = (high - low) * scale;
    let corner =
        (low + (high - low) * 0.5 * (1.0 - scale)).clamp(DVec2::splat(MARGIN), DVec2::splat(1.0 - MARGIN) - size);
    sheet.uv.iter_mut().for_each(|p| *p = corner + (*p - low) * scale);
}

fn bounds(points: &[DVec2]) -> (DVec2, DVec2) {
    points.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)))
}

/// The similarity that brings the features nearest to their places; without features the disc fills the unit square.
fn align(sheet: &mut Sheet) {
    let mean = |of: &mut dyn Iterator<Item = DVec2>, n: usize| of.sum::<DVec2>() / n as f64;
    let n = sheet.features.len();
    let (low, high) = bounds(&sheet.uv);
    let fit = 1.0 / (high - low).max_element();
    let (from, to) = match n {
        0 => ((low + high) * 0.5, DVec2::splat(0.5)),
        _ => (
            mean(&mut sheet.features.iter().map(|f| sheet.uv[f.vertex as usize]), n),
            mean(&mut sheet.features.iter().map(|f| f.place), n),
        ),
    };
    let (mut turn, mut spread, mut wanted) = (DVec2::ZERO, 0.0, 0.0);
    for f in &sheet.features {
        let (a, b) = (sheet.uv[f.vertex as usize] - from, f.place - to);
        turn += DVec2::new(a.dot(b), a.perp_dot(b));
        spread += a.length_squared();
        wanted += b.length_squared();
    }
    let agreed = turn.length() / (spread * wanted).sqrt();
    let factor = if spread == 0.0 || wanted == 0.0 {
        DVec2::new(fit, 0.0)
    } else if agreed > TELLING {
        turn / spread
    } else {
        turn.try_normalize().unwrap_or(DVec2::X) * (wanted / spread).sqrt()
    };
    for p in &mut sheet.uv {
        *p = factor.rotate(*p - from) + to;
    }
}
