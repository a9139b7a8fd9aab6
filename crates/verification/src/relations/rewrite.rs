//! The relations: each rewrites a problem into another one, and says how closely the two must agree and why.
//!
//! Equilibria are found to 10⁻¹⁰ mm, N (the drawn solver keys), so that what is the same problem agrees far better than the tolerances here;
//! these leave room for sums in another order and for stiff bodies, whose equations lose digits.

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use pneuflex::mesh::{Actuator, Part, PerChamber, ReferenceBody};
use pneuflex::model::model_file::{
    CavityTable, ContactTable, ForceTable, Model, PressureTable, RegionTable, Series, Source, Steps, SupportTable,
    Times, TractionTable,
};
use pneuflex::model::{Case, Contact, Formulation, MeshOptions, ObstacleTable, Problem, ShapeName};
use pneuflex::post::measures;
use pneuflex::{Analysis, Change, Error, Event, StopToken, Study};

use super::draw::{Body, Dice, Draw, Scale};
use super::form::{Files, Form};
use super::frame::Frame;
use super::meshes;
use super::outcome::{End, IMAGE, Measure, Outcome, Rule, Verdict, compare, limited};
use super::whole_deck;

/// The same equations in another order of their sums.
const SAME: f64 = 1e-6;

/// The same equilibrium on another path or with other equations for it.
const SAME_STATE: f64 = 1e-5;

/// A relation: its name, and what rewrites and compares.
pub struct Relation {
    /// In a few words.
    pub name: &'static str,
    /// `None` for a problem that it says nothing of.
    pub check: fn(&First<'_>, &mut Dice) -> Option<Checked>,
}

/// A problem with what became of it.
pub struct First<'a> {
    /// The problem.
    pub draw: &'a Draw,
    /// Built from its text.
    pub analysis: &'a Result<Analysis, Error>,
    /// Solved so.
    pub outcome: &'a Outcome,
}

/// What was found, and the files of the rewritten problem.
pub struct Checked {
    /// Whether it holds.
    pub verdict: Verdict,
    /// The second problem; none if it has the text of the first.
    pub files: Files,
}

/// All relations.
pub const ALL: [Relation; 21] = [
    Relation { name: "text and memory", check: in_memory },
    Relation { name: "text and deck", check: as_deck },
    Relation { name: "text and mesh of Gmsh in m", check: as_gmsh },
    Relation { name: "model and whole deck", check: as_whole_deck },
    Relation { name: "text and resolved text", check: resolved },
    Relation { name: "case and model", check: case_as_model },
    Relation { name: "actuator and its mesh", check: actuator_as_mesh },
    Relation { name: "number and equal entries", check: number_as_list },
    Relation { name: "air in common and in chambers", check: air_of_chambers },
    Relation { name: "half and whole", check: half_as_whole },
    Relation { name: "half that stands for no whole", check: refused_half },
    Relation { name: "turned by 90 degrees", check: turned },
    Relation { name: "mirrored", check: mirrored },
    Relation { name: "other units", check: scaled },
    Relation { name: "times renumbered", check: renumbered },
    Relation { name: "loads split in two", check: split },
    Relation { name: "set in any order", check: set_in_any_order },
    Relation { name: "obstacle moved or support", check: carried_along },
    Relation { name: "pressure, volume, gas", check: other_fluid },
    Relation { name: "elements within their errors", check: other_element },
    Relation { name: "threads and resumed", check: on_the_machine },
];

/// By what small numbers of a problem are measured.
fn measure(analysis: &Result<Analysis, Error>) -> Measure {
    analysis.as_ref().map_or(Measure { extent: 1.0, modulus: 1.0 }, |analysis| Measure {
        extent: analysis.problem.mesh.extent(),
        modulus: analysis.problem.material.shear_modulus(),
    })
}

impl First<'_> {
    fn against(&self, second: &Draw, rule: &Rule) -> Option<Checked> {
        self.in_form(second, Form::Text, rule)
    }

    fn in_form(&self, second: &Draw, form: Form, rule: &Rule) -> Option<Checked> {
        let outcome = Outcome::of(&second.analysis(form)?);
        let verdict = compare(self.outcome, &outcome, rule, measure(self.analysis));
        Some(Checked { verdict, files: second.files(form).unwrap_or_default() })
    }

    /// The model with its mesh, if it has one.
    fn block(&self) -> Option<(&Model, &Body)> {
        match self.draw {
            Draw::Model(model, Some(body)) => Some((model, body)),
            _ => None,
        }
    }

    fn problem(&self) -> Option<&Problem> {
        self.analysis.as_ref().ok().map(|analysis| &analysis.problem)
    }
}

