//! From the text of a deck or mesh to a problem.
//!
//! * [`syntax`]: keywords, parameters, data lines, included files.
//! * [`mesh_and_sets`], [`materials`], [`steps`]: what the keywords mean.
//! * [`cavities`]: spaces filled with fluid.
//! * [`constraints`]: ties, rigid bodies, couplings, MPCs; also solved.
//! * [`feb`]: files of FEBio.
//! * [`msh`]: meshes of Gmsh.
//! * [`vtk`]: meshes of VTK.
//! * [`samples`]: whole decks, as they are and damaged.
//! * [`calculix`]: whole decks against the displacements of CalculiX.

// Helpers count as tests here.
#![allow(clippy::unwrap_used)]

mod calculix;
mod cavities;
mod constraints;
mod feb;
mod materials;
mod mesh_and_sets;
mod msh;
mod samples;
mod steps;
mod support;
mod syntax;
mod vtk;
