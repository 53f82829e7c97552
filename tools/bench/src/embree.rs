//! The rival: Embree 3 or 4, loaded at run time. The only module with unsafe code: calls through its C interface, declared by hand from its
//! headers (`rtcore_ray.h`, `rtcore_common.h`), which both versions share but for the arguments of the queries.

use std::ffi::{CString, c_char, c_int, c_uint, c_void};
use std::mem::{ManuallyDrop, offset_of};
use std::path::{Path, PathBuf};
use std::ptr::NonNull;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::Instant;

use anyhow::{Context as _, Result, bail};
use gridwalk::{Hit, Ray};
use libloading::Library;

use crate::arguments::Quality;
use crate::contender::Tree;
use crate::host::{HostTree, Library as Rival};

/// `RTCRayHit`: `RTCRay` of 48 bytes and `RTCHit` of 32. Embree 4.3 appends the primitive of the instance, 4 bytes, which falls into
/// `spare`; both count on one level of instances, as the headers do by default.
#[repr(C, align(16))]
#[derive(Clone, Copy)]
struct RayHit {
    origin: [f32; 3],
    near: f32,
    direction: [f32; 3],
    time: f32,
    far: f32,
    mask: u32,
    id: u32,
    flags: u32,
    normal: [f32; 3],
    u: f32,
    v: f32,
    primitive: u32,
    geometry: u32,
    instance: u32,
    spare: [u32; 4],
}

impl RayHit {
    fn new(ray: &Ray) -> RayHit {
        RayHit {
            origin: ray.origin,
            near: ray.t_min,
            direction: ray.direction,
            time: 0.0,
            far: ray.t_max,
            mask: u32::MAX,
            id: 0,
            flags: 0,
            normal: [0.0; 3],
            u: 0.0,
            v: 0.0,
            primitive: NOTHING,
            geometry: NOTHING,
            instance: NOTHING,
            spare: [NOTHING; 4],
        }
    }
}

const _: () = assert!(offset_of!(RayHit, far) == 32 && offset_of!(RayHit, normal) == 48 && offset_of!(RayHit, primitive) == 68);
const _: () = assert!(offset_of!(RayHit, spare) == 80 && size_of::<RayHit>() == 96 && align_of::<RayHit>() == 16);

/// `RTCIntersectContext` of Embree 3.
#[repr(C)]
#[derive(Clone, Copy)]
struct QueryContext {
    flags: c_uint,
    filter: *const c_void,
    instance: u32,
}

impl QueryContext {
    fn new() -> QueryContext {
        QueryContext { flags: 0, filter: std::ptr::null(), instance: NOTHING }
    }
}

const _: () = assert!(size_of::<QueryContext>() == 24 && offset_of!(QueryContext, instance) == 16);

const NOTHING: u32 = u32::MAX;
const VERSION_MAJOR: c_int = 1;
const VERSION_MINOR: c_int = 2;
const VERSION_PATCH: c_int = 3;
const GEOMETRY_TRIANGLE: c_int = 0;
const BUFFER_INDEX: c_int = 0;
const BUFFER_VERTEX: c_int = 1;
const FORMAT_UINT3: c_int = 0x5003;
const FORMAT_FLOAT3: c_int = 0x9003;
const QUALITY_LOW: c_int = 0;
const QUALITY_MEDIUM: c_int = 1;
const QUALITY_HIGH: c_int = 2;
const FLAG_NONE: c_int = 0;
const FLAG_DYNAMIC: c_int = 1;

/// A device, scene or geometry of Embree's. The reference counts are atomic, and a committed scene may be asked by any thread.
#[derive(Clone, Copy)]
struct Handle(NonNull<c_void>);

// SAFETY: the handles may be used on every thread (Embree's manual, "thread safety"); changes to one object are made by one thread, since
// they take `&mut` or happen before it is shared.
unsafe impl Send for Handle {}
// SAFETY: as above.
unsafe impl Sync for Handle {}

type Raw = *mut c_void;
type Intersect3 = unsafe extern "C" fn(Raw, *mut QueryContext, *mut RayHit);
type Intersect4 = unsafe extern "C" fn(Raw, *mut RayHit, *const c_void);

