//! The PLY reader: text and both byte orders, any properties in any order.
//!
//! Our own, because what is asked of it here cannot be had from `ply-rs-bw` 2: errors with line or byte, triangle strips and CR line endings,
//! and no allocation for every face. The tests use it as the second opinion on clean files.
//!
//! A vertex of the file is a vertex of the mesh, used or not, so that key-frames stay comparable vertex for vertex; only texture coordinates
//! of face corners make more of them.

use std::borrow::Cow;
use std::collections::HashMap;

use crate::lines::{number, shown, word, words};
use crate::normals::{Smooth, compute_normals};
use crate::texture::srgb_to_linear;
use crate::triangulate::triangulate;
use crate::{Error, Mesh, Place, Result};

/// The cap for one line of a header.
const MAX_HEADER_LINE: usize = 4096;
/// The caps for what a header declares: far beyond any program's files, and small enough to search.
const MAX_ELEMENTS: usize = 256;
const MAX_PROPERTIES: usize = 1024;
/// The cap for the corners of one face.
const MAX_CORNERS: u64 = 65_536;

/// A PLY file as read.
#[derive(Debug)]
pub(crate) struct Ply {
    /// All materials are 0.
    pub(crate) mesh: Mesh,
    /// The picture that the header names (`comment TextureFile`), with the line.
    pub(crate) texture: Option<(String, u64)>,
    pub(crate) warnings: Vec<String>,
}

