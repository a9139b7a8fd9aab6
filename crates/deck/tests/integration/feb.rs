//! FEBio's files: the same problem as the same body as an Abaqus deck; what is meant otherwise, and what is refused.

use pneuflex_deck::{Deck, Extent, feb};
use pneuflex_mesh::ElementKind;
use pneuflex_model::load::Load;
use pneuflex_model::{Clock, Curve, Law, LoadParameter, Material, OgdenTerm, Solver, Volumetric};
use pneuflex_newton::{Event, follow_path};

use crate::support::{cubes, deck, numbers};

const MATERIAL: &str = "<material id=\"1\" name=\"rubber\" type=\"Mooney-Rivlin\"><c1>0.2</c1><c2>0</c2><k>200</k><pressure_model>Abaqus</pressure_model></material>";

/// The two cubes of the other decks: the first clamped, the second moved at its end, with a pressure on its top and a force.
const CUBES: &str = include_str!("../../../../fixtures/decks/cubes.feb");

/// The cubes with texts put in the place of others.
fn edited(edits: &[(&str, &str)]) -> String {
    let mut text = CUBES.to_owned();
    for (from, to) in edits {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    text
}

fn good(edits: &[(&str, &str)]) -> Deck {
    feb::read("a.feb", edited(edits).as_bytes(), Extent::Problem)
        .unwrap_or_else(|errors| panic!("{edits:?}: {errors:?}"))
}

fn refused(edits: &[(&str, &str)]) -> Vec<String> {
    let errors = feb::read("a.feb", edited(edits).as_bytes(), Extent::Problem).expect_err("read without complaint");
    errors.iter().map(ToString::to_string).collect()
}

/// Displacements at the end.
fn solved(deck: &Deck) -> Vec<[f64; 3]> {
    let settings = Solver { first_step: 0.25, max_step: 1.0, min_step: 1e-3, tolerance: 1e-12, ..Solver::default() };
    let mut last = Vec::new();
    let mut observer = |event: Event<'_>| {
        if let Event::Converged(state) = event {
            last = state.displacement.to_vec();
        }
    };
    follow_path(&deck.problem, &[1.0], &settings, &mut observer).unwrap_or_else(|ended| panic!("{}", ended.0));
    last
}

#[test]
fn the_same_body_as_another_deck_is_the_same_problem() {
    let (found, other) = (
        good(&[]),
        deck(&cubes(
            "*BOUNDARY\nCLAMP, 1, 3\n*SURFACE, NAME=TOP\nRIGHT, S2\n",
            "*BOUNDARY\nTIP, 3, 3, 0.3\n*DSLOAD\nTOP, P, 0.01\n*CLOAD\nTIP, 1, 0.02\n",
        )),
    );
    assert_eq!(found.problem.mesh.nodes, other.problem.mesh.nodes);
    assert_eq!(found.problem.mesh.connectivity, other.problem.mesh.connectivity);
    assert_eq!(found.problem.material, other.problem.material);
    assert_eq!(found.problem.clock, Clock::Steps);
    assert_eq!(found.schedule.times, [0.25, 0.5, 0.75, 1.0]);
    assert_eq!(found.problem.held_dofs(), other.problem.held_dofs());
    let at = LoadParameter(0.7);
    assert_eq!(found.problem.held_displacement(at), other.problem.held_displacement(at));
    let (a, b) = (solved(&found), solved(&other));
    let difference = a.as_flattened().iter().zip(b.as_flattened()).fold(0.0_f64, |d, (a, b)| d.max((a - b).abs()));
    assert!(difference < 1e-12 && a.as_flattened().iter().any(|u| u.abs() > 0.2), "{difference:e}");
    assert_eq!(numbers(&found, found.problem.mesh.node_set("tip")), [9, 10, 11, 12]);
    assert_eq!(found.problem.mesh.element_set("right"), [1]);
}

