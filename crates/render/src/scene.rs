//! A scene in device memory.

use crate::{Buffer, BufferDesc, BufferKind, Context, Error, Result, layout};
use ash::vk;
use gridwalk::Geometry;
use gridwalk_scene::{Background, Light, Material, Mesh, Scene, Texture};
use std::collections::HashMap;

/// A scene in device memory: geometry, materials, textures, lights, background.
#[derive(Debug)]
pub struct GpuScene {
    arrays: Arrays,
    surfaces: Surfaces,
    lights: Buffer,
    mesh_starts: Buffer,
    table: Buffer,
    /// Reached through the table alone.
    _panorama: Buffer,
    _srgb: Buffer,
    /// Vertices of each mesh, and where they begin: their ranges may have room for more.
    ranges: Vec<VertexRange>,
    triangle_count: u32,
    starts: Vec<u32>,
    host_lights: Vec<layout::Light>,
    host_table: layout::SceneTable,
    /// What of it the device does not have yet.
    stale: Stale,
}

/// A mesh's part of the arrays of vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct VertexRange {
    pub(crate) first: u32,
    pub(crate) count: u32,
    /// Vertices that the range has room for.
    pub(crate) room: u32,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Stale {
    table: bool,
    lights: bool,
    starts: bool,
}

/// What there is of each vertex and of each triangle.
#[derive(Debug)]
pub(crate) struct Arrays {
    pub(crate) positions: Buffer,
    pub(crate) normals: Buffer,
    pub(crate) uvs: Buffer,
    pub(crate) indices: Buffer,
    pub(crate) surrounds: Buffer,
    /// None where no mesh has any.
    pub(crate) colours: Option<Buffer>,
    /// None where no mesh has any. Meshes of key-frames never have: theirs are one.
    opacities: Option<Buffer>,
    vertices: u32,
    triangles: u32,
}

impl Arrays {
    /// Room for so many vertices and triangles, with colours and opacities of vertices or without.
    pub(crate) fn new(context: &Context, vertices: u32, triangles: u32, has_colours: bool, has_opacities: bool) -> Result<Arrays> {
        let buffer = |name, count: u32, size: u64| {
            context.buffer(&BufferDesc { name, size: u64::from(count) * size, kind: BufferKind::Device, dedicated: false })
        };
        let opacities = if has_opacities { Some(buffer("scene opacities", vertices, 4)?) } else { None };
        if let Some(opacities) = &opacities {
            opacities.write(0, &vec![1.0_f32; vertices as usize])?;
        }
        Ok(Arrays {
            positions: buffer("scene positions", vertices, 12)?,
            normals: buffer("scene normals", vertices, 12)?,
            uvs: buffer("scene texture coordinates", vertices, 8)?,
            indices: buffer("scene indices", triangles, 12)?,
            surrounds: buffer("scene triangle materials", triangles, 8)?,
            colours: if has_colours { Some(buffer("scene colours", vertices, 12)?) } else { None },
            opacities,
            vertices,
            triangles,
        })
    }

    /// Number of buffers.
    pub(crate) fn count(&self) -> u32 {
        5 + u32::from(self.colours.is_some()) + u32::from(self.opacities.is_some())
    }

    pub(crate) fn has_opacities(&self) -> bool {
        self.opacities.is_some()
    }

    pub(crate) fn write_vertices(&self, mesh: &Mesh, first_vertex: u32) -> Result<()> {
        let first = u64::from(first_vertex);
        self.positions.write(first * 12, &mesh.positions)?;
        self.normals.write(first * 12, &mesh.normals)?;
        self.uvs.write(first * 8, &mesh.uvs)?;
        if let Some(opacities) = &self.opacities {
            // Empty ones are one already.
            opacities.write(first * 4, &mesh.opacities)?;
        }
        match &self.colours {
            Some(colours) if mesh.colours.is_empty() => colours.write(first * 12, &vec![[1.0_f32; 3]; mesh.positions.len()]),
            Some(colours) => colours.write(first * 12, &mesh.colours),
            None => Ok(()),
        }
    }

