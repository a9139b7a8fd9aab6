//! What things are called in each kind of file: the only place from which advice takes the names of keys.

use pneuflex_model::{Invariant, Material, Problem};

use crate::advice::{Occasion, Remedy};

/// What a problem was written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Vocabulary {
    /// The case file of an actuator.
    CaseFile,
    /// A model file with `[actuator]`.
    ActuatorModel,
    /// A model file around a deck.
    DeckModel,
    /// A model file around a mesh.
    MeshModel,
    /// A deck that is solved as it is.
    Deck,
    /// A program ([`crate::Body`]).
    Program,
}

impl Vocabulary {
    /// What is advised on an occasion, in words; without what this kind of file or this problem has not.
    pub fn advice(self, occasion: Occasion, problem: &Problem) -> String {
        let words: Vec<String> =
            occasion.remedies().iter().filter_map(|&remedy| self.words(remedy, occasion, problem)).collect();
        match &words[..] {
            [] => String::new(),
            [one] => one.clone(),
            [one, other] => format!("{one}, or {other}"),
            [most @ .., last] => format!("{}, or {last}", most.join(", ")),
        }
    }

    /// A remedy in words; `None` if this kind of file or this problem has it not.
    pub fn words(self, remedy: Remedy, occasion: Occasion, problem: &Problem) -> Option<String> {
        let is_model = matches!(self, Self::ActuatorModel | Self::DeckModel | Self::MeshModel);
        let is_actuator = matches!(self, Self::CaseFile | Self::ActuatorModel);
        let words = match remedy {
            Remedy::SmallerLoad if self == Self::CaseFile => "stay below this pressure".into(),
            // Loads without a table of their own reach their full value at the last time, whichever that is.
            Remedy::SmallerLoad => "lower the loads to what they are at this time".into(),
            Remedy::ThickerWalls => "make what stretches thicker".into(),
            Remedy::Stockier => "make what buckles there thicker or shorter (the last shape shows it)".into(),
            Remedy::FittedConstants => {
                "use constants that were fitted to larger stretches (`pneuflex fit` prints the range in which a set is stable)".into()
            }
            Remedy::Hold => self.hold().into(),
            Remedy::TouchAtRest => "let the part touch what is to hold it from the beginning".into(),
            Remedy::SmallerSteps => format!("take smaller steps ({})", self.steps()),
            Remedy::FinerMesh if is_actuator => {
                "use a finer mesh (mesh.resolution = \"standard\" or \"fine\", or a smaller mesh.size)".into()
            }
            Remedy::FinerMesh => "use a finer mesh, with two elements or more across walls".into(),
            Remedy::BetterElements => self.better_elements(problem)?.into(),
            Remedy::Isochoric => {
                let is_full = |material: &&Material| material.invariant == Invariant::Full;
                problem.materials().0.iter().find(|material| is_full(material))?;
                self.isochoric()?.into()
            }
            Remedy::OtherStiffness => self.contact_stiffness("try half or twice", problem)?,
            Remedy::StifferContact => self.contact_stiffness("raise", problem)?,
            Remedy::StifferObstacle if self == Self::Program => "raise the stiffness of the obstacle".into(),
            // A deck has no obstacles, a case and a model have tables of them.
            Remedy::StifferObstacle => "raise the stiffness of the [[obstacle]]".into(),
            Remedy::ClearOfSupports => {
                "keep the obstacle away from what supports hold, by a shorter way or in another direction".into()
            }
            Remedy::PenetrationTolerance if self == Self::CaseFile => "set contact.penetration_tolerance".into(),
            Remedy::MultiPoint if self == Self::CaseFile => "set contact.method = \"multi-point\"".into(),
            Remedy::SelfContact if self == Self::CaseFile => "set contact.self_contact = true".into(),
            Remedy::SelfContact if self == Self::ActuatorModel => {
                "add a [[contact]] with slave = \"outer\" and master = \"outer\"".into()
            }
            Remedy::PumpVolume if problem.cavities.is_empty() => return None,
            Remedy::PumpVolume => self.pump().into(),
            Remedy::PrescribeMotion => self.drive().into(),
            Remedy::Imperfection => self.imperfection().into(),
            Remedy::ArcLength => self.arc_length().into(),
            Remedy::LetSnap => self.let_snap().into(),
            Remedy::Memory => {
                "use a coarser mesh, end other programs, or raise the limit of this one (of a container, or `ulimit -v`)".into()
            }
            // A deck has no key for it.
            Remedy::ResidualTolerance if self == Self::Deck => return None,
            Remedy::ResidualTolerance if self == Self::Program => {
                "raise residual_tolerance of Analysis::solver above what rounding leaves".into()
            }
            Remedy::ResidualTolerance => "raise solver.residual_tolerance above what rounding leaves".into(),
            Remedy::Equations => "mend what the message names".into(),
            Remedy::ErrorBars if matches!(self, Self::CaseFile | Self::ActuatorModel) => "let `pneuflex converge` give error bars".into(),
            Remedy::BetterShapes if is_actuator => {
                "take hexahedra (mesh.element = \"hex27\"), or a smaller mesh.edge_size".into()
            }
            Remedy::BetterShapes => "improve the mesh (Gmsh: Mesh.Optimize, or another size)".into(),
            Remedy::WholeBody if is_actuator => "if there is only one, set actuator.part = \"whole\"".into(),
            Remedy::WholeBody => "if there is only one, model the whole body, without the [[support]] of symmetry".into(),
            Remedy::MoveProbe => "put it on the body at rest".into(),
            Remedy::Lengths if matches!(self, Self::DeckModel | Self::MeshModel) => {
                "lengths are in mm: model.scale = 1000 takes a mesh in metres".into()
            }
            Remedy::Lengths if self == Self::Deck => {
                "lengths are in mm: a deck in metres must be converted, its moduli and loads too".into()
            }
            Remedy::Lengths => "lengths are in mm".into(),
            Remedy::Moduli => "if that is not what is meant: moduli are in MPa (1 kPa is 0.001, 1 Pa is 0.000001)".into(),
            Remedy::Densities if self == Self::Deck => "*DENSITY is in t/mm3, 1.1e-9 for silicone".into(),
            Remedy::Densities => "density is in g/cm3, 1.1 for silicone".into(),
            Remedy::BulkModulus => {
                let key = if self == Self::Deck { "give D1 of *HYPERELASTIC" } else { "set bulk_modulus" };
                format!(
                    "{key}: the default keeps rubber's ratio to the shear modulus; stiff layers of paper, fabric or plastic have one to \
                     five times their shear modulus"
                )
            }
            Remedy::Pressures if occasion == Occasion::HardlyMoves => "pressures are in kPa, lengths in mm".into(),
            Remedy::Pressures if self == Self::Deck => "pressures are in MPa, as moduli are".into(),
            Remedy::Pressures if self == Self::Program => "mind the unit: moduli are in MPa".into(),
            Remedy::Pressures => "pressures are in kPa; moduli are in MPa".into(),
            Remedy::Accelerations if is_model => {
                "gravity.acceleration is in mm/s2: [0, 0, -9810] with z upwards".into()
            }
            Remedy::Accelerations => "accelerations are in mm/s2: 9810 on earth".into(),
            Remedy::MultiPoint if is_model => "set method = \"multi-point\" in its [[contact]]".into(),
            Remedy::PenetrationTolerance | Remedy::MultiPoint | Remedy::SelfContact | Remedy::ErrorBars => return None,
        };
        Some(words)
    }

