//! NumPy arrays: rays in, hits out (NPY format 1 to 3, and NPZ).
//!
//! Read with a parser of our own: the crates for it build a tree from the header by recursion, or multiply its numbers unchecked, so that a
//! file of a few hundred bytes ends the program.

use std::io::{Cursor, Read, Write};

use zip::CompressionMethod;
use zip::write::SimpleFileOptions;

/// NumPy writes 128 bytes; a header beyond this is none of an array of numbers.
const MAX_HEADER: usize = 65_536;

/// An array of single-precision numbers, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct FloatArray {
    /// Extent along each axis.
    pub shape: Vec<usize>,
    /// The numbers, in C order.
    pub values: Vec<f32>,
}

/// Reads an NPY file of float32 in C order. `limit` bounds the bytes of the array; nothing is allocated before its size is known to be
/// within it, and no more than the reader gives.
///
/// # Errors
/// What is wrong and, where NumPy can mend it, how.
pub fn read_f32(reader: &mut dyn Read, limit: u64) -> Result<FloatArray, String> {
    let io = |error: std::io::Error| match error.kind() {
        std::io::ErrorKind::UnexpectedEof => "it ends too early".to_owned(),
        _ => error.to_string(),
    };
    let mut start = [0; 8];
    reader.read_exact(&mut start).map_err(io)?;
    if start[..6] != *b"\x93NUMPY" {
        return Err("it is no NPY file; write it with numpy.save".to_owned());
    }
    let length = match start[6] {
        1 => {
            let mut length = [0; 2];
            reader.read_exact(&mut length).map_err(io)?;
            usize::from(u16::from_le_bytes(length))
        }
        2 | 3 => {
            let mut length = [0; 4];
            reader.read_exact(&mut length).map_err(io)?;
            u32::from_le_bytes(length) as usize
        }
        version => return Err(format!("NPY version {version} is not known")),
    };
    if length > MAX_HEADER {
        return Err(format!("its header has {length} bytes"));
    }
    let mut header = vec![0; length];
    reader.read_exact(&mut header).map_err(io)?;
    let header = std::str::from_utf8(&header).map_err(|_| "its header is no text".to_owned())?;
    let header = Header::parse(header).ok_or_else(|| format!("its header cannot be understood: {}", header.trim()))?;

    match header.descr {
        "<f4" => {}
        "<f8" | ">f8" | ">f4" | "=f8" => {
            return Err(format!("its type is {}, float32 is needed; save rays.astype(\"<f4\")", header.descr));
        }
        other => return Err(format!("its type is {other}, float32 is needed")),
    }
    if header.fortran_order {
        return Err("it is in Fortran order; save numpy.ascontiguousarray(rays)".to_owned());
    }
    let count = header.shape.iter().try_fold(1_usize, |count, extent| count.checked_mul(*extent));
    let bytes = count.and_then(|count| count.checked_mul(4)).filter(|bytes| *bytes as u64 <= limit);
    let Some(bytes) = bytes else {
        return Err(format!("an array of shape {:?} has more than the {limit} bytes allowed; raise --max-size", header.shape));
    };
    // Grows with what is really there: a short file with a large header costs nothing.
    let mut data = Vec::new();
    reader.take(bytes as u64).read_to_end(&mut data).map_err(io)?;
    if data.len() != bytes {
        return Err(format!("it ends too early: {} of {bytes} bytes for shape {:?}", data.len(), header.shape));
    }
    let values = data.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    Ok(FloatArray { shape: header.shape, values })
}

/// The header: a Python dictionary of three known keys.
struct Header<'a> {
    descr: &'a str,
    fortran_order: bool,
    shape: Vec<usize>,
}

impl<'a> Header<'a> {
    fn parse(text: &'a str) -> Option<Header<'a>> {
        let mut parser = Parser { rest: text.trim() };
        let (mut descr, mut fortran_order, mut shape) = (None, None, None);
        parser.expect('{')?;
        while parser.expect('}').is_none() {
            let key = parser.string()?;
            parser.expect(':')?;
            match key {
                "descr" if descr.is_none() => descr = Some(parser.string()?),
                "fortran_order" if fortran_order.is_none() => fortran_order = Some(parser.boolean()?),
                "shape" if shape.is_none() => shape = Some(parser.tuple()?),
                _ => return None,
            }
            if parser.expect(',').is_none() {
                parser.expect('}')?;
                break;
            }
        }
        if parser.rest.is_empty() { Some(Header { descr: descr?, fortran_order: fortran_order?, shape: shape? }) } else { None }
    }
}

struct Parser<'a> {
    rest: &'a str,
}

