//! Pictures from files: told by their content, within limits, each file read once for each use.

use std::collections::HashMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use image::{DynamicImage, ImageFormat, ImageReader};

use crate::files::Files;
use crate::{LoadOptions, Texture};

/// What a texture is for, which decides what its bytes mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Use {
    /// sRGB-coded colours.
    Colour,
    /// Opacity: the alpha channel if there is one in use, else brightness.
    Opacity,
    /// The opacity in the alpha channel of a colour map, and nothing where there is none.
    AlphaOfColour,
    /// Normals or heights, as they are.
    Data,
}

/// All textures of a scene.
#[derive(Clone, Debug)]
pub(crate) struct Textures {
    files: Arc<Files>,
    options: Arc<LoadOptions>,
    loaded: HashMap<(PathBuf, Use), Option<u32>>,
    total_bytes: u64,
    /// Of each texture, those taken included, whether it holds normals.
    normals: Vec<bool>,
    /// Those that were not taken yet: the last ones by number.
    textures: Vec<Texture>,
}

impl Textures {
    pub(crate) fn new(files: Arc<Files>, options: Arc<LoadOptions>) -> Self {
        Self { files, options, loaded: HashMap::new(), total_bytes: 0, normals: Vec::new(), textures: Vec::new() }
    }

    /// Hands over the textures that came since the last time. Numbers go on counting.
    pub(crate) fn take(&mut self) -> Vec<Texture> {
        std::mem::take(&mut self.textures)
    }

    /// Whether a texture that was loaded as [`Use::Data`] holds heights rather than normals.
    pub(crate) fn is_height(&self, number: u32) -> bool {
        self.normals.get(number as usize).is_some_and(|normals| !normals)
    }

    /// The number of a texture that a file in `folder` names; `Err` holds the reason in words, once for each file and use.
    pub(crate) fn load(&mut self, folder: &Path, name: &str, usage: Use) -> Result<Option<u32>, String> {
        let path = self.files.find(folder, name).map_err(|error| error.to_string())?;
        let key = (path, usage);
        if let Some(&known) = self.loaded.get(&key) {
            return Ok(known);
        }
        let made = self.read(&key.0, name, usage);
        self.loaded.insert(key, made.as_ref().ok().copied().flatten());
        made
    }

    fn read(&mut self, path: &Path, name: &str, usage: Use) -> Result<Option<u32>, String> {
        let bytes = self.files.read(path, self.options.max_texture_bytes).map_err(|error| error.to_string())?;
        let picture = decode(&bytes, &self.options).map_err(|message| format!("{name}: {message}"))?;
        let coloured_alpha = picture.color().has_alpha();
        let (width, height) = (picture.width(), picture.height());
        let mut pixels = picture.into_rgba8().into_raw();
        if width == 0 || height == 0 {
            return Err(format!("{name}: the picture has no pixels"));
        }
        let (texels, _) = pixels.as_chunks_mut::<4>();
        let alpha_in_use = coloured_alpha && texels.iter().any(|texel| texel[3] < 255);
        // An alpha channel of zeros is one that a program forgot to fill; taken at its word it would hide the surface.
        let alpha_in_use = alpha_in_use && texels.iter().any(|texel| texel[3] > 0);
        match usage {
            Use::AlphaOfColour if !alpha_in_use => return Ok(None),
            Use::Opacity | Use::AlphaOfColour => {
                for texel in texels {
                    let [red, green, blue, alpha] = texel.map(u32::from);
                    let opacity = if alpha_in_use { alpha } else { (red * 54 + green * 183 + blue * 19) >> 8 };
                    *texel = [opacity as u8; 4];
                }
            }
            Use::Colour | Use::Data => {}
        }
        let (texels, _) = pixels.as_chunks::<4>();
        let has_alpha = texels.iter().any(|texel| texel[3] < 255);
        let texture = Texture { name: name.to_owned(), width, height, pixels, srgb: usage == Use::Colour, has_alpha };
        self.add(texture, usage == Use::Data).map(Some)
    }

    /// The number of a texture that was made elsewhere; `Err` holds the reason in words. `data` is whether it may hold normals or heights.
    pub(crate) fn add(&mut self, texture: Texture, data: bool) -> Result<u32, String> {
        let total = self.total_bytes.saturating_add(texture.pixels.len() as u64);
        let name = &texture.name;
        if total > self.options.max_texture_total_bytes {
            let limit = self.options.max_texture_total_bytes;
            return Err(format!("{name}: with it the textures would take {total} bytes, more than the limit of {limit}"));
        }
        let number = u32::try_from(self.normals.len()).map_err(|_| format!("{name}: too many textures"))?;
        self.total_bytes = total;
        self.normals.push(data && holds_normals(&texture));
        self.textures.push(texture);
        Ok(number)
    }
}

/// Decodes PNG, JPEG, TGA or Radiance HDR.
pub(crate) fn decode(bytes: &[u8], options: &LoadOptions) -> Result<DynamicImage, String> {
    // TGA has no mark of its own: it is what remains. The name's ending is never trusted.
    let format = match image::guess_format(bytes) {
        Ok(format @ (ImageFormat::Png | ImageFormat::Jpeg | ImageFormat::Hdr)) => format,
        Ok(format) => return Err(format!("{format:?} pictures cannot be read; convert to PNG, JPEG or TGA")),
        Err(_) if looks_like_tga(bytes) => ImageFormat::Tga,
        Err(_) => return Err("not a picture that can be read; convert to PNG, JPEG or TGA".to_owned()),
    };
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(options.max_texture_size);
    limits.max_image_height = Some(options.max_texture_size);
    limits.max_alloc = Some(options.max_texture_bytes.saturating_mul(4));
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits);
    reader.decode().map_err(|error| match error {
        image::ImageError::Limits(error) => {
            format!("the picture is too large ({error}); the limit is {0} x {0} pixels", options.max_texture_size)
        }
        error => format!("the picture is damaged ({error})"),
    })
}

/// A TGA header that makes sense: a known kind of picture, a palette only where there is one, a depth that exists.
fn looks_like_tga(bytes: &[u8]) -> bool {
    matches!(bytes, [_, palette @ 0..=1, kind @ (1 | 2 | 3 | 9 | 10 | 11), rest @ ..]
        if (*palette == 1) == matches!(kind, 1 | 9) && matches!(rest.get(13), Some(8 | 15 | 16 | 24 | 32)))
}

/// Whether a bump map holds normals: bluish nearly everywhere, where a map of heights is grey. Exporters write both after `map_bump`.
fn holds_normals(texture: &Texture) -> bool {
    let (texels, _) = texture.pixels.as_chunks::<4>();
    let step = (texels.len() / 4096).max(1);
    let mut seen = 0_u32;
    let mut bluish = 0_u32;
    for [red, green, blue, _] in texels.iter().step_by(step) {
        seen += 1;
        bluish += u32::from(*blue >= 128 && u16::from(*blue) * 2 > u16::from(*red) + u16::from(*green) + 40);
    }
    bluish * 4 > seen * 3
}

/// One part of a colour, from its sRGB code between 0 and 1.
pub(crate) fn srgb_to_linear(value: f32) -> f32 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}
