//! Spans, rules and pressures of the elements: what the production path takes from tables is here once more, on its own.
//!
//! | formulation | deviatoric points | volumetric points | ψ |
//! |---|---|---|---|
//! | `hex8-sri` | 2×2×2 | the centre, w = Vₑ | 1 |
//! | `hex8-q1p0` | 2×2×2 | 2×2×2 | 1 |
//! | `hex20` | 14 (Irons) | 14 (Irons) | 1, ξ, η, ζ |
//! | `hex27` | 3×3×3 | 3×3×3 | 1, ξ, η, ζ |
//! | `tet10` | 4 | 3×3×3, collapsed | 1 |
//! | `tet15` | 14 | 14 | 1, ξ, η, ζ |
//! | `wedge21` | 7 × 3 | 7 × 3 | 1, ξ, η, ζ |

use std::collections::BTreeMap;

use pneuflex_mesh::{ElementKind, FaceKind};
use pneuflex_model::{Formulation, Invariant, Law, Material};

use crate::quadrature;

/// A point of an element's rule: reference coordinates, weight, deviatoric?, volumetric?
pub type RulePoint = ([f64; 3], f64, bool, bool);

/// Which monomials span a family.
#[derive(Clone, Copy)]
pub enum Span {
    /// Those with at most so many squares.
    Squares(usize),
    /// Those of total degree up to 2.
    TotalDegree2,
    /// Those of total degree up to 2, the product of the barycentric coordinates of every face, and that of all.
    Bubbles,
    /// Products of functions of x and y and of z.
    Prism(Prism),
}

/// How many products a wedge has.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Prism {
    /// z² times the linear functions of the triangle only.
    Serendipity,
    /// All of the quadratic ones.
    Full,
    /// All of the quadratic ones and of the triangle's bubble.
    Bubble,
}

impl Span {
    /// Whether the monomial with these exponents belongs to it.
    fn holds(self, exponents: &[usize]) -> bool {
        match self {
            Self::Squares(most) => exponents.iter().filter(|&&e| e == 2).count() <= most,
            Self::TotalDegree2 => exponents.iter().sum::<usize>() <= 2,
            Self::Bubbles => exponents.iter().sum::<usize>() <= 2 || exponents == [1, 1, 1],
            Self::Prism(prism) => {
                let in_plane = exponents[..2].iter().sum::<usize>();
                in_plane <= 2 && (prism != Prism::Serendipity || exponents[2] < 2 || in_plane < 2)
            }
        }
    }

    /// Sums of monomials, by their exponents up to 2, that span it. With z = 0 in the plane, products of barycentric coordinates are
    /// x y z, x y (1 − x − y − z) and so on, and x y z (1 − x − y − z): beside what is there already, x²y + x y² of every two coordinates
    /// and x²y z + x y²z + x y z².
    pub fn functions<const DIM: usize>(self) -> Vec<Vec<[usize; DIM]>> {
        let all = || (0..3_usize.pow(DIM as u32)).map(|code| std::array::from_fn(|d| code / 3_usize.pow(d as u32) % 3));
        let mut found: Vec<Vec<[usize; DIM]>> =
            all().filter(|exponents: &[usize; DIM]| self.holds(exponents)).map(|exponents| vec![exponents]).collect();
        if let Self::Bubbles = self {
            let mut sums: BTreeMap<[bool; DIM], Vec<[usize; DIM]>> = BTreeMap::new();
            for exponents in all() {
                let coordinates = exponents.iter().filter(|e| **e > 0).count();
                if coordinates > 1 && exponents.iter().sum::<usize>() == coordinates + 1 {
                    sums.entry(exponents.map(|e| e > 0)).or_default().push(exponents);
                }
            }
            found.extend(sums.into_values());
        }
        if let Self::Prism(Prism::Bubble) = self {
            // x y (1 − x − y) zᵏ: beside what is there, (x²y + x y²) zᵏ.
            let of = |x: usize, y: usize, z: usize| std::array::from_fn(|d| [x, y, z][d]);
            found.extend((0..3).map(|z| vec![of(2, 1, z), of(1, 2, z)]));
        }
        found
    }
}

/// What an element's shape functions span.
pub fn span_of_element(kind: ElementKind) -> Span {
    match kind {
        ElementKind::Hex8 => Span::Squares(0),
        ElementKind::Hex20 => Span::Squares(1),
        ElementKind::Hex27 => Span::Squares(3),
        ElementKind::Tet10 => Span::TotalDegree2,
        ElementKind::Tet15 => Span::Bubbles,
        ElementKind::Wedge15 => Span::Prism(Prism::Serendipity),
        ElementKind::Wedge18 => Span::Prism(Prism::Full),
        ElementKind::Wedge21 => Span::Prism(Prism::Bubble),
    }
}

/// What a face's shape functions span.
pub fn span_of_face(kind: FaceKind) -> Span {
    match kind {
        FaceKind::Quad4 => Span::Squares(0),
        FaceKind::Quad8 => Span::Squares(1),
        FaceKind::Quad9 => Span::Squares(2),
        FaceKind::Tri6 => Span::TotalDegree2,
        FaceKind::Tri7 => Span::Bubbles,
    }
}

