//! Surfaces that are glued to each other though their faces do not match, by linear equations (theory §6.4).
//!
//! On the mean over the slave surface its displacement is the master's, weighted with functions ψ_a that are dual to its shape functions:
//!
//! ```text
//! ∫ ψ_a (u_slave − u_master) dA = 0,   ∫ ψ_a N_b dA = δ_ab ∫ N_a dA,   u_a = Σ_m u_m ∫ ψ_a N_m dA / ∫ N_a dA
//! ```
//!
//! Every slave node follows master nodes near it (Wohlmuth 2000, *A mortar finite element method using dual spaces for the Lagrange
//! multiplier*). ψ = D M⁻¹ N face by face, with D the diagonal of the ∫ N_a and M the mass matrix, adds up to one: a constant stress passes
//! exactly if integrals are exact on both sides, for which faces are cut along each other's edges ([`crate::segments`]).

use std::collections::BTreeMap;

use pneuflex_mesh::vector::bounds;
use pneuflex_mesh::{FaceKind, Facet, Mesh, shape};
use pneuflex_model::{LinearEquation, Tie};

use crate::projection::{EXTENSION, dot, face_geometry, project, unit_normal};
use crate::segments::samples_for_masses;

/// Default tolerance as a share of the master faces' size.
const NEAR: f64 = 0.1;

/// A slave face of which less than this share lies on the master is not glued; one of which more than the other does is. What lies between
/// would be glued in part.
const COVERED: [f64; 2] = [0.02, 0.9];

/// Weights below this are rounding.
const NOTHING: f64 = 1e-10;

/// Why two surfaces cannot be glued.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TieError {
    /// They are nowhere near each other.
    #[error("tie {name}: no face of the slave lies within {tolerance:.4} mm of the master")]
    Apart {
        /// The tie.
        name: String,
        /// How near they must be, mm.
        tolerance: f64,
    },
    /// Faces lie on the master in part.
    #[error(
        "tie {name}: a slave face near ({:.4}, {:.4}, {:.4}) lies on the master with {:.0} % of its area; end the surfaces where elements end",
        .near[0], .near[1], .near[2], 100.0 * .share
    )]
    Overhanging {
        /// The tie.
        name: String,
        /// Middle of the face, mm.
        near: [f64; 3],
        /// What of its area lies on the master.
        share: f64,
    },
    /// Functions of corners with no mean over the face cannot be dual to anything.
    #[error(
        "tie {name}: the slave's faces lack nodes in their middle; solve it with the default elements, which have them"
    )]
    Serendipity {
        /// The tie.
        name: String,
    },
}

/// What a tie comes to.
#[derive(Clone, Debug, PartialEq)]
pub struct Glue {
    /// Slave nodes follow masters.
    pub equations: Vec<LinearEquation>,
    /// Number of the slave's faces that are glued, and of all.
    pub faces: [usize; 2],
}

/// The equations of a tie; `held` says for every degree of freedom (3 · node + axis) whether its displacement is prescribed: slave nodes follow
/// their supports then. The finer surface is the slave if it lies on the other one.
///
/// # Errors
/// [`TieError`].
pub fn glue(mesh: &Mesh, tie: &Tie, held: &[bool]) -> Result<Glue, TieError> {
    let surfaces = [&tie.slave, &tie.master];
    let [slave, master] = if tie.slave.len() >= tie.master.len() { surfaces } else { [surfaces[1], surfaces[0]] };
    let (following, faces) = following(mesh, tie, slave, master).or_else(|first| match first {
        TieError::Overhanging { .. } => following(mesh, tie, master, slave).map_err(|_| first),
        _ => Err(first),
    })?;
    let of_node = |(slave, masters): (u32, Weights)| {
        let axes = (0..3_u8).filter(move |axis| !held[3 * slave as usize + usize::from(*axis)]);
        axes.map(move |axis| {
            let others = masters.iter().map(|&(master, weight)| (master, axis, -weight));
            LinearEquation {
                terms: std::iter::once((slave, axis, 1.0)).chain(others).collect(),
                value: pneuflex_model::Curve::ZERO,
            }
        })
    };
    Ok(Glue { equations: following.into_iter().flat_map(of_node).collect(), faces })
}

/// Master nodes with their shares in what follows them.
type Weights = Vec<(u32, f64)>;

/// Slave nodes with what they follow; the numbers of slave faces that are glued, and of all.
type Following = (Vec<(u32, Weights)>, [usize; 2]);

/// A master face as the search sees it.
struct MasterFace {
    kind: FaceKind,
    nodes: Vec<u32>,
    positions: Vec<[f64; 3]>,
    bounds: [[f64; 3]; 2],
}

