//! What couples nodes and surfaces beside `*EQUATION`: ties, rigid bodies, couplings, MPCs.

use std::collections::{BTreeMap, BTreeSet};

use pneuflex_mesh::Facet;
use pneuflex_mesh::vector::{norm, sub};
use pneuflex_model::{Curve, LinearEquation, Support, Tie};

use super::body::Body;
use super::boundary::{Component, ROTATIONS};
use super::context::Context;
use super::histories::Histories;
use super::outline::{Item, Outline};
use super::rigid::bind;
use super::sets::{AllSets, nodes_of};
use crate::mid_edges::MidEdges;
use crate::report::{Place, quoted};
use crate::syntax::DataLine;

/// A reference node that further from the middle of its surface than this share of the surface's size is not in it.
const OFF_CENTRE: f64 = 1e-6;

/// Types of `*MPC`.
const MPCS: [&str; 4] = ["BEAM", "LINK", "PIN", "TIE"];

/// Nodes that move with a reference node.
#[derive(Debug)]
struct RigidBody {
    place: Place,
    reference: u32,
    others: BTreeSet<u32>,
    /// Directions in which they follow.
    axes: [bool; 3],
    /// The node whose displacements are rotations.
    rotation_node: Option<u32>,
}

/// All constraints of a deck but its equations.
#[derive(Debug, Default)]
pub(super) struct Constraints {
    bodies: Vec<RigidBody>,
    /// Reference nodes that are the mean of a surface, which nothing turns.
    means: Vec<(u32, Place)>,
    pub equations: Vec<LinearEquation>,
    pub distances: Vec<[u32; 2]>,
    pub ties: Vec<Tie>,
}

impl Constraints {
    pub fn read(
        outline: &Outline<'_>,
        body: &Body,
        sets: &AllSets,
        mid_edges: Option<&MidEdges>,
        context: &mut Context<'_>,
    ) -> Self {
        let mut found = Self::default();
        for (number, item) in outline.items.iter().enumerate() {
            match item.block.keyword.as_str() {
                "TIE" => found.tie(*item, body, sets, context),
                "RIGIDBODY" => found.rigid_body(*item, body, sets, mid_edges, context),
                "COUPLING" => {
                    let kinds = outline.items.iter().filter(|kind| kind.owner == Some(number));
                    found.coupling(*item, &kinds.copied().collect::<Vec<_>>(), body, sets, context);
                }
                "MPC" => found.mpc(*item, body, sets, context),
                _ => {}
            }
        }
        found
    }

    /// Nodes whose directions 4 to 6 are the rotations of what they carry.
    pub fn turning(&self) -> BTreeSet<u32> {
        self.bodies.iter().map(|body| body.reference).chain(self.means.iter().map(|mean| mean.0)).collect()
    }

    /// Equations and distances of the rigid bodies, once it is known what is held; what is held of rotations is taken out of that.
    pub fn bind(&mut self, body: &Body, held: &mut Histories<Component>, context: &mut Context<'_>) {
        for rigid in &self.bodies {
            // CalculiX writes rotations as displacements of a node of their own.
            if let Some(node) = rigid.rotation_node {
                for axis in 0..3 {
                    if let Some(history) = held.remove(&(node, axis)) {
                        held.insert((rigid.reference, ROTATIONS.start + axis), history);
                    }
                }
            }
        }
        for (&(node, axis), history) in held.range(..).filter(|((_, axis), _)| ROTATIONS.contains(axis)) {
            if history.events.iter().any(|event| event.value != 0.0 || event.amplitude.is_some()) {
                let text = format!(
                    "node {}, direction {}: rotations can be held, not prescribed; move nodes of the body instead",
                    body.node_name(node),
                    axis + 1
                );
                context.error(history.place, text);
            }
        }
        for (reference, place) in &self.means {
            if ROTATIONS.clone().any(|axis| held.contains_key(&(*reference, axis))) {
                let text = "*DISTRIBUTING: the mean rotation of a surface cannot be held; *KINEMATIC holds all of it";
                context.error(*place, text);
            }
        }
        for rigid in std::mem::take(&mut self.bodies) {
            let RigidBody { place, reference, others, axes, .. } = rigid;
            let rotations: [bool; 3] =
                std::array::from_fn(|k| held.contains_key(&(reference, ROTATIONS.start + k as u8)));
            // Along an axis all nodes move as the reference does unless they turn about another.
            let goes_straight = |axis: u8| (0..3_u8).all(|about| about == axis || rotations[usize::from(about)]);
            let held_alike = |node: u32, axis: u8| {
                let key = |node| held.get(&(node, axis)).map(|history| history.key().1);
                goes_straight(axis) && key(node) == key(reference)
            };
            let dofs = others.iter().flat_map(|&node| (0..3).map(move |axis| (node, axis)));
            let held_of_others: Vec<Component> =
                dofs.filter(|dof| axes[usize::from(dof.1)] && held.contains_key(dof)).collect();
            if let Some((node, axis)) = held_of_others.iter().find(|(node, axis)| !held_alike(*node, *axis)) {
                let text = format!(
                    "node {} is held in direction {} and belongs to a rigid body: hold the reference node {} instead, and its \
                     rotations (4 to 6)",
                    body.node_name(*node),
                    axis + 1,
                    body.node_name(reference)
                );
                context.error(held[&(*node, *axis)].place, text);
                continue;
            }
            let nodes: Vec<u32> = std::iter::once(reference).chain(others).collect();
            match bind(&body.mesh.nodes, &nodes, axes, rotations) {
                Ok(bound) => {
                    let is_held = |e: &LinearEquation| held_of_others.contains(&(e.terms[0].0, e.terms[0].1));
                    self.equations.extend(bound.equations.into_iter().filter(|equation| !is_held(equation)));
                    self.distances.extend(bound.distances);
                }
                Err(why) => context.error(place, why),
            }
        }
        held.retain(|(_, axis), _| !ROTATIONS.contains(axis));
    }

