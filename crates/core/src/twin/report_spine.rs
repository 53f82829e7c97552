//! Twin of kernel `report_spine`.

use super::brick_reduce::unite;
use crate::grid::brick_resolution;
use crate::layout::Report;
use crate::shape::Shape;

/// Completes the report.
pub fn report_spine(shape: &Shape, resolution: [u32; 3], partials: &[[u32; 2]], report: &mut Report) {
    let bricks: u32 = brick_resolution(resolution).iter().product();
    let count = bricks.div_ceil(shape.brick_tile()) as usize;
    [report.cells_in_use, report.longest_list] = partials[..count].iter().copied().fold([0, 0], unite);
}
