//! The order of a deck: which keyword belongs to which instance, material, step.
//!
//! Parts are read once for every instance of them, as if the instance had been written out; what stands outside of parts and
//! instances belongs to the assembly.

use std::collections::BTreeMap;

use super::context::Context;
use super::language::{Region, Treatment, candidates, treatment};
use super::placement::Placement;
use crate::report::{Place, quoted, suggestion};
use crate::syntax::Block;

/// Number of the assembly among the scopes, or of the whole deck if it has no instances.
pub(super) const ROOT: u32 = 0;

/// Elements and nodes are numbered, sets and surfaces named, within a scope: an instance or the assembly.
#[derive(Debug, Default)]
pub(super) struct Scope {
    /// Name of the instance; empty for the assembly.
    pub name: String,
    /// Where its nodes are moved.
    pub placement: Placement,
}

/// A keyword in its surroundings.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item<'a> {
    pub block: &'a Block,
    pub scope: u32,
    /// Step, from 0; `None` before the first.
    pub step: Option<u32>,
    /// The item of the `*MATERIAL`, `*SURFACE INTERACTION` or `*COUPLING` that it describes.
    pub owner: Option<usize>,
}

/// All keywords that are understood, in their order.
#[derive(Debug)]
pub(super) struct Outline<'a> {
    pub scopes: Vec<Scope>,
    pub items: Vec<Item<'a>>,
    /// The keywords that begin the steps.
    pub steps: Vec<&'a Block>,
}

impl<'a> Outline<'a> {
    /// Items of a keyword.
    pub fn of(&self, keyword: &'static str) -> impl Iterator<Item = Item<'a>> + '_ {
        self.items.iter().copied().filter(move |item| item.block.keyword == keyword)
    }

    /// Items of a keyword in a step, or before the first for `None`.
    pub fn of_step(&self, keyword: &'static str, step: Option<u32>) -> impl Iterator<Item = Item<'a>> + '_ {
        // Items come in the order of the steps.
        let begin = self.items.partition_point(|item| item.step < step);
        let items = self.items[begin..].iter().copied().take_while(move |item| item.step == step);
        items.filter(move |item| item.block.keyword == keyword)
    }

    /// Sorts the keywords of a deck.
    pub fn new(blocks: &'a [Block], context: &mut Context<'_>) -> Self {
        let outline = Self { scopes: vec![Scope::default()], items: Vec::new(), steps: Vec::new() };
        let mut state = State { outline, parts: BTreeMap::new(), level: Level::Model, step: None, owner: None };
        for block in blocks {
            state.take(block, context);
        }
        let unclosed = match (&state.level, state.step) {
            (Level::Part(_), _) => Some("*PART without *END PART"),
            (Level::Instance(_), _) => Some("*INSTANCE without *END INSTANCE"),
            (_, Some(place)) => {
                context.error(place, "*STEP without *END STEP");
                None
            }
            _ => None,
        };
        if let (Some(text), Some(last)) = (unclosed, blocks.last()) {
            context.error(last.place, text);
        }
        state.outline
    }
}

enum Level {
    Model,
    Part(String),
    Instance(u32),
}

struct State<'a> {
    outline: Outline<'a>,
    parts: BTreeMap<String, Vec<&'a Block>>,
    level: Level,
    /// The step that is open.
    step: Option<Place>,
    owner: Option<usize>,
}

impl<'a> State<'a> {
    fn take(&mut self, block: &'a Block, context: &mut Context<'_>) {
        let (region, parameters) = match treatment(&block.keyword) {
            Some(Treatment::Understood(region, parameters)) => (region, parameters),
            Some(Treatment::LeftOut) => {
                let text = format!("{} is left out: it does not change what is solved", block.written.to_uppercase());
                return context.note(block.place, text);
            }
            Some(Treatment::Refused(why)) => {
                return context.error(block.place, format!("{} is not supported: {why}", block.written));
            }
            None => {
                let hint = suggestion(&block.keyword, candidates()).replace("mean ", "mean *");
                return context
                    .error(block.place, format!("{} is not a keyword that is known here{hint}", block.written));
            }
        };
        for parameter in &block.parameters {
            if !parameters.contains(&parameter.name.as_str()) {
                let hint = suggestion(&parameter.name, parameters.iter().copied());
                let name = quoted(&parameter.name);
                context.error(block.place, format!("{}: parameter {name} is not supported{hint}", block.written));
            }
        }
        match (region, self.step) {
            (Region::Model, Some(_)) if block.keyword == "STEP" => {
                context.error(block.place, "a step begins before *END STEP of the one before");
            }
            (Region::Model, Some(_)) => {
                context.error(block.place, format!("{} must stand before the first *STEP", block.written));
            }
            (Region::Model, None) if !self.outline.steps.is_empty() && block.keyword != "STEP" => {
                context.error(block.place, format!("{} must stand before the first *STEP", block.written));
            }
            (Region::Step, None) => context.error(block.place, format!("{} must stand in a *STEP", block.written)),
            _ => self.place(block, context),
        }
    }

