//! `cargo tool slang`: compiles the tests' shaders in Slang, which trace through the public include in Slang, to SPIR-V that is committed:
//! so tests need no Slang compiler.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};
use sha2::{Digest, Sha256};

use crate::process::{self, Root};

/// The compiler, as a package of PyPI holds it.
const PACKAGE: &str = "slangtorch==1.3.22";
const HASH: &str = "7755f2f53509ebbd65839dcd8a104e7105aeaf3e3600aea9385c2bec9beb2eaa";

/// Folder of the shaders and of what is made of them, below the root.
const FOLDER: &str = "tests/slang";

/// The public include in Slang, below the root.
const INCLUDE: &str = "crates/gridwalk/glsl/gridwalk.slang";

fn compiler_folder() -> Result<PathBuf> {
    Ok(process::cache()?.join("slang").join(PACKAGE.replace("==", "-")))
}

/// Whether the compiler has been brought already.
pub fn is_here() -> bool {
    compiler_folder().is_ok_and(|folder| folder.is_dir())
}

/// Brings the compiler, if need be, and gives its path.
pub fn compiler() -> Result<PathBuf> {
    if std::env::consts::ARCH != "x86_64" || std::env::consts::OS != "linux" {
        bail!("slangc: known for Linux on x86-64 only");
    }
    let folder = compiler_folder()?;
    fs::create_dir_all(folder.parent().unwrap_or(&folder)).with_context(|| format!("{}: cannot be made", folder.display()))?;
    process::complete(&folder, fill)?;
    Ok(folder.join("slangtorch/bin/slangc"))
}

fn fill(folder: &Path) -> Result<()> {
    let requirements = folder.join("requirements.txt");
    fs::write(&requirements, format!("{PACKAGE} --hash=sha256:{HASH}\n"))
        .with_context(|| format!("{}: cannot be written", requirements.display()))?;
    let mut download = Command::new("python3");
    download.args(["-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps", "--require-hashes"]);
    download.args(["--only-binary=:all:", "--platform", "manylinux_2_27_x86_64", "--dest"]).arg(folder).arg("-r").arg(&requirements);
    process::run(&mut download)?;
    let wheel = fs::read_dir(folder)?.flatten().map(|entry| entry.path()).find(|path| path.extension().is_some_and(|e| e == "whl"));
    let wheel = wheel.context("pip has downloaded no wheel")?;
    process::run(Command::new("python3").args(["-m", "zipfile", "-e"]).arg(&wheel).arg(folder))?;
    process::run(Command::new("chmod").arg("+x").arg(folder.join("slangtorch/bin/slangc")))?;
    fs::remove_file(&wheel).with_context(|| format!("{}: cannot be removed", wheel.display()))
}

/// What is made of every shader, by path below the root: the modules, and the hashes of what they were made from.
fn made(root: &Root) -> Result<Vec<(String, Vec<u8>)>> {
    let compiler = compiler()?;
    let temporary = process::cache()?.join(format!("slang-{}.spv", std::process::id()));
    let mut all = Vec::new();
    let mut sources: Vec<PathBuf> = fs::read_dir(root.join(FOLDER)).context(FOLDER)?.flatten().map(|entry| entry.path()).collect();
    sources.retain(|path| path.extension().is_some_and(|e| e == "slang"));
    sources.sort();
    let mut hashes = String::from("# Made by `cargo tool slang`: what the modules here were made from.\n");
    for path in sources.iter().chain([&root.join(INCLUDE)]) {
        let bytes = fs::read(path).with_context(|| format!("{}: cannot be read", path.display()))?;
        let hash: String = Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
        let name = path.strip_prefix(&**root).unwrap_or(path).display();
        hashes += &format!("\"{name}\" = \"{hash}\"\n");
    }
    for source in &sources {
        let mut command = Command::new(&compiler);
        command.arg(source).arg("-I").arg(root.join(INCLUDE).parent().context("no folder")?);
        command.args(["-stage", "compute", "-entry", "main", "-target", "spirv", "-profile", "spirv_1_5", "-fp-mode", "precise", "-O0"]);
        command.args(["-warnings-as-errors", "all", "-o"]).arg(&temporary);
        let compiled = process::run(&mut command).and_then(|()| fs::read(&temporary).context("slangc has written nothing"));
        let _ = fs::remove_file(&temporary);
        let name = source.file_stem().unwrap_or_default().to_string_lossy();
        all.push((format!("{FOLDER}/{name}.spv"), without_language(&compiled?)));
    }
    all.push((format!("{FOLDER}/made-from.toml"), hashes.into_bytes()));
    Ok(all)
}

/// A module that does not say that it was Slang: validators older than that language refuse it for that alone.
fn without_language(bytes: &[u8]) -> Vec<u8> {
    const SOURCE: u32 = 3;
    let mut words: Vec<u32> = bytes.chunks_exact(4).map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]])).collect();
    let mut at = 5;
    while let Some(&first) = words.get(at) {
        if first & 0xFFFF == SOURCE {
            words[at + 1] = 0;
        }
        at += ((first >> 16) as usize).max(1);
    }
    words.into_iter().flat_map(u32::to_le_bytes).collect()
}

/// Writes all that is made.
pub fn write(root: &Root) -> Result<()> {
    for (path, bytes) in made(root)? {
        if fs::read(root.join(&path)).ok().as_ref() != Some(&bytes) {
            fs::write(root.join(&path), &bytes).with_context(|| format!("{path}: cannot be written"))?;
            eprintln!("wrote {path}");
        }
    }
    Ok(())
}

/// Compares all that is made with what is committed.
pub fn check(root: &Root) -> Result<()> {
    for (path, bytes) in made(root)? {
        if fs::read(root.join(&path)).ok().as_ref() != Some(&bytes) {
            bail!("{path} is stale: cargo tool slang");
        }
    }
    Ok(())
}
