//! The thread that reads key-frames and sends them to the device.

use super::staging::{Parcel, Staging, Timeline};
use crate::{
    Buffer, BufferDesc, BufferKind, Context, Error, Result,
    scene::{check_mesh, with_slack},
};
use gridwalk_scene::{KeyFrame, KeyReader, Material, Texture};
use std::{
    collections::VecDeque,
    sync::{
        Arc, Condvar, Mutex, MutexGuard, PoisonError, Weak,
        mpsc::{Receiver, Sender, channel},
    },
    thread::JoinHandle,
    time::Instant,
};

/// How many vertices and triangles something has, or has room for, and whether for colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Size {
    pub(super) vertices: u32,
    pub(super) triangles: u32,
    pub(super) has_colours: bool,
}

impl Size {
    fn holds(self, other: Size) -> bool {
        self.vertices >= other.vertices && self.triangles >= other.triangles && self.has_colours >= other.has_colours
    }
}

/// Vertex indices and materials of triangles. Equal ones that lie in slots at the same time are one.
#[derive(Clone, Debug, Default)]
pub(super) struct Lists {
    pub(super) indices: Arc<Vec<[u32; 3]>>,
    pub(super) materials: Arc<Vec<u32>>,
}

impl Lists {
    /// Whether these are those.
    pub(super) fn are(&self, others: &Lists) -> bool {
        Arc::ptr_eq(&self.indices, &others.indices) && Arc::ptr_eq(&self.materials, &others.materials)
    }
}

/// Where in a slot each array begins, in bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlotLayout {
    pub(super) positions: u64,
    pub(super) normals: u64,
    pub(super) uvs: u64,
    pub(super) colours: u64,
    pub(super) indices: u64,
    pub(super) materials: u64,
    end: u64,
}

impl SlotLayout {
    pub(super) fn new(room: Size) -> SlotLayout {
        let (vertices, triangles) = (u64::from(room.vertices), u64::from(room.triangles));
        let mut end = 0;
        let mut part = |bytes: u64| {
            let begin = end;
            end = (end + bytes).next_multiple_of(16);
            begin
        };
        let (positions, normals, uvs) = (part(vertices * 12), part(vertices * 12), part(vertices * 8));
        let colours = part(if room.has_colours { vertices * 12 } else { 0 });
        let (indices, materials) = (part(triangles * 12), part(triangles * 4));
        SlotLayout { positions, normals, uvs, colours, indices, materials, end }
    }
}

/// Memory for one key-frame of a mesh. Whoever holds the slot may write it: the player gives it away only when no frame reads it.
#[derive(Debug)]
pub(super) struct Slot {
    /// Its pair of timestamps.
    pub(super) number: u32,
    pub(super) memory: Buffer,
    pub(super) room: Size,
    /// What it holds of each key-frame, once something was sent to it.
    pub(super) size: Size,
    pub(super) lists: Lists,
    /// When its last copies have arrived; 0 before the first.
    pub(super) value: u64,
}

impl Slot {
    pub(super) fn new(context: &Context, number: u32, room: Size) -> Result<Slot> {
        Ok(Slot { number, memory: slot_memory(context, room)?, room, size: Size::default(), lists: Lists::default(), value: 0 })
    }
}

fn slot_memory(context: &Context, room: Size) -> Result<Buffer> {
    let size = SlotLayout::new(room).end;
    context.shared_buffer(&BufferDesc { name: "key-frame", size, kind: BufferKind::Device, dedicated: false })
}

/// A key-frame to be read.
pub(super) struct Request {
    pub(super) mesh: usize,
    pub(super) key: u32,
    pub(super) slot: Slot,
}

/// A key-frame that was read, or why it was not, with the slot that was lent for it.
pub(super) struct Reply {
    pub(super) mesh: usize,
    pub(super) key: u32,
    pub(super) slot: Slot,
    pub(super) result: Result<Arrival>,
}

/// What a key-frame brought beside its mesh, and what it took.
#[derive(Debug, Default)]
pub(super) struct Arrival {
    pub(super) added_materials: Vec<Material>,
    pub(super) added_textures: Vec<Texture>,
    pub(super) warnings: Vec<String>,
    pub(super) read_ms: f64,
    pub(super) parse_ms: f64,
    pub(super) stage_ms: f64,
    /// Whether a seek had to wait for it.
    pub(super) was_waited_for: bool,
    /// Buffers that were made anew.
    pub(super) grown: u32,
}

