//! `<Material>`.

use pneuflex_model::{Law, Material, OgdenTerm, Volumetric};

use super::xml::{Node, Reader, child, children, elements, text};
use crate::report::quoted;

/// So many terms has a sum over powers.
const MOST_TERMS: usize = 6;

/// Names with materials, in the order of the file.
pub(super) fn read_materials(section: Node<'_, '_>, reader: &mut Reader<'_>) -> Vec<(String, Material)> {
    reader.only(section, &["material"]);
    let mut found = Vec::new();
    for node in children(section, "material") {
        let (Some(id), Some(kind)) = (reader.id(node), reader.required(node, "type")) else { continue };
        let name = node.attribute("name").map_or_else(|| id.to_string(), str::to_owned);
        let Some(material) = material(node, kind, reader) else { continue };
        for problem in material.problems(&name) {
            reader.error(node, format!("material {problem}"));
        }
        found.push((name, material));
    }
    found
}

fn material(node: Node<'_, '_>, kind: &str, reader: &mut Reader<'_>) -> Option<Material> {
    let mut values: Vec<(&str, f64)> = Vec::new();
    for given in elements(node).filter(|given| !given.has_tag_name("pressure_model")) {
        values.push((given.tag_name().name(), reader.real(given)?));
    }
    let mut used = vec!["density", "pressure_model"];
    let mut value = |name: &'static str| {
        used.push(name);
        values.iter().find(|(given, _)| *given == name).map_or(0.0, |(_, value)| *value)
    };
    let terms = |letter: char| (1..=MOST_TERMS).map(move |i| format!("{letter}{i}"));
    let (law, bulk_modulus, is_split) = match kind {
        "neo-Hookean" | "isotropic elastic" => {
            let (young, poisson) = (value("E"), value("v"));
            if !(young > 0.0 && poisson > -1.0 && poisson < 0.5) {
                reader.error(node, format!("{kind} takes <E> greater than 0 and <v> from -1 to less than 0.5"));
                return None;
            }
            let text = format!(
                "material {} is solved as C10 (J^(-2/3) I1 - 3) + K/2 (ln J)^2 with the same moduli at rest: C10 = E / 4(1+v), K = E / 3(1-2v)",
                quoted(kind)
            );
            reader.note(node, text);
            (Law::NeoHooke { c10: young / (4.0 * (1.0 + poisson)) }, young / (3.0 * (1.0 - 2.0 * poisson)), false)
        }
        "incomp neo-Hookean" => (Law::NeoHooke { c10: 0.5 * value("G") }, value("k"), true),
        "Mooney-Rivlin" => {
            let (c10, c01) = (value("c1"), value("c2"));
            let law = if c01 == 0.0 {
                Law::NeoHooke { c10 }
            } else {
                Law::Polynomial { c10, c01, c20: 0.0, c11: 0.0, c02: 0.0 }
            };
            (law, value("k"), true)
        }
        "Yeoh" => {
            if ["c4", "c5", "c6"].map(&mut value) != [0.0; 3] {
                reader.error(node, "Yeoh's law has three terms here: c4, c5 and c6 must be 0");
                return None;
            }
            (Law::Yeoh { c10: value("c1"), c20: value("c2"), c30: value("c3") }, value("k"), true)
        }
        "Ogden" => {
            let names = terms('c').zip(terms('m'));
            let of = |name: &str| values.iter().find(|(given, _)| *given == name).map_or(0.0, |(_, value)| *value);
            // c/m² here is 2μ/α² there.
            let all = names.map(|(c, m)| OgdenTerm { mu: 0.5 * of(&c), alpha: of(&m) });
            let law = Law::Ogden { terms: all.filter(|term| term.mu != 0.0).collect() };
            (law, value("k"), true)
        }
        "Gent" => (Law::Gent { shear_modulus: value("G"), jm: value("Jm") }, value("k"), true),
        _ => {
            let text = format!(
                "material {} is not supported, only neo-Hookean, incomp neo-Hookean, Mooney-Rivlin, Yeoh, Ogden, Gent and isotropic elastic{}",
                quoted(kind),
                if kind.starts_with("rigid") {
                    "; rigid bodies of simple shapes are `[[obstacle]]` of a model file"
                } else {
                    ""
                }
            );
            reader.error(node, text);
            return None;
        }
    };
    let of_terms: Vec<String> = if kind == "Ogden" { terms('c').chain(terms('m')).collect() } else { Vec::new() };
    let known: Vec<&str> = used.iter().copied().chain(of_terms.iter().map(String::as_str)).collect();
    reader.only(node, &known);
    let volumetric = if is_split { volumetric(node, reader)? } else { Volumetric::Logarithmic };
    // Densities of the model are in g/cm³.
    let density = 1e9 * values.iter().find(|(name, _)| *name == "density").map_or(0.0, |(_, value)| *value);
    Some(Material { bulk_modulus, volumetric, density, ..Material::from(law) })
}

/// The energy of a change of volume of a law that is split: ½ k (ln J)² unless `<pressure_model>` has another one.
fn volumetric(node: Node<'_, '_>, reader: &mut Reader<'_>) -> Option<Volumetric> {
    match child(node, "pressure_model").map(text) {
        None | Some("default" | "0") => Some(Volumetric::Logarithmic),
        Some("Abaqus" | "2") => Some(Volumetric::Quadratic),
        Some(other) => {
            let text = format!("<pressure_model> {} is not supported, only default and Abaqus", quoted(other));
            reader.error(node, text);
            None
        }
    }
}
