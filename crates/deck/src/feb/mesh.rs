//! `<Mesh>` and `<MeshDomains>`: nodes, elements, and the sets that are named.

use std::collections::BTreeMap;

use pneuflex_mesh::{ElementKind, Facet, Mesh};

use super::xml::{Node, Reader, children, elements, text};
use crate::mid_edges::MidEdges;
use crate::raw_mesh::{Corners, Form, MeshFile, RawElement, RawMesh, faces_by_corners};
use crate::report::{quoted, suggestion};

/// The mesh, and what names stand for.
pub(super) struct Body {
    pub mesh: Mesh,
    /// Numbers of the file: of nodes that were added there are none.
    pub node_tags: Vec<Option<u64>>,
    pub element_tags: Vec<u64>,
    /// Elements of each part, in the order of the file.
    pub domains: Vec<(String, Vec<u32>)>,
    pub surfaces: BTreeMap<String, Surface>,
    /// Primary and secondary surface.
    pub pairs: BTreeMap<String, [String; 2]>,
}

/// Faces of the body.
pub(super) struct Surface {
    pub facets: Vec<Facet>,
    /// How many of them the file has with the normal into the body.
    pub num_inward: usize,
}

impl Body {
    pub fn read(section: Node<'_, '_>, reader: &mut Reader<'_>) -> Option<Self> {
        const NAMED: [&str; 10] = [
            "Nodes",
            "Elements",
            "NodeSet",
            "Surface",
            "ElementSet",
            "SurfacePair",
            "PartList",
            "Edge",
            "FacetSet",
            "DiscreteSet",
        ];
        reader.only(section, &NAMED);
        let mut raw = RawMesh::default();
        for node in children(section, "Nodes").flat_map(elements) {
            let (Some(tag), Some(position)) = (reader.id(node), reader.reals(node)) else { continue };
            let Ok(position) = <[f64; 3]>::try_from(position) else {
                reader.error(node, "a node takes three coordinates");
                continue;
            };
            if raw.nodes.insert(tag, position).is_some() {
                reader.error(node, format!("node {tag} is there twice"));
            }
        }
        let mut domains: Vec<(String, Vec<u32>)> = Vec::new();
        for part in children(section, "Elements") {
            let name = part.attribute("name").map_or_else(|| format!("Part{}", domains.len() + 1), str::to_owned);
            let Some(form) = reader.required(part, "type").and_then(|kind| form(part, kind, reader)) else { continue };
            let first = raw.elements.len() as u32;
            for node in elements(part) {
                let Some(tag) = reader.id(node) else { continue };
                let nodes = reader.tags(node);
                let line = reader.place(node).line;
                match nodes_in_our_order(form, nodes, &raw.nodes) {
                    Ok(nodes) => raw.elements.push(RawElement { tag, form, group: 0, nodes, line }),
                    Err(why) => reader.error(node, format!("element {tag}: {why}")),
                }
            }
            domains.push((name, (first..raw.elements.len() as u32).collect()));
        }
        if reader.report.has_errors() {
            return None;
        }
        let MeshFile { mesh, node_tags, element_tags, .. } = raw.build(reader.report)?;
        let mut body =
            Self { mesh, node_tags, element_tags, domains, surfaces: BTreeMap::new(), pairs: BTreeMap::new() };
        body.name_sets(section, reader);
        Some(body)
    }

