//! The list of hyperelastic laws: which crate's law a material of the problem has.
//!
//! Everything else sees a law as a [`Hyperelastic`] only.

use std::sync::Arc;

use pneuflex_material::Hyperelastic;
use pneuflex_material_gent::Gent;
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
        &Law::Gent { shear_modulus, jm } => Arc::new(Gent::new(shear_modulus, jm)),
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
        Law::Gent { shear_modulus: 0.54, jm: 60.0 },
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
            let is_of_i1 = material.law.reduced_polynomial().is_some() || matches!(material.law, Law::Gent { .. });
            assert_eq!(derivatives.is_some(), is_of_i1, "{material:?}");
            if let Some(derivatives) = derivatives {
                assert_eq!(law.energy_and_stress(&kinematics), (derivatives.energy, derivatives.stress(&kinematics)));
            }
        }
    }

    /// Uniaxial Mooney-Rivlin: C₁₀/λ + C₀₁ λ = 0 across the load at λ = √(−C₁₀/C₀₁) = 2. Laws that cannot give way never do.
    #[test]
    fn laws_are_stable_as_far_as_their_closed_forms_say() {
        let stable = |material: &Material, l: f64| {
            let across = 1.0 / l.sqrt();
            pneuflex_material::drucker::is_stable(&*law_of(material), [across, l, across])
        };
        let mooney_rivlin: Material = Law::Polynomial { c10: 0.4, c01: -0.1, c20: 0.0, c11: 0.0, c02: 0.0 }.into();
        assert!(mooney_rivlin.law.may_give_way() && stable(&mooney_rivlin, 1.999) && !stable(&mooney_rivlin, 2.001));
        // Yeoh in planar tension ends at the root of 2x² + 2.5x − 19.5 = 0, x = I₁ − 3 = λ² + λ⁻² − 2.
        let yeoh: Material = Law::Yeoh { c10: 1.3, c20: -0.1, c30: 0.0 }.into();
        let x = (-2.5 + (2.5_f64 * 2.5 + 8.0 * 19.5).sqrt()) / 4.0;
        let end = (0.5 * (x + 2.0 + ((x + 2.0) * (x + 2.0) - 4.0).sqrt())).sqrt();
        let planar = |l: f64| pneuflex_material::drucker::is_stable(&*law_of(&yeoh), [1.0, l, 1.0 / l]);
        assert!(planar(0.999 * end) && !planar(1.001 * end));
        for material in samples().iter().filter(|material| !material.law.may_give_way()) {
            assert!([0.3, 0.9, 1.0, 1.7, 4.0].iter().all(|&l| stable(material, l)), "{material:?}");
        }
    }
}
