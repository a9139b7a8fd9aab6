//! A random small problem: a body with everything that a case or model file can say of it.
//!
//! Tables are written out key by key, without defaults: whoever adds a key to one of them has to say here what is drawn for it, in
//! [`super::frame`] how it turns, is mirrored and scales, and in [`super::rewrite`] what becomes of it in a half. The compiler asks for it.

use pneuflex::mesh::lattice::Lattice;
use pneuflex::mesh::testing::mixed;
use pneuflex::mesh::{Actuator, Channel, ElementKind, Facet, Mesh, Part, PerChamber};
use pneuflex::model::choice::{Ball, Choice, Conditions, Direction, Plane};
use pneuflex::model::model_file::{
    CavityTable, ContactTable, EquationTable, ForceTable, GravityTable, Model, PressureTable, RegionTable, Source,
    Steps, SupportTable, Times, TractionTable,
};
use pneuflex::model::{
    Case, Contact, ContactMethod, Continuation, Formulation, Load, Material, MeshOptions, ObstacleTable, Output, Probe,
    Resolution, Series, ShapeName, Size, Solver, Volumetric,
};
use pneuflex_laws::samples;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A problem, before it is written in one form or another.
#[derive(Clone, Debug)]
pub enum Draw {
    /// A case file.
    Case(Box<Case>),
    /// A model file; with a mesh unless its body is an actuator.
    Model(Box<Model>, Option<Body>),
}

/// A mesh and how it is solved.
#[derive(Clone, Debug)]
pub struct Body {
    /// The mesh, with sets `x0`, `x1`, … `z1` (outer faces), `outer`, `inner` (of a hole), `front` (elements), `tip` and `corner` (a node).
    pub mesh: Mesh,
    /// Its formulation.
    pub formulation: Formulation,
}

/// Largest number of unknowns, about, of a quick draw and of others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// The smallest bodies only.
    Tiny,
    /// Some hundreds of nodes.
    Small,
}

/// Corrections of a drawn problem end below this, mm and N: relations are far closer than results have to be otherwise.
const TOLERANCE: f64 = 1e-10;

/// The random numbers of a draw.
pub struct Dice(ChaCha8Rng);

impl Dice {
    /// Those of a draw of a seed.
    pub fn of(seed: u64, number: usize) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(number as u64);
        Self(random)
    }

    /// A number between two.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        // Three digits: files and messages stay readable.
        let number: f64 = self.0.random_range(low..high);
        let digits = 10_f64.powf(2.0 - number.abs().max(1e-300).log10().floor());
        (number * digits).round() / digits
    }

    /// Whether something with a probability happens.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.0.random_bool(probability)
    }

    /// One of some things.
    pub fn one_of<T: Clone>(&mut self, things: &[T]) -> T {
        things[self.0.random_range(0..things.len())].clone()
    }

    fn maybe<T>(&mut self, probability: f64, make: impl FnOnce(&mut Self) -> T) -> Option<T> {
        self.chance(probability).then(|| make(self))
    }
}

impl Draw {
    /// A random problem.
    pub fn new(dice: &mut Dice, scale: Scale) -> Self {
        match dice.0.random_range(0..10) {
            0..2 => Self::Case(Box::new(case(dice, scale))),
            2..4 => Self::Model(Box::new(actuator_model(dice, scale)), None),
            _ => block_model(dice, scale),
        }
    }

    /// In a word.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Case(_) => "case",
            Self::Model(_, None) => "actuator",
            Self::Model(_, Some(_)) => "block",
        }
    }
}

/// A material: every law and invariant that there is, of a softness and compressibility.
fn material(dice: &mut Dice) -> Material {
    let sample = dice.one_of(&samples());
    let bulk_modulus = sample.shear_modulus() * dice.one_of(&[5.0, 50.0, 1844.0]);
    let volumetric = dice.one_of(&[Volumetric::Quadratic, Volumetric::Logarithmic]);
    let density = if dice.chance(0.5) { 1.1 } else { 0.0 };
    Material { bulk_modulus, volumetric, density, ..sample }
}

/// A stiff one, or any, which has a weight if the first has.
fn other_material(dice: &mut Dice, first: &Material) -> Material {
    let other = if dice.chance(0.5) { Material::yeoh(1.5, 0.0, 0.0) } else { material(dice) };
    Material { density: first.density, ..other }
}

/// A function of time that reaches a value, all of them ending at `end`.
fn series(dice: &mut Dice, value: f64, end: f64) -> Series {
    if dice.chance(0.6) {
        return Series::End(value);
    }
    let middle = dice.between(0.2, 1.0);
    Series::Points(vec![[0.0, 0.0], [0.5 * end, middle * value], [end, value]])
}

