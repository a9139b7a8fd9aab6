//! Which nodes, faces and elements of a body a [`Choice`] holds.
//!
//! Faces are those of the body's surface. Where nodes are asked for, a choice that speaks of faces (by `normal`, `near` or a surface's name)
//! stands for their nodes, another one for all nodes for which its conditions hold, inside of the body, too.

use std::cell::OnceCell;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use pneuflex_mesh::vector::{angle_between, bounds, dot, norm, sub};
use pneuflex_mesh::{Facet, Mesh, Skin};

use crate::choice::{Choice, Conditions, Direction};
use crate::number::rounded;

/// Largest angle to the direction of `normal` that is not given, degrees.
const NORMAL: f64 = 10.0;

/// Largest angle between neighbours of `near` that is not given, degrees.
const SMOOTH: f64 = 30.0;

/// What nodes may lie beside planes and outside of boxes where nothing is given, relative to the body's extent.
const TOLERANCE: f64 = 1e-6;

/// A point that is further from the surface than this was meant for another body, or is in another unit; relative to the body's extent.
const FAR: f64 = 0.1;

/// Why a choice holds nothing, or cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotChosen {
    /// A name is that of no set, or of an empty one.
    #[error("{name:?} is not {what} of the body: {known}")]
    Unknown {
        /// The name.
        name: String,
        /// What is asked for, with its article.
        what: &'static str,
        /// Names of the sets that there are.
        known: String,
    },
    /// Nothing is where the conditions hold, and what is near; or they cannot be asked of what is wanted.
    #[error("{0}")]
    Nothing(String),
}

/// The members of a choice, and what they are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Holds {
    /// Nodes, where nodes are asked for or faces hold them.
    pub nodes: Vec<u32>,
    /// Faces of the surface.
    pub facets: Vec<Facet>,
    /// Elements, where elements are asked for.
    pub elements: Vec<u32>,
}

/// What a table asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// Nodes.
    Nodes,
    /// Faces.
    Faces,
    /// Elements.
    Elements,
}

impl Asked {
    const fn words(self) -> &'static str {
        match self {
            Self::Nodes => "node",
            Self::Faces => "face",
            Self::Elements => "element",
        }
    }
}

/// Chooses from a body.
#[derive(Debug)]
pub struct Chooser {
    mesh: Arc<Mesh>,
    skin: OnceCell<Skin>,
}

/// Names of sets are found whatever the case of their letters, exact ones first: decks know none.
pub(crate) fn named<'a, T>(sets: &'a BTreeMap<String, Vec<T>>, name: &str) -> Option<(&'a String, &'a Vec<T>)> {
    let found = sets.get_key_value(name).or_else(|| sets.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)));
    found.filter(|(_, members)| !members.is_empty())
}

impl Chooser {
    /// Of a body.
    pub fn new(mesh: Arc<Mesh>) -> Self {
        Self { mesh, skin: OnceCell::new() }
    }

    /// The body's surface.
    pub fn skin(&self) -> &Skin {
        self.skin.get_or_init(|| self.mesh.skin())
    }

    /// What a choice holds.
    ///
    /// # Errors
    /// [`NotChosen`] if that is nothing, or a name is no set.
    pub fn holds(&self, choice: &Choice, asked: Asked) -> Result<Holds, NotChosen> {
        match asked {
            Asked::Elements => Ok(Holds { elements: self.elements(choice)?, ..Holds::default() }),
            Asked::Faces => {
                let facets = self.facets(choice)?;
                Ok(Holds { nodes: nodes_of(&self.mesh, &facets), facets, ..Holds::default() })
            }
            Asked::Nodes if self.is_of_faces(choice) => self.holds(choice, Asked::Faces),
            Asked::Nodes => {
                let nodes = self.nodes(choice)?;
                let is_member = |node: &u32| nodes.binary_search(node).is_ok();
                let skin = self.skin().facets.iter().copied();
                let facets = skin.filter(|&facet| self.mesh.facet_nodes(facet).iter().all(is_member)).collect();
                Ok(Holds { nodes, facets, ..Holds::default() })
            }
        }
    }

