//! PLY files of every kind against each other, against OBJ, and against another reader; broken ones with exactly what is said about them.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use gridwalk_scene::generate::Random;
use gridwalk_scene::{Error, LoadOptions, Mesh, Scene, load, load_reader};
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};

use super::{folder, png, without_folder};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Format {
    Ascii,
    Little,
    Big,
}

/// What a file shall hold.
#[derive(Clone, Debug)]
pub(super) struct Model {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    colours: Vec<[u8; 3]>,
    faces: Vec<Vec<u32>>,
}

const TYPES: [&str; 8] = ["char", "uchar", "short", "ushort", "int", "uint", "float", "double"];

/// Values go through here on their way into a file.
struct Sink {
    format: Format,
    bytes: Vec<u8>,
}

impl Sink {
    fn value(&mut self, kind: &str, value: f64) {
        macro_rules! put {
            ($type:ty) => {{
                let value = value as $type;
                match self.format {
                    Format::Ascii => write!(self.bytes, "{value} ").unwrap(),
                    Format::Little => self.bytes.extend(value.to_le_bytes()),
                    Format::Big => self.bytes.extend(value.to_be_bytes()),
                }
            }};
        }
        match kind {
            "char" | "int8" => put!(i8),
            "uchar" | "uint8" => put!(u8),
            "short" | "int16" => put!(i16),
            "ushort" | "uint16" => put!(u16),
            "int" | "int32" => put!(i32),
            "uint" | "uint32" => put!(u32),
            "float" | "float32" => put!(f32),
            "double" | "float64" => put!(f64),
            _ => panic!("no type {kind}"),
        }
    }

    fn end_row(&mut self, ending: &str) {
        if self.format == Format::Ascii {
            self.bytes.extend(ending.as_bytes());
        }
    }
}

fn modern(kind: &str) -> &'static str {
    let at = TYPES.iter().position(|name| *name == kind).unwrap();
    ["int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"][at]
}

