//! Scenes that move, on the device: the scene and the grid of one time after another.
//!
//! A mesh of key-frames has three slots of device memory: the frame reads one or two, and a thread of its own fills the third with the one
//! that comes next. Kernels make of these, and of poses, the vertices of the scene's arrays, in which each mesh has a range of its own;
//! triangles lie side by side, so that those behind a mesh move when it grows. Renderer and library see an ordinary scene.

mod bent;
mod loader;
mod shelf;
mod staging;
mod stats;

use crate::{
    BuildSettings, BuildStats, Context, Error, GpuScene, Grid, GridBuilder, Result, kernels,
    pipeline::{Pipeline, Recorder, Timer, map_groups},
    push,
    scene::{Arrays, VertexRange, check_room, update_buffer, with_slack},
};
use bent::{BendKernels, Bent, Placing};
use gridwalk_scene::{Animation, KeyPair, Motion};
use loader::{Lists, Loader, Reply, Request, Size, Slot, SlotLayout};
use shelf::Shelf;
use staging::Timeline;
use std::{sync::Arc, time::Instant};

pub use stats::SeekStats;

/// How an animation is to be played.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PlayerOptions {
    /// How the grids are to be built.
    pub build: BuildSettings,
    /// Bytes of the memory through which key-frames travel to the device; larger ones go through in pieces.
    pub staging_bytes: u64,
}

impl Default for PlayerOptions {
    fn default() -> Self {
        PlayerOptions { build: BuildSettings::default(), staging_bytes: 32 << 20 }
    }
}

/// An animation in device memory, with the grid over what is to be seen at one time.
pub struct Player {
    /// First, so that its thread has ended before anything that it writes to is freed.
    loader: Option<Loader>,
    timeline: Arc<Timeline>,
    meshes: Vec<Moving>,
    scene: GpuScene,
    grid: Grid,
    /// Whether the grid is that of the scene as it is now.
    is_built: bool,
    /// Buffers that were made anew, until a seek tells of them.
    grown: u32,
    /// The build by which the player was made, until a seek tells of it.
    first_build: Option<BuildStats>,
    timer: Timer,
    kernels: MotionKernels,
    animation: Animation,
    context: Context,
}

impl std::fmt::Debug for Player {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Player").field("scene", &self.scene).field("grid", &self.grid).finish_non_exhaustive()
    }
}

/// The kernels that make a scene's vertices and triangles.
struct MotionKernels {
    interpolate: Pipeline,
    interpolate_colours: Pipeline,
    place: Pipeline,
    bend: BendKernels,
}

/// A mesh as the player moves it.
#[derive(Debug)]
struct Moving {
    motion: Way,
    /// What its triangles in the scene's arrays are.
    placed: Placed,
}

#[derive(Debug)]
enum Way {
    Still,
    Keys {
        shelf: Box<Shelf>,
        /// The key-frames to come, as far as they can be blended, and those that the scene shows.
        next: KeyPair,
        shown: Option<KeyPair>,
        /// Of a mesh that moves as a whole, too.
        placing: Option<Box<Placing>>,
    },
    Bent {
        bent: Box<Bent>,
        is_shown: bool,
    },
}

/// Triangles as they were put among those of the scene.
#[derive(Debug)]
struct Placed {
    first_triangle: u32,
    first_vertex: u32,
    /// Of a mesh of key-frames: the lists that they were made of.
    lists: Option<Lists>,
    /// Of another mesh that a mesh of key-frames stands before: indices and materials of its own.
    source: Option<[crate::Buffer; 2]>,
    triangle_count: u32,
}

/// What a seek will record.
#[derive(Default)]
struct Work {
    /// Meshes whose vertices are made anew.
    vertices: Vec<usize>,
    /// Meshes whose triangles are put elsewhere or changed.
    triangles: Vec<usize>,
}

