//! From a model file and its body to a problem.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use pneuflex_mesh::{Actuator, Facet, Mesh};

use super::hollows::Hollows;
use super::tables::{CavityTable, ContactTable, EquationTable, Model, RegionTable, Steps, SupportTable};
use crate::choice::Choice;
use crate::chosen::{Chooser, NotChosen};
use crate::contact_stiffness;
use crate::load::{Cavity, Control, Curve, Gas, LinearEquation, Load, Motion};
use crate::obstacle::Obstacle;
use crate::obstacle_table::ObstacleTable;
use crate::options::{Contact, ContactMethod, Solver};
use crate::problem::{Clock, ContactPair, Problem, Region, Support};
use crate::quantity::LoadParameter;
use crate::range_check::CaseError;
use crate::series::Series;
use crate::symmetry_check::{BoxSide, ProblemPart, WHOLE_ACTUATOR};
use crate::units::MPA_PER_KPA;

/// Largest error of the volume of a region that is given by a box.
const BOX_VOLUME: f64 = 0.05;

/// Step sizes by default, relative to the last time: first, largest, smallest.
const STEPS: [f64; 3] = [0.1, 1.0, 1e-5];

/// What is solved.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// The problem.
    pub problem: Problem,
    /// Times to reach.
    pub times: Vec<f64>,
    /// Solver settings.
    pub solver: Solver,
    /// Hollow spaces that were found, by the names of the sets of their walls.
    pub hollows: Hollows,
    /// What to know of the body.
    pub notes: Vec<String>,
}

impl Model {
    /// Adds what the file says to a body; `schedule` are times and first step of the deck that it came from, if it did.
    ///
    /// # Errors
    /// Every set that does not exist or is empty, and what is missing.
    pub fn study(&self, mut body: Problem, schedule: Option<(&[f64], f64)>) -> Result<Study, Vec<CaseError>> {
        let mut notes = Vec::new();
        let hollows = self.name_hollows(&mut body, &mut notes).map_err(|error| vec![error])?;
        let of_body = [body.supports.len(), body.loads.len(), body.obstacles.len()];
        let (actuator, load_keys) = (self.actuator.as_ref(), Vec::new());
        let mut build = Build {
            chooser: Chooser::new(Arc::clone(&body.mesh)),
            problem: body,
            actuator,
            errors: Vec::new(),
            first: LoadParameter::default(),
            end: 0.0,
            load_keys,
        };
        let times = match (&self.load, schedule) {
            (Some(load), _) => load.times.clone(),
            (None, Some((times, _))) => times.to_vec(),
            (None, None) => {
                build.complain(
                    "load.times",
                    "nothing".into(),
                    "must be given: the body comes without a schedule".into(),
                );
                vec![1.0]
            }
        };
        build.first = LoadParameter(times.first().copied().unwrap_or(1.0));
        build.end = times.last().copied().unwrap_or(1.0);
        build.problem.clock = Clock::Steps;
        if let Some(material) = &self.material {
            build.problem.material = material.clone();
        }
        for (i, region) in self.regions.iter().enumerate() {
            build.region(i, region);
        }
        for (i, support) in self.supports.iter().enumerate() {
            build.support(i, support);
        }
        build.problem.hold_added();
        for (i, equation) in self.equations.iter().enumerate() {
            build.equation(i, equation);
        }
        for (i, cavity) in self.cavities.iter().enumerate() {
            build.cavity(i, cavity);
        }
        self.add_loads(&mut build);
        for (i, contact) in self.contacts.iter().enumerate() {
            build.contact(i, contact);
        }
        for (i, obstacle) in self.obstacles.iter().enumerate() {
            build.obstacle(i, obstacle);
        }
        if build.errors.is_empty() {
            self.check_symmetry(&mut build, of_body);
        }
        build.problem.follow_faces();
        let solver = self.solver.resolved(build.end, schedule.map(|(_, first)| first));
        if build.errors.is_empty() {
            Ok(Study { problem: build.problem, times, solver, hollows, notes })
        } else {
            Err(build.errors)
        }
    }

