//! A problem in the words of a deck: not only its mesh, but supports, equations, loads, contact, materials and schedule.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use pneuflex::mesh::Mesh;
use pneuflex::model::model_file::{
    ContactTable, EquationTable, ForceTable, Model, PressureTable, RegionTable, Series, Steps, SupportTable,
};
use pneuflex::model::{Choice, ContactMethod, Law, Material};

use super::draw::Body;
use super::form::{deck_of_mesh, of_deck_alone, rows};

/// Where a deck has no default: N/mm³.
const STIFFNESS: f64 = 4.0;

/// What a deck has words for of a model, as a model and as a deck; `None` if there is no such deck.
pub fn both(model: &Model, body: &Body) -> Option<(Model, String)> {
    let mesh = of_deck_alone(body)?;
    let spoken = in_words_of_decks(model)?;
    let text = deck(&spoken, &mesh)?;
    Some((spoken, text))
}

/// The model without what decks cannot say.
fn in_words_of_decks(model: &Model) -> Option<Model> {
    // Decks know names of sets only.
    if model.choices().iter().any(|(_, _, choice)| choice.name().is_none()) {
        return None;
    }
    let is_moved = model.supports.iter().any(|support| support.displacement.is_some());
    let material = |material: &Material| Material {
        bulk_modulus: material.bulk_modulus,
        density: material.density,
        ..Material::from(material.law.clone())
    };
    let inflated = model.cavities.iter().filter_map(|cavity| {
        Some(PressureTable { faces: cavity.faces.clone(), pressure_kpa: cavity.pressure_kpa.clone()? })
    });
    Some(Model {
        title: model.title.clone(),
        model: model.model.clone(),
        material: Some(material(model.material.as_ref()?)),
        regions: (model.regions.iter())
            .filter(|region| region.elements.is_some())
            .map(|region| RegionTable { material: material(&region.material), ..region.clone() })
            .collect(),
        supports: model.supports.iter().map(|table| without_symmetry(table, &model.supports)).collect(),
        equations: (model.equations.iter())
            .filter(|equation| equation.value.is_none() && !is_moved)
            .map(|equation| EquationTable { value: None, ..equation.clone() })
            .collect(),
        // A deck gives every node of a set the same force.
        forces: (model.forces.iter())
            .map(|table| ForceTable {
                nodes: "tip".into(),
                total: if table.nodes.name() == Some("tip") { table.total } else { table.total.map(|f| 0.1 * f) },
                ..table.clone()
            })
            .collect(),
        pressures: model.pressures.iter().cloned().chain(inflated).collect(),
        gravity: model.gravity.clone(),
        contacts: (model.contacts.iter())
            .map(|table| ContactTable {
                method: Some(ContactMethod::MultiPoint),
                stiffness: table.stiffness.or(Some(STIFFNESS)),
                penetration_tolerance: None,
                two_pass: false,
                ..table.clone()
            })
            .collect(),
        load: model.load.clone(),
        solver: Steps { max_iterations: None, ..Steps::default() },
        ..Model::default()
    })
}

/// Decks know supports only, no planes of symmetry. What moves nodes out of such a plane, which is refused where the plane is declared,
/// contradicts it in its edge: what a node in the middle of a face does there is for the file to say, and decks do not know such nodes.
fn without_symmetry(table: &SupportTable, all: &[SupportTable]) -> SupportTable {
    let is_plane = |axis: char| all.iter().any(|other| other.symmetry && other.axes.contains(axis));
    let along = |(axis, component): (char, f64)| if is_plane(axis) { 0.0 } else { component };
    let displacement = table.displacement.map(|[x, y, z]| [('x', x), ('y', y), ('z', z)].map(along));
    SupportTable { symmetry: false, displacement, ..table.clone() }
}

/// Amplitudes by the total time, and what stands in the first step.
struct Step {
    end: f64,
    amplitudes: String,
    loads: String,
    count: usize,
}

impl Step {
    /// Lines that follow a function of time; without one they grow along a straight line.
    fn add(&mut self, keyword: &str, lines: &[String], factor: Option<&Series>) {
        let points = match factor {
            None => vec![[0.0, 0.0], [self.end, 1.0]],
            Some(Series::End(value)) => vec![[0.0, 0.0], [self.end, *value]],
            Some(Series::Points(points)) => points.clone(),
        };
        let name = self.count;
        self.count += 1;
        // Writing to a string cannot fail.
        let _ = writeln!(self.amplitudes, "*AMPLITUDE, NAME=A{name}, TIME=TOTAL TIME");
        for [time, value] in points {
            let _ = writeln!(self.amplitudes, "{time:?}, {value:?}");
        }
        let _ = writeln!(self.loads, "*{keyword}, AMPLITUDE=A{name}\n{}", lines.join("\n"));
    }
}