fn model(model: Model, body: Option<&Body>) -> Draw {
    Draw::Model(Box::new(model), body.cloned())
}

/// A body of nodes and cells in memory is that of the file that they are recorded in: the same numbers, so the same results to the last bit.
fn in_memory(first: &First<'_>, _: &mut Dice) -> Option<Checked> {
    first.in_form(first.draw, Form::Memory, &Rule::same(0.0))
}

/// A deck's numbers are written with all their digits: the same mesh. Its sets may come in another order.
fn as_deck(first: &First<'_>, _: &mut Dice) -> Option<Checked> {
    first.in_form(first.draw, Form::Deck, &Rule::same(SAME))
}

/// Nodes in metres and `scale = 1000`: rounded in their last digit.
fn as_gmsh(first: &First<'_>, _: &mut Dice) -> Option<Checked> {
    first.in_form(first.draw, Form::Gmsh, &Rule::same(SAME))
}

/// A deck says supports, equations, forces, pressures, weight, contact and materials in its own words, in its own units of density and pressure.
/// What it has no words for is left out of both. It has the default tolerances.
fn as_whole_deck(first: &First<'_>, _: &mut Dice) -> Option<Checked> {
    let (old, body) = first.block()?;
    let (old, deck) = whole_deck::both(old, body)?;
    let draw = model(old, Some(body));
    let analysis = draw.analysis(Form::Text)?;
    let outcome = Outcome::of(&analysis);
    let files = vec![("draw.inp".to_owned(), deck.into_bytes())];
    let other = Study::from_files("draw.inp", files.clone()).and_then(|study| study.build());
    // Reactions of a deck's supports have names of their own.
    let rule = Rule { has_supports: false, ..Rule::same(SAME_STATE) };
    let verdict = compare(&outcome, &Outcome::of(&other), &rule, measure(&analysis));
    Some(Checked { verdict, files })
}

/// Every default written out changes nothing: the same problem to the last bit.
fn resolved(first: &First<'_>, _: &mut Dice) -> Option<Checked> {
    first.in_form(first.draw, Form::Resolved, &Rule::same(0.0))
}

/// A case file is the model file of its actuator with one cavity whose pressure in kPa is the time.
fn case_as_model(first: &First<'_>, _: &mut Dice) -> Option<Checked> {
    let Draw::Case(case) = first.draw else { return None };
    let contact = Contact::of_actuator(&case.material, &case.actuator);
    let with_default = Case { contact, ..(**case).clone() };
    let end = case.load.pressure_kpa.last().copied()?;
    let chambers = case.actuator.chambers;
    let Case { title, actuator, mesh, material, contact: _, obstacles, load, probes, solver, output } =
        with_default.clone();
    let second = Model {
        title,
        actuator: Some(actuator),
        mesh,
        material: Some(material),
        cavities: match &load.chamber_factor {
            None => vec![pressure("air", "cavity", end)],
            Some(factor) => (0..chambers)
                .map(|i| format!("cavity_{}", i + 1))
                .enumerate()
                .map(|(i, name)| pressure(&name, &name, factor.at(i) * end))
                .collect(),
        },
        obstacles,
        load: Some(Times { times: load.pressure_kpa }),
        probes,
        solver: Steps {
            tolerance: Some(solver.tolerance),
            residual_tolerance: Some(solver.residual_tolerance),
            max_iterations: Some(solver.max_iterations),
            first_step: Some(solver.first_step),
            max_step: Some(solver.max_step),
            min_step: Some(solver.min_step),
            continuation: Some(solver.continuation),
            states_past_limit: Some(solver.states_past_limit),
            imperfection: solver.imperfection,
        },
        output,
        ..Model::default()
    };
    let analysis = Draw::Case(Box::new(with_default.clone())).analysis(Form::Text)?;
    let outcome = Outcome::of(&analysis);
    let first = First { draw: &Draw::Case(Box::new(with_default)), analysis: &analysis, outcome: &outcome };
    first.against(&model(second, None), &Rule::same(SAME))
}

fn pressure(name: &str, faces: &str, value: f64) -> CavityTable {
    CavityTable {
        name: name.into(),
        faces: faces.into(),
        pressure_kpa: Some(Series::End(value)),
        volume_mm3: None,
        gas: None,
        atmosphere_kpa: 101.325,
        exponent: 1.0,
    }
}

