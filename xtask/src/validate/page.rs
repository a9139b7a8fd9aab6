//! `index.html`: one page that needs nothing else.

use std::fmt::Write as _;

use super::Outcome;
use super::figures::Figure;
use super::record::{MeasuredDistance, Number, Places, Record, Sensitivity, Statement, Verdict};
use super::rods::RodResult;
use super::runner::seconds;
use super::solution::Solutions;

const STYLE: &str = include_str!("style.css");

/// The page.
///
/// # Errors
/// A drawing that cannot be written.
pub fn write(record: &Record, figures: &[Figure], rods: &[RodResult], solutions: &Solutions) -> Outcome<String> {
    let mut page = String::from("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
    page += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
    page += "<title>pneuflex validation</title>\n";
    let _ = write!(page, "<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n");
    head(&mut page, record);
    overview(&mut page, &record.statements);
    page += "<h2 id=\"figures\" class=\"page\">Figures</h2>\n";
    for figure in figures {
        draw(&mut page, figure)?;
        match figure.name.as_str() {
            "figure-15" => measured(&mut page, record),
            "figure-16" => parameters(&mut page, rods),
            "sensitivity" => lengths(&mut page, &record.sensitivities),
            _ => {}
        }
    }
    page += "<h2 id=\"stresses\" class=\"page\">The ten highest von Mises stresses at 35 kPa</h2>\n";
    page += "<p>Multiple-point contact, integration points at least 1.5 mm apart; positions at rest. At sharp re-entrant \
             edges the highest value grows without limit as the mesh is refined, and which edge leads may change.</p>\n";
    record.highest_stresses.iter().for_each(|places| stresses(&mut page, places));
    page += "<h2 id=\"statements\" class=\"page\">Statements and their numbers</h2>\n";
    record.statements.iter().for_each(|s| statement(&mut page, s));
    table_of_runs(&mut page, solutions);
    page += "</main>\n</body>\n</html>\n";
    Ok(page)
}

fn head(page: &mut String, record: &Record) {
    let count = |verdict| record.statements.iter().filter(|s| s.verdict == verdict).count();
    let _ = writeln!(
        page,
        "<h1>What of the paper is reproduced</h1>\n<p>Xu &amp; Liu, <cite>Effective enhanced model for a large deformable \
         soft pneumatic actuator</cite> (2020), figure by figure. pneuflex {}, {} run of {}; all runs together {}.</p>\n\
         <p><strong>Of {} statements {} hold, {} hold in part, {} fail.</strong></p>",
        escape(&record.version),
        record.extent,
        escape(&record.date),
        seconds(std::time::Duration::from_secs_f64(record.seconds)),
        record.statements.len(),
        count(Verdict::Holds),
        count(Verdict::Limited),
        count(Verdict::Fails)
    );
    page.push_str("<div class=\"note\">\n<p>What is not here:</p>\n<ul>\n");
    for missing in &record.missing {
        let _ = writeln!(page, "<li>{}</li>", escape(missing));
    }
    page.push_str("</ul>\n</div>\n<p>Meshes:</p>\n<ul>\n");
    for line in &record.resolution {
        let _ = writeln!(page, "<li>{}</li>", escape(line));
    }
    page.push_str(
        "</ul>\n<p>The first mesh of each is that of the pictures; the second is one refinement of it. Material, loads and \
         contact stiffness are the paper's (full invariant, 4 N/mm³). Every number was read from files the program \
         wrote.</p>\n",
    );
}

fn overview(page: &mut String, statements: &[Statement]) {
    page.push_str("<h2>Statements</h2>\n<div class=\"wide\"><table>\n<tr><th>statement</th><th>verdict</th></tr>\n");
    for s in statements {
        let _ = writeln!(
            page,
            "<tr><td><a href=\"#{}\">{}</a></td><td>{}</td></tr>",
            s.id,
            escape(&s.text),
            verdict(s.verdict)
        );
    }
    page.push_str("</table></div>\n");
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Holds => "<span class=\"verdict holds\">✓ holds</span>",
        Verdict::Limited => "<span class=\"verdict limited\">◐ holds in part</span>",
        Verdict::Fails => "<span class=\"verdict fails\">✗ fails</span>",
    }
}

