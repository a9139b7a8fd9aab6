//! Input that would give a number which is not the one that was asked for: refused, or honoured and said, in every kind of file.

#![allow(clippy::unwrap_used)]

use pneuflex::diagnosis::WarningKind;
use pneuflex::model::{Formulation, Law, Material};
use pneuflex::{Analysis, Body, Change, Error, Study, template};

/// Four chambers and what else a file says.
fn file(rest: &str) -> String {
    format!(
        "[actuator]\nchambers = 4\nchamber_length = 8.0\ncavity_length = 6.0\ngap = 2.0\nflange = 2.0\nwidth = 20.0\nheight = 13.0\n\
         base = 4.0\nside_wall = 1.0\ntop_wall = 1.0\nchannel = {{ half_width = 1.0, bottom = 2.0, top = 3.0 }}\n\
         [mesh]\nresolution = \"draft\"\n{rest}"
    )
}

const TIMES: &str = "[load]\ntimes = [1.0]\n";

/// A model file of four chambers with weight.
fn model(rest: &str) -> String {
    file(&format!("[material]\nlaw = \"neo-hooke\"\nc10 = 0.03\ndensity = 1.1\n{TIMES}{rest}"))
}

fn build(text: &str) -> Result<Analysis, Error> {
    Study::from_text("finger.toml", text)?.build()
}

/// Keys and messages of what is refused.
#[track_caller]
fn refused(text: &str) -> Vec<(String, String)> {
    let Err(Error::Input(errors)) = build(text) else { panic!("it was built: {text}") };
    errors.iter().map(|error| (error.key().unwrap_or_default().to_owned(), error.to_string())).collect()
}

#[track_caller]
fn assert_refused(text: &str, key: &str, words: &str) {
    let found = refused(text);
    let is_said = found.iter().any(|(k, message)| k == key && message.contains(words));
    assert!(is_said, "{key} with `{words}` is not in {found:?}");
}

fn kinds(text: &str) -> Vec<WarningKind> {
    build(text).unwrap().cautions().into_iter().map(|warning| warning.kind).collect()
}

/// A block of two hexahedra above each other, 2 mm x 2 mm x 4 mm.
fn block() -> Body {
    let nodes =
        (0..12).map(|n| [2.0 * f64::from(n & 1), 2.0 * f64::from(n >> 1 & 1), 2.0 * f64::from(n >> 2)]).collect();
    let cell = |n: u32| [n, n + 1, n + 3, n + 2, n + 4, n + 5, n + 7, n + 6];
    let mut block = Body::new(Formulation::Hex8Q1p0, nodes, &[cell(0), cell(4)]).unwrap();
    block
        .material(Material::from(Law::NeoHooke { c10: 0.1 }))
        .name_nodes("bottom", |[_, _, z]| z == 0.0)
        .name_nodes("middle", |[_, y, _]| y == 0.0)
        .name_nodes("far", |[_, y, _]| y == 2.0)
        .name_faces("top", |[_, _, z]| z == 4.0)
        .hold("bottom", "xyz")
        .times([1.0]);
    block
}

#[track_caller]
fn assert_body_refused(body: &Body, key: &str, words: &str) {
    let Err(Error::Input(errors)) = body.analysis() else { panic!("it was built") };
    let said: Vec<_> = errors.iter().map(|error| (error.key().unwrap_or_default(), error.to_string())).collect();
    assert!(said.iter().any(|(k, message)| *k == key && message.contains(words)), "{said:?}");
}

