//! A scene in device memory.

use crate::{Buffer, BufferDesc, BufferKind, Context, Error, Result, layout};
use bytemuck::NoUninit;
use gridwalk_scene::{Background, Light, Material, Scene, Texture};

/// A scene in device memory: geometry, materials, textures, lights, background.
#[derive(Debug)]
pub struct GpuScene {
    pub(crate) positions: Buffer,
    pub(crate) indices: Buffer,
    pub(crate) table: Buffer,
    /// Reached through the table alone.
    _others: Vec<Buffer>,
    vertex_count: u32,
    triangle_count: u32,
    light_count: u32,
    mesh_starts: Vec<u32>,
    has_masks: bool,
    has_mirrors: bool,
    bytes: u64,
}

impl GpuScene {
    /// Brings a scene to the device.
    ///
    /// # Errors
    /// [`Error::Scene`] when an index of the scene leads nowhere or a count exceeds what kernels can index; [`Error::OutOfDeviceMemory`]; those of
    /// [`Context::submit`].
    pub fn upload(context: &Context, scene: &Scene) -> Result<GpuScene> {
        let counts = check(scene)?;
        let mut bytes = 0;
        let mut buffer = |name: &'static str, size: u64| {
            let buffer = context.buffer(&BufferDesc { name, size, kind: BufferKind::Device, dedicated: false })?;
            bytes += buffer.size();
            Ok::<_, Error>(buffer)
        };
        let vertices = u64::from(counts.vertices);
        let triangles = u64::from(counts.triangles);
        let positions = buffer("scene positions", vertices * 12)?;
        let normals = buffer("scene normals", vertices * 12)?;
        let uvs = buffer("scene texture coordinates", vertices * 8)?;
        let indices = buffer("scene indices", triangles * 12)?;
        let surrounds = buffer("scene triangle materials", triangles * 8)?;
        let mut first_vertex = 0_u32;
        let mut mesh_starts = Vec::with_capacity(scene.meshes.len());
        let mut first_triangle = 0_u32;
        for (mesh_id, mesh) in (0..).zip(&scene.meshes) {
            mesh_starts.push(first_triangle);
            positions.write(u64::from(first_vertex) * 12, &mesh.positions)?;
            normals.write(u64::from(first_vertex) * 12, &mesh.normals)?;
            uvs.write(u64::from(first_vertex) * 8, &mesh.uvs)?;
            let shifted: Vec<[u32; 3]> = mesh.indices.iter().map(|corners| corners.map(|corner| corner + first_vertex)).collect();
            indices.write(u64::from(first_triangle) * 12, &shifted)?;
            let of_mesh: Vec<layout::Surround> =
                mesh.materials.iter().map(|&material| layout::Surround { material, mesh: mesh_id }).collect();
            surrounds.write(u64::from(first_triangle) * 8, &of_mesh)?;
            // In range: `check` has added them all up.
            first_vertex += mesh.positions.len() as u32;
            first_triangle += mesh.indices.len() as u32;
        }

        let texels = buffer("scene texels", counts.texels * 4)?;
        let mut textures = Vec::with_capacity(scene.textures.len());
        let mut first_texel = 0_u64;
        for texture in &scene.textures {
            texels.write(first_texel * 4, &texture.pixels)?;
            textures.push(layout::Texture {
                width: texture.width,
                height: texture.height,
                first_texel: first_texel as u32,
                srgb: u32::from(texture.srgb),
            });
            first_texel += u64::from(texture.width) * u64::from(texture.height);
        }

