//! Ctrl-C: the first asks the run to stop at its next iteration, the second ends the program at once.
//!
//! Requests to terminate and the end of the terminal (`SIGHUP`) mean the same, but for a program that `nohup` has started.

use std::process;

use pneuflex::StopToken;

use crate::outcome::INTERRUPTED;
use crate::terminal::say;

/// Listens to Ctrl-C and to requests to terminate; returns what is stopped then.
pub fn listen() -> StopToken {
    let token = StopToken::new();
    let heard = token.clone();
    // Somebody else listening already is no reason not to run.
    let _ = ctrlc::set_handler(move || {
        if heard.stop() {
            process::exit(INTERRUPTED.into());
        }
        say("stopping at the next iteration; once more to end at once");
    });
    token
}

/// Goes on to ignore the end of the terminal where the program was started so, as by `nohup`: what listens to Ctrl-C would listen to that,
/// too. Before anything starts a thread, each of which takes this over.
pub fn honour_nohup() {
    #[cfg(target_os = "linux")]
    if std::fs::read_to_string("/proc/self/status").is_ok_and(|status| ignores_hangup(&status)) {
        let mut signals = nix::sys::signal::SigSet::empty();
        signals.add(nix::sys::signal::Signal::SIGHUP);
        // A signal that is blocked waits for ever, which is as good. If it cannot be blocked, it stops the run.
        let _ = signals.thread_block();
    }
}

/// Whether the first signal, `SIGHUP`, is among those that a process ignores, by what Linux says of it.
#[cfg(target_os = "linux")]
fn ignores_hangup(status: &str) -> bool {
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).is_some_and(|mask| mask & 1 == 1)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn ignored_signals_are_read() {
        assert!(ignores_hangup("Name:\tpneuflex\nSigIgn:\t0000000000001001\nSigCgt:\t0000000000000000\n"));
        assert!(!ignores_hangup("SigBlk:\t0000000000000001\nSigIgn:\t0000000000001000\n") && !ignores_hangup(""));
    }
}
