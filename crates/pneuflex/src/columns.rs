//! The numbers of a state as a flat row: the columns of `pneuflex table`, of sweeps and of what `pneuflex find` looks for.

use pneuflex_post::load_step::LoadStepSummary;
use pneuflex_post::measures;
use pneuflex_post::summary::StepSummary;

use crate::analysis::Analysis;
use crate::pairs::Pairs;
use crate::study::Study;

/// What the tip of an actuator is told by.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tip {
    /// Length of the actuator at rest, mm, if it is one: the tip is at (length, 0, 0).
    pub length: Option<f64>,
    /// Position of the probe called `tip`, mm.
    pub probe_at: Option<[f64; 3]>,
}

impl Tip {
    /// That of a study.
    pub fn of(study: &Study) -> Self {
        let actuator = study.case().map(|case| &case.actuator);
        let actuator = actuator.or_else(|| study.model().and_then(|model| model.actuator.as_ref()));
        let probes = study.case().map(|case| &case.probes).or_else(|| study.model().map(|model| &model.probes));
        let probe = probes.into_iter().flatten().find(|probe| probe.name == "tip");
        Self { length: actuator.map(|actuator| actuator.length()), probe_at: probe.map(|probe| probe.at) }
    }

    /// That of an analysis, where the mesh has the tip.
    pub(crate) fn of_analysis(analysis: &Analysis) -> Self {
        let problem = &analysis.problem;
        let end = measures::centreline_nodes(problem).last().map(|node| problem.mesh.nodes[*node as usize][0]);
        let probe = analysis.probes.iter().find(|probe| probe.name == "tip");
        Self { length: end.filter(|_| analysis.actuator().is_some()), probe_at: probe.map(|probe| probe.at) }
    }

    /// Displacement of the tip, mm: of an actuator the end of its bottom centreline, of another body the probe `tip`.
    fn displacement(&self, state: &LoadStepSummary) -> Option<[f64; 3]> {
        let probe = state.probes.get("tip").copied();
        let (Some(length), Some([x, z])) = (self.length, state.centreline.last()) else { return probe };
        let is_there = |at: [f64; 3]| {
            let [dx, dy, dz] = [at[0] - length, at[1], at[2]];
            (dx * dx + dy * dy + dz * dz).sqrt() < 1e-9
        };
        match probe {
            Some(probe) if self.probe_at.is_some_and(is_there) => Some(probe),
            // In the plane y = 0, in which the centreline lies.
            _ => Some([x - length, 0.0, *z]),
        }
    }
}

/// The numbers of a state by the names of their columns, units in the names.
pub fn columns(state: &StepSummary, tip: &Tip) -> Pairs {
    row(&state.plain(), Some(state), tip)
}

/// Those of a load step between requested positions: all but the ones that take stresses or a sampling of the walls.
pub fn columns_of_load_step(step: &LoadStepSummary, tip: &Tip) -> Pairs {
    row(step, None, tip)
}

fn row(state: &LoadStepSummary, whole: Option<&StepSummary>, tip: &Tip) -> Pairs {
    let mut found = Pairs::default();
    for (name, value) in [
        ("time", state.time),
        ("pressure_kpa", Some(state.pressure_kpa)),
        ("end_face_angle_deg", state.end_face_angle_deg),
        ("chord_angle_deg", state.chord_angle_deg()),
        ("cavity_volume_mm3", Some(state.cavity_volume_mm3)),
        ("max_von_mises_mpa", whole.map(|state| state.max_von_mises_mpa)),
        ("von_mises_p99_mpa", whole.map(|state| state.von_mises_p99_mpa)),
        ("strain_energy_mj", whole.map(|state| state.strain_energy_mj)),
        ("contact.area_mm2", Some(state.contact.area_mm2)),
        ("contact.max_penetration_mm", whole.map(|state| state.contact.max_penetration_mm)),
    ] {
        if let Some(value) = value {
            found.push(name, value);
        }
    }
    if let Some(state) = whole {
        found.0.push(("contact.gaps_in_contact".to_owned(), state.contact.gaps_in_contact.into()));
    }
    if let Some(gap) = whole.and_then(|state| state.contact.min_gap_mm) {
        found.push("contact.min_gap_mm", gap);
    }
    for (name, cavity) in &state.cavities {
        found.push(format!("cavity.{name}.pressure_kpa"), cavity.pressure_kpa);
        if let Some(volume) = cavity.volume_mm3 {
            found.push(format!("cavity.{name}.volume_mm3"), volume);
        }
    }
    let mut vector = |name: &str, vector: [f64; 3], unit: &str| {
        for (axis, value) in ["x", "y", "z"].iter().zip(vector) {
            found.push(format!("{name}.{axis}_{unit}"), value);
        }
    };
    vector("reaction", state.reaction_n, "n");
    if let Some(displacement) = tip.displacement(state) {
        vector("tip", displacement, "mm");
    }
    for (name, displacement) in &state.probes {
        vector(&format!("probe.{name}"), *displacement, "mm");
    }
    for (name, force) in &state.reactions {
        vector(&format!("reaction.{name}"), *force, "n");
    }
    for (name, obstacle) in &state.obstacles {
        vector(&format!("obstacle.{name}"), obstacle.force_n, "n");
    }
    if let Some(state) = whole {
        found.0.push(("iterations".to_owned(), state.iterations.into()));
        found.0.push(("load_steps".to_owned(), state.load_steps.into()));
    }
    found
}
