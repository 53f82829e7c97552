//! `cargo tool drivers`: further Vulkan drivers on the CPU, for tests and measurements.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::{apt, process};

struct Driver {
    name: &'static str,
    about: &'static str,
    fill: fn(&Path) -> Result<()>,
    /// Folder in the cache; two drivers may share one.
    folder: &'static str,
    environment: fn(&Path) -> Environment,
}

/// Variables and values.
pub type Environment = Vec<(&'static str, String)>;

const DRIVERS: [Driver; 3] = [
    Driver {
        name: "mesa",
        about: "lavapipe of Mesa 25, from Debian 12's backports; measurements are made on it. Needs the system's mesa-vulkan-drivers installed",
        fill: fill_mesa,
        folder: "mesa",
        environment: mesa_environment,
    },
    Driver {
        name: "swiftshader",
        about: "a second, independent driver (subgroups of 4; no 64-bit integers), from Debian's chromium-common",
        fill: fill_chromium,
        folder: "chromium",
        environment: |folder| driver_files(&folder.join("swiftshader_icd.json")),
    },
    Driver {
        name: "validation",
        about: "a current validation layer for any driver, from Debian's chromium-common",
        fill: fill_chromium,
        folder: "chromium",
        environment: |folder| vec![("VK_LAYER_PATH", folder.join("layers").display().to_string())],
    },
];

/// Prints name and purpose of every driver.
pub fn list() {
    for driver in &DRIVERS {
        println!("{:<12} {}", driver.name, driver.about);
    }
}

/// Brings a driver and prints the environment that selects it.
pub fn get(name: &str) -> Result<()> {
    for (variable, value) in environment(name)? {
        // Libraries come before whatever the shell that evaluates this has.
        let rest = if variable == LIBRARY_PATH { "\"${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}\"" } else { "" };
        println!("export {variable}='{}'{rest}", value.replace('\'', "'\\''"));
    }
    Ok(())
}

/// Brings a driver, if need be, and gives the environment that selects it.
pub fn environment(name: &str) -> Result<Environment> {
    let Some(driver) = DRIVERS.iter().find(|driver| driver.name == name) else {
        bail!("{name}: no such driver; there are: {}", DRIVERS.map(|driver| driver.name).join(", "));
    };
    if std::env::consts::ARCH != "x86_64" {
        bail!("{name}: known for x86-64 only");
    }
    let folder = process::cache()?.join("drivers").join(driver.folder);
    if let Some(parent) = folder.parent() {
        fs::create_dir_all(parent).with_context(|| format!("{}: cannot be made", parent.display()))?;
    }
    process::complete(&folder, driver.fill)?;
    Ok((driver.environment)(&folder))
}

const LIBRARY_PATH: &str = "LD_LIBRARY_PATH";
const LIBRARIES: &str = "usr/lib/x86_64-linux-gnu";

fn driver_files(manifest: &Path) -> Environment {
    // Older loaders know the second name only.
    ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"].map(|name| (name, manifest.display().to_string())).to_vec()
}

fn fill_mesa(folder: &Path) -> Result<()> {
    let codename = apt::codename()?;
    if codename != "bookworm" {
        bail!("mesa: comes from Debian 12's backports; on {codename} use the system's own mesa-vulkan-drivers");
    }
    apt::unpack(&["mesa-vulkan-drivers", "libdrm2", "libdrm-amdgpu1"], "bookworm-backports", folder)?;
    manifest(&folder.join("lvp_icd.json"), &format!("{LIBRARIES}/libvulkan_lvp.so"), "1.4.0")
}

fn mesa_environment(folder: &Path) -> Environment {
    let mut environment = driver_files(&folder.join("lvp_icd.json"));
    environment.push((LIBRARY_PATH, folder.join(LIBRARIES).display().to_string()));
    environment
}

fn fill_chromium(folder: &Path) -> Result<()> {
    apt::unpack(&["chromium-common"], &apt::codename()?, folder)?;
    let chromium = PathBuf::from("usr/lib/chromium");
    manifest(&folder.join("swiftshader_icd.json"), &chromium.join("libvk_swiftshader.so").display().to_string(), "1.3.0")?;
    let layers = folder.join("layers");
    fs::create_dir_all(&layers).with_context(|| format!("{}: cannot be made", layers.display()))?;
    let extensions =
        [("VK_EXT_debug_report", 9), ("VK_EXT_debug_utils", 1), ("VK_EXT_validation_features", 2), ("VK_EXT_layer_settings", 2)]
            .map(|(name, version)| format!(r#"{{"name": "{name}", "spec_version": "{version}"}}"#))
            .join(", ");
    let layer = format!(
        r#"{{"file_format_version": "1.2.0", "layer": {{"name": "VK_LAYER_KHRONOS_validation", "type": "GLOBAL", "library_path": "../{}",
"api_version": "1.4.300", "implementation_version": "1", "description": "Khronos validation layer", "instance_extensions": [{extensions}]}}}}
"#,
        chromium.join("libVkLayer_khronos_validation.so").display()
    );
    let path = layers.join("VkLayer_khronos_validation.json");
    fs::write(&path, layer).with_context(|| format!("{}: cannot be written", path.display()))
}

/// Writes a driver manifest. The library's path counts from the manifest, so that the folder can be renamed.
fn manifest(path: &Path, library: &str, version: &str) -> Result<()> {
    let folder = path.parent().context("a manifest without a folder")?;
    if !folder.join(library).is_file() {
        bail!("{library}: not in the package");
    }
    let text = format!(r#"{{"file_format_version": "1.0.0", "ICD": {{"library_path": "./{library}", "api_version": "{version}"}}}}"#);
    fs::write(path, text + "\n").with_context(|| format!("{}: cannot be written", path.display()))
}
