//! The motions that release energy at an unstable equilibrium: where they strain the body, and whether the body has them or only the mesh
//! (theory §15).

use nalgebra::{DMatrix, SymmetricEigen};
use pneuflex_assembly::formulation::{IntegrationPoint, displacement_gradient, reference_gradients, tabulate};
use pneuflex_mesh::{Mesh, PerKind, with_num_nodes};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::error::AssembleError;
use crate::rotation_update::rate;
use crate::system::System;
use crate::tangent_solver::{Assembled, Tangent};

/// More unstable motions than this are not looked for.
const MOST: usize = 8;

/// Vectors of the Lanczos basis.
const VECTORS: usize = 32;

/// A vector of which no more than this share is new adds nothing to a basis.
const NOTHING_NEW: f64 = 1e-12;

/// Share of the straining that the elements which count hold.
const COUNTED: f64 = 0.9;

/// A motion in no more elements than this is none that the mesh resolves.
const FEW: usize = 2;

/// Linear elements in which the straining varies about its mean by more than this share do not resolve it: with n elements across a bent wall
/// it is 1/n².
const VARYING: f64 = 0.1;

/// A nearly incompressible body is strained at constant volume; a motion whose straining is by more than this share a change of volume lives
/// where the pressures of the elements do not see it.
const VOLUMETRIC: f64 = 0.2;

/// A motion, one entry per node; its size has no meaning.
pub type Mode = Vec<[f64; 3]>;

/// What the motions that release energy have in common.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnstableMotions {
    /// How many there are.
    pub count: usize,
    /// Element that they strain most.
    pub element: usize,
    /// Centre of its nodes at rest, mm.
    pub place: [f64; 3],
    /// Fewest elements that hold nine tenths of the straining.
    pub num_elements: usize,
    /// Share of the change of volume in the straining, 0 to 1.
    pub volumetric_share: f64,
    /// Share of the straining that varies within the elements about their means, 0 to 1.
    pub varying_share: f64,
    /// Mean volumetric pressure in the strained elements, MPa, weighted by the straining; tension is positive.
    pub tension: f64,
    /// Whether the elements are linear: straight edges, which lose volume as they twist.
    pub is_linear: bool,
}

impl UnstableMotions {
    /// Whether they are motions of the mesh, and not of the body:
    ///
    /// * inside of one or two elements each;
    /// * a change of volume that the elements' pressures do not see;
    /// * a twist that linear elements under hydrostatic tension do not resolve. Their edges stay straight, so that twisting one of height h by
    ///   θ takes about A h θ²/6 of its volume away, and p times that is released, against ½ μ J θ²/h that the twist costs: too much from
    ///   p h²/(μ A) of about one half on, and ever less on finer meshes.
    pub fn are_of_the_mesh(&self) -> bool {
        let is_twisted = self.is_linear && self.tension > 0.0 && self.varying_share > VARYING;
        self.num_elements <= FEW * self.count || self.is_volumetric() || is_twisted
    }

    /// Whether they are changes of volume that the elements' pressures do not see.
    pub fn is_volumetric(&self) -> bool {
        self.volumetric_share > VOLUMETRIC
    }

    /// Those at an equilibrium, from the tangent and what was assembled there, and the one of least energy; `None` if they are not found.
    ///
    /// # Errors
    /// A tangent that cannot be solved with.
    pub(crate) fn find(
        system: &mut System,
        mesh: &Mesh,
        tangent: &Tangent,
        assembled: &Assembled,
        displacement: &[[f64; 3]],
    ) -> Result<Option<(Self, Mode)>, AssembleError> {
        let count = tangent.negative_pivots();
        if count == 0 || count > MOST {
            return Ok(None);
        }
        let Some(motions) = negative_motions(system, tangent, assembled, count)? else { return Ok(None) };
        let tensions = system.element_tensions(displacement);
        let found = Self::in_common(mesh, displacement, &motions, &tensions);
        Ok(found.zip(motions.into_iter().next()))
    }

