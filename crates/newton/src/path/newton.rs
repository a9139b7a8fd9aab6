//! Newton's method at one load (theory §13).

use super::{Converged, Path, Target};
use crate::arc::ArcEquation;
use crate::convergence::{Criteria, Scales};
use crate::event::{Event, Observer};
use crate::failure::Cause;
use crate::globalisation::{Choice, Globalisation, Measures, Verdict};
use crate::history::IterationRecord;
use crate::prescribed_motion::{PrescribedMotion, is_felt};
use crate::state::{Correction, Equilibrium, State, difference};
use crate::tangent_solver::{Assembled, Tangent};
use crate::unstable_motion::UnstableMotions;

/// Largest step to the first state with unstable motions of the mesh, relative to the load parameter there.
const FIRST_UNSTABLE_STEP: f64 = 0.05;

/// What drives the body in an attempt.
pub(crate) enum Driven<'a> {
    /// The loads of a position on the load path, and displacements wanted at held degrees of freedom (mm, one entry per node), if they are to
    /// move.
    ByLoad(Option<&'a [[f64; 3]]>),
    /// An equation for the load parameter, which supports follow.
    ByArc(&'a ArcEquation<'a>),
}

impl Driven<'_> {
    fn held(&self, motion: &PrescribedMotion, state: &State) -> Option<Vec<[f64; 3]>> {
        match self {
            Self::ByLoad(held) => held.map(<[_]>::to_vec),
            Self::ByArc(_) => motion.target(state.parameter),
        }
    }

    /// Whether the load parameter falls along the path at a state that was found.
    fn is_falling(&self, state: &State, rate: Option<&Correction>) -> bool {
        match (self, rate) {
            (Self::ByArc(arc), Some(rate)) => arc.is_falling(state, rate),
            _ => false,
        }
    }
}

