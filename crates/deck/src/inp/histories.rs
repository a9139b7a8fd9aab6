//! What is said of supports and loads, step by step.

use std::collections::BTreeMap;

use super::schedule::Event;
use crate::report::Place;

/// What is said of one component of one thing.
#[derive(Clone, Debug)]
pub(super) struct History {
    /// Name under which it is reported: that of a set, or "nodes" for single ones.
    pub name: String,
    /// Where it was said last.
    pub place: Place,
    /// Last step that says something of it, even that it stays 0; `None` before the first step.
    pub last: Option<u32>,
    /// In the order of the steps, one a step.
    pub events: Vec<Event>,
}

/// Histories by what they are of.
pub(super) type Histories<K> = BTreeMap<K, History>;

/// A key that is the same for things with the same name and the same events.
pub(super) type GroupKey = (String, Vec<(u32, u64, Option<usize>)>);

impl History {
    /// Said before the first step.
    pub fn new(name: &str, place: Place) -> Self {
        Self { name: name.to_owned(), place, last: None, events: Vec::new() }
    }

    /// The event of a step, if there is one.
    pub fn event(&mut self, step: u32) -> Option<&mut Event> {
        self.events.last_mut().filter(|event| event.step == step)
    }

    /// The value that is left behind before a step; an amplitude counts as a value.
    pub fn is_zero_before(&self, step: u32) -> bool {
        self.events.iter().rev().find(|event| event.step < step).is_none_or(|event| event.value == 0.0)
    }

    /// Members of a group share it.
    pub fn key(&self) -> GroupKey {
        (self.name.clone(), self.events.iter().map(Event::key).collect())
    }
}

/// Things with the same key, each group with one of its histories.
pub(super) fn groups<K: Copy>(histories: &Histories<K>) -> BTreeMap<GroupKey, (Vec<K>, &History)> {
    let mut found: BTreeMap<GroupKey, (Vec<K>, &History)> = BTreeMap::new();
    for (&thing, history) in histories {
        found.entry(history.key()).or_insert_with(|| (Vec::new(), history)).0.push(thing);
    }
    found
}
