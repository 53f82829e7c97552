//! How kernels are cut into workgroups: specialization constants, chosen by the kind of device.

use crate::dispatch::deal_workgroups;
use crate::kernel::Kernel;

/// Workgroup sizes and elements an invocation. Two kinds of devices want the opposite: a CPU few invocations with long runs, a GPU many
/// with short ones. The bounds keep what an invocation does for its own elements to about 32,768 turns of its loops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Invocations a workgroup of the map kernels; no size of a workgroup is above 256.
    pub map_size: u32,
    /// Invocations a workgroup of the reductions and the scan; a power of two.
    pub scan_size: u32,
    /// Elements an invocation of the scan, which passes by them twice, at most 8,000.
    pub scan_items: u32,
    /// Triangles an invocation of the gathering, which reduces the scene box, at most 1,800: a search for its record takes 17 turns.
    pub reduce_items: u32,
    /// Bricks an invocation of `brick_reduce`, at most 90: `split_cells` takes 170 turns for one, beside 16,384 for all references.
    pub reduce_bricks: u32,
    /// Most bits a digit of the sort, at least 4; 2^`sort_bits` <= 8 * [`Shape::sort_tile`].
    pub sort_bits: u32,
    /// Invocations a workgroup of the sort and of `leaf_sort`; 2^`sort_bits` * `sort_size` <= 8,192 unless `sort_alone`.
    pub sort_size: u32,
    /// Keys an invocation of the sort, at most 8,192 unless `sort_alone`.
    pub sort_keys: u32,
    /// Whether an invocation's keys are a tile of the sort, counted in a private array; otherwise those of a workgroup are, in shared
    /// memory. 2^`sort_bits` + `sort_keys` <= 16,384 then, and no more than 32,768 * `sort_keys` pairs or rays are sorted.
    pub sort_alone: bool,
    /// Pairs an invocation of the emission of large boxes, at most 700: each takes 44 turns at most, one, 27 of a search and those of 16 lanes
    /// one after another.
    pub emit_pairs: u32,
    /// Pairs an invocation of `cell_ranges`, at most 32,767.
    pub range_pairs: u32,
    /// Turns that an invocation of `leaf_sort` takes for the split cells before its last, at most 16,000: one for a pair, two for a reference,
    /// one for eight leaf cells. 0: the pairs of leaf cells are sorted all together.
    pub leaf_run: u32,
    /// Whether rays load a row of a triangle as two coordinates and one, not as a vector.
    pub by_two: bool,
    /// Runs of workgroups of a launch, at most 1,024, to which elements that cost unlike are dealt: one for each thread of a driver that gives its
    /// threads one run of consecutive workgroups each, so that all end together.
    pub strands: u32,
}

/// Fewer keys than that are not worth a column of the digit table, whose rows are scanned by an invocation each: a turn for each tile.
const LEAST_SORT_TILE: u32 = 512;

/// Most tiles of a sort by invocations.
const MOST_SORT_TILES: u32 = 32_768;

/// Most strands of a launch: fewer workgroups along z than every device takes.
const MOST_STRANDS: u32 = 1024;

impl Shape {
    /// For devices whose invocations run on CPU cores, in vectors of 4 to 16 lanes.
    pub const CPU: Shape = Shape {
        map_size: 256,
        scan_size: 8,
        scan_items: 512,
        reduce_items: 128,
        reduce_bricks: 16,
        sort_bits: 10,
        sort_size: 8,
        sort_keys: 8192,
        sort_alone: true,
        emit_pairs: 256,
        range_pairs: 16,
        leaf_run: 6000,
        by_two: true,
        strands: 2,
    };

    /// For GPUs.
    pub const GPU: Shape = Shape {
        map_size: 64,
        scan_size: 256,
        scan_items: 16,
        reduce_items: 2,
        reduce_bricks: 1,
        sort_bits: 4,
        sort_size: 256,
        sort_keys: 16,
        sort_alone: false,
        emit_pairs: 16,
        range_pairs: 1,
        leaf_run: 0,
        by_two: false,
        strands: 1,
    };

