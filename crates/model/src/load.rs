//! What acts on a body, as functions of the load parameter ([`LoadParameter`]), which files call time where it is no pressure.

use pneuflex_mesh::Facet;

use crate::quantity::LoadParameter;

/// A piecewise linear function of the load parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Curve {
    /// This many times the parameter.
    Proportional(f64),
    /// Through points (parameter, value) in the order of the parameter; constant before the first and after the last.
    Table(Vec<[f64; 2]>),
}

/// A space that a surface encloses, alone or together with planes of symmetry.
#[derive(Clone, Debug, PartialEq)]
pub struct Cavity {
    /// Name in reports.
    pub name: String,
    /// Its walls.
    pub facets: Vec<Facet>,
    /// What is known about the fluid in it.
    pub control: Control,
}

/// What is known about the fluid in a cavity.
#[derive(Clone, Debug, PartialEq)]
pub enum Control {
    /// Its pressure above the atmosphere's, MPa.
    Pressure(Curve),
    /// By how much it exceeds the volume at rest, mm³: an incompressible liquid is pumped in. The pressure follows, and may fall while
    /// the volume grows.
    Volume(Curve),
    /// An amount of gas.
    Gas(Gas),
}

/// Gas in a closed cavity: (p + p₀) Vⁿ = m p₀ V₀ⁿ, with the pressure p above the atmosphere's p₀, the volume V (V₀ at rest).
#[derive(Clone, Debug, PartialEq)]
pub struct Gas {
    /// Absolute pressure of the atmosphere p₀, MPa.
    pub atmosphere: f64,
    /// Polytropic exponent n: 1 for gas that keeps its temperature, 1.4 for air that exchanges no heat.
    pub exponent: f64,
    /// Amount m, relative to what fills the cavity at rest at the atmosphere's pressure.
    pub amount: Curve,
}

/// A load that is not a cavity's.
#[derive(Clone, Debug, PartialEq)]
pub enum Load {
    /// Forces of one direction on nodes, N.
    Force {
        /// Loaded nodes, each with the factor of its force.
        nodes: Vec<(u32, f64)>,
        /// Force on a node whose factor is 1, N.
        force: [f64; 3],
        /// Factor along the load path.
        curve: Curve,
    },
    /// A force per area at rest that keeps its direction, MPa.
    Traction {
        /// Loaded faces.
        facets: Vec<Facet>,
        /// Force per area at rest, MPa.
        traction: [f64; 3],
        /// Factor along the load path.
        curve: Curve,
    },
    /// A pressure that stays normal to the deformed faces, against their outer normals, MPa.
    Pressure {
        /// Loaded faces.
        facets: Vec<Facet>,
        /// Pressure along the load path, MPa.
        curve: Curve,
    },
    /// Weight, by the materials' densities.
    Gravity {
        /// Elements that have a weight; `None` for all.
        elements: Option<Vec<u32>>,
        /// Acceleration, mm/s².
        acceleration: [f64; 3],
        /// Factor along the load path.
        curve: Curve,
    },
}

/// Displacements of a support, in the same ratio everywhere on the load path.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Displacement where the curve is 1, mm; only that along held axes counts.
    pub displacement: [f64; 3],
    /// Factor along the load path.
    pub curve: Curve,
}

/// Σ cᵢ uᵢ = b over components of nodes' displacements.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearEquation {
    /// Node, axis and coefficient of every term.
    pub terms: Vec<(u32, u8, f64)>,
    /// Right-hand side along the load path, mm (times the coefficients' unit).
    pub value: Curve,
}

impl Curve {
    /// Zero everywhere.
    pub const ZERO: Self = Self::Proportional(0.0);

    /// The same value everywhere.
    pub fn constant(value: f64) -> Self {
        Self::Table(vec![[0.0, value]])
    }

