//! What becomes of a problem, and whether two of them agree.

use pneuflex::post::summary::StepSummary;
use pneuflex::{Analysis, Error, Event, Run, Solution, StopToken};

use super::frame::Frame;

/// Largest extent, mm, and shear modulus, MPa, by which small numbers are measured.
#[derive(Clone, Copy, Debug)]
pub struct Measure {
    /// Of the body.
    pub extent: f64,
    /// Of its material.
    pub modulus: f64,
}

/// What becomes of a problem.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// How it ended.
    pub end: End,
    /// States at requested times.
    pub states: Vec<StepSummary>,
    /// Displacements there, mm.
    pub displacements: Vec<Vec<[f64; 3]>>,
    /// Nodes at rest, mm; none if it was refused.
    pub nodes: Vec<[f64; 3]>,
    /// Kinds of warnings.
    pub warnings: Vec<String>,
}

/// How a problem ended.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// At its last time.
    Reached,
    /// Before anything was solved; why.
    Refused(String),
    /// On the way; why.
    Stopped(String),
    /// In a way that nothing can be compared with: not within [`MOST_ITERATIONS`], or after a snap, to one of several shapes.
    Apart(&'static str),
    /// With an equilibrium that nothing can be derived from, or that cannot be recorded: right for no problem.
    Failed(String),
}

const EXHAUSTED: &str = "too many iterations, nothing compared";
const SNAPPED: &str = "a snap, nothing compared";

/// A path that takes more iterations is left where it is: it creeps, as some past a limit point do. Most drawn paths take 10 to 60.
pub const MOST_ITERATIONS: usize = 150;

/// Stops a run by its token after that many iterations.
pub fn limited<'a>(run: Run<'a>, token: &StopToken) -> Run<'a> {
    let (mut count, token) = (0, token.clone());
    run.stop(&token).observer(move |event| {
        if let Event::Iteration(_) = event {
            count += 1;
            if count == MOST_ITERATIONS {
                token.stop();
            }
        }
    })
}

impl Outcome {
    /// Solves a problem with the one thread that calls.
    pub fn of(analysis: &Result<Analysis, Error>) -> Self {
        Self::solved(analysis, |analysis| limited(analysis.run().threads(1), &StopToken::new()).solve())
    }

    /// Solves it in a way.
    pub fn solved(
        analysis: &Result<Analysis, Error>,
        solve: impl FnOnce(&Analysis) -> Result<Solution, Error>,
    ) -> Self {
        let none =
            |end| Self { end, states: Vec::new(), displacements: Vec::new(), nodes: Vec::new(), warnings: Vec::new() };
        let analysis = match analysis {
            Ok(analysis) => analysis,
            Err(error) => return none(End::Refused(error.to_string())),
        };
        let (end, solution) = match solve(analysis) {
            Ok(solution) => {
                let is_lost = |why: &&String| why.contains(UNSTABLE);
                let lost = solution.states.iter().find_map(|state| state.unmet_tolerance.as_ref().filter(is_lost));
                let has_snapped = solution.states.iter().any(|state| !state.snaps.is_empty());
                let reached = if has_snapped { End::Apart(SNAPPED) } else { End::Reached };
                (lost.map_or(reached, |why| End::Stopped(why.clone())), solution)
            }
            Err(Error::NotConverged(ended)) => (End::Stopped(ended.to_string()), ended.reached),
            Err(Error::Interrupted(ended)) => (End::Apart(EXHAUSTED), ended.reached),
            Err(Error::Results(error)) => return none(End::Failed(error.to_string())),
            Err(error) => return none(End::Refused(error.to_string())),
        };
        let mut warnings: Vec<String> = solution.warnings.iter().map(|warning| format!("{:?}", warning.kind)).collect();
        warnings.sort();
        warnings.dedup();
        Self {
            end,
            displacements: solution.fields.into_iter().map(|field| field.displacement).collect(),
            states: solution.states,
            nodes: analysis.problem.mesh.nodes.clone(),
            warnings,
        }
    }
}

