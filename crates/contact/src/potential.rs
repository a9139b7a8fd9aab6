//! Energy, force and consistent tangent of the touching points between two faces, or between a face and an obstacle.
//!
//! The energy of a point is ½ k w g², g = d − λ/k, for all g < 0: without a multiplier λ, ½ k w ⟨−d⟩². Its traction is −k g = λ − k d. For a point that slides freely over the master (multiple-point), with
//! `G_α = a_α·δg`, `T_α = n·δr_m,α`, metric m, curvature `b_αβ = n·r_m,αβ` and `X = (m − d b)⁻¹(G + d T)` the change of
//! the foot, `∇d = n·δg` and
//!
//! ```text
//! ∇²d = −(T + b X)ᵀ m⁻¹ G − Xᵀ T
//! ```
//!
//! (Laursen 2002, *Computational Contact and Impact Mechanics*, ch. 5, rearranged). For centre-to-centre contact
//! (single-point) the foot is fixed and only the normal turns; its derivatives are in `fixed_point`.

use pneuflex_mesh::shape::{self, FaceShape};
use pneuflex_model::{ContactMethod, LoadParameter};

use crate::contact_block::{ContactBlock, ContactPoint, Partner};
use crate::model::ContactModel;
use crate::projection::{FaceGeometry, cross, dot, face_geometry, sub, unit_normal};
use crate::surface_pair::SurfacePair;

/// Largest number of nodes of a contact block: two nine-node faces.
pub const MAX_NODES: usize = 18;
const MAX_DOFS: usize = 3 * MAX_NODES;

/// What a block adds: energy (mJ), force on the nodes as the energy's gradient (N), tangent (N/mm).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BlockOutput {
    /// ½ k Σ w g².
    pub energy: f64,
    /// Gradient, three per node of the block.
    pub residual: Vec<f64>,
    /// Hessian, row by row over the block's degrees of freedom; empty unless asked for.
    pub tangent: Vec<f64>,
}

/// First and second derivative of the signed distance with respect to the block's degrees of freedom.
struct DistanceDerivatives {
    distance: f64,
    gradient: [f64; MAX_DOFS],
    hessian: Vec<f64>,
}

/// Evaluates a block found by [`ContactModel::search`] at the same positions. Where gaps are averaged, the energy, and the tangent's part
/// that comes from it, are those of [`crate::AverageGap`].
pub fn evaluate_block(
    model: &ContactModel,
    block: &ContactBlock,
    positions: &[[f64; 3]],
    with_tangent: bool,
) -> BlockOutput {
    let dofs = 3 * block.nodes.len();
    let is_averaged = model.averaging(block.partner).is_some();
    let mut out = BlockOutput {
        energy: 0.0,
        residual: vec![0.0; dofs],
        tangent: if with_tangent { vec![0.0; dofs * dofs] } else { Vec::new() },
    };
    let mut scratch = DistanceDerivatives {
        distance: 0.0,
        gradient: [0.0; MAX_DOFS],
        hessian: vec![0.0; if with_tangent { dofs * dofs } else { 0 }],
    };
    for point in &block.points {
        distance_derivatives(model, block, point, positions, &mut scratch);
        let factor = point.stiffness * point.area;
        let geometric = -point.carried * point.area;
        let force = if is_averaged {
            -point.traction * point.area
        } else {
            let d = scratch.distance - point.shift;
            out.energy += 0.5 * factor * d * d;
            factor * d
        };
        for i in 0..dofs {
            out.residual[i] += force * scratch.gradient[i];
        }
        if with_tangent {
            for i in 0..dofs {
                let gi = scratch.gradient[i];
                let row = &mut out.tangent[i * dofs..(i + 1) * dofs];
                let second = &scratch.hessian[i * dofs..(i + 1) * dofs];
                for j in 0..dofs {
                    row[j] += factor * gi * scratch.gradient[j] + geometric * second[j];
                }
            }
        }
    }
    out
}

