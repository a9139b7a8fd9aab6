//! Forces, pressures, weight.

use std::collections::BTreeMap;

use pneuflex_mesh::Facet;
use pneuflex_model::load::Load;

use super::body::Body;
use super::context::Context;
use super::histories::{Histories, History, groups};
use super::outline::{Item, Outline};
use super::schedule::{Event, Times};
use super::sets::{AllSets, nodes_of};
use crate::report::{Place, quoted};

/// What a load acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Component {
    /// A force on a node along an axis, N.
    Force(u32, u8),
    /// A pressure on a face, MPa; those of `*DLOAD` and `*DSLOAD` add up.
    ElementPressure(Facet),
    SurfacePressure(Facet),
    /// An acceleration of a list of elements along an axis, mm/s².
    Gravity(usize, u8),
}

impl Component {
    /// The keyword that sets it, for `OP=NEW`.
    const fn keyword(self) -> &'static str {
        match self {
            Self::Force(..) => "CLOAD",
            Self::ElementPressure(_) | Self::Gravity(..) => "DLOAD",
            Self::SurfacePressure(_) => "DSLOAD",
        }
    }
}

/// All loads of a deck.
#[derive(Debug, Default)]
pub(super) struct Loads {
    histories: Histories<Component>,
    /// Elements with a weight: name in capitals and members; all if there are none.
    heavy: Vec<(String, Option<Vec<u32>>)>,
    /// Where gravity is first asked for.
    pub gravity: Option<Place>,
}

impl Loads {
    pub fn read(outline: &Outline<'_>, body: &Body, sets: &AllSets, times: &Times, context: &mut Context<'_>) -> Self {
        let mut loads = Self::default();
        for step in 0..times.steps.len() as u32 {
            for keyword in ["CLOAD", "DLOAD", "DSLOAD"] {
                let mut renewed = false;
                for item in outline.of_step(keyword, Some(step)) {
                    context.expect_word(item.block, "OP", &["MOD", "NEW"]);
                    renewed |= item.block.word("OP").is_some_and(|word| word == "NEW");
                    loads.block(item, step, body, sets, times, context);
                }
                if renewed {
                    loads.drop_others(keyword, step);
                }
            }
        }
        loads
    }

    /// Nodes and axes along which forces act, and where that is said.
    pub fn forces(&self) -> Vec<((u32, u8), Place)> {
        let force = |(component, history): (&Component, &History)| match component {
            Component::Force(node, axis) => Some(((*node, *axis), history.place)),
            _ => None,
        };
        self.histories.iter().filter_map(force).collect()
    }

    /// What `OP=NEW` does not repeat goes back to zero over the step.
    fn drop_others(&mut self, keyword: &str, step: u32) {
        for (component, history) in &mut self.histories {
            if component.keyword() == keyword && history.last != Some(step) && !history.is_zero_before(step) {
                history.events.push(Event { step, value: 0.0, amplitude: None });
            }
        }
    }

    fn block(
        &mut self,
        item: Item<'_>,
        step: u32,
        body: &Body,
        sets: &AllSets,
        times: &Times,
        context: &mut Context<'_>,
    ) {
        let amplitude = times.amplitude(item.block, context);
        for line in &item.block.lines {
            let fields = context.fields(line);
            if fields.is_empty() {
                continue;
            }
            let found = match item.block.keyword.as_str() {
                "CLOAD" => read_force(item, line.place, &fields, body, sets, context),
                "DLOAD" => self.read_distributed(item, line.place, &fields, body, sets, context),
                _ => read_surface_pressure(item, line.place, &fields, body, sets, context),
            };
            for (component, value) in found {
                // An absolute amplitude is the magnitude itself.
                let is_weight = matches!(component, Component::Gravity(..));
                if times.is_absolute(amplitude) && is_weight {
                    context.error(line.place, "*DLOAD: GRAV with an amplitude of absolute values is not supported");
                    break;
                }
                let value = if times.is_absolute(amplitude) { 1.0 } else { value };
                let event = Event { step, value, amplitude };
                if let Err(why) = self.act(component, fields[0], line.place, event, (times, context)) {
                    context.error(line.place, format!("{}: {why}", item.block.written));
                    break;
                }
            }
        }
    }

