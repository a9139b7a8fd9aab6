//! Nodes and elements → a mesh.

use std::cell::OnceCell;
use std::collections::{BTreeMap, BTreeSet};

use pneuflex_mesh::{Facet, Mesh};

use super::context::Context;
use super::element_types::Family;
use super::outline::{Item, Outline, Scope};
use super::references::nodes_of_constraints;
use crate::jacobian::inverted_elements;
use crate::mid_edges::{UNMATCHED, completed_mesh, note_on_families, unmatched_elements};
use crate::report::{Place, quoted};
use crate::syntax::integer;

/// A node's or element's number within its scope.
pub(super) type Number = (u32, i32);

/// Nodes and elements of a deck.
#[derive(Debug)]
pub(super) struct Body {
    pub scopes: Vec<Scope>,
    /// Type of every element.
    pub families: Vec<Family>,
    /// Without sets.
    pub mesh: Mesh,
    /// Our numbers of the nodes that belong to an element, or to a constraint.
    pub nodes: BTreeMap<Number, u32>,
    /// Those of them that belong to constraints alone, by our numbers.
    pub references: BTreeSet<u32>,
    /// Nodes that belong to nothing.
    pub lone_nodes: BTreeSet<Number>,
    /// Our numbers of the elements.
    pub elements: BTreeMap<Number, u32>,
    /// The deck's numbers of our nodes; added mid-edge nodes have none.
    pub node_numbers: Vec<Number>,
    /// The deck's numbers of our elements.
    pub element_numbers: Vec<Number>,
    /// Where our elements are written.
    pub element_places: Vec<Place>,
    free: OnceCell<BTreeSet<Facet>>,
}

/// A node that a deck refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NodeReference {
    /// Our number.
    Node(u32),
    /// It belongs to no element.
    Lone,
}

struct WrittenNode {
    position: [f64; 3],
    place: Place,
}

struct WrittenElement {
    family: Family,
    number: Number,
    place: Place,
    nodes: Vec<i32>,
}

impl Body {
    /// Reads all nodes and elements; `None` if there is no mesh to go on with.
    pub fn read(outline: &mut Outline<'_>, context: &mut Context<'_>) -> Option<Self> {
        let written = read_nodes(outline, context);
        let elements = read_elements(outline, context);
        let Some(first) = elements.first() else {
            if !context.report.has_errors() {
                context.error(Place { file: 0, line: 1 }, "the deck has no *ELEMENT");
            }
            return None;
        };
        let named = nodes_of_constraints(outline, context);
        let scopes = std::mem::take(&mut outline.scopes);
        let mut is_used: BTreeMap<Number, u32> = BTreeMap::new();
        let mut whole = true;
        for element in &elements {
            let unknown = element.nodes.iter().find(|&&node| !written.contains_key(&(element.number.0, node)));
            if let Some(node) = unknown {
                context.error(element.place, format!("element {}: there is no node {node}", element.number.1));
                whole = false;
            }
            is_used.extend(element.nodes.iter().map(|&node| ((element.number.0, node), 0)));
        }
        if !whole {
            return None;
        }
        let of_elements: BTreeSet<Number> = is_used.keys().copied().collect();
        is_used.extend(named.into_iter().filter(|number| written.contains_key(number)).map(|number| (number, 0)));
        for (number, index) in is_used.iter_mut().zip(0..) {
            *number.1 = index;
        }
        let nodes = is_used;
        let positions = nodes
            .keys()
            .filter_map(|number| Some(scopes[number.0 as usize].placement.place(written.get(number)?.position)));
        let numbered =
            |e: &WrittenElement| e.nodes.iter().map(|&node| nodes[&(e.number.0, node)]).collect::<Vec<u32>>();
        let of_mesh: Vec<_> = elements.iter().map(|element| (element.family.kind, numbered(element))).collect();
        let mesh = completed_mesh(positions.collect(), &of_mesh);
        if let Some(note) = note_on_families(&mesh) {
            context.note(first.place, note);
        }
        let lone_nodes: BTreeSet<Number> =
            written.keys().filter(|number| !nodes.contains_key(number)).copied().collect();
        if let Some(place) = lone_nodes.first().and_then(|number| Some(written.get(number)?.place)) {
            context.note(place, format!("nodes that belong to no element are left out: {}", lone_nodes.len()));
        }
        let body = Self {
            scopes,
            families: elements.iter().map(|element| element.family).collect(),
            node_numbers: nodes.keys().copied().collect(),
            mesh,
            references: nodes.iter().filter(|(number, _)| !of_elements.contains(number)).map(|(_, &n)| n).collect(),
            nodes,
            lone_nodes,
            elements: elements.iter().map(|e| e.number).zip(0..).collect(),
            element_numbers: elements.iter().map(|e| e.number).collect(),
            element_places: elements.iter().map(|e| e.place).collect(),
            free: OnceCell::new(),
        };
        body.check_jacobians(context);
        body.check_faces(context);
        Some(body)
    }

