//! What results are those of: half and whole, case file and model file, loads on faces, runs that stop on their way.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};

use pneuflex::mesh::lattice::Lattice;
use pneuflex::mesh::testing::{angle, mixed};
use pneuflex::mesh::{ElementKind, Mesh};
use pneuflex::model::{Formulation, Law, Material};
use pneuflex::post::load_step::LoadStepSummary;
use pneuflex::post::summary::{State, StepSummary, probe_sites};
use pneuflex::report_page::report_page;
use pneuflex::{Body, Error, Event, Solution, StopToken, Study};
use serde_json::Value;

const BODY: &str = "[actuator]\nchambers = 2\nchamber_length = 8.0\ncavity_length = 6.0\ngap = 2.0\nflange = 0.0\nwidth = 20.0\n\
                    height = 13.0\nbase = 4.0\nside_wall = 1.0\ntop_wall = 1.0\n\
                    channel = { half_width = 1.0, bottom = 2.0, top = 3.0 }\npart = \"PART\"\n\
                    [mesh]\nelement = \"hex8-q1p0\"\nsize = [2.0, 2.5, 3.0]\n[material]\nlaw = \"neo-hooke\"\nc10 = 0.2\n\
                    invariant = \"isochoric\"\n\
                    [[probe]]\nname = \"tip\"\nat = [18.0, 0.0, 0.0]\n\
                    [[obstacle]]\nname = \"table\"\nshape = \"plane\"\npoint = [3.0, 2.0, -0.2]\nnormal = [0.0, 0.0, 1.0]\n";

/// The chambers over a table at 30 kPa.
fn solved(part: &str, rest: &str) -> (Solution, String) {
    let text = BODY.replace("PART", part) + rest;
    let analysis = Study::from_text("chambers.toml", &text).unwrap().build().unwrap();
    (analysis.solve().unwrap(), analysis.overview().to_string())
}

const CASE: &str = "[load]\npressure_kpa = [30]\n";
const MODEL: &str = "[load]\ntimes = [30]\n[[cavity]]\nname = \"air\"\nfaces = \"cavity\"\npressure_kpa = 30\n\
                     [solver]\nfirst_step = 5.0\nmax_step = 20.0\n";

/// A load step is described by what a state is described by, as far as that takes no stresses.
#[test]
fn load_steps_have_the_numbers_of_states() {
    for rest in [CASE, MODEL] {
        let analysis =
            Study::from_text("chambers.toml", &(BODY.replace("PART", "half") + rest)).unwrap().build().unwrap();
        let sites = probe_sites(&analysis.problem.mesh, &analysis.probes);
        let mut compared = 0;
        let compare = |event: &Event<'_>| {
            let Event::State(reached) = event else { return };
            let equilibrium = reached.equilibrium;
            let state = State {
                parameter: equilibrium.parameter,
                cavity_pressures: &equilibrium.cavity_pressures,
                displacement: &equilibrium.displacement,
                reaction: &equilibrium.reaction,
                iterations: 0,
                load_steps: 0,
                contact_multipliers: &equilibrium.contact_multipliers,
                contact_failure: None,
            };
            let step = LoadStepSummary::of(&analysis.problem, &sites, &state).unwrap();
            assert_eq!(step, reached.summary.plain());
            assert!(step.when() == equilibrium.parameter && step.obstacles["table"].force_n[2] < 0.0, "{step:?}");
            compared += 1;
        };
        analysis.run().observer(compare).solve().unwrap();
        assert_eq!(compared, 1);
    }
}

