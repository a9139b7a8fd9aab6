//! The `[material]` table of a case file.

/// Bulk modulus over initial shear modulus unless the user says otherwise: Poisson's ratio 0.4995. Silicones are stiffer in
/// volume by far, but soft actuators do not notice, and the solver's penalty needs no more.
pub const BULK_RATIO: f64 = 1000.0;

/// The table with its comments.
pub fn material(comments: &[String], constants: [f64; 3], bulk_modulus: f64, bulk_comment: &str) -> String {
    let comments: String = comments.iter().map(|c| format!("# {}\n", c.replace(['\n', '\r'], " "))).collect();
    let [c10, c20, c30] = constants.map(rounded);
    let bulk_modulus = rounded(bulk_modulus);
    format!(
        "{comments}[material]\nlaw = \"yeoh\"\nc10 = {c10:?}\nc20 = {c20:?}\nc30 = {c30:?}\n\
         bulk_modulus = {bulk_modulus:?}  # {bulk_comment}\ninvariant = \"isochoric\"\n"
    )
}

/// To six significant digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