        let materials: Vec<layout::Material> = scene.materials.iter().map(|material| device_material(material, &scene.textures)).collect();
        let lights = scene.lights.iter().map(device_light).collect::<Result<Vec<_>>>()?;
        let (background, panorama) = device_background(&scene.background, scene.up)?;
        let mut others = vec![normals, uvs, surrounds, texels];
        let mut filled = |name: &'static str, data: &[u8]| {
            let made = buffer(name, data.len() as u64)?;
            made.write(0, data)?;
            let address = made.address();
            others.push(made);
            Ok::<_, Error>(address)
        };
        let table = layout::SceneTable {
            mesh_starts: filled("scene mesh starts", bytes_of(&mesh_starts))?,
            materials: filled("scene materials", bytes_of(&materials))?,
            textures: filled("scene textures", bytes_of(&textures))?,
            lights: filled("scene lights", bytes_of(&lights))?,
            panorama: filled("scene panorama", bytes_of(panorama))?,
            srgb: filled("sRGB table", bytes_of(&srgb_table()))?,
            positions: positions.address(),
            indices: indices.address(),
            normals: others[0].address(),
            uvs: others[1].address(),
            surrounds: others[2].address(),
            texels: others[3].address(),
            ambient: scene.ambient,
            triangle_count: counts.triangles,
            background,
        };
        let table_buffer = buffer("scene table", size_of::<layout::SceneTable>() as u64)?;
        table_buffer.write(0, &[table])?;
        Ok(GpuScene {
            positions,
            indices,
            table: table_buffer,
            _others: others,
            vertex_count: counts.vertices,
            triangle_count: counts.triangles,
            light_count: counts.lights,
            mesh_starts,
            has_masks: materials.iter().any(|material| material.opacity_map != layout::NO_MAP),
            has_mirrors: materials.iter().any(|material| material.flags & layout::MATERIAL_MIRROR != 0),
            bytes,
        })
    }

    /// Number of triangles of all meshes.
    pub fn triangle_count(&self) -> u32 {
        self.triangle_count
    }

    /// Number of vertices of all meshes.
    pub fn vertex_count(&self) -> u32 {
        self.vertex_count
    }

    /// Number of lights.
    pub fn light_count(&self) -> u32 {
        self.light_count
    }

    /// First triangle of each mesh: the triangle of a hit counts over all meshes.
    pub fn mesh_starts(&self) -> &[u32] {
        &self.mesh_starts
    }

    /// The mesh of a triangle, and the triangle's number within it.
    pub fn locate(&self, triangle: u32) -> Option<(u32, u32)> {
        if triangle >= self.triangle_count {
            return None;
        }
        let mesh = self.mesh_starts.partition_point(|&start| start <= triangle).checked_sub(1)?;
        Some((u32::try_from(mesh).ok()?, triangle - self.mesh_starts.get(mesh)?))
    }

    /// Whether any material has holes.
    pub fn has_masks(&self) -> bool {
        self.has_masks
    }

    /// Whether any material reflects as a mirror.
    pub fn has_mirrors(&self) -> bool {
        self.has_mirrors
    }

    /// Brings the positions back to the host, as the grid is built of them; those that no triangle names may hold anything.
    ///
    /// # Errors
    /// Those of [`Buffer::read`].
    pub fn read_positions(&self) -> Result<Vec<[f32; 3]>> {
        self.positions.read(0, self.vertex_count as usize)
    }

    /// Brings the triangles of all meshes back to the host.
    ///
    /// # Errors
    /// Those of [`Buffer::read`].
    pub fn read_indices(&self) -> Result<Vec<[u32; 3]>> {
        self.indices.read(0, self.triangle_count as usize)
    }

    /// Bytes of device memory.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

fn bytes_of<T: NoUninit>(data: &[T]) -> &[u8] {
    bytemuck::cast_slice(data)
}

struct Counts {
    vertices: u32,
    triangles: u32,
    lights: u32,
    texels: u64,
}

/// Every index that a kernel will follow.
fn check(scene: &Scene) -> Result<Counts> {
    let bad = |reason: String| Error::Scene { reason };
    let (mut vertices, mut triangles, mut texels) = (0_u64, 0_u64, 0_u64);
    for mesh in &scene.meshes {
        let count = mesh.positions.len();
        if mesh.normals.len() != count || mesh.uvs.len() != count {
            return Err(bad(format!(
                "mesh {}: {} normals and {} texture coordinates for {count} positions",
                mesh.name,
                mesh.normals.len(),
                mesh.uvs.len()
            )));
        }
        if mesh.materials.len() != mesh.indices.len() {
            return Err(bad(format!("mesh {}: {} materials for {} triangles", mesh.name, mesh.materials.len(), mesh.indices.len())));
        }
        if let Some(index) = mesh.indices.as_flattened().iter().find(|&&index| index as usize >= count) {
            return Err(bad(format!("mesh {}: vertex {index} of {count}", mesh.name)));
        }
        if let Some(material) = mesh.materials.iter().find(|&&material| material as usize >= scene.materials.len()) {
            return Err(bad(format!("mesh {}: material {material} of {}", mesh.name, scene.materials.len())));
        }
        vertices += count as u64;
        triangles += mesh.indices.len() as u64;
    }
    for texture in &scene.textures {
        let size = u64::from(texture.width) * u64::from(texture.height);
        if size == 0 || size.checked_mul(4) != Some(texture.pixels.len() as u64) {
            return Err(bad(format!(
                "texture {}: {} bytes for {} x {} pixels",
                texture.name,
                texture.pixels.len(),
                texture.width,
                texture.height
            )));
        }
        texels += size;
    }
    for material in &scene.materials {
        let maps = [material.diffuse_map, material.specular_map, material.emission_map, material.opacity_map, material.normal_map];
        if let Some(map) = maps.into_iter().flatten().find(|&map| map as usize >= scene.textures.len()) {
            return Err(bad(format!("material {}: texture {map} of {}", material.name, scene.textures.len())));
        }
    }
    let bounded = |what: &str, count: u64, most: u32| match u32::try_from(count) {
        Ok(count) if count <= most => Ok(count),
        _ => Err(bad(format!("{count} {what}; {most} are possible"))),
    };
    bounded("texels", texels, MAX_WORDS)?;
    Ok(Counts {
        vertices: bounded("vertices", vertices, gridwalk::MAX_VERTICES)?,
        triangles: bounded("triangles", triangles, gridwalk::MAX_TRIANGLES)?,
        lights: bounded("lights", scene.lights.len() as u64, MAX_WORDS)?,
        texels,
    })
}

