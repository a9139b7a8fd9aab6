//! Constants from test curves by the real program: what is printed, what is written, what is refused.

use std::fs;
use std::path::Path;

use crate::support::Scratch;
use serde_json::Value;

fn curve(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/curves").join(name).to_str().unwrap().to_owned()
}

fn json(scratch: &Scratch, name: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(scratch.path(name)).unwrap()).unwrap()
}

#[test]
fn a_curve_becomes_a_material_that_a_case_accepts() {
    let scratch = Scratch::new("fit");
    let ended = scratch.run(&["fit", &curve("dragon_skin_30.csv"), "--to", "300%", "--out", "fits"]);
    assert_eq!(ended.code, 0, "{ended:?}");
    for words in [
        "by the standard in line",
        "column 5 'Engineering Stress (MPa)'",
        "points out of the range",
        "95 %:",
        "Mooney-Rivlin",
    ] {
        assert!(ended.out.contains(words), "{words}: {}", ended.out);
    }
    let material = fs::read_to_string(scratch.path("fits/material.toml")).unwrap();
    assert!(ended.out.ends_with(&material), "{}", ended.out);
    let fit = json(&scratch, "fits/fit.json");
    let bands = fit["laws"][0]["bands"][0].as_array().unwrap();
    assert!(
        bands.len() == 5 && bands.iter().all(|band| band["largest_error"].as_f64().unwrap().abs() < 0.1),
        "{bands:?}"
    );
    let c10 = fit["material"]["c10"].as_f64().unwrap();
    // At rest 1000 times the shear modulus would do; at three times the length the volume would change by more than 0.5 %.
    let bulk_over_shear = |fit: &Value| {
        let of = |key: &str| fit["material"][key].as_f64().unwrap();
        of("bulk_modulus") / (2.0 * of("c10"))
    };
    assert!((1100.0..5000.0).contains(&bulk_over_shear(&fit)) && c10 > 0.0, "{}", fit["material"]);
    let short = scratch.run(&["fit", &curve("dragon_skin_30.csv"), "--to", "50%", "--out", "short"]);
    assert_eq!(short.code, 0, "{short:?}");
    assert!((bulk_over_shear(&json(&scratch, "short/fit.json")) - 1000.0).abs() < 1e-9);
    let svg = fs::read_to_string(scratch.path("fits/fit.svg")).unwrap();
    for words in ["Uniaxial", "stretch (1)", "nominal stress (MPa)", "measured, not fitted", "neo-Hookean"] {
        assert!(svg.contains(words), "{words}");
    }
    assert!(fs::read(scratch.path("fits/fit.png")).unwrap().starts_with(b"\x89PNG"));
    // The table takes the place of the template's.
    scratch.run(&["new", "two-chamber", "case.toml"]);
    let case = fs::read_to_string(scratch.path("case.toml")).unwrap();
    let (before, rest) = case.split_once("[material]").unwrap();
    let after = &rest[rest.find("\n[").unwrap()..];
    let check = |material: &str| {
        fs::write(scratch.path("case.toml"), format!("{before}{material}{after}")).unwrap();
        let checked = scratch.run(&["check", "case.toml"]);
        assert_eq!(checked.code, 0, "{checked:?}");
        checked.out
    };
    assert!(check(&material).contains("material  yeoh, isochoric"));
    for (law, words) in [
        ("neo-hooke", "material  neo-hooke, isochoric"),
        ("mooney-rivlin", "material  mooney-rivlin, isochoric"),
        ("ogden", "material  ogden, isochoric"),
    ] {
        let other =
            scratch.run(&["fit", &curve("treloar_1944.csv"), "--unit", "MPa", "--to", "2", "--quiet", "--law", law]);
        assert_eq!(other.code, 0, "{other:?}");
        assert!(check(&other.out).contains(words), "{}", other.out);
    }
}

/// Without a range, what the law cannot follow together with small strains is left out, and said; what is off is warned about.
#[test]
fn the_default_range_serves_actuators_and_misfits_are_warned_about() {
    let scratch = Scratch::new("fit-range");
    let run = |more: &[&str]| scratch.run(&[&["fit", "--out", "fits"], more].concat());
    let default = run(&[&curve("dragon_skin_10_medium.csv")]);
    for words in [
        "points above stretch 4.",
        "with them Yeoh would be off by 28 %",
        "--to all",
        "within 10 % from 10 % strain on",
    ] {
        assert!(default.out.contains(words), "{words}: {}", default.out);
    }
    assert!(!default.out.contains("WARNING"), "{}", default.out);
    let short = json(&scratch, "fits/fit.json")["material"]["c10"].as_f64().unwrap();
    let all = run(&[&curve("dragon_skin_10_medium.csv"), "--to", "all", "--residuals", "absolute"]);
    assert!(all.out.contains("WARNING: more than 10 % off: 126 % too stiff at stretch 1.11"), "{}", all.out);
    let to_break = json(&scratch, "fits/fit.json")["material"]["c10"].as_f64().unwrap();
    assert!(to_break > 2.0 * short, "{to_break} {short}");
    // No law of I1 alone follows three tests of rubber at once, and another one is named.
    let rubber = run(&[&curve("treloar_1944.csv"), "--unit", "MPa"]);
    assert!(rubber.out.contains("hint: Ogden follows these points to 6.94 within 8 % (--law ogden)"), "{}", rubber.out);
    let ogden = run(&[&curve("treloar_1944.csv"), "--unit", "MPa", "--law", "ogden"]);
    assert!(!ogden.out.contains("WARNING") && !ogden.out.contains("hint:"), "{}", ogden.out);
}

