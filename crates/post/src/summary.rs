//! What `summary.json` says about one reached pressure. Numbers are those of the whole body, also where a part of it is modelled (see
//! [`pneuflex_model::symmetry`]).

use std::collections::BTreeMap;

use pneuflex_laws::law_of;
use pneuflex_material::drucker;
use pneuflex_model::{LoadParameter, Problem, StateKind};
use serde::{Deserialize, Serialize};

use crate::error::PostError;
pub use crate::load_step::{CavitySummary, ObstacleSummary, ProbeSite, State, probe_sites};
use crate::load_step::{LoadStepSummary, Touching};
use crate::surface_stress::SurfaceState;
use crate::{contact, fields, measures, penetration, stress, vtu};

/// One reached pressure. The names of the fields are the keys of `summary.json`, a contract.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepSummary {
    /// Time, for models with a schedule; left out for actuators.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    /// Air pressure, kPa; that of the first cavity of a model, 0 if it has none.
    pub pressure_kpa: f64,
    /// Whether equilibrium was reached.
    pub converged: bool,
    /// Newton iterations spent since the previous pressure, rejected attempts included.
    pub iterations: usize,
    /// Load steps accepted since the previous pressure.
    pub load_steps: usize,
    /// Displacement of every probe, mm.
    pub probes: BTreeMap<String, [f64; 3]>,
    /// Angle of the end face, degrees, positive downwards; see [`measures::end_face_angle_deg`]. Left out for a body without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end_face_angle_deg: Option<f64>,
    /// Deformed bottom centreline, \[x, z\] in mm from the clamp to the tip.
    pub centreline: Vec<[f64; 2]>,
    /// Largest von Mises stress at an integration point, MPa.
    pub max_von_mises_mpa: f64,
    /// Reference position of that point, mm.
    pub max_von_mises_at: [f64; 3],
    /// von Mises stress not exceeded in 99 % of the reference volume, MPa.
    pub von_mises_p99_mpa: f64,
    /// Contact.
    pub contact: ContactSummary,
    /// Volume of all cavities that have one, mm³.
    pub cavity_volume_mm3: f64,
    /// Every cavity of a model, by name; of an actuator where chambers have air of their own.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub cavities: BTreeMap<String, CavitySummary>,
    /// Sum of the reactions of all supports, N, every node once; planes of symmetry are none.
    pub reaction_n: [f64; 3],
    /// Force with which the part beyond a plane of symmetry holds the modelled one, on the whole cross-section, N, by the plane's words; left
    /// out if there is none.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub symmetry_reactions: BTreeMap<String, [f64; 3]>,
    /// Sum of the reactions of every support of a model, N, by name; left out for actuators.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub reactions: BTreeMap<String, [f64; 3]>,
    /// What the body does to every obstacle, by name; left out if there is none.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub obstacles: BTreeMap<String, ObstacleSummary>,
    /// Strain energy, mJ, relative to the undeformed state; with the `full` invariant that state is
    /// not the one of least energy, and the number may be negative.
    pub strain_energy_mj: f64,
    /// Largest I₁ − 3 (or Ī₁ − 3) at an integration point.
    pub max_invariant_minus_3: f64,
    /// What to be careful about; left out if there is nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub warning: Option<String>,
    /// How much of the body is stretched further than the tests that its constants were fitted to, and where most; left out if next to nothing
    /// is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beyond_fit: Option<String>,
    /// How the contact misses the depth that it was to be solved to; left out if it does not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unmet_tolerance: Option<String>,
    /// Motions by which the mesh, and not the body, is unstable; left out if there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh_instability: Option<String>,
    /// Why it is among the results; left out for a state that was asked for.
    #[serde(default, skip_serializing_if = "StateKind::is_requested")]
    pub kind: StateKind,
    /// Motions by which the body would go away if the loads kept their values; left out if there are none.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub unstable_motions: usize,
    /// Where the body has buckled since the state before; left out if it has not.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bifurcations: Vec<BifurcationSummary>,
    /// How the body has snapped since the state before; left out if it has not.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub snaps: Vec<SnapSummary>,
}