/// Whether bytes begin as a PLY file does.
pub(crate) fn is_ply(bytes: &[u8]) -> bool {
    bytes.strip_prefix(b"ply").is_some_and(|rest| rest.first().is_none_or(u8::is_ascii_whitespace))
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Ascii,
    LittleEndian,
    BigEndian,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Type {
    fn named(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// What stands for 1 in a colour; `None` for types that hold it as it is.
    fn greatest(self) -> Option<f64> {
        match self {
            Self::I8 => Some(f64::from(i8::MAX)),
            Self::U8 => Some(f64::from(u8::MAX)),
            Self::I16 => Some(f64::from(i16::MAX)),
            Self::U16 => Some(f64::from(u16::MAX)),
            Self::I32 => Some(f64::from(i32::MAX)),
            Self::U32 => Some(f64::from(u32::MAX)),
            Self::F32 | Self::F64 => None,
        }
    }
}

#[derive(Debug)]
struct Property {
    name: String,
    value: Type,
    /// The type of the length, for a list.
    list: Option<Type>,
}

#[derive(Debug)]
struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

impl Element {
    /// The bytes that a row takes at least.
    fn least_bytes(&self, format: Format) -> u64 {
        let bytes = |property: &Property| match format {
            // A digit and what parts it from the next one.
            Format::Ascii => 2,
            _ => property.list.unwrap_or(property.value).size() as u64,
        };
        self.properties.iter().map(bytes).sum()
    }
}

#[derive(Debug)]
struct Header {
    format: Format,
    elements: Vec<Element>,
    texture: Option<(String, u64)>,
    /// Bytes and lines of the header.
    bytes: usize,
    lines: u64,
}

/// Reads the bytes of a PLY file; `file` is its name in messages.
pub(crate) fn parse(bytes: &[u8], file: &str, name: &str) -> Result<Ply> {
    let header = read_header(bytes, file)?;
    let rest = bytes.get(header.bytes..).unwrap_or_default();
    let body = match header.format {
        Format::Ascii => Body::Text(Text { bytes: rest, at: 0, line: header.lines, words: b"", row: "", surplus: 0 }),
        order => Body::Binary(Binary { bytes, at: header.bytes, big: order == Format::BigEndian }),
    };
    let mut reader = Reader { file, body, vertex_count: 0, vertices: Vertices::default(), faces: Faces::default(), warnings: Vec::new() };
    let vertices = header.elements.iter().find(|element| element.name == "vertex");
    reader.vertex_count = vertices.map_or(0, |element| element.count);
    if reader.vertex_count >= u64::from(u32::MAX) {
        return Err(reader.error(format!("{} vertices; at most {} are possible: split the file", reader.vertex_count, u32::MAX - 1)));
    }
    for element in &header.elements {
        reader.element(element, header.format)?;
    }
    reader.finish(name, header.texture)
}

fn read_header(bytes: &[u8], file: &str) -> Result<Header> {
    let error = |line: u64, message: String| Error::Ply { file: file.to_owned(), place: Place::Line(line), message };
    if !is_ply(bytes) {
        return Err(error(1, "this is not a PLY file (its first line is not \"ply\")".to_owned()));
    }
    // What ends the first line ends all of them: after `end_header` a byte of the body may look like half an ending.
    let ending: &[u8] = match &bytes[3..] {
        rest if rest.trim_ascii_start().is_empty() => b"\n",
        rest => {
            let blanks = rest.iter().take_while(|&&byte| byte == b' ' || byte == b'\t').count();
            match &rest[blanks..] {
                [b'\r', b'\n', ..] => b"\r\n",
                [b'\r', ..] => b"\r",
                _ => b"\n",
            }
        }
    };
    let mut header = Header { format: Format::Ascii, elements: Vec::new(), texture: None, bytes: 0, lines: 0 };
    let mut format = None;
    loop {
        let rest = &bytes[header.bytes..];
        header.lines += 1;
        let line_number = header.lines;
        let end = rest.windows(ending.len()).take(MAX_HEADER_LINE).position(|window| window == ending);
        let end = match end {
            Some(end) => end,
            None if rest.trim_ascii() == b"end_header" => rest.len(),
            None if rest.len() >= MAX_HEADER_LINE => {
                return Err(error(line_number, format!("the header's line is longer than {MAX_HEADER_LINE} bytes; is this a PLY file?")));
            }
            None => return Err(error(line_number, "the file ends within its header, before \"end_header\"".to_owned())),
        };
        header.bytes += (end + ending.len()).min(rest.len());
        let line = rest[..end].trim_ascii();
        let (keyword, rest) = word(line);
        match keyword {
            b"ply" if line_number == 1 => {}
            b"end_header" => break,
            b"comment" | b"obj_info" => {
                let (what, name) = word(rest);
                if what.eq_ignore_ascii_case(b"TextureFile") && !name.is_empty() && header.texture.is_none() {
                    header.texture = Some((String::from_utf8_lossy(name).into_owned(), line_number));
                }
            }
            b"" => {}
            b"format" => {
                let (kind, version) = word(rest);
                format = match kind {
                    b"ascii" => Some(Format::Ascii),
                    b"binary_little_endian" => Some(Format::LittleEndian),
                    b"binary_big_endian" => Some(Format::BigEndian),
                    _ => {
                        return Err(error(
                            line_number,
                            format!("no format \"{}\"; there are ascii, binary_little_endian, binary_big_endian", shown(kind)),
                        ));
                    }
                };
                if version != b"1.0" {
                    return Err(error(line_number, format!("version \"{}\" of the format; only 1.0 can be read", shown(version))));
                }
            }
            b"element" => {
                let (name, count) = word(rest);
                let count = std::str::from_utf8(count).ok().and_then(|count| count.parse().ok());
                let count = count.filter(|_| !name.is_empty()).ok_or_else(|| {
                    error(line_number, format!("\"element {}\" is not understood; write: element name count", shown(rest)))
                })?;
                if header.elements.len() == MAX_ELEMENTS {
                    return Err(error(line_number, format!("more than {MAX_ELEMENTS} elements; is this a PLY file?")));
                }
                let name = String::from_utf8_lossy(name).into_owned();
                if header.elements.iter().any(|element| element.name == name) {
                    return Err(error(line_number, format!("element \"{}\" is there twice; rename or remove one", shown(name.as_bytes()))));
                }
                header.elements.push(Element { name, count, properties: Vec::new() });
            }
            b"property" => {
                let property = read_property(rest).map_err(|message| error(line_number, message))?;
                let element = header
                    .elements
                    .last_mut()
                    .ok_or_else(|| error(line_number, "a property stands before any element; move it below its element".to_owned()))?;
                if element.properties.len() == MAX_PROPERTIES {
                    return Err(error(line_number, format!("more than {MAX_PROPERTIES} properties; is this a PLY file?")));
                }
                element.properties.push(property);
            }
            _ => {
                return Err(error(
                    line_number,
                    format!("\"{}\" has no meaning in a header; there are format, comment, obj_info, element, property", shown(keyword)),
                ));
            }
        }
    }
    header.format = format.ok_or_else(|| error(header.lines, "the header has no format; write: format ascii 1.0".to_owned()))?;
    Ok(header)
}

fn read_property(line: &[u8]) -> Result<Property, String> {
    let named = |name: &[u8]| {
        Type::named(name).ok_or_else(|| {
            format!("no type \"{}\"; there are char, uchar, short, ushort, int, uint, float, double, and int8 to float64", shown(name))
        })
    };
    let mut parts = words(line);
    let first = parts.next().unwrap_or_default();
    let list = if first == b"list" { Some(named(parts.next().unwrap_or_default())?) } else { None };
    if matches!(list, Some(Type::F32 | Type::F64)) {
        return Err("the length of a list must be of a whole type, such as uchar".to_owned());
    }
    let value = named(if list.is_some() { parts.next().unwrap_or_default() } else { first })?;
    match parts.next() {
        Some(name) => Ok(Property { name: String::from_utf8_lossy(name).into_owned(), value, list }),
        None => Err("a property needs a name; write: property type name, or property list type type name".to_owned()),
    }
}

/// Where the values come from.
enum Body<'a> {
    Text(Text<'a>),
    Binary(Binary<'a>),
}

/// A row is a line.
struct Text<'a> {
    bytes: &'a [u8],
    at: usize,
    line: u64,
    /// What is left of the row.
    words: &'a [u8],
    /// What the row is, for messages.
    row: &'static str,
    /// Rows that hold more values than the header tells.
    surplus: u64,
}

struct Binary<'a> {
    bytes: &'a [u8],
    at: usize,
    big: bool,
}

impl Body<'_> {
    fn left(&self) -> u64 {
        match self {
            Self::Text(text) => (text.bytes.len() - text.at) as u64,
            Self::Binary(binary) => (binary.bytes.len() - binary.at) as u64,
        }
    }

    fn place(&self) -> Place {
        match self {
            Self::Text(text) => Place::Line(text.line),
            Self::Binary(binary) => Place::Byte(binary.at as u64),
        }
    }

    /// Goes on to the next row; `Err` where there is none.
    fn begin_row(&mut self, what: &'static str) -> Result<(), String> {
        let Self::Text(text) = self else { return Ok(()) };
        text.row = what;
        text.surplus += u64::from(!text.words.is_empty());
        loop {
            let rest = text.bytes.get(text.at..).unwrap_or_default();
            if rest.is_empty() {
                return Err(format!("the file ends where a {what} should be"));
            }
            text.line += 1;
            let end = rest.iter().position(|&byte| byte == b'\n' || byte == b'\r').unwrap_or(rest.len());
            let ending = match &rest[end..] {
                [b'\r', b'\n', ..] => 2,
                [] => 0,
                _ => 1,
            };
            text.at += end + ending;
            text.words = rest[..end].trim_ascii();
            if !text.words.is_empty() {
                return Ok(());
            }
        }
    }

    /// The next value of the row.
    fn value(&mut self, kind: Type) -> Result<f64, String> {
        match self {
            Self::Text(text) => {
                let (value, rest) = word(text.words);
                if value.is_empty() {
                    return Err(format!("the {} has too few values", text.row));
                }
                text.words = rest;
                let parsed = match kind {
                    // As OBJ files are read: rounded once.
                    Type::F32 => number(value).map(f64::from),
                    _ => std::str::from_utf8(value).ok().and_then(|text| text.parse().ok()),
                };
                parsed.ok_or_else(|| format!("\"{}\" is not a number", shown(value)))
            }
            Self::Binary(binary) => binary.value(kind).ok_or_else(|| "the file ends in the middle of a row".to_owned()),
        }
    }

    /// The length of a list, which the bytes that are left can hold.
    fn length(&mut self, list: Type, value: Type) -> Result<u64, String> {
        let length = self.value(list)?;
        if !(length >= 0.0 && length.fract() == 0.0) {
            return Err(format!("a list of {length} values; the length must be a whole number, 0 or more"));
        }
        let each = if matches!(self, Self::Text(_)) { 1 } else { value.size() as u64 };
        let left = match self {
            Self::Text(text) => text.words.len() as u64,
            Self::Binary(_) => self.left(),
        };
        // Lengths come from at most 32 bits, or from text.
        let length = length as u64;
        if length.saturating_mul(each) > left {
            return Err(format!(
                "a list of {length} values goes beyond the end of the {}",
                if each == 1 && matches!(self, Self::Text(_)) { "line" } else { "file" }
            ));
        }
        Ok(length)
    }

    fn skip(&mut self, property: &Property) -> Result<(), String> {
        let count = match property.list {
            Some(list) => self.length(list, property.value)?,
            None => 1,
        };
        if let Self::Binary(binary) = self {
            let bytes = count.saturating_mul(property.value.size() as u64);
            if bytes > (binary.bytes.len() - binary.at) as u64 {
                return Err("the file ends in the middle of a row".to_owned());
            }
            binary.at += bytes as usize;
            return Ok(());
        }
        for _ in 0..count {
            self.value(property.value)?;
        }
        Ok(())
    }
}

