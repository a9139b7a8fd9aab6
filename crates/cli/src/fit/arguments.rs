//! Arguments of `pneuflex fit`, and their values for each file and test.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use pneuflex::calibration::bulk::bulk_modulus;
use pneuflex::calibration::clean::{Cleaning, Cycles};
use pneuflex::calibration::curve::{ColumnChoice, DecimalSign, ReadOptions, StrainMeasure, StressMeasure, StressUnit};
use pneuflex::calibration::fit::{FitOptions, Residuals};
use pneuflex::calibration::law::{Choice, Family, Mode};
use pneuflex::calibration::test_name;

use pneuflex::InputError;

const EXAMPLES: &str = "\
Examples:
  pneuflex fit ecoflex.csv --test uniaxial --unit kPa
  pneuflex fit uniaxial.csv planar.csv biaxial.csv --weight planar=2 --to 2.5
  pneuflex fit treloar.csv --unit MPa --to uniaxial=4 --to 300% --stable
  pneuflex fit machine.csv --columns true-strain=2,true-stress=3 --test ut
  pneuflex fit load.csv --test ut --area 12 --length 30
  pneuflex fit a.csv b.csv --test a.csv:uniaxial --test b.csv:planar --unit b.csv:psi

Files are tables with a header; cells between commas, semicolons, tabs or blanks; several tests in one file are told apart by a column
`test` or by the names of the columns (`uniaxial stress (MPa)`). What was understood is printed; what is not understood is refused.
An option with FILE: before its value holds for that file alone.

A fit up to the break is ruled by stresses that no actuator sees, and is then often twice too stiff where one works. So relative
differences are minimised, and what the law cannot follow together with the small strains is left out (--to all fits it).
Each test counts equally, however many points it has. Rows at stretch 1, duplicates, unloading and what follows a break are left
out, and said so. The confidence intervals suppose independent residuals, which those of a smooth curve are not; the report
says by about how much they are too narrow.

