//! What was measured, as a table and as `docs/accuracy.json`.

use pneuflex::accuracy::{Bounds, Fineness};
use pneuflex::model::Resolution;
use serde::Serialize;

use super::kinds::Kind;
use super::measure::{Errors, Measured, Mesh, Solved};

/// `accuracy.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Record {
    /// Always "pneuflex".
    program: &'static str,
    /// Its version.
    version: &'static str,
    /// Day of the run, UTC.
    date: String,
    /// `full` or `quick`.
    extent: &'static str,
    /// Seconds taken by all runs together.
    seconds: f64,
    /// One per kind of design.
    kinds: Vec<OfKind>,
}

/// A kind of design.
#[derive(Clone, Debug, Serialize)]
struct OfKind {
    name: &'static str,
    what: &'static str,
    /// The mesh that the others are compared with.
    compared_with: &'static str,
    /// Results on that mesh.
    right: Vec<Measured>,
    /// The other meshes.
    meshes: Vec<OfMesh>,
}

/// A kind on a mesh.
#[derive(Clone, Debug, Serialize)]
struct OfMesh {
    mesh: &'static str,
    unknowns: usize,
    seconds: f64,
    /// Parameters in which the program finds the design unlike the measured ones, and warns.
    outside: Vec<&'static str>,
    /// Errors in percent, one per pressure.
    errors: Vec<Errors>,
}

impl OfMesh {
    /// The largest errors over all pressures: angles and tip, growth of the cavities, stress.
    fn worst(&self) -> Bounds {
        // An undefined error is the largest of all.
        let most = |of: &dyn Fn(&Errors) -> f64| {
            self.errors
                .iter()
                .map(|e| of(e).abs())
                .fold(0.0, |most: f64, error| if most.is_nan() || error <= most { most } else { error })
        };
        Bounds {
            displacement: [most(&|e| e.end_face_angle), most(&|e| e.chord_angle), most(&|e| e.tip)]
                .into_iter()
                .fold(0.0, |most, error| if most.is_nan() || error <= most { most } else { error }),
            volume_change: most(&|e| e.volume_change),
            stress: most(&|e| e.von_mises_p99),
        }
    }

    fn cell(&self) -> String {
        let Bounds { displacement, volume_change, stress } = self.worst();
        let mark = if self.outside.is_empty() { "" } else { " (warned)" };
        format!("{} / {} / {}{mark}", digits(displacement), digits(volume_change), digits(stress))
    }
}

/// Two digits, as errors deserve.
fn digits(x: f64) -> String {
    if x < 9.95 { format!("{x:.1}") } else { format!("{x:.0}") }
}

const RESOLUTIONS: [(Resolution, Fineness); 3] = [
    (Resolution::Draft, Fineness::Draft),
    (Resolution::Standard, Fineness::Standard),
    (Resolution::Fine, Fineness::Fine),
];

