//! Two blocks of 1 mm side by side, written by Gmsh, VTK and meshio as `.vtk`, `.vtu` and `.msh` 2.2: the same mesh whatever the file; damage.

use std::fs;
use std::path::PathBuf;

use pneuflex_deck::{msh, vtk, vtu};
use pneuflex_mesh::ElementKind;
use proptest::prelude::*;

/// Files, the sets of elements and of faces that they have of the blocks and of the end of the first.
const FILES: [(&str, [&str; 3]); 10] = [
    ("blocks_tet4.vtk", ["CellEntityIds_1", "CellEntityIds_2", "CellEntityIds_3"]),
    ("blocks_tet10_binary.vtk", ["CellEntityIds_1", "CellEntityIds_2", "CellEntityIds_3"]),
    ("blocks_tet10_5_1_binary.vtk", ["gmsh:physical_1", "gmsh:physical_2", "gmsh:physical_3"]),
    ("blocks_tet4_ascii.vtu", ["CellEntityIds_1", "CellEntityIds_2", "CellEntityIds_3"]),
    ("blocks_tet10_inline.vtu", ["CellEntityIds_1", "CellEntityIds_2", "CellEntityIds_3"]),
    ("blocks_tet10_raw.vtu", ["CellEntityIds_1", "CellEntityIds_2", "CellEntityIds_3"]),
    ("blocks_tet10_base64_zlib.vtu", ["CellEntityIds_1", "CellEntityIds_2", "CellEntityIds_3"]),
    ("blocks_tet10_meshio.vtu", ["gmsh:physical_1", "gmsh:physical_2", "gmsh:physical_3"]),
    ("blocks_tet4.msh", ["left", "right", "foot"]),
    ("blocks_tet10_binary.msh", ["left", "right", "foot"]),
];

fn bytes(name: &str) -> Vec<u8> {
    fs::read(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)).unwrap()
}

fn read(name: &str, bytes: &[u8]) -> Result<pneuflex_deck::msh::MeshFile, Vec<pneuflex_deck::DeckError>> {
    match name.rsplit_once('.') {
        Some((_, "msh")) => msh::read(name, bytes),
        Some((_, "vtu")) => vtu::read(name, bytes),
        _ => vtk::read(name, bytes),
    }
}

#[test]
fn the_same_blocks_are_read_from_every_file() {
    for (name, [left, right, foot]) in FILES {
        let mesh = read(name, &bytes(name)).unwrap_or_else(|errors| panic!("{name}: {}", errors[0])).mesh;
        assert_eq!(mesh.kinds.only(), Some(ElementKind::Tet10), "{name}");
        assert_eq!((mesh.num_nodes(), mesh.num_elements()), (113, 48), "{name}");
        for (set, at) in [(left, 0.0), (right, 1.0)] {
            let elements = mesh.element_set(set);
            assert!((mesh.volume_of(elements.iter().copied()) - 1.0).abs() < 1e-12, "{name} {set}");
            let nodes = elements.iter().flat_map(|&element| mesh.element(element as usize));
            assert!(nodes.map(|&node| mesh.nodes[node as usize][0]).all(|x| (at..=at + 1.0).contains(&x)), "{name}");
        }
        assert_eq!(mesh.facet_set(foot), mesh.select_facets(|x| x[0] == 0.0), "{name}");
    }
}

/// The mirror image of a tetrahedron, as some programs write it, is turned; what has no volume and what is no element is refused.
#[test]
fn cells_that_are_turned_or_unknown() {
    let file = |cells: &str, types: &str| {
        format!(
            "# vtk DataFile Version 2.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 0\nCELLS 1 {cells}\n\
             CELL_TYPES 1\n{types}\n"
        )
    };
    let turned = vtk::read("a.vtk", file("5\n4 1 0 2 3", "10").as_bytes()).unwrap();
    assert!((turned.mesh.volume() - 1.0 / 6.0).abs() < 1e-15);
    assert!(turned.notes[0].to_string().contains("mirror image"));
    for (cells, types, said) in [
        ("5\n4 1 0 2 4", "10", "inverted or flat"),
        ("6\n5 0 1 4 2 3", "14", "a pyramid"),
        ("6\n5 0 1 4 2 3", "10", "has 5 nodes instead of 4"),
        ("5\n4 0 1 2 9", "10", "there is no node 9"),
        ("5\n4 0 1 2 -1", "10", "the number of no node"),
        ("4\n3 0 1 2", "5", "no volume is meshed"),
        ("99999999999\n4 0 1 2 3", "10", "numbers are announced"),
    ] {
        let errors = vtk::read("a.vtk", file(cells, types).as_bytes()).unwrap_err();
        assert!(errors[0].to_string().contains(said), "{cells}: {}", errors[0]);
    }
    let surface = b"# vtk DataFile Version 2.0\nx\nASCII\nDATASET POLYDATA\n";
    assert!(vtk::read("a.vtk", surface).unwrap_err()[0].to_string().contains("a surface without an inside"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Whatever is damaged, nothing panics.
    #[test]
    fn damaged_files_are_read_or_refused(file in 0..FILES.len(), at in any::<prop::sample::Index>(), byte in any::<u8>(), cut in any::<bool>()) {
        let name = FILES[file].0;
        let mut bytes = bytes(name);
        let at = at.index(bytes.len());
        if cut { bytes.truncate(at) } else { bytes[at] = byte }
        let _ = read(name, &bytes);
    }
}

/// What a `.vtu` file may be that is none of an unstructured grid, and counts that do not fit.
#[test]
fn damaged_vtu_files_are_refused_with_their_reason() {
    let text = String::from_utf8(bytes("blocks_tet4_ascii.vtu")).unwrap();
    let inline = String::from_utf8(bytes("blocks_tet10_inline.vtu")).unwrap();
    let zlib = String::from_utf8(bytes("blocks_tet10_base64_zlib.vtu")).unwrap();
    for (text, said) in [
        ("points".to_owned(), "not an XML file"),
        (text.replace("UnstructuredGrid", "PolyData"), "is \"PolyData\" and not UnstructuredGrid"),
        (text.replace("connectivity", "nodes"), "Cells has no array connectivity"),
        (text.replacen("=\"Float", "=\"Real", 1), "is no type of numbers"),
        (inline.replacen("AAA", "!!!", 1), "its data end too early, or are damaged"),
        (zlib.replace("vtkZLibDataCompressor", "vtkLZ4DataCompressor"), "compress by zlib, or not at all"),
        (zlib.replacen("offset=\"0\"", "offset=\"99999999\"", 1), "its offset lies beyond the appended data"),
        (
            zlib.replacen("<AppendedData", "<Appendix", 1).replacen("</AppendedData", "</Appendix", 1),
            "nothing is appended",
        ),
    ] {
        let errors = vtu::read("a.vtu", text.as_bytes()).unwrap_err();
        assert!(errors[0].to_string().contains(said), "{}", errors[0]);
    }
}
