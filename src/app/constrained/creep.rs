//! Features creep on where a step of all at once is cut back by the worst triangle: each goes as far as its own ring of
//! triangles lets it, and sweeps of the relaxation kernel make room for the next time.

use super::relax::{adopt, piece};
use super::sheet::{Feature, Framed, Sheet};
use super::walk::swerves;
use crate::error::Result;
use crate::gpu::Compute;
use crate::kernel::sweep_batch::{Piece, sweep_all};
use crate::plane::domain::Fans;
use crate::plane::smooth::Smoother;
use glam::DVec2;

/// Times that features move before the scaffold is made anew.
const TIMES: usize = 40;
/// Sweeps after each.
const SWEEPS: usize = 4;
/// The longest way of a feature at a time, in units of the image's side.
const STEP: f64 = 0.02;
/// A feature goes at most this share of the way to the first triangle of its ring that collapses.
const SAFE_SHARE: f64 = 0.4;
/// A feature as near to its place as this is put there; the kernel's two floats are finer.
const NEAR: f64 = 1e-9;

/// Moves the features towards their places for a while.
pub fn creep(sheet: &mut Sheet) -> Result<()> {
    let even = vec![1.0; sheet.triangles.len()];
    let Some(Framed { mut domain, shapes, weights }) = sheet.framed(&even) else { return Ok(()) };
    let fans = domain.fans();
    let triangles = domain.triangles.clone();
    let mut smoother = Smoother::shaped(&mut domain, &shapes, &weights);
    let mut pieces = [piece(&smoother)?];
    for _ in 0..TIMES {
        let positions = pieces[0].positions();
        let next = steps(&sheet.features, &positions);
        for (f, to) in sheet.features.iter().zip(next) {
            let from = positions[f.vertex as usize];
            let way = to - from;
            let share = (SAFE_SHARE * first_collapse(&triangles, &fans, &pieces[0], f.vertex, way)).min(1.0);
            pieces[0].put(f.vertex, from + way * share);
        }
        // Always here: between so few sweeps a device would mostly wait for the positions.
        sweep_all(&Compute::Cpu, &mut pieces, SWEEPS)?;
    }
    let mut moved = pieces[0].positions();
    // What does not move is put back exactly.
    let disc = sheet.uv.len();
    let fixed = (disc..moved.len()).filter(|&v| !smoother.moving().free[v]);
    fixed.for_each(|v| moved[v] = smoother.moving().positions[v]);
    for f in &sheet.features {
        let p = &mut moved[f.vertex as usize];
        if p.distance(f.place) < NEAR {
            *p = f.place;
        }
    }
    smoother.adopt(moved);
    adopt(sheet, &domain);
    Ok(())
}

/// Where every feature would go next.
fn steps(features: &[Feature], positions: &[DVec2]) -> Vec<DVec2> {
    let at: Vec<DVec2> = features.iter().map(|f| positions[f.vertex as usize]).collect();
    let to: Vec<DVec2> = features.iter().map(|f| f.place).collect();
    let swerve = swerves(&at, &to);
    let next = |i: usize| at[i] + ((to[i] - at[i]).clamp_length_max(STEP) + swerve[i].clamp_length_max(STEP));
    (0..at.len()).map(next).collect()
}

/// The share of a feature's way at which the first triangle of its ring collapses.
fn first_collapse(triangles: &[[u32; 3]], fans: &Fans, piece: &Piece, v: u32, way: DVec2) -> f64 {
    let one = |&(t, i): &(u32, u8)| {
        let corners = triangles[t as usize];
        let [p, b, c] = [0, 1, 2].map(|k| piece.position(corners[(i as usize + k) % 3]));
        let (area, loss) = ((b - p).perp_dot(c - p), way.perp_dot(c - b));
        if loss > 0.0 { area / loss } else { f64::INFINITY }
    };
    fans.around(v as usize).iter().map(one).fold(f64::INFINITY, f64::min)
}
