//! What is said, on standard error and into the log file. Standard output carries data alone.

use std::fmt;
use std::fs::File;
use std::io::IsTerminal;
use std::sync::Mutex;

use tracing::{Event, Level, Subscriber};
use tracing_subscriber::Layer;
use tracing_subscriber::filter::{LevelFilter, filter_fn};
use tracing_subscriber::fmt::format::Writer;
use tracing_subscriber::fmt::{FmtContext, FormatEvent, FormatFields};
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::registry::LookupSpan;
use tracing_subscriber::util::SubscriberInitExt;

use crate::args::low::Global;
use crate::exit::{Failure, Result};

/// Target of messages that are told unless the program is to be quiet: what nobody could know otherwise.
pub const RESULT: &str = "gridwalk::result";

/// Directs messages to standard error, and to the log file if there is one.
pub fn install(options: &Global) -> Result<()> {
    let level = match (options.quiet, options.verbose) {
        (true, _) => LevelFilter::ERROR,
        (false, 0) => LevelFilter::WARN,
        (false, 1) => LevelFilter::INFO,
        (false, 2) => LevelFilter::DEBUG,
        (false, _) => LevelFilter::TRACE,
    };
    let quiet = options.quiet;
    let shown = filter_fn(move |message| *message.level() <= level || (!quiet && message.target() == RESULT));
    let screen = tracing_subscriber::fmt::layer().with_writer(std::io::stderr).event_format(Plain { color: color() }).with_filter(shown);
    let file = options.log_file.as_ref().map(|path| File::create(path).map_err(|error| (path, error))).transpose();
    let (file, failure) = match file {
        Ok(file) => (file, None),
        Err((path, error)) => (None, Some(Failure::from(gridwalk_render::image::Error::write(path, error)))),
    };
    let file = file.map(|file| {
        tracing_subscriber::fmt::layer().with_writer(Mutex::new(file)).with_ansi(false).with_filter(level.max(LevelFilter::DEBUG))
    });
    // Fails only if there is one already, which then serves. Without a log file there is still somebody to tell that to.
    let _ = tracing_subscriber::registry().with(screen).with(file).try_init();
    failure.map_or(Ok(()), Err)
}

/// Whether standard error takes colours: a terminal, and NO_COLOR (no-color.org) is not set.
pub fn color() -> bool {
    std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
        && std::env::var_os("TERM").is_none_or(|value| value != "dumb")
        && std::io::stderr().is_terminal()
}

/// Whether standard error is a terminal that may show a moving bar.
pub fn can_move() -> bool {
    std::io::stderr().is_terminal() && std::env::var_os("TERM").is_none_or(|value| value != "dumb") && std::env::var_os("CI").is_none()
}

/// `warning: text`, as compilers say it.
struct Plain {
    color: bool,
}

impl<S: Subscriber + for<'a> LookupSpan<'a>, N: for<'a> FormatFields<'a> + 'static> FormatEvent<S, N> for Plain {
    fn format_event(&self, context: &FmtContext<'_, S, N>, mut writer: Writer<'_>, event: &Event<'_>) -> fmt::Result {
        let (word, color) = match *event.metadata().level() {
            Level::ERROR => ("error", 31),
            Level::WARN => ("warning", 33),
            Level::INFO => ("info", 36),
            Level::DEBUG => ("debug", 90),
            Level::TRACE => ("trace", 90),
        };
        if self.color {
            write!(writer, "\x1b[1;{color}m{word}:\x1b[0m ")?;
        } else {
            write!(writer, "{word}: ")?;
        }
        context.field_format().format_fields(writer.by_ref(), event)?;
        writeln!(writer)
    }
}
