//! The Vulkan functions that the library calls, as its source has them: it records, and makes pipelines.

use std::collections::BTreeSet;
use std::fs;

use crate::repository::root;

/// Names of methods that are called on a device, an instance or the debug utilities.
fn calls(text: &str) -> BTreeSet<String> {
    let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    let code: String = code.flat_map(str::chars).filter(|c| !c.is_whitespace()).collect();
    let mut found = BTreeSet::new();
    for receiver in ["device.", "device().", "instance.", "debug."] {
        for (_, after) in code.match_indices(receiver).map(|(at, _)| code.split_at(at + receiver.len())) {
            let name: String = after.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            if !name.is_empty() && after[name.len()..].starts_with('(') {
                found.insert(name);
            }
        }
    }
    found
}

/// Nothing else is called: no allocation of device memory, no submission, no waiting, no mapping.
#[test]
fn the_library_only_records() {
    let allowed = [
        "cmd_begin_debug_utils_label",
        "cmd_bind_pipeline",
        "cmd_dispatch",
        "cmd_dispatch_indirect",
        "cmd_end_debug_utils_label",
        "cmd_pipeline_barrier2",
        "cmd_push_constants",
        "cmd_reset_query_pool",
        "cmd_write_timestamp2",
        "create_compute_pipelines",
        "create_pipeline_layout",
        "create_shader_module",
        "destroy_pipeline",
        "destroy_pipeline_layout",
        "destroy_shader_module",
        "get_physical_device_features2",
        "get_physical_device_properties",
        "get_physical_device_properties2",
        "set_debug_utils_object_name",
        // Of a reference to a device, not of a device.
        "clone",
        "cloned",
    ];
    let mut seen = BTreeSet::new();
    for file in fs::read_dir(root().join("crates/gridwalk/src")).unwrap() {
        let path = file.unwrap().path();
        for call in calls(&fs::read_to_string(&path).unwrap()) {
            assert!(allowed.contains(&call.as_str()), "{}: calls {call}", path.display());
            seen.insert(call);
        }
    }
    assert!(
        ["cmd_dispatch_indirect", "cmd_pipeline_barrier2", "create_compute_pipelines"].iter().all(|call| seen.contains(*call)),
        "{seen:?}"
    );
    assert!(calls("unsafe { self.device.allocate_memory(&info, None) }").contains("allocate_memory"), "it would not be seen");
    assert!(calls("device\n    .queue_submit(queue)").contains("queue_submit"), "it would not be seen");
}
