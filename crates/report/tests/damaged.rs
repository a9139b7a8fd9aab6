//! Nothing that the files of a result folder may hold makes the report panic, take memory without bound, or show what is no number.

#![allow(clippy::unwrap_used)]

use std::cell::Cell;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use peak_alloc::PeakAlloc;
use pneuflex_model::{Case, Formulation, LoadParameter, Problem};
use pneuflex_post::surface_stress::SurfaceState;
use pneuflex_post::vtu::Grid;
use pneuflex_post::{contact, fields, stress};
use pneuflex_report::inputs::groups;
use pneuflex_report::state::State;
use pneuflex_report::summary::Summary;
use pneuflex_report::{Report, render};
use proptest::prelude::*;
use proptest::sample::Index;
use proptest::test_runner::{Config, TestRunner};

#[path = "../src/testing.rs"]
mod testing;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// The texts of a result folder with one pressure.
#[derive(Clone)]
struct Folder {
    texts: [String; 3],
}

const BODY: usize = 0;
const WALLS: usize = 1;
const SUMMARY: usize = 2;

impl Folder {
    fn new(problem: &Problem) -> Self {
        // The first chamber leans onto the second.
        let u = testing::displaced(problem, |x| [if x[0] <= 8.0 { 2.1 } else { 0.0 } * x[2] / 13.0, 0.0, 0.0]);
        let (stress, contact) = (stress::recover(problem, &u).unwrap(), contact::evaluate(problem, &u).unwrap());
        let body = fields::body(
            problem,
            &stress,
            &SurfaceState { displacement: &u, parameter: LoadParameter(5.0), pressures: &[], contact: &contact },
        )
        .unwrap()
        .to_vtu()
        .unwrap();
        let walls = fields::contact_walls(problem, &u, &contact, 5.0).unwrap().unwrap().to_vtu().unwrap();
        let summary = serde_json::to_string_pretty(&testing::summary_json(&[5.0])).unwrap();
        Self { texts: [body, walls, summary] }
    }

    /// The page, or why there is none.
    fn page(&self, case: &Case, problem: &Problem) -> Result<String, String> {
        let grid = |which: usize| Grid::from_vtu(&self.texts[which]).map_err(|e| e.to_string());
        let summary: Summary = serde_json::from_str(&self.texts[SUMMARY]).map_err(|e| e.to_string())?;
        let (body, walls) = (grid(BODY)?, grid(WALLS)?);
        let states = [State::from_grids(problem, &body, Some(&walls)).map_err(|e| e.to_string())?];
        let report = Report {
            title: &case.title,
            about: "2 chambers",
            inputs: &groups(case),
            problem,
            summary: &summary,
            states: Some(&states),
        };
        render(&report).map_err(|e| e.to_string())
    }
}

#[derive(Clone, Debug)]
enum Edit {
    Cut(Index),
    Delete(Index),
    Double(Index),
    Swap(Index, Index),
    Byte(Index, u8),
    /// Another value in place of an attribute's or of a number of JSON.
    Value(Index, &'static str),
    /// Eight other bytes in an array, counted from its byte count on.
    Word(Index, Place, [u8; 8]),
    /// One array in place of another.
    Array(Index, Index),
}

/// The byte count and the first numbers are as likely as all others together.
#[derive(Clone, Debug)]
enum Place {
    First(usize),
    Any(Index),
}

const VALUES: [&str; 20] = [
    "",
    "-1",
    "0",
    "1",
    "99999999999999999999",
    "1e308",
    "-1e308",
    "1e999",
    "nan",
    "null",
    "Float64",
    "Int64",
    "UInt8",
    "[]",
    "displacement",
    "von_mises",
    "\"\"",
    "é<&",
    "{}",
    "[1e308, -1e308]",
];

const NUMBERS: [f64; 7] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, -f64::MAX, -1e300, 1e-310];

fn edit() -> impl Strategy<Value = Edit> {
    let index = any::<Index>;
    let place = prop_oneof![(0..3_usize).prop_map(Place::First), index().prop_map(Place::Any)];
    let word = prop_oneof![
        any::<u64>().prop_map(u64::to_le_bytes),
        (-2_i64..70).prop_map(i64::to_le_bytes),
        prop::sample::select(&NUMBERS[..]).prop_map(f64::to_le_bytes),
    ];
    prop_oneof![
        1 => index().prop_map(Edit::Cut),
        2 => index().prop_map(Edit::Delete),
        2 => index().prop_map(Edit::Double),
        2 => (index(), index()).prop_map(|(a, b)| Edit::Swap(a, b)),
        2 => (index(), any::<u8>()).prop_map(|(a, b)| Edit::Byte(a, b)),
        6 => (index(), prop::sample::select(&VALUES[..])).prop_map(|(a, v)| Edit::Value(a, v)),
        8 => (index(), place, word).prop_map(|(a, b, w)| Edit::Word(a, b, w)),
        2 => (index(), index()).prop_map(|(a, b)| Edit::Array(a, b)),
    ]
}

