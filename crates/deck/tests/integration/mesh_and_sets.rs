//! Nodes, elements, sets, surfaces, instances.

use crate::support::{CUBES, MATERIAL, NODES, STEP, cubes, deck, errors, loaded, node, notes, numbers};
use pneuflex_mesh::{ElementKind, Facet};
use pneuflex_model::Formulation;
use pneuflex_model::load::Load;

#[test]
fn nodes_and_elements_arrive_with_their_numbers() {
    let deck = deck(&cubes("", ""));
    let mesh = &deck.problem.mesh;
    assert_eq!((mesh.kind_of(0), mesh.num_nodes(), mesh.num_elements()), (ElementKind::Hex8, 12, 2));
    assert_eq!(deck.problem.formulation, Formulation::Hex8Q1p0);
    assert!((mesh.volume() - 2.0).abs() < 1e-12);
    assert_eq!(mesh.nodes[node(&deck, 12) as usize], [2.0, 1.0, 1.0]);
    assert_eq!(deck.element_labels.iter().map(|label| label.number).collect::<Vec<_>>(), [10, 20]);
}

#[test]
fn sets_take_numbers_ranges_and_other_sets() {
    let model = "*Nset, nset=Odd, generate\n1, 11, 2\n*NSET, NSET=both\n clamp , ODD,\n9,2\n*NSET, NSET=BOTH\n3\n\
                 *NSET, NSET=FROMELEMENTS, ELSET=RIGHT\n*ELSET, ELSET=E, GENERATE\n10, 20, 10\n*ELSET, ELSET=F\nleft, 20\n";
    let deck = deck(&cubes(model, ""));
    let mesh = &deck.problem.mesh;
    let nodes = |name| numbers(&deck, mesh.node_set(name));
    assert_eq!(nodes("ALL"), (1..=12).collect::<Vec<_>>());
    assert_eq!(nodes("Odd"), [1, 3, 5, 7, 9, 11]);
    assert_eq!(nodes("both"), [1, 2, 3, 4, 5, 7, 8, 9, 11]);
    assert_eq!(nodes("FROMELEMENTS"), [2, 3, 6, 7, 9, 10, 11, 12]);
    assert_eq!(
        (mesh.element_set("E"), mesh.element_set("F"), mesh.element_set("LEFT")),
        (&[0, 1][..], &[0, 1][..], &[0][..])
    );
}

#[test]
fn surfaces_take_faces_of_sets_and_elements_or_all_that_are_free() {
    let model = "*SURFACE, NAME=TOP, TYPE=ELEMENT\nBODY, S2\n*SURFACE, NAME=END\n20, S4\n*SURFACE, NAME=SKIN\nLEFT,\n";
    let deck = deck(&cubes(model, ""));
    let mesh = &deck.problem.mesh;
    let facets = |name| -> Vec<[f64; 3]> {
        let centre = |&facet: &Facet| -> [f64; 3] {
            let nodes = mesh.facet_nodes(facet);
            std::array::from_fn(|i| nodes.iter().map(|&n| mesh.nodes[n as usize][i]).sum::<f64>() / 4.0)
        };
        mesh.facet_set(name).iter().map(centre).collect()
    };
    assert_eq!(facets("TOP"), [[0.5, 0.5, 1.0], [1.5, 0.5, 1.0]]);
    assert_eq!(facets("END"), [[2.0, 0.5, 0.5]]);
    let inner = notes(&cubes("*SURFACE, NAME=A\nBODY, S4\n", ""));
    assert!(
        inner.contains(&"a.inp:30: 1 of the 2 faces lie inside of the body, between two elements".to_owned()),
        "{inner:?}"
    );
    // Five faces: the sixth touches the other cube.
    assert_eq!(facets("SKIN").len(), 5);
    assert!(facets("SKIN").iter().all(|x| x[0] < 1.0));
}

