//! Constants of material laws, as `*HYPERELASTIC` and `*ELASTIC` give them.

use pneuflex_model::{Law, OgdenTerm};

use super::context::Context;
use crate::report::Place;
use crate::syntax::Block;

/// A law with its constants.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Constants {
    pub law: Law,
    /// Bulk modulus, MPa: 2/D₁, or E / 3(1 − 2ν). `None` if D₁ is 0 or missing.
    pub bulk_modulus: Option<f64>,
}

/// The words that name a law of `*HYPERELASTIC`.
const LAWS: [&str; 6] = ["NEOHOOKE", "YEOH", "MOONEY-RIVLIN", "POLYNOMIAL", "REDUCEDPOLYNOMIAL", "OGDEN"];

impl Constants {
    /// Reads `*HYPERELASTIC` or `*ELASTIC`; what is wrong goes to the report.
    pub fn read(block: &Block, context: &mut Context<'_>) -> Option<Self> {
        let constants =
            if block.keyword == "ELASTIC" { elastic(block, context) } else { hyperelastic(block, context) }?;
        let shear_modulus = constants.law.shear_modulus();
        if !(shear_modulus > 0.0 && shear_modulus.is_finite()) {
            context.error(
                block.place,
                format!(
                    "{}: the shear modulus at rest is {shear_modulus} MPa; it must be greater than 0",
                    block.written
                ),
            );
            return None;
        }
        Some(constants)
    }
}

fn elastic(block: &Block, context: &mut Context<'_>) -> Option<Constants> {
    context.expect_word(block, "TYPE", &["ISO", "ISOTROPIC"]);
    let numbers = values(block, 2, context)?;
    let (young, poisson) = (numbers[0], numbers[1]);
    if !(young > 0.0 && poisson > -1.0 && poisson < 0.5) {
        context.error(
            block.place,
            "*ELASTIC takes Young's modulus greater than 0 and Poisson's ratio from -1 to less than 0.5",
        );
        return None;
    }
    context.note(
        block.place,
        "*ELASTIC is solved as a compressible neo-Hookean material with the same moduli at rest: \
         C10 = E / 4(1+ν), bulk modulus E / 3(1-2ν)",
    );
    let law = Law::NeoHooke { c10: young / (4.0 * (1.0 + poisson)) };
    Some(Constants { law, bulk_modulus: Some(young / (3.0 * (1.0 - 2.0 * poisson))) })
}

fn hyperelastic(block: &Block, context: &mut Context<'_>) -> Option<Constants> {
    let given: Vec<&str> = LAWS.into_iter().filter(|law| block.has(law)).collect();
    let law = match given[..] {
        [law] => law,
        [] => "POLYNOMIAL",
        _ => {
            context.error(block.place, format!("{} has two laws", block.written));
            return None;
        }
    };
    let order = match block.value("N") {
        None => 1,
        Some(text) => context.integer(block.place, text)?,
    };
    let most = match law {
        "POLYNOMIAL" => 2,
        "REDUCEDPOLYNOMIAL" | "OGDEN" => 3,
        _ => 1,
    };
    if !(1..=most).contains(&order) {
        context.error(block.place, format!("{}: N={order} is not supported, only 1 to {most}", block.written));
        return None;
    }
    let n = order as usize;
    // Coefficients of the change of shape, then as many D as the law has.
    let (shape, volume) = match law {
        "NEOHOOKE" => (1, 1),
        "YEOH" => (3, 3),
        "MOONEY-RIVLIN" => (2, 1),
        "POLYNOMIAL" => ([2, 5][n - 1], n),
        "REDUCEDPOLYNOMIAL" => (n, n),
        _ => (2 * n, n),
    };
    let numbers = values(block, shape + volume, context)?;
    let (c, d) = numbers.split_at(shape);
    // CalculiX puts numbers of its own in place of zeros, so decks for it have very large ones, which stand for none.
    if d[1..].iter().any(|&other| other != 0.0 && d[0] / other.abs() > 1e-6) {
        let text = format!("{}: of the constants D only D1 is used, bulk modulus 2/D1", block.written);
        context.note(block.place, text);
    }
    if d[0] < 0.0 {
        context.error(block.place, format!("{}: D1 = {} must not be negative", block.written, d[0]));
        return None;
    }
    let get = |i: usize| c.get(i).copied().unwrap_or(0.0);
    let law = match law {
        "MOONEY-RIVLIN" | "POLYNOMIAL" => {
            Law::Polynomial { c10: get(0), c01: get(1), c20: get(2), c11: get(3), c02: get(4) }
        }
        "OGDEN" => {
            Law::Ogden { terms: c.chunks_exact(2).map(|term| OgdenTerm { mu: term[0], alpha: term[1] }).collect() }
        }
        "NEOHOOKE" => Law::NeoHooke { c10: get(0) },
        _ => Law::Yeoh { c10: get(0), c20: get(1), c30: get(2) },
    };
    Some(Constants { law, bulk_modulus: (d[0] > 0.0).then(|| 2.0 / d[0]) })
}