/// A surface whose faces all look into the body is pressed from within; forms of version 3.
#[test]
fn other_ways_to_say_the_same() {
    let pressure = |deck: &Deck| match &deck.problem.loads[0] {
        Load::Pressure { curve, .. } => curve.at(LoadParameter(1.0)),
        _ => panic!("no pressure"),
    };
    assert_eq!(pressure(&good(&[])), 0.01);
    assert_eq!(pressure(&good(&[("6,11,12,7</quad4>", "6,7,12,11</quad4>")])), -0.01);
    let old = good(&[
        ("version=\"4.0\"", "version=\"3.0\""),
        (
            "type=\"zero displacement\"><x_dof>1</x_dof><y_dof>1</y_dof><z_dof>1</z_dof>",
            "type=\"fix\"><dofs>x,y,z</dofs>",
        ),
        ("type=\"prescribed displacement\"", "type=\"prescribe\""),
        ("<value lc=\"1\">0.3</value>", "<scale lc=\"1\">0.3</scale>"),
        (
            "<NodeSet name=\"clamp\">1,4,5,8</NodeSet>",
            "<NodeSet name=\"clamp\"><n id=\"1\"/><n id=\"4\"/><n id=\"5\"/><n id=\"8\"/></NodeSet>",
        ),
        ("<pt>0,0</pt><pt>1,1</pt>", "<point>0,0</point><point>1,1</point>"),
    ]);
    assert_eq!(old.problem, good(&[]).problem);
    let step = good(&[
        ("<Boundary>", "<Step><step id=\"1\"><Boundary>"),
        ("</Loads>", "</Loads></step></Step>"),
        ("node_set=\"tip\" type=\"nodal_load\"", "node_set=\"@surface:end\" type=\"nodal_load\""),
    ]);
    assert_eq!(step.problem, good(&[]).problem);
    // Without a load curve a value is there at once, nearly.
    let jump = good(&[("<pressure lc=\"1\">", "<pressure>")]);
    let Load::Pressure { curve, .. } = &jump.problem.loads[0] else { panic!("no pressure") };
    assert_eq!([0.0, 1e-3, 1.0].map(|t| curve.at(LoadParameter(t))), [0.0, 0.01, 0.01]);
    assert!(jump.notes.iter().any(|note| note.text.contains("first thousandth")));
    // Steps of a size of their own end where they must.
    let stepper = "<step_size>0.25</step_size><time_stepper><dtmax lc=\"2\">1</dtmax></time_stepper>";
    let must = "</LoadData>";
    let curve = "<load_controller id=\"2\" type=\"loadcurve\"><interpolate>STEP</interpolate><points><pt>0,0</pt><pt>0.4,1</pt><pt>1,1</pt>\
                 </points></load_controller></LoadData>";
    assert_eq!(good(&[("<step_size>0.25</step_size>", stepper), (must, curve)]).schedule.times, [0.4, 1.0]);
}

#[test]
fn constants_arrive_in_their_laws() {
    let material = |text: &str| {
        good(&[(MATERIAL, &format!("<material id=\"1\" name=\"rubber\" {text}</material>"))]).problem.material
    };
    let of = |law: Law, bulk_modulus: f64| Material {
        bulk_modulus,
        volumetric: Volumetric::Logarithmic,
        ..Material::from(law)
    };
    let polynomial = Law::Polynomial { c10: 0.2, c01: 0.05, c20: 0.0, c11: 0.0, c02: 0.0 };
    let cases = [
        ("type=\"Mooney-Rivlin\"><c1>0.2</c1><c2>0.05</c2><k>200</k>", of(polynomial, 200.0)),
        ("type=\"Yeoh\"><c1>0.2</c1><c2>0.02</c2><k>200</k>", of(Law::Yeoh { c10: 0.2, c20: 0.02, c30: 0.0 }, 200.0)),
        (
            "type=\"Ogden\"><m1>2.5</m1><c1>0.8</c1><m2>-2</m2><c2>0.1</c2><k>200</k>",
            of(
                Law::Ogden { terms: [(0.4, 2.5), (0.05, -2.0)].map(|(mu, alpha)| OgdenTerm { mu, alpha }).to_vec() },
                200.0,
            ),
        ),
        ("type=\"Gent\"><G>0.4</G><Jm>20</Jm><k>200</k>", of(Law::Gent { shear_modulus: 0.4, jm: 20.0 }, 200.0)),
        ("type=\"neo-Hookean\"><E>0.9</E><v>0.25</v>", of(Law::NeoHooke { c10: 0.18 }, 0.6)),
        (
            "type=\"incomp neo-Hookean\"><density>1e-9</density><G>0.4</G><k>200</k>",
            Material { density: 1.0, ..of(Law::NeoHooke { c10: 0.2 }, 200.0) },
        ),
    ];
    for (text, expected) in cases {
        assert_eq!(material(text), expected, "{text}");
    }
}

