//! Every frame of a run is the frame rendered alone, and at its key-frames it is the key-frame.

use gridwalk_scene::generate;

use super::*;

/// Ten key-frames a second of a sphere that wobbles beside a box and a mirror that stand still.
fn wobbling(count: u32) -> tempfile::TempDir {
    let keys: Vec<Mesh> = (0..count)
        .map(|key| {
            let mut mesh = generate::sphere([0.0, 0.3, 0.0], 0.8, 12);
            let phase = key as f32 * 0.9;
            for p in &mut mesh.positions {
                *p = [p[0] + 0.3 * (phase + 2.0 * p[1]).sin(), p[1] * (1.0 + 0.2 * phase.cos()), p[2]];
            }
            mesh
        })
        .collect();
    sequence(
        &keys,
        "ambient = 0.2\n[[material]]\nname = \"steel\"\ndiffuse = 0.1\nspecular = 0.8\nmirror = true\n\
         [[mesh]]\nsequence = \"key.%04d.obj\"\nfps = 10\nloop = true\n\
         [[mesh]]\nshape = \"box\"\nscale = 0.5\ntranslate = [1.4, 0, 0]\n\
         [[mesh]]\nshape = \"plane\"\nscale = 4\ntranslate = [0, -1, 0]\nmaterial = \"steel\"\n",
    )
}

#[test]
fn each_frame_of_a_run_is_the_frame_rendered_alone() {
    let folder = wobbling(5);
    let mut run = play(folder.path());
    let times: Vec<f64> = (0..12).map(|frame| f64::from(frame) / 24.0).collect();
    let mut pictures = Vec::new();
    for (frame, &time) in times.iter().enumerate() {
        let stats = seek(&mut run, time, &times[frame + 1..]);
        assert!(stats.rebuilt, "frame {frame}");
        pictures.push(shoot_player(&run));
    }
    for (frame, &time) in times.iter().enumerate().rev() {
        let mut alone = play(folder.path());
        seek(&mut alone, time, &[]);
        assert_same_picture(&format!("frame {frame}"), &pictures[frame], &shoot_player(&alone));
    }
    // Backwards and at random, by the same player.
    for frame in [11, 3, 7, 0, 1, 10, 10, 2] {
        let stats = seek(&mut run, times[frame], &[times[(frame * 5) % 12], times[(frame * 7) % 12]]);
        assert_eq!(stats.grown, 0, "frame {frame}");
        assert_same_picture(&format!("frame {frame} again"), &pictures[frame], &shoot_player(&run));
    }
    // Negative control.
    assert!(differ(&pictures[3], &pictures[4]));
}

#[test]
fn at_its_key_frames_it_is_the_key_frame() {
    let folder = wobbling(4);
    let mut run = play(folder.path());
    let moving = animation(folder.path());
    let mut reader = moving.reader().unwrap();
    for key in [0, 3, 1, 2] {
        seek(&mut run, f64::from(key) / 10.0, &[]);
        let mut scene = moving.scene.clone();
        scene.meshes[0] = reader.read(0, key).unwrap().mesh;
        assert_same_picture(&format!("key-frame {key}"), &shoot_player(&run), &shoot_still(&scene));
        let positions = run.scene().read_positions().unwrap();
        let count = scene.meshes[0].positions.len();
        assert_eq!(positions[..count], scene.meshes[0].positions[..]);
    }
}

/// Halfway, vertices lie on the straight line; what is the same in both stays exactly where it is.
#[test]
fn between_key_frames_vertices_go_straight() {
    let a = generate::sphere([0.0; 3], 1.0, 10);
    let mut b = a.clone();
    for p in b.positions.iter_mut().skip(20) {
        p[1] += 2.0;
    }
    let folder = sequence(&[a, b], "[[mesh]]\nsequence = \"key.%04d.obj\"\nfps = 1\n");
    let mut run = play(folder.path());
    let mut reader = run.animation().reader().unwrap();
    let [a, b] = [0, 1].map(|key| reader.read(0, key).unwrap().mesh);
    assert!(a.positions.iter().zip(&b.positions).filter(|(a, b)| a == b).count() > 0);
    for weight in [0.0_f32, 0.25, 0.5, 0.8125, 1.0] {
        seek(&mut run, f64::from(weight), &[]);
        let found = run.scene().read_positions().unwrap();
        for (i, position) in found.iter().enumerate().take(a.positions.len()) {
            let expected = [0, 1, 2].map(|axis| a.positions[i][axis] + (b.positions[i][axis] - a.positions[i][axis]) * weight);
            assert_eq!(*position, expected, "vertex {i} at {weight}");
        }
    }
}

