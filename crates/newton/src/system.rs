//! The equations of one problem: residual, tangent, factor, reactions at a given state.

use std::sync::Arc;
use std::time::Instant;

use pneuflex_assembly::solid::DegenerateElement;
use pneuflex_assembly::{Assembler, Contact, LocalContribution, LocalError, Pressure, Request, Solid, Totals};
use pneuflex_contact::{ContactBlock, ContactModel, predicted_tractions};
use pneuflex_factor::{Factor, FactorError, Inertia, Ordering, Parallelism, Symbolic, multiply};
use pneuflex_mesh::Mesh;
use pneuflex_model::Problem;

use crate::checkpoint::{Carried, Linearisation};
use crate::history::Timing;
use crate::warp::{Extent, Warp};

/// Room is made in the tangent for faces that are nearer than this share of their distance at rest.
const NEAR_SHARE: f64 = 0.15;

/// Corrections that move no node further than this are not bent: the next one makes up for their second-order part, mm.
const STRAIGHT_BELOW: f64 = 1e-3;

/// Index of the solid and of the pressure in the assembler's list.
const SOLID: usize = 0;
const PRESSURE: usize = 1;

/// A problem that cannot be set up.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SetupError {
    /// An element of the mesh has no volume.
    #[error(transparent)]
    Degenerate(#[from] DegenerateElement),
    /// The structure of the equations cannot be analysed, or part of the body is not held.
    #[error("the equations cannot be set up: {0}")]
    Factor(#[from] FactorError),
}

/// The discretised equations of a [`Problem`] with everything that is reused from iteration to iteration.
pub struct System {
    mesh: Arc<Mesh>,
    solid: Solid,
    pressure: Pressure,
    contact: ContactModel,
    near_margin: f64,
    /// Touching blocks of the last assembly, and the node positions it was made at.
    touching: Vec<ContactBlock>,
    positions: Vec<[f64; 3]>,
    /// What the next tangent's carried pressures follow from, if they are not those of the tangent before.
    pending: Option<Carried>,
    /// Where the last tangent was assembled.
    linearisation: Option<Linearisation>,
    /// Traction of every contact point that the linearisation carries, MPa.
    carried_tractions: Vec<f64>,
    assembler: Assembler,
    factor: Factor<3>,
    warp: Warp,
    totals: Totals,
    held: Vec<bool>,
    parallelism: Parallelism,
    contact_points: usize,
    /// Seconds spent so far.
    pub timing: Timing,
}

impl System {
    /// Sets up the equations of a problem.
    ///
    /// # Errors
    /// [`SetupError`] if an element is degenerate or the body is not held.
    pub fn new(problem: &Problem, parallelism: Parallelism) -> Result<Self, SetupError> {
        let start = Instant::now();
        let mesh = Arc::new(problem.mesh.clone());
        let solid = Solid::new(&mesh, problem.formulation, &problem.material)?;
        let pressure = Pressure::new(&mesh, &problem.cavity_facets());
        let contact = ContactModel::new(&mesh, &problem.contact_pairs, &problem.contact);
        let held = problem.held_dofs();
        let assembler = Assembler::new(mesh.num_nodes(), &[&solid, &pressure], &[]);
        let factor = Factor::new(Arc::new(Symbolic::analyze(assembler.pattern(), Ordering::default())?));
        let warp = Warp::new(&mesh, &held, parallelism)?;
        let carried_tractions = vec![0.0; contact.num_points()];
        let near_margin = NEAR_SHARE * contact.rest_distance();
        let timing = Timing { factor_s: start.elapsed().as_secs_f64(), ..Timing::default() };
        Ok(Self {
            mesh,
            solid,
            pressure,
            contact,
            near_margin,
            touching: Vec::new(),
            positions: Vec::new(),
            pending: None,
            linearisation: None,
            carried_tractions,
            assembler,
            factor,
            warp,
            totals: Totals::default(),
            held,
            parallelism,
            contact_points: 0,
            timing,
        })
    }

    /// For every degree of freedom (3 · node + axis) whether it is held.
    pub fn held(&self) -> &[bool] {
        &self.held
    }

    /// Sums of the last [`System::assemble`].
    pub fn totals(&self) -> &Totals {
        &self.totals
    }

    /// Contact points that touched in the last [`System::assemble`].
    pub fn contact_points(&self) -> usize {
        self.contact_points
    }

    /// Energy, residual and, if asked for, tangent at a displacement and a pressure (MPa).
    ///
    /// # Errors
    /// [`LocalError`] naming the element that is turned inside out.
    pub fn assemble(
        &mut self,
        displacement: &[[f64; 3]],
        pressure: f64,
        request: Request,
    ) -> Result<(), AssembleError> {
        let start = Instant::now();
        if request == Request::Tangent {
            self.linearise_at(displacement, pressure);
            self.timing.assembly_s += start.elapsed().as_secs_f64();
        }
        let start = Instant::now();
        self.pressure.pressure = pressure;
        let positions = self.positions(displacement);
        let mut contact = Contact::search(&self.contact, positions.clone());
        for point in contact.blocks.iter_mut().flat_map(|block| &mut block.points) {
            point.traction = self.carried_tractions[point.number];
        }
        if request == Request::Tangent && !self.assembler.covers(&contact) {
            let near = self.contact.near_face_pairs(&positions, self.near_margin);
            self.assembler = Assembler::new(self.mesh.num_nodes(), &[&self.solid, &self.pressure], &near);
            self.timing.contact_s += start.elapsed().as_secs_f64();
            let analysis = Instant::now();
            self.factor = Factor::new(Arc::new(Symbolic::analyze(self.assembler.pattern(), Ordering::default())?));
            self.timing.factor_s += analysis.elapsed().as_secs_f64();
        } else {
            self.timing.contact_s += start.elapsed().as_secs_f64();
        }
        self.contact_points = contact.num_points();

        let start = Instant::now();
        self.assembler.reset(&mut self.totals, request);
        self.assembler.add(SOLID, &self.solid, displacement, request, &mut self.totals)?;
        self.assembler.add(PRESSURE, &self.pressure, displacement, request, &mut self.totals)?;
        self.timing.assembly_s += start.elapsed().as_secs_f64();
        let start = Instant::now();
        self.assembler.add_changing(&contact, displacement, request, &mut self.totals)?;
        self.touching = contact.blocks;
        self.positions = positions;
        self.timing.contact_s += start.elapsed().as_secs_f64();
        Ok(())
    }

    /// Brings the carried pressures up to date and notes what the tangent is made from.
    fn linearise_at(&mut self, displacement: &[[f64; 3]], pressure: f64) {
        let before = self.linearisation.take().map(|linearisation| linearisation.carried);
        let carried = match (self.pending.take(), before) {
            (Some(new), _) => {
                match &new.correction {
                    Some(correction) => self.solid.update_pressures(&new.displacement, correction),
                    None => self.solid.carry_pressures(&new.displacement),
                }
                new
            }
            (None, Some(old)) => old,
            // Nothing was ever carried: the pressures at rest, which are zero.
            (None, None) => Carried { displacement: vec![[0.0; 3]; displacement.len()], correction: None },
        };
        let tractions = self.carried_tractions.clone();
        self.linearisation = Some(Linearisation { pressure, displacement: displacement.to_vec(), carried, tractions });
    }

    /// Where the last tangent was assembled.
    pub fn linearisation(&self) -> Option<&Linearisation> {
        self.linearisation.as_ref()
    }

    /// Assembles and factorises the tangent of an earlier linearisation again. Its lists must have this problem's lengths.
    ///
    /// # Errors
    /// An element turned inside out or a singular tangent, which an earlier linearisation of the same problem has not.
    pub fn restore(&mut self, linearisation: Linearisation) -> Result<(), AssembleError> {
        let Linearisation { pressure, displacement, carried, tractions } = linearisation;
        self.pending = Some(carried);
        self.carried_tractions = tractions;
        self.assemble(&displacement, pressure, Request::Tangent)?;
        self.factorize()?;
        Ok(())
    }

    /// Number of contact points, touching or not.
    pub fn num_contact_points(&self) -> usize {
        self.carried_tractions.len()
    }

    /// Norm of the pressure's forces on the free degrees of freedom at a displacement, N: the scale of the residual.
    pub fn load_norm(&mut self, displacement: &[[f64; 3]], pressure: f64) -> f64 {
        self.pressure.pressure = pressure;
        let mut totals = Totals::default();
        self.assembler.reset(&mut totals, Request::Residual);
        // Pressure on a face has no state that could fail.
        let _ = self.assembler.add(PRESSURE, &self.pressure, displacement, Request::Residual, &mut totals);
        self.free_norm(totals.residual.as_flattened())
    }

    /// Norm of a vector over the free degrees of freedom.
    pub fn free_norm(&self, vector: &[f64]) -> f64 {
        vector.iter().zip(&self.held).filter(|(_, held)| !**held).map(|(x, _)| x * x).sum::<f64>().sqrt()
    }

    /// Factorises the assembled tangent.
    ///
    /// # Errors
    /// If the tangent is singular or not finite.
    pub fn factorize(&mut self) -> Result<Inertia, FactorError> {
        let start = Instant::now();
        let result = self.factor.factorize(&self.totals.tangent, &self.held, self.parallelism);
        self.timing.factor_s += start.elapsed().as_secs_f64();
        result
    }

    /// Correction δu from K δu = −r with the last factor, and the multipliers λ = −(r + K δu) at held degrees of freedom if the
    /// assembled tangent is the factorised one. `prescribed` are the changes wanted at held degrees of freedom.
    ///
    /// # Errors
    /// If nothing was factorised.
    pub fn solve(&mut self, prescribed: Option<&[[f64; 3]]>) -> Result<Vec<[f64; 3]>, FactorError> {
        let start = Instant::now();
        let residual = self.totals.residual.as_flattened();
        let mut rhs: Vec<f64> = residual.iter().map(|r| -r).collect();
        if let Some(prescribed) = prescribed {
            let imposed: Vec<f64> = prescribed
                .as_flattened()
                .iter()
                .zip(&self.held)
                .map(|(x, held)| if *held { *x } else { 0.0 })
                .collect();
            let mut product = vec![0.0; rhs.len()];
            multiply::<3>(self.assembler.pattern(), &self.totals.tangent, &imposed, &mut product)?;
            for i in 0..rhs.len() {
                rhs[i] = if self.held[i] { imposed[i] } else { rhs[i] - product[i] };
            }
        } else {
            for (value, held) in rhs.iter_mut().zip(&self.held) {
                if *held {
                    *value = 0.0;
                }
            }
        }
        self.factor.solve_in_place(&mut rhs, 1)?;
        self.timing.solve_s += start.elapsed().as_secs_f64();
        Ok(rhs.chunks_exact(3).map(|x| [x[0], x[1], x[2]]).collect())
    }

    /// Multipliers λ = −(r + K δu) of the held degrees of freedom after a correction; zero at free ones.
    ///
    /// # Errors
    /// If the assembled tangent does not fit (nothing was assembled).
    pub fn multipliers(&mut self, correction: &[[f64; 3]]) -> Result<Vec<f64>, FactorError> {
        let start = Instant::now();
        let mut product = vec![0.0; self.held.len()];
        multiply::<3>(self.assembler.pattern(), &self.totals.tangent, correction.as_flattened(), &mut product)?;
        for ((value, r), held) in product.iter_mut().zip(self.totals.residual.as_flattened()).zip(&self.held) {
            *value = if *held { -(*value + r) } else { 0.0 };
        }
        self.timing.solve_s += start.elapsed().as_secs_f64();
        Ok(product)
    }

    /// Updates the carried pressures and contact tractions by what the linear system, assembled at `displacement`, makes
    /// of them under a correction.
    pub fn carry(&mut self, displacement: &[[f64; 3]], correction: &[[f64; 3]]) {
        let start = Instant::now();
        self.pending = Some(Carried { displacement: displacement.to_vec(), correction: Some(correction.to_vec()) });
        self.carried_tractions.fill(0.0);
        for block in &self.touching {
            for (number, traction) in predicted_tractions(&self.contact, block, &self.positions, correction) {
                self.carried_tractions[number] = traction;
            }
        }
        self.timing.solve_s += start.elapsed().as_secs_f64();
    }

    /// How much a correction deforms the body at a displacement.
    pub fn extent(&mut self, displacement: &[[f64; 3]], correction: &[[f64; 3]]) -> Extent {
        let start = Instant::now();
        let extent = self.warp.extent(displacement, correction);
        self.timing.solve_s += start.elapsed().as_secs_f64();
        extent
    }

    /// Applies a correction to the displacements, bent into rotations.
    ///
    /// # Errors
    /// [`LocalError`] if the state before the correction is turned inside out.
    pub fn warp(&mut self, displacement: &mut [[f64; 3]], correction: &[[f64; 3]]) -> Result<(), LocalError> {
        let start = Instant::now();
        let largest = correction.as_flattened().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        if largest < STRAIGHT_BELOW {
            for (u, delta) in displacement.as_flattened_mut().iter_mut().zip(correction.as_flattened()) {
                *u += delta;
            }
        } else {
            self.warp.apply(displacement, correction)?;
        }
        self.timing.solve_s += start.elapsed().as_secs_f64();
        Ok(())
    }

    /// Largest penetration of a contact point at a displacement, mm; 0 where nothing touches.
    pub fn deepest_penetration(&mut self, displacement: &[[f64; 3]]) -> f64 {
        let start = Instant::now();
        let blocks = self.contact.search(&self.positions(displacement));
        self.timing.contact_s += start.elapsed().as_secs_f64();
        blocks.iter().flat_map(|block| &block.points).fold(0.0, |deepest, point| deepest.max(-point.distance))
    }

    /// Restarts the carried pressures and contact tractions from those of a displacement.
    pub fn carry_pressures(&mut self, displacement: &[[f64; 3]]) {
        self.pending = Some(Carried { displacement: displacement.to_vec(), correction: None });
        self.carried_tractions.fill(0.0);
        for point in self.contact.search(&self.positions(displacement)).iter().flat_map(|block| &block.points) {
            self.carried_tractions[point.number] = point.traction;
        }
    }

    /// Energies at a displacement, mJ: of the solid, of the contact's penalty.
    ///
    /// # Errors
    /// [`LocalError`] naming the element that is turned inside out.
    pub fn energies(&mut self, displacement: &[[f64; 3]]) -> Result<[f64; 2], LocalError> {
        let contact = Contact::search(&self.contact, self.positions(displacement));
        let mut energy = |index: Option<usize>, contribution: &dyn LocalContribution| {
            let mut totals = Totals::default();
            self.assembler.reset(&mut totals, Request::Energy);
            match index {
                Some(index) => self.assembler.add(index, contribution, displacement, Request::Energy, &mut totals)?,
                None => self.assembler.add_changing(contribution, displacement, Request::Energy, &mut totals)?,
            }
            Ok(totals.energy)
        };
        Ok([energy(Some(SOLID), &self.solid)?, energy(None, &contact)?])
    }

    fn positions(&self, displacement: &[[f64; 3]]) -> Vec<[f64; 3]> {
        self.mesh.nodes.iter().zip(displacement).map(|(x, u)| std::array::from_fn(|k| x[k] + u[k])).collect()
    }
}

/// Why a state could not be assembled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AssembleError {
    /// An element is turned inside out.
    #[error(transparent)]
    Local(#[from] LocalError),
    /// The pattern with the new contacts cannot be analysed.
    #[error(transparent)]
    Factor(#[from] FactorError),
}
