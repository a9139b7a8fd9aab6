//! A cube in homogeneous states: uniaxial, equibiaxial, pure shear.

use pneuflex_mesh::lattice::Lattice;
use pneuflex_model::{Formulation, Invariant, Material, Problem};

use crate::Effort;
use crate::body::{body, displacement, hold, last, material, near, prescribe};
use crate::row::Row;
use crate::yeoh::{root, slope};

/// See [`crate::Section::text`].
pub const TEXT: &str = "\
A unit cube of 2 × 1 × 1 cells on three symmetry planes is stretched to 1.5, 2 and 3; the quantity is the nominal stress along x, \
in MPa. Exact for the incompressible material (κ = 10⁴ MPa here): with the stretches λ₁ and λ₂ and λ₃ = 1/(λ₁ λ₂), \
P₁ = 2 W′(I₁) (λ₁ − λ₃²/λ₁) (Rivlin 1948; Holzapfel 2000, *Nonlinear Solid Mechanics*, §6.5). The bound is what compressibility may \
change. *Bar, κ = 1000 MPa* is exact for the compressible law: the transverse stretch is the one with no transverse stress. Every \
element must reproduce homogeneous states to rounding.";

/// Stretch along y as a function of that along x.
type Transverse = fn(f64) -> f64;

const STATES: [(&str, [bool; 3], Transverse); 3] = [
    ("uniaxial", [true, false, false], |stretch| 1.0 / stretch.sqrt()),
    ("equibiaxial", [true, true, false], |stretch| stretch),
    ("pure shear", [true, true, false], |_| 1.0),
];

/// Rows of all elements.
pub fn rows(_: Effort) -> Vec<Row> {
    let mut rows = Vec::new();
    for element in crate::ELEMENTS {
        for (name, stretched, transverse) in STATES {
            for stretch in [1.5, 2.0, 3.0] {
                let material = material(1e4);
                let (l2, l3) = (transverse(stretch), 1.0 / (stretch * transverse(stretch)));
                let e = stretch * stretch + l2 * l2 + l3 * l3 - 3.0;
                let exact = 2.0 * slope(&material, e) * (stretch - l3 * l3 / stretch);
                let problem = cube(element, material, stretched);
                rows.push(row(format!("{name}, stretch {stretch}"), element, 2e-3, || {
                    Ok([nominal_stress(&problem, transverse, stretch)?, exact])
                }));
            }
        }
        for invariant in [Invariant::Full, Invariant::Isochoric] {
            let material = Material { invariant, ..material(1000.0) };
            let exact = bar_stress(&material, 3.0);
            let problem = cube(element, material, [true, false, false]);
            let name = format!("bar, κ = 1000 MPa, {invariant:?} invariant, stretch 3").to_lowercase();
            rows.push(row(name.replace("mpa", "MPa"), element, 1e-9, || {
                Ok([nominal_stress(&problem, |_| 1.0, 3.0)?, exact])
            }));
        }
    }
    rows
}

fn row(quantity: String, element: Formulation, bound: f64, solve: impl Fn() -> Result<[f64; 2], String>) -> Row {
    Row::sequence(quantity, element, &[()], |_| ("2 × 1 × 1".into(), 1.0), None, bound, |_| solve())
}

/// A unit cube with its faces at x = 0, y = 0, z = 0 on symmetry planes; where `stretched`, the opposite face moves, too.
fn cube(formulation: Formulation, material: Material, stretched: [bool; 3]) -> Problem {
    let mesh = Lattice::uniform([0.0; 3], [1.0; 3], [2, 1, 1]).mesh_all(formulation.element_kind());
    let mut problem = body(mesh, formulation, material);
    for axis in 0..3 {
        let axes = std::array::from_fn(|k| k == axis);
        hold(&mut problem, "plane", axes, |x| near(x[axis], 0.0) || (stretched[axis] && near(x[axis], 1.0)));
    }
    problem
}

/// Force on the face x = 1, N, that is nominal stress, MPa; in steps of a quarter.
fn nominal_stress(problem: &Problem, transverse: Transverse, stretch: f64) -> Result<f64, String> {
    let steps = ((stretch - 1.0) / 0.25).round() as u32;
    let stages = (1..=steps).map(|i| {
        let now = 1.0 + (stretch - 1.0) * f64::from(i) / f64::from(steps);
        // Where the opposite face is free, the displacement along y is not used.
        displacement(&problem.mesh, |[x, y, z]| [now * x, transverse(now) * y, z])
    });
    let state = last(prescribe(problem, stages)?)?;
    Ok(problem.mesh.select_nodes(|x| near(x[0], 1.0)).iter().map(|&node| state.reaction[node as usize][0]).sum())
}

/// Nominal stress of a bar of the compressible material, MPa.
pub(crate) fn bar_stress(m: &Material, stretch: f64) -> f64 {
    // P along an axis with stretch a, the others having b and c.
    let stress = |a: f64, b: f64, c: f64| {
        crate::yeoh::first_piola_kirchhoff(m, &[[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]])[0][0]
    };
    let thin = root(0.9 / stretch.sqrt(), 1.1 / stretch.sqrt(), |t| stress(t, t, stretch));
    stress(stretch, thin, thin)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Theory §9.
    #[test]
    fn stresses_are_those_of_the_theory() {
        let m = material(1e9);
        for (stretch, expected) in [(1.5, 0.646_863), (2.0, 1.359_765), (3.0, 3.609_724)] {
            assert!((bar_stress(&m, stretch) - expected).abs() < 1e-6);
        }
    }
}
