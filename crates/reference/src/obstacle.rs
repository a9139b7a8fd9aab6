//! Rigid obstacles: the energy ½ k ∫⟨−φ⟩² dA₀ with the signed distance φ of the deformed points, negative inside (theory §5.6).

use nalgebra::{DMatrix, DVector};
use pneuflex_model::{LoadParameter, Motion, Obstacle, Problem, Shape};

use crate::closest_point::penalty;
use crate::differentiate::{Differentiable, Dual, Energy, LinearMap, Term, cross, dot};
use crate::elements;
use crate::error::{ReferenceError, Unmodelled};
use crate::shape::face_functions;

/// ½ k A ⟨−φ⟩² of a point; v is its position.
#[derive(Clone, Debug)]
struct Touch<'a> {
    // k A, N/mm
    stiffness: f64,
    shape: &'a Shape,
    offset: [f64; 3],
}

impl Energy<3> for Touch<'_> {
    fn energy<D: Dual>(&self, v: &[D; 3]) -> D {
        penalty(self.stiffness, distance(self.shape, std::array::from_fn(|i| v[i] - self.offset[i])))
    }
}

/// φ at a point, for an obstacle that has not moved.
fn distance<D: Dual>(shape: &Shape, r: [D; 3]) -> D {
    let from = |origin: &[f64; 3]| -> [D; 3] { std::array::from_fn(|i| r[i] - origin[i]) };
    let unit = |a: &[f64; 3]| a.map(|x| D::from(x / dot(*a, *a).sqrt()));
    let signed = |distance: D, is_hollow: bool| if is_hollow { -distance } else { distance };
    match shape {
        Shape::Plane { point, normal } => dot(from(point), unit(normal)),
        Shape::Sphere { centre, radius, is_hollow } => signed(length(from(centre)) - *radius, *is_hollow),
        // |v × axis| is the distance from the axis.
        Shape::Cylinder { point, axis, radius, is_hollow } => {
            signed(length(cross(from(point), unit(axis))) - *radius, *is_hollow)
        }
        // A smaller cuboid, grown by the radius of its edges. Outside of it only the coordinates beyond its faces count, inside only
        // the nearest face.
        Shape::Cuboid { centre, size, axes, edge_radius } => {
            let v = from(centre);
            let beyond: [D; 3] =
                std::array::from_fn(|axis| dot(axes[axis].map(D::from), v).abs() - (0.5 * size[axis] - edge_radius));
            let outside: Vec<D> = beyond.into_iter().filter(|b| *b > 0.0).collect();
            let nearest = |a: D, b: D| if b > a { b } else { a };
            let from_box = match outside[..] {
                [] => nearest(nearest(beyond[0], beyond[1]), beyond[2]),
                [alone] => alone,
                [a, b] => (a * a + b * b).sqrt(),
                _ => length(beyond),
            };
            from_box - *edge_radius
        }
    }
}

fn length<D: Dual>(a: [D; 3]) -> D {
    dot(a, a).sqrt()
}

/// An obstacle and the points that may touch it.
#[derive(Clone, Debug)]
pub struct ObstacleModel {
    shape: Shape,
    stiffness: f64,
    motion: Option<Motion>,
    // Positions of the points, and the reference areas that they stand for, mm².
    points: Vec<(LinearMap<3>, f64)>,
}

impl ObstacleModel {
    /// An obstacle of a problem, with 4 × 4 points on each of its facets.
    ///
    /// # Errors
    /// An element family without a formulation, or contact that is not modelled ([`Unmodelled`]).
    pub fn new(problem: &Problem, obstacle: &Obstacle) -> Result<Self, ReferenceError> {
        // Whether its force is reported changes nothing.
        let Obstacle {
            name,
            shape,
            facets,
            stiffness,
            motion,
            report_force: _,
            penetration_tolerance,
            interference_until,
        } = obstacle;
        if interference_until.is_some() {
            return Err(ReferenceError::NotModelled { part: Unmodelled::Interference, name: name.clone() });
        }
        if penetration_tolerance.is_some() {
            let (part, name) = (Unmodelled::PenetrationTolerance, name.clone());
            return Err(ReferenceError::NotModelled { part, name });
        }
        let mesh = &problem.mesh;
        let mut points = Vec::new();
        for &facet in facets {
            let nodes = mesh.facet_nodes(facet);
            let (kind, functions) = face_functions(problem, facet)?;
            for (xi, weight) in elements::contact_rule(kind) {
                let map = LinearMap::of_positions(&nodes, &mesh.nodes, &[functions.values(&xi)]);
                let [along_xi, along_eta] = [[1, 0], [0, 1]].map(|orders| -> [f64; 3] {
                    LinearMap::<3>::of_positions(&nodes, &mesh.nodes, &[functions.derivatives(orders, &xi)]).offset
                });
                points.push((map, weight * length(cross(along_xi, along_eta))));
            }
        }
        Ok(Self { shape: shape.clone(), stiffness: *stiffness, motion: motion.clone(), points })
    }

    /// Signed distances of all points, mm.
    pub fn distances(&self, u: &[f64], parameter: LoadParameter) -> Vec<f64> {
        let offset = self.offset(parameter);
        let position = |map: &LinearMap<3>| -> [f64; 3] {
            let r = map.apply(u);
            std::array::from_fn(|i| r[i] - offset[i])
        };
        self.points.iter().map(|(map, _)| distance(&self.shape, position(map))).collect()
    }

