//! Supports, loads, amplitudes, steps, contact.

use crate::support::{cubes, deck, errors, loaded, node, notes, numbers};
use pneuflex_mesh::Facet;
use pneuflex_model::load::Load;
use pneuflex_model::{ContactMethod, Curve, LoadParameter};

fn table(points: &[[f64; 2]]) -> Curve {
    Curve::Table(points.to_vec())
}

fn steps(steps: &[&str]) -> String {
    let one = cubes("", steps[0]);
    steps[1..].iter().fold(one, |text, step| text + "*STEP, NLGEOM\n*STATIC\n" + step + "*END STEP\n")
}

#[test]
fn supports_hold_directions_of_nodes_and_sets() {
    let model = "*BOUNDARY\nCLAMP, 1, 3\n9, 2\n10, 2, 6, 0.\nTIP, ZSYMM\n";
    let deck = deck(&cubes(model, ""));
    let held = deck.problem.held_dofs();
    let of = |number| -> Vec<bool> { held[3 * node(&deck, number) as usize..][..3].to_vec() };
    assert_eq!(
        (of(1), of(9), of(10), of(11), of(2)),
        (vec![true; 3], vec![false, true, true], vec![false, true, true], vec![false, false, true], vec![false; 3])
    );
    let mut names: Vec<&str> = deck.problem.supports.iter().map(|support| support.name.as_str()).collect();
    names.dedup();
    assert_eq!(names, ["CLAMP", "TIP", "nodes"]);
    assert!(deck.problem.supports.iter().all(|support| support.motion.is_none()));
    assert!(deck.notes.iter().any(|note| note.text.contains("directions 4 to 6 are left out")));
    for (name, axes) in [
        ("PINNED", [true; 3]),
        ("ENCASTRE", [true; 3]),
        ("XSYMM", [true, false, false]),
        ("ysymm", [false, true, false]),
    ] {
        let deck = self::deck(&cubes(&format!("*BOUNDARY\nCLAMP, {name}\n"), ""));
        assert_eq!(deck.problem.supports[0].axes, axes, "{name}");
    }
}

#[test]
fn displacements_move_over_their_steps() {
    let deck = deck(&steps(&["*BOUNDARY\nCLAMP, 1, 3\nTIP, 1, 1, 0.5\n", "*BOUNDARY, OP=MOD\nTIP, 1, 1, -1.\n", ""]));
    assert_eq!(deck.schedule.times, [1.0, 2.0, 3.0]);
    let tip = node(&deck, 9) as usize;
    for (time, expected) in [(0.0, 0.0), (0.5, 0.25), (1.0, 0.5), (1.5, -0.25), (2.0, -1.0), (2.7, -1.0)] {
        let displacement = deck.problem.held_displacement(LoadParameter(time));
        assert_eq!(displacement[tip], [expected, 0.0, 0.0], "at {time}");
        assert_eq!(displacement[node(&deck, 1) as usize], [0.0; 3]);
    }
}

#[test]
fn forces_grow_add_up_and_are_taken_away() {
    let text = steps(&["*CLOAD\nTIP, 3, 2.\n9, 3, 1.\n12, 1, -1.\n", "*CLOAD, OP=NEW\n9, 3, 4.\n"]);
    let deck = deck(&text);
    let found: Vec<(Vec<i32>, [f64; 3], Curve)> = deck
        .problem
        .loads
        .iter()
        .map(|load| match load {
            Load::Force { nodes, force, curve } => (loaded(&deck, nodes), *force, curve.clone()),
            _ => panic!(),
        })
        .collect();
    let of = |nodes: &[i32]| found.iter().find(|(n, ..)| n == nodes).unwrap();
    assert_eq!(found.len(), 3);
    assert_eq!(*of(&[10, 11, 12]), (vec![10, 11, 12], [0.0, 0.0, 1.0], table(&[[0.0, 0.0], [1.0, 2.0], [2.0, 0.0]])));
    assert_eq!(*of(&[9]), (vec![9], [0.0, 0.0, 1.0], table(&[[0.0, 0.0], [1.0, 3.0], [2.0, 4.0]])));
    assert_eq!(*of(&[12]), (vec![12], [1.0, 0.0, 0.0], table(&[[0.0, 0.0], [1.0, -1.0], [2.0, 0.0]])));
    assert!(notes(&text).iter().any(|note| note.contains("a.inp:33: loads on \"9\" that the step names twice add up")));
}

