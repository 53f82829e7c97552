//! Animated PNG: every frame as exact as a PNG, in one file that browsers play.

use std::io::{Seek, SeekFrom, Write};
use std::path::Path;

use super::movie::{changed, same_size};
use super::{Error, Metadata, Rate, Result, Rgb8, encode_png};

/// Writes an animated PNG (the APNG part of the third edition of the PNG specification, 2025), frame by frame. A frame holds the smallest
/// rectangle in which it differs from the one before; played, all frames are what was given, bit for bit. It repeats for ever.
#[derive(Debug)]
pub struct ApngEncoder<W> {
    writer: W,
    rate: Rate,
    metadata: Metadata,
    frames: u32,
    /// Numbers the chunks `fcTL` and `fdAT` in the order of the file.
    sequence: u32,
    /// Where the number of frames stands, which is known only in the end.
    control: u64,
    last: Option<Rgb8>,
}

impl<W: Write + Seek> ApngEncoder<W> {
    /// Begins an animation of equally long frames. `metadata` is that of [`encode_png`].
    pub fn new(writer: W, rate: Rate, metadata: Metadata) -> ApngEncoder<W> {
        ApngEncoder { writer, rate, metadata, frames: 0, sequence: 0, control: 0, last: None }
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// [`Error::Encode`] when it has another size or other channels than the first; [`Error::Write`] when the writer fails.
    pub fn push(&mut self, picture: &Rgb8) -> Result<()> {
        match self.last.take() {
            None => self.first(picture)?,
            Some(last) => {
                same_size(&last, picture)?;
                // A frame is never empty: where nothing changes, one pixel is written again.
                let [x, y, width, height] = changed(&last, picture).unwrap_or([0, 0, 1, 1]);
                let png = encoded(&part(picture, [x, y, width, height]), &Metadata::new())?;
                self.frame_control([x, y, width, height])?;
                for (_, data) in chunks(&png).filter(|(kind, _)| kind == b"IDAT") {
                    let mut numbered = self.next_sequence()?.to_be_bytes().to_vec();
                    numbered.extend_from_slice(data);
                    self.chunk(b"fdAT", &numbered)?;
                }
            }
        }
        self.frames = self.frames.checked_add(1).ok_or_else(|| too_long("frames"))?;
        self.last = Some(picture.clone());
        Ok(())
    }

    /// Ends the file with the frames so far, and gives the writer back.
    ///
    /// # Errors
    /// [`Error::Encode`] without any frame; [`Error::Write`] when the writer fails.
    pub fn finish(mut self) -> Result<W> {
        if self.frames == 0 {
            return Err(Error::Encode { reason: "an animated PNG needs a frame".to_owned() });
        }
        self.chunk(b"IEND", &[])?;
        self.writer.seek(SeekFrom::Start(self.control)).map_err(failed)?;
        self.animation_control()?;
        self.writer.seek(SeekFrom::End(0)).map_err(failed)?;
        self.writer.flush().map_err(failed)?;
        Ok(self.writer)
    }

    /// The first frame is also what programs show that know PNG alone.
    fn first(&mut self, picture: &Rgb8) -> Result<()> {
        let png = encoded(picture, &self.metadata)?;
        self.writer.write_all(&png[..SIGNATURE]).map_err(failed)?;
        let mut begun = false;
        for (kind, data) in chunks(&png).filter(|(kind, _)| kind != b"IEND") {
            if &kind == b"IDAT" && !begun {
                begun = true;
                self.control = self.writer.stream_position().map_err(failed)?;
                self.animation_control()?;
                self.frame_control([0, 0, picture.width, picture.height])?;
            }
            self.chunk(&kind, data)?;
        }
        Ok(())
    }

    fn animation_control(&mut self) -> Result<()> {
        let [a, b, c, d] = self.frames.to_be_bytes();
        // The second number counts the repetitions; 0 is for ever.
        self.chunk(b"acTL", &[a, b, c, d, 0, 0, 0, 0])
    }

    fn frame_control(&mut self, [x, y, width, height]: [u32; 4]) -> Result<()> {
        let (seconds, parts) = delay(self.rate);
        let mut data = Vec::with_capacity(26);
        for value in [self.next_sequence()?, width, height, x, y] {
            data.extend_from_slice(&value.to_be_bytes());
        }
        data.extend_from_slice(&seconds.to_be_bytes());
        data.extend_from_slice(&parts.to_be_bytes());
        // The frame stays, and replaces what was in its rectangle, alpha included.
        data.extend_from_slice(&[0, 0]);
        self.chunk(b"fcTL", &data)
    }

    fn next_sequence(&mut self) -> Result<u32> {
        let number = self.sequence;
        self.sequence = number.checked_add(1).ok_or_else(|| too_long("chunks"))?;
        Ok(number)
    }

    fn chunk(&mut self, kind: &[u8; 4], data: &[u8]) -> Result<()> {
        let length = u32::try_from(data.len()).map_err(|_| too_long("bytes in a chunk"))?;
        let checksum = crc(kind.iter().chain(data));
        let mut write = |bytes: &[u8]| self.writer.write_all(bytes).map_err(failed);
        write(&length.to_be_bytes())?;
        write(kind)?;
        write(data)?;
        write(&checksum.to_be_bytes())
    }
}

/// Bytes before the first chunk.
const SIGNATURE: usize = 8;

fn failed(source: std::io::Error) -> Error {
    super::file::write_error(Path::new("the animated PNG"), source)
}

fn too_long(what: &str) -> Error {
    Error::Encode { reason: format!("an animated PNG cannot hold more {what}") }
}

fn encoded(picture: &Rgb8, metadata: &Metadata) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    encode_png(&mut bytes, picture, metadata)?;
    Ok(bytes)
}

