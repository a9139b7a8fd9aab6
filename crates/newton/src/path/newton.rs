//! One load step: a guess along the tangent, and Newton's method from there.

use pneuflex_assembly::Request;
use pneuflex_model::Material;

use super::{Converged, Observer, Path, State, Target, add, difference};
use crate::history::{Cause, Event, IterationRecord};
use crate::system::Correction;
use crate::warp::Extent;

/// A correction this much larger than the body is no use.
const RUNAWAY: f64 = 1e3;

/// Guesses are shortened where they would drive walls deeper than this into each other, mm.
const DEEP: f64 = 0.2;

/// By how much a guess is shortened at a time, and at the most.
const SHORTEN: f64 = 0.7;
const SHORTEST: f64 = 0.03;

/// Guesses are shortened to this stretching and rotation (radians) at any point: Newton's method hardly returns from further away.
const GUESS: Extent = Extent { stretch: 0.2, angle: 0.7 };

/// A correction with more stretching or rotation than this comes from a tangent that is nearly singular, and leads nowhere.
const HOPELESS: Extent = Extent { stretch: 0.7, angle: 1.5 };

/// Corrections smaller than this are not hopeless, mm.
const HARMLESS: f64 = 0.1;

/// From this iteration on a correction that is not clearly smaller than the one so many tangents before is halved: contact points that
/// open and close in turn let Newton's method run in circles.
const CIRCLING_FROM: usize = 8;
const CIRCLE: usize = 3;
const NOT_SMALLER: f64 = 0.7;

/// A load step that is not a requested one is good enough when no node moves further than this, mm, and nothing is stretched further than
/// this: in small elements 0.1 mm would leave stresses from which there is no going on.
const LOOSE: f64 = 0.1;
const LOOSE_STRETCH: f64 = 0.05;

/// Materials whose bulk modulus is a larger multiple of the shear modulus than this allow the less of it, the less they allow of a change of
/// volume.
const LOOSE_RATIO: f64 = 2e4;

/// Once a correction moves no node further than this (mm), the factor at hand is tried for the next ones.
const STALE_BELOW: f64 = 0.05;

/// Corrections in a row with the same old factor, at the most.
const MOST_STALE: usize = 8;

/// Displacements of supports below this are rounding, mm.
const ROUNDED: f64 = 1e-13;

/// Residuals below this are rounding, N: it bounds the relative tolerance from below where the load is tiny.
const RESIDUAL_FLOOR: f64 = 1e-9;

/// Rounding is accepted in the residual up to this multiple of the tolerance asked for.
const MOST_ROUNDING: f64 = 10.0;

/// Unknowns up to which the tolerance of the correction's norm can be met whatever the rounding. Beyond, rounding makes the norm
/// grow with the root of their number.
const FEW_UNKNOWNS: f64 = 1e4;

/// A correction with an old factor that is not smaller than this share of the one before is thrown away.
const STALE_CONTRACTION: f64 = 0.5;

/// Measures of a correction.
#[derive(Clone, Copy, Default)]
struct Measures {
    /// ‖\[Δq; Δλ\]‖, mm and N.
    norm: f64,
    /// Largest component of Δq, mm.
    largest: f64,
    /// Whether the next one is to be tried with the same factor.
    goes_on: bool,
    /// Residual norm before it, N.
    residual: f64,
}

/// Stretching by a correction after which the state is good enough to go on from.
pub(super) fn loose_stretch(materials: &[&Material]) -> f64 {
    let ratio = materials.iter().map(|m| m.bulk_modulus / m.shear_modulus()).fold(LOOSE_RATIO, f64::max);
    LOOSE_STRETCH * LOOSE_RATIO / ratio
}

impl Path {
    /// One load step towards `aim`, a time that becomes the one that is tried: a guess along the tangent, cut short where it
    /// would deform the body too much or drive walls deep into each other, and Newton's method from there, to the end only at the
    /// time asked for.
    pub(super) fn load_step(
        &mut self,
        aim: &mut f64,
        requested: f64,
        observer: Observer<'_>,
    ) -> Result<Converged, Cause> {
        let wanted = *aim;
        let start = self.state.time;
        let (mut u, mut border) = (self.state.displacement.clone(), self.state.border.clone());
        let mut iterations = 0;
        self.check_stop()?;
        if !self.has_factor {
            self.system.carry_pressures(&u);
            self.system.assemble(&u, start, &border, Request::Tangent)?;
            self.system.factorize()?;
            self.iterations += 1;
            iterations = 1;
        }
        // The present loads in the factor, the new ones in the residual: with the new pressure in K as well, K is
        // indefinite where the stresses that balance it are still missing.
        self.system.assemble(&u, wanted, &border, Request::Residual)?;
        let prescribed = self.prescribed(wanted, &u);
        let correction = self.system.solve(prescribed.as_deref())?;
        self.has_factor = false;
        let allowed = self.system.deepest_penetration(&u).max(DEEP);
        let extent = self.system.extent(&u, &correction.displacement);
        self.first_rate.get_or_insert(extent.stretch / (wanted - start));
        let mut share = (GUESS.stretch / extent.stretch).min(GUESS.angle / extent.angle).min(1.0);
        let shortest = SHORTEST * share;
        loop {
            let guess = correction.scaled(share);
            let mut trial = u.clone();
            self.system.warp(&mut trial, &guess.displacement)?;
            if share * SHORTEN < shortest || self.system.deepest_penetration(&trial) <= allowed {
                self.system.carry(&u, &guess.displacement);
                u = trial;
                add(&mut border, &guess.border);
                break;
            }
            share *= SHORTEN;
        }
        let time = if share < 1.0 { start + share * (wanted - start) } else { wanted };
        *aim = time;
        let target = if time == requested { Target::Requested } else { Target::OnTheWay };
        observer(Event::StepStarted { step: self.step, time });
        let held = self.moving.as_ref().map(|problem| problem.held_displacement(time));
        let mut converged = self.newton(time, (u, border), held, target, observer)?;
        converged.iterations += iterations;
        Ok(converged)
    }

