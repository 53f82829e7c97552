//! GIF: 255 colours at a time, shown everywhere.

use std::collections::HashMap;
use std::io::Write;
use std::path::Path;

use color_quant::NeuQuant;

use super::movie::same_size;
use super::{Error, Rate, Result, Rgb8};

/// Writes an animated GIF, frame by frame; it repeats for ever.
///
/// Frames of up to 255 colours are exact. Others get a palette by Kohonen's neural network (Dekker 1994) and an ordered dither, which stands
/// still where the picture does. A palette is kept as long as it serves, so that colours do not flicker; pixels that stay as they were are
/// left out. Times of frames are in hundredths of a second, chosen so that the whole keeps its rate.
pub struct GifEncoder<W: Write> {
    /// Not yet made before the first frame; the writer then waits in the second.
    encoder: Option<::gif::Encoder<W>>,
    writer: Option<W>,
    rate: Rate,
    frames: u64,
    palette: Option<Palette>,
    last: Option<Rgb8>,
    /// What is to be seen after the frames so far.
    canvas: Vec<Color>,
}

impl<W: Write> std::fmt::Debug for GifEncoder<W> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("GifEncoder").field("rate", &self.rate).field("frames", &self.frames).finish_non_exhaustive()
    }
}

type Color = [u8; 3];

/// Colours of a palette; the one after them stands for "as before".
const COLORS: usize = 255;
const AS_BEFORE: u8 = 255;

/// Every so many pixels are looked at to judge a palette; a prime, so that they are no columns of the picture.
const SAMPLE: usize = 31;

/// Frames a second at most: players show frames of one hundredth of a second ten times as long.
pub(super) const MAX_RATE: f64 = 50.0;

impl<W: Write> GifEncoder<W> {
    /// Begins an animation of equally long frames.
    pub fn new(writer: W, rate: Rate) -> GifEncoder<W> {
        GifEncoder { encoder: None, writer: Some(writer), rate, frames: 0, palette: None, last: None, canvas: Vec::new() }
    }

    /// Adds a frame, of three channels.
    ///
    /// # Errors
    /// [`Error::Encode`] when it has alpha, a side above 65,535, or another size than the first; [`Error::Write`] when the writer fails.
    pub fn push(&mut self, picture: &Rgb8) -> Result<()> {
        let refuse = |reason: &str| Error::Encode { reason: reason.to_owned() };
        let (Ok(width), Ok(height)) = (u16::try_from(picture.width), u16::try_from(picture.height)) else {
            return Err(refuse("a GIF has at most 65,535 columns and rows"));
        };
        let pixels = usize::from(width) * usize::from(height);
        if picture.channels != 3 || picture.data.len() != pixels * 3 || pixels == 0 {
            return Err(refuse("a GIF wants frames of red, green and blue"));
        }
        if let Some(last) = &self.last {
            same_size(last, picture)?;
        }
        let (colors, _) = picture.data.as_chunks::<3>();
        let palette = match self.palette.take().filter(|palette| palette.serves(colors)) {
            Some(palette) => palette,
            None => Palette::new(colors),
        };

        let stride = usize::from(width);
        let mut indices = vec![AS_BEFORE; pixels];
        let [mut left, mut right, mut top, mut bottom] = [usize::MAX, 0, usize::MAX, 0];
        let first = self.canvas.is_empty();
        self.canvas.resize(pixels, [0; 3]);
        for (at, ((color, index), shown)) in colors.iter().zip(&mut indices).zip(&mut self.canvas).enumerate() {
            let (x, y) = (at % stride, at / stride);
            let nearest = palette.index(*color, x, y);
            let new = palette.colors[usize::from(nearest)];
            if first || new != *shown {
                (*index, *shown) = (nearest, new);
                (left, right, top, bottom) = (left.min(x), right.max(x), top.min(y), bottom.max(y));
            }
        }
        // A frame is never empty: where nothing changes, one pixel stays as before.
        if left > right {
            [left, right, top, bottom] = [0; 4];
        }
        let buffer: Vec<u8> = (top..=bottom).flat_map(|row| &indices[row * stride + left..=row * stride + right]).copied().collect();

        let encoder = match &mut self.encoder {
            Some(encoder) => encoder,
            None => {
                let writer = self.writer.take().ok_or_else(|| refuse("the GIF could not be begun"))?;
                let mut encoder = ::gif::Encoder::new(writer, width, height, &[]).map_err(failed)?;
                encoder.set_repeat(::gif::Repeat::Infinite).map_err(failed)?;
                self.encoder.insert(encoder)
            }
        };
        let mut table = palette.colors.as_flattened().to_vec();
        table.resize(256 * 3, 0);
        // Sides of 16 bits hold parts of them.
        let frame = ::gif::Frame {
            delay: delay(self.rate, self.frames),
            dispose: ::gif::DisposalMethod::Keep,
            transparent: Some(AS_BEFORE),
            needs_user_input: false,
            top: top as u16,
            left: left as u16,
            width: (right - left + 1) as u16,
            height: (bottom - top + 1) as u16,
            interlaced: false,
            palette: Some(table),
            buffer: buffer.into(),
        };
        encoder.write_frame(&frame).map_err(failed)?;
        self.frames += 1;
        self.palette = Some(palette);
        self.last = Some(Rgb8 { data: Vec::new(), ..*picture });
        Ok(())
    }

