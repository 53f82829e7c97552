//! `cast`: NumPy in, NumPy out, with known answers.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;

use super::{folder, gridwalk, with_input, words};

/// An NPY file as numpy.save writes it.
pub fn npy<const N: usize>(rows: &[[f32; N]]) -> Vec<u8> {
    with_header(&format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, {N}), }}", rows.len()), rows.as_flattened())
}

fn with_header(header: &str, values: &[f32]) -> Vec<u8> {
    let header = format!("{header:<117}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    bytes
}

/// Arrays of an NPZ: type, shape and bytes by name.
fn arrays(bytes: Vec<u8>) -> BTreeMap<String, (String, String, Vec<u8>)> {
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(bytes)).unwrap();
    let quoted = |header: &str, from: &str, to: char| {
        let start = header.find(from).unwrap() + from.len();
        header[start..].split(to).next().unwrap().to_owned()
    };
    (0..archive.len())
        .map(|index| {
            let mut file = archive.by_index(index).unwrap();
            let name = file.name().unwrap().strip_suffix(".npy").unwrap().to_owned();
            let mut bytes = Vec::new();
            file.read_to_end(&mut bytes).unwrap();
            assert_eq!(bytes[..8], *b"\x93NUMPY\x01\x00");
            let length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
            assert_eq!((10 + length) % 64, 0);
            let header = String::from_utf8(bytes[10..10 + length].to_vec()).unwrap();
            (name, (quoted(&header, "'descr': '", '\''), quoted(&header, "'shape': ", ')'), bytes[10 + length..].to_vec()))
        })
        .collect()
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}

fn uints(bytes: &[u8]) -> Vec<u32> {
    bytes.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect()
}

/// Straight down on the first triangle, past it on the second, past both, from below, and along the plane.
const RAYS: [[f32; 6]; 5] = [
    [0.25, 0.5, 2.0, 0.0, 0.0, -1.0],
    [0.8, 0.8, 2.0, 0.0, 0.0, -2.0],
    [3.0, 3.0, 2.0, 0.0, 0.0, -1.0],
    [0.25, 0.5, -3.0, 0.0, 0.0, 1.0],
    [0.25, 0.5, 2.0, 1.0, 0.0, 0.0],
];

fn cast(folder: &Path, line: &str) -> BTreeMap<String, (String, String, Vec<u8>)> {
    gridwalk(folder, words(line)).expect(0);
    arrays(std::fs::read(folder.join("h.npz")).unwrap())
}

