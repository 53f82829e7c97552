//! Movies: other decoders see every frame as it was given, for as long as it was meant.

use std::io::Cursor;
use std::path::Path;

use gridwalk_render::image::{
    ApngEncoder, Chroma, Error, GifEncoder, Matrix, Metadata, MetadataValue, MovieDesc, MovieFormat, MovieWriter, Overwrite, Rate, Rgb8,
    Y4mEncoder,
};
use image::AnimationDecoder;

use super::Random;

fn rate(text: &str) -> Rate {
    text.parse().unwrap()
}

fn picture(width: u32, height: u32, channels: u8, value: impl Fn(u32, u32, u8) -> u8) -> Rgb8 {
    let data = (0..height)
        .flat_map(|y| (0..width).flat_map(move |x| (0..channels).map(move |c| (x, y, c))))
        .map(|(x, y, c)| value(x, y, c))
        .collect();
    Rgb8 { width, height, channels, data, not_finite: 0 }
}

/// A bright square that moves over noise; the third frame is the second again, the last is wholly new.
fn frames(channels: u8, seed: u64) -> Vec<Rgb8> {
    let (width, height) = (23, 17);
    let mut random = Random(seed);
    let ground: Vec<u8> = (0..width * height * 4).map(|_| random.next_u32() as u8).collect();
    let square = |at: u32| {
        picture(width, height, channels, |x, y, c| {
            if x.abs_diff(at) < 3 && y.abs_diff(5) < 3 { 255 - c } else { ground[((y * width + x) * 4) as usize + c as usize] }
        })
    };
    let new = picture(width, height, channels, |x, y, c| (x * 7 + y * 3) as u8 ^ c);
    vec![square(4), square(9), square(9), square(20), new]
}

fn apng(frames: &[Rgb8], rate: Rate) -> Vec<u8> {
    let metadata = Metadata::new().with("software", MetadataValue::Text("gridwalk".to_owned()));
    let mut encoder = ApngEncoder::new(Cursor::new(Vec::new()), rate, metadata);
    for frame in frames {
        encoder.push(frame).unwrap();
    }
    encoder.finish().unwrap().into_inner()
}

/// Pixels (RGBA) and milliseconds of each frame of an animated PNG.
pub fn decode_apng(bytes: &[u8]) -> Vec<(Vec<u8>, f64)> {
    let decoder = image::codecs::png::PngDecoder::new(Cursor::new(bytes)).unwrap().apng().unwrap();
    let decoded = decoder.into_frames().collect_frames().unwrap();
    decoded
        .into_iter()
        .map(|frame| {
            let (numerator, denominator) = frame.delay().numer_denom_ms();
            (frame.into_buffer().into_raw(), f64::from(numerator) / f64::from(denominator))
        })
        .collect()
}

/// Pixels (RGB) and hundredths of a second of each frame of a GIF.
pub fn decode_gif(bytes: &[u8]) -> Vec<(Vec<u8>, u16)> {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(Cursor::new(bytes)).unwrap();
    let (width, height) = (usize::from(decoder.width()), usize::from(decoder.height()));
    assert_eq!(decoder.repeat(), gif::Repeat::Infinite);
    let mut canvas = vec![0; width * height * 3];
    let mut frames = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        let (left, top, columns) = (usize::from(frame.left), usize::from(frame.top), usize::from(frame.width));
        for (at, pixel) in frame.buffer.chunks_exact(4).enumerate().filter(|(_, pixel)| pixel[3] > 0) {
            let place = ((top + at / columns) * width + left + at % columns) * 3;
            canvas[place..place + 3].copy_from_slice(&pixel[..3]);
        }
        frames.push((canvas.clone(), frame.delay));
    }
    frames
}

fn rgba(picture: &Rgb8) -> Vec<u8> {
    let channels = usize::from(picture.channels);
    picture.data.chunks_exact(channels).flat_map(|pixel| [pixel[0], pixel[1], pixel[2], pixel.get(3).copied().unwrap_or(255)]).collect()
}

