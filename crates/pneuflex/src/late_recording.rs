//! Recording a run that has ended.

use std::path::Path;

use pneuflex_newton::{Checkpoint, ConvergedState};

use crate::analysis::Analysis;
use crate::error::Error;
use crate::folder::OutputFolder;
use crate::observer::{End, Event, Observer, ReachedState};
use crate::recorder::Recorder;
use crate::start::Recorded;

impl Analysis {
    /// Records a run of this analysis that has ended in a folder, as [`crate::Run::record`] would have done, but for the history of its
    /// iterations. `states` are those that were reached; `checkpoint` is the last load step that was accepted with the number of states
    /// that had been reached before it, if a run is to go on from there.
    ///
    /// # Errors
    /// [`Error::Input`] for a folder that cannot be used, [`Error::Results`] for results that cannot be derived or written.
    pub fn record(
        &self,
        folder: &Path,
        states: &[&ConvergedState],
        checkpoint: Option<(&Checkpoint, usize)>,
        end: &End<'_>,
    ) -> Result<OutputFolder, Error> {
        let folder = OutputFolder::prepare(folder)?;
        folder.begin()?;
        let mut recorder = Recorder::new(folder.clone(), self, Recorded::default())?;
        for (number, &equilibrium) in states.iter().enumerate() {
            if let Some((checkpoint, _)) = checkpoint.filter(|(_, before)| *before == number) {
                recorder.observe(&Event::StepAccepted(checkpoint))?;
            }
            let described = self.describe(equilibrium)?;
            let state = ReachedState { summary: &described.summary, equilibrium, described: &described, seconds: 0.0 };
            recorder.observe(&Event::State(state))?;
        }
        if let Some((checkpoint, _)) = checkpoint.filter(|(_, before)| *before >= states.len()) {
            recorder.observe(&Event::StepAccepted(checkpoint))?;
        }
        recorder.finish(end)?;
        Ok(folder)
    }
}
