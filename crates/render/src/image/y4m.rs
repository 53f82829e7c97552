//! Y4M: uncompressed video, for pipes.

use std::io::Write;
use std::path::Path;

use super::movie::same_size;
use super::{Error, Rate, Result, Rgb8};

/// How many colour samples there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Chroma {
    /// One for four pixels, in their middle: what every player shows. Odd sides are rounded up.
    #[default]
    C420,
    /// One a pixel.
    C444,
}

/// How colours become brightness and two colour differences.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Matrix {
    /// ITU-R BT.601: what players expect of small pictures.
    Bt601,
    /// ITU-R BT.709: what they expect of large ones.
    Bt709,
}

impl Matrix {
    /// What players take a picture for whose file does not say: BT.709 from 720 rows or 1280 columns on.
    pub const fn of_size(width: u32, height: u32) -> Matrix {
        if height >= 720 || width >= 1280 { Matrix::Bt709 } else { Matrix::Bt601 }
    }

    /// Weights of red and blue in the brightness; green has the rest.
    const fn weights(self) -> (f32, f32) {
        match self {
            Matrix::Bt601 => (0.299, 0.114),
            Matrix::Bt709 => (0.2126, 0.0722),
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Matrix::Bt601 => "BT601",
            Matrix::Bt709 => "BT709",
        }
    }
}

/// Writes YUV4MPEG2, frame by frame: three planes of eight bits, brightness from 16 to 235, colour differences from 16 to 240 around 128.
/// The header says so (`XCOLORRANGE=LIMITED`), and by which matrix (`XCOLORMATRIX`, which programs that do not know it pass over).
#[derive(Debug)]
pub struct Y4mEncoder<W> {
    writer: W,
    rate: Rate,
    chroma: Chroma,
    matrix: Option<Matrix>,
    last: Option<Rgb8>,
    planes: Vec<u8>,
}

impl<W: Write> Y4mEncoder<W> {
    /// Begins a video. Without a matrix the size decides: [`Matrix::of_size`].
    pub fn new(writer: W, rate: Rate, chroma: Chroma, matrix: Option<Matrix>) -> Y4mEncoder<W> {
        Y4mEncoder { writer, rate, chroma, matrix, last: None, planes: Vec::new() }
    }

    /// Adds a frame, of three channels.
    ///
    /// # Errors
    /// [`Error::Encode`] when it has alpha or another size than the first; [`Error::Write`] when the writer fails.
    pub fn push(&mut self, picture: &Rgb8) -> Result<()> {
        let (width, height) = (picture.width as usize, picture.height as usize);
        if picture.channels != 3 || picture.data.len() != width * height * 3 || picture.data.is_empty() {
            return Err(Error::Encode { reason: "video wants frames of red, green and blue".to_owned() });
        }
        let matrix = self.matrix.unwrap_or(Matrix::of_size(picture.width, picture.height));
        match &self.last {
            Some(last) => same_size(last, picture)?,
            None => {
                let chroma = match self.chroma {
                    Chroma::C420 => "420jpeg",
                    Chroma::C444 => "444",
                };
                let (numerator, denominator) = (self.rate.numerator(), self.rate.denominator());
                let header = format!(
                    "YUV4MPEG2 W{width} H{height} F{numerator}:{denominator} Ip A1:1 C{chroma} XCOLORRANGE=LIMITED XCOLORMATRIX={}\n",
                    matrix.name()
                );
                self.writer.write_all(header.as_bytes()).map_err(failed)?;
            }
        }
        self.planes.clear();
        convert(&picture.data, width, self.chroma, matrix, &mut self.planes);
        self.writer.write_all(b"FRAME\n").and_then(|()| self.writer.write_all(&self.planes)).map_err(failed)?;
        self.last = Some(Rgb8 { data: Vec::new(), ..*picture });
        Ok(())
    }

    /// Writes what is still held back, and gives the writer back.
    ///
    /// # Errors
    /// [`Error::Write`] when the writer fails.
    pub fn finish(mut self) -> Result<W> {
        self.writer.flush().map_err(failed)?;
        Ok(self.writer)
    }
}