    /// What suits a device of this kind: [`Shape::GPU`], or [`Shape::CPU`] with a strand for each processor of this machine.
    pub fn of_device(is_cpu: bool) -> Shape {
        if !is_cpu {
            return Shape::GPU;
        }
        let threads = std::thread::available_parallelism().map_or(Shape::CPU.strands, |threads| threads.get() as u32);
        Shape { strands: threads.min(MOST_STRANDS), ..Shape::CPU }
    }

    /// Whether the fields keep to what is said of them: kernels cut otherwise would not fit into shared memory, or give wrong results.
    pub fn is_valid(&self) -> bool {
        let sizes = [self.map_size, self.scan_size, self.sort_size];
        let items = [
            (self.scan_items, 8_000),
            (self.reduce_items, 1_800),
            (self.reduce_bricks, 90),
            (self.sort_keys, if self.sort_alone { 16_384 } else { 8_192 }),
            (self.emit_pairs, 700),
            (self.range_pairs, 32_767),
            (self.strands, MOST_STRANDS),
        ];
        let digits = |bits: u32| 1_u32 << bits;
        sizes.iter().all(|size| (1..=256).contains(size))
            && items.iter().all(|(items, most)| (1..=*most).contains(items))
            && self.leaf_run <= 16_000
            && self.scan_size.is_power_of_two()
            // Fewer bits need more passes than a plan records.
            && (4..=12).contains(&self.sort_bits)
            && if self.sort_alone { digits(self.sort_bits) + self.sort_keys <= 16_384 } else { digits(self.sort_bits) * self.sort_size <= 8192 }
            // The digit table of 2^28 pairs stays below 2^31 entries.
            && digits(self.sort_bits) <= 8 * self.sort_tile()
    }

    /// Workgroups for `count` elements that cost unlike, `size` a workgroup: see [`deal_workgroups`].
    pub fn deal_workgroups(&self, count: u32, size: u32) -> [u32; 3] {
        deal_workgroups(count, size, self.strands)
    }

    /// Elements a workgroup of the scan.
    pub const fn scan_tile(&self) -> u32 {
        self.scan_size * self.scan_items
    }

    /// Triangles a workgroup of the gathering.
    pub const fn bounds_tile(&self) -> u32 {
        self.scan_size * self.reduce_items
    }

    /// Bricks a workgroup of `brick_reduce`.
    pub const fn brick_tile(&self) -> u32 {
        self.scan_size * self.reduce_bricks
    }

    /// Split cells a workgroup of `leaf_distance`: four, of which each takes 4,400 turns at most, stay within the budget of its loops.
    pub const fn measured_cells(&self) -> u32 {
        if self.reduce_bricks < 4 { self.reduce_bricks } else { 4 }
    }

    /// Keys a tile of the sort, at most.
    pub const fn sort_tile(&self) -> u32 {
        if self.sort_alone { self.sort_keys } else { self.sort_size * self.sort_keys }
    }

    /// Most pairs or rays that are sorted: where an invocation scans a row of the digit table by itself, it takes a turn for each tile, and
    /// 32,768 of them keep to the budget of its loops.
    pub const fn most_sorted(&self) -> u32 {
        if self.sort_alone { self.sort_tile().saturating_mul(MOST_SORT_TILES) } else { u32::MAX }
    }

    /// Most tiles of so many pairs. Those of invocations fill the workgroups of each strand: one with a workgroup more than the others would be
    /// waited for. No more for fewer pairs, as later passes have.
    pub fn most_sort_tiles(&self, pairs: u32) -> u32 {
        let tiles = pairs.div_ceil(self.sort_tile());
        if !self.sort_alone {
            return tiles;
        }
        let [x, y, z] = self.deal_workgroups(tiles, self.sort_tiles());
        let most = pairs.div_ceil(self.sort_tile().min(LEAST_SORT_TILE)).min(MOST_SORT_TILES);
        (x * y * z * self.sort_tiles()).min(most)
    }

