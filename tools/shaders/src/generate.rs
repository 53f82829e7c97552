//! From sources to everything that is generated, in memory; and what to do with it.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::{Context, Result, anyhow, bail};
use shaderc::{CompileOptions, Compiler, EnvVersion, OptimizationLevel, ResolvedInclude, ShaderKind, SourceLanguage, TargetEnv};

use crate::manifest::{self, Entry, FLAGS, GENERATION, HOST_TYPES, Manifest};
use crate::source::{self, KernelSource, OWNERS, Owner, PUBLIC_NAME};
use crate::spirv::{self, Layout, Reflected};
use crate::{published, table};

/// Everything generated for one crate.
#[derive(Debug)]
pub struct Generated {
    /// The crate.
    pub owner: &'static Owner,
    /// Its kernels.
    pub kernels: Vec<(KernelSource, Reflected)>,
    /// Files by path below the crate.
    pub files: BTreeMap<String, Vec<u8>>,
}

/// Compiles the kernels of the named crates, or of all when none is named, and makes all files in memory. Either everything compiles or
/// the error lists every failure.
pub fn generate(root: &Path, only: &[String]) -> Result<Vec<Generated>> {
    if let Some(name) = only.iter().find(|name| OWNERS.iter().all(|owner| owner.name != **name)) {
        bail!("{name}: no such crate with kernels; there are: {}", OWNERS.map(|owner| owner.name).join(", "));
    }
    let chosen = OWNERS.iter().filter(|owner| only.is_empty() || only.iter().any(|name| name == owner.name));
    let sources = chosen.map(|owner| Ok((owner, owner.kernels(root)?))).collect::<Result<Vec<_>>>()?;
    let jobs: Vec<&KernelSource> = sources.iter().flat_map(|(_, kernels)| kernels).collect();
    let count = jobs.len();
    let mut results = compile_all(root, &jobs)?.into_iter();
    let mut failures = Vec::new();
    let mut all = Vec::new();
    for (owner, sources) in sources {
        let mut kernels = Vec::new();
        for (kernel, result) in sources.into_iter().zip(results.by_ref()) {
            match result {
                Ok(reflected) => kernels.push((kernel, reflected)),
                Err(error) => failures.push(format!("{error:#}")),
            }
        }
        all.push((owner, kernels));
    }
    if !failures.is_empty() {
        bail!("{}\n{} of {count} kernels failed; nothing is written", failures.join("\n"), failures.len());
    }
    all.into_iter().map(|(owner, kernels)| assemble(root, owner, kernels)).collect()
}

/// Compiles on all cores; the results are in the order of the kernels.
fn compile_all(root: &Path, kernels: &[&KernelSource]) -> Result<Vec<Result<Reflected>>> {
    let next = AtomicUsize::new(0);
    let results = Mutex::new(BTreeMap::new());
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(2, usize::from).min(kernels.len()) {
            scope.spawn(|| {
                let compiler = Compiler::new();
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(kernel) = kernels.get(index) else { break };
                    let result = match &compiler {
                        Ok(compiler) => compile(root, compiler, kernel),
                        Err(error) => Err(anyhow!("the compiler cannot be started: {error}")),
                    };
                    if let Ok(mut results) = results.lock() {
                        results.insert(index, result);
                    }
                }
            });
        }
    });
    let results = results.into_inner().map_err(|_| anyhow!("a compiling thread died"))?;
    Ok(results.into_values().collect())
}

fn compile(root: &Path, compiler: &Compiler, kernel: &KernelSource) -> Result<Reflected> {
    let mut options = CompileOptions::new().context("compile options")?;
    options.set_source_language(SourceLanguage::GLSL);
    options.set_target_env(TargetEnv::Vulkan, EnvVersion::Vulkan1_2 as u32);
    options.set_optimization_level(OptimizationLevel::Zero);
    options.set_include_callback(|name, _, _, _| {
        let path = source::include_path(name);
        // Who includes it as users do gets what users get.
        let content = match name {
            PUBLIC_NAME => published::glsl(root, &path).map_err(|error| format!("{error:#}")),
            _ => fs::read_to_string(root.join(&path)).map_err(|error| format!("{path}: {error} (names count from glsl/)")),
        };
        Ok(ResolvedInclude { resolved_name: path, content: content? })
    });
    let text = source::read(root, &kernel.path)?;
    let artifact =
        compiler.compile_into_spirv(&text, ShaderKind::Compute, &kernel.path, "main", Some(&options)).map_err(|error| match error {
            shaderc::Error::CompilationError(_, messages) => anyhow!("{}:\n{}", kernel.path, messages.trim_end()),
            other => anyhow!("{}: {other}", kernel.path),
        })?;
    if artifact.get_num_warnings() > 0 {
        bail!("{}: warnings count as errors:\n{}", kernel.path, artifact.get_warning_messages().trim_end());
    }
    spirv::finish(artifact.as_binary()).with_context(|| kernel.path.clone())
}

