//! Which domains need another visit: not those that had little to gain and whose patches have not changed since.

use crate::mesh::{IdVec, PatchId};
use crate::plane::tiling::Tiling;
use rayon::prelude::*;

/// What happened to the domains so far.
pub(super) struct Visits {
    /// How often a patch was changed much.
    changes: IdVec<PatchId, u32>,
    /// For every domain the changes of its patches when it was found settled.
    settled: Vec<Vec<Option<Vec<u32>>>>,
    /// What gains less is settled.
    little: f64,
}

impl Visits {
    /// No domain has been visited yet; one that gains less than `little` will be settled.
    pub fn none(groups: &[Vec<Tiling>], patches: usize, little: f64) -> Self {
        let settled = groups.iter().map(|group| vec![None; group.len()]).collect();
        Visits { changes: IdVec::filled(0, patches), settled, little }
    }

    /// Visits the domains of a group that are not settled, side by side; a visit returns its result and what it gained.
    pub fn group<T: Send>(
        &mut self,
        group: usize,
        tilings: &[Tiling],
        visit: impl Fn(&Tiling) -> Option<(T, f64)> + Sync,
    ) -> Vec<Option<T>> {
        let settled = &self.settled[group];
        let is_settled = |i: usize| settled[i].as_ref().is_some_and(|then| *then == self.of(&tilings[i]));
        let one = |i: usize| if is_settled(i) { None } else { visit(&tilings[i]) };
        let results: Vec<Option<(T, f64)>> = (0..tilings.len()).into_par_iter().map(one).collect();
        let mut kept = Vec::with_capacity(results.len());
        for (i, result) in results.into_iter().enumerate() {
            let (result, gain) = result.map_or((None, 0.0), |(result, gain)| (Some(result), gain));
            self.note(group, i, &tilings[i], gain);
            kept.push(result);
        }
        kept
    }

    fn note(&mut self, group: usize, i: usize, tiling: &Tiling, gain: f64) {
        if gain < self.little {
            self.settled[group][i] = Some(self.of(tiling));
        } else {
            tiling.tiles.iter().for_each(|t| self.changes[t.patch] += 1);
        }
    }

    fn of(&self, tiling: &Tiling) -> Vec<u32> {
        tiling.tiles.iter().map(|t| self.changes[t.patch]).collect()
    }
}
