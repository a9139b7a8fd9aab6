//! Constants of known silicones, each with the source it was taken from.
//!
//! Two kinds: our own fits to public curves, stored thinned in `fixtures/curves` and refitted by a test of this crate; and
//! constants that stand in a publication or program, as they stand there. Names of products do not make a material: published
//! sets for one product differ by a factor of two, with batch, mixing, curing, strain rate, the first or a later loading, the
//! way strain is measured, and the range that is fitted.

use crate::bulk::{bulk_modulus, mean_stress};
use crate::law::{Law, Mode};
use pneuflex_model::{FittedTo, Material};

/// A set of Yeoh constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Product or material.
    pub name: &'static str,
    /// C₁₀, C₂₀, C₃₀, MPa.
    pub constants: [f64; 3],
    /// The test and its range, or that it is not known.
    pub range: &'static str,
    /// Where the constants are from.
    pub source: &'static str,
    /// Our own fit.
    pub fit: Option<OwnFit>,
    /// Bulk modulus of the source, MPa.
    pub bulk_modulus_of_source: Option<f64>,
}

impl Entry {
    /// The bulk modulus of the source, or one that suits the range of the fit, MPa.
    pub fn bulk_modulus(&self) -> f64 {
        let stress = self.fit.map_or(0.0, |fit| {
            mean_stress(Mode::Uniaxial, fit.to, Law::Yeoh.stress(&self.constants, Mode::Uniaxial, fit.to))
        });
        self.bulk_modulus_of_source.unwrap_or_else(|| bulk_modulus(2.0 * self.constants[0], stress))
    }

    /// The set as a material of case files, with six digits of what is chosen and not measured.
    pub fn material(&self) -> Material {
        let [c10, c20, c30] = self.constants;
        let bulk = self.bulk_modulus();
        let fitted_to =
            self.fit.map(|fit| FittedTo::of([(Mode::Uniaxial, fit.to)].into_iter().chain(fit.also.iter().copied())));
        let bulk_modulus = format!("{bulk:.5e}").parse().unwrap_or(bulk);
        Material { bulk_modulus, fitted_to, ..Material::yeoh(c10, c20, c30) }
    }
}

/// How constants of our own were fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnFit {
    /// File in `fixtures/curves`.
    pub curve: &'static str,
    /// Largest stretch of the fit.
    pub to: f64,
    /// Ends of other tests that were fitted, too.
    pub also: &'static [(Mode, f64)],
    /// Arguments of `pneuflex fit` after the file.
    pub arguments: &'static str,
}

const MARECHAL: &str = "own fit to the curve of Marechal et al. 2020, Soft Robotics, doi 10.1089/soro.2019.0115 (database under \
                        ODbL 1.0): ASTM D412, one pull to failure at 450 mm/min, strain from the crosshead";
const MEUNIER: &str = "own fit to the curves of Meunier et al. 2008 (unfilled silicone; uniaxial, equibiaxial and planar), as \
                       collected in github.com/Chongran-Zhao/Calibration-Hyperelasticity (MIT)";
/// Constants of a file of the program Sorotoki, at a commit.
macro_rules! sorotoki {
    ($file:literal, $commit:literal) => {
        concat!(
            "constants of the program Sorotoki (github.com/BJCaasenbrood/SorotokiCode, ",
            $file,
            " at commit ",
            $commit,
            "); the test behind them is not stated there"
        )
    };
}

const XU_LIU: &str = "Xu & Liu 2020, Effective enhanced model for a large deformable soft pneumatic actuator: the constants of \
                      their simulations; uniaxial test, product and range are not stated";
const UNKNOWN: &str = "not stated";

/// The longest range that Yeoh follows to 10 % from 10 % strain on: what `pneuflex fit` finds.
const fn own(name: &'static str, curve: &'static str, to: f64, range: &'static str, constants: [f64; 3]) -> Entry {
    let fit = OwnFit { curve, to, also: &[], arguments: "" };
    Entry { name, constants, range, source: MARECHAL, fit: Some(fit), bulk_modulus_of_source: None }
}

/// Up to twice the length, which actuators seldom go beyond.
const fn moderate(name: &'static str, curve: &'static str, constants: [f64; 3]) -> Entry {
    let fit = OwnFit { curve, to: 2.0, also: &[], arguments: "--to 2" };
    let range = "uniaxial, stretch 1 to 2, within 8 % from 10 % strain on";
    Entry { name, constants, range, source: MARECHAL, fit: Some(fit), bulk_modulus_of_source: None }
}

