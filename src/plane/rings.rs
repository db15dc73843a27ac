//! The neighbours of every vertex of a disc in cyclic order, as merging vertices and bringing them back changes them.

/// Merges `v` with the neighbour at place `start` of its ring; returns the ring, which then starts with that neighbour.
pub(super) fn merge(rings: &mut [Vec<u32>], v: u32, start: usize) -> Vec<u32> {
    let mut ring = std::mem::take(&mut rings[v as usize]);
    ring.rotate_left(start);
    let (u, last) = (ring[0], ring.len() - 1);
    replace(&mut rings[u as usize], &[v], &ring[2..last]);
    for &x in &ring[2..last] {
        replace(&mut rings[x as usize], &[v], &[u]);
    }
    replace(&mut rings[ring[1] as usize], &[v], &[]);
    replace(&mut rings[ring[last] as usize], &[v], &[]);
    ring
}

/// Undoes the merge of `v`, given its ring.
pub(super) fn bring_back(rings: &mut [Vec<u32>], v: u32, ring: Vec<u32>) {
    let (u, last) = (ring[0], ring.len() - 1);
    if last == 2 {
        insert_between(&mut rings[u as usize], ring[1], v);
    } else {
        replace(&mut rings[u as usize], &ring[2..last], &[v]);
    }
    for &x in &ring[2..last] {
        replace(&mut rings[x as usize], &[u], &[v]);
    }
    insert_between(&mut rings[ring[1] as usize], ring[2], v);
    insert_between(&mut rings[ring[last] as usize], u, v);
    rings[v as usize] = ring;
}

/// Replaces the run `old` of a cyclic list by `new`.
fn replace(ring: &mut Vec<u32>, old: &[u32], new: &[u32]) {
    let Some(mut at) = ring.iter().position(|w| *w == old[0]) else { return };
    if at + old.len() > ring.len() {
        ring.rotate_left(at);
        at = 0;
    }
    ring.splice(at..at + old.len(), new.iter().copied());
}

/// Inserts `v` behind `before`.
fn insert_between(ring: &mut Vec<u32>, before: u32, v: u32) {
    if let Some(at) = ring.iter().position(|&w| w == before) {
        ring.insert(at + 1, v);
    }
}
