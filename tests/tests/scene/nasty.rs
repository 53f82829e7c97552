//! A table of broken, hostile and merely odd files, each with exactly what must come of it.

use gridwalk_scene::{LoadOptions, load};

use super::{folder, png, tga, without_folder};

enum Expected {
    /// The whole message.
    Error(&'static str),
    /// Triangles, vertices, and every warning.
    Scene(usize, usize, &'static [&'static str]),
}
use Expected::{Error, Scene};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn obj(text: &str) -> Vec<u8> {
    text.as_bytes().to_vec()
}

fn with_material(mtl: &str) -> Vec<(&'static str, Vec<u8>)> {
    vec![("a.obj", obj(&format!("mtllib a.mtl\nusemtl m\n{TRIANGLE}"))), ("a.mtl", obj(mtl))]
}

fn described(text: &str) -> Vec<(&'static str, Vec<u8>)> {
    vec![("scene.toml", obj(text))]
}

type Case = (&'static str, Vec<(&'static str, Vec<u8>)>, Expected);

fn only(text: impl Into<Vec<u8>>) -> Vec<(&'static str, Vec<u8>)> {
    vec![("a.obj", text.into())]
}

fn obj_cases() -> Vec<Case> {
    let soup = |face: &str| only(format!("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n{face}\n"));
    let polygon = |corners: usize| {
        let mut text = String::new();
        for at in 0..corners {
            let (sine, cosine) = (std::f64::consts::TAU * at as f64 / corners as f64).sin_cos();
            text += &format!("v {cosine} {sine} 0\n");
        }
        text += "f";
        for at in 0..corners {
            text += &format!(" {}", at + 1);
        }
        only(text + "\n")
    };
    let mut groups = String::new();
    for group in 0..10_000 {
        groups += &format!("g group{group}\nusemtl\nv 0 0 {group}\nv 1 0 {group}\nv 0 1 {group}\nf -3 -2 -1\n");
    }
    vec![
        ("nothing", only(""), Scene(0, 0, &["DIR/a.obj: holds no faces"])),
        (
            "a picture",
            only(png(png::ColorType::Grayscale, &[0])),
            Error("DIR/a.obj:1: this is not an OBJ text file (it holds zero bytes); save it as OBJ in UTF-8"),
        ),
        (
            "UTF-16",
            only("v 0 0 0\n".encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<_>>()),
            Error("DIR/a.obj:1: this is not an OBJ text file (it holds zero bytes); save it as OBJ in UTF-8"),
        ),
        ("prose", only("Dear Sir or Madam,\nplease find enclosed\n"), Scene(0, 0, &["DIR/a.obj: holds no faces"])),
        (
            "index too great",
            soup("f 1 2 5"),
            Error("DIR/a.obj:7: vertex 5 in \"5\" does not exist: 4 vertices so far, counted from 1, or from -1 backwards"),
        ),
        (
            "index zero",
            soup("f 0 1 2"),
            Error("DIR/a.obj:7: vertex 0 in \"0\" does not exist: 4 vertices so far, counted from 1, or from -1 backwards"),
        ),
        (
            "index too far back",
            soup("f -1 -2 -5"),
            Error("DIR/a.obj:7: vertex -5 in \"-5\" does not exist: 4 vertices so far, counted from 1, or from -1 backwards"),
        ),
        (
            "least index",
            soup("f -9223372036854775808 1 2"),
            Error(
                "DIR/a.obj:7: vertex -9223372036854775808 in \"-9223372036854775808\" does not exist: 4 vertices so far, counted from 1, or from -1 backwards",
            ),
        ),
        (
            "index beyond 64 bits",
            soup("f 1 2 99999999999999999999"),
            Error("DIR/a.obj:7: \"99999999999999999999\" is not a vertex; write v, v/vt, v//vn or v/vt/vn in whole numbers"),
        ),
        (
            "index that is a fraction",
            soup("f 1 2 3.0"),
            Error("DIR/a.obj:7: \"3.0\" is not a vertex; write v, v/vt, v//vn or v/vt/vn in whole numbers"),
        ),
        (
            "four parts",
            soup("f 1/1/1/1 2/1/1 3/1/1"),
            Error("DIR/a.obj:7: \"1/1/1/1\" has too many parts; write v, v/vt, v//vn or v/vt/vn"),
        ),
        ("no vertex number", soup("f /1/1 2 3"), Error("DIR/a.obj:7: \"/1/1\" has no vertex number; write v, v/vt, v//vn or v/vt/vn")),
        (
            "face before any vertex",
            only("f 1 2 3\n"),
            Error("DIR/a.obj:1: vertex 1 in \"1\" does not exist: 0 vertices so far, counted from 1, or from -1 backwards"),
        ),
        ("a word as a number", only("v 0 zero 0\n"), Error("DIR/a.obj:1: \"zero\" is not a number; v needs three numbers: v x y z")),
        ("decimal commas", only("v 0,5 1 0\n"), Error("DIR/a.obj:1: \"0,5\" is not a number; v needs three numbers: v x y z")),
        ("two coordinates", only("v 0 1\n"), Error("DIR/a.obj:1: v needs three numbers: v x y z")),
        ("no texture coordinate", only("vt\n"), Error("DIR/a.obj:1: vt needs one or two numbers: vt u v")),
        ("a normal of words", only("vn up up up\n"), Error("DIR/a.obj:1: \"up\" is not a number; vn needs three numbers: vn x y z")),
        (
            "control characters in a message",
            only(b"v \x1b[31m 0 0\n".to_vec()),
            Error("DIR/a.obj:1: \"\u{fffd}[31m\" is not a number; v needs three numbers: v x y z"),
        ),
        (
            "all four index forms and negative ones",
            soup("f 1 2 3\nf 1/1 2/1 3/1\nf 1//1 2//1 3//1\nf 1/1/1 2/1/1 3/1/1\nf -4/-1/-1 -3/-1/-1 -2/-1/-1"),
            Scene(5, 12, &[]),
        ),
        (
            "points, lines and faces without corners",
            soup("f\nf 1\nf 1 2\np 1\nl 1 2 3\nf 1 2 3"),
            Scene(1, 3, &["DIR/a.obj:7: a face of fewer than 3 corners is skipped (in 3 places)"]),
        ),
        (
            "texture coordinates and normals that do not exist",
            soup("f 1/7/9 2/1/1 3/1/-4"),
            Scene(
                1,
                3,
                &[
                    "DIR/a.obj:7: a texture coordinate that does not exist counts as none (in 1 place)",
                    "DIR/a.obj:7: a normal that does not exist is computed instead (in 2 places)",
                ],
            ),
        ),
        (
            "not finite",
            only("v nan inf 1e400\nv 1 0 0\nv 0 -1.#IND 0\nv 0 0 1\nf 1 2 3\nf 2 4 3\n"),
            Scene(2, 4, &["DIR/a.obj:1: a vertex is not finite; triangles at it are dropped (in 2 places)"]),
        ),
        ("CRLF", only(TRIANGLE.replace('\n', "\r\n")), Scene(1, 3, &[])),
        ("CR", only(TRIANGLE.replace('\n', "\r")), Scene(1, 3, &[])),
        ("a continued line", only("v 0 0 \\\n0\nv 1 0 0\nv 0 1 0\nf 1 \\\r\n 2\\\n 3"), Scene(1, 3, &[])),
        ("continued at the end of the file", only(format!("{TRIANGLE}\\")), Scene(1, 3, &[])),
        ("Latin-1 names", only([b"o M\xfcller\ng \xe9\xff\n".as_slice(), TRIANGLE.as_bytes()].concat()), Scene(1, 3, &[])),
        ("a byte-order mark and tabs", only(format!("\u{feff}{}", TRIANGLE.replace(' ', "\t "))), Scene(1, 3, &[])),
        (
            "colours and weights after the vertices",
            only("v 0 0 0 1\nv 1 0 0 1 0 0\nv 0 1 0 1 1 1 1\nf 1 2 3 # comment\n"),
            Scene(1, 3, &[]),
        ),
        ("a polygon of 270 corners", polygon(270), Scene(268, 270, &[])),
        ("a polygon of 65,536 corners", polygon(65_536), Scene(65_534, 65_536, &[])),
        ("one corner more", polygon(65_537), Error("DIR/a.obj:65538: a face of more than 65536 corners; cut it into smaller ones")),
        (
            "a line without end",
            only(vec![b'v'; (1 << 20) + 1]),
            Error("DIR/a.obj:1: the line is longer than 1048576 bytes; is this an OBJ file?"),
        ),
        ("ten thousand groups", only(groups), Scene(10_000, 30_000, &[])),
        (
            "free-form surfaces",
            only(format!("surf 0 1 0 1 1\n{TRIANGLE}")),
            Scene(1, 3, &["DIR/a.obj:1: free-form curves and surfaces are not read; export polygons (in 1 place)"]),
        ),
        ("the same corner thrice", soup("f 1 1 1\nf 1 2 1"), Scene(2, 2, &[])),
        ("smoothing off splits vertices", only("s off\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\n"), Scene(2, 6, &[])),
        ("smoothing on shares them", only("s 1\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\n"), Scene(2, 4, &[])),
    ]
}

