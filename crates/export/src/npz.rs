//! Arrays for numpy: `.npz`, a ZIP archive of `.npy` files that are stored as they are.

use pneuflex_mesh::Mesh;
use pneuflex_model::Problem;
use pneuflex_report::state::State;

use crate::error::ExportError;
use crate::nodes::parameter;

/// An array in the order of C.
struct Array {
    name: String,
    /// Type in numpy's words.
    kind: &'static str,
    shape: Vec<usize>,
    bytes: Vec<u8>,
}

impl Array {
    fn floats(name: &str, shape: &[usize], numbers: impl IntoIterator<Item = f64>) -> Self {
        let bytes = numbers.into_iter().flat_map(f64::to_le_bytes).collect();
        Self { name: name.into(), kind: "<f8", shape: shape.into(), bytes }
    }

    fn integers(name: String, shape: &[usize], numbers: impl IntoIterator<Item = u32>) -> Self {
        let bytes = numbers.into_iter().flat_map(u32::to_le_bytes).collect();
        Self { name, kind: "<u4", shape: shape.into(), bytes }
    }

    /// The bytes of its `.npy` file.
    fn npy(&self) -> Vec<u8> {
        let lengths: String = self.shape.iter().map(|length| format!("{length},")).collect();
        let mut header = format!("{{'descr': '{}', 'fortran_order': False, 'shape': ({lengths}), }}", self.kind);
        // The numbers begin at a multiple of 64 bytes.
        const BEFORE: usize = 10;
        let length = (BEFORE + header.len() + 1).next_multiple_of(64) - BEFORE;
        header.extend(std::iter::repeat_n(' ', length - header.len() - 1));
        let mut file = b"\x93NUMPY\x01\x00".to_vec();
        file.extend((length as u16).to_le_bytes());
        file.extend(header.bytes().chain([b'\n']));
        file.extend(&self.bytes);
        file
    }
}

/// The bytes of a file with `nodes` (mm), for every state `pressure_kpa` (or `time`), `displacement` (mm), `von_mises` and `contact_pressure`
/// (MPa) at the nodes, the nodes of the elements of every kind (`cells_hexahedron_27` and so on, in VTK's order, from 0), and the planes of
/// symmetry at which the body is cut (`symmetry`: axis and place, mm).
///
/// # Errors
/// [`ExportError::TooLarge`] beyond the 4 GB that the format counts.
pub fn write(problem: &Problem, states: &[&State]) -> Result<Vec<u8>, ExportError> {
    let mesh = &problem.mesh;
    let (count, nodes) = (states.len(), mesh.num_nodes());
    let scalars = |name: &str, of: fn(&State) -> &[f64]| {
        Array::floats(name, &[count, nodes], states.iter().flat_map(|state| of(state).iter().copied()))
    };
    let displacement = states.iter().flat_map(|state| state.displacement.as_flattened().iter().copied());
    let planes = problem.symmetry.iter().flat_map(|plane| [plane.axis as f64, plane.at]);
    let mut arrays = vec![
        Array::floats("nodes", &[nodes, 3], mesh.nodes.as_flattened().iter().copied()),
        Array::floats(parameter(problem), &[count], states.iter().map(|state| state.time)),
        Array::floats("displacement", &[count, nodes, 3], displacement),
        scalars("von_mises", |state| &state.von_mises),
        scalars("contact_pressure", |state| &state.contact_pressure),
        Array::floats("symmetry", &[problem.symmetry.len(), 2], planes),
    ];
    arrays.extend(cells(mesh));
    archive(&arrays)
}

fn cells(mesh: &Mesh) -> Vec<Array> {
    let of_family = |kind: &pneuflex_mesh::ElementKind| {
        let elements = (0..mesh.num_elements()).filter(|&element| mesh.kind_of(element) == *kind);
        let numbers: Vec<u32> = elements.flat_map(|element| mesh.element(element).iter().copied()).collect();
        let width = kind.num_nodes();
        let body = format!("{:?}", kind.body).to_lowercase();
        Array::integers(format!("cells_{body}_{width}"), &[numbers.len() / width, width], numbers)
    };
    mesh.families().iter().map(of_family).collect()
}

