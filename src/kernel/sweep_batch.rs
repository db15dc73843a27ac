//! Sweeps over many domains at once: those of one mesh pair that share no patch, or of several pairs.
//!
//! Domains share no vertex, so all of them form one graph, and one dispatch per colour serves them all. A sweep goes
//! through the colours forwards, the next one backwards. Jobs that wait for the device go together, see [`Gather`].

use glam::{DMat2, DVec2, Mat2};
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::gpu::{Compute, Gather, GpuDevice, Launch};
use crate::solve::coloring::{self, Coloring};

use super::rings::Lists;
use super::sweep::{self, Moving, Sight, SweepBuffers};
use super::sweep_lanes;
use super::{Lanes, check_indices, check_len};

/// The mesh that moves in one domain.
#[derive(Clone, Debug)]
pub struct Piece {
    moving: Moving,
    coloring: Coloring,
}

impl Default for Piece {
    /// A mesh without vertices.
    fn default() -> Self {
        let fans = Lists { starts: vec![0], items: Vec::new() };
        let moving = Moving { fans, triangles: Vec::new(), sights: Vec::new(), positions: Vec::new() };
        Piece { moving, coloring: Coloring { vertices: Vec::new(), starts: vec![0] } }
    }
}

impl Piece {
    /// A mesh whose `free` vertices move; one sight per triangle, one position per vertex.
    ///
    /// Fails when the arrays do not fit together.
    pub fn new(triangles: &[[u32; 3]], sights: Vec<Sight>, positions: &[DVec2], free: &[bool]) -> Result<Piece> {
        check_indices("triangle corner", triangles.as_flattened(), positions.len())?;
        check_len("sights", sights.len(), triangles.len())?;
        check_len("free vertices", free.len(), positions.len())?;
        if triangles.len() > u32::MAX as usize / 4 {
            return Err(Error::bug(format!("{} triangles in one domain", triangles.len())));
        }
        let fans = fans(positions.len(), triangles);
        let around = neighbours(&fans, triangles, free);
        let coloring = coloring::color(positions.len(), |v| around.of(v));
        let triangles = triangles.iter().map(|&[a, b, c]| [a, b, c, 0]).collect();
        let positions = positions.iter().map(|&p| sweep::split(p)).collect();
        Ok(Piece { moving: Moving { fans, triangles, sights, positions }, coloring })
    }

    /// Where the vertices are.
    pub fn positions(&self) -> Vec<DVec2> {
        self.moving.positions.iter().map(|&p| sweep::joined(p)).collect()
    }

    /// Where a vertex is.
    pub fn position(&self, v: u32) -> DVec2 {
        sweep::joined(self.moving.positions[v as usize])
    }

    /// Puts a vertex to a place, rounded as [`sweep::split`] does.
    pub fn put(&mut self, v: u32, p: DVec2) {
        self.moving.positions[v as usize] = sweep::split(p);
    }

    /// Energy of all triangles.
    pub fn energy(&self) -> f64 {
        let Moving { triangles, sights, .. } = &self.moving;
        let one = |(sight, &[a, b, c, _]): (&Sight, &[u32; 4])| {
            let [a, b, c] = [a, b, c].map(|v| self.position(v));
            let map = DMat2::from_cols(b - a, c - a) * Mat2::from_cols_array(&sight.rest).as_dmat2();
            let seen = |[xx, xy, yy, _]: Lanes| {
                let metric = Mat2::from_cols_array(&[xx, xy, xy, yy]).as_dmat2();
                (map.transpose() * metric * map).diagonal().element_sum()
            };
            0.25 * (seen(sight.sum) + seen(sight.inverse) / map.determinant().powi(2))
        };
        sights.iter().zip(triangles).map(one).sum()
    }
}

/// Entries of the fans of all vertices: four times the triangle, plus the corner.
fn fans(vertices: usize, triangles: &[[u32; 3]]) -> Lists {
    let mut starts = vec![0u32; vertices + 1];
    for &v in triangles.as_flattened() {
        starts[v as usize + 1] += 1;
    }
    for v in 0..vertices {
        starts[v + 1] += starts[v];
    }
    let mut next = starts.clone();
    let mut items = vec![0; 3 * triangles.len()];
    for (k, &v) in triangles.as_flattened().iter().enumerate() {
        items[next[v as usize] as usize] = (k / 3 * 4 + k % 3) as u32;
        next[v as usize] += 1;
    }
    Lists { starts, items }
}

/// The vertices beside every free vertex, each once or twice; none beside the others.
fn neighbours(fans: &Lists, triangles: &[[u32; 3]], free: &[bool]) -> Lists {
    let mut around = Lists { starts: vec![0], items: Vec::with_capacity(2 * fans.items.len()) };
    for v in 0..free.len() {
        if free[v] {
            for entry in fans.of(v) {
                let corners = triangles[(entry / 4) as usize];
                around.items.extend([1, 2].map(|k| corners[(entry % 4 + k) as usize % 3]));
            }
        }
        around.starts.push(around.items.len() as u32);
    }
    around
}

