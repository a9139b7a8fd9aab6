//! One child process: its time and its peak memory.

use std::process::Command;
use std::time::Instant;

use wait4::Wait4;

/// What a finished process took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Usage {
    /// Exit code; `None` after a signal.
    pub code: Option<i32>,
    /// From start to end, s.
    pub wall_s: f64,
    /// Largest resident set, bytes.
    pub peak_bytes: u64,
}

/// Runs a command to its end. The numbers are those of this one process, not of others started before.
///
/// # Errors
/// The command cannot be started or waited for.
pub fn measure(command: &mut Command) -> Result<Usage, String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let began = Instant::now();
    let mut child = command.spawn().map_err(|e| format!("{name} cannot be started: {e}"))?;
    let used = child.wait4().map_err(|e| format!("{name}: {e}"))?;
    Ok(Usage { code: used.status.code(), wall_s: began.elapsed().as_secs_f64(), peak_bytes: used.rusage.maxrss })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exit_code_and_the_memory_are_the_childs() {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let usage = measure(Command::new(&cargo).arg("--version").stdout(std::process::Stdio::null())).unwrap();
        assert_eq!(usage.code, Some(0));
        assert!(usage.wall_s > 0.0 && usage.peak_bytes > 1 << 20 && usage.peak_bytes < 1 << 32, "{usage:?}");
        assert!(measure(&mut Command::new("no-such-program-anywhere")).is_err());
    }
}
