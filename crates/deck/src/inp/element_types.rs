//! Element types of Abaqus and CalculiX, and what they are solved with.

use pneuflex_mesh::ElementKind;

/// Elements that differ in their integration only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Family {
    /// Element family. The order of the nodes is the same everywhere.
    pub kind: ElementKind,
    /// Whether a deck has the corners alone, which get the other nodes.
    pub is_linear: bool,
}

impl Family {
    /// The family of a type by its name in capitals, or why there is none.
    pub fn of(name: &str) -> Result<Self, String> {
        for kind in ElementKind::ALL {
            let types = &kind.family().abaqus;
            for (names, is_linear) in [(types.names, false), (types.linear_names, true)] {
                if names.contains(&name) {
                    return Ok(Self { kind, is_linear });
                }
            }
        }
        if name.starts_with("C3D5") || name.starts_with("C3D13") {
            return Err("pyramids are not solved; divide them into tetrahedra, or mesh that part with wedges".into());
        }
        let types = ElementKind::ALL.iter().map(|kind| &kind.family().abaqus);
        let first: Vec<&str> =
            types.flat_map(|types| [types.names.first(), types.linear_names.first()]).flatten().copied().collect();
        Err(format!("only the solids {} and their variants are solved", first.join(", ")))
    }

    /// Nodes of an element in a deck.
    pub fn num_nodes(self) -> usize {
        if self.is_linear { self.kind.num_corners() } else { self.kind.num_nodes() }
    }

    /// In words.
    pub fn words(self) -> String {
        self.kind.body.words(self.num_nodes())
    }

    /// What a user of the type should know.
    pub fn note(self, name: &str) -> String {
        let words = self.words();
        if self.is_linear {
            return format!(
                "{name} are {words}: straight mid-edge nodes are added, because linear tetrahedra and wedges lock; results are those of \
                 a finer mesh, and node sets and supports take in the mid-edge nodes between their nodes on the surface"
            );
        }
        format!("{name} are {words}")
    }

    /// Our number of Abaqus's face `number`, from 1.
    pub fn face(self, number: usize) -> Option<u8> {
        self.kind.abaqus.faces.get(number.checked_sub(1)?).copied()
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
    const WEDGE: [&[usize]; 5] = [&[1, 2, 3], &[4, 6, 5], &[1, 4, 5, 2], &[2, 5, 6, 3], &[3, 6, 4, 1]];
    const TET: [[usize; 3]; 4] = [[1, 2, 3], [1, 4, 2], [2, 4, 3], [3, 4, 1]];

    fn family(name: &str) -> Family {
        Family::of(name).unwrap()
    }

    fn sorted(nodes: impl IntoIterator<Item = usize>) -> Vec<usize> {
        let mut nodes: Vec<usize> = nodes.into_iter().collect();
        nodes.sort_unstable();
        nodes
    }

    #[test]
    fn faces_have_the_nodes_of_the_manual_and_outward_normals() {
        for family in ["C3D8", "C3D20", "C3D10", "C3D4", "C3D15", "C3D6"].map(family) {
            let kind = family.kind;
            let nodes = kind.nodes;
            for number in 1..=kind.num_faces() {
                let face = kind.face_nodes(usize::from(family.face(number).unwrap()));
                let corners = kind.face_kind(usize::from(family.face(number).unwrap())).num_corners();
                let expected = match kind {
                    ElementKind::Wedge15 => sorted(WEDGE[number - 1].iter().map(|n| n - 1)),
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
        // Abaqus: C3D20 nodes 9–20, C3D10 nodes 5–10 and C3D15 nodes 7–15 lie between these corners.
        let hex = [[1, 2], [2, 3], [3, 4], [4, 1], [5, 6], [6, 7], [7, 8], [8, 5], [1, 5], [2, 6], [3, 7], [4, 8]];
        let tet = [[1, 2], [2, 3], [3, 1], [1, 4], [2, 4], [3, 4]];
        let wedge = [[1, 2], [2, 3], [3, 1], [4, 5], [5, 6], [6, 4], [1, 4], [2, 5], [3, 6]];
        for (family, edges) in [(family("C3D20"), &hex[..]), (family("C3D10"), &tet[..]), (family("C3D15"), &wedge[..])]
        {
            let nodes = family.kind.nodes;
            let first = family.kind.num_corners();
            assert_eq!(first + edges.len(), family.num_nodes());
            for (i, &[a, b]) in edges.iter().enumerate() {
                let middle: [f64; 3] = std::array::from_fn(|d| 0.5 * (nodes[a - 1][d] + nodes[b - 1][d]));
                assert_eq!(nodes[first + i], middle, "{family:?} node {}", first + i + 1);
            }
        }
    }

    #[test]
    fn labels_name_faces() {
        assert_eq!(family("C3D8").labelled_face('S', "s2"), Some(5));
        assert_eq!(family("C3D10").labelled_face('P', "P4"), Some(3));
        for bad in ["S", "S0", "S7", "S11", "P1", "", "SPOS"] {
            assert_eq!(family("C3D8").labelled_face('S', bad), None, "{bad}");
        }
        assert_eq!(family("C3D4").labelled_face('S', "S5"), None);
    }

    #[test]
    fn other_elements_are_refused() {
        for name in ["C3D5", "C3D13H", "C3D15V", "S4R", "B31", "CPS4", "", "C3D8P", "C3D20RT"] {
            assert!(Family::of(name).is_err(), "{name}");
        }
    }
}
