//! Every kernel on the CPU, and a player of whole plans. A twin walks the workgroups of its kernel's dispatch, over slices
//! in place of memory, and leaves the same words: integers always, floats where the kernel adds, subtracts, multiplies, compares and
//! rounds down, which every device does alike. The sign of a zero is left open where a minimum or maximum chooses between two.

pub mod any_hit;
pub mod brick_distance_x;
pub mod brick_distance_y;
pub mod brick_distance_z;
pub mod brick_reduce;
pub mod brute_force;
pub mod cell_ranges;
pub mod clear_bricks;
pub mod clear_cells;
pub mod closest_candidate;
pub mod closest_hit;
pub mod configure;
pub mod count_hits;
pub mod gather;
pub mod gather_records;
pub mod geometry_scan;
pub mod interpolate;
pub mod interpolate_colours;
pub mod leaf_args;
pub mod leaf_count;
pub mod leaf_distance;
pub mod leaf_sort;
pub mod morph;
pub mod motion;
pub mod nearest_hits;
pub mod overlap_count;
pub mod overlap_emit;
pub mod pair_args;
pub mod place;
pub mod player;
pub mod ray_keys;
pub mod ray_sort_args;
pub mod report_spine;
pub mod scan_reduce;
pub mod skin;
pub mod sort_histogram;
pub mod sort_scatter;
pub mod split_cells;
pub mod table_scan;
pub mod trace_args;
pub mod trace_continue_args;
