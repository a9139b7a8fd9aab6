//! What is to be studied, as it is described: keys can be set before anything is built.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use pneuflex_deck::Extent;
use pneuflex_mesh::Mesh;
use pneuflex_model::model_file::{Model, Source};
use pneuflex_model::{Case, Formulation};

use crate::analysis::{Analysis, Guard};
use crate::body_file::{is_deck, read_body};
use crate::document::{CaseFile, Change, Written, is_model};
use crate::error::Error;
use crate::input_error::{InputError, Origin, Place};
use crate::memory::{Estimate, MemoryLimit};
use crate::recorded_mesh::{self, RecordedMesh};
use crate::solution::Solution;
use crate::store::Store;
use crate::words::{self, count};

/// A case file, a model file or a deck, read and checked as far as its text goes.
///
/// Nothing is meshed before [`Study::build`], so that a study is cheap to copy and to change: a sweep sets keys on copies of one.
#[derive(Clone, Debug)]
pub struct Study {
    path: PathBuf,
    store: Store,
    text: Arc<str>,
    changes: Vec<Change>,
    described: Described,
}

#[derive(Clone, Debug)]
enum Described {
    Actuator(Box<CaseFile>),
    Model(Box<Written<Model>>),
    Deck {
        /// A deck has no key to ask for it.
        error_estimate: bool,
    },
}

impl Study {
    /// Reads a case file or a model file (TOML), or takes an input deck (`.inp`, `.feb`).
    ///
    /// # Errors
    /// [`Error::Input`] with everything that is wrong with a case or model file. Decks and meshes are read by [`Self::build`].
    pub fn load(path: impl AsRef<Path>) -> Result<Self, Error> {
        Self::load_with(path, Vec::new())
    }

    /// The same with changes to keys, which may mend what is missing in the file.
    ///
    /// # Errors
    /// As there.
    pub fn load_with(path: impl AsRef<Path>, changes: Vec<Change>) -> Result<Self, Error> {
        Self::from_store(path.as_ref(), Store::Disk, changes)
    }

    /// The same from the text of a case file, a model file or a deck, which is called `name` in messages; a name that ends in `.inp` or
    /// `.feb` is that of a deck.
    ///
    /// # Errors
    /// As for [`Self::load`].
    pub fn from_text(name: &str, text: &str) -> Result<Self, Error> {
        Self::from_files(name, [(name.to_owned(), text.as_bytes().to_vec())])
    }

    /// The same from files in memory: the one called `name` and what it refers to, meshes and included decks.
    ///
    /// # Errors
    /// As for [`Self::load`].
    pub fn from_files(name: &str, files: impl IntoIterator<Item = (String, Vec<u8>)>) -> Result<Self, Error> {
        Self::from_files_with(name, files, Vec::new())
    }

    /// The same with changes to keys, as [`Self::load_with`].
    ///
    /// # Errors
    /// As for [`Self::load`].
    pub fn from_files_with(
        name: &str,
        files: impl IntoIterator<Item = (String, Vec<u8>)>,
        changes: Vec<Change>,
    ) -> Result<Self, Error> {
        let files: BTreeMap<_, _> = files.into_iter().map(|(name, bytes)| (PathBuf::from(name), bytes)).collect();
        Self::from_store(Path::new(name), Store::Memory(Arc::new(files)), changes)
    }

    /// A model on a mesh in memory: `text` is that of a model file without `[model]`, and speaks of the mesh's sets. Errors call it `name`.
    ///
    /// # Errors
    /// As for [`Self::load`]; a mesh of another family than the formulation's, or with members of sets that are not there.
    pub fn from_mesh(name: &str, text: &str, formulation: Formulation, mesh: &Mesh) -> Result<Self, Error> {
        recorded_mesh::check(formulation, mesh)?;
        let bytes = RecordedMesh::of(formulation, mesh).written()?;
        let text = format!("model.file = \"{}\"\n{text}", recorded_mesh::FILE);
        Self::from_files(name, [(name.to_owned(), text.into_bytes()), (recorded_mesh::FILE.to_owned(), bytes)])
    }