/// Chambers that no channel joins: what they do with air of their own is what they do with one air if the pressures are equal, and less if one has
/// none; so do those that share a wall.
#[test]
fn chambers_without_a_channel_have_air_of_their_own() {
    for gap in ["2.0", "0.0"] {
        let text = BODY.replace("half_width = 1.0", "half_width = 0.0").replace("gap = 2.0", &format!("gap = {gap}"));
        let text = text.replace("PART", "half").split("[[obstacle]]").next().unwrap().to_owned();
        let angle_and_volumes = |cavities: &[(&str, f64)]| {
            let each = cavities.iter().map(|(faces, pressure)| {
                format!("[[cavity]]\nname = \"{faces}\"\nfaces = \"{faces}\"\npressure_kpa = {pressure}\n")
            });
            let text = format!("{text}[load]\ntimes = [1]\n{}", each.collect::<String>());
            let solution = Study::from_text("chambers.toml", &text).unwrap().build().unwrap().solve().unwrap();
            (solution.states[0].end_face_angle_deg.unwrap(), solution.states[0].cavity_volume_mm3)
        };
        let (angle, volume) = angle_and_volumes(&[("cavity", 20.0)]);
        let (of_each, volume_of_each) = angle_and_volumes(&[("cavity_1", 20.0), ("cavity_2", 20.0)]);
        assert!((of_each / angle - 1.0).abs() < 1e-9 && angle > 1.0, "{gap}: {of_each} {angle}");
        assert!((volume_of_each / volume - 1.0).abs() < 1e-9, "{gap}: {volume_of_each} {volume}");
        let (of_one, _) = angle_and_volumes(&[("cavity_1", 20.0), ("cavity_2", 0.0)]);
        assert!((0.2 * angle..0.8 * angle).contains(&of_one), "{gap}: {of_one} of {angle}");
    }
}

/// Pressures of chambers in a case file are those of its model file with a cavity for each; results have the air of each.
#[test]
fn chambers_of_a_case_have_the_pressures_of_their_factors() {
    let text = BODY.replace("half_width = 1.0", "half_width = 0.0").replace("PART", "half");
    let text = text.replace("gap = 2.0", "gap = [1.5, 0]").replace("chambers = 2", "chambers = 3");
    let text =
        text.replace("top_wall = 1.0", "top_wall = [1.0, 1.5, 1.0]").split("[[obstacle]]").next().unwrap().to_owned();
    let factors = [1.0, 0.5, -0.2];
    let case = format!("{text}[load]\npressure_kpa = [10, 20]\nchamber_factor = {factors:?}\n");
    let case = Study::from_text("case.toml", &case).unwrap().build().unwrap();
    assert!(
        case.overview().to_string().contains("10, 20 kPa, times [1, 0.5, -0.2] in the chambers"),
        "{}",
        case.overview()
    );
    let states = case.solve().unwrap().states;
    let cavities = (1..).zip(factors).map(|(i, factor)| {
        format!("[[cavity]]\nname = \"cavity_{i}\"\nfaces = \"cavity_{i}\"\npressure_kpa = {:?}\n", 20.0 * factor)
    });
    let model = format!("{text}[load]\ntimes = [10, 20]\n{}", cavities.collect::<String>());
    let model = Study::from_text("model.toml", &model).unwrap().build().unwrap().solve().unwrap().states;
    let [a, b] = [&states[1], &model[1]];
    assert!((a.end_face_angle_deg.unwrap() / b.end_face_angle_deg.unwrap() - 1.0).abs() < 1e-8);
    assert_eq!(a.pressure_kpa, 20.0);
    for (name, factor) in ["cavity_1", "cavity_2", "cavity_3"].into_iter().zip(factors) {
        let [in_case, in_model] = [a.cavities[name], b.cavities[name]];
        assert!((in_case.pressure_kpa - 20.0 * factor).abs() < 1e-12, "{name}: {in_case:?}");
        assert!((in_case.volume_mm3.unwrap() / in_model.volume_mm3.unwrap() - 1.0).abs() < 1e-9, "{name}");
    }
    // What is sucked empty shrinks, and what is inflated more grows more.
    let rest = [6.0 * 18.0 * 8.0, 6.0 * 18.0 * 7.5, 6.0 * 18.0 * 8.0];
    let growth: Vec<f64> =
        a.cavities.values().zip(rest).map(|(cavity, rest)| cavity.volume_mm3.unwrap() - rest).collect();
    assert!(growth[0] > growth[1] && growth[1] > 0.0 && growth[2] < 0.0, "{growth:?}");
}