    /// Residual norm that rounding leaves, N: positions x are known to ε|x|, their gradients to ε|x|/h with the element size h,
    /// pressures to κ ε|x|/h, and forces on an element to κ ε|x| h; over n nodes that adds up to √n times as much.
    fn rounding(&self, displacement: &[[f64; 3]]) -> f64 {
        let largest = displacement.as_flattened().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        self.rounding_per_mm * (self.size + largest)
    }

    /// Newton's method at one time from a guess of the displacements and the unknowns beside them; `held` are the displacements wanted
    /// at held degrees of freedom, if they are to move.
    pub(super) fn newton(
        &mut self,
        time: f64,
        (mut u, mut border): (Vec<[f64; 3]>, Vec<f64>),
        held: Option<Vec<[f64; 3]>>,
        target: Target,
        observer: Observer<'_>,
    ) -> Result<Converged, Cause> {
        let mut multipliers = self.state.multipliers.clone();
        let load = self.system.load_norm(&u, time, &border).max(f64::MIN_POSITIVE);
        let rounding = self.rounding(&u).min(MOST_ROUNDING * self.settings.residual_tolerance * load);
        // What a correction cannot fall below once the residual is rounding.
        let unknowns = self.system.held().iter().filter(|held| !**held).count() as f64;
        let rounded_tolerance = self.settings.tolerance * (unknowns / FEW_UNKNOWNS).sqrt().max(1.0);
        let (mut least, mut most) = (usize::MAX, 0);
        let mut last = Measures::default();
        let mut negative_pivots = 0;
        let (mut iteration, mut stale) = (0, 0);
        let mut norms: Vec<f64> = Vec::new();
        let mut is_cautious = false;
        while iteration < self.settings.max_iterations {
            self.check_stop()?;
            // An old factor serves as long as it contracts well; a new one is an iteration.
            let is_stale = iteration > 0 && last.largest < STALE_BELOW && last.goes_on && stale < MOST_STALE;
            if is_stale {
                stale += 1;
                self.system.assemble(&u, time, &border, Request::Residual)?;
            } else {
                stale = 0;
                iteration += 1;
                self.iterations += 1;
                if is_cautious {
                    self.system.carry_pressures(&self.state.displacement);
                }
                self.system.assemble(&u, time, &border, Request::Tangent)?;
                negative_pivots = self.system.factorize()?.negative;
            }
            let residual = self.system.free_norm(self.system.totals().residual.as_flattened());
            let prescribed = held.as_deref().map(|target| difference(target, &u));
            let prescribed = prescribed.filter(|change| self.is_felt(change));
            let correction = self.system.solve(prescribed.as_deref())?;
            let updated = self.system.multipliers(&correction)?;
            let straight = correction.displacement.as_flattened();
            let squared: f64 = straight.iter().map(|x| x * x).sum::<f64>()
                + updated.iter().zip(&multipliers).map(|(a, b)| (a - b) * (a - b)).sum::<f64>()
                + correction.border.iter().map(|y| y * y).sum::<f64>();
            let largest = straight.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            let norm = squared.sqrt();
            let ratio = if is_stale { norm / last.norm } else { 0.0 };
            // An old factor goes on while it needs few more corrections to get there.
            let goes_on = ratio * ratio * norm < self.settings.tolerance || !is_stale;
            let now = Measures { norm, largest, goes_on, residual };
            multipliers = updated;
            let touching = self.system.contact_points();
            let record = IterationRecord {
                step: self.step,
                iteration,
                new_tangent: !is_stale,
                time,
                correction: now.norm,
                residual,
                relative_residual: residual / load,
                contact_points: touching,
                negative_pivots,
                elapsed_s: self.spent.total_s + self.begin.elapsed().as_secs_f64(),
            };
            observer(Event::Iteration(&record));
            if !now.norm.is_finite() || largest > RUNAWAY * self.size {
                return Err(Cause::Diverged { correction: now.norm });
            }
            let mut correction = correction;
            if !is_stale {
                if largest > HARMLESS && self.system.extent(&u, &correction.displacement).exceeds(&HOPELESS) {
                    // Once with the stresses of the last equilibrium in the tangent: far from the path, those that the linear system
                    // predicted can be so large that nothing of the tangent is left.
                    if is_cautious || prescribed.is_some() {
                        return Err(Cause::Diverged { correction: now.norm });
                    }
                    is_cautious = true;
                    continue;
                }
                norms.push(norm);
                let before = norms.len().checked_sub(1 + CIRCLE).map(|index| norms[index]);
                if iteration >= CIRCLING_FROM && before.is_some_and(|before| norm > NOT_SMALLER * before) {
                    correction = correction.scaled(0.5);
                }
            }
            if iteration + 6 > self.settings.max_iterations {
                (least, most) = (least.min(touching), most.max(touching));
            }
            // A correction with an old factor that hardly contracts is thrown away.
            let is_used = ratio < STALE_CONTRACTION || norm < self.settings.tolerance;
            if is_used {
                self.system.carry(&u, &correction.displacement);
                self.system.warp(&mut u, &correction.displacement)?;
                add(&mut border, &correction.border);
            }
            if !is_used {
                last.goes_on = false;
                continue;
            }
            last = now;
            // Small corrections of an unstable tangent lead away from the path.
            if target == Target::OnTheWay && negative_pivots == 0 && self.is_small(&u, &correction) {
                self.has_factor = !is_stale;
                let mut converged = self.converged(time, (u, border), multipliers, iteration);
                converged.state.is_loose = true;
                return Ok(converged);
            }
            let was_cautious = std::mem::take(&mut is_cautious);
            let is_rounding = residual <= rounding && last.norm < rounded_tolerance;
            if was_cautious {
                // The inertia of such a tangent says nothing about the equilibrium.
                continue;
            }
            if last.norm < self.settings.tolerance || is_rounding {
                self.system.assemble(&u, time, &border, Request::Residual)?;
                let residual = self.system.free_norm(self.system.totals().residual.as_flattened());
                // Where supports or cavities drive the body, what the loads were at the guess says little.
                let driven = if held.is_some() || !border.is_empty() {
                    self.system.load_norm(&u, time, &border).max(self.system.reaction_norm())
                } else {
                    0.0
                };
                let is_satisfied = self.system.border_violation() <= self.settings.residual_tolerance;
                let tolerance = self.settings.residual_tolerance * load.max(driven);
                if is_satisfied && residual <= tolerance.max(rounding).max(RESIDUAL_FLOOR) {
                    if negative_pivots > 0 {
                        return Err(Cause::IndefiniteTangent { negative_pivots });
                    }
                    // Reactions of the final state, not of its linearisation.
                    for ((value, r), held) in
                        multipliers.iter_mut().zip(self.system.totals().residual.as_flattened()).zip(self.system.held())
                    {
                        *value = if *held { -r } else { 0.0 };
                    }
                    self.has_factor = true;
                    return Ok(self.converged(time, (u, border), multipliers, iteration));
                }
            }
        }
        if most > least && last.norm < 1.0 {
            return Err(Cause::ContactChatter { least, most });
        }
        Err(Cause::TooManyIterations {
            iterations: self.settings.max_iterations,
            correction: last.norm,
            residual: last.residual,
            node: self.largest_residual_node(),
        })
    }

