//! FEBio's `.feb` files of the versions 3.0 and 4.0 → a problem with a schedule (*FEBio User Manual*, chapter *Free Format Input*).
//!
//! Solid elements, hyperelastic laws that are also ours, held and prescribed displacements, pressures, tractions, forces on nodes, sliding and
//! tied contact without friction, load curves. All else is refused by name and line. The file is taken in mm, N, MPa.

mod conditions;
mod curves;
mod materials;
mod mesh;
mod xml;

use std::collections::BTreeMap;

use pneuflex_model::{Clock, Contact, ContactMethod, Formulation, Problem, Region};
use roxmltree::Document;

use crate::deck::{Deck, Extent, Label, Schedule};
use crate::report::{DeckError, Report, quoted};
use mesh::Body;
use xml::{Node, Reader, child, children, elements};

/// Sections that say nothing of what is solved.
const IDLE: [&str; 3] = ["Module", "Globals", "Output"];

/// Sections that are read, at the root or in the only step.
const OF_STEP: [&str; 4] = ["Control", "Boundary", "Loads", "Contact"];

/// Reads a `.feb` file called `name` from its bytes.
///
/// # Errors
/// Everything that is wrong or cannot be solved, by line.
pub fn read(name: &str, bytes: &[u8], extent: Extent) -> Result<Deck, Vec<DeckError>> {
    let mut report = Report::default();
    let wrong = |line: u32, text: String| vec![DeckError { file: name.to_owned(), line, text }];
    // Most files say that they are in ISO 8859-1, of which every byte is a character.
    let text =
        String::from_utf8(bytes.to_vec()).unwrap_or_else(|_| bytes.iter().map(|&byte| char::from(byte)).collect());
    let document = Document::parse(&text).map_err(|why| wrong(why.pos().row, format!("not an XML file: {why}")))?;
    let begins =
        std::iter::once(0).chain(text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(at, _)| at + 1));
    let mut reader = Reader { lines: begins.collect(), report: &mut report, curves: BTreeMap::new(), end: 0.0 };
    let deck = understand(document.root_element(), extent, &mut reader);
    let notes = report.finish(&[name.to_owned()])?;
    deck.map(|deck| Deck { notes, ..deck }).ok_or_else(|| wrong(1, "the file holds no problem".to_owned()))
}

fn understand(root: Node<'_, '_>, extent: Extent, reader: &mut Reader<'_>) -> Option<Deck> {
    let version = root.attribute("version").unwrap_or_default();
    if !root.has_tag_name("febio_spec") || !["3.0", "4.0"].contains(&version) {
        let text = format!(
            "<{}> of version {} is not supported, only <febio_spec> of 3.0 and 4.0",
            root.tag_name().name(),
            quoted(version)
        );
        reader.error(root, text);
        return None;
    }
    let known = ["Material", "Mesh", "MeshDomains", "LoadData", "Step"];
    // Programs write sections without contents, too.
    let empty =
        elements(root).filter(|section| elements(*section).next().is_none()).map(|section| section.tag_name().name());
    let known: Vec<&str> = IDLE.into_iter().chain(OF_STEP).chain(known).chain(empty).collect();
    reader.only(root, &known);
    let module = child(root, "Module").and_then(|module| module.attribute("type")).unwrap_or("solid");
    if module != "solid" {
        reader.error(child(root, "Module")?, format!("module {} is not supported, only solid", quoted(module)));
    }
    for curves in children(root, "LoadData") {
        curves::read_curves(curves, reader);
    }
    let steps: Vec<Node<'_, '_>> = children(root, "Step").flat_map(elements).collect();
    let mut schedule = Schedule { times: Vec::new(), first_increment: 1.0 };
    for place in std::iter::once(root).chain(steps.iter().copied()) {
        for control in children(place, "Control") {
            curves::read_control(control, &mut schedule, reader);
        }
    }
    if schedule.times.is_empty() && extent == Extent::Problem && !reader.report.has_errors() {
        reader.error(root, "there is no <Control>: nothing is to be solved");
    }
    for step in &steps {
        reader.only(*step, &OF_STEP);
        if let (true, Some(section)) =
            (steps.len() > 1, elements(*step).find(|section| !section.has_tag_name("Control")))
        {
            let text = format!(
                "<{}> of one of several steps is not supported: what holds and loads stands outside of the steps, with load curves",
                section.tag_name().name()
            );
            reader.error(section, text);
        }
    }
    let section = reader.required_child(root, "Mesh")?;
    let body = Body::read(section, reader)?;
    let (mut materials, mut sections) = (Vec::new(), Vec::new());
    if extent == Extent::Problem || child(root, "MeshDomains").is_some() {
        materials = materials::read_materials(reader.required_child(root, "Material")?, reader);
        let names: Vec<&str> = materials.iter().map(|(name, _)| name.as_str()).collect();
        sections = body.sections(reader.required_child(root, "MeshDomains")?, &names, reader);
    }
    if reader.report.has_errors() {
        return None;
    }
    let first = sections.first().map(|(number, _)| materials[*number].1.clone()).unwrap_or_default();
    let mut problem = Problem::body(body.mesh.clone(), Formulation::of_mesh(&body.mesh)?, first);
    problem.clock = Clock::Steps;
    problem.regions = (sections.iter().skip(1))
        .map(|(number, elements)| {
            let (name, material) = materials[*number].clone();
            Region { name, elements: elements.clone(), material }
        })
        .collect();
    let young = 3.0 * materials.iter().map(|(_, material)| material.shear_modulus()).fold(0.0, f64::max);
    for place in std::iter::once(root).chain(steps) {
        for section in elements(place) {
            match section.tag_name().name() {
                "Boundary" => conditions::read_boundary(section, &body, &mut problem, reader),
                "Loads" => conditions::read_loads(section, &body, &mut problem, reader),
                "Contact" => conditions::read_contact(section, &body, young, &mut problem, reader),
                _ => {}
            }
        }
    }
    let stiffest = problem.contact_pairs.iter().filter_map(|pair| pair.stiffness).reduce(f64::max);
    problem.contact = match stiffest {
        Some(stiffness) => Contact { stiffness, ..Contact::default() },
        None => Contact { method: ContactMethod::None, ..Contact::default() },
    };
    let label = |&tag: &u64| Label { instance: String::new(), number: tag as i32 };
    Some(Deck {
        title: String::new(),
        schedule,
        notes: Vec::new(),
        node_labels: body.node_tags.iter().map(|tag| tag.as_ref().map(label)).collect(),
        element_labels: body.element_tags.iter().map(label).collect(),
        problem,
    })
}
