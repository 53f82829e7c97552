use gridwalk_render::image::{Error, diff};
use gridwalk_render::{LayerData, Layers};

use super::{Random, all_layers, beauty, layer};

fn noise(seed: u64, strength: f32) -> Layers {
    let mut random = Random(seed);
    let offsets: Vec<f32> = (0..64 * 48).map(|_| strength * (random.unit() - 0.5)).collect();
    beauty(64, 48, |x, y| {
        let value = 0.5 + 0.3 * ((x as f32) / 5.0).sin() * ((y as f32) / 7.0).cos() + offsets[(y * 64 + x) as usize];
        [value, value, value, 1.0]
    })
}

#[test]
fn equal_pictures_are_equal() {
    let picture = all_layers(20, 13);
    let difference = diff(&picture, &picture).unwrap();
    assert_eq!((difference.mean_square(), difference.maximum()), (0.0, 0.0));
    assert!((difference.ssim() - 1.0).abs() < 1e-12);
    assert!(difference.unmatched.is_empty());
    assert!(difference.layers.iter().all(|layer| layer.pixels == 0 && layer.at.is_none()));
}

/// The negative control: one value of one pixel of one layer.
#[test]
fn one_value_is_seen_in_each_layer() {
    let picture = all_layers(20, 13);
    for name in ["beauty", "Z", "N", "Ng", "P", "albedo", "uv", "id", "debug"] {
        let mut other = Layers::new(20, 13);
        for layer in picture.iter() {
            let mut layer = layer.clone();
            if layer.name == name {
                let at = (7 * 20 + 3) * layer.channels.len();
                match &mut layer.data {
                    LayerData::Float(values) => values[at] += 0.5,
                    LayerData::Uint(values) => values[at] -= 1,
                }
            }
            other.push(layer).unwrap();
        }
        let difference = diff(&picture, &other).unwrap();
        let changed: Vec<_> = difference.layers.iter().filter(|layer| layer.pixels > 0).collect();
        assert_eq!(changed.len(), 1, "{name}");
        assert_eq!((changed[0].name.as_str(), changed[0].pixels, changed[0].at), (name, 1, Some((3, 7))));
        assert!(difference.maximum() >= 0.5 && difference.mean_square() > 0.0);
    }
}

#[test]
fn numbers_are_what_they_are_called() {
    let a = beauty(16, 16, |_, _| [0.25, 0.5, 0.75, 1.0]);
    let b = beauty(16, 16, |x, y| if (x, y) == (5, 9) { [0.25, 0.0, 0.75, 1.0] } else { [0.25, 0.5, 0.75, 1.0] });
    let difference = diff(&a, &b).unwrap();
    assert_eq!(difference.maximum(), 0.5);
    assert!((difference.mean_square() - 0.25 / (16.0 * 16.0 * 4.0)).abs() < 1e-12);
    assert!(difference.ssim() < 0.99);
}

#[test]
fn similarity_falls_with_noise() {
    let clean = noise(11, 0.0);
    let mut last = 1.0;
    for strength in [0.02, 0.05, 0.1, 0.3, 1.0] {
        let ssim = diff(&clean, &noise(11, strength)).unwrap().ssim();
        assert!(ssim < last, "seed 11, noise {strength}: {ssim} after {last}");
        last = ssim;
    }
    assert!(last < 0.6, "{last}");
    // A constant offset keeps the structure: less is lost than by noise of the same mean square.
    let offset = beauty(64, 48, |x, y| {
        let value = 0.55 + 0.3 * ((x as f32) / 5.0).sin() * ((y as f32) / 7.0).cos();
        [value, value, value, 1.0]
    });
    let strength = (12.0_f32 * 0.05 * 0.05).sqrt();
    assert!(diff(&clean, &offset).unwrap().ssim() > diff(&clean, &noise(11, strength)).unwrap().ssim());
}

#[test]
fn values_that_are_no_number() {
    let nan = beauty(12, 12, |_, _| [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1.0]);
    assert_eq!(diff(&nan, &nan).unwrap().maximum(), 0.0);
    let number = beauty(12, 12, |_, _| [0.0, f32::INFINITY, f32::NEG_INFINITY, 1.0]);
    let difference = diff(&nan, &number).unwrap();
    assert_eq!((difference.maximum(), difference.mean_square()), (f64::INFINITY, f64::INFINITY));
    let flipped = beauty(12, 12, |_, _| [f32::NAN, f32::NEG_INFINITY, f32::INFINITY, 1.0]);
    assert_eq!(diff(&nan, &flipped).unwrap().maximum(), f64::INFINITY);
}

#[test]
fn what_cannot_be_compared_is_said() {
    let a = all_layers(4, 4);
    assert!(matches!(diff(&a, &all_layers(4, 5)), Err(Error::SizeMismatch { .. })));
    let mut other = Layers::new(4, 4);
    other.push(layer("other", "other", &["R"], LayerData::Float(vec![0.0; 16]))).unwrap();
    let error = diff(&a, &other).unwrap_err();
    assert!(matches!(error, Error::NoCommonLayer { .. }), "{error}");
    let mut some = Layers::new(4, 4);
    some.push(a.get("Z").unwrap().clone()).unwrap();
    some.push(layer("id", "id", &["prim", "mesh", "material"], LayerData::Float(vec![0.0; 48]))).unwrap();
    some.push(layer("extra", "extra", &["R"], LayerData::Float(vec![0.0; 16]))).unwrap();
    let difference = diff(&a, &some).unwrap();
    assert_eq!(difference.layers.len(), 1);
    for name in ["beauty", "id", "extra"] {
        assert!(difference.unmatched.iter().any(|unmatched| unmatched == name), "{name}: {:?}", difference.unmatched);
    }
}

/// Smaller than the window, and thinner.
#[test]
fn small_pictures_have_a_similarity() {
    for (width, height) in [(1, 1), (10, 1), (1, 40), (11, 11), (12, 3)] {
        let a = beauty(width, height, |x, y| [x as f32 / 8.0, y as f32 / 8.0, 0.5, 1.0]);
        let b = beauty(width, height, |x, y| [y as f32 / 8.0 + 0.2, x as f32 / 8.0, 0.0, 1.0]);
        assert!((diff(&a, &a).unwrap().ssim() - 1.0).abs() < 1e-12);
        let ssim = diff(&a, &b).unwrap().ssim();
        assert!(ssim.is_finite() && ssim < 1.0, "{width} x {height}: {ssim}");
    }
}