    /// Faces in ascending order.
    ///
    /// # Errors
    /// As for [`Self::holds`].
    pub fn facets(&self, choice: &Choice) -> Result<Vec<Facet>, NotChosen> {
        let found = self.faces_of(choice)?;
        if found.is_empty() { Err(self.nothing(choice, Asked::Faces)) } else { Ok(found.into_iter().collect()) }
    }

    /// Nodes in ascending order.
    ///
    /// # Errors
    /// As for [`Self::holds`].
    pub fn nodes(&self, choice: &Choice) -> Result<Vec<u32>, NotChosen> {
        if self.is_of_faces(choice) {
            return Ok(nodes_of(&self.mesh, &self.facets(choice)?));
        }
        let found = self.nodes_where(choice)?;
        if found.is_empty() { Err(self.nothing(choice, Asked::Nodes)) } else { Ok(found.into_iter().collect()) }
    }

    /// Elements in ascending order: those whose centre is where the conditions hold.
    ///
    /// # Errors
    /// As for [`Self::holds`].
    pub fn elements(&self, choice: &Choice) -> Result<Vec<u32>, NotChosen> {
        let found = self.elements_where(choice)?;
        if found.is_empty() { Err(self.nothing(choice, Asked::Elements)) } else { Ok(found.into_iter().collect()) }
    }

    /// Whether a choice speaks of faces, so that it stands for their nodes where nodes are asked for.
    pub fn is_of_faces(&self, choice: &Choice) -> bool {
        match choice {
            Choice::Named(name) => {
                named(&self.mesh.node_sets, name).is_none() && named(&self.mesh.facet_sets, name).is_some()
            }
            Choice::Where(conditions) => {
                conditions.normal.is_some()
                    || conditions.near.is_some()
                    || conditions.choices().any(|inner| self.is_of_faces(inner))
            }
        }
    }

    fn faces_of(&self, choice: &Choice) -> Result<BTreeSet<Facet>, NotChosen> {
        let conditions = match choice {
            Choice::Named(name) => {
                let sets = &self.mesh.facet_sets;
                let found = named(sets, name).ok_or_else(|| unknown(name, "a surface", sets.keys()))?;
                return Ok(found.1.iter().copied().collect());
            }
            Choice::Where(conditions) => conditions,
        };
        let skin = self.skin();
        let all = || skin.facets.iter().copied();
        let mut sets: Vec<BTreeSet<Facet>> = Vec::new();
        for measure in self.measures(conditions) {
            let holds = |facet: &Facet| self.mesh.facet_nodes(*facet).iter().all(|&n| measure.holds(self.at(n)));
            sets.push(all().filter(holds).collect());
        }
        if let Some(Direction(direction)) = conditions.normal {
            let most = conditions.angle.unwrap_or(NORMAL);
            let looks =
                |(_, place): &(Facet, &pneuflex_mesh::FacePlace)| angle_between(place.normal, direction) <= most;
            sets.push(all().zip(&skin.places).filter(looks).map(|(facet, _)| facet).collect());
        }
        if let Some(point) = conditions.near {
            sets.push(self.smooth_part(point, conditions.angle.unwrap_or(SMOOTH))?);
        }
        self.combined(conditions, sets, || all().collect(), |inner| self.faces_of(inner))
    }

    fn nodes_where(&self, choice: &Choice) -> Result<BTreeSet<u32>, NotChosen> {
        let conditions = match choice {
            Choice::Named(name) => {
                let sets = &self.mesh.node_sets;
                let known = sets.keys().chain(self.mesh.facet_sets.keys());
                let found = named(sets, name).ok_or_else(|| unknown(name, "a node set or a surface", known))?;
                return Ok(found.1.iter().copied().collect());
            }
            Choice::Where(conditions) => conditions,
        };
        let all = || 0..self.mesh.num_nodes() as u32;
        let sets =
            self.measures(conditions).map(|measure| all().filter(|&node| measure.holds(self.at(node))).collect());
        self.combined(conditions, sets.collect(), || all().collect(), |inner| self.nodes_where(inner))
    }