#[test]
fn pressures_act_on_faces_and_surfaces() {
    let surface = "*SURFACE, NAME=END\nRIGHT, S4\n";
    let deck = deck(&cubes(surface, "*DLOAD\nBODY, P2, 0.01\n10, P1, 0.02\n*DSLOAD\nend, p, 0.03\n"));
    let found: Vec<_> = deck
        .problem
        .loads
        .iter()
        .map(|load| match load {
            Load::Pressure { facets, curve } => (curve.at(LoadParameter(1.0)), facets.clone()),
            _ => panic!(),
        })
        .collect();
    let facet = |element, face| Facet { element, face };
    assert_eq!(found.len(), 3);
    assert!(found.contains(&(0.01, vec![facet(0, 5), facet(1, 5)])));
    assert!(found.contains(&(0.02, vec![facet(0, 4)])));
    assert!(found.contains(&(0.03, vec![facet(1, 1)])));
}

#[test]
fn weight_acts_along_its_direction() {
    let text = cubes("", "*DLOAD\nRIGHT, GRAV, 10., 0., 3., -4.\n, GRAV, 1., 1., 0., 0.\n")
        .replace("0.2, 0.01\n", "0.2, 0.01\n*DENSITY\n1e-9\n");
    let deck = deck(&text);
    let mut acceleration = [[0.0; 3]; 2];
    for load in &deck.problem.loads {
        let Load::Gravity { elements, acceleration: unit, curve } = load else { panic!() };
        for element in elements.clone().unwrap_or(vec![0, 1]) {
            (0..3).for_each(|i| acceleration[element as usize][i] += unit[i] * curve.at(LoadParameter(1.0)));
        }
    }
    assert_eq!(acceleration, [[1.0, 0.0, 0.0], [1.0, 6.0, -8.0]]);
    let without = text.replace("*DENSITY\n1e-9\n", "");
    assert_eq!(errors(&without), ["a.inp:32: gravity acts, but material RUBBER has no *DENSITY"]);
}

#[test]
fn amplitudes_shape_values() {
    let model = "*AMPLITUDE, NAME=A\n0., 0., 0.5, 2., 1., 1.\n*AMPLITUDE, NAME=B, VALUE=ABSOLUTE, TIME=TOTAL TIME\n0., 0.,\n2., 8.\n";
    let text = cubes(
        model,
        "*CLOAD, AMPLITUDE=a\n9, 1, 3.\n*CLOAD, AMPLITUDE=B\n10, 1, 77.\n*BOUNDARY, AMPLITUDE=A\nCLAMP, 1, 1, 0.1\n",
    );
    let deck = deck(&(text + "*STEP, NLGEOM\n*STATIC\n*END STEP\n"));
    let curve = |number: i32| {
        let is_on = |load: &&Load| matches!(load, Load::Force { nodes, .. } if loaded(&deck, nodes) == [number]);
        let Some(Load::Force { curve, .. }) = deck.problem.loads.iter().find(is_on) else { panic!() };
        curve
    };
    assert_eq!([0.25, 0.5, 1.0, 2.0].map(|t| curve(9).at(LoadParameter(t))), [3.0, 6.0, 3.0, 3.0]);
    assert_eq!([0.25, 0.5, 1.0, 2.0].map(|t| curve(10).at(LoadParameter(t))), [1.0, 2.0, 4.0, 8.0]);
    assert_eq!(deck.problem.held_displacement(LoadParameter(0.5))[node(&deck, 1) as usize][0], 0.2);
}

#[test]
fn equations_bind_displacements() {
    let model = "*EQUATION\n2\n9, 1, 1., 10, 1, -1.\n3\n11, 2, 2.,\n12, 3, 0.5, 1, 1, 1\n*NSET, NSET=A\n2, 3\n*NSET, NSET=B\n6, 7\n*EQUATION\n2\nA, 3, 1., B, 3, -1.\n";
    let deck = deck(&cubes(model, ""));
    let terms: Vec<Vec<(i32, u8, f64)>> = deck
        .problem
        .equations
        .iter()
        .map(|equation| equation.terms.iter().map(|&(n, axis, c)| (numbers(&deck, &[n])[0], axis, c)).collect())
        .collect();
    assert_eq!(
        terms,
        [
            vec![(9, 0, 1.0), (10, 0, -1.0)],
            vec![(11, 1, 2.0), (12, 2, 0.5), (1, 0, 1.0)],
            vec![(2, 2, 1.0), (6, 2, -1.0)],
            vec![(3, 2, 1.0), (7, 2, -1.0)],
        ]
    );
    assert!(deck.problem.equations.iter().all(|equation| equation.value == Curve::ZERO));
}

#[test]
fn steps_follow_each_other() {
    let one = "*STEP, NLGEOM, INC=100\n*STATIC, DIRECT\n0.25, 0.5\n*END STEP\n";
    let text = cubes("*HEADING\nA title, with a comma\n", "").replace("*STATIC\n", "*STATIC\n0.1, 2.\n") + one;
    let deck = deck(&text);
    assert_eq!(deck.title, "A title, with a comma");
    assert_eq!((deck.schedule.times, deck.schedule.first_increment), (vec![2.0, 2.25, 2.5], 0.1));
    assert!(
        notes(&text.replace(", NLGEOM", ""))
            .iter()
            .any(|note| note.contains("a step without NLGEOM is solved with large"))
    );
}

