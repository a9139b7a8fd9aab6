//! Decks with ties and rigid bodies, solved: equilibria say whether they are right.

// Helpers count as tests here.
#![allow(clippy::unwrap_used)]

use std::fmt::Write as _;

use pneuflex::deck::{Deck, read};
use pneuflex::newton::{ConvergedState, Event, follow_path};
use pneuflex::{Analysis, Study};

fn deck(text: &str) -> Deck {
    read("a.inp", text.into(), &mut |_| Err(String::new())).unwrap()
}

/// A box of bricks or of tetrahedra, six to a brick, whose numbers begin after `first`.
fn block(kind: &str, [low, high]: [[f64; 3]; 2], cells: [i32; 3], first: i32) -> String {
    let number = |[i, j, k]: [i32; 3]| first + 1 + i + (cells[0] + 1) * (j + (cells[1] + 1) * k);
    let mut text = String::from("*NODE\n");
    let ranges = || {
        let [x, y, z] = cells;
        (0..=z).flat_map(move |k| (0..=y).flat_map(move |j| (0..=x).map(move |i| [i, j, k])))
    };
    for at in ranges() {
        let x: [f64; 3] = std::array::from_fn(|d| low[d] + (high[d] - low[d]) * f64::from(at[d]) / f64::from(cells[d]));
        let _ = writeln!(text, "{}, {}, {}, {}", number(at), x[0], x[1], x[2]);
    }
    let _ = writeln!(text, "*ELEMENT, TYPE={kind}, ELSET=BODY");
    let mut element = first;
    for [i, j, k] in ranges().filter(|at| (0..3).all(|d| at[d] < cells[d])) {
        let corner = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
            .map(|[a, b, c]| number([i + a, j + b, k + c]));
        let parts: &[&[usize]] = match kind {
            "C3D8" => &[&[0, 1, 2, 3, 4, 5, 6, 7]],
            _ => &[&[0, 1, 3, 7], &[0, 4, 1, 7], &[1, 2, 3, 7], &[1, 6, 2, 7], &[1, 4, 5, 7], &[1, 5, 6, 7]],
        };
        for part in parts {
            element += 1;
            let nodes: Vec<String> = part.iter().map(|&place| corner[place].to_string()).collect();
            let _ = writeln!(text, "{element}, {}", nodes.join(", "));
        }
    }
    text
}

fn set(name: &str, deck: &Deck, holds: impl Fn([f64; 3]) -> bool) -> String {
    let members =
        (deck.node_labels.iter().zip(&deck.problem.mesh.nodes)).filter(|(label, x)| label.is_some() && holds(**x));
    let numbers = members.map(|(label, _)| label.as_ref().unwrap().number.to_string());
    format!("*NSET, NSET={name}\n{}\n", numbers.collect::<Vec<_>>().join("\n"))
}

const MATERIAL: &str =
    "*MATERIAL, NAME=RUBBER\n*HYPERELASTIC, NEO HOOKE\n0.2, 0.1\n*SOLID SECTION, ELSET=BODY, MATERIAL=RUBBER\n";

/// The last state of a deck.
fn solved(text: &str) -> (Analysis, ConvergedState) {
    let analysis = Study::from_text("a.inp", text).unwrap().build().unwrap();
    let times: Vec<f64> = analysis.requested.iter().map(|time| time.0).collect();
    let mut last = None;
    let mut observer = |event: Event<'_>| {
        if let Event::Converged(state) = event {
            last = Some(state.clone());
        }
    };
    let end = follow_path(&analysis.problem, &times, &analysis.solver, &mut observer);
    assert!(end.is_ok(), "{}", end.unwrap_err().0);
    (analysis, last.unwrap())
}

/// A body of two parts whose faces do not match is stretched by a fifth: it is deformed alike everywhere, as one part would be.
#[test]
fn a_constant_stress_passes_through_a_tie() {
    for kinds in [["C3D8", "C3D8"], ["C3D4", "C3D8"], ["C3D4", "C3D4"]] {
        let parts = block(kinds[0], [[0.0; 3], [2.0, 3.0, 1.0]], [1, 2, 1], 0)
            + &block(kinds[1], [[0.0, 0.0, 1.0], [2.0, 3.0, 2.0]], [2, 3, 1], 100);
        let plain = deck(&format!("{parts}{MATERIAL}*STEP\n*STATIC\n*END STEP\n"));
        let place = |name: &str, holds: &dyn Fn([f64; 3]) -> bool| set(name, &plain, holds);
        let at = |value: f64, axis: usize| move |x: [f64; 3]| (x[axis] - value).abs() < 1e-9;
        let number = |deck: &Deck, node: usize| deck.node_labels[node].as_ref().map_or(0, |label| label.number);
        let glue = |name: &str, first: bool| {
            let mesh = &plain.problem.mesh;
            let members = (0..mesh.num_nodes())
                .filter(|&n| at(1.0, 2)(mesh.nodes[n]) && number(&plain, n) > 0 && (number(&plain, n) <= 100) == first);
            let numbers: Vec<String> = members.map(|n| number(&plain, n).to_string()).collect();
            format!("*SURFACE, NAME={name}, TYPE=NODE\n{}\n", numbers.join("\n"))
        };
        let sets = place("LOW", &at(0.0, 2))
            + &place("HIGH", &at(2.0, 2))
            + &place("X", &at(0.0, 0))
            + &place("Y", &at(0.0, 1));
        let tie = glue("UNDER", true) + &glue("OVER", false) + "*TIE, NAME=GLUE, ADJUST=NO\nUNDER, OVER\n";
        let text = format!(
            "{parts}{sets}{tie}{MATERIAL}*BOUNDARY\nLOW, 3\nX, 1\nY, 2\n*STEP, NLGEOM\n*STATIC\n*BOUNDARY\nHIGH, 3, 3, 0.4\n*END STEP\n"
        );
        let (Analysis { problem, .. }, state) = solved(&text);
        let across = problem.mesh.nodes.iter().zip(&state.displacement).find(|(x, _)| x[0] == 2.0).unwrap().1[0] / 2.0;
        assert!(across < -0.05, "{kinds:?}: nothing happens");
        for (x, u) in problem.mesh.nodes.iter().zip(&state.displacement) {
            for (found, expected) in u.iter().zip([across * x[0], across * x[1], 0.2 * x[2]]) {
                assert!((found - expected).abs() < 1e-9, "{kinds:?} at {x:?}: {found} {expected}");
            }
        }
    }
}

