//! Reference nodes: nodes that belong to no element but to a constraint, and have displacements for its sake.

use std::collections::BTreeSet;

use super::body::Number;
use super::context::Context;
use super::outline::{Item, Outline};
use crate::syntax::integer;

/// Sets of sets are followed this deep; deeper ones cannot be written down before they are used.
const DEEPEST: usize = 16;

/// The nodes that equations, rigid bodies, couplings and MPCs name, by number or set, in the deck's numbers. Sets of what exists are read
/// later, and what is wrong with these keywords is said where they are understood.
pub(super) fn nodes_of_constraints(outline: &Outline<'_>, context: &Context<'_>) -> BTreeSet<Number> {
    let mut found = BTreeSet::new();
    for item in &outline.items {
        let names: Vec<&str> = match item.block.keyword.as_str() {
            // Lines of terms begin with a node; the number of terms stands alone.
            "EQUATION" => {
                let lines = item.block.lines.iter().map(|line| context.fields(line)).filter(|fields| fields.len() > 1);
                lines.flat_map(|fields| fields.into_iter().step_by(3)).collect()
            }
            "MPC" => item.block.lines.iter().flat_map(|line| context.fields(line).into_iter().skip(1)).collect(),
            "RIGIDBODY" | "COUPLING" => {
                ["REFNODE", "ROTNODE"].iter().filter_map(|parameter| item.block.value(parameter)).collect()
            }
            _ => continue,
        };
        for name in names {
            add(outline, context, item.scope, name, DEEPEST, &mut found);
        }
    }
    found
}

/// The numbers of the nodes that a name stands for: a number, or a set.
pub(super) fn numbers_called(outline: &Outline<'_>, context: &Context<'_>, scope: u32, name: &str) -> BTreeSet<Number> {
    let mut found = BTreeSet::new();
    add(outline, context, scope, name, DEEPEST, &mut found);
    found
}

fn add(
    outline: &Outline<'_>,
    context: &Context<'_>,
    scope: u32,
    name: &str,
    depth: usize,
    found: &mut BTreeSet<Number>,
) {
    let of_instance = outline.scopes.iter().zip(0..).skip(1).find_map(|(known, number)| {
        let (head, rest) = name.split_once('.')?;
        head.eq_ignore_ascii_case(&known.name).then_some((number, rest))
    });
    let (scope, name) = of_instance.unwrap_or((scope, name));
    if let Ok(number) = integer(name) {
        found.insert((scope, number));
        return;
    }
    if depth == 0 {
        return;
    }
    let is_it = |item: &&Item<'_>| {
        let keyword = item.block.keyword.as_str();
        matches!(keyword, "NSET" | "NODE") && item.block.value("NSET").is_some_and(|set| set.eq_ignore_ascii_case(name))
    };
    for item in outline.items.iter().filter(is_it) {
        let instance = item.block.value("INSTANCE").and_then(|wanted| {
            outline.scopes.iter().zip(0..).skip(1).find(|(known, _)| known.name.eq_ignore_ascii_case(wanted))
        });
        let scope = instance.map_or(item.scope, |(_, number)| number);
        for line in &item.block.lines {
            let fields = context.fields(line);
            match fields[..] {
                [first, ..] if item.block.keyword == "NODE" => add(outline, context, scope, first, 0, found),
                [first, last, ..] if item.block.has("GENERATE") => {
                    let step = fields.get(2).and_then(|text| integer(text).ok()).unwrap_or(1).max(1);
                    if let (Ok(first), Ok(last)) = (integer(first), integer(last)) {
                        // A range may be written that is much longer than there are nodes; a set of references is short.
                        found.extend((first..=last).step_by(step as usize).take(1 << 20).map(|n| (scope, n)));
                    }
                }
                _ => fields.iter().for_each(|field| add(outline, context, scope, field, depth - 1, found)),
            }
        }
    }
}
