//! The derivatives of Lagrangians by the numbers of a file.

use std::sync::Arc;

use pneuflex_model::{LoadParameter, Pressure, Problem};
use pneuflex_newton::adjoint::{Frozen, Linearised, Multipliers};

use super::results::Scalar;
use super::variables::{Kind, Variable};
use super::variants::Variants;

/// What the derivatives at a state are made from.
pub struct Slopes<'a> {
    pub linearised: &'a Linearised,
    pub variants: &'a Variants<'a>,
    pub scalars: &'a [Scalar],
    pub multipliers: &'a [Multipliers],
    /// Slopes of the Lagrangians by the positions of the nodes at rest, if they are known.
    pub by_nodes: Option<&'a [Vec<[f64; 3]>]>,
    pub at: LoadParameter,
}

impl Slopes<'_> {
    /// The derivatives by a length that moves nodes and changes nothing else; `None` for others, and where the slopes by the nodes are not known.
    fn by_nodes(&self, variable: &Variable) -> Result<Option<Vec<f64>>, String> {
        let Self { linearised, variants, scalars, .. } = self;
        let Some(by_nodes) = self.by_nodes.filter(|_| variants.is_of_shape(variable)) else { return Ok(None) };
        let (step, base) = (variants.step(variable), variants.problem());
        let (high, _) = variants.with(variable, variable.value + step, self.at)?;
        if (Problem { mesh: Arc::clone(&base.mesh), ..high.clone() }) != *base {
            return Ok(None);
        }
        let with = |steps: f64| -> Result<Problem, String> {
            Ok(Problem { mesh: variants.mesh_with(variable, variable.value + steps * step)?, ..base.clone() })
        };
        let [far_low, low, far_high] = [with(-2.0)?, with(-1.0)?, with(2.0)?];
        // Nodes move evenly with a length.
        let ends = low.mesh.nodes.as_flattened().iter().zip(high.mesh.nodes.as_flattened());
        let motion: Vec<f64> = ends.map(|(low, high)| (high - low) / (2.0 * step)).collect();
        let frozen = Frozen {
            displacement: linearised.displacement().to_vec(),
            cavity_pressures: vec![Pressure::default(); base.cavities.len()],
            lagrangians: Vec::new(),
        };
        let slope = |(scalar, by_nodes): (&Scalar, &Vec<[f64; 3]>)| {
            let at = |problem: &Problem| scalar.explicit(problem, &frozen).map_err(|error| error.to_string());
            let explicit = extrapolated([at(&low)?, at(&high)?], [at(&far_low)?, at(&far_high)?], step);
            let along = by_nodes.as_flattened().iter().zip(&motion).map(|(slope, motion)| slope * motion);
            Ok(explicit + along.sum::<f64>())
        };
        scalars.iter().zip(by_nodes).map(slope).collect::<Result<Vec<f64>, String>>().map(Some)
    }

    /// The derivatives of all results by a number: central differences of the Lagrangians, extrapolated where these are not linear in it.
    pub fn by(&self, variable: &Variable) -> Result<Vec<f64>, String> {
        if let Some(slopes) = self.by_nodes(variable)? {
            return Ok(slopes);
        }
        let step = self.variants.step(variable);
        let at = |steps: f64| self.lagrangians(variable, variable.value + steps * step);
        let [low, high] = [at(-1.0)?, at(1.0)?];
        if variable.kind == Kind::Linear {
            return Ok(low.iter().zip(&high).map(|(low, high)| (high - low) / (2.0 * step)).collect());
        }
        let [far_low, far_high] = [at(-2.0)?, at(2.0)?];
        let slope = |i: usize| extrapolated([low[i], high[i]], [far_low[i], far_high[i]], step);
        Ok((0..self.scalars.len()).map(slope).collect())
    }

    fn lagrangians(&self, variable: &Variable, value: f64) -> Result<Vec<f64>, String> {
        let (problem, at) = self.variants.with(variable, value, self.at)?;
        let frozen = self.linearised.frozen(&problem, at, self.multipliers).map_err(|cause| cause.to_string())?;
        let frozen: Frozen = frozen.ok_or("a point that touches slides off its face")?;
        let of_scalar = |(scalar, lagrangian): (&Scalar, &f64)| {
            scalar.explicit(&problem, &frozen).map(|explicit| explicit + lagrangian).map_err(|error| error.to_string())
        };
        self.scalars.iter().zip(&frozen.lagrangians).map(of_scalar).collect()
    }
}

/// The derivative from values at ± one step and at ± two (Richardson): what is left is of the fourth order in the step.
pub fn extrapolated([low, high]: [f64; 2], [far_low, far_high]: [f64; 2], step: f64) -> f64 {
    (8.0 * (high - low) - (far_high - far_low)) / (12.0 * step)
}