impl Player {
    /// Brings an animation to the device, as it is at time 0.
    ///
    /// # Errors
    /// [`Error::Scene`] for a motion without a meaning; those of [`GpuScene::upload`], of [`GridBuilder::build`] and of
    /// [`Animation::reader`].
    pub fn new(context: &Context, animation: Animation, options: &PlayerOptions) -> Result<Player> {
        let Animation { scene, motions, .. } = &animation;
        if motions.len() != scene.meshes.len() {
            return Err(Error::Scene { reason: format!("{} motions of {} meshes", motions.len(), scene.meshes.len()) });
        }
        let gpu = GpuScene::upload(context, scene)?;
        let grid = GridBuilder::new(context)?.build(&gpu, &options.build)?;
        let mut slots = 0;
        let mut rooms = Vec::with_capacity(motions.len());
        let mut meshes = Vec::with_capacity(motions.len());
        for (index, (mesh, motion)) in scene.meshes.iter().zip(motions).enumerate() {
            let range = gpu.ranges().get(index).copied().unwrap_or_default();
            let size = Size { vertices: range.count, triangles: mesh.indices.len() as u32, has_colours: !mesh.colours.is_empty() };
            rooms.push(size);
            let way = match motion {
                Motion::Still => Way::Still,
                Motion::Keys => {
                    let mut slot = || {
                        slots += 1;
                        Slot::new(context, slots - 1, size)
                    };
                    let shelf = Box::new(Shelf::new([slot()?, slot()?, slot()?]));
                    let placing = Placing::new(context, &animation, index)?.map(Box::new);
                    Way::Keys { shelf, next: KeyPair::default(), shown: None, placing }
                }
                Motion::Deformed(source) => {
                    let bent = Box::new(Bent::new(context, &mesh.name, mesh.positions.len(), source)?);
                    Way::Bent { bent, is_shown: false }
                }
                _ => return Err(Error::Scene { reason: format!("mesh {}: a kind of motion that this version does not know", mesh.name) }),
            };
            let is_moved = slots > 0 && !matches!(way, Way::Keys { .. });
            let source = if is_moved {
                Some([context.upload("mesh indices", &mesh.indices)?, context.upload("mesh triangle materials", &mesh.materials)?])
            } else {
                None
            };
            let first_triangle = gpu.mesh_starts().get(index).copied().unwrap_or(0);
            let placed = Placed { first_triangle, first_vertex: range.first, lists: None, source, triangle_count: size.triangles };
            meshes.push(Moving { motion: way, placed });
        }
        let timeline = Arc::new(Timeline::new(context, slots)?);
        let loader = if slots > 0 {
            let reader = animation.reader()?;
            Some(Loader::new(context, reader, &timeline, options.staging_bytes, rooms, scene.materials.len())?)
        } else {
            None
        };
        Ok(Player {
            loader,
            timeline,
            meshes,
            scene: gpu,
            grown: 0,
            first_build: Some(grid.stats().clone()),
            grid,
            is_built: true,
            timer: Timer::new(context)?,
            kernels: MotionKernels {
                interpolate: Pipeline::new(context, &kernels::INTERPOLATE, &[])?,
                interpolate_colours: Pipeline::new(context, &kernels::INTERPOLATE_COLOURS, &[])?,
                place: Pipeline::new(context, &kernels::PLACE, &[])?,
                bend: BendKernels::new(context)?,
            },
            animation,
            context: context.clone(),
        })
    }

