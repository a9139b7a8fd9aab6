//! `docs/relations.md`: what the tasks found that try random inputs, a section for each.

use std::fs;
use std::path::Path;

/// Sections in their order.
const SECTIONS: [&str; 4] = ["Relations", "Damaged inputs", "Killed runs", "What was drawn"];

const HEAD: &str = "# Random problems\n\nWritten by `cargo xtask relations --docs`, `fuzz --docs` and `kills --docs`, section by section. What came of \
                    it, fault by fault, is in [measurements.md](measurements.md#relations).\n";

/// Puts a section in the place of the one of its name.
///
/// # Errors
/// In words: the file cannot be read or written.
pub fn write(section: &str, text: &str) -> Result<(), String> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/relations.md");
    let old = fs::read_to_string(&file).unwrap_or_default();
    fs::write(&file, replaced(&old, section, text)).map_err(|error| format!("{}: {error}", file.display()))
}

fn replaced(old: &str, section: &str, text: &str) -> String {
    let known = |name: &str| {
        let rest = old.split_once(&format!("\n## {name}\n\n"))?.1;
        Some(rest.split_once("\n## ").map_or(rest, |parts| parts.0).trim().to_owned())
    };
    let mut found = HEAD.to_owned();
    for name in SECTIONS {
        let body = if name == section { Some(text.trim().to_owned()) } else { known(name) };
        if let Some(body) = body {
            found += &format!("\n## {name}\n\n{body}\n");
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_takes_the_place_of_its_predecessor() {
        let one = replaced("", "Killed runs", "killed\n");
        let two = replaced(&one, "Relations", "| a |\n\nb");
        let three = replaced(&two, "Killed runs", "again");
        assert_eq!(three, format!("{HEAD}\n## Relations\n\n| a |\n\nb\n\n## Killed runs\n\nagain\n"));
        assert_eq!(replaced(&three, "Killed runs", "again"), three);
    }
}
