//! Keys, and the places in a document that they stand for: `material.c10`, `obstacle[0].centre.z`, `region.sole.material.c10`, `actuator.gap[3]`.
//!
//! A full stop goes into a table, or along x, y or z in a list of three numbers; a number in brackets goes to an entry of a list. Tables count from
//! 0, as in messages and results; numbers count from 1, as chambers do. A table of a list may also be called by its `name`.

use std::ops::Range;

use pneuflex_mesh::LENGTHS_PER_CHAMBER;
use toml::de::{DeArray, DeTable, DeValue};
use toml::{Spanned, Value};

/// Names of the entries of a vector.
const AXES: [&str; 3] = ["x", "y", "z"];

/// A factor of which a file need not speak: it is 1 for all chambers.
const CHAMBER_FACTOR: &str = "load.chamber_factor";

/// A step on the way to a place in a document.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// Into a table.
    Key(String),
    /// To an entry of a list, from 0.
    Item(usize),
}

/// A part of a key.
#[derive(Clone, Debug, PartialEq)]
enum Part {
    Name(String),
    /// What stands in brackets, with these.
    Number(usize, Range<usize>),
}

/// The parts of a key; `None` for what is none.
fn parts(key: &str) -> Option<Vec<Part>> {
    let mut found = Vec::new();
    let mut rest = key;
    loop {
        rest = rest.trim_start();
        let at = key.len() - rest.len();
        if let Some(inside) = rest.strip_prefix('[').filter(|_| !found.is_empty()) {
            let end = inside.find(']')?;
            found.push(Part::Number(inside[..end].trim().parse().ok()?, at..at + end + 2));
            rest = &inside[end + 1..];
        } else {
            let rest_of_key = if found.is_empty() { rest } else { rest.strip_prefix('.')?.trim_start() };
            let (name, behind) = name(rest_of_key)?;
            found.push(Part::Name(name.to_owned()));
            rest = behind;
        }
        if rest.trim().is_empty() {
            return Some(found);
        }
    }
}

/// The name at the beginning of a text, without quotes, and what is behind it.
fn name(text: &str) -> Option<(&str, &str)> {
    if let Some(quote) = text.chars().next().filter(|first| ['"', '\''].contains(first)) {
        return text[1..].split_once(quote);
    }
    let end = text.find(['.', '[']).unwrap_or(text.len());
    let name = text[..end].trim();
    (!name.is_empty()).then_some((name, &text[end..]))
}

/// Where numbers of entries stand in a key, with their brackets: the rest is a key of TOML.
pub fn brackets(key: &str) -> Vec<Range<usize>> {
    let number = |part| if let Part::Number(_, range) = part { Some(range) } else { None };
    parts(key).into_iter().flatten().filter_map(number).collect()
}

/// How many names a key has: 2 of `actuator.gap[3]`.
pub fn names(key: &str) -> usize {
    parts(key).map_or(1, |parts| parts.iter().filter(|part| matches!(part, Part::Name(_))).count())
}

/// Whether a key may have an entry for every chamber.
fn is_per_chamber(key: &str) -> bool {
    let of_actuator = key.strip_prefix("actuator.").is_some_and(|name| LENGTHS_PER_CHAMBER.contains(&name));
    of_actuator || key == CHAMBER_FACTOR
}

/// The number of the first entry of a list: 1 of numbers, 0 of tables and lists.
pub fn first_number<T>(list: &[T], is_nested: impl Fn(&T) -> bool) -> usize {
    usize::from(!list.iter().any(is_nested))
}

/// How many entries a number at a place stands for that may be given for every chamber, or gap; `None` for another one, and without a number of
/// chambers, or more than any actuator has.
pub fn entries(document: &Value, place: &[Step]) -> Option<usize> {
    let [Step::Key(table), Step::Key(name)] = place else { return None };
    if !is_per_chamber(&format!("{table}.{name}")) {
        return None;
    }
    let chambers = document.get("actuator")?.get("chambers")?.as_integer()?;
    let chambers = usize::try_from(chambers).ok().filter(|number| *number <= 10_000)?;
    Some(if name == "gap" { chambers.saturating_sub(1) } else { chambers })
}

