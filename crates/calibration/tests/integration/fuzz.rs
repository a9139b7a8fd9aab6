//! Nothing that a file may hold makes the reader panic or keep more than the file has.

use pneuflex_calibration::clean::{Cleaning, clean};
use pneuflex_calibration::curve::{ReadOptions, StressUnit, decode, read};
use pneuflex_calibration::fit::{FitOptions, Test, fit, largest_i1_minus_3};
use pneuflex_calibration::law::{Law, Mode};
use proptest::prelude::*;

const VALID: [&str; 4] = [
    "test,F11,F22,F33,S11\nET,1.2,1.2,0.694444,0.5\nPS,1.25,1,0.8,0.4\nUT,0.64,1.25,1.25,-0.6\nUT,1.5,0.81,0.82,0.7\n",
    "PARAMETER;INFO;\nStandard;ASTM D412;\n;;\nTime (s);Engineering Strain;Engineering Stress (MPa)\n0,1;0,1;0,05\n0,2;0,2;0,09\n",
    "Nominal stress\nstretch\tuniaxial (kPa)\tplanar (kPa)\n1.1\t50\t60\n1.2\t\t100\n1.4\t130\t\n",
    "\"strain\",\"nominal stress\"\n\"%\",\"psi\"\n\"10\",\"5\"\n\"20\",\"8\"\n",
];

/// Reads, prepares and fits as the program does; whatever comes out is finite.
fn process(bytes: &[u8]) {
    let Ok(text) = decode(bytes) else { return };
    for options in [
        ReadOptions::default(),
        ReadOptions { test: Some(Mode::Uniaxial), unit: Some(StressUnit::Kilopascal), ..ReadOptions::default() },
    ] {
        let reading = match read("a.csv", &text, &options) {
            Ok(reading) => reading,
            Err(error) => {
                assert!(!error.message.is_empty() && error.message.len() < 2000, "{error:?}");
                continue;
            }
        };
        let count: usize = reading.curves.iter().map(|c| c.points.len()).sum();
        assert!(count > 0 && count <= bytes.len(), "more points than the file has characters");
        let mut tests = Vec::new();
        for curve in &reading.curves {
            assert!(curve.points.iter().all(|p| p.stretch > 0.0 && p.stretch.is_finite() && p.stress.is_finite()));
            let points = clean(curve, &Cleaning::default()).used;
            if !points.is_empty() {
                tests.push(Test { name: "a".into(), mode: curve.mode, points, weight: 1.0 });
            }
        }
        let options =
            FitOptions { stable_up_to: Some(largest_i1_minus_3(&tests).clamp(1e-3, 1e4)), ..FitOptions::default() };
        for law in [Law::Yeoh, Law::NeoHookean, Law::MooneyRivlin] {
            if let Ok(found) = fit(law, &tests, &options) {
                assert!(found.values().iter().all(|c| c.is_finite()) && found.total.rms_mpa.is_finite());
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        process(&bytes);
    }

    #[test]
    fn any_table_of_odd_cells(
        cells in proptest::collection::vec(
            prop_oneof![
                Just("strain"), Just("stress (MPa)"), Just("test"), Just("ut"), Just("1e308"), Just("-1e-308"), Just("nan"), Just("0,5"),
                Just("1.5"), Just("1"), Just(""), Just("\""), Just("\n"), Just("\r"), Just("#"), Just("stretch"), Just("ps"), Just("é²")
            ],
            0..60,
        ),
        separator in prop_oneof![Just(","), Just(";"), Just("\t")],
    ) {
        process(cells.join(separator).as_bytes());
    }

    #[test]
    fn valid_files_with_bytes_changed(
        which in 0..VALID.len(),
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..3), 1..8),
    ) {
        let mut bytes = VALID[which].as_bytes().to_vec();
        for (at, byte, kind) in changes {
            let at = at.index(bytes.len());
            match kind {
                0 => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                _ if bytes.len() > 1 => { bytes.remove(at); }
                _ => {}
            }
        }
        process(&bytes);
    }
}

#[test]
fn the_valid_files_are_valid() {
    for text in VALID {
        let options = ReadOptions { test: Some(Mode::Uniaxial), ..ReadOptions::default() };
        let reading = read("a.csv", text, &options)
            .or_else(|_| read("a.csv", text, &ReadOptions { unit: Some(StressUnit::Megapascal), ..options }));
        assert!(reading.is_ok(), "{reading:?} {text}");
    }
}
