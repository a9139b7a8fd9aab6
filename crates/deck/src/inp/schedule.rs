//! Steps, amplitudes, and how values change over them.

use std::collections::BTreeMap;

use pneuflex_model::{Curve, LoadParameter};

use super::context::Context;
use super::outline::{Item, Outline};
use crate::report::{Place, quoted, suggestion};
use crate::syntax::Block;

/// A value that jumps at the beginning of a step grows over this share of it instead, so that there is an equilibrium to start from.
const JUMP: f64 = 1e-3;

/// So many increments of `*STATIC, DIRECT` are reached on in one step at the most.
const MOST_INCREMENTS: f64 = 1000.0;

/// A step in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    pub begin: f64,
    pub end: f64,
    /// First increment.
    pub first: f64,
    /// Whether all increments are the first one.
    pub is_direct: bool,
}

/// Steps and amplitudes.
#[derive(Debug, Default)]
pub(super) struct Times {
    pub steps: Vec<Step>,
    amplitudes: Vec<Amplitude>,
    by_name: BTreeMap<String, usize>,
}

/// A piecewise linear factor.
#[derive(Debug)]
struct Amplitude {
    points: Vec<[f64; 2]>,
    /// Time counts from the beginning of the first step.
    is_total: bool,
    /// Its values are the load's, not factors.
    is_absolute: bool,
}

/// What is said of a value in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Event {
    pub step: u32,
    /// Value at the step's end, or times the amplitude.
    pub value: f64,
    pub amplitude: Option<usize>,
}

impl Event {
    /// A key that is the same for equal events.
    pub fn key(&self) -> (u32, u64, Option<usize>) {
        // Both zeros are the same.
        (self.step, (self.value + 0.0).to_bits(), self.amplitude)
    }
}

impl Times {
    pub fn read(outline: &Outline<'_>, context: &mut Context<'_>) -> Self {
        let mut times = Self::default();
        for Item { block, .. } in outline.of("AMPLITUDE") {
            let Some(name) = context.required(block, "NAME") else { continue };
            if times.by_name.insert(name.to_uppercase(), times.amplitudes.len()).is_some() {
                context.error(block.place, format!("amplitude {} is there twice", quoted(name)));
            }
            times.amplitudes.push(Amplitude::read(block, context));
        }
        for (block, number) in outline.steps.iter().zip(0..) {
            times.step(block, number, outline, context);
        }
        times
    }

    fn step(&mut self, block: &Block, number: u32, outline: &Outline<'_>, context: &mut Context<'_>) {
        let begin = self.steps.last().map_or(0.0, |step: &Step| step.end);
        let mut step = Step { begin, end: begin + 1.0, first: 1.0, is_direct: false };
        let is_first = number == 0;
        let is_off = |block: &Block| !block.has("NLGEOM") || block.word("NLGEOM").is_some_and(|word| word == "NO");
        if is_off(block) && (is_first || is_off(outline.steps[0])) {
            context.note(block.place, "a step without NLGEOM is solved with large displacements, as every step");
        }
        if block.word("AMPLITUDE").is_some_and(|word| word == "STEP") {
            context.note(block.place, "AMPLITUDE=STEP: loads grow linearly over the step instead of acting at once");
        } else {
            context.expect_word(block, "AMPLITUDE", &["RAMP", "STEP"]);
        }
        let statics: Vec<&Block> = outline.of_step("STATIC", Some(number)).map(|item| item.block).collect();
        match statics[..] {
            [one] => step.read(one, context),
            [] => context.error(block.place, "the step has no *STATIC: other procedures cannot be solved"),
            [_, second, ..] => context.error(second.place, "the step has two procedures"),
        }
        self.steps.push(step);
    }

    /// Number of the amplitude that a keyword names.
    pub fn amplitude(&self, block: &Block, context: &mut Context<'_>) -> Option<usize> {
        let name = block.value("AMPLITUDE")?;
        let found = self.by_name.get(&name.to_uppercase()).copied();
        if found.is_none() {
            let hint = suggestion(name, self.by_name.keys().map(String::as_str));
            context.error(block.place, format!("there is no amplitude {}{hint}", quoted(name)));
        }
        found
    }

    /// Whether an amplitude's values count themselves, not as factors.
    pub fn is_absolute(&self, amplitude: Option<usize>) -> bool {
        amplitude.is_some_and(|number| self.amplitudes[number].is_absolute)
    }

