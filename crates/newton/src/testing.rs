//! Contributions without mechanics, for tests of the solver's rooms.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use pneuflex_assembly::{
    BorderedEquation, BoundaryTerm, Contribution, Couplings, Elimination, LocalBlock, LocalContribution, LocalError,
    Position, Request,
};
use pneuflex_factor::Parallelism;
use pneuflex_mesh::lattice::Lattice;
use pneuflex_mesh::{ElementKind, Mesh};
use pneuflex_model::{LoadParameter, Pressure};

use crate::system::System;

/// A cube of one element; its nodes are tied to their places by springs.
pub(crate) fn cube() -> Arc<Mesh> {
    Arc::new(Lattice::uniform([0.0; 3], [1.0; 3], [1, 1, 1]).mesh_all(ElementKind::Hex8))
}

/// A spring at every node, k |u|² / 2, pulled by a force along x that is the load parameter, N.
pub(crate) struct Springs {
    pub stiffness: f64,
    nodes: Vec<[u32; 1]>,
    parameter: LoadParameter,
    /// Forces of the last node on the first that no energy has: ½ p ∮ around the cube's faces under this pressure.
    follower: Option<BoundaryTerm>,
    /// Whether the sum of the displacements along x is given: the load parameter itself, mm.
    is_constrained: bool,
    multiplier: f64,
    pub commits: Arc<AtomicUsize>,
    pub reverts: Arc<AtomicUsize>,
}

impl Springs {
    pub fn new(mesh: &Arc<Mesh>, stiffness: f64) -> Self {
        Self {
            stiffness,
            nodes: (0..mesh.num_nodes() as u32).map(|node| [node]).collect(),
            parameter: LoadParameter::default(),
            follower: None,
            is_constrained: false,
            multiplier: 0.0,
            commits: Arc::default(),
            reverts: Arc::default(),
        }
    }

    /// With the unsymmetric terms of a pressure on one open face.
    pub fn with_follower(self, mesh: &Arc<Mesh>) -> Self {
        let facets = mesh.boundary_facets();
        Self { follower: Some(BoundaryTerm::new(Arc::clone(mesh), &facets[..1])), ..self }
    }

    /// With Σ u_x = load parameter instead of the force.
    pub fn constrained(self) -> Self {
        Self { is_constrained: true, ..self }
    }

    /// The system of these springs alone; the first node is held.
    pub fn system(self, mesh: &Arc<Mesh>) -> System {
        let mut held = vec![false; 3 * mesh.num_nodes()];
        held[..3].fill(true);
        let constraints = (held, Elimination::default());
        System::with_contributions(mesh, constraints, vec![Box::new(self)], Parallelism::Serial).unwrap()
    }
}

impl LocalContribution for Springs {
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
        let u = displacement[block];
        out.energy += 0.5 * self.stiffness * u.iter().map(|x| x * x).sum::<f64>();
        if request >= Request::Residual {
            for k in 0..3 {
                out.residual[0][k] += self.stiffness * u[k];
            }
        }
        if request == Request::Tangent {
            for k in 0..3 {
                out.tangent[0][4 * k] += self.stiffness;
            }
        }
        Ok(())
    }
}

impl Contribution for Springs {
    fn name(&self) -> &'static str {
        "springs"
    }

    fn set_position(&mut self, position: Position<'_>) {
        self.parameter = position.parameter;
        self.multiplier = position.bordered.first().copied().unwrap_or(0.0);
    }

    fn blocks(&self) -> Option<&dyn LocalContribution> {
        Some(self)
    }

    fn is_load(&self) -> bool {
        true
    }

    fn add_forces(&self, residual: &mut [[f64; 3]]) {
        let along_x = if self.is_constrained { self.multiplier } else { -self.parameter.0 };
        residual.iter_mut().for_each(|r| r[0] += along_x);
    }

    fn add_couplings(&self, displacement: &[[f64; 3]], couplings: &mut Couplings) {
        if let Some(follower) = &self.follower {
            follower.couple(Pressure::from_mpa(1.0), displacement, couplings);
        }
    }

    fn num_bordered(&self) -> usize {
        usize::from(self.is_constrained)
    }

    fn bordered_equations(&self, displacement: &[[f64; 3]]) -> Vec<BorderedEquation> {
        if !self.is_constrained {
            return Vec::new();
        }
        let sum: f64 = displacement.iter().map(|u| u[0]).sum();
        vec![BorderedEquation {
            value: sum - self.parameter.0,
            along_column: 1.0,
            by_unknown: 0.0,
            scale: 1.0,
            column: vec![[1.0, 0.0, 0.0]; displacement.len()],
        }]
    }

    fn commit(&mut self) {
        self.commits.fetch_add(1, Ordering::Relaxed);
    }

    fn revert(&mut self) {
        self.reverts.fetch_add(1, Ordering::Relaxed);
    }
}