impl<'a> Parser<'a> {
    fn expect(&mut self, wanted: char) -> Option<()> {
        self.rest = self.rest.strip_prefix(wanted)?.trim_start();
        Some(())
    }

    fn string(&mut self) -> Option<&'a str> {
        let quote = self.rest.chars().next().filter(|quote| matches!(quote, '\'' | '"'))?;
        let (string, rest) = self.rest[1..].split_once(quote)?;
        self.rest = rest.trim_start();
        Some(string)
    }

    fn boolean(&mut self) -> Option<bool> {
        for (word, value) in [("True", true), ("False", false)] {
            if let Some(rest) = self.rest.strip_prefix(word) {
                self.rest = rest.trim_start();
                return Some(value);
            }
        }
        None
    }

    fn tuple(&mut self) -> Option<Vec<usize>> {
        let mut extents = Vec::new();
        self.expect('(')?;
        while self.expect(')').is_none() {
            let digits = self.rest.len() - self.rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
            // NumPy has at most 64 axes.
            extents.push(self.rest[..digits].parse().ok().filter(|_| extents.len() < 64)?);
            self.rest = self.rest[digits..].trim_start();
            if self.expect(',').is_none() {
                self.expect(')')?;
                break;
            }
        }
        Some(extents)
    }
}

/// Values that NumPy knows by a type name.
pub trait Element: Copy {
    /// NumPy's name for the type.
    const DESCR: &'static str;
    /// Appends the value as NumPy stores it.
    fn write(self, bytes: &mut Vec<u8>);
}

impl Element for f32 {
    const DESCR: &'static str = "<f4";
    fn write(self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }
}

impl Element for u32 {
    const DESCR: &'static str = "<u4";
    fn write(self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }
}

impl Element for bool {
    const DESCR: &'static str = "|b1";
    fn write(self, bytes: &mut Vec<u8>) {
        bytes.push(u8::from(self));
    }
}

/// An array of rows as an NPY file. `columns` of `None` makes it one-dimensional.
pub fn npy<T: Element>(values: &[T], columns: Option<usize>) -> Vec<u8> {
    let shape = match columns {
        None => format!("({},)", values.len()),
        Some(columns) => format!("({}, {columns})", values.len() / columns.max(1)),
    };
    let mut header = format!("{{'descr': '{}', 'fortran_order': False, 'shape': {shape}, }}", T::DESCR);
    // The data begin at a multiple of 64 bytes; ten come before the header.
    while !(10 + header.len() + 1).is_multiple_of(64) {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.reserve(std::mem::size_of_val(values));
    for value in values {
        value.write(&mut bytes);
    }
    bytes
}

/// Several NPY files as one NPZ, not compressed as `numpy.savez` does it, and without times, so that equal arrays give equal bytes.
///
/// # Errors
/// What the archiver says.
pub fn npz(arrays: &[(&str, Vec<u8>)]) -> Result<Vec<u8>, String> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in arrays {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .large_file(bytes.len() as u64 >= u64::from(u32::MAX) - 65_536);
        archive.start_file(format!("{name}.npy"), options).map_err(|error| error.to_string())?;
        archive.write_all(bytes).map_err(|error| error.to_string())?;
    }
    archive.finish().map(Cursor::into_inner).map_err(|error| error.to_string())
}

#[cfg(test)]
#[allow(clippy::expect_used, reason = "a test that fails panics")]
mod tests {
    use super::{FloatArray, npy, npz, read_f32};

    fn read(bytes: &[u8]) -> Result<FloatArray, String> {
        read_f32(&mut &bytes[..], 1 << 20)
    }

