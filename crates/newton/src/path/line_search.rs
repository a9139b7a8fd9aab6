//! How much of a correction is applied where corrections run in circles (theory §13): contact points that open and close in turn lead Newton's
//! method from one side of the equilibrium to the other.

use super::Path;
use crate::error::AssembleError;
use crate::state::{Correction, State, dot};

/// States at which the work is looked at, at the most.
const MOST: usize = 5;

/// The energy is nearly least where the work has fallen to this share.
const FALLEN: f64 = 0.2;

/// What is taken if the correction raises the energy from the beginning.
const HALF: f64 = 0.5;

impl Path {
    /// Share of a correction, found at a state with a residual, up to which it releases energy: the residual's work along it is negative at first,
    /// and zero where the energy is least. `change_of_parameter` goes with it.
    ///
    /// # Errors
    /// [`AssembleError`] of the state itself; states along the correction that cannot be evaluated are too far.
    pub(super) fn releasing_share(
        &mut self,
        state: &State,
        (correction, change_of_parameter): (&Correction, f64),
        residual: &[[f64; 3]],
    ) -> Result<f64, AssembleError> {
        let direction = self.system.free_part(&correction.displacement);
        let begin = dot(residual, &direction);
        if begin >= 0.0 {
            return Ok(HALF);
        }
        let mut work_at = |share: f64| -> Result<f64, AssembleError> {
            let mut trial = state.moved_to(state.parameter + share * change_of_parameter);
            self.system.move_by(&mut trial, &correction.scaled(share))?;
            Ok(dot(&self.system.residual_on_the_way(&trial)?.residual, &direction))
        };
        // Shares between which the energy is least, with the work at each (Illinois' rule of false position).
        let (mut low, mut high) = ((0.0, begin), (1.0, -begin));
        let (mut share, mut was_low) = (1.0, None);
        for _ in 0..MOST {
            let work = match work_at(share) {
                Err(AssembleError::Local(_)) => -begin,
                work => work?,
            };
            if work.abs() <= -FALLEN * begin || (share == 1.0 && work < 0.0) {
                break;
            }
            let is_low = work < 0.0;
            let (moved, kept) = if is_low { (&mut low, &mut high) } else { (&mut high, &mut low) };
            *moved = (share, work);
            if was_low == Some(is_low) {
                kept.1 *= 0.5;
            }
            was_low = Some(is_low);
            share = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        }
        // The contact of the state itself predicts what follows.
        self.system.residual_on_the_way(state)?;
        Ok(share)
    }
}

#[cfg(test)]
mod tests {
    use pneuflex_mesh::lattice::Lattice;
    use pneuflex_model::load::Load;
    use pneuflex_model::{Curve, Formulation, Law, LoadParameter, Problem, Solver, Support};

    use super::*;

    /// Under a small force the energy is a parabola along the correction, least at the correction of Newton's method.
    #[test]
    fn a_correction_is_taken_as_far_as_it_releases_energy() {
        let mesh = Lattice::uniform([0.0; 3], [1.0; 3], [2, 2, 2]).mesh_all(Formulation::Hex8Q1p0.element_kind());
        let held = mesh.select_nodes(|x| x[0] < 1e-9);
        let pulled = mesh.select_nodes(|x| x[0] > 1.0 - 1e-9);
        let mut problem = Problem::body(mesh, Formulation::Hex8Q1p0, Law::NeoHooke { c10: 0.5 }.into());
        problem.supports = vec![Support { name: "wall".into(), nodes: held, axes: [true; 3], motion: None }];
        let nodes = pulled.into_iter().map(|node| (node, 1.0)).collect();
        problem.loads = vec![Load::Force { nodes, force: [1e-7, 0.0, 0.0], curve: Curve::Proportional(1.0) }];
        let mut path = Path::new(&problem, &Solver::default()).unwrap();
        let loaded = path.equilibrium.state.moved_to(LoadParameter(1.0));
        let (assembled, tangent) = path.system.tangent(&loaded).unwrap();
        let correction = path.system.solve(&tangent, &assembled, None).unwrap();
        let mut share = |factor: f64| {
            path.releasing_share(&loaded, (&correction.scaled(factor), 0.0), &assembled.residual).unwrap()
        };
        assert_eq!([share(0.5), share(1.0)], [1.0, 1.0]);
        assert!((share(4.0) - 0.25).abs() < 1e-3, "{}", share(4.0));
        assert_eq!(share(-1.0), HALF);
    }
}
