//! Ctrl-C and the signal to terminate: the program ends at once, with status 130 or 143; while a file is put in its place, right after that;
//! while frames are rendered, after the one at hand. A second signal never waits for those, but removes files that are not finished; a third
//! not even for that.

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
    /// Whether the next signal would end the program.
    impatient: Arc<AtomicBool>,
}

/// As long as this lives, a first signal is noted alone.
#[derive(Debug)]
pub struct Deferred<'a>(&'a Interrupt);

impl Interrupt {
    /// Takes over the signals. Without them (a system that has none) the default stays.
    pub fn install() -> Interrupt {
        let interrupt = Interrupt {
            at_once: Arc::new(AtomicBool::new(true)),
            pending: Arc::new(AtomicUsize::new(0)),
            impatient: Arc::new(AtomicBool::new(false)),
        };
        let is_watched = interrupt.watch().map_err(|error| tracing::debug!("signals are not waited for: {error}")).is_ok();
        for signal in [SIGINT, SIGTERM] {
            // Order matters: handlers run in the order in which they were registered, so the note is made before the end.
            let noted = signal_hook::flag::register_usize(signal, Arc::clone(&interrupt.pending), signal as usize);
            let ended = signal_hook::flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&interrupt.at_once));
            let mut registered = noted.and(ended);
            if !is_watched {
                // Nobody is there to remove anything: the second signal ends the program in its handler.
                let impatient = signal_hook::flag::register(signal, Arc::clone(&interrupt.impatient));
                registered = registered.and(impatient).and(signal_hook::flag::register(signal, Arc::clone(&interrupt.at_once)));
            }
            if let Err(error) = registered {
                tracing::debug!("cannot catch signal {signal}: {error}");
            }
        }
        interrupt
    }

    /// A thread that waits for the second signal.
    #[cfg(unix)]
    fn watch(&self) -> std::io::Result<()> {
        let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM])?;
        let (at_once, impatient) = (Arc::clone(&self.at_once), Arc::clone(&self.impatient));
        let wait = move || {
            for signal in signals.forever() {
                if impatient.swap(true, Ordering::SeqCst) {
                    // A third signal does not wait for a disk that does not answer.
                    at_once.store(true, Ordering::SeqCst);
                    gridwalk_render::image::remove_unfinished();
                    signal_hook::low_level::exit(128 + signal);
                }
            }
        };
        std::thread::Builder::new().name("signals".to_owned()).spawn(wait).map(drop)
    }

    #[cfg(not(unix))]
    fn watch(&self) -> std::io::Result<()> {
        Err(std::io::ErrorKind::Unsupported.into())
    }

    /// Runs `write` to its end whatever signal comes, then obeys the signal.
    pub fn uninterrupted<T>(&self, write: impl FnOnce() -> Result<T>) -> Result<T> {
        let deferred = self.defer();
        let result = write();
        drop(deferred);
        if self.is_pending() { Err(Failure::new(self.exit(), "interrupted")) } else { result }
    }

    /// From here on a first signal does not end the program: what is done looks itself whether one [is pending](Interrupt::is_pending).
    pub fn defer(&self) -> Deferred<'_> {
        self.at_once.store(false, Ordering::SeqCst);
        Deferred(self)
    }

    /// Whether a signal has come that could not end the program.
    pub fn is_pending(&self) -> bool {
        self.pending.load(Ordering::SeqCst) != 0
    }

    /// Whether the next signal ends the program at once.
    pub fn is_impatient(&self) -> bool {
        self.impatient.load(Ordering::SeqCst)
    }

    /// How the program ends for the signal that came.
    pub fn exit(&self) -> Exit {
        if self.pending.load(Ordering::SeqCst) == SIGTERM as usize { Exit::Terminated } else { Exit::Interrupted }
    }
}

impl Drop for Deferred<'_> {
    fn drop(&mut self) {
        self.0.at_once.store(true, Ordering::SeqCst);
    }
}
