//! Key-frames that have nothing in common with the one before.

use gridwalk_scene::generate;

use super::*;

const SCENE: &str = "ambient = 0.3\n[[mesh]]\nsequence = \"key.%04d.obj\"\nfps = 1\n[[mesh]]\nshape = \"torus\"\nradius = 1.5\n\
                     [[mesh]]\nsequence = [\"key.0001.obj\", \"key.0000.obj\"]\nfps = 1\ntranslate = [0, -1, 0]\n[[mesh]]\nshape = \"box\"\n";

fn still_at(moving: &Animation, time: f64) -> Scene {
    let mut reader = moving.reader().unwrap();
    let mut scene = moving.scene.clone();
    for mesh in [0, 2] {
        scene.meshes[mesh] = reader.read(mesh, moving.keys_at(mesh, time).first).unwrap().mesh;
    }
    scene
}

/// A few triangles, ten times as many, none at all, and back: the meshes behind move to and fro among the scene's triangles.
#[test]
fn key_frames_grow_tenfold_shrink_to_nothing_and_come_back() {
    let keys = [
        generate::sphere([0.0; 3], 0.7, 8),
        generate::sphere([0.3, 0.0, 0.0], 0.8, 26),
        Mesh::default(),
        generate::cuboid([1.0; 3]),
        generate::sphere([0.0; 3], 0.7, 8),
        generate::torus(0.8, 0.2, 40),
    ];
    let folder = sequence(&keys, SCENE);
    let moving = animation(folder.path());
    let mut run = play(folder.path());
    let mut grown = Vec::new();
    for key in [0, 1, 2, 3, 4, 5, 2, 5, 0, 1, 2, 3, 4, 5] {
        let time = f64::from(key) + if key == 3 { 0.5 } else { 0.0 };
        let stats = seek(&mut run, time, &[time + 1.0]);
        assert!(stats.rebuilt, "key-frame {key}");
        grown.push(stats.grown);
        let scene = still_at(&moving, time);
        assert_eq!(u64::from(run.scene().triangle_count()), scene.triangle_count());
        let counts: Vec<u32> = scene.meshes.iter().map(|mesh| mesh.positions.len() as u32).collect();
        assert_eq!(run.scene().vertex_count(), counts.iter().sum::<u32>());
        assert_eq!(run.grid().stats().report.triangles, run.scene().triangle_count());
        assert_same_picture(&format!("key-frame {key}"), &shoot_player(&run), &shoot_still(&scene));
    }
    assert!(grown[..6].iter().sum::<u32>() > 0 && grown[8..].iter().all(|&count| count == 0), "{grown:?}");
}

/// The same number of triangles with other corners: the first key-frame stands until the second is reached.
#[test]
fn other_faces_are_not_blended() {
    let a = generate::sphere([0.0; 3], 1.0, 10);
    let mut b = moved(a.clone(), [0.5, 0.0, 0.0]);
    b.indices.rotate_left(1);
    let folder = sequence(&[a.clone(), b, a.clone()], "[[mesh]]\nsequence = \"key.%04d.obj\"\nfps = 1\n");
    let mut run = play(folder.path());
    seek(&mut run, 0.0, &[]);
    let first = shoot_player(&run);
    let half = seek(&mut run, 0.5, &[1.0]);
    assert!(!half.rebuilt, "{half:?}");
    assert_same_picture("between", &first, &shoot_player(&run));
    seek(&mut run, 1.0, &[]);
    assert!(differ(&first, &shoot_player(&run)));
    seek(&mut run, 2.0, &[]);
    assert_same_picture("the same again", &first, &shoot_player(&run));
}

