//! A part of a batch, the same wherever it runs: it depends on the jobs' ids alone.

use crate::error::{Error, Result};
use std::fmt;
use std::str::FromStr;

/// Part `part` of `of`, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    part: u32,
    of: u32,
}

impl Shard {
    /// Part `part` of `of`; none unless `1 <= part <= of`.
    pub fn new(part: u32, of: u32) -> Option<Self> {
        (1..=of).contains(&part).then_some(Shard { part, of })
    }

    /// True for the jobs that this part has to do; each job belongs to one of the parts.
    pub fn holds(&self, id: &str) -> bool {
        let hash = blake3::hash(id.as_bytes());
        let [a, b, c, d, ..] = *hash.as_bytes();
        u32::from_le_bytes([a, b, c, d]) % self.of == self.part - 1
    }
}

impl FromStr for Shard {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let numbers = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        let shard = numbers.and_then(|(part, of)| Shard::new(part, of));
        shard
            .ok_or_else(|| Error::usage(format!("\"{text}\" is no shard")).remedy("write I/N with 1 <= I <= N, as 2/8"))
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.part, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_job_belongs_to_one_shard_and_shards_are_about_equal() {
        let shards: Vec<Shard> = (1..=7).filter_map(|i| Shard::new(i, 7)).collect();
        let mut counts = [0; 7];
        for id in (0..7000).map(|i| format!("job_{i}")) {
            let holders: Vec<usize> = (0..7).filter(|&i| shards[i].holds(&id)).collect();
            assert_eq!(holders.len(), 1, "{id}");
            counts[holders[0]] += 1;
        }
        assert!(counts.iter().all(|n| (850..1150).contains(n)), "{counts:?}");
    }

    #[test]
    fn a_job_stays_where_it_is() {
        // Schedulers on other machines and later versions must agree: these are not to change.
        let of_four = |id: &str| (1..=4).find(|&i| Shard::new(i, 4).is_some_and(|s| s.holds(id)));
        assert_eq!(["a", "cat_horse", "0001"].map(of_four), [Some(4), Some(2), Some(1)]);
    }

    #[test]
    fn what_is_no_shard_is_refused() {
        assert_eq!("2/8".parse(), Ok(Shard { part: 2, of: 8 }));
        for text in ["0/4", "5/4", "1/0", "1", "a/b", "1/2/3", "-1/4", ""] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
    }
}
