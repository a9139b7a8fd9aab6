//! Sets that a body gets where its file has none: its hollow spaces, `cavity_1`, `cavity_2` and so on, and the rest of its surface, `outer`.

use std::collections::BTreeSet;
use std::sync::Arc;

use pneuflex_mesh::{Facet, Hollow};

use super::tables::Model;
use crate::choice::Choice;
use crate::chosen::{Asked, Chooser};
use crate::number::rounded;
use crate::problem::Problem;
use crate::range_check::CaseError;

/// What the rest of the surface is called.
const OUTER: &str = "outer";

/// What the hollow spaces are called, with a number from 1 behind it.
const CAVITY: &str = "cavity_";

/// Hollow spaces by the names of the sets of their walls.
pub type Hollows = Vec<(String, Hollow)>;

impl Model {
    /// Finds the hollow spaces of a body from a file without surfaces, or where the model asks for them by name or by an inlet, and names
    /// their walls. What the file itself calls so is left alone.
    pub(super) fn name_hollows(&self, body: &mut Problem, notes: &mut Vec<String>) -> Result<Hollows, CaseError> {
        let Some(source) = &self.model else { return Ok(Vec::new()) };
        let sets = &body.mesh.facet_sets;
        let is_known = |name: &str| sets.keys().any(|known| known.eq_ignore_ascii_case(name));
        let mut asked = BTreeSet::new();
        for (_, _, choice) in self.choices() {
            names(choice, &mut asked);
        }
        if self.obstacles.iter().any(|obstacle| obstacle.faces.is_none()) {
            asked.insert(OUTER);
        }
        let is_missing = |name: &&str| (*name == OUTER || number(name).is_some()) && !is_known(name);
        let is_asked = asked.iter().any(|name| is_missing(&name.to_ascii_lowercase().as_str()));
        if !(is_asked || sets.is_empty() || !source.inlet.0.is_empty()) {
            return Ok(Vec::new());
        }
        let (hollows, is_complete) = body.mesh.hollows(&source.inlet.0).map_err(|(inlet, none)| {
            let [x, y, z] = source.inlet.0[inlet];
            let nearest = none.nearest.map_or_else(String::new, |at| {
                let [x, y, z] = at.map(rounded);
                format!("; the nearest rim is around ({x}, {y}, {z})")
            });
            let allowed =
                format!("must be a point in the mouth of a chamber: no part of the surface that encloses a void ends there{nearest}");
            CaseError { key: "model.inlet".into(), value: format!("[{x}, {y}, {z}]"), allowed }
        })?;
        if !is_complete {
            let note = "the surface has too many edges to look for chambers that open to the outside; say where with model.inlet";
            notes.push(note.to_owned());
        }
        let has_own = sets.keys().any(|name| number(&name.to_ascii_lowercase()).is_some());
        let has_outer = is_known(OUTER);
        if hollows.is_empty() && !is_asked {
            return Ok(Vec::new());
        }
        let mut inner: BTreeSet<Facet> = hollows.iter().flat_map(|hollow| hollow.facets.iter().copied()).collect();
        inner.extend(self.cut_faces(body));
        let named: Hollows =
            hollows.into_iter().enumerate().map(|(i, hollow)| (format!("{CAVITY}{}", i + 1), hollow)).collect();
        let mesh = Arc::make_mut(&mut body.mesh);
        if !has_outer {
            let outer = mesh.boundary_facets().into_iter().filter(|facet| !inner.contains(facet)).collect();
            mesh.facet_sets.insert(OUTER.to_owned(), outer);
        }
        if has_own {
            return Ok(Vec::new());
        }
        for (name, hollow) in &named {
            mesh.facet_sets.insert(name.clone(), hollow.facets.clone());
        }
        Ok(named)
    }

    /// Faces in which a body is cut at a plane of symmetry: its other half is there, and nothing touches them.
    fn cut_faces(&self, body: &Problem) -> Vec<Facet> {
        let chooser = Chooser::new(Arc::clone(&body.mesh));
        let planes = self.supports.iter().filter(|support| support.symmetry);
        // What names no nodes is complained of where supports are made.
        let planes = planes.filter_map(|support| chooser.holds(&support.nodes, Asked::Nodes).ok());
        planes.flat_map(|held| held.facets).collect()
    }
}

/// The number of a hollow space's name.
fn number(name: &str) -> Option<usize> {
    name.strip_prefix(CAVITY)?.parse().ok()
}

/// All names in a choice.
fn names<'a>(choice: &'a Choice, found: &mut BTreeSet<&'a str>) {
    match choice {
        Choice::Named(name) => {
            found.insert(name);
        }
        Choice::Where(conditions) => conditions.choices().for_each(|inner| names(inner, found)),
    }
}