#[derive(Clone, Copy)]
enum Query {
    Three { intersect: Intersect3, occluded: Intersect3 },
    Four { intersect: Intersect4, occluded: Intersect4 },
}

/// Bytes that Embree has asked for: now, and at most since the last mark.
#[derive(Default)]
struct Memory {
    now: AtomicI64,
    peak: AtomicI64,
}

type Monitor = unsafe extern "C" fn(Raw, isize, bool) -> bool;

/// Told before memory is taken, and after it is given back, which counts below 0. Always goes on.
///
/// # Safety
/// `memory` is a [`Memory`] that lives as long as the device.
unsafe extern "C" fn monitor(memory: Raw, bytes: isize, _post: bool) -> bool {
    // SAFETY: the caller's word.
    let memory = unsafe { &*memory.cast_const().cast::<Memory>() };
    let bytes = bytes as i64;
    let now = memory.now.fetch_add(bytes, Ordering::Relaxed) + bytes;
    memory.peak.fetch_max(now, Ordering::Relaxed);
    true
}

struct Functions {
    release_device: unsafe extern "C" fn(Raw),
    device_error: unsafe extern "C" fn(Raw) -> c_int,
    device_property: unsafe extern "C" fn(Raw, c_int) -> isize,
    new_scene: unsafe extern "C" fn(Raw) -> Raw,
    release_scene: unsafe extern "C" fn(Raw),
    set_scene_flags: unsafe extern "C" fn(Raw, c_int),
    set_scene_quality: unsafe extern "C" fn(Raw, c_int),
    commit_scene: unsafe extern "C" fn(Raw),
    new_geometry: unsafe extern "C" fn(Raw, c_int) -> Raw,
    release_geometry: unsafe extern "C" fn(Raw),
    set_geometry_quality: unsafe extern "C" fn(Raw, c_int),
    set_shared_buffer: unsafe extern "C" fn(Raw, c_int, c_uint, c_int, *const c_void, usize, usize, usize),
    update_buffer: unsafe extern "C" fn(Raw, c_int, c_uint),
    commit_geometry: unsafe extern "C" fn(Raw),
    attach_geometry: unsafe extern "C" fn(Raw, Raw) -> c_uint,
    query: Query,
}

struct Loaded {
    functions: Functions,
    device: Handle,
    /// Not moved while the device lives, which tells it what it takes.
    memory: Box<Memory>,
}

impl Drop for Loaded {
    fn drop(&mut self) {
        // SAFETY: the device was made by this library and is released once.
        unsafe { (self.functions.release_device)(self.device.0.as_ptr()) };
    }
}

/// An Embree device.
#[derive(Clone)]
pub struct Embree {
    loaded: Arc<Loaded>,
    path: PathBuf,
    threads: u32,
}

/// As the report has it.
pub const NAME: &str = "Embree";

/// The usual names, the newest first.
const NAMES: &[&str] = if cfg!(windows) {
    &["embree4.dll", "embree3.dll"]
} else if cfg!(target_os = "macos") {
    &["libembree4.dylib", "libembree3.dylib"]
} else {
    &["libembree4.so.4", "libembree4.so", "libembree3.so.3", "libembree3.so"]
};

impl Embree {
    /// Loads the library and makes a device; `None` where none of the usual names is installed.
    ///
    /// # Errors
    /// A library that was named cannot be loaded, or one lacks a function or refuses the device.
    pub fn load(path: Option<&Path>, threads: u32) -> Result<Option<Embree>> {
        let names: Vec<PathBuf> = path.map_or_else(|| NAMES.iter().map(PathBuf::from).collect(), |path| vec![path.to_owned()]);
        let mut last = None;
        for name in names {
            // SAFETY: the file is Embree by its name or by the user's word; its initialisers need nothing of us.
            match unsafe { Library::new(&name) } {
                Ok(library) => return Embree::new(library, name, threads).map(Some),
                Err(error) => last = Some(error),
            }
        }
        match (path, last) {
            (Some(path), Some(error)) => Err(error).with_context(|| format!("{}: cannot be loaded", path.display())),
            _ => Ok(None),
        }
    }