    /// Ends the file with the frames so far, and gives the writer back.
    ///
    /// # Errors
    /// [`Error::Encode`] without any frame; [`Error::Write`] when the writer fails.
    pub fn finish(self) -> Result<W> {
        let encoder = self.encoder.ok_or_else(|| Error::Encode { reason: "a GIF needs a frame".to_owned() })?;
        let mut writer = encoder.into_inner().map_err(failed)?;
        writer.flush().map_err(|source| failed(::gif::EncodingError::Io(source)))?;
        Ok(writer)
    }
}

fn failed(error: ::gif::EncodingError) -> Error {
    match error {
        ::gif::EncodingError::Io(source) => super::file::write_error(Path::new("the GIF"), source),
        other => Error::Encode { reason: other.to_string() },
    }
}

/// Hundredths of a second of a frame: the difference of two rounded times, so that roundings do not add up.
fn delay(rate: Rate, frame: u64) -> u16 {
    let end = |frame: u64| (rate.time(frame) * 100.0).round();
    // Saturates at eleven minutes.
    (end(frame + 1) - end(frame)) as u16
}

struct Palette {
    /// 1 to 255.
    colors: Vec<Color>,
    finder: Finder,
}

enum Finder {
    /// Every colour there is.
    Exact(HashMap<Color, u8>),
    /// The nearest colour.
    Nearest {
        network: NeuQuant,
        /// Root of the mean square error a channel of what it was made for.
        error: f32,
    },
}

impl Palette {
    fn new(pixels: &[Color]) -> Palette {
        let mut known = HashMap::new();
        let mut colors = Vec::new();
        let mut last = None;
        for color in pixels {
            if last != Some(color) && !known.contains_key(color) {
                if colors.len() == COLORS {
                    return Palette::of_many(pixels);
                }
                known.insert(*color, colors.len() as u8);
                colors.push(*color);
            }
            last = Some(color);
        }
        Palette { colors, finder: Finder::Exact(known) }
    }

    fn of_many(pixels: &[Color]) -> Palette {
        let rgba: Vec<u8> = pixels.iter().flat_map(|[r, g, b]| [*r, *g, *b, 255]).collect();
        // One pixel in ten trains the network: the compromise that its author recommends.
        let network = NeuQuant::new(10, COLORS, &rgba);
        let colors = network.color_map_rgb().as_chunks::<3>().0.to_vec();
        let mut palette = Palette { colors, finder: Finder::Nearest { network, error: 0.0 } };
        let made_for = palette.error(pixels);
        if let Finder::Nearest { error, .. } = &mut palette.finder {
            *error = made_for;
        }
        palette
    }

    /// Whether a picture looks as good with this palette as with one of its own, nearly.
    fn serves(&self, pixels: &[Color]) -> bool {
        match &self.finder {
            Finder::Exact(known) => pixels.iter().all(|color| known.contains_key(color)),
            Finder::Nearest { error, .. } => self.error(pixels) <= 1.25 * error + 0.5,
        }
    }

    fn error(&self, pixels: &[Color]) -> f32 {
        let Finder::Nearest { network, .. } = &self.finder else { return 0.0 };
        let (mut sum, mut count) = (0.0, 0.0);
        for color in pixels.iter().step_by(SAMPLE) {
            let nearest = self.colors[network.index_of(&[color[0], color[1], color[2], 255])];
            sum += color.iter().zip(nearest).map(|(a, b)| (f32::from(*a) - f32::from(b)).powi(2)).sum::<f32>();
            count += 3.0;
        }
        f32::sqrt(sum / f32::max(count, 1.0))
    }

    fn index(&self, color: Color, x: usize, y: usize) -> u8 {
        match &self.finder {
            Finder::Exact(known) => known.get(&color).copied().unwrap_or(0),
            Finder::Nearest { network, error } => {
                // Twice the root mean square error either way reaches the neighbouring colours of the palette.
                let offset = bayer(x, y) * 4.0 * error.min(8.0);
                let [r, g, b] = color.map(|value| (f32::from(value) + offset + 0.5) as u8);
                network.index_of(&[r, g, b, 255]) as u8
            }
        }
    }
}

/// The ordered dither of Bayer (1973) with 64 levels, from -0.5 to below 0.5.
fn bayer(x: usize, y: usize) -> f32 {
    let (x, y) = (x & 7, y & 7);
    let mut value = 0;
    for bit in 0..3 {
        let (x, y) = (x >> bit & 1, y >> bit & 1);
        value = value << 2 | (x ^ y) << 1 | y;
    }
    (value as f32 + 0.5) / 64.0 - 0.5
}

#[cfg(test)]
mod tests {
    use super::{bayer, delay};
    use crate::image::Rate;

    #[test]
    fn every_level_once() {
        let mut levels: Vec<u32> = (0..64).map(|i| ((bayer(i % 8, i / 8) + 0.5) * 64.0) as u32).collect();
        // Neighbours are far apart.
        assert!((0..7).all(|x| levels[x].abs_diff(levels[x + 1]) >= 8), "{levels:?}");
        levels.sort_unstable();
        assert!(levels.into_iter().eq(0..64));
    }

    #[test]
    fn delays_keep_the_rate() {
        for text in ["24", "23.976", "30", "12.5", "50", "7"] {
            let Ok(rate) = text.parse::<Rate>() else { unreachable!("{text}") };
            let mut sum = 0;
            for frame in 0..1000 {
                let delay = delay(rate, frame);
                let exact = 100.0 / rate.per_second();
                assert!((f64::from(delay) - exact).abs() < 1.0, "{text}: {delay} for {exact}");
                sum += u64::from(delay);
                assert!((sum as f64 - exact * (frame + 1) as f64).abs() <= 0.5 + 1e-6, "{text}, frame {frame}");
            }
        }
    }
}