/// Words of an array that a kernel can index: SPIR-V takes indices as signed.
const MAX_WORDS: u32 = i32::MAX as u32;

fn device_material(material: &Material, textures: &[Texture]) -> layout::Material {
    let mut flags = 0;
    if material.illumination >= 3 && material.specular.iter().any(|&value| value > 0.0) {
        flags |= layout::MATERIAL_MIRROR;
    }
    if material.normal_map_is_height {
        flags |= layout::MATERIAL_HEIGHT_MAP;
    }
    // A mask without a hole is none: such a scene is traced by the library's own kernels, which are faster.
    let opacity_map = material.opacity_map.filter(|&map| {
        textures
            .get(map as usize)
            .is_some_and(|texture| texture.pixels.chunks_exact(4).any(|texel| f32::from(texel[3]) / 255.0 * material.opacity < 0.5))
    });
    let map = |map: Option<u32>| map.unwrap_or(layout::NO_MAP);
    layout::Material {
        diffuse: material.diffuse,
        shininess: material.shininess,
        specular: material.specular,
        flags,
        emission: material.emission,
        opacity: material.opacity,
        diffuse_map: map(material.diffuse_map),
        specular_map: map(material.specular_map),
        emission_map: map(material.emission_map),
        opacity_map: map(opacity_map),
        normal_map: map(material.normal_map),
        bump_scale: material.bump_scale,
        reserved0: 0,
        reserved1: 0,
    }
}

fn device_light(light: &Light) -> Result<layout::Light> {
    Ok(match *light {
        Light::Point { position, intensity } => {
            layout::Light { position, kind: layout::LIGHT_POINT, direction: [0.0; 3], cos_inner: 0.0, intensity, cos_outer: 0.0 }
        }
        Light::Directional { direction, irradiance } => layout::Light {
            position: [0.0; 3],
            kind: layout::LIGHT_DIRECTIONAL,
            direction,
            cos_inner: 0.0,
            intensity: irradiance,
            cos_outer: 0.0,
        },
        Light::Spot { position, direction, intensity, inner_degrees, outer_degrees } => layout::Light {
            position,
            kind: layout::LIGHT_SPOT,
            direction,
            cos_inner: inner_degrees.to_radians().cos(),
            intensity,
            cos_outer: outer_degrees.to_radians().cos(),
        },
        _ => return Err(Error::Scene { reason: "a kind of light that this version does not know".to_owned() }),
    })
}

fn device_background(background: &Background, up: [f32; 3]) -> Result<(layout::Background, &[[f32; 3]])> {
    let mut result = layout::Background { up, front: front(up), ..layout::Background::default() };
    let mut panorama: &[[f32; 3]] = &[];
    match background {
        Background::Colour(colour) => {
            result.kind = layout::BACKGROUND_COLOUR;
            result.bottom = *colour;
        }
        Background::Gradient { bottom, top } => {
            result.kind = layout::BACKGROUND_GRADIENT;
            result.bottom = *bottom;
            result.top = *top;
        }
        Background::Equirectangular { width, height, pixels, rotation_degrees } => {
            let count = u64::from(*width) * u64::from(*height);
            if count == 0 || count != pixels.len() as u64 || count > u64::from(MAX_WORDS / 3) {
                return Err(Error::Scene { reason: format!("the background has {} pixels for {width} x {height}", pixels.len()) });
            }
            result.kind = layout::BACKGROUND_PANORAMA;
            result.width = *width;
            result.height = *height;
            result.rotation = rotation_degrees / 360.0;
            panorama = pixels;
        }
        _ => return Err(Error::Scene { reason: "a kind of background that this version does not know".to_owned() }),
    }
    Ok((result, panorama))
}

/// The z axis of the frame in which a panorama hangs: +Z where Y is up, -Y where Z is up, as the automatic camera has it; at a right angle
/// to `up`.
fn front(up: [f32; 3]) -> [f32; 3] {
    let axis = if up[2].abs() > 0.9 { [0.0, -up[2].signum(), 0.0] } else { [0.0, 0.0, 1.0] };
    let along: f32 = (0..3).map(|i| axis[i] * up[i]).sum();
    let across: [f32; 3] = std::array::from_fn(|i| axis[i] - up[i] * along);
    let length = across.iter().map(|value| value * value).sum::<f32>().sqrt();
    if length > 0.0 { across.map(|value| value / length) } else { [0.0, 0.0, 1.0] }
}

/// Linear value of each sRGB code (IEC 61966-2-1).
fn srgb_table() -> [f32; 256] {
    std::array::from_fn(|code| {
        let value = code as f64 / 255.0;
        (if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }) as f32
    })
}