/// Traction that the linearised distance predicts for every touching point, MPa: ⟨λ − k (d + ∇d·δu)⟩, with the point's number. `motion` says
/// between which positions on the load path obstacles move and overlaps go meanwhile, if they do.
///
/// A solver that carries it in the tangent's geometric term (see [`ContactPoint::traction`]) survives the deep
/// interpenetration of a first guess: the distance may be far off, what the linear system makes of it is not.
pub fn predicted_tractions(
    model: &ContactModel,
    block: &ContactBlock,
    positions: &[[f64; 3]],
    correction: &[[f64; 3]],
    motion: Option<[LoadParameter; 2]>,
) -> Vec<(usize, f64)> {
    let stiffness = model.stiffness(block.partner);
    let mut scratch = DistanceDerivatives { distance: 0.0, gradient: [0.0; MAX_DOFS], hessian: Vec::new() };
    let partner = match block.partner {
        Partner::Obstacle(number) => motion.map_or([0.0; 3], |[from, to]| model.moved(number, from, to)),
        Partner::Face { .. } => [0.0; 3],
    };
    let predict = |point: &ContactPoint| {
        distance_derivatives(model, block, point, positions, &mut scratch);
        let mut distance = scratch.distance - point.shift + model.allowed_change(point.number, motion);
        for (i, &node) in block.nodes.iter().enumerate() {
            for k in 0..3 {
                distance += scratch.gradient[3 * i + k] * (correction[node as usize][k] - partner[k]);
            }
        }
        (point.number, (-stiffness * distance).max(0.0))
    };
    block.points.iter().map(predict).collect()
}

/// ∂d/∂x of a point by its block's nodes, three entries each.
pub fn distance_gradient(
    model: &ContactModel,
    block: &ContactBlock,
    point: &ContactPoint,
    positions: &[[f64; 3]],
) -> [f64; MAX_DOFS] {
    let mut scratch = DistanceDerivatives { distance: 0.0, gradient: [0.0; MAX_DOFS], hessian: Vec::new() };
    distance_derivatives(model, block, point, positions, &mut scratch);
    scratch.gradient
}

/// A slave point and its partner on the master, with all that the distance depends on.
struct Pairing {
    /// Nodes of the slave face, and of both.
    own: usize,
    all: usize,
    /// Coefficients with which the block's nodes enter r_s − r_m: N on the slave, −N on the master.
    coefficients: [f64; MAX_NODES],
    /// Shape functions of the master face at the partner.
    shape: FaceShape,
    /// The master face at the partner.
    master: FaceGeometry,
    /// r_s − r_m.
    gap: [f64; 3],
    /// Unit normal of the master face and the length of r_ξ × r_η.
    normal: [f64; 3],
    length: f64,
}

impl Pairing {
    fn new(
        surface_pair: &SurfacePair,
        face: usize,
        block: &ContactBlock,
        point: &ContactPoint,
        positions: &[[f64; 3]],
    ) -> Self {
        let SurfacePair { slave, master, .. } = surface_pair;
        let (slave_kind, kind) = (slave.kind(block.slave_face), master.kind(face));
        let (own, of_master) = (slave_kind.num_nodes(), kind.num_nodes());
        let slave_shape = shape::evaluate_face(slave_kind, point.slave_xi);
        let shape = shape::evaluate_face(kind, point.master_xi);
        let slave_nodes = slave.face_positions(block.slave_face, positions);
        let slave_point = face_geometry(&slave_nodes[..own], &slave_shape).position;
        let master = face_geometry(&master.face_positions(face, positions)[..of_master], &shape);
        let mut coefficients = [0.0; MAX_NODES];
        coefficients[..own].copy_from_slice(&slave_shape.values[..own]);
        coefficients[own..].iter_mut().zip(&shape.values[..of_master]).for_each(|(c, value)| *c = -value);
        let (normal, length) = unit_normal(&master.tangents);
        Self {
            own,
            all: own + of_master,
            coefficients,
            shape,
            gap: sub(slave_point, master.position),
            master,
            normal,
            length,
        }
    }
}

