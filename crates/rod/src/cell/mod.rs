//! Samples of the two-chamber cell for the rod: curvature of its bottom, bending stiffness, contact.
//!
//! The **curvature** is that of the bottom: the rotation of the base's cross-section from the middle of the one chamber to
//! that of the other, over the reference length between them, one chamber and one gap. The middle of a chamber is a plane
//! of symmetry of a long actuator, where a section stays plane and at right angles to the bottom; what the clamp and the
//! free end do to the cell has mostly faded there. The direction of the bottom line itself would jump from element to
//! element.
//!
//! The **bending stiffness** is ∂m/∂κ at constant pressure. The face at the end of the base is held as a plane that keeps
//! its shape (free across the width) and is moved by small amounts: two shifts and a rotation. The reactions give the
//! 3 × 3 stiffness of that motion; its inverse tells how far the cell bends under a moment alone, without forces, so that
//! the moment is the same all along the cell. Curvature is again read between the middles of the chambers, away from the
//! held face.
//!
//! Bent back far enough, the chambers touch: the **contact** samples are moment and curvature from there on.

mod error;
mod gauge;
mod held_end;
mod plane;

use pneuflex_mesh::{Actuator, PerChamber};
use pneuflex_model::{Case, ContactMethod, Problem, Solver};
use pneuflex_newton::{ConvergedState, Path};
use pneuflex_post::penetration;

pub use error::CellError;
use gauge::Gauge;
use held_end::{HeldEnd, problem_with_held_end, without_force};

use crate::identify::{ContactSample, FreeSample, Samples, StiffnessSample, TouchSample};

/// Highest pressure of the identification, kPa (theory §8: the paper's rod knows no contact).
pub const HIGHEST_KPA: f64 = 15.0;

/// Pressures of the unloaded cell, kPa.
const FREE_KPA: [f64; 8] = [1.0, 2.5, 5.0, 7.5, 10.0, 12.0, 13.5, HIGHEST_KPA];

/// Pressures, among those, at which the bending stiffness is measured, and the cell bent back until its chambers touch.
const BENT_KPA: [f64; 3] = [5.0, 10.0, HIGHEST_KPA];

/// By how much the end is turned at a time when the cell is bent back, rad, and how often at the most.
const TURN: f64 = 0.02;
const TURNS: usize = 25;

/// Turns after the first contact that are sampled.
const TURNS_IN_CONTACT: usize = 4;

/// Samples and what they are of.
pub struct Cell {
    /// For the identification.
    pub samples: Samples,
    /// Largest change in length of the cell's bottom between the middles, a share: the rod has none.
    pub stretch: f64,
    /// Why some contact samples are missing, if they are.
    pub note: Option<String>,
}

/// Two chambers of a long actuator, cut in the middle of the gaps on either side, through the base only.
///
/// The cuts are planes of symmetry of a long row, so that clamping one of them takes little away. Cut at the chambers'
/// outer walls and clamped there, the cell bends 10 % less than a chamber within a row.
///
/// # Errors
/// Chambers that differ in a length or their pressure: nothing is repeated along the rod. Chambers without a gap.
pub fn cell_of(case: &Case) -> Result<Actuator, CellError> {
    let actuator = &case.actuator;
    let one = |key: &'static str, value: &PerChamber| {
        // Of a single chamber there may be a list without a gap.
        value.common().ok_or(if value.is_varied() { CellError::Differ { key } } else { CellError::NoGap })
    };
    if case.load.chamber_factor.as_ref().is_some_and(|factor| factor.common() != Some(1.0)) {
        return Err(CellError::OwnPressures);
    }
    let gap = one("gap", &actuator.gap)?;
    if gap == 0.0 {
        return Err(CellError::NoGap);
    }
    Ok(Actuator {
        chambers: 2,
        chamber_length: one("chamber_length", &actuator.chamber_length)?.into(),
        cavity_length: one("cavity_length", &actuator.cavity_length)?.into(),
        gap: gap.into(),
        flange: 0.5 * gap,
        side_wall: one("side_wall", &actuator.side_wall)?.into(),
        top_wall: one("top_wall", &actuator.top_wall)?.into(),
        ..actuator.clone()
    })
}

