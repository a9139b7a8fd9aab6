//! Sections of a `.msh` file of version 4.1 → nodes, elements, groups. Gmsh's manual, "MSH file format".

use std::collections::BTreeMap;

use super::cursor::{Cursor, Encoding};
use super::element_types::nodes_of_type;
use crate::report::quoted;

/// What a `.msh` file holds.
#[derive(Debug, Default)]
pub(super) struct Sections {
    /// Names of physical groups by dimension and tag.
    pub names: BTreeMap<(i32, i32), String>,
    /// Physical groups of the geometric entities, by dimension and tag.
    pub groups: BTreeMap<(i32, i32), Vec<i32>>,
    /// Positions by node tag.
    pub nodes: BTreeMap<u64, [f64; 3]>,
    pub elements: Vec<Element>,
}

/// An element as it is written.
#[derive(Debug)]
pub(super) struct Element {
    pub tag: u64,
    /// Gmsh's number of its type.
    pub kind: i32,
    /// Dimension and tag of the geometric entity that it belongs to.
    pub entity: (i32, i32),
    pub nodes: Vec<u64>,
    pub line: u32,
}

/// A line and what is wrong there.
pub(super) type Wrong = (u32, String);

/// Gmsh's pyramids with 5, 13 and 14 nodes.
const PYRAMIDS: [i32; 3] = [7, 19, 14];

impl Sections {
    pub fn read(bytes: &[u8]) -> Result<Self, Wrong> {
        let mut cursor = Cursor::new(bytes);
        let mut sections = Self::default();
        read_format(&mut cursor)?;
        let encoding = cursor.encoding;
        let (mut has_nodes, mut has_elements) = (false, false);
        while let Some(head) = cursor.next_full_line() {
            let line = cursor.line - 1;
            let Some(name) = head.strip_prefix('$') else {
                return Err((line, format!("{} is not the beginning of a section", quoted(head))));
            };
            cursor.encoding = if name == "PhysicalNames" { Encoding::Text } else { encoding };
            let read = match name {
                "PhysicalNames" => sections.physical_names(&mut cursor),
                "Entities" => sections.entities(&mut cursor),
                "PartitionedEntities" => {
                    Err("partitioned meshes are not supported; save the mesh in one piece".to_owned())
                }
                "Nodes" if std::mem::replace(&mut has_nodes, true) => Err("a second $Nodes".to_owned()),
                "Nodes" => sections.nodes(&mut cursor),
                "Elements" if std::mem::replace(&mut has_elements, true) => Err("a second $Elements".to_owned()),
                "Elements" => sections.elements(&mut cursor),
                _ => Ok(()),
            };
            read.map_err(|why| (cursor.line, format!("${}: {why}", short(name))))?;
            if !cursor.skip_behind(&format!("$End{name}")) {
                return Err((line, format!("${0} without $End{0}", short(name))));
            }
        }
        match (has_nodes, has_elements) {
            (true, true) => Ok(sections),
            (false, _) => Err((cursor.line, "the file has no $Nodes".to_owned())),
            _ => Err((cursor.line, "the file has no $Elements".to_owned())),
        }
    }

    fn physical_names(&mut self, cursor: &mut Cursor<'_>) -> Result<(), String> {
        for _ in 0..cursor.size()? {
            let key = (cursor.int()?, cursor.int()?);
            let name = cursor.next_line().unwrap_or_default().trim_matches('"');
            if name.is_empty() {
                return Err("a physical group needs a name".to_owned());
            }
            self.names.insert(key, name.to_owned());
        }
        Ok(())
    }

