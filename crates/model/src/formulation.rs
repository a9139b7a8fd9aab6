//! Element formulations: shape functions together with the treatment of the volumetric energy.

use std::fmt;

use pneuflex_mesh::ElementKind;
use serde::{Deserialize, Serialize};

use crate::material::Material;

/// Element formulation: shape functions together with the treatment of the volumetric energy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Formulation {
    /// The paper's: trilinear hexahedron, volumetric energy at the centre (selective reduced integration).
    #[serde(rename = "hex8-sri")]
    Hex8Sri,
    /// Trilinear hexahedron with mean dilatation J̄ = deformed / reference volume.
    #[serde(rename = "hex8-q1p0")]
    Hex8Q1p0,
    /// Serendipity quadratic hexahedron with a discontinuous linear pressure.
    #[serde(rename = "hex20")]
    Hex20,
    /// Triquadratic hexahedron with a discontinuous linear pressure.
    #[serde(rename = "hex27")]
    Hex27,
    /// Quadratic tetrahedron with a constant pressure (P2–P0); six per lattice cell.
    #[serde(rename = "tet10")]
    Tet10,
}

impl Formulation {
    /// Element family of the formulation.
    pub const fn element_kind(self) -> ElementKind {
        match self {
            Self::Hex8Sri | Self::Hex8Q1p0 => ElementKind::Hex8,
            Self::Hex20 => ElementKind::Hex20,
            Self::Hex27 => ElementKind::Hex27,
            Self::Tet10 => ElementKind::Tet10,
        }
    }

    /// The formulation of bodies that come with elements of a family: free of locking.
    pub const fn of_kind(kind: ElementKind) -> Self {
        match kind {
            ElementKind::Hex8 => Self::Hex8Q1p0,
            ElementKind::Hex20 => Self::Hex20,
            ElementKind::Hex27 => Self::Hex27,
            ElementKind::Tet10 => Self::Tet10,
        }
    }

    /// Part of the bulk modulus, MPa, that resists fluctuations of J within an element; the rest resists its mean. Zero but
    /// for the tetrahedron, whose constant pressure leaves three quadratic motions without energy otherwise
    /// (`pneuflex-assembly`, formulations).
    pub fn fluctuation_modulus(self, material: &Material) -> f64 {
        match self {
            Self::Tet10 => material.shear_modulus().min(0.5 * material.bulk_modulus),
            _ => 0.0,
        }
    }

    /// Name in case files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hex8Sri => "hex8-sri",
            Self::Hex8Q1p0 => "hex8-q1p0",
            Self::Hex20 => "hex20",
            Self::Hex27 => "hex27",
            Self::Tet10 => "tet10",
        }
    }
}

impl fmt::Display for Formulation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