    /// Brings scene and grid to a time in seconds. `upcoming` are the times of the next frames, soonest first, whose key-frames are read
    /// ahead. The grid is built only when the geometry differs from that of the last time. The same time gives the same scene, whatever was
    /// sought before.
    ///
    /// # Errors
    /// [`Error::KeyFrame`] for a key-frame that is missing or broken, from the seek that needs it; [`Error::Scene`] for one that leads
    /// nowhere; [`Error::Setting`] for a time that is not a number; [`Error::OutOfDeviceMemory`]; those of [`Grid::rebuild`] and of
    /// [`Context::submit`]. The scene then stays at the time where it was, unless it was the grid that failed; other times can be sought.
    pub fn seek(&mut self, time: f64, upcoming: &[f64]) -> Result<SeekStats> {
        if !time.is_finite() {
            return Err(Error::Setting { setting: "time", value: time.to_string(), expected: "a finite number of seconds" });
        }
        let mut stats = SeekStats::new(self.grid.stats());
        let busy_ms = self.load(time, upcoming, &mut stats)?;
        stats.grown += self.scene.append_surfaces(&self.context, &self.animation.scene)?;
        self.prepare(time)?;
        stats.grown += self.make_room()?;
        let work = self.plan();
        let is_moved = !work.vertices.is_empty() || !work.triangles.is_empty();
        if is_moved || self.scene.has_stale_tables() {
            self.is_built &= !is_moved;
            self.submit(&work)?;
            stats.deform_steps = self.timer.take();
            stats.deform_ms = stats.deform_steps.iter().filter(|step| step.kind == "map").fold(0.0, |sum, step| sum + step.ms);
        }
        self.tell_news(time, busy_ms, &mut stats)?;
        if !self.is_built {
            let capacity = *self.grid.capacity();
            self.grid.rebuild(&self.scene)?;
            self.is_built = true;
            stats.rebuilt = true;
            stats.grown += if *self.grid.capacity() == capacity { 0 } else { GRID_BUFFERS };
        }
        stats.build = self.grid.stats().clone();
        stats.first_build = self.first_build.take();
        Ok(stats)
    }

    /// Whether a seek to this time would find its key-frames read and sent to the device, or known to be missing, without waiting for them.
    /// They are on their way once a seek has named them as upcoming.
    pub fn is_ready(&mut self, time: f64) -> bool {
        self.take_in();
        let animation = &self.animation;
        shelves(&mut self.meshes).all(|(mesh, shelf, _)| keys(&animation.keys_at(mesh, time)).iter().all(|&key| shelf.is_settled(key)))
    }

    /// Takes in what the thread has done so far.
    fn take_in(&mut self) {
        let Some(loader) = &self.loader else { return };
        while let Some(reply) = loader.poll() {
            self.grown += settle(&mut self.meshes, &mut self.animation, reply, false);
        }
    }

    /// Builds the grid again from nothing, to measure.
    ///
    /// # Errors
    /// As [`Grid::rebuild`].
    pub fn rebuild(&mut self) -> Result<()> {
        self.grid.rebuild(&self.scene)
    }

    /// Whether the next builds of the grid time each step: see [`BuildSettings::time_steps`].
    pub fn time_steps(&mut self, time_steps: bool) {
        self.grid.time_steps(time_steps);
    }

    /// The animation. Its scene is that of time 0, with all materials and textures that key-frames have added so far.
    pub fn animation(&self) -> &Animation {
        &self.animation
    }

    /// The scene at the time that was last sought; at time 0 before.
    pub fn scene(&self) -> &GpuScene {
        &self.scene
    }

    /// The grid over [`Player::scene`].
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Sees to it that the key-frames of a time are in their slots, or on their way on the device, and that the next ones follow. Returns the
    /// milliseconds in which the thread can have worked for this seek alone: 0 where all was there.
    fn load(&mut self, time: f64, upcoming: &[f64], stats: &mut SeekStats) -> Result<f64> {
        let begin = Instant::now();
        let Some(loader) = &self.loader else { return Ok(0.0) };
        let (meshes, animation) = (&mut self.meshes, &mut self.animation);
        // What was asked for but not begun may not be needed any more.
        for Request { mesh, key, slot } in loader.take_back() {
            if let Some(Way::Keys { shelf, .. }) = meshes.get_mut(mesh).map(|moving| &mut moving.motion) {
                shelf.give_back(key, slot);
            }
        }
        while let Some(reply) = loader.poll() {
            stats.grown += settle(meshes, animation, reply, false);
        }
        stats.grown += std::mem::take(&mut self.grown);
        for (mesh, _, next) in shelves(meshes) {
            *next = animation.keys_at(mesh, time);
        }
        ask_for_needed(meshes, loader);
        let mut kept: Vec<Vec<u32>> = shelves(meshes).map(|(_, _, next)| keys(next)).collect();
        for &later in upcoming.iter().take(UPCOMING).filter(|later| later.is_finite()) {
            for ((mesh, shelf, _), kept) in shelves(meshes).zip(&mut kept) {
                for key in keys(&animation.keys_at(mesh, later)) {
                    // What is needed sooner keeps its slot.
                    if let Some(slot) = shelf.lend(key, kept) {
                        loader.ask(Request { mesh, key, slot });
                    }
                    kept.push(key);
                }
            }
        }
        let asked = Instant::now();
        let mut busy_ms = 0.0;
        while shelves(meshes).any(|(_, shelf, next)| !keys(next).iter().all(|&key| shelf.is_settled(key))) {
            stats.grown += settle(meshes, animation, loader.wait()?, true);
            // The slot that is wanted may have been lent for something else till now.
            ask_for_needed(meshes, loader);
            stats.wait_ms = asked.elapsed().as_secs_f64() * 1e3;
            busy_ms = begin.elapsed().as_secs_f64() * 1e3;
        }
        for (_, shelf, next) in shelves(meshes) {
            for key in keys(next) {
                if let Some(error) = shelf.failure(key) {
                    return Err(error);
                }
            }
        }
        Ok(busy_ms)
    }