#[test]
fn several_tests_with_weights_ranges_and_units() {
    let scratch = Scratch::new("fit-several");
    let arguments = ["fit", &curve("treloar_1944.csv"), "--unit", "MPa", "--out", "fits", "--quiet"];
    let run = |more: &[&str]| {
        let ended = scratch.run(&[&arguments[..], more].concat());
        assert_eq!((ended.code, ended.err.as_str()), (0, ""), "{ended:?}");
        assert!(ended.out.starts_with("# ") && ended.out.contains("[material]"), "{}", ended.out);
        json(&scratch, "fits/fit.json")
    };
    let r_squared = |fit: &Value, test: usize| fit["laws"][0]["tests"][test]["r_squared"].as_f64().unwrap();
    let plain = run(&["--to", "all", "--residuals", "absolute"]);
    assert_eq!(plain["tests"].as_array().unwrap().len(), 3);
    assert!(plain["laws"][0]["total"]["r_squared"].as_f64().unwrap() > 0.99);
    let weighted = run(&["--to", "all", "--residuals", "absolute", "--weight", "equibiaxial=20"]);
    assert!(r_squared(&weighted, 1) > r_squared(&plain, 1) + 0.01);
    let ranged = run(&["--to", "uniaxial=3", "--from", "1.1", "--bulk-modulus", "500", "--law", "neo-hooke"]);
    assert_eq!(ranged["tests"][0]["stretch"][1], 2.42);
    assert_eq!(ranged["tests"][1]["stretch"][0], 1.115);
    assert_eq!((&ranged["material"]["bulk_modulus"], &ranged["material"]["law"]), (&500.0.into(), &"neo-hooke".into()));
    assert_eq!(ranged["material"].get("c20"), None);
    let poisson = run(&["--poisson", "0.495"]);
    let ratio = poisson["material"]["bulk_modulus"].as_f64().unwrap() / poisson["material"]["c10"].as_f64().unwrap();
    assert!((ratio - 2.0 * 2.0 * 1.495 / (3.0 * 0.01)).abs() < 1e-9);
}

#[test]
fn files_have_options_of_their_own_and_stability_is_offered_and_held() {
    let scratch = Scratch::new("fit-own");
    let row = |l: f64| format!("{l};{}\n", 1000.0 * (l - l.powi(-2)) * (0.9 - 0.28 * l));
    let falling: String = (1..40).map(|i| row(1.0 + 0.05 * f64::from(i))).collect();
    fs::write(scratch.path("a.csv"), format!("stretch;nominal stress\n{falling}")).unwrap();
    fs::write(scratch.path("b.csv"), "strain,nominal stress (MPa)\n0.1,0.2\n0.2,0.35\n0.3,0.5\n").unwrap();
    let own = ["--test", "a.csv:ut", "--test", "b.csv:planar", "--unit", "a.csv:kPa"];
    let ended = scratch.run(&[&["fit", "a.csv", "b.csv", "--out", "both"], &own[..]].concat());
    assert_eq!(ended.code, 0, "{ended:?}");
    let fit = json(&scratch, "both/fit.json");
    let modes: Vec<&str> = fit["tests"].as_array().unwrap().iter().map(|t| t["mode"].as_str().unwrap()).collect();
    assert_eq!(modes, ["uniaxial", "planar"]);
    let alone = ["fit", "a.csv", "--test", "ut", "--unit", "kPa", "--keep-break", "--out", "alone"];
    let free = scratch.run(&alone);
    assert!(free.out.contains("UNSTABLE") && free.out.contains("--stable"), "{}", free.out);
    assert!(free.out.contains("NOT STABLE over this range"), "{}", free.out);
    let held = scratch.run(&[&alone[..], &["--stable"]].concat());
    assert!(held.code == 0 && held.out.contains("held stable up to"), "{held:?}");
    assert_eq!(json(&scratch, "alone/fit.json")["laws"][0]["is_stable_in_range"], true);
}

#[test]
fn a_softening_beyond_use_is_said_and_kept() {
    let scratch = Scratch::new("fit-negative");
    fs::write(scratch.path("ut.csv"), "stretch,nominal stress (MPa)\n1.1,-0.1\n1.2,-0.2\n1.3,-0.3\n1.4,-0.4\n")
        .unwrap();
    let ended = scratch.run(&["fit", "ut.csv", "--out", "fits"]);
    assert_eq!(ended.code, 3, "{ended:?}");
    assert!(ended.err.contains("Yeoh: its c10 = -") && ended.err.contains("not greater than 0"), "{}", ended.err);
    assert!(scratch.path("fits/fit.json").exists() && !scratch.path("fits/material.toml").exists());
}

