//! A mesh of any shape as a file of its own, for the result folders of bodies that were built in memory.

use std::collections::BTreeMap;

use pneuflex_mesh::{ElementKind, Facet, Kinds, Mesh};
use pneuflex_model::Formulation;
use serde::{Deserialize, Serialize};

use crate::input_error::InputError;

/// Name of the file.
pub const FILE: &str = "body.json";

/// A mesh without sets.
pub fn plain_mesh(kinds: Kinds, nodes: Vec<[f64; 3]>, connectivity: Vec<u32>) -> Mesh {
    let (node_sets, facet_sets, element_sets) = Default::default();
    Mesh { kinds, nodes, connectivity, node_sets, facet_sets, element_sets }
}

/// Checks that everything that a mesh names is there.
///
/// # Errors
/// What is not.
pub fn check(formulation: Formulation, mesh: &Mesh) -> Result<(), InputError> {
    let wrong = |what: String| Err(InputError::new(what));
    let (nodes, elements) = (mesh.num_nodes(), mesh.num_elements());
    let is_solved = match mesh.kinds.only() {
        // A family without a formulation of its own is enriched.
        Some(kind) => {
            kind == formulation.element
                || Formulation::of_kind(kind).is_none() && kind.enriched() == Some(formulation.element)
        }
        None => mesh.families().iter().all(|kind| kind.is_quadratic()),
    };
    if !is_solved {
        return wrong(format!("a mesh of {} cannot be solved as {formulation}", mesh.words()));
    }
    let wanted: usize = (0..elements).map(|element| mesh.kind_of(element).num_nodes()).sum();
    if elements == 0 || mesh.connectivity.len() != wanted {
        return wrong("the mesh has no cells, or its last one is incomplete".into());
    }
    if let Some(node) = mesh.nodes.iter().position(|x| !x.iter().all(|t| t.is_finite())) {
        return wrong(format!("the position of node {node} is not finite"));
    }
    if let Some(at) = mesh.connectivity.iter().position(|&node| node as usize >= nodes) {
        let (cell, node) =
            ((0..elements).position(|cell| mesh.kinds.range(cell).contains(&at)).unwrap_or(0), mesh.connectivity[at]);
        return wrong(format!("cell {cell} has node {node}, but there are {nodes} nodes"));
    }
    if let Some([quadrilateral, triangle]) = mesh.unmatched_faces() {
        let at = mesh.nodes[mesh.facet_nodes(quadrilateral)[0] as usize];
        return wrong(format!(
            "cells {} and {} meet with a quadrilateral on a triangle, at {at:?} mm: put wedges between hexahedra and tetrahedra, or divide \
             both into tetrahedra",
            quadrilateral.element, triangle.element
        ));
    }
    // A node beside all cells may be one that equations tie, or supports hold, by a set.
    let mut is_used = vec![false; nodes];
    let in_sets = mesh.node_sets.values().flatten();
    for &node in mesh.connectivity.iter().chain(in_sets).filter(|&&node| (node as usize) < nodes) {
        is_used[node as usize] = true;
    }
    if let Some(node) = is_used.iter().position(|is_used| !is_used) {
        return wrong(format!(
            "node {node} at {:?} mm belongs to no cell and to no set: leave it out",
            mesh.nodes[node]
        ));
    }
    let missing =
        |(name, count): (&String, usize)| wrong(format!("set {name} has members that are not there: {count}"));
    let beyond = |numbers: &[u32], end: usize| numbers.iter().filter(|&&number| number as usize >= end).count();
    let is_face = |facet: &&Facet| {
        (facet.element as usize) < elements
            && usize::from(facet.face) < mesh.kind_of(facet.element as usize).num_faces()
    };
    let of_nodes = mesh.node_sets.iter().map(|(name, set)| (name, beyond(set, nodes)));
    let of_faces = mesh.facet_sets.iter().map(|(name, set)| (name, set.len() - set.iter().filter(is_face).count()));
    let of_elements = mesh.element_sets.iter().map(|(name, set)| (name, beyond(set, elements)));
    of_nodes.chain(of_faces).chain(of_elements).find(|(_, count)| *count > 0).map_or(Ok(()), missing)
}

/// A mesh as it is recorded in a result folder.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedMesh {
    formulation: Formulation,
    /// Families of the elements, where not all are the formulation's.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    families: Vec<ElementKind>,
    nodes: Vec<[f64; 3]>,
    connectivity: Vec<u32>,
    node_sets: BTreeMap<String, Vec<u32>>,
    /// Element and local number of every face.
    face_sets: BTreeMap<String, Vec<(u32, u8)>>,
    element_sets: BTreeMap<String, Vec<u32>>,
}

impl RecordedMesh {
    /// A mesh and how it is solved.
    pub fn of(formulation: Formulation, mesh: &Mesh) -> Self {
        let faces = |set: &Vec<Facet>| set.iter().map(|facet| (facet.element, facet.face)).collect();
        let families = match mesh.kinds.only() {
            Some(kind) if kind == formulation.element => Vec::new(),
            _ => (0..mesh.num_elements()).map(|element| mesh.kind_of(element)).collect(),
        };
        Self {
            formulation,
            families,
            nodes: mesh.nodes.clone(),
            connectivity: mesh.connectivity.clone(),
            node_sets: mesh.node_sets.clone(),
            face_sets: mesh.facet_sets.iter().map(|(name, set)| (name.clone(), faces(set))).collect(),
            element_sets: mesh.element_sets.clone(),
        }
    }

    /// Its bytes.
    ///
    /// # Errors
    /// A number that cannot be written.
    pub fn written(&self) -> Result<Vec<u8>, InputError> {
        serde_json::to_vec(self).map_err(|error| InputError::new(format!("{FILE}: {error}")))
    }

    /// Reads a mesh from its bytes.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn read(bytes: &[u8]) -> Result<(Mesh, Formulation), String> {
        let read: Self = serde_json::from_slice(bytes).map_err(|error| error.to_string())?;
        let faces = |set: Vec<(u32, u8)>| set.into_iter().map(|(element, face)| Facet { element, face }).collect();
        let kinds = match read.families.as_slice() {
            [] => read.formulation.element_kind().into(),
            families => families.iter().copied().collect(),
        };
        let mesh = Mesh {
            node_sets: read.node_sets,
            facet_sets: read.face_sets.into_iter().map(|(name, set)| (name, faces(set))).collect(),
            element_sets: read.element_sets,
            ..plain_mesh(kinds, read.nodes, read.connectivity)
        };
        check(read.formulation, &mesh).map_err(|error| error.to_string())?;
        Ok((mesh, read.formulation))
    }
}
