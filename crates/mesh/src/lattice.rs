//! Structured hexahedra, tetrahedra or wedges on a tensor-product grid from which cells may be left out.

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
    /// A cell becomes one hexahedron, six tetrahedra ([`crate::kuhn`]) or two wedges along z. Cells and nodes are numbered with z fastest and x
    /// slowest, which keeps neighbours close in memory.
    pub fn mesh(&self, kind: ElementKind, is_solid: impl Fn([usize; 3]) -> bool) -> LatticeMesh {
        let cells = self.num_cells();
        // Nodes live on the grid with every interval halved; linear elements use its even points only.
        let fine: [usize; 3] = std::array::from_fn(|d| 2 * cells[d] + 1);
        let fine_index = |p: [usize; 3]| (p[0] * fine[1] + p[1]) * fine[2] + p[2];
        // Of all the elements of a cell, one after the other.
        let offsets = (kind.lattice.nodes)();

        let mut solid_cells = Vec::new();
        let mut is_meshed = vec![false; cells[0] * cells[1] * cells[2]];
        let cell_index = |c: [usize; 3]| (c[0] * cells[1] + c[1]) * cells[2] + c[2];
        let mut used = vec![false; fine[0] * fine[1] * fine[2]];
        for i in 0..cells[0] {
            for j in 0..cells[1] {
                for k in 0..cells[2] {
                    if is_solid([i, j, k]) {
                        is_meshed[cell_index([i, j, k])] = true;
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
        let connectivity: Vec<u32> = solid_cells
            .iter()
            .flat_map(|c| offsets.iter().map(|o| number[fine_index(std::array::from_fn(|d| 2 * c[d] + o[d]))]))
            .collect();
        // The family of these nodes.
        let written = match kind.enriches.first() {
            Some(&enriched) if offsets.len() < kind.lattice.elements * kind.num_nodes() => enriched,
            _ => kind,
        };
        let mut mesh = Mesh {
            kinds: written.into(),
            nodes,
            connectivity,
            node_sets: BTreeMap::new(),
            facet_sets: BTreeMap::new(),
            element_sets: BTreeMap::new(),
        };
        if written != kind {
            mesh = mesh.enriched().0;
        }
        LatticeMesh { mesh, kind, cells: solid_cells, is_meshed, size: cells }
    }

    /// Meshes all cells of the lattice.
    pub fn mesh_all(&self, kind: ElementKind) -> Mesh {
        self.mesh(kind, |_| true).mesh
    }
}

/// A mesh together with its lattice cells.
#[derive(Clone, Debug)]
pub struct LatticeMesh {
    /// The mesh.
    pub mesh: Mesh,
    /// Family of all elements.
    pub kind: ElementKind,
    /// The lattice cells that are meshed, in the order of their elements ([`crate::family::LatticeCell::elements`] each).
    pub cells: Vec<[usize; 3]>,
    is_meshed: Vec<bool>,
    size: [usize; 3],
}

/// What lies on the other side of a cell's side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Neighbour {
    /// The lattice ends here.
    Outside,
    /// A cell that is not solid.
    Void([usize; 3]),
}

/// A facet on the boundary of the meshed cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoundaryFacet {
    /// The facet.
    pub facet: Facet,
    /// Cell it belongs to.
    pub cell: [usize; 3],
    /// Side of the cell: 0 … 5 for −x, +x, −y, +y, −z, +z.
    pub side: usize,
    /// What it looks at.
    pub neighbour: Neighbour,
}

impl LatticeMesh {
    /// All boundary facets, cell by cell and side by side.
    pub fn boundary(&self) -> Vec<BoundaryFacet> {
        let lattice = &self.kind.lattice;
        let on_side = (lattice.facets_on_sides)();
        let mut boundary = Vec::new();
        for (index, &cell) in self.cells.iter().enumerate() {
            for (side, facets) in on_side.iter().enumerate() {
                let Some(neighbour) = self.neighbour(cell, side) else { continue };
                boundary.extend(facets.iter().map(|&(within, face)| {
                    let element = (index * lattice.elements + within) as u32;
                    BoundaryFacet { facet: Facet { element, face }, cell, side, neighbour }
                }));
            }
        }
        boundary
    }

    /// What lies beyond a side of a meshed cell; `None` for another meshed cell.
    fn neighbour(&self, cell: [usize; 3], side: usize) -> Option<Neighbour> {
        let (axis, up) = (side / 2, side % 2 == 1);
        let limit = if up { self.size[axis] - 1 } else { 0 };
        if cell[axis] == limit {
            return Some(Neighbour::Outside);
        }
        let mut other = cell;
        if up {
            other[axis] += 1
        } else {
            other[axis] -= 1
        }
        let index = (other[0] * self.size[1] + other[1]) * self.size[2] + other[2];
        (!self.is_meshed[index]).then_some(Neighbour::Void(other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tetrahedra_conform_and_fill_the_lattice() {
        let lattice = Lattice { lines: [vec![0.0, 1.0, 1.5], vec![0.0, 0.7, 2.0, 2.2], vec![-1.0, 0.0, 3.0]] };
        let built = lattice.mesh(ElementKind::Tet10, |cell| cell != [1, 1, 0]);
        let mesh = &built.mesh;
        assert_eq!((mesh.num_elements(), built.cells.len()), (66, 11));
        assert!((mesh.volume() - (1.5 * 2.2 * 4.0 - 0.5 * 1.3)).abs() < 1e-12);
        // Facets shared by no other element are those of the cells' boundary: two tetrahedra share every other one.
        let mut from_lattice: Vec<Facet> = built.boundary().iter().map(|b| b.facet).collect();
        from_lattice.sort();
        assert_eq!(from_lattice, mesh.boundary_facets());
        // Mid-edge nodes are in the middle.
        for element in 0..mesh.num_elements() {
            let nodes = mesh.element(element);
            for (&middle, &[a, b]) in nodes[4..].iter().zip(mesh.kind_of(element).edges) {
                for d in 0..3 {
                    let mean = 0.5 * (mesh.nodes[nodes[a] as usize][d] + mesh.nodes[nodes[b] as usize][d]);
                    assert!((mesh.nodes[middle as usize][d] - mean).abs() < 1e-14);
                }
            }
        }
    }
}
