//! Geometry as the caller describes it in device memory, and how it is read, as `shared/geometry.glsl` has it.

use bytemuck::{Pod, Zeroable};

use crate::vector::Vec3;

/// Three `f32` a vertex.
pub const FORMAT_FLOAT32X3: u32 = 0;
/// Four IEEE 754 half floats a vertex, the fourth unused.
pub const FORMAT_FLOAT16X4: u32 = 1;
/// Four `i16` a vertex, the fourth unused: q counts as max(q, -32767) / 32767, the quotient rounded as a product with the float next to
/// 1 / 32767.
pub const FORMAT_SNORM16X4: u32 = 2;

/// No indices: triangle i has the vertices 3 i, 3 i + 1 and 3 i + 2.
pub const INDEX_NONE: u32 = 0;
/// Three `u16` a triangle, tightly packed.
pub const INDEX_UINT16: u32 = 1;
/// Three `u32` a triangle, tightly packed.
pub const INDEX_UINT32: u32 = 2;

/// [`GeometryRecord::flags`]: front and back are exchanged, as by a transform that mirrors.
pub const FLAG_FLIP_FACING: u32 = 1;
/// [`GeometryRecord::flags`]: the geometry is never culled.
pub const FLAG_TWO_SIDED: u32 = 2;

/// Most geometries of a grid.
pub const MAX_GEOMETRIES: u32 = 1 << 16;

/// One geometry of a grid: 128 bytes, written by the host or by a shader. An instance is a record that shares its addresses with others.
///
/// A vertex is the stored position, times `scale`, plus `offset`, then transformed; component by component, in this order, every
/// operation rounded. It is a function of the record and the index alone, so triangles that share a vertex by index share it exactly.
/// Memory is read in words of 4 bytes: addresses of positions and of 32-bit indices, and the stride, are multiples of 4; those of 16-bit
/// indices of 2, and the word that holds the last of them is read whole.
///
/// | offset | bytes | field |
/// |---|---|---|
/// | 0 | 48 | `transform` |
/// | 48 | 12 | `scale` |
/// | 60 | 4 | `stride` |
/// | 64 | 12 | `offset` |
/// | 76 | 4 | `vertex_count` |
/// | 80 | 8 | `positions` |
/// | 88 | 8 | `indices` |
/// | 96 | 8 | `count` |
/// | 104 | 4 | `triangle_count` |
/// | 108 | 4 | `format` |
/// | 112 | 4 | `index_type` |
/// | 116 | 4 | `id` |
/// | 120 | 4 | `mask` |
/// | 124 | 4 | `flags` |
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct GeometryRecord {
    /// Three rows of four: the last column is the translation, as in `VkTransformMatrixKHR`.
    pub transform: [[f32; 4]; 3],
    /// Multiplied to a stored position before the transform.
    pub scale: [f32; 3],
    /// Bytes from a vertex to the next, a multiple of 4.
    pub stride: u32,
    /// Added to a scaled position before the transform.
    pub offset: [f32; 3],
    /// Vertices; a triangle with an index beyond is dropped and counted.
    pub vertex_count: u32,
    /// Device address of the first vertex's position.
    pub positions: u64,
    /// Device address of the first index; not read with [`INDEX_NONE`].
    pub indices: u64,
    /// Device address of a `u32`, a multiple of 4: the number of triangles, if it is less than `triangle_count`. 0: that is the number.
    pub count: u64,
    /// Triangles, or their bound.
    pub triangle_count: u32,
    /// [`FORMAT_FLOAT32X3`], [`FORMAT_FLOAT16X4`] or [`FORMAT_SNORM16X4`].
    pub format: u32,
    /// [`INDEX_NONE`], [`INDEX_UINT16`] or [`INDEX_UINT32`].
    pub index_type: u32,
    /// Any number, which a trace gives back for a hit.
    pub id: u32,
    /// A ray with a mask hits the geometry only if the two share a bit.
    pub mask: u32,
    /// 0, or [`FLAG_FLIP_FACING`] and [`FLAG_TWO_SIDED`].
    pub flags: u32,
}

impl GeometryRecord {
    /// The transform that changes nothing.
    pub const IDENTITY: [[f32; 4]; 3] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
}

