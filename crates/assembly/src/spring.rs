//! Springs and dampers at nodes: weak springs that hold what only contact holds until contact does, dampers that hold back a body that snaps.
//!
//! Every node of such a part, or of a body that snaps, is tied to where it was when the step began, u₀, with the energy ½ c ‖u − u₀‖². Solved again and again from where the
//! last solution ended (the proximal point method: Rockafellar 1976, *SIAM J. Control Optim.* 14), an equilibrium of the body alone is what does not move any more: the springs carry nothing there, whatever their stiffness.
//! Motions that nothing resists, as those of a block along a plane without friction, stay where they are.

use crate::contribution::{Contribution, Position};
use crate::local::{LocalBlock, LocalContribution, LocalError, Request};

/// Springs at nodes.
#[derive(Clone, Debug)]
pub struct NodeSprings {
    /// A block for each.
    nodes: Vec<[u32; 1]>,
    /// Stiffness c of each, N/mm.
    stiffness: Vec<f64>,
    /// Displacements to which nodes are tied, mm, one entry per node.
    anchors: Vec<[f64; 3]>,
    /// Whether they are dampers.
    is_damping: bool,
    /// What stiffnesses count times.
    factor: f64,
}

impl NodeSprings {
    /// Springs at some nodes, with the stiffness of each, N/mm. Nodes begin tied to where they are at rest.
    pub fn new(springs: &[(u32, f64)], num_nodes: usize) -> Self {
        let (nodes, stiffness) = springs.iter().map(|&(node, stiffness)| ([node], stiffness)).unzip();
        Self { nodes, stiffness, anchors: vec![[0.0; 3]; num_nodes], is_damping: false, factor: 1.0 }
    }

    /// Dampers at some nodes, with the damping constant of each, N per mm of motion in a unit of pseudo-time: a step of pseudo-time Δτ is one of
    /// springs that are 1/Δτ times as stiff (implicit Euler). They rest until they are [told](Contribution::damp).
    pub fn dampers(constants: &[(u32, f64)], num_nodes: usize) -> Self {
        Self { is_damping: true, factor: 0.0, ..Self::new(constants, num_nodes) }
    }

    /// Stiffness of a spring, N/mm.
    fn stiffness(&self, spring: usize) -> f64 {
        self.factor * self.stiffness[spring]
    }

    /// How far a spring's node is from where it is tied, mm.
    fn elongation(&self, spring: usize, displacement: &[[f64; 3]]) -> [f64; 3] {
        let node = self.nodes[spring][0] as usize;
        std::array::from_fn(|k| displacement[node][k] - self.anchors[node][k])
    }

    fn force(&self, spring: usize, displacement: &[[f64; 3]]) -> [f64; 3] {
        self.elongation(spring, displacement).map(|x| self.stiffness(spring) * x)
    }
}

impl Contribution for NodeSprings {
    fn name(&self) -> &'static str {
        if self.is_damping { "dampers" } else { "springs" }
    }

    fn set_position(&mut self, _position: Position<'_>) {}

    fn blocks(&self) -> Option<&dyn LocalContribution> {
        (!self.nodes.is_empty()).then_some(self)
    }

    fn begin_step(&mut self, displacement: &[[f64; 3]]) {
        self.anchors.copy_from_slice(displacement);
    }

    fn vanishing_forces(&self, displacement: &[[f64; 3]]) -> Option<Vec<(u32, [f64; 3])>> {
        let force = |spring: usize| (self.nodes[spring][0], self.force(spring, displacement));
        (!self.nodes.is_empty() && self.factor > 0.0).then(|| (0..self.nodes.len()).map(force).collect())
    }

    fn damp(&mut self, rate: f64) {
        if self.is_damping {
            self.factor = rate;
        }
    }
}

impl LocalContribution for NodeSprings {
    fn num_blocks(&self) -> usize {
        self.nodes.len()
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
        let (elongation, stiffness) = (self.elongation(block, displacement), self.stiffness(block));
        let force = elongation.map(|x| stiffness * x);
        out.energy += 0.5 * stiffness * elongation.iter().map(|x| x * x).sum::<f64>();
        if request >= Request::Residual {
            (0..3).for_each(|k| out.residual[0][k] += force[k]);
        }
        if request == Request::Tangent {
            (0..3).for_each(|k| out.tangent[0][4 * k] += stiffness);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn force_and_stiffness_are_derivatives_of_the_energy() {
        let mut springs = NodeSprings::new(&[(0, 2.0), (2, 3.0)], 3);
        springs.begin_step(&[[0.1, -0.2, 0.3]; 3]);
        let at = |springs: &NodeSprings, u: &[[f64; 3]], block: usize, request| {
            let mut out = LocalBlock::default();
            out.reset(1, request);
            springs.evaluate(block, u, request, &mut out).unwrap();
            out
        };
        let (u, h) = ([[0.4, 0.5, -0.6], [0.0; 3], [0.7, 0.8, 0.9]], 1e-5);
        for block in 0..2 {
            let node = springs.nodes(block)[0] as usize;
            let here = at(&springs, &u, block, Request::Tangent);
            assert!(here.energy > 0.1);
            for k in 0..3 {
                let moved = |step: f64| {
                    let mut u = u;
                    u[node][k] += step;
                    at(&springs, &u, block, Request::Residual)
                };
                let (low, high) = (moved(-h), moved(h));
                assert!(((high.energy - low.energy) / (2.0 * h) - here.residual[0][k]).abs() < 1e-8);
                for i in 0..3 {
                    let slope = (high.residual[0][i] - low.residual[0][i]) / (2.0 * h);
                    assert!((slope - here.tangent[0][3 * k + i]).abs() < 1e-8);
                }
            }
            let force = springs.vanishing_forces(&u).unwrap()[block];
            assert_eq!((force.0 as usize, force.1), (node, here.residual[0]));
        }
        springs.begin_step(&u);
        assert_eq!(at(&springs, &u, 1, Request::Residual).residual, [[0.0; 3]]);
    }
}
