//! Ctrl-C: the program ends at once with status 130; while a file is put in its place, right after that; while frames are rendered, after
//! the one at hand. A second Ctrl-C never waits.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};

use crate::exit::{Exit, Failure, Result};

/// The signals, and whether they may end the program now.
#[derive(Clone, Debug)]
pub struct Interrupt {
    /// Read in the signal handler: when set, the handler ends the program.
    at_once: Arc<AtomicBool>,
    /// The signal that came while it could not.
    pending: Arc<AtomicUsize>,
}

impl Interrupt {
    /// Takes over the signals. Without them (a system that has none) the default stays.
    pub fn install() -> Interrupt {
        let interrupt = Interrupt { at_once: Arc::new(AtomicBool::new(true)), pending: Arc::new(AtomicUsize::new(0)) };
        for signal in [SIGINT, SIGTERM] {
            // Order matters: handlers run in the order in which they were registered, so the note is made before the end.
            let noted = signal_hook::flag::register_usize(signal, Arc::clone(&interrupt.pending), signal as usize);
            let ended = signal_hook::flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&interrupt.at_once));
            // A second signal does not wait: a file may be stuck on a disk that does not answer.
            let impatient = signal_hook::flag::register(signal, Arc::clone(&interrupt.at_once));
            if let Err(error) = noted.and(ended).and(impatient) {
                tracing::debug!("cannot catch signal {signal}: {error}");
            }
        }
        interrupt
    }

    /// Runs `write` to its end whatever signal comes, then obeys the signal.
    pub fn uninterrupted<T>(&self, write: impl FnOnce() -> Result<T>) -> Result<T> {
        let result = self.deferred(write);
        if self.is_pending() { Err(Failure::new(Exit::Interrupted, "interrupted")) } else { result }
    }

    /// Runs `work`, which looks itself whether a signal [is pending](Interrupt::is_pending). A second signal ends the program.
    pub fn deferred<T>(&self, work: impl FnOnce() -> T) -> T {
        self.at_once.store(false, Ordering::SeqCst);
        let result = work();
        self.at_once.store(true, Ordering::SeqCst);
        result
    }

    /// Whether a signal has come that could not end the program.
    pub fn is_pending(&self) -> bool {
        self.pending.load(Ordering::SeqCst) != 0
    }
}
