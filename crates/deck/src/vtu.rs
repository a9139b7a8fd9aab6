//! `.vtu` files of unstructured grids (VTK's XML format) → a mesh with named sets: arrays as text, as base64 in their place, or appended as base64 or
//! as they are; compressed by zlib or not; of either byte order. What cells and their data become is what it is for `.vtk` (`vtk_cells`).
//!
//! "File Formats for VTK Version 4.2", chapter *XML file formats*, and VTK's `vtkXMLDataReader` for compression.

use std::io::Read as _;

use base64::Engine;
use base64::engine::GeneralPurpose;
use base64::engine::general_purpose::{GeneralPurposeConfig, STANDARD};
use roxmltree::{Document, Node};

use crate::raw_mesh::{MeshFile, RawMesh};
use crate::report::{DeckError, quoted};
use crate::vtk_cells::{CellData, Cells, raw_mesh};

/// All arrays of a file together may be this many times as long as the file, and [`FREE`] bytes more: what is compressed further is no mesh.
const MOST_INFLATED: usize = 100;
const FREE: usize = 1 << 20;

/// Reads a `.vtu` file called `name` from its bytes.
///
/// # Errors
/// What is wrong or not supported.
pub fn read(name: &str, bytes: &[u8]) -> Result<MeshFile, Vec<DeckError>> {
    RawMesh::finish(mesh(bytes).map_err(|why| (1, why)), name)
}

/// Where arrays come from.
struct Source<'a> {
    is_big_endian: bool,
    /// Bytes of a count in front of an array.
    header: usize,
    is_compressed: bool,
    /// What is appended behind the text, and whether it is base64.
    appended: Option<(&'a [u8], bool)>,
    /// Bytes that compressed arrays may still have.
    left: usize,
}

fn mesh(bytes: &[u8]) -> Result<RawMesh, String> {
    // Behind the underscore the appended data are bytes of any kind, which no reader of XML can bear.
    const APPENDED: &[u8] = b"<AppendedData";
    let mut text = bytes.to_vec();
    let mut appended = None;
    if let Some(at) = bytes.windows(APPENDED.len()).position(|window| window == APPENDED) {
        let rest = &bytes[at..];
        let begin = rest.iter().position(|byte| *byte == b'_').ok_or("AppendedData has no _ before its data")?;
        let is_base64 = String::from_utf8_lossy(&rest[..begin]).contains("base64");
        appended = Some((&rest[begin + 1..], is_base64));
        text.truncate(at);
        text.extend_from_slice(b"</VTKFile>");
    }
    let text = std::str::from_utf8(&text).map_err(|_| "the file is no text")?;
    let document = Document::parse(text).map_err(|why| format!("not an XML file: {why}"))?;
    let root = document.root_element();
    let kind = root.attribute("type").unwrap_or_default();
    if !root.has_tag_name("VTKFile") || kind != "UnstructuredGrid" {
        return Err(format!("the file is {} and not UnstructuredGrid, which alone has elements", quoted(kind)));
    }
    let is_compressed = match root.attribute("compressor") {
        None => false,
        Some("vtkZLibDataCompressor") => true,
        Some(other) => return Err(format!("{} is not supported: compress by zlib, or not at all", quoted(other))),
    };
    let header = match root.attribute("header_type") {
        None | Some("UInt32") => 4,
        Some("UInt64") => 8,
        Some(other) => return Err(format!("header_type is {}, not UInt32 or UInt64", quoted(other))),
    };
    let is_big_endian = root.attribute("byte_order") == Some("BigEndian");
    let left = MOST_INFLATED.saturating_mul(bytes.len()).saturating_add(FREE);
    let mut source = Source { is_big_endian, header, is_compressed, appended, left };
    let grid = child(root, "UnstructuredGrid").ok_or("the file has no UnstructuredGrid")?;
    let mut points: Vec<[f64; 3]> = Vec::new();
    let mut cells = Cells::default();
    for piece in grid.children().filter(|node| node.has_tag_name("Piece")) {
        source.piece(piece, &mut points, &mut cells)?;
    }
    if cells.types.is_empty() {
        return Err("the file has no cells".into());
    }
    raw_mesh((0..).zip(points).collect(), cells)
}

fn child<'a, 'input>(node: Node<'a, 'input>, name: &str) -> Option<Node<'a, 'input>> {
    node.children().find(|child| child.has_tag_name(name))
}

fn arrays<'a, 'input>(section: Node<'a, 'input>) -> impl Iterator<Item = Node<'a, 'input>> {
    section.children().filter(|node| node.has_tag_name("DataArray"))
}

fn name_of(array: Node<'_, '_>) -> String {
    array.attribute("Name").unwrap_or("without a name").to_owned()
}

