//! The grid that a scene would get, reckoned on the CPU: for a look at a scene where no device is at hand.

use gridwalk::gridwalk_core::layout::Bounds;
use gridwalk::gridwalk_core::overlap::{SeparatingAxes, triangle_cells};
use gridwalk::gridwalk_core::twin::configure::{Configure, configure_header};
use gridwalk::{Capacity, Overlap, Shape, region_bytes};
use gridwalk_scene::Scene;

use crate::grid::{cell_capacity, first_leaf_cells};
use crate::{BuildSettings, Error, Result};

/// The grid that a scene would get. A device may arrive at one cell more or fewer along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridEstimate {
    /// Cells along each axis.
    pub resolution: [u32; 3],
    /// Density k that a build would use.
    pub density: f32,
    /// All cells.
    pub cells: u32,
    /// Pairs of a cell and a triangle that the grid lists.
    pub pairs: u64,
    /// Cells in the boxes of all triangles: with [`Overlap::Box`] the pairs that the grid lists and that its build needs room for, else no fewer
    /// than either.
    pub box_pairs: u64,
    /// Bytes of the grid, with its copy of the triangles.
    pub grid_bytes: u64,
    /// Bytes that a build needs beside it.
    pub scratch_bytes: u64,
}

/// Reckons with the kernels' own arithmetic what [`crate::GridBuilder::build`] would make of a scene.
///
/// # Errors
/// [`Error::Setting`] for settings without a meaning, [`Error::Scene`] for more triangles than a grid can hold.
pub fn estimate_grid(scene: &Scene, settings: &BuildSettings) -> Result<GridEstimate> {
    let triangles = u32::try_from(scene.triangle_count()).ok().filter(|count| *count <= gridwalk::MAX_TRIANGLES).ok_or_else(|| {
        Error::Scene { reason: format!("{} triangles, at most {} are possible", scene.triangle_count(), gridwalk::MAX_TRIANGLES) }
    })?;
    let mut bounds = Bounds::EMPTY;
    for_each_triangle(scene, |corners| match corners {
        Some(corners) => {
            for axis in 0..3 {
                for corner in corners {
                    bounds.low[axis] = bounds.low[axis].min(corner[axis]);
                    bounds.high[axis] = bounds.high[axis].max(corner[axis]);
                }
            }
        }
        None => bounds.dropped += 1,
    });
    let info = Configure {
        triangle_count: triangles,
        cell_capacity: cell_capacity(triangles, settings)?,
        density: settings.density,
        fixed: settings.resolution.unwrap_or([0; 3]),
        splits: settings.split,
        exact: settings.overlap == Overlap::Exact,
    };
    let (header, density, _) = configure_header(&info, &bounds, [[0; 2]; 4]);
    let (mut pairs, mut box_pairs) = (0_u64, 0_u64);
    for_each_triangle(scene, |corners| {
        if let Some(corners) = corners {
            let corners = corners.map(|corner| header.to_frame(corner));
            let cells = triangle_cells(&header, corners);
            let size = cells.size();
            let in_box = size.iter().map(|cells| u64::from(*cells)).product::<u64>();
            box_pairs = box_pairs.saturating_add(in_box);
            // A triangle meets every cell of a box of one row. More pairs than any build has room for are not worth the time.
            let test = info.exact && size.iter().filter(|n| **n == 1).count() < 2 && box_pairs <= gridwalk::MAX_PAIRS.into();
            let listed = match u32::try_from(in_box) {
                Ok(count) if test => {
                    let axes = SeparatingAxes::new(&header, corners, cells.low);
                    (0..count).filter(|n| axes.meets(cells.cell(*n))).count() as u64
                }
                _ => in_box,
            };
            pairs = pairs.saturating_add(listed);
        }
    });
    let room = u32::try_from(box_pairs).unwrap_or(u32::MAX).min(gridwalk::MAX_PAIRS);
    let leaf_cells = if settings.split { first_leaf_cells(triangles) } else { 0 };
    let capacity = Capacity { triangles, cells: info.cell_capacity, pairs: room, leaf_cells };
    let (grid_bytes, scratch_bytes) = region_bytes(&capacity, &Shape::GPU);
    Ok(GridEstimate { resolution: header.resolution, density, cells: header.cell_count, pairs, box_pairs, grid_bytes, scratch_bytes })
}

/// Every triangle's corners; `None` for one that the build drops.
fn for_each_triangle(scene: &Scene, mut visit: impl FnMut(Option<[[f32; 3]; 3]>)) {
    for mesh in &scene.meshes {
        for triangle in &mesh.indices {
            let corners = triangle.map(|index| mesh.positions.get(index as usize).copied().unwrap_or([f32::NAN; 3]));
            visit(Some(corners).filter(|corners| corners.as_flattened().iter().all(|value| value.is_finite())));
        }
    }
}