/// What follows what, if these are slave and master.
fn following(mesh: &Mesh, tie: &Tie, slave: &[Facet], master: &[Facet]) -> Result<Following, TieError> {
    let faces: Vec<MasterFace> = master.iter().map(|&facet| MasterFace::of(mesh, facet)).collect();
    let mean_area = faces.iter().map(MasterFace::area).sum::<f64>() / faces.len().max(1) as f64;
    let tolerance = tie.tolerance.unwrap_or(NEAR * mean_area.sqrt());
    let name = || tie.name.clone();
    let mut glued = 0;
    let mut of_node: BTreeMap<u32, (f64, BTreeMap<u32, f64>)> = BTreeMap::new();
    for &facet in slave {
        let face = MasterFace::of(mesh, facet);
        if matches!(face.kind, FaceKind::Tri6 | FaceKind::Quad8) {
            return Err(TieError::Serendipity { name: name() });
        }
        let near: Vec<&MasterFace> = faces.iter().filter(|other| other.is_near(&face, tolerance)).collect();
        let corners: Vec<&[[f64; 3]]> = near.iter().map(|f| &f.positions[..f.kind.num_corners()]).collect();
        let (mut area, mut covered) = (0.0, 0.0);
        let n = face.nodes.len();
        let mut masses = nalgebra::DMatrix::<f64>::zeros(n, n);
        // Of every covered point: area, shape functions there, the master face and its shape functions.
        let mut points: Vec<(f64, [f64; 9], &MasterFace, [f64; 9])> = Vec::new();
        for sample in samples_for_masses(face.kind, &face.positions, &corners) {
            area += sample.area;
            let here = shape::evaluate_face(face.kind, sample.xi);
            let geometry = face_geometry(&face.positions, &here);
            let normal = unit_normal(&geometry.tangents).0;
            let Some((opposite, xi)) = foot(&near, geometry.position, normal, tolerance) else { continue };
            covered += sample.area;
            for i in 0..n {
                for j in 0..n {
                    masses[(i, j)] += sample.area * here.values[i] * here.values[j];
                }
            }
            let there = shape::evaluate_face(opposite.kind, xi);
            points.push((sample.area, here.values, opposite, there.values));
        }
        if covered < COVERED[0] * area {
            continue;
        }
        if covered < COVERED[1] * area {
            let near = face_geometry(&face.positions, &shape::evaluate_face(face.kind, face.kind.centre())).position;
            return Err(TieError::Overhanging { name: name(), near, share: covered / area });
        }
        glued += 1;
        // Rows of D M⁻¹: the coefficients of ψ.
        let integrals = nalgebra::DVector::from_fn(n, |i, _| masses.row(i).sum());
        let Some(inverse) = masses.try_inverse() else { continue };
        let coefficients: nalgebra::DMatrix<f64> = nalgebra::DMatrix::from_diagonal(&integrals) * inverse;
        for (i, node) in face.nodes.iter().enumerate() {
            let (integral, weights) = of_node.entry(*node).or_default();
            *integral += integrals[i];
            for (area, here, opposite, there) in &points {
                let psi: f64 = (0..n).map(|j| coefficients[(i, j)] * here[j]).sum();
                for (master, value) in opposite.nodes.iter().zip(there) {
                    *weights.entry(*master).or_default() += area * psi * value;
                }
            }
        }
    }
    if of_node.is_empty() {
        return Err(TieError::Apart { name: name(), tolerance });
    }
    let of_node = of_node.into_iter().map(|(node, (integral, weights))| {
        let weights = weights.into_iter().map(|(master, weight)| (master, weight / integral));
        (node, weights.filter(|(_, weight)| weight.abs() > NOTHING).collect())
    });
    Ok((of_node.collect(), [glued, slave.len()]))
}

/// The face opposite a point, and the reference coordinates of the point's foot on it.
fn foot<'a>(
    near: &[&'a MasterFace],
    point: [f64; 3],
    normal: [f64; 3],
    tolerance: f64,
) -> Option<(&'a MasterFace, [f64; 2])> {
    let mut best: Option<(f64, f64, &MasterFace, [f64; 2])> = None;
    for &face in near {
        let Some(foot) = project(face.kind, &face.positions, point) else { continue };
        let is_opposite = dot(foot.normal, normal) < 0.0 && foot.distance.abs() <= tolerance;
        if !is_opposite || foot.excess > EXTENSION {
            continue;
        }
        let rank = (foot.excess, foot.distance.abs());
        if best.is_none_or(|(excess, distance, ..)| rank < (excess, distance)) {
            best = Some((rank.0, rank.1, face, foot.xi));
        }
    }
    best.map(|(_, _, face, xi)| (face, xi))
}

impl MasterFace {
    fn of(mesh: &Mesh, facet: Facet) -> Self {
        let nodes = mesh.facet_nodes(facet);
        let positions: Vec<[f64; 3]> = nodes.iter().map(|&node| mesh.nodes[node as usize]).collect();
        let bounds = bounds(positions.iter().copied()).unwrap_or_default();
        Self { kind: mesh.face_kind(facet), nodes, positions, bounds }
    }

    fn area(&self) -> f64 {
        let part = |(xi, weight): ([f64; 2], f64)| {
            weight * unit_normal(&face_geometry(&self.positions, &shape::evaluate_face(self.kind, xi)).tangents).1
        };
        (self.kind.rule)().into_iter().map(part).sum()
    }

    fn is_near(&self, other: &Self, tolerance: f64) -> bool {
        (0..3).all(|d| {
            self.bounds[0][d] <= other.bounds[1][d] + tolerance && other.bounds[0][d] <= self.bounds[1][d] + tolerance
        })
    }
}