#[test]
fn changes_of_the_mesh_that_are_made_together_have_no_order() {
    let changed = |text: &str, changes: &[(&str, &str)]| {
        let mut study = Study::from_text("finger.toml", text).unwrap();
        study.set_all(changes.iter().map(|(key, value)| Change::new(*key, *value))).unwrap();
        study.case().unwrap().mesh.clone()
    };
    let paper = template::two_chambers().replace("resolution = \"standard\"", "size = 1.0\nelement = \"hex8-sri\"");
    let (element, resolution, size) = (("mesh.element", "tet10"), ("mesh.resolution", "draft"), ("mesh.size", "2.0"));
    for text in [template::two_chambers(), paper.clone()] {
        for changes in [[element, resolution, size], [resolution, size, element], [size, element, resolution]] {
            let mesh = changed(&text, &changes);
            assert_eq!(mesh, changed(&text, &[resolution, element, size]));
            assert_eq!((mesh.formulation(), mesh.size.is_some()), (Formulation::Tet10, true));
        }
    }
    // A resolution takes the place of a mesh that was given by its size, element and all.
    let mesh = changed(&paper, &[resolution]);
    assert_eq!((mesh.formulation(), mesh.size), (Formulation::Hex27, None));
    // An element that stands beside a resolution was chosen for it.
    let chosen =
        template::two_chambers().replace("resolution = \"standard\"", "resolution = \"standard\"\nelement = \"hex20\"");
    assert_eq!(changed(&chosen, &[resolution]).formulation(), Formulation::Hex20);
}

#[test]
fn an_imported_body_is_not_meshed() {
    let mut body = block();
    body.model.mesh.resolution = Some(pneuflex::model::Resolution::Fine);
    assert_body_refused(&body, "mesh.resolution", "imported body");
    let deck = "[model]\nfile = \"a.inp\"\n[mesh]\nresolution = \"fine\"\nsize = 2.0\n";
    let found = refused(deck);
    assert_eq!(found.iter().map(|(key, _)| key.as_str()).collect::<Vec<_>>(), ["mesh.resolution", "mesh.size"]);
    // What an actuator of a model file is meshed with has a range as in a case file.
    assert_refused(&model("").replace("resolution = \"draft\"", "size = 0.0"), "mesh.size", "greater than 0");
}

/// Faces feel one air, and chambers have air of their own only where nothing joins them.
#[test]
fn cavities_do_not_overlap() {
    let cavity =
        |name: &str, faces: &str| format!("[[cavity]]\nname = \"{name}\"\nfaces = \"{faces}\"\npressure_kpa = 1\n");
    assert_refused(&model(&cavity("first", "cavity_1")), "cavity[0].faces", "the channel joins the cavities");
    let apart = |rest: &str| model(rest).replace("half_width = 1.0", "half_width = 0.0");
    assert_refused(&apart(&cavity("fifth", "cavity_5")), "cavity[0].faces", "cavity_4");
    let both = cavity("all", "cavity") + &cavity("first", "cavity_1");
    assert_refused(&apart(&both), "cavity[1].faces", "the air of both");
    let each = cavity("first", "cavity_1") + &cavity("second", "cavity_2");
    assert!(Study::from_text("model.toml", &apart(&each)).unwrap().build().is_ok());
}