/// An actuator is its mesh with the clamp, the plane of symmetry and the contact in its gaps said in words.
fn actuator_as_mesh(first: &First<'_>, _: &mut Dice) -> Option<Checked> {
    let (Draw::Model(actuator, None), problem) = (first.draw, first.problem()?) else { return None };
    let support = |nodes: &str, axes: &str, symmetry| SupportTable {
        nodes: nodes.into(),
        axes: axes.into(),
        displacement: None,
        factor: None,
        symmetry,
    };
    let mut supports = vec![support("clamp", "xyz", false)];
    if !problem.symmetry.is_empty() {
        supports.push(support("symmetry", "y", true));
    }
    let chambers = actuator.actuator.as_ref()?.chambers;
    let has_walls = |i: &usize| problem.mesh.facet_sets.contains_key(&format!("gap_{i}_left"));
    // A table of a gap says of it what there is to say.
    let gap = |i: usize| ContactTable {
        slave: format!("gap_{i}_left").into(),
        master: format!("gap_{i}_right").into(),
        method: Some(problem.contact.method),
        stiffness: Some(problem.contact.stiffness),
        penetration_tolerance: problem.contact.penetration_tolerance,
        two_pass: false,
        interference: false,
    };
    let is_said = |gap: &ContactTable| actuator.contacts.iter().any(|said| said.slave == gap.slave);
    let contacts = actuator.contacts.iter().cloned().map(|mut table| {
        // Without them an actuator's gaps have other defaults than surfaces of a mesh.
        table.method = table.method.or(Some(problem.contact.method));
        table.stiffness = table.stiffness.or(Some(problem.contact.stiffness));
        table
    });
    let mut obstacles = actuator.obstacles.clone();
    for (table, solved) in obstacles.iter_mut().zip(&problem.obstacles) {
        table.stiffness = Some(solved.stiffness);
        table.faces.get_or_insert_with(|| "outer".into());
    }
    let second = Model {
        model: Some(Source::of_file("")),
        actuator: None,
        mesh: MeshOptions::default(),
        material: Some(problem.material.clone()),
        supports: supports.into_iter().chain(actuator.supports.clone()).collect(),
        contacts: (1..chambers).filter(has_walls).map(gap).filter(|gap| !is_said(gap)).chain(contacts).collect(),
        obstacles,
        ..(**actuator).clone()
    };
    let body = Body { mesh: (*problem.mesh).clone(), formulation: problem.formulation };
    // Warnings of an actuator go by its walls, those of a mesh by its elements.
    let rule = Rule { has_same_warnings: false, ..Rule::same(SAME) };
    first.against(&model(second, Some(&body)), &rule)
}

/// A number is a list of as many equal entries, and the other way round: the same mesh and the same equations, to the last bit.
fn number_as_list(first: &First<'_>, _: &mut Dice) -> Option<Checked> {
    let other = |value: &mut PerChamber, count: usize| {
        *value = match value {
            PerChamber::All(number) => vec![*number; count].into(),
            PerChamber::Each(_) => value.common().map_or_else(|| value.clone(), PerChamber::from),
        };
    };
    let rewrite = |actuator: &mut Actuator| {
        let n = actuator.chambers;
        other(&mut actuator.chamber_length, n);
        other(&mut actuator.cavity_length, n);
        other(&mut actuator.gap, n - 1);
        other(&mut actuator.side_wall, n);
        other(&mut actuator.top_wall, n);
    };
    let second = match first.draw {
        Draw::Case(case) => {
            let mut case = case.clone();
            rewrite(&mut case.actuator);
            let n = case.actuator.chambers;
            case.load.chamber_factor.iter_mut().for_each(|factor| other(factor, n));
            Draw::Case(case)
        }
        Draw::Model(old, None) => {
            let mut new = old.clone();
            rewrite(new.actuator.as_mut()?);
            Draw::Model(new, None)
        }
        Draw::Model(_, Some(_)) => return None,
    };
    first.against(&second, &Rule::same(0.0))
}

/// Where no channel joins the chambers, air of one pressure in all of them is air of that pressure in each.
fn air_of_chambers(first: &First<'_>, _: &mut Dice) -> Option<Checked> {
    let Draw::Case(case) = first.draw else { return None };
    if case.actuator.has_channel() || case.load.chamber_factor.is_some() {
        return None;
    }
    let mut second = case.clone();
    second.load.chamber_factor = Some(1.0.into());
    first.against(&Draw::Case(second), &Rule::same(SAME))
}