fn factor(dice: &mut Dice, end: f64) -> Option<Series> {
    dice.maybe(0.3, |dice| series(dice, 1.0, end))
}

fn times(dice: &mut Dice) -> Vec<f64> {
    let end = dice.one_of(&[1.0, 2.5, 20.0]);
    if dice.chance(0.5) { vec![end] } else { vec![0.5 * end, end] }
}

fn steps(dice: &mut Dice, end: f64) -> Steps {
    Steps {
        tolerance: Some(TOLERANCE),
        residual_tolerance: Some(TOLERANCE),
        max_iterations: dice.maybe(0.3, |dice| dice.one_of(&[15, 40])),
        first_step: dice.maybe(0.4, |dice| dice.one_of(&[0.2, 0.5]) * end),
        max_step: dice.maybe(0.3, |dice| dice.one_of(&[0.3, 0.5]) * end),
        ..with_continuation(dice.maybe(0.2, |_| 1e-4 * end))
    }
}

/// Where a least step is drawn, one of the continuations: they find the same states at the requested times.
fn with_continuation(min_step: Option<f64>) -> Steps {
    let Some(step) = min_step else { return Steps::default() };
    let is_arc = step > 1e-3;
    Steps {
        min_step,
        continuation: Some(if is_arc {
            Continuation::ArcLength
        } else if step > 1.5e-4 {
            Continuation::Damped
        } else {
            Continuation::Load
        }),
        states_past_limit: is_arc.then_some(4),
        ..Steps::default()
    }
}

fn actuator(dice: &mut Dice) -> Actuator {
    let chambers = dice.one_of(&[1, 1, 2, 2, 2, 3]);
    let is_varied = dice.chance(0.35);
    // Chambers that differ do so by a quarter: elements between planes that are closer have too little left of their digits.
    let each = |dice: &mut Dice, count: usize, number: f64| -> PerChamber {
        match is_varied && dice.chance(0.6) {
            true => (0..count).map(|_| number * dice.one_of(&[1.0, 0.75])).collect::<Vec<f64>>().into(),
            false => number.into(),
        }
    };
    let cavity_length = dice.between(4.0, 7.0);
    let has_channel = dice.chance(0.8);
    Actuator {
        chambers,
        chamber_length: {
            let longest = cavity_length + dice.between(1.5, 3.0);
            // Around every cavity, also the longest in the shortest chamber.
            let shortest = cavity_length + 1.0;
            match is_varied && dice.chance(0.6) {
                true => (0..chambers).map(|_| dice.one_of(&[longest, shortest])).collect::<Vec<f64>>().into(),
                false => longest.into(),
            }
        },
        cavity_length: each(dice, chambers, cavity_length),
        gap: match (is_varied && dice.chance(0.6), dice.chance(0.15)) {
            (true, _) => {
                let gaps = [0.0, dice.between(0.5, 1.2), dice.between(1.3, 2.5)];
                (1..chambers).map(|_| dice.one_of(&gaps)).collect::<Vec<f64>>().into()
            }
            (false, true) => 0.0.into(),
            (false, false) => dice.between(0.5, 2.5).into(),
        },
        flange: dice.one_of(&[0.0, 2.0]),
        width: dice.between(12.0, 20.0),
        height: dice.between(9.0, 13.0),
        base: dice.between(3.0, 4.5),
        cavity_floor: dice.maybe(0.2, |dice| dice.between(4.6, 5.5)),
        side_wall: {
            let wall = dice.between(1.0, 2.0);
            each(dice, chambers, wall)
        },
        top_wall: {
            let wall = dice.between(1.0, 2.0);
            each(dice, chambers, wall)
        },
        channel: Channel { half_width: if has_channel { 1.0 } else { 0.0 }, bottom: 1.0, top: 2.0 },
        part: dice.one_of(&[Part::Half, Part::Half, Part::Whole]),
    }
}

fn mesh_options(dice: &mut Dice, scale: Scale) -> MeshOptions {
    let elements: &[Formulation] = match scale {
        Scale::Tiny => &[Formulation::Hex8Sri, Formulation::Hex8Q1p0],
        Scale::Small => &Formulation::ALL,
    };
    let element = dice.one_of(elements);
    let size = if element.element.is_quadratic() { [6.0, 12.0, 12.0] } else { [3.0, 5.0, 4.0] };
    MeshOptions {
        resolution: dice.maybe(0.2, |_| Resolution::Draft),
        size: Some(if dice.chance(0.5) { Size::PerAxis(size) } else { Size::Uniform(size[1]) }),
        edge_size: dice.maybe(0.15, |_| 0.6 * size[0]),
        wall_elements: dice.maybe(0.3, |_| 1),
        element: Some(element),
    }
}

