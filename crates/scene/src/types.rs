//! What a scene is once it is read: plain vectors in world space, every index checked.

/// A whole scene in world space, with every reference between its parts resolved.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Geometries, in the order in which the scene names them. The index here is the geometry id of a hit.
    pub meshes: Vec<Mesh>,
    /// Materials; never empty in a scene that was loaded. Entry 0 is the default material.
    pub materials: Vec<Material>,
    /// Textures, each file once per use (colour or data).
    pub textures: Vec<Texture>,
    /// Lights; a scene that names none gets a key light and a fill light.
    pub lights: Vec<Light>,
    /// Light that reaches every surface point from everywhere, as linear RGB radiance: shading adds `ambient * diffuse`.
    pub ambient: [f32; 3],
    /// Cameras by name, in the order of the file; empty where the scene names none: see [`Scene::camera`].
    pub cameras: Vec<NamedCamera>,
    /// What a ray sees that leaves the scene.
    pub background: Background,
    /// What the scene wants of a rendering where the user says nothing.
    pub defaults: RenderDefaults,
    /// The direction that the scene calls up, of length one.
    pub up: [f32; 3],
    /// Everything odd that was read over, one sentence each, with file and line where there is one.
    pub warnings: Vec<String>,
}

/// One geometry: triangles over shared vertices, in file order. An OBJ file is one mesh whatever its groups, so that the number of a
/// triangle is its place in the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The name in the scene, or the file's name without its ending.
    pub name: String,
    /// Vertex positions in world space. May hold values that are not finite: the grid drops and counts such triangles.
    pub positions: Vec<[f32; 3]>,
    /// Shading normals of length one, one a vertex; computed where the file has none.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates, one a vertex, zeros where the file has none. (0, 0) is the lower left corner of a picture.
    pub uvs: Vec<[f32; 2]>,
    /// Colours that multiply the diffuse colour of the material, of one that is [`Material::unlit`] the emission; linear RGB, one a vertex;
    /// empty where the file has none, which is as if all were one.
    pub colours: Vec<[f32; 3]>,
    /// Opacities that multiply that of the material where that is [`Material::blend`], from 0 to 1, one a vertex; empty where the file has
    /// none, which is as if all were one.
    pub opacities: Vec<f32>,
    /// Three vertex indices a triangle, each below `positions.len()`.
    pub indices: Vec<[u32; 3]>,
    /// One index into [`Scene::materials`] a triangle.
    pub materials: Vec<u32>,
}

/// A surface, in the terms of MTL files. Colours are linear RGB.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name after `newmtl`, or in the scene file.
    pub name: String,
    /// `Kd`, multiplied with `diffuse_map`.
    pub diffuse: [f32; 3],
    /// `Ks`, multiplied with `specular_map`.
    pub specular: [f32; 3],
    /// `Ns`, the Blinn-Phong exponent, 0 or more.
    pub shininess: f32,
    /// `Ke`, emitted radiance, multiplied with `emission_map`.
    pub emission: [f32; 3],
    /// `d` (or 1 - `Tr`), 0 to 1, multiplied with `opacity_map`.
    pub opacity: f32,
    /// Whether what lies behind is seen through the surface by the share that its opacity leaves, and lit through it; else a surface with an
    /// `opacity_map` is cut where its opacity is below one half, and one without is solid whatever its opacity.
    pub blend: bool,
    /// Whether [`Mesh::colours`] multiply the emission, as the colour of a surface that shows it without any light (`KHR_materials_unlit`).
    pub unlit: bool,
    /// `Ni`.
    pub index_of_refraction: f32,
    /// `illum`: 3 and above reflects as a mirror, weighted by `specular`.
    pub illumination: u32,
    /// Texture of `map_Kd`; [`Texture::srgb`] is set.
    pub diffuse_map: Option<u32>,
    /// Texture of `map_Ks`; [`Texture::srgb`] is set.
    pub specular_map: Option<u32>,
    /// Texture of `map_Ke`; [`Texture::srgb`] is set.
    pub emission_map: Option<u32>,
    /// Texture of `map_d`, or of the alpha channel of `map_Kd` where that has one and `map_d` is absent. All four channels of every texel
    /// hold the opacity, so that it does not matter which of them is read.
    pub opacity_map: Option<u32>,
    /// Texture of `map_bump`, `bump` or `norm`; not sRGB.
    pub normal_map: Option<u32>,
    /// Whether `normal_map` holds heights (`bump`) or normals (`norm`).
    pub normal_map_is_height: bool,
    /// `-bm` of the bump map, a factor on its heights.
    pub bump_scale: f32,
}

