//! The states of a result folder as a film: pictures from rest through all of them, with all pictures alike in scale and colours.

use std::path::Path;

use pneuflex_mesh::vector::Vec3;
use pneuflex_model::LoadParameter;
use pneuflex_plot::drawing::Drawing;
use pneuflex_plot::picture::{View, obstacle_surface};
use pneuflex_report::state::State;

use crate::error::Error;
use crate::picture::{FieldsOfRun, Look, Shown, field};

/// How long a film of a number of states is, s.
const PER_STATE: f64 = 1.0;
const SHORTEST: f64 = 3.0;
const LONGEST: f64 = 10.0;

/// States follow each other after no less than this share of the film, however near each other they are on the path.
const LEAST: f64 = 0.02;

/// A film of a run.
pub(crate) struct Film {
    run: FieldsOfRun,
    look: Look,
    /// When every state is shown, the first one, which is rest, included, s.
    pub(crate) seconds: Vec<f64>,
    range: Option<[f64; 2]>,
    room: [Vec<Vec3>; 2],
    words: String,
}

impl Film {
    /// The film of a folder; a look has no state of its own.
    ///
    /// # Errors
    /// As for [`crate::picture::picture`].
    pub fn of(folder: &Path, look: &Look) -> Result<Self, Error> {
        let run = FieldsOfRun::read(folder)?;
        let range = range_of_all(&run, look);
        let seconds = seconds(&run.states);
        let problem = &run.analysis.problem;
        let images = if look.view == View::OUTSIDE { problem.images() } else { vec![pneuflex_model::Image::default()] };
        let rest = std::iter::once(problem.mesh.nodes.clone());
        let places = rest.chain(run.states.iter().map(|state| problem.mesh.deformed(&state.displacement)));
        let body: Vec<Vec3> = places
            .flat_map(|nodes| images.iter().flat_map(move |image| nodes.clone().into_iter().map(|x| image.point(x))))
            .collect();
        let times = std::iter::once(0.0).chain(run.states.iter().map(|state| state.time));
        let things = times.flat_map(|time| {
            let of = |obstacle| obstacle_surface(obstacle, LoadParameter(time), &body).corners;
            problem
                .obstacles
                .iter()
                .flat_map(of)
                .flat_map(|[at, _]| images.iter().map(move |image| image.point(at)))
                .collect::<Vec<_>>()
        });
        let things = things.collect();
        let between = "Between the computed states it is interpolated.";
        let ends = "The colours end at the stress that 99 % of the volume stays below.";
        let is_cut = look.range.is_none() && run.stress_range(look.colours, 0..run.states.len()).is_some();
        let words = if is_cut { format!("{between} {ends}") } else { between.to_owned() };
        Ok(Self { look: Look { at: None, ..look.clone() }, range, seconds, room: [body, things], words, run })
    }

    /// How long it is, s.
    pub fn length(&self) -> f64 {
        self.seconds.last().copied().unwrap_or_default()
    }

    /// Its pictures, evenly spread over its length; the first one is at rest, the last one at the last state.
    pub fn pictures(&self, count: usize) -> impl Iterator<Item = Result<Drawing, Error>> {
        let last = count.saturating_sub(1).max(1) as f64;
        (0..count).map(move |number| self.picture(self.length() * number as f64 / last))
    }

    fn picture(&self, second: f64) -> Result<Drawing, Error> {
        let state = at(&self.run.states, &self.seconds, second);
        let shown = Shown { range: self.range, words: &self.words, room: Some(self.room.clone()), sharpness: 1.0 };
        self.run.draw(&self.look, &state, &shown)
    }
}

/// The range of the colours over all states.
pub(crate) fn range_of_all(run: &FieldsOfRun, look: &Look) -> Option<[f64; 2]> {
    let of_all = || {
        let largest = |state: &State| field(state, look.colours).0.map(|values| values.into_iter().fold(0.0, f64::max));
        run.states.iter().filter_map(largest).reduce(f64::max).map(|most| [0.0, most])
    };
    look.range.or_else(|| run.stress_range(look.colours, 0..run.states.len())).or_else(of_all)
}