/// A jump of the body from one equilibrium to another one under the same loads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SnapSummary {
    /// Position on the load path of the last equilibrium before: the pressure in kPa of an actuator, else a time.
    pub at: LoadParameter,
    /// The same of the equilibrium after it.
    pub to: LoadParameter,
    /// Place that moved furthest, at rest, mm.
    pub near_mm: [f64; 3],
    /// How far, mm.
    pub moved_mm: f64,
    /// Energy that body and loads gave up, mJ, where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub released_mj: Option<f64>,
    /// It is a load step that led further than the tangents at both of its ends predict: no dampers, and no state in between was sought.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub in_load_step: bool,
}

/// Where a body buckled, and the path left the branch that becomes unstable there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BifurcationSummary {
    /// Position on the load path of the last equilibrium before: the pressure in kPa of an actuator, else a time.
    pub at: LoadParameter,
    /// Place that the motion strains most, at rest, mm.
    pub near_mm: [f64; 3],
    /// Largest displacement by which the body was pushed along the motion to find the other branch, mm.
    pub pushed_mm: f64,
}

impl StepSummary {
    /// Its position on the load path: the time of a model with a schedule, the pressure in kPa of an actuator.
    pub fn when(&self) -> LoadParameter {
        LoadParameter(self.time.unwrap_or(self.pressure_kpa))
    }

    /// What a load step between requested positions is described by, too.
    pub fn plain(&self) -> LoadStepSummary {
        LoadStepSummary {
            time: self.time,
            pressure_kpa: self.pressure_kpa,
            probes: self.probes.clone(),
            end_face_angle_deg: self.end_face_angle_deg,
            centreline: self.centreline.clone(),
            contact: Touching { points_active: self.contact.points_active, area_mm2: self.contact.area_mm2 },
            cavity_volume_mm3: self.cavity_volume_mm3,
            cavities: self.cavities.clone(),
            reaction_n: self.reaction_n,
            symmetry_reactions: self.symmetry_reactions.clone(),
            reactions: self.reactions.clone(),
            obstacles: self.obstacles.clone(),
        }
    }

    /// Angle of the chord from the clamp to the tip, degrees, positive downwards; `None` for a body without a centreline.
    pub fn chord_angle_deg(&self) -> Option<f64> {
        measures::angle_of_chord_deg(&self.centreline)
    }
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// Contact at one reached pressure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactSummary {
    /// Contact points that carry traction.
    pub points_active: usize,
    /// Reference area of these points, mm².
    pub area_mm2: f64,
    /// Energy of the contact's penalty, mJ.
    pub penalty_energy_mj: f64,
    /// Largest depth by which walls pass through each other, from dense sampling of the deformed faces, mm.
    pub max_penetration_mm: f64,
    /// Slave area behind the master walls, from dense sampling, mm².
    pub penetrating_area_mm2: f64,
    /// Gaps whose walls touch somewhere, from dense sampling.
    pub gaps_in_contact: usize,
    /// Least signed distance of facing walls, from dense sampling, mm; left out for a body without gaps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min_gap_mm: Option<f64>,
}

/// A state with everything derived from it.
#[derive(Clone, Debug, PartialEq)]
pub struct Described {
    /// For `summary.json`.
    pub summary: StepSummary,
    /// Stresses.
    pub stress: stress::StressField,
    /// Contact.
    pub contact: contact::ContactState,
}