/// Two meshes of one sequence, a quarter apart.
#[test]
fn materials_and_textures_may_come_later() {
    let mesh = generate::sphere([0.0; 3], 1.0, 8);
    let key = |material: &str| format!("mtllib a.mtl\nusemtl {material}\n{}", obj(&mesh));
    let mut library = String::new();
    for i in 0..40 {
        library += &format!("newmtl m{i}\nKd {} 0.5 0.1\n", i as f32 / 40.0);
    }
    library += "newmtl last\nKd 1 1 1\nmap_Kd a.png\n";
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, 2, 1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().unwrap().write_image_data(&[255, 0, 0, 0, 255, 0]).unwrap();
    let mut files: Vec<(String, Vec<u8>)> = (0..40).map(|i| (format!("k{i}.obj"), key(&format!("m{i}")).into_bytes())).collect();
    files.push(("k40.obj".to_owned(), key("last").into_bytes()));
    files.push(("a.mtl".to_owned(), library.into_bytes()));
    files.push(("a.png".to_owned(), png));
    let folder = folder(&files);
    let path = folder.path().join("k#.obj");
    let mut run = play(&path);
    let fps = run.animation().fps;
    let mut grown = 0;
    for i in 0..=40_u32 {
        let stats = seek(&mut run, f64::from(i) / fps, &[f64::from(i + 1) / fps]);
        grown += u32::from(stats.grown > 0);
        if i % 8 == 0 {
            let mut alone = play(&path);
            let mut scene = alone.animation().scene.clone();
            let read = alone.animation().reader().unwrap().read(0, i).unwrap();
            scene.materials.extend(read.added_materials);
            scene.textures.extend(read.added_textures);
            scene.meshes[0] = read.mesh;
            let beauty = |layers: &Layers| bits(layers).swap_remove(0);
            let still = shoot_still(&scene);
            let found = shoot_player(&run);
            assert!(beauty(&found) == beauty(&still), "key-frame {i}");
            seek(&mut alone, f64::from(i) / fps, &[]);
            assert_same_picture(&format!("key-frame {i} alone"), &found, &shoot_player(&alone));
        }
    }
    assert!(grown > 0 && grown < 20, "{grown}");
    assert_eq!(run.animation().scene.materials.len(), 42);
}

/// A key-frame that is many times larger than the memory it travels through.
#[test]
fn a_large_key_frame_goes_through_a_small_memory() {
    let keys = [generate::sphere([0.0; 3], 1.0, 40), generate::sphere([0.1; 3], 0.9, 40), generate::torus(1.0, 0.4, 64)];
    let folder = sequence(&keys, "[[mesh]]\nsequence = \"key.%04d.obj\"\nfps = 1\n");
    let moving = animation(folder.path());
    let mut reader = moving.reader().unwrap();
    let mut options = PlayerOptions::default();
    options.staging_bytes = 0;
    let mut run = Player::new(context(), animation(folder.path()), &options).unwrap();
    for key in [1, 2, 0, 2, 1] {
        seek(&mut run, f64::from(key), &[f64::from((key + 1) % 3)]);
        let mesh = reader.read(0, key).unwrap().mesh;
        assert_eq!(run.scene().read_positions().unwrap()[..mesh.positions.len()], mesh.positions[..], "key-frame {key}");
        assert_eq!(run.scene().read_indices().unwrap(), mesh.indices, "key-frame {key}");
    }
}

/// A PLY file of a mesh, with colours of its vertices or without.
fn ply(mesh: &Mesh, colour: Option<fn(usize) -> [u8; 3]>) -> String {
    let mut text = format!("ply\nformat ascii 1.0\nelement vertex {}\n", mesh.positions.len());
    text += "property float x\nproperty float y\nproperty float z\n";
    if colour.is_some() {
        text += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    }
    writeln!(text, "element face {}\nproperty list uchar int vertex_indices\nend_header", mesh.indices.len()).unwrap();
    for (i, [x, y, z]) in mesh.positions.iter().enumerate() {
        write!(text, "{x} {y} {z}").unwrap();
        if let Some([r, g, b]) = colour.map(|colour| colour(i)) {
            write!(text, " {r} {g} {b}").unwrap();
        }
        text.push('\n');
    }
    for [a, b, c] in &mesh.indices {
        writeln!(text, "3 {a} {b} {c}").unwrap();
    }
    text
}