    /// Value at a position on the load path.
    pub fn at(&self, LoadParameter(parameter): LoadParameter) -> f64 {
        let points = match self {
            Self::Proportional(slope) => return slope * parameter,
            Self::Table(points) => points,
        };
        let after = points.partition_point(|point| point[0] <= parameter);
        match (&points[..after], &points[after..]) {
            ([.., [t0, v0]], [[t1, v1], ..]) => v0 + (v1 - v0) * (parameter - t0) / (t1 - t0),
            ([.., [_, value]], []) | ([], [[_, value], ..]) => *value,
            ([], []) => 0.0,
        }
    }

    /// Σ factor · curve. Where one jumps, so does the sum. Proportional curves among tables grow up to the last corner of these, and stay.
    pub fn sum(terms: &[(f64, &Self)]) -> Self {
        let slope = |curve: &Self| match curve {
            Self::Proportional(slope) => Some(*slope),
            Self::Table(_) => None,
        };
        let slopes: Option<Vec<f64>> = terms.iter().map(|(factor, curve)| Some(factor * slope(curve)?)).collect();
        if let Some(slopes) = slopes {
            return Self::Proportional(slopes.iter().sum());
        }
        let mut corners: Vec<f64> = terms.iter().flat_map(|(_, curve)| curve.corners()).map(|at| at.0).collect();
        corners.sort_by(f64::total_cmp);
        corners.dedup();
        let total = |of: &dyn Fn(&Self) -> f64| terms.iter().map(|(factor, curve)| factor * of(curve)).sum::<f64>();
        let mut points = Vec::new();
        for corner in corners {
            let (before, after) =
                (total(&|curve| curve.before(corner)), total(&|curve| curve.at(LoadParameter(corner))));
            if before != after {
                points.push([corner, before]);
            }
            points.push([corner, after]);
        }
        Self::Table(points)
    }

    /// Value right before a position on the load path.
    fn before(&self, parameter: f64) -> f64 {
        let points = match self {
            Self::Proportional(slope) => return slope * parameter,
            Self::Table(points) => points,
        };
        match points.iter().find(|point| point[0] >= parameter) {
            Some([at, value]) if *at == parameter => *value,
            _ => self.at(LoadParameter(parameter)),
        }
    }

    /// Positions at which its slope changes.
    pub fn corners(&self) -> impl Iterator<Item = LoadParameter> {
        let points: &[[f64; 2]] = match self {
            Self::Proportional(_) => &[],
            Self::Table(points) => points,
        };
        points.iter().map(|point| LoadParameter(point[0]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_linear_between_their_points_and_constant_outside() {
        let curve = Curve::Table(vec![[1.0, 2.0], [3.0, 6.0], [3.0, 1.0], [4.0, 0.0]]);
        let expected = [(0.0, 2.0), (1.0, 2.0), (2.0, 4.0), (3.0, 1.0), (3.5, 0.5), (9.0, 0.0)];
        for (time, value) in expected {
            assert_eq!(curve.at(LoadParameter(time)), value, "at {time}");
        }
        assert_eq!(Curve::Proportional(1e-3).at(LoadParameter(35.0)), 0.035);
        assert_eq!(Curve::constant(7.0).at(LoadParameter(-1.0)), 7.0);
        assert_eq!(Curve::Table(Vec::new()).at(LoadParameter(1.0)), 0.0);
    }

    #[test]
    fn a_sum_of_curves_is_the_sum_of_their_values() {
        let jump = Curve::Table(vec![[1.0, 2.0], [3.0, 6.0], [3.0, 1.0], [4.0, 0.0]]);
        let ramp = Curve::Table(vec![[0.0, 0.0], [2.0, 1.0]]);
        let sum = Curve::sum(&[(2.0, &jump), (-0.5, &ramp)]);
        for time in [0.0, 0.3, 1.0, 1.7, 2.5, 2.999, 3.0, 3.3, 5.0] {
            let at = |curve: &Curve| curve.at(LoadParameter(time));
            assert!((at(&sum) - 2.0 * at(&jump) + 0.5 * at(&ramp)).abs() < 1e-13, "at {time}");
        }
        assert_eq!(Curve::sum(&[(2.0, &Curve::Proportional(1.5))]), Curve::Proportional(3.0));
    }
}
