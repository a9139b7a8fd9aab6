//! `pneuflex sweep`: many designs, each solved once whatever dies.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use pneuflex::InputError;
use pneuflex_sweep::design::{Job, Task};
use pneuflex_sweep::job_script;
use pneuflex_sweep::plan::Planned;
use pneuflex_sweep::sweep_file::{Described, StartingPoint};
use pneuflex_sweep::{Folder, Plan, Row, SweepFile, neighbours, workers};

use crate::args::{Scheduler, SweepArguments, changes};
use crate::error::CliError;
use crate::interrupt;
use crate::outcome::Outcome;
use crate::progress::duration;
use crate::terminal::say;

/// Solves many designs.
///
/// # Errors
/// Bad input, found before anything is solved or written; a table that cannot be written.
pub fn sweep(arguments: &SweepArguments) -> Result<Outcome, CliError> {
    if arguments.worker {
        workers::work()?;
        return Ok(Outcome::Converged);
    }
    let described = SweepFile::load(&arguments.file, &changes(&arguments.set)?)?;
    let designs = &described.designs;
    let planned = Plan::of(&described.base, designs, described.fields);
    let Planned { plan, memory } = planned.map_err(|(number, error)| described.place(number, error))?;
    if let Some([_, last]) = arguments.only.filter(|[_, last]| *last >= designs.len()) {
        let allowed = format!("the designs of {} are 0 to {}", arguments.file.display(), designs.len() - 1);
        return Err(InputError::new(format!("--only: there is no design {last}: {allowed}")).into());
    }
    if let Some(scheduler) = arguments.emit {
        return emit(scheduler, arguments, &described, memory);
    }
    let path = arguments.out.clone().unwrap_or_else(|| PathBuf::from("out").join(described.stem()));
    let open = if arguments.only.is_some() { Folder::share } else { Folder::hold };
    let folder = open(&path, plan)?;
    if arguments.join {
        return table(&folder, arguments.quiet);
    }
    let mut left = folder.left();
    if let Some([first, last]) = arguments.only {
        // A design that is there twice may be here under its other number.
        let identity = |number: usize| &folder.plan().designs[number].identity;
        let wanted: Vec<_> = (first..=last).map(identity).collect();
        left.retain(|number| wanted.contains(&identity(*number)));
    }
    let (workers, threads) = match arguments.only {
        Some(_) => workers::share(1, memory, Some(1), arguments.threads.map(usize::from)),
        None => {
            let [workers, threads] = [arguments.workers, arguments.threads].map(|number| number.map(usize::from));
            workers::share(left.len(), memory, workers, threads)
        }
    };
    // A job solves its own designs, and takes nothing from another one that may be slower or faster.
    let [first, last] = arguments.only.unwrap_or([0, designs.len() - 1]);
    let name = |number: usize| folder.plan().designs[number].identity.as_str();
    let neighbour_of = match described.start {
        StartingPoint::Rest => BTreeMap::new(),
        StartingPoint::Neighbours => {
            let names: Vec<&str> = (first..=last).map(name).collect();
            neighbours::by_name(&names, &designs[first..=last])
        }
    };
    let has_followers: BTreeSet<_> = neighbour_of.values().cloned().collect();
    let mut tasks = Vec::new();
    for number in left {
        folder.forget(number)?;
        let (identity, design) = (name(number).to_owned(), designs[number].clone());
        let starts_from = neighbour_of.get(&identity).cloned();
        tasks.push(Task { is_neighbour: has_followers.contains(&identity), identity, design, starts_from });
    }
    let job = Job { base: described.base.clone(), folder: path, threads, fields: described.fields };
    let program = std::env::current_exe()
        .map_err(|error| CliError::Output(format!("the program does not find itself: {error}")))?;
    let command = || {
        let mut command = Command::new(&program);
        command.args(["sweep", "--worker"]).arg(&arguments.file);
        command
    };
    let stop = interrupt::listen();
    let count = if arguments.only.is_some() { tasks.len() } else { designs.len() };
    let rows = folder.rows();
    let failed = if arguments.only.is_some() { 0 } else { rows.iter().filter(|row| row.has_failed()).count() };
    let mut progress = Progress::new(arguments.quiet, count, count - tasks.len().min(count), failed);
    let mut is_left = false;
    // First those that others start from.
    let (by_themselves, others) = tasks.into_iter().partition(|task| task.starts_from.is_none());
    for tasks in [by_themselves, others] {
        if stop.is_stopped() {
            break;
        }
        workers::solve_all(&job, tasks, workers, &command, &stop, &mut |row| {
            is_left |= !row.is_finished();
            progress.row(row);
        });
    }
    progress.finish();
    if arguments.only.is_none() {
        let outcome = table(&folder, arguments.quiet)?;
        return Ok(if stop.is_stopped() { Outcome::Interrupted } else { outcome });
    }
    Ok(match (stop.is_stopped(), is_left) {
        (true, _) => Outcome::Interrupted,
        (false, true) => Outcome::NotConverged,
        (false, false) => Outcome::Converged,
    })
}