/// Colours of vertices that come with the second key-frame, are blended to the third, and are gone with the fourth.
#[test]
fn colours_of_vertices_come_and_go() {
    let mesh = generate::sphere([0.0; 3], 1.0, 12);
    let files = [
        ply(&mesh, None),
        ply(&mesh, Some(|i| [255, (i % 256) as u8, 40])),
        ply(&mesh, Some(|i| [20, 200, (i * 3 % 256) as u8])),
        ply(&mesh, None),
    ];
    let mut files: Vec<(String, String)> = files.into_iter().enumerate().map(|(i, text)| (format!("k{i}.ply"), text)).collect();
    files
        .push(("scene.toml".to_owned(), "ambient = 1.0\n[[mesh]]\nsequence = \"k#.ply\"\nfps = 1\n[[mesh]]\nshape = \"box\"\n".to_owned()));
    let folder = folder(&files);
    let moving = animation(folder.path());
    let mut reader = moving.reader().unwrap();
    let mut materials = moving.scene.materials.clone();
    let mut keys: Vec<Mesh> = Vec::new();
    for key in 0..4 {
        let read = reader.read(0, key).unwrap();
        materials.extend(read.added_materials);
        keys.push(read.mesh);
    }
    let mut run = play(folder.path());
    let mut pictures = Vec::new();
    for key in [0, 1, 2, 3, 1, 0] {
        seek(&mut run, key as f64, &[key as f64 + 1.0]);
        let mut scene = moving.scene.clone();
        scene.materials = materials.clone();
        scene.meshes[0] = keys[key].clone();
        let albedo = |layers: &Layers| bits(layers).into_iter().find(|(name, _)| name == "albedo").unwrap();
        let picture = shoot_player(&run);
        assert!(albedo(&picture) == albedo(&shoot_still(&scene)), "key-frame {key}");
        pictures.push(picture);
    }
    assert!(differ(&pictures[0], &pictures[1]) && differ(&pictures[1], &pictures[2]));
    seek(&mut run, 1.5, &[]);
    let mut scene = moving.scene.clone();
    scene.materials = materials;
    scene.meshes[0] = keys[1].clone();
    let colours = scene.meshes[0].colours.iter_mut().zip(&keys[2].colours);
    colours.for_each(|(a, b)| *a = [0, 1, 2].map(|channel| a[channel] + (b[channel] - a[channel]) * 0.5));
    let (found, expected) = (shoot_player(&run), shoot_still(&scene));
    let floats = |layers: &Layers| layers.get("albedo").unwrap().floats().unwrap().to_vec();
    assert!(floats(&found).iter().zip(floats(&expected)).all(|(a, b)| (a - b).abs() < 1e-6));
    assert!(floats(&found) != floats(&pictures[1]));
}

/// What a material's diffuse colour says of a whole mesh, colours say of its vertices.
#[test]
fn colours_of_vertices_are_those_of_a_material() {
    let mut scene = Scene { up: [0.0, 1.0, 0.0], ambient: [0.7; 3], ..Scene::default() };
    let mesh = generate::sphere([0.0; 3], 1.0, 12);
    scene.materials = vec![gridwalk_scene::Material { diffuse: [0.25, 0.5, 1.0], ..Default::default() }];
    scene.meshes = vec![Mesh { materials: vec![0; mesh.indices.len()], ..mesh.clone() }];
    let by_material = shoot_still(&scene);
    scene.materials[0].diffuse = [0.5; 3];
    let dull = shoot_still(&scene);
    scene.meshes[0].colours = vec![[0.5, 1.0, 2.0]; mesh.positions.len()];
    let by_colours = shoot_still(&scene);
    let beauty = |layers: &Layers| layers.get("beauty").unwrap().floats().unwrap().to_vec();
    assert!(beauty(&by_material).iter().zip(beauty(&by_colours)).all(|(a, b)| (a - b).abs() <= 1e-6));
    assert!(beauty(&dull) != beauty(&by_colours));
}

/// What is seen through stays so when the arrays are made anew beside it, opacities of vertices included.
#[test]
fn panes_stay_when_key_frames_grow() {
    let keys = [4, 40, 6].map(|segments| generate::sphere([0.0; 3], 0.9, segments));
    let text = "ambient = 0.5\n[[material]]\nname = \"pane\"\nblend = true\ndiffuse = [1, 0, 0]\n[[mesh]]\nsequence = \"key.%04d.obj\"\nfps = 1\n\
                [[mesh]]\nshape = \"quad\"\ncorners = [[-1, -1, 1.5], [1, -1, 1.5], [1, 1, 1.5], [-1, 1, 1.5]]\nmaterial = \"pane\"\n";
    let folder = sequence(&keys, text);
    let open = || {
        let mut animation = animation(folder.path());
        animation.scene.meshes[1].opacities = vec![0.0, 0.25, 1.0, 0.5];
        animation
    };
    let mut run = player(open());
    assert!(run.scene().has_blends());
    let mut reader = run.animation().reader().unwrap();
    let mut grown = 0;
    for (time, key) in [(0.0, 0), (1.0, 1), (2.0, 2), (0.0, 0)] {
        grown += seek(&mut run, time, &[]).grown;
        let mut scene = open().scene;
        scene.meshes[0] = reader.read(0, key).unwrap().mesh;
        assert_same_picture(&format!("key-frame {key}"), &shoot_player(&run), &shoot_still(&scene));
        scene.meshes[1].opacities.clear();
        assert!(differ(&shoot_player(&run), &shoot_still(&scene)), "without opacities it is solid");
    }
    assert!(grown > 0);
}
