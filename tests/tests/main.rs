//! Integration tests of gridwalk.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs, reason = "a test that fails panics")]

mod animation;
mod capi;
mod cli;
mod contract;
mod examples;
mod image;
mod kernels;
mod package;
mod rebuild;
mod render;
mod repository;
mod scene;
mod traverse;
