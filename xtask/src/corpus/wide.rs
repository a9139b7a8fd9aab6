//! Random case files over everything that a case file can say: laws, invariants, elements, thin and thick walls.

use super::design::{self, Lengths, Problem, geometric};

/// Quantities of a problem.
const QUANTITIES: usize = 22;

/// The case files of a seed: 1 to 14 chambers, lengths within 50 % of the paper's actuator, walls of 0.4 to 3 mm, gaps of 0.05 to 4 mm, bases of 1
/// to 8 mm, every law and element, both invariants, bulk moduli of 50 to 5000 shear moduli, pressures up to a quarter of the shear modulus.
pub fn problems(count: usize, seed: u64) -> Vec<Problem> {
    design::problems(count, seed, problem)
}

fn problem(number: usize, shares: &[f64; QUANTITIES]) -> Problem {
    let mut shares = shares.iter().copied();
    let mut next = || shares.next().unwrap_or(0.5);
    let mut about = |length: f64| length * (0.5 + next());
    let [cavity_length, flange, cavity_half_width, cavity_height] = [6.0, 2.0, 9.0, 8.0].map(&mut about);
    let [end_wall, side_wall, top_wall] = [(); 3].map(|()| geometric(next(), 0.4, 3.0));
    let base = geometric(next(), 1.0, 8.0);
    let lengths = Lengths {
        chambers: 1 + (14.0 * next()).min(13.0) as usize,
        cavity_length,
        end_wall,
        gap: geometric(next(), 0.05, 4.0),
        flange,
        cavity_half_width,
        side_wall,
        top_wall,
        base,
        cavity_height,
        channel_half_width: 0.5 + next(),
        channel_height: base * (0.1 + 0.5 * next()),
    };
    let shear_modulus = geometric(next(), 5e-3, 1.0) / 3.0;
    let (a, b) = (next(), next());
    let half = 0.5 * shear_modulus;
    let law = match (4.0 * next()) as usize {
        0 => {
            format!("law = \"yeoh\"\nc10 = {half:.5e}\nc20 = {:.5e}\nc30 = {:.5e}\n", half * (0.2 * a), half * 0.01 * b)
        }
        1 => format!("law = \"neo-hooke\"\nc10 = {half:.5e}\n"),
        2 => format!(
            "law = \"mooney-rivlin\"\nc10 = {:.5e}\nc01 = {:.5e}\n",
            half * (0.5 + 0.5 * a),
            half * 0.5 * (1.0 - a)
        ),
        _ => format!("law = \"ogden\"\nmu = [{shear_modulus:.5e}]\nalpha = [{:.4}]\n", 1.5 + 2.5 * a),
    };
    let is_full = next() < 0.5 && !(law.contains("mooney") || law.contains("ogden"));
    let elements = ["hex27", "hex20", "tet10", "hex8-q1p0", "hex8-sri"];
    let element = elements[((elements.len() as f64 * next()) as usize).min(elements.len() - 1)];
    let ratio = geometric(next(), 50.0, 5000.0);
    let last_kpa = 1e3 * shear_modulus * geometric(next(), 0.02, 0.25);
    let pressures: Vec<String> = [0.3, 0.6, 0.8, 1.0].map(|share| format!("{:.4e}", share * last_kpa)).into();
    let text = format!(
        "title = \"wide {number}\"\n\n{}\n[mesh]\nresolution = \"draft\"\nelement = \"{element}\"\n\n[material]\n{law}\
         bulk_modulus = {:.5e}\ninvariant = \"{}\"\n\n[load]\npressure_kpa = [{}]\n\n[output]\nfields = false\n",
        lengths.table(1.0),
        ratio * shear_modulus,
        if is_full { "full" } else { "isochoric" },
        pressures.join(", "),
    );
    Problem { number, text, thinnest_wall: lengths.thinnest_wall() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_case_is_valid() {
        for case in problems(200, 1) {
            let study = pneuflex::Study::from_text("wide.toml", &case.text);
            study.unwrap_or_else(|error| panic!("{error}\n{}", case.text));
        }
    }
}
