//! An OBJ file with its MTL files and textures, as a part of a scene.

use std::collections::HashMap;
use std::path::Path;

use crate::assets::Assets;
use crate::lines::words;
use crate::mtl::{self, Map, MtlMaterial};
use crate::obj;
use crate::suggest::closest;
use crate::texture::Use;
use crate::{Error, Material, Mesh, Result};

/// Reads an OBJ file's bytes. `folder` is where its MTL files are looked for; `default_material` serves faces that name none.
pub(crate) fn read(
    assets: &mut Assets,
    bytes: &[u8],
    file: &str,
    name: &str,
    folder: Option<&Path>,
    default_material: u32,
) -> Result<Mesh> {
    let mut obj = obj::parse(bytes, file, name)?;
    assets.warnings.append(&mut obj.warnings);

    let mut known: Vec<(MtlMaterial, usize)> = Vec::new();
    let mut libraries = Vec::new();
    for (names, line) in &obj.libraries {
        let mut place = Place { file, line: *line };
        for (path, bytes) in open_libraries(assets, names, &mut place, folder) {
            let shown = path.file_name().map_or_else(|| file.to_owned(), |name| name.to_string_lossy().into_owned());
            let materials = mtl::parse(&bytes, &shown, &mut assets.warnings);
            known.extend(materials.into_iter().map(|material| (material, libraries.len())));
            libraries.push((path.parent().map(Path::to_owned).unwrap_or_default(), shown));
        }
    }
    // Of two materials of one name the first holds, as in Blender and tinyobjloader.
    let mut by_name: HashMap<&str, usize> = HashMap::new();
    for (at, (material, _)) in known.iter().enumerate() {
        by_name.entry(&material.name).or_insert(at);
    }

    let mut numbers = vec![default_material];
    let mut made: HashMap<usize, u32> = HashMap::new();
    let mut missing = 0_u32;
    for (name, line) in &obj.materials {
        let number = match by_name.get(name.as_str()) {
            Some(&at) => match made.get(&at) {
                Some(&number) => number,
                None => {
                    let (material, library) = &known[at];
                    let (folder, file) = &libraries[*library];
                    let material = resolve(assets, material, folder, file);
                    let number = assets.material(material);
                    made.insert(at, number);
                    number
                }
            },
            None => {
                missing += 1;
                if missing <= 20 {
                    let hint = closest(name, by_name.keys().copied()).map(|near| format!(" (there is \"{near}\")")).unwrap_or_default();
                    assets.warnings.push(format!("{file}:{line}: no material \"{name}\"{hint}; the default material is used"));
                }
                default_material
            }
        };
        numbers.push(number);
    }
    if missing > 20 {
        assets.warnings.push(format!("{file}: {} more materials are missing", missing - 20));
    }
    for material in &mut obj.mesh.materials {
        *material = numbers.get(*material as usize).copied().unwrap_or(default_material);
    }
    Ok(obj.mesh)
}

struct Place<'a> {
    file: &'a str,
    line: u64,
}

/// The rest of an `mtllib` line is one name with blanks, or several names.
fn open_libraries(assets: &mut Assets, names: &str, place: &mut Place<'_>, folder: Option<&Path>) -> Vec<(std::path::PathBuf, Vec<u8>)> {
    let Some(folder) = folder else {
        assets.warnings.push(format!("{}:{}: the materials of a stream are not read", place.file, place.line));
        return Vec::new();
    };
    let limit = assets.options.max_material_bytes;
    let open = |name: &str| -> Result<(std::path::PathBuf, Vec<u8>)> {
        let path = assets.files.find(folder, name)?;
        let bytes = assets.files.read(&path, limit)?;
        Ok((path, bytes))
    };
    let whole = match open(names) {
        Ok(opened) => return vec![opened],
        Err(error) => error,
    };
    let parts: Vec<String> = words(names.as_bytes()).take(64).map(|name| String::from_utf8_lossy(name).into_owned()).collect();
    if parts.len() < 2 || !matches!(whole, Error::NotFound { .. }) {
        assets.warnings.push(format!("{}:{}: materials are not read: {whole}", place.file, place.line));
        return Vec::new();
    }
    let mut opened = Vec::new();
    for part in parts {
        match open(&part) {
            Ok(file) => opened.push(file),
            Err(error) => assets.warnings.push(format!("{}:{}: materials are not read: {error}", place.file, place.line)),
        }
    }
    opened
}

/// Makes a material, its textures loaded. `folder` and `file` are those of the MTL file.
fn resolve(assets: &mut Assets, from: &MtlMaterial, folder: &Path, file: &str) -> Material {
    let mut load = |map: &Option<Map>, usage: Use| -> Option<u32> {
        let map = map.as_ref()?;
        assets.textures.load(folder, &map.file, usage).unwrap_or_else(|message| {
            assets.warnings.push(format!("{file}:{}: no texture: {message}", map.line));
            None
        })
    };
    let diffuse_map = load(&from.diffuse_map, Use::Colour);
    let opacity_map = match &from.opacity_map {
        Some(_) => load(&from.opacity_map, Use::Opacity),
        None if diffuse_map.is_some() => load(&from.diffuse_map, Use::AlphaOfColour),
        None => None,
    };
    let specular_map = load(&from.specular_map, Use::Colour);
    let emission_map = load(&from.emission_map, Use::Colour);
    let normals = load(&from.normal_map, Use::Data);
    let bumps = if normals.is_none() { load(&from.bump_map, Use::Data) } else { None };
    let bump_is_height = bumps.is_some_and(|map| assets.textures.is_height(map));

    let defaults = Material::default();
    // `d` goes before `Tr`: files that have both often have `Tr` the wrong way round.
    let opacity = match (from.dissolve, from.transparency) {
        (Some(dissolve), _) => dissolve,
        (None, Some(transparency)) if transparency >= 1.0 && opacity_map.is_none() => {
            let name = &from.name;
            assets
                .warnings
                .push(format!("{file}: Tr 1 would leave nothing of {name} to be seen; it is taken as solid (say d 0 to hide it)"));
            1.0
        }
        (None, Some(transparency)) => 1.0 - transparency,
        (None, None) => defaults.opacity,
    };
    // A map without its factor is meant to be seen as it is.
    let factor = |map: Option<u32>, absent: [f32; 3]| if map.is_some() { [1.0; 3] } else { absent };
    Material {
        name: from.name.clone(),
        diffuse: from.diffuse.unwrap_or(factor(diffuse_map, defaults.diffuse)),
        specular: from.specular.unwrap_or(factor(specular_map, defaults.specular)),
        shininess: from.shininess.unwrap_or(defaults.shininess),
        emission: from.emission.unwrap_or(factor(emission_map, defaults.emission)),
        opacity,
        blend: opacity < 1.0,
        unlit: defaults.unlit,
        index_of_refraction: from.index_of_refraction.unwrap_or(defaults.index_of_refraction),
        illumination: from.illumination.unwrap_or(if from.specular.is_some() { 2 } else { defaults.illumination }),
        diffuse_map,
        specular_map,
        emission_map,
        opacity_map,
        normal_map: normals.or(bumps),
        normal_map_is_height: bump_is_height,
        bump_scale: from.bump_map.as_ref().map_or(1.0, |map| map.bump_scale),
    }
}
