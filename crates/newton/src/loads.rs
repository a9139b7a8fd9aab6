//! The loads of a problem and the equations of the unknowns beside the displacements.

use std::sync::Arc;

use pneuflex_assembly::{
    Assembler, BoundaryTerm, Couplings, Equations, FollowerPressure, LocalContribution, LocalError, Request, Totals,
    conservative_load,
};
use pneuflex_model::load::Load;
use pneuflex_model::{Cavity, Control, Curve, OpenCavity, Problem};

use crate::border::{Row, Supply};
use crate::system::extent_of;

/// Stiffness that stabilises linear equations, relative to a shear modulus times an element's size: large enough to carry a part of the
/// body, small enough to lose no digits.
const EQUATION_STIFFNESS: f64 = 10.0;

/// Loads and linear equations.
pub struct Loads {
    /// Cavities, then other pressures.
    inflated: Vec<Inflated>,
    num_cavities: usize,
    equations: Equations,
    /// Forces that keep their direction, N, and their factors by time.
    dead: Vec<(Vec<[f64; 3]>, Curve)>,
    /// Largest extent of the body at rest, mm.
    size: f64,
}

/// Faces under a pressure, and what it is.
struct Inflated {
    faces: FollowerPressure,
    rim: BoundaryTerm,
    source: Source,
}

enum Source {
    /// Known by time, MPa.
    Given(Curve),
    /// Entry `unknown` of the border; the volume at rest, mm³.
    Unknown { unknown: usize, supply: Supply, rest_volume: f64 },
}

impl Loads {
    /// The loads of a problem.
    ///
    /// # Errors
    /// [`OpenCavity`] if the volume of a cavity matters that is not closed.
    pub fn new(problem: &Problem) -> Result<Self, OpenCavity> {
        let mesh = &problem.mesh;
        let mut inflated = Vec::new();
        let mut unknowns = 0;
        for cavity in &problem.cavities {
            inflated.push(Inflated::cavity(problem, cavity, &mut unknowns)?);
        }
        for load in &problem.loads {
            if let Load::Pressure { facets, curve } = load {
                let source = Source::Given(curve.clone());
                inflated.push(Inflated {
                    faces: FollowerPressure::new(Arc::clone(mesh), facets),
                    rim: BoundaryTerm::new(Arc::clone(mesh), facets),
                    source,
                });
            }
        }
        let element_size = (mesh.volume() / mesh.num_elements().max(1) as f64).cbrt();
        let (materials, _) = problem.materials();
        let stiffest = materials.iter().map(|material| material.shear_modulus()).fold(0.0, f64::max);
        let stiffness = EQUATION_STIFFNESS * stiffest * element_size;
        Ok(Self {
            num_cavities: problem.cavities.len(),
            inflated,
            equations: Equations::new(&problem.equations, stiffness),
            dead: problem.loads.iter().filter_map(|load| dead_load(problem, load)).collect(),
            size: extent_of(mesh),
        })
    }

    /// Number of unknowns beside the displacements: pressures (MPa) of cavities whose volume or gas is given, then multipliers (N) of the
    /// linear equations.
    pub fn num_unknowns(&self) -> usize {
        let is_unknown = |air: &&Inflated| matches!(air.source, Source::Unknown { .. });
        self.inflated.iter().filter(is_unknown).count() + self.equations.len()
    }

    /// Pressure in every cavity, MPa.
    pub fn cavity_pressures(&self, time: f64, border: &[f64]) -> Vec<f64> {
        self.inflated[..self.num_cavities].iter().map(|air| air.pressure_at(time, border)).collect()
    }

    /// What goes into an assembler's list, in this order.
    pub fn contributions(&self) -> impl Iterator<Item = &dyn LocalContribution> {
        let pressures = self.inflated.iter().map(|air| &air.faces as &dyn LocalContribution);
        pressures.chain(std::iter::once(&self.equations as &dyn LocalContribution))
    }

    /// Takes the loads of a time.
    pub fn set_time(&mut self, time: f64, border: &[f64]) {
        for air in &mut self.inflated {
            air.faces.pressure = air.pressure_at(time, border);
        }
        self.equations.set_time(time);
    }

    /// Adds pressures, the stabilising part of the equations and the forces that keep their direction. `first` is the number of
    /// [`Self::contributions`]' first in the assembler's list.
    pub fn add_forces(
        &self,
        assembler: &mut Assembler,
        first: usize,
        displacement: &[[f64; 3]],
        time: f64,
        request: Request,
        totals: &mut Totals,
    ) -> Result<(), LocalError> {
        for (index, contribution) in self.contributions().enumerate() {
            assembler.add(first + index, contribution, displacement, request, totals)?;
        }
        for (forces, curve) in &self.dead {
            add_scaled(&mut totals.residual, -curve.at(time), forces);
        }
        Ok(())
    }

