//! What a model or a deck was understood as.

use std::fmt::{self, Write};

use pneuflex_model::load::Load;
use pneuflex_model::{Control, Curve, Material};
use pneuflex_post::summary::probe_sites;

use super::{obstacle, plural};
use crate::memory::{Estimate, size, thousands};
use crate::study::Study;

/// Writes it.
pub fn write_description(text: &mut String, study: &Study) -> fmt::Result {
    if !study.title.is_empty() {
        writeln!(text, "{}", study.title)?;
    }
    for (kind, what) in understood(study) {
        writeln!(text, "{kind:<9} {what}")?;
    }
    writeln!(text, "memory    about {}", size(Estimate::of_body(&study.problem.mesh).bytes))
}

/// What the parts of a model are, each with its kind.
pub fn understood(study: &Study) -> Vec<(&'static str, String)> {
    let Study { problem, times, .. } = study;
    let mesh = &problem.mesh;
    let number = |n: usize| thousands(n as u64);
    let mut rows = Vec::new();
    let mut row = |kind: &'static str, what: String| rows.push((kind, what));
    row(
        "body",
        format!(
            "{} nodes, {} elements {}, {} unknowns, {:.6} mm3",
            number(mesh.num_nodes()),
            number(mesh.num_elements()),
            problem.formulation,
            number(problem.num_unknowns()),
            mesh.volume()
        ),
    );
    let (_, of_element) = problem.materials();
    let plain = of_element.iter().filter(|region| **region == 0).count();
    if plain > 0 {
        row("material", material("", plain, &problem.material));
    }
    for region in &problem.regions {
        row("material", material(&format!("{}: ", region.name), region.elements.len(), &region.material));
    }
    for (kind, sets) in [
        ("nodes", mesh.node_sets.iter().map(|(name, nodes)| (name, nodes.len())).collect::<Vec<_>>()),
        ("elements", mesh.element_sets.iter().map(|(name, elements)| (name, elements.len())).collect()),
        ("faces", mesh.facet_sets.iter().map(|(name, facets)| (name, facets.len())).collect()),
    ] {
        for (name, count) in sets {
            row(kind, format!("{name}: {}", number(count)));
        }
    }
    for support in &problem.supports {
        let axes: String =
            ["x", "y", "z"].iter().zip(support.axes).filter(|(_, held)| *held).map(|(a, _)| *a).collect();
        let held = format!("{}: {} held in {axes}", support.name, plural(support.nodes.len(), "node"));
        let moved = support.motion.as_ref().map_or(String::new(), |motion| {
            format!(", moved by {:?} mm times {}", motion.displacement, curve(&motion.curve, 1.0))
        });
        row("support", held + &moved);
    }
    if !problem.equations.is_empty() {
        let terms: usize = problem.equations.iter().map(|equation| equation.terms.len()).sum();
        row("equations", format!("{} with {}", number(problem.equations.len()), plural(terms, "term")));
    }
    for cavity in &problem.cavities {
        let control = match &cavity.control {
            Control::Pressure(pressure) => format!("pressure {} kPa", curve(pressure, 1000.0)),
            Control::Volume(volume) => format!("pumped in {} mm3", curve(volume, 1.0)),
            Control::Gas(gas) => format!(
                "gas {} of what fills it at {} kPa, exponent {}",
                curve(&gas.amount, 1.0),
                1000.0 * gas.atmosphere,
                gas.exponent
            ),
        };
        row("cavity", format!("{}: {}, {control}", cavity.name, plural(cavity.facets.len(), "face")));
    }
    for load in &problem.loads {
        match load {
            Load::Force { nodes, force, curve: by } => {
                row("force", format!("{force:?} N on {} times {}", plural(nodes.len(), "node"), curve(by, 1.0)));
            }
            Load::Traction { facets, traction, curve: by } => {
                let faces = plural(facets.len(), "face");
                row("traction", format!("{traction:?} MPa on {faces} times {}", curve(by, 1.0)));
            }
            Load::Pressure { facets, curve: by } => {
                row("pressure", format!("{} kPa on {}", curve(by, 1000.0), plural(facets.len(), "face")));
            }
            Load::Gravity { elements, acceleration, curve: by } => {
                let count = elements.as_ref().map_or(mesh.num_elements(), Vec::len);
                let on = plural(count, "element");
                row("gravity", format!("{acceleration:?} mm/s2 on {on} times {}", curve(by, 1.0)));
            }
        }
    }
    for pair in &problem.contact_pairs {
        let [slave, master] = [&pair.slave, &pair.master].map(|facets| plural(facets.len(), "face"));
        row("contact", format!("{}: {slave} against {master}", pair.name));
    }
    for thing in &problem.obstacles {
        row("obstacle", obstacle(thing));
    }
    let times: Vec<String> = times.iter().map(f64::to_string).collect();
    row("times", times.join(", "));
    for (name, site) in probe_sites(mesh, &study.probes) {
        let [x, y, z] = site.at;
        let far = if site.distance_mm > 1e-9 { format!(", {:.3} mm away", site.distance_mm) } else { String::new() };
        row("probe", format!("{name}: node {} at ({x}, {y}, {z}){far}", site.node));
    }
    rows
}

fn material(name: &str, elements: usize, material: &Material) -> String {
    let density = if material.density > 0.0 { format!(", {} g/cm3", material.density) } else { String::new() };
    format!(
        "{name}{} of {}: {}, bulk modulus {} MPa{density}",
        plural(elements, "element"),
        material.law.name(),
        material.law,
        material.bulk_modulus
    )
}

/// A curve in words, its values times a factor.
fn curve(curve: &Curve, factor: f64) -> String {
    match curve {
        Curve::Proportional(slope) => format!("{} x time", factor * slope),
        Curve::Table(points) => {
            let shown = |[time, value]: &[f64; 2]| format!("{} at {time}", round(factor * value));
            match &points[..] {
                [[_, value]] => round(factor * value).to_string(),
                points if points.len() <= 6 => points.iter().map(shown).collect::<Vec<_>>().join(", "),
                points => {
                    let ends = [&points[0], &points[points.len() - 1]].map(shown);
                    format!("{} ... {} ({} points)", ends[0], ends[1], points.len())
                }
            }
        }
    }
}

/// Without the digits that a change of units leaves behind.
fn round(x: f64) -> f64 {
    format!("{x:.9e}").parse().unwrap_or(x)
}
