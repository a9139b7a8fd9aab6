//! How often estimates are right.

use std::collections::BTreeMap;

use serde::Serialize;

/// An estimate is right if the error is at most so many times as large, and at least that part of it.
const FACTOR: f64 = 2.0;

/// Errors below this, percent, may be the difference of larger ones, which happen to cancel; and the mesh that they are measured against has
/// some of that size, too.
const LARGE: f64 = 2.0;

/// `estimates.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Record {
    program: &'static str,
    version: &'static str,
    /// Day of the run, UTC.
    date: String,
    seed: u64,
    designs: Vec<OfDesign>,
}

/// A design.
#[derive(Clone, Debug, Serialize)]
pub struct OfDesign {
    /// Its number among those of the seed.
    pub design: usize,
    /// Number of chambers.
    pub chambers: usize,
    /// The meshes.
    pub meshes: Vec<OfMesh>,
}

/// A design on a mesh, at its last pressure.
#[derive(Clone, Debug, Serialize)]
pub struct OfMesh {
    /// Its resolution.
    pub mesh: &'static str,
    /// Seconds of the run, and of the estimate, on one thread.
    pub run_seconds: f64,
    /// The same of the estimate.
    pub estimate_seconds: f64,
    /// Unknowns of the estimate's mesh.
    pub unknowns: usize,
    /// Whether walls touch.
    pub touching: bool,
    /// The quantities.
    pub quantities: Vec<Compared>,
}

/// The error of a quantity, percent: positive where its value is too large.
#[derive(Clone, Debug, Serialize)]
pub struct Compared {
    /// The quantity.
    pub key: String,
    /// Against the finest mesh.
    pub error: f64,
    /// As it was estimated.
    pub estimated: f64,
}

impl Compared {
    fn is_large(&self) -> bool {
        self.error.abs() > LARGE
    }

    /// Whether the estimate has the sign of the error and is right to the factor.
    fn is_right(&self) -> bool {
        let ratio = self.error / self.estimated;
        (1.0 / FACTOR..=FACTOR).contains(&ratio)
    }

    /// Whether the error is not more than the factor times the estimate, whatever its sign.
    fn is_bounded(&self) -> bool {
        self.error.abs() <= FACTOR * self.estimated.abs()
    }
}

impl Record {
    /// Of designs.
    pub fn new(seed: u64, designs: Vec<OfDesign>) -> Self {
        Self {
            program: "pneuflex",
            version: env!("CARGO_PKG_VERSION"),
            date: time::OffsetDateTime::now_utc().date().to_string(),
            seed,
            designs,
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.designs.is_empty()
    }

    /// The table of the guide.
    pub fn markdown(&self) -> String {
        let meshes: Vec<&OfMesh> = self.designs.iter().flat_map(|design| &design.meshes).collect();
        let mut by_key: BTreeMap<&str, Vec<&Compared>> = BTreeMap::new();
        for one in meshes.iter().flat_map(|mesh| &mesh.quantities) {
            by_key.entry(&one.key).or_default().push(one);
        }
        let touching = meshes.iter().filter(|mesh| mesh.touching).count();
        let mut ratios: Vec<f64> = meshes.iter().map(|mesh| mesh.estimate_seconds / mesh.run_seconds).collect();
        ratios.sort_by(f64::total_cmp);
        let median = ratios.get(ratios.len() / 2).copied().unwrap_or(f64::NAN);
        let mut text = format!(
            "{} random designs on two meshes each; walls touch in {touching} of {}. The estimate took {median:.1} times as long as the run \
             (median).\n\n| quantity | errors beyond {LARGE} % | of these estimated to a factor of {FACTOR}, with the right sign | all: error \
             at most {FACTOR} times the estimate |\n|---|---|---|---|\n",
            self.designs.len(),
            meshes.len(),
        );
        for (key, all) in by_key {
            let large: Vec<_> = all.iter().filter(|one| one.is_large()).collect();
            let right = large.iter().filter(|one| one.is_right()).count();
            let bounded = all.iter().filter(|one| one.is_bounded()).count();
            text += &format!("| `{key}` | {} of {} | {right} | {bounded} |\n", large.len(), all.len());
        }
        text
    }

    /// All numbers.
    ///
    /// # Errors
    /// A number that is not finite.
    pub fn json(&self) -> Result<String, String> {
        let text = serde_json::to_string_pretty(self).map_err(|e| e.to_string())?;
        if text.contains("null") { Err("a number is not finite".into()) } else { Ok(text + "\n") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_estimate_is_right_with_its_sign_and_to_the_factor() {
        let of = |error: f64, estimated: f64| Compared { key: String::new(), error, estimated };
        assert!(of(4.0, 2.1).is_right() && of(4.0, 7.9).is_right() && of(-3.0, -3.0).is_right());
        assert!(!of(4.0, 1.9).is_right() && !of(4.0, 8.1).is_right() && !of(4.0, -4.0).is_right());
        assert!(of(0.1, -2.0).is_bounded() && !of(5.0, 2.0).is_bounded());
        assert!(of(-3.0, 0.0).is_large() && !of(1.9, 0.0).is_large());
    }
}
