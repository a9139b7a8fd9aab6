//! The boundary-value problem of the rod.
//!
//! With y = (θ, m) and n(s) = P + f (L − s) the equations are y′ = g(s, y) with g = (κ(p, m), n_x sin θ − n_y cos θ),
//! θ(0) = 0 and m(L) = M. They are solved by collocation with Simpson's rule on equal intervals (fourth order; the
//! three-point Lobatto IIIA method),
//!
//! ```text
//! y₁ − y₀ = h/6 (g₀ + 4 g_m + g₁),   y_m = ½ (y₀ + y₁) + h/8 (g₀ − g₁),
//! ```
//!
//! with Newton's method for all points at once, and load steps that follow the unloaded rod to the loaded one. Shooting
//! from the clamp would be shorter, but loses all digits for slender rods, where errors grow like exp(L √(P/D)).

use nalgebra::{DMatrix, DVector, Matrix2, Vector2};
use serde::Serialize;

use crate::law::Law;

/// A rod clamped at s = 0 along the x axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rod {
    /// Length, mm.
    pub length: f64,
    /// Moment and curvature.
    pub law: Law,
    /// Number of intervals.
    pub intervals: usize,
}

/// What acts on a rod. y points to the side towards which positive curvature bends it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// Air pressure, kPa.
    pub pressure_kpa: f64,
    /// Force at the tip that keeps its direction, N.
    pub tip_force: [f64; 2],
    /// Moment at the tip, N·mm.
    pub tip_moment: f64,
    /// Force per length that keeps its direction, N/mm, e.g. weight.
    pub line_force: [f64; 2],
}

/// A rod in equilibrium, at equally spaced points from the clamp to the tip.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Shape {
    /// Positions, mm.
    pub points: Vec<[f64; 2]>,
    /// Angles θ of the tangent, rad.
    pub angles: Vec<f64>,
    /// Moments, N·mm.
    pub moments: Vec<f64>,
}

impl Shape {
    /// Position of the tip, mm.
    pub fn tip(&self) -> [f64; 2] {
        self.points.last().copied().unwrap_or_default()
    }

    /// Angle of the tangent at the tip, rad.
    pub fn tip_angle(&self) -> f64 {
        self.angles.last().copied().unwrap_or_default()
    }
}

/// Why a rod has no shape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RodError {
    /// A number out of range.
    #[error("{what} = {value} is out of range: {allowed}")]
    OutOfRange {
        /// Which.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What would be allowed.
        allowed: &'static str,
    },
    /// Newton's method failed even for small load steps.
    #[error("the rod's equilibrium could not be followed beyond {share:.4} of its load")]
    NotConverged {
        /// Share of the load reached.
        share: f64,
    },
}

/// ‖Δy‖ below which Newton's method is done; angles in rad, moments in units of D/L.
const TOLERANCE: f64 = 1e-12;
/// More iterations than this, or tangents turned further than this (rad), ask for a smaller load step.
const ITERATIONS: usize = 12;
const TURN: f64 = 0.6;
const LEAST_SHARE: f64 = 1e-5;

impl Rod {
    /// The shape under a load.
    ///
    /// # Errors
    /// Numbers out of range; an equilibrium that cannot be followed from the unloaded rod.
    pub fn shape(&self, load: &Load) -> Result<Shape, RodError> {
        self.check(load)?;
        let stiffness = self.law.stiffness(load.pressure_kpa);
        // Without load the rod has constant curvature: the start, and exact.
        let unit = stiffness / self.length;
        let curvature = self.law.curvature(load.pressure_kpa, 0.0).0;
        let h = self.length / self.intervals as f64;
        let mut state: Vec<Vector2<f64>> =
            (0..=self.intervals).map(|i| Vector2::new(curvature * h * i as f64, 0.0)).collect();
        let (mut reached, mut share) = (0.0, 1.0_f64);
        while reached < 1.0 {
            let next = (reached + share).min(1.0);
            match self.newton(&load.scaled(next), &state, unit) {
                Some(found) => {
                    (state, reached) = (found, next);
                    share *= 1.5;
                }
                None => {
                    share *= 0.5;
                    if share < LEAST_SHARE {
                        return Err(RodError::NotConverged { share: reached });
                    }
                }
            }
        }
        Ok(self.integrate(load, &state))
    }