/// What is symmetric moves symmetrically (away from bifurcations): the half with its plane held is the whole, whose loads are twice those of
/// the half.
fn half_as_whole(first: &First<'_>, _: &mut Dice) -> Option<Checked> {
    let rule = Rule { has_same_warnings: false, may_lose_symmetry: true, ..Rule::same(SAME) };
    match first.draw {
        Draw::Case(case) => {
            let mut second = Case { obstacles: both_sides(&case.obstacles)?, ..(**case).clone() };
            // Tetrahedra and wedges divide the other half as the first one, not as its mirror image.
            let is_mirrored = case.mesh.formulation().element.body == ReferenceBody::Hexahedron;
            let is_half = std::mem::replace(&mut second.actuator.part, Part::Whole) == Part::Half;
            (is_half && is_mirrored).then(|| first.against(&Draw::Case(Box::new(second)), &rule))?
        }
        Draw::Model(half, None) => {
            let mut second = whole_model(half)?;
            let actuator = second.actuator.as_mut()?;
            let is_mirrored = half.mesh.formulation().element.body == ReferenceBody::Hexahedron;
            let is_half = std::mem::replace(&mut actuator.part, Part::Whole) == Part::Half;
            (is_half && is_mirrored).then(|| first.against(&model(second, None), &rule))?
        }
        Draw::Model(half, Some(body)) => {
            let is_plane = |support: &SupportTable| support.symmetry && support.axes == "y";
            let plane = half.supports.iter().position(is_plane)?;
            let mut second = whole_model(half)?;
            second.supports.remove(plane);
            let body = Body { mesh: meshes::whole(&body.mesh), formulation: body.formulation };
            first.against(&model(second, Some(&body)), &rule)
        }
    }
}

/// What an obstacle is of a half that ends at y = 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Beside {
    /// Its own mirror image.
    Itself,
    /// All of it on the side y > 0: there are two.
    Two,
    /// Cut by the plane, or on the other side.
    Neither,
}

fn beside(table: &ObstacleTable) -> Beside {
    let y = |x: Option<[f64; 3]>| x.map_or(0.0, |x| x[1]);
    let at = match table.shape {
        ShapeName::Plane => y(table.normal),
        ShapeName::Cylinder if y(table.axis) != 0.0 => 0.0,
        ShapeName::Cylinder => y(table.point),
        ShapeName::Sphere | ShapeName::Cuboid => y(table.centre),
    };
    let reach = table.radius.or_else(|| Some(0.5 * table.size?[1])).unwrap_or(f64::INFINITY);
    match at - reach {
        _ if at == 0.0 && y(table.displacement) == 0.0 => Beside::Itself,
        low if low > 0.0 && table.hollow != Some(true) => Beside::Two,
        _ => Beside::Neither,
    }
}

/// Obstacles of the whole for those of a half: what is beside the plane has an image of its own.
fn both_sides(obstacles: &[ObstacleTable]) -> Option<Vec<ObstacleTable>> {
    let mut found = obstacles.to_vec();
    for table in obstacles {
        let other = |x: [f64; 3]| [x[0], -x[1], x[2]];
        match beside(table) {
            Beside::Itself => {}
            Beside::Two => found.push(ObstacleTable {
                name: format!("{}{IMAGE}", table.name),
                point: table.point.map(other),
                centre: table.centre.map(other),
                axis: table.axis.map(other),
                displacement: table.displacement.map(other),
                ..table.clone()
            }),
            Beside::Neither => return None,
        }
    }
    Some(found)
}

/// What has no mirror image is refused by a half, with the remedy: a load across the plane of nodes or faces in it, an obstacle that is cut.
fn refused_half(first: &First<'_>, _: &mut Dice) -> Option<Checked> {
    let crosses = |obstacles: &[ObstacleTable]| obstacles.iter().any(|table| beside(table) == Beside::Neither);
    let is_broken = match first.draw {
        Draw::Case(case) => case.actuator.part == Part::Half && crosses(&case.obstacles),
        Draw::Model(model, body) => {
            let is_half = match (&model.actuator, body) {
                (Some(actuator), _) => actuator.part == Part::Half,
                (None, _) => model.supports.iter().any(|support| support.symmetry),
            };
            let moved = |support: &SupportTable| {
                support.axes.contains('y') && support.displacement.is_some_and(|displacement| displacement[1] != 0.0)
            };
            let is_loaded = model.forces.iter().any(|force| force.total[1] != 0.0)
                || model.tractions.iter().any(|traction| traction.traction_mpa[1] != 0.0)
                || model.gravity.iter().any(|gravity| gravity.acceleration[1] != 0.0)
                || model.supports.iter().any(moved);
            is_half && (is_loaded || crosses(&model.obstacles))
        }
    };
    let verdict = match first.analysis {
        Err(error) if error.to_string().contains("whole") => Verdict::Held(0.0),
        // It has another fault, which is said first.
        Err(_) => Verdict::Refused,
        Ok(_) => Verdict::Broken("something across a plane of symmetry is taken".into(), f64::INFINITY),
    };
    is_broken.then_some(Checked { verdict, files: Vec::new() })
}