/// What a body that is not in the way of an obstacle yet offers it: its corners, and how far its contact points are apart.
struct Target {
    corners: [[f64; 3]; 2],
    spacing: f64,
}

impl Target {
    /// Gauss points, four along an edge of a face, are apart by 0.34 of the edge at the most.
    fn new(corners: [[f64; 3]; 2], edge: f64) -> Self {
        Self { corners, spacing: 0.34 * edge }
    }
}

/// An obstacle below a body, hardly or not yet touched; beside the middle plane now and then.
fn obstacle(dice: &mut Dice, target: &Target, name: &str, faces: Option<Choice>) -> ObstacleTable {
    let [low, high] = target.corners;
    let [length, height] = [high[0] - low[0], high[2] - low[2]];
    let shape = dice.one_of(&[ShapeName::Plane, ShapeName::Sphere, ShapeName::Cylinder, ShapeName::Cuboid]);
    let slope: f64 = dice.one_of(&[0.0, -0.05]);
    // An inclined plane rises towards the end of the body.
    let rise = if shape == ShapeName::Plane { 0.5 * slope.abs() * length } else { 0.0 };
    // Or it is to be pressed out of the body.
    let overlaps = dice.chance(0.15);
    let gap = if overlaps { -0.03 * height } else { dice.one_of(&[0.0, 0.02, 0.1]) * height + rise };
    // A point that is deeper in an obstacle than it is from its side leaves it there. Where an edge of a cuboid lies between two points, a body
    // can rest on it or slide past it, and the way there decides: cuboids are wider than twice the distance of the points, so that none falls
    // through between the two sides.
    let least = if shape == ShapeName::Cuboid { 2.0 * target.spacing } else { 0.0 };
    let radius = (dice.between(0.3, 0.8) * height).max(least);
    let is_half = low[1] == 0.0;
    let middle = if is_half { 0.0 } else { 0.5 * (low[1] + high[1]) };
    // On one side of the plane of symmetry, all of it: of a half there are two then. Or cut by it, which a half has to refuse.
    let beside = dice.one_of(&[0.0, 0.0, 0.0, 0.0, 1.05, if is_half { 0.4 } else { -1.1 }]);
    let across = middle + beside * radius;
    let along = low[0] + dice.between(0.5, 0.9) * length;
    let centre = [along, across, low[2] - gap - radius];
    let is_hollow = dice.chance(0.15);
    let is = |shapes: &[ShapeName]| shapes.contains(&shape);
    let is_tube = is_hollow && shape == ShapeName::Cylinder;
    let is_shell = is_hollow && shape == ShapeName::Sphere;
    let inside = [0.5 * (low[0] + high[0]), middle, 0.5 * (low[2] + high[2])];
    let around = (high[1] - middle).hypot(0.5 * height) * 1.02;
    let about = around.hypot(0.5 * length) * 1.02;
    ObstacleTable {
        name: name.to_owned(),
        shape,
        faces,
        point: is(&[ShapeName::Plane, ShapeName::Cylinder]).then_some(match shape {
            ShapeName::Plane => [along, across, low[2] - gap],
            _ if is_tube => [along, middle, inside[2]],
            _ => centre,
        }),
        normal: is(&[ShapeName::Plane]).then_some([slope, 0.0, 2.0]),
        centre: is(&[ShapeName::Sphere, ShapeName::Cuboid]).then_some(if is_shell { inside } else { centre }),
        axis: is(&[ShapeName::Cylinder]).then_some(match beside {
            _ if is_tube => [1.0, 0.0, 0.0],
            0.0 => [0.0, 2.0, 0.0],
            _ => [1.0, 0.0, 0.0],
        }),
        radius: match shape {
            ShapeName::Sphere | ShapeName::Cylinder if is_tube => Some(around),
            ShapeName::Sphere if is_shell => Some(about),
            ShapeName::Sphere | ShapeName::Cylinder => Some(radius),
            ShapeName::Plane | ShapeName::Cuboid => None,
        },
        hollow: (is_tube || is_shell).then_some(true),
        size: is(&[ShapeName::Cuboid]).then_some([radius, 2.0 * radius, 2.0 * radius]),
        edge_radius: is(&[ShapeName::Cuboid]).then_some(0.2 * radius),
        stiffness: dice.maybe(0.6, |dice| dice.between(1.0, 6.0)),
        penetration_tolerance: dice.maybe(0.1, |_| 0.01),
        displacement: None,
        factor: None,
        interference: overlaps.then_some(true),
        report_force: dice.maybe(0.2, |dice| dice.chance(0.7)),
    }
}

fn box_of(actuator: &Actuator) -> [[f64; 3]; 2] {
    let half = 0.5 * actuator.width;
    let low = if actuator.part == Part::Half { 0.0 } else { -half };
    [[0.0, low, 0.0], [actuator.length(), half, actuator.height]]
}