    /// Lights, poses, and which key-frames can be blended.
    fn prepare(&mut self, time: f64) -> Result<()> {
        self.scene.set_lights(&self.animation.lights(time))?;
        for (mesh, moving) in self.meshes.iter_mut().enumerate() {
            match &mut moving.motion {
                Way::Still => {}
                Way::Keys { shelf, next, placing, .. } => {
                    if let Some(placing) = placing {
                        self.animation.pose(mesh, time, &mut placing.next);
                    }
                    let can_blend = match (shelf.slot(next.first), shelf.slot(next.second)) {
                        (Some(first), Some(second)) => {
                            Arc::ptr_eq(&first.lists.indices, &second.lists.indices) && first.size.vertices == second.size.vertices
                        }
                        _ => false,
                    };
                    if !can_blend || next.weight <= 0.0 {
                        *next = KeyPair { first: next.first, second: next.first, weight: 0.0 };
                    }
                }
                Way::Bent { bent, .. } => {
                    self.animation.pose(mesh, time, &mut bent.next);
                    bent.prepare(self.animation.scene.meshes.get(mesh).map_or("", |mesh| &mesh.name))?;
                }
            }
        }
        Ok(())
    }

    /// Makes the scene's arrays larger where the key-frames do not fit. Returns how many buffers were made anew.
    fn make_room(&mut self) -> Result<u32> {
        let arrays = self.scene.arrays();
        let mut ranges = Vec::with_capacity(self.meshes.len());
        let (mut vertices, mut triangles) = (0_u64, 0_u64);
        let mut is_enough = true;
        let mut has_colours = arrays.colours.is_some();
        for (moving, range) in self.meshes.iter().zip(self.scene.ranges()) {
            let mut room = range.room;
            match &moving.motion {
                Way::Keys { shelf, .. } => {
                    // Those read ahead count too: what is to come soon should not make the arrays anew once more.
                    let Size { vertices: needed, triangles: more, has_colours: coloured } = shelf.largest();
                    has_colours |= coloured;
                    if needed > room {
                        room = u32::try_from(with_slack(needed.into(), room.into())).unwrap_or(u32::MAX);
                        is_enough = false;
                    }
                    triangles += u64::from(more);
                }
                _ => triangles += u64::from(moving.placed.triangle_count),
            }
            ranges.push(VertexRange { first: u32::try_from(vertices).unwrap_or(u32::MAX), count: range.count, room });
            vertices += u64::from(room);
        }
        let mut triangle_room = u64::from(arrays.triangle_room());
        if triangles > triangle_room {
            triangle_room = with_slack(triangles, triangle_room).min(u64::from(gridwalk::MAX_TRIANGLES).max(triangles));
            is_enough = false;
        }
        if is_enough && has_colours == arrays.colours.is_some() {
            return Ok(0);
        }
        let (vertices, triangles) = check_room(vertices, triangle_room)?;
        let made = Arrays::new(&self.context, vertices, triangles, has_colours, arrays.has_opacities())?;
        for (((mesh_id, moving), range), mesh) in (0..).zip(&self.meshes).zip(&ranges).zip(&self.animation.scene.meshes) {
            if !matches!(moving.motion, Way::Keys { .. }) {
                made.write_vertices(mesh, range.first)?;
                if moving.placed.source.is_none() {
                    made.write_triangles(mesh, mesh_id, range.first, moving.placed.first_triangle)?;
                }
            }
        }
        self.scene.replace_arrays(made, ranges);
        for moving in &mut self.meshes {
            moving.placed.lists = None;
            if moving.placed.source.is_some() {
                // No vertex of a triangle begins there: it will be put anew.
                moving.placed.first_vertex = u32::MAX;
            }
            match &mut moving.motion {
                Way::Still => {}
                Way::Keys { shown, .. } => *shown = None,
                Way::Bent { is_shown, .. } => *is_shown = false,
            }
        }
        Ok(self.scene.arrays().count())
    }

