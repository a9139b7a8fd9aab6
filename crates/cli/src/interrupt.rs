//! Ctrl-C: the first asks the run to stop at its next iteration, the second ends the program at once.

use std::process;

use pneuflex::StopToken;

use crate::error::say;
use crate::outcome::INTERRUPTED;

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
