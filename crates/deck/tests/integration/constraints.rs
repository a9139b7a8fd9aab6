//! Ties, rigid bodies, couplings, MPCs: how they are read. `pneuflex/tests/constraints.rs` solves them.

use crate::support::{cubes, deck, errors, node, notes};

#[test]
fn what_is_coupled_is_told() {
    let lone = "*NODE\n50, 2., 0.5, 0.5\n51, 3., 0., 0.\n*SURFACE, NAME=END, TYPE=NODE\nTIP\n";
    let with = |constraint: &str, step: &str| cubes(&format!("{lone}{constraint}"), step);
    let mean = "*COUPLING, CONSTRAINT NAME=C, REF NODE=50, SURFACE=END\n*DISTRIBUTING\n1, 3\n";
    let found = deck(&with(mean, "*CLOAD\n50, 1, 1.\n"));
    let [equation, ..] = &found.problem.equations[..] else { panic!("no equation") };
    let shares: Vec<f64> = equation.terms[1..].iter().map(|term| term.2).collect();
    assert_eq!(found.problem.equations.len(), 3);
    assert!(shares.len() == 4 && shares.iter().all(|share| (share + 0.25).abs() < 1e-12), "{shares:?}");
    let pins = deck(&with("*MPC\nPIN, 9, 2\nLINK, 10, 3\nBEAM, 11, 6\n", ""));
    assert_eq!((pins.problem.equations.len(), pins.problem.distances.len()), (3, 2));
    // A reference node of an equation has the directions alone that are coupled.
    let follows = deck(&with("*EQUATION\n2\n9, 1, 1., 51, 1, -1.\n", "*BOUNDARY\n51, 1, 1, 0.1\n"));
    let held = follows.problem.held_dofs();
    assert_eq!(held[3 * node(&follows, 51) as usize..][..3], [true; 3]);
    assert!(notes(&with("", "")).iter().any(|note| note.ends_with("nodes that belong to no element are left out: 2")));
    let one = |constraint: &str, step: &str| {
        let found = errors(&with(constraint, step));
        assert_eq!(found.len(), 1, "{found:?}");
        found[0].clone()
    };
    let rigid = "*RIGID BODY, NSET=TIP, REF NODE=51\n";
    for (constraint, step, expected) in [
        (
            &*mean.replace("50", "51"),
            "",
            "lies 1.2247 mm away from the middle of the surface, (2.000000, 0.500000, 0.500000)",
        ),
        (rigid, "*BOUNDARY\n51, 4, 6\n51, 5, 5, 0.1\n", "the step says two things of it"),
        (rigid, "*BOUNDARY\n51, 4\n51, 6\n51, 5, 5, 0.1\n", "rotations can be held, not prescribed"),
        (rigid, "*BOUNDARY\n51, 4\n", "one rotation is held and two are free"),
        (
            rigid,
            "*BOUNDARY\n9, 1\n",
            "node 9 is held in direction 1 and belongs to a rigid body: hold the reference node 51 instead",
        ),
        (rigid, "*CLOAD\n51, 5, 1.\n", "nodes take no moments: let a pair of forces act"),
        (
            "*EQUATION\n2\n9, 1, 1., 51, 1, -1.\n",
            "*CLOAD\n51, 2, 1.\n",
            "nothing takes a force on node 51 in direction 2",
        ),
        (
            "*COUPLING, REF NODE=51, SURFACE=END\n*KINEMATIC\n1, 1\n",
            "",
            "single directions can be coupled only where all rotations",
        ),
        ("*COUPLING, REF NODE=51, SURFACE=END\n", "", "must be followed by one *KINEMATIC or *DISTRIBUTING"),
        ("*MPC\nMEANROT, 9, 51\n", "", "\"MEANROT\" is not supported, only BEAM, LINK, PIN, TIE"),
        (&*format!("{mean}*BOUNDARY\n50, 4\n"), "", "the mean rotation of a surface cannot be held"),
        ("*TIE, NAME=A\nA, END\n", "", "there is no surface \"A\""),
    ] {
        let found = one(constraint, step);
        assert!(found.contains(expected), "{found}");
    }
}
