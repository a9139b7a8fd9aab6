//! Which points of a curve are fitted: not those at rest, after the break, in the wrong cycle or out of range.

use std::collections::HashSet;

use crate::curve::{Curve, Point};
use crate::slack::strain_without_stress;

/// A change of direction smaller than this share of the curve's range is noise.
const NOISE: f64 = 0.01;

/// Stress after the maximum, as a share of it, below which the specimen is broken.
const BROKEN: f64 = 0.8;

/// Least number of points of an unloading curve; a new specimen jumps back at once.
const UNLOADING_POINTS: usize = 3;

/// A loading that reaches no further than this share of the largest one is not the one that is meant.
const WHOLE_LOADING: f64 = 0.5;

/// A point that is off what its neighbours say by more than this share of it,
const SPIKE: f64 = 0.3;

/// and by more than this many times what they differ by, is an error of the measurement.
const SPIKE_OVER_SLOPE: f64 = 5.0;

/// A stress at rest above this share of the largest is an offset.
const OFFSET: f64 = 0.01;

/// Which loading of a cyclic test is used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cycles {
    /// The last loading, if there is an unloading; otherwise everything.
    #[default]
    Last,
    /// The first loading, if there is an unloading.
    First,
    /// Every point, unloading too.
    All,
}

/// How a curve is prepared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cleaning {
    /// Which loading.
    pub cycles: Cycles,
    /// Keep what follows the break.
    pub keeps_break: bool,
    /// Keep the stress that was measured at rest in all others, and the strain without stress.
    pub keeps_offset: bool,
    /// Smallest stretch.
    pub from: f64,
    /// Largest stretch.
    pub to: f64,
}

impl Default for Cleaning {
    fn default() -> Self {
        Self { cycles: Cycles::Last, keeps_break: false, keeps_offset: false, from: 0.0, to: f64::INFINITY }
    }
}

/// Points to fit and what was left out.
#[derive(Clone, Debug, PartialEq)]
pub struct Cleaned {
    /// Points that are fitted, in the order of the file.
    pub used: Vec<Point>,
    /// Points that are not, apart from those at rest and duplicates.
    pub unused: Vec<Point>,
    /// What was done, one sentence each.
    pub notes: Vec<String>,
}

/// Chooses the points to fit.
pub fn clean(curve: &Curve, how: &Cleaning) -> Cleaned {
    let mut notes = Vec::new();
    let largest = curve.points.iter().map(|p| p.stress.abs()).fold(0.0, f64::max);
    let (at_rest, moving): (Vec<Point>, Vec<Point>) = curve.points.iter().partition(|p| (p.stretch - 1.0).abs() < 1e-9);
    if !at_rest.is_empty() {
        notes.push(format!("{} left out at stretch 1, where every law gives 0", points(at_rest.len())));
    }
    let moving = match at_rest.iter().find(|p| p.stress.abs() > OFFSET * largest) {
        Some(offset) if how.keeps_offset => {
            notes.push(format!(
                "line {}: {:.4} MPa at stretch 1 is kept as part of every stress",
                offset.line, offset.stress
            ));
            moving
        }
        Some(offset) => {
            notes.push(format!(
                "line {}: {:.4} MPa at stretch 1 is an offset of the load cell or a preload, and taken from every stress; --keep-offset \
                 keeps it",
                offset.line, offset.stress
            ));
            moving.iter().map(|p| Point { stress: p.stress - offset.stress, ..*p }).collect()
        }
        None => moving,
    };
    let (moving, spikes) = without_spikes(&moving);
    if let Some(first) = spikes.first() {
        notes.push(format!(
            "{} left out as errors of the measurement, the first in line {}: {:.4} MPa between neighbours that agree with each other",
            points(spikes.len()),
            first.line,
            first.stress
        ));
    }
    let moving = upwards(moving, &mut notes);
    let (kept, mut unused, has_order) = choose_loading(&moving, how.cycles, &mut notes);
    // Loadings and unloadings that are not meant.
    let others = unused.iter().map(|p| p.line).min();
    unused.extend(spikes);
    let mut used = Vec::new();
    for branch in kept {
        let is_first = branch.first().is_none_or(|first| others.is_none_or(|line| line > first.line));
        let is_as_measured = how.keeps_offset || !has_order;
        let branch = if is_as_measured { branch } else { taut(branch, is_first, &mut unused, &mut notes) };
        let cut = if how.keeps_break || !has_order { None } else { break_of(&branch) };
        let end = cut.unwrap_or(branch.len());
        if let Some(last) = cut.and_then(|c| branch.get(c.wrapping_sub(1))) {
            let after = points(branch.len() - end);
            notes.push(format!(
                "{after} left out after the largest stress in line {} (break); --keep-break keeps them",
                last.line
            ));
        }
        used.extend_from_slice(&branch[..end]);
        unused.extend_from_slice(&branch[end..]);
    }
    let before = used.len();
    let mut seen = HashSet::new();
    used.retain(|p| seen.insert((p.stretch.to_bits(), p.stress.to_bits())));
    if used.len() < before {
        notes.push(format!("{} left out as duplicates", points(before - used.len())));
    }
    let (inside, outside): (Vec<Point>, Vec<Point>) =
        used.into_iter().partition(|p| (how.from..=how.to).contains(&p.stretch));
    if !outside.is_empty() {
        notes.push(format!("{} out of the range", points(outside.len())));
    }
    unused.extend(outside);
    Cleaned { used: inside, unused, notes }
}

