//! Smooth measures of the largest stress and the largest stretch.
//!
//! A largest value is now at one place and now at another, and a quantile is the value of one point or of the next one: neither has a derivative.
//! With the values xᵢ ≥ 0 at integration points that stand for the volumes Vᵢ at rest, V in all,
//!
//! ```text
//! norm      x̄ = (Σ Vᵢ xᵢᵖ / V)^(1/p)                              (Duysinx & Sigmund 1998; Le et al. 2010)
//! quantile  Σ Vᵢ s((1 − xᵢ/q)/ε) = f V,  s(t) = 1/(1 + e⁻ᵗ)
//! ```
//!
//! Of the stretch it is what exceeds 1 that is measured. The slope of the von Mises stress by F, with N = 3/2 dev σ / σ_v, is
//! −σ_v F⁻ᵀ + J⁻¹ (A:(N F) + N P), as N:σ = σ_v and pressures do not enter; that of the largest principal stretch λ with its direction n at rest is
//! F n ⊗ n / λ. Where two stretches are largest together, this has a corner.

use pneuflex_assembly::formulation::IntegrationPoint;
use pneuflex_assembly::law::ElementMaterial;
use pneuflex_material::{Kinematics, Tensor, cofactor};
use pneuflex_mesh::mesh::determinant;
use pneuflex_mesh::vector::{cross, norm};
use pneuflex_model::Problem;

use crate::error::{PostError, check};
use crate::stress::{laws, local, tables, von_mises};

/// ε: the width in which a quantile is smoothed, as a share of it.
pub const SMOOTHING: f64 = 0.05;

/// Corrections of a quantile at the most; halving the bracket alone takes fewer.
const MOST_CORRECTIONS: usize = 200;

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    /// von Mises stress, MPa.
    VonMises,
    /// Largest principal stretch.
    Stretch,
}

/// How the values at all points become one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// The norm with the exponent p ≥ 1, which comes from below as near to the largest value as p is large.
    Norm(f64),
    /// The value that is not exceeded in the share f of the volume, smoothed.
    Quantile(f64),
}

/// A smooth measure of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// The field.
    pub field: Field,
    /// The measure.
    pub measure: Measure,
}

/// The field at an integration point.
struct Sample {
    /// What of it is measured: the stress, or the stretch less 1.
    value: f64,
    volume: f64,
    /// Its slope by F.
    by_gradient: Tensor,
}

impl Peak {
    /// Its value, MPa or without a unit. `displacement` has one entry per node, mm.
    ///
    /// # Errors
    /// A list of the wrong length or with a number that is not finite; an element turned inside out.
    pub fn value(self, problem: &Problem, displacement: &[[f64; 3]]) -> Result<f64, PostError> {
        let mut samples = Vec::new();
        self.visit(problem, displacement, |_, _, sample| samples.push([sample.value, sample.volume]))?;
        Ok(self.at_rest() + self.measure.of(&samples))
    }

    /// Its value at rest.
    pub fn at_rest(self) -> f64 {
        if self.field == Field::Stretch { 1.0 } else { 0.0 }
    }

