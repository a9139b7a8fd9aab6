//! A case or a model file as tables: what every key means, and its unit.

use serde::Serialize;
use serde_json::Value;

/// A group of keys, a table of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Its heading.
    pub heading: String,
    /// Its keys.
    pub rows: Vec<Row>,
}

/// A key of the file.
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
const TABLES: &[(&str, &str)] = &[
    ("model", "Body"),
    ("actuator", "Actuator"),
    ("material", "Material"),
    ("region", "Region"),
    ("support", "Support"),
    ("equation", "Equation"),
    ("cavity", "Cavity"),
    ("force", "Force"),
    ("traction", "Traction"),
    ("pressure", "Pressure"),
    ("gravity", "Gravity"),
    ("contact", "Contact"),
    ("obstacle", "Obstacle"),
    ("load", "Load"),
    ("mesh", "Mesh"),
    ("solver", "Solver"),
    ("output", "Output"),
];

/// Table of the points whose displacement is reported: one row each.
const PROBES: &str = "probe";

/// Keys in the order of the page, their meaning and unit.
const KEYS: &[(&str, &str, &str)] = &[
    ("model.file", "deck or mesh, as copied into the result folder", ""),
    ("model.scale", "millimetres per unit of length", ""),
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
    ("material.shear_modulus", "shear modulus at rest", "MPa"),
    ("material.jm", "I₁ − 3 at which it locks", ""),
    ("material.bulk_modulus", "bulk modulus", "MPa"),
    ("material.invariant", "first invariant in the energy", ""),
    ("material.volumetric", "energy of a change of volume", ""),
    ("material.density", "density", "g/cm³"),
    ("material.fitted_to", "largest stretch of the uniaxial test behind the constants", ""),
    ("material.fitted_to.uniaxial", "largest stretch of the uniaxial test behind the constants", ""),
    ("material.fitted_to.equibiaxial", "largest stretch of the equibiaxial test behind the constants", ""),
    ("material.fitted_to.planar", "largest stretch of the planar test behind the constants", ""),
    ("region.name", "name", ""),
    ("region.elements", "which elements", ""),
    ("region.box", "two corners of a box around the elements' centres", "mm"),
    ("support.nodes", "which nodes", ""),
    ("support.axes", "held axes", ""),
    ("support.displacement", "displacement where the factor is 1", "mm"),
    ("support.factor", "factor at the end, or by time", ""),
    ("support.symmetry", "plane of symmetry", ""),
    ("equation.terms", "nodes, axis, coefficient of each term", ""),
    ("equation.value", "right-hand side at the end, or by time", "mm"),
    ("cavity.name", "name", ""),
    ("cavity.faces", "its walls", ""),
    ("cavity.pressure_kpa", "pressure at the end, or by time", "kPa"),
    ("cavity.volume_mm3", "volume pumped in by the end, or by time", "mm³"),
    ("cavity.gas", "gas relative to what fills it at rest, at the end or by time", ""),
    ("cavity.atmosphere_kpa", "absolute pressure of the atmosphere", "kPa"),
    ("cavity.exponent", "polytropic exponent", ""),
    ("force.nodes", "which nodes", ""),
    ("force.total", "force in all", "N"),
    ("force.factor", "factor at the end, or by time", ""),
    ("traction.faces", "which faces", ""),
    ("traction.traction_mpa", "force per area at rest", "MPa"),
    ("traction.factor", "factor at the end, or by time", ""),
    ("pressure.faces", "which faces", ""),
    ("pressure.pressure_kpa", "pressure at the end, or by time", "kPa"),
    ("gravity.acceleration", "acceleration", "mm/s²"),
    ("gravity.factor", "factor at the end, or by time", ""),
    ("contact.slave", "surface that carries the contact points", ""),
    ("contact.master", "surface they are projected onto", ""),
    ("contact.method", "where contact is looked for", ""),
    ("contact.stiffness", "penalty stiffness", "N/mm³"),
    ("contact.two_pass", "both surfaces are the slave in turn", ""),
    ("contact.self_contact", "outer surface against itself", ""),
    ("contact.penetration_tolerance", "largest depth of a contact point", "mm"),
    ("obstacle.name", "name", ""),
    ("obstacle.shape", "shape", ""),
    ("obstacle.faces", "surface that may touch it", ""),
    ("obstacle.point", "a point of the plane or of the axis", "mm"),
    ("obstacle.normal", "normal towards the body", ""),
    ("obstacle.centre", "centre", "mm"),
    ("obstacle.axis", "direction of the axis", ""),
    ("obstacle.radius", "radius", "mm"),
    ("obstacle.hollow", "body inside of it", ""),
    ("obstacle.size", "lengths along x, y, z", "mm"),
    ("obstacle.edge_radius", "radius of the edges", "mm"),
    ("obstacle.stiffness", "penalty stiffness", "N/mm³"),
    ("obstacle.displacement", "displacement where the factor is 1", "mm"),
    ("obstacle.factor", "factor at the end, or by time", ""),
    ("obstacle.report_force", "force on it in the results", ""),
    ("load.pressure_kpa", "pressures", "kPa"),
    ("load.chamber_factor", "pressures in the chambers over these", ""),
    ("load.times", "times of the results", ""),
    ("mesh.resolution", "resolution", ""),
    ("mesh.element", "element", ""),
    ("mesh.size", "largest element edge along x, y, z", "mm"),
    ("mesh.edge_size", "element edge at re-entrant edges", "mm"),
    ("mesh.wall_elements", "least number of elements through walls", ""),
    ("solver.tolerance", "norm of the last correction, lengths in the nodes' spacing", ""),
    ("solver.residual_tolerance", "residual relative to the pressure forces", ""),
    ("solver.max_iterations", "iterations per load step", ""),
    ("solver.first_step_kpa", "first load step", "kPa"),
    ("solver.max_step_kpa", "largest load step", "kPa"),
    ("solver.min_step_kpa", "smallest load step", "kPa"),
    ("solver.first_step", "first load step, in time", ""),
    ("solver.max_step", "largest load step, in time", ""),
    ("solver.min_step", "smallest load step, in time", ""),
    ("solver.continuation", "what is prescribed from step to step", ""),
    ("solver.states_past_limit", "states past the first limit point, at the most", ""),
    ("solver.imperfection", "displacement along the motion that buckles", "mm"),
    ("output.fields", "field files", ""),
    ("output.points", "stresses at integration points", ""),
    ("output.error_estimate", "errors by a mesh of divided elements", ""),
];

