//! Whether everything is drawn that a file may say. What it may say the readers of case and model files tell themselves: asked with a key or a
//! word that is none, they list those that are. So a new key is asked for here the day it is added.

use std::collections::BTreeSet;

use pneuflex::model::Case;
use pneuflex::model::model_file::Model;
use serde::de::DeserializeOwned;

use super::draw::Draw;
use super::form::Form;

/// Keys and words that are not drawn, each with the reason.
pub const NOT_DRAWN: [(&str, &str); 26] = [
    ("model: model.size", "is for parts, which Gmsh meshes"),
    (
        "model: model.inlet",
        "drawn meshes name the walls of their holes; where chambers open is tested where they are found",
    ),
    (
        "case: obstacle.displacement",
        "is for model files, where it is drawn; in a case file it is refused as soon as it is there",
    ),
    ("case: obstacle.factor", "the same"),
    ("case: mesh.resolution = standard", "thousands of nodes; draft goes through the same code with other sizes"),
    ("case: mesh.resolution = fine", "the same"),
    ("model: mesh.resolution = standard", "the same"),
    ("model: mesh.resolution = fine", "the same"),
    ("case: material.fitted_to", "a run that goes further warns; the solution knows nothing of it"),
    ("model: material.fitted_to", "the same"),
    ("model: region.material.fitted_to", "the same"),
    ("case: material.fitted_to.uniaxial", "the same"),
    ("case: material.fitted_to.equibiaxial", "the same"),
    ("case: material.fitted_to.planar", "the same"),
    ("model: material.fitted_to.uniaxial", "the same"),
    ("model: material.fitted_to.equibiaxial", "the same"),
    ("model: material.fitted_to.planar", "the same"),
    ("model: region.material.fitted_to.uniaxial", "the same"),
    ("model: region.material.fitted_to.equibiaxial", "the same"),
    ("model: region.material.fitted_to.planar", "the same"),
    (
        "case: solver.imperfection",
        "what buckles has two shapes, mirror images of each other as a rule, and a run takes either one",
    ),
    ("model: solver.imperfection", "the same"),
    (
        "case: output.error_estimate",
        "adds numbers about a solution that is there already, and eight times the unknowns",
    ),
    ("model: output.error_estimate", "the same"),
    ("model: contact.method = none", "is refused"),
    ("model: contact.method = single-point", "the same"),
];

/// What is no key and no word.
const NONE: &str = "no-such-thing";

/// Everything that case and model files may say, as `case: table.key` and `model: table.key = word`.
pub fn all() -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    explore::<Case>("case", &mut Vec::new(), &mut found);
    explore::<Model>("model", &mut Vec::new(), &mut found);
    found
}

/// What a drawn problem says, whatever its form.
pub fn said(draw: &Draw) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let kind = match draw {
        Draw::Case(_) => "case",
        Draw::Model(_, body) => {
            // As a mesh of Gmsh it is in metres.
            if body.is_some() {
                found.insert("model: model.scale".to_owned());
            }
            "model"
        }
    };
    let text = draw.files(Form::Text).map(|files| String::from_utf8_lossy(&files[0].1).into_owned());
    if let Some(table) = text.and_then(|text| text.parse::<toml::Table>().ok()) {
        gather(kind, "", &toml::Value::Table(table), &mut found);
    }
    found
}

/// Keys whose values are choices of nodes, faces or elements, which have the same keys everywhere.
const CHOICES: [&str; 6] = ["nodes", "faces", "slave", "master", "elements", "terms"];

/// Keys of a choice that hold choices.
const INNER: [&str; 3] = ["and", "or", "not"];

/// A key by its path: of a choice, wherever it stands, as `choice: plane.point`.
fn canonical(kind: &str, path: &str) -> String {
    let mut names = path.split('.');
    let is_choice = names.by_ref().any(|name| CHOICES.contains(&name));
    let mut rest: Vec<&str> = names.collect();
    while rest.len() > 1 && INNER.contains(&rest[0]) {
        rest.remove(0);
    }
    if is_choice && !rest.is_empty() { format!("choice: {}", rest.join(".")) } else { format!("{kind}: {path}") }
}

