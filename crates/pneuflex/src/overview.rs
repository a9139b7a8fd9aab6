//! What a problem was understood as, before it is solved.

use std::fmt;
use std::sync::Arc;

use pneuflex_mesh::Facet;
use pneuflex_mesh::vector::bounds;
use pneuflex_model::load::Load;
use pneuflex_model::{Case, Chooser, ContactMethod, Control, Curve, Material, Obstacle, Problem, Shape, SymmetryPlane};
use pneuflex_post::stress::stability_limits;
use pneuflex_post::summary::{ProbeSite, probe_sites};

use crate::analysis::{Analysis, Description};
use crate::caution::{POOR_SHAPE, centre, worst_element};
use crate::words::{measured, place, plain, plain_list, plural, rounded, size, thousands};

/// Digits of densities, which become others by a change of units and back.
const DENSITY_DIGITS: i32 = 10;

/// What would be solved, as data and as a text.
#[derive(Clone, Debug, PartialEq)]
pub struct Overview {
    /// Title.
    pub title: String,
    /// Number of nodes.
    pub nodes: usize,
    /// Number of elements.
    pub elements: usize,
    /// Number of unknown displacements.
    pub unknowns: usize,
    /// Volume of the solid, mm³.
    pub volume_mm3: f64,
    /// Peak memory that solving will need, about, bytes.
    pub memory_bytes: f64,
    /// What is there, in words.
    pub rows: Vec<OverviewRow>,
}

/// A part of what would be solved.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OverviewRow {
    /// What kind of part, e.g. `support`; empty if the row goes on about the one before.
    pub kind: &'static str,
    /// What it is.
    pub text: String,
}

impl Analysis {
    /// What would be solved.
    pub fn overview(&self) -> Overview {
        Overview::of(self)
    }
}

impl Overview {
    fn of(analysis: &Analysis) -> Self {
        let mesh = &analysis.problem.mesh;
        let rows = match &analysis.description {
            Description::Actuator(case) => rows_of_actuator(case, &analysis.problem),
            Description::Model(..) | Description::Body(_) => rows_of_model(analysis),
        };
        Self {
            title: analysis.title.clone(),
            nodes: mesh.num_nodes(),
            elements: mesh.num_elements(),
            unknowns: analysis.problem.num_unknowns(),
            volume_mm3: mesh.volume(),
            memory_bytes: analysis.estimate().bytes,
            rows,
        }
    }
}

impl fmt::Display for Overview {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.title.is_empty() {
            writeln!(f, "{}", self.title)?;
        }
        for OverviewRow { kind, text } in &self.rows {
            writeln!(f, "{kind:<9} {text}")?;
        }
        writeln!(f, "memory    about {}", size(self.memory_bytes))
    }
}

/// Rows that are being put together.
#[derive(Default)]
struct Rows(Vec<OverviewRow>);

impl Rows {
    fn add(&mut self, kind: &'static str, text: String) {
        self.0.push(OverviewRow { kind, text });
    }
}

fn number(n: usize) -> String {
    thousands(n as u64)
}