    /// Whether a face belongs to one element only.
    pub fn is_free(&self, facet: Facet) -> bool {
        self.free.get_or_init(|| self.mesh.boundary_facets().into_iter().collect()).contains(&facet)
    }

    /// Loads on faces between two elements are taken as they are, but are hardly ever meant.
    pub fn note_inner_faces(&self, facets: &[Facet], place: Place, context: &mut Context<'_>) {
        let inner = facets.iter().filter(|facet| !self.is_free(**facet)).count();
        if inner > 0 {
            context.note(
                place,
                format!("{inner} of the {} faces lie inside of the body, between two elements", facets.len()),
            );
        }
    }

    /// An element's number as the deck has it.
    pub fn element_name(&self, element: u32) -> String {
        self.name(self.element_numbers[element as usize])
    }

    /// A node's number as the deck has it.
    pub fn node_name(&self, node: u32) -> String {
        self.node_numbers.get(node as usize).map_or_else(|| "added on an edge".to_owned(), |&number| self.name(number))
    }

    fn name(&self, (scope, number): Number) -> String {
        let scope = &self.scopes[scope as usize].name;
        if scope.is_empty() { number.to_string() } else { format!("{scope}.{number}") }
    }

    /// The scope and the rest of a name that begins with an instance's, as in `PART-1.TOP`.
    pub fn split<'t>(&self, text: &'t str) -> Option<(u32, &'t str)> {
        self.scopes.iter().zip(0..).skip(1).find_map(|(scope, number)| {
            let (head, rest) = (text.get(..scope.name.len())?, text.get(scope.name.len()..)?);
            head.eq_ignore_ascii_case(&scope.name).then(|| rest.strip_prefix('.')).flatten().map(|rest| (number, rest))
        })
    }

    /// A node by its number, with the instance before it or not. `None` if the text is no number.
    pub fn node(&self, scope: u32, text: &str) -> Option<Result<NodeReference, String>> {
        let number = self.number(scope, text)?;
        Some(match self.nodes.get(&number) {
            Some(&node) => Ok(NodeReference::Node(node)),
            None if self.lone_nodes.contains(&number) => Ok(NodeReference::Lone),
            None => Err(format!("there is no node {}", quoted(text))),
        })
    }

    /// An element by its number, with the instance before it or not. `None` if the text is no number.
    pub fn element(&self, scope: u32, text: &str) -> Option<Result<u32, String>> {
        let number = self.number(scope, text)?;
        Some(self.elements.get(&number).copied().ok_or_else(|| format!("there is no element {}", quoted(text))))
    }

    fn number(&self, scope: u32, text: &str) -> Option<Number> {
        match self.split(text) {
            Some((scope, rest)) => Some((scope, integer(rest).ok()?)),
            None => Some((scope, integer(text).ok()?)),
        }
    }

    /// Number of the first mid-edge node that was added, if there is one.
    pub fn first_added(&self) -> Option<u32> {
        let written = self.node_numbers.len();
        (written < self.mesh.num_nodes()).then_some(written as u32)
    }

    /// Nodes of an element that the deck has.
    pub fn written_nodes(&self, element: u32) -> &[u32] {
        &self.mesh.element(element as usize)[..self.families[element as usize].num_nodes()]
    }

    /// Faces by their label, a letter and a digit, of some elements; an error says which labels there are.
    pub fn labelled_faces(&self, elements: &[u32], letter: char, label: &str) -> Result<Vec<Facet>, String> {
        let of_element = |&element: &u32| {
            let family = self.families[element as usize];
            let face =
                family.labelled_face(letter, label).ok_or_else(|| format!("{letter}{}", family.kind.num_faces()))?;
            Ok(Facet { element, face })
        };
        elements.iter().map(of_element).collect()
    }

    fn check_faces(&self, context: &mut Context<'_>) {
        if let Some(([one, other], [x, y, z])) = unmatched_elements(&self.mesh) {
            let [name, of_triangle] = [one, other].map(|element| self.element_name(element as u32));
            let text = format!(
                "elements {name} and {of_triangle} meet near ({x:.6}, {y:.6}, {z:.6}) with a quadrilateral on a triangle: {UNMATCHED}"
            );
            context.error(self.element_places[one], text);
        }
    }

    fn check_jacobians(&self, context: &mut Context<'_>) {
        for (element, smallest) in inverted_elements(&self.mesh) {
            let name = self.element_name(element as u32);
            let text = format!(
                "element {name} is inverted or flat: its Jacobian is {smallest:.3e}; check the order and the positions of its nodes"
            );
            context.error(self.element_places[element], text);
        }
    }
}

