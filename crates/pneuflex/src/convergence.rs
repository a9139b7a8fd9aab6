//! The same problem on finer and finer meshes, and what that says about the exact answer.

use std::time::Instant;

use pneuflex_model::{Clock, Problem};
use pneuflex_post::convergence::{Extrapolated, extrapolate};
use pneuflex_post::summary::StepSummary;
use serde::{Serialize, Serializer};

use crate::analysis::{Analysis, Description};
use crate::error::{Error, ResultsError};
use crate::input_error::InputError;
use crate::memory::{Estimate, MemoryLimit};
use crate::quantities::{Quantity, Rest, by_key};

/// `converge.json`. Its keys are a contract: later versions add to them.
#[derive(Clone, Debug, Serialize)]
pub struct Convergence {
    /// This program.
    pub program: &'static str,
    /// Its version.
    pub version: &'static str,
    /// Title of the case.
    pub title: String,
    /// Names of the elements' formulations.
    pub element: String,
    /// One per mesh, the coarsest first.
    pub levels: Vec<Level>,
    /// One per pressure or time that was reached on every mesh.
    pub results: Vec<AtState>,
    /// Why it ended before the finest mesh, if it did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}

/// One mesh.
#[derive(Clone, Debug, Serialize)]
pub struct Level {
    /// Number of parts into which every element of the body's own mesh is divided along every direction.
    pub divisions: usize,
    /// Number of elements.
    pub elements: usize,
    /// Number of unknown displacements.
    pub unknowns: usize,
    /// Edge of a cube with the mean volume of an element, mm.
    pub element_size_mm: f64,
    /// Seconds spent.
    pub seconds: f64,
    /// Newton iterations.
    pub iterations: usize,
    /// One per pressure or time that was reached.
    pub steps: Vec<Measured>,
}

/// What is compared.
#[derive(Clone, Debug, Serialize)]
pub struct Measured {
    /// Time of a schedule, if that is followed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    /// Pressure, kPa; that of the first cavity where a schedule is followed.
    pub pressure_kpa: f64,
    /// The numbers, by their keys.
    #[serde(flatten, serialize_with = "by_key")]
    pub quantities: Vec<Quantity>,
}

/// Extrapolations at one pressure or time.
#[derive(Clone, Debug, Serialize)]
pub struct AtState {
    /// Time of a schedule, if that is followed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    /// Pressure on the coarsest mesh, kPa.
    pub pressure_kpa: f64,
    /// The numbers, by their keys.
    #[serde(flatten, serialize_with = "extrapolated_by_key")]
    pub compared: Vec<Compared>,
}

/// One number on all meshes.
#[derive(Clone, Debug)]
pub struct Compared {
    /// The number on the finest mesh.
    pub quantity: Quantity,
    /// Its values, on the coarsest mesh first.
    pub values: Vec<f64>,
    /// What they approach.
    pub extrapolated: Extrapolated,
}

fn extrapolated_by_key<S: Serializer>(compared: &[Compared], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(compared.iter().map(|one| (&one.quantity.key, &one.extrapolated)))
}

impl Measured {
    /// Where on the load path, in words.
    pub fn when(&self) -> String {
        in_words(self.time, self.pressure_kpa)
    }
}

impl AtState {
    /// Where on the load path, in words.
    pub fn when(&self) -> String {
        in_words(self.time, self.pressure_kpa)
    }
}

fn in_words(time: Option<f64>, pressure_kpa: f64) -> String {
    time.map_or_else(|| format!("{pressure_kpa} kPa"), |time| format!("time {time}"))
}

/// What a listener is told of a mesh.
#[derive(Clone, Copy, Debug)]
pub enum LevelEvent<'a> {
    /// It is about to be solved.
    Started {
        /// Number of parts into which every element of the body's own mesh is divided along every direction.
        divisions: usize,
        /// Number of unknown displacements.
        unknowns: usize,
    },
    /// It was solved as far as it could be.
    Finished(&'a Level),
}

/// Meshes that are to be solved on.
pub struct Sequence<'a> {
    analysis: &'a Analysis,
    levels: usize,
    /// The second one: by it, it was found out whether the mesh can be divided.
    second: Analysis,
}

impl Analysis {
    /// Its own mesh and finer ones, at least two in all. An actuator's case has its elements divided by 2, 3 and so on along every direction,
    /// any other body by 2, 4 and so on, in the shape that they have. Probes are at the same nodes on all.
    ///
    /// # Errors
    /// [`Error::Input`] for a mesh that cannot be divided, or a finest one beyond the memory limit.
    pub fn finer_meshes(&self, levels: usize, limit: MemoryLimit) -> Result<Sequence<'_>, Error> {
        let finest = match &self.description {
            Description::Actuator(case) => {
                Estimate::of_size(case, &case.mesh.mesh_size(&case.actuator).divided(levels))
            }
            Description::Model(..) | Description::Body(_) => {
                Estimate::of_divided(&self.problem.mesh, levels.saturating_sub(1) as u32)
            }
        };
        let fewer = "compare two meshes only (--levels 2), or begin with a coarser one".to_owned();
        finest.within(limit).map_err(|error| error.with_help(Some(fewer)))?;
        Ok(Sequence { analysis: self, levels: levels.max(2), second: self.finer(self, 2)? })
    }

    /// A mesh of the sequence; `before` is the one before it.
    fn finer(&self, before: &Self, number: usize) -> Result<Self, Error> {
        match &self.description {
            Description::Actuator(case) => {
                let size = case.mesh.mesh_size(&case.actuator).divided(number);
                let problem = Problem::from_case_on(case, &size);
                let problem = problem.map_err(|e| InputError::new(e.to_string()).of_key(&e.key))?;
                Ok(Self { problem, probes: self.probes_at_nodes(), ..self.clone() })
            }
            Description::Model(..) | Description::Body(_) => Ok(before.divided()?.0),
        }
    }
}

