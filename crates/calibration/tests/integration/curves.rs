//! Every layout of a test file that users have, and what is refused.

use pneuflex_calibration::curve::{
    ColumnChoice, CurveError, ReadOptions, Reading, StressMeasure, StressUnit, decode, read,
};
use pneuflex_calibration::law::Mode;

fn parse(file: &str, text: &str, edit: impl Fn(&mut ReadOptions)) -> Result<Reading, CurveError> {
    let mut options = ReadOptions::default();
    edit(&mut options);
    read(file, text, &options)
}

/// Stretch and stress of the points of a test.
fn points(reading: &Reading, mode: Mode) -> Vec<[f64; 2]> {
    let curve = reading.curves.iter().find(|c| c.mode == mode).unwrap();
    curve.points.iter().map(|p| [p.stretch, p.stress]).collect()
}

#[track_caller]
fn same(found: &[[f64; 2]], expected: &[[f64; 2]]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
        assert!((a - b).abs() < 1e-12, "{found:?} {expected:?}");
    }
}

#[track_caller]
fn refused(file: &str, text: &str, edit: impl Fn(&mut ReadOptions), line: Option<usize>, words: &[&str]) {
    let error = parse(file, text, edit).unwrap_err();
    assert_eq!(error.line, line, "{error:?}");
    for word in words {
        assert!(
            format!("{} {}", error.message, error.help.clone().unwrap_or_default()).contains(word),
            "{word}: {error:?}"
        );
    }
}

#[test]
fn a_long_table_with_several_tests_and_units() {
    let text = "# a comment\nmode,stretch,nominal_stress_kgf_cm2,nominal_stress_MPa\nuniaxial,1.5,1,0.0980665\nequibiaxial,1.2,2,0.196133\n";
    let reading = parse("a.csv", text, |_| ()).unwrap();
    same(&points(&reading, Mode::Uniaxial), &[[1.5, 0.0980665]]);
    same(&points(&reading, Mode::Equibiaxial), &[[1.2, 0.196133]]);
    assert!(reading.understood.iter().any(|l| l.contains("column 4 'nominal_stress_MPa'")), "{:?}", reading.understood);
    assert!(reading.understood.iter().any(|l| l.contains("not used: column 3")), "{:?}", reading.understood);
    let kgf =
        parse("a.csv", text, |o| o.columns = ColumnChoice::parse("stretch=2,stress=nominal_stress_kgf_cm2").unwrap());
    same(&points(&kgf.unwrap(), Mode::Equibiaxial), &[[1.2, 0.196133]]);
}

#[test]
fn wide_tables_with_a_column_of_strain_per_test_or_for_all() {
    let pairs = "uniaxial strain,uniaxial eng. stress (kPa),pure shear strain (%),pure shear eng. stress (kPa)\n0.5,100,20,50\n1,200,,\n";
    let reading = parse("a.csv", pairs, |_| ()).unwrap();
    same(&points(&reading, Mode::Uniaxial), &[[1.5, 0.1], [2.0, 0.2]]);
    same(&points(&reading, Mode::Planar), &[[1.2, 0.05]]);
    let common = "Nominal stress\nstretch\tuniaxial (MPa)\tequibiaxial (MPa)\tplanar (MPa)\n1.5\t0.1\t0.2\t0.15\n2\t0.2\t\t0.3\n";
    let reading = parse("a.csv", common, |_| ()).unwrap();
    same(&points(&reading, Mode::Uniaxial), &[[1.5, 0.1], [2.0, 0.2]]);
    same(&points(&reading, Mode::Equibiaxial), &[[1.5, 0.2]]);
    same(&points(&reading, Mode::Planar), &[[1.5, 0.15], [2.0, 0.3]]);
}

#[test]
fn principal_stretches_are_checked_against_the_test() {
    let head = "test,F11,F22,F33,S11,S22,S33\n";
    let good = format!("{head}ET,1.2,1.2,0.694444,0.5,0.5,0\nPS,1.25,1,0.8,0.4,0,0\nUT,0.64,1.25,1.25,-0.6,0,0\n");
    let reading = parse("a.csv", &good, |o| o.unit = Some(StressUnit::Megapascal)).unwrap();
    assert_eq!(reading.curves.len(), 3);
    same(&points(&reading, Mode::Uniaxial), &[[0.64, -0.6]]);
    let bad = format!("{head}ET,1.2,1.0,0.8333,0.5,0.1,0\n");
    refused("a.csv", &bad, |o| o.unit = Some(StressUnit::Megapascal), Some(2), &["column 3 'F22'", "equibiaxial"]);
    refused("a.csv", &good, |_| (), Some(1), &["column 5 'S11'", "--unit"]);
}

