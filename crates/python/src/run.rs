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

use pneuflex::newton::{self, Failure, PathReport};
use pneuflex::reason::Reason;
use pneuflex::{End, Error, Event, Observer, ResultsError, Solution, StopToken, Unfinished, on_threads};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::error::{apart, of_panic, raised, wrong};
use crate::state::{Kept, State};
use crate::study::Analysis;

/// How long Ctrl-C may go unheard.
const PATIENCE: Duration = Duration::from_millis(50);

/// The last load step that was accepted, from which a run can go on.
#[pyclass(frozen, module = "pneuflex._native")]
pub struct Checkpoint(Arc<newton::Checkpoint>);

/// What a run found, and how it ended.
#[pyclass(frozen, module = "pneuflex._native")]
pub struct Outcome {
    status: &'static str,
    failure: Option<(Failure, Option<Reason>)>,
    words: String,
    states: Vec<Arc<Kept>>,
    /// Summaries of states that were reached before, by the run that this one went on from.
    earlier: Vec<String>,
    last: Option<Arc<Kept>>,
    warnings: String,
    report: PathReport,
    checkpoint: Option<(Arc<newton::Checkpoint>, usize)>,
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
    stop: StopToken,
}

#[derive(Default)]
struct Heard {
    states: Vec<Arc<Kept>>,
    checkpoint: Option<(Arc<newton::Checkpoint>, usize)>,
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
                heard.checkpoint = Some((Arc::new((*checkpoint).clone()), states));
            }
            Event::State(state) => {
                let kept = Kept::new(&self.analysis, state.equilibrium, state.described, self.keeps_fields)?;
                let kept = Arc::new(kept);
                self.heard.lock().unwrap_or_else(PoisonError::into_inner).states.push(Arc::clone(&kept));
                let is_heard = self.messages.send(Message::State(kept)).is_ok();
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
    start: Option<newton::Checkpoint>,
    keeps_fields: bool,
    stop: StopToken,
}

impl Request {
    fn solve(self, ear: Ear) -> Result<Outcome, Error> {
        let heard = Arc::clone(&ear.heard);
        let mut run = self.analysis.run().without_fields().stop(&self.stop).observe_with(ear);
        if let Some(out) = &self.out {
            run = if self.resumes { run.resume(out) } else { run.record(out) };
        }
        if let Some(start) = self.start {
            run = run.resume_from(start);
        }
        let ended = on_threads(self.threads, || run.solve());
        let Heard { states, checkpoint } = std::mem::take(&mut *heard.lock().unwrap_or_else(PoisonError::into_inner));
        let (status, failure, words, found) = match ended {
            Ok(found) => (status_of(&self.analysis, &found), None, String::new(), found),
            Err(Error::NotConverged(ended)) => unfinished("not-converged", *ended),
            Err(Error::Interrupted(ended)) => unfinished("interrupted", *ended),
            Err(Error::Setup(ended)) => unfinished("setup", *ended),
            Err(error) => return Err(error),
        };
        let last = found.last.as_ref().and_then(|last| {
            // Where nothing can be derived there is nothing to show: the run has ended for a reason of its own.
            let described = self.analysis.describe(last).ok()?;
            Kept::new(&self.analysis, last, &described, self.keeps_fields).ok().map(Arc::new)
        });
        let written = |what: &dyn erased::Json| what.json();
        let reached_before = found.states.len().saturating_sub(states.len());
        Ok(Outcome {
            status,
            failure,
            words,
            states,
            earlier: found.states[..reached_before].iter().map(|state| written(state)).collect::<Result<_, _>>()?,
            last,
            warnings: written(&found.warnings)?,
            report: PathReport { iterations: found.iterations, timing: found.timing },
            checkpoint,
        })
    }
}

/// Writing as JSON without naming the type.
mod erased {
    use pneuflex::{Error, ResultsError};

    pub trait Json {
        fn json(&self) -> Result<String, Error>;
    }

    impl<T: serde::Serialize> Json for T {
        fn json(&self) -> Result<String, Error> {
            let text = serde_json::to_string(self);
            Ok(text.map_err(|error| ResultsError::not_representable("result", error))?)
        }
    }
}

fn status_of(analysis: &pneuflex::Analysis, found: &Solution) -> &'static str {
    let last = analysis.requested.last().copied();
    let has_all = found.states.iter().any(|state| state.kind.is_requested() && Some(state.when()) == last);
    if has_all || analysis.requested.is_empty() { "converged" } else { "past-limit" }
}