#[test]
fn what_stands_still_is_built_once() {
    let folder = wobbling(3);
    let mut run = play(folder.path());
    assert!(seek(&mut run, 0.1, &[]).rebuilt);
    let again = seek(&mut run, 0.1, &[0.2]);
    assert!(!again.rebuilt && again.key_frames == 0 && again.deform_ms == 0.0, "{again:?}");
    let next = seek(&mut run, 0.2, &[]);
    assert!(next.rebuilt && next.key_frames == 1 && next.read_ms + next.parse_ms > 0.0, "{next:?}");
    let mut still = player(Animation::still(animation(folder.path()).scene));
    let stats = seek(&mut still, 7.0, &[8.0]);
    assert!(!stats.rebuilt && stats.build.report.triangles > 0, "{stats:?}");
    assert_eq!(stats.first_build.map(|build| build.report.triangles), Some(stats.build.report.triangles), "the first seek tells of it");
    assert!(seek(&mut still, 8.0, &[]).first_build.is_none());
}

/// Key-frames that bring materials of their own, late and each time others: whichever were read before, a frame has the same layers, the
/// numbers of materials included.
#[test]
fn materials_that_come_late_have_the_same_numbers_in_every_order() {
    let ball = generate::sphere([0.0; 3], 1.0, 12);
    // Materials of the thirds of each key-frame's triangles; "b" and "d" have other colours in the third library.
    let keys = [["a", "b", "b"], ["b", "c", "d"], ["d", "a", "e"], ["f", "e", "b"], ["c", "c", "c"], ["f", "g", "d"]];
    let mut files: Vec<(String, Vec<u8>)> = Vec::new();
    for (key, names) in keys.iter().enumerate() {
        let text = obj(&moved(ball.clone(), [0.0, 0.1 * key as f32, 0.0]));
        let (vertices, faces) = text.split_at(text.find("f ").unwrap());
        let faces: Vec<&str> = faces.lines().collect();
        let mut text = format!("mtllib {}.mtl\n{vertices}", key / 2);
        for (name, part) in names.iter().zip(faces.chunks(faces.len().div_ceil(3))) {
            writeln!(text, "usemtl {name}\n{}", part.join("\n")).unwrap();
        }
        files.push((format!("key.{key:04}.obj"), text.into_bytes()));
    }
    for library in 0..3 {
        let mut text = String::new();
        for (at, name) in ["a", "b", "c", "d", "e", "f", "g"].iter().enumerate() {
            let late = f64::from(u32::from(library == 2 && at % 2 == 1)) * 0.05;
            writeln!(text, "newmtl {name}\nKd {} 0.5 {late}\nmap_Kd {name}.png", 0.1 * at as f64).unwrap();
        }
        files.push((format!("{library}.mtl"), text.into_bytes()));
    }
    for (at, name) in ["a", "b", "c", "d", "e", "f", "g"].iter().enumerate() {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header().unwrap().write_image_data(&[200, 30 * at as u8, 90]).unwrap();
        files.push((format!("{name}.png"), bytes));
    }
    files.push(("scene.toml".to_owned(), b"[[mesh]]\nsequence = \"key.%04d.obj\"\nfps = 10\n[[mesh]]\nshape = \"box\"\n".to_vec()));
    let folder = folder(&files);
    let numbers = |layers: &Layers| -> std::collections::BTreeSet<u32> {
        layers.get("id").unwrap().uints().unwrap().chunks_exact(3).map(|pixel| pixel[2]).filter(|&number| number != u32::MAX).collect()
    };
    // With frames between key-frames, which are of the first one's materials.
    let times: Vec<f64> = (0..11).map(|frame| f64::from(frame) / 20.0).collect();
    let alone: Vec<Layers> = times
        .iter()
        .map(|&time| {
            let mut run = play(folder.path());
            seek(&mut run, time, &[]);
            shoot_player(&run)
        })
        .collect();
    let mut seen = std::collections::BTreeSet::new();
    for order in [[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10], [10, 2, 6, 4, 9, 0, 8, 7, 1, 3, 5]] {
        let mut run = play(folder.path());
        for frame in order {
            seek(&mut run, times[frame], &[times[(frame + 1) % 11], times[(frame + 3) % 11]]);
            let layers = shoot_player(&run);
            assert_same_picture(&format!("frame {frame}"), &layers, &alone[frame]);
            seen.extend(numbers(&layers));
        }
        // Negative control: in the table, they come in another order.
        let names: Vec<&str> = run.animation().scene.materials.iter().map(|material| material.name.as_str()).collect();
        assert_eq!(names[..3], ["default", "a", "b"], "{names:?}");
        assert!(names.contains(&"g") && names.len() >= 10, "{names:?}");
        assert_eq!(names[3] == "c", order[0] == 0, "{names:?}");
    }
    // a and b are the scene's own; c, d, e, f and g are not, whichever library they come from.
    assert_eq!(
        (seen.range(..3).count(), seen.range(1 << 31..).count(), seen.len()),
        (seen.range(..1 << 31).count(), 5, 5 + seen.range(..3).count())
    );
    assert!(seen.contains(&1) && seen.contains(&2), "{seen:?}");
}