/// Kind and data of the chunks of a PNG.
fn chunks(png: &[u8]) -> impl Iterator<Item = ([u8; 4], &[u8])> {
    let mut rest = png.get(SIGNATURE..).unwrap_or_default();
    std::iter::from_fn(move || {
        let (length, after) = rest.split_first_chunk::<4>()?;
        let (kind, after) = after.split_first_chunk::<4>()?;
        let (data, after) = after.split_at_checked(u32::from_be_bytes(*length) as usize)?;
        // The checksum follows.
        rest = after.get(4..)?;
        Some((*kind, data))
    })
}

fn part(picture: &Rgb8, [x, y, width, height]: [u32; 4]) -> Rgb8 {
    let channels = usize::from(picture.channels);
    let stride = picture.width as usize * channels;
    let data = picture
        .data
        .chunks_exact(stride.max(1))
        .skip(y as usize)
        .take(height as usize)
        .flat_map(|row| &row[x as usize * channels..(x + width) as usize * channels])
        .copied()
        .collect();
    Rgb8 { width, height, channels: picture.channels, data, not_finite: 0 }
}

/// The time of a frame as the two 16-bit numbers of the format, seconds = first / second.
fn delay(rate: Rate) -> (u16, u16) {
    let (mut seconds, mut parts) = (f64::from(rate.denominator()), f64::from(rate.numerator()));
    let largest = seconds.max(parts);
    if largest > f64::from(u16::MAX) {
        // The nearest fraction with the larger number at its limit.
        let scale = f64::from(u16::MAX) / largest;
        (seconds, parts) = ((seconds * scale).round(), (parts * scale).round());
    }
    // A divisor of 0 would stand for 100.
    (seconds as u16, parts.max(1.0) as u16)
}

/// The checksum of PNG (its Annex D): CRC-32 with the polynomial of Ethernet.
fn crc<'a>(bytes: impl Iterator<Item = &'a u8>) -> u32 {
    const TABLE: [u32; 256] = {
        let mut table = [0; 256];
        let mut n = 0;
        while n < 256 {
            let mut value = n as u32;
            let mut bit = 0;
            while bit < 8 {
                value = if value & 1 == 1 { 0xedb8_8320 ^ (value >> 1) } else { value >> 1 };
                bit += 1;
            }
            table[n] = value;
            n += 1;
        }
        table
    };
    !bytes.fold(u32::MAX, |crc, byte| TABLE[(crc as u8 ^ byte) as usize] ^ (crc >> 8))
}
