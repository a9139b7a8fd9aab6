//! The pneuflex command line program.
fn main() {}