    fn place(&mut self, block: &'a Block, context: &mut Context<'_>) {
        match (block.keyword.as_str(), &self.level) {
            ("PART", Level::Model) => {
                if let Some(name) = context.required(block, "NAME") {
                    let name = name.to_uppercase();
                    if self.parts.insert(name.clone(), Vec::new()).is_some() {
                        context.error(block.place, format!("part {} is there twice", quoted(&name)));
                    }
                    self.level = Level::Part(name);
                }
            }
            ("ENDPART", Level::Part(_)) | ("ENDINSTANCE", Level::Instance(_)) => self.level = Level::Model,
            (
                "PART" | "INSTANCE" | "ASSEMBLY" | "ENDASSEMBLY" | "ENDPART" | "ENDINSTANCE" | "STEP",
                Level::Part(_) | Level::Instance(_),
            )
            | ("ENDPART" | "ENDINSTANCE", Level::Model) => {
                context.error(block.place, format!("{} is out of place here", block.written));
            }
            ("INSTANCE", Level::Model) => self.instance(block, context),
            ("ASSEMBLY" | "ENDASSEMBLY", Level::Model) => {}
            ("STEP", Level::Model) => {
                self.step = Some(block.place);
                self.outline.steps.push(block);
                self.owner = None;
            }
            ("ENDSTEP", Level::Model) => self.step = None,
            (_, Level::Part(part)) => {
                if let Some(blocks) = self.parts.get_mut(part) {
                    blocks.push(block);
                }
            }
            (_, Level::Instance(scope)) => {
                let scope = *scope;
                self.push(block, scope, context);
            }
            (_, Level::Model) => self.push(block, ROOT, context),
        }
    }

    fn instance(&mut self, block: &'a Block, context: &mut Context<'_>) {
        let Some(name) = context.required(block, "NAME") else { return };
        let same = |scope: &Scope| scope.name.eq_ignore_ascii_case(name);
        if self.outline.scopes.iter().any(same) {
            context.error(block.place, format!("instance {} is there twice", quoted(name)));
        }
        let scope = self.outline.scopes.len() as u32;
        let placement = Placement::read(block, context);
        self.outline.scopes.push(Scope { name: name.to_owned(), placement });
        self.level = Level::Instance(scope);
        // An instance may also hold the mesh itself.
        let Some(part) = block.value("PART") else { return };
        match self.parts.get(&part.to_uppercase()).cloned() {
            Some(blocks) => blocks.into_iter().for_each(|block| self.push(block, scope, context)),
            None => {
                let hint = suggestion(part, self.parts.keys().map(String::as_str));
                context.error(block.place, format!("there is no part {}{hint}", quoted(part)));
            }
        }
    }

    fn push(&mut self, block: &'a Block, scope: u32, context: &mut Context<'_>) {
        let number = self.outline.items.len();
        let owned_by = match block.keyword.as_str() {
            "HYPERELASTIC" | "ELASTIC" | "DENSITY" => Some("MATERIAL"),
            "SURFACEBEHAVIOR" | "FRICTION" => Some("SURFACEINTERACTION"),
            "KINEMATIC" | "DISTRIBUTING" => Some("COUPLING"),
            "FLUIDDENSITY" | "FLUIDBULKMODULUS" | "MOLECULARWEIGHT" | "CAPACITY" => Some("FLUIDBEHAVIOR"),
            _ => None,
        };
        match owned_by {
            None => {
                let is_owner =
                    matches!(block.keyword.as_str(), "MATERIAL" | "SURFACEINTERACTION" | "COUPLING" | "FLUIDBEHAVIOR");
                self.owner = is_owner.then_some(number);
            }
            Some(owner) => {
                let is_owned = self.owner.is_some_and(|number| self.outline.items[number].block.keyword == owner);
                if !is_owned {
                    let owner = match owner {
                        "SURFACEINTERACTION" => "*SURFACE INTERACTION",
                        "COUPLING" => "*COUPLING",
                        "FLUIDBEHAVIOR" => "*FLUID BEHAVIOR",
                        _ => "*MATERIAL",
                    };
                    return context.error(block.place, format!("{} must follow a {owner}", block.written));
                }
            }
        }
        let step = self.step.map(|_| self.outline.steps.len() as u32 - 1);
        let owner = owned_by.and(self.owner);
        self.outline.items.push(Item { block, scope, step, owner });
    }
}
