//! What a seek took.

use crate::{BuildStats, StepTime};

/// What it took to bring scene and grid to a time. The times of reading, parsing, staging and upload are those of the key-frames that this
/// seek is the first to need since they were read, whenever that was.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SeekStats {
    /// Whether the geometry changed, and the grid was built anew.
    pub rebuilt: bool,
    /// Key-frames that the times are of.
    pub key_frames: u32,
    /// Milliseconds of reading files.
    pub read_ms: f64,
    /// Milliseconds of making meshes of them.
    pub parse_ms: f64,
    /// Milliseconds of the host's copies into staging memory, waits for room in it included.
    pub stage_ms: f64,
    /// Device milliseconds of the copies to where the kernels read; 0 where the queue has no clock.
    pub upload_ms: f64,
    /// How much of these four ran before the seek began, beside earlier frames.
    pub hidden_ms: f64,
    /// Milliseconds that the seek waited for key-frames.
    pub wait_ms: f64,
    /// Device milliseconds of interpolation, morphing, skinning and placing; 0 without timestamps.
    pub deform_ms: f64,
    /// The kernels of `deform_ms`, those of one name summed.
    pub deform_steps: Vec<StepTime>,
    /// The last build of the grid: this seek's where `rebuilt`, else an earlier one's.
    pub build: BuildStats,
    /// Of the first seek: the build over the scene at time 0, by which the player was made.
    pub first_build: Option<BuildStats>,
    /// Buffers that were made anew because they had become too small: 0 once the largest key-frame was seen.
    pub grown: u32,
    /// What was odd about the files, one sentence each.
    pub warnings: Vec<String>,
}

impl SeekStats {
    pub(super) fn new(build: &BuildStats) -> SeekStats {
        SeekStats {
            rebuilt: false,
            key_frames: 0,
            read_ms: 0.0,
            parse_ms: 0.0,
            stage_ms: 0.0,
            upload_ms: 0.0,
            hidden_ms: 0.0,
            wait_ms: 0.0,
            deform_ms: 0.0,
            deform_steps: Vec::new(),
            build: build.clone(),
            first_build: None,
            grown: 0,
            warnings: Vec::new(),
        }
    }
}
