//! Lists, completions, manual, information: text that is the result.

use super::{entries, folder, gridwalk, words};

#[test]
fn every_list_has_its_option() {
    let folder = folder();
    for (name, known) in [("aovs", "debug.steps"), ("tonemaps", "neutral"), ("formats", "exr")] {
        let list = gridwalk(folder.path(), ["list", name]).expect(0);
        assert!(list.text().lines().any(|line| line.starts_with(&format!("{known}\t"))), "{}", list.text());
        assert_eq!(gridwalk(folder.path(), ["render", &format!("--list-{name}")]).expect(0).text(), list.text());
        assert_eq!(list.stderr, "");
    }
    // What is listed can be used.
    let tonemaps = gridwalk(folder.path(), words("list tonemaps")).expect(0).text();
    for tonemap in tonemaps.lines().map(|line| line.split('\t').next().unwrap()) {
        gridwalk(folder.path(), ["render", "two.obj", "--size", "4x4", "--tonemap", tonemap]).expect(0);
    }
    let aovs = gridwalk(folder.path(), words("list aovs")).expect(0).text();
    let aovs: Vec<&str> = aovs.lines().map(|line| line.split('\t').next().unwrap()).collect();
    gridwalk(folder.path(), ["render", "two.obj", "--size", "4x4", "-o", "a.exr", "--aov", &aovs.join(",")]).expect(0);
}

#[test]
fn devices_say_whether_they_serve() {
    let folder = folder();
    let text = gridwalk(folder.path(), words("devices")).expect(0).text();
    assert!(text.contains("can serve") && text.contains("driver") && text.contains("uuid"), "{text}");
    assert_eq!(gridwalk(folder.path(), words("list devices")).expect(0).text(), text);
}

#[test]
fn completions_for_every_shell() {
    let folder = folder();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let text = gridwalk(folder.path(), ["completions", shell]).expect(0).text();
        assert!(text.contains("--heatmap") || text.contains("heatmap"), "{shell}");
    }
}

#[test]
fn manual_pages() {
    let folder = folder();
    let page = gridwalk(folder.path(), words("man")).expect(0).text();
    assert!(page.contains(".TH gridwalk 1") && page.contains("interrupted"), "{page}");
    gridwalk(folder.path(), words("man --folder pages")).expect(0);
    let pages = entries(&folder.path().join("pages"));
    for name in ["gridwalk.1", "gridwalk-render.1", "gridwalk-cast.1", "gridwalk-diff.1", "gridwalk-info.1", "gridwalk-devices.1"] {
        assert!(pages.iter().any(|page| page == name), "{name} is missing in {pages:?}");
    }
    let page = std::fs::read_to_string(folder.path().join("pages/gridwalk-render.1")).unwrap();
    assert!(page.contains("GRIDWALK_DEVICE") && page.contains("heatmap"));
}

#[test]
fn help_and_version_are_results() {
    let folder = folder();
    for line in ["--help", "-h", "render --help", "cast -h", "--version", "render --version"] {
        let run = gridwalk(folder.path(), words(line)).expect(0);
        assert!(run.text().contains("gridwalk") && run.stderr.is_empty(), "{line}");
    }
    let help = gridwalk(folder.path(), words("--help")).expect(0).text();
    for status in [
        "0  done",
        "1  done, but",
        "2  wrong",
        "3  a file",
        "4  no",
        "5  out",
        "6  the",
        "7  a file",
        "130  interrupted",
        "143  terminated",
    ] {
        assert!(help.contains(status), "{status}");
    }
}

/// The help texts are written by hand, the defaults are not.
#[test]
fn help_tells_the_defaults() {
    let folder = folder();
    let settings = gridwalk_render::RenderSettings::default();
    let help = gridwalk(folder.path(), words("render --help")).expect(0).text();
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    for (option, default) in [
        ("--size <WxH>", format!("{}x{}", settings.width, settings.height)),
        ("--spp <N>", settings.spp.to_string()),
        ("--depth <N>", settings.depth.to_string()),
        ("--density <K>", gridwalk_render::BuildSettings::default().density.to_string()),
        ("--tonemap <NAME>", gridwalk_render::image::Tonemap::default().name().to_owned()),
    ] {
        let text = help.split_once(option).unwrap_or_else(|| panic!("no {option}: {help}")).1;
        let found = text.split_once("the scene's, or ").unwrap().1.split_once(']').unwrap().0;
        assert_eq!(found, default, "{option}");
    }
    let exact = help.split_once("exact: ").unwrap().1.split_once("Device:").unwrap().0;
    assert_eq!(exact.contains("(the default)"), gridwalk_render::BuildSettings::default().overlap == gridwalk::Overlap::Exact, "{exact}");
}

#[test]
fn information_counts_what_is_there() {
    let folder = folder();
    let scene = format!("{}v nan 0 0\nf 1 2 7\nf 1 1 2\n", super::TRIANGLES);
    std::fs::write(folder.path().join("odd.obj"), scene).unwrap();
    let info = gridwalk(folder.path(), words("info odd.obj --json")).expect(0).json();
    assert_eq!((info["triangles"].as_u64(), info["dropped"].as_u64(), info["degenerate"].as_u64()), (Some(4), Some(1), Some(1)));
    assert_eq!(info["bounds"], serde_json::json!([[0.0, 0.0, -1.0], [2.0, 2.0, 0.0]]));
    let text = gridwalk(folder.path(), words("info odd.obj")).expect(0).text();
    assert!(text.contains("triangles   4 (1 not finite, 1 without area)"), "{text}");
}

/// The estimate on the CPU is the device's grid, but for a cell along an axis.
#[test]
fn information_foretells_the_grid() {
    let folder = folder();
    for options in ["", "--density 40", "--resolution 7x5x3", "--density 40 --overlap exact", "--density 40 --overlap box"] {
        let info = gridwalk(folder.path(), words(&format!("info two.obj --json {options}"))).expect(0).json();
        let render = gridwalk(folder.path(), words(&format!("render two.obj --size 4x4 --json {options}"))).expect(0).json();
        let resolution =
            |value: &serde_json::Value| value["resolution"].as_array().unwrap().iter().map(|n| n.as_i64().unwrap()).collect::<Vec<_>>();
        let (foretold, built) = (resolution(&info["grid"]), resolution(&render));
        assert!(foretold.iter().zip(&built).all(|(a, b)| (a - b).abs() <= 1), "{options}: {foretold:?}, {built:?}");
        let pairs = |name: &str| info["grid"][name].as_u64().unwrap();
        if foretold == built {
            assert_eq!(info["grid"]["pairs"], render["pairs"], "{options}");
        }
        assert!(pairs("pairs") <= pairs("box_pairs"), "{options}");
        if options.contains("40") {
            assert_eq!(pairs("pairs") == pairs("box_pairs"), options.contains("box"), "{options}: exact overlap lists fewer");
        }
    }
    std::fs::write(folder.path().join("empty.obj"), "v 0 0 0\n").unwrap();
    assert!(gridwalk(folder.path(), words("info empty.obj --json")).expect(0).json()["grid"].is_null());
}
