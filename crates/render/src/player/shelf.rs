//! Which key-frames of a mesh lie in which of its slots.

use super::loader::{Arrival, Size, Slot};
use crate::Error;

/// Slots of a mesh: two to be read, one to be filled meanwhile.
const SLOTS: usize = 3;

/// What became of a slot.
#[derive(Debug)]
enum Place {
    /// It holds nothing.
    Free(Slot),
    /// It was lent to the loader for a key-frame.
    Lent { key: u32 },
    /// It holds a key-frame; with what that took, until a seek has used it.
    Full { key: u32, slot: Slot, news: Option<Arrival> },
    /// The key-frame could not be read, which matters only to those who need it.
    Failed { key: u32, slot: Slot, error: Error },
    /// Only while its content moves.
    Moving,
}

impl Place {
    fn key(&self) -> Option<u32> {
        match self {
            Place::Free(_) | Place::Moving => None,
            Place::Lent { key } | Place::Full { key, .. } | Place::Failed { key, .. } => Some(*key),
        }
    }

    fn take(&mut self) -> Place {
        std::mem::replace(self, Place::Moving)
    }
}

/// The slots of a mesh.
#[derive(Debug)]
pub(super) struct Shelf {
    places: [Place; SLOTS],
}

impl Shelf {
    pub(super) fn new(slots: [Slot; SLOTS]) -> Shelf {
        Shelf { places: slots.map(Place::Free) }
    }

    fn find(&self, key: u32) -> Option<&Place> {
        self.places.iter().find(|place| place.key() == Some(key))
    }

    /// Whether it is known what became of a key-frame.
    pub(super) fn is_settled(&self, key: u32) -> bool {
        matches!(self.find(key), Some(Place::Full { .. } | Place::Failed { .. }))
    }

    /// The slot that holds a key-frame.
    pub(super) fn slot(&self, key: u32) -> Option<&Slot> {
        match self.find(key) {
            Some(Place::Full { slot, .. }) => Some(slot),
            _ => None,
        }
    }

    /// What a key-frame took, when it is asked for the first time.
    pub(super) fn news(&mut self, key: u32) -> Option<Arrival> {
        self.places.iter_mut().find_map(|place| match place {
            Place::Full { key: held, news, .. } if *held == key => news.take(),
            _ => None,
        })
    }

    /// A slot to be lent for a key-frame, if that is not here yet and a slot can be spared: none of those with a key-frame to be `kept`.
    pub(super) fn lend(&mut self, key: u32, kept: &[u32]) -> Option<Slot> {
        if self.find(key).is_some() {
            return None;
        }
        let idle = |place: &&mut Place| match place {
            Place::Free(_) => true,
            Place::Full { key, .. } | Place::Failed { key, .. } => !kept.contains(key),
            Place::Lent { .. } | Place::Moving => false,
        };
        let rank = |place: &&mut Place| match place {
            Place::Free(_) => 0,
            Place::Failed { .. } => 1,
            _ => 2,
        };
        let place = self.places.iter_mut().filter(idle).min_by_key(rank)?;
        match place.take() {
            Place::Free(slot) | Place::Full { slot, .. } | Place::Failed { slot, .. } => {
                *place = Place::Lent { key };
                Some(slot)
            }
            other => {
                *place = other;
                None
            }
        }
    }

    fn lent(&mut self, key: u32) -> Option<&mut Place> {
        self.places.iter_mut().find(|place| matches!(place, Place::Lent { key: lent } if *lent == key))
    }

    /// Takes a slot back that was lent for nothing.
    pub(super) fn give_back(&mut self, key: u32, slot: Slot) {
        if let Some(place) = self.lent(key) {
            *place = Place::Free(slot);
        }
    }

    /// Takes a slot back with what became of its key-frame.
    pub(super) fn settle(&mut self, key: u32, slot: Slot, result: Result<Arrival, Error>) {
        if let Some(place) = self.lent(key) {
            *place = match result {
                Ok(arrival) => Place::Full { key, slot, news: Some(arrival) },
                Err(error) => Place::Failed { key, slot, error },
            };
        }
    }

    /// Why a key-frame could not be read. The next request for it tries again.
    pub(super) fn failure(&mut self, key: u32) -> Option<Error> {
        let place = self.places.iter_mut().find(|place| matches!(place, Place::Failed { key: failed, .. } if *failed == key))?;
        match place.take() {
            Place::Failed { slot, error, .. } => {
                *place = Place::Free(slot);
                Some(error)
            }
            other => {
                *place = other;
                None
            }
        }
    }

    /// The most vertices and triangles of the key-frames that are here.
    pub(super) fn largest(&self) -> Size {
        self.places.iter().fold(Size::default(), |size, place| match place {
            Place::Full { slot, .. } => Size {
                vertices: size.vertices.max(slot.size.vertices),
                triangles: size.triangles.max(slot.size.triangles),
                has_colours: size.has_colours || slot.size.has_colours,
            },
            _ => size,
        })
    }
}