fn failed(source: std::io::Error) -> Error {
    super::file::write_error(Path::new("the video"), source)
}

/// The three planes of a picture, one behind the other.
fn convert(rgb: &[u8], width: usize, chroma: Chroma, matrix: Matrix, planes: &mut Vec<u8>) {
    let (red, blue) = matrix.weights();
    let green = 1.0 - red - blue;
    let (pixels, _) = rgb.as_chunks::<3>();
    let float = |pixel: &[u8; 3]| pixel.map(f32::from);
    let brightness = |[r, g, b]: [f32; 3]| red * r + green * g + blue * b;
    // Differences reach 1 - weight of 255 either way, which is to become 112.
    let (blue_scale, red_scale) = (112.0 / 255.0 / (1.0 - blue), 112.0 / 255.0 / (1.0 - red));
    planes.extend(pixels.iter().map(|pixel| (brightness(float(pixel)) * (219.0 / 255.0) + 16.5) as u8));
    let blueness = |color: [f32; 3]| ((color[2] - brightness(color)) * blue_scale + 128.5) as u8;
    let redness = |color: [f32; 3]| ((color[0] - brightness(color)) * red_scale + 128.5) as u8;
    match chroma {
        Chroma::C444 => {
            planes.extend(pixels.iter().map(|pixel| blueness(float(pixel))));
            planes.extend(pixels.iter().map(|pixel| redness(float(pixel))));
        }
        Chroma::C420 => {
            // Differences are linear in the colours, so the mean colour has the mean differences. At an odd edge there are fewer than four.
            let rows: Vec<&[[u8; 3]]> = pixels.chunks_exact(width.max(1)).collect();
            let means: Vec<[f32; 3]> = rows
                .chunks(2)
                .flat_map(|rows| {
                    (0..width.div_ceil(2)).map(|x| {
                        let block = rows.iter().flat_map(|row| &row[2 * x..(2 * x + 2).min(width)]).map(float);
                        let (sum, count) = block
                            .fold(([0.0; 3], 0.0), |([r, g, b], count), pixel| ([r + pixel[0], g + pixel[1], b + pixel[2]], count + 1.0));
                        sum.map(|value| value / count)
                    })
                })
                .collect();
            planes.extend(means.iter().map(|color| blueness(*color)));
            planes.extend(means.iter().map(|color| redness(*color)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Chroma, Matrix, convert};

    fn planes(rgb: &[u8], width: usize, chroma: Chroma, matrix: Matrix) -> Vec<u8> {
        let mut planes = Vec::new();
        convert(rgb, width, chroma, matrix, &mut planes);
        planes
    }

    /// The values of the colour bars in both recommendations.
    #[test]
    fn known_colours() {
        for (rgb, small, large) in [
            ([0, 0, 0], [16, 128, 128], [16, 128, 128]),
            ([255, 255, 255], [235, 128, 128], [235, 128, 128]),
            ([255, 0, 0], [81, 90, 240], [63, 102, 240]),
            ([0, 255, 0], [145, 54, 34], [173, 42, 26]),
            ([0, 0, 255], [41, 240, 110], [32, 240, 118]),
        ] {
            assert_eq!(planes(&rgb, 1, Chroma::C444, Matrix::Bt601), small, "{rgb:?}");
            assert_eq!(planes(&rgb, 1, Chroma::C444, Matrix::Bt709), large, "{rgb:?}");
            assert_eq!(planes(&rgb, 1, Chroma::C420, Matrix::Bt709), large, "{rgb:?}");
        }
    }

    #[test]
    fn odd_sides_are_rounded_up() {
        let rgb: Vec<u8> = (0..3 * 5 * 3).map(|i| (i * 5) as u8).collect();
        assert_eq!(planes(&rgb, 3, Chroma::C420, Matrix::Bt601).len(), 15 + 2 * 2 * 3);
        assert_eq!(planes(&rgb, 3, Chroma::C444, Matrix::Bt601).len(), 45);
        let grey = vec![77; 3 * 5 * 3];
        assert!(planes(&grey, 3, Chroma::C420, Matrix::Bt601)[15..].iter().all(|value| *value == 128));
    }
}