fn distance_derivatives(
    model: &ContactModel,
    block: &ContactBlock,
    point: &ContactPoint,
    positions: &[[f64; 3]],
    out: &mut DistanceDerivatives,
) {
    match block.partner {
        Partner::Face { surface_pair, face } => {
            let surface_pair = model.surface_pair(surface_pair);
            let pairing = Pairing::new(surface_pair, face, block, point, positions);
            match surface_pair.method {
                ContactMethod::SinglePoint => fixed_point(&pairing, out),
                _ => sliding_point(&pairing, out),
            }
        }
        Partner::Obstacle(number) => obstacle_point(model, number, block, point, positions, out),
    }
}

/// Derivatives of d = φ(r_s).
fn obstacle_point(
    model: &ContactModel,
    number: usize,
    block: &ContactBlock,
    point: &ContactPoint,
    positions: &[[f64; 3]],
    out: &mut DistanceDerivatives,
) {
    let slave = model.slave(block.partner);
    let kind = slave.kind(block.slave_face);
    let (n, shape) = (kind.num_nodes(), shape::evaluate_face(kind, point.slave_xi));
    let position = face_geometry(&slave.face_positions(block.slave_face, positions)[..n], &shape).position;
    let distance = model.distance_to_obstacle(number, position);
    out.distance = distance.value;
    for i in 0..3 * n {
        out.gradient[i] = shape.values[i / 3] * distance.normal[i % 3];
    }
    if out.hessian.is_empty() {
        return;
    }
    for i in 0..3 * n {
        for j in 0..3 * n {
            let weight = shape.values[i / 3] * shape.values[j / 3];
            out.hessian[3 * n * i + j] = weight * distance.hessian[i % 3][j % 3];
        }
    }
}

/// Derivatives of d = (r_s − r_m)·n for a partner that stays the closest point.
fn sliding_point(pairing: &Pairing, out: &mut DistanceDerivatives) {
    let Pairing { own, all, coefficients, shape: shape_m, master: m, gap, normal, .. } = pairing;
    let (own, all, normal) = (*own, *all, *normal);
    let d = dot(*gap, normal);
    out.distance = d;
    for (i, c) in coefficients[..all].iter().enumerate() {
        for k in 0..3 {
            out.gradient[3 * i + k] = c * normal[k];
        }
    }
    if out.hessian.is_empty() {
        return;
    }

    let metric =
        [dot(m.tangents[0], m.tangents[0]), dot(m.tangents[0], m.tangents[1]), dot(m.tangents[1], m.tangents[1])];
    let b: [f64; 3] = m.curvatures.map(|r| dot(normal, r));
    let inverse_metric = inverse_symmetric(metric);
    let inverse_a = inverse_symmetric(std::array::from_fn(|i| metric[i] - d * b[i]));

    let dofs = 3 * all;
    let mut g = [[0.0; MAX_DOFS]; 2];
    let mut t = [[0.0; MAX_DOFS]; 2];
    for alpha in 0..2 {
        for i in 0..all {
            for k in 0..3 {
                g[alpha][3 * i + k] = coefficients[i] * m.tangents[alpha][k];
            }
        }
        for i in 0..all - own {
            for k in 0..3 {
                t[alpha][3 * (own + i) + k] = shape_m.gradients[i][alpha] * normal[k];
            }
        }
    }
    let mut x = [[0.0; MAX_DOFS]; 2];
    let mut left = [[0.0; MAX_DOFS]; 2];
    for i in 0..dofs {
        let rhs = [g[0][i] + d * t[0][i], g[1][i] + d * t[1][i]];
        x[0][i] = inverse_a[0] * rhs[0] + inverse_a[1] * rhs[1];
        x[1][i] = inverse_a[1] * rhs[0] + inverse_a[2] * rhs[1];
        let y = [t[0][i] + b[0] * x[0][i] + b[1] * x[1][i], t[1][i] + b[1] * x[0][i] + b[2] * x[1][i]];
        left[0][i] = inverse_metric[0] * y[0] + inverse_metric[1] * y[1];
        left[1][i] = inverse_metric[1] * y[0] + inverse_metric[2] * y[1];
    }
    for i in 0..dofs {
        for j in 0..dofs {
            out.hessian[i * dofs + j] =
                -(left[0][i] * g[0][j] + left[1][i] * g[1][j] + x[0][i] * t[0][j] + x[1][i] * t[1][j]);
        }
    }
}

