//! Statements with their numbers and verdicts, and `validation.json`.

use serde::Serialize;

use super::plan::{Body, Extent, Mesh};

/// Whether a statement holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Every bound is kept.
    Holds,
    /// Every bound is kept, but the paper's claim holds in part only; see the statement's limit.
    Limited,
    /// At least one bound is not kept.
    Fails,
}

/// A measured number and the bound it is held against, if it is.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Number {
    /// What was measured.
    pub name: String,
    /// On which body and mesh.
    pub mesh: String,
    /// The value.
    pub value: f64,
    /// Its unit; empty for a pure number.
    pub unit: &'static str,
    /// Its bound in words; left out for a number given for information.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bound: Option<String>,
    /// Whether it keeps the bound.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub is_kept: Option<bool>,
}

/// A statement of the paper, or about the method, with what was measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Statement {
    /// Short name that stays the same.
    pub id: &'static str,
    /// What is stated.
    pub text: String,
    /// What the paper says.
    pub claim: String,
    /// How the bounds were chosen.
    pub bound: String,
    /// What was measured.
    pub numbers: Vec<Number>,
    /// Whether all bounds are kept.
    pub verdict: Verdict,
    /// Which part of the claim does not hold, or not always.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub limit: String,
    /// What a reader should know.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub remark: String,
}

impl Statement {
    /// A statement without numbers. It fails until a bound is kept: nothing holds by having been left out.
    pub fn new(id: &'static str, text: &str, claim: &str, bound: &str) -> Self {
        Self {
            id,
            text: text.into(),
            claim: claim.into(),
            bound: bound.into(),
            numbers: Vec::new(),
            verdict: Verdict::Fails,
            limit: String::new(),
            remark: String::new(),
        }
    }

    /// Adds a number for information.
    pub fn note(&mut self, name: &str, on: &str, value: f64, unit: &'static str) {
        self.numbers.push(Number { name: name.into(), mesh: on.into(), value, unit, bound: None, is_kept: None });
    }

    /// Adds a number that must be no greater than a bound.
    pub fn at_most(&mut self, name: &str, on: &str, value: f64, bound: f64, unit: &'static str) {
        self.bounded(name, on, value, unit, format!("≤ {}", short(bound)), value <= bound);
    }

    /// Adds a number that must be no less than a bound.
    pub fn at_least(&mut self, name: &str, on: &str, value: f64, bound: f64, unit: &'static str) {
        self.bounded(name, on, value, unit, format!("≥ {}", short(bound)), value >= bound);
    }

    fn bounded(&mut self, name: &str, on: &str, value: f64, unit: &'static str, bound: String, is_kept: bool) {
        let (name, mesh) = (name.into(), on.into());
        self.numbers.push(Number { name, mesh, value, unit, bound: Some(bound), is_kept: Some(is_kept) });
        self.judge();
    }

    fn judge(&mut self) {
        let kept: Vec<bool> = self.numbers.iter().filter_map(|n| n.is_kept).collect();
        self.verdict = match !kept.is_empty() && kept.iter().all(|kept| *kept) {
            false => Verdict::Fails,
            true if self.limit.is_empty() => Verdict::Holds,
            true => Verdict::Limited,
        };
    }

    /// The same with a limit: it holds in part at the best.
    pub fn limit(mut self, text: &str) -> Self {
        self.limit = text.into();
        self.judge();
        self
    }

    /// The same with a remark.
    pub fn remark(self, text: &str) -> Self {
        Self { remark: text.into(), ..self }
    }
}

/// A bound without the noise of binary fractions.
fn short(bound: f64) -> String {
    let rounded: f64 = format!("{bound:.3e}").parse().unwrap_or(bound);
    if rounded != 0.0 && rounded.abs() < 1e-3 { format!("{rounded:e}") } else { rounded.to_string() }
}

/// Body and mesh in a few words.
pub fn on(body: Body, mesh: Mesh) -> String {
    format!("{}, {mesh}", body.name())
}

/// One length of the sensitivity study.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sensitivity {
    /// The length.
    pub name: String,
    /// Its value, mm.
    pub value_mm: f64,
    /// Angles of the end face with the length lowered and raised, degrees, by mesh; `None` where no equilibrium was found.
    pub angles_deg: Vec<SensitivityOn>,
}

