//! Cells of a grid, as `shared/grid.glsl` has them.

use crate::vector::{Vec3, add, mul};

/// Lower boundary of cell `i`, upper boundary of cell `i - 1`.
pub fn boundary(box_min: Vec3, cell_size: Vec3, i: Vec3) -> Vec3 {
    let offset = mul(i, cell_size);
    add(box_min, offset)
}

/// floor(x) for x in [0.5, 2^23 - 0.5]: the nearest to x - 0.5. Of odd whole numbers the one below. For larger x a larger
/// number.
pub fn whole_below(x: f32) -> i32 {
    (x + 8_388_607.5).to_bits() as i32 - 0x4B00_0000
}

/// Cells along each axis of a brick.
pub const BRICK_SIZE: u32 = 4;

/// Bricks along each axis.
pub fn brick_resolution(resolution: [u32; 3]) -> [u32; 3] {
    resolution.map(|cells| cells.div_ceil(BRICK_SIZE))
}

/// Index of a cell.
pub fn cell_id(cell: [u32; 3], resolution: [u32; 3]) -> u32 {
    cell[0] + resolution[0] * cell[1] + resolution[0] * resolution[1] * cell[2]
}

/// Cell of an index: the inverse of [`cell_id`].
pub fn cell_of(id: u32, resolution: [u32; 3]) -> [u32; 3] {
    [id % resolution[0], id / resolution[0] % resolution[1], id / resolution[0] / resolution[1]]
}

#[cfg(test)]
mod tests {
    use super::whole_below;

    #[test]
    fn whole_numbers_below() {
        let cases = [
            (0.5, 0),
            (0.999_999_94, 0),
            (1.0, 0),
            (1.000_000_1, 1),
            (2.0, 2),
            (2.999_999_8, 2),
            (3.0, 2),
            (3.000_000_2, 3),
            (8_388_607.5, 8_388_607),
        ];
        for (x, expected) in cases {
            assert_eq!(whole_below(x), expected, "{x}");
        }
        for x in [8_388_608.0, 16_777_216.0, 1e30, f32::MAX, f32::INFINITY] {
            assert!(whole_below(x) >= 8_388_607, "{x}: {}", whole_below(x));
        }
    }
}
