//! A mesh as a file has it, whichever its format: elements that fill volume, pieces of their surfaces, edges and points with the groups that
//! they belong to → a mesh with named sets.

use std::collections::BTreeMap;

use pneuflex_mesh::mesh::determinant;
use pneuflex_mesh::{ElementKind, Facet, Mesh};

use crate::jacobian::inverted_elements;
use crate::mid_edges::{UNMATCHED, completed_mesh, note_on_families, unmatched_elements};
use crate::report::{DeckError, Note, Place, Report};

/// A file of a mesh as a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// The mesh with a set for every group.
    pub mesh: Mesh,
    /// What was understood in another way than the file may mean it.
    pub notes: Vec<Note>,
    /// The file's numbers of the nodes; mid-edge nodes that were added have none.
    pub node_tags: Vec<Option<u64>>,
    /// The file's numbers of the elements.
    pub element_tags: Vec<u64>,
}

/// What a file of a mesh holds.
#[derive(Debug, Default)]
pub(crate) struct RawMesh {
    /// Positions by number.
    pub nodes: BTreeMap<u64, [f64; 3]>,
    /// In the order of the file.
    pub elements: Vec<RawElement>,
    /// Names of groups by dimension and the number that elements have for them.
    pub groups: BTreeMap<(u8, i64), Vec<String>>,
}

/// An element of a file.
#[derive(Debug)]
pub(crate) struct RawElement {
    /// Its number.
    pub tag: u64,
    pub form: Form,
    /// Number of its groups, among those of its dimension.
    pub group: i64,
    /// In our order where it fills volume, the corners first elsewhere.
    pub nodes: Vec<u64>,
    pub line: u32,
}

/// What an element is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// It fills volume; `true` if it has its corners alone, but its family more nodes.
    Solid(ElementKind, bool),
    /// A piece of a surface, a curve or a point, by the number of its corners.
    Piece(usize),
}

impl Form {
    /// 3 for a solid, 2 for a surface, 1 for a curve, 0 for a point.
    pub const fn dimension(self) -> u8 {
        match self {
            Self::Solid(..) => 3,
            Self::Piece(1) => 0,
            Self::Piece(2) => 1,
            Self::Piece(_) => 2,
        }
    }
}

impl RawMesh {
    /// The mesh of a file called `name`, or what is wrong at a line.
    pub fn finish(read: Result<Self, (u32, String)>, name: &str) -> Result<MeshFile, Vec<DeckError>> {
        let mut report = Report::default();
        let file = match read {
            Ok(raw) => raw.build(&mut report),
            Err((line, why)) => {
                report.error(Place { file: 0, line }, why);
                None
            }
        };
        let notes = report.finish(&[name.to_owned()])?;
        match file {
            Some(file) => Ok(MeshFile { notes, ..file }),
            None => Err(vec![DeckError { file: name.to_owned(), line: 1, text: "the file holds no mesh".to_owned() }]),
        }
    }

    /// The mesh; what is wrong and worth knowing goes to the report.
    pub fn build(&self, report: &mut Report) -> Option<MeshFile> {
        build(self, report)
    }
}

fn build(raw: &RawMesh, report: &mut Report) -> Option<MeshFile> {
    let at = |element: &RawElement| Place { file: 0, line: element.line };
    let solid = |element: &'_ RawElement| matches!(element.form, Form::Solid(..));
    let solids: Vec<&RawElement> = raw.elements.iter().filter(|element| solid(element)).collect();
    let Some(&first) = solids.first() else {
        report.error(Place { file: 0, line: 1 }, "no volume is meshed: generate a mesh in three dimensions");
        return None;
    };
    let mut numbers: BTreeMap<u64, u32> =
        solids.iter().flat_map(|element| element.nodes.iter().map(|&tag| (tag, 0))).collect();
    numbers.iter_mut().zip(0..).for_each(|((_, number), next)| *number = next);
    let mut nodes = Vec::with_capacity(numbers.len());
    for tag in numbers.keys() {
        match raw.nodes.get(tag) {
            Some(&position) => nodes.push(position),
            None => {
                let user = solids.iter().find(|element| element.nodes.contains(tag)).copied().unwrap_or(first);
                report.error(at(user), format!("element {}: there is no node {tag}", user.tag));
                return None;
            }
        }
    }
    let numbered = |element: &&RawElement| match element.form {
        Form::Solid(kind, _) => Some((kind, element.nodes.iter().map(|tag| numbers[tag]).collect::<Vec<u32>>())),
        Form::Piece(_) => None,
    };
    let mut elements: Vec<(ElementKind, Vec<u32>)> = solids.iter().filter_map(numbered).collect();
    let mut turned = None;
    for ((_, nodes_of), written) in elements.iter_mut().zip(&solids).filter(|((_, nodes_of), _)| nodes_of.len() == 4) {
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| nodes[nodes_of[i] as usize]);
        let edge = |x: [f64; 3]| std::array::from_fn(|k| x[k] - a[k]);
        // Four corners are a body whatever their order.
        if determinant(&[edge(b), edge(c), edge(d)]) < 0.0 {
            nodes_of.swap(0, 1);
            turned.get_or_insert(at(written));
        }
    }
    if let Some(place) = turned {
        report.note(place, "tetrahedra whose corners are in the order of their mirror image are turned");
    }
    let mut mesh = completed_mesh(nodes, &elements);
    if let Some(element) = solids.iter().find(|element| matches!(element.form, Form::Solid(_, true))) {
        report.note(
            at(element),
            "tetrahedra with 4 nodes lock, and so do wedges with 6; straight mid-edge nodes are added, and sets take in those of their faces \
             and edges",
        );
    }
    if let Some(note) = note_on_families(&mesh) {
        report.note(at(first), note);
    }
    if let Some(([one, other], [x, y, z])) = unmatched_elements(&mesh) {
        let [tag, of_triangle] = [one, other].map(|element| solids[element].tag);
        let text = format!(
            "elements {tag} and {of_triangle} meet near ({x:.6}, {y:.6}, {z:.6}) with a quadrilateral on a triangle: {UNMATCHED}"
        );
        report.error(at(solids[one]), text);
    }
    for (element, smallest) in inverted_elements(&mesh) {
        let written = solids[element];
        let text = format!("element {} is inverted or flat: its Jacobian is {smallest:.3e}", written.tag);
        report.error(at(written), text);
    }
    let mut node_tags: Vec<Option<u64>> = numbers.keys().copied().map(Some).collect();
    node_tags.resize(mesh.num_nodes(), None);
    Groups { raw, numbers: &numbers }.add(&mut mesh, report);
    Some(MeshFile {
        mesh,
        notes: Vec::new(),
        node_tags,
        element_tags: solids.iter().map(|element| element.tag).collect(),
    })
}

