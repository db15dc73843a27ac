//! A queue of elements by distance, in buckets of equal width, for fronts that may correct what they said.
//!
//! Elements of one bucket come in the order in which they were put in; a distance below the bucket at hand counts as in it.
//! So an element can come too early, and then again with a smaller distance; what a front leaves behind is the same.
//! Source of the idea: Dial, "Shortest-path forest with topological ordering", 1969.

/// Marks an element that does not wait.
const NOWHERE: u64 = u64::MAX;

/// The queue; it is empty after a front and can be used for the next one.
#[derive(Debug)]
pub struct BucketQueue {
    buckets: Vec<Vec<u32>>,
    /// For every element the bucket in which it waits.
    place: Vec<u64>,
    per_unit: f64,
    /// The bucket at hand, and how much of it is done.
    bucket: u64,
    done: usize,
    waiting: usize,
}

impl BucketQueue {
    /// A queue for so many elements; `width` is that of a bucket, `reach` the most that a distance can be larger than the
    /// one of the element that came last.
    pub fn new(elements: usize, width: f64, reach: f64) -> Self {
        /// More buckets are not worth their memory; with a few very long edges buckets get wider instead.
        const MOST: f64 = 65_536.0;
        let count = (reach / width).clamp(1.0, MOST);
        let per_unit = if reach > 0.0 { count / reach } else { 1.0 };
        BucketQueue {
            buckets: vec![Vec::new(); count.ceil() as usize + 2],
            place: vec![NOWHERE; elements],
            per_unit,
            bucket: 0,
            done: 0,
            waiting: 0,
        }
    }

    /// Puts an element in, or moves it forward.
    #[inline]
    pub fn push(&mut self, element: u32, distance: f64) {
        let bucket = ((distance * self.per_unit) as u64).max(self.bucket);
        let place = &mut self.place[element as usize];
        if *place != bucket {
            *place = bucket;
            let at = (bucket % self.buckets.len() as u64) as usize;
            self.buckets[at].push(element);
            self.waiting += 1;
        }
    }

    /// The next element.
    #[inline]
    pub fn pop(&mut self) -> Option<u32> {
        while self.waiting > 0 {
            let at = (self.bucket % self.buckets.len() as u64) as usize;
            let Some(&element) = self.buckets[at].get(self.done) else {
                self.buckets[at].clear();
                self.bucket += 1;
                self.done = 0;
                continue;
            };
            self.done += 1;
            self.waiting -= 1;
            let place = &mut self.place[element as usize];
            if *place == self.bucket {
                *place = NOWHERE;
                return Some(element);
            }
        }
        self.reset();
        None
    }

    fn reset(&mut self) {
        let at = (self.bucket % self.buckets.len() as u64) as usize;
        self.buckets[at].clear();
        (self.bucket, self.done) = (0, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_come_by_bucket_and_once() {
        let mut queue = BucketQueue::new(4, 0.5, 3.0);
        for _ in 0..2 {
            for (element, distance) in [(0, 2.9), (1, 0.1), (2, 1.2), (0, 0.2), (3, 0.3)] {
                queue.push(element, distance);
            }
            let order: Vec<u32> = std::iter::from_fn(|| queue.pop()).collect();
            assert_eq!(order, [1, 0, 3, 2]);
        }
    }
}