fn title(dice: &mut Dice) -> String {
    if dice.chance(0.5) { "a \"drawn\" problem".to_owned() } else { String::new() }
}

/// Longest edge of an element of an actuator's mesh, mm.
fn edge(mesh: &MeshOptions) -> f64 {
    match mesh.size {
        Some(Size::Uniform(edge)) => edge,
        Some(Size::PerAxis(edges)) => edges.into_iter().fold(0.0, f64::max),
        None => 0.0,
    }
}

fn probes(dice: &mut Dice, [low, high]: [[f64; 3]; 2]) -> Vec<Probe> {
    let count = dice.one_of(&[0, 1, 2]);
    // Nowhere halfway between two nodes: a probe shows the nearest one, and of two that are as near rounding, or their order in the file,
    // chooses. Which of the two it is the results say; it is not the same in a turned mesh.
    let at = |x: f64| std::array::from_fn(|d| low[d] + [x, 0.61, 0.13][d] * (high[d] - low[d]));
    (0..count).map(|i| Probe { name: format!("probe {i}"), at: at(0.97 - 0.53 * f64::from(i)) }).collect()
}

/// Pressures of their own, where no channel joins the chambers.
fn chamber_factor(dice: &mut Dice, actuator: &Actuator) -> Option<PerChamber> {
    if actuator.has_channel() || dice.chance(0.4) {
        return None;
    }
    let mut list = vec![1.0];
    list.extend((1..actuator.chambers).map(|_| dice.one_of(&[1.0, 0.5, 0.0, -0.3])));
    Some(if dice.chance(0.2) { 0.7.into() } else { list.into() })
}

fn case(dice: &mut Dice, scale: Scale) -> Case {
    let actuator = actuator(dice);
    let material = material(dice);
    let last = 1e3 * material.shear_modulus() * dice.between(0.005, 0.03);
    let method = dice.one_of(&[
        ContactMethod::MultiPoint,
        ContactMethod::Mortar,
        ContactMethod::SinglePoint,
        ContactMethod::None,
    ]);
    let is_multi_point = matches!(method, ContactMethod::MultiPoint | ContactMethod::Mortar);
    let stiffness = match dice.chance(0.5) {
        true => Contact::of_actuator(&material, &actuator).stiffness,
        false => dice.between(1.0, 5.0),
    };
    let extent = box_of(&actuator);
    let mesh = mesh_options(dice, scale);
    let target = Target::new(extent, edge(&mesh));
    let count = dice.one_of(&[0, 0, 1]);
    let faces = dice.one_of(&[None, Some("bottom".to_owned()), Some("outer".to_owned())]);
    let mut case = Case {
        title: title(dice),
        mesh,
        material,
        contact: Contact {
            method,
            stiffness,
            two_pass: is_multi_point && dice.chance(0.3),
            self_contact: is_multi_point && dice.chance(0.2),
            penetration_tolerance: dice.maybe(0.1, |_| 0.01),
        },
        obstacles: (0..count)
            .map(|i| obstacle(dice, &target, &format!("obstacle {i}"), faces.clone().map(Choice::from)))
            .collect(),
        load: Load {
            pressure_kpa: if dice.chance(0.5) { vec![last] } else { vec![0.5 * last, last] },
            chamber_factor: chamber_factor(dice, &actuator),
        },
        probes: probes(dice, extent),
        solver: Solver {
            tolerance: TOLERANCE,
            residual_tolerance: TOLERANCE,
            max_iterations: 30,
            first_step: 0.3 * last,
            max_step: last,
            min_step: 1e-4 * last,
            continuation: Continuation::Load,
            states_past_limit: 4,
            imperfection: None,
        },
        output: output(dice),
        actuator,
    };
    // As often as there are no fields.
    if !case.output.fields {
        let has_one = case.load.pressure_kpa.len() == 1;
        case.solver.continuation = if has_one { Continuation::ArcLength } else { Continuation::Damped };
    }
    case
}

fn output(dice: &mut Dice) -> Output {
    let fields = dice.chance(0.8);
    // An estimate changes nothing of what it is of.
    Output { fields, points: fields && dice.chance(0.2), error_estimate: false }
}

