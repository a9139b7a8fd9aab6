//! Block buffers are used again and again: nothing of what was in them may come through.

use std::collections::BTreeSet;
use std::sync::Mutex;

use pneuflex_assembly::{
    ContactForces, Contribution, Equations, FollowerPressure, LocalBlock, LocalContribution, LocalError, Position,
    Request, Solid, Totals,
};
use pneuflex_contact::Partner;
use pneuflex_mesh::lattice::Lattice;
use pneuflex_model::{
    ContactMethod, ContactPair, Curve, Formulation, LinearEquation, LoadParameter, Material, Obstacle, Pressure,
    Problem, Shape,
};

use crate::mock::{BATCH, Dense, Mock, NOISE, REQUESTS, assembler_of, displacement};

/// Notes which buffers a contribution gets, and leaves noise in them if it is dirty.
struct Watched<'a> {
    mock: &'a Mock,
    is_dirty: bool,
    /// Addresses of the buffers.
    seen: Mutex<BTreeSet<usize>>,
}

impl<'a> Watched<'a> {
    fn new(mock: &'a Mock, is_dirty: bool) -> Self {
        Self { mock, is_dirty, seen: Mutex::default() }
    }
}

impl LocalContribution for Watched<'_> {
    fn num_blocks(&self) -> usize {
        self.mock.num_blocks()
    }

    fn nodes(&self, block: usize) -> &[u32] {
        self.mock.nodes(block)
    }

    fn evaluate(
        &self,
        block: usize,
        displacement: &[[f64; 3]],
        request: Request,
        out: &mut LocalBlock,
    ) -> Result<(), LocalError> {
        self.seen.lock().unwrap().insert(std::ptr::from_ref(out) as usize);
        if !self.is_dirty {
            return self.mock.evaluate(block, displacement, request, out);
        }
        out.energy = NOISE;
        out.residual.fill([NOISE; 3]);
        out.tangent.fill([NOISE; 9]);
        // It leaves in the middle of its work, too.
        match block + 1 == self.num_blocks() {
            true => Err(LocalError { block, point: 0, jacobian: NOISE }),
            false => Ok(()),
        }
    }
}

/// Aim: a contribution finds its buffers clean and of the right size, whatever another one has left in them.
#[test]
fn buffers_are_clean_after_another_contribution() {
    let (num_nodes, count) = (31, 2 * BATCH + 60);
    let u = displacement(num_nodes);
    let before = Mock::of_many(16, count, 5, num_nodes as u32, 1.0);
    for nodes_per_block in [0, 1, 4, 5, 8] {
        let mock = Mock::of_many(17, count, nodes_per_block, num_nodes as u32, 1.0);
        let expected = Dense::sum(&[&mock], &u);
        let mut assembler = assembler_of(&[&before, &mock], num_nodes);
        for (first, request) in REQUESTS.into_iter().flat_map(|first| REQUESTS.map(|request| (first, request))) {
            let (dirty, clean) = (Watched::new(&before, true), Watched::new(&mock, false));
            let mut totals = Totals::default();
            assembler.reset(&mut totals, Request::Tangent);
            assembler.add(0, &dirty, &u, first, &mut totals).unwrap_err();
            assembler.reset(&mut totals, Request::Tangent);
            assembler.add(1, &clean, &u, request, &mut totals).unwrap();
            // Two batches' worth of buffers, all of them used before.
            let [dirty, clean] = [dirty, clean].map(|watched| watched.seen.into_inner().unwrap());
            assert!(clean.len() == 2 * BATCH && clean == dirty, "no buffer was used again");
            let found = Dense::of(assembler.pattern(), &totals);
            let of_request = Dense {
                energy: expected.energy,
                residual: if request >= Request::Residual {
                    expected.residual.clone()
                } else {
                    vec![[0.0; 3]; num_nodes]
                },
                tangent: if request == Request::Tangent { expected.tangent.clone() } else { 0.0 * &expected.tangent },
            };
            assert_eq!(found, of_request, "{nodes_per_block} nodes, {request:?} after {first:?}");
        }
    }
}

/// Requires of every block the same from a new buffer and from one that was full of noise before it was reset.
#[track_caller]
fn check_buffers(name: &str, contribution: &dyn LocalContribution, u: &[[f64; 3]]) {
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let mut sizes = [0.0_f64; 3];
    for block in 0..contribution.num_blocks() {
        let n = contribution.nodes(block).len();
        for (request, room) in REQUESTS.into_iter().flat_map(|request| [1, n, n + 3].map(|room| (request, room))) {
            let mut new = LocalBlock::default();
            let mut used = LocalBlock {
                energy: NOISE,
                residual: vec![[NOISE; 3]; room],
                tangent: vec![[NOISE; 9]; room * (room + 1) / 2],
            };
            for out in [&mut new, &mut used] {
                out.reset(n, request);
                contribution.evaluate(block, u, request, out).unwrap();
            }
            assert_eq!(used, new, "{name}, block {block}, {request:?}");
            let [with_residual, with_tangent] = [Request::Residual, Request::Tangent].map(|least| request >= least);
            assert_eq!(new.residual.len(), if with_residual { n } else { 0 }, "{name}, {request:?}");
            assert_eq!(new.tangent.len(), if with_tangent { n * (n + 1) / 2 } else { 0 }, "{name}, {request:?}");
            let found = [&[new.energy][..], new.residual.as_flattened(), new.tangent.as_flattened()].map(largest);
            sizes = std::array::from_fn(|k| sizes[k].max(found[k]));
        }
    }
    assert!(sizes.iter().all(|&size| size > 1e-6), "{name}: the check would be empty, {sizes:?}");
}

