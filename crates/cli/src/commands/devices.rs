//! `gridwalk devices`.

use std::fmt::Write;

use gridwalk_render::{DeviceInfo, list_devices};
use serde::Serialize;

use crate::exit::{Exit, Result};
use crate::output;
use crate::report::Header;

#[derive(Serialize)]
struct Report {
    #[serde(flatten)]
    header: Header,
    devices: Vec<Entry>,
}

#[derive(Serialize)]
struct Entry {
    index: usize,
    name: String,
    kind: &'static str,
    uuid: String,
    driver: String,
    vulkan: String,
    heap_bytes: u64,
    max_allocation_bytes: u64,
    subgroup_size: u32,
    suitable: bool,
    reasons: Vec<String>,
}

/// Lists all devices. With none that can serve, the status says so.
pub fn run(json: bool) -> Result<Exit> {
    let devices = list_devices()?;
    if json {
        let entries = devices.iter().map(entry).collect();
        output::print_json(&Report { header: Header::new("devices"), devices: entries })?;
    } else {
        let mut text = String::new();
        for device in &devices {
            let entry = entry(device);
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{}  {} ({})", entry.index, entry.name, entry.kind);
            let _ = writeln!(text, "   driver  {}, Vulkan {}", entry.driver, entry.vulkan);
            let _ = writeln!(text, "   memory  {} MiB, {} MiB at once", entry.heap_bytes >> 20, entry.max_allocation_bytes >> 20);
            let _ = writeln!(text, "   uuid    {}", entry.uuid);
            if entry.suitable {
                let _ = writeln!(text, "   can serve");
            }
            for reason in entry.reasons {
                let _ = writeln!(text, "   cannot serve: lacks {reason}");
            }
        }
        output::print(&text)?;
    }
    Ok(if devices.iter().any(DeviceInfo::is_suitable) { Exit::Ok } else { Exit::NoDevice })
}

fn entry(device: &DeviceInfo) -> Entry {
    let [major, minor, patch] = device.api_version;
    Entry {
        index: device.index,
        name: device.name.clone(),
        kind: device.kind.name(),
        uuid: device.uuid_text(),
        driver: crate::report::driver(device),
        vulkan: format!("{major}.{minor}.{patch}"),
        heap_bytes: device.limits.heap_bytes,
        max_allocation_bytes: device.limits.max_allocation_bytes,
        subgroup_size: device.limits.subgroup_size,
        suitable: device.is_suitable(),
        reasons: device.unsuitable.clone(),
    }
}
