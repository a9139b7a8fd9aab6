//! Spaces filled with fluid: `*FLUID CAVITY` with what fills it. Its pressure is direction 8 of its reference node, by `*BOUNDARY`.

use std::collections::BTreeSet;

use pneuflex_mesh::Facet;
use pneuflex_model::Curve;
use pneuflex_model::load::{Cavity, Control, Gas};

use super::body::{Body, Number};
use super::context::Context;
use super::histories::{Histories, History};
use super::outline::{Item, Outline};
use super::references::numbers_called;
use super::schedule::{Event, Times};
use super::sets::AllSets;
use crate::report::{Place, quoted, suggestion};
use crate::syntax::DataLine;

/// The direction that is a pressure.
const PRESSURE: &str = "8";

/// What fills a cavity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fluid {
    /// Incompressible.
    Liquid,
    Gas,
}

struct Space {
    name: String,
    place: Place,
    facets: Vec<Facet>,
    reference: BTreeSet<Number>,
    fluid: Fluid,
    /// Absolute pressure outside, MPa.
    ambient: Option<f64>,
}

/// Whether the entries of a line of `*BOUNDARY` behind its target are of a pressure.
pub(super) fn is_pressure(fields: &[&str]) -> bool {
    fields.first() == Some(&PRESSURE)
}

/// Reads all `*FLUID CAVITY`, and the pressures that `*BOUNDARY` prescribes.
pub(super) fn read(
    outline: &Outline<'_>,
    body: &Body,
    sets: &AllSets,
    times: &Times,
    context: &mut Context<'_>,
) -> Vec<Cavity> {
    let spaces: Vec<Space> =
        outline.of("FLUIDCAVITY").filter_map(|item| space(item, outline, body, sets, context)).collect();
    let mut held: Histories<usize> = Histories::new();
    for item in outline.of_step("BOUNDARY", None) {
        for (line, number, value) in pressures(item, outline, &spaces, context) {
            if value != 0.0 {
                context.error(line.place, "a pressure other than 0 must stand in a step");
            }
            held.entry(number).or_insert_with(|| History::new(&spaces[number].name, line.place));
        }
    }
    for step in 0..times.steps.len() as u32 {
        let mut renewed = None;
        for item in outline.of_step("BOUNDARY", Some(step)) {
            let amplitude = times.amplitude(item.block, context);
            if item.block.word("OP").is_some_and(|word| word == "NEW") {
                renewed = Some(item.block.place);
            }
            for (line, number, value) in pressures(item, outline, &spaces, context) {
                let value = if times.is_absolute(amplitude) { 1.0 } else { value };
                let event = Event { step, value, amplitude };
                let is_new = !held.contains_key(&number);
                let history = held.entry(number).or_insert_with(|| History::new(&spaces[number].name, line.place));
                if is_new && step > 0 || history.last == Some(step) || !times.is_finite(&event) {
                    let text = "the pressure of a cavity is prescribed once a step, from the first one on, by a number that is not too large";
                    context.error(line.place, text);
                }
                history.last = Some(step);
                history.events.push(event);
            }
        }
        if let (Some(place), Some(history)) = (renewed, held.values().find(|history| history.last != Some(step))) {
            let text =
                format!("*BOUNDARY, OP=NEW lets go of the pressure of cavity {}: that is not supported", history.name);
            context.error(place, text);
        }
    }
    let cavity = |(space, number): (Space, usize)| {
        let pressure = held.get(&number).map(|history| times.curve(&history.events));
        let control = match (pressure, space.fluid, space.ambient) {
            (Some(pressure), ..) => Control::Pressure(pressure),
            (None, Fluid::Liquid, _) => {
                let text =
                    format!("cavity {} is full of an incompressible liquid: its volume stays what it is", space.name);
                context.note(space.place, text);
                Control::Volume(Curve::ZERO)
            }
            (None, Fluid::Gas, Some(atmosphere)) => {
                let text = format!(
                    "cavity {} is full of gas that keeps its temperature, at rest at {atmosphere} MPa",
                    space.name
                );
                context.note(space.place, text);
                Control::Gas(Gas { atmosphere, exponent: 1.0, amount: Curve::constant(1.0) })
            }
            (None, Fluid::Gas, None) => {
                context.error(
                    space.place,
                    format!("gas in cavity {}: *FLUID CAVITY needs AMBIENT PRESSURE=…, MPa", space.name),
                );
                return None;
            }
        };
        Some(Cavity { name: space.name, facets: space.facets, control })
    };
    spaces.into_iter().zip(0..).filter_map(cavity).collect()
}