const WALLS: &str = "*SURFACE, NAME=S\nLEFT, S4\n*SURFACE, NAME=M\nRIGHT, S6\n";

#[test]
fn contact_pairs_have_their_surfaces_and_stiffness() {
    let model = format!(
        "{WALLS}*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n25.\n*FRICTION\n0.\n\
         *CONTACT PAIR, INTERACTION=i, TYPE=SURFACE TO SURFACE\ns, M\n"
    );
    let problem = deck(&cubes(&model, "")).problem;
    assert_eq!((problem.contact.method, problem.contact.stiffness), (ContactMethod::MultiPoint, 25.0));
    let pair = &problem.contact_pairs[0];
    assert_eq!(
        (pair.name.as_str(), &pair.slave[..], &pair.master[..]),
        ("s on M", &[Facet { element: 0, face: 1 }][..], &[Facet { element: 1, face: 0 }][..])
    );
    let hard = model.replace("=LINEAR\n25.", "=HARD");
    let problem = deck(&cubes(&hard, "")).problem;
    // Ten times Young's modulus 3 · 0.4 over faces of 1 mm.
    assert!((problem.contact.stiffness - 12.0).abs() < 1e-12);
    assert!(
        notes(&cubes(&hard, ""))
            .iter()
            .any(|note| note.contains("hard contact of s on M is a penalty of 12.0000 N/mm3"))
    );
    assert_eq!(deck(&cubes("", "")).problem.contact.method, ContactMethod::None);
    let wrong = |from: &str, to: &str| errors(&cubes(&model.replace(from, to), ""));
    assert!(wrong("=LINEAR", "=EXPONENTIAL")[0].contains("only HARD or LINEAR"));
    assert!(wrong("*FRICTION\n0.", "*FRICTION\n0.3")[0].contains("contact is without friction"));
    assert!(wrong("s, M", "s, MM")[0].contains("there is no surface \"MM\""));
    assert!(wrong("s, M", "s, M, s")[0].contains("one surface that may touch itself"));
    assert!(wrong("INTERACTION=i", "INTERACTION=j")[0].contains("there is no surface interaction \"j\""));
    assert!(wrong("25.", "0.")[0].contains("greater than 0"));
    assert!(wrong("TYPE=SURFACE TO SURFACE", "ADJUST=0.1")[0].contains("ADJUST is not supported"));
}

#[test]
fn every_contact_pair_has_its_own_stiffness_and_a_surface_may_touch_itself() {
    let model = format!(
        "{WALLS}*SURFACE INTERACTION, NAME=SOFT\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n5.\n\
         *SURFACE INTERACTION, NAME=STIFF\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n25.\n\
         *CONTACT PAIR, INTERACTION=STIFF, TYPE=SURFACE TO SURFACE\nS, M\n\
         *CONTACT PAIR, INTERACTION=SOFT, TYPE=SURFACE TO SURFACE\nS\nM, m\n"
    );
    let pairs = deck(&cubes(&model, "")).problem.contact_pairs;
    let found: Vec<_> = pairs.iter().map(|pair| (pair.name.as_str(), pair.stiffness, pair.is_self())).collect();
    let expected = [("S on M", Some(25.0), false), ("S on itself", Some(5.0), true), ("M on itself", Some(5.0), true)];
    assert_eq!(found, expected);
}

#[test]
fn output_requests_are_left_out_with_a_note() {
    let step = "*NODE FILE\nU\n*EL FILE\nS\n*NODE PRINT, NSET=TIP\nU\n*EL PRINT, ELSET=BODY\nS\n*OUTPUT, FIELD\n*NODE OUTPUT\nU\n\
                *ELEMENT OUTPUT\nS\n*RESTART, WRITE\n*CONTACT FILE\nCDIS\n*NODE FILE\nRF\n";
    let notes = notes(&cubes("*PREPRINT, ECHO=NO\n", step));
    let left_out: Vec<&String> = notes.iter().filter(|note| note.contains("is left out")).collect();
    assert_eq!(left_out.len(), 10, "{left_out:?}");
    assert!(
        left_out
            .iter()
            .any(|note| note.ends_with("*NODE FILE is left out: it does not change what is solved (2 times)"))
    );
}

