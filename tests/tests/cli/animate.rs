//! `animate`: which frames, into which files, and what becomes of them when something ends it.

use std::fs;
use std::path::Path;

use super::{Run, decode_png, entries, gridwalk, prepared, read_png, words};
use crate::image::movie::{decode_apng, decode_gif, yuv};

/// A triangle with a corner at x.
fn key(x: f32) -> String {
    format!("v 0 0 0\nv {x} 0 0\nv 0 1 0\nf 1 2 3\n")
}

/// A folder with the key-frames `move.0.obj` and so on, but those that are left out, and the still scene `two.obj`.
fn moving(keys: u32, but: &[u32]) -> tempfile::TempDir {
    let folder = super::folder();
    for number in (0..keys).filter(|number| !but.contains(number)) {
        fs::write(folder.path().join(format!("move.{number}.obj")), key(2.0 - 0.25 * number as f32)).unwrap();
    }
    folder
}

const SMALL: &str = "animate move.#.obj --size 20x15 --eye 0.4,0.5,4";

fn animate(folder: &Path, options: &str) -> Run {
    gridwalk(folder, words(&format!("{SMALL} {options}")))
}

/// The JSON lines of a run: those of the frames, and the last one.
#[track_caller]
fn lines(run: &Run) -> (Vec<serde_json::Value>, serde_json::Value) {
    let mut lines: Vec<serde_json::Value> = run.text().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let last = lines.pop().unwrap();
    assert_eq!(last["schema"], "gridwalk.animate/1");
    assert!(lines.iter().all(|line| line["schema"] == "gridwalk.animate.frame/1"));
    assert_eq!(last["frames"].as_u64(), Some(lines.len() as u64));
    (lines, last)
}

fn numbers(lines: &[serde_json::Value]) -> Vec<u64> {
    lines.iter().map(|line| line["frame"].as_u64().unwrap()).collect()
}

fn pixels(folder: &Path, name: &str) -> Vec<u8> {
    read_png(&folder.join(name)).3
}

/// Files of a folder that were not there in the beginning.
fn results(folder: &Path) -> Vec<String> {
    entries(folder).into_iter().filter(|name| !name.ends_with(".obj")).collect()
}

/// The heart of the matter: a frame of a run is the frame rendered alone, in every kind of file; twice the key-frames' rate, so that every
/// second frame lies between two of them.
#[test]
fn a_frame_is_what_it_is_alone() {
    let folder = moving(3, &[]);
    let at = folder.path();
    let run =
        animate(at, "--fps 48 --json --aov Z -o f.%02d.png -o f.##.exr -o m.apng -o m.gif -o m.y4m --chroma 444 --validate").expect(0);
    let (frames, last) = lines(&run);
    assert_eq!(numbers(&frames), [0, 1, 2, 3, 4]);
    assert_eq!(frames[3]["time"].as_f64(), Some(3.0 / 48.0));
    assert_eq!(frames[1]["outputs"], serde_json::json!(["f.01.png", "f.01.exr"]));
    assert_eq!(last["outputs"], serde_json::json!(["f.%02d.png", "f.##.exr", "m.apng", "m.gif", "m.y4m"]));
    assert_eq!((last["interrupted"].as_bool(), last["error"].is_null(), last["skipped"].as_u64()), (Some(false), true, Some(0)));
    for frame in [0, 3] {
        let line = format!("render move.%d.obj --size 20x15 --eye 0.4,0.5,4 --fps 48 --frame {frame} --aov Z -o a.png -o a.exr -q");
        gridwalk(at, words(&line)).expect(0);
        for extension in ["png", "exr"] {
            let name = format!("f.{frame:02}.{extension}");
            let [a, b] = [name.as_str(), &format!("a.{extension}")].map(|name| fs::read(at.join(name)).unwrap());
            // The name of the scene is in the file, and is as long.
            let [a, b] = [a, b].map(|bytes| String::from_utf8_lossy(&bytes).replace("move.%d.obj", "move.#.obj"));
            assert!(a == b || without_text(at, &name) == without_text(at, &format!("a.{extension}")), "frame {frame}, {extension}");
        }
    }
    gridwalk(at, words("render move.%d.obj --size 20x15 --eye 0.4,0.5,4 --time 0.0625 -o t.png -q")).expect(0);
    assert_eq!(pixels(at, "t.png"), pixels(at, "f.03.png"), "a time as good as a number");

    let stills: Vec<Vec<u8>> = (0..5).map(|frame| pixels(at, &format!("f.{frame:02}.png"))).collect();
    for pair in stills.windows(2) {
        assert!(pair[0] != pair[1], "the frames are not all one");
    }
    let movie = decode_apng(&fs::read(at.join("m.apng")).unwrap());
    assert_eq!(movie.len(), 5);
    for (index, ((shown, ms), still)) in movie.iter().zip(&stills).enumerate() {
        let shown: Vec<u8> = shown.chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied().collect();
        assert_eq!(shown, *still, "frame {index} of the animated PNG");
        assert!((ms - 1000.0 / 48.0).abs() < 0.01, "{ms}");
    }
    let movie = decode_gif(&fs::read(at.join("m.gif")).unwrap());
    assert_eq!((movie.len(), movie.iter().map(|frame| frame.1).sum::<u16>()), (5, 10), "five frames take 10.4 hundredths of a second");
    for (index, ((shown, _), still)) in movie.iter().zip(&stills).enumerate() {
        let error = shown.iter().zip(still).map(|(a, b)| f64::from(a.abs_diff(*b)).powi(2)).sum::<f64>() / still.len() as f64;
        assert!(error.sqrt() < 8.0, "frame {index} of the GIF: {}", error.sqrt());
    }
    let movie = fs::read(at.join("m.y4m")).unwrap();
    let header = b"YUV4MPEG2 W20 H15 F48:1 Ip A1:1 C444 XCOLORRANGE=LIMITED XCOLORMATRIX=BT601\n";
    assert!(movie.starts_with(header) && movie.len() == header.len() + 5 * (6 + 900), "{} bytes", movie.len());
    let plane_error = |frame: usize, still: &[u8]| {
        let planes = &movie[header.len() + frame * 906 + 6..][..900];
        let wanted =
            still.chunks_exact(3).map(|pixel| yuv([pixel[0], pixel[1], pixel[2]].map(f64::from), gridwalk_render::image::Matrix::Bt601));
        wanted
            .enumerate()
            .flat_map(|(at, yuv)| (0..3).map(move |plane| (yuv[plane] - f64::from(planes[plane * 300 + at])).abs()))
            .fold(0.0, f64::max)
    };
    for (frame, still) in stills.iter().enumerate() {
        assert!(plane_error(frame, still) < 0.501, "frame {frame}");
    }
    assert!(plane_error(0, &stills[4]) > 5.0, "the comparison tells frames apart");
}

