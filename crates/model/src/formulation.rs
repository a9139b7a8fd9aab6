//! Element formulations: shape functions together with the treatment of the volumetric energy.

use std::fmt;
use std::ops::Deref;

use pneuflex_mesh::{ElementKind, quadrature};
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

/// What a formulation is.
#[derive(Debug)]
pub struct MixedFormulation {
    /// Name in case files.
    pub name: &'static str,
    /// In words.
    pub words: &'static str,
    /// Element family.
    pub element: ElementKind,
    /// Rule of the deviatoric energy.
    pub deviatoric_rule: fn() -> Vec<([f64; 3], f64)>,
    /// Rule of the volumetric energy.
    pub volumetric_rule: fn() -> Vec<([f64; 3], f64)>,
    /// Whether the single volumetric point stands for the element's whole volume, as the deviatoric rule integrates it.
    pub is_centre_only: bool,
    /// How many of the pressure modes 1, ξ, η, ζ an element has.
    pub num_modes: usize,
    /// Whether a part of the bulk modulus resists fluctuations of J within an element.
    pub resists_fluctuations: bool,
    /// Whether strains are of second order, so that half as many cells do.
    pub is_second_order: bool,
}

static HEX8_SRI: MixedFormulation = MixedFormulation {
    name: "hex8-sri",
    words: "trilinear hexahedra whose volumetric energy is integrated at the centre",
    element: ElementKind::Hex8,
    deviatoric_rule: || quadrature::hexahedron(2),
    volumetric_rule: || quadrature::hexahedron(1),
    is_centre_only: true,
    num_modes: 1,
    resists_fluctuations: false,
    is_second_order: false,
};

static HEX8_Q1P0: MixedFormulation = MixedFormulation {
    name: "hex8-q1p0",
    words: "trilinear hexahedra with a mean pressure, which do not lock in volume",
    volumetric_rule: || quadrature::hexahedron(2),
    is_centre_only: false,
    ..HEX8_SRI
};

static HEX20: MixedFormulation = MixedFormulation {
    name: "hex20",
    words: "fully integrated with a discontinuous linear pressure",
    element: ElementKind::Hex20,
    deviatoric_rule: quadrature::hexahedron_14,
    volumetric_rule: quadrature::hexahedron_14,
    is_centre_only: false,
    num_modes: 4,
    resists_fluctuations: false,
    is_second_order: true,
};

static HEX27: MixedFormulation = MixedFormulation {
    name: "hex27",
    words: "triquadratic hexahedra with a discontinuous linear pressure",
    element: ElementKind::Hex27,
    deviatoric_rule: || quadrature::hexahedron(3),
    volumetric_rule: || quadrature::hexahedron(3),
    ..HEX20
};

static TET10: MixedFormulation = MixedFormulation {
    name: "tet10",
    words: "quadratic tetrahedra with a constant pressure",
    element: ElementKind::Tet10,
    deviatoric_rule: quadrature::tetrahedron_4,
    volumetric_rule: quadrature::tetrahedron_8,
    is_centre_only: false,
    num_modes: 1,
    resists_fluctuations: true,
    is_second_order: false,
};

impl Formulation {
    /// All formulations. Of those with one element, the last is that of bodies that come with such elements: free of locking.
    pub const ALL: [Self; 5] = [Self::Hex8Sri, Self::Hex8Q1p0, Self::Hex20, Self::Hex27, Self::Tet10];

    /// What the formulation is.
    pub const fn table(self) -> &'static MixedFormulation {
        match self {
            Self::Hex8Sri => &HEX8_SRI,
            Self::Hex8Q1p0 => &HEX8_Q1P0,
            Self::Hex20 => &HEX20,
            Self::Hex27 => &HEX27,
            Self::Tet10 => &TET10,
        }
    }

    /// The formulation of bodies that come with elements of a family: free of locking. `None` for a family that has none.
    pub fn of_kind(kind: ElementKind) -> Option<Self> {
        Self::ALL.into_iter().rfind(|formulation| formulation.element == kind)
    }
}

impl Deref for Formulation {
    type Target = MixedFormulation;

    fn deref(&self) -> &MixedFormulation {
        self.table()
    }
}

impl MixedFormulation {
    /// Element family of the formulation.
    pub const fn element_kind(&self) -> ElementKind {
        self.element
    }

    /// Part of the bulk modulus, MPa, that resists fluctuations of J within an element; the rest resists its mean. Zero but
    /// for the tetrahedron, whose constant pressure leaves three quadratic motions without energy otherwise
    /// (`pneuflex-assembly`, formulations).
    pub fn fluctuation_modulus(&self, material: &Material) -> f64 {
        if self.resists_fluctuations { material.shear_modulus().min(0.5 * material.bulk_modulus) } else { 0.0 }
    }

    /// Name in case files.
    pub const fn name(&self) -> &'static str {
        self.name
    }
}

impl fmt::Display for Formulation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}