/// A loading from where it has stress: the specimen was slack in its first loading, and has grown longer before a later one.
fn taut(branch: Vec<Point>, is_first: bool, unused: &mut Vec<Point>, notes: &mut Vec<String>) -> Vec<Point> {
    let Some(slack) = strain_without_stress(&branch) else { return branch };
    let (slackened, taut): (Vec<Point>, Vec<Point>) = branch.into_iter().partition(|p| p.stretch <= 1.0 + slack);
    let why = if is_first {
        "the specimen was slack: strains are counted from there"
    } else {
        "earlier loadings have left it longer: stretches are of that length"
    };
    notes.push(format!(
        "no stress up to a strain of {:.1} %, {why}; --keep-offset keeps them as they are",
        100.0 * slack
    ));
    unused.extend(slackened);
    let own = |stretch: f64| if is_first { stretch - slack } else { stretch / (1.0 + slack) };
    taut.into_iter().map(|p| Point { stretch: own(p.stretch), ..p }).collect()
}

/// Splits off single points that stand alone between neighbours.
fn without_spikes(all: &[Point]) -> (Vec<Point>, Vec<Point>) {
    let is_spike = |i: usize| {
        let (Some(before), Some(after)) = (i.checked_sub(1).map(|k| all[k]), all.get(i + 1)) else { return false };
        // Between neighbours in order only.
        if (all[i].stretch - before.stretch) * (after.stretch - all[i].stretch) <= 0.0 {
            return false;
        }
        let expected = 0.5 * (before.stress + after.stress);
        let off = (all[i].stress - expected).abs();
        off > SPIKE * expected.abs() && off > SPIKE_OVER_SLOPE * (after.stress - before.stress).abs()
    };
    let (mut kept, mut spikes) = (Vec::new(), Vec::new());
    for i in 0..all.len() {
        if is_spike(i) { spikes.push(all[i]) } else { kept.push(all[i]) }
    }
    (kept, spikes)
}

/// Rows that lead from the largest strain back to rest and nowhere else were written in that order, and not measured so.
fn upwards(mut all: Vec<Point>, notes: &mut Vec<String>) -> Vec<Point> {
    let strain = |p: &Point| p.stretch.ln().abs();
    if let [only] = &branches(&all)[..]
        && only.len() >= UNLOADING_POINTS
        && only.iter().all(|p| (p.stretch > 1.0) == (only[0].stretch > 1.0))
        && strain(&only[only.len() - 1]) < strain(&only[0])
    {
        all.reverse();
        notes.push("the rows lead from the largest strain to the smallest; they are read the other way round".into());
    }
    all
}

fn points(count: usize) -> String {
    format!("{count} {}", if count == 1 { "point" } else { "points" })
}

