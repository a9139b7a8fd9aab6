//! Files of one rubber, 2 C10 = 0.2 MPa, as people write and miswrite them: the constant that comes out is right, or the file is refused
//! for the true reason.

use pneuflex_calibration::clean::{Cleaning, clean};
use pneuflex_calibration::curve::{
    ColumnChoice, DecimalSign, ReadOptions, StrainMeasure, StressMeasure, StressUnit, decode, read,
};
use pneuflex_calibration::fit::{FitOptions, Test, fit};
use pneuflex_calibration::law::{Law, Mode};

const C10: f64 = 0.1;

/// What becomes of a file: the constant, or words that the refusal must have.
enum Right {
    C10,
    Refused(&'static [&'static str]),
}
use Right::{C10 as Read, Refused};

/// Stretch, nominal stress (MPa) of a test.
fn curve(mode: Mode, stretches: impl IntoIterator<Item = f64>) -> Vec<[f64; 2]> {
    stretches.into_iter().map(|stretch| [stretch, Law::NeoHookean.stress(&[C10], mode, stretch)]).collect()
}

/// Uniaxial, from rest to a stretch of 2.
fn pulled() -> Vec<[f64; 2]> {
    curve(Mode::Uniaxial, (0..=20).map(|i| 1.0 + 0.05 * f64::from(i)))
}

fn pressed() -> Vec<[f64; 2]> {
    curve(Mode::Uniaxial, (0..=10).map(|i| 1.0 - 0.05 * f64::from(i)))
}

/// A table of what `row` makes of the points.
fn table(header: &str, points: &[[f64; 2]], row: impl Fn(f64, f64) -> String) -> String {
    let rows: Vec<String> = points.iter().map(|[stretch, stress]| row(*stretch, *stress)).collect();
    format!("{header}\n{}\n", rows.join("\n"))
}

/// The table that most have: engineering strain and stress, commas between cells.
fn plain(header: &str, points: &[[f64; 2]]) -> String {
    table(header, points, |stretch, stress| format!("{:.9},{stress:.9}", stretch - 1.0))
}

const NOMINAL: &str = "strain,nominal stress (MPa)";

/// The constant that the program would fit by default.
fn fitted(file: &str, bytes: &[u8], options: &ReadOptions) -> Result<f64, String> {
    let words = |error: pneuflex_calibration::curve::CurveError| {
        format!("{} {}", error.message, error.help.unwrap_or_default())
    };
    let text = decode(bytes).map_err(words)?;
    let reading = read(file, &text, options).map_err(words)?;
    let tests: Vec<Test> = reading
        .curves
        .iter()
        .map(|curve| Test {
            name: curve.mode.name().into(),
            mode: curve.mode,
            points: clean(curve, &Cleaning::default()).used,
            weight: 1.0,
        })
        .collect();
    let fit = fit(Law::NeoHookean, &tests, &FitOptions::default()).map_err(|error| error.to_string())?;
    Ok(fit.constants[0].value)
}

#[derive(Default)]
struct Traps {
    count: usize,
    wrong: Vec<String>,
}

impl Traps {
    fn bytes(&mut self, what: &str, file: &str, bytes: &[u8], edit: impl Fn(&mut ReadOptions), right: Right) {
        let mut options = ReadOptions::default();
        edit(&mut options);
        self.count += 1;
        let found = fitted(file, bytes, &options);
        let is_right = match (&found, right) {
            (Ok(c10), Read) => (c10 / C10 - 1.0).abs() < 1e-3,
            (Err(message), Refused(words)) => words.iter().all(|word| message.contains(word)),
            _ => false,
        };
        if !is_right {
            self.wrong.push(format!("{what}: {found:?}"));
        }
    }

    fn with(&mut self, what: &str, file: &str, text: &str, edit: impl Fn(&mut ReadOptions), right: Right) {
        self.bytes(what, file, text.as_bytes(), edit, right);
    }

    fn of(&mut self, what: &str, text: &str, right: Right) {
        self.with(what, "ut.csv", text, |_| (), right);
    }

    fn named(&mut self, file: &str, right: Right) {
        self.with(file, file, &plain(NOMINAL, &pulled()), |_| (), right);
    }

    #[track_caller]
    fn none_is_wrong(self, at_least: usize) {
        assert!(self.count >= at_least, "{}", self.count);
        assert!(self.wrong.is_empty(), "{} of {}:\n{}", self.wrong.len(), self.count, self.wrong.join("\n"));
    }
}

