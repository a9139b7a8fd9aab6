//! The `[material]` table of a case file.

use pneuflex::model::{Law, Material, OgdenTerm};

/// The table of a law, with its comments.
pub fn material(comments: &[String], material: &Material, bulk_comment: &str) -> String {
    let law = &material.law;
    let comments: String = comments.iter().map(|c| format!("# {}\n", c.replace(['\n', '\r'], " "))).collect();
    let mut constants: String =
        law.constants().iter().map(|(key, value)| format!("{key} = {:?}\n", rounded(*value))).collect();
    if let Law::Ogden { terms } = law {
        let list = |value: fn(&OgdenTerm) -> f64| {
            terms.iter().map(|term| format!("{:?}", rounded(value(term)))).collect::<Vec<_>>().join(", ")
        };
        constants += &format!("mu = [{}]\nalpha = [{}]\n", list(|term| term.mu), list(|term| term.alpha));
    }
    let (name, bulk_modulus) = (law.name(), rounded(material.bulk_modulus));
    let range = match material.fitted_to {
        Some(stretch) => {
            let tests: Vec<String> =
                stretch.tests().map(|(mode, stretch)| format!("{} = {stretch:?}", mode.name())).collect();
            let tests = tests.join(", ");
            format!("fitted_to = {{ {tests} }}  # largest stretches of the tests; a run that goes further warns\n")
        }
        None => String::new(),
    };
    format!(
        "{comments}[material]\nlaw = \"{name}\"\n{constants}\
         bulk_modulus = {bulk_modulus:?}  # {bulk_comment}\ninvariant = \"isochoric\"\n{range}"
    )
}

/// To six significant digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
