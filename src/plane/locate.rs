//! Point location in the embedding of a patch, decided by the exact orientation predicate.

use super::orientation::orientation;
use glam::DVec2;

/// Mean number of triangles per cell of the grid; fewer cells cost more tests, more cells more memory.
const TRIANGLES_PER_CELL: f64 = 2.0;

/// A uniform grid over the reference triangle that lists the triangles meeting every cell.
pub struct Locator<'a> {
    positions: &'a [DVec2],
    triangles: &'a [[u32; 3]],
    cells: usize,
    start: Vec<u32>,
    entries: Vec<u32>,
}

impl<'a> Locator<'a> {
    /// Prepares location in an embedded patch.
    pub fn new(positions: &'a [DVec2], triangles: &'a [[u32; 3]]) -> Self {
        let cells = ((triangles.len() as f64 / TRIANGLES_PER_CELL).sqrt().ceil() as usize).max(1);
        let mut locator =
            Locator { positions, triangles, cells, start: vec![0; cells * cells + 1], entries: Vec::new() };
        for t in 0..triangles.len() {
            locator.for_cells(t, |start, cell| start[cell + 1] += 1);
        }
        for c in 0..cells * cells {
            locator.start[c + 1] += locator.start[c];
        }
        let mut fill = locator.start.clone();
        let mut entries = vec![0; locator.start[cells * cells] as usize];
        for t in 0..triangles.len() {
            locator.for_cells(t, |_, cell| {
                entries[fill[cell] as usize] = t as u32;
                fill[cell] += 1;
            });
        }
        locator.entries = entries;
        locator
    }

    /// Visits the cells that the bounding box of triangle `t` meets.
    fn for_cells(&mut self, t: usize, mut visit: impl FnMut(&mut [u32], usize)) {
        let corners = self.triangles[t].map(|v| self.positions[v as usize]);
        let low = corners.into_iter().fold(DVec2::INFINITY, DVec2::min);
        let high = corners.into_iter().fold(DVec2::NEG_INFINITY, DVec2::max);
        let ((i0, j0), (i1, j1)) = (self.cell(low), self.cell(high));
        for j in j0..=j1 {
            for i in i0..=i1 {
                visit(&mut self.start, j * self.cells + i);
            }
        }
    }

    fn cell(&self, p: DVec2) -> (usize, usize) {
        let index = |x: f64| ((x * self.cells as f64) as usize).min(self.cells - 1);
        (index(p.x), index(p.y))
    }

    /// The triangle that contains `p` and the barycentric coordinates there, none negative, sum one.
    ///
    /// None only for points outside the reference triangle.
    pub fn locate(&self, p: DVec2) -> Option<(usize, [f64; 3])> {
        let (i, j) = self.cell(p);
        let cell = j * self.cells + i;
        let candidates = &self.entries[self.start[cell] as usize..self.start[cell + 1] as usize];
        candidates.iter().find_map(|&t| Some((t as usize, self.coordinates(t as usize, p)?)))
    }

    fn coordinates(&self, t: usize, p: DVec2) -> Option<[f64; 3]> {
        let [a, b, c] = self.triangles[t].map(|v| self.positions[v as usize]);
        let areas = [orientation(b, c, p), orientation(c, a, p), orientation(a, b, p)];
        let sum: f64 = areas.iter().sum();
        (areas.iter().all(|&x| x >= 0.0) && sum > 0.0).then(|| areas.map(|x| x / sum))
    }
}