fn deck(model: &Model, mesh: &Mesh) -> Option<String> {
    let times = &model.load.as_ref()?.times;
    let mut text = deck_of_mesh(mesh)?;
    for (set, facets) in &mesh.facet_sets {
        let nodes: BTreeSet<u32> = facets.iter().flat_map(|&facet| mesh.facet_nodes(facet)).collect();
        let numbers = nodes.into_iter().map(|node| node as usize + 1);
        let _ = writeln!(text, "*NSET, NSET=N_{set}\n{}", rows(numbers, 12, "\n"));
    }
    let nodes_of = |choice: &Choice| match choice.name() {
        Some(set) if mesh.facet_sets.contains_key(set) => format!("N_{set}"),
        _ => choice.to_string(),
    };
    let special: Vec<&RegionTable> = model.regions.iter().collect();
    let in_region = |element: u32| {
        let has = |region: &&RegionTable| {
            region
                .elements
                .as_ref()
                .and_then(Choice::name)
                .is_some_and(|set| mesh.element_sets.get(set).is_some_and(|s| s.contains(&element)))
        };
        special.iter().any(has)
    };
    let rest = (0..mesh.num_elements() as u32).filter(|&element| !in_region(element)).map(|e| e as usize + 1);
    let _ = writeln!(text, "*ELSET, ELSET=REST\n{}", rows(rest, 12, "\n"));
    let first = ("REST", "MAIN".to_owned(), model.material.as_ref()?);
    let others = special
        .iter()
        .filter_map(|region| Some((region.elements.as_ref()?.name()?, region.name.clone(), &region.material)));
    for (set, name, material) in std::iter::once(first).chain(others) {
        text += &in_words(&name, material)?;
        let _ = writeln!(text, "*SOLID SECTION, ELSET={set}, MATERIAL={name}");
    }
    for EquationTable { terms, .. } in &model.equations {
        let terms: Vec<String> = (terms.iter())
            .map(|(nodes, axis, factor)| format!("{}, {}, {factor:?}", nodes_of(nodes), number(axis)))
            .collect();
        let _ = writeln!(text, "*EQUATION\n{}\n{}", terms.len(), terms.join(", "));
    }
    for (i, ContactTable { slave, master, stiffness, .. }) in model.contacts.iter().enumerate() {
        let stiffness = stiffness.unwrap_or(STIFFNESS);
        let surfaces = if slave == master { slave.to_string() } else { format!("{slave}, {master}") };
        let _ = writeln!(
            text,
            "*SURFACE INTERACTION, NAME=T{i}\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{stiffness:?}\n\
             *CONTACT PAIR, INTERACTION=T{i}, TYPE=SURFACE TO SURFACE\n{surfaces}"
        );
    }
    let mut step = Step { end: times.last().copied()?, amplitudes: String::new(), loads: String::new(), count: 0 };
    for SupportTable { nodes, axes, displacement, factor, .. } in &model.supports {
        let line = |axis: char, value: f64| {
            let axis = number(&axis.to_string());
            format!("{}, {axis}, {axis}, {value:?}", nodes_of(nodes))
        };
        match displacement {
            None => {
                let lines: Vec<String> = axes.chars().map(|axis| line(axis, 0.0)).collect();
                let _ = writeln!(text, "*BOUNDARY\n{}", lines.join("\n"));
            }
            Some(moved) => {
                let value = |axis: char| moved[number(&axis.to_string()) - 1];
                let lines: Vec<String> = axes.chars().map(|axis| line(axis, value(axis))).collect();
                step.add("BOUNDARY", &lines, factor.as_ref());
            }
        }
    }
    for ForceTable { nodes, total, factor } in &model.forces {
        let lines: Vec<String> =
            (1..=3).zip(total).map(|(axis, force)| format!("{}, {axis}, {force:?}", nodes_of(nodes))).collect();
        step.add("CLOAD", &lines, factor.as_ref());
    }
    for PressureTable { faces, pressure_kpa } in &model.pressures {
        // In MPa; the amplitude has the values.
        step.add("DSLOAD", &[format!("{faces}, P, 1e-3")], Some(pressure_kpa));
    }
    if let Some(gravity) = &model.gravity {
        let [x, y, z] = gravity.acceleration;
        let most = (x * x + y * y + z * z).sqrt();
        step.add(
            "DLOAD",
            &[format!(", GRAV, {most:?}, {:?}, {:?}, {:?}", x / most, y / most, z / most)],
            gravity.factor.as_ref(),
        );
    }
    text += &step.amplitudes;
    let mut begin = 0.0;
    for (i, &time) in times.iter().enumerate() {
        let period = time - begin;
        begin = time;
        let loads = if i == 0 { step.loads.as_str() } else { "" };
        let _ = write!(text, "*STEP, NLGEOM\n*STATIC\n{period:?}, {period:?}\n{loads}*END STEP\n");
    }
    Some(text)
}

fn number(axis: &str) -> usize {
    "xyz".find(axis).map_or(1, |at| at + 1)
}

/// Densities in t/mm³, and D₁ = 2/κ; `None` for a law that decks have no word for.
fn in_words(name: &str, material: &Material) -> Option<String> {
    let d = 2.0 / material.bulk_modulus;
    let law = match &material.law {
        Law::NeoHooke { c10 } => format!("NEO HOOKE\n{c10:?}, {d:?}"),
        Law::Yeoh { c10, c20, c30 } => format!("YEOH\n{c10:?}, {c20:?}, {c30:?}, {d:?}, 0., 0."),
        Law::Polynomial { c10, c01, c20, c11, c02 } => {
            format!("POLYNOMIAL, N=2\n{c10:?}, {c01:?}, {c20:?}, {c11:?}, {c02:?}, {d:?}, 0.")
        }
        Law::Ogden { terms } => {
            let constants: Vec<String> = terms.iter().map(|term| format!("{:?}, {:?}", term.mu, term.alpha)).collect();
            let zeros = ", 0.".repeat(terms.len().saturating_sub(1));
            format!("OGDEN, N={}\n{}, {d:?}{zeros}", terms.len(), constants.join(", "))
        }
        _ => return None,
    };
    let density = match material.density {
        0.0 => String::new(),
        density => format!("*DENSITY\n{:?}\n", 1e-9 * density),
    };
    Some(format!("*MATERIAL, NAME={name}\n*HYPERELASTIC, {law}\n{density}"))
}