/// The file, with types, order, spelling and additions drawn by chance; no additions with `plain`.
pub(super) fn write(model: &Model, format: Format, plain: bool, random: &mut Random) -> Vec<u8> {
    let ending = ["\n", "\r\n", "\r"][if plain { 0 } else { random.below(3) as usize }];
    let spelled = |kind: &'static str, random: &mut Random| if random.below(2) == 0 { kind } else { modern(kind) };
    let real = |random: &mut Random| if random.below(2) == 0 { "float" } else { "double" };
    let whole = |count: usize, random: &mut Random| loop {
        let kind = TYPES[random.below(6) as usize];
        let most = [127, 255, 32_767, 65_535, usize::MAX, usize::MAX][TYPES.iter().position(|name| *name == kind).unwrap()];
        if count <= most {
            return kind;
        }
    };
    // Name, type, and the column, or none for what is to be skipped.
    let mut properties: Vec<(&str, &str, Option<usize>)> =
        ["x", "y", "z"].iter().enumerate().map(|(column, name)| (*name, real(random), Some(column))).collect();
    if !model.normals.is_empty() {
        properties.extend(["nx", "ny", "nz"].iter().enumerate().map(|(column, name)| (*name, real(random), Some(3 + column))));
    }
    if !model.uvs.is_empty() {
        let names = [["s", "t"], ["u", "v"], ["texture_u", "texture_v"]][random.below(3) as usize];
        properties.extend(names.iter().enumerate().map(|(column, name)| (*name, real(random), Some(6 + column))));
    }
    if !model.colours.is_empty() {
        properties.extend(["red", "green", "blue"].iter().enumerate().map(|(column, name)| (*name, "uchar", Some(8 + column))));
    }
    if !plain {
        for name in ["quality", "alpha", "radius"].iter().take(random.below(4) as usize) {
            properties.push((name, TYPES[random.below(8) as usize], None));
        }
        for at in (1..properties.len()).rev() {
            properties.swap(at, random.below(at as u64 + 1) as usize);
        }
    }
    let strange_first = !plain && random.below(2) == 0;
    let strange_last = !plain && random.below(2) == 0;
    let strange = |name: &str| format!("element {name} 2{ending}property list uchar double a{ending}property short b{ending}");
    let (length, index) = (whole(model.faces.iter().map(Vec::len).max().unwrap_or(0), random), whole(model.positions.len(), random));
    let mut header = String::new();
    let kind = ["ascii", "binary_little_endian", "binary_big_endian"][format as usize];
    write!(header, "ply{ending}format {kind} 1.0{ending}comment made by chance{ending}").unwrap();
    if strange_first {
        header += &strange("before");
    }
    write!(header, "element vertex {}{ending}", model.positions.len()).unwrap();
    for (name, kind, _) in &properties {
        write!(header, "property {} {name}{ending}", spelled(TYPES.iter().find(|known| *known == kind).unwrap(), random)).unwrap();
    }
    let extra = !plain && random.below(2) == 0;
    write!(header, "element face {}{ending}", model.faces.len()).unwrap();
    if extra {
        write!(header, "property uchar flags{ending}property list ushort float weights{ending}").unwrap();
    }
    write!(header, "property list {length} {index} vertex_ind{}{ending}", ["ices", "ex"][random.below(2) as usize]).unwrap();
    if strange_last {
        header += &strange("after");
    }
    write!(header, "end_header{ending}").unwrap();

    let mut sink = Sink { format, bytes: header.into_bytes() };
    let strange = |sink: &mut Sink| {
        for count in [3, 0] {
            sink.value("uchar", f64::from(count));
            for at in 0..count {
                sink.value("double", f64::from(at) * 0.5);
            }
            sink.value("short", -7.0);
            sink.end_row(ending);
        }
    };
    if strange_first {
        strange(&mut sink);
    }
    for vertex in 0..model.positions.len() {
        for (_, kind, column) in &properties {
            let value = match column {
                Some(column @ 0..3) => f64::from(model.positions[vertex][*column]),
                Some(column @ 3..6) => f64::from(model.normals[vertex][*column - 3]),
                Some(column @ 6..8) => f64::from(model.uvs[vertex][*column - 6]),
                Some(column) => f64::from(model.colours[vertex][*column - 8]),
                None => random.below(100) as f64,
            };
            sink.value(kind, value);
        }
        sink.end_row(ending);
    }
    for face in &model.faces {
        if extra {
            sink.value("uchar", 200.0);
            sink.value("ushort", 2.0);
            sink.value("float", 0.25);
            sink.value("float", -1e30);
        }
        sink.value(length, face.len() as f64);
        face.iter().for_each(|&corner| sink.value(index, f64::from(corner)));
        sink.end_row(ending);
    }
    if strange_last {
        strange(&mut sink);
    }
    sink.bytes
}

pub(super) fn model(random: &mut Random) -> Model {
    let count = 3 + random.below(40) as usize;
    let mut point = |low: f32, high: f32| -> [f32; 3] { std::array::from_fn(|_| random.range(low, high)) };
    let positions: Vec<[f32; 3]> = (0..count).map(|_| point(-3.0, 3.0)).collect();
    let normals = (0..count).map(|_| point(0.1, 1.0)).collect();
    let uvs = (0..count).map(|_| std::array::from_fn(|_| random.range(-1.0, 2.0))).collect();
    let colours = (0..count).map(|_| std::array::from_fn(|_| random.below(256) as u8)).collect();
    let faces = (0..random.below(30)).map(|_| (0..3 + random.below(5)).map(|_| random.below(count as u64) as u32).collect()).collect();
    let mut model = Model { positions, normals, uvs, colours, faces };
    for kept in [&mut model.normals, &mut Vec::new()].into_iter().take(1) {
        if random.below(2) == 0 {
            kept.clear();
        }
    }
    if random.below(2) == 0 {
        model.uvs.clear();
    }
    if random.below(2) == 0 {
        model.colours.clear();
    }
    model
}

