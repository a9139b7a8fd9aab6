//! No text makes the reader of case files panic, hang, or say more than somebody can read; and what it accepts can be described.

use proptest::prelude::*;
use proptest::sample::{Index, select};

use super::*;
use crate::analysis::Analysis;
use crate::memory::{Estimate, MemoryLimit};
use crate::template::{full_actuator, two_chambers};
use pneuflex_model::Problem;

/// Elements up to which an accepted case is meshed.
const FEW: f64 = 2000.0;

/// What becomes of a text: refused by the reader or by the estimate of memory, too large to try here, or described.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fate {
    Refused,
    TooLarge,
    Described,
}

fn fate(text: &str, changes: &[Change]) -> Fate {
    let file = match CaseFile::from_text(Path::new("case.toml"), text.to_owned(), changes) {
        Ok(file) => file,
        Err(errors) => {
            assert!(!errors.is_empty() && errors.len() <= MOST_PROBLEMS, "{} errors", errors.len());
            for error in errors {
                let message = error.to_string();
                assert!(!message.is_empty() && message.len() < 2000, "{} bytes: {message:.200}", message.len());
                assert!(!message.contains("NaN is out of range: must be greater than NaN"), "{message}");
            }
            return Fate::Refused;
        }
    };
    file.case.validate().unwrap();
    let resolved = file.case.resolved();
    resolved.validate().unwrap();
    let estimate = Estimate::of(&file.case);
    if estimate.within(MemoryLimit::Available).is_err() {
        return Fate::Refused;
    }
    if estimate.elements > FEW {
        return Fate::TooLarge;
    }
    let problem = match Problem::from_case(&file.case) {
        Ok(problem) => problem,
        Err(error) => {
            assert!(!file.out_of_range(&error).to_string().is_empty());
            return Fate::Refused;
        }
    };
    let found = problem.mesh.num_elements() as f64;
    assert!(found <= 20.0 * estimate.elements + 10.0, "{found} elements instead of {}", estimate.elements);
    let description = Analysis::of_case(Path::new("fuzz.toml"), file.case, problem).overview().to_string();
    assert!(description.contains("load") && !description.contains("NaN"), "{description}");
    Fate::Described
}

/// The template with values for all keys, on a coarse mesh.
fn template(text: &str) -> String {
    let text = text.replace("resolution = \"standard\"", "size = 3.0");
    // Keys that stand there as remarks.
    text.lines()
        .map(|line| match line.strip_prefix("# ") {
            Some(rest) if rest.starts_with('[') => format!("{}\n", rest.split('#').next().unwrap_or("")),
            Some(rest) if rest.contains(" = ") && !rest.starts_with("size") && !rest.starts_with("line") => {
                format!("{rest}\n")
            }
            _ => format!("{line}\n"),
        })
        .collect::<String>()
        .replace("edge_size = 0.5", "edge_size = 2.0")
        // Pressures of chambers ask for chambers that nothing joins.
        .replace("half_width = 1.0", "half_width = 0.0")
}

#[derive(Clone, Debug)]
enum Edit {
    Delete(Index),
    Double(Index),
    Replace(Index, Index),
    Insert(Index, String),
    Value(Index, String),
    Key(Index, String),
    Byte(Index, u8),
}

fn values() -> impl Strategy<Value = String> {
    let few = [
        "0",
        "1",
        "-1",
        "2.5",
        "7",
        "40",
        "0.0",
        "-0.0",
        "1e-320",
        "1e-9",
        "1e-3",
        "1e9",
        "1e308",
        "-1e308",
        "nan",
        "-inf",
        "inf",
        "9223372036854775807",
        "-9223372036854775808",
        "99999999999999999999",
        "true",
        "\"\"",
        "\"half\"",
        "\"x\"",
        "[]",
        "[1, 2, 3]",
        "[1.0, nan, 3.0]",
        "[[1]]",
        "[5, 15, 25]",
        "{}",
        "{ half_width = 0, bottom = 0, top = 0 }",
        "1979-05-27T07:32:00Z",
        "'",
        "\"\"\"",
        "0x1F",
        "1_0",
        "é",
        "\"\\u0000\"",
        "{ a.b.c = 1 }",
        "\"hex8-sri\"",
        "\"tet10\"",
        "\"none\"",
        "\"whole\"",
        "[1, \"2\", {}]",
    ];
    prop_oneof![
        6 => select(few.to_vec()).prop_map(str::to_owned),
        1 => any::<f64>().prop_map(|x| format!("{x:?}")),
        1 => (-6.0..6.0_f64).prop_map(|x| format!("{:?}", 10_f64.powf(x))),
        1 => any::<i64>().prop_map(|n| n.to_string()),
        1 => ".{0,12}",
        1 => (1..200_usize).prop_map(|n| "[".repeat(n)),
    ]
}