#[test]
fn nothing_hides_another_of_its_name() {
    let two = |table: &str| format!("{table}{table}");
    let probe = "[[probe]]\nname = \"tip\"\nat = [42.0, 0.0, 0.0]\n";
    assert_refused(&model(&two(probe)), "probe[1].name", "different");
    assert_refused(&file(&format!("[load]\npressure_kpa = [1]\n{}", two(probe))), "probe[1].name", "different");
    let cavity = "[[cavity]]\nname = \"air\"\nfaces = \"cavity\"\npressure_kpa = 1\n";
    assert_refused(&model(&two(cavity)), "cavity[1].name", "different");
    let region =
        "[[region]]\nname = \"r\"\nbox = [[0, -10, 0], [42, 10, 1]]\nmaterial = { law = \"neo-hooke\", c10 = 1.0 }\n";
    assert_refused(&model(&two(region)), "region[1].name", "different");
    let obstacle = "[[obstacle]]\nname = \"o\"\nshape = \"plane\"\npoint = [0, 0, -9]\nnormal = [0, 0, 1]\n";
    assert_refused(&model(&two(obstacle)), "obstacle[1].name", "different");
    // The same surfaces twice would be twice as stiff.
    let contact = "[[contact]]\nslave = \"cavity\"\nmaster = \"cavity\"\n";
    assert_refused(&model(&two(contact)), "contact[1].slave", "already");
    // A table may say how an actuator's gap is kept apart, once.
    let gap = "[[contact]]\nslave = \"gap_1_right\"\nmaster = \"gap_1_left\"\n";
    assert_refused(&model(&two(gap)), "contact[1].slave", "already");
    for (key, value, allowed) in [
        ("method", "\"none\"", "mortar or multi-point"),
        ("method", "\"mortar\"", "nodes in common"),
        ("penetration_tolerance", "0.0", "greater than 0"),
    ] {
        let table = format!("[[contact]]\nslave = \"cavity\"\nmaster = \"cavity\"\n{key} = {value}\n");
        assert_refused(&model(&table), &format!("contact[0].{key}"), allowed);
    }
    let mut body = block();
    body.pressure("top", 1.0).probe("p", [0.0; 3]).probe("p", [2.0; 3]);
    assert_body_refused(&body, "probe[1].name", "different");
}

#[test]
fn probes_are_on_the_body() {
    let probe = |at: &str| format!("[[probe]]\nname = \"p\"\nat = {at}\n");
    let pressure = "[load]\npressure_kpa = [1]\n";
    for at in ["[-inf, 0, 0]", "[nan, 0, 0]", "[1e300, 0, 0]", "[0, 9000, 0]", "[42, -3, 0]"] {
        assert_refused(&model(&probe(at)), "probe[0].at", "");
        assert_refused(&file(&(pressure.to_owned() + &probe(at))), "probe[0].at", "");
    }
    for at in [[f64::NEG_INFINITY, 0.0, 0.0], [0.0, f64::NAN, 0.0], [0.0, 0.0, 1e300], [0.0, 9.0, 0.0]] {
        assert_body_refused(block().probe("p", at), "probe[0].at", "");
    }
    assert_eq!(kinds(&model(&probe("[42, 0, 0]"))), []);
    assert_eq!(kinds(&model(&probe("[45, 0, 0]"))), [WarningKind::Probe]);
}

#[test]
fn what_breaks_the_plane_of_a_half_is_refused_and_the_whole_takes_it() {
    let gravity = "[gravity]\nacceleration = [0.0, -9810.0, 0.0]\n";
    let force = "[[force]]\nnodes = \"end_face\"\ntotal = [0.0, 0.1, 0.0]\n";
    let moved = "[[support]]\nnodes = \"end_face\"\naxes = \"y\"\ndisplacement = [0, 2, 0]\n";
    let traction = "[[traction]]\nfaces = \"end_face\"\ntraction_mpa = [0, 0.001, 0]\n";
    let ball = |y: f64| {
        format!("[[obstacle]]\nname = \"ball\"\nshape = \"sphere\"\ncentre = [30.0, {y:?}, -6.0]\nradius = 5.0\n")
    };
    let (beyond, beside) = (ball(-6.0), ball(6.0));
    for (rest, key) in [
        (gravity, "gravity.acceleration"),
        (force, "force[0].total"),
        (moved, "support[0].displacement"),
        (traction, "traction[0].traction_mpa"),
        (&beyond, "obstacle[0].centre"),
        (&ball(2.0), "obstacle[0].centre"),
    ] {
        assert_refused(&model(rest), key, "set actuator.part = \"whole\"");
        assert_refused(&model(rest), key, "y = 0");
        assert!(refused(&model(rest)).iter().all(|(_, message)| !message.contains("out of range")), "{rest}");
        let whole = model(rest).replace("base = 4.0", "base = 4.0\npart = \"whole\"");
        assert!(build(&whole).is_ok(), "{rest}");
    }
    let case = |rest: &str| file(&format!("[load]\npressure_kpa = [20]\n{rest}"));
    assert_refused(&case(&beyond), "obstacle[0].centre", "nothing is modelled");
    assert!(build(&case(&beyond).replace("base = 4.0", "base = 4.0\npart = \"whole\"")).is_ok());
    // Two balls, one on either side.
    assert_eq!(
        (kinds(&case(&beside)), kinds(&model(&beside))),
        (vec![WarningKind::Symmetry], vec![WarningKind::Symmetry])
    );
    assert_eq!((kinds(&case(&ball(0.0))), kinds(&model(&ball(0.0)))), (vec![], vec![]));
    // A declared plane is no other.
    let mut body = block();
    body.symmetry("middle", "y").force("far", [0.0, 0.1, 0.0]);
    assert_eq!(body.analysis().unwrap().cautions()[0].kind, WarningKind::Symmetry);
    body.force("top", [0.0, 0.1, 0.0]);
    assert_body_refused(&body, "force[1].total", "model the whole body");
    let mut roller = block();
    roller.hold("middle", "y").force("top", [0.0, 0.1, 0.0]);
    assert!(roller.analysis().unwrap().cautions().is_empty());
}