/// Derives everything reported about a state.
///
/// # Errors
/// A list of the wrong length, a number that is not finite, or an inverted element.
pub fn describe(
    problem: &Problem,
    sites: &BTreeMap<String, ProbeSite>,
    state: &State<'_>,
) -> Result<Described, PostError> {
    let u = state.displacement;
    let stress = stress::recover(problem, u)?;
    let contact = contact::evaluate_at(problem, u, state.parameter, state.contact_multipliers)?;
    let penetration = penetration::measure(problem, u)?;
    let largest = stress.largest_von_mises();
    let parts = problem.parts_of_whole();
    let whole = |of_part: f64| parts as f64 * of_part;
    let plain = LoadStepSummary::beside(problem, sites, state, &contact)?;
    let summary = StepSummary {
        time: plain.time,
        pressure_kpa: plain.pressure_kpa,
        converged: true,
        iterations: state.iterations,
        load_steps: state.load_steps,
        probes: plain.probes,
        end_face_angle_deg: plain.end_face_angle_deg,
        centreline: plain.centreline,
        max_von_mises_mpa: largest.map_or(0.0, |p| p.von_mises),
        max_von_mises_at: largest.map_or([0.0; 3], |p| p.position),
        von_mises_p99_mpa: stress.von_mises_quantile(0.99),
        contact: ContactSummary {
            points_active: plain.contact.points_active,
            area_mm2: plain.contact.area_mm2,
            penalty_energy_mj: whole(contact.penalty_energy_mj),
            max_penetration_mm: penetration.max_penetration_mm(),
            penetrating_area_mm2: whole(penetration.penetrating_area_mm2()),
            gaps_in_contact: penetration.gaps_in_contact(),
            min_gap_mm: penetration.min_gap_mm(),
        },
        cavity_volume_mm3: plain.cavity_volume_mm3,
        cavities: plain.cavities,
        reaction_n: plain.reaction_n,
        symmetry_reactions: plain.symmetry_reactions,
        reactions: plain.reactions,
        obstacles: plain.obstacles,
        strain_energy_mj: whole(stress.strain_energy),
        max_invariant_minus_3: stress.largest_invariant_minus_3(),
        warning: material_warning(problem, &stress),
        beyond_fit: beyond_fit(problem, &stress),
        unmet_tolerance: state.contact_failure.map(str::to_owned),
        mesh_instability: None,
        kind: StateKind::default(),
        unstable_motions: 0,
        bifurcations: Vec::new(),
        snaps: Vec::new(),
    };
    Ok(Described { summary, stress, contact })
}

fn material_warning(problem: &Problem, stress: &stress::StressField) -> Option<String> {
    let beyond = stress.beyond_limit(problem);
    let worst = stress::first_largest(beyond.iter(), |(_, point, _)| point.invariant_minus_3);
    let Some((_, worst, limit)) = worst else { return instability_warning(problem, stress) };
    let [x, y, z] = worst.position;
    Some(format!(
        "the material gives way at {} integration points, most at ({x:.2}, {y:.2}, {z:.2}) mm: the invariant exceeds 3 \
         by more than {limit:.2}, where these constants have no stiffness left",
        beyond.len()
    ))
}

/// Share of the volume that may be stretched further than the constants were fitted: at re-entrant edges some always is.
const BEYOND_FIT: f64 = 1e-3;

/// Beyond what was measured, whatever the law can bear.
fn beyond_fit(problem: &Problem, stress: &stress::StressField) -> Option<String> {
    let beyond = stress.beyond_fit(problem);
    // How far beyond: tests of other kinds end at other stretches.
    let (worst, end) = stress::first_largest(beyond.iter(), |(point, tests)| {
        point.isochoric_invariant_minus_3 / tests.invariant_minus_3(point.mode)
    })?;
    let share = beyond.iter().map(|(point, _)| point.volume).sum::<f64>()
        / stress.points.iter().map(|point| point.volume).sum::<f64>();
    let [x, y, z] = worst.position;
    (share > BEYOND_FIT).then(|| {
        let (mode, known) = (worst.mode, end.invariant_minus_3(worst.mode));
        let known = match end.tests().any(|(tested, _)| tested == mode) {
            true => String::new(),
            false => format!(", which no test was; what was measured of others leads to {:.2}", mode.stretch_of(known)),
        };
        format!(
            "{:.1} % of the body are stretched further than the tests that the constants were fitted to ({end}), most at \
             ({x:.2}, {y:.2}, {z:.2}) mm: to {:.2} in a deformation like {} tension{known}",
            100.0 * share,
            worst.stretch,
            mode.name()
        )
    })
}