fn space(
    item: Item<'_>,
    outline: &Outline<'_>,
    body: &Body,
    sets: &AllSets,
    context: &mut Context<'_>,
) -> Option<Space> {
    let block = item.block;
    let surface = context.required(block, "SURFACE")?;
    let facets = match sets.surfaces.get(body, item.scope, surface, "surface") {
        Ok(set) => set.members.clone(),
        Err(why) => {
            context.error(block.place, format!("{}: {why}", block.written));
            return None;
        }
    };
    let reference = context.required(block, "REFNODE")?;
    let reference = numbers_called(outline, context, item.scope, reference);
    let ambient = match block.value("AMBIENTPRESSURE") {
        Some(text) => Some(context.real(block.place, text)?),
        None => None,
    };
    if ambient.is_some_and(|pressure| pressure <= 0.0) {
        context.error(block.place, "AMBIENT PRESSURE must be greater than 0, MPa");
    }
    let behavior = context.required(block, "BEHAVIOR")?;
    let is_it = |number: &usize| {
        let other = outline.items[*number].block;
        other.keyword == "FLUIDBEHAVIOR" && other.value("NAME").is_some_and(|name| name.eq_ignore_ascii_case(behavior))
    };
    let Some(number) = (0..outline.items.len()).find(is_it) else {
        let names = outline.of("FLUIDBEHAVIOR").filter_map(|other| other.block.value("NAME"));
        let hint = suggestion(behavior, names);
        context.error(block.place, format!("there is no *FLUID BEHAVIOR {}{hint}", quoted(behavior)));
        return None;
    };
    let owned = || outline.items.iter().filter(|owned| owned.owner == Some(number));
    let has = |keyword: &str| owned().any(|owned| owned.block.keyword == keyword);
    if let Some(modulus) = owned().find(|owned| owned.block.keyword == "FLUIDBULKMODULUS") {
        context.note(modulus.block.place, "*FLUID BULK MODULUS is left out: liquids are incompressible");
    }
    let fluid = if has("FLUIDDENSITY") { Fluid::Liquid } else { Fluid::Gas };
    if fluid == Fluid::Gas && !has("MOLECULARWEIGHT") {
        let text = "*FLUID BEHAVIOR needs *FLUID DENSITY (a liquid) or *MOLECULAR WEIGHT (a gas)";
        context.error(outline.items[number].block.place, text);
    }
    let name = block.value("NAME").unwrap_or(surface).to_owned();
    Some(Space { name, place: block.place, facets, reference, fluid, ambient })
}

/// Lines of a `*BOUNDARY` that are of pressures, with the cavity's number and the value.
fn pressures<'a>(
    item: Item<'a>,
    outline: &Outline<'_>,
    spaces: &[Space],
    context: &mut Context<'_>,
) -> Vec<(&'a DataLine, usize, f64)> {
    let mut found = Vec::new();
    for line in &item.block.lines {
        let fields = context.fields(line);
        let Some((target, rest)) = fields.split_first().filter(|(_, rest)| is_pressure(rest)) else { continue };
        if !["", PRESSURE].contains(&rest.get(1).copied().unwrap_or("")) || rest.len() > 3 {
            context.error(line.place, "*BOUNDARY takes a reference node, 8, 8 and a pressure in MPa");
            continue;
        }
        let Some(value) = context.real_or_zero(line.place, rest.get(2)) else { continue };
        let named = numbers_called(outline, context, item.scope, target);
        let of_target = spaces.iter().position(|space| space.reference == named && !named.is_empty());
        match of_target {
            Some(number) => found.push((line, number, value)),
            None => {
                let text = format!(
                    "direction 8 is the pressure of a *FLUID CAVITY, and {} is the reference node of none",
                    quoted(target)
                );
                context.error(line.place, text);
            }
        }
    }
    found
}
