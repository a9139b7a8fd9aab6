//! Contact without penetration: the augmented Lagrangian at a requested load.
//!
//! A penalty k leaves the depth p/k under the pressure p. With multipliers λ of the contact points the energy of a point is
//! ½ k ⟨λ/k − d⟩² and its traction ⟨λ − k d⟩; λ ← ⟨λ − k d⟩ at an equilibrium makes the traction there the next one's without any
//! depth (Uzawa's iteration; Wriggers 2006, *Computational Contact Mechanics*, §10.2; Simo & Laursen 1992, *Comput. Struct.* 42). The
//! multipliers stay with their points on the way to the next load.

use pneuflex_assembly::Tractions;

use crate::event::Observer;
use crate::failure::Cause;
use crate::history::Augmentation;
use crate::path::Path;

/// Multipliers are brought up to date at most so often at one load.
pub const MOST_AUGMENTATIONS: usize = 30;

impl Path {
    /// Brings the multipliers up to date and solves again until no contact point that carries traction is further than its
    /// tolerance from its partner. Where that fails, the last equilibrium stays with the reason.
    ///
    /// # Errors
    /// [`Cause::Interrupted`]; the state before the last update stays.
    pub(crate) fn augment(&mut self, observer: Observer<'_>) -> Result<(), Cause> {
        let mut failure = None;
        let mut is_stale = false;
        for count in 0..=MOST_AUGMENTATIONS {
            let u = self.equilibrium().state.displacement.clone();
            let Tractions { values, distance, excess, stuck } = self.system().contact_tractions(&u);
            if excess > 1.0 && count == MOST_AUGMENTATIONS {
                let times = format!("{excess:.2} times what is allowed");
                failure = Some(format!("still {distance:.2e} mm, {times}, after {count} updates of the multipliers"));
            }
            if excess <= 1.0 || failure.is_some() {
                let stuck = stuck.map(|(depth, name)| {
                    format!("{name} is {depth:.2e} mm deep where supports hold the body, and no force frees it there")
                });
                let failure = failure.or(stuck);
                self.set_augmentation(Augmentation { count, distance, failure });
                if is_stale {
                    // A resumed path could not make it again: it has the present multipliers alone.
                    self.forget_predictor();
                }
                return Ok(());
            }
            let before = self.system().contact_multipliers();
            // Multipliers take over tractions, which hardly change: the tangent is near the one of before.
            let at_hand = self.take_tangent();
            self.system().predict(&u, None);
            self.system().set_contact_multipliers(&values);
            match self.solve_near(at_hand, observer) {
                Ok(converged) => {
                    is_stale = converged.iterations == 0;
                    self.adopt(converged);
                }
                Err(cause) => {
                    self.system().set_contact_multipliers(&before);
                    if cause == Cause::Interrupted {
                        return Err(cause);
                    }
                    let failure = Some(format!("the equilibrium after update {} was not found: {cause}", count + 1));
                    self.set_augmentation(Augmentation { count, distance, failure });
                    return Ok(());
                }
            }
        }
        Ok(())
    }
}
