//! Element types of Abaqus and CalculiX, and what they are solved with.

use pneuflex_mesh::ElementKind;
use pneuflex_model::Formulation;

/// Elements that differ in their integration only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Family {
    /// Eight nodes: C3D8 and its variants.
    Hex8,
    /// Twenty nodes: C3D20 and its variants.
    Hex20,
    /// Ten nodes: C3D10 and its variants.
    Tet10,
    /// Four nodes: C3D4 and C3D4H, which get mid-edge nodes.
    Tet4,
}

/// Abaqus's faces S1, S2, … as our local face numbers. Its faces in its own nodes are 1-2-3-4, 5-8-7-6, 1-5-6-2, 2-6-7-3, 3-7-8-4,
/// 4-8-5-1 of a hexahedron and 1-2-3, 1-4-2, 2-4-3, 3-4-1 of a tetrahedron.
const HEX_FACES: [u8; 6] = [4, 5, 2, 1, 3, 0];
const TET_FACES: [u8; 4] = [0, 1, 2, 3];

impl Family {
    /// The family of a type by its name in capitals, or why there is none.
    pub fn of(name: &str) -> Result<Self, String> {
        Ok(match name {
            "C3D8" | "C3D8R" | "C3D8H" | "C3D8I" | "C3D8RH" | "C3D8IH" => Self::Hex8,
            "C3D20" | "C3D20R" | "C3D20H" | "C3D20RH" => Self::Hex20,
            "C3D10" | "C3D10H" | "C3D10M" | "C3D10MH" | "C3D10I" | "C3D10T" | "C3D10HS" => Self::Tet10,
            "C3D4" | "C3D4H" => Self::Tet4,
            _ => return Err("only the solids C3D8, C3D20, C3D10, C3D4 and their variants are solved".to_owned()),
        })
    }

    /// Nodes of an element in a deck.
    pub const fn num_nodes(self) -> usize {
        match self {
            Self::Hex8 => 8,
            Self::Hex20 => 20,
            Self::Tet10 => 10,
            Self::Tet4 => 4,
        }
    }

    /// What it is solved with.
    pub const fn formulation(self) -> Formulation {
        match self {
            Self::Hex8 => Formulation::Hex8Q1p0,
            Self::Hex20 => Formulation::Hex20,
            Self::Tet10 | Self::Tet4 => Formulation::Tet10,
        }
    }

    /// What it is solved with. The order of the nodes is the same everywhere.
    pub const fn kind(self) -> ElementKind {
        self.formulation().element_kind()
    }