fn read(bytes: &[u8]) -> Result<Scene, Error> {
    load_reader(&mut &*bytes, None, &LoadOptions::default())
}

fn zipped(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn every_kind_of_file_gives_the_same_mesh() {
    for seed in 0..300 {
        let random = &mut Random::new(seed);
        let model = model(random);
        let plain = read(&write(&model, Format::Ascii, true, random)).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
        let mesh = &plain.meshes[0];
        assert_eq!(mesh.positions, model.positions, "seed {seed}");
        assert_eq!(mesh.colours.len(), model.colours.len(), "seed {seed}");
        for format in [Format::Ascii, Format::Little, Format::Big] {
            let bytes = write(&model, format, false, random);
            for (bytes, packed) in [(zipped(&bytes), true), (bytes, false)] {
                let found = read(&bytes).unwrap_or_else(|error| panic!("seed {seed}, {format:?}: {error}"));
                assert!(found.meshes[0] == *mesh && found.materials == plain.materials, "seed {seed}, {format:?}, packed: {packed}");
                assert_eq!(found.warnings.len(), plain.warnings.len(), "seed {seed}, {format:?}: {:?}", found.warnings);
            }
        }
        // Negative control: one bit of one position.
        let mut other = model.clone();
        other.positions[0][0] = f32::from_bits(other.positions[0][0].to_bits() ^ 1);
        assert_ne!(read(&write(&other, Format::Big, true, random)).unwrap().meshes[0], *mesh, "seed {seed}");
    }
}

/// The triangles by their corners, which do not depend on how the vertices are numbered.
fn corners(mesh: &Mesh) -> Vec<([f32; 3], [f32; 2], [f32; 3])> {
    let at = |corner: &u32| *corner as usize;
    mesh.indices.as_flattened().iter().map(at).map(|at| (mesh.positions[at], mesh.uvs[at], mesh.normals[at])).collect()
}

#[test]
fn the_same_mesh_as_obj_is_the_same() {
    for seed in 0..200 {
        let random = &mut Random::new(seed);
        let model = model(random);
        let mut obj = String::new();
        for [x, y, z] in &model.positions {
            writeln!(obj, "v {x} {y} {z}").unwrap();
        }
        for [x, y, z] in &model.normals {
            writeln!(obj, "vn {x} {y} {z}").unwrap();
        }
        for [u, v] in &model.uvs {
            writeln!(obj, "vt {u} {v}").unwrap();
        }
        for face in &model.faces {
            obj += "f";
            for corner in face {
                let number = corner + 1;
                let uv = if model.uvs.is_empty() { String::new() } else { number.to_string() };
                let normal = if model.normals.is_empty() { String::new() } else { format!("/{number}") };
                write!(obj, " {number}/{uv}{normal}").unwrap();
            }
            obj += "\n";
        }
        let (obj, ply) = (read(obj.as_bytes()).unwrap(), read(&write(&model, Format::Little, false, random)).unwrap());
        assert_eq!(corners(&obj.meshes[0]), corners(&ply.meshes[0]), "seed {seed}");
    }
}

#[test]
fn another_reader_finds_the_same() {
    for seed in 0..200 {
        let random = &mut Random::new(seed);
        let mut model = model(random);
        model.faces.iter_mut().for_each(|face| face.truncate(3));
        let format = [Format::Ascii, Format::Little, Format::Big][random.below(3) as usize];
        let bytes = write(&model, format, true, random);
        let theirs = Parser::<DefaultElement>::new().read_ply(&mut &*bytes).unwrap();
        let number = |property: &Property| match *property {
            Property::Float(value) => value,
            Property::Double(value) => value as f32,
            Property::UChar(value) => f32::from(value),
            ref other => panic!("{other:?}"),
        };
        let ours = &read(&bytes).unwrap().meshes[0];
        for (at, vertex) in theirs.payload["vertex"].iter().enumerate() {
            assert_eq!(ours.positions[at], ["x", "y", "z"].map(|name| number(&vertex[name])), "seed {seed}");
        }
        for (at, face) in theirs.payload["face"].iter().enumerate() {
            let corners: Vec<u32> = match face.values().next().unwrap() {
                Property::ListChar(list) => list.iter().map(|&corner| corner as u32).collect(),
                Property::ListUChar(list) => list.iter().map(|&corner| corner.into()).collect(),
                Property::ListShort(list) => list.iter().map(|&corner| corner as u32).collect(),
                Property::ListUShort(list) => list.iter().map(|&corner| corner.into()).collect(),
                Property::ListInt(list) => list.iter().map(|&corner| corner as u32).collect(),
                Property::ListUInt(list) => list.clone(),
                other => panic!("{other:?}"),
            };
            assert_eq!(ours.indices[at].to_vec(), corners, "seed {seed}");
        }
    }
}

#[test]
fn colours_become_linear_and_their_material_white() {
    let file = |kind: &str, values: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty {kind} red\n\
             property {kind} green\nproperty {kind} blue\nend_header\n0 0 0 {values}\n"
        )
    };
    for (kind, values, expected) in [
        ("uchar", "0 255 128", [0.0, 1.0, 0.215_860_5]),
        ("ushort", "0 65535 32896", [0.0, 1.0, 0.215_860_5]),
        ("float", "0 1 0.5", [0.0, 1.0, 0.5]),
        ("double", "-1 7.5 nan", [0.0, 7.5, 1.0]),
    ] {
        let scene = read(file(kind, values).as_bytes()).unwrap();
        let [red, green, blue] = scene.meshes[0].colours[0];
        assert!(red == expected[0] && green == expected[1] && (blue - expected[2]).abs() < 1e-6, "{kind}: {:?}", scene.meshes[0].colours);
        assert_eq!((scene.materials.len(), scene.materials[1].diffuse), (2, [1.0; 3]));
    }
}