fn actuator_model(dice: &mut Dice, scale: Scale) -> Model {
    let actuator = actuator(dice);
    let material = material(dice);
    let times = times(dice);
    let end = times[times.len() - 1];
    let stiffness = material.shear_modulus();
    let extent = box_of(&actuator);
    let layer = [[0.0, -99.0, 0.0], [999.0, 99.0, 0.4 * actuator.base]];
    let solid = (actuator.length(), actuator.width * actuator.height);
    let has_air = dice.chance(0.85);
    let count = dice.one_of(&[0, 0, 1]);
    let mesh = mesh_options(dice, scale);
    let target = Target::new(extent, edge(&mesh));
    let first_gap = (1..actuator.chambers).find(|gap| actuator.gap.at(gap - 1) > 0.0);
    // Without a channel every chamber may have air of its own.
    let has_own_air = !actuator.has_channel() && dice.chance(0.6);
    let cavities = match (has_air, has_own_air) {
        (false, _) => Vec::new(),
        (true, false) => vec![cavity(dice, "cavity", stiffness, 0.3 * solid.0 * solid.1, end)],
        (true, true) => (1..=actuator.chambers)
            .map(|i| {
                let volume = 0.3 * solid.0 * solid.1 / actuator.chambers as f64;
                let table = cavity(dice, &format!("cavity_{i}"), stiffness, volume, end);
                CavityTable { name: format!("chamber {i}"), ..table }
            })
            .collect(),
    };
    let mut model = Model {
        title: title(dice),
        model: None,
        mesh,
        regions: dice
            .maybe(0.25, |dice| RegionTable {
                name: "layer".into(),
                elements: None,
                within: Some(layer),
                material: other_material(dice, &material),
            })
            .into_iter()
            .collect(),
        supports: Vec::new(),
        equations: Vec::new(),
        cavities,
        // Less than what buckles it: beyond, an actuator that is pushed along its axis has an equilibrium to either side, and rounding chooses.
        forces: forces(dice, "end_face", 0.1 * stiffness * solid.1, end),
        tractions: tractions(dice, "end_face", stiffness, end),
        pressures: pressures(dice, "bottom", stiffness, end),
        gravity: gravity(dice, &material, end),
        contacts: Vec::new(),
        obstacles: (0..count)
            .map(|i| {
                let table = obstacle(dice, &target, &format!("obstacle {i}"), Some("bottom".into()));
                moved(dice, table, 0.1 * actuator.height, end)
            })
            .collect(),
        load: Some(Times { times }),
        probes: probes(dice, extent),
        solver: steps(dice, end),
        output: output(dice),
        material: if dice.chance(0.8) { Some(material) } else { None },
        actuator: Some(actuator),
    };
    // How stiffly the walls of the first gap are kept apart.
    if let Some(gap) = first_gap {
        let [left, right] = ["left", "right"].map(|side| format!("gap_{gap}_{side}"));
        model.contacts = dice.maybe(0.3, |dice| contact_table(dice, &left, &right)).into_iter().collect();
    }
    model
}

/// An obstacle of a model file, which may move up by a length.
fn moved(dice: &mut Dice, table: ObstacleTable, up: f64, end: f64) -> ObstacleTable {
    if table.hollow == Some(true) || dice.chance(0.4) {
        return table;
    }
    ObstacleTable { displacement: Some([0.0, 0.0, up]), factor: factor(dice, end), ..table }
}

fn cavity(dice: &mut Dice, faces: &str, shear_modulus: f64, volume: f64, end: f64) -> CavityTable {
    let pressure = 1e3 * shear_modulus * dice.between(0.004, 0.02);
    let pumped = volume * dice.between(0.002, 0.01);
    let control = dice.one_of(&["pressure", "volume", "gas"]);
    let amount = dice.between(1.02, 1.08);
    let values = match control {
        "gas" if dice.chance(0.5) => Series::End(amount),
        "gas" => Series::Points(vec![[0.0, 1.0], [end, amount]]),
        "volume" => series(dice, pumped, end),
        _ => series(dice, pressure, end),
    };
    let of = |name: &str| (control == name).then(|| values.clone());
    CavityTable {
        name: "air".into(),
        faces: faces.into(),
        pressure_kpa: of("pressure"),
        volume_mm3: of("volume"),
        gas: of("gas"),
        atmosphere_kpa: dice.one_of(&[101.325, 50.0]),
        exponent: dice.one_of(&[1.0, 1.4]),
    }
}

/// Something along y, which a half has to refuse, now and then.
fn across(dice: &mut Dice) -> f64 {
    if dice.chance(0.15) { dice.one_of(&[-0.003, 0.002]) } else { 0.0 }
}

fn forces(dice: &mut Dice, nodes: &str, strength: f64, end: f64) -> Vec<ForceTable> {
    let table = |dice: &mut Dice| ForceTable {
        nodes: nodes.into(),
        total: [dice.between(-0.02, 0.02), across(dice), dice.between(-0.004, 0.004)].map(|x| x * strength),
        factor: factor(dice, end),
    };
    dice.maybe(0.35, table).into_iter().collect()
}

