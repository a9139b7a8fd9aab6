//! Relations that must hold: one problem, written in two ways, has one solution.
//!
//! A [`Draw`] is a random small problem: a body, elements, a law, supports, cavities, forces, obstacles, solver keys, drawn from all that there
//! are. A [`Relation`] rewrites it into another one whose results must agree with its own to what theory allows; what is refused in one way must
//! be refused in the other. A problem for which a relation fails is shrunk ([`shrink`]) and written down as a small file.
//!
//! * [`draw`]: random problems. Tables are written out key by key: the compiler asks whoever adds one.
//! * [`form`]: one problem as case or model file, deck, mesh, in memory.
//! * [`frame`]: turned, mirrored, in other units.
//! * [`meshes`]: the whole of a half, finer meshes, other elements.
//! * [`rewrite`]: the relations.
//! * [`outcome`]: what becomes of a problem, and whether two outcomes agree.
//! * [`shrink`]: making a problem smaller.
//! * [`vocabulary`]: whether everything is drawn that a file may say.
//! * [`whole_deck`]: a problem in the words of a deck.

pub mod draw;
pub mod form;
pub mod frame;
pub mod meshes;
pub mod outcome;
pub mod rewrite;
pub mod shrink;
pub mod vocabulary;
pub mod whole_deck;

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

pub use draw::{Dice, Draw, Scale};
pub use form::{Files, Form};
pub use outcome::{End, MOST_ITERATIONS, Outcome, Verdict};
pub use rewrite::{ALL, Checked, Relation};

use rewrite::First;

/// What is tried.
#[derive(Clone, Debug)]
pub struct Options {
    /// Numbers of the draws.
    pub draws: Vec<usize>,
    /// Seed of all of them.
    pub seed: u64,
    /// How large they are.
    pub scale: Scale,
    /// A part of the name of the relations to be tried; all if it is empty.
    pub only: String,
}

/// How often a relation held.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    /// Draws that it says something of.
    pub tried: usize,
    /// Of these, how many agree.
    pub held: usize,
    /// Refused on both sides.
    pub refused: usize,
    /// Stopped on the way on both sides, agreeing so far, or on one where the paths differ.
    pub stopped: usize,
    /// It does not hold.
    pub broken: usize,
    /// Largest difference where it holds.
    pub worst: f64,
}

/// A problem for which a relation does not hold.
#[derive(Clone, Debug)]
pub struct Fault {
    /// The relation.
    pub relation: &'static str,
    /// Number of the draw.
    pub draw: usize,
    /// What differs.
    pub why: String,
    /// Files of the problem, after it was shrunk, and of the rewritten one.
    pub files: [Files; 2],
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Report {
    /// Every relation by its name.
    pub relations: Vec<(&'static str, Tally)>,
    /// How many draws were refused, or stopped on the way, and why.
    pub ends: BTreeMap<String, usize>,
    /// In how many draws every key and word was, see [`vocabulary`].
    pub said: BTreeMap<String, usize>,
}

/// Tries all relations on all draws, telling `observe` about every fault.
pub fn run(options: &Options, observe: &(dyn Fn(&Fault) + Sync)) -> Report {
    let tallies = Mutex::new((vec![Tally::default(); ALL.len()], BTreeMap::new(), BTreeMap::new()));
    let next = AtomicUsize::new(0);
    let workers = thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                while let Some(&number) = options.draws.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let draw = Draw::new(&mut Dice::of(options.seed, number), options.scale);
                    let (end, found) = one_draw(options, number, &draw, observe);
                    let mut tallies = tallies.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
                    for (relation, verdict) in found {
                        tallies.0[relation].add(&verdict);
                    }
                    for key in vocabulary::said(&draw) {
                        *tallies.2.entry(key).or_default() += 1;
                    }
                    let end = match end {
                        End::Reached => continue,
                        End::Refused(why) => why,
                        End::Stopped(why) => why,
                        End::Failed(why) => why,
                        End::Apart(why) => why.to_owned(),
                    };
                    *tallies.1.entry(end).or_default() += 1;
                }
            });
        }
    });
    let (tallies, ends, said) = tallies.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    Report { relations: ALL.iter().map(|relation| relation.name).zip(tallies).collect(), ends, said }
}