    fn elements_where(&self, choice: &Choice) -> Result<BTreeSet<u32>, NotChosen> {
        let conditions = match choice {
            Choice::Named(name) => {
                let sets = &self.mesh.element_sets;
                let found = named(sets, name).ok_or_else(|| unknown(name, "an element set", sets.keys()))?;
                return Ok(found.1.iter().copied().collect());
            }
            Choice::Where(conditions) => conditions,
        };
        if conditions.plane.is_some() || conditions.normal.is_some() || conditions.near.is_some() {
            let why = "plane, normal and near choose faces; for elements use box, sphere or the name of a set";
            return Err(NotChosen::Nothing(why.into()));
        }
        let all = || 0..self.mesh.num_elements() as u32;
        let sets = self.measures(conditions).map(|measure| all().filter(|&e| measure.holds(self.centre(e))).collect());
        self.combined(conditions, sets.collect(), || all().collect(), |inner| self.elements_where(inner))
    }

    /// What all sets hold, and `and`, `or` and `not` of some conditions.
    fn combined<T: Copy + Ord>(
        &self,
        conditions: &Conditions,
        mut sets: Vec<BTreeSet<T>>,
        all: impl Fn() -> BTreeSet<T>,
        inner: impl Fn(&Choice) -> Result<BTreeSet<T>, NotChosen>,
    ) -> Result<BTreeSet<T>, NotChosen> {
        for choice in conditions.and.iter().flatten() {
            sets.push(inner(choice)?);
        }
        if let Some(choices) = &conditions.or {
            let mut union = BTreeSet::new();
            for choice in choices {
                union.extend(inner(choice)?);
            }
            sets.push(union);
        }
        if let Some(choice) = &conditions.not {
            let without = inner(choice)?;
            sets.push(all().difference(&without).copied().collect());
        }
        let first = sets.pop().unwrap_or_default();
        Ok(sets.iter().fold(first, |held, set| held.intersection(set).copied().collect()))
    }

    /// The face nearest to a point with those that continue it.
    fn smooth_part(&self, point: [f64; 3], most: f64) -> Result<BTreeSet<Facet>, NotChosen> {
        let skin = self.skin();
        let Some((first, gap)) = skin.nearest(&self.mesh, point) else { return Ok(BTreeSet::new()) };
        if gap > FAR * self.mesh.extent() {
            let at = words(skin.places[first].centre);
            return Err(NotChosen::Nothing(format!(
                "it is far from the body: the nearest face is at {at}, {} mm away",
                rounded(gap)
            )));
        }
        let part = skin.pieces(|edge| skin.angle(edge) <= most);
        let of_part = skin.facets.iter().zip(&part).filter(|(_, number)| **number == part[first]);
        Ok(of_part.map(|(facet, _)| *facet).collect())
    }

