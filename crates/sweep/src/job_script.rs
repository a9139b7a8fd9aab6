//! Scripts that solve a sweep on a cluster: a job for every design, or for a few, and one that writes the table.

use std::fmt::Write as _;

/// Which scheduler a script is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheduler {
    /// SLURM: `sbatch`.
    Slurm,
    /// HyperQueue: `hq submit`.
    HyperQueue,
}

/// Jobs of an array that SLURM takes unless told otherwise (`MaxArraySize`, which is one more than the largest number).
const MOST_JOBS: usize = 1000;

/// What a script says.
#[derive(Clone, Debug)]
pub struct Script<'a> {
    /// Name of the jobs.
    pub name: &'a str,
    /// Words of the program's command for the sweep, as they are, without what single jobs do.
    pub command: &'a [String],
    /// The folder in which the command is called.
    pub folder: &'a str,
    /// Number of designs.
    pub designs: usize,
    /// Threads of each.
    pub threads: usize,
    /// Memory that the largest design needs by its estimate, bytes.
    pub memory: Option<f64>,
}

impl Script<'_> {
    /// The script for a scheduler, to be called by `bash`.
    pub fn text(&self, scheduler: Scheduler) -> String {
        // A good part more than the estimate: schedulers kill what needs more.
        let megabytes = self.memory.map(|bytes| (1.5 * bytes / 1e6).ceil().max(500.0));
        let jobs = if scheduler == Scheduler::Slurm { self.designs.min(MOST_JOBS) } else { self.designs };
        let each = self.designs.div_ceil(jobs.max(1));
        let last = self.designs.div_ceil(each.max(1)) - 1;
        let command = self.command.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ");
        let (submit, variable) = match scheduler {
            Scheduler::Slurm => ("bash, where sbatch is", "SLURM_ARRAY_TASK_ID"),
            Scheduler::HyperQueue => ("bash, where a HyperQueue server runs (hq server start)", "HQ_TASK_ID"),
        };
        let mut text = format!(
            "#!/usr/bin/env bash\n# Solves the {} designs of a sweep, and writes their table. To be called by {submit}.\n\
             # Where designs are left, because a job was killed, calling it again solves these and no others.\n\
             set -euo pipefail\ncd {}\n\n",
            self.designs,
            quoted(self.folder)
        );
        let first = format!("$(({variable} * {each}))");
        let only =
            if each == 1 { format!("${variable}") } else { format!("{first}-$(({variable} * {each} + {}))", each - 1) };
        let (name, threads) = (quoted(self.name), self.threads);
        let solve = quoted(&format!("{command} --only \"{only}\" --threads {threads}"));
        let join = quoted(&format!("{command} --join"));
        // Writing to a string cannot fail.
        let _ = match scheduler {
            Scheduler::Slurm => {
                let memory = megabytes.map(|size| format!(" --mem={size}M")).unwrap_or_default();
                write!(
                    text,
                    "array=$(sbatch --parsable --job-name={name} --array=0-{last} --cpus-per-task={threads}{memory} \\\n    \
                     --wrap={solve})\n\
                     sbatch --job-name={name} --dependency=afterany:\"${{array%%;*}}\" --wrap={join}\n"
                )
            }
            Scheduler::HyperQueue => {
                let memory = megabytes.map(|size| format!(" --resource \"mem={size}\"")).unwrap_or_default();
                write!(
                    text,
                    "hq submit --wait --name={name} --array=0-{last} --cpus={threads}{memory} -- bash -c {solve} || true\n{command} --join\n"
                )
            }
        };
        text
    }
}

/// A word as a shell takes it for one.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "/._-+=:,@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_design_has_a_job_and_words_stay_words() {
        let command = ["pneuflex".to_owned(), "sweep".to_owned(), "my gaps.toml".to_owned()];
        let script = |designs, threads| Script {
            name: "gaps",
            command: &command,
            folder: "/home/it's",
            designs,
            threads,
            memory: Some(1e9),
        };
        let text = script(12, 2).text(Scheduler::Slurm);
        assert!(
            text.contains("cd '/home/it'\\''s'\n") && text.contains("--array=0-11 --cpus-per-task=2 --mem=1500M"),
            "{text}"
        );
        assert!(text.contains("sweep '\\''my gaps.toml'\\'' --only \"$SLURM_ARRAY_TASK_ID\""), "{text}");
        // 2,500 designs are three for each of 834 jobs.
        let text = script(2500, 1).text(Scheduler::Slurm);
        assert!(
            text.contains("--array=0-833 ") && text.contains("ID * 3))-$((SLURM_ARRAY_TASK_ID * 3 + 2))"),
            "{text}"
        );
        let text = script(2500, 1).text(Scheduler::HyperQueue);
        assert!(text.contains("--array=0-2499 ") && text.contains("--only \"$HQ_TASK_ID\""), "{text}");
    }
}
