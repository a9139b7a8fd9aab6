//! Held and moved nodes, linear equations between displacements.

use std::collections::{BTreeMap, BTreeSet};

use pneuflex_model::{Curve, LinearEquation, Motion, Support};

use super::body::Body;
use super::cavities::is_pressure;
use super::context::Context;
use super::histories::{Histories, History, groups};
use super::outline::{Item, Outline};
use super::schedule::{Event, Times};
use super::sets::{AllSets, nodes_of};
use crate::mid_edges::MidEdges;
use crate::report::{Place, quoted};
use crate::syntax::DataLine;

/// Node and axis; of reference nodes rotations, too.
pub(super) type Component = (u32, u8);

/// Axes that are rotations.
pub(super) const ROTATIONS: std::ops::Range<u8> = 3..6;

/// Axes that a name holds.
const NAMED: [(&str, &[u8]); 5] = [
    ("PINNED", &[0, 1, 2]),
    ("ENCASTRE", &[0, 1, 2, 3, 4, 5]),
    ("XSYMM", &[0, 4, 5]),
    ("YSYMM", &[1, 3, 5]),
    ("ZSYMM", &[2, 3, 4]),
];

/// What supports are read from: the body and its sets, the steps, nodes that can turn.
#[derive(Clone, Copy)]
pub(super) struct Known<'a> {
    pub body: &'a Body,
    pub sets: &'a AllSets,
    pub times: &'a Times,
    pub turning: &'a BTreeSet<u32>,
}

/// Reads all `*BOUNDARY`.
pub(super) fn read_supports(
    outline: &Outline<'_>,
    known: Known<'_>,
    context: &mut Context<'_>,
) -> Histories<Component> {
    let Known { body, times, .. } = known;
    let mut held: Histories<Component> = BTreeMap::new();
    for item in outline.of_step("BOUNDARY", None) {
        read_block(item, known, &mut held, context);
    }
    for step in 0..times.steps.len() as u32 {
        let mut renewed: Option<Place> = None;
        for item in outline.of_step("BOUNDARY", Some(step)) {
            context.expect_word(item.block, "OP", &["MOD", "NEW"]);
            if item.block.word("OP").is_some_and(|word| word == "NEW") {
                renewed.get_or_insert(item.block.place);
            }
            read_block(item, known, &mut held, context);
        }
        let Some(place) = renewed else { continue };
        if step == 0 {
            held.retain(|_, history| history.last.is_some());
        } else if let Some(((node, _), _)) = held.iter().find(|(_, history)| history.last != Some(step)) {
            let text = format!(
                "*BOUNDARY, OP=NEW lets go of node {} (and maybe others), which was held before; supports cannot be let go of",
                body.node_name(*node)
            );
            context.error(place, text);
        }
    }
    held
}

fn read_block(
    item: Item<'_>,
    Known { body, sets, times, turning }: Known<'_>,
    held: &mut Histories<Component>,
    context: &mut Context<'_>,
) {
    context.expect_word(item.block, "TYPE", &["DISPLACEMENT"]);
    let amplitude = times.amplitude(item.block, context);
    for line in &item.block.lines {
        let fields = context.fields(line);
        let Some((&target, rest)) = fields.split_first() else { continue };
        if is_pressure(rest) {
            continue;
        }
        let nodes = match nodes_of(sets, body, item.scope, target, item.block) {
            Ok(nodes) => nodes,
            Err(why) => {
                context.error(line.place, why);
                continue;
            }
        };
        if nodes.is_empty() {
            context
                .note(line.place, format!("*BOUNDARY: {} holds no node of an element and is left out", quoted(target)));
        }
        let Some((axes, value)) = read_axes(line, rest, context) else { continue };
        let value = if times.is_absolute(amplitude) { 1.0 } else { value };
        if item.step.is_some_and(|step| !times.is_finite(&Event { step, value, amplitude })) {
            context.error(line.place, "the displacement is too large a number");
        }
        let name = if nodes.len() == 1 && body.node(item.scope, target).is_some() { "nodes" } else { target };
        let is_left_out = |node: u32, axis: u8| ROTATIONS.contains(&axis) && !turning.contains(&node);
        let is_named = fields.get(1).is_some_and(|field| field.starts_with(|c: char| c.is_alphabetic()));
        if !is_named && nodes.iter().any(|&node| axes.iter().any(|&axis| is_left_out(node, axis))) {
            context.note(line.place, "*BOUNDARY: nodes of solids have no rotations; directions 4 to 6 are left out");
        }
        for &node in &nodes {
            for &axis in axes.iter().filter(|axis| !is_left_out(node, **axis)) {
                let event = item.step.map(|step| Event { step, value, amplitude });
                if let Err(why) = hold(held, (node, axis), name, line.place, event, value) {
                    let text = format!("node {}, direction {}: {why}", body.node_name(node), axis + 1);
                    context.error(line.place, text);
                    return;
                }
            }
        }
    }
}

