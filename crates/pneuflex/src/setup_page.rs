//! The page that shows what would be solved: cavities, supports, loads, contact, obstacles' surfaces, regions, choices by place.

use std::collections::BTreeSet;
use std::sync::Arc;

use pneuflex_mesh::Facet;
use pneuflex_model::load::Load;
use pneuflex_model::{Chooser, LoadParameter, Obstacle, Problem};
use pneuflex_plot::picture::obstacle_surface;
use pneuflex_report::setup::{Part, Setup, render};

use crate::analysis::{Analysis, Description};
use crate::error::Error;
use crate::input_error::InputError;

/// The page as the text of an HTML file.
///
/// # Errors
/// A page that cannot be written as text.
pub fn setup_page(analysis: &Analysis) -> Result<String, Error> {
    let problem = &analysis.problem;
    let about = match &analysis.description {
        Description::Model(_, files) => files.name.clone(),
        Description::Actuator(_) | Description::Body(_) => String::new(),
    };
    let mut parts = parts(problem);
    let is_new = |facets: &Vec<Facet>| !problem.cavities.iter().any(|cavity| cavity.facets == *facets);
    let hollows = analysis.hollows.iter().filter(|(_, hollow)| is_new(&hollow.facets));
    parts.extend(hollows.map(|(name, hollow)| Part {
        kind: "hollow",
        name: name.clone(),
        facets: hollow.facets.clone(),
        ..Part::default()
    }));
    parts.extend(choices(analysis));
    parts.extend(obstacles(problem));
    let setup = Setup { title: &analysis.title, about: &about, mesh: &problem.mesh, parts };
    Ok(render(&setup).map_err(|e| InputError::about_file(&analysis.path, e))?)
}

fn parts(problem: &Problem) -> Vec<Part> {
    let mut parts = Vec::new();
    let mut add = |kind, name: &str, facets: &[Facet], nodes: Vec<u32>| {
        parts.push(Part { kind, name: name.to_owned(), facets: facets.to_vec(), nodes, ..Part::default() });
    };
    for cavity in &problem.cavities {
        add("cavity", &cavity.name, &cavity.facets, Vec::new());
    }
    for support in &problem.supports {
        let axes: String = "xyz".chars().zip(support.axes).filter(|(_, held)| *held).map(|(axis, _)| axis).collect();
        let moved = if support.motion.is_some() { ", moved" } else { "" };
        add("support", &format!("{} held in {axes}{moved}", support.name), &[], support.nodes.clone());
    }
    for load in &problem.loads {
        match load {
            Load::Pressure { facets, .. } => add("pressure", "", facets, Vec::new()),
            Load::Traction { facets, .. } => add("traction", "", facets, Vec::new()),
            Load::Force { nodes, .. } => add("force", "", &[], nodes.iter().map(|(node, _)| *node).collect()),
            Load::Gravity { .. } => {}
        }
    }
    for pair in &problem.contact_pairs {
        add("contact", &format!("{}: slave", pair.name), &pair.slave, Vec::new());
        if !pair.is_self() {
            add("contact", &format!("{}: master", pair.name), &pair.master, Vec::new());
        }
    }
    for obstacle in &problem.obstacles {
        add("obstacle", &format!("may touch {}", obstacle.name), &obstacle.facets, Vec::new());
    }
    let slaves: BTreeSet<u32> = problem.equations.iter().filter_map(|e| e.terms.first()).map(|term| term.0).collect();
    if !slaves.is_empty() {
        add("equations", "nodes that follow others", &[], slaves.into_iter().collect());
    }
    if !problem.distances.is_empty() {
        let nodes: BTreeSet<u32> = problem.distances.iter().flatten().copied().collect();
        add("rigid", "nodes that keep their distances", &[], nodes.into_iter().collect());
    }
    let boundary = problem.mesh.boundary_facets();
    for region in &problem.regions {
        let elements: BTreeSet<u32> = region.elements.iter().copied().collect();
        let facets: Vec<Facet> = boundary.iter().copied().filter(|facet| elements.contains(&facet.element)).collect();
        add("region", &region.name, &facets, Vec::new());
    }
    parts
}

/// The obstacles where they begin; of what stands beside a plane of symmetry the one on the side of the part.
fn obstacles(problem: &Problem) -> Vec<Part> {
    let part = |obstacle: &Obstacle| {
        let surface = obstacle_surface(obstacle, LoadParameter(0.0), &problem.mesh.nodes);
        let corners = |triangle: &[u32; 3]| triangle.map(|corner| surface.corners[corner as usize][0]);
        let triangles: Vec<[[f64; 3]; 3]> = surface.triangles.iter().map(corners).collect();
        (!triangles.is_empty()).then(|| Part {
            kind: "obstacle",
            name: obstacle.name.clone(),
            triangles,
            ..Part::default()
        })
    };
    problem.obstacles.iter().filter_map(part).collect()
}

/// What the choices by place of a model file hold.
fn choices(analysis: &Analysis) -> Vec<Part> {
    let (Some(model), Description::Model(..)) = (analysis.description.model(), &analysis.description) else {
        return Vec::new();
    };
    let chooser = Chooser::new(Arc::clone(&analysis.problem.mesh));
    let by_place = model.choices().into_iter().filter(|(_, _, choice)| choice.name().is_none());
    let part = |(key, asked, choice)| {
        let holds = chooser.holds(choice, asked).ok()?;
        Some(Part {
            kind: "choice",
            name: format!("{key} {choice}"),
            facets: holds.facets,
            nodes: holds.nodes,
            ..Part::default()
        })
    };
    by_place.filter_map(part).collect()
}
