//! Frictionless penalty contact by brute force (theory §5): the energy ½ k ∫⟨−d⟩² dA₀ over the slaves' reference area.
//!
//! * Single-point: the centre of slave facet i against the centre of master facet i, d = (r_s − r_m) · n_m with the
//!   master's normal at its centre. One Gauss point, so the area weight is 4 |X_ξ × X_η| (½ on triangles).
//! * Multiple-point: 4 × 4 Gauss points (a symmetric rule of 16 on triangles) on every slave facet, each projected on *every* master facet of the pair.
//!
//! Which projection counts, in the order of the master list:
//! 1. among facets with converged |ξ|, |η| ≤ 1 + 1e−9 the nearest, the first of equals;
//! 2. otherwise among those with |ξ|, |η| ≤ 1.1 the nearest;
//! 3. otherwise none: no contact.
//!
//! On triangles 0 ≤ ξ, 0 ≤ η, ξ + η ≤ 1, with the same excesses. There is no limit to the depth: the production path's is beyond what
//! an equilibrium reaches.
//!
//! Where both surfaces are slaves, each has half of its area.
//!
//! # Derivatives through the projection
//! (ξ, η) solves g(ξ, q) = (r_m − r_s) · r_m,ξ = 0 and so depends on q. The search runs in real numbers until
//! convergence. Then Newton steps ξ ← ξ − (∂g/∂ξ)⁻¹ g are repeated in dual numbers, starting at the converged real
//! point. There the error as a function of δq is O(δq), after one step O(δq²), after two O(δq⁴): two steps carry exact
//! first and second derivatives of ξ. (For d itself one would do, because d is stationary in ξ at the closest point.)

use nalgebra::{DMatrix, DVector};
use pneuflex_mesh::{FaceKind, Facet};
use pneuflex_model::{Contact, ContactMethod, ContactPair, Problem};

use crate::closest_point::{centre, distance, excess, interpolate, penalty, project, projection_step};
use crate::differentiate::{Differentiable, Dual, Energy, LinearMap, Term, cross, dot, minus, vector};
use crate::elements;
use crate::error::{ReferenceError, Unmodelled};
use crate::shape::{ShapeFunctions, face_functions};

/// A projection counts as inside its facet up to this excess of |ξ|, |η| over 1 (or over a triangle's sides).
const INSIDE: f64 = 1e-9;
/// Without any projection inside, one this far outside is accepted: it bridges the wedge between tilted neighbours.
const MARGIN: f64 = 0.1;

/// A slave point that has found its master point.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactPoint {
    /// Number of the surface pair: contact pairs in the order of the problem, those of two passes twice.
    pub surface_pair: usize,
    /// Position in the pair's list of slave facets.
    pub slave: usize,
    /// Number of the point on its facet, ξ fastest.
    pub point: usize,
    /// Position in the pair's list of master facets.
    pub master: usize,
    /// (ξ, η) on the master facet.
    pub xi: [f64; 2],
    /// Signed distance d = (r_s − r_m) · n_m, mm; negative inside the master.
    pub gap: f64,
    /// Share of the slave's reference area, mm²; half of it where both surfaces are slaves.
    pub area: f64,
}

/// Contact of a problem.
#[derive(Clone, Debug)]
pub struct ContactModel {
    surface_pairs: Vec<SurfacePair>,
    positions: Vec<[f64; 3]>,
    // Of every family of faces that there is.
    shapes: Vec<(FaceKind, ShapeFunctions<2>)>,
}

/// A facet: its family and nodes.
type Face = (FaceKind, Vec<u32>);

/// Points of one surface against another.
#[derive(Clone, Debug)]
struct SurfacePair {
    is_single_point: bool,
    // k, N/mm³
    stiffness: f64,
    // Share of the slave's area that its points stand for.
    share: f64,
    slave: Vec<Face>,
    master: Vec<Face>,
}