    /// The sum of an index and `first_vertex` is within what `check` has allowed.
    pub(crate) fn write_triangles(&self, mesh: &Mesh, mesh_id: u32, first_vertex: u32, first_triangle: u32) -> Result<()> {
        let first = u64::from(first_triangle);
        let shifted: Vec<[u32; 3]> = mesh.indices.iter().map(|corners| corners.map(|corner| corner + first_vertex)).collect();
        self.indices.write(first * 12, &shifted)?;
        let surrounds: Vec<layout::Surround> =
            mesh.materials.iter().map(|&material| layout::Surround { material, mesh: mesh_id }).collect();
        self.surrounds.write(first * 8, &surrounds)
    }

    pub(crate) fn triangle_room(&self) -> u32 {
        self.triangles
    }

    fn bytes(&self) -> u64 {
        let always = [&self.positions, &self.normals, &self.uvs, &self.indices, &self.surrounds];
        always.into_iter().chain(&self.colours).chain(&self.opacities).map(Buffer::size).sum()
    }
}

/// Materials and textures, of which key-frames may bring more.
#[derive(Debug)]
struct Surfaces {
    materials: Buffer,
    textures: Buffer,
    texels: Buffer,
    material_count: usize,
    texture_count: usize,
    texel_count: u64,
    has_masks: bool,
    has_mirrors: bool,
    has_blends: bool,
    /// Of vertices, whatever the material.
    has_opacities: bool,
    /// Of each name the first material that the scene had from the beginning.
    numbers: HashMap<String, u32>,
}

impl Surfaces {
    fn new(context: &Context, scene: &Scene) -> Result<Surfaces> {
        let none = |name| context.buffer(&BufferDesc { name, size: 0, kind: BufferKind::Device, dedicated: false });
        let mut surfaces = Surfaces {
            materials: none("scene materials")?,
            textures: none("scene textures")?,
            texels: none("scene texels")?,
            material_count: 0,
            texture_count: 0,
            texel_count: 0,
            has_masks: false,
            has_mirrors: false,
            has_blends: false,
            has_opacities: has_opacities(scene),
            numbers: HashMap::new(),
        };
        for (number, material) in (0..).zip(&scene.materials) {
            surfaces.numbers.entry(material.name.clone()).or_insert(number);
        }
        surfaces.append(context, scene, false)?;
        Ok(surfaces)
    }

    /// The number in the layer `id` of a material that a key-frame has added: that of the scene's own material of its name, or else one that
    /// is made of the name. So it does not depend on which key-frames were read before.
    fn late_number(&self, name: &str) -> u32 {
        self.numbers.get(name).copied().unwrap_or_else(|| {
            // FNV-1a.
            let hash = name.bytes().fold(0x811C_9DC5_u32, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193));
            // Above the numbers of any table, and not what stands for the background.
            (hash | 1 << 31).min(u32::MAX - 1)
        })
    }

    /// Brings the materials and textures to the device that it does not have yet; the scene was checked. With `slack`, what must grow grows
    /// by a quarter at least. Returns the number of buffers that were made anew.
    fn append(&mut self, context: &Context, scene: &Scene, slack: bool) -> Result<u32> {
        let added = scene.materials.get(self.material_count..).unwrap_or_default();
        let is_first = self.material_count == 0;
        let number = |(at, material): (usize, &Material)| if is_first { at as u32 } else { self.late_number(&material.name) };
        let materials: Vec<layout::Material> = added
            .iter()
            .enumerate()
            .map(|(at, material)| layout::Material {
                number: number((at, material)),
                ..device_material(material, &scene.textures, self.has_opacities)
            })
            .collect();
        let mut first_texel = self.texel_count;
        let mut textures = Vec::new();
        let new_textures = scene.textures.get(self.texture_count..).unwrap_or_default();
        for texture in new_textures {
            // In range: the check has bounded the sum.
            let first = first_texel as u32;
            textures.push(layout::Texture {
                width: texture.width,
                height: texture.height,
                first_texel: first,
                srgb: u32::from(texture.srgb),
            });
            first_texel += u64::from(texture.width) * u64::from(texture.height);
        }
        let mut grown = 0;
        let mut room = |buffer: &mut Buffer, used: u64, needed: u64| {
            if needed <= buffer.size() {
                return Ok::<_, Error>(());
            }
            let size = if slack { with_slack(needed, buffer.size()) } else { needed };
            let name = buffer.name().to_owned();
            let larger = context.buffer(&BufferDesc { name: &name, size, kind: BufferKind::Device, dedicated: false })?;
            context.copy(buffer, 0, &larger, 0, used)?;
            *buffer = larger;
            grown += 1;
            Ok(())
        };
        let material_bytes = |count: usize| (count * size_of::<layout::Material>()) as u64;
        let texture_bytes = |count: usize| (count * size_of::<layout::Texture>()) as u64;
        room(&mut self.materials, material_bytes(self.material_count), material_bytes(scene.materials.len()))?;
        room(&mut self.textures, texture_bytes(self.texture_count), texture_bytes(scene.textures.len()))?;
        room(&mut self.texels, self.texel_count * 4, first_texel * 4)?;
        self.materials.write(material_bytes(self.material_count), &materials)?;
        self.textures.write(texture_bytes(self.texture_count), &textures)?;
        for (texture, placed) in new_textures.iter().zip(&textures) {
            self.texels.write(u64::from(placed.first_texel) * 4, &texture.pixels)?;
        }
        let is_blended = |material: &layout::Material| material.flags & layout::MATERIAL_BLEND != 0;
        self.has_masks |= materials.iter().any(|material| !is_blended(material) && material.opacity_map != layout::NO_MAP);
        self.has_mirrors |= materials.iter().any(|material| material.flags & layout::MATERIAL_MIRROR != 0);
        self.has_blends |= materials.iter().any(is_blended);
        self.material_count = scene.materials.len();
        self.texture_count = scene.textures.len();
        self.texel_count = first_texel;
        Ok(grown)
    }
}