fn assemble(root: &Path, owner: &'static Owner, kernels: Vec<(KernelSource, Reflected)>) -> Result<Generated> {
    let mut files = BTreeMap::new();
    let mut entries = Vec::new();
    for (kernel, reflected) in &kernels {
        let bytes: Vec<u8> = reflected.words.iter().flat_map(|word| word.to_le_bytes()).collect();
        entries.push(entry(root, &kernel.path, format!("spirv/{}.spv", kernel.name), bytes, &mut files)?);
    }
    let mut includes = Vec::new();
    if let Some(path) = owner.public_include.map(|name| format!("glsl/{name}")).filter(|path| root.join(path).exists()) {
        for (name, text) in [(PUBLIC_NAME, published::glsl(root, &path)?), ("gridwalk.slang", published::slang(root, &path)?)] {
            includes.push(entry(root, &path, format!("glsl/{name}"), text.into_bytes(), &mut files)?);
        }
    }
    if kernels.is_empty() {
        return Ok(Generated { owner, kernels, files: BTreeMap::new() });
    }
    let table = match owner.kernel_types {
        Some(types) => {
            let hosts = host_layouts(root, owner, &kernels)?;
            Some(table::format(root, &table::write(types, &kernels, &hosts))?)
        }
        None => None,
    };
    let manifest = Manifest {
        generation: GENERATION,
        compiler: manifest::compiler(root)?,
        flags: FLAGS.to_owned(),
        host_types: table.as_ref().map(|_| manifest::host_types_hash(root)).transpose()?,
        table: table.as_ref().map(|source| manifest::hash(source.as_bytes())),
        includes,
        kernels: entries,
    };
    let manifest = format!("# Made by `{}`; do not edit.\n{}", manifest::CURE, toml::to_string(&manifest)?);
    if let Some(source) = table {
        files.insert("src/kernels.rs".to_owned(), source.into_bytes());
    }
    files.insert("spirv/manifest.toml".to_owned(), manifest.into_bytes());
    Ok(Generated { owner, kernels, files })
}

fn entry(root: &Path, source: &str, output: String, bytes: Vec<u8>, files: &mut BTreeMap<String, Vec<u8>>) -> Result<Entry> {
    let entry = Entry {
        source: source.to_owned(),
        source_hash: manifest::source_hash(root, source)?,
        output: output.clone(),
        output_hash: manifest::hash(&bytes),
    };
    files.insert(output, bytes);
    Ok(entry)
}

/// The host types that [`HOST_TYPES`] lists for a crate and that its kernels use, as Rust path and layout.
fn host_layouts(root: &Path, owner: &Owner, kernels: &[(KernelSource, Reflected)]) -> Result<Vec<(String, Layout)>> {
    if !root.join(HOST_TYPES).exists() {
        return Ok(Vec::new());
    }
    let table: BTreeMap<String, BTreeMap<String, String>> =
        toml::from_str(&source::read(root, HOST_TYPES)?).with_context(|| format!("{HOST_TYPES}: not understood"))?;
    let Some(wanted) = table.get(owner.name) else { return Ok(Vec::new()) };
    let mut known: BTreeMap<String, Layout> = BTreeMap::new();
    for (kernel, reflected) in kernels {
        for layout in reflected.layouts.values().filter(|layout| wanted.contains_key(&layout.name)) {
            spirv::merge(&mut known, layout.clone()).with_context(|| kernel.path.clone())?;
        }
    }
    for name in wanted.keys().filter(|name| !known.contains_key(*name)) {
        eprintln!("{HOST_TYPES}: [{}] {name}: no kernel holds such a structure in memory; nothing is asserted of it", owner.name);
    }
    Ok(wanted.iter().filter_map(|(name, path)| Some((path.clone(), known.remove(name)?))).collect())
}

impl Generated {
    /// Files that are not on disk as they should be: generated ones that differ, and SPIR-V that belongs to no kernel.
    pub fn stale(&self, root: &Path) -> Result<Vec<PathBuf>> {
        let folder = self.owner.folder(root);
        let mut stale: Vec<PathBuf> = self
            .files
            .iter()
            .map(|(name, bytes)| (folder.join(name), bytes))
            .filter(|(path, bytes)| fs::read(path).ok().as_ref() != Some(bytes))
            .map(|(path, _)| path)
            .collect();
        stale.extend(self.orphans(root)?);
        Ok(stale)
    }

    fn orphans(&self, root: &Path) -> Result<Vec<PathBuf>> {
        let mut orphans = source::files(&self.owner.folder(root).join("spirv"), "spv")?;
        orphans.retain(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            !self.files.contains_key(&format!("spirv/{name}"))
        });
        Ok(orphans)
    }

    /// Writes what differs, each file in one step, and removes SPIR-V that belongs to no kernel. Gives what it touched.
    pub fn write(&self, root: &Path) -> Result<Vec<PathBuf>> {
        let stale = self.stale(root)?;
        let folder = self.owner.folder(root);
        for path in &stale {
            let name = path.strip_prefix(&folder).unwrap_or(path).to_string_lossy().replace('\\', "/");
            match self.files.get(&name) {
                None => fs::remove_file(path).with_context(|| format!("{}: cannot be removed", path.display()))?,
                Some(bytes) => {
                    if let Some(parent) = path.parent() {
                        fs::create_dir_all(parent).with_context(|| format!("{}: cannot be made", parent.display()))?;
                    }
                    let partial = path.with_extension(format!("{}.partial", std::process::id()));
                    fs::write(&partial, bytes).with_context(|| format!("{}: cannot be written", partial.display()))?;
                    fs::rename(&partial, path).with_context(|| format!("{}: cannot be written", path.display()))?;
                }
            }
        }
        Ok(stale)
    }
}
