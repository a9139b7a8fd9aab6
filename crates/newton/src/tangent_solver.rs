//! A factorised tangent and the solutions that it gives: the factor of the symmetric part, the border of the other unknowns, GMRES for
//! the unsymmetric part.

use std::sync::Arc;

use pneuflex_assembly::{BorderedEquation, Couplings, Elimination, RigidMotion};
use pneuflex_factor::{BlockPattern, Factor, FactorError, Parallelism, Symbolic, gmres, multiply};

use crate::bordered;
use crate::error::AssembleError;
use crate::linearisation::Linearisation;
use crate::state::Correction;

/// What is assembled at a state.
#[derive(Clone, Debug, Default)]
pub struct Assembled {
    /// Energy, mJ.
    pub energy: f64,
    /// Residual r, N, one entry per node.
    pub residual: Vec<[f64; 3]>,
    /// Equations of the unknowns beside the displacements.
    pub equations: Vec<BorderedEquation>,
    /// Contact points that carry traction.
    pub contact_points: usize,
}

/// A tangent K, factorised, with what it was made from.
pub struct Tangent {
    pattern: Arc<BlockPattern>,
    buffers: Buffers,
    /// Unsymmetric part.
    couplings: Couplings,
    /// For every degree of freedom whether there is no equation for it: it is held, or follows others.
    held: Arc<[bool]>,
    elimination: Arc<Elimination>,
    negative_pivots: usize,
    linearisation: Linearisation,
    /// What moving obstacles do to the body.
    motions: Vec<RigidMotion>,
}

/// Memory of a tangent that is not needed any more.
pub(crate) struct Buffers {
    pub(crate) values: Vec<f64>,
    pub(crate) symbolic: Arc<Symbolic<3>>,
    factor: Factor<3>,
}

impl Buffers {
    /// None yet.
    pub(crate) fn new(symbolic: &Arc<Symbolic<3>>) -> Self {
        Self { values: Vec::new(), symbolic: Arc::clone(symbolic), factor: Factor::new(Arc::clone(symbolic)) }
    }

    /// Goes over to a pattern that has changed.
    pub(crate) fn set_symbolic(&mut self, symbolic: &Arc<Symbolic<3>>) {
        self.symbolic = Arc::clone(symbolic);
        self.factor.set_symbolic(Arc::clone(symbolic));
    }
}

impl Tangent {
    /// Factorises an assembled tangent, its values in the buffers.
    ///
    /// # Errors
    /// If the tangent is singular or not finite; the memory comes back.
    pub(crate) fn new(
        pattern: Arc<BlockPattern>,
        mut buffers: Buffers,
        (couplings, (held, elimination)): (Couplings, (Arc<[bool]>, Arc<Elimination>)),
        (linearisation, motions): (Linearisation, Vec<RigidMotion>),
        parallelism: Parallelism,
    ) -> Result<Self, Box<(FactorError, Buffers)>> {
        match buffers.factor.factorize(&buffers.values, &held, parallelism) {
            Ok(inertia) => {
                let negative_pivots = inertia.negative;
                Ok(Self { pattern, buffers, couplings, held, elimination, negative_pivots, linearisation, motions })
            }
            Err(error) => Err(Box::new((error, buffers))),
        }
    }

    /// Negative eigenvalues: the number of motions that release energy; 0 if the state is stable.
    pub fn negative_pivots(&self) -> usize {
        self.negative_pivots
    }

    /// Turns the inertia into that of motions which the equations of the other unknowns allow; `responses` are the columns −K⁻¹B. Under
    /// pressure on an open surface forces have no potential, and the inertia of the symmetric part says nothing: none is negative then.
    pub(crate) fn judge_inertia(&mut self, equations: &[BorderedEquation], responses: Option<&[Vec<f64>]>) {
        if let Some(responses) = responses {
            let negative = self.negative_pivots + bordered::negative_eigenvalues(equations, responses);
            // Fewer than there are unknowns cannot be but for rounding.
            self.negative_pivots = negative.saturating_sub(equations.len());
        }
        if self.is_unsymmetric() {
            self.negative_pivots = 0;
        }
    }

