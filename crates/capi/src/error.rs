//! Errors with a code, a message kept for the thread, and the end of all panics.

use std::cell::UnsafeCell;
use std::ffi::c_char;
use std::fmt::{self, Display, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};

use gridwalk::ash::vk;

use crate::types::GridwalkResult;

/// Result within this crate.
pub type Result<T> = std::result::Result<T, Failure>;

/// What a function could not do.
#[derive(Debug)]
pub enum Failure {
    /// A null pointer or handle: its name.
    Null(&'static str),
    /// A structure that cannot be read.
    Struct(String),
    /// A function that Vulkan does not know, and who was asked.
    Loader { function: String, of: &'static str },
    /// An option, said in words.
    Option(String),
    /// The library's own.
    Library(gridwalk::Error),
}

impl From<gridwalk::Error> for Failure {
    fn from(error: gridwalk::Error) -> Failure {
        Failure::Library(error)
    }
}

impl Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Failure::Null(name) => write!(f, "{name} is null"),
            Failure::Struct(text) | Failure::Option(text) => f.write_str(text),
            Failure::Loader { function, of } => write!(f, "{function} cannot be found: the {of} was not created for Vulkan 1.3"),
            Failure::Library(error) => error.fmt(f),
        }
    }
}

impl Failure {
    fn result(&self) -> GridwalkResult {
        match self {
            Failure::Null(_) => GridwalkResult::ErrorNull,
            Failure::Struct(_) => GridwalkResult::ErrorStruct,
            Failure::Loader { .. } => GridwalkResult::ErrorLoader,
            Failure::Option(_) => GridwalkResult::ErrorOption,
            Failure::Library(error) => match error {
                gridwalk::Error::Vulkan { .. } => GridwalkResult::ErrorVulkan,
                gridwalk::Error::Unsuitable { .. } => GridwalkResult::ErrorUnsuitable,
                gridwalk::Error::Chain { .. } => GridwalkResult::ErrorStruct,
                gridwalk::Error::Capacity { .. } => GridwalkResult::ErrorCapacity,
                gridwalk::Error::DeviceLimit { .. } => GridwalkResult::ErrorDeviceLimit,
                gridwalk::Error::Region { .. } => GridwalkResult::ErrorRegion,
                gridwalk::Error::Option { .. } => GridwalkResult::ErrorOption,
                // The enum may grow; its message says what this code does not.
                _ => GridwalkResult::ErrorInternal,
            },
        }
    }

    fn vk_result(&self) -> vk::Result {
        match self {
            Failure::Library(gridwalk::Error::Vulkan { result, .. }) => *result,
            _ => vk::Result::SUCCESS,
        }
    }
}

/// Bytes of a thread's message, its end included. The longest names all that a device lacks.
const MESSAGE_SIZE: usize = 2048;

struct Last {
    text: [u8; MESSAGE_SIZE],
    vk_result: vk::Result,
}

thread_local! {
    /// Constant and without a destructor: it needs no memory but its own, and can be read until the thread has ended.
    static LAST: UnsafeCell<Last> = const { UnsafeCell::new(Last { text: [0; MESSAGE_SIZE], vk_result: vk::Result::SUCCESS }) };
}

/// Writes text that ends with a zero byte and is cut, between characters, where the room ends.
pub struct Text<'a> {
    room: &'a mut [u8],
    length: usize,
}

impl<'a> Text<'a> {
    /// Begins with an empty text.
    pub fn new(room: &'a mut [u8]) -> Text<'a> {
        if let Some(first) = room.first_mut() {
            *first = 0;
        }
        Text { room, length: 0 }
    }
}

impl Write for Text<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for character in text.chars().filter(|character| *character != '\0') {
            let end = self.length + character.len_utf8();
            let Some(room) = self.room.get_mut(self.length..=end).filter(|room| room.len() > character.len_utf8()) else {
                return Err(fmt::Error);
            };
            character.encode_utf8(room);
            self.room[end] = 0;
            self.length = end;
        }
        Ok(())
    }
}

