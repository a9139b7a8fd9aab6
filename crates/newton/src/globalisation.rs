//! Globalisation of Newton's method (theory §13): which tangent the next correction comes from, and what becomes of it.
//!
//! One object sees every correction and returns a [`Verdict`]. What it does beyond Newton's own method: a factor is used again while it
//! contracts (modified Newton), a correction from a tangent that is nearly singular is found once more with the stresses of the last
//! equilibrium in the tangent, corrections that run in circles are halved, and what runs away is given up.

use pneuflex_model::Solver;

use crate::convergence::Scales;
use crate::failure::Cause;
use crate::rotation_update::Extent;
use crate::tuning::Tuning;

/// The tangent that the next correction comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// A new one.
    New,
    /// A new one that carries the stresses of the last equilibrium: far from the path, those that the linear system predicted can be so
    /// large that nothing of the tangent is left.
    Cautious,
    /// The one at hand (modified Newton).
    AtHand,
}

/// What becomes of a correction.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// It is applied.
    Accept,
    /// This share of it is applied.
    Shorten(f64),
    /// It is thrown away; the next one comes from a new tangent.
    Refactor,
    /// The attempt is given up.
    Reject(Cause),
}

/// Measures of a correction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measures {
    /// ‖\[Δq; Δλ\]‖ with lengths in mean spacings h of the nodes and forces in μ h², μ the shear modulus.
    pub norm: f64,
    /// Largest component of Δq, in mean spacings of the nodes.
    pub largest: f64,
    /// Residual norm before it, N.
    pub residual: f64,
    /// Contact points that carry traction.
    pub contact_points: usize,
    /// Whether the tangent that it comes from is indefinite.
    pub is_unstable: bool,
}

/// The policy of one attempt.
pub struct Globalisation<'a> {
    tuning: &'a Tuning,
    settings: &'a Solver,
    /// Largest extent of the body, in [`Scales::length`].
    size: f64,
    choice: Choice,
    iteration: usize,
    /// Whether there is a tangent from near the guess, from which the first correction comes.
    has_tangent: bool,
    /// Corrections since the last tangent.
    modified: usize,
    /// The last correction that was applied.
    last: Measures,
    /// Whether the factor at hand may serve once more.
    goes_on: bool,
    /// Norms of the corrections of new tangents.
    norms: Vec<f64>,
    /// Fewest and most touching points of the last iterations.
    touching: (usize, usize),
    /// How many of them had stable tangents, and how many unstable ones.
    stability: [usize; 2],
    /// Fewest touching points of all iterations, and how many tangents ago they were seen.
    fewest: (usize, usize),
    /// The last correction of a new tangent, and how many of them in a row were below the tolerance and left the residual as it was.
    stall: (Measures, usize),
}

/// New tangents in a row whose corrections are below the tolerance and leave the residual as it is, before that is called rounding.
const STALLED: usize = 3;

/// A residual that keeps more than this share is as it was.
const AS_IT_WAS: f64 = 0.5;

/// Iterations at the end over which the touching points are watched.
const WATCHED: usize = 6;

/// A last correction below this is that of a contact which does not settle rather than of an iteration that is lost.
const SETTLING: f64 = 1.0;

/// Contact peels off if fewer points touch than ever before in one of so many tangents,
const PEELING: usize = 3;

/// and has this many times the iterations that a step has else.
const MOST_PEELING: usize = 4;

impl<'a> Globalisation<'a> {
    /// The policy of an attempt for a body, which `has_tangent` from near the guess, or has not.
    pub fn new(tuning: &'a Tuning, settings: &'a Solver, scales: &Scales, has_tangent: bool) -> Self {
        Self {
            tuning,
            settings,
            size: scales.size / scales.length,
            choice: Choice::New,
            iteration: 0,
            has_tangent,
            modified: 0,
            last: Measures::default(),
            goes_on: has_tangent,
            norms: Vec::new(),
            touching: (usize::MAX, 0),
            stability: [0; 2],
            fewest: (usize::MAX, 0),
            stall: (Measures { norm: f64::INFINITY, ..Measures::default() }, 0),
        }
    }

    /// Tangents so far.
    pub fn iteration(&self) -> usize {
        self.iteration
    }

    /// The tangent that the present correction comes from.
    pub fn choice(&self) -> Choice {
        self.choice
    }

