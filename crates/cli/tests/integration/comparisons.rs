//! `pneuflex compare`: measurements that are the run's own with noise give back the noise.

use std::fmt::Write;
use std::fs;

use serde_json::Value;

use crate::support::Scratch;

fn json(scratch: &Scratch, name: &str) -> Value {
    serde_json::from_str(&fs::read_to_string(scratch.path(name)).unwrap()).unwrap()
}

/// Numbers between −1 and 1 that look drawn by lot (a linear congruential generator).
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
}

#[test]
fn points_and_angles_of_the_run_with_noise_give_back_the_noise() {
    let scratch = Scratch::new("compare");
    assert_eq!(scratch.run(&["new", "two-chamber", "case.toml"]).code, 0);
    let coarse = ["--set", "mesh.size=4.5", "--set", "mesh.element=hex8-q1p0", "--set", "load.pressure_kpa=[10, 20]"];
    assert_eq!(scratch.run(&[&["run", "case.toml", "--out", "run", "--quiet"], &coarse[..]].concat()).code, 0);
    let summary = json(&scratch, "run/summary.json");
    let mut noise = Noise(20);
    let (mut drawn, mut points, mut angles) = (Vec::new(), String::from("pressure_kpa,x_mm,z_mm\n"), Vec::new());
    let mut elsewhere = points.clone();
    let mut both = String::from("pressure_kpa,end_face_angle_deg\n");
    for step in summary["steps"].as_array().unwrap() {
        let at = step["pressure_kpa"].as_f64().unwrap();
        let line: Vec<[f64; 2]> = serde_json::from_value(step["centreline"].clone()).unwrap();
        for two in line.windows(2) {
            let [dx, dz] = [0, 1].map(|d| two[1][d] - two[0][d]);
            let length = dx.hypot(dz);
            for share in [0.3, 0.45, 0.7] {
                let off = 0.02 * noise.next();
                drawn.push(off);
                let [x, z] = [two[0][0] + share * dx - off * dz / length, two[0][1] + share * dz + off * dx / length];
                writeln!(points, "{at},{x},{z}").unwrap();
                // A camera that sees it turned and larger.
                let (sin, cos) = 0.1_f64.sin_cos();
                let (u, v) = (1.25 * (cos * x - sin * z), 1.25 * (sin * x + cos * z));
                writeln!(elsewhere, "{at},{u},{v}").unwrap();
            }
        }
        let off = 0.3 * noise.next();
        angles.push(off);
        writeln!(both, "{at},{}", step["end_face_angle_deg"].as_f64().unwrap() + off).unwrap();
    }
    fs::write(scratch.path("points.csv"), points).unwrap();
    let ended = scratch.run(&["compare", "run", "points.csv", "--out", "points.png"]);
    assert_eq!(ended.code, 0, "{ended:?}");
    assert!(ended.out.contains("nearest point of the bottom line") && ended.err.contains("report: "), "{ended:?}");
    let found = json(&scratch, "run/comparison.json");
    let kind = &found["kinds"][0];
    let number = |value: &Value| value.as_f64().unwrap();
    assert_eq!((&kind["of"], &kind["count"]), (&"points".into(), &drawn.len().into()));
    assert!((number(&kind["rms"]) / rms(&drawn) - 1.0).abs() < 1e-3, "{kind} {}", rms(&drawn));
    let largest = drawn.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    assert!((number(&kind["largest"]) / largest - 1.0).abs() < 1e-2, "{kind} {largest}");
    assert_eq!(&fs::read(scratch.path("points.png")).unwrap()[1..4], b"PNG");
    let page = fs::read_to_string(scratch.path("run/report.html")).unwrap();
    assert!(page.contains("Compared with <code>points.csv</code>") && page.contains("data:image/svg+xml;base64,"));
    // The page is a function of the folder.
    fs::remove_file(scratch.path("run/report.html")).unwrap();
    assert_eq!(scratch.run(&["view", "run"]).code, 0);
    assert!(fs::read_to_string(scratch.path("run/report.html")).unwrap() == page);

    // What is fitted is said, and leaves no more than the noise; without a fit it is far off.
    fs::write(scratch.path("elsewhere.csv"), elsewhere).unwrap();
    assert_eq!(scratch.run(&["compare", "run", "elsewhere.csv"]).code, 0);
    assert!(number(&json(&scratch, "run/comparison.json")["kinds"][0]["rms"]) > 0.5);
    let ended = scratch.run(&["compare", "run", "elsewhere.csv", "--fit", "rotation,scale"]);
    assert!(ended.code == 0 && ended.out.contains("fitted to the run first"), "{ended:?}");
    let found = json(&scratch, "run/comparison.json");
    assert!(number(&found["kinds"][0]["rms"]) <= 1.001 * rms(&drawn), "{found}");

    // Numbers by the names of the table; between the states the run is interpolated, and says so.
    let [a, b] = [0, 1].map(|i| number(&summary["steps"][i]["end_face_angle_deg"]));
    writeln!(both, "15,{}", 0.5 * (a + b) + 0.25).unwrap();
    angles.push(0.25);
    fs::write(scratch.path("angles.csv"), both).unwrap();
    let ended = scratch.run(&["compare", "run", "angles.csv"]);
    assert!(ended.code == 0 && ended.out.contains("interpolated at 15 kPa"), "{ended:?}");
    let kind = &json(&scratch, "run/comparison.json")["kinds"][0];
    assert!((number(&kind["rms"]) / rms(&angles) - 1.0).abs() < 1e-9, "{kind}");
    let mean = angles.iter().sum::<f64>() / 3.0;
    assert!((number(&kind["mean"]) - mean).abs() < 1e-9 && kind["unit"] == "°", "{kind}");

    let refused = |text: &str, more: &[&str]| {
        fs::write(scratch.path("bad.csv"), text).unwrap();
        let ended = scratch.run(&[&["compare", "run", "bad.csv"], more].concat());
        assert_eq!((ended.code, ended.out.as_str()), (2, ""), "{ended:?}");
        ended.err
    };
    assert!(
        refused("pressure_kpa,x_mm,z_mm\n30,1,1\n", &[]).contains("measured at 30 kPa, where the run has no results")
    );
    assert!(refused("pressure_kpa,angle\n10,1\n", &[]).contains("the run has no column angle"));
    assert!(refused("time,x_mm,z_mm\n10,1,1\n", &[]).contains("there is no column pressure_kpa"));
    assert!(
        refused("pressure_kpa,chord_angle_deg\n10,1\n", &["--fit", "scale"])
            .contains("--fit and --line are for points")
    );
    assert!(
        refused("pressure_kpa,x_mm,z_mm\n10,1,1\n", &["--fit", "scale,offset"])
            .contains("do not tell what is to be fitted")
    );
    // A new run removes what belongs to the old one.
    assert_eq!(scratch.run(&[&["run", "case.toml", "--out", "run", "--quiet"], &coarse[..]].concat()).code, 0);
    assert!(!scratch.path("run/comparison.json").exists() && !scratch.path("run/comparison.svg").exists());
}

