//! Linear equations between displacements, Σ cᵢ uᵢ = b, that are not eliminated ([`crate::Elimination`]).
//!
//! They are enforced exactly by a multiplier each, an unknown beside the displacements with the equation g = cᵀu − b and the column B = c.
//! The blocks are the stabilising half of the augmented Lagrangian, ½ γ (cᵀu − b)²: it changes no solution, and keeps the tangent
//! regular where a part of the body is held by equations alone.

use pneuflex_model::{LinearEquation, LoadParameter, Problem};

use crate::contribution::{BorderedEquation, Contribution, Position};
use crate::local::{LocalBlock, LocalContribution, LocalError, Request};

/// Stiffness that stabilises linear equations, relative to a shear modulus times an element's size: large enough to carry a part of the
/// body, small enough to lose no digits.
const STIFFNESS: f64 = 10.0;

/// The equations, with the right-hand sides and the multipliers of one position.
#[derive(Clone, Debug)]
pub struct Equations {
    equations: Vec<LinearEquation>,
    nodes: Vec<Vec<u32>>,
    /// γ of every equation, N/mm per coefficient squared.
    stiffness: Vec<f64>,
    values: Vec<f64>,
    /// λ of every equation, N.
    multipliers: Vec<f64>,
    /// What cᵀu is large against, mm.
    size: f64,
}

impl Equations {
    /// Those of a problem that have not been eliminated.
    pub fn of(problem: &Problem, equations: &[LinearEquation]) -> Self {
        let mesh = &problem.mesh;
        let (materials, _) = problem.materials();
        let stiffest = materials.iter().map(|material| material.shear_modulus()).fold(0.0, f64::max);
        Self::new(equations, STIFFNESS * stiffest * mesh.mean_element_size(), mesh.extent())
    }

    /// Equations with a stiffness (N/mm) that single nodes have, for a body of a size (mm).
    pub fn new(equations: &[LinearEquation], stiffness: f64, size: f64) -> Self {
        let nodes = equations.iter().map(|equation| {
            let mut nodes: Vec<u32> = equation.terms.iter().map(|term| term.0).collect();
            nodes.sort_unstable();
            nodes.dedup();
            nodes
        });
        let squared = |equation: &LinearEquation| equation.terms.iter().map(|term| term.2 * term.2).sum::<f64>();
        Self {
            nodes: nodes.collect(),
            stiffness: equations.iter().map(|equation| stiffness / squared(equation)).collect(),
            values: vec![0.0; equations.len()],
            multipliers: vec![0.0; equations.len()],
            size,
            equations: equations.to_vec(),
        }
    }

    /// Number of equations.
    pub fn len(&self) -> usize {
        self.equations.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.equations.is_empty()
    }

    /// Takes the right-hand sides of a position on the load path.
    pub fn set_parameter(&mut self, parameter: LoadParameter) {
        for (value, equation) in self.values.iter_mut().zip(&self.equations) {
            *value = equation.value.at(parameter);
        }
    }

    /// cᵀu − b of an equation.
    pub fn violation(&self, equation: usize, displacement: &[[f64; 3]]) -> f64 {
        let terms = &self.equations[equation].terms;
        let sum: f64 = terms.iter().map(|&(node, axis, c)| c * displacement[node as usize][axis as usize]).sum();
        sum - self.values[equation]
    }

    /// The coefficients c of an equation as a field over the nodes.
    pub fn column(&self, equation: usize, num_nodes: usize) -> Vec<[f64; 3]> {
        let mut column = vec![[0.0; 3]; num_nodes];
        for &(node, axis, c) in &self.equations[equation].terms {
            column[node as usize][axis as usize] += c;
        }
        column
    }
}

