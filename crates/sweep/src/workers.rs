//! Processes that solve designs, one at a time each: tasks go in and rows come out, a line of JSON each. A worker that dies is replaced, and
//! its design tried again; nobody else notices.

use std::collections::VecDeque;
use std::io::{self, BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use pneuflex::{Error, StopToken};

use crate::design::{Job, Task, solve};
use crate::row::Row;

/// How often a design is tried whose worker dies.
const ATTEMPTS: usize = 3;

/// Share of the memory that is available that workers may fill, by their estimates.
const MEMORY_SHARE: f64 = 0.8;

/// How long a request to stop may go unheard.
const PATIENCE: Duration = Duration::from_millis(100);

/// Numbers of workers and of threads of each: as many processes as there are cores, or as have room in the memory by the largest
/// design's estimate, unless told otherwise; cores that are left over are shared out as threads.
pub fn share(designs: usize, memory: Option<f64>, workers: Option<usize>, threads: Option<usize>) -> (usize, usize) {
    let cores = thread::available_parallelism().map_or(1, std::num::NonZero::get);
    share_of(cores, pneuflex::memory::available(), designs, memory, workers, threads)
}

fn share_of(
    cores: usize,
    available: Option<f64>,
    designs: usize,
    memory: Option<f64>,
    workers: Option<usize>,
    threads: Option<usize>,
) -> (usize, usize) {
    let with_room = match (available, memory) {
        (Some(available), Some(memory)) if memory > 0.0 => (MEMORY_SHARE * available / memory) as usize,
        _ => usize::MAX,
    };
    let workers = workers.unwrap_or_else(|| (cores / threads.unwrap_or(1)).min(designs).min(with_room).max(1));
    (workers, threads.unwrap_or_else(|| (cores / workers).max(1)))
}

/// Solves designs in as many processes, which `command` makes and in which [`work`] is called. Returns once all have rows, or `stop` is
/// stopped; `tell` hears of every row as it comes.
pub fn solve_all(
    job: &Job,
    tasks: Vec<Task>,
    workers: usize,
    command: &(dyn Fn() -> Command + Sync),
    stop: &StopToken,
    tell: &mut dyn FnMut(&Row),
) {
    let queue = Mutex::new(VecDeque::from(tasks));
    let children: Vec<Mutex<Option<Child>>> = (0..workers).map(|_| Mutex::new(None)).collect();
    let is_stopped = AtomicBool::new(false);
    let (rows, received) = channel();
    thread::scope(|scope| {
        for child in &children {
            let (rows, queue, is_stopped) = (rows.clone(), &queue, &is_stopped);
            let post = Post { job, command, child, is_stopped };
            scope.spawn(move || {
                let mut worker = None;
                // The queue is free again before the design is solved; in the loop's own condition it would be locked until after it.
                let next = || lock(queue).pop_front().filter(|_| !is_stopped.load(Ordering::SeqCst));
                while let Some(task) = next() {
                    let Some(row) = post.row(&mut worker, &task) else { break };
                    if rows.send(row).is_err() {
                        break;
                    }
                }
                post.end(worker);
            });
        }
        drop(rows);
        loop {
            match received.recv_timeout(PATIENCE) {
                Ok(row) => tell(&row),
                Err(RecvTimeoutError::Disconnected) => break,
                Err(RecvTimeoutError::Timeout) => {}
            }
            if stop.is_stopped() && !is_stopped.swap(true, Ordering::SeqCst) {
                for child in &children {
                    if let Some(child) = lock(child).as_mut() {
                        let _ = child.kill();
                    }
                }
            }
        }
    });
}

/// Where one worker stands, whichever process it is.
struct Post<'a> {
    job: &'a Job,
    command: &'a (dyn Fn() -> Command + Sync),
    child: &'a Mutex<Option<Child>>,
    is_stopped: &'a AtomicBool,
}

/// The ends of a worker's lines.
struct Lines {
    tasks: ChildStdin,
    rows: BufReader<ChildStdout>,
}

