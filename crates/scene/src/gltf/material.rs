//! PBR materials, brought to diffuse, Blinn-Phong and mirror.
//!
//! With base colour `c`, metallic `m`, roughness `r` and the reflectance `f` of a dielectric at a right angle (0.04):
//! - mirror weight: `c m g` with `g = (1 - r)²`; from 0.05 on the surface is a mirror (`illumination` 3), and dielectric parts reflect
//!   `f (1 - m) g` too. A rough metal mirrors nothing sharp: what `g` takes away it scatters as a diffuse surface.
//! - diffuse: `c (1 - m g)`.
//! - highlights of a surface that is no mirror: `(c m g + f (1 - m)) (n + 8) / 8`, at most 1, which gives the lobe the energy of the
//!   reflectance whatever its width.
//! - exponent: `n = 2 / α² - 2` with `α = r²`, which has the width of that lobe (Walter et al. 2007).
//!
//! Where a texture tells metallic from point to point, diffuse and specular textures are made of it and the base colour.

use std::collections::HashMap;
use std::sync::OnceLock;

use gltf::json;
use gltf::json::deserialize;
use gltf::json::extensions::texture::TextureTransform;
use gltf::json::material::AlphaMode;
use gltf::json::texture::{MagFilter, WrappingMode};
use gltf::json::validation::Checked;

use super::document::{Document, absent, named};
use crate::assets::Assets;
use crate::texture::decode;
use crate::{Error, Material, Texture};

/// Mirror weights below this are highlights only.
const LEAST_MIRROR: f32 = 0.05;
/// A lobe narrower than this is seen by no pixel.
const MOST_SHININESS: f32 = 1e5;

/// Which texture coordinates the maps of a material are looked up by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Coordinates {
    pub(super) set: u32,
    /// `KHR_texture_transform`: offset, rotation in radians, scale.
    pub(super) offset: [f32; 2],
    pub(super) rotation: f32,
    pub(super) scale: [f32; 2],
}

/// A material of the scene, and what meshes must know of it.
#[derive(Clone, Debug)]
pub(super) struct Made {
    /// In the scene's table.
    pub(super) number: u32,
    pub(super) name: String,
    /// `None` without maps.
    pub(super) coordinates: Option<Coordinates>,
    /// Whether a map ends at its edges instead of being repeated.
    pub(super) clamped: bool,
    pub(super) alpha: AlphaMode,
}

/// Makes the materials that meshes ask for, each once.
pub(super) struct Materials<'a> {
    document: &'a Document,
    assets: &'a mut Assets,
    made: HashMap<Option<usize>, Made>,
    /// By what they are made of.
    textures: HashMap<String, Option<u32>>,
}

/// A reference to a texture out of a material.
#[derive(Clone, Copy)]
struct Slot {
    texture: usize,
    coordinates: Coordinates,
}

/// A decoded image, RGBA, 8 bits each.
struct Picture {
    name: String,
    width: u32,
    height: u32,
    texels: Vec<[u8; 4]>,
}

impl<'a> Materials<'a> {
    pub(super) fn new(document: &'a Document, assets: &'a mut Assets) -> Self {
        Self { document, assets, made: HashMap::new(), textures: HashMap::new() }
    }

    /// The material of a primitive; `None` is the one of surfaces that name none.
    pub(super) fn get(&mut self, at: Option<usize>) -> Result<Made, Error> {
        if let Some(made) = self.made.get(&at) {
            return Ok(made.clone());
        }
        let document = self.document;
        let absent_default = json::Material::default();
        let source = match at {
            None => &absent_default,
            Some(at) => {
                document.root.materials.get(at).ok_or_else(|| document.error(absent("material", at, document.root.materials.len())))?
            }
        };
        let made = self.make(at, source);
        self.made.insert(at, made.clone());
        Ok(made)
    }

