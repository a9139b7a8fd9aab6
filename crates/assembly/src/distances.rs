//! Distances between nodes that stay what they are at rest: what makes a body rigid whose other nodes follow by linear equations (theory
//! §6.4).
//!
//! With d = x_a − x_b and its length L at rest, g = (|d|² − L²)/2L = 0 is enforced by a multiplier, an unknown beside the displacements. It is
//! a force along d, whose direction turns with the body: the tangent has λ ∂²g/∂u² as well. The blocks are the augmented Lagrangian
//! λ g + ½ γ g²; γ changes no solution, and keeps the tangent regular.

use pneuflex_mesh::vector::{norm, sub};
use pneuflex_model::Problem;

use crate::contribution::{BorderedEquation, Contribution, Position};
use crate::local::{LocalBlock, LocalContribution, LocalError, Request};

/// Stiffness γ, relative to a shear modulus times an element's size.
const STIFFNESS: f64 = 10.0;

/// Pairs of nodes with the multipliers of one position.
#[derive(Clone, Debug)]
pub struct Distances {
    pairs: Vec<[u32; 2]>,
    /// d at rest, mm.
    at_rest: Vec<[f64; 3]>,
    /// γ, N/mm.
    stiffness: f64,
    /// λ of every pair, N.
    multipliers: Vec<f64>,
    /// What g is small against, mm.
    size: f64,
}

impl Distances {
    /// Those of a problem.
    pub fn of(problem: &Problem) -> Self {
        let mesh = &problem.mesh;
        let (materials, _) = problem.materials();
        let stiffest = materials.iter().map(|material| material.shear_modulus()).fold(0.0, f64::max);
        let stiffness = STIFFNESS * stiffest * mesh.mean_element_size();
        Self::new(&problem.distances, &mesh.nodes, stiffness, mesh.extent())
    }

    /// Pairs of nodes that are at `nodes` at rest, with a stiffness in N/mm, for a body of a size (mm).
    pub fn new(pairs: &[[u32; 2]], nodes: &[[f64; 3]], stiffness: f64, size: f64) -> Self {
        let between = |&[a, b]: &[u32; 2]| sub(nodes[a as usize], nodes[b as usize]);
        Self {
            pairs: pairs.to_vec(),
            at_rest: pairs.iter().map(between).collect(),
            stiffness,
            multipliers: vec![0.0; pairs.len()],
            size,
        }
    }

    /// g and d/L, which is its derivative by the first node's displacement.
    fn violation(&self, pair: usize, displacement: &[[f64; 3]]) -> (f64, [f64; 3]) {
        let ([a, b], rest) = (self.pairs[pair].map(|node| displacement[node as usize]), self.at_rest[pair]);
        let length = norm(rest);
        let change = sub(a, b);
        // |d|² − L² without cancellation.
        let difference: f64 = (0..3).map(|k| change[k] * (2.0 * rest[k] + change[k])).sum();
        (difference / (2.0 * length), std::array::from_fn(|k| (rest[k] + change[k]) / length))
    }
}

impl Contribution for Distances {
    fn name(&self) -> &'static str {
        "fixed distances"
    }

    fn set_position(&mut self, position: Position<'_>) {
        self.multipliers.copy_from_slice(position.bordered);
    }

    fn blocks(&self) -> Option<&dyn LocalContribution> {
        Some(self)
    }

    fn num_bordered(&self) -> usize {
        self.pairs.len()
    }

    fn bordered_equations(&self, displacement: &[[f64; 3]]) -> Vec<BorderedEquation> {
        let of = |(pair, [a, b]): (usize, &[u32; 2])| {
            let (value, slope) = self.violation(pair, displacement);
            let mut column = vec![[0.0; 3]; displacement.len()];
            column[*a as usize] = slope;
            column[*b as usize] = slope.map(|x| -x);
            BorderedEquation { value, along_column: 1.0, by_unknown: 0.0, scale: self.size, column }
        };
        self.pairs.iter().enumerate().map(of).collect()
    }
}

impl LocalContribution for Distances {
    fn num_blocks(&self) -> usize {
        self.pairs.len()
    }

    fn nodes(&self, block: usize) -> &[u32] {
        &self.pairs[block]
    }

    fn evaluate(
        &self,
        block: usize,
        displacement: &[[f64; 3]],
        request: Request,
        out: &mut LocalBlock,
    ) -> Result<(), LocalError> {
        let (violation, slope) = self.violation(block, displacement);
        out.energy += (self.multipliers[block] + 0.5 * self.stiffness * violation) * violation;
        if request == Request::Energy {
            return Ok(());
        }
        let force = self.multipliers[block] + self.stiffness * violation;
        for k in 0..3 {
            out.residual[0][k] += force * slope[k];
            out.residual[1][k] -= force * slope[k];
        }
        if request == Request::Tangent {
            let turning = force / norm(self.at_rest[block]);
            for j in 0..3 {
                for i in 0..3 {
                    let value = self.stiffness * slope[i] * slope[j] + if i == j { turning } else { 0.0 };
                    out.tangent[0][3 * j + i] += value;
                    out.tangent[1][3 * j + i] -= value;
                    out.tangent[2][3 * j + i] += value;
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_model::LoadParameter;

    /// By finite differences at a turned and stretched state with a multiplier: energy → residual → tangent, g → column.
    #[test]
    fn derivatives_are_those_of_the_energy() {
        let nodes = [[0.0; 3], [2.0, 0.5, -1.0], [1.0, 1.0, 1.0]];
        let mut distances = Distances::new(&[[2, 1]], &nodes, 7.0, 1.0);
        let mut u = vec![[0.0; 3], [0.3, -0.4, 0.8], [-0.7, 0.2, 0.5]];
        let position =
            Position { parameter: LoadParameter(1.0), displacement: &u, bordered: &[0.6], is_on_the_way: false };
        distances.set_position(position);
        let evaluate = |u: &[[f64; 3]]| {
            let mut out = LocalBlock { energy: 3.0, residual: vec![[5.0; 3]; 4], tangent: Vec::new() };
            out.reset(2, Request::Tangent);
            distances.evaluate(0, u, Request::Tangent, &mut out).unwrap();
            (out, distances.bordered_equations(u).swap_remove(0))
        };
        let (here, equation) = evaluate(&u);
        assert!(equation.value.abs() > 0.1 && here.energy.abs() > 0.1, "the check would be empty");
        let h = 1e-6;
        for (index, node) in [2_usize, 1].into_iter().enumerate() {
            for k in 0..3 {
                let mut at = |shift: f64| {
                    let before = u[node][k];
                    u[node][k] += shift;
                    let found = evaluate(&u);
                    u[node][k] = before;
                    found
                };
                let ((low, g_low), (high, g_high)) = (at(-h), at(h));
                assert!(((high.energy - low.energy) / (2.0 * h) - here.residual[index][k]).abs() < 1e-8);
                assert!(((g_high.value - g_low.value) / (2.0 * h) - equation.column[node][k]).abs() < 1e-9);
                for (a, i) in (index..2).flat_map(|a| (0..3).map(move |i| (a, i))) {
                    let slope = (high.residual[a][i] - low.residual[a][i]) / (2.0 * h);
                    let exact = here.tangent[a * (a + 1) / 2 + index][3 * k + i];
                    assert!((slope - exact).abs() < 1e-7, "{slope} {exact}");
                }
            }
        }
    }
}
