//! Element formulations: shape functions together with the treatment of the volumetric energy.

use std::fmt;
use std::ops::Deref;

use pneuflex_mesh::{ElementKind, Mesh, quadrature};
use serde::{Deserialize, Serialize};

use crate::law::Invariant;
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
    /// Quadratic tetrahedron with bubbles in its faces and inside and a discontinuous linear pressure; six per lattice cell.
    #[serde(rename = "tet15")]
    Tet15,
    /// Quadratic wedge with nodes in its faces and inside and a discontinuous linear pressure; two per lattice cell.
    #[serde(rename = "wedge21")]
    Wedge21,
}

/// When a part of the bulk modulus resists fluctuations of J within an element (theory §10).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ResistsFluctuations {
    /// A change of volume that no pressure mode sees comes with enough of a change of shape.
    Never,
    /// Some changes of volume that no pressure mode sees are unstable under the pressure that the full invariant has at rest.
    WithFullInvariant,
    /// Some motions have no energy otherwise, whatever the invariant.
    Always,
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
    /// When a part of the bulk modulus resists fluctuations of J within an element.
    pub resists_fluctuations: ResistsFluctuations,
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
    resists_fluctuations: ResistsFluctuations::Never,
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
    resists_fluctuations: ResistsFluctuations::WithFullInvariant,
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
    resists_fluctuations: ResistsFluctuations::Always,
    is_second_order: false,
};

static TET15: MixedFormulation = MixedFormulation {
    name: "tet15",
    words: "quadratic tetrahedra with nodes in their faces and inside and a discontinuous linear pressure",
    element: ElementKind::Tet15,
    deviatoric_rule: quadrature::tetrahedron_14,
    volumetric_rule: quadrature::tetrahedron_14,
    ..HEX20
};

static WEDGE21: MixedFormulation = MixedFormulation {
    name: "wedge21",
    words: "quadratic wedges with nodes in their faces and inside and a discontinuous linear pressure",
    element: ElementKind::Wedge21,
    deviatoric_rule: quadrature::wedge_21,
    volumetric_rule: quadrature::wedge_21,
    ..HEX20
};

impl Formulation {
    /// All formulations. Of those with one element, the last is that of bodies that come with such elements: free of locking.
    pub const ALL: [Self; 7] =
        [Self::Hex8Sri, Self::Hex8Q1p0, Self::Hex20, Self::Hex27, Self::Tet10, Self::Tet15, Self::Wedge21];

    /// What the formulation is.
    pub const fn table(self) -> &'static MixedFormulation {
        match self {
            Self::Hex8Sri => &HEX8_SRI,
            Self::Hex8Q1p0 => &HEX8_Q1P0,
            Self::Hex20 => &HEX20,
            Self::Hex27 => &HEX27,
            Self::Tet10 => &TET10,
            Self::Tet15 => &TET15,
            Self::Wedge21 => &WEDGE21,
        }
    }

    /// The formulation of bodies that come with elements of a family: free of locking. `None` for a family that has none.
    pub fn of_kind(kind: ElementKind) -> Option<Self> {
        Self::ALL.into_iter().rfind(|formulation| formulation.element == kind)
    }

    /// The formulation of a body that comes with a mesh, by its first element; where its family has none, that of the family which it is
    /// enriched to. `None` if there is none either.
    pub fn of_mesh(mesh: &Mesh) -> Option<Self> {
        let kind = mesh.kind_of(0);
        Self::of_kind(kind).or_else(|| Self::of_kind(kind.enriched()?))
    }

    /// The formulation of elements of a family in a body with this one: itself for its own, and that of [`Self::of_kind`] for all others.
    ///
    /// # Panics
    /// If there is none for the family: a body of such elements must be enriched first.
    pub fn beside(self, kind: ElementKind) -> Self {
        if self.element == kind {
            return self;
        }
        Self::of_kind(kind).expect("elements without a formulation are enriched before they are solved")
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

    /// Part κ_f of the bulk modulus, MPa, that resists fluctuations of J within an element; the rest resists its projection onto the
    /// pressure modes (theory §10). It is the sum of
    ///
    /// * μ on the tetrahedron, whose constant pressure leaves three quadratic motions without energy otherwise;
    /// * ⅓ μ − 8 C₂₀, if that is positive, on quadratic elements with the full invariant: what that has less energy at rest than the
    ///   isochoric one, for changes of volume that no pressure mode sees;
    ///
    /// and at most κ/2.
    pub fn fluctuation_modulus(&self, material: &Material) -> f64 {
        let shear_modulus = material.shear_modulus();
        let of_modes = match self.resists_fluctuations {
            ResistsFluctuations::Never => return 0.0,
            ResistsFluctuations::WithFullInvariant => 0.0,
            ResistsFluctuations::Always => shear_modulus,
        };
        let of_invariant = match (material.invariant, material.law.reduced_polynomial()) {
            (Invariant::Full, Some([_, c20, _])) => (shear_modulus / 3.0 - 8.0 * c20).max(0.0),
            _ => 0.0,
        };
        (of_modes + of_invariant).min(0.5 * material.bulk_modulus)
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