impl Binary<'_> {
    fn value(&mut self, kind: Type) -> Option<f64> {
        let bytes = self.bytes.get(self.at..)?;
        let big = self.big;
        macro_rules! take {
            ($type:ty) => {{
                let bytes = *bytes.first_chunk()?;
                f64::from(if big { <$type>::from_be_bytes(bytes) } else { <$type>::from_le_bytes(bytes) })
            }};
        }
        let value = match kind {
            Type::I8 => take!(i8),
            Type::U8 => take!(u8),
            Type::I16 => take!(i16),
            Type::U16 => take!(u16),
            Type::I32 => take!(i32),
            Type::U32 => take!(u32),
            Type::F32 => take!(f32),
            Type::F64 => take!(f64),
        };
        self.at += kind.size();
        Some(value)
    }
}

#[derive(Default)]
struct Vertices {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    colours: Vec<[f32; 3]>,
    non_finite: u64,
}

#[derive(Default)]
struct Faces {
    /// Corners of all faces, one after the other.
    corners: Vec<u32>,
    /// Where each face ends in `corners`.
    ends: Vec<usize>,
    /// Texture coordinates, one a corner; empty until a face has some.
    uvs: Vec<[f32; 2]>,
    small: u64,
    bad_uvs: u64,
}

struct Reader<'a> {
    file: &'a str,
    body: Body<'a>,
    vertex_count: u64,
    vertices: Vertices,
    faces: Faces,
    warnings: Vec<String>,
}

