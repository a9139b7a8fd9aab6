//! The solid: strain energy of all elements, with the pressures of nearly incompressible elements (theory §3).
//!
//! Every formulation is the saddle-point energy
//!
//! ```text
//! Π(u, p) = Σ_dev w φ(G) + Σ_vol w [ p (J − 1) − p² / (2κ) ],     p = Σ ψᵢ pᵢ
//! ```
//!
//! over its deviatoric and its volumetric points, with weights w that contain the reference volume:
//!
//! See [`crate::elements`] for the points and ψ.
//!
//! Π is quadratic in p. Its stationary value is the primal energy: with θᵢ = Σ w ψᵢ (J − 1) and Mᵢⱼ = Σ w ψᵢ ψⱼ it is
//! p = κ M⁻¹ θ and Σ φ + ½ κ θᵀ M⁻¹ θ, that is ½ κ (J_C − 1)² Vₑ for `hex8-sri` and ½ κ (J̄ − 1)² Vₑ for `hex8-q1p0`.
//! Where a material's volumetric energy U(J) is not quadratic, Π has another field j, the change of volume in the space of the
//! pressures (Simo, Taylor & Pister 1985, *Comput. Methods Appl. Mech. Engrg.* 51): its volumetric terms are
//! w [ U(1 + j) + p (J − 1 − j) ] with j = Σ ψᵢ jᵢ, and the primal energy is Σ φ + Σ w U(1 + Σ ψᵢ (M⁻¹ θ)ᵢ). The coefficients
//! jᵢ of an element stand behind its pressures.
//!
//! For `tet10`, and with the full invariant for `hex20` and `hex27`, a part κ_f of κ ([`elements::fluctuation_modulus`]) is taken out of
//! the p² term and put at the deviatoric points as ½ κ_f (J − 1)²; with j = Σ ψᵢ (M⁻¹ θ)ᵢ the primal energy is then
//! Σ φ + ½ κ Σ w j² + ½ κ_f Σ w (J − 1 − j)².
//! The derivatives of the primal energy follow by eliminating p from those of Π, exactly.

use nalgebra::{DMatrix, DVector, Matrix3};
use pneuflex_model::{Formulation, Material, Problem, Region, Volumetric};

use crate::differentiate::{Differentiable, Dual, Energy, LinearMap, Term};
use crate::elements;
use crate::energy::{check as check_material, deviatoric, gradient_from, jacobian, volumetric};
use crate::error::ReferenceError;
use crate::quadrature;
use crate::shape::ShapeFunctions;

/// One integration point's share of Π; v holds G row by row, then p and j.
#[derive(Clone, Debug)]
struct SaddlePoint {
    material: Material,
    fluctuation_modulus: f64,
    // Whether j is a field of its own.
    has_own_dilatation: bool,
    // Weights of the two parts of Π at this point, mm³.
    deviatoric: f64,
    volumetric: f64,
}

impl Energy<11> for SaddlePoint {
    fn energy<D: Dual>(&self, v: &[D; 11]) -> D {
        let (g, p, j) = (gradient_from(v), v[9], v[10]);
        let mut energy = D::from(0.0);
        if self.deviatoric > 0.0 {
            energy += deviatoric(&self.material, &g) * self.deviatoric;
            let dilatation = jacobian(&g) - 1.0;
            energy += dilatation * dilatation * (0.5 * self.fluctuation_modulus * self.deviatoric);
        }
        if self.volumetric > 0.0 {
            let kappa = self.material.bulk_modulus - self.fluctuation_modulus;
            energy += if self.has_own_dilatation {
                (volumetric(self.material.volumetric, j) * kappa + p * (jacobian(&g) - 1.0 - j)) * self.volumetric
            } else {
                (p * (jacobian(&g) - 1.0) - p * p / (2.0 * kappa)) * self.volumetric
            };
        }
        energy
    }
}

#[derive(Clone, Debug)]
struct Element {
    // Displacements of the element's nodes, three each.
    dofs: Vec<usize>,
    // In local numbering: displacements first, then pressures.
    terms: Vec<Term<11, SaddlePoint>>,
}

/// The solid of a problem.
#[derive(Clone, Debug)]
pub struct SolidModel {
    num_dofs: usize,
    pressures_per_element: usize,
    elements: Vec<Element>,
}