/// A body of a mesh has no bottom line: its outline is compared, and a run that stopped with the states that it has.
#[test]
fn the_outline_of_a_mesh_is_compared_by_time() {
    let scratch = Scratch::new("compare-mesh");
    let bar = "*NODE, NSET=ALL\n1,0,0,0\n2,4,0,0\n3,4,1,0\n4,0,1,0\n5,0,0,2\n6,4,0,2\n7,4,1,2\n8,0,1,2\n\
               *NSET, NSET=END\n1,4,5,8\n*ELEMENT, TYPE=C3D8, ELSET=BODY\n1,1,2,3,4,5,6,7,8\n\
               *MATERIAL, NAME=M\n*HYPERELASTIC, NEO HOOKE\n0.1,0.02\n*SOLID SECTION, ELSET=BODY, MATERIAL=M\n\
               *STEP, NLGEOM\n*STATIC\n*BOUNDARY\nEND,1,3\n*CLOAD\n7,1,1e-12\n*END STEP\n";
    fs::write(scratch.path("bar.inp"), bar).unwrap();
    assert_eq!(scratch.run(&["run", "bar.inp", "--out", "bar", "--quiet", "--no-report"]).code, 0);
    // Off each side by a known length, the last one beyond a corner.
    fs::write(scratch.path("m.csv"), "time,x_mm,z_mm\n1,1,2.5\n1,2,-0.1\n1,4.2,1\n1,4.3,2.4\n1,2,1.2\n").unwrap();
    let ended = scratch.run(&["compare", "bar", "m.csv"]);
    assert!(ended.code == 0 && ended.out.contains("nearest point of the outline"), "{ended:?}");
    let kind = &json(&scratch, "bar/comparison.json")["kinds"][0];
    let expected = rms(&[0.5, 0.1, 0.2, 0.5, 0.8]);
    assert!((kind["rms"].as_f64().unwrap() - expected).abs() < 1e-6, "{kind} {expected}");
    assert!((kind["largest"].as_f64().unwrap() - 0.8).abs() < 1e-6 && kind["largest_at"] == 1.0);
    assert!(!scratch.path("bar/report.html").exists());
    let ended = scratch.run(&["compare", "bar", "m.csv", "--line", "bottom"]);
    assert!(ended.code == 2 && ended.err.contains("this body has no bottom line"), "{ended:?}");
}
