//! Air pressure on the faces of a cavity: a load that follows the deformed faces (theory §4).
//!
//! The residual is the follower load itself, `r_a = p ∫ N_a (r_ξ × r_η) dξ dη` with the facet's normal pointing out of the
//! solid. Its derivative is symmetric only after assembly, and only if the cavity is closed or cut by planes in which
//! its rim stays. Each face adds the symmetric part of its derivative: the parts left out cancel between neighbouring
//! faces and, on such a rim, act on held displacements only. What is left on other rims is in [`crate::boundary_term`].
//!
//! The potential is −p V. Of the many surface integrals for the volume V the one with the field (0, y, 0) is used,
//! `V = −∮ y n_y dS`: a rim in the symmetry plane y = 0, or in planes x = const and z = const, adds nothing to it or to its derivatives. (The form ⅓∮ r·n dS
//! has the right derivative along the plane, but adds forces normal to it along the rim.)

use std::sync::Arc;

use pneuflex_mesh::{FaceKind, Facet, Mesh, PerFaceKind, shape, shape::FaceShape};
use pneuflex_model::Pressure;

use crate::local::{LocalBlock, LocalContribution, LocalError, Request};

/// Faces under air pressure.
#[derive(Clone, Debug)]
pub struct FollowerPressure {
    /// The pressure.
    pub pressure: Pressure,
    /// Coordinate y of the plane that the volume is measured from, mm: that of a plane of symmetry y = const that cuts the cavity.
    pub plane_y: f64,
    mesh: Arc<Mesh>,
    faces: Vec<(FaceKind, Vec<u32>)>,
    rules: PerFaceKind<Vec<(FaceShape, f64)>>,
}

impl FollowerPressure {
    /// The given facets of a mesh, at zero pressure.
    pub fn new(mesh: impl Into<Arc<Mesh>>, facets: &[Facet]) -> Self {
        let mesh = mesh.into();
        Self {
            pressure: Pressure::default(),
            plane_y: 0.0,
            faces: facets.iter().map(|&facet| (mesh.face_kind(facet), mesh.facet_nodes(facet))).collect(),
            rules: PerFaceKind::new(|kind| {
                (kind.rule)().into_iter().map(|(xi, w)| (shape::evaluate_face(kind, xi), w)).collect()
            }),
            mesh,
        }
    }

    /// Volume of the air behind the faces, mm³; exact for a cavity that is closed, or cut by planes x = const, z = const and
    /// y = [`Self::plane_y`].
    pub fn volume(&self, displacement: &[[f64; 3]]) -> f64 {
        (0..self.num_blocks()).map(|face| self.face_volume(face, displacement)).sum()
    }

    /// ∫ N_a n dS = −∂V/∂x_a: forces on the nodes under a pressure of 1 MPa, N, one entry per node.
    pub fn forces_of_unit_pressure(&self, displacement: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut forces = vec![[0.0; 3]; displacement.len()];
        for face in 0..self.num_blocks() {
            for (shape, weight) in self.rule(face) {
                let (_, tangents) = self.geometry(face, displacement, shape);
                let normal = cross(&tangents);
                for (&node, value) in self.nodes(face).iter().zip(&shape.values) {
                    for k in 0..3 {
                        forces[node as usize][k] += weight * value * normal[k];
                    }
                }
            }
        }
        forces
    }

    /// Shape functions and weights at the integration points of a face.
    fn rule(&self, face: usize) -> &[(FaceShape, f64)] {
        &self.rules[self.faces[face].0]
    }

    fn face_volume(&self, face: usize, displacement: &[[f64; 3]]) -> f64 {
        let mut volume = 0.0;
        for (shape, weight) in self.rule(face) {
            let (position, tangents) = self.geometry(face, displacement, shape);
            let n_y = tangents[0][2] * tangents[1][0] - tangents[0][0] * tangents[1][2];
            volume -= weight * (position[1] - self.plane_y) * n_y;
        }
        volume
    }

    fn geometry(&self, face: usize, displacement: &[[f64; 3]], shape: &FaceShape) -> ([f64; 3], [[f64; 3]; 2]) {
        let (mut position, mut tangents) = ([0.0; 3], [[0.0; 3]; 2]);
        for (a, &node) in self.nodes(face).iter().enumerate() {
            for k in 0..3 {
                let x = self.mesh.nodes[node as usize][k] + displacement[node as usize][k];
                position[k] += shape.values[a] * x;
                tangents[0][k] += shape.gradients[a][0] * x;
                tangents[1][k] += shape.gradients[a][1] * x;
            }
        }
        (position, tangents)
    }
}

impl LocalContribution for FollowerPressure {
    fn num_blocks(&self) -> usize {
        self.faces.len()
    }

    fn nodes(&self, block: usize) -> &[u32] {
        &self.faces[block].1
    }

    fn evaluate(
        &self,
        block: usize,
        displacement: &[[f64; 3]],
        request: Request,
        out: &mut LocalBlock,
    ) -> Result<(), LocalError> {
        out.energy -= self.pressure.mpa() * self.face_volume(block, displacement);
        if request == Request::Energy {
            return Ok(());
        }
        for (shape, weight) in self.rule(block) {
            let (_, tangents) = self.geometry(block, displacement, shape);
            let [t1, t2] = tangents;
            let load = self.pressure.mpa() * weight;
            let normal = cross(&tangents);
            for (a, r) in out.residual.iter_mut().enumerate() {
                for k in 0..3 {
                    r[k] += load * shape.values[a] * normal[k];
                }
            }
            if request == Request::Tangent {
                let mut pair = 0;
                for a in 0..self.faces[block].1.len() {
                    for b in 0..=a {
                        // Symmetric part of N_a (N_b,η [r_ξ]ₓ − N_b,ξ [r_η]ₓ).
                        let (na, nb) = (shape.values[a], shape.values[b]);
                        let (da, db) = (shape.gradients[a], shape.gradients[b]);
                        let first = 0.5 * load * (na * db[1] - nb * da[1]);
                        let second = 0.5 * load * (na * db[0] - nb * da[0]);
                        let v: [f64; 3] = std::array::from_fn(|k| first * t1[k] - second * t2[k]);
                        // [v]ₓ, column by column.
                        let block = &mut out.tangent[pair];
                        pair += 1;
                        block[1] += v[2];
                        block[2] -= v[1];
                        block[3] -= v[2];
                        block[5] += v[0];
                        block[6] += v[1];
                        block[7] -= v[0];
                    }
                }
            }
        }
        Ok(())
    }
}

/// r_ξ × r_η: the normal into the solid, times the ratio of areas.
fn cross([a, b]: &[[f64; 3]; 2]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