/// In the words of an end, or of multipliers that were not brought up to date, at an unstable state.
const UNSTABLE: &str = "an instability";

/// Ends the name of an obstacle that stands for the mirror image of another one.
pub const IMAGE: &str = " in the mirror";

/// What is compared of two outcomes, and how closely.
#[derive(Clone, Debug)]
pub struct Rule {
    /// How the second follows from the first.
    pub frame: Frame,
    /// Largest difference, relative to the largest number of the kind.
    pub tolerance: f64,
    /// Whether nodes are compared, matched by their places at rest.
    pub has_nodes: bool,
    /// Whether the last states alone are compared.
    pub is_last_only: bool,
    /// Whether contact is compared point by point, not only by its forces.
    pub has_same_points: bool,
    /// Whether the kinds of warnings must be the same.
    pub has_same_warnings: bool,
    /// Whether one may stop on the way where the other does not.
    pub may_stop: bool,
    /// Whether the second may be unstable where the first, its half, cannot be: by motions that are not symmetrical.
    pub may_lose_symmetry: bool,
    /// What the second has moved by as a whole at its states, mm (as in the first's frame).
    pub shift: Vec<[f64; 3]>,
    /// Whether stresses are compared, and the greatest invariant.
    pub has_stresses: bool,
    /// Whether forces of single supports are compared.
    pub has_supports: bool,
    /// Whether angle and centreline are those of the same directions.
    pub has_angle: bool,
}

impl Rule {
    /// Everything is the same, to the accuracy of the equilibria.
    pub const fn same(tolerance: f64) -> Self {
        Self {
            frame: Frame::SAME,
            tolerance,
            has_nodes: true,
            is_last_only: false,
            has_same_points: true,
            has_same_warnings: true,
            may_stop: false,
            may_lose_symmetry: false,
            shift: Vec::new(),
            has_stresses: true,
            has_supports: true,
            has_angle: true,
        }
    }
}

/// Whether a relation holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// It does; the largest difference.
    Held(f64),
    /// Both were refused.
    Refused,
    /// Both stopped on the way, and agree so far.
    Stopped(f64),
    /// It does not: why, and by how much.
    Broken(String, f64),
}

/// Compares two outcomes.
pub fn compare(first: &Outcome, second: &Outcome, rule: &Rule, measure: Measure) -> Verdict {
    let is_stopped = match (&first.end, &second.end) {
        (End::Refused(_), End::Refused(_)) => return Verdict::Refused,
        (End::Reached, End::Reached) => false,
        (End::Stopped(_), End::Stopped(_)) => true,
        (End::Apart(_), End::Apart(_) | End::Reached | End::Stopped(_))
        | (End::Reached | End::Stopped(_), End::Apart(_)) => true,
        (End::Stopped(_), End::Reached) | (End::Reached, End::Stopped(_)) if rule.may_stop => {
            return Verdict::Stopped(0.0);
        }
        (End::Reached, End::Stopped(why)) if rule.may_lose_symmetry && why.contains(UNSTABLE) => {
            return Verdict::Stopped(0.0);
        }
        (one, other) => return Verdict::Broken(format!("one is {one:?}, the other {other:?}"), f64::INFINITY),
    };
    let mut worst = Worst::default();
    let count = first.states.len().min(second.states.len());
    if !is_stopped && first.states.len() != second.states.len() {
        let text = format!("{} states, {} states", first.states.len(), second.states.len());
        return Verdict::Broken(text, f64::INFINITY);
    }
    for state in 0..count {
        if rule.is_last_only && (is_stopped || state + 1 < count) {
            continue;
        }
        let shift = rule.shift.get(state).copied().unwrap_or_default();
        worst.state([&first.states[state], &second.states[state]], rule, measure, shift);
        if rule.has_nodes {
            worst.nodes([first, second], state, rule, measure, shift);
        }
    }
    if rule.has_same_warnings && !is_stopped && first.warnings != second.warnings {
        let text = format!("warnings {:?}, warnings {:?}", first.warnings, second.warnings);
        return Verdict::Broken(text, f64::INFINITY);
    }
    match worst {
        Worst { difference, what } if difference > rule.tolerance || difference.is_nan() => {
            Verdict::Broken(what, difference)
        }
        Worst { difference, .. } if is_stopped => Verdict::Stopped(difference),
        Worst { difference, .. } => Verdict::Held(difference),
    }
}