    fn measures<'a>(&self, conditions: &'a Conditions) -> impl Iterator<Item = Measure<'a>> + use<'a> {
        let tolerance = conditions.tolerance.unwrap_or(TOLERANCE * self.mesh.extent());
        let places = [
            conditions.within.as_ref().map(Place::Box),
            conditions.plane.as_ref().map(Place::Plane),
            conditions.sphere.as_ref().map(Place::Sphere),
        ];
        places.into_iter().flatten().map(move |place| Measure { place, tolerance })
    }

    fn at(&self, node: u32) -> [f64; 3] {
        self.mesh.nodes[node as usize]
    }

    /// Mean corner of an element.
    fn centre(&self, element: u32) -> [f64; 3] {
        let corners = self.mesh.corners(element as usize);
        std::array::from_fn(|d| corners.iter().map(|&n| self.at(n)[d]).sum::<f64>() / corners.len() as f64)
    }

    /// Why a choice holds nothing, and what is near.
    fn nothing(&self, choice: &Choice, asked: Asked) -> NotChosen {
        let body = bounds(self.mesh.nodes.iter().copied()).map_or_else(String::new, |[low, high]| {
            format!("; the body reaches from {} to {} mm", words(low), words(high))
        });
        let why = match choice {
            Choice::Where(conditions) => self.near_miss(conditions, asked),
            Choice::Named(_) => None,
        };
        let why = why.unwrap_or_else(|| "no member is left".into());
        NotChosen::Nothing(format!("it holds no {}: {why}{body}", asked.words()))
    }

    /// The first condition that nothing fulfils with what comes nearest to it; else how many each holds.
    fn near_miss(&self, conditions: &Conditions, asked: Asked) -> Option<String> {
        let points: Vec<([f64; 3], Vec<[f64; 3]>)> = match asked {
            Asked::Elements => {
                (0..self.mesh.num_elements() as u32).map(|e| (self.centre(e), vec![self.centre(e)])).collect()
            }
            Asked::Nodes => self.mesh.nodes.iter().map(|&x| (x, vec![x])).collect(),
            Asked::Faces => {
                let skin = self.skin();
                let nodes = |facet| self.mesh.facet_nodes(facet).into_iter().map(|node| self.at(node)).collect();
                skin.places.iter().zip(&skin.facets).map(|(place, &facet)| (place.centre, nodes(facet))).collect()
            }
        };
        let mut counts = Vec::new();
        for measure in self.measures(conditions) {
            let outside = |nodes: &[[f64; 3]]| nodes.iter().map(|&x| measure.outside(x)).fold(0.0, f64::max);
            let holding = points.iter().filter(|(_, nodes)| outside(nodes) <= measure.tolerance).count();
            let name = measure.place.name();
            if holding == 0 {
                let (off, centre) =
                    points.iter().map(|(x, nodes)| (outside(nodes), *x)).min_by(|a, b| a.0.total_cmp(&b.0))?;
                let (off, tolerance) = (rounded(off), rounded(measure.tolerance));
                return Some(format!(
                    "the nearest one, at {}, is {off} mm outside of the {name} (tolerance {tolerance} mm)",
                    words(centre)
                ));
            }
            counts.push(format!("{name} holds {holding}"));
        }
        if let Some(Direction(direction)) = conditions.normal {
            let skin = self.skin();
            let most = conditions.angle.unwrap_or(NORMAL);
            let angles = || skin.places.iter().map(|place| (angle_between(place.normal, direction), place.centre));
            let holding = angles().filter(|(angle, _)| *angle <= most).count();
            if holding == 0 {
                let (angle, at) = angles().min_by(|a, b| a.0.total_cmp(&b.0))?;
                return Some(format!("the nearest one, at {}, looks {angle:.1} degrees away", words(at)));
            }
            counts.push(format!("normal holds {holding}"));
        }
        for (name, choice) in (conditions.and.iter().flatten().map(|choice| ("and", choice)))
            .chain(conditions.or.iter().flatten().map(|choice| ("or", choice)))
            .chain(conditions.not.iter().map(|choice| ("not", choice)))
        {
            match self.holds(choice, asked) {
                Ok(held) => {
                    let number = match asked {
                        Asked::Nodes => held.nodes.len(),
                        Asked::Faces => held.facets.len(),
                        Asked::Elements => held.elements.len(),
                    };
                    counts.push(format!("{choice} ({name}) holds {number}"));
                }
                Err(why) => return Some(format!("of {choice}, {why}")),
            }
        }
        (!counts.is_empty()).then(|| format!("none is left of them all: {}", counts.join(", ")))
    }
}

fn words(x: [f64; 3]) -> String {
    let [x, y, z] = x.map(rounded);
    format!("({x}, {y}, {z})")
}

fn nodes_of(mesh: &Mesh, facets: &[Facet]) -> Vec<u32> {
    let nodes: BTreeSet<u32> = facets.iter().flat_map(|&facet| mesh.facet_nodes(facet)).collect();
    nodes.into_iter().collect()
}

fn unknown<'a>(name: &str, what: &'static str, known: impl Iterator<Item = &'a String>) -> NotChosen {
    let known: Vec<&str> = known.map(String::as_str).collect();
    let known = if known.is_empty() { "there are none".to_owned() } else { known.join(", ") };
    NotChosen::Unknown { name: name.to_owned(), what, known }
}

/// Where things lie.
#[derive(Clone, Copy)]
enum Place<'a> {
    Box(&'a [[f64; 3]; 2]),
    Plane(&'a crate::choice::Plane),
    Sphere(&'a crate::choice::Ball),
}

/// A place with how far outside of it a point may be.
#[derive(Clone, Copy)]
struct Measure<'a> {
    place: Place<'a>,
    tolerance: f64,
}

impl Place<'_> {
    const fn name(&self) -> &'static str {
        match self {
            Self::Box(_) => "box",
            Self::Plane(_) => "plane",
            Self::Sphere(_) => "sphere",
        }
    }
}

