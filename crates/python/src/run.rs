//! Solving: the interpreter is free, Ctrl-C is heard.
//!
//! The path is followed on a thread of its own. The thread that called waits for what that has to say, and looks every now and then whether
//! Python has a signal to handle, which only its main thread may do.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use pneuflex::gradient::{self, Gradient};
use pneuflex::newton::{self, Cause, Failure, PathReport};
use pneuflex::reason::Reason;
use pneuflex::{End, Error, Event, Neighbour, Observer, ResultsError, Solution, StopToken, Unfinished, on_threads};
use pneuflex_sweep::neighbours;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use serde::Serialize;

use crate::error::{apart, of_panic, raised};
use crate::state::{Kept, State};
use crate::study::Analysis;

/// How long Ctrl-C may go unheard.
const PATIENCE: Duration = Duration::from_millis(50);

/// A load step that was accepted, and the number of states that had been reached before.
type Step = (Arc<newton::Checkpoint>, usize);

/// Where a run goes on from one that is kept in memory.
#[pyclass(frozen, module = "pneuflex._native")]
pub struct Start {
    start: pneuflex::Start,
    heard: Heard,
    /// Number of states that were told of already.
    told: usize,
}

/// What a run found, and how it ended.
#[pyclass(frozen, module = "pneuflex._native")]
pub struct Outcome {
    analysis: Arc<pneuflex::Analysis>,
    status: &'static str,
    failure: Option<(Failure, Option<Reason>)>,
    words: String,
    found: Solution,
    /// Those that were found, and those of the run in memory that this one went on from.
    states: Vec<Arc<Kept>>,
    last: Option<Arc<Kept>>,
    step: Option<Step>,
}

/// What the thread that solves says.
enum Message {
    Iteration { parameter: f64, step: usize, iteration: usize },
    State(Arc<Kept>),
}

/// What is heard while the path is followed.
struct Ear {
    analysis: Arc<pneuflex::Analysis>,
    keeps_fields: bool,
    says_iterations: bool,
    messages: Sender<Message>,
    /// Heard when a state has been looked at.
    go_on: Option<Receiver<()>>,
    heard: Arc<Mutex<Heard>>,
    told: usize,
    stop: StopToken,
}

#[derive(Clone, Default)]
struct Heard {
    states: Vec<Arc<Kept>>,
    step: Option<Step>,
}

impl Observer for Ear {
    fn observe(&mut self, event: &Event<'_>) -> Result<(), ResultsError> {
        // Nobody listening any more is no reason not to go on.
        match event {
            Event::Iteration(record) if self.says_iterations => {
                let (parameter, step, iteration) = (record.parameter.0, record.step, record.iteration);
                let _ = self.messages.send(Message::Iteration { parameter, step, iteration });
            }
            Event::StepAccepted(checkpoint) if self.keeps_fields => {
                let mut heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
                let states = heard.states.len();
                heard.step = Some((Arc::new((*checkpoint).clone()), states));
            }
            Event::State(state) => {
                let kept = Kept::new(&self.analysis, state.equilibrium, state.described, self.keeps_fields)?;
                let kept = Arc::new(kept);
                let mut heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
                heard.states.push(Arc::clone(&kept));
                // A load step that was accepted at a position that was asked for is reached once more.
                let is_new = heard.states.len() > self.told;
                drop(heard);
                let is_heard = is_new && self.messages.send(Message::State(kept)).is_ok();
                if let Some(go_on) = self.go_on.as_ref().filter(|_| is_heard && !self.stop.is_stopped()) {
                    let _ = go_on.recv();
                }
            }
            _ => {}
        }
        Ok(())
    }
}

/// What is asked of a run.
struct Request {
    analysis: Arc<pneuflex::Analysis>,
    threads: Option<usize>,
    out: Option<PathBuf>,
    resumes: bool,
    start: pneuflex::Start,
    keeps_fields: bool,
    neighbour: Option<Neighbour>,
    keeps_equilibria: bool,
    stop: StopToken,
}

impl Request {
    fn solve(self, ear: Ear) -> Result<Outcome, Error> {
        let heard = Arc::clone(&ear.heard);
        let run = self.analysis.run().without_fields().stop(&self.stop).observe_with(ear);
        let run = run.start_from(self.neighbour).keep_equilibria(self.keeps_equilibria);
        let run = match &self.out {
            Some(out) if self.resumes => run.resume(out),
            Some(out) => run.record(out),
            None => run.start_at(self.start),
        };
        let ended = on_threads(self.threads, || run.solve());
        let Heard { states, step } = std::mem::take(&mut *heard.lock().unwrap_or_else(PoisonError::into_inner));
        let (status, failure, words, found) = match ended {
            Ok(found) => (found.status.name(), None, String::new(), found),
            Err(Error::NotConverged(ended) | Error::Interrupted(ended)) => {
                unfinished(ended.reached.status.name(), *ended)
            }
            Err(Error::Setup(ended)) => unfinished("setup", *ended),
            Err(error) => return Err(error),
        };
        let last = found.last.as_ref().and_then(|last| {
            // Where nothing can be derived there is nothing to show: the run has ended for a reason of its own.
            let described = self.analysis.describe(last).ok()?;
            Kept::new(&self.analysis, last, &described, self.keeps_fields).ok().map(Arc::new)
        });
        Ok(Outcome { analysis: self.analysis, status, failure, words, found, states, last, step })
    }
}