/// Nodes in faces and inside are told by where they lie; sets of corners take in the nodes that tetrahedra get on their edges.
#[test]
fn elements_of_other_families() {
    let kind = ElementKind::Hex27;
    let swapped: Vec<usize> = (0..20).chain([26, 24, 21, 25, 23, 20, 22]).collect();
    let nodes: String = (swapped.iter().zip(1..))
        .map(|(&n, id)| {
            let [x, y, z] = kind.nodes[n];
            format!("<node id=\"{id}\">{x},{y},{z}</node>")
        })
        .collect();
    let list = |count: usize| (1..=count).map(|n| n.to_string()).collect::<Vec<_>>().join(",");
    let from = |text: &str, to: &str| {
        let (a, b) = (CUBES.find(text).unwrap(), CUBES.find(to).unwrap());
        CUBES[a..b].to_owned()
    };
    let mesh = |nodes: &str, kind: &str, count: usize| {
        format!(
            "<Mesh><Nodes>{nodes}</Nodes><Elements type=\"{kind}\" name=\"left\"><elem id=\"1\">{}</elem></Elements>\
             <NodeSet name=\"clamp\">1,2,3</NodeSet><NodeSet name=\"tip\">4</NodeSet>\
             <Surface name=\"top\"><tri3 id=\"1\">1,2,3</tri3></Surface>",
            list(count)
        )
    };
    let (before, right, loads) =
        (from("<Mesh>", "<SurfacePair"), "<SolidDomain name=\"right\" mat=\"rubber\"/>", from("<Loads>", "<LoadData>"));
    let pair = from("<SurfacePair", "</Mesh>");
    let edit = |text: String| good(&[(&before, &text), (&pair, ""), (right, ""), (&loads, "")]);
    let found = edit(mesh(&nodes, "hex27", 27).replace("<tri3 id=\"1\">1,2,3</tri3>", ""));
    let [of_file, ours] = [&found.problem.mesh.nodes, &kind.nodes.to_vec()];
    assert!(found.problem.mesh.element(0).iter().zip(ours).all(|(&node, x)| of_file[node as usize] == *x));
    let tetrahedron =
        "<node id=\"1\">0,0,0</node><node id=\"2\">1,0,0</node><node id=\"3\">0,1,0</node><node id=\"4\">0,0,1</node>";
    let found = edit(mesh(tetrahedron, "tet4", 4));
    assert_eq!(found.problem.mesh.node_set("clamp").len(), 6);
    assert_eq!(found.problem.mesh.facet_set("top").len(), 1);
    assert_eq!(found.problem.supports[0].nodes.len(), 6);
}

#[test]
fn contact_and_ties() {
    let contact = |text: &str| {
        format!("</Boundary><Contact><contact name=\"gap\" surface_pair=\"pair\" {text}</contact></Contact>")
    };
    let sliding =
        good(&[("</Boundary>", &contact("type=\"sliding-elastic\"><penalty>5</penalty><two_pass>1</two_pass>"))]);
    let [pair] = &sliding.problem.contact_pairs[..] else { panic!("{:?}", sliding.problem.contact_pairs) };
    assert_eq!((pair.name.as_str(), pair.stiffness, pair.is_two_pass), ("gap", Some(5.0), true));
    let augmented = "type=\"sliding-elastic\"><penalty>2</penalty><auto_penalty>1</auto_penalty><laugon>AUGLAG</laugon><gaptol>0.01</gaptol>";
    let augmented = good(&[("</Boundary>", &contact(augmented))]);
    let pair = &augmented.problem.contact_pairs[0];
    // Young's modulus 1.2 MPa, faces of 1 mm.
    assert!((pair.stiffness.unwrap() - 2.4).abs() < 1e-12 && pair.penetration_tolerance == Some(0.01), "{pair:?}");
    let tied = good(&[("</Boundary>", &contact("type=\"tied-elastic\">"))]);
    assert_eq!((tied.problem.ties.len(), tied.problem.contact_pairs.len()), (1, 0));
}

