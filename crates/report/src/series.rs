//! What is plotted against pressure or time.

use std::collections::BTreeMap;

use pneuflex_model::{Clock, Control};
use pneuflex_post::measures;
use serde::Serialize;

use crate::curves::{Axis, CURVES, Curve, Plot, Rows, Values};
use crate::error::ReportError;
use crate::quantities;
use crate::report::Report;
use crate::state::State;
use crate::summary::{Found, Obstacle};

/// Name of the largest displacement of all nodes.
const LARGEST: &str = "largest";

/// Reactions below this share of the largest are rounding.
const ROUNDING: f64 = 1e-9;

/// mm³ from which volumes are in cm³.
const LARGE: f64 = 1000.0;

/// Numbers at rest, at every reached step and at the load steps between.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Series {
    /// Where the states stand along the slider: the parameter of the load path, kPa for actuators, 0, then that of the reached steps; where it
    /// turned back, evenly spaced from there on.
    pub times: Vec<f64>,
    /// Where curves have their values: the times, and the load steps between them.
    pub places: Vec<f64>,
    /// The parameter at the times, where it turned back.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub parameters: Option<Vec<f64>>,
    /// How many of them, at the end, were not asked for: states on the way of a run that ended early.
    pub on_the_way: usize,
    /// Bottom centreline at the places, \[x, z\] in mm from the clamp to the tip; left out for a body without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub centrelines: Option<Vec<Vec<[f64; 2]>>>,
    /// What is said beside the slider.
    pub key_numbers: Vec<Plot>,
    /// The plots in their order.
    pub plots: Vec<Plot>,
    /// Further quantities, for plots of one over another.
    pub more: Vec<Plot>,
}

/// The body at rest, followed by every reached step.
///
/// # Errors
/// A volume at rest that cannot be found, steps that are out of order, or a number that is not finite.
pub fn of(report: &Report<'_>) -> Result<Series, ReportError> {
    let times: Vec<f64> = std::iter::once(0.0).chain(report.summary.reached().map(|(time, _)| time)).collect();
    let not_finite = || Err(ReportError::NotFinite("summary.json".into()));
    if !times.iter().all(|time| time.is_finite()) {
        return not_finite();
    }
    let turned = report.summary.has_turned();
    let (times, parameters) = if turned { (along(&times), Some(times)) } else { (times, None) };
    if times.windows(2).any(|pair| pair[0] >= pair[1]) {
        return Err(ReportError::Order);
    }
    let rows = Rows::of(report, &times);
    let collect = Collect { report, rows: &rows, rest: vec![[0.0; 3]; report.problem.mesh.num_nodes()] };
    let (key_numbers, mut plots) = collect.plots()?;
    for plot in plots.iter_mut().filter(|plot| turned && plot.over.is_none()) {
        plot.over = Some(Axis { name: report.parameter().into(), unit: report.unit(), values: rows.parameters() });
    }
    let on_the_way = report.summary.on_the_way.iter().filter(|step| step.reached.is_some()).count();
    let mut more = quantities::more(&rows);
    more.push(Plot::single(report.parameter(), report.unit(), rows.parameters()));
    let places = rows.0.iter().map(|row| row.place).collect();
    let centrelines = collect.centrelines()?;
    let series = Series { times, places, parameters, on_the_way, centrelines, key_numbers, plots, more };
    if series.is_finite() { Ok(series) } else { not_finite() }
}

impl Series {
    /// Whether all numbers of the plots and lines are finite.
    pub(crate) fn is_finite(&self) -> bool {
        let of_plots = self.plots.iter().chain(&self.key_numbers).chain(&self.more).flat_map(Plot::numbers);
        let of_lines = self.centrelines.iter().flatten().flatten().flatten().copied();
        of_plots.chain(of_lines).all(f64::is_finite)
    }
}

