//! The end of a cell, held as a plane and moved: loads and stiffness.

use pneuflex_model::{Problem, Support};
use pneuflex_newton::{ConvergedState, Path};

use super::error::CellError;
use super::gauge::Gauge;
use super::plane::{best_motion, place};

/// Half the small rotation of a stiffness sample, rad, and the half shift, mm.
const SMALL: f64 = 2e-3;

/// Forces on the end that count as none, N.
const NO_FORCE: f64 = 1e-5;

/// A cell's problem with the end of the base held along x and z.
pub fn problem_with_held_end(problem: &Problem) -> Problem {
    let mut held = problem.clone();
    let nodes = held.mesh.node_set("end_face").to_vec();
    held.supports.push(Support { name: "end".into(), nodes, axes: [true, false, true], motion: None });
    held
}

/// The held end of the cell: a plane moved by two shifts (mm) and a rotation (rad, positive downwards) about its bottom.
pub struct HeldEnd<'a> {
    path: &'a mut Path,
    problem: &'a Problem,
    /// Shifts along x and z and rotation.
    pub motion: [f64; 3],
    /// Forces along x and z (N) and moment (N·mm) on the modelled half at the motion.
    pub load: [f64; 3],
    /// Equilibrium at the motion.
    pub state: ConvergedState,
}

impl<'a> HeldEnd<'a> {
    /// Brings the held cell to the pressure and the end of a free one.
    ///
    /// # Errors
    /// A state that is not reached.
    pub fn follow(
        path: &'a mut Path,
        problem: &'a Problem,
        free_problem: &Problem,
        free: &ConvergedState,
    ) -> Result<Self, CellError> {
        let motion = best_motion(free_problem, free_problem.mesh.node_set("end_face"), &free.displacement);
        let state = path.advance_to(free.parameter, &mut |_| ())?;
        let mut end = Self { path, problem, motion: [0.0; 3], load: [0.0; 3], state };
        end.move_to(motion)?;
        Ok(end)
    }

    /// Moves the end and finds the equilibrium and the loads there.
    ///
    /// # Errors
    /// A state that is not reached.
    pub fn move_to(&mut self, motion: [f64; 3]) -> Result<(), CellError> {
        let mesh = &self.problem.mesh;
        let mut held = vec![[0.0; 3]; mesh.num_nodes()];
        for &node in mesh.node_set("end_face") {
            held[node as usize] = place(mesh.nodes[node as usize], self.origin(), motion).0;
        }
        self.state = self.path.prescribe(&held, &mut |_| ()).map_err(CellError::NotMoved)?;
        self.motion = motion;
        self.load = [0.0; 3];
        for &node in mesh.node_set("end_face") {
            let (_, by_turn) = place(mesh.nodes[node as usize], self.origin(), motion);
            let [x, _, z] = self.state.reaction[node as usize];
            let force = [x, z];
            self.load[0] += force[0];
            self.load[1] += force[1];
            self.load[2] += force[0] * by_turn[0] + force[1] * by_turn[1];
        }
        Ok(())
    }

    /// The plane's lowest line: x and z.
    fn origin(&self) -> [f64; 2] {
        let mesh = &self.problem.mesh;
        let first = mesh.node_set("end_face").first().map_or([0.0; 3], |&n| mesh.nodes[n as usize]);
        [first[0], 0.0]
    }

    /// ∂(load)/∂(motion) by central differences, and the curvature's derivatives; leaves the end where it was.
    ///
    /// # Errors
    /// A state that is not reached.
    pub fn derivatives(&mut self, gauge: &Gauge) -> Result<([[f64; 3]; 3], [f64; 3]), CellError> {
        let at = self.motion;
        let (mut stiffness, mut curvature) = ([[0.0; 3]; 3], [0.0; 3]);
        for j in 0..3 {
            let mut found = [([0.0; 3], 0.0); 2];
            for (side, found) in [-1.0, 1.0].into_iter().zip(&mut found) {
                let mut motion = at;
                motion[j] += side * SMALL;
                self.move_to(motion)?;
                *found = (self.load, gauge.curvature(self.problem, &self.state.displacement)?);
            }
            for i in 0..3 {
                stiffness[i][j] = (found[1].0[i] - found[0].0[i]) / (2.0 * SMALL);
            }
            curvature[j] = (found[1].1 - found[0].1) / (2.0 * SMALL);
        }
        self.move_to(at)?;
        Ok((stiffness, curvature))
    }

