//! What to be careful about that is known before anything is solved: units, shapes of elements, what stands for two. All of it is found in
//! the problem's data, whatever kind of file it came from.

use std::collections::{BTreeMap, BTreeSet};

use pneuflex_mesh::Facet;
use pneuflex_model::load::Load;
use pneuflex_model::model_file::Model;
use pneuflex_model::{Asymmetry, BoxSide, Control, Curve, LoadParameter, Material, Probe, Problem, ProblemPart};

use crate::advice::Occasion;
use crate::diagnosis::{Warning, WarningKind};
use crate::held_in_obstacle;
use crate::vocabulary::Vocabulary;
use crate::words::thousands;

/// Elements of a smaller scaled Jacobian are poor: slivers.
pub const POOR_SHAPE: f64 = 0.05;

/// A probe whose nearest node is further away than this share of the body's extent is hardly on it.
const FAR_PROBE: f64 = 0.05;

/// Extents of bodies, mm, that are usual.
const EXTENT: [f64; 2] = [0.5, 5000.0];

/// Densities of solids, g/cm³.
const DENSITY: [f64; 2] = [0.01, 25.0];

/// Shear moduli of the softest material of a soft body, MPa: from hydrogels to hard rubber and beyond.
const SHEAR_MODULUS: [f64; 2] = [1e-4, 300.0];

/// Largest pressure over the shear modulus of the softest material.
const PRESSURE: [f64; 2] = [5e-4, 50.0];

/// Accelerations in mm/s² that may be a weight.
const ACCELERATION: [f64; 2] = [100.0, 1e6];

/// Bulk modulus, MPa, that no material reaches which is this many times as stiff against a change of volume as against one of shape:
/// polymers have 1000 to 8000.
const BULK_MODULUS: f64 = 2e4;
const BULK_RATIO: f64 = 500.0;

/// What is worth a word about a problem that is followed to `end`, in the words of what it was written in; `model` has the tables that it was
/// built from.
pub fn cautions(
    problem: &Problem,
    end: LoadParameter,
    model: Option<&Model>,
    vocabulary: Vocabulary,
    probes: &[Probe],
) -> Vec<Warning> {
    let mut found: Vec<Caution> = Vec::new();
    found.extend(poor_elements(problem));
    found.extend(problem.asymmetries().iter().map(|twofold| two_of(problem, twofold)));
    found.extend(model.into_iter().flat_map(|model| regions(problem, model)));
    found.extend(probes.iter().filter_map(|probe| far_probe(problem, probe)));
    found.extend(driven_into_supports(problem, end));
    found.extend(unusual_size(problem));
    found.extend(unusual_materials(problem, end));
    found.extend(unusual_loads(problem, end));
    let warning = |Caution { occasion, message }| {
        let kind = match occasion {
            Occasion::PoorShapes => WarningKind::ElementShape,
            Occasion::Twofold => WarningKind::Symmetry,
            Occasion::FarProbe => WarningKind::Probe,
            Occasion::HeldInObstacle => WarningKind::Penetration,
            _ => WarningKind::Units,
        };
        let advice = vocabulary.advice(occasion, problem);
        Warning { kind, pressure_kpa: None, time: None, message, advice, occasion }
    };
    found.into_iter().map(warning).collect()
}

/// Something to be careful about.
struct Caution {
    occasion: Occasion,
    message: String,
}

impl Caution {
    fn new(occasion: Occasion, message: String) -> Self {
        Self { occasion, message }
    }
}

/// The element of the worst shape, its scaled Jacobian, and the number of poor ones.
pub fn worst_element(problem: &Problem) -> Option<(usize, f64, usize)> {
    let mut poor = 0;
    let qualities = problem.mesh.scaled_jacobians().enumerate().inspect(|(_, q)| poor += usize::from(*q < POOR_SHAPE));
    let (element, quality) = qualities.min_by(|(_, a), (_, b)| a.total_cmp(b))?;
    Some((element, quality, poor))
}

/// Where an element is: the mean of its corners, mm.
pub fn centre(problem: &Problem, element: usize) -> [f64; 3] {
    let mesh = &problem.mesh;
    let corners = mesh.corners(element);
    std::array::from_fn(|k| corners.iter().map(|&n| mesh.nodes[n as usize][k]).sum::<f64>() / corners.len() as f64)
}