    /// What has to be done, and the counts that the scene will have.
    fn plan(&mut self) -> Work {
        let mut work = Work::default();
        let mut counts = Vec::with_capacity(self.meshes.len());
        let mut starts = Vec::with_capacity(self.meshes.len());
        let mut first_triangle = 0;
        for (index, (moving, range)) in self.meshes.iter_mut().zip(self.scene.ranges()).enumerate() {
            let placed = &mut moving.placed;
            let mut count = range.count;
            let mut is_moved = placed.first_triangle != first_triangle || placed.first_vertex != range.first;
            match &moving.motion {
                Way::Still => {}
                Way::Keys { shelf, next, shown, placing } => {
                    if *shown != Some(*next) || placing.as_ref().is_some_and(|placing| placing.next != placing.shown) {
                        work.vertices.push(index);
                    }
                    if let Some(slot) = shelf.slot(next.first) {
                        count = slot.size.vertices;
                        placed.triangle_count = slot.size.triangles;
                        is_moved |= !placed.lists.as_ref().is_some_and(|lists| lists.are(&slot.lists));
                    }
                }
                Way::Bent { bent, is_shown } => {
                    if !is_shown || bent.shown != bent.next {
                        work.vertices.push(index);
                    }
                }
            }
            if is_moved {
                work.triangles.push(index);
            }
            counts.push(count);
            starts.push(first_triangle);
            first_triangle += placed.triangle_count;
        }
        self.scene.set_counts(&counts, &starts, first_triangle);
        work
    }