    /// Whether an event leads to numbers at all times.
    pub fn is_finite(&self, event: &Event) -> bool {
        let largest =
            |number: usize| self.amplitudes[number].points.iter().fold(0.0_f64, |a, point| a.max(point[1].abs()));
        (event.value * event.amplitude.map_or(1.0, largest)).is_finite()
    }

    /// Times to land on: the ends of the steps, and all increments of a step with `DIRECT`.
    pub fn requested(&self) -> Vec<f64> {
        let mut found = Vec::new();
        for step in &self.steps {
            let count =
                if step.is_direct { ((step.end - step.begin) / step.first - 1e-9).floor().max(0.0) } else { 0.0 };
            found.extend((1..=count as usize).map(|i| step.begin + step.first * i as f64));
            found.push(step.end);
        }
        found
    }

    /// A value over time from what is said of it, in the order of the steps. Zero at the beginning.
    ///
    /// Without amplitude the value changes linearly over the step, from what it was to what is said; in steps that say nothing it stays,
    /// unless an amplitude in total time goes on.
    pub fn curve(&self, events: &[Event]) -> Curve {
        let mut points = vec![[0.0, 0.0]];
        let mut going_on: Option<(&Amplitude, f64)> = None;
        for (step, number) in self.steps.iter().zip(0..) {
            if let Some(event) = events.iter().find(|event| event.step == number) {
                going_on = event.amplitude.map(|amplitude| (&self.amplitudes[amplitude], event.value));
                if going_on.is_none() {
                    points.push([step.end, event.value]);
                    continue;
                }
            }
            match going_on {
                Some((amplitude, factor)) => {
                    amplitude.add(step, factor, &mut points);
                    going_on = going_on.filter(|(amplitude, _)| amplitude.is_total);
                }
                None => {
                    let last = points.last().map_or(0.0, |point| point[1]);
                    points.push([step.end, last]);
                }
            }
        }
        simplified(points)
    }
}

impl Step {
    /// `*STATIC`: first increment, period, least and largest increment.
    fn read(&mut self, block: &Block, context: &mut Context<'_>) {
        if block.has("STABILIZE") {
            context.note(
                block.place,
                "*STATIC, STABILIZE: nothing is added to stabilise; unstable paths are followed as they are; a model file around the \
                 deck with solver.continuation = \"damped\" lets the body snap",
            );
        }
        let Some(line) = block.lines.first() else { return };
        let fields = context.fields(line);
        let mut values = [1.0, 1.0];
        for (value, field) in values.iter_mut().zip(&fields).filter(|(_, field)| !field.is_empty()) {
            let Some(number) = context.real(line.place, field) else { return };
            *value = number;
        }
        // Zeros stand for the defaults.
        let [first, period] = values.map(|value| if value == 0.0 { 1.0 } else { value });
        // Times must stay apart when they are added up.
        let is_good = period > 1e-9 * self.begin.max(1e-3) && period < 1e9;
        if !(first > 0.0 && is_good) {
            return context
                .error(line.place, "*STATIC takes a first increment and a period greater than 0 and less than 1e9");
        }
        self.end = self.begin + period;
        self.first = first.min(period);
        self.is_direct = block.has("DIRECT");
        if self.is_direct && period / self.first > MOST_INCREMENTS {
            context.note(
                line.place,
                format!(
                    "*STATIC, DIRECT: more than {MOST_INCREMENTS} increments; only the end of the step is reached exactly"
                ),
            );
            self.is_direct = false;
        }
    }
}

impl Amplitude {
    fn read(block: &Block, context: &mut Context<'_>) -> Self {
        context.expect_word(block, "DEFINITION", &["TABULAR"]);
        context.expect_word(block, "TIME", &["STEPTIME", "TOTALTIME"]);
        context.expect_word(block, "VALUE", &["RELATIVE", "ABSOLUTE"]);
        let numbers = context.numbers(block).unwrap_or_default();
        let points: Vec<[f64; 2]> = numbers.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
        let place: Place = block.place;
        if points.is_empty() || !numbers.len().is_multiple_of(2) {
            context.error(place, "*AMPLITUDE takes pairs of time and value");
        } else if points.windows(2).any(|pair| pair[0][0] >= pair[1][0]) || points[0][0] < 0.0 {
            context.error(place, "*AMPLITUDE: times must increase from 0 or more");
        } else if points[0][1] != 0.0 {
            let text = "*AMPLITUDE begins with a value other than 0: where a load or a support would jump at the beginning of a step, it \
                        grows over the first thousandth of the step";
            context.note(place, text);
        }
        Self {
            points,
            is_total: block.word("TIME").is_some_and(|word| word == "TOTALTIME"),
            is_absolute: block.word("VALUE").is_some_and(|word| word == "ABSOLUTE"),
        }
    }

