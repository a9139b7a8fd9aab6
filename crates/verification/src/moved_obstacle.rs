//! An obstacle that comes down on an arch of rubber, or the arch's feet that come up to it: seen from the obstacle both are one problem, and
//! should take as many iterations.

use std::f64::consts::PI;

use pneuflex_mesh::lattice::Lattice;
use pneuflex_model::{
    Clock, Curve, Formulation, Invariant, Law, Material, Motion, Obstacle, Problem, Shape, Solver, Support,
};
use pneuflex_newton::{Event, follow_path};
use rayon::prelude::*;

const RADIUS: f64 = 10.0;
const GAP: f64 = 0.5;
const WAY: f64 = 3.0;
const C10: f64 = 0.2;
const CELLS: usize = 12;

/// Elements of the table, hexahedra and tetrahedra, and their lengths in multiples of the arch with a radius of 10 mm.
const ELEMENTS: [(Formulation, &[f64]); 2] = [(Formulation::Hex8Q1p0, &[1e-3, 1.0, 1e3]), (Formulation::Tet10, &[1.0])];

/// Stiffnesses of the table, in multiples of the default of these faces.
const STIFFNESSES: [f64; 4] = [0.1, 1.0, 10.0, 100.0];

/// A rubber arch on two feet, and what it meets.
#[derive(Clone, Copy, Debug)]
pub struct Arch {
    /// Its elements.
    pub formulation: Formulation,
    /// `plane`, `sphere`, `cylinder` or `cuboid`.
    pub shape: &'static str,
    /// Penalty stiffness over the default of a model file.
    pub stiffness: f64,
    /// All lengths, against a radius of 10 mm.
    pub length: f64,
    /// All moduli, against c10 = 0.2 MPa.
    pub modulus: f64,
}

/// Who goes to whom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mover {
    /// The obstacle.
    Obstacle,
    /// The feet of the arch.
    Feet,
}

/// What a path comes to.
#[derive(Clone, Debug)]
pub struct End {
    /// Displacements of the nodes as the obstacle sees them, over [`Arch::length`].
    pub displacement: Vec<[f64; 3]>,
    /// Iterations that it took.
    pub iterations: usize,
}

/// A row of the table.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The problem.
    pub arch: Arch,
    /// Where the obstacle moves, and where the feet do; or why a path ended early.
    pub ends: [Result<End, String>; 2],
}

/// Shapes of obstacles.
pub const SHAPES: [&str; 4] = ["plane", "sphere", "cylinder", "cuboid"];

impl Arch {
    /// The arch on which shapes are compared, with a penalty of so many times the default.
    pub fn new(formulation: Formulation, shape: &'static str, stiffness: f64) -> Self {
        Self { formulation, shape, stiffness, length: 1.0, modulus: 1.0 }
    }

    fn obstacle(&self) -> Shape {
        let at = |z: f64| [0.0, 0.0, self.length * (RADIUS + GAP + z)];
        match self.shape {
            "plane" => Shape::Plane { point: at(0.0), normal: [0.0, 0.0, -1.0] },
            "sphere" => Shape::Sphere { centre: at(6.0), radius: self.length * 6.0, is_hollow: false },
            "cylinder" => {
                Shape::Cylinder { point: at(5.0), axis: [0.0, 1.0, 0.0], radius: self.length * 5.0, is_hollow: false }
            }
            _ => Shape::Cuboid {
                centre: at(3.0),
                size: [9.0, 12.0, 6.0].map(|edge| self.length * edge),
                axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
                edge_radius: self.length,
            },
        }
    }

    /// The problem in which one goes to the other by 3 mm.
    fn problem(&self, mover: Mover) -> Problem {
        let mesh = Lattice::uniform([0.0; 3], [1.0, 4.0, 2.0], [CELLS, 2, 2]).mesh_all(self.formulation.element_kind());
        let top = mesh.select_facets(|x| (x[2] - 2.0).abs() < 1e-9);
        let feet = mesh.select_nodes(|x| x[0] < 1e-9 || x[0] > 1.0 - 1e-9);
        let mesh = mesh.map_nodes(|[x, y, z]| {
            let (sine, cosine) = (PI * (1.0 - x)).sin_cos();
            let r = RADIUS - 2.0 + z;
            [r * cosine, y - 2.0, r * sine].map(|x| self.length * x)
        });
        let mut problem = Problem::body(mesh, self.formulation, Law::NeoHooke { c10: self.modulus * C10 }.into());
        let bulk_modulus = self.modulus * 1e3 * C10;
        problem.material = Material { bulk_modulus, invariant: Invariant::Isochoric, ..problem.material };
        let way = |z: f64| Some(Motion { displacement: [0.0, 0.0, self.length * z], curve: Curve::Proportional(1.0) });
        let (of_obstacle, of_feet) = match mover {
            Mover::Obstacle => (way(-WAY), None),
            Mover::Feet => (None, way(WAY)),
        };
        problem.supports = vec![Support { name: "feet".into(), nodes: feet, axes: [true; 3], motion: of_feet }];
        // 100 μ over the edge of the faces, 2.6 and 2 mm long.
        let edge = 0.5 * self.length * (PI * RADIUS / CELLS as f64 + 2.0);
        problem.obstacles = vec![Obstacle {
            name: "press".into(),
            shape: self.obstacle(),
            facets: top,
            stiffness: self.stiffness * 100.0 * 2.0 * self.modulus * C10 / edge,
            motion: of_obstacle,
            report_force: true,
            penetration_tolerance: None,
            interference_until: None,
        }];
        problem.clock = Clock::Steps;
        problem
    }