const fn published(name: &'static str, source: &'static str, constants: [f64; 3]) -> Entry {
    Entry { name, constants, range: UNKNOWN, source, fit: None, bulk_modulus_of_source: None }
}

/// All sets; those of one material follow each other, the one to try first in front.
pub const ENTRIES: [Entry; 31] = [
    own(
        "Ecoflex 00-10",
        "ecoflex_00-10.csv",
        10.864,
        "uniaxial, stretch 1 to 10.9, within 10 % from 10 % strain on",
        [0.00361431, 0.000125226, -4.04468e-7],
    ),
    moderate("Ecoflex 00-10", "ecoflex_00-10.csv", [0.00335331, 0.000494524, -0.00010421]),
    published("Ecoflex 00-10", sorotoki!("+preset/+material/Ecoflex0010.m", "ca7a079"), [0.003, -0.0002, 0.000023]),
    own(
        "Ecoflex 00-30",
        "ecoflex_00-30.csv",
        3.387,
        "uniaxial, stretch 1 to 3.4, within 10 % from 10 % strain on",
        [0.0072794, 0.000273847, -1.26944e-5],
    ),
    moderate("Ecoflex 00-30", "ecoflex_00-30.csv", [0.00675976, 0.00124597, -0.000321011]),
    published("Ecoflex 00-30", sorotoki!("src/fem/materials/samples/Ecoflex0030.m", "d062777"), [0.0084, 0.0001, 0.0]),
    published("Ecoflex 00-30", sorotoki!("+preset/+material/Ecoflex0030.m", "ca7a079"), [0.017, -0.0002, 0.000023]),
    own(
        "Ecoflex 00-35 FAST",
        "ecoflex_00-35_fast.csv",
        7.228,
        "uniaxial, stretch 1 to 7.2, within 8 % from 10 % strain on",
        [0.0132916, 0.000508612, -2.94121e-6],
    ),
    own(
        "Ecoflex 00-50",
        "ecoflex_00-50.csv",
        5.955,
        "uniaxial, stretch 1 to 6.0, within 10 % from 10 % strain on",
        [0.0102029, 0.00028543, -2.73055e-6],
    ),
    moderate("Ecoflex 00-50", "ecoflex_00-50.csv", [0.00939708, 0.00155391, -0.000351761]),
    published("Ecoflex 00-50", sorotoki!("+preset/+material/Ecoflex0050.m", "ca7a079"), [0.0145, 0.0001, 0.0]),
    own(
        "Dragon Skin 10",
        "dragon_skin_10_medium.csv",
        4.591,
        "uniaxial, stretch 1 to 4.6, within 10 % from 10 % strain on",
        [0.021418, 0.00266222, -6.3051e-5],
    ),
    moderate("Dragon Skin 10", "dragon_skin_10_medium.csv", [0.0200445, 0.00508504, -0.000752769]),
    published("Dragon Skin 10", sorotoki!("+preset/+material/Dragonskin10.m", "ca7a079"), [0.036, 0.00025, 0.000023]),
    own(
        "Dragon Skin 20",
        "dragon_skin_20.csv",
        3.841,
        "uniaxial, stretch 1 to 3.8, within 10 % from 10 % strain on",
        [0.0577898, 0.00848482, -0.000288148],
    ),
    moderate("Dragon Skin 20", "dragon_skin_20.csv", [0.0528059, 0.0183676, -0.00310985]),
    own(
        "Dragon Skin 30",
        "dragon_skin_30.csv",
        5.432,
        "uniaxial, stretch 1 to 5.4, within 10 % from 10 % strain on",
        [0.0916973, 0.00660846, -0.000112478],
    ),
    moderate("Dragon Skin 30", "dragon_skin_30.csv", [0.0845025, 0.0169131, -0.00254093]),
    published("Dragon Skin 30", sorotoki!("+preset/+material/Dragonskin30.m", "ca7a079"), [0.1536, 0.0016, 0.0]),
    own(
        "Dragon Skin FX Pro",
        "dragon_skin_fx_pro.csv",
        4.66,
        "uniaxial, stretch 1 to 4.7, within 10 % from 10 % strain on",
        [0.0139103, 0.000883834, -1.68062e-5],
    ),
    own(
        "Mold Star 16 FAST",
        "mold_star_16_fast.csv",
        7.591,
        "uniaxial, stretch 1 to 7.6, within 10 % from 10 % strain on",
        [0.0418688, 0.00244789, -1.99378e-5],
    ),
    moderate("Mold Star 16 FAST", "mold_star_16_fast.csv", [0.0399136, 0.00475607, -0.000588779]),
    own(
        "Mold Star 20T",
        "mold_star_20t.csv",
        7.341,
        "uniaxial, stretch 1 to 7.3, within 8 % from 10 % strain on",
        [0.0552268, 0.00287068, -2.4354e-5],
    ),
    own(
        "PlatSil Gel 10",
        "platsil_gel_10.csv",
        3.91,
        "uniaxial, stretch 1 to 3.9, within 10 % from 10 % strain on",
        [0.0264394, 0.00370977, -0.000126726],
    ),
    own(
        "RTV615",
        "rtv615.csv",
        2.932,
        "uniaxial, stretch 1 to 2.9, within 10 % from 10 % strain on",
        [0.164446, 0.0135812, 0.000949677],
    ),
    moderate("RTV615", "rtv615.csv", [0.163416, 0.0160531, -3.64249e-5]),
    own(
        "SortaClear 40",
        "sortaclear_40.csv",
        6.0,
        "uniaxial, stretch 1 to 6.0, within 3 % from 10 % strain on",
        [0.138725, 0.0058554, -6.73871e-5],
    ),
    published("Elastic 50A", sorotoki!("+preset/+material/Elastic50A.m", "ca7a079"), [0.5056, 0.0, 0.002562]),
    published("Elastosil 28", sorotoki!("+preset/+material/Elastosil28.m", "ca7a079"), [0.11, 0.02, 0.0]),
    Entry {
        name: "Silicone of Meunier 2008",
        constants: [0.179112, -0.0060882, 0.00229698],
        range: "uniaxial (stretch 0.49 to 2.17), equibiaxial (to 2.06) and planar (to 2.15) together, within 20 % from 10 % strain on",
        source: MEUNIER,
        fit: Some(OwnFit {
            curve: "meunier_2008.csv",
            to: 2.17,
            also: &[(Mode::Uniaxial, 0.49), (Mode::Equibiaxial, 2.06), (Mode::Planar, 2.15)],
            arguments: "--unit MPa",
        }),
        bulk_modulus_of_source: None,
    },
    Entry {
        name: "Silicone of Xu & Liu 2020",
        constants: [0.2712, 0.03053, -0.0004013],
        range: UNKNOWN,
        source: XU_LIU,
        fit: None,
        bulk_modulus_of_source: Some(1000.0),
    },
];

