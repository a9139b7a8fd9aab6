//! What a search has solved, as a file of its folder. From the same designs the same search follows: it goes on by taking their results from there.

use pneuflex::folder::ROUNDS;
use pneuflex::{Error, InputError, InputErrorKind, OutputFolder, ResultsError, json};
use serde::{Deserialize, Serialize};

/// A design that was tried.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Tried {
    /// Values of the variables.
    pub values: Vec<f64>,
    /// The results; empty if it has none.
    pub results: Vec<f64>,
    /// Their derivatives by the variables, a row for each result.
    pub derivatives: Vec<Vec<f64>>,
    /// Why it has no results.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outside: Option<String>,
    /// Whether the guesses of its load steps came from the design before.
    pub has_started_from_last: bool,
    /// The bottom centreline in the last state, \[x, z\] in mm from the clamp to the tip; empty for a body without one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub line: Vec<[f64; 2]>,
    /// Seconds that it took.
    pub seconds: f64,
    /// The start, from 1, from which the search came to it.
    #[serde(default = "first")]
    pub start: usize,
}

fn first() -> usize {
    1
}

/// The designs of a search.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct History {
    program: String,
    version: String,
    /// A digest of the first design.
    origin: String,
    /// Names of the variables.
    pub variables: Vec<String>,
    /// Names of the results, with their places on the load path.
    pub results: Vec<String>,
    /// The designs in their order.
    pub designs: Vec<Tried>,
    /// Why the search has ended.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ended: Option<String>,
}

impl History {
    /// That of a search that begins.
    pub fn new(origin: String, variables: Vec<String>, results: Vec<String>) -> Self {
        let (program, version) = ("pneuflex".to_owned(), env!("CARGO_PKG_VERSION").to_owned());
        Self { program, version, origin, variables, results, designs: Vec::new(), ended: None }
    }

    /// Takes over the designs that a folder holds; nothing if it holds none.
    ///
    /// # Errors
    /// Designs of another search.
    pub fn resume(&mut self, folder: &OutputFolder) -> Result<(), InputError> {
        let Some(bytes) = folder.read(ROUNDS) else { return Ok(()) };
        let refused = |what: &str| {
            InputError::about_file(&folder.path().join(ROUNDS), what).of_kind(InputErrorKind::OtherResults)
        };
        let old: Self = serde_json::from_slice(&bytes).map_err(|_| refused("cannot be read, or is damaged"))?;
        let has_shape = |tried: &Tried| {
            let is_row = |row: &Vec<f64>| row.len() == self.variables.len();
            let is_outside = tried.outside.is_some() && tried.results.is_empty();
            let is_solved = tried.results.len() == self.results.len() && tried.derivatives.len() == self.results.len();
            tried.values.len() == self.variables.len()
                && (is_outside || is_solved && tried.derivatives.iter().all(is_row))
        };
        if (&old.version, &old.origin) != (&self.version, &self.origin) {
            return Err(refused("holds designs of another case, or of another version of the program"));
        }
        if old.variables != self.variables || old.results != self.results {
            return Err(refused("holds designs with other variables or results"));
        }
        if !old.designs.iter().all(has_shape) {
            return Err(refused("is damaged"));
        }
        self.designs = old.designs;
        Ok(())
    }

    /// Writes it.
    ///
    /// # Errors
    /// A file that cannot be written; a number that is not finite.
    pub fn write(&self, folder: &OutputFolder) -> Result<(), Error> {
        let text = json::pretty(self).map_err(|why| ResultsError::not_representable(ROUNDS, why))?;
        Ok(folder.write(ROUNDS, text)?)
    }
}
