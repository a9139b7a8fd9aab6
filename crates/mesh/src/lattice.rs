//! Structured hexahedra on a tensor-product grid from which cells may be left out.

use std::collections::BTreeMap;

use crate::element::ElementKind;
use crate::mesh::{Facet, Mesh};

/// Grid lines along the three axes; at least two, strictly increasing, along each.
#[derive(Clone, Debug, PartialEq)]
pub struct Lattice {
    /// Coordinates of the grid planes along x, y, z, mm.
    pub lines: [Vec<f64>; 3],
}

impl Lattice {
    /// A block of `cells` equal cells per direction between two corners.
    pub fn uniform(low: [f64; 3], high: [f64; 3], cells: [usize; 3]) -> Self {
        let lines = std::array::from_fn(|d| {
            (0..=cells[d]).map(|i| low[d] + (high[d] - low[d]) * i as f64 / cells[d] as f64).collect()
        });
        Self { lines }
    }

    /// Number of cells along each axis.
    pub fn num_cells(&self) -> [usize; 3] {
        std::array::from_fn(|d| self.lines[d].len() - 1)
    }

    /// Centre of a cell.
    pub fn centre(&self, cell: [usize; 3]) -> [f64; 3] {
        std::array::from_fn(|d| 0.5 * (self.lines[d][cell[d]] + self.lines[d][cell[d] + 1]))
    }

    /// Meshes the cells for which `is_solid(cell)` holds. The mesh has no named sets yet.
    ///
    /// Elements and nodes are numbered with z fastest and x slowest, which keeps neighbours close in memory.
    ///
    /// # Panics
    /// If `kind` is not a hexahedron.
    pub fn mesh(&self, kind: ElementKind, is_solid: impl Fn([usize; 3]) -> bool) -> LatticeMesh {
        assert!(kind != ElementKind::Tet10, "a lattice is meshed by hexahedra");
        let cells = self.num_cells();
        // Nodes live on the grid with every interval halved; linear elements use its even points only.
        let fine: [usize; 3] = std::array::from_fn(|d| 2 * cells[d] + 1);
        let fine_index = |p: [usize; 3]| (p[0] * fine[1] + p[1]) * fine[2] + p[2];
        let offsets: Vec<[usize; 3]> = kind.reference_nodes().iter().map(|x| x.map(|t| (t + 1.0) as usize)).collect();

        let mut solid_cells = Vec::new();
        let mut element_of_cell = vec![None; cells[0] * cells[1] * cells[2]];
        let cell_index = |c: [usize; 3]| (c[0] * cells[1] + c[1]) * cells[2] + c[2];
        let mut used = vec![false; fine[0] * fine[1] * fine[2]];
        for i in 0..cells[0] {
            for j in 0..cells[1] {
                for k in 0..cells[2] {
                    if is_solid([i, j, k]) {
                        element_of_cell[cell_index([i, j, k])] = Some(solid_cells.len() as u32);
                        solid_cells.push([i, j, k]);
                        for o in &offsets {
                            used[fine_index([2 * i + o[0], 2 * j + o[1], 2 * k + o[2]])] = true;
                        }
                    }
                }
            }
        }

        let coordinate = |d: usize, p: usize| {
            let line = &self.lines[d];
            if p.is_multiple_of(2) { line[p / 2] } else { 0.5 * (line[p / 2] + line[p / 2 + 1]) }
        };
        let mut number = vec![u32::MAX; used.len()];
        let mut nodes = Vec::new();
        for a in 0..fine[0] {
            for b in 0..fine[1] {
                for c in 0..fine[2] {
                    let index = fine_index([a, b, c]);
                    if used[index] {
                        number[index] = nodes.len() as u32;
                        nodes.push([coordinate(0, a), coordinate(1, b), coordinate(2, c)]);
                    }
                }
            }
        }
        let connectivity = solid_cells
            .iter()
            .flat_map(|c| offsets.iter().map(|o| number[fine_index(std::array::from_fn(|d| 2 * c[d] + o[d]))]))
            .collect();
        LatticeMesh {
            mesh: Mesh { kind, nodes, connectivity, node_sets: BTreeMap::new(), facet_sets: BTreeMap::new() },
            cells: solid_cells,
            element_of_cell,
            size: cells,
        }
    }

    /// Meshes all cells of the lattice.
    pub fn mesh_all(&self, kind: ElementKind) -> Mesh {
        self.mesh(kind, |_| true).mesh
    }
}

/// A mesh together with the lattice cell of every element.
#[derive(Clone, Debug)]
pub struct LatticeMesh {
    /// The mesh.
    pub mesh: Mesh,
    /// Lattice cell of every element.
    pub cells: Vec<[usize; 3]>,
    element_of_cell: Vec<Option<u32>>,
    size: [usize; 3],
}

/// What lies on the other side of an element's face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Neighbour {
    /// The lattice ends here.
    Outside,
    /// A cell that is not solid.
    Void([usize; 3]),
}

impl LatticeMesh {
    /// All boundary facets with what they look at, in element order.
    pub fn boundary(&self) -> Vec<(Facet, Neighbour)> {
        let mut boundary = Vec::new();
        for (element, cell) in self.cells.iter().enumerate() {
            // Faces come in the order −x, +x, −y, +y, −z, +z.
            for face in 0..6_u8 {
                let (axis, up) = ((face / 2) as usize, face % 2 == 1);
                let facet = Facet { element: element as u32, face };
                let limit = if up { self.size[axis] - 1 } else { 0 };
                if cell[axis] == limit {
                    boundary.push((facet, Neighbour::Outside));
                    continue;
                }
                let mut other = *cell;
                if up {
                    other[axis] += 1
                } else {
                    other[axis] -= 1
                }
                let index = (other[0] * self.size[1] + other[1]) * self.size[2] + other[2];
                if self.element_of_cell[index].is_none() {
                    boundary.push((facet, Neighbour::Void(other)));
                }
            }
        }
        boundary
    }
}
