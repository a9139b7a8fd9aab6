//! Rivlin's flexure: a block bent into a sector of a circular tube.

use std::f64::consts::FRAC_PI_2;

use pneuflex_mesh::lattice::Lattice;
use pneuflex_model::{Formulation, Material, Problem};

use crate::Effort;
use crate::body::{body, displacement, hold, last, material, near, prescribe};
use crate::row::Row;
use crate::yeoh::{integrate, slope};

/// See [`crate::Section::text`].
pub const TEXT: &str = "\
A block 0 ≤ X ≤ 2, 0 ≤ Y ≤ 6 mm, 1 mm wide in plane strain, is bent by a right angle: r² = 2X/β + r_i², θ = βY, z = Z with β = π/12 \
(Rivlin 1949, *Proc. R. Soc. A* 195). The end faces are moved as in the exact solution, in twelve steps; the long faces are free. The \
quantity is the moment about the z axis, N·mm. Exact for the incompressible material: with λ = βr and W(λ) = W(1/λ, λ, 1), \
dσ_r/dr = (σ_θ − σ_r)/r = W′ dλ/dr, so σ_r = W(λ) − W(λ_o); both long faces are free, hence λ_i λ_o = 1, which with r_o² − r_i² = 2H/β \
fixes the radii; and M = ∫ σ_θ r dr = ½ β⁻² ∫ λ² W′(λ) dλ from λ_i to λ_o. κ = 10⁴ MPa. \
Not in the table: on 16 × 48 cells the bent block of `hex8-q1p0` has a tangent with six negative pivots and is refused as unstable, where \
`hex8-sri` is stable (error −2.0·10⁻³); the compressed side at λ = 0.78 is far from a surface instability (0.54), so the pivots are an artefact of the \
element.";

const THICKNESS: f64 = 2.0;
const LENGTH: f64 = 6.0;
const STEPS: u32 = 12;

/// Rows of all elements.
pub fn rows(effort: Effort) -> Vec<Row> {
    effort
        .elements()
        .iter()
        .copied()
        .map(|element| {
            let order = match element {
                Formulation::Hex20 | Formulation::Hex27 => 4.0,
                Formulation::Tet15 | Formulation::Wedge21 => 3.0,
                _ => 2.0,
            };
            let meshes: [[usize; 2]; 3] =
                if element.is_second_order { [[1, 3], [2, 6], [4, 12]] } else { [[4, 12], [6, 18], [8, 24]] };
            Row::sequence(
                "moment",
                element,
                effort.of(&meshes),
                |mesh| (format!("{} × {}", mesh[0], mesh[1]), mesh[0] as f64),
                Some([order, if order > 2.0 { 3.0 } else { 1.8 }]),
                0.1,
                |mesh| {
                    let problem = block(element, material(1e4), *mesh);
                    Ok([moment(&problem)?, exact(&problem.material)])
                },
            )
        })
        .collect()
}

fn block(formulation: Formulation, material: Material, [across, along]: [usize; 2]) -> Problem {
    let lattice = Lattice::uniform([0.0; 3], [THICKNESS, LENGTH, 1.0], [across, along, 1]);
    let mut problem = body(lattice.mesh_all(formulation.element_kind()), formulation, material);
    hold(&mut problem, "ends", [true; 3], |x| near(x[1], 0.0) || near(x[1], LENGTH));
    hold(&mut problem, "plane strain", [false, false, true], |_| true);
    problem
}

/// Stretches of the inner and the outer face when the block is bent by `angle`.
fn stretches(angle: f64) -> [f64; 2] {
    // λ_o² − λ_i² = 2 H β and λ_i λ_o = 1.
    let difference = 2.0 * THICKNESS * angle / LENGTH;
    let outer = (0.5 * difference + (0.25 * difference * difference + 1.0).sqrt()).sqrt();
    [1.0 / outer, outer]
}

/// The exact deformed position, moved so that the middle of the face Y = 0 stays near its place.
fn bent([x, y, z]: [f64; 3], angle: f64) -> [f64; 3] {
    let beta = angle / LENGTH;
    let inner = stretches(angle)[0] / beta;
    let r = (2.0 * x / beta + inner * inner).sqrt();
    let (s, c) = (beta * y).sin_cos();
    [r * c - inner, r * s, z]
}

/// Moment about the centre of curvature on the end that is turned, N·mm.
fn moment(problem: &Problem) -> Result<f64, String> {
    let angle = |i: u32| FRAC_PI_2 * f64::from(i) / f64::from(STEPS);
    let stages = (1..=STEPS).map(|i| displacement(&problem.mesh, |x| bent(x, angle(i))));
    let state = last(prescribe(problem, stages)?)?;
    let centre = -stretches(FRAC_PI_2)[0] * LENGTH / FRAC_PI_2;
    let turned = problem.mesh.select_nodes(|x| near(x[1], LENGTH));
    let moment_of = |&node: &u32| {
        let (x, u, force) =
            (problem.mesh.nodes[node as usize], state.displacement[node as usize], state.reaction[node as usize]);
        (x[0] + u[0] - centre) * force[1] - (x[1] + u[1]) * force[0]
    };
    // Tension outside and compression inside bend the end as it is turned: the moment is negative about +z.
    Ok(turned.iter().map(moment_of).sum::<f64>().abs())
}

fn exact(m: &Material) -> f64 {
    let beta = FRAC_PI_2 / LENGTH;
    let [inner, outer] = stretches(FRAC_PI_2);
    // λ² dW/dλ = 2 W′ (λ³ − λ⁻¹).
    let integral = integrate(inner, outer, |l| 2.0 * slope(m, l * l + l.powi(-2) - 2.0) * (l.powi(3) - 1.0 / l));
    0.5 * integral / (beta * beta)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// M about the neutral fibre is E H³ κ / 12 with plane strain modulus 4 μ for small angles.
    #[test]
    fn small_moments_are_those_of_beam_theory() {
        let (m, angle) = (material(1e4), 1e-3);
        let beta = angle / LENGTH;
        let [inner, outer] = stretches(angle);
        let integral = integrate(inner, outer, |l| 2.0 * slope(&m, l * l + l.powi(-2) - 2.0) * (l.powi(3) - 1.0 / l));
        let beam = 4.0 * m.shear_modulus() * THICKNESS.powi(3) * beta / 12.0;
        assert!((0.5 * integral / (beta * beta) / beam - 1.0).abs() < 1e-3);
    }

    #[test]
    fn the_bent_block_keeps_its_volume() {
        let f = |x: [f64; 3]| -> [[f64; 3]; 3] {
            let mut f = [[0.0; 3]; 3];
            for k in 0..3 {
                let (mut low, mut high) = (x, x);
                low[k] -= 1e-5;
                high[k] += 1e-5;
                let (low, high) = (bent(low, 1.2), bent(high, 1.2));
                for i in 0..3 {
                    f[i][k] = (high[i] - low[i]) / 2e-5;
                }
            }
            f
        };
        assert!((pneuflex_mesh::mesh::determinant(&f([0.7, 2.5, 0.5])) - 1.0).abs() < 1e-8);
    }
}
