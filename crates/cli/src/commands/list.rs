//! `gridwalk list`, and the options of `render` that do the same.

use std::fmt::Write;

use gridwalk_render::Aov;
use gridwalk_render::image::{Format, MovieFormat, Tonemap};

use crate::args::high::{Source, load_options};
use crate::args::low::{Limits, List, Listed};
use crate::exit::{Exit, Failure, Result};
use crate::{output, scene};

/// Lists what options can be set to: a name, a tab, and what it is.
pub fn run(low: &List) -> Result<Exit> {
    match low.what {
        Listed::Cameras => {
            let path = low.scene.as_ref().ok_or_else(|| Failure::usage("cameras of which scene? gridwalk list cameras SCENE"))?;
            cameras(&Source::new(path), &low.limits)
        }
        Listed::Clips => {
            let path = low.scene.as_ref().ok_or_else(|| Failure::usage("clips of which scene? gridwalk list clips SCENE"))?;
            clips(&Source::new(path), &low.limits)
        }
        Listed::Aovs => aovs(),
        Listed::Tonemaps => tonemaps(),
        Listed::Formats => formats(),
        Listed::Devices => super::devices::run(false),
    }
}

pub fn cameras(source: &Source, limits: &Limits) -> Result<Exit> {
    let scene = scene::read(source, &load_options(limits))?;
    let lines = scene.cameras.iter().enumerate().map(|(index, named)| {
        let [x, y, z] = named.camera.eye;
        (named.name.clone(), format!("number {index}, at {x} {y} {z}"))
    });
    print(lines)
}

pub fn clips(source: &Source, limits: &Limits) -> Result<Exit> {
    let animation = scene::open(source, &load_options(limits), None)?;
    print(animation.clips.iter().map(|clip| (clip.name.clone(), format!("{} s", clip.duration))))
}

pub fn aovs() -> Result<Exit> {
    let beauty = ("beauty".to_owned(), "R G B A: the picture, linear; always there".to_owned());
    print(std::iter::once(beauty).chain(Aov::ALL.into_iter().map(|aov| (aov.layer().to_owned(), describe(aov)))))
}

fn describe(aov: Aov) -> String {
    let what = match aov {
        Aov::Depth => "Z: distance along the ray, infinite on the background",
        Aov::Normal => "N.X N.Y N.Z: shading normal, towards the viewer",
        Aov::GeometricNormal => "Ng.X Ng.Y Ng.Z: the triangle's own normal, towards the viewer",
        Aov::Position => "P.X P.Y P.Z: position",
        Aov::Albedo => "albedo.R albedo.G albedo.B: diffuse colour without light",
        Aov::Uv => "uv.U uv.V: texture coordinates",
        Aov::Id => "id.prim id.mesh id.material: integers, 4294967295 on the background",
        Aov::Steps => "debug.steps: cells that the camera ray passed",
        Aov::Tests => "debug.tests: triangles that it was tested against",
        Aov::Cells => "debug.cells: cells that it passed and that were not empty",
        _ => "",
    };
    if aov.name() == aov.layer() { what.to_owned() } else { format!("{what} (also called {})", aov.name()) }
}

pub fn tonemaps() -> Result<Exit> {
    print(Tonemap::ALL.into_iter().map(|tonemap| (tonemap.name().to_owned(), tonemap.description().to_owned())))
}

pub fn formats() -> Result<Exit> {
    let read = [
        ("obj", "read: Wavefront OBJ, with its MTL; textures PNG, JPEG, TGA; also .obj.gz, and sequences %04d or ####"),
        ("ply", "read: PLY, ASCII or binary; also .ply.gz, and sequences"),
        ("gltf", "read: glTF 2.0, with what moves in it"),
        ("glb", "read: the same in one file"),
        ("toml", "read: a scene of gridwalk: meshes, cameras, lights, background"),
        ("npy", "read by cast: rays, float32"),
        ("npz", "written by cast: hits"),
    ];
    let read = read.into_iter().map(|(name, what)| (name.to_owned(), what.to_owned()));
    let pictures = Format::ALL.into_iter().map(|format| (format.extension(), format!("written: {}", format.description())));
    let movies = MovieFormat::ALL.into_iter().map(|format| (format.extension(), format!("written by animate: {}", format.description())));
    print(pictures.chain(movies).map(|(name, what)| (name.to_owned(), what)).chain(read))
}

fn print(lines: impl Iterator<Item = (String, String)>) -> Result<Exit> {
    let text = lines.fold(String::new(), |mut text, (name, what)| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{name}\t{what}");
        text
    });
    output::print(&text)?;
    Ok(Exit::Ok)
}
