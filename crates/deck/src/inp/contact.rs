//! Pairs of surfaces that may touch.

use std::collections::BTreeMap;

use pneuflex_mesh::Facet;
use pneuflex_model::{Contact, ContactMethod, ContactPair};

use super::body::Body;
use super::context::Context;
use super::outline::{Item, Outline};
use super::sets::AllSets;
use crate::report::{Place, quoted, suggestion};
use crate::syntax::Block;

/// How surfaces push each other away.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Behaviour {
    /// Penalty stiffness, N/mm³.
    Linear(f64),
    Hard,
}

/// Reads `*SURFACE INTERACTION` and `*CONTACT PAIR`. `hard` is the stiffness in N/mm³ that stands for hard contact on a list of faces.
pub(super) fn read_contact(
    outline: &Outline<'_>,
    body: &Body,
    sets: &AllSets,
    hard: impl Fn(&[Facet]) -> f64,
    context: &mut Context<'_>,
) -> (Contact, Vec<ContactPair>) {
    let interactions = read_interactions(outline, context);
    let mut pairs = Vec::new();
    for item in outline.of("CONTACTPAIR") {
        check_parameters(item.block, context);
        let Some(name) = context.required(item.block, "INTERACTION") else { continue };
        let Some(&behaviour) = interactions.get(&name.to_uppercase()) else {
            let hint = suggestion(name, interactions.keys().map(String::as_str));
            context.error(item.block.place, format!("there is no surface interaction {}{hint}", quoted(name)));
            continue;
        };
        for line in &item.block.lines {
            let Some(mut pair) = read_pair(item, line.place, &context.fields(line), body, sets, context) else {
                continue;
            };
            let stiffness = match behaviour {
                Behaviour::Linear(stiffness) => stiffness,
                Behaviour::Hard => hard(&pair.slave),
            };
            if behaviour == Behaviour::Hard {
                let text = format!(
                    "hard contact of {} is a penalty of {stiffness:.4} N/mm3: surfaces under the pressure p overlap by p/{stiffness:.4} mm",
                    pair.name
                );
                context.note(line.place, text);
            }
            pair.stiffness = Some(stiffness);
            pairs.push(pair);
        }
    }
    let stiffest = pairs.iter().filter_map(|pair| pair.stiffness).reduce(f64::max);
    let contact = match stiffest {
        Some(stiffness) => Contact { stiffness, ..Contact::default() },
        None => Contact { method: ContactMethod::None, ..Contact::default() },
    };
    (contact, pairs)
}

fn read_interactions(outline: &Outline<'_>, context: &mut Context<'_>) -> BTreeMap<String, Behaviour> {
    let mut found = BTreeMap::new();
    for (number, item) in outline.items.iter().enumerate() {
        if item.block.keyword != "SURFACEINTERACTION" {
            continue;
        }
        let Some(name) = context.required(item.block, "NAME") else { continue };
        let mut behaviour = Behaviour::Hard;
        for owned in outline.items.iter().filter(|item| item.owner == Some(number)) {
            match owned.block.keyword.as_str() {
                "FRICTION" => check_friction(owned.block, context),
                _ => behaviour = read_behaviour(owned.block, context).unwrap_or(behaviour),
            }
        }
        if found.insert(name.to_uppercase(), behaviour).is_some() {
            context.error(item.block.place, format!("surface interaction {} is there twice", quoted(name)));
        }
    }
    found
}

fn check_friction(block: &Block, context: &mut Context<'_>) {
    let coefficient = context.numbers(block).and_then(|numbers| numbers.first().copied());
    if coefficient != Some(0.0) {
        context.error(block.place, "*FRICTION: contact is without friction; only the coefficient 0 is supported");
    }
}

fn read_behaviour(block: &Block, context: &mut Context<'_>) -> Option<Behaviour> {
    if block.has("NOSEPARATION") {
        context.error(block.place, format!("{}: NO SEPARATION is not supported", block.written));
        return None;
    }
    context.expect_word(block, "PRESSURE-OVERCLOSURE", &["HARD", "LINEAR"]);
    if block.word("PRESSURE-OVERCLOSURE").is_none_or(|word| word != "LINEAR") {
        return Some(Behaviour::Hard);
    }
    let numbers = context.numbers(block)?;
    let stiffness = numbers.first().copied().unwrap_or(0.0);
    if numbers.len() > 1 {
        context.note(
            block.place,
            format!("{}: LINEAR pushes only where surfaces overlap; further constants are left out", block.written),
        );
    }
    if stiffness <= 0.0 {
        context.error(block.place, format!("{}: LINEAR takes a stiffness greater than 0, N/mm3", block.written));
        return None;
    }
    Some(Behaviour::Linear(stiffness))
}

fn check_parameters(block: &Block, context: &mut Context<'_>) {
    context.expect_word(block, "TYPE", &["SURFACETOSURFACE", "NODETOSURFACE"]);
    if block.word("TYPE").is_none_or(|word| word == "NODETOSURFACE") {
        context.note(
            block.place,
            "node-to-surface contact is solved as surface-to-surface contact, at 4 × 4 points of every slave face",
        );
    }
    if block.has("SMALLSLIDING") {
        context.note(block.place, "SMALL SLIDING: surfaces slide as far as they do");
    }
    let adjust = block.value("ADJUST").map(|text| crate::syntax::real(text).unwrap_or(1.0));
    if adjust.is_some_and(|width| width != 0.0) {
        context.error(
            block.place,
            format!("{}: ADJUST is not supported; surfaces are taken where the nodes are", block.written),
        );
    }
}

fn read_pair(
    item: Item<'_>,
    place: Place,
    fields: &[&str],
    body: &Body,
    sets: &AllSets,
    context: &mut Context<'_>,
) -> Option<ContactPair> {
    let (slave, master) = match *fields {
        [slave, master] => (slave, master),
        [surface] => (surface, surface),
        _ => {
            context
                .error(place, "*CONTACT PAIR takes a slave and a master surface, or one surface that may touch itself");
            return None;
        }
    };
    let mut surface = |name: &str| match sets.surfaces.get(body, item.scope, name, "surface") {
        Ok(set) => Some(set.members.clone()),
        Err(why) => {
            context.error(place, format!("{}: {why}", item.block.written));
            None
        }
    };
    let (slave_facets, master_facets) = (surface(slave), surface(master));
    let is_self = slave.eq_ignore_ascii_case(master);
    let name = if is_self { format!("{slave} on itself") } else { format!("{slave} on {master}") };
    Some(ContactPair::new(name, slave_facets?, master_facets?))
}