/// A glTF file of an unlit red wall, and an unlit blue pane before it that goes to the right within a second; with a colour of all vertices
/// if wanted.
fn pane(folder: &Path, colour: Option<[f32; 4]>) -> serde_json::Value {
    let corners: [[f32; 3]; 4] = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let mut bytes: Vec<u8> = corners.as_flattened().iter().flat_map(|value| value.to_le_bytes()).collect();
    bytes.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|index| index.to_le_bytes()));
    bytes.extend([0.0_f32, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0].iter().flat_map(|value| value.to_le_bytes()));
    let view = |offset: usize, length: usize| serde_json::json!({ "buffer": 0, "byteOffset": offset, "byteLength": length });
    let accessor = |view: u32, kind: u32, count: u32, width: &str| serde_json::json!({ "bufferView": view, "componentType": kind, "count": count, "type": width });
    let unlit = |colour: [f32; 4], mode: &str| serde_json::json!({ "pbrMetallicRoughness": { "baseColorFactor": colour }, "alphaMode": mode, "extensions": { "KHR_materials_unlit": {} } });
    let primitive =
        |material: u32| serde_json::json!({ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "material": material }] });
    bytes.extend([colour.unwrap_or_default(); 4].as_flattened().iter().flat_map(|value| value.to_le_bytes()));
    let mut json = serde_json::json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0, 1] }],
        "nodes": [{ "mesh": 0, "translation": [0.0, 0.0, -1.0], "scale": [4.0, 4.0, 1.0] }, { "mesh": 1 }],
        "meshes": [primitive(0), primitive(1)],
        "materials": [unlit([1.0, 0.0, 0.0, 0.5], "OPAQUE"), unlit([0.0, 0.0, 1.0, 0.25], "BLEND")],
        "extensionsUsed": ["KHR_materials_unlit"],
        "animations": [{
            "samplers": [{ "input": 2, "output": 3 }],
            "channels": [{ "sampler": 0, "target": { "node": 1, "path": "translation" } }]
        }],
        "bufferViews": [view(0, 48), view(48, 12), view(60, 8), view(68, 24), view(92, 64)],
        "accessors": [accessor(0, 5126, 4, "VEC3"), accessor(1, 5123, 6, "SCALAR"), accessor(2, 5126, 2, "SCALAR"), accessor(3, 5126, 2, "VEC3"), accessor(4, 5126, 4, "VEC4")],
        "buffers": [{ "byteLength": bytes.len(), "uri": "pane.bin" }]
    });
    if colour.is_some() {
        for mesh in 0..2 {
            json["meshes"][mesh]["primitives"][0]["attributes"]["COLOR_0"] = 4.into();
        }
    }
    fs::write(folder.join("pane.gltf"), json.to_string()).unwrap();
    fs::write(folder.join("pane.bin"), bytes).unwrap();
    json
}

