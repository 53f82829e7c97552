//! Twin of kernel `leaf_sort`.

use super::leaf_args::write_sort;
use super::leaf_count::LARGE_LEAF_BOX;
use crate::dispatch::workgroups;
use crate::grid::{cell_id, cell_of};
use crate::layout::{BuildState, CELL_SPLIT, LeafArguments, SplitCell};
use crate::shape::Shape;
use crate::split::leaf_count_of;

/// Turns of an invocation's loops, at most.
pub const MOST_WORK: u32 = 32_000;

/// Turns for so many pairs, references and leaf cells.
fn work_of([pairs, references, leaf_cells]: [u32; 3]) -> u32 {
    pairs + 2 * references + leaf_cells / 8
}

/// The leaf cells, within those of its split cell or of all, that a reference with a small box overlaps.
fn small_box(word: u32, mask: u32) -> impl Iterator<Item = u32> {
    let (low, level) = (word & 0x7FFF, word >> 25);
    let sizes = [(word >> 15 & 31) + 1, (word >> 20 & 31) + 1, 32];
    (0..32).filter(move |n| mask >> n & 1 != 0).map(move |n| low + cell_id(cell_of(n, sizes), [1 << level; 3]))
}

/// Makes the lists of leaf cells by counting, for a run of split cells an invocation, and makes these lead to their leaf cells. Where a run is
/// too long, the arguments of the steps that sort all pairs are written.
#[allow(clippy::too_many_arguments, reason = "they are the kernel's")]
pub fn leaf_sort(
    shape: &Shape,
    groups: [u32; 3],
    state: &BuildState,
    split_cells: &[SplitCell],
    offsets: &[u32],
    masks: &[u32],
    boxes: &[u32],
    references: &mut [u32],
    cells: &mut [[u32; 2]],
    arguments: &mut LeafArguments,
    pass_capacity: u32,
) {
    let all = &split_cells[..state.split_cells as usize];
    let fitting = &all[..all.partition_point(|split| split.level != 0)];
    let work_before = |split: &SplitCell| work_of([offsets[split.first_reference as usize], split.first_reference, split.leaf_begin]);
    for invocation in 0..workgroups(groups).end * shape.sort_size {
        let begin = invocation * shape.leaf_run;
        let first_with = |work| fitting.partition_point(|split| work_before(split) < work);
        let run = &fitting[first_with(begin)..first_with(begin + shape.leaf_run)];
        let [Some(first), Some(last)] = [run.first(), run.last()] else { continue };
        let reference_end = last.first_reference + last.list_length;
        let pairs = offsets[reference_end as usize] - offsets[first.first_reference as usize];
        let leaf_cells = last.leaf_begin + leaf_count_of(last.level) - first.leaf_begin;
        if work_of([pairs, reference_end - first.first_reference, leaf_cells]) > MOST_WORK {
            write_sort(shape, state, arguments, pass_capacity);
            continue;
        }
        for split in run {
            let first_leaf = state.first_cell + split.leaf_begin;
            cells[split.cell as usize] = [first_leaf, CELL_SPLIT | split.level];
            let mut lists = vec![Vec::new(); leaf_count_of(split.level) as usize];
            for place in 0..split.list_length {
                let reference = (split.first_reference + place) as usize;
                let row = references[(split.list_begin + place) as usize];
                if boxes[reference] == LARGE_LEAF_BOX {
                    let pairs = offsets[reference]..offsets[reference + 1];
                    pairs.for_each(|pair| lists[(masks[(state.first_pair + pair) as usize] - split.leaf_begin) as usize].push(row));
                } else {
                    small_box(boxes[reference], masks[reference]).for_each(|leaf| lists[leaf as usize].push(row));
                }
            }
            let mut next = (state.first_pair + offsets[split.first_reference as usize]) as usize;
            for (leaf, list) in (first_leaf as usize..).zip(lists) {
                let end = next + list.len();
                references[next..end].copy_from_slice(&list);
                cells[leaf] = if list.is_empty() { [0, 0] } else { [next as u32, end as u32] };
                next = end;
            }
        }
    }
}
