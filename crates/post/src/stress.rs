//! Cauchy stress at integration points, and its average at nodes for pictures.
//!
//! With the material's law W(F) of a change of shape and a volumetric pressure `p` from the element,
//!
//! ```text
//! σ = J⁻¹ ∂W/∂F Fᵀ + p 1
//! ```
//!
//! | formulation | volumetric pressure | volumetric energy |
//! |---|---|---|
//! | `hex8-sri` | κ (J_C − 1), J_C at the element's centre | ½ κ (J_C − 1)² V |
//! | `hex8-q1p0`, `tet10` | κ (J̄ − 1), J̄ = deformed / reference volume | ½ κ (J̄ − 1)² V |
//! | `hex20`, `hex27`, `tet15`, `wedge21` | Σ ψᵢ pᵢ, p = κ M⁻¹ θ, θᵢ = ∫ ψᵢ (J − 1) dV, Mᵢⱼ = ∫ ψᵢ ψⱼ dV, ψ = (1, ξ, η, ζ) | ½ κ θᵀ M⁻¹ θ |
//!
//! With another volumetric energy than κ/2 (J − 1)², p = M⁻¹ ∫ U′(J̄) ψ dV at J̄ = 1 + Σ ψᵢ (M⁻¹θ)ᵢ, with the energy
//! ∫ U(J̄) dV. On `tet10`, and with the full invariant on `hex20`, `hex27`, `tet15` and `wedge21`, a part κ_f of κ
//! ([`pneuflex_model::formulation::MixedFormulation::fluctuation_modulus`]) acts on J itself: the pressure is
//! κ (J̄ − 1) + κ_f (J − J̄), the energy has ½ κ_f ∫ (J − J̄)² dV more. (Theory §3.6, §10.) The stress is taken at the points of
//! the deviatoric rule, where the law is evaluated by the solver too.

use pneuflex_assembly::ReferenceElement;
use pneuflex_assembly::formulation::IntegrationPoint;
use pneuflex_assembly::law::ElementMaterial;
use pneuflex_laws::law_of;
use pneuflex_material::{Kinematics, cofactor, drucker, volumetric};
use pneuflex_mesh::mesh::determinant;
use pneuflex_mesh::{ElementKind, PerKind, ReferenceBody};
use pneuflex_model::{FittedTo, Invariant, Material, Mode, Problem, Volumetric};

use crate::error::{PostError, check};

/// A symmetric tensor in the order of VTK: xx, yy, zz, xy, yz, xz.
pub type SymmetricTensor = [f64; 6];

/// The state at one integration point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StressPoint {
    /// Reference position, mm.
    pub position: [f64; 3],
    /// Reference volume the point stands for, mm³.
    pub volume: f64,
    /// Cauchy stress, MPa.
    pub stress: SymmetricTensor,
    /// von Mises stress, MPa.
    pub von_mises: f64,
    /// The invariant the energy depends on, less its value 3 at rest: I₁ − 3 or Ī₁ − 3.
    pub invariant_minus_3: f64,
    /// Ī₁ − 3, whatever the energy depends on.
    pub isochoric_invariant_minus_3: f64,
    /// Whether more strain takes more stress there (Drucker's condition).
    pub is_stable: bool,
    /// The largest principal stretch, and the test whose deformation is most like that of the point.
    pub stretch: f64,
    /// See `stretch`.
    pub mode: Mode,
}

/// Stresses of a whole body in one state.
#[derive(Clone, Debug, PartialEq)]
pub struct StressField {
    /// Integration points, element by element.
    pub points: Vec<StressPoint>,
    /// Where the points of every element begin, and where the last one's end.
    starts: Vec<usize>,
    /// Strain energy of the body, N·mm = mJ.
    pub strain_energy: f64,
    /// Integration points of an element in reference coordinates, in the order of `points`.
    reference_points: PerKind<Vec<[f64; 3]>>,
}

/// An element's state at one tabulated point.
pub(crate) struct Local {
    pub(crate) kinematics: Kinematics,
    pub(crate) volume: f64,
}