type Ended = (&'static str, Option<(Failure, Option<Reason>)>, String, Solution);

fn unfinished(status: &'static str, ended: Unfinished) -> Ended {
    let words = ended.to_string();
    (status, Some((ended.failure, ended.reason)), words, ended.reached)
}

/// Follows the path of an analysis. `on_state` and `on_iteration` are called on this thread; what they raise stops the run and is raised
/// here. `out` is a folder to record in, `resumes` goes on with what that holds, `start` with a load step.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "one for each thing that can be asked for")]
pub fn solve(
    py: Python<'_>,
    analysis: &Analysis,
    threads: Option<usize>,
    out: Option<PathBuf>,
    resumes: bool,
    start: Option<&Checkpoint>,
    keeps_fields: bool,
    on_state: Option<Bound<'_, PyAny>>,
    on_iteration: Option<Bound<'_, PyAny>>,
) -> PyResult<Outcome> {
    if threads == Some(0) {
        return Err(wrong(py, "threads = 0 must be at least 1; leave it out to use all cores"));
    }
    let stop = StopToken::new();
    let (messages, received) = channel();
    let (let_go_on, go_on) = channel();
    let request = Request {
        analysis: Arc::clone(&analysis.analysis),
        threads,
        out,
        resumes,
        start: start.map(|start| (*start.0).clone()),
        keeps_fields,
        stop: stop.clone(),
    };
    let ear = Ear {
        analysis: Arc::clone(&analysis.analysis),
        keeps_fields,
        says_iterations: on_iteration.is_some(),
        messages,
        go_on: on_state.is_some().then_some(go_on),
        heard: Arc::default(),
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
        reason.map(|reason| erased::Json::json(reason).map_err(|error| raised(py, error))).transpose()
    }

    /// States that were reached.
    #[getter]
    fn states(&self) -> Vec<State> {
        self.states.iter().map(|kept| State(Arc::clone(kept))).collect()
    }

    /// Summaries of the states that an earlier run had reached, as JSON.
    #[getter]
    fn earlier(&self) -> Vec<String> {
        self.earlier.clone()
    }

    /// The last equilibrium of a run that ended early, if it lies between the requested ones.
    #[getter]
    fn last(&self) -> Option<State> {
        self.last.as_ref().map(|kept| State(Arc::clone(kept)))
    }

    /// Warnings, as JSON.
    #[getter]
    fn warnings(&self) -> &str {
        &self.warnings
    }

    /// Newton iterations, rejected attempts included.
    #[getter]
    fn iterations(&self) -> usize {
        self.report.iterations
    }

    /// Seconds by kind of work, as JSON.
    #[getter]
    fn timing(&self, py: Python<'_>) -> PyResult<String> {
        erased::Json::json(&self.report.timing).map_err(|error| raised(py, error))
    }

    /// Where a run can go on.
    #[getter]
    fn checkpoint(&self) -> Option<Checkpoint> {
        self.checkpoint.as_ref().map(|(checkpoint, _)| Checkpoint(Arc::clone(checkpoint)))
    }

    /// Records the run in a folder, with the states of the run that it went on from.
    fn record(
        &self,
        py: Python<'_>,
        analysis: &Analysis,
        folder: PathBuf,
        earlier: Vec<PyRef<'_, State>>,
    ) -> PyResult<()> {
        let earlier: Vec<Arc<Kept>> = earlier.iter().map(|state| Arc::clone(&state.0)).collect();
        let analysis = Arc::clone(&analysis.analysis);
        apart(py, || {
            on_threads(Some(1), || {
                let states: Vec<_> = earlier.iter().chain(&self.states).map(|kept| &kept.equilibrium).collect();
                let checkpoint = self.checkpoint.as_ref();
                let checkpoint = checkpoint.map(|(checkpoint, before)| (&**checkpoint, before + earlier.len()));
                let failure = self.failure.as_ref();
                let end = End {
                    report: &self.report,
                    failure: failure.map(|(failure, _)| failure),
                    reason: failure.and_then(|(_, reason)| reason.as_ref()),
                    last: self.last.as_ref().map(|kept| &kept.equilibrium),
                    error: None,
                };
                analysis.record(&folder, &states, checkpoint, &end).map(drop)
            })
        })
    }
}
