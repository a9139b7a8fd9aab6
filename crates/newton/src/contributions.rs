//! The contributions of a problem, in the order in which they are added.

use pneuflex_assembly::cavity::{PressurisedFaces, Supply};
use pneuflex_assembly::{ConservativeLoads, ContactForces, Contribution, Distances, Equations, NodeSprings, Solid};
use pneuflex_model::load::Load;
use pneuflex_model::{LinearEquation, Pressure, Problem};

use crate::error::SetupError;
use crate::holding_springs::{dampers_of, springs_of};
use crate::state::State;

/// The list of a problem's contributions: solid, cavities, pressures on other faces, conservative loads, linear equations,
/// fixed distances, springs of what contact holds, contact, dampers of a body that may snap (`is_damped`). A new
/// kind of contribution is added here. `equations` are the linear equations that have not been eliminated.
///
/// # Errors
/// [`SetupError`] if an element is degenerate, the volume of an open cavity matters, or ties are not written as equations ([`crate::glued`]).
pub fn contributions_of(
    problem: &Problem,
    equations: &[LinearEquation],
    is_damped: bool,
) -> Result<Vec<Box<dyn Contribution>>, SetupError> {
    if let Some(tie) = problem.ties.first() {
        return Err(SetupError::Tie(tie.name.clone()));
    }
    let (materials, material_of) = problem.materials();
    let solid = Solid::of_materials(problem.mesh.clone(), problem.formulation, &materials, material_of)?;
    let mut list: Vec<Box<dyn Contribution>> = vec![Box::new(solid)];
    for cavity in &problem.cavities {
        list.push(Box::new(PressurisedFaces::of_cavity(problem, cavity)?));
    }
    for load in &problem.loads {
        if let Load::Pressure { facets, curve } = load {
            list.push(Box::new(PressurisedFaces::with_pressure(problem, facets, curve)));
        }
    }
    list.push(Box::new(ConservativeLoads::of(problem)));
    list.push(Box::new(Equations::of(problem, equations)));
    list.push(Box::new(Distances::of(problem)));
    list.push(Box::new(NodeSprings::new(&springs_of(problem), problem.mesh.num_nodes())));
    list.push(Box::new(ContactForces::of(problem)));
    if is_damped {
        list.push(Box::new(NodeSprings::dampers(&dampers_of(problem), problem.mesh.num_nodes())));
    }
    Ok(list)
}

/// The pressures of a problem's cavities, for reports.
pub struct CavityPressures(Vec<(Supply, Option<usize>)>);

impl CavityPressures {
    /// Those of a problem.
    ///
    /// # Errors
    /// [`SetupError::Cavity`] as [`contributions_of`].
    pub fn of(problem: &Problem) -> Result<Self, SetupError> {
        let mut unknowns = 0;
        let mut list = Vec::new();
        for cavity in &problem.cavities {
            let supply = PressurisedFaces::of_cavity(problem, cavity)?.into_supply();
            let unknown = supply.is_unknown().then_some(unknowns);
            unknowns += usize::from(supply.is_unknown());
            list.push((supply, unknown));
        }
        Ok(Self(list))
    }

    /// The pressure in every cavity.
    pub fn at(&self, state: &State) -> Vec<Pressure> {
        let unknown = |index: Option<usize>| index.map_or(&[][..], |index| &state.bordered[index..=index]);
        self.0.iter().map(|(supply, index)| supply.pressure(state.parameter, unknown(*index))).collect()
    }

    /// Of one number per cavity those of the cavities whose pressures are unknown.
    pub fn unknowns_of(&self, values: &[f64]) -> Vec<f64> {
        self.0.iter().zip(values).filter_map(|((_, index), value)| index.map(|_| *value)).collect()
    }

    /// The unknowns beside the displacements, as far as they are pressures, that give these pressures.
    pub fn unknowns(&self, pressures: &[Pressure]) -> Vec<f64> {
        let unknown = |((_, index), pressure): (&(Supply, Option<usize>), &Pressure)| index.map(|_| pressure.mpa());
        self.0.iter().zip(pressures).filter_map(unknown).collect()
    }
}
