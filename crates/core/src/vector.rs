//! Three floats, component by component, with the operations and the order of operations of the kernels.

/// A point, a direction or a size.
pub type Vec3 = [f32; 3];

/// Applies `f` to each pair of components.
pub fn zip(a: Vec3, b: Vec3, f: impl Fn(f32, f32) -> f32) -> Vec3 {
    std::array::from_fn(|axis| f(a[axis], b[axis]))
}

/// `a + b`.
pub fn add(a: Vec3, b: Vec3) -> Vec3 {
    zip(a, b, |a, b| a + b)
}

/// `a - b`.
pub fn sub(a: Vec3, b: Vec3) -> Vec3 {
    zip(a, b, |a, b| a - b)
}

/// `a * b`, by component.
pub fn mul(a: Vec3, b: Vec3) -> Vec3 {
    zip(a, b, |a, b| a * b)
}

/// GLSL's `min` of numbers.
pub fn min_f32(a: f32, b: f32) -> f32 {
    if b < a { b } else { a }
}

/// GLSL's `max` of numbers.
pub fn max_f32(a: f32, b: f32) -> f32 {
    if a < b { b } else { a }
}

/// Minimum by component.
pub fn min(a: Vec3, b: Vec3) -> Vec3 {
    zip(a, b, min_f32)
}

/// Maximum by component.
pub fn max(a: Vec3, b: Vec3) -> Vec3 {
    zip(a, b, max_f32)
}

/// Largest component.
pub fn largest(a: Vec3) -> f32 {
    max_f32(a[0], max_f32(a[1], a[2]))
}

/// Whether no component is infinite or NaN.
pub fn is_finite(a: Vec3) -> bool {
    a.iter().all(|x| x.is_finite())
}

/// 2^e for -126 <= e <= 127.
pub fn power_of_two(e: i32) -> f32 {
    f32::from_bits(((e + 127) as u32) << 23)
}

/// floor(log2(x)) for normal x > 0, clamped so that the power of two and its inverse are normal numbers.
pub fn clamped_exponent(x: f32) -> i32 {
    (((x.to_bits() >> 23) & 255) as i32 - 127).clamp(-126, 126)
}
