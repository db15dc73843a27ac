//! Disjoint sets whose members carry a sign relative to each other.
//!
//! Source: R. E. Tarjan, "Efficiency of a good but not linear set union algorithm", 1975; signs as in bipartiteness tests.

/// Disjoint sets of the numbers from 0; the lowest member stands for its set.
pub struct Parity {
    parent: Vec<u32>,
    /// True if a member's sign is opposite to its parent's.
    opposite: Vec<bool>,
}

impl Parity {
    /// `n` sets of one member each.
    pub fn new(n: usize) -> Self {
        Parity { parent: (0..n as u32).collect(), opposite: vec![false; n] }
    }

    /// The lowest member of the set of `x`, and whether `x` has the opposite sign.
    pub fn find(&mut self, x: u32) -> (u32, bool) {
        let (mut root, mut sign) = (x, false);
        while self.parent[root as usize] != root {
            sign ^= self.opposite[root as usize];
            root = self.parent[root as usize];
        }
        let (mut at, mut rest) = (x, sign);
        while self.parent[at as usize] != root {
            let next = self.parent[at as usize];
            let step = std::mem::replace(&mut self.opposite[at as usize], rest);
            self.parent[at as usize] = root;
            rest ^= step;
            at = next;
        }
        (root, sign)
    }

    /// Joins two sets so that `x` and `y` have opposite or equal signs; false if they already have the other.
    pub fn join(&mut self, x: u32, y: u32, opposite: bool) -> bool {
        let ((a, sign_x), (b, sign_y)) = (self.find(x), self.find(y));
        let between = sign_x ^ sign_y ^ opposite;
        if a == b {
            return !between;
        }
        let (low, high) = (a.min(b), a.max(b));
        self.parent[high as usize] = low;
        self.opposite[high as usize] = between;
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_multiply_along_any_chain() {
        let mut sets = Parity::new(64);
        for i in (0..63).rev() {
            assert!(sets.join(i, i + 1, i % 3 == 0));
        }
        let sign = |i: u32| (0..i).filter(|k| k % 3 == 0).count() % 2 == 1;
        for i in 0..64 {
            assert_eq!(sets.find(i), (0, sign(i)), "member {i}");
        }
        assert!(sets.join(5, 60, sign(5) != sign(60)));
        assert!(!sets.join(5, 60, sign(5) == sign(60)));
    }
}