#[test]
fn long_elements_go_on_in_the_next_line() {
    // A unit cube with 20 nodes, its mid-edge nodes where Abaqus has them.
    let kind = ElementKind::Hex20;
    let mut text = String::from("*NODE\n");
    for (i, x) in kind.reference_nodes().iter().enumerate() {
        text += &format!("{}, {}, {}, {}\n", i + 1, x[0], x[1], x[2]);
    }
    text += "*ELEMENT, TYPE=C3D20R, ELSET=BODY\n1, 1,2,3,4,5,6,7,8,9,10,11,12,13,14,\n15,16,17,18,19,20\n";
    let good = deck(&format!("{text}{MATERIAL}{STEP}"));
    assert_eq!(good.problem.formulation, Formulation::Hex20);
    assert!((good.problem.mesh.volume() - 8.0).abs() < 1e-12);
    let short = text.replace(",20\n", "\n");
    assert_eq!(errors(&format!("{short}{MATERIAL}{STEP}")), ["a.inp:23: element 1 has 19 nodes instead of 20"]);
    let long = text.replace(",20\n", ",20,21\n");
    assert_eq!(errors(&format!("{long}{MATERIAL}{STEP}")), ["a.inp:24: element 1 has 21 nodes instead of 20"]);
}

const TETS: &str = "*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 0., 1., 0.
4, 0., 0., 1.
5, 1., 1., 1.
*ELEMENT, TYPE=C3D4, ELSET=BODY
1, 1, 2, 3, 4
2, 2, 5, 3, 4
*NSET, NSET=FLOOR
1, 2, 3
*NSET, NSET=EDGE
2, 5
";

#[test]
fn linear_tetrahedra_get_shared_mid_edge_nodes_which_follow_their_sets() {
    let text = format!(
        "{TETS}{MATERIAL}*BOUNDARY\nFLOOR, 3\n2, 1\n3, 1\n*STEP, NLGEOM\n*STATIC\n*CLOAD\nEDGE, 3, 2.\n*END STEP\n"
    );
    let deck = deck(&text);
    let mesh = &deck.problem.mesh;
    // Nine edges of two tetrahedra that share a face.
    assert_eq!((mesh.kind_of(0), mesh.num_nodes(), mesh.num_elements()), (ElementKind::Tet10, 5 + 9, 2));
    assert!((mesh.volume() - 0.5).abs() < 1e-14, "{}", mesh.volume());
    assert_eq!(mesh.node_set("FLOOR").len(), 6);
    assert!(mesh.node_set("FLOOR").iter().all(|&n| mesh.nodes[n as usize][2] == 0.0));
    assert_eq!(mesh.node_set("EDGE").len(), 3);
    // Supports by single nodes take in the node between them, too; forces stay on the deck's own nodes.
    let held = deck.problem.held_dofs();
    let between = (0..14).find(|&n| mesh.nodes[n] == [0.5, 0.5, 0.0]).unwrap();
    assert_eq!(held[3 * between..3 * between + 3], [true, false, true]);
    assert_eq!(held.iter().filter(|held| **held).count(), 6 + 3);
    let [pneuflex_model::load::Load::Force { nodes, .. }] = &deck.problem.loads[..] else { panic!() };
    assert_eq!(loaded(&deck, nodes), [2, 5]);
    assert!(
        deck.notes[0].to_string().starts_with("a.inp:7: C3D4 are tetrahedra with 4 nodes: straight"),
        "{}",
        deck.notes[0]
    );
}

/// A cube, a wedge beside it and a tetrahedron on the wedge.
const THREE: &str = "*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
9, 2., 0., 0.
10, 2., 0., 1.
11, 1.2, 0.2, 2.
*ELEMENT, TYPE=C3D8, ELSET=BODY
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=C3D6H, ELSET=BODY
2, 2, 9, 3, 6, 10, 7
*ELEMENT, TYPE=C3D4, ELSET=BODY
3, 6, 10, 7, 11
*NSET, NSET=FLOOR
1, 2, 3, 4, 9
*SURFACE, NAME=SIDES
1, S3
2, S3
*SURFACE, NAME=FLOOR
1, S1
2, S1
";

