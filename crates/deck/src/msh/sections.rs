//! Sections of a `.msh` file of version 4.1 or 2.2 → nodes, elements, groups. Gmsh's manual, "MSH file format".

use std::collections::BTreeMap;

use super::cursor::{Cursor, Encoding};
use super::element_types::{form_of_type, nodes_of_type, ordered};
use crate::raw_mesh::{RawElement, RawMesh};
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
    /// Their groups are those of their geometric entity; in version 2.2 of the group itself.
    pub elements: Vec<RawElement>,
    /// Whether elements name groups themselves.
    is_grouped: bool,
}

/// A line and what is wrong there.
pub(super) type Wrong = (u32, String);

/// Gmsh's pyramids with 5, 13 and 14 nodes.
const PYRAMIDS: [i32; 3] = [7, 19, 14];

impl Sections {
    pub fn read(bytes: &[u8]) -> Result<Self, Wrong> {
        let mut cursor = Cursor::new(bytes);
        let mut sections = Self::default();
        let is_old = read_format(&mut cursor)?;
        sections.is_grouped = is_old;
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
                "Nodes" if is_old => sections.old_nodes(&mut cursor),
                "Nodes" => sections.nodes(&mut cursor),
                "Elements" if std::mem::replace(&mut has_elements, true) => Err("a second $Elements".to_owned()),
                "Elements" if is_old => sections.old_elements(&mut cursor),
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
            let count = nodes_of_type(kind).ok_or_else(|| unsupported(kind))?;
            for _ in 0..cursor.size()? {
                let line = cursor.line;
                let tag = cursor.size()?;
                let mut nodes = Vec::with_capacity(count);
                for _ in 0..count {
                    nodes.push(cursor.size()?);
                }
                self.add(tag, kind, entity.1, nodes, line);
            }
        }
        Ok(())
    }

    fn add(&mut self, tag: u64, kind: i32, group: i32, nodes: Vec<u64>, line: u32) {
        let (form, nodes) = (form_of_type(kind), ordered(kind, nodes));
        self.elements.push(RawElement { tag, form, group: i64::from(group), nodes, line });
    }

    /// $Nodes of version 2.2.
    fn old_nodes(&mut self, cursor: &mut Cursor<'_>) -> Result<(), String> {
        for _ in 0..cursor.count()? {
            let tag = cursor.tag()?;
            if self.nodes.insert(tag, [cursor.double()?, cursor.double()?, cursor.double()?]).is_some() {
                return Err(format!("node {tag} is there twice"));
            }
        }
        Ok(())
    }

    /// $Elements of version 2.2.
    fn old_elements(&mut self, cursor: &mut Cursor<'_>) -> Result<(), String> {
        let total = cursor.count()?;
        let mut read = 0;
        while read < total {
            // In binary, several of one type follow one head; their number and that of their tags stand there.
            let (head, in_block) = if cursor.encoding == Encoding::Text {
                (None, 1)
            } else {
                let (kind, count) = (cursor.int()?, cursor.int()?);
                (Some((kind, cursor.int()?)), u64::try_from(count).map_err(|_| "a negative number of elements")?)
            };
            if in_block == 0 {
                return Err("a block of no elements".into());
            }
            for _ in 0..in_block {
                let line = cursor.line;
                let tag = cursor.tag()?;
                let (kind, tags) = match head {
                    Some(head) => head,
                    None => (cursor.int()?, cursor.int()?),
                };
                let count = nodes_of_type(kind).ok_or_else(|| unsupported(kind))?;
                let mut group = 0;
                for number in 0..tags {
                    let value = cursor.int()?;
                    group = if number == 0 { value } else { group };
                }
                let mut nodes = Vec::with_capacity(count);
                for _ in 0..count {
                    nodes.push(cursor.tag()?);
                }
                self.add(tag, kind, group, nodes, line);
                read += 1;
            }
        }
        Ok(())
    }

    /// The mesh with the names of its groups.
    pub fn raw(self) -> RawMesh {
        let name = |dimension: i32, group: i32| {
            let kind =
                ["point", "curve", "surface", "volume"].get(dimension.unsigned_abs() as usize).unwrap_or(&"group");
            self.names.get(&(dimension, group)).cloned().unwrap_or_else(|| format!("{kind}_{group}"))
        };
        let by_dimension = |dimension: i32| u8::try_from(dimension).unwrap_or(u8::MAX);
        let mut groups: BTreeMap<(u8, i64), Vec<String>> = BTreeMap::new();
        if self.is_grouped {
            // 0 is no group.
            for element in self.elements.iter().filter(|element| element.group != 0) {
                let dimension = element.form.dimension();
                let of = |group: i64| vec![name(i32::from(dimension), group.unsigned_abs() as i32)];
                groups.entry((dimension, element.group)).or_insert_with(|| of(element.group));
            }
        } else {
            for (&(dimension, tag), of_entity) in &self.groups {
                let names = of_entity.iter().map(|&group| name(dimension, group)).collect();
                groups.insert((by_dimension(dimension), i64::from(tag)), names);
            }
        }
        RawMesh { nodes: self.nodes, elements: self.elements, groups }
    }
}

fn unsupported(kind: i32) -> String {
    format!(
        "elements of Gmsh's type {kind}{} are not supported; volumes must be meshed with hexahedra of 8, 20 or 27 nodes, wedges of 6, 15 \
         or 18 or tetrahedra of 4 or 10",
        if PYRAMIDS.contains(&kind) { ", pyramids," } else { "" }
    )
}

/// Whether it is version 2.2.
fn read_format(cursor: &mut Cursor<'_>) -> Result<bool, Wrong> {
    if cursor.next_full_line() != Some("$MeshFormat") {
        return Err((1, "a .msh file begins with $MeshFormat".to_owned()));
    }
    let line = cursor.line;
    let wrong = |text: String| Err((line, text));
    let format = cursor.next_line().unwrap_or_default();
    let mut words = format.split_whitespace();
    let (version, binary, size) = (words.next().unwrap_or_default(), words.next(), words.next());
    if !["4.1", "2.2"].contains(&version) {
        return wrong(format!(
            "the file has version {} of the .msh format; only 4.1 and 2.2 are supported (gmsh -save -format msh41, or Mesh.MshFileVersion = 4.1)",
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
    if cursor.skip_behind("$EndMeshFormat") {
        Ok(version == "2.2")
    } else {
        wrong("$MeshFormat without $EndMeshFormat".to_owned())
    }
}

fn short(name: &str) -> String {
    name.chars().take(30).collect()
}
