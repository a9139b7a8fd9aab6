//! The text of a deck → keywords with their parameters and data lines.
//!
//! A line that begins with `**` is a comment, one that begins with `*` a keyword with its parameters, any other a line of data for the
//! keyword above it; blank lines count for nothing. A keyword goes on in the next line after a comma at its end. Keywords, parameters
//! and names are the same in capitals and small letters; blanks around commas and equals signs count for nothing. A name in double
//! quotes may contain commas.

mod block;
mod number;
mod parse;

pub use block::{Block, DataLine, Parameter, Sources};
pub use number::{integer, real};
pub use parse::{Include, MAX_DEPTH, MAX_FILES, MAX_SIZE, parse, parse_into};