    /// As numpy.save writes it, with another header.
    fn file(version: u8, header: &str, data: &[u8]) -> Vec<u8> {
        let mut bytes = b"\x93NUMPY".to_vec();
        bytes.extend([version, 0]);
        if version == 1 {
            bytes.extend((header.len() as u16).to_le_bytes())
        } else {
            bytes.extend((header.len() as u32).to_le_bytes())
        }
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    #[test]
    fn what_is_written_is_read() {
        let values: Vec<f32> = (0..12).map(|i| i as f32 - 3.5).collect();
        let bytes = npy(&values, Some(6));
        assert_eq!(bytes.len() % 64, 48, "data begin at a multiple of 64");
        assert_eq!(read(&bytes), Ok(FloatArray { shape: vec![2, 6], values: values.clone() }));
        assert_eq!(read(&npy(&values, None)).map(|array| array.shape), Ok(vec![12]));
        assert_eq!(read(&npy::<f32>(&[], Some(8))), Ok(FloatArray { shape: vec![0, 8], values: vec![] }));
    }

    #[test]
    fn headers_in_the_wild() {
        let data = [0; 24];
        for header in [
            "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 6), }      \n",
            "{'descr':'<f4','fortran_order':False,'shape':(1,6)}\n",
            "{\"shape\": (1, 6,), \"fortran_order\": False, \"descr\": \"<f4\"}",
        ] {
            for version in 1..=3 {
                assert_eq!(read(&file(version, header, &data)).map(|array| array.shape), Ok(vec![1, 6]), "{header}");
            }
        }
    }

    #[test]
    fn hostile_headers_are_refused() {
        let deep = "(".repeat(60_000);
        for (header, word) in [
            ("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 6), }", "astype"),
            ("{'descr': '|O', 'fortran_order': False, 'shape': (1, 6), }", "|O"),
            ("{'descr': '<f4', 'fortran_order': True, 'shape': (1, 6), }", "ascontiguousarray"),
            ("{'descr': '<f4', 'fortran_order': False, 'shape': (18446744073709551615, 18446744073709551615), }", "bytes allowed"),
            ("{'descr': '<f4', 'fortran_order': False, 'shape': (4294967296, 4294967296, 4294967296), }", "bytes allowed"),
            ("{'descr': '<f4', 'fortran_order': False, 'shape': (99999999999999999999, 6), }", "understood"),
            ("{'descr': '<f4', 'fortran_order': False, 'shape': (-1, 6), }", "understood"),
            ("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 6), }", "too early"),
            ("{'descr': '<f4', 'fortran_order': False}", "understood"),
            ("{'descr': '<f4', 'descr': '<f4', 'fortran_order': False, 'shape': (1, 6)}", "understood"),
            ("{'descr': [('x', '<f4')], 'fortran_order': False, 'shape': (1, 6)}", "understood"),
            ("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 6)} + 1", "understood"),
            ("{'d\u{e9}scr", "understood"),
            ("", "understood"),
            (&deep, "understood"),
        ] {
            let error = read(&file(2, header, &[0; 24])).expect_err(header);
            assert!(error.contains(word), "{header}: {error}");
        }
        assert!(read(b"").is_err_and(|error| error.contains("too early")));
        assert!(read(b"PK\x03\x04 a zip").is_err_and(|error| error.contains("numpy.save")));
        assert!(read(b"\x93NUMPY\x09\x00").is_err());
        let mut long = b"\x93NUMPY\x02\x00".to_vec();
        long.extend(u32::MAX.to_le_bytes());
        assert!(read(&long).is_err_and(|error| error.contains("bytes")));
    }

    #[test]
    fn an_archive_holds_every_array() {
        let bytes = npz(&[("t_hit", npy(&[1.0_f32, f32::INFINITY], None)), ("occluded", npy(&[true, false], None))]);
        let bytes = bytes.expect("an archive");
        let mut archive = zip::ZipArchive::new(std::io::Cursor::new(bytes)).expect("a zip file");
        assert_eq!(archive.len(), 2);
        let mut file = archive.by_name("t_hit.npy").expect("the array");
        assert_eq!(read_f32(&mut file, 100).map(|array| array.values), Ok(vec![1.0, f32::INFINITY]));
    }
}
