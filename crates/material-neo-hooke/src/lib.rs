//! Neo-Hookean hyperelasticity: W = C₁₀ (Ī − 3), with Ī = I₁ (the *full* invariant) or Ī = J^(−2/3) I₁ (*isochoric*).

use pneuflex_material::FirstInvariant;
use pneuflex_model::Invariant;

/// The neo-Hookean law without its volumetric term.
#[derive(Clone, Debug, PartialEq)]
pub struct NeoHooke {
    c10: f64,
    invariant: Invariant,
}

impl NeoHooke {
    /// The law with the constant C₁₀, MPa, half the shear modulus at rest.
    pub fn new(c10: f64, invariant: Invariant) -> Self {
        Self { c10, invariant }
    }
}

impl FirstInvariant for NeoHooke {
    #[inline]
    fn invariant(&self) -> Invariant {
        self.invariant
    }

    #[inline]
    fn energy_of(&self, x: f64) -> [f64; 3] {
        [self.c10 * x, self.c10, 0.0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_material::battery::{self, Mode};

    #[test]
    fn it_passes_the_battery() {
        for invariant in [Invariant::Full, Invariant::Isochoric] {
            let law = NeoHooke::new(0.2712, invariant);
            battery::check_isotropic(&law, 0.3);
            battery::check_homogeneous(&law, |mode, l| {
                2.0 * 0.2712
                    * match mode {
                        Mode::Uniaxial => l - l.powi(-2),
                        Mode::Equibiaxial => l - l.powi(-5),
                        Mode::Planar => l - l.powi(-3),
                    }
            });
        }
        battery::check_isochoric(&NeoHooke::new(0.2712, Invariant::Isochoric), 2.0 * 0.2712);
    }
}
