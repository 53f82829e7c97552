//! The progress bar: on standard error, and only where somebody watches.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::messages;

/// A bar that counts to `total`, or nothing at all.
pub fn bar(enabled: bool, total: u64, what: &str) -> ProgressBar {
    if !enabled || !messages::can_move() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
    let template = if messages::color() { "{msg} {wide_bar:.cyan} {percent:>3} % {eta}" } else { "{msg} {wide_bar} {percent:>3} % {eta}" };
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.set_message(what.to_owned());
    bar
}
