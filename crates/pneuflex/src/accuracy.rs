//! How exact results on the mesh of an actuator are: what was measured on kinds of designs (`cargo xtask accuracy`, the table in the guide),
//! and whether a design is of these kinds.

use std::f64::consts::PI;

use pneuflex_mesh::{Actuator, Chamber, MeshSize};
use pneuflex_model::{Formulation, LoadParameter, MeshOptions, Problem};
use pneuflex_post::summary::StepSummary;

/// How fine the mesh of an actuator is, by the size of elements at its re-entrant edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Fineness {
    /// Like `draft`: 2.8 times the thinnest wall.
    Draft,
    /// Like `standard`: 1.4 times.
    Standard,
    /// Like `fine`: 0.7 times.
    Fine,
}

/// Sizes over the thinnest wall of the three meshes, with some room for rounding.
const SIZES: [(Fineness, f64); 3] = [(Fineness::Fine, 0.71), (Fineness::Standard, 1.41), (Fineness::Draft, 2.81)];

impl Fineness {
    /// That of a mesh; `None` for one that is coarser than `draft`.
    fn of(size: &MeshSize, actuator: &Actuator) -> Option<Self> {
        let largest = size.size.into_iter().fold(0.0, f64::max);
        let ratio = size.edge.min(largest) / actuator.thinnest_wall();
        SIZES.into_iter().find(|(_, limit)| ratio <= *limit).map(|(fineness, _)| fineness)
    }

    /// Its name in a case file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Draft => "draft",
            Self::Standard => "standard",
            Self::Fine => "fine",
        }
    }

    /// Largest errors on designs like those of the table, percent.
    pub fn bounds(self) -> Bounds {
        match self {
            Self::Draft => Bounds { displacement: 10.0, volume_change: 10.0, stress: 25.0 },
            Self::Standard => Bounds { displacement: 10.0, volume_change: 15.0, stress: 15.0 },
            Self::Fine => Bounds { displacement: 2.0, volume_change: 3.0, stress: 15.0 },
        }
    }
}

/// Largest errors that were found on designs that are not [`Expected::outside`], rounded up, percent; `cargo xtask accuracy` fails if they do
/// not hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Of the angles of the end face and of the line from the clamp to the tip, and of the tip's displacement.
    pub displacement: f64,
    /// Of the growth of the cavities.
    pub volume_change: f64,
    /// Of the von Mises stress that 99 % of the volume stays below.
    pub stress: f64,
}

impl std::fmt::Display for Bounds {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { displacement, volume_change, stress } = self;
        write!(
            f,
            "{displacement} % in angle and tip displacement, {volume_change} % in the growth of the cavities and {stress} % in the 99 % stress"
        )
    }
}

/// A parameter of a design that lies outside the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Outside {
    /// Which.
    pub parameter: Parameter,
    /// First position on the load path at which it does; `None` if it always does.
    pub when: Option<LoadParameter>,
    /// Its value and what the table has, in words.
    pub what: String,
}

/// What the table's designs are described by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// The size of elements over the thinnest wall.
    Mesh,
    /// The family of the elements.
    Element,
    /// Spans of walls over their thickness.
    Walls,
    /// The base over the thinnest wall.
    Base,
    /// The base above and below the channel over the thinnest wall.
    Channel,
    /// Gaps between the chambers.
    Gap,
    /// Chambers that are not alike.
    Chambers,
    /// Pressures that are not the same in all chambers.
    Air,
    /// Bending beside the stretch that the air gives.
    WeakBending,
    /// Angle per chamber.
    StrongBending,
}

impl Parameter {
    /// Short name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mesh => "mesh",
            Self::Element => "element",
            Self::Walls => "walls",
            Self::Base => "base",
            Self::Channel => "channel",
            Self::Gap => "gap",
            Self::Chambers => "chambers",
            Self::Air => "air",
            Self::WeakBending => "weak bending",
            Self::StrongBending => "strong bending",
        }
    }
}

/// What can be expected of the results for an actuator.
#[derive(Clone, Debug, PartialEq)]
pub struct Expected {
    /// How fine the mesh is; `None` for one coarser than any that was measured.
    pub fineness: Option<Fineness>,
    /// In what it is unlike the designs of the table.
    pub outside: Vec<Outside>,
}

impl Expected {
    /// Largest errors that were found on such designs; `None` if it is unlike them.
    pub fn bounds(&self) -> Option<Bounds> {
        self.fineness.filter(|_| self.outside.is_empty()).map(Fineness::bounds)
    }

    /// Position on the load path from which on it is unlike the table's designs; `None` if it always is, or never.
    pub fn since(&self) -> Option<LoadParameter> {
        let first = |when: Vec<LoadParameter>| when.into_iter().reduce(|a, b| if b.0 < a.0 { b } else { a });
        self.outside.iter().map(|outside| outside.when).collect::<Option<_>>().and_then(first)
    }
}

