//! Newton-Raphson with mixed linearisation, rotation-aware increments and load stepping.
//!
//! * [`system`]: the equations of a problem at a state: residual, tangent, factor, reactions.
//! * `loads`: its loads; [`border`]: the unknowns beside the displacements.
//! * `gmres`: solutions with the unsymmetric part that pressures on open surfaces have.
//! * [`warp`]: corrections bent into rotations.
//! * [`path`]: Newton's method at one load and the stepping around it.
//! * [`augmentation`]: the contact's multipliers at the requested loads.
//! * [`checkpoint`]: what is needed to go on after a kill.
//! * [`history`]: what a run reports.
//!
//! Files, clocks on the wall and terminals are other crates' business: a run talks to an observer.

pub mod augmentation;
pub mod border;
pub mod checkpoint;
mod gmres;
pub mod history;
mod loads;
pub mod path;
pub mod system;
pub mod warp;

pub use checkpoint::Checkpoint;
pub use history::{
    Augmentation, Cause, ConvergedState, Event, Failure, IterationRecord, PathReport, Stability, Timing,
};
pub use path::{Observer, Path, ResumeError, follow_path};
pub use system::{Correction, SetupError, System};
