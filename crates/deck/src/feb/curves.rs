//! Time: `<Control>` and load curves.

use pneuflex_model::{Curve, LoadParameter};

use super::xml::{Node, Reader, child, children, elements, text};
use crate::deck::Schedule;
use crate::report::quoted;

/// A value that jumps at the beginning grows over this share of the time instead, so that there is an equilibrium to start from.
const JUMP: f64 = 1e-3;

/// So many fixed steps are reached one by one at the most.
const MOST_STEPS: i32 = 1000;

/// A factor over time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LoadCurve {
    points: Vec<[f64; 2]>,
    /// As written.
    interpolate: String,
    extend: String,
}

impl LoadCurve {
    /// 1 at all times.
    pub fn constant() -> Self {
        Self { points: vec![[0.0, 1.0]], interpolate: "LINEAR".to_owned(), extend: "CONSTANT".to_owned() }
    }

    /// Whether it is of a kind that loads can follow up to the end.
    pub fn usable(&self, end: f64) -> Result<(), String> {
        let is_straight = self.interpolate.eq_ignore_ascii_case("LINEAR") || self.points.len() == 1;
        if !is_straight {
            return Err(format!("{} is not supported, only LINEAR", quoted(&self.interpolate)));
        }
        let goes_on = self.points.last().is_some_and(|point| point[0] < end * (1.0 - 1e-9));
        if goes_on && !self.extend.eq_ignore_ascii_case("CONSTANT") {
            return Err(format!("{} beyond its last point is not supported, only CONSTANT", quoted(&self.extend)));
        }
        Ok(())
    }

    /// A factor times it.
    pub fn times(&self, factor: f64, end: f64) -> Curve {
        let table = Curve::Table(self.points.clone());
        let mut points = vec![[0.0, 0.0]];
        if factor * table.at(LoadParameter(0.0)) != 0.0 {
            points.push([JUMP * end, factor * table.at(LoadParameter(JUMP * end))]);
        }
        let from = points[points.len() - 1][0];
        points.extend(self.points.iter().filter(|point| point[0] > from).map(|[time, value]| [*time, factor * value]));
        if points.iter().all(|point| point[1] == 0.0) { Curve::ZERO } else { Curve::Table(points) }
    }
}

/// Reads `<LoadData>`.
pub(super) fn read_curves(section: Node<'_, '_>, reader: &mut Reader<'_>) {
    reader.only(section, &["load_controller"]);
    for node in children(section, "load_controller") {
        let Some(number) = reader.id(node) else { continue };
        let kind = node.attribute("type").unwrap_or("loadcurve");
        if kind != "loadcurve" {
            reader.error(node, format!("load controller {} is not supported, only \"loadcurve\"", quoted(kind)));
            continue;
        }
        let word = |name: &str, otherwise: &str| child(node, name).map_or(otherwise, text).to_owned();
        let (interpolate, extend) = (word("interpolate", "LINEAR"), word("extend", "CONSTANT"));
        reader.only(node, &["interpolate", "extend", "points"]);
        let mut points = Vec::new();
        for point in child(node, "points").into_iter().flat_map(elements) {
            match reader.reals(point).as_deref() {
                Some(&[time, value]) => points.push([time, value]),
                Some(_) => reader.error(point, "a point takes a time and a value"),
                None => {}
            }
        }
        if points.is_empty() || points.windows(2).any(|pair| pair[0][0] >= pair[1][0]) {
            reader.error(node, "a load curve takes points whose times increase");
        } else {
            reader.curves.insert(number as i32, LoadCurve { points, interpolate, extend });
        }
    }
}

/// Adds the time of a `<Control>` to a schedule that ends at `reader.end`.
pub(super) fn read_control(section: Node<'_, '_>, schedule: &mut Schedule, reader: &mut Reader<'_>) {
    let analysis = child(section, "analysis").map_or("STATIC", |node| node.attribute("type").unwrap_or(text(node)));
    // Numbers are those of FEBio's own list.
    if !(analysis.eq_ignore_ascii_case("STATIC") || analysis == "0") {
        return reader.error(section, format!("analysis {} is not supported, only STATIC", quoted(analysis)));
    }
    let [count, size] = ["time_steps", "step_size"].map(|name| reader.required_child(section, name));
    let count = count.and_then(|node| reader.integer(node).map(|count| (node, count)));
    let size = size.and_then(|node| reader.real(node));
    let (Some((node, count)), Some(size)) = (count, size) else { return };
    if !(count > 0 && size > 1e-9 * reader.end.max(1e-3) && f64::from(count) * size < 1e9) {
        return reader
            .error(node, "<time_steps> and <step_size> must be greater than 0, and their product less than 1e9");
    }
    let (begin, end) = (reader.end, reader.end + f64::from(count) * size);
    // Steps whose size adapts end where they must.
    if let Some(stepper) = child(section, "time_stepper") {
        let must = child(stepper, "dtmax").and_then(|node| node.attribute("lc")).and_then(|lc| lc.parse().ok());
        let points = must.and_then(|number: i32| reader.curves.get(&number)).map(|curve| curve.points.clone());
        let inner = points.unwrap_or_default().into_iter().map(|point| point[0]);
        schedule.times.extend(inner.filter(|time| *time > begin + 1e-9 * end && *time < end * (1.0 - 1e-9)));
    } else if count <= MOST_STEPS {
        schedule.times.extend((1..count).map(|step| begin + f64::from(step) * size));
    } else {
        reader.note(node, format!("more than {MOST_STEPS} time steps: only their end is reached exactly"));
    }
    schedule.times.push(end);
    if begin == 0.0 {
        schedule.first_increment = size;
    }
    reader.end = end;
}