#[test]
fn machine_files_have_lines_above_the_table_and_true_measures_beside_engineering_ones() {
    let text = "PARAMETER;INFO;;;\nStandard;ASTM D412;;;\nSpecimen Width (mm);6;;;\n;;;;\n\
                Time (s);True Strain;True Stress (MPa);Engineering Strain;Engineering Stress (MPa)\n\
                1;0.69314718055994530942;0.6;1;0.3\n";
    let reading = parse("machine.csv", text, |_| ()).unwrap();
    same(&points(&reading, Mode::Uniaxial), &[[2.0, 0.3]]);
    let columns = "true-strain=2,true-stress=3";
    let by_true = parse("machine.csv", text, |o| o.columns = ColumnChoice::parse(columns).unwrap()).unwrap();
    same(&points(&by_true, Mode::Uniaxial), &[[2.0, 0.3]]);
}

#[test]
fn units_below_the_header_decimal_commas_and_old_encodings() {
    let bytes = b"Dehnung;Standardkraft;Nennspannung\n%;N;N/mm\xb2\n50,5;1,2;0,25\n";
    let reading = parse("zug_uniaxial.csv", &decode(bytes).unwrap(), |_| ()).unwrap();
    same(&points(&reading, Mode::Uniaxial), &[[1.505, 0.25]]);
    let utf16: Vec<u8> =
        "\u{feff}strain,engineering stress (psi)\n0.5,100\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let reading = parse("ut.csv", &decode(&utf16).unwrap(), |_| ()).unwrap();
    assert!((points(&reading, Mode::Uniaxial)[0][1] - 0.689_475_729_316_8).abs() < 1e-9);
    assert!(decode(b"PK\x03\x04\0\0").is_err());
}

#[test]
fn force_and_change_of_length_need_the_specimen() {
    let text = "\n\nTime (sec), Load (N), Stress (KPa), Strain (mm), Position (mm), Cycle\n0.0, 0.0, N/A, , 0.0, 1\n0.1, 1.2, N/A, , 15.0, 1\n";
    refused("ut.csv", text, |_| (), Some(3), &["--area", "2 'Load (N)'", "5 'Position (mm)'"]);
    let reading = parse("ut.csv", text, |o| o.specimen = Some([12.0, 30.0])).unwrap();
    same(&points(&reading, Mode::Uniaxial), &[[1.0, 0.0], [1.5, 0.1]]);
    assert!(reading.understood[1].contains("gives nominal stress"), "{:?}", reading.understood);
    // Of several columns the one that is meant is named; what would have no effect is refused.
    let two = text.replace("Cycle", "Force (kN)").replace(", 1\n", ", 0.001\n");
    let of = |columns: &str, unit: Option<StressUnit>| {
        parse("ut.csv", &two, |o| {
            (o.specimen, o.unit) = (Some([12.0, 30.0]), unit);
            o.columns = ColumnChoice::parse(columns).unwrap();
        })
    };
    assert!(
        parse("ut.csv", &two, |o| o.specimen = Some([12.0, 30.0])).unwrap_err().message.contains("several columns")
    );
    same(&points(&of("stress=2", None).unwrap(), Mode::Uniaxial), &[[1.0, 0.0], [1.5, 0.1]]);
    assert!(of("stress=1", None).unwrap_err().message.contains("1 'Time (sec)' is no force"));
    assert!(of("stress=2", Some(StressUnit::Kilopascal)).unwrap_err().help.unwrap().contains("leave out --unit"));
    assert!(of("true-stress=2", None).is_err());
}