impl Default for Material {
    /// The grey of surfaces that no file describes.
    fn default() -> Self {
        Self {
            name: "default".to_owned(),
            diffuse: [0.7, 0.7, 0.7],
            specular: [0.0; 3],
            shininess: 10.0,
            emission: [0.0; 3],
            opacity: 1.0,
            blend: false,
            unlit: false,
            index_of_refraction: 1.0,
            illumination: 1,
            diffuse_map: None,
            specular_map: None,
            emission_map: None,
            opacity_map: None,
            normal_map: None,
            normal_map_is_height: false,
            bump_scale: 1.0,
        }
    }
}

/// A picture to be looked up by texture coordinates, repeated in both directions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texture {
    /// The file as the scene names it.
    pub name: String,
    /// Columns, 1 or more.
    pub width: u32,
    /// Rows, 1 or more.
    pub height: u32,
    /// RGBA, 8 bits a channel, `4 * width * height` bytes, row by row from the top row (v near 1) to the bottom row (v near 0).
    pub pixels: Vec<u8>,
    /// Whether red, green and blue are sRGB-coded (colours) or linear (masks, normals). Alpha is always linear.
    pub srgb: bool,
    /// Whether any texel's alpha is below 255.
    pub has_alpha: bool,
}

/// A light without extent. All values are linear RGB. A diffuse surface reflects `diffuse * irradiance * cosine / π` of it, so that white paper
/// looks white (radiance 1) under an irradiance of π.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Light {
    /// Light from one point in all directions: irradiance = `intensity` / distance², times the cosine.
    Point {
        /// In world space.
        position: [f32; 3],
        /// Radiant intensity.
        intensity: [f32; 3],
    },
    /// Light from infinitely far away.
    Directional {
        /// Where the light goes to (from the light into the scene), of length one.
        direction: [f32; 3],
        /// Irradiance of a surface that faces the light.
        irradiance: [f32; 3],
    },
    /// A point light in a cone.
    Spot {
        /// In world space.
        position: [f32; 3],
        /// The cone's axis, from the light into the scene, of length one.
        direction: [f32; 3],
        /// Radiant intensity on the axis.
        intensity: [f32; 3],
        /// Half angle in degrees within which the light is full, at most `outer_degrees`.
        inner_degrees: f32,
        /// Half angle in degrees beyond which there is none, at most 90; smoothstep of the angles' cosines in between.
        outer_degrees: f32,
    },
}

/// Where the picture is taken from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position in world space.
    pub eye: [f32; 3],
    /// The point in the middle of the picture; differs from `eye`.
    pub target: [f32; 3],
    /// Roughly up; not parallel to the view direction.
    pub up: [f32; 3],
    /// Angle between the lower and the upper edge of the picture, above 0 and below 180. Not used by an orthographic camera.
    pub vertical_fov_degrees: f32,
    /// Height of the picture in world units for parallel projection; `None` is perspective.
    pub orthographic_height: Option<f32>,
}

/// A camera that a scene file names.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedCamera {
    /// Unique within the scene.
    pub name: String,
    /// The camera.
    pub camera: Camera,
}

/// What a ray sees that leaves the scene. Linear RGB radiance.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Background {
    /// The same in all directions.
    Colour([f32; 3]),
    /// `bottom + (top - bottom) * (dot(direction, up) + 1) / 2`, with `up` from [`Scene::up`].
    Gradient {
        /// Straight down.
        bottom: [f32; 3],
        /// Straight up.
        top: [f32; 3],
    },
    /// A panorama around the scene's up axis. With u = 0.5 + atan2(x, -z) / 2π and v = 0.5 + asin(y) / π of a direction of length one
    /// (y up), u runs along a row from the left, v from the bottom row upwards: the middle of the picture is towards -z.
    Equirectangular {
        /// Columns, 1 or more.
        width: u32,
        /// Rows, 1 or more.
        height: u32,
        /// `width * height` pixels, row by row from the top; finite and not negative, any factor of the scene file already applied.
        pixels: Vec<[f32; 3]>,
        /// Turns the panorama about the up axis: added to u, in degrees.
        rotation_degrees: f32,
    },
}

impl Default for Background {
    fn default() -> Self {
        Self::Colour([0.0; 3])
    }
}