    fn new(library: Library, path: PathBuf, threads: u32) -> Result<Embree> {
        // Never unloaded: Embree's worker threads (TBB) outlive its device and would run on in code that is gone.
        let library = ManuallyDrop::new(library);
        fn get<T: Copy>(library: &Library, name: &str) -> Result<T> {
            // SAFETY: the type is that of the function in Embree's headers, for every name below.
            let symbol = unsafe { library.get::<T>(name.as_bytes()) };
            Ok(*symbol.with_context(|| format!("Embree lacks {name}"))?)
        }
        let new_device: unsafe extern "C" fn(*const c_char) -> Raw = get(&library, "rtcNewDevice")?;
        let config = CString::new(format!("threads={threads}"))?;
        // SAFETY: a string that ends in a zero and lives through the call.
        let device = NonNull::new(unsafe { new_device(config.as_ptr()) }).context("Embree makes no device")?;
        let device_property: unsafe extern "C" fn(Raw, c_int) -> isize = get(&library, "rtcGetDeviceProperty")?;
        // SAFETY: a living device, and a property that both versions know.
        let query = match unsafe { device_property(device.as_ptr(), VERSION_MAJOR) } {
            3 => Query::Three { intersect: get(&library, "rtcIntersect1")?, occluded: get(&library, "rtcOccluded1")? },
            4 => Query::Four { intersect: get(&library, "rtcIntersect1")?, occluded: get(&library, "rtcOccluded1")? },
            other => bail!("{}: Embree {other} is neither 3 nor 4", path.display()),
        };
        let set_monitor: unsafe extern "C" fn(Raw, Option<Monitor>, Raw) = get(&library, "rtcSetDeviceMemoryMonitorFunction")?;
        let functions = Functions {
            release_device: get(&library, "rtcReleaseDevice")?,
            device_error: get(&library, "rtcGetDeviceError")?,
            device_property,
            new_scene: get(&library, "rtcNewScene")?,
            release_scene: get(&library, "rtcReleaseScene")?,
            set_scene_flags: get(&library, "rtcSetSceneFlags")?,
            set_scene_quality: get(&library, "rtcSetSceneBuildQuality")?,
            commit_scene: get(&library, "rtcCommitScene")?,
            new_geometry: get(&library, "rtcNewGeometry")?,
            release_geometry: get(&library, "rtcReleaseGeometry")?,
            set_geometry_quality: get(&library, "rtcSetGeometryBuildQuality")?,
            set_shared_buffer: get(&library, "rtcSetSharedGeometryBuffer")?,
            update_buffer: get(&library, "rtcUpdateGeometryBuffer")?,
            commit_geometry: get(&library, "rtcCommitGeometry")?,
            attach_geometry: get(&library, "rtcAttachGeometry")?,
            query,
        };
        // Owns the device from here on.
        let loaded = Loaded { functions, device: Handle(device), memory: Box::default() };
        // SAFETY: a living device, and a `Memory` that lives as long, behind a box that is not moved out of.
        unsafe { set_monitor(device.as_ptr(), Some(monitor), std::ptr::from_ref(&*loaded.memory).cast_mut().cast()) };
        Ok(Embree { loaded: Arc::new(loaded), path, threads })
    }

    /// Its version.
    pub fn version(&self) -> String {
        let Loaded { functions, device, .. } = &*self.loaded;
        // SAFETY: a living device, and properties that both versions know.
        let part = |property| unsafe { (functions.device_property)(device.0.as_ptr(), property) };
        format!("{}.{}.{}", part(VERSION_MAJOR), part(VERSION_MINOR), part(VERSION_PATCH))
    }

    /// The library that was loaded.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Threads of its builds and of our queries.
    pub fn threads(&self) -> u32 {
        self.threads
    }

