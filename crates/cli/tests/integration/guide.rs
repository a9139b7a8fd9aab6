//! The user guide: its commands run, its outputs are those of the program, its links lead somewhere, and its reference of the case
//! file is complete.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use crate::support::{Ended, Scratch, alone, ended};

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn guide() -> PathBuf {
    repository().join("docs/guide/src")
}

fn chapter(name: &str) -> String {
    fs::read_to_string(guide().join(name)).unwrap()
}

/// A fenced block: the words after its fence, its first line's number in the chapter, its text.
struct Block {
    info: Vec<String>,
    line: usize,
    text: String,
}

impl Block {
    fn is(&self, language: &str, word: &str) -> bool {
        self.info.first().is_some_and(|l| l == language) && self.info[1..].iter().any(|w| w == word)
    }

    fn value(&self, key: &str) -> Option<&str> {
        self.info.iter().find_map(|word| word.strip_prefix(key)?.strip_prefix('='))
    }
}

fn blocks(chapter: &str) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut is_open = false;
    for (number, line) in chapter.lines().enumerate() {
        match line.strip_prefix("```") {
            Some(info) if !is_open => {
                let info = info.split_whitespace().map(str::to_owned).collect();
                blocks.push(Block { info, line: number + 2, text: String::new() });
                is_open = true;
            }
            Some(_) => is_open = false,
            None if is_open => blocks.last_mut().unwrap().text += &format!("{line}\n"),
            None => {}
        }
    }
    assert!(!is_open, "a block is not closed");
    blocks
}

/// Runs a block with the shell in the scratch folder, with the program on the path.
fn shell(scratch: &Scratch, script: &str) -> Ended {
    let program = Path::new(env!("CARGO_BIN_EXE_pneuflex")).parent().unwrap();
    let mut path = vec![program.to_owned()];
    path.extend(std::env::split_paths(&std::env::var_os("PATH").unwrap()));
    let mut command = alone("sh");
    command.args(["-e", "-c", script]).current_dir(scratch.path(".")).env("PATH", std::env::join_paths(path).unwrap());
    ended(command.output().unwrap())
}

/// Whether a line stands for another one; `…` is any text.
fn stands_for(line: &str, real: &str) -> bool {
    let mut pieces = line.split('…');
    let Some(mut rest) = real.trim().strip_prefix(pieces.next().unwrap_or("")) else { return false };
    for piece in pieces {
        let Some(at) = rest.find(piece) else { return false };
        rest = &rest[at + piece.len()..];
    }
    rest.is_empty() || line.ends_with('…')
}

fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy_folder(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// Runs everything in a chapter.
#[track_caller]
fn works(name: &str) {
    let scratch = Scratch::new(&format!("guide-{name}"));
    copy_folder(&repository().join("fixtures"), &scratch.path("fixtures"));
    let mut last: Option<Ended> = None;
    for block in blocks(&chapter(name)) {
        let place = format!("{name}:{}", block.line);
        if let Some(file) = block.value("file") {
            fs::write(scratch.path(file), &block.text).unwrap();
        } else if let Some(file) = block.value("shown") {
            let text = fs::read_to_string(repository().join(file)).unwrap();
            let mut lines = text.lines().filter(|line| !line.is_empty());
            let missing = block.text.lines().filter(|line| !line.is_empty()).find(|&line| !lines.any(|l| l == line));
            assert!(missing.is_none(), "{place}: {missing:?} (in this order) is not in {file}");
        } else if block.is("sh", "by-hand") {
            // What a test cannot run may only be the installation.
            assert!(block.text.lines().all(|line| line.starts_with("cargo install ")), "{place}");
        } else if block.info[0] == "sh" {
            let code: i32 = block.value("exit").map_or(0, |code| code.parse().unwrap());
            let ended = shell(&scratch, &block.text);
            assert_eq!(ended.code, code, "{place}: {}{ended:?}", block.text);
            last = Some(ended);
        } else {
            assert!(block.is("text", "output"), "{place}: what is a block of {:?}?", block.info);
            let ended = last.as_ref().unwrap();
            let mut real = ended.out.lines().chain(ended.err.lines());
            for line in block.text.lines().map(str::trim) {
                assert!(
                    real.any(|r| stands_for(line, r)),
                    "{place}: `{line}` (in this order) is not in {}{}",
                    ended.out,
                    ended.err
                );
            }
        }
    }
    assert!(last.is_some(), "{name} has no command");
}

#[test]
fn first_run() {
    works("first-run.md");
}

/// The chapter's part is drawn and meshed by Gmsh.
#[test]
fn from_cad() {
    if pneuflex::cad::has_gmsh() {
        works("from-cad.md");
    } else {
        eprintln!("passed over: Gmsh is not there (pip install gmsh)");
    }
}

#[test]
fn results() {
    works("results.md");
}

#[test]
fn compare() {
    works("compare.md");
}

#[test]
fn export() {
    works("export.md");
}

#[test]
fn geometry() {
    works("geometry.md");
}

#[test]
fn material() {
    works("material.md");
}

#[test]
fn models() {
    works("models.md");
}

#[test]
fn model_file() {
    works("model-file.md");
}

#[test]
fn accuracy() {
    works("accuracy.md");
}

#[test]
fn obstacles() {
    works("obstacles.md");
}

#[test]
fn stops() {
    works("stops.md");
}

#[test]
fn resume() {
    works("resume.md");
}

#[test]
fn sweeps() {
    works("sweeps.md");
}

#[test]
fn design() {
    works("design.md");
}

#[test]
fn rod() {
    works("rod.md");
}

#[test]
fn gallery() {
    works("gallery.md");
}

#[test]
fn faq() {
    works("faq.md");
}

/// Who follows all chapters in one folder never meets a file of an earlier one: `pneuflex new` replaces none.
#[test]
fn no_two_chapters_make_the_same_file() {
    let mut made: BTreeMap<String, String> = BTreeMap::new();
    for name in chapter("SUMMARY.md").split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
        for block in blocks(&chapter(name)) {
            let new_cases = block.text.lines().filter_map(|line| line.strip_prefix("pneuflex new ")).map(|words| {
                let mut words = words.split_whitespace();
                let kind = words.next().unwrap_or_default().replace('-', "_");
                words.next().map_or(format!("{kind}.toml"), str::to_owned)
            });
            for file in new_cases.chain(block.value("file").map(str::to_owned)) {
                let before = made.insert(file.clone(), name.to_owned());
                assert!(before.is_none(), "{file} is made in {name} and in {before:?}");
            }
        }
    }
    assert!(made.len() > 10, "{made:?}");
}

/// What a link to a heading ends with: its letters, digits, hyphens and underscores in small letters, joined by hyphens.
fn anchor(line: &str) -> Option<String> {
    let heading = line.strip_prefix('#')?.trim_start_matches('#').trim().to_lowercase();
    let kept = heading.chars().filter(|c| c.is_alphanumeric() || [' ', '-', '_'].contains(c));
    Some(kept.map(|c| if c == ' ' { '-' } else { c }).collect())
}

#[test]
fn the_summary_lists_every_chapter_and_links_lead_somewhere() {
    let summary = chapter("SUMMARY.md");
    for entry in fs::read_dir(guide()).unwrap() {
        let name = entry.unwrap().file_name().to_string_lossy().into_owned();
        if !name.ends_with(".md") {
            continue;
        }
        assert!(name == "SUMMARY.md" || summary.contains(&format!("({name})")), "{name} is not in SUMMARY.md");
        let text = chapter(&name);
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            let (file, heading) = link.split_once('#').map_or((link, None), |(file, heading)| (file, Some(heading)));
            assert!(link.starts_with("https://") || guide().join(file).is_file(), "{name}: {link}");
            if let Some(heading) = heading.filter(|_| !link.starts_with("https://")) {
                assert!(chapter(file).lines().any(|line| anchor(line) == Some(heading.into())), "{name}: {link}");
            }
        }
    }
    let book = fs::read_to_string(guide().join("../book.toml")).unwrap();
    assert!(book.parse::<toml::Table>().unwrap()["book"]["src"].as_str() == Some("src"));
}