/// The tables of the whole for those of the half y ≥ 0; `None` if something is not its own mirror image.
fn whole_model(half: &Model) -> Option<Model> {
    let twice = |series: &Series| match series {
        Series::End(value) => Series::End(2.0 * value),
        Series::Points(points) => Series::Points(points.iter().map(|[t, v]| [*t, 2.0 * v]).collect()),
    };
    let obstacles = both_sides(&half.obstacles)?;
    let mut across = (half.forces.iter().map(|force| force.total[1]))
        .chain(half.tractions.iter().map(|traction| traction.traction_mpa[1]))
        .chain(half.supports.iter().filter_map(|support| Some(support.displacement?[1])))
        .chain(half.gravity.iter().map(|gravity| gravity.acceleration[1]));
    let is_across = across.any(|y| y != 0.0);
    let turns = half.equations.iter().flat_map(|equation| &equation.terms).any(|(_, axis, _)| axis == "y");
    if is_across || turns {
        return None;
    }
    Some(Model {
        forces: (half.forces.iter())
            .map(|force| ForceTable { total: force.total.map(|f| 2.0 * f), ..force.clone() })
            .collect(),
        cavities: (half.cavities.iter())
            .map(|cavity| CavityTable { volume_mm3: cavity.volume_mm3.as_ref().map(twice), ..cavity.clone() })
            .collect(),
        regions: (half.regions.iter())
            .map(|region| {
                let both = |[low, high]: [[f64; 3]; 2]| {
                    let far = low[1].max(high[1]);
                    [[low[0], -far, low[2]], [high[0], far, high[2]]]
                };
                RegionTable { within: region.within.map(both), ..region.clone() }
            })
            .collect(),
        obstacles,
        ..half.clone()
    })
}

fn in_frame(first: &First<'_>, frame: Frame) -> Option<Checked> {
    let (block, body) = first.block()?;
    let body = Body { mesh: frame.mesh(&body.mesh), formulation: body.formulation };
    // Angles are those about y, and hints go by usual lengths and moduli.
    let is_same_size = frame.length == 1.0 && frame.stress == 1.0;
    let rule = Rule { frame, has_angle: false, has_same_warnings: is_same_size, ..Rule::same(SAME) };
    first.against(&model(frame.model(block), Some(&body)), &rule)
}

/// Space has no direction.
fn turned(first: &First<'_>, dice: &mut Dice) -> Option<Checked> {
    let turns = [
        [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
        [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]],
        [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]],
        [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    ];
    in_frame(first, Frame { turn: dice.one_of(&turns), ..Frame::SAME })
}