impl SurfacePair {
    fn rule(&self, kind: FaceKind) -> Vec<([f64; 2], f64)> {
        if self.is_single_point { elements::centre_rule(kind) } else { elements::contact_rule(kind) }
    }
}

/// ½ k A ⟨−d⟩² with a given master point; v holds r_s, r_m, r_m,ξ, r_m,η.
#[derive(Clone, Debug)]
struct FixedPoint {
    // k A, N/mm
    stiffness: f64,
}

impl Energy<12> for FixedPoint {
    fn energy<D: Dual>(&self, v: &[D; 12]) -> D {
        let [slave, master, along_xi, along_eta] = std::array::from_fn(|k| vector(v, k));
        penalty(self.stiffness, distance(slave, master, along_xi, along_eta))
    }
}

/// ½ k A ⟨−d⟩² with the closest point of a master facet; v holds r_s and the positions of the facet's nodes.
#[derive(Clone, Debug)]
struct ClosestPoint<'a> {
    stiffness: f64,
    shape: &'a ShapeFunctions<2>,
    // Converged projection at the present displacements.
    xi: [f64; 2],
}

impl<const N: usize> Energy<N> for ClosestPoint<'_> {
    fn energy<D: Dual>(&self, v: &[D; N]) -> D {
        let slave = vector(v, 0);
        let nodes: Vec<[D; 3]> = (1..N / 3).map(|k| vector(v, k)).collect();
        let mut xi = self.xi.map(D::from);
        for _ in 0..2 {
            let step = projection_step(self.shape, slave, &nodes, &xi);
            xi = [xi[0] + step[0], xi[1] + step[1]];
        }
        let [master, along_xi, along_eta] =
            [[0, 0], [1, 0], [0, 1]].map(|orders| interpolate(&nodes, &self.shape.derivatives(orders, &xi)));
        penalty(self.stiffness, distance(slave, master, along_xi, along_eta))
    }
}

impl ContactModel {
    /// Contact between the problem's pairs.
    ///
    /// # Errors
    /// An element family without a formulation, lists of unequal length in single-point contact, or contact that is not modelled
    /// ([`Unmodelled`]).
    pub fn new(problem: &Problem) -> Result<Self, ReferenceError> {
        let mesh = &problem.mesh;
        let mut shapes: Vec<(FaceKind, ShapeFunctions<2>)> = Vec::new();
        for &facet in problem.contact_pairs.iter().flat_map(|pair| pair.slave.iter().chain(&pair.master)) {
            let kind = mesh.face_kind(facet);
            if shapes.iter().all(|(known, _)| *known != kind) {
                shapes.push(face_functions(problem, facet)?);
            }
        }
        // The actuator's mesh builder has made pairs of the two flags.
        let Contact { method, stiffness, two_pass: _, self_contact: _, penetration_tolerance } = &problem.contact;
        if penetration_tolerance.is_some() {
            let (part, name) = (Unmodelled::PenetrationTolerance, "contact.penetration_tolerance".into());
            return Err(ReferenceError::NotModelled { part, name });
        }
        let faces = |facets: &[Facet]| -> Vec<Face> {
            facets.iter().map(|&f| (mesh.face_kind(f), mesh.facet_nodes(f))).collect()
        };
        let mut surface_pairs = Vec::new();
        for pair in &problem.contact_pairs {
            let ContactPair { name, slave, master, method: own_method, stiffness: own_stiffness, is_two_pass, .. } =
                pair;
            if pair.penetration_tolerance.is_some() {
                let (part, name) = (Unmodelled::PenetrationTolerance, name.clone());
                return Err(ReferenceError::NotModelled { part, name });
            }
            if pair.interference_until.is_some() {
                return Err(ReferenceError::NotModelled { part: Unmodelled::Interference, name: name.clone() });
            }
            let is_single_point = match own_method.unwrap_or(*method) {
                ContactMethod::None => continue,
                ContactMethod::SinglePoint => true,
                ContactMethod::MultiPoint => false,
                ContactMethod::Mortar => {
                    return Err(ReferenceError::NotModelled { part: Unmodelled::Mortar, name: name.clone() });
                }
            };
            if is_single_point && slave.len() != master.len() {
                let (pair, slave, master) = (name.clone(), slave.len(), master.len());
                return Err(ReferenceError::UnpairedFacets { pair, slave, master });
            }
            let (slave, master) = (faces(slave), faces(master));
            let mut of_slave = slave.iter().flat_map(|(_, nodes)| nodes);
            if of_slave.any(|node| master.iter().any(|(_, nodes)| nodes.contains(node))) {
                return Err(ReferenceError::NotModelled { part: Unmodelled::SelfContact, name: name.clone() });
            }
            let surface_pair = |slave: &[Face], master: &[Face]| SurfacePair {
                is_single_point,
                stiffness: own_stiffness.unwrap_or(*stiffness),
                share: if *is_two_pass { 0.5 } else { 1.0 },
                slave: slave.to_vec(),
                master: master.to_vec(),
            };
            surface_pairs.push(surface_pair(&slave, &master));
            if *is_two_pass {
                surface_pairs.push(surface_pair(&master, &slave));
            }
        }
        Ok(Self { surface_pairs, positions: mesh.nodes.clone(), shapes })
    }

