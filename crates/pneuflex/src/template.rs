//! Case files to start from.

use pneuflex_mesh::Actuator;

const TEMPLATE: &str = include_str!("../templates/case.toml");

/// The case file of the paper's two-chamber piece, with remarks.
pub fn two_chambers() -> String {
    filled([
        ("{name}", "two_chamber"),
        ("{what}", "Two chambers of a soft pneumatic actuator"),
        ("{title}", "Two chambers, multiple-point contact"),
        ("{chambers}", "2"),
        ("{flange}", "0.0"),
        ("{length}", "18.0"),
    ])
}

/// The case file of the paper's full actuator, eight chambers and two flanges, with remarks.
pub fn full_actuator() -> String {
    filled([
        ("{name}", "actuator"),
        ("{what}", "A soft pneumatic actuator with eight chambers"),
        ("{title}", "Full actuator, multiple-point contact"),
        ("{chambers}", "8"),
        ("{flange}", "2.0"),
        ("{length}", "82.0"),
    ])
}

/// The case file of the paper's actuator with another number of chambers, with remarks.
///
/// A number out of range is found when the text is read.
pub fn actuator(chambers: usize) -> String {
    let length = Actuator { chambers, ..Actuator::full() }.length();
    filled([
        ("{name}", "actuator"),
        ("{what}", "A soft pneumatic actuator"),
        ("{title}", ""),
        ("{chambers}", &chambers.to_string()),
        ("{flange}", "2.0"),
        ("{length}", &format!("{length:?}")),
    ])
}

fn filled(values: [(&str, &str); 6]) -> String {
    values.iter().fold(TEMPLATE.to_owned(), |text, (mark, value)| text.replace(mark, value))
}