/// The laws of a problem's materials in every kind of element.
pub(crate) fn laws(problem: &Problem) -> PerKind<Vec<ElementMaterial>> {
    let (materials, _) = problem.materials();
    problem.mesh.per_kind(|kind| {
        let formulation = problem.formulation.beside(kind);
        materials.iter().map(|material| ElementMaterial::new(material, formulation)).collect()
    })
}

/// Points and shape functions of every kind of element.
pub(crate) fn tables(problem: &Problem) -> PerKind<ReferenceElement> {
    problem.mesh.per_kind(|kind| ReferenceElement::new(problem.formulation.beside(kind)))
}

/// The value of I₁ − 3 (or Ī₁ − 3) beyond which the material has no stiffness left, so that stresses there mean nothing;
/// `None` if there is none, or if the law is none in the first invariant alone: others are checked by [`StressField::unstable`]. The paper's constants have C₃₀ < 0 and reach it at 54.83 (theory §9).
pub fn material_limit(material: &Material) -> Option<f64> {
    law_of(material).limit()
}

/// Stretches up to which a material is stable (Drucker's condition) in the tests in which it may give way.
pub fn stability_limits(material: &Material) -> Vec<(Mode, f64)> {
    if !material.law.may_give_way() {
        return Vec::new();
    }
    let law = law_of(material);
    let limit = |mode: Mode| drucker::stable_up_to(&*law, mode).map(|limit| (mode, limit));
    Mode::ALL.into_iter().filter_map(limit).collect()
}

/// von Mises stress of a symmetric tensor (theory §3).
pub fn von_mises([xx, yy, zz, xy, yz, xz]: SymmetricTensor) -> f64 {
    let normal = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
    (0.5 * normal + 3.0 * (xy * xy + yz * yz + xz * xz)).sqrt()
}

/// Cauchy stresses at all integration points, and the strain energy.
///
/// `displacement` has three entries per node, mm.
///
/// # Errors
/// A list of the wrong length or with a number that is not finite; an element turned inside out.
pub fn recover(problem: &Problem, displacement: &[[f64; 3]]) -> Result<StressField, PostError> {
    check("displacement", displacement.as_flattened(), problem.num_dofs())?;
    let mesh = &problem.mesh;
    let (materials, material_of) = problem.materials();
    let laws = laws(problem);
    let may_give_way: Vec<bool> = materials.iter().map(|material| material.law.may_give_way()).collect();
    let tables = tables(problem);

    let (mut points, mut starts) = (Vec::new(), vec![0]);
    let mut strain_energy = 0.0;
    for element in 0..mesh.num_elements() {
        let kind = mesh.kind_of(element);
        let table = &tables[kind];
        let (deviatoric, volumetric) = (&table.deviatoric, &table.volumetric);
        let modes_at = |point: &IntegrationPoint| -> [f64; 4] {
            std::array::from_fn(|i| if i < table.num_modes { point.modes[i] } else { 0.0 })
        };
        let at = |index: usize, point: &IntegrationPoint| local(problem, displacement, element, index, point);
        let states = deviatoric.iter().enumerate().map(|(i, p)| at(i, p)).collect::<Result<Vec<_>, _>>()?;
        let volume = volumetric.iter().enumerate().map(|(i, p)| at(i, p)).collect::<Result<Vec<_>, _>>()?;
        let number = usize::from(material_of[element]);
        let (material, model) = (&materials[number], &laws[kind][number]);
        let whole: f64 = states.iter().map(|s| s.volume).sum();
        let volume_of = |state: &Local| if table.is_centre_only { whole } else { state.volume };
        let rule: Vec<([f64; 4], f64, f64)> = volumetric
            .iter()
            .zip(&volume)
            .map(|(point, state)| (modes_at(point), volume_of(state), state.kinematics.jacobian_minus_1))
            .collect();
        let (pressure, volumetric_energy) = volumetric_pressure(&rule, model);
        strain_energy += volumetric_energy;
        for (point, state) in deviatoric.iter().zip(&states) {
            let excess = state.kinematics.jacobian_minus_1;
            let p = modes_at(point).iter().zip(&pressure).map(|(psi, p)| psi * p).sum::<f64>()
                + model.fluctuation_modulus * excess;
            strain_energy += 0.5 * model.fluctuation_modulus * excess * excess * state.volume;
            let s = model.law.cauchy_stress(&state.kinematics);
            let stress = [s[0][0] + p, s[1][1] + p, s[2][2] + p, s[0][1], s[1][2], s[0][2]];
            let mut position = [0.0; 3];
            for (value, &node) in point.values.iter().zip(mesh.element(element)) {
                for d in 0..3 {
                    position[d] += value * mesh.nodes[node as usize][d];
                }
            }
            strain_energy += model.law.energy_and_stress(&state.kinematics).0 * state.volume;
            let isochoric = (state.kinematics.i1_minus_3 + 3.0) * state.kinematics.jacobian.powf(-2.0 / 3.0) - 3.0;
            let invariant_minus_3 = match material.invariant {
                Invariant::Full => state.kinematics.i1_minus_3,
                Invariant::Isochoric => isochoric,
            };
            let von_mises = von_mises(stress);
            let stretches = state.kinematics.principal_stretches();
            let is_stable = !may_give_way[number] || drucker::is_stable(&*model.law, stretches);
            points.push(StressPoint {
                position,
                volume: state.volume,
                stress,
                von_mises,
                invariant_minus_3,
                is_stable,
                stretch: stretches.into_iter().fold(0.0, f64::max),
                mode: Mode::nearest(stretches),
                isochoric_invariant_minus_3: isochoric,
            });
        }
        starts.push(points.len());
    }
    if !strain_energy.is_finite() || !points.iter().all(|p| p.von_mises.is_finite()) {
        return Err(PostError::NotFinite { what: "the stress".into() });
    }
    let reference_points = mesh.per_kind(|kind| tables[kind].deviatoric.iter().map(|p| p.xi).collect());
    Ok(StressField { points, starts, strain_energy, reference_points })
}

