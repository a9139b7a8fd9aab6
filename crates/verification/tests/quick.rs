//! Every row of the coarsest two meshes is within its bound.
#![allow(clippy::print_stdout)]

use pneuflex_verification::{Effort, run, table};

#[test]
fn the_coarsest_meshes_are_within_their_bounds() {
    let sections = run(Effort::Quick, &|row| print!("{}", table::line(row)));
    let missed: Vec<String> =
        sections.iter().flat_map(|s| &s.rows).filter(|row| row.is_fault()).map(table::line).collect();
    assert!(sections.iter().all(|s| !s.rows.is_empty()));
    assert!(missed.is_empty(), "rows that miss their bounds:\n{}", missed.concat());
}