impl Sequence<'_> {
    /// Solves on every mesh. One on which the path ends early ends the sequence, too: see [`Convergence::failure`].
    ///
    /// # Errors
    /// A mesh that cannot be made.
    pub fn solve(self, listener: &mut dyn FnMut(LevelEvent<'_>)) -> Result<Convergence, Error> {
        let Self { analysis, levels, second } = self;
        let (mut solved, mut failure): (Vec<Level>, _) = (Vec::new(), None);
        let (mut present, mut next) = (analysis.clone(), Some(second));
        // The sequence itself says how exact its meshes are.
        present.output.error_estimate = false;
        for number in 1..=levels {
            let divisions = match &analysis.description {
                Description::Actuator(_) => number,
                Description::Model(..) | Description::Body(_) => 1 << (number - 1),
            };
            if number > 1 {
                present = match next.take() {
                    Some(second) => Analysis { output: present.output.clone(), ..second },
                    None => analysis.finer(&present, number)?,
                };
            }
            listener(LevelEvent::Started { divisions, unknowns: present.problem.num_unknowns() });
            let (level, ended) = solve(&present, divisions);
            listener(LevelEvent::Finished(&level));
            solved.push(level);
            if let Err(cause) = ended {
                failure = Some(format!("elements divided by {divisions}: {cause}"));
                break;
            }
        }
        Ok(Convergence {
            program: "pneuflex",
            version: env!("CARGO_PKG_VERSION"),
            title: analysis.title.clone(),
            element: analysis.problem.element_names(),
            results: compare(&solved),
            levels: solved,
            failure,
        })
    }
}

/// Follows an analysis's path on one mesh; what was reached is kept when it fails.
fn solve(analysis: &Analysis, divisions: usize) -> (Level, Result<(), String>) {
    let began = Instant::now();
    let (states, iterations, ended) = match analysis.run().without_fields().solve() {
        Ok(solution) => (solution.states, solution.iterations, Ok(())),
        Err(Error::NotConverged(ended) | Error::Setup(ended) | Error::Interrupted(ended)) => {
            let words = ended.to_string();
            (ended.reached.states, ended.reached.iterations, Err(words))
        }
        Err(error) => (Vec::new(), 0, Err(error.to_string())),
    };
    let problem = &analysis.problem;
    // States past a limit point are at other pressures on every mesh.
    let requested = || states.iter().filter(|state| state.kind.is_requested());
    let (steps, measured) = match Rest::of(problem) {
        Ok(rest) => (requested().map(|state| measure(&rest, state)).collect(), Ok(())),
        Err(source) => {
            let at = Clock::words(problem.clock, analysis.requested.first().copied().unwrap_or_default());
            (Vec::new(), Err(ResultsError::Derived { at, source }.to_string()))
        }
    };
    let missed = analysis.requested.get(requested().count());
    let limit = missed.map_or(Ok(()), |&at| {
        Err(format!("the path past its limit point does not come to {}", problem.clock.words(at)))
    });
    let elements = problem.mesh.num_elements();
    let level = Level {
        divisions,
        elements,
        unknowns: problem.num_unknowns(),
        element_size_mm: problem.mesh.mean_element_size(),
        seconds: began.elapsed().as_secs_f64(),
        iterations,
        steps,
    };
    (level, ended.and(measured).and(limit))
}

fn measure(rest: &Rest, state: &StepSummary) -> Measured {
    Measured { time: state.time, pressure_kpa: state.pressure_kpa, quantities: rest.quantities(state) }
}

/// Extrapolates at the pressures that every mesh reached.
fn compare(levels: &[Level]) -> Vec<AtState> {
    let h: Vec<f64> = levels.iter().map(|level| level.element_size_mm).collect();
    let reached = levels.iter().map(|level| level.steps.len()).min().unwrap_or(0);
    let at = |step: usize| {
        let Measured { time, pressure_kpa, quantities } = &levels[0].steps[step];
        let compared = quantities.iter().enumerate().filter_map(|(number, _)| {
            let on_each: Vec<&Quantity> = levels.iter().map(|level| &level.steps[step].quantities[number]).collect();
            let values: Vec<f64> = on_each.iter().map(|quantity| quantity.value).collect();
            let quantity = (*on_each.last()?).clone();
            Some(Compared { quantity, extrapolated: extrapolate(&h, &values)?, values })
        });
        AtState { time: *time, pressure_kpa: *pressure_kpa, compared: compared.collect() }
    };
    (0..reached).map(at).filter(|state| !state.compared.is_empty()).collect()
}