/// What a scene file says about rendering; the command line goes before it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RenderDefaults {
    /// Width and height in pixels, each 1 or more.
    pub size: Option<[u32; 2]>,
    /// Samples a pixel, 1 or more.
    pub spp: Option<u32>,
    /// Reflections that are followed; 0 is none.
    pub depth: Option<u32>,
    /// In stops: a factor of 2 to this power.
    pub exposure: Option<f32>,
    /// One of [`TONEMAPS`].
    pub tonemap: Option<String>,
    /// The grid's density k, above 0.
    pub density: Option<f32>,
    /// Name of a camera in [`Scene::cameras`].
    pub camera: Option<String>,
}

/// The names of tone mapping operators that a scene file may use.
pub const TONEMAPS: [&str; 5] = ["none", "reinhard", "aces", "agx", "neutral"];

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Least coordinates.
    pub min: [f32; 3],
    /// Greatest coordinates.
    pub max: [f32; 3],
}

impl Mesh {
    /// What the vectors hold, in bytes.
    pub(crate) fn byte_count(&self) -> u64 {
        let bytes = size_of_val(&*self.positions)
            + size_of_val(&*self.normals)
            + size_of_val(&*self.uvs)
            + size_of_val(&*self.colours)
            + size_of_val(&*self.opacities)
            + size_of_val(&*self.indices)
            + size_of_val(&*self.materials);
        bytes as u64
    }

    /// The box of all triangles whose vertices are finite; `None` where there is no such triangle.
    pub fn bounds(&self) -> Option<Bounds> {
        self.bounds_at(&self.positions)
    }

    /// The same with its vertices elsewhere.
    pub(crate) fn bounds_at(&self, positions: &[[f32; 3]]) -> Option<Bounds> {
        let mut bounds: Option<Bounds> = None;
        for triangle in &self.indices {
            let corners = triangle.map(|index| positions.get(index as usize).copied().unwrap_or([f32::NAN; 3]));
            if corners.as_flattened().iter().all(|value| value.is_finite()) {
                for corner in corners {
                    bounds = Some(bounds.map_or(Bounds { min: corner, max: corner }, |bounds| bounds.with(corner)));
                }
            }
        }
        bounds
    }
}

impl Bounds {
    /// What stands for a scene without triangles.
    pub(crate) const UNIT: Self = Self { min: [-0.5; 3], max: [0.5; 3] };

    fn with(self, point: [f32; 3]) -> Self {
        Self {
            min: std::array::from_fn(|axis| self.min[axis].min(point[axis])),
            max: std::array::from_fn(|axis| self.max[axis].max(point[axis])),
        }
    }

    /// The smallest box that holds both.
    pub fn union(self, other: Self) -> Self {
        self.with(other.min).with(other.max)
    }
}

impl Scene {
    /// The box of all finite triangles; `None` where there is none.
    pub fn bounds(&self) -> Option<Bounds> {
        self.meshes.iter().filter_map(Mesh::bounds).reduce(Bounds::union)
    }

    /// Number of triangles of all meshes.
    pub fn triangle_count(&self) -> u64 {
        self.meshes.iter().map(|mesh| mesh.indices.len() as u64).sum()
    }

    /// The camera of that name, or without a name the one in [`RenderDefaults::camera`], else the first, else one that frames the scene.
    /// `None` only where a name is given that no camera has.
    pub fn camera(&self, name: Option<&str>) -> Option<Camera> {
        match (self.camera_number(name), name) {
            (Some(number), _) => self.cameras.get(number).map(|camera| camera.camera),
            (None, Some(_)) => None,
            (None, None) => Some(self.frame(&crate::Framing { up: self.up, ..crate::Framing::default() })),
        }
    }

    /// Which of the cameras [`Scene::camera`] takes; `None` where it takes none of them.
    pub(crate) fn camera_number(&self, name: Option<&str>) -> Option<usize> {
        let find = |name: &str| self.cameras.iter().position(|camera| camera.name == name);
        match name {
            Some(name) => find(name),
            None => self.defaults.camera.as_deref().and_then(find).or_else(|| (!self.cameras.is_empty()).then_some(0)),
        }
    }

    /// A camera that frames the whole scene; a scene without triangles is framed as a unit cube.
    pub fn frame(&self, framing: &crate::Framing) -> Camera {
        crate::frame_camera(&self.bounds().unwrap_or(Bounds::UNIT), framing)
    }
}
