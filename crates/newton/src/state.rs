//! States: a point in the space of the unknowns, and an equilibrium.

use pneuflex_assembly::Position;
use pneuflex_model::LoadParameter;

use crate::unstable_motion::UnstableMotions;

/// All unknowns at a position on the load path.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Position on the load path.
    pub parameter: LoadParameter,
    /// Displacements, mm, one entry per node.
    pub displacement: Vec<[f64; 3]>,
    /// Unknowns beside the displacements: pressures (MPa) of cavities whose volume or gas is given, then multipliers (N) of the linear
    /// equations.
    pub bordered: Vec<f64>,
}

impl State {
    /// The body at rest.
    pub fn at_rest(num_nodes: usize, num_bordered: usize) -> Self {
        Self::new(LoadParameter::default(), vec![[0.0; 3]; num_nodes], vec![0.0; num_bordered])
    }

    /// A state.
    pub fn new(parameter: impl Into<LoadParameter>, displacement: Vec<[f64; 3]>, bordered: Vec<f64>) -> Self {
        Self { parameter: parameter.into(), displacement, bordered }
    }

    /// The same unknowns at another position on the path.
    pub fn moved_to(&self, parameter: LoadParameter) -> Self {
        Self { parameter, ..self.clone() }
    }

    /// Where contributions are evaluated.
    pub fn position(&self) -> Position<'_> {
        Position {
            parameter: self.parameter,
            displacement: &self.displacement,
            bordered: &self.bordered,
            is_on_the_way: false,
        }
    }
}

/// A change of all unknowns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Correction {
    /// Change of the displacements, mm, one entry per node.
    pub displacement: Vec<[f64; 3]>,
    /// Change of the unknowns beside them.
    pub bordered: Vec<f64>,
}

impl Correction {
    /// A part of it.
    pub fn scaled(&self, factor: f64) -> Self {
        let displacement = self.displacement.iter().map(|x| x.map(|t| factor * t)).collect();
        Self { displacement, bordered: self.bordered.iter().map(|y| factor * y).collect() }
    }

    /// It with so many times another one.
    pub fn plus(mut self, factor: f64, other: &Self) -> Self {
        let pairs = self.displacement.as_flattened_mut().iter_mut().zip(other.displacement.as_flattened());
        pairs.for_each(|(u, more)| *u += factor * more);
        self.bordered.iter_mut().zip(&other.bordered).for_each(|(y, more)| *y += factor * more);
        self
    }

    /// Largest component of the displacements, mm.
    pub fn largest(&self) -> f64 {
        self.displacement.as_flattened().iter().fold(0.0_f64, |a, b| a.max(b.abs()))
    }
}

/// A state of equilibrium, the start of the next step.
#[derive(Clone, Debug)]
pub struct Equilibrium {
    /// The unknowns.
    pub state: State,
    /// Multipliers λ of the held degrees of freedom, N, three per node; zero at free ones.
    pub multipliers: Vec<f64>,
    /// Contact points that carry traction.
    pub contact_points: usize,
    /// Solved well enough to go on from (inexact Newton), not to the tolerances asked for.
    pub is_inexact: bool,
    /// Motions of the mesh that release energy there, in spite of which the path goes on.
    pub mesh_motions: Option<UnstableMotions>,
    /// Negative eigenvalues of the tangent near it.
    pub negative_pivots: usize,
}

/// b − a of nodal fields.
pub(crate) fn difference(b: &[[f64; 3]], a: &[[f64; 3]]) -> Vec<[f64; 3]> {
    b.iter().zip(a).map(|(b, a)| std::array::from_fn(|k| b[k] - a[k])).collect()
}

/// a · b of nodal fields.
pub(crate) fn dot(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| a * b).sum()
}
