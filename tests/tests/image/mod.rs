//! Picture files: what is written can be read by others, says what was measured, and is there whole or not at all.

mod diff;
mod exr;
mod file;
mod heatmap;
pub mod movie;
mod png;
mod tonemap;

use gridwalk_render::{Layer, LayerData, Layers};

/// Small numbers that look random and are always the same (xorshift, Marsaglia 2003).
pub struct Random(pub u64);

impl Random {
    pub fn next_u32(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 32) as u32
    }

    pub fn unit(&mut self) -> f32 {
        self.next_u32() as f32 / u32::MAX as f32
    }
}

pub fn layer(name: &str, prefix: &str, channels: &[&str], data: LayerData) -> Layer {
    Layer { name: name.to_owned(), prefix: prefix.to_owned(), channels: channels.iter().map(|c| (*c).to_owned()).collect(), data }
}

/// A beauty layer and nothing else.
pub fn beauty(width: u32, height: u32, pixel: impl Fn(u32, u32) -> [f32; 4]) -> Layers {
    let mut layers = Layers::new(width, height);
    let values = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).flat_map(|(x, y)| pixel(x, y)).collect();
    layers.push(layer("beauty", "", &["R", "G", "B", "A"], LayerData::Float(values))).unwrap();
    layers
}

/// All the layers of the renderer, with values that tell every pixel and channel from every other.
pub fn all_layers(width: u32, height: u32) -> Layers {
    let pixels = (width * height) as usize;
    let floats = |channels: usize, base: f32| LayerData::Float((0..pixels * channels).map(|i| base + i as f32 * 0.25).collect());
    let uints = |channels: usize, base: u32| LayerData::Uint((0..pixels * channels).map(|i| base + i as u32).collect());
    let mut layers = Layers::new(width, height);
    for layer in [
        layer("beauty", "", &["R", "G", "B", "A"], floats(4, 0.5)),
        layer("Z", "", &["Z"], floats(1, 1000.0)),
        layer("N", "N", &["X", "Y", "Z"], floats(3, -2000.0)),
        layer("Ng", "Ng", &["X", "Y", "Z"], floats(3, 3000.0)),
        layer("P", "P", &["X", "Y", "Z"], floats(3, -4000.0)),
        layer("albedo", "albedo", &["R", "G", "B"], floats(3, 5000.0)),
        layer("uv", "uv", &["U", "V"], floats(2, 6000.0)),
        layer("id", "id", &["prim", "mesh", "material"], uints(3, 4_294_000_000)),
        layer("debug", "debug", &["steps", "tests", "cells"], uints(3, 16_777_217)),
    ] {
        layers.push(layer).unwrap();
    }
    layers
}