impl Tally {
    fn add(&mut self, verdict: &Verdict) {
        self.tried += 1;
        match verdict {
            Verdict::Held(difference) => {
                self.held += 1;
                self.worst = self.worst.max(*difference);
            }
            Verdict::Refused => self.refused += 1,
            Verdict::Stopped(_) => self.stopped += 1,
            Verdict::Broken(..) => self.broken += 1,
        }
    }
}

/// How a draw ended, and what became of the relations, by their numbers.
fn one_draw(
    options: &Options,
    number: usize,
    draw: &Draw,
    observe: &(dyn Fn(&Fault) + Sync),
) -> (End, Vec<(usize, Verdict)>) {
    let analysis = draw.analysis(Form::Text);
    let Some(analysis) = analysis else { return (End::Reached, Vec::new()) };
    let outcome = Outcome::of(&analysis);
    let mut found = Vec::new();
    if matches!(outcome.end, End::Apart(_)) {
        return (outcome.end, found);
    }
    for (which, relation) in ALL.iter().enumerate().filter(|(_, relation)| relation.name.contains(&options.only)) {
        let first = First { draw, analysis: &analysis, outcome: &outcome };
        let mut dice = || Dice::of(options.seed + 1 + which as u64, number);
        let Some(checked) = guarded(relation, &first, &mut dice()) else { continue };
        if let Verdict::Broken(..) = checked.verdict {
            observe(&shrunk(relation, number, draw.clone(), checked.clone_with(draw), &mut dice));
        }
        found.push((which, checked.verdict));
    }
    (outcome.end, found)
}

/// A panic is a fault of its own.
fn guarded(relation: &Relation, first: &First<'_>, dice: &mut Dice) -> Option<Checked> {
    catch_unwind(AssertUnwindSafe(|| (relation.check)(first, dice))).unwrap_or_else(|_| {
        Some(Checked { verdict: Verdict::Broken("it panicked".into(), f64::INFINITY), files: Vec::new() })
    })
}

impl Checked {
    fn clone_with(&self, draw: &Draw) -> (String, [Files; 2]) {
        let why = match &self.verdict {
            Verdict::Broken(why, difference) => format!("{why} (difference {difference:.2e})"),
            other => format!("{other:?}"),
        };
        (why, [draw.files(Form::Text).unwrap_or_default(), self.files.clone()])
    }
}

/// The smallest problem found for which the relation still fails.
fn shrunk(
    relation: &Relation,
    number: usize,
    mut draw: Draw,
    mut known: (String, [Files; 2]),
    dice: &mut dyn FnMut() -> Dice,
) -> Fault {
    const MOST_ATTEMPTS: usize = 25;
    let mut attempts = 0;
    'again: loop {
        for smaller in shrink::smaller(&draw) {
            attempts += 1;
            if attempts > MOST_ATTEMPTS {
                break 'again;
            }
            let Some(analysis) = smaller.analysis(Form::Text) else { continue };
            let outcome = Outcome::of(&analysis);
            let first = First { draw: &smaller, analysis: &analysis, outcome: &outcome };
            let Some(checked) = guarded(relation, &first, &mut dice()) else { continue };
            if matches!(checked.verdict, Verdict::Broken(..)) {
                known = checked.clone_with(&smaller);
                draw = smaller;
                continue 'again;
            }
        }
        break;
    }
    let (why, files) = known;
    Fault { relation: relation.name, draw: number, why, files }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Among a few hundred draws is every kind of body, and most can be solved.
    #[test]
    fn draws_are_of_every_kind() {
        let kinds: BTreeSet<&str> =
            (0..100).map(|number| Draw::new(&mut Dice::of(3, number), Scale::Small).kind()).collect();
        assert_eq!(kinds, BTreeSet::from(["actuator", "block", "case"]));
    }
}