/// A bar with a rigid end is bent by a force at a reference node beyond it: the end keeps its shape through a large turn, and the clamp bears
/// the force and its moment about where the node has come to.
#[test]
fn a_rigid_end_turns_and_passes_the_force_on() {
    let bar = block("C3D8", [[0.0; 3], [12.0, 2.0, 2.0]], [6, 1, 1], 0) + "*NODE\n900, 15., 1., 1.\n901, 0., 0., 0.\n";
    let plain = deck(&format!("{bar}{MATERIAL}*STEP\n*STATIC\n*END STEP\n"));
    let place = |name: &str, x0: f64| set(name, &plain, |x| (x[0] - x0).abs() < 1e-9);
    let sets = place("ROOT", 0.0) + &place("END", 12.0);
    let text = |constraint: &str, held: &str, step: &str| {
        format!(
            "{bar}{sets}{constraint}{MATERIAL}*BOUNDARY\nROOT, 1, 3\n{held}*STEP, NLGEOM\n*STATIC\n{step}*END STEP\n"
        )
    };
    let rigid = "*RIGID BODY, NSET=END, REF NODE=900, ROT NODE=901\n";
    let coupling = "*SURFACE, NAME=ENDS, TYPE=NODE\nEND\n*COUPLING, CONSTRAINT NAME=C, REF NODE=900, SURFACE=ENDS\n*KINEMATIC\n1, 3\n";
    let beams = "*MPC\nBEAM, END, 900\n";
    let push = "*CLOAD\n900, 3, 0.03\n";
    let mut tips = Vec::new();
    // Turning about y is what symmetry leaves: with the other rotations held the solution is the same.
    let hinge = "900, 2\n900, 4\n900, 6\n";
    let of_node = "900, 2\n901, 1\n901, 3\n";
    for (constraint, held) in [(rigid, ""), (coupling, ""), (beams, ""), (rigid, hinge), (rigid, of_node)] {
        let (Analysis { problem, .. }, state) = solved(&text(constraint, held, push));
        let now = problem.mesh.deformed(&state.displacement);
        let reference = problem.mesh.nodes.iter().position(|x| *x == [15.0, 1.0, 1.0]).unwrap();
        let mut end: Vec<usize> = (0..now.len()).filter(|&n| problem.mesh.nodes[n][0] == 12.0).collect();
        end.push(reference);
        let distance = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
        for (&a, &b) in end.iter().flat_map(|a| end.iter().map(move |b| (a, b))) {
            let [before, after] = [&problem.mesh.nodes, &now].map(|x| distance(x[a], x[b]));
            assert!((before - after).abs() < 1e-9, "{constraint}: {before} {after}");
        }
        assert!(state.displacement[reference][2] > 8.0, "{constraint}: the turn is small");
        // About the reference node the clamp's forces have no moment: the force there has none.
        let mut sum = [0.0; 3];
        let mut moment = 0.0;
        for n in (0..now.len()).filter(|&n| problem.mesh.nodes[n][0] == 0.0) {
            let force: [f64; 3] = std::array::from_fn(|k| state.reaction[n][k]);
            (0..3).for_each(|k| sum[k] += force[k]);
            let arm: [f64; 3] = std::array::from_fn(|k| now[n][k] - now[reference][k]);
            moment += arm[2] * force[0] - arm[0] * force[2];
        }
        assert!((sum[2].abs() - 0.03).abs() < 1e-8 && sum[0].abs() < 1e-8, "{constraint}: {sum:?}");
        assert!(moment.abs() < 1e-7, "{constraint}: {moment}");
        tips.push(state.displacement[reference]);
    }
    for tip in &tips[1..] {
        (0..3).for_each(|k| assert!((tip[k] - tips[0][k]).abs() < 1e-7, "{tips:?}"));
    }
}