impl Measure<'_> {
    /// Distance of a point from the place, mm; along the axis in which it is largest, of a box.
    fn outside(&self, x: [f64; 3]) -> f64 {
        match self.place {
            Place::Box([one, other]) => {
                let beyond = |d: usize| (one[d].min(other[d]) - x[d]).max(x[d] - one[d].max(other[d]));
                (0..3).map(beyond).fold(0.0, f64::max)
            }
            Place::Plane(plane) => {
                let Direction(normal) = plane.normal;
                (dot(sub(x, plane.point), normal) / norm(normal)).abs()
            }
            Place::Sphere(ball) => (norm(sub(x, ball.centre)) - ball.radius).max(0.0),
        }
    }

    fn holds(&self, x: [f64; 3]) -> bool {
        self.outside(x) <= self.tolerance
    }
}

#[cfg(test)]
mod tests {
    use pneuflex_mesh::ElementKind;
    use pneuflex_mesh::lattice::Lattice;

    use super::*;

    /// A block of 4 × 3 × 3 mm with a closed hole of one cell.
    fn chooser(kind: ElementKind) -> Chooser {
        let mut mesh = Lattice::uniform([0.0; 3], [4.0, 3.0, 3.0], [4, 3, 3]).mesh(kind, |cell| cell != [1, 1, 1]).mesh;
        let end = mesh.select_facets(|x| x[0] == 4.0);
        mesh.facet_sets.insert("end".into(), end);
        mesh.node_sets.insert("foot".into(), mesh.select_nodes(|x| x[0] == 0.0));
        mesh.element_sets.insert("all".into(), (0..mesh.num_elements() as u32).collect());
        Chooser::new(mesh.into())
    }

    fn read(text: &str) -> Choice {
        #[derive(serde::Deserialize)]
        struct File {
            a: Choice,
        }
        toml::from_str::<File>(&format!("a = {text}")).unwrap().a
    }

    #[test]
    fn conditions_hold_what_lies_there() {
        for kind in [ElementKind::Hex8, ElementKind::Tet10, ElementKind::Wedge15] {
            let chooser = chooser(kind);
            let mesh = chooser.mesh.clone();
            let area = |text: &str| -> f64 {
                let held = chooser.facets(&read(text)).unwrap();
                held.iter().map(|&facet| mesh.face_place(facet).area).sum()
            };
            for (text, expected) in [
                ("{ box = [[0, 0, 0], [1, 3, 3]] }", 9.0 + 4.0 * 3.0 + 1.0),
                ("{ plane = { point = [0, 5, 1], normal = \"-x\" } }", 9.0),
                ("{ plane = { point = [0, 0, 1], normal = [0, 0, 2] } }", 1.0),
                ("{ normal = \"x\" }", 9.0 + 1.0),
                ("{ normal = \"x\", box = [[4, -9, -9], [4, 9, 9]] }", 9.0),
                ("{ normal = [1, 0.1, 0], angle = 20 }", 10.0),
                ("{ near = [2.1, 1.5, 3.01] }", 12.0),
                ("{ near = [1.5, 1.5, 1.1] }", 1.0),
                ("{ near = [1.5, 1.5, 1.1], angle = 100 }", 6.0),
                ("{ sphere = { centre = [1.5, 1.5, 1.5], radius = 0.9 } }", 6.0),
                ("{ not = { box = [[0.5, 0.5, 0.5], [2.5, 2.5, 2.5]] } }", 66.0),
                ("{ and = [{ normal = \"z\" }, { not = { near = [1, 1, 3] } }] }", 1.0),
                ("{ or = [\"END\", { plane = { point = [0, 0, 0], normal = \"x\" } }] }", 18.0),
                ("\"end\"", 9.0),
            ] {
                assert!((area(text) - expected).abs() < 1e-12, "{kind:?} {text}: {} for {expected}", area(text));
                // As it is written and shown it is the same.
                let choice = read(text);
                if choice.name().is_none() {
                    assert_eq!(read(&choice.to_string()), choice);
                }
            }
        }
    }

