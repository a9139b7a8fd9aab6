//! Legacy `.vtk` files of unstructured grids, text or binary, versions 1 to 5.1 → a mesh with named sets.
//!
//! Data of cells that are whole numbers with few values become sets: of volumes, element sets, of surfaces, facet sets and node sets, called
//! after the data and the value, as in `material_2`. Other data are passed over. VTK's "File Formats for VTK Version 4.2", and the reader
//! `vtkUnstructuredGridReader` for what came later.

use std::collections::BTreeMap;

use crate::raw_mesh::{MeshFile, RawMesh};
use crate::report::{DeckError, quoted};
use crate::vtk_cells::{CellData, Cells, raw_mesh};

/// Reads a `.vtk` file called `name` from its bytes.
///
/// # Errors
/// What is wrong or not supported, by line; binary numbers are not counted in lines.
pub fn read(name: &str, bytes: &[u8]) -> Result<MeshFile, Vec<DeckError>> {
    let mut reader = Reader { bytes, at: 0, line: 1, is_binary: false };
    let read = reader.mesh().map_err(|why| (reader.line, why));
    RawMesh::finish(read, name)
}

/// A place in a file, behind which words and numbers are read.
struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    line: u32,
    is_binary: bool,
}

/// Types of numbers.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Type {
    Bit,
    Unsigned(usize),
    Signed(usize),
    Float,
    Double,
}

impl Type {
    fn of(name: &str) -> Result<Self, String> {
        Ok(match name.to_ascii_lowercase().as_str() {
            "bit" => Self::Bit,
            "unsigned_char" | "vtktypeuint8" => Self::Unsigned(1),
            "char" | "signed_char" | "vtktypeint8" => Self::Signed(1),
            "unsigned_short" | "vtktypeuint16" => Self::Unsigned(2),
            "short" | "vtktypeint16" => Self::Signed(2),
            "unsigned_int" | "vtktypeuint32" => Self::Unsigned(4),
            // Files with identifiers have had four bytes for each, whatever the machine.
            "int" | "vtktypeint32" | "vtkidtype" => Self::Signed(4),
            "unsigned_long" | "vtktypeuint64" => Self::Unsigned(8),
            "long" | "vtktypeint64" => Self::Signed(8),
            "float" | "vtktypefloat32" => Self::Float,
            "double" | "vtktypefloat64" => Self::Double,
            _ => return Err(format!("{} is no type of numbers", quoted(name))),
        })
    }

    const fn is_whole(self) -> bool {
        matches!(self, Self::Unsigned(_) | Self::Signed(_))
    }

    const fn bytes(self) -> usize {
        match self {
            Self::Bit => 1,
            Self::Unsigned(bytes) | Self::Signed(bytes) => bytes,
            Self::Float => 4,
            Self::Double => 8,
        }
    }
}

impl<'a> Reader<'a> {
    fn mesh(&mut self) -> Result<RawMesh, String> {
        let head = self.rest_of_line();
        if !head.starts_with("# vtk DataFile") {
            return Err("a legacy .vtk file begins with \"# vtk DataFile Version\"".into());
        }
        self.rest_of_line();
        let encoding = self.word()?;
        self.is_binary = match encoding.to_ascii_uppercase().as_str() {
            "ASCII" => false,
            "BINARY" => true,
            _ => return Err(format!("{} is neither ASCII nor BINARY", quoted(encoding))),
        };
        let (word, dataset) = (self.word()?, self.word()?);
        if !word.eq_ignore_ascii_case("DATASET") || !dataset.eq_ignore_ascii_case("UNSTRUCTURED_GRID") {
            let hint = if dataset.eq_ignore_ascii_case("POLYDATA") { ", a surface without an inside" } else { "" };
            return Err(format!("the dataset is {}{hint}; only UNSTRUCTURED_GRID has elements", quoted(dataset)));
        }
        let (mut nodes, mut cells, mut types) = (BTreeMap::new(), None, None);
        let mut data: CellData = Vec::new();
        // Tuples of the data that follow; `None` before there are any, and whether they are the cells'.
        let mut tuples: Option<(u64, bool)> = None;
        while let Some(keyword) = self.next_word() {
            match keyword.to_ascii_uppercase().as_str() {
                "POINTS" if nodes.is_empty() => {
                    let (count, kind) = (self.whole()?, Type::of(self.word()?)?);
                    self.begin(count.saturating_mul(3), kind)?;
                    for tag in 0..count {
                        nodes.insert(tag, [self.real(kind)?, self.real(kind)?, self.real(kind)?]);
                    }
                }
                "CELLS" if cells.is_none() => cells = Some(self.cells()?),
                "CELL_TYPES" if types.is_none() => {
                    let count = self.whole()?;
                    types = Some((self.integers(count, Type::Signed(4))?, self.line));
                }
                "CELL_DATA" => tuples = Some((self.whole()?, true)),
                "POINT_DATA" => tuples = Some((self.whole()?, false)),
                "METADATA" => while !self.rest_of_line().is_empty() {},
                "FIELD" => {
                    self.word()?;
                    for _ in 0..self.whole()? {
                        self.field(tuples.is_some_and(|(_, is_of_cells)| is_of_cells), &mut data)?;
                    }
                }
                other => {
                    let (count, is_of_cells) =
                        tuples.ok_or_else(|| format!("{} is no keyword here", quoted(keyword)))?;
                    self.attribute(other, count, is_of_cells, &mut data)?;
                }
            }
        }
        let (cells, line) = cells.ok_or("the file has no CELLS")?;
        let (types, _) = types.ok_or("the file has no CELL_TYPES")?;
        raw_mesh(nodes, Cells { nodes: cells, types, data, line })
    }

