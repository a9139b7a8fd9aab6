//! Named sets of nodes, elements and faces.

use std::collections::{BTreeMap, BTreeSet};

use pneuflex_mesh::Facet;

use super::body::{Body, NodeReference};
use super::context::Context;
use super::outline::{Item, Outline, ROOT};
use crate::report::{Place, quoted, suggestion};
use crate::syntax::{Block, DataLine};

/// A named set.
#[derive(Debug)]
pub(super) struct Set<T> {
    /// As it was first written.
    pub name: String,
    pub members: Vec<T>,
}

/// Named sets of one kind by scope and name in capitals.
#[derive(Debug)]
pub(super) struct Sets<T>(BTreeMap<(u32, String), Set<T>>);

/// All sets of a deck.
#[derive(Debug, Default)]
pub(super) struct AllSets {
    pub nodes: Sets<u32>,
    pub elements: Sets<u32>,
    pub surfaces: Sets<Facet>,
}

impl<T> Default for Sets<T> {
    fn default() -> Self {
        Self(BTreeMap::new())
    }
}

impl<T: Copy + Ord> Sets<T> {
    /// A set by its name as seen from a scope: its own, the assembly's, or an instance's with the instance's name before it.
    pub fn find(&self, body: &Body, scope: u32, name: &str) -> Option<&Set<T>> {
        let get = |scope, name: &str| self.0.get(&(scope, name.to_uppercase()));
        let of_instance = || body.split(name).and_then(|(scope, rest)| get(scope, rest));
        let of_assembly = || {
            let (head, rest) = name.split_once('.')?;
            head.eq_ignore_ascii_case("ASSEMBLY").then(|| get(ROOT, rest))?
        };
        get(scope, name).or_else(|| get(ROOT, name)).or_else(of_instance).or_else(of_assembly)
    }

    /// A set by its name, or why there is none.
    pub fn get(&self, body: &Body, scope: u32, name: &str, what: &str) -> Result<&Set<T>, String> {
        self.find(body, scope, name).ok_or_else(|| {
            let hint = suggestion(name, self.0.values().map(|set| set.name.as_str()));
            format!("there is no {what} {} (yet){hint}", quoted(name))
        })
    }

    /// Adds members to a set, in ascending order or in that of their first mention.
    fn add(&mut self, scope: u32, name: &str, members: Vec<T>, is_sorted: bool) {
        let new = || Set { name: name.to_owned(), members: Vec::new() };
        let set = self.0.entry((scope, name.to_uppercase())).or_insert_with(new);
        set.members.extend(members);
        if is_sorted {
            set.members.sort_unstable();
            set.members.dedup();
        } else {
            let mut seen = BTreeSet::new();
            set.members.retain(|&member| seen.insert(member));
        }
    }

    /// Names as the whole deck sees them, with the instance's in front, and sets.
    pub fn named<'a>(&'a self, body: &'a Body) -> impl Iterator<Item = (String, &'a Set<T>)> {
        self.0.iter().map(|((scope, _), set)| {
            let scope = &body.scopes[*scope as usize].name;
            (if scope.is_empty() { set.name.clone() } else { format!("{scope}.{}", set.name) }, set)
        })
    }
}

impl AllSets {
    /// Reads the sets of nodes and elements, then the surfaces.
    pub fn read(outline: &Outline<'_>, body: &Body, context: &mut Context<'_>) -> Self {
        let mut sets = Self::default();
        for item in &outline.items {
            match item.block.keyword.as_str() {
                "NODE" => sets.with_definition(item, "NSET", body, context),
                "ELEMENT" => sets.with_definition(item, "ELSET", body, context),
                "NSET" => sets.node_set(item, body, context),
                "ELSET" => sets.element_set(item, body, context),
                _ => {}
            }
        }
        for item in outline.of("SURFACE") {
            sets.surface(item, body, context);
        }
        sets
    }

    /// `*NODE, NSET=` and `*ELEMENT, ELSET=`: the first number of each line that begins a node or an element.
    fn with_definition(&mut self, item: &Item<'_>, parameter: &str, body: &Body, context: &mut Context<'_>) {
        let Some(name) = item.block.value(parameter) else { return };
        let number = |line: &DataLine| Some((item.scope, context.fields(line).first()?.parse().ok()?));
        let numbers = item.block.lines.iter().filter_map(number);
        if parameter == "NSET" {
            let members = numbers.filter_map(|number| body.nodes.get(&number).copied()).collect();
            self.nodes.add(item.scope, name, members, true);
        } else {
            // Further lines of an element begin with a node's number.
            let place_of = |element: u32| body.element_places[element as usize];
            let lines: BTreeSet<Place> = item.block.lines.iter().map(|line| line.place).collect();
            let members = numbers.filter_map(|number| body.elements.get(&number).copied());
            let members = members.filter(|&element| lines.contains(&place_of(element))).collect();
            self.elements.add(item.scope, name, members, true);
        }
    }