fn apply(text: &str, edit: &Edit) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    if lines.is_empty() {
        return String::new();
    }
    let arrays: Vec<usize> = (1..lines.len()).filter(|&i| lines[i - 1].contains("<DataArray")).collect();
    match edit {
        Edit::Cut(at) => {
            let end = (0..=at.index(text.len() + 1)).rev().find(|&i| text.is_char_boundary(i)).unwrap();
            return text[..end].to_owned();
        }
        Edit::Byte(at, byte) => {
            let mut bytes = text.as_bytes().to_vec();
            let at = at.index(bytes.len());
            bytes[at] = *byte;
            return String::from_utf8_lossy(&bytes).into_owned();
        }
        Edit::Value(at, value) => return with_value(text, at, value),
        Edit::Delete(at) => {
            lines.remove(at.index(lines.len()));
        }
        Edit::Double(at) => {
            let at = at.index(lines.len());
            lines.insert(at, lines[at].clone());
        }
        Edit::Swap(a, b) => {
            let (a, b) = (a.index(lines.len()), b.index(lines.len()));
            lines.swap(a, b);
        }
        Edit::Word(..) | Edit::Array(..) if arrays.is_empty() => {}
        Edit::Word(array, at, word) => {
            let line = &mut lines[arrays[array.index(arrays.len())]];
            if let Ok(mut bytes) = STANDARD.decode(line.trim())
                && bytes.len() >= 8
            {
                let words = bytes.len() / 8;
                let start = 8 * match at {
                    Place::First(n) => (*n).min(words - 1),
                    Place::Any(at) => at.index(words),
                };
                bytes[start..start + 8].copy_from_slice(word);
                *line = STANDARD.encode(bytes);
            }
        }
        Edit::Array(a, b) => {
            let (a, b) = (arrays[a.index(arrays.len())], arrays[b.index(arrays.len())]);
            lines[a] = lines[b].clone();
        }
    }
    lines.join("\n")
}

fn with_value(text: &str, at: &Index, value: &str) -> String {
    let bytes = text.as_bytes();
    let starts = |i: usize| {
        let is_number = bytes[i].is_ascii_digit() && matches!(bytes[i - 1], b' ' | b'-');
        is_number || (i > 1 && &bytes[i - 2..i] == b"=\"")
    };
    let places: Vec<usize> = (1..bytes.len()).filter(|&i| text.is_char_boundary(i) && starts(i)).collect();
    if places.is_empty() {
        return text.to_owned();
    }
    let start = places[at.index(places.len())];
    let length = text[start..].find(['"', ',', '\n', ' ']).unwrap_or(text.len() - start);
    format!("{}{value}{}", &text[..start], &text[start + length..])
}

/// Makes the page of damaged files, and says whether there is one: memory stays within a bound, and what is shown are numbers.
fn process(folder: &Folder, case: &Case, problem: &Problem) -> Result<bool, TestCaseError> {
    let length: usize = folder.texts.iter().map(String::len).sum();
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let page = folder.page(case, problem);
    let taken = MEMORY.peak_usage().saturating_sub(before);
    prop_assert!(taken < 100 * length + (16 << 20), "{taken} bytes for {length}");
    let page = match page {
        Ok(page) => page,
        Err(error) => {
            prop_assert!(!error.is_empty() && error.len() < 2000, "{error}");
            return Ok(false);
        }
    };
    let data = page.split("application/json\">").nth(1).unwrap().split("</script>").next().unwrap();
    // JSON has no other word for what is no number.
    prop_assert!([":null", "[null", ",null"].iter().all(|word| !data.contains(word)), "{data}");
    let shown = page.split("<main").nth(1).unwrap().split("report-data").next().unwrap();
    prop_assert!(["NaN", ">inf", ">-inf", "−inf"].iter().all(|word| !shown.contains(word)), "{shown}");
    Ok(true)
}

// A single test, so that no other one takes memory meanwhile.
#[test]
fn damaged_files_are_errors_or_pages_of_numbers() {
    let problem = testing::two_chambers(Formulation::Hex8Sri);
    let case: Case = serde_json::from_value(serde_json::json!({
        "load": {"pressure_kpa": [5.0]}, "actuator": serde_json::to_value(pneuflex_mesh::Actuator::two_chambers()).unwrap()
    }))
    .unwrap();
    let folder = Folder::new(&problem);
    assert!(process(&folder, &case, &problem).unwrap());

    let (errors, pages) = (Cell::new(0), Cell::new(0));
    let config = Config { cases: 1000, failure_persistence: None, ..Config::default() };
    let changes =
        prop::collection::vec((prop::sample::select(vec![BODY, BODY, WALLS, SUMMARY, SUMMARY]), edit()), 1..4);
    TestRunner::new(config)
        .run(&changes, |changes| {
            let mut damaged = folder.clone();
            for (which, edit) in &changes {
                damaged.texts[*which] = apply(&damaged.texts[*which], edit);
            }
            let count = if process(&damaged, &case, &problem)? { &pages } else { &errors };
            count.set(count.get() + 1);
            Ok(())
        })
        .unwrap();
    // Neither is all that ever happens.
    assert!(errors.get() > 50 && pages.get() > 50, "{errors:?} {pages:?}");

    for text in [
        "<a>".repeat(100_000),
        format!("{}{}", "<a>".repeat(100_000), "</a>".repeat(100_000)),
        "<!DOCTYPE a [<!ENTITY b \"bbbbbbbbbb\"><!ENTITY c \"&b;&b;&b;\">]><a>&c;</a>".to_owned(),
        "[".repeat(100_000),
        format!("{{\"steps\": {}", "[{\"pressure_kpa\":".repeat(10_000)),
    ] {
        for which in [BODY, WALLS, SUMMARY] {
            let mut damaged = folder.clone();
            damaged.texts[which] = text.clone();
            assert!(!process(&damaged, &case, &problem).unwrap(), "{which}");
        }
    }
}