/// How far a chamber bends is its own matter: nearly as far beside another one as beside one of its own kind, before the gap as behind it.
#[test]
fn a_chamber_bends_as_beside_one_of_its_kind() {
    let turns = |lengths: &str| {
        let text = BODY.replace("PART", "half").split("[[obstacle]]").next().unwrap().to_owned() + CASE;
        let cavities = lengths.replace("8.0", "6.0").replace("12.0", "10.0");
        let text = text.replace("chamber_length = 8.0", &format!("chamber_length = {lengths}"));
        let text = text.replace("cavity_length = 6.0", &format!("cavity_length = {cavities}"));
        let analysis = Study::from_text("case.toml", &text).unwrap().build().unwrap();
        let row = analysis.actuator().unwrap().row();
        let run = analysis.solve().unwrap();
        let displacement = &run.fields[0].displacement;
        // By how much the base's section at x has turned, degrees.
        let section = |x: f64| {
            let mean = |z: f64| {
                let mesh = &analysis.problem.mesh;
                let nodes = mesh.select_nodes(|at| (at[0] - x).abs() + (at[2] - z).abs() < 1e-9);
                nodes.iter().map(|&node| displacement[node as usize][0]).sum::<f64>() / nodes.len() as f64
            };
            ((mean(4.0) - mean(0.0)) / 4.0).atan().to_degrees()
        };
        let at_gap = 0.5 * (section(row[0].end) + section(row[1].start));
        [at_gap, run.states[0].end_face_angle_deg.unwrap() - at_gap]
    };
    let [short, long] = ["[8.0, 8.0]", "[12.0, 12.0]"].map(turns);
    for (lengths, alike) in [("[8.0, 12.0]", [short[0], long[1]]), ("[12.0, 8.0]", [long[0], short[1]])] {
        for (found, expected) in turns(lengths).into_iter().zip(alike) {
            assert!((found / expected - 1.0).abs() < 0.1, "{lengths}: {found} {expected}");
        }
    }
    // Longer ones bulge more to the side of their base, which bends them back.
    assert!(short.into_iter().zip(long).all(|(short, long)| short > 1.4 * long && long > 1.0), "{short:?} {long:?}");
}

/// Numbers of two results that describe the same body, which are to be equal.
fn compare(name: &str, a: &StepSummary, b: &StepSummary) {
    let numbers = |state: &StepSummary| {
        let table = &state.obstacles["table"];
        let mut all = vec![
            state.end_face_angle_deg.unwrap(),
            state.max_von_mises_mpa,
            state.cavity_volume_mm3,
            state.strain_energy_mj,
            state.contact.area_mm2,
            state.contact.penalty_energy_mj,
            state.contact.penetrating_area_mm2,
            state.contact.points_active as f64,
            table.area_mm2,
            table.points_active as f64,
        ];
        all.extend([state.probes["tip"], state.reaction_n, table.force_n, table.moment_nmm].as_flattened());
        all
    };
    for (i, (a, b)) in numbers(a).into_iter().zip(numbers(b)).enumerate() {
        assert!((a - b).abs() < 1e-8 * (1.0 + a.abs()), "{name}: number {i} is {a} and {b}");
    }
}

#[test]
fn half_and_whole_case_file_and_model_file_agree_in_every_number() {
    let ((half, overview), (whole, of_whole)) = (solved("half", CASE), solved("whole", CASE));
    let (model, of_model) = solved("half", MODEL);
    let state = &half.states[0];
    compare("whole", state, &whole.states[0]);
    compare("model file", state, &model.states[0]);
    // The table carries what the clamp holds, and walls touch.
    let force = state.obstacles["table"].force_n[2];
    assert!(force < -0.05 && (force - state.reaction_n[2]).abs() < 1e-7 && state.contact.area_mm2 > 0.0, "{state:?}");
    assert_eq!((state.reaction_n[1], state.obstacles["table"].force_n[1]), (0.0, 0.0));
    // The halves pull at each other; that is nobody's reaction.
    let across = state.symmetry_reactions["y = 0"];
    assert!(across[1] < -1.0 && across[0] == 0.0 && whole.states[0].symmetry_reactions.is_empty(), "{across:?}");
    assert_eq!(model.states[0].reactions.keys().collect::<Vec<_>>(), ["clamp"]);
    for (overview, contact) in [(&overview, "1 gap"), (&of_model, "gap_1:")] {
        assert!(overview.contains("symmetry  half of the body is modelled, symmetric to y = 0"), "{overview}");
        let row = overview.lines().find(|line| line.starts_with("contact") && line.contains(contact)).unwrap();
        let table = overview.lines().find(|line| line.starts_with("obstacle")).unwrap();
        let stiffness = |line: &str| line.rsplit(", ").next().unwrap().to_owned();
        assert_eq!((stiffness(row), stiffness(table)), ("2.949852507 N/mm3".into(), "2.949852507 N/mm3".into()));
    }
    assert!(!of_whole.contains("symmetry"));
}