/// All keys of a case or a model in groups, in the order of the page; what is not known here comes last. Tables of which there
/// may be several are numbered if there are.
pub fn groups(file: &impl Serialize) -> Vec<Group> {
    let Ok(Value::Object(tables)) = serde_json::to_value(file) else { return Vec::new() };
    let place = |name: &str| TABLES.iter().position(|(table, _)| *table == name).unwrap_or(TABLES.len());
    let mut names: Vec<&String> = tables.keys().filter(|name| *name != PROBES).collect();
    names.sort_by_key(|name| place(name));
    let mut groups = Vec::new();
    for name in names {
        let heading = TABLES.get(place(name)).map_or(name.as_str(), |(_, heading)| heading);
        match &tables[name] {
            table @ Value::Object(_) => groups.push(group(heading.to_owned(), name, table)),
            Value::Array(entries) => {
                let number = |i: usize| if entries.len() > 1 { format!(" {}", i + 1) } else { String::new() };
                let all = entries.iter().enumerate();
                groups.extend(all.map(|(i, table)| group(format!("{heading}{}", number(i)), name, table)));
            }
            _ => {}
        }
    }
    if let Some(Value::Array(probes)) = tables.get(PROBES).filter(|probes| probes.get(0).is_some()) {
        let row = |probe: &Value| Row {
            key: plain(&probe["name"]),
            meaning: "displacement of the node nearest to",
            value: plain(&probe["at"]),
            unit: "mm",
        };
        groups.push(Group { heading: "Probes".into(), rows: probes.iter().map(row).collect() });
    }
    groups
}

fn group(heading: String, name: &str, table: &Value) -> Group {
    let mut rows = Vec::new();
    collect(table, name, "", &mut rows);
    rows.sort_by_key(|(rank, _)| *rank);
    Group { heading, rows: rows.into_iter().map(|(_, row)| row).collect() }
}

