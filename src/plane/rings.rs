//! Cyclic lists of neighbours, as merging vertices and bringing them back changes them.

/// Replaces the run `old` of a cyclic list by `new`.
pub(super) fn replace(ring: &mut Vec<u32>, old: &[u32], new: &[u32]) {
    let Some(mut at) = ring.iter().position(|w| *w == old[0]) else { return };
    if at + old.len() > ring.len() {
        ring.rotate_left(at);
        at = 0;
    }
    ring.splice(at..at + old.len(), new.iter().copied());
}

/// Inserts `v` behind `before`.
pub(super) fn insert_between(ring: &mut Vec<u32>, before: u32, v: u32) {
    if let Some(at) = ring.iter().position(|&w| w == before) {
        ring.insert(at + 1, v);
    }
}