fn draw(page: &mut String, figure: &Figure) -> Outcome<()> {
    let _ = writeln!(
        page,
        "<h3 id=\"{}\">{}</h3>\n<figure>\n<div class=\"wide\">\n{}</div>\n<figcaption>{} <span class=\"screen\">(\
         <a href=\"{0}.png\">PNG</a>, <a href=\"{0}.svg\">SVG</a>)</span></figcaption>\n</figure>",
        figure.name,
        escape(&figure.heading),
        figure.drawing.to_svg()?,
        escape(&figure.text)
    );
    Ok(())
}

fn measured(page: &mut String, record: &Record) {
    if record.measured.is_empty() {
        page.push_str("<p>No measured points survived; none are shown.</p>\n");
        return;
    }
    page.push_str(
        "<p>Distance of the measured points from the computed shapes at the same pressure:</p>\n<div class=\"wide\"><table>\n\
         <tr><th class=\"number\">pressure (kPa)</th><th class=\"number\">points</th><th class=\"number\">RMS, multiple-point \
         (mm)</th><th class=\"number\">RMS, single-point (mm)</th></tr>\n",
    );
    for MeasuredDistance { pressure_kpa, points, multiple_point_mm, single_point_mm } in &record.measured {
        let _ = writeln!(
            page,
            "<tr><td class=\"number\">{pressure_kpa}</td><td class=\"number\">{points}</td><td class=\"number\">\
             {multiple_point_mm:.2}</td><td class=\"number\">{single_point_mm:.2}</td></tr>"
        );
    }
    page.push_str("</table></div>\n");
}

fn parameters(page: &mut String, rods: &[RodResult]) {
    for rod in rods {
        let _ = writeln!(
            page,
            "<p>Parameters identified from two chambers, {}:</p>\n<div class=\"wide\"><table>\n<tr><th>parameter</th>\
             <th class=\"number\">value</th><th>unit</th><th class=\"number\">fit error</th><th class=\"number\">samples</th>\
             </tr>",
            rod.mesh
        );
        for p in &rod.parameters {
            let error = p.fit_error.map_or("not determined".into(), |e| format!("{:.2} %", 100.0 * e));
            let _ = writeln!(
                page,
                "<tr><td>{}</td><td class=\"number\">{}</td><td>{}</td><td class=\"number\">{error}</td>\
                 <td class=\"number\">{}</td></tr>",
                p.name,
                number(p.value),
                p.unit,
                p.samples
            );
        }
        page.push_str("</table></div>\n");
    }
}

fn lengths(page: &mut String, found: &[Sensitivity]) {
    page.push_str(
        "<div class=\"wide\"><table>\n<tr><th>length</th><th class=\"number\">value (mm)</th><th>mesh</th>\
         <th class=\"number\">10 % less (°)</th><th class=\"number\">as it is (°)</th><th class=\"number\">10 % more (°)</th>\
         </tr>\n",
    );
    for f in found {
        for on in &f.angles_deg {
            let angle = |a: Option<f64>| a.map_or("not solved".into(), |a| format!("{a:.2}"));
            let _ = writeln!(
                page,
                "<tr><td>{}</td><td class=\"number\">{}</td><td>{}</td><td class=\"number\">{}</td><td class=\"number\">\
                 {:.2}</td><td class=\"number\">{}</td></tr>",
                f.name,
                f.value_mm,
                on.mesh,
                angle(on.lowered),
                on.unchanged,
                angle(on.raised)
            );
        }
    }
    page.push_str("</table></div>\n");
}