/// The values of a vertex that count.
const COLUMNS: [&[&str]; 11] = [
    &["x"],
    &["y"],
    &["z"],
    &["nx", "normal_x"],
    &["ny", "normal_y"],
    &["nz", "normal_z"],
    &["s", "u", "texture_u", "texture_s"],
    &["t", "v", "texture_v", "texture_t"],
    &["red", "diffuse_red", "r"],
    &["green", "diffuse_green", "g"],
    &["blue", "diffuse_blue", "b"],
];

impl Reader<'_> {
    fn error(&self, message: String) -> Error {
        Error::Ply { file: self.file.to_owned(), place: self.body.place(), message }
    }

    fn element(&mut self, element: &Element, format: Format) -> Result<()> {
        // Rows of nothing take no bytes, however many the header promises.
        if element.properties.is_empty() {
            return if element.name == "vertex" && element.count > 0 { Err(self.error(NO_POSITION.to_owned())) } else { Ok(()) };
        }
        // A last line without an ending is a byte shorter.
        if element.count.saturating_mul(element.least_bytes(format)) > self.body.left() + 1 {
            return Err(self.error(format!(
                "the header promises {} rows of element \"{}\", but only {} bytes follow; the file was cut off",
                element.count,
                shown(element.name.as_bytes()),
                self.body.left()
            )));
        }
        match element.name.as_str() {
            "vertex" => self.vertices(element),
            "face" => self.faces(element, "face"),
            "tristrips" => self.faces(element, "strip"),
            _ => {
                for _ in 0..element.count {
                    self.body.begin_row("row").map_err(|message| self.error(message))?;
                    for property in &element.properties {
                        self.body.skip(property).map_err(|message| self.error(message))?;
                    }
                }
                Ok(())
            }
        }
    }

    fn vertices(&mut self, element: &Element) -> Result<()> {
        let column = |property: &Property| {
            let named = |names: &&[&str]| property.list.is_none() && names.contains(&property.name.as_str());
            COLUMNS.iter().position(named)
        };
        let columns: Vec<Option<usize>> = element.properties.iter().map(column).collect();
        let has = |wanted: std::ops::Range<usize>| wanted.clone().all(|wanted| columns.contains(&Some(wanted)));
        if !has(0..3) {
            return Err(self.error(NO_POSITION.to_owned()));
        }
        let (has_normals, has_uvs, has_colours) = (has(3..6), has(6..8), has(8..11));
        // How each column is brought to a colour between 0 and 1.
        let mut greatest = [None; COLUMNS.len()];
        for (property, column) in element.properties.iter().zip(&columns) {
            if let Some(column) = column {
                greatest[*column] = property.value.greatest();
            }
        }
        let colour = |value: f64, greatest: Option<f64>| match greatest {
            Some(greatest) => srgb_to_linear((value / greatest).clamp(0.0, 1.0) as f32),
            None if value.is_finite() => value.clamp(0.0, f64::from(f32::MAX)) as f32,
            None => 1.0,
        };
        // `element` made sure that the file can hold so many.
        let count = element.count as usize;
        let vertices = &mut self.vertices;
        vertices.positions.reserve_exact(count);
        vertices.normals.reserve_exact(if has_normals { count } else { 0 });
        vertices.uvs.reserve_exact(if has_uvs { count } else { 0 });
        vertices.colours.reserve_exact(if has_colours { count } else { 0 });
        for _ in 0..count {
            let mut row = [0.0_f64; COLUMNS.len()];
            let mut read = || {
                self.body.begin_row("vertex")?;
                for (property, column) in element.properties.iter().zip(&columns) {
                    match column {
                        Some(column) => row[*column] = self.body.value(property.value)?,
                        None => self.body.skip(property)?,
                    }
                }
                Ok(())
            };
            if let Err(message) = read() {
                return Err(self.error(message));
            }
            let vertices = &mut self.vertices;
            let [x, y, z, nx, ny, nz, u, v, red, green, blue] = row;
            let position = [x as f32, y as f32, z as f32];
            vertices.non_finite += u64::from(!position.iter().all(|value| value.is_finite()));
            vertices.positions.push(position);
            if has_normals {
                vertices.normals.push([nx as f32, ny as f32, nz as f32]);
            }
            if has_uvs {
                vertices.uvs.push(finite([u as f32, v as f32]));
            }
            if has_colours {
                vertices.colours.push([colour(red, greatest[8]), colour(green, greatest[9]), colour(blue, greatest[10])]);
            }
        }
        Ok(())
    }

    /// Faces, or strips of triangles that a -1 ends.
    fn faces(&mut self, element: &Element, what: &'static str) -> Result<()> {
        let strips = what == "strip";
        let indices = |property: &Property| property.list.is_some() && matches!(property.name.as_str(), "vertex_indices" | "vertex_index");
        let Some(at) = element.properties.iter().position(indices) else {
            return Err(self.error(format!("a {what} needs the property \"list uchar int vertex_indices\"")));
        };
        let uvs_at = element.properties.iter().position(|property| property.list.is_some() && property.name == "texcoord" && !strips);
        let mut corners = Vec::new();
        let mut uvs = Vec::new();
        for _ in 0..element.count {
            corners.clear();
            uvs.clear();
            let mut read = || {
                self.body.begin_row(what)?;
                for (number, property) in element.properties.iter().enumerate() {
                    match property.list {
                        Some(list) if number == at => {
                            let count = self.body.length(list, property.value)?;
                            if count > MAX_CORNERS && !strips {
                                return Err(format!("a face of {count} corners; cut it into ones of at most {MAX_CORNERS}"));
                            }
                            for _ in 0..count {
                                let index = self.body.value(property.value)?;
                                // Also true for what is no number.
                                let outside = !(index >= 0.0 && index < self.vertex_count as f64 && index.fract() == 0.0);
                                if outside && !(strips && index == -1.0) {
                                    return Err(format!("there is no vertex {index}; {} are counted from 0", self.vertex_count));
                                }
                                // -1 saturates to 0: what ends a strip is told by its length below.
                                corners.push(if outside { u32::MAX } else { index as u32 });
                            }
                        }
                        Some(list) if Some(number) == uvs_at => {
                            let count = self.body.length(list, property.value)?;
                            for _ in 0..count {
                                uvs.push(self.body.value(property.value)? as f32);
                            }
                        }
                        _ => self.body.skip(property)?,
                    }
                }
                Ok(())
            };
            if let Err(message) = read() {
                return Err(self.error(message));
            }
            if strips {
                for strip in corners.split(|&corner| corner == u32::MAX) {
                    for (number, corner) in strip.windows(3).enumerate() {
                        // Every other triangle is wound the other way.
                        let [a, b, c] = if number % 2 == 0 { [0, 1, 2] } else { [1, 0, 2] };
                        self.faces.push(&[corner[a], corner[b], corner[c]], &[]);
                    }
                }
            } else {
                self.faces.push(&corners, &uvs);
            }
        }
        Ok(())
    }

    fn finish(mut self, name: &str, texture: Option<(String, u64)>) -> Result<Ply> {
        let Vertices { mut positions, mut normals, mut uvs, mut colours, non_finite } = self.vertices;
        let mut faces = self.faces;
        if faces.corners.len().saturating_add(positions.len()) >= u32::MAX as usize {
            return Err(Error::Ply {
                file: self.file.to_owned(),
                place: self.body.place(),
                message: "more than 2^32 corners; split the file".to_owned(),
            });
        }
        // Which vertex of the file each vertex of the mesh is.
        let mut places: Cow<'_, [u32]> = Cow::Borrowed(&[]);
        if !faces.uvs.is_empty() {
            let from = faces.split_by_uv(positions.len());
            let pick = |values: &mut Vec<[f32; 3]>| {
                if !values.is_empty() {
                    *values = from.iter().map(|&at| values.get(at as usize).copied().unwrap_or_default()).collect();
                }
            };
            pick(&mut positions);
            pick(&mut normals);
            pick(&mut colours);
            uvs = vec![[0.0; 2]; from.len()];
            for (&corner, uv) in faces.corners.iter().zip(&faces.uvs) {
                if let Some(slot) = uvs.get_mut(corner as usize) {
                    *slot = *uv;
                }
            }
            places = Cow::Owned(from);
        }
        uvs.resize(positions.len(), [0.0; 2]);
        let mut mesh = Mesh { name: name.to_owned(), positions, uvs, colours, ..Mesh::default() };

        let mut points = Vec::new();
        let mut triangles = Vec::new();
        mesh.indices.reserve_exact(faces.corners.len().saturating_sub(2 * faces.ends.len()));
        let mut begin = 0;
        for &end in &faces.ends {
            let corners = faces.corners.get(begin..end).unwrap_or_default();
            begin = end;
            if let [a, b, c] = *corners {
                mesh.indices.push([a, b, c]);
                continue;
            }
            points.clear();
            points.extend(corners.iter().map(|&corner| mesh.positions.get(corner as usize).copied().unwrap_or_default()));
            triangulate(&points, &mut triangles);
            mesh.indices.extend(triangles.iter().map(|triangle| triangle.map(|at| corners.get(at).copied().unwrap_or_default())));
        }
        mesh.materials = vec![0; mesh.indices.len()];
        let usable = |normal: &[f32; 3]| {
            let square: f64 = normal.iter().map(|&value| f64::from(value) * f64::from(value)).sum();
            square.is_finite() && square > 0.0
        };
        let smooth: Vec<Smooth> = (0..mesh.positions.len())
            .map(|at| match normals.get(at).filter(|normal| usable(normal)) {
                Some(normal) => Smooth::Given(*normal),
                None => Smooth::Shared { place: places.get(at).copied().unwrap_or(at as u32), group: 0 },
            })
            .collect();
        compute_normals(&mut mesh, &smooth);

        let file = self.file;
        let mut warn = |count: u64, what: &str| {
            if count > 0 {
                self.warnings.push(format!("{file}: {what} (in {count} {})", if count == 1 { "place" } else { "places" }));
            }
        };
        warn(non_finite, "a vertex is not finite; triangles at it are dropped");
        if let Body::Text(text) = &self.body {
            warn(text.surplus + u64::from(!text.words.is_empty()), "a row holds more values than the header tells; they are not read");
        }
        warn(faces.small, "a face of fewer than 3 corners is skipped");
        warn(faces.bad_uvs, "a face has other than two texture coordinates a corner; they count as none");
        if mesh.indices.is_empty() {
            self.warnings.push(format!("{file}: holds no faces"));
        }
        Ok(Ply { mesh, texture, warnings: self.warnings })
    }
}