    /// ½ k ∫⟨−φ⟩² dA₀, N·mm.
    pub fn energy(&self, u: &[f64], parameter: LoadParameter) -> f64 {
        self.terms(parameter).map(|term| term.value(u)).sum()
    }

    /// ∂energy/∂u, N.
    pub fn gradient(&self, u: &[f64], parameter: LoadParameter) -> DVector<f64> {
        let mut gradient = DVector::zeros(u.len());
        self.terms(parameter).for_each(|term| term.add_gradient(u, 1.0, &mut gradient));
        gradient
    }

    /// ∂²energy/∂u², N/mm.
    pub fn hessian(&self, u: &[f64], parameter: LoadParameter) -> DMatrix<f64> {
        let mut hessian = DMatrix::zeros(u.len(), u.len());
        self.terms(parameter).for_each(|term| term.add_hessian(u, 1.0, &mut hessian));
        hessian
    }

    fn offset(&self, parameter: LoadParameter) -> [f64; 3] {
        self.motion.as_ref().map_or([0.0; 3], |Motion { displacement, curve }| {
            let factor = curve.at(parameter);
            displacement.map(|x| factor * x)
        })
    }

    fn terms(&self, parameter: LoadParameter) -> impl Iterator<Item = Term<3, Touch<'_>>> {
        let offset = self.offset(parameter);
        self.points.iter().map(move |(map, area)| Term {
            energy: Touch { stiffness: self.stiffness * area, shape: &self.shape, offset },
            map: map.clone(),
        })
    }
}

#[cfg(test)]
mod tests {
    use pneuflex_model::{Curve, Formulation, Material};

    use super::*;
    use crate::testing::{block, body, check_derivatives, noise};

    #[test]
    fn distances_of_known_points() {
        let axes = [[1.0, 0.0, 0.0], [0.0, 0.6, 0.8], [0.0, -0.8, 0.6]];
        let cuboid = Shape::Cuboid { centre: [1.0, 0.0, 0.0], size: [2.0, 4.0, 6.0], axes, edge_radius: 0.25 };
        let round = |is_hollow| Shape::Sphere { centre: [1.0, 0.0, 0.0], radius: 2.0, is_hollow };
        let tube = Shape::Cylinder { point: [0.0, 0.0, 9.0], axis: [0.0, 0.0, -3.0], radius: 1.0, is_hollow: true };
        let at = |local: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|i| f64::from(u8::from(i == 0)) + (0..3).map(|a| axes[a][i] * local[a]).sum::<f64>())
        };
        for (shape, r, expected) in [
            (&Shape::Plane { point: [0.0, 0.0, 1.0], normal: [0.0, 0.0, -2.0] }, [5.0, 5.0, 3.0], -2.0),
            (&round(false), [1.0, 3.0, 4.0], 3.0),
            (&round(true), [1.0, 3.0, 4.0], -3.0),
            (&tube, [3.0, 4.0, -7.0], -4.0),
            (&cuboid, at([1.5, 0.0, 0.0]), 0.5),
            (&cuboid, at([0.0, -1.9, 0.5]), -0.1),
            (&cuboid, at([0.0, 2.75, -3.75]), 2.0_f64.sqrt() - 0.25),
            (&cuboid, at([1.75, 2.75, -3.75]), 3.0_f64.sqrt() - 0.25),
        ] {
            let found = distance(shape, r);
            assert!((found - expected).abs() < 1e-14, "{shape:?} at {r:?}: {found} for {expected}");
        }
    }

    #[test]
    fn derivatives_in_touch_with_moved_obstacles() {
        let axes = [[1.0, 0.0, 0.0], [0.0, 0.6, 0.8], [0.0, -0.8, 0.6]];
        let shapes = [
            Shape::Plane { point: [0.0, 0.0, 0.8], normal: [0.1, 0.0, -1.0] },
            Shape::Sphere { centre: [0.5, 0.6, 1.5], radius: 0.9, is_hollow: false },
            Shape::Cylinder { point: [0.5, 0.6, 0.0], axis: [0.1, 1.0, 0.0], radius: 0.7, is_hollow: true },
            Shape::Cuboid { centre: [0.5, 0.6, 1.4], size: [0.8, 1.6, 1.0], axes, edge_radius: 0.2 },
        ];
        for formulation in [Formulation::Hex8Q1p0, Formulation::Tet15] {
            let mesh = block(formulation, [1.0, 1.2, 0.8], [1, 1, 1], 0.0);
            let problem = body(mesh, formulation, Material::default());
            let facets = problem.mesh.select_facets(|x| x[2] == 0.8);
            for shape in &shapes {
                let motion = Motion { displacement: [0.0, 0.0, -0.1], curve: Curve::Proportional(1.0) };
                let obstacle = Obstacle {
                    name: "test".into(),
                    shape: shape.clone(),
                    facets: facets.clone(),
                    stiffness: 4.0,
                    motion: Some(motion),
                    report_force: false,
                    penetration_tolerance: None,
                    interference_until: None,
                };
                let (model, t) = (ObstacleModel::new(&problem, &obstacle).unwrap(), LoadParameter(2.0));
                let u = noise(problem.num_dofs(), 0.02);
                assert!(model.distances(&u, t).iter().filter(|d| **d < -0.01).count() > 3, "{shape:?}");
                check_derivatives(|u| model.energy(u, t), |u| model.gradient(u, t), |u| model.hessian(u, t), &u);
            }
        }
    }
}
