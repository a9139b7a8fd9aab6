//! A thick sphere beyond its greatest pressure.

use std::f64::consts::PI;

use pneuflex_model::load::{Control, Curve, Gas};
use pneuflex_model::{Clock, Formulation, Law, Material, Solver};
use pneuflex_newton::{Event, follow_path};

use crate::Effort;
use crate::body::material;
use crate::row::Row;
use crate::sphere::{RADII, pressure, sphere};
use crate::yeoh::{first_piola_kirchhoff, root};

/// See [`crate::Section::text`].
pub const TEXT: &str = "\
The eighth of the thick sphere above, of neo-Hookean material (C₂₀ = C₃₀ = 0, κ = 10⁴ MPa), whose pressure has a maximum at an inner stretch of \
1.6: beyond it no pressure control can go. An incompressible liquid is pumped in until the inner surface is stretched to 1.4, 1.8 \
and 2.5; then gas, sealed in at the atmosphere's 0.1 MPa and pumped up at constant temperature (n = 1) or without exchange of heat (n = 1.4). \
The quantity is the pressure of the cavity above the atmosphere's, MPa. Exact: p(a) of the compressible wall, which differs from the \
incompressible one by 10⁻⁴: with P_R and P_θ of the stretches dr/dR and r/R, dP_R/dR = 2 (P_θ − P_R)/R is integrated from A, where \
p = −P_R (A/a)², to B, where P_R = 0 (Runge-Kutta of fourth order, by shooting). For gas, p(a) = p₀ (m (A/a)³ⁿ − 1) at the given amount m.";

/// Bulk modulus, MPa.
const KAPPA: f64 = 1e4;
const STRETCHES: [f64; 3] = [1.4, 1.8, 2.5];
const ATMOSPHERE: f64 = 0.1;
/// The last amount of gas, relative to what fills the cavity at rest.
const AMOUNT: f64 = 10.0;

/// Rows of some elements.
pub fn rows(effort: Effort) -> Vec<Row> {
    let mut rows = Vec::new();
    let gases = [1.0, 1.4].map(|exponent| (exponent, pressure_of_gas(exponent)));
    for (element, meshes, order) in [
        (Formulation::Hex8Q1p0, [[2, 2], [4, 4], [8, 8]], [2.0, 1.7]),
        (Formulation::Hex27, [[1, 1], [2, 2], [4, 4]], [4.0, 3.0]),
    ] {
        let mut row = |quantity: String, find: &dyn Fn([usize; 2]) -> Result<[f64; 2], String>| {
            let describe = |mesh: &[usize; 2]| (format!("3 × {}² × {}", mesh[0], mesh[1]), mesh[0] as f64);
            rows.push(Row::sequence(quantity, element, effort.of(&meshes), describe, Some(order), 0.1, |m| find(*m)));
        };
        for stretch in STRETCHES {
            row(format!("pressure of a liquid at a stretch of {stretch}"), &|mesh| liquid(element, mesh, stretch));
        }
        for (exponent, exact) in gases {
            let quantity = format!("pressure of {AMOUNT} fillings of gas, n = {exponent}");
            row(quantity, &|mesh| Ok([gas(element, mesh, exponent)?, exact]));
        }
    }
    rows
}

fn neo_hookean() -> Material {
    let c10 = 0.5 * material(KAPPA).shear_modulus();
    Material { law: Law::Yeoh { c10, c20: 0.0, c30: 0.0 }, ..material(KAPPA) }
}

/// Measured and exact pressure, MPa.
fn liquid(formulation: Formulation, cells: [usize; 2], stretch: f64) -> Result<[f64; 2], String> {
    let eighth = PI / 6.0 * RADII[0].powi(3);
    let change = eighth * (stretch.powi(3) - 1.0);
    let found = follow(formulation, neo_hookean(), cells, Control::Volume(Curve::Proportional(change)))?;
    Ok([found, wall_pressure(&neo_hookean(), stretch)])
}

