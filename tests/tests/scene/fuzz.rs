//! Files with random bytes changed: whatever comes of them, nobody panics, hangs or takes much memory. A failure names its seed, which goes
//! into `GRIDWALK_FUZZ_SEED` to see it again alone.

use std::panic::{AssertUnwindSafe, catch_unwind};

use gridwalk_scene::generate::Random;
use gridwalk_scene::{Animation, AnimationOptions, LoadOptions, Motion, Pose, Scene, load, load_reader, open};

use super::{folder, ply, png, tga};

const OBJ: &[u8] = b"# head\nmtllib a.mtl\no body\nv 0 0 0\nv 1.5 0 -2e-3\nv 1 1 0\nv 0 1 0 1\nv .5 .5 1\nvt 0 0\nvt 1 0\nvt 1 1 0\nvn 0 0 1\n\
    vn 0 1 0\ng one two\nusemtl red\ns 1\nf 1/1/1 2/2/1 3/3/2\nf 1 2 3 4\ns off\nusemtl blue\nf -1//-1 -2//-1 -3//-2\nf 1/1 3/2 \\\n4/3\nf 2 3 5 4 1\n";
const MTL: &[u8] = b"newmtl red\nKd 1 0 0\nKs .5 .5 .5\nNs 1e2\nKe 0 0 0\nd 1.0\nTr 0\nNi 1.45\nillum 3\nmap_Kd -o 0 0 -s 1 1 1 a.png\n\
    map_d a.tga\nmap_bump -bm 0.3 a.tga\nnewmtl blue\nKd 0 0 1\nmap_Kd a.tga\nnorm a.png\nmap_Ke b\\a.png\n";
const TOML: &[u8] = b"up = [0, 1, 0]\nambient = 0.1\n[render]\nsize = [64, 48]\nspp = 2\nexposure = -0.5\ntonemap = \"aces\"\ncamera = \"a\"\n\
    [background]\nimage = \"a.png\"\nscale = 2\n[[camera]]\nname = \"a\"\neye = [0, 1, 5]\ntarget = [0, 0, 0]\nfov = 40\n[[light]]\nkind = \"spot\"\n\
    position = [1, 2, 3]\ntarget = [0, 0, 0]\nintensity = \"#ff8800\"\nouter = 30\n[[material]]\nname = \"m\"\ndiffuse_map = \"a.png\"\nmirror = true\n\
    [[mesh]]\nfile = \"a.obj\"\nscale = [1, 2, 3]\nrotate = [0, 45, 0]\nmaterial = \"m\"\n[[mesh]]\nshape = \"torus\"\nsegments = 8\ntube = 0.2\n\
    matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 2]]\n";
/// What mutations like to put in: words of the formats and numbers at the edges.
const WORDS: [&[u8]; 28] = [
    b"f ",
    b"v ",
    b"vt ",
    b"vn ",
    b"usemtl ",
    b"mtllib ",
    b"newmtl ",
    b"map_Kd ",
    b"s off\n",
    b"\\\n",
    b"\r",
    b"\n",
    b"/",
    b"//",
    b"-1",
    b"0",
    b"4294967296",
    b"-9223372036854775808",
    b"nan",
    b"inf",
    b"1e39",
    b"-0",
    b"\0",
    b"\xff\xfe",
    b"[[mesh]]\n",
    b"\"",
    b"]",
    b"2147483647",
];

pub(super) fn mutated(bytes: &[u8], most: u64, random: &mut Random) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..=random.below(most) {
        let at = random.below(bytes.len() as u64 + 1) as usize;
        let end = (at + random.below(12) as usize).min(bytes.len());
        match random.below(7) {
            0 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
            1 if at < bytes.len() => bytes[at] = random.next_u64() as u8,
            2 => drop(bytes.drain(at..end)),
            3 => {
                let piece = bytes[at..end].to_vec();
                let to = random.below(bytes.len() as u64 + 1) as usize;
                bytes.splice(to..to, piece);
            }
            4 => bytes.truncate(at.max(1)),
            _ => {
                let word = WORDS[random.below(WORDS.len() as u64) as usize];
                bytes.splice(at..at, word.iter().copied());
            }
        }
    }
    bytes
}