/// Splits at changes of direction and keeps the loadings that are wanted: those, the other points, and whether stress that
/// falls along a loading is a break.
fn choose_loading(moving: &[Point], cycles: Cycles, notes: &mut Vec<String>) -> (Vec<Vec<Point>>, Vec<Point>, bool) {
    let branches = branches(moving);
    let is_loading = |b: &[Point]| match (b.first(), b.last()) {
        (Some(first), Some(last)) => last.stretch.ln().abs() >= first.stretch.ln().abs(),
        _ => true,
    };
    let crosses_rest = |b: &[Point]| b.iter().any(|p| p.stretch < 1.0) && b.iter().any(|p| p.stretch > 1.0);
    let is_unloading = |b: &[Point]| !is_loading(b) && !crosses_rest(b) && b.len() >= UNLOADING_POINTS;
    // Rows in no order at all are no cycles.
    let is_unordered = branches.len() > 4 && 4 * branches.len() > moving.len();
    if is_unordered {
        return (vec![moving.to_vec()], Vec::new(), false);
    }
    if !branches.iter().any(|b| is_unloading(b)) {
        return (from_their_first_points(branches), Vec::new(), true);
    }
    let reach = |b: &[Point]| b.iter().map(|p| p.stretch.ln().abs()).fold(0.0, f64::max);
    let largest = branches.iter().filter(|b| is_loading(b)).map(|b| reach(b)).fold(0.0, f64::max);
    let is_whole = |b: &[Point]| is_loading(b) && b.len() >= UNLOADING_POINTS && reach(b) >= WHOLE_LOADING * largest;
    let loadings: Vec<usize> = (0..branches.len()).filter(|&i| is_whole(&branches[i])).collect();
    let (chosen, which) = match cycles {
        Cycles::All => {
            notes.push("a cyclic test: loading and unloading are fitted together".into());
            return (vec![moving.to_vec()], Vec::new(), false);
        }
        Cycles::Last => (loadings.last(), "last"),
        Cycles::First => (loadings.first(), "first"),
    };
    let Some(&chosen) = chosen else { return (vec![moving.to_vec()], Vec::new(), false) };
    let kept = branches[chosen].clone();
    let lines = (kept.first().map_or(0, |p| p.line), kept.last().map_or(0, |p| p.line));
    notes.push(format!(
        "a test with {} and unloading: only the {which} loading is fitted, lines {} to {}; --cycles first, last or all",
        if loadings.len() == 1 { "one loading".to_owned() } else { format!("{} loadings", loadings.len()) },
        lines.0,
        lines.1
    ));
    let others = branches.into_iter().enumerate().filter(|(i, _)| *i != chosen).flat_map(|(_, b)| b).collect();
    (vec![kept], others, true)
}

/// Loadings of specimens that follow each other: the jump back to the beginning of the next one is no part of its own.
fn from_their_first_points(branches: Vec<Vec<Point>>) -> Vec<Vec<Point>> {
    let mut loadings: Vec<Vec<Point>> = Vec::new();
    for branch in branches {
        match loadings.last_mut() {
            Some(jump) if jump.len() < UNLOADING_POINTS => jump.extend(branch),
            _ => loadings.push(branch),
        }
    }
    loadings
}

/// The parts between changes of direction; a turning point belongs to the part that leads to it.
fn branches(points: &[Point]) -> Vec<Vec<Point>> {
    let stretch = |i: usize| points[i].stretch;
    let all = || points.iter().map(|p| p.stretch);
    let noise = NOISE * (all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min));
    let mut turns = vec![0];
    let (mut direction, mut extreme) = (0.0, 0);
    for i in 1..points.len() {
        let step = stretch(i) - stretch(extreme);
        if direction == 0.0 {
            if step.abs() > noise {
                (direction, extreme) = (step.signum(), i);
            }
        } else if step * direction >= 0.0 {
            extreme = i;
        } else if step.abs() > noise {
            turns.push(extreme + 1);
            (direction, extreme) = (-direction, i);
        }
    }
    turns.push(points.len());
    turns.windows(2).map(|w| points[w[0]..w[1]].to_vec()).collect()
}