#[test]
fn compression_with_positive_signs_is_recognised() {
    let table = "strain (%),nominal stress (kPa)\n0,0\n10,20\n40,90\n";
    let reading = parse("compression_3.csv", table, |_| ()).unwrap();
    same(&points(&reading, Mode::Uniaxial), &[[1.0, 0.0], [0.9, -0.02], [0.6, -0.09]]);
    assert!(reading.understood[0].contains("compression with positive signs"), "{:?}", reading.understood);
    let signed = parse("compression.csv", "strain (%),nominal stress (kPa)\n0,0\n-10,-20\n", |_| ()).unwrap();
    same(&points(&signed, Mode::Uniaxial), &[[1.0, 0.0], [0.9, -0.02]]);
    let both = parse("tension_and_compression.csv", "strain (%),nominal stress (kPa)\n0,0\n10,20\n", |_| ()).unwrap();
    same(&points(&both, Mode::Uniaxial), &[[1.0, 0.0], [1.1, 0.02]]);
    refused("compression.csv", "stretch,true stress (kPa)\n1.1,20\n", |_| (), None, &["positive signs"]);
}

#[test]
fn only_clear_words_name_a_test_and_blanks_separate_columns() {
    let table = "stretch nominal_stress_MPa\n1.5   0.1\n2.0   0.2\n";
    let mode = |file: &str, text: &str| parse(file, text, |_| ()).map(|reading| reading.curves[0].mode);
    assert_eq!(mode("ut.csv", table), Ok(Mode::Uniaxial));
    assert_eq!(mode("ET.csv", table), Ok(Mode::Equibiaxial));
    assert_eq!(mode("sample_equibiaxial_3.csv", table), Ok(Mode::Equibiaxial));
    assert_eq!(mode("a.csv", &format!("Test type: PS\n{table}")), Ok(Mode::Planar));
    // Initials of people and samples are no tests.
    for (file, head) in [("sample_ET_3.csv", ""), ("a.csv", "Operator: EB\n"), ("a.csv", "Sample PS 12\n")] {
        assert!(mode(file, &format!("{head}{table}")).unwrap_err().message.contains("which test"), "{file} {head}");
    }
    let reading = parse("ut.csv", table, |_| ()).unwrap();
    same(&points(&reading, Mode::Uniaxial), &[[1.5, 0.1], [2.0, 0.2]]);
    // What was decided about the test stands first.
    assert!(reading.understood[0].starts_with("uniaxial (by the file's name)"), "{:?}", reading.understood);
}

#[test]
fn tables_without_names_need_them() {
    let text = "1.5 ; 0.1\n2.0 ; 0.2\n";
    refused("ut.csv", text, |_| (), Some(0), &["no column of stress", "--columns"]);
    let reading = parse("ut.csv", text, |o| {
        o.columns = ColumnChoice::parse("stretch=1,nominal-stress=2").unwrap();
        o.unit = Some(StressUnit::Megapascal);
    });
    same(&points(&reading.unwrap(), Mode::Uniaxial), &[[1.5, 0.1], [2.0, 0.2]]);
}

