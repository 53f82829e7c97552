//! The C interface of `gridwalk`: `include/gridwalk.h`, made from this crate by cbindgen, whose head is the contract for C.
//!
//! Rust programs use crate `gridwalk`. Every function here checks its pointers, calls the library, and turns errors into a
//! [`GridwalkResult`](types::GridwalkResult) with a message kept for the thread. Panics end there, never in the caller.

#[cfg(not(panic = "unwind"))]
compile_error!("gridwalk-capi promises that no call ends the process: build it with panic = \"unwind\"");

mod error;
pub mod functions;
mod input;
mod load;
#[cfg(test)]
mod recording;
pub mod types;
