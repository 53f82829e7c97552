//! The kernel table of a crate, as Rust source.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail};

use crate::source::KernelSource;
use crate::spirv::{Layout, Reflected};

/// The unformatted table of one crate. `kernel_types` is the module of the table's types, `hosts` are host types by GLSL name, with their layouts.
pub fn write(kernel_types: &str, kernels: &[(KernelSource, Reflected)], hosts: &[(String, Layout)]) -> String {
    let mut out = format!(
        "//! The kernels of this crate: SPIR-V and what reflection found in it. Made by `cargo tool shaders`; edit the GLSL instead.\n\n\
         use {}::{{{}Kernel, Kind}};\n\n",
        kernel_types,
        if kernels.iter().any(|(_, r)| !r.accesses.is_empty()) { "Access, " } else { "" }
    );
    out.push_str(
        "/// SPIR-V as words: files hold it as little-endian bytes.\n\
         const fn words<const N: usize>(bytes: &[u8]) -> [u32; N] {\n\
             let (chunks, rest) = bytes.as_chunks::<4>();\n\
             assert!(chunks.len() == N && rest.is_empty());\n\
             let mut words = [0; N];\n\
             let mut i = 0;\n\
             while i < N {\n\
                 words[i] = u32::from_le_bytes(chunks[i]);\n\
                 i += 1;\n\
             }\n\
             words\n\
         }\n\n\
         macro_rules! spirv {\n\
             ($path:literal) => {{\n\
                 const BYTES: &[u8] = include_bytes!($path);\n\
                 const WORDS: [u32; BYTES.len() / 4] = words(BYTES);\n\
                 &WORDS\n\
             }};\n\
         }\n\n",
    );
    for (kernel, reflected) in kernels {
        write_kernel(&mut out, kernel, reflected);
    }
    let names: Vec<String> = kernels.iter().map(|(kernel, _)| format!("&{}", kernel.name.to_uppercase())).collect();
    let _ = write!(out, "/// Every kernel of this crate, in order of name.\npub static ALL: &[&Kernel] = &[{}];\n\n", names.join(", "));
    write_assertions(&mut out, kernels, hosts);
    out
}

fn write_kernel(out: &mut String, kernel: &KernelSource, reflected: &Reflected) {
    let name = &kernel.name;
    let kind = if kernel.kind == "map" { "Map" } else { "Cooperative" };
    let accesses: Vec<String> = reflected
        .accesses
        .iter()
        .map(|(name, reads, writes)| {
            let access = match (reads, writes) {
                (true, false) => "Read",
                (false, true) => "Write",
                _ => "ReadWrite",
            };
            format!("(\"{name}\", Access::{access})")
        })
        .collect();
    let spec: Vec<String> =
        reflected.spec_constants.iter().map(|(id, name, bits)| format!("({id}, \"{name}\", {})", grouped(*bits))).collect();
    let _ = write!(
        out,
        "/// Kernel `{name}`, from `{}`.\n\
         pub static {}: Kernel = Kernel {{\n\
             name: \"{name}\",\n\
             kind: Kind::{kind},\n\
             spirv: spirv!(\"../spirv/{name}.spv\"),\n\
             local_size: {:?},\n\
             local_size_ids: {:?},\n\
             push_constant_size: {},\n\
             accesses: &[{}],\n\
             spec_constants: &[{}],\n\
         }};\n\n",
        kernel.path,
        name.to_uppercase(),
        reflected.local_size,
        reflected.local_size_ids,
        reflected.push.as_ref().map_or(0, host_size),
        accesses.join(", "),
        spec.join(", "),
    );
}

/// A number as clippy wants to read it: hexadecimal where decimal would be unreadably long.
fn grouped(bits: u32) -> String {
    if bits < 100_000 { bits.to_string() } else { format!("{:#06X}_{:04X}", bits >> 16, bits & 0xFFFF) }
}

/// Bytes of the host's twin of a push-constant block: its end, rounded up to its alignment there.
fn host_size(layout: &Layout) -> u32 {
    layout.end.next_multiple_of(if layout.members.iter().any(|m| m.reference) { 8 } else { 4 })
}

fn write_assertions(out: &mut String, kernels: &[(KernelSource, Reflected)], hosts: &[(String, Layout)]) {
    // Blocks of one name and one layout, which several kernels may share, are asserted once.
    let mut asserted: BTreeMap<String, String> = BTreeMap::new();
    for layout in kernels.iter().filter_map(|(_, r)| r.push.as_ref()) {
        let body = assertions(&format!("crate::push::{}", layout.name), layout, Some(host_size(layout)));
        asserted.entry(body).or_insert_with(|| layout.name.clone());
    }
    for (path, layout) in hosts {
        asserted.entry(assertions(path, layout, layout.stride)).or_insert_with(|| layout.name.clone());
    }
    if asserted.is_empty() {
        return;
    }
    out.push_str(
        "/// Bytes of a field, found by a function that takes it.\n\
         const fn size<T, F>(_: fn(&T) -> &F) -> usize {\n\
             size_of::<F>()\n\
         }\n\n\
         // The host's structures lie in memory as the kernels read them.\n",
    );
    let mut bodies: Vec<(String, String)> = asserted.into_iter().map(|(body, name)| (name, body)).collect();
    bodies.sort();
    for (_, body) in bodies {
        out.push_str(&body);
    }
}

fn assertions(path: &str, layout: &Layout, size: Option<u32>) -> String {
    let mut out = String::from("const _: () = {\n");
    let _ = writeln!(out, "use {path} as Host;");
    for member in &layout.members {
        let name = &member.name;
        let _ = writeln!(out, "assert!(core::mem::offset_of!(Host, {name}) == {});", member.offset);
        let _ = writeln!(out, "assert!(size(|host: &Host| &host.{name}) == {});", member.size);
    }
    if let Some(size) = size {
        let _ = writeln!(out, "assert!(size_of::<Host>() == {size});");
    }
    out.push_str("};\n");
    out
}

/// Formats Rust source as the repository's rustfmt.toml wants it.
pub fn format(root: &Path, source: &str) -> Result<String> {
    let mut child = Command::new("rustfmt")
        .args(["--edition", "2024", "--config-path"])
        .arg(root.join("rustfmt.toml"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .context("rustfmt cannot be started: rustup component add rustfmt")?;
    child.stdin.take().context("rustfmt takes no input")?.write_all(source.as_bytes())?;
    let output = child.wait_with_output()?;
    if !output.status.success() {
        bail!("rustfmt failed on the kernel table");
    }
    Ok(String::from_utf8(output.stdout)?)
}
