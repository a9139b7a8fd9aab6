//! Torsion of a solid cylinder.

use pneuflex_mesh::ReferenceBody;
use pneuflex_mesh::lattice::Lattice;
use pneuflex_model::{Formulation, Material, Problem};

use crate::Effort;
use crate::body::{body, displacement, hold, last, material, near, prescribe};
use crate::row::Row;
use crate::yeoh::{integrate, slope};

/// See [`crate::Section::text`].
pub const TEXT: &str = "\
A cylinder of radius 5 mm and length 1 mm whose ends are turned against each other as in the exact solution, 0.05 and 0.2 rad/mm; the \
quantities are the torque, N·mm, and the axial force, N. Exact for the incompressible material: T = 4π ψ ∫ r³ W′ dr, \
N = −2π ψ² ∫ r³ W′ dr, I₁ − 3 = ψ² r² (Rivlin 1949; Holzapfel 2000, §6.6). κ = 10⁴ MPa. Layers that turn by an angle φ lose φ²/12 of their \
volume unless they widen, which the held ends do not let the outermost ones do: the axial force converges from further away, and on \
the coarsest mesh its error may have the other sign, so its sequence begins with the second mesh.";

const RADIUS: f64 = 5.0;

/// Rows of all elements.
pub fn rows(effort: Effort) -> Vec<Row> {
    let mut rows = Vec::new();
    for &element in effort.elements() {
        // Cells across and along.
        let meshes: [[usize; 2]; 3] = match element {
            _ if element.is_second_order => [[2, 1], [4, 2], [6, 3]],
            _ => [[4, 2], [8, 4], [12, 6]],
        };
        let order = match element {
            Formulation::Hex20 | Formulation::Hex27 | Formulation::Tet15 | Formulation::Wedge21 => 3.0,
            _ => 2.0,
        };
        let least = match element {
            // Serendipity functions are not complete on curved elements (Arnold, Boffi & Falk 2002, *Math. Comp.* 71).
            Formulation::Hex20 => 2.9,
            Formulation::Hex27 => 3.0,
            Formulation::Tet15 | Formulation::Wedge21 => 2.8,
            _ => 1.9,
        };
        let describe = |mesh: &[usize; 2]| (format!("{} × {}", mesh[0], mesh[1]), mesh[0] as f64);
        for twist in [0.05, 0.2] {
            let solve = |mesh: &[usize; 2], which: usize| -> Result<[f64; 2], String> {
                let problem = cylinder(element, material(1e4), *mesh);
                Ok([torque_and_force(&problem, twist)?[which], exact(&problem.material, twist)[which]])
            };
            let torque = effort.of(&meshes);
            for (which, quantity, meshes) in [(0, "torque", torque), (1, "axial force", &torque[1..])] {
                let name = format!("{quantity} at {twist} rad/mm");
                let orders = Some([order, least]);
                rows.push(Row::sequence(name, element, meshes, describe, orders, 0.1, |mesh| solve(mesh, which)));
            }
        }
    }
    rows
}

/// A lattice over a square, mapped onto the disc. Both ends are held.
fn cylinder(formulation: Formulation, material: Material, [across, layers]: [usize; 2]) -> Problem {
    let lattice = Lattice::uniform([-1.0, -1.0, 0.0], [1.0; 3], [across, across, layers]);
    let mesh = lattice
        .mesh_all(formulation.element_kind())
        .map_nodes(|[x, y, z]| [RADIUS * x * (1.0 - 0.5 * y * y).sqrt(), RADIUS * y * (1.0 - 0.5 * x * x).sqrt(), z]);
    let mut problem = body(mesh, formulation, material);
    hold(&mut problem, "ends", [true; 3], |x| near(x[2], 0.0) || near(x[2], 1.0));
    problem
}

/// Torque, N·mm, and axial force, N, on the upper end.
fn torque_and_force(problem: &Problem, twist: f64) -> Result<[f64; 2], String> {
    // Tetrahedra are flat at the four corners of the lattice, where they turn over in larger steps.
    let is_flat = problem.mesh.kind_of(0).body == ReferenceBody::Tetrahedron;
    let step = if is_flat { 0.0125 } else { 0.05 };
    let steps = (twist / step).round() as u32;
    let stages = (1..=steps).map(|i| {
        displacement(&problem.mesh, |[x, y, z]| {
            let (s, c) = (step * f64::from(i) * z).sin_cos();
            [c * x - s * y, s * x + c * y, z]
        })
    });
    let state = last(prescribe(problem, stages)?)?;
    let mut sums = [0.0; 2];
    for node in problem.mesh.select_nodes(|x| near(x[2], 1.0)) {
        let (u, force) = (state.displacement[node as usize], state.reaction[node as usize]);
        let [x, y]: [f64; 2] = std::array::from_fn(|k| problem.mesh.nodes[node as usize][k] + u[k]);
        sums[0] += x * force[1] - y * force[0];
        sums[1] += force[2];
    }
    Ok(sums)
}

fn exact(m: &Material, twist: f64) -> [f64; 2] {
    let integral = integrate(0.0, RADIUS, |r| r.powi(3) * slope(m, (twist * r).powi(2)));
    let pi = std::f64::consts::PI;
    [4.0 * pi * twist * integral, -2.0 * pi * twist * twist * integral]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Theory §9.
    #[test]
    fn torques_and_forces_are_those_of_the_theory() {
        for (twist, expected) in [(0.05, [26.8745, -0.671_863]), (0.2, [122.2491, -12.224_908])] {
            let found = exact(&material(1e4), twist);
            assert!((found[0] - expected[0]).abs() < 1e-4 && (found[1] - expected[1]).abs() < 1e-6, "{found:?}");
        }
    }
}