#[test]
fn what_cannot_be_is_told_by_line() {
    let wrong = |model: &str, step: &str| errors(&cubes(model, step));
    let one = |model: &str, step: &str| {
        let found = wrong(model, step);
        assert_eq!(found.len(), 1, "{found:?}");
        found[0].clone()
    };
    assert_eq!(
        one("*BUONDARY\nCLAMP, 1\n", ""),
        "a.inp:29: *BUONDARY is not a keyword that is known here; did you mean *BOUNDARY?"
    );
    assert_eq!(
        one("*EMBEDDED ELEMENT\nA\n", ""),
        "a.inp:29: *EMBEDDED ELEMENT is not supported: surfaces and nodes are coupled by *TIE, *COUPLING, *RIGID BODY, *MPC and *EQUATION, \
         or share nodes"
    );
    assert_eq!(one("*BOUNDARY, FIXED\nCLAMP, 1\n", ""), "a.inp:29: *BOUNDARY: parameter \"FIXED\" is not supported");
    assert_eq!(
        one("*BOUNDARY\nCLMAP, 1\n", ""),
        "a.inp:30: *BOUNDARY: there is no node set \"CLMAP\" (yet); did you mean CLAMP?"
    );
    assert_eq!(one("*BOUNDARY\nCLAMP, 11\n", ""), "a.inp:30: *BOUNDARY: directions 11 to 11 are not within 1 to 3");
    assert_eq!(
        one("*BOUNDARY\nCLAMP, XASYMM\n", ""),
        "a.inp:30: \"XASYMM\" is not supported, only directions 1 to 3 and PINNED, ENCASTRE, XSYMM, YSYMM, ZSYMM"
    );
    assert_eq!(
        one("*BOUNDARY\nCLAMP, 1, 1, 0.5\n", ""),
        "a.inp:30: node 1, direction 1: a displacement other than 0 must stand in a step"
    );
    assert_eq!(
        one("", "*BOUNDARY\nCLAMP, 1, 1, 0.5\n1, 1, 1, 0.6\n"),
        "a.inp:33: node 1, direction 1: the step says two things of it, first in line 32"
    );
    assert_eq!(
        one("", "*CLOAD\nTIP, 4, 1.\n"),
        "a.inp:32: *CLOAD: direction 4 is not within 1 to 3; nodes take no moments: let a pair of forces act"
    );
    assert_eq!(one("", "*DLOAD\nBODY, P, 1.\n"), "a.inp:32: *DLOAD: \"P\" is not supported, only P1 to P6 and GRAV");
    assert_eq!(
        one("", "*DLOAD\nBODY, GRAV, 1.\n"),
        "a.inp:32: *DLOAD: GRAV takes a magnitude and the three components of its direction"
    );
    assert_eq!(one("", "*DSLOAD\nTOP, P, 1.\n"), "a.inp:32: *DSLOAD: there is no surface \"TOP\" (yet)");
    assert_eq!(one("", "*CLOAD, AMPLITUDE=X\nTIP, 1, 1.\n"), "a.inp:31: there is no amplitude \"X\"");
    assert_eq!(
        one("*AMPLITUDE, NAME=A\n1., 0., 0., 1.\n", ""),
        "a.inp:29: *AMPLITUDE: times must increase from 0 or more"
    );
    assert_eq!(
        one("*EQUATION\n2\n9, 1, 1.\n", ""),
        "a.inp:30: *EQUATION takes the number of terms, then node, direction and coefficient of each"
    );
    assert_eq!(
        one("*BOUNDARY\n9, 1\n*EQUATION\n2\n9, 1, 1., 10, 1, -1.\n", ""),
        "a.inp:32: the first term of the equation, node 9 direction 1, is held by *BOUNDARY"
    );
    assert_eq!(one("*CLOAD\n9, 1, 1.\n", ""), "a.inp:29: *CLOAD must stand in a *STEP");
    assert_eq!(one("", "*NODE\n9, 1., 1., 1.\n"), "a.inp:31: *NODE must stand before the first *STEP");
    let dynamic = cubes("", "").replace("*STATIC", "*DYNAMIC");
    assert!(errors(&dynamic)[1].contains("*DYNAMIC is not supported"));
    assert!(
        errors(&dynamic.replace("*END STEP\n", "")).iter().any(|error| error == "a.inp:29: *STEP without *END STEP")
    );
    let late = steps(&["*BOUNDARY\nCLAMP, 1, 3\n", "*BOUNDARY\nTIP, 1\n"]);
    assert_eq!(
        errors(&late),
        ["a.inp:37: node 9, direction 1: it is held from step 2 on; supports must hold from the first step on"]
    );
    let freed = steps(&["*BOUNDARY\nCLAMP, 1, 3\n", "*BOUNDARY, OP=NEW\n1, 1, 3\n"]);
    assert_eq!(
        errors(&freed),
        [
            "a.inp:36: *BOUNDARY, OP=NEW lets go of node 4 (and maybe others), which was held before; supports cannot be let go of"
        ]
    );
}
