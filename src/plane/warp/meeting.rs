//! When and where a walker on a straight way meets the line of an edge, in exact arithmetic.

use glam::DVec2;
use num_rational::BigRational;
use std::cmp::Ordering;

/// A point with exact coordinates.
type Exact = [BigRational; 2];

fn exact(p: DVec2) -> Option<Exact> {
    Some([BigRational::from_float(p.x)?, BigRational::from_float(p.y)?])
}

fn cross(o: &Exact, a: &Exact, b: &Exact) -> BigRational {
    (&a[0] - &o[0]) * (&b[1] - &o[1]) - (&a[1] - &o[1]) * (&b[0] - &o[0])
}

/// A straight way.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    /// Where it starts.
    pub from: DVec2,
    /// Where it ends.
    pub to: DVec2,
}

/// Where the invalid point lies along the edge whose line it is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Beyond the first end.
    BeforeFirst,
    /// At the first end.
    First,
    /// Between the ends.
    Between,
    /// At the second end.
    Second,
    /// Beyond the second end.
    AfterSecond,
}

impl Way {
    /// The share of the way at which it meets the line through `p` and `q`, to the left of which it starts.
    ///
    /// None if the coordinates are not finite or the way runs along the line.
    pub fn meets(&self, p: DVec2, q: DVec2) -> Option<BigRational> {
        let [from, to, p, q] = [exact(self.from)?, exact(self.to)?, exact(p)?, exact(q)?];
        let (before, after) = (cross(&from, &p, &q), cross(&to, &p, &q));
        let fall = &before - &after;
        (fall != BigRational::from_integer(0.into())).then(|| before / fall)
    }

    /// Where the point at a share of the way, which must be on the line through `p` and `q`, lies between them.
    pub fn place(&self, share: &BigRational, p: DVec2, q: DVec2) -> Option<Place> {
        let axis = usize::from((q.y - p.y).abs() > (q.x - p.x).abs());
        let [from, to, p, q] = [exact(self.from)?, exact(self.to)?, exact(p)?, exact(q)?].map(|e| e[axis].clone());
        let at = &from + share * (to - &from);
        let (low, high, turned) = if p <= q { (&p, &q, false) } else { (&q, &p, true) };
        let place = match (at.cmp(low), at.cmp(high)) {
            (Ordering::Less, _) => Place::BeforeFirst,
            (Ordering::Equal, _) => Place::First,
            (_, Ordering::Less) => Place::Between,
            (_, Ordering::Equal) => Place::Second,
            _ => Place::AfterSecond,
        };
        Some(if turned { place.turned() } else { place })
    }
}

impl Place {
    fn turned(self) -> Self {
        match self {
            Place::BeforeFirst => Place::AfterSecond,
            Place::First => Place::Second,
            Place::Between => Place::Between,
            Place::Second => Place::First,
            Place::AfterSecond => Place::BeforeFirst,
        }
    }
}