    fn name_sets(&mut self, section: Node<'_, '_>, reader: &mut Reader<'_>) {
        let node_of: BTreeMap<u64, u32> =
            self.node_tags.iter().zip(0..).filter_map(|(tag, node)| tag.map(|tag| (tag, node))).collect();
        let element_of: BTreeMap<u64, u32> = self.element_tags.iter().copied().zip(0..).collect();
        let first_added = node_of.len() as u32;
        let mid_edges = (first_added < self.mesh.num_nodes() as u32).then(|| MidEdges::new(&self.mesh, first_added));
        let listed = |node: Node<'_, '_>, reader: &mut Reader<'_>, known: &BTreeMap<u64, u32>| -> Vec<u32> {
            // One element per member, or all as a text.
            let mut tags: Vec<u64> = elements(node).filter_map(|member| reader.id(member)).collect();
            tags.extend(reader.tags(node));
            let mut found: Vec<u32> = tags.iter().filter_map(|tag| known.get(tag).copied()).collect();
            if found.len() < tags.len() {
                let name = node.attribute("name").unwrap_or_default();
                reader.note(node, format!("{}: what belongs to no element is left out", quoted(name)));
            }
            found.sort_unstable();
            found.dedup();
            found
        };
        for node in children(section, "NodeSet") {
            let Some(name) = reader.required(node, "name") else { continue };
            let mut nodes = listed(node, reader, &node_of);
            if let Some(mid_edges) = &mid_edges {
                let added = mid_edges.of(|node| nodes.binary_search(&node).is_ok());
                nodes.extend(added);
            }
            self.mesh.node_sets.insert(name.to_owned(), nodes);
        }
        for node in children(section, "ElementSet") {
            let Some(name) = reader.required(node, "name") else { continue };
            let members = listed(node, reader, &element_of);
            self.mesh.element_sets.insert(name.to_owned(), members);
        }
        for (name, members) in &self.domains {
            self.mesh.element_sets.entry(name.clone()).or_insert_with(|| members.clone());
        }
        let faces = faces_by_corners(&self.mesh);
        for node in children(section, "Surface") {
            let Some(name) = reader.required(node, "name") else { continue };
            let surface = self.surface(node, &node_of, &faces, reader);
            self.mesh.facet_sets.insert(name.to_owned(), surface.facets.clone());
            self.surfaces.insert(name.to_owned(), surface);
        }
        for node in children(section, "SurfacePair") {
            let Some(name) = reader.required(node, "name") else { continue };
            let sides = ["primary", "secondary"].map(|side| reader.required_child(node, side));
            if let [Some(primary), Some(secondary)] = sides {
                self.pairs.insert(name.to_owned(), [primary, secondary].map(|side| text(side).to_owned()));
            }
        }
    }

    fn surface(
        &self,
        node: Node<'_, '_>,
        node_of: &BTreeMap<u64, u32>,
        faces: &Corners<Facet>,
        reader: &mut Reader<'_>,
    ) -> Surface {
        let mut surface = Surface { facets: Vec::new(), num_inward: 0 };
        for face in elements(node) {
            let corners = if face.tag_name().name().starts_with("tri") { 3 } else { 4 };
            let tags = reader.tags(face);
            let given: Option<Vec<u32>> =
                tags.get(..corners).and_then(|tags| tags.iter().map(|tag| node_of.get(tag).copied()).collect());
            let Some(given) = given else {
                reader.error(face, "a face takes its corners first, nodes of elements of the body");
                continue;
            };
            let mut key = given.clone();
            key.sort_unstable();
            let candidates = faces.get(&key).map_or(&[][..], Vec::as_slice);
            let is_outward = |facet: &&Facet| {
                let own = &self.mesh.facet_nodes(**facet)[..corners];
                own.iter().position(|node| *node == given[0]).is_some_and(|at| own[(at + 1) % corners] == given[1])
            };
            // Between two elements the normal tells which one is meant.
            match candidates.iter().find(is_outward).or(candidates.first()) {
                Some(facet) => {
                    surface.num_inward += usize::from(!is_outward(&facet));
                    surface.facets.push(*facet);
                }
                None => reader.error(face, "the face belongs to no element of the body"),
            }
        }
        surface.facets.sort_unstable();
        surface.facets.dedup();
        surface
    }

    /// The surface that an attribute names.
    pub fn surface_called(&self, node: Node<'_, '_>, name: &str, reader: &mut Reader<'_>) -> Option<&Surface> {
        let found = self.surfaces.get(name);
        if found.is_none() {
            let hint = suggestion(name, self.surfaces.keys().map(String::as_str));
            reader.error(node, format!("there is no surface {}{hint}", quoted(name)));
        }
        if found.is_some_and(|surface| surface.facets.is_empty()) {
            reader.error(node, format!("surface {} has no faces", quoted(name)));
        }
        found
    }

    /// The nodes that the attribute `node_set` names: a set, or `@surface:` and a surface.
    pub fn nodes_of(&self, node: Node<'_, '_>, reader: &mut Reader<'_>) -> Option<Vec<u32>> {
        let name = reader.required(node, "node_set")?;
        if let Some(surface) = name.strip_prefix("@surface:") {
            let facets = &self.surface_called(node, surface, reader)?.facets;
            let mut nodes: Vec<u32> = facets.iter().flat_map(|&facet| self.mesh.facet_nodes(facet)).collect();
            nodes.sort_unstable();
            nodes.dedup();
            return Some(nodes);
        }
        let found = self.mesh.node_sets.get(name);
        match found {
            None => {
                let hint = suggestion(name, self.mesh.node_sets.keys().map(String::as_str));
                reader.error(node, format!("there is no node set {}{hint}", quoted(name)));
            }
            Some(nodes) if nodes.is_empty() => {
                reader.error(node, format!("node set {} has no node of an element", quoted(name)));
            }
            Some(_) => {}
        }
        found.cloned()
    }

    /// Material of every part: its number among `names`.
    pub fn sections(&self, domains: Node<'_, '_>, names: &[&str], reader: &mut Reader<'_>) -> Vec<(usize, Vec<u32>)> {
        reader.only(domains, &["SolidDomain"]);
        let mut found: Vec<(usize, Vec<u32>)> = Vec::new();
        let mut is_made: Vec<bool> = vec![false; self.domains.len()];
        for node in children(domains, "SolidDomain") {
            let (Some(name), Some(material)) = (reader.required(node, "name"), reader.required(node, "mat")) else {
                continue;
            };
            let part = self.domains.iter().position(|(known, _)| known == name);
            let number = names.iter().position(|known| *known == material);
            let (Some(part), Some(number)) = (part, number) else {
                let parts = self.domains.iter().map(|(name, _)| name.as_str());
                let text = match part {
                    None => format!("there is no part {}{}", quoted(name), suggestion(name, parts)),
                    Some(_) => {
                        format!(
                            "there is no material {}{}",
                            quoted(material),
                            suggestion(material, names.iter().copied())
                        )
                    }
                };
                reader.error(node, text);
                continue;
            };
            is_made[part] = true;
            let members = &self.domains[part].1;
            match found.iter_mut().find(|(known, _)| *known == number) {
                Some((_, elements)) => elements.extend(members),
                None => found.push((number, members.clone())),
            }
        }
        for ((name, _), _) in self.domains.iter().zip(is_made).filter(|(_, is_made)| !is_made) {
            reader.error(domains, format!("part {} has no <SolidDomain>", quoted(name)));
        }
        found
    }
}

