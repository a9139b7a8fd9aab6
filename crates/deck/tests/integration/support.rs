//! Small decks.

use pneuflex_deck::{Deck, read};

/// Nodes of two unit cubes, one beside the other along x: 1–4 and 5–8 at z = 0 and 1 of the first, 9–12 behind the second.
pub const NODES: &str = "*NODE, NSET=ALL
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
9, 2., 0., 0.
10, 2., 1., 0.
11, 2., 0., 1.
12, 2., 1., 1.
";

/// The two cubes, 10 and 20.
pub const CUBES: &str = "*ELEMENT, TYPE=C3D8, ELSET=BODY
10, 1, 2, 3, 4, 5, 6, 7, 8
20, 2, 9, 10, 3, 6, 11, 12, 7
*ELSET, ELSET=LEFT
10
*ELSET, ELSET=RIGHT
20
*NSET, NSET=CLAMP
1, 4, 5, 8
*NSET, NSET=TIP
9, 10, 11, 12
";

pub const MATERIAL: &str = "*MATERIAL, NAME=RUBBER
*HYPERELASTIC, NEO HOOKE
0.2, 0.01
*SOLID SECTION, ELSET=BODY, MATERIAL=RUBBER
";

pub const STEP: &str = "*STEP, NLGEOM
*STATIC
*END STEP
";

/// Two cubes of one material with something before the step and something in it.
pub fn cubes(model: &str, step: &str) -> String {
    format!("{NODES}{CUBES}{MATERIAL}{model}*STEP, NLGEOM\n*STATIC\n{step}*END STEP\n")
}

/// Reads a deck that is right.
pub fn deck(text: &str) -> Deck {
    match read("a.inp", text.into(), &mut |name| Err(format!("no file {name}"))) {
        Ok(deck) => deck,
        Err(errors) => panic!("{}", errors.iter().map(|e| format!("{e}\n")).collect::<String>()),
    }
}

/// Errors of a deck that is wrong.
pub fn errors(text: &str) -> Vec<String> {
    match read("a.inp", text.into(), &mut |name| Err(format!("no file {name}"))) {
        Ok(_) => panic!("read without complaint"),
        Err(errors) => errors.iter().map(ToString::to_string).collect(),
    }
}

/// Notes of a deck that is right.
pub fn notes(text: &str) -> Vec<String> {
    deck(text).notes.iter().map(ToString::to_string).collect()
}

/// Our number of a node by the deck's.
pub fn node(deck: &Deck, number: i32) -> u32 {
    let is_it = |label: &Option<pneuflex_deck::Label>| label.as_ref().is_some_and(|label| label.number == number);
    deck.node_labels.iter().position(is_it).unwrap_or_else(|| panic!("no node {number}")) as u32
}

/// The deck's numbers of the nodes that a force acts on, all with the factor 1.
pub fn loaded(deck: &Deck, nodes: &[(u32, f64)]) -> Vec<i32> {
    assert!(nodes.iter().all(|(_, factor)| *factor == 1.0), "{nodes:?}");
    numbers(deck, &nodes.iter().map(|(node, _)| *node).collect::<Vec<_>>())
}

/// The deck's numbers of nodes of ours, ascending.
pub fn numbers(deck: &Deck, nodes: &[u32]) -> Vec<i32> {
    let mut found: Vec<i32> =
        nodes.iter().map(|&n| deck.node_labels[n as usize].as_ref().map_or(0, |label| label.number)).collect();
    found.sort_unstable();
    found
}