/// Takes the samples from the case's actuator.
///
/// # Errors
/// Lengths that make no body, chambers that differ or have no gap, or a state that is not reached.
pub fn sample(case: &Case, progress: &mut dyn FnMut(&str)) -> Result<Cell, CellError> {
    let cell = cell_of(case)?;
    let problem = Problem::from_actuator(
        &cell,
        &case.mesh.mesh_size(&case.actuator),
        case.mesh.formulation(),
        case.material.clone(),
        case.contact.clone(),
    )?;
    let gauge = Gauge::new(&cell);
    let mut samples = Samples::default();

    progress("cell without load");
    let free = free_states(&problem, &case.solver)?;
    let mut stretch: f64 = 0.0;
    for state in &free {
        let curvature = gauge.curvature(&problem, &state.displacement)?;
        if state.contact_points == 0 {
            samples.free.push(FreeSample { pressure_kpa: state.parameter.0, curvature });
        }
        stretch = stretch.max(gauge.stretch(&problem, &state.displacement).abs());
    }

    let held = problem_with_held_end(&problem);
    let bent: Vec<&ConvergedState> = free.iter().filter(|s| BENT_KPA.contains(&s.parameter.0)).collect();
    let mut path = Path::new(&held, &case.solver)?;
    for state in &bent {
        progress(&format!("cell at {} kPa: bending stiffness", state.parameter));
        let mut end = HeldEnd::follow(&mut path, &held, &problem, state)?;
        let stiffness = end.stiffness(&gauge)?;
        if end.state.contact_points == 0 {
            samples.stiffness.push(StiffnessSample { pressure_kpa: state.parameter.0, stiffness });
        }
    }
    let mut note = None;
    if case.contact.method != ContactMethod::None {
        for (i, state) in bent.iter().enumerate() {
            progress(&format!("cell at {} kPa: bent back until its chambers touch", state.parameter));
            if let Err(cause) = bend_back(&held, &problem, &bent[..=i], &case.solver, &gauge, &mut samples) {
                note = Some(cause.to_string());
            }
        }
    }
    if samples.touch.len() < 2 {
        // No line through one point: the fifth parameter stays unknown.
        samples.touch.clear();
        samples.contact.clear();
    }
    Ok(Cell { samples, stretch, note })
}

/// Equilibria of the cell under pressure alone.
fn free_states(problem: &Problem, settings: &Solver) -> Result<Vec<ConvergedState>, CellError> {
    let mut path = Path::new(problem, settings)?;
    FREE_KPA.iter().map(|&p| Ok(path.advance_to(p, &mut |_| ())?)).collect()
}

/// Turns the end upwards at the last of some pressures until the chambers touch, and a little further.
fn bend_back(
    held: &Problem,
    free_problem: &Problem,
    states: &[&ConvergedState],
    settings: &Solver,
    gauge: &Gauge,
    samples: &mut Samples,
) -> Result<(), CellError> {
    let mut path = Path::new(held, settings)?;
    let Some((last, before)) = states.split_last() else { return Ok(()) };
    // On the way the end follows the free one: with it held straight the cell would not bear the higher pressures.
    for state in before {
        HeldEnd::follow(&mut path, held, free_problem, state)?;
    }
    let mut end = HeldEnd::follow(&mut path, held, free_problem, last)?;
    let pressure_kpa = end.state.parameter.0;
    let mut stiffness = end.derivatives(gauge)?.0;
    // Curvature and least distance of the walls, from turn to turn.
    let mut gaps: Vec<[f64; 2]> = Vec::new();
    let mut in_contact = 0;
    for turn in 0..TURNS {
        if turn > 0 {
            let shifts = without_force(&stiffness, [0.0; 2], -TURN);
            let [x, z, angle] = end.motion;
            end.move_to([x + shifts[0], z + shifts[1], angle - TURN])?;
        }
        end.balance(&mut stiffness, gauge)?;
        let curvature = gauge.curvature(held, &end.state.displacement)?;
        if end.state.contact_points > 0 {
            if in_contact == 0
                && let Some(touch) = touch_curvature(&gaps, curvature)
            {
                samples.touch.push(TouchSample { pressure_kpa, curvature: touch });
            }
            samples.contact.push(ContactSample { pressure_kpa, curvature, moment: 2.0 * end.load[2] });
            in_contact += 1;
            if in_contact > TURNS_IN_CONTACT {
                return Ok(());
            }
        } else {
            let found = penetration::measure(held, &end.state.displacement)?;
            gaps.push([curvature, found.min_gap_mm().unwrap_or(f64::INFINITY)]);
        }
    }
    Err(CellError::NoContact { pressure_kpa, turn: TURN * TURNS as f64 })
}

/// The curvature at which the distance of the walls reaches zero, going on straight from the last two points, between
/// the last of them and `reached`, where they touch.
fn touch_curvature(gaps: &[[f64; 2]], reached: f64) -> Option<f64> {
    let [.., a, b] = gaps else { return gaps.last().map(|last| 0.5 * (last[0] + reached)) };
    let touch = b[0] - b[1] * (b[0] - a[0]) / (b[1] - a[1]);
    Some(if touch.is_finite() { touch.clamp(reached.min(b[0]), reached.max(b[0])) } else { 0.5 * (b[0] + reached) })
}