fn keep(message: &dyn Display, vk_result: vk::Result) {
    LAST.with(|last| {
        // SAFETY: only this thread gets here, `Display` of our errors does not come back to this cell, and the pointer that
        // `last_message` gave is not read by Rust.
        let last = unsafe { &mut *last.get() };
        last.vk_result = vk_result;
        // Text that does not fit is cut, and ends.
        let _ = write!(Text::new(&mut last.text), "{message}");
    });
}

/// The message of the thread's last failure, ended by a zero byte; empty if nothing has failed.
pub fn last_message() -> *const c_char {
    // SAFETY: the pointer is within the cell; it is made without a reference to the rest.
    LAST.with(|last| unsafe { (&raw const (*last.get()).text).cast() })
}

/// What Vulkan said in the thread's last failure.
pub fn last_vk_result() -> vk::Result {
    // SAFETY: only this thread gets here, and `keep` is not running.
    LAST.with(|last| unsafe { (*last.get()).vk_result })
}

/// Runs the body of a function of the C interface: no panic leaves it.
pub fn guard(call: impl FnOnce() -> Result<()>) -> GridwalkResult {
    // What a panic may leave half done is the caller's output alone: a tracer is never changed.
    let caught = catch_unwind(AssertUnwindSafe(|| match call() {
        Ok(()) => GridwalkResult::Ok,
        Err(failure) => {
            keep(&failure, failure.vk_result());
            failure.result()
        }
    }));
    caught.unwrap_or_else(|payload| {
        // To drop it could panic again.
        std::mem::forget(payload);
        keep(&"a defect of gridwalk: see standard error", vk::Result::SUCCESS);
        GridwalkResult::ErrorInternal
    })
}

#[cfg(test)]
#[allow(clippy::panic, clippy::unwrap_used, reason = "a test that fails panics")]
mod tests {
    use std::ffi::CStr;

    use super::*;

    fn message() -> String {
        // SAFETY: the message ends with a zero byte and is of this thread.
        unsafe { CStr::from_ptr(last_message()) }.to_str().unwrap().to_owned()
    }

    #[test]
    fn a_panic_becomes_a_result() {
        struct Bomb;
        impl Drop for Bomb {
            fn drop(&mut self) {
                panic!("dropped");
            }
        }
        assert_eq!(guard(|| panic!("a defect")), GridwalkResult::ErrorInternal);
        assert_eq!(guard(|| std::panic::panic_any(Bomb)), GridwalkResult::ErrorInternal);
        assert!(message().contains("defect"), "{}", message());
    }

    #[test]
    fn messages_are_of_their_thread_and_stay_until_the_next_failure() {
        assert_eq!(guard(|| Err(Failure::Null("tracer"))), GridwalkResult::ErrorNull);
        assert_eq!(guard(|| Ok(())), GridwalkResult::Ok);
        assert_eq!(message(), "tracer is null");
        assert_eq!(std::thread::spawn(message).join().unwrap(), "");
        let error = gridwalk::Error::Vulkan { call: "vkCreateComputePipelines", result: vk::Result::ERROR_OUT_OF_HOST_MEMORY };
        assert_eq!(guard(|| Err(error.into())), GridwalkResult::ErrorVulkan);
        assert_eq!(last_vk_result(), vk::Result::ERROR_OUT_OF_HOST_MEMORY);
    }

    #[test]
    fn text_is_cut_between_characters() {
        let mut room = [0xFF; 5];
        assert!(write!(Text::new(&mut room), "abcä").is_err());
        assert_eq!(room[..4], *b"abc\0");
        let mut room = [0xFF; 6];
        assert!(write!(Text::new(&mut room), "abcä").is_ok());
        assert_eq!(CStr::from_bytes_until_nul(&room).unwrap().to_str().unwrap(), "abcä");
        assert!(write!(Text::new(&mut []), "a").is_err());
        assert_eq!(guard(|| Err(Failure::Struct("x".repeat(5000)))), GridwalkResult::ErrorStruct);
        assert_eq!(message().len(), MESSAGE_SIZE - 1);
    }
}
