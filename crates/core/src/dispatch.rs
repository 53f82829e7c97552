//! How a number of elements becomes workgroups, as `shared/dispatch.glsl` has it.

/// Most workgroups along x that every device takes.
pub const MAX_GROUPS_X: u32 = 65_535;

/// Workgroups for `count` elements, `size` a workgroup: at most 65,535 along x, the rest along y. The last row may hold workgroups beyond
/// the last element.
pub const fn split_workgroups(count: u32, size: u32) -> [u32; 3] {
    let groups = count.div_ceil(size);
    if groups <= MAX_GROUPS_X { [groups, 1, 1] } else { [MAX_GROUPS_X, groups.div_ceil(MAX_GROUPS_X), 1] }
}

/// Blocks of workgroups that each strand is dealt, at most where workgroups along x admit it.
pub const ROUNDS: u32 = 64;

/// Workgroups of a block, at least where there are as many.
pub const BLOCK: u32 = 4;

/// The same for elements that cost unlike: blocks of workgroups along x, dealt in rounds along y to strands along z. With a single strand it is
/// as above.
pub fn deal_workgroups(count: u32, size: u32, strands: u32) -> [u32; 3] {
    if strands == 1 {
        return split_workgroups(count, size);
    }
    let groups = count.div_ceil(size);
    let each = groups.div_ceil(strands);
    let rounds = each.div_ceil(BLOCK).min(ROUNDS).max(each.div_ceil(MAX_GROUPS_X)).max(1);
    [each.div_ceil(rounds), rounds, strands]
}

/// Indices of the workgroups of a dispatch, those beyond the last element included.
pub fn workgroups(groups: [u32; 3]) -> std::ops::Range<u32> {
    0..groups[0] * groups[1] * groups[2]
}