impl Contribution for Equations {
    fn name(&self) -> &'static str {
        "linear equations"
    }

    fn set_position(&mut self, position: Position<'_>) {
        self.set_parameter(position.parameter);
        self.multipliers.copy_from_slice(position.bordered);
    }

    fn blocks(&self) -> Option<&dyn LocalContribution> {
        Some(self)
    }

    fn add_forces(&self, residual: &mut [[f64; 3]]) {
        for (equation, multiplier) in self.equations.iter().zip(&self.multipliers) {
            for &(node, axis, c) in &equation.terms {
                residual[node as usize][axis as usize] += multiplier * c;
            }
        }
    }

    fn num_bordered(&self) -> usize {
        self.equations.len()
    }

    fn bordered_equations(&self, displacement: &[[f64; 3]]) -> Vec<BorderedEquation> {
        let of = |equation| BorderedEquation {
            value: self.violation(equation, displacement),
            along_column: 1.0,
            by_unknown: 0.0,
            scale: self.size,
            column: self.column(equation, displacement.len()),
        };
        (0..self.equations.len()).map(of).collect()
    }
}

impl LocalContribution for Equations {
    fn num_blocks(&self) -> usize {
        self.equations.len()
    }

    fn nodes(&self, block: usize) -> &[u32] {
        &self.nodes[block]
    }

    fn evaluate(
        &self,
        block: usize,
        displacement: &[[f64; 3]],
        request: Request,
        out: &mut LocalBlock,
    ) -> Result<(), LocalError> {
        let (violation, stiffness) = (self.violation(block, displacement), self.stiffness[block]);
        out.energy += 0.5 * stiffness * violation * violation;
        if request == Request::Energy {
            return Ok(());
        }
        let mut coefficients = vec![[0.0; 3]; self.nodes[block].len()];
        for &(node, axis, c) in &self.equations[block].terms {
            let index = self.nodes[block].partition_point(|&n| n < node);
            coefficients[index][axis as usize] += c;
        }
        for (r, c) in out.residual.iter_mut().zip(&coefficients) {
            for k in 0..3 {
                r[k] += stiffness * violation * c[k];
            }
        }
        if request == Request::Tangent {
            let mut pair = 0;
            for (a, ca) in coefficients.iter().enumerate() {
                for cb in &coefficients[..=a] {
                    for j in 0..3 {
                        for i in 0..3 {
                            out.tangent[pair][3 * j + i] += stiffness * ca[i] * cb[j];
                        }
                    }
                    pair += 1;
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_model::Curve;

    #[test]
    fn residual_and_tangent_are_derivatives_of_the_energy() {
        let terms = vec![(4, 0, 1.0), (1, 2, -2.0), (4, 1, 0.5), (2, 0, 3.0)];
        let mut equations = Equations::new(&[LinearEquation { terms, value: Curve::Proportional(0.2) }], 7.0, 1.0);
        equations.set_parameter(LoadParameter(1.5));
        let mut u: Vec<[f64; 3]> =
            (0..5).map(|n| std::array::from_fn(|k| 0.1 * f64::from(n) - 0.07 * k as f64)).collect();
        let evaluate = |u: &[[f64; 3]]| {
            let mut out = LocalBlock::default();
            out.reset(3, Request::Tangent);
            equations.evaluate(0, u, Request::Tangent, &mut out).unwrap();
            out
        };
        let here = evaluate(&u);
        assert!(here.energy > 1e-3, "the check would be empty");
        for (index, &node) in equations.nodes(0).iter().enumerate() {
            for k in 0..3 {
                let before = u[node as usize][k];
                let mut at = |shift: f64| {
                    u[node as usize][k] = before + shift;
                    evaluate(&u)
                };
                let (low, high) = (at(-1e-5), at(1e-5));
                u[node as usize][k] = before;
                let slope = (high.energy - low.energy) / 2e-5;
                assert!((slope - here.residual[index][k]).abs() < 1e-9);
                for a in index..3 {
                    for i in 0..3 {
                        let slope = (high.residual[a][i] - low.residual[a][i]) / 2e-5;
                        let exact = here.tangent[a * (a + 1) / 2 + index][3 * k + i];
                        assert!((slope - exact).abs() < 1e-8, "{slope} {exact}");
                    }
                }
            }
        }
    }
}
