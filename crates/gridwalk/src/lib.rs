//! Builds uniform grids and traces rays on a Vulkan device that it is given.