    /// ½ k ∫⟨−d⟩² dA₀ at displacements `u`, N·mm.
    pub fn energy(&self, u: &[f64]) -> f64 {
        self.active_terms(u).iter().map(|term| term.value(u)).sum()
    }

    /// ∂energy/∂u, N: minus the contact forces, −Q_c of theory §6.
    pub fn gradient(&self, u: &[f64]) -> DVector<f64> {
        let mut gradient = DVector::zeros(u.len());
        self.active_terms(u).iter().for_each(|term| term.add_gradient(u, 1.0, &mut gradient));
        gradient
    }

    /// ∂²energy/∂u², N/mm.
    pub fn hessian(&self, u: &[f64]) -> DMatrix<f64> {
        let mut hessian = DMatrix::zeros(u.len(), u.len());
        self.active_terms(u).iter().for_each(|term| term.add_hessian(u, 1.0, &mut hessian));
        hessian
    }

    /// Every slave point that has a master point, touching or not.
    pub fn points(&self, u: &[f64]) -> Vec<ContactPoint> {
        let mut points = Vec::new();
        for (number, pair) in self.surface_pairs.iter().enumerate() {
            for (slave, (kind, nodes)) in pair.slave.iter().enumerate() {
                for (point, (xi, weight)) in pair.rule(*kind).into_iter().enumerate() {
                    let rows = [[0, 0], [1, 0], [0, 1]].map(|orders| self.shape(*kind).derivatives(orders, &xi));
                    let at = |k: usize, nodes: &[[f64; 3]]| interpolate(nodes, &rows[k]);
                    let reference: Vec<_> = nodes.iter().map(|&n| self.positions[n as usize]).collect();
                    let normal = cross(at(1, &reference), at(2, &reference));
                    let area = pair.share * weight * dot(normal, normal).sqrt();
                    let r_s = at(0, &self.deformed(nodes, u));
                    let found = if pair.is_single_point {
                        Some((slave, centre(pair.master[slave].0)))
                    } else {
                        self.closest(pair, r_s, u)
                    };
                    if let Some((master, xi)) = found {
                        let (kind, nodes) = &pair.master[master];
                        let nodes = self.deformed(nodes, u);
                        let [r_m, along_xi, along_eta] = [[0, 0], [1, 0], [0, 1]]
                            .map(|orders| interpolate(&nodes, &self.shape(*kind).derivatives(orders, &xi)));
                        let gap = distance(r_s, r_m, along_xi, along_eta);
                        points.push(ContactPoint { surface_pair: number, slave, point, master, xi, gap, area });
                    }
                }
            }
        }
        points
    }