/// Number of points up to and with the largest stress, if the specimen breaks after it.
fn break_of(branch: &[Point]) -> Option<usize> {
    // Tension only: specimens do not break in compression.
    let largest = (0..branch.len()).max_by(|&a, &b| branch[a].stress.total_cmp(&branch[b].stress))?;
    let stress = branch[largest].stress;
    let is_broken = stress > 0.0 && branch[largest + 1..].iter().any(|p| p.stress < BROKEN * stress && p.stretch > 1.0);
    is_broken.then_some(largest + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Mode;

    fn curve(points: impl IntoIterator<Item = (f64, f64)>) -> Curve {
        let points = points.into_iter().enumerate();
        let points = points.map(|(i, (stretch, stress))| Point { stretch, stress, line: i + 2 }).collect();
        Curve { file: "test".into(), mode: Mode::Uniaxial, points }
    }

    fn ramp(from: i32, to: i32, stress: f64) -> Vec<(f64, f64)> {
        let numbers: Vec<i32> = if from < to { (from..=to).collect() } else { (to..=from).rev().collect() };
        numbers.into_iter().map(|i| (1.0 + 0.1 * f64::from(i), stress * f64::from(i))).collect()
    }

    #[test]
    fn rest_and_duplicates_are_left_out() {
        let cleaned =
            clean(&curve([(1.0, 0.0), (1.1, 0.1), (1.1, 0.1), (1.1, 0.11), (1.2, 0.2)]), &Cleaning::default());
        assert_eq!(cleaned.used.len(), 3);
        assert_eq!(cleaned.notes.len(), 2, "{:?}", cleaned.notes);
        let preload = clean(&curve([(1.0, 0.05), (1.1, 0.1), (1.2, 0.2)]), &Cleaning::default());
        assert!(preload.notes.iter().any(|n| n.contains("preload") && n.starts_with("line 2")), "{:?}", preload.notes);
        assert!((preload.used[0].stress - 0.05).abs() < 1e-15 && (preload.used[1].stress - 0.15).abs() < 1e-15);
        let kept = clean(
            &curve([(1.0, 0.05), (1.1, 0.1), (1.2, 0.2)]),
            &Cleaning { keeps_offset: true, ..Cleaning::default() },
        );
        assert_eq!(kept.used[0].stress, 0.1);
    }

    #[test]
    fn the_curve_ends_at_the_break() {
        let mut points = ramp(1, 10, 0.1);
        points.extend([(2.1, 0.95), (2.2, 0.1), (2.3, 0.01)]);
        let cleaned = clean(&curve(points.clone()), &Cleaning::default());
        assert_eq!((cleaned.used.len(), cleaned.unused.len()), (10, 3));
        assert!(cleaned.notes[0].contains("line 11"), "{:?}", cleaned.notes);
        let kept = clean(&curve(points), &Cleaning { keeps_break: true, ..Cleaning::default() });
        assert_eq!(kept.used.len(), 13);
        // A curve with a little noise at its end is whole.
        let mut whole = ramp(1, 10, 0.1);
        whole.push((2.1, 0.99));
        assert_eq!(clean(&curve(whole), &Cleaning::default()).used.len(), 11);
    }

    #[test]
    fn of_a_cyclic_test_one_loading_is_used() {
        let cycle = |stress| [ramp(0, 10, stress), ramp(9, 1, 0.5 * stress)].concat();
        let test = curve([cycle(0.2), cycle(0.15), ramp(0, 10, 0.11)].concat());
        let used = |cycles| clean(&test, &Cleaning { cycles, ..Cleaning::default() }).used;
        let slope = |points: &[Point]| points.last().unwrap().stress;
        assert!((slope(&used(Cycles::Last)) - 1.1).abs() < 1e-12 && used(Cycles::Last).len() >= 9);
        assert!((slope(&used(Cycles::First)) - 2.0).abs() < 1e-12 && used(Cycles::First).len() >= 9);
        assert!(used(Cycles::All).len() > 40);
    }

    #[test]
    fn descending_rows_are_turned_round_and_only_whole_loadings_count() {
        let all = |points: Vec<(f64, f64)>| clean(&curve(points), &Cleaning::default());
        let descending = all(ramp(40, 1, 0.1));
        assert_eq!(descending.used.len(), 40, "{:?}", descending.notes);
        assert!(descending.used[0].stretch < 1.2 && descending.notes[0].contains("other way round"));
        // The rows begin with an unloading; its points are no part of the loading.
        let begins = all([ramp(10, 1, 0.06), ramp(1, 12, 0.1)].concat());
        assert!((11..=12).contains(&begins.used.len()) && begins.used.iter().all(|p| p.stress > 0.09), "{begins:?}");
        // After the test, four points of a new loading.
        let stub = all([ramp(1, 20, 0.1), ramp(19, 1, 0.06), ramp(2, 5, 0.07)].concat());
        assert_eq!(stub.used.len(), 20, "{:?}", stub.notes);
        assert!(stub.notes.iter().any(|n| n.contains("one loading and unloading")), "{:?}", stub.notes);
        // Compression and tension in one go are no unloading.
        assert_eq!(all(ramp(-5, 3, 0.1)).used.len(), 8);
    }

    #[test]
    fn a_spike_is_no_break() {
        let mut points = ramp(1, 20, 0.1);
        points[9].1 *= 3.0;
        let cleaned = clean(&curve(points), &Cleaning::default());
        assert_eq!((cleaned.used.len(), cleaned.unused.len()), (19, 1), "{:?}", cleaned.notes);
        assert!(cleaned.notes.iter().any(|n| n.contains("line 11")), "{:?}", cleaned.notes);
    }

    #[test]
    fn specimens_one_after_the_other_and_sorted_compression_are_no_cycles() {
        let specimens = curve([ramp(0, 10, 0.13), ramp(0, 10, 0.11), ramp(0, 10, 0.12)].concat());
        assert_eq!(clean(&specimens, &Cleaning::default()).used.len(), 30);
        let sorted = curve(ramp(-5, 10, 0.1));
        let cleaned = clean(&sorted, &Cleaning::default());
        assert_eq!(cleaned.used.len(), 15, "{:?}", cleaned.notes);
        let shuffled =
            curve((0..40).map(|i| 0.02 * f64::from(i * 17 % 40)).map(|strain| (1.05 + strain, 0.1 + strain)));
        assert_eq!(clean(&shuffled, &Cleaning::default()).used.len(), 40);
    }
}