fn written<T: Serialize>(py: Python<'_>, what: &T) -> PyResult<String> {
    serde_json::to_string(what).map_err(|why| raised(py, ResultsError::not_representable("result", why).into()))
}

type Ended = (&'static str, Option<(Failure, Option<Reason>)>, String, Solution);

fn unfinished(status: &'static str, ended: Unfinished) -> Ended {
    let words = ended.to_string();
    (status, Some((ended.failure, ended.reason)), words, ended.reached)
}

/// Follows the path of an analysis. `on_state` and `on_iteration` are called on this thread; what they raise stops the run and is raised
/// here. `out` is a folder to record in, `resumes` goes on with what that holds, `start` without a folder with a run in memory. `neighbour` is
/// the folder of a sweep and the name of the design in it that this one starts from; `keeps_equilibria` for those that start from this one.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "one for each thing that can be asked for")]
pub fn solve(
    py: Python<'_>,
    analysis: &Analysis,
    threads: Option<usize>,
    out: Option<PathBuf>,
    resumes: bool,
    start: Option<&Start>,
    keeps_fields: bool,
    neighbour: Option<(PathBuf, String)>,
    keeps_equilibria: bool,
    on_state: Option<Bound<'_, PyAny>>,
    on_iteration: Option<Bound<'_, PyAny>>,
) -> PyResult<Outcome> {
    let stop = StopToken::new();
    let (messages, received) = channel();
    let (let_go_on, go_on) = channel();
    let request = Request {
        analysis: Arc::clone(&analysis.analysis),
        threads,
        out,
        resumes,
        start: start.map(|start| start.start.clone()).unwrap_or_default(),
        keeps_fields,
        neighbour: neighbour.and_then(|(folder, identity)| neighbours::read(&folder, &identity)),
        keeps_equilibria,
        stop: stop.clone(),
    };
    let ear = Ear {
        analysis: Arc::clone(&analysis.analysis),
        keeps_fields,
        says_iterations: on_iteration.is_some(),
        messages,
        go_on: on_state.is_some().then_some(go_on),
        heard: Arc::new(Mutex::new(start.map(|start| start.heard.clone()).unwrap_or_default())),
        told: start.map_or(0, |start| start.told),
        stop: stop.clone(),
    };
    let solver = thread::Builder::new()
        .name("pneuflex".into())
        .spawn(move || catch_unwind(AssertUnwindSafe(|| request.solve(ear))))
        .map_err(|error| PyRuntimeError::new_err(format!("a thread cannot be started: {error}")))?;
    let received = Mutex::new(received);
    let mut raised_meanwhile: Option<PyErr> = None;
    loop {
        let wait = || received.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(PATIENCE);
        let said = match py.detach(wait) {
            Ok(Message::Iteration { parameter, step, iteration }) => match &on_iteration {
                Some(on_iteration) if raised_meanwhile.is_none() => {
                    on_iteration.call1((parameter, step, iteration)).map(drop)
                }
                _ => Ok(()),
            },
            Ok(Message::State(kept)) => match &on_state {
                Some(on_state) if raised_meanwhile.is_none() => on_state.call1((State(kept),)).map(drop),
                _ => Ok(()),
            },
            Err(RecvTimeoutError::Timeout) => Ok(()),
            Err(RecvTimeoutError::Disconnected) => break,
        };
        // Once it has been asked to stop, nothing more is asked of it.
        if let Err(error) = said.and_then(|()| py.check_signals()) {
            stop.stop();
            raised_meanwhile.get_or_insert(error);
        }
        let _ = let_go_on.send(());
    }
    let ended = py.detach(|| solver.join());
    let outcome = match ended {
        Ok(Ok(ended)) => ended.map_err(|error| raised(py, error))?,
        Ok(Err(panic)) | Err(panic) => return Err(of_panic(&*panic)),
    };
    match raised_meanwhile {
        // The caller makes something of what was reached.
        Some(error) if !error.is_instance_of::<pyo3::exceptions::PyKeyboardInterrupt>(py) => Err(error),
        Some(_) => Ok(Outcome { status: "interrupted", ..outcome }),
        None => Ok(outcome),
    }
}

/// Results by their names.
pub fn requests(results: &[String]) -> Result<Vec<gradient::Request>, Error> {
    results.iter().map(|result| Ok(result.parse()?)).collect()
}

#[pymethods]
impl Outcome {
    /// `converged`, `past-limit`, `not-converged`, `interrupted` or `setup`.
    #[getter]
    fn status(&self) -> &'static str {
        self.status
    }

    /// How it ended, in words; empty if it came to its end.
    #[getter]
    fn failure(&self) -> &str {
        &self.words
    }

    /// Why it ended early, as JSON.
    #[getter]
    fn reason(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let reason = self.failure.as_ref().and_then(|(_, reason)| reason.as_ref());
        reason.map(|reason| written(py, reason)).transpose()
    }

    /// States that were reached, without those that a folder holds already.
    #[getter]
    fn states(&self) -> Vec<State> {
        self.states.iter().map(|kept| State(Arc::clone(kept))).collect()
    }

    /// The last equilibrium of a run that ended early, if it lies between the requested ones.
    #[getter]
    fn last(&self) -> Option<State> {
        self.last.as_ref().map(|kept| State(Arc::clone(kept)))
    }

    /// Warnings, as JSON.
    #[getter]
    fn warnings(&self, py: Python<'_>) -> PyResult<String> {
        written(py, &self.found.warnings)
    }

    /// Estimated errors of the last state, as JSON; null if they were not asked for.
    #[getter]
    fn error_estimate(&self, py: Python<'_>) -> PyResult<String> {
        written(py, &self.found.error_estimate)
    }

    /// Whether guesses were taken from a neighbour's path.
    #[getter]
    fn has_started_from(&self) -> bool {
        self.found.has_started_from
    }

    /// Whether it ended where it differs from the neighbour.
    #[getter]
    fn has_left_neighbour(&self) -> bool {
        self.found.has_started_from
            && self.failure.as_ref().is_some_and(|(failure, _)| failure.cause == Cause::OtherBranch)
    }

    /// Leaves its equilibria, if they were kept, in the folder of a sweep under the name of the design.
    fn leave_equilibria(&self, py: Python<'_>, folder: PathBuf, identity: &str) {
        if let Some(found) = &self.found.neighbour {
            py.detach(|| neighbours::keep(&folder, identity, found));
        }
    }

    /// Results of its states and their exact derivatives by keys, a row for each result.
    fn gradients(
        &self,
        py: Python<'_>,
        results: Vec<String>,
        keys: Vec<String>,
    ) -> PyResult<(Vec<f64>, Vec<Vec<f64>>)> {
        apart(py, || {
            let states: Vec<_> = self.states.iter().map(|kept| kept.equilibrium.clone()).collect();
            let found = self.analysis.gradients(&states, &requests(&results)?, Some(&keys))?;
            let by = |gradient: &Gradient, key: &String| {
                let found = gradient.derivatives.iter().find(|derivative| derivative.by == *key);
                found.map_or(f64::NAN, |derivative| derivative.derivative)
            };
            let row = |gradient: &Gradient| keys.iter().map(|key| by(gradient, key)).collect();
            Ok((found.iter().map(|gradient| gradient.value).collect(), found.iter().map(row).collect()))
        })
    }

    /// Results of its states and their exact derivatives by the positions of all nodes at rest, three numbers for each.
    fn shape_gradients(&self, py: Python<'_>, results: Vec<String>) -> PyResult<(Vec<f64>, Vec<Vec<f64>>)> {
        apart(py, || {
            let states: Vec<_> = self.states.iter().map(|kept| kept.equilibrium.clone()).collect();
            let found = self.analysis.shape_gradients(&states, &requests(&results)?)?;
            Ok(found.into_iter().map(|shape| (shape.value, shape.by_node.into_flattened())).unzip())
        })
    }

    /// Newton iterations, rejected attempts included.
    #[getter]
    fn iterations(&self) -> usize {
        self.found.iterations
    }

    /// Seconds by kind of work, as JSON.
    #[getter]
    fn timing(&self, py: Python<'_>) -> PyResult<String> {
        written(py, &self.found.timing)
    }

    /// Where a run of an analysis goes on from this one; nowhere if nothing is left to do.
    fn start(&self, py: Python<'_>, analysis: &Analysis) -> PyResult<Option<Start>> {
        let step = self.step.as_ref().map(|(checkpoint, states)| (&**checkpoint, *states));
        let start = apart(py, || Ok(analysis.analysis.start_after(&self.analysis, &self.found, step)?))?;
        let states = match &start {
            pneuflex::Start::Complete(_) => return Ok(None),
            pneuflex::Start::AtRest => return Ok(Some(Start { start, heard: Heard::default(), told: 0 })),
            pneuflex::Start::From(earlier) => earlier.0.steps.len(),
        };
        let heard = Heard { states: self.states[..states].to_vec(), step: self.step.clone() };
        Ok(Some(Start { start, heard, told: self.states.len() }))
    }

    /// Records the run in a folder.
    fn record(&self, py: Python<'_>, folder: PathBuf) -> PyResult<()> {
        apart(py, || {
            on_threads(Some(1), || {
                let states: Vec<_> = self.states.iter().map(|kept| &kept.equilibrium).collect();
                let step = self.step.as_ref().map(|(checkpoint, before)| (&**checkpoint, *before));
                let failure = self.failure.as_ref();
                let end = End {
                    report: &PathReport { iterations: self.found.iterations, timing: self.found.timing },
                    failure: failure.map(|(failure, _)| failure),
                    reason: failure.and_then(|(_, reason)| reason.as_ref()),
                    last: self.last.as_ref().map(|kept| &kept.equilibrium),
                    estimate: self.found.error_estimate.as_ref(),
                    error: None,
                };
                self.analysis.record(&folder, &states, step, &end).map(drop)
            })
        })
    }
}