/// Sensitivity on one mesh.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SensitivityOn {
    /// The mesh.
    pub mesh: String,
    /// With the length 10 % smaller.
    pub lowered: Option<f64>,
    /// With the length as it is.
    pub unchanged: f64,
    /// With the length 10 % greater.
    pub raised: Option<f64>,
}

impl SensitivityOn {
    /// Largest change, degrees; 0 if neither was solved.
    pub fn largest_change(&self) -> f64 {
        [self.lowered, self.raised].into_iter().flatten().map(|a| (a - self.unchanged).abs()).fold(0.0, f64::max)
    }
}

/// One high place of the von Mises stress.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Place {
    /// von Mises stress, MPa.
    pub von_mises_mpa: f64,
    /// Reference position, mm.
    pub at: [f64; 3],
    /// Where that is.
    pub region: String,
}

/// High places of one state.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Places {
    /// Body and mesh.
    pub mesh: String,
    /// From the highest down.
    pub places: Vec<Place>,
}

/// RMS distance of measured points from the computed shapes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeasuredDistance {
    /// Pressure of the points, kPa.
    pub pressure_kpa: f64,
    /// Number of points.
    pub points: usize,
    /// Distance from the multiple-point shape, mm.
    pub multiple_point_mm: f64,
    /// Distance from the single-point shape, mm.
    pub single_point_mm: f64,
}

/// `validation.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Record {
    /// Always "pneuflex".
    pub program: &'static str,
    /// Version of the program.
    pub version: String,
    /// Day of the run, UTC.
    pub date: String,
    /// `full` or `quick`.
    pub extent: &'static str,
    /// Meshes used, by what for.
    pub resolution: Vec<String>,
    /// Seconds taken by the runs.
    pub seconds: f64,
    /// Statements with their verdicts.
    pub statements: Vec<Statement>,
    /// Highest places of the von Mises stress.
    pub highest_stresses: Vec<Places>,
    /// Parameters of the rod with their fit errors, by mesh.
    pub rods: Vec<serde_json::Value>,
    /// Sensitivity of the 50 kPa angle.
    pub sensitivities: Vec<Sensitivity>,
    /// Distances of measured points, if any were given.
    pub measured: Vec<MeasuredDistance>,
    /// What was not possible.
    pub missing: Vec<String>,
}

impl Record {
    /// Whether no statement fails.
    pub fn holds(&self) -> bool {
        self.statements.iter().all(|s| s.verdict != Verdict::Fails)
    }

    /// What the meshes of an extent are for.
    pub fn resolution(extent: Extent) -> Vec<String> {
        let list = |meshes: Vec<Mesh>| meshes.iter().map(Mesh::to_string).collect::<Vec<_>>().join(", ");
        vec![
            format!("two chambers: {}", list(extent.meshes(Body::TwoChambers))),
            format!("actuator: {}", list(extent.meshes(Body::Actuator))),
            format!("penetration against face size, two chambers: {}", list(extent.face_sizes())),
            format!("sensitivities, actuator: {}", extent.sensitivity_mesh()),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_statement_holds_only_if_every_bound_is_kept() {
        let mut statement = Statement::new("a", "", "", "");
        statement.note("angle", "", 3.0, "°");
        assert_eq!(statement.verdict, Verdict::Fails, "nothing was held against a bound");
        statement.at_most("x", "", 1.0, 1.0, "");
        assert_eq!(statement.verdict, Verdict::Holds);
        statement.at_least("y", "", f64::NAN, 0.0, "");
        assert_eq!(statement.verdict, Verdict::Fails, "an undefined number keeps no bound");
        statement.at_most("z", "", 0.0, 1.0, "");
        assert_eq!(statement.verdict, Verdict::Fails);
        assert_eq!(statement.limit("in part").verdict, Verdict::Fails);
    }

    #[test]
    fn a_limit_is_no_failure_and_no_success() {
        let mut statement = Statement::new("a", "", "", "").limit("in part");
        assert_eq!(statement.verdict, Verdict::Fails);
        statement.at_most("x", "", 0.5, 0.01 * 82.0, "");
        assert_eq!(statement.verdict, Verdict::Limited);
        assert_eq!(statement.numbers[0].bound.as_deref(), Some("≤ 0.82"));
        assert_eq!((short(1e-9), short(0.0), short(3.0)), ("1e-9".into(), "0".into(), "3".into()));
    }
}
