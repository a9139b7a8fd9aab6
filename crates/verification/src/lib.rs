//! Verification: problems with known solutions, solved on sequences of meshes by every element formulation.
//!
//! Each problem yields [`Row`]s: a measured quantity against its exact value, relative errors on successively finer meshes, and
//! the order with which they fall. A row passes if its errors stay below its bound, which falls from mesh to mesh with the
//! least order accepted; with three meshes or more, the fitted order must not be below that least order either.
//! [`table::markdown`] makes `docs/verification.md` of them (`cargo xtask verification`).
//!
//! * [`homogeneous`]: uniaxial, equibiaxial, pure shear; bar of the compressible material.
//! * [`tube`]: thick tube in plane strain under inner pressure.
//! * [`torsion`]: solid cylinder.
//! * [`sphere`]: thick sphere under inner pressure.
//! * [`balloon`]: the same sphere beyond its greatest pressure, filled with a liquid or with gas.
//! * [`bending`]: Rivlin's flexure of a block.
//! * [`manufactured`]: a chosen displacement field and the body force it needs.
//! * [`contact_patch`]: two blocks with faces that do not match.
//! * [`hertz`]: a sphere on a block.
//! * [`crushed`]: a cylinder crushed between plates, and by a block.
//! * [`curved_contact`]: two arches pressed on each other, and a round die that irons a slab.
//!
//! [`moved_obstacle`]: what an obstacle that moves costs against supports that do (`cargo xtask obstacles`).
//!
//! [`relations`] are random problems, each written in two ways that must have one solution (`cargo xtask relations`); [`mutation`] damages their files
//! (`cargo xtask fuzz`). [`known_cases`] are inputs that were once answered wrongly (`cargo xtask cases`). [`advice`] is tried here, whatever the program
//! gives.
//!
//! Exact solutions are those of incompressible Yeoh material and are derived where they are used; [`yeoh`] has its own formulas
//! for the energy. Units: mm, N, MPa.

pub mod advice;
pub mod balloon;
pub mod bending;
pub mod body;
pub mod contact_patch;
pub mod crushed;
pub mod curved_contact;
pub mod hertz;
pub mod homogeneous;
pub mod intervals;
pub mod known_cases;
pub mod manufactured;
pub mod moved_obstacle;
pub mod mutation;
pub mod relations;
pub mod row;
pub mod sphere;
pub mod table;
pub mod torsion;
pub mod tube;
pub mod yeoh;

use pneuflex_model::Formulation;
use rayon::prelude::*;

pub use row::Row;

/// Elements of the problems: `tet10`, in whose place imported tetrahedra are solved with `tet15`, is not among them (docs/measurements.md has
/// what it missed).
pub(crate) const ELEMENTS: [Formulation; 6] = [
    Formulation::Hex8Sri,
    Formulation::Hex8Q1p0,
    Formulation::Hex20,
    Formulation::Hex27,
    Formulation::Tet15,
    Formulation::Wedge21,
];

/// How much is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// The two coarsest meshes of every sequence, of the elements that bodies are solved with by default.
    Quick,
    /// All meshes of all elements.
    Full,
}

impl Effort {
    /// The elements whose sequences are solved.
    pub(crate) fn elements(self) -> &'static [Formulation] {
        match self {
            Self::Quick => &[Formulation::Hex8Q1p0, Formulation::Hex27, Formulation::Tet15],
            Self::Full => &ELEMENTS,
        }
    }

    /// The meshes of a sequence, coarsest first, that are solved.
    pub fn of<T>(self, meshes: &[T]) -> &[T] {
        match self {
            Self::Quick => &meshes[..meshes.len().min(2)],
            Self::Full => meshes,
        }
    }
}

/// A group of rows with what they verify and where the exact solution comes from.
#[derive(Clone, Debug)]
pub struct Section {
    /// Heading.
    pub title: &'static str,
    /// Problem, source of the exact solution, remarks; Markdown.
    pub text: &'static str,
    /// Results.
    pub rows: Vec<Row>,
}

/// A problem, before it is solved.
type Problem = (&'static str, &'static str, fn(Effort) -> Vec<Row>);

const PROBLEMS: [Problem; 11] = [
    ("Homogeneous states", homogeneous::TEXT, homogeneous::rows),
    ("Thick tube", tube::TEXT, tube::rows),
    ("Torsion of a cylinder", torsion::TEXT, torsion::rows),
    ("Inflation of a thick sphere", sphere::TEXT, sphere::rows),
    ("Balloon", balloon::TEXT, balloon::rows),
    ("Bending of a block", bending::TEXT, bending::rows),
    ("Manufactured solutions", manufactured::TEXT, manufactured::rows),
    ("Contact patch test", contact_patch::TEXT, contact_patch::rows),
    ("Hertzian contact", hertz::TEXT, hertz::rows),
    ("Crushed cylinder", crushed::TEXT, crushed::rows),
    ("Arches and ironing", curved_contact::TEXT, curved_contact::rows),
];

/// Solves all problems, some at the same time, telling `observe` about the rows of each when it is solved.
pub fn run(effort: Effort, observe: &(dyn Fn(&Row) + Sync)) -> Vec<Section> {
    PROBLEMS
        .into_par_iter()
        .map(|(title, text, solve)| {
            let rows = solve(effort);
            rows.iter().for_each(observe);
            Section { title, text, rows }
        })
        .collect()
}