/// What FEBio's name of an element stands for.
fn form(part: Node<'_, '_>, kind: &str, reader: &mut Reader<'_>) -> Option<Form> {
    Some(match kind {
        "hex8" => Form::Solid(ElementKind::Hex8, false),
        "hex20" => Form::Solid(ElementKind::Hex20, false),
        "hex27" => Form::Solid(ElementKind::Hex27, false),
        "tet4" => Form::Solid(ElementKind::Tet10, true),
        "tet10" => Form::Solid(ElementKind::Tet10, false),
        "tet15" => Form::Solid(ElementKind::Tet15, false),
        "penta6" => Form::Solid(ElementKind::Wedge15, true),
        "penta15" => Form::Solid(ElementKind::Wedge15, false),
        _ => {
            let text = format!(
                "elements {} are not solved, only hex8, hex20, hex27, tet4, tet10, tet15, penta6 and penta15",
                quoted(kind)
            );
            reader.error(part, text);
            return None;
        }
    })
}

/// Corners and nodes on edges have the order of all programs; those in faces and inside are told by where they lie.
fn nodes_in_our_order(form: Form, nodes: Vec<u64>, positions: &BTreeMap<u64, [f64; 3]>) -> Result<Vec<u64>, String> {
    let Form::Solid(kind, is_linear) = form else { return Ok(nodes) };
    let count = if is_linear { kind.num_corners() } else { kind.num_nodes() };
    if nodes.len() != count {
        return Err(format!("it has {} nodes instead of {count}", nodes.len()));
    }
    let Some(missing) = nodes.iter().find(|tag| !positions.contains_key(tag)) else {
        let first = kind.num_corners() + kind.edges().len();
        if is_linear || count <= first {
            return Ok(nodes);
        }
        let at = |tag: u64| positions[&tag];
        let mean = |corners: &mut dyn Iterator<Item = usize>| -> [f64; 3] {
            let all: Vec<[f64; 3]> = corners.map(|corner| at(nodes[corner])).collect();
            std::array::from_fn(|d| all.iter().map(|x| x[d]).sum::<f64>() / all.len() as f64)
        };
        let face_of = |place: usize| (0..kind.num_faces()).find(|face| kind.face_nodes(*face).last() == Some(&place));
        let middle = |place: usize| match face_of(place) {
            Some(face) => {
                let corners = kind.face_kind(face).num_corners();
                mean(&mut kind.face_nodes(face)[..corners].iter().copied())
            }
            None => mean(&mut (0..kind.num_corners())),
        };
        let mut sorted = nodes[..first].to_vec();
        for place in first..count {
            let wanted = middle(place);
            let distance = |tag: u64| (0..3).map(|d| (at(tag)[d] - wanted[d]).powi(2)).sum::<f64>();
            let nearest = nodes[first..].iter().copied().min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
            sorted.extend(nearest);
        }
        let mut all = sorted.clone();
        all.sort_unstable();
        all.dedup();
        return if all.len() == count {
            Ok(sorted)
        } else {
            Err("its last nodes do not lie in the middle of its faces and inside of it, one in each".to_owned())
        };
    };
    Err(format!("there is no node {missing}"))
}

/// Whether a set of faces is taken with its normals as they are, or all turned.
pub(super) fn side(node: Node<'_, '_>, surface: &Surface, reader: &mut Reader<'_>) -> f64 {
    if surface.num_inward == 0 {
        return 1.0;
    }
    if surface.num_inward < surface.facets.len() {
        reader.error(node, "some faces of the surface have their normal out of the body and some into it");
    }
    -1.0
}