#[test]
fn elements_of_several_kinds_with_matching_faces_are_one_body() {
    let step = "*STEP, NLGEOM\n*STATIC\n*DLOAD\n2, P4, 0.1\n1, P6, 0.1\n*END STEP\n";
    let deck = deck(&format!("{THREE}{MATERIAL}*BOUNDARY\nFLOOR, 1, 3\n{step}"));
    let mesh = &deck.problem.mesh;
    assert_eq!(mesh.families(), [ElementKind::Hex20, ElementKind::Tet10, ElementKind::Wedge15]);
    assert!((mesh.volume() - (1.0 + 0.5 + 1.0 / 6.0)).abs() < 1e-14, "{}", mesh.volume());
    // Edges of all three, those they share once: 12 + 5 + 3.
    assert_eq!(mesh.num_nodes(), 11 + 20);
    let on_floor: Vec<u32> = mesh.select_nodes(|x| x[2] == 0.0);
    assert_eq!(mesh.node_set("FLOOR"), on_floor);
    assert_eq!(mesh.facet_set("SIDES"), mesh.select_facets(|x| x[1] == 0.0 && x[2] <= 1.0));
    assert_eq!(mesh.facet_set("FLOOR"), mesh.select_facets(|x| x[2] == 0.0));
    let faces = |load: &Load| match load {
        Load::Pressure { facets, .. } => facets.clone(),
        _ => panic!(),
    };
    let mut loaded: Vec<_> = deck.problem.loads.iter().flat_map(faces).collect();
    loaded.sort();
    let hypotenuse = |x: [f64; 3]| (x[0] + x[1] - 2.0).abs() < 1e-12 && x[2] <= 1.0;
    let expected = [mesh.select_facets(|x| x[0] == 0.0), mesh.select_facets(hypotenuse)].concat();
    assert_eq!(loaded, expected);
    assert!(deck.notes.iter().any(|note| note.to_string().contains("elements of several kinds are solved together")));
    let problem = deck.problem.solved_by(None).unwrap();
    assert_eq!(problem.element_names(), "hex27 + tet15 + wedge21");
}

#[test]
fn faces_that_do_not_match_are_refused_with_their_place() {
    // The tetrahedron stands on half of the cube.
    let torn = THREE.replace("3, 6, 10, 7, 11", "3, 5, 6, 7, 11");
    let found = errors(&format!("{torn}{MATERIAL}{STEP}"));
    assert!(
        found[0]
            .contains("elements 1 and 3 meet near (0.500000, 0.500000, 1.000000) with a quadrilateral on a triangle"),
        "{found:?}"
    );
    // A face that a wedge does not have.
    let wrong = THREE.replace("2, S3\n", "2, S6\n");
    let found = errors(&format!("{wrong}{MATERIAL}{STEP}"));
    assert!(found[0].contains("surface SIDES: \"S6\" is no face, S1 to S5 are"), "{found:?}");
}

/// A quadratic wedge beside a linear cube: the nodes in the middle of its edges are the cube's, too.
#[test]
fn linear_elements_take_the_mid_edge_nodes_of_quadratic_neighbours() {
    let wedge = "*ELEMENT, TYPE=C3D15, ELSET=BODY\n2, 2, 9, 3, 6, 10, 7, 21, 22, 23, 24, 25, 26, 27, 28,\n29\n";
    let middles = "21, 1.5, 0., 0.\n22, 1.5, 0.5, 0.\n23, 1.1, 0.5, 0.\n24, 1.5, 0., 1.\n25, 1.5, 0.5, 1.\n26, 1.1, 0.5, 1.\n\
                   27, 1., 0., 0.5\n28, 2., 0., 0.5\n29, 1., 1., 0.5\n";
    let begin = THREE.find("*ELEMENT, TYPE=C3D6H").unwrap();
    let nodes = THREE[..begin].replace("11, 1.2, 0.2, 2.\n", middles);
    let deck = deck(&format!("{nodes}{wedge}{MATERIAL}{STEP}"));
    let mesh = &deck.problem.mesh;
    assert_eq!(mesh.num_nodes(), 10 + 9 + 8);
    // The common face is curved alike.
    assert!(mesh.unmatched_faces().is_none());
    let expected: f64 = 1.5;
    assert!((mesh.volume() - expected).abs() < 1e-12, "{}", mesh.volume());
    let of_face = [mesh.element(0), mesh.element(1)]
        .map(|nodes| nodes.iter().filter(|&&n| mesh.nodes[n as usize][0] == 1.1).count());
    assert_eq!(of_face, [2, 2]);
}