    /// Runs the kernels, after the copies that they read, and keeps in mind what the scene shows now.
    fn submit(&mut self, work: &Work) -> Result<()> {
        let mut after = 0;
        for moving in work.vertices.iter().chain(&work.triangles).filter_map(|&index| self.meshes.get(index)) {
            if let Way::Keys { shelf, next, .. } = &moving.motion {
                after = keys(next).iter().filter_map(|&key| shelf.slot(key)).map(|slot| slot.value).fold(after, u64::max);
            }
        }
        let after = (after > 0).then(|| self.timeline.moment(after));
        let (context, scene, meshes, timer) = (&self.context, &self.scene, &self.meshes, &mut self.timer);
        let kernels = &self.kernels;
        context.submit_after("the scene at a time", after, |cmd| {
            let mut recorder = Recorder::new(context, cmd, timer);
            recorder.step("update", "copy", |cmd| {
                scene.record_tables(context.device(), cmd);
                for moving in work.vertices.iter().filter_map(|&index| meshes.get(index)) {
                    let update = |(buffer, offset, bytes)| update_buffer(context.device(), cmd, buffer, offset, bytes);
                    match &moving.motion {
                        Way::Bent { bent, .. } => bent.pose_parts().into_iter().for_each(update),
                        Way::Keys { placing: Some(placing), .. } => update(placing.pose_part()),
                        _ => {}
                    }
                }
            });
            for &index in &work.vertices {
                let (Some(moving), Some(range)) = (meshes.get(index), scene.ranges().get(index)) else { continue };
                match &moving.motion {
                    Way::Still => {}
                    Way::Keys { shelf, next, placing, .. } => {
                        record_keys(&mut recorder, kernels, scene.arrays(), range, shelf, next);
                        if let (Some(placing), Some(slot)) = (placing, shelf.slot(next.first)) {
                            placing.record(&mut recorder, &kernels.bend, scene.arrays(), range, slot.size.vertices);
                        }
                    }
                    Way::Bent { bent, .. } => bent.record(&mut recorder, &kernels.bend, scene.arrays(), range),
                }
            }
            for &index in &work.triangles {
                if let (Some(moving), Ok(mesh)) = (meshes.get(index), u32::try_from(index)) {
                    record_triangles(&mut recorder, &kernels.place, scene, moving, mesh);
                }
            }
            Ok(())
        })?;
        self.timer.collect()?;
        self.scene.tables_are_written();
        for &index in &work.vertices {
            match self.meshes.get_mut(index).map(|moving| &mut moving.motion) {
                Some(Way::Keys { next, shown, placing, .. }) => {
                    *shown = Some(*next);
                    if let Some(placing) = placing {
                        let placing = &mut **placing;
                        placing.shown.clone_from(&placing.next);
                    }
                }
                Some(Way::Bent { bent, is_shown }) => {
                    let bent = &mut **bent;
                    bent.shown.clone_from(&bent.next);
                    *is_shown = true;
                }
                _ => {}
            }
        }
        for &index in &work.triangles {
            let (Some(moving), Some(range)) = (self.meshes.get_mut(index), self.scene.ranges().get(index)) else { continue };
            moving.placed.first_vertex = range.first;
            moving.placed.first_triangle = self.scene.mesh_starts().get(index).copied().unwrap_or(0);
            if let Way::Keys { shelf, next, .. } = &moving.motion
                && let Some(slot) = shelf.slot(next.first)
            {
                moving.placed.lists = Some(slot.lists.clone());
            }
        }
        Ok(())
    }

    /// Adds what the key-frames took that this seek is the first to need.
    fn tell_news(&mut self, time: f64, busy_ms: f64, stats: &mut SeekStats) -> Result<()> {
        let mut beside_ms = 0.0;
        for (mesh, shelf, _) in shelves(&mut self.meshes) {
            for key in keys(&self.animation.keys_at(mesh, time)) {
                let (Some(news), Some(slot)) = (shelf.news(key), shelf.slot(key)) else { continue };
                // Done by now, but for a second key-frame that cannot be blended with the first: nothing has read it.
                self.timeline.wait(slot.value)?;
                stats.key_frames += 1;
                stats.read_ms += news.read_ms;
                stats.parse_ms += news.parse_ms;
                stats.stage_ms += news.stage_ms;
                let upload_ms = self.timeline.milliseconds(slot.number)?;
                stats.upload_ms += upload_ms;
                // Of what was waited for, the copies come after the wait.
                beside_ms += news.read_ms + news.parse_ms + news.stage_ms + if news.was_waited_for { 0.0 } else { upload_ms };
                stats.warnings.extend(news.warnings);
            }
        }
        // What this seek did not see done ran beside what the caller did before.
        stats.hidden_ms = (beside_ms - busy_ms).max(0.0);
        Ok(())
    }
}

/// Times ahead that are looked at: a slot or two can be spared, and a key-frame may serve several frames.
const UPCOMING: usize = 32;

/// Buffers of a grid with its build.
const GRID_BUFFERS: u32 = 3;

/// Every mesh of key-frames: its number, its slots, and the key-frames to come.
fn shelves(meshes: &mut [Moving]) -> impl Iterator<Item = (usize, &mut Shelf, &mut KeyPair)> {
    meshes.iter_mut().enumerate().filter_map(|(mesh, moving)| match &mut moving.motion {
        Way::Keys { shelf, next, .. } => Some((mesh, &mut **shelf, next)),
        _ => None,
    })
}

/// The key-frames of a pair.
fn keys(pair: &KeyPair) -> Vec<u32> {
    if pair.weight > 0.0 && pair.second != pair.first { vec![pair.first, pair.second] } else { vec![pair.first] }
}