#[test]
fn too_few_points_are_the_reason_that_is_given() {
    let scratch = Scratch::new("fit-few");
    fs::write(scratch.path("ut.csv"), "stretch,nominal stress (MPa)\n1.1,0.1\n1.2,0.18\n").unwrap();
    let ended = scratch.run(&["fit", "ut.csv", "--test", "ut", "--out", "fits"]);
    assert_eq!(ended.code, 3, "{ended:?}");
    assert!(ended.err.contains("Yeoh: its 3 constants are not determined by these points"), "{}", ended.err);
    assert!(ended.err.contains("--law neo-hooke") && !ended.err.contains("greater than 0"), "{}", ended.err);
    let one = scratch.run(&["fit", "ut.csv", "--test", "ut", "--law", "neo-hooke", "--out", "fits"]);
    assert!(one.code == 0 && one.out.contains("law = \"neo-hooke\"\nc10 = "), "{one:?}");
}

#[test]
fn what_cannot_be_used_is_refused_with_one_message() {
    let scratch = Scratch::new("fit-bad");
    fs::write(scratch.path("ut.csv"), "stretch;nominal stress (MPa)\n1.1;0.1\n1.2;x\n").unwrap();
    fs::write(scratch.path("good.csv"), "stretch;nominal stress (MPa)\n1.1;0.1\n1.2;0.2\n1.5;0.3\n1.7;0.4\n").unwrap();
    fs::File::create(scratch.path("huge.csv")).unwrap().set_len(60 << 20).unwrap();
    let before = scratch.listing();
    for (arguments, words) in [
        (&["ut.csv"][..], &["ut.csv:3:1", "column 2 'nominal stress (MPa)'", "`x`", "finite number"][..]),
        (&["good.csv"], &["good.csv", "which test", "--test"]),
        (&["missing.csv"], &["missing.csv", "cannot be read"]),
        (&["huge.csv"], &["huge.csv", "at most 50 MiB"]),
        (&["good.csv", "--test", "bending"], &["--test bending", "uniaxial, equibiaxial or planar"]),
        (&["good.csv", "--test", "other.csv:ut"], &["--test other.csv:ut", "no file of this name"]),
        (&["good.csv", "--test", "ut", "--to", "0"], &["--to 0", "greater than 0"]),
        (&["good.csv", "--test", "ut", "--to", "1.05"], &["no point", "--from"]),
        (&["good.csv", "--test", "ut", "--from", "2", "--to", "1.5"], &["--from 2", "--to 1.5"]),
        (&["good.csv", "--test", "ut", "--weight", "3"], &["--weight 3", "planar=2"]),
        (&["good.csv", "--test", "ut", "--poisson", "0.5"], &["--poisson 0.5", "less than 0.5"]),
        (&["good.csv", "--test", "ut", "--stable=-1"], &["--stable=-1", "greater than 0"]),
        (&["good.csv", "--test", "ut", "--columns", "force=2"], &["--columns", "true-stress"]),
    ] {
        let ended = scratch.run(&[&["fit"], arguments].concat());
        assert_eq!(ended.code, 2, "{arguments:?}: {ended:?}");
        assert_eq!(ended.err.matches("error:").count(), 1, "{}", ended.err);
        for word in words {
            assert!(ended.err.contains(word), "{arguments:?}: `{word}` is not in: {}", ended.err);
        }
        assert_eq!(scratch.listing(), before);
    }
}

#[test]
fn all_sets_of_a_product_are_drawn_together() {
    let scratch = Scratch::new("compare");
    let ended = scratch.run(&["materials", "ecoflex-00-30", "--compare"]);
    assert_eq!(ended.code, 0, "{ended:?}");
    for words in ["ecoflex-00-30:3", "100 %", "out/ecoflex-00-30-materials"] {
        assert!(ended.out.contains(words), "{words}: {}", ended.out);
    }
    let svg = fs::read_to_string(scratch.path("out/ecoflex-00-30-materials/compare.svg")).unwrap();
    assert!(svg.contains("ecoflex-00-30:2") && svg.contains("nominal stress, uniaxial (MPa)"), "{svg}");
    let alone = scratch.run(&["materials", "--compare"]);
    assert_eq!(alone.code, 2, "{alone:?}");
}

#[test]
fn known_materials_are_listed_and_printed() {
    let scratch = Scratch::new("materials");
    let list = scratch.run(&["materials"]);
    assert!(list.code == 0 && list.out.contains("ecoflex-00-30:2") && list.out.contains("factor of two"), "{list:?}");
    let one = scratch.run(&["materials", "Dragon Skin 30"]);
    assert_eq!(one.code, 0, "{one:?}");
    for words in [
        "c10 = 0.0916973",
        "law = \"yeoh\"",
        "# source:",
        "pneuflex fit fixtures/curves/dragon_skin_30.csv\n",
        "other sets",
    ] {
        assert!(one.out.contains(words), "{words}: {}", one.out);
    }
    let bad = scratch.run(&["materials", "ecoflex"]);
    assert!(bad.code == 2 && bad.err.contains("did you mean ecoflex-00-10"), "{bad:?}");
}