fn stresses(page: &mut String, places: &Places) {
    let _ = writeln!(
        page,
        "<h3>{}</h3>\n<div class=\"wide\"><table>\n<tr><th class=\"number\">von Mises (MPa)</th><th class=\"number\">x, y, z \
         (mm)</th><th>where</th></tr>",
        escape(&places.mesh)
    );
    for place in &places.places {
        let [x, y, z] = place.at;
        let _ = writeln!(
            page,
            "<tr><td class=\"number\">{:.3}</td><td class=\"number\">{x:.2}, {y:.2}, {z:.2}</td><td>{}</td></tr>",
            place.von_mises_mpa,
            escape(&place.region)
        );
    }
    page.push_str("</table></div>\n");
}

fn statement(page: &mut String, s: &Statement) {
    let _ = writeln!(
        page,
        "<section class=\"statement\" id=\"{}\">\n<h3>{} {}</h3>\n<p class=\"claim\">Paper: {}</p>\n<p>Bound: {}</p>",
        s.id,
        escape(&s.text),
        verdict(s.verdict),
        escape(&s.claim),
        escape(&s.bound)
    );
    if !s.limit.is_empty() {
        let _ = writeln!(page, "<p class=\"note\"><strong>Limit:</strong> {}</p>", escape(&s.limit));
    }
    if !s.remark.is_empty() {
        let _ = writeln!(page, "<p class=\"note\">{}</p>", escape(&s.remark));
    }
    page.push_str(
        "<div class=\"wide\"><table>\n<tr><th>number</th><th>on</th><th class=\"number\">value</th><th>unit</th><th>bound</th>\
         <th></th></tr>\n",
    );
    for Number { name, mesh, value, unit, bound, is_kept } in &s.numbers {
        let mark = match is_kept {
            Some(true) => "<span class=\"holds\">✓</span>",
            Some(false) => "<span class=\"fails\">✗</span>",
            None => "",
        };
        let _ = writeln!(
            page,
            "<tr><td>{}</td><td>{}</td><td class=\"number\">{}</td><td>{unit}</td><td>{}</td><td>{mark}</td></tr>",
            escape(name),
            escape(mesh),
            number(*value),
            escape(bound.as_deref().unwrap_or(""))
        );
    }
    page.push_str("</table></div>\n</section>\n");
}

fn table_of_runs(page: &mut String, solutions: &Solutions) {
    page.push_str(
        "<h2 id=\"runs\" class=\"page\">Runs</h2>\n<div class=\"wide\"><table>\n<tr><th>run</th><th class=\"number\">elements\
         </th><th class=\"number\">unknowns</th><th class=\"number\">pressures reached</th><th class=\"number\">tangents</th>\
         <th class=\"number\">angle at the end (°)</th></tr>\n",
    );
    for s in &solutions.0 {
        let _ = writeln!(
            page,
            "<tr><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td>\
             <td class=\"number\">{}</td><td class=\"number\">{:.2}</td></tr>",
            escape(&s.run.name),
            s.problem.mesh.num_elements(),
            s.problem.num_unknowns(),
            s.steps.len(),
            s.tangents,
            s.steps.last().map_or(0.0, |step| step.end_face_angle_deg)
        );
    }
    page.push_str("</table></div>\n");
}

/// A number with about four digits.
fn number(value: f64) -> String {
    let size = value.abs();
    let text = if value == 0.0 {
        "0".into()
    } else if value.fract() == 0.0 && size < 1e6 {
        format!("{value:.0}")
    } else if (1e-3..1e5).contains(&size) {
        let decimals = (3 - size.log10().floor() as i32).clamp(0, 6) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.2e}")
    };
    text.replace('-', "−")
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_texts_are_escaped() {
        let texts: Vec<String> = [0.0, 7.0, 0.35719, -12.3456, 2.5e-11, 164.0].map(number).into();
        assert_eq!(texts, ["0", "7", "0.3572", "−12.35", "2.50e−11", "164"]);
        assert_eq!(escape("a < b & \"c\""), "a &lt; b &amp; &quot;c&quot;");
    }
}
