//! The kinds of designs whose errors are measured: each differs from two chambers of the paper's actuator in what its name says.

use pneuflex::{Change, Error, Study, template};

/// A kind of design, by an example of it.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// Short name.
    pub name: &'static str,
    /// What it stands for.
    pub what: &'static str,
    /// Where its case file comes from.
    pub base: Base,
    /// Keys that are set in it.
    pub changes: &'static [(&'static str, &'static str)],
    /// Pressures, kPa.
    pub pressures: &'static str,
    /// Whether a mesh finer than `fine` is solved. Where it is not, `fine` is what the others are compared with.
    pub has_finer: bool,
    /// Whether it is among those of `--quick`.
    pub is_quick: bool,
}

/// A case file that kinds are made from.
#[derive(Clone, Copy, Debug)]
pub enum Base {
    /// Two chambers of the paper's actuator.
    TwoChambers,
    /// The paper's actuator.
    EightChambers,
    /// A file of its own.
    File(&'static str),
}

impl Kind {
    /// The kind's case.
    ///
    /// # Errors
    /// A change that a case file does not take.
    pub fn study(&self) -> Result<Study, Error> {
        let text = match self.base {
            Base::TwoChambers => template::two_chambers(),
            Base::EightChambers => template::full_actuator(),
            Base::File(text) => text.to_owned(),
        };
        let mut study = Study::from_text(&format!("{}.toml", self.name), &text)?;
        let changes = self.changes.iter().map(|&(key, value)| Change::new(key, value));
        let always = [("load.pressure_kpa", self.pressures), ("output.fields", "false")];
        study.set_all(changes.chain(always.map(|(key, value)| Change::new(key, value))))?;
        Ok(study)
    }
}

/// One chamber that differs from the paper's in a few lengths. Its flanges carry what a second chamber would.
const fn one(
    name: &'static str,
    what: &'static str,
    changes: &'static [(&'static str, &'static str)],
    pressures: &'static str,
) -> Kind {
    Kind { name, what, base: Base::TwoChambers, changes, pressures, has_finer: false, is_quick: false }
}

/// All kinds.
pub const KINDS: &[Kind] = &[
    Kind {
        base: Base::EightChambers,
        ..one("eight chambers", "the paper's actuator, before and after first touch", &[], "[15, 50]")
    },
    Kind {
        has_finer: true,
        is_quick: true,
        ..one("two chambers", "the paper's piece, before, at and after first touch", &[], "[15, 25, 50]")
    },
    Kind { has_finer: true, is_quick: true, ..one("one chamber", "nothing touches", &[ONE, FLANGE], "[15, 50]") },
    one("small gap", "0.5 mm: pressed from the beginning", &[("actuator.gap", "0.5")], "[5, 25, 50]"),
    one("soft", "0.3 of the shear modulus and no more: bends strongly", SOFT, "[5, 12, 25]"),
    one(
        "thin walls",
        "all walls 0.5 mm",
        &[ONE, FLANGE, ("actuator.cavity_length", "7.0"), ("actuator.side_wall", "0.5"), ("actuator.top_wall", "0.5")],
        "[5, 15]",
    ),
    one("thin top wall", "0.4 mm, all other walls 1 mm", &[ONE, FLANGE, ("actuator.top_wall", "0.4")], "[5, 15]"),
    Kind {
        has_finer: true,
        ..one(
            "thick walls",
            "all walls 2 mm",
            &[
                ONE,
                FLANGE,
                ("actuator.chamber_length", "10.0"),
                ("actuator.side_wall", "2.0"),
                ("actuator.top_wall", "2.0"),
            ],
            "[40, 120]",
        )
    },
    Kind {
        has_finer: true,
        ..one(
            "thin base",
            "1.5 mm, with 0.4 mm below and above the channel",
            &[
                ONE,
                FLANGE,
                ("actuator.base", "1.5"),
                ("actuator.height", "10.5"),
                ("actuator.channel.bottom", "0.4"),
                ("actuator.channel.top", "1.1"),
            ],
            "[6, 20]",
        )
    },
    one("thick base", "7 mm", &[ONE, FLANGE, ("actuator.base", "7.0"), ("actuator.height", "16.0")], "[20, 60]"),
    one("no channel", "a solid base", &[ONE, FLANGE, ("actuator.channel.half_width", "0.0")], "[15, 50]"),
    one("thin floor", "0.3 mm below the channel", &[ONE, FLANGE, ("actuator.channel.bottom", "0.3")], "[15, 50]"),
    one("wide", "40 mm", &[ONE, FLANGE, ("actuator.width", "40.0")], "[10, 30]"),
    one("tall", "22 mm", &[ONE, FLANGE, ("actuator.height", "22.0")], "[10, 30]"),
    one(
        "long chamber",
        "16 mm",
        &[ONE, FLANGE, ("actuator.chamber_length", "16.0"), ("actuator.cavity_length", "14.0")],
        "[10, 25]",
    ),
    Kind { is_quick: true, ..one("low", "8 mm: hardly bends", &[ONE, FLANGE, ("actuator.height", "8.0")], "[20, 60]") },
    Kind {
        base: Base::File(include_str!("../../../fixtures/accuracy/draft_wrong_sign.toml")),
        is_quick: true,
        ..one(
            "changes its sign",
            "walls of 0.6 mm, 0.13 mm below the channel: bends down, then up (`fixtures/accuracy/draft_wrong_sign.toml`)",
            &[],
            "[2.8541, 5.7082, 11.416]",
        )
    },
];

const ONE: (&str, &str) = ("actuator.chambers", "1");
const FLANGE: (&str, &str) = ("actuator.flange", "2.0");
const SOFT: &[(&str, &str)] = &[("material.c10", "0.08"), ("material.c20", "0"), ("material.c30", "0")];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_is_a_valid_case_of_its_own() {
        let mut names: Vec<&str> = KINDS.iter().map(|kind| kind.name).collect();
        for kind in KINDS {
            assert!(kind.study().unwrap().case().is_some(), "{}", kind.name);
        }
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), KINDS.len());
    }
}