/// The state at a point of an element, the integration point of number `index`.
pub(crate) fn local(
    problem: &Problem,
    displacement: &[[f64; 3]],
    element: usize,
    index: usize,
    point: &IntegrationPoint,
) -> Result<Local, PostError> {
    let mesh = &problem.mesh;
    let jacobian = mesh.jacobian(element, &point.gradients);
    let determinant = determinant(&jacobian);
    // ∂u/∂X = (∂u/∂ξ) (∂X/∂ξ)⁻¹, and the inverse is the transposed cofactor over the determinant.
    let cofactor = cofactor(&jacobian);
    let mut by_xi = [[0.0; 3]; 3];
    for (&node, gradient) in mesh.element(element).iter().zip(&point.gradients) {
        let u = displacement[node as usize];
        for i in 0..3 {
            for j in 0..3 {
                by_xi[i][j] += u[i] * gradient[j];
            }
        }
    }
    let gradient = std::array::from_fn(|i| {
        std::array::from_fn(|j| (0..3).map(|k| by_xi[i][k] * cofactor[j][k]).sum::<f64>() / determinant)
    });
    let kinematics =
        Kinematics::new(&gradient).map_err(|e| PostError::Inverted { element, point: index, jacobian: e.0 })?;
    Ok(Local { kinematics, volume: point.weight * determinant })
}