/// When states are shown after rest, s: at a steady pace along the path.
pub(crate) fn seconds(states: &[State]) -> Vec<f64> {
    let length = (PER_STATE * states.len() as f64).clamp(SHORTEST, LONGEST);
    let times: Vec<f64> = std::iter::once(0.0).chain(states.iter().map(|state| state.time)).collect();
    let steps: Vec<f64> = times.windows(2).map(|two| (two[1] - two[0]).abs()).collect();
    let sum: f64 = steps.iter().sum();
    let least = if sum > 0.0 { LEAST * sum } else { 1.0 };
    let steps: Vec<f64> = steps.into_iter().map(|step| step.max(least)).collect();
    let sum: f64 = steps.iter().sum();
    let mut passed = 0.0;
    let ends = steps.iter().map(|step| {
        passed += step;
        length * passed / sum
    });
    std::iter::once(0.0).chain(ends).collect()
}

/// The state at a second of the film, interpolated between those before and after it.
fn at(states: &[State], seconds: &[f64], second: f64) -> State {
    // `seconds` begins with rest, which is no state.
    let after = seconds.partition_point(|t| *t < second).clamp(1, states.len());
    let share = ((second - seconds[after - 1]) / (seconds[after] - seconds[after - 1])).clamp(0.0, 1.0);
    let end = &states[after - 1];
    let rest;
    let begin = match after.checked_sub(2) {
        Some(before) => &states[before],
        None => {
            rest = State {
                time: 0.0,
                displacement: vec![[0.0; 3]; end.displacement.len()],
                von_mises: vec![0.0; end.von_mises.len()],
                stress: vec![[0.0; 6]; end.stress.len()],
                contact_pressure: vec![0.0; end.contact_pressure.len()],
            };
            &rest
        }
    };
    let mix = |a: f64, b: f64| if share == 1.0 { b } else { a + share * (b - a) };
    let scalars = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| mix(*a, *b)).collect();
    let displacement = begin.displacement.iter().zip(&end.displacement);
    State {
        time: mix(begin.time, end.time),
        displacement: displacement.map(|(a, b)| std::array::from_fn(|d| mix(a[d], b[d]))).collect(),
        von_mises: scalars(&begin.von_mises, &end.von_mises),
        stress: begin.stress.iter().zip(&end.stress).map(|(a, b)| std::array::from_fn(|k| mix(a[k], b[k]))).collect(),
        contact_pressure: scalars(&begin.contact_pressure, &end.contact_pressure),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(time: f64) -> State {
        State {
            time,
            displacement: vec![[time, 0.0, -time]],
            von_mises: vec![2.0 * time],
            stress: vec![[time; 6]],
            contact_pressure: vec![0.0],
        }
    }

    #[test]
    fn a_film_has_every_state_at_its_time_and_a_steady_pace_between() {
        let states = [state(5.0), state(15.0), state(20.0)];
        let seconds = seconds(&states);
        assert_eq!(seconds, [0.0, 0.75, 2.25, 3.0]);
        for (state, second) in states.iter().zip(&seconds[1..]) {
            assert_eq!(at(&states, &seconds, *second), *state);
        }
        let between = at(&states, &seconds, 1.5);
        assert!((between.time - 10.0).abs() < 1e-12 && (between.displacement[0][2] + 10.0).abs() < 1e-12);
        assert_eq!(at(&states, &seconds, 0.0).displacement, [[0.0; 3]]);
        // Where the load turns back, and where it stays.
        let turned = super::seconds(&[state(10.0), state(8.0), state(8.0)]);
        assert!(turned.windows(2).all(|two| two[1] > two[0]), "{turned:?}");
        assert!(super::seconds(&[state(0.0)]) == [0.0, SHORTEST]);
    }
}
