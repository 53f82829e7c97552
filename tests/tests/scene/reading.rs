//! What is read from good files, value by value.

use gridwalk_scene::{Background, Bounds, Framing, Light, LoadOptions, frame_camera, load, load_reader};

use super::gltf::Maker;
use super::{folder, png, tga};

const QUAD: &str = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

#[test]
fn materials_reach_the_triangles_that_name_them_in_file_order() {
    let obj = format!(
        "mtllib a.mtl\n{QUAD}usemtl red\nf 1/1 2/2 3/3\ng other\nusemtl blue\nf 1/1 3/3 4/4\nusemtl red\nf 1/1 2/2 4/4\nusemtl\nf 2/2 3/3 4/4\n"
    );
    let mtl = "newmtl blue\nKd 0 0 1\nKs 0.5 0.5 0.5\nNs 20\nKe 1 2 3\nd 0.5\nTr 0.9\nNi 1.5\nillum 3\nnewmtl red\nKd 1 0 0\nTr 0.25\n";
    let folder = folder(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())]);
    let scene = load(&folder.path().join("a.obj"), &LoadOptions::default()).unwrap();
    assert_eq!(scene.warnings, [""; 0]);
    assert_eq!(scene.meshes.len(), 1, "one mesh whatever the groups");
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.name, "a");
    let names: Vec<&str> = mesh.materials.iter().map(|&at| scene.materials[at as usize].name.as_str()).collect();
    assert_eq!(names, ["red", "blue", "red", "default"]);
    let corner = |triangle: usize, at: usize| mesh.positions[mesh.indices[triangle][at] as usize];
    assert_eq!([corner(1, 0), corner(1, 1), corner(1, 2)], [[0.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]]);
    assert_eq!(mesh.uvs[mesh.indices[1][1] as usize], [1.0, 1.0]);
    assert!(mesh.normals.iter().all(|normal| *normal == [0.0, 0.0, 1.0]));
    let blue = scene.materials.iter().find(|material| material.name == "blue").unwrap();
    assert_eq!((blue.diffuse, blue.specular, blue.shininess, blue.emission), ([0.0, 0.0, 1.0], [0.5; 3], 20.0, [1.0, 2.0, 3.0]));
    assert_eq!((blue.opacity, blue.index_of_refraction, blue.illumination), (0.5, 1.5, 3));
    let red = scene.materials.iter().find(|material| material.name == "red").unwrap();
    assert_eq!(red.opacity, 0.75);
    assert!(red.blend && blue.blend && !scene.materials[0].blend);
}

#[test]
fn smooth_normals_are_the_mean_by_angle_across_groups_and_materials() {
    // Three faces of a cube about one corner, each a quad, in three groups: whatever the diagonals, the corner's normal is the diagonal.
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\ng a\nusemtl x\nf 1 4 3 2\ng b\nusemtl y\nf 1 2 6 5\ng c\nusemtl z\nf 1 5 7 4\n";
    let folder = folder(&[("a.obj", obj.as_bytes())]);
    let scene = load(&folder.path().join("a.obj"), &LoadOptions::default()).unwrap();
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.positions.len(), 7);
    let at = mesh.positions.iter().position(|position| *position == [0.0; 3]).unwrap();
    let expected = -1.0 / 3.0_f32.sqrt();
    for value in mesh.normals[at] {
        assert!((value - expected).abs() < 1e-6, "{:?}", mesh.normals[at]);
    }
    // Negative control: without smoothing no normal is oblique.
    let mut flat: &[u8] = &[b"s off\n", obj.as_bytes()].concat();
    let scene = load_reader(&mut flat, None, &LoadOptions::default()).unwrap();
    assert_eq!(scene.meshes[0].positions.len(), 12);
    assert!(scene.meshes[0].normals.iter().all(|normal| normal.iter().filter(|value| **value != 0.0).count() == 1));
}

#[test]
fn file_normals_are_kept_normalised_and_useless_ones_are_computed() {
    let mut obj: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 3 4\nvn 0 0 0\nvn nan 0 1\nf 1//1 2//2 3//3\n";
    let mesh = &load_reader(&mut obj, None, &LoadOptions::default()).unwrap().meshes[0];
    assert_eq!(mesh.normals, [[0.0, 0.6, 0.8], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]);
}