    fn make(&mut self, at: Option<usize>, source: &json::Material) -> Made {
        let name = match (at, source.name.as_deref()) {
            (_, Some(name)) if !name.is_empty() => name.to_owned(),
            (Some(at), _) => format!("material {at}"),
            (None, _) => "glTF default".to_owned(),
        };
        let place = at.map_or_else(|| name.clone(), |at| named("material", at, source.name.as_deref()));
        let extensions = source.extensions.as_ref();
        let pbr = &source.pbr_metallic_roughness;
        let unlit = extensions.is_some_and(|extensions| extensions.unlit.is_some());

        let mut coordinates = None;
        let mut clamped = false;
        let mut slot = |kind: &str, info: Option<Slot>| self.usable(&place, kind, info?, &mut coordinates, &mut clamped);
        let base_slot = slot("baseColorTexture", pbr.base_color_texture.as_ref().map(slot_of));
        let rough_slot = slot("metallicRoughnessTexture", pbr.metallic_roughness_texture.as_ref().filter(|_| !unlit).map(slot_of));
        let emission_slot = slot("emissiveTexture", source.emissive_texture.as_ref().filter(|_| !unlit).map(slot_of));
        let normal = source.normal_texture.as_ref().filter(|_| !unlit);
        let normal_slot = slot(
            "normalTexture",
            normal.map(|normal| {
                let transform = normal.extensions.as_ref().and_then(|extensions| extensions.others.get("KHR_texture_transform"));
                let transform: Option<TextureTransform> = transform.and_then(|value| deserialize::from_value(value.clone()).ok());
                Slot { texture: normal.index.value(), coordinates: coordinates_of(normal.tex_coord, transform.as_ref()) }
            }),
        );
        if source.occlusion_texture.is_some() {
            self.document.warn("occlusion textures are not used: ambient light reaches every point alike");
        }

        let [red, green, blue, alpha] = pbr.base_color_factor.0.map(share);
        let colour = [red, green, blue];
        let (metallic, roughness) = (share(pbr.metallic_factor.0), share(pbr.roughness_factor.0));
        let index_of_refraction = extensions.and_then(|extensions| extensions.ior.as_ref()).map_or(1.5, |ior| ior.ior.0);
        let index_of_refraction = if index_of_refraction.is_finite() && index_of_refraction >= 0.0 { index_of_refraction } else { 1.5 };
        let mut reflectance = [((index_of_refraction - 1.0) / (index_of_refraction + 1.0)).powi(2); 3];
        if let Some(specular) = extensions.and_then(|extensions| extensions.specular.as_ref()) {
            if specular.specular_texture.is_some() || specular.specular_color_texture.is_some() {
                self.document.warn(format!("{place}: the textures of KHR_materials_specular are not used"));
            }
            let factor = share(specular.specular_factor.0);
            reflectance = std::array::from_fn(|at| share(reflectance[at] * positive(specular.specular_color_factor.0[at])) * factor);
        }
        let strength = extensions
            .and_then(|extensions| extensions.emissive_strength.as_ref())
            .map_or(1.0, |strength| positive(strength.emissive_strength.0));

        let mut material = Material { name, index_of_refraction, ..Material::default() };
        let base = base_slot.and_then(|slot| self.image_of(&place, slot));
        if unlit {
            let map = base.and_then(|image| self.plain(image, true));
            (material.emission, material.emission_map) = (colour, map);
            (material.diffuse, material.illumination, material.unlit) = ([0.0; 3], 0, true);
        } else {
            let rough = rough_slot.and_then(|slot| self.image_of(&place, slot));
            self.reflect(&mut material, Surface { colour, metallic, roughness, reflectance }, base, rough);
            material.emission = source.emissive_factor.0.map(|value| positive(value) * strength);
            if material.emission != [0.0; 3] {
                material.emission_map =
                    emission_slot.and_then(|slot| self.image_of(&place, slot)).and_then(|image| self.plain(image, true));
            }
            material.normal_map = normal_slot
                .and_then(|slot| self.image_of(&place, slot))
                .and_then(|image| self.normals(image, normal.map_or(1.0, |normal| normal.scale)));
        }

        let mode = match source.alpha_mode {
            Checked::Valid(mode) => mode,
            Checked::Invalid => {
                self.document.warn(format!("{place}: the alphaMode is none of OPAQUE, MASK, BLEND; it counts as OPAQUE"));
                AlphaMode::Opaque
            }
        };
        match mode {
            AlphaMode::Opaque => {}
            AlphaMode::Mask => {
                let cutoff = source.alpha_cutoff.map_or(0.5, |cutoff| positive(cutoff.0));
                material.opacity_map = self.mask(base, alpha, cutoff);
            }
            AlphaMode::Blend => {
                (material.blend, material.opacity) = (true, alpha);
                material.opacity_map = base.and_then(|image| self.opacity(image));
            }
        }
        Made { name: material.name.clone(), number: self.assets.material(material), coordinates, clamped, alpha: mode }
    }

