//! Derivatives of results by the positions of all nodes at rest.

use std::sync::Arc;
use std::time::Instant;

use pneuflex_model::load::{Control, Load};
use pneuflex_model::{LoadParameter, Problem};
use pneuflex_newton::ConvergedState;
use pneuflex_newton::adjoint::Frozen;
use pneuflex_post::fields;
use pneuflex_post::measures::centreline_nodes;
use pneuflex_post::vtu::Field;

use super::request::Request;
use super::results::Scalar;
use super::slopes::extrapolated;
use super::solved::{Solved, no_gradient};
use crate::analysis::Analysis;
use crate::error::{Error, ResultsError};
use crate::folder::{OutputFolder, SHAPE_GRADIENTS};
use crate::input_error::InputError;

/// Nodes are moved by this share of their mean distance where what a result itself depends on is differentiated.
const SHARE: f64 = 1e-3;

/// The derivative of a result of a state by the positions of all nodes at rest; displacements of the tip and of probes are those of their nodes. Where a part of the body is modelled, the nodes of the other parts
/// move as their mirror images do.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeGradient {
    /// The result's column.
    pub of: String,
    /// Time or pressure in kPa of the state.
    pub at: LoadParameter,
    /// The result there.
    pub value: f64,
    /// Change of the result by mm along x, y and z, one entry per node.
    pub by_node: Vec<[f64; 3]>,
    /// Seconds spent on all results of the state.
    pub seconds: f64,
}

impl Analysis {
    /// Refuses what has no derivative by the positions of nodes, before anything is solved.
    ///
    /// # Errors
    /// As [`Self::check_gradients`]; loads, cavities, equations and results that depend on places of nodes in a way that is not differentiated.
    pub fn check_shape_gradients(&self, requests: &[Request]) -> Result<(), Error> {
        self.check_gradients(requests)?;
        requests.iter().try_for_each(|request| Scalar::check_shape(&request.column, &self.problem))?;
        let Problem { loads, cavities, equations, .. } = &self.problem;
        let (key, why) = if loads.iter().any(|load| !matches!(load, Load::Pressure { .. })) {
            ("load", "forces, tractions and weight are spread by the areas and volumes at rest")
        } else if cavities.iter().any(|cavity| !matches!(cavity.control, Control::Pressure(_))) {
            ("cavity", "what is shut in depends on the volume at rest")
        } else if !equations.is_empty() {
            ("equation", "coefficients of equations may depend on where nodes are")
        } else {
            return Ok(());
        };
        Err(InputError::new(format!("{key}: {why}: there are no derivatives by nodes")).of_key(key).into())
    }

    /// The derivatives that are asked for by the positions of all nodes, of states that were reached.
    ///
    /// # Errors
    /// As [`Self::check_shape_gradients`] and [`Self::gradients`].
    pub fn shape_gradients(
        &self,
        states: &[ConvergedState],
        requests: &[Request],
    ) -> Result<Vec<ShapeGradient>, Error> {
        self.check_shape_gradients(requests)?;
        self.by_state(states, requests, |state, columns| self.shape_gradients_at(state, columns))
    }

    fn shape_gradients_at(&self, state: &ConvergedState, columns: &[&str]) -> Result<Vec<ShapeGradient>, Error> {
        let began = Instant::now();
        let Solved { scalars, linearised, multipliers, .. } = self.solved(state, columns)?;
        let frozen = Frozen {
            displacement: linearised.displacement().to_vec(),
            cavity_pressures: state.cavity_pressures.clone(),
            lagrangians: Vec::new(),
        };
        let mut found = Vec::new();
        for (scalar, multipliers) in scalars.iter().zip(&multipliers) {
            let slope = linearised.shape_slope(multipliers).map_err(no_gradient)?;
            let mut by_node = slope.ok_or_else(|| no_gradient("something depends on the nodes beside the elements"))?;
            scalar.add_own_slope(&self.problem, &frozen, &mut by_node)?;
            let (of, value) = (scalar.column.clone(), scalar.value);
            found.push(ShapeGradient { of, at: state.parameter, value, by_node, seconds: 0.0 });
        }
        let seconds = began.elapsed().as_secs_f64();
        found.iter_mut().for_each(|gradient| gradient.seconds = seconds);
        Ok(found)
    }
}

impl Scalar {
    /// Adds what a result itself depends on the positions of nodes at rest at the frozen unknowns.
    fn add_own_slope(&self, problem: &Problem, frozen: &Frozen, slope: &mut [[f64; 3]]) -> Result<(), InputError> {
        let u = &frozen.displacement;
        if let Some(of_positions) = self.slope_by_positions(problem, u).map_err(no_gradient)? {
            let pairs = slope.as_flattened_mut().iter_mut().zip(of_positions.as_flattened());
            pairs.for_each(|(sum, own)| *sum += own);
            return Ok(());
        }
        let objective = self.objective(problem, u).map_err(no_gradient)?;
        let is_felt = |node: &usize| objective.by_displacement[*node] != [0.0; 3];
        let mut nodes: Vec<usize> = (0..u.len()).filter(is_felt).collect();
        nodes.extend(centreline_nodes(problem).iter().map(|node| *node as usize));
        nodes.sort_unstable();
        nodes.dedup();
        let step = SHARE * problem.mesh.mean_node_spacing();
        let mut moved = problem.clone();
        for node in nodes {
            for axis in 0..3 {
                let at_rest = problem.mesh.nodes[node][axis];
                let mut at = |steps: f64| {
                    Arc::make_mut(&mut moved.mesh).nodes[node][axis] = at_rest + steps * step;
                    self.explicit(&moved, frozen).map_err(no_gradient)
                };
                let (near, far) = ([at(-1.0)?, at(1.0)?], [at(-2.0)?, at(2.0)?]);
                slope[node][axis] += extrapolated(near, far, step);
                at(0.0)?;
            }
        }
        Ok(())
    }
}

/// Writes shape gradients into a result folder, as fields at the nodes of the body at rest, by the names of their requests.
///
/// # Errors
/// A file that cannot be written; a number that is not finite.
pub fn write_shape_gradients(
    folder: &OutputFolder,
    analysis: &Analysis,
    gradients: &[ShapeGradient],
) -> Result<(), Error> {
    let field = |gradient: &ShapeGradient| {
        let name = Request { column: gradient.of.clone(), at: Some(gradient.at.0) }.to_string();
        Field::vector(&name, gradient.by_node.as_flattened().to_vec())
    };
    let time = gradients.last().map_or(0.0, |gradient| gradient.at.0);
    let grid = fields::at_rest(&analysis.problem, time, gradients.iter().map(field).collect());
    let text = grid.to_vtu().map_err(|why| ResultsError::not_representable(SHAPE_GRADIENTS, why.to_string()))?;
    Ok(folder.write(SHAPE_GRADIENTS, text)?)
}