/// What is made instead of memory of `now` that must hold `needed`: more than just enough, so that what grows does so rarely.
pub(crate) fn with_slack(needed: u64, now: u64) -> u64 {
    needed.max(now.saturating_add(now / 4))
}

impl GpuScene {
    /// Brings a scene to the device.
    ///
    /// # Errors
    /// [`Error::Scene`] when an index of the scene leads nowhere or a count exceeds what kernels can index; [`Error::OutOfDeviceMemory`]; those of
    /// [`Context::submit`].
    pub fn upload(context: &Context, scene: &Scene) -> Result<GpuScene> {
        let counts = check(scene)?;
        let arrays = Arrays::new(
            context,
            counts.vertices,
            counts.triangles,
            scene.meshes.iter().any(|mesh| !mesh.colours.is_empty()),
            has_opacities(scene),
        )?;
        let mut ranges = Vec::with_capacity(scene.meshes.len());
        let mut starts = Vec::with_capacity(scene.meshes.len());
        let (mut first_vertex, mut first_triangle) = (0, 0);
        for (mesh_id, mesh) in (0..).zip(&scene.meshes) {
            arrays.write_vertices(mesh, first_vertex)?;
            arrays.write_triangles(mesh, mesh_id, first_vertex, first_triangle)?;
            // In range: `check` has added them all up.
            let count = mesh.positions.len() as u32;
            ranges.push(VertexRange { first: first_vertex, count, room: count });
            starts.push(first_triangle);
            first_vertex += count;
            first_triangle += mesh.indices.len() as u32;
        }
        let surfaces = Surfaces::new(context, scene)?;
        let lights = scene.lights.iter().map(device_light).collect::<Result<Vec<_>>>()?;
        let (background, panorama) = device_background(&scene.background, scene.up)?;
        let panorama = context.upload("scene panorama", panorama)?;
        let srgb = context.upload("sRGB table", &srgb_table())?;
        let table = layout::SceneTable {
            panorama: panorama.address(),
            srgb: srgb.address(),
            ambient: scene.ambient,
            triangle_count: counts.triangles,
            background,
            ..layout::SceneTable::default()
        };
        let mut gpu = GpuScene {
            arrays,
            surfaces,
            lights: context.upload("scene lights", &lights)?,
            mesh_starts: context.upload("scene mesh starts", &starts)?,
            table: context.upload("scene table", &[table])?,
            _panorama: panorama,
            _srgb: srgb,
            ranges,
            triangle_count: counts.triangles,
            starts,
            host_lights: lights,
            host_table: table,
            stale: Stale::default(),
        };
        gpu.link();
        gpu.table.write(0, &[gpu.host_table])?;
        gpu.stale = Stale::default();
        Ok(gpu)
    }

