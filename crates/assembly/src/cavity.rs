//! Air or a liquid behind faces: its pressure is given, or follows from its volume or from an amount of gas (theory §4.4).
//!
//! | what is given | unknown | equation g | column B |
//! |---|---|---|---|
//! | the pressure | | | |
//! | the volume | pressure p | V − V₀ − ΔV(t) | −∂V/∂u |
//! | the gas | pressure p | p + p₀ − m(t) p₀ (V₀/V)ⁿ | −∂V/∂u |

use pneuflex_mesh::Facet;
use pneuflex_model::{Cavity, Control, Curve, Gas, LoadParameter, OpenCavity, Pressure, Problem};

use crate::boundary_term::{BoundaryTerm, Couplings};
use crate::contribution::{BorderedEquation, Contribution, Frozen, Position};
use crate::follower_pressure::FollowerPressure;
use crate::local::{LocalBlock, LocalContribution, LocalError, Request};

/// Faces under the pressure of a fluid.
#[derive(Clone, Debug)]
pub struct PressurisedFaces {
    faces: FollowerPressure,
    boundary: BoundaryTerm,
    supply: Supply,
    parameter: LoadParameter,
}

/// What determines the pressure.
#[derive(Clone, Debug)]
pub enum Supply {
    /// The pressure itself, MPa.
    Pressure(Curve),
    /// The change of a volume; both in mm³.
    Volume {
        /// By how much it exceeds the volume at rest.
        change: Curve,
        /// The volume at rest.
        at_rest: f64,
    },
    /// An amount of gas.
    Gas {
        /// The gas.
        gas: Gas,
        /// The volume at rest, mm³.
        at_rest: f64,
    },
}

impl PressurisedFaces {
    /// Some faces of a problem under a pressure that is given, MPa.
    pub fn with_pressure(problem: &Problem, facets: &[Facet], pressure: &Curve) -> Self {
        let faces = FollowerPressure::new(problem.mesh.clone(), facets);
        Self::new(problem, facets, faces, Supply::Pressure(pressure.clone()))
    }

    /// A cavity of a problem.
    ///
    /// # Errors
    /// [`OpenCavity`] if its volume matters and it is not closed.
    pub fn of_cavity(problem: &Problem, cavity: &Cavity) -> Result<Self, OpenCavity> {
        let mut faces = FollowerPressure::new(problem.mesh.clone(), &cavity.facets);
        if let Control::Pressure(curve) = &cavity.control {
            return Ok(Self::new(problem, &cavity.facets, faces, Supply::Pressure(curve.clone())));
        }
        faces.plane_y = problem.cavity_plane(cavity)?;
        let at_rest = faces.volume(&vec![[0.0; 3]; problem.mesh.num_nodes()]);
        let supply = match &cavity.control {
            Control::Pressure(curve) => Supply::Pressure(curve.clone()),
            Control::Volume(change) => Supply::Volume { change: change.clone(), at_rest },
            Control::Gas(gas) => Supply::Gas { gas: gas.clone(), at_rest },
        };
        Ok(Self::new(problem, &cavity.facets, faces, supply))
    }

    fn new(problem: &Problem, facets: &[Facet], faces: FollowerPressure, supply: Supply) -> Self {
        let boundary = BoundaryTerm::new(problem.mesh.clone(), facets);
        Self { faces, boundary, supply, parameter: LoadParameter::default() }
    }
}

impl PressurisedFaces {
    /// What determines the pressure.
    pub fn into_supply(self) -> Supply {
        self.supply
    }
}

impl Supply {
    /// Whether the pressure is an unknown.
    pub fn is_unknown(&self) -> bool {
        !matches!(self, Self::Pressure(_))
    }

    /// The pressure at a position on the load path; `unknown` is the unknown one.
    pub fn pressure(&self, parameter: LoadParameter, unknown: &[f64]) -> Pressure {
        Pressure::from_mpa(match self {
            Self::Pressure(curve) => curve.at(parameter),
            Self::Volume { .. } | Self::Gas { .. } => unknown.first().copied().unwrap_or(0.0),
        })
    }

