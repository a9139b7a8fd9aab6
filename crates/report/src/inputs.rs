//! The case as tables: what every key means, and its unit.

use pneuflex_model::Case;
use serde_json::Value;

/// A group of keys, a table of the case file.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Its heading.
    pub heading: String,
    /// Its keys.
    pub rows: Vec<Row>,
}

/// A key of the case file.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Dotted name below the table's.
    pub key: String,
    /// What it is; empty for a key that is not known here.
    pub meaning: &'static str,
    /// Value as text.
    pub value: String,
    /// Unit; empty for none.
    pub unit: &'static str,
}

/// Tables with their headings, in the order of the page.
const TABLES: [(&str, &str); 7] = [
    ("actuator", "Actuator"),
    ("material", "Material"),
    ("contact", "Contact"),
    ("load", "Load"),
    ("mesh", "Mesh"),
    ("solver", "Solver"),
    ("output", "Output"),
];

/// Keys in the order of the page, their meaning and unit.
const KEYS: [(&str, &str, &str); 49] = [
    ("actuator.chambers", "number of chambers", ""),
    ("actuator.chamber_length", "outer length of one chamber", "mm"),
    ("actuator.cavity_length", "length of one cavity", "mm"),
    ("actuator.gap", "gap between neighbouring chambers", "mm"),
    ("actuator.flange", "flange at either end", "mm"),
    ("actuator.width", "whole width", "mm"),
    ("actuator.height", "whole height", "mm"),
    ("actuator.base", "thickness of the base", "mm"),
    ("actuator.cavity_floor", "height of the cavities' floor", "mm"),
    ("actuator.side_wall", "thickness of the side walls", "mm"),
    ("actuator.top_wall", "thickness of the top walls", "mm"),
    ("actuator.channel.half_width", "air channel: half width", "mm"),
    ("actuator.channel.bottom", "air channel: height of its floor", "mm"),
    ("actuator.channel.top", "air channel: height of its roof", "mm"),
    ("actuator.part", "modelled part", ""),
    ("material.law", "law", ""),
    ("material.c10", "coefficient of (I₁ − 3)", "MPa"),
    ("material.c20", "coefficient of (I₁ − 3)²", "MPa"),
    ("material.c30", "coefficient of (I₁ − 3)³", "MPa"),
    ("material.c01", "coefficient of (I₂ − 3)", "MPa"),
    ("material.c11", "coefficient of (I₁ − 3) (I₂ − 3)", "MPa"),
    ("material.c02", "coefficient of (I₂ − 3)²", "MPa"),
    ("material.mu", "shares of the shear modulus at rest", "MPa"),
    ("material.alpha", "exponents of the principal stretches", ""),
    ("material.bulk_modulus", "bulk modulus", "MPa"),
    ("material.invariant", "first invariant in the energy", ""),
    ("material.volumetric", "energy of a change of volume", ""),
    ("material.density", "density", "g/cm³"),
    ("contact.method", "where contact is looked for", ""),
    ("contact.stiffness", "penalty stiffness", "N/mm³"),
    ("contact.two_pass", "both walls are the slave in turn", ""),
    ("contact.self_contact", "outer surface against itself", ""),
    ("contact.penetration_tolerance", "largest depth of a contact point", "mm"),
    ("load.pressure_kpa", "pressures", "kPa"),
    ("mesh.resolution", "resolution", ""),
    ("mesh.element", "element", ""),
    ("mesh.size", "largest element edge along x, y, z", "mm"),
    ("mesh.edge_size", "element edge at re-entrant edges", "mm"),
    ("mesh.wall_elements", "least number of elements through walls", ""),
    ("solver.tolerance", "norm of the last correction", "mm, N"),
    ("solver.residual_tolerance", "residual relative to the pressure forces", ""),
    ("solver.max_iterations", "iterations per load step", ""),
    ("solver.first_step_kpa", "first load step", "kPa"),
    ("solver.max_step_kpa", "largest load step", "kPa"),
    ("solver.min_step_kpa", "smallest load step", "kPa"),
    ("output.fields", "field files", ""),
    ("probe.name", "name", ""),
    ("probe.at", "reference position", "mm"),
    ("title", "title", ""),
];