fn gather(kind: &str, path: &str, value: &toml::Value, found: &mut BTreeSet<String>) {
    match value {
        toml::Value::Table(table) => {
            for (key, value) in table {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                found.insert(canonical(kind, &path));
                gather(kind, &path, value, found);
            }
        }
        toml::Value::Array(entries) => entries.iter().for_each(|entry| gather(kind, path, entry, found)),
        toml::Value::String(word) => {
            found.insert(format!("{kind}: {path} = {word}"));
        }
        _ => {}
    }
}

/// A key on the way to another one, and whether a list of tables stands there.
type Place = (String, bool);

fn explore<T: DeserializeOwned>(kind: &str, path: &mut Vec<Place>, found: &mut BTreeSet<String>) {
    /// Deeper than any table lies.
    const DEEPEST: usize = 5;
    // Choices in choices say what all say.
    if path.len() > DEEPEST || path.last().is_some_and(|(name, _)| INNER.contains(&name.as_str())) {
        return;
    }
    let name = path.iter().map(|place| place.0.as_str()).collect::<Vec<_>>().join(".");
    for word in expected::<T>(&written(path, &format!("{NONE:?}")), "unknown variant") {
        found.insert(format!("{kind}: {name} = {word}"));
    }
    for is_list in [false, true] {
        if let Some(last) = path.last_mut() {
            last.1 = is_list;
        } else if is_list {
            continue;
        }
        for key in expected::<T>(&written(path, &format!("{{ {NONE} = 0 }}")), "unknown field") {
            let full = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
            found.insert(canonical(kind, &full));
            path.push((key, false));
            explore::<T>(kind, path, found);
            path.pop();
        }
    }
    if let Some(last) = path.last_mut() {
        last.1 = false;
    }
}

/// A file that says nothing but a value at a place.
fn written(path: &[Place], value: &str) -> String {
    let Some(((first, is_list), rest)) = path.split_first() else { return format!("{NONE} = 0") };
    let inner = rest.iter().rev().fold(value.to_owned(), |value, (key, is_list)| {
        if *is_list && !value.starts_with('"') {
            format!("{{ {key} = [{value}] }}")
        } else {
            format!("{{ {key} = {value} }}")
        }
    });
    if *is_list { format!("{first} = [{inner}]") } else { format!("{first} = {inner}") }
}

/// What a reader says that it expects in the place of [`NONE`].
fn expected<T: DeserializeOwned>(text: &str, complaint: &str) -> Vec<String> {
    let Some(error) = toml::from_str::<T>(text).err() else { return Vec::new() };
    let message = error.message();
    match message.split_once("expected") {
        Some((before, list)) if before.contains(complaint) && before.contains(NONE) => {
            list.split('`').skip(1).step_by(2).map(str::to_owned).collect()
        }
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::draw::{Dice, Scale};
    use super::*;

    /// A key or word of a file is drawn, or it is said why not.
    #[test]
    fn everything_is_drawn_that_a_file_may_say() {
        let all = all();
        for known in [
            "case: actuator.channel.bottom",
            "case: contact.method = single-point",
            "case: solver.first_step_kpa",
            "model: region.material.law = ogden",
            "model: obstacle.shape = cuboid",
            "model: cavity.gas",
            "model: mesh.element = hex20",
            "model: solver.first_step",
            "choice: plane.normal",
            "choice: and",
        ] {
            assert!(all.contains(known), "{known} is not among {all:?}");
        }
        let mut said = BTreeSet::new();
        (0..700).for_each(|number| said.extend(self::said(&Draw::new(&mut Dice::of(1, number), Scale::Small))));
        let left_out: BTreeSet<String> = NOT_DRAWN.iter().map(|(key, _)| (*key).to_owned()).collect();
        let missing: Vec<&String> = all.iter().filter(|key| !said.contains(*key) && !left_out.contains(*key)).collect();
        assert!(missing.is_empty(), "neither drawn (draw.rs) nor said why not (NOT_DRAWN): {missing:#?}");
        let wrong: Vec<&String> = left_out.iter().filter(|key| !all.contains(*key) || said.contains(*key)).collect();
        assert!(wrong.is_empty(), "drawn after all, or no key: {wrong:?}");
    }
}
