//! What one contribution to the equilibrium offers: the solid, a pressure, contact, …
//!
//! A solver is given a list of contributions and knows none of them by name. Each takes a [`Position`] and is evaluated there: symmetric
//! blocks ([`LocalContribution`]), forces without a tangent, an unsymmetric part, equations of unknowns beside the displacements.
//! What only some have stands in a trait of its own: [`Mixed`], [`Unilateral`].

use std::sync::Arc;

use pneuflex_model::{Curve, LoadParameter};

use crate::boundary_term::Couplings;
use crate::local::{LocalContribution, LocalError};

/// Where contributions are evaluated.
#[derive(Clone, Copy, Debug)]
pub struct Position<'a> {
    /// Position on the load path.
    pub parameter: LoadParameter,
    /// Displacements, mm, one entry per node.
    pub displacement: &'a [[f64; 3]],
    /// Unknowns beside the displacements, those of one contribution or of all.
    pub bordered: &'a [f64],
    /// Whether it is one of Newton's method on its way: contact then keeps points for which the linear system predicts traction.
    pub is_on_the_way: bool,
}

/// A Lagrangian e E − Λ·r at frozen displacements.
#[derive(Clone, Copy, Debug)]
pub struct Frozen<'a> {
    /// Displacements, mm, one entry per node.
    pub displacement: &'a [[f64; 3]],
    /// Λ, one entry per node.
    pub multipliers: &'a [[f64; 3]],
    /// e, the weight of the solid's energy.
    pub energy: f64,
}

/// A contribution to the energy and the residual.
pub trait Contribution: Send + Sync {
    /// What it is, in a word.
    fn name(&self) -> &'static str;

    /// Takes a position; everything below is evaluated there. Its [`Position::bordered`] are this contribution's own.
    fn set_position(&mut self, position: Position<'_>);

    /// Energy, residual and the symmetric part of the tangent, block by block; `None` if it has only forces.
    fn blocks(&self) -> Option<&dyn LocalContribution>;

    /// Whether it is a load from outside: the scale of the residual is the norm of the loads.
    fn is_load(&self) -> bool {
        false
    }

    /// Adds to the residual (N, one entry per node) what is in no block: forces that do not depend on the displacements.
    fn add_forces(&self, _residual: &mut [[f64; 3]]) {}

    /// Adds what the tangent has beside its symmetric blocks at a displacement.
    fn add_couplings(&self, _displacement: &[[f64; 3]], _couplings: &mut Couplings) {}

    /// Number of unknowns that it has beside the displacements.
    fn num_bordered(&self) -> usize {
        0
    }

    /// The equations of these unknowns.
    fn bordered_equations(&self, _displacement: &[[f64; 3]]) -> Vec<BorderedEquation> {
        Vec::new()
    }

    /// Its part in a mixed linearisation, if it has one.
    fn mixed(&mut self) -> Option<&mut dyn Mixed> {
        None
    }

    /// Whether a displacement that solves the equations may count as an equilibrium, from which results are derived.
    ///
    /// # Errors
    /// An element that is turned inside out where the equations did not notice.
    fn check_equilibrium(&self, _displacement: &[[f64; 3]]) -> Result<(), LocalError> {
        Ok(())
    }

    /// Mean volumetric pressure of every element at a displacement, MPa, tension positive; empty if it has no elements.
    fn element_tensions(&self, _displacement: &[[f64; 3]]) -> Vec<f64> {
        Vec::new()
    }

    /// What it keeps apart, if it is contact. Its blocks may have other nodes at other positions then.
    fn unilateral(&self) -> Option<&dyn Unilateral> {
        None
    }

    /// The same, to be changed.
    fn unilateral_mut(&mut self) -> Option<&mut dyn Unilateral> {
        None
    }

    /// A step begins at a displacement: what was chosen on the way to it is chosen there again. Then the step does not depend on that way,
    /// and a resumed path goes on as it would have.
    fn begin_step(&mut self, _displacement: &[[f64; 3]]) {}

    /// Forces at a displacement that must have vanished where results are wanted, N, node by node; `None` if it has none of the kind.
    fn vanishing_forces(&self, _displacement: &[[f64; 3]]) -> Option<Vec<(u32, [f64; 3])>> {
        None
    }

    /// Adds the slope of its part e E − Λ·r of a Lagrangian by the positions of the nodes at rest, N times the Lagrangian's unit per mJ, one entry per
    /// node. `false` if it does not say: something else of it than its blocks depends on them.
    ///
    /// # Errors
    /// [`LocalError`] of a block that cannot be evaluated.
    fn add_shape_slope(&self, _frozen: &Frozen<'_>, _slope: &mut [[f64; 3]]) -> Result<bool, LocalError> {
        Ok(self.blocks().is_none_or(|blocks| blocks.num_blocks() == 0))
    }

    /// Dampers take 1/Δτ of the step of pseudo-time that follows; 0 lets them rest.
    fn damp(&mut self, _rate: f64) {}

    /// The position taken last has become the state of equilibrium: history follows.
    fn commit(&mut self) {}

    /// The attempt has failed: history goes back to the last state of equilibrium.
    fn revert(&mut self) {}
}

/// The equation g(u, y) = 0 of an unknown y beside the displacements, which acts on the body along a column B of forces:
/// r(u, y) = r(u) + y B(u) (theory §6.5).
#[derive(Clone, Debug)]
pub struct BorderedEquation {
    /// g, in the unit of `scale`.
    pub value: f64,
    /// s: derivative of g along the column.
    pub along_column: f64,
    /// h: derivative of g by the unknown itself.
    pub by_unknown: f64,
    /// What g is small against.
    pub scale: f64,
    /// B over all degrees of freedom, N per unit of the unknown, one entry per node.
    pub column: Vec<[f64; 3]>,
}

/// A contribution whose tangent may be taken with stresses of its own (mixed linearisation, theory §11): pressures of elements, tractions
/// of contact points. The residual is not touched.
pub trait Mixed {
    /// Takes the stresses that the linear system predicts. With a correction, its displacement is that of the position taken last.
    fn predict(&mut self, prediction: &Arc<Prediction>);

