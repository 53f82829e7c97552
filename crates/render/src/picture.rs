//! A picture, put together from the batches of its pixels.

use crate::{
    Aov, Crop, Layer, LayerData, Layers, RenderSettings, Result,
    layout::{Film, FirstHitRecord},
};

/// A picture as it is put together from batches.
pub(crate) struct Picture {
    width: u32,
    height: u32,
    scale: f32,
    transparent: bool,
    beauty: Vec<f32>,
    layers: Vec<(Aov, LayerData)>,
}

impl Picture {
    pub(crate) fn new(crop: Crop, settings: &RenderSettings) -> Picture {
        let pixels = crop.width as usize * crop.height as usize;
        let mut aovs = settings.aovs.clone();
        aovs.sort_unstable();
        aovs.dedup();
        let layers = aovs
            .into_iter()
            .map(|aov| {
                let values = pixels * aov.channels().1.len();
                let data =
                    if aov == Aov::Id || aov.is_count() { LayerData::Uint(vec![0; values]) } else { LayerData::Float(vec![0.0; values]) };
                (aov, data)
            })
            .collect();
        Picture {
            width: crop.width,
            height: crop.height,
            scale: 1.0 / settings.spp as f32,
            transparent: settings.transparent,
            beauty: vec![0.0; pixels * 4],
            layers,
        }
    }

    pub(crate) fn add_film(&mut self, first: u32, film: &[Film]) {
        for (place, pixel) in (first..).zip(film) {
            let at = tiled_pixel(place, self.width, self.height) * 4;
            let alpha = if self.transparent { pixel.coverage * self.scale } else { 1.0 };
            let [r, g, b] = pixel.radiance.map(|value| value * self.scale);
            if let Some(target) = self.beauty.get_mut(at..at + 4) {
                target.copy_from_slice(&[r, g, b, alpha]);
            }
        }
    }

    pub(crate) fn add_records(&mut self, first: u32, records: &[FirstHitRecord], counters: &[[u32; 4]]) {
        let (width, height) = (self.width, self.height);
        for (aov, data) in &mut self.layers {
            let channels = aov.channels().1.len();
            for (i, record) in records.iter().enumerate() {
                let at = tiled_pixel(first + i as u32, width, height) * channels;
                let counts = counters.get(i).copied().unwrap_or_default();
                let uv = [record.u, record.v];
                let ids = [record.primitive, record.mesh, record.material];
                match data {
                    LayerData::Float(values) => {
                        let source: &[f32] = match aov {
                            Aov::Depth => std::slice::from_ref(&record.distance),
                            Aov::Normal => &record.normal,
                            Aov::GeometricNormal => &record.geometric_normal,
                            Aov::Position => &record.position,
                            Aov::Albedo => &record.albedo,
                            _ => &uv,
                        };
                        if let Some(target) = values.get_mut(at..at + channels) {
                            target.copy_from_slice(source);
                        }
                    }
                    LayerData::Uint(values) => {
                        let source: &[u32] = match aov {
                            Aov::Steps => &counts[..1],
                            Aov::Tests => &counts[1..2],
                            Aov::Cells => &counts[2..3],
                            _ => &ids,
                        };
                        if let Some(target) = values.get_mut(at..at + channels) {
                            target.copy_from_slice(source);
                        }
                    }
                }
            }
        }
    }

    pub(crate) fn finish(self) -> Result<Layers> {
        let mut layers = Layers::new(self.width, self.height);
        let names = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
        layers.push(Layer {
            name: "beauty".to_owned(),
            prefix: String::new(),
            channels: names(&["R", "G", "B", "A"]),
            data: LayerData::Float(self.beauty),
        })?;
        for (aov, data) in self.layers {
            let (prefix, channels) = aov.channels();
            layers.push(Layer { name: aov.layer().to_owned(), prefix: prefix.to_owned(), channels: names(channels), data })?;
        }
        Ok(layers)
    }
}

/// Index of the pixel at a place in the order of tiles: the host's twin of `tiled_pixel` in `camera_rays`.
fn tiled_pixel(place: u32, width: u32, height: u32) -> usize {
    const TILE: u32 = 8;
    let band = place / (TILE * width);
    let place = place - band * TILE * width;
    let rows = TILE.min(height - band * TILE);
    let column = place / (TILE * rows);
    let place = place - column * TILE * rows;
    let columns = TILE.min(width - column * TILE);
    let inside = if (columns, rows) == (TILE, TILE) {
        // Bits 0, 2, 4 and 1, 3, 5.
        [place, place >> 1].map(|bits| (bits & 1) | ((bits >> 1) & 2) | ((bits >> 2) & 4))
    } else {
        [place % columns, place / columns]
    };
    let (x, y) = (column * TILE + inside[0], band * TILE + inside[1]);
    y as usize * width as usize + x as usize
}

#[cfg(test)]
mod tests {
    use super::tiled_pixel;

    #[test]
    fn every_pixel_has_one_place() {
        for (width, height) in [(1, 1), (8, 8), (7, 9), (64, 3), (3, 64), (17, 23), (160, 120)] {
            let mut places: Vec<usize> = (0..width * height).map(|place| tiled_pixel(place, width, height)).collect();
            if width >= 16 && height >= 8 {
                assert!(places[..64].iter().all(|pixel| pixel % width as usize <= 7 && pixel / width as usize <= 7), "a tile");
                let (row, square) = (width as usize, &places[..4]);
                assert_eq!(square, [0, 1, row, row + 1], "Morton order inside of it");
            }
            places.sort_unstable();
            assert!(places.into_iter().eq(0..(width * height) as usize), "{width} x {height}");
        }
    }
}
