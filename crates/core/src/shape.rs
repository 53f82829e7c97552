//! How kernels are cut into workgroups: specialization constants, chosen by the kind of device.

use crate::kernel::Kernel;

/// Workgroup sizes and elements an invocation. Two kinds of devices want the opposite: a CPU few invocations with long runs, a GPU many
/// with short ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Invocations a workgroup of the map kernels.
    pub map_size: u32,
    /// Invocations a workgroup of the reductions and the scan; a power of two.
    pub scan_size: u32,
    /// Elements an invocation of the scan.
    pub scan_items: u32,
    /// Triangles an invocation of the scene box's reduction.
    pub reduce_items: u32,
    /// Bricks an invocation of `brick_reduce`.
    pub reduce_bricks: u32,
    /// Bits a digit of the sort.
    pub sort_bits: u32,
    /// Invocations a workgroup of the sort; 2^`sort_bits` * `sort_size` <= 4,096.
    pub sort_size: u32,
    /// Keys an invocation of the sort.
    pub sort_keys: u32,
    /// Pairs an invocation of the emission.
    pub emit_pairs: u32,
}

impl Shape {
    /// For devices whose invocations run on CPU cores, in vectors of 4 to 16 lanes.
    pub const CPU: Shape = Shape {
        map_size: 64,
        scan_size: 16,
        scan_items: 256,
        reduce_items: 64,
        reduce_bricks: 4,
        sort_bits: 8,
        sort_size: 8,
        sort_keys: 512,
        emit_pairs: 16,
    };

    /// For GPUs.
    pub const GPU: Shape = Shape {
        map_size: 64,
        scan_size: 256,
        scan_items: 16,
        reduce_items: 8,
        reduce_bricks: 1,
        sort_bits: 4,
        sort_size: 256,
        sort_keys: 16,
        emit_pairs: 16,
    };

    /// Elements a workgroup of the scan.
    pub const fn scan_tile(&self) -> u32 {
        self.scan_size * self.scan_items
    }

    /// Triangles a workgroup of the scene box's reduction.
    pub const fn bounds_tile(&self) -> u32 {
        self.scan_size * self.reduce_items
    }

    /// Bricks a workgroup of `brick_reduce`.
    pub const fn brick_tile(&self) -> u32 {
        self.scan_size * self.reduce_bricks
    }

    /// Keys a workgroup of the sort.
    pub const fn sort_tile(&self) -> u32 {
        self.sort_size * self.sort_keys
    }

    /// Workgroups that reduce the scene box; at least one, so that an empty scene has a box of no triangle.
    pub const fn bounds_tiles(&self, triangles: u32) -> u32 {
        let tiles = triangles.div_ceil(self.bounds_tile());
        if tiles == 0 { 1 } else { tiles }
    }

    /// Entries of the sort's digit table: a row a digit, a column a tile.
    pub fn table_entries(&self, pairs: u32) -> u64 {
        u64::from(pairs.div_ceil(self.sort_tile())) << self.sort_bits
    }

    /// The value of a kernel's specialization constant by its name.
    pub fn constant(&self, name: &str) -> Option<u32> {
        Some(match name {
            "MAP_SIZE" => self.map_size,
            "ITEMS_EACH" => self.scan_items,
            "SCAN_TILE" => self.scan_tile(),
            "TRIANGLES_EACH" => self.reduce_items,
            "BRICKS_EACH" => self.reduce_bricks,
            "BRICK_TILE" => self.brick_tile(),
            "SORT_BITS" => self.sort_bits,
            "KEYS_EACH" => self.sort_keys,
            "SORT_TILE" => self.sort_tile(),
            "PAIRS_EACH" => self.emit_pairs,
            _ => return None,
        })
    }

    /// Invocations a workgroup of a kernel whose size is a specialization constant.
    pub fn local_size(&self, kernel: &Kernel) -> u32 {
        match kernel.name {
            "sort_histogram" | "sort_scatter" => self.sort_size,
            "bounds_reduce" | "bounds_spine" | "brick_reduce" | "report_spine" | "scan_reduce" | "scan_spine" | "scan_downsweep" => {
                self.scan_size
            }
            _ => self.map_size,
        }
    }
}