    /// Follows the path to its end.
    ///
    /// # Errors
    /// Why it ended early.
    pub fn solve(&self, mover: Mover) -> Result<End, String> {
        let settings = Solver { first_step: 0.25, max_step: 0.25, min_step: 1e-4, ..Solver::default() };
        let mut displacement = Vec::new();
        let report = follow_path(&self.problem(mover), &[1.0], &settings, &mut |event| {
            if let Event::Converged(state) = event {
                displacement.clone_from(&state.displacement);
            }
        })
        .map_err(|ended| ended.0.to_string())?;
        let from_obstacle = if mover == Mover::Obstacle { WAY } else { 0.0 };
        for u in &mut displacement {
            *u = u.map(|x| x / self.length);
            u[2] += from_obstacle;
        }
        Ok(End { displacement, iterations: report.iterations })
    }
}

/// The table: every shape, element, stiffness and size, each row told to `observe` when it is there.
pub fn table(observe: &(dyn Fn(&Comparison) + Sync)) -> Vec<Comparison> {
    let mut arches = Vec::new();
    for shape in SHAPES {
        for (formulation, lengths) in ELEMENTS {
            for stiffness in STIFFNESSES {
                let of_length = |&length: &f64| Arch { length, ..Arch::new(formulation, shape, stiffness) };
                arches.extend(lengths.iter().map(of_length));
            }
        }
    }
    let compare = |arch: Arch| {
        let ends = [Mover::Obstacle, Mover::Feet].map(|mover| arch.solve(mover));
        let found = Comparison { arch, ends };
        observe(&found);
        found
    };
    arches.into_par_iter().map(compare).collect()
}

/// Largest difference of two fields over the largest of the second.
pub fn difference(found: &[[f64; 3]], expected: &[[f64; 3]]) -> f64 {
    let size = |field: &mut dyn Iterator<Item = f64>| field.fold(0.0, |most: f64, x| most.max(x.abs()));
    let (found, expected) = (found.as_flattened(), expected.as_flattened());
    size(&mut found.iter().zip(expected).map(|(a, b)| a - b)) / size(&mut expected.iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn end(arch: &Arch, mover: Mover) -> End {
        arch.solve(mover).unwrap_or_else(|why| panic!("{arch:?}: {why}"))
    }

    /// Seen from the obstacle, both problems are one. `cargo xtask obstacles` goes up to a hundred times the default, where a cylinder costs 1.6 times
    /// what the feet do.
    #[test]
    fn a_moved_obstacle_costs_what_moved_supports_cost() {
        let of_hexahedra = [0.03, 0.3, 26.0].map(|stiffness| (Formulation::Hex8Q1p0, stiffness));
        for shape in SHAPES {
            for (formulation, stiffness) in of_hexahedra.into_iter().chain([(Formulation::Tet10, 0.3)]) {
                let arch = Arch::new(formulation, shape, stiffness);
                let [moved, of_feet] = [Mover::Obstacle, Mover::Feet].map(|mover| end(&arch, mover));
                let u = difference(&moved.displacement, &of_feet.displacement);
                assert!(u < 1e-6, "{arch:?}: {u:.1e}");
                let [cost, of_feet] = [moved.iterations, of_feet.iterations];
                assert!(2 * cost <= 3 * of_feet, "{arch:?}: {cost} against {of_feet} iterations");
            }
        }
    }

    #[test]
    fn nothing_depends_on_the_units_of_length_and_force() {
        for shape in ["plane", "sphere"] {
            let arch = Arch::new(Formulation::Hex8Q1p0, shape, 1.0);
            let expected = end(&arch, Mover::Obstacle);
            for (length, modulus) in [(1e-3, 1.0), (1e3, 1.0), (1.0, 1e-3), (1e-3, 1e6), (1e3, 1e3)] {
                let found = end(&Arch { length, modulus, ..arch }, Mover::Obstacle);
                let u = difference(&found.displacement, &expected.displacement);
                assert!(u < 1e-9, "{shape}, length {length}, modulus {modulus}: {u:.1e}");
                assert_eq!(found.iterations, expected.iterations, "{shape}, length {length}, modulus {modulus}");
            }
        }
    }
}