fn rows_of_actuator(case: &Case, problem: &Problem) -> Vec<OverviewRow> {
    let mut rows = Rows::default();
    let mesh = &problem.mesh;
    let actuator = &case.actuator;
    rows.add(
        "body",
        format!(
            "{}, {} mm x {} mm x {} mm, {} model, {:.6} mm3 of solid",
            plural(actuator.chambers, "chamber"),
            plain(actuator.length()),
            plain(actuator.width),
            plain(actuator.height),
            problem.modelled_part(),
            mesh.volume()
        ),
    );
    let varied = actuator.per_chamber().into_iter().filter(|(_, value)| value.is_varied());
    varied.for_each(|(key, value)| rows.add("", format!("{key} {} mm", plain_list(value.entries()))));
    rows.add(
        "mesh",
        format!(
            "{} nodes, {} elements {}, {} unknowns",
            number(mesh.num_nodes()),
            number(mesh.num_elements()),
            case.mesh.formulation(),
            number(problem.num_unknowns())
        ),
    );
    rows_of_quality(problem).into_iter().for_each(|text| rows.add("quality", text));
    if let Some(cut) = symmetry(problem) {
        rows.add("symmetry", cut);
    }
    let material = &case.material;
    rows.add(
        "material",
        format!(
            "{}, {} invariant: {}, bulk modulus {} MPa",
            material.law.name(),
            format!("{:?}", material.invariant).to_lowercase(),
            material.law,
            material.bulk_modulus
        ),
    );
    if let Some(limits) = where_it_gives_way(material) {
        rows.add("", limits);
    }
    for support in &problem.supports {
        let held = axes(support.axes);
        rows.add("support", format!("{}: {} nodes held in {held}", support.name, number(support.nodes.len())));
    }
    for (name, nodes) in &mesh.node_sets {
        rows.add("nodes", format!("{name}: {}", number(nodes.len())));
    }
    for (name, facets) in &mesh.facet_sets {
        rows.add("faces", format!("{name}: {}", number(facets.len())));
    }
    let faces: usize = problem.contact_pairs.iter().map(|p| p.slave.len()).sum();
    let (method, per_face) = match case.contact.method {
        ContactMethod::None => ("none", 0),
        ContactMethod::SinglePoint => ("single-point", 1),
        ContactMethod::MultiPoint => ("multi-point", 16),
        // Its points are the corners of the faces: about one for each.
        ContactMethod::Mortar => ("mortar", 1),
    };
    rows.add(
        "contact",
        format!(
            "{method}, {} with {} contact points, {} N/mm3",
            plural(problem.contact_pairs.len(), "gap"),
            number(faces * per_face),
            plain(case.contact.stiffness)
        ),
    );
    for thing in &problem.obstacles {
        rows.add("obstacle", obstacle(thing));
    }
    let pressures: Vec<String> = case.load.pressure_kpa.iter().map(|p| plain(*p)).collect();
    let faces = number(problem.cavity_facets().len());
    let pressures = format!("{} kPa", pressures.join(", "));
    rows.add(
        "load",
        match &case.load.chamber_factor {
            None => format!("{pressures} on {faces} faces"),
            Some(factor) => {
                format!("{pressures}, times {} in the chambers, on {faces} faces", plain_list(factor.entries()))
            }
        },
    );
    for (name, site) in probe_sites(mesh, &case.probes) {
        rows.add("probe", probe(&name, &site));
    }
    rows.0
}

fn axes(held: [bool; 3]) -> String {
    ["x", "y", "z"].iter().zip(held).filter(|(_, held)| *held).map(|(axis, _)| *axis).collect()
}

fn probe(name: &str, site: &ProbeSite) -> String {
    let [x, y, z] = site.at.map(plain);
    let far = if site.distance_mm > 1e-9 { format!(", {:.3} mm away", site.distance_mm) } else { String::new() };
    format!("{name}: node {} at ({x}, {y}, {z}){far}", site.node)
}

/// What is modelled of a body that is cut by planes of symmetry; `None` for a whole one.
fn symmetry(problem: &Problem) -> Option<String> {
    let planes: Vec<String> = problem.symmetry.iter().map(SymmetryPlane::words).collect();
    let words = format!(
        "{} of the body is modelled, symmetric to {}; loads are those of the {0}, results those of the whole body",
        problem.modelled_part(),
        planes.join(", ")
    );
    (!planes.is_empty()).then_some(words)
}

/// What an obstacle is.
fn obstacle(obstacle: &Obstacle) -> String {
    let shape = match &obstacle.shape {
        Shape::Plane { .. } => "plane".to_owned(),
        Shape::Sphere { radius, .. } => format!("sphere of radius {} mm", plain(*radius)),
        Shape::Cylinder { radius, .. } => format!("cylinder of radius {} mm", plain(*radius)),
        Shape::Cuboid { size, .. } => {
            let [x, y, z] = size.map(plain);
            format!("cuboid, {x} mm x {y} mm x {z} mm")
        }
    };
    let faces = plural(obstacle.facets.len(), "face");
    format!("{}: {shape}, {faces} may touch it, {} N/mm3", obstacle.name, plain(obstacle.stiffness))
}