/// A line of the reference: key, default, allowed values.
struct Row {
    key: String,
    default: String,
    allowed: String,
}

impl Row {
    /// The words between backquotes where they are all that is allowed.
    fn choices(&self) -> Vec<String> {
        let is_list =
            self.allowed.split(", ").all(|word| word.len() > 2 && word.starts_with('`') && word.ends_with('`'));
        let words = self.allowed.split(", ").map(|word| word.trim_matches('`').to_owned());
        if is_list { words.collect() } else { Vec::new() }
    }

    /// `--set` with a value.
    fn set(&self, value: &str) -> String {
        if let Some(key) = self.key.strip_prefix("obstacle.") {
            return set_obstacle(key, value);
        }
        match self.key.strip_prefix("probe.") {
            Some("name") => format!("probe=[{{ name = {value}, at = [0, 0, 0] }}]"),
            Some(other) => format!("probe=[{{ name = \"a\", {other} = {value} }}]"),
            None => format!("{}={value}", self.key),
        }
    }
}

/// `--set` with an obstacle that has a key.
fn set_obstacle(key: &str, value: &str) -> String {
    let is_word =
        value.chars().all(|c| c.is_ascii_alphabetic() || c == '_') && !["true", "false", "nan"].contains(&value);
    let value = if is_word { format!("\"{value}\"") } else { value.to_owned() };
    let shape = match key {
        "shape" => value.trim_matches('"').to_owned(),
        "point" | "normal" => "plane".into(),
        "axis" => "cylinder".into(),
        "size" | "edge_radius" => "cuboid".into(),
        _ => "sphere".into(),
    };
    let needed: &[(&str, &str)] = match shape.as_str() {
        "plane" => &[("point", "[0, 0, -50]"), ("normal", "[0, 0, 1]")],
        "cylinder" => &[("point", "[0, 0, -50]"), ("axis", "[0, 1, 0]"), ("radius", "1")],
        "cuboid" => &[("centre", "[0, 0, -50]"), ("size", "[1, 1, 1]")],
        // A hollow sphere must be large enough for the actuator inside of it.
        _ if key == "hollow" && value == "true" => &[("centre", "[0, 0, 0]"), ("radius", "500")],
        _ => &[("centre", "[0, 0, -50]"), ("radius", "1")],
    };
    let shape = format!("\"{shape}\"");
    let fixed = [&[("name", "\"a\""), ("shape", &shape)], needed].concat();
    let mut entries: Vec<String> = fixed.iter().filter(|(k, _)| *k != key).map(|(k, v)| format!("{k} = {v}")).collect();
    entries.push(format!("{key} = {value}"));
    format!("obstacle=[{{ {} }}]", entries.join(", "))
}

/// The tables of a reference.
fn rows(name: &str) -> Vec<Row> {
    let text = chapter(name);
    let lines = text.lines().filter_map(|line| line.strip_prefix("| `"));
    lines
        .map(|line| {
            let cells: Vec<&str> = line.split('|').map(str::trim).collect();
            let [key, _, default, allowed, _, _] = cells[..] else { panic!("{name}: {line}") };
            Row { key: key.trim_end_matches('`').into(), default: default.into(), allowed: allowed.into() }
        })
        .collect()
}

/// The files that a chapter has.
fn with_files_of(chapter_name: &str, name: &str) -> Scratch {
    let scratch = Scratch::new(name);
    for block in blocks(&chapter(chapter_name)) {
        if let Some(file) = block.value("file") {
            fs::write(scratch.path(file), &block.text).unwrap();
        }
    }
    scratch
}

