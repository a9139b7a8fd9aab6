//! Files that are given where others are expected: what they are, and what leads on from there.

use std::path::Path;

use crate::input_error::InputError;

/// Bytes from which a file is recognised.
const HEAD: usize = 4096;

/// What people name in the place of a case file or of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// A few lines that stand for a large file of a repository.
    LfsPointer,
    /// A mesh of Gmsh or VTK.
    Mesh,
    /// A deck of Abaqus, CalculiX or FEBio.
    Deck,
    /// A surface of triangles.
    Surface,
    /// A table of numbers.
    Table,
    /// A shape that is not meshed yet.
    Geometry,
    /// A shape of a program that is not read.
    OtherGeometry,
    /// A mesh in a format that is not read.
    OtherMesh,
    /// Numbers or tables as JSON, as in a result folder.
    Json,
    /// Bytes.
    Binary,
}

/// Says of a file that it is no case or model file, if that is plain from its name or its first bytes.
pub fn not_a_case(path: &Path, bytes: &[u8]) -> Option<InputError> {
    let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let around = |file: &str| {
        format!(
            "write a model file around it: [model] with file = \"{file}\", and materials, supports and loads; the guide's page on \
             models begins with one"
        )
    };
    let (what, help) = match Kind::of(path, bytes)? {
        Kind::LfsPointer => return Some(lfs_pointer(path)),
        Kind::Mesh => ("is a mesh, and a mesh needs a model file", around(&name)),
        Kind::Deck => ("is an input deck, and the names of decks end in .inp (Abaqus, CalculiX) or .feb (FEBio)", "save it under such a name".into()),
        Kind::Surface => ("is a surface of triangles without a mesh inside", mesh_first(&name)),
        Kind::Geometry => ("is a geometry without a mesh", mesh_first(&name)),
        Kind::OtherGeometry => ("is a geometry in a format that is not read", export_first()),
        Kind::OtherMesh => ("is a mesh in a format that is not read", convert_first()),
        Kind::Table => (
            "is a table, not a case file",
            "`pneuflex fit` reads curves of material tests from it; `pneuflex new two-chamber` writes a case file to start from"
                .into(),
        ),
        Kind::Json => (
            "is JSON, not a case file",
            "in a result folder the case is case.toml, and `pneuflex view` shows the folder".into(),
        ),
        Kind::Binary => ("is no text: its format is unknown", KNOWN.into()),
    };
    Some(InputError::about_file(path, what).with_help(Some(help)))
}

/// Says of a file that no body can be read from it, what it is instead.
pub fn not_a_body(path: &Path, bytes: &[u8]) -> InputError {
    let (what, help) = match Kind::of(path, bytes) {
        Some(Kind::LfsPointer) => return lfs_pointer(path),
        Some(Kind::Mesh) => {
            ("is a mesh, and the names of meshes end in .msh (Gmsh), .vtk or .vtu", "save it under such a name".into())
        }
        Some(Kind::Deck) => (
            "is an input deck, whose names end in .inp (Abaqus, CalculiX) or .feb (FEBio)",
            "save it under such a name".into(),
        ),
        Some(Kind::Surface) => {
            ("is a surface of triangles (STL), whose names end in .stl", "save it under such a name".into())
        }
        Some(Kind::Geometry) => {
            ("is a geometry, whose names end in .step, .stp, .iges, .igs or .brep", "save it under such a name".into())
        }
        Some(Kind::OtherGeometry) => ("is a geometry in a format that is not read", export_first()),
        Some(Kind::OtherMesh) => ("is a mesh in a format that is not read", convert_first()),
        Some(Kind::Table | Kind::Json | Kind::Binary) | None => ("is neither a deck nor a mesh", KNOWN.into()),
    };
    InputError::about_file(path, what).with_help(Some(help))
}

/// What can be read.
const KNOWN: &str = "case and model files are TOML; decks of Abaqus and CalculiX end in .inp, of FEBio in .feb, meshes of Gmsh in .msh, of VTK in .vtk or .vtu";

/// Says of a file that it stands for another one, if it does.
pub fn pointer(path: &Path, bytes: &[u8]) -> Option<InputError> {
    is_lfs_pointer(bytes).then(|| lfs_pointer(path))
}

fn is_lfs_pointer(bytes: &[u8]) -> bool {
    bytes.starts_with(b"version https://git-lfs.github.com/spec/")
}

fn lfs_pointer(path: &Path) -> InputError {
    let help = "fetch the file itself: `git lfs pull` in its repository".to_owned();
    InputError::about_file(path, "is a pointer of Git LFS, not the file that it stands for").with_help(Some(help))
}