/// Requests that the thread has not begun with.
#[derive(Default)]
struct Inbox {
    requests: VecDeque<Request>,
    closed: bool,
}

#[derive(Default)]
struct Door {
    inbox: Mutex<Inbox>,
    bell: Condvar,
}

fn lock(door: &Door) -> MutexGuard<'_, Inbox> {
    door.inbox.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The thread, as the player sees it. When dropped, it ends after the key-frame that it is at.
pub(super) struct Loader {
    door: Arc<Door>,
    replies: Receiver<Reply>,
    thread: Option<JoinHandle<()>>,
}

impl std::fmt::Debug for Loader {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Loader").finish_non_exhaustive()
    }
}

impl Loader {
    /// Starts the thread. `rooms` are those of each mesh's slots, `materials` the number of the scene's materials.
    pub(super) fn new(
        context: &Context,
        reader: KeyReader,
        timeline: &Arc<Timeline>,
        staging_bytes: u64,
        rooms: Vec<Size>,
        materials: usize,
    ) -> Result<Loader> {
        let door = Arc::<Door>::default();
        let (sender, replies) = channel();
        let known = rooms.iter().map(|_| Known::default()).collect();
        let staging = Staging::new(context, timeline, staging_bytes)?;
        let mut worker = Worker { context: context.clone(), reader, staging, timeline: Arc::clone(timeline), rooms, known, materials };
        let behind = Arc::clone(&door);
        let thread = std::thread::Builder::new()
            .name("key-frames".to_owned())
            .spawn(move || worker.run(&behind, &sender))
            .map_err(|error| Error::Scene { reason: format!("no thread can be started to read key-frames: {error}") })?;
        Ok(Loader { door, replies, thread: Some(thread) })
    }

    /// Asks for a key-frame, after all that were asked for before.
    pub(super) fn ask(&self, request: Request) {
        lock(&self.door).requests.push_back(request);
        self.door.bell.notify_one();
    }

    /// Takes everything back that was not begun.
    pub(super) fn take_back(&self) -> VecDeque<Request> {
        std::mem::take(&mut lock(&self.door).requests)
    }

    /// A reply, if there is one.
    pub(super) fn poll(&self) -> Option<Reply> {
        self.replies.try_recv().ok()
    }

    /// Waits for a reply.
    pub(super) fn wait(&self) -> Result<Reply> {
        self.replies.recv().map_err(|_| Error::Scene { reason: "the thread that reads key-frames has ended".to_owned() })
    }
}

impl Drop for Loader {
    fn drop(&mut self) {
        lock(&self.door).closed = true;
        self.door.bell.notify_one();
        if let Some(thread) = self.thread.take() {
            // A panic was reported by the thread itself.
            let _ = thread.join();
        }
    }
}

/// Lists that some slot holds, so that equal ones are one.
#[derive(Default)]
struct Known {
    indices: Vec<Weak<Vec<[u32; 3]>>>,
    materials: Vec<Weak<Vec<u32>>>,
}

/// One of the known lists if it is equal to the given one, else a new one.
fn intern<T: PartialEq>(known: &mut Vec<Weak<Vec<T>>>, list: Vec<T>) -> Arc<Vec<T>> {
    known.retain(|known| known.strong_count() > 0);
    if let Some(same) = known.iter().filter_map(Weak::upgrade).find(|known| **known == list) {
        return same;
    }
    let list = Arc::new(list);
    known.push(Arc::downgrade(&list));
    list
}

struct Worker {
    context: Context,
    reader: KeyReader,
    /// Waits for all copies when it is dropped.
    staging: Staging,
    timeline: Arc<Timeline>,
    rooms: Vec<Size>,
    known: Vec<Known>,
    materials: usize,
}

impl Worker {
    fn run(&mut self, door: &Door, replies: &Sender<Reply>) {
        loop {
            let mut inbox = lock(door);
            while inbox.requests.is_empty() && !inbox.closed {
                inbox = door.bell.wait(inbox).unwrap_or_else(PoisonError::into_inner);
            }
            if inbox.closed {
                return;
            }
            let Some(Request { mesh, key, mut slot }) = inbox.requests.pop_front() else { continue };
            drop(inbox);
            let result = self.serve(mesh, key, &mut slot);
            if replies.send(Reply { mesh, key, slot, result }).is_err() {
                return;
            }
        }
    }