/// The place that a key stands for. What it names in tables need not exist, entries of lists must.
///
/// # Errors
/// Why there is no such place, in words behind the key.
pub fn resolve(document: &Value, key: &str) -> Result<Vec<Step>, String> {
    let parts = parts(key).ok_or("it is not a key")?;
    let (mut here, mut place, mut path) = (Some(document), Vec::new(), String::new());
    for part in parts {
        let is_in_list = place.iter().any(|step| matches!(step, Step::Item(_)));
        let step = match (&part, here) {
            (Part::Name(name), Some(Value::Array(list))) => Step::Item(named(list, &path, name)?),
            (Part::Name(_), None) if is_in_list => return Err(format!("{path} is not given")),
            (Part::Name(name), _) => Step::Key(name.clone()),
            (Part::Number(number, _), _) => Step::Item(numbered(document, (here, &place), &path, *number)?),
        };
        here = here.and_then(|value| match &step {
            Step::Key(name) => value.get(name),
            Step::Item(item) => value.get(*item),
        });
        path += &match &part {
            Part::Name(name) if path.is_empty() => name.clone(),
            Part::Name(name) => format!(".{name}"),
            Part::Number(number, _) => format!("[{number}]"),
        };
        place.push(step);
    }
    Ok(place)
}

/// The entry of a name in a list: along an axis, or the table that is called so.
fn named(list: &[Value], path: &str, name: &str) -> Result<usize, String> {
    let is_vector = list.len() == AXES.len() && !list.iter().any(|entry| entry.is_table() || entry.is_array());
    if let Some(axis) = AXES.iter().position(|axis| *axis == name).filter(|_| is_vector) {
        return Ok(axis);
    }
    if is_vector {
        return Err(format!("{path} has x, y and z"));
    }
    let names: Vec<&str> = list.iter().filter_map(|table| table.get("name").and_then(Value::as_str)).collect();
    match (list.iter().position(|table| table.get("name").and_then(Value::as_str) == Some(name)), &names[..]) {
        (Some(found), _) => Ok(found),
        (None, []) => Err(format!("{path} is a list: say which entry, e.g. {path}[{}]", of_list(list))),
        (None, names) => Err(format!("{path} has no entry with the name {name:?}: there are {}", names.join(", "))),
    }
}

fn of_list(list: &[Value]) -> usize {
    first_number(list, |entry| entry.is_table() || entry.is_array())
}

/// The entry of a number in what is a list, or may be one.
fn numbered(
    document: &Value,
    (here, place): (Option<&Value>, &[Step]),
    path: &str,
    number: usize,
) -> Result<usize, String> {
    let (first, count) = match here {
        Some(Value::Array(list)) => (of_list(list), list.len()),
        None if path != CHAMBER_FACTOR || document.get("load").is_none() => {
            return Err(format!("{path} is not given"));
        }
        None | Some(Value::Float(_) | Value::Integer(_)) if is_per_chamber(path) => {
            // Without a number of chambers there is another message.
            (1, entries(document, place).unwrap_or(usize::MAX))
        }
        _ => return Err(format!("{path} is no list")),
    };
    let item = number.checked_sub(first).filter(|item| *item < count);
    item.ok_or_else(|| match count {
        0 if path == "actuator.gap" => format!("{path} has no entries: there are no gaps"),
        0 => format!("{path} has no entries"),
        _ => format!("{path} has entries from {first} to {}", first + count - 1),
    })
}

/// Puts a value at a place. A number for all chambers becomes a list first, of so many entries; without a number of these everything stays as it is.
pub fn set<'a>(document: &mut DeTable<'a>, place: &[Step], entries: Option<usize>, value: Spanned<DeValue<'a>>) {
    let [Step::Key(name), rest @ ..] = place else { return };
    let span = value.span();
    if rest.is_empty() {
        // An insertion would keep the old key with its old place.
        document.remove(name.as_str());
        document.insert(Spanned::new(span, name.clone().into()), value);
        return;
    }
    if !document.contains_key(name.as_str()) {
        let empty = match rest {
            [Step::Item(_)] => one(),
            _ => Some(DeValue::Table(DeTable::new())),
        };
        let Some(empty) = empty else { return };
        document.insert(Spanned::new(span.clone(), name.clone().into()), Spanned::new(span, empty));
    }
    if let Some(inner) = document.get_mut(name.as_str()) {
        set_in(inner, rest, entries, value);
    }
}

