//! Gutters: texels that no triangle covers show what the nearest covered one does.
//!
//! The image goes by twice. The first time the places are noted where columns enter the covered part; the second time every
//! column knows the nearest covered texel above and below, and a row's nearest ones follow from the columns'.

use super::canvas::Band;
use crate::kernel::Texel;
use rayon::prelude::*;

/// Columns that a thread looks through at a time.
const COLUMNS: usize = 64;

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
    /// For every column how many of them lie above the row at hand.
    passed: Vec<usize>,
    /// For every column the last covered texel above.
    above: Vec<Option<Seen>>,
}

impl Gutter {
    /// For an image of this width; texels farther than `limit` from any covered one stay empty.
    pub fn new(width: usize, limit: u32) -> Gutter {
        let tops = vec![Vec::new(); width];
        Gutter { width, limit, tops, was_covered: vec![false; width], passed: vec![0; width], above: vec![None; width] }
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
        let width = self.width;
        let first_row = band.first_row;
        let lines = band.texels.chunks(width).zip(first_row..);
        let nearest: Vec<Vec<Option<Seen>>> = lines.map(|(line, row)| self.nearest_in_columns(line, row)).collect();
        let limit = self.limit;
        let rows = band.texels.par_chunks_mut(width).zip(nearest).zip(first_row..first_row + band.rows);
        rows.for_each(|((line, nearest), row)| fill_row(line, &nearest, row, limit));
    }

    /// For every column the covered texel nearest to a row; the one above if there are two.
    fn nearest_in_columns(&mut self, line: &[Texel], row: usize) -> Vec<Option<Seen>> {
        let one = |x: usize| {
            if line[x].covers > 0 {
                self.above[x] = Some(Seen { row, texel: line[x] });
                return self.above[x];
            }
            while self.tops[x].get(self.passed[x]).is_some_and(|seen| seen.row < row) {
                self.passed[x] += 1;
            }
            let below = self.tops[x].get(self.passed[x]).copied();
            match (self.above[x], below) {
                (Some(above), Some(below)) => Some(if row - above.row <= below.row - row { above } else { below }),
                (above, below) => above.or(below),
            }
        };
        (0..line.len()).map(one).collect()
    }
}

/// Gives every uncovered texel of a row what the nearest covered one shows, by the lower envelope of the columns'
/// distances (P. Felzenszwalb, D. Huttenlocher, "Distance transforms of sampled functions", 2012).
fn fill_row(line: &mut [Texel], nearest: &[Option<Seen>], row: usize, limit: u32) {
    let sq = |x: usize| -> Option<i64> {
        let d = nearest[x]?.row.abs_diff(row) as i64;
        (d <= i64::from(limit)).then_some(d * d)
    };
    // Columns of the envelope, and from which column on each is the nearest.
    let mut envelope: Vec<(usize, i64)> = Vec::new();
    for x in 0..line.len() {
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
    let reach = i64::from(limit).saturating_mul(i64::from(limit));
    let mut at = 0;
    for x in 0..line.len() {
        while envelope.get(at + 1).is_some_and(|&(_, from)| from <= x as i64) {
            at += 1;
        }
        let Some(&(column, _)) = envelope.get(at) else { return };
        if line[x].covers > 0 {
            continue;
        }
        let across = x.abs_diff(column) as i64;
        if let (Some(seen), Some(down)) = (nearest[column], sq(column))
            && across * across + down <= reach
        {
            line[x] = Texel { covers: 0, ..seen.texel };
        }
    }
}