    /// Loads that a step names twice add up, as in CalculiX; a step that names a load anew replaces the one before.
    fn act(
        &mut self,
        component: Component,
        name: &str,
        place: Place,
        event: Event,
        (times, context): (&Times, &mut Context<'_>),
    ) -> Result<(), String> {
        let history = self.histories.entry(component).or_insert_with(|| History::new("", place));
        history.last = Some(event.step);
        match history.event(event.step) {
            None => history.events.push(event),
            Some(first) if first.amplitude == event.amplitude => {
                context.note(place, format!("loads on {} that the step names twice add up", quoted(name)));
                first.value += event.value;
            }
            Some(_) => return Err(format!("{} is loaded twice in the step, with different amplitudes", quoted(name))),
        }
        let is_finite = history.event(event.step).is_none_or(|event| times.is_finite(event));
        if is_finite { Ok(()) } else { Err("the load is too large a number".to_owned()) }
    }

    fn read_distributed(
        &mut self,
        item: Item<'_>,
        place: Place,
        fields: &[&str],
        body: &Body,
        sets: &AllSets,
        context: &mut Context<'_>,
    ) -> Vec<(Component, f64)> {
        let [target, label, rest @ ..] = fields else {
            context.error(place, "*DLOAD takes an element or set, a label such as P1 or GRAV, and a magnitude");
            return Vec::new();
        };
        let is_gravity = label.eq_ignore_ascii_case("GRAV");
        let elements = match sets.target(body, item.scope, target) {
            _ if is_gravity && target.is_empty() => None,
            Ok(elements) => Some(elements),
            Err(why) => {
                context.error(place, format!("{}: {why}", item.block.written));
                return Vec::new();
            }
        };
        if is_gravity {
            return self.read_gravity(place, target, elements, rest, context);
        }
        let facets = match body.labelled_faces(&elements.unwrap_or_default(), 'P', label) {
            Ok(facets) => facets,
            Err(last) => {
                context.error(place, format!("*DLOAD: {} is not supported, only P1 to {last} and GRAV", quoted(label)));
                return Vec::new();
            }
        };
        let Some(value) = magnitude(place, rest, context) else { return Vec::new() };
        body.note_inner_faces(&facets, place, context);
        facets.into_iter().map(|facet| (Component::ElementPressure(facet), value)).collect()
    }

    fn read_gravity(
        &mut self,
        place: Place,
        target: &str,
        elements: Option<Vec<u32>>,
        rest: &[&str],
        context: &mut Context<'_>,
    ) -> Vec<(Component, f64)> {
        let mut values = [0.0; 4];
        for (value, field) in values.iter_mut().zip(rest) {
            match context.real_or_zero(place, Some(field)) {
                Some(number) => *value = number,
                None => return Vec::new(),
            }
        }
        let [magnitude, direction @ ..] = values;
        let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
        if rest.len() > 4 || !(length > 0.0 && length.is_finite()) {
            context.error(place, "*DLOAD: GRAV takes a magnitude and the three components of its direction");
            return Vec::new();
        }
        self.gravity.get_or_insert(place);
        let name = target.to_uppercase();
        let known = self.heavy.iter().position(|(heavy, _)| *heavy == name);
        let number = known.unwrap_or(self.heavy.len());
        if known.is_none() {
            self.heavy.push((name, elements));
        }
        // Zeros, too: a new direction replaces the old one.
        (0..3).map(|i| (Component::Gravity(number, i as u8), magnitude * direction[i] / length)).collect()
    }

    /// Loads for the solver: one for all things that are loaded alike.
    pub fn for_solver(&self, times: &Times) -> Vec<Load> {
        let mut found = Vec::new();
        for (_, (components, history)) in groups(&self.histories) {
            let curve = times.curve(&history.events);
            if curve == pneuflex_model::Curve::ZERO {
                continue;
            }
            // *CLOAD is the force on every single node.
            let mut forces: BTreeMap<u8, Vec<(u32, f64)>> = BTreeMap::new();
            let mut facets: [Vec<Facet>; 2] = [Vec::new(), Vec::new()];
            for component in components {
                match component {
                    Component::Force(node, axis) => forces.entry(axis).or_default().push((node, 1.0)),
                    Component::ElementPressure(facet) => facets[0].push(facet),
                    Component::SurfacePressure(facet) => facets[1].push(facet),
                    Component::Gravity(number, axis) => found.push(Load::Gravity {
                        elements: self.heavy[number].1.clone(),
                        acceleration: unit(axis),
                        curve: curve.clone(),
                    }),
                }
            }
            let force = |(axis, nodes)| Load::Force { nodes, force: unit(axis), curve: curve.clone() };
            found.extend(forces.into_iter().map(force));
            let pressure = |facets| Load::Pressure { facets, curve: curve.clone() };
            found.extend(facets.into_iter().filter(|facets| !facets.is_empty()).map(pressure));
        }
        found
    }
}

fn unit(axis: u8) -> [f64; 3] {
    std::array::from_fn(|i| f64::from(u8::from(i == usize::from(axis))))
}

fn read_force(
    item: Item<'_>,
    place: Place,
    fields: &[&str],
    body: &Body,
    sets: &AllSets,
    context: &mut Context<'_>,
) -> Vec<(Component, f64)> {
    let [target, direction, rest @ ..] = fields else {
        context.error(place, "*CLOAD takes a node or a set, a direction and a force");
        return Vec::new();
    };
    let nodes = match nodes_of(sets, body, item.scope, target, item.block) {
        Ok(nodes) => nodes,
        Err(why) => {
            context.error(place, why);
            return Vec::new();
        }
    };
    if nodes.is_empty() {
        context.error(place, format!("*CLOAD: {} has no node of an element", quoted(target)));
    }
    let (Some(direction), Some(force)) = (context.integer(place, direction), magnitude(place, rest, context)) else {
        return Vec::new();
    };
    if !(1..=3).contains(&direction) {
        context.error(
            place,
            format!(
                "*CLOAD: direction {direction} is not within 1 to 3; nodes take no moments: let a pair of forces act"
            ),
        );
        return Vec::new();
    }
    nodes.into_iter().map(|node| (Component::Force(node, direction as u8 - 1), force)).collect()
}

fn read_surface_pressure(
    item: Item<'_>,
    place: Place,
    fields: &[&str],
    body: &Body,
    sets: &AllSets,
    context: &mut Context<'_>,
) -> Vec<(Component, f64)> {
    let [target, label, rest @ ..] = fields else {
        context.error(place, "*DSLOAD takes a surface, P and a pressure");
        return Vec::new();
    };
    if !label.eq_ignore_ascii_case("P") {
        context.error(place, format!("*DSLOAD: {} is not supported, only P", quoted(label)));
        return Vec::new();
    }
    let Some(value) = magnitude(place, rest, context) else { return Vec::new() };
    match sets.surfaces.get(body, item.scope, target, "surface") {
        Ok(surface) => surface.members.iter().map(|&facet| (Component::SurfacePressure(facet), value)).collect(),
        Err(why) => {
            context.error(place, format!("{}: {why}", item.block.written));
            Vec::new()
        }
    }
}

/// The one number at the end of a line.
fn magnitude(place: Place, rest: &[&str], context: &mut Context<'_>) -> Option<f64> {
    match rest {
        [] => Some(0.0),
        [one] => context.real_or_zero(place, Some(one)),
        _ => {
            context.error(place, "too many entries");
            None
        }
    }
}