#[test]
fn textures_of_every_kind_are_told_by_content_and_found_by_any_spelling() {
    let mut jpeg = Vec::new();
    image::codecs::jpeg::JpegEncoder::new(&mut jpeg).encode(&[200; 12], 2, 2, image::ExtendedColorType::Rgb8).unwrap();
    let mtl = "newmtl a\nmap_Kd Textures\\Wood Floor.PNG\nmap_Ks C:\\Users\\me\\shine.tga\nmap_Ke /home/me/glow.jpg\nmap_d mask.png\n\
               map_bump -bm 0.5 bump.png\nnewmtl b\nmap_Kd leaf.png\nnewmtl c\nmap_Kd textures/wood floor.png\nmap_d leaf.png\nnorm normal.png\n";
    let obj = format!("mtllib A.MTL\n{QUAD}usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3\n");
    let folder = folder(&[
        ("a.obj", obj.as_bytes()),
        ("a.mtl", mtl.as_bytes()),
        ("textures/wood floor.png", &png(png::ColorType::Rgb, &[1, 2, 3, 250, 251, 252])),
        ("Shine.TGA", &tga(24, &[3, 2, 1])),
        ("glow.jpg", &jpeg),
        ("mask.png", &png(png::ColorType::Grayscale, &[0, 128, 255])),
        ("bump.png", &png(png::ColorType::Grayscale, &[7])),
        ("leaf.png", &tga(32, &[30, 20, 10, 0, 60, 50, 40, 255])),
        ("normal.png", &png(png::ColorType::Rgb, &[128, 128, 255])),
    ]);
    let scene = load(&folder.path().join("a.obj"), &LoadOptions::default()).unwrap();
    assert_eq!(scene.warnings, [""; 0]);
    let named = |name: &str| scene.materials.iter().find(|material| material.name == name).unwrap();
    let texture = |at: Option<u32>| &scene.textures[at.unwrap() as usize];
    let a = named("a");
    let diffuse = texture(a.diffuse_map);
    assert_eq!((diffuse.width, diffuse.height, diffuse.srgb, diffuse.has_alpha), (2, 1, true, false));
    assert_eq!(diffuse.pixels, [1, 2, 3, 255, 250, 251, 252, 255]);
    assert_eq!(texture(a.specular_map).pixels, [1, 2, 3, 255]);
    assert_eq!((texture(a.emission_map).width, texture(a.emission_map).height), (2, 2));
    assert_eq!(texture(a.opacity_map).pixels, [0, 0, 0, 0, 128, 128, 128, 128, 255, 255, 255, 255]);
    assert!(!texture(a.opacity_map).srgb && texture(a.opacity_map).has_alpha);
    assert_eq!((a.bump_scale, a.normal_map_is_height), (0.5, true));
    assert_eq!(a.diffuse, [1.0; 3], "a map without Kd is seen as it is");
    let b = named("b");
    assert_eq!(texture(b.diffuse_map).pixels, [10, 20, 30, 0, 40, 50, 60, 255], "TGA under the name of PNG");
    assert_eq!(texture(b.opacity_map).pixels, [0, 0, 0, 0, 255, 255, 255, 255], "the alpha of a colour map is a mask");
    let c = named("c");
    assert_eq!(c.diffuse_map, a.diffuse_map, "one file, one texture");
    assert_eq!(texture(c.opacity_map).pixels, [0, 0, 0, 0, 255, 255, 255, 255]);
    assert!(c.normal_map.is_some() && !c.normal_map_is_height);
}

