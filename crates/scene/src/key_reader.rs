//! Key-frames from their files, each parsed once while there is room for it.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use crate::animation::{KeyTrack, blend};
use crate::assets::Assets;
use crate::mesh_file::{self, Timed};
use crate::moving::PlacedCurve;
use crate::{Error, KeyFrame, Mesh, Result};

/// Reads key-frames; made by [`Animation::reader`](crate::Animation::reader) for a thread of its own. It owns all that it needs.
///
/// Files are taken to stay as they are: one that was parsed is parsed again only when it fell out of the cache
/// ([`LoadOptions::max_key_cache_bytes`](crate::LoadOptions::max_key_cache_bytes)).
#[derive(Clone, Debug, Default)]
pub struct KeyReader {
    /// One a mesh; `None` for those without key-frames.
    tracks: Vec<Option<KeyTrack>>,
    /// `None` only where no mesh has key-frames.
    state: Option<Box<State>>,
}

#[derive(Clone, Debug)]
struct State {
    assets: Assets,
    cache: Cache,
    /// Materials that were handed over.
    handed: usize,
    /// Warnings that were given, so that a thousand key-frames with one slip give one.
    told: HashSet<String>,
}

impl KeyReader {
    /// `assets` and `cache` are those that the scene was read with, `told` its warnings.
    pub(crate) fn new(tracks: Vec<Option<KeyTrack>>, assets: Assets, cache: Cache, told: &[String]) -> Self {
        let handed = assets.materials().len();
        Self { tracks, state: Some(Box::new(State { assets, cache, handed, told: told.iter().cloned().collect() })) }
    }

    /// Reads a key-frame of a mesh. After an error the next key-frame can be read all the same.
    ///
    /// # Errors
    /// A file that is missing or broken, by name; a mesh or a key-frame that there is not.
    pub fn read(&mut self, mesh: usize, key: u32) -> Result<KeyFrame> {
        let track = self.tracks.get(mesh).and_then(Option::as_ref);
        let (Some(track), Some(state)) = (track, &mut self.state) else { return Err(Error::NoKeyFrame { key, count: 0 }) };
        let Timed { mesh, read_ms, parse_ms } = fetch(&mut state.assets, &mut state.cache, track, key)?;
        let added_materials = state.assets.materials()[state.handed..].to_vec();
        state.handed = state.assets.materials().len();
        let added_textures = state.assets.textures.take();
        let warnings = std::mem::take(&mut state.assets.warnings);
        let warnings = warnings.into_iter().filter(|warning| state.told.insert(warning.clone())).collect();
        Ok(KeyFrame { mesh, added_materials, added_textures, warnings, read_ms, parse_ms })
    }
}

/// A key-frame of a mesh, in world space, or before the matrix that moves it as a whole.
pub(crate) fn fetch(assets: &mut Assets, cache: &mut Cache, track: &KeyTrack, key: u32) -> Result<Timed> {
    let path = track.sequence.path(&assets.files, key)?;
    let begin = Instant::now();
    let (shared, read_ms) = match cache.get(&path) {
        Some(mesh) => (mesh, 0.0),
        None => {
            let Timed { mesh, read_ms, .. } = mesh_file::read(assets, &path, &track.sequence.shown(key))?;
            let mesh = Arc::new(mesh);
            cache.insert(path, mesh.clone());
            (mesh, read_ms)
        }
    };
    let mut mesh = Arc::unwrap_or_clone(shared);
    track.edit.apply(&mut mesh);
    if track.placed.as_ref().is_some_and(PlacedCurve::is_mirrored) {
        mesh.indices.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    Ok(Timed { mesh, read_ms, parse_ms: mesh_file::milliseconds(begin) - read_ms })
}

/// A sequence's mesh at time 0, in world space.
pub(crate) fn first_mesh(assets: &mut Assets, cache: &mut Cache, track: &KeyTrack) -> Result<Mesh> {
    let keys = track.at(0.0);
    let mut mesh = fetch(assets, cache, track, keys.first)?.mesh;
    if keys.weight > 0.0 {
        let second = fetch(assets, cache, track, keys.second)?.mesh;
        blend(&mut mesh, &second, keys.weight);
    }
    if let Some(placed) = &track.placed {
        placed.place(&mut mesh);
    }
    Ok(mesh)
}

/// The meshes of files, the least recently used one going first when there are more than so many bytes.
#[derive(Clone, Debug)]
pub(crate) struct Cache {
    limit: u64,
    bytes: u64,
    clock: u64,
    entries: HashMap<PathBuf, Entry>,
}

#[derive(Clone, Debug)]
struct Entry {
    mesh: Arc<Mesh>,
    bytes: u64,
    used: u64,
}

impl Cache {
    pub(crate) fn new(limit: u64) -> Self {
        Self { limit, bytes: 0, clock: 0, entries: HashMap::new() }
    }

    fn get(&mut self, path: &Path) -> Option<Arc<Mesh>> {
        self.clock += 1;
        let entry = self.entries.get_mut(path)?;
        entry.used = self.clock;
        Some(entry.mesh.clone())
    }

    fn insert(&mut self, path: PathBuf, mesh: Arc<Mesh>) {
        let bytes = mesh.byte_count();
        if bytes > self.limit {
            return;
        }
        while self.bytes + bytes > self.limit {
            // Every use has a number of its own, so which one goes does not depend on the table's order.
            let Some(oldest) = self.entries.iter().min_by_key(|(_, entry)| entry.used).map(|(path, _)| path.clone()) else { break };
            if let Some(entry) = self.entries.remove(&oldest) {
                self.bytes -= entry.bytes;
            }
        }
        self.bytes += bytes;
        self.clock += 1;
        self.entries.insert(path, Entry { mesh, bytes, used: self.clock });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_recently_used_goes_first_and_the_large_never_come_in() {
        let mesh = |vertices: usize| Arc::new(Mesh { positions: vec![[0.0; 3]; vertices], ..Mesh::default() });
        let mut cache = Cache::new(36);
        cache.insert("a".into(), mesh(1));
        cache.insert("b".into(), mesh(1));
        cache.insert("c".into(), mesh(1));
        assert!(cache.get(Path::new("a")).is_some());
        cache.insert("d".into(), mesh(1));
        cache.insert("e".into(), mesh(4));
        let held = ["a", "b", "c", "d", "e"].map(|name| cache.get(Path::new(name)).is_some());
        assert_eq!((held, cache.bytes), ([true, false, true, true, false], 36));
    }
}