    /// Keys of a tile of so many pairs.
    pub fn sort_tile_of(&self, pairs: u32) -> u32 {
        if self.sort_alone && pairs > 0 { pairs.div_ceil(self.most_sort_tiles(pairs)) } else { self.sort_tile() }
    }

    /// Workgroups of `sort_histogram` and `sort_scatter` for so many pairs.
    pub fn sort_workgroups(&self, pairs: u32) -> [u32; 3] {
        self.deal_workgroups(self.most_sort_tiles(pairs), self.sort_tiles())
    }

    /// Tiles a workgroup of the sort.
    pub const fn sort_tiles(&self) -> u32 {
        if self.sort_alone { self.sort_size } else { 1 }
    }

    /// Least binary logarithm of the number of references of split cells that share one in the list of owners, which lies where the digit
    /// table will.
    pub const fn owner_shift(&self) -> u32 {
        let shift = self.sort_tile().div_ceil(1 << self.sort_bits).next_power_of_two().ilog2();
        if shift < 5 { 5 } else { shift }
    }

    /// Invocations a workgroup of `table_scan`.
    const fn table_scan_size(&self) -> u32 {
        if !self.sort_alone {
            self.scan_size
        } else if self.map_size < 64 {
            self.map_size
        } else {
            64
        }
    }

    /// Rows of the digit table a workgroup of `table_scan`.
    pub const fn table_rows(&self) -> u32 {
        if self.sort_alone { self.table_scan_size() } else { 1 }
    }

    /// Bricks of a row whose distances along it an invocation finds.
    pub const fn distance_run(&self) -> u32 {
        if self.sort_alone { 16 } else { 4 }
    }

    /// Workgroups that reduce the scene box; at least one, so that an empty scene has a box of no triangle.
    pub const fn bounds_tiles(&self, triangles: u32) -> u32 {
        let tiles = triangles.div_ceil(self.bounds_tile());
        if tiles == 0 { 1 } else { tiles }
    }

    /// Sums that are kept of the tiles of a scan over triangles or pairs, and a number behind them, or of the rows of the digit table.
    pub fn scan_partials(&self, triangles: u32, pairs: u32) -> u32 {
        (triangles.max(pairs) + 1).div_ceil(self.scan_tile()).max(1 << self.sort_bits)
    }

    /// Entries of the sort's digit table: a row a digit, a column a tile.
    pub fn table_entries(&self, pairs: u32) -> u64 {
        u64::from(self.most_sort_tiles(pairs)) << self.sort_bits
    }

    /// The value of a kernel's specialization constant by its name.
    pub fn constant(&self, name: &str) -> Option<u32> {
        Some(match name {
            "MAP_SIZE" => self.map_size,
            "ITEMS_EACH" => self.scan_items,
            "SCAN_TILE" => self.scan_tile(),
            "TRIANGLES_EACH" => self.reduce_items,
            "BOUNDS_TILE" => self.bounds_tile(),
            "BRICKS_EACH" => self.reduce_bricks,
            "BRICK_TILE" => self.brick_tile(),
            "SORT_BITS" => self.sort_bits,
            "KEYS_EACH" => self.sort_keys,
            "SORT_ALONE" => self.sort_alone.into(),
            "SORT_TILE" => self.sort_tile(),
            "OWNER_SHIFT" => self.owner_shift(),
            "DISTANCE_RUN" => self.distance_run(),
            "TABLE_ROWS" => self.table_rows(),
            "SORT_TILES" => self.sort_tiles(),
            "SPLIT_CELLS_EACH" => self.measured_cells(),
            "PAIRS_EACH" => self.emit_pairs,
            "RANGE_PAIRS" => self.range_pairs,
            "SORT_SIZE" => self.sort_size,
            "LEAF_RUN" => self.leaf_run,
            "BY_TWO" => self.by_two.into(),
            "STRANDS" => self.strands,
            _ => return None,
        })
    }