/// Coefficients of the pressure M⁻¹ ∫ U′(J̄) ψ dV and the energy ∫ U(J̄) dV, from modes, volume and J − 1 at the volumetric points.
fn volumetric_pressure(rule: &[([f64; 4], f64, f64)], material: &ElementMaterial) -> ([f64; 4], f64) {
    let kappa = material.bulk_modulus;
    let (mut mass, mut theta) = ([[0.0; 4]; 4], [0.0; 4]);
    for (psi, volume, excess) in rule {
        for i in 0..4 {
            theta[i] += psi[i] * excess * volume;
            for j in 0..4 {
                mass[i][j] += psi[i] * psi[j] * volume;
            }
        }
    }
    // Modes that the formulation does not have are decoupled.
    for i in 0..4 {
        if mass[i][i] == 0.0 {
            mass[i][i] = 1.0;
        }
    }
    let strain = solve_positive_definite(mass, theta);
    if material.volumetric == Volumetric::Quadratic {
        let energy = 0.5 * kappa * (0..4).map(|i| theta[i] * strain[i]).sum::<f64>();
        return (strain.map(|s| kappa * s), energy);
    }
    let (mut slope, mut energy) = ([0.0; 4], 0.0);
    for (psi, volume, _) in rule {
        let excess = psi.iter().zip(&strain).map(|(psi, s)| psi * s).sum();
        let [u, du, _] = volumetric::evaluate(material.volumetric, excess);
        energy += kappa * u * volume;
        (0..4).for_each(|i| slope[i] += kappa * du * psi[i] * volume);
    }
    (solve_positive_definite(mass, slope), energy)
}

