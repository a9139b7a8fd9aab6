//! Reading back the `.vtu` files of this crate.
//!
//! Only what [`Grid::to_vtu`] writes is understood: one piece, inline base64 of uncompressed little-endian numbers behind
//! a 64-bit byte count. Anything else is an error that names the array and what is wrong with it.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use roxmltree::{Document, Node};

use super::{Field, Grid};

/// A text that is no `.vtu` file of this crate.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum VtuError {
    /// Not XML.
    #[error("not an XML file: {0}")]
    Xml(String),
    /// XML of another kind, or a variety that is not written here.
    #[error("not a VTK unstructured grid as written by this program: {0}")]
    Kind(String),
    /// An array that cannot be decoded or does not fit the grid.
    #[error("array `{name}`: {what}")]
    Array {
        /// Name of the array.
        name: String,
        /// What is wrong.
        what: String,
    },
}

impl Grid {
    /// The grid of a `.vtu` file written by [`Grid::to_vtu`].
    ///
    /// # Errors
    /// [`VtuError`] for any other text.
    pub fn from_vtu(text: &str) -> Result<Self, VtuError> {
        let document = Document::parse(text).map_err(|e| VtuError::Xml(e.to_string()))?;
        let root = document.root_element();
        for (name, expected) in
            [("type", "UnstructuredGrid"), ("byte_order", "LittleEndian"), ("header_type", "UInt64")]
        {
            let found = root.attribute(name).unwrap_or("none");
            if found != expected {
                return Err(VtuError::Kind(format!("{name} is {found} instead of {expected}")));
            }
        }
        let grid = child(root, "UnstructuredGrid")?;
        let piece = child(grid, "Piece")?;
        let points = numbers(array(child(piece, "Points")?, "Points")?, "Float64", f64::from_le_bytes)?;
        let cells = child(piece, "Cells")?;
        let connectivity = numbers(array(cells, "connectivity")?, "Int64", i64::from_le_bytes)?;
        let ends = numbers(array(cells, "offsets")?, "Int64", i64::from_le_bytes)?;
        let mut read = Self {
            points: points.chunks_exact(3).map(|x| [x[0], x[1], x[2]]).collect(),
            connectivity: connectivity.iter().map(|&n| u32::try_from(n).unwrap_or(u32::MAX)).collect(),
            offsets: ends.iter().map(|&n| u64::try_from(n).unwrap_or(u64::MAX)).collect(),
            cell_types: numbers(array(cells, "types")?, "UInt8", |[b]: [u8; 1]| b)?,
            ..Self::default()
        };
        let times = numbers(array(child(grid, "FieldData")?, "TimeValue")?, "Float64", f64::from_le_bytes)?;
        read.time = *times.first().ok_or_else(|| wrong("TimeValue", "is empty".into()))?;
        read.check_cells(piece, points.len())?;
        read.point_data = fields(child(piece, "PointData")?, read.points.len())?;
        read.cell_data = fields(child(piece, "CellData")?, read.cell_types.len())?;
        Ok(read)
    }

    /// The values of a point field by its name.
    pub fn point_values(&self, name: &str) -> Option<&[f64]> {
        self.point_data.iter().find(|field| field.name == name).map(|field| field.values.as_slice())
    }

    fn check_cells(&self, piece: Node<'_, '_>, coordinates: usize) -> Result<(), VtuError> {
        let count = |name: &str| piece.attribute(name).and_then(|n| n.parse::<usize>().ok());
        if count("NumberOfPoints") != Some(self.points.len()) || coordinates != 3 * self.points.len() {
            return Err(wrong("Points", format!("holds {coordinates} numbers, not three for every point")));
        }
        if count("NumberOfCells") != Some(self.cell_types.len()) || self.offsets.len() != self.cell_types.len() {
            let found = self.offsets.len();
            return Err(wrong("offsets", format!("holds {found} numbers, not one for every cell")));
        }
        if self.connectivity.iter().any(|&n| n as usize >= self.points.len()) {
            return Err(wrong("connectivity", "names a point that does not exist".into()));
        }
        let rising = self.offsets.windows(2).all(|w| w[0] <= w[1]);
        if !rising || self.offsets.last().copied().unwrap_or(0) != self.connectivity.len() as u64 {
            return Err(wrong("offsets", "does not divide the connectivity into cells".into()));
        }
        Ok(())
    }
}

fn wrong(name: &str, what: String) -> VtuError {
    VtuError::Array { name: name.into(), what }
}

fn child<'a, 'input>(node: Node<'a, 'input>, name: &str) -> Result<Node<'a, 'input>, VtuError> {
    let mut found = node.children().filter(|c| c.has_tag_name(name));
    match (found.next(), found.next()) {
        (Some(one), None) => Ok(one),
        (None, _) => Err(VtuError::Kind(format!("no {name} in {}", node.tag_name().name()))),
        _ => Err(VtuError::Kind(format!("more than one {name}"))),
    }
}

fn array<'a, 'input>(section: Node<'a, 'input>, name: &str) -> Result<Node<'a, 'input>, VtuError> {
    let is_it = |c: &Node<'_, '_>| c.has_tag_name("DataArray") && c.attribute("Name") == Some(name);
    section.children().find(is_it).ok_or_else(|| wrong(name, format!("is missing in {}", section.tag_name().name())))
}