fn read_nodes(outline: &Outline<'_>, context: &mut Context<'_>) -> BTreeMap<Number, WrittenNode> {
    let mut found: BTreeMap<Number, WrittenNode> = BTreeMap::new();
    for Item { block, scope, .. } in outline.of("NODE") {
        context.expect_word(block, "SYSTEM", &["R"]);
        for line in &block.lines {
            let fields = context.fields(line);
            if fields.len() > 4 || fields.is_empty() {
                context.error(line.place, "a node is its number and three coordinates");
                continue;
            }
            let Some(number) = context.integer(line.place, fields[0]) else { continue };
            let mut position = [0.0; 3];
            for (i, x) in position.iter_mut().enumerate() {
                *x = context.real_or_zero(line.place, fields.get(i + 1)).unwrap_or(0.0);
            }
            let node = WrittenNode { position, place: line.place };
            if number < 1 {
                context.error(line.place, format!("node {number}: numbers begin with 1"));
            } else if let Some(first) = found.insert((scope, number), node) {
                let (file, line_number) = (context.sources.names[first.place.file as usize].clone(), first.place.line);
                context.error(line.place, format!("node {number} is there twice, first in {file}:{line_number}"));
            }
        }
    }
    found
}

fn read_elements(outline: &Outline<'_>, context: &mut Context<'_>) -> Vec<WrittenElement> {
    let mut found: Vec<WrittenElement> = Vec::new();
    let mut places: BTreeMap<Number, Place> = BTreeMap::new();
    for Item { block, scope, .. } in outline.of("ELEMENT") {
        let Some(written) = context.required(block, "TYPE") else { continue };
        let name = written.to_uppercase();
        let family = match Family::of(&name) {
            Ok(family) => family,
            Err(why) => {
                context.error(block.place, format!("elements of type {} cannot be solved: {why}", quoted(written)));
                continue;
            }
        };
        context.note(block.place, family.note(&name));
        for element in elements_of_block(block, scope, family, context) {
            if element.number.1 < 1 {
                context.error(element.place, format!("element {}: numbers begin with 1", element.number.1));
            } else if let Some(first) = places.insert(element.number, element.place) {
                let file = context.sources.names[first.file as usize].clone();
                let text = format!("element {} is there twice, first in {file}:{}", element.number.1, first.line);
                context.error(element.place, text);
            } else {
                found.push(element);
            }
        }
    }
    found
}

/// Elements go on in the next line until they have all their nodes.
fn elements_of_block(
    block: &crate::syntax::Block,
    scope: u32,
    family: Family,
    context: &mut Context<'_>,
) -> Vec<WrittenElement> {
    let wanted = family.num_nodes();
    let mut found: Vec<WrittenElement> = Vec::new();
    let mut open = false;
    for line in &block.lines {
        let mut numbers = Vec::new();
        for field in context.fields(line) {
            match context.integer(line.place, field) {
                Some(number) => numbers.push(number),
                None => {
                    found.retain(|element| element.nodes.len() == wanted);
                    return found;
                }
            }
        }
        match (found.last_mut().filter(|_| open), numbers.split_first()) {
            (Some(element), _) => element.nodes.extend(&numbers),
            (None, Some((&number, nodes))) => {
                found.push(WrittenElement {
                    family,
                    number: (scope, number),
                    place: line.place,
                    nodes: nodes.to_vec(),
                });
            }
            (None, None) => continue,
        }
        let Some(element) = found.last() else { continue };
        open = element.nodes.len() < wanted;
        if element.nodes.len() > wanted {
            let (number, has) = (element.number.1, element.nodes.len());
            context.error(line.place, format!("element {number} has {has} nodes instead of {wanted}"));
            found.pop();
            return found;
        }
    }
    if let (true, Some(element)) = (open, found.last()) {
        let (number, has) = (element.number.1, element.nodes.len());
        context.error(element.place, format!("element {number} has {has} nodes instead of {wanted}"));
        found.pop();
    }
    found
}