    /// Its slope by the displacements, one entry per node; zero at rest, where it has a corner.
    ///
    /// # Errors
    /// As [`Self::value`].
    pub fn gradient(self, problem: &Problem, displacement: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, PostError> {
        let mut samples = Vec::new();
        self.visit(problem, displacement, |_, _, sample| samples.push([sample.value, sample.volume]))?;
        let mut slopes = self.measure.slopes(&samples).into_iter();
        let mut gradient = vec![[0.0; 3]; displacement.len()];
        let mesh = &problem.mesh;
        self.visit(problem, displacement, |element, point, sample| {
            let slope = slopes.next().unwrap_or_default();
            // ∂N/∂X = (∂N/∂ξ) (∂X/∂ξ)⁻¹, and the inverse is the transposed cofactor over the determinant.
            let jacobian = mesh.jacobian(element, &point.gradients);
            let (determinant, cofactor) = (determinant(&jacobian), cofactor(&jacobian));
            for (&node, by_xi) in mesh.element(element).iter().zip(&point.gradients) {
                let by_position: [f64; 3] =
                    std::array::from_fn(|j| (0..3).map(|k| by_xi[k] * cofactor[j][k]).sum::<f64>() / determinant);
                for (entry, row) in gradient[node as usize].iter_mut().zip(&sample.by_gradient) {
                    *entry += slope * (0..3).map(|j| row[j] * by_position[j]).sum::<f64>();
                }
            }
        })?;
        Ok(gradient)
    }

    /// Visits the integration points in their order.
    fn visit(
        self,
        problem: &Problem,
        displacement: &[[f64; 3]],
        mut visitor: impl FnMut(usize, &IntegrationPoint, &Sample),
    ) -> Result<(), PostError> {
        check("displacement", displacement.as_flattened(), problem.num_dofs())?;
        let (_, material_of) = problem.materials();
        let (laws, tables) = (laws(problem), tables(problem));
        for element in 0..problem.mesh.num_elements() {
            let kind = problem.mesh.kind_of(element);
            let law = &laws[kind][usize::from(material_of[element])];
            for (index, point) in tables[kind].deviatoric.iter().enumerate() {
                let state = local(problem, displacement, element, index, point)?;
                let (value, by_gradient) = match self.field {
                    Field::VonMises => stress(law, &state.kinematics),
                    Field::Stretch => stretch(&state.kinematics),
                };
                visitor(element, point, &Sample { value, volume: state.volume, by_gradient });
            }
        }
        Ok(())
    }
}

impl Measure {
    /// That of values with their volumes.
    fn of(self, samples: &[[f64; 2]]) -> f64 {
        let most = samples.iter().fold(0.0_f64, |most, [value, _]| most.max(*value));
        if most == 0.0 {
            return 0.0;
        }
        let volume: f64 = samples.iter().map(|[_, volume]| volume).sum();
        match self {
            Self::Norm(p) => {
                let sum: f64 = samples.iter().map(|[value, volume]| volume * (value / most).powf(p)).sum();
                most * (sum / volume).powf(1.0 / p)
            }
            Self::Quantile(share) => quantile(samples, share * volume, most),
        }
    }

    /// Its slopes by the values.
    fn slopes(self, samples: &[[f64; 2]]) -> Vec<f64> {
        let own = self.of(samples);
        if own == 0.0 {
            return vec![0.0; samples.len()];
        }
        match self {
            Self::Norm(p) => {
                let volume: f64 = samples.iter().map(|[_, volume]| volume).sum();
                samples.iter().map(|[value, own_volume]| own_volume / volume * (value / own).powf(p - 1.0)).collect()
            }
            Self::Quantile(_) => {
                let densities: Vec<f64> = samples.iter().map(|[value, volume]| volume * density(*value, own)).collect();
                let sum: f64 = samples.iter().zip(&densities).map(|([value, _], density)| density * value / own).sum();
                densities.into_iter().map(|density| density / sum).collect()
            }
        }
    }
}

/// s((1 − x/q)/ε).
fn share_below(value: f64, quantile: f64) -> f64 {
    1.0 / (1.0 + (-(1.0 - value / quantile) / SMOOTHING).exp())
}

/// Its s′.
fn density(value: f64, quantile: f64) -> f64 {
    let share = share_below(value, quantile);
    share * (1.0 - share)
}

/// The q with Σ Vᵢ s((1 − xᵢ/q)/ε) = `wanted`, by Newton's method within a bracket that shrinks.
fn quantile(samples: &[[f64; 2]], wanted: f64, most: f64) -> f64 {
    let [mut low, mut high] = [0.0, 4.0 * most];
    let mut at = most;
    for _ in 0..MOST_CORRECTIONS {
        let (mut excess, mut slope) = (-wanted, 0.0);
        for [value, volume] in samples {
            let share = share_below(*value, at);
            excess += volume * share;
            slope += volume * share * (1.0 - share) * value / (SMOOTHING * at * at);
        }
        if excess < 0.0 {
            low = at
        } else {
            high = at
        }
        let next = at - excess / slope;
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        if (next - at).abs() <= 4.0 * f64::EPSILON * at {
            return next;
        }
        at = next;
    }
    at
}

/// The von Mises stress, MPa, and its slope by F.
fn stress(law: &ElementMaterial, kinematics: &Kinematics) -> (f64, Tensor) {
    let (f, jacobian) = (&kinematics.gradient, kinematics.jacobian);
    let response = law.law.respond(kinematics);
    let p = &response.stress;
    let s: Tensor =
        std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| p[i][k] * f[j][k]).sum::<f64>() / jacobian));
    let value = von_mises([s[0][0], s[1][1], s[2][2], s[0][1], s[1][2], s[0][2]]);
    if value == 0.0 {
        return (0.0, [[0.0; 3]; 3]);
    }
    let mean = (s[0][0] + s[1][1] + s[2][2]) / 3.0;
    let normal: Tensor =
        std::array::from_fn(|i| std::array::from_fn(|j| 1.5 * (s[i][j] - if i == j { mean } else { 0.0 }) / value));
    let times = |b: &Tensor| -> Tensor {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| normal[i][k] * b[k][j]).sum()))
    };
    let (along, turned) = (times(f), times(p));
    let slope = |i: usize, j: usize| {
        let row = &response.tangent[3 * i + j];
        let of_tangent: f64 = row.iter().zip(along.as_flattened()).map(|(a, b)| a * b).sum();
        (of_tangent + turned[i][j] - value * kinematics.cofactor[i][j]) / jacobian
    };
    (value, std::array::from_fn(|i| std::array::from_fn(|j| slope(i, j))))
}