/// The name of a set on the command line: the material's in lower case with hyphens, and its number if it is not the first.
pub fn identifier(index: usize) -> String {
    let name = ENTRIES[index].name;
    let words: Vec<String> = crate::words::words_of(name).into_iter().filter(|w| w != "of").collect();
    let number = 1 + ENTRIES[..index].iter().filter(|e| e.name == name).count();
    let suffix = if number > 1 { format!(":{number}") } else { String::new() };
    format!("{}{suffix}", words.join("-"))
}

/// The sets that a text names: one by its identifier, with any punctuation and case.
pub fn find(text: &str) -> Option<usize> {
    let bare = |t: &str| t.to_lowercase().chars().filter(|c| c.is_alphanumeric() || *c == ':').collect::<String>();
    (0..ENTRIES.len()).find(|&i| bare(&identifier(i)) == bare(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_are_unique_and_found() {
        let mut all: Vec<String> = (0..ENTRIES.len()).map(identifier).collect();
        for (i, name) in all.iter().enumerate() {
            assert_eq!(find(name), Some(i), "{name}");
        }
        let named = |text: &str| find(text).map(identifier);
        assert_eq!(named("Dragon Skin 30").as_deref(), Some("dragon-skin-30"));
        assert_eq!(named("EcoFlex00-30:4").as_deref(), Some("ecoflex-00-30:4"));
        assert_eq!(named("butter"), None);
        all.sort();
        all.dedup();
        assert_eq!(all.len(), ENTRIES.len());
    }
}
