//! How a design's run ended, judged from what the program left behind.

use serde_json::Value;

/// Walls that pass through each other further than this share of the thinnest wall are penetration.
const PENETRATION_SHARE: f64 = 0.1;

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// Every pressure was reached.
    Converged,
    /// The run ended early for a reason that lies in the design: its name in `summary.json`.
    Physical(String),
    /// Anything else, in words.
    Failed(String),
}

/// What a process left behind.
#[derive(Clone, Debug, Default)]
pub struct Remains {
    /// Exit code; `None` after a signal or when the time was over.
    pub code: Option<i32>,
    /// Whether the time was over.
    pub is_late: bool,
    /// Standard error.
    pub messages: String,
    /// `summary.json`, if there is one.
    pub summary: Option<String>,
    /// Thickness of the thinnest wall, mm.
    pub thinnest_wall: f64,
}

/// Judges a run: panics, numbers that are not finite, hangs, penetration without a warning and failures without a physical
/// reason are failures.
pub fn judge(remains: &Remains) -> Outcome {
    let failed = |what: String| Outcome::Failed(what);
    if remains.is_late {
        return failed("time limit".into());
    }
    if remains.messages.contains("panicked") {
        return failed("panic".into());
    }
    let Some(code) = remains.code else { return failed("killed by a signal".into()) };
    let Some(text) = &remains.summary else { return failed(format!("exit code {code} without a summary")) };
    if text.contains("NaN") || text.contains("inf") && !text.contains("info") || text.contains("null") {
        return failed("a number that is not finite".into());
    }
    let Ok(summary) = serde_json::from_str::<Value>(text) else { return failed("damaged summary".into()) };
    if let Some(penetration) = silent_penetration(&summary, remains.thinnest_wall) {
        return failed(format!("penetration of {penetration:.3} mm without a warning"));
    }
    match code {
        0 if summary["status"] == "converged" => Outcome::Converged,
        3 => {
            let reason = &summary["failure_reason"];
            let kind = reason["kind"].as_str().unwrap_or("unexplained");
            if reason["is_physical"] == true {
                Outcome::Physical(kind.into())
            } else {
                failed(format!("{kind}: {}", summary["failure"].as_str().unwrap_or_default()))
            }
        }
        _ => failed(format!("exit code {code}")),
    }
}

fn silent_penetration(summary: &Value, thinnest_wall: f64) -> Option<f64> {
    let warned = summary["warnings"].as_array().is_some_and(|all| all.iter().any(|w| w["kind"] == "penetration"));
    let steps = summary["steps"].as_array()?.iter();
    let deepest = steps.filter_map(|step| step["contact"]["max_penetration_mm"].as_f64()).fold(0.0, f64::max);
    (deepest > PENETRATION_SHARE * thinnest_wall && !warned).then_some(deepest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn remains(code: i32, summary: &str) -> Remains {
        Remains { code: Some(code), summary: Some(summary.into()), thinnest_wall: 1.0, ..Remains::default() }
    }

    #[test]
    fn what_counts_as_what() {
        let is_failure = |remains: &Remains| matches!(judge(remains), Outcome::Failed(_));
        assert_eq!(judge(&remains(0, r#"{"status": "converged", "steps": []}"#)), Outcome::Converged);
        let physical =
            r#"{"failure": "x", "failure_reason": {"kind": "instability", "is_physical": true}, "steps": []}"#;
        assert_eq!(judge(&remains(3, physical)), Outcome::Physical("instability".into()));
        assert!(is_failure(&remains(3, r#"{"failure": "x", "steps": []}"#)));
        assert!(is_failure(&remains(0, r#"{"status": "running", "steps": []}"#)));
        assert!(is_failure(&remains(101, r#"{"status": "converged", "steps": []}"#)));
        assert!(is_failure(&Remains { is_late: true, ..remains(0, r#"{"status": "converged"}"#) }));
        assert!(is_failure(&Remains {
            messages: "thread panicked at".into(),
            ..remains(0, r#"{"status": "converged"}"#)
        }));
        assert!(is_failure(&Remains { code: None, ..remains(0, "{}") }));
        assert!(is_failure(&remains(0, r#"{"status": "converged", "tip": null}"#)));
        let deep = |warnings: &str| {
            format!(
                r#"{{"status": "converged", "steps": [{{"contact": {{"max_penetration_mm": 0.2}}}}], "warnings": {warnings}}}"#
            )
        };
        assert!(is_failure(&remains(0, &deep("[]"))));
        assert_eq!(judge(&remains(0, &deep(r#"[{"kind": "penetration"}]"#))), Outcome::Converged);
    }
}