Printed and written to --out: fit.json (all numbers), fit.svg and fit.png (points and curves), material.toml (to paste into a case
file). The bulk modulus is no result of these tests: it is set to 1000 times the initial shear modulus (Poisson's ratio 0.4995), or
to more where the volume would change by over 0.5 % at the largest stress of the tests, unless --bulk-ratio, --poisson or --bulk-modulus says otherwise.

Exit codes: 0 done, 1 an output could not be written, 2 bad input, 3 no constants that a case file could use.";

/// Arguments of `pneuflex fit`.
#[derive(Debug, Args)]
#[command(after_long_help = EXAMPLES, after_help = "Examples and rules: pneuflex fit --help")]
pub struct FitArguments {
    /// Files of test curves (CSV), at most 50 MiB each
    #[arg(required = true, value_name = "DATA.csv")]
    pub files: Vec<PathBuf>,
    /// The test of a file that names none: uniaxial (ut), equibiaxial (et) or planar (ps, pure shear)
    #[arg(long, value_name = "[FILE:]TEST")]
    test: Vec<String>,
    /// Columns by number or name, e.g. strain=2,stress=5; keys: stretch, strain, percent-strain, true-strain, stress,
    /// nominal-stress, true-stress, test
    #[arg(long, value_name = "[FILE:]KEY=COLUMN,…")]
    columns: Vec<String>,
    /// Unit of stresses whose column does not name it: MPa, kPa, Pa, N/mm2, psi …
    #[arg(long, value_name = "[FILE:]UNIT")]
    unit: Vec<String>,
    /// What the strain column holds: stretch, engineering, percent or true
    #[arg(long, value_name = "[FILE:]MEASURE")]
    strain: Vec<String>,
    /// What the stress column holds: nominal or true
    #[arg(long, value_name = "[FILE:]MEASURE")]
    stress: Vec<String>,
    /// Undeformed area of the specimen, mm², for files of force and change of length
    #[arg(long, value_name = "[FILE:]MM2")]
    area: Vec<String>,
    /// Undeformed length of the specimen, mm, the same
    #[arg(long, value_name = "[FILE:]MM")]
    length: Vec<String>,
    /// Decimal sign: point or comma
    #[arg(long, value_name = "[FILE:]SIGN")]
    decimal: Vec<String>,
    /// Which loading of a cyclic test is fitted
    #[arg(long, default_value = "last")]
    cycles: CyclesArgument,
    /// Keep the rows after the largest stress of a broken specimen
    #[arg(long)]
    keep_break: bool,
    /// Keep a stress that was measured at stretch 1 in all others, from which it is taken otherwise, and strains without stress
    #[arg(long)]
    keep_offset: bool,
    /// Smallest stretch, or engineering strain with %, that is fitted; for one test or all
    #[arg(long, value_name = "[TEST=]STRETCH")]
    from: Vec<String>,
    /// Largest stretch, or engineering strain with %, that is fitted, for one test or all; `all` for every point [default: the longest range
    /// on which the law is within 10 % of the stress at every strain from 10 % on]
    #[arg(long, value_name = "[TEST=]STRETCH")]
    to: Vec<String>,
    /// Weight of a test [default: 1 each]
    #[arg(long, value_name = "TEST=WEIGHT")]
    weight: Vec<String>,
    /// Minimise differences relative to the stress, each part of the logarithm of the strain counting alike, or differences of nominal
    /// stress, which the largest stresses rule
    #[arg(long, default_value = "relative")]
    residuals: ResidualsArgument,
    /// Only constants that are stable (Drucker) in every deformation up to this I1-3, by default the largest of the points
    #[arg(long, value_name = "I1-3", num_args = 0..=1, require_equals = true, default_missing_value = "data")]
    stable: Option<String>,
    /// Law of material.toml
    #[arg(long, default_value = "yeoh")]
    law: LawArgument,
    /// Terms of a Yeoh law, 2 or 3, or of an Ogden law, 1 to 3 [default: 3, or as many of Ogden's as are worth it]
    #[arg(long, value_name = "NUMBER")]
    terms: Option<usize>,
    /// Bulk modulus over initial shear modulus [default: 1000, or what keeps the volume to 0.5 % at the largest stress]
    #[arg(long, value_name = "K/MU", group = "bulk")]
    bulk_ratio: Option<f64>,
    /// Poisson's ratio at rest, in place of --bulk-ratio
    #[arg(long, value_name = "NU", group = "bulk")]
    poisson: Option<f64>,
    /// Bulk modulus itself, in place of --bulk-ratio
    #[arg(long, value_name = "MPA", group = "bulk")]
    bulk_modulus: Option<f64>,
    /// Folder for the results [default: out/NAME-fit for the first file NAME.csv]; what else it holds is left alone
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print nothing but the material
    #[arg(long)]
    pub quiet: bool,
}

/// Loadings of a cyclic test.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum CyclesArgument {
    /// The last loading.
    Last,
    /// The first loading.
    First,
    /// Everything.
    All,
}

/// What is minimised.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum ResidualsArgument {
    /// Relative differences.
    Relative,
    /// Differences of stress.
    Absolute,
}

/// Laws that a case file can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LawArgument {
    /// Three constants.
    Yeoh,
    /// C10 alone.
    #[value(alias = "neo-hookean")]
    NeoHooke,
    /// C10 and C01.
    MooneyRivlin,
    /// One to three moduli and exponents.
    Ogden,
    /// A modulus, and the I1-3 at which it locks.
    Gent,
}

