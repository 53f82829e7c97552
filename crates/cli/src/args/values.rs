//! Values of options from their text.

/// Three coordinates.
pub type Vector = [f32; 3];
/// Width and height.
pub type Extent = [u32; 2];
/// Cells along each axis.
pub type Resolution = [u32; 3];

/// Largest width and height; the product is bounded too, so that sizes of layers stay far from overflow.
const MAX_EXTENT: u32 = 65_536;
const MAX_PIXELS: u64 = 1 << 28;

/// `1920x1080` or `1920,1080`.
pub fn size(text: &str) -> Result<Extent, String> {
    let [width, height] = integers::<2>(text).ok_or("write it as 1920x1080")?;
    if width == 0 || height == 0 || width > MAX_EXTENT || height > MAX_EXTENT || u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(format!("each side must be 1 to {MAX_EXTENT} and the whole at most {MAX_PIXELS} pixels"));
    }
    Ok([width, height])
}

/// `128x128x64`, also with commas, or one number for all axes.
pub fn resolution(text: &str) -> Result<Resolution, String> {
    let cells = integers::<1>(text).map(|[n]| [n; 3]).or_else(|| integers::<3>(text)).ok_or("write it as 128x128x64")?;
    // The library's own bounds are told by the library; this keeps nonsense out.
    if cells.iter().any(|n| *n == 0 || *n > 4096) { Err("each axis must have 1 to 4096 cells".to_owned()) } else { Ok(cells) }
}

/// `100,50,320,240`: first column and row, columns, rows.
pub fn crop(text: &str) -> Result<[u32; 4], String> {
    integers(text).filter(|[_, _, width, height]| *width > 0 && *height > 0).ok_or_else(|| "write it as x,y,width,height".to_owned())
}

fn integers<const N: usize>(text: &str) -> Option<[u32; N]> {
    let parts: Option<Vec<u32>> = text.split(['x', 'X', ',']).map(|part| part.trim().parse().ok()).collect();
    parts?.try_into().ok()
}

/// `1,2.5,-3`.
pub fn vector(text: &str) -> Result<Vector, String> {
    let parts: Option<Vec<f32>> = text.split(',').map(|part| part.trim().parse().ok().filter(|value: &f32| value.is_finite())).collect();
    parts.and_then(|parts| parts.try_into().ok()).ok_or_else(|| "write it as three numbers: 1,2.5,-3".to_owned())
}

/// `+Z`, `-y`, `x`, or a vector that is not zero.
pub fn up(text: &str) -> Result<Vector, String> {
    let (sign, axis) = match text.as_bytes() {
        [b'+', axis] => (1.0, *axis),
        [b'-', axis] => (-1.0, *axis),
        [axis] => (1.0, *axis),
        _ => (0.0, 0),
    };
    match axis.to_ascii_lowercase() {
        b'x' => Ok([sign, 0.0, 0.0]),
        b'y' => Ok([0.0, sign, 0.0]),
        b'z' => Ok([0.0, 0.0, sign]),
        _ => vector(text).ok().filter(|up| up.iter().any(|value| *value != 0.0)).ok_or("write it as +Z, or as 0,0,1".to_owned()),
    }
}

/// Any number but infinities.
pub fn finite(text: &str) -> Result<f32, String> {
    text.parse().ok().filter(|value: &f32| value.is_finite()).ok_or_else(|| "must be a number".to_owned())
}

/// Any number above zero.
pub fn positive(text: &str) -> Result<f32, String> {
    finite(text).ok().filter(|value| *value > 0.0).ok_or_else(|| "must be a number above 0".to_owned())
}

/// A point in time.
pub fn seconds(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| "must be a number of seconds".to_owned())
}

/// A stretch of time.
pub fn duration(text: &str) -> Result<f64, String> {
    seconds(text).ok().filter(|value| *value > 0.0 && *value <= 1e6).ok_or_else(|| "must be seconds above 0, at most 1000000".to_owned())
}

/// An angle of view.
pub fn angle(text: &str) -> Result<f32, String> {
    finite(text).ok().filter(|value| *value >= 0.1 && *value <= 170.0).ok_or_else(|| "must be 0.1 to 170 degrees".to_owned())
}

/// Zero or above.
pub fn threshold(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|value: &f64| *value >= 0.0).ok_or_else(|| "must be a number, 0 or above".to_owned())
}

#[cfg(test)]
mod tests {
    use super::{resolution, size, up, vector};

    #[test]
    fn sizes() {
        assert_eq!(size("1920x1080"), Ok([1920, 1080]));
        assert_eq!(size("7,5"), Ok([7, 5]));
        for wrong in ["", "1920", "1920x", "x", "0x5", "5x0", "-1x5", "1e3x5", "70000x1", "65536x65536", "1x2x3", "99999999999x1"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn resolutions() {
        assert_eq!(resolution("64"), Ok([64; 3]));
        assert_eq!(resolution("1x2x3"), Ok([1, 2, 3]));
        assert_eq!(resolution("1,2,3"), Ok([1, 2, 3]));
        assert!(resolution("1x2").is_err() && resolution("0x1x1").is_err() && resolution("5000").is_err());
    }

    #[test]
    fn vectors_and_axes() {
        assert_eq!(vector("1, -2.5,3e2"), Ok([1.0, -2.5, 300.0]));
        assert!(vector("1,2").is_err() && vector("1,2,nan").is_err() && vector("1,2,inf").is_err() && vector("1,2,3,4").is_err());
        assert_eq!(up("+Z"), Ok([0.0, 0.0, 1.0]));
        assert_eq!(up("-y"), Ok([0.0, -1.0, 0.0]));
        assert_eq!(up("x"), Ok([1.0, 0.0, 0.0]));
        assert_eq!(up("0,1,1"), Ok([0.0, 1.0, 1.0]));
        assert!(up("0,0,0").is_err() && up("w").is_err() && up("").is_err());
    }
}
