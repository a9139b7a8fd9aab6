//! Gmsh's `.msh` files of version 4.1, text or binary → a mesh with named sets.
//!
//! Physical groups become sets: of volumes, element sets; of surfaces, facet sets and node sets; of curves and points, node sets. Groups
//! without a name are called after their dimension and tag, as in `surface_5`.
//!
//! The `mshio` library was not used: it panics on files with no elements and on sizes of numbers that it does not know, skips the names of
//! groups, and forgets the tags of nodes in files whose tags have no gaps.

mod cursor;
mod element_types;
mod sections;

use std::collections::BTreeMap;

use pneuflex_mesh::{Facet, Mesh};

use crate::jacobian::inverted_elements;
use crate::mid_edges::{UNMATCHED, completed_mesh, note_on_families, unmatched_elements};
use crate::report::{DeckError, Note, Place, Report};
use element_types::{Solid, corners_of_type};
use sections::{Element, Sections};

/// A `.msh` file as a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// The mesh with a set for every physical group.
    pub mesh: Mesh,
    /// What was understood in another way than the file may mean it.
    pub notes: Vec<Note>,
    /// Gmsh's tags of the nodes; mid-edge nodes that were added have none.
    pub node_tags: Vec<Option<u64>>,
    /// Gmsh's tags of the elements.
    pub element_tags: Vec<u64>,
}

/// Reads a `.msh` file called `name` from its bytes.
///
/// # Errors
/// What is wrong or not supported, by line; binary numbers are not counted in lines.
pub fn read(name: &str, bytes: &[u8]) -> Result<MeshFile, Vec<DeckError>> {
    let mut report = Report::default();
    let file = match Sections::read(bytes) {
        Ok(sections) => build(&sections, &mut report),
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

fn build(sections: &Sections, report: &mut Report) -> Option<MeshFile> {
    let at = |element: &Element| Place { file: 0, line: element.line };
    let solids: Vec<(&Element, Solid)> =
        sections.elements.iter().filter_map(|element| Some((element, Solid::of_type(element.kind)?))).collect();
    let Some(&(first, _)) = solids.first() else {
        report.error(Place { file: 0, line: 1 }, "no volume is meshed: generate a mesh in three dimensions");
        return None;
    };
    let mut numbers: BTreeMap<u64, u32> =
        solids.iter().flat_map(|(element, _)| element.nodes.iter().map(|&tag| (tag, 0))).collect();
    numbers.iter_mut().zip(0..).for_each(|((_, number), next)| *number = next);
    let mut nodes = Vec::with_capacity(numbers.len());
    for tag in numbers.keys() {
        match sections.nodes.get(tag) {
            Some(&position) => nodes.push(position),
            None => {
                let user = solids.iter().find(|(element, _)| element.nodes.contains(tag)).map_or(first, |(e, _)| e);
                report.error(at(user), format!("element {}: there is no node {tag}", user.tag));
                return None;
            }
        }
    }
    let ordered = |(element, solid): &(&Element, Solid)| {
        (solid.kind, solid.order().iter().map(|&i| numbers[&element.nodes[i]]).collect::<Vec<u32>>())
    };
    let mut mesh = completed_mesh(nodes, &solids.iter().map(ordered).collect::<Vec<_>>());
    if let Some((element, _)) = solids.iter().find(|(_, solid)| solid.is_linear) {
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
        let [tag, of_triangle] = [one, other].map(|element| solids[element].0.tag);
        let text = format!(
            "elements {tag} and {of_triangle} meet near ({x:.6}, {y:.6}, {z:.6}) with a quadrilateral on a triangle: {UNMATCHED}"
        );
        report.error(at(solids[one].0), text);
    }
    for (element, smallest) in inverted_elements(&mesh) {
        let (written, _) = solids[element];
        let text = format!("element {} is inverted or flat: its Jacobian is {smallest:.3e}", written.tag);
        report.error(at(written), text);
    }
    let mut node_tags: Vec<Option<u64>> = numbers.keys().copied().map(Some).collect();
    node_tags.resize(mesh.num_nodes(), None);
    Groups { sections, numbers: &numbers }.add(&mut mesh, report);
    Some(MeshFile { mesh, notes: Vec::new(), node_tags, element_tags: solids.iter().map(|(e, _)| e.tag).collect() })
}

/// Physical groups as sets.
struct Groups<'a> {
    sections: &'a Sections,
    /// Our numbers of nodes by tag.
    numbers: &'a BTreeMap<u64, u32>,
}

impl Groups<'_> {
    fn add(&self, mesh: &mut Mesh, report: &mut Report) {
        let faces = faces_by_corners(mesh);
        let edges = edges_by_corners(mesh);
        let mut solid = 0;
        for element in &self.sections.elements {
            let dimension = element.entity.0;
            let number = solid;
            solid += u32::from(Solid::of_type(element.kind).is_some());
            let groups = self.sections.groups.get(&element.entity).map_or(&[][..], Vec::as_slice);
            for &group in groups {
                let name = self.name(dimension, group);
                if Solid::of_type(element.kind).is_some() {
                    mesh.element_sets.entry(name).or_default().push(number);
                } else {
                    self.add_piece(element, name, (&faces, &edges), mesh, report);
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
        element: &Element,
        name: String,
        (faces, edges): (&Corners<Facet>, &Corners<u32>),
        mesh: &mut Mesh,
        report: &mut Report,
    ) {
        let place = Place { file: 0, line: element.line };
        let corners: Option<Vec<u32>> =
            element.nodes[..corners_of_type(element.kind)].iter().map(|tag| self.numbers.get(tag).copied()).collect();
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
                    [facet] => mesh.facet_sets.entry(name.clone()).or_default().push(*facet),
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
        mesh.node_sets.entry(name).or_default().extend(nodes);
    }

    fn name(&self, dimension: i32, group: i32) -> String {
        let kind = ["point", "curve", "surface", "volume"].get(dimension.unsigned_abs() as usize).unwrap_or(&"group");
        self.sections.names.get(&(dimension, group)).cloned().unwrap_or_else(|| format!("{kind}_{group}"))
    }
}

/// Things by the ascending corners between which they lie.
type Corners<T> = BTreeMap<Vec<u32>, Vec<T>>;

fn faces_by_corners(mesh: &Mesh) -> Corners<Facet> {
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