fn mtl_cases() -> Vec<Case> {
    vec![
        (
            "no such library",
            only(format!("mtllib b.mtl\nusemtl m\n{TRIANGLE}")),
            Scene(
                1,
                3,
                &[
                    "DIR/a.obj:1: materials are not read: b.mtl does not exist",
                    "DIR/a.obj:2: no material \"m\"; the default material is used",
                ],
            ),
        ),
        (
            "a library of a similar name",
            vec![("a.obj", obj(&format!("mtllib colors.mtl\n{TRIANGLE}"))), ("colours.mtl", vec![])],
            Scene(1, 3, &["DIR/a.obj:1: materials are not read: colors.mtl does not exist: did you mean colours.mtl?"]),
        ),
        (
            "a material of a similar name",
            vec![("a.obj", obj(&format!("mtllib a.mtl\nusemtl Steal\n{TRIANGLE}"))), ("a.mtl", obj("newmtl steel\n"))],
            Scene(1, 3, &["DIR/a.obj:2: no material \"Steal\" (there is \"steel\"); the default material is used"]),
        ),
        (
            "two libraries on a line",
            vec![
                ("a.obj", obj(&format!("mtllib a.mtl b.mtl\nusemtl b\n{TRIANGLE}"))),
                ("a.mtl", obj("newmtl a\n")),
                ("b.mtl", obj("newmtl b\n")),
            ],
            Scene(1, 3, &[]),
        ),
        (
            "a library with a blank in its name",
            vec![("a.obj", obj(&format!("mtllib my file.mtl\nusemtl a b\n{TRIANGLE}"))), ("my file.mtl", obj("newmtl a b\n"))],
            Scene(1, 3, &[]),
        ),
        (
            "numbers that are none",
            with_material("newmtl m\nKd red\nNs\nd x\nKs -1 0 0\nTr 2\n"),
            Scene(
                1,
                3,
                &[
                    "a.mtl:2: \"Kd red\" is no colour and is not used; write Kd red green blue, each 0 or more",
                    "a.mtl:3: \"Ns \" is no number and is not used",
                    "a.mtl:4: \"d x\" is no number and is not used",
                    "a.mtl:5: \"Ks -1 0 0\" is no colour and is not used; write Ks red green blue, each 0 or more",
                    "a.mtl: Tr 1 would leave nothing of m to be seen; it is taken as solid (say d 0 to hide it)",
                ],
            ),
        ),
        (
            "no texture",
            with_material("newmtl m\nmap_Kd gone.png\nmap_d\n"),
            Scene(1, 3, &["a.mtl:3: map_d names no file", "a.mtl:2: no texture: gone.png does not exist"]),
        ),
        (
            "a texture of text",
            [with_material("newmtl m\nmap_Kd t.png\n"), vec![("t.png", obj("hello, this is text"))]].concat(),
            Scene(1, 3, &["a.mtl:2: no texture: t.png: not a picture that can be read; convert to PNG, JPEG or TGA"]),
        ),
        (
            "an empty texture",
            [with_material("newmtl m\nmap_Kd t.png\n"), vec![("t.png", vec![])]].concat(),
            Scene(1, 3, &["a.mtl:2: no texture: t.png: not a picture that can be read; convert to PNG, JPEG or TGA"]),
        ),
        (
            "a GIF",
            [with_material("newmtl m\nmap_Kd t.png\n"), vec![("t.png", obj("GIF89a\x01\x00\x01\x00"))]].concat(),
            Scene(1, 3, &["a.mtl:2: no texture: t.png: Gif pictures cannot be read; convert to PNG, JPEG or TGA"]),
        ),
        (
            "a PNG that claims 2^31 columns",
            [with_material("newmtl m\nmap_Kd t.png\n"), vec![("t.png", huge_png())]].concat(),
            Scene(
                1,
                3,
                &["a.mtl:2: no texture: t.png: the picture is too large (Image size exceeds limit); the limit is 16384 x 16384 pixels"],
            ),
        ),
        (
            "a TGA without pixels",
            [with_material("newmtl m\nmap_Kd t.tga\n"), vec![("t.tga", tga(24, &[]))]].concat(),
            Scene(1, 3, &["a.mtl:2: no texture: t.tga: the picture is damaged (Format error decoding Tga: Invalid empty image)"]),
        ),
        (
            "a folder as a texture",
            [with_material("newmtl m\nmap_Kd t\n"), vec![("t/x", vec![])]].concat(),
            Scene(1, 3, &["a.mtl:2: no texture: DIR/t is not a regular file; read a stream by the name -"]),
        ),
    ]
}

