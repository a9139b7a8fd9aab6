//! The numbers of a state by which meshes are compared.

use pneuflex_mesh::vector::norm;
use pneuflex_model::Problem;
use pneuflex_post::summary::StepSummary;
use pneuflex_post::{PostError, measures};
use serde::Serializer;

/// A number of a state.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// Its key in files, which ends with the unit.
    pub key: String,
    /// What it is in words, with the unit.
    pub words: String,
    /// Whether it is a displacement or an angle.
    pub is_displacement: bool,
    /// Decimals in tables.
    pub decimals: usize,
    /// Its value.
    pub value: f64,
}

/// The body at rest, as far as quantities are changes from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// \[x, z\] of the end of the bottom centreline, mm; `None` for a body without one.
    tip: Option<[f64; 2]>,
    /// Volume of the cavities, mm³; zero without one that is closed.
    volume: f64,
}

impl Rest {
    /// That of a problem.
    ///
    /// # Errors
    /// What the volume of a cavity cannot be derived for.
    pub fn of(problem: &Problem) -> Result<Self, PostError> {
        let rest = vec![[0.0; 3]; problem.mesh.num_nodes()];
        let tip = measures::centreline(problem, &rest)?.last().copied();
        Ok(Self { tip, volume: measures::cavity_volume(problem, &rest)? })
    }

    /// The quantities of a state: angles, displacements of the tip and of probes, growth of the cavities, forces of a model's supports and on obstacles,
    /// strain energy, stress. Each is there on every mesh of a problem, or on none.
    pub fn quantities(&self, state: &StepSummary) -> Vec<Quantity> {
        let mut found = Vec::new();
        let mut add = |key: &str, words: &str, decimals, value| {
            let is_displacement = ["angle", "displacement"].iter().any(|kind| words.contains(kind));
            found.push(Quantity { key: key.into(), words: words.into(), is_displacement, decimals, value });
        };
        if let Some(angle) = state.end_face_angle_deg {
            add("end_face_angle_deg", "end face angle, deg", 3, angle);
        }
        if let (Some(angle), Some([x, z]), Some([x0, z0])) =
            (state.chord_angle_deg(), state.centreline.last(), self.tip)
        {
            add("chord_angle_deg", "chord angle, deg", 3, angle);
            add("tip_displacement_mm", "tip displacement, mm", 4, (x - x0).hypot(z - z0));
        }
        for (name, displacement) in &state.probes {
            add(&format!("probe_{name}_mm"), &format!("displacement of {name}, mm"), 4, norm(*displacement));
        }
        if self.volume != 0.0 {
            add("cavity_growth_mm3", "growth of cavities, mm3", 2, state.cavity_volume_mm3 - self.volume);
        }
        for (name, force) in &state.reactions {
            add(&format!("reaction_{name}_n"), &format!("force of {name}, N"), 4, norm(*force));
        }
        for (name, obstacle) in &state.obstacles {
            add(&format!("force_on_{name}_n"), &format!("force on {name}, N"), 4, norm(obstacle.force_n));
        }
        add("strain_energy_mj", "strain energy, mJ", 4, state.strain_energy_mj);
        add("von_mises_p99_mpa", "p99 von Mises, MPa", 5, state.von_mises_p99_mpa);
        found
    }
}

/// Quantities as entries of the object that they belong to.
///
/// # Errors
/// The serializer's.
pub(crate) fn by_key<S: Serializer>(quantities: &[Quantity], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(quantities.iter().map(|quantity| (&quantity.key, quantity.value)))
}
