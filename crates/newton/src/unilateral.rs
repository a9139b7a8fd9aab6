//! What a path asks and tells the contact of its system.

use std::time::Instant;

use pneuflex_assembly::{Tractions, Unilateral};

use crate::linearisation;
use crate::state::State;
use crate::system::{System, unilateral};

impl System {
    /// Largest penetration of a contact point at a state, mm; 0 where nothing touches.
    pub fn deepest_penetration(&mut self, state: &State) -> f64 {
        let start = Instant::now();
        let contacts = self.contributions.iter_mut().filter_map(|contribution| contribution.unilateral_mut());
        let depth = contacts.map(|contact| contact.deepest_penetration(state.position())).fold(0.0, f64::max);
        self.timing.contact_s += start.elapsed().as_secs_f64();
        depth
    }

    /// Name of an obstacle that the body would have passed through between two states, if it would.
    pub fn passed_through(&mut self, before: &State, after: &State) -> Option<String> {
        let start = Instant::now();
        let ends = [before.position(), after.position()];
        let passed = unilateral(&self.contributions).find_map(|contact| contact.passed_through(ends));
        self.timing.contact_s += start.elapsed().as_secs_f64();
        passed
    }

    /// Number of contact points, touching or not.
    pub fn num_contact_points(&self) -> usize {
        unilateral(&self.contributions).map(Unilateral::num_points).sum()
    }

    /// Length of what the contributions keep of a tangent.
    pub fn num_stored(&mut self) -> usize {
        linearisation::num_stored(&mut self.contributions)
    }

    /// Traction that every contact point carries without penetration, MPa; empty for none.
    pub fn contact_multipliers(&self) -> Vec<f64> {
        unilateral(&self.contributions).flat_map(|contact| contact.multipliers().to_vec()).collect()
    }

    /// Sets them. There must be none or as many as contact points.
    pub fn set_contact_multipliers(&mut self, multipliers: &[f64]) {
        let mut left = multipliers;
        for contact in self.contributions.iter_mut().filter_map(|contribution| contribution.unilateral_mut()) {
            let (own, rest) = left.split_at(contact.num_points().min(left.len()));
            contact.set_multipliers(own.to_vec());
            left = rest;
        }
    }

    /// Tractions of all contact points at a displacement, and how far those are from their partners that carry one.
    pub fn contact_tractions(&mut self, displacement: &[[f64; 3]]) -> Tractions {
        let start = Instant::now();
        let mut found = Tractions::default();
        for contact in unilateral(&self.contributions) {
            let own = contact.tractions(displacement);
            found.values.extend(own.values);
            found.distance = found.distance.max(own.distance);
            found.excess = found.excess.max(own.excess);
            found.stuck = found.stuck.or(own.stuck);
        }
        self.timing.contact_s += start.elapsed().as_secs_f64();
        found
    }

    /// Whether any contact point has a tolerance for its depth, which multipliers are to meet.
    pub fn is_augmented(&self) -> bool {
        unilateral(&self.contributions).any(Unilateral::is_augmented)
    }
}
