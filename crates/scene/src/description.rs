//! The scene file: TOML, every key checked, every error with its line.

use std::collections::HashSet;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Deserialize;
use serde::de::{Deserializer, Error as _, SeqAccess, Visitor};
use toml::Spanned;

use crate::animation::{CameraTrack, Course, KeyTrack, LightTrack, MeshTrack, RigTrack, Tracks};
use crate::assets::Assets;
use crate::curve::{Curve, Interpolation};
use crate::files::read_file;
use crate::gltf::{self, Playing};
use crate::key_reader::{Cache, KeyReader, first_mesh};
use crate::load::{DEFAULT_AMBIENT, DEFAULT_BACKGROUND, default_lights, ending, folder_of};
use crate::moving::{CAMERA_BOUNDED, CameraCurve, LIGHT_BOUNDED, LightCurve, PLACED_BOUNDED, PlacedCurve, Turntable, camera_values};
use crate::sequence::{Pattern, Range as NumberRange, Sequence};
use crate::suggest::closest;
use crate::texture::{Use, srgb_to_linear};
use crate::transform::{Edit, Transform};
use crate::vector::{cross, dot, normalised, sub};
use crate::{
    Animation, Background, Camera, Error, Framing, Light, LoadOptions, Material, Mesh, Motion, NamedCamera, RenderDefaults, Result, Scene,
};
use crate::{TONEMAPS, generate, mesh_file, panorama};

/// A finite number that fits single precision.
#[derive(Clone, Copy, Debug)]
struct Number(f32);

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = f64::deserialize(deserializer)? as f32;
        if value.is_finite() { Ok(Self(value)) } else { Err(D::Error::custom("the number must be finite")) }
    }
}

/// A finite number in double precision, for times and rates.
#[derive(Clone, Copy, Debug)]
struct Real(f64);

impl<'de> Deserialize<'de> for Real {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = f64::deserialize(deserializer)?;
        if value.is_finite() { Ok(Self(value)) } else { Err(D::Error::custom("the number must be finite")) }
    }
}

type Vec3 = [Number; 3];

fn plain<const N: usize>(values: [Number; N]) -> [f32; N] {
    values.map(|value| value.0)
}

/// Linear RGB, each 0 or more: one number (grey), three numbers, or sRGB as "#rrggbb".
#[derive(Clone, Copy, Debug)]
struct Colour([f32; 3]);

impl<'de> Deserialize<'de> for Colour {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ColourVisitor;
        impl<'de> Visitor<'de> for ColourVisitor {
            type Value = [f32; 3];

            fn expecting(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                formatter.write_str("a colour: a number, [red, green, blue] (linear), or \"#rrggbb\" (sRGB)")
            }

            fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<Self::Value, E> {
                Ok([value as f32; 3])
            }

            fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<Self::Value, E> {
                Ok([value as f32; 3])
            }