/// Measured pressure, MPa.
fn gas(formulation: Formulation, cells: [usize; 2], exponent: f64) -> Result<f64, String> {
    let amount = Curve::Table(vec![[0.0, 1.0], [1.0, AMOUNT]]);
    follow(formulation, neo_hookean(), cells, Control::Gas(Gas { atmosphere: ATMOSPHERE, exponent, amount }))
}

/// Exact pressure of the gas, MPa: its own falls with the stretch; the wall's rises, then falls more slowly.
fn pressure_of_gas(exponent: f64) -> f64 {
    let of_gas = |stretch: f64| ATMOSPHERE * (AMOUNT * stretch.powf(-3.0 * exponent) - 1.0);
    of_gas(root(1.0, 10.0, |stretch| wall_pressure(&neo_hookean(), stretch) - of_gas(stretch)))
}

/// Pressure, MPa, at which the compressible sphere's inner surface has the stretch.
fn wall_pressure(m: &Material, stretch: f64) -> f64 {
    let [inner, outer] = RADII;
    // By the secant method, from the pressure on the incompressible sphere.
    let outside = |pressure: f64| stress_outside(m, stretch * inner, -pressure * stretch * stretch);
    let mut p = [0.99, 1.0].map(|share| share * pressure(m, (stretch - 1.0) * inner) + 1e-6 * (share - 1.0));
    let mut t = p.map(outside);
    for _ in 0..20 {
        if t[1] == t[0] {
            break;
        }
        let next = p[1] - t[1] * (p[1] - p[0]) / (t[1] - t[0]);
        (p, t) = ([p[1], next], [t[1], outside(next)]);
        if t[1].abs() < 1e-13 * outer {
            break;
        }
    }
    p[1]
}

/// P_R at the outer surface, MPa, with radius r, mm, and P_R at the inner one.
fn stress_outside(m: &Material, radius: f64, stress: f64) -> f64 {
    const INTERVALS: usize = 64;
    let [inner, outer] = RADII;
    let h = (outer - inner) / INTERVALS as f64;
    let mut y = [radius, stress];
    for i in 0..INTERVALS {
        let at = inner + h * i as f64;
        let step = |k: [f64; 2], part: f64| [y[0] + part * h * k[0], y[1] + part * h * k[1]];
        let k1 = equilibrium(m, at, y);
        let k2 = equilibrium(m, at + 0.5 * h, step(k1, 0.5));
        let k3 = equilibrium(m, at + 0.5 * h, step(k2, 0.5));
        let k4 = equilibrium(m, at + h, step(k3, 1.0));
        y = std::array::from_fn(|j| y[j] + h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]));
    }
    y[1]
}

/// d(r, P_R)/dR at the radius `at` of the body at rest.
fn equilibrium(m: &Material, at: f64, [radius, stress]: [f64; 2]) -> [f64; 2] {
    let around = radius / at;
    let stresses = |radial: f64| {
        let p = first_piola_kirchhoff(m, &[[radial, 0.0, 0.0], [0.0, around, 0.0], [0.0, 0.0, around]]);
        [p[0][0], p[1][1]]
    };
    // The radial stretch that goes with P_R, by Newton's method from the incompressible one.
    let mut radial = around.powi(-2);
    for _ in 0..8 {
        let slope = (stresses(radial + 1e-6)[0] - stresses(radial - 1e-6)[0]) / 2e-6;
        let correction = (stresses(radial)[0] - stress) / slope;
        radial -= correction;
        // The bulk modulus is so much larger than all stresses that nothing better can be had.
        if correction.abs() < 1e-14 * radial {
            break;
        }
    }
    [radial, 2.0 * (stresses(radial)[1] - stress) / at]
}

/// Pressure in the cavity at time 1, MPa.
fn follow(formulation: Formulation, material: Material, cells: [usize; 2], control: Control) -> Result<f64, String> {
    let mut problem = sphere(formulation, material, cells);
    problem.cavities[0].control = control;
    problem.clock = Clock::Steps;
    let settings = Solver { first_step: 0.05, max_step: 0.2, min_step: 1e-4, ..Solver::default() };
    let mut found = None;
    let mut observer = |event: Event<'_>| {
        if let Event::Converged(state) = event {
            found = Some(state.cavity_pressures[0].mpa());
        }
    };
    follow_path(&problem, &[1.0], &settings, &mut observer).map_err(|ended| ended.0.to_string())?;
    found.ok_or_else(|| "no state".into())
}

