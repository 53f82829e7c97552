//! Twin of kernel `leaf_distance`.

use crate::dispatch::workgroups;
use crate::grid::{cell_id, cell_of};
use crate::layout::{BuildState, SplitCell};
use crate::shape::Shape;
use crate::split::{LEAST_MEASURED, leaf_count_of, max_leaf_distance};

/// The least of each value and of those of its neighbours along an axis.
fn spread(values: &[u32], level: u32, axis: usize) -> Vec<u32> {
    let along = 1 << level;
    (0..leaf_count_of(level))
        .map(|leaf| {
            let at = cell_of(leaf, [along; 3]);
            let neighbours = [at[axis].wrapping_sub(1), at[axis], at[axis] + 1].into_iter().filter(|i| *i < along);
            let near = neighbours.map(|i| {
                let mut cell = at;
                cell[axis] = i;
                values[cell_id(cell, [along; 3]) as usize]
            });
            near.fold(u32::MAX, u32::min)
        })
        .collect()
}

/// The distance of each empty leaf cell to the nearest that is not empty, among those of the same split cell; 0 if that is 1, which is what
/// they have anyway.
pub fn leaf_distance(shape: &Shape, groups: [u32; 3], state: &BuildState, split_cells: &[SplitCell], cells: &mut [[u32; 2]]) {
    let covered = workgroups(groups).end * shape.measured_cells();
    for split in &split_cells[..state.split_cells.min(covered) as usize] {
        if split.level < LEAST_MEASURED {
            continue;
        }
        let most = max_leaf_distance(split.level);
        let first = (state.first_cell + split.leaf_begin) as usize;
        let leaves = &mut cells[first..first + leaf_count_of(split.level) as usize];
        // How far each is from one that is not empty, as far as is known after some turns.
        let mut distances: Vec<u32> = leaves.iter().map(|range| if range[1] != 0 { 0 } else { most }).collect();
        for reach in 1..most {
            let near = (0..3).fold(distances.clone(), |values, axis| spread(&values, split.level, axis));
            for (distance, near) in distances.iter_mut().zip(near) {
                *distance = (*distance).min(if near < reach { reach } else { most });
            }
        }
        for (range, distance) in leaves.iter_mut().zip(distances).filter(|(_, distance)| *distance > 1) {
            range[0] = distance;
        }
    }
}
