//! Moment and curvature of the rod at a pressure.

use serde::{Deserialize, Serialize};

/// m = D(p) (κ − κ₀(p)) + D_c min(κ − κ_c(p), 0) with κ₀ = a₁p + a₂p², D = D₀ + D₁p.
///
/// Curvature is positive towards the side to which pressure bends the rod. There the chambers' walls part; bent the
/// other way they meet, at the curvature κ_c, and from then on the rod is stiffer by D_c **(our reading of "stiffening
/// after first contact")**. Since walls bulge under pressure, κ_c grows with it; where it has overtaken κ₀ the chambers
/// push each other apart and the rod bends further than κ₀ by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Law {
    /// Intrinsic curvature per pressure, 1/(mm·kPa).
    pub a1: f64,
    /// Intrinsic curvature per square of the pressure, 1/(mm·kPa²).
    pub a2: f64,
    /// Bending stiffness at rest, N·mm².
    pub d0: f64,
    /// Bending stiffness per pressure, N·mm²/kPa.
    pub d1: f64,
    /// Bending stiffness that touching chambers add, N·mm²; 0 for a rod that knows no contact.
    pub contact: f64,
    /// Curvature κ_c = `touch[0]` + `touch[1]` p at which chambers touch, 1/mm and 1/(mm·kPa). Read off, not fitted.
    pub touch: [f64; 2],
}

impl Law {
    /// Intrinsic curvature κ₀, 1/mm, at a pressure in kPa.
    pub fn intrinsic_curvature(&self, pressure_kpa: f64) -> f64 {
        pressure_kpa * (self.a1 + self.a2 * pressure_kpa)
    }

    /// Bending stiffness D without contact, N·mm², at a pressure in kPa.
    pub fn stiffness(&self, pressure_kpa: f64) -> f64 {
        self.d0 + self.d1 * pressure_kpa
    }

    /// Curvature at which chambers touch, 1/mm, at a pressure in kPa.
    pub fn touch_curvature(&self, pressure_kpa: f64) -> f64 {
        self.touch[0] + self.touch[1] * pressure_kpa
    }

    /// The same rod without contact.
    pub fn without_contact(self) -> Self {
        Self { contact: 0.0, ..self }
    }

    /// Moment in N·mm at a curvature in 1/mm.
    pub fn moment(&self, pressure_kpa: f64, curvature: f64) -> f64 {
        let free = self.stiffness(pressure_kpa) * (curvature - self.intrinsic_curvature(pressure_kpa));
        free + self.contact * (curvature - self.touch_curvature(pressure_kpa)).min(0.0)
    }

    /// Curvature in 1/mm at a moment in N·mm, and its derivative, 1/(N·mm²).
    pub fn curvature(&self, pressure_kpa: f64, moment: f64) -> (f64, f64) {
        let stiffness = self.stiffness(pressure_kpa);
        let free = self.intrinsic_curvature(pressure_kpa) + moment / stiffness;
        let touch = self.touch_curvature(pressure_kpa);
        if self.contact == 0.0 || free >= touch {
            return (free, 1.0 / stiffness);
        }
        let both = stiffness + self.contact;
        ((stiffness * free + self.contact * touch) / both, 1.0 / both)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: Law = Law { a1: 2e-3, a2: -1e-5, d0: 900.0, d1: -4.0, contact: 5000.0, touch: [-0.02, 1.5e-3] };

    #[test]
    fn curvature_undoes_moment() {
        let mut touching = 0;
        for pressure in [0.0, 5.0, 15.0, 35.0] {
            for curvature in [-0.05, -0.01, 0.0, 0.02, 0.08] {
                let moment = LAW.moment(pressure, curvature);
                let (back, slope) = LAW.curvature(pressure, moment);
                assert!((back - curvature).abs() < 1e-14, "{back} for {curvature}");
                let step = 1e-3;
                let difference = (LAW.curvature(pressure, moment + step).0 - LAW.curvature(pressure, moment - step).0)
                    / (2.0 * step);
                assert!((difference - slope).abs() < 1e-9 * slope);
                touching += usize::from(curvature < LAW.touch_curvature(pressure));
            }
        }
        assert!(touching > 3, "contact was not tested");
    }

    #[test]
    fn contact_beyond_the_intrinsic_curvature_bends_further() {
        // κ_c overtakes κ₀ with growing pressure: the free curvature then lies between them.
        let law = Law { touch: [-0.02, 4e-3], ..LAW };
        let (curvature, _) = law.curvature(35.0, 0.0);
        assert!(curvature > law.intrinsic_curvature(35.0) && curvature < law.touch_curvature(35.0));
        assert_eq!(law.without_contact().curvature(35.0, 0.0).0, law.intrinsic_curvature(35.0));
    }
}
