//! What a run reports: iterations and converged states. Plain data.

use pneuflex_model::{LoadParameter, Pressure, StateKind};
use serde::{Deserialize, Serialize};

use crate::unstable_motion::UnstableMotions;

/// One Newton iteration.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct IterationRecord {
    /// Load step, from 1; rejected attempts count.
    pub step: usize,
    /// Iteration within the step, from 1: the number of tangents factorised.
    pub iteration: usize,
    /// Whether this correction is one of a new tangent; otherwise the factor of the iteration was used again.
    pub new_tangent: bool,
    /// Position of the attempt on the load path.
    #[serde(rename = "time")]
    pub parameter: LoadParameter,
    /// ‖\[Δq; Δλ\]‖ with lengths in mean spacings h of the nodes and forces in μ h², μ the shear modulus.
    pub correction: f64,
    /// Norm of the residual over the free degrees of freedom before the correction, N.
    pub residual: f64,
    /// The same relative to the norm of the loads, or of the supports' forces where supports or cavities drive the body.
    pub relative_residual: f64,
    /// Contact points that carry traction.
    pub contact_points: usize,
    /// Negative pivots of the tangent; 0 when it is positive definite.
    pub negative_pivots: usize,
    /// Seconds since the run began.
    pub elapsed_s: f64,
}

/// An equilibrium at one of the requested positions, or one beyond a limit point.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvergedState {
    /// Position on the load path: the pressure in kPa for actuators.
    pub parameter: LoadParameter,
    /// Why it is told of.
    pub kind: StateKind,
    /// Motions that would release energy if the loads kept their values; on a path that ends where there are any, none.
    pub negative_pivots: usize,
    /// Displacements, mm, one entry per node.
    pub displacement: Vec<[f64; 3]>,
    /// Forces of the supports on the body, N, one entry per node, zero at free degrees of freedom: −λ of R + Φᵀλ = 0.
    pub reaction: Vec<[f64; 3]>,
    /// Newton iterations spent since the previous one, rejected attempts included.
    pub iterations: usize,
    /// Load steps accepted since the previous one.
    pub load_steps: usize,
    /// Contact points that carry traction.
    pub contact_points: usize,
    /// Pressure in every cavity.
    pub cavity_pressures: Vec<Pressure>,
    /// Multipliers of all contact points, MPa; empty for a plain penalty.
    pub contact_multipliers: Vec<f64>,
    /// How the contact's multipliers came about; `None` for a plain penalty.
    pub augmentation: Option<Augmentation>,
    /// Motions of the mesh that release energy there, if there are any.
    pub mesh_motions: Option<UnstableMotions>,
    /// Where the path has left a branch since the state before.
    pub bifurcations: Vec<Bifurcation>,
    /// How the body has snapped since the state before.
    pub snaps: Vec<Snap>,
}

/// A jump of the body from one equilibrium to another one: under the same loads, held back by dampers that rest at both, or in a load step that
/// leads further than the tangents at both of its ends predict.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Snap {
    /// Position of the last equilibrium before it.
    pub from: LoadParameter,
    /// Position of the equilibrium after it.
    pub to: LoadParameter,
    /// Node that it moved furthest.
    pub node: usize,
    /// Where that was at rest, mm.
    pub place: [f64; 3],
    /// How far it moved, mm.
    pub moved: f64,
    /// Work that the dampers took up, mJ: what the loads and the body had to spare. `None` where it could not be integrated.
    pub released: Option<f64>,
    /// Steps of pseudo-time; none where a load step has jumped.
    pub steps: usize,
}

/// Where a path left a branch of equilibria that becomes unstable for another one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bifurcation {
    /// Position of the last equilibrium before it.
    pub parameter: LoadParameter,
    /// The motion that becomes unstable, its largest displacement 1, one entry per node.
    pub mode: Vec<[f64; 3]>,
    /// Its largest displacement in the guess that led to the other branch, mm.
    pub size: f64,
    /// Where it strains the body.
    pub motions: UnstableMotions,
}

/// The contact of a state as an augmented Lagrangian left it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Augmentation {
    /// How often the multipliers were brought up to date.
    pub count: usize,
    /// Largest distance |d| of a contact point that carries traction, mm.
    pub distance: f64,
    /// Why it is above the tolerance, if it is.
    pub failure: Option<String>,
}