    fn scene(&self, mesh: &Arc<Mesh>, flags: c_int, quality: c_int) -> Result<Scene> {
        let Loaded { functions, device, .. } = &*self.loaded;
        let device = device.0.as_ptr();
        // SAFETY: a living device.
        let raw = NonNull::new(unsafe { (functions.new_scene)(device) }).context("Embree makes no scene")?;
        // SAFETY: a living device, and a geometry type that both versions know.
        let geometry = NonNull::new(unsafe { (functions.new_geometry)(device, GEOMETRY_TRIANGLE) });
        // Owns both from here on.
        let scene = Scene { embree: self.clone(), mesh: Arc::clone(mesh), scene: Handle(raw), geometry: geometry.map(Handle) };
        let geometry = geometry.context("Embree makes no geometry")?.as_ptr();
        let vertices = mesh.positions.len().saturating_sub(Mesh::PADDING);
        // SAFETY: living objects of one device. The buffers have the stated strides and counts, the vertices one more behind them, so that
        // 16-byte loads of the last stay inside; they live as long as `scene`, which holds the mesh. All indices are below the number of
        // vertices: `Mesh::new` has checked it.
        unsafe {
            (functions.set_scene_flags)(raw.as_ptr(), flags);
            (functions.set_scene_quality)(raw.as_ptr(), quality);
            (functions.set_geometry_quality)(geometry, quality);
            (functions.set_shared_buffer)(geometry, BUFFER_VERTEX, 0, FORMAT_FLOAT3, mesh.positions.as_ptr().cast(), 0, 12, vertices);
            (functions.set_shared_buffer)(geometry, BUFFER_INDEX, 0, FORMAT_UINT3, mesh.indices.as_ptr().cast(), 0, 12, mesh.indices.len());
            (functions.commit_geometry)(geometry);
            (functions.attach_geometry)(raw.as_ptr(), geometry);
        }
        self.check()?;
        Ok(scene)
    }

    fn check(&self) -> Result<()> {
        let Loaded { functions, device, .. } = &*self.loaded;
        // SAFETY: a living device.
        match unsafe { (functions.device_error)(device.0.as_ptr()) } {
            0 => Ok(()),
            error => bail!("Embree reports error {error}"),
        }
    }
}

/// Embree with the mesh that its trees are of.
pub struct Meshed {
    /// The device.
    pub embree: Embree,
    /// The triangles.
    pub mesh: Arc<Mesh>,
    /// Of the tree for the fastest rays.
    pub quality: Quality,
}

impl Rival for Meshed {
    type Tree = Scene;

    fn name(&self) -> &'static str {
        NAME
    }

    fn threads(&self) -> u32 {
        self.embree.threads
    }

    fn tree(&self, tree: Tree) -> Result<Scene> {
        let (flags, quality) = match (tree, self.quality) {
            // In Morton order.
            (Tree::Fast, _) => (FLAG_DYNAMIC, QUALITY_LOW),
            (Tree::Best, Quality::Medium) => (FLAG_NONE, QUALITY_MEDIUM),
            (Tree::Best, Quality::High) => (FLAG_NONE, QUALITY_HIGH),
        };
        let memory = &self.embree.loaded.memory;
        memory.peak.store(memory.now.load(Ordering::Relaxed), Ordering::Relaxed);
        let mut scene = self.embree.scene(&self.mesh, flags, quality)?;
        scene.rebuild()?;
        Ok(scene)
    }
}

/// Triangles as Embree reads them.
pub struct Mesh {
    positions: Vec<[f32; 3]>,
    indices: Vec<[u32; 3]>,
}

impl Mesh {
    /// Vertices behind the last, which 16-byte loads may touch.
    const PADDING: usize = 1;

    /// Copies triangles; `None` where an index leads nowhere.
    pub fn new(positions: &[[f32; 3]], indices: &[[u32; 3]]) -> Option<Arc<Mesh>> {
        if indices.as_flattened().iter().any(|&vertex| vertex as usize >= positions.len()) {
            return None;
        }
        let mut positions = positions.to_vec();
        positions.resize(positions.len() + Mesh::PADDING, [0.0; 3]);
        Some(Arc::new(Mesh { positions, indices: indices.to_vec() }))
    }
}

/// A scene of one mesh.
pub struct Scene {
    embree: Embree,
    mesh: Arc<Mesh>,
    scene: Handle,
    geometry: Option<Handle>,
}

impl Drop for Scene {
    fn drop(&mut self) {
        let functions = &self.embree.loaded.functions;
        // SAFETY: both were made by this library and are released once; nothing asks the scene any more.
        unsafe {
            (functions.release_scene)(self.scene.0.as_ptr());
            if let Some(geometry) = self.geometry {
                (functions.release_geometry)(geometry.0.as_ptr());
            }
        }
    }
}