    /// Where the next correction comes from; `None` when the iterations are used up.
    pub fn next_tangent(&mut self) -> Option<Choice> {
        if self.iteration >= self.settings.max_iterations && !self.peels_off() {
            return None;
        }
        let contracts = self.last.largest < self.tuning.modified_below && self.goes_on;
        if (self.iteration > 0 || self.has_tangent) && contracts && self.modified < self.tuning.most_modified {
            self.modified += 1;
            self.choice = Choice::AtHand;
        } else {
            self.modified = 0;
            self.iteration += 1;
            if self.choice != Choice::Cautious {
                self.choice = Choice::New;
            }
        }
        Some(self.choice)
    }

    /// Judges a correction. `extent` computes how much it deforms the body, and is asked only if that matters; under `is_prescribed` motion
    /// of the supports there is no second attempt.
    pub fn judge(&mut self, now: Measures, is_prescribed: bool, extent: impl FnOnce() -> Extent) -> Verdict {
        let tuning = self.tuning;
        if !now.norm.is_finite() || now.largest > tuning.runaway * self.size {
            return Verdict::Reject(Cause::Diverged { correction: now.norm });
        }
        if self.choice == Choice::AtHand {
            return self.judge_modified(now);
        }
        if now.largest > tuning.harmless && extent().exceeds(&tuning.hopeless) {
            if self.choice == Choice::Cautious || is_prescribed {
                return Verdict::Reject(Cause::Diverged { correction: now.norm });
            }
            self.choice = Choice::Cautious;
            self.goes_on = false;
            return Verdict::Refactor;
        }
        self.norms.push(now.norm);
        let before = self.norms.len().checked_sub(1 + tuning.circle).map(|index| self.norms[index]);
        let circles = before.is_some_and(|before| now.norm > tuning.not_smaller * before);
        self.watch(&now);
        self.watch_rounding(now);
        self.last = now;
        self.goes_on = true;
        if circles && self.iteration >= tuning.circling_from { Verdict::Shorten(0.5) } else { Verdict::Accept }
    }

    /// A correction of the factor at hand: it goes on while it needs few more corrections to get there; one that hardly contracts is
    /// thrown away.
    fn judge_modified(&mut self, now: Measures) -> Verdict {
        self.watch(&now);
        if self.iteration == 0 && self.last.norm == 0.0 {
            self.goes_on = now.largest < self.tuning.modified_below;
            self.last = now;
            return if self.goes_on { Verdict::Accept } else { Verdict::Refactor };
        }
        let ratio = now.norm / self.last.norm;
        if ratio >= self.tuning.modified_contraction && now.norm >= self.settings.tolerance {
            self.goes_on = false;
            return Verdict::Refactor;
        }
        self.goes_on = ratio * ratio * now.norm < self.settings.tolerance;
        self.last = now;
        Verdict::Accept
    }

    /// The correction was applied, and its attempt goes on. Says whether the tangent was a cautious one: its inertia and its correction say
    /// nothing about the equilibrium.
    pub fn was_cautious(&mut self) -> bool {
        let was = self.choice == Choice::Cautious;
        if was {
            self.choice = Choice::New;
        }
        was
    }

    /// Why the iterations did not suffice; `node` is where the residual is largest.
    pub fn exhausted(&self, node: usize) -> Cause {
        let (least, most) = self.touching;
        if most > least && self.last.norm < SETTLING {
            let becomes_unstable = self.stability.iter().all(|count| *count > 0);
            return Cause::ContactChatter { least, most, becomes_unstable };
        }
        Cause::TooManyIterations {
            iterations: self.settings.max_iterations,
            correction: self.last.norm,
            residual: self.last.residual,
            node,
        }
    }

    /// Whether corrections have long been below the tolerance, and the residual falls no more: what is left of it is rounding. With contact
    /// points that come and go it may be something else.
    pub fn is_stalled(&self) -> bool {
        self.stall.1 >= STALLED
    }

    fn watch_rounding(&mut self, now: Measures) {
        let (before, count) = self.stall;
        let is_as_it_was = now.residual > AS_IT_WAS * before.residual && now.contact_points == before.contact_points;
        let is_small = |measures: &Measures| measures.norm < self.settings.tolerance;
        self.stall = (now, if is_as_it_was && is_small(&now) && is_small(&before) { count + 1 } else { 0 });
    }

    /// Whether contact still peels off, front by front: then another tangent is worth more than a smaller step, over which as many points open.
    fn peels_off(&self) -> bool {
        self.fewest.1 < PEELING && self.iteration < MOST_PEELING * self.settings.max_iterations
    }