    /// Nodes of every cell, and the line behind which they stand.
    fn cells(&mut self) -> Result<(Vec<Vec<u64>>, u32), String> {
        let (first, second) = (self.whole()?, self.whole()?);
        let line = self.line;
        let node = |tag: i64| u64::try_from(tag).map_err(|_| format!("{tag} is the number of no node"));
        let before = (self.at, self.line);
        if self.next_word().is_some_and(|word| word == "OFFSETS") {
            let kind = Type::of(self.word()?)?;
            let offsets = self.integers(first, kind)?;
            if self.next_word() != Some("CONNECTIVITY") {
                return Err("OFFSETS without CONNECTIVITY".into());
            }
            let kind = Type::of(self.word()?)?;
            let connectivity = self.integers(second, kind)?;
            let cell = |ends: &[i64]| {
                let range = usize::try_from(ends[0]).ok()?..usize::try_from(ends[1]).ok()?;
                connectivity.get(range)?.iter().map(|&tag| u64::try_from(tag).ok()).collect::<Option<Vec<u64>>>()
            };
            let cells = offsets
                .windows(2)
                .map(|ends| cell(ends).ok_or("an offset or a node of a cell is out of range".to_owned()));
            return Ok((cells.collect::<Result<_, String>>()?, line));
        }
        (self.at, self.line) = before;
        let kind = Type::Signed(4);
        self.begin(second, kind)?;
        let mut cells = Vec::new();
        let mut left = second;
        for _ in 0..first {
            let count = u64::try_from(self.integer(kind)?).map_err(|_| "a cell with a negative number of nodes")?;
            left = left.checked_sub(count.saturating_add(1)).ok_or("cells have more nodes than CELLS says")?;
            let mut nodes = Vec::with_capacity(count.min(64) as usize);
            for _ in 0..count {
                nodes.push(node(self.integer(kind)?)?);
            }
            cells.push(nodes);
        }
        Ok((cells, line))
    }

    /// An array of a FIELD.
    fn field(&mut self, is_of_cells: bool, data: &mut CellData) -> Result<(), String> {
        let mut name = self.word()?;
        // Between arrays of a field there may be what describes the one before.
        while name == "METADATA" {
            while !self.rest_of_line().is_empty() {}
            name = self.word()?;
        }
        let (components, tuples, kind) = (self.whole()?, self.whole()?, self.word()?);
        if kind.eq_ignore_ascii_case("string") {
            for _ in 0..tuples.min(self.bytes.len() as u64) {
                self.rest_of_line();
            }
            return Ok(());
        }
        let kind = Type::of(kind)?;
        self.values(name, components, tuples, kind, is_of_cells, data)
    }

    /// Data of points or cells.
    fn attribute(&mut self, keyword: &str, count: u64, is_of_cells: bool, data: &mut CellData) -> Result<(), String> {
        match keyword {
            "SCALARS" => {
                let (name, kind) = (self.word()?, Type::of(self.word()?)?);
                let rest = self.rest_of_line();
                let components = if rest.is_empty() { 1 } else { whole(rest)? };
                let before = (self.at, self.line);
                match self.next_word() {
                    Some("LOOKUP_TABLE") => {
                        self.word()?;
                    }
                    _ => (self.at, self.line) = before,
                }
                self.values(name, components, count, kind, is_of_cells, data)
            }
            "LOOKUP_TABLE" => {
                self.word()?;
                let entries = self.whole()?;
                let kind = if self.is_binary { Type::Unsigned(1) } else { Type::Float };
                self.values("", 4, entries, kind, false, data)
            }
            "COLOR_SCALARS" => {
                self.word()?;
                let components = self.whole()?;
                let kind = if self.is_binary { Type::Unsigned(1) } else { Type::Float };
                self.values("", components, count, kind, false, data)
            }
            "VECTORS" | "NORMALS" | "TENSORS" | "TENSORS6" => {
                let (_, kind) = (self.word()?, Type::of(self.word()?)?);
                let components = match keyword {
                    "TENSORS" => 9,
                    "TENSORS6" => 6,
                    _ => 3,
                };
                self.values("", components, count, kind, false, data)
            }
            "TEXTURE_COORDINATES" => {
                self.word()?;
                let (components, kind) = (self.whole()?, Type::of(self.word()?)?);
                self.values("", components, count, kind, false, data)
            }
            "GLOBAL_IDS" | "PEDIGREE_IDS" => {
                let (_, kind) = (self.word()?, Type::of(self.word()?)?);
                self.values("", 1, count, kind, false, data)
            }
            _ => Err(format!("{} is no keyword of data", quoted(keyword))),
        }
    }