impl SolidModel {
    /// Prepares all integration points.
    ///
    /// # Errors
    /// An element family that does not fit the formulation, an inverted element, or a law with an invariant that it does not have.
    pub fn new(problem: &Problem) -> Result<Self, ReferenceError> {
        let families = problem.mesh.families();
        let pressures_per_element = elements::num_pressures(problem.formulation);
        let mut shapes = Vec::new();
        for &found in &families {
            let wrong = ReferenceError::WrongElement { formulation: problem.formulation, found };
            // Beside elements of other families there are those whose faces fit.
            let fits = match families.len() {
                1 => problem.formulation.element_kind() == found,
                _ => Formulation::of_kind(found).is_some_and(|f| elements::num_pressures(f) == pressures_per_element),
            };
            let shape = ShapeFunctions::of_element(found).filter(|_| fits).ok_or(wrong)?;
            shapes.push((found, shape));
        }
        check_material("material", &problem.material)?;
        for Region { name, elements: _, material } in &problem.regions {
            check_material(name, material)?;
        }
        let (materials, material_of) = problem.materials();
        let has_own_dilatation = materials.iter().any(|material| material.volumetric != Volumetric::Quadratic);
        let fields = Fields { modes: pressures_per_element, has_own_dilatation };
        let elements = (0..problem.mesh.num_elements())
            .map(|e| {
                let kind = problem.mesh.kind_of(e);
                let shape = shapes.iter().find(|(known, _)| *known == kind).map(|(_, shape)| shape);
                let wrong = ReferenceError::WrongElement { formulation: problem.formulation, found: kind };
                build_element(problem, e, materials[usize::from(material_of[e])], shape.ok_or(wrong)?, fields)
            })
            .collect::<Result<_, _>>()?;
        Ok(Self { num_dofs: problem.num_dofs(), pressures_per_element: fields.number(), elements })
    }

    /// Number of displacements, three per node.
    pub fn num_dofs(&self) -> usize {
        self.num_dofs
    }

    /// Number of pressures: 1 per hex8 and tet10, 4 per hex20 and hex27; twice as many with the coefficients of j.
    pub fn num_pressures(&self) -> usize {
        self.pressures_per_element * self.elements.len()
    }

    /// Primal energy at displacements `u`, N·mm: Π at its stationary pressures.
    pub fn energy(&self, u: &[f64]) -> f64 {
        self.saddle_energy(u, &self.pressures(u))
    }

    /// Primal internal forces ∂energy/∂u, N; Q_k of theory §6.
    pub fn gradient(&self, u: &[f64]) -> DVector<f64> {
        self.saddle_gradient(u, &self.pressures(u)).rows(0, self.num_dofs).into_owned()
    }

    /// Primal tangent ∂²energy/∂u², N/mm.
    pub fn hessian(&self, u: &[f64]) -> DMatrix<f64> {
        self.condensed_hessian(u, &self.pressures(u))
    }

    /// Stationary pressures of every element, MPa, element by element: p = κ M⁻¹ θ; if j is a field, p = M⁻¹ Σ w ψ U′ followed
    /// by j = M⁻¹ θ.
    pub fn pressures(&self, u: &[f64]) -> Vec<f64> {
        (0..self.elements.len()).flat_map(|e| self.element_pressures(e, u)).collect()
    }

    /// Π(u, p), N·mm.
    pub fn saddle_energy(&self, u: &[f64], p: &[f64]) -> f64 {
        let values = self.elements.iter().enumerate().map(|(e, element)| {
            let x = self.local(e, u, self.own_pressures(e, p));
            element.terms.iter().map(|term| term.value(&x)).sum::<f64>()
        });
        values.sum()
    }

    /// ∂Π/∂(u, p): forces, N, followed by volume defects Σ w ψᵢ (J − 1 − p/κ), mm³.
    pub fn saddle_gradient(&self, u: &[f64], p: &[f64]) -> DVector<f64> {
        let mut gradient = DVector::zeros(self.num_dofs + self.num_pressures());
        for e in 0..self.elements.len() {
            let local = self.element_saddle_gradient(e, u, self.own_pressures(e, p));
            for (&dof, value) in self.global(e).iter().zip(local.iter()) {
                gradient[dof] += value;
            }
        }
        gradient
    }

