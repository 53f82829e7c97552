//! What the integration tests share.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs, reason = "a test that fails panics")]

pub mod foreign;
pub mod gpu;
pub mod meshes;
pub mod random;
