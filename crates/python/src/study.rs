//! Case files, model files, decks and meshes, and what is built from them.

use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;
use std::sync::Arc;

use pneuflex::mesh::{Facet, Mesh};
use pneuflex::model::Formulation;
use pneuflex::{Change, Error, InputError, MemoryLimit, on_threads};
use pneuflex_sweep::identity;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::array::Array;
use crate::error::{apart, wrong};
use crate::run::requests;

/// Something to be studied, as it is written; never changed.
#[pyclass(frozen, module = "pneuflex._native")]
pub struct Study(pub(crate) pneuflex::Study);

/// What is built from it, ready to be solved.
#[pyclass(frozen, module = "pneuflex._native")]
pub struct Analysis {
    pub(crate) analysis: Arc<pneuflex::Analysis>,
    kinds: Arc<Vec<u8>>,
}

/// Bytes of a set of faces with the number of columns: cell and number of the face, or the nodes of the face; or nodes, and 0.
type Faces = (Vec<u8>, usize);

#[pymethods]
impl Study {
    /// Reads a case file, a model file or a deck.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf, changes: Vec<(String, String)>) -> PyResult<Self> {
        apart(py, || pneuflex::Study::load_with(path, changed(changes)).map(Self))
    }

    /// The same from the file of that name and those that it names, by their paths.
    #[staticmethod]
    fn from_files(
        py: Python<'_>,
        name: &str,
        files: HashMap<String, Vec<u8>>,
        changes: Vec<(String, String)>,
    ) -> PyResult<Self> {
        apart(py, || pneuflex::Study::from_files_with(name, files, changed(changes)).map(Self))
    }

    /// A model on a mesh of little-endian numbers: positions, nodes of cells and members of sets.
    #[staticmethod]
    #[expect(clippy::too_many_arguments, reason = "the parts of a mesh")]
    fn from_mesh(
        py: Python<'_>,
        name: &str,
        text: &str,
        element: &str,
        nodes: &[u8],
        cells: (Vec<u8>, usize),
        node_sets: HashMap<String, Vec<u8>>,
        face_sets: HashMap<String, Faces>,
        cell_sets: HashMap<String, Vec<u8>>,
        changes: Vec<(String, String)>,
    ) -> PyResult<Self> {
        let Some(formulation) = Formulation::ALL.into_iter().find(|formulation| formulation.name() == element) else {
            let names = Formulation::ALL.map(|formulation| formulation.name()).join(", ");
            return Err(wrong(py, format!("element = \"{element}\" must be one of {names}")));
        };
        let (kind, (cells, columns)) = (formulation.element_kind(), cells);
        if columns != kind.num_nodes() {
            let what = format!("element = \"{element}\" has {} nodes, but cells have {columns}", kind.num_nodes());
            return Err(wrong(py, what));
        }
        apart(py, || {
            let mut mesh = Mesh {
                kinds: kind.into(),
                nodes: floats(nodes).chunks_exact(3).map(|x| [x[0], x[1], x[2]]).collect(),
                connectivity: numbers(&cells),
                node_sets: node_sets.into_iter().map(|(name, bytes)| (name, sorted(numbers(&bytes)))).collect(),
                facet_sets: BTreeMap::new(),
                element_sets: cell_sets.into_iter().map(|(name, bytes)| (name, sorted(numbers(&bytes)))).collect(),
            };
            // Before faces are looked for: they need nodes that are there.
            pneuflex::Body::of_mesh(formulation, mesh.clone())?;
            let found = face_sets.into_iter().map(|(name, faces)| Ok((name.clone(), facets(&mesh, &name, faces)?)));
            mesh.facet_sets = found.collect::<Result<_, Error>>()?;
            let mut study = pneuflex::Study::from_mesh(name, text, formulation, &mesh)?;
            study.set_all(changed(changes))?;
            Ok(Self(study))
        })
    }

    /// A copy with other values of keys, as TOML.
    fn with_changes(&self, py: Python<'_>, changes: Vec<(String, String)>) -> PyResult<Self> {
        apart(py, || {
            let mut study = self.0.clone();
            study.set_all(changed(changes))?;
            Ok(Self(study))
        })
    }

    /// All files that it is read from, by their paths.
    #[getter]
    fn files(&self, py: Python<'_>) -> PyResult<BTreeMap<PathBuf, Py<PyBytes>>> {
        let files = apart(py, || self.0.files())?;
        Ok(files.into_iter().map(|(path, bytes)| (path, PyBytes::new(py, &bytes).unbind())).collect())
    }

    /// `case`, `model` or `deck`.
    #[getter]
    fn kind(&self) -> &'static str {
        identity::kind(&self.0)
    }

    /// The text of its file; of a deck, nothing.
    #[getter]
    fn text(&self) -> &str {
        self.0.text()
    }

    /// What was set, as far as it has a meaning still.
    #[getter]
    fn changes(&self) -> Vec<(String, String)> {
        self.0.changes().iter().map(|change| (change.key.clone(), change.value.clone())).collect()
    }

    /// Name of the file.
    #[getter]
    fn path(&self) -> PathBuf {
        self.0.path().to_owned()
    }

    /// Every key with its value as JSON; of a deck, nothing.
    #[getter]
    fn values(&self, py: Python<'_>) -> PyResult<String> {
        identity::values(&self.0).map_err(|error| wrong(py, error.to_string()))
    }

    /// Length of the actuator at rest, mm, if it is one.
    #[getter]
    fn length(&self) -> Option<f64> {
        let of_model = || self.0.model().and_then(|model| model.actuator.as_ref());
        self.0.case().map(|case| &case.actuator).or_else(of_model).map(|actuator| actuator.length())
    }

    /// Unknowns and bytes that an actuator will need, from its lengths alone.
    #[getter]
    fn estimate(&self) -> Option<(f64, f64)> {
        self.0.estimate().map(|estimate| (estimate.unknowns, estimate.bytes))
    }

    /// Meshes it and puts the problem together.
    fn build(&self, py: Python<'_>, force: bool, threads: Option<usize>) -> PyResult<Analysis> {
        let limit = if force { MemoryLimit::None } else { MemoryLimit::Available };
        let analysis = apart(py, || on_threads(threads, || self.0.build_within(limit)))?;
        let mesh = &analysis.problem.mesh;
        let kinds = (0..mesh.num_elements()).map(|element| mesh.kind_of(element).vtk_cell_type).collect();
        Ok(Analysis { analysis: Arc::new(analysis), kinds: Arc::new(kinds) })
    }
}