/// A cube that forces on nodes pull.
#[cfg(test)]
pub(crate) const PULLED_CUBE: &str = "*NODE
1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n8, 0, 1, 1
*ELEMENT, TYPE=C3D8, ELSET=CUBE\n1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=LEFT\n1, 4, 5, 8\n*NSET, NSET=RIGHT\n2, 3, 6, 7
*MATERIAL, NAME=M\n*HYPERELASTIC, NEO HOOKE\n0.25, 0.0002\n*SOLID SECTION, ELSET=CUBE, MATERIAL=M
*BOUNDARY\nLEFT, 1, 3
*STEP, NLGEOM\n*STATIC\n1, 1\n*CLOAD\nRIGHT, 1, 0.01\n*END STEP
";

#[cfg(test)]
mod tests {
    use std::path::Path;

    use pneuflex_mesh::PARTS;
    use pneuflex_model::Case;

    use super::*;
    use crate::Study;

    /// A mesh's own limit point is compared with nothing.
    #[test]
    fn states_past_a_limit_point_are_left_out_and_what_is_not_reached_is_said() {
        let mesh = "size = 4.5\nelement = \"hex8-q1p0\"";
        let mut case: Case =
            toml::from_str(&crate::template::two_chambers().replace("resolution = \"standard\"", mesh)).unwrap();
        case.material.law = pneuflex_model::Law::NeoHooke { c10: 0.05 };
        case.load.pressure_kpa = [5.0, 60.0].map(Into::into).to_vec();
        case.solver.continuation = pneuflex_model::Continuation::ArcLength;
        case.solver.states_past_limit = 2;
        let problem = Problem::from_case(&case).unwrap();
        let (level, ended) = solve(&Analysis::of_case(Path::new("a.toml"), case, problem), 1);
        assert_eq!(level.steps.iter().map(|step| step.pressure_kpa).collect::<Vec<_>>(), [5.0]);
        assert!(ended.unwrap_err().contains("does not come to 60 kPa"));
    }

    /// A body of hexahedra, wedges and tetrahedra, pulled by its roof.
    #[test]
    fn bodies_of_any_shape_are_divided() {
        let mesh = pneuflex_mesh::testing::angle(1);
        let mut body = crate::Body::of_mesh(pneuflex_model::Formulation::of_mesh(&mesh).unwrap(), mesh).unwrap();
        body.name_faces("foot", |x| x[2] == 0.0)
            .name_faces("roof", |x| x[2] == 3.0)
            .name_nodes("side", |x| x[1] == 0.0);
        body.material(pneuflex_model::Law::NeoHooke { c10: 0.1 }.into()).hold("foot", "xyz").symmetry("side", "y");
        body.displace("roof", "z", [0.0, 0.0, 0.1]).probe("end", [3.0, 2.0, 2.9]).times([1.0]);
        let mut told = Vec::new();
        let analysis = body.analysis().unwrap();
        let found = analysis.finer_meshes(2, MemoryLimit::Available).unwrap().solve(&mut |event| {
            if let LevelEvent::Started { divisions, .. } = event {
                told.push(divisions);
            }
        });
        let found = found.unwrap();
        assert_eq!((told, found.failure.clone(), &*found.element), (vec![1, 2], None, "hex27 + tet15 + wedge21"));
        assert_eq!(found.levels[1].elements, PARTS * found.levels[0].elements);
        let keys: Vec<&str> = found.results[0].compared.iter().map(|one| &*one.quantity.key).collect();
        let expected = ["probe_end_mm", "reaction_foot_n", "reaction_roof_n", "strain_energy_mj", "von_mises_p99_mpa"];
        assert_eq!((keys, found.results[0].when()), (expected.to_vec(), "time 1".to_owned()));
        // The probe's node is the same one; an energy falls on a finer mesh, and by little.
        let of = |key: &str| &found.results[0].compared.iter().find(|one| one.quantity.key == key).unwrap().values;
        let energy = of("strain_energy_mj");
        assert!(energy[1] < energy[0] && energy[1] > 0.9 * energy[0], "{energy:?}");
        let json = serde_json::to_value(&found).unwrap();
        assert_eq!(json["levels"][1]["steps"][0]["strain_energy_mj"], energy[1]);
        assert_eq!(json["results"][0]["strain_energy_mj"]["finest"], energy[1]);
    }

    #[test]
    fn what_cannot_be_divided_is_refused_before_anything_is_solved() {
        let study = Study::from_text("cube.inp", PULLED_CUBE).unwrap();
        let analysis = study.build().unwrap();
        let error = analysis.finer_meshes(2, MemoryLimit::Available).err().unwrap().to_string();
        assert!(error.contains("forces act on nodes"), "{error}");
    }
}