    /// An actuator's case that was put together in memory.
    ///
    /// # Errors
    /// [`Error::Input`] with every value that is out of range.
    pub fn actuator(case: &Case) -> Result<Self, Error> {
        let text = toml::to_string(case).map_err(|error| InputError::new(error.to_string()))?;
        Self::from_text("case.toml", &text)
    }

    fn from_store(path: &Path, store: Store, changes: Vec<Change>) -> Result<Self, Error> {
        let text: Arc<str> = if is_deck(path) { Arc::from("") } else { store.text(path)?.into() };
        let described = read(path, &text, &changes)?;
        Ok(Self { path: path.to_owned(), store, text, changes, described })
    }

    /// All that it is read from, by paths: its text, the deck or mesh that it names, and what that includes. [`Self::from_files_with`] makes
    /// the same study of them, which reads nothing from the disk.
    ///
    /// # Errors
    /// [`Error::Input`]: a deck or a mesh that cannot be read.
    pub fn files(&self) -> Result<BTreeMap<PathBuf, Vec<u8>>, Error> {
        let own = (self.path.clone(), self.text.as_bytes().to_vec());
        let (mut files, source, element) = match &self.described {
            Described::Actuator(_) => return Ok(BTreeMap::from([own])),
            Described::Model(file) => match &file.case.model {
                Some(source) => (BTreeMap::from([own]), source.clone(), file.case.mesh.element),
                None => return Ok(BTreeMap::from([own])),
            },
            Described::Deck { .. } => (BTreeMap::new(), source_of_deck(&self.path), None),
        };
        let path = self.store.beside(&self.path, &source.file);
        let read = read_body(&self.store, &path, &source, element, Extent::Body)?.files;
        let folder = path.parent().unwrap_or(Path::new(""));
        files.extend(read.included.into_iter().map(|(name, bytes)| (folder.join(name), bytes)));
        files.insert(path, read.bytes);
        Ok(files)
    }

    /// Sets a key, e.g. `actuator.gap` to `1.5` or `mesh.element` to `hex8-q1p0`. The value is TOML; what is no TOML is taken as a text.
    ///
    /// # Errors
    /// [`Error::Input`] if there is no such key or the value is out of range; the study is then as it was.
    pub fn set(&mut self, key: &str, value: &str) -> Result<&mut Self, Error> {
        self.set_all([Change::new(key, value)])
    }

    /// Sets several keys at once: what one of them alone would break may be mended by another. What was set before stays, unless it is set
    /// anew: a table as a whole takes the place of the keys in it, a resolution that of sizes.
    ///
    /// # Errors
    /// As for [`Self::set`].
    pub fn set_all(&mut self, changes: impl IntoIterator<Item = Change>) -> Result<&mut Self, Error> {
        let new: Vec<Change> = changes.into_iter().collect();
        let stays = |earlier: &&Change| !new.iter().any(|change| change.replaces(earlier));
        let changes: Vec<Change> = self.changes.iter().filter(stays).chain(&new).cloned().collect();
        self.described = read(&self.path, &self.text, &changes)?;
        self.changes = changes;
        Ok(self)
    }

    /// Sets `output.error_estimate`, also for a deck, which has no keys.
    ///
    /// # Errors
    /// As for [`Self::set`].
    pub fn estimate_errors(&mut self) -> Result<&mut Self, Error> {
        if let Described::Deck { error_estimate } = &mut self.described {
            *error_estimate = true;
            return Ok(self);
        }
        self.set("output.error_estimate", "true")
    }

    /// What was set, as far as it has a meaning still.
    pub fn changes(&self) -> &[Change] {
        &self.changes
    }

    /// The values of an actuator's case file; `None` for models and decks.
    pub fn case(&self) -> Option<&Case> {
        match &self.described {
            Described::Actuator(file) => Some(&file.case),
            Described::Model(_) | Described::Deck { .. } => None,
        }
    }

