//! The library without the command line: from memory to results, folders, errors and back.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::PathBuf;

use pneuflex::mesh::Facet;
use pneuflex::model::{Formulation, Law, Material};
use pneuflex::{
    Analysis, Body, Change, End, Error, Event, MemoryLimit, Observer, ResultsError, Run, Solution, Start, Status,
    StopToken, Study, template,
};

/// Two chambers on a mesh that is solved in no time.
fn coarse() -> Study {
    let mut study = Study::from_text("finger.toml", &template::two_chambers()).unwrap();
    study.set("mesh.size", "3").unwrap().set("mesh.element", "hex8-q1p0").unwrap();
    study.set("load.pressure_kpa", "[1, 2, 3]").unwrap();
    study
}

/// A cube of one hexahedron, 2 mm, on its bottom.
fn cube() -> Body {
    let nodes =
        (0..8).map(|n| [2.0 * f64::from(n & 1), 2.0 * f64::from(n >> 1 & 1), 2.0 * f64::from(n >> 2)]).collect();
    let mut cube = Body::new(Formulation::Hex8Q1p0, nodes, &[[0, 1, 3, 2, 4, 5, 7, 6]]).unwrap();
    cube.material(Material::from(Law::NeoHooke { c10: 0.1 }))
        .name_nodes("bottom", |[_, _, z]| z == 0.0)
        .name_faces("top", |[_, _, z]| z == 2.0)
        .hold("bottom", "xyz")
        .pressure("top", 10.0)
        .times([0.5, 1.0]);
    cube
}