fn set_in<'a>(here: &mut Spanned<DeValue<'a>>, place: &[Step], entries: Option<usize>, value: Spanned<DeValue<'a>>) {
    let Some((step, rest)) = place.split_first() else {
        *here = value;
        return;
    };
    if let (Step::Item(_), DeValue::Integer(_) | DeValue::Float(_)) = (step, here.get_ref()) {
        let all: DeArray<'a> = (0..entries.unwrap_or_default()).map(|_| here.clone()).collect();
        if all.is_empty() {
            return;
        }
        *here = Spanned::new(here.span(), DeValue::Array(all));
    }
    match (here.get_mut(), step) {
        (DeValue::Table(table), Step::Key(_)) => set(table, place, entries, value),
        (DeValue::Array(list), Step::Item(item)) => {
            if let Some(entry) = list.get_mut(*item) {
                set_in(entry, rest, entries, value);
            }
        }
        // What is no list is complained about when it is read.
        _ => {}
    }
}

/// What a factor is that is not given.
fn one() -> Option<DeValue<'static>> {
    Some(DeTable::parse("one = 1.0").ok()?.into_inner().remove("one")?.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn document() -> Value {
        Value::Table(
            toml::from_str(
                "actuator = { chambers = 3, gap = 2.0, side_wall = [1.0, 2.0, 3.0], width = 20.0 }\nload = { pressure_kpa = [5, 10] }\n\
                 obstacle = [{ name = \"table\", point = [0.0, 0.0, -3.0] }, { name = \"ball\", radius = 2.0 }]\nforce = [{ total = [1.0, 2.0, 3.0] }]",
            )
            .unwrap(),
        )
    }

    #[test]
    fn keys_stand_for_places() {
        use Step::{Item, Key};
        let key = |name: &str| Key(name.to_owned());
        for (text, place) in [
            ("actuator.width", vec![key("actuator"), key("width")]),
            (" actuator . gap [ 2 ]", vec![key("actuator"), key("gap"), Item(1)]),
            ("actuator.side_wall[3]", vec![key("actuator"), key("side_wall"), Item(2)]),
            ("load.chamber_factor[3]", vec![key("load"), key("chamber_factor"), Item(2)]),
            ("load.pressure_kpa[2]", vec![key("load"), key("pressure_kpa"), Item(1)]),
            ("obstacle[0].point.z", vec![key("obstacle"), Item(0), key("point"), Item(2)]),
            ("obstacle.ball.radius", vec![key("obstacle"), Item(1), key("radius")]),
            ("obstacle.'ball'.stiffness", vec![key("obstacle"), Item(1), key("stiffness")]),
            ("force[0].total[1]", vec![key("force"), Item(0), key("total"), Item(0)]),
            ("mesh.size", vec![key("mesh"), key("size")]),
        ] {
            assert_eq!(resolve(&document(), text), Ok(place), "{text}");
        }
        assert_eq!((names("obstacle[0].point.z"), brackets("a[1].b [ 20 ]")), (3, vec![1..4, 7..13]));
    }

    #[test]
    fn what_stands_for_no_place_is_told_why() {
        for (text, words) in [
            ("actuator.gap[3]", "actuator.gap has entries from 1 to 2"),
            ("actuator.gap[0]", "from 1 to 2"),
            ("actuator.width[1]", "actuator.width is no list"),
            ("obstacle[2].radius", "obstacle has entries from 0 to 1"),
            ("obstacle.tabel.radius", "obstacle has no entry with the name \"tabel\": there are table, ball"),
            ("obstacle[1].centre.x", "obstacle[1].centre is not given"),
            ("obstacle[0].point.w", "obstacle[0].point has x, y and z"),
            ("obstacle[0].point[4]", "obstacle[0].point has entries from 1 to 3"),
            ("force.total.x", "force is a list: say which entry, e.g. force[0]"),
            ("region[0].material.c10", "region is not given"),
            ("actuator.gap[x]", "not a key"),
            ("actuator..gap", "not a key"),
            ("[1].gap", "not a key"),
            ("actuator.gap[1", "not a key"),
        ] {
            let why = resolve(&document(), text).unwrap_err();
            assert!(why.contains(words), "{text}: {why}");
        }
    }
}
