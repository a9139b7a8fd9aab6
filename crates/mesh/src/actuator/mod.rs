//! The parametric soft actuator of theory §1: a row of chambers on a continuous base.
//!
//! ```text
//!   z                chamber 1        chamber 2
//!   H ─          ┌──────────────┐  ┌──────────────┐   ── top wall
//!                │ ┌──────────┐ │  │ ┌──────────┐ │
//!                │ │ cavity 1 │ │  │ │ cavity 2 │ │   walls between cavity and gap:
//!                │ │          │ │  │ │          │ │   (chamber_length − cavity_length)/2
//!   base ─ ┌─────┘ └──┐    ┌──┘ └──┘ └──┐    ┌──┘ └─────┐
//!          │ flange   └────┘  channel   └────┘   flange │
//!   0 ──── └────────────────────────────────────────────┘ ── x
//! ```
//!
//! Sets of the generated mesh: node sets `clamp` (x = 0), `symmetry` (y = 0, half models only), `bottom_centreline`
//! (y = z = 0), `end_face` (x = L, z ≤ base); facet sets `cavity` (all faces that feel the air), `cavity_i` (those of
//! chamber i, from 1, where no channel joins the cavities), `gap_i_left` and `gap_i_right` (the wall of chamber i and of
//! chamber i + 1 that face each other, i from 1, unless this gap is 0), `bottom` (z = 0), `end_face` and `clamp`, and `outer`: all faces that look out of the body, those of the gaps included, but not the clamped one.
//!
//! Width and height are the same all along the body. A chamber with thicker side or top walls than others has a narrower or lower cavity; as
//! the mesh is a lattice, the planes of its walls divide the elements of all chambers.

mod build;
mod lengths;
mod moved;
mod per_chamber;
mod plan;
mod planes;
mod ranges;
mod row;
#[cfg(test)]
mod tests;

pub use build::{build_actuator, build_actuator_with};
pub use lengths::{Actuator, Channel, LENGTHS_PER_CHAMBER, Part};
pub use moved::NotMovable;
pub use per_chamber::PerChamber;
pub use plan::{Filling, Plan};
pub use planes::Cuts;
pub use ranges::{GeometryError, LENGTHS};
pub use row::Chamber;