/// Axes from 0 and the value of a line: first and last degree of freedom and a value, or a name.
fn read_axes(line: &DataLine, rest: &[&str], context: &mut Context<'_>) -> Option<(Vec<u8>, f64)> {
    if let [name] = rest
        && let Some((_, axes)) = NAMED.iter().find(|(known, _)| known.eq_ignore_ascii_case(name))
    {
        return Some((axes.to_vec(), 0.0));
    }
    let [first, others @ ..] = rest else {
        context.error(
            line.place,
            "*BOUNDARY takes a node or a set, the first and last direction and a value, or a name such as PINNED",
        );
        return None;
    };
    if others.len() > 2 {
        context.error(line.place, "*BOUNDARY: too many entries");
        return None;
    }
    let is_name = first.starts_with(|c: char| c.is_alphabetic());
    if is_name {
        let names = NAMED.map(|(name, _)| name).join(", ");
        context.error(line.place, format!("{} is not supported, only directions 1 to 3 and {names}", quoted(first)));
        return None;
    }
    let first = context.integer(line.place, first)?;
    let last = match others.first() {
        None | Some(&"") => first,
        Some(text) => context.integer(line.place, text)?,
    };
    let value = context.real_or_zero(line.place, others.get(1))?;
    if first < 1 || last < first || last > 6 {
        context.error(line.place, format!("*BOUNDARY: directions {first} to {last} are not within 1 to 3"));
        return None;
    }
    Some(((first..=last).map(|direction| direction as u8 - 1).collect(), value))
}

fn hold(
    held: &mut Histories<Component>,
    component: Component,
    name: &str,
    place: Place,
    event: Option<Event>,
    value: f64,
) -> Result<(), String> {
    let is_new = !held.contains_key(&component);
    let history = held.entry(component).or_insert_with(|| History::new(name, place));
    let Some(event) = event else {
        return if value == 0.0 { Ok(()) } else { Err("a displacement other than 0 must stand in a step".to_owned()) };
    };
    if is_new && event.step > 0 {
        return Err(format!("it is held from step {} on; supports must hold from the first step on", event.step + 1));
    }
    let again = history.last == Some(event.step);
    history.last = Some(event.step);
    if let Some(first) = history.event(event.step) {
        return if *first == event {
            Ok(())
        } else {
            Err(format!("the step says two things of it, first in line {}", history.place.line))
        };
    }
    let is_nothing = event.value == 0.0;
    if again && !is_nothing {
        return Err(format!("the step says two things of it, first in line {}", history.place.line));
    }
    if !(is_nothing && history.is_zero_before(event.step)) {
        history.events.push(event);
    }
    history.place = place;
    Ok(())
}

/// Supports for the solver: nodes that are held alike along the same axes, by the names of their sets. Mid-edge nodes that were added are
/// held where both ends of their edge are held alike.
pub(super) fn supports(held: &Histories<Component>, times: &Times, mid_edges: Option<&MidEdges>) -> Vec<Support> {
    let mut found = Vec::new();
    for ((name, _), (components, history)) in groups(held) {
        let mut axes_of: BTreeMap<u32, [bool; 3]> = BTreeMap::new();
        for (node, axis) in components {
            axes_of.entry(node).or_default()[usize::from(axis)] = true;
        }
        if let Some(mid_edges) = mid_edges {
            for axis in 0..3 {
                for node in mid_edges.of(|node| axes_of.get(&node).is_some_and(|axes| axes[axis])) {
                    axes_of.entry(node).or_default()[axis] = true;
                }
            }
        }
        let mut by_axes: BTreeMap<[bool; 3], Vec<u32>> = BTreeMap::new();
        for (node, axes) in axes_of {
            by_axes.entry(axes).or_default().push(node);
        }
        let curve = times.curve(&history.events);
        let motion = (curve != Curve::ZERO).then_some(Motion { displacement: [1.0; 3], curve });
        let support = |(axes, nodes)| Support { name: name.clone(), nodes, axes, motion: motion.clone() };
        found.extend(by_axes.into_iter().map(support));
    }
    found
}

