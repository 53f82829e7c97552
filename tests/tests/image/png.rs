use std::io::Cursor;

use gridwalk_render::image::{Error, Metadata, MetadataValue, PngOptions, ReadLimits, Rgb8, Tonemap, encode_png, read, tonemapped};

use super::{all_layers, beauty};

fn encode(picture: &Rgb8, metadata: &Metadata) -> Vec<u8> {
    let mut bytes = Vec::new();
    encode_png(&mut bytes, picture, metadata).unwrap();
    bytes
}

fn decode(bytes: &[u8]) -> (png::Info<'static>, Vec<u8>) {
    let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    reader.finish().unwrap();
    (reader.info().clone(), pixels)
}

#[test]
fn round_trip() {
    for (width, height) in [(1, 1), (7, 3), (64, 65)] {
        for alpha in [false, true] {
            let layers = beauty(width, height, |x, y| [x as f32 / 64.0, y as f32 / 65.0, 0.5, 1.0]);
            let picture = tonemapped(&layers, &PngOptions { alpha, ..PngOptions::default() }).unwrap();
            let bytes = encode(&picture, &Metadata::new());
            assert_eq!(bytes, encode(&picture, &Metadata::new()), "the same picture gives the same bytes");
            let (info, pixels) = decode(&bytes);
            assert_eq!((info.width, info.height), (width, height));
            assert_eq!(info.color_type, if alpha { png::ColorType::Rgba } else { png::ColorType::Rgb });
            assert_eq!(pixels, picture.data);
        }
    }
}

#[test]
fn says_srgb_and_who_made_it() {
    let picture = tonemapped(&beauty(2, 2, |_, _| [1.0; 4]), &PngOptions::default()).unwrap();
    let metadata = Metadata::new()
        .with("software", MetadataValue::Text("gridwalk 1.2.3".to_owned()))
        .with("scene", MetadataValue::Text("Gr\u{fc}\u{df}e \u{1f600}\u{0}".to_owned()))
        .with("spp", MetadataValue::Int(4))
        .with("worldToNDC", MetadataValue::Matrix([0.0; 16]));
    let (info, _) = decode(&encode(&picture, &metadata));
    assert_eq!(info.srgb, Some(png::SrgbRenderingIntent::Perceptual));
    let texts: Vec<_> = info.uncompressed_latin1_text.iter().map(|chunk| (chunk.keyword.as_str(), chunk.text.as_str())).collect();
    assert_eq!(texts, [("Software", "gridwalk 1.2.3"), ("scene", "Gr\u{fc}\u{df}e ??"), ("spp", "4")]);
}

#[test]
fn exposure_is_in_stops() {
    let dark = beauty(1, 1, |_, _| [0.1, 0.2, 0.05, 1.0]);
    let bright = beauty(1, 1, |_, _| [0.4, 0.8, 0.2, 1.0]);
    for tonemap in Tonemap::ALL {
        let raised = tonemapped(&dark, &PngOptions { exposure: 2.0, tonemap, alpha: false }).unwrap();
        let as_is = tonemapped(&bright, &PngOptions { tonemap, ..PngOptions::default() }).unwrap();
        assert_eq!(raised, as_is);
        assert_ne!(raised, tonemapped(&dark, &PngOptions { tonemap, ..PngOptions::default() }).unwrap());
    }
}

#[test]
fn values_that_are_no_number_are_counted() {
    let layers =
        beauty(4, 1, |x, _| [[f32::NAN, 0.5, 0.5, 1.0], [f32::INFINITY; 4], [f32::NEG_INFINITY, 1.0, 0.0, 1.0], [0.5; 4]][x as usize]);
    let picture = tonemapped(&layers, &PngOptions::default()).unwrap();
    assert_eq!(picture.not_finite, 3);
    assert_eq!(picture.data, [0, 188, 188, 255, 255, 255, 0, 255, 0, 188, 188, 188]);
}

#[test]
fn alpha_is_straight() {
    let layers = beauty(3, 1, |x, _| [[0.25, 0.125, 0.0, 0.5], [0.0; 4], [0.5, 0.5, 0.5, f32::NAN]][x as usize]);
    let picture = tonemapped(&layers, &PngOptions { alpha: true, ..PngOptions::default() }).unwrap();
    assert_eq!(picture.data, [188, 137, 0, 128, 0, 0, 0, 0, 188, 188, 188, 0]);
}

#[test]
fn needs_a_beauty() {
    let mut layers = gridwalk_render::Layers::new(1, 1);
    assert!(matches!(tonemapped(&layers, &PngOptions::default()), Err(Error::Layer { .. })));
    layers.push(super::layer("beauty", "", &["R", "G"], gridwalk_render::LayerData::Float(vec![0.0; 2]))).unwrap();
    let error = tonemapped(&layers, &PngOptions::default()).unwrap_err();
    assert!(error.to_string().contains("no channel B"), "{error}");
    assert!(tonemapped(&all_layers(2, 2), &PngOptions::default()).is_ok());
}

#[test]
fn reads_back_under_limits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let picture = tonemapped(&beauty(20, 10, |x, y| [x as f32 / 20.0, y as f32 / 10.0, 0.0, 1.0]), &PngOptions::default()).unwrap();
    std::fs::write(&path, encode(&picture, &Metadata::new())).unwrap();
    let layers = read(&path, ReadLimits::default()).unwrap();
    let stored: Vec<u8> = layers.get("beauty").unwrap().floats().unwrap().iter().map(|v| (v * 255.0).round() as u8).collect();
    assert_eq!(stored, picture.data);

    let error = read(&path, ReadLimits { bytes: 3199 }).unwrap_err();
    assert!(matches!(error, Error::TooLarge { needed: 3200, .. }), "{error}");
    assert!(error.to_string().contains("a.png"), "{error}");

    // A header that claims more than there is, cut files, files of another kind, no file.
    let bytes = std::fs::read(&path).unwrap();
    for length in [0, 4, 8, 20, 33, 40, bytes.len() - 13] {
        std::fs::write(&path, &bytes[..length]).unwrap();
        let error = read(&path, ReadLimits::default()).unwrap_err();
        assert!(matches!(error, Error::Decode { .. }), "cut to {length}: {error}");
    }
    assert!(matches!(read(&folder.path().join("none.png"), ReadLimits::default()), Err(Error::Read { .. })));
    assert!(matches!(read(folder.path(), ReadLimits::default()), Err(Error::Read { .. })));
}

/// One byte at a time: an error or another picture, never a panic and never more memory than allowed.
#[test]
fn broken_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("broken.png");
    let picture = tonemapped(&beauty(9, 5, |x, y| [x as f32 / 9.0, y as f32 / 5.0, 0.3, 1.0]), &PngOptions::default()).unwrap();
    let good = encode(&picture, &Metadata::new());
    for at in 0..good.len() {
        let mut bytes = good.clone();
        bytes[at] ^= 0x55;
        std::fs::write(&path, &bytes).unwrap();
        let _ = read(&path, ReadLimits { bytes: 1 << 20 });
    }
}