    /// What can be said of the motion in which a body gives way to a small change of its loads.
    pub(crate) fn of_response(
        system: &System,
        mesh: &Mesh,
        displacement: &[[f64; 3]],
        response: Vec<[f64; 3]>,
    ) -> Option<Self> {
        Self::in_common(mesh, displacement, &[response], &system.element_tensions(displacement))
    }

    fn in_common(mesh: &Mesh, displacement: &[[f64; 3]], motions: &[Vec<[f64; 3]>], tensions: &[f64]) -> Option<Self> {
        // Combinations of motions with the same energy are as good as these: only what they strain together has a meaning.
        let mut sum = vec![Straining::default(); mesh.num_elements()];
        for motion in motions {
            let found = straining(mesh, displacement, motion);
            let whole: f64 = found.iter().map(|straining| straining.all).sum();
            for (sum, found) in sum.iter_mut().zip(&found) {
                sum.all += found.all / whole;
                sum.volumetric += found.volumetric / whole;
                sum.varying += found.varying / whole;
            }
        }
        let count = motions.len();
        let share = |part: fn(&Straining) -> f64| sum.iter().map(part).sum::<f64>() / count as f64;
        let (volumetric_share, varying_share) = (share(|of| of.volumetric), share(|of| of.varying));
        let tension = sum.iter().zip(tensions).map(|(of, tension)| of.all * tension).sum::<f64>() / count as f64;
        let mut order: Vec<usize> = (0..sum.len()).collect();
        order.sort_by(|&a, &b| sum[b].all.total_cmp(&sum[a].all));
        let mut held = 0.0;
        let num_elements = order.iter().position(|&element| {
            held += sum[element].all;
            held >= COUNTED * count as f64
        })? + 1;
        let element = order[0];
        let nodes = mesh.element(element);
        let place = std::array::from_fn(|k| {
            nodes.iter().map(|&node| mesh.nodes[node as usize][k]).sum::<f64>() / nodes.len() as f64
        });
        let is_linear = !mesh.kind_of(element).is_quadratic();
        Some(Self { count, element, place, num_elements, volumetric_share, varying_share, tension, is_linear })
    }
}

/// Motions that span those of negative energy, the least one first, by Lanczos' method for K⁻¹ from two vectors of noise: its negative eigenvalues are one end of
/// the spectrum, whatever their size. `None` if not all were found.
fn negative_motions(
    system: &mut System,
    tangent: &Tangent,
    assembled: &Assembled,
    count: usize,
) -> Result<Option<Vec<Vec<[f64; 3]>>>, AssembleError> {
    let held = system.held().to_vec();
    let most = VECTORS.min(held.iter().filter(|held| !**held).count());
    let mut load = assembled.clone();
    load.equations.iter_mut().for_each(|equation| equation.value = 0.0);
    let mut noise = Noise(1);
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for _ in 0..2.min(most) {
        let start = held.iter().map(|held| if *held { 0.0 } else { noise.draw() }).collect();
        basis.extend(orthonormal(&basis, start));
    }
    // QᵀK⁻¹Q, column by column.
    let mut projected = DMatrix::zeros(most, most);
    let mut done = 0;
    while done < basis.len() {
        for (force, q) in load.residual.as_flattened_mut().iter_mut().zip(&basis[done]) {
            *force = -q;
        }
        let response = system.solve(tangent, &load, None)?.displacement;
        let response: Vec<f64> =
            response.as_flattened().iter().zip(&held).map(|(u, held)| if *held { 0.0 } else { *u }).collect();
        for (row, q) in basis.iter().enumerate() {
            projected[(row, done)] = dot(q, &response);
            projected[(done, row)] = projected[(row, done)];
        }
        if basis.len() < most {
            let next = orthonormal(&basis, response);
            basis.extend(next);
        }
        done += 1;
    }
    let pairs = SymmetricEigen::new(projected.view((0, 0), (done, done)).into_owned());
    let mut negative: Vec<usize> = (0..done).filter(|&k| pairs.eigenvalues[k] < 0.0).collect();
    negative.sort_by(|&a, &b| pairs.eigenvalues[b].total_cmp(&pairs.eigenvalues[a]));
    if negative.len() != count {
        return Ok(None);
    }
    let motion = |k: usize| {
        let mut motion = vec![[0.0; 3]; load.residual.len()];
        for (q, share) in basis.iter().zip(pairs.eigenvectors.column(k).iter()) {
            motion.as_flattened_mut().iter_mut().zip(q).for_each(|(value, q)| *value += share * q);
        }
        motion
    };
    Ok(Some(negative.into_iter().map(motion).collect()))
}