    fn entities(&mut self, cursor: &mut Cursor<'_>) -> Result<(), String> {
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = cursor.size()?;
        }
        for (count, dimension) in counts.into_iter().zip(0..) {
            for _ in 0..count {
                let tag = cursor.int()?;
                // A point's position, or the box around the entity.
                for _ in 0..if dimension == 0 { 3 } else { 6 } {
                    cursor.double()?;
                }
                let mut groups = Vec::new();
                for _ in 0..cursor.size()? {
                    // Negative where the entity is turned round.
                    groups.push(cursor.int()?.saturating_abs());
                }
                if dimension > 0 {
                    for _ in 0..cursor.size()? {
                        cursor.int()?;
                    }
                }
                self.groups.insert((dimension, tag), groups);
            }
        }
        Ok(())
    }

    fn nodes(&mut self, cursor: &mut Cursor<'_>) -> Result<(), String> {
        let blocks = cursor.size()?;
        for _ in 0..3 {
            cursor.size()?;
        }
        for _ in 0..blocks {
            let (dimension, _tag, parametric) = (cursor.int()?, cursor.int()?, cursor.int()?);
            let mut tags = Vec::new();
            for _ in 0..cursor.size()? {
                tags.push(cursor.size()?);
            }
            for tag in tags {
                let position = [cursor.double()?, cursor.double()?, cursor.double()?];
                if parametric != 0 {
                    for _ in 0..dimension.clamp(0, 3) {
                        cursor.double()?;
                    }
                }
                if self.nodes.insert(tag, position).is_some() {
                    return Err(format!("node {tag} is there twice"));
                }
            }
        }
        Ok(())
    }

    fn elements(&mut self, cursor: &mut Cursor<'_>) -> Result<(), String> {
        let blocks = cursor.size()?;
        for _ in 0..3 {
            cursor.size()?;
        }
        for _ in 0..blocks {
            let entity = (cursor.int()?, cursor.int()?);
            let kind = cursor.int()?;
            let count = nodes_of_type(kind).ok_or_else(|| {
                format!(
                    "elements of Gmsh's type {kind}{} are not supported; volumes must be meshed with hexahedra of 8, 20 or 27 nodes, \
                     wedges of 6, 15 or 18 or tetrahedra of 4 or 10",
                    if PYRAMIDS.contains(&kind) { ", pyramids," } else { "" }
                )
            })?;
            for _ in 0..cursor.size()? {
                let line = cursor.line;
                let tag = cursor.size()?;
                let mut nodes = Vec::with_capacity(count);
                for _ in 0..count {
                    nodes.push(cursor.size()?);
                }
                self.elements.push(Element { tag, kind, entity, nodes, line });
            }
        }
        Ok(())
    }
}

fn read_format(cursor: &mut Cursor<'_>) -> Result<(), Wrong> {
    if cursor.next_full_line() != Some("$MeshFormat") {
        return Err((1, "a .msh file begins with $MeshFormat".to_owned()));
    }
    let line = cursor.line;
    let wrong = |text: String| Err((line, text));
    let format = cursor.next_line().unwrap_or_default();
    let mut words = format.split_whitespace();
    let (version, binary, size) = (words.next().unwrap_or_default(), words.next(), words.next());
    if version != "4.1" {
        return wrong(format!(
            "the file has version {} of the .msh format; only 4.1 is supported (gmsh -save -format msh41, or Mesh.MshFileVersion = 4.1)",
            quoted(version)
        ));
    }
    cursor.encoding = match (binary, size) {
        (Some("0"), _) => Encoding::Text,
        (Some("1"), Some("8")) => {
            cursor.encoding = Encoding::LittleEndian;
            match cursor.int().map(i32::to_le_bytes) {
                Ok([1, 0, 0, 0]) => Encoding::LittleEndian,
                Ok([0, 0, 0, 1]) => Encoding::BigEndian,
                _ => return wrong("the order of bytes cannot be told".to_owned()),
            }
        }
        _ => return wrong(format!("{} is no format of numbers, only 0 8 and 1 8 are", quoted(format))),
    };
    if cursor.skip_behind("$EndMeshFormat") { Ok(()) } else { wrong("$MeshFormat without $EndMeshFormat".to_owned()) }
}

fn short(name: &str) -> String {
    name.chars().take(30).collect()
}