/// A rule that integrates the volume behind a face exactly: 2×2 points on quad4, 3×3 on quad8 and quad9, 3×3 collapsed on tri6, 5×5 on tri7.
pub fn face_rule(kind: FaceKind) -> Vec<([f64; 2], f64)> {
    match kind {
        FaceKind::Quad4 => quadrature::tensor(2),
        FaceKind::Quad8 | FaceKind::Quad9 => quadrature::tensor(3),
        FaceKind::Tri6 => quadrature::collapsed(3),
        FaceKind::Tri7 => quadrature::collapsed(5),
    }
}

/// A rule for weights: at least 3×3×3 points, collapsed on tetrahedra, 16 × 3 on wedges.
pub fn volume_rule(kind: ElementKind) -> Vec<([f64; 3], f64)> {
    match kind {
        ElementKind::Hex8 | ElementKind::Hex20 | ElementKind::Hex27 => quadrature::tensor(3),
        ElementKind::Tet10 => quadrature::collapsed(3),
        ElementKind::Tet15 => quadrature::collapsed(5),
        ElementKind::Wedge15 | ElementKind::Wedge18 | ElementKind::Wedge21 => {
            quadrature::prism(&quadrature::triangle_of_degree_8())
        }
    }
}

/// The point of single-point contact.
pub fn centre_rule(kind: FaceKind) -> Vec<([f64; 2], f64)> {
    match kind {
        FaceKind::Tri6 | FaceKind::Tri7 => vec![([1.0 / 3.0; 2], 0.5)],
        FaceKind::Quad4 | FaceKind::Quad8 | FaceKind::Quad9 => quadrature::tensor(1),
    }
}

/// The points of multiple-point contact: 4×4, 16 of a symmetric rule on triangles.
pub fn contact_rule(kind: FaceKind) -> Vec<([f64; 2], f64)> {
    match kind {
        FaceKind::Tri6 | FaceKind::Tri7 => quadrature::triangle_of_degree_8(),
        FaceKind::Quad4 | FaceKind::Quad8 | FaceKind::Quad9 => quadrature::tensor(4),
    }
}

/// The rule of the table above.
pub fn rule(formulation: Formulation) -> Vec<RulePoint> {
    let points = |n: usize, is_deviatoric: bool, is_volumetric: bool| -> Vec<RulePoint> {
        quadrature::tensor(n).into_iter().map(|(xi, w)| (xi, w, is_deviatoric, is_volumetric)).collect()
    };
    match formulation {
        Formulation::Hex8Sri => [points(2, true, false), points(1, false, true)].concat(),
        Formulation::Hex8Q1p0 => points(2, true, true),
        Formulation::Hex20 => quadrature::irons().into_iter().map(|(xi, w)| (xi, w, true, true)).collect(),
        Formulation::Hex27 => points(3, true, true),
        Formulation::Tet10 => {
            let deviatoric = quadrature::tetrahedron_of_degree_2().into_iter().map(|(xi, w)| (xi, w, true, false));
            let volumetric = quadrature::collapsed(3).into_iter().map(|(xi, w)| (xi, w, false, true));
            deviatoric.chain(volumetric).collect()
        }
        Formulation::Tet15 => {
            quadrature::tetrahedron_of_degree_5().into_iter().map(|(xi, w)| (xi, w, true, true)).collect()
        }
        Formulation::Wedge21 => {
            let points = quadrature::prism(&quadrature::triangle_of_degree_5());
            points.into_iter().map(|(xi, w)| (xi, w, true, true)).collect()
        }
    }
}

/// Number of pressures of an element.
pub fn num_pressures(formulation: Formulation) -> usize {
    match formulation {
        Formulation::Hex8Sri | Formulation::Hex8Q1p0 | Formulation::Tet10 => 1,
        Formulation::Hex20 | Formulation::Hex27 | Formulation::Tet15 | Formulation::Wedge21 => 4,
    }
}

/// The part κ_f of the bulk modulus that acts on J itself, MPa: μ on tetrahedra; with the full invariant, quadratic elements have
/// 2/3 C₁₀ − 8 C₂₀ more, if that is more.
pub fn fluctuation_modulus(formulation: Formulation, material: &Material) -> f64 {
    let lack = match (material.invariant, &material.law) {
        (Invariant::Full, Law::NeoHooke { c10 }) => 2.0 * c10 / 3.0,
        (Invariant::Full, Law::Yeoh { c10, c20, .. }) if 12.0 * c20 < *c10 => 2.0 * c10 / 3.0 - 8.0 * c20,
        _ => 0.0,
    };
    let modulus = match formulation {
        Formulation::Hex8Sri | Formulation::Hex8Q1p0 => 0.0,
        Formulation::Hex20 | Formulation::Hex27 | Formulation::Tet15 | Formulation::Wedge21 => lack,
        Formulation::Tet10 => material.shear_modulus() + lack,
    };
    modulus.min(0.5 * material.bulk_modulus)
}