#[test]
fn known_answers() {
    let folder = folder();
    std::fs::write(folder.path().join("r.npy"), npy(&RAYS)).unwrap();
    for options in ["", "--density 50", "--resolution 1", "--overlap exact", "--repeat 2"] {
        let hits = cast(folder.path(), &format!("cast two.obj --rays r.npy -o h.npz {options}"));
        let names: Vec<&str> = hits.keys().map(String::as_str).collect();
        assert_eq!(names, ["geometry_ids", "primitive_ids", "primitive_normals", "primitive_uvs", "t_hit"]);
        let array = |name: &str, descr: &str, shape: &str| {
            let (found, extents, bytes) = &hits[name];
            assert_eq!((found.as_str(), extents.as_str()), (descr, shape), "{name}");
            bytes.clone()
        };
        assert_eq!(floats(&array("t_hit", "<f4", "(5,")), [2.0, 1.5, f32::INFINITY, 2.0, f32::INFINITY]);
        assert_eq!(uints(&array("primitive_ids", "<u4", "(5,")), [0, 1, u32::MAX, 1, u32::MAX]);
        assert_eq!(uints(&array("geometry_ids", "<u4", "(5,")), [0, 0, u32::MAX, 0, u32::MAX]);
        let uvs = floats(&array("primitive_uvs", "<f4", "(5, 2"));
        for (found, expected) in uvs.iter().zip([0.25, 0.5, 0.4, 0.4, 0.0, 0.0, 0.125, 0.25, 0.0, 0.0]) {
            assert!((found - expected).abs() < 1e-6, "{uvs:?}");
        }
        let normals = floats(&array("primitive_normals", "<f4", "(5, 3"));
        assert_eq!(normals, [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    }
}

#[test]
fn intervals_are_obeyed() {
    let folder = folder();
    let down = |t_min, t_max| [0.25, 0.5, 2.0, 0.0, 0.0, -1.0, t_min, t_max];
    let rays = [down(0.0, f32::INFINITY), down(2.5, 10.0), down(0.0, 1.5), down(2.0, 2.0), down(3.5, 10.0)];
    std::fs::write(folder.path().join("r.npy"), npy(&rays)).unwrap();
    let hits = cast(folder.path(), "cast two.obj --rays r.npy -o h.npz");
    assert_eq!(floats(&hits["t_hit"].2), [2.0, 3.0, f32::INFINITY, 2.0, f32::INFINITY]);
    let hits = cast(folder.path(), "cast two.obj --rays r.npy -o h.npz --occlusion");
    assert_eq!(hits.keys().collect::<Vec<_>>(), ["occluded"]);
    assert_eq!(hits["occluded"], ("|b1".to_owned(), "(5,".to_owned(), vec![1, 1, 0, 1, 0]));
}

/// Triangles count within their geometry.
#[test]
fn several_geometries() {
    let folder = folder();
    std::fs::write(
        folder.path().join("scene.toml"),
        "[[mesh]]\nfile = \"two.obj\"\n[[mesh]]\nfile = \"two.obj\"\ntranslate = [10, 0, 0]\n",
    )
    .unwrap();
    std::fs::write(folder.path().join("r.npy"), npy(&[[10.8, 0.8, 2.0, 0.0, 0.0, -1.0], [0.1, 0.1, 2.0, 0.0, 0.0, -1.0]])).unwrap();
    let hits = cast(folder.path(), "cast scene.toml --rays r.npy -o h.npz");
    assert_eq!(uints(&hits["geometry_ids"].2), [1, 0]);
    assert_eq!(uints(&hits["primitive_ids"].2), [1, 0]);
}

#[test]
fn pipes_and_empty_files() {
    let folder = folder();
    let run = with_input(folder.path(), words("cast two.obj --rays - -o - -q"), &npy(&RAYS)).expect(0);
    assert_eq!(floats(&arrays(run.stdout)["t_hit"].2).len(), 5);
    std::fs::write(folder.path().join("r.npy"), npy::<6>(&[])).unwrap();
    let hits = cast(folder.path(), "cast two.obj --rays r.npy -o h.npz");
    assert_eq!((hits["t_hit"].1.as_str(), hits["primitive_uvs"].1.as_str()), ("(0,", "(0, 2"));
}

#[test]
fn the_same_rays_give_the_same_bytes() {
    let folder = folder();
    std::fs::write(folder.path().join("r.npy"), npy(&RAYS)).unwrap();
    gridwalk(folder.path(), words("cast two.obj --rays r.npy -o a.npz")).expect(0);
    gridwalk(folder.path(), words("cast two.obj --rays r.npy -o b.npz")).expect(0);
    assert_eq!(std::fs::read(folder.path().join("a.npz")).unwrap(), std::fs::read(folder.path().join("b.npz")).unwrap());
}

#[test]
fn wrong_arrays_are_refused() {
    let folder = folder();
    let header = |descr: &str, shape: &str| format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}");
    for (bytes, said) in [
        (npy(&[[0.0_f32; 7]]), &["[1, 7]", "(N, 6)", "(N, 8)"][..]),
        (with_header(&header("<f4", "(6,)"), &[0.0; 6]), &["[6]"]),
        (with_header(&header("<f4", "(1, 2, 3)"), &[0.0; 6]), &["[1, 2, 3]"]),
        (with_header(&header("<f8", "(1, 6)"), &[0.0; 12]), &["float32", "astype"]),
        (with_header(&header("<i4", "(1, 6)"), &[0.0; 6]), &["<i4"]),
        (with_header("{'descr': '<f4', 'fortran_order': True, 'shape': (1, 6), }", &[0.0; 6]), &["ascontiguousarray"]),
        (with_header(&header("<f4", "(2, 6)"), &[0.0; 6]), &["too early"]),
        (with_header(&header("<f4", "(999999999999, 6)"), &[0.0; 6]), &["--max-size"]),
        (b"\x93NUMPY".to_vec(), &["too early"]),
        (Vec::new(), &["too early"]),
    ] {
        std::fs::write(folder.path().join("r.npy"), bytes).unwrap();
        let mut words_said = vec!["r.npy"];
        words_said.extend(said);
        gridwalk(folder.path(), words("cast two.obj --rays r.npy -o h.npz")).fails(3, &words_said);
    }
    std::fs::write(folder.path().join("r.npy"), npy(&RAYS)).unwrap();
    gridwalk(folder.path(), words("cast two.obj --rays r.npi -o h.npz")).fails(3, &["did you mean", "r.npy"]);
    gridwalk(folder.path(), words("cast two.obj --rays r.npy -o none/h.npz")).fails(7, &["none/h.npz"]);
    assert_eq!(super::entries(folder.path()), ["r.npy", "two.obj"]);
}

/// NaN rays miss; the scene without triangles has no hit.
#[test]
fn odd_rays_and_scenes() {
    let folder = folder();
    let nan = f32::NAN;
    let rays = [[nan, 0.5, 2.0, 0.0, 0.0, -1.0], [0.25, 0.5, 2.0, 0.0, nan, -1.0], [0.25, 0.5, 2.0, -0.0, 0.0, -1.0]];
    std::fs::write(folder.path().join("r.npy"), npy(&rays)).unwrap();
    let hits = cast(folder.path(), "cast two.obj --rays r.npy -o h.npz");
    assert_eq!(floats(&hits["t_hit"].2), [f32::INFINITY, f32::INFINITY, 2.0]);
    std::fs::write(folder.path().join("empty.obj"), "v 0 0 0\n").unwrap();
    let hits = cast(folder.path(), "cast empty.obj --rays r.npy -o h.npz");
    assert_eq!(uints(&hits["primitive_ids"].2), [u32::MAX; 3]);
}