fn tractions(dice: &mut Dice, faces: &str, shear_modulus: f64, end: f64) -> Vec<TractionTable> {
    let table = |dice: &mut Dice| TractionTable {
        faces: faces.into(),
        traction_mpa: [dice.between(-0.01, 0.01), across(dice), dice.between(-0.004, 0.004)].map(|x| x * shear_modulus),
        factor: factor(dice, end),
    };
    dice.maybe(0.3, table).into_iter().collect()
}

fn pressures(dice: &mut Dice, faces: &str, shear_modulus: f64, end: f64) -> Vec<PressureTable> {
    let table = |dice: &mut Dice| {
        let pressure = 1e3 * shear_modulus * dice.between(-0.01, 0.01);
        PressureTable { faces: faces.into(), pressure_kpa: series(dice, pressure, end) }
    };
    dice.maybe(0.25, table).into_iter().collect()
}

fn gravity(dice: &mut Dice, material: &Material, end: f64) -> Option<GravityTable> {
    let probability = if material.density > 0.0 { 0.5 } else { 0.03 };
    // A hundred times the earth's, to be felt.
    dice.maybe(probability, |dice| GravityTable {
        acceleration: [dice.one_of(&[0.0, 1e5]), 1e8 * across(dice), -9.81e5],
        factor: factor(dice, end),
    })
}

/// A block, with or without a hole, as a half or a whole.
fn block_model(dice: &mut Dice, scale: Scale) -> Draw {
    let formulation = dice.one_of(&Formulation::ALL);
    let is_half = dice.chance(0.6);
    let is_quadratic = formulation.element.is_quadratic();
    // A hole asks for three cells along every axis, two of them for five along the first.
    let has_hole = dice.chance(0.6) && (scale == Scale::Small || !is_quadratic);
    let holes = if has_hole { dice.one_of(&[1, 1, 2]) } else { 0 };
    let size = [dice.between(6.0, 12.0), dice.between(3.0, 5.0), dice.between(3.0, 6.0)];
    let low = [0.0, if is_half { 0.0 } else { -size[1] }, 0.0];
    let high = [size[0], size[1], size[2]];
    let across = match (is_half, is_quadratic) {
        (true, _) => 2,
        (false, true) => 3,
        (false, false) => 4,
    };
    let mut cells = if has_hole { [1 + 2 * holes, across, 3] } else { [3, 1, 1] };
    if scale == Scale::Tiny && is_quadratic {
        cells = [2, 1, 1];
    }
    if scale == Scale::Small && !is_quadratic && holes < 2 {
        cells = cells.map(|n| 2 * n);
    }
    // A slot, whose walls meet under a load.
    let is_slot = has_hole && dice.chance(0.3);
    // Every third body of such hexahedra has wedges in the place of some.
    let is_mixed = formulation == Formulation::Hex27 && dice.chance(0.35);
    let mesh = block(formulation, [low, high], cells, holes, (is_half, is_slot, is_mixed));
    let edges: [f64; 3] = std::array::from_fn(|d| (high[d] - low[d]) / cells[d] as f64);
    let target = Target::new([low, high], edges[0].max(edges[1]));
    let material = material(dice);
    let (modulus, times) = (material.shear_modulus(), times(dice));
    let end = times[times.len() - 1];
    let area = (high[1] - low[1]) * size[2];
    let mut supports = vec![support("x0", "xyz", false)];
    if is_half {
        let is_declared = dice.chance(0.85);
        supports.push(support("y0", "y", is_declared));
    }
    if dice.chance(0.25) {
        let displacement =
            [dice.between(-0.06, 0.06) * size[0], 10.0 * self::across(dice), dice.between(-0.05, 0.05) * size[2]];
        let axes = dice.one_of(&["x", "xz", "z", "xyz"]).to_owned();
        let displacement = Some(displacement);
        let factor = factor(dice, end);
        supports.push(SupportTable { nodes: "x1".into(), axes, displacement, factor, symmetry: false });
    }
    let equation = |dice: &mut Dice| EquationTable {
        terms: vec![("tip".into(), "z".into(), 1.0), ("corner".into(), "z".into(), dice.one_of(&[-1.0, -0.5, 2.0]))],
        value: dice.maybe(0.3, |dice| series(dice, 0.02 * size[2], end)),
    };
    let is_on_lines = dice.chance(0.8);
    let third = if is_on_lines { first_part(cells) * size[0] } else { 0.41 * size[0] };
    let region = |dice: &mut Dice| {
        let is_box = dice.chance(0.5);
        RegionTable {
            name: "stiff".into(),
            elements: (!is_box).then(|| "front".into()),
            within: is_box.then_some([[-1.0, -99.0, -1.0], [third, 99.0, 99.0]]),
            material: other_material(dice, &material),
        }
    };
    let contact = |dice: &mut Dice| {
        let [slave, master] = dice.one_of(&[["inner", "inner"], ["roof", "floor"], ["floor", "roof"]]);
        contact_table(dice, slave, master)
    };
    let hole = size[0] * area / 27.0;
    let count = dice.one_of(&[0, 0, 1, 1, 2]);
    let mut model = Model {
        title: title(dice),
        model: Some(Source::of_file("")),
        actuator: None,
        mesh: MeshOptions::default(),
        regions: dice.maybe(0.3, region).into_iter().collect(),
        supports,
        equations: dice.maybe(0.15, equation).into_iter().collect(),
        cavities: if has_hole && dice.chance(0.85) {
            // Pressures beside forces and motions of the same strength; a slot is drawn together by a small vacuum.
            let table = |dice: &mut Dice, name: &str, faces: &str| CavityTable {
                name: name.into(),
                ..cavity(dice, faces, 5.0 * modulus, if is_slot { 0.3 } else { 5.0 } * hole, end)
            };
            match holes {
                2 => vec![table(dice, "air", "hole_0"), table(dice, "other air", "hole_1")],
                _ => vec![table(dice, "air", "inner")],
            }
        } else {
            Vec::new()
        },
        forces: {
            let nodes = dice.one_of(&["x1", "x1", "tip"]);
            forces(dice, nodes, modulus * area * if nodes == "tip" { 0.1 } else { 1.0 }, end)
        },
        tractions: tractions(dice, "z1", modulus, end),
        pressures: match is_slot {
            // Enough to close a slot.
            true => pressures(dice, "z1", 8.0 * modulus, end),
            false => pressures(dice, "z0", modulus, end),
        },
        gravity: gravity(dice, &material, end),
        contacts: if has_hole {
            dice.maybe(if is_slot { 0.9 } else { 0.2 }, contact).into_iter().collect()
        } else {
            Vec::new()
        },
        obstacles: (0..count)
            .map(|i| {
                let table = obstacle(dice, &target, &format!("obstacle {i}"), Some("z0".into()));
                moved(dice, table, 0.15 * size[2], end)
            })
            .collect(),
        load: Some(Times { times }),
        probes: probes(dice, [low, high]),
        solver: steps(dice, end),
        output: output(dice),
        material: Some(material),
    };
    if dice.chance(0.4) {
        by_place(dice, &mut model, [low, high]);
    }
    Draw::Model(Box::new(model), Some(Body { mesh, formulation }))
}