#[test]
fn a_region_is_what_its_box_says() {
    let region = |corners: &str| {
        format!(
            "[[region]]\nname = \"paper\"\nbox = {corners}\nmaterial = {{ law = \"neo-hooke\", c10 = 2.71, bulk_modulus = 1800.0 }}\n"
        )
    };
    let volume = |text: &str| {
        let problem = build(text).unwrap().problem;
        problem.mesh.volume_of(problem.regions[0].elements.iter().copied())
    };
    let layer = model(&region("[[0, -10, 0], [42, 10, 1.0]]"));
    assert!((volume(&layer) - 420.0).abs() < 1e-9, "{}", volume(&layer));
    assert!((volume(&layer.replace("base = 4.0", "base = 4.0\npart = \"whole\"")) - 840.0).abs() < 1e-9);
    // Inside of the base, and with tetrahedra.
    let bar = model(&region("[[3.3, -2.5, 0.4], [38.1, 2.5, 1.7]]"));
    assert!((volume(&bar) - 34.8 * 2.5 * 1.3).abs() < 1e-9);
    let tetrahedra = bar.replace("resolution = \"draft\"", "resolution = \"draft\"\nelement = \"tet10\"");
    assert!((volume(&tetrahedra) - 34.8 * 2.5 * 1.3).abs() < 1e-9);
    assert!(build(&layer).unwrap().overview().to_string().contains("420"), "check prints the volume");
    // One side only, on both but not alike, two of it.
    assert_refused(
        &model(&region("[[0, -10, 0], [42, -1, 1.0]]")),
        "region[0].box",
        "beyond the plane of symmetry y = 0",
    );
    assert_refused(&model(&region("[[0, -3, 0], [42, 10, 1.0]]")), "region[0].box", "the same on both sides");
    assert_eq!(kinds(&model(&region("[[0, 2, 0], [42, 10, 1.0]]"))), [WarningKind::Symmetry]);
    // Elsewhere it must follow the elements.
    let stiff = Material::from(Law::NeoHooke { c10: 1.0 });
    let boxed = |z: f64| {
        let mut body = block();
        body.model.regions.push(pneuflex::model::model_file::RegionTable {
            name: "r".into(),
            elements: None,
            within: Some([[0.0; 3], [2.0, 2.0, z]]),
            material: stiff.clone(),
        });
        body
    };
    assert_eq!(boxed(2.05).analysis().unwrap().problem.regions[0].elements, [0]);
    assert_body_refused(&boxed(1.5), "region[0].box", "6.0");
    assert_body_refused(&boxed(0.5), "region[0].box", "must follow faces");
}

