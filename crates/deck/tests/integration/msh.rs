//! Meshes of a box of 2 × 1 × 1 mm, written by Gmsh 4.15.2: element families, groups, both encodings, damage.

use std::fs;
use std::path::PathBuf;

use pneuflex_deck::msh::{MeshFile, read};
use pneuflex_mesh::{ElementKind, ReferenceBody};
use proptest::prelude::*;

const FILES: [&str; 10] = [
    "hex8",
    "hex20",
    "hex27_binary",
    "tet10",
    "tet4_binary",
    "wedge6",
    "wedge15",
    "wedge18_binary",
    "hex8_wedge6",
    "hex27_wedge18_binary",
];

fn bytes(name: &str) -> Vec<u8> {
    fs::read(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(format!("{name}.msh"))).unwrap()
}

fn file(name: &str) -> MeshFile {
    read(&format!("{name}.msh"), &bytes(name)).unwrap_or_else(|errors| panic!("{}", errors[0]))
}

fn errors(bytes: &[u8]) -> Vec<String> {
    read("a.msh", bytes).unwrap_err().iter().map(ToString::to_string).collect()
}

#[test]
fn every_family_has_its_nodes_in_their_places() {
    use ElementKind::{Hex8, Hex20, Hex27, Tet10, Wedge15, Wedge18};
    let families: [&[ElementKind]; 10] = [
        &[Hex8],
        &[Hex20],
        &[Hex27],
        &[Tet10],
        &[Tet10],
        &[Wedge15],
        &[Wedge15],
        &[Wedge18],
        // Beside wedges linear hexahedra get nodes on their edges, too.
        &[Hex20, Wedge15],
        &[Hex27, Wedge18],
    ];
    for (name, families) in FILES.into_iter().zip(families) {
        let mesh = file(name).mesh;
        assert_eq!(mesh.families(), families, "{name}");
        assert!((mesh.volume() - 2.0).abs() < 1e-12, "{name}: {}", mesh.volume());
        assert!(mesh.unmatched_faces().is_none());
        for element in 0..mesh.num_elements() {
            let kind = mesh.kind_of(element);
            let corners = kind.num_corners();
            let nodes: Vec<[f64; 3]> = mesh.element(element).iter().map(|&n| mesh.nodes[n as usize]).collect();
            // Straight edges: all further nodes are where the shape functions of the corners put them.
            for (xi, x) in kind.reference_nodes().iter().zip(&nodes).skip(corners) {
                let line = |corner: &[f64; 3], d: usize| 0.5 * (1.0 + corner[d] * xi[d]);
                let weight = |at: usize| -> f64 {
                    let corner = &kind.reference_nodes()[at];
                    match kind.body {
                        ReferenceBody::Tetrahedron => [1.0 - xi.iter().sum::<f64>(), xi[0], xi[1], xi[2]][at],
                        ReferenceBody::Wedge => [1.0 - xi[0] - xi[1], xi[0], xi[1]][at % 3] * line(corner, 2),
                        ReferenceBody::Hexahedron => (0..3).map(|d| line(corner, d)).product(),
                    }
                };
                let expected: [f64; 3] = std::array::from_fn(|i| (0..corners).map(|c| weight(c) * nodes[c][i]).sum());
                assert!((0..3).all(|i| (expected[i] - x[i]).abs() < 1e-9), "{name}: {expected:?} {x:?}");
            }
        }
    }
}

