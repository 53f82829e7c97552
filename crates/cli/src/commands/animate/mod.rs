//! `gridwalk animate`.

mod report;
mod writer;

use std::ops::ControlFlow;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::time::Instant;

use gridwalk_render::image::{Metadata, MovieDesc, Overwrite, Rate};
use gridwalk_render::{RenderSettings, Renderer};
use indicatif::ProgressBar;

use crate::args::high::{self, AnimationOutput, Target};
use crate::args::low;
use crate::exit::{Exit, Failure, Result};
use crate::interrupt::Interrupt;
use crate::picture::{self, Shown};
use crate::session::Session;
use crate::{messages, output, progress, scene};
use report::{Before, FrameLine, Summary};
use writer::{Job, Writer};

/// Frames whose key-frames are read ahead.
const UPCOMING: usize = 3;

/// Frames that wait for their encoder. One is enough to hide the shorter of both; each takes the memory of a picture.
const WAITING: usize = 1;

/// Renders the frames of an animation, or lists its clips.
pub fn run(low: low::Animate, quiet: bool, interrupt: &Interrupt) -> Result<Exit> {
    let started = Instant::now();
    if low.list_clips {
        return super::list::clips(&high::Source::new(&low.scene), &low.limits);
    }
    let animate = high::Animate::new(low, quiet)?;
    let animation = scene::open(&animate.source, &animate.load, animate.clip.as_deref())?;
    let opened = Instant::now();
    let (frames, rate) = animate.frames(&animation)?;
    // A movie of every nth frame keeps its speed.
    let too_slow = || Failure::usage("the frames are too far apart; lower the step of --frames");
    let movie_rate = rate.every(animate.step()).ok_or_else(too_slow)?;
    let settings = picture::settings(&animate.picture, &animation.scene.defaults);
    let shown = Shown::new(&animate.picture, &animation.scene.defaults);
    check(&animate, &frames, movie_rate, &settings)?;

    let session = Session::open(&animate.device, &animate.grid, &animate.reports, animation, started)?;
    let common = picture::metadata(&animate.source, session.context.device_info(), &settings);
    // Before there is any file that would be left behind.
    let deferred = interrupt.defer();
    let writer = Writer::new(&animate, shown, movie_rate, &common)?;
    let missing: Vec<u64> = frames.iter().copied().filter(|frame| writer.wants(*frame)).collect();
    let bar = progress::frames(animate.reports.progress, missing.len() as u64, "rendering");

    let first_build_ms = session.context.has_timestamps().then_some(session.player.grid().stats().ms);
    let mut play = Play { animate: &animate, session, settings, common, rate, bar, interrupt, warned: false, begun: Instant::now() };
    let (sender, receiver) = sync_channel(WAITING);
    let (rendered, written) = together(|| play.render(&missing, sender), || writer.run(receiver));
    drop(deferred);
    let Play { session, settings, bar, begun, .. } = play;
    bar.finish_and_clear();

    // An encoder that fails ends the rendering too: its error is the cause.
    let ended = written.result.and(rendered);
    let mut summary = Summary::new(&session, &animate, &settings, rate, &written.tally);
    summary.skipped = frames.len() - missing.len();
    summary.outputs = written.outputs;
    summary.interrupted = matches!(ended, Ok(Ended::Interrupted));
    summary.error = ended.as_ref().err().map(|failure| crate::sentence(&failure.error));
    let ms = |from: Instant, to: Instant| (to - from).as_secs_f64() * 1e3;
    summary.before = Before { open_ms: ms(started, opened), setup_ms: ms(opened, begun), first_build_ms };
    summary.seconds(begun.elapsed().as_secs_f64(), session.seconds());
    if animate.reports.stats {
        eprint!("{}", report::table(&summary, &written.tally.rows));
    }
    if animate.reports.json {
        output::print_json(&summary)?;
    }
    if ended? == Ended::Interrupted {
        tracing::warn!("interrupted: {} of {} frames are done", written.tally.frames, missing.len());
        return Ok(interrupt.exit());
    }
    for name in &summary.outputs {
        if animate.named {
            tracing::info!("wrote {name}");
        } else {
            tracing::info!(target: messages::RESULT, "wrote {name}");
        }
    }
    Ok(session.verdict(summary.unfinished))
}