impl Post<'_> {
    /// What becomes of a design; `None` if everything is to stop.
    fn row(&self, worker: &mut Option<Lines>, task: &Task) -> Option<Row> {
        let mut why = String::new();
        for _ in 0..ATTEMPTS {
            match self.ask(worker, task) {
                Ok(row) => return Some(row),
                Err(error) => why = error.to_string(),
            }
            self.end(worker.take());
            if self.is_stopped.load(Ordering::SeqCst) {
                return None;
            }
        }
        let mut row = Row::new(&task.identity, "worker-died");
        row.reason = Some("worker-died".into());
        row.message =
            format!("its worker process died {ATTEMPTS} times ({why}): it was killed, or there was not enough memory");
        row.threads = Some(self.job.threads);
        // If it cannot be kept, the design stays open, which the next call tries again, too.
        let _ = row.keep(&self.job.folder);
        Some(row)
    }

    fn ask(&self, worker: &mut Option<Lines>, task: &Task) -> io::Result<Row> {
        let lines = match worker {
            Some(lines) => lines,
            None => worker.insert(self.start()?),
        };
        send(&mut lines.tasks, task)?;
        let mut line = String::new();
        if lines.rows.read_line(&mut line)? == 0 {
            return Err(self.last_words());
        }
        Ok(serde_json::from_str(&line)?)
    }

    fn start(&self) -> io::Result<Lines> {
        let mut command = (self.command)();
        command.stdin(Stdio::piped()).stdout(Stdio::piped());
        // Ctrl-C is for the one that waits; it ends the workers.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        // Nobody stops between a start and its being known.
        let mut slot = lock(self.child);
        if self.is_stopped.load(Ordering::SeqCst) {
            return Err(io::Error::other("stopped"));
        }
        let child = slot.insert(command.spawn()?);
        let (tasks, rows) = child.stdin.take().zip(child.stdout.take()).ok_or(io::ErrorKind::BrokenPipe)?;
        drop(slot);
        let mut lines = Lines { tasks, rows: BufReader::new(rows) };
        send(&mut lines.tasks, self.job)?;
        Ok(lines)
    }

    /// How a worker ended that says nothing any more.
    fn last_words(&self) -> io::Error {
        let status = lock(self.child).as_mut().and_then(|child| child.wait().ok());
        io::Error::other(status.map_or_else(|| "it ended".to_owned(), |status| status.to_string()))
    }

    /// Ends a worker, who has nothing to do.
    fn end(&self, lines: Option<Lines>) {
        drop(lines);
        if let Some(mut child) = lock(self.child).take() {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn send(to: &mut impl Write, what: &impl serde::Serialize) -> io::Result<()> {
    let mut line = serde_json::to_vec(what)?;
    line.push(b'\n');
    to.write_all(&line)?;
    to.flush()
}

/// What a worker does: solves what comes in on standard input until nothing more can come. One whose input ends in the middle of a design
/// has lost whoever waits for it, and ends at once.
///
/// # Errors
/// Input that is no job, threads that cannot be started.
pub fn work() -> Result<(), Error> {
    let (lines, received) = channel();
    thread::spawn(move || {
        for line in io::stdin().lock().lines().map_while(Result::ok) {
            if lines.send(line).is_err() {
                return;
            }
        }
        std::process::exit(0);
    });
    let not_a_job = |error: &dyn std::fmt::Display| pneuflex::InputError::new(format!("a worker was told: {error}"));
    let first = received.recv().map_err(|error| not_a_job(&error))?;
    let job: Job = serde_json::from_str(&first).map_err(|error| not_a_job(&error))?;
    pneuflex::use_threads(job.threads)?;
    while let Ok(line) = received.recv() {
        let task: Task = serde_json::from_str(&line).map_err(|error| not_a_job(&error))?;
        if send(&mut io::stdout().lock(), &solve(&job, &task)).is_err() {
            break;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Base, Design};

    /// A folder, a job in it and tasks without anything to solve.
    fn empty_job(name: &str) -> (Job, Vec<Task>) {
        let folder = std::env::temp_dir().join(format!("pneuflex-sweep-{name}-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("rows")).unwrap();
        let base = Base { path: "case.toml".into(), changes: Design::new() };
        let tasks = ["a", "b"].map(|name| Task {
            identity: name.into(),
            design: Design::new(),
            starts_from: None,
            is_neighbour: false,
        });
        (Job { base, folder, threads: 1, fields: false }, tasks.into())
    }

    /// Each worker waits until it sees the other one; in turn they would wait in vain.
    #[cfg(unix)]
    #[test]
    fn designs_are_solved_side_by_side() {
        let (job, tasks) = empty_job("side-by-side");
        let script = "mkdir $$; for i in $(seq 100); do \
                      if [ $(ls -d [0-9]* | wc -l) = 2 ]; then touch met; sleep 0.2; break; fi; sleep 0.05; done; rmdir $$";
        let command = || {
            let mut command = Command::new("sh");
            command.args(["-c", script]).current_dir(&job.folder);
            command
        };
        solve_all(&job, tasks, 2, &command, &StopToken::new(), &mut |_| {});
        assert!(job.folder.join("met").exists());
        std::fs::remove_dir_all(&job.folder).unwrap();
    }

    #[test]
    fn a_design_that_kills_its_workers_is_a_row_and_is_tried_again() {
        let (job, tasks) = empty_job("workers");
        let mut told = Vec::new();
        // It ends at once, whatever it is told.
        let command = || Command::new(if cfg!(windows) { "hostname" } else { "true" });
        solve_all(&job, tasks, 2, &command, &StopToken::new(), &mut |row| told.push(row.clone()));
        told.sort_by(|a, b| a.identity.cmp(&b.identity));
        let found: Vec<_> = told.iter().map(|row| (row.identity.as_str(), row.status.as_str())).collect();
        assert_eq!(found, [("a", "worker-died"), ("b", "worker-died")]);
        assert!(told[0].message.contains("died 3 times") && !told[0].is_finished());
        assert_eq!(Row::read(&job.folder, "a"), told[0]);
        std::fs::remove_dir_all(&job.folder).unwrap();
    }

    #[test]
    fn cores_and_memory_are_shared_out() {
        assert_eq!(share_of(8, Some(1e9), 100, Some(1e8), None, None), (8, 1));
        assert_eq!(share_of(8, Some(1e9), 100, Some(3e8), None, None), (2, 4));
        assert_eq!(share_of(8, Some(1e9), 3, Some(1e8), None, None), (3, 2));
        assert_eq!(share_of(8, Some(1e9), 100, Some(9e9), None, None), (1, 8));
        assert_eq!(share_of(8, None, 100, None, None, Some(4)), (2, 4));
        assert_eq!(share_of(8, Some(1e9), 100, Some(9e9), Some(3), None), (3, 2));
    }
}
