//! Reading what C passes.

use std::mem::MaybeUninit;

use crate::error::{Failure, Result};
use crate::types::{GridwalkBuildInfo, GridwalkDeviceDesc, GridwalkRaySortInfo, GridwalkTraceInfo};

/// A structure that may grow at its end, and whose first field is its size in bytes as its writer knows it.
///
/// # Safety
/// The type is `repr(C)`, begins with a `u32`, and all zeros are a value of it.
pub unsafe trait Growing: Copy {
    /// Its name in C.
    const NAME: &'static str;
    /// Its size in the first version that had it: fields beyond may be missing.
    const FIRST_SIZE: usize;
}

// SAFETY: as the trait asks; handles, addresses and an optional function are zero when absent.
unsafe impl Growing for GridwalkDeviceDesc {
    const NAME: &'static str = "GridwalkDeviceDesc";
    const FIRST_SIZE: usize = size_of::<Self>();
}

// SAFETY: as above.
unsafe impl Growing for GridwalkBuildInfo {
    const NAME: &'static str = "GridwalkBuildInfo";
    const FIRST_SIZE: usize = size_of::<Self>();
}

// SAFETY: as above.
unsafe impl Growing for GridwalkTraceInfo {
    const NAME: &'static str = "GridwalkTraceInfo";
    const FIRST_SIZE: usize = size_of::<Self>();
}

// SAFETY: as above.
unsafe impl Growing for GridwalkRaySortInfo {
    const NAME: &'static str = "GridwalkRaySortInfo";
    const FIRST_SIZE: usize = size_of::<Self>();
}

/// Greatest size that is believed: a larger one was never set.
const MAX_SIZE: usize = 4096;

/// Copies a growing structure: missing fields become zero, unknown ones must be zero.
///
/// # Safety
/// The pointer is null or points to a structure of as many bytes as its first field says.
pub unsafe fn read_growing<T: Growing>(pointer: *const T) -> Result<T> {
    if pointer.is_null() {
        return Err(Failure::Null(T::NAME));
    }
    // SAFETY: the first field is a u32 in any version.
    let given = unsafe { pointer.cast::<u32>().read_unaligned() } as usize;
    if given < T::FIRST_SIZE || given > MAX_SIZE {
        return Err(Failure::Struct(format!("{}::struct_size is {given}: set it to sizeof({})", T::NAME, T::NAME)));
    }
    let known = size_of::<T>();
    let mut value = MaybeUninit::<T>::zeroed();
    // SAFETY: both have that many bytes, and do not overlap.
    unsafe { std::ptr::copy_nonoverlapping(pointer.cast::<u8>(), value.as_mut_ptr().cast::<u8>(), given.min(known)) };
    for offset in known..given {
        // SAFETY: the structure has `given` bytes.
        if unsafe { pointer.cast::<u8>().add(offset).read() } != 0 {
            return Err(Failure::Struct(format!(
                "{} has a field at byte {offset} that this version of the library does not know: leave it at zero, or use a newer library",
                T::NAME
            )));
        }
    }
    // SAFETY: all zeros are a value, and so is what the caller's structure begins with.
    Ok(unsafe { value.assume_init() })
}

/// # Safety
/// The pointer is null, or valid for reads while the reference lives.
pub unsafe fn reference<'a, T>(pointer: *const T, name: &'static str) -> Result<&'a T> {
    // SAFETY: the caller's contract.
    unsafe { pointer.as_ref() }.ok_or(Failure::Null(name))
}

/// # Safety
/// The pointer is null, or valid for a write.
pub unsafe fn write<T>(pointer: *mut T, name: &'static str, value: T) -> Result<()> {
    if pointer.is_null() {
        return Err(Failure::Null(name));
    }
    // SAFETY: the caller's contract.
    unsafe { pointer.write(value) };
    Ok(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that fails panics")]
mod tests {
    use super::*;

    /// The structure as a version before and one after have it.
    #[repr(C)]
    #[derive(Clone, Copy, Default)]
    struct Grown {
        struct_size: u32,
        old: u32,
        new: u32,
    }

    // SAFETY: three integers.
    unsafe impl Growing for Grown {
        const NAME: &'static str = "Grown";
        const FIRST_SIZE: usize = 8;
    }

    fn read(words: &[u32]) -> Result<Grown> {
        // SAFETY: every size that a test gives is at most that of its words, or is refused.
        unsafe { read_growing(words.as_ptr().cast()) }
    }

    #[test]
    fn structures_of_other_versions_are_read() {
        let old = read(&[8, 5, 77]).unwrap();
        assert_eq!((old.old, old.new), (5, 0), "what lies behind the structure is not its own");
        let same = read(&[12, 5, 6]).unwrap();
        assert_eq!((same.old, same.new), (5, 6));
        let newer = read(&[16, 5, 6, 0]).unwrap();
        assert_eq!((newer.old, newer.new), (5, 6));
        for wrong in [&[16, 5, 6, 1][..], &[0, 5, 6], &[4, 5, 6], &[u32::MAX, 5, 6]] {
            assert!(matches!(read(wrong), Err(Failure::Struct(_))), "{wrong:?}");
        }
        // SAFETY: null is allowed.
        assert!(matches!(unsafe { read_growing::<Grown>(std::ptr::null()) }, Err(Failure::Null("Grown"))));
    }
}
