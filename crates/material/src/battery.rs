//! Tests that every law passes. They are called from the laws' own crates and panic with what is wrong.

use crate::hyperelastic::Hyperelastic;
use crate::kinematics::Kinematics;
use crate::tensor::{Response, Tangent, Tensor};

pub use pneuflex_model::Mode;

const GENERIC: Tensor = [[0.31, -0.22, 0.15], [0.08, -0.17, 0.21], [-0.12, 0.19, 0.26]];
const LARGE: Tensor = [[1.4, 0.7, -0.2], [0.3, -0.35, 0.4], [0.5, -0.3, 0.2]];

/// Everything that holds for any isotropic law: stress and tangent are derivatives, neither depends on the frame, the
/// material has no direction. `stress` is a typical size of the law's stress, MPa.
///
/// # Panics
/// If something of it does not hold.
pub fn check_isotropic(law: &impl Hyperelastic, stress: f64) {
    for (name, h) in states() {
        check_derivatives(law, &name, &h, stress);
        check_frames(law, &name, &h);
    }
    check_near_equal_stretches(law);
}

/// What holds for laws in the isochoric part of the deformation: a change of volume alone costs nothing, and the moduli at rest are
/// those of the shear modulus μ, MPa: μ (δ_ik δ_jl + δ_il δ_jk − ⅔ δ_ij δ_kl).
///
/// # Panics
/// If something of it does not hold.
pub fn check_isochoric(law: &impl Hyperelastic, shear_modulus: f64) {
    for by in [0.0, 1e-3, 0.4, -0.3] {
        let response = at(law, &diagonal([by; 3]));
        assert!(response.energy.abs() < 1e-14 * shear_modulus, "energy {:e} at {by}", response.energy);
        assert_close(response.stress.as_flattened(), &[0.0; 9], 1e-14 * shear_modulus, "stress of a dilation");
    }
    let rest = at(law, &diagonal([0.0; 3])).tangent;
    let delta = |a: usize, b: usize| f64::from(u8::from(a == b));
    let expected: Tangent = std::array::from_fn(|row| {
        std::array::from_fn(|column| {
            let (i, j, k, l) = (row / 3, row % 3, column / 3, column % 3);
            shear_modulus
                * (delta(i, k) * delta(j, l) + delta(i, l) * delta(j, k) - 2.0 / 3.0 * delta(i, j) * delta(k, l))
        })
    });
    assert_close(rest.as_flattened(), expected.as_flattened(), 1e-13 * shear_modulus, "moduli at rest");
}

/// Nominal stress of homogeneous states, MPa, against a closed form; the pressure follows from the free face.
///
/// # Panics
/// If they differ by more than rounding.
pub fn check_homogeneous(law: &impl Hyperelastic, nominal_stress: impl Fn(Mode, f64) -> f64) {
    for mode in Mode::ALL {
        for stretch in [0.6, 0.95, 1.1, 1.5, 2.0, 3.0] {
            let l = mode.stretches(stretch);
            let p = at(law, &diagonal(l.map(|l| l - 1.0))).stress;
            let (found, exact) = (p[0][0] - p[2][2] * l[2] / l[0], nominal_stress(mode, stretch));
            // The sum that was cancelled may be larger than what is left.
            let scale = p[0][0].abs() + (p[2][2] * l[2] / l[0]).abs() + exact.abs();
            assert!((found - exact).abs() < 1e-12 * scale, "{mode:?} {stretch}: {found} for {exact}");
        }
    }
}

fn states() -> Vec<(String, Tensor)> {
    let mut states = vec![
        ("rest".to_owned(), diagonal([0.0; 3])),
        ("generic".to_owned(), GENERIC),
        ("large".to_owned(), LARGE),
        ("dilation".to_owned(), diagonal([0.2; 3])),
    ];
    let turned = rotation([0.3, -0.5, 0.8], 0.7);
    for mode in Mode::ALL {
        for stretch in [0.7, 1.8] {
            states.push((format!("{mode:?} {stretch}"), diagonal(mode.stretches(stretch).map(|l| l - 1.0))));
            // The same along directions that are not those of the coordinates.
            let stretches = diagonal(mode.stretches(stretch).map(|l| l - 1.0));
            let along = product(&product(&transposed(&turned), &stretches), &turned);
            states.push((format!("{mode:?} {stretch}, turned"), along));
        }
    }
    states
}