fn ask_for_needed(meshes: &mut [Moving], loader: &Loader) {
    for (mesh, shelf, next) in shelves(meshes) {
        let needed = keys(next);
        for &key in &needed {
            if let Some(slot) = shelf.lend(key, &needed) {
                loader.ask(Request { mesh, key, slot });
            }
        }
    }
}

/// Takes in what became of a key-frame; returns how many buffers were made anew for it.
fn settle(meshes: &mut [Moving], animation: &mut Animation, reply: Reply, was_waited_for: bool) -> u32 {
    let Reply { mesh, key, slot, mut result } = reply;
    let mut grown = 0;
    if let Ok(arrival) = &mut result {
        grown = arrival.grown;
        arrival.was_waited_for = was_waited_for;
        animation.scene.materials.append(&mut arrival.added_materials);
        animation.scene.textures.append(&mut arrival.added_textures);
    }
    if let Some(Way::Keys { shelf, .. }) = meshes.get_mut(mesh).map(|moving| &mut moving.motion) {
        shelf.settle(key, slot, result);
    }
    grown
}

/// Vertices between two key-frames.
fn record_keys(recorder: &mut Recorder<'_>, kernels: &MotionKernels, arrays: &Arrays, range: &VertexRange, shelf: &Shelf, pair: &KeyPair) {
    let (Some(first), Some(second)) = (shelf.slot(pair.first), shelf.slot(pair.second)) else { return };
    let (from, to) = (SlotLayout::new(first.room), SlotLayout::new(second.room));
    let (first_at, second_at) = (first.memory.address(), second.memory.address());
    let begin = u64::from(range.first);
    let push = push::Interpolate {
        first_positions: first_at + from.positions,
        first_normals: first_at + from.normals,
        first_uvs: first_at + from.uvs,
        second_positions: second_at + to.positions,
        second_normals: second_at + to.normals,
        second_uvs: second_at + to.uvs,
        positions: arrays.positions.address() + begin * 12,
        normals: arrays.normals.address() + begin * 12,
        uvs: arrays.uvs.address() + begin * 8,
        vertex_count: first.size.vertices,
        weight: pair.weight,
    };
    recorder.dispatch(&kernels.interpolate, &push, map_groups(first.size.vertices));
    if let Some(colours) = &arrays.colours {
        // Colours of one alone stay as they are.
        let weight = if second.size.has_colours { pair.weight } else { 0.0 };
        let word_count = first.size.vertices.saturating_mul(3);
        let push = push::InterpolateColours {
            first_colours: first_at + from.colours,
            second_colours: second_at + to.colours,
            colours: colours.address() + begin * 12,
            word_count,
            weight,
            has_colours: u32::from(first.size.has_colours),
            padding: 0,
        };
        recorder.dispatch(&kernels.interpolate_colours, &push, map_groups(word_count));
    }
}

/// Triangles of a mesh, to where they are now in the scene.
fn record_triangles(recorder: &mut Recorder<'_>, place: &Pipeline, scene: &GpuScene, moving: &Moving, mesh: u32) {
    let (Some(range), Some(&first_triangle)) = (scene.ranges().get(mesh as usize), scene.mesh_starts().get(mesh as usize)) else {
        return;
    };
    let (mesh_indices, mesh_materials) = match (&moving.motion, &moving.placed.source) {
        (Way::Keys { shelf, next, .. }, _) => {
            let Some(slot) = shelf.slot(next.first) else { return };
            let layout = SlotLayout::new(slot.room);
            (slot.memory.address() + layout.indices, slot.memory.address() + layout.materials)
        }
        (_, Some([indices, materials])) => (indices.address(), materials.address()),
        _ => return,
    };
    let push = push::Place {
        mesh_indices,
        mesh_materials,
        indices: scene.arrays().indices.address(),
        surrounds: scene.arrays().surrounds.address(),
        triangle_count: moving.placed.triangle_count,
        first_triangle,
        first_vertex: range.first,
        mesh,
    };
    recorder.dispatch(place, &push, map_groups(moving.placed.triangle_count));
}