impl FitArguments {
    /// What is said about a file.
    pub fn read_options(&self, file: &Path) -> Result<ReadOptions, InputError> {
        let of = |name: &str, values: &[String]| self.for_file(name, values, file);
        let columns = match of("columns", &self.columns)? {
            Some(text) => ColumnChoice::parse(&text).map_err(|e| InputError::new(format!("--columns {e}")))?,
            None => ColumnChoice::default(),
        };
        let unit = |text: &str| StressUnit::find(text);
        let strain = |text: &str| match text {
            "stretch" => Some(StrainMeasure::Stretch),
            "engineering" | "nominal" => Some(StrainMeasure::Engineering),
            "percent" | "%" => Some(StrainMeasure::Percent),
            "true" | "log" => Some(StrainMeasure::True),
            _ => None,
        };
        let stress = |text: &str| match text {
            "nominal" | "engineering" => Some(StressMeasure::Nominal),
            "true" | "cauchy" => Some(StressMeasure::True),
            _ => None,
        };
        let decimal = |text: &str| match text {
            "point" | "." => Some(DecimalSign::Point),
            "comma" | "," => Some(DecimalSign::Comma),
            _ => None,
        };
        let size = |text: &str| text.parse().ok().filter(|size: &f64| (1e-6..=1e9).contains(size));
        let area = parsed("area", of("area", &self.area)?, size, "mm2, a number from 1e-6 to 1e9")?;
        let length = parsed("length", of("length", &self.length)?, size, "mm, a number from 1e-6 to 1e9")?;
        Ok(ReadOptions {
            test: parsed("test", of("test", &self.test)?, test_name::find, "uniaxial, equibiaxial or planar")?,
            columns,
            unit: parsed("unit", of("unit", &self.unit)?, unit, "MPa, kPa, Pa, GPa, N/mm2, N/cm2, kgf/cm2 or psi")?,
            strain: parsed("strain", of("strain", &self.strain)?, strain, "stretch, engineering, percent or true")?,
            stress: parsed("stress", of("stress", &self.stress)?, stress, "nominal or true")?,
            decimal: parsed("decimal", of("decimal", &self.decimal)?, decimal, "point or comma")?,
            specimen: match (area, length) {
                (Some(area), Some(length)) => Some([area, length]),
                (None, None) => None,
                _ => return Err(InputError::new("--area and --length belong together".to_owned())),
            },
        })
    }

    /// The last value for a file: one with its name before a colon, otherwise one without a name.
    fn for_file(&self, option: &str, values: &[String], file: &Path) -> Result<Option<String>, InputError> {
        let mut own = None;
        let mut common = None;
        for value in values {
            let named = self.files.iter().find_map(|f| {
                let names = [f.to_string_lossy(), f.file_name().unwrap_or_default().to_string_lossy()];
                names.iter().find_map(|n| Some((f, value.strip_prefix(&**n)?.strip_prefix(':')?.to_owned())))
            });
            match named {
                Some((f, rest)) if f == file => own = Some(rest),
                Some(_) => {}
                None if value.contains(".csv:") => {
                    let message = format!("--{option} {value}: no file of this name is fitted");
                    return Err(
                        InputError::new(message).with_help(Some("give the file's name as on the command line".into()))
                    );
                }
                None => common = Some(value.clone()),
            }
        }
        Ok(own.or(common))
    }

    /// How the curve of a test is prepared.
    pub fn cleaning(&self, mode: Mode) -> Result<Cleaning, InputError> {
        let default = Cleaning::default();
        let from = for_test("from", &self.from, mode, stretch)?.unwrap_or(default.from);
        let end = |text: &str| if text == "all" { Ok(f64::INFINITY) } else { stretch(text) };
        let to = for_test("to", &self.to, mode, end)?.unwrap_or(default.to);
        if from >= to {
            return Err(InputError::new(format!("--from {from} is not less than --to {to} for {} tests", mode.name())));
        }
        let cycles = match self.cycles {
            CyclesArgument::Last => Cycles::Last,
            CyclesArgument::First => Cycles::First,
            CyclesArgument::All => Cycles::All,
        };
        Ok(Cleaning { cycles, keeps_break: self.keep_break, keeps_offset: self.keep_offset, from, to })
    }

    /// The weight of a test.
    pub fn weight(&self, mode: Mode) -> Result<f64, InputError> {
        let positive = |text: &str| text.parse().ok().filter(|w: &f64| (1e-6..=1e6).contains(w));
        Ok(for_test("weight", &self.weight, mode, |t| positive(t).ok_or("a number from 1e-6 to 1e6"))?.unwrap_or(1.0))
    }

    /// How constants are fitted to points with this largest I₁ − 3.
    pub fn fit_options(&self, largest: f64) -> Result<FitOptions, InputError> {
        let stable_up_to = match self.stable.as_deref() {
            None => None,
            Some("data") => Some(largest),
            Some(text) => match text.parse::<f64>() {
                Ok(limit) if limit > 0.0 && limit <= 1e4 => Some(limit),
                _ => {
                    let message = format!("--stable={text}: must be an I1-3 greater than 0 and no more than 10000");
                    return Err(InputError::new(message));
                }
            },
        };
        Ok(FitOptions { residuals: self.residuals(), stable_up_to })
    }