/// What a vector has beside those of an orthonormal basis, of length one; `None` if that is nothing.
fn orthonormal(basis: &[Vec<f64>], mut vector: Vec<f64>) -> Option<Vec<f64>> {
    let before = dot(&vector, &vector).sqrt();
    // Twice is enough (Parlett 1998, The Symmetric Eigenvalue Problem, §6.9).
    for _ in 0..2 {
        for q in basis {
            let along = dot(q, &vector);
            vector.iter_mut().zip(q).for_each(|(value, q)| *value -= along * q);
        }
    }
    let norm = dot(&vector, &vector).sqrt();
    vector.iter_mut().for_each(|value| *value /= norm);
    (norm > NOTHING_NEW * before).then_some(vector)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// How much a motion strains an element: ∫ S : S dV with the symmetric part S of δF F⁻¹, and ∫ (tr S)²/3 dV of that.
#[derive(Clone, Copy, Debug, Default)]
struct Straining {
    all: f64,
    volumetric: f64,
    /// ∫ (S − S̄) : (S − S̄) dV with the element's mean S̄.
    varying: f64,
}

fn straining(mesh: &Mesh, displacement: &[[f64; 3]], motion: &[[f64; 3]]) -> Vec<Straining> {
    let points = mesh.per_kind(|kind| tabulate(kind, (kind.volume_rule)()));
    let of_element = |element| with_num_nodes!(mesh.kind_of(element), N => straining_of::<N>(mesh, &points, element, displacement, motion));
    (0..mesh.num_elements()).into_par_iter().with_min_len(64).map(of_element).collect()
}

fn straining_of<const N: usize>(
    mesh: &Mesh,
    points: &PerKind<Vec<IntegrationPoint>>,
    element: usize,
    displacement: &[[f64; 3]],
    motion: &[[f64; 3]],
) -> Straining {
    let nodes = mesh.element(element);
    let [x, u, delta]: [[[f64; 3]; N]; 3] =
        [&mesh.nodes[..], displacement, motion].map(|field| std::array::from_fn(|a| field[nodes[a] as usize]));
    let mut sum = Straining::default();
    let (mut mean, mut whole) = ([[0.0; 3]; 3], 0.0);
    for point in &points[mesh.kind_of(element)] {
        let (gradients, volume) = reference_gradients(&x, point);
        let mut f = displacement_gradient(&u, &gradients);
        (0..3).for_each(|i| f[i][i] += 1.0);
        let Some(rate) = rate(&f, &displacement_gradient(&delta, &gradients)) else { continue };
        let (mut all, mut trace) = (0.0, 0.0);
        for i in 0..3 {
            trace += rate.stretching(i, i);
            for j in 0..3 {
                all += rate.stretching(i, j).powi(2);
                mean[i][j] += volume * rate.stretching(i, j);
            }
        }
        whole += volume;
        sum.all += volume * all;
        sum.volumetric += volume * trace * trace / 3.0;
    }
    sum.varying = sum.all - mean.as_flattened().iter().map(|s| s * s).sum::<f64>() / whole;
    sum
}

/// Numbers between −1 and 1 that look like noise, the same in every run (a linear congruence, Knuth's constants).
struct Noise(u64);

impl Noise {
    fn draw(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}