fn keys() -> impl Strategy<Value = String> {
    let few = [
        "gap",
        "gpa",
        "chambers",
        "actuator",
        "actuator.gap",
        "actuator.gap[1]",
        "actuator.top_wall[2]",
        "actuator.top_wall[]",
        "load.chamber_factor[1]",
        "mesh",
        "probe",
        "title",
        "load.pressure_kpa",
        "channel",
        "\"\"",
        "''",
        "a.b.c.d",
        "\"a]b\"",
        "\"a[0].b\"",
        "\"probe[0]\"",
        "é",
        "\"`x`\"",
        "[actuator",
        "size",
        "resolution",
        "-",
        "1",
    ];
    prop_oneof![4 => select(few.to_vec()).prop_map(str::to_owned), 1 => "[a-z_.\"\\[\\]]{1,10}"]
}

fn edits() -> impl Strategy<Value = Edit> {
    let index = any::<Index>;
    let lines = prop_oneof![
        (keys(), values()).prop_map(|(key, value)| format!("{key} = {value}")),
        keys().prop_map(|key| format!("[{key}]")),
        keys().prop_map(|key| format!("[[{key}]]")),
        ".{0,20}",
    ];
    prop_oneof![
        2 => index().prop_map(Edit::Delete),
        1 => index().prop_map(Edit::Double),
        1 => (index(), index()).prop_map(|(a, b)| Edit::Replace(a, b)),
        1 => (index(), lines).prop_map(|(a, line)| Edit::Insert(a, line)),
        8 => (index(), values()).prop_map(|(a, value)| Edit::Value(a, value)),
        2 => (index(), keys()).prop_map(|(a, key)| Edit::Key(a, key)),
        1 => (index(), any::<u8>()).prop_map(|(a, byte)| Edit::Byte(a, byte)),
    ]
}

fn edited(text: &str, edit: &Edit) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    if lines.is_empty() {
        return text.to_owned();
    }
    let pairs: Vec<usize> =
        (0..lines.len()).filter(|&i| lines[i].contains(" = ") && !lines[i].starts_with('#')).collect();
    match edit {
        Edit::Delete(at) => {
            lines.remove(at.index(lines.len()));
        }
        Edit::Double(at) => {
            let at = at.index(lines.len());
            lines.insert(at, lines[at].clone());
        }
        Edit::Replace(a, b) => {
            let line = lines[b.index(lines.len())].clone();
            let at = a.index(lines.len());
            lines[at] = line;
        }
        Edit::Insert(at, line) => lines.insert(at.index(lines.len() + 1), line.clone()),
        Edit::Value(..) | Edit::Key(..) if pairs.is_empty() => {}
        Edit::Value(at, value) => {
            let line = &mut lines[pairs[at.index(pairs.len())]];
            *line = format!("{} = {value}", line.split(" = ").next().unwrap_or(""));
        }
        Edit::Key(at, key) => {
            let line = &mut lines[pairs[at.index(pairs.len())]];
            *line = format!("{key} = {}", line.split_once(" = ").map_or("", |(_, value)| value));
        }
        Edit::Byte(at, byte) => {
            let mut bytes = text.as_bytes().to_vec();
            let at = at.index(bytes.len());
            bytes[at] = *byte;
            return String::from_utf8_lossy(&bytes).into_owned();
        }
    }
    lines.join("\n")
}

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

#[test]
fn the_template_with_all_keys_is_described() {
    for text in [two_chambers(), full_actuator()] {
        assert_eq!(fate(&template(&text), &[]), Fate::Described, "{}", template(&text));
    }
}