    #[test]
    fn nodes_are_those_of_faces_or_those_that_lie_there() {
        let chooser = chooser(ElementKind::Hex8);
        let count = |text: &str| chooser.nodes(&read(text)).unwrap().len();
        for (text, expected) in [
            ("{ plane = { point = [2, 0, 0], normal = \"x\" } }", 16),
            ("{ plane = { point = [3, 0, 0], normal = \"x\" }, tolerance = 1.001 }", 48),
            ("\"foot\"", 16),
            ("\"end\"", 16),
            ("{ normal = \"-x\" }", 16 + 4),
            ("{ and = [\"foot\", { box = [[0, 0, 0], [0, 0, 9]] }] }", 4),
            ("{ not = \"foot\" }", 64),
            ("{ and = [\"end\", { box = [[0, 0, 0], [9, 9, 1]] }] }", 8),
        ] {
            assert_eq!(count(text), expected, "{text}");
        }
        let elements = |text: &str| chooser.elements(&read(text)).unwrap().len();
        assert_eq!(elements("{ box = [[0, 0, 0], [1, 3, 3]] }"), 9);
        assert_eq!(
            elements("{ and = [\"all\", { not = { sphere = { centre = [0.5, 0.5, 0.5], radius = 0.1 } } }] }"),
            34
        );
        assert!(
            chooser.elements(&read("{ normal = \"x\" }")).unwrap_err().to_string().contains("for elements use box")
        );
    }

    #[test]
    fn an_empty_choice_says_what_is_near() {
        let chooser = chooser(ElementKind::Hex8);
        for (text, said) in [
            ("{ box = [[5, 0, 0], [9, 3, 3]] }", "is 1 mm outside of the box"),
            ("{ box = [[5, 0, 0], [9, 3, 3]] }", "the body reaches from (0, 0, 0) to (4, 3, 3) mm"),
            (
                "{ plane = { point = [-0.25, 0, 0], normal = \"x\" } }",
                "at (0, 0.5, 0.5), is 0.25 mm outside of the plane",
            ),
            ("{ sphere = { centre = [2, 1.5, 9], radius = 1 } }", "outside of the sphere"),
            ("{ normal = [1, 1, 0] }", "looks 45.0 degrees away"),
            ("{ near = [20, 0, 0] }", "mm away"),
            (
                "{ normal = \"x\", box = [[0, 0, 0], [0, 3, 3]] }",
                "none is left of them all: box holds 9, normal holds 10",
            ),
            ("{ and = [\"end\", { normal = \"y\" }] }", "end (and) holds 9"),
            ("{ not = \"nothing\" }", "\"nothing\" is not a surface of the body: end"),
        ] {
            let why = chooser.facets(&read(text)).unwrap_err().to_string();
            assert!(why.contains(said), "{text}: {why}");
        }
    }

    #[test]
    fn what_cannot_be_meant_is_found_in_the_text() {
        let problems = |text: &str| {
            let mut found = crate::range_check::Problems::default();
            read(text).check("support[0].nodes", &mut found);
            found.0.into_iter().map(|problem| problem.key).collect::<Vec<_>>()
        };
        for (text, key) in [
            ("{}", ""),
            ("{ tolerance = 1 }", ""),
            ("{ box = [[0, 0, 0], [nan, 0, 0]] }", ".box"),
            ("{ plane = { point = [0, 0, 0], normal = [0, 0, 0] } }", ".plane.normal"),
            ("{ sphere = { centre = [0, 0, 0], radius = 0 } }", ".sphere.radius"),
            ("{ near = [0, 0, inf] }", ".near"),
            ("{ normal = \"x\", angle = 180 }", ".angle"),
            ("{ box = [[0, 0, 0], [1, 1, 1]], angle = 3 }", ".angle"),
            ("{ normal = \"x\", tolerance = 3 }", ".tolerance"),
            ("{ and = [] }", ".and"),
            ("{ or = [\"a\", { not = {} }] }", ".or[1].not"),
        ] {
            assert_eq!(problems(text), [format!("support[0].nodes{key}")], "{text}");
        }
        assert_eq!(problems("{ and = [\"a\", { normal = \"-z\", angle = 5 }] }"), Vec::<String>::new());
        for wrong in ["3", "{ normal = \"w\" }", "{ colour = 1 }", "{ plane = { point = [0, 0, 0] } }"] {
            assert!(
                toml::from_str::<std::collections::BTreeMap<String, Choice>>(&format!("a = {wrong}")).is_err(),
                "{wrong}"
            );
        }
    }
}