/// What every scene that was read keeps to, so that nobody downstream needs to check it again.
fn assert_sound(scene: &Scene) {
    for mesh in &scene.meshes {
        assert_eq!((mesh.normals.len(), mesh.uvs.len()), (mesh.positions.len(), mesh.positions.len()));
        assert_eq!(mesh.materials.len(), mesh.indices.len());
        assert!(mesh.indices.as_flattened().iter().all(|&at| (at as usize) < mesh.positions.len()));
        assert!(mesh.materials.iter().all(|&at| (at as usize) < scene.materials.len()));
        assert!(mesh.normals.iter().all(|normal| (normal.iter().map(|value| value * value).sum::<f32>() - 1.0).abs() < 1e-4));
        assert!(mesh.uvs.as_flattened().iter().all(|value| value.is_finite()));
        assert!(mesh.colours.is_empty() || mesh.colours.len() == mesh.positions.len());
        assert!(mesh.colours.as_flattened().iter().all(|value| value.is_finite() && *value >= 0.0));
    }
    for material in &scene.materials {
        let maps = [material.diffuse_map, material.specular_map, material.emission_map, material.opacity_map, material.normal_map];
        assert!(maps.iter().flatten().all(|&at| (at as usize) < scene.textures.len()));
        let colours = [material.diffuse, material.specular, material.emission];
        assert!(colours.as_flattened().iter().all(|value| value.is_finite() && *value >= 0.0));
        assert!((0.0..=1.0).contains(&material.opacity) && material.shininess.is_finite());
    }
    for texture in &scene.textures {
        assert_eq!(texture.pixels.len(), 4 * texture.width as usize * texture.height as usize);
        assert!(!texture.pixels.is_empty());
    }
    assert!(scene.camera(None).is_some_and(|camera| camera.eye != camera.target && camera.eye.iter().all(|value| value.is_finite())));
}

/// Runs `case` for many seeds and returns how many of them gave a scene.
pub(super) fn fuzz(name: &str, count: u64, case: impl Fn(&mut Random) -> Option<Scene>) -> u64 {
    let wanted: Option<u64> = std::env::var("GRIDWALK_FUZZ_SEED").ok().and_then(|seed| seed.parse().ok());
    let seeds = wanted.map_or(0..count, |seed| seed..seed + 1);
    seeds
        .filter(|&seed| {
            let run = || case(&mut Random::new(seed)).inspect(assert_sound).is_some();
            catch_unwind(AssertUnwindSafe(run))
                .unwrap_or_else(|_| panic!("{name}: seed {seed}; see it alone with GRIDWALK_FUZZ_SEED={seed}"))
        })
        .count() as u64
}

/// Both outcomes must occur, or the mutations are too weak or too strong to test anything.
pub(super) fn assert_mixed(name: &str, scenes: u64, count: u64) {
    if std::env::var_os("GRIDWALK_FUZZ_SEED").is_none() {
        assert!(scenes > count / 50 && scenes < count - count / 50, "{name}: {scenes} of {count} were scenes");
    }
}

#[test]
fn meshes() {
    let count = 6000;
    let scenes = fuzz("meshes", count, |random| {
        let bytes = mutated(OBJ, 8, random);
        load_reader(&mut bytes.as_slice(), None, &LoadOptions::default()).ok()
    });
    assert_mixed("meshes", scenes, count);
}

#[test]
fn ply_meshes() {
    let count = 6000;
    let scenes = fuzz("ply_meshes", count, |random| {
        let model = ply::model(random);
        let format = [ply::Format::Ascii, ply::Format::Little, ply::Format::Big][random.below(3) as usize];
        let bytes = mutated(&ply::write(&model, format, false, random), 4, random);
        load_reader(&mut bytes.as_slice(), None, &LoadOptions::default()).ok()
    });
    assert_mixed("ply_meshes", scenes, count);
}

#[test]
fn packed_meshes() {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::none());
    std::io::Write::write_all(&mut encoder, OBJ).unwrap();
    let packed = encoder.finish().unwrap();
    let options = LoadOptions { max_mesh_bytes: 1 << 20, ..LoadOptions::default() };
    let count = 3000;
    let scenes = fuzz("packed_meshes", count, |random| {
        let bytes = mutated(&packed, 1, random);
        load_reader(&mut bytes.as_slice(), None, &options).ok()
    });
    assert_mixed("packed_meshes", scenes, count);
}

fn small() -> LoadOptions {
    LoadOptions { max_texture_bytes: 1 << 20, max_texture_size: 1024, ..LoadOptions::default() }
}

#[test]
fn materials() {
    let folder = folder(&[("a.obj", OBJ), ("a.png", &png(png::ColorType::Rgba, &[9; 16])), ("a.tga", &tga(32, &[7; 8]))]);
    let scenes = fuzz("materials", 2000, |random| {
        std::fs::write(folder.path().join("a.mtl"), mutated(MTL, 8, random)).unwrap();
        load(&folder.path().join("a.obj"), &small()).ok()
    });
    assert!(scenes == 2000 || std::env::var_os("GRIDWALK_FUZZ_SEED").is_some(), "a damaged material never costs the mesh");
}

#[test]
fn descriptions() {
    let folder = folder(&[("a.obj", OBJ), ("a.mtl", MTL), ("a.png", &png(png::ColorType::Rgba, &[9; 16])), ("a.tga", &tga(32, &[7; 8]))]);
    let path = folder.path().join("scene.toml");
    let count = 3000;
    let scenes = fuzz("descriptions", count, |random| {
        std::fs::write(&path, mutated(TOML, 2, random)).unwrap();
        load(&path, &small()).ok()
    });
    assert_mixed("descriptions", scenes, count);
}

