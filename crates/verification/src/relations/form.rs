//! One problem in every kind of file.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use pneuflex::mesh::Mesh;
use pneuflex::model::Formulation;
use pneuflex::model::model_file::{Model, Source};
use pneuflex::{Analysis, Body as MemoryBody, Error, Study};
use serde_json::json;

use super::draw::{Body, Draw};
use super::meshes::without_added_nodes;

/// A kind of file in which a problem is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A case or model file; a mesh lies beside it as results record it.
    Text,
    /// Nodes and cells in memory.
    Memory,
    /// A model file around a deck with mesh and sets.
    Deck,
    /// A model file around a mesh of Gmsh, in metres.
    Gmsh,
    /// The case or model with every default written out, as results record it.
    Resolved,
}

/// Files by name; the first one is the one that is given to the program.
pub type Files = Vec<(String, Vec<u8>)>;

impl Draw {
    /// The problem in a form; `None` if it cannot be written so.
    pub fn analysis(&self, form: Form) -> Option<Result<Analysis, Error>> {
        match (form, self) {
            (Form::Memory, Self::Model(model, Some(body))) => Some(in_memory(model, body)),
            (Form::Memory, _) => None,
            (Form::Resolved, Self::Model(_, Some(_))) => None,
            (Form::Resolved, _) => Some(self.analysis(Form::Text)?.and_then(|analysis| {
                let text = analysis.resolved().unwrap_or_default();
                Study::from_text("draw.toml", &text)?.build()
            })),
            _ => {
                let files = self.files(form)?;
                let name = files[0].0.clone();
                Some(Study::from_files(&name, files).and_then(|study| study.build()))
            }
        }
    }

    /// The files of a form; `None` if it has none or cannot be written so.
    pub fn files(&self, form: Form) -> Option<Files> {
        let text = |model: &Model, file: &str, scale: f64| {
            let source = model.model.as_ref().map(|source| Source { file: file.into(), scale, ..source.clone() });
            let text = toml::to_string(&Model { model: source, ..model.clone() }).unwrap_or_default();
            ("draw.toml".to_owned(), text.into_bytes())
        };
        match (form, self) {
            (Form::Text, Self::Case(case)) => {
                Some(vec![("draw.toml".into(), toml::to_string(case).unwrap_or_default().into_bytes())])
            }
            (Form::Text, Self::Model(model, None)) => Some(vec![text(model, "", 1.0)]),
            (Form::Text, Self::Model(model, Some(body))) => {
                Some(vec![text(model, "body.json", 1.0), ("body.json".into(), recorded(body).into_bytes())])
            }
            (Form::Deck, Self::Model(model, Some(body))) => {
                let (mesh, model) = imported(model, body);
                Some(vec![text(&model, "body.inp", 1.0), ("body.inp".into(), deck(&mesh)?.into_bytes())])
            }
            // Written in metres, if the model file's own lengths are in mm.
            (Form::Gmsh, Self::Model(model, Some(body))) => {
                let (mesh, model) = imported(model, body);
                Some(vec![text(&model, "body.msh", 1e3), ("body.msh".into(), gmsh(&mesh, 1e-3).into_bytes())])
            }
            _ => None,
        }
    }
}

/// The mesh that a deck or Gmsh has of a body, and the model file with the element that it then asks for: elements that no such file has come
/// without the nodes that are added to them by default.
fn imported(model: &Model, body: &Body) -> (Mesh, Model) {
    let mesh = as_files_have_it(&body.mesh);
    let mut model = model.clone();
    model.mesh.element = (!is_by_default(&mesh, body)).then_some(body.formulation);
    (mesh, model)
}

fn as_files_have_it(mesh: &Mesh) -> Mesh {
    let has_all = mesh.families().iter().all(|kind| kind.gmsh.number.is_some());
    if has_all { mesh.clone() } else { without_added_nodes(mesh) }
}

/// Whether a mesh is solved with the body's formulation if none is asked for; with several families there is no choice.
fn is_by_default(mesh: &Mesh, body: &Body) -> bool {
    let kind = mesh.kinds.only();
    kind.is_none_or(|kind| Formulation::of_kind(kind.enriched().unwrap_or(kind)) == Some(body.formulation))
}