/// Reads all `*EQUATION`: Σ cᵢ uᵢ = 0.
pub(super) fn read_equations(
    outline: &Outline<'_>,
    body: &Body,
    sets: &AllSets,
    held: &Histories<Component>,
    context: &mut Context<'_>,
) -> Vec<LinearEquation> {
    let mut found = Vec::new();
    for item in outline.of("EQUATION") {
        let mut lines = item.block.lines.iter();
        while let Some(head) = lines.next() {
            let fields = context.fields(head);
            let Some(count) = fields.first().and_then(|text| context.integer(head.place, text)) else { break };
            let mut entries: Vec<(Place, &str)> = Vec::new();
            while entries.len() < 3 * count.max(0) as usize {
                let Some(line) = lines.next() else { break };
                entries.extend(context.fields(line).into_iter().map(|field| (line.place, field)));
            }
            if count < 1 || entries.len() != 3 * count as usize {
                context.error(
                    head.place,
                    "*EQUATION takes the number of terms, then node, direction and coefficient of each",
                );
                break;
            }
            let equations = equations(item, &entries, body, sets, context);
            for equation in &equations {
                let (node, axis, _) = equation.terms[0];
                if held.contains_key(&(node, axis)) {
                    let text = format!(
                        "the first term of the equation, node {} direction {}, is held by *BOUNDARY",
                        body.node_name(node),
                        axis + 1
                    );
                    context.error(head.place, text);
                }
            }
            found.extend(equations);
        }
    }
    if let (Some(item), true) = (outline.of("EQUATION").next(), body.first_added().is_some()) {
        context.note(
            item.block.place,
            "*EQUATION binds the nodes that it names; mid-edge nodes that were added stay free",
        );
    }
    found
}

/// The equations of one set of terms: one, or as many as the sets in it have nodes.
fn equations(
    item: Item<'_>,
    entries: &[(Place, &str)],
    body: &Body,
    sets: &AllSets,
    context: &mut Context<'_>,
) -> Vec<LinearEquation> {
    let mut terms: Vec<(Vec<u32>, u8, f64)> = Vec::new();
    for term in entries.chunks_exact(3) {
        let [(place, target), (_, direction), (_, coefficient)] = *term else { continue };
        let nodes = match nodes_of(sets, body, item.scope, target, item.block) {
            Ok(nodes) => nodes,
            Err(why) => {
                context.error(place, why);
                return Vec::new();
            }
        };
        let (Some(direction), Some(coefficient)) =
            (context.integer(place, direction), context.real(place, coefficient))
        else {
            return Vec::new();
        };
        if nodes.is_empty() {
            context.error(place, format!("*EQUATION: {} belongs to no element", quoted(target)));
            return Vec::new();
        }
        if !(1..=3).contains(&direction) || coefficient == 0.0 {
            context.error(place, "*EQUATION takes directions 1 to 3 and coefficients other than 0");
            return Vec::new();
        }
        terms.push((nodes, direction as u8 - 1, coefficient));
    }
    let count = terms.iter().map(|(nodes, ..)| nodes.len()).max().unwrap_or(0);
    if let (Some((place, _)), true) =
        (entries.first(), terms.iter().any(|(nodes, ..)| ![1, count].contains(&nodes.len())))
    {
        context.error(*place, "*EQUATION: sets in one equation must have the same number of nodes");
        return Vec::new();
    }
    let term = |(nodes, axis, coefficient): &(Vec<u32>, u8, f64), i: usize| {
        (if nodes.len() == 1 { nodes[0] } else { nodes[i] }, *axis, *coefficient)
    };
    (0..count)
        .map(|i| LinearEquation { terms: terms.iter().map(|t| term(t, i)).collect(), value: Curve::ZERO })
        .collect()
}
