//! The page: its elements, into which the modules of `assets/js` draw.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::assets;
use crate::comparison;
use crate::controls::{options, stage, transport};
use crate::numbers::thousands;
use crate::report::Report;
use crate::results::results;
use crate::sensitivity::sensitivity;
use crate::tables::{exactness, inputs, notices, status_text};

/// Nothing may be loaded from anywhere: everything is in the page itself.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline' data:; style-src 'unsafe-inline'; img-src data: blob:; \
                      base-uri 'none'; form-action 'none'";

/// The button between light and dark.
pub(crate) const MOON: &str = r#"<svg viewBox="0 0 24 24" aria-hidden="true"><path d="M12 3a9 9 0 1 0 0 18zm0-1a10 10 0 1 1 0 20 10 10 0 0 1 0-20z"/></svg>"#;

/// The whole text of the page; `data` is the JSON that the modules read.
pub fn html(report: &Report<'_>, data: &str) -> String {
    let title = if report.title.is_empty() { report.about } else { report.title };
    let plots = format!("Plots against {}", report.parameter());
    let body = html! {
        (masthead(report, title))
        (notices(report))
        noscript { p .notice { "The three-dimensional view and the plots need JavaScript. The tables below do not." } }
        main {
            div .dashboard {
                (viewer(report))
                section #plots .plots aria-label=(plots) {}
            }
            // Plots for which there is no room beside the view.
            section #more-plots .plots .more-plots aria-label={ (plots) ", continued" } hidden {}
            (results(report))
            (exactness(report))
            (comparison::section(report))
            (sensitivity(report))
            (inputs(report))
        }
    };
    document(&format!("{title} – pneuflex"), &body, data, "main")
}

/// A whole page: its body, the JSON that the modules read, and the module that is begun with.
pub(crate) fn document(title: &str, body: &Markup, data: &str, module: &str) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                meta name="color-scheme" content="light dark";
                title { (title) }
                style { (PreEscaped(assets::STYLE)) }
                script type="importmap" { (PreEscaped(assets::import_map())) }
            }
            body {
                (body)
                footer {
                    p { "Written by pneuflex. This page needs no network." }
                    details { summary { "Licence of three.js, which draws the view" } pre { (assets::LICENCES) } }
                }
                script #report-data type="application/json" { (PreEscaped(data)) }
                script type="module" { (PreEscaped(format!("import \"pneuflex/{module}\";"))) }
            }
        }
    };
    page.into_string()
}

fn masthead(report: &Report<'_>, title: &str) -> Markup {
    let summary = report.summary;
    let reached = summary.reached().last().map(|(time, _)| format!(" · computed to {}", report.words(time)));
    html! {
        header .masthead {
            div .titles {
                h1 { (title) }
                p {
                    (report.about)
                    " · " (thousands(summary.mesh.elements)) " elements " (summary.mesh.element)
                    " · " (thousands(summary.mesh.unknowns)) " unknowns" @if let Some(reached) = reached { (reached) }
                }
            }
            p .status .bad[!summary.is_converged() && !summary.is_past_limit()] { (status_text(summary)) }
            button #theme .icon type="button" aria-label="Light or dark" title="Light or dark" { (PreEscaped(MOON)) }
        }
    }
}

