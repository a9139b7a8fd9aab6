//! Paths that are followed by their arc length, on which the load parameter is an unknown (theory §14; Riks 1979, *Int. J. Solids Struct.* 15;
//! Crisfield 1981, *Comput. Struct.* 13): the metric, the equation that closes the system, and what such a path remembers.
//!
//! Lengths are those of a space of displacements and the load parameter t, ds² = ½ (w |du|² + dt²): of the unit of t, and equal to dt where
//! w |du/dt|² = 1. With w = (t_max/|u|)² of the state that a step begins at, both parts weigh alike on a straight path, whatever the body's
//! size, stiffness and mesh; at a limit point, where displacements change and t does not, the first part alone counts.

use pneuflex_model::{LoadParameter, StateKind};
use serde::{Deserialize, Serialize};

use crate::state::{Correction, State, difference, dot};

/// What a path that is followed by its arc length remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ArcMemory {
    /// Change of displacements (mm, one entry per node) and load parameter over the last step; none at rest.
    pub last: Option<(Vec<[f64; 3]>, f64)>,
    /// Greatest load parameter so far.
    pub greatest: f64,
    /// Whether the load parameter falls along the path.
    pub is_falling: bool,
    /// States beyond the first limit point so far, which counts; 0 before it.
    pub past_limit: usize,
    /// The kind of the present state, if it is one to be told of that was not asked for.
    pub untold: Option<StateKind>,
}

impl ArcMemory {
    /// Whether a limit point lies behind.
    pub fn is_past_limit(&self) -> bool {
        self.past_limit > 0
    }
}

/// The path's direction at a state: the change of all unknowns per change of the load parameter.
#[derive(Clone, Debug)]
pub(crate) struct Direction<'a> {
    rate: &'a Correction,
    /// 1 where the load parameter rises along the path, else −1.
    pub(crate) sign: f64,
    /// ds/dt, without its sign.
    length: f64,
}

impl<'a> Direction<'a> {
    /// The direction that a path goes on in after a change of displacements (mm) and load parameter.
    pub(crate) fn after(rate: &'a Correction, change: Option<(&[[f64; 3]], f64)>, weight: f64) -> Self {
        let along = change.map_or(1.0, |(u, parameter)| weight * dot(u, &rate.displacement) + parameter);
        let length = (0.5 * (1.0 + weight * dot(&rate.displacement, &rate.displacement))).sqrt();
        Self { rate, sign: if along < 0.0 { -1.0 } else { 1.0 }, length }
    }

    /// Change of the load parameter per arc length.
    pub(crate) fn slope(&self) -> f64 {
        self.sign / self.length
    }

    /// The change of all unknowns beside the load parameter over an arc, along the tangent.
    pub(crate) fn over(&self, size: f64) -> Correction {
        self.rate.scaled(size * self.slope())
    }

    /// Cosine of the angle between it and a change.
    pub(crate) fn cosine(&self, change: &[[f64; 3]], parameter: f64, weight: f64) -> f64 {
        let along = self.sign * (weight * dot(change, &self.rate.displacement) + parameter);
        along / (2.0 * self.length * length(change, parameter, weight))
    }
}

/// Arc length of a straight change.
pub(crate) fn length(change: &[[f64; 3]], parameter: f64, weight: f64) -> f64 {
    (0.5 * (weight * dot(change, change) + parameter * parameter)).sqrt()
}

/// The equation g(u, t) = 0 beside those of the equilibrium.
pub(crate) struct ArcEquation<'a> {
    /// Where the step begins.
    pub(crate) start: &'a State,
    /// Weight w of the displacements.
    pub(crate) weight: f64,
    pub(crate) kind: ArcKind<'a>,
}

/// What the equation asks for.
pub(crate) enum ArcKind<'a> {
    /// An arc length from the start: ½ (w |Δu|² + Δt²) = s². The path leaves every such ball, whichever way it turns.
    Sphere(f64),
    /// No way along a direction: w ṫu · Δu + Δt = 0, for a start that is to become an equilibrium again.
    Across(&'a Correction),
}

impl ArcEquation<'_> {
    /// g at a state.
    pub(crate) fn value(&self, state: &State) -> f64 {
        let (u, t) = self.change(state);
        match self.kind {
            ArcKind::Sphere(size) => length(&u, t, self.weight).powi(2) - size * size,
            ArcKind::Across(rate) => self.weight * dot(&rate.displacement, &u) + t,
        }
    }

    /// Change of the load parameter by which a correction that leaves no residual at the present one is to be taken along `rate`, so that
    /// the linearised equation holds, too.
    pub(crate) fn change_of_parameter(&self, state: &State, correction: &Correction, rate: &Correction) -> f64 {
        let (u, t) = self.change(state);
        let (row, own) = match self.kind {
            ArcKind::Sphere(_) => (u, t),
            ArcKind::Across(rate) => (rate.displacement.clone(), 1.0),
        };
        let along = |correction: &Correction| self.weight * dot(&row, &correction.displacement);
        -(self.value(state) + along(correction)) / (own + along(rate))
    }

    /// Whether the load parameter falls along the path at a state that was reached from the start.
    pub(crate) fn is_falling(&self, state: &State, rate: &Correction) -> bool {
        let (u, t) = self.change(state);
        Direction::after(rate, Some((&u, t)), self.weight).sign < 0.0
    }

    fn change(&self, state: &State) -> (Vec<[f64; 3]>, f64) {
        (difference(&state.displacement, &self.start.displacement), state.parameter - self.start.parameter)
    }
}