/// What the largest principal stretch exceeds 1 by, not less than nothing, and its slope by F.
fn stretch(kinematics: &Kinematics) -> (f64, Tensor) {
    let largest = kinematics.principal_stretches().into_iter().fold(0.0, f64::max);
    if largest <= 1.0 {
        return (0.0, [[0.0; 3]; 3]);
    }
    let direction = direction(&kinematics.right_cauchy_green_minus_1(), largest * largest - 1.0);
    let f = &kinematics.gradient;
    let turned: [f64; 3] = std::array::from_fn(|i| (0..3).map(|k| f[i][k] * direction[k]).sum());
    (largest - 1.0, std::array::from_fn(|i| std::array::from_fn(|j| turned[i] * direction[j] / largest)))
}

/// A unit vector along an eigenvector of a symmetric tensor: normal to two rows of what is left without the eigenvalue.
fn direction(tensor: &Tensor, eigenvalue: f64) -> [f64; 3] {
    let rows: Tensor =
        std::array::from_fn(|i| std::array::from_fn(|j| tensor[i][j] - if i == j { eigenvalue } else { 0.0 }));
    let longest = |vectors: [[f64; 3]; 3]| {
        let longer = |a: [f64; 3], b: [f64; 3]| if norm(b) > norm(a) { b } else { a };
        vectors.into_iter().fold([0.0; 3], longer)
    };
    let unit = |v: [f64; 3]| v.map(|x| x / norm(v));
    let normal = longest([cross(rows[0], rows[1]), cross(rows[1], rows[2]), cross(rows[2], rows[0])]);
    if norm(normal) > 0.0 {
        return unit(normal);
    }
    // A double eigenvalue: every direction normal to the one row; a triple one: every direction.
    let row = longest(rows);
    if norm(row) == 0.0 {
        return [1.0, 0.0, 0.0];
    }
    unit(longest([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| cross(row, axis))))
}

#[cfg(test)]
mod tests {
    use pneuflex_model::Formulation;

    use super::*;
    use crate::stress::recover;
    use crate::testing::{displacement_of, with_formulation};

    const ALL: [Peak; 4] = [
        Peak { field: Field::VonMises, measure: Measure::Norm(12.0) },
        Peak { field: Field::VonMises, measure: Measure::Quantile(0.99) },
        Peak { field: Field::Stretch, measure: Measure::Norm(12.0) },
        Peak { field: Field::Stretch, measure: Measure::Quantile(0.99) },
    ];

