//! Which designs take the guesses of their load steps from a similar one, and the files that they find these in: a matter of the designs
//! alone, not of which was finished first.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use pneuflex::Neighbour;
use toml::Value;

use crate::base::Design;
use crate::row::replace;
use crate::space::is_count;

/// Numbers that differ by no more than this share of the larger one are near.
const NEAR: f64 = 0.1;

/// For every design the number of the one before it that it starts from: the nearest of those that start from none themselves. One that is
/// near to none of these starts from none, too. Further designs at the end change nothing.
fn neighbours(designs: &[Design]) -> Vec<Option<usize>> {
    let designs: Vec<Vec<(&str, Value)>> = designs.iter().map(values).collect();
    let (mut by_themselves, mut found): (Vec<usize>, _) = (Vec::new(), Vec::new());
    for (number, design) in designs.iter().enumerate() {
        let near = by_themselves.iter().filter_map(|&other| Some((distance(&designs[other], design)?, other)));
        let nearest = near.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, other)| other);
        if nearest.is_none() {
            by_themselves.push(number);
        }
        found.push(nearest);
    }
    found
}

/// Of the designs with these names, those that start from another one, each with the name of that. A design that is there twice is what it is
/// the first time.
pub fn by_name(names: &[&str], designs: &[Design]) -> BTreeMap<String, String> {
    let mut found: BTreeMap<&str, Option<&str>> = BTreeMap::new();
    for (name, neighbour) in names.iter().zip(neighbours(designs)) {
        found.entry(name).or_insert(neighbour.map(|number| names[number]));
    }
    found.into_iter().filter_map(|(name, other)| Some((name.to_owned(), other?.to_owned()))).collect()
}

fn values(design: &Design) -> Vec<(&str, Value)> {
    let value = |text: &str| {
        let table = toml::from_str::<toml::Table>(&format!("value = {text}"));
        table.map_or_else(|_| Value::from(text), |table| table["value"].clone())
    };
    let mut found: Vec<_> = design.iter().map(|(key, text)| (key.trim(), value(text))).collect();
    found.sort_by_key(|(key, _)| *key);
    found
}

/// The largest difference of their numbers, relative to the larger one; `None` for designs that are not near, or differ in anything but
/// numbers that are measured.
fn distance(a: &[(&str, Value)], b: &[(&str, Value)]) -> Option<f64> {
    if a.len() != b.len() {
        return None;
    }
    let number = |value: &Value| value.as_float().or(value.as_integer().map(|whole| whole as f64));
    a.iter().zip(b).try_fold(0.0_f64, |most, ((key, a), (other, b))| {
        if key != other {
            return None;
        }
        if a == b {
            return Some(most);
        }
        let (a, b) = number(a).zip(number(b)).filter(|_| !is_count(key))?;
        let difference = (a - b).abs() / a.abs().max(b.abs());
        (difference <= NEAR).then_some(most.max(difference))
    })
}

/// The folder of the designs' equilibria in that of the sweep.
fn folder(sweep: &Path) -> PathBuf {
    sweep.join("neighbours")
}

fn file(sweep: &Path, identity: &str) -> PathBuf {
    folder(sweep).join(format!("{identity}.bin"))
}

/// What a design has left for others; none if it is not there, or damaged: they begin at rest then, and come to the same.
pub fn read(sweep: &Path, identity: &str) -> Option<Neighbour> {
    Neighbour::from_bytes(&fs::read(file(sweep, identity)).ok()?)
}

/// Leaves what a design has found for others, in the folder of a sweep if that can be reached. They can do without where it cannot be written.
pub fn keep(sweep: &Path, identity: &str, neighbour: &Neighbour) {
    let _ = fs::create_dir(folder(sweep));
    if let Ok(bytes) = neighbour.to_bytes() {
        let _ = replace(&file(sweep, identity), &bytes);
    }
}

/// Removes what designs have left: all are finished.
pub fn forget(sweep: &Path) {
    let _ = fs::remove_dir_all(folder(sweep));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_starts_from_whom_depends_on_the_designs_before_alone() {
        let of = |gap: &str, chambers: &str| -> Design {
            vec![("actuator.gap".into(), gap.into()), ("actuator.chambers".into(), chambers.into())]
        };
        let designs = [
            of("1", "3"),
            of("1.05", "3"),
            of("1.2", "3"),
            of("1.12", "3"),
            of("1.1", "3"),
            of("1.1", "30"),
            of("1.1", "31"),
        ];
        let found = neighbours(&designs);
        assert_eq!(found, [None, Some(0), None, Some(2), Some(2), None, None]);
        assert_eq!(neighbours(&designs[..4]), found[..4]);
        let names = ["a", "b", "c", "b"];
        assert_eq!(by_name(&names, &designs[..4]), [("b".to_owned(), "a".to_owned())].into());
        // The order of keys makes no difference, other words do.
        let mut turned = of("1.02", "3");
        turned.reverse();
        let named = vec![("actuator.gap".to_owned(), "1".to_owned()), ("title".to_owned(), "\"a\"".to_owned())];
        assert_eq!(neighbours(&[of("1", "3"), turned, named]), [None, Some(0), None]);
    }
}
