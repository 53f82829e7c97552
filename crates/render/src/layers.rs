//! Pictures in memory: named layers of one size, as the renderer makes them and the image files hold them.

use crate::{Error, Result};

/// What the pixels of a layer are made of. Pixels lie row by row from the top left, the channels of a pixel side by side.
#[derive(Clone, Debug, PartialEq)]
pub enum LayerData {
    /// Linear values.
    Float(Vec<f32>),
    /// Identifiers and counts: never filtered.
    Uint(Vec<u32>),
}

impl LayerData {
    /// Number of values: pixels times channels.
    pub fn len(&self) -> usize {
        match self {
            LayerData::Float(values) => values.len(),
            LayerData::Uint(values) => values.len(),
        }
    }

    /// Whether there is no value.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// One layer of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// What the layer is called in options and statistics: `beauty`, `Z`, `N`, `id`, ...
    pub name: String,
    /// What stands before the dot in the channel names of an EXR file; empty for channels without a prefix (`R`, `G`, `B`, `A`, `Z`).
    pub prefix: String,
    /// Channel names without the prefix, in the order of the values of a pixel.
    pub channels: Vec<String>,
    /// The pixels.
    pub data: LayerData,
}

impl Layer {
    /// Channel names as an EXR file holds them, with the prefix.
    pub fn channel_names(&self) -> impl Iterator<Item = String> + '_ {
        self.channels.iter().map(|channel| if self.prefix.is_empty() { channel.clone() } else { format!("{}.{channel}", self.prefix) })
    }

    /// The values, if they are floats.
    pub fn floats(&self) -> Option<&[f32]> {
        match &self.data {
            LayerData::Float(values) => Some(values),
            LayerData::Uint(_) => None,
        }
    }

    /// The values, if they are identifiers or counts.
    pub fn uints(&self) -> Option<&[u32]> {
        match &self.data {
            LayerData::Float(_) => None,
            LayerData::Uint(values) => Some(values),
        }
    }
}

/// The layers of one picture, all of one size.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    width: u32,
    height: u32,
    layers: Vec<Layer>,
}

impl Layers {
    /// A picture without layers of `width` by `height` pixels.
    pub const fn new(width: u32, height: u32) -> Layers {
        Layers { width, height, layers: Vec::new() }
    }

    /// Pixels in a row.
    pub const fn width(&self) -> u32 {
        self.width
    }

    /// Number of rows.
    pub const fn height(&self) -> u32 {
        self.height
    }

    /// Number of pixels.
    pub const fn pixel_count(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Adds a layer.
    ///
    /// # Errors
    /// [`Error::Layer`] when the number of values is not that of the pixels times the channels, or the name is taken.
    pub fn push(&mut self, layer: Layer) -> Result<()> {
        if layer.channels.is_empty() || self.pixel_count().checked_mul(layer.channels.len()) != Some(layer.data.len()) {
            return Err(Error::Layer {
                name: layer.name,
                reason: format!(
                    "{} values for {} x {} pixels of {} channels",
                    layer.data.len(),
                    self.width,
                    self.height,
                    layer.channels.len()
                ),
            });
        }
        if self.get(&layer.name).is_some() {
            return Err(Error::Layer { name: layer.name, reason: "two layers of this name".to_owned() });
        }
        self.layers.push(layer);
        Ok(())
    }

    /// The layer of this name.
    pub fn get(&self, name: &str) -> Option<&Layer> {
        self.layers.iter().find(|layer| layer.name == name)
    }

    /// All layers, in the order in which they were added.
    pub fn iter(&self) -> impl Iterator<Item = &Layer> {
        self.layers.iter()
    }
}