    /// What the pressures' tangents have beside their symmetric parts, between free degrees of freedom.
    pub fn couplings(&self, displacement: &[[f64; 3]], held: &[bool]) -> Couplings {
        let mut couplings = Couplings::default();
        for air in &self.inflated {
            air.rim.couple(air.faces.pressure, displacement, &mut couplings);
        }
        couplings.condensed(held)
    }

    /// The equations of the unknowns beside the displacements at a state; the multipliers' forces are added to the residual.
    pub fn rows(
        &mut self,
        assembler: &mut Assembler,
        first: usize,
        displacement: &[[f64; 3]],
        time: f64,
        border: &[f64],
        totals: &mut Totals,
    ) -> Result<Vec<Row>, LocalError> {
        let mut rows = Vec::new();
        for (index, air) in self.inflated.iter_mut().enumerate() {
            let Source::Unknown { unknown, supply, rest_volume } = &air.source else { continue };
            let pressure = std::mem::replace(&mut air.faces.pressure, 1.0);
            let mut unit = Totals::default();
            assembler.reset(&mut unit, Request::Residual);
            assembler.add(first + index, &air.faces, displacement, Request::Residual, &mut unit)?;
            air.faces.pressure = pressure;
            let volumes = [air.faces.volume(displacement), *rest_volume];
            rows.push(supply.row(time, volumes, border[*unknown], unit.residual));
        }
        let multipliers = border[rows.len()..].to_vec();
        for (equation, multiplier) in multipliers.into_iter().enumerate() {
            let column = self.equations.column(equation, displacement.len());
            add_scaled(&mut totals.residual, multiplier, &column);
            let value = self.equations.violation(equation, displacement);
            rows.push(Row { value, along_column: 1.0, by_unknown: 0.0, scale: self.size, column });
        }
        Ok(rows)
    }
}

impl Inflated {
    fn cavity(problem: &Problem, cavity: &Cavity, unknowns: &mut usize) -> Result<Self, OpenCavity> {
        let mut faces = FollowerPressure::new(problem.mesh.clone(), &cavity.facets);
        let rim = BoundaryTerm::new(problem.mesh.clone(), &cavity.facets);
        let supply = match &cavity.control {
            Control::Pressure(curve) => return Ok(Self { faces, rim, source: Source::Given(curve.clone()) }),
            Control::Volume(change) => Supply::Volume(change.clone()),
            Control::Gas(gas) => Supply::Gas(gas.clone()),
        };
        faces.plane_y = problem.cavity_plane(cavity)?;
        let rest_volume = faces.volume(&vec![[0.0; 3]; problem.mesh.num_nodes()]);
        let source = Source::Unknown { unknown: *unknowns, supply, rest_volume };
        *unknowns += 1;
        Ok(Self { faces, rim, source })
    }

    fn pressure_at(&self, time: f64, border: &[f64]) -> f64 {
        match &self.source {
            Source::Given(curve) => curve.at(time),
            Source::Unknown { unknown, .. } => border[*unknown],
        }
    }
}

/// Forces on the nodes of a load that keeps its direction, N, and their factor by time.
fn dead_load(problem: &Problem, load: &Load) -> Option<(Vec<[f64; 3]>, Curve)> {
    let mesh = &problem.mesh;
    match load {
        Load::Force { nodes, force, curve } => {
            let mut forces = vec![[0.0; 3]; mesh.num_nodes()];
            for &node in nodes {
                for k in 0..3 {
                    forces[node as usize][k] += force[k];
                }
            }
            Some((forces, curve.clone()))
        }
        Load::Traction { facets, traction, curve } => {
            Some((conservative_load::traction_forces(mesh, facets, *traction), curve.clone()))
        }
        Load::Gravity { elements, acceleration, curve } => {
            let (materials, of_element) = problem.materials();
            let density = |element: u32| materials[usize::from(of_element[element as usize])].density_in_t_per_mm3();
            let forces = match elements {
                Some(elements) => {
                    conservative_load::weight_forces(mesh, elements.iter().copied(), density, *acceleration)
                }
                None => conservative_load::weight_forces(mesh, 0..mesh.num_elements() as u32, density, *acceleration),
            };
            Some((forces, curve.clone()))
        }
        Load::Pressure { .. } => None,
    }
}

fn add_scaled(sum: &mut [[f64; 3]], factor: f64, field: &[[f64; 3]]) {
    for (s, f) in sum.iter_mut().zip(field) {
        for k in 0..3 {
            s[k] += factor * f[k];
        }
    }
}
