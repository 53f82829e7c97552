//! Many frames in one file.

use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use super::ffmpeg::Ffmpeg;
use super::file::{PartFile, named};
use super::{ApngEncoder, Chroma, Error, GifEncoder, Matrix, Metadata, Overwrite, Rate, Result, Rgb8, Y4mEncoder};

/// The kinds of file that hold an animation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MovieFormat {
    /// Animated PNG.
    Apng,
    /// GIF.
    Gif,
    /// Uncompressed video.
    Y4m,
    /// H.264 by ffmpeg.
    Mp4,
    /// H.264 by ffmpeg, in Matroska.
    Mkv,
    /// VP9 by ffmpeg.
    Webm,
}

impl MovieFormat {
    /// All formats.
    pub const ALL: [MovieFormat; 6] =
        [MovieFormat::Apng, MovieFormat::Gif, MovieFormat::Y4m, MovieFormat::Mp4, MovieFormat::Mkv, MovieFormat::Webm];

    /// The file extension, without the dot, which is also the name in options.
    pub const fn extension(self) -> &'static str {
        match self {
            MovieFormat::Apng => "apng",
            MovieFormat::Gif => "gif",
            MovieFormat::Y4m => "y4m",
            MovieFormat::Mp4 => "mp4",
            MovieFormat::Mkv => "mkv",
            MovieFormat::Webm => "webm",
        }
    }

    /// What the format holds, in one line.
    pub const fn description(self) -> &'static str {
        match self {
            MovieFormat::Apng => "animated PNG, as exact as PNG; browsers play it",
            MovieFormat::Gif => "animated GIF: 255 colours, dithered",
            MovieFormat::Y4m => "uncompressed video (YUV4MPEG2), for pipes",
            MovieFormat::Mp4 => "H.264 video, where ffmpeg is installed",
            MovieFormat::Mkv => "H.264 video in Matroska, where ffmpeg is installed",
            MovieFormat::Webm => "VP9 video, where ffmpeg is installed",
        }
    }

    /// The format that a path's extension names.
    pub fn of_path(path: &Path) -> Option<MovieFormat> {
        let extension = path.extension()?.to_string_lossy().to_ascii_lowercase();
        MovieFormat::ALL.into_iter().find(|format| format.extension() == extension)
    }

    /// Whether ffmpeg makes it.
    pub const fn is_by_ffmpeg(self) -> bool {
        matches!(self, MovieFormat::Mp4 | MovieFormat::Mkv | MovieFormat::Webm)
    }

    /// Whether it can hold an alpha channel.
    pub const fn holds_alpha(self) -> bool {
        matches!(self, MovieFormat::Apng)
    }

    /// What keeps a movie from being this format, with the cure.
    pub fn obstacle(self, desc: &MovieDesc, size: [u32; 2], alpha: bool) -> Option<String> {
        let extension = self.extension();
        if alpha && !self.holds_alpha() {
            return Some(format!("{extension} holds no alpha channel; use .apng, or a sequence of PNG or EXR"));
        }
        match self {
            MovieFormat::Gif if desc.rate.per_second() > super::gif::MAX_RATE => {
                Some(format!("GIF shows at most 50 frames a second, not {}; lower --fps, or use .apng", desc.rate))
            }
            MovieFormat::Gif if size.iter().any(|side| *side > u32::from(u16::MAX)) => {
                Some("GIF has at most 65,535 columns and rows; lower --size".to_owned())
            }
            _ if self.is_by_ffmpeg() && desc.chroma == Chroma::C420 && size.iter().any(|side| side % 2 == 1) => {
                let [width, height] = size.map(|side| side + side % 2);
                Some(format!("{extension} wants even sides; use --size {width}x{height}, or --chroma 444"))
            }
            _ => None,
        }
    }
}

/// How a movie is written.
#[derive(Clone, Debug, PartialEq)]
pub struct MovieDesc {
    /// The kind of file.
    pub format: MovieFormat,
    /// Frames a second.
    pub rate: Rate,
    /// Colour samples of video.
    pub chroma: Chroma,
    /// What an animated PNG says about itself.
    pub metadata: Metadata,
}

/// A movie on its way into a file, frame by frame. The file appears whole, under its name, when it is finished; dropped before, it leaves
/// nothing behind.
#[derive(Debug)]
pub struct MovieWriter {
    name: PathBuf,
    desc: MovieDesc,
    frames: u64,
    encoder: Encoder,
}

type Out = BufWriter<PartFile>;

#[derive(Debug)]
enum Encoder {
    Apng(Box<ApngEncoder<Out>>),
    Gif(Box<GifEncoder<Out>>),
    Y4m(Box<Y4mEncoder<Out>>),
    Ffmpeg(Box<Ffmpeg>),
}

impl MovieWriter {
    /// Begins a file. A symbolic link is followed; into a device or pipe is written directly.
    ///
    /// # Errors
    /// [`Error::Write`], [`Error::Exists`] as [`write_file`](super::write_file); [`Error::Ffmpeg`] when ffmpeg is needed and not installed.
    pub fn create(path: &Path, overwrite: Overwrite, desc: &MovieDesc) -> Result<MovieWriter> {
        let part = PartFile::create(path, overwrite, seeks(desc.format))?;
        MovieWriter::new(part, desc)
    }