impl Record {
    /// From the solutions of every kind.
    ///
    /// # Errors
    /// What could not be solved.
    pub fn new<'a, F>(quick: bool, seconds: f64, kinds: impl Iterator<Item = (&'a Kind, F)>) -> Result<Self, String>
    where
        F: Fn(&Kind, Mesh) -> Result<Option<Solved>, String>,
    {
        let mut all = Vec::new();
        for (kind, find) in kinds {
            let mut solved = Vec::new();
            for mesh in Mesh::ALL {
                solved.extend(find(kind, mesh)?.map(|found| (mesh, found)));
            }
            let mut solved = solved.into_iter();
            let (best, right) = solved.next().ok_or_else(|| format!("{}: nothing was solved", kind.name))?;
            let meshes = solved.map(|(mesh, found)| OfMesh {
                mesh: mesh.name(),
                unknowns: found.unknowns,
                seconds: found.seconds,
                outside: found.outside,
                errors: found.states.iter().zip(&right.states).map(|(state, right)| state.errors(right)).collect(),
            });
            let meshes = meshes.collect();
            all.push(OfKind {
                name: kind.name,
                what: kind.what,
                compared_with: best.name(),
                right: right.states,
                meshes,
            });
        }
        Ok(Self {
            program: "pneuflex",
            version: env!("CARGO_PKG_VERSION"),
            date: time::OffsetDateTime::now_utc().date().to_string(),
            extent: if quick { "quick" } else { "full" },
            seconds,
            kinds: all,
        })
    }

    /// Errors beyond what the program says about a mesh, where it does not warn.
    pub fn broken(&self) -> Vec<String> {
        let mut broken = Vec::new();
        for kind in &self.kinds {
            for (resolution, fineness) in RESOLUTIONS {
                let name = Mesh::Of(resolution).name();
                let silent = kind.meshes.iter().filter(|mesh| mesh.mesh == name && mesh.outside.is_empty());
                let (bounds, worst) = (fineness.bounds(), silent.map(OfMesh::worst));
                broken.extend(
                    worst
                        .filter(|worst| {
                            // Not "above": an undefined error keeps no bound.
                            !(worst.displacement <= bounds.displacement
                                && worst.volume_change <= bounds.volume_change
                                && worst.stress <= bounds.stress)
                        })
                        .map(|worst| format!("{} on {name}: {worst}; the program says {bounds}", kind.name)),
                );
            }
        }
        broken
    }

    /// The table of the guide.
    pub fn markdown(&self) -> String {
        let mut text = String::from("| design | draft | standard | fine |\n|---|---|---|---|\n");
        for kind in &self.kinds {
            let cells = RESOLUTIONS.map(|(resolution, _)| {
                let mesh = kind.meshes.iter().find(|mesh| mesh.mesh == Mesh::Of(resolution).name());
                mesh.map_or_else(|| "–".to_owned(), OfMesh::cell)
            });
            text += &format!("| {}: {} | {} |\n", kind.name, kind.what, cells.join(" | "));
        }
        let bounds = RESOLUTIONS.map(|(_, fineness)| {
            let Bounds { displacement, volume_change, stress } = fineness.bounds();
            format!("**{displacement} / {volume_change} / {stress}**")
        });
        text + &format!("| **at the most, without a warning** | {} |\n", bounds.join(" | "))
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

/// Marks of what is written by the command.
pub const MARKS: [&str; 2] = ["<!-- made by cargo xtask accuracy --docs -->\n", "<!-- until here -->\n"];

/// A page with a table between its marks replaced.
///
/// # Errors
/// A page without the marks.
pub fn between_marks(page: &str, [first, last]: [&str; 2], table: &str) -> Result<String, String> {
    let missing = || format!("the page has not the marks {first:?} and {last:?}");
    let (head, rest) = page.split_once(first).ok_or_else(missing)?;
    let (_, tail) = rest.split_once(last).ok_or_else(missing)?;
    Ok(format!("{head}{first}\n{table}\n{last}{tail}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_mesh(outside: Vec<&'static str>, percent: f64) -> OfMesh {
        let errors = Errors {
            end_face_angle: percent,
            chord_angle: 0.0,
            tip: 0.0,
            volume_change: 0.0,
            von_mises_p99: 0.0,
            contact_area: None,
        };
        OfMesh { mesh: "draft", unknowns: 1, seconds: 0.0, outside, errors: vec![errors] }
    }

    fn record(mesh: OfMesh) -> Record {
        let kind = OfKind { name: "a", what: "b", compared_with: "fine", right: Vec::new(), meshes: vec![mesh] };
        let (version, date) = ("0", String::new());
        Record { program: "pneuflex", version, date, extent: "quick", seconds: 0.0, kinds: vec![kind] }
    }

    #[test]
    fn an_error_beyond_what_is_said_needs_a_warning() {
        assert!(record(of_mesh(vec![], -9.0)).broken().is_empty());
        assert_eq!(record(of_mesh(vec![], -90.0)).broken().len(), 1);
        assert_eq!(record(of_mesh(vec![], f64::NAN)).broken().len(), 1);
        assert!(record(of_mesh(vec!["base"], -90.0)).broken().is_empty());
        assert!(record(of_mesh(vec![], f64::NAN)).json().is_err());
    }

    #[test]
    fn the_table_takes_the_place_of_the_last_one() {
        let page = format!("a\n{}old\n{}b\n", MARKS[0], MARKS[1]);
        let once = between_marks(&page, MARKS, "new\n").unwrap();
        assert_eq!(once, format!("a\n{}\nnew\n\n{}b\n", MARKS[0], MARKS[1]));
        assert_eq!(between_marks(&once, MARKS, "new\n").unwrap(), once);
        assert!(between_marks("a", MARKS, "b").is_err());
    }
}