/// A bar of 4 mm × 2 mm × 1 mm with cells of different sizes, held at x = 0; a quarter of one that is twice as wide and high.
fn bar(formulation: Formulation) -> Body {
    let lines = [vec![0.0, 1.0, 4.0], vec![0.0, 0.5, 2.0], vec![0.0, 1.0]];
    let mesh = Lattice { lines }.mesh(formulation.element_kind(), |_| true).mesh;
    let mut bar = Body::of_mesh(formulation, mesh).unwrap();
    bar.material(Material::from(Law::NeoHooke { c10: 0.1 }))
        .name_nodes("root", |[x, _, _]| x == 0.0)
        .name_nodes("end", |[x, _, _]| x == 4.0)
        .name_nodes("middle", |[_, y, _]| y == 0.0)
        .name_nodes("bottom", |[_, _, z]| z == 0.0)
        .name_faces("end face", |[x, _, _]| x == 4.0)
        .hold("root", "xyz")
        .probe("end", [4.0, 2.0, 1.0])
        .times([1.0]);
    bar
}

/// An angle that is bent up by a pressure below, against a plane that presses on its arm.
fn bent_angle(mesh: Mesh, formulation: Formulation) -> StepSummary {
    let mut body = Body::of_mesh(formulation, mesh).unwrap();
    body.material(Material::from(Law::NeoHooke { c10: 0.1 }))
        .name_nodes("root", |[x, _, _]| x == 0.0)
        .name_faces("under", |[_, _, z]| z == 0.0)
        .name_faces("over", |[_, _, z]| z == 3.0)
        .hold("root", "xyz")
        .probe("end", [3.0, 2.0, 3.0])
        .times([1.0]);
    let text = "[[pressure]]\nfaces = \"under\"\npressure_kpa = [[0, 0], [1, 15]]\n[[obstacle]]\nname = \"plane\"\nshape = \"plane\"\n\
                faces = \"over\"\npoint = [0.0, 0.0, 3.2]\nnormal = [0.0, 0.0, -1.0]\n";
    let tables = toml::from_str::<pneuflex::model::model_file::Model>(text).unwrap();
    body.model.pressures = tables.pressures;
    body.model.obstacles = tables.obstacles;
    body.analysis().unwrap().solve().unwrap().states.remove(0)
}

/// Its lower faces are quadrilaterals and triangles, its upper ones triangles of tetrahedra.
#[test]
fn hexahedra_wedges_and_tetrahedra_are_one_body() {
    let lattice = Lattice::uniform([0.0; 3], [3.0, 2.0, 3.0], [6, 4, 6]);
    let tetrahedra = lattice.mesh(ElementKind::Tet15, |[x, _, z]| x >= 2 || z < 4).mesh;
    let several = bent_angle(angle(2), Formulation::Hex27);
    let one = bent_angle(tetrahedra, Formulation::Tet15);
    let [found, expected] = [&several, &one].map(|state| {
        let force = state.obstacles["plane"].force_n[2];
        [state.probes["end"][2], state.probes["end"][0], force, state.strain_energy_mj]
    });
    assert!(expected[0] > 0.1 && expected[2].abs() > 1e-3, "{expected:?}");
    // The force is that of an edge which is some micrometres deep in the plane, behind a stiff penalty.
    let bounds = [1e-3, 1e-2, 3e-2, 1e-3];
    let error = |i: usize| (found[i] / expected[i] - 1.0).abs();
    assert!((0..4).all(|i| error(i) < bounds[i]), "{found:?} {expected:?}");
}

