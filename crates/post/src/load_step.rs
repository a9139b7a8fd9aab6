//! What a load step between requested positions is described by: everything that needs neither stresses nor a dense sampling of the walls,
//! which would cost several percent of the step.

use std::collections::BTreeMap;

use pneuflex_mesh::Mesh;
use pneuflex_mesh::vector::{cross, sub};
use pneuflex_model::{Cavity, Clock, LoadParameter, Obstacle, Pressure, Probe, Problem};
use serde::{Deserialize, Serialize};

use crate::contact::{self, ContactState};
use crate::error::{PostError, check};
use crate::measures;

/// An equilibrium to be described.
#[derive(Clone, Copy, Debug)]
pub struct State<'a> {
    /// Position on the load path: the air pressure in kPa for actuators.
    pub parameter: LoadParameter,
    /// Pressure in every cavity.
    pub cavity_pressures: &'a [Pressure],
    /// Displacements, mm, one entry per node.
    pub displacement: &'a [[f64; 3]],
    /// Support reactions, N, one entry per node.
    pub reaction: &'a [[f64; 3]],
    /// Newton iterations spent since the previous one.
    pub iterations: usize,
    /// Load steps accepted since the previous one.
    pub load_steps: usize,
    /// Multipliers of the contact's points, MPa; none for a plain penalty.
    pub contact_multipliers: &'a [f64],
    /// Why the contact points are further from their partners than asked for, if they are.
    pub contact_failure: Option<&'a str>,
}

/// A load step in numbers of the whole body. The names of the fields are the keys of `summary.json`, a contract; what they mean, and when
/// they are left out, is said where [`crate::summary::StepSummary`] has them, too.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LoadStepSummary {
    /// Time, for models with a schedule.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    /// Air pressure, kPa; that of the first cavity of a model.
    pub pressure_kpa: f64,
    /// Displacement of every probe, mm.
    pub probes: BTreeMap<String, [f64; 3]>,
    /// Angle of the end face, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end_face_angle_deg: Option<f64>,
    /// Deformed bottom centreline, \[x, z\] in mm.
    pub centreline: Vec<[f64; 2]>,
    /// Contact.
    pub contact: Touching,
    /// Volume of all cavities that have one, mm³.
    pub cavity_volume_mm3: f64,
    /// Every cavity, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub cavities: BTreeMap<String, CavitySummary>,
    /// Sum of the reactions of all supports, N.
    pub reaction_n: [f64; 3],
    /// Forces across the planes of symmetry, N.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub symmetry_reactions: BTreeMap<String, [f64; 3]>,
    /// Sums of the reactions of a model's supports, N.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub reactions: BTreeMap<String, [f64; 3]>,
    /// What the body does to every obstacle.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub obstacles: BTreeMap<String, ObstacleSummary>,
}

/// How much touches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Touching {
    /// Contact points that carry traction.
    pub points_active: usize,
    /// Reference area of these points, mm².
    pub area_mm2: f64,
}

/// A cavity at one reached time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CavitySummary {
    /// Pressure above the atmosphere's, kPa.
    pub pressure_kpa: f64,
    /// Volume, mm³; left out for an open one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub volume_mm3: Option<f64>,
}

/// What the body does to an obstacle at one reached pressure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObstacleSummary {
    /// Force on the obstacle, N.
    pub force_n: [f64; 3],
    /// Moment of that force about `about_mm`, N·mm.
    pub moment_nmm: [f64; 3],
    /// The obstacle's centre, or the given point of a plane or an axis, where it is now, mm.
    pub about_mm: [f64; 3],
    /// Contact points that carry traction.
    pub points_active: usize,
    /// Reference area of these points, mm².
    pub area_mm2: f64,
    /// Largest depth of a contact point, mm.
    pub max_penetration_mm: f64,
    /// How many there are of it: an obstacle beside a plane of symmetry has a mirror image, and the numbers are those of one of them. Left
    /// out for a single one.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub images: usize,
}

/// Where a probe sits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ProbeSite {
    /// Node taken.
    pub node: usize,
    /// Its reference position, mm.
    pub at: [f64; 3],
    /// Its distance from the requested position, mm.
    pub distance_mm: f64,
}

impl LoadStepSummary {
    /// That of a state.
    ///
    /// # Errors
    /// A list of the wrong length, a number that is not finite, or contact that cannot be evaluated.
    pub fn of(problem: &Problem, sites: &BTreeMap<String, ProbeSite>, state: &State<'_>) -> Result<Self, PostError> {
        let contact = contact::evaluate_at(problem, state.displacement, state.parameter, state.contact_multipliers)?;
        Self::beside(problem, sites, state, &contact)
    }