    /// The slot, if its texture is there and looked up as those before it: meshes have one set of texture coordinates.
    fn usable(&self, place: &str, kind: &str, slot: Slot, first: &mut Option<Coordinates>, clamped: &mut bool) -> Option<Slot> {
        let root = &self.document.root;
        let Some(texture) = root.textures.get(slot.texture) else {
            self.document.warn(format!("{place}: {}, so there is no {kind}", absent("texture", slot.texture, root.textures.len())));
            return None;
        };
        let known = *first.get_or_insert(slot.coordinates);
        if known != slot.coordinates {
            self.document.warn(format!("{place}: the {kind} is looked up otherwise than the texture before it, and is not used"));
            return None;
        }
        if let Some(sampler) = texture.sampler.and_then(|sampler| root.samplers.get(sampler.value())) {
            let repeats = |mode| mode == Checked::Valid(WrappingMode::Repeat);
            *clamped |= !repeats(sampler.wrap_s) || !repeats(sampler.wrap_t);
            if sampler.mag_filter == Some(Checked::Valid(MagFilter::Nearest)) {
                self.document.warn("textures are always filtered: NEAREST is not supported");
            }
        }
        Some(slot)
    }

    /// The image of a slot's texture.
    fn image_of(&self, place: &str, slot: Slot) -> Option<usize> {
        let root = &self.document.root;
        let image = root.textures.get(slot.texture)?.source.value();
        if image >= root.images.len() {
            // What an extension puts in its place is told with the extension.
            self.document.warn(format!("{place}: texture {} has no image that can be read", slot.texture));
            return None;
        }
        Some(image)
    }

    /// Diffuse, specular, their maps, and the exponent.
    fn reflect(&mut self, material: &mut Material, surface: Surface, base: Option<usize>, rough: Option<usize>) {
        let rough_map = rough.and_then(|image| self.picture(image));
        let average = match &rough_map {
            Some(map) => {
                let sum: u64 = map.texels.iter().map(|texel| u64::from(texel[1])).sum();
                surface.roughness * (sum as f32 / (255.0 * map.texels.len().max(1) as f32))
            }
            None => surface.roughness,
        };
        let alpha = (average * average).max(1e-4);
        material.shininess = (2.0 / (alpha * alpha) - 2.0).clamp(0.0, MOST_SHININESS);
        let energy = (material.shininess + 8.0) / 8.0;

        if let (Some(image), Some(map)) = (rough, &rough_map)
            && map.texels.iter().any(|texel| surface.mirror(*texel) >= LEAST_MIRROR)
            && let Some((diffuse, specular)) = self.split(surface, base, image, map)
        {
            (material.diffuse, material.diffuse_map) = (surface.colour, Some(diffuse));
            (material.specular, material.specular_map) = ([1.0; 3], Some(specular));
            material.illumination = 3;
            return;
        }
        let metallic = match &rough_map {
            // Below the least mirror at every point.
            Some(_) => 0.0,
            None => surface.metallic,
        };
        let gloss = (1.0 - average) * (1.0 - average);
        let mirror = metallic * gloss;
        let map = base.and_then(|image| self.plain(image, true));
        (material.diffuse, material.diffuse_map) = (surface.colour.map(|value| value * (1.0 - mirror)), map);
        let metal = surface.colour.map(|value| value * mirror);
        if mirror >= LEAST_MIRROR {
            // A map over the metal's part leaves no place for the dielectric's, which is small beside it.
            let other = if map.is_some() { 0.0 } else { (1.0 - metallic) * gloss };
            material.specular = std::array::from_fn(|at| metal[at] + surface.reflectance[at] * other);
            material.specular_map = map;
            material.illumination = 3;
        } else {
            material.specular = std::array::from_fn(|at| share((metal[at] + surface.reflectance[at] * (1.0 - metallic)) * energy));
            material.illumination = 2;
        }
    }

