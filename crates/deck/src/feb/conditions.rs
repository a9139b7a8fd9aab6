//! `<Boundary>`, `<Loads>` and `<Contact>`.

use std::collections::BTreeMap;

use pneuflex_model::load::{Load, Motion};
use pneuflex_model::{ContactPair, Curve, Problem, Support, Tie};

use super::mesh::{Body, side};
use super::xml::{Node, Reader, child, elements, text};
use crate::deck::mean_size;
use crate::report::quoted;

/// Axes by name.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Depth in a contact that is augmented without a `<gaptol>`, relative to the size of its faces.
const DEPTH: f64 = 0.01;

/// Adds what a `<Boundary>` holds and moves.
pub(super) fn read_boundary(section: Node<'_, '_>, body: &Body, problem: &mut Problem, reader: &mut Reader<'_>) {
    reader.only(section, &["bc"]);
    // Of every held component, how it moves.
    let mut moved: BTreeMap<(u32, usize), Option<Curve>> = BTreeMap::new();
    for support in &problem.supports {
        let curve = support.motion.as_ref().map(|motion| motion.curve.clone());
        let held = (0..3).filter(|&axis| support.axes[axis]);
        moved.extend(
            held.flat_map(|axis| support.nodes.iter().map(move |&node| (node, axis))).map(|dof| (dof, curve.clone())),
        );
    }
    for node in elements(section) {
        let Some(kind) = reader.required(node, "type") else { continue };
        let Some((axes, curve)) = held(node, kind, reader) else { continue };
        let Some(nodes) = body.nodes_of(node, reader) else { continue };
        let name = node.attribute("name").or(node.attribute("node_set")).unwrap_or_default();
        for axis in (0..3).filter(|&axis| axes[axis]) {
            let mut free = Vec::new();
            for &held in &nodes {
                match moved.get(&(held, axis)) {
                    None => free.push(held),
                    Some(known) if *known == curve => {}
                    Some(_) => {
                        let text = format!("some node is held along {} in another way already", AXES[axis]);
                        reader.error(node, text);
                        break;
                    }
                }
            }
            moved.extend(free.iter().map(|&node| ((node, axis), curve.clone())));
            if free.is_empty() {
                continue;
            }
            let motion = curve.clone().map(|curve| Motion { displacement: [1.0; 3], curve });
            let of_axis = std::array::from_fn(|i| i == axis);
            // What is held alike along several axes is one support.
            match problem.supports.iter_mut().find(|one| one.name == name && one.nodes == free && one.motion == motion)
            {
                Some(support) => support.axes[axis] = true,
                None => problem.supports.push(Support { name: name.to_owned(), nodes: free, axes: of_axis, motion }),
            }
        }
    }
}

/// Held axes, and how they move.
fn held(node: Node<'_, '_>, kind: &str, reader: &mut Reader<'_>) -> Option<([bool; 3], Option<Curve>)> {
    let axis = |name: &str| AXES.iter().position(|axis| *axis == name);
    match kind {
        "zero displacement" => {
            reader.only(node, &["x_dof", "y_dof", "z_dof"]);
            Some((["x_dof", "y_dof", "z_dof"].map(|name| reader.flag(node, name, false)), None))
        }
        // Version 3.
        "fix" => {
            reader.only(node, &["dofs"]);
            let list = text(reader.required_child(node, "dofs")?);
            let mut axes = [false; 3];
            for name in list.split(',').map(str::trim) {
                match axis(name) {
                    Some(axis) => axes[axis] = true,
                    None => reader.note(node, format!("{} is no displacement of a solid: left out", quoted(name))),
                }
            }
            Some((axes, None))
        }
        "prescribed displacement" | "prescribe" => {
            reader.only(node, &["dof", "value", "scale", "relative"]);
            if reader.flag(node, "relative", false) {
                reader.error(node, "a displacement relative to that of a step before is not supported");
            }
            let dof = reader.required_child(node, "dof")?;
            let Some(axis) = axis(text(dof)) else {
                reader.error(dof, format!("<dof> is {}, not x, y or z", quoted(text(dof))));
                return None;
            };
            let value = child(node, "value").or_else(|| child(node, "scale"));
            let value = value.or_else(|| reader.required_child(node, "value"))?;
            Some((
                std::array::from_fn(|i| i == axis),
                Some(reader.history(value)?).filter(|curve| *curve != Curve::ZERO),
            ))
        }
        _ => {
            let text = format!(
                "boundary condition {} is not supported, only zero displacement and prescribed displacement",
                quoted(kind)
            );
            reader.error(node, text);
            None
        }
    }
}