    /// Whether forces have no potential, so that the inertia says nothing.
    pub fn is_unsymmetric(&self) -> bool {
        !self.couplings.is_empty()
    }

    /// The symmetric part of K, N/mm, 9 numbers per block of the pattern.
    pub fn values(&self) -> &[f64] {
        &self.buffers.values
    }

    /// What it was made from.
    pub fn linearisation(&self) -> &Linearisation {
        &self.linearisation
    }

    /// Obstacles that move, and what that does to the body where the tangent was assembled.
    pub fn motions(&self) -> &[RigidMotion] {
        &self.motions
    }

    pub(crate) fn into_buffers(self) -> Buffers {
        self.buffers
    }

    /// Columns Y = −K⁻¹B of the equations' columns B.
    pub(crate) fn responses(&self, equations: &[BorderedEquation]) -> Result<Vec<Vec<f64>>, AssembleError> {
        let mut all: Vec<f64> = Vec::with_capacity(equations.len() * self.held.len());
        for equation in equations {
            let column = equation.column.as_flattened().iter().zip(self.held.iter());
            all.extend(column.map(|(b, held)| if *held { 0.0 } else { -b }));
        }
        self.solve_in_place(&mut all, equations.len())?;
        Ok(all.chunks_exact(self.held.len().max(1)).map(<[f64]>::to_vec).collect())
    }

    /// Solves K x = b for some columns b, the values of held degrees of freedom among them.
    fn solve_in_place(&self, columns: &mut [f64], count: usize) -> Result<(), AssembleError> {
        self.buffers.factor.solve_in_place(columns, count)?;
        if self.couplings.is_empty() {
            return Ok(());
        }
        for column in columns.chunks_exact_mut(self.held.len().max(1)) {
            let apply = |vector: &[f64]| {
                let free = |(x, held): (&f64, &bool)| if *held { 0.0 } else { *x };
                let moved: Vec<f64> = vector.iter().zip(self.held.iter()).map(free).collect();
                let mut forces = self.unsymmetric_product(&moved);
                forces = forces.iter().zip(self.held.iter()).map(free).collect();
                self.buffers.factor.solve_in_place(&mut forces, 1)?;
                Ok::<_, FactorError>(vector.iter().zip(forces).map(|(x, y)| x + y).collect())
            };
            let solution = gmres::solve(column, apply)?.or_not_converged()?;
            column.copy_from_slice(&solution);
        }
        Ok(())
    }

    /// K times a vector.
    fn product(&self, vector: &[f64]) -> Result<Vec<f64>, FactorError> {
        let mut product = self.symmetric_product(vector)?;
        if !self.couplings.is_empty() {
            product.iter_mut().zip(self.unsymmetric_product(vector)).for_each(|(force, more)| *force += more);
        }
        Ok(product)
    }

    /// Solutions are those with the transposed matrix from now on. The symmetric part and its factor are what they were.
    pub(crate) fn transpose(&mut self) {
        self.couplings = std::mem::take(&mut self.couplings).transposed();
    }

    /// The symmetric part of K times a vector, held degrees of freedom and all.
    pub(crate) fn symmetric_product(&self, vector: &[f64]) -> Result<Vec<f64>, FactorError> {
        let mut product = vec![0.0; vector.len()];
        multiply::<3>(&self.pattern, &self.buffers.values, vector, &mut product)?;
        Ok(product)
    }

    /// The unsymmetric part of K times a vector.
    fn unsymmetric_product(&self, vector: &[f64]) -> Vec<f64> {
        let mut displacement = vector.as_chunks().0.to_vec();
        self.elimination.expand(&mut displacement);
        let mut forces = vec![0.0; vector.len()];
        self.couplings.add_product(displacement.as_flattened(), &mut forces);
        self.elimination.condense(&mut forces);
        forces
    }