/// The base colour of an unlit surface is multiplied by that of its vertices, solid or seen through; what a surface emits otherwise is not.
#[test]
fn the_colours_of_vertices_are_those_of_unlit_surfaces() {
    let folder = super::folder();
    let at = folder.path();
    let render = || {
        gridwalk(at, words("render pane.gltf --size 16x12 --eye 0,0,6 --time 0 -o a.exr -q")).expect(0);
        let layers = gridwalk_render::image::read(&at.join("a.exr"), gridwalk_render::image::ReadLimits::default()).unwrap();
        let beauty = layers.get("beauty").unwrap().floats().unwrap().to_vec();
        // Through the pane, and beside it.
        [7, 1].map(|x| [0, 1, 2].map(|channel| beauty[(6 * 16 + x) * 4 + channel]))
    };
    pane(at, None);
    assert_eq!(render(), [[0.75, 0.0, 0.25], [1.0, 0.0, 0.0]]);
    let mut json = pane(at, Some([0.5, 1.0, 0.25, 0.5]));
    assert_eq!(render(), [[0.5 * 0.875, 0.0, 0.25 * 0.125], [0.5, 0.0, 0.0]], "the alpha too, where it blends");
    pane(at, Some([0.0, 1.0, 1.0, 1.0]));
    assert_eq!(render(), [[0.0, 0.0, 0.25], [0.0; 3]]);
    // Negative control: a wall that is black, and emits red.
    json["materials"][0] = serde_json::json!({ "emissiveFactor": [1, 0, 0], "pbrMetallicRoughness": { "baseColorFactor": [0, 0, 0, 1] } });
    fs::write(at.join("pane.gltf"), json.to_string()).unwrap();
    assert_eq!(render()[1], [1.0, 0.0, 0.0]);
}

/// What glTF says of `BLEND`: a quarter of blue over three quarters of red, and all red beside it; and it moves.
#[test]
fn a_pane_is_seen_through_and_each_frame_is_the_one_rendered_alone() {
    let folder = super::folder();
    let at = folder.path();
    pane(at, None);
    let options = "--size 16x12 --eye 0,0,6";
    let run =
        gridwalk(at, words(&format!("animate pane.gltf {options} --fps 2 --frames 0..2 --aov id,depth -o f#.exr -o f#.png"))).expect(0);
    assert!(!run.stderr.contains("BLEND"), "nothing is told of it: {}", run.stderr);
    for frame in 0..3 {
        gridwalk(at, words(&format!("render pane.gltf {options} --fps 2 --frame {frame} --aov id,depth -o alone.exr -o alone.png")))
            .expect(0);
        assert_eq!(without_text(at, "alone.exr"), without_text(at, &format!("f{frame}.exr")), "frame {frame}");
        assert_eq!(pixels(at, "alone.png"), pixels(at, &format!("f{frame}.png")), "frame {frame}");
        let layers = gridwalk_render::image::read(&at.join("alone.exr"), gridwalk_render::image::ReadLimits::default()).unwrap();
        let beauty = layers.get("beauty").unwrap().floats().unwrap().to_vec();
        let pixel = |x: usize, y: usize| [0, 1, 2].map(|channel| beauty[(y * 16 + x) * 4 + channel]);
        assert_eq!(pixel(7, 6), [[0.75, 0.0, 0.25], [0.75, 0.0, 0.25], [1.0, 0.0, 0.0]][frame], "frame {frame}");
    }
    assert_ne!(pixels(at, "f0.png"), pixels(at, "f2.png"));
}

#[test]
fn the_automatic_camera_is_one_for_all_frames() {
    let folder = super::folder();
    let at = folder.path();
    pane(at, None);
    gridwalk(at, words("animate pane.gltf --size 16x12 --fps 2 --frames 0..2 -o f#.png")).expect(0);
    for (frame, time) in ["0", "0.5", "1"].into_iter().enumerate() {
        gridwalk(at, words(&format!("render pane.gltf --size 16x12 --time {time} -o alone.png"))).expect(0);
        assert_eq!(pixels(at, "alone.png"), pixels(at, &format!("f{frame}.png")), "{time}");
    }
    assert_ne!(pixels(at, "f0.png"), pixels(at, "f2.png"));
}