/// Adds the loads of a `<Loads>`.
pub(super) fn read_loads(section: Node<'_, '_>, body: &Body, problem: &mut Problem, reader: &mut Reader<'_>) {
    reader.only(section, &["surface_load", "nodal_load", "body_load"]);
    for node in elements(section) {
        let Some(kind) = reader.required(node, "type") else { continue };
        match (node.tag_name().name(), kind) {
            ("surface_load", "pressure") => problem.loads.extend(pressure(node, body, reader)),
            ("surface_load", "traction") => problem.loads.extend(traction(node, body, reader)),
            ("nodal_load", "nodal_load" | "nodal_force") => forces(node, kind, body, problem, reader),
            ("body_load", _) => {
                let text =
                    "body loads are not supported; `[[load]]` with `gravity` in a model file around this one is weight";
                reader.error(node, text);
            }
            (tag, _) => {
                let text = format!(
                    "<{tag}> of type {} is not supported, only pressure, traction, nodal_load and nodal_force",
                    quoted(kind)
                );
                reader.error(node, text);
            }
        }
    }
}

fn pressure(node: Node<'_, '_>, body: &Body, reader: &mut Reader<'_>) -> Option<Load> {
    reader.only(node, &["pressure", "linear", "symmetric_stiffness", "shell_bottom", "value"]);
    if reader.flag(node, "linear", false) {
        reader.error(node, "a pressure follows the deformed surface; <linear> must be 0");
    }
    let name = reader.required(node, "surface")?;
    let surface = body.surface_called(node, name, reader)?;
    let side = side(node, surface, reader);
    let value = reader.required_child(node, "pressure")?;
    let factor = side * reader.real(value)?;
    Some(Load::Pressure { facets: surface.facets.clone(), curve: reader.history_of(value, factor)? })
}

fn traction(node: Node<'_, '_>, body: &Body, reader: &mut Reader<'_>) -> Option<Load> {
    reader.only(node, &["traction", "scale", "linear", "shell_bottom"]);
    if !reader.flag(node, "linear", false) {
        reader.error(node, "a traction is a force per area at rest; <linear> must be 1");
    }
    let name = reader.required(node, "surface")?;
    let facets = body.surface_called(node, name, reader)?.facets.clone();
    let given = reader.required_child(node, "traction")?;
    let Ok(traction) = <[f64; 3]>::try_from(reader.reals(given)?) else {
        reader.error(given, "<traction> takes three numbers");
        return None;
    };
    let curve = match child(node, "scale") {
        Some(scale) => reader.history(scale)?,
        None => reader.history_of(given, 1.0)?,
    };
    Some(Load::Traction { facets, traction, curve })
}

/// The same force on every node of a set.
fn forces(node: Node<'_, '_>, kind: &str, body: &Body, problem: &mut Problem, reader: &mut Reader<'_>) {
    reader.only(node, &["dof", "scale", "value", "relative", "shell_bottom"]);
    if reader.flag(node, "relative", false) {
        reader.error(node, "a force relative to that of a step before is not supported");
    }
    let Some(nodes) = body.nodes_of(node, reader) else { return };
    if nodes.iter().any(|&node| body.node_tags[node as usize].is_none()) {
        let text = "the force is that on every node of the file: nodes that were added on edges carry none";
        reader.note(node, text);
    }
    let given = |node: &u32| body.node_tags[*node as usize].is_some();
    let nodes: Vec<(u32, f64)> = nodes.iter().copied().filter(given).map(|node| (node, 1.0)).collect();
    let value = child(node, "value").or_else(|| child(node, "scale"));
    let Some(value) = value.or_else(|| reader.required_child(node, "value")) else { return };
    let (force, curve) = if kind == "nodal_force" {
        let Some(Ok(force)) = reader.reals(value).map(<[f64; 3]>::try_from) else {
            return reader.error(value, "a force takes three numbers");
        };
        (force, reader.history_of(value, 1.0))
    } else {
        let Some(dof) = reader.required_child(node, "dof") else { return };
        let Some(axis) = AXES.iter().position(|axis| *axis == text(dof)) else {
            return reader.error(dof, format!("<dof> is {}, not x, y or z", quoted(text(dof))));
        };
        (std::array::from_fn(|i| f64::from(u8::from(i == axis))), reader.history(value))
    };
    if let Some(curve) = curve {
        problem.loads.push(Load::Force { nodes, force, curve });
    }
}

