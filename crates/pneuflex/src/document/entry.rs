//! Keys of single chambers, `actuator.gap[3]`: one entry of what may be given for every chamber. They count from 1, as chambers do.

use std::ops::Range;

use pneuflex_mesh::LENGTHS_PER_CHAMBER;
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

/// Whether a key may have an entry for every chamber.
pub fn is_per_chamber(key: &str) -> bool {
    let of_actuator = key.strip_prefix("actuator.").is_some_and(|name| LENGTHS_PER_CHAMBER.contains(&name));
    of_actuator || key == "load.chamber_factor"
}

/// The key of the list and the number of the entry, of a key such as `actuator.gap[3]`; `None` for another one.
pub fn split(key: &str) -> Option<(&str, usize)> {
    let (list, number) = key.trim().strip_suffix(']')?.split_once('[')?;
    let (list, number) = (list.trim(), number.trim().parse().ok()?);
    is_per_chamber(list).then_some((list, number))
}

/// The brackets in such a key.
pub fn brackets(key: &str) -> Range<usize> {
    key.find('[').unwrap_or(0)..key.rfind(']').map_or(0, |end| end + 1)
}

/// Sets entry `number` of a list. A number for all becomes a list first.
///
/// # Errors
/// Why there is no such entry, in words behind the key.
pub fn set<'a>(
    document: &mut DeTable<'a>,
    (list, number): (&str, usize),
    value: Spanned<DeValue<'a>>,
) -> Result<(), String> {
    let chambers = number_of_chambers(document);
    let (table, name) = list.split_once('.').unwrap_or(("", list));
    let Some(DeValue::Table(table)) = document.get_mut(table).map(Spanned::get_mut) else {
        return Err(format!("there is no [{table}] here"));
    };
    if !table.contains_key(name) && list == "load.chamber_factor" {
        // In all the others the pressure itself.
        let one = DeTable::parse("one = 1.0").ok().and_then(|table| table.into_inner().remove("one"));
        let one = one.map(|one| Spanned::new(value.span(), one.into_inner()));
        one.and_then(|one| table.insert(Spanned::new(value.span(), name.to_owned().into()), one));
    }
    let Some(given) = table.get_mut(name) else { return Err(format!("{list} is not given")) };
    let span = given.span();
    if let DeValue::Integer(_) | DeValue::Float(_) = given.get_ref() {
        // Without a number of chambers there is another message.
        let Some(chambers) = chambers else { return Ok(()) };
        let count = if list == "actuator.gap" { chambers.saturating_sub(1) } else { chambers };
        let all: DeArray<'a> = (0..count).map(|_| given.clone()).collect();
        *given = Spanned::new(span, DeValue::Array(all));
    }
    // What is no list is complained about when it is read.
    let DeValue::Array(entries) = given.get_mut() else { return Ok(()) };
    let count = entries.len();
    match number.checked_sub(1).and_then(|index| entries.get_mut(index)) {
        Some(entry) => *entry = value,
        None if count == 0 => return Err(format!("{list} has no entries: there are no gaps")),
        None => return Err(format!("{list} has entries from 1 to {count}")),
    }
    Ok(())
}

/// `None` if it is not given, or more than any actuator has.
fn number_of_chambers(document: &DeTable<'_>) -> Option<usize> {
    let chambers = document.get("actuator")?.get_ref().as_table()?.get("chambers")?.get_ref().as_integer()?;
    let number = usize::from_str_radix(&chambers.as_str().replace('_', ""), chambers.radix()).ok()?;
    (number <= 10_000).then_some(number)
}
