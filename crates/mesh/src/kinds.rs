//! Which family every element of a mesh is of.

use std::ops::{Index, Range};

use crate::element::ElementKind;

/// Families of a mesh's elements. Those of a mesh of one family are [`Kinds::One`], whatever they were made from.
#[derive(Clone, Debug, PartialEq)]
pub enum Kinds {
    /// All elements are of one family.
    One(ElementKind),
    /// The family of every element.
    Each {
        /// Families.
        kinds: Vec<ElementKind>,
        /// Where every element's nodes begin in the connectivity, and where the last one's end.
        starts: Vec<usize>,
    },
}

impl From<ElementKind> for Kinds {
    fn from(kind: ElementKind) -> Self {
        Self::One(kind)
    }
}

impl FromIterator<ElementKind> for Kinds {
    /// Families of elements in their order, of which there is at least one: those of one family are always written as [`Kinds::One`].
    ///
    /// # Panics
    /// If there is no element.
    fn from_iter<I: IntoIterator<Item = ElementKind>>(kinds: I) -> Self {
        let kinds: Vec<ElementKind> = kinds.into_iter().collect();
        if kinds.iter().all(|kind| *kind == kinds[0]) {
            return Self::One(kinds[0]);
        }
        let mut starts = vec![0];
        let mut end = 0;
        starts.extend(kinds.iter().map(|kind| {
            end += kind.num_nodes();
            end
        }));
        Self::Each { kinds, starts }
    }
}

impl Kinds {
    /// Family of an element.
    ///
    /// # Panics
    /// If there is no such element; not where all are of one family.
    pub fn of(&self, element: usize) -> ElementKind {
        match self {
            Self::One(kind) => *kind,
            Self::Each { kinds, .. } => kinds[element],
        }
    }

    /// Where an element's nodes are in the connectivity.
    ///
    /// # Panics
    /// As [`Self::of`].
    pub fn range(&self, element: usize) -> Range<usize> {
        match self {
            Self::One(kind) => element * kind.num_nodes()..(element + 1) * kind.num_nodes(),
            Self::Each { starts, .. } => starts[element]..starts[element + 1],
        }
    }

    /// The families that there are, each once, in the order of [`ElementKind::ALL`].
    pub fn families(&self) -> Vec<ElementKind> {
        match self {
            Self::One(kind) => vec![*kind],
            Self::Each { kinds, .. } => ElementKind::ALL.into_iter().filter(|kind| kinds.contains(kind)).collect(),
        }
    }

    /// The family of all elements; `None` if there are several.
    pub fn only(&self) -> Option<ElementKind> {
        match self {
            Self::One(kind) => Some(*kind),
            Self::Each { .. } => None,
        }
    }
}

/// One value for each of some families of elements.
#[derive(Clone, Debug, PartialEq)]
pub struct PerKind<T>([Option<T>; ElementKind::ALL.len()]);

impl<T> PerKind<T> {
    /// The value of each of `families`.
    pub fn new(families: &[ElementKind], mut value: impl FnMut(ElementKind) -> T) -> Self {
        Self(ElementKind::ALL.map(|kind| families.contains(&kind).then(|| value(kind))))
    }

    /// All values, in the order of [`ElementKind::ALL`].
    pub fn values(&self) -> impl Iterator<Item = &T> {
        self.0.iter().flatten()
    }
}

impl<T> Index<ElementKind> for PerKind<T> {
    type Output = T;

    fn index(&self, kind: ElementKind) -> &T {
        self.0[kind as usize].as_ref().expect("there is a value for every family of the mesh")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_of_several_families_have_their_own_nodes() {
        use ElementKind::{Hex8, Tet10};
        let kinds: Kinds = [Hex8, Tet10, Hex8].into_iter().collect();
        assert_eq!([0, 1, 2].map(|e| kinds.range(e)), [0..8, 8..18, 18..26]);
        assert_eq!((kinds.of(1), kinds.only(), kinds.families()), (Tet10, None, vec![Hex8, Tet10]));
        assert_eq!([Tet10; 2].into_iter().collect::<Kinds>(), Kinds::One(Tet10));
        // Every family finds its own value.
        let numbers = PerKind::new(&ElementKind::ALL, |kind| kind.num_nodes());
        assert!(ElementKind::ALL.into_iter().all(|kind| numbers[kind] == kind.num_nodes()));
    }
}