    /// The values of a model file; `None` for actuators and decks.
    pub fn model(&self) -> Option<&Model> {
        match &self.described {
            Described::Model(file) => Some(&file.case),
            Described::Actuator(_) | Described::Deck { .. } => None,
        }
    }

    /// Size and memory as far as they follow from an actuator's lengths, before anything is meshed; `None` for models and decks.
    pub fn estimate(&self) -> Option<Estimate> {
        self.case().map(Estimate::of)
    }

    /// The text of its file, without changes; of a deck, nothing.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Path of the file, or the name that stands for it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Meshes the body and puts the problem together, unless it needs more memory than there is.
    ///
    /// # Errors
    /// [`Error::Input`]: lengths that make no body, a deck or a mesh that cannot be read or solved, sets that do not exist, an obstacle that
    /// overlaps the body, a body that is too large.
    pub fn build(&self) -> Result<Analysis, Error> {
        self.build_within(MemoryLimit::Available)
    }

    /// The same within another limit.
    ///
    /// # Errors
    /// As there.
    pub fn build_within(&self, limit: MemoryLimit) -> Result<Analysis, Error> {
        Ok(self.build_guarded(&|estimate| estimate.within(limit))?)
    }

    /// The same; `guard` says from its size whether a body may be built, and what to warn of.
    pub(crate) fn build_guarded(&self, guard: Guard<'_>) -> Result<Analysis, Vec<InputError>> {
        let mut analysis = match &self.described {
            Described::Actuator(file) => Analysis::of_case_file(file, guard)?,
            Described::Model(file) => {
                let say = |error| file.out_of_range(&error);
                Analysis::of_model(&self.store, &self.path, file.case.clone(), guard, &say)?
            }
            Described::Deck { error_estimate } => {
                let mut model = Model { model: Some(source_of_deck(&self.path)), ..Model::default() };
                model.output.error_estimate = *error_estimate;
                let say = |error| InputError::about_file(&self.path, error);
                Analysis::of_model(&self.store, &self.path, model, guard, &say)?
            }
        };
        if let Some(size) = analysis.size_of_error_estimate() {
            let without = "output.error_estimate = false does without the finer mesh".to_owned();
            let warning = guard(size).map_err(|error| error.with_help(Some(without)))?;
            let size = format!("{} unknowns and {}", count(size.unknowns), words::size(size.bytes));
            analysis
                .notes
                .push(format!("the error estimate needs about {size}, and two factorisations of that size or more"));
            analysis.notes.extend(warning.map(|warning| format!("warning: error estimate: {warning}")));
        }
        Ok(analysis)
    }

    /// Builds and solves it from rest through all pressures or times.
    ///
    /// # Errors
    /// As for [`Self::build`] and [`Analysis::solve`].
    pub fn solve(&self) -> Result<Solution, Error> {
        self.build()?.solve()
    }
}

/// A deck as the body of a model that says nothing else.
fn source_of_deck(path: &Path) -> Source {
    let file = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    Source::of_file(file)
}

fn read(path: &Path, text: &Arc<str>, changes: &[Change]) -> Result<Described, Vec<InputError>> {
    if is_deck(path) {
        return match changes.first() {
            None => Ok(Described::Deck { error_estimate: false }),
            Some(change) => {
                let name = change.to_string();
                let place = Place::new(&name, Origin::Change, name.as_str().into(), 0..change.key.len());
                let help = "write a model file around the deck: [model] with file = \"...\"".to_owned();
                let error = InputError::new("a deck has no keys to change").of_key(&change.key);
                Err(error.at(Some(place)).with_help(Some(help)).into())
            }
        };
    }
    if is_model(text) {
        return Ok(Described::Model(Box::new(Written::from_text(path, text.clone(), changes)?)));
    }
    Ok(Described::Actuator(Box::new(CaseFile::from_text(path, text.clone(), changes)?)))
}