    /// Shifts the end at the same rotation until no force acts on it; `stiffness` is brought up to date if it is too old.
    ///
    /// # Errors
    /// A state that is not reached.
    pub fn balance(&mut self, stiffness: &mut [[f64; 3]; 3], gauge: &Gauge) -> Result<(), CellError> {
        for round in 1..=12 {
            let [x, z, turn] = self.motion;
            let force = [self.load[0], self.load[1]];
            if force[0].hypot(force[1]) < NO_FORCE {
                return Ok(());
            }
            if round % 4 == 0 {
                *stiffness = self.derivatives(gauge)?.0;
            }
            let shifts = without_force(stiffness, force, 0.0);
            self.move_to([x + shifts[0], z + shifts[1], turn])?;
        }
        Err(CellError::NotBalanced { pressure_kpa: self.state.parameter.0 })
    }

    /// ∂m/∂κ of the whole width, N·mm², about the unloaded state: a free end's motion leaves next to no load.
    ///
    /// # Errors
    /// A state that is not reached.
    pub fn stiffness(&mut self, gauge: &Gauge) -> Result<f64, CellError> {
        let (stiffness, curvature) = self.derivatives(gauge)?;
        let by_moment = solve(stiffness, [0.0, 0.0, 1.0]).ok_or(CellError::NoStiffness)?;
        let bent: f64 = (0..3).map(|i| curvature[i] * by_moment[i]).sum();
        // The half model carries half the moment.
        Ok(2.0 / bent)
    }
}

/// Shifts that take away forces `load` and those of a rotation.
pub fn without_force(stiffness: &[[f64; 3]; 3], load: [f64; 2], turn: f64) -> [f64; 2] {
    let [[a, b, c], [d, e, f], _] = *stiffness;
    let (p, q) = (-load[0] - c * turn, -load[1] - f * turn);
    let determinant = a * e - b * d;
    [(p * e - b * q) / determinant, (a * q - p * d) / determinant]
}

/// Solution of a 3 × 3 system by Cramer's rule; `None` if it is singular.
fn solve(matrix: [[f64; 3]; 3], rhs: [f64; 3]) -> Option<[f64; 3]> {
    let determinant = pneuflex_mesh::mesh::determinant(&matrix);
    let solution = std::array::from_fn(|j| {
        let mut replaced = matrix;
        (0..3).for_each(|i| replaced[i][j] = rhs[i]);
        pneuflex_mesh::mesh::determinant(&replaced) / determinant
    });
    solution.iter().all(|x: &f64| x.is_finite()).then_some(solution)
}

#[cfg(test)]
mod tests {
    use pneuflex_mesh::{Actuator, Channel, MeshSize};
    use pneuflex_model::{Contact, Formulation, Material, Solver};

    use super::*;

    #[test]
    fn a_nearly_solid_bar_has_the_stiffness_of_beam_theory() {
        // A base of 4 mm × 2 mm, low chambers on it that are all but solid. E = 6 C10 for small strains of an
        // incompressible body.
        let actuator = Actuator {
            width: 2.0,
            height: 4.1,
            cavity_length: 0.2.into(),
            side_wall: 0.8.into(),
            top_wall: 0.05.into(),
            channel: Channel { half_width: 0.0, bottom: 2.0, top: 3.0 },
            ..Actuator::two_chambers()
        };
        let size = MeshSize::uniform(2.0);
        let material = Material::default();
        let modulus = 3.0 * material.shear_modulus();
        let mut problem =
            Problem::from_actuator(&actuator, &size, Formulation::Hex20, material, Contact::default()).unwrap();
        // A breath of air from below: the pressure inside has next to nothing to push at.
        problem.cavities[0].facets = problem.mesh.facet_set("bottom").to_vec();
        let settings = Solver::default();
        let pressure_kpa = 1e-3;
        let free = Path::new(&problem, &settings).unwrap().advance_to(pressure_kpa, &mut |_| ()).unwrap();
        let held = problem_with_held_end(&problem);
        let mut path = Path::new(&held, &settings).unwrap();
        let mut end = HeldEnd::follow(&mut path, &held, &problem, &free).unwrap();
        let found = end.stiffness(&Gauge::new(&actuator)).unwrap();
        let expected = modulus * 2.0 * 4.08_f64.powi(3) / 12.0;
        assert!((found / expected - 1.0).abs() < 0.03, "{found} N mm2, beam theory {expected}");
    }
}
