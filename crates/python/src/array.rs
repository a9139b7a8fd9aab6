//! Numbers that numpy sees without a copy.

use std::any::Any;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::PyDict;

/// What numpy calls the bytes of a number.
pub trait Number {
    /// The type without its byte order, e.g. `f8`.
    const TYPE: &'static str;
}

impl Number for f64 {
    const TYPE: &'static str = "f8";
}

impl Number for u32 {
    const TYPE: &'static str = "u4";
}

impl Number for u64 {
    const TYPE: &'static str = "u8";
}

impl Number for u8 {
    const TYPE: &'static str = "u1";
}

/// Numbers in memory that nobody changes, behind numpy's `__array_interface__`: `numpy.asarray` shows them without a copy, for reading, and
/// keeps them alive.
#[pyclass(frozen, module = "pneuflex._native")]
pub struct Array {
    address: usize,
    shape: Vec<usize>,
    kind: &'static str,
    _owner: Arc<dyn Any + Send + Sync>,
}

impl Array {
    /// Numbers that `owner` has, in rows of `columns`; a list if there is only one of these. What an `Arc` holds stays where it is, and
    /// what is shared is not changed.
    pub fn of<T: Any + Send + Sync, N: Number>(owner: &Arc<T>, columns: usize, numbers: impl Fn(&T) -> &[N]) -> Self {
        let found = numbers(owner);
        let rows = found.len() / columns.max(1);
        let shape = if columns == 1 { vec![rows] } else { vec![rows, columns] };
        let owner: Arc<dyn Any + Send + Sync> = Arc::<T>::clone(owner);
        Self { address: found.as_ptr() as usize, shape, kind: N::TYPE, _owner: owner }
    }
}

#[pymethods]
impl Array {
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let order = if cfg!(target_endian = "little") { '<' } else { '>' };
        let described = PyDict::new(py);
        described.set_item("version", 3)?;
        described.set_item("typestr", format!("{order}{}", self.kind))?;
        described.set_item("shape", pyo3::types::PyTuple::new(py, &self.shape)?)?;
        // For reading only.
        described.set_item("data", (self.address, true))?;
        Ok(described)
    }
}