fn huge_png() -> Vec<u8> {
    let mut bytes = png(png::ColorType::Grayscale, &[0]);
    bytes[16..20].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff]);
    let checksum = crc32(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&checksum.to_be_bytes());
    bytes
}

fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc: u32, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| crc >> 1 ^ (0xedb8_8320 * (crc & 1))))
}

fn toml_cases() -> Vec<Case> {
    let sphere = "[[mesh]]\nshape = \"sphere\"\nsegments = 8\n";
    let and = |text: &str| described(&format!("{text}\n{sphere}"));
    vec![
        ("an empty description", described(""), Scene(0, 0, &["DIR/scene.toml: holds no meshes"])),
        ("no TOML", described("v 0 0 0"), Error("DIR/scene.toml:1: key with no value, expected `=`")),
        (
            "no UTF-8",
            vec![("scene.toml", b"up = [0, 1, 0]\n# \xff\n".to_vec())],
            Error("DIR/scene.toml:2: the text is not UTF-8; save it as UTF-8"),
        ),
        (
            "a key that is nearly right",
            described("[[material]]\nname = \"a\"\ndifuse = 1\n"),
            Error(
                "DIR/scene.toml:3: unknown field `difuse`, expected one of `name`, `diffuse`, `specular`, `shininess`, `emission`, `opacity`, `blend`, `index_of_refraction`, `illumination`, `mirror`, `diffuse_map`, `specular_map`, `emission_map`, `opacity_map`, `normal_map`, `bump_map`, `bump_scale`; did you mean `diffuse`?",
            ),
        ),
        (
            "a key that is not",
            described("\nweather = \"fine\"\n"),
            Error(
                "DIR/scene.toml:2: unknown field `weather`, expected one of `up`, `animation`, `ambient`, `render`, `background`, `camera`, `light`, `material`, `mesh`",
            ),
        ),
        (
            "a shape that is nearly right",
            described("[[mesh]]\nshape = \"shpere\"\n"),
            Error(
                "DIR/scene.toml:2: no shape \"shpere\"; there are \"sphere\", \"plane\", \"box\", \"quad\", \"torus\", \"knot\", \"soup\", \"bumpy\"; did you mean \"sphere\"?",
            ),
        ),
        (
            "a file and a shape",
            described("[[mesh]]\nfile = \"a.obj\"\nshape = \"box\"\n"),
            Error("DIR/scene.toml:1: a mesh needs one of: file = \"name.obj\", sequence = \"name.%04d.obj\", shape = \"sphere\""),
        ),
        (
            "neither",
            described("\n[[mesh]]\nname = \"a\"\n"),
            Error("DIR/scene.toml:2: a mesh needs one of: file = \"name.obj\", sequence = \"name.%04d.obj\", shape = \"sphere\""),
        ),
        ("a mesh file that is not there", described("[[mesh]]\nfile = \"a.obj\"\n"), Error("DIR/scene.toml:2: a.obj does not exist")),
        (
            "a mesh file that is broken",
            vec![("scene.toml", obj("[[mesh]]\nfile = \"a.obj\"\n")), ("a.obj", obj("v 0 0 0\nf 1 2 3\n"))],
            Error("a.obj:2: vertex 2 in \"2\" does not exist: 1 vertex so far, counted from 1, or from -1 backwards"),
        ),
        (
            "a material that is not there",
            described("[[material]]\nname = \"gold\"\n[[mesh]]\nshape = \"box\"\nmaterial = \"golf\"\n"),
            Error("DIR/scene.toml:5: no material \"golf\"; there are \"default\", \"gold\"; did you mean \"gold\"?"),
        ),
        (
            "a material twice",
            described("[[material]]\nname = \"a\"\n[[material]]\nname = \"a\"\n"),
            Error("DIR/scene.toml:3: material \"a\" is there twice; rename one"),
        ),
        ("infinite", and("ambient = inf"), Error("DIR/scene.toml:1: the parts of a colour must be finite and 0 or more")),
        ("negative light", and("ambient = [1, -1, 0]"), Error("DIR/scene.toml:1: the parts of a colour must be finite and 0 or more")),
        (
            "a colour of two parts",
            and("ambient = [1, 1]"),
            Error("DIR/scene.toml:1: invalid length 2, expected a colour: a number, [red, green, blue] (linear), or \"#rrggbb\" (sRGB)"),
        ),
        (
            "a colour with a typing error",
            and("ambient = \"#12345g\""),
            Error(
                "DIR/scene.toml:1: invalid value: string \"#12345g\", expected a colour: a number, [red, green, blue] (linear), or \"#rrggbb\" (sRGB)",
            ),
        ),
        ("up is nowhere", and("up = [0, 0, 0]"), Error("DIR/scene.toml:1: up must not be [0, 0, 0]")),
        (
            "a light of an unknown kind",
            described("[[light]]\nkind = \"sun\"\n"),
            Error("DIR/scene.toml:2: no kind of light \"sun\"; there are \"point\", \"directional\", \"spot\""),
        ),
        (
            "a point light without a place",
            described("[[light]]\nkind = \"point\"\nintensity = 1\n"),
            Error("DIR/scene.toml:1: a point light needs position = [x, y, z]"),
        ),
        (
            "a directional light with intensity",
            described("[[light]]\nkind = \"directional\"\nintensity = 1\ndirection = [0, -1, 0]\n"),
            Error("DIR/scene.toml:1: a directional light has no intensity; give irradiance"),
        ),
        (
            "a spot light on itself",
            described("[[light]]\nkind = \"spot\"\nintensity = 1\nposition = [1, 1, 1]\ntarget = [1, 1, 1]\n"),
            Error("DIR/scene.toml:5: target must differ from position"),
        ),
        (
            "a camera that looks nowhere",
            described("[[camera]]\nname = \"c\"\neye = [1, 2, 3]\ntarget = [1, 2, 3]\n"),
            Error("DIR/scene.toml:1: a camera's eye and target must differ, and up must not be [0, 0, 0]"),
        ),
        (
            "a camera that looks along its up",
            described("[[camera]]\nname = \"c\"\neye = [0, 2, 0]\ntarget = [0, 0, 0]\n"),
            Error("DIR/scene.toml:1: a camera must not look along its up; give another up"),
        ),
        (
            "a camera with an eye alone",
            described("[[camera]]\nname = \"c\"\neye = [0, 2, 0]\n"),
            Error("DIR/scene.toml:1: a camera needs eye and target, or neither (with azimuth, elevation, zoom from the automatic view)"),
        ),
        (
            "a camera with half a turn of view",
            described("[[camera]]\nname = \"c\"\nfov = 180\n"),
            Error("DIR/scene.toml:3: fov is 180; it must be from 0.01 to 179"),
        ),
        (
            "cameras of one name",
            described("[[camera]]\nname = \"c\"\n[[camera]]\nname = \"c\"\n"),
            Error("DIR/scene.toml:4: camera \"c\" is there twice; rename one"),
        ),
        (
            "a default camera that is not there",
            described("[render]\ncamera = \"font\"\n[[camera]]\nname = \"front\"\n"),
            Error("DIR/scene.toml:2: no camera \"font\"; there are \"front\"; did you mean \"front\"?"),
        ),
        (
            "a picture without width",
            described("[render]\nsize = [0, 100]\n"),
            Error("DIR/scene.toml:2: width and height of a picture must be 1 or more"),
        ),
        (
            "a picture of negative width",
            described("[render]\nsize = [-1, 100]\n"),
            Error("DIR/scene.toml:2: invalid value: integer `-1`, expected a whole number, 0 or more"),
        ),
        (
            "a tone map that is nearly right",
            described("[render]\ntonemap = \"reinhart\"\n"),
            Error(
                "DIR/scene.toml:2: no tonemap \"reinhart\"; there are \"none\", \"reinhard\", \"aces\", \"agx\", \"neutral\"; did you mean \"reinhard\"?",
            ),
        ),
        ("a density of zero", described("[render]\ndensity = 0\n"), Error("DIR/scene.toml:2: density is 0; it must be above 0")),
        ("no samples", described("[render]\nspp = 0\n"), Error("DIR/scene.toml:2: spp must be 1 or more")),
        (
            "a background of two kinds",
            described("[background]\ncolour = 1\ntop = 1\n"),
            Error("DIR/scene.toml:1: a background needs one of: colour, or bottom and top, or image"),
        ),
        (
            "a background that is not there",
            described("[background]\nimage = \"sky.exr\"\n"),
            Error("DIR/scene.toml:2: sky.exr does not exist"),
        ),
        (
            "a background that is no picture",
            vec![("scene.toml", obj("[background]\nimage = \"sky.exr\"\n")), ("sky.exr", obj("\x76\x2f\x31\x01rubbish"))],
            Error(
                "DIR/scene.toml:2: sky.exr: the picture is damaged or of a kind that cannot be read (not supported: too new file feature flags)",
            ),
        ),
        (
            "a scale of zero",
            described("[[mesh]]\nshape = \"box\"\nscale = [1, 0, 1]\n"),
            Error("DIR/scene.toml:3: a scale must be finite and not 0"),
        ),
        (
            "a matrix that flattens",
            described("[[mesh]]\nshape = \"box\"\nmatrix = [[1, 0, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0]]\n"),
            Error("DIR/scene.toml:3: matrix must be 3 rows of 4 numbers (or 4 rows, the last [0, 0, 0, 1]) and not flatten the mesh"),
        ),
        (
            "a matrix and a translation",
            described("[[mesh]]\nshape = \"box\"\ntranslate = [1, 0, 0]\nmatrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]\n"),
            Error("DIR/scene.toml:4: a mesh has a matrix, or translate, rotate and scale, not both"),
        ),
        (
            "four thousand million triangles",
            described("[[mesh]]\nshape = \"soup\"\ntriangles = 4000000000\n"),
            Error("DIR/scene.toml:2: more than 33554432 triangles in a shape, or 67108864 in all; ask for fewer"),
        ),
        (
            "a radius of a file",
            vec![("scene.toml", obj("[[mesh]]\nfile = \"a.obj\"\nradius = 2\n")), ("a.obj", obj(TRIANGLE))],
            Error("DIR/scene.toml:1: radius belongs to a shape, not to a file"),
        ),
        (
            "a texture that is not there",
            described("[[material]]\nname = \"a\"\ndiffuse_map = \"a.png\"\n[[mesh]]\nshape = \"box\"\nmaterial = \"a\"\n"),
            Scene(12, 24, &["DIR/scene.toml:3: no texture: a.png does not exist"]),
        ),
    ]
}