    /// Puts the addresses and counts into the host's table.
    fn link(&mut self) {
        let table = layout::SceneTable {
            positions: self.arrays.positions.address(),
            indices: self.arrays.indices.address(),
            normals: self.arrays.normals.address(),
            uvs: self.arrays.uvs.address(),
            surrounds: self.arrays.surrounds.address(),
            colours: self.arrays.colours.as_ref().map_or(0, Buffer::address),
            opacities: self.arrays.opacities.as_ref().map_or(0, Buffer::address),
            mesh_starts: self.mesh_starts.address(),
            materials: self.surfaces.materials.address(),
            textures: self.surfaces.textures.address(),
            texels: self.surfaces.texels.address(),
            lights: self.lights.address(),
            triangle_count: self.triangle_count,
            ..self.host_table
        };
        self.stale.table |= bytemuck::bytes_of(&table) != bytemuck::bytes_of(&self.host_table);
        self.host_table = table;
    }

    pub(crate) fn arrays(&self) -> &Arrays {
        &self.arrays
    }

    pub(crate) fn ranges(&self) -> &[VertexRange] {
        &self.ranges
    }

    /// Address of the table that kernels take.
    pub(crate) fn table(&self) -> u64 {
        self.table.address()
    }

    /// Puts other arrays in place of those there are, for ranges of other sizes. What they hold is the caller's matter.
    pub(crate) fn replace_arrays(&mut self, arrays: Arrays, ranges: Vec<VertexRange>) {
        self.arrays = arrays;
        self.ranges = ranges;
        self.link();
    }

    /// Tells how many vertices and triangles each mesh has now. The arrays have room for them.
    pub(crate) fn set_counts(&mut self, vertices: &[u32], starts: &[u32], triangle_count: u32) {
        for (range, &count) in self.ranges.iter_mut().zip(vertices) {
            range.count = count;
        }
        if self.starts != starts {
            self.starts.clear();
            self.starts.extend_from_slice(starts);
            self.stale.starts = true;
        }
        self.triangle_count = triangle_count;
        self.link();
    }

    /// Takes other lights, as many as there were.
    pub(crate) fn set_lights(&mut self, lights: &[Light]) -> Result<()> {
        if lights.len() != self.host_lights.len() {
            let reason = format!("it has {} lights at one time and {} at another", self.host_lights.len(), lights.len());
            return Err(Error::Scene { reason });
        }
        for (host, light) in self.host_lights.iter_mut().zip(lights) {
            let light = device_light(light)?;
            self.stale.lights |= bytemuck::bytes_of(host) != bytemuck::bytes_of(&light);
            *host = light;
        }
        Ok(())
    }

    /// Brings materials and textures to the device that were added to the scene that it was made of. Returns the number of buffers that
    /// were made anew.
    pub(crate) fn append_surfaces(&mut self, context: &Context, scene: &Scene) -> Result<u32> {
        if self.surfaces.material_count == scene.materials.len() && self.surfaces.texture_count == scene.textures.len() {
            return Ok(0);
        }
        check_surfaces(scene)?;
        let grown = self.surfaces.append(context, scene, true)?;
        self.link();
        if grown > 0 {
            // At once: what it names is freed.
            self.table.write(0, &[self.host_table])?;
        }
        Ok(grown)
    }

    /// Whether [`GpuScene::record_tables`] has anything to do.
    pub(crate) fn has_stale_tables(&self) -> bool {
        self.stale != Stale::default()
    }

    /// Records the copies of all tables that changed.
    pub(crate) fn record_tables(&self, device: &ash::Device, cmd: vk::CommandBuffer) {
        let update = |buffer: &Buffer, bytes: &[u8]| update_buffer(device, cmd, buffer, 0, bytes);
        if self.stale.table {
            update(&self.table, bytemuck::bytes_of(&self.host_table));
        }
        if self.stale.lights {
            update(&self.lights, bytemuck::cast_slice(&self.host_lights));
        }
        if self.stale.starts {
            update(&self.mesh_starts, bytemuck::cast_slice(&self.starts));
        }
    }