    fn node_set(&mut self, item: &Item<'_>, body: &Body, context: &mut Context<'_>) {
        let Some(name) = context.required(item.block, "NSET") else { return };
        let scope = instance(item, body, context);
        let mut members = Vec::new();
        if let Some(elements) = item.block.value("ELSET") {
            match self.elements.get(body, scope, elements, "element set") {
                Ok(set) => {
                    let nodes = set.members.iter().flat_map(|&element| body.written_nodes(element));
                    members.extend(nodes.copied());
                }
                Err(why) => context.error(item.block.place, why),
            }
        }
        for line in &item.block.lines {
            if item.block.has("GENERATE") {
                members.extend(generate(line, scope, &body.nodes, "nodes", context));
                continue;
            }
            for field in context.fields(line) {
                match body.node(scope, field) {
                    _ if field.is_empty() => {}
                    Some(Ok(NodeReference::Node(node))) => members.push(node),
                    Some(Ok(NodeReference::Lone)) => {
                        context.note(line.place, format!("set {name}: nodes that belong to no element are left out"));
                    }
                    Some(Err(why)) => context.error(line.place, format!("set {name}: {why}")),
                    None => match self.nodes.get(body, scope, field, "node set") {
                        Ok(set) => members.extend(&set.members),
                        Err(why) => context.error(line.place, format!("set {name}: {why}")),
                    },
                }
            }
        }
        self.nodes.add(item.scope, name, members, !item.block.has("UNSORTED"));
    }

    fn element_set(&mut self, item: &Item<'_>, body: &Body, context: &mut Context<'_>) {
        let Some(name) = context.required(item.block, "ELSET") else { return };
        let scope = instance(item, body, context);
        let mut members = Vec::new();
        for line in &item.block.lines {
            if item.block.has("GENERATE") {
                members.extend(generate(line, scope, &body.elements, "elements", context));
                continue;
            }
            for field in context.fields(line).into_iter().filter(|field| !field.is_empty()) {
                let found = match body.element(scope, field) {
                    Some(element) => element.map(|element| vec![element]),
                    None => self.elements.get(body, scope, field, "element set").map(|set| set.members.clone()),
                };
                match found {
                    Ok(elements) => members.extend(elements),
                    Err(why) => context.error(line.place, format!("set {name}: {why}")),
                }
            }
        }
        self.elements.add(item.scope, name, members, true);
    }

    fn surface(&mut self, item: Item<'_>, body: &Body, context: &mut Context<'_>) {
        let Some(name) = context.required(item.block, "NAME") else { return };
        let place = item.block.place;
        context.expect_word(item.block, "TYPE", &["ELEMENT", "NODE"]);
        let facets = match item.block.word("TYPE").as_deref() {
            None | Some("ELEMENT") => self.faces_of_elements(item, name, body, context),
            Some("NODE") => self.faces_of_nodes(item, name, body, context),
            Some(_) => return,
        };
        if facets.is_empty() {
            let why = match item.block.word("TYPE").as_deref() {
                Some("NODE") => ": no free face has all its corners among its nodes",
                _ => "",
            };
            context.error(place, format!("surface {name} is empty{why}"));
        }
        if self.surfaces.0.contains_key(&(item.scope, name.to_uppercase())) {
            context.error(place, format!("surface {name} is there twice"));
        }
        self.surfaces.add(item.scope, name, facets, true);
    }

    /// The free faces all of whose corners are named: contact acts on faces, not on nodes.
    fn faces_of_nodes(&self, item: Item<'_>, name: &str, body: &Body, context: &mut Context<'_>) -> Vec<Facet> {
        let mut nodes = BTreeSet::new();
        for line in &item.block.lines {
            // A second field is the node's share of the area, which follows from the faces.
            let Some(&field) = context.fields(line).first() else { continue };
            match nodes_of(self, body, item.scope, field, item.block) {
                Ok(found) => nodes.extend(found),
                Err(why) => context.error(line.place, why),
            }
        }
        let is_named = |facet: &Facet| {
            let corners = body.mesh.face_kind(*facet).num_corners();
            body.mesh.facet_nodes(*facet)[..corners].iter().all(|node| nodes.contains(node))
        };
        let facets: Vec<Facet> = body.mesh.boundary_facets().into_iter().filter(is_named).collect();
        let text = format!(
            "surface {name}, {} nodes, is taken as the {} free faces that have all their corners among them",
            nodes.len(),
            facets.len()
        );
        context.note(item.block.place, text);
        facets
    }

