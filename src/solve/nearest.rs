//! An entry of a queue from which the nearest comes first.

use std::cmp::Ordering;

/// A distance and what lies there, for a [`std::collections::BinaryHeap`]: the least distance comes first, ties go to the
/// lower element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest<T>(pub f64, pub T);

impl<T: PartialEq> Eq for Nearest<T> {}

impl<T: Ord> Ord for Nearest<T> {
    fn cmp(&self, other: &Self) -> Ordering {
        other.0.total_cmp(&self.0).then_with(|| other.1.cmp(&self.1))
    }
}

impl<T: Ord> PartialOrd for Nearest<T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BinaryHeap;

    #[test]
    fn the_nearest_comes_first_and_the_lower_of_two() {
        let mut queue = BinaryHeap::from([Nearest(2.0, 1), Nearest(0.5, 7), Nearest(0.5, 3), Nearest(-1.0, 9)]);
        let order: Vec<i32> = std::iter::from_fn(|| queue.pop()).map(|Nearest(_, x)| x).collect();
        assert_eq!(order, [9, 3, 7, 1]);
    }
}