    /// Invocations a workgroup of a kernel whose size is a specialization constant.
    pub fn local_size(&self, kernel: &Kernel) -> u32 {
        match kernel.name {
            "sort_histogram" | "sort_scatter" | "leaf_sort" => self.sort_size,
            "brick_reduce" | "configure" | "gather" | "gather_records" | "geometry_scan" | "report_spine" | "scan_reduce" | "pair_args"
            | "leaf_args" | "split_cells" => self.scan_size,
            "table_scan" => self.table_scan_size(),
            _ => self.map_size,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{MOST_SORT_TILES, Shape};

    #[test]
    fn tiles_of_a_sort() {
        for (sort_size, sort_keys, strands) in
            [(8, 8_192, 1), (8, 8_192, 2), (8, 8_192, 64), (8, 8_192, 1_000), (256, 1_000, 1_024), (1, 5, 3)]
        {
            let shape = Shape { sort_size, sort_keys, strands, ..Shape::CPU };
            let mut before = 0;
            let small = 1..=70_000;
            let large = (70_000..shape.most_sorted().min(1 << 28)).step_by(997_001).chain([shape.most_sorted().min(1 << 28)]);
            for pairs in small.chain(large) {
                let (most, tile) = (shape.most_sort_tiles(pairs), shape.sort_tile_of(pairs));
                let tiles = pairs.div_ceil(tile);
                assert!((1..=sort_keys).contains(&tile) && tiles <= most && most <= MOST_SORT_TILES, "{pairs} pairs, {shape:?}");
                // A pass of fewer pairs has the workgroups of all.
                assert!(most >= before, "{pairs} pairs, {shape:?}");
                before = most;
                let [x, y, z] = shape.sort_workgroups(pairs);
                assert!(most <= x * y * z * sort_size && x <= 65_535 && y <= 65_535 && z == strands.max(1), "{pairs} pairs, {shape:?}");
            }
        }
        // Three workgroups a strand, none of which has more tiles than another.
        assert_eq!([Shape::CPU.most_sort_tiles(290_000), Shape::CPU.sort_tile_of(290_000)], [48, 6_042]);
    }

    #[test]
    fn shapes_that_cannot_be() {
        let (cpu, gpu) = (Shape::CPU, Shape::GPU);
        assert!(cpu.is_valid() && gpu.is_valid());
        assert!(Shape { sort_size: 4, sort_keys: 1, ..gpu }.is_valid());
        assert!(Shape { scan_items: 8_000, reduce_items: 1_800, reduce_bricks: 90, sort_keys: 8_192, emit_pairs: 700, ..gpu }.is_valid());
        let wrong = [
            Shape { map_size: 0, ..cpu },
            Shape { map_size: 257, ..cpu },
            Shape { scan_size: 24, ..cpu },
            Shape { scan_items: 0, ..cpu },
            Shape { scan_items: 8_001, ..cpu },
            Shape { reduce_items: 1_801, ..cpu },
            Shape { reduce_bricks: 91, ..gpu },
            Shape { sort_keys: 8_193, ..gpu },
            Shape { emit_pairs: 701, ..gpu },
            Shape { emit_pairs: 0, ..cpu },
            Shape { range_pairs: 32_768, ..cpu },
            Shape { range_pairs: 0, ..gpu },
            Shape { leaf_run: 16_001, ..cpu },
            Shape { strands: 0, ..gpu },
            Shape { strands: 1_025, ..cpu },
            Shape { sort_bits: 3, ..gpu },
            Shape { sort_bits: 32, ..gpu },
            Shape { sort_bits: 6, ..gpu },
            Shape { sort_bits: 8, sort_size: 1, sort_keys: 31, ..gpu },
            Shape { sort_bits: 10, sort_keys: 127, ..cpu },
            Shape { sort_bits: 10, sort_keys: 15_361, ..cpu },
            Shape { sort_bits: 10, sort_size: 16, sort_alone: false, ..cpu },
        ];
        for shape in wrong {
            assert!(!shape.is_valid(), "{shape:?}");
        }
    }
}
