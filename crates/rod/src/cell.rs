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

use pneuflex_mesh::Actuator;
use pneuflex_model::{Case, ContactMethod, Problem, Solver, Support};
use pneuflex_newton::{ConvergedState, Path};
use pneuflex_post::penetration;

use crate::identify::{ContactSample, FreeSample, Samples, StiffnessSample, TouchSample};

/// Highest pressure of the identification, kPa (theory §8: the paper's rod knows no contact).
pub const HIGHEST_KPA: f64 = 15.0;

/// Pressures of the unloaded cell, kPa.
const FREE_KPA: [f64; 8] = [1.0, 2.5, 5.0, 7.5, 10.0, 12.0, 13.5, HIGHEST_KPA];

/// Pressures, among those, at which the bending stiffness is measured, and the cell bent back until its chambers touch.
const BENT_KPA: [f64; 3] = [5.0, 10.0, HIGHEST_KPA];

/// Half the small rotation of a stiffness sample, rad, and the half shift, mm.
const SMALL: f64 = 2e-3;

/// By how much the end is turned at a time when the cell is bent back, rad, and how often at the most.
const TURN: f64 = 0.02;
const TURNS: usize = 25;

/// Turns after the first contact that are sampled.
const TURNS_IN_CONTACT: usize = 4;

/// Forces on the end that count as none, N.
const NO_FORCE: f64 = 1e-5;

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
pub fn cell_of(actuator: &Actuator) -> Actuator {
    Actuator { chambers: 2, flange: 0.5 * actuator.gap, ..actuator.clone() }
}

