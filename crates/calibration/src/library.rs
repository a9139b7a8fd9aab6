//! Constants of known silicones, each with the source it was taken from.
//!
//! Two kinds: our own fits to public curves, stored thinned in `fixtures/curves` and refitted by a test of this crate; and
//! constants that stand in a publication or program, as they stand there. Names of products do not make a material: published
//! sets for one product differ by a factor of two, with batch, mixing, curing, strain rate, the first or a later loading, the
//! way strain is measured, and the range that is fitted.

/// A set of Yeoh constants.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
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
    pub bulk_modulus: Option<f64>,
}

/// How constants of our own were fitted.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct OwnFit {
    /// File in `fixtures/curves`.
    pub curve: &'static str,
    /// Largest stretch of the fit.
    pub to: f64,
    /// Arguments of `pneuflex fit` after the file.
    pub arguments: &'static str,
}

const MARECHAL: &str = "own fit to the curve of Marechal et al. 2020, Soft Robotics, doi 10.1089/soro.2019.0115 (database under \
                        ODbL 1.0): ASTM D412, one pull to failure at 450 mm/min, strain from the crosshead";
const MEUNIER: &str = "own fit to the curves of Meunier et al. 2008 (unfilled silicone; uniaxial, equibiaxial and planar), as \
                       collected in github.com/Chongran-Zhao/Calibration-Hyperelasticity (MIT)";
const SOROTOKI: &str = "constants of the program Sorotoki (github.com/BJCaasenbrood/SorotokiCode, src/fem/materials/samples, \
                        file of this name); the test behind them is not stated there";
const XU_LIU: &str = "Xu & Liu 2020, Effective enhanced model for a large deformable soft pneumatic actuator: the constants of \
                      their simulations; uniaxial test, product and range are not stated";
const UNKNOWN: &str = "not stated";

const fn own(name: &'static str, curve: &'static str, to: f64, constants: [f64; 3]) -> Entry {
    let (range, arguments) = if to == 4.0 {
        ("uniaxial, stretch 1 to 4", "--residuals absolute --to 4")
    } else if to == 2.0 {
        ("uniaxial, stretch 1 to 2", "--residuals absolute --to 2")
    } else {
        ("uniaxial, the whole curve, stretch 1 to 2.93", "--residuals absolute --to all")
    };
    Entry { name, constants, range, source: MARECHAL, fit: Some(OwnFit { curve, to, arguments }), bulk_modulus: None }
}

const fn published(name: &'static str, constants: [f64; 3]) -> Entry {
    Entry { name, constants, range: UNKNOWN, source: SOROTOKI, fit: None, bulk_modulus: None }
}

/// All sets; those of one material follow each other, the one to try first in front.
pub const ENTRIES: [Entry; 22] = [
    own("Ecoflex 00-10", "ecoflex_00-10.csv", 4.0, [0.00358883, 0.000141604, -3.76198e-7]),
    own("Ecoflex 00-10", "ecoflex_00-10.csv", 2.0, [0.00351249, 0.000248123, -2.70888e-5]),
    own("Ecoflex 00-30", "ecoflex_00-30.csv", 4.0, [0.00779207, 0.00010883, -1.00922e-6]),
    own("Ecoflex 00-30", "ecoflex_00-30.csv", 2.0, [0.00719839, 0.00061975, -0.000117161]),
    published("Ecoflex 00-30", [0.0084, 0.0001, 0.0]),
    own("Ecoflex 00-50", "ecoflex_00-50.csv", 4.0, [0.0106768, 0.000259148, -3.20878e-6]),
    own("Ecoflex 00-50", "ecoflex_00-50.csv", 2.0, [0.00982766, 0.000933254, -0.000160754]),
    published("Ecoflex 00-50", [0.0145, 0.0001, 0.0]),
    own("Dragon Skin 10", "dragon_skin_10_medium.csv", 4.0, [0.0242584, 0.00225651, -5.45625e-5]),
    own("Dragon Skin 10", "dragon_skin_10_medium.csv", 2.0, [0.0202441, 0.00469457, -0.000607724]),
    published("Dragon Skin 10", [0.036, 0.00025, 0.000023]),
    own("Dragon Skin 20", "dragon_skin_20.csv", 4.0, [0.0703753, 0.00522858, -0.000112948]),
    own("Dragon Skin 20", "dragon_skin_20.csv", 2.0, [0.0555063, 0.0145685, -0.00195569]),
    own("Dragon Skin 30", "dragon_skin_30.csv", 4.0, [0.100521, 0.00639226, -0.000149414]),
    own("Dragon Skin 30", "dragon_skin_30.csv", 2.0, [0.0862024, 0.0142963, -0.00163889]),
    published("Dragon Skin 30", [0.1536, 0.0016, 0.0]),
    own("Mold Star 16 FAST", "mold_star_16_fast.csv", 4.0, [0.0422276, 0.00289065, -4.37234e-5]),
    own("Mold Star 16 FAST", "mold_star_16_fast.csv", 2.0, [0.0405808, 0.00369622, -0.000217919]),
    own("RTV615", "rtv615.csv", 2.932, [0.162806, 0.0140725, 0.000913052]),
    own("RTV615", "rtv615.csv", 2.0, [0.16581, 0.0127241, 0.000987216]),
    Entry {
        name: "Silicone of Meunier 2008",
        constants: [0.182363, -0.00489973, 0.0020688],
        range: "uniaxial (stretch 0.49 to 2.17), equibiaxial (to 2.06) and planar (to 2.15) together",
        source: MEUNIER,
        fit: Some(OwnFit {
            curve: "meunier_2008.csv",
            to: 10.0,
            arguments: "--unit MPa --residuals absolute --to all",
        }),
        bulk_modulus: None,
    },
    Entry {
        name: "Silicone of Xu & Liu 2020",
        constants: [0.2712, 0.03053, -0.0004013],
        range: UNKNOWN,
        source: XU_LIU,
        fit: None,
        bulk_modulus: Some(1000.0),
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
        assert_eq!((all[2].as_str(), all[4].as_str()), ("ecoflex-00-30", "ecoflex-00-30:3"));
        assert_eq!((find("Dragon Skin 30"), find("EcoFlex00-30:2"), find("butter")), (Some(13), Some(3), None));
        all.sort();
        all.dedup();
        assert_eq!(all.len(), ENTRIES.len());
    }
}