#[pymethods]
impl Analysis {
    #[getter]
    fn title(&self) -> &str {
        &self.analysis.title
    }

    /// What would be solved: text, rows of kind and text.
    #[getter]
    fn overview(&self) -> (String, Vec<(&'static str, String)>) {
        let overview = self.analysis.overview();
        let text = overview.to_string();
        (text, overview.rows.into_iter().map(|row| (row.kind, row.text)).collect())
    }

    /// Nodes, elements, unknowns.
    #[getter]
    fn sizes(&self) -> [usize; 3] {
        let problem = &self.analysis.problem;
        [problem.mesh.num_nodes(), problem.mesh.num_elements(), problem.num_unknowns()]
    }

    /// Volume of the solid that is modelled, mm³, and peak memory, bytes.
    #[getter]
    fn volume_and_memory(&self) -> (f64, f64) {
        (self.analysis.problem.mesh.volume(), self.analysis.estimate().bytes)
    }

    #[getter]
    fn element(&self) -> String {
        self.analysis.problem.element_names()
    }

    /// What part of the body is modelled, if that is known.
    #[getter]
    fn modelled(&self) -> Option<&'static str> {
        self.analysis.modelled_part()
    }

    /// What is known before anything is solved: notes, and warnings as JSON.
    #[getter]
    fn remarks(&self, py: Python<'_>) -> PyResult<(Vec<String>, String)> {
        let warnings = serde_json::to_string(&self.analysis.warnings(&[]));
        Ok((self.analysis.notes.clone(), warnings.map_err(|error| wrong(py, error.to_string()))?))
    }

    /// Positions on the load path at which results are wanted: kPa of an actuator, else times.
    #[getter]
    fn requested(&self) -> Vec<f64> {
        self.analysis.requested.iter().map(|at| at.0).collect()
    }

    /// Refuses results without derivatives by the positions of nodes.
    fn check_shape_gradients(&self, py: Python<'_>, results: Vec<String>) -> PyResult<()> {
        apart(py, || self.analysis.check_shape_gradients(&requests(&results)?))
    }

    /// Refuses results and keys of which there are no derivatives, before anything is solved.
    fn check_gradients(&self, py: Python<'_>, results: Vec<String>, keys: Vec<String>) -> PyResult<()> {
        apart(py, || {
            self.analysis.check_gradients(&requests(&results)?)?;
            keys.iter().try_for_each(|key| self.analysis.number(key).map(drop))
        })
    }

    /// Positions of the nodes at rest, mm.
    #[getter]
    fn nodes(&self) -> Array {
        Array::of(&self.analysis, 3, |analysis| analysis.problem.mesh.nodes.as_flattened())
    }

