//! Compressed video: by ffmpeg, which is a program of its own.

use std::io::{BufWriter, ErrorKind, Read};
use std::path::PathBuf;
use std::process::{Child, ChildStderr, ChildStdin, Command, Stdio};
use std::thread::JoinHandle;

use super::file::PartFile;
use super::movie::MATRIX;
use super::{Chroma, Error, MovieDesc, MovieFormat, Result, Rgb8, Y4mEncoder};

/// Feeds ffmpeg with frames. It writes into the temporary file, which is put in its place in the end.
#[derive(Debug)]
pub(super) struct Ffmpeg {
    part: PartFile,
    desc: MovieDesc,
    running: Option<Running>,
}

#[derive(Debug)]
struct Running {
    child: Child,
    input: Option<Y4mEncoder<BufWriter<ChildStdin>>>,
    /// Gathers what it says, so that it never waits for a reader.
    said: Option<JoinHandle<String>>,
}

/// The program, looked for where the shell looks for it.
const PROGRAM: &str = "ffmpeg";

/// What is kept of what ffmpeg says, from its end.
const SAID: usize = 4096;

impl Ffmpeg {
    /// Makes sure that there is an ffmpeg, before there are frames.
    pub(super) fn new(part: PartFile, desc: &MovieDesc) -> Result<Ffmpeg> {
        let ffmpeg = Ffmpeg { part, desc: desc.clone(), running: None };
        if ffmpeg.part.temporary_path().is_none() {
            return Err(ffmpeg.failed("ffmpeg writes into files alone; give the name of one, or pipe --format y4m into it"));
        }
        let probe = Command::new(PROGRAM).arg("-version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status();
        probe.map_err(|error| ffmpeg.not_started(&error))?;
        Ok(ffmpeg)
    }

    pub(super) fn push(&mut self, picture: &Rgb8) -> Result<()> {
        if self.running.is_none() {
            self.running = Some(self.start()?);
        }
        let Some(Running { input: Some(input), .. }) = &mut self.running else {
            return Err(self.failed("it has already ended"));
        };
        match input.push(picture) {
            // It has closed its end: what it said tells why.
            Err(Error::Write { source, .. }) => Err(match self.wait() {
                Ok(()) => self.failed(format!("it takes no more frames: {source}")),
                Err(error) => error,
            }),
            other => other,
        }
    }

    pub(super) fn finish(mut self) -> Result<()> {
        self.wait()?;
        self.part.commit()
    }

    fn start(&self) -> Result<Running> {
        let temporary = self.part.temporary_path().ok_or_else(|| self.failed("there is no file to write into"))?;
        let mut command = Command::new(PROGRAM);
        command.args(["-hide_banner", "-loglevel", "error", "-y"]).args(COLORS).args(["-f", "yuv4mpegpipe", "-i", "-"]);
        command.args(codec(self.desc.format)).args(COLORS).args(["-color_trc", "iec61966-2-1", "-color_primaries", "bt709"]);
        command.args(["-pix_fmt", pixel_format(self.desc.chroma), "-f", container(self.desc.format)]).arg(temporary);
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
        #[cfg(unix)]
        {
            // Ctrl-C in a terminal goes to the whole group; ffmpeg is to end when there are no more frames.
            use std::os::unix::process::CommandExt;
            command.process_group(0);
        }
        let mut child = command.spawn().map_err(|error| self.not_started(&error))?;
        let (Some(stdin), Some(stderr)) = (child.stdin.take(), child.stderr.take()) else {
            return Err(self.failed("it has no standard input"));
        };
        let input = Y4mEncoder::new(BufWriter::with_capacity(1 << 16, stdin), self.desc.rate, self.desc.chroma, Some(MATRIX));
        Ok(Running { child, input: Some(input), said: Some(std::thread::spawn(move || listen(stderr))) })
    }

    /// Waits until ffmpeg has ended, after the last frame.
    fn wait(&mut self) -> Result<()> {
        let Some(mut running) = self.running.take() else { return Ok(()) };
        // Its input ends when the pipe is closed. An error of the last bytes is told by how it ends.
        let flushed = running.input.take().map_or(Ok(()), |input| input.finish().map(drop));
        let status = running.child.wait().map_err(|error| self.failed(error.to_string()))?;
        let said = running.said.take().and_then(|said| said.join().ok()).unwrap_or_default();
        if status.success() && flushed.is_ok() {
            return Ok(());
        }
        let said = if said.is_empty() { "it says nothing".to_owned() } else { said };
        Err(self.failed(format!("{status}: {said}")))
    }

    fn not_started(&self, error: &std::io::Error) -> Error {
        self.failed(match error.kind() {
            ErrorKind::NotFound => {
                "it is not installed (Debian: apt install ffmpeg); or use .apng, .gif or .y4m, which need no other program".to_owned()
            }
            _ => format!("it cannot be started: {error}"),
        })
    }

    fn failed(&self, reason: impl Into<String>) -> Error {
        Error::Ffmpeg { path: PathBuf::from(self.part.path()), reason: reason.into() }
    }
}

impl Drop for Running {
    /// Given up, unless it was waited for: what it has written so far goes with the temporary file.
    fn drop(&mut self) {
        if let Some(said) = self.said.take() {
            // A child that has ended already cannot be killed, which is as well.
            let _ = self.child.kill();
            self.input = None;
            let _ = self.child.wait();
            let _ = said.join();
        }
    }
}

/// Of what is read and of what is written, so that nothing is converted.
const COLORS: [&str; 4] = ["-colorspace", "bt709", "-color_range", "tv"];

const fn codec(format: MovieFormat) -> &'static [&'static str] {
    match format {
        // Constant quality at which losses are hard to see; the index goes to the beginning, so that browsers can start at once.
        MovieFormat::Mp4 => &["-c:v", "libx264", "-crf", "18", "-movflags", "+faststart"],
        MovieFormat::Webm => &["-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0"],
        _ => &["-c:v", "libx264", "-crf", "18"],
    }
}

/// The name of the container, which the temporary file's ending does not tell.
const fn container(format: MovieFormat) -> &'static str {
    match format {
        MovieFormat::Mkv => "matroska",
        MovieFormat::Webm => "webm",
        _ => "mp4",
    }
}

const fn pixel_format(chroma: Chroma) -> &'static str {
    match chroma {
        Chroma::C420 => "yuv420p",
        Chroma::C444 => "yuv444p",
    }
}

/// Everything that it says, or the end of it.
fn listen(mut stderr: ChildStderr) -> String {
    let mut said = Vec::new();
    let mut buffer = [0; 1024];
    while let Ok(length @ 1..) = stderr.read(&mut buffer) {
        said.extend_from_slice(&buffer[..length]);
        if said.len() > 2 * SAID {
            said.drain(..said.len() - SAID);
        }
    }
    String::from_utf8_lossy(&said).trim().to_owned()
}