#[test]
fn physical_groups_are_sets() {
    for name in FILES {
        let mesh = file(name).mesh;
        assert_eq!(mesh.element_set("body").len(), mesh.num_elements(), "{name}");
        let expect = |set: &str, lies: &dyn Fn([f64; 3]) -> bool, area: Option<f64>| {
            let expected: Vec<u32> = mesh.select_nodes(lies);
            assert!(!expected.is_empty());
            assert_eq!(mesh.node_set(set), expected, "{name}: {set}");
            let Some(area) = area else {
                return assert!(mesh.facet_set(set).is_empty(), "{name}: {set}");
            };
            assert_eq!(mesh.facet_set(set), mesh.select_facets(lies), "{name}: {set}");
            let of_triangle = |a: u32, b: u32, c: u32| {
                let [a, b, c] = [a, b, c].map(|n| mesh.nodes[n as usize]);
                let (u, v): ([f64; 3], [f64; 3]) =
                    (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
                0.5 * ((u[1] * v[2] - u[2] * v[1]).powi(2)
                    + (u[2] * v[0] - u[0] * v[2]).powi(2)
                    + (u[0] * v[1] - u[1] * v[0]).powi(2))
                .sqrt()
            };
            let total: f64 = mesh
                .facet_set(set)
                .iter()
                .map(|&facet| {
                    let (n, corners) = (mesh.facet_nodes(facet), mesh.face_kind(facet).num_corners());
                    (2..corners).map(|i| of_triangle(n[0], n[i - 1], n[i])).sum::<f64>()
                })
                .sum();
            assert!((total - area).abs() < 1e-12, "{name}: {set} {total}");
        };
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        expect("clamp", &|x| near(x[0], 0.0), Some(1.0));
        expect("surface_5", &|x| near(x[0], 2.0), Some(1.0));
        expect("edge", &|x| near(x[0], 2.0) && near(x[2], 1.0), None);
        expect("corner", &|x| x.iter().zip([2.0, 1.0, 1.0]).all(|(a, b)| near(*a, b)), None);
        let both = mesh.facet_set("top and bottom");
        let flat = |x: [f64; 3]| near(x[2], 0.0) || near(x[2], 1.0);
        assert_eq!(
            mesh.node_set("top and bottom"),
            mesh.select_nodes(flat)
                .iter()
                .filter(|&&n| !near(mesh.nodes[n as usize][2], 0.5))
                .copied()
                .collect::<Vec<_>>()
        );
        assert_eq!(both.len() % 2, 0);
    }
}

#[test]
fn tags_are_kept() {
    let file = file("hex8");
    assert_eq!(file.element_tags.len(), 2);
    assert_eq!(file.node_tags.len(), 12);
    assert!(file.notes.is_empty());
    let tets = self::file("tet4_binary");
    assert!(tets.node_tags.iter().any(Option::is_none));
    assert!(tets.notes[0].text.starts_with("tetrahedra with 4 nodes lock"));
}

#[test]
fn other_versions_and_elements_are_refused() {
    assert_eq!(
        errors(b"$MeshFormat\n3 0 8\n"),
        [
            "a.msh:2: the file has version \"3\" of the .msh format; only 4.1 and 2.2 are supported (gmsh -save -format msh41, or \
             Mesh.MshFileVersion = 4.1)"
        ]
    );
    let old = file("version_2").mesh;
    assert!(old.facet_sets.contains_key("clamp") && old.element_sets.contains_key("body"));
    assert_eq!(errors(b"*NODE\n"), ["a.msh:1: a .msh file begins with $MeshFormat"]);
    assert_eq!(errors(b""), ["a.msh:1: a .msh file begins with $MeshFormat"]);
    assert_eq!(errors(b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"), ["a.msh:4: the file has no $Nodes"]);
    let text = String::from_utf8(bytes("hex8")).unwrap();
    let with = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        errors(text.replacen(from, to, 1).as_bytes())
    };
    let pyramids = with("3 1 5 2", "3 1 7 2");
    let refusal = "$Elements: elements of Gmsh's type 7, pyramids, are not supported; volumes must";
    assert!(pyramids[0].contains(refusal), "{pyramids:?}");
    assert!(with("$EndElements", "$EndElement")[0].contains("$Elements without $EndElements"));
    assert!(with("$Entities", "$PartitionedEntities")[0].contains("partitioned meshes are not supported"));
    assert!(with("3 1 5 2", "3 1 5 200")[0].contains("is not a whole number"));
}

#[test]
fn broken_meshes_are_told() {
    let text = String::from_utf8(bytes("hex8")).unwrap();
    let begin = text.find("\n3 1 5 2\n").unwrap() + 9;
    let line = text[begin..].lines().next().unwrap();
    let words: Vec<&str> = line.split_whitespace().collect();
    let element = |order: [usize; 9]| order.map(|i| words[i]).join(" ");
    let inverted = errors(text.replace(line.trim(), &element([0, 5, 6, 7, 8, 1, 2, 3, 4])).as_bytes());
    assert!(inverted[0].contains(&format!("element {} is inverted or flat", words[0])), "{inverted:?}");
    let unknown = errors(text.replace(line.trim(), &line.trim().replace(words[3], "777")).as_bytes());
    assert!(unknown[0].ends_with("there is no node 777"), "{unknown:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn damaged_files_are_read_or_refused(
        which in 0..FILES.len(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4),
        length in any::<prop::sample::Index>(), whole in any::<bool>(),
    ) {
        let mut bytes = bytes(FILES[which]);
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        if !whole {
            bytes.truncate(length.index(bytes.len()));
        }
        if let Ok(file) = read("a.msh", &bytes) {
            prop_assert!(file.mesh.nodes.iter().flatten().all(|x| x.is_finite()));
        }
    }
}