fn poor_elements(problem: &Problem) -> Option<Caution> {
    let (element, quality, poor) = worst_element(problem)?;
    let [x, y, z] = centre(problem, element);
    let count = |n: usize| thousands(n as u64);
    let message = format!(
        "badly shaped elements: {} of {}; the worst, {}, near ({x:.2}, {y:.2}, {z:.2}) mm, has the scaled Jacobian {quality:.3} (good ones have 1, \
         flat ones 0); results near them are unreliable, and a run may stop there",
        count(poor),
        count(problem.mesh.num_elements()),
        element + 1
    );
    (poor > 0).then(|| Caution::new(Occasion::PoorShapes, message))
}

fn two_of(problem: &Problem, twofold: &Asymmetry) -> Caution {
    let what = match twofold.part {
        ProblemPart::Support(number) => format!("support {}", problem.supports[number].name),
        ProblemPart::Obstacle(number) => format!("obstacle {}", problem.obstacles[number].name),
        ProblemPart::Load(number) => match &problem.loads[number] {
            Load::Force { force, .. } => format!("a force of {force:?} N"),
            Load::Traction { traction, .. } => format!("a traction of {traction:?} MPa"),
            Load::Pressure { .. } | Load::Gravity { .. } => "a load".to_owned(),
        },
    };
    Caution::new(Occasion::Twofold, format!("{what}: {}", twofold.why))
}

fn regions(problem: &Problem, model: &Model) -> Vec<Caution> {
    let mut found = Vec::new();
    for region in &model.regions {
        let Some(corners) = region.within else { continue };
        for plane in problem.symmetry.iter().filter(|plane| problem.box_side(plane, corners) == BoxSide::Twofold) {
            let message = format!(
                "region {}: there are two of it, one on either side of the plane of symmetry {}",
                region.name,
                plane.words()
            );
            found.push(Caution::new(Occasion::Twofold, message));
        }
    }
    found
}

fn far_probe(problem: &Problem, probe: &Probe) -> Option<Caution> {
    let (node, distance) = problem.mesh.nearest_node(probe.at)?;
    let [x, y, z] = problem.mesh.nodes[node];
    let message = format!(
        "probe {} is {distance:.3} mm away from its nearest node, whose displacement it shows: ({x:.3}, {y:.3}, {z:.3}) mm",
        probe.name
    );
    let is_far = distance > FAR_PROBE * problem.mesh.extent();
    is_far.then(|| Caution::new(Occasion::FarProbe, message))
}

/// An obstacle that comes into what supports hold on its way, or supports that carry something into one.
fn driven_into_supports(problem: &Problem, end: LoadParameter) -> Option<Caution> {
    let of_obstacles = problem.obstacles.iter().filter_map(|obstacle| obstacle.motion.as_ref());
    let of_supports = problem.supports.iter().filter_map(|support| support.motion.as_ref());
    let curves = of_obstacles.chain(of_supports).map(|motion| &motion.curve);
    let (since, worst_at) = held_in_obstacle::way_in(problem, bends(curves, end), end)?;
    let clock = problem.clock;
    let message = format!("from {} on {}", clock.words(since), held_in_obstacle::words(problem, worst_at)?);
    Some(Caution::new(Occasion::HeldInObstacle, message))
}

fn is_unusual(value: f64, [low, high]: [f64; 2]) -> bool {
    !(low..=high).contains(&value)
}

fn unusual_size(problem: &Problem) -> Option<Caution> {
    let (extent, volume) = (problem.mesh.extent(), problem.mesh.volume());
    let message = format!("the body is {extent:.3e} mm long and has {volume:.3e} mm3");
    is_unusual(extent, EXTENT).then(|| Caution::new(Occasion::Size, message))
}

fn unusual_materials(problem: &Problem, end: LoadParameter) -> Vec<Caution> {
    let mut found = Vec::new();
    let (materials, of_element) = problem.materials();
    let mut is_used = vec![false; materials.len()];
    of_element.iter().for_each(|&number| is_used[usize::from(number)] = true);
    let used: Vec<&Material> = materials.into_iter().zip(&is_used).filter(|(_, used)| **used).map(|(m, _)| m).collect();
    let softest = used.iter().map(|material| material.shear_modulus()).fold(f64::INFINITY, f64::min);
    if softest.is_finite() && is_unusual(softest, SHEAR_MODULUS) {
        let message =
            format!("the softest material has a shear modulus of {softest:.3e} MPa; silicones have 0.01 to 2");
        found.push(Caution::new(Occasion::Modulus, message));
    }
    for material in used {
        let (density, bulk) = (material.density, material.bulk_modulus);
        if density > 0.0 && is_unusual(density, DENSITY) {
            let message = format!("a material has a density of {density:.3e} g/cm3; silicones have about 1.1");
            found.push(Caution::new(Occasion::Density, message));
        }
        if bulk > BULK_MODULUS && bulk > BULK_RATIO * material.shear_modulus() {
            let message = format!(
                "a material with a shear modulus of {:.4} MPa has a bulk modulus of {bulk:.3e} MPa; polymers have 1000 to 8000",
                material.shear_modulus()
            );
            found.push(Caution::new(Occasion::Bulk, message));
        }
    }
    let largest = largest_pressure(problem, end);
    if softest.is_finite() && softest > 0.0 && largest > 0.0 && is_unusual(largest / softest, PRESSURE) {
        let message = format!(
            "the largest pressure, {:.4} kPa, is {:.1e} times the shear modulus of the softest material, {softest:.4} MPa",
            1000.0 * largest,
            largest / softest
        );
        found.push(Caution::new(Occasion::Pressure, message));
    }
    found
}