#[test]
fn the_scene_file_of_the_documentation_means_what_it_says() {
    let text = include_str!("../../../crates/scene/src/lib.rs");
    let example: String = text
        .lines()
        .skip_while(|line| *line != "//! ```toml")
        .skip(1)
        .take_while(|line| *line != "//! ```")
        .map(|line| format!("{}\n", line.trim_start_matches("//!").trim_start()))
        .collect();
    let mut fox = Maker::triangle();
    fox.animate(0, "translation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    fox.json["animations"][0]["name"] = "Run".into();
    let folder = folder(&[("scene.toml", example.as_bytes()), ("teapot.obj", QUAD.as_bytes()), ("fox.glb", &fox.glb())]);
    let scene = load(folder.path(), &LoadOptions::default()).unwrap();
    assert_eq!(scene.cameras[0].name, "front");
    assert_eq!(scene.camera(None).unwrap().eye, [0.0, 1.0, 5.0]);
    assert_eq!(scene.camera(Some("rear")), None);
    assert_eq!((scene.defaults.size, scene.defaults.spp, scene.defaults.depth), (Some([800, 600]), Some(4), Some(4)));
    assert_eq!(scene.ambient, [0.1; 3]);
    assert_eq!(scene.background, Background::Gradient { bottom: [0.3; 3], top: [0.6, 0.7, 0.9] });
    let third = 1.0 / 6.0_f32.sqrt();
    let Light::Directional { direction, irradiance } = scene.lights[0] else { panic!("{:?}", scene.lights[0]) };
    assert!((direction[0] + third).abs() < 1e-6 && irradiance == [2.5; 3]);
    let Light::Spot { direction, outer_degrees, intensity, .. } = scene.lights[1] else { panic!("{:?}", scene.lights[1]) };
    assert_eq!((direction, outer_degrees, intensity), ([0.0, -1.0, 0.0], 30.0, [20.0, 18.0, 15.0]));
    let steel = &scene.materials[1];
    assert_eq!((steel.name.as_str(), steel.illumination, steel.diffuse, steel.specular), ("steel", 3, [0.1; 3], [0.8; 3]));
    assert_eq!(scene.meshes.iter().map(|mesh| mesh.name.as_str()).collect::<Vec<_>>(), ["teapot", "node 0", "sphere"]);
    assert_eq!(scene.meshes[1].positions[0], [0.5, 0.0, 0.0], "half a second into the clip");
    assert!(scene.meshes[2].materials.iter().all(|&material| material == 1));
}

#[test]
fn a_panorama_is_read_in_linear_light_from_the_top_row() {
    let row = [0.25_f32, 1.0, 4.0, -1.0, f32::NAN, 1e9];
    let folder = folder(&[("scene.toml", b"[background]\nimage = \"sky.exr\"\nscale = 2\nrotation = 90\n")]);
    exr::prelude::write_rgb_file(folder.path().join("sky.exr"), 1, 2, |_, y| (row[3 * y], row[3 * y + 1], row[3 * y + 2])).unwrap();
    let scene = load(folder.path(), &LoadOptions::default()).unwrap();
    let Background::Equirectangular { width, height, pixels, rotation_degrees } = scene.background else {
        panic!("{:?}", scene.background)
    };
    assert_eq!((width, height, rotation_degrees), (1, 2, 90.0));
    assert_eq!(pixels, [[0.5, 2.0, 8.0], [0.0, 0.0, 65_504.0]]);
}

#[test]
fn a_bare_obj_gets_a_camera_that_sees_all_of_it_and_light_from_its_side() {
    for offset in [0.0_f32, 1e6, -3e4] {
        for size in [[1.0_f32, 1.0, 1.0], [1e-3, 50.0, 1e-3], [100.0, 0.0, 3.0], [0.0; 3]] {
            for up in [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.3, 0.4, 0.5]] {
                let bounds = Bounds { min: [offset; 3], max: size.map(|value| value + offset) };
                let framing = Framing { up, ..Framing::default() };
                let camera = frame_camera(&bounds, &framing);
                let sub = |a: [f32; 3], b: [f32; 3]| [0, 1, 2].map(|axis| f64::from(a[axis]) - f64::from(b[axis]));
                let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
                let cross = |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
                let unit = |a: [f64; 3]| a.map(|value| value / dot(a, a).sqrt());
                let view = unit(sub(camera.target, camera.eye));
                let right = unit(cross(view, camera.up.map(f64::from)));
                let above = cross(right, view);
                let tangent = f64::from(camera.vertical_fov_degrees / 2.0).to_radians().tan();
                let mut largest = 0.0_f64;
                for corner in 0..8 {
                    let corner = std::array::from_fn(|axis| if corner >> axis & 1 == 1 { bounds.max[axis] } else { bounds.min[axis] });
                    let to = sub(corner, camera.eye);
                    let depth = dot(to, view);
                    assert!(depth > 0.0, "{offset} {size:?} {up:?}");
                    largest = largest
                        .max(dot(to, above).abs() / depth / tangent)
                        .max(dot(to, right).abs() / depth / tangent / f64::from(framing.aspect));
                }
                assert!(largest < 1.0, "{offset} {size:?} {up:?}: {largest}");
                let extent: f32 = size.iter().sum();
                assert!(extent == 0.0 || offset.abs() > 1e5 || largest > 0.75, "{offset} {size:?} {up:?}: small in the picture, {largest}");
            }
        }
    }
    let mut obj: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let scene = load_reader(&mut obj, None, &LoadOptions::default()).unwrap();
    assert_eq!(scene.lights.len(), 2);
    assert!(matches!(scene.background, Background::Gradient { .. }));
    assert!(scene.camera(None).is_some());
}
