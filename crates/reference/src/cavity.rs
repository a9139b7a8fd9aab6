//! Cavities by what is known about the fluid in them (theory §4, §13).
//!
//! The energy is a function of the volume V alone: −p V for a given pressure p, −∫ p dV for gas with (p + p₀) Vⁿ = m p₀ V₀ⁿ. A
//! liquid is incompressible: V = V₀ + ΔV is a constraint, and minus its multiplier the pressure. A surface that encloses no volume has
//! no such energy; it may have a given pressure, whose virtual work needs none.

use nalgebra::{DMatrix, DVector, SVector};
use pneuflex_model::{Cavity, Control, Gas, LoadParameter, Problem};

use crate::differentiate::{Dual, Energy, gradient_of, hessian_of};
use crate::error::ReferenceError;
use crate::follower_pressure::FollowerPressure;
use crate::kkt::Constraint;
use crate::pressure::AirModel;

/// A cavity of a problem.
#[derive(Clone, Debug)]
pub struct CavityModel {
    walls: Walls,
    control: Control,
    // V₀, mm³; 0 if open.
    volume_at_rest: f64,
}

#[derive(Clone, Debug)]
enum Walls {
    /// Closed, or ending in planes of symmetry.
    Closed(AirModel),
    /// With a given pressure only.
    Open(FollowerPressure),
}

/// The energy of a cavity; v is its volume.
struct Fluid<'a> {
    control: &'a Control,
    volume_at_rest: f64,
    parameter: LoadParameter,
}

impl Energy<1> for Fluid<'_> {
    fn energy<D: Dual>(&self, v: &[D; 1]) -> D {
        match self.control {
            Control::Pressure(curve) => v[0] * -curve.at(self.parameter),
            Control::Volume(_) => D::from(0.0),
            Control::Gas(Gas { atmosphere, exponent, amount }) => {
                let ratio = v[0] / self.volume_at_rest;
                // ∫ (V₀/V)ⁿ dV / V₀
                let integral =
                    if *exponent == 1.0 { ratio.ln() } else { (ratio.powf(1.0 - exponent) - 1.0) / (1.0 - exponent) };
                v[0] * *atmosphere - integral * (amount.at(self.parameter) * atmosphere * self.volume_at_rest)
            }
        }
    }
}

impl CavityModel {
    /// A cavity, with the weights `axes` of its volume, see [`crate::pressure`].
    ///
    /// # Errors
    /// A volume that matters and is not defined; an element family without a formulation.
    pub fn new(problem: &Problem, cavity: &Cavity, axes: [f64; 3]) -> Result<Self, ReferenceError> {
        let Cavity { name: _, facets, control } = cavity;
        let walls = match (problem.cavity_plane(cavity), control) {
            (Ok(plane_y), _) => Walls::Closed(AirModel::new(problem, facets, axes, plane_y)?),
            (Err(_), Control::Pressure(_)) => Walls::Open(FollowerPressure::new(problem, facets)?),
            (Err(open), Control::Volume(_) | Control::Gas(_)) => return Err(open.into()),
        };
        let mut model = Self { walls, control: control.clone(), volume_at_rest: 0.0 };
        model.volume_at_rest = model.volume(&vec![0.0; problem.num_dofs()]).unwrap_or(0.0);
        Ok(model)
    }

    /// Volume at displacements `u`, mm³, if it has one.
    pub fn volume(&self, u: &[f64]) -> Option<f64> {
        match &self.walls {
            Walls::Closed(air) => Some(air.volume(u)),
            Walls::Open(_) => None,
        }
    }

    /// Whether the pressure is the multiplier of a constraint.
    pub fn is_constrained(&self) -> bool {
        matches!(self.control, Control::Volume(_))
    }

    /// Pressure above the atmosphere's, MPa; 0 of a liquid.
    pub fn pressure(&self, u: &[f64], parameter: LoadParameter) -> f64 {
        let volume = SVector::from([self.volume(u).unwrap_or(0.0)]);
        -gradient_of(&self.fluid(parameter), &volume).1[0]
    }

    /// The fluid's energy, N·mm; 0 of a liquid and of an open surface.
    pub fn energy(&self, u: &[f64], parameter: LoadParameter) -> f64 {
        self.volume(u).map_or(0.0, |volume| self.fluid(parameter).energy(&[volume]))
    }

    /// Minus the forces of the pressure, N.
    pub fn gradient(&self, u: &[f64], parameter: LoadParameter) -> DVector<f64> {
        let pressure = self.pressure(u, parameter);
        match &self.walls {
            Walls::Closed(air) => air.gradient(u, pressure),
            Walls::Open(faces) => faces.gradient(u, pressure),
        }
    }

    /// The derivative of [`Self::gradient`], N/mm.
    pub fn tangent(&self, u: &[f64], parameter: LoadParameter) -> DMatrix<f64> {
        let pressure = self.pressure(u, parameter);
        match &self.walls {
            Walls::Closed(air) => {
                let volume = SVector::from([air.volume(u)]);
                let (_, _, stiffness) = hessian_of(&self.fluid(parameter), &volume);
                let by_u = air.gradient(u, -1.0);
                air.hessian(u, pressure) + &by_u * by_u.transpose() * stiffness[0]
            }
            Walls::Open(faces) => faces.tangent(u, pressure),
        }
    }

    /// V − V₀ − ΔV of a liquid, mm³, with its derivatives.
    pub fn constraint(&self, u: &[f64], parameter: LoadParameter) -> Option<Constraint> {
        let (Control::Volume(change), Walls::Closed(air)) = (&self.control, &self.walls) else { return None };
        let value = air.volume(u) - self.volume_at_rest - change.at(parameter);
        Some(Constraint { value, gradient: air.gradient(u, -1.0).iter().copied().enumerate().collect() })
    }

    /// ∂²V/∂u² times a factor, mm.
    pub fn curvature(&self, u: &[f64], factor: f64) -> DMatrix<f64> {
        match &self.walls {
            Walls::Closed(air) => air.hessian(u, -factor),
            Walls::Open(_) => DMatrix::zeros(u.len(), u.len()),
        }
    }

    fn fluid(&self, parameter: LoadParameter) -> Fluid<'_> {
        Fluid { control: &self.control, volume_at_rest: self.volume_at_rest, parameter }
    }
}

#[cfg(test)]
mod tests {
    use pneuflex_model::{ContactMethod, Curve, Formulation};

    use super::*;
    use crate::pressure::ACROSS_Y;
    use crate::testing::{check_derivatives, noise, two_chambers};

    #[test]
    fn derivatives_of_the_energy_of_gas() {
        let problem = two_chambers([8.0, 9.0, 8.0], 2.0, Formulation::Hex8Q1p0, ContactMethod::None);
        for exponent in [1.0, 1.4] {
            let control = Control::Gas(Gas { atmosphere: 0.1, exponent, amount: Curve::constant(1.7) });
            let cavity = Cavity { control, ..problem.cavities[0].clone() };
            let model = CavityModel::new(&problem, &cavity, ACROSS_Y).unwrap();
            let (u, t) = (noise(problem.num_dofs(), 0.2), LoadParameter(1.0));
            let ratio = model.volume(&u).unwrap() / model.volume(&vec![0.0; u.len()]).unwrap();
            assert!((ratio - 1.0).abs() > 1e-3);
            let law = 0.1 * (1.7 * ratio.powf(-exponent) - 1.0);
            assert!((model.pressure(&u, t) - law).abs() < 1e-14);
            check_derivatives(|u| model.energy(u, t), |u| model.gradient(u, t), |u| model.tangent(u, t), &u);
        }
    }
}