/// A camera of glTF has a direction alone: it turns about the scene's middle, however far from the origin both are.
#[test]
fn a_camera_without_a_target_turns_about_what_there_is() {
    let folder = super::folder();
    let at = folder.path();
    pane(at, None);
    let mut json: serde_json::Value = serde_json::from_str(&fs::read_to_string(at.join("pane.gltf")).unwrap()).unwrap();
    let nodes = json["nodes"].as_array_mut().unwrap();
    nodes.push(serde_json::json!({ "children": [0, 1], "translation": [400.0, 5.0, -30.0] }));
    nodes.push(serde_json::json!({ "camera": 0, "translation": [400.0, 5.0, -10.0] }));
    json["scenes"][0]["nodes"] = serde_json::json!([2, 3]);
    json["cameras"] = serde_json::json!([{ "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.1 } }]);
    fs::write(at.join("pane.gltf"), json.to_string()).unwrap();

    // Where the wall is, of 40 x 30: its middle, and how many pixels it has.
    let wall = |name: &str| {
        let pixels = pixels(at, name);
        let seen: Vec<usize> = pixels.chunks_exact(3).enumerate().filter(|(_, rgb)| rgb[1] < 60).map(|(pixel, _)| pixel).collect();
        let middle = |part: fn(usize) -> usize| seen.iter().map(|&pixel| part(pixel) as f64 + 0.5).sum::<f64>() / seen.len() as f64;
        ([middle(|pixel| pixel % 40), middle(|pixel| pixel / 40)], seen.len())
    };
    gridwalk(at, words("render pane.gltf --size 40x30 -o still.png")).expect(0);
    gridwalk(at, words("animate pane.gltf --size 40x30 --turntable 2 --fps 4 -o f#.png")).expect(0);
    assert_eq!(pixels(at, "f0.png"), pixels(at, "still.png"), "a turn begins where the camera stands");
    // From the side there is nothing of it to be seen.
    for frame in [0, 1, 3, 4, 5, 7] {
        let (middle, count) = wall(&format!("f{frame}.png"));
        assert!((middle[0] - 20.0).abs() < 2.0 && (middle[1] - 15.0).abs() < 1.0 && count > 100, "frame {frame}: {count} about {middle:?}");
    }
    // What stands in the middle has its size in parallel projection, too.
    gridwalk(at, words("render pane.gltf --size 40x30 --ortho -o ortho.png")).expect(0);
    let [(_, still), (_, ortho)] = [wall("still.png"), wall("ortho.png")];
    assert!(still.abs_diff(ortho) < 50, "{still} and {ortho} pixels");
}

/// The decoded pixels of a file, all layers.
fn without_text(folder: &Path, name: &str) -> Vec<(String, gridwalk_render::LayerData)> {
    let layers = gridwalk_render::image::read(&folder.join(name), gridwalk_render::image::ReadLimits::default()).unwrap();
    layers.iter().map(|layer| (layer.name.clone(), layer.data.clone())).collect()
}

#[test]
fn ranges_steps_and_patterns() {
    let folder = moving(8, &[]);
    let at = folder.path();
    for (options, files) in [
        ("--frames 1..5:2 -o {frame:03}.png", &["001.png", "003.png", "005.png"][..]),
        ("--frames 6.. -o x_%d.png", &["x_6.png", "x_7.png"]),
        ("--frames 4 -o one.png", &["one.png"]),
        ("--duration 0.1 -o #.png", &["0.png", "1.png"]),
        ("--fps 6 --format png -o %d.data", &["0.data", "1.data"]),
        ("--frames 2..3", &["move.apng"]),
        ("--frames 2..3 --format apng -o two.png", &["two.png"]),
        ("--frames 3..3 --format png", &["move.0003.png"]),
    ] {
        let run = animate(at, options).expect(0);
        assert!(run.stdout.is_empty());
        assert_eq!(results(at), files, "{options}");
        for name in files {
            fs::remove_file(at.join(name)).unwrap();
        }
    }
    // A movie of every second frame lasts as long.
    animate(at, "--frames 0..6:2 -o m.gif").expect(0);
    let movie = decode_gif(&fs::read(at.join("m.gif")).unwrap());
    assert_eq!((movie.len(), movie.iter().map(|frame| frame.1).sum::<u16>()), (4, 33));
}

#[test]
fn what_is_there_is_skipped_or_kept() {
    let folder = moving(4, &[]);
    let at = folder.path();
    fs::write(at.join("f1.png"), "theirs").unwrap();
    animate(at, "-o f#.png --overwrite never").fails(7, &["f1.png exists"]);
    assert_eq!(results(at), ["f1.png"]);
    let (frames, last) = lines(&animate(at, "-o f#.png --skip-existing --json").expect(0));
    assert_eq!((numbers(&frames), last["skipped"].as_u64()), (vec![0, 2, 3], Some(1)));
    assert_eq!(fs::read(at.join("f1.png")).unwrap(), b"theirs");
    let (frames, last) = lines(&animate(at, "-o f#.png --skip-existing --overwrite never --json").expect(0));
    assert_eq!((frames.len(), last["skipped"].as_u64()), (0, Some(4)));
    // The movie wants every frame; the pictures that are there stay.
    let (frames, _) = lines(&animate(at, "-o f#.png -o m.apng --skip-existing --json").expect(0));
    assert_eq!(numbers(&frames), [0, 1, 2, 3]);
    assert!(frames.iter().all(|frame| frame["outputs"] == serde_json::json!([])));
    assert_eq!(decode_apng(&fs::read(at.join("m.apng")).unwrap()).len(), 4);
    animate(at, "-o f#.png").expect(0);
    assert_ne!(fs::read(at.join("f1.png")).unwrap(), b"theirs");
}

#[test]
fn a_turntable_turns_once() {
    let folder = moving(0, &[]);
    let at = folder.path();
    gridwalk(at, words("animate two.obj --size 20x15")).fails(2, &["does not move", "--turntable"]);
    gridwalk(at, words("animate two.obj --size 20x15 --turntable 1 --fps 4 --frames 0..4 -o f#.png")).expect(0);
    let frames: Vec<Vec<u8>> = (0..5).map(|frame| pixels(at, &format!("f{frame}.png"))).collect();
    assert_eq!(frames[0], frames[4], "after a whole turn all is as before");
    assert!(frames[..4].iter().enumerate().all(|(index, frame)| !frames[..index].contains(frame)), "no two sides look alike");
    let (frames, last) = lines(&gridwalk(at, words("animate two.obj --size 20x15 --turntable 0.5 --fps 4 --json")).expect(0));
    assert_eq!((numbers(&frames), last["outputs"].clone()), (vec![0, 1], serde_json::json!(["two.apng"])));
    assert!(frames[1..].iter().all(|frame| frame["rebuilt"] == false), "a camera that moves changes no grid");
    assert!(frames.iter().all(|frame| frame["build_steps"] == serde_json::json!([])), "the only grid was built before the first frame");
    assert_eq!(last["rebuilt"].as_u64(), Some(0));
    let run = gridwalk(at, words("animate two.obj --size 20x15 --turntable 0.5 --fps 4 --json --stats")).expect(0);
    assert!(!run.text().contains("-0.0") && !run.stderr.contains("-0.0"), "{}{}", run.text(), run.stderr);
    // Named cameras turn too.
    let run = gridwalk(at, words("animate two.obj --size 20x15 --eye 0.4,0.5,4 --turntable 1 --fps 2 -o t#.png"));
    run.expect(0);
    gridwalk(at, words("render two.obj --size 20x15 --eye 0.4,0.5,4 -o r.png")).expect(0);
    assert_eq!(pixels(at, "t0.png"), pixels(at, "r.png"), "a turn begins where the camera stands");
    assert_ne!(pixels(at, "t1.png"), pixels(at, "r.png"));
}

/// The first frame has nothing before it that it could hide behind, and is not charged with what was done before it.
#[test]
fn times_are_those_of_their_frame() {
    let folder = moving(4, &[]);
    for options in ["", "--frames 2..3", "--fps 48 --frames 1..4"] {
        let run = animate(folder.path(), &format!("-o m.apng --json --stats {options}")).expect(0);
        let (frames, last) = lines(&run);
        let ms = |line: &serde_json::Value, name: &str| line[name].as_f64().unwrap();
        assert!(ms(&last, "open_ms") > 0.0 && run.stderr.contains("before   the first frame: "), "{}", run.stderr);
        assert!(ms(&last, "setup_ms") >= last["first_build_ms"].as_f64().unwrap_or(0.0));
        assert_eq!(ms(&frames[0], "hidden_ms"), 0.0, "{}", frames[0]);
        for frame in &frames {
            let names: Vec<&str> = frame["build_steps"].as_array().unwrap().iter().map(|step| step["name"].as_str().unwrap()).collect();
            assert!(frame["rebuilt"] == true && names.iter().enumerate().all(|(at, name)| !names[..at].contains(name)), "{names:?}");
            let parts: f64 = ["rebuild_ms", "trace_ms", "shade_ms", "deform_ms"].iter().filter_map(|name| frame[name].as_f64()).sum();
            assert!(parts + ms(frame, "readback_ms") + ms(frame, "wait_ms") <= ms(frame, "frame_ms"), "{frame}");
            // Both are sums, in another order.
            assert!(ms(frame, "hidden_ms") <= ms(frame, "disk_ms") + ms(frame, "parse_ms") + ms(frame, "upload_ms") + 1e-9, "{frame}");
        }
        for name in ["disk_ms", "parse_ms", "upload_ms", "hidden_ms", "wait_ms", "encode_ms", "frame_ms"] {
            let sum: f64 = frames.iter().map(|frame| ms(frame, name)).sum();
            assert!((sum - ms(&last, name)).abs() < 1e-6, "{name}: {sum} and {}", last[name]);
        }
        assert!(ms(&last, "open_ms") + ms(&last, "setup_ms") + ms(&last, "frame_ms") <= ms(&last, "wall_s") * 1e3, "{last}");
    }
}

#[test]
fn standard_output_is_a_movie() {
    let folder = moving(3, &[]);
    let at = folder.path();
    let run = animate(at, "-o -").expect(0);
    assert!(run.stdout.starts_with(b"YUV4MPEG2 W20 H15 F24:1 Ip A1:1 C420jpeg "));
    let header = run.stdout.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    assert_eq!(run.stdout.len() - header, 3 * (6 + 300 + 2 * 80), "odd sides are rounded up");
    let run = animate(at, "-o - --format apng --frames 0..1 --stats -v").expect(0);
    assert_eq!(decode_apng(&run.stdout).len(), 2);
    for word in ["disk", "parse", "upload", "hidden", "rebuild", "trace", "shade", "read-back", "encode", "all (ms)", "frames a second"] {
        assert!(run.stderr.contains(word), "no \"{word}\" in\n{}", run.stderr);
    }
    assert_eq!(results(at), [""; 0]);
}

/// All frames before it are written, movies end with them, and the file is named.
#[test]
fn a_key_frame_that_is_missing_or_broken() {
    let folder = moving(5, &[3]);
    let at = folder.path();
    let run = animate(at, "-o f#.png -o m.apng --json").expect(3);
    for word in ["frame 3", "move.3.obj"] {
        assert!(run.stderr.contains(word), "no \"{word}\" in {}", run.stderr);
    }
    let (frames, last) = lines(&run);
    assert_eq!(numbers(&frames), [0, 1, 2]);
    assert!(last["error"].as_str().unwrap().contains("move.3.obj"));
    assert_eq!(results(at), ["f0.png", "f1.png", "f2.png", "m.apng"]);
    assert_eq!(decode_apng(&fs::read(at.join("m.apng")).unwrap()).len(), 3);
    fs::write(at.join("move.3.obj"), "v 0 0 0\nv 1 0 0\nv 0 1\nf 1 2 3\n").unwrap();
    animate(at, "-o g#.png").fails(3, &["frame 3", "move.3.obj:3"]);
    assert_eq!(results(at), ["f0.png", "f1.png", "f2.png", "g0.png", "g1.png", "g2.png", "m.apng"]);
    // Frames that do not need it are none the worse.
    animate(at, "-o h#.png --frames 4").expect(0);
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_after_the_frame() {
    for (signal, status) in [("INT", 130), ("TERM", 143)] {
        interrupted(signal, status);
    }
}

#[cfg(unix)]
fn interrupted(signal: &str, status: i32) {
    use std::io::{BufRead, BufReader};
    use std::process::Stdio;
    let folder = moving(0, &[]);
    let at = folder.path();
    let line = "animate two.obj --size 200x150 --turntable 10000 --fps 50 --json -o f#.png -o m.gif -o m.apng";
    let mut child = prepared(at, words(line)).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut reader = BufReader::new(child.stdout.take().unwrap());
    let mut text = String::new();
    reader.read_line(&mut text).unwrap();
    // From here on it has 499,999 frames to go.
    let kill = std::process::Command::new("kill").args(["-s", signal, &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    for line in reader.lines() {
        text.push_str(&line.unwrap());
        text.push('\n');
    }
    let mut output = child.wait_with_output().unwrap();
    output.stdout = text.into_bytes();
    let run = Run::new(line.to_owned(), output).expect(status);
    let (frames, last) = lines(&run);
    assert!(run.stderr.contains("interrupted") && last["interrupted"] == true, "{}", run.stderr);
    let count = frames.len();
    assert_eq!(numbers(&frames), (0..count as u64).collect::<Vec<_>>());
    let mut expected: Vec<String> = (0..count).map(|frame| format!("f{frame}.png")).chain(["m.apng".into(), "m.gif".into()]).collect();
    expected.sort();
    assert_eq!(results(at), expected, "every frame that was told of, and no half file");
    assert_eq!(decode_gif(&fs::read(at.join("m.gif")).unwrap()).len(), count);
    let movie = decode_apng(&fs::read(at.join("m.apng")).unwrap());
    assert_eq!(movie.len(), count);
    let (_, _, _, still) = decode_png(&fs::read(at.join(format!("f{}.png", count - 1))).unwrap());
    assert!(movie[count - 1].0.chunks_exact(4).flat_map(|pixel| &pixel[..3]).eq(&still));
}

/// The first signal ends after the frame at hand, which here lasts for ever; the second at once, without a trace.
#[cfg(unix)]
#[test]
fn a_second_interrupt_does_not_wait() {
    use std::io::{BufRead, BufReader};
    use std::process::Stdio;
    let folder = moving(0, &[]);
    let at = folder.path();
    for (first, second, status) in [("INT", "INT", 130), ("TERM", "INT", 130), ("INT", "TERM", 143)] {
        let line = "animate two.obj --turntable 10 --spp 65536 -o f#.png -o m.gif -o m.apng -o m.y4m -v";
        let mut child = prepared(at, words(line)).stderr(Stdio::piped()).spawn().unwrap();
        let id = child.id().to_string();
        let signal = |name: &str| {
            let kill = std::process::Command::new("kill").args(["-s", name, &id]).status().unwrap();
            assert!(kill.success());
        };
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map(|line| line.unwrap());
        assert!(lines.any(|line| line.contains("info: grid of")));
        assert_eq!(entries(at).iter().filter(|name| name.ends_with(".part")).count(), 3, "{:?}", entries(at));
        signal(first);
        assert!(lines.any(|line| line.contains("ending after this frame")));
        signal(second);
        assert_eq!(child.wait().unwrap().code(), Some(status));
        assert_eq!(entries(at), ["two.obj"]);
    }
}

/// Resident memory of the program does not grow with the number of frames.
#[cfg(target_os = "linux")]
#[test]
fn a_long_run_takes_no_more_memory() {
    use std::io::{BufRead, BufReader};
    use std::process::Stdio;
    let folder = moving(7, &[]);
    let at = folder.path();
    let line = format!("{SMALL} --fps 480 --duration 10 --json -o m.apng -o f#.png --overwrite always");
    let mut child = prepared(at, words(&line)).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let resident = |id: u32| -> i64 {
        let text = fs::read_to_string(format!("/proc/{id}/statm")).unwrap();
        text.split_whitespace().nth(1).unwrap().parse::<i64>().unwrap() * 4
    };
    let mut seen = Vec::new();
    for line in BufReader::new(child.stdout.take().unwrap()).lines().take(301) {
        let line: serde_json::Value = serde_json::from_str(&line.unwrap()).unwrap();
        assert!(seen.len() < 20 || line["grown"] == 0, "{line}");
        seen.push(resident(child.id()));
    }
    std::process::Command::new("kill").args(["-s", "INT", &child.id().to_string()]).status().unwrap();
    child.wait().unwrap();
    let most = |hundred: usize| *seen[100 * hundred..][..100].iter().max().unwrap();
    assert!(most(2) - most(1) < 8 << 10, "KiB after each frame: {seen:?}");
}

/// A program that notes its arguments and keeps what it gets in the file that it is told to write.
#[cfg(unix)]
fn fake_ffmpeg(folder: &Path, script: &str) {
    use std::os::unix::fs::PermissionsExt;
    fs::create_dir_all(folder.join("bin")).unwrap();
    let path = folder.join("bin/ffmpeg");
    // A file that is open for writing cannot be run; whoever is forked meanwhile holds it open.
    fs::write(folder.join("bin/new"), format!("#!/bin/sh\n[ \"$1\" = -version ] && exit 0\n{script}\n")).unwrap();
    fs::set_permissions(folder.join("bin/new"), fs::Permissions::from_mode(0o755)).unwrap();
    std::process::Command::new("cp").arg("-p").arg(folder.join("bin/new")).arg(&path).status().unwrap();
}

#[cfg(unix)]
fn with_path(folder: &Path, options: &str, path: &str) -> Run {
    let line = format!("{SMALL} --frames 0..2 {options}");
    let output = prepared(folder, words(&line)).env("PATH", path).output().unwrap();
    Run::new(line, output)
}

#[cfg(unix)]
#[test]
fn video_goes_through_ffmpeg() {
    let folder = moving(3, &[]);
    let at = folder.path();
    let path = format!("{}:/usr/bin:/bin", at.join("bin").display());
    fake_ffmpeg(at, &format!("echo \"$@\" > {0}/arguments\nfor last; do :; done\ncat > \"$last\"", at.join("bin").display()));
    for (name, containers) in [("a.mp4", "-f mp4"), ("a.mkv", "-f matroska"), ("a.webm", "-f webm")] {
        with_path(at, &format!("--size 20x16 -o {name}"), &path).expect(0);
        let bytes = fs::read(at.join(name)).unwrap();
        assert!(bytes.starts_with(b"YUV4MPEG2 W20 H16 F24:1 Ip A1:1 C420jpeg XCOLORRANGE=LIMITED XCOLORMATRIX=BT709\n"));
        assert_eq!(bytes.windows(6).filter(|bytes| bytes == b"FRAME\n").count(), 3);
        let arguments = fs::read_to_string(at.join("bin/arguments")).unwrap();
        for part in ["-f yuv4mpegpipe -i -", "-colorspace bt709", "-pix_fmt yuv420p", containers] {
            assert!(arguments.contains(part), "no {part} in {arguments}");
        }
        fs::remove_file(at.join(name)).unwrap();
    }
    with_path(at, "-o a.mp4", &path).fails(2, &["a.mp4", "--size 20x16", "--chroma 444"]);
    with_path(at, "-o a.mp4 --chroma 444", &path).expect(0);
    fs::remove_file(at.join("a.mp4")).unwrap();

    for script in ["echo Unknown encoder >&2; exit 1", "cat > /dev/null; echo Unknown encoder >&2; exit 8"] {
        fake_ffmpeg(at, script);
        with_path(at, "--size 20x16 -o a.mp4", &path).fails(7, &["a.mp4", "ffmpeg", "Unknown encoder"]);
    }
    with_path(at, "-o a.gif -o a.mkv --size 20x16", &at.join("nothing").display().to_string())
        .fails(7, &["a.mkv", "not installed", ".apng"]);
    assert_eq!(results(at), ["bin"], "what failed leaves nothing");
}

/// With the real program, where it is installed: what it makes is decoded by it again, and is the pictures.
#[cfg(unix)]
#[test]
fn video_can_be_played() {
    let ffmpeg =
        |arguments: &[&str]| std::process::Command::new("ffmpeg").args(["-hide_banner", "-loglevel", "error"]).args(arguments).output();
    let Ok(encoders) = ffmpeg(&["-encoders"]) else {
        eprintln!("skipped: ffmpeg is not installed");
        return;
    };
    let encoders = String::from_utf8_lossy(&encoders.stdout).into_owned();
    // The last ones are far smaller.
    let folder = moving(8, &[1, 2, 3, 4]);
    let at = folder.path();
    for (key, name) in [5, 6, 7].into_iter().zip(1..) {
        fs::rename(at.join(format!("move.{key}.obj")), at.join(format!("move.{name}.obj"))).unwrap();
    }
    animate(at, "--size 64x48 -o f#.png").expect(0);
    let stills: Vec<Vec<u8>> = (0..4).map(|frame| pixels(at, &format!("f{frame}.png"))).collect();
    for (name, encoder) in [("a.mp4", "libx264"), ("a.mkv", "libx264"), ("a.webm", "libvpx-vp9")] {
        if !encoders.contains(encoder) {
            eprintln!("skipped: ffmpeg has no {encoder}");
            continue;
        }
        animate(at, &format!("--size 64x48 --chroma 444 -o {name}")).expect(0);
        let path = at.join(name);
        let decoded = ffmpeg(&["-i", path.to_str().unwrap(), "-f", "rawvideo", "-pix_fmt", "rgb24", "-vsync", "0", "-"]).unwrap();
        assert!(decoded.status.success(), "{name}: {}", String::from_utf8_lossy(&decoded.stderr));
        assert_eq!(decoded.stdout.len(), 4 * 64 * 48 * 3, "{name}");
        let error = |frame: &[u8], still: &[u8]| {
            let sum: f64 = frame.iter().zip(still).map(|(a, b)| (f64::from(*a) - f64::from(*b)).abs()).sum();
            sum / still.len() as f64
        };
        for (index, (frame, still)) in decoded.stdout.chunks_exact(64 * 48 * 3).zip(&stills).enumerate() {
            assert!(error(frame, still) < 3.0, "{name}, frame {index}: {}", error(frame, still));
        }
        let first = &decoded.stdout[..64 * 48 * 3];
        assert!(error(first, &stills[3]) > 1.5 * error(first, &stills[0]), "the comparison tells frames apart");
    }
}

#[test]
fn wrong_usage_is_status_2() {
    let folder = moving(3, &[]);
    let at = folder.path();
    for (options, said) in [
        ("-o a.png", &["a.%04d.png", "--format apng"][..]),
        ("-o a.exr", &["a.%04d.exr"]),
        ("-o a.jpg", &["a.jpg", ".apng", "--format"]),
        ("-o a%d#.png", &["two places"]),
        ("-o a%d.gif", &["one file"]),
        ("-o a.gif -o a.gif", &["twice"]),
        ("-o - --json", &["standard output"]),
        ("-o - --format png", &["y4m"]),
        ("-o - --format mp4", &["y4m"]),
        ("-o a.gif --fps 60", &["50 frames a second", ".apng"]),
        ("-o a.gif --transparent", &["alpha", ".apng"]),
        ("-o a.mp4 --transparent", &["alpha"]),
        ("-o a.apng --aov Z", &["EXR"]),
        ("-o a#.exr --heatmap steps", &["PNG"]),
        ("--frames 5..2", &["2..5"]),
        ("--frames x", &["0..99"]),
        ("--frames 99..", &["the last frame is 2"]),
        ("--frames 0..5 --duration 2", &["--duration"]),
        ("--fps 0", &["24000/1001"]),
        ("--turntable 0", &["above 0"]),
    ] {
        animate(at, options).fails(2, said);
    }
    gridwalk(at, words("animate move.#.obj --camera x")).fails(2, &["no camera"]);
    gridwalk(at, words("render two.obj -o a.gif")).fails(2, &["gridwalk animate"]);
    gridwalk(at, words("render two.obj --time 1 --frame 2")).fails(2, &["--frame"]);
    animate(at, "-o none/f%d.png").fails(7, &["none/f0.png", "make the folder first"]);
    animate(at, "-o none/a.gif").fails(7, &["none/a.gif", "make the folder first"]);
    animate(at, "--clip walk").fails(3, &["walk"]);
    assert_eq!(results(at), [""; 0]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_ends_it() {
    let folder = moving(3, &[]);
    let at = folder.path();
    for name in ["full.y4m", "full.apng", "full0.png"] {
        std::os::unix::fs::symlink("/dev/full", at.join(name)).unwrap();
    }
    for output in ["full.y4m", "full.apng", "full%d.png"] {
        animate(at, &format!("-o {output}")).fails(7, &["full", "make room"]);
    }
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let line = format!("{SMALL} -o -");
    let output = prepared(at, words(&line)).stdout(full).output().unwrap();
    Run::new(line, output).fails(7, &["standard output"]);
    assert_eq!(results(at), ["full.apng", "full.y4m", "full0.png"]);
}

#[test]
fn information_tells_what_moves() {
    let folder = moving(3, &[]);
    let at = folder.path();
    let info = gridwalk(at, words("info move.#.obj --json")).expect(0).json();
    assert_eq!((info["animation"]["frames"].as_u64(), info["animation"]["fps"].as_f64()), (Some(3), Some(24.0)));
    assert_eq!((info["meshes"][0]["motion"].as_str(), info["meshes"][0]["key_frames"].as_u64()), (Some("key-frames"), Some(3)));
    let text = gridwalk(at, words("info move.#.obj")).expect(0).text();
    assert!(text.contains("3 frames at 24 a second") && text.contains("moves by 3 key-frames"), "{text}");
    let still = gridwalk(at, words("info two.obj --json")).expect(0).json();
    assert_eq!((still["animation"].is_null(), still["meshes"][0]["motion"].as_str()), (true, Some("still")));
    assert_eq!(gridwalk(at, words("list clips move.#.obj")).expect(0).text(), "");
    assert_eq!(gridwalk(at, words("animate move.#.obj --list-clips")).expect(0).text(), "");
}