fn collect(value: &Value, path: &str, key: &str, rows: &mut Vec<(usize, Row)>) {
    if let Value::Object(fields) = value {
        for (name, value) in fields {
            let key = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
            collect(value, &format!("{path}.{name}"), &key, rows);
        }
        return;
    }
    // A region's material is described like any other.
    let known_as = path.strip_prefix("region.").filter(|inner| inner.contains('.')).unwrap_or(path);
    let rank = KEYS.iter().position(|(known, _, _)| *known == known_as).unwrap_or(KEYS.len());
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
        Value::Array(entries) => {
            let inner = |entry: &Value| if entry.is_array() { format!("({})", plain(entry)) } else { plain(entry) };
            entries.iter().map(inner).collect::<Vec<_>>().join(", ")
        }
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
    use pneuflex_model::Case;
    use pneuflex_model::model_file::Model;

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

    #[test]
    fn every_key_of_a_model_is_known_and_tables_are_numbered() {
        let material = serde_json::json!({"law": "neo-hooke", "c10": 0.1, "bulk_modulus": 100.0});
        let locking = serde_json::json!({"law": "gent", "shear_modulus": 0.1, "jm": 9.0,
                                         "fitted_to": {"uniaxial": 3.0, "equibiaxial": 2.0, "planar": 2.5}});
        let model: Model = serde_json::from_value(serde_json::json!({
            "title": "t", "model": {"file": "input/a.msh", "scale": 25.4}, "material": material,
            "region": [{"name": "base", "elements": "B", "material": locking},
                       {"name": "tip", "box": [[0, 0, 0], [1, 1, 1]], "material": material}],
            "support": [{"nodes": "WALL", "axes": "xz", "displacement": [1, 0, 2], "factor": [[0, 0], [1, 2.5]]}],
            "equation": [{"terms": [["A", "x", 1], ["B", "y", -1]], "value": 0.5}],
            "cavity": [{"name": "air", "faces": "C", "pressure_kpa": 5, "atmosphere_kpa": 90, "exponent": 1.4},
                       {"name": "gas", "faces": "D", "gas": 2}, {"name": "oil", "faces": "E", "volume_mm3": 7}],
            "force": [{"nodes": "N", "total": [1, 0, 0], "factor": 2}],
            "traction": [{"faces": "F", "traction_mpa": [0, 0, 1], "factor": 2}],
            "pressure": [{"faces": "F", "pressure_kpa": 3}],
            "gravity": {"acceleration": [0, 0, -9810], "factor": 1},
            "contact": [{"slave": "S", "master": "M", "stiffness": 4, "two_pass": true}],
            "obstacle": [{"name": "table", "shape": "plane", "faces": "F", "point": [0, 0, -1], "normal": [0, 0, 1]},
                         {"name": "ram", "shape": "cuboid", "centre": [0, 0, 9], "size": [1, 1, 1], "edge_radius": 0.1,
                          "displacement": [0, 0, -2], "factor": 1},
                         {"name": "tube", "shape": "cylinder", "point": [0, 0, 0], "axis": [1, 0, 0], "radius": 5, "hollow": true,
                          "stiffness": 3}],
            "load": {"times": [1, 2]}, "probe": [{"name": "tip", "at": [18, 0, 0]}],
            "solver": {"tolerance": 1e-6, "residual_tolerance": 1e-6, "max_iterations": 9, "first_step": 0.1, "max_step": 1,
                       "min_step": 0.01, "continuation": "arc-length", "states_past_limit": 7, "imperfection": 0.1}
        }))
        .unwrap();
        let groups = groups(&model);
        for (group, row) in groups.iter().flat_map(|group| group.rows.iter().map(move |row| (group, row))) {
            assert!(!row.meaning.is_empty(), "{}: {} has no meaning", group.heading, row.key);
        }
        let headings: Vec<&str> = groups.iter().map(|group| group.heading.as_str()).collect();
        assert_eq!(headings[..5], ["Body", "Material", "Region 1", "Region 2", "Support"]);
        let factor = groups[4].rows.iter().find(|row| row.key == "factor").unwrap();
        assert_eq!(factor.value, "(0, 0), (1, 2.5)");
        let material = groups[3].rows.iter().find(|row| row.key == "material.c10").unwrap();
        assert_eq!((material.value.as_str(), material.unit), ("0.1", "MPa"));
    }
}