#[test]
fn bodies_whose_elements_do_not_fit_together_are_refused() {
    let refused = |mesh: Mesh| match Body::of_mesh(Formulation::Hex27, mesh) {
        Err(Error::Input(errors)) => errors[0].to_string(),
        other => panic!("{other:?}"),
    };
    let block = |kind| Lattice::uniform([0.0; 3], [2.0, 1.0, 1.0], [2, 1, 1]).mesh_all(kind);
    let torn = mixed(&block(ElementKind::Hex27), &block(ElementKind::Tet15), |x| x[0] < 1.0);
    assert!(refused(torn).contains("meet with a quadrilateral on a triangle, at [1.0, "));
    let of_two_orders = mixed(&block(ElementKind::Hex8), &block(ElementKind::Wedge21), |x| x[0] < 1.0);
    assert!(
        refused(of_two_orders).contains("hexahedra with 8 nodes and wedges with 21 nodes cannot be solved as hex27")
    );
    // Elements of one kind may be chosen, those of several not.
    let mut body = Body::of_mesh(Formulation::Hex27, angle(1)).unwrap();
    body.name_nodes("root", |[x, _, _]| x == 0.0).hold("root", "xyz").times([1.0]);
    body.model.mesh.element = Some(Formulation::Hex27);
    let Err(Error::Input(errors)) = body.analysis() else { panic!() };
    assert!(errors[0].to_string().contains("mesh.element") && errors[0].to_string().contains("must be left out"));
}

#[test]
fn a_force_on_the_nodes_of_a_face_is_a_traction_on_it_for_every_element() {
    for formulation in Formulation::ALL {
        let solved = |load: &dyn Fn(&mut Body)| {
            let mut bar = bar(formulation);
            load(&mut bar);
            bar.analysis().unwrap().solve().unwrap().states.remove(0)
        };
        let traction = solved(&|bar| {
            let traction_mpa = [0.05, 0.0, -0.002];
            let faces = "end face".to_owned();
            bar.model.tractions.push(pneuflex::model::model_file::TractionTable {
                faces: faces.into(),
                traction_mpa,
                factor: None,
            });
        });
        assert!(traction.probes["end"][0] > 0.1, "{formulation}: {:?}", traction.probes);
        for set in ["end", "end face"] {
            let force = solved(&|bar| {
                bar.force(set, [0.1, 0.0, -0.004]);
            });
            for (a, b) in traction.probes["end"].iter().zip(force.probes["end"]) {
                assert!((a - b).abs() < 1e-9, "{formulation}, {set}: {a} {b}");
            }
        }
    }
}

#[test]
fn results_are_of_the_whole_where_planes_are_declared() {
    let solved = |planes: &[(&str, &str)], is_declared: bool| {
        let mut bar = bar(Formulation::of_kind(ElementKind::Hex20).unwrap());
        for (nodes, axis) in planes {
            if is_declared {
                bar.symmetry(*nodes, axis)
            } else {
                bar.hold(*nodes, axis)
            };
        }
        bar.force("end", [0.1, 0.0, 0.0]);
        let analysis = bar.analysis().unwrap();
        (analysis.modelled_part(), analysis.solve().unwrap().states.remove(0))
    };
    let planes = [("middle", "y"), ("bottom", "z")];
    let ((part, quarter), (unknown, model)) = (solved(&planes, true), solved(&planes, false));
    assert_eq!((part, unknown), (Some("quarter"), None));
    assert!((quarter.reaction_n[0] + 0.4).abs() < 1e-9 && (model.reaction_n[0] + 0.1).abs() < 1e-9);
    assert_eq!(quarter.strain_energy_mj, 4.0 * model.strain_energy_mj);
    assert_eq!((quarter.reactions.len(), model.reactions.len()), (1, 3));
    // Each cross-section has two quarters.
    let [y, z] = ["middle", "bottom"].map(|name| model.reactions[name]);
    assert_eq!(quarter.symmetry_reactions["y = 0"], [0.0, 2.0 * y[1], 0.0]);
    assert_eq!(quarter.symmetry_reactions["z = 0"], [0.0, 0.0, 2.0 * z[2]]);

    let mut wrong = bar(Formulation::Hex8Q1p0);
    wrong.symmetry("end", "y");
    let Err(Error::Input(errors)) = wrong.analysis() else { panic!("it was taken") };
    assert_eq!(errors[0].key(), Some("support[1].symmetry"));
    assert!(errors[0].to_string().contains("one plane y = const"), "{}", errors[0]);
}