#[derive(Debug, Default)]
struct Worst {
    difference: f64,
    what: String,
}

impl Worst {
    fn add(&mut self, what: &str, expected: &[f64], found: &[f64], scale: f64) {
        if expected.len() != found.len() {
            *self = Self { difference: f64::INFINITY, what: format!("{what}: {expected:?} and {found:?}") };
            return;
        }
        let largest = expected.iter().zip(found).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let difference = largest / scale;
        if difference > self.difference || difference.is_nan() {
            *self = Self { difference, what: format!("{what}: {expected:?} expected, {found:?} found") };
        }
    }

    /// Names that one has and the other lacks.
    fn names<'a>(
        &mut self,
        what: &str,
        one: impl Iterator<Item = &'a String>,
        other: impl Iterator<Item = &'a String>,
    ) {
        let (one, other): (Vec<_>, Vec<_>) = (one.collect(), other.collect());
        if one != other {
            *self = Self { difference: f64::INFINITY, what: format!("{what}: {one:?} and {other:?}") };
        }
    }

    fn state(&mut self, [a, b]: [&StepSummary; 2], rule: &Rule, measure: Measure, shift: [f64; 3]) {
        let frame = &rule.frame;
        let (length, stress) = (frame.length, frame.stress);
        let (area, volume) = (length * length, length.powi(3));
        let Measure { extent, modulus } = measure;
        let when = a.when().0;
        let mut add = |what: &str, expected: &[f64], found: &[f64], scale: f64| {
            self.add(&format!("{what} at {when}"), expected, found, scale);
        };
        add("time", &[frame.time * when], &[b.when().0], when * frame.time);
        let moved = a.probes.values().flatten().fold(1e-2 * extent, |most, u| most.max(u.abs()));
        for (name, at) in &a.probes {
            let expected = std::array::from_fn(|d| at[d] + shift[d]);
            let found = b.probes.get(name).map_or(&[][..], |u| &u[..]);
            add(&format!("probe {name}"), &frame.point(expected), found, length * moved);
        }
        if rule.has_angle {
            let angle = |state: &StepSummary| state.end_face_angle_deg.into_iter().collect::<Vec<f64>>();
            add("angle of the end face", &angle(a), &angle(b), 10.0);
        }
        let largest = a.max_von_mises_mpa.max(1e-2 * modulus);
        if rule.has_stresses {
            let (one, other) = (stress * a.max_von_mises_mpa, b.max_von_mises_mpa);
            add("greatest von Mises stress", &[one], &[other], stress * largest);
            let (one, other) = (stress * a.von_mises_p99_mpa, b.von_mises_p99_mpa);
            add("99 % of von Mises stresses", &[one], &[other], stress * largest);
            let invariant = a.max_invariant_minus_3.max(1e-2);
            add("greatest invariant", &[a.max_invariant_minus_3], &[b.max_invariant_minus_3], invariant);
        }
        let forces = (a.reactions.values().chain([&a.reaction_n]).chain(a.obstacles.values().map(|o| &o.force_n)))
            .flatten()
            .fold(1e-2 * modulus * extent * extent, |most, f| most.max(f.abs()));
        let force = stress * area * forces;
        add("reaction", &frame.force(a.reaction_n), &b.reaction_n, force);
        if rule.has_supports {
            for (name, found) in &b.reactions {
                if let Some(expected) = a.reactions.get(name) {
                    add(&format!("reaction of {name}"), &frame.force(*expected), found, force);
                }
            }
        }
        let energy = a.strain_energy_mj.abs().max(1e-4 * modulus * extent.powi(3));
        add("strain energy", &[stress * volume * a.strain_energy_mj], &[b.strain_energy_mj], stress * volume * energy);
        let pressure = 1e3 * modulus;
        for (name, expected) in &a.cavities {
            let Some(found) = b.cavities.get(name) else { continue };
            let scale = stress * expected.pressure_kpa.abs().max(1e-2 * pressure);
            add(&format!("pressure in {name}"), &[stress * expected.pressure_kpa], &[found.pressure_kpa], scale);
            let of = |volume: Option<f64>, scale: f64| volume.map(|v| scale * v).into_iter().collect::<Vec<f64>>();
            let all = volume * expected.volume_mm3.unwrap_or(1.0).abs();
            let found = of(found.volume_mm3, 1.0);
            add(&format!("volume of {name}"), &of(expected.volume_mm3, volume), &found, all);
        }
        let all = volume * a.cavity_volume_mm3.abs().max(1e-3 * extent.powi(3));
        add("volume of the cavities", &[volume * a.cavity_volume_mm3], &[b.cavity_volume_mm3], all);
        let deep = 1e-2 * extent;
        for (name, expected) in &a.obstacles {
            let Some(found) = b.obstacles.get(name) else { continue };
            add(&format!("force on {name}"), &frame.force(expected.force_n), &found.force_n, force);
            let about = std::array::from_fn(|d| expected.about_mm[d] + shift[d]);
            add(&format!("position of {name}"), &frame.point(about), &found.about_mm, length * extent);
            let moment = force * length * extent;
            add(&format!("moment on {name}"), &frame.moment(expected.moment_nmm), &found.moment_nmm, moment);
            let (one, other) = (length * expected.max_penetration_mm, found.max_penetration_mm);
            add(&format!("depth in {name}"), &[one], &[other], length * deep);
            if rule.has_same_points {
                let (one, other) = (area * expected.area_mm2, found.area_mm2);
                add(&format!("area on {name}"), &[one], &[other], area * extent * extent);
                let images = found.images + usize::from(b.obstacles.contains_key(&format!("{name}{IMAGE}")));
                add(&format!("images of {name}"), &[expected.images as f64], &[images as f64], 1.0);
            }
        }
        let (c, d) = (&a.contact, &b.contact);
        add("depth of the contact", &[length * c.max_penetration_mm], &[d.max_penetration_mm], length * deep);
        if rule.has_same_points {
            add("area of the contact", &[area * c.area_mm2], &[d.area_mm2], area * extent * extent);
            let (one, other) = (stress * volume * c.penalty_energy_mj, d.penalty_energy_mj);
            add("energy of the contact", &[one], &[other], stress * volume * energy);
            let gap = |gap: Option<f64>, scale: f64| gap.map(|gap| scale * gap).into_iter().collect::<Vec<f64>>();
            add("least gap", &gap(c.min_gap_mm, length), &gap(d.min_gap_mm, 1.0), length * extent);
        }
        self.names("obstacles", a.obstacles.keys(), b.obstacles.keys().filter(|name| !name.ends_with(IMAGE)));
    }

    fn nodes(&mut self, [a, b]: [&Outcome; 2], state: usize, rule: &Rule, measure: Measure, shift: [f64; 3]) {
        let (Some(one), Some(other)) = (a.displacements.get(state), b.displacements.get(state)) else { return };
        let frame = &rule.frame;
        let most = one.iter().flatten().fold(1e-2 * measure.extent, |most, u| most.max(u.abs()));
        let close = 1e-5 * measure.extent * frame.length;
        let mut start = 0;
        for (x, u) in a.nodes.iter().zip(one) {
            let at = frame.point(*x);
            let is_there = |y: &[f64; 3]| (0..3).all(|d| (y[d] - at[d]).abs() < close);
            // Mostly the next one.
            let count = b.nodes.len();
            let found = (0..count).map(|i| (start + i) % count).find(|&i| is_there(&b.nodes[i]));
            let Some(found) = found else {
                *self = Self { difference: f64::INFINITY, what: format!("no node at {at:?}") };
                return;
            };
            start = found + 1;
            let expected = frame.point(std::array::from_fn(|d| u[d] + shift[d]));
            self.add(&format!("displacement at {x:?}"), &expected, &other[found], frame.length * most);
        }
    }
}