    /// The device has all that [`GpuScene::record_tables`] recorded.
    pub(crate) fn tables_are_written(&mut self) {
        self.stale = Stale::default();
    }

    /// What a grid is built over: the triangles of all meshes, in device memory.
    pub fn geometry(&self) -> Geometry {
        Geometry {
            positions: self.arrays.positions.region(),
            vertex_count: self.arrays.vertices,
            indices: self.arrays.indices.region(),
            triangle_count: self.triangle_count,
        }
    }

    /// Number of triangles of all meshes.
    pub fn triangle_count(&self) -> u32 {
        self.triangle_count
    }

    /// Number of vertices of all meshes.
    pub fn vertex_count(&self) -> u32 {
        self.ranges.iter().map(|range| range.count).sum()
    }

    /// Number of lights.
    pub fn light_count(&self) -> u32 {
        self.host_lights.len() as u32
    }

    /// First triangle of each mesh: the triangle of a hit counts over all meshes.
    pub fn mesh_starts(&self) -> &[u32] {
        &self.starts
    }

    /// The mesh of a triangle, and the triangle's number within it.
    pub fn locate(&self, triangle: u32) -> Option<(u32, u32)> {
        if triangle >= self.triangle_count {
            return None;
        }
        let mesh = self.starts.partition_point(|&start| start <= triangle).checked_sub(1)?;
        Some((u32::try_from(mesh).ok()?, triangle - self.starts.get(mesh)?))
    }

    /// Whether any material has holes.
    pub fn has_masks(&self) -> bool {
        self.surfaces.has_masks
    }

    /// Whether any material reflects as a mirror.
    pub fn has_mirrors(&self) -> bool {
        self.surfaces.has_mirrors
    }

    /// Whether any material is seen through.
    pub fn has_blends(&self) -> bool {
        self.surfaces.has_blends
    }

    /// Brings the positions back to the host, as the grid is built of them; those that no triangle names may hold anything.
    ///
    /// # Errors
    /// Those of [`Buffer::read`].
    pub fn read_positions(&self) -> Result<Vec<[f32; 3]>> {
        self.arrays.positions.read(0, self.arrays.vertices as usize)
    }

    /// Brings the triangles of all meshes back to the host.
    ///
    /// # Errors
    /// Those of [`Buffer::read`].
    pub fn read_indices(&self) -> Result<Vec<[u32; 3]>> {
        self.arrays.indices.read(0, self.triangle_count as usize)
    }

    /// Bytes of device memory.
    pub fn bytes(&self) -> u64 {
        let Surfaces { materials, textures, texels, .. } = &self.surfaces;
        let others = [materials, textures, texels, &self.lights, &self.mesh_starts, &self.table, &self._panorama, &self._srgb];
        self.arrays.bytes() + others.iter().map(|buffer| buffer.size()).sum::<u64>()
    }
}

/// Most bytes of one `vkCmdUpdateBuffer`.
const UPDATE_BYTES: usize = 65_536;

/// Records that bytes are put into a buffer: a multiple of 4, at an offset that is one, within the buffer.
pub(crate) fn update_buffer(device: &ash::Device, cmd: vk::CommandBuffer, buffer: &Buffer, offset: u64, bytes: &[u8]) {
    debug_assert!(offset + bytes.len() as u64 <= buffer.size());
    for (at, piece) in (offset..).step_by(UPDATE_BYTES).zip(bytes.chunks(UPDATE_BYTES)) {
        // SAFETY: the command buffer is recording (its recorder is the caller); the buffer lives until the submission was waited for and
        // has room, which the caller has seen to.
        unsafe { device.cmd_update_buffer(cmd, buffer.raw(), at, piece) };
    }
}

struct Counts {
    vertices: u32,
    triangles: u32,
}

fn bad(reason: String) -> Error {
    Error::Scene { reason }
}

fn bounded(what: &str, count: u64, most: u32) -> Result<u32> {
    u32::try_from(count).ok().filter(|&count| count <= most).ok_or_else(|| bad(format!("{count} {what}; {most} are possible")))
}