/// Two unit cubes side by side, 0.1 mm apart, the first of which is pushed 0.2 mm into the second and 0.05 mm into a floor.
fn touching_cubes(formulation: Formulation, method: ContactMethod) -> (Problem, Vec<[f64; 3]>) {
    let cube =
        |x: f64| Lattice::uniform([x, 0.0, 0.0], [x + 1.0, 1.0, 1.0], [1; 3]).mesh_all(formulation.element_kind());
    let (mut mesh, second) = (cube(0.0), cube(1.1));
    let shift = mesh.num_nodes() as u32;
    mesh.connectivity.extend(second.connectivity.iter().map(|node| node + shift));
    mesh.nodes.extend(second.nodes);
    let facets = |axis: usize, at: f64| mesh.select_facets(|x| (x[axis] - at).abs() < 1e-9);
    let (pair, floor) = (ContactPair::new("gap", facets(0, 1.0), facets(0, 1.1)), facets(2, 0.0));
    let pushed = |x: &[f64; 3]| if x[0] < 1.05 { [0.2 + 0.1 + 0.02 * x[2], 0.03 * x[2], -0.05] } else { [0.0; 3] };
    let u = mesh.nodes.iter().map(pushed).collect();
    let mut problem = Problem::body(mesh, formulation, Material::default());
    problem.contact.method = method;
    problem.contact_pairs = vec![pair];
    problem.obstacles = vec![Obstacle {
        name: "floor".into(),
        shape: Shape::Plane { point: [0.0; 3], normal: [0.0, 0.0, 1.0] },
        facets: floor,
        stiffness: 20.0,
        motion: None,
        report_force: false,
        penetration_tolerance: None,
        interference_until: None,
    }];
    (problem, u)
}

/// Aim: no contribution reads what stood in its buffers before.
#[test]
fn contributions_do_not_depend_on_what_their_buffers_held() {
    for formulation in Formulation::ALL {
        let mesh = Lattice::uniform([0.0; 3], [2.0, 1.0, 1.0], [2, 1, 1]).mesh_all(formulation.element_kind());
        let bent = |x: &[f64; 3]| [0.1 * x[0] + 0.05 * x[2], 0.04 * x[0] * x[1], 0.1 * (x[0] - x[1]).sin()];
        let u: Vec<[f64; 3]> = mesh.nodes.iter().map(bent).collect();
        let solid = Solid::new(mesh.clone(), formulation, &Material::default()).unwrap();
        check_buffers(&format!("solid, {formulation}"), &solid, &u);

        let facets = mesh.boundary_facets();
        let mut pressure = FollowerPressure::new(mesh, &facets);
        pressure.pressure = Pressure::from_mpa(0.3);
        check_buffers(&format!("pressure, {formulation}"), &pressure, &u);
    }

    let terms = [vec![(4, 0, 1.0), (1, 2, -2.0), (4, 1, 0.5), (2, 0, 3.0)], vec![(3, 1, 1.0)]];
    let equations = terms.map(|terms| LinearEquation { terms, value: Curve::Proportional(0.2) });
    let mut equations = Equations::new(&equations, 7.0, 1.0);
    equations.set_parameter(LoadParameter(1.5));
    check_buffers("equations", &equations, &displacement(5));

    for formulation in
        [Formulation::Hex8Q1p0, Formulation::Hex20, Formulation::Hex27, Formulation::Tet10, Formulation::Tet15]
    {
        for method in [ContactMethod::SinglePoint, ContactMethod::MultiPoint] {
            let (problem, u) = touching_cubes(formulation, method);
            let mut contact = ContactForces::of(&problem);
            contact.set_position(Position {
                parameter: LoadParameter::default(),
                displacement: &u,
                bordered: &[],
                is_on_the_way: false,
            });
            let on_floor =
                contact.touching().iter().filter(|block| matches!(block.partner, Partner::Obstacle(_))).count();
            assert!(on_floor > 0 && on_floor < contact.num_blocks(), "{formulation} {method:?}: {on_floor}");
            check_buffers(&format!("contact, {formulation} {method:?}"), &contact, &u);
        }
    }
}