/// Ranges of the table's designs.
mod range {
    /// Shorter span of a wall over its thickness.
    pub const SLENDERNESS: f64 = 20.0;
    /// Base over the thinnest wall.
    pub const BASE: f64 = 2.0;
    /// Thinner part of the base at the channel over the thinnest wall.
    pub const CHANNEL: f64 = 0.3;
    /// Strain that bending puts across the height over the mean strain that the air would give the section.
    pub const BENDING: f64 = 2.5;
    /// Angle per chamber, degrees.
    pub const ANGLE: f64 = 20.0;
}

/// What can be expected of the results `steps` for an actuator on a mesh. Without results, what is known before anything is solved.
pub fn expected(problem: &Problem, actuator: &Actuator, mesh: &MeshOptions, steps: &[StepSummary]) -> Expected {
    let fineness = Fineness::of(&mesh.mesh_size(actuator), actuator);
    let mut outside = Vec::new();
    let mut add = |parameter, when, what: String| outside.push(Outside { parameter, when, what });
    let thinnest = actuator.thinnest_wall();
    if fineness.is_none() {
        let what =
            "elements at the inner edges of the body are more than 2.8 times as large as the thinnest wall".into();
        add(Parameter::Mesh, None, what);
    }
    let formulation = mesh.formulation();
    if formulation != Formulation::Hex27 {
        let what = match formulation {
            Formulation::Hex20 => "hex20 elements had up to twice the errors of hex27",
            Formulation::Tet10 => "tet10 elements had up to three times the errors of hex27",
            Formulation::Tet15 => "errors of tet15 elements were not measured",
            Formulation::Wedge21 => "errors of wedge21 elements were not measured",
            _ => "errors of linear elements were not measured",
        };
        add(Parameter::Element, None, what.into());
    }
    let (slenderness, which) = slenderness(actuator);
    if slenderness > range::SLENDERNESS {
        let what = format!(
            "the {which} walls span {slenderness:.0} times their thickness, at the most {:.0}",
            range::SLENDERNESS
        );
        add(Parameter::Walls, None, what);
    }
    let base = actuator.base / thinnest;
    if base < range::BASE {
        add(
            Parameter::Base,
            None,
            format!("the base is {base:.1} times as thick as the thinnest wall, at the least {:.0}", range::BASE),
        );
    }
    if let Some((part, thickness)) = thinner_at_channel(actuator).filter(|(_, t)| t / thinnest < range::CHANNEL) {
        let ratio = thickness / thinnest;
        let what = format!(
            "the base {part} the channel is {ratio:.2} times as thick as the thinnest wall, at the least {}",
            range::CHANNEL
        );
        add(Parameter::Channel, None, what);
    }
    if actuator.gaps() + 1 < actuator.chambers {
        add(Parameter::Gap, None, "chambers without a gap between them were not measured".into());
    }
    if let Some(key) = actuator.first_varied() {
        add(Parameter::Chambers, None, format!("chambers that differ in {key} were not measured"));
    }
    let of_chambers: Vec<_> = problem.cavities.iter().map(|cavity| &cavity.control).collect();
    if of_chambers.windows(2).any(|pair| pair[0] != pair[1]) {
        add(Parameter::Air, None, "chambers whose air is not the same were not measured".into());
    }
    let is_air_alone = problem.loads.is_empty()
        && problem.obstacles.is_empty()
        && problem.equations.is_empty()
        && problem.distances.is_empty()
        && problem.supports.iter().all(|support| support.motion.is_none())
        && problem.cavities.len() == 1;
    let angle = |step: &StepSummary| step.end_face_angle_deg.map(|angle| angle / actuator.chambers as f64);
    let is_weak =
        |step: &&StepSummary| bending(problem, actuator, step).is_some_and(|bending| bending < range::BENDING);
    if let Some(step) = steps.iter().find(is_weak).filter(|_| is_air_alone) {
        let bending = bending(problem, actuator, step).unwrap_or_default();
        let what = format!(
            "it bends little beside the stretch that the air gives it: across the height, bending strains it {bending:.1} times as much, at the \
             least {}, so that the bending is a small difference of large effects",
            range::BENDING
        );
        add(Parameter::WeakBending, Some(step.when()), what);
    }
    if let Some(step) = steps.iter().find(|step| angle(step).is_some_and(|angle| angle.abs() > range::ANGLE)) {
        let angle = angle(step).unwrap_or_default().abs();
        add(
            Parameter::StrongBending,
            Some(step.when()),
            format!("it bends by {angle:.0} degrees per chamber, at the most {:.0}", range::ANGLE),
        );
    }
    Expected { fineness, outside }
}

