//! Guesses from the load steps of a similar design.

use pneuflex_mesh::Mesh;
use pneuflex_newton::EquilibriumPath;
use serde::{Deserialize, Serialize};

use crate::checkpoint_file::{checksum, sealed, unsealed};

/// The equilibria of a design ([`crate::Solution::neighbour`]), for runs of similar ones on meshes of the same topology
/// ([`crate::Run::start_from`]).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Neighbour {
    /// A digest of the elements and their nodes.
    topology: u64,
    path: EquilibriumPath,
}

impl Neighbour {
    /// That of a path on a mesh.
    pub(crate) fn new(mesh: &Mesh, path: EquilibriumPath) -> Self {
        Self { topology: topology(mesh), path }
    }

    /// The path, if it is one on a mesh of that topology.
    pub(crate) fn path_on(self, mesh: &Mesh) -> Option<EquilibriumPath> {
        (self.topology == topology(mesh)).then_some(self.path)
    }

    /// As bytes of a file, behind a checksum.
    ///
    /// # Errors
    /// What the writer says.
    pub fn to_bytes(&self) -> Result<Vec<u8>, rmp_serde::encode::Error> {
        rmp_serde::to_vec(self).map(|bytes| sealed(&bytes))
    }

    /// That of a file; none if a byte is not what was written.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        rmp_serde::from_slice(unsealed(bytes)?).ok()
    }
}

fn topology(mesh: &Mesh) -> u64 {
    let nodes: Vec<u8> = mesh.connectivity.iter().flat_map(|node| node.to_le_bytes()).collect();
    checksum(&[format!("{:?} {} ", mesh.kinds, mesh.num_nodes()).as_bytes(), &nodes].concat())
}
