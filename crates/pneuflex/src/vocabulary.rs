//! What things are called in each kind of file: the only place from which advice takes the names of keys.

use pneuflex_model::Problem;

use crate::analysis::{Analysis, Description};
use crate::body_file::is_deck;

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
    /// That of an analysis.
    pub fn of(analysis: &Analysis) -> Self {
        match &analysis.description {
            Description::Actuator(_) => Self::CaseFile,
            Description::Body(_) => Self::Program,
            Description::Model(..) if is_deck(&analysis.path) => Self::Deck,
            Description::Model(model, _) => match &model.model {
                None => Self::ActuatorModel,
                Some(source) if is_deck(source.file.as_ref()) => Self::DeckModel,
                Some(_) => Self::MeshModel,
            },
        }
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

    /// How load steps are made smaller.
    pub fn smaller_steps(self) -> &'static str {
        match self {
            Self::CaseFile => "smaller steps (solver.max_step_kpa, solver.first_step_kpa)",
            Self::ActuatorModel | Self::DeckModel | Self::MeshModel => {
                "smaller steps (solver.max_step, solver.first_step)"
            }
            Self::Deck => "smaller steps (*STATIC, DIRECT with a small first increment)",
            Self::Program => "smaller steps (Analysis::solver, max_step and first_step)",
        }
    }

    /// How the mesh is made finer.
    pub fn finer_mesh(self) -> &'static str {
        match self {
            Self::CaseFile | Self::ActuatorModel => "a finer mesh (mesh.resolution)",
            Self::DeckModel | Self::MeshModel | Self::Deck | Self::Program => "a finer mesh of the body",
        }
    }

    /// How better elements are chosen.
    pub fn better_elements(self) -> &'static str {
        match self {
            Self::CaseFile | Self::ActuatorModel => "mesh.element = \"hex27\"",
            Self::DeckModel | Self::Deck => "quadratic bricks (C3D20 or C3D27)",
            Self::MeshModel | Self::Program => "quadratic bricks (of 20 or 27 nodes)",
        }
    }

    /// How contact is made softer or stiffer.
    pub fn contact_stiffness(self, problem: &Problem) -> &'static str {
        let has_pairs = !problem.contact_pairs.is_empty();
        let has_tables = problem.contact_pairs.iter().any(|pair| pair.stiffness.is_some());
        match self {
            Self::CaseFile if has_pairs => "half or twice the contact.stiffness",
            Self::Deck => "half or twice the slope of *SURFACE BEHAVIOR",
            Self::Program => "half or twice the stiffness of the contact",
            _ if has_tables => "half or twice the stiffness of each [[contact]]",
            _ if !problem.obstacles.is_empty() => "half or twice the stiffness of each [[obstacle]]",
            _ => self.smaller_steps(),
        }
    }

    /// How a material is made more compressible.
    pub fn bulk_modulus(self) -> &'static str {
        match self {
            Self::CaseFile | Self::ActuatorModel | Self::DeckModel | Self::MeshModel => "a lower material.bulk_modulus",
            Self::Deck => "a larger D1 of *HYPERELASTIC",
            Self::Program => "a lower Material::bulk_modulus",
        }
    }

    /// How air is pumped in by its volume instead of its pressure.
    pub fn pump(self) -> &'static str {
        match self {
            Self::CaseFile => {
                "write the actuator into a model file, and pump a volume into its [[cavity]] (volume_mm3)"
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

    /// How a load of a given force is replaced by a motion.
    pub fn drive(self) -> &'static str {
        match self {
            Self::CaseFile => "write the actuator into a model file, and move it by a [[support]] with a displacement",
            Self::ActuatorModel | Self::DeckModel | Self::MeshModel => {
                "move the loaded nodes by a [[support]] with a displacement instead of loading them"
            }
            Self::Deck => "move the loaded nodes by *BOUNDARY instead of loading them",
            Self::Program => "move the loaded nodes with Body::displace instead of loading them",
        }
    }

    /// What the last position on the load path is called.
    pub fn position(self) -> &'static str {
        if self == Self::CaseFile { "pressure" } else { "time" }
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

    fn phrases(words: Vocabulary, problem: &Problem) -> Vec<&'static str> {
        vec![
            words.hold(),
            words.smaller_steps(),
            words.finer_mesh(),
            words.better_elements(),
            words.contact_stiffness(problem),
            words.bulk_modulus(),
            words.pump(),
            words.drive(),
        ]
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
                for key in keys(phrase) {
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