    /// The law of material.toml.
    pub fn choice(&self) -> Result<Choice, InputError> {
        let family = match self.law {
            LawArgument::Yeoh => Family::Yeoh,
            LawArgument::NeoHooke => Family::NeoHookean,
            LawArgument::MooneyRivlin => Family::MooneyRivlin,
            LawArgument::Ogden => Family::Ogden,
            LawArgument::Gent => Family::Gent,
        };
        let choice = Choice { family, terms: self.terms };
        if choice.is_possible() {
            return Ok(choice);
        }
        let terms = self.terms.unwrap_or_default();
        let message =
            format!("--terms {terms}: --law yeoh has 2 or 3 terms, --law ogden 1 to 3, the others take no --terms");
        Err(InputError::new(message))
    }

    /// What is minimised.
    pub fn residuals(&self) -> Residuals {
        match self.residuals {
            ResidualsArgument::Absolute => Residuals::Absolute,
            ResidualsArgument::Relative => Residuals::Relative,
        }
    }

    /// Whether the user said where the range that is fitted ends.
    pub fn gives_end(&self) -> bool {
        !self.to.is_empty()
    }

    /// The bulk modulus for an initial shear modulus and the largest mean stress of the tests, MPa.
    pub fn bulk_modulus(&self, shear_modulus: f64, mean_stress: f64) -> Result<f64, InputError> {
        let positive = |name: &str, value: f64| {
            if value > 0.0 && value.is_finite() {
                return Ok(value);
            }
            Err(InputError::new(format!("--{name} {value}: must be greater than 0")))
        };
        if let Some(nu) = self.poisson {
            if !(0.4..0.5).contains(&nu) {
                let message = format!("--poisson {nu}: must be at least 0.4 and less than 0.5; the fit supposes 0.5");
                return Err(InputError::new(message));
            }
            return Ok(shear_modulus * 2.0 * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu)));
        }
        match (self.bulk_modulus, self.bulk_ratio) {
            (Some(modulus), _) => positive("bulk-modulus", modulus),
            (_, Some(ratio)) => Ok(shear_modulus * positive("bulk-ratio", ratio)?),
            _ => Ok(bulk_modulus(shear_modulus, mean_stress)),
        }
    }
}

fn parsed<T>(
    option: &str,
    text: Option<String>,
    parse: impl Fn(&str) -> Option<T>,
    expected: &str,
) -> Result<Option<T>, InputError> {
    let Some(text) = text else { return Ok(None) };
    let value = parse(&text.trim().to_lowercase());
    value.map(Some).ok_or_else(|| InputError::new(format!("--{option} {text}: expected {expected}")))
}

/// The value of a test: one with its name, otherwise one without.
fn for_test(
    option: &str,
    values: &[String],
    mode: Mode,
    parse: impl Fn(&str) -> Result<f64, &'static str>,
) -> Result<Option<f64>, InputError> {
    let (mut own, mut common) = (None, None);
    for value in values {
        let (test, number) = match value.split_once('=') {
            Some((test, number)) => (Some(test), number),
            None => (None, value.as_str()),
        };
        let refuse = |expected: &str| InputError::new(format!("--{option} {value}: expected {expected}"));
        let number = parse(number.trim()).map_err(refuse)?;
        match test.map(test_name::find) {
            Some(None) => return Err(refuse("uniaxial, equibiaxial or planar before the ="))?,
            Some(Some(named)) if named == mode => own = Some(number),
            Some(_) => {}
            None if option == "weight" => return Err(refuse("TEST=WEIGHT, e.g. planar=2")),
            None => common = Some(number),
        }
    }
    Ok(own.or(common))
}

/// A stretch, or an engineering strain with %.
fn stretch(text: &str) -> Result<f64, &'static str> {
    let value = match text.strip_suffix('%') {
        Some(percent) => percent.trim().parse().map(|p: f64| 1.0 + 0.01 * p),
        None => text.parse(),
    };
    let expected = "a stretch greater than 0, such as 2.5, or an engineering strain such as 150%";
    value.ok().filter(|s: &f64| *s > 0.0 && s.is_finite()).ok_or(expected)
}
