//! Pictures by gridwalk: device, frame loop, shading and image files.