    /// Directions of reference nodes that nothing is coupled to, which are held for the equations to have a solution; an error for forces
    /// on them.
    pub fn idle(
        &self,
        body: &Body,
        held: &Histories<Component>,
        equations: &[LinearEquation],
        forces: &[(Component, Place)],
        context: &mut Context<'_>,
    ) -> Vec<Support> {
        let mut coupled: BTreeSet<Component> =
            equations.iter().flat_map(|equation| &equation.terms).map(|term| (term.0, term.1)).collect();
        coupled.extend(self.distances.iter().flatten().flat_map(|&node| (0..3).map(move |axis| (node, axis))));
        coupled.extend(held.keys().copied());
        let mut by_axes: BTreeMap<[bool; 3], Vec<u32>> = BTreeMap::new();
        for &node in &body.references {
            let axes: [bool; 3] = std::array::from_fn(|k| !coupled.contains(&(node, k as u8)));
            by_axes.entry(axes).or_default().push(node);
            for ((_, axis), place) in forces.iter().filter(|((of, axis), _)| *of == node && axes[usize::from(*axis)]) {
                let text = format!(
                    "*CLOAD: nothing takes a force on node {} in direction {}; moments are not solved: let a pair of forces act",
                    body.node_name(node),
                    axis + 1
                );
                context.error(*place, text);
            }
        }
        by_axes.remove(&[false; 3]);
        let name = "REFERENCE NODES".to_owned();
        by_axes.into_iter().map(|(axes, nodes)| Support { name: name.clone(), nodes, axes, motion: None }).collect()
    }

    fn tie(&mut self, item: Item<'_>, body: &Body, sets: &AllSets, context: &mut Context<'_>) {
        context.expect_word(item.block, "TYPE", &["SURFACETOSURFACE", "NODETOSURFACE"]);
        context.expect_word(item.block, "ADJUST", &["YES", "NO"]);
        if item.block.word("ADJUST").is_none_or(|word| word != "NO") {
            context.note(
                item.block.place,
                "*TIE: surfaces are glued where they are; no node is moved onto the other surface",
            );
        }
        let tolerance = item.block.value("POSITIONTOLERANCE").and_then(|text| context.real(item.block.place, text));
        for line in &item.block.lines {
            let [slave, master] = context.fields(line)[..] else {
                context.error(line.place, "*TIE takes a slave and a master surface");
                continue;
            };
            let mut surface = |name: &str| faces(item, line.place, name, body, sets, context);
            let (Some(slave_faces), Some(master_faces)) = (surface(slave), surface(master)) else { continue };
            let name = format!("{slave} to {master}");
            self.ties.push(Tie { name, slave: slave_faces, master: master_faces, tolerance });
        }
    }

