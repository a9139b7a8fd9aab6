//! Results in the formats of other programs. Data goes in and bytes come out; reading the result folder and writing the files is up to the
//! caller.
//!
//! * [`surface`]: the surface of the whole body as triangles, which [`stl`], [`obj`] and [`gltf`] write.
//! * [`gltf`]: the same in motion and in colours.
//! * [`nodes`], [`npz`]: fields at the nodes as tables and as arrays of numpy.
//! * [`linear_mesh`]: the solid as linear hexahedra or tetrahedra, for robot simulators.
//! * [`gif`]: pictures as an animation.
//! * [`mould`]: what an actuator is cast in.
//!
//! Lengths are in mm, stresses in MPa. A body of which a part is modelled is whole in everything but tables and arrays, which have the nodes of
//! the mesh.

mod error;
pub mod gif;
mod glb;
pub mod gltf;
pub mod linear_mesh;
pub mod mould;
pub mod nodes;
pub mod npz;
pub mod obj;
pub mod paint;
pub mod stl;
pub mod surface;
#[cfg(test)]
mod testing;

pub use error::ExportError;
