//! How far the 50 kPa bending angle hangs on the lengths that are our own reading of the paper.

use pneuflex::mesh::Actuator;
use rayon::prelude::*;

use super::Outcome;
use super::plan::{Body, Extent, Mesh, Method, REFINED, Run};
use super::record::{Sensitivity, SensitivityOn, Statement};
use super::runner::Runner;

/// Change of every length.
const SHARE: f64 = 0.1;
/// Pressure of the angle, kPa.
const PRESSURE: f64 = 50.0;
/// Lengths whose influence is computed once more on the refined mesh: those with the most of it.
const CHECKED: usize = 3;

/// A length, and the case's key for it with its value for a factor.
struct Length {
    name: &'static str,
    value: f64,
    key: &'static str,
    setting: fn(&Actuator, f64) -> f64,
}

fn lengths() -> Vec<Length> {
    let a = Actuator::full();
    let length = |name, value, key, setting| Length { name, value, key, setting };
    vec![
        length("base", a.base, "base", |a, f| f * a.base),
        length("cavity floor", a.floor(), "cavity_floor", |a, f| f * a.floor()),
        length("end walls", a.end_wall(), "cavity_length", |a, f| a.chamber_length.least() - 2.0 * f * a.end_wall()),
        length("side walls", a.side_wall.least(), "side_wall", |a, f| f * a.side_wall.least()),
        length("top walls", a.top_wall.least(), "top_wall", |a, f| f * a.top_wall.least()),
        length("gap", a.gap.least(), "gap", |a, f| f * a.gap.least()),
        length("channel, half width", a.channel.half_width, "channel.half_width", |a, f| f * a.channel.half_width),
        length("channel, floor", a.channel.bottom, "channel.bottom", |a, f| f * a.channel.bottom),
        length("channel, roof", a.channel.top, "channel.top", |a, f| f * a.channel.top),
    ]
}

/// All lengths; a quick run takes a few, which shows that the study works.
fn studied(extent: Extent) -> Vec<Length> {
    let mut lengths = lengths();
    if extent == Extent::Quick {
        lengths.truncate(CHECKED);
    }
    lengths
}

fn run(mesh: Mesh, length: &Length, factor: f64) -> Run {
    let mut changes = vec![format!("actuator.{}={:.6}", length.key, (length.setting)(&Actuator::full(), factor))];
    if length.key == "base" {
        // The cavities begin where they are: only the base around and between them changes.
        changes.push(format!("actuator.cavity_floor={:?}", Actuator::full().floor()));
    }
    let suffix = format!("{}-{}", length.key.replace('.', "-"), if factor < 1.0 { "lower" } else { "higher" });
    Run::standard(Body::Actuator, mesh, Method::Multiple).landing_on(vec![PRESSURE]).varied(&suffix, &changes)
}

fn unchanged(mesh: Mesh) -> Run {
    Run::standard(Body::Actuator, mesh, Method::Multiple).landing_on(vec![PRESSURE]).varied("unchanged", &[])
}

/// Rough seconds of the study.
pub fn expected_s(extent: Extent) -> f64 {
    let mesh = extent.sensitivity_mesh();
    let count = (2 * studied(extent).len() + 1) as f64;
    let checks = if extent == Extent::Full { (2 * CHECKED + 1) as f64 * unchanged(REFINED).expected_s() } else { 0.0 };
    count * unchanged(mesh).expected_s() + checks
}

/// Runs the study.
///
/// # Errors
/// A program that fails otherwise than by not converging.
pub fn study(extent: Extent, runner: &Runner) -> Outcome<Vec<Sensitivity>> {
    let mesh = extent.sensitivity_mesh();
    let centre = angle(runner, &unchanged(mesh))?;
    let on_first = |length: Length| -> Outcome<(Length, Sensitivity)> {
        let on = on_mesh(runner, mesh, &length, centre)?;
        let found = Sensitivity { name: length.name.into(), value_mm: length.value, angles_deg: vec![on] };
        Ok((length, found))
    };
    let mut all = studied(extent).into_par_iter().map(on_first).collect::<Outcome<Vec<_>>>()?;
    all.sort_by(|a, b| b.1.angles_deg[0].largest_change().total_cmp(&a.1.angles_deg[0].largest_change()));
    if extent == Extent::Full {
        let centre = angle(runner, &unchanged(REFINED))?;
        for (length, found) in all.iter_mut().take(CHECKED) {
            found.angles_deg.push(on_mesh(runner, REFINED, length, centre)?);
        }
    }
    Ok(all.into_iter().map(|(_, found)| found).collect())
}