#[test]
fn what_is_not_understood_is_refused_with_its_place() {
    let head = "stretch;stress (MPa)\n";
    let ut = |body: &str| format!("{head}{body}");
    refused("a.csv", &ut("1.5;0.1\n"), |_| (), None, &["which test", "--test"]);
    refused("ut.csv", &ut("1.5;0.1\n1.6;abc\n"), |_| (), Some(3), &["column 2 'stress (MPa)'", "`abc`"]);
    refused("ut.csv", &ut("1.5;0.1\n1.6;\n"), |_| (), Some(3), &["is empty"]);
    refused("ut.csv", &ut("1.5;0.1\n1.6;NaN\n"), |_| (), Some(3), &["finite number"]);
    refused("ut.csv", &ut("1.5;0.1\n-0.5;0.1\n"), |_| (), Some(3), &["column 1 'stretch'", "greater than 0"]);
    refused("ut.csv", &ut("1,5;0.1\n"), |_| (), Some(2), &["decimal commas", "--decimal"]);
    refused("ut.csv", &ut("1,500;1,000\n"), |_| (), Some(2), &["thousands", "--decimal"]);
    refused("ut.csv", "strain;stress (MPa)\n150;0.1\n", |_| (), Some(2), &["150", "--strain percent"]);
    refused("ut.csv", "strain,stress (MPa)\n1,5,0,1\n", |_| (), Some(2), &["4 cells", "decimal commas"]);
    refused(
        "ut.csv",
        "strain,strain,stress (MPa)\n1,2,3\n",
        |_| (),
        Some(1),
        &["several columns", "1 'strain', 2 'strain'"],
    );
    refused("ut.csv", "strain,force (N)\n1,2\n", |_| (), Some(1), &["no column of stress"]);
    refused(
        "ut.csv",
        "strain,stress (MPa)\n0,0\n10,0.1\n25,0.2\n",
        |_| (),
        Some(4),
        &["25 %", "2500 %", "--strain percent"],
    );
    refused("ut.csv", "elongation (mm),stress (MPa)\n1,2\n", |_| (), Some(1), &["no column of stretch or strain"]);
    refused("a.csv", "test,stretch,stress (MPa)\nut,1,0\nshear,1.5,2\n", |_| (), Some(3), &["`shear`", "uniaxial"]);
    refused(
        "ut.csv",
        "stress (MPa),strain\n1,2\n",
        |o| o.unit = Some(StressUnit::Kilopascal),
        Some(1),
        &["MPa", "kPa"],
    );
    refused("ut.csv", "", |_| (), None, &["two numbers"]);
    refused(
        "ut.csv",
        &ut("1.5;0.1\n"),
        |o| o.columns = ColumnChoice::parse("stress=7").unwrap(),
        Some(1),
        &["no column 7"],
    );
    assert!(
        ColumnChoice::parse("strain").is_err() && ColumnChoice::parse("force=3").unwrap_err().contains("true-strain")
    );
    refused("ut.csv", &ut(&format!("1.5;0.1\n1.6;0.2{}\n", " ".repeat(20_000))), |_| (), Some(3), &["characters"]);
}

#[test]
fn nominal_or_true_stress_is_asked_where_nothing_says_it() {
    let table = "stretch,stress (MPa)\n1,0\n1.5,0.3\n2.5,1\n";
    let both = ["column 2 'stress (MPa)'", "stretch of 2.5000", "2.50 times", "--stress nominal", "--stress true"];
    refused("ut.csv", table, |_| (), Some(1), &both);
    // Whoever knows says so, and a line above the table does.
    for (stress, expected) in [(StressMeasure::Nominal, 1.0), (StressMeasure::True, 0.4)] {
        let said = parse("ut.csv", table, |o| o.stress = Some(stress)).unwrap();
        same(&points(&said, Mode::Uniaxial)[2..], &[[2.5, expected]]);
        let above = format!("Tensile test; stress type: {}\n{table}", stress.name());
        let said = parse("ut.csv", &above, |_| ()).unwrap();
        same(&points(&said, Mode::Uniaxial)[2..], &[[2.5, expected]]);
        assert!(said.understood.iter().any(|line| line.contains("by line 1")), "{:?}", said.understood);
    }
    let vague = format!("true strain, engineering and true stress\n{table}");
    refused("ut.csv", &vague, |_| (), Some(2), &["nothing says which"]);
    // The area that a force beside it is divided by stays, or shrinks with the stretch.
    let with_force = |stresses: [f64; 3]| {
        let [a, b, c] = stresses;
        format!("load (N),strain (%),stress (MPa)\n0,0,0\n3.6,50,{a}\n7.1,100,{b}\n12,150,{c}\n")
    };
    let nominal = parse("ut.csv", &with_force([0.3, 0.59, 1.0]), |_| ()).unwrap();
    same(&points(&nominal, Mode::Uniaxial)[3..], &[[2.5, 1.0]]);
    assert!(nominal.understood.iter().any(|line| line.contains("by column 1 'load (N)'")), "{:?}", nominal.understood);
    let cauchy = parse("ut.csv", &with_force([0.45, 1.18, 2.5]), |_| ()).unwrap();
    same(&points(&cauchy, Mode::Uniaxial)[3..], &[[2.5, 1.0]]);
    refused("ut.csv", &with_force([0.4, 0.7, 2.0]), |_| (), Some(1), &["nothing says which"]);
    // Up to a tenth it makes no difference that matters, and is only mentioned.
    let small = parse("ut.csv", "stretch,stress (MPa)\n1,0\n1.1,0.1\n", |_| ()).unwrap();
    assert!(small.understood.iter().any(|line| line.contains("supposed; --stress true otherwise")));
}