    /// In words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Hex8 => "hexahedra with 8 nodes",
            Self::Hex20 => "hexahedra with 20 nodes",
            Self::Tet10 => "tetrahedra with 10 nodes",
            Self::Tet4 => "tetrahedra with 4 nodes",
        }
    }

    /// What a user of the type should know.
    pub fn note(self, name: &str) -> String {
        let element = match self {
            Self::Hex8 => "hex8-q1p0, trilinear hexahedra with a mean pressure, which do not lock in volume",
            Self::Hex20 => "hex20, fully integrated with a discontinuous linear pressure",
            Self::Tet10 => "tet10, quadratic tetrahedra with a constant pressure",
            Self::Tet4 => {
                "tet10: straight mid-edge nodes are added, because linear tetrahedra lock; results are those of a finer mesh, \
                 and node sets and supports take in the mid-edge nodes between their nodes on the surface"
            }
        };
        format!("{name} is solved with {element}")
    }

    /// Our number of Abaqus's face `number`, from 1.
    pub fn face(self, number: usize) -> Option<u8> {
        let faces: &[u8] = match self {
            Self::Hex8 | Self::Hex20 => &HEX_FACES,
            Self::Tet10 | Self::Tet4 => &TET_FACES,
        };
        faces.get(number.checked_sub(1)?).copied()
    }

    /// Our number of a face by its label, a letter and a digit: `S1`, `P6`.
    pub fn labelled_face(self, letter: char, label: &str) -> Option<u8> {
        let mut characters = label.chars();
        let is_letter = characters.next()?.eq_ignore_ascii_case(&letter);
        let number = characters.next()?.to_digit(10)?;
        (is_letter && characters.next().is_none()).then(|| self.face(number as usize))?
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Faces in Abaqus's nodes, from its manual.
    const HEX: [[usize; 4]; 6] = [[1, 2, 3, 4], [5, 8, 7, 6], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 8, 4], [4, 8, 5, 1]];
    const TET: [[usize; 3]; 4] = [[1, 2, 3], [1, 4, 2], [2, 4, 3], [3, 4, 1]];

    fn sorted(nodes: impl IntoIterator<Item = usize>) -> Vec<usize> {
        let mut nodes: Vec<usize> = nodes.into_iter().collect();
        nodes.sort_unstable();
        nodes
    }

    #[test]
    fn faces_have_the_nodes_of_the_manual_and_outward_normals() {
        for family in [Family::Hex8, Family::Hex20, Family::Tet10, Family::Tet4] {
            let kind = family.kind();
            let corners = kind.face_kind().num_corners();
            let nodes = kind.reference_nodes();
            for number in 1..=kind.num_faces() {
                let face = kind.face_nodes(usize::from(family.face(number).unwrap()));
                let expected = match kind {
                    ElementKind::Tet10 => sorted(TET[number - 1].map(|n| n - 1)),
                    _ => sorted(HEX[number - 1].map(|n| n - 1)),
                };
                assert_eq!(sorted(face[..corners].iter().copied()), expected, "{family:?} S{number}");
                // The normal of our face points away from the element's centre.
                let mean = |list: &[usize]| -> [f64; 3] {
                    std::array::from_fn(|i| list.iter().map(|&n| nodes[n][i]).sum::<f64>() / list.len() as f64)
                };
                let all: Vec<usize> = (0..kind.num_corners()).collect();
                let (centre, middle) = (mean(&all), mean(&face[..corners]));
                let [a, b, c] = [0, 1, 2].map(|i| nodes[face[i]]);
                let (u, v): ([f64; 3], [f64; 3]) =
                    (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - b[i]));
                let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
                assert!((0..3).map(|i| normal[i] * (middle[i] - centre[i])).sum::<f64>() > 0.0, "{family:?} S{number}");
            }
            assert_eq!(family.face(0), None);
            assert_eq!(family.face(kind.num_faces() + 1), None);
        }
    }

    #[test]
    fn mid_edge_nodes_lie_on_the_edges_of_the_manual() {
        // Abaqus: C3D20 nodes 9–20 and C3D10 nodes 5–10 lie between these corners.
        let hex = [[1, 2], [2, 3], [3, 4], [4, 1], [5, 6], [6, 7], [7, 8], [8, 5], [1, 5], [2, 6], [3, 7], [4, 8]];
        let tet = [[1, 2], [2, 3], [3, 1], [1, 4], [2, 4], [3, 4]];
        for (family, edges) in [(Family::Hex20, &hex[..]), (Family::Tet10, &tet[..])] {
            let nodes = family.kind().reference_nodes();
            let first = family.kind().num_corners();
            assert_eq!(first + edges.len(), family.num_nodes());
            for (i, &[a, b]) in edges.iter().enumerate() {
                let middle: [f64; 3] = std::array::from_fn(|d| 0.5 * (nodes[a - 1][d] + nodes[b - 1][d]));
                assert_eq!(nodes[first + i], middle, "{family:?} node {}", first + i + 1);
            }
        }
    }

    #[test]
    fn labels_name_faces() {
        assert_eq!(Family::Hex8.labelled_face('S', "s2"), Some(5));
        assert_eq!(Family::Tet10.labelled_face('P', "P4"), Some(3));
        for bad in ["S", "S0", "S7", "S11", "P1", "", "SPOS"] {
            assert_eq!(Family::Hex8.labelled_face('S', bad), None, "{bad}");
        }
        assert_eq!(Family::Tet4.labelled_face('S', "S5"), None);
    }

    #[test]
    fn other_elements_are_refused() {
        for name in ["C3D6", "C3D15", "S4R", "B31", "CPS4", "", "C3D8P", "C3D20RT"] {
            assert!(Family::of(name).is_err(), "{name}");
        }
    }
}
