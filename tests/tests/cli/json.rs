//! `--json` and docs/json.md say the same.

use std::collections::BTreeSet;

use super::{folder, gridwalk, words};

/// The fields that a section of the document lists, each with its type.
fn documented(section: &str) -> Vec<(String, String)> {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/json.md")).unwrap();
    let part =
        text.split("\n## ").find(|part| part.starts_with(section)).unwrap_or_else(|| panic!("docs/json.md has no section {section}"));
    let rows = part.lines().filter_map(|line| line.strip_prefix("| `"));
    rows.map(|row| {
        let (name, rest) = row.split_once("` | ").unwrap();
        (name.to_owned(), rest.split(" |").next().unwrap().to_owned())
    })
    .collect()
}

fn has_type(value: &serde_json::Value, kind: &str) -> bool {
    if let Some(kind) = kind.strip_suffix(" or null") {
        return value.is_null() || has_type(value, kind);
    }
    let all = |test: fn(&serde_json::Value) -> bool| value.as_array().is_some_and(|array| array.iter().all(test));
    match kind {
        "string" => value.is_string(),
        "integer" => value.is_u64(),
        "number" => value.is_number(),
        "boolean" => value.is_boolean(),
        "object" => value.is_object(),
        "2 integers" => all(serde_json::Value::is_u64) && value.as_array().unwrap().len() == 2,
        "3 integers" => all(serde_json::Value::is_u64) && value.as_array().unwrap().len() == 3,
        "2 x 3 numbers" => {
            value.as_array().is_some_and(|rows| rows.len() == 2 && rows.iter().all(|row| row.as_array().unwrap().len() == 3))
        }
        "array of strings" => all(serde_json::Value::is_string),
        "array of objects" => all(serde_json::Value::is_object),
        other => panic!("docs/json.md uses a type that is not known here: {other}"),
    }
}

/// `absent` are fields that the document allows to be missing, and that are.
#[track_caller]
fn check(section: &str, value: &serde_json::Value, absent: &[&str]) {
    let documented = documented(section);
    let listed: BTreeSet<&str> = documented.iter().map(|(name, _)| name.as_str()).filter(|name| !absent.contains(name)).collect();
    let printed: BTreeSet<&str> = value.as_object().unwrap().keys().map(String::as_str).collect();
    assert_eq!(listed, printed, "docs/json.md, section {section}, and what is printed");
    for (name, kind) in documented.iter().filter(|(name, _)| printed.contains(name.as_str())) {
        assert!(has_type(&value[name], kind), "{section}: {name} is {}, not {kind}", value[name]);
    }
}

#[test]
fn render() {
    let folder = folder();
    let json = gridwalk(folder.path(), words("render two.obj --size 32x24 --spp 4 --json -v")).expect(0).json();
    check("`gridwalk render`", &json, &["heatmap"]);
    assert_eq!(json["schema"], "gridwalk.render/1");
    assert_eq!((json["triangles"].as_u64(), json["dropped"].as_u64(), json["spp"].as_u64()), (Some(2), Some(0), Some(4)));
    assert_eq!(json["size"], serde_json::json!([32, 24]));
    assert_eq!(json["outputs"], serde_json::json!(["two.png"]));
    assert!(json["rays"].as_u64().unwrap() >= 32 * 24 * 4);
    let cells: u64 = json["resolution"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap()).product();
    assert_eq!(json["cells"].as_u64(), Some(cells));
    // Parts are rounded up to the alignment of 64 bytes each.
    let parts: Vec<u64> = json["buffers"].as_array().unwrap().iter().map(|part| part["bytes"].as_u64().unwrap()).collect();
    let (sum, whole) = (parts.iter().sum::<u64>(), json["grid_bytes"].as_u64().unwrap() + json["scratch_bytes"].as_u64().unwrap());
    assert!(sum <= whole && whole <= sum + 64 * parts.len() as u64, "{parts:?} come to {sum}, not to {whole}");
    let kinds: BTreeSet<&str> = json["build_steps"].as_array().unwrap().iter().map(|step| step["kind"].as_str().unwrap()).collect();
    assert!(kinds.is_subset(&BTreeSet::from(["map", "cooperative"])), "{kinds:?}");

    let json =
        gridwalk(folder.path(), words("render two.obj --size 32x24 --heatmap tests --resolution 3x4x5 --repeat 3 --json")).expect(0).json();
    check("`gridwalk render`", &json, &[]);
    assert_eq!(json["resolution"], serde_json::json!([3, 4, 5]));
    assert_eq!((json["repeat"].as_u64(), json["heatmap"]["count"].as_str()), (Some(3), Some("tests")));
}

#[test]
fn animate() {
    let folder = folder();
    let line = "animate two.obj --size 16x12 --turntable 0.5 --fps 4 --json -o f#.png";
    for (options, absent) in [("", &["heatmap"][..]), (" --heatmap steps", &[])] {
        let text = gridwalk(folder.path(), words(&format!("{line}{options}"))).expect(0).text();
        let lines: Vec<serde_json::Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        assert_eq!(lines.len(), 3);
        for line in &lines[..2] {
            check("`gridwalk animate`, a frame", line, absent);
        }
        check("`gridwalk animate`, in the end", &lines[2], &[]);
        assert_eq!((lines[2]["size"].clone(), lines[2]["fps"].as_f64()), (serde_json::json!([16, 12]), Some(4.0)));
    }
}

#[test]
fn cast() {
    let folder = folder();
    std::fs::write(folder.path().join("r.npy"), super::cast::npy(&[[0.1, 0.1, 1.0, 0.0, 0.0, -1.0]])).unwrap();
    let json = gridwalk(folder.path(), words("cast two.obj --rays r.npy -o h.npz --json")).expect(0).json();
    check("`gridwalk render`", &json, &["heatmap", "size", "spp", "time"]);
    assert_eq!((json["schema"].as_str(), json["rays"].as_u64()), (Some("gridwalk.cast/1"), Some(1)));
}

#[test]
fn others() {
    let folder = folder();
    check("`gridwalk info`", &gridwalk(folder.path(), words("info two.obj --json")).expect(0).json(), &[]);
    check("`gridwalk devices`", &gridwalk(folder.path(), words("devices --json")).expect(0).json(), &[]);
    gridwalk(folder.path(), words("render two.obj --size 16x16 -o a.png")).expect(0);
    check("`gridwalk diff`", &gridwalk(folder.path(), words("diff a.png a.png --json")).expect(0).json(), &[]);
}

/// The negative control: the comparison sees a field too many, one too few, and a wrong type.
#[test]
fn a_wrong_document_is_seen() {
    let folder = folder();
    let good = gridwalk(folder.path(), words("info two.obj --json")).expect(0).json();
    let wrong = |change: &dyn Fn(&mut serde_json::Value)| {
        let mut value = good.clone();
        change(&mut value);
        std::panic::catch_unwind(|| check("`gridwalk info`", &value, &[])).is_err()
    };
    assert!(wrong(&|value| value["surprise"] = 1.into()));
    assert!(wrong(&|value| drop(value.as_object_mut().unwrap().remove("lights"))));
    assert!(wrong(&|value| value["lights"] = "two".into()));
    assert!(!wrong(&|_| {}));
}
