//! The equations of one problem: residual, tangent, factor, reactions at a given state.

use std::sync::Arc;
use std::time::Instant;

use pneuflex_assembly::solid::DegenerateElement;
use pneuflex_assembly::{Assembler, Contact, Couplings, LocalContribution, LocalError, Request, Solid, Totals};
use pneuflex_contact::{ContactBlock, ContactModel, predicted_tractions};
use pneuflex_factor::{Factor, FactorError, Inertia, Ordering, Parallelism, Symbolic, multiply};
use pneuflex_mesh::Mesh;
use pneuflex_model::{OpenCavity, Problem};

use crate::border::{self, Row};
use crate::checkpoint::{Carried, Linearisation};
use crate::gmres;
use crate::history::Timing;
use crate::loads::Loads;
use crate::warp::{Extent, Warp};

/// Corrections that move no node further than this are not bent: the next one makes up for their second-order part, mm.
const STRAIGHT_BELOW: f64 = 1e-3;

/// Index of the solid and of the first of the loads in the assembler's list.
const SOLID: usize = 0;
const FIRST_LOAD: usize = 1;

/// A problem that cannot be set up.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SetupError {
    /// An element of the mesh has no volume.
    #[error(transparent)]
    Degenerate(#[from] DegenerateElement),
    /// The structure of the equations cannot be analysed, or part of the body is not held.
    #[error("the equations cannot be set up: {0}")]
    Factor(#[from] FactorError),
    /// The volume of a cavity is asked for that is open.
    #[error(transparent)]
    Cavity(#[from] OpenCavity),
}

/// Displacements and what else is unknown.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Correction {
    /// Change of the displacements, mm, one entry per node.
    pub displacement: Vec<[f64; 3]>,
    /// Change of the unknowns beside them, see [`System::border_len`].
    pub border: Vec<f64>,
}

impl Correction {
    /// The same in parts.
    pub fn scaled(&self, factor: f64) -> Self {
        let displacement = self.displacement.iter().map(|x| x.map(|t| factor * t)).collect();
        Self { displacement, border: self.border.iter().map(|y| factor * y).collect() }
    }
}

/// The discretised equations of a [`Problem`] with everything that is reused from iteration to iteration.
pub struct System {
    mesh: Arc<Mesh>,
    solid: Solid,
    loads: Loads,
    /// Equations of the unknowns beside the displacements, as last assembled, and the columns −K⁻¹B of the last factor.
    rows: Vec<Row>,
    responses: Option<Vec<Vec<f64>>>,
    /// Unsymmetric part of the last tangent.
    couplings: Couplings,
    contact: ContactModel,
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
        let mesh = Arc::clone(&problem.mesh);
        let (materials, material_of) = problem.materials();
        let solid = Solid::of_materials(Arc::clone(&mesh), problem.formulation, &materials, material_of)?;
        let loads = Loads::new(problem)?;
        let contact = ContactModel::of(problem);
        let held = problem.held_dofs();
        let assembler = Assembler::new(mesh.num_nodes(), &fixed(&solid, &loads), &[]);
        let factor = Factor::new(Arc::new(Symbolic::analyze(assembler.pattern(), Ordering::default())?));
        let warp = Warp::new(&mesh, &held, parallelism)?;
        let carried_tractions = vec![0.0; contact.num_points()];
        let timing = Timing { factor_s: start.elapsed().as_secs_f64(), ..Timing::default() };
        Ok(Self {
            mesh,
            solid,
            loads,
            rows: Vec::new(),
            responses: None,
            couplings: Couplings::default(),
            contact,
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

    /// Number of unknowns beside the displacements: pressures (MPa) of cavities whose volume or gas is given, then multipliers (N) of the
    /// linear equations.
    pub fn border_len(&self) -> usize {
        self.loads.num_unknowns()
    }

    /// Pressure in every cavity, MPa.
    pub fn cavity_pressures(&self, time: f64, border: &[f64]) -> Vec<f64> {
        self.loads.cavity_pressures(time, border)
    }

    /// Energy, residual and, if asked for, tangent at a displacement, a time and the unknowns beside the displacements.
    ///
    /// # Errors
    /// [`LocalError`] naming the element that is turned inside out.
    pub fn assemble(
        &mut self,
        displacement: &[[f64; 3]],
        time: f64,
        border: &[f64],
        request: Request,
    ) -> Result<(), AssembleError> {
        let start = Instant::now();
        if request == Request::Tangent {
            self.linearise_at(displacement, time, border);
            self.timing.assembly_s += start.elapsed().as_secs_f64();
        }
        let start = Instant::now();
        self.loads.set_time(time, border);
        self.contact.set_time(time);
        let positions = self.positions(displacement);
        let mut contact = Contact::search(&self.contact, positions.clone());
        for point in contact.blocks.iter_mut().flat_map(|block| &mut block.points) {
            point.traction = self.carried_tractions[point.number];
        }
        if request == Request::Tangent && !self.assembler.covers(&contact) {
            let near = self.contact.near_face_pairs(&positions);
            let fixed = fixed(&self.solid, &self.loads);
            self.assembler = Assembler::new(self.mesh.num_nodes(), &fixed, &near);
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
        self.loads.add_forces(&mut self.assembler, FIRST_LOAD, displacement, time, request, &mut self.totals)?;
        if request == Request::Tangent {
            self.couplings = self.loads.couplings(displacement, &self.held);
        }
        self.responses = None;
        self.rows = self.loads.rows(&mut self.assembler, FIRST_LOAD, displacement, time, border, &mut self.totals)?;
        self.timing.assembly_s += start.elapsed().as_secs_f64();
        let start = Instant::now();
        self.assembler.add_changing(&contact, displacement, request, &mut self.totals)?;
        self.touching = contact.blocks;
        self.positions = positions;
        self.timing.contact_s += start.elapsed().as_secs_f64();
        Ok(())
    }

    /// Columns −K⁻¹B of the present factor.
    fn responses(&self) -> Result<Vec<Vec<f64>>, FactorError> {
        let mut all: Vec<f64> = Vec::with_capacity(self.rows.len() * self.held.len());
        for row in &self.rows {
            let column = row.column.as_flattened().iter().zip(&self.held);
            all.extend(column.map(|(b, held)| if *held { 0.0 } else { -b }));
        }
        self.solve_in_place(&mut all, self.rows.len())?;
        Ok(all.chunks_exact(self.held.len().max(1)).map(<[f64]>::to_vec).collect())
    }

    /// Solves K x = b for some columns b, the values of held degrees of freedom among them.
    fn solve_in_place(&self, columns: &mut [f64], count: usize) -> Result<(), FactorError> {
        self.factor.solve_in_place(columns, count)?;
        if self.couplings.is_empty() {
            return Ok(());
        }
        for column in columns.chunks_exact_mut(self.held.len().max(1)) {
            let solution = gmres::solve(column, |vector| {
                let free = |(x, held): (&f64, &bool)| if *held { 0.0 } else { *x };
                let moved: Vec<f64> = vector.iter().zip(&self.held).map(free).collect();
                let mut forces = vec![0.0; vector.len()];
                self.couplings.add_product(&moved, &mut forces);
                forces = forces.iter().zip(&self.held).map(free).collect();
                self.factor.solve_in_place(&mut forces, 1)?;
                Ok(vector.iter().zip(forces).map(|(x, y)| x + y).collect())
            })?;
            column.copy_from_slice(&solution);
        }
        Ok(())
    }

    /// K times a vector.
    fn product(&self, vector: &[f64]) -> Result<Vec<f64>, FactorError> {
        let mut product = vec![0.0; vector.len()];
        multiply::<3>(self.assembler.pattern(), &self.totals.tangent, vector, &mut product)?;
        self.couplings.add_product(vector, &mut product);
        Ok(product)
    }

    /// Largest violation of the equations of the unknowns beside the displacements, relative to what they are small against.
    pub fn border_violation(&self) -> f64 {
        self.rows.iter().fold(0.0, |largest, row| largest.max(row.value.abs() / row.scale))
    }

    /// Brings the carried pressures up to date and notes what the tangent is made from.
    fn linearise_at(&mut self, displacement: &[[f64; 3]], time: f64, border: &[f64]) {
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
        let (displacement, border) = (displacement.to_vec(), border.to_vec());
        self.linearisation = Some(Linearisation { time, border, displacement, carried, tractions });
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
        let Linearisation { time, border, displacement, carried, tractions } = linearisation;
        self.pending = Some(carried);
        self.carried_tractions = tractions;
        self.assemble(&displacement, time, &border, Request::Tangent)?;
        self.factorize()?;
        Ok(())
    }

    /// Number of contact points, touching or not.
    pub fn num_contact_points(&self) -> usize {
        self.carried_tractions.len()
    }

    /// Norm of the loads on the free degrees of freedom at a displacement, N: the scale of the residual. Loads are the pressures and
    /// what keeps its direction.
    pub fn load_norm(&mut self, displacement: &[[f64; 3]], time: f64, border: &[f64]) -> f64 {
        self.loads.set_time(time, border);
        let mut totals = Totals::default();
        self.assembler.reset(&mut totals, Request::Residual);
        // Loads have no state that could fail.
        let _ =
            self.loads.add_forces(&mut self.assembler, FIRST_LOAD, displacement, time, Request::Residual, &mut totals);
        self.free_norm(totals.residual.as_flattened())
    }

    /// Norm of the forces that the supports exert in the last assembled state, N.
    pub fn reaction_norm(&self) -> f64 {
        let reactions = self.totals.residual.as_flattened().iter().zip(&self.held).filter(|(_, held)| **held);
        reactions.map(|(x, _)| x * x).sum::<f64>().sqrt()
    }

    /// Norm of a vector over the free degrees of freedom.
    pub fn free_norm(&self, vector: &[f64]) -> f64 {
        vector.iter().zip(&self.held).filter(|(_, held)| !**held).map(|(x, _)| x * x).sum::<f64>().sqrt()
    }

    /// Factorises the assembled tangent. The inertia is that of motions that the equations beside the displacements allow. Under
    /// pressure on an open surface forces have no potential, and the inertia of the symmetric part says nothing: none is negative then.
    ///
    /// # Errors
    /// If the tangent is singular or not finite.
    pub fn factorize(&mut self) -> Result<Inertia, FactorError> {
        let start = Instant::now();
        let result = self.factor.factorize(&self.totals.tangent, &self.held, self.parallelism);
        self.timing.factor_s += start.elapsed().as_secs_f64();
        let mut inertia = result?;
        if !self.rows.is_empty() {
            let start = Instant::now();
            let responses = self.responses()?;
            let negative = inertia.negative + border::negative_eigenvalues(&self.rows, &responses);
            // Fewer than there are unknowns cannot be but for rounding.
            inertia.negative = negative.saturating_sub(self.rows.len());
            self.responses = Some(responses);
            self.timing.solve_s += start.elapsed().as_secs_f64();
        }
        if !self.couplings.is_empty() {
            inertia.negative = 0;
        }
        Ok(inertia)
    }

    /// Correction from K δu + B δy = −r and the equations of the unknowns δy beside the displacements, with the last factor.
    /// `prescribed` are the changes wanted at held degrees of freedom.
    ///
    /// # Errors
    /// If nothing was factorised, or the equations contradict each other.
    pub fn solve(&mut self, prescribed: Option<&[[f64; 3]]>) -> Result<Correction, AssembleError> {
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
            let product = self.product(&imposed)?;
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
        self.solve_in_place(&mut rhs, 1)?;
        let mut border = Vec::new();
        if !self.rows.is_empty() {
            let responses = match self.responses.take() {
                Some(responses) => responses,
                None => self.responses()?,
            };
            border = border::eliminate(&self.rows, &responses, &rhs).ok_or(AssembleError::Contradiction)?;
            for (change, response) in border.iter().zip(&responses) {
                for (value, y) in rhs.iter_mut().zip(response) {
                    *value += change * y;
                }
            }
            self.responses = Some(responses);
        }
        self.timing.solve_s += start.elapsed().as_secs_f64();
        Ok(Correction { displacement: rhs.chunks_exact(3).map(|x| [x[0], x[1], x[2]]).collect(), border })
    }

    /// Multipliers λ = −(r + K δu + B δy) of the held degrees of freedom after a correction; zero at free ones.
    ///
    /// # Errors
    /// If the assembled tangent does not fit (nothing was assembled).
    pub fn multipliers(&mut self, correction: &Correction) -> Result<Vec<f64>, FactorError> {
        let start = Instant::now();
        let mut product = self.product(correction.displacement.as_flattened())?;
        for (row, change) in self.rows.iter().zip(&correction.border) {
            for (value, b) in product.iter_mut().zip(row.column.as_flattened()) {
                *value += change * b;
            }
        }
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

    /// Traction that every contact point carries without penetration, MPa; empty for none.
    pub fn contact_multipliers(&self) -> &[f64] {
        self.contact.multipliers()
    }

    /// Sets them. There must be none or as many as contact points.
    pub fn set_contact_multipliers(&mut self, multipliers: Vec<f64>) {
        self.contact.set_multipliers(multipliers);
    }

    /// Tractions ⟨λ − k d⟩ of all contact points at a displacement, MPa, and the largest |d| of those that carry one, mm.
    pub fn contact_tractions(&mut self, displacement: &[[f64; 3]]) -> (Vec<f64>, f64) {
        let start = Instant::now();
        let mut tractions = vec![0.0; self.contact.num_points()];
        let mut distance: f64 = 0.0;
        for point in self.contact.search(&self.positions(displacement)).iter().flat_map(|block| &block.points) {
            tractions[point.number] = point.traction;
            distance = distance.max(point.distance.abs());
        }
        self.timing.contact_s += start.elapsed().as_secs_f64();
        (tractions, distance)
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
    /// Equations that no displacement satisfies, or that say the same twice.
    #[error("the linear equations or the cavities' volumes contradict or repeat each other")]
    Contradiction,
}

/// Largest extent of a body along an axis, mm.
pub fn extent_of(mesh: &Mesh) -> f64 {
    let along = |d: usize| {
        let span = |(a, b): (f64, f64), x: &[f64; 3]| (a.min(x[d]), b.max(x[d]));
        let (low, high) = mesh.nodes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), span);
        high - low
    };
    (0..3).map(along).fold(0.0, f64::max)
}

/// What does not change its nodes from assembly to assembly.
fn fixed<'a>(solid: &'a Solid, loads: &'a Loads) -> Vec<&'a dyn LocalContribution> {
    std::iter::once(solid as &dyn LocalContribution).chain(loads.contributions()).collect()
}
