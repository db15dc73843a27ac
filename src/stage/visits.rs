//! Which domains need another visit: not those that had little to gain and whose patches have not changed since.

use crate::error::Result;
use crate::mesh::{IdVec, PatchId};
use crate::plane::tiling::Tiling;

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

    /// Visits the domains of a group that are not settled, all at once; a visit returns for each its result and what it
    /// gained.
    pub fn group<T>(
        &mut self,
        group: usize,
        tilings: &[Tiling],
        visit: impl FnOnce(&[&Tiling]) -> Result<Vec<Option<(T, f64)>>>,
    ) -> Result<Vec<Option<T>>> {
        let is_due = |i: &usize| self.settled[group][*i].as_ref().is_none_or(|then| *then != self.of(&tilings[*i]));
        let due: Vec<usize> = (0..tilings.len()).filter(is_due).collect();
        let results = visit(&due.iter().map(|&i| &tilings[i]).collect::<Vec<_>>())?;
        let mut kept: Vec<Option<T>> = tilings.iter().map(|_| None).collect();
        for (i, result) in due.into_iter().zip(results) {
            let gain = result.as_ref().map_or(0.0, |(_, gain)| *gain);
            self.note(group, i, &tilings[i], gain);
            kept[i] = result.map(|(result, _)| result);
        }
        Ok(kept)
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