    /// Refuses what the part of a body that is cut at a plane of symmetry cannot stand for; `of_body` are the numbers of supports, loads and
    /// obstacles that came with the body.
    fn check_symmetry(&self, build: &mut Build<'_>, of_body: [usize; 3]) {
        let remedy = match self.actuator {
            Some(_) => WHOLE_ACTUATOR,
            None => "model the whole body",
        };
        for asymmetry in build.problem.asymmetries().into_iter().filter(|asymmetry| !asymmetry.is_twofold) {
            let (number, first) = match asymmetry.part {
                ProblemPart::Support(number) => (number, of_body[0]),
                ProblemPart::Load(number) => (number, of_body[1]),
                ProblemPart::Obstacle(number) => (number, of_body[2]),
            };
            let (key, value) = match (number.checked_sub(first), asymmetry.part) {
                (Some(i), ProblemPart::Support(_)) => {
                    let moved = self.supports.get(i).and_then(|support| support.displacement);
                    (format!("support[{i}].displacement"), format!("{:?}", moved.unwrap_or_default()))
                }
                (Some(i), ProblemPart::Load(_)) => build.load_keys.get(i).cloned().unwrap_or_default(),
                (Some(i), ProblemPart::Obstacle(_)) => {
                    let (name, at) = self.obstacles.get(i).map_or(("name", [0.0; 3]), ObstacleTable::position);
                    (format!("obstacle[{i}].{name}"), format!("{at:?}"))
                }
                // What the deck says and the plane that the model file adds do not go together.
                (None, part) => (
                    format!("support[{}].symmetry", asymmetry.plane.support.saturating_sub(of_body[0])),
                    deck_words(part),
                ),
            };
            build.errors.push(asymmetry.refusal(key, value, remedy));
        }
    }

    fn add_loads(&self, build: &mut Build<'_>) {
        for (i, force) in self.forces.iter().enumerate() {
            let nodes = build.shares(&format!("force[{i}].nodes"), &force.nodes);
            let curve = build.factor(force.factor.as_ref());
            let load = Load::Force { nodes, force: force.total, curve };
            build.load(load, format!("force[{i}].total"), format!("{:?}", force.total));
        }
        for (i, traction) in self.tractions.iter().enumerate() {
            let facets = build.facets(&format!("traction[{i}].faces"), &traction.faces);
            let curve = build.factor(traction.factor.as_ref());
            let load = Load::Traction { facets, traction: traction.traction_mpa, curve };
            build.load(load, format!("traction[{i}].traction_mpa"), format!("{:?}", traction.traction_mpa));
        }
        for (i, pressure) in self.pressures.iter().enumerate() {
            let facets = build.facets(&format!("pressure[{i}].faces"), &pressure.faces);
            let curve = build.curve(&pressure.pressure_kpa, MPA_PER_KPA);
            build.load(Load::Pressure { facets, curve }, format!("pressure[{i}].faces"), quoted(&pressure.faces));
        }
        if let Some(gravity) = &self.gravity {
            let curve = build.factor(gravity.factor.as_ref());
            let acceleration = gravity.acceleration;
            let load = Load::Gravity { elements: None, acceleration, curve };
            build.load(load, "gravity.acceleration".into(), format!("{acceleration:?}"));
            let (materials, _) = build.problem.materials();
            if materials.iter().all(|material| material.density == 0.0) {
                let allowed = "must be greater than 0 where there is gravity, g/cm3";
                build.complain("material.density", "0".into(), allowed.into());
            }
        }
    }
}

impl Steps {
    fn resolved(&self, end: f64, first_of_deck: Option<f64>) -> Solver {
        let default = Solver::default();
        let [first, max, min] = STEPS.map(|share| share * end);
        let max_step = self.max_step.unwrap_or(max);
        let min_step = self.min_step.unwrap_or(min).min(max_step);
        Solver {
            tolerance: self.tolerance.unwrap_or(default.tolerance),
            residual_tolerance: self.residual_tolerance.unwrap_or(default.residual_tolerance),
            max_iterations: self.max_iterations.unwrap_or(default.max_iterations),
            first_step: self.first_step.unwrap_or(first_of_deck.map_or(first, |step| step.min(first))),
            max_step,
            min_step,
            continuation: self.continuation.unwrap_or(default.continuation),
            states_past_limit: self.states_past_limit.unwrap_or(default.states_past_limit),
            imperfection: self.imperfection,
        }
    }
}