/// Runs two things at once, the second on a thread of its own.
fn together<A, B: Send>(a: impl FnOnce() -> A, b: impl FnOnce() -> B + Send) -> (A, B) {
    std::thread::scope(|scope| {
        let b = scope.spawn(b);
        let a = a();
        (a, b.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    })
}

/// Finds before hours of work what would keep their results from being written.
fn check(animate: &high::Animate, frames: &[u64], rate: Rate, settings: &RenderSettings) -> Result<()> {
    for output in &animate.outputs {
        match output {
            AnimationOutput::Sequence { pattern, format } => {
                let name = |frame: &u64| pattern.path(*frame);
                if let (false, [first, _, ..]) = (pattern.has_number(), frames) {
                    let (path, extension) = (name(first), format.extension());
                    return Err(Failure::usage(format!(
                        "-o {} would be replaced by each of {} frames; write {} for a sequence, or --format apng for one animated picture",
                        path.display(),
                        frames.len(),
                        path.with_extension(format!("%04d.{extension}")).display(),
                    )));
                }
                // Names differ in their number alone, so one of them tells whether the folder is there.
                let refused = animate.overwrite == Overwrite::Refuse && !animate.skip_existing;
                let looked_at = if refused { frames } else { frames.get(..1).unwrap_or_default() };
                for frame in looked_at.iter().map(name).filter(|path| !(animate.skip_existing && path.exists())) {
                    output::check(&Target::Path(frame), animate.overwrite)?;
                }
            }
            AnimationOutput::Movie { target, format } => {
                if !is_there(animate, target) {
                    output::check(target, animate.overwrite)?;
                }
                let desc = MovieDesc { format: *format, rate, chroma: animate.chroma, metadata: Metadata::new() };
                let size = settings.crop.map_or([settings.width, settings.height], |crop| [crop.width, crop.height]);
                if let Some(reason) = format.obstacle(&desc, size, settings.transparent) {
                    return Err(Failure::usage(format!("-o {}: {reason}", target.name())));
                }
            }
        }
    }
    Ok(())
}

/// Whether a movie is left as it is.
fn is_there(animate: &high::Animate, target: &Target) -> bool {
    animate.skip_existing && matches!(target, Target::Path(path) if path.exists())
}

/// How the rendering ended, if not by an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ended {
    /// With the last frame.
    Done,
    /// By a signal.
    Interrupted,
    /// Because nobody takes frames any more; the writer tells why.
    Refused,
}

struct Play<'a> {
    animate: &'a high::Animate,
    session: Session,
    settings: RenderSettings,
    common: Metadata,
    rate: Rate,
    bar: ProgressBar,
    interrupt: &'a Interrupt,
    /// It was told that the frame at hand is the last one.
    warned: bool,
    /// When all was ready for the first frame.
    begun: Instant,
}

impl Play<'_> {
    /// Renders frames one after another and hands them over.
    fn render(&mut self, frames: &[u64], sender: SyncSender<Job>) -> Result<Ended> {
        let renderer = Renderer::new(&self.session.context)?;
        self.begun = Instant::now();
        for (index, frame) in frames.iter().enumerate() {
            if self.interrupt.is_pending() {
                return Ok(Ended::Interrupted);
            }
            let upcoming: Vec<f64> = frames[index + 1..].iter().take(UPCOMING).map(|frame| self.rate.time(*frame)).collect();
            let job = self.frame(&renderer, index, *frame, &upcoming).map_err(|failure| failure.within(format!("frame {frame}")))?;
            if sender.send(job).is_err() {
                return Ok(Ended::Refused);
            }
        }
        Ok(Ended::Done)
    }

    fn frame(&mut self, renderer: &Renderer, index: usize, frame: u64, upcoming: &[f64]) -> Result<Job> {
        let begun = Instant::now();
        let Play { settings, bar, interrupt, .. } = self;
        let time = self.rate.time(frame);
        let size = [settings.width, settings.height];
        let camera = high::camera(&self.animate.picture.view, self.session.player.animation(), time, size, self.animate.turn(time))?;
        let sought = self.session.seek(time, upcoming)?;
        if index == 0 {
            self.session.tell_grid();
        }
        let player = &self.session.player;
        let mut warned = self.warned;
        let picture = renderer.render(player.scene(), player.grid(), &camera, settings, &mut |progress| {
            bar.set_position(index as u64 * progress::PARTS + (progress.done * progress::PARTS as f64) as u64);
            if interrupt.is_impatient() && !warned {
                warned = true;
                bar.suspend(|| tracing::warn!("ending after this frame; Ctrl-C once more ends at once"));
            }
            ControlFlow::Continue(())
        })?;
        self.warned = warned;
        let mut line = FrameLine::new(frame, time, &sought, &picture, self.session.context.has_timestamps());
        line.times.frame_ms = begun.elapsed().as_secs_f64() * 1e3;
        let metadata = picture::metadata_of_one(self.common.clone(), &picture.build.report, &camera, settings);
        Ok(Job { layers: picture.layers, metadata, line })
    }
}