/// Gaussian elimination without pivoting, which a positive definite matrix does not need.
pub(crate) fn solve_positive_definite<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N]) -> [f64; N] {
    for k in 0..N {
        for i in k + 1..N {
            let factor = a[i][k] / a[k][k];
            for j in k..N {
                a[i][j] -= factor * a[k][j];
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..N).rev() {
        let known: f64 = (k + 1..N).map(|j| a[k][j] * b[j]).sum();
        b[k] = (b[k] - known) / a[k][k];
    }
    b
}

impl StressField {
    /// Integration points of one element.
    ///
    /// # Panics
    /// If there is no such element.
    pub fn element(&self, element: usize) -> &[StressPoint] {
        &self.points[self.starts[element]..self.starts[element + 1]]
    }

    /// The points of every element in order.
    fn by_element(&self) -> impl Iterator<Item = &[StressPoint]> {
        self.starts.windows(2).map(|ends| &self.points[ends[0]..ends[1]])
    }

    /// The integration point with the largest von Mises stress; `None` for a body without elements.
    ///
    /// The largest value has no limit under refinement at the actuator's re-entrant edges (theory §3.8): read it
    /// together with [`StressField::von_mises_quantile`] and the position.
    pub fn largest_von_mises(&self) -> Option<&StressPoint> {
        first_largest(self.points.iter(), |point| point.von_mises)
    }

    /// Integration points at which their material has no stiffness left ([`material_limit`]): element, point and limit.
    pub fn beyond_limit<'a>(&'a self, problem: &Problem) -> Vec<(usize, &'a StressPoint, f64)> {
        let (materials, material_of) = problem.materials();
        let limits: Vec<Option<f64>> = materials.into_iter().map(material_limit).collect();
        let in_element = |(element, points): (usize, &'a [StressPoint])| {
            let limit = limits[usize::from(material_of[element])].unwrap_or(f64::INFINITY);
            let beyond = move |point: &&StressPoint| point.invariant_minus_3 > limit;
            points.iter().filter(beyond).map(move |point| (element, point, limit))
        };
        self.by_element().enumerate().flat_map(in_element).collect()
    }

    /// Integration points at which more strain takes less stress: element and point.
    pub fn unstable<'a>(&'a self) -> Vec<(usize, &'a StressPoint)> {
        let in_element =
            |(element, points): (usize, &'a [StressPoint])| points.iter().map(move |point| (element, point));
        self.by_element().enumerate().flat_map(in_element).filter(|(_, point)| !point.is_stable).collect()
    }

    /// Integration points that are stretched further than the tests which their constants were fitted to, by the test that they are most like:
    /// point and tests.
    pub fn beyond_fit<'a>(&'a self, problem: &Problem) -> Vec<(&'a StressPoint, FittedTo)> {
        let (materials, material_of) = problem.materials();
        let fitted_to = |element: usize| materials[usize::from(material_of[element])].fitted_to;
        let is_beyond = |point: &StressPoint, tests: &FittedTo| {
            point.isochoric_invariant_minus_3 > tests.invariant_minus_3(point.mode)
        };
        let in_element =
            |(element, points): (usize, &'a [StressPoint])| points.iter().map(move |point| (element, point));
        let points = self.by_element().enumerate().flat_map(in_element);
        points
            .filter_map(|(element, point)| Some((point, fitted_to(element).filter(|tests| is_beyond(point, tests))?)))
            .collect()
    }

    /// Largest I₁ − 3 (or Ī₁ − 3) at an integration point; 0 for a body without elements.
    pub fn largest_invariant_minus_3(&self) -> f64 {
        self.points.iter().map(|p| p.invariant_minus_3).max_by(f64::total_cmp).unwrap_or(0.0)
    }

    /// The von Mises stress, MPa, that is not exceeded in the share `fraction` of the reference volume (0 … 1).
    pub fn von_mises_quantile(&self, fraction: f64) -> f64 {
        let mut sorted: Vec<(f64, f64)> = self.points.iter().map(|p| (p.von_mises, p.volume)).collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let target = fraction * sorted.iter().map(|s| s.1).sum::<f64>();
        let mut volume = 0.0;
        for (value, v) in &sorted {
            volume += v;
            if volume >= target {
                return *value;
            }
        }
        sorted.last().map_or(0.0, |s| s.0)
    }

    /// Hydrostatic pressure −tr σ / 3 of every element, MPa, averaged over its reference volume; compression is positive.
    pub fn element_pressures(&self) -> Vec<f64> {
        self.by_element()
            .map(|points| {
                let volume: f64 = points.iter().map(|p| p.volume).sum();
                let sum: f64 = points.iter().map(|p| p.volume * (p.stress[0] + p.stress[1] + p.stress[2])).sum();
                -sum / (3.0 * volume)
            })
            .collect()
    }

    /// Cauchy stress at every node, MPa: the trilinear field fitted to an element's integration points by least squares
    /// (through them for the 2×2×2 rule), on tetrahedra the linear field (through the four points of `tet10`), on wedges the linear field of a triangle times
    /// that of a line, evaluated at the element's nodes and averaged over the elements at a node with
    /// their reference volumes as weights. For pictures: at interfaces and re-entrant edges it smooths.
    pub fn at_nodes(&self, problem: &Problem) -> Vec<SymmetricTensor> {
        let mesh = &problem.mesh;
        let extrapolation = mesh.per_kind(|kind| extrapolation(kind, &self.reference_points[kind]));
        let mut sum = vec![[0.0; 6]; mesh.num_nodes()];
        let mut weight = vec![0.0; mesh.num_nodes()];
        for element in 0..mesh.num_elements() {
            let points = self.element(element);
            let volume: f64 = points.iter().map(|p| p.volume).sum();
            for (row, &node) in extrapolation[mesh.kind_of(element)].iter().zip(mesh.element(element)) {
                weight[node as usize] += volume;
                for c in 0..6 {
                    let value: f64 = row.iter().zip(points).map(|(m, p)| m * p.stress[c]).sum();
                    sum[node as usize][c] += volume * value;
                }
            }
        }
        sum.iter().zip(&weight).map(|(s, &w)| s.map(|x| if w > 0.0 { x / w } else { 0.0 })).collect()
    }
}

/// Values at the nodes of an element from values at its integration points, one row per node.
fn extrapolation(kind: ElementKind, points: &[[f64; 3]]) -> Vec<Vec<f64>> {
    match kind.body {
        ReferenceBody::Hexahedron => extrapolation_on_hexahedron(kind, points),
        ReferenceBody::Tetrahedron => extrapolation_on_tetrahedron(kind, points),
        ReferenceBody::Wedge => extrapolation_on_wedge(kind, points),
    }
}

/// The eight monomials of the trilinear field are orthogonal over points symmetric about the coordinate planes, so each coefficient of the
/// fit is a plain projection.
fn extrapolation_on_hexahedron(kind: ElementKind, points: &[[f64; 3]]) -> Vec<Vec<f64>> {
    let squares: [f64; 8] = std::array::from_fn(|k| points.iter().map(|xi| monomials(*xi)[k].powi(2)).sum());
    kind.nodes
        .iter()
        .map(|node| {
            let there = monomials(*node);
            points
                .iter()
                .map(|xi| {
                    let here = monomials(*xi);
                    (0..8).map(|k| there[k] * here[k] / squares[k]).sum()
                })
                .collect()
        })
        .collect()
}

/// The rules know no first corner: with barycentric coordinates λ and δᵢ = λᵢ − 1/4, Σ δᵢ δⱼ over the n points is s (δᵢⱼ − 1/4), so that the
/// weight of a point p in the linear field fitted by least squares is 1/n + Σᵢ δᵢ δᵢ(p) / s.
fn extrapolation_on_tetrahedron(kind: ElementKind, points: &[[f64; 3]]) -> Vec<Vec<f64>> {
    let offsets = |[x, y, z]: [f64; 3]| [1.0 - x - y - z, x, y, z].map(|l| l - 0.25);
    let points: Vec<[f64; 4]> = points.iter().map(|&point| offsets(point)).collect();
    let sum = points.iter().map(|p| p[0] * p[0]).sum::<f64>() / 0.75;
    let weight = |node: &[f64; 4], p: &[f64; 4]| {
        1.0 / points.len() as f64 + node.iter().zip(p).map(|(a, b)| a * b).sum::<f64>() / sum
    };
    kind.nodes.iter().map(|&node| points.iter().map(|p| weight(&offsets(node), p)).collect()).collect()
}

/// The same on the triangle, δᵢ = λᵢ − 1/3 and Σ δᵢ δⱼ = s (δᵢⱼ − 1/3), times the line: 1/n (1 + n Σᵢ δᵢ δᵢ(p) / s) (1 + n ζ ζ(p) / Σ ζ²).
fn extrapolation_on_wedge(kind: ElementKind, points: &[[f64; 3]]) -> Vec<Vec<f64>> {
    let count = points.len() as f64;
    let offsets = |[x, y, _]: [f64; 3]| [1.0 - x - y, x, y].map(|l| l - 1.0 / 3.0);
    let sum = 1.5 * points.iter().map(|&p| offsets(p)[0].powi(2)).sum::<f64>();
    let squares: f64 = points.iter().map(|p| p[2] * p[2]).sum();
    let weight = |node: [f64; 3], p: [f64; 3]| {
        let product: f64 = offsets(node).iter().zip(offsets(p)).map(|(a, b)| a * b).sum();
        (1.0 + count * product / sum) * (1.0 + count * node[2] * p[2] / squares) / count
    };
    kind.nodes.iter().map(|&node| points.iter().map(|&p| weight(node, p)).collect()).collect()
}

fn monomials([x, y, z]: [f64; 3]) -> [f64; 8] {
    [1.0, x, y, z, x * y, y * z, x * z, x * y * z]
}

/// The first of those whose value is the largest: within rounding, since a symmetric body has its largest stress twice, and the last digit
/// must not choose between the two.
pub fn first_largest<T>(things: impl Iterator<Item = T> + Clone, value: impl Fn(&T) -> f64) -> Option<T> {
    const ROUNDING: f64 = 1e-9;
    let largest = things.clone().map(|thing| value(&thing)).max_by(f64::total_cmp)?;
    let least = largest - ROUNDING * largest.abs();
    things.into_iter().find(|thing| value(thing).total_cmp(&least).is_ge())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{displacement_of, two_chambers, with_formulation};
    use pneuflex_model::{Formulation, Law};

    fn materials() -> Vec<Material> {
        let mut materials = pneuflex_laws::samples();
        let logarithmic = materials.iter().take(1).cloned();
        let logarithmic = logarithmic.map(|material| Material { volumetric: Volumetric::Logarithmic, ..material });
        materials.extend(logarithmic.collect::<Vec<_>>());
        materials
    }

    /// An affine map: every formulation has the same homogeneous stress and energy.
    #[test]
    fn an_affine_map_has_the_homogeneous_stress_and_energy() {
        let h = [[0.2, 0.1, 0.0], [-0.05, -0.1, 0.08], [0.03, 0.0, -0.07]];
        for material in materials() {
            for formulation in Formulation::ALL {
                let mut problem = with_formulation(3.0, formulation);
                problem.material = material.clone();
                let u = displacement_of(&problem, |x| std::array::from_fn(|i| (0..3).map(|j| h[i][j] * x[j]).sum()));
                let field = recover(&problem, &u).unwrap();
                let k = Kinematics::new(&h).unwrap();
                let law = law_of(&material);
                let mut exact = law.cauchy_stress(&k);
                // The fluctuations of J have the quadratic energy in any case.
                let fluctuation_modulus = formulation.fluctuation_modulus(&material);
                let [u, du, _] = volumetric::evaluate(material.volumetric, k.jacobian_minus_1)
                    .map(|u| u * (material.bulk_modulus - fluctuation_modulus));
                let p = du + fluctuation_modulus * k.jacobian_minus_1;
                let volumetric_energy = u + 0.5 * fluctuation_modulus * k.jacobian_minus_1.powi(2);
                (0..3).for_each(|i| exact[i][i] += p);
                let exact = [exact[0][0], exact[1][1], exact[2][2], exact[0][1], exact[1][2], exact[0][2]];
                let nodal = field.at_nodes(&problem);
                for stress in field.points.iter().map(|p| &p.stress).chain(&nodal) {
                    for c in 0..6 {
                        assert!((stress[c] - exact[c]).abs() < 1e-8 * p.abs(), "{formulation:?} {c}: {stress:?}");
                    }
                }
                let energy = (law.energy_and_stress(&k).0 + volumetric_energy) * 1268.0;
                assert!((field.strain_energy - energy).abs() < 1e-9 * energy, "{formulation:?}");
                assert!((field.element_pressures()[0] + (exact[0] + exact[1] + exact[2]) / 3.0).abs() < 1e-8 * p.abs());
                assert!((field.points.iter().map(|p| p.volume).sum::<f64>() - 1268.0).abs() < 1e-8);
            }
        }
    }

    /// The energy's derivative along a displacement is the work of the stress: Σ V J σ : grad(δu) in a state in which
    /// the volumetric pressure varies, which ties each formulation's pressure to its energy.
    /// Uniaxial Mooney-Rivlin: C₁₀/λ + C₀₁ λ = 0 at the stretch 2.
    #[test]
    fn points_at_which_more_strain_takes_less_stress_are_found() {
        let mut problem = with_formulation(3.0, Formulation::Hex27);
        problem.material = Law::Polynomial { c10: 0.4, c01: -0.1, c20: 0.0, c11: 0.0, c02: 0.0 }.into();
        let unstable = |stretch: f64| {
            let across = 1.0 / stretch.sqrt() - 1.0;
            let u = displacement_of(&problem, |[x, y, z]| [(stretch - 1.0) * x, across * y, across * z]);
            let field = recover(&problem, &u).unwrap();
            (field.unstable().len(), field.points.len())
        };
        let ((few, _), (many, all)) = (unstable(1.99), unstable(2.01));
        assert_eq!((few, many), (0, all));
    }

    #[test]
    fn stress_is_the_derivative_of_the_energy_where_the_volume_change_is_uniform() {
        for formulation in Formulation::ALL {
            let problem = with_formulation(3.0, formulation);
            let state = |t: f64| {
                displacement_of(&problem, |x| {
                    [0.1 * x[2] + t * 0.01 * x[0], 0.02 * x[0], -0.1 * x[0] + t * 0.02 * x[2]]
                })
            };
            let step = 1e-5;
            let energy = |t: f64| recover(&problem, &state(t)).unwrap().strain_energy;
            let slope = (energy(step) - energy(-step)) / (2.0 * step);
            let field = recover(&problem, &state(0.0)).unwrap();
            let f = [[1.0, 0.0, 0.1], [0.02, 1.0, 0.0], [-0.1, 0.0, 1.0]];
            let (j, cofactor) = (determinant(&f), pneuflex_material::cofactor(&f));
            // grad(δu) = δF F⁻¹ with δF = diag(0.01, 0, 0.02).
            let rate = |i: usize, k: usize| [0.01, 0.0, 0.02][i] * cofactor[k][i] / j;
            let work: f64 = field
                .points
                .iter()
                .map(|p| {
                    let s = p.stress;
                    let full = [[s[0], s[3], s[5]], [s[3], s[1], s[4]], [s[5], s[4], s[2]]];
                    let power: f64 =
                        (0..3).flat_map(|i| (0..3).map(move |k| (i, k))).map(|(i, k)| full[i][k] * rate(i, k)).sum();
                    p.volume * j * power
                })
                .sum();
            assert!(work.abs() > 1.0, "the check would be empty");
            assert!((work - slope).abs() < 1e-6 * work.abs(), "{formulation:?}: {work} against {slope}");
        }
    }

    #[test]
    fn extrapolation_reproduces_the_fields_that_are_fitted() {
        for formulation in Formulation::ALL {
            let problem = with_formulation(3.0, formulation);
            let field = recover(&problem, &vec![[0.0; 3]; problem.mesh.num_nodes()]).unwrap();
            let kind = formulation.element;
            let [bilinear, trilinear] = match kind.body {
                ReferenceBody::Hexahedron => [-2.0, 0.5],
                ReferenceBody::Wedge => [-2.0, 0.0],
                ReferenceBody::Tetrahedron => [0.0; 2],
            };
            let function =
                |x: [f64; 3]| 1.0 + x[0] - 2.0 * x[2] + bilinear * x[1] * x[2] + trilinear * x[0] * x[1] * x[2];
            let points = &field.reference_points[kind];
            let values: Vec<f64> = points.iter().map(|&xi| function(xi)).collect();
            for (row, node) in extrapolation(kind, points).iter().zip(kind.nodes) {
                let value: f64 = row.iter().zip(&values).map(|(m, v)| m * v).sum();
                assert!((value - function(*node)).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn von_mises_of_simple_states() {
        assert_eq!(von_mises([3.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 3.0);
        assert!((von_mises([0.0, 0.0, 0.0, 0.0, 2.0, 0.0]) - 2.0 * 3.0_f64.sqrt()).abs() < 1e-15);
        assert_eq!(von_mises([7.0, 7.0, 7.0, 0.0, 0.0, 0.0]), 0.0);
    }

    #[test]
    fn quantile_is_weighted_by_volume() {
        let point = |von_mises, volume| StressPoint {
            position: [0.0; 3],
            volume,
            stress: [0.0; 6],
            von_mises,
            invariant_minus_3: 0.0,
            is_stable: true,
            stretch: 1.0,
            mode: Mode::Planar,
            isochoric_invariant_minus_3: 0.0,
        };
        let field = StressField {
            points: vec![point(5.0, 1.0), point(1.0, 98.0), point(9.0, 1.0)],
            starts: vec![0, 1, 2, 3],
            strain_energy: 0.0,
            reference_points: PerKind::new(&[], |_| Vec::new()),
        };
        assert_eq!((field.von_mises_quantile(0.5), field.von_mises_quantile(0.99)), (1.0, 5.0));
        assert_eq!((field.von_mises_quantile(1.0), field.largest_von_mises().unwrap().von_mises), (9.0, 9.0));
        let first = |values: &[f64]| first_largest(values.iter().enumerate(), |(_, value)| **value).map(|(i, _)| i);
        assert_eq!(
            (first(&[1.0, 3.0, 3.0 + 1e-12]), first(&[1.0, 3.0, 3.0 + 1e-6]), first(&[])),
            (Some(1), Some(2), None)
        );
        assert_eq!(first(&[-2.0, -1.0, -1.0]), Some(1));
    }

    #[test]
    fn bad_states_are_errors() {
        let problem = two_chambers(3.0);
        let mut u = vec![[0.0; 3]; problem.mesh.num_nodes()];
        assert!(matches!(recover(&problem, &u[1..]), Err(PostError::WrongLength { .. })));
        u[1][1] = f64::NAN;
        assert!(matches!(recover(&problem, &u), Err(PostError::NotFinite { .. })));
        u[1][1] = 500.0;
        assert!(matches!(recover(&problem, &u), Err(PostError::Inverted { .. })));
    }
}