#[test]
fn tetrahedra_with_ten_nodes_keep_their_order() {
    let mut text = String::from("*NODE\n");
    for (i, x) in ElementKind::Tet10.reference_nodes().iter().enumerate() {
        text += &format!("{}, {}, {}, {}\n", i + 1, x[0], x[1], x[2]);
    }
    text += "*ELEMENT, TYPE=C3D10H, ELSET=BODY\n1, 1,2,3,4,5,6,7,8,9,10\n";
    let deck = deck(&format!("{text}{MATERIAL}{STEP}"));
    assert!((deck.problem.mesh.volume() - 1.0 / 6.0).abs() < 1e-14);
}

/// As Abaqus/CAE writes decks.
const PARTS: &str = include_str!("../data/assembly.inp");

#[test]
fn instances_are_placed_copies_of_their_parts() {
    let deck = deck(PARTS);
    let mesh = &deck.problem.mesh;
    assert_eq!((deck.title.as_str(), mesh.num_nodes(), mesh.num_elements()), ("two cubes", 16, 2));
    let of = |instance: &str, number| {
        deck.node_labels.iter().flatten().position(|l| l.instance == instance && l.number == number).unwrap()
    };
    assert_eq!(mesh.nodes[of("Cube-1", 7)], [1.0, 1.0, 1.0]);
    // Moved up by 3, then turned by 90° about the line y = 0, z = 3 along x: (1, 1, 1) → (1, 1, 4) → (1, −1, 4).
    let turned = mesh.nodes[of("Cube-2", 7)];
    assert!((0..3).all(|i| (turned[i] - [1.0, -1.0, 4.0][i]).abs() < 1e-15), "{turned:?}");
    assert_eq!(mesh.node_set("Both").len(), 3);
    assert_eq!(mesh.node_set("Cube-2.Floor").len(), 4);
    assert_eq!(mesh.facet_set("Top"), [Facet { element: 0, face: 5 }]);
    let held = deck.problem.held_dofs();
    assert_eq!(held.iter().filter(|held| **held).count(), 4 * 3 + 1 + 3);
    assert!(held[3 * of("Cube-2", 1)] && held[3 * of("Cube-2", 2) + 1] && held[3 * of("Cube-1", 5) + 1]);
}

#[test]
fn broken_meshes_are_told_by_line() {
    let with = |nodes: &str, elements: &str| format!("{nodes}{elements}{MATERIAL}{STEP}");
    assert_eq!(
        errors(&with(&format!("{NODES}7, 1., 1., 1.\n"), CUBES)),
        ["a.inp:14: node 7 is there twice, first in a.inp:8"]
    );
    assert_eq!(
        errors(&with(NODES, &CUBES.replace("20, 2, 9", "20, 2, 99"))),
        ["a.inp:16: element 20: there is no node 99"]
    );
    assert_eq!(
        errors(&with(NODES, &CUBES.replace("20, 2, 9", "10, 2, 9"))),
        ["a.inp:16: element 10 is there twice, first in a.inp:15", "a.inp:20: set RIGHT: there is no element \"20\"",]
    );
    let inverted = errors(&with(NODES, &CUBES.replace("10, 1, 2, 3, 4, 5", "10, 1, 4, 3, 2, 5")));
    assert!(inverted[0].starts_with("a.inp:15: element 10 is inverted or flat: its Jacobian is -"), "{inverted:?}");
    assert_eq!(
        errors(&with(NODES, &CUBES.replace("C3D8", "S4R")))[0],
        "a.inp:14: elements of type \"S4R\" cannot be solved: only the \
                solids C3D8, C3D20, C3D10, C3D4, C3D15, C3D6 and their variants are solved"
    );
    assert_eq!(errors(&format!("{NODES}{STEP}")), ["a.inp:1: the deck has no *ELEMENT"]);
    assert_eq!(
        errors(&with(&NODES.replace("3, 1., 1., 0.", "3, 1., x, 0."), CUBES))[0],
        "a.inp:4: \"x\" is not a number"
    );
    assert_eq!(
        errors(&with(&NODES.replace("3, 1., 1., 0.", "3, 1., nan, 0."), CUBES))[0],
        "a.inp:4: \"nan\" is not a number"
    );
}