#[test]
fn results_carry_warnings_in_every_kind_of_file() {
    let kinds = |analysis: &Analysis| -> Vec<WarningKind> {
        analysis.solve().unwrap().warnings.into_iter().map(|warning| warning.kind).collect()
    };
    // A soft plate that is pressed onto a block: it enters by more than 1 % of an element.
    let mut pressed = block();
    let plate = "name = \"plate\"\nshape = \"plane\"\nfaces = \"top\"\npoint = [0, 0, 4]\nnormal = [0, 0, -1]\n\
                 displacement = [0, 0, -0.3]\nstiffness = 0.5\n";
    pressed.model.obstacles.push(toml::from_str(plate).unwrap());
    pressed.times([0.5, 1.0]);
    let warnings = pressed.analysis().unwrap().solve().unwrap().warnings;
    let found: Vec<_> = warnings.iter().map(|warning| warning.kind).collect();
    assert_eq!(found, [WarningKind::Penetration, WarningKind::CoarseMesh]);
    // It is headed by where it begins, and says where it is worst.
    let words = "from time 0.5 on; at time 1 what touches passes through each other by";
    assert!(warnings[0].time == Some(0.5) && warnings[0].message.starts_with(words), "{}", warnings[0]);
    pressed.model.obstacles[0].stiffness = Some(500.0);
    assert_eq!(kinds(&pressed.analysis().unwrap()), [WarningKind::CoarseMesh]);
    // Constants in kPa instead of MPa, as a case file and as a model file.
    let mesh = "resolution = \"draft\"";
    let coarse = "size = 4.5\nelement = \"hex8-q1p0\"";
    let stiff = "[material]\nlaw = \"neo-hooke\"\nc10 = 100.0\nbulk_modulus = 10000.0\n";
    let air = "[[cavity]]\nname = \"air\"\nfaces = \"cavity\"\npressure_kpa = 60\n";
    for rest in [format!("{stiff}[load]\npressure_kpa = [60]\n"), format!("{stiff}{TIMES}{air}")] {
        let found = kinds(&build(&file(&rest).replace(mesh, coarse)).unwrap());
        assert_eq!(found, [WarningKind::Units, WarningKind::CoarseMesh, WarningKind::Units], "{rest}");
        let soft = rest.replace("100.0", "0.3").replace("10000.0", "1000.0").replace("60", "5");
        assert_eq!(kinds(&build(&file(&soft).replace(mesh, coarse)).unwrap()), [WarningKind::CoarseMesh], "{soft}");
        // Little of the body is stretched by more than a hundredth.
        let measured = soft.replace("[material]\n", "[material]\nfitted_to = 1.01\n");
        let found = kinds(&build(&file(&measured).replace(mesh, coarse)).unwrap());
        assert_eq!(found, [WarningKind::BeyondFit, WarningKind::CoarseMesh], "{measured}");
    }
}