fn scratch(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("pneuflex-results-{name}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&path);
    path
}

fn summary(folder: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(folder.join("summary.json")).unwrap()).unwrap()
}

fn fields(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = (fs::read_dir(folder.join("fields")).unwrap())
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// Peaks and quantiles can be had from the points again; a run into the same folder without them removes them.
#[test]
fn stresses_at_integration_points_are_written_on_request() {
    for text in [pneuflex::template::two_chambers(), BODY.replace("PART", "half") + MODEL] {
        let mut study = Study::from_text("points.toml", &text).unwrap();
        if !text.contains("[[cavity]]") {
            study.set("mesh", "{ resolution = 'draft' }").unwrap().set("load.pressure_kpa", "[3, 5]").unwrap();
        }
        study.set("output.points", "true").unwrap();
        let (analysis, folder) = (study.build().unwrap(), scratch("points"));
        analysis.run().record(&folder).solve().unwrap();
        let steps = summary(&folder)["steps"].as_array().unwrap().clone();
        assert!(fs::read_to_string(folder.join("fields/series.pvd")).unwrap().contains("points_01.vtu"));
        for (number, step) in steps.iter().enumerate() {
            let file = folder.join(format!("fields/points_{:02}.vtu", number + 1));
            let grid = pneuflex::post::vtu::Grid::from_vtu(&fs::read_to_string(file).unwrap()).unwrap();
            let values = |name: &str| grid.point_data.iter().find(|field| field.name == name).unwrap().values.clone();
            let (mut stress, volume) = (values("von_mises"), values("volume"));
            assert_eq!((stress.len(), values("cauchy_stress").len()), (grid.points.len(), 6 * grid.points.len()));
            let whole: f64 = volume.iter().sum();
            assert!((whole - analysis.problem.mesh.volume()).abs() < 1e-6 * whole);
            stress.sort_by(f64::total_cmp);
            let largest = step["max_von_mises_mpa"].as_f64().unwrap();
            assert!((stress[stress.len() - 1] - largest).abs() < 1e-9 * largest);
        }
        study.set("output.points", "false").unwrap();
        study.build().unwrap().run().record(&folder).solve().unwrap();
        assert!(!fields(&folder).iter().any(|name| name.starts_with("points")), "{:?}", fields(&folder));
        let why = study.set("output", "{ fields = false, points = true }").and_then(|study| study.build()).unwrap_err();
        assert!(why.to_string().contains("output.points = true"), "{why}");
        fs::remove_dir_all(&folder).unwrap();
    }
}

#[test]
fn a_run_that_stops_keeps_what_it_reached_on_the_way() {
    let mut study = Study::from_text("chambers.toml", &(BODY.replace("PART", "half") + MODEL)).unwrap();
    study.set("obstacle", "[]").unwrap();
    // The walls have no stiffness left long before the second time.
    study.set("material", "{ law = 'neo-hooke', c10 = 0.02 }").unwrap();
    study.set("load.times", "[2, 200]").unwrap().set("solver.min_step", "1").unwrap();
    study.set("cavity", "[{ name = 'air', faces = 'cavity', pressure_kpa = [[0, 0], [200, 100]] }]").unwrap();
    let (analysis, folder) = (study.build().unwrap(), scratch("stops"));
    let Err(Error::NotConverged(ended)) = analysis.run().record(&folder).solve() else { panic!("it converged") };
    let last = ended.reached.last.as_ref().unwrap();
    assert_eq!(last.parameter, ended.failure.reached);
    let found = summary(&folder);
    let missed = &found["steps"][1];
    // The pressure that was asked for at that time, and not the time.
    assert_eq!(
        (&missed["converged"], &missed["time"], &missed["pressure_kpa"]),
        (&false.into(), &200.0.into(), &100.0.into())
    );
    let on_the_way = found["on_the_way"].as_array().unwrap();
    let times: Vec<f64> = on_the_way.iter().map(|state| state["time"].as_f64().unwrap()).collect();
    assert!(times[0] > 2.0 && times.windows(2).all(|w| w[0] < w[1]) && times.len() <= 6, "{times:?}");
    assert_eq!(times.last(), Some(&last.parameter.0));
    for state in on_the_way {
        let [time, pressure] = ["time", "pressure_kpa"].map(|key| state[key].as_f64().unwrap());
        assert!((pressure - 0.5 * time).abs() < 1e-9 && state["probes"]["tip"][2].as_f64().unwrap() < 0.0, "{state}");
    }
    assert!(fields(&folder).contains(&format!("step_on_the_way_{:02}.vtu", times.len())));
    let page = report_page(&folder).unwrap();
    assert!(page.contains("lies on the way to the next requested time") && !page.contains("at rest."), "no word of it");
    assert!(page.contains(&format!("\"on_the_way\":{}", times.len())) && page.contains("on the way</span>"));
    fs::remove_dir_all(&folder).unwrap();
}

/// What was on the way when a run was stopped is gone once it has gone on, and kept again if it is stopped again.
#[test]
fn a_run_that_goes_on_leaves_no_states_on_the_way() {
    let mut study = Study::from_text("chambers.toml", &(BODY.replace("PART", "half") + CASE)).unwrap();
    study.set("obstacle", "[]").unwrap().set("solver.max_step_kpa", "3").unwrap();
    study.set("solver.first_step_kpa", "3").unwrap();
    let (analysis, folder) = (study.build().unwrap(), scratch("goes-on"));
    let undisturbed = analysis.solve().unwrap();
    let stopped_after = |steps: usize| {
        let (token, mut left) = (StopToken::new(), steps);
        let stop = token.clone();
        let run = analysis.run().stop(&token).resume(&folder).observer(move |event| {
            if matches!(event, Event::StepAccepted(_)) {
                left -= 1;
                if left == 0 {
                    stop.stop();
                }
            }
        });
        let Err(Error::Interrupted(_)) = run.solve() else { panic!("it was not stopped") };
        let found = summary(&folder);
        let states = found["on_the_way"].as_array().unwrap().clone();
        states.iter().map(|state| state["pressure_kpa"].as_f64().unwrap()).collect::<Vec<_>>()
    };
    // Steps before the last one are good enough to go on from, but not solved to the tolerances.
    assert_eq!(stopped_after(2), [6.0]);
    assert_eq!(stopped_after(3), [15.0]);
    let page = report_page(&folder).unwrap();
    assert!(
        page.contains("The last shape, at <strong>15 kPa</strong>, lies on the way to the next requested pressure")
    );
    let complete = analysis.run().resume(&folder).solve().unwrap();
    assert!(summary(&folder)["on_the_way"].is_null() && complete.last.is_none());
    assert_eq!(fields(&folder), ["contact_01.vtu", "series.pvd", "step_01.vtu"]);
    assert!(!fs::read_to_string(folder.join("fields/series.pvd")).unwrap().contains("on_the_way"));
    let [found, expected] = [&complete, &undisturbed].map(|solution| solution.states[0].probes["tip"]);
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {expected:?}");

    // Results of the older form are neither shown nor gone on with: their numbers were those of the half.
    let mut old = summary(&folder);
    old["format"] = 1.into();
    fs::write(folder.join("summary.json"), old.to_string()).unwrap();
    let shown = report_page(&folder).unwrap_err().to_string();
    assert!(shown.contains("format 1 instead of 2"), "{shown}");
    let Err(Error::Input(errors)) = analysis.run().resume(&folder).solve() else { panic!("it went on") };
    assert!(errors[0].to_string().contains("format 1 instead of 2"), "{}", errors[0]);
    fs::remove_dir_all(&folder).unwrap();
}
