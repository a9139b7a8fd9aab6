//! The tests that texts name.

use crate::law::Mode;
use crate::words::words_of;

/// The test that a text names, by its usual names and abbreviations.
pub fn find(text: &str) -> Option<Mode> {
    let words = words_of(text);
    let joined = words.concat();
    let has = |parts: &[&str]| parts.iter().any(|p| joined.contains(p));
    let is = |names: &[&str]| words.iter().any(|w| names.contains(&w.as_str()));
    let found = [
        has(&["uniaxial", "einachsig"])
            || is(&["ut", "ua", "uni", "tension", "tensile", "compression", "zugversuch", "druckversuch"]),
        has(&["biaxial", "zweiachsig"]) || is(&["et", "eb", "bt", "ebt", "equi"]),
        has(&["planar", "pureshear"]) || is(&["ps"]),
    ];
    // "Planar tension" and "equibiaxial tension" are no uniaxial tests.
    match found {
        [_, true, true] => None,
        [_, true, _] => Some(Mode::Equibiaxial),
        [_, _, true] => Some(Mode::Planar),
        [true, ..] => Some(Mode::Uniaxial),
        _ => None,
    }
}

/// The test that a sentence or a name is about, by clear words alone: abbreviations stand in for too much else.
pub fn find_spelled_out(text: &str) -> Option<Mode> {
    let long: Vec<String> = words_of(text).into_iter().filter(|word| word.len() > 3).collect();
    // "Pure shear" and "equi-biaxial" are two words.
    find(&long.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tests_have_many_names() {
        for (text, mode) in [
            ("UT", Some(Mode::Uniaxial)),
            ("uniaxial_stress", Some(Mode::Uniaxial)),
            ("ET", Some(Mode::Equibiaxial)),
            ("Equi-biaxial", Some(Mode::Equibiaxial)),
            ("pure shear", Some(Mode::Planar)),
            ("planar tension", Some(Mode::Planar)),
            ("simple shear", None),
            ("stress", None),
        ] {
            assert_eq!(find(text), mode, "{text}");
        }
    }
}