/// Lengths of single chambers are set by their numbers, whatever is set before or after, and the list is what is solved.
#[test]
fn one_chamber_is_changed_by_its_number() {
    let text = file("[load]\npressure_kpa = [1]\n");
    let set = |changes: &[(&str, &str)]| {
        let mut study = Study::from_text("finger.toml", &text).unwrap();
        study.set_all(changes.iter().map(|&(key, value)| Change::new(key, value)))?;
        Ok::<_, Error>(study)
    };
    let one = set(&[("actuator.gap[3]", "1.5"), ("actuator.top_wall[1]", "2")]).unwrap();
    let actuator = &one.case().unwrap().actuator;
    assert_eq!((&actuator.gap, &actuator.top_wall), (&[2.0, 2.0, 1.5].into(), &[2.0, 1.0, 1.0, 1.0].into()));
    let walls = one.build().unwrap().problem.mesh.facet_set("gap_3_right").len();
    assert!(walls > 0);
    // An entry of the list, and of as many chambers, as the other keys leave.
    for order in [[0, 1, 2], [2, 1, 0]] {
        let changes = [("actuator.gap[2]", "0"), ("actuator.gap", "[1, 2]"), ("actuator.chambers", "3")];
        let study = set(&order.map(|i| changes[i])).unwrap();
        assert_eq!(study.case().unwrap().actuator.gap, [1.0, 0.0].into());
    }
    // A list as a whole takes the place of entries that were set before, and entries stay beside other keys.
    let mut study = one;
    study.set("actuator.gap", "0.5").unwrap().set("actuator.flange", "1").unwrap();
    assert_eq!(study.case().unwrap().actuator.gap, 0.5.into());
    assert_eq!(study.case().unwrap().actuator.top_wall, [2.0, 1.0, 1.0, 1.0].into());
    for (key, value, words) in [
        ("actuator.gap[4]", "1", "actuator.gap[4] cannot be set: actuator.gap has entries from 1 to 3"),
        ("actuator.gap[0]", "1", "entries from 1 to 3"),
        ("actuator.width[1]", "1", "actuator.width[1] cannot be set: actuator.width is no list"),
        ("actuator.gap[3]", "-1", "actuator.gap[3] = -1 is out of range: must be at least 0 mm"),
        ("actuator.gap[3]", "wide", "actuator.gap[3]: wrong type: string \"wide\", expected a number"),
        (
            "actuator.side_wall",
            "[1, 1, 1]",
            "must be a number, or a list with 4 entries, one for each of 4 chambers: this one has 3",
        ),
        (
            "actuator.gap",
            "[1, 1, 1, 1]",
            "a list with 3 entries, one for each of the gaps between 4 chambers: this one has 4",
        ),
        ("actuator.cavity_length[2]", "8", "actuator.cavity_length[2] = 8 is out of range"),
        ("actuator.top_wall[2]", "1.002", "must be equal to top_wall[4] = 1, or differ from it by 1.00e-2 mm or more"),
    ] {
        let Err(Error::Input(errors)) = set(&[(key, value)]) else { panic!("{key}={value} was taken") };
        assert!(errors.iter().any(|error| error.to_string().contains(words)), "{key}={value}: {errors:?}");
        assert!(
            errors[0].to_string().contains(&format!("--set {key}={value}")) || errors[0].key().is_some(),
            "{errors:?}"
        );
    }
    // In a model file as well.
    let mut study = Study::from_text("finger.toml", &model("")).unwrap();
    study.set("actuator.side_wall[4]", "1.5").unwrap();
    assert_eq!(study.model().unwrap().actuator.as_ref().unwrap().side_wall, [1.0, 1.0, 1.0, 1.5].into());
    assert!(study.set("load.chamber_factor[1]", "0.5").is_err());
}