/// Writes the table, and says what it holds.
fn table(folder: &Folder, quiet: bool) -> Result<Outcome, CliError> {
    let file = folder.write_table()?;
    let rows = folder.rows();
    let failed: Vec<&Row> = rows.iter().filter(|row| row.has_failed()).collect();
    let left = rows.iter().filter(|row| !row.is_finished()).count();
    if !quiet {
        say(&format!("{} of {} designs finished; the table is {}", rows.len() - left, rows.len(), file.display()));
        let mut reasons: Vec<(&str, usize, &str)> = Vec::new();
        for row in &failed {
            let reason = row.reason.as_deref().unwrap_or(&row.status);
            match reasons.iter_mut().find(|(other, ..)| *other == reason) {
                Some((_, count, _)) => *count += 1,
                None => reasons.push((reason, 1, &row.message)),
            }
        }
        for (reason, count, message) in reasons {
            let first = message.lines().next().unwrap_or_default();
            say(&format!(
                "  {count} failed: {reason}{}{first}",
                if first.is_empty() { "" } else { ", the first with " }
            ));
        }
    }
    if left == 0 {
        let is_all = !rows.is_empty() && failed.len() == rows.len();
        return Ok(if is_all { Outcome::NotConverged } else { Outcome::Converged });
    }
    // Said even when quiet: it is the reason for the exit code.
    say(&format!("{left} designs are left: the same command tries them again"));
    Ok(Outcome::NotConverged)
}

/// Prints the script of a cluster.
fn emit(
    scheduler: Scheduler,
    arguments: &SweepArguments,
    described: &Described,
    memory: Option<f64>,
) -> Result<Outcome, CliError> {
    let text = |path: &Path| path.to_string_lossy().into_owned();
    let absolute = |path: &Path| std::path::absolute(path).map_err(|error| CliError::Output(error.to_string()));
    let program = std::env::current_exe().map_err(|error| CliError::Output(error.to_string()))?;
    let mut command = vec![text(&program), "sweep".into(), text(&absolute(&arguments.file)?)];
    command.extend(arguments.set.iter().flat_map(|change| ["--set".to_owned(), change.clone()]));
    if let Some(out) = &arguments.out {
        command.extend(["--out".into(), text(&absolute(out)?)]);
    }
    command.push("--quiet".into());
    let script = job_script::Script {
        name: &described.stem(),
        command: &command,
        folder: &text(&absolute(Path::new("."))?),
        designs: described.designs.len(),
        threads: arguments.threads.map_or(1, usize::from),
        memory,
    };
    let script = script.text(match scheduler {
        Scheduler::Slurm => job_script::Scheduler::Slurm,
        Scheduler::Hq => job_script::Scheduler::HyperQueue,
    });
    // Nobody reading on is no error.
    let _ = io::stdout().write_all(script.as_bytes());
    Ok(Outcome::Converged)
}

/// How far a sweep is: a bar on a terminal, a line every now and then elsewhere.
struct Progress {
    count: usize,
    begun_with: usize,
    done: usize,
    failed: usize,
    began: Instant,
    said: Option<Instant>,
    bar: Option<ProgressBar>,
    is_quiet: bool,
}

impl Progress {
    /// How long nothing is said where there is no bar.
    const PAUSE: Duration = Duration::from_secs(5);

    fn new(is_quiet: bool, count: usize, done: usize, failed: usize) -> Self {
        let bar = (!is_quiet && io::stderr().is_terminal()).then(|| {
            let bar = ProgressBar::new(count as u64);
            // What is too long for the line is cut off.
            if let Ok(style) = ProgressStyle::with_template("{spinner} [{bar:10}] {wide_msg}") {
                bar.set_style(style.progress_chars("=> "));
            }
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        });
        let mut progress =
            Self { count, begun_with: done, done, failed, began: Instant::now(), said: None, bar, is_quiet };
        progress.say();
        progress
    }

    fn row(&mut self, row: &Row) {
        self.done += 1;
        self.failed += usize::from(row.has_failed());
        if self.bar.is_some() || self.said.is_none_or(|said| said.elapsed() > Self::PAUSE) {
            self.say();
        }
    }

    fn say(&mut self) {
        self.said = Some(Instant::now());
        let line = self.line(self.began.elapsed().as_secs_f64());
        match &self.bar {
            Some(bar) => {
                bar.set_position(self.done as u64);
                bar.set_message(line);
            }
            None if self.is_quiet => {}
            None => say(&line),
        }
    }

    fn line(&self, spent: f64) -> String {
        let solved = self.done - self.begun_with;
        let time = match self.count - self.done {
            _ if solved == 0 => String::new(),
            0 => format!(", {}", duration(spent)),
            left => format!(", about {} left", duration(spent / solved as f64 * left as f64)),
        };
        format!("{} of {} designs, {} failed{time}", self.done, self.count, self.failed)
    }

    fn finish(&mut self) {
        match &self.bar {
            Some(bar) => bar.finish_and_clear(),
            None => self.say(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_is_told_from_what_was_solved_and_fits_into_80_columns() {
        let mut progress = Progress::new(true, 100_000, 50_000, 3);
        assert_eq!(progress.line(1.0), "50000 of 100000 designs, 3 failed");
        progress.row(&Row::new("a", "not-converged"));
        let line = progress.line(36.0);
        assert_eq!(line, "50001 of 100000 designs, 4 failed, about 500.0 h left");
        assert!(line.len() + "* [==========] ".len() <= 80, "{line}");
    }
}
