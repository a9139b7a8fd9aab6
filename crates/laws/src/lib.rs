//! The list of hyperelastic laws: which crate's law a material of the problem has.
//!
//! Everything else sees a law as a [`Hyperelastic`] only.

use std::sync::Arc;

use pneuflex_material::Hyperelastic;
use pneuflex_material_mooney_rivlin::MooneyRivlin;
use pneuflex_material_neo_hooke::NeoHooke;
use pneuflex_material_ogden::Ogden;
use pneuflex_material_yeoh::Yeoh;
use pneuflex_model::{Invariant, Law, Material, OgdenTerm};

/// The law of a material, without its volumetric energy.
pub fn law_of(material: &Material) -> Arc<dyn Hyperelastic> {
    match &material.law {
        &Law::Yeoh { c10, c20, c30 } => Arc::new(Yeoh::new([c10, c20, c30], material.invariant)),
        &Law::NeoHooke { c10 } => Arc::new(NeoHooke::new(c10, material.invariant)),
        &Law::Polynomial { c10, c01, c20, c11, c02 } => Arc::new(MooneyRivlin::new([c10, c01, c20, c11, c02])),
        Law::Ogden { terms } => Arc::new(Ogden::new(terms)),
    }
}

/// A material of every law and invariant, with the stiffness of a silicone: for tests of what must hold for all.
pub fn samples() -> Vec<Material> {
    let ogden = [(0.5, 1.7), (0.1, -2.4)].map(|(mu, alpha)| OgdenTerm { mu, alpha });
    let mut samples: Vec<Material> = [
        Law::Yeoh { c10: 0.2712, c20: 0.03053, c30: -0.000_401_3 },
        Law::NeoHooke { c10: 0.3 },
        Law::Polynomial { c10: 0.2, c01: 0.07, c20: 0.0, c11: 0.0, c02: 0.0 },
        Law::Polynomial { c10: 0.2, c01: 0.07, c20: 0.03, c11: -0.01, c02: 0.004 },
        Law::Ogden { terms: ogden.into() },
    ]
    .map(Material::from)
    .into();
    let full: Vec<Material> = samples
        .iter()
        .filter(|material| material.law.reduced_polynomial().is_some())
        .map(|material| Material { invariant: Invariant::Full, ..material.clone() })
        .collect();
    samples.extend(full);
    samples
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_material::Kinematics;

    /// The shear modulus that case files, element formulations and contact go by is that of the law itself.
    #[test]
    fn every_law_has_the_shear_modulus_of_its_material() {
        for material in samples() {
            let (law, shear) = (law_of(&material), 1e-6);
            let kinematics = Kinematics::new(&[[0.0, shear, 0.0], [0.0; 3], [0.0; 3]]).unwrap();
            let modulus = law.energy_and_stress(&kinematics).1[0][1] / shear;
            assert!((modulus / material.shear_modulus() - 1.0).abs() < 1e-5, "{material:?}: {modulus}");
        }
    }

    #[test]
    fn laws_of_the_first_invariant_say_so_and_are_the_same_both_ways() {
        let kinematics = Kinematics::new(&[[0.2, 0.1, 0.0], [-0.05, -0.1, 0.08], [0.03, 0.0, -0.07]]).unwrap();
        for material in samples() {
            let law = law_of(&material);
            let derivatives = law.by_invariants(&kinematics);
            assert_eq!(derivatives.is_some(), material.law.reduced_polynomial().is_some(), "{material:?}");
            if let Some(derivatives) = derivatives {
                assert_eq!(law.energy_and_stress(&kinematics), (derivatives.energy, derivatives.stress(&kinematics)));
            }
        }
    }
}