/// Groups as sets.
struct Groups<'a> {
    raw: &'a RawMesh,
    /// Our numbers of nodes by theirs.
    numbers: &'a BTreeMap<u64, u32>,
}

impl Groups<'_> {
    fn add(&self, mesh: &mut Mesh, report: &mut Report) {
        let faces = faces_by_corners(mesh);
        let edges = edges_by_corners(mesh);
        let mut solid = 0;
        for element in &self.raw.elements {
            let is_solid = element.form.dimension() == 3;
            let number = solid;
            solid += u32::from(is_solid);
            for name in self.raw.groups.get(&(element.form.dimension(), element.group)).into_iter().flatten() {
                match element.form {
                    Form::Solid(..) => mesh.element_sets.entry(name.clone()).or_default().push(number),
                    Form::Piece(corners) => self.add_piece(element, corners, name, (&faces, &edges), mesh, report),
                }
            }
        }
        for nodes in mesh.node_sets.values_mut() {
            nodes.sort_unstable();
            nodes.dedup();
        }
        mesh.facet_sets.values_mut().for_each(|facets| {
            facets.sort_unstable();
            facets.dedup();
        });
    }

    /// Adds an element of a surface, a curve or a point to the sets of its group.
    fn add_piece(
        &self,
        element: &RawElement,
        corners: usize,
        name: &str,
        (faces, edges): (&Corners<Facet>, &Corners<u32>),
        mesh: &mut Mesh,
        report: &mut Report,
    ) {
        let place = Place { file: 0, line: element.line };
        let corners: Option<Vec<u32>> =
            element.nodes[..corners].iter().map(|tag| self.numbers.get(tag).copied()).collect();
        let Some(mut corners) = corners else {
            let text =
                format!("group {name}: elements whose nodes do not belong to the volume's elements are left out");
            return report.note(place, text);
        };
        corners.sort_unstable();
        let nodes = match corners.len() {
            1 => corners,
            2 => edges.get(&corners).map(|middles| [&corners[..], middles].concat()).unwrap_or_default(),
            _ => {
                let facets = faces.get(&corners).map_or(&[][..], Vec::as_slice);
                match facets {
                    [facet] => mesh.facet_sets.entry(name.to_owned()).or_default().push(*facet),
                    [] => {}
                    _ => {
                        let text = format!("group {name} lies inside of the body; it is a set of nodes, not of faces");
                        report.note(place, text);
                    }
                }
                facets.first().map(|&facet| mesh.facet_nodes(facet)).unwrap_or_default()
            }
        };
        if nodes.is_empty() {
            let text =
                format!("group {name}: elements that are no faces or edges of the volume's elements are left out");
            return report.note(place, text);
        }
        mesh.node_sets.entry(name.to_owned()).or_default().extend(nodes);
    }
}

/// Things by the ascending corners between which they lie.
pub(crate) type Corners<T> = BTreeMap<Vec<u32>, Vec<T>>;

pub(crate) fn faces_by_corners(mesh: &Mesh) -> Corners<Facet> {
    let mut found: Corners<Facet> = BTreeMap::new();
    for element in 0..mesh.num_elements() as u32 {
        for facet in mesh.facets_of(element) {
            let mut key = mesh.facet_nodes(facet);
            key.truncate(mesh.face_kind(facet).num_corners());
            key.sort_unstable();
            found.entry(key).or_default().push(facet);
        }
    }
    found
}

/// Mid-edge nodes, none for linear elements.
fn edges_by_corners(mesh: &Mesh) -> Corners<u32> {
    let mut found: Corners<u32> = BTreeMap::new();
    for element in 0..mesh.num_elements() {
        let (nodes, kind) = (mesh.element(element), mesh.kind_of(element));
        for (&[a, b], i) in kind.edges().iter().zip(kind.num_corners()..) {
            let key = vec![nodes[a].min(nodes[b]), nodes[a].max(nodes[b])];
            found.insert(key, nodes.get(i).filter(|_| kind.is_quadratic()).copied().into_iter().collect());
        }
    }
    found
}