#[test]
fn changed_templates_are_refused_or_described() {
    let text = template(&two_chambers());
    let fates = std::cell::RefCell::new([0; 3]);
    let changes = proptest::collection::vec(edits(), 1..5);
    proptest::test_runner::TestRunner::new(config(1500))
        .run(&changes, |edits| {
            let changed = edits.iter().fold(text.clone(), |text, edit| edited(&text, edit));
            fates.borrow_mut()[fate(&changed, &[]) as usize] += 1;
            Ok(())
        })
        .unwrap();
    let [refused, _, described] = fates.into_inner();
    // About a hundred of each at least, by chance: neither branch is empty.
    assert!(refused > 30 && described > 30, "{refused} refused, {described} described");
}

proptest! {
    #![proptest_config(config(500))]

    #[test]
    fn any_bytes(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        fate(&String::from_utf8_lossy(&bytes), &[]);
    }

    #[test]
    fn any_toml(lines in proptest::collection::vec((keys(), values(), 0..4), 0..30)) {
        let line = |(key, value, kind): &(String, String, i32)| match kind {
            0 => format!("[{key}]\n"),
            1 => format!("[[{key}]]\n"),
            _ => format!("{key} = {value}\n"),
        };
        fate(&lines.iter().map(line).collect::<String>(), &[]);
    }

    #[test]
    fn any_change(
        sets in proptest::collection::vec(
            prop_oneof![
                (keys(), values()).prop_map(|(k, v)| Change::new(k, v)),
                (".{0,10}", ".{0,10}").prop_map(|(k, v)| Change::new(k, v)),
                ("(actuator|mesh|solver|load)", keys(), values()).prop_map(|(t, k, v)| Change::new(format!("{t}.{k}"), v)),
            ],
            1..4,
        ),
    ) {
        fate(&template(&two_chambers()), &sets);
    }
}

/// Texts of nearly the largest size, each of which costs much in some way.
#[test]
fn hostile_texts_are_refused() {
    const MANY: usize = 900_000;
    let least = template(&two_chambers());
    let with = |from: &str, to: String| {
        assert!(least.contains(from), "{from}");
        least.replacen(from, &to, 1)
    };
    let long = "x".repeat(MANY);
    let texts = [
        "[".repeat(MANY),
        format!("a = {}", "[".repeat(10_000)),
        format!("a = {}{}", "[".repeat(10_000), "]".repeat(10_000)),
        format!("a = {}", "{a=".repeat(10_000)),
        format!("{}a = 1", "a.".repeat(MANY / 2)),
        format!("[{}a]", "a.".repeat(MANY / 2)),
        "[a]\n[[a.b]]\n".repeat(MANY / 12),
        format!("{least}\n[{long}]"),
        format!("{least}\n[solver.{long}]"),
        with("gap = ", format!("{long} = 1\ngap = ")),
        with("part = \"half\"", format!("part = \"{long}\"")),
        with("[5, 15, 25, 35, 50]", format!("[{}]", "5, ".repeat(MANY / 3))),
        with("[5, 15, 25, 35, 50]", format!("[{}]", "\"5\", ".repeat(MANY / 5))),
        with("title = ", format!("{}title = ", (0..MANY / 10).map(|i| format!("k{i} = 1\n")).collect::<String>())),
        format!("{least}\n{}", "[[probe]]\nname = \"a\"\nat = [0, 0, 0]\n".repeat(MANY / 36)),
        format!("{least}\n{}", "[[probe]]\nname = \"a\"\nat = [nan, 0, 0]\n".repeat(MANY / 38)),
        format!("{least}\n{}", "[[probe]]\nnam = 1\n".repeat(MANY / 18)),
        format!("\u{feff}{least}\n{}", "é".repeat(MANY / 2)),
        with("size = 3.0", "size = 1e-9".into()),
        with("size = 3.0", "size = 5e-324".into()),
        with("size = 3.0", "wall_elements = 1000\nsize = [1, 1, 1]\nedge_size = 1e-300".into())
            .replace("\nwall_elements = 1 ", "\n#"),
    ];
    for text in texts {
        assert!(text.len() < 1_100_000);
        assert_eq!(fate(&text, &[]), Fate::Refused, "{:.200} … {} bytes", text, text.len());
    }
}