            fn visit_str<E: serde::de::Error>(self, value: &str) -> Result<Self::Value, E> {
                let digits =
                    value.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.bytes().all(|byte| byte.is_ascii_hexdigit()));
                let code = digits.and_then(|digits| u32::from_str_radix(digits, 16).ok());
                let code = code.ok_or_else(|| E::invalid_value(serde::de::Unexpected::Str(value), &self))?;
                Ok([code >> 16, code >> 8 & 255, code & 255].map(|byte| srgb_to_linear(byte as f32 / 255.0)))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Self::Value, A::Error> {
                let mut values = [0.0; 3];
                for (at, value) in values.iter_mut().enumerate() {
                    *value = sequence.next_element::<f64>()?.ok_or_else(|| A::Error::invalid_length(at, &self))? as f32;
                }
                match sequence.next_element::<f64>()? {
                    None => Ok(values),
                    Some(_) => Err(A::Error::invalid_length(4, &self)),
                }
            }
        }
        let colour = deserializer.deserialize_any(ColourVisitor)?;
        if colour.iter().all(|&value| value.is_finite() && value >= 0.0) {
            Ok(Self(colour))
        } else {
            Err(D::Error::custom("the parts of a colour must be finite and 0 or more"))
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    up: Option<Spanned<Vec3>>,
    animation: Option<AnimationEntry>,
    ambient: Option<Colour>,
    render: Option<RenderEntry>,
    background: Option<Spanned<BackgroundEntry>>,
    #[serde(default)]
    camera: Vec<Spanned<CameraEntry>>,
    #[serde(default)]
    light: Vec<Spanned<LightEntry>>,
    #[serde(default)]
    material: Vec<Spanned<MaterialEntry>>,
    #[serde(default)]
    mesh: Vec<Spanned<MeshEntry>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RenderEntry {
    size: Option<Spanned<[u32; 2]>>,
    spp: Option<Spanned<u32>>,
    depth: Option<u32>,
    exposure: Option<Number>,
    tonemap: Option<Spanned<String>>,
    density: Option<Spanned<Number>>,
    camera: Option<Spanned<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AnimationEntry {
    duration: Option<Spanned<Real>>,
    fps: Option<Spanned<Real>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BackgroundEntry {
    colour: Option<Colour>,
    bottom: Option<Colour>,
    top: Option<Colour>,
    image: Option<Spanned<String>>,
    scale: Option<Number>,
    rotation: Option<Number>,
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraEntry {
    name: Spanned<String>,
    eye: Option<Vec3>,
    target: Option<Vec3>,
    up: Option<Vec3>,
    fov: Option<Spanned<Number>>,
    orthographic_height: Option<Spanned<Number>>,
    azimuth: Option<Number>,
    elevation: Option<Number>,
    zoom: Option<Spanned<Number>>,
    turntable: Option<Spanned<Real>>,
    interpolation: Option<Spanned<String>>,
    #[serde(rename = "loop")]
    looped: Option<bool>,
    #[serde(default)]
    key: Vec<Spanned<CameraKeyEntry>>,
}

/// What a key does not give is as in the key before it, and in the first one as in the camera itself; so for lights and meshes.
#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraKeyEntry {
    time: Real,
    eye: Option<Vec3>,
    target: Option<Vec3>,
    up: Option<Vec3>,
    fov: Option<Spanned<Number>>,
    orthographic_height: Option<Spanned<Number>>,
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct LightEntry {
    kind: Spanned<String>,
    position: Option<Vec3>,
    direction: Option<Spanned<Vec3>>,
    target: Option<Spanned<Vec3>>,
    intensity: Option<Colour>,
    irradiance: Option<Colour>,
    inner: Option<Number>,
    outer: Option<Spanned<Number>>,
    interpolation: Option<Spanned<String>>,
    #[serde(rename = "loop")]
    looped: Option<bool>,
    #[serde(default)]
    key: Vec<Spanned<LightKeyEntry>>,
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct LightKeyEntry {
    time: Real,
    position: Option<Vec3>,
    direction: Option<Spanned<Vec3>>,
    target: Option<Spanned<Vec3>>,
    intensity: Option<Colour>,
    irradiance: Option<Colour>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MaterialEntry {
    name: Spanned<String>,
    diffuse: Option<Colour>,
    specular: Option<Colour>,
    shininess: Option<Spanned<Number>>,
    emission: Option<Colour>,
    opacity: Option<Spanned<Number>>,
    blend: Option<bool>,
    index_of_refraction: Option<Number>,
    illumination: Option<Spanned<u32>>,
    mirror: Option<bool>,
    diffuse_map: Option<Spanned<String>>,
    specular_map: Option<Spanned<String>>,
    emission_map: Option<Spanned<String>>,
    opacity_map: Option<Spanned<String>>,
    normal_map: Option<Spanned<String>>,
    bump_map: Option<Spanned<String>>,
    bump_scale: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MeshEntry {
    file: Option<Spanned<String>>,
    sequence: Option<Spanned<SequenceEntry>>,
    fps: Option<Spanned<Real>>,
    start: Option<Real>,
    #[serde(rename = "loop")]
    looped: Option<bool>,
    clip: Option<Spanned<String>>,
    interpolate: Option<bool>,
    first: Option<u64>,
    last: Option<u64>,
    shape: Option<Spanned<String>>,
    name: Option<String>,
    material: Option<Spanned<String>>,
    translate: Option<Vec3>,
    rotate: Option<Vec3>,
    scale: Option<Spanned<Scale>>,
    matrix: Option<Spanned<Vec<[Number; 4]>>>,
    radius: Option<Spanned<Number>>,
    tube: Option<Spanned<Number>>,
    size: Option<Vec<Number>>,
    segments: Option<Spanned<u32>>,
    triangles: Option<Spanned<u32>>,
    seed: Option<u32>,
    corners: Option<[Vec3; 4]>,
    uv_scale: Option<Number>,
    interpolation: Option<Spanned<String>>,
    #[serde(default)]
    key: Vec<Spanned<MeshKeyEntry>>,
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct MeshKeyEntry {
    time: Real,
    translate: Option<Vec3>,
    rotate: Option<Vec3>,
    scale: Option<Spanned<Scale>>,
}

/// A pattern, or the names of all files.
#[derive(Clone, Debug)]
enum SequenceEntry {
    Pattern(String),
    List(Vec<String>),
}

impl<'de> Deserialize<'de> for SequenceEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct SequenceVisitor;
        impl<'de> Visitor<'de> for SequenceVisitor {
            type Value = SequenceEntry;

            fn expecting(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                formatter.write_str("a pattern such as \"name.%04d.obj\", or a list of file names")
            }

            fn visit_str<E: serde::de::Error>(self, value: &str) -> Result<Self::Value, E> {
                Ok(SequenceEntry::Pattern(value.to_owned()))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Self::Value, A::Error> {
                let mut names = Vec::new();
                while let Some(name) = sequence.next_element()? {
                    names.push(name);
                }
                Ok(SequenceEntry::List(names))
            }
        }
        deserializer.deserialize_any(SequenceVisitor)
    }
}

/// One factor, or one an axis.
#[derive(Clone, Copy, Debug)]
struct Scale([f32; 3]);

impl<'de> Deserialize<'de> for Scale {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ScaleVisitor;
        impl<'de> Visitor<'de> for ScaleVisitor {
            type Value = [f64; 3];

            fn expecting(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                formatter.write_str("a number, or three numbers [x, y, z]")
            }

            fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<Self::Value, E> {
                Ok([value; 3])
            }

            fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<Self::Value, E> {
                Ok([value as f64; 3])
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Self::Value, A::Error> {
                let mut values = [0.0; 3];
                for (at, value) in values.iter_mut().enumerate() {
                    *value = sequence.next_element::<f64>()?.ok_or_else(|| A::Error::invalid_length(at, &self))?;
                }
                match sequence.next_element::<f64>()? {
                    None => Ok(values),
                    Some(_) => Err(A::Error::invalid_length(4, &self)),
                }
            }
        }
        let scale = deserializer.deserialize_any(ScaleVisitor)?.map(|value| value as f32);
        if scale.iter().all(|value| value.is_finite() && *value != 0.0) {
            Ok(Self(scale))
        } else {
            Err(D::Error::custom("a scale must be finite and not 0"))
        }
    }
}

/// The cap for what a scene file may generate in one mesh.
const MAX_GENERATED_TRIANGLES: u64 = 1 << 25;
/// The cap for all shapes of a scene file together.
const MAX_GENERATED_TOTAL: u64 = 1 << 26;

/// Reads a scene file. Everything that it names lies below its folder, unless the options allow more.
pub(crate) fn open(path: &Path, options: &LoadOptions) -> Result<Animation> {
    let bytes = read_file(path, options.max_description_bytes)?;
    let shown = path.to_string_lossy().into_owned();
    let text = String::from_utf8(bytes).map_err(|error| Error::Description {
        file: shown.clone(),
        line: 1 + error.as_bytes()[..error.utf8_error().valid_up_to()].iter().filter(|&&byte| byte == b'\n').count() as u64,
        message: "the text is not UTF-8; save it as UTF-8".to_owned(),
    })?;
    let source = Source { file: &shown, text: &text };
    let mut description: Description = toml::from_str(&text).map_err(|error| source.toml_error(&error))?;
    let assets = Assets::new(Some(&folder_of(path)), options)?;
    let root = assets.files.root().map(Path::to_owned).unwrap_or_default();
    let mut builder = Builder {
        source,
        root,
        assets,
        cache: Cache::new(options.max_key_cache_bytes),
        motions: Vec::new(),
        tracks: Tracks::default(),
        courses: Vec::new(),
        generated: 0,
    };
    let given = description.animation.take();
    let scene = builder.build(description)?;
    builder.finish(scene, given.as_ref())
}

/// By the ending of a file's name.
fn is_gltf(name: &str) -> bool {
    let ending = name.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase());
    matches!(ending.as_deref(), Some("gltf" | "glb"))
}

#[derive(Clone, Copy)]
struct Source<'a> {
    file: &'a str,
    text: &'a str,
}

impl Source<'_> {
    fn error(&self, at: usize, message: impl Into<String>) -> Error {
        let line = 1 + self.text.as_bytes().iter().take(at).filter(|&&byte| byte == b'\n').count() as u64;
        Error::Description { file: self.file.to_owned(), line, message: message.into() }
    }

    fn error_in(&self, span: Range<usize>, message: impl Into<String>) -> Error {
        self.error(span.start, message)
    }

    fn toml_error(&self, error: &toml::de::Error) -> Error {
        // Several lines in places; the parts after the first say what was expected.
        let mut message = error.message().trim().replace('\n', "; ");
        for (type_name, words) in [("u32", "a whole number, 0 or more"), ("f64", "a number")] {
            if let Some(start) = message.strip_suffix(&format!("expected {type_name}")) {
                message = format!("{start}expected {words}");
            }
        }
        // "unknown field `a`, expected one of `b`, `c`": all names stand in the message.
        if message.starts_with("unknown field") {
            let mut names = message.split('`').skip(1).step_by(2);
            let near = names.next().and_then(|wrong| closest(wrong, names)).map(str::to_owned);
            if let Some(near) = near {
                message = format!("{message}; did you mean `{near}`?");
            }
        }
        self.error(error.span().map_or(0, |span| span.start), message)
    }

    /// The place of a name in a list.
    fn choose(&self, what: &str, name: &Spanned<String>, choices: &[&str]) -> Result<usize> {
        choices.iter().position(|choice| choice == name.get_ref()).ok_or_else(|| {
            let near =
                closest(name.get_ref(), choices.iter().copied()).map(|near| format!("; did you mean \"{near}\"?")).unwrap_or_default();
            let list = choices.iter().map(|choice| format!("\"{choice}\"")).collect::<Vec<_>>().join(", ");
            self.error_in(name.span(), format!("no {what} \"{}\"; there are {list}{near}", name.get_ref()))
        })
    }

    fn direction(&self, what: &str, value: &Spanned<Vec3>) -> Result<[f32; 3]> {
        normalised(plain(*value.get_ref()).map(f64::from))
            .map(|direction| direction.map(|value| value as f32))
            .ok_or_else(|| self.error_in(value.span(), format!("{what} must not be [0, 0, 0]")))
    }

    fn within(&self, what: &str, value: &Spanned<Number>, low: f32, high: f32) -> Result<f32> {
        let number = value.get_ref().0;
        if number >= low && number <= high {
            Ok(number)
        } else {
            Err(self.error_in(value.span(), format!("{what} is {number}; it must be from {low} to {high}")))
        }
    }

    fn above_zero(&self, what: &str, value: &Spanned<Number>) -> Result<f32> {
        let number = value.get_ref().0;
        if number > 0.0 { Ok(number) } else { Err(self.error_in(value.span(), format!("{what} is {number}; it must be above 0"))) }
    }
}

struct Builder<'a> {
    source: Source<'a>,
    root: PathBuf,
    assets: Assets,
    cache: Cache,
    motions: Vec<Motion>,
    tracks: Tracks,
    courses: Vec<Course>,
    generated: u64,
}

impl Builder<'_> {
    /// The animation about a scene that was built.
    fn finish(self, scene: Scene, given: Option<&AnimationEntry>) -> Result<Animation> {
        let key_tracks: Vec<Option<KeyTrack>> = self
            .tracks
            .meshes
            .iter()
            .map(|track| match track {
                MeshTrack::Keys(track) => Some(track.clone()),
                _ => None,
            })
            .collect();
        let positive = |what: &str, value: Option<&Spanned<Real>>| match value {
            Some(value) if value.get_ref().0 <= 0.0 => {
                Err(self.source.error_in(value.span(), format!("{what} is {}; it must be above 0", value.get_ref().0)))
            }
            value => Ok(value.map(|value| value.get_ref().0)),
        };
        let duration = positive("duration", given.and_then(|given| given.duration.as_ref()))?;
        let fps = positive("fps", given.and_then(|given| given.fps.as_ref()))?;
        let mut animation = Animation::still(scene);
        animation.motions = self.motions;
        if key_tracks.iter().any(Option::is_some) {
            animation.keys = Some(KeyReader::new(key_tracks, self.assets, self.cache, &animation.scene.warnings));
        }
        animation.tracks = self.tracks;
        animation.set_course(&self.courses, duration, fps);
        Ok(animation)
    }

    fn build(&mut self, description: Description) -> Result<Scene> {
        let source = self.source;
        let up = match &description.up {
            Some(up) => source.direction("up", up)?,
            None => [0.0, 1.0, 0.0],
        };
        let mut names = HashSet::new();
        for entry in description.material {
            let at = entry.span().start;
            let material = self.material(entry.into_inner())?;
            if !names.insert(material.name.clone()) {
                return Err(source.error(at, format!("material \"{}\" is there twice; rename one", material.name)));
            }
            self.assets.material(material);
        }
        // The names that meshes may use are those of the file, not those that OBJ files bring along.
        let named: Vec<String> = self.assets.materials().iter().map(|material| material.name.clone()).collect();
        let mut meshes = Vec::new();
        for entry in description.mesh {
            let at = entry.span().start;
            let entry = entry.into_inner();
            match &entry.file {
                Some(file) if is_gltf(file.get_ref()) => meshes.append(&mut self.gltf(&entry, file, at, &named)?),
                _ => meshes.push(self.mesh(entry, at, &named)?),
            }
        }
        let lights = description.light.into_iter().map(|entry| self.moving_light(entry)).collect::<Result<Vec<_>>>()?;
        let background = match description.background {
            Some(entry) => self.background(entry)?,
            None => DEFAULT_BACKGROUND,
        };
        let mut scene = Scene { background, up, ..self.assets.scene(meshes) };
        if lights.is_empty() {
            scene.lights = default_lights(up);
            scene.ambient = DEFAULT_AMBIENT;
        } else {
            scene.lights = lights;
        }
        if let Some(Colour(ambient)) = description.ambient {
            scene.ambient = ambient;
        }
        if let Some(render) = &description.render {
            scene.defaults = self.render(render)?;
        }
        for entry in description.camera {
            let camera = self.moving_camera(entry, &scene)?;
            scene.cameras.push(camera);
        }
        if let Some(wanted) = description.render.as_ref().and_then(|render| render.camera.as_ref()) {
            let cameras: Vec<&str> = scene.cameras.iter().map(|camera| camera.name.as_str()).collect();
            source.choose("camera", wanted, &cameras)?;
        }
        if scene.meshes.is_empty() {
            scene.warnings.push(format!("{}: holds no meshes", source.file));
        }
        Ok(scene)
    }

    fn render(&self, entry: &RenderEntry) -> Result<RenderDefaults> {
        let source = self.source;
        if let Some(size) = &entry.size
            && size.get_ref().contains(&0)
        {
            return Err(source.error_in(size.span(), "width and height of a picture must be 1 or more"));
        }
        if let Some(spp) = &entry.spp
            && *spp.get_ref() == 0
        {
            return Err(source.error_in(spp.span(), "spp must be 1 or more"));
        }
        if let Some(tonemap) = &entry.tonemap {
            source.choose("tonemap", tonemap, &TONEMAPS)?;
        }
        Ok(RenderDefaults {
            size: entry.size.as_ref().map(|size| *size.get_ref()),
            spp: entry.spp.as_ref().map(|spp| *spp.get_ref()),
            depth: entry.depth,
            exposure: entry.exposure.map(|exposure| exposure.0),
            tonemap: entry.tonemap.as_ref().map(|tonemap| tonemap.get_ref().clone()),
            density: entry.density.as_ref().map(|density| source.above_zero("density", density)).transpose()?,
            camera: entry.camera.as_ref().map(|camera| camera.get_ref().clone()),
        })
    }

    fn background(&mut self, entry: Spanned<BackgroundEntry>) -> Result<Background> {
        let source = self.source;
        let at = entry.span().start;
        let entry = entry.into_inner();
        if entry.image.is_none() && (entry.scale.is_some() || entry.rotation.is_some()) {
            return Err(source.error(at, "scale and rotation of a background belong to an image"));
        }
        match (entry.colour, entry.bottom, entry.top, entry.image) {
            (Some(Colour(colour)), None, None, None) => Ok(Background::Colour(colour)),
            (None, Some(Colour(bottom)), Some(Colour(top)), None) => Ok(Background::Gradient { bottom, top }),
            (None, None, None, Some(image)) => {
                let path = self.find(&image)?;
                let bytes = read_file(&path, self.assets.options.max_texture_bytes)?;
                let scale = entry.scale.map_or(1.0, |scale| scale.0);
                let (width, height, pixels) = panorama::decode(&bytes, scale, &self.assets.options)
                    .map_err(|message| source.error_in(image.span(), format!("{}: {message}", image.get_ref())))?;
                Ok(Background::Equirectangular {
                    width,
                    height,
                    pixels,
                    rotation_degrees: entry.rotation.map_or(0.0, |rotation| rotation.0),
                })
            }
            _ => Err(source.error(at, "a background needs one of: colour, or bottom and top, or image")),
        }
    }

    fn interpolation(&self, name: Option<&Spanned<String>>) -> Result<Interpolation> {
        let Some(name) = name else { return Ok(Interpolation::default()) };
        let choices = [Interpolation::Step, Interpolation::Linear, Interpolation::Smooth];
        Ok(choices[self.source.choose("interpolation", name, &["step", "linear", "smooth"])?])
    }

    /// The curve through keys; `at` is where what has them begins in the scene file.
    fn curve<const N: usize>(
        &self,
        keys: Vec<(f64, [f64; N])>,
        name: Option<&Spanned<String>>,
        looped: Option<bool>,
        bounded: [bool; N],
        at: usize,
    ) -> Result<Curve<N>> {
        let interpolation = self.interpolation(name)?;
        Curve::new(keys, interpolation, looped.unwrap_or(false), bounded)
            .ok_or_else(|| self.source.error(at, "the times of keys must be 0 or above, each later than the one before"))
    }

    fn moving_camera(&mut self, entry: Spanned<CameraEntry>, scene: &Scene) -> Result<NamedCamera> {
        let source = self.source;
        let at = entry.span().start;
        let mut entry = entry.into_inner();
        let name = entry.name.get_ref().clone();
        if scene.cameras.iter().any(|camera| camera.name == name) {
            return Err(source.error_in(entry.name.span(), format!("camera \"{name}\" is there twice; rename one")));
        }
        if entry.key.is_empty() {
            if entry.interpolation.is_some() || entry.looped.is_some() {
                return Err(source.error(at, "interpolation and loop of a camera belong to keys; a turntable goes on by itself"));
            }
            let turntable = match &entry.turntable {
                Some(seconds) if seconds.get_ref().0 == 0.0 => {
                    return Err(source.error_in(seconds.span(), "a turntable needs seconds for a turn, below 0 to turn the other way"));
                }
                seconds => seconds.as_ref().map(|seconds| seconds.get_ref().0),
            };
            let camera = self.camera(&entry, at, scene)?;
            self.tracks.cameras.push(match turntable {
                Some(seconds) => {
                    self.courses.push(Course { seconds: seconds.abs(), looped: true, fps: None });
                    CameraTrack::Turntable(Turntable { seconds, axis: normalised(scene.up.map(f64::from)).unwrap_or([0.0, 1.0, 0.0]) })
                }
                None => CameraTrack::Still,
            });
            return Ok(NamedCamera { name, camera });
        }
        if let Some(turntable) = &entry.turntable {
            return Err(source.error_in(turntable.span(), "a camera has keys or a turntable, not both"));
        }
        let mut keys = Vec::new();
        let mut orthographic = None;
        for key in std::mem::take(&mut entry.key) {
            let at = key.span().start;
            let key = key.into_inner();
            entry.eye = key.eye.or(entry.eye);
            entry.target = key.target.or(entry.target);
            entry.up = key.up.or(entry.up);
            entry.fov = key.fov.or(entry.fov);
            entry.orthographic_height = key.orthographic_height.or(entry.orthographic_height);
            let camera = self.camera(&entry, at, scene)?;
            if *orthographic.get_or_insert(camera.orthographic_height.is_some()) != camera.orthographic_height.is_some() {
                return Err(source.error(at, "a camera is orthographic in all its keys or in none; give the first one orthographic_height"));
            }
            keys.push((key.time.0, camera_values(&camera)));
        }
        let curve = self.curve(keys, entry.interpolation.as_ref(), entry.looped, CAMERA_BOUNDED, at)?;
        self.courses.push(Course::of(&curve));
        let moving = CameraCurve::new(curve, orthographic.unwrap_or(false));
        let camera = moving.at(0.0);
        self.tracks.cameras.push(CameraTrack::Keys(moving));
        Ok(NamedCamera { name, camera })
    }

    fn camera(&self, entry: &CameraEntry, at: usize, scene: &Scene) -> Result<Camera> {
        let source = self.source;
        let fov = entry.fov.as_ref().map(|fov| source.within("fov", fov, 0.01, 179.0)).transpose()?;
        let orthographic_height =
            entry.orthographic_height.as_ref().map(|height| source.above_zero("orthographic_height", height)).transpose()?;
        let up = entry.up.map_or(scene.up, plain);
        let mut framing = Framing { up, ..Framing::default() };
        if let Some(fov) = fov {
            framing.vertical_fov_degrees = fov;
        }
        let framed = entry.azimuth.is_some() || entry.elevation.is_some() || entry.zoom.is_some();
        let mut camera = match (entry.eye, entry.target) {
            (Some(eye), Some(target)) if !framed => Camera {
                eye: plain(eye),
                target: plain(target),
                up,
                vertical_fov_degrees: framing.vertical_fov_degrees,
                orthographic_height: None,
            },
            (None, None) => {
                framing.azimuth = entry.azimuth.map_or(0.0, |azimuth| azimuth.0);
                framing.elevation = entry.elevation.map_or(0.0, |elevation| elevation.0);
                framing.zoom = entry.zoom.as_ref().map(|zoom| source.above_zero("zoom", zoom)).transpose()?.unwrap_or(1.0);
                if let Some([width, height]) = scene.defaults.size {
                    framing.aspect = width as f32 / height as f32;
                }
                scene.frame(&framing)
            }
            _ => {
                return Err(
                    source.error(at, "a camera needs eye and target, or neither (with azimuth, elevation, zoom from the automatic view)")
                );
            }
        };
        camera.orthographic_height = orthographic_height;
        let view = sub(camera.target.map(f64::from), camera.eye.map(f64::from));
        let (Some(view), Some(up)) = (normalised(view), normalised(up.map(f64::from))) else {
            return Err(source.error(at, "a camera's eye and target must differ, and up must not be [0, 0, 0]"));
        };
        let side = cross(view, up);
        if dot(side, side) < 1e-12 {
            return Err(source.error(at, "a camera must not look along its up; give another up"));
        }
        Ok(camera)
    }

    fn moving_light(&mut self, entry: Spanned<LightEntry>) -> Result<Light> {
        let source = self.source;
        let at = entry.span().start;
        let mut entry = entry.into_inner();
        if entry.key.is_empty() {
            if entry.interpolation.is_some() || entry.looped.is_some() {
                return Err(source.error(at, "interpolation and loop of a light belong to keys"));
            }
            self.tracks.lights.push(LightTrack::Still);
            return self.light(&entry, at);
        }
        let mut keys = Vec::new();
        let mut first: Option<Light> = None;
        let mut aimed = None;
        for key in std::mem::take(&mut entry.key) {
            let at = key.span().start;
            let key = key.into_inner();
            entry.position = key.position.or(entry.position);
            entry.direction = key.direction.or(entry.direction);
            entry.target = key.target.or(entry.target);
            entry.intensity = key.intensity.or(entry.intensity);
            entry.irradiance = key.irradiance.or(entry.irradiance);
            let light = self.light(&entry, at)?;
            first.get_or_insert(light);
            if *aimed.get_or_insert(entry.target.is_some()) != entry.target.is_some() {
                return Err(source.error(at, "a light has a target in all its keys or in none"));
            }
            let (direction, power) = match light {
                Light::Point { intensity, .. } => ([0.0; 3], intensity),
                Light::Directional { direction, irradiance } => (direction, irradiance),
                Light::Spot { direction, intensity, .. } => (direction, intensity),
            };
            let towards = entry.target.as_ref().map_or(direction, |target| plain(*target.get_ref()));
            let parts = [entry.position.map_or([0.0; 3], plain), towards, power];
            let mut values = [0.0; 9];
            values.iter_mut().zip(parts.as_flattened()).for_each(|(value, part)| *value = f64::from(*part));
            keys.push((key.time.0, values));
        }
        let curve = self.curve(keys, entry.interpolation.as_ref(), entry.looped, LIGHT_BOUNDED, at)?;
        self.courses.push(Course::of(&curve));
        let moving = LightCurve::new(curve, aimed.unwrap_or(false));
        let light = match first {
            Some(first) => moving.at(&first, 0.0),
            None => self.light(&entry, at)?,
        };
        self.tracks.lights.push(LightTrack::Keys(moving));
        Ok(light)
    }

    fn light(&self, entry: &LightEntry, at: usize) -> Result<Light> {
        let source = self.source;
        let missing = |what: &str| source.error(at, format!("a {} light needs {what}", entry.kind.get_ref()));
        let unused = |what: &str| source.error(at, format!("a {} light has no {what}", entry.kind.get_ref()));
        let position = || entry.position.map(plain).ok_or_else(|| missing("position = [x, y, z]"));
        let intensity = || entry.intensity.map(|Colour(colour)| colour).ok_or_else(|| missing("intensity"));
        let direction = |from: Option<[f32; 3]>| match (&entry.direction, &entry.target, from) {
            (Some(direction), None, _) => source.direction("direction", direction),
            (None, Some(target), Some(from)) => {
                let way = sub(plain(*target.get_ref()).map(f64::from), from.map(f64::from));
                let way = normalised(way).ok_or_else(|| source.error_in(target.span(), "target must differ from position"))?;
                Ok(way.map(|value| value as f32))
            }
            (None, Some(_), None) => Err(missing("position with target, or direction")),
            (Some(_), Some(_), _) => Err(source.error(at, "a light has direction or target, not both")),
            (None, None, _) => Err(missing("direction or target")),
        };
        let kind = source.choose("kind of light", &entry.kind, &["point", "directional", "spot"])?;
        if kind != 1 && entry.irradiance.is_some() {
            return Err(unused("irradiance; give intensity"));
        }
        if kind != 2 && (entry.inner.is_some() || entry.outer.is_some()) {
            return Err(unused("cone; inner and outer belong to a spot light"));
        }
        match kind {
            0 if entry.direction.is_some() || entry.target.is_some() => Err(unused("direction")),
            0 => Ok(Light::Point { position: position()?, intensity: intensity()? }),
            1 if entry.intensity.is_some() => Err(unused("intensity; give irradiance")),
            1 => Ok(Light::Directional {
                direction: direction(entry.position.map(plain))?,
                irradiance: entry.irradiance.map(|Colour(colour)| colour).ok_or_else(|| missing("irradiance"))?,
            }),
            _ => {
                let position = position()?;
                let outer_degrees =
                    entry.outer.as_ref().map(|outer| source.within("outer", outer, 0.01, 90.0)).transpose()?.unwrap_or(45.0);
                let inner_degrees = entry.inner.map_or(outer_degrees * 0.8, |inner| inner.0).clamp(0.0, outer_degrees);
                Ok(Light::Spot { position, direction: direction(Some(position))?, intensity: intensity()?, inner_degrees, outer_degrees })
            }
        }
    }

    fn material(&mut self, entry: MaterialEntry) -> Result<Material> {
        let source = self.source;
        let defaults = Material::default();
        let diffuse_map = self.texture(&entry.diffuse_map, Use::Colour)?;
        let opacity_map = match &entry.opacity_map {
            Some(_) => self.texture(&entry.opacity_map, Use::Opacity)?,
            None if diffuse_map.is_some() => self.texture(&entry.diffuse_map, Use::AlphaOfColour)?,
            None => None,
        };
        let specular_map = self.texture(&entry.specular_map, Use::Colour)?;
        let emission_map = self.texture(&entry.emission_map, Use::Colour)?;
        if let (Some(_), Some(bump)) = (&entry.normal_map, &entry.bump_map) {
            return Err(source.error_in(bump.span(), "a material has normal_map or bump_map, not both"));
        }
        let normals = self.texture(&entry.normal_map, Use::Data)?;
        let bumps = self.texture(&entry.bump_map, Use::Data)?;
        let normal_map_is_height = bumps.is_some_and(|map| self.assets.textures.is_height(map));
        let given = |colour: Option<Colour>, map: Option<u32>, absent: [f32; 3]| match (colour, map) {
            (Some(Colour(colour)), _) => colour,
            (None, Some(_)) => [1.0; 3],
            (None, None) => absent,
        };
        let mirror = entry.mirror.unwrap_or(false);
        let illumination = match &entry.illumination {
            Some(illumination) if *illumination.get_ref() > 10 => {
                return Err(source.error_in(illumination.span(), "illumination must be from 0 to 10, as illum in MTL files"));
            }
            Some(illumination) => *illumination.get_ref(),
            None if mirror => 3,
            None if entry.specular.is_some() => 2,
            None => defaults.illumination,
        };
        let opacity = entry.opacity.as_ref().map_or(Ok(defaults.opacity), |value| source.within("opacity", value, 0.0, 1.0))?;
        let specular = given(entry.specular, specular_map, if mirror { [1.0; 3] } else { defaults.specular });
        Ok(Material {
            name: entry.name.get_ref().clone(),
            diffuse: given(entry.diffuse, diffuse_map, if mirror { [0.0; 3] } else { defaults.diffuse }),
            specular,
            shininess: entry.shininess.as_ref().map_or(Ok(defaults.shininess), |value| source.within("shininess", value, 0.0, 1e6))?,
            emission: given(entry.emission, emission_map, defaults.emission),
            opacity,
            blend: entry.blend.unwrap_or(opacity < 1.0),
            unlit: defaults.unlit,
            index_of_refraction: entry.index_of_refraction.map_or(defaults.index_of_refraction, |value| value.0),
            illumination,
            diffuse_map,
            specular_map,
            emission_map,
            opacity_map,
            normal_map: normals.or(bumps),
            normal_map_is_height,
            bump_scale: entry.bump_scale.map_or(1.0, |scale| scale.0),
        })
    }

    fn texture(&mut self, name: &Option<Spanned<String>>, usage: Use) -> Result<Option<u32>> {
        let Some(name) = name else { return Ok(None) };
        let source = self.source;
        let root = self.root.clone();
        self.assets.textures.load(&root, name.get_ref(), usage).or_else(|message| match source.error_in(name.span(), message) {
            Error::Description { file, line, message } => {
                self.assets.warnings.push(format!("{file}:{line}: no texture: {message}"));
                Ok(None)
            }
            error => Err(error),
        })
    }

    /// The path of a file that the scene cannot do without.
    fn find(&self, name: &Spanned<String>) -> Result<PathBuf> {
        self.assets.files.find(&self.root, name.get_ref()).map_err(|error| self.source.error_in(name.span(), error.to_string()))
    }

    /// The meshes of a glTF file.
    fn gltf(&mut self, entry: &MeshEntry, file: &Spanned<String>, at: usize, named: &[String]) -> Result<Vec<Mesh>> {
        let source = self.source;
        self.refuse_shape_keys(entry, at)?;
        let others = [
            ("shape", entry.shape.is_some()),
            ("sequence", entry.sequence.is_some()),
            ("fps", entry.fps.is_some()),
            ("interpolate", entry.interpolate.is_some()),
            ("first", entry.first.is_some()),
            ("last", entry.last.is_some()),
            ("interpolation", entry.interpolation.is_some()),
            ("key", !entry.key.is_empty()),
        ];
        if let Some((key, _)) = others.iter().find(|(_, given)| *given) {
            return Err(source.error(at, format!("a mesh of a glTF file has no {key}; it moves as its clip says")));
        }
        let material = match &entry.material {
            Some(name) => Some(source.choose("material", name, &named.iter().map(String::as_str).collect::<Vec<_>>())? as u32),
            None => None,
        };
        let playing = Playing {
            clip: entry.clip.as_ref().map(|clip| clip.get_ref().as_str()),
            placement: self.transform(entry)?.rows(),
            start: entry.start.map_or(0.0, |start| start.0),
            looped: entry.looped.unwrap_or(true),
        };
        let path = self.find(file)?;
        let bytes = read_file(&path, self.assets.options.max_mesh_bytes).map_err(|error| self.in_place(file.span(), error))?;
        let loaded = gltf::read(&mut self.assets, &bytes, file.get_ref(), Some(&folder_of(&path)), &playing).map_err(|error| {
            let span = entry.clip.as_ref().filter(|_| matches!(error, Error::UnknownClip { .. })).map_or(file.span(), Spanned::span);
            self.in_place(span, error)
        })?;
        let mut meshes = loaded.meshes;
        let single = meshes.len() == 1;
        for mesh in &mut meshes {
            let name = entry.name.as_ref().map(|name| if single { name.clone() } else { format!("{name}/{}", mesh.name) });
            Edit { name, material, uv_scale: entry.uv_scale.map(|scale| scale.0), ..Edit::default() }.apply(mesh);
        }
        let rig = Arc::new(loaded.rig);
        for (number, deformed) in loaded.deformed.into_iter().enumerate() {
            let (track, motion) = RigTrack::mesh(&rig, number, deformed);
            if matches!(motion, Motion::Deformed(_)) {
                self.courses.push(rig.course());
            }
            self.tracks.meshes.push(track);
            self.motions.push(motion);
        }
        Ok(meshes)
    }

    fn mesh(&mut self, mut entry: MeshEntry, at: usize, named: &[String]) -> Result<Mesh> {
        let source = self.source;
        let material = match &entry.material {
            Some(name) => Some(source.choose("material", name, &named.iter().map(String::as_str).collect::<Vec<_>>())? as u32),
            None => None,
        };
        if entry.sequence.is_none() {
            self.refuse_sequence_keys(&entry, at)?;
        }
        let transform = if entry.key.is_empty() {
            if let Some(interpolation) = &entry.interpolation {
                return Err(source.error_in(interpolation.span(), "interpolation of a mesh belongs to keys; a sequence has interpolate"));
            }
            self.transform(&entry)?
        } else {
            // The keys hold the rest of its place.
            self.matrix(&entry)?.unwrap_or(Transform::IDENTITY)
        };
        let mut edit = Edit { name: entry.name.clone(), material, uv_scale: entry.uv_scale.map(|scale| scale.0), transform };
        let mut mesh = match (&entry.file, &entry.sequence, &entry.shape) {
            (Some(file), None, None) => {
                self.refuse_shape_keys(&entry, at)?;
                let path = self.find(file)?;
                if ending(&path).as_deref() == Some("toml") {
                    return Err(source.error_in(file.span(), format!("{} is a scene file; name its meshes here instead", file.get_ref())));
                }
                let timed = mesh_file::read(&mut self.assets, &path, file.get_ref()).map_err(|error| self.in_place(file.span(), error))?;
                timed.mesh
            }
            (None, Some(sequence), None) => {
                self.refuse_shape_keys(&entry, at)?;
                let mut track = self.sequence(&entry, sequence, &mut edit)?;
                let span = sequence.span();
                if !entry.key.is_empty() {
                    // `loop` is the sequence's.
                    entry.looped = None;
                    let placed = self.placed(&mut entry, at)?;
                    self.courses.push(Course::of(placed.curve()));
                    track.placed = Some(placed);
                }
                let mesh = first_mesh(&mut self.assets, &mut self.cache, &track).map_err(|error| self.in_place(span, error))?;
                self.courses.push(track.course());
                self.tracks.meshes.push(MeshTrack::Keys(track));
                self.motions.push(Motion::Keys);
                return Ok(mesh);
            }
            (None, None, Some(shape)) => self.shape(&entry, shape, at)?,
            _ => return Err(source.error(at, "a mesh needs one of: file = \"name.obj\", sequence = \"name.%04d.obj\", shape = \"sphere\"")),
        };
        edit.apply(&mut mesh);
        if entry.key.is_empty() {
            self.tracks.meshes.push(MeshTrack::Still);
            self.motions.push(Motion::Still);
        } else {
            let placed = self.placed(&mut entry, at)?;
            self.motions.push(Motion::Deformed(Box::new(placed.deform(&mut mesh))));
            self.courses.push(Course::of(placed.curve()));
            self.tracks.meshes.push(MeshTrack::Placed(placed));
        }
        Ok(mesh)
    }

    /// The course of a mesh with keys.
    fn placed(&self, entry: &mut MeshEntry, at: usize) -> Result<PlacedCurve> {
        let mut keys = Vec::new();
        let mut first: Option<[f32; 3]> = None;
        for key in std::mem::take(&mut entry.key) {
            let key = key.into_inner();
            entry.translate = key.translate.or(entry.translate);
            entry.rotate = key.rotate.or(entry.rotate);
            if let Some(scale) = key.scale {
                entry.scale = Some(scale);
            }
            let scale = entry.scale.as_ref().map_or([1.0; 3], |scale| scale.get_ref().0);
            let first = first.get_or_insert(scale);
            if let Some(given) = &entry.scale
                && (0..3).any(|axis| (scale[axis] < 0.0) != (first[axis] < 0.0))
            {
                return Err(self
                    .source
                    .error_in(given.span(), "a scale must keep its sign from key to key: on the way it would flatten the mesh"));
            }
            let parts = [entry.translate.map_or([0.0; 3], plain), entry.rotate.map_or([0.0; 3], plain), scale];
            let mut values = [0.0; 9];
            values.iter_mut().zip(parts.as_flattened()).for_each(|(value, part)| *value = f64::from(*part));
            keys.push((key.time.0, values));
        }
        self.curve(keys, entry.interpolation.as_ref(), entry.looped, PLACED_BOUNDED, at).map(PlacedCurve::new)
    }

    /// An error of a file that the scene file names; those that tell their own place are left as they are.
    fn in_place(&self, span: Range<usize>, error: Error) -> Error {
        match error {
            error @ (Error::Obj { .. } | Error::Ply { .. } | Error::Gltf { .. } | Error::Description { .. }) => error,
            error => self.source.error_in(span, error.to_string()),
        }
    }

    fn sequence(&self, entry: &MeshEntry, sequence: &Spanned<SequenceEntry>, edit: &mut Edit) -> Result<KeyTrack> {
        let source = self.source;
        let wrong = |message: String| source.error_in(sequence.span(), message);
        let range = NumberRange { first: entry.first, last: entry.last };
        let files = match sequence.get_ref() {
            SequenceEntry::Pattern(name) => {
                let slashed = name.replace('\\', "/");
                let (folder, file) = slashed.rsplit_once('/').map_or((None, slashed.as_str()), |(folder, file)| (Some(folder), file));
                let pattern = Pattern::parse(file).map_err(wrong)?.ok_or_else(|| {
                    wrong(format!(
                        "\"{name}\" has no place for a number; write %04d or #### for it, or file = for a mesh that stands still"
                    ))
                })?;
                let folder = match folder {
                    Some(folder) => self.assets.files.folder(&self.root, folder).map_err(|error| wrong(error.to_string()))?,
                    None => self.root.clone(),
                };
                Sequence::numbered(pattern, &folder, range, false).map_err(wrong)?
            }
            SequenceEntry::List(_) if range.first.is_some() || range.last.is_some() => {
                return Err(wrong("first and last belong to a pattern; leave names out of the list instead".to_owned()));
            }
            SequenceEntry::List(names) => {
                Sequence::listed(names.clone(), &self.root).ok_or_else(|| wrong("a sequence needs one file or more".to_owned()))?
            }
        };
        edit.name.get_or_insert_with(|| files.title());
        let fps = match &entry.fps {
            Some(fps) if fps.get_ref().0 > 0.0 => fps.get_ref().0,
            Some(fps) => return Err(source.error_in(fps.span(), format!("fps is {}; it must be above 0", fps.get_ref().0))),
            None => crate::DEFAULT_FPS,
        };
        Ok(KeyTrack {
            sequence: Arc::new(files),
            fps,
            start: entry.start.map_or(0.0, |start| start.0),
            looped: entry.looped.unwrap_or(false),
            interpolate: entry.interpolate.unwrap_or(true),
            edit: edit.clone(),
            placed: None,
        })
    }

    fn transform(&self, entry: &MeshEntry) -> Result<Transform> {
        match self.matrix(entry)? {
            Some(_) if entry.translate.is_some() || entry.rotate.is_some() || entry.scale.is_some() => {
                let span = entry.matrix.as_ref().map(Spanned::span).unwrap_or_default();
                Err(self.source.error_in(span, "a mesh has a matrix, or translate, rotate and scale, not both"))
            }
            Some(matrix) => Ok(matrix),
            None => Ok(Transform::new(
                entry.scale.as_ref().map_or([1.0; 3], |scale| scale.get_ref().0).map(f64::from),
                entry.rotate.map_or([0.0; 3], plain).map(f64::from),
                entry.translate.map_or([0.0; 3], plain).map(f64::from),
            )),
        }
    }

    fn matrix(&self, entry: &MeshEntry) -> Result<Option<Transform>> {
        let Some(matrix) = &entry.matrix else { return Ok(None) };
        let rows: Vec<[f64; 4]> = matrix.get_ref().iter().map(|row| plain(*row).map(f64::from)).collect();
        Transform::from_rows(&rows).map(Some).ok_or_else(|| {
            self.source
                .error_in(matrix.span(), "matrix must be 3 rows of 4 numbers (or 4 rows, the last [0, 0, 0, 1]) and not flatten the mesh")
        })
    }

    fn refuse_sequence_keys(&self, entry: &MeshEntry, at: usize) -> Result<()> {
        let keys = [
            ("fps", entry.fps.is_some()),
            ("start", entry.start.is_some()),
            ("loop", entry.looped.is_some() && entry.key.is_empty()),
            ("clip", entry.clip.is_some()),
            ("interpolate", entry.interpolate.is_some()),
            ("first", entry.first.is_some()),
            ("last", entry.last.is_some()),
        ];
        match keys.iter().find(|(_, given)| *given) {
            Some((key, _)) => {
                let owner = match *key {
                    "clip" => "a glTF file",
                    "start" => "a sequence or a glTF file",
                    "loop" => "a sequence, keys or a glTF file",
                    _ => "a sequence",
                };
                Err(self.source.error(at, format!("{key} belongs to {owner}")))
            }
            None => Ok(()),
        }
    }

    fn refuse_shape_keys(&self, entry: &MeshEntry, at: usize) -> Result<()> {
        let keys = [
            ("radius", entry.radius.is_some()),
            ("tube", entry.tube.is_some()),
            ("size", entry.size.is_some()),
            ("segments", entry.segments.is_some()),
            ("triangles", entry.triangles.is_some()),
            ("seed", entry.seed.is_some()),
            ("corners", entry.corners.is_some()),
        ];
        match keys.iter().find(|(_, given)| *given) {
            Some((key, _)) => Err(self.source.error(at, format!("{key} belongs to a shape, not to a file"))),
            None => Ok(()),
        }
    }

    fn shape(&mut self, entry: &MeshEntry, shape: &Spanned<String>, at: usize) -> Result<Mesh> {
        let source = self.source;
        let kind = source.choose("shape", shape, &["sphere", "plane", "box", "quad", "torus", "knot", "soup", "bumpy"])?;
        let radius = entry.radius.as_ref().map(|radius| source.above_zero("radius", radius)).transpose()?.unwrap_or(1.0);
        let tube = entry.tube.as_ref().map(|tube| source.above_zero("tube", tube)).transpose()?.unwrap_or(radius * 0.3);
        let segments = entry.segments.as_ref().map(|segments| *segments.get_ref());
        let triangles = entry.triangles.as_ref().map_or(10_000, |triangles| *triangles.get_ref());
        let seed = u64::from(entry.seed.unwrap_or(1));
        let size = |count: usize| match entry.size.as_deref() {
            None => Ok(vec![1.0; count]),
            Some(size) if size.len() == count => Ok(size.iter().map(|value| value.0).collect()),
            Some(_) => Err(source.error(at, format!("size of a {} needs {count} numbers", shape.get_ref()))),
        };
        let segments_or = |default: u32| segments.unwrap_or(default);
        let (s, span) = (u64::from(segments.unwrap_or(64)), entry.segments.as_ref().map_or(shape.span(), Spanned::span));
        let count = match kind {
            0 | 4 | 5 => s.saturating_mul(s).saturating_mul(4),
            1 => u64::from(segments_or(1)).saturating_mul(s).saturating_mul(2),
            6 | 7 => u64::from(triangles),
            _ => 12,
        };
        self.generated = self.generated.saturating_add(count);
        if count > MAX_GENERATED_TRIANGLES || self.generated > MAX_GENERATED_TOTAL {
            return Err(source.error_in(
                span,
                format!("more than {MAX_GENERATED_TRIANGLES} triangles in a shape, or {MAX_GENERATED_TOTAL} in all; ask for fewer"),
            ));
        }
        let mut mesh = match kind {
            0 => generate::sphere([0.0; 3], radius, segments_or(64)),
            1 => {
                let size = size(2)?;
                generate::plane([size[0], size[1]], segments_or(1))
            }
            2 => {
                let size = size(3)?;
                generate::cuboid([size[0], size[1], size[2]])
            }
            3 => {
                let corners = entry.corners.ok_or_else(|| source.error(at, "a quad needs corners = [[x, y, z], ...], four of them"))?;
                generate::quad(corners.map(plain))
            }
            4 => generate::torus(radius, tube, segments_or(64)),
            5 => generate::knot(radius, tube, segments_or(64)),
            6 => generate::soup(triangles, seed),
            _ => generate::bumpy_sphere(triangles, seed),
        };
        mesh.name = shape.get_ref().clone();
        Ok(mesh)
    }
}