fn fields(section: Node<'_, '_>, count: usize) -> Result<Vec<Field>, VtuError> {
    let read = |node: Node<'_, '_>| {
        let name = node.attribute("Name").unwrap_or_default();
        let components: Vec<String> =
            (0..).map_while(|i| node.attribute(format!("ComponentName{i}").as_str())).map(str::to_owned).collect();
        let field = Field { name: name.into(), components, values: numbers(node, "Float64", f64::from_le_bytes)? };
        let expected = count * field.width();
        if field.values.len() != expected {
            return Err(wrong(name, format!("holds {} numbers instead of {expected}", field.values.len())));
        }
        Ok(field)
    };
    section.children().filter(|c| c.has_tag_name("DataArray")).map(read).collect()
}

fn numbers<T, const N: usize>(
    node: Node<'_, '_>,
    kind: &str,
    decode: impl Fn([u8; N]) -> T,
) -> Result<Vec<T>, VtuError> {
    let name = node.attribute("Name").unwrap_or_default();
    let error = |what: String| Err(wrong(name, what));
    for (attribute, expected) in [("type", kind), ("format", "binary")] {
        let found = node.attribute(attribute).unwrap_or("none");
        if found != expected {
            return error(format!("{attribute} is {found} instead of {expected}"));
        }
    }
    let Ok(block) = STANDARD.decode(node.text().unwrap_or_default().trim()) else {
        return error("is not base64".into());
    };
    let Some((head, data)) = block.split_first_chunk::<8>() else {
        return error("has no byte count".into());
    };
    let announced = u64::from_le_bytes(*head);
    if announced != data.len() as u64 || !data.len().is_multiple_of(N) {
        return error(format!("announces {announced} bytes and holds {}", data.len()));
    }
    let (chunks, _) = data.as_chunks::<N>();
    Ok(chunks.iter().map(|chunk| decode(*chunk)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface_stress::SurfaceState;
    use crate::testing::{displacement_of, two_chambers};
    use crate::{contact, fields, stress};
    use pneuflex_model::LoadParameter;

    fn state() -> Grid {
        let problem = two_chambers(2.0);
        let u = displacement_of(&problem, |x| [0.01 * x[2], 0.0, -1e-3 * x[0] * x[0]]);
        let (stress, contact) = (stress::recover(&problem, &u).unwrap(), contact::evaluate(&problem, &u).unwrap());
        let parameter = LoadParameter(35.0);
        let state = SurfaceState { displacement: &u, parameter, pressures: &[], contact: &contact };
        fields::body(&problem, &stress, &state).unwrap()
    }

    #[test]
    fn a_state_comes_back_bit_for_bit() {
        let mut grid = state();
        grid.point_data.push(Field::scalar("a < \"b\" & c", vec![1.5; grid.points.len()]));
        let read = Grid::from_vtu(&grid.to_vtu().unwrap()).unwrap();
        assert_eq!(read, grid);
        assert!(read.point_values("displacement").unwrap().iter().any(|u| *u != 0.0));
        assert_eq!(read.point_values("nothing"), None);
    }

    #[test]
    fn other_texts_are_errors_that_say_why() {
        let text = state().to_vtu().unwrap();
        let fails = |text: &str, reason: &str| {
            let message = Grid::from_vtu(text).unwrap_err().to_string();
            assert!(message.contains(reason), "{message}");
        };
        fails("points: 3", "not an XML file");
        fails("<VTKFile type=\"ImageData\"/>", "ImageData instead of UnstructuredGrid");
        fails(&text.replace("LittleEndian", "BigEndian"), "BigEndian instead of LittleEndian");
        fails(&text.replace("\"UInt64\"", "\"UInt32\""), "UInt32 instead of UInt64");
        fails(&text.replace("Name=\"offsets\"", "Name=\"ends\""), "array `offsets`: is missing in Cells");
        fails(&text.replace("format=\"binary\"", "format=\"ascii\""), "ascii instead of binary");
        let cut = |name: &str, by: usize| {
            let start = text.find(&format!("Name=\"{name}\"")).unwrap();
            let end = start + text[start..].find("\n</DataArray>").unwrap();
            format!("{}{}", &text[..end - by], &text[end..])
        };
        fails(&cut("displacement", 1), "array `displacement`: is not base64");
        fails(&cut("displacement", 8), "array `displacement`: announces");
        let cells = state().cell_types.len();
        let fewer = text.replace(&format!("NumberOfCells=\"{cells}\""), "NumberOfCells=\"1\"");
        fails(&fewer, "not one for every cell");
    }

    #[test]
    fn a_grid_whose_parts_do_not_fit_is_an_error() {
        let mut grid = state();
        grid.connectivity[3] = grid.points.len() as u32;
        let message = Grid::from_vtu(&grid.to_vtu().unwrap()).unwrap_err().to_string();
        assert!(message.contains("names a point that does not exist"), "{message}");
        let mut grid = state();
        grid.offsets[0] += 1000;
        let message = Grid::from_vtu(&grid.to_vtu().unwrap()).unwrap_err().to_string();
        assert!(message.contains("does not divide"), "{message}");
    }
}