#[test]
fn measures_and_units() {
    let mut traps = Traps::default();
    let points = pulled();
    let strain = |header: &str, value: fn(f64) -> f64| {
        table(&format!("{header},nominal stress (MPa)"), &points, |l, p| format!("{:.9},{p:.9}", value(l)))
    };
    for header in ["stretch", "λ", "Extension ratio", "F11"] {
        traps.of(header, &strain(header, |l| l), Read);
    }
    for header in ["strain", "Tensile strain (mm/mm)", "Engineering strain [-]", "ε", "Dehnung"] {
        traps.of(header, &strain(header, |l| l - 1.0), Read);
    }
    for header in ["strain (%)", "Elongation [%]", "strain_percent", "Dehnung in Prozent"] {
        traps.of(header, &strain(header, |l| 100.0 * (l - 1.0)), Read);
    }
    for header in ["true strain", "Hencky strain", "logarithmic strain", "wahre Dehnung"] {
        traps.of(header, &strain(header, f64::ln), Read);
    }
    let undeclared = strain("strain", |l| 100.0 * (l - 1.0));
    traps.of("per cent without a sign", &undeclared, Refused(&["100 %", "10000 %", "--strain percent"]));
    traps.with("per cent as said", "ut.csv", &undeclared, |o| o.strain = Some(StrainMeasure::Percent), Read);
    let far = curve(Mode::Uniaxial, (0..=30).map(|i| 1.0 + 0.1 * f64::from(i)));
    traps.of("three times its length", &plain(NOMINAL, &far), Refused(&["3 %", "300 %", "--strain engineering"]));
    traps.of("three times, with a unit", &plain("strain (mm/mm),nominal stress (MPa)", &far), Read);

    let stress = |header: &str, factor: f64| {
        table(&format!("strain,{header}"), &points, |l, p| format!("{:.9},{:e}", l - 1.0, factor * p))
    };
    for (header, factor) in [
        ("nominal stress (kPa)", 1e3),
        ("Engineering Stress [Pa]", 1e6),
        ("eng_stress_psi", 145.037_737_73),
        ("Nennspannung N/mm²", 1.0),
        ("nominal stress (MN/m^2)", 1.0),
        ("nominal stress (N/cm2)", 100.0),
        ("nominal stress (kgf/cm^2)", 10.197_162_13),
        ("P11 (MPA)", 1.0),
        ("1st PK stress (kPa)", 1e3),
    ] {
        traps.of(header, &stress(header, factor), Read);
    }
    traps.of("no unit", &stress("nominal stress", 1.0), Refused(&["unit", "--unit"]));
    traps.with(
        "unit as said",
        "ut.csv",
        &stress("nominal stress", 1e3),
        |o| o.unit = Some(StressUnit::Kilopascal),
        Read,
    );
    let contradicts = |o: &mut ReadOptions| o.unit = Some(StressUnit::Psi);
    traps.with("two units", "ut.csv", &stress("nominal stress (kPa)", 1e3), contradicts, Refused(&["kPa", "psi"]));

    let kind = |header: &str, is_true: bool| {
        let factor = |l: f64| if is_true { l } else { 1.0 };
        table(&format!("strain,{header}"), &points, |l, p| format!("{:.9},{:.9}", l - 1.0, factor(l) * p))
    };
    traps.of("true stress", &kind("True stress (MPa)", true), Read);
    traps.of("Cauchy stress", &kind("Cauchy stress [MPa]", true), Read);
    traps.of("wahre Spannung", &kind("wahre Spannung (MPa)", true), Read);
    let unknown = Refused(&["nominal", "true stress", "--stress"]);
    traps.of("stress of unknown kind", &kind("stress (MPa)", false), unknown);
    traps.of("tensile stress", &kind("Tensile stress (MPa)", false), Refused(&["--stress"]));
    traps.with("as said", "ut.csv", &kind("stress (MPa)", true), |o| o.stress = Some(StressMeasure::True), Read);
    traps.of("by a line above", &format!("All stresses are Cauchy stresses\n{}", kind("stress (MPa)", true)), Read);
    traps.of(
        "both kinds of both",
        &table("true strain,true stress (MPa),eng. strain,eng. stress (MPa)", &points, |l, p| {
            format!("{:.9},{:.9},{:.9},{p:.9}", l.ln(), l * p, l - 1.0)
        }),
        Read,
    );
    for (what, is_true) in [("force beside nominal stress", false), ("force beside true stress", true)] {
        let text = table("Load (N),strain,stress (MPa)", &points, |l, p| {
            format!("{:.6},{:.9},{:.9}", 18.0 * p, l - 1.0, if is_true { l * p } else { p })
        });
        traps.of(what, &text, Read);
    }
    traps.none_is_wrong(40);
}