fn mesh_first(name: &str) -> String {
    format!("`pneuflex new model {name}` writes a model file around it, and `pneuflex mesh {name}` a mesh")
}

/// What leads on from a geometry of a program that is not read.
fn export_first() -> String {
    "export it as STEP from the program that drew it (of Gmsh's .geo: `gmsh -3 -order 2`, into a .msh)".into()
}

fn convert_first() -> String {
    "convert it to a .msh of Gmsh, a .vtu of VTK or an .inp deck first, e.g. by meshio (`meshio convert a.med a.vtu`)"
        .into()
}

impl Kind {
    fn of(path: &Path, bytes: &[u8]) -> Option<Self> {
        let head = &bytes[..bytes.len().min(HEAD)];
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
        let text = String::from_utf8_lossy(head);
        let text = text.trim_start_matches('\u{feff}').trim_start();
        let first = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with("**")).unwrap_or("");
        let is_keyword = |line: &str| line.strip_prefix('*').is_some_and(|rest| rest.starts_with(char::is_alphabetic));
        Some(match extension.as_deref().unwrap_or("") {
            _ if is_lfs_pointer(head) => Self::LfsPointer,
            _ if text.starts_with("$MeshFormat") || text.starts_with("# vtk DataFile") => Self::Mesh,
            "msh" | "vtk" | "vtu" => Self::Mesh,
            "stl" | "obj" => Self::Surface,
            _ if text.starts_with("solid") && text.contains("facet normal") => Self::Surface,
            "csv" | "tsv" | "xls" | "xlsx" | "ods" => Self::Table,
            "step" | "stp" | "iges" | "igs" | "brep" => Self::Geometry,
            "geo" | "geo_unrolled" | "sldprt" | "fcstd" | "3mf" => Self::OtherGeometry,
            _ if text.starts_with("ISO-10303-21") => Self::Geometry,
            "vtp" | "vtm" | "off" | "ply" | "nas" | "bdf" | "fem" | "cdb" | "med" | "unv" | "mesh" | "meshb" | "e"
            | "exo" | "xdmf" | "odb" | "frd" | "k" => Self::OtherMesh,
            _ if is_keyword(first) || text.contains("<febio_spec") => Self::Deck,
            "json" | "jsonl" => Self::Json,
            _ if text.starts_with('{') => Self::Json,
            _ if head.contains(&0) => Self::Binary,
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_given_in_the_place_of_a_case_is_recognised_and_leads_on() {
        let says = |name: &str, bytes: &[u8]| {
            not_a_case(Path::new(name), bytes).map(|error| format!("{error}; {}", error.help().unwrap_or("no help")))
        };
        for (name, bytes, words) in [
            (
                "one_tet.msh",
                &b"$MeshFormat\n4.1 0 8"[..],
                "a mesh needs a model file; write a model file around it: [model] with file = \"one_tet.msh\"",
            ),
            ("mesh.toml", b"$MeshFormat\n4.1 0 8", "a mesh needs a model file"),
            ("deck.txt", b"** a remark\n\n*HEADING\nx", "end in .inp"),
            ("part.STL", b"\x00\x01", "pneuflex new model part.STL"),
            ("part", b"solid part\n facet normal 0 0 1\n", "surface of triangles"),
            ("curve.csv", b"1;2\n", "pneuflex fit"),
            ("part.step", b"ISO-10303-21;", "geometry"),
            ("body.vtp", b"<VTKFile>", "meshio"),
            ("summary.json", b"{\"program\": 1}", "case.toml"),
            ("page", b"\x7fELF\x00\x00", "format is unknown"),
            ("case.toml", b"version https://git-lfs.github.com/spec/v1\noid sha256:1\n", "git lfs pull"),
        ] {
            let said = says(name, bytes).unwrap_or_default();
            assert!(said.starts_with(name) && said.contains(words), "{name}: {said}");
        }
        for text in ["title = \"x\"\n", "[actuator]\n", "# *HEADING\n", "", "caf\u{e9} = 1"] {
            assert_eq!(says("case.toml", text.as_bytes()), None);
        }
        let body = |name: &str, bytes: &[u8]| not_a_body(Path::new(name), bytes).to_string();
        assert!(
            body("a.dat", b"solid a\nfacet normal").contains("(STL)")
                && body("a.toml", b"[model]").contains("neither a deck nor a mesh")
        );
        assert!(body("a.msh", b"version https://git-lfs.github.com/spec/v1").contains("Git LFS"));
    }
}