    fn deformed(problem: &Problem) -> Vec<[f64; 3]> {
        displacement_of(problem, |[x, y, z]| {
            [
                0.02 * x + 0.004 * z * z,
                -0.01 * y + 0.002 * x * z,
                -0.006 * x * x + 0.01 * y * z + 0.05 * (0.7 * z).sin(),
            ]
        })
    }

    #[test]
    fn slopes_are_those_of_differences() {
        for formulation in [Formulation::Hex8Sri, Formulation::Hex27] {
            let problem = with_formulation(9.0, formulation);
            let u = deformed(&problem);
            let along: Vec<[f64; 3]> =
                (0..u.len()).map(|node| std::array::from_fn(|k| ((3 * node + k) as f64 * 1.7).sin())).collect();
            for peak in ALL {
                let at = |step: f64| {
                    let moved = u.iter().zip(&along).map(|(u, d)| std::array::from_fn(|k| u[k] + step * d[k]));
                    peak.value(&problem, &moved.collect::<Vec<[f64; 3]>>()).unwrap()
                };
                let step = 1e-5;
                let differences = (8.0 * (at(step) - at(-step)) - (at(2.0 * step) - at(-2.0 * step))) / (12.0 * step);
                let gradient = peak.gradient(&problem, &u).unwrap();
                let exact: f64 = gradient.as_flattened().iter().zip(along.as_flattened()).map(|(g, d)| g * d).sum();
                assert!(exact.abs() > 1e-3, "nothing to differentiate: {peak:?} {exact}");
                assert!((exact - differences).abs() < 1e-7 * exact.abs(), "{peak:?}: {exact} {differences}");
            }
        }
    }

    /// Below the largest value, which the norm comes near to, and by the smoothing near the quantile that counts points.
    #[test]
    fn measures_are_near_what_they_smooth() {
        let problem = with_formulation(4.5, Formulation::Hex27);
        let u = deformed(&problem);
        let stress = recover(&problem, &u).unwrap();
        let largest = stress.largest_von_mises().unwrap().von_mises;
        let of = |field: Field, measure: Measure| Peak { field, measure }.value(&problem, &u).unwrap();
        let norms = [4.0, 12.0, 100.0].map(|p| of(Field::VonMises, Measure::Norm(p)));
        assert!(norms[0] < norms[1] && norms[1] < norms[2] && norms[2] < largest, "{norms:?} {largest}");
        assert!(norms[2] > 0.9 * largest, "{norms:?} {largest}");
        let (smooth, counted) = (of(Field::VonMises, Measure::Quantile(0.99)), stress.von_mises_quantile(0.99));
        assert!((smooth / counted - 1.0).abs() < 0.1, "{smooth} {counted}");
        let stretch = stress.points.iter().fold(0.0_f64, |most, point| most.max(point.stretch));
        let norm = of(Field::Stretch, Measure::Norm(100.0));
        assert!(norm < stretch && norm - 1.0 > 0.9 * (stretch - 1.0), "{norm} {stretch}");
        let rest = vec![[0.0; 3]; u.len()];
        assert_eq!(ALL.map(|peak| peak.value(&problem, &rest).unwrap()), [0.0, 0.0, 1.0, 1.0]);
    }

    /// Pulled evenly, all points have the same value, which every measure is.
    #[test]
    fn of_an_even_field_every_measure_is_its_value() {
        let problem = with_formulation(9.0, Formulation::Hex8Sri);
        let u = displacement_of(&problem, |[x, ..]| [0.3 * x, 0.0, 0.0]);
        let found = ALL.map(|peak| peak.value(&problem, &u).unwrap());
        let stress = recover(&problem, &u).unwrap().points[0].von_mises;
        // s(t) = 0.99 at t = ln 99: the smoothed quantile is above an even field by that many widths.
        let raised = 1.0 / (1.0 - SMOOTHING * 99.0_f64.ln());
        let expected = [stress, stress * raised, 1.3, 1.0 + 0.3 * raised];
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {expected:?}");
    }
}