/// Numbers in one of several tables, by the table's number or name, along an axis, and entries of lists; in the file and in what was set.
#[test]
fn what_stands_in_one_of_several_tables_is_set_by_its_number_or_name() {
    let text = file(
        "[load]\npressure_kpa = [1, 2]\n[[obstacle]]\nname = \"table\"\nshape = \"plane\"\npoint = [0, 0, -3]\nnormal = [0, 0, 1]\n\
         [[obstacle]]\nname = \"ball\"\nshape = \"sphere\"\ncentre = [60, 0, -30]\nradius = 5\n",
    );
    let set = |changes: &[(&str, &str)]| {
        let mut study = Study::from_text("finger.toml", &text).unwrap();
        study.set_all(changes.iter().map(|&(key, value)| Change::new(key, value)))?;
        Ok::<_, Error>(study)
    };
    let changes = [
        ("obstacle[0].point.z", "-4"),
        ("obstacle.ball.radius", "6"),
        ("obstacle[1].centre[1]", "61"),
        ("load.pressure_kpa[2]", "3"),
    ];
    for order in [[0, 1, 2, 3], [3, 1, 2, 0]] {
        let study = set(&order.map(|i| changes[i])).unwrap();
        let case = study.case().unwrap();
        assert_eq!(case.obstacles[0].point, Some([0.0, 0.0, -4.0]));
        assert_eq!((case.obstacles[1].radius, case.obstacles[1].centre), (Some(6.0), Some([61.0, 0.0, -30.0])));
        assert_eq!(case.load.pressure_kpa, [1.0, 3.0]);
    }
    // A key that the table does not have yet.
    let study = set(&[("obstacle.table.stiffness", "2")]).unwrap();
    assert_eq!(study.case().unwrap().obstacles[0].stiffness, Some(2.0));
    for (key, value, words) in [
        ("obstacle[2].radius", "1", "obstacle[2].radius cannot be set: obstacle has entries from 0 to 1"),
        ("obstacle.box.radius", "1", "no entry with the name \"box\": there are table, ball"),
        ("obstacle[0].point.w", "1", "obstacle[0].point has x, y and z"),
        ("obstacle[0].centre.x", "1", "obstacle[0].centre is not given"),
        ("obstacle[1].radius", "-1", "obstacle[1].radius = -1.0 is out of range"),
        ("obstacle[1].radius", "wide", "obstacle[1].radius: wrong type: string \"wide\", expected a number"),
        ("obstacle[1].raduis", "1", "unknown key `obstacle[1].raduis`"),
        ("obstacle[1].centre.z", "nan", "obstacle[1].centre"),
        ("region[0].material.c10", "1", "region[0].material.c10 cannot be set: region is not given"),
    ] {
        let Err(Error::Input(errors)) = set(&[(key, value)]) else { panic!("{key}={value} was taken") };
        let said = errors[0].to_string();
        assert!(said.contains(words) && errors[0].key().is_some(), "{key}={value}: {said}");
    }
}

/// Pressures of single chambers where these have air of their own; refused, with the remedy, where a channel joins them.
#[test]
fn pressures_of_single_chambers_ask_for_air_of_their_own() {
    let load = |factor: &str| file(&format!("[load]\npressure_kpa = [1]\nchamber_factor = {factor}\n"));
    let apart = |factor: &str| load(factor).replace("half_width = 1.0", "half_width = 0.0");
    assert_refused(&load("[1, 1, 1, 1]"), "load.chamber_factor", "set actuator.channel.half_width = 0");
    assert_refused(
        &apart("[1, 1]"),
        "load.chamber_factor",
        "a list with 4 entries, one for each of 4 chambers: this one has 2",
    );
    assert_refused(&apart("[1, nan, 1, 1]"), "load.chamber_factor[2]", "negative for a vacuum");
    assert_refused(&apart("0"), "load.chamber_factor", "must not be 0 for all chambers");
    let mut study = Study::from_text("finger.toml", &file("[load]\npressure_kpa = [1]\n")).unwrap();
    study.set("actuator.channel.half_width", "0").unwrap().set("load.chamber_factor[3]", "-0.5").unwrap();
    assert_eq!(study.case().unwrap().load.chamber_factor, Some([1.0, 1.0, -0.5, 1.0].into()));
    let analysis = study.build().unwrap();
    assert_eq!(
        analysis.problem.cavities.iter().map(|cavity| &cavity.name[..]).collect::<Vec<_>>(),
        ["cavity_1", "cavity_2", "cavity_3", "cavity_4"]
    );
    // What is written out is read again.
    let again = Study::from_text("again.toml", &analysis.resolved().unwrap()).unwrap();
    assert_eq!(again.case().unwrap(), &study.case().unwrap().resolved());
    // As a deck or a mesh has no chambers, its files have no such keys.
    assert_refused(
        &model("").replace(TIMES, "[load]\ntimes = [1.0]\nchamber_factor = [1, 1, 1, 1]\n"),
        "load.chamber_factor",
        "unknown key",
    );
}