    fn check(&self, load: &Load) -> Result<(), RodError> {
        let positive = |what, value: f64| {
            if value.is_finite() && value > 0.0 {
                Ok(())
            } else {
                Err(RodError::OutOfRange { what, value, allowed: "must be a finite number greater than 0" })
            }
        };
        positive("length", self.length)?;
        positive("bending stiffness", self.law.stiffness(load.pressure_kpa))?;
        if !(1..=2000).contains(&self.intervals) {
            let value = self.intervals as f64;
            return Err(RodError::OutOfRange { what: "intervals", value, allowed: "must be from 1 to 2000" });
        }
        let numbers = [
            load.pressure_kpa,
            load.tip_moment,
            load.tip_force[0],
            load.tip_force[1],
            load.line_force[0],
            load.line_force[1],
            self.law.intrinsic_curvature(load.pressure_kpa),
            self.law.touch_curvature(load.pressure_kpa),
        ];
        match numbers.iter().find(|v| !v.is_finite()) {
            Some(&value) => Err(RodError::OutOfRange { what: "load", value, allowed: "must be finite" }),
            None if self.law.contact < 0.0 || !self.law.contact.is_finite() => {
                let (value, allowed) = (self.law.contact, "must be 0 or more");
                Err(RodError::OutOfRange { what: "contact stiffness", value, allowed })
            }
            None => Ok(()),
        }
    }

    /// g and its derivative by y at an arc length.
    fn slope(&self, load: &Load, s: f64, y: Vector2<f64>) -> (Vector2<f64>, Matrix2<f64>) {
        let rest = self.length - s;
        let n: [f64; 2] = std::array::from_fn(|d| load.tip_force[d] + load.line_force[d] * rest);
        let (sine, cosine) = y[0].sin_cos();
        let (curvature, per_moment) = self.law.curvature(load.pressure_kpa, y[1]);
        let slope = Vector2::new(curvature, n[0] * sine - n[1] * cosine);
        (slope, Matrix2::new(0.0, per_moment, n[0] * cosine + n[1] * sine, 0.0))
    }

    /// Newton's method from a guess; `None` if it does not converge nearby.
    fn newton(&self, load: &Load, start: &[Vector2<f64>], unit: f64) -> Option<Vec<Vector2<f64>>> {
        let (n, h) = (self.intervals, self.length / self.intervals as f64);
        let mut y = start.to_vec();
        for _ in 0..ITERATIONS {
            let mut matrix = DMatrix::zeros(2 * n + 2, 2 * n + 2);
            let mut rhs = DVector::zeros(2 * n + 2);
            matrix[(0, 0)] = 1.0;
            rhs[0] = -y[0][0];
            let slopes: Vec<_> = y.iter().enumerate().map(|(i, &y)| self.slope(load, h * i as f64, y)).collect();
            for i in 0..n {
                let ((g0, j0), (g1, j1)) = (slopes[i], slopes[i + 1]);
                let middle = 0.5 * (y[i] + y[i + 1]) + h / 8.0 * (g0 - g1);
                let (gm, jm) = self.slope(load, h * (i as f64 + 0.5), middle);
                let residual = y[i + 1] - y[i] - h / 6.0 * (g0 + 4.0 * gm + g1);
                let one = Matrix2::<f64>::identity();
                let left = -one - h / 6.0 * (j0 + 4.0 * jm * (0.5 * one + h / 8.0 * j0));
                let right = one - h / 6.0 * (j1 + 4.0 * jm * (0.5 * one - h / 8.0 * j1));
                // Moments in units of D/L, so that angles and moments weigh alike; the force's row alike.
                for a in 0..2 {
                    let row = 2 * i + 1 + a;
                    let scale = if a == 1 { 1.0 / unit } else { 1.0 };
                    rhs[row] = -scale * residual[a];
                    for b in 0..2 {
                        let by = if b == 1 { unit } else { 1.0 };
                        matrix[(row, 2 * i + b)] = scale * by * left[(a, b)];
                        matrix[(row, 2 * i + 2 + b)] = scale * by * right[(a, b)];
                    }
                }
            }
            matrix[(2 * n + 1, 2 * n + 1)] = 1.0;
            rhs[2 * n + 1] = (load.tip_moment - y[n][1]) / unit;
            let step = matrix.lu().solve(&rhs)?;
            for (i, y) in y.iter_mut().enumerate() {
                y[0] += step[2 * i];
                y[1] += unit * step[2 * i + 1];
            }
            let turned = y.iter().zip(start).map(|(a, b)| (a[0] - b[0]).abs()).fold(0.0, f64::max);
            let size = step.amax();
            if !size.is_finite() || turned > TURN {
                return None;
            }
            if size < TOLERANCE * (1.0 + turned) * n as f64 {
                return Some(y);
            }
        }
        None
    }