/// The mesh of a deck alone that is solved with the body's formulation; `None` if there is none.
pub(super) fn of_deck_alone(body: &Body) -> Option<Mesh> {
    let mesh = as_files_have_it(&body.mesh);
    is_by_default(&mesh, body).then_some(mesh)
}

fn in_memory(model: &Model, body: &Body) -> Result<Analysis, Error> {
    let mut built = MemoryBody::of_mesh(body.formulation, body.mesh.clone())?;
    let source = built.model.model.clone();
    built.model = Model { model: source, ..model.clone() };
    built.analysis()
}

/// A body as the file that a result folder has it in.
pub(crate) fn recorded(Body { mesh, formulation }: &Body) -> String {
    let faces: BTreeMap<&String, Vec<(u32, u8)>> = (mesh.facet_sets.iter())
        .map(|(name, facets)| (name, facets.iter().map(|facet| (facet.element, facet.face)).collect()))
        .collect();
    let kinds = || (0..mesh.num_elements()).map(|element| mesh.kind_of(element)).collect::<Vec<_>>();
    json!({
        "formulation": formulation,
        "families": if mesh.kinds.only().is_some() { Vec::new() } else { kinds() },
        "nodes": mesh.nodes,
        "connectivity": mesh.connectivity,
        "node_sets": mesh.node_sets,
        "face_sets": faces,
        "element_sets": mesh.element_sets,
    })
    .to_string()
}

/// A deck with mesh and sets; `None` if no deck has such elements.
fn deck(mesh: &Mesh) -> Option<String> {
    let rest = "*MATERIAL, NAME=ANY\n*HYPERELASTIC, NEO HOOKE\n1., 0.1\n*SOLID SECTION, ELSET=ALL, MATERIAL=ANY\n*STEP, NLGEOM\n*STATIC\n\
                *END STEP\n";
    Some(deck_of_mesh(mesh)? + rest)
}

/// Nodes, elements, sets and surfaces of a deck.
pub(super) fn deck_of_mesh(mesh: &Mesh) -> Option<String> {
    let mut text = String::from("*NODE, NSET=ALLNODES\n");
    // Writing to a string cannot fail.
    for (node, [x, y, z]) in mesh.nodes.iter().enumerate() {
        let _ = writeln!(text, "{}, {x:?}, {y:?}, {z:?}", node + 1);
    }
    let mut last = None;
    for element in 0..mesh.num_elements() {
        let kind = mesh.kind_of(element);
        if last.replace(kind) != Some(kind) {
            let _ = writeln!(text, "*ELEMENT, TYPE={}, ELSET=ALL", kind.abaqus.names.first()?);
        }
        let numbers = std::iter::once(element + 1).chain(mesh.element(element).iter().map(|node| *node as usize + 1));
        let _ = writeln!(text, "{}", rows(numbers, 12, ",\n"));
    }
    for (set, nodes) in &mesh.node_sets {
        let _ = writeln!(text, "*NSET, NSET={set}\n{}", rows(nodes.iter().map(|node| *node as usize + 1), 12, "\n"));
    }
    for (set, elements) in &mesh.element_sets {
        let numbers = elements.iter().map(|element| *element as usize + 1);
        let _ = writeln!(text, "*ELSET, ELSET={set}\n{}", rows(numbers, 12, "\n"));
    }
    for (set, facets) in &mesh.facet_sets {
        let _ = writeln!(text, "*SURFACE, TYPE=ELEMENT, NAME={set}");
        for facet in facets {
            let faces = mesh.kind_of(facet.element as usize).abaqus.faces;
            let face = faces.iter().position(|face| *face == facet.face)? + 1;
            let _ = writeln!(text, "{}, S{face}", facet.element + 1);
        }
    }
    Some(text)
}

pub(super) fn rows(numbers: impl Iterator<Item = usize>, length: usize, end: &str) -> String {
    let numbers: Vec<String> = numbers.map(|number| number.to_string()).collect();
    numbers.chunks(length).map(|row| row.join(", ")).collect::<Vec<_>>().join(end)
}

/// Gmsh's type and nodes.
type Piece = (i32, Vec<u32>);

