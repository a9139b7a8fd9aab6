//! The table as Markdown.

use std::fmt::Write;

use crate::{Row, Section};

/// `docs/verification.md` for the given results.
pub fn markdown(sections: &[Section]) -> String {
    let rows = || sections.iter().flat_map(|s| &s.rows);
    let missed = rows().filter(|row| !row.passes()).count();
    let faults = rows().filter(|row| row.is_fault()).count();
    let mut text = format!(
        "# Verification\n\n\
         Made by `cargo xtask verification`; not to be edited. {} rows, {} miss their bounds, {} of them not by a known limit.\n\n\
         Errors are relative unless said otherwise, from the coarsest to the finest mesh; *order* is the slope of a straight line \
         through their logarithms. A row passes if every error is below a bound that is given for the coarsest mesh and falls with \
         the least order accepted, and if, on three meshes or more, the order is not below that. A *known limit* is a miss that the text above the table explains.\n",
        rows().count(),
        missed,
        faults
    );
    for section in sections {
        // Writing to a string cannot fail.
        let _ = write!(text, "\n## {}\n\n{}\n\n", section.title, section.text.trim());
        text += "| quantity | element | meshes | measured | exact | errors | order | expected | bound | verdict |\n";
        text += "|---|---|---|---|---|---|---|---|---|---|\n";
        for row in &section.rows {
            text += &line(row);
        }
    }
    text
}

/// One line of the table, with its line feed.
pub fn line(row: &Row) -> String {
    let errors: Vec<String> = row.errors.iter().map(|e| format!("{e:.1e}")).collect();
    let number = |x: Option<f64>| x.map_or("–".into(), |x| format!("{x:.5}"));
    let order = |x: Option<f64>| x.map_or("–".into(), |x| format!("{x:.1}"));
    let expected = match row.expected_order {
        Some(expected) => format!("{expected:.1} (≥ {:.1})", row.least_order),
        None => "–".into(),
    };
    let verdict = match (&row.failure, row.passes()) {
        (Some(why), _) => format!("**no result: {why}**"),
        (None, true) if row.bound.is_infinite() => "reported".into(),
        (None, true) => "passes".into(),
        (None, false) if row.is_known_limit => "**misses** (known limit)".into(),
        (None, false) => "**misses**".into(),
    };
    format!(
        "| {} | `{}` | {} | {} | {} | {} | {} | {} | {} | {} |\n",
        row.quantity,
        row.element,
        row.meshes.join(", "),
        number(row.exact.map(|_| row.measured)),
        number(row.exact),
        errors.join(", "),
        order(row.expected_order.and(row.order())),
        expected,
        if row.bound.is_finite() { format!("{:.1e}", row.bound) } else { "–".into() },
        verdict
    )
}