    /// How a part is held.
    pub fn hold(self) -> &'static str {
        match self {
            Self::CaseFile => "write the actuator into a model file, and add a [[support]]",
            Self::ActuatorModel | Self::DeckModel | Self::MeshModel => {
                "add a [[support]] with nodes = \"a set\" and axes = \"xyz\", or some of them"
            }
            Self::Deck => "add a *BOUNDARY before the first step: set, first axis, last axis",
            Self::Program => "hold a set of nodes with Body::hold",
        }
    }

    /// What makes load steps smaller.
    fn steps(self) -> &'static str {
        match self {
            Self::CaseFile => "solver.max_step_kpa, solver.first_step_kpa and solver.min_step_kpa",
            Self::ActuatorModel | Self::DeckModel | Self::MeshModel => {
                "solver.max_step, solver.first_step and solver.min_step"
            }
            Self::Deck => "the first, smallest and largest increment of *STATIC",
            Self::Program => "max_step, first_step and min_step of Analysis::solver",
        }
    }

    /// Elements of a higher order than those of the problem, if they can be chosen.
    fn better_elements(self, problem: &Problem) -> Option<&'static str> {
        let element = problem.formulation.element;
        match self {
            _ if element.is_quadratic() && element.enriched().is_none() => None,
            Self::CaseFile | Self::ActuatorModel => Some("take better elements (mesh.element = \"hex27\")"),
            Self::DeckModel | Self::MeshModel if element.enriched().is_some() => {
                Some("leave out mesh.element, which keeps elements as the file has them")
            }
            Self::DeckModel | Self::Deck => Some("take quadratic bricks (C3D20)"),
            Self::MeshModel | Self::Program => Some("take bricks of 20 or 27 nodes (in Gmsh: second order)"),
        }
    }

    /// How the isochoric invariant is chosen.
    fn isochoric(self) -> Option<&'static str> {
        match self {
            Self::CaseFile | Self::ActuatorModel | Self::DeckModel | Self::MeshModel => {
                Some("take the isochoric invariant (material.invariant = \"isochoric\")")
            }
            // Laws of a deck have it.
            Self::Deck => None,
            Self::Program => Some("take Invariant::Isochoric"),
        }
    }

    /// What is to be done with the stiffness of the contact.
    fn contact_stiffness(self, what: &str, problem: &Problem) -> Option<String> {
        let has_pairs = !problem.contact_pairs.is_empty();
        let has_tables = problem.contact_pairs.iter().any(|pair| pair.stiffness.is_some());
        let of = match self {
            Self::CaseFile if has_pairs => format!("contact.stiffness, which is {}", problem.contact.stiffness),
            Self::Deck if has_pairs => "the slope of *SURFACE BEHAVIOR".into(),
            Self::Program if has_pairs => "the stiffness of the contact".into(),
            Self::ActuatorModel if has_pairs && !has_tables => {
                "the stiffness of the gaps (a [[contact]] with slave = \"gap_1_left\", master = \"gap_1_right\", and so on)".into()
            }
            _ if has_tables => "the stiffness of each [[contact]]".into(),
            _ if !problem.obstacles.is_empty() => "the stiffness of each [[obstacle]]".into(),
            _ => return None,
        };
        Some(format!("{what} {of}"))
    }

    /// How air is pumped in by its volume instead of its pressure.
    fn pump(self) -> &'static str {
        match self {
            Self::CaseFile => {
                "write the actuator into a model file, and pump a volume into its [[cavity]] (volume_mm3): a volume passes the limit"
            }
            Self::ActuatorModel | Self::DeckModel | Self::MeshModel => {
                "pump a volume into the [[cavity]] (volume_mm3 instead of pressure_kpa): a volume passes the limit"
            }
            Self::Deck => {
                "write a model file around the deck, and pump a volume into a [[cavity]] (volume_mm3): a volume passes the limit"
            }
            Self::Program => "pump a volume into the cavity instead of giving its pressure: a volume passes the limit",
        }
    }

    /// How a body is led on where it buckles.
    fn imperfection(self) -> &'static str {
        match self {
            Self::Program => "let it buckle (Solver::imperfection, mm)",
            Self::Deck => "let it buckle, in a model file around the deck",
            Self::CaseFile | Self::ActuatorModel | Self::DeckModel | Self::MeshModel => {
                "let it buckle (solver.imperfection, a tenth of the thickness of what buckles, mm)"
            }
        }
    }

    /// How a path is followed beyond a greatest load.
    fn arc_length(self) -> &'static str {
        match self {
            Self::Program => "follow the path past it with Continuation::ArcLength",
            Self::Deck => "follow the path past it by its arc length, in a model file around the deck",
            Self::CaseFile | Self::ActuatorModel | Self::DeckModel | Self::MeshModel => {
                "follow the path past it (solver.continuation = \"arc-length\")"
            }
        }
    }

    /// How a body is led to its next stable shape.
    fn let_snap(self) -> &'static str {
        match self {
            Self::Program => "let it snap to its next stable shape with Continuation::Damped",
            Self::Deck => {
                "let it snap to its next stable shape by damped continuation, in a model file around the deck"
            }
            Self::CaseFile | Self::ActuatorModel | Self::DeckModel | Self::MeshModel => {
                "let it snap to its next stable shape (solver.continuation = \"damped\")"
            }
        }
    }

    /// How a load of a given force is replaced by a motion.
    fn drive(self) -> &'static str {
        match self {
            Self::CaseFile => "write the actuator into a model file, and move it by a [[support]] with a displacement",
            Self::ActuatorModel | Self::DeckModel | Self::MeshModel => {
                "move the loaded nodes by a [[support]] with a displacement instead of loading them"
            }
            Self::Deck => "move the loaded nodes by *BOUNDARY instead of loading them",
            Self::Program => "move the loaded nodes with Body::displace instead of loading them",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Study;

    const ALL: [Vocabulary; 6] = [
        Vocabulary::CaseFile,
        Vocabulary::ActuatorModel,
        Vocabulary::DeckModel,
        Vocabulary::MeshModel,
        Vocabulary::Deck,
        Vocabulary::Program,
    ];

    /// Everything that can be advised.
    fn phrases(words: Vocabulary, problem: &Problem) -> Vec<String> {
        Occasion::ALL.iter().map(|&occasion| words.advice(occasion, problem)).collect()
    }

    /// What looks like a key: `table.name`.
    fn keys(phrase: &str) -> Vec<&str> {
        let words = phrase.split(|c: char| !(c.is_ascii_lowercase() || c == '.' || c == '_'));
        words
            .filter(|word| word.split('.').filter(|part| !part.is_empty()).count() == 2 && !word.starts_with('.'))
            .collect()
    }

    /// Every key that is named is one of that kind of file, which takes it.
    #[test]
    fn advice_names_keys_that_the_file_has() {
        let case = crate::template::two_chambers();
        let problem = Study::from_text("case.toml", &case).unwrap().build().unwrap().problem;
        let start = case.find("[actuator]").unwrap();
        let actuator: String = case[start..].split("\n\n").next().unwrap().to_owned();
        let model = format!(
            "{actuator}\n[load]\ntimes = [1.0]\n[[cavity]]\nname = \"air\"\nfaces = \"cavity\"\npressure_kpa = 1.0\n"
        );
        let value = |key: &str| match key {
            "mesh.resolution" => "draft",
            "mesh.element" => "hex27",
            "contact.method" => "multi-point",
            "contact.self_contact" => "true",
            "material.invariant" => "isochoric",
            "actuator.part" => "whole",
            "solver.continuation" => "arc-length",
            "gravity.acceleration" => "[0, 0, -9810]",
            _ => "0.5",
        };
        let mut named = 0;
        for words in ALL {
            let text = match words {
                Vocabulary::CaseFile => Some(case.clone()),
                Vocabulary::ActuatorModel => Some(model.clone()),
                Vocabulary::DeckModel | Vocabulary::MeshModel => Some("[model]\nfile = \"body.msh\"\n".to_owned()),
                Vocabulary::Deck | Vocabulary::Program => None,
            };
            for phrase in phrases(words, &problem) {
                for key in keys(&phrase) {
                    let text = text.as_ref().unwrap_or_else(|| panic!("{words:?} has no keys: {phrase}"));
                    let mut study = Study::from_text("file.toml", text).unwrap();
                    study.set(key, value(key)).unwrap_or_else(|error| panic!("{words:?}: {key}: {error}"));
                    // An imported body has its mesh from its file.
                    let is_imported = matches!(words, Vocabulary::DeckModel | Vocabulary::MeshModel);
                    assert!(!(is_imported && key.starts_with("mesh.")), "{words:?}: {phrase}");
                    named += 1;
                }
            }
        }
        assert!(named > 10, "the test would be empty: {named}");
    }
}