/// Says of some sets of a block where they are instead of their names: the same faces, nodes and elements.
fn by_place(dice: &mut Dice, model: &mut Model, [low, high]: [[f64; 3]; 2]) {
    let direction = |v: [f64; 3]| Some(Direction(v));
    let conditions = Conditions::default;
    let x0 = Plane { point: [low[0], 1.0, 2.0], normal: Direction([-1.0, 0.0, 0.0]) };
    let everything = Ball { centre: high, radius: 99.0 };
    let not = |name: &str| Choice::from(Conditions { not: Some(name.into()), ..conditions() });
    let either = |one: &str, other: &str| Conditions { or: Some(vec![one.into(), other.into()]), ..conditions() };
    let mut change = |choice: &mut Choice| {
        let placed = match choice.name() {
            Some("x0") => Conditions { plane: Some(x0), ..conditions() },
            Some("x1") => Conditions {
                within: Some([[high[0], -99.0, -99.0], [high[0], 99.0, 99.0]]),
                normal: direction([1.0, 0.0, 0.0]),
                angle: Some(5.0),
                tolerance: Some(1e-4),
                ..conditions()
            },
            Some("z1") => {
                let near = [0.5 * (low[0] + high[0]), 0.5 * high[1], high[2]];
                Conditions { near: Some(near), ..conditions() }
            }
            Some("z0") => Conditions { and: Some(vec![either("z0", "z1").into(), not("z1")]), ..conditions() },
            Some("front") => Conditions { sphere: Some(everything), and: Some(vec!["front".into()]), ..conditions() },
            _ => return,
        };
        if dice.chance(0.7) {
            *choice = placed.into();
        }
    };
    model.regions.iter_mut().filter_map(|region| region.elements.as_mut()).for_each(&mut change);
    model.supports.iter_mut().for_each(|support| change(&mut support.nodes));
    model.forces.iter_mut().for_each(|force| change(&mut force.nodes));
    model.tractions.iter_mut().for_each(|traction| change(&mut traction.faces));
    model.pressures.iter_mut().for_each(|pressure| change(&mut pressure.faces));
    model.obstacles.iter_mut().filter_map(|obstacle| obstacle.faces.as_mut()).for_each(&mut change);
}