#[test]
fn an_animated_png_is_exact() {
    for channels in [3, 4] {
        let frames = frames(channels, 7);
        for (text, ms) in [("25", 40.0), ("23.976", 1001.0 / 24.0), ("0.5", 2000.0), ("1/100", 100_000.0)] {
            let bytes = apng(&frames, rate(text));
            let decoded = decode_apng(&bytes);
            assert_eq!(decoded.len(), frames.len());
            for (index, ((pixels, delay), frame)) in decoded.iter().zip(&frames).enumerate() {
                assert_eq!(*pixels, rgba(frame), "{channels} channels, frame {index}");
                assert!((delay / ms - 1.0).abs() < 1e-4, "{text}: {delay} ms");
            }
            assert_ne!(decoded[0].0, rgba(&frames[1]), "the comparison tells frames apart");
        }
    }
}

/// Programs that do not know the animation show the first frame; what the file says of itself stands before it; unchanged parts are left out.
#[test]
fn an_animated_png_is_a_png() {
    let frames = frames(3, 8);
    let bytes = apng(&frames, rate("25"));
    let mut reader = png::Decoder::new(Cursor::new(&bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    assert_eq!(pixels, frames[0].data);
    let info = reader.info();
    assert_eq!(info.animation_control().map(|control| (control.num_frames, control.num_plays)), Some((5, 0)));
    assert_eq!(info.srgb, Some(png::SrgbRenderingIntent::Perceptual));
    assert_eq!(info.uncompressed_latin1_text[0].text, "gridwalk");
    let still = apng(&vec![frames[0].clone(); 50], rate("25"));
    let once = apng(&frames[..1], rate("25"));
    assert!(still.len() < once.len() + 49 * 120, "frames that do not change take {} bytes", still.len() - once.len());
    assert_eq!(decode_apng(&still).len(), 50);
}

#[test]
fn a_gif_of_few_colours_is_exact() {
    let frames: Vec<Rgb8> =
        (0..6).map(|at| picture(31, 20, 3, |x, y, c| if x / 5 == at { 200 + c } else { ((x + y) % 8) as u8 * 30 + c })).collect();
    for text in ["24", "50", "30", "7"] {
        let mut encoder = GifEncoder::new(Vec::new(), rate(text));
        for frame in &frames {
            encoder.push(frame).unwrap();
        }
        let decoded = decode_gif(&encoder.finish().unwrap());
        assert_eq!(decoded.len(), frames.len());
        for (index, ((pixels, _), frame)) in decoded.iter().zip(&frames).enumerate() {
            assert!(*pixels == frame.data, "frame {index}");
        }
        let sum: u32 = decoded.iter().map(|(_, delay)| u32::from(*delay)).sum();
        assert_eq!(sum, (6.0 * 100.0 / rate(text).per_second()).round() as u32, "{text}: delays keep the rate on average");
        assert_ne!(decoded[0].0, frames[1].data, "the comparison tells frames apart");
    }
}

#[test]
fn a_gif_of_many_colours_is_near() {
    let frames: Vec<Rgb8> = (0..4)
        .map(|at| {
            picture(160, 120, 3, |x, y, c| match c {
                0 => x as u8,
                1 => (y * 2) as u8,
                _ => (x + y + at * 9) as u8,
            })
        })
        .collect();
    let mut encoder = GifEncoder::new(Vec::new(), rate("25"));
    for frame in &frames {
        encoder.push(frame).unwrap();
    }
    // A cut to other colours needs another palette.
    let cut = picture(160, 120, 3, |x, y, c| match c {
        0 => 255 - (x / 2) as u8,
        1 => (x ^ y) as u8,
        _ => 0,
    });
    encoder.push(&cut).unwrap();
    let decoded = decode_gif(&encoder.finish().unwrap());
    // Means over 8 x 8 pixels: the dither is meant to keep them.
    let blocks = |data: &[u8]| -> Vec<f64> {
        let mut sums = vec![0.0; 20 * 15 * 3];
        for (at, value) in data.iter().enumerate() {
            let (x, y, c) = (at / 3 % 160, at / 480, at % 3);
            sums[(y / 8 * 20 + x / 8) * 3 + c] += f64::from(*value) / 64.0;
        }
        sums
    };
    let error = |a: &[u8], b: &[u8]| {
        let (a, b) = (blocks(a), blocks(b));
        (a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
    };
    for (index, ((pixels, _), frame)) in decoded.iter().zip(frames.iter().chain([&cut])).enumerate() {
        let error = error(pixels, &frame.data);
        assert!(error < 8.0, "frame {index}: root mean square error {error} of 255");
    }
    assert!(error(&decoded[0].0, &cut.data) > 50.0, "the comparison tells frames apart");
}

/// By the definition of the recommendations, in double precision.
pub fn yuv([r, g, b]: [f64; 3], matrix: Matrix) -> [f64; 3] {
    let (red, blue) = if matrix == Matrix::Bt601 { (0.299, 0.114) } else { (0.2126, 0.0722) };
    let y = red * r + (1.0 - red - blue) * g + blue * b;
    [16.0 + 219.0 * y / 255.0, 128.0 + 224.0 * (b - y) / 255.0 / 2.0 / (1.0 - blue), 128.0 + 224.0 * (r - y) / 255.0 / 2.0 / (1.0 - red)]
}

#[test]
fn planes_of_video() {
    let frames = frames(3, 9);
    for chroma in [Chroma::C420, Chroma::C444] {
        for matrix in [Matrix::Bt601, Matrix::Bt709] {
            let mut encoder = Y4mEncoder::new(Vec::new(), rate("29.97"), chroma, Some(matrix));
            for frame in &frames {
                encoder.push(frame).unwrap();
            }
            let bytes = encoder.finish().unwrap();
            let end = bytes.iter().position(|byte| *byte == b'\n').unwrap() + 1;
            let header = std::str::from_utf8(&bytes[..end]).unwrap();
            let (kind, name) =
                (if chroma == Chroma::C420 { "420jpeg" } else { "444" }, if matrix == Matrix::Bt601 { "BT601" } else { "BT709" });
            assert_eq!(header, format!("YUV4MPEG2 W23 H17 F30000:1001 Ip A1:1 C{kind} XCOLORRANGE=LIMITED XCOLORMATRIX={name}\n"));
            let (columns, rows) = if chroma == Chroma::C420 { (12, 9) } else { (23, 17) };
            let length = 23 * 17 + 2 * columns * rows;
            assert_eq!(bytes.len() - end, frames.len() * (length + 6));
            let differs = |matrix: Matrix| {
                let mut worst = 0.0_f64;
                for (frame, part) in frames.iter().zip(bytes[end..].chunks_exact(length + 6)) {
                    assert_eq!(&part[..6], b"FRAME\n");
                    let pixel = |x: usize, y: usize| -> [f64; 3] { std::array::from_fn(|c| f64::from(frame.data[(y * 23 + x) * 3 + c])) };
                    for y in 0..17 {
                        for x in 0..23 {
                            worst = worst.max((f64::from(part[6 + y * 23 + x]) - yuv(pixel(x, y), matrix)[0]).abs());
                        }
                    }
                    let step = if chroma == Chroma::C420 { 2 } else { 1 };
                    for (y, x) in (0..rows).flat_map(|y| (0..columns).map(move |x| (y, x))) {
                        let near: Vec<[f64; 3]> = (y * step..(y * step + step).min(17))
                            .flat_map(|y| (x * step..(x * step + step).min(23)).map(move |x| (x, y)))
                            .map(|(x, y)| yuv(pixel(x, y), matrix))
                            .collect();
                        for plane in 1..3 {
                            let mean = near.iter().map(|color| color[plane]).sum::<f64>() / near.len() as f64;
                            let stored = part[6 + 23 * 17 + (plane - 1) * columns * rows + y * columns + x];
                            worst = worst.max((f64::from(stored) - mean).abs());
                        }
                    }
                }
                worst
            };
            assert!(differs(matrix) < 0.501, "{chroma:?} {matrix:?}: {}", differs(matrix));
            let other = if matrix == Matrix::Bt601 { Matrix::Bt709 } else { Matrix::Bt601 };
            assert!(differs(other) > 5.0, "the comparison tells the matrices apart");
        }
    }
    assert_eq!((Matrix::of_size(720, 576), Matrix::of_size(1280, 720)), (Matrix::Bt601, Matrix::Bt709));
}

#[test]
fn movies_appear_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let entries = || std::fs::read_dir(folder.path()).unwrap().count();
    for format in [MovieFormat::Apng, MovieFormat::Gif, MovieFormat::Y4m] {
        let desc = MovieDesc { format, rate: rate("25"), chroma: Chroma::C420, metadata: Metadata::new() };
        let path = folder.path().join(format!("a.{}", format.extension()));
        assert_eq!(MovieFormat::of_path(&path), Some(format));
        let mut movie = MovieWriter::create(&path, Overwrite::Refuse, &desc).unwrap();
        movie.push(&frames(3, 1)[0]).unwrap();
        assert!(!path.exists(), "not before the end");
        drop(movie);
        assert_eq!(entries(), 0, "given up, nothing is left");
        MovieWriter::create(&path, Overwrite::Refuse, &desc).unwrap().finish().unwrap();
        assert_eq!(entries(), 0, "without a frame there is no file");
        let mut movie = MovieWriter::create(&path, Overwrite::Refuse, &desc).unwrap();
        movie.push(&frames(3, 1)[0]).unwrap();
        let error = movie.push(&picture(5, 5, 3, |_, _, _| 0)).unwrap_err();
        assert!(error.to_string().contains("23 x 17") && error.to_string().contains("5 x 5"), "{error}");
        let mut movie = MovieWriter::create(&path, Overwrite::Refuse, &desc).unwrap();
        movie.push(&frames(3, 1)[0]).unwrap();
        assert_eq!(movie.frames(), 1);
        movie.finish().unwrap();
        assert!(matches!(MovieWriter::create(&path, Overwrite::Refuse, &desc), Err(Error::Exists { .. })));
        std::fs::remove_file(&path).unwrap();
    }
    let desc = MovieDesc { format: MovieFormat::Gif, rate: rate("60"), chroma: Chroma::C420, metadata: Metadata::new() };
    let mut movie = MovieWriter::create(&folder.path().join("a.gif"), Overwrite::Replace, &desc).unwrap();
    assert!(matches!(movie.push(&frames(3, 1)[0]), Err(Error::Movie { .. })), "no player shows 60 frames of a GIF a second");
    drop(movie);
    let alpha = MovieDesc { rate: rate("10"), ..desc };
    let mut movie = MovieWriter::create(&folder.path().join("a.gif"), Overwrite::Replace, &alpha).unwrap();
    assert!(matches!(movie.push(&frames(4, 1)[0]), Err(Error::Movie { .. })));
    drop(movie);
    assert_eq!(entries(), 0);
}

/// A stream cannot seek, but an animated PNG can go through one.
#[test]
fn movies_into_streams() {
    let shared = std::sync::Arc::new(std::sync::Mutex::new(Vec::new()));
    struct Stream(std::sync::Arc<std::sync::Mutex<Vec<u8>>>);
    impl std::io::Write for Stream {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.lock().unwrap().extend_from_slice(bytes);
            Ok(bytes.len())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let frames = frames(3, 3);
    let desc = MovieDesc { format: MovieFormat::Apng, rate: rate("25"), chroma: Chroma::C420, metadata: Metadata::new() };
    let mut movie = MovieWriter::stream(Path::new("-"), Box::new(Stream(shared.clone())), &desc).unwrap();
    for frame in &frames {
        movie.push(frame).unwrap();
    }
    movie.finish().unwrap();
    let decoded = decode_apng(&shared.lock().unwrap());
    assert!(decoded.iter().map(|(pixels, _)| pixels.clone()).eq(frames.iter().map(rgba)));
}
