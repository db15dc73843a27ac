//! Which domains need another visit: not those that had little to gain and whose patches have not changed since.

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

    /// True if another visit of domain `i` of a group would bring next to nothing.
    pub fn is_settled(&self, group: usize, i: usize, tiling: &Tiling) -> bool {
        self.settled[group][i].as_ref().is_some_and(|then| *then == self.of(tiling))
    }

    /// Notes what a visit gained.
    pub fn note(&mut self, group: usize, i: usize, tiling: &Tiling, gain: f64) {
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