    fn rigid_body(
        &mut self,
        item: Item<'_>,
        body: &Body,
        sets: &AllSets,
        mid_edges: Option<&MidEdges>,
        context: &mut Context<'_>,
    ) {
        let Some(reference) = the_node(item, "REFNODE", body, sets, context) else { return };
        let rotation_node = match item.block.value("ROTNODE") {
            None => None,
            Some(_) => match the_node(item, "ROTNODE", body, sets, context) {
                Some(node) => Some(node),
                None => return,
            },
        };
        if let Some(node) = rotation_node.filter(|node| !body.references.contains(node)) {
            let text =
                format!("*RIGID BODY: ROT NODE {} belongs to an element; take a node of its own", body.node_name(node));
            return context.error(item.block.place, text);
        }
        let mut others = BTreeSet::new();
        for parameter in ["NSET", "TIENSET", "PINNSET"] {
            let Some(name) = item.block.value(parameter) else { continue };
            match sets.nodes.get(body, item.scope, name, "node set") {
                Ok(set) => {
                    others.extend(&set.members);
                    let is_member = |node| set.members.binary_search(&node).is_ok() || set.members.contains(&node);
                    others.extend(mid_edges.map_or(Vec::new(), |mid_edges| mid_edges.of(is_member)));
                }
                Err(why) => context.error(item.block.place, format!("{}: {why}", item.block.written)),
            }
        }
        if let Some(name) = item.block.value("ELSET") {
            match sets.elements.get(body, item.scope, name, "element set") {
                Ok(set) => others.extend(set.members.iter().flat_map(|&element| body.mesh.element(element as usize))),
                Err(why) => context.error(item.block.place, format!("{}: {why}", item.block.written)),
            }
        }
        others.remove(&reference);
        if others.is_empty() {
            context.error(item.block.place, "*RIGID BODY needs NSET= or ELSET= with nodes of the body");
        }
        self.bodies.push(RigidBody { place: item.block.place, reference, others, axes: [true; 3], rotation_node });
    }

    fn coupling(&mut self, item: Item<'_>, kinds: &[Item<'_>], body: &Body, sets: &AllSets, context: &mut Context<'_>) {
        let place = item.block.place;
        let [kind] = kinds else {
            return context.error(place, "*COUPLING must be followed by one *KINEMATIC or *DISTRIBUTING");
        };
        let Some(reference) = the_node(item, "REFNODE", body, sets, context) else { return };
        let Some(name) = context.required(item.block, "SURFACE") else { return };
        let Some(facets) = faces(item, place, name, body, sets, context) else { return };
        let Some(axes) = directions(&kind.block.lines, context) else { return };
        if kind.block.keyword == "KINEMATIC" {
            let mut others: BTreeSet<u32> = facets.iter().flat_map(|&facet| body.mesh.facet_nodes(facet)).collect();
            others.remove(&reference);
            self.bodies.push(RigidBody { place, reference, others, axes, rotation_node: None });
            return;
        }
        context.expect_word(kind.block, "WEIGHTINGMETHOD", &["UNIFORM"]);
        context.note(place, "*DISTRIBUTING: the reference node moves as the mean of the surface, by area; forces on it are spread alike");
        let shares: BTreeMap<u32, f64> = body.mesh.shares_of_faces(&facets).into_iter().collect();
        let at = |node: u32| body.mesh.nodes[node as usize];
        let centre: [f64; 3] = std::array::from_fn(|k| shares.iter().map(|(&node, share)| share * at(node)[k]).sum());
        let distance = |x: [f64; 3]| norm(sub(x, centre));
        let size = shares.keys().map(|&node| distance(at(node))).fold(0.0, f64::max);
        let away = distance(at(reference));
        if away > OFF_CENTRE * size || shares.contains_key(&reference) {
            let [x, y, z] = centre;
            let text = format!(
                "*DISTRIBUTING: the reference node {} lies {away:.4} mm away from the middle of the surface, ({x:.6}, {y:.6}, {z:.6}): put a \
                 node of its own there, or use *KINEMATIC; the mean of a surface that turns says nothing of other points",
                body.node_name(reference)
            );
            return context.error(place, text);
        }
        self.means.push((reference, place));
        for axis in (0..3_u8).filter(|axis| axes[usize::from(*axis)]) {
            let terms = shares.iter().filter(|(_, share)| **share != 0.0).map(|(&node, share)| (node, axis, -share));
            let terms = std::iter::once((reference, axis, 1.0)).chain(terms).collect();
            self.equations.push(LinearEquation { terms, value: Curve::ZERO });
        }
    }

    fn mpc(&mut self, item: Item<'_>, body: &Body, sets: &AllSets, context: &mut Context<'_>) {
        for line in &item.block.lines {
            let fields = context.fields(line);
            let kind = fields.first().map_or(String::new(), |kind| kind.to_uppercase());
            if !MPCS.contains(&kind.as_str()) {
                let text = format!(
                    "*MPC: {} is not supported, only {}; *EQUATION, *COUPLING and *RIGID BODY couple nodes, too",
                    quoted(&kind),
                    MPCS.join(", ")
                );
                context.error(line.place, text);
                continue;
            }
            let [_, first, second] = fields[..] else {
                context.error(line.place, "*MPC takes a type and two nodes or sets");
                continue;
            };
            let mut nodes = |text| match nodes_of(sets, body, item.scope, text, item.block) {
                Ok(nodes) => nodes,
                Err(why) => {
                    context.error(line.place, why);
                    Vec::new()
                }
            };
            let (first, second) = (nodes(first), nodes(second));
            if first.is_empty() || ![1, first.len()].contains(&second.len()) {
                context.error(
                    line.place,
                    "*MPC: the second set must have one node or as many as the first, and both must have some",
                );
                continue;
            }
            for (i, &node) in first.iter().enumerate() {
                let other = second[if second.len() == 1 { 0 } else { i }];
                if other == node {
                    continue;
                }
                match kind.as_str() {
                    "PIN" | "TIE" => self.equations.extend((0..3).map(|axis| LinearEquation {
                        terms: vec![(node, axis, 1.0), (other, axis, -1.0)],
                        value: Curve::ZERO,
                    })),
                    "BEAM" if body.references.contains(&other) => self.beam(line.place, node, other, context),
                    "BEAM" | "LINK" if body.mesh.nodes[node as usize] != body.mesh.nodes[other as usize] => {
                        self.distances.push([node, other]);
                    }
                    _ => {
                        context.error(line.place, "*MPC: the two nodes are at one place; use PIN");
                        break;
                    }
                }
            }
        }
    }

    /// All beams at a reference node are one rigid body.
    fn beam(&mut self, place: Place, node: u32, reference: u32, context: &mut Context<'_>) {
        let text = "*MPC, BEAM: nodes that beams join to one reference node move with it as a rigid body";
        context.note(place, text);
        match self.bodies.iter_mut().find(|body| body.reference == reference && body.rotation_node.is_none()) {
            Some(body) => {
                body.others.insert(node);
            }
            None => {
                let others = BTreeSet::from([node]);
                self.bodies.push(RigidBody { place, reference, others, axes: [true; 3], rotation_node: None });
            }
        }
    }
}

