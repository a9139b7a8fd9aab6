//! What all readers of decks end with.

use pneuflex_mesh::{Facet, Mesh};
use pneuflex_model::Problem;

use crate::report::{DeckError, Note};
use crate::syntax::Include;
use crate::{feb, inp};

/// A deck as a problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Deck {
    /// First line of the heading; empty if there is none.
    pub title: String,
    /// What is solved.
    pub problem: Problem,
    /// When.
    pub schedule: Schedule,
    /// What was understood in another way than the deck may mean it.
    pub notes: Vec<Note>,
    /// The deck's numbers of the problem's nodes; nodes that were added on edges have none.
    pub node_labels: Vec<Option<Label>>,
    /// The deck's numbers of the problem's elements.
    pub element_labels: Vec<Label>,
}

/// When a problem is solved.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    /// Times to land on, increasing: the ends of the steps, and all increments of steps with fixed ones. None if there are no steps.
    pub times: Vec<f64>,
    /// First increment.
    pub first_increment: f64,
}

/// A number of a node or an element in a deck.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Label {
    /// The instance; empty if the deck has none.
    pub instance: String,
    /// The number in it.
    pub number: i32,
}

/// How much of a problem a deck must hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// Materials and steps: it is solved as it is.
    Problem,
    /// A mesh: materials and times may come from elsewhere. Where there are no steps the schedule has no times.
    Body,
}

/// Reads a deck called `name` from its bytes: FEBio's if the name ends so, else Abaqus's or CalculiX's. `include` finds the files that it
/// includes.
///
/// # Errors
/// Everything that is wrong or cannot be solved, by file and line.
pub fn read(name: &str, text: Vec<u8>, include: &mut Include<'_>) -> Result<Deck, Vec<DeckError>> {
    read_extent(name, text, include, Extent::Problem)
}

/// The same of a deck that need not hold all of a problem.
///
/// # Errors
/// As there.
pub fn read_extent(
    name: &str,
    text: Vec<u8>,
    include: &mut Include<'_>,
    extent: Extent,
) -> Result<Deck, Vec<DeckError>> {
    let is_feb = name.rsplit_once('.').is_some_and(|(_, end)| end.eq_ignore_ascii_case("feb"));
    if is_feb { feb::read(name, &text, extent) } else { inp::read(name, text, include, extent) }
}

/// Mean size of faces, mm: from the first corner to the last.
pub(crate) fn mean_size(mesh: &Mesh, facets: &[Facet]) -> f64 {
    let size = |facet: &Facet| {
        let (nodes, corners) = (mesh.facet_nodes(*facet), mesh.face_kind(*facet).num_corners());
        let [a, b] = [nodes[0], nodes[corners - 1]].map(|node| mesh.nodes[node as usize]);
        (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
    };
    facets.iter().map(size).sum::<f64>() / facets.len().max(1) as f64
}