fn with_least_case(name: &str) -> Scratch {
    with_files_of("case-file.md", name)
}

/// Keys of a table that the program knows, by what it says about one that it does not know.
fn known_keys(scratch: &Scratch, file: &str, set: &str) -> Vec<String> {
    let ended = scratch.run(&["check", file, "--set", set]);
    let (_, known) = ended.err.split_once("known keys here: ").unwrap_or_else(|| panic!("{set}: {ended:?}"));
    known.lines().next().unwrap().split(", ").map(str::to_owned).collect()
}

/// All keys that may stand in a file; `lists` are its tables that may be repeated.
fn all_keys(scratch: &Scratch, file: &str, lists: &[&str]) -> Vec<String> {
    let mut known = Vec::new();
    for table in known_keys(scratch, file, "qqq=1") {
        if table == "title" {
            known.push(table);
            continue;
        }
        let is_list = lists.contains(&table.as_str());
        let set = if is_list { format!("{table}=[{{ qqq = 1 }}]") } else { format!("{table}.qqq=1") };
        for key in known_keys(scratch, file, &set) {
            let path = format!("{table}.{key}");
            if path == "actuator.channel" {
                let inner = known_keys(scratch, file, "actuator.channel.qqq=1");
                known.extend(inner.iter().map(|key| format!("{path}.{key}")));
            } else {
                known.push(path);
            }
        }
    }
    known.sort();
    known
}

#[test]
fn the_reference_has_exactly_the_keys_of_the_program() {
    let scratch = with_least_case("guide-keys");
    let mut described: Vec<String> = rows("case-file.md").into_iter().map(|row| row.key).collect();
    described.sort();
    assert_eq!(described, all_keys(&scratch, "least.toml", &["probe", "obstacle"]));
}

/// Tables that it refers to the other reference for are those of the other reference.
#[test]
fn the_reference_of_models_has_exactly_the_keys_of_the_program() {
    let scratch = with_files_of("model-file.md", "guide-model-keys");
    let text = chapter("model-file.md");
    let mut described: Vec<String> = rows("model-file.md").into_iter().map(|row| row.key).collect();
    for table in ["actuator", "mesh", "material", "probe", "output"] {
        assert!(text.contains(&format!("[{table}]")), "{table}");
        let prefix = format!("{table}.");
        described.extend(rows("case-file.md").into_iter().map(|row| row.key).filter(|key| key.starts_with(&prefix)));
    }
    described.sort();
    let lists = ["region", "support", "equation", "cavity", "force", "traction", "pressure", "contact", "obstacle"];
    let lists = [&lists[..], &["probe"]].concat();
    assert_eq!(described, all_keys(&scratch, "least-model.toml", &lists));
}

#[test]
fn the_reference_of_models_says_what_is_required_and_no_key_takes_what_is_no_number() {
    let scratch = with_files_of("model-file.md", "guide-model-values");
    let (text, rows) = (chapter("model-file.md"), rows("model-file.md"));
    let mut compared = 0;
    for row in &rows {
        let Some((table, key)) = row.key.split_once('.') else { continue };
        let set = |inner: &str| match text.contains(&format!("[[{table}]]")) {
            true => format!("{table}=[{{ {inner} }}]"),
            false => format!("{table}={{ {inner} }}"),
        };
        let said = |set: &str| {
            let bad = scratch.run(&["check", "least-model.toml", "--set", set]);
            assert_eq!(bad.code, 2, "{set}: {bad:?}");
            bad.err
        };
        let wrong = set(&format!("{key} = nan"));
        assert!(said(&wrong).contains(key), "{wrong}");
        let is_first = rows.iter().find(|other| other.key.starts_with(&format!("{table}."))).unwrap().key == row.key;
        // The file that the body comes from is there already; the others need nothing.
        if !is_first || ["model", "load", "solver"].contains(&table) {
            continue;
        }
        let refused = said(&set(""));
        let mut missing: Vec<&str> = refused
            .lines()
            .filter_map(|line| line.split('`').nth(1).filter(|_| line.ends_with("is missing")))
            .collect();
        let missing_keys = missing.iter_mut().map(|key| key.rsplit('.').next().unwrap());
        let required = rows.iter().filter(|row| row.default == "required");
        let required_keys = required.filter_map(|row| row.key.strip_prefix(&format!("{table}.")));
        assert!(missing_keys.eq(required_keys), "{table}: {refused}");
        compared += 1;
    }
    assert_eq!(compared, 10);
}

