//! Frames into files, beside the rendering of the next.

use std::path::Path;
use std::sync::mpsc::Receiver;
use std::time::Instant;

use gridwalk_render::Layers;
use gridwalk_render::image::{Format, Metadata, MovieDesc, MovieWriter, Overwrite, Rate, Rgb8, encode_exr, encode_png, write_file};

use super::report::{FrameLine, Tally};
use crate::args::high::{self, AnimationOutput, Target};
use crate::args::pattern::Pattern;
use crate::exit::Result;
use crate::output;
use crate::picture::Shown;

/// A frame on its way into files.
pub struct Job {
    pub layers: Layers,
    pub metadata: Metadata,
    pub line: FrameLine,
}

/// What has been written.
#[derive(Debug)]
pub struct Written {
    /// What is known of the frames.
    pub tally: Tally,
    /// Movies, and patterns of sequences of which there are frames.
    pub outputs: Vec<String>,
    pub result: Result<()>,
}

/// Writes frames into all outputs.
pub struct Writer<'a> {
    shown: Shown,
    overwrite: Overwrite,
    skip_existing: bool,
    json: bool,
    stats: bool,
    sinks: Vec<Sink<'a>>,
}

enum Sink<'a> {
    Sequence { pattern: &'a Pattern, format: Format },
    Movie { name: String, movie: Box<MovieWriter> },
}

impl<'a> Writer<'a> {
    /// Begins all movies, but those that are to be left as they are.
    pub fn new(animate: &'a high::Animate, shown: Shown, rate: Rate, metadata: &Metadata) -> Result<Writer<'a>> {
        let mut sinks = Vec::new();
        for output in &animate.outputs {
            match output {
                AnimationOutput::Sequence { pattern, format } => sinks.push(Sink::Sequence { pattern, format: *format }),
                AnimationOutput::Movie { target, .. } if super::is_there(animate, target) => {}
                AnimationOutput::Movie { target, format } => {
                    let desc = MovieDesc { format: *format, rate, chroma: animate.chroma, metadata: metadata.clone() };
                    let movie = match target {
                        Target::Path(path) => MovieWriter::create(path, animate.overwrite, &desc)?,
                        Target::Stdout => MovieWriter::stream(Path::new("standard output"), Box::new(std::io::stdout()), &desc)?,
                    };
                    sinks.push(Sink::Movie { name: target.name(), movie: Box::new(movie) });
                }
            }
        }
        Ok(Writer {
            shown,
            overwrite: animate.overwrite,
            skip_existing: animate.skip_existing,
            json: animate.reports.json,
            stats: animate.reports.stats,
            sinks,
        })
    }

    /// Whether some output lacks a frame.
    pub fn wants(&self, frame: u64) -> bool {
        self.sinks.iter().any(|sink| match sink {
            Sink::Sequence { pattern, .. } => !self.has(&pattern.path(frame)),
            Sink::Movie { .. } => true,
        })
    }

    fn has(&self, path: &Path) -> bool {
        self.skip_existing && path.exists()
    }

    /// Writes frames as long as there come any, and then ends the movies. After an error there will be no movie.
    pub fn run(mut self, frames: Receiver<Job>) -> Written {
        let mut written = Written { tally: Tally::default(), outputs: Vec::new(), result: Ok(()) };
        for job in frames {
            match self.write(job) {
                Ok(line) => written.tally.add(&line, self.stats),
                Err(failure) => {
                    written.result = Err(failure);
                    return written;
                }
            }
        }
        for sink in self.sinks {
            match sink {
                _ if written.tally.frames == 0 => {}
                Sink::Sequence { pattern, .. } => written.outputs.push(pattern.to_string()),
                Sink::Movie { name, movie } => match movie.finish() {
                    Ok(()) => written.outputs.push(name),
                    Err(error) => written.result = Err(error.into()),
                },
            }
        }
        written
    }

    fn write(&mut self, job: Job) -> Result<FrameLine> {
        let begun = Instant::now();
        let Job { layers, metadata, mut line } = job;
        let mut eight_bit = None;
        let needs_eight_bit = |sink: &Sink| !matches!(sink, Sink::Sequence { format: Format::Exr, .. });
        if self.sinks.iter().any(needs_eight_bit) {
            let (picture, heatmap) = self.shown.of(&layers)?;
            line.heatmap = heatmap;
            eight_bit = Some(picture);
        }
        let picture = eight_bit.as_ref();
        for sink in &mut self.sinks {
            match (sink, picture) {
                (Sink::Movie { movie, .. }, Some(picture)) => movie.push(picture)?,
                (Sink::Movie { .. }, None) => {}
                (Sink::Sequence { pattern, format }, picture) => {
                    let path = pattern.path(line.frame);
                    if !(self.skip_existing && path.exists()) {
                        still(&path, *format, self.overwrite, picture, &layers, &metadata)?;
                        line.outputs.push(path.display().to_string());
                    }
                }
            }
        }
        line.times.encode_ms = begun.elapsed().as_secs_f64() * 1e3;
        if self.json {
            output::print_json(&line)?;
        }
        Ok(line)
    }
}

/// Writes a picture of its own, as `render` does.
fn still(path: &Path, format: Format, overwrite: Overwrite, picture: Option<&Rgb8>, layers: &Layers, metadata: &Metadata) -> Result<()> {
    Ok(write_file(path, overwrite, |writer| match (format, picture) {
        (Format::Png, Some(picture)) => encode_png(writer, picture, metadata),
        _ => encode_exr(writer, layers, metadata),
    })?)
}