    /// The same where the contact is known.
    pub(crate) fn beside(
        problem: &Problem,
        sites: &BTreeMap<String, ProbeSite>,
        state: &State<'_>,
        contact: &ContactState,
    ) -> Result<Self, PostError> {
        let u = state.displacement;
        let is_model = problem.clock == Clock::Steps;
        let first = state.cavity_pressures.first().map_or(0.0, |pressure| pressure.kpa());
        let has_end_face = !measures::end_face(problem).is_empty();
        let parts = problem.parts_of_whole();
        let reactions = measures::reactions(problem, state.reaction)?;
        let cavity_volume_mm3 = measures::cavity_volume(problem, u)?;
        check("cavity volume", &[cavity_volume_mm3], 1)?;
        Ok(Self {
            time: is_model.then_some(state.parameter.0),
            pressure_kpa: if is_model { first } else { state.parameter.0 },
            probes: sites.iter().map(|(name, site)| (name.clone(), u[site.node])).collect(),
            end_face_angle_deg: has_end_face.then(|| measures::end_face_angle_deg(problem, u)).transpose()?,
            centreline: measures::centreline(problem, u)?,
            contact: Touching {
                points_active: parts * contact.points_active,
                area_mm2: parts as f64 * contact.area_mm2,
            },
            cavity_volume_mm3,
            cavities: if is_model || !problem.has_one_air() { cavities(problem, state)? } else { BTreeMap::new() },
            reaction_n: reactions.total,
            symmetry_reactions: reactions.planes,
            reactions: if is_model { reactions.supports } else { BTreeMap::new() },
            obstacles: (problem.obstacles.iter().zip(&contact.obstacles))
                .filter(|(obstacle, _)| obstacle.report_force)
                .map(|(obstacle, found)| (found.name.clone(), ObstacleSummary::of(problem, obstacle, found)))
                .collect(),
        })
    }

    /// Its position on the load path: the time of a model with a schedule, the pressure in kPa of an actuator.
    pub fn when(&self) -> LoadParameter {
        LoadParameter(self.time.unwrap_or(self.pressure_kpa))
    }

    /// Angle of the chord from the clamp to the tip, degrees, positive downwards; `None` for a body without a centreline.
    pub fn chord_angle_deg(&self) -> Option<f64> {
        measures::angle_of_chord_deg(&self.centreline)
    }
}

impl ObstacleSummary {
    /// What the whole body does to an obstacle, from what the modelled part does.
    fn of(problem: &Problem, obstacle: &Obstacle, found: &contact::ObstacleForce) -> Self {
        let mut whole = Self {
            force_n: found.force,
            moment_nmm: found.moment,
            about_mm: found.about,
            points_active: found.points_active,
            area_mm2: found.area_mm2,
            max_penetration_mm: found.max_penetration_mm,
            images: 1,
        };
        for plane in &problem.symmetry {
            if !plane.is_symmetry_of(obstacle) {
                whole.images *= 2;
                continue;
            }
            let mirrored = plane.mirror_vector(whole.force_n);
            // The mirror image's moment is one about the mirror image of the point.
            let moved = cross(sub(plane.mirror_point(whole.about_mm), whole.about_mm), mirrored);
            let turned = plane.mirror_moment(whole.moment_nmm);
            whole.moment_nmm = std::array::from_fn(|d| whole.moment_nmm[d] + turned[d] + moved[d]);
            whole.force_n = std::array::from_fn(|d| whole.force_n[d] + mirrored[d]);
            whole.points_active *= 2;
            whole.area_mm2 *= 2.0;
        }
        whole
    }
}

/// The node every probe reads: the nearest one.
pub fn probe_sites(mesh: &Mesh, probes: &[Probe]) -> BTreeMap<String, ProbeSite> {
    probes
        .iter()
        .filter_map(|probe| {
            let (node, distance_mm) = mesh.nearest_node(probe.at)?;
            Some((probe.name.clone(), ProbeSite { node, at: mesh.nodes[node], distance_mm }))
        })
        .collect()
}

fn one() -> usize {
    1
}

fn is_one(images: &usize) -> bool {
    *images == 1
}

fn cavities(problem: &Problem, state: &State<'_>) -> Result<BTreeMap<String, CavitySummary>, PostError> {
    let of = |(cavity, pressure): (&Cavity, &Pressure)| {
        let volume_mm3 = measures::volume(problem, cavity, state.displacement)?;
        Ok((cavity.name.clone(), CavitySummary { pressure_kpa: pressure.kpa(), volume_mm3 }))
    };
    problem.cavities.iter().zip(state.cavity_pressures).map(of).collect()
}