    fn serve(&mut self, mesh: usize, key: u32, slot: &mut Slot) -> Result<Arrival> {
        let KeyFrame { mesh: frame, added_materials, added_textures, warnings, read_ms, parse_ms } = self.reader.read(mesh, key)?;
        // The reader counts them from now on, whatever becomes of this key-frame.
        self.materials += added_materials.len();
        let mut arrival = Arrival { added_materials, added_textures, warnings, read_ms, parse_ms, ..Arrival::default() };
        let begin = Instant::now();
        check_mesh(&frame, self.materials).map_err(|reason| Error::Scene { reason: format!("key-frame {key}: {reason}") })?;
        let count = |what: &str, count: usize, most: u32| {
            u32::try_from(count).ok().filter(|&count| count <= most).ok_or_else(|| Error::Scene {
                reason: format!("key-frame {key} of mesh {}: {count} {what}; {most} are possible", frame.name),
            })
        };
        let size = Size {
            vertices: count("vertices", frame.positions.len(), gridwalk::MAX_VERTICES)?,
            triangles: count("triangles", frame.indices.len(), gridwalk::MAX_TRIANGLES)?,
            has_colours: !frame.colours.is_empty(),
        };
        // Copies that nobody came to read may still be under way.
        self.timeline.wait(slot.value)?;
        self.make_room(mesh, size, slot, &mut arrival)?;
        let Some(known) = self.known.get_mut(mesh) else {
            return Err(Error::Scene { reason: format!("there is no mesh {mesh}") });
        };
        let had = slot.lists.clone();
        let lists = Lists { indices: intern(&mut known.indices, frame.indices), materials: intern(&mut known.materials, frame.materials) };
        let layout = SlotLayout::new(slot.room);
        let mut parcels = vec![
            Parcel { bytes: bytemuck::cast_slice(&frame.positions), offset: layout.positions },
            Parcel { bytes: bytemuck::cast_slice(&frame.normals), offset: layout.normals },
            Parcel { bytes: bytemuck::cast_slice(&frame.uvs), offset: layout.uvs },
            Parcel { bytes: bytemuck::cast_slice(&frame.colours), offset: layout.colours },
        ];
        // In most sequences they are those that the slot holds already.
        if slot.value == 0 || !Arc::ptr_eq(&lists.indices, &had.indices) {
            parcels.push(Parcel { bytes: bytemuck::cast_slice(&lists.indices), offset: layout.indices });
        }
        if slot.value == 0 || !Arc::ptr_eq(&lists.materials, &had.materials) {
            parcels.push(Parcel { bytes: bytemuck::cast_slice(&lists.materials), offset: layout.materials });
        }
        // Until all is sent it holds nothing that could be trusted.
        (slot.lists, slot.size) = (Lists::default(), Size::default());
        // SAFETY: the slot is this thread's until the reply, and then the player's, whose submissions wait for its value before they read
        // it; what the slot held before, no submission reads any more, and its copies were waited for.
        slot.value = unsafe { self.staging.send(&slot.memory, slot.number, &parcels) }?;
        (slot.lists, slot.size) = (lists, size);
        arrival.stage_ms = begin.elapsed().as_secs_f64() * 1e3;
        Ok(arrival)
    }

    /// Gives a slot the memory of the largest key-frame of its mesh so far.
    fn make_room(&mut self, mesh: usize, size: Size, slot: &mut Slot, arrival: &mut Arrival) -> Result<()> {
        let Some(room) = self.rooms.get_mut(mesh) else { return Ok(()) };
        let larger = |needed: u32, now: u32, most: u32| {
            if needed <= now { now } else { u32::try_from(with_slack(needed.into(), now.into())).unwrap_or(most).min(most) }
        };
        room.vertices = larger(size.vertices, room.vertices, gridwalk::MAX_VERTICES);
        room.triangles = larger(size.triangles, room.triangles, gridwalk::MAX_TRIANGLES);
        room.has_colours |= size.has_colours;
        if slot.room.holds(*room) {
            return Ok(());
        }
        slot.memory = slot_memory(&self.context, *room)?;
        slot.room = *room;
        slot.value = 0;
        arrival.grown += 1;
        Ok(())
    }
}