    /// Values of an array, kept if they are a whole number for every cell.
    fn values(
        &mut self,
        name: &str,
        components: u64,
        tuples: u64,
        kind: Type,
        is_of_cells: bool,
        data: &mut CellData,
    ) -> Result<(), String> {
        let count = components.saturating_mul(tuples);
        if is_of_cells && components == 1 && kind.is_whole() {
            let values = self.integers(tuples, kind)?;
            data.push((name.to_owned(), values));
            return Ok(());
        }
        self.begin(count, kind)?;
        if self.is_binary {
            let bytes = if kind == Type::Bit { count.div_ceil(8) } else { count * kind.bytes() as u64 };
            self.at += bytes as usize;
        } else {
            // Words, whatever they say: nothing is done with them.
            for _ in 0..count {
                self.word()?;
            }
        }
        Ok(())
    }

    fn integers(&mut self, count: u64, kind: Type) -> Result<Vec<i64>, String> {
        self.begin(count, kind)?;
        (0..count).map(|_| self.integer(kind)).collect()
    }

    /// Goes to the first of some numbers, which must be there as far as the file's length tells.
    fn begin(&mut self, count: u64, kind: Type) -> Result<(), String> {
        if self.is_binary {
            // The numbers follow the end of the line.
            self.rest_of_line();
        }
        let left = self.bytes.len().saturating_sub(self.at) as u64;
        let least = match (self.is_binary, kind) {
            (true, Type::Bit) => count.div_ceil(8),
            (true, _) => count.saturating_mul(kind.bytes() as u64),
            // A digit and a blank, which the last one lacks.
            (false, _) => count.saturating_mul(2).saturating_sub(1),
        };
        if least > left { Err(format!("{count} numbers are announced, but the file ends before")) } else { Ok(()) }
    }

    fn integer(&mut self, kind: Type) -> Result<i64, String> {
        if !self.is_binary {
            let word = self.word()?;
            return word.parse().map_err(|_| format!("{} is not a whole number", quoted(word)));
        }
        let too_large = |value: u64| i64::try_from(value).map_err(|_| format!("{value} is too large a number"));
        Ok(match kind {
            Type::Unsigned(1) => i64::from(u8::from_be_bytes(self.take()?)),
            Type::Signed(1) => i64::from(i8::from_be_bytes(self.take()?)),
            Type::Unsigned(2) => i64::from(u16::from_be_bytes(self.take()?)),
            Type::Signed(2) => i64::from(i16::from_be_bytes(self.take()?)),
            Type::Unsigned(4) => i64::from(u32::from_be_bytes(self.take()?)),
            Type::Signed(4) => i64::from(i32::from_be_bytes(self.take()?)),
            Type::Unsigned(_) => too_large(u64::from_be_bytes(self.take()?))?,
            Type::Signed(_) => i64::from_be_bytes(self.take()?),
            Type::Bit | Type::Float | Type::Double => return Err("whole numbers are needed here".into()),
        })
    }

    /// A finite number.
    fn real(&mut self, kind: Type) -> Result<f64, String> {
        if !self.is_binary {
            return crate::syntax::real(self.word()?);
        }
        let value = match kind {
            Type::Float => f64::from(f32::from_be_bytes(self.take()?)),
            Type::Double => f64::from_be_bytes(self.take()?),
            whole => self.integer(whole)? as f64,
        };
        if value.is_finite() && value.abs() < 1e100 { Ok(value) } else { Err(format!("{value} is no position")) }
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let bytes = self.bytes.get(self.at..self.at + N).and_then(|bytes| bytes.try_into().ok());
        self.at += N;
        bytes.ok_or_else(|| "the file ends too early".to_owned())
    }

    fn whole(&mut self) -> Result<u64, String> {
        whole(self.word()?)
    }

    fn word(&mut self) -> Result<&'a str, String> {
        self.next_word().ok_or_else(|| "the file ends too early".to_owned())
    }

    /// What stands between blanks; `None` at the end of the file.
    fn next_word(&mut self) -> Option<&'a str> {
        while let Some(byte) = self.bytes.get(self.at).filter(|byte| byte.is_ascii_whitespace()) {
            self.line += u32::from(*byte == b'\n');
            self.at += 1;
        }
        let rest = self.bytes.get(self.at..)?;
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += length;
        (length > 0).then(|| std::str::from_utf8(&rest[..length]).unwrap_or("\u{fffd}"))
    }

    /// The rest of a line without blanks around it; nothing at the end of the file.
    fn rest_of_line(&mut self) -> &'a str {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let length = rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len());
        self.at += (length + 1).min(rest.len());
        self.line += 1;
        std::str::from_utf8(&rest[..length]).unwrap_or("\u{fffd}").trim()
    }
}

fn whole(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("{} is not a whole number of 0 or more", quoted(text)))
}