/// Sweeps `count` times over all pieces; fails on a device error.
pub fn sweep_all(compute: &Compute, pieces: &mut [Piece], count: usize) -> Result<()> {
    match compute {
        Compute::Cpu => {
            pieces.par_iter_mut().for_each(|Piece { moving, coloring }| {
                for c in order(coloring.colors(), count) {
                    sweep_lanes::reference(coloring.class(c), moving);
                }
            });
            Ok(())
        }
        Compute::Gpu(gpu) => {
            let own = pieces.iter_mut().map(std::mem::take).collect();
            let gather: &Gather<Errand> = &gpu.gather();
            let swept = gather.run(Errand { pieces: own, count }, may_join, |errands| on_device(gpu, errands))?;
            pieces.iter_mut().zip(swept.pieces).for_each(|(piece, swept)| *piece = swept);
            Ok(())
        }
    }
}

/// What one caller wants swept.
struct Errand {
    pieces: Vec<Piece>,
    count: usize,
}

impl Errand {
    fn triangles(&self) -> usize {
        self.pieces.iter().map(|piece| piece.moving.triangles.len()).sum()
    }
}

/// More triangles gain nothing by going together, and buffers have limits.
const MOST_TOGETHER: usize = 1 << 18;

/// Errands go together if they want as many sweeps.
fn may_join(others: &[(usize, Errand)], errand: &Errand) -> bool {
    let total = others.iter().map(|(_, other)| other.triangles()).sum::<usize>() + errand.triangles();
    total <= MOST_TOGETHER && others.iter().all(|(_, other)| other.count == errand.count)
}

/// The colours in the order in which `count` sweeps go through them.
fn order(colors: usize, count: usize) -> impl Iterator<Item = usize> {
    (0..count).flat_map(move |k| (0..colors).map(move |c| if k % 2 == 1 { colors - 1 - c } else { c }))
}

fn on_device(gpu: &GpuDevice, errands: &mut [(usize, Errand)]) -> Result<()> {
    let count = errands.first().map_or(0, |(_, errand)| errand.count);
    let mut pieces: Vec<&mut Piece> = errands.iter_mut().flat_map(|(_, errand)| &mut errand.pieces).collect();
    let (merged, colors) = merged(&pieces)?;
    let Piece { moving, coloring } = merged;
    if coloring.vertices.is_empty() {
        return Ok(());
    }
    let buffers = SweepBuffers {
        vertices: gpu.upload("vertices", &coloring.vertices)?,
        fan_starts: gpu.upload("fan_starts", &moving.fans.starts)?,
        fans: gpu.upload("fans", &moving.fans.items)?,
        triangles: gpu.upload("triangles", &moving.triangles)?,
        sights: gpu.upload("sights", &moving.sights)?,
        positions: gpu.upload("positions", &moving.positions)?,
    };
    let launches: Vec<Launch> = (0..colors).map(|c| sweep::launch(gpu, coloring.range(c), &buffers)).collect();
    gpu.submit(order(colors, count).map(|c| &launches[c]))?;
    let positions = gpu.download(&buffers.positions)?;
    let mut rest = positions.as_slice();
    for Piece { moving, .. } in &mut pieces {
        let (own, others) = rest.split_at(moving.positions.len());
        moving.positions.copy_from_slice(own);
        rest = others;
    }
    Ok(())
}

/// All pieces as one, and the number of its colours; a piece of fewer colours rests while the others are at theirs.
fn merged(pieces: &[&mut Piece]) -> Result<(Piece, usize)> {
    let total: usize = pieces.iter().map(|p| p.moving.triangles.len()).sum();
    if total > u32::MAX as usize / 4 {
        let what = format!("{total} triangles of domains at once");
        return Err(Error::device(what).remedy("run with --device cpu"));
    }
    let colors = pieces.iter().map(|p| p.coloring.colors()).max().unwrap_or(0);
    let mut all = Piece::default().moving;
    let mut classes = vec![Vec::new(); colors];
    for Piece { moving, coloring } in pieces {
        let (vertex, triangle) = (all.positions.len() as u32, all.triangles.len() as u32);
        let entry = all.fans.items.len() as u32;
        all.fans.starts.extend(moving.fans.starts[1..].iter().map(|s| s + entry));
        all.fans.items.extend(moving.fans.items.iter().map(|e| e + 4 * triangle));
        all.triangles.extend(moving.triangles.iter().map(|&[a, b, c, _]| [a + vertex, b + vertex, c + vertex, 0]));
        all.sights.extend(&moving.sights);
        all.positions.extend(&moving.positions);
        for (c, class) in classes.iter_mut().enumerate().take(coloring.colors()) {
            class.extend(coloring.class(c).iter().map(|v| v + vertex));
        }
    }
    let mut starts = vec![0];
    for class in &classes {
        starts.push(starts[starts.len() - 1] + class.len() as u32);
    }
    let coloring = Coloring { vertices: classes.concat(), starts };
    Ok((Piece { moving: all, coloring }, colors))
}