/// A ball that changes its shape by key-frames, goes along a path, turns and is mirrored, at its own rate and on another loop.
#[test]
fn a_mesh_of_key_frames_moves_as_a_whole_too() {
    let keys: Vec<Mesh> = (0..3)
        .map(|key| {
            let mut mesh = generate::sphere([0.0; 3], 0.5, 12);
            mesh.positions.iter_mut().for_each(|p| p[1] *= 1.0 + 0.5 * key as f32);
            mesh
        })
        .collect();
    let folder = sequence(
        &keys,
        "ambient = 0.2\n[[mesh]]\nsequence = \"key.%04d.obj\"\nfps = 10\nloop = true\n[[mesh.key]]\ntime = 0\nscale = [-1, 1, 1]\n\
         [[mesh.key]]\ntime = 1\ntranslate = [1, 0, -2]\nrotate = [0, 0, 90]\nscale = [-2, 1, 1]\n",
    );
    let mut run = play(folder.path());
    assert_eq!(run.animation().duration, 1.0, "the path is the longer");
    let reader = &mut run.animation().reader().unwrap();
    let own: Vec<Mesh> = (0..3).map(|key| reader.read(0, key).unwrap().mesh).collect();
    let times: Vec<f64> = (0..7).map(|frame| f64::from(frame) * 0.2).collect();
    let mut pictures = Vec::new();
    for (frame, &time) in times.iter().enumerate() {
        seek(&mut run, time, &times[frame + 1..]);
        pictures.push(shoot_player(&run));
        let keys = run.animation().keys_at(0, time);
        let (first, second) = (&own[keys.first as usize], &own[keys.second as usize]);
        // Between the two keys all goes straight; after the last it stays.
        let part = time.min(1.0);
        let (sin, cos) = (part * std::f64::consts::FRAC_PI_2).sin_cos();
        let found = run.scene().read_positions().unwrap();
        for (i, found) in found.iter().enumerate().take(first.positions.len()) {
            let p: [f64; 3] = std::array::from_fn(|axis| {
                let (a, b) = (f64::from(first.positions[i][axis]), f64::from(second.positions[i][axis]));
                a + (b - a) * f64::from(keys.weight)
            });
            let x = -(1.0 + part) * p[0];
            let expected = [cos * x - sin * p[1] + part, sin * x + cos * p[1], p[2] - 2.0 * part];
            let error = (0..3).map(|axis| (f64::from(found[axis]) - expected[axis]).abs()).fold(0.0, f64::max);
            assert!(error < 2e-6, "vertex {i} at {time}: {found:?}, expected {expected:?}");
        }
        // Mirrored, but not turned inside out.
        let middle = [part, 0.0, -2.0 * part].map(|value| value as f32);
        let indices = run.scene().read_indices().unwrap();
        let outwards = indices.iter().filter(|corners| {
            let [a, b, c] = corners.map(|corner| found[corner as usize]);
            let minus = |a: [f32; 3], b: [f32; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
            let (u, v, w) = (minus(b, a), minus(c, a), minus(a, middle));
            let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            cross[0] * w[0] + cross[1] * w[1] + cross[2] * w[2] >= 0.0
        });
        assert_eq!(outwards.count(), first.indices.len());
    }
    for frame in [6, 2, 3] {
        let mut alone = play(folder.path());
        seek(&mut alone, times[frame], &[]);
        assert_same_picture(&format!("frame {frame}"), &pictures[frame], &shoot_player(&alone));
    }
    assert!(!seek(&mut run, times[6], &[]).rebuilt);
    // Negative control: it does move between two frames of one key-frame, which here are a loop apart.
    seek(&mut run, 0.3, &[]);
    let early = shoot_player(&run);
    seek(&mut run, 0.6, &[]);
    assert_eq!(run.animation().keys_at(0, 0.3), run.animation().keys_at(0, 0.6));
    assert!(differ(&early, &shoot_player(&run)));
}