#[test]
fn layouts() {
    let mut traps = Traps::default();
    let points = pulled();
    let text = plain(NOMINAL, &points);
    let between = |separator: &str| text.replace(',', separator);
    traps.of("semicolons", &between(";"), Read);
    traps.of("tabs", &between("\t"), Read);
    traps.of("blanks", &between("   ").replace("nominal stress (MPa)", "nominal_stress_MPa"), Read);
    traps.of("decimal commas", &between(";").replace('.', ","), Read);
    traps.of("decimal commas between commas", &text.replace('.', ","), Refused(&["decimal commas"]));
    let mixed = between(";").replacen('.', ",", 3);
    traps.of("decimal commas and points", &mixed, Refused(&["decimal commas", "decimal points"]));
    let thousands = "stretch;nominal stress (Pa)\n1;0\n2;350,000\n3;578,000\n";
    traps.of("thousands", thousands, Refused(&["thousands", "--decimal"]));
    let as_comma = |o: &mut ReadOptions| o.decimal = Some(DecimalSign::Comma);
    traps.with("the sign as said", "ut.csv", &between(";").replace('.', ","), as_comma, Read);
    traps.of(
        "quoted",
        &table("\"strain\",\"nominal stress (MPa)\"", &points, |l, p| format!("\"{:.9}\",\"{p:.9}\"", l - 1.0)),
        Read,
    );
    traps.of("Windows", &text.replace('\n', "\r\n"), Read);
    traps.of("old Macintosh", &text.replace('\n', "\r"), Read);
    traps.of("byte-order mark", &format!("\u{feff}{text}"), Read);
    let utf16: Vec<u8> = format!("\u{feff}{text}").encode_utf16().flat_map(u16::to_le_bytes).collect();
    traps.bytes("UTF-16", "ut.csv", &utf16, |_| (), Read);
    let latin = [b"strain,Nennspannung (N/mm\xb2)\n", text.split_once('\n').unwrap().1.as_bytes()].concat();
    traps.bytes("Latin 1", "ut.csv", &latin, |_| (), Read);
    traps.bytes("a workbook", "ut.csv", b"PK\x03\x04\0\0\x08\0", |_| (), Refused(&["no text", "CSV"]));
    traps.of("empty", "", Refused(&["two numbers"]));
    traps.of("a header only", &format!("{NOMINAL}\n"), Refused(&["two numbers"]));
    traps.of("one column", "strain\n0.1\n0.2\n", Refused(&["two numbers"]));
    traps.of("powers of ten", &table(NOMINAL, &points, |l, p| format!("{:E},{p:E}", l - 1.0)), Read);
    let minus = plain(NOMINAL, &pressed()).replace('-', "\u{2212}");
    traps.of("compression with long minus signs", &minus, Read);
    let units_below =
        table("Strain,Nominal stress\n%,kPa", &points, |l, p| format!("{:.9},{:.9}", 100.0 * (l - 1.0), 1e3 * p));
    traps.of("units below", &units_below, Read);
    traps.of("lines above", &format!("Project: finger\nOperator;Jane\nDate,2020-01-02\n\n{text}"), Read);
    traps.of("comments", &format!("# nothing\n# 1,2\n{}", text.replacen("\n", "\n# half way\n", 1)), Read);
    traps.of("blank lines", &text.replace('\n', "\n\n"), Read);
    traps.of("empty cells at the end", &text.replace('\n', ",,\n"), Read);
    traps.of(
        "stress first",
        &table("nominal stress (MPa),strain", &points, |l, p| format!("{p:.9},{:.9}", l - 1.0)),
        Read,
    );
    let many = table("Time (s),Load Cell (kN),Strain rate (1/s),strain,nominal stress (MPa),Cycle", &points, |l, p| {
        format!("{:.3},1,0.01,{:.9},{p:.9},1", 10.0 * l, l - 1.0)
    });
    traps.of("columns beside", &many, Read);
    traps.of(
        "two columns of strain",
        "strain,strain,nominal stress (MPa)\n1,2,3\n2,3,4\n",
        Refused(&["several columns"]),
    );
    let specimens = table("strain,nominal stress A (MPa),nominal stress B (MPa)", &points, |l, p| {
        format!("{:.9},{p:.9},{p:.9}", l - 1.0)
    });
    traps.of("two columns of stress", &specimens, Refused(&["several columns", "--columns"]));
    let second = |o: &mut ReadOptions| o.columns = ColumnChoice::parse("stress=3").unwrap();
    traps.with("the second of them", "ut.csv", &specimens, second, Read);
    let bare = text.split_once('\n').unwrap().1;
    let by_number = |o: &mut ReadOptions| {
        o.columns = ColumnChoice::parse("strain=1,nominal-stress=2").unwrap();
        o.unit = Some(StressUnit::Megapascal);
    };
    traps.of("no names", bare, Refused(&["--columns"]));
    traps.with("numbers of columns", "ut.csv", bare, by_number, Refused(&["unknown kind", "--strain"]));
    let all = |o: &mut ReadOptions| (by_number(o), o.strain = Some(StrainMeasure::Engineering)).1;
    traps.with("all that is needed", "ut.csv", bare, all, Read);
    traps.of("a cell without a number", &text.replacen("0.050000000", "n/a", 1), Refused(&["`n/a`", "finite number"]));
    traps.of("statistics below", &format!("{text}Mean,0.3\n"), Refused(&["`Mean`"]));

    let forces = |header: &str, force: f64, length: f64| {
        table(header, &points, |l, p| format!("{:.9},{:.9}", force * 18.0 * p, length * 33.0 * (l - 1.0)))
    };
    let specimen = |o: &mut ReadOptions| o.specimen = Some([18.0, 33.0]);
    traps.with("force and displacement", "ut.csv", &forces("Load (N),Position (mm)", 1.0, 1.0), specimen, Read);
    traps.with("kilonewton and inch", "ut.csv", &forces("Force [kN],Stroke [inch]", 1e-3, 1.0 / 25.4), specimen, Read);
    traps.with("Kraft und Weg", "ut.csv", &forces("Kraft N,Standardweg mm", 1.0, 1.0), specimen, Read);
    let without = Refused(&["--area", "--length"]);
    traps.of("of an unknown specimen", &forces("Load (N),Position (mm)", 1.0, 1.0), without);
    traps.none_is_wrong(35);
}

