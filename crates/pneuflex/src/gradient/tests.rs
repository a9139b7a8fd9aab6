//! Derivatives against differences of whole runs, extrapolated, with walls and obstacles in contact.

use super::*;
use crate::analysis::Description;
use crate::observer::StopToken;
use crate::study::Study;
use crate::template;

/// How far exact derivatives and differences may be apart, relative to the larger.
const CLOSE: f64 = 1e-6;

fn requests(columns: &[&str]) -> Vec<Request> {
    columns.iter().map(|column| column.parse().unwrap()).collect()
}

/// Compares derivatives of results by keys at the end of an analysis, whose summary comes back; both must be something.
fn compare(analysis: &Analysis, columns: &[&str], keys: &[&str]) -> StepSummary {
    let tight = analysis.to_tight_tolerances(*analysis.requested.last().unwrap());
    let solution = tight.solve().unwrap();
    let keys: Vec<String> = keys.iter().map(|key| (*key).to_owned()).collect();
    let gradients = tight.gradients(&solution.fields, &requests(columns), Some(&keys)).unwrap();
    let names: Vec<String> = gradients.iter().map(|gradient| gradient.of.clone()).collect();
    let mut wrong = Vec::new();
    for key in &keys {
        let [first, ..] = &gradients[..] else { panic!("there is no result") };
        let exact = first.derivatives.iter().find(|derivative| derivative.by == *key).unwrap();
        let differences = tight.differences(exact, first.value, &names, &StopToken::new()).unwrap();
        for (gradient, expected) in gradients.iter().zip(differences) {
            let found = gradient.derivatives.iter().find(|derivative| derivative.by == *key).unwrap();
            let apart = (found.derivative - expected).abs() / expected.abs();
            if apart.is_nan() || apart >= CLOSE {
                wrong.push(format!("{} by {key}: {} and {expected}, {apart:.1e}", gradient.of, found.derivative));
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), keys.len() * names.len(), wrong.join("\n"));
    solution.states.into_iter().last().unwrap()
}

/// Two chambers that touch each other and a plane below their tip.
fn touching(element: &str, size: &str) -> Analysis {
    let plane =
        "[[obstacle]]\nname = \"table\"\nshape = \"plane\"\npoint = [0.0, 0.0, -0.6]\nnormal = [0.0, 0.0, 1.0]\n";
    let text = format!("{}\n{plane}", template::two_chambers());
    let mut study = Study::from_text("two.toml", &text).unwrap();
    for (key, value) in
        [("mesh.size", size), ("mesh.element", element), ("actuator.gap", "0.5"), ("load.pressure_kpa", "[30]")]
    {
        study.set(key, value).unwrap();
    }
    study.build().unwrap()
}

/// Whether walls touch each other, and the body the plane.
fn touches(state: &StepSummary) -> bool {
    state.contact.gaps_in_contact == 1 && state.obstacles["table"].force_n[2] < -1e-3
}

const OF_CASE: [&str; 15] = [
    "end_face_angle",
    "chord_angle",
    "tip.z",
    "tip",
    "cavity_volume",
    "reaction.z",
    "force",
    "strain_energy",
    "centreline[7.3].x",
    "centreline[60%].z",
    "von_mises_norm[12]",
    "von_mises_quantile[99%]",
    "stretch_norm[12]",
    "stretch_quantile[99%]",
    "smallest_gap[0.02]",
];

#[test]
fn derivatives_of_linear_elements_are_those_of_differences() {
    let keys = [
        "actuator.side_wall",
        "actuator.gap",
        "actuator.cavity_length[2]",
        "material.c10",
        "material.bulk_modulus",
        "contact.stiffness",
        "obstacle.table.point.z",
        "load.pressure_kpa",
    ];
    assert!(touches(&compare(&touching("hex8-sri", "4.5"), &OF_CASE, &keys)));
}

/// Two ways to the same numbers: slopes by the positions of all nodes times the motion of these, and the equations on moved meshes.
#[test]
fn lengths_count_by_their_nodes() {
    for element in ["hex8-sri", "tet15"] {
        let analysis = touching(element, "9");
        let lengths = ["side_wall", "top_wall", "base", "gap", "cavity_length[1]"];
        let keys = lengths.map(|length| format!("actuator.{length}"));
        let state = analysis.solve().unwrap().fields.pop().unwrap();
        // Of more results than that, slopes along all nodes are more work.
        let columns = &OF_CASE[OF_CASE.len() - RESULTS_PER_LENGTH * lengths.len()..];
        let [by_nodes, plain] =
            [true, false].map(|by_nodes| analysis.gradients_at(&state, columns, Some(&keys), by_nodes).unwrap());
        for (a, b) in by_nodes.iter().zip(&plain) {
            for key in &keys {
                let of = |gradient: &Gradient| gradient.derivatives.iter().find(|d| d.by == *key).unwrap().derivative;
                let size = b.derivatives.iter().fold(0.0_f64, |most, d| most.max(d.derivative.abs()));
                let apart = (of(a) - of(b)).abs() / size;
                assert!(apart < 1e-7 && of(a) != of(b), "{element}: {} by {key}: {} {}", a.of, of(a), of(b));
            }
        }
    }
}

/// The places of a few nodes at rest, against differences of whole runs: one of the wall in contact, one of the end face, one inside, the tip's.
#[test]
fn derivatives_by_nodes_are_those_of_differences() {
    let analysis = touching("hex8-sri", "9");
    let tight = analysis.to_tight_tolerances(*analysis.requested.last().unwrap());
    let columns = [
        "end_face_angle",
        "tip.z",
        "cavity_volume",
        "force",
        "strain_energy",
        "centreline[60%].z",
        "smallest_gap[0.02]",
    ];
    let fields = tight.solve().unwrap().fields;
    let found = tight.shape_gradients(&fields, &requests(&columns)).unwrap();
    let mesh = &tight.problem.mesh;
    let height = |node: &&u32| mesh.nodes[**node as usize][2];
    // Not the tip, whose displacement is read off its place.
    let end = mesh.node_set("end_face").iter().max_by(|a, b| height(a).total_cmp(&height(b)));
    let end = *end.unwrap() as usize;
    let wall = mesh.facet_nodes(mesh.facet_set("gap_1_left")[1])[0] as usize;
    let tip = *pneuflex_post::measures::centreline_nodes(&tight.problem).last().unwrap() as usize;
    let tip_of = Tip::of_analysis(&tight);
    for (node, axis) in [(wall, 0), (end, 2), (tip, 0), (mesh.num_nodes() / 2, 2)] {
        let step = 1e-3;
        let values = |steps: f64| -> Vec<f64> {
            let mut moved = tight.clone();
            std::sync::Arc::make_mut(&mut moved.problem.mesh).nodes[node][axis] += steps * step;
            let solution = moved.solve().unwrap();
            let state = (&solution.fields[0], &solution.states[0]);
            columns.iter().map(|column| Scalar::find(column, state, &moved, &tip_of).unwrap().value).collect()
        };
        let [near, far] = [[values(-1.0), values(1.0)], [values(-2.0), values(2.0)]];
        for (i, gradient) in found.iter().enumerate() {
            let at = |ends: &[Vec<f64>; 2]| [ends[0][i], ends[1][i]];
            let expected = slopes::extrapolated(at(&near), at(&far), step);
            let largest = gradient.by_node.as_flattened().iter().fold(0.0_f64, |most, slope| most.max(slope.abs()));
            let apart = (gradient.by_node[node][axis] - expected).abs() / largest;
            assert!(apart < CLOSE && largest > 0.0, "{} by {axis} of {node}: {apart:.1e} of {largest}", gradient.of);
        }
    }
    for (column, words) in
        [("von_mises_norm[12]", "not differentiated by nodes"), ("silicone_volume", "volumes of all")]
    {
        let error = tight.shape_gradients(&fields, &requests(&[column])).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    let model = Study::from_text("model.toml", MODEL).unwrap().build().unwrap();
    let error = model.check_shape_gradients(&requests(&["probe.end.x"])).unwrap_err().to_string();
    assert!(error.starts_with("load: forces, tractions and weight"), "{error}");
}

#[test]
fn derivatives_of_quadratic_elements_are_those_of_differences() {
    assert!(touches(&compare(&touching("hex27", "9"), &OF_CASE, &["actuator.top_wall"])));
}

/// A gas that is shut in, a pressure on an open surface, which has no potential, two materials, weight and a moved support.
const MODEL: &str = r#"
[actuator]
chambers = 1
chamber_length = 8.0
cavity_length = 6.0
gap = 2.0
flange = 2.0
width = 20.0
height = 13.0
base = 4.0
side_wall = 1.0
top_wall = 1.0
channel = { half_width = 0.0, bottom = 2.0, top = 3.0 }

[mesh]
size = 9.0
element = "hex8-q1p0"

[material]
law = "ogden"
mu = [0.2, 0.1]
alpha = [1.5, 3.0]
density = 1.1

[[region]]
name = "sole"
box = [[0, -10, 0], [12, 10, 2]]
material = { law = "gent", shear_modulus = 0.8, jm = 40.0, density = 1.2 }

[[cavity]]
name = "air"
faces = "cavity_1"
gas = [[0.0, 1.0], [1.0, 1.4]]
exponent = 1.2

[[pressure]]
faces = "bottom"
pressure_kpa = 4.0

[[support]]
nodes = "end_face"
axes = "z"
displacement = [0.0, 0.0, -0.4]

[gravity]
acceleration = [0.0, 0.0, -9807.0]

[load]
times = [1.0]

[[probe]]
name = "end"
at = [12.0, 0.0, 4.0]
"#;

#[test]
fn derivatives_of_a_model_are_those_of_differences() {
    let analysis = Study::from_text("model.toml", MODEL).unwrap().build().unwrap();
    let results =
        ["cavity.air.pressure_kpa", "cavity.air.volume", "probe.end.x", "reaction.end_face.z", "strain_energy"];
    let keys = [
        "actuator.top_wall",
        "actuator.base",
        "material.mu[2]",
        "material.alpha[1]",
        "region.sole.material.shear_modulus",
        "region[0].material.density",
        "cavity[0].exponent",
        "pressure[0].pressure_kpa",
        "gravity.acceleration.z",
        "support[0].displacement.z",
        // Both together, and a list's entry by its number.
        "actuator.side_wall + actuator.top_wall",
        "gravity.acceleration[3]",
    ];
    compare(&analysis, &results, &keys);
}

#[test]
fn what_has_no_derivative_is_refused_by_name() {
    let analysis = touching("hex8-q1p0", "4.5");
    let of = |column: &str| analysis.check_gradients(&requests(&[column])).unwrap_err().to_string();
    for (column, words) in [
        ("von_mises_p99", "jumps"),
        ("max_von_mises_mpa", "has corners"),
        ("contact.min_gap", "found by samples"),
        ("pressure_kpa", "it is given"),
        ("iterations", "a count"),
        ("silicone_mass", "no density"),
        ("von_mises_norm[0.5]", "an exponent from 1 to 100"),
        ("stretch_quantile[99]", "a share from 50% to 99.99%"),
        ("smallest_gap[0]", "mm above 0"),
        ("centreline[99].z", "is 16.5 mm long"),
        ("centreline[5].y", "expected e.g."),
        ("angle", "no such result"),
        ("tip.z@20", "no state is asked for at 20 kPa"),
    ] {
        let error = of(column);
        assert!(error.contains(words), "{column}: {error}");
    }
    assert!("tip.z@x".parse::<Request>().is_err());
    let by = |analysis: &Analysis, key: &str| {
        let variants = Variants::of(analysis).unwrap();
        let found = variants.find(key, *analysis.requested.last().unwrap());
        found.map_or_else(
            |error| error.to_string(),
            |variable| {
                let step = variants.step(&variable);
                variants.with(&variable, variable.value + step, LoadParameter(1.0)).unwrap_err()
            },
        )
    };
    for (key, words) in [
        ("mesh.size", "the elements stay what they are"),
        ("solver.max_step_kpa", "how an equilibrium is found"),
        ("probe[0].at", "nearest node"),
        ("actuator.chambers", "no number of this file"),
        ("actuator.side_wall[1]", "would be slivers"),
        ("actuator.flange", "planes that part"),
        ("actuator.base + actuator.top_wall", "actuator.base is 4 and actuator.top_wall is 1"),
        ("actuator.base + material.c10", "are not of one kind"),
        ("obstacle[3].radius", "obstacle has entries from 0 to 0"),
    ] {
        let error = by(&analysis, key);
        assert!(error.contains(words), "{key}: {error}");
    }
    let model = Study::from_text("model.toml", MODEL).unwrap().build().unwrap();
    assert!(by(&model, "load.times").contains("a load has a corner at time 1"));
    let error = model.check_gradients(&requests(&["smallest_gap[0.02]"])).unwrap_err().to_string();
    assert!(error.contains("no walls that may touch"), "{error}");
    let deck = Study::from_text("c.inp", crate::convergence::PULLED_CUBE).unwrap().build().unwrap();
    let error = deck.check_gradients(&requests(&["strain_energy"])).unwrap_err().to_string();
    assert!(error.starts_with("a deck has no keys"), "{error}");
    let mut averaged = analysis.clone();
    averaged.problem.contact.method = ContactMethod::Mortar;
    let error = averaged.check_gradients(&requests(&["tip.z"])).unwrap_err().to_string();
    assert!(error.starts_with("contact.method: gaps that are averaged"), "{error}");
}

#[test]
fn an_earlier_state_has_its_gradient_and_one_of_an_earlier_run_has_none() {
    let mut analysis = touching("hex8-q1p0", "9");
    analysis.requested.insert(0, LoadParameter(15.0));
    let solution = analysis.solve().unwrap();
    let asked = requests(&["tip.z", "tip.z@15"]);
    let found = analysis.gradients(&solution.fields, &asked, None).unwrap();
    assert_eq!([found[0].pressure_kpa, found[1].pressure_kpa], [30.0, 15.0]);
    for gradient in &found {
        assert!(gradient.derivatives.len() > 15, "{gradient:?}");
        // Without flanges there is no shorter one, and half of a body has a plane that is level across.
        let without: Vec<&str> = gradient.without.iter().map(|number| &*number.by).collect();
        assert_eq!(without, ["actuator.flange", "obstacle[0].normal.y"]);
    }
    let error = analysis.gradients(&solution.fields[1..], &asked, None).unwrap_err();
    assert!(error.to_string().contains("tip.z@15: the displacements there are not known"), "{error}");
}

/// Of the paper's piece: 1268 mm³ are the half of it.
#[test]
fn volume_and_mass_of_the_silicone_depend_on_lengths_and_density_alone() {
    let mut analysis = touching("hex8-q1p0", "9");
    analysis.problem.material.density = 1.08;
    let Description::Actuator(case) = &mut analysis.description else { panic!("it is a case") };
    case.material.density = 1.08;
    let state = analysis.solve().unwrap().fields.pop().unwrap();
    let keys = ["actuator.base", "material.density", "material.c10"].map(str::to_owned);
    let found = analysis.gradients(&[state], &requests(&["silicone_volume", "silicone_mass_g"]), Some(&keys)).unwrap();
    let volume = 2.0 * analysis.problem.mesh.volume();
    assert_eq!([found[0].value, found[1].value], [volume, 1e-3 * 1.08 * volume]);
    let by = |gradient: &Gradient, key: &str| gradient.derivatives.iter().find(|d| d.by == key).unwrap().derivative;
    // The cavities begin at the top of the base, which the slit ends at, too.
    assert!(by(&found[0], "actuator.base") > 50.0 && by(&found[0], "material.density") == 0.0, "{found:?}");
    assert!((by(&found[1], "material.density") / (1e-3 * volume) - 1.0).abs() < 1e-9, "{found:?}");
    assert!((by(&found[1], "actuator.base") / by(&found[0], "actuator.base") - 1.08e-3).abs() < 1e-12);
    assert!(by(&found[1], "material.c10").abs() < 1e-12);
}

/// Two bricks of a deck, glued at faces that share no nodes.
#[test]
fn derivatives_pass_through_glued_surfaces() {
    let brick = |first: u32, low: f64, size: f64| {
        let at = |i: u32| [i.div_ceil(2) % 2, i / 2 % 2, i / 4].map(f64::from);
        let node = |i: u32| {
            let [x, y, z] = at(i);
            format!("{}, {}, {}, {}\n", first + i, size * x, size * y, low + z)
        };
        let nodes: String = (0..8).map(node).collect();
        let numbers: Vec<String> = (0..8).map(|i| (first + i).to_string()).collect();
        format!("*NODE\n{nodes}*ELEMENT, TYPE=C3D8, ELSET=BODY\n{first}, {}\n", numbers.join(", "))
    };
    let sets = "*NSET, NSET=FOOT\n1, 2, 3, 4\n*SURFACE, NAME=UNDER\n1, S2\n*SURFACE, NAME=OVER\n9, S1\n*SURFACE, NAME=HEAD\n9, S2\n\
                *TIE, NAME=GLUE, ADJUST=NO\nOVER, UNDER\n*MATERIAL, NAME=M\n*HYPERELASTIC, NEO HOOKE\n0.2, 0.1\n\
                *SOLID SECTION, ELSET=BODY, MATERIAL=M\n*STEP, NLGEOM\n*STATIC\n*END STEP\n";
    let deck = [brick(1, 0.0, 1.0), brick(9, 1.0, 0.8), sets.to_owned()].concat();
    let model = "[model]\nfile = \"two.inp\"\n[material]\nlaw = \"neo-hooke\"\nc10 = 0.3\nbulk_modulus = 20.0\n[load]\ntimes = [1.0]\n\
                 [[support]]\nnodes = \"FOOT\"\naxes = \"xyz\"\n[[traction]]\nfaces = \"HEAD\"\ntraction_mpa = [0.03, 0.0, 0.05]\n\
                 [[probe]]\nname = \"end\"\nat = [0.8, 0.8, 2.0]\n";
    let files = [("two.toml", model.to_owned()), ("two.inp", deck)];
    let files = files.map(|(name, text)| (name.to_owned(), text.into_bytes()));
    let analysis = Study::from_files("two.toml", files).unwrap().build().unwrap();
    // What is glued follows by equations.
    assert!(!analysis.problem.equations.is_empty());
    let state = compare(&analysis, &["probe.end.x", "strain_energy"], &["material.c10", "traction[0].traction_mpa.x"]);
    assert!(state.probes["end"][0] > 0.01, "{state:?}");
}
