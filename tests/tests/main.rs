//! Integration tests of gridwalk.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs, reason = "a test that fails panics")]

mod image;
mod render;
mod repository;
mod scene;
mod traverse;