    /// Correction from K δu + B δy = −r and the equations of the unknowns δy beside the displacements.
    /// `prescribed` are the changes wanted at held degrees of freedom, mm, one entry per node; `responses` the columns −K⁻¹B if they are
    /// known.
    ///
    /// # Errors
    /// If the unsymmetric part is too much, or the equations contradict each other.
    pub(crate) fn solve(
        &self,
        assembled: &Assembled,
        prescribed: Option<&[[f64; 3]]>,
        responses: Option<&[Vec<f64>]>,
    ) -> Result<Correction, AssembleError> {
        let mut rhs = self.right_hand_side(assembled.residual.as_flattened(), prescribed)?;
        self.solve_in_place(&mut rhs, 1)?;
        let mut border = Vec::new();
        if !assembled.equations.is_empty() {
            let computed;
            let responses = match responses {
                Some(responses) => responses,
                None => {
                    computed = self.responses(&assembled.equations)?;
                    &computed
                }
            };
            border = bordered::eliminate(&assembled.equations, responses, &rhs).ok_or(AssembleError::Contradiction)?;
            for (change, response) in border.iter().zip(responses) {
                for (value, y) in rhs.iter_mut().zip(response) {
                    *value += change * y;
                }
            }
        }
        Ok(Correction { displacement: rhs.as_chunks().0.to_vec(), bordered: border })
    }

    /// −r less what the prescribed changes add to it; the changes themselves at held degrees of freedom.
    fn right_hand_side(&self, residual: &[f64], prescribed: Option<&[[f64; 3]]>) -> Result<Vec<f64>, FactorError> {
        let free = |(r, held): (&f64, &bool)| if *held { 0.0 } else { -r };
        let mut rhs: Vec<f64> = residual.iter().zip(self.held.iter()).map(free).collect();
        if let Some(prescribed) = prescribed {
            let imposed = prescribed.as_flattened().iter().zip(self.held.iter());
            let mut imposed: Vec<f64> = imposed.map(|(x, held)| if *held { *x } else { 0.0 }).collect();
            self.elimination.slaves().for_each(|slave| imposed[slave] = 0.0);
            let product = self.product(&imposed)?;
            for i in 0..rhs.len() {
                rhs[i] = if self.held[i] { imposed[i] } else { rhs[i] - product[i] };
            }
        }
        Ok(rhs)
    }

    /// K δu over the free degrees of freedom of a correction, without what supports that move add to it, N, one entry per node.
    ///
    /// # Errors
    /// If the correction is that of another problem.
    pub(crate) fn forces_of_free(&self, correction: &Correction) -> Result<Vec<[f64; 3]>, FactorError> {
        let free = correction.displacement.as_flattened().iter().zip(self.held.iter());
        let free: Vec<f64> = free.map(|(x, held)| if *held { 0.0 } else { *x }).collect();
        Ok(self.product(&free)?.as_chunks().0.to_vec())
    }

