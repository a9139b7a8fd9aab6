//! The meaning of an Abaqus or CalculiX deck → a problem with a schedule.
//!
//! What cannot be solved is refused by keyword, file and line, all at once; what is solved in another way than the deck may mean it, or
//! left out because it does not change what is solved, is told in notes.
//!
//! Time runs from 0 through the steps one after the other, each lasting the period of its `*STATIC` (1 by default). Loads and
//! displacements without amplitude change linearly over the step that names them.

mod body;
mod boundary;
mod cavities;
mod constants;
mod constraints;
mod contact;
mod context;
mod element_types;
mod histories;
mod language;
mod loads;
mod materials;
mod outline;
mod placement;
mod references;
mod rigid;
mod schedule;
mod sets;

use pneuflex_mesh::{Facet, Mesh};
use pneuflex_model::{Clock, Formulation, Problem, Region};

use crate::deck::{Deck, Extent, Label, Schedule, mean_size};
use crate::mid_edges::MidEdges;
use crate::report::{DeckError, Place, Report};
use crate::syntax::{Block, Include, Sources, parse_into};
use body::Body;
use constraints::Constraints;
use context::Context;
use loads::Loads;
use materials::Materials;
use outline::Outline;
use schedule::Times;
use sets::AllSets;

/// A hard contact's penalty: this many times the slave's Young's modulus over the size of its faces, as Abaqus does by default.
const HARD_CONTACT: f64 = 10.0;

/// Reads a deck called `name` from its bytes. `include` finds the files that it includes.
///
/// # Errors
/// Everything that is wrong or cannot be solved, by file and line.
pub fn read(name: &str, text: Vec<u8>, include: &mut Include<'_>, extent: Extent) -> Result<Deck, Vec<DeckError>> {
    let mut report = Report::default();
    let (sources, blocks) = parse_into(name, text, include, &mut report);
    // A deck with lines that were not understood would be full of errors that follow from them.
    let parts = if report.has_errors() { None } else { understand(&sources, &blocks, extent, &mut report) };
    let notes = report.finish(&sources.names)?;
    match parts {
        Some(parts) => Ok(Deck { notes, ..parts }),
        None => Err(vec![DeckError { file: name.to_owned(), line: 1, text: "the deck holds no problem".to_owned() }]),
    }
}

fn understand(sources: &Sources, blocks: &[Block], extent: Extent, report: &mut Report) -> Option<Deck> {
    let mut context = Context { sources, report };
    let context = &mut context;
    let mut outline = Outline::new(blocks, context);
    let body = Body::read(&mut outline, context)?;
    let outline = outline;
    let sets = AllSets::read(&outline, &body, context);
    let materials = Materials::read(&outline, &body, &sets, extent, context);
    let times = Times::read(&outline, context);
    if outline.steps.is_empty() && extent == Extent::Problem {
        context.error(blocks.last().map_or(Place { file: 0, line: 1 }, |b| b.place), "the deck has no *STEP");
    }
    let mid_edges = body.first_added().map(|first| MidEdges::new(&body.mesh, first));
    let mut constraints = Constraints::read(&outline, &body, &sets, mid_edges.as_ref(), context);
    let known = boundary::Known { body: &body, sets: &sets, times: &times, turning: &constraints.turning() };
    let mut held = boundary::read_supports(&outline, known, context);
    let mut equations = boundary::read_equations(&outline, &body, &sets, &held, context);
    constraints.bind(&body, &mut held, context);
    equations.append(&mut constraints.equations);
    let loads = Loads::read(&outline, &body, &sets, &times, context);
    let cavities = cavities::read(&outline, &body, &sets, &times, context);
    let idle = constraints.idle(&body, &held, &equations, &loads.forces(), context);
    let hard = |facets: &[Facet]| hard_stiffness(&body, &materials, facets);
    let (contact, contact_pairs) = contact::read_contact(&outline, &body, &sets, hard, context);
    check_densities(&materials, &loads, context);
    check_initial_conditions(&outline, context);
    let mut regions = regions(&materials, context)?.into_iter();
    if context.report.has_errors() {
        return None;
    }
    let mut problem = Problem::body(
        mesh(&body, &sets, mid_edges.as_ref()),
        Formulation::of_mesh(&body.mesh)?,
        regions.next().map(|region| region.material).unwrap_or_default(),
    );
    problem.clock = Clock::Steps;
    problem.regions = regions.collect();
    problem.supports = boundary::supports(&held, &times, mid_edges.as_ref());
    problem.supports.extend(idle);
    problem.equations = equations;
    problem.cavities = cavities;
    problem.distances = constraints.distances;
    problem.ties = constraints.ties;
    problem.loads = loads.for_solver(&times);
    problem.contact = contact;
    problem.contact_pairs = contact_pairs;
    let label = |&(scope, number): &body::Number| Label { instance: body.scopes[scope as usize].name.clone(), number };
    let mut node_labels: Vec<Option<Label>> = body.node_numbers.iter().map(|number| Some(label(number))).collect();
    node_labels.resize(problem.mesh.num_nodes(), None);
    Some(Deck {
        title: title(&outline, sources),
        schedule: Schedule {
            times: times.requested(),
            first_increment: times.steps.first().map_or(1.0, |step| step.first),
        },
        notes: Vec::new(),
        node_labels,
        element_labels: body.element_numbers.iter().map(label).collect(),
        problem,
    })
}