/// Weight of the displacements at a state, given the change of all unknowns per change of the load parameter there.
pub(crate) fn weight(state: &State, greatest: f64, rate: &Correction) -> f64 {
    let size = dot(&state.displacement, &state.displacement);
    let (size, parameter) = if size > 0.0 && greatest > 0.0 {
        (size, greatest)
    } else {
        (dot(&rate.displacement, &rate.displacement), 1.0)
    };
    if size > 0.0 { parameter * parameter / size } else { 0.0 }
}

/// Where along an arc from 0 to `size` the load parameter has its extreme value, by the cubic with its values and slopes at both ends, and
/// the second derivative there. The slopes must have different signs.
pub(crate) fn extreme(values: [f64; 2], slopes: [f64; 2], size: f64) -> (f64, f64) {
    let rise = values[1] - values[0];
    let [a, b] = slopes.map(|slope| slope * size);
    // Derivative a + 2 p θ + 3 q θ².
    let (p, q) = (3.0 * rise - 2.0 * a - b, a + b - 2.0 * rise);
    let root = (p * p - 3.0 * q * a).max(0.0).sqrt();
    // Of the two roots the one between 0 and 1; in the form that keeps its digits where q is small.
    let candidates = [-a / (p + root), -a / (p - root)];
    let inside = candidates.into_iter().find(|theta| *theta > 0.0 && *theta < 1.0);
    let theta = inside.unwrap_or(a / (a - b));
    (theta * size, (2.0 * p + 6.0 * q * theta) / (size * size))
}

/// The position from which the change of loads is taken: a small one that stays below the last position asked for, beyond which curves have
/// no slope.
pub(crate) fn probe(at: LoadParameter, last: LoadParameter) -> f64 {
    let change = 1e-4 * last.0.abs().max(at.0.abs());
    if at + change <= last { change } else { -change }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(u: f64) -> Vec<[f64; 3]> {
        vec![[u, 0.0, 0.0]]
    }

    fn rate(u: f64) -> Correction {
        Correction { displacement: one(u), bordered: Vec::new() }
    }

    #[test]
    fn the_extreme_of_a_cubic_is_found() {
        let cubic = |s: f64| 2.0 + 3.0 * s - 2.0 * s * s + 0.1 * s * s * s;
        let slope = |s: f64| 3.0 - 4.0 * s + 0.3 * s * s;
        let (at, curvature) = extreme([cubic(0.0), cubic(2.0)], [slope(0.0), slope(2.0)], 2.0);
        assert!(slope(at).abs() < 1e-12 && (curvature - (-4.0 + 0.6 * at)).abs() < 1e-12, "{at}");
        // A parabola.
        let (at, curvature) = extreme([0.0, 0.0], [1.0, -1.0], 4.0);
        assert!((at - 2.0).abs() < 1e-12 && (curvature + 0.5).abs() < 1e-12, "{at} {curvature}");
    }

    /// One unknown with u − sin t … turned round: t = sin u has a limit point at u = π/2. Newton's method with the bordered row finds the
    /// point of the path on the sphere, also beyond the limit point.
    #[test]
    fn the_sphere_meets_the_path_beyond_a_limit_point() {
        let start = State::new(1.4_f64.sin(), one(1.4), Vec::new());
        let equation = ArcEquation { start: &start, weight: 0.5, kind: ArcKind::Sphere(0.3) };
        let (first, size) = (rate(1.0 / 1.4_f64.cos()), 0.3);
        let direction = Direction::after(&first, None, 0.5);
        assert!(direction.sign > 0.0 && direction.slope() > 0.0);
        let guess = direction.over(size);
        let mut state =
            State::new(start.parameter.0 + size * direction.slope(), one(1.4 + guess.displacement[0][0]), Vec::new());
        for _ in 0..12 {
            let (u, t) = (state.displacement[0][0], state.parameter.0);
            let correction = rate((t - u.sin()) / u.cos());
            let along = rate(1.0 / u.cos());
            let change = equation.change_of_parameter(&state, &correction, &along);
            state = State::new(
                t + change,
                one(u + correction.displacement[0][0] + change * along.displacement[0][0]),
                Vec::new(),
            );
        }
        let u = state.displacement[0][0];
        assert!((state.parameter.0 - u.sin()).abs() < 1e-12 && equation.value(&state).abs() < 1e-12);
        assert!(u > std::f64::consts::FRAC_PI_2 && equation.is_falling(&state, &rate(1.0 / u.cos())), "{u}");
        let change = [u - 1.4, state.parameter - start.parameter];
        assert!(direction.cosine(&one(change[0]), change[1], 0.5) > 0.9);
        assert!((length(&one(change[0]), change[1], 0.5) - size).abs() < 1e-12);
    }

    #[test]
    fn lengths_have_the_unit_of_the_load_parameter() {
        // A straight path: the weight makes both parts equal, and the arc as long as the parameter changes.
        let state = State::new(2.0, one(6.0), Vec::new());
        let weight = weight(&state, 2.0, &rate(3.0));
        assert!((Direction::after(&rate(3.0), None, weight).slope() - 1.0).abs() < 1e-15);
        let at_rest = super::weight(&State::at_rest(1, 0), 0.0, &rate(3.0));
        assert!((at_rest - weight).abs() < 1e-15);
        assert_eq!(super::weight(&State::at_rest(1, 0), 0.0, &rate(0.0)), 0.0);
    }
}