impl Path {
    /// Newton's method from a guess; the first correction comes from a tangent that is `at_hand`, if there is one. With an equation for it, the
    /// load parameter is an unknown.
    pub(crate) fn newton(
        &mut self,
        mut state: State,
        driven: Driven<'_>,
        mut at_hand: Option<Tangent>,
        target: Target,
        observer: Observer<'_>,
    ) -> Result<Converged, Cause> {
        let held = driven.held(&self.motion, &state);
        let is_driven = held.is_some() || self.motion.moves_obstacles;
        // Beyond a limit point loads may be small beside the stresses that they balance.
        let scales = match driven {
            Driven::ByLoad(_) => self.scales,
            Driven::ByArc(_) => self.scales.stretched(&self.mesh, &state.displacement),
        };
        let criteria = Criteria::new(&mut self.system, &self.settings, &scales, &state, is_driven)?;
        let (tuning, settings) = (self.tuning.clone(), self.settings.clone());
        let mut policy = Globalisation::new(&tuning, &settings, &self.scales, at_hand.is_some());
        let mut multipliers = self.equilibrium.multipliers.clone();
        let mut left: Vec<[f64; 3]> = Vec::new();
        let mut rate = None;
        while let Some(choice) = policy.next_tangent() {
            self.check_stop()?;
            let (assembled, tangent) = self.linearise(&state, choice, at_hand.take())?;
            let change = driven.held(&self.motion, &state).map(|held| difference(&held, &state.displacement));
            let prescribed = change.filter(|change| is_felt(change, self.system.held(), self.scales.size));
            let mut correction = self.system.solve(&tangent, &assembled, prescribed.as_deref())?;
            let mut change_of_parameter = 0.0;
            if let Driven::ByArc(arc) = &driven {
                let of_tangent = match rate.take().filter(|_| choice == Choice::AtHand) {
                    Some(rate) => rate,
                    None => self.rate_by(&tangent, &state)?,
                };
                change_of_parameter = arc.change_of_parameter(&state, &correction, &of_tangent);
                correction = correction.plus(change_of_parameter, &of_tangent);
                rate = Some(of_tangent);
            }
            let updated = self.system.multipliers(&tangent, &assembled, &correction)?;
            let is_unstable = tangent.negative_pivots() > 0;
            let measures = Measures { is_unstable, ..self.measure(&assembled, &correction, [&updated, &multipliers]) };
            multipliers = updated;
            let scale = criteria.scale(self.system.held_norm(&assembled.residual));
            observer(Event::Iteration(&self.record(&policy, &state, &tangent, &measures, scale)));
            let extent = || self.system.extent(&state.displacement, &correction.displacement);
            match policy.judge(measures, prescribed.is_some(), extent) {
                Verdict::Reject(cause) => {
                    self.system.recycle(Some(tangent));
                    return Err(cause);
                }
                Verdict::Refactor => {
                    (at_hand, left) = (Some(tangent), assembled.residual);
                    continue;
                }
                Verdict::Shorten(share) => {
                    (correction, change_of_parameter) = (correction.scaled(share), share * change_of_parameter);
                }
                Verdict::Accept => {}
            }
            self.system.apply(&mut state, &correction)?;
            state.parameter = state.parameter + change_of_parameter;
            // Small corrections of an unstable tangent lead away from the path.
            if target == Target::OnTheWay && !is_unstable && self.is_small(&state, &correction) {
                self.system.check_equilibrium(&state.displacement)?;
                // The next guess comes from a tangent near the state, or from a new one.
                let predictor = if choice == Choice::AtHand {
                    self.system.recycle(Some(tangent));
                    None
                } else {
                    Some(tangent)
                };
                let equilibrium = Equilibrium {
                    state,
                    multipliers,
                    contact_points: assembled.contact_points,
                    is_inexact: true,
                    mesh_motions: None,
                    negative_pivots: 0,
                };
                return Ok(Converged {
                    equilibrium,
                    predictor,
                    rate: None,
                    iterations: policy.iteration(),
                    has_jumped: false,
                });
            }
            if !policy.was_cautious() && criteria.may_be_met(&measures) {
                let assembled = self.system.residual(&state)?;
                if criteria.are_met(&mut self.system, &state, &assembled)? {
                    self.system.check_equilibrium(&state.displacement)?;
                    let is_taken = driven.is_falling(&state, rate.as_ref()) || self.takes_unstable();
                    let tangent = if !is_unstable || is_taken { tangent } else { self.judged_at(&state, tangent)? };
                    let mesh_motions = if is_taken || tangent.negative_pivots() == 0 {
                        None
                    } else {
                        Some(self.judge_instability(&tangent, &assembled, &state, &criteria)?)
                    };
                    // Reactions of the final state, not of its linearisation.
                    let equilibrium = Equilibrium {
                        state,
                        multipliers: self.held_forces(&assembled),
                        contact_points: assembled.contact_points,
                        is_inexact: false,
                        mesh_motions,
                        negative_pivots: tangent.negative_pivots(),
                    };
                    let predictor = Some(tangent);
                    return Ok(Converged {
                        equilibrium,
                        predictor,
                        rate,
                        iterations: policy.iteration(),
                        has_jumped: false,
                    });
                }
            }
            if policy.is_stalled() {
                self.system.recycle(Some(tangent));
                return Err(Cause::Rounding { residual: measures.residual, relative: measures.residual / scale });
            }
            (at_hand, left) = (Some(tangent), assembled.residual);
        }
        self.system.recycle(at_hand);
        Err(policy.exhausted(self.node_with_largest(&left)))
    }

    /// The tangent from which the stability of a state that solves the equations is judged: the one at hand, or its own where motions are held
    /// by weak springs alone. What was left of the residual where the one at hand comes from is more than the springs.
    fn judged_at(&mut self, state: &State, at_hand: Tangent) -> Result<Tangent, Cause> {
        if self.system.vanishing_force(&state.displacement).is_none() {
            return Ok(at_hand);
        }
        self.system.recycle(Some(at_hand));
        self.iterations += 1;
        self.system.predict(&state.displacement, None);
        Ok(self.system.tangent(state)?.1)
    }