fn check_derivatives(law: &impl Hyperelastic, name: &str, h: &Tensor, stress: f64) {
    const STEP: f64 = 1e-5;
    let here = at(law, h);
    let scale = here.tangent.as_flattened().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    assert!(scale > 0.1 * stress, "{name}: the check would be empty");
    assert_eq!(law.energy_and_stress(&kinematics(h)), (here.energy, here.stress), "{name}");
    for k in 0..9 {
        // Fourth order: f(1), f(2) on either side.
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|by| {
            let mut moved = *h;
            moved[k / 3][k % 3] += by * STEP;
            at(law, &moved)
        });
        let slope = |a: f64, b: f64, c: f64, d: f64| (a - 8.0 * b + 8.0 * c - d) / (12.0 * STEP);
        let quotient = slope(a.energy, b.energy, c.energy, d.energy);
        let found = here.stress[k / 3][k % 3];
        assert!((quotient - found).abs() < 1e-9 * scale, "{name}: P {k} is {found}, not {quotient}");
        for i in 0..9 {
            let [a, b, c, d] = [&a, &b, &c, &d].map(|r| r.stress[i / 3][i % 3]);
            let (quotient, found) = (slope(a, b, c, d), here.tangent[i][k]);
            assert!((quotient - found).abs() < 1e-9 * scale, "{name}: tangent {i},{k} is {found}, not {quotient}");
            assert!((found - here.tangent[k][i]).abs() < 1e-12 * scale, "{name}: not symmetric {i},{k}");
        }
    }
}

/// P(Q F) = Q P(F) and P(F Q) = P(F) Q, with equal energies.
fn check_frames(law: &impl Hyperelastic, name: &str, h: &Tensor) {
    let q = rotation([0.6, 0.2, -0.4], 2.1);
    let here = at(law, h);
    let scale = 1e-12 * here.tangent.as_flattened().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    let f = kinematics(h).gradient;
    let less_one = |f: Tensor| -> Tensor {
        std::array::from_fn(|i| std::array::from_fn(|j| f[i][j] - f64::from(u8::from(i == j))))
    };
    for (what, turned, expected) in [
        ("frame", product(&q, &f), product(&q, &here.stress)),
        ("direction", product(&f, &q), product(&here.stress, &q)),
    ] {
        let there = at(law, &less_one(turned));
        assert!((there.energy - here.energy).abs() < scale, "{name}: the energy depends on the {what}");
        assert_close(there.stress.as_flattened(), expected.as_flattened(), scale, &format!("{name}: {what}"));
    }
}

/// Stretches that come together: the response goes to that of equal stretches, without loss of digits on the way.
fn check_near_equal_stretches(law: &impl Hyperelastic) {
    let turned = rotation([0.3, -0.5, 0.8], 0.7);
    let along =
        |stretches: [f64; 3]| product(&product(&transposed(&turned), &diagonal(stretches.map(|l| l - 1.0))), &turned);
    for [one, two, three] in [[1.3, 1.3, 0.6], [0.8, 0.8, 0.8], [1.7, 1.7, 1.7]] {
        let equal = at(law, &along([one, two, three]));
        let size = |t: &Tangent| t.as_flattened().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let scale = size(&equal.tangent);
        for apart in [1e-15, 1e-13, 1e-11, 1e-9, 1e-7] {
            let near = at(law, &along([one + apart, two - 0.5 * apart, three]));
            // The tangent's own derivative is a few times as large as the tangent.
            let allowed = (1e-12 + 100.0 * apart) * scale;
            let what = format!("stretches {apart:e} apart");
            assert_close(near.stress.as_flattened(), equal.stress.as_flattened(), allowed, &what);
            assert_close(near.tangent.as_flattened(), equal.tangent.as_flattened(), allowed, &what);
        }
    }
}

fn at(law: &impl Hyperelastic, h: &Tensor) -> Response {
    law.respond(&kinematics(h))
}

fn kinematics(h: &Tensor) -> Kinematics {
    match Kinematics::new(h) {
        Ok(kinematics) => kinematics,
        Err(error) => panic!("a state of the battery is not admissible: {error}"),
    }
}

#[track_caller]
fn assert_close(found: &[f64], expected: &[f64], allowed: f64, what: &str) {
    for (i, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((a - b).abs() <= allowed, "{what}: entry {i} is {a}, not {b} (within {allowed:e})");
    }
}

fn diagonal(entries: [f64; 3]) -> Tensor {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { entries[i] } else { 0.0 }))
}

fn product(a: &Tensor, b: &Tensor) -> Tensor {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn transposed(a: &Tensor) -> Tensor {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

/// Rotation about an axis (of any length) by an angle: Rodrigues' formula.
fn rotation(axis: [f64; 3], angle: f64) -> Tensor {
    let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [x, y, z] = axis.map(|a| a / length);
    let (s, c) = angle.sin_cos();
    let cross = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    let n = [x, y, z];
    std::array::from_fn(|i| {
        std::array::from_fn(|j| (1.0 - c) * n[i] * n[j] + s * cross[i][j] + if i == j { c } else { 0.0 })
    })
}
