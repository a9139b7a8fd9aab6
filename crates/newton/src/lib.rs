//! Newton–Raphson with mixed linearisation, rotation updates and load stepping.
//!
//! * [`contributions`]: the list of what a problem's energy and residual consist of; [`system`]: their sum at a state,
//!   `unilateral`: its contact.
//! * [`state`]: the unknowns, and an equilibrium; [`linearisation`]: what a tangent is made from.
//! * [`tangent_solver`]: solutions with a tangent: its factor, `bordered` unknowns, an unsymmetric part.
//! * [`rigid_motion`]: what nothing holds, before anything is solved.
//! * [`globalisation`]: what becomes of a correction; `convergence`: when a state is an equilibrium; `stability`: how firm it is;
//!   [`unstable_motion`]: what it does if it is not.
//! * [`rotation_update`]: how displacements follow a correction.
//! * [`path`]: Newton's method at one load, the guess before it, the steps around it; [`arc`]: beyond limit points; `prescribed_motion`:
//!   supports that move.
//! * [`corrected`]: corrections of a state that was found on another mesh.
//! * [`adjoint`]: derivatives of an equilibrium's results by everything that its problem is made of.
//! * [`augmentation`]: the contact's multipliers at the requested positions.
//! * [`checkpoint`]: what is needed to go on after a kill; [`event`], [`history`], [`failure`],
//!   [`timing`]: what a run reports.
//!
//! Files, clocks on the wall and terminals are other crates' business: a run talks to an observer.

pub mod adjoint;
pub mod arc;
pub mod augmentation;
pub mod bordered;
pub mod checkpoint;
pub mod contributions;
mod convergence;
pub mod corrected;
pub mod error;
pub mod event;
pub mod failure;
pub mod globalisation;
pub mod history;
pub mod holding_springs;
pub mod linearisation;
pub mod path;
mod prescribed_motion;
pub mod rigid_motion;
pub mod rotation_update;
mod stability;
pub mod state;
pub mod system;
pub mod tangent_solver;
#[cfg(test)]
mod testing;
pub mod tied;
pub mod timing;
mod tuning;
mod unilateral;
pub mod unstable_motion;

pub use arc::ArcMemory;
pub use checkpoint::Checkpoint;
pub use error::{AssembleError, ResumeError, SetupError};
pub use event::{Event, Observer};
pub use failure::{Cause, Failure, Stability};
pub use history::{Augmentation, Bifurcation, ConvergedState, IterationRecord, Snap};
pub use holding_springs::springs_of;
pub use path::{EquilibriumPath, Path, follow_path};
pub use rigid_motion::{LoosePart, loose_parts};
pub use state::{Correction, Equilibrium, State};
pub use system::System;
pub use tangent_solver::{Assembled, Tangent};
pub use tied::{TieError, glued};
pub use timing::{PathReport, Timing};
pub use unstable_motion::UnstableMotions;