/// Derivatives of d = (r_s − r_m)·n at fixed reference points, n = c/‖c‖, c = r_ξ × r_η of the master face.
fn fixed_point(pairing: &Pairing, out: &mut DistanceDerivatives) {
    let Pairing { own, all, coefficients, shape: shape_m, master: m, gap, normal, length } = pairing;
    let (own, all, normal, length) = (*own, *all, *normal, *length);
    let d = dot(*gap, normal);
    // Part of the gap in the tangent plane.
    let tangential: [f64; 3] = std::array::from_fn(|k| gap[k] - d * normal[k]);
    let dofs = 3 * all;

    // Per degree of freedom: change of the gap, and of c; axis vectors make both sparse.
    let mut delta_c = [[0.0; 3]; MAX_DOFS];
    for i in 0..all - own {
        for k in 0..3 {
            let mut axis = [0.0; 3];
            axis[k] = 1.0;
            let first = cross(axis, m.tangents[1]);
            let second = cross(m.tangents[0], axis);
            delta_c[3 * (own + i) + k] =
                std::array::from_fn(|q| shape_m.gradients[i][0] * first[q] + shape_m.gradients[i][1] * second[q]);
        }
    }
    out.distance = d;
    for i in 0..all {
        for k in 0..3 {
            let dof = 3 * i + k;
            out.gradient[dof] = coefficients[i] * normal[k] + dot(tangential, delta_c[dof]) / length;
        }
    }
    if out.hessian.is_empty() {
        return;
    }
    let projected: Vec<[f64; 3]> = delta_c[..dofs]
        .iter()
        .map(|c| {
            let along = dot(*c, normal);
            std::array::from_fn(|k| (c[k] - along * normal[k]) / length)
        })
        .collect();
    for p in 0..dofs {
        let (ip, kp) = (p / 3, p % 3);
        for q in 0..dofs {
            let (iq, kq) = (q / 3, q % 3);
            // δg·P Δc/s + Δg·P δc/s
            let mut value = coefficients[ip] * projected[q][kp] + coefficients[iq] * projected[p][kq];
            // −[(t·Δc)(n·δc) + (t·δc)(n·Δc)]/s² − d Δc·P δc/s²
            value -= (dot(tangential, delta_c[q]) * dot(normal, delta_c[p])
                + dot(tangential, delta_c[p]) * dot(normal, delta_c[q]))
                / (length * length);
            value -= d * dot(projected[p], delta_c[q]) / length;
            // t·(δa₁ × Δa₂ + Δa₁ × δa₂)/s
            if ip >= own && iq >= own && kp != kq {
                let (gp, gq) = (shape_m.gradients[ip - own], shape_m.gradients[iq - own]);
                let (mut u, mut v) = ([0.0; 3], [0.0; 3]);
                u[kp] = 1.0;
                v[kq] = 1.0;
                value += (gp[0] * gq[1] - gq[0] * gp[1]) * dot(tangential, cross(u, v)) / length;
            }
            out.hessian[p * dofs + q] = value;
        }
    }
}

/// Inverse of \[a, b; b, c\] given and returned as \[a, b, c\].
fn inverse_symmetric([a, b, c]: [f64; 3]) -> [f64; 3] {
    let determinant = a * c - b * b;
    [c / determinant, -b / determinant, a / determinant]
}