/// A ZIP archive of files that are stored as they are.
fn archive(arrays: &[Array]) -> Result<Vec<u8>, ExportError> {
    let too_large = |_| ExportError::TooLarge { what: "bytes of an archive" };
    let mut file = Vec::new();
    let mut directory = Vec::new();
    for array in arrays {
        let (name, contents) = (format!("{}.npy", array.name), array.npy());
        let size = u32::try_from(contents.len()).map_err(too_large)?;
        let offset = u32::try_from(file.len()).map_err(too_large)?;
        // Version, flags, method (none), time, date (the first that there is), checksum, sizes, lengths of name and further fields.
        let mut common = Vec::new();
        for number in [20_u16, 0, 0, 0, 0x21] {
            common.extend(number.to_le_bytes());
        }
        for number in [crc32fast::hash(&contents), size, size] {
            common.extend(number.to_le_bytes());
        }
        for number in [name.len() as u16, 0] {
            common.extend(number.to_le_bytes());
        }
        file.extend(b"PK\x03\x04");
        file.extend(&common);
        file.extend(name.bytes());
        file.extend(contents);
        directory.extend(b"PK\x01\x02\x14\x00");
        directory.extend(common);
        // Comment, disk, attributes: none.
        directory.extend([0; 10]);
        directory.extend(offset.to_le_bytes());
        directory.extend(name.bytes());
    }
    let (begin, length) = (u32::try_from(file.len()).map_err(too_large)?, directory.len() as u32);
    file.extend(directory);
    file.extend(b"PK\x05\x06\x00\x00\x00\x00");
    let count = arrays.len() as u16;
    file.extend([count, count].map(u16::to_le_bytes).as_flattened());
    file.extend([length, begin].map(u32::to_le_bytes).as_flattened());
    file.extend([0; 2]);
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{states, two_chambers};
    use pneuflex_model::Formulation;

    /// The arrays of a file by way of its directory: name, header, numbers.
    fn read(file: &[u8]) -> Vec<(String, String, Vec<u8>)> {
        let short = |at: usize| usize::from(u16::from_le_bytes(file[at..at + 2].try_into().unwrap()));
        let long = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
        let end = file.len() - 22;
        assert_eq!(&file[end..end + 4], b"PK\x05\x06");
        let (count, mut at) = (short(end + 10), long(end + 16));
        let mut found = Vec::new();
        for _ in 0..count {
            assert_eq!(&file[at..at + 4], b"PK\x01\x02");
            let (sum, size, name, local) = (long(at + 16), long(at + 24), short(at + 28), long(at + 42));
            let name_here = String::from_utf8(file[at + 46..at + 46 + name].to_vec()).unwrap();
            assert_eq!((&file[local..local + 4], short(local + 26)), (&b"PK\x03\x04"[..], name));
            let contents = &file[local + 30 + name..local + 30 + name + size];
            assert_eq!(crc32fast::hash(contents) as usize, sum);
            assert_eq!(&contents[..8], b"\x93NUMPY\x01\x00");
            let begin = 10 + usize::from(u16::from_le_bytes([contents[8], contents[9]]));
            assert_eq!(begin % 64, 0);
            let header = String::from_utf8(contents[10..begin].to_vec()).unwrap();
            assert!(header.ends_with('\n'));
            found.push((name_here, header.trim_end().to_owned(), contents[begin..].to_vec()));
            at += 46 + name;
        }
        assert_eq!(at, end);
        found
    }

    #[test]
    fn the_arrays_are_there_with_shapes_and_numbers() {
        let problem = two_chambers(Formulation::Hex27);
        let states = states(&problem, &[0.5, 1.5]);
        let arrays = read(&write(&problem, &states.iter().collect::<Vec<_>>()).unwrap());
        let names: Vec<&str> = arrays.iter().map(|(name, ..)| name.as_str()).collect();
        let expected = [
            "nodes",
            "pressure_kpa",
            "displacement",
            "von_mises",
            "contact_pressure",
            "symmetry",
            "cells_hexahedron_27",
        ];
        assert_eq!(names, expected.map(|name| format!("{name}.npy")));
        let nodes = problem.mesh.num_nodes();
        assert_eq!(arrays[2].1, format!("{{'descr': '<f8', 'fortran_order': False, 'shape': (2,{nodes},3,), }}"));
        assert!(arrays[1].1.contains("'shape': (2,)"));
        let floats =
            |bytes: &[u8]| -> Vec<f64> { bytes.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b)).collect() };
        let displacement = floats(&arrays[2].2);
        assert_eq!(displacement[3 * nodes..], *states[1].displacement.as_flattened());
        assert_eq!((floats(&arrays[1].2), floats(&arrays[5].2)), (vec![5.0, 15.0], vec![1.0, 0.0]));
        let cells: Vec<u32> = arrays[6].2.as_chunks().0.iter().map(|b| u32::from_le_bytes(*b)).collect();
        assert_eq!(cells, problem.mesh.connectivity);
    }
}
