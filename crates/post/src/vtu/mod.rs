//! VTK XML files: unstructured grids (`.vtu`) and their time series (`.pvd`).
//!
//! Arrays are written inline as base64 of little-endian numbers behind a 64-bit byte count, uncompressed: what every
//! reader of the format understands. Node numbering of the mesh crate is VTK's own. [`Grid::from_vtu`] reads them back.

mod read;

pub use read::VtuError;

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::error::{PostError, check};

/// A grid of cells with values at points and cells.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Grid {
    /// Points, mm.
    pub points: Vec<[f64; 3]>,
    /// Points of all cells, one cell after the other.
    pub connectivity: Vec<u32>,
    /// End of every cell in `connectivity`.
    pub offsets: Vec<u64>,
    /// VTK cell type of every cell.
    pub cell_types: Vec<u8>,
    /// Values at points.
    pub point_data: Vec<Field>,
    /// Values at cells.
    pub cell_data: Vec<Field>,
    /// The series' time, here the air pressure in kPa; readers know it as `TimeValue`.
    pub time: f64,
}

/// A named array with the same number of components for every point or cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Name shown by viewers.
    pub name: String,
    /// Names of the components, as many as there are; empty for a scalar.
    pub components: Vec<String>,
    /// Values, components running fastest.
    pub values: Vec<f64>,
}

impl Field {
    /// A scalar field.
    pub fn scalar(name: &str, values: Vec<f64>) -> Self {
        Self { name: name.into(), components: Vec::new(), values }
    }

    /// A vector field with components x, y, z.
    pub fn vector(name: &str, values: Vec<f64>) -> Self {
        Self { name: name.into(), components: ["x", "y", "z"].map(String::from).into(), values }
    }

    /// A symmetric tensor field, components in VTK's order.
    pub fn symmetric_tensor(name: &str, values: Vec<f64>) -> Self {
        let components = ["xx", "yy", "zz", "xy", "yz", "xz"].map(String::from).into();
        Self { name: name.into(), components, values }
    }

    fn width(&self) -> usize {
        self.components.len().max(1)
    }
}

impl Grid {
    /// Adds a cell.
    pub fn push_cell(&mut self, cell_type: u8, nodes: impl IntoIterator<Item = u32>) {
        self.connectivity.extend(nodes);
        self.offsets.push(self.connectivity.len() as u64);
        self.cell_types.push(cell_type);
    }

    /// The text of the `.vtu` file.
    ///
    /// # Errors
    /// A field whose length does not fit the grid, or a number that is not finite.
    pub fn to_vtu(&self) -> Result<String, PostError> {
        check("points", self.points.as_flattened(), 3 * self.points.len())?;
        check("time", &[self.time], 1)?;
        for (fields, count) in [(&self.point_data, self.points.len()), (&self.cell_data, self.cell_types.len())] {
            for field in fields {
                check(&field.name, &field.values, count * field.width())?;
            }
        }
        let mut text = String::new();
        text += "<?xml version=\"1.0\"?>\n";
        text +=
            "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n";
        text += "<UnstructuredGrid>\n<FieldData>\n";
        array(&mut text, "Float64", "TimeValue", " NumberOfTuples=\"1\"", bytes(&[self.time], |x| x.to_le_bytes()));
        text += "</FieldData>\n";
        let (points, cells) = (self.points.len(), self.cell_types.len());
        text += &format!("<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">\n<Points>\n");
        let coordinates = bytes(self.points.as_flattened(), |x| x.to_le_bytes());
        array(&mut text, "Float64", "Points", " NumberOfComponents=\"3\"", coordinates);
        text += "</Points>\n<Cells>\n";
        let connectivity = bytes(&self.connectivity, |&x| i64::from(x).to_le_bytes());
        array(&mut text, "Int64", "connectivity", "", connectivity);
        array(&mut text, "Int64", "offsets", "", bytes(&self.offsets, |x| x.to_le_bytes()));
        array(&mut text, "UInt8", "types", "", self.cell_types.clone());
        text += "</Cells>\n";
        section(&mut text, "PointData", &self.point_data);
        section(&mut text, "CellData", &self.cell_data);
        text += "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
        Ok(text)
    }
}

/// One entry of a time series.
#[derive(Clone, Debug, PartialEq)]
pub struct SeriesEntry {
    /// Air pressure, kPa, as the time.
    pub time: f64,
    /// Number of the part shown at this time: 0 for the body, 1 for the contact faces.
    pub part: usize,
    /// File name relative to the series file.
    pub file: String,
}

/// The text of a `.pvd` file, ParaView's list of files over time.
pub fn series(entries: &[SeriesEntry]) -> String {
    let mut text = String::from("<?xml version=\"1.0\"?>\n");
    text += "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n";
    for SeriesEntry { time, part, file } in entries {
        let file = escape(file);
        text += &format!("<DataSet timestep=\"{time}\" group=\"\" part=\"{part}\" file=\"{file}\"/>\n");
    }
    text + "</Collection>\n</VTKFile>\n"
}

fn section(text: &mut String, name: &str, fields: &[Field]) {
    *text += &format!("<{name}>\n");
    for field in fields {
        // A scalar with an explicit single component would be read as a list of lists by some.
        let mut attributes = match field.width() {
            1 => String::new(),
            width => format!(" NumberOfComponents=\"{width}\""),
        };
        for (i, component) in field.components.iter().enumerate() {
            // Writing to a string cannot fail.
            let _ = write!(attributes, " ComponentName{i}=\"{component}\"");
        }
        let values = bytes(&field.values, |x| x.to_le_bytes());
        array(text, "Float64", &escape(&field.name), &attributes, values);
    }
    *text += &format!("</{name}>\n");
}

fn bytes<T, const N: usize>(values: &[T], encode: impl Fn(&T) -> [u8; N]) -> Vec<u8> {
    values.iter().flat_map(encode).collect()
}

fn array(text: &mut String, kind: &str, name: &str, attributes: &str, data: Vec<u8>) {
    *text += &format!("<DataArray type=\"{kind}\" Name=\"{name}\"{attributes} format=\"binary\">\n");
    let mut block = (data.len() as u64).to_le_bytes().to_vec();
    block.extend(data);
    STANDARD.encode_string(&block, text);
    *text += "\n</DataArray>\n";
}

/// Text as it may stand in XML.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_of_the_wrong_length_and_undefined_numbers_are_refused() {
        let mut grid = Grid { points: vec![[0.0; 3]; 8], ..Grid::default() };
        grid.push_cell(12, 0..8);
        assert!(grid.to_vtu().unwrap().contains("NumberOfPoints=\"8\" NumberOfCells=\"1\""));
        grid.point_data.push(Field::vector("displacement", vec![0.0; 23]));
        assert_eq!(
            grid.to_vtu().unwrap_err(),
            PostError::WrongLength { what: "displacement".into(), expected: 24, found: 23 }
        );
        grid.point_data[0].values = vec![f64::NAN; 24];
        assert_eq!(grid.to_vtu().unwrap_err(), PostError::NotFinite { what: "displacement".into() });
    }

    #[test]
    fn a_series_names_its_files() {
        let text = series(&[SeriesEntry { time: 35.0, part: 1, file: "a&b.vtu".into() }]);
        assert!(text.contains("timestep=\"35\" group=\"\" part=\"1\" file=\"a&amp;b.vtu\""));
    }
}