/// Types of numbers: bytes of each, and whether they are whole, with a sign.
fn type_of(array: Node<'_, '_>) -> Result<(usize, bool, bool), String> {
    Ok(match array.attribute("type").unwrap_or_default() {
        "Int8" => (1, true, true),
        "UInt8" => (1, true, false),
        "Int16" => (2, true, true),
        "UInt16" => (2, true, false),
        "Int32" => (4, true, true),
        "UInt32" => (4, true, false),
        "Int64" => (8, true, true),
        "UInt64" => (8, true, false),
        "Float32" => (4, false, true),
        "Float64" => (8, false, true),
        other => return Err(format!("array {}: {} is no type of numbers", quoted(&name_of(array)), quoted(other))),
    })
}

impl Source<'_> {
    fn piece(&mut self, piece: Node<'_, '_>, points: &mut Vec<[f64; 3]>, cells: &mut Cells) -> Result<(), String> {
        let section = |name: &'static str| child(piece, name).ok_or(format!("a piece has no {name}"));
        let first = points.len() as u64;
        let of_points = section("Points")?;
        let positions = self.reals(arrays(of_points).next().ok_or("Points has no array")?)?;
        if let Some(bad) = positions.iter().find(|x| !(x.is_finite() && x.abs() < 1e100)) {
            return Err(format!("{bad} is no position"));
        }
        points.extend(positions.as_chunks::<3>().0);
        let count = positions.len() as u64 / 3;
        let of_cells = section("Cells")?;
        let mut array = |name: &str| {
            let found = arrays(of_cells).find(|array| array.attribute("Name") == Some(name));
            self.integers(found.ok_or(format!("Cells has no array {name}"))?)
        };
        let (connectivity, offsets, types) = (array("connectivity")?, array("offsets")?, array("types")?);
        if offsets.len() != types.len() {
            return Err(format!("{} cells have {} types", offsets.len(), types.len()));
        }
        let mut begin = 0;
        for &end in &offsets {
            let range = usize::try_from(begin).ok().zip(usize::try_from(end).ok());
            let nodes = range.and_then(|(begin, end)| connectivity.get(begin..end));
            let node = |tag: &i64| u64::try_from(*tag).ok().filter(|tag| *tag < count).map(|tag| tag + first);
            let nodes = nodes.and_then(|nodes| nodes.iter().map(node).collect::<Option<Vec<u64>>>());
            cells.nodes.push(nodes.ok_or("an offset or a node of a cell is out of range")?);
            begin = end;
        }
        let before = cells.types.len();
        cells.types.extend(&types);
        for array in child(piece, "CellData").into_iter().flat_map(arrays) {
            let is_single = array.attribute("NumberOfComponents").is_none_or(|count| count == "1" || count == "0");
            if !is_single || !type_of(array).is_ok_and(|(_, is_whole, _)| is_whole) {
                continue;
            }
            let (name, values) = (name_of(array), self.integers(array)?);
            if values.len() == types.len() {
                add(&mut cells.data, name, before, values);
            }
        }
        Ok(())
    }

    fn reals(&mut self, array: Node<'_, '_>) -> Result<Vec<f64>, String> {
        let (bytes, is_whole, _) = type_of(array)?;
        if array.attribute("format") == Some("ascii") {
            return text_of(array).split_ascii_whitespace().map(crate::syntax::real).collect();
        }
        if is_whole {
            return Ok(self.integers(array)?.into_iter().map(|value| value as f64).collect());
        }
        let data = self.bytes(array)?;
        let number = |chunk: &[u8]| {
            let word = self.word(chunk);
            if bytes == 4 { f64::from(f32::from_bits(word as u32)) } else { f64::from_bits(word) }
        };
        Ok(data.chunks_exact(bytes).map(number).collect())
    }

    fn integers(&mut self, array: Node<'_, '_>) -> Result<Vec<i64>, String> {
        let (bytes, is_whole, is_signed) = type_of(array)?;
        if !is_whole {
            return Err(format!("array {}: whole numbers are needed", quoted(&name_of(array))));
        }
        if array.attribute("format") == Some("ascii") {
            let number = |word: &str| word.parse().map_err(|_| format!("{} is not a whole number", quoted(word)));
            return text_of(array).split_ascii_whitespace().map(number).collect();
        }
        let data = self.bytes(array)?;
        let number = |chunk: &[u8]| {
            let word = self.word(chunk);
            let shift = 64 - 8 * bytes as u32;
            if is_signed { ((word << shift) as i64) >> shift } else { i64::try_from(word).unwrap_or(-1) }
        };
        Ok(data.chunks_exact(bytes).map(number).collect())
    }

    /// A number of up to eight bytes, its first ones zero.
    fn word(&self, chunk: &[u8]) -> u64 {
        let add = |word: u64, byte: &u8| word << 8 | u64::from(*byte);
        if self.is_big_endian { chunk.iter().fold(0, add) } else { chunk.iter().rev().fold(0, add) }
    }

    /// The numbers of an array that is no text, as bytes.
    fn bytes(&mut self, array: Node<'_, '_>) -> Result<Vec<u8>, String> {
        let wrong = |what: &str| format!("array {}: {what}", quoted(&name_of(array)));
        let (data, is_base64) = match array.attribute("format") {
            Some("binary") => (text_of(array).trim().as_bytes(), true),
            Some("appended") => {
                let (all, is_base64) = self.appended.ok_or_else(|| wrong("nothing is appended"))?;
                let offset = array.attribute("offset").and_then(|offset| offset.trim().parse::<usize>().ok());
                let data = offset.and_then(|offset| all.get(offset..));
                (data.ok_or_else(|| wrong("its offset lies beyond the appended data"))?, is_base64)
            }
            _ => return Err(wrong("format is neither ascii nor binary nor appended")),
        };
        let found = if self.is_compressed { self.inflated(data, is_base64) } else { self.plain(data, is_base64) };
        found.ok_or_else(|| wrong("its data end too early, or are damaged"))
    }

    fn plain(&self, data: &[u8], is_base64: bool) -> Option<Vec<u8>> {
        let header = self.header;
        let head = decoded(data, is_base64, 0, header)?;
        let length = usize::try_from(self.word(&head)).ok()?;
        // Some writers encode the count by itself: its padding tells.
        let own = encoded_length(header);
        if is_base64 && data.get(own - 1) == Some(&b'=') && length > 0 {
            return decoded(&data[own..], true, 0, length);
        }
        decoded(data, is_base64, header, length)
    }

    /// Blocks that are compressed one by one, behind a header of their number, length, the last one's length, and their compressed lengths.
    fn inflated(&mut self, data: &[u8], is_base64: bool) -> Option<Vec<u8>> {
        let header = self.header;
        let words = |bytes: &[u8]| -> Option<Vec<usize>> {
            bytes.chunks_exact(header).map(|chunk| usize::try_from(self.word(chunk)).ok()).collect()
        };
        let first = words(&decoded(data, is_base64, 0, 3 * header)?)?;
        let [blocks, length, last] = first[..] else { return None };
        let head = blocks.checked_add(3)?.checked_mul(header)?;
        let compressed = words(&decoded(data, is_base64, 3 * header, head - 3 * header)?)?;
        let mut rest = data.get(if is_base64 { encoded_length(head) } else { head }..)?;
        let total = compressed.iter().try_fold(0_usize, |sum, length| sum.checked_add(*length))?;
        let all;
        if is_base64 {
            all = decoded(rest, true, 0, total)?;
            rest = &all;
        }
        let mut found = Vec::new();
        for (number, &size) in compressed.iter().enumerate() {
            let (block, after) = rest.split_at_checked(size)?;
            rest = after;
            let wanted = if number + 1 == blocks && last > 0 { last } else { length };
            self.left = self.left.checked_sub(wanted)?;
            let before = found.len();
            flate2::read::ZlibDecoder::new(block).take(wanted as u64).read_to_end(&mut found).ok()?;
            if found.len() - before != wanted {
                return None;
            }
        }
        Some(found)
    }
}