/// Largest pressure that is prescribed, MPa: pressures on one face add up, however they are divided among tables.
fn largest_pressure(problem: &Problem, end: LoadParameter) -> f64 {
    let of_cavities = problem.cavities.iter().filter_map(|cavity| match &cavity.control {
        Control::Pressure(curve) => Some((&cavity.facets, curve)),
        Control::Volume(_) | Control::Gas(_) => None,
    });
    let of_faces = problem.loads.iter().filter_map(|load| match load {
        Load::Pressure { facets, curve } => Some((facets, curve)),
        Load::Force { .. } | Load::Traction { .. } | Load::Gravity { .. } => None,
    });
    let mut on_face: BTreeMap<Facet, Vec<usize>> = BTreeMap::new();
    let (mut curves, mut open) = (Vec::new(), Vec::new());
    for (number, (facets, curve)) in of_cavities.chain(of_faces).enumerate() {
        curves.push(curve);
        if facets.is_empty() {
            open.push(vec![number]);
        }
        facets.iter().for_each(|&facet| on_face.entry(facet).or_default().push(number));
    }
    let together: BTreeSet<Vec<usize>> = on_face.into_values().chain(open).collect();
    let largest = |together: &Vec<usize>| {
        let sum = |at: LoadParameter| together.iter().map(|&number| curves[number].at(at)).sum::<f64>().abs();
        bends(together.iter().map(|&number| curves[number]), end).into_iter().map(sum).fold(0.0, f64::max)
    };
    together.iter().map(largest).fold(0.0, f64::max)
}

/// Where the greatest sum of curves may be: at their bends and at the end.
fn bends<'a>(curves: impl IntoIterator<Item = &'a Curve>, end: LoadParameter) -> Vec<LoadParameter> {
    let of_curve = |curve: &Curve| match curve {
        Curve::Proportional(_) => Vec::new(),
        Curve::Table(points) => points.iter().map(|point| LoadParameter(point[0])).collect(),
    };
    curves.into_iter().flat_map(of_curve).chain([end]).collect()
}

/// An acceleration, mm/s², and its factor.
type Weight<'a> = ([f64; 3], &'a Curve);