/// What moves keeps to the same rules at any time.
fn assert_moves(animation: &Animation) {
    let mut pose = Pose::default();
    let mut reader = animation.reader().unwrap();
    assert!(animation.duration.is_finite() && animation.duration >= 0.0 && animation.fps > 0.0 && animation.frame_count(24.0) >= 1);
    assert_eq!(animation.motions.len(), animation.scene.meshes.len());
    for time in [0.0, 0.3, 1.0, -5.0, 1e12, f64::NAN] {
        let camera = animation.camera(None, time).unwrap();
        assert!(camera.eye != camera.target && camera.eye.iter().chain(&camera.up).all(|value| value.is_finite()));
        let lights = animation.lights(time);
        assert!(lights.iter().zip(&animation.scene.lights).all(|(a, b)| std::mem::discriminant(a) == std::mem::discriminant(b)));
        assert_eq!(lights.len(), animation.scene.lights.len());
        for (mesh, motion) in animation.motions.iter().enumerate() {
            let keys = animation.keys_at(mesh, time);
            match motion {
                Motion::Keys => {
                    let count = animation.key_count(mesh);
                    assert!(keys.first < count && keys.second < count && (0.0..1.0).contains(&keys.weight));
                    drop(reader.read(mesh, keys.second));
                }
                Motion::Deformed(deformed) => {
                    animation.pose(mesh, time, &mut pose);
                    assert_eq!((pose.matrices.len(), deformed.positions.len()), (1, animation.scene.meshes[mesh].positions.len()));
                    assert!(pose.matrices.as_flattened().as_flattened().iter().all(|value| value.is_finite()));
                }
                _ => assert_eq!(animation.key_count(mesh), 0),
            }
        }
    }
}

const MOVING: &[u8] = b"[animation]\nduration = 2\nfps = 12.5\n[[camera]]\nname = \"a\"\nloop = true\n[[camera.key]]\ntime = 0\neye = [0, 1, 5]\n\
    target = [0, 0, 0]\n[[camera.key]]\ntime = 1.5\nfov = 60\nup = [0, 1, 1]\n[[camera]]\nname = \"b\"\nturntable = 6\nazimuth = 9\n[[light]]\n\
    kind = \"spot\"\nintensity = 3\ntarget = [0, 0, 0]\ninterpolation = \"linear\"\n[[light.key]]\ntime = 0\nposition = [0, 3, 0]\n\
    [[light.key]]\ntime = 1\nintensity = 0\n[[mesh]]\nsequence = \"k.##.obj\"\nfps = 8\nstart = 0.06\nloop = true\nscale = 2\n[[mesh]]\n\
    sequence = [\"a.obj\", \"k.01.obj\"]\ninterpolate = false\n[[mesh]]\nshape = \"box\"\nrotate = [0, 10, 0]\n[[mesh.key]]\ntime = 0\n\
    [[mesh.key]]\ntime = 2\nrotate = [0, 360, 0]\nscale = 3\ntranslate = [0, 1, 0]\n";

#[test]
fn moving_descriptions() {
    let folder = folder(&[("a.obj", OBJ), ("k.01.obj", OBJ), ("k.02.obj", OBJ), ("k.04.obj", OBJ)]);
    let path = folder.path().join("scene.toml");
    let count = 3000;
    let scenes = fuzz("moving_descriptions", count, |random| {
        std::fs::write(&path, mutated(MOVING, 2, random)).unwrap();
        let animation = open(&path, &small(), &AnimationOptions::default()).ok()?;
        assert_moves(&animation);
        Some(animation.scene)
    });
    assert_mixed("moving_descriptions", scenes, count);
}

#[test]
fn pictures() {
    let mut jpeg = Vec::new();
    image::codecs::jpeg::JpegEncoder::new(&mut jpeg).encode(&[90; 192], 8, 8, image::ExtendedColorType::Rgb8).unwrap();
    let mut exr = std::io::Cursor::new(Vec::new());
    let image = exr::prelude::Image::from_channels(
        (8, 4),
        exr::prelude::SpecificChannels::rgb(|at: exr::prelude::Vec2<usize>| (at.x() as f32, 1.0, 0.5)),
    );
    exr::prelude::WritableImage::write(&image).to_buffered(&mut exr).unwrap();
    let mut hdr = Vec::new();
    image::codecs::hdr::HdrEncoder::new(&mut hdr).encode(&[image::Rgb([1.0, 2.0, 0.5]); 32], 8, 4).unwrap();
    let pictures = [png(png::ColorType::Rgba, &[9; 64]), tga(32, &[7; 64]), tga(8, &[7; 5]), jpeg, exr.into_inner(), hdr];
    let folder = folder(&[("a.obj", OBJ), ("a.mtl", b"newmtl red\nmap_Kd a\nmap_d a\n"), ("scene.toml", b"[background]\nimage = \"a\"\n")]);
    let count = 4000;
    let scenes = fuzz("pictures", count, |random| {
        let picture = &pictures[random.below(pictures.len() as u64) as usize];
        std::fs::write(folder.path().join("a"), mutated(picture, 8, random)).unwrap();
        assert_sound(&load(&folder.path().join("a.obj"), &small()).unwrap());
        load(&folder.path().join("scene.toml"), &small()).ok()
    });
    assert_mixed("pictures", scenes, count);
}