/// What the parts of a model are.
fn rows_of_model(analysis: &Analysis) -> Vec<OverviewRow> {
    let Analysis { problem, requested, .. } = analysis;
    let mesh = &problem.mesh;
    let mut rows = Rows::default();
    let mut row = |kind: &'static str, what: String| rows.add(kind, what);
    row(
        "body",
        format!(
            "{} nodes, {} elements {}, {} unknowns, {:.6} mm3",
            number(mesh.num_nodes()),
            number(mesh.num_elements()),
            problem.element_names(),
            number(problem.num_unknowns()),
            mesh.volume()
        ),
    );
    if let Some(cut) = symmetry(problem) {
        row("symmetry", cut);
    }
    let (_, of_element) = problem.materials();
    let others = of_element.iter().filter(|region| **region == 0).count();
    let volume = |region: u16| {
        let of_region = of_element.iter().zip(0..).filter(|(of, _)| **of == region).map(|(_, element)| element);
        mesh.volume_of(of_region)
    };
    if others > 0 {
        row("material", material("", others, volume(0), &problem.material));
        where_it_gives_way(&problem.material).into_iter().for_each(|limits| row("", limits));
    }
    for (number, region) in problem.regions.iter().enumerate() {
        let volume = volume(number as u16 + 1);
        row("material", material(&format!("{}: ", region.name), region.elements.len(), volume, &region.material));
        where_it_gives_way(&region.material).into_iter().for_each(|limits| row("", limits));
    }
    rows_of_quality(problem).into_iter().for_each(|text| row("quality", text));
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
        let axes = axes(support.axes);
        let held = format!("{}: {} held in {axes}", support.name, plural(support.nodes.len(), "node"));
        let moved = support.motion.as_ref().map_or(String::new(), |motion| {
            format!(", moved by {} mm times {}", plain_list(&motion.displacement), curve(&motion.curve, 1.0))
        });
        row("support", held + &moved);
    }
    if !problem.equations.is_empty() {
        let terms: usize = problem.equations.iter().map(|equation| equation.terms.len()).sum();
        row("equations", format!("{} with {}", number(problem.equations.len()), plural(terms, "term")));
    }
    if !problem.distances.is_empty() {
        row("rigid", format!("{} between nodes stay what they are", plural(problem.distances.len(), "distance")));
    }
    for cavity in &problem.cavities {
        let control = match &cavity.control {
            Control::Pressure(pressure) => format!("pressure {} kPa", curve(pressure, 1000.0)),
            Control::Volume(volume) => format!("pumped in {} mm3", curve(volume, 1.0)),
            Control::Gas(gas) => format!(
                "gas {} of what fills it at {} kPa, exponent {}",
                curve(&gas.amount, 1.0),
                plain(1000.0 * gas.atmosphere),
                plain(gas.exponent)
            ),
        };
        row("cavity", format!("{}: {}, {control}", cavity.name, plural(cavity.facets.len(), "face")));
    }
    for load in &problem.loads {
        match load {
            Load::Force { nodes, force, curve: by } => {
                // Those of a deck are given for every node, those of a model file for all of them.
                let is_each = nodes.iter().all(|(_, factor)| *factor == 1.0) && nodes.len() > 1;
                let (on, spread) = if is_each { ("each of ", "") } else { ("", ", spread evenly,") };
                let on = format!("{on}{}{}", plural(nodes.len(), "node"), if nodes.len() > 1 { spread } else { "" });
                row("force", format!("{} N on {on} times {}", plain_list(force), curve(by, 1.0)));
            }
            Load::Traction { facets, traction, curve: by } => {
                let faces = plural(facets.len(), "face");
                row("traction", format!("{} MPa on {faces} times {}", plain_list(traction), curve(by, 1.0)));
            }
            Load::Pressure { facets, curve: by } => {
                row("pressure", format!("{} kPa on {}", curve(by, 1000.0), plural(facets.len(), "face")));
            }
            Load::Gravity { elements, acceleration, curve: by } => {
                let count = elements.as_ref().map_or(mesh.num_elements(), Vec::len);
                let on = plural(count, "element");
                row("gravity", format!("{} mm/s2 on {on} times {}", plain_list(acceleration), curve(by, 1.0)));
            }
        }
    }
    rows_of_choices(analysis, &mut row);
    for pair in &problem.contact_pairs {
        let [slave, master] = [&pair.slave, &pair.master].map(|facets| plural(facets.len(), "face"));
        let stiffness = plain(pair.stiffness.unwrap_or(problem.contact.stiffness));
        row("contact", format!("{}: {slave} against {master}, {stiffness} N/mm3", pair.name));
    }
    for thing in &problem.obstacles {
        row("obstacle", obstacle(thing));
    }
    let times: Vec<String> = requested.iter().map(|at| plain(at.0)).collect();
    row("times", times.join(", "));
    for (name, site) in probe_sites(mesh, &analysis.probes) {
        row("probe", probe(&name, &site));
    }
    rows.0
}