fn scratch(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("pneuflex-face-{name}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&path);
    path
}

#[test]
fn what_is_handed_over_may_go_to_other_threads_and_outlive_its_maker() {
    fn owned<T: Send + Sync + 'static>() {}
    fn sendable<T: Send>() {}
    owned::<(Study, Analysis, Body, Solution, StopToken)>();
    owned::<Error>();
    sendable::<Run<'_>>();
}

#[test]
fn input_errors_have_key_place_and_help() {
    let text = template::two_chambers().replace("gap = ", "gpa = ");
    let Err(Error::Input(errors)) = Study::from_text("finger.toml", &text) else { panic!("it was read") };
    let unknown = errors.iter().find(|error| error.key() == Some("actuator.gpa")).unwrap();
    assert_eq!(unknown.help(), Some("did you mean `gap`?"));
    assert_eq!(unknown.file().unwrap().to_str(), Some("finger.toml"));
    let line = text.lines().position(|line| line.starts_with("gpa")).unwrap() + 1;
    assert_eq!(unknown.line(), Some(line));

    // A bad change leaves the study as it was.
    let mut study = coarse();
    let Err(Error::Input(errors)) = study.set("actuator.gap", "-1") else { panic!("it was set") };
    assert_eq!(errors[0].key(), Some("actuator.gap"));
    assert_eq!(study.case().unwrap().actuator.gap, 2.0.into());
    assert!(matches!(study.set("actuator", ""), Err(Error::Input(_))));
    study.set("actuator.gap", "1.5").unwrap();
    assert_eq!(study.case().unwrap().actuator.gap, 1.5.into());
}

#[test]
fn what_is_set_later_takes_the_place_of_what_it_stands_for() {
    let mut study = coarse();
    let number = study.changes().len();
    study.set("load.pressure_kpa", "[1]").unwrap().set("load.pressure_kpa", "[2]").unwrap();
    assert_eq!((study.changes().len(), &study.case().unwrap().load.pressure_kpa), (number, &vec![2.0]));
    // A table as a whole has nothing of the one before: no law has the constants of another one.
    study.set("material.c10", "0.3").unwrap().set("material", "{ law = \"neo-hooke\", c10 = 0.1 }").unwrap();
    assert_eq!(study.case().unwrap().material.law, Law::NeoHooke { c10: 0.1 });
    study.set("material.c10", "0.2").unwrap();
    assert_eq!(study.case().unwrap().material.law, Law::NeoHooke { c10: 0.2 });
    // A resolution would be nothing beside a size that was set before it; what is set together with it stays.
    let size = |study: &Study| study.case().unwrap().resolved().mesh.size;
    let coarse_size = size(&study);
    study.set("mesh.resolution", "draft").unwrap();
    assert!(size(&study) != coarse_size && study.case().unwrap().mesh.element.is_some(), "{:?}", size(&study));
    study.set_all([Change::new("mesh.resolution", "fine"), Change::new("mesh.size", "3")]).unwrap();
    assert_eq!(size(&study), coarse_size);
}

#[test]
fn a_model_on_a_mesh_in_memory_is_that_of_its_body() {
    let body = cube();
    let text = "load.times = [0.5, 1.0]\nmaterial = { law = \"neo-hooke\", c10 = 0.1 }\n\
                support = [{ nodes = \"bottom\", axes = \"xyz\" }]\npressure = [{ faces = \"top\", pressure_kpa = 10.0 }]\n";
    let study = Study::from_mesh("cube", text, Formulation::Hex8Q1p0, body.mesh()).unwrap();
    let (one, other) = (study.solve().unwrap(), body.analysis().unwrap().solve().unwrap());
    assert_eq!(one.fields[1].displacement, other.fields[1].displacement);
    let wrong = Study::from_mesh("cube", &text.replace("axes", "axis"), Formulation::Hex8Q1p0, body.mesh());
    let Err(Error::Input(errors)) = wrong else { panic!("it was read") };
    assert!(errors.iter().any(|error| error.help() == Some("did you mean `axes`?")), "{errors:?}");
    assert!(Study::from_mesh("cube", text, Formulation::Hex27, body.mesh()).is_err());
}

#[test]
fn a_run_can_be_recorded_when_it_has_ended() {
    let analysis = coarse().build().unwrap();
    let mut checkpoints = Vec::new();
    let run = analysis.run().observer(|event| {
        if let Event::StepAccepted(checkpoint) = event {
            checkpoints.push((*checkpoint).clone());
        }
    });
    let found = run.solve().unwrap();
    let states: Vec<_> = found.fields.iter().collect();
    let report = pneuflex::newton::PathReport { iterations: found.iterations, timing: found.timing };
    let end = End { report: &report, failure: None, reason: None, last: None, estimate: None, error: None };
    let [late, at_once] = [scratch("late"), scratch("at-once")];
    analysis.record(&late, &states, checkpoints.last().map(|last| (last, 2)), &end).unwrap();
    let further = coarse().set("load.pressure_kpa", "[1, 2, 3, 4]").unwrap().build().unwrap();
    let gone_on = further.run().resume(&late).solve().unwrap();
    let straight = further.run().record(&at_once).solve().unwrap();
    assert_eq!(gone_on.states[..3], straight.states[..3]);
    let tip = |found: &Solution| found.states[3].probes["tip"][2];
    assert!((tip(&gone_on) - tip(&straight)).abs() < 1e-9 * tip(&straight).abs());
    for file in ["case.toml", "fields/step_01.vtu", "fields/step_03.vtu", "fields/series.pvd"] {
        assert_eq!(fs::read(late.join(file)).unwrap(), fs::read(at_once.join(file)).unwrap(), "{file}");
    }
    for folder in [late, at_once] {
        fs::remove_dir_all(folder).unwrap();
    }
}

#[test]
fn a_run_goes_on_to_later_times_only_under_the_same_loads() {
    let (folder, mut ramp) = (scratch("later"), cube());
    ramp.analysis().unwrap().run().record(&folder).solve().unwrap();
    // It grows up to the last time: half of it would be there at the time 1 if that were 2.
    let Err(Error::Input(errors)) = ramp.times([0.5, 1.0, 2.0]).analysis().unwrap().run().resume(&folder).solve()
    else {
        panic!("it went on")
    };
    assert!(errors[0].to_string().contains("reached under other loads"), "{errors:?}");

    let mut given = cube();
    given.model.pressures[0].pressure_kpa = vec![[0.0, 0.0], [2.0, 20.0]].into();
    given.analysis().unwrap().run().record(&folder).solve().unwrap();
    let gone_on = given.times([0.5, 1.0, 2.0]).analysis().unwrap().run().resume(&folder).solve().unwrap();
    let straight = given.analysis().unwrap().solve().unwrap();
    for (one, other) in gone_on.states.iter().zip(&straight.states) {
        assert!((one.strain_energy_mj - other.strain_energy_mj).abs() < 1e-6 * other.strain_energy_mj);
    }
    assert_eq!(gone_on.states.len(), 3);
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_case_put_together_in_memory_is_the_one_of_its_file() {
    let study = coarse();
    let again = Study::actuator(study.case().unwrap()).unwrap();
    assert_eq!(again.case().unwrap().resolved(), study.case().unwrap().resolved());
    assert_eq!(again.build().unwrap().problem, study.build().unwrap().problem);
}

#[test]
fn too_little_memory_is_an_error_that_can_be_overruled() {
    let mut study = coarse();
    study.set("mesh.size", "0.02").unwrap();
    assert!(study.estimate().unwrap().bytes > 1e12);
    let Err(Error::Input(errors)) = study.build() else { panic!("it was built") };
    assert_eq!(errors[0].kind(), pneuflex::input_error::InputErrorKind::TooLarge);
    assert!(study.estimate().unwrap().within(MemoryLimit::None).unwrap().is_some());
}

#[test]
fn a_cube_under_pressure_is_pressed_down() {
    let analysis = cube().analysis().unwrap();
    let solution = analysis.solve().unwrap();
    assert_eq!(solution.states.iter().map(|state| state.when().0).collect::<Vec<_>>(), [0.5, 1.0]);
    let top = |state: usize| solution.fields[state].displacement[7][2];
    assert!(top(1) < top(0) && top(0) < -1e-4, "{} {}", top(0), top(1));
    // 10 kPa on 4 mm² by the bottom's reaction: N, upwards, a little more where the face has widened.
    let reaction = solution.states[1].reactions["bottom"][2];
    assert!((0.04..0.05).contains(&reaction), "{reaction}");
    let described = analysis.describe(&solution.fields[1]).unwrap();
    assert_eq!(described.summary, solution.states[1]);
}

/// An actuator as the body of a model file has the air that the file gives it, and none if it gives none.
#[test]
fn an_actuator_in_a_model_file_without_a_cavity_has_no_air() {
    let model = |loads: &str| {
        let text = format!(
            "[actuator]\nchambers = 2\nchamber_length = 8.0\ncavity_length = 6.0\ngap = 2.0\nflange = 2.0\nwidth = 20.0\n\
             height = 13.0\nbase = 4.0\nside_wall = 1.0\ntop_wall = 1.0\n\
             channel = {{ half_width = 1.0, bottom = 2.0, top = 3.0 }}\n\
             [mesh]\nelement = \"hex8-q1p0\"\nsize = 3.0\n[load]\ntimes = [1.0, 20.0]\n\
             [[probe]]\nname = \"end\"\nat = [22.0, 0.0, 0.0]\n{loads}"
        );
        Study::from_text("model.toml", &text).unwrap().build().unwrap().solve().unwrap()
    };
    let without = model("");
    assert_eq!(without.states.len(), 2);
    for state in &without.states {
        assert!(state.cavities.is_empty() && state.probes["end"].iter().all(|u| u.abs() < 1e-12), "{state:?}");
    }
    let with = model("[[cavity]]\nname = \"air\"\nfaces = \"cavity\"\npressure_kpa = 1.0\n");
    assert!(
        (with.states[1].cavities["air"].pressure_kpa - 1.0).abs() < 1e-12 && with.states[1].probes["end"][2] < -1e-3
    );
}

/// A ball that comes up under a bar lifts it, as the bar does that comes down on the ball; it does not throw it to the other side of another
/// obstacle (where it stayed, 5 mm lower, as an equilibrium).
#[test]
fn an_obstacle_that_moves_is_a_support_that_moves_the_other_way() {
    let [length, half_width, height] = [9.78, 3.23, 4.22];
    let at = |i: usize, j: usize, k: usize| (4 * i + 2 * j + k) as u32;
    let nodes: Vec<[f64; 3]> = (0..16)
        .map(|n| {
            let [i, j, k] = [n / 4, n / 2 % 2, n % 2].map(|c| c as f64);
            [i * length / 3.0, (2.0 * j - 1.0) * half_width, k * height]
        })
        .collect();
    let face = |i| [at(i, 0, 0), at(i, 1, 0), at(i, 1, 1), at(i, 0, 1)];
    let cells: Vec<Vec<u32>> = (0..3).map(|i| [face(i), face(i + 1)].concat()).collect();
    let up = 0.633;
    let solve = |is_ball_moved: bool| {
        let mut bar = Body::new(Formulation::Hex8Sri, nodes.clone(), &cells).unwrap();
        bar.material(Material { bulk_modulus: 3.0, ..Law::NeoHooke { c10: 0.3 }.into() })
            .name_nodes("clamp", |[x, _, _]| x == 0.0)
            .name_faces("under", |[_, _, z]| z == 0.0)
            .probe("tip", [length, half_width, height])
            .times([1.0]);
        let [of_block, of_ball] = if is_ball_moved { [0.0, up] } else { [-up, 0.0] };
        if is_ball_moved {
            bar.hold("clamp", "xyz")
        } else {
            bar.displace("clamp", "xyz", [0.0, 0.0, -up])
        };
        let text = format!(
            "[[obstacle]]\nname = \"block\"\nshape = \"cuboid\"\nfaces = \"under\"\ncentre = [5.61372, 0.0, -1.7724]\n\
             size = [1.688, 3.376, 3.376]\nedge_radius = 0.3376\nstiffness = 3.78\ndisplacement = [0.0, 0.0, {of_block:?}]\n\
             [[obstacle]]\nname = \"ball\"\nshape = \"sphere\"\nfaces = \"under\"\ncentre = [7.24698, 0.0, -1.4348]\n\
             radius = 1.4348\nstiffness = 4.5\ndisplacement = [0.0, 0.0, {of_ball:?}]\n"
        );
        bar.model.obstacles = toml::from_str::<pneuflex::model::model_file::Model>(&text).unwrap().obstacles;
        let state = bar.analysis().unwrap().solve().unwrap().states.remove(0);
        (state.probes["tip"][2] + if is_ball_moved { 0.0 } else { up }, state.obstacles["ball"].force_n[2])
    };
    let (lifted, lowered) = (solve(true), solve(false));
    assert!((lifted.0 - lowered.0).abs() < 1e-5 && (lifted.1 - lowered.1).abs() < 1e-5, "{lifted:?} {lowered:?}");
    assert!(lifted.0 > 0.03 && lifted.1 < -1e-3, "{lifted:?}");
}

#[test]
fn bodies_that_make_no_sense_are_refused() {
    let refused = |nodes: Vec<[f64; 3]>, cell: &[u32]| match Body::new(Formulation::Hex8Q1p0, nodes, &[cell]) {
        Err(Error::Input(errors)) => errors[0].to_string(),
        other => panic!("{other:?}"),
    };
    let nodes = vec![[0.0; 3]; 8];
    assert!(refused(nodes.clone(), &[0, 1, 2]).contains("3 nodes instead of 8"));
    assert!(refused(nodes.clone(), &[0, 1, 2, 3, 4, 5, 6, 8]).contains("node 8"));
    assert!(refused(vec![[f64::NAN; 3]; 8], &[0, 1, 2, 3, 4, 5, 6, 7]).contains("not finite"));
    let mut body = cube();
    body.add_face_set("none", vec![Facet { element: 3, face: 0 }]);
    assert!(matches!(body.analysis(), Err(Error::Input(errors)) if errors[0].to_string().contains("set none")));
    let mut body = cube();
    body.hold("nowhere", "x");
    assert!(matches!(body.analysis(), Err(Error::Input(errors)) if errors[0].key() == Some("support[1].nodes")));
    // All nodes in one place, and in one plane.
    assert!(matches!(
        Body::new(Formulation::Hex8Q1p0, nodes, &[[0, 1, 2, 3, 4, 5, 6, 7]]).unwrap().times([1.0]).analysis(),
        Err(Error::Input(errors)) if errors[0].to_string().contains("1e-6 to 1e6 mm")
    ));
    let nodes = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| [x, y, 0.0]).repeat(2);
    let mut flat = Body::new(Formulation::Hex8Q1p0, nodes.to_vec(), &[[0, 1, 2, 3, 4, 5, 6, 7]]).unwrap();
    flat.name_nodes("all", |_| true).hold("all", "xyz").times([1.0]);
    assert!(matches!(flat.analysis().unwrap().solve(), Err(Error::Setup(_))));
}

#[test]
fn a_study_is_all_files_that_it_is_read_from() {
    let folder = scratch("files");
    fs::create_dir_all(folder.join("body")).unwrap();
    let deck = "*INCLUDE, INPUT=nodes.inc\n*ELEMENT, TYPE=C3D8, ELSET=BAR\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*NSET, NSET=FOOT\n1, 2, 3, 4\n\
                *MATERIAL, NAME=SILICONE\n*HYPERELASTIC, NEO HOOKE\n0.1, 0.1\n*SOLID SECTION, ELSET=BAR, MATERIAL=SILICONE\n\
                *BOUNDARY\nFOOT, 1, 3\n*STEP, NLGEOM\n*STATIC\n1., 1.\n*BOUNDARY\nFOOT, 3, 3, 0.1\n*END STEP\n";
    let nodes =
        "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 2\n6, 1, 0, 2\n7, 1, 1, 2\n8, 0, 1, 2\n";
    let model = "model.file = \"body/brick.inp\"\nload.times = [1.0]\n";
    for (name, text) in [("brick.toml", model), ("body/brick.inp", deck), ("body/nodes.inc", nodes)] {
        fs::write(folder.join(name), text).unwrap();
    }
    for (name, count) in [("brick.toml", 3), ("body/brick.inp", 2)] {
        let name = folder.join(name).display().to_string();
        let study = Study::load(&name).unwrap();
        let files = study.files().unwrap();
        assert_eq!(files.len(), count);
        let files: Vec<_> = files.into_iter().map(|(path, bytes)| (path.display().to_string(), bytes)).collect();
        // The copy reads nothing from the disk.
        let built = study.build().unwrap().problem;
        let elsewhere = scratch("files-elsewhere");
        fs::rename(&folder, &elsewhere).unwrap();
        let copy = Study::from_files_with(&name, files, Vec::new()).unwrap();
        assert!(copy.build().unwrap().problem == built);
        assert_eq!(copy.files().unwrap().len(), count);
        assert!(study.files().is_err());
        fs::rename(&elsewhere, &folder).unwrap();
    }
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_run_is_stopped_recorded_and_gone_on_with_as_if_it_had_never_ended() {
    let analysis = coarse().build().unwrap();
    let whole = analysis.solve().unwrap();
    assert_eq!(whole.states.len(), 3);

    let path = scratch("resumed");
    let token = StopToken::new();
    let mut checkpoint = None;
    let stopped = analysis.run().stop(&token).record(&path).observer(|event| match event {
        Event::StepAccepted(accepted) => checkpoint = Some((*accepted).clone()),
        Event::State(state) if state.summary.pressure_kpa == 2.0 => {
            token.stop();
        }
        _ => {}
    });
    let Err(Error::Interrupted(ended)) = stopped.solve() else { panic!("it went on") };
    assert_eq!((ended.reached.states.len(), ended.reached.status), (2, Status::Interrupted));
    assert_eq!((ended.failure.reached.0, ended.reason.is_none()), (2.0, true));

    let close = |a: &Solution, states: usize| {
        assert_eq!(a.states.len(), states);
        let (last, expected) = (a.states.last().unwrap(), whole.states.last().unwrap());
        let [found, wanted] = [last, expected].map(|state| state.end_face_angle_deg.unwrap());
        assert!((found / wanted - 1.0).abs() < 1e-9, "{found} {wanted}");
        assert_eq!(a.iterations, whole.iterations);
    };
    // From memory the state at the checkpoint is reached once more.
    let checkpoint = checkpoint.unwrap();
    close(&analysis.run().resume_from(checkpoint.clone()).solve().unwrap(), 2);
    // With the state before it, as from a folder; and both leave out nothing that was reached.
    let start = |of: &Analysis| of.start_after(&analysis, &ended.reached, Some((&checkpoint, 1)));
    close(&analysis.run().start_at(start(&analysis).unwrap()).solve().unwrap(), 3);
    let other = coarse().set("load.pressure_kpa", "[1, 1.5]").unwrap().build().unwrap();
    let refused = start(&other).unwrap_err().to_string();
    assert!(refused.starts_with("load.pressure_kpa leaves out what was reached"), "{refused}");
    let Err(Error::Input(errors)) = other.run().resume(&path).solve() else { panic!("it went on") };
    assert!(errors[0].to_string().ends_with(&refused), "{}", errors[0]);
    let stiffer = coarse().set("material.c10", "0.3").unwrap().build().unwrap();
    assert!(start(&stiffer).unwrap_err().to_string().contains("material.c10 was"));
    close(&analysis.run().resume(&path).solve().unwrap(), 3);
    let summary: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(path.join("summary.json")).unwrap()).unwrap();
    assert_eq!(summary["status"], "converged");
    // Nothing is left to do.
    let again = analysis.run().resume(&path).observer(|_| panic!("it was solved once more")).solve().unwrap();
    assert_eq!((again.states.len(), again.status), (3, Status::Converged));
    assert!(matches!(analysis.start_after(&analysis, &again, None), Ok(Start::Complete(states)) if states.len() == 3));
    fs::remove_dir_all(&path).unwrap();
}

#[test]
fn a_body_from_memory_is_recorded_and_shown() {
    let path = scratch("body");
    cube().analysis().unwrap().run().record(&path).solve().unwrap();
    let page = pneuflex::report_page::report_page(&path).unwrap();
    assert!(page.contains("<html"), "{page:.200}");
    // The folder is a model of its own.
    let again = Study::load(path.join("case.toml")).unwrap().build().unwrap();
    let (ours, theirs) = (cube().analysis().unwrap().problem, again.problem);
    assert_eq!((ours.mesh, ours.supports, ours.loads), (theirs.mesh, theirs.supports, theirs.loads));
    assert_eq!(cube().analysis().unwrap().run().resume(&path).solve().unwrap().states.len(), 2);
    fs::remove_dir_all(&path).unwrap();
}

/// Fails at the second state.
#[derive(Default)]
struct Failing {
    states: usize,
    ended: Option<bool>,
}

impl Observer for &mut Failing {
    fn observe(&mut self, event: &Event<'_>) -> Result<(), ResultsError> {
        if let Event::State(_) = event {
            self.states += 1;
            if self.states == 2 {
                return Err(ResultsError::not_representable("table.csv", "it is full"));
            }
        }
        Ok(())
    }

    fn finish(&mut self, end: &End<'_>) -> Result<(), ResultsError> {
        self.ended = Some(end.error.is_some());
        Ok(())
    }
}

#[test]
fn an_observer_that_fails_ends_the_run_and_no_other_one() {
    let analysis = coarse().build().unwrap();
    let token = StopToken::new();
    let mut failing = Failing::default();
    let result = analysis.run().stop(&token).observe_with(&mut failing).threads(1).solve();
    assert!(matches!(result, Err(Error::Results(error)) if error.to_string() == "table.csv: it is full"));
    assert_eq!((failing.states, failing.ended), (2, Some(true)));
    assert!(!token.is_stopped());
}

#[test]
fn decks_and_meshes_are_read_from_memory() {
    let deck = "*HEADING\nA cube\n*INCLUDE, INPUT=mesh.inp\n*MATERIAL, NAME=M\n*HYPERELASTIC, NEO HOOKE\n0.1, 0.1\n\
                *SOLID SECTION, ELSET=ALL, MATERIAL=M\n*BOUNDARY\nBOTTOM, 1, 3\n*STEP, NLGEOM\n*STATIC\n1, 1\n*CLOAD\nTIP, 3, 0.01\n*END STEP\n";
    let mesh = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n8, 0, 1, 1\n\
                *ELEMENT, TYPE=C3D8, ELSET=ALL\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*NSET, NSET=BOTTOM\n1, 2, 3, 4\n*NSET, NSET=TIP\n7\n";
    let files =
        [("cube.inp", deck), ("mesh.inp", mesh)].map(|(name, text)| (name.to_owned(), text.as_bytes().to_vec()));
    let mut study = Study::from_files("cube.inp", files.clone()).unwrap();
    assert!(
        matches!(study.set("load.times", "[1]"), Err(Error::Input(errors)) if errors[0].key() == Some("load.times"))
    );
    let analysis = study.build().unwrap();
    assert_eq!((analysis.title.as_str(), analysis.overview().nodes), ("A cube", 8));
    assert!(analysis.solve().unwrap().fields[0].displacement[6][2] > 1e-3);
    // A file that is not among them is named.
    let Err(Error::Input(errors)) = Study::from_files("cube.inp", files.into_iter().take(1)).unwrap().build() else {
        panic!("it was built")
    };
    assert!(errors[0].to_string().contains("mesh.inp") && errors[0].line() == Some(3), "{}", errors[0]);
}
