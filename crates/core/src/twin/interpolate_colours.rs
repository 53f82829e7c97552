//! Twin of kernel `interpolate_colours`.

use crate::dispatch::workgroups;
use crate::twin::motion::between;

/// Words of vertex colours between two key-frames: at weight 0 the first's, bit for bit; one where there are none.
pub fn interpolate_colours(
    map_size: u32,
    groups: [u32; 3],
    first: Option<&[u32]>,
    second: &[u32],
    colours: &mut [u32],
    word_count: u32,
    weight: f32,
) {
    let invocations = workgroups(groups).flat_map(|group| group * map_size..(group + 1) * map_size);
    for i in invocations.filter(|word| *word < word_count).map(|word| word as usize) {
        colours[i] = match first {
            None => 1.0_f32.to_bits(),
            Some(first) if weight == 0.0 => first[i],
            Some(first) => between(first[i], second[i], weight),
        };
    }
}