    /// ∂²Π/∂(u, p)²: \[K B; Bᵀ −M/κ\].
    pub fn saddle_hessian(&self, u: &[f64], p: &[f64]) -> DMatrix<f64> {
        let size = self.num_dofs + self.num_pressures();
        let mut hessian = DMatrix::zeros(size, size);
        for e in 0..self.elements.len() {
            let local = self.element_saddle_hessian(e, u, self.own_pressures(e, p));
            scatter(&local, &self.global(e), &mut hessian);
        }
        hessian
    }

    /// K + κ B M⁻¹ Bᵀ at any pressures: the tangent of a Newton step on (u, p) after p is eliminated.
    pub fn condensed_hessian(&self, u: &[f64], p: &[f64]) -> DMatrix<f64> {
        let mut hessian = DMatrix::zeros(self.num_dofs, self.num_dofs);
        for e in 0..self.elements.len() {
            let local = self.element_condensed_hessian(e, u, self.own_pressures(e, p));
            scatter(&local, &self.elements[e].dofs, &mut hessian);
        }
        hessian
    }

    /// Stationary pressures of element `e`, MPa.
    pub fn element_pressures(&self, e: usize, u: &[f64]) -> Vec<f64> {
        let (split, number) = (self.elements[e].dofs.len(), self.pressures_per_element);
        let mut pressures = vec![0.0; number];
        // Π is quadratic in p: one Newton step from p = 0 is exact. With j, which enters ∂Π/∂p linearly, a first step finds j, a
        // second p.
        let has_own_dilatation = self.elements[e].terms.iter().any(|term| term.energy.has_own_dilatation);
        for _ in 0..if has_own_dilatation { 3 } else { 1 } {
            let defect = self.element_saddle_gradient(e, u, &pressures).rows(split, number).into_owned();
            let curvature = self.element_saddle_hessian(e, u, &pressures);
            let curvature = curvature.view((split, split), (number, number)).into_owned();
            let step = curvature.lu().solve(&-defect).expect("M is positive definite");
            pressures.iter_mut().zip(step.iter()).for_each(|(p, change)| *p += change);
        }
        pressures
    }

    /// Primal internal forces of element `e` at the displacements `u` of the whole mesh, N; three per node of the element.
    pub fn element_gradient(&self, e: usize, u: &[f64]) -> DVector<f64> {
        let gradient = self.element_saddle_gradient(e, u, &self.element_pressures(e, u));
        gradient.rows(0, self.elements[e].dofs.len()).into_owned()
    }

    /// Element `e`'s block of [`Self::condensed_hessian`]; `p` holds its own pressures only.
    pub fn element_condensed_hessian(&self, e: usize, u: &[f64], p: &[f64]) -> DMatrix<f64> {
        let (split, m) = (self.elements[e].dofs.len(), self.pressures_per_element);
        let full = self.element_saddle_hessian(e, u, p);
        let (k, b) = (full.view((0, 0), (split, split)), full.view((0, split), (split, m)).into_owned());
        let eliminated = full.view((split, split), (m, m)).into_owned().lu().solve(&b.transpose());
        k - b * eliminated.expect("M is positive definite")
    }

    /// Smallest J over all integration points; an equilibrium with J ≤ 0 somewhere is none.
    pub fn smallest_jacobian(&self, u: &[f64]) -> f64 {
        let zero = vec![0.0; self.num_pressures()];
        let mut smallest = f64::INFINITY;
        for (e, element) in self.elements.iter().enumerate() {
            let x = self.local(e, u, self.own_pressures(e, &zero));
            for term in &element.terms {
                smallest = smallest.min(jacobian(&gradient_from(term.map.apply(&x).as_slice())));
            }
        }
        smallest
    }

    fn element_saddle_gradient(&self, e: usize, u: &[f64], p: &[f64]) -> DVector<f64> {
        let x = self.local(e, u, p);
        let mut gradient = DVector::zeros(x.len());
        self.elements[e].terms.iter().for_each(|term| term.add_gradient(&x, 1.0, &mut gradient));
        gradient
    }

    fn element_saddle_hessian(&self, e: usize, u: &[f64], p: &[f64]) -> DMatrix<f64> {
        let x = self.local(e, u, p);
        let mut hessian = DMatrix::zeros(x.len(), x.len());
        self.elements[e].terms.iter().for_each(|term| term.add_hessian(&x, 1.0, &mut hessian));
        hessian
    }

    /// The element's displacements and pressures in local numbering.
    fn local(&self, e: usize, u: &[f64], p: &[f64]) -> Vec<f64> {
        self.elements[e].dofs.iter().map(|&dof| u[dof]).chain(p.iter().copied()).collect()
    }