fn contact_table(dice: &mut Dice, slave: &str, master: &str) -> ContactTable {
    let method = dice.maybe(0.6, |dice| dice.one_of(&[ContactMethod::MultiPoint, ContactMethod::Mortar]));
    ContactTable {
        slave: slave.into(),
        master: master.into(),
        // Refused where a surface meets itself.
        method: method.filter(|method| slave != master || *method != ContactMethod::Mortar),
        stiffness: dice.maybe(0.6, |dice| dice.between(1.0, 6.0)),
        penetration_tolerance: dice.maybe(0.2, |_| 0.01),
        two_pass: dice.chance(0.3),
        interference: dice.chance(0.2),
    }
}

fn support(nodes: &str, axes: &str, symmetry: bool) -> SupportTable {
    SupportTable { nodes: nodes.into(), axes: axes.into(), displacement: None, factor: None, symmetry }
}

/// About a third of a body's length, a whole number of its cells, as a share of it.
fn first_part(cells: [usize; 3]) -> f64 {
    (cells[0] / 3).max(1) as f64 / cells[0] as f64
}

/// A block with holes one behind the other, which slots have hardly any height in the middle cells.
fn block(
    formulation: Formulation,
    [low, high]: [[f64; 3]; 2],
    cells: [usize; 3],
    holes: usize,
    (is_half, is_slot, is_mixed): (bool, bool, bool),
) -> Mesh {
    let mut lattice = Lattice::uniform(low, high, cells);
    let wall = |d: usize| if d == 0 { cells[0] / (1 + 2 * holes) } else { (cells[d] / 3).max(1) };
    // Which hole a cell lies in.
    let hole_of = |cell: [usize; 3]| {
        let is_within = holes > 0
            && (1..3).all(|d| {
                let first = if d == 1 && is_half { 0 } else { wall(d) };
                (first..cells[d] - wall(d)).contains(&cell[d])
            });
        let part = cell[0] / wall(0).max(1);
        (is_within && part % 2 == 1 && part < 1 + 2 * holes).then_some(part / 2)
    };
    if is_slot {
        let (first, last) = (wall(2), cells[2] - wall(2));
        let middle = 0.5 * (low[2] + high[2]);
        for plane in &mut lattice.lines[2][first..=last] {
            *plane = middle + 0.1 * (*plane - middle);
        }
    }
    let of_family = |kind| lattice.mesh(kind, |cell| hole_of(cell).is_none()).mesh;
    let mut mesh = of_family(formulation.element);
    if is_mixed {
        let first = lattice.lines[0][1];
        mesh = mixed(&mesh, &of_family(ElementKind::Wedge21), |x| x[0] < first);
    }
    let sides = ["x0", "x1", "y0", "y1", "z0", "z1"];
    let boundary = mesh.boundary_facets();
    let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
    let side_of = |mesh: &Mesh, facet: Facet| {
        let nodes = mesh.facet_nodes(facet);
        let lies = |d: usize, at: f64| nodes.iter().all(|&node| close(mesh.nodes[node as usize][d], at));
        (0..6).find(|side| lies(side / 2, if side % 2 == 0 { low[side / 2] } else { high[side / 2] }))
    };
    for facet in boundary {
        let side = side_of(&mesh, facet);
        let mut names = vec![side.map_or("inner", |side| sides[side]).to_owned()];
        if side.is_none() {
            let corners = mesh.facet_nodes(facet);
            let mean =
                |d: usize| corners.iter().map(|&n| mesh.nodes[n as usize][d]).sum::<f64>() / corners.len() as f64;
            let part = (mean(0) - low[0]) / (high[0] - low[0]) * holes as f64;
            names.push(format!("hole_{}", part as usize));
            let z = mesh.nodes[corners[0] as usize][2];
            if corners.iter().all(|&node| close(mesh.nodes[node as usize][2], z)) {
                names.push(if z < 0.5 * (low[2] + high[2]) { "floor" } else { "roof" }.to_owned());
            }
        }
        for name in names {
            mesh.facet_sets.entry(name).or_default().push(facet);
        }
        if side.is_some_and(|side| side != 0 && !(is_half && side == 2)) {
            mesh.facet_sets.entry("outer".into()).or_default().push(facet);
        }
    }
    let first_third = low[0] + first_part(cells) * (high[0] - low[0]);
    let in_front = |element: &u32| {
        let nodes = mesh.corners(*element as usize);
        nodes.iter().map(|&node| mesh.nodes[node as usize][0]).sum::<f64>() / (nodes.len() as f64) < first_third
    };
    let front = (0..mesh.num_elements() as u32).filter(in_front).collect();
    mesh.element_sets.insert("front".into(), front);
    for (name, z) in [("tip", low[2]), ("corner", high[2])] {
        let y = if is_half { 0.0 } else { high[1] };
        let node = mesh.select_nodes(|x| close(x[0], high[0]) && close(x[1], y) && close(x[2], z));
        mesh.node_sets.insert(name.into(), node);
    }
    mesh
}