#[test]
fn the_reference_has_the_program_s_defaults() {
    let scratch = with_least_case("guide-defaults");
    // Required keys are those without which the case is refused.
    let least: toml::Table = fs::read_to_string(scratch.path("least.toml")).unwrap().parse().unwrap();
    let ended =
        scratch.run(&["run", "least.toml", "--quiet", "--no-report", "--set", "mesh.resolution=draft", "--out", "out"]);
    assert_eq!(ended.code, 0, "{ended:?}");
    let resolved: toml::Table = fs::read_to_string(scratch.path("out/case.toml")).unwrap().parse().unwrap();
    let find = |table: &toml::Table, key: &str| {
        let mut value = toml::Value::Table(table.clone());
        for part in key.split('.') {
            value = value.get(part)?.clone();
        }
        Some(value)
    };
    let mut compared = 0;
    for row in
        rows("case-file.md").iter().filter(|row| !row.key.starts_with("probe.") && !row.key.starts_with("obstacle."))
    {
        assert_eq!(row.default == "required", find(&least, &row.key).is_some(), "{}", row.key);
        let Some(default) = row.default.strip_prefix('`').and_then(|d| d.strip_suffix('`')) else { continue };
        if row.key == "mesh.resolution" {
            continue;
        }
        let value = find(&resolved, &row.key).unwrap_or_else(|| panic!("{}", row.key));
        let is_same = match value.as_float() {
            Some(number) => default.parse() == Ok(number),
            None => value.to_string() == default || value.as_str() == Some(default.trim_matches('"')),
        };
        assert!(is_same, "{}: {value} is not {default}", row.key);
        compared += 1;
    }
    assert!(compared > 15, "{compared}");
}

#[test]
fn the_reference_has_the_choices_of_the_program_and_every_key_is_checked() {
    let scratch = with_least_case("guide-choices");
    let check = |set: &str| scratch.run(&["check", "least.toml", "--set", "mesh.size=4", "--set", set]);
    for row in rows("case-file.md") {
        let bad = check(&row.set("nan"));
        let name = row.key.rsplit('.').next().unwrap();
        assert!(bad.code == 2 && bad.err.contains(name), "{}: {bad:?}", row.key);
        let choices = row.choices();
        for choice in &choices {
            let constants = match (row.key.as_str(), choice.as_str()) {
                ("material.law", "mooney-rivlin" | "polynomial") => ", c10=0.1, c01=0.1",
                ("material.law", "ogden") => ", mu=[0.1], alpha=[2]",
                ("material.law", "gent") => ", shear_modulus=0.2, jm=30",
                ("material.law", _) => ", c10=0.1",
                _ => "",
            };
            let set = match constants {
                "" => row.set(choice),
                constants => format!("material={{ law=\"{choice}\"{constants} }}"),
            };
            let good = check(&set);
            assert_eq!(good.code, 0, "{} = {choice}: {good:?}", row.key);
        }
        if choices.len() > 1 && choices[0] != "true" {
            let other = check(&row.set("qqq")).err;
            let (_, allowed) = other.split_once("one of ").unwrap_or_else(|| panic!("{other}"));
            let mut allowed: Vec<&str> = allowed.lines().next().unwrap().split(", ").collect();
            let mut choices: Vec<&str> = choices.iter().map(String::as_str).collect();
            allowed.sort_unstable();
            choices.sort_unstable();
            assert_eq!(choices, allowed, "{}", row.key);
        }
    }
}