    /// Diffuse and specular textures of a base colour and a texture of metallic and roughness.
    fn split(&mut self, surface: Surface, base: Option<usize>, rough: usize, map: &Picture) -> Option<(u32, u32)> {
        let parts = [surface.colour, surface.reflectance, [surface.metallic, surface.roughness, 0.0]];
        let key = format!("{base:?} {rough} {:?}", parts.as_flattened().iter().map(|value| value.to_bits()).collect::<Vec<_>>());
        let (first, second) = (format!("diffuse {key}"), format!("specular {key}"));
        if let (Some(&first), Some(&second)) = (self.textures.get(&first), self.textures.get(&second)) {
            return first.zip(second);
        }
        let base = base.and_then(|image| self.picture(image));
        // The larger of the two says the size.
        let larger = base.as_ref().filter(|base| base.texels.len() >= map.texels.len()).unwrap_or(map);
        let (width, height) = (larger.width, larger.height);
        let mut diffuse = Vec::with_capacity(larger.texels.len());
        let mut specular = Vec::with_capacity(larger.texels.len());
        for y in 0..height {
            for x in 0..width {
                let at = [(x as f32 + 0.5) / width as f32, (y as f32 + 0.5) / height as f32];
                let rough = map.sample(at, [width, height]);
                let texel = base.as_ref().map_or([255; 4], |base| base.sample(at, [width, height]));
                let (metallic, gloss) = surface.parts(rough);
                let mirror = metallic * gloss;
                let linear = [texel[0], texel[1], texel[2]].map(srgb_to_linear);
                let coded = |value: [f32; 3]| {
                    let [red, green, blue] = value.map(linear_to_srgb);
                    [red, green, blue, 255]
                };
                diffuse.push(coded(linear.map(|value| value * (1.0 - mirror))));
                specular.push(coded(std::array::from_fn(|at| {
                    linear[at] * surface.colour[at] * mirror + surface.reflectance[at] * (1.0 - metallic) * gloss
                })));
            }
        }
        let name = base.as_ref().map_or(&map.name, |base| &base.name).clone();
        let diffuse = self.add(first, Picture { name: format!("{name} (diffuse)"), width, height, texels: diffuse }, true);
        let specular = self.add(second, Picture { name: format!("{name} (specular)"), width, height, texels: specular }, true);
        diffuse.zip(specular)
    }

    /// An image as it is.
    fn plain(&mut self, image: usize, srgb: bool) -> Option<u32> {
        let key = format!("plain {srgb} {image}");
        if let Some(&known) = self.textures.get(&key) {
            return known;
        }
        let picture = self.picture(image)?;
        self.add(key, picture, srgb)
    }

    /// A normal map, its slopes multiplied by a factor.
    fn normals(&mut self, image: usize, factor: f32) -> Option<u32> {
        let factor = if factor.is_finite() { factor } else { 1.0 };
        if factor == 1.0 {
            return self.plain(image, false);
        }
        let key = format!("normals {} {image}", factor.to_bits());
        if let Some(&known) = self.textures.get(&key) {
            return known;
        }
        let mut picture = self.picture(image)?;
        for texel in &mut picture.texels {
            let [x, y, z] = [texel[0], texel[1], texel[2]].map(|value| f32::from(value) / 127.5 - 1.0);
            let bent = [x * factor, y * factor, z];
            let length = bent.iter().map(|value| value * value).sum::<f32>().sqrt().max(1e-6);
            let [x, y, z] = bent.map(|value| byte((value / length + 1.0) * 0.5));
            *texel = [x, y, z, texel[3]];
        }
        self.add(key, picture, false)
    }