#[test]
fn kinds_of_test() {
    let mut traps = Traps::default();
    for file in ["ut.csv", "UT.txt", "tensile_3.csv", "Zugversuch 2.csv", "dogbone-uniaxial.csv", "Tension.csv"] {
        traps.named(file, Read);
    }
    for file in ["sample_ET_3.csv", "EB.Smith.csv", "finger.csv", "1.csv"] {
        traps.named(file, Refused(&["which test", "--test"]));
    }
    let text = plain(NOMINAL, &pulled());
    let above = |line: &str| format!("{line}\n{text}");
    for line in ["Standard;ASTM D412", "ISO 37 dumbbell", "DIN 53504", "Test type: uniaxial tension"] {
        traps.with(line, "a.csv", &above(line), |_| (), Read);
    }
    for line in ["Operator: EB", "Sample PS 12", "Machine ET 200"] {
        traps.with(line, "a.csv", &above(line), |_| (), Refused(&["which test"]));
    }
    traps.with("as said", "a.csv", &text, |o| o.test = Some(Mode::Uniaxial), Read);
    let stretches = || (1..=10).map(|i| 1.0 + 0.1 * f64::from(i));
    for (name, mode) in
        [("equi-biaxial", Mode::Equibiaxial), ("pure shear", Mode::Planar), ("planar tension", Mode::Planar)]
    {
        traps.with(name, &format!("{name}.csv"), &plain(NOMINAL, &curve(mode, stretches())), |_| (), Read);
    }
    let [ut, et, ps] = Mode::ALL.map(|mode| curve(mode, stretches()));
    let long: Vec<String> = [("UT", &ut), ("et", &et), ("planar", &ps)]
        .into_iter()
        .map(|(name, points)| table("", points, |l, p| format!("{name},{:.9},{p:.9}", l - 1.0)))
        .collect();
    traps.with("all in one column", "a.csv", &format!("test,{NOMINAL}{}", long.concat()), |_| (), Read);
    let wide: Vec<String> =
        (0..10).map(|i| format!("{:.9},{:.9},{:.9},{:.9}\n", ut[i][0], ut[i][1], et[i][1], ps[i][1])).collect();
    let head = "stretch,UT nominal stress (MPa),ET nominal stress (MPa),PS nominal stress (MPa)\n";
    traps.with("side by side", "a.csv", &format!("{head}{}", wide.concat()), |_| (), Read);
    traps.with(
        "another test than its stretches",
        "ut.csv",
        &table("F11,F22,P11 (MPa)", &et, |l, p| format!("{l:.9},{l:.9},{p:.9}")),
        |_| (),
        Refused(&["'F22'", "uniaxial"]),
    );
    let instron = plain("Tensile strain (mm/mm),Tensile nominal stress (MPa)", &ps);
    traps.with(
        "machines call every test tensile",
        "planar_3.csv",
        &instron,
        |_| (),
        Refused(&["uniaxial", "planar", "--test"]),
    );
    traps.with("the kind as said", "planar_3.csv", &instron, |o| o.test = Some(Mode::Planar), Read);
    let instron = plain("Tensile strain (mm/mm),Tensile nominal stress (MPa)", &pulled());
    traps.with("a tensile test", "1.csv", &instron, |_| (), Read);
    let positive: Vec<[f64; 2]> = pressed().iter().map(|[l, p]| [2.0 - l, -p]).collect();
    traps.with("compression", "compression.csv", &plain(NOMINAL, &positive), |_| (), Read);
    traps.with(
        "Druckversuch",
        "a.csv",
        &format!("Druckversuch einachsig\n{}", plain(NOMINAL, &positive)),
        |_| (),
        Read,
    );
    traps.with("compression with signs", "compression.csv", &plain(NOMINAL, &pressed()), |_| (), Read);
    traps.none_is_wrong(25);
}