    fn faces_of_elements(&self, item: Item<'_>, name: &str, body: &Body, context: &mut Context<'_>) -> Vec<Facet> {
        let mut facets = Vec::new();
        for line in &item.block.lines {
            let fields = context.fields(line);
            let Some((&target, label)) = fields.split_first() else { continue };
            let elements = match self.target(body, item.scope, target) {
                Ok(elements) => elements,
                Err(why) => {
                    context.error(line.place, format!("surface {name}: {why}"));
                    continue;
                }
            };
            match label {
                [] => {
                    let of_element = |&element: &u32| body.mesh.facets_of(element);
                    facets.extend(elements.iter().flat_map(of_element).filter(|&facet| body.is_free(facet)));
                }
                [label] => match body.labelled_faces(&elements, 'S', label) {
                    Ok(named) => {
                        body.note_inner_faces(&named, line.place, context);
                        facets.extend(named);
                    }
                    Err(last) => {
                        let text = format!("surface {name}: {} is no face, S1 to {last} are", quoted(label));
                        context.error(line.place, text);
                    }
                },
                _ => context
                    .error(line.place, format!("surface {name}: a line is an element set or element, and a face")),
            }
        }
        facets
    }

    /// Elements of a set, or one by its number.
    pub fn target(&self, body: &Body, scope: u32, text: &str) -> Result<Vec<u32>, String> {
        match body.element(scope, text) {
            Some(element) => element.map(|element| vec![element]),
            None => self.elements.get(body, scope, text, "element set").map(|set| set.members.clone()),
        }
    }
}

/// The scope in which a set's numbers are meant.
fn instance(item: &Item<'_>, body: &Body, context: &mut Context<'_>) -> u32 {
    let Some(name) = item.block.value("INSTANCE") else { return item.scope };
    let found = body.scopes.iter().zip(0..).skip(1).find(|(scope, _)| scope.name.eq_ignore_ascii_case(name));
    match found {
        Some((_, scope)) => scope,
        None => {
            let hint = suggestion(name, body.scopes.iter().skip(1).map(|scope| scope.name.as_str()));
            context.error(item.block.place, format!("there is no instance {}{hint}", quoted(name)));
            item.scope
        }
    }
}

/// First, last and increment of numbers. Only existing ones are looked at, however many there could be.
fn generate(
    line: &DataLine,
    scope: u32,
    existing: &BTreeMap<(u32, i32), u32>,
    what: &str,
    context: &mut Context<'_>,
) -> Vec<u32> {
    let fields = context.fields(line);
    let mut numbers = Vec::new();
    for field in &fields {
        match context.integer(line.place, field) {
            Some(number) => numbers.push(number),
            None => return Vec::new(),
        }
    }
    let (first, last, increment) = match numbers[..] {
        [first] => (first, first, 1),
        [first, last] => (first, last, 1),
        [first, last, increment] => (first, last, if first == last { increment.max(1) } else { increment }),
        _ => (1, 0, 0),
    };
    if first < 1 || last < first || increment < 1 {
        context.error(
            line.place,
            "GENERATE takes the first number, the last, which is not smaller, and a positive increment",
        );
        return Vec::new();
    }
    let found: Vec<u32> = existing
        .range((scope, first)..=(scope, last))
        .filter(|((_, number), _)| (number - first) % increment == 0)
        .map(|(_, &index)| index)
        .collect();
    let wanted = ((last - first) / increment) as usize + 1;
    if found.len() < wanted {
        context.note(line.place, format!("of {wanted} generated {what} {} exist", found.len()));
    }
    found
}

/// Keywords whose data name nodes: a number or a set.
pub(super) fn nodes_of(sets: &AllSets, body: &Body, scope: u32, text: &str, block: &Block) -> Result<Vec<u32>, String> {
    match body.node(scope, text) {
        Some(Ok(NodeReference::Node(node))) => Ok(vec![node]),
        Some(Ok(NodeReference::Lone)) => Ok(Vec::new()),
        Some(Err(why)) => Err(format!("{}: {why}", block.written)),
        None => {
            let set = sets.nodes.get(body, scope, text, "node set");
            set.map(|set| set.members.clone()).map_err(|why| format!("{}: {why}", block.written))
        }
    }
}
