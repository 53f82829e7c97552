//! How kernels are cut into workgroups; the sizes themselves are shared with the twins.

pub use gridwalk_core::shape::Shape;

/// Workgroups of a direct dispatch: at most 65,535 along x, the rest along y, as `split_workgroups` of the kernels has it.
pub fn split_workgroups(groups: u32) -> [u32; 3] {
    gridwalk_core::dispatch::split_workgroups(groups, 1)
}
