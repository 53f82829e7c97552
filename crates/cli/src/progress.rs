//! The progress bar: on standard error, and only where somebody watches.

use std::fmt::Write;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::messages;

/// A bar that counts to `total`, or nothing at all.
pub fn bar(enabled: bool, total: u64, what: &str) -> ProgressBar {
    let template = if messages::color() { "{msg} {wide_bar:.cyan} {percent:>3} % {eta}" } else { "{msg} {wide_bar} {percent:>3} % {eta}" };
    styled(enabled, total, what, template, |style| style)
}

/// Steps of a frame on the bar of [`frames`].
pub const PARTS: u64 = 1000;

/// A bar over so many frames of [`PARTS`] steps each, with frames a second and the time left.
pub fn frames(enabled: bool, frames: u64, what: &str) -> ProgressBar {
    let template = if messages::color() {
        "{msg} {wide_bar:.cyan} {frame}/{frames} {rate} frames/s, {eta} left"
    } else {
        "{msg} {wide_bar} {frame}/{frames} {rate} frames/s, {eta} left"
    };
    // What cannot be written to a terminal's line is no loss.
    let text = |text: fn(&ProgressState) -> String| {
        move |state: &ProgressState, out: &mut dyn Write| {
            let _ = out.write_str(&text(state));
        }
    };
    styled(enabled, frames.saturating_mul(PARTS), what, template, |style| {
        style
            .with_key("frame", text(|state| (state.pos() / PARTS).to_string()))
            .with_key("frames", text(|state| (state.len().unwrap_or(0) / PARTS).to_string()))
            .with_key("rate", text(|state| format!("{:.2}", state.per_sec() / PARTS as f64)))
    })
}

fn styled(enabled: bool, total: u64, what: &str, template: &str, keys: impl FnOnce(ProgressStyle) -> ProgressStyle) -> ProgressBar {
    if !enabled || !messages::can_move() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(keys(style));
    }
    bar.set_message(what.to_owned());
    bar
}
