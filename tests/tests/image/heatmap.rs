use gridwalk_render::image::{Error, heatmap, ramp, srgb_decode};
use gridwalk_render::{LayerData, Layers};

use super::{all_layers, layer};

fn counts(width: u32, height: u32, values: Vec<u32>) -> Layers {
    let mut layers = Layers::new(width, height);
    layers.push(layer("debug", "debug", &["steps"], LayerData::Uint(values))).unwrap();
    layers
}

/// Lightness in Oklab (Ottosson 2020), from the other side than the program's.
fn lightness(color: [u8; 3]) -> f64 {
    let [r, g, b] = color.map(|value| f64::from(srgb_decode(f32::from(value) / 255.0)));
    let l = 0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b;
    let m = 0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b;
    let s = 0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b;
    0.2104542553 * l.cbrt() + 0.7936177850 * m.cbrt() - 0.0040720468 * s.cbrt()
}

#[test]
fn ramp_rises_by_equal_steps() {
    let ramp = ramp();
    for (i, color) in ramp.iter().enumerate() {
        let expected = 0.16 + 0.80 * i as f64 / 255.0;
        // Eight bits are coarse in the dark.
        assert!((lightness(*color) - expected).abs() < 0.02, "colour {i}: {color:?} has lightness {}", lightness(*color));
    }
    assert!(ramp.windows(2).all(|pair| pair[0] != pair[1]));
}

#[test]
fn colours_follow_the_counts() {
    let map = heatmap(&counts(40, 2, (0..80).map(|i| 10 + i * 3).collect()), "steps").unwrap();
    assert_eq!((map.min, map.max, map.mean), (10.0, 247.0, 128.5));
    let row = map.picture.width as usize * 3;
    let at = |x: usize, y: usize| {
        let at = y * row + x * 3;
        [map.picture.data[at], map.picture.data[at + 1], map.picture.data[at + 2]]
    };
    assert_eq!(at(0, 0), ramp()[0]);
    assert_eq!(at(39, 1), ramp()[255]);
    let seen: Vec<f64> = (0..80).map(|i| lightness(at(i % 40, i / 40))).collect();
    assert!(seen.windows(2).all(|pair| pair[0] < pair[1]), "{seen:?}");
    assert!(map.picture.height > 2, "there is a legend");
    let legend = &map.picture.data[2 * row..];
    assert!(legend.chunks_exact(3).filter(|pixel| *pixel == [255; 3]).count() > 50, "with numbers in it");
}

#[test]
fn legends_tell_numbers_apart() {
    let legend =
        |max: u32| heatmap(&counts(200, 1, (0..200).map(|i| if i == 0 { 0 } else { max }).collect()), "steps").unwrap().picture.data;
    for max in 1..10 {
        assert_ne!(legend(max)[600..], legend(max + 1)[600..], "{max}");
    }
}

#[test]
fn every_size_has_room() {
    for (width, height) in [(1, 1), (3, 2), (100, 1), (799, 3), (1920, 2)] {
        let pixels = width * height;
        for values in [vec![0; pixels], vec![u32::MAX; pixels], (0..pixels as u32).collect()] {
            let map = heatmap(&counts(width as u32, height as u32, values), "steps").unwrap();
            assert_eq!(map.picture.data.len(), map.picture.width as usize * map.picture.height as usize * 3);
            assert!(map.picture.width as usize >= width);
        }
    }
}

#[test]
fn all_three_or_an_error() {
    let layers = all_layers(8, 8);
    for name in ["steps", "tests", "cells"] {
        assert!(heatmap(&layers, name).is_ok());
    }
    assert!(matches!(heatmap(&layers, "time"), Err(Error::Layer { name, .. }) if name == "debug.time"));
    let mut nan = Layers::new(1, 1);
    nan.push(layer("debug", "debug", &["steps"], LayerData::Float(vec![f32::NAN]))).unwrap();
    assert!(heatmap(&nan, "steps").is_err());
}