impl HostTree for Scene {
    fn rebuild(&mut self) -> Result<f64> {
        let functions = &self.embree.loaded.functions;
        let begin = Instant::now();
        // SAFETY: living objects; `&mut self` keeps queries away; the buffers live in `self.mesh`.
        unsafe {
            if let Some(geometry) = self.geometry {
                (functions.update_buffer)(geometry.0.as_ptr(), BUFFER_VERTEX, 0);
                (functions.commit_geometry)(geometry.0.as_ptr());
            }
            (functions.commit_scene)(self.scene.0.as_ptr());
        }
        let ms = begin.elapsed().as_secs_f64() * 1e3;
        self.embree.check()?;
        debug_assert!(!self.mesh.positions.is_empty());
        Ok(ms)
    }

    fn closest(&self, ray: &Ray) -> Hit {
        let mut query = RayHit::new(ray);
        let scene = self.scene.0.as_ptr();
        match self.embree.loaded.functions.query {
            // SAFETY: a scene that was committed when it was made, and structures with the layout of Embree 3's headers.
            Query::Three { intersect, .. } => unsafe { intersect(scene, &mut QueryContext::new(), &mut query) },
            // SAFETY: likewise, a structure with the layout of Embree 4's headers, and no arguments, which is allowed.
            Query::Four { intersect, .. } => unsafe { intersect(scene, &mut query, std::ptr::null()) },
        }
        if query.geometry == NOTHING { Hit::MISS } else { Hit { t: query.far, u: query.u, v: query.v, triangle: query.primitive } }
    }

    fn any(&self, ray: &Ray) -> bool {
        let mut query = RayHit::new(ray);
        let scene = self.scene.0.as_ptr();
        match self.embree.loaded.functions.query {
            // SAFETY: as in `closest`; the query touches the ray alone, which comes first in the structure.
            Query::Three { occluded, .. } => unsafe { occluded(scene, &mut QueryContext::new(), &mut query) },
            // SAFETY: as above.
            Query::Four { occluded, .. } => unsafe { occluded(scene, &mut query, std::ptr::null()) },
        }
        // A ray that hits comes back with an end of minus infinity.
        query.far < 0.0
    }

    /// The most that was taken since the tree was begun, while the device has no other.
    fn bytes(&self) -> Option<u64> {
        u64::try_from(self.embree.loaded.memory.peak.load(Ordering::Relaxed)).ok().filter(|bytes| *bytes > 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_that_lead_nowhere_are_refused() {
        assert!(Mesh::new(&[[0.0; 3]; 3], &[[0, 1, 3]]).is_none());
        assert!(Mesh::new(&[[0.0; 3]; 3], &[[0, 1, 2]]).is_some());
    }

    #[test]
    fn a_library_that_is_named_must_be_there() {
        assert!(Embree::load(Some(Path::new("nowhere/libembree4.so")), 1).is_err());
    }

    #[test]
    fn one_triangle() {
        let Some(embree) = Embree::load(None, 2).unwrap() else {
            eprintln!("Embree is not installed: not tested");
            return;
        };
        let mesh = Mesh::new(&[[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]], &[[0, 1, 2]]).unwrap();
        let ray = |x: f32| Ray { origin: [x, 0.25, 0.0], t_min: 0.0, direction: [0.0, 0.0, 1.0], t_max: f32::INFINITY };
        for quality in [Quality::Medium, Quality::High] {
            let rival = Meshed { embree: embree.clone(), mesh: Arc::clone(&mesh), quality };
            for tree in [Tree::Fast, Tree::Best] {
                let mut scene = rival.tree(tree).unwrap();
                scene.rebuild().unwrap();
                assert!(scene.bytes().is_some_and(|bytes| bytes < 1 << 24), "{:?}", scene.bytes());
                assert_eq!(scene.closest(&ray(0.5)), Hit { t: 1.0, u: 0.5, v: 0.25, triangle: 0 });
                assert_eq!(scene.closest(&ray(2.0)), Hit::MISS);
                assert_eq!([scene.any(&ray(0.5)), scene.any(&ray(2.0))], [true, false]);
            }
        }
    }
}
