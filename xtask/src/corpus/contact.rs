//! Random actuators that meet something: a table, a ball, a bar or a box, which stays where it is or is moved.

use super::design::{self, Design, Drawn, Problem, QUANTITIES, geometric};

/// Quantities of a problem: those of its actuator, and its own.
const ALL: usize = QUANTITIES + 8;

/// The problems of a seed: actuators as those of the other corpus, a hundredth to a hundred times as large, shear moduli over three
/// decades. In the first half of the time air is pumped in, in the second the obstacle moves, if it does. It keeps clear of the clamp, where
/// nothing would give way.
pub fn problems(count: usize, seed: u64) -> Vec<Problem> {
    design::problems(count, seed, problem)
}

/// Share of its distance at rest by which a table comes nearer to the clamp at the most.
const CLEAR: f64 = 0.9;

/// How far an obstacle of a shape and radius that rises to `top` above the level of the finger's lower side reaches from its middle on
/// that level.
fn reach(shape: usize, radius: f64, top: f64) -> f64 {
    match shape {
        _ if top <= 0.0 => f64::NEG_INFINITY,
        1 | 2 => (radius * radius - (radius - top).max(0.0).powi(2)).sqrt(),
        _ => radius,
    }
}

fn problem(number: usize, shares: &[f64; ALL]) -> Problem {
    let own: [f64; QUANTITIES] = std::array::from_fn(|k| shares[k]);
    let mut shares = shares[QUANTITIES..].iter().copied();
    let mut next = || shares.next().unwrap_or(0.5);
    let scale = geometric(next(), 1e-2, 1e2);
    let Drawn { body, length, height, shear_modulus, last_share, thinnest_wall, .. } =
        Design::new(number, own).draw(scale, geometric(next(), 0.5, 2.5));
    let shape = (4.0 * next()) as usize;
    let is_moved = next() < 0.6;
    let distance = height * geometric(next(), 0.02, 1.0);
    let along = length * (0.4 + 0.6 * next());
    let radius = height * geometric(next(), 0.3, 2.0);
    // The finger bends towards -z.
    let angle = std::f64::consts::PI * next();
    let way = if is_moved { 0.25 * height } else { 0.0 };
    let [x, z] = [way * angle.cos(), way * angle.sin()];
    let along = along.max(reach(shape, radius, z - distance) - x);
    let below = -distance - radius;
    let mut obstacle = match shape {
        0 => {
            // A table that rises further than the clamp is above it is tilted about its far end.
            let slope = ((z - CLEAR * distance) / (length + x)).max(0.0);
            format!(
                "shape = \"plane\"\npoint = [{length:.5e}, 0.0, {:.5e}]\nnormal = [{:.5e}, 0.0, 1.0]\n",
                -distance,
                0.0 - slope
            )
        }
        1 => format!("shape = \"sphere\"\ncentre = [{along:.5e}, 0.0, {below:.5e}]\nradius = {radius:.5e}\n"),
        2 => format!(
            "shape = \"cylinder\"\npoint = [{along:.5e}, 0.0, {below:.5e}]\naxis = [0.0, 1.0, 0.0]\nradius = {radius:.5e}\n"
        ),
        _ => format!(
            "shape = \"cuboid\"\ncentre = [{along:.5e}, 0.0, {below:.5e}]\nsize = [{:.5e}, {:.5e}, {:.5e}]\n\
             edge_radius = {:.5e}\n",
            2.0 * radius,
            4.0 * height,
            2.0 * radius,
            0.3 * radius
        ),
    };
    if is_moved {
        obstacle += &format!("displacement = [{x:.5e}, 0.0, {z:.5e}]\nfactor = [[0, 0], [1, 0], [2, 1]]\n");
    }
    let pressure = 1e3 * shear_modulus * last_share;
    let text = format!(
        "title = \"contact {number}\"\n\n{body}\n[[cavity]]\nname = \"air\"\nfaces = \"cavity\"\n\
         pressure_kpa = [[0, 0], [1, {pressure:.5}], [2, {pressure:.5}]]\n\n[[obstacle]]\nname = \"thing\"\n{obstacle}\n\
         [load]\ntimes = [0.5, 1.0, 1.5, 2.0]\n\n[output]\nfields = false\n"
    );
    Problem { number, text, thinnest_wall }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_problem_is_a_valid_model() {
        for problem in problems(40, 1) {
            let study = pneuflex::Study::from_text("contact.toml", &problem.text);
            study.unwrap_or_else(|error| panic!("{error}\n{}", problem.text));
        }
    }

    /// Tables that would otherwise: all problems together take long to build.
    #[test]
    fn tables_that_rise_keep_clear_of_the_clamp() {
        let is_tilted = |problem: &Problem| problem.text.contains("normal = [-");
        let tilted: Vec<Problem> = problems(60, 1).into_iter().filter(is_tilted).collect();
        assert!(tilted.len() > 2, "{}", tilted.len());
        for problem in tilted {
            let study = pneuflex::Study::from_text("contact.toml", &problem.text).unwrap();
            let cautions = study.build().unwrap().cautions();
            let is_in = cautions.iter().any(|warning| warning.kind == pneuflex::diagnosis::WarningKind::Penetration);
            assert!(!is_in, "{cautions:?}\n{}", problem.text);
        }
    }
}