/// Largest ratio of the shorter span of a wall around a cavity to its thickness, and which walls have it.
fn slenderness(actuator: &Actuator) -> (f64, &'static str) {
    let of_chamber = |chamber: Chamber| {
        let [length, width, height] = inside(actuator, &chamber);
        let end = chamber.cavity[0] - chamber.start;
        [
            (width.min(height) / end, "end"),
            (length.min(height) / chamber.side_wall, "side"),
            (length.min(width) / chamber.top_wall, "top"),
        ]
    };
    let walls = actuator.row().into_iter().flat_map(of_chamber);
    walls.fold((0.0, "end"), |most, wall| if wall.0 > most.0 { wall } else { most })
}

/// Length, width and height of a cavity, mm.
fn inside(actuator: &Actuator, chamber: &Chamber) -> [f64; 3] {
    [
        chamber.cavity[1] - chamber.cavity[0],
        actuator.width - 2.0 * chamber.side_wall,
        actuator.height - actuator.floor() - chamber.top_wall,
    ]
}

/// The thinner part of the base at the channel and its thickness, mm.
fn thinner_at_channel(actuator: &Actuator) -> Option<(&'static str, f64)> {
    let channel = &actuator.channel;
    let (below, above) = (channel.bottom, actuator.base - channel.top);
    let thinner = if below <= above { ("below", below) } else { ("above", above) };
    (channel.half_width > 0.0).then_some(thinner)
}

/// The strain that bending puts across the height of a chamber, θ H / l with the angle θ and the length l of a chamber, over the mean
/// strain p A / (3 μ S) that the air would give its section, with the cross-section A of the cavity, S of the walls and base around it, and
/// the shear modulus μ. Both are of one order where an actuator bends because the air acts beside its stiff base; where the ratio is small
/// or negative, bending to one side nearly cancels that to the other. `None` without air.
fn bending(problem: &Problem, actuator: &Actuator, step: &StepSummary) -> Option<f64> {
    let row = actuator.row();
    let pressure_kpa = step.cavities.values().next().map_or(step.pressure_kpa, |cavity| cavity.pressure_kpa);
    // Of chambers that differ, the sums over all of them, by their lengths.
    let (mut length, mut stretch) = (0.0, 0.0);
    for chamber in &row {
        let [_, width, height] = inside(actuator, chamber);
        let air = width * height;
        let solid = actuator.width * actuator.height - air;
        let of_chamber = chamber.end - chamber.start;
        length += of_chamber;
        stretch += of_chamber * 1e-3 * pressure_kpa * air / (3.0 * problem.material.shear_modulus() * solid);
    }
    let strain = stretch / length;
    let bending = step.end_face_angle_deg? * PI / 180.0 * actuator.height / length;
    (strain != 0.0).then_some(bending / strain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Study;
    use crate::template;

    /// Fineness and what is outside before anything is solved.
    fn of(text: &str, changes: &[(&str, &str)]) -> (Option<Fineness>, Vec<Parameter>) {
        let mut study = Study::from_text("finger.toml", text).unwrap();
        let changes = changes.iter().map(|&(key, value)| crate::Change::new(key, value));
        study.set_all(changes).unwrap();
        let expected = study.build().unwrap().expected(&[]).unwrap();
        (expected.fineness, expected.outside.into_iter().map(|outside| outside.parameter).collect())
    }

    #[test]
    fn every_mesh_of_the_paper_is_like_those_of_the_table() {
        for text in [template::two_chambers(), template::full_actuator()] {
            for (name, fineness) in
                [("draft", Fineness::Draft), ("standard", Fineness::Standard), ("fine", Fineness::Fine)]
            {
                assert_eq!(of(&text, &[("mesh.resolution", name)]), (Some(fineness), vec![]), "{name}");
            }
        }
    }

    #[test]
    fn what_is_outside_is_named() {
        let two = template::two_chambers();
        let outside = |changes: &[(&str, &str)]| of(&two, changes).1;
        assert_eq!(of(&two, &[("mesh.size", "1.0")]), (Some(Fineness::Standard), vec![]));
        assert_eq!(of(&two, &[("mesh.size", "4.0")]), (None, vec![Parameter::Mesh]));
        assert_eq!(outside(&[("mesh.element", "hex20")]), [Parameter::Element]);
        assert_eq!(outside(&[("actuator.top_wall", "0.1")]), [Parameter::Walls]);
        let base = [("actuator.base", "1.5"), ("actuator.channel.bottom", "0.5"), ("actuator.channel.top", "1.0")];
        assert_eq!(outside(&base), [Parameter::Base]);
        assert_eq!(outside(&[("actuator.channel.bottom", "0.2")]), [Parameter::Channel]);
        assert_eq!(outside(&[("actuator.channel.top", "3.8")]), [Parameter::Channel]);
        assert_eq!(outside(&[("actuator.channel.top", "3.8"), ("actuator.channel.half_width", "0.0")]), []);
        assert_eq!(outside(&[("actuator.gap", "0.0")]), [Parameter::Gap]);
        assert_eq!(outside(&[("actuator.gap", "0.0"), ("actuator.chambers", "1")]), []);
    }
}