#[cfg(test)]
mod tests {
    use pneuflex_model::{Continuation, StateKind};

    use super::*;

    #[test]
    fn a_wall_that_hardly_compresses_is_the_incompressible_one() {
        let stiff = Material { bulk_modulus: 1e7, ..neo_hookean() };
        for stretch in [1.0, 1.4, 2.5] {
            let incompressible = pressure(&stiff, (stretch - 1.0) * RADII[0]);
            assert!((wall_pressure(&stiff, stretch) - incompressible).abs() < 1e-7, "{stretch}");
            let soft = wall_pressure(&neo_hookean(), stretch) / incompressible - 1.0;
            assert!(stretch == 1.0 || (1e-5..2e-4).contains(&-soft), "{stretch}: {soft}");
        }
    }

    /// Two million times as stiff in volume as in shear: states on the way must not be left with the volumes that an inexact step may have.
    #[test]
    fn a_hardly_compressible_balloon_is_pumped_up() {
        let stiff = Material { bulk_modulus: 1e6, ..neo_hookean() };
        let change = PI / 6.0 * RADII[0].powi(3) * (1.8_f64.powi(3) - 1.0);
        let control = Control::Volume(Curve::Proportional(change));
        let found = follow(Formulation::Hex27, stiff.clone(), [2, 2], control).unwrap();
        assert!((found / wall_pressure(&stiff, 1.8) - 1.0).abs() < 1e-5, "{found}");
    }

    /// By its arc length the path goes past the greatest pressure, and comes down along the curve of the sphere.
    #[test]
    fn the_falling_branch_is_that_of_the_sphere() {
        let mut problem = sphere(Formulation::Hex27, neo_hookean(), [2, 2]);
        problem.cavities[0].control = Control::Pressure(Curve::Proportional(0.001));
        problem.clock = Clock::Pressure;
        let (node, _) = problem.mesh.nearest_node([RADII[0], 0.0, 0.0]).unwrap();
        let greatest = (1..200).map(|i| wall_pressure(&neo_hookean(), 1.0 + 0.005 * f64::from(i))).fold(0.0, f64::max);
        let settings = Solver {
            first_step: 5.0,
            max_step: 1000.0 * greatest,
            min_step: 0.01,
            continuation: Continuation::ArcLength,
            states_past_limit: 12,
            ..Solver::default()
        };
        let requested = [400.0, 900.0, 1100.0].map(|share| share * greatest);
        let (mut states, mut limit) = (Vec::new(), None);
        let report = follow_path(&problem, &requested, &settings, &mut |event| {
            if let Event::Converged(state) = event {
                let stretch = 1.0 + state.displacement[node][0] / RADII[0];
                states.push((state.kind, stretch, state.cavity_pressures[0].mpa(), state.negative_pivots));
                limit = limit.or((state.kind == StateKind::GreatestLoad).then_some(state.parameter.0));
            }
        });
        println!("{} iterations, limit {limit:?} kPa of {}", report.unwrap().iterations, 1e3 * greatest);
        for &(kind, stretch, found, unstable) in &states {
            let exact = wall_pressure(&neo_hookean(), stretch);
            println!("{kind:?} {stretch:.4}: {found:.7} {exact:.7}, {unstable}");
            assert!((found / exact - 1.0).abs() < 2e-3, "{stretch}: {found} {exact}");
            assert!(kind != StateKind::PastLimit || unstable == 1, "{stretch}: {unstable}");
        }
        assert!((limit.unwrap() / (1e3 * greatest) - 1.0).abs() < 1e-3);
        let kinds: Vec<StateKind> = states.iter().map(|state| state.0).collect();
        assert_eq!(kinds[..3], [StateKind::Requested, StateKind::Requested, StateKind::GreatestLoad]);
        assert_eq!(kinds.len(), 2 + 12);
        assert!(states.last().unwrap().1 > 2.5, "{states:?}");
    }