fn faces(
    item: Item<'_>,
    place: Place,
    name: &str,
    body: &Body,
    sets: &AllSets,
    context: &mut Context<'_>,
) -> Option<Vec<Facet>> {
    match sets.surfaces.get(body, item.scope, name, "surface") {
        Ok(set) => Some(set.members.clone()),
        Err(why) => {
            context.error(place, format!("{}: {why}", item.block.written));
            None
        }
    }
}

/// The one node of a parameter, by number or by the name of a set.
fn the_node(item: Item<'_>, parameter: &str, body: &Body, sets: &AllSets, context: &mut Context<'_>) -> Option<u32> {
    let name = context.required(item.block, parameter)?;
    match nodes_of(sets, body, item.scope, name, item.block) {
        Ok(nodes) if nodes.len() == 1 => Some(nodes[0]),
        Ok(_) => {
            context.error(item.block.place, format!("{}: {} is not one node", item.block.written, quoted(name)));
            None
        }
        Err(why) => {
            context.error(item.block.place, why);
            None
        }
    }
}

/// Directions 1 to 3 of lines with a first and a last one; all without lines. Nodes of solids have no others.
fn directions(lines: &[DataLine], context: &mut Context<'_>) -> Option<[bool; 3]> {
    if lines.is_empty() {
        return Some([true; 3]);
    }
    let mut axes = [false; 3];
    for line in lines {
        let fields = context.fields(line);
        let [first, rest @ ..] = &fields[..] else { continue };
        let first = context.integer(line.place, first)?;
        let last = rest.first().map_or(Some(first), |text| context.integer(line.place, text))?;
        if rest.len() > 1 || first < 1 || last < first || last > 6 {
            context.error(line.place, "a coupling takes a first and a last direction, from 1 to 6");
            return None;
        }
        (first..=last).filter(|direction| *direction <= 3).for_each(|direction| axes[direction as usize - 1] = true);
    }
    Some(axes)
}