#[test]
fn broken_sets_and_surfaces_are_told_by_line() {
    let wrong = |model: &str| errors(&cubes(model, ""));
    assert_eq!(
        wrong("*NSET, NSET=A\nCLAM\n"),
        ["a.inp:30: set A: there is no node set \"CLAM\" (yet); did you mean CLAMP?"]
    );
    assert_eq!(wrong("*NSET, NSET=A\n77\n"), ["a.inp:30: set A: there is no node \"77\""]);
    assert_eq!(wrong("*ELSET, ELSET=A\n11\n"), ["a.inp:30: set A: there is no element \"11\""]);
    assert_eq!(wrong("*NSET\n1\n"), ["a.inp:29: *NSET needs NSET=…"]);
    assert_eq!(
        wrong("*NSET, NSET=A, GENERATE\n5, 1\n")[0],
        "a.inp:30: GENERATE takes the first number, the last, which is not smaller, and a positive increment"
    );
    assert_eq!(
        wrong("*SURFACE, NAME=A\nLEFT, S7\n"),
        ["a.inp:29: surface A is empty", "a.inp:30: surface A: \"S7\" is no face, S1 to S6 are"]
    );
    assert_eq!(
        wrong("*SURFACE, NAME=A, TYPE=CUTTING SURFACE\nCLAMP\n"),
        ["a.inp:29: *SURFACE: TYPE=\"CUTTING SURFACE\" is not supported, only ELEMENT or NODE"]
    );
    assert_eq!(
        wrong("*SURFACE, NAME=A, TYPE=NODE\n1, 2, 3\n"),
        ["a.inp:29: surface A is empty: no free face has all its corners among its nodes"]
    );
    assert_eq!(
        wrong("*SURFACE, NAME=A, TYPE=NODE\nCLAM\n")[1],
        "a.inp:30: *SURFACE: there is no node set \"CLAM\" (yet); did you mean CLAMP?"
    );
    assert_eq!(wrong("*NSET, NSET=A, INSTANCE=P\n1\n"), ["a.inp:29: there is no instance \"P\""]);
    assert_eq!(
        notes(&cubes("*NSET, NSET=A, GENERATE\n1, 2000000000\n", ""))[1],
        "a.inp:30: of 2000000000 generated nodes 12 exist"
    );
}

#[test]
fn a_surface_of_nodes_is_the_faces_between_them() {
    let text = cubes("*SURFACE, NAME=A, TYPE=NODE\nCLAMP, 0.25\n2,\n3,\n", "");
    // The left face of the left cube and its underside; the face between the cubes lacks two corners, and is not free.
    let expected = [Facet { element: 0, face: 0 }, Facet { element: 0, face: 4 }];
    let mut found = deck(&text).problem.mesh.facet_set("A").to_vec();
    found.sort_unstable();
    assert_eq!(found, expected);
    assert!(notes(&text).iter().any(|note| {
        note == "a.inp:29: surface A, 6 nodes, is taken as the 2 free faces that have all their corners among them"
    }));
}

#[test]
fn nodes_without_elements_are_left_out_with_a_note() {
    let text = cubes("*NODE\n99, 5., 5., 5.\n*NSET, NSET=A\n1, 99\n", "");
    let found = deck(&text);
    assert_eq!((found.problem.mesh.num_nodes(), found.problem.mesh.node_set("A").len()), (12, 1));
    let notes = notes(&text);
    assert!(notes.contains(&"a.inp:30: nodes that belong to no element are left out: 1".to_owned()), "{notes:?}");
}