/// Hollow spaces that were found, and what the choices by place hold.
fn rows_of_choices(analysis: &Analysis, row: &mut dyn FnMut(&'static str, String)) {
    let mesh = &analysis.problem.mesh;
    let area = |facets: &[Facet]| facets.iter().map(|&facet| mesh.face_place(facet).area).sum::<f64>();
    for (name, hollow) in &analysis.hollows {
        let mouth = hollow.mouth.map_or_else(
            || "closed".to_owned(),
            |mouth| format!("open near {} by {} mm2", place(mouth.centre), measured(mouth.area)),
        );
        let (faces, walls) = (plural(hollow.facets.len(), "face"), measured(area(&hollow.facets)));
        row("hollow", format!("{name}: {faces}, {walls} mm2, {} mm3, {mouth}", measured(hollow.volume)));
    }
    let Some(model) = analysis.description.model() else { return };
    let chooser = Chooser::new(Arc::clone(&analysis.problem.mesh));
    for (key, asked, choice) in model.choices().into_iter().filter(|(_, _, choice)| choice.name().is_none()) {
        // What holds nothing has been refused.
        let Ok(held) = chooser.holds(choice, asked) else { continue };
        let counts = [(held.elements.len(), "element"), (held.nodes.len(), "node"), (held.facets.len(), "face")];
        let mut said: Vec<String> =
            counts.into_iter().filter(|(count, _)| *count > 0).map(|(count, what)| plural(count, what)).collect();
        if !held.facets.is_empty() {
            said.push(format!("{} mm2", measured(area(&held.facets))));
        }
        if !held.elements.is_empty() {
            said.push(format!("{} mm3", measured(mesh.volume_of(held.elements.iter().copied()))));
        }
        let of_elements = held.elements.iter().flat_map(|&element| mesh.element(element as usize));
        let nodes = held.nodes.iter().chain(of_elements).map(|&node| mesh.nodes[node as usize]);
        if let Some([low, high]) = bounds(nodes) {
            let range = |d: usize| format!("{} {} to {}", ["x", "y", "z"][d], measured(low[d]), measured(high[d]));
            said.push([0, 1, 2].map(range).join(", "));
        }
        row("choice", format!("{key} {choice}: {}", said.join(", ")));
    }
}

/// The shape of the worst element.
fn rows_of_quality(problem: &Problem) -> Option<String> {
    let (element, quality, poor) = worst_element(problem)?;
    let [x, y, z] = centre(problem, element);
    let poor = if poor > 0 { format!("; {} below {POOR_SHAPE}", number(poor)) } else { String::new() };
    Some(format!(
        "worst element {} near ({x:.2}, {y:.2}, {z:.2}) mm, scaled Jacobian {quality:.3} of 1{poor}",
        element + 1
    ))
}

/// The stretches beyond which a material answers more strain with less stress.
fn where_it_gives_way(material: &Material) -> Option<String> {
    let limits = stability_limits(material);
    let all: Vec<String> = limits.iter().map(|(mode, limit)| format!("{} {limit:.2}", mode.name())).collect();
    (!all.is_empty()).then(|| format!("gives way beyond stretches of: {}", all.join(", ")))
}

fn material(name: &str, elements: usize, volume: f64, material: &Material) -> String {
    let density = if material.density > 0.0 {
        format!(", {} g/cm3", rounded(material.density, DENSITY_DIGITS))
    } else {
        String::new()
    };
    format!(
        "{name}{} of {}: {}, bulk modulus {} MPa{density}, {volume:.6} mm3",
        plural(elements, "element"),
        material.law.name(),
        material.law,
        material.bulk_modulus
    )
}

/// A curve in words, its values times a factor.
fn curve(curve: &Curve, factor: f64) -> String {
    match curve {
        Curve::Proportional(slope) => format!("{} x time", plain(factor * slope)),
        Curve::Table(points) => {
            let shown = |[time, value]: &[f64; 2]| format!("{} at {}", plain(factor * value), plain(*time));
            match &points[..] {
                [[_, value]] => plain(factor * value),
                points if points.len() <= 6 => points.iter().map(shown).collect::<Vec<_>>().join(", "),
                points => {
                    let ends = [&points[0], &points[points.len() - 1]].map(shown);
                    format!("{} ... {} ({} points)", ends[0], ends[1], points.len())
                }
            }
        }
    }
}