fn viewer(report: &Report<'_>) -> Markup {
    html! {
        section .viewer aria-label={ "The deformed " (report.noun()) } {
            @if report.states.is_some() { (stage(report.noun(), true)) } @else {
                p .notice {
                    "There is no view of the deformed " (report.noun()) ": the run wrote no fields (" code { "output.fields = false" }
                    "). Run the case with " code { "--set output.fields=true" } " to have it."
                }
            }
            (transport(report))
            @if report.states.is_some() { (options(report)) }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::inputs::groups;
    use crate::report::Report;
    use crate::summary::Summary;
    use crate::testing::{summary_json, two_chambers};
    use pneuflex_mesh::Actuator;
    use pneuflex_model::{Case, Clock, Formulation, Obstacle, Problem, Shape};
    use serde_json::json;

    fn page(title: &str, change: impl Fn(&mut serde_json::Value)) -> String {
        page_of(two_chambers(Formulation::Hex8Sri), title, change)
    }

    /// The body in the data of a page.
    fn body_of(html: &str) -> serde_json::Value {
        let (_, data) = html.split_once("id=\"report-data\" type=\"application/json\">").unwrap();
        let data: serde_json::Value = serde_json::from_str(data.split_once("</script>").unwrap().0).unwrap();
        data["body"].clone()
    }

    fn page_of(problem: Problem, title: &str, change: impl Fn(&mut serde_json::Value)) -> String {
        let case: Case = serde_json::from_value(json!({
            "title": title, "load": {"pressure_kpa": [5.0]}, "probe": [{"name": "<i>tip", "at": [18, 0, 0]}],
            "actuator": serde_json::to_value(Actuator::two_chambers()).unwrap()
        }))
        .unwrap();
        let mut summary = summary_json(&[5.0]);
        change(&mut summary);
        let summary: Summary = serde_json::from_value(summary).unwrap();
        let u = vec![[0.25; 3]; problem.mesh.num_nodes()];
        let nodes = vec![0.0; problem.mesh.num_nodes()];
        let state = crate::state::State {
            time: 5.0,
            displacement: u,
            von_mises: nodes.clone(),
            stress: vec![[0.0; 6]; nodes.len()],
            contact_pressure: nodes,
        };
        let report = Report {
            title: &case.title,
            about: "2 chambers",
            inputs: &groups(&case),
            problem: &problem,
            summary: &summary,
            states: Some(&[state]),
        };
        crate::render(&report).unwrap()
    }

    #[test]
    fn what_changes_a_result_is_a_table_and_reasons_are_said() {
        let html = page("", |summary| {
            summary["gradients"] = json!([{
                "of": "end_face_angle_deg", "pressure_kpa": 5.0, "value": 1.75,
                "derivatives": [
                    {"by": "actuator.gap", "value": 2.0, "unit": "mm", "derivative": -0.125, "per_percent": -0.0025},
                    {"by": "material.jm", "value": 40.0, "unit": "", "derivative": 0.5, "per_percent": 0.2},
                ],
                "without": [{"by": "actuator.cavity_floor", "why": "one <plane>"}],
            }]);
        });
        for words in [
            "What changes <code>end_face_angle_deg</code> most",
            "It is 1.75 at 5 kPa.",
            "−0.125 <span class=\"unit\">per mm</span>",
            "<td>−0.0025</td>",
            "<code>actuator.cavity_floor</code>: one &lt;plane&gt;.",
        ] {
            assert!(html.contains(words), "{words}");
        }
        assert!(!page("", |_| ()).contains("What changes"));
    }

    #[test]
    fn text_of_the_user_never_becomes_markup() {
        let hostile = "</script><b>bold</b><!-- \" & '";
        let html = page(hostile, |summary| {
            summary["failure"] = hostile.into();
            summary["status"] = "not-converged".into();
            summary["warnings"] = json!([{"kind": "unstable", "message": hostile, "advice": hostile}]);
        });
        assert!(!html.contains("<b>") && !html.contains("<i>tip") && !html.contains("<!-- "));
        assert!(html.contains("&lt;/script&gt;&lt;b&gt;bold"));
        // Three scripts: the import map, the data, the start.
        assert_eq!(html.matches("</script>").count(), 3);
        let data = html.split("application/json\">").nth(1).unwrap().split("</script>").next().unwrap();
        let data: serde_json::Value = serde_json::from_str(data).unwrap();
        assert_eq!(data["title"], hostile);
    }

    #[test]
    fn estimated_errors_have_a_table_or_a_reason() {
        assert!(!page("t", |_| ()).contains("How exact it is"));
        let html = page("t", |summary| {
            let errors = json!({"tip_displacement_mm": {"value": 0.25, "error": -0.0125, "percent": -4.76}});
            summary["error_estimate"] = json!({"pressure_kpa": 5.0, "unknowns": 12345, "errors": errors});
        });
        for part in ["How exact it is at 5 kPa", "tip_displacement_mm", ">0.25<", ">−0.0125<", ">−4.8<", "12,345"] {
            assert!(html.contains(part), "{part}");
        }
        let why = |summary: &mut serde_json::Value| summary["error_estimate"] = json!({"why_not": "<b>so</b>"});
        assert!(page("t", why).contains("Errors were not estimated: &lt;b&gt;so&lt;/b&gt;."));
    }

    #[test]
    fn a_run_that_failed_says_so_before_anything_else() {
        let html = page("t", |summary| {
            summary["status"] = "not-converged".into();
            summary["failure"] = "the load step became too small".into();
            summary["failure_reason"] = json!({"kind": "not-converged", "advice": "try smaller steps"});
        });
        let (before, _) = html.split_once("<main>").unwrap();
        assert!(before.contains("try smaller steps."));
        assert!(before.contains("The run did not converge") && before.contains("The load step became too small."));
        assert!(!page("t", |_| ()).contains("class=\"notice failure\""));
    }

    #[test]
    fn the_page_of_a_model_speaks_of_time_and_says_what_is_not_there() {
        let mut problem = two_chambers(Formulation::Hex8Sri);
        problem.clock = Clock::Steps;
        let mut summary = summary_json(&[0.5, 2.0]);
        summary["status"] = "not-converged".into();
        summary["warnings"] = json!([{"time": 0.5, "message": "careful"}]);
        summary["steps"][0]["time"] = 0.5.into();
        summary["steps"][0].as_object_mut().unwrap().remove("end_face_angle_deg");
        summary["steps"][0]["reactions"] = json!({"wall": [0.00012, 0.0, 0.0]});
        summary["steps"][1] = json!({"time": 2.0, "pressure_kpa": 2.0, "converged": false, "iterations": 9});
        let summary: Summary = serde_json::from_value(summary).unwrap();
        let report =
            Report { title: "", about: "part.inp", inputs: &[], problem: &problem, summary: &summary, states: None };
        let html = crate::render(&report).unwrap();
        assert!(html.contains("<h1>part.inp</h1>") && html.contains("computed to time 0.5"));
        assert!(
            html.contains("up to <strong>time 0.5</strong>") && html.contains("<strong>time 0.5: </strong>careful.")
        );
        assert!(html.contains("Results at the computed times") && html.contains("aria-label=\"Plots against time\""));
        assert!(html.contains("0.000120, 0.000000, 0.000000") && html.contains(">not reached<"));
        let (before, _) = html.split_once("report-data").unwrap();
        let shown = before.split("<main>").nth(1).unwrap();
        assert!(!shown.contains("bending") && !shown.contains("NaN") && !shown.contains("actuator"));
    }

    #[test]
    fn the_page_holds_obstacles_and_what_presses_on_them() {
        let force = |summary: &mut serde_json::Value| {
            summary["steps"][0]["obstacles"] = json!({"<b>ball": {"force_n": [0.0, 0.0, -1.0], "area_mm2": 3.0}});
        };
        let none = page("t", force);
        assert!(!none.contains("data-obstacle") && body_of(&none)["obstacles"].is_null());

        let mut problem = two_chambers(Formulation::Hex8Sri);
        let shape = Shape::Sphere { centre: [9.0, 0.0, -8.0], radius: 5.0, is_hollow: false };
        let ball = Obstacle {
            name: "<b>ball".into(),
            shape,
            facets: Vec::new(),
            stiffness: 1.0,
            motion: None,
            report_force: true,
            penetration_tolerance: None,
            interference_until: None,
        };
        problem.obstacles.push(ball);
        let html = page_of(problem, "t", force);
        assert!(html.contains("data-obstacle=\"0\"") && !html.contains("<b>ball"));
        let body = body_of(&html);
        let (drawn, origin) = (&body["obstacles"][0], &body["origin"]);
        let place = [9.0, 0.0, -8.0];
        let relative: [f64; 3] = std::array::from_fn(|d| place[d] - origin[d].as_f64().unwrap());
        assert_eq!(
            (&drawn["name"], &drawn["shape"], &drawn["mirrored"]),
            (&json!("<b>ball"), &json!("sphere"), &json!([false, false, false]))
        );
        assert_eq!((&drawn["centre"], &drawn["size"]), (&json!(relative), &json!([10.0, 10.0, 10.0])));
        assert!(html.contains("force on it x, y, z") && html.contains("0.000, 0.000, −1.000"));
    }

    #[test]
    fn the_page_is_the_same_every_time_and_asks_for_nothing() {
        let html = page("t", |_| ());
        assert_eq!(html, page("t", |_| ()));
        assert!(!html.contains("NaN"));
        let outside = html.replace("http-equiv", "").replace("http://www.w3.org", "");
        assert!(!outside.contains("http:") && !outside.contains("https:") && !outside.contains("src=\"/"));
    }
}