/// A problem that is being put together.
struct Build<'a> {
    problem: Problem,
    chooser: Chooser,
    /// Lengths of the body, if it is an actuator's.
    actuator: Option<&'a Actuator>,
    errors: Vec<CaseError>,
    /// First requested time.
    first: LoadParameter,
    /// Last time.
    end: f64,
    /// Key and value of every load that was added.
    load_keys: Vec<(String, String)>,
}

/// A part of a deck in words.
fn deck_words(part: ProblemPart) -> String {
    match part {
        ProblemPart::Support(_) => "true, with a moved boundary of the deck",
        ProblemPart::Load(_) => "true, with a load of the deck",
        ProblemPart::Obstacle(_) => "true, with a rigid body of the deck",
    }
    .to_owned()
}

impl Build<'_> {
    fn complain(&mut self, key: &str, value: String, allowed: String) {
        self.errors.push(CaseError { key: key.into(), value, allowed });
    }

    fn load(&mut self, load: Load, key: String, value: String) {
        self.problem.loads.push(load);
        self.load_keys.push((key, value));
    }

    /// Complains about a name that something of the body has already.
    fn unless_new(&mut self, key: &str, name: &str, is_known: bool) {
        if is_known {
            self.complain(key, format!("{name:?}"), "must be another name than that of one of the deck's".into());
        }
    }

    /// What a choice holds; nothing, with a complaint, where that is nothing.
    fn held<T>(&mut self, key: &str, choice: &Choice, found: Result<Vec<T>, NotChosen>) -> Vec<T> {
        found.unwrap_or_else(|why| {
            let allowed = match (why, choice) {
                (NotChosen::Unknown { what, known, .. }, Choice::Named(_)) => {
                    format!("must be {what} of the body: {known}")
                }
                (why, _) => why.to_string(),
            };
            self.complain(key, quoted(choice), allowed);
            Vec::new()
        })
    }

    fn nodes(&mut self, key: &str, choice: &Choice) -> Vec<u32> {
        let found = self.chooser.nodes(choice);
        self.held(key, choice, found)
    }

    /// Nodes with their shares in what is spread evenly over them, or over the faces that they are of.
    fn shares(&mut self, key: &str, choice: &Choice) -> Vec<(u32, f64)> {
        if self.chooser.is_of_faces(choice) {
            let facets = self.facets(key, choice);
            return self.problem.mesh.shares_of_faces(&facets);
        }
        let nodes = self.nodes(key, choice);
        let shares = self.problem.mesh.shares(&nodes);
        nodes.into_iter().zip(shares).collect()
    }

    fn facets(&mut self, key: &str, choice: &Choice) -> Vec<Facet> {
        let found = self.chooser.facets(choice);
        let is_joined = self.actuator.is_some_and(Actuator::has_channel);
        let number = choice.name().and_then(|name| name.strip_prefix("cavity_"));
        if found.is_err() && is_joined && number.is_some_and(|number| number.parse::<usize>().is_ok()) {
            let why = "the channel joins the cavities, and its air has one pressure: set actuator.channel.half_width = 0 for \
                       chambers with air of their own, or use cavity";
            return self.held(key, choice, Err(NotChosen::Nothing(why.into())));
        }
        self.held(key, choice, found)
    }

    fn curve(&self, series: &Series, unit: f64) -> Curve {
        match series {
            Series::End(value) => Curve::Table(vec![[0.0, 0.0], [self.end, unit * value]]),
            Series::Points(points) => Curve::Table(points.iter().map(|[t, value]| [*t, unit * value]).collect()),
        }
    }

    fn factor(&self, series: Option<&Series>) -> Curve {
        self.curve(series.unwrap_or(&Series::End(1.0)), 1.0)
    }

    fn region(&mut self, number: usize, table: &RegionTable) {
        let key = format!("region[{number}].elements");
        let elements: Vec<u32> = match (&table.elements, table.within) {
            (Some(choice), _) => match choice.only_box() {
                Some(corners) => self.elements_of_box(&key, corners),
                None => {
                    let found = self.chooser.elements(choice);
                    self.held(&key, choice, found)
                }
            },
            (None, Some(corners)) => self.elements_of_box(&format!("region[{number}].box"), corners),
            (None, None) => Vec::new(),
        };
        for earlier in &mut self.problem.regions {
            earlier.elements.retain(|element| elements.binary_search(element).is_err());
        }
        self.problem.regions.push(Region { name: table.name.clone(), elements, material: table.material.clone() });
    }

    /// The elements that fill a box, to 5 % of the volume of the body in it.
    fn elements_of_box(&mut self, key: &str, corners: [[f64; 3]; 2]) -> Vec<u32> {
        for plane in self.problem.symmetry.clone() {
            let words = plane.words();
            let (why, remedy) = match self.problem.box_side(&plane, corners) {
                BoxSide::Symmetric | BoxSide::Twofold => continue,
                BoxSide::Beyond => {
                    ("lies beyond the plane of symmetry", "its mirror image is the part of the body that is modelled")
                }
                BoxSide::Uneven => (
                    "reaches over the plane of symmetry further on one side than on the other",
                    "make it the same on both sides, or model the whole body",
                ),
            };
            self.complain(key, format!("{corners:?}"), format!("it {why} {words}; {remedy}"));
            return Vec::new();
        }
        let mesh = &self.problem.mesh;
        let elements = elements_within(mesh, corners);
        let (found, wanted) = (mesh.volume_of(elements.iter().copied()), mesh.volume_within(corners));
        if !((found - wanted).abs() <= BOX_VOLUME * wanted && wanted > 0.0) {
            let allowed = format!(
                "{wanted:.6} mm3 of the body are in it, but the elements whose centre is in it have {found:.6} mm3: it must follow faces of \
                 elements; mesh the body so that they lie at the box, or name an element set (region.elements)"
            );
            self.complain(key, format!("{corners:?}"), allowed);
        }
        elements
    }

    fn support(&mut self, number: usize, table: &SupportTable) {
        let nodes = self.nodes(&format!("support[{number}].nodes"), &table.nodes);
        let axes = ['x', 'y', 'z'].map(|axis| table.axes.contains(axis));
        let motion =
            table.displacement.map(|displacement| Motion { displacement, curve: self.factor(table.factor.as_ref()) });
        let name = table.nodes.name().map_or_else(|| format!("support_{}", number + 1), str::to_owned);
        self.problem.supports.push(Support { name, nodes, axes, motion });
        if table.symmetry && self.errors.is_empty() {
            let declared = self.problem.declare_symmetry(self.problem.supports.len() - 1);
            if let Err(why) = declared {
                self.complain(&format!("support[{number}].symmetry"), "true".into(), why.to_string());
            }
        }
    }

    fn equation(&mut self, number: usize, table: &EquationTable) {
        let key = |term: usize| format!("equation[{number}].terms[{term}]");
        let mut sets: Vec<Vec<u32>> =
            table.terms.iter().enumerate().map(|(j, (name, ..))| self.nodes(&key(j), name)).collect();
        // Sets correspond node by node as the file has them; added nodes follow.
        if let Some(given) = &self.problem.given {
            sets.iter_mut().for_each(|set| set.retain(|&node| (node as usize) < given.mesh.num_nodes()));
        }
        let count = sets.iter().map(Vec::len).max().unwrap_or(0);
        for (j, set) in sets.iter().enumerate() {
            if ![0, 1, count].contains(&set.len()) {
                let allowed = format!("must have one node, or {count} as the largest set of the equation");
                self.complain(&key(j), format!("{} with {} nodes", table.terms[j].0, set.len()), allowed);
            }
        }
        if !self.errors.is_empty() {
            return;
        }
        let value = table.value.as_ref().map_or(Curve::ZERO, |series| self.curve(series, 1.0));
        for row in 0..count {
            let term = |(set, (_, axis, coefficient)): (&Vec<u32>, &(Choice, String, f64))| {
                let axis = "xyz".find(axis.as_str()).unwrap_or(0) as u8;
                (set[row.min(set.len() - 1)], axis, *coefficient)
            };
            let mut sums: BTreeMap<(u32, u8), f64> = BTreeMap::new();
            for (node, axis, coefficient) in sets.iter().zip(&table.terms).map(term) {
                *sums.entry((node, axis)).or_default() += coefficient;
            }
            // A node that is tied to itself says nothing.
            let terms: Vec<_> =
                sums.into_iter().filter(|(_, c)| *c != 0.0).map(|((node, axis), c)| (node, axis, c)).collect();
            if !terms.is_empty() {
                self.problem.equations.push(LinearEquation { terms, value: value.clone() });
            }
        }
    }

    fn cavity(&mut self, number: usize, table: &CavityTable) {
        let key = format!("cavity[{number}].faces");
        let facets = self.facets(&key, &table.faces);
        let known: BTreeSet<Facet> = facets.iter().copied().collect();
        let other = self.problem.cavities.iter().find(|other| other.facets.iter().any(|facet| known.contains(facet)));
        if let Some(name) = other.map(|other| other.name.clone()) {
            let why = format!("the cavity {name:?} has some of these faces already: they would feel the air of both");
            self.complain(&key, quoted(&table.faces), why);
        }
        let control = match (&table.pressure_kpa, &table.volume_mm3, &table.gas) {
            (Some(pressure), _, _) => Control::Pressure(self.curve(pressure, MPA_PER_KPA)),
            (_, Some(volume), _) => Control::Volume(self.curve(volume, 1.0)),
            (_, _, Some(Series::End(amount))) => {
                // From what fills it at rest.
                self.gas(table, Curve::Table(vec![[0.0, 1.0], [self.end, *amount]]))
            }
            (_, _, Some(points)) => self.gas(table, self.curve(points, 1.0)),
            (None, None, None) => Control::Pressure(Curve::ZERO),
        };
        let cavity = Cavity { name: table.name.clone(), facets, control };
        let is_open = match cavity.control {
            Control::Pressure(_) => None,
            _ => self.problem.cavity_plane(&cavity).err(),
        };
        if let Some(error) = is_open.filter(|_| self.errors.is_empty()) {
            self.complain(&format!("cavity[{number}].faces"), quoted(&table.faces), error.to_string());
        }
        self.problem.cavities.push(cavity);
    }

    fn gas(&self, table: &CavityTable, amount: Curve) -> Control {
        Control::Gas(Gas { atmosphere: MPA_PER_KPA * table.atmosphere_kpa, exponent: table.exponent, amount })
    }

    fn contact(&mut self, number: usize, table: &ContactTable) {
        let slave = self.facets(&format!("contact[{number}].slave"), &table.slave);
        let master = self.facets(&format!("contact[{number}].master"), &table.master);
        let stiffness = table.stiffness.unwrap_or_else(|| self.stiffness(&slave));
        let known = self.problem.contact_pairs.iter_mut().find(|pair| {
            let both = [&pair.slave, &pair.master];
            !slave.is_empty() && (both == [&slave, &master] || both == [&master, &slave])
        });
        match known {
            // The walls of an actuator's gaps are kept apart by themselves; a table says how stiffly.
            Some(gap) if gap.stiffness.is_none() => {
                let (is_two_pass, interference_until) = (table.two_pass, table.interference.then_some(self.first));
                let name = std::mem::take(&mut gap.name);
                let (method, penetration_tolerance) = (table.method, table.penetration_tolerance);
                let plain = ContactPair::new(name, slave, master);
                let stiffness = Some(stiffness);
                *gap =
                    ContactPair { stiffness, is_two_pass, method, penetration_tolerance, interference_until, ..plain };
                return;
            }
            Some(_) => {
                let allowed =
                    "these surfaces are kept apart already: a second time would make their contact twice as stiff";
                self.complain(&format!("contact[{number}].slave"), quoted(&table.slave), allowed.into());
            }
            None => {}
        }
        if self.problem.contact.method == ContactMethod::None {
            self.problem.contact = Contact { stiffness, method: ContactMethod::Mortar, ..Contact::default() };
        }
        let penetration_tolerance = table.penetration_tolerance.or_else(|| self.tolerance(table.stiffness, &slave));
        let name = match (table.slave.name(), table.master.name()) {
            (Some(slave), Some(master)) => format!("{slave}-{master}"),
            _ => format!("contact_{}", number + 1),
        };
        let pair = ContactPair::new(name, slave, master);
        let is_of_one_surface = pair.is_of_one_surface(&self.problem.mesh);
        if is_of_one_surface && table.method == Some(ContactMethod::Mortar) {
            let allowed = "must be multi-point where the two surfaces have nodes in common: gaps are averaged between two surfaces only";
            self.complain(&format!("contact[{number}].method"), "mortar".into(), allowed.into());
        }
        let default = if is_of_one_surface || self.actuator.is_some() {
            ContactMethod::MultiPoint
        } else {
            ContactMethod::Mortar
        };
        self.problem.contact_pairs.push(ContactPair {
            method: Some(table.method.unwrap_or(default)),
            stiffness: Some(stiffness),
            penetration_tolerance,
            is_two_pass: table.two_pass,
            interference_until: table.interference.then_some(self.first),
            ..pair
        });
    }

    fn obstacle(&mut self, number: usize, table: &ObstacleTable) {
        let facets =
            self.facets(&format!("obstacle[{number}].faces"), &table.faces.clone().unwrap_or_else(|| "outer".into()));
        let motion =
            table.displacement.map(|displacement| Motion { displacement, curve: self.factor(table.factor.as_ref()) });
        let is_known = self.problem.obstacles.iter().any(|obstacle| obstacle.name == table.name);
        self.unless_new(&format!("obstacle[{number}].name"), &table.name, is_known);
        let stiffness = self.stiffness(&facets);
        let tolerance = table.penetration_tolerance.or_else(|| self.tolerance(table.stiffness, &facets));
        // The ranges of the file ask for all that a shape needs.
        let obstacle = table.obstacle(facets, stiffness, motion, self.first);
        self.problem.obstacles.extend(obstacle.map(|found| Obstacle { penetration_tolerance: tolerance, ..found }));
    }

    /// How deep faces may be in what they touch at the requested times where the file does not say it, mm: as deep as a given stiffness lets
    /// them, and in own actuators that of the paper's cases.
    fn tolerance(&self, given: Option<f64>, facets: &[Facet]) -> Option<f64> {
        let is_free = given.is_none() && self.actuator.is_none();
        is_free.then(|| contact_stiffness::tolerance_of_faces(&self.problem.mesh, facets)).flatten()
    }

    /// Penalty stiffness of faces that are given none, N/mm³.
    fn stiffness(&self, facets: &[Facet]) -> f64 {
        let (materials, of_element) = self.problem.materials();
        let softest = facets
            .iter()
            .map(|facet| materials[usize::from(of_element[facet.element as usize])].shear_modulus())
            .fold(f64::INFINITY, f64::min);
        match self.actuator {
            Some(actuator) => contact_stiffness::of_actuator(softest, actuator),
            None => contact_stiffness::of_faces(softest, &self.problem.mesh, facets).unwrap_or(1.0),
        }
    }
}

/// A choice as a message has it.
fn quoted(choice: &Choice) -> String {
    choice.name().map_or_else(|| choice.to_string(), |name| format!("{name:?}"))
}

/// Elements whose mean corner lies between two corners of a box.
fn elements_within(mesh: &Mesh, [low, high]: [[f64; 3]; 2]) -> Vec<u32> {
    let is_within = |element: &u32| {
        let nodes = mesh.corners(*element as usize);
        (0..3).all(|k| {
            let centre = nodes.iter().map(|&n| mesh.nodes[n as usize][k]).sum::<f64>() / nodes.len() as f64;
            (low[k].min(high[k])..=low[k].max(high[k])).contains(&centre)
        })
    };
    (0..mesh.num_elements() as u32).filter(is_within).collect()
}