    /// Multipliers λ = −(r + K δu + B δy) of the held degrees of freedom after a correction; zero at free ones.
    ///
    /// # Errors
    /// If the correction is that of another problem.
    pub(crate) fn multipliers(&self, assembled: &Assembled, correction: &Correction) -> Result<Vec<f64>, FactorError> {
        let mut product = self.product(correction.displacement.as_flattened())?;
        for (equation, change) in assembled.equations.iter().zip(&correction.bordered) {
            for (value, b) in product.iter_mut().zip(equation.column.as_flattened()) {
                *value += change * b;
            }
        }
        for ((value, r), held) in product.iter_mut().zip(assembled.residual.as_flattened()).zip(self.held.iter()) {
            *value = if *held { -(*value + r) } else { 0.0 };
        }
        Ok(product)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::State;
    use crate::testing::{Springs, cube};

    /// Springs of 4 N/mm under 2 N at every node but the held one: half a millimetre, and the support carries the last 2 N.
    #[test]
    fn a_linear_system_is_solved_by_one_correction() {
        let mesh = cube();
        let mut system = Springs::new(&mesh, 4.0).system(&mesh);
        let state = State::at_rest(8, 0).moved_to(2.0.into());
        let (assembled, tangent) = system.tangent(&state).unwrap();
        assert_eq!((tangent.negative_pivots(), tangent.is_unsymmetric()), (0, false));
        let correction = system.solve(&tangent, &assembled, None).unwrap();
        for (node, u) in correction.displacement.iter().enumerate() {
            assert_eq!(*u, if node == 0 { [0.0; 3] } else { [0.5, 0.0, 0.0] });
        }
        let multipliers = system.multipliers(&tangent, &assembled, &correction).unwrap();
        assert_eq!((multipliers[0], &multipliers[1..]), (2.0, &[0.0; 23][..]));
        // The same when the held node is moved.
        let moved: Vec<[f64; 3]> = (0..8).map(|node| if node == 0 { [0.0, 1.5, 0.0] } else { [9.0; 3] }).collect();
        let correction = system.solve(&tangent, &assembled, Some(&moved)).unwrap();
        assert_eq!(correction.displacement[..2], [[0.0, 1.5, 0.0], [0.5, 0.0, 0.0]]);
        assert_eq!(system.multipliers(&tangent, &assembled, &correction).unwrap()[1], -6.0);
    }

    #[test]
    fn negative_springs_are_counted_unless_a_constraint_or_missing_potential_forbids() {
        let mesh = cube();
        let mut system = Springs::new(&mesh, -1.0).system(&mesh);
        assert_eq!(system.tangent(&State::at_rest(8, 0)).unwrap().1.negative_pivots(), 21);
        let mut system = Springs::new(&mesh, -1.0).constrained().system(&mesh);
        assert_eq!(system.tangent(&State::at_rest(8, 1)).unwrap().1.negative_pivots(), 20);
        let mut system = Springs::new(&mesh, -1.0).with_follower(&mesh).system(&mesh);
        let (_, tangent) = system.tangent(&State::at_rest(8, 0)).unwrap();
        assert_eq!((tangent.is_unsymmetric(), tangent.negative_pivots()), (true, 0));
    }

    #[test]
    fn a_singular_tangent_is_an_error_and_the_next_one_is_not() {
        let mesh = cube();
        let mut system = Springs::new(&mesh, 0.0).system(&mesh);
        let error = system.tangent(&State::at_rest(8, 0)).err().unwrap();
        assert!(matches!(error, AssembleError::Factor(FactorError::Pivot { .. })), "{error}");
    }

    /// The unsymmetric part is felt: K δu = −r with it, and not without it.
    #[test]
    fn the_unsymmetric_part_is_solved_with() {
        let mesh = cube();
        let mut system = Springs::new(&mesh, 4.0).with_follower(&mesh).system(&mesh);
        let (assembled, tangent) = system.tangent(&State::at_rest(8, 0).moved_to(2.0.into())).unwrap();
        let correction = system.solve(&tangent, &assembled, None).unwrap();
        let product = tangent.product(correction.displacement.as_flattened()).unwrap();
        let mut differs: f64 = 0.0;
        for dof in 3..24 {
            let residual = assembled.residual.as_flattened()[dof];
            assert!((product[dof] + residual).abs() < 1e-9, "{dof}: {} {residual}", product[dof]);
            differs = differs.max((4.0 * correction.displacement.as_flattened()[dof] + residual).abs());
        }
        assert!(differs > 1e-2, "the check would be empty: {differs}");
    }

    #[test]
    fn a_constraint_is_met_by_its_multiplier() {
        let mesh = cube();
        let mut system = Springs::new(&mesh, 4.0).constrained().system(&mesh);
        let state = State::at_rest(8, 1).moved_to(1.4.into());
        let (assembled, tangent) = system.tangent(&state).unwrap();
        let correction = system.solve(&tangent, &assembled, None).unwrap();
        let sum: f64 = correction.displacement.iter().map(|u| u[0]).sum();
        assert!((sum - 1.4).abs() < 1e-13, "{sum}");
        // Seven free nodes, 0.2 mm each, 0.8 N each.
        assert!((correction.bordered[0] + 0.8).abs() < 1e-13, "{:?}", correction.bordered);
    }
}