fn angle(runner: &Runner, run: &Run) -> Outcome<f64> {
    Ok(runner.solve(run)?.step(PRESSURE)?.end_face_angle_deg)
}

fn on_mesh(runner: &Runner, mesh: Mesh, length: &Length, centre: f64) -> Outcome<SensitivityOn> {
    let angle = |factor: f64| -> Outcome<Option<f64>> {
        let solved = runner.try_solve(&run(mesh, length, factor))?;
        solved.map(|s| s.step(PRESSURE).map(|step| step.end_face_angle_deg)).transpose()
    };
    let (lowered, raised) = (angle(1.0 - SHARE)?, angle(1.0 + SHARE)?);
    Ok(SensitivityOn { mesh: mesh.to_string(), lowered, unchanged: centre, raised })
}

/// The angle depends on the lengths smoothly and the same on a finer mesh.
pub fn statement(found: &[Sensitivity]) -> Statement {
    let mut statement = Statement::new(
        "sensitivity",
        "What hangs on our own reading of the geometry is known: every variant is solved, and refinement leaves the most \
         important influences as they are.",
        "The paper gives no drawing that survived; these lengths are our reading.",
        "Variants without an equilibrium ≤ 0; influence of the three most important lengths on the refined mesh / on the \
         coarse mesh between 0.8 and 1.25 (full run).",
    );
    let on =
        found.first().and_then(|f| f.angles_deg.first()).map_or(String::new(), |a| format!("actuator, {}", a.mesh));
    let failed: usize = found
        .iter()
        .flat_map(|f| &f.angles_deg)
        .map(|a| usize::from(a.lowered.is_none()) + usize::from(a.raised.is_none()))
        .sum();
    statement.at_most("variants without an equilibrium", &on, failed as f64, 0.0, "");
    for sensitivity in found {
        for angles in &sensitivity.angles_deg {
            let name = format!("largest change of the angle at 50 kPa, {} ± 10 %", sensitivity.name);
            statement.note(&name, &format!("actuator, {}", angles.mesh), angles.largest_change(), "°");
        }
        if let [coarse, refined] = &sensitivity.angles_deg[..] {
            let (name, on) = (format!("refined / coarse, {}", sensitivity.name), format!("actuator, {}", refined.mesh));
            let ratio = refined.largest_change() / coarse.largest_change();
            statement.at_least(&name, &on, ratio, 0.8, "");
            statement.at_most(&name, &on, ratio, 1.25, "");
        }
    }
    statement
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_length_is_a_key_of_the_actuator_and_changes_by_a_tenth() {
        for length in lengths() {
            let present = (length.setting)(&Actuator::full(), 1.0);
            let lowered = run(REFINED, &length, 0.9);
            let table: toml::Table = lowered.changes[0].parse().unwrap();
            let mut actuator = toml::Table::try_from(Actuator::full()).unwrap();
            if length.key == "cavity_floor" {
                actuator.insert("cavity_floor".into(), toml::Value::Float(4.0));
            }
            let mut value = table["actuator"].clone();
            let mut there = toml::Value::Table(actuator);
            for key in length.key.split('.') {
                value = value[key].clone();
                there = there[key].clone();
            }
            assert_eq!(there.as_float().unwrap(), present, "{}", length.name);
            let change = (value.as_float().unwrap() - present).abs();
            let thickness = if length.key == "cavity_length" { 0.5 * change } else { change };
            assert!((thickness - 0.1 * length.value).abs() < 1e-6, "{}", length.name);
        }
    }
}