    /// Whether a correction is so small that the state after it will do on the way.
    fn is_small(&mut self, displacement: &[[f64; 3]], correction: &Correction) -> bool {
        let straight = correction.displacement.as_flattened();
        straight.iter().all(|x| x.abs() < LOOSE)
            && self.system.extent(displacement, &correction.displacement).stretch < self.loose_stretch
    }

    /// Whether a change of the supports' displacements is more than rounding.
    fn is_felt(&self, change: &[[f64; 3]]) -> bool {
        change.as_flattened().iter().zip(self.system.held()).any(|(x, held)| *held && x.abs() > ROUNDED)
    }

    fn converged(
        &self,
        time: f64,
        (displacement, border): (Vec<[f64; 3]>, Vec<f64>),
        multipliers: Vec<f64>,
        iterations: usize,
    ) -> Converged {
        let contact_points = self.system.contact_points();
        let state = State { time, displacement, border, multipliers, contact_points, is_loose: false };
        Converged { state, iterations }
    }

    fn largest_residual_node(&self) -> usize {
        let held = self.system.held();
        let size =
            |node: usize, r: &[f64; 3]| -> f64 { (0..3).filter(|k| !held[3 * node + k]).map(|k| r[k] * r[k]).sum() };
        let residual = &self.system.totals().residual;
        (0..residual.len()).max_by(|&a, &b| size(a, &residual[a]).total_cmp(&size(b, &residual[b]))).unwrap_or(0)
    }
}