/// A mesh of VTK tetrahedra without any groups, as users of SOFA have them, runs with a model file of five lines: its hollow is found.
#[test]
fn a_hollow_mesh_of_vtk_needs_five_lines() {
    let corner = |i: usize| [i % 4, i / 4 % 4, i / 16];
    let number = |[i, j, k]: [usize; 3]| i + 4 * (j + 4 * k);
    let mut cells = String::new();
    let mut count = 0;
    for cell in (0..27).map(|i| [i % 3, i / 3 % 3, i / 9]).filter(|cell| *cell != [1, 1, 1]) {
        let at = |c: usize| number(std::array::from_fn(|d| cell[d] + (c >> d & 1)));
        // Around the diagonal from the first corner to the last; neighbours fit.
        for [a, b] in [[1, 3], [3, 2], [2, 6], [6, 4], [4, 5], [5, 1]] {
            cells += &format!("{} {} {} {}\n", at(0), at(a), at(b), at(7));
            count += 1;
        }
    }
    let points: String = (0..64).map(corner).map(|[x, y, z]| format!("{x} {y} {z}\n")).collect();
    let offsets: String = (1..=count).map(|i| format!("{} ", 4 * i)).collect();
    let types = "10 ".repeat(count);
    let array = |name: &str, kind: &str, text: &str| {
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{}\" format=\"ascii\">{text}</DataArray>\n",
            if name == "Points" { 3 } else { 1 }
        )
    };
    let vtu = format!(
        "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"><UnstructuredGrid>\n<Piece NumberOfPoints=\"64\" \
         NumberOfCells=\"{count}\"><Points>{}</Points><Cells>{}{}{}</Cells></Piece></UnstructuredGrid></VTKFile>\n",
        array("Points", "Float32", &points),
        array("connectivity", "Int64", &cells),
        array("offsets", "Int64", &offsets),
        array("types", "UInt8", &types)
    );
    let model = "model = { file = \"hollow.vtu\" }\nmaterial = { law = \"neo-hooke\", c10 = 0.1 }\nsupport = [{ nodes = { plane = { point = [0, 0, 0], \
                 normal = \"x\" } }, axes = \"xyz\" }]\ncavity = [{ name = \"air\", faces = \"cavity_1\", pressure_kpa = 4 }]\nload = { times = [1.0] }\n";
    let files = [("model.toml", model.to_owned()), ("hollow.vtu", vtu)]
        .map(|(name, text)| (name.to_owned(), text.into_bytes()));
    let analysis = Study::from_files("model.toml", files).unwrap().build().unwrap();
    assert_eq!(analysis.problem.cavities[0].facets.len(), 12);
    let (_, hollow) = &analysis.hollows[0];
    assert!((hollow.volume - 1.0).abs() < 1e-12 && hollow.mouth.is_none());
    assert!((analysis.problem.mesh.volume() - 26.0).abs() < 1e-9);
}

/// A deck with a mesh alone is a body like a mesh of Gmsh; by itself it is refused.
#[test]
fn a_deck_without_materials_and_steps_takes_those_of_a_model_file() {
    let deck = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n8, 0, 1, 1\n\
                *ELEMENT, TYPE=C3D8, ELSET=ALL\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*NSET, NSET=FOOT\n1, 2, 3, 4\n";
    let build = |name: &str, model: &str| {
        let files =
            [("a.toml", model), ("a.inp", deck)].map(|(name, text)| (name.to_owned(), text.as_bytes().to_vec()));
        Study::from_files(name, files).and_then(|study| study.build())
    };
    let model = "[model]\nfile = \"a.inp\"\n[material]\nlaw = \"neo-hooke\"\nc10 = 0.1\n[[support]]\nnodes = \"FOOT\"\naxes = \"xyz\"\n";
    let built = build("a.toml", &format!("{model}{TIMES}")).unwrap();
    assert_eq!(
        (built.problem.material.shear_modulus(), built.requested[..].iter().map(|at| at.0).collect::<Vec<_>>()),
        (0.2, vec![1.0])
    );
    for (name, expected) in [("a.toml", "load.times"), ("a.inp", "the deck has no *STEP")] {
        let refused = build(name, model).map(|_| ()).unwrap_err().to_string();
        assert!(refused.contains(expected), "{refused}");
    }
}
