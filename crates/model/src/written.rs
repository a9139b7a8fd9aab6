//! The case file as it is written: keys whose defaults follow from other keys are optional here.

use pneuflex_mesh::Actuator;
use serde::Deserialize;

use crate::case::{Case, Contact, ContactMethod, Load, MeshOptions, Output, Probe, Solver};
use crate::material::Material;
use crate::obstacle_table::ObstacleTable;

/// [`Case`] with such keys left open.
#[derive(Deserialize)]
#[serde(rename = "Case", deny_unknown_fields)]
pub struct Written {
    #[serde(default)]
    title: String,
    actuator: Actuator,
    #[serde(default)]
    mesh: MeshOptions,
    #[serde(default)]
    material: Material,
    #[serde(default)]
    contact: WrittenContact,
    #[serde(default, rename = "obstacle")]
    obstacles: Vec<ObstacleTable>,
    load: Load,
    #[serde(default, rename = "probe")]
    probes: Vec<Probe>,
    #[serde(default)]
    solver: WrittenSolver,
    #[serde(default)]
    output: Output,
}

#[derive(Deserialize)]
#[serde(rename = "Contact", deny_unknown_fields, default)]
struct WrittenContact {
    method: ContactMethod,
    stiffness: Option<f64>,
    two_pass: bool,
    self_contact: bool,
    penetration_tolerance: Option<f64>,
}

#[derive(Deserialize)]
#[serde(rename = "Solver", deny_unknown_fields, default)]
struct WrittenSolver {
    tolerance: f64,
    residual_tolerance: f64,
    max_iterations: usize,
    first_step_kpa: f64,
    max_step_kpa: f64,
    min_step_kpa: Option<f64>,
}

impl Default for WrittenSolver {
    fn default() -> Self {
        let Solver { tolerance, residual_tolerance, max_iterations, first_step, max_step, .. } = Solver::default();
        Self {
            tolerance,
            residual_tolerance,
            max_iterations,
            first_step_kpa: first_step,
            max_step_kpa: max_step,
            min_step_kpa: None,
        }
    }
}

impl Default for WrittenContact {
    fn default() -> Self {
        let Contact { method, two_pass, self_contact, penetration_tolerance, .. } = Contact::default();
        Self { method, stiffness: None, two_pass, self_contact, penetration_tolerance }
    }
}

impl From<Written> for Case {
    fn from(written: Written) -> Self {
        let Written { title, actuator, mesh, material, contact, mut obstacles, load, probes, solver, output } = written;
        let stiffness = contact.stiffness.unwrap_or_else(|| default_stiffness(material.shear_modulus(), &actuator));
        let min_step = solver.min_step_kpa.unwrap_or_else(|| default_min_step(&load, solver.max_step_kpa));
        let WrittenSolver { tolerance, residual_tolerance, max_iterations, first_step_kpa, max_step_kpa, .. } = solver;
        let (first_step, max_step) = (first_step_kpa, max_step_kpa);
        let solver = Solver { tolerance, residual_tolerance, max_iterations, first_step, max_step, min_step };
        for obstacle in &mut obstacles {
            obstacle.stiffness.get_or_insert(stiffness);
            obstacle.faces.get_or_insert_with(|| "outer".into());
        }
        let WrittenContact { method, two_pass, self_contact, penetration_tolerance, .. } = contact;
        Self {
            title,
            mesh,
            material,
            contact: Contact { method, stiffness, two_pass, self_contact, penetration_tolerance },
            actuator,
            obstacles,
            load,
            probes,
            solver,
            output,
        }
    }
}

/// Penalty stiffness, N/mm³: the paper's 4 for its material and walls of 1 mm, in proportion to the shear modulus over the thinnest
/// wall's thickness. Walls pressed together by the air then sink into each other by the same share of their thickness.
fn default_stiffness(shear_modulus: f64, actuator: &Actuator) -> f64 {
    let (paper, wall) = (Contact::default().stiffness, actuator.thinnest_wall());
    if !(shear_modulus > 0.0 && shear_modulus.is_finite() && wall > 0.0) {
        return paper;
    }
    let half = 0.5 * Material::default().shear_modulus();
    rounded(paper * (0.5 * shear_modulus) / half / wall)
}

/// Smallest load step, kPa: small beside the pressures of soft materials, too.
fn default_min_step(load: &Load, max_step_kpa: f64) -> f64 {
    let last = load.pressure_kpa.iter().copied().fold(0.0, f64::max);
    let default = Solver::default().min_step;
    let small = if last > 0.0 && last.is_finite() { rounded(last / 5000.0).min(default) } else { default };
    if max_step_kpa > 0.0 { small.min(max_step_kpa) } else { small }
}

/// To twelve digits: the paper's constants give the paper's numbers, not their neighbours.
pub(crate) fn rounded(value: f64) -> f64 {
    if !value.is_finite() || value == 0.0 {
        return value;
    }
    let unit = 10f64.powf(11.0 - value.abs().log10().floor());
    let rounded = (value * unit).round() / unit;
    if rounded.is_finite() { rounded } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_material_gives_the_papers_numbers_and_others_scale() {
        assert_eq!(default_stiffness(0.5424, &Actuator::full()), 4.0);
        let thick = Actuator { top_wall: 2.0, side_wall: 2.0, cavity_length: 4.0, ..Actuator::full() };
        assert_eq!(default_stiffness(1.0848, &thick), 4.0);
    }
}