/// Takes the samples from the case's actuator.
///
/// # Errors
/// Lengths that make no body, or a state that is not reached.
pub fn sample(case: &Case, progress: &mut dyn FnMut(&str)) -> Result<Cell, String> {
    let cell = cell_of(&case.actuator);
    let problem = Problem::from_actuator(
        &cell,
        &case.mesh.mesh_size(&case.actuator),
        case.mesh.formulation(),
        case.material.clone(),
        case.contact.clone(),
    )
    .map_err(|e| e.to_string())?;
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
    let mut path = Path::new(&held, &case.solver).map_err(|e| e.to_string())?;
    for state in &bent {
        progress(&format!("cell at {} kPa: bending stiffness", state.parameter));
        let mut end = End::follow(&mut path, &held, &problem, state)?;
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
                note = Some(cause);
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
fn free_states(problem: &Problem, settings: &Solver) -> Result<Vec<ConvergedState>, String> {
    let mut path = Path::new(problem, settings).map_err(|e| e.to_string())?;
    FREE_KPA.iter().map(|&p| path.advance_to(p, &mut |_| ()).map_err(|e| e.to_string())).collect()
}

/// The same with the end of the base held along x and z.
fn problem_with_held_end(problem: &Problem) -> Problem {
    let mut held = problem.clone();
    let nodes = held.mesh.node_set("end_face").to_vec();
    held.supports.push(Support { name: "end".into(), nodes, axes: [true, false, true], motion: None });
    held
}

/// Where curvature is read.
struct Gauge {
    /// Reference x of the chambers' middles, mm.
    stations: [f64; 2],
    /// Height of the base, mm.
    base: f64,
}

impl Gauge {
    fn new(actuator: &Actuator) -> Self {
        let first = actuator.flange + 0.5 * actuator.chamber_length;
        Self {
            stations: [first, first + actuator.chamber_length + actuator.gap],
            base: actuator.base.min(actuator.floor()),
        }
    }

    fn length(&self) -> f64 {
        self.stations[1] - self.stations[0]
    }

    /// Curvature of the bottom, 1/mm, positive downwards.
    fn curvature(&self, problem: &Problem, displacement: &[[f64; 3]]) -> Result<f64, String> {
        let angles = self.stations.map(|x| section_angle(problem, displacement, x, self.base));
        let [Some(a), Some(b)] = angles else {
            return Err("the mesh does not reach the chambers' middles".into());
        };
        Ok((b - a) / self.length())
    }

    /// Change in length of the bottom between the stations, as a share.
    fn stretch(&self, problem: &Problem, displacement: &[[f64; 3]]) -> f64 {
        let points: Vec<[f64; 3]> = bottom(problem, displacement);
        let inside = |p: &&[[f64; 3]]| {
            let middle = 0.5 * (p[0][0] + p[1][0]);
            middle > self.stations[0] && middle < self.stations[1]
        };
        let (before, after) = points
            .windows(2)
            .filter(|p| inside(p))
            .fold((0.0, 0.0), |(a, b), p| (a + p[1][0] - p[0][0], b + (p[1][1] - p[0][1]).hypot(p[1][2] - p[0][2])));
        if before > 0.0 { after / before - 1.0 } else { 0.0 }
    }
}

/// Bottom centreline from the clamp on: reference x, deformed x and z, mm.
pub fn bottom(problem: &Problem, displacement: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mesh = &problem.mesh;
    let mut points: Vec<[f64; 3]> = mesh
        .node_set("bottom_centreline")
        .iter()
        .map(|&n| {
            let (n, at) = (n as usize, mesh.nodes[n as usize]);
            [at[0], at[0] + displacement[n][0], at[2] + displacement[n][2]]
        })
        .collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points
}

/// Rotation of the base's cross-section at a reference x, rad, positive downwards: the best-fitting one of its nodes about
/// their centroid. Where there are no nodes, that of the sections to either side by their distance. `None` beyond the mesh.
pub fn section_angle(problem: &Problem, displacement: &[[f64; 3]], x: f64, base: f64) -> Option<f64> {
    let lines = bottom(problem, displacement);
    let tolerance = 1e-6 * lines.last()?[0];
    let before = lines.iter().map(|p| p[0]).rfind(|at| *at <= x + tolerance)?;
    let after = lines.iter().map(|p| p[0]).find(|at| *at >= x - tolerance)?;
    let [a, b] = [before, after].map(|at| {
        let in_section = |p: [f64; 3]| (p[0] - at).abs() <= tolerance && p[2] <= base + tolerance;
        best_motion(problem, &problem.mesh.select_nodes(in_section), displacement)[2]
    });
    let share = if after - before > tolerance { (x - before) / (after - before) } else { 0.0 };
    Some(a + share * (b - a))
}

/// The held end of the cell: a plane moved by two shifts (mm) and a rotation (rad, positive downwards) about its bottom.
struct End<'a> {
    path: &'a mut Path,
    problem: &'a Problem,
    motion: [f64; 3],
    /// Forces along x and z (N) and moment (N·mm) on the modelled half at the motion.
    load: [f64; 3],
    state: ConvergedState,
}

impl<'a> End<'a> {
    /// Brings the held cell to the pressure and the end of a free one.
    fn follow(
        path: &'a mut Path,
        problem: &'a Problem,
        free_problem: &Problem,
        free: &ConvergedState,
    ) -> Result<Self, String> {
        let motion = best_motion(free_problem, free_problem.mesh.node_set("end_face"), &free.displacement);
        let state = path.advance_to(free.parameter, &mut |_| ()).map_err(|e| e.to_string())?;
        let mut end = Self { path, problem, motion: [0.0; 3], load: [0.0; 3], state };
        end.move_to(motion)?;
        Ok(end)
    }

    fn move_to(&mut self, motion: [f64; 3]) -> Result<(), String> {
        let mesh = &self.problem.mesh;
        let mut held = vec![[0.0; 3]; mesh.num_nodes()];
        for &node in mesh.node_set("end_face") {
            held[node as usize] = place(mesh.nodes[node as usize], self.origin(), motion).0;
        }
        self.state =
            self.path.prescribe(&held, &mut |_| ()).map_err(|e| format!("the cell's end could not be moved: {e}"))?;
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
    fn derivatives(&mut self, gauge: &Gauge) -> Result<([[f64; 3]; 3], [f64; 3]), String> {
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
    fn balance(&mut self, stiffness: &mut [[f64; 3]; 3], gauge: &Gauge) -> Result<(), String> {
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
        Err(format!("bent back at {} kPa the cell does not become free of forces", self.state.parameter))
    }

    /// ∂m/∂κ of the whole width, N·mm², about the unloaded state: a free end's motion leaves next to no load.
    fn stiffness(&mut self, gauge: &Gauge) -> Result<f64, String> {
        let (stiffness, curvature) = self.derivatives(gauge)?;
        let by_moment = solve(stiffness, [0.0, 0.0, 1.0]).ok_or("the cell's end has no stiffness")?;
        let bent: f64 = (0..3).map(|i| curvature[i] * by_moment[i]).sum();
        // The half model carries half the moment.
        Ok(2.0 / bent)
    }
}

/// Turns the end upwards at the last of some pressures until the chambers touch, and a little further.
fn bend_back(
    held: &Problem,
    free_problem: &Problem,
    states: &[&ConvergedState],
    settings: &Solver,
    gauge: &Gauge,
    samples: &mut Samples,
) -> Result<(), String> {
    let mut path = Path::new(held, settings).map_err(|e| e.to_string())?;
    let Some((last, before)) = states.split_last() else { return Ok(()) };
    // On the way the end follows the free one: with it held straight the cell would not bear the higher pressures.
    for state in before {
        End::follow(&mut path, held, free_problem, state)?;
    }
    let mut end = End::follow(&mut path, held, free_problem, last)?;
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
            let found = penetration::measure(held, &end.state.displacement).map_err(|e| e.to_string())?;
            gaps.push([curvature, found.min_gap_mm().unwrap_or(f64::INFINITY)]);
        }
    }
    Err(format!("at {pressure_kpa} kPa the chambers do not touch within {:.2} rad", TURN * TURNS as f64))
}

/// The curvature at which the distance of the walls reaches zero, going on straight from the last two points, between
/// the last of them and `reached`, where they touch.
fn touch_curvature(gaps: &[[f64; 2]], reached: f64) -> Option<f64> {
    let [.., a, b] = gaps else { return gaps.last().map(|last| 0.5 * (last[0] + reached)) };
    let touch = b[0] - b[1] * (b[0] - a[0]) / (b[1] - a[1]);
    Some(if touch.is_finite() { touch.clamp(reached.min(b[0]), reached.max(b[0])) } else { 0.5 * (b[0] + reached) })
}

/// Shifts that take away forces `load` and those of a rotation.
fn without_force(stiffness: &[[f64; 3]; 3], load: [f64; 2], turn: f64) -> [f64; 2] {
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

/// Displacement of a point of the plane under a motion, and the derivative of its x and z by the rotation.
fn place(at: [f64; 3], origin: [f64; 2], [x, z, turn]: [f64; 3]) -> ([f64; 3], [f64; 2]) {
    let (sine, cosine) = turn.sin_cos();
    let [dx, dz] = [at[0] - origin[0], at[2] - origin[1]];
    let moved = [x + cosine * dx + sine * dz - dx, 0.0, z - sine * dx + cosine * dz - dz];
    (moved, [-sine * dx + cosine * dz, -cosine * dx - sine * dz])
}

/// The motion of a plane across x that comes closest to that of some of its nodes.
fn best_motion(problem: &Problem, nodes: &[u32], displacement: &[[f64; 3]]) -> [f64; 3] {
    let mesh = &problem.mesh;
    let n = nodes.len().max(1) as f64;
    let mean = |component: usize, deformed: bool| {
        let value = |&node: &u32| {
            let (node, d) = (node as usize, component);
            mesh.nodes[node][d] + if deformed { displacement[node][d] } else { 0.0 }
        };
        nodes.iter().map(value).sum::<f64>() / n
    };
    let (before, after) = ([mean(0, false), mean(2, false)], [mean(0, true), mean(2, true)]);
    let (mut sine, mut cosine) = (0.0, 0.0);
    for &node in nodes {
        let node = node as usize;
        let (x, u) = (mesh.nodes[node], displacement[node]);
        let a = [x[0] - before[0], x[2] - before[1]];
        let b = [x[0] + u[0] - after[0], x[2] + u[2] - after[1]];
        sine += a[0] * b[1] - a[1] * b[0];
        cosine += a[0] * b[0] + a[1] * b[1];
    }
    let turn = -sine.atan2(cosine);
    let (s, c) = turn.sin_cos();
    // The centroid's motion, less what the rotation about the bottom does to it.
    let dz = before[1];
    [after[0] - before[0] - s * dz, after[1] - before[1] - (c - 1.0) * dz, turn]
}

#[cfg(test)]
mod tests {
    use pneuflex_mesh::{Channel, MeshSize};
    use pneuflex_model::{Contact, Formulation, Material};

    use super::*;

    #[test]
    fn a_turned_plane_does_the_work_of_its_moment() {
        let (at, origin, motion) = ([18.0, 3.0, 4.0], [18.0, 0.0], [0.1, -0.2, 0.3]);
        let (_, by_turn) = place(at, origin, motion);
        let step = 1e-6;
        let [more, less] = [step, -step].map(|h| place(at, origin, [motion[0], motion[1], motion[2] + h]).0);
        assert!(((more[0] - less[0]) / (2.0 * step) - by_turn[0]).abs() < 1e-8);
        assert!(((more[2] - less[2]) / (2.0 * step) - by_turn[1]).abs() < 1e-8);
        // Positive turns lead downwards: the top of the face goes forwards.
        assert!(place(at, origin, [0.0, 0.0, 0.1]).0[0] > 0.0);
    }

    #[test]
    fn the_motion_of_a_rigidly_moved_end_is_found() {
        let size = MeshSize::uniform(2.0);
        let problem = Problem::from_actuator(
            &Actuator::two_chambers(),
            &size,
            Formulation::Hex8Sri,
            Material::default(),
            Contact::default(),
        )
        .unwrap();
        let motion = [0.3, -0.7, 0.4];
        let u: Vec<[f64; 3]> = problem.mesh.nodes.iter().map(|&x| place(x, [18.0, 0.0], motion).0).collect();
        for (found, expected) in best_motion(&problem, problem.mesh.node_set("end_face"), &u).into_iter().zip(motion) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn a_nearly_solid_bar_has_the_stiffness_of_beam_theory() {
        // A base of 4 mm × 2 mm, low chambers on it that are all but solid. E = 6 C10 for small strains of an
        // incompressible body.
        let actuator = Actuator {
            width: 2.0,
            height: 4.1,
            cavity_length: 0.2,
            side_wall: 0.8,
            top_wall: 0.05,
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
        let mut end = End::follow(&mut path, &held, &problem, &free).unwrap();
        let found = end.stiffness(&Gauge::new(&actuator)).unwrap();
        let expected = modulus * 2.0 * 4.08_f64.powi(3) / 12.0;
        assert!((found / expected - 1.0).abs() < 0.03, "{found} N mm2, beam theory {expected}");
    }
}