const NO_POSITION: &str = "a vertex needs the properties x, y and z";

fn finite(uv: [f32; 2]) -> [f32; 2] {
    uv.map(|value| if value.is_finite() { value } else { 0.0 })
}

impl Faces {
    /// Adds a face with its texture coordinates, two a corner or none.
    fn push(&mut self, corners: &[u32], uvs: &[f32]) {
        if corners.len() < 3 {
            self.small += 1;
            return;
        }
        let given = uvs.len() == 2 * corners.len();
        self.bad_uvs += u64::from(!given && !uvs.is_empty());
        if given || !self.uvs.is_empty() {
            self.uvs.resize(self.corners.len(), [0.0; 2]);
            self.uvs.extend(uvs.as_chunks::<2>().0.iter().take(if given { corners.len() } else { 0 }).map(|uv| finite(*uv)));
            self.uvs.resize(self.corners.len() + corners.len(), [0.0; 2]);
        }
        self.corners.extend_from_slice(corners);
        self.ends.push(self.corners.len());
    }

    /// Gives corners of one vertex and different texture coordinates vertices of their own. Returns for each vertex the one that it was: the
    /// first `vertex_count` are as before.
    fn split_by_uv(&mut self, vertex_count: usize) -> Vec<u32> {
        // `finish` made sure that vertices and corners together are below 2^32.
        let mut from: Vec<u32> = (0..vertex_count as u32).collect();
        let mut first: Vec<Option<[u32; 2]>> = vec![None; vertex_count];
        let mut others: HashMap<(u32, [u32; 2]), u32> = HashMap::new();
        for (corner, uv) in self.corners.iter_mut().zip(&self.uvs) {
            let bits = uv.map(f32::to_bits);
            match first.get_mut(*corner as usize) {
                Some(slot @ None) => *slot = Some(bits),
                Some(Some(known)) if *known == bits => {}
                _ => {
                    let vertex = *corner;
                    *corner = *others.entry((vertex, bits)).or_insert_with(|| {
                        from.push(vertex);
                        (from.len() - 1) as u32
                    });
                }
            }
        }
        from
    }
}