/// Accelerations of the same elements add up, however they are divided among loads: a deck's has one for every axis.
fn unusual_loads(problem: &Problem, end: LoadParameter) -> Vec<Caution> {
    let mut of_elements: BTreeMap<Option<&Vec<u32>>, Vec<Weight<'_>>> = BTreeMap::new();
    for load in &problem.loads {
        if let Load::Gravity { elements, acceleration, curve } = load {
            of_elements.entry(elements.as_ref()).or_default().push((*acceleration, curve));
        }
    }
    let of_group = |group: Vec<Weight<'_>>| {
        let at = |time: LoadParameter| {
            let along =
                |d: usize| group.iter().map(|(acceleration, curve)| acceleration[d] * curve.at(time)).sum::<f64>();
            (0..3).map(|d| along(d).powi(2)).sum::<f64>().sqrt()
        };
        let largest = bends(group.iter().map(|(_, curve)| *curve), end).into_iter().map(at).fold(0.0, f64::max);
        let message = format!("the acceleration is {largest:.4} mm/s2; on earth it is 9810");
        (largest > 0.0 && is_unusual(largest, ACCELERATION)).then(|| Caution::new(Occasion::Acceleration, message))
    };
    of_elements.into_values().filter_map(of_group).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneuflex_mesh::ElementKind;
    use pneuflex_mesh::lattice::Lattice;
    use pneuflex_model::{Cavity, Formulation, Law};

    fn block(scale: f64) -> Problem {
        let mesh = Lattice::uniform([0.0; 3], [scale; 3], [1, 1, 1]).mesh_all(ElementKind::Tet10);
        Problem::body(mesh, Formulation::Tet10, Law::NeoHooke { c10: 0.1 }.into())
    }

    fn said(problem: &Problem) -> Vec<WarningKind> {
        cautions(problem, LoadParameter(1.0), None, Vocabulary::MeshModel, &[])
            .into_iter()
            .map(|warning| warning.kind)
            .collect()
    }

    #[test]
    fn what_looks_like_another_unit_gets_a_hint() {
        use WarningKind::Units;
        let right = block(10.0);
        assert_eq!(said(&right), []);
        assert_eq!(said(&block(0.01)), [Units]);
        let of = |change: &dyn Fn(&mut Material)| {
            let mut problem = right.clone();
            change(&mut problem.material);
            said(&problem)
        };
        assert_eq!(of(&|m| m.density = 1.1), []);
        assert_eq!(of(&|m| m.density = 7.8e12), [Units]);
        assert_eq!(of(&|m| m.density = 1.1e-9), [Units]);
        // c10 in Pa with the default's bulk modulus: both are said.
        assert_eq!(of(&|m| *m = Law::NeoHooke { c10: 1e5 }.into()), [Units, Units]);
        assert_eq!(of(&|m| *m = Law::NeoHooke { c10: 160.0 }.into()), [Units, Units]);
        assert_eq!(of(&|m| m.bulk_modulus = 6e5), [Units]);
        let gravity = |g: f64| {
            let curve = Curve::Table(vec![[0.0, 0.0], [1.0, 1.0]]);
            let load = Load::Gravity { elements: None, acceleration: [0.0, 0.0, -g], curve };
            said(&Problem { loads: vec![load], ..right.clone() })
        };
        assert_eq!((gravity(9810.0), gravity(9.81)), (vec![], vec![Units]));
        let along = |axis: usize, g: f64| {
            let acceleration = std::array::from_fn(|d| if d == axis { g } else { 0.0 });
            Load::Gravity { elements: None, acceleration, curve: Curve::Table(vec![[0.0, 0.0], [1.0, 1.0]]) }
        };
        let weighs = |loads: Vec<Load>| said(&Problem { loads, ..right.clone() });
        assert_eq!(weighs(vec![along(0, 8e5), along(2, -8e5)]), [Units]);
        assert_eq!(weighs(vec![along(0, 60.0), along(0, 60.0), along(2, 5.0)]), []);
        let pressure = |mpa: f64| {
            let control = Control::Pressure(Curve::Table(vec![[0.0, 0.0], [1.0, mpa]]));
            let cavity = Cavity { name: "air".into(), facets: Vec::new(), control };
            said(&Problem { cavities: vec![cavity], ..right.clone() })
        };
        assert_eq!((pressure(0.03), pressure(30.0), pressure(3e-5)), (vec![], vec![Units], vec![Units]));
    }

    /// The greatest sum on a face, not the sum of the greatest; what is on other faces does not count.
    #[test]
    fn pressures_add_up_face_by_face() {
        let face = |element| Facet { element, face: 0 };
        let of = |elements: &[u32], points: &[[f64; 2]]| {
            let facets = elements.iter().copied().map(face).collect();
            Load::Pressure { facets, curve: Curve::Table(points.to_vec()) }
        };
        let largest = |loads: Vec<Load>| largest_pressure(&Problem { loads, ..block(10.0) }, LoadParameter(1.0));
        let (up, peak) = ([[0.0, 0.0], [1.0, 3.0]], [[0.0, 0.0], [0.5, 4.0], [1.0, 0.0]]);
        assert_eq!(largest(vec![of(&[0, 1], &up), of(&[1], &up), of(&[2], &up)]), 6.0);
        assert_eq!(largest(vec![of(&[0], &up), of(&[0], &peak)]), 5.5);
        assert_eq!(largest(vec![of(&[0], &[[0.0, 0.0], [1.0, 30.0]]), of(&[0], &[[0.0, 0.0], [1.0, -29.0]])]), 1.0);
    }

    #[test]
    fn slivers_and_probes_beside_the_body_are_named() {
        let right = block(10.0);
        let mesh = (*right.mesh).clone().map_nodes(|[x, y, z]| [x + 40.0 * z, y, z]);
        let found = cautions(
            &Problem { mesh: mesh.into(), ..right.clone() },
            LoadParameter(1.0),
            None,
            Vocabulary::MeshModel,
            &[],
        );
        assert_eq!(found[0].kind, WarningKind::ElementShape);
        assert!(found[0].message.contains("of 6;"), "{}", found[0].message);
        let probe = |x: f64| far_probe(&right, &Probe { name: "p".into(), at: [x, 0.0, 0.0] });
        assert!(probe(10.4).is_none() && probe(11.0).unwrap().message.contains("1.000 mm away"));
    }
}