/// Adds the values of one piece to the data of a name; other pieces have −1.
fn add(data: &mut CellData, name: String, before: usize, values: Vec<i64>) {
    let known = data.iter().position(|(other, _)| *other == name).unwrap_or(data.len());
    if known == data.len() {
        data.push((name, Vec::new()));
    }
    let all = &mut data[known].1;
    all.resize(before.max(all.len()), -1);
    all.extend(values);
}

fn text_of<'a>(array: Node<'a, '_>) -> &'a str {
    array.text().unwrap_or_default()
}

/// Characters of so many bytes in base64.
const fn encoded_length(bytes: usize) -> usize {
    bytes.div_ceil(3).saturating_mul(4)
}

/// `length` bytes from the byte `from` on; `None` if there are not that many.
fn decoded(data: &[u8], is_base64: bool, from: usize, length: usize) -> Option<Vec<u8>> {
    let end = from.checked_add(length)?;
    if !is_base64 {
        return Some(data.get(from..end)?.to_vec());
    }
    // What stands behind in the same group of four characters is cut off, whatever its last bits are.
    const LENIENT: GeneralPurpose = GeneralPurpose::new(
        &base64::alphabet::STANDARD,
        GeneralPurposeConfig::new().with_decode_allow_trailing_bits(true),
    );
    let first = from / 3;
    let characters = data.get(4 * first..encoded_length(end).min(data.len()))?;
    let bytes = LENIENT.decode(characters).or_else(|_| STANDARD.decode(characters)).ok()?;
    Some(bytes.get(from - 3 * first..end - 3 * first)?.to_vec())
}