    /// A wall that stiffens has a second branch: beyond the greatest pressure of the first one the balloon snaps to it.
    #[test]
    fn a_stiffening_balloon_snaps_to_its_second_branch() {
        let Law::Yeoh { c10, .. } = neo_hookean().law else { unreachable!() };
        let stiffening = Material { law: Law::Yeoh { c10, c20: 0.0, c30: 1e-3 * c10 }, ..neo_hookean() };
        let greatest = (1..90).map(|i| wall_pressure(&stiffening, 1.0 + 0.01 * f64::from(i))).fold(0.0, f64::max);
        let wanted = 1.05 * greatest;
        let (mut low, mut high) = (1.0 + 1.0, 4.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if wall_pressure(&stiffening, middle) < wanted { low = middle } else { high = middle }
        }
        assert!(
            (1..20).any(|i| wall_pressure(&stiffening, 1.6 + 0.1 * f64::from(i)) < 0.97 * greatest),
            "no limit point"
        );
        let mut problem = sphere(Formulation::Hex27, stiffening.clone(), [2, 2]);
        problem.cavities[0].control = Control::Pressure(Curve::Proportional(0.001));
        problem.clock = Clock::Pressure;
        let (node, _) = problem.mesh.nearest_node([RADII[0], 0.0, 0.0]).unwrap();
        let settings = Solver {
            first_step: 5.0,
            max_step: 1000.0 * greatest,
            min_step: 0.01,
            continuation: Continuation::Damped,
            ..Solver::default()
        };
        let (mut states, requested) = (Vec::new(), [900.0 * greatest, 1000.0 * wanted]);
        follow_path(&problem, &requested, &settings, &mut |event| {
            if let Event::Converged(state) = event {
                states.push((1.0 + state.displacement[node][0] / RADII[0], state.negative_pivots, state.snaps.clone()));
            }
        })
        .unwrap_or_else(|ended| panic!("{}", ended.0));
        println!("{states:?}, {low} in closed form");
        let [(_, _, before), (stretch, unstable, snaps)] = &states[..] else { panic!("{states:?}") };
        assert!(before.is_empty() && *unstable == 0);
        assert!((stretch / low - 1.0).abs() < 2e-3, "{stretch} {low}");
        assert_eq!(snaps.len(), 1);
        // The energy given up: what the given pressure does on the growing volume of the eighth, less what the wall asks for.
        let given = 1e-3 * snaps[0].to.0;
        let grid = (1..=50).map(|i| 1.0 + 0.02 * f64::from(i)).map(|a| (wall_pressure(&stiffening, a), a));
        let (_, from) = grid.fold((0.0, 1.0), |best, now| if now.0 > best.0 { now } else { best });
        let to = root(from + 0.5, 4.0, |a| wall_pressure(&stiffening, a) - given);
        let spare =
            |a: f64| (given - wall_pressure(&stiffening, a)) * 0.5 * std::f64::consts::PI * RADII[0].powi(3) * a * a;
        let width = (to - from) / 50.0;
        let expected: f64 = (0..50).map(|i| width * spare(from + width * (f64::from(i) + 0.5))).sum();
        let released = snaps[0].released.unwrap();
        assert!((released / expected - 1.0).abs() < 5e-3, "{released} {expected}");
        assert!(
            (snaps[0].from.0 / (1e3 * greatest) - 1.0).abs() < 2e-3 && snaps[0].moved > 0.5 * RADII[0],
            "{snaps:?}"
        );
    }

    #[test]
    fn the_pressure_has_its_maximum_between_the_stretches() {
        let at = |stretch: f64| pressure(&neo_hookean(), (stretch - 1.0) * RADII[0]);
        assert!(at(STRETCHES[0]) < at(1.6) && at(STRETCHES[1]) < at(1.6), "{} {} {}", at(1.55), at(1.6), at(1.65));
    }
}