    /// Motions of the mesh that release energy at a state which solves the equations. The path goes on through them where supports alone
    /// drive the body: its shape is then given, and not the force by which something would snap.
    ///
    /// # Errors
    /// [`Cause::IndefiniteTangent`] for an instability of the body.
    fn judge_instability(
        &mut self,
        tangent: &Tangent,
        assembled: &Assembled,
        state: &State,
        criteria: &Criteria,
    ) -> Result<UnstableMotions, Cause> {
        let Self { system, mesh, .. } = self;
        let found = UnstableMotions::find(system, mesh, tangent, assembled, &state.displacement)?;
        let motions = found.as_ref().map(|(motions, _)| *motions);
        self.unstable = found;
        let before = &self.equilibrium;
        let step = state.parameter - before.state.parameter;
        // The first of these states is to be the next one on the path, and not one of another branch.
        let is_next = before.mesh_motions.is_some() || step <= FIRST_UNSTABLE_STEP * state.parameter.0;
        let goes_on = motions.filter(|motions| is_next && !criteria.has_load() && motions.are_of_the_mesh());
        let motions = motions.map(Box::new);
        goes_on.ok_or(Cause::IndefiniteTangent { negative_pivots: tangent.negative_pivots(), motions })
    }

    /// Assembles at a state, and gives the tangent that the next correction comes from.
    fn linearise(
        &mut self,
        state: &State,
        choice: Choice,
        at_hand: Option<Tangent>,
    ) -> Result<(Assembled, Tangent), Cause> {
        match (choice, at_hand) {
            (Choice::AtHand, Some(tangent)) => Ok((self.system.residual_on_the_way(state)?, tangent)),
            (choice, old) => {
                self.iterations += 1;
                self.system.recycle(old);
                if choice == Choice::Cautious {
                    self.system.predict(&self.equilibrium.state.displacement, None);
                }
                Ok(self.system.tangent(state)?)
            }
        }
    }

    fn measure(&self, assembled: &Assembled, correction: &Correction, [updated, multipliers]: [&[f64]; 2]) -> Measures {
        let Scales { length, force, .. } = self.scales;
        let displacement = correction.displacement.as_flattened().iter().map(|x| x * x).sum::<f64>();
        // An unknown beside the displacements counts by the force that it acts with.
        let bordered = correction.bordered.iter().zip(&assembled.equations).map(|(change, equation)| {
            change * change * equation.column.as_flattened().iter().map(|x| x * x).sum::<f64>()
        });
        let forces =
            updated.iter().zip(multipliers).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() + bordered.sum::<f64>();
        Measures {
            norm: (displacement.sqrt() / length).hypot(forces.sqrt() / force),
            largest: correction.largest() / length,
            residual: self.system.free_norm(&assembled.residual),
            contact_points: assembled.contact_points,
            is_unstable: false,
        }
    }

    fn record(
        &self,
        policy: &Globalisation<'_>,
        state: &State,
        tangent: &Tangent,
        measures: &Measures,
        scale: f64,
    ) -> IterationRecord {
        IterationRecord {
            step: self.step,
            iteration: policy.iteration(),
            new_tangent: policy.choice() != Choice::AtHand,
            parameter: state.parameter,
            correction: measures.norm,
            residual: measures.residual,
            relative_residual: measures.residual / scale,
            contact_points: measures.contact_points,
            negative_pivots: tangent.negative_pivots(),
            elapsed_s: self.spent.total_s + self.begin.elapsed().as_secs_f64(),
        }
    }

    /// Whether a correction is so small that the state after it will do on the way (inexact Newton).
    fn is_small(&mut self, state: &State, correction: &Correction) -> bool {
        correction.largest() < self.tuning.inexact_displacement * self.scales.length
            && self.system.extent(&state.displacement, &correction.displacement).stretch < self.scales.inexact_stretch
    }

    /// −r at held degrees of freedom, zero at free ones.
    fn held_forces(&self, assembled: &Assembled) -> Vec<f64> {
        let residual = assembled.residual.as_flattened().iter().zip(self.system.held());
        residual.map(|(r, held)| if *held { -r } else { 0.0 }).collect()
    }

    /// Node with the largest residual over the free degrees of freedom.
    fn node_with_largest(&self, residual: &[[f64; 3]]) -> usize {
        let held = self.system.held();
        let size =
            |node: usize, r: &[f64; 3]| -> f64 { (0..3).filter(|k| !held[3 * node + k]).map(|k| r[k] * r[k]).sum() };
        (0..residual.len()).max_by(|&a, &b| size(a, &residual[a]).total_cmp(&size(b, &residual[b]))).unwrap_or(0)
    }
}