#[test]
fn every_nasty_file_gives_exactly_what_the_table_says() {
    let cases: Vec<Case> = obj_cases().into_iter().chain(mtl_cases()).chain(toml_cases()).collect();
    assert!(cases.len() >= 80);
    let mut wrong = Vec::new();
    for (what, files, expected) in cases {
        let borrowed: Vec<(&str, &[u8])> = files.iter().map(|(name, bytes)| (*name, bytes.as_slice())).collect();
        let folder = folder(&borrowed);
        let name = if files.iter().any(|(name, _)| *name == "scene.toml") { "scene.toml" } else { "a.obj" };
        let found = load(&folder.path().join(name), &LoadOptions::default());
        let (found, expected) = match (found, expected) {
            (Err(error), Error(expected)) => (without_folder(&error.to_string(), folder.path()), expected.to_owned()),
            (Err(error), Scene(..)) => (without_folder(&error.to_string(), folder.path()), "a scene".to_owned()),
            (Ok(scene), expected) => {
                let triangles = scene.triangle_count() as usize;
                let vertices: usize = scene.meshes.iter().map(|mesh| mesh.positions.len()).sum();
                let warnings: Vec<String> = scene.warnings.iter().map(|warning| without_folder(warning, folder.path())).collect();
                let found = format!("{triangles} {vertices} {warnings:#?}");
                match expected {
                    Scene(triangles, vertices, warnings) => (found, format!("{triangles} {vertices} {warnings:#?}")),
                    Error(expected) => (found, expected.to_owned()),
                }
            }
        };
        if found != expected {
            wrong.push(format!("{what}\n     found: {found}\n  expected: {expected}"));
        }
    }
    assert!(wrong.is_empty(), "{} cases:\n{}", wrong.len(), wrong.join("\n"));
}