    fn at(&self, time: f64) -> f64 {
        Curve::Table(self.points.clone()).at(LoadParameter(time))
    }

    /// Follows the amplitude times a factor through a step.
    fn add(&self, step: &Step, factor: f64, points: &mut Vec<[f64; 2]>) {
        let shift = if self.is_total { 0.0 } else { step.begin };
        let last = points.last().map_or(0.0, |point| point[1]);
        let mut from = step.begin;
        if factor * self.at(from - shift) != last {
            from += JUMP * (step.end - step.begin);
            points.push([from, factor * self.at(from - shift)]);
        }
        for point in &self.points {
            let time = point[0] + shift;
            if time > from && time < step.end {
                points.push([time, factor * point[1]]);
            }
        }
        points.push([step.end, factor * self.at(step.end - shift)]);
    }
}

/// Leaves out points between equal values and repetitions; a value that is always zero is [`Curve::ZERO`].
fn simplified(points: Vec<[f64; 2]>) -> Curve {
    let mut kept: Vec<[f64; 2]> = Vec::new();
    for point in points {
        if let [.., [_, a], [_, b]] = kept[..]
            && a == b
            && b == point[1]
        {
            kept.pop();
        }
        kept.push(point);
    }
    if kept.iter().all(|point| point[1] == 0.0) { Curve::ZERO } else { Curve::Table(kept) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(amplitudes: Vec<Amplitude>) -> Times {
        let step = |begin, end| Step { begin, end, first: 0.5, is_direct: false };
        Times { steps: vec![step(0.0, 1.0), step(1.0, 3.0)], amplitudes, by_name: BTreeMap::new() }
    }

    fn event(step: u32, value: f64, amplitude: Option<usize>) -> Event {
        Event { step, value, amplitude }
    }

    #[test]
    fn values_grow_over_their_step_and_stay() {
        let times = times(Vec::new());
        assert_eq!(times.curve(&[event(0, 2.0, None)]), Curve::Table(vec![[0.0, 0.0], [1.0, 2.0], [3.0, 2.0]]));
        assert_eq!(times.curve(&[event(1, 2.0, None)]), Curve::Table(vec![[0.0, 0.0], [1.0, 0.0], [3.0, 2.0]]));
        let removed = times.curve(&[event(0, 2.0, None), event(1, 0.0, None)]);
        assert_eq!(removed, Curve::Table(vec![[0.0, 0.0], [1.0, 2.0], [3.0, 0.0]]));
        assert_eq!(times.curve(&[event(0, 0.0, None)]), Curve::ZERO);
    }

    #[test]
    fn amplitudes_count_from_their_step_or_from_the_beginning() {
        let points = vec![[0.0, 0.0], [0.5, 3.0], [2.0, 1.0]];
        let amplitude = |is_total| Amplitude { points: points.clone(), is_total, is_absolute: false };
        let times = times(vec![amplitude(false), amplitude(true)]);
        let of_step = times.curve(&[event(1, 10.0, Some(0))]);
        assert_eq!([1.0, 1.5, 3.0, 9.0].map(|t| of_step.at(LoadParameter(t))), [0.0, 30.0, 10.0, 10.0]);
        let total = times.curve(&[event(0, 10.0, Some(1))]);
        assert_eq!([0.0, 0.5, 2.0, 3.0].map(|t| total.at(LoadParameter(t))), [0.0, 30.0, 10.0, 10.0]);
        // In the second step a step's amplitude leaves the value where it was.
        let stays = times.curve(&[event(0, 10.0, Some(0))]);
        assert_eq!(stays.at(LoadParameter(3.0)), stays.at(LoadParameter(1.0)));
    }

    #[test]
    fn jumps_are_spread_over_the_beginning_of_the_step() {
        let times = times(vec![Amplitude { points: vec![[0.0, 1.0]], is_total: false, is_absolute: false }]);
        let curve = times.curve(&[event(1, 5.0, Some(0))]);
        assert_eq!([1.0, 1.002, 3.0].map(|t| curve.at(LoadParameter(t))), [0.0, 5.0, 5.0]);
    }

    #[test]
    fn fixed_increments_are_landed_on() {
        let mut times = times(Vec::new());
        times.steps[1].is_direct = true;
        assert_eq!(times.requested(), [1.0, 1.5, 2.0, 2.5, 3.0]);
    }
}
