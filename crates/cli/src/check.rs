//! `pneuflex check`: what would be solved, without solving it.

use std::fmt::Write as _;
use std::io::{self, Write as _};

use pneuflex_model::{Case, ContactMethod, Obstacle, Problem, Shape};
use pneuflex_post::stress::material_limit;
use pneuflex_post::summary::probe_sites;

use crate::args::CaseArguments;
use crate::error::{CliError, say};
use crate::memory::{Estimate, size, thousands};
use crate::study::{Description, Study};

pub mod model;

/// Checks a case and prints what would be solved.
///
/// # Errors
/// Bad input.
pub fn check(arguments: &CaseArguments) -> Result<(), CliError> {
    let study = Study::load(&arguments.case, &arguments.set, false)?;
    for note in &study.notes {
        say(note);
    }
    // Nobody reading on is no error.
    let _ = io::stdout().write_all(describe(&study).as_bytes());
    Ok(())
}

/// The description printed by `check`.
pub fn describe(study: &Study) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = match &study.description {
        Description::Actuator(case) => write_description(&mut text, case, &study.problem),
        Description::Model(..) => model::write_description(&mut text, study),
    };
    text
}

fn write_description(text: &mut String, case: &Case, problem: &Problem) -> std::fmt::Result {
    let mesh = &problem.mesh;
    let number = |n: usize| thousands(n as u64);
    let actuator = &case.actuator;
    if !case.title.is_empty() {
        writeln!(text, "{}", case.title)?;
    }
    writeln!(
        text,
        "body      {}, {} mm x {} mm x {} mm, {} model, {:.6} mm3 of solid",
        plural(actuator.chambers, "chamber"),
        actuator.length(),
        actuator.width,
        actuator.height,
        format!("{:?}", actuator.part).to_lowercase(),
        mesh.volume()
    )?;
    let unknowns = problem.num_unknowns();
    writeln!(
        text,
        "mesh      {} nodes, {} elements {}, {} unknowns",
        number(mesh.num_nodes()),
        number(mesh.num_elements()),
        case.mesh.formulation(),
        number(unknowns)
    )?;
    let material = &case.material;
    writeln!(
        text,
        "material  {}, {} invariant: {}, bulk modulus {} MPa",
        material.law.name(),
        format!("{:?}", material.invariant).to_lowercase(),
        material.law,
        material.bulk_modulus
    )?;
    if let Some(limit) = material_limit(material) {
        writeln!(text, "          gives way where the invariant exceeds 3 by {limit:.2}")?;
    } else if material.law.reduced_polynomial().is_none() {
        writeln!(text, "          whether and where it gives way is not checked for this law")?;
    }
    for support in &problem.supports {
        let axes: String =
            ["x", "y", "z"].iter().zip(support.axes).filter(|(_, held)| *held).map(|(a, _)| *a).collect();
        writeln!(text, "support   {}: {} nodes held in {axes}", support.name, number(support.nodes.len()))?;
    }
    for (name, nodes) in &mesh.node_sets {
        writeln!(text, "nodes     {name}: {}", number(nodes.len()))?;
    }
    for (name, facets) in &mesh.facet_sets {
        writeln!(text, "faces     {name}: {}", number(facets.len()))?;
    }
    let faces: usize = problem.contact_pairs.iter().map(|p| p.slave.len()).sum();
    let (method, per_face) = match case.contact.method {
        ContactMethod::None => ("none", 0),
        ContactMethod::SinglePoint => ("single-point", 1),
        ContactMethod::MultiPoint => ("multi-point", 16),
    };
    writeln!(
        text,
        "contact   {method}, {} with {} contact points, {} N/mm3",
        plural(problem.contact_pairs.len(), "gap"),
        number(faces * per_face),
        case.contact.stiffness
    )?;
    for thing in &problem.obstacles {
        writeln!(text, "obstacle  {}", obstacle(thing))?;
    }
    let pressures: Vec<String> = case.load.pressure_kpa.iter().map(f64::to_string).collect();
    writeln!(text, "load      {} kPa on {} faces", pressures.join(", "), number(problem.cavity_facets().len()))?;
    for (name, site) in probe_sites(mesh, &case.probes) {
        let [x, y, z] = site.at;
        let far = if site.distance_mm > 1e-9 { format!(", {:.3} mm away", site.distance_mm) } else { String::new() };
        writeln!(text, "probe     {name}: node {} at ({x}, {y}, {z}){far}", site.node)?;
    }
    writeln!(text, "memory    about {}", size(Estimate::of_mesh(case, mesh.num_elements(), unknowns).bytes))
}

/// What an obstacle is.
fn obstacle(obstacle: &Obstacle) -> String {
    let shape = match &obstacle.shape {
        Shape::Plane { .. } => "plane".to_owned(),
        Shape::Sphere { radius, .. } => format!("sphere of radius {radius} mm"),
        Shape::Cylinder { radius, .. } => format!("cylinder of radius {radius} mm"),
        Shape::Cuboid { size: [x, y, z], .. } => format!("cuboid, {x} mm x {y} mm x {z} mm"),
    };
    let faces = plural(obstacle.facets.len(), "face");
    format!("{}: {shape}, {faces} may touch it, {:.4} N/mm3", obstacle.name, obstacle.stiffness)
}

/// A number of things in words.
pub fn plural(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}
