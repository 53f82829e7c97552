//! The OBJ reader.
//!
//! Our own, because what is asked of it here cannot be had from `tobj` 4.0.5, which the tests use as the second opinion on clean files:
//! errors with line numbers, smooth normals across groups (`tobj` starts its vertices anew with every group and material), concave
//! polygons, the names of materials that are missing, and files with other bytes than UTF-8, CR line endings or continued lines.
//!
//! One file is one mesh with its faces in file order, whatever its groups, and its vertices in the order of their `v` lines.

use crate::lines::{LineTooLong, Lines, MAX_LINE_BYTES, number, shown, word, words};
use crate::normals::{Smooth, compute_normals};
use crate::triangulate::triangulate;
use crate::{Error, Mesh, Result};

/// The cap for the corners of one face.
const MAX_CORNERS: usize = 65_536;
/// How many of a position's vertices are compared with a new corner before it becomes a vertex of its own. Files made for it could have
/// millions; an extra vertex is harmless.
const MAX_SEARCH: usize = 64;

const NONE: u32 = u32::MAX;

/// An OBJ file as read, its materials still names.
#[derive(Debug)]
pub(crate) struct Obj {
    /// `mesh.materials` counts in `materials`, plus one: 0 is "none named".
    pub(crate) mesh: Mesh,
    /// Names after `usemtl`, each once, with the line where each is first used.
    pub(crate) materials: Vec<(String, u64)>,
    /// What stands after `mtllib`, with the line.
    pub(crate) libraries: Vec<(String, u64)>,
    pub(crate) warnings: Vec<String>,
}

/// What decides the normal of a corner.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum NormalSource {
    /// The number of a `vn` line.
    File(u32),
    /// Computed across all faces of the same smoothing group about the same position.
    Group(u32),
    /// Computed from the polygon of this number alone.
    Polygon(u32),
}

/// A vertex of the mesh, in the terms of the file.
#[derive(Clone, Copy)]
struct Vertex {
    uv: u32,
    normal: NormalSource,
    /// The next vertex of the same position.
    next: u32,
}

#[derive(Clone, Copy)]
struct Corner {
    position: u32,
    uv: u32,
    normal: u32,
}

/// Something odd that may occur in every line: told once, with a count and the first place.
#[derive(Default)]
struct Tally {
    count: u64,
    first_line: u64,
}

impl Tally {
    fn add(&mut self, line: u64) {
        if self.count == 0 {
            self.first_line = line;
        }
        self.count += 1;
    }

    fn warn(&self, warnings: &mut Vec<String>, file: &str, what: &str) {
        if self.count > 0 {
            warnings.push(format!(
                "{file}:{}: {what} (in {} {})",
                self.first_line,
                self.count,
                if self.count == 1 { "place" } else { "places" }
            ));
        }
    }
}

struct Reader<'a> {
    file: &'a str,
    line: u64,
    positions: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    /// The last vertex made for each position.
    heads: Vec<u32>,
    vertices: Vec<Vertex>,
    mesh: Mesh,
    material: u32,
    material_numbers: std::collections::HashMap<String, u32>,
    materials: Vec<(String, u64)>,
    libraries: Vec<(String, u64)>,
    /// `None` is `s off`. A file that never says `s` is smooth everywhere.
    group: Option<u32>,
    polygon_count: u32,
    corners: Vec<Corner>,
    points: Vec<[f32; 3]>,
    triangles: Vec<[usize; 3]>,
    non_finite: Tally,
    small_faces: Tally,
    bad_uvs: Tally,
    bad_normals: Tally,
    free_form: Tally,
}

