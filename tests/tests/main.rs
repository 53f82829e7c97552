//! Integration tests of gridwalk.
