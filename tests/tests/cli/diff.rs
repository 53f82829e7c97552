//! `diff`: 0 for equal pictures, 1 for others.

use super::{folder, gridwalk, words};

#[test]
fn status_tells_equal_from_different() {
    let folder = folder();
    for (name, options) in [("a", ""), ("b", ""), ("brighter", "--exposure 0.1"), ("turned", "--azimuth 20")] {
        let line = format!("render two.obj --size 40x30 -o {name}.png -o {name}.exr --aov all {options}");
        gridwalk(folder.path(), words(&line)).expect(0);
    }
    for kind in ["png", "exr"] {
        for metric in ["mse", "max", "ssim"] {
            gridwalk(folder.path(), words(&format!("diff a.{kind} b.{kind} --metric {metric}"))).expect(0);
            gridwalk(folder.path(), words(&format!("diff a.{kind} turned.{kind} --metric {metric}"))).expect(1);
        }
    }
    gridwalk(folder.path(), words("diff a.png brighter.png")).expect(1);
    gridwalk(folder.path(), words("diff a.png brighter.png --metric max --threshold 0.5")).expect(0);
    gridwalk(folder.path(), words("diff a.png brighter.png --metric ssim --threshold 0.2")).expect(0);
    // The EXR is linear and knows nothing of exposure.
    gridwalk(folder.path(), words("diff a.exr brighter.exr")).expect(0);
    gridwalk(folder.path(), words("diff a.exr turned.exr --layer Z,id")).expect(1);
    gridwalk(folder.path(), words("diff a.exr turned.exr --layer Zz")).fails(3, &["did you mean \"Z\""]);

    let text = gridwalk(folder.path(), words("diff a.exr turned.exr")).expect(1).text();
    for layer in ["beauty", "N ", "Ng", "P ", "Z ", "albedo", "debug", "id", "uv"] {
        assert!(text.lines().any(|line| line.starts_with(layer)), "{layer}:\n{text}");
    }
    let json = gridwalk(folder.path(), words("diff a.png turned.png --json")).expect(1).json();
    assert_eq!(json["equal"], false);
    assert!(json["layers"][0]["mean_square"].as_f64().unwrap() > 0.0);
}

#[test]
fn what_cannot_be_compared_is_status_3() {
    let folder = folder();
    gridwalk(folder.path(), words("render two.obj --size 40x30 -o a.png -o a.exr --aov Z")).expect(0);
    gridwalk(folder.path(), words("render two.obj --size 40x31 -o b.png")).expect(0);
    gridwalk(folder.path(), words("render two.obj --size 40x30 -o b.exr")).expect(0);
    gridwalk(folder.path(), words("diff a.png b.png")).fails(3, &["40 x 30", "40 x 31"]);
    gridwalk(folder.path(), words("diff a.png aa.png")).fails(3, &["aa.png", "did you mean a.png"]);
    // A layer that only one has is a difference.
    let run = gridwalk(folder.path(), words("diff a.exr b.exr")).expect(1);
    assert!(run.text().contains("in one picture only"), "{}", run.text());
    gridwalk(folder.path(), words("diff a.exr b.exr --layer beauty")).expect(0);
    gridwalk(folder.path(), words("render two.obj --size 1000x600 -o large.png")).expect(0);
    gridwalk(folder.path(), words("diff large.png large.png --max-size 1")).fails(3, &["large.png", "--max-size"]);
}