    /// Begins a movie in something that was opened by others, such as standard output; `name` is for messages. An animated PNG is gathered
    /// in memory first.
    ///
    /// # Errors
    /// [`Error::Ffmpeg`] for formats made by ffmpeg, which writes into files.
    pub fn stream(name: &Path, writer: Box<dyn Write + Send>, desc: &MovieDesc) -> Result<MovieWriter> {
        MovieWriter::new(PartFile::stream(name, writer, seeks(desc.format)), desc)
    }

    fn new(part: PartFile, desc: &MovieDesc) -> Result<MovieWriter> {
        let name = part.path().to_owned();
        let out = |part| BufWriter::with_capacity(1 << 16, part);
        let encoder = match desc.format {
            MovieFormat::Apng => Encoder::Apng(Box::new(ApngEncoder::new(out(part), desc.rate, desc.metadata.clone()))),
            MovieFormat::Gif => Encoder::Gif(Box::new(GifEncoder::new(out(part), desc.rate))),
            // The file does not say by which matrix it was made, so it is the one that players guess.
            MovieFormat::Y4m => Encoder::Y4m(Box::new(Y4mEncoder::new(out(part), desc.rate, desc.chroma, None))),
            MovieFormat::Mp4 | MovieFormat::Mkv | MovieFormat::Webm => Encoder::Ffmpeg(Box::new(Ffmpeg::new(part, desc)?)),
        };
        Ok(MovieWriter { name, desc: desc.clone(), frames: 0, encoder })
    }

    /// Frames so far.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Adds a frame, of the size and channels of the first.
    ///
    /// # Errors
    /// [`Error::Movie`] for what the format cannot hold; [`Error::Encode`] when frames differ in size; [`Error::Write`]; [`Error::Ffmpeg`].
    pub fn push(&mut self, picture: &Rgb8) -> Result<()> {
        if let Some(reason) = self.desc.format.obstacle(&self.desc, [picture.width, picture.height], picture.channels == 4) {
            return Err(Error::Movie { path: self.name.clone(), reason });
        }
        let pushed = match &mut self.encoder {
            Encoder::Apng(encoder) => encoder.push(picture),
            Encoder::Gif(encoder) => encoder.push(picture),
            Encoder::Y4m(encoder) => encoder.push(picture),
            Encoder::Ffmpeg(encoder) => encoder.push(picture),
        };
        pushed.map_err(|error| named(&self.name, error))?;
        self.frames += 1;
        Ok(())
    }

    /// Ends the movie with the frames so far and puts the file in its place. Without any frame there will be no file.
    ///
    /// # Errors
    /// [`Error::Write`]; [`Error::Exists`]; [`Error::Ffmpeg`].
    pub fn finish(self) -> Result<()> {
        if self.frames == 0 {
            return Ok(());
        }
        let out = match self.encoder {
            Encoder::Apng(encoder) => encoder.finish(),
            Encoder::Gif(encoder) => encoder.finish(),
            Encoder::Y4m(encoder) => encoder.finish(),
            Encoder::Ffmpeg(encoder) => return encoder.finish(),
        };
        let out = out.map_err(|error| named(&self.name, error))?;
        out.into_inner().map_err(|error| Error::write(&self.name, error.into_error()))?.commit()
    }
}

/// The number of frames stands at the beginning of an animated PNG and is known in the end.
const fn seeks(format: MovieFormat) -> bool {
    matches!(format, MovieFormat::Apng)
}

/// The matrix of video that says by which it was made.
pub(super) const MATRIX: Matrix = Matrix::Bt709;

/// Refuses a frame that is not of one kind with the one before.
pub(super) fn same_size(last: &Rgb8, next: &Rgb8) -> Result<()> {
    let kind = |picture: &Rgb8| (picture.width, picture.height, picture.channels);
    if kind(last) == kind(next) {
        return Ok(());
    }
    let [a, b] = [last, next].map(|picture| format!("{} x {} pixels of {} channels", picture.width, picture.height, picture.channels));
    Err(Error::Encode { reason: format!("the frames of a movie are of one size, but after {a} came {b}") })
}

/// The smallest rectangle (column, row, columns, rows) in which two pictures of one size differ; `None` if they are equal.
pub(super) fn changed(last: &Rgb8, next: &Rgb8) -> Option<[u32; 4]> {
    let channels = usize::from(next.channels);
    let stride = (next.width as usize * channels).max(1);
    let rows = || last.data.chunks_exact(stride).zip(next.data.chunks_exact(stride)).enumerate().filter(|(_, (a, b))| a != b);
    let top = rows().next()?.0;
    let (mut bottom, mut left, mut right) = (top, usize::MAX, 0);
    for (row, (a, b)) in rows() {
        bottom = row;
        let differs = |(a, b): (&u8, &u8)| a != b;
        left = left.min(a.iter().zip(b).position(differs)? / channels);
        right = right.max(a.iter().zip(b).rposition(differs)? / channels);
    }
    // Parts of sides of 32 bits.
    Some([left, top, right - left + 1, bottom - top + 1].map(|value| value as u32))
}
