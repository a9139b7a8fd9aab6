//! The kinds of solid elements: small keys to the tables of [`crate::family`].

use std::ops::Deref;

use serde::{Deserialize, Serialize};

use crate::family::{ElementFamily, hex8, hex20, hex27, tet10, tet15, wedge15, wedge18, wedge21};

/// Family of solid elements; dereferences to its table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ElementKind {
    /// Trilinear hexahedron.
    Hex8,
    /// Serendipity quadratic hexahedron.
    Hex20,
    /// Full triquadratic hexahedron.
    Hex27,
    /// Quadratic tetrahedron.
    Tet10,
    /// Quadratic tetrahedron with nodes in its faces and inside.
    Tet15,
    /// Serendipity quadratic wedge.
    Wedge15,
    /// Quadratic wedge with nodes in its quadrilateral faces.
    Wedge18,
    /// Quadratic wedge with nodes in its faces and inside.
    Wedge21,
}

impl ElementKind {
    /// All families.
    pub const ALL: [Self; 8] =
        [Self::Hex8, Self::Hex20, Self::Hex27, Self::Tet10, Self::Tet15, Self::Wedge15, Self::Wedge18, Self::Wedge21];

    /// What the family is.
    pub const fn family(self) -> &'static ElementFamily {
        match self {
            Self::Hex8 => &hex8::FAMILY,
            Self::Hex20 => &hex20::FAMILY,
            Self::Hex27 => &hex27::FAMILY,
            Self::Tet10 => &tet10::FAMILY,
            Self::Tet15 => &tet15::FAMILY,
            Self::Wedge15 => &wedge15::FAMILY,
            Self::Wedge18 => &wedge18::FAMILY,
            Self::Wedge21 => &wedge21::FAMILY,
        }
    }

    /// The family with further nodes in the faces and inside, with which pressures are stable; `None` if there is none.
    pub fn enriched(self) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.enriches.contains(&self))
    }
}

impl Deref for ElementKind {
    type Target = ElementFamily;

    fn deref(&self) -> &ElementFamily {
        self.family()
    }
}

/// Evaluates an expression with the number of nodes of an element's kind as a constant, for kernels that are compiled once per number:
/// `with_num_nodes!(kind, N => kernel::<N>(element))`.
#[macro_export]
macro_rules! with_num_nodes {
    (@each $kind:expr, $n:ident => $body:expr; $($variant:ident)*) => {
        match $kind {
            $($crate::ElementKind::$variant => {
                const $n: usize = $crate::ElementKind::$variant.family().num_nodes();
                $body
            })*
        }
    };
    ($kind:expr, $n:ident => $body:expr) => {
        $crate::with_num_nodes!(@each $kind, $n => $body; Hex8 Hex20 Hex27 Tet10 Tet15 Wedge15 Wedge18 Wedge21)
    };
}
