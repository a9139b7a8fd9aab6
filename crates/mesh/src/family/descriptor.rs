//! What a family of solid elements is.

use crate::element::ElementKind;
use crate::face::FaceKind;

/// The reference element that families have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReferenceBody {
    /// \[−1, 1\]³.
    Hexahedron,
    /// The unit tetrahedron.
    Tetrahedron,
    /// The unit triangle times \[−1, 1\].
    Wedge,
}

impl ReferenceBody {
    /// Elements with a number of nodes in words.
    pub fn words(self, num_nodes: usize) -> String {
        let body = match self {
            Self::Hexahedron => "hexahedra",
            Self::Tetrahedron => "tetrahedra",
            Self::Wedge => "wedges",
        };
        format!("{body} with {num_nodes} nodes")
    }
}

/// What a family of solid elements is.
#[derive(Debug)]
pub struct ElementFamily {
    /// The reference element.
    pub body: ReferenceBody,
    /// Number of corners; they come first in the numbering.
    pub num_corners: usize,
    /// Reference coordinates of the nodes, in the order of VTK.
    pub nodes: &'static [[f64; 3]],
    /// Edges as pairs of corners. Where edges have nodes in their middle, these follow the corners, in this order.
    pub edges: &'static [[usize; 2]],
    /// Faces.
    pub faces: &'static [Face],
    /// Shape functions (one per node) and their gradients ∂Nᵢ/∂ξ at a reference point. Panics where the slices are too short.
    pub shape: fn([f64; 3], &mut [f64], &mut [[f64; 3]]),
    /// Rule that integrates volumes exactly, also of curved elements.
    pub volume_rule: fn() -> Vec<([f64; 3], f64)>,
    /// A rule good enough for norms and for loads that vary in space.
    pub fine_rule: fn() -> Vec<([f64; 3], f64)>,
    /// How lattice cells are divided into elements.
    pub lattice: LatticeCell,
    /// Families that lack some of the nodes in the faces and inside, and have all others; where they are the first of the nodes, in that
    /// order. Meshes of these can be enriched.
    pub enriches: &'static [ElementKind],
    /// Local nodes of tetrahedra through all nodes, with positive volumes, for pictures; neighbours of one lattice are cut alike on the face
    /// they share. `None` if [`Self::completed_by`] is divided instead.
    pub tetrahedra: Option<fn() -> Vec<[u8; 4]>>,
    /// The family with further nodes in the middles of the faces and of the element, for pictures.
    pub completed_by: Option<fn() -> &'static ElementFamily>,
    /// Cell type number of the VTK file formats.
    pub vtk_cell_type: u8,
    /// Types of Abaqus and CalculiX; the order of nodes must be the same.
    pub abaqus: AbaqusTypes,
    /// Type of Gmsh.
    pub gmsh: GmshTypes,
}

/// A face of an element.
#[derive(Debug)]
pub struct Face {
    /// Its family.
    pub kind: FaceKind,
    /// Local nodes, numbered so that `r_ξ × r_η` points out of the element.
    pub nodes: &'static [usize],
}

impl Face {
    /// Whether it has a node at its centre, which comes last.
    pub fn has_centre(&self) -> bool {
        self.nodes.len() > 2 * self.kind.num_corners()
    }
}

/// How a family fills the cells of a lattice.
#[derive(Debug)]
pub struct LatticeCell {
    /// Number of elements that one cell is divided into.
    pub elements: usize,
    /// Positions (0, 1 or 2 along each axis) of the nodes of all elements, one after the other, on the cell with halved edges; of a family
    /// with nodes elsewhere, those of the first family that it enriches.
    pub nodes: fn() -> Vec<[usize; 3]>,
    /// Facets on the sides (−x, +x, −y, +y, −z, +z) of a cell: element within the cell and its local face.
    pub facets_on_sides: fn() -> [Vec<(usize, u8)>; 6],
    /// Nodes per cell inside of a body, and what its surface adds per cell for each n^(−1/3), n cells: for estimates.
    pub nodes_per_cell: [f64; 2],
}

/// Types of input decks.
#[derive(Debug)]
pub struct AbaqusTypes {
    /// Types in capitals, with all variants of integration.
    pub names: &'static [&'static str],
    /// Types that have the corners alone and are given the other nodes.
    pub linear_names: &'static [&'static str],
    /// Faces S1, S2, … as local face numbers.
    pub faces: &'static [u8],
}

/// Types of Gmsh's meshes.
#[derive(Debug)]
pub struct GmshTypes {
    /// Number of the type; `None` if there is none.
    pub number: Option<i32>,
    /// Type that has the corners alone and is given the other nodes.
    pub linear_number: Option<i32>,
    /// Gmsh's node for each of ours. Both begin with the same corners.
    pub order: &'static [usize],
}

impl ElementFamily {
    /// In words, as in "hexahedra with 27 nodes".
    pub fn words(&self) -> String {
        self.body.words(self.num_nodes())
    }

    /// Number of nodes of one element.
    pub const fn num_nodes(&self) -> usize {
        self.nodes.len()
    }

    /// Number of corner nodes; corners come first in the numbering.
    pub const fn num_corners(&self) -> usize {
        self.num_corners
    }

    /// Number of faces of one element.
    pub const fn num_faces(&self) -> usize {
        self.faces.len()
    }

    /// Family of a face.
    ///
    /// # Panics
    /// If `face >= self.num_faces()`.
    pub fn face_kind(&self, face: usize) -> FaceKind {
        self.faces[face].kind
    }

    /// Local nodes of a face, numbered so that `r_ξ × r_η` points out of the element.
    ///
    /// # Panics
    /// If `face >= self.num_faces()`.
    pub fn face_nodes(&self, face: usize) -> &'static [usize] {
        self.faces[face].nodes
    }

    /// Edges as pairs of corners, in the order of the mid-edge nodes.
    pub const fn edges(&self) -> &'static [[usize; 2]] {
        self.edges
    }

    /// Reference coordinates of the nodes.
    pub const fn reference_nodes(&self) -> &'static [[f64; 3]] {
        self.nodes
    }

    /// The node that lies where node `local` of another family of the same body does; `None` if there is none.
    pub fn place_of(&self, other: &Self, local: usize) -> Option<usize> {
        self.nodes.iter().position(|node| *node == other.nodes[local])
    }

    /// Whether nodes sit on mid-edges, so that edges may be curved.
    pub const fn is_quadratic(&self) -> bool {
        self.nodes.len() > self.num_corners
    }

    /// Reference coordinates of the centre: the mean of the corners.
    pub fn centre(&self) -> [f64; 3] {
        let corners = &self.nodes[..self.num_corners];
        std::array::from_fn(|d| corners.iter().map(|x| x[d]).sum::<f64>() / corners.len() as f64)
    }
}
