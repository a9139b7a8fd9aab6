//! What the cells of VTK's files are, and what their data become: whole numbers with few values are sets.

use std::collections::BTreeMap;

use pneuflex_mesh::ElementKind;

use crate::raw_mesh::{Form, RawElement, RawMesh};

/// Data of cells with more values than this are no groups.
const MOST_GROUPS: usize = 64;

/// Data of cells: name and value of every cell.
pub(crate) type CellData = Vec<(String, Vec<i64>)>;

/// The cells of a file.
#[derive(Debug, Default)]
pub(crate) struct Cells {
    /// Nodes of every cell.
    pub nodes: Vec<Vec<u64>>,
    /// VTK's type of every cell.
    pub types: Vec<i64>,
    /// Data of cells that are whole numbers.
    pub data: CellData,
    /// Where they stand.
    pub line: u32,
}

/// The mesh of cells with nodes of these positions: data become sets, called after the data and the value, as in `material_2`.
pub(crate) fn raw_mesh(nodes: BTreeMap<u64, [f64; 3]>, cells: Cells) -> Result<RawMesh, String> {
    let Cells { nodes: of_cells, types, mut data, line } = cells;
    if of_cells.len() != types.len() {
        return Err(format!("{} cells have {} types", of_cells.len(), types.len()));
    }
    let mut mesh = RawMesh { nodes, ..RawMesh::default() };
    let mut groups: BTreeMap<Vec<String>, i64> = BTreeMap::new();
    data.retain(|(_, values)| is_group(values) && values.len() == types.len());
    for (number, (nodes, kind)) in of_cells.into_iter().zip(types).enumerate() {
        let Some((form, nodes)) = cell(kind, nodes).map_err(|why| format!("cell {number}: {why}"))? else {
            continue;
        };
        let names: Vec<String> = data.iter().map(|(name, values)| format!("{name}_{}", values[number])).collect();
        let next = groups.len() as i64;
        let group = *groups.entry(names).or_insert(next);
        mesh.elements.push(RawElement { tag: number as u64, form, group, nodes, line });
    }
    for (names, group) in groups {
        mesh.groups.extend((0..4).map(|dimension| ((dimension, group), names.clone())));
    }
    Ok(mesh)
}

/// Whether data of cells have few values.
fn is_group(values: &[i64]) -> bool {
    let mut known = std::collections::BTreeSet::new();
    values.iter().all(|value| known.contains(value) || known.len() < MOST_GROUPS && known.insert(*value))
}

/// What a cell of a type is, with its nodes in our order; `None` for what bounds no volume.
fn cell(kind: i64, nodes: Vec<u64>) -> Result<Option<(Form, Vec<u64>)>, String> {
    let swapped = |order: &[usize]| order.iter().filter_map(|&i| nodes.get(i).copied()).collect::<Vec<u64>>();
    let (form, count, nodes) = match kind {
        1 => (Form::Piece(1), 1, nodes),
        3 | 21 => (Form::Piece(2), if kind == 3 { 2 } else { 3 }, nodes),
        5 => (Form::Piece(3), 3, nodes),
        22 => (Form::Piece(3), 6, nodes),
        8 => (Form::Piece(4), 4, swapped(&[0, 1, 3, 2])),
        9 => (Form::Piece(4), 4, nodes),
        23 => (Form::Piece(4), 8, nodes),
        28 => (Form::Piece(4), 9, nodes),
        10 => (Form::Solid(ElementKind::Tet10, true), 4, nodes),
        13 => (Form::Solid(ElementKind::Wedge15, true), 6, nodes),
        11 => (Form::Solid(ElementKind::Hex8, false), 8, swapped(&[0, 1, 3, 2, 4, 5, 7, 6])),
        // Lines and surfaces of many pieces name nothing.
        0 | 2 | 4 | 6 | 7 => return Ok(None),
        _ => {
            // A Lagrange cell of any order has one number.
            let known = |family: &ElementKind| {
                i64::from(family.vtk_cell_type) == kind
                    && (family.gmsh.number.is_some() || family.num_nodes() == nodes.len())
            };
            let family = ElementKind::ALL.into_iter().find(known).ok_or_else(|| {
                format!(
                    "VTK's type {kind}{} is not supported; volumes must be meshed with hexahedra of 8, 20 or 27 nodes, wedges of 6, 15 or 18 \
                     or tetrahedra of 4 or 10",
                    if [14, 27, 37].contains(&kind) { ", a pyramid," } else { "" }
                )
            })?;
            (Form::Solid(family, false), family.num_nodes(), nodes)
        }
    };
    if nodes.len() != count {
        return Err(format!("it has {} nodes instead of {count}", nodes.len()));
    }
    Ok(Some((form, nodes)))
}