/// Every index that a kernel will follow.
fn check(scene: &Scene) -> Result<Counts> {
    let (mut vertices, mut triangles) = (0_u64, 0_u64);
    for mesh in &scene.meshes {
        check_mesh(mesh, scene.materials.len()).map_err(bad)?;
        vertices += mesh.positions.len() as u64;
        triangles += mesh.indices.len() as u64;
    }
    check_surfaces(scene)?;
    bounded("lights", scene.lights.len() as u64, MAX_WORDS)?;
    check_counts(vertices, triangles)
}

/// Bounds the vertices and triangles of all meshes.
fn check_counts(vertices: u64, triangles: u64) -> Result<Counts> {
    Ok(Counts {
        vertices: bounded("vertices", vertices, gridwalk::MAX_VERTICES)?,
        triangles: bounded("triangles", triangles, gridwalk::MAX_TRIANGLES)?,
    })
}

/// Room for the vertices of all ranges and for triangles, in words that kernels can index.
pub(crate) fn check_room(vertices: u64, triangles: u64) -> Result<(u32, u32)> {
    check_counts(vertices, triangles).map(|counts| (counts.vertices, counts.triangles))
}

/// What is wrong with a mesh.
pub(crate) fn check_mesh(mesh: &Mesh, materials: usize) -> Result<(), String> {
    let count = mesh.positions.len();
    if mesh.normals.len() != count || mesh.uvs.len() != count {
        return Err(format!(
            "mesh {}: {} normals and {} texture coordinates for {count} positions",
            mesh.name,
            mesh.normals.len(),
            mesh.uvs.len()
        ));
    }
    if !mesh.colours.is_empty() && mesh.colours.len() != count {
        return Err(format!("mesh {}: {} colours for {count} positions", mesh.name, mesh.colours.len()));
    }
    if !mesh.opacities.is_empty() && mesh.opacities.len() != count {
        return Err(format!("mesh {}: {} opacities for {count} positions", mesh.name, mesh.opacities.len()));
    }
    if mesh.materials.len() != mesh.indices.len() {
        return Err(format!("mesh {}: {} materials for {} triangles", mesh.name, mesh.materials.len(), mesh.indices.len()));
    }
    if let Some(index) = mesh.indices.as_flattened().iter().find(|&&index| index as usize >= count) {
        return Err(format!("mesh {}: vertex {index} of {count}", mesh.name));
    }
    if let Some(material) = mesh.materials.iter().find(|&&material| material as usize >= materials) {
        return Err(format!("mesh {}: material {material} of {materials}", mesh.name));
    }
    Ok(())
}

fn check_surfaces(scene: &Scene) -> Result<()> {
    let mut texels = 0_u64;
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
    bounded("texels", texels, MAX_WORDS).map(drop)
}

/// Words of an array that a kernel can index: SPIR-V takes indices as signed.
const MAX_WORDS: u32 = i32::MAX as u32;

fn has_opacities(scene: &Scene) -> bool {
    scene.meshes.iter().any(|mesh| !mesh.opacities.is_empty())
}

fn device_material(material: &Material, textures: &[Texture], has_opacities: bool) -> layout::Material {
    let mut flags = 0;
    if material.illumination >= 3 && material.specular.iter().any(|&value| value > 0.0) {
        flags |= layout::MATERIAL_MIRROR;
    }
    if material.normal_map_is_height {
        flags |= layout::MATERIAL_HEIGHT_MAP;
    }
    // A mask without a hole is none, and what is solid everywhere is not seen through: a scene without either is traced by the library's
    // own kernels, which are faster.
    let solid = if material.blend { 1.0 } else { 0.5 };
    let opacity_map = material.opacity_map.filter(|&map| {
        textures
            .get(map as usize)
            .is_some_and(|texture| texture.pixels.chunks_exact(4).any(|texel| f32::from(texel[3]) / 255.0 * material.opacity < solid))
    });
    if material.blend && (material.opacity < 1.0 || opacity_map.is_some() || has_opacities) {
        flags |= layout::MATERIAL_BLEND;
    }
    if material.unlit {
        flags |= layout::MATERIAL_UNLIT;
    }
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
        number: 0,
        reserved: 0,
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