/// Nor has it a hand.
fn mirrored(first: &First<'_>, dice: &mut Dice) -> Option<Checked> {
    let turns = [
        [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
    ];
    in_frame(first, Frame { turn: dice.one_of(&turns), ..Frame::SAME })
}

/// The equations know no unit: lengths times ℓ and stresses times s give the same shape. Default stiffnesses are rounded to three digits, so
/// that contact without one of its own is left out.
fn scaled(first: &First<'_>, dice: &mut Dice) -> Option<Checked> {
    let (block, _) = first.block()?;
    let has_stiffness = block.obstacles.iter().all(|obstacle| obstacle.stiffness.is_some())
        && block.contacts.iter().all(|contact| contact.stiffness.is_some());
    let length = dice.one_of(&[1e-3, 0.1, 25.4, 1e3]);
    let stress = dice.one_of(&[1e-3, 1.0, 6.894, 1e3]);
    has_stiffness.then(|| in_frame(first, Frame { length, stress, ..Frame::SAME }))?
}

/// Time is a name for the places on the load path.
fn renumbered(first: &First<'_>, dice: &mut Dice) -> Option<Checked> {
    let Draw::Model(old, body) = first.draw else { return None };
    let frame = Frame { time: dice.one_of(&[0.01, 3.7, 60.0]), ..Frame::SAME };
    let rule = Rule { frame, ..Rule::same(SAME) };
    first.against(&model(frame.model(old), body.as_ref()), &rule)
}

/// Loads add up.
fn split(first: &First<'_>, dice: &mut Dice) -> Option<Checked> {
    let Draw::Model(old, body) = first.draw else { return None };
    if old.forces.is_empty() && old.tractions.is_empty() && old.pressures.is_empty() {
        return None;
    }
    let share = dice.one_of(&[0.3, 1.5]);
    let parts = [share, 1.0 - share];
    let times = |series: &Series, part: f64| match series {
        Series::End(value) => Series::End(part * value),
        Series::Points(points) => Series::Points(points.iter().map(|[t, v]| [*t, part * v]).collect()),
    };
    let force =
        |force: &ForceTable| parts.map(|part| ForceTable { total: force.total.map(|f| part * f), ..force.clone() });
    let traction = |traction: &TractionTable| {
        parts.map(|part| TractionTable { traction_mpa: traction.traction_mpa.map(|t| part * t), ..traction.clone() })
    };
    let pressure = |pressure: &PressureTable| {
        parts.map(|part| PressureTable { pressure_kpa: times(&pressure.pressure_kpa, part), ..pressure.clone() })
    };
    let second = Model {
        forces: old.forces.iter().flat_map(force).collect(),
        tractions: old.tractions.iter().flat_map(traction).collect(),
        pressures: old.pressures.iter().flat_map(pressure).collect(),
        ..(**old).clone()
    };
    first.against(&model(second, body.as_ref()), &Rule::same(SAME))
}

/// What a key is set to does not depend on when another one is set.
fn set_in_any_order(first: &First<'_>, dice: &mut Dice) -> Option<Checked> {
    let files = first.draw.files(Form::Text)?;
    // Values come from other draws.
    let other = (0..).map(|_| Draw::new(dice, Scale::Tiny)).find(|other| other.kind() == first.draw.kind())?;
    let other = String::from_utf8_lossy(&other.files(Form::Text)?[0].1).into_owned();
    let mut changes = Vec::new();
    flatten(&other.parse::<toml::Table>().ok()?, "", &mut changes);
    changes.retain(|change| !change.key.starts_with("model."));
    if first.draw.kind() != "block" {
        changes.push(Change::new("actuator.top_wall[1]", "1.7"));
        changes.push(Change::new("actuator.gap[1]", "0.8"));
    }
    changes.push(Change::new("mesh.resolution", "draft"));
    changes.push(Change::new("mesh.element", "hex8-q1p0"));
    let mut chosen: Vec<Change> = Vec::new();
    for _ in 0..dice.one_of(&[2, 3, 4]) {
        let change = dice.one_of(&changes);
        if chosen.iter().all(|known| known.key != change.key) {
            chosen.push(change);
        }
    }
    let apply = |changes: Vec<Change>| -> Result<Analysis, Error> {
        let mut study = Study::from_files(&files[0].0, files.clone())?;
        study.set_all(changes)?;
        study.build()
    };
    let one = apply(chosen.clone());
    let words: Vec<String> = chosen.iter().map(ToString::to_string).collect();
    chosen.reverse();
    let verdict = match (one, apply(chosen)) {
        (Err(_), Err(_)) => Verdict::Refused,
        (Ok(one), Ok(other)) if one.problem == other.problem && one.solver == other.solver => Verdict::Held(0.0),
        (one, other) => {
            let end = |result: Result<Analysis, Error>| match result {
                Ok(_) => "built".to_owned(),
                Err(error) => error.to_string(),
            };
            let text = format!("--set {} gives {}, reversed {}", words.join(" --set "), end(one), end(other));
            Verdict::Broken(text, f64::INFINITY)
        }
    };
    Some(Checked { verdict, files: Vec::new() })
}

/// Keys with their values in TOML; lists of tables are values as a whole.
fn flatten(table: &toml::Table, prefix: &str, found: &mut Vec<Change>) {
    for (name, value) in table {
        let key = if prefix.is_empty() { name.clone() } else { format!("{prefix}.{name}") };
        match value {
            toml::Value::Table(inner) => flatten(inner, &key, found),
            value => found.push(Change::new(key, value.to_string())),
        }
    }
}

/// What moves as a whole together with everything that it may touch has the same shape: an obstacle that comes nearer is a support that comes
/// nearer the other way.
fn carried_along(first: &First<'_>, dice: &mut Dice) -> Option<Checked> {
    let (old, body) = first.block()?;
    if !old.equations.is_empty() {
        return None;
    }
    let moving = old.obstacles.iter().find(|obstacle| obstacle.displacement.is_some());
    let way = moving.and_then(|obstacle| obstacle.displacement).unwrap_or([0.3, 0.0, dice.between(-0.5, 0.5)]);
    let factor = moving.and_then(|obstacle| obstacle.factor.clone());
    let mut second = old.clone();
    let less = |u: [f64; 3]| std::array::from_fn(|d| u[d] - way[d]);
    for support in &mut second.supports {
        let is_along = support.axes.chars().any(|axis| way["xyz".find(axis).unwrap_or(0)] != 0.0);
        match (&support.displacement, is_along) {
            (None, true) => (support.displacement, support.factor) = (Some(less([0.0; 3])), factor.clone()),
            (Some(displacement), true) if support.factor == factor => support.displacement = Some(less(*displacement)),
            (Some(_), true) => return None,
            (_, false) => {}
        }
    }
    for obstacle in &mut second.obstacles {
        match &obstacle.displacement {
            None => (obstacle.displacement, obstacle.factor) = (Some(less([0.0; 3])), factor.clone()),
            Some(displacement) if obstacle.factor == factor => {
                let left: [f64; 3] = less(*displacement);
                let is_left = left != [0.0; 3];
                obstacle.displacement = is_left.then_some(left);
                obstacle.factor = obstacle.factor.take().filter(|_| is_left);
            }
            Some(_) => return None,
        }
    }
    let times = &old.load.as_ref()?.times;
    let end = times.last().copied()?;
    let shift = times.iter().map(|&t| way.map(|u| -u * value(factor.as_ref(), t, end))).collect();
    // Forces and probes that follow, too, but not the work of what moves them.
    let rule = Rule { shift, ..Rule::same(SAME) };
    first.against(&model(second, Some(body)), &rule)
}

/// Value of a factor at a time.
fn value(factor: Option<&Series>, time: f64, end: f64) -> f64 {
    let points = match factor {
        None => return time / end,
        Some(Series::End(value)) => return value * time / end,
        Some(Series::Points(points)) => points,
    };
    let next = points.iter().position(|point| point[0] >= time).unwrap_or(points.len() - 1);
    let ([t, v], [s, w]) = (points[next], points[next.saturating_sub(1)]);
    if t == s { v } else { w + (v - w) * ((time - s) / (t - s)).min(1.0) }
}

/// A penalty for contact that has none of its own, N/mm³.
const PLAIN_STIFFNESS: f64 = 3.0;

/// A state does not know how the fluid got into it: the volume that a pressure gives has that pressure, and so has the amount of gas,
/// m = (1 + p/p₀) (V/V₀)ⁿ (theory §4). The path there may end earlier under one than under the other.
fn other_fluid(first: &First<'_>, dice: &mut Dice) -> Option<Checked> {
    let Draw::Model(old, body) = first.draw else { return None };
    if old.cavities.is_empty() {
        return None;
    }
    // Multipliers stop at a tolerance, and where they do depends on the way: both are solved without them.
    let mut plain = (**old).clone();
    for table in &mut plain.contacts {
        (table.stiffness, table.penetration_tolerance) = (table.stiffness.or(Some(PLAIN_STIFFNESS)), None);
    }
    for table in &mut plain.obstacles {
        (table.stiffness, table.penetration_tolerance) = (table.stiffness.or(Some(PLAIN_STIFFNESS)), None);
    }
    let draw = model(plain, body.as_ref());
    let analysis = draw.analysis(Form::Text)?;
    let outcome = Outcome::of(&analysis);
    by_other_fluid(&First { draw: &draw, analysis: &analysis, outcome: &outcome }, dice)
}

fn by_other_fluid(first: &First<'_>, dice: &mut Dice) -> Option<Checked> {
    let (Draw::Model(old, body), problem, End::Reached) = (first.draw, first.problem()?, &first.outcome.end) else {
        return None;
    };
    let which = dice.one_of(&(0..old.cavities.len()).collect::<Vec<usize>>());
    let table = &old.cavities[which];
    let state = first.outcome.states.last()?;
    let reached = state.cavities.get(&table.name)?;
    let rest = vec![[0.0; 3]; problem.mesh.num_nodes()];
    let parts = problem.parts_of_whole() as f64;
    let volume_at_rest = measures::volume(problem, problem.cavities.get(which)?, &rest).ok()??;
    let (pressure, volume) = (reached.pressure_kpa, reached.volume_mm3?);
    let mut new = CavityTable { pressure_kpa: None, volume_mm3: None, gas: None, ..table.clone() };
    let kinds = [table.pressure_kpa.is_some(), table.volume_mm3.is_some(), table.gas.is_some()];
    let others: Vec<usize> = (0..3).filter(|&kind| !kinds[kind]).collect();
    match dice.one_of(&others) {
        0 => new.pressure_kpa = Some(Series::End(pressure)),
        1 => new.volume_mm3 = Some(Series::End((volume - volume_at_rest) / parts)),
        _ => {
            let amount = (1.0 + pressure / new.atmosphere_kpa) * (volume / volume_at_rest).powf(new.exponent);
            new.gas = Some(Series::End(amount));
        }
    }
    let mut second = (**old).clone();
    second.cavities[which] = new;
    let rule = Rule { is_last_only: true, may_stop: true, has_same_warnings: false, ..Rule::same(SAME_STATE) };
    let rule = Rule { has_nodes: false, ..rule };
    first.against(&model(second, body.as_ref()), &rule)
}

/// Elements of one order have the same limit. A wall of a single element has its own errors: the faces of a cavity that is one hexahedron of 20
/// nodes have no node in their middle, and cannot bulge at all, which takes twice the pressure for a given volume (draw 400: 16.3 and
/// 31.2 kPa; 14.5 and 16.1 kPa with eight elements for each, 14.3 and 14.8 kPa with 216). Both are solved with eight for each therefore.
fn other_element(first: &First<'_>, _: &mut Dice) -> Option<Checked> {
    let (old, body) = first.block()?;
    if !old.obstacles.is_empty() || !old.contacts.is_empty() || body.mesh.kinds.only().is_none() {
        return None;
    }
    let other = match body.formulation {
        Formulation::Hex8Sri => Formulation::Hex8Q1p0,
        Formulation::Hex27 => Formulation::Hex20,
        Formulation::Hex8Q1p0 | Formulation::Hex20 | Formulation::Tet10 | Formulation::Tet15 | Formulation::Wedge21 => {
            return None;
        }
    };
    let fine = Body { mesh: meshes::refined(&body.mesh), formulation: body.formulation };
    let mesh = if other == Formulation::Hex20 { meshes::without_added_nodes(&fine.mesh) } else { fine.mesh.clone() };
    let second = model(old.clone(), Some(&Body { mesh, formulation: other }));
    let draw = model(old.clone(), Some(&fine));
    let analysis = draw.analysis(Form::Text)?;
    let outcome = Outcome::of(&analysis);
    // Stresses in corners have no limit, and what is unstable of a mesh is not of the other.
    let rule = Rule { may_stop: true, has_nodes: false, has_same_points: false, ..Rule::same(0.2) };
    let rule = Rule { has_stresses: false, has_same_warnings: false, ..rule };
    First { draw: &draw, analysis: &analysis, outcome: &outcome }.against(&second, &rule)
}

/// Sums are made in one order whatever the number of threads (bit by bit), and a run that is stopped and gone on with, from memory or from its
/// folder, is the run that never ended (10⁻⁹).
fn on_the_machine(first: &First<'_>, dice: &mut Dice) -> Option<Checked> {
    let verdict = |outcome: &Outcome, rule: &Rule| compare(first.outcome, outcome, rule, measure(first.analysis));
    let more =
        Outcome::solved(first.analysis, |analysis| limited(analysis.run().threads(3), &StopToken::new()).solve());
    let with_threads = verdict(&more, &Rule::same(0.0));
    if matches!(with_threads, Verdict::Broken(..)) || first.analysis.is_err() {
        return Some(Checked { verdict: with_threads, files: Vec::new() });
    }
    let (steps, is_recorded) = (dice.one_of(&[1, 2, 3]), dice.chance(0.5));
    let folder = scratch();
    let resumed = Outcome::solved(first.analysis, |analysis| {
        let token = StopToken::new();
        let (mut accepted, mut checkpoint) = (0, None);
        let run = limited(analysis.run().threads(1), &token);
        let run = if is_recorded { run.record(&folder) } else { run };
        let observed = run.observer(|event| {
            if let Event::StepAccepted(step) = event {
                accepted += 1;
                checkpoint = Some((*step).clone());
                if accepted == steps {
                    token.stop();
                }
            }
        });
        let again = || limited(analysis.run().threads(1), &StopToken::new());
        match (observed.solve(), checkpoint) {
            (Err(Error::Interrupted(_)), _) if is_recorded => again().resume(&folder).solve(),
            (Err(Error::Interrupted(_)), Some(checkpoint)) => again().resume_from(checkpoint).solve(),
            (ended, _) => ended,
        }
    });
    // A folder that cannot be removed is in a place for such things.
    let _ = std::fs::remove_dir_all(&folder);
    // From memory states before the checkpoint are not there, from a folder their fields.
    let rule = Rule { has_nodes: !is_recorded, is_last_only: !is_recorded, ..Rule::same(1e-9) };
    let mut last = resumed;
    if !is_recorded && matches!(last.end, End::Reached) && last.states.len() < first.outcome.states.len() {
        let missing = first.outcome.states.len() - last.states.len();
        let earlier = first.outcome.states[..missing].to_vec();
        last.states.splice(0..0, earlier);
        last.displacements.splice(0..0, first.outcome.displacements[..missing].to_vec());
    }
    let rule = Rule { has_same_warnings: is_recorded, ..rule };
    Some(Checked { verdict: verdict(&last, &rule), files: Vec::new() })
}

/// A folder of its own for every call.
fn scratch() -> PathBuf {
    static NEXT: AtomicUsize = AtomicUsize::new(0);
    let number = NEXT.fetch_add(1, Ordering::Relaxed);
    std::env::temp_dir().join(format!("pneuflex-relations-{}-{number}", std::process::id()))
}
