use std::io::Cursor;

use exr::prelude::{FlatSamples, ReadChannels, ReadLayers};
use gridwalk_render::image::{Error, Metadata, MetadataValue, ReadLimits, diff, encode_exr, read};
use gridwalk_render::{LayerData, Layers};

use super::{Random, all_layers, layer};

fn encode(layers: &Layers, metadata: &Metadata) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    encode_exr(&mut bytes, layers, metadata).unwrap();
    bytes.into_inner()
}

fn decode(bytes: &[u8]) -> exr::image::FlatImage {
    let read = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
    read.from_buffered(Cursor::new(bytes)).unwrap()
}

/// Names, kinds and values as another reader sees them.
#[test]
fn channels_as_documented() {
    let layers = all_layers(5, 3);
    let image = decode(&encode(&layers, &Metadata::new()));
    assert_eq!(image.layer_data.len(), 1, "one part");
    let part = &image.layer_data[0];
    let names: Vec<String> = part.channel_data.list.iter().map(|channel| channel.name.to_string()).collect();
    assert_eq!(
        names,
        [
            "A",
            "B",
            "G",
            "N.X",
            "N.Y",
            "N.Z",
            "Ng.X",
            "Ng.Y",
            "Ng.Z",
            "P.X",
            "P.Y",
            "P.Z",
            "R",
            "Z",
            "albedo.B",
            "albedo.G",
            "albedo.R",
            "debug.cells",
            "debug.steps",
            "debug.tests",
            "id.material",
            "id.mesh",
            "id.prim",
            "uv.U",
            "uv.V"
        ]
    );
    for channel in &part.channel_data.list {
        let name = channel.name.to_string();
        let (layer, index) =
            layers.iter().find_map(|layer| layer.channel_names().position(|channel| channel == name).map(|index| (layer, index))).unwrap();
        let stride = layer.channels.len();
        match (&channel.sample_data, &layer.data) {
            (FlatSamples::F32(read), LayerData::Float(written)) => {
                assert!(read.iter().eq(written.iter().skip(index).step_by(stride)), "{name}");
            }
            (FlatSamples::U32(read), LayerData::Uint(written)) => {
                assert!(read.iter().eq(written.iter().skip(index).step_by(stride)), "{name}");
            }
            _ => panic!("{name} changed its kind"),
        }
    }
}

#[test]
fn header_says_where_it_comes_from() {
    let matrix: [f32; 16] = std::array::from_fn(|i| i as f32);
    let metadata = Metadata::new()
        .with("software", MetadataValue::Text("gridwalk 1.2.3".to_owned()))
        .with("worldToCamera", MetadataValue::Matrix(matrix))
        .with("worldToNDC", MetadataValue::Matrix(matrix.map(|v| v * 2.0)))
        .with("device", MetadataValue::Text("llvmpipe".to_owned()))
        .with("spp", MetadataValue::Int(4))
        .with("density", MetadataValue::Float(2.5));
    let bytes = encode(&all_layers(2, 2), &metadata);
    assert_eq!(bytes, encode(&all_layers(2, 2), &metadata), "the same picture gives the same bytes");
    let image = decode(&bytes);
    let attributes = &image.layer_data[0].attributes;
    assert_eq!(attributes.software_name.as_ref().unwrap().to_string(), "gridwalk 1.2.3");
    assert_eq!(attributes.world_to_camera, Some(matrix));
    assert_eq!(attributes.world_to_normalized_device.unwrap()[3], 6.0);
    assert_eq!(attributes.comments.as_ref().unwrap().to_string(), "device: llvmpipe\nspp: 4\ndensity: 2.5\n");
    assert_eq!(image.attributes.chromaticities.unwrap().red.0, 0.64);
}

#[test]
fn every_bit_survives() {
    let seed = 0x9e37_79b9_7f4a_7c15;
    let mut random = Random(seed);
    let floats: Vec<f32> = (0..33 * 17).map(|_| f32::from_bits(random.next_u32())).collect();
    let uints: Vec<u32> = (0..33 * 17).map(|_| random.next_u32()).collect();
    let mut layers = Layers::new(33, 17);
    layers.push(layer("Z", "", &["Z"], LayerData::Float(floats.clone()))).unwrap();
    layers.push(layer("id", "id", &["prim"], LayerData::Uint(uints.clone()))).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    std::fs::write(&path, encode(&layers, &Metadata::new())).unwrap();
    let back = read(&path, ReadLimits::default()).unwrap();
    let got: Vec<u32> = back.get("Z").unwrap().floats().unwrap().iter().map(|value| value.to_bits()).collect();
    assert_eq!(got, floats.iter().map(|value| value.to_bits()).collect::<Vec<_>>(), "seed {seed:#x}");
    assert_eq!(back.get("id").unwrap().uints().unwrap(), uints, "seed {seed:#x}");
}

#[test]
fn reads_back_as_the_same_layers() {
    let layers = all_layers(7, 4);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    std::fs::write(&path, encode(&layers, &Metadata::new())).unwrap();
    let back = read(&path, ReadLimits::default()).unwrap();
    assert_eq!(back.iter().count(), layers.iter().count());
    for name in ["beauty", "Z", "N", "Ng", "P", "albedo", "uv"] {
        assert_eq!(back.get(name), layers.get(name));
    }
    let difference = diff(&back, &back).unwrap();
    assert_eq!(difference.maximum(), 0.0);
}

#[test]
fn broken_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("broken.exr");
    let bytes = encode(&all_layers(40, 30), &Metadata::new());
    for length in (0..bytes.len()).step_by(97) {
        std::fs::write(&path, &bytes[..length]).unwrap();
        let error = read(&path, ReadLimits::default()).expect_err("a cut file");
        assert!(error.to_string().contains("broken.exr"), "{error}");
    }
    // One byte at a time: an error or another picture, never a panic and never more memory than allowed.
    for at in 0..600.min(bytes.len()) {
        let mut bytes = bytes.clone();
        bytes[at] ^= 0x55;
        std::fs::write(&path, &bytes).unwrap();
        let _ = read(&path, ReadLimits { bytes: 1 << 20 });
    }
    std::fs::write(&path, &bytes).unwrap();
    assert!(matches!(read(&path, ReadLimits { bytes: 10_000 }), Err(Error::TooLarge { .. })));
}

#[test]
fn two_channels_of_one_name_are_refused() {
    let mut layers = Layers::new(1, 1);
    layers.push(layer("a", "", &["Z"], LayerData::Float(vec![0.0]))).unwrap();
    layers.push(layer("b", "", &["Z"], LayerData::Float(vec![0.0]))).unwrap();
    let error = encode_exr(Cursor::new(Vec::new()), &layers, &Metadata::new()).unwrap_err();
    assert!(error.to_string().contains("two channels are called Z"), "{error}");
    assert!(encode_exr(Cursor::new(Vec::new()), &Layers::new(3, 3), &Metadata::new()).is_err());
    assert!(encode_exr(Cursor::new(Vec::new()), &Layers::new(0, 3), &Metadata::new()).is_err());
}