    /// Nodes of every cell in VTK's order.
    #[getter]
    fn cells(&self) -> Array {
        // Cells of several kinds have rows of several lengths: one list.
        let columns = self.analysis.problem.mesh.kinds.only().map_or(1, |kind| kind.num_nodes());
        Array::of(&self.analysis, columns, |analysis| &analysis.problem.mesh.connectivity)
    }

    /// Number of nodes of every cell.
    #[getter]
    fn cell_sizes(&self) -> Vec<usize> {
        let mesh = &self.analysis.problem.mesh;
        (0..mesh.num_elements()).map(|element| mesh.kind_of(element).num_nodes()).collect()
    }

    /// VTK's type of every cell.
    #[getter]
    fn cell_types(&self) -> Array {
        Array::of(&self.kinds, 1, |kinds| kinds)
    }

    /// Names and members of the sets of nodes and of cells.
    #[getter]
    fn sets(&self) -> [BTreeMap<String, Vec<u32>>; 2] {
        let mesh = &self.analysis.problem.mesh;
        [mesh.node_sets.clone(), mesh.element_sets.clone()]
    }

    /// Names and members (cell, number of the face) of the sets of faces.
    #[getter]
    fn face_sets(&self) -> BTreeMap<String, Vec<(u32, u8)>> {
        let faces = |set: &Vec<Facet>| set.iter().map(|facet| (facet.element, facet.face)).collect();
        self.analysis.problem.mesh.facet_sets.iter().map(|(name, set)| (name.clone(), faces(set))).collect()
    }
}

/// Bytes that the machine, and the limits of this process, leave to it; nothing where nobody says.
#[pyfunction]
pub fn available_memory() -> Option<f64> {
    pneuflex::memory::available()
}

/// The text of a case file with so many chambers.
#[pyfunction]
pub fn template(chambers: usize) -> String {
    pneuflex::template::actuator(chambers)
}

fn changed(changes: Vec<(String, String)>) -> Vec<Change> {
    changes.into_iter().map(|(key, value)| Change::new(key, value)).collect()
}

fn floats(bytes: &[u8]) -> Vec<f64> {
    bytes.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect()
}

fn numbers(bytes: &[u8]) -> Vec<u32> {
    bytes.as_chunks().0.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect()
}

fn sorted<T: Ord>(mut members: Vec<T>) -> Vec<T> {
    members.sort_unstable();
    members.dedup();
    members
}

/// The faces of a set that is given by cells and numbers of faces, by the nodes of every face in any order, or, without columns, by the nodes
/// among which all nodes of a face must be.
fn facets(mesh: &Mesh, name: &str, (bytes, columns): Faces) -> Result<Vec<Facet>, Error> {
    let members = numbers(&bytes);
    let missing = |what: String| Error::from(InputError::new(format!("face_sets[\"{name}\"]: {what}")));
    if columns == 0 {
        let mut is_member = vec![false; mesh.num_nodes()];
        for node in members {
            is_member[node as usize] = true;
        }
        let has_all = |facet: &Facet| mesh.facet_nodes(*facet).iter().all(|&node| is_member[node as usize]);
        return Ok(mesh.boundary_facets().into_iter().filter(has_all).collect());
    }
    let rows = members.chunks_exact(columns);
    let found: Result<Vec<Facet>, Error> = if columns == 2 {
        let facet = |row: &[u32]| {
            let is_there = |face: &u8| usize::from(*face) < mesh.kind_of(row[0] as usize).num_faces();
            let face = u8::try_from(row[1]).ok().filter(|_| (row[0] as usize) < mesh.num_elements());
            let face = face.filter(is_there);
            let face = face.ok_or_else(|| missing(format!("cell {} has no face {}", row[0], row[1])))?;
            Ok(Facet { element: row[0], face })
        };
        rows.map(facet).collect()
    } else {
        // A face is told from its corners, whatever comes after them.
        let key = |nodes: &[u32]| sorted(nodes.to_vec());
        let mut by_corners = HashMap::new();
        for facet in mesh.boundary_facets() {
            let nodes = mesh.facet_nodes(facet);
            let corners = mesh.face_kind(facet).edges().count();
            by_corners.insert(key(&nodes[..corners]), facet);
        }
        let corners = by_corners.keys().map(Vec::len).max().unwrap_or_default();
        let facet = |(number, row): (usize, &[u32])| {
            let found = row.get(..corners).and_then(|corners| by_corners.get(&key(corners)));
            // Nodes may have other numbers than where they come from.
            found.copied().ok_or_else(|| missing(format!("row {number} has not the nodes of a face of the surface")))
        };
        rows.enumerate().map(facet).collect()
    };
    Ok(sorted(found?))
}