/// Reads the bytes of an OBJ file; `file` is its name in messages.
pub(crate) fn parse(bytes: &[u8], file: &str, name: &str) -> Result<Obj> {
    let mut reader = Reader {
        file,
        line: 0,
        positions: Vec::new(),
        uvs: Vec::new(),
        normals: Vec::new(),
        heads: Vec::new(),
        vertices: Vec::new(),
        mesh: Mesh { name: name.to_owned(), ..Mesh::default() },
        material: 0,
        material_numbers: std::collections::HashMap::new(),
        materials: Vec::new(),
        libraries: Vec::new(),
        group: Some(1),
        polygon_count: 0,
        corners: Vec::new(),
        points: Vec::new(),
        triangles: Vec::new(),
        non_finite: Tally::default(),
        small_faces: Tally::default(),
        bad_uvs: Tally::default(),
        bad_normals: Tally::default(),
        free_form: Tally::default(),
    };
    if bytes.iter().take(1024).any(|&byte| byte == 0) {
        reader.line = 1;
        return Err(reader.error("this is not an OBJ text file (it holds zero bytes); save it as OBJ in UTF-8".to_owned()));
    }
    for line in Lines::new(bytes) {
        match line {
            Ok((number, line)) => {
                reader.line = number;
                reader.read_line(&line)?;
            }
            Err(LineTooLong(number)) => {
                reader.line = number;
                return Err(reader.error(format!("the line is longer than {MAX_LINE_BYTES} bytes; is this an OBJ file?")));
            }
        }
    }
    reader.finish()
}

