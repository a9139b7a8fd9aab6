//! A thick sphere beyond its greatest pressure.

use std::f64::consts::PI;

use pneuflex_model::load::{Control, Curve, Gas};
use pneuflex_model::{Clock, Formulation, Law, Material, Solver};
use pneuflex_newton::{Event, follow_path};

use crate::Effort;
use crate::body::material;
use crate::row::Row;
use crate::sphere::{RADII, pressure, sphere};

/// See [`crate::Section::text`].
pub const TEXT: &str = "\
The eighth of the thick sphere above, of neo-Hookean material (C₂₀ = C₃₀ = 0, κ = 10⁴ MPa), whose pressure has a maximum at an inner stretch of \
1.6: beyond it no pressure control can go. An incompressible liquid is pumped in until the inner surface is stretched to 1.4, 1.8 \
and 2.5; then gas, sealed in at the atmosphere's 0.1 MPa and pumped up at constant temperature (n = 1) or without exchange of heat (n = 1.4). \
The quantity is the pressure of the cavity above the atmosphere's, MPa. Exact: p(a) as above; for gas it is p(a) = p₀ (m (A/a)³ⁿ − 1) at the \
given amount m.";

const STRETCHES: [f64; 3] = [1.4, 1.8, 2.5];
const ATMOSPHERE: f64 = 0.1;
/// The last amount of gas, relative to what fills the cavity at rest.
const AMOUNT: f64 = 20.0;

/// Rows of some elements.
pub fn rows(effort: Effort) -> Vec<Row> {
    let mut rows = Vec::new();
    for (element, meshes, order) in [
        (Formulation::Hex8Q1p0, [[2, 2], [4, 4], [8, 8]], [2.0, 1.7]),
        (Formulation::Hex27, [[1, 1], [2, 2], [4, 4]], [4.0, 2.0]),
    ] {
        let mut row = |quantity: String, find: &dyn Fn([usize; 2]) -> Result<[f64; 2], String>| {
            let describe = |mesh: &[usize; 2]| (format!("3 × {}² × {}", mesh[0], mesh[1]), mesh[0] as f64);
            rows.push(Row::sequence(quantity, element, effort.of(&meshes), describe, Some(order), 0.1, |m| find(*m)));
        };
        for stretch in STRETCHES {
            row(format!("pressure of a liquid at a stretch of {stretch}"), &|mesh| liquid(element, mesh, stretch));
        }
        for exponent in [1.0, 1.4] {
            row(format!("pressure of {AMOUNT} fillings of gas, n = {exponent}"), &|mesh| gas(element, mesh, exponent));
        }
    }
    rows
}

fn neo_hookean() -> Material {
    let c10 = 0.5 * material(1e4).shear_modulus();
    Material { law: Law::Yeoh { c10, c20: 0.0, c30: 0.0 }, ..material(1e4) }
}

/// Measured and exact pressure, MPa.
fn liquid(formulation: Formulation, cells: [usize; 2], stretch: f64) -> Result<[f64; 2], String> {
    let eighth = PI / 6.0 * RADII[0].powi(3);
    let change = eighth * (stretch.powi(3) - 1.0);
    let found = follow(formulation, cells, Control::Volume(Curve::Proportional(change)))?;
    Ok([found, pressure(&neo_hookean(), (stretch - 1.0) * RADII[0])])
}

/// Measured and exact pressure, MPa.
fn gas(formulation: Formulation, cells: [usize; 2], exponent: f64) -> Result<[f64; 2], String> {
    let amount = Curve::Table(vec![[0.0, 1.0], [1.0, AMOUNT]]);
    let found = follow(formulation, cells, Control::Gas(Gas { atmosphere: ATMOSPHERE, exponent, amount }))?;
    let of_gas = |stretch: f64| ATMOSPHERE * (AMOUNT * stretch.powf(-3.0 * exponent) - 1.0);
    let of_wall = |stretch: f64| pressure(&neo_hookean(), (stretch - 1.0) * RADII[0]);
    // The gas's pressure falls with the stretch; the wall's rises, then falls more slowly.
    let (mut low, mut high) = (1.0, 10.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if of_gas(middle) > of_wall(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok([found, of_gas(low)])
}

/// Pressure in the cavity at time 1, MPa.
fn follow(formulation: Formulation, cells: [usize; 2], control: Control) -> Result<f64, String> {
    let mut problem = sphere(formulation, neo_hookean(), cells);
    problem.cavities[0].control = control;
    problem.clock = Clock::Steps;
    let settings = Solver { first_step: 0.05, max_step: 0.2, min_step: 1e-4, ..Solver::default() };
    let mut found = None;
    let mut observer = |event: Event<'_>| {
        if let Event::Landed(state) = event {
            found = Some(state.cavity_pressures[0]);
        }
    };
    follow_path(&problem, &[1.0], &settings, &mut observer).map_err(|ended| ended.0.to_string())?;
    found.ok_or_else(|| "no state".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pressure_has_its_maximum_between_the_stretches() {
        let at = |stretch: f64| pressure(&neo_hookean(), (stretch - 1.0) * RADII[0]);
        assert!(at(STRETCHES[0]) < at(1.6) && at(STRETCHES[1]) < at(1.6), "{} {} {}", at(1.55), at(1.6), at(1.65));
    }
}