/// Gmsh's format 4.1, as text: a piece of the body or its surface for every combination of sets.
fn gmsh(mesh: &Mesh, scale: f64) -> String {
    // Dimension, Gmsh's type and nodes of every piece, by dimension and names of sets.
    let mut pieces: BTreeMap<(u8, Vec<&String>, i32), Vec<Piece>> = BTreeMap::new();
    let mut names: BTreeMap<(u8, &String), usize> = BTreeMap::new();
    for (dimension, name) in (mesh.node_sets.keys().map(|name| (0, name)))
        .chain(mesh.facet_sets.keys().map(|name| (2, name)))
        .chain(mesh.element_sets.keys().map(|name| (3, name)))
    {
        names.insert((dimension, name), names.len() + 1);
    }
    fn holders<'a, T: PartialEq>(sets: &'a BTreeMap<String, Vec<T>>, thing: &T) -> Vec<&'a String> {
        sets.iter().filter(|(_, set)| set.contains(thing)).map(|(name, _)| name).collect()
    }
    for node in mesh.node_sets.values().flatten().collect::<BTreeSet<_>>() {
        pieces.entry((0, holders(&mesh.node_sets, node), 15)).or_default().push((15, vec![*node]));
    }
    for facet in mesh.facet_sets.values().flatten().collect::<BTreeSet<_>>() {
        let piece = (mesh.face_kind(*facet).gmsh_type.unwrap_or_default(), mesh.facet_nodes(*facet));
        pieces.entry((2, holders(&mesh.facet_sets, facet), piece.0)).or_default().push(piece);
    }
    for element in 0..mesh.num_elements() {
        let family = mesh.kind_of(element).family();
        let mut nodes = vec![0; family.nodes.len()];
        family.gmsh.order.iter().zip(mesh.element(element)).for_each(|(&at, &node)| nodes[at] = node);
        let sets = holders(&mesh.element_sets, &(element as u32));
        let number = family.gmsh.number.unwrap_or_default();
        pieces.entry((3, sets, number)).or_default().push((number, nodes));
    }
    let mut text = format!("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n{}\n", names.len());
    for ((dimension, name), number) in &names {
        let _ = writeln!(text, "{dimension} {number} \"{name}\"");
    }
    let count = |wanted: u8| pieces.keys().filter(|(dimension, ..)| *dimension == wanted).count();
    let _ = writeln!(text, "$EndPhysicalNames\n$Entities\n{} 0 {} {}", count(0), count(2), count(3));
    for (tag, ((dimension, sets, _), _)) in pieces.iter().enumerate() {
        let physical: Vec<String> = sets.iter().map(|name| names[&(*dimension, *name)].to_string()).collect();
        let extent = if *dimension == 0 { "0 0 0" } else { "0 0 0 1 1 1" };
        let bounding = if *dimension == 0 { "" } else { " 0" };
        let _ = writeln!(text, "{} {extent} {} {}{bounding}", tag + 1, physical.len(), physical.join(" "));
    }
    let volume = pieces.keys().position(|(dimension, ..)| *dimension == 3).map_or(1, |at| at + 1);
    let nodes = mesh.num_nodes();
    let _ = writeln!(text, "$EndEntities\n$Nodes\n1 {nodes} 1 {nodes}\n3 {volume} 0 {nodes}");
    (1..=nodes).for_each(|node| text += &format!("{node}\n"));
    for x in &mesh.nodes {
        let [x, y, z] = x.map(|t| scale * t);
        let _ = writeln!(text, "{x:?} {y:?} {z:?}");
    }
    let total: usize = pieces.values().map(Vec::len).sum();
    let _ = writeln!(text, "$EndNodes\n$Elements\n{} {total} 1 {total}", pieces.len());
    let mut number = 0;
    for (tag, ((dimension, ..), members)) in pieces.iter().enumerate() {
        let kind = members.first().map_or(0, |member| member.0);
        let _ = writeln!(text, "{dimension} {} {kind} {}", tag + 1, members.len());
        for (_, nodes) in members {
            number += 1;
            let nodes: Vec<String> = nodes.iter().map(|node| (node + 1).to_string()).collect();
            let _ = writeln!(text, "{number} {}", nodes.join(" "));
        }
    }
    text + "$EndElements\n"
}