#[test]
fn what_is_not_solved_is_refused_by_name_and_line() {
    let cases: [(&[(&str, &str)], &str); 24] = [
        (&[("version=\"4.0\"", "version=\"2.5\"")], "a.feb:2: <febio_spec> of version \"2.5\" is not supported"),
        (&[("type=\"solid\"", "type=\"biphasic\"")], "a.feb:3: module \"biphasic\" is not supported"),
        (&[("STATIC", "DYNAMIC")], "a.feb:4: analysis \"DYNAMIC\" is not supported"),
        (&[("<time_steps>4", "<time_steps>0")], "a.feb:4: <time_steps> and <step_size>"),
        (&[("<Globals>", "<Rigid><rigid_bc/></Rigid><Globals>")], "a.feb:5: <Rigid> in <febio_spec> is not supported"),
        (
            &[("\"Mooney-Rivlin\"", "\"viscoelastic\"")],
            "a.feb:6: material \"viscoelastic\" is not supported, only neo-Hookean",
        ),
        (&[("<c2>0</c2>", "<c2>0</c2><c3>1</c3>")], "a.feb:6: <c3> in <material> is not supported"),
        (&[("<c1>0.2", "<c1>-0.2")], "a.feb:6: material rubber.c10"),
        (&[("<c1>", "<c1 type=\"map\">")], "a.feb:6: <c1> is the same everywhere"),
        (&[(">Abaqus<", ">NIKE3D<")], "a.feb:6: <pressure_model> \"NIKE3D\" is not supported"),
        (&[("id=\"12\">2,1,1", "id=\"12\">2,1")], "a.feb:11: a node takes three coordinates"),
        (
            &[("type=\"hex8\" name=\"left\"", "type=\"quad4\" name=\"left\"")],
            "a.feb:13: elements \"quad4\" are not solved",
        ),
        (&[("5,6,7,8</elem>", "5,6,7,99</elem>")], "a.feb:13: element 10: there is no node 99"),
        (&[("6,11,12,7</quad4>", "1,2,11,12</quad4>")], "a.feb:18: the face belongs to no element"),
        (
            &[("name=\"left\" mat=\"rubber\"", "name=\"left\" mat=\"ruber\"")],
            "there is no material \"ruber\"; did you mean rubber?",
        ),
        (&[("<SolidDomain name=\"left\" mat=\"rubber\"/>", "")], "part \"left\" has no <SolidDomain>"),
        (
            &[("node_set=\"clamp\"", "node_set=\"clam\"")],
            "a.feb:24: there is no node set \"clam\"; did you mean clamp?",
        ),
        (
            &[("node_set=\"tip\" type=\"prescribed", "node_set=\"clamp\" type=\"prescribed")],
            "held along z in another way already",
        ),
        (&[("<relative>0", "<relative>1")], "a.feb:25: a displacement relative to"),
        (&[("<linear>0", "<linear>1")], "a.feb:28: a pressure follows the deformed surface"),
        (&[("type=\"nodal_load\"", "type=\"nodal_target_force\"")], "of type \"nodal_target_force\" is not supported"),
        (&[("LINEAR", "SMOOTH")], "load curve 1: \"SMOOTH\" is not supported, only LINEAR"),
        (
            &[("<pt>1,1</pt>", "<pt>0.5,1</pt>"), ("<points>", "<extend>REPEAT</extend><points>")],
            "\"REPEAT\" beyond its last point",
        ),
        (&[("<scale lc=\"1\">", "<scale lc=\"7\">")], "a.feb:29: there is no load curve 7"),
    ];
    for (edits, expected) in cases {
        let errors = refused(edits);
        assert!(errors.iter().any(|error| error.contains(expected)), "{edits:?}: {errors:?}");
    }
    assert!(
        feb::read("a.feb", b"<febio_spec", Extent::Problem).unwrap_err()[0].to_string().contains("not an XML file")
    );
    let mixed = refused(&[(
        "<quad4 id=\"1\">6,11,12,7</quad4>",
        "<quad4 id=\"1\">6,7,12,11</quad4><quad4 id=\"2\">9,10,12,11</quad4>",
    )]);
    assert!(mixed[0].contains("some faces of the surface have their normal out of the body"), "{mixed:?}");
    let steps = refused(&[
        ("<Boundary>", "<Step><step id=\"1\"/><step id=\"2\"><Boundary>"),
        ("</Loads>", "</Loads></step></Step>"),
    ]);
    assert!(steps[0].contains("of one of several steps is not supported"), "{steps:?}");
    assert_eq!(
        good(&[])
            .problem
            .loads
            .iter()
            .filter(|load| matches!(load, Load::Force { curve, .. } if *curve != Curve::ZERO))
            .count(),
        1
    );
}

/// What a model file may bring can be missing: materials and times.
#[test]
fn a_mesh_alone_is_a_body() {
    let cut = |text: &str, from: &str, to: &str| {
        let (a, b) = (text.find(from).unwrap(), text.find(to).unwrap() + to.len());
        format!("{}{}", &text[..a], &text[b..])
    };
    let mut mesh = edited(&[]);
    for section in ["Control", "Material", "MeshDomains", "Boundary", "Loads"] {
        mesh = cut(&mesh, &format!("<{section}>"), &format!("</{section}>"));
    }
    assert!(feb::read("a.feb", mesh.as_bytes(), Extent::Problem).is_err());
    let body = feb::read("a.feb", mesh.as_bytes(), Extent::Body).unwrap();
    assert_eq!((body.problem.mesh.num_elements(), body.problem.supports.len(), body.schedule.times.len()), (2, 0, 0));
}