#[test]
fn strips_corner_coordinates_and_the_picture_of_a_header() {
    let strips = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\n\
                  property list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n9 0 1 2 3 -1 2 3 4 -1\n";
    let mesh = &read(strips.as_bytes()).unwrap().meshes[0];
    assert_eq!(mesh.indices, [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
    assert!(mesh.normals.iter().all(|normal| *normal == [0.0, 0.0, 1.0]));

    let corners = "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                   element face 2\nproperty list uchar int vertex_index\nproperty list uchar float texcoord\nend_header\n\
                   0 0 0\n1 0 0\n1 1 0\n0 1 1\n3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 0.5 0 1 1 0 1\n";
    let folder = folder(&[("a.ply", corners.as_bytes()), ("a.png", &png(png::ColorType::Rgb, &[9, 8, 7]))]);
    let scene = load(&folder.path().join("a.ply"), &LoadOptions::default()).unwrap();
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.indices, [[0, 1, 2], [4, 2, 3]]);
    assert_eq!(mesh.uvs, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.0]]);
    assert_eq!(mesh.positions[4], mesh.positions[0]);
    assert_eq!(mesh.normals[4], mesh.normals[0], "the seam of the texture is none of the surface");
    assert_eq!((scene.textures.len(), scene.materials[1].diffuse_map, mesh.materials[0]), (1, Some(0), 1));
    std::fs::remove_file(folder.path().join("a.png")).unwrap();
    let scene = load(&folder.path().join("a.ply"), &LoadOptions::default()).unwrap();
    assert_eq!(without_folder(&scene.warnings[0], folder.path()), "DIR/a.ply:3: no texture: a.png does not exist");
}

const HEAD: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
                    property list uchar int vertex_indices\nend_header\n";