    /// Where the element's displacements and pressures stand among all.
    fn global(&self, e: usize) -> Vec<usize> {
        let first = self.num_dofs + e * self.pressures_per_element;
        self.elements[e].dofs.iter().copied().chain(first..first + self.pressures_per_element).collect()
    }

    fn own_pressures<'a>(&self, e: usize, p: &'a [f64]) -> &'a [f64] {
        &p[e * self.pressures_per_element..(e + 1) * self.pressures_per_element]
    }
}

/// Fields of an element beside its displacements.
#[derive(Clone, Copy, Debug)]
struct Fields {
    /// Coefficients of the pressure.
    modes: usize,
    /// Whether j is there, too.
    has_own_dilatation: bool,
}

impl Fields {
    fn number(self) -> usize {
        if self.has_own_dilatation { 2 * self.modes } else { self.modes }
    }
}

fn scatter(local: &DMatrix<f64>, dofs: &[usize], global: &mut DMatrix<f64>) {
    for (j, &column) in dofs.iter().enumerate() {
        for (i, &row) in dofs.iter().enumerate() {
            global[(row, column)] += local[(i, j)];
        }
    }
}

fn build_element(
    problem: &Problem,
    e: usize,
    material: &Material,
    shape: &ShapeFunctions<3>,
    fields: Fields,
) -> Result<Element, ReferenceError> {
    let formulation = problem.formulation.beside(problem.mesh.kind_of(e));
    let nodes = problem.mesh.element(e);
    let positions: Vec<[f64; 3]> = nodes.iter().map(|&n| problem.mesh.nodes[n as usize]).collect();
    let geometry = |xi: &[f64; 3]| {
        let gradients = shape.gradients(xi);
        // ∂X/∂ξ
        let jacobian = Matrix3::from_fn(|i, j| positions.iter().zip(&gradients).map(|(x, g)| x[i] * g[j]).sum());
        (gradients, jacobian)
    };
    // Used by hex8-sri only, whose Jacobian determinant these points integrate exactly.
    let volume = || quadrature::tensor(2).iter().map(|(xi, w)| w * geometry(xi).1.determinant()).sum::<f64>();

    let mut terms = Vec::new();
    for (xi, weight, is_deviatoric, is_volumetric) in elements::rule(formulation) {
        let (gradients, jacobian) = geometry(&xi);
        let determinant = jacobian.determinant();
        let inverse = jacobian.try_inverse().filter(|_| determinant > 0.0);
        let inverse = inverse.ok_or(ReferenceError::InvertedElement { element: e, jacobian: determinant })?;
        // Gᵢⱼ = δᵢⱼ + Σₐ uₐᵢ ∂Nₐ/∂Xⱼ and p = Σ ψₖ pₖ.
        let mut matrix = DMatrix::zeros(11, 3 * nodes.len() + fields.number());
        for (a, gradient) in gradients.iter().enumerate() {
            for j in 0..3 {
                let slope: f64 = (0..3).map(|k| gradient[k] * inverse[(k, j)]).sum();
                for i in 0..3 {
                    matrix[(3 * i + j, 3 * a + i)] = slope;
                }
            }
        }
        let psi = [1.0, xi[0], xi[1], xi[2]];
        for (k, &value) in psi[..fields.modes].iter().enumerate() {
            matrix[(9, 3 * nodes.len() + k)] = value;
            if fields.has_own_dilatation {
                matrix[(10, 3 * nodes.len() + fields.modes + k)] = value;
            }
        }
        let offset = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0];
        let w = if formulation == Formulation::Hex8Sri && is_volumetric { volume() } else { weight * determinant };
        let energy = SaddlePoint {
            material: material.clone(),
            fluctuation_modulus: elements::fluctuation_modulus(formulation, material),
            has_own_dilatation: fields.has_own_dilatation,
            deviatoric: if is_deviatoric { w } else { 0.0 },
            volumetric: if is_volumetric { w } else { 0.0 },
        };
        terms.push(Term { energy, map: LinearMap { dofs: (0..matrix.ncols()).collect(), offset, matrix } });
    }
    let dofs = nodes.iter().flat_map(|&n| (0..3).map(move |axis| 3 * n as usize + axis)).collect();
    Ok(Element { dofs, terms })
}

#[cfg(test)]
mod tests;