    /// The equation of the pressure for a volume (mm³); `None` where the pressure is given. The column is −∂V/∂u.
    pub fn equation(
        &self,
        parameter: LoadParameter,
        volume: f64,
        pressure: Pressure,
        column: Vec<[f64; 3]>,
    ) -> Option<BorderedEquation> {
        match self {
            Self::Pressure(_) => None,
            Self::Volume { change, at_rest } => Some(BorderedEquation {
                value: volume - at_rest - change.at(parameter),
                along_column: -1.0,
                by_unknown: 0.0,
                scale: *at_rest,
                column,
            }),
            Self::Gas { gas: Gas { atmosphere, exponent, amount }, at_rest } => {
                // A volume that a bad guess turns negative has the pressure of a very small one.
                let ratio = at_rest / volume.max(1e-3 * at_rest);
                let absolute = amount.at(parameter) * atmosphere * ratio.powf(*exponent);
                Some(BorderedEquation {
                    value: pressure.mpa() + atmosphere - absolute,
                    along_column: -exponent * absolute * ratio / at_rest,
                    by_unknown: 1.0,
                    scale: *atmosphere,
                    column,
                })
            }
        }
    }
}

impl Contribution for PressurisedFaces {
    fn name(&self) -> &'static str {
        "pressure"
    }

    fn set_position(&mut self, position: Position<'_>) {
        self.parameter = position.parameter;
        self.faces.pressure = self.supply.pressure(position.parameter, position.bordered);
    }

    fn blocks(&self) -> Option<&dyn LocalContribution> {
        Some(&self.faces)
    }

    fn is_load(&self) -> bool {
        true
    }

    fn add_couplings(&self, displacement: &[[f64; 3]], couplings: &mut Couplings) {
        self.boundary.couple(self.faces.pressure, displacement, couplings);
    }

    /// A pressure acts on the deformed faces, which move with the positions at rest as with the displacements: the slope is −KᵀΛ. Where the
    /// pressure follows from a volume, that at rest counts, too, and nothing is said.
    fn add_shape_slope(&self, frozen: &Frozen<'_>, slope: &mut [[f64; 3]]) -> Result<bool, LocalError> {
        if self.supply.is_unknown() {
            return Ok(false);
        }
        let (u, multipliers) = (frozen.displacement, frozen.multipliers);
        let mut local = LocalBlock::default();
        for face in 0..self.faces.num_blocks() {
            let nodes = self.faces.nodes(face);
            local.reset(nodes.len(), Request::Tangent);
            self.faces.evaluate(face, u, Request::Tangent, &mut local)?;
            let pairs = (0..nodes.len()).flat_map(|a| (0..=a).map(move |b| (a, b)));
            for ((a, b), values) in pairs.zip(&local.tangent) {
                let [row, column] = [a, b].map(|place| nodes[place] as usize);
                for (k, value) in values.iter().enumerate() {
                    let (i, j) = (k % 3, k / 3);
                    slope[row][i] -= value * multipliers[column][j];
                    if a != b {
                        slope[column][j] -= value * multipliers[row][i];
                    }
                }
            }
        }
        let mut couplings = Couplings::default();
        self.add_couplings(u, &mut couplings);
        // Minus the transposed matrix is the matrix itself, which is skew.
        couplings.add_product(multipliers.as_flattened(), slope.as_flattened_mut());
        Ok(true)
    }

    fn num_bordered(&self) -> usize {
        usize::from(self.supply.is_unknown())
    }

    fn bordered_equations(&self, displacement: &[[f64; 3]]) -> Vec<BorderedEquation> {
        if !self.supply.is_unknown() {
            return Vec::new();
        }
        let column = self.faces.forces_of_unit_pressure(displacement);
        let volume = self.faces.volume(displacement);
        self.supply.equation(self.parameter, volume, self.faces.pressure, column).into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_are_linearised_by_their_derivatives() {
        let gas = Gas { atmosphere: 0.1, exponent: 1.4, amount: Curve::constant(1.7) };
        let volume = Supply::Volume { change: Curve::Proportional(3.0), at_rest: 50.0 };
        for supply in [volume, Supply::Gas { gas, at_rest: 50.0 }] {
            let at = |volume: f64, pressure: f64| {
                supply.equation(LoadParameter(2.0), volume, Pressure::from_mpa(pressure), Vec::new()).unwrap()
            };
            let (here, h) = (at(60.0, 0.02), 1e-4);
            assert!(here.value.abs() > 1e-3, "the check would be empty");
            // The column is −∂V/∂u: along it the volume falls.
            let by_volume = (at(60.0 + h, 0.02).value - at(60.0 - h, 0.02).value) / (2.0 * h);
            let by_pressure = (at(60.0, 0.02 + h).value - at(60.0, 0.02 - h).value) / (2.0 * h);
            assert!((by_volume + here.along_column).abs() < 1e-9, "{by_volume}");
            assert!((by_pressure - here.by_unknown).abs() < 1e-9);
        }
    }
}