/// Adds the pairs of surfaces of a `<Contact>`; `young` is the stiffest Young's modulus, MPa, for penalties that are chosen by it.
pub(super) fn read_contact(
    section: Node<'_, '_>,
    body: &Body,
    young: f64,
    problem: &mut Problem,
    reader: &mut Reader<'_>,
) {
    reader.only(section, &["contact"]);
    for node in elements(section) {
        let (Some(kind), Some(pair)) = (reader.required(node, "type"), reader.required(node, "surface_pair")) else {
            continue;
        };
        let Some([primary, secondary]) = body.pairs.get(pair) else {
            reader.error(node, format!("there is no surface pair {}", quoted(pair)));
            continue;
        };
        let mut facets = |name: &str| body.surface_called(node, name, reader).map(|surface| surface.facets.clone());
        let (Some(slave), Some(master)) = (facets(primary), facets(secondary)) else { continue };
        let name = node.attribute("name").unwrap_or(pair).to_owned();
        match kind {
            "sliding-elastic" | "sliding-facet-on-facet" | "sliding-node-on-facet" => {
                let pair = ContactPair::new(name, slave, master);
                problem.contact_pairs.extend(sliding(node, pair, young, body, reader));
            }
            "tied-elastic" | "tied-facet-on-facet" | "tied-node-on-facet" => {
                reader.note(node, format!("{name}: the surfaces are glued exactly, without a penalty"));
                problem.ties.push(Tie { name, slave, master, tolerance: None });
            }
            _ => {
                let text = format!(
                    "contact {} is not supported, only sliding-elastic, sliding-facet-on-facet, sliding-node-on-facet and their tied kinds{}",
                    quoted(kind),
                    if kind.contains("rigid") { "; a rigid plane is an `[[obstacle]]` of a model file" } else { "" }
                );
                reader.error(node, text);
            }
        }
    }
}

fn sliding(
    node: Node<'_, '_>,
    mut pair: ContactPair,
    young: f64,
    body: &Body,
    reader: &mut Reader<'_>,
) -> Option<ContactPair> {
    let mut number = |name: &str, otherwise: f64| match child(node, name) {
        Some(given) => reader.real(given),
        None => Some(otherwise),
    };
    let (penalty, friction, depth) = (number("penalty", 1.0)?, number("fric_coeff", 0.0)?, number("gaptol", 0.0)?);
    if friction != 0.0 {
        reader.error(node, "contact is without friction: <fric_coeff> must be 0");
    }
    if reader.flag(node, "tension", false) {
        reader.error(node, "surfaces that stick to each other are not supported: <tension> must be 0");
    }
    if penalty <= 0.0 {
        reader.error(node, "<penalty> must be greater than 0");
    }
    let size = mean_size(&body.mesh, &pair.slave);
    let mut stiffness = penalty;
    if reader.flag(node, "auto_penalty", false) {
        if young == 0.0 {
            reader.error(node, "an automatic penalty needs the file's materials");
        }
        stiffness = penalty * young / size;
        let text = format!(
            "{}: an automatic penalty is {stiffness:.4} N/mm3: Young's modulus over the size of the faces",
            pair.name
        );
        reader.note(node, text);
    }
    pair.stiffness = Some(stiffness);
    pair.is_two_pass = reader.flag(node, "two_pass", false);
    let is_augmented = child(node, "laugon").is_some_and(|given| !["0", "PENALTY"].contains(&text(given)));
    if is_augmented {
        let tolerance = if depth > 0.0 { depth } else { DEPTH * size };
        let text = format!("{}: multipliers are found until no point is deeper than {tolerance:.4} mm", pair.name);
        reader.note(node, text);
        pair.penetration_tolerance = Some(tolerance);
    }
    Some(pair)
}
