//! Twin of kernel `bounds_spine`.

use crate::gather::unite;
use crate::layout::Bounds;

/// The union of the boxes of all tiles: the scene box.
pub fn bounds_spine(partials: &[Bounds], scene: &mut Bounds, partial_count: u32) {
    *scene = partials[..partial_count as usize].iter().copied().fold(Bounds::EMPTY, unite);
}