#[test]
fn rows() {
    let mut traps = Traps::default();
    let points = pulled();
    let loaded = |factor: f64| -> Vec<[f64; 2]> { points.iter().map(|[l, p]| [*l, factor * p]).collect() };
    let unloaded = |factor: f64| -> Vec<[f64; 2]> { loaded(factor).into_iter().rev().skip(1).collect() };
    let mut of = |what: &str, points: &[[f64; 2]]| traps.of(what, &plain(NOMINAL, points), Read);
    of("descending", &unloaded(1.0));
    of("with the unloading", &[loaded(1.0), unloaded(0.8)].concat());
    of("the unloading first", &[unloaded(0.8), loaded(1.0)].concat());
    of("three cycles", &[loaded(1.4), unloaded(0.8), loaded(1.1), unloaded(0.7), loaded(1.0), unloaded(0.7)].concat());
    of("a stub of reloading", &[loaded(1.0), unloaded(0.8), loaded(0.9)[..4].to_vec()].concat());
    of("three specimens one after the other", &[loaded(1.0), loaded(1.01), loaded(0.99)].concat());
    of("twice", &points.iter().flat_map(|point| [*point, *point]).collect::<Vec<_>>());
    let mut shuffled = points.clone();
    (0..shuffled.len()).for_each(|i| shuffled.swap(i, (7 * i) % 21));
    of("in no order", &shuffled);
    let mut spike = points.clone();
    spike[9][1] *= 3.0;
    of("one three times too high", &spike);
    spike[9][1] = 0.0;
    of("one without stress", &spike);
    let offset: Vec<[f64; 2]> = points.iter().map(|[l, p]| [*l, p + 0.03]).collect();
    of("an offset of the load cell", &offset);
    let slack: Vec<[f64; 2]> = [[1.0, 0.0]; 1].into_iter().chain(points.iter().map(|[l, p]| [l + 0.05, *p])).collect();
    of("slack before the specimen is taut", &slack);
    let set: Vec<[f64; 2]> = points.iter().map(|[l, p]| [1.1 * l, *p]).collect();
    of("longer after the first loading", &[loaded(1.3), unloaded(0.7), [[1.05, 0.0]].to_vec(), set].concat());
    let broken = [points.clone(), vec![[2.05, 0.12], [2.1, 0.02], [2.15, 0.001]]].concat();
    of("broken", &broken);
    let taut = points.iter().map(|[l, p]| [l + 0.05, *p]).chain([[2.1, 0.02], [2.15, 0.0], [2.2, 0.0]]);
    of("slack, and broken in the end", &[[1.0, 0.0]].into_iter().chain(taut).collect::<Vec<_>>());
    let slack_twice: Vec<[f64; 2]> = [slack.clone(), slack].concat();
    of("two specimens, both slack", &slack_twice);
    traps.none_is_wrong(16);
}
