//! Typed indices and the vectors they index, so that a face number is never taken for a vertex number.

use std::fmt;
use std::marker::PhantomData;
use std::ops::{Index, IndexMut};

/// An index of one kind of element.
pub trait Id: Copy + Eq + Ord + std::hash::Hash {
    /// The id of the element number `i`.
    fn new(i: usize) -> Self;
    /// The element's number.
    fn index(self) -> usize;
}

macro_rules! id {
    ($(#[$doc:meta])* $name:ident, $word:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
        #[serde(transparent)]
        pub struct $name(pub u32);

        impl Id for $name {
            fn new(i: usize) -> Self {
                $name(u32::try_from(i).expect("more than 2^32 elements are refused by the readers"))
            }
            fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, concat!($word, " {}"), self.0)
            }
        }
    };
}

id!(
    /// A vertex of a mesh, in the order of its file.
    VertexId,
    "vertex"
);
id!(
    /// A triangle of a mesh.
    FaceId,
    "face"
);
id!(
    /// Half an edge: half-edge `3 f + i` leaves corner `i` of face `f` for the next corner.
    HalfedgeId,
    "half-edge"
);
id!(
    /// A landmark: a vertex pair the user gives; also a vertex of the base complex.
    LandmarkId,
    "landmark"
);
id!(
    /// An edge of the base complex and the curve that embeds it on a mesh.
    ArcId,
    "arc"
);
id!(
    /// A triangle of the base complex and the disc that embeds it on a mesh.
    PatchId,
    "patch"
);

/// A vector indexed by one kind of id.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IdVec<I, T> {
    /// The elements in order.
    pub raw: Vec<T>,
    kind: PhantomData<fn(I)>,
}

impl<I: Id, T> IdVec<I, T> {
    /// Wraps a vector.
    pub fn from_raw(raw: Vec<T>) -> Self {
        IdVec { raw, kind: PhantomData }
    }

    /// `n` copies of `value`.
    pub fn filled(value: T, n: usize) -> Self
    where
        T: Clone,
    {
        Self::from_raw(vec![value; n])
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.raw.len()
    }

    /// True without elements.
    pub fn is_empty(&self) -> bool {
        self.raw.is_empty()
    }

    /// All ids in order.
    pub fn ids(&self) -> impl DoubleEndedIterator<Item = I> + use<I, T> {
        (0..self.raw.len()).map(I::new)
    }

    /// All elements in order.
    pub fn iter(&self) -> std::slice::Iter<'_, T> {
        self.raw.iter()
    }

    /// Ids and elements in order.
    pub fn iter_ids(&self) -> impl Iterator<Item = (I, &T)> {
        self.raw.iter().enumerate().map(|(i, x)| (I::new(i), x))
    }

    /// Appends an element and returns its id.
    pub fn push(&mut self, value: T) -> I {
        self.raw.push(value);
        I::new(self.raw.len() - 1)
    }
}

impl<I, T> Default for IdVec<I, T> {
    fn default() -> Self {
        IdVec { raw: Vec::new(), kind: PhantomData }
    }
}

impl<I: Id, T> FromIterator<T> for IdVec<I, T> {
    fn from_iter<J: IntoIterator<Item = T>>(items: J) -> Self {
        Self::from_raw(items.into_iter().collect())
    }
}

impl<I: Id, T> Index<I> for IdVec<I, T> {
    type Output = T;
    fn index(&self, i: I) -> &T {
        &self.raw[i.index()]
    }
}

impl<I: Id, T> IndexMut<I> for IdVec<I, T> {
    fn index_mut(&mut self, i: I) -> &mut T {
        &mut self.raw[i.index()]
    }
}
