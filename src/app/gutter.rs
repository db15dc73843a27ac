//! Gutters: texels that no triangle covers show what the nearest covered one does.
//!
//! The image goes by twice. The first time the places are noted where columns enter the covered part; the second time every
//! column knows the nearest covered texel above and below, and a row's nearest ones follow from the columns'.

use super::canvas::Band;
use crate::kernel::Texel;
use rayon::prelude::*;
use std::ops::Range;

/// Columns that a thread looks through at a time.
const COLUMNS: usize = 64;
/// No row.
const NOWHERE: u32 = u32::MAX;

/// A covered texel of a column.
#[derive(Clone, Copy)]
struct Seen {
    row: usize,
    texel: Texel,
}

/// Fills the texels that no triangle covers, band after band.
pub(super) struct Gutter {
    width: usize,
    limit: u32,
    /// For every column the covered texels below uncovered ones, or at the top.
    tops: Vec<Vec<Seen>>,
    /// For every column whether its last texel was covered, while they are noted.
    was_covered: Vec<bool>,
    /// For every column how many of them lie above the end of the band at hand.
    passed: Vec<usize>,
    /// For every column the last covered texel above the band at hand.
    above: Vec<Option<Seen>>,
    /// For every texel of the band the covered one nearest in its column: its row. Some columns, row by row, then the next.
    nearest: Vec<u32>,
}

impl Gutter {
    /// For an image of this width; texels farther than `limit` from any covered one stay empty.
    pub fn new(width: usize, limit: u32) -> Gutter {
        Gutter {
            width,
            limit,
            tops: vec![Vec::new(); width],
            was_covered: vec![false; width],
            passed: vec![0; width],
            above: vec![None; width],
            nearest: Vec::new(),
        }
    }

    /// Notes where the columns of the next band enter the covered part; they come from the top.
    pub fn look(&mut self, band: &Band) {
        let columns = self.tops.par_chunks_mut(COLUMNS).zip(self.was_covered.par_chunks_mut(COLUMNS)).enumerate();
        columns.for_each(|(chunk, (tops, was_covered))| {
            for (row, line) in (band.first_row..).zip(band.texels.chunks(self.width)) {
                let line = &line[chunk * COLUMNS..];
                for ((texel, tops), was_covered) in line.iter().zip(&mut *tops).zip(&mut *was_covered) {
                    let is_covered = texel.covers > 0;
                    if is_covered && !*was_covered {
                        tops.push(Seen { row, texel: *texel });
                    }
                    *was_covered = is_covered;
                }
            }
        });
    }

    /// Fills the next band; they come from the top.
    pub fn fill(&mut self, band: &mut Band) {
        self.look_along_columns(band);
        let rows = band.first_row..band.first_row + band.rows;
        let filled: Vec<Vec<(usize, Texel)>> = rows.into_par_iter().map(|row| self.filled(band, row)).collect();
        for (line, filled) in band.texels.chunks_mut(self.width).zip(filled) {
            filled.into_iter().for_each(|(x, texel)| line[x] = texel);
        }
        self.pass(band);
    }

    /// Finds for every texel the nearest covered one in its column; the one above if there are two.
    fn look_along_columns(&mut self, band: &Band) {
        let (first_row, end) = (band.first_row as u32, (band.first_row + band.rows) as u32);
        self.nearest.resize(self.width.next_multiple_of(COLUMNS) * band.rows, NOWHERE);
        let chunks = self.nearest.par_chunks_mut(COLUMNS * band.rows).zip(self.passed.par_chunks_mut(COLUMNS));
        chunks.enumerate().for_each(|(chunk, (nearest, passed))| {
            let columns = chunk * COLUMNS..chunk * COLUMNS + passed.len();
            let line = |row: u32| &band.texels[(row - first_row) as usize * self.width..][columns.clone()];
            let mut above = [NOWHERE; COLUMNS];
            for (above, seen) in above.iter_mut().zip(&self.above[columns.clone()]) {
                *above = seen.map_or(NOWHERE, |seen| seen.row as u32);
            }
            for (row, nearest) in (first_row..).zip(nearest.chunks_mut(COLUMNS)) {
                for ((texel, above), nearest) in line(row).iter().zip(&mut above).zip(nearest) {
                    *above = if texel.covers > 0 { row } else { *above };
                    *nearest = *above;
                }
            }
            let mut below = [NOWHERE; COLUMNS];
            for ((below, tops), passed) in below.iter_mut().zip(&self.tops[columns.clone()]).zip(passed) {
                *passed += tops[*passed..].iter().take_while(|seen| seen.row < end as usize).count();
                *below = tops.get(*passed).map_or(NOWHERE, |seen| seen.row as u32);
            }
            for (row, nearest) in (first_row..end).rev().zip(nearest.chunks_mut(COLUMNS).rev()) {
                for ((texel, below), nearest) in line(row).iter().zip(&mut below).zip(nearest) {
                    *below = if texel.covers > 0 { row } else { *below };
                    let far = row.checked_sub(*nearest).unwrap_or(NOWHERE);
                    *nearest = if far <= *below - row { *nearest } else { *below };
                }
            }
        });
    }