    /// The rule in the module's text: master facet and (ξ, η).
    fn closest(&self, pair: &SurfacePair, r_s: [f64; 3], u: &[f64]) -> Option<(usize, [f64; 2])> {
        let candidates: Vec<(usize, [f64; 2], f64)> = (pair.master.iter())
            .enumerate()
            .filter_map(|(master, (kind, nodes))| {
                let (shape, nodes) = (self.shape(*kind), self.deformed(nodes, u));
                let xi = project(shape, centre(*kind), r_s, &nodes)?;
                let offset = minus(r_s, interpolate(&nodes, &shape.derivatives([0, 0], &xi)));
                Some((master, xi, dot(offset, offset)))
            })
            .collect();
        let nearest_within = |limit: f64| {
            // `min_by` returns the first of equals.
            candidates
                .iter()
                .filter(|(master, xi, _)| excess(pair.master[*master].0, xi) <= limit)
                .min_by(|a, b| a.2.total_cmp(&b.2))
                .map(|&(master, xi, _)| (master, xi))
        };
        nearest_within(INSIDE).or_else(|| nearest_within(MARGIN))
    }

    fn shape(&self, kind: FaceKind) -> &ShapeFunctions<2> {
        let known = self.shapes.iter().find(|(known, _)| *known == kind);
        &known.expect("there are functions for every face of the pairs").1
    }

    fn deformed(&self, nodes: &[u32], u: &[f64]) -> Vec<[f64; 3]> {
        let position = |n: usize| std::array::from_fn(|i| self.positions[n][i] + u[3 * n + i]);
        nodes.iter().map(|&n| position(n as usize)).collect()
    }

    /// Energies of the touching points.
    fn active_terms(&self, u: &[f64]) -> Vec<Box<dyn Differentiable + '_>> {
        self.points(u).iter().filter(|point| point.gap < 0.0).map(|point| self.term(point)).collect()
    }

    fn term(&self, point: &ContactPoint) -> Box<dyn Differentiable + '_> {
        let pair = &self.surface_pairs[point.surface_pair];
        let ((slave_kind, slave), (kind, master)) = (&pair.slave[point.slave], &pair.master[point.master]);
        let (nodes, own, n) = ([slave.clone(), master.clone()].concat(), slave.len(), master.len());
        let xi = pair.rule(*slave_kind)[point.point].0;
        let on_slave = [self.shape(*slave_kind).values(&xi), vec![0.0; n]].concat();
        let shape = self.shape(*kind);
        let stiffness = pair.stiffness * point.area;
        if pair.is_single_point {
            let on_master =
                [[0, 0], [1, 0], [0, 1]].map(|orders| [vec![0.0; own], shape.derivatives(orders, &point.xi)].concat());
            let rows = [&[on_slave], &on_master[..]].concat();
            let map = LinearMap::of_positions(&nodes, &self.positions, &rows);
            return Box::new(Term::<12, _> { energy: FixedPoint { stiffness }, map });
        }
        let mut rows = vec![on_slave];
        rows.extend((0..n).map(|a| (0..own + n).map(|b| f64::from(b == own + a)).collect()));
        let energy = ClosestPoint { stiffness, shape, xi: point.xi };
        match n {
            6 => Box::new(Term::<21, _> { energy, map: LinearMap::of_positions(&nodes, &self.positions, &rows) }),
            7 => Box::new(Term::<24, _> { energy, map: LinearMap::of_positions(&nodes, &self.positions, &rows) }),
            4 => Box::new(Term::<15, _> { energy, map: LinearMap::of_positions(&nodes, &self.positions, &rows) }),
            8 => Box::new(Term::<27, _> { energy, map: LinearMap::of_positions(&nodes, &self.positions, &rows) }),
            _ => Box::new(Term::<30, _> { energy, map: LinearMap::of_positions(&nodes, &self.positions, &rows) }),
        }
    }
}

#[cfg(test)]
mod tests;
