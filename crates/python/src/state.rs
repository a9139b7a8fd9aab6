//! Reached states with their fields, field files, the report's page.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pneuflex::newton::ConvergedState;
use pneuflex::post::fields;
use pneuflex::post::summary::Described;
use pneuflex::post::surface_stress::SurfaceState;
use pneuflex::post::vtu::{Field, Grid};
use pneuflex::{Analysis, Error, InputError, ResultsError, input_file, json, on_threads};
use pyo3::prelude::*;

use crate::array::Array;
use crate::error::apart;

/// Bytes that a field file may have.
const MOST_BYTES: u64 = 8_000_000_000;

/// What is kept of a state.
pub struct Kept {
    /// Its part of `summary.json`.
    pub summary: String,
    /// The equilibrium.
    pub equilibrium: ConvergedState,
    point_data: Vec<Field>,
    cell_data: Vec<Field>,
}

impl Kept {
    /// What is kept of an equilibrium and what was derived from it.
    ///
    /// # Errors
    /// Numbers that are not finite.
    pub fn new(
        analysis: &Analysis,
        equilibrium: &ConvergedState,
        described: &Described,
        keeps_fields: bool,
    ) -> Result<Self, ResultsError> {
        let summary = json::line(&described.summary).map_err(|why| ResultsError::not_representable("summary", why))?;
        let mut kept =
            Self { summary, equilibrium: equilibrium.clone(), point_data: Vec::new(), cell_data: Vec::new() };
        if keeps_fields {
            let problem = &analysis.problem;
            let surface = SurfaceState {
                displacement: &equilibrium.displacement,
                parameter: equilibrium.parameter,
                pressures: &equilibrium.cavity_pressures,
                contact: &described.contact,
            };
            let grid = fields::body(problem, &described.stress, &surface);
            let at = problem.clock.words(equilibrium.parameter);
            let grid = grid.map_err(|source| ResultsError::Derived { at, source })?;
            (kept.point_data, kept.cell_data) = (grid.point_data, grid.cell_data);
        } else {
            kept.equilibrium.displacement = Vec::new();
            kept.equilibrium.reaction = Vec::new();
        }
        Ok(kept)
    }

    fn values(&self, name: &str) -> Option<&[f64]> {
        let fields = self.point_data.iter().chain(&self.cell_data);
        fields.into_iter().find(|field| field.name == name).map(|field| &field.values[..])
    }
}

/// A reached state.
#[pyclass(frozen, module = "pneuflex._native")]
pub struct State(pub Arc<Kept>);

#[pymethods]
impl State {
    /// Its part of `summary.json`.
    #[getter]
    fn summary(&self) -> &str {
        &self.0.summary
    }

    #[getter]
    fn has_fields(&self) -> bool {
        !self.0.equilibrium.displacement.is_empty()
    }

    /// Displacements of the nodes, mm.
    #[getter]
    fn displacement(&self) -> Array {
        Array::of(&self.0, 3, |kept| kept.equilibrium.displacement.as_flattened())
    }

    /// Forces of the supports on the nodes, N.
    #[getter]
    fn reaction(&self) -> Array {
        Array::of(&self.0, 3, |kept| kept.equilibrium.reaction.as_flattened())
    }

    /// A field by its name in the field files, in rows of `columns`; `None` if there is no such field.
    fn field(&self, name: &str, columns: usize) -> Option<Array> {
        self.0.values(name)?;
        Some(Array::of(&self.0, columns, |kept| kept.values(name).unwrap_or_default()))
    }
}

/// A field file: a grid with values.
#[pyclass(frozen, module = "pneuflex._native")]
pub struct FieldFile(Arc<Grid>);

#[pymethods]
impl FieldFile {
    #[getter]
    fn points(&self) -> Array {
        Array::of(&self.0, 3, |grid| grid.points.as_flattened())
    }

    #[getter]
    fn connectivity(&self) -> Array {
        Array::of(&self.0, 1, |grid| &grid.connectivity)
    }

    #[getter]
    fn offsets(&self) -> Array {
        Array::of(&self.0, 1, |grid| &grid.offsets)
    }

    #[getter]
    fn cell_types(&self) -> Array {
        Array::of(&self.0, 1, |grid| &grid.cell_types)
    }

    /// A field by its name; `None` if there is no such field.
    fn field(&self, name: &str, columns: usize) -> Option<Array> {
        let find = |grid: &Grid| {
            let fields = grid.point_data.iter().chain(&grid.cell_data);
            fields.enumerate().find(|(_, field)| field.name == name).map(|(number, _)| number)
        };
        let number = find(&self.0)?;
        Some(Array::of(&self.0, columns, |grid| {
            let mut fields = grid.point_data.iter().chain(&grid.cell_data);
            fields.nth(number).map(|field| &field.values[..]).unwrap_or_default()
        }))
    }
}

/// Reads a field file (`.vtu`) of a result folder.
#[pyfunction]
pub fn read_field_file(py: Python<'_>, path: PathBuf) -> PyResult<FieldFile> {
    apart(py, || {
        let damaged = |why: String| Error::from(InputError::about_file(&path, format!("damaged: {why}")));
        let bytes = input_file(&path, MOST_BYTES)?;
        let text = String::from_utf8(bytes).map_err(|error| damaged(error.to_string()))?;
        let grid = Grid::from_vtu(&text).map_err(|error| damaged(error.to_string()))?;
        Ok(FieldFile(Arc::new(grid)))
    })
}

/// The page that shows a result folder in a browser.
#[pyfunction]
pub fn report_page(py: Python<'_>, folder: PathBuf) -> PyResult<String> {
    apart(py, || on_threads(Some(1), || pneuflex::report_page::report_page(Path::new(&folder))))
}