    /// A tangent is assembled next: what was put off until then is done now.
    fn linearise(&mut self) {}

    /// Number of values in [`Self::stored`] once a tangent was assembled.
    fn num_stored(&self) -> usize;

    /// The stresses of the tangent that is assembled next or was assembled last, and what else it is made from: what a checkpoint keeps.
    fn stored(&self) -> &[f64];

    /// Puts them back. The list has [`Self::num_stored`] values.
    fn restore(&mut self, stored: &[f64]);
}

/// What the stresses of a mixed linearisation follow from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Prediction {
    /// Displacements, mm, one entry per node.
    pub displacement: Vec<[f64; 3]>,
    /// The correction that the linear system found there, mm; `None` for the stresses of the displacement itself.
    pub correction: Option<Vec<[f64; 3]>>,
    /// Positions on the load path that obstacles move between meanwhile, if they do.
    pub motion: Option<[LoadParameter; 2]>,
}

/// Something rigid that moves with the load parameter, or an overlap that goes with it, and what that does to the body.
#[derive(Clone, Debug)]
pub struct RigidMotion {
    /// Its factor along the load path.
    pub curve: Curve,
    /// Change of the residual per unit of the factor, N, one entry per node: with the tangent's part K_qm, K_qm times the whole motion.
    pub column: Vec<[f64; 3]>,
}

/// What contact points carry.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tractions {
    /// ⟨λ − k d⟩ of all points, MPa; 0 of those that no traction can free.
    pub values: Vec<f64>,
    /// Largest |d| of those that carry one, mm.
    pub distance: f64,
    /// Largest |d| as a multiple of the point's own tolerance; 0 where there is none.
    pub excess: f64,
    /// What is where supports hold the body, and how deep, mm: there the depth stays, and is no part of `distance` and `excess`.
    pub stuck: Option<(f64, String)>,
}

/// Points that must not pass through what is in their way.
pub trait Unilateral {
    /// Number of points.
    fn num_points(&self) -> usize;

    /// Number of points in contact at the position taken last.
    fn num_active(&self) -> usize;

    /// Nodes of the blocks that may soon be there beside those that are: the tangent's pattern needs room for them.
    fn near_nodes(&self) -> Vec<Vec<u32>>;

    /// Largest penetration at a position, which is not taken, mm; 0 where nothing touches.
    fn deepest_penetration(&mut self, position: Position<'_>) -> f64;

    /// Name of what the body would have passed through on the straight way between two positions, if it would.
    fn passed_through(&self, ends: [Position<'_>; 2]) -> Option<String>;

    /// What its moving obstacles and overlaps that go do to the body, linearised at the position taken last.
    fn motions(&self) -> Vec<RigidMotion>;

    /// Tractions of all points at a displacement, and how far from their partners those are that carry one.
    fn tractions(&self, displacement: &[[f64; 3]]) -> Tractions;

    /// Whether any point has a tolerance for its depth, which multipliers are to meet.
    fn is_augmented(&self) -> bool;

    /// Traction λ that every point carries without penetration, MPa (augmented Lagrangian); empty for none.
    fn multipliers(&self) -> &[f64];

    /// Sets them. There must be none or as many as points.
    fn set_multipliers(&mut self, multipliers: Vec<f64>);
}