/// Below a limit of the invariant, or for laws without one.
fn instability_warning(problem: &Problem, stress: &stress::StressField) -> Option<String> {
    let unstable = stress.unstable();
    let (element, worst) = stress::first_largest(unstable.iter(), |(_, point)| point.invariant_minus_3)?;
    let [x, y, z] = worst.position;
    let (materials, material_of) = problem.materials();
    let law = law_of(materials[usize::from(material_of[*element])]);
    let limit = drucker::stable_up_to(&*law, worst.mode)
        .map_or(String::new(), |limit| format!(", which they describe to {limit:.2}"));
    Some(format!(
        "the material gives way at {} integration points, most at ({x:.2}, {y:.2}, {z:.2}) mm: there these constants answer more strain \
         with less stress (Drucker's condition), at a stretch of {:.2} in a deformation like {} tension{limit}",
        unstable.len(),
        worst.stretch,
        worst.mode.name()
    ))
}

impl Described {
    /// The texts of the state's field files: the body, and the contact walls if there are any.
    ///
    /// # Errors
    /// A list of the wrong length or a number that is not finite.
    pub fn field_files(&self, problem: &Problem, state: &State<'_>) -> Result<(String, Option<String>), PostError> {
        let time = state.parameter.0;
        let surface = SurfaceState {
            displacement: state.displacement,
            parameter: state.parameter,
            pressures: state.cavity_pressures,
            contact: &self.contact,
        };
        let body = fields::body(problem, &self.stress, &surface)?.to_vtu()?;
        let walls: Option<vtu::Grid> = fields::contact_walls(problem, state.displacement, &self.contact, time)?;
        Ok((body, walls.map(|grid| grid.to_vtu()).transpose()?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{displacement_of, two_chambers};
    use pneuflex_model::{FittedTo, Material, Mode, Obstacle, Pressure, Probe, Shape};

    #[test]
    fn a_state_at_rest_is_described() {
        let problem = two_chambers(2.0);
        let zero = vec![[0.0; 3]; problem.mesh.num_nodes()];
        let probes = [Probe { name: "tip".into(), at: [18.0, 0.1, 0.0] }];
        let sites = probe_sites(&problem.mesh, &probes);
        assert!((sites["tip"].distance_mm - 0.1).abs() < 1e-12);
        let state = State {
            parameter: LoadParameter(5.0),
            cavity_pressures: &[Pressure::from_mpa(0.005)],
            displacement: &zero,
            reaction: &zero,
            iterations: 3,
            load_steps: 1,
            contact_multipliers: &[],
            contact_failure: None,
        };
        let described = describe(&problem, &sites, &state).unwrap();
        let summary = &described.summary;
        assert_eq!(summary.probes["tip"], [0.0; 3]);
        assert_eq!(
            (summary.end_face_angle_deg, summary.strain_energy_mj, summary.max_von_mises_mpa),
            (Some(0.0), 0.0, 0.0)
        );
        assert!((summary.contact.min_gap_mm.unwrap() - 2.0).abs() < 1e-12);
        let (body, walls) = described.field_files(&problem, &state).unwrap();
        assert!(body.contains("von_mises") && walls.unwrap().contains("contact_traction"));
        assert_eq!((summary.max_invariant_minus_3, &summary.warning), (0.0, &None));
        let json = serde_json::to_value(summary).unwrap();
        for key in ["pressure_kpa", "converged", "iterations", "probes", "end_face_angle_deg", "centreline"] {
            assert!(json.get(key).is_some(), "{key}");
        }
    }

    #[test]
    fn forces_on_obstacles_are_those_of_the_whole_body() {
        let mut problem = two_chambers(2.0);
        let shape = Shape::Plane { point: [3.0, 2.0, 0.1], normal: [0.0, 0.0, 1.0] };
        let obstacle = |name: &str, shape| Obstacle {
            name: name.into(),
            shape,
            facets: problem.mesh.facet_set("bottom").to_vec(),
            stiffness: 4.0,
            motion: None,
            report_force: true,
            penetration_tolerance: None,
            interference_until: None,
        };
        let beside = Shape::Sphere { centre: [9.0, 5.0, -1.0], radius: 1.2, is_hollow: false };
        let obstacles = vec![obstacle("table", shape), obstacle("ball", beside)];
        problem.obstacles = obstacles;
        let zero = vec![[0.0; 3]; problem.mesh.num_nodes()];
        let state = State {
            parameter: LoadParameter(5.0),
            cavity_pressures: &[Pressure::from_mpa(0.005)],
            displacement: &zero,
            reaction: &zero,
            iterations: 3,
            load_steps: 1,
            contact_multipliers: &[],
            contact_failure: None,
        };
        let of = |problem: &Problem| describe(problem, &BTreeMap::new(), &state).unwrap().summary;
        let half = of(&problem);
        let found = half.obstacles["table"];
        // k d A of 18 mm × 20 mm; its moment about (3, 2, 0.1) from the centre (9, 0).
        let force = 4.0 * 0.1 * 18.0 * 20.0;
        assert!((found.force_n[2] + force).abs() < 1e-9 && (found.area_mm2 - 360.0).abs() < 1e-9, "{found:?}");
        let expected = [2.0 * force, 6.0 * force, 0.0];
        assert!(found.moment_nmm.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
        assert_eq!((found.images, half.obstacles["ball"].images), (1, 2));
        problem.symmetry.clear();
        let part = of(&problem);
        assert_eq!(2.0 * part.cavity_volume_mm3, half.cavity_volume_mm3);
        assert_eq!(2.0 * part.contact.penalty_energy_mj, half.contact.penalty_energy_mj);
        assert_eq!(2 * part.obstacles["table"].points_active, found.points_active);
        assert_eq!(
            (part.obstacles["ball"].images, part.obstacles["ball"].force_n),
            (1, half.obstacles["ball"].force_n)
        );
    }

    #[test]
    fn a_material_stretched_beyond_its_limit_is_a_warning() {
        let problem = two_chambers(2.0);
        // Plane stretch to 8 has I₁ − 3 = 64 + 1/64 + 1 − 3, beyond the limit of 54.83.
        let u = displacement_of(&problem, |x| [7.0 * x[0], 0.0, -0.875 * x[2]]);
        let state = State {
            parameter: LoadParameter(5.0),
            cavity_pressures: &[Pressure::from_mpa(0.005)],
            displacement: &u,
            reaction: &u,
            iterations: 3,
            load_steps: 1,
            contact_multipliers: &[],
            contact_failure: None,
        };
        let summary = describe(&problem, &BTreeMap::new(), &state).unwrap().summary;
        assert!((summary.max_invariant_minus_3 - (62.0 + 1.0 / 64.0)).abs() < 1e-9);
        let fitted_to = FittedTo::of([(Mode::Uniaxial, 5.0), (Mode::Planar, 4.0)]);
        let fitted = Material { fitted_to: Some(fitted_to), ..Material::yeoh(0.27, 0.03, 0.0) };
        let measured = |stretch: f64| {
            let problem = Problem { material: fitted.clone(), ..problem.clone() };
            let u = displacement_of(&problem, |x| [(stretch - 1.0) * x[0], 0.0, (1.0 / stretch - 1.0) * x[2]]);
            describe(&problem, &BTreeMap::new(), &State { displacement: &u, reaction: &u, ..state })
                .unwrap()
                .summary
                .beyond_fit
        };
        assert_eq!(measured(3.99), None);
        let text = measured(4.01).unwrap();
        assert!(text.contains("100.0 % of the body") && text.contains("(uniaxial 5, planar 4)"), "{text}");
        assert!(text.ends_with("to 4.01 in a deformation like planar tension"), "{text}");
        let warning = summary.warning.unwrap();
        assert!(warning.contains("2904 integration points") && warning.contains("54.83"), "{warning}");
    }
}