/// Increasing numbers for values that rise from zero and then turn back: the values themselves up to where they do, from there on steps of
/// the mean length before.
fn along(values: &[f64]) -> Vec<f64> {
    let rising = values.windows(2).take_while(|pair| pair[0] < pair[1]).count();
    let step = values[rising] / rising.max(1) as f64;
    let beyond = (1..values.len() - rising).map(|i| values[rising] + step * i as f64);
    values[..=rising].iter().copied().chain(beyond).collect()
}

/// Collects the curves of a report.
struct Collect<'a> {
    report: &'a Report<'a>,
    rows: &'a Rows<'a>,
    /// Displacements at rest.
    rest: Vec<[f64; 3]>,
}

impl Collect<'_> {
    /// The numbers beside the slider, and the plots.
    fn plots(&self) -> Result<(Vec<Plot>, Vec<Plot>), ReportError> {
        let is_model = self.report.problem.clock == Clock::Steps;
        let mut key_numbers = Vec::new();
        let mut plots = Vec::new();
        if let Some(angle) = self.rows.column(|reached| reached.end_face_angle_deg) {
            key_numbers.push(Plot::single("end-face angle", "°", angle.clone()));
            let mut curves = vec![Curve { name: "end face".into(), values: angle }];
            if let Some(chord) = self.rows.column(Found::chord_angle_deg) {
                key_numbers.push(Plot::single("chord angle", "°", chord.clone()));
                curves.push(Curve { name: "chord".into(), values: chord });
            }
            plots.extend(Plot::grouped("Bending angle", "°", curves));
        }
        if is_model {
            let displacements = self.displacements();
            if let Some(first) = displacements.first().filter(|_| key_numbers.is_empty()) {
                let name = if first.name == LARGEST { "largest displacement" } else { &first.name };
                key_numbers.push(Plot::single(name, "mm", first.values.clone()));
            }
            let cavities = self.cavity_pressures();
            if let Some(first) = cavities.first() {
                key_numbers.push(Plot::single(&first.name, "kPa", first.values.clone()));
            }
            plots.extend(self.cavity_plots(cavities)?);
            plots.extend(Plot::grouped("Displacement", "mm", displacements));
            let force = |force: &[f64; 3]| Some(length(*force));
            let mut reactions = self.rows.named(|reached| &reached.reactions, force);
            reactions.sort_by(|a, b| largest(&b.values).total_cmp(&largest(&a.values)));
            let forces = self.rows.named(|reached| &reached.obstacles, |obstacle| obstacle.force_n.map(length));
            let across = self.rows.named(|reached| &reached.symmetry_reactions, force);
            let all = reactions.iter().chain(&forces).chain(&across);
            let least = ROUNDING * all.map(|curve| largest(&curve.values)).fold(0.0, f64::max);
            reactions.retain(|curve| largest(&curve.values) > least);
            reactions.truncate(CURVES);
            plots.extend(Plot::grouped("Reaction", "N", reactions));
        } else {
            let at_rest = measures::cavity_volume(self.report.problem, &self.rest)?;
            let volumes =
                self.rows.column_from(Some(at_rest), |reached| Some(reached.cavity_volume_mm3)).unwrap_or_default();
            let volumes: Values = volumes.into_iter().map(|mm3| mm3.map(|mm3| mm3 / LARGE)).collect();
            plots.extend(self.air_of_chambers()?);
            if self.report.summary.has_turned() {
                let over = Axis { name: "air volume".into(), unit: "cm³", values: volumes.clone() };
                plots.push(Plot { over: Some(over), ..Plot::single("Pressure", "kPa", self.rows.parameters()) });
            }
            plots.push(Plot { from_zero: false, ..Plot::single("Air volume", "cm³", volumes) });
        }
        let force = |obstacle: &Obstacle| obstacle.force_n.map(length);
        plots.extend(Plot::grouped("Force on obstacles", "N", self.rows.named(|reached| &reached.obstacles, force)));
        plots.extend(self.contact_areas());
        let stress = self.rows.column_of_states(|reached| reached.von_mises_p99_mpa);
        plots.push(Plot::single("von Mises stress, 99 %", "MPa", stress));
        Ok((key_numbers, plots))
    }

    /// Contact between walls, and on every obstacle.
    fn contact_areas(&self) -> Vec<Plot> {
        let mut curves = self.rows.named(|reached| &reached.obstacles, |obstacle| obstacle.area_mm2);
        if let Some(values) = self.rows.column(|reached| Some(reached.contact.area_mm2))
            && self.report.has_walls()
        {
            let name = if curves.is_empty() { String::new() } else { "between walls".into() };
            curves.insert(0, Curve { name, values });
        }
        Plot::grouped("Contact area", "mm²", curves)
    }

    fn cavity_pressures(&self) -> Vec<Curve> {
        self.rows.named(|reached| &reached.cavities, |cavity| cavity.pressure_kpa)
    }

    /// Pressure and growth in volume of the air of every chamber, where chambers have air of their own.
    fn air_of_chambers(&self) -> Result<Vec<Plot>, ReportError> {
        let pressures = self.cavity_pressures();
        let mut growth = Vec::new();
        for cavity in self.report.problem.cavities.iter().filter(|_| !pressures.is_empty()) {
            let Some(at_rest) = measures::volume(self.report.problem, cavity, &self.rest)? else { continue };
            let of = |reached: &Found| Some(reached.cavities.get(&cavity.name)?.volume_mm3? - at_rest);
            growth.extend(self.rows.column(of).map(|values| Curve { name: cavity.name.clone(), values }));
        }
        Ok(Plot::grouped("Pressure", "kPa", pressures)
            .into_iter()
            .chain(Plot::grouped("Growth of volume", "mm³", growth))
            .collect())
    }

    /// Pressure and volume of every cavity against time, or against each other where the volume is given or the path turned back.
    fn cavity_plots(&self, pressures: Vec<Curve>) -> Result<Vec<Plot>, ReportError> {
        let mut volumes = Vec::new();
        for cavity in &self.report.problem.cavities {
            let at_rest = measures::volume(self.report.problem, cavity, &self.rest)?;
            let of = |reached: &Found| reached.cavities.get(&cavity.name)?.volume_mm3;
            if let Some(values) = self.rows.column_from(at_rest, of) {
                volumes.push(Curve { name: cavity.name.clone(), values });
            }
        }
        let is_large = volumes.iter().any(|curve| largest(&curve.values) >= LARGE);
        let unit = if is_large { "cm³" } else { "mm³" };
        for value in volumes.iter_mut().flat_map(|curve| &mut curve.values).flatten().filter(|_| is_large) {
            *value /= LARGE;
        }
        let pumped: BTreeMap<&str, &Curve> = (self.report.problem.cavities.iter())
            .filter(|cavity| self.report.summary.has_turned() || matches!(cavity.control, Control::Volume(_)))
            .filter_map(|cavity| Some((cavity.name.as_str(), volumes.iter().find(|curve| curve.name == cavity.name)?)))
            .collect();
        let mut plots = Vec::new();
        for curve in &pressures {
            if let Some(volume) = pumped.get(curve.name.as_str()) {
                let over = Axis { name: "volume".into(), unit, values: volume.values.clone() };
                let name = format!("Pressure, {}", curve.name);
                plots.push(Plot { over: Some(over), ..Plot::single(&name, "kPa", curve.values.clone()) });
            }
        }
        let others = |curves: &[Curve]| {
            curves.iter().filter(|curve| !pumped.contains_key(curve.name.as_str())).cloned().collect()
        };
        plots.extend(Plot::grouped("Cavity pressure", "kPa", others(&pressures)));
        let volumes = Plot::grouped("Cavity volume", unit, others(&volumes));
        plots.extend(volumes.into_iter().map(|plot| Plot { from_zero: false, ..plot }));
        Ok(plots)
    }

    /// How far the node that moves most, and the probes, are from where they were.
    fn displacements(&self) -> Vec<Curve> {
        let mut curves = Vec::new();
        if let Some(states) = self.report.states {
            let of = |state: &State| state.displacement.iter().map(|&u| length(u)).fold(0.0, f64::max);
            let values = self.rows.spread(std::iter::once(0.0).chain(states.iter().map(of)));
            curves.push(Curve { name: LARGEST.into(), values });
        }
        curves.extend(self.rows.named(|reached| &reached.probes, |u| Some(length(*u))));
        curves
    }

    fn centrelines(&self) -> Result<Option<Vec<Vec<[f64; 2]>>>, ReportError> {
        let rest = measures::centreline(self.report.problem, &self.rest)?;
        let count = rest.len();
        let line = |found: &Found| (found.centreline.len() == count).then(|| found.centreline.clone());
        let lines = self.rows.vectors(Some(rest), line).and_then(|lines| lines.into_iter().collect());
        Ok(lines.filter(|_| count > 1))
    }
}

fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn largest(values: &[Option<f64>]) -> f64 {
    values.iter().flatten().fold(0.0, |a, b| a.max(b.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::summary::Summary;
    use crate::testing::{summary_json, two_chambers};
    use pneuflex_model::{Formulation, Problem};
    use serde_json::{Value, json};

    /// A pumped chamber with a support and an obstacle, at the times 1 and 2.
    fn model() -> (Problem, Value) {
        let mut problem = two_chambers(Formulation::Hex8Sri);
        problem.clock = Clock::Steps;
        problem.symmetry.clear();
        problem.cavities[0].control = Control::Volume(pneuflex_model::Curve::Proportional(10.0));
        let mut summary = summary_json(&[1.0, 2.0]);
        for step in summary["steps"].as_array_mut().unwrap() {
            let time = step["pressure_kpa"].take().as_f64().unwrap();
            step["pressure_kpa"] = 7.0.into();
            step["time"] = time.into();
            step.as_object_mut().unwrap().remove("end_face_angle_deg");
            step["centreline"] = json!([]);
            step["cavities"] = json!({"cavity": {"pressure_kpa": 7.0 * time, "volume_mm3": 900.0 + 10.0 * time}});
            step["reactions"] = json!({"clamp": [3.0 * time, 1.0, 4.0 * time], "middle": [0.0, 0.0, 0.0]});
            step["obstacles"] =
                json!({"ball": {"force_n": [0.0, 0.5, time], "moment_nmm": [0, 0, 0], "area_mm2": 3.0 * time}});
        }
        (problem, summary)
    }

    fn of_summary(problem: &Problem, summary: Value) -> Result<Series, ReportError> {
        let summary: Summary = serde_json::from_value(summary).unwrap();
        of(&Report { title: "", about: "", inputs: &[], problem, summary: &summary, states: None })
    }

    fn plot<'a>(series: &'a Series, name: &str) -> Option<&'a Plot> {
        series.plots.iter().find(|plot| plot.name == name)
    }

    #[test]
    fn a_model_is_plotted_against_time_and_a_pumped_cavity_against_its_volume() {
        let (problem, summary) = model();
        let series = of_summary(&problem, summary.clone()).unwrap();
        assert_eq!(series.times, [0.0, 1.0, 2.0]);
        assert!(series.centrelines.is_none() && plot(&series, "Bending angle").is_none());
        let pumped = plot(&series, "Pressure, cavity").unwrap();
        assert_eq!(pumped.curves[0].values, [0.0, 7.0, 14.0].map(Some));
        let (volume, rest) = (pumped.over.as_ref().unwrap(), vec![[0.0; 3]; problem.mesh.num_nodes()]);
        let at_rest = measures::volume(&problem, &problem.cavities[0], &rest).unwrap().unwrap();
        assert_eq!((&volume.values[..], volume.unit), (&[at_rest, 910.0, 920.0].map(Some)[..], "mm³"));
        assert!(plot(&series, "Cavity pressure").is_none() && plot(&series, "Cavity volume").is_none());
        let reactions = &plot(&series, "Reaction").unwrap().curves;
        assert_eq!(reactions.iter().map(|curve| curve.name.as_str()).collect::<Vec<_>>(), ["clamp"]);
        assert!((reactions[0].values[2].unwrap() - 101_f64.sqrt()).abs() < 1e-12);
        let force = plot(&series, "Force on obstacles").unwrap().curves[0].values[1].unwrap();
        assert!((force - 1.25_f64.sqrt()).abs() < 1e-12);
        assert_eq!(plot(&series, "Displacement").unwrap().curves[0].values[0], Some(0.0));
    }

    #[test]
    fn what_a_summary_does_not_say_everywhere_is_not_plotted() {
        let (mut problem, mut summary) = model();
        problem.cavities[0].control = Control::Pressure(pneuflex_model::Curve::ZERO);
        summary["steps"][1]["cavities"]["cavity"].as_object_mut().unwrap().remove("volume_mm3");
        summary["steps"][0].as_object_mut().unwrap().remove("obstacles");
        let series = of_summary(&problem, summary.clone()).unwrap();
        assert!(plot(&series, "Cavity pressure").is_some() && plot(&series, "Cavity volume").is_none());
        assert!(plot(&series, "Force on obstacles").is_none());
        for step in summary["steps"].as_array_mut().unwrap() {
            for key in ["cavities", "reactions", "obstacles", "probes", "centreline"] {
                step.as_object_mut().unwrap().remove(key);
            }
        }
        let names: Vec<String> =
            of_summary(&problem, summary.clone()).unwrap().plots.into_iter().map(|plot| plot.name).collect();
        assert_eq!(names, ["Contact area", "von Mises stress, 99 %"]);
        summary["steps"][1]["time"] = 0.5.into();
        assert_eq!(of_summary(&problem, summary), Err(ReportError::Order));
    }

    #[test]
    fn curves_go_through_the_load_steps_between_states() {
        let problem = two_chambers(Formulation::Hex8Sri);
        let mut summary = summary_json(&[5.0, 15.0]);
        // The second is a state, too, and the third lies beyond the last one.
        let step = |at: f64, angle: f64| {
            json!({"pressure_kpa": at, "probes": {"tip": [0.0, 0.0, -at]}, "end_face_angle_deg": angle,
                "centreline": summary["steps"][0]["centreline"], "cavity_volume_mm3": 900.0 + at,
                "contact": {"points_active": 0, "area_mm2": 0.0}})
        };
        summary["load_steps"] = json!([step(9.0, 33.0), step(5.0, 44.0), step(16.0, 55.0)]);
        let series = of_summary(&problem, summary.clone()).unwrap();
        assert_eq!((&series.times[..], &series.places[..]), (&[0.0, 5.0, 15.0][..], &[0.0, 5.0, 9.0, 15.0][..]));
        let angle = &plot(&series, "Bending angle").unwrap().curves[0].values;
        assert_eq!(angle[..], [0.0, 10.0, 33.0, 30.0].map(Some));
        let stress = &plot(&series, "von Mises stress, 99 %").unwrap().curves[0].values;
        assert_eq!(stress[..], [Some(0.0), Some(0.05), None, Some(0.15)]);
        let probe = series.more.iter().find(|plot| plot.name == "tip").unwrap();
        assert_eq!(probe.curves[2].values, [0.0, -2.5, -9.0, -7.5].map(Some));
        assert_eq!(series.more.last().unwrap().curves[0].values, [0.0, 5.0, 9.0, 15.0].map(Some));
        summary["load_steps"][0]["end_face_angle_deg"] = "x".into();
        assert!(serde_json::from_value::<Summary>(summary).is_err());
    }

    #[test]
    fn many_cavities_share_plots_by_fours() {
        let curves = vec![Curve { name: "a".into(), values: vec![Some(0.0)] }; 9];
        let counts: Vec<usize> = Plot::grouped("p", "kPa", curves).iter().map(|plot| plot.curves.len()).collect();
        assert_eq!(counts, [4, 4, 1]);
    }
}
