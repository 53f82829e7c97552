//! Pictures that surround a scene: OpenEXR and Radiance HDR in linear light, and ordinary pictures decoded to it.

use std::io::Cursor;

use exr::prelude::{ReadChannels, ReadLayers, read};

use crate::LoadOptions;
use crate::texture;

/// The greatest value of a pixel that is kept: beyond it sums over a picture overflow.
const MAX_RADIANCE: f32 = 65_504.0;

/// Width, height and pixels from the top row, each part times `scale`; values that are negative or no numbers become 0.
pub(crate) fn decode(bytes: &[u8], scale: f32, options: &LoadOptions) -> Result<(u32, u32, Vec<[f32; 3]>), String> {
    let (width, height, mut pixels) =
        if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) { decode_exr(bytes, options)? } else { decode_other(bytes, options)? };
    if width == 0 || height == 0 || pixels.len() as u64 != u64::from(width) * u64::from(height) {
        return Err("the picture has no pixels".to_owned());
    }
    for value in pixels.as_flattened_mut() {
        let scaled = *value * scale;
        *value = if scaled.is_nan() { 0.0 } else { scaled.clamp(0.0, MAX_RADIANCE) };
    }
    Ok((width, height, pixels))
}

fn decode_other(bytes: &[u8], options: &LoadOptions) -> Result<(u32, u32, Vec<[f32; 3]>), String> {
    let picture = texture::decode(bytes, options)?;
    let (width, height) = (picture.width(), picture.height());
    let linear = matches!(picture, image::DynamicImage::ImageRgb32F(_) | image::DynamicImage::ImageRgba32F(_));
    let mut values = picture.into_rgb32f().into_raw();
    if !linear {
        for value in &mut values {
            *value = texture::srgb_to_linear(*value);
        }
    }
    Ok((width, height, values.as_chunks::<3>().0.to_vec()))
}

fn decode_exr(bytes: &[u8], options: &LoadOptions) -> Result<(u32, u32, Vec<[f32; 3]>), String> {
    let damaged = |error: exr::error::Error| format!("the picture is damaged or of a kind that cannot be read ({error})");
    // The header alone, so that nothing is allocated for a size that is refused.
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(damaged)?;
    let limit = options.max_texture_size as usize;
    for header in &meta.headers {
        let size = header.layer_size;
        let bytes = (size.width() as u64).saturating_mul(size.height() as u64).saturating_mul(12);
        if size.width() > limit || size.height() > limit || bytes > options.max_texture_bytes.saturating_mul(4) {
            return Err(format!("the picture is too large ({} x {}); the limit is {limit} x {limit} pixels", size.width(), size.height()));
        }
    }
    let picture = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| (size.width(), vec![[0.0_f32; 3]; size.area()]),
            |(width, pixels): &mut (usize, Vec<[f32; 3]>), at, (red, green, blue): (f32, f32, f32)| {
                if let Some(pixel) = pixels.get_mut(at.y() * *width + at.x()) {
                    *pixel = [red, green, blue];
                }
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(damaged)?;
    let size = picture.layer_data.size;
    let (width, height) = (u32::try_from(size.width()), u32::try_from(size.height()));
    match (width, height) {
        (Ok(width), Ok(height)) => Ok((width, height, picture.layer_data.channel_data.pixels.1)),
        _ => Err("the picture is too large".to_owned()),
    }
}