    /// Positions, by the same rule.
    fn integrate(&self, load: &Load, state: &[Vector2<f64>]) -> Shape {
        let h = self.length / self.intervals as f64;
        let mut points = vec![[0.0; 2]];
        let curvature = |y: &Vector2<f64>| self.law.curvature(load.pressure_kpa, y[1]).0;
        for pair in state.windows(2) {
            let middle = 0.5 * (pair[0][0] + pair[1][0]) + h / 8.0 * (curvature(&pair[0]) - curvature(&pair[1]));
            let [s0, s1, s2] = [pair[0][0], middle, pair[1][0]].map(f64::sin_cos);
            let last = points[points.len() - 1];
            let step = [s0.1 + 4.0 * s1.1 + s2.1, s0.0 + 4.0 * s1.0 + s2.0];
            points.push(std::array::from_fn(|d| last[d] + h / 6.0 * step[d]));
        }
        Shape { points, angles: state.iter().map(|y| y[0]).collect(), moments: state.iter().map(|y| y[1]).collect() }
    }
}

impl Load {
    /// Pressure alone.
    pub fn pressure(pressure_kpa: f64) -> Self {
        Self { pressure_kpa, ..Self::default() }
    }

    /// The same pressure with a share of the forces.
    fn scaled(&self, share: f64) -> Self {
        Self {
            pressure_kpa: self.pressure_kpa,
            tip_force: self.tip_force.map(|x| share * x),
            tip_moment: share * self.tip_moment,
            line_force: self.line_force.map(|x| share * x),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    use super::*;

    fn straight(length: f64, stiffness: f64, intervals: usize) -> Rod {
        Rod { length, law: Law { d0: stiffness, ..Law::default() }, intervals }
    }

    #[test]
    fn an_end_moment_of_two_pi_closes_the_rod_into_a_circle() {
        let rod = straight(82.0, 700.0, 100);
        let load = Load { tip_moment: TAU * 700.0 / 82.0, ..Load::default() };
        let shape = rod.shape(&load).unwrap();
        assert!((shape.tip_angle() - TAU).abs() < 1e-12);
        assert!(shape.tip()[0].hypot(shape.tip()[1]) < 1e-6, "{:?}", shape.tip());
        // Half way round it is a diameter away.
        let half = shape.points[50];
        assert!(half[0].abs() < 1e-6 && (half[1] - 82.0 / PI).abs() < 1e-5, "{half:?}");
    }

    /// Incomplete elliptic integrals F and E of amplitude `phi` and modulus `k`, by Gauss-Legendre quadrature on many
    /// short intervals; beyond double precision's needs for k well below 1.
    fn elliptic(phi: f64, k: f64) -> [f64; 2] {
        const NODES: [(f64, f64); 3] = [
            (0.238_619_186_083_196_9, 0.467_913_934_572_691_04),
            (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
            (0.932_469_514_203_152, 0.171_324_492_379_170_36),
        ];
        const N: usize = 400;
        let h = phi / N as f64;
        let mut sum = [0.0; 2];
        for i in 0..N {
            for (x, w) in NODES {
                for x in [x, -x] {
                    let t = h * (i as f64 + 0.5 + 0.5 * x);
                    let root = (1.0 - (k * t.sin()).powi(2)).sqrt();
                    sum[0] += 0.5 * h * w / root;
                    sum[1] += 0.5 * h * w * root;
                }
            }
        }
        sum
    }

    /// Tip of a straight cantilever of length 1 and stiffness 1 under a force α across it: deflection, shortening and
    /// angle by the elastica's elliptic integrals (K. Mattiasson 1981): with k² = (1 + sin θ)/2 and sin φ = 1/(k√2),
    /// √α = K(k) − F(φ, k), deflection 1 − 2 (E(k) − E(φ, k))/√α, position along the axis √(2 sin θ/α).
    fn mattiasson(alpha: f64) -> [f64; 3] {
        let at = |theta: f64| {
            let k = (0.5 * (1.0 + theta.sin())).sqrt();
            let phi = (1.0 / (k * 2.0_f64.sqrt())).asin();
            let (complete, part) = (elliptic(FRAC_PI_2, k), elliptic(phi, k));
            (complete[0] - part[0], complete[1] - part[1])
        };
        let (mut low, mut high) = (0.0, FRAC_PI_2 - 1e-9);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if at(middle).0 < alpha.sqrt() { low = middle } else { high = middle }
        }
        let theta = 0.5 * (low + high);
        let (root, e) = at(theta);
        [1.0 - 2.0 * e / root, 1.0 - (2.0 * theta.sin()).sqrt() / root, theta]
    }

    #[test]
    fn a_transverse_tip_load_has_the_deflection_of_elliptic_integrals() {
        // Three values of the published table, to know that the formula is the right one.
        for (alpha, [deflection, shortening, angle]) in [
            (1.0, [0.30172, 0.05643, 0.46135]),
            (2.0, [0.49346, 0.16064, 0.78175]),
            (10.0, [0.81061, 0.55500, 1.43029]),
        ] {
            let exact = mattiasson(alpha);
            for (a, b) in exact.iter().zip([deflection, shortening, angle]) {
                assert!((a - b).abs() < 6e-6, "{alpha}: {exact:?}");
            }
        }
        let (length, stiffness) = (82.0, 700.0);
        let rod = straight(length, stiffness, 200);
        for alpha in [0.2, 0.6, 1.0, 2.0, 4.0, 6.0, 8.0, 10.0] {
            let force = alpha * stiffness / (length * length);
            let shape = rod.shape(&Load { tip_force: [0.0, force], ..Load::default() }).unwrap();
            let found = [shape.tip()[1] / length, 1.0 - shape.tip()[0] / length, shape.tip_angle()];
            for (a, b) in found.iter().zip(mattiasson(alpha)) {
                assert!((a - b).abs() < 1e-7, "{alpha}: {found:?} against {:?}", mattiasson(alpha));
            }
        }
    }

    #[test]
    fn the_error_falls_with_the_fourth_power_of_the_interval() {
        let exact = mattiasson(4.0)[0];
        let error = |intervals| {
            let load = Load { tip_force: [0.0, 4.0], ..Load::default() };
            (straight(1.0, 1.0, intervals).shape(&load).unwrap().tip()[1] - exact).abs()
        };
        let [coarse, fine] = [10, 20].map(error);
        let order = (coarse / fine).log2();
        assert!((3.7..4.4).contains(&order), "order {order}, errors {coarse:e} {fine:e}");
    }

    #[test]
    fn pressure_alone_makes_an_arc() {
        let law = Law { a1: 1e-3, a2: 2e-5, d0: 700.0, ..Law::default() };
        let shape = Rod { length: 82.0, law, intervals: 40 }.shape(&Load::pressure(20.0)).unwrap();
        let curvature = 0.02 + 0.008;
        let angle: f64 = 82.0 * curvature;
        assert!((shape.tip_angle() - angle).abs() < 1e-12);
        assert!((shape.tip()[0] - angle.sin() / curvature).abs() < 1e-4);
        assert!(shape.moments.iter().all(|m| m.abs() < 1e-12));
    }

    #[test]
    fn moments_balance_the_loads() {
        // Moment at the clamp: of the tip force, of the line force about its own points, and the tip's.
        let law = Law { a1: 1e-3, d0: 700.0, contact: 3000.0, touch: [-0.01, 0.0], ..Law::default() };
        let rod = Rod { length: 82.0, law, intervals: 400 };
        let load = Load { pressure_kpa: 10.0, tip_force: [0.05, -0.3], tip_moment: 2.0, line_force: [0.0, -2e-3] };
        let shape = rod.shape(&load).unwrap();
        let tip = shape.tip();
        let h = 82.0 / 400.0;
        let line: f64 = shape.points.windows(2).map(|p| 0.5 * (p[0][0] + p[1][0]) * h * load.line_force[1]).sum();
        let expected = 2.0 + tip[0] * -0.3 - tip[1] * 0.05 + line;
        assert!((shape.moments[0] - expected).abs() < 1e-4 * expected.abs(), "{} {expected}", shape.moments[0]);
        // Bent back far enough for the chambers to touch near the clamp.
        assert!(law.curvature(10.0, shape.moments[0]).0 < -0.01);
    }

    #[test]
    fn rods_that_make_no_sense_are_refused() {
        let rod = straight(82.0, 700.0, 10);
        assert!(Rod { length: 0.0, ..rod }.shape(&Load::default()).is_err());
        assert!(straight(82.0, -1.0, 10).shape(&Load::default()).is_err());
        assert!(Rod { intervals: 0, ..rod }.shape(&Load::default()).is_err());
        assert!(rod.shape(&Load { tip_moment: f64::NAN, ..Load::default() }).is_err());
    }
}
