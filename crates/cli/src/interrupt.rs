//! Ctrl-C: the first asks the run to stop at its next iteration, the second ends the program at once.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock};

use crate::error::say;

/// Whether the run under way is to stop.
static STOP: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// Exit code of a run that was interrupted, by the shells' custom.
pub const EXIT_CODE: u8 = 130;

/// Listens to Ctrl-C and to requests to terminate; returns what becomes true then.
pub fn listen() -> Arc<AtomicBool> {
    // Somebody else listening already is no reason not to run.
    let _ = ctrlc::set_handler(|| {
        if STOP.swap(true, Ordering::Relaxed) {
            process::exit(EXIT_CODE.into());
        }
        say("stopping at the next iteration; once more to end at once");
    });
    Arc::clone(&STOP)
}

/// Stops the run under way.
pub fn stop() {
    STOP.store(true, Ordering::Relaxed);
}