impl Default for GeometryRecord {
    /// No triangle; tightly packed `f32` positions, 32-bit indices, nothing transformed, hit by every mask.
    fn default() -> GeometryRecord {
        GeometryRecord {
            transform: GeometryRecord::IDENTITY,
            scale: [1.0; 3],
            stride: 12,
            offset: [0.0; 3],
            vertex_count: 0,
            positions: 0,
            indices: 0,
            count: 0,
            triangle_count: 0,
            format: FORMAT_FLOAT32X3,
            index_type: INDEX_UINT32,
            id: 0,
            mask: u32::MAX,
            flags: 0,
        }
    }
}

/// Device memory as a twin reads it: words at addresses.
#[derive(Clone, Debug, Default)]
pub struct AddressedMemory {
    pieces: Vec<(u64, Vec<u32>)>,
}

impl AddressedMemory {
    /// Adds words that begin at an address.
    pub fn add(&mut self, address: u64, words: Vec<u32>) {
        self.pieces.push((address, words));
    }

    /// The word at an address; 0 where nothing is known.
    pub fn word(&self, address: u64) -> u32 {
        let found = |(base, words): &(u64, Vec<u32>)| address.checked_sub(*base).and_then(|bytes| words.get(bytes as usize / 4).copied());
        self.pieces.iter().find_map(found).unwrap_or(0)
    }

    fn words<const N: usize>(&self, address: u64) -> [u32; N] {
        std::array::from_fn(|i| self.word(address + 4 * i as u64))
    }
}

/// The value of a half float.
pub fn half_to_float(bits: u32) -> f32 {
    let (exponent, mantissa, sign) = ((bits >> 10) & 31, bits & 1023, (bits & 32_768) << 16);
    if exponent == 0 {
        let magnitude = mantissa as f32 * 5.960_464_5e-8;
        return if sign != 0 { -magnitude } else { magnitude };
    }
    let wide = if exponent == 31 { 255 } else { exponent + 112 };
    f32::from_bits(sign | wide << 23 | mantissa << 13)
}

/// The value of a normalized 16-bit integer.
pub fn snorm_to_float(bits: u32) -> f32 {
    f32::from((bits as u16 as i16).max(-32_767)) * 3.051_851e-5
}

/// Triangles of a geometry.
pub fn count_of(memory: &AddressedMemory, record: &GeometryRecord) -> u32 {
    if record.count == 0 { record.triangle_count } else { record.triangle_count.min(memory.word(record.count)) }
}

/// Indices of a triangle's vertices.
pub fn vertices_of(memory: &AddressedMemory, record: &GeometryRecord, triangle: u32) -> [u32; 3] {
    match record.index_type {
        INDEX_NONE => [0, 1, 2].map(|corner| (3 * triangle).wrapping_add(corner)),
        INDEX_UINT16 => [0, 1, 2].map(|corner| {
            let address = record.indices + 6 * u64::from(triangle) + 2 * corner;
            memory.word(address & !3) >> (8 * (address & 2)) & 65_535
        }),
        _ => memory.words(record.indices + 12 * u64::from(triangle)),
    }
}

fn transformed(row: [f32; 4], p: Vec3) -> f32 {
    row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]
}

/// A vertex in the grid's input coordinates.
pub fn position_of(memory: &AddressedMemory, record: &GeometryRecord, vertex: u32) -> Vec3 {
    let address = record.positions + u64::from(vertex) * u64::from(record.stride);
    let words: [u32; 3] = memory.words(address);
    let halves = [words[0] & 65_535, words[0] >> 16, words[1] & 65_535];
    let stored = match record.format {
        FORMAT_FLOAT32X3 => words.map(f32::from_bits),
        FORMAT_FLOAT16X4 => halves.map(half_to_float),
        _ => halves.map(snorm_to_float),
    };
    let p = std::array::from_fn(|axis| stored[axis] * record.scale[axis] + record.offset[axis]);
    record.transform.map(|row| transformed(row, p))
}

#[cfg(test)]
mod tests {
    use super::{half_to_float, snorm_to_float};

    #[test]
    fn halves_and_normalized_integers() {
        let halves = [
            (0x3C00, 1.0),
            (0xC000, -2.0),
            (0x7BFF, 65_504.0),
            (1, 2.0_f32.powi(-24)),
            (0x0400, 2.0_f32.powi(-14)),
            (0x3555, 0.333_251_95),
        ];
        for (bits, value) in halves {
            assert_eq!(half_to_float(bits), value, "{bits:#x}");
        }
        assert!(half_to_float(0x7C00) == f32::INFINITY && half_to_float(0x7E00).is_nan());
        assert_eq!([0, 32_767, 32_768, 32_769].map(snorm_to_float), [0.0, 1.0, -1.0, -1.0]);
    }
}