/// The constants of a block's only row, zeros where it is shorter. A temperature may follow.
fn values(block: &Block, count: usize, context: &mut Context<'_>) -> Option<Vec<f64>> {
    let place: Place = block.lines.first().map_or(block.place, |line| line.place);
    let mut numbers = context.numbers(block)?;
    // Rows have eight entries a line; a row that is longer goes on in the next.
    let lines = (count + 1).div_ceil(8);
    if numbers.is_empty() {
        context.error(block.place, format!("{} has no constants", block.written));
        return None;
    }
    if numbers.len() > count + 1 || block.lines.len() > lines.max(count.div_ceil(8)) {
        let text = format!(
            "{} takes {count} constants for one temperature; constants by temperature are not supported",
            block.written
        );
        context.error(place, text);
        return None;
    }
    numbers.resize(count, 0.0);
    Some(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Report;
    use crate::syntax::parse;

    #[test]
    fn constants_arrive_in_their_laws() {
        let yeoh = |c10, c20, c30| Law::Yeoh { c10, c20, c30 };
        let polynomial = |c10, c01, c20, c11, c02| Law::Polynomial { c10, c01, c20, c11, c02 };
        let ogden = |terms: &[(f64, f64)]| Law::Ogden {
            terms: terms.iter().map(|&(mu, alpha)| OgdenTerm { mu, alpha }).collect(),
        };
        let cases = [
            ("NEO HOOKE\n.2, 1.D-2\n", Law::NeoHooke { c10: 0.2 }),
            ("NEO HOOKE\n.2, 1.D-2, 293.\n", Law::NeoHooke { c10: 0.2 }),
            ("YEOH\n0.2, 0.02, -0.001, 0.01, 0., 0.\n", yeoh(0.2, 0.02, -0.001)),
            ("MOONEY-RIVLIN\n0.2, 0.05, 0.01\n", polynomial(0.2, 0.05, 0.0, 0.0, 0.0)),
            ("POLYNOMIAL\n0.2, 0.05, 0.01\n", polynomial(0.2, 0.05, 0.0, 0.0, 0.0)),
            ("N=2, POLYNOMIAL\n0.2, 0.05, 0.03, 0.02, 0.01, 0.01, 0.\n", polynomial(0.2, 0.05, 0.03, 0.02, 0.01)),
            ("N=2\n0.2, 0.05, 0.03, 0.02, 0.01, 0.01, 0.\n", polynomial(0.2, 0.05, 0.03, 0.02, 0.01)),
            ("REDUCED POLYNOMIAL, N=2\n0.2, 0.02, 0.01, 0.\n", yeoh(0.2, 0.02, 0.0)),
            ("OGDEN\n0.4, 2.5, 0.01\n", ogden(&[(0.4, 2.5)])),
            (
                "OGDEN, N=3\n0.4, 2.5, 0.1, 4., -0.05, -2., 0.01, 0.,\n0.\n",
                ogden(&[(0.4, 2.5), (0.1, 4.0), (-0.05, -2.0)]),
            ),
        ];
        for (text, law) in cases {
            let text = format!("*HYPERELASTIC, {text}");
            let (sources, blocks) = parse("a.inp", text.clone().into(), &mut |_| Err(String::new())).unwrap();
            let mut report = Report::default();
            let constants = Constants::read(&blocks[0], &mut Context { sources: &sources, report: &mut report });
            assert_eq!(constants, Some(Constants { law, bulk_modulus: Some(200.0) }), "{text}");
            assert!(report.finish(&sources.names).unwrap().is_empty(), "{text}");
        }
    }
}
