//! `cargo tool`: the chores of this repository.
#![forbid(unsafe_code)]

mod api;
mod apt;
mod bless;
mod ci;
mod drivers;
mod process;
mod scenes;
mod shaders;
mod slang;

use std::path::PathBuf;
use std::process::{Command, ExitCode};

use anyhow::Result;
use clap::{Parser, Subcommand};

use crate::process::Root;

/// The chores of this repository.
#[derive(Parser)]
#[command(name = "cargo tool", bin_name = "cargo tool")]
struct Arguments {
    #[command(subcommand)]
    tool: Tool,
}

#[derive(Subcommand)]
enum Tool {
    /// Compile the GLSL kernels and write SPIR-V, kernel tables and the public include (needs cmake, Python and a C++ compiler)
    #[command(disable_help_flag = true)]
    Shaders {
        /// Options of the shader tool; --help lists them
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        options: Vec<String>,
    },
    /// Compile the tests' shaders in Slang anew; `shaders` does so too where the compiler has been brought (needs Python's pip)
    Slang,
    /// Everything that CI does, in its order
    Ci(ci::Arguments),
    /// Bless the pictures that the image tests make now, and list what changed
    Bless {
        /// Only tests whose name holds this
        filter: Option<String>,
    },
    /// List the public interface of the library into docs/api/ (needs cargo-public-api)
    Api,
    /// Scenes too large or not free enough to be committed
    Scenes {
        #[command(subcommand)]
        action: Scenes,
    },
    /// Further Vulkan drivers on the CPU, beside the system's
    Drivers {
        #[command(subcommand)]
        action: Drivers,
    },
    /// Measure (an own program, built in release)
    #[command(disable_help_flag = true)]
    Bench {
        /// Options of the benchmark; --help lists them
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        options: Vec<String>,
    },
}

#[derive(Subcommand)]
enum Scenes {
    /// Name, size, licence and source of every scene
    List,
    /// Bring or make a scene and print its path
    Get {
        /// Name of the scene, as `list` has it
        name: String,
        /// Folder to put it into [default: scenes/ in the cache folder: GRIDWALK_CACHE, or gridwalk below XDG_CACHE_HOME or ~/.cache]
        #[arg(long, value_name = "DIR")]
        into: Option<PathBuf>,
    },
    /// Make the key-frames of the committed scene `drops` anew
    Drops,
}

#[derive(Subcommand)]
enum Drivers {
    /// Name and purpose of every driver
    List,
    /// Bring a driver and print the environment that selects it, for eval
    Get {
        /// Name of the driver, as `list` has it
        name: String,
    },
}

fn main() -> ExitCode {
    match run(Arguments::parse().tool) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("cargo tool: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(tool: Tool) -> Result<ExitCode> {
    let root = Root::find()?;
    match tool {
        Tool::Shaders { options } => return shaders::run(&root, &options),
        Tool::Slang => slang::write(&root)?,
        Tool::Ci(arguments) => return ci::run(&root, &arguments),
        Tool::Bless { filter } => return bless::run(&root, filter.as_deref()),
        Tool::Api => api::write(&root)?,
        Tool::Scenes { action: Scenes::List } => scenes::list(),
        Tool::Scenes { action: Scenes::Get { name, into } } => scenes::get(&name, into.as_deref())?,
        Tool::Scenes { action: Scenes::Drops } => scenes::drops::write(&root.join("scenes/drops"))?,
        Tool::Drivers { action: Drivers::List } => drivers::list(),
        Tool::Drivers { action: Drivers::Get { name } } => drivers::get(&name)?,
        Tool::Bench { options } => {
            let mut command = Command::new("cargo");
            command.args(["run", "--quiet", "--release", "--manifest-path"]).arg(root.join("Cargo.toml"));
            command.args(["--package", "gridwalk-bench", "--"]);
            return process::pass(command.args(options));
        }
    }
    Ok(ExitCode::SUCCESS)
}