    /// A texture that is one half where alpha reaches the cutoff; `None` where all is solid.
    fn mask(&mut self, base: Option<usize>, alpha: f32, cutoff: f32) -> Option<u32> {
        let key = format!("mask {base:?} {} {}", alpha.to_bits(), cutoff.to_bits());
        if let Some(&known) = self.textures.get(&key) {
            return known;
        }
        if cutoff <= 0.0 {
            return None;
        }
        let picture = base.and_then(|image| self.picture(image));
        let picture = picture.unwrap_or_else(|| Picture { name: "mask".to_owned(), width: 1, height: 1, texels: vec![[255; 4]] });
        // In the map's own alpha. The slope keeps all values between 0 and 1, so that filtering crosses one half where it crossed the cutoff.
        let least = if alpha > 0.0 { cutoff / alpha } else { f32::INFINITY };
        if picture.texels.iter().all(|texel| f32::from(texel[3]) / 255.0 >= least) {
            return None;
        }
        let slope = if least <= 1.0 { (0.5 / least).min(0.5 / (1.0 - least).max(1e-6)) } else { 0.0 };
        let texels = picture.texels.iter().map(|texel| {
            let value = f32::from(texel[3]) / 255.0;
            // No byte is one half: the side is kept whatever rounding does.
            let opacity = if slope == 0.0 {
                0
            } else if value >= least {
                byte(0.5 + (value - least) * slope).max(128)
            } else {
                byte(0.5 + (value - least) * slope).min(127)
            };
            [opacity; 4]
        });
        let texels = texels.collect();
        let picture = Picture { name: format!("{} (mask)", picture.name), width: picture.width, height: picture.height, texels };
        self.add(key, picture, false)
    }

    /// The alpha of an image; `None` where all is solid.
    fn opacity(&mut self, image: usize) -> Option<u32> {
        let key = format!("opacity {image}");
        if let Some(&known) = self.textures.get(&key) {
            return known;
        }
        let mut picture = self.picture(image)?;
        if picture.texels.iter().all(|texel| texel[3] == 255) {
            return None;
        }
        picture.texels.iter_mut().for_each(|texel| *texel = [texel[3]; 4]);
        picture.name.push_str(" (opacity)");
        self.add(key, picture, false)
    }

    fn add(&mut self, key: String, picture: Picture, srgb: bool) -> Option<u32> {
        let has_alpha = picture.texels.iter().any(|texel| texel[3] < 255);
        let Picture { name, width, height, texels } = picture;
        let texture = Texture { name, width, height, pixels: texels.into_flattened(), srgb, has_alpha };
        let number = self.assets.textures.add(texture, false).map_err(|message| self.document.warn(format!("no texture: {message}"))).ok();
        self.textures.insert(key, number);
        number
    }

    /// Reads and decodes an image; one that cannot be read is told and left out.
    fn picture(&self, at: usize) -> Option<Picture> {
        let image = self.document.root.images.get(at)?;
        let place = named("image", at, image.name.as_deref());
        let options = &self.assets.options;
        let limit = options.max_texture_bytes;
        let owned;
        let read = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => match self.document.resource(uri, limit) {
                Ok(bytes) => {
                    owned = bytes;
                    Ok(owned.as_slice())
                }
                Err(Error::Gltf { message, .. }) => Err(message),
                Err(error) => Err(error.to_string()),
            },
            (None, Some(view)) => self.document.view(view.value()).map(|(bytes, _)| bytes),
            (None, None) => Err("has neither uri nor bufferView".to_owned()),
        };
        let decoded = read.and_then(|bytes| {
            if bytes.len() as u64 > limit {
                return Err(format!("{} bytes are more than the limit of {limit}", bytes.len()));
            }
            decode(bytes, options)
        });
        match decoded {
            Ok(picture) if picture.width() > 0 && picture.height() > 0 => {
                let (width, height) = (picture.width(), picture.height());
                let texels = picture.into_rgba8().into_raw().as_chunks::<4>().0.to_vec();
                Some(Picture { name: image_name(at, image), width, height, texels })
            }
            Ok(_) => {
                self.document.warn(format!("{place}: no texture: the picture has no pixels"));
                None
            }
            Err(message) => {
                self.document.warn(format!("{place}: no texture: {message}"));
                None
            }
        }
    }
}

fn image_name(at: usize, image: &json::Image) -> String {
    match (&image.name, &image.uri) {
        (Some(name), _) if !name.is_empty() => name.clone(),
        (_, Some(uri)) if !uri.starts_with("data:") => uri.clone(),
        _ => format!("image {at}"),
    }
}

/// The factors of a material.
#[derive(Clone, Copy)]
struct Surface {
    colour: [f32; 3],
    metallic: f32,
    roughness: f32,
    /// Of a dielectric, at a right angle.
    reflectance: [f32; 3],
}