    /// What the uncovered texels of a row show, those that are near enough to covered ones.
    fn filled(&self, band: &Band, row: usize) -> Vec<(usize, Texel)> {
        let line = &band.texels[(row - band.first_row) * self.width..][..self.width];
        let mut filled = Vec::new();
        let mut next = 0;
        while let Some(first) = line[next..].iter().position(|texel| texel.covers == 0).map(|x| next + x) {
            // Gutters whose texels may show the same covered one go together.
            let gap = self.limit as usize * 2;
            let (mut end, mut covered) = (first, 0);
            while end + covered < self.width && covered <= gap {
                let is_covered = line[end + covered].covers > 0;
                (end, covered) = if is_covered { (end, covered + 1) } else { (end + covered + 1, 0) };
            }
            self.fill_columns(band, row, first..end, &mut filled);
            next = end;
        }
        filled
    }

    /// Finds the nearest covered texel for the uncovered ones of a row in some columns, by the lower envelope of the columns'
    /// distances (P. Felzenszwalb, D. Huttenlocher, "Distance transforms of sampled functions", 2012).
    fn fill_columns(&self, band: &Band, row: usize, columns: Range<usize>, filled: &mut Vec<(usize, Texel)>) {
        let limit = self.limit as usize;
        let nearest = |x: usize| self.nearest_row(band, row, x);
        let sq = |x: usize| -> Option<i64> {
            let d = nearest(x)?.abs_diff(row);
            (d <= limit).then_some((d * d) as i64)
        };
        // Columns of the envelope, and from which column on each is the nearest.
        let mut envelope: Vec<(usize, i64)> = Vec::new();
        for x in columns.start.saturating_sub(limit)..columns.end.saturating_add(limit).min(self.width) {
            let Some(d) = sq(x) else { continue };
            let from = loop {
                let Some(&(q, start)) = envelope.last() else { break 0 };
                // The first column that is strictly nearer to x than to q.
                let (x, q) = (x as i64, q as i64);
                let dq = sq(q as usize).unwrap_or(0); // the envelope's columns have one
                let from = (d + x * x - dq - q * q).div_euclid(2 * (x - q)) + 1;
                if from > start {
                    break from;
                }
                envelope.pop();
            };
            envelope.push((x, from));
        }
        let line = &band.texels[(row - band.first_row) * self.width..][..self.width];
        let reach = (limit as i64).saturating_mul(limit as i64);
        let mut at = 0;
        for x in columns {
            while envelope.get(at + 1).is_some_and(|&(_, from)| from <= x as i64) {
                at += 1;
            }
            let Some(&(column, _)) = envelope.get(at) else { return };
            if line[x].covers > 0 {
                continue;
            }
            let across = x.abs_diff(column) as i64;
            if let (Some(seen), Some(down)) = (nearest(column), sq(column))
                && across * across + down <= reach
                && let Some(texel) = self.texel(band, seen, column)
            {
                filled.push((x, Texel { covers: 0, ..texel }));
            }
        }
    }

    /// The row of the covered texel nearest to a row in its column, as far as there is one.
    fn nearest_row(&self, band: &Band, row: usize, column: usize) -> Option<usize> {
        let line = column / COLUMNS * band.rows + (row - band.first_row);
        let nearest = self.nearest[line * COLUMNS + column % COLUMNS];
        (nearest != NOWHERE).then_some(nearest as usize)
    }

    /// The covered texel of a column in a row of the band, the last one above, or the first one below it.
    fn texel(&self, band: &Band, row: usize, column: usize) -> Option<Texel> {
        if row < band.first_row {
            self.above[column].map(|seen| seen.texel)
        } else if row < band.first_row + band.rows {
            Some(band.texels[(row - band.first_row) * self.width + column])
        } else {
            self.tops[column].get(self.passed[column]).map(|seen| seen.texel)
        }
    }

    /// Notes the last covered texels of a band.
    fn pass(&mut self, band: &Band) {
        self.above.par_chunks_mut(COLUMNS).enumerate().for_each(|(chunk, above)| {
            for (x, above) in (chunk * COLUMNS..).zip(above) {
                let texel = |row: usize| band.texels[(row - band.first_row) * self.width + x];
                let mut rows = (band.first_row..band.first_row + band.rows).rev();
                let last = rows.find(|&row| texel(row).covers > 0);
                *above = last.map(|row| Seen { row, texel: texel(row) }).or(*above);
            }
        });
    }
}