#[test]
fn broken_files_are_told_with_their_place() {
    let with = |body: &str| format!("{HEAD}{body}").into_bytes();
    let header = |lines: &str| format!("ply\n{lines}\nend_header\n").into_bytes();
    let xyz = "property float x\nproperty float y\nproperty float z\n";
    let binary = |body: &[u8]| {
        let mut bytes = HEAD.replace("ascii", "binary_little_endian").into_bytes();
        bytes.extend([0; 36]);
        bytes.extend(body);
        bytes
    };
    let cases: Vec<(Vec<u8>, &str)> = vec![
        (b"off\n".to_vec(), "DIR/a.ply:1: this is not a PLY file (its first line is not \"ply\")"),
        (b"ply\nformat ascii 1.0\n".to_vec(), "DIR/a.ply:3: the file ends within its header, before \"end_header\""),
        (header("format ascii 1.1"), "DIR/a.ply:2: version \"1.1\" of the format; only 1.0 can be read"),
        (header("format binary 1.0"), "DIR/a.ply:2: no format \"binary\"; there are ascii, binary_little_endian, binary_big_endian"),
        (header("comment"), "DIR/a.ply:3: the header has no format; write: format ascii 1.0"),
        (header("format ascii 1.0\nelement vertex -3"), "DIR/a.ply:3: \"element vertex -3\" is not understood; write: element name count"),
        (header("format ascii 1.0\nproperty float x"), "DIR/a.ply:3: a property stands before any element; move it below its element"),
        (
            header("format ascii 1.0\nelement vertex 3\nproperty quad x"),
            "DIR/a.ply:4: no type \"quad\"; there are char, uchar, short, ushort, int, uint, float, double, and int8 to float64",
        ),
        (
            header("format ascii 1.0\nelement face 3\nproperty list float int x"),
            "DIR/a.ply:4: the length of a list must be of a whole type, such as uchar",
        ),
        (
            header("format ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y"),
            "DIR/a.ply:6: a vertex needs the properties x, y and z",
        ),
        (header("format ascii 1.0\nelement vertex 1"), "DIR/a.ply:4: a vertex needs the properties x, y and z"),
        (
            header("format ascii 1.0\nvertices 7"),
            "DIR/a.ply:3: \"vertices\" has no meaning in a header; there are format, comment, obj_info, element, property",
        ),
        (
            header(&format!("format ascii 1.0\nelement vertex 1\n{xyz}element vertex 1")),
            "DIR/a.ply:7: element \"vertex\" is there twice; rename or remove one",
        ),
        (
            header(&format!("format ascii 1.0\nelement vertex 5000000000\n{xyz}")),
            "DIR/a.ply:8: 5000000000 vertices; at most 4294967294 are possible: split the file",
        ),
        (
            header(&format!("format binary_big_endian 1.0\nelement vertex 4000000000\n{xyz}")),
            "DIR/a.ply:byte 122: the header promises 4000000000 rows of element \"vertex\", but only 0 bytes follow; the file was cut off",
        ),
        (with("0 0 0\n1 0\n0 1 0\n3 0 1 2\n"), "DIR/a.ply:11: the vertex has too few values"),
        (with("0 0 0\n1 0 zero\n0 1 0\n3 0 1 2\n"), "DIR/a.ply:11: \"zero\" is not a number"),
        (with("0.00 0 0\n\n1.00 0 0\n0.00 1 0\n\n"), "DIR/a.ply:14: the file ends where a face should be"),
        (with("0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), "DIR/a.ply:13: there is no vertex 3; 3 are counted from 0"),
        (with("0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), "DIR/a.ply:13: there is no vertex -1; 3 are counted from 0"),
        (with("0 0 0\n1 0 0\n0 1 0\n3 0 1 1.5\n"), "DIR/a.ply:13: there is no vertex 1.5; 3 are counted from 0"),
        (with("0 0 0\n1 0 0\n0 1 0\n3 0 1\n"), "DIR/a.ply:13: the face has too few values"),
        (with("0 0 0\n1 0 0\n0 1 0\n4000000000 0 1\n"), "DIR/a.ply:13: a list of 4000000000 values goes beyond the end of the line"),
        (with("0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n"), "DIR/a.ply:13: a list of -3 values; the length must be a whole number, 0 or more"),
        (binary(&[3, 0, 0, 0, 0]), "DIR/a.ply:byte 206: a list of 3 values goes beyond the end of the file"),
        (binary(&[255]), "DIR/a.ply:byte 206: a list of 255 values goes beyond the end of the file"),
        (binary(&[]), "DIR/a.ply:byte 205: the file ends in the middle of a row"),
        (binary(&[3, 0, 0, 0, 0, 1, 0, 0, 0, 9, 0, 0, 0]), "DIR/a.ply:byte 218: there is no vertex 9; 3 are counted from 0"),
        (zipped(&with("0 0 0\n"))[..40].to_vec(), "cannot read DIR/a.ply: incomplete deflate stream"),
    ];
    let folder = folder(&[]);
    let path = folder.path().join("a.ply");
    for (bytes, expected) in cases {
        std::fs::write(&path, &bytes).unwrap();
        let found = load(&path, &LoadOptions::default()).map(|_| ()).unwrap_err();
        assert_eq!(without_folder(&found.to_string(), folder.path()), expected);
    }
    // Negative control: the body that all of them break.
    for bytes in [with("0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), binary(&[3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0])] {
        std::fs::write(&path, &bytes).unwrap();
        assert_eq!(load(&path, &LoadOptions::default()).unwrap().meshes[0].indices, [[0, 1, 2]]);
    }
}

#[test]
fn odd_files_are_read_with_a_warning() {
    for (body, triangles, expected) in [
        ("0 0 0\n1 0 0\n0 1 0\n2 0 1\n", 0, vec!["-: a face of fewer than 3 corners is skipped (in 1 place)", "-: holds no faces"]),
        (
            "0 0 0 9\n1 0 0\n0 1 0 9\n3 0 1 2\n",
            1,
            vec!["-: a row holds more values than the header tells; they are not read (in 2 places)"],
        ),
        ("0 0 inf\n1 0 nan\n0 1 0\n3 0 1 2\n", 1, vec!["-: a vertex is not finite; triangles at it are dropped (in 2 places)"]),
    ] {
        let scene = read(format!("{HEAD}{body}").as_bytes()).unwrap();
        assert_eq!(
            (scene.meshes[0].indices.len(), scene.warnings),
            (triangles, expected.into_iter().map(str::to_owned).collect::<Vec<_>>())
        );
    }
}

#[test]
fn what_is_packed_counts_unpacked() {
    // A kilobyte that holds a megabyte.
    let bomb = zipped(&[HEAD.as_bytes(), &vec![b' '; 1 << 20]].concat());
    let options = LoadOptions { max_mesh_bytes: 1 << 16, ..LoadOptions::default() };
    assert!(bomb.len() < 1 << 13);
    let error = load_reader(&mut &*bomb, None, &options).map(|_| ()).unwrap_err();
    assert!(matches!(error, Error::TooLarge { limit: 65_536, .. }), "{error}");
}

#[test]
fn a_name_says_what_a_file_is_only_where_its_content_does_not() {
    let ply = format!("{HEAD}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let folder = folder(&[
        ("a.ply", ply.as_bytes()),
        ("b.ply.gz", &zipped(ply.as_bytes())),
        ("c.ply", &zipped(ply.as_bytes())),
        ("d.obj.gz", &zipped(obj.as_bytes())),
        ("e.obj", ply.as_bytes()),
    ]);
    let mut expected: Option<Mesh> = None;
    for (file, name) in [("a.ply", "a"), ("b.ply.gz", "b"), ("c.ply", "c"), ("d.obj.gz", "d"), ("e.obj", "e")] {
        let mut mesh = load(&folder.path().join(file), &LoadOptions::default()).unwrap().meshes.remove(0);
        assert_eq!(std::mem::take(&mut mesh.name), name);
        assert_eq!(mesh, *expected.get_or_insert_with(|| mesh.clone()), "{file}");
    }
    let missing = load(Path::new("a.gz"), &LoadOptions::default()).map(|_| ()).unwrap_err();
    assert_eq!(missing.to_string(), "a.gz does not exist");
}