/// All keys of a case in groups; keys that are not known here come last in theirs.
pub fn groups(case: &Case) -> Vec<Group> {
    let Ok(Value::Object(tables)) = serde_json::to_value(case) else { return Vec::new() };
    let place = |name: &str| TABLES.iter().position(|(table, _)| *table == name).unwrap_or(TABLES.len());
    let mut names: Vec<&String> = tables.iter().filter(|(_, table)| table.is_object()).map(|(name, _)| name).collect();
    names.sort_by_key(|name| place(name));
    let mut groups: Vec<Group> = names
        .into_iter()
        .map(|name| {
            let mut rows = Vec::new();
            collect(&tables[name], name, "", &mut rows);
            rows.sort_by_key(|(rank, _)| *rank);
            let heading = TABLES.get(place(name)).map_or(name.as_str(), |(_, heading)| heading);
            Group { heading: heading.to_owned(), rows: rows.into_iter().map(|(_, row)| row).collect() }
        })
        .collect();
    if let Some(Value::Array(obstacles)) = tables.get("obstacle") {
        groups.push(Group { heading: "Obstacles".into(), rows: obstacles.iter().map(obstacle_row).collect() });
    }
    if !case.probes.is_empty() {
        let row = |probe: &pneuflex_model::Probe| Row {
            key: probe.name.clone(),
            meaning: "displacement of the node nearest to",
            value: probe.at.map(|x| x.to_string()).join(", "),
            unit: "mm",
        };
        groups.push(Group { heading: "Probes".into(), rows: case.probes.iter().map(row).collect() });
    }
    groups
}

/// An obstacle in one line: its keys and their values.
fn obstacle_row(obstacle: &Value) -> Row {
    let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    let keys = obstacle.as_object().into_iter().flatten().filter(|(key, _)| !["name", "shape"].contains(&key.as_str()));
    let values: Vec<String> = keys.map(|(key, value)| format!("{key} {}", text(value))).collect();
    let shape = text(&obstacle["shape"]);
    Row {
        key: text(&obstacle["name"]),
        meaning: "obstacle",
        value: format!("{shape}: {}", values.join(", ")),
        unit: "",
    }
}

fn collect(value: &Value, path: &str, key: &str, rows: &mut Vec<(usize, Row)>) {
    if let Value::Object(fields) = value {
        for (name, value) in fields {
            let key = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
            collect(value, &format!("{path}.{name}"), &key, rows);
        }
        return;
    }
    let rank = KEYS.iter().position(|(known, _, _)| *known == path).unwrap_or(KEYS.len());
    let (_, meaning, unit) = KEYS.get(rank).copied().unwrap_or_default();
    if !value.is_null() {
        rows.push((rank, Row { key: key.to_owned(), meaning, value: plain(value), unit }));
    }
}

/// A value as somebody would write it.
fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Bool(yes) => if *yes { "yes" } else { "no" }.to_owned(),
        Value::Array(entries) => entries.iter().map(plain).collect::<Vec<_>>().join(", "),
        // Shorter than the JSON text of a number: 5 instead of 5.0.
        Value::Number(number) => number.as_f64().map_or_else(|| number.to_string(), short),
        other => other.to_string(),
    }
}

fn short(x: f64) -> String {
    if x != 0.0 && (x.abs() < 1e-3 || x.abs() >= 1e6) { format!("{x:e}") } else { x.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_mesh::Actuator;

    #[test]
    fn every_key_of_a_case_is_known_and_shown_once() {
        let actuator = Actuator { cavity_floor: Some(4.0), ..Actuator::two_chambers() };
        let case: Case = serde_json::from_value(serde_json::json!({
            "title": "t", "actuator": serde_json::to_value(&actuator).unwrap(), "load": {"pressure_kpa": [5, 7.5]},
            "probe": [{"name": "tip", "at": [18, 0, 0]}]
        }))
        .unwrap();
        let mesh = case.mesh.resolved(&actuator);
        let groups = groups(&Case { mesh, ..case });
        let row = |heading: &str, key: &str| {
            groups.iter().find(|g| g.heading == heading).unwrap().rows.iter().find(|r| r.key == key).unwrap()
        };
        assert_eq!((row("Load", "pressure_kpa").value.as_str(), row("Load", "pressure_kpa").unit), ("5, 7.5", "kPa"));
        assert_eq!(row("Actuator", "channel.half_width").unit, "mm");
        assert_eq!(row("Solver", "tolerance").value, "1e-6");
        assert_eq!(row("Probes", "tip").value, "18, 0, 0");
        for row in groups.iter().flat_map(|g| &g.rows) {
            assert!(!row.meaning.is_empty(), "{} has no meaning", row.key);
        }
        assert_eq!(groups[0].rows[0].key, "chambers");
    }
}