impl Reader<'_> {
    fn error(&self, message: String) -> Error {
        Error::Obj { file: self.file.to_owned(), line: self.line, message }
    }

    fn read_line(&mut self, line: &[u8]) -> Result<()> {
        let (keyword, rest) = word(line);
        match keyword {
            b"v" => {
                let position = self.numbers::<3>(rest, 3, "v needs three numbers: v x y z")?;
                if !position.iter().all(|value| value.is_finite()) {
                    self.non_finite.add(self.line);
                }
                self.positions.push(position);
                self.heads.push(NONE);
                if self.positions.len() >= NONE as usize {
                    return Err(self.error(format!("more than {} vertices; split the file", NONE - 1)));
                }
            }
            b"vt" => {
                let uv = self.numbers::<2>(rest, 1, "vt needs one or two numbers: vt u v")?;
                self.uvs.push(uv.map(|value| if value.is_finite() { value } else { 0.0 }));
            }
            b"vn" => {
                let normal = self.numbers::<3>(rest, 3, "vn needs three numbers: vn x y z")?;
                self.normals.push(normal);
            }
            b"f" | b"fo" => self.read_face(rest)?,
            b"usemtl" => self.use_material(rest),
            b"mtllib" if !rest.is_empty() => self.libraries.push((String::from_utf8_lossy(rest).into_owned(), self.line)),
            b"s" => {
                // Anything but a number above zero ("off", "0", "null") ends smoothing.
                self.group = std::str::from_utf8(rest).ok().and_then(|text| text.trim().parse().ok()).filter(|&group: &u32| group > 0);
            }
            b"curv" | b"curv2" | b"surf" | b"bzp" | b"bsp" | b"cdc" | b"cdp" | b"res" => self.free_form.add(self.line),
            _ => {}
        }
        Ok(())
    }

    /// The first `N` numbers of a line; those after the first `least` may be absent and are zero.
    fn numbers<const N: usize>(&self, line: &[u8], least: usize, usage: &str) -> Result<[f32; N]> {
        let mut values = [0.0; N];
        let mut words = words(line);
        for (at, value) in values.iter_mut().enumerate() {
            match words.next() {
                Some(word) => *value = number(word).ok_or_else(|| self.error(format!("\"{}\" is not a number; {usage}", shown(word))))?,
                None if at < least => return Err(self.error(usage.to_owned())),
                None => {}
            }
        }
        Ok(values)
    }

    fn use_material(&mut self, name: &[u8]) {
        let name = String::from_utf8_lossy(name).into_owned();
        self.material = match self.material_numbers.get(&name) {
            _ if name.is_empty() => 0,
            Some(&number) => number,
            None => {
                self.materials.push((name.clone(), self.line));
                // A name takes at least nine bytes of a file, and files are held in memory: far below 2^32 names.
                let number = u32::try_from(self.materials.len()).unwrap_or(0);
                self.material_numbers.insert(name, number);
                number
            }
        };
    }

    fn read_face(&mut self, line: &[u8]) -> Result<()> {
        self.corners.clear();
        for word in words(line) {
            if self.corners.len() == MAX_CORNERS {
                return Err(self.error(format!("a face of more than {MAX_CORNERS} corners; cut it into smaller ones")));
            }
            let corner = self.read_corner(word)?;
            self.corners.push(corner);
        }
        if self.corners.len() < 3 {
            self.small_faces.add(self.line);
            return Ok(());
        }
        self.points.clear();
        self.points.extend(self.corners.iter().map(|corner| self.positions.get(corner.position as usize).copied().unwrap_or_default()));
        triangulate(&self.points, &mut self.triangles);
        let triangle_count = self.mesh.indices.len() + self.triangles.len();
        if triangle_count >= NONE as usize {
            return Err(self.error(format!("more than {} triangles; split the file", NONE - 1)));
        }

        let polygon = self.polygon_count;
        self.polygon_count += 1;
        let mut vertices = [0; 4];
        let mut more = Vec::new();
        let count = self.corners.len();
        let slots = if count <= vertices.len() {
            &mut vertices[..count]
        } else {
            more.resize(count, 0);
            &mut more[..]
        };
        for (at, slot) in slots.iter_mut().enumerate() {
            *slot = self.vertex(self.corners[at], polygon)?;
        }
        for triangle in &self.triangles {
            self.mesh.indices.push(triangle.map(|at| slots[at]));
            self.mesh.materials.push(self.material);
        }
        Ok(())
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn read_corner(&mut self, word: &[u8]) -> Result<Corner> {
        let mut parts = word.split(|&byte| byte == b'/');
        let position = match self.index(parts.next().unwrap_or_default(), word, self.positions.len())? {
            Some(Index::Valid(position)) => position,
            Some(Index::OutOfRange(index)) => {
                let count = self.positions.len();
                return Err(self.error(format!(
                    "vertex {index} in \"{}\" does not exist: {} so far, counted from 1, or from -1 backwards",
                    shown(word),
                    if count == 1 { "1 vertex".to_owned() } else { format!("{count} vertices") }
                )));
            }
            None => return Err(self.error(format!("\"{}\" has no vertex number; write v, v/vt, v//vn or v/vt/vn", shown(word)))),
        };
        let uv = match self.index(parts.next().unwrap_or_default(), word, self.uvs.len())? {
            Some(Index::Valid(uv)) => uv,
            Some(Index::OutOfRange(_)) => {
                self.bad_uvs.add(self.line);
                NONE
            }
            None => NONE,
        };
        let normal = match self.index(parts.next().unwrap_or_default(), word, self.normals.len())? {
            Some(Index::Valid(normal)) => normal,
            Some(Index::OutOfRange(_)) => {
                self.bad_normals.add(self.line);
                NONE
            }
            None => NONE,
        };
        if parts.next().is_some() {
            return Err(self.error(format!("\"{}\" has too many parts; write v, v/vt, v//vn or v/vt/vn", shown(word))));
        }
        Ok(Corner { position, uv, normal })
    }

    fn index(&self, part: &[u8], word: &[u8], count: usize) -> Result<Option<Index>> {
        if part.is_empty() {
            return Ok(None);
        }
        let index: i64 = std::str::from_utf8(part)
            .ok()
            .and_then(|text| text.parse().ok())
            .ok_or_else(|| self.error(format!("\"{}\" is not a vertex; write v, v/vt, v//vn or v/vt/vn in whole numbers", shown(word))))?;
        let place = if index > 0 { index - 1 } else { (count as i64).saturating_add(index) };
        let valid = index != 0 && place >= 0 && (place as u64) < (count as u64).min(u64::from(NONE));
        Ok(Some(if valid { Index::Valid(place as u32) } else { Index::OutOfRange(index) }))
    }

    /// The vertex of the mesh for a corner, made if there is none yet.
    fn vertex(&mut self, corner: Corner, polygon: u32) -> Result<u32> {
        let usable = |normal: &&[f32; 3]| {
            let square: f64 = normal.iter().map(|&value| f64::from(value) * f64::from(value)).sum();
            square.is_finite() && square > 0.0
        };
        let normal = match (self.normals.get(corner.normal as usize).filter(usable), self.group) {
            (Some(_), _) => NormalSource::File(corner.normal),
            (None, Some(group)) => NormalSource::Group(group),
            (None, None) => NormalSource::Polygon(polygon),
        };
        let head = self.heads[corner.position as usize];
        let mut at = head;
        for _ in 0..MAX_SEARCH {
            let Some(vertex) = self.vertices.get(at as usize) else { break };
            if vertex.uv == corner.uv && vertex.normal == normal {
                return Ok(at);
            }
            at = vertex.next;
        }
        let number = self.vertices.len();
        if number >= NONE as usize {
            return Err(self.error(format!("more than {} vertices; split the file", NONE - 1)));
        }
        let number = number as u32;
        self.vertices.push(Vertex { uv: corner.uv, normal, next: head });
        self.heads[corner.position as usize] = number;
        self.mesh.positions.push(self.positions[corner.position as usize]);
        self.mesh.uvs.push(self.uvs.get(corner.uv as usize).copied().unwrap_or_default());
        Ok(number)
    }

    fn finish(mut self) -> Result<Obj> {
        let positions_of = self.sort_vertices();
        let smooth: Vec<Smooth> = self
            .vertices
            .iter()
            .zip(&positions_of)
            .map(|(vertex, &position)| match vertex.normal {
                NormalSource::File(normal) => Smooth::Given(self.normals.get(normal as usize).copied().unwrap_or_default()),
                NormalSource::Group(group) => Smooth::Shared { place: position, group },
                NormalSource::Polygon(polygon) => Smooth::Shared { place: polygon, group: 0 },
            })
            .collect();
        compute_normals(&mut self.mesh, &smooth);

        let mut warnings = Vec::new();
        let file = self.file;
        self.non_finite.warn(&mut warnings, file, "a vertex is not finite; triangles at it are dropped");
        self.small_faces.warn(&mut warnings, file, "a face of fewer than 3 corners is skipped");
        self.bad_uvs.warn(&mut warnings, file, "a texture coordinate that does not exist counts as none");
        self.bad_normals.warn(&mut warnings, file, "a normal that does not exist is computed instead");
        self.free_form.warn(&mut warnings, file, "free-form curves and surfaces are not read; export polygons");
        if self.mesh.indices.is_empty() {
            warnings.push(format!("{file}: holds no faces"));
        }
        Ok(Obj { mesh: self.mesh, materials: self.materials, libraries: self.libraries, warnings })
    }
}