impl Surface {
    /// Metallic and gloss where the texture has this value.
    fn parts(self, texel: [u8; 4]) -> (f32, f32) {
        let metallic = self.metallic * f32::from(texel[2]) / 255.0;
        let smooth = 1.0 - self.roughness * f32::from(texel[1]) / 255.0;
        (metallic, smooth * smooth)
    }

    fn mirror(self, texel: [u8; 4]) -> f32 {
        let (metallic, gloss) = self.parts(texel);
        metallic * gloss
    }
}

impl Picture {
    /// The texel at a place from 0 to 1, filtered where the texels that are made have another raster than these.
    fn sample(&self, [u, v]: [f32; 2], raster: [u32; 2]) -> [u8; 4] {
        let get = |x: u32, y: u32| {
            let at = y.min(self.height - 1) as usize * self.width as usize + x.min(self.width - 1) as usize;
            self.texels.get(at).copied().unwrap_or([255; 4])
        };
        let (x, y) = (u * self.width as f32, v * self.height as f32);
        if raster == [self.width, self.height] {
            return get(x as u32, y as u32);
        }
        let (x, y) = ((x - 0.5).max(0.0), (y - 0.5).max(0.0));
        let (right, down) = (x.fract(), y.fract());
        let (x, y) = (x as u32, y as u32);
        let corners = [get(x, y), get(x + 1, y), get(x, y + 1), get(x + 1, y + 1)].map(|texel| texel.map(f32::from));
        std::array::from_fn(|at| {
            let upper = corners[0][at] + (corners[1][at] - corners[0][at]) * right;
            let lower = corners[2][at] + (corners[3][at] - corners[2][at]) * right;
            (upper + (lower - upper) * down + 0.5) as u8
        })
    }
}

fn slot_of(info: &json::texture::Info) -> Slot {
    let transform = info.extensions.as_ref().and_then(|extensions| extensions.texture_transform.as_ref());
    Slot { texture: info.index.value(), coordinates: coordinates_of(info.tex_coord, transform) }
}

fn coordinates_of(set: u32, transform: Option<&TextureTransform>) -> Coordinates {
    match transform {
        Some(transform) => Coordinates {
            set: transform.tex_coord.unwrap_or(set),
            offset: transform.offset.0,
            rotation: transform.rotation.0,
            scale: transform.scale.0,
        },
        None => Coordinates { set, ..Coordinates::default() },
    }
}

impl Default for Coordinates {
    fn default() -> Self {
        Self { set: 0, offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2] }
    }
}

impl Coordinates {
    /// From glTF's texture coordinates (v downwards) to ours.
    pub(super) fn apply(&self, [u, v]: [f32; 2]) -> [f32; 2] {
        let (sine, cosine) = self.rotation.sin_cos();
        let (u, v) = (u * self.scale[0], v * self.scale[1]);
        // Counterclockwise as seen on the picture, whose v goes down.
        let (u, v) = (cosine * u + sine * v + self.offset[0], cosine * v - sine * u + self.offset[1]);
        [u, 1.0 - v].map(|value| if value.is_finite() { value } else { 0.0 })
    }
}

fn positive(value: f32) -> f32 {
    if value.is_finite() { value.max(0.0) } else { 0.0 }
}

fn share(value: f32) -> f32 {
    positive(value).min(1.0)
}

fn byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

fn srgb_to_linear(value: u8) -> f32 {
    static TABLE: OnceLock<[f32; 256]> = OnceLock::new();
    let table = TABLE.get_or_init(|| {
        std::array::from_fn(|at| {
            let value = at as f32 / 255.0;
            if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        })
    });
    table[usize::from(value)]
}

fn linear_to_srgb(value: f32) -> u8 {
    /// Fine enough that every byte is reached: the steepest part of the curve is 13 bytes in 256 of these.
    const STEPS: usize = 1 << 14;
    static TABLE: OnceLock<Vec<u8>> = OnceLock::new();
    let table = TABLE.get_or_init(|| {
        let coded = |value: f32| if value <= 0.003_130_8 { value * 12.92 } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 };
        (0..=STEPS).map(|at| byte(coded(at as f32 / STEPS as f32))).collect()
    });
    table.get((value.clamp(0.0, 1.0) * STEPS as f32 + 0.5) as usize).copied().unwrap_or(255)
}
