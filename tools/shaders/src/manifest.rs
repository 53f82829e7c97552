//! The manifest beside the SPIR-V: which sources it was made from, and the hashes of all that was made.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::source::{self, OWNERS, Owner};

/// Raised whenever the tool writes something else for the same sources, so that what an older tool wrote counts as stale.
pub const GENERATION: u32 = 2;

/// How the kernels are compiled; part of the manifest.
pub const FLAGS: &str = "vulkan1.2, GLSL 460, optimization zero, NoContraction on all float arithmetic, names kept";

/// What mends a stale file.
pub const CURE: &str = "cargo tool shaders";

/// The table of host types, below the root.
pub const HOST_TYPES: &str = "glsl/host.toml";

/// `spirv/manifest.toml` of a crate.
#[derive(Debug, Serialize, Deserialize, PartialEq, Eq)]
pub struct Manifest {
    /// [`GENERATION`] of the tool that wrote it.
    pub generation: u32,
    /// Name and version of the compiler.
    pub compiler: String,
    /// [`FLAGS`].
    pub flags: String,
    /// Hash of [`HOST_TYPES`], for a crate with a kernel table.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub host_types: Option<String>,
    /// Hash of the crate's `src/kernels.rs`, if it has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table: Option<String>,
    /// The public include in each language, if the crate carries it.
    #[serde(default, rename = "include", skip_serializing_if = "Vec::is_empty")]
    pub includes: Vec<Entry>,
    /// The kernels, in order of name.
    #[serde(default, rename = "kernel")]
    pub kernels: Vec<Entry>,
}

/// A generated file and its source.
#[derive(Debug, Serialize, Deserialize, PartialEq, Eq)]
pub struct Entry {
    /// Path of the source below the root.
    pub source: String,
    /// Hash over the source and everything that it includes.
    pub source_hash: String,
    /// Path of the generated file below the crate.
    pub output: String,
    /// Hash of the generated file.
    pub output_hash: String,
}

/// SHA-256 of bytes, in hexadecimal.
pub fn hash(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// SHA-256 over a source and everything that it includes, names included.
pub fn source_hash(root: &Path, path: &str) -> Result<String> {
    let mut hasher = Sha256::new();
    for (name, text) in source::closure(root, path)? {
        // The lengths keep two different sets of files from running together into the same bytes.
        for part in [name.as_bytes(), text.as_bytes()] {
            hasher.update((part.len() as u64).to_le_bytes());
            hasher.update(part);
        }
    }
    Ok(hex(&hasher.finalize()))
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The version of the compiler that the lock file of the repository names.
pub fn compiler(root: &Path) -> Result<String> {
    #[derive(Deserialize)]
    struct Lock {
        package: Vec<Package>,
    }
    #[derive(Deserialize)]
    struct Package {
        name: String,
        version: String,
    }
    let lock: Lock = toml::from_str(&source::read(root, "Cargo.lock")?).context("Cargo.lock: not understood")?;
    let package = lock.package.iter().find(|p| p.name == "shaderc").context("Cargo.lock: names no package shaderc")?;
    Ok(format!("shaderc {}", package.version))
}

/// Hash of the table of host types; of nothing when there is none.
pub fn host_types_hash(root: &Path) -> Result<String> {
    let path = root.join(HOST_TYPES);
    let bytes = if path.exists() { fs::read(&path).with_context(|| format!("{HOST_TYPES}: cannot be read"))? } else { Vec::new() };
    Ok(hash(&bytes))
}

/// Everything generated that is not up to date by its hashes, as `path: reason`, without compiling anything. Empty when all is well.
pub fn stale(root: &Path) -> Result<Vec<String>> {
    let mut stale = Vec::new();
    for owner in &OWNERS {
        stale_of(root, owner, &mut stale)?;
    }
    Ok(stale)
}

fn stale_of(root: &Path, owner: &Owner, stale: &mut Vec<String>) -> Result<()> {
    let kernels = owner.kernels(root)?;
    let folder = owner.folder;
    let path = format!("{folder}/spirv/manifest.toml");
    if !root.join(&path).exists() {
        if !kernels.is_empty() {
            stale.push(format!("{path}: missing"));
        }
        return Ok(());
    }
    let manifest: Manifest = toml::from_str(&source::read(root, &path)?).with_context(|| format!("{path}: not understood"))?;
    if manifest.generation != GENERATION || manifest.flags != FLAGS {
        stale.push(format!("{path}: written by another version of the tool"));
    }
    if manifest.compiler != compiler(root)? {
        stale.push(format!("{path}: made with {}, but Cargo.lock has {}", manifest.compiler, compiler(root)?));
    }
    if manifest.host_types.as_ref().is_some_and(|hash| host_types_hash(root).ok().as_ref() != Some(hash)) {
        stale.push(format!("{folder}/src/kernels.rs: {HOST_TYPES} has changed"));
    }
    let mut output = |path: &str, hash_wanted: &str| {
        let file = format!("{folder}/{path}");
        match fs::read(root.join(&file)) {
            Err(error) => stale.push(format!("{file}: {error}")),
            Ok(bytes) if hash(&bytes) != hash_wanted => stale.push(format!("{file}: not as it was made")),
            Ok(_) => {}
        }
    };
    if let Some(hash) = &manifest.table {
        output("src/kernels.rs", hash);
    }
    for entry in manifest.kernels.iter().chain(&manifest.includes) {
        output(&entry.output, &entry.output_hash);
    }
    for entry in manifest.kernels.iter().chain(&manifest.includes) {
        if !root.join(&entry.source).exists() {
            stale.push(format!("{folder}/{}: its source {} is gone", entry.output, entry.source));
        } else if source_hash(root, &entry.source)? != entry.source_hash {
            stale.push(format!("{folder}/{}: {} or an include of it has changed", entry.output, entry.source));
        }
    }
    for kernel in &kernels {
        if !manifest.kernels.iter().any(|entry| entry.source == kernel.path) {
            stale.push(format!("{path}: {} is new", kernel.path));
        }
    }
    for spirv in source::files(&root.join(folder).join("spirv"), "spv")? {
        let name = spirv.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        if !manifest.kernels.iter().any(|entry| entry.output == format!("spirv/{name}")) {
            stale.push(format!("{folder}/spirv/{name}: belongs to no kernel"));
        }
    }
    Ok(())
}