fn title(outline: &Outline<'_>, sources: &Sources) -> String {
    let first = outline.of("HEADING").find_map(|item| item.block.lines.first());
    first.map(|line| sources.text(line).to_owned()).unwrap_or_default()
}

/// One region per material, in the order of the sections; the first is to be the problem's own material.
fn regions(materials: &Materials, context: &mut Context<'_>) -> Option<Vec<Region>> {
    let mut found: Vec<(usize, Region)> = Vec::new();
    for section in &materials.sections {
        if let Some((_, region)) = found.iter_mut().find(|(material, _)| *material == section.material) {
            region.elements.extend(&section.elements);
            region.elements.sort_unstable();
            continue;
        }
        let named = &materials.list[section.material];
        let material = named.for_solver(section.place, context)?;
        let region = Region { name: named.name.clone(), elements: section.elements.clone(), material };
        found.push((section.material, region));
    }
    Some(found.into_iter().map(|(_, region)| region).collect())
}

fn check_densities(materials: &Materials, loads: &Loads, context: &mut Context<'_>) {
    let Some(place) = loads.gravity else { return };
    let weightless = materials.sections.iter().map(|section| &materials.list[section.material]);
    if let Some(material) = weightless.into_iter().find(|material| material.density.is_none()) {
        context.error(place, format!("gravity acts, but material {} has no *DENSITY", material.name));
    }
}

/// What a body in equilibrium that does not expand knows nothing of is left out.
fn check_initial_conditions(outline: &Outline<'_>, context: &mut Context<'_>) {
    for item in outline.of("INITIALCONDITIONS") {
        let written = &item.block.written;
        match item.block.word("TYPE").as_deref() {
            Some("TEMPERATURE" | "VELOCITY") => {
                context.note(item.block.place, format!("{written} is left out: equilibria do not depend on it"));
            }
            Some("FLUIDPRESSURE") if is_zero(item.block, context) => {}
            _ => context.error(
                item.block.place,
                format!("{written}: bodies are without stress at the beginning; only TYPE=TEMPERATURE and VELOCITY are left out"),
            ),
        }
    }
}

/// Whether the last entry of every line is 0.
fn is_zero(block: &Block, context: &Context<'_>) -> bool {
    let last = |line| context.fields(line).last().and_then(|text| crate::syntax::real(text).ok());
    block.lines.iter().all(|line| last(line) == Some(0.0))
}

/// The mesh with the deck's sets.
fn mesh(body: &Body, sets: &AllSets, mid_edges: Option<&MidEdges>) -> Mesh {
    let mut mesh = body.mesh.clone();
    for (name, set) in sets.nodes.named(body) {
        let mut nodes = set.members.clone();
        nodes.sort_unstable();
        if let Some(mid_edges) = mid_edges {
            nodes.extend(mid_edges.of(|node| set.members.binary_search(&node).is_ok()));
        }
        mesh.node_sets.insert(name, nodes);
    }
    for (name, set) in sets.surfaces.named(body) {
        mesh.facet_sets.insert(name, set.members.clone());
    }
    for (name, set) in sets.elements.named(body) {
        mesh.element_sets.insert(name, set.members.clone());
    }
    mesh
}

/// Penalty for hard contact on faces, N/mm³: from the stiffest of the materials, for the faces' mean size.
fn hard_stiffness(body: &Body, materials: &Materials, facets: &[Facet]) -> f64 {
    let mean = mean_size(&body.mesh, facets);
    let constants = materials.sections.iter().filter_map(|section| materials.list[section.material].constants.as_ref());
    let shear_modulus = constants.map(|constants| constants.law.shear_modulus()).fold(0.0, f64::max);
    if mean > 0.0 && shear_modulus > 0.0 { HARD_CONTACT * 3.0 * shear_modulus / mean } else { 1.0 }
}
