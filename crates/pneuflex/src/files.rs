//! The files of a body, and the names of their copies in a result folder.

/// Folder within a result folder that the files of a body are copied to.
pub const INPUT: &str = "input";

/// Names of included files as a deck has them, in the order of their copies.
pub const INCLUDED: &str = "included.json";

/// The files of a body as they were read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Files {
    /// Name of the first one, without folder.
    pub name: String,
    /// Its bytes; empty if the body is made of parameters.
    pub bytes: Vec<u8>,
    /// Included files by the names that the deck has for them.
    pub included: Vec<(String, Vec<u8>)>,
}

/// Name of the copy of an included file.
pub fn included_name(number: usize) -> String {
    format!("included_{:03}.inp", number + 1)
}