    fn watch(&mut self, now: &Measures) {
        let touching = now.contact_points;
        self.fewest = if touching < self.fewest.0 { (touching, 0) } else { (self.fewest.0, self.fewest.1 + 1) };
        if self.iteration + WATCHED > self.settings.max_iterations {
            self.touching = (self.touching.0.min(touching), self.touching.1.max(touching));
            self.stability[usize::from(now.is_unstable)] += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TUNING: fn() -> Tuning = Tuning::default;

    fn measures(norm: f64) -> Measures {
        Measures { norm, largest: norm, residual: norm, ..Measures::default() }
    }

    fn scales() -> Scales {
        Scales { size: 100.0, ..Scales::of_unit_cube() }
    }

    fn small() -> Extent {
        Extent::default()
    }

    #[test]
    fn a_factor_is_used_again_while_it_contracts() {
        let (tuning, settings) = (TUNING(), Solver::default());
        let mut policy = Globalisation::new(&tuning, &settings, &scales(), false);
        assert_eq!(policy.next_tangent(), Some(Choice::New));
        assert_eq!(policy.judge(measures(1.0), false, small), Verdict::Accept);
        // Too large to go on with the factor at hand.
        assert_eq!(policy.next_tangent(), Some(Choice::New));
        assert_eq!(policy.judge(measures(1e-2), false, small), Verdict::Accept);
        assert_eq!(policy.next_tangent(), Some(Choice::AtHand));
        assert_eq!(policy.judge(measures(1e-5), false, small), Verdict::Accept);
        assert_eq!(policy.next_tangent(), Some(Choice::AtHand));
        // Hardly smaller: thrown away, a new tangent follows.
        assert_eq!(policy.judge(measures(0.9e-5), false, small), Verdict::Refactor);
        assert_eq!(policy.next_tangent(), Some(Choice::New));
        assert_eq!(policy.iteration(), 3);
    }

    #[test]
    fn a_tangent_from_near_the_guess_gives_the_first_corrections() {
        let (tuning, settings) = (TUNING(), Solver::default());
        let policy = || Globalisation::new(&tuning, &settings, &scales(), true);
        let mut near = policy();
        for norm in [1e-2, 1e-5] {
            assert_eq!(near.next_tangent(), Some(Choice::AtHand));
            assert_eq!(near.judge(measures(norm), false, small), Verdict::Accept);
        }
        assert_eq!((near.next_tangent(), near.iteration()), (Some(Choice::AtHand), 0));
        // A large correction is not its business.
        let mut far = policy();
        assert_eq!(far.next_tangent(), Some(Choice::AtHand));
        assert_eq!(far.judge(measures(1.0), false, small), Verdict::Refactor);
        assert_eq!((far.next_tangent(), far.iteration()), (Some(Choice::New), 1));
        assert_eq!(far.judge(measures(0.9), false, small), Verdict::Accept);
    }

    #[test]
    fn a_hopeless_correction_is_found_once_more_and_then_given_up() {
        let (tuning, settings) = (TUNING(), Solver::default());
        let huge = || Extent { stretch: 2.0, angle: 0.0 };
        let mut policy = Globalisation::new(&tuning, &settings, &scales(), false);
        policy.next_tangent();
        assert_eq!(policy.judge(measures(1.0), false, huge), Verdict::Refactor);
        assert_eq!(policy.next_tangent(), Some(Choice::Cautious));
        assert_eq!(policy.judge(measures(0.5), false, small), Verdict::Accept);
        assert!(policy.was_cautious() && !policy.was_cautious());
        assert_eq!(policy.next_tangent(), Some(Choice::New));
        assert_eq!(policy.judge(measures(1.0), false, huge), Verdict::Refactor);
        policy.next_tangent();
        assert_eq!(policy.judge(measures(1.0), false, huge), Verdict::Reject(Cause::Diverged { correction: 1.0 }));
        // Not where supports move.
        let mut policy = Globalisation::new(&tuning, &settings, &scales(), false);
        policy.next_tangent();
        assert!(matches!(policy.judge(measures(1.0), true, huge), Verdict::Reject(_)));
        // Nor for a correction that is small.
        let mut policy = Globalisation::new(&tuning, &settings, &scales(), false);
        policy.next_tangent();
        assert_eq!(policy.judge(measures(0.05), false, huge), Verdict::Accept);
    }

    #[test]
    fn circles_are_broken_by_halving() {
        let (tuning, settings) = (TUNING(), Solver::default());
        let mut policy = Globalisation::new(&tuning, &settings, &scales(), false);
        for iteration in 1..=9 {
            policy.next_tangent();
            let verdict = policy.judge(measures(0.5), false, small);
            let expected = if iteration >= 8 { Verdict::Shorten(0.5) } else { Verdict::Accept };
            assert_eq!(verdict, expected, "iteration {iteration}");
        }
    }

    #[test]
    fn what_runs_away_or_is_no_number_is_rejected() {
        let (tuning, settings) = (TUNING(), Solver::default());
        for bad in [f64::NAN, f64::INFINITY, 2e5] {
            let mut policy = Globalisation::new(&tuning, &settings, &scales(), false);
            policy.next_tangent();
            let verdict = policy.judge(measures(bad), false, small);
            assert!(matches!(verdict, Verdict::Reject(Cause::Diverged { .. })), "{bad}");
        }
    }

    #[test]
    fn the_reason_of_an_exhausted_attempt_is_contact_where_points_keep_changing() {
        let tuning = TUNING();
        let settings = Solver { max_iterations: 8, ..Solver::default() };
        let exhaust = |points: fn(usize) -> usize, is_unstable: fn(usize) -> bool| {
            let mut policy = Globalisation::new(&tuning, &settings, &scales(), false);
            let mut count = 0;
            while policy.next_tangent().is_some() {
                let now = Measures { contact_points: points(count), is_unstable: is_unstable(count), ..measures(0.4) };
                policy.judge(now, false, small);
                count += 1;
            }
            (count, policy.exhausted(7))
        };
        // Where the body is unstable without the point that opens there is a limit, and not where it is unstable anyway.
        for (is_unstable, becomes_unstable) in
            [((|_| false) as fn(usize) -> bool, false), (|_| true, false), (|count| count % 2 == 0, true)]
        {
            let chatter = Cause::ContactChatter { least: 10, most: 11, becomes_unstable };
            assert_eq!(exhaust(|count| 10 + count % 2, is_unstable), (8, chatter));
        }
        let lost = Cause::TooManyIterations { iterations: 8, correction: 0.4, residual: 0.4, node: 7 };
        assert_eq!(exhaust(|_| 10, |_| false), (8, lost));
    }

    #[test]
    fn contact_that_peels_off_has_more_iterations() {
        let (tuning, settings) = (TUNING(), Solver { max_iterations: 8, ..Solver::default() });
        let iterations = |points: &dyn Fn(usize) -> usize| {
            let mut policy = Globalisation::new(&tuning, &settings, &scales(), false);
            let mut count = 0;
            while policy.next_tangent().is_some() {
                policy.judge(Measures { contact_points: points(count), ..measures(0.4) }, false, small);
                count += 1;
            }
            count
        };
        assert_eq!(iterations(&|count| 900 - 10 * count), 32);
        assert_eq!(iterations(&|count| 900 - 10 * count.min(12)), 12 + PEELING + 1);
        assert_eq!(iterations(&|count| 900 - count % 2), 8);
        assert_eq!(iterations(&|count| 10 + count), 8);
    }

    #[test]
    fn a_residual_that_no_correction_makes_smaller_is_rounding() {
        let (tuning, settings) = (TUNING(), Solver::default());
        let stalls_after = |measures: &dyn Fn(usize) -> Measures| {
            let mut policy = Globalisation::new(&tuning, &settings, &scales(), false);
            (0..9).find(|&count| {
                policy.next_tangent();
                policy.choice = Choice::New;
                policy.judge(measures(count), false, small);
                policy.is_stalled()
            })
        };
        let of = |norm: f64, residual: f64| Measures { norm, largest: norm, residual, ..Measures::default() };
        let small_corrections = |count: usize| of(1e-14, 1e-7 * (1.0 + 0.1 * count as f64));
        assert_eq!(stalls_after(&small_corrections), Some(STALLED));
        // Corrections that are still large, a residual that still falls, contact that has not settled.
        assert_eq!(stalls_after(&|_| of(1e-3, 1e-7)), None);
        assert_eq!(stalls_after(&|count| of(1e-14, 0.4_f64.powi(count as i32))), None);
        assert_eq!(stalls_after(&|count| Measures { contact_points: count, ..of(1e-14, 1e-7) }), None);
    }
}