impl Reader<'_> {
    /// Brings the vertices into the order of their positions in the file; those of one position stay in the order in which faces came to
    /// them. So key-frames have the same indices only where their faces name the same positions, not wherever they look alike. Returns the
    /// position of each.
    fn sort_vertices(&mut self) -> Vec<u32> {
        let count = self.vertices.len();
        let (mut order, mut positions_of) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for (position, &head) in self.heads.iter().enumerate() {
            let begin = order.len();
            let mut at = head;
            while let Some(vertex) = self.vertices.get(at as usize) {
                order.push(at);
                positions_of.push(position as u32);
                at = vertex.next;
            }
            // The chain begins at the last one made.
            order[begin..].reverse();
        }
        let mut numbers = vec![0_u32; count];
        for (new, &old) in order.iter().enumerate() {
            numbers[old as usize] = new as u32;
        }
        self.mesh.positions = order.iter().map(|&old| self.mesh.positions[old as usize]).collect();
        self.mesh.uvs = order.iter().map(|&old| self.mesh.uvs[old as usize]).collect();
        self.vertices = order.iter().map(|&old| self.vertices[old as usize]).collect();
        for index in self.mesh.indices.as_flattened_mut() {
            *index = numbers[*index as usize];
        }
        positions_of
    }
}

enum Index {
    Valid(u32),
    OutOfRange(i64),
}
